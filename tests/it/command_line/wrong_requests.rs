//! Wrong requests, and the help of every command.

use super::{SMALL, ask, ask_words, folder_with, program, write};
use std::io::Read;
use std::process::Stdio;

/// A command line (quoted words are one argument), and what the message must contain.
const WRONG: &[(&str, &str)] = &[
    ("", "Usage: beltspace <COMMAND>"),
    ("swep small.toml", "unrecognized subcommand 'swep'"),
    ("small.toml", "hint: a command comes first: beltspace sweep small.toml"),
    ("'my belt.toml'", "hint: a command comes first: beltspace sweep 'my belt.toml'"),
    ("help", "unrecognized subcommand 'help'"),
    ("--colour", "unexpected argument '--colour'"),
    ("models rubber", "unknown model \"rubber\"; models are: rubber-cvt, metal-cvt, timing-belt, pulley-load, pulley"),
    ("models --study", "required arguments were not provided"),
    ("models metal-cvt --json --study", "cannot be used with"),
    ("models metal-cvt rubber-cvt", "unexpected argument 'rubber-cvt'"),
    ("eval", "<MODEL|STUDY>"),
    ("eval steel-cvt", "unknown model \"steel-cvt\""),
    ("eval none.toml --design 0", "cannot read study none.toml"),
    ("eval metal-cvt --design 3", "--design is for studies, and metal-cvt is a model; use --set"),
    ("eval metal-cvt --design -3", "unexpected argument '-3'"),
    ("eval metal-cvt --scenario 3", "--design <N>"),
    ("eval metal-cvt --set", "a value is required for '--set <NAME=VALUE>'"),
    ("eval metal-cvt --set friction", "--set \"friction\": write NAME=VALUE"),
    ("eval metal-cvt --set =3", "--set \"=3\": write NAME=VALUE"),
    ("eval metal-cvt --set friction=", "\"\" is not a number with a unit; write for example \"12\""),
    ("eval metal-cvt --set friction=nan", "friction: \"nan\" is not a number"),
    ("eval metal-cvt --set friction=1e400", "friction: \"1e400\" is not a number"),
    ("eval metal-cvt --set friction=lots", "friction: \"lots\" is not a number"),
    ("eval metal-cvt --set frictoin=0.1", "frictoin is no input of metal-cvt; did you mean friction?"),
    ("eval metal-cvt --set axial_force_N=3", "axial_force_N is an output of metal-cvt"),
    ("eval metal-cvt --set 'band_width_mm=3 furlong'", "unknown unit \"furlong\"; a length may be given in"),
    ("eval metal-cvt --set 'band_width_mm=3 kg/m'", "\"kg/m\" measures a mass per length, but a length is wanted"),
    ("eval metal-cvt --set friction=-0.1", "friction = -0.1 is out of range; it must be greater than 0"),
    ("eval metal-cvt --set groove_angle_deg=180", "it must be greater than 0 and less than 180"),
    ("eval metal-cvt --set traction=1", "it must be at least 0 and less than 1, or \"limit\""),
    ("eval metal-cvt --set band_count=9.5", "band_count = 9.5 must be a whole number"),
    ("eval metal-cvt --set ratio=limit", "ratio: \"limit\" is not a number"),
    ("eval metal-cvt --preset sport", "metal-cvt has no preset \"sport\"; it has none"),
    ("eval metal-cvt --plot belt.svg", "metal-cvt has no values along the belt"),
    ("eval pulley --preset sport", "presets are: machined, welded-discs, double-groove, pressed-cup"),
    ("eval pulley --set section=4", "section takes words only"),
    ("eval pulley --set section=cup", "write \"machined\", \"welded-discs\", \"double-groove\" or \"pressed-cup\""),
    ("eval pulley --set fold_radius_mm=1.8 --plot none.svg", "the inside radius of bend D would be 0 mm"),
    ("eval small.toml", "which design? use --design N, from 0 to 12284"),
    ("eval small.toml --set friction=0.1", "which design? use --design N, from 0 to 12284"),
    ("eval small.toml --preset sport", "--preset is for models; a study names its own"),
    ("eval small.toml --design 12285", "there is no design 12285; the study's designs are 0 to 12284"),
    ("eval small.toml --design 99999999999999999999", "invalid value '99999999999999999999' for '--design <N>'"),
    ("eval small.toml --design knee", "front.csv has them in the column design_index"),
    (
        "eval done --design 0",
        "cannot read study done: it is the directory of a result; give the study in it, done/study.json, or done/study.toml with --set",
    ),
    ("sweep done", "beltspace report done writes its page again"),
    ("explore done --no-browser", "it is the directory of a result"),
    ("explore small.toml --no-browser --view p=1<b", "a view cannot have '<' in it; copy the whole command"),
    (
        "eval timing-belt --profile nowhere/teeth.csv",
        "error: nowhere/teeth.csv: there is no directory nowhere; make it, or name another file",
    ),
    ("eval timing-belt --plot nowhere/teeth.svg", "error: nowhere/teeth.svg: there is no directory nowhere"),
    ("eval metal-cvt --table rows.csv --out nowhere/rows.csv", "error: nowhere/rows.csv: there is no directory nowhere"),
    ("eval small.toml --design 1.5", "invalid value '1.5' for '--design <N>'"),
    ("eval small.toml --design 0 --scenario 12", "there is no scenario 12; the study's scenarios are 0 to 11"),
    ("eval metal-cvt --out rows.csv", "--table <ROWS>"),
    ("eval small.toml --design 0 --table rows.csv", "cannot be used with"),
    ("eval metal-cvt --table none.csv", "cannot read none.csv: "),
    ("eval metal-cvt --table small.toml --out rows.txt", "rows.txt: a table is CSV or Parquet; end its name in .csv or .parquet"),
    ("eval small.toml --design 0 --plot belt.svg", "add --scenario K, from 0 to 11"),
    ("eval small.toml --design 0 --scenario 0 --plot belt.svg", "metal-cvt has no values along the belt"),
    ("export pulley", "--calculix <DIR>"),
    (
        "export metal-cvt --calculix deck",
        "metal-cvt is not computed with finite elements, so there is nothing to export; the model pulley is",
    ),
    ("export pulley --calculix deck --set fold_radius_mm=1.8", "there is nothing to export: the status is \"no section\""),
    ("export pulley.toml --calculix deck", "which design? use --design N, from 0 to "),
    ("check", "<STUDY>"),
    ("check none.toml", "cannot read study none.toml"),
    ("check .", "cannot read study ."),
    ("check broken.toml", "broken.toml:3:1: axis \"groove_angel_deg\": metal-cvt has no input"),
    ("check broken.toml", "broken.toml:5:1: objective \"axial_farce_N\""),
    ("check binary.toml", "this is not UTF-8 text"),
    ("check empty.toml", "no model is named"),
    ("check small.toml other.toml", "unexpected argument 'other.toml'"),
    ("sweep", "<STUDY>"),
    ("sweep none.toml", "cannot read study none.toml"),
    ("sweep broken.toml", "did you mean \"groove_angle_deg\"?"),
    ("sweep small.toml --threads 0", "0 is not in 1..=4096"),
    ("sweep small.toml --threads many", "invalid value 'many' for '--threads <N>'"),
    ("sweep small.toml --tile 0", "0 is not in 1.."),
    ("sweep small.toml --engine abacus", "invalid value 'abacus' for '--engine <ENGINE>'"),
    ("sweep small.toml --shard 0/3", "a shard is K/N with K from 1 to N, such as 3/8"),
    ("sweep small.toml --shard 4/3", "a shard is K/N with K from 1 to N"),
    ("sweep small.toml --shard 1", "a shard is K/N with K from 1 to N"),
    ("sweep small.toml --resume --force", "cannot be used with"),
    ("sweep small.toml --out small.toml", "small.toml is a file; name a directory with --out"),
    ("sweep small.toml --out small.toml --force", "small.toml is a file; name a directory with --out"),
    ("sweep small.toml --out done", "done holds a finished result; replace it with --force"),
    ("sweep small.toml --out done --shard 1/2", "done holds a finished result"),
    ("sweep small.toml --out begun", "begun holds an unfinished run; go on with --resume"),
    ("merge", "<DIR>..."),
    ("merge begun", "--out <DIR>"),
    ("merge begun --out small.toml", "small.toml is a file"),
    ("merge begun --out done", "done holds a finished result"),
    ("merge begun --out whole", "shard 2/2 is missing"),
    ("merge nowhere --out whole", "nowhere: there is no checkpoint here"),
    ("merge done --out whole", "done: there is no checkpoint here"),
    ("sweep pulley.toml --engine gpu", "pulley is computed in f64 on the CPU only; use --engine cpu"),
    ("sweep pulley.toml --adapter llvmpipe", "pulley is computed in f64 on the CPU only; use --engine cpu"),
    ("sweep pulley.toml --emit-shader pulley.wgsl", "it has no shader to write; leave --emit-shader out"),
    ("verify pulley", "pulley is computed in f64 on the CPU only; there is nothing on a GPU to compare with it"),
    ("verify pulley.toml", "there is nothing on a GPU to compare with it"),
    ("completions", "<SHELL>"),
    ("completions cmd", "invalid value 'cmd' for '<SHELL>'"),
];

