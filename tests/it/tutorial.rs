//! The tutorials of `docs/`: every command is run, and outputs, numbers, file names and links must be true.
//!
//! A page is checked like this (`docs/README.md` tells it to readers):
//!
//! - A block ```` ```toml ```` or ```` ```csv ```` under a line that ends in `` `NAME.toml`: `` (or `.csv`) is written to that file, in a folder of the page's own.
//! - A block ```` ```console ```` has commands, lines that start with `$ `, each followed by what it prints: its output, then its notes.
//!   A line `...` stands for any lines, `...` at the end of a line for the rest of it; all else must be equal.
//! - A block ```` ```rust ```` under a line that ends in `` `FILE.rs`: `` stands in that file of the repository, but for lines `...`.
//! - A block ```` ```python ```` or ```` ```sh ```` is run by `python/tests/test_docs.py` or `python/run`; its numbers count as shown.
//! - A number of the prose must stand in a block, or in the section "The requirement"; with three digits or more it may be rounded.
//! - A file name in inline code must be a file that the page made, and a link must lead to a file.

use std::path::{Path, PathBuf};
use std::process::Command;

/// What stands for anything.
const ANYTHING: &str = "...";

/// A part of a page.
enum Part<'a> {
    /// A line of text, and whether it belongs to the requirement.
    Prose { line: &'a str, requirement: bool },
    /// A file and its content.
    File { name: &'a str, content: String },
    /// A part of a source file of this repository.
    Source { name: &'a str, shown: Vec<&'a str> },
    /// What another test runs.
    Elsewhere { shown: Vec<&'a str> },
    /// A command and what it prints.
    Session { command: &'a str, printed: Vec<&'a str> },
}

/// What was checked.
#[derive(Debug, PartialEq)]
struct Checked {
    commands: usize,
    files: usize,
    numbers: usize,
}

/// Takes a page apart.
fn parts(page: &str) -> Result<Vec<Part<'_>>, String> {
    let (mut parts, mut requirement, mut before) = (Vec::new(), false, "");
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        let Some(kind) = line.strip_prefix("```") else {
            requirement = if line.starts_with('#') { line == "## The requirement" } else { requirement };
            before = if line.trim().is_empty() { before } else { line };
            parts.push(Part::Prose { line, requirement });
            continue;
        };
        let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
        match kind {
            "toml" | "csv" => {
                let ending = format!(".{kind}");
                let name = before.strip_suffix("`:").and_then(|line| line.rsplit('`').next()).filter(|name| name.ends_with(&ending));
                let name = name.ok_or_else(|| format!("a file without a name, after: {before}"))?;
                parts.push(Part::File { name, content: block.join("\n") + "\n" });
            }
            "python" | "sh" => parts.push(Part::Elsewhere { shown: block }),
            "rust" => {
                let name = before.strip_suffix("`:").and_then(|line| line.rsplit('`').next()).filter(|name| name.ends_with(".rs"));
                let name = name.ok_or_else(|| format!("source without the name of its file, after: {before}"))?;
                parts.push(Part::Source { name, shown: block });
            }
            "console" => {
                for line in block {
                    match (line.strip_prefix("$ "), parts.last_mut()) {
                        (Some(command), _) => parts.push(Part::Session { command, printed: Vec::new() }),
                        (None, Some(Part::Session { printed, .. })) => printed.push(line),
                        (None, _) => return Err(format!("an output without a command: {line}")),
                    }
                }
            }
            _ => return Err(format!("a block of an unknown kind: {line}")),
        }
    }
    Ok(parts)
}

/// Whether what is shown says the same as what was printed.
fn says(shown: &[&str], printed: &[&str]) -> bool {
    match (shown.split_first(), printed.split_first()) {
        (None, None) => true,
        (Some((&ANYTHING, shown)), _) => (0..=printed.len()).any(|skip| says(shown, &printed[skip..])),
        (Some((line, shown)), Some((other, printed))) => {
            let same = line.strip_suffix(ANYTHING).map_or_else(|| line == other, |start| other.starts_with(start));
            same && says(shown, printed)
        }
        _ => false,
    }
}

