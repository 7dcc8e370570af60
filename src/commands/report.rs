//! `beltspace report`: the page of a result, which `sweep` and `merge` write too.

use super::threads;
use crate::cli;
use crate::terminal::{self, quoted};
use beltspace::checkpoint::replace;
use beltspace::error::{Error, Result};
use beltspace::export::PAGE;
use beltspace::plan::Plan;
use beltspace::report::{Page, Request, of_result, study_of};
use beltspace::screen::Control;
use beltspace::study::Study;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What a sweep waits at least for the outputs that its tables do not have.
const LEAST_PATIENCE: Duration = Duration::from_secs(3);

pub fn run(request: &cli::Report) -> Result<()> {
    let folder = &request.dir;
    let plan = Plan::new(study_of(folder)?);
    let file = request.out.clone().unwrap_or_else(|| folder.join(PAGE));
    let patience = Duration::from_secs(request.patience.into());
    let page = make(&plan, folder, &folder.join("study.toml"), threads(request.threads), patience, &Control::default())?;
    replace(&file, page.html.as_bytes())?;
    if request.quiet {
        return Ok(());
    }
    if !page.complete {
        terminal::remark(
            "note",
            &format!(
                "the page has of each design what front.csv has; every other output would take more than {} s: raise --patience",
                request.patience
            ),
        );
    }
    #[allow(clippy::cast_precision_loss, reason = "a size for people")]
    let size = page.html.len() as f64 / 1e6;
    terminal::print(&format!("{} ({size:.1} MB)\n", file.display()))
}

/// Writes the page of a result that has just been written, and says where. `study` is the file that the user named.
pub fn beside(plan: &Plan, out: &Path, study: &Path, took: Duration, threads: usize, control: &Control) -> Result<PathBuf> {
    let file = out.join(PAGE);
    let page = make(plan, out, study, threads, LEAST_PATIENCE.max(took / 4), control);
    // Whatever goes wrong here, the result is whole.
    let lost = |error: Error| {
        let again = format!("beltspace report {}", quoted(out));
        Error::Page(format!("the result in {} is complete, but its page could not be made ({error}); try: {again}", out.display()))
    };
    replace(&file, page.map_err(lost)?.html.as_bytes())?;
    Ok(file)
}

fn make(plan: &Plan, folder: &Path, study: &Path, threads: usize, patience: Duration, control: &Control) -> Result<Page> {
    // The result's copy of the study stays what it is; it will not do where it names tables beside the original.
    let copy = folder.join("study.toml");
    let alone = Study::read(&copy).is_ok_and(|(copy, _)| copy.hash() == plan.study.hash());
    let study = if alone { &copy } else { study };
    let evaluate = format!("beltspace eval {} --design {{design}}", quoted(study));
    let page = of_result(&Request { folder, plan, evaluate: &evaluate, threads, patience }, control)?;
    if page.designs < page.of {
        terminal::remark("note", &format!("the page shows {} of the front's {} designs", page.designs, page.of));
    }
    Ok(page)
}
