//! `beltspace man`: manual pages.

use crate::cli::Cli;
use crate::terminal;
use beltspace::error::{Error, Result};
use clap::CommandFactory;
use std::path::Path;

/// Prints the page of the program, or writes that and one per command into a directory.
pub fn run(dir: Option<&Path>) -> Result<()> {
    let mut program = Cli::command();
    program.build();
    let Some(dir) = dir else {
        return terminal::print(&page(program, "beltspace")?);
    };
    std::fs::create_dir_all(dir).map_err(Error::io(dir))?;
    let mut pages = vec![("beltspace".to_owned(), program.clone())];
    let commands = program.get_subcommands().filter(|it| !it.is_hide_set());
    pages.extend(commands.map(|command| (format!("beltspace-{}", command.get_name()), command.clone())));
    for (name, command) in &pages {
        let file = dir.join(format!("{name}.1"));
        std::fs::write(&file, page(command.clone(), name)?).map_err(Error::io(&file))?;
    }
    terminal::print(&format!("{} in {}\n", terminal::counted(pages.len() as u64, "page"), dir.display()))
}

/// A page in the form that `man` reads.
fn page(command: clap::Command, name: &str) -> Result<String> {
    let mut text = Vec::new();
    clap_mangen::Man::new(command).title(name).render(&mut text).map_err(Error::io(Path::new("man page")))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}