/// Runs a command and compares what it prints with what is shown.
fn run(command: &str, shown: &[&str], folder: &Path) -> Result<(), String> {
    let arguments = command.strip_prefix("beltspace ").ok_or_else(|| format!("not a command of beltspace: {command}"))?;
    if arguments.contains(['|', '>', '<', '&', ';', '"', '\'', '\\', '$']) {
        return Err(format!("a command that needs a shell: {command}"));
    }
    let output = Command::new(env!("CARGO_BIN_EXE_beltspace"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .map_err(|error| error.to_string())?;
    let text = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    // How fast this machine is decides whether bounds settle a study that takes about a second; nothing else is told differently then.
    let printed: Vec<&str> = text.lines().map(str::trim_end).filter(|line| !line.starts_with("bounds    ")).collect();
    if shown.iter().all(|line| [ANYTHING, ""].contains(line)) {
        return Err(format!("nothing is shown of what this prints: {command}"));
    }
    let fails = shown.iter().any(|line| line.starts_with("error:"));
    if output.status.success() == fails || !says(shown, &printed) {
        return Err(format!("$ {command}\n--- shown\n{}\n--- printed, {}\n{}", shown.join("\n"), output.status, printed.join("\n")));
    }
    Ok(())
}

/// A number as it is written: its value and digits after the point, and how many digits count.
#[derive(Clone, Copy, Debug)]
struct Number {
    value: f64,
    decimals: i32,
    digits: usize,
}

/// The numbers of a text. Thousands may be set apart by spaces: such numbers count as a whole, and with `pieces` in pieces too.
fn numbers(text: &str, pieces: bool) -> Vec<Number> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    let bytes = text.as_bytes();
    let digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    let mut at = 0;
    while at < bytes.len() {
        let start = at;
        // A digit within a word, such as f64, is none.
        if !digit(at) || at > 0 && (bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b'_') {
            at += 1;
            continue;
        }
        while digit(at) || bytes.get(at) == Some(&b'.') && digit(at + 1) {
            at += 1;
        }
        if bytes.get(at) == Some(&b'e') && (digit(at + 1) || bytes.get(at + 1) == Some(&b'-') && digit(at + 2)) {
            at += 2;
            while digit(at) {
                at += 1;
            }
        }
        found.push((start, at));
    }
    let number = |text: &str| {
        let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i32);
        let digits = text.chars().filter(char::is_ascii_digit).skip_while(|digit| *digit == '0').count();
        Some(Number { value: text.parse().ok()?, decimals, digits })
    };
    let group = |range: &(usize, usize), next: &(usize, usize)| {
        let first = &text[range.0..range.1];
        next.0 == range.1 + 1
            && bytes[range.1] == b' '
            && next.1 - next.0 >= 3
            && first.chars().all(|it| it.is_ascii_digit())
            && text[next.0..next.1].find('.').unwrap_or(next.1 - next.0) == 3
    };
    let (mut all, mut at) = (Vec::new(), 0);
    while at < found.len() {
        let mut end = at + 1;
        while end < found.len() && found[at].1 - found[at].0 <= 3 && group(&found[end - 1], &found[end]) {
            end += 1;
        }
        all.extend(number(&text[found[at].0..found[end - 1].1].replace(' ', "")));
        if pieces && end > at + 1 {
            all.extend(found[at..end].iter().filter_map(|&(from, to)| number(&text[from..to])));
        }
        at = end;
    }
    all
}

/// Whether a number of the prose is one of these, perhaps rounded.
fn stands(number: Number, among: &[Number]) -> bool {
    let half = 0.5 * 10f64.powi(-number.decimals) * (1.0 + 1e-9);
    among.iter().any(|other| other.value == number.value || number.digits >= 3 && (other.value - number.value).abs() <= half)
}

/// The targets of a line's links.
fn links(line: &str) -> impl Iterator<Item = &str> {
    line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target)
}

/// A line without the targets of its links.
fn without_links(line: &str) -> String {
    links(line).fold(line.to_owned(), |line, target| line.replace(&format!("]({target})"), "]"))
}

/// The names of all files below a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let below = |entry: std::fs::DirEntry| {
        let mut all = vec![entry.file_name().to_string_lossy().into_owned()];
        all.extend(names(&entry.path()));
        all
    };
    entries.flat_map(below).collect()
}

