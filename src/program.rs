//! The program: parse, run, print, and how it ended. `main.rs` starts it, and so does the command that comes with the Python package.

use crate::{cli, commands, terminal};
use clap::Parser;
use clap::error::{ContextKind, ContextValue};
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::OnceLock;

/// How the program was started, where that is not what the system says: another program may run it.
struct Invocation {
    path: PathBuf,
    words: Vec<OsString>,
}

static INVOCATION: OnceLock<Invocation> = OnceLock::new();

/// Runs the program as the system has started it; returns the exit code. Call it before there are threads.
pub fn main() -> u8 {
    run(std::env::args_os().collect())
}

/// Runs it with these words, of which the first is the path by which it was started; returns the exit code.
///
/// Wrong words and requests for help end the process.
pub fn main_with(words: Vec<OsString>) -> u8 {
    let path = words.first().map(PathBuf::from).unwrap_or_default();
    INVOCATION.get_or_init(|| Invocation { path, words: words.clone() });
    run(words)
}

/// The words that the program was started with, its own path first.
pub(crate) fn words() -> Vec<OsString> {
    INVOCATION.get().map_or_else(|| std::env::args_os().collect(), |it| it.words.clone())
}

/// The path of the program.
///
/// # Errors
/// If the system does not tell.
pub(crate) fn path() -> std::io::Result<PathBuf> {
    INVOCATION.get().map_or_else(std::env::current_exe, |it| std::path::absolute(&it.path))
}

fn run(words: Vec<OsString>) -> u8 {
    let cli = cli::Cli::try_parse_from(words).unwrap_or_else(|error| wrong_words(&error));
    keep_the_loader_quiet();
    match commands::run(cli.command) {
        Ok(()) => 0,
        Err(error) => {
            terminal::report_error(&error);
            error.exit_code()
        }
    }
}

/// Ends the process with what is wrong with its words, or with the help that was asked for.
fn wrong_words(error: &clap::Error) -> ! {
    // If even this cannot be written, nothing is left to do.
    let _ = error.print();
    if let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand)
        && let Some(meant) = commands::meant_by(word)
    {
        terminal::remark("hint", &meant);
    }
    std::process::exit(error.exit_code())
}

/// A layer of Mesa's Vulkan drivers looks for a display and complains on standard error if there is none. It chooses among graphics cards,
/// which this program does itself, so it is switched off.
#[cfg(target_os = "linux")]
#[allow(unsafe_code, reason = "the only way to tell the loader")]
fn keep_the_loader_quiet() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() && std::env::var_os("NODEVICE_SELECT").is_none() {
        // SAFETY: the program still has only one thread.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

#[cfg(not(target_os = "linux"))]
fn keep_the_loader_quiet() {}
