//! No mangled study text, table, result directory or checkpoint makes the program panic, hang or take all memory.
//!
//! Cases are run in a child process, which is this test binary once more, with a limit to its memory; it says which case it is at, so
//! that one that ends it is known. `BELTSPACE_MUTATIONS` is the number of cases of each kind, `BELTSPACE_MUTATION_SEED` where they come
//! from, `BELTSPACE_MUTATION_CASE` the number of a single one that is to be seen again.

mod cases;
mod mutate;
mod readers;

use crate::random::Random;
use std::env;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// Cases of each kind unless the environment says otherwise.
const CASES: u64 = 40;
const SEED: u64 = 0x5eed;
/// How long a case may take.
const TIME: Duration = Duration::from_secs(2);
/// KiB that a case may take.
const MEMORY: u64 = 1 << 20;
/// A case that takes too long is tried alone so many times before it counts: others may be at work on this machine.
const TRIES: u32 = 3;
/// After so many faults the rest is not tried.
const MOST_FAULTS: usize = 5;
/// What the child is told: the kind, the seed, the first case, one behind the last, and the folder of what is mangled.
const ORDER: &str = "BELTSPACE_MUTATION_ORDER";

#[test]
fn mangled_studies_are_read_or_refused() {
    check("study");
}

#[test]
fn mangled_tables_are_read_or_refused() {
    check("table");
}

#[test]
fn mangled_models_are_read_or_refused() {
    check("model");
}

#[test]
fn mangled_results_are_read_or_refused() {
    check("result");
}

#[test]
fn mangled_checkpoints_are_read_or_refused() {
    check("checkpoint");
}

/// The harness objects to a reader that panics, hangs, takes all memory or ends the program, and to nothing else.
#[test]
fn a_reader_that_breaks_is_noticed() {
    let folder = tempfile::tempdir().expect("there is room");
    let Tried { faults, understood } = try_all(cases::BITE, SEED, 0..6, folder.path());
    assert_eq!(understood, 2);
    let expected = [(1, "a reader panics"), (2, "takes more than 2 s"), (3, "memory allocation"), (4, "ends")];
    assert_eq!(faults.len(), expected.len(), "{faults:#?}");
    for (fault, (number, what)) in faults.iter().zip(expected) {
        assert!(fault.number == number && fault.what.contains(what), "{fault:?} is not {what}");
    }
}

/// The child: not a test.
#[test]
#[ignore = "it is run by the others"]
fn worker() {
    let order = env::var(ORDER).expect("the parent says what to do");
    let parts: Vec<&str> = order.splitn(5, ' ').collect();
    let [kind, seed, first, end, base] = parts[..] else { panic!("{order} is no order") };
    let number = |text: &str| text.parse::<u64>().expect("it is a number");
    let say = |what: String| {
        let mut out = std::io::stdout().lock();
        // If the parent has closed the pipe, it has seen enough.
        let _ = writeln!(out, "\n@{what}").and_then(|()| out.flush());
    };
    std::panic::set_hook(Box::new(|_| {}));
    for case in number(first)..number(end) {
        say(format!("case {case}"));
        let mut random = random_of(kind, number(seed), case);
        let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| cases::run(kind, &mut random, case, Path::new(base))));
        match done {
            Ok(true) => say("understood".to_owned()),
            Ok(false) => {}
            Err(panic) => {
                let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
                say(format!("panic {}", text.unwrap_or("a panic").replace('\n', " ")));
            }
        }
    }
    say("end".to_owned());
}

/// Every case has numbers of its own, whatever was run before it.
fn random_of(kind: &str, seed: u64, case: u64) -> Random {
    let kind = kind.bytes().fold(0, |sum: u64, byte| sum.wrapping_mul(31).wrapping_add(byte.into()));
    Random::new(Random::new(seed ^ kind << 32).next() ^ case)
}

fn variable(name: &str) -> Option<u64> {
    env::var(name).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{name} is no number: {text}")))
}