/// Checks a page whose links start from this folder.
fn check(page: &str, home: &Path) -> Result<Checked, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let parts = parts(page)?;
    let (mut checked, mut shown) = (Checked { commands: 0, files: 0, numbers: 0 }, Vec::new());
    for part in &parts {
        match part {
            Part::File { name, content } => {
                let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies").join(name);
                if std::fs::read_to_string(shipped).is_ok_and(|shipped| shipped != *content) {
                    return Err(format!("{name} is not as it is shipped in studies/"));
                }
                std::fs::write(folder.path().join(name), content).map_err(|error| error.to_string())?;
                shown.extend(numbers(content, true));
                checked.files += 1;
            }
            Part::Source { name, shown: lines } => {
                let source = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name))
                    .map_err(|error| format!("{name}: {error}"))?;
                let anywhere: Vec<&str> = [ANYTHING].into_iter().chain(lines.iter().copied()).chain([ANYTHING]).collect();
                if !says(&anywhere, &source.lines().collect::<Vec<_>>()) {
                    return Err(format!("{name} does not have this:\n{}", lines.join("\n")));
                }
                shown.extend(lines.iter().flat_map(|line| numbers(line, true)));
            }
            Part::Elsewhere { shown: lines } => shown.extend(lines.iter().flat_map(|line| numbers(line, true))),
            Part::Session { command, printed } => {
                let end = printed.iter().rposition(|line| !line.is_empty()).map_or(0, |last| last + 1);
                run(command, &printed[..end], folder.path())?;
                shown.extend(numbers(command, true));
                shown.extend(printed.iter().flat_map(|line| numbers(line, true)));
                checked.commands += 1;
            }
            Part::Prose { line, requirement: true } => shown.extend(numbers(line, true)),
            Part::Prose { .. } => {}
        }
    }
    let made = names(folder.path());
    for (line, requirement) in
        parts.iter().filter_map(|part| if let Part::Prose { line, requirement } = part { Some((*line, *requirement)) } else { None })
    {
        if let Some(target) = links(line).find(|target| !target.starts_with("https://") && !home.join(target).is_file()) {
            return Err(format!("a link to {target}, which is no file: {line}"));
        }
        let text = without_links(line);
        if let Some(number) = numbers(&text, false).into_iter().find(|number| !requirement && !stands(*number, &shown)) {
            return Err(format!("{} stands in nothing that is shown: {line}", number.value));
        }
        checked.numbers += if requirement { 0 } else { numbers(&text, false).len() };
        let is_file =
            |name: &&str| [".toml", ".csv", ".svg"].iter().any(|end| name.ends_with(end)) && !line.contains(&format!("[`{name}`]("));
        if let Some(name) = line.split('`').skip(1).step_by(2).filter(is_file).find(|name| !made.iter().any(|it| it == name)) {
            return Err(format!("{name} was not made: {line}"));
        }
    }
    Ok(checked)
}

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")
}

/// The pages of `docs/`: name and text.
fn pages() -> Vec<(String, String)> {
    let files = std::fs::read_dir(docs()).expect("the crate has tutorials").map(|entry| entry.expect("a file").path());
    let pages = files.filter(|path| path.extension().is_some_and(|it| it == "md"));
    let mut pages: Vec<_> = pages
        .map(|path| (path.file_name().expect("a name").to_string_lossy().into_owned(), std::fs::read_to_string(&path).expect("text")))
        .collect();
    pages.sort();
    pages
}

/// A page that the program prints.
const PRINTED: &str = "reference-study.md";

#[test]
fn the_reference_is_what_the_program_prints() {
    let page = std::fs::read_to_string(docs().join(PRINTED)).expect("there is a reference");
    assert!(page == beltspace::study::study_reference(), "beltspace schema --markdown > docs/{PRINTED} writes it");
}

#[test]
fn tutorials_say_what_the_program_prints() {
    let mut pages = pages();
    pages.retain(|(name, _)| name != PRINTED);
    let outcomes: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = pages.iter().map(|(_, page)| scope.spawn(move || check(page, &docs()))).collect();
        threads.into_iter().map(|thread| thread.join().expect("a check that ends")).collect()
    });
    let wrong: Vec<String> =
        pages.iter().zip(&outcomes).filter_map(|((name, _), outcome)| Some(format!("docs/{name}: {}", outcome.as_ref().err()?))).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    let mut tutorials = 0;
    for ((name, _), checked) in pages.iter().zip(outcomes.into_iter().flatten()) {
        if name.starts_with("tutorial-") {
            tutorials += 1;
            assert!(checked.commands >= 10 && checked.files >= 2 && checked.numbers >= 20, "docs/{name}: {checked:?}");
        }
    }
    assert_eq!(tutorials, 4);
}

/// The models that the tutorials are about.
const TAUGHT: [&str; 5] = ["rubber-cvt", "metal-cvt", "timing-belt", "pulley-load", "pulley"];

#[test]
fn what_is_taught_has_a_tutorial_and_the_index_has_every_page() {
    let pages = pages();
    for model in TAUGHT {
        assert!(pages.iter().any(|(_, page)| page.contains(&format!("\nmodel = \"{model}\"\n"))), "{model}");
    }
    let (_, index) = pages.iter().find(|(name, _)| name == "README.md").expect("an index");
    assert!(pages.iter().all(|(name, _)| name == "README.md" || links(index).any(|target| target == name)));
}

/// A small page that is true.
const TRUE: &str = "\
# A page

## The requirement

Power 3 kW.

## Work

`small.toml`:

```toml
model = \"pulley-load\"
[design]
slack_tension_N = [600, 700]
[objectives]
resultant_force_N = \"min\"
```

```console
$ beltspace eval pulley-load --set speed_rpm=6000
...
  belt_speed_m_per_s                37.6991  Speed of the belt.
...
  tight_tension_N                   779.577  Tension of the tight side.
...
status ok

$ beltspace sweep small.toml --out small
...
designs   2 in ...
feasible  2 (100 %)
...
knee: slack_tension_N 600 (design 0)
...
$ beltspace eval pulley-load --set speed_rpm=-1
error: ...
```

