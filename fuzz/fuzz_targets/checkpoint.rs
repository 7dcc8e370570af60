//! Manifests of checkpoints and the states that belong to them, sealed as the program seals them. The first line is the manifest, what
//! comes after it the state.

#![no_main]

#[allow(dead_code, reason = "each target calls one of them")]
#[path = "../../tests/it/mutations/readers.rs"]
mod readers;

use libfuzzer_sys::fuzz_target;
use serde_json::{Value, json};
use std::fs;

fuzz_target!(|bytes: &[u8]| {
    let line = bytes.iter().position(|&byte| byte == b'\n').unwrap_or(bytes.len());
    let (manifest, state) = (&bytes[..line], &bytes[(line + 1).min(bytes.len())..]);
    let Ok(mut manifest) = serde_json::from_slice::<Value>(manifest) else { return };
    if let Some(object) = manifest.as_object_mut() {
        object.insert("state".to_owned(), json!(["state-1.bin", crc32fast::hash(state)]));
    }
    let folder = tempfile::tempdir().expect("there is room");
    let checkpoint = folder.path().join("checkpoint");
    fs::create_dir(&checkpoint).expect("it can be made");
    let sealed = json!({ "version": 1, "checksum": crc32fast::hash(manifest.to_string().as_bytes()), "manifest": manifest });
    fs::write(checkpoint.join("manifest.json"), sealed.to_string()).expect("it can be written");
    fs::write(checkpoint.join("state-1.bin"), state).expect("it can be written");
    let _ = readers::checkpoint(folder.path());
});
