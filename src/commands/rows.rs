//! `beltspace eval --table`: evaluates every row of a table.

use super::settings::{inputs_of, no_preset};
use super::{CommandTarget, read_study_what_if, target, threads};
use crate::cli;
use crate::terminal;
use beltspace::batch::{BatchTarget, RowReader, evaluate_rows};
use beltspace::error::{Error, Result};
use beltspace::files::{is_there, open, refuse_without_folder, replace_with};
use beltspace::table::stream::{TableForm, TableStream};
use std::io::{ErrorKind, Seek, Write};
use std::path::Path;

/// Stands for standard input and standard output.
const STREAM: &str = "-";

pub fn run(request: &cli::EvalArgs, rows: &Path) -> Result<()> {
    let target = target_of(request)?;
    let out = request.out.as_path();
    let form = form_of(out)?;
    if out != Path::new(STREAM) {
        refuse_without_folder(out)?;
    }
    if out != Path::new(STREAM) && is_there(out) && !request.force {
        return Err(Error::Request(format!("{} is there already; name another, or replace it with --force", out.display())));
    }
    let mut reader = reader_of(rows)?;
    let mut evaluated = |to: &mut dyn Write, target: BatchTarget| {
        let mut target = target;
        let mut stream = TableStream::new(form, to, out);
        let count = evaluate_rows(&mut reader, &mut target, &request.carry, threads(None), &mut stream)?;
        stream.finish().map(|()| count)
    };
    if out == Path::new(STREAM) {
        // Nothing is printed of rows that turn out to be wrong.
        let io = Error::io(Path::new("standard output"));
        let mut file = tempfile::tempfile().map_err(Error::io(Path::new("a temporary file")))?;
        evaluated(&mut file, target)?;
        let copied = file.rewind().and_then(|()| std::io::copy(&mut file, &mut std::io::stdout().lock()));
        return match copied {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(io(error)),
            _ => Ok(()),
        };
    }
    let mut count = Ok(0);
    let written = replace_with(out, |to| {
        count = evaluated(to, target);
        if count.is_ok() { Ok(()) } else { Err(ErrorKind::Other.into()) }
    });
    let count = count?;
    written?;
    terminal::print(&format!("{}, in {}\n", terminal::counted(count, "row"), out.display()))
}

/// What the rows are evaluated by.
fn target_of(request: &cli::EvalArgs) -> Result<BatchTarget> {
    let set = request.set.iter().filter_map(|it| Some(it.split_once('=')?.0.trim().to_owned())).collect();
    let path = match target(&request.target)? {
        CommandTarget::Study(path) => path,
        CommandTarget::Model(model) => {
            let inputs = inputs_of(&model, request.preset.as_deref(), &request.set)?;
            return Ok(BatchTarget::of_model(model, inputs, set));
        }
    };
    if request.preset.is_some() {
        return Err(no_preset());
    }
    // A design axis that is set has one value, which rows need not give.
    let study = read_study_what_if(path, &request.set)?;
    Ok(BatchTarget::of_study(study, set))
}

fn reader_of(rows: &Path) -> Result<RowReader> {
    if rows == Path::new(STREAM) {
        return RowReader::csv("standard input", Box::new(std::io::stdin()));
    }
    let (name, file) =
        (rows.display().to_string(), open(rows).map_err(|error| Error::Request(format!("cannot read {}: {error}", rows.display())))?);
    if ends_in(rows, "parquet") { RowReader::parquet(&name, file) } else { RowReader::csv(&name, Box::new(file)) }
}

fn ends_in(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|it| it.eq_ignore_ascii_case(extension))
}

fn form_of(out: &Path) -> Result<TableForm> {
    match () {
        () if out == Path::new(STREAM) || ends_in(out, "csv") => Ok(TableForm::Csv),
        () if ends_in(out, "parquet") => Ok(TableForm::Parquet),
        () => Err(Error::Request(format!("{}: a table is CSV or Parquet; end its name in .csv or .parquet", out.display()))),
    }
}
