//! `beltspace reproduce`: the papers' tables and figures.

use crate::cli;
use crate::terminal::{self, Grid, bold, dim};
use beltspace::error::{Error, Result};
use beltspace::papers::{PAGE, Paper, Reproduction, reproduce};
use std::path::Path;

pub fn run(request: &cli::Reproduce) -> Result<()> {
    let out = &request.out;
    if out.is_file() {
        return Err(Error::Request(format!("{} is a file; name a directory with --out", out.display())));
    }
    let all = reproduce()?;
    if !request.force {
        refuse_to_overwrite(&all, out)?;
    }
    all.write(out)?;
    if request.quiet { Ok(()) } else { terminal::print(&shown(&all, out)) }
}

/// Files that are there stay unless `--force` says otherwise.
fn refuse_to_overwrite(all: &Reproduction, out: &Path) -> Result<()> {
    let files = all.in_the_way(out);
    let Some(first) = files.first() else { return Ok(()) };
    let more = if files.len() > 1 { format!(" and {} more", files.len() - 1) } else { String::new() };
    Err(Error::Request(format!(
        "{} has files that would be replaced ({first}{more}); replace them with --force, or write to another --out",
        out.display()
    )))
}

/// The comparisons, paper by paper.
fn shown(all: &Reproduction, out: &Path) -> String {
    let mut text = String::new();
    for paper in Paper::ALL {
        let mut grid = Grid::default();
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
    text + &format!("{}\nreasons, figures and tables: {}\n", all.summary(), out.join(PAGE).display())
}
