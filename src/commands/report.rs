//! `beltspace report`: the page of a result, which `sweep` and `merge` write too.

use super::threads;
use crate::cli;
use crate::terminal::{self, quoted};
use beltspace::error::{Error, Result};
use beltspace::files::{Reading, refuse_foreign, refuse_without_folder, replace};
use beltspace::names::{PAGE, is_page};
use beltspace::plan::Plan;
use beltspace::report::{Page, Request, of_result, study_of};
use beltspace::screen::Control;
use beltspace::study::Study;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Least time that a sweep allows for computing the outputs that its tables lack.
const LEAST_PATIENCE: Duration = Duration::from_secs(3);

pub fn run(request: &cli::ReportArgs) -> Result<()> {
    let folder = &request.dir;
    let _reading = Reading::new(folder, &terminal::command_line())?;
    let plan = Plan::new(study_of(folder)?);
    let file = request.out.clone().unwrap_or_else(|| folder.join(PAGE));
    refuse_to_replace(&file, request.force)?;
    let patience = Duration::from_secs(request.patience.into());
    let page = make(&plan, folder, &quoted(&folder.join("study.toml")), threads(request.threads), patience, &Control::default())?;
    replace(&file, page.html.as_bytes())?;
    if request.quiet {
        return Ok(());
    }
    if !page.complete {
        terminal::remark(
            "note",
            &format!(
                "the page shows only the outputs of front.csv; computing the others takes more than {} s: raise --patience",
                request.patience
            ),
        );
    }
    #[allow(clippy::cast_precision_loss, reason = "a size for people")]
    let size = page.html.len() as f64 / 1e6;
    terminal::print(&format!("{} ({size:.1} MB)\n", file.display()))
}

/// The page must be an HTML file, and replaces only another page.
fn refuse_to_replace(file: &Path, force: bool) -> Result<()> {
    let refuse = |problem: &str| Err(Error::Request(format!("{}: {problem}", file.display())));
    if file.is_dir() {
        return refuse("it is a directory; name a file, such as report.html in it");
    }
    if !file.extension().is_some_and(|it| it.eq_ignore_ascii_case("html") || it.eq_ignore_ascii_case("htm")) {
        return refuse("a page is an HTML file; give it a name that ends in .html");
    }
    refuse_without_folder(file)?;
    if force {
        return Ok(());
    }
    refuse_foreign(file, "replace it with --force, or name another", is_page)
}

/// Writes the page of a result that has just been written, and says where. `study` is the one that the user named, as words of
/// a command line.
pub fn beside(plan: &Plan, out: &Path, study: &str, took: Duration, threads: usize, control: &Control) -> Result<PathBuf> {
    let file = out.join(PAGE);
    let page = make(plan, out, study, threads, LEAST_PATIENCE.max(took / 4), control);
    // If this fails, the result is complete all the same.
    let lost = |error: Error| {
        let again = format!("beltspace report {}", quoted(out));
        Error::Page { path: out.to_owned(), why: Box::new(error), again }
    };
    page.and_then(|page| replace(&file, page.html.as_bytes())).map_err(lost)?;
    Ok(file)
}

fn make(plan: &Plan, folder: &Path, study: &str, threads: usize, patience: Duration, control: &Control) -> Result<Page> {
    // Prefer the result's copy of the study, which never changes. It cannot be used if it names tables beside the original.
    let copy = folder.join("study.toml");
    let alone = Study::read(&copy).is_ok_and(|(copy, _)| copy.hash() == plan.study.hash());
    let study = if alone { quoted(&copy) } else { study.to_owned() };
    let evaluate = format!("beltspace eval {study} --design {{design}}");
    let page = of_result(&Request { folder, plan, evaluate: &evaluate, threads, patience }, control)?;
    if page.designs < page.of {
        terminal::remark("note", &format!("the page shows {} of the front's {} designs", page.designs, page.of));
    }
    Ok(page)
}
