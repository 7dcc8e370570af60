//! The command line: parse, run, print, exit.

mod cli;
mod commands;
mod terminal;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    keep_the_loader_quiet();
    match commands::run(cli.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            terminal::report_error(&error);
            ExitCode::from(error.exit_code())
        }
    }
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
