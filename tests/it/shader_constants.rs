//! Numbers that Rust and WGSL both know are declared in Rust only, which writes them into the kernels. Looked at are the modules that write
//! kernels, run them, or compute the same in Rust: elsewhere a constant of the same name is another number.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Files of a kind below a folder of the crate.
pub fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
            let path = entry.expect("it is listed").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|it| it == extension) {
                files.push(path);
            }
        }
    }
    files
}

pub fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The constants that a text of either language declares: `const NAME:`.
fn declared(text: &str) -> BTreeSet<String> {
    let name = |rest: &str| rest.split_once(':').map(|(name, _)| name.to_owned());
    let is_name = |name: &String| !name.is_empty() && name.chars().all(|it| it.is_ascii_uppercase() || it.is_ascii_digit() || it == '_');
    text.split("const ").skip(1).filter_map(name).filter(is_name).collect()
}

/// What is wrong with a shader: constants that Rust declares too, and sizes written as numbers.
fn faults(shader: &str, of_rust: &BTreeSet<String>) -> Vec<String> {
    let twice = declared(shader).intersection(of_rust).map(|name| format!("{name} is declared in Rust too")).collect::<Vec<_>>();
    let digits = |text: &str| text.trim_start().chars().take_while(char::is_ascii_digit).collect::<String>();
    // A single invocation is no size that anybody else has to know.
    let workgroups = shader.split("@workgroup_size(").skip(1).map(digits).filter(|it| !it.is_empty() && it != "1");
    let workgroups = workgroups.map(|it| format!("a workgroup of {it}"));
    // `array<u32, 4>` and `array<vec4<u32>, 4>`, up to the end of the type.
    let size = |text: &str| digits(text.split([';', ',', ')']).nth(1).unwrap_or_default());
    let arrays = shader.split("array<").skip(1).map(size).filter(|it| !it.is_empty()).map(|it| format!("an array of {it}"));
    twice.into_iter().chain(workgroups).chain(arrays).collect()
}

#[test]
fn no_shader_file_declares_a_number_that_rust_declares() {
    let folders = ["src/gpu", "src/screen", "src/tape", "src/real", "src/models", "src/reduce"];
    let sources: Vec<_> = folders.iter().flat_map(|folder| files(folder, "rs")).collect();
    let of_rust: BTreeSet<String> = sources.iter().flat_map(|path| declared(&read(path))).collect();
    for name in ["ROUNDING", "FLUSH", "LARGEST_DIVISOR", "WORKGROUP", "IS_UNSURE", "RESULTS"] {
        assert!(of_rust.contains(name), "{name} is no constant of Rust any more");
    }
    let shaders: Vec<_> = ["shaders/common", "shaders/sweep"].iter().flat_map(|folder| files(folder, "wgsl")).collect();
    let single = ["shaders/evaluate.wgsl", "shaders/self-test.wgsl", "shaders/self-test-64.wgsl", "shaders/self-test-arithmetic.wgsl"]
        .map(|path| Path::new(env!("CARGO_MANIFEST_DIR")).join(path));
    let mut seen = 0;
    // Those of the models are written from the formulas: what they declare is Rust's own.
    for path in shaders.iter().chain(&single) {
        assert_eq!(faults(&read(path), &of_rust), Vec::<String>::new(), "{}", path.display());
        seen += 1;
    }
    assert!(seen >= 9, "{seen}");
}

#[test]
fn a_number_that_is_declared_twice_is_noticed() {
    let of_rust = declared("pub(crate) const FLUSH: f64 = 1.0;\n    const WORKGROUP: u32 = 64;\nconst fn x() -> u32 { 1 }");
    assert_eq!(of_rust, BTreeSet::from(["FLUSH".to_owned(), "WORKGROUP".to_owned()]));
    let fault = |shader: &str| faults(shader, &of_rust);
    assert_eq!(fault("const FLUSH: f32 = 1.0;"), ["FLUSH is declared in Rust too"]);
    assert_eq!(fault("@compute @workgroup_size(64)\nfn f() {}"), ["a workgroup of 64"]);
    assert_eq!(fault("var<private> a: array<u32, 12>;\nvar<private> b: array<vec4<f32>, 16>;"), ["an array of 12", "an array of 16"]);
    let fine = "const PI: f32 = 3.1;\n@workgroup_size(WORKGROUP)\n@workgroup_size(1)\nvar a: array<u32, ROOM>; var b: array<f32>;";
    assert_eq!(fault(fine), Vec::<String>::new());
}
