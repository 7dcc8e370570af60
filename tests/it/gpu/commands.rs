//! The command line with a device, and without one.

use std::path::Path;
use std::process::{Command, Output};

fn program(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_beltspace"));
    command.args(line.split_whitespace()).current_dir(folder);
    command
}

fn ask(folder: &Path, line: &str) -> (Option<i32>, String, String) {
    answer(program(folder, line).output().expect("the program starts"))
}

/// The same where the loader finds no driver.
fn ask_without_driver(folder: &Path, line: &str) -> (Option<i32>, String, String) {
    let mut command = program(folder, line);
    command.env("VK_DRIVER_FILES", "/there/is/none.json").env("VK_ICD_FILENAMES", "/there/is/none.json");
    answer(command.output().expect("the program starts"))
}

fn answer(output: Output) -> (Option<i32>, String, String) {
    let text = |bytes| String::from_utf8(bytes).expect("the program writes UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder can be made");
    std::fs::write(folder.path().join("small.toml"), super::SMALL[0]).expect("files can be written");
    folder
}

#[test]
fn adapters_are_listed_with_their_limits_and_their_test() {
    let folder = folder();
    let (code, page, _) = ask(folder.path(), "adapters");
    assert_eq!(code, Some(0));
    for word in ["kind", "driver", "storage binding", "self-test", "passed", "lost appends", "exp_m1"] {
        assert!(page.contains(word), "{word}: {page}");
    }
    let (_, json, _) = ask(folder.path(), "adapters --json");
    let json: serde_json::Value = serde_json::from_str(&json).expect("it is JSON");
    let last = json.as_array().and_then(|list| list.last()).expect("there is an adapter");
    assert_eq!(last["trusted"], true);
    assert!(last["self_test"]["error_ulp"]["arc_sine"].is_number() && last["limits"]["buffer"].is_u64(), "{last}");
}

#[test]
fn shipped_studies_that_a_device_does_not_serve_are_refused_there_with_the_reason() {
    let folder = folder();
    let paths = super::all_shipped();
    for (name, reason) in super::NOT_ON_A_DEVICE {
        if name == super::LONG_LOOPS && !super::device().limited_loops {
            continue;
        }
        let path = paths.iter().find(|it| it.file_stem().is_some_and(|stem| stem == name)).unwrap_or_else(|| panic!("{name} is shipped"));
        let (code, _, error) = ask(folder.path(), &format!("sweep {} --out out --engine gpu", path.display()));
        assert_eq!(code, Some(2), "{name}: {error}");
        assert!(error.contains(reason), "{name}: {error}");
        assert!(!folder.path().join("out").exists(), "{name}");
    }
}

#[test]
fn a_sweep_on_a_device_writes_the_same_files_and_says_what_the_device_did() {
    let folder = folder();
    let name = super::adapters().last().expect("there is an adapter").name.clone();
    let part = name.split_whitespace().next().expect("it has a name").to_uppercase();
    let (code, page, error) = ask(folder.path(), &format!("sweep small.toml --out gpu --engine gpu --adapter {part}"));
    assert_eq!(code, Some(0), "{error}");
    assert!(page.contains(&name) && page.contains("designs left to f64"), "{page}");
    assert_eq!(ask(folder.path(), "sweep small.toml --out cpu --engine cpu").0, Some(0));
    let names = |out: &str| {
        let mut names: Vec<_> =
            std::fs::read_dir(folder.path().join(out)).expect("there is a result").map(|it| it.expect("listed").file_name()).collect();
        names.sort();
        names
    };
    assert_eq!(names("gpu"), names("cpu"));
    for file in names("cpu").into_iter().filter(|name| name != "run.json" && name != "report.html") {
        let read = |out: &str| std::fs::read(folder.path().join(out).join(&file)).expect("it can be read");
        assert!(read("gpu") == read("cpu"), "{file:?} differs");
    }
    let run = std::fs::read_to_string(folder.path().join("gpu/run.json")).expect("it is there");
    let run: serde_json::Value = serde_json::from_str(&run).expect("it is JSON");
    assert_eq!((&run["engine"], &run["device"]["adapter"]), (&"gpu".into(), &name.into()));
    assert_eq!(run["device"]["designs"], run["designs"]);
    for number in ["unsure_designs", "survivors", "tiles"] {
        assert!(run["device"][number].is_u64(), "{number}");
    }
    assert!(run["device"]["self_test"]["loop_turns"].is_u64() && run["device"]["driver"].is_string());
    assert!(run["device"]["compared_with_f64"]["error"]["axial_force_N"]["share_of_promise"].is_number());
}

#[test]
fn the_kernel_can_be_read() {
    let folder = folder();
    let (code, out, error) = ask(folder.path(), "sweep small.toml --emit-shader kernel.wgsl");
    assert_eq!((code, out.as_str()), (Some(0), ""), "{error}");
    let kernel = std::fs::read_to_string(folder.path().join("kernel.wgsl")).expect("it was written");
    for piece in [
        "fn prepare(i: Inputs)",
        "fn finish(p: Prepared",
        "fn sweep(",
        "inputs.strength = Real(f32(800000000.0)",
        "const OBJECTIVES: u32 = 3u;",
    ] {
        assert!(kernel.contains(piece), "{piece}");
    }
    let counted =
        kernel.lines().nth(1).and_then(|line| line.strip_prefix("// Operations in the inner loops, a loop within them counted once: "));
    let count = counted.and_then(|it| it.strip_suffix(" for a design.")?.parse::<u64>().ok());
    assert!(count.is_some_and(|count| (100..1000).contains(&count)), "{counted:?}");
    assert!(!folder.path().join("results").exists(), "nothing else is written");
}