With 3 kW the belt runs at 37.70 m/s and pulls with 780 N; f64 says so in `front.csv` of `small.toml`.
See the [index](README.md).
";

#[test]
fn a_page_that_is_not_true_is_rejected() {
    assert_eq!(check(TRUE, &docs()), Ok(Checked { commands: 3, files: 1, numbers: 3 }));
    let changes = [
        ("a digit of an output", "  37.6991  Speed", "  37.6992  Speed", "--- shown"),
        ("a digit of a study", "[600, 700]", "[601, 700]", "--- shown"),
        ("a count", "designs   2 in", "designs   3 in", "--- shown"),
        ("an output of another command", "--set speed_rpm=6000", "--set speed_rpm=6001", "--- shown"),
        ("a command that does not exist", "$ beltspace sweep", "$ beltspace swoop", "--- shown"),
        ("a command of another program", "$ beltspace sweep", "$ echo sweep", "not a command of beltspace"),
        ("a command that needs a shell", "speed_rpm=6000", "speed_rpm=6000 | cat", "needs a shell"),
        ("a failure that is shown as a success", "error: ...", "err...", "--- shown"),
        ("lines that are not printed", "status ok", "status ok\nand more", "--- shown"),
        ("lines that are printed and not shown", "...\nstatus ok", "status ok", "--- shown"),
        ("nothing shown", "error: ...", "...", "nothing is shown"),
        ("a number of the prose", "780 N", "781 N", "781 stands in nothing"),
        ("a number that is rounded wrong", "37.70", "37.69", "37.69 stands in nothing"),
        ("a number of one digit", "With 3 kW", "With 8 kW", "8 stands in nothing"),
        ("a number that the requirement had", "Power 3 kW", "Much power", "3 stands in nothing"),
        ("a file without a name", "`small.toml`:\n", "A study:\n", "a file without a name"),
        ("a file that nothing made", "`front.csv`", "`back.csv`", "back.csv was not made"),
        ("a link to nowhere", "(README.md)", "(INDEX.md)", "INDEX.md, which is no file"),
    ];
    for (what, from, to, message) in changes {
        assert!(TRUE.contains(from), "{what}: the page has no {from:?}");
        let outcome = check(&TRUE.replacen(from, to, 1), &docs());
        assert!(outcome.as_ref().is_err_and(|why| why.contains(message)), "{what}: {outcome:?}");
    }
    let shipped = std::fs::read_to_string(docs().join("../studies/camshaft-torque.toml")).expect("it is shipped");
    let study = |text: &str| format!("{TRUE}\n`camshaft-torque.toml`:\n\n```toml\n{text}```\n");
    assert!(check(&study(&shipped), &docs()).is_ok());
    assert!(check(&study(&shipped.replace("13[N m]", "14[N m]")), &docs()).is_err_and(|why| why.contains("is not as it is shipped")));
    let source = |line: &str| format!("{TRUE}\n`tests/it/tutorial.rs`:\n\n```rust\n...\n{line}\n```\n");
    assert!(check(&source("const ANYTHING: &str = \"...\";"), &docs()).is_ok());
    assert!(check(&source("const ANYTHING: &str = \"..,\";"), &docs()).is_err_and(|why| why.contains("does not have this")));
    let (_, tutorial) = pages().into_iter().find(|(name, _)| name == "tutorial-timing-belt.md").expect("a tutorial");
    for (from, to) in [("1683.29", "1683.28"), (" 5 teeth still lift", " 6666 teeth still lift"), ("0.328 N", "0.329 N")] {
        assert!(tutorial.contains(from), "{from}");
        assert!(check(&tutorial.replacen(from, to, 1), &docs()).is_err(), "{from}");
    }
}

#[test]
fn numbers_are_read_as_they_are_written() {
    let values = |text: &str| numbers(text, false).iter().map(|number| number.value).collect::<Vec<_>>();
    assert_eq!(
        values("44 548 N, 0.05 to 1.605e5, -2; f64, x=6000, (28) and 1 600 000.5"),
        [44548.0, 0.05, 160500.0, 2.0, 6000.0, 28.0, 1600000.5]
    );
    assert_eq!(values("12 34, 5 6789, 1234 567"), [12.0, 34.0, 5.0, 6789.0, 1234.0, 567.0]);
    assert_eq!(numbers("882 182", true).iter().map(|number| number.value).collect::<Vec<_>>(), [882182.0, 882.0, 182.0]);
    let among = numbers("0.0350277 41213.2", true);
    for (text, right) in [("0.0350", true), ("0.035", false), ("41 213", true), ("41213.2", true), ("41 214", false), ("41213.21", false)] {
        assert_eq!(stands(numbers(text, false)[0], &among), right, "{text}");
    }
}