/// The words of a line; single quotes keep words together.
fn words(line: &str) -> Vec<&str> {
    let parts = line.split('\'').enumerate();
    parts.flat_map(|(at, part)| if at % 2 == 1 { vec![part] } else { part.split_whitespace().collect() }).collect()
}

#[test]
fn every_wrong_request_exits_2_and_says_what_is_wrong() {
    let folder = folder_with("small.toml", SMALL);
    let broken = "model = \"metal-cvt\"\n[design]\ngroove_angel_deg = [18, 20]\n[objectives]\naxial_farce_N = \"min\"\n";
    write(folder.path(), "broken.toml", broken);
    write(folder.path(), "empty.toml", "");
    write(folder.path(), "rows.csv", "torque_Nm\n100\n");
    write(folder.path(), "pulley.toml", &ask(folder.path(), "models pulley --study").text());
    std::fs::write(folder.path().join("binary.toml"), [0xff, 0xfe, 0x00]).expect("files can be written");
    ask(folder.path(), "sweep small.toml --out done").text();
    ask(folder.path(), "sweep small.toml --out begun --shard 1/2").text();
    let before = super::files(folder.path());
    let mut wrong = String::new();
    for (line, expected) in WRONG {
        let answer = ask_words(folder.path(), &words(line));
        if answer.code != Some(2) || !answer.err.contains(expected) || !answer.out.is_empty() {
            wrong += &format!("beltspace {line}\n  must say: {expected}\n  exit {:?}: {}{}\n", answer.code, answer.err, answer.out);
        }
        // No Rust internals: people read this.
        let inside = ["panicked", "Error {", "Err(", "Some(", "unwrap"];
        if inside.iter().any(|word| answer.err.contains(word)) {
            wrong += &format!("beltspace {line}\n  shows its inside: {}\n", answer.err);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(WRONG.len() >= 35);
    assert_eq!(super::files(folder.path()), before, "a wrong request writes nothing");
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = folder_with("small.toml", SMALL);
    for line in ["models metal-cvt", "models --json", "--help", "completions bash", "check small.toml", "sweep small.toml --out out"] {
        let mut child = program(folder.path(), &words(line)).spawn().expect("the program starts");
        // The output is never read.
        drop(child.stdout.take());
        let status = child.wait().expect("it can be waited for");
        let mut err = String::new();
        child.stderr.take().expect("it is piped").read_to_string(&mut err).expect("messages are text");
        assert_eq!((status.code(), err.as_str()), (Some(0), ""), "{line}");
    }
    assert!(folder.path().join("out/summary.json").exists(), "the result is written all the same");
    let mut child = program(folder.path(), &["models", "metal-cvt", "--json"]).stderr(Stdio::piped()).spawn().expect("the program starts");
    let mut pipe = child.stdout.take().expect("it is piped");
    pipe.read_exact(&mut [0; 10]).expect("there are ten bytes");
    drop(pipe);
    assert_eq!(child.wait().expect("it can be waited for").code(), Some(0));
}

#[test]
fn help_names_every_option() {
    let folder = folder_with("small.toml", SMALL);
    let options: [(&str, &[&str]); 6] = [
        ("models", &["[NAME]", "--json", "--study"]),
        ("eval", &["<MODEL|STUDY>", "--set <NAME=VALUE>", "--preset", "--design <N>", "--scenario <K>", "--json", "--profile", "--plot"]),
        ("check", &["<STUDY>"]),
        ("sweep", &["<STUDY>", "--out <DIR>", "--engine", "--threads <N>", "--resume", "--shard <K/N>", "--quiet", "--force"]),
        ("merge", &["<DIR>...", "--out <DIR>", "--force", "--quiet"]),
        ("completions", &["<SHELL>"]),
    ];
    let list = ask(folder.path(), "--help").text();
    for (command, options) in options {
        assert!(list.lines().any(|line| line.trim_start().starts_with(command)), "{command} is missing in\n{list}");
        for help in ["--help", "-h"] {
            let text = ask(folder.path(), &format!("{command} {help}")).text();
            for option in options {
                assert!(text.contains(option), "{option} is missing in\n{text}");
            }
        }
    }
    assert!(!ask(folder.path(), "sweep --help").text().contains("--tile"), "what is for testing is not shown");
    assert_eq!(ask(folder.path(), "--version").text(), format!("beltspace {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn every_shell_has_its_completions() {
    let folder = folder_with("small.toml", SMALL);
    let scripts: Vec<_> = ["bash", "zsh", "fish"].iter().map(|shell| ask(folder.path(), &format!("completions {shell}")).text()).collect();
    for script in &scripts {
        for word in ["beltspace", "sweep", "merge", "shard", "resume"] {
            assert!(script.contains(word), "{word} is missing in\n{script}");
        }
    }
    assert!(scripts[0] != scripts[1] && scripts[1] != scripts[2]);
}
