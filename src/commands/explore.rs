//! `beltspace explore`: a page that answers while its sliders move.

use super::{tell_short_ranges, threads, unreadable};
use crate::cli;
use crate::terminal::{self, quoted, quoted_word};
use beltspace::error::{Error, Result};
use beltspace::explore::Explorer;
use beltspace::live::Live;
use std::path::Path;

pub fn run(request: &cli::ExploreArgs) -> Result<()> {
    let path = &request.study;
    let text = std::fs::read_to_string(path).map_err(Error::io(path)).map_err(unreadable)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let live = Live::new(text, path.display().to_string(), folder, threads(request.threads));
    let study = live.study(&request.set)?.0;
    study.left_out.iter().for_each(|left_out| terminal::remark("note", left_out));
    tell_short_ranges(&study);
    let study = quoted(path);
    let words = move |command: &str, set: &[String]| {
        let set: String = set.iter().map(|it| format!(" --set {}", quoted_word(it))).collect();
        format!("beltspace {command} {study}{set}")
    };
    let explorer = Explorer::bind(live, request.port, &request.set, Box::new(words))?;
    ctrlc::set_handler(|| std::process::exit(0)).map_err(|error| Error::Request(format!("Ctrl-C cannot be caught: {error}")))?;
    let view = request.view.as_ref().map_or_else(String::new, |it| format!("#{it}"));
    let opened = !request.no_browser && open::that_detached(explorer.address_once() + &view).is_ok();
    let how = if opened { "open in your browser, and at" } else { "open in a browser:" };
    terminal::print(&format!("{how} {}{view}\nCtrl-C ends it\n", explorer.address()))?;
    explorer.serve();
    Ok(())
}
