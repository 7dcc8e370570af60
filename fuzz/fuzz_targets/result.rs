//! Files of a result directory. The first byte chooses which one the others are: the rest is the committed result of a small study.

#![no_main]

#[allow(dead_code, reason = "each target calls one of them")]
#[path = "../../tests/it/mutations/readers.rs"]
mod readers;

use libfuzzer_sys::fuzz_target;
use std::fs;
use std::path::Path;

/// A committed result whose page is made in a moment.
const RESULT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../results/studies/metal-grid");

fuzz_target!(|bytes: &[u8]| {
    let Some((&first, bytes)) = bytes.split_first() else { return };
    let folder = tempfile::tempdir().expect("there is room");
    let mut names = Vec::new();
    for entry in Path::new(RESULT).read_dir().expect("it is committed").flatten().filter(|it| it.path().is_file()) {
        fs::copy(entry.path(), folder.path().join(entry.file_name())).expect("it can be copied");
        names.push(entry.file_name());
    }
    names.sort();
    fs::write(folder.path().join(&names[usize::from(first) % names.len()]), bytes).expect("it can be written");
    let _ = readers::result(folder.path());
});