#[test]
fn verify_says_how_accurate_the_device_is_and_whether_the_error_bounds_hold() {
    let folder = folder();
    let (code, page, error) = ask(folder.path(), "verify pulley-load --samples 20000");
    assert_eq!(code, Some(0), "{error}");
    assert!(page.contains("resultant_force_N") && page.contains("all error bounds hold"), "{page}");
    let (code, json, _) = ask(folder.path(), "verify small.toml --samples 20000 --seed 9 --json");
    let json: serde_json::Value = serde_json::from_str(&json).expect("it is JSON");
    assert_eq!((code, &json["kept"], &json["points"]), (Some(0), &true.into(), &20_000.into()));
    assert!(json["tiles"]["designs"].as_u64().is_some_and(|designs| designs > 10_000), "{}", json["tiles"]);
    assert!(json["outputs"].as_array().is_some_and(|outputs| outputs.len() == 38));
}

#[test]
fn a_perturbed_kernel_fails_by_name_and_leaves_no_result() {
    let folder = folder();
    let (code, page, error) = ask(folder.path(), "verify small.toml --samples 20000 --perturb axial_force_N=3e-5");
    assert_eq!(code, Some(1), "{error}");
    assert!(page.contains("an error bound or a decision is wrong") && error.contains("axial_force_N: the GPU gives"), "{page}{error}");
    let (code, out, error) = ask(folder.path(), "sweep small.toml --engine gpu --perturb axial_force_N=3e-5 --out wrong");
    assert_eq!((code, out.as_str()), (Some(1), ""));
    for words in ["axial_force_N of design", "the GPU gives", "f64 gives", "more than the error bound", "--resume --engine cpu"] {
        assert!(error.contains(words), "{words}: {error}");
    }
    assert!(!folder.path().join("wrong/summary.json").exists());
    assert_eq!(ask(folder.path(), "sweep small.toml --out wrong --resume --engine cpu --quiet").0, Some(0), "the way back works");
}

#[test]
fn wrong_requests_about_devices_exit_2_and_say_what_there_is() {
    let folder = folder();
    for (line, expected) in [
        ("sweep small.toml --engine gpu --adapter abacus", "no adapter's name contains \"abacus\"; there is: \""),
        ("verify metal-cvt --adapter abacus", "no adapter's name contains \"abacus\""),
        ("sweep small.toml --engine cpu --adapter llvm", "--adapter names a GPU, but --engine cpu was asked for"),
        ("sweep small.toml --perturb axial_force_N=1", "needs --engine gpu"),
        ("sweep small.toml --engine gpu --perturb axial_force_N", "write OUTPUT=FRACTION"),
        ("sweep small.toml --engine gpu --perturb farce=1", "metal-cvt has no output \"farce\""),
        ("verify farce", "unknown model \"farce\""),
        ("verify metal-cvt --samples 0", "0 is not in 8..=100000000"),
    ] {
        let (code, out, error) = ask(folder.path(), line);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{line}: {error}");
        assert!(error.contains(expected), "{line}: {error}");
    }
    assert!(!folder.path().join("results").exists(), "a wrong request writes nothing");
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_driver_the_processor_does_the_work_and_asking_for_a_gpu_is_refused() {
    let folder = folder();
    for line in ["sweep small.toml --engine gpu", "verify metal-cvt", "sweep small.toml --adapter llvm"] {
        let (code, out, error) = ask_without_driver(folder.path(), line);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{line}: {error}");
        assert!(error.contains("no GPU driver was found") && error.contains("--engine cpu"), "{line}: {error}");
    }
    let (code, page, _) = ask_without_driver(folder.path(), "adapters");
    assert_eq!(code, Some(0));
    assert!(page.contains("no GPU driver was found"), "{page}");
    assert_eq!(ask_without_driver(folder.path(), "sweep small.toml --out auto --quiet").0, Some(0));
}

/// Values too large for f32 need f64: a device refuses them, and if none was asked for by name the CPU takes over.
#[test]
fn numbers_beyond_f32_are_left_to_the_processor() {
    let design = "model = \"metal-cvt\"\n[design]\nratio = { from = 0.5, to = 2, count = 50 }\n";
    let cases = [
        (
            format!(
                "{design}band_thickness_mm = [1e-300, 2e-300, 0.1]\n[objectives]\nband_thickness_mm = \"min\"\naxial_force_N = \"min\"\n"
            ),
            "1e-300 mm",
        ),
        (
            format!(
                "{design}[objectives]\naxial_force_N = \"min\"\n[report]\nhistograms = [{{ of = \"stress_margin\", from = -1e39, to = 1, bins = 4 }}]\n"
            ),
            "the histogram of stress_margin has bins from -1e39 to 1e0",
        ),
    ];
    for (text, told) in cases {
        let folder = tempfile::tempdir().expect("a folder can be made");
        std::fs::write(folder.path().join("s.toml"), text).expect("it can be written");
        let (code, _, err) = ask(folder.path(), "sweep s.toml --out gpu --engine gpu");
        assert_eq!(code, Some(2), "{err}");
        assert!(err.contains("this study cannot be screened on a GPU") && err.contains(told) && err.contains("use --engine cpu"), "{err}");
        assert!(!folder.path().join("gpu").exists(), "it is refused before anything is written");
        let (code, _, err) = ask(folder.path(), "sweep s.toml --out auto --no-report");
        assert_eq!(code, Some(0), "{err}");
    }
}
