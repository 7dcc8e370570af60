//! The command line.

fn main() -> std::process::ExitCode {
    beltspace::program::main().into()
}