fn check(kind: &str) {
    assert!(cases::KINDS.contains(&kind));
    let base = tempfile::tempdir().expect("there is room");
    cases::prepare(base.path());
    let seed = variable("BELTSPACE_MUTATION_SEED").unwrap_or(SEED);
    let cases = match variable("BELTSPACE_MUTATION_CASE") {
        Some(case) => case..case + 1,
        None => 0..variable("BELTSPACE_MUTATIONS").unwrap_or(CASES),
    };
    let tried = cases.end - cases.start;
    let Tried { faults: found, understood } = try_all(kind, seed, cases, base.path());
    println!("{kind}: {tried} mutations of seed {seed}, {understood} understood all the same, {} faults", found.len());
    let again = |fault: &Fault| {
        let Fault { number, what } = fault;
        format!(
            "case {number}: {what}\n  again: BELTSPACE_MUTATION_SEED={seed} BELTSPACE_MUTATION_CASE={number} \
             cargo test --test it -- mutations::mangled --nocapture"
        )
    };
    // Mangled too little or too much, nothing would be found.
    assert!(tried < CASES || (0 < understood && understood < tried) || !found.is_empty(), "{understood} of {tried} understood");
    assert!(found.is_empty(), "mangled {kind}:\n{}", found.iter().map(again).collect::<Vec<_>>().join("\n"));
}

/// A case that ended otherwise than it may.
#[derive(Debug)]
struct Fault {
    number: u64,
    what: String,
}

/// What came of some cases.
#[derive(Default)]
struct Tried {
    faults: Vec<Fault>,
    /// Cases that were understood all the same.
    understood: u64,
}

/// Runs cases in children until all have been tried.
fn try_all(kind: &str, seed: u64, cases: std::ops::Range<u64>, base: &Path) -> Tried {
    let mut tried = Tried::default();
    let mut next = cases.start;
    while next < cases.end && tried.faults.len() < MOST_FAULTS {
        let Err(broken) = run(kind, seed, next..cases.end, base, &mut tried) else { break };
        next = broken.number + 1;
        let slow = |broken: &Fault| broken.what.starts_with("it takes more");
        let alone = |number| run(kind, seed, number..number + 1, base, &mut Tried::default());
        // Slow because of others?
        if !slow(&broken) || (1..TRIES).all(|_| alone(broken.number).is_err_and(|again| slow(&again))) {
            tried.faults.push(broken);
        }
    }
    tried
}

/// Runs cases in one child; what ends the child is the error.
fn run(kind: &str, seed: u64, cases: std::ops::Range<u64>, base: &Path, tried: &mut Tried) -> Result<(), Fault> {
    let mut child = start(&format!("{kind} {seed} {} {} {}", cases.start, cases.end, base.display()));
    let lines = listen(child.stdout.take().expect("it is piped"));
    let mut number = cases.start;
    let ended = loop {
        match lines.recv_timeout(TIME) {
            Ok(line) if line == "@end" => break None,
            Ok(line) if line == "@understood" => tried.understood += 1,
            Ok(line) => match line.strip_prefix('@').unwrap_or_default().split_once(' ') {
                Some(("case", case)) => number = case.parse().expect("it is a number"),
                Some(("panic", what)) => tried.faults.push(Fault { number, what: what.to_owned() }),
                _ => {}
            },
            Err(RecvTimeoutError::Timeout) => break Some(format!("it takes more than {} s", TIME.as_secs())),
            Err(RecvTimeoutError::Disconnected) => break Some(String::new()),
        }
    };
    // It may have ended by itself.
    let _ = child.kill();
    let output = child.wait_with_output().expect("it has ended");
    match ended {
        None => Ok(()),
        Some(what) if !what.is_empty() => Err(Fault { number, what }),
        Some(_) => {
            let said = String::from_utf8_lossy(&output.stderr);
            let words: Vec<&str> = said.split_whitespace().collect();
            Err(Fault { number, what: format!("it ends the program ({}): {}", output.status, words.join(" ")) })
        }
    }
}

/// This binary once more, with a limit to its memory.
fn start(order: &str) -> Child {
    let binary = env::current_exe().expect("this program is a file");
    let words = ["mutations::worker", "--exact", "--ignored", "--nocapture", "--test-threads", "1"];
    let mut command = if cfg!(unix) {
        let mut shell = Command::new("sh");
        shell.args(["-c", &format!("ulimit -d {MEMORY} && exec \"$0\" \"$@\"")]).arg(binary);
        shell
    } else {
        Command::new(binary)
    };
    command.args(words).env(ORDER, order).env("RUST_BACKTRACE", "0");
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the child starts")
}

fn listen(out: ChildStdout) -> Receiver<String> {
    let (said, heard) = channel();
    std::thread::spawn(move || BufReader::new(out).lines().map_while(Result::ok).try_for_each(|line| said.send(line)));
    heard
}
