//! `beltspace reproduce`: computes the papers' tables and figures again.

use crate::cli;
use crate::terminal::{self, TextGrid, bold, dim};
use beltspace::error::{Error, Result};
use beltspace::files::{Claim, MOVE, is_regular, refuse_foreign, replace};
use beltspace::names::{PAGE as HTML, is_page};
use beltspace::papers::{PAGE, Paper, Reproduction, Verdict, reproduce};
use beltspace::report::of_papers;
use std::path::Path;

pub fn run(request: &cli::ReproduceArgs) -> Result<()> {
    let out = &request.out;
    let directory = Claim::new(out, &terminal::command_line())?;
    let all = reproduce()?;
    refuse_to_overwrite(&all, out, request.force)?;
    let page = out.join(HTML);
    if !request.no_report {
        refuse_foreign(&page, MOVE, is_page)?;
    }
    all.write(&directory)?;
    if !request.no_report {
        replace(&page, of_papers(&all).as_bytes())?;
    }
    if request.quiet {
        return Ok(());
    }
    let page = if request.no_report { String::new() } else { format!("page: {}\n", page.display()) };
    terminal::tell(&(shown(&all, out) + &page))
}

/// Existing files are only replaced if they are those of a reproduction and `--force` is given.
fn refuse_to_overwrite(all: &Reproduction, out: &Path, force: bool) -> Result<()> {
    let own = Reproduction::is_in(out);
    let files = all.in_the_way(out);
    let link = files.iter().find(|name| !is_regular(&out.join(name)));
    let Some(first) = link.or(files.first()).filter(|_| !(own && force && link.is_none())) else { return Ok(()) };
    let more = if files.len() > 1 { format!(" and {} more", files.len() - 1) } else { String::new() };
    let remedy = if own && link.is_none() { "replace them with --force" } else { "beltspace did not write them: move them away" };
    Err(Error::Request(format!("{} has files that would be replaced ({first}{more}); {remedy}, or write to another --out", out.display())))
}

/// The comparisons, paper by paper.
fn shown(all: &Reproduction, out: &Path) -> String {
    let mut text = String::new();
    for paper in Paper::ALL {
        let mut grid = TextGrid::default();
        for row in all.comparisons.iter().filter(|row| row.group == paper) {
            let with_unit = |number: &str| if row.unit.is_empty() { number.to_owned() } else { format!("{number} {}", row.unit) };
            grid.row([
                row.verdict.word().to_owned(),
                dim(row.at),
                row.what.clone(),
                row.difference.clone(),
                format!("{} -> {}", row.printed, with_unit(&row.computed)),
            ]);
        }
        text += &format!("{}\n{}\n", bold(paper.name()), grid.indented(2));
    }
    for verdict in Verdict::ALL {
        text += &format!("{}: {}\n", bold(verdict.word()), verdict.meaning());
    }
    text + &format!("\n{}\nreasons, figures and tables: {}\n", all.summary(), out.join(PAGE).display())
}
