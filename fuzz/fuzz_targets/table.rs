//! Tables of values that a study names.

#![no_main]

#[allow(dead_code, reason = "each target calls one of them")]
#[path = "../../tests/it/mutations/readers.rs"]
mod readers;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let folder = tempfile::tempdir().expect("there is room");
    let _ = readers::table(bytes, folder.path());
});
