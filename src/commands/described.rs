//! A study in its resolved form, `study.json`, as a result has it beside `study.toml`: no other file is needed.

use beltspace::error::{Error, Result};
use beltspace::files::{MOVE, RESULT_BYTES, is_there, read_text, refuse_foreign, replace};
use beltspace::study::{Study, StudyEdits};
use std::path::{Path, PathBuf};

/// The file, and the one beside it that has the text of the study.
const RESOLVED: &str = "study.json";
const TEXT: &str = "study.toml";

/// Is it the resolved form of a study, rather than a study file?
pub fn is_described(path: &Path) -> bool {
    path.extension().is_some_and(|it| it == "json")
}

/// Reads a resolved study, and the text that it was made of.
///
/// # Errors
/// [`Error::Request`] that names the file, if it is none or the text is missing, or if it is to be edited.
pub fn read(path: &Path, edits: StudyEdits<'_>) -> Result<(Study, String)> {
    let wrong = |why: String| Error::Request(format!("{}: {why}", path.display()));
    if !edits.set.is_empty() || edits.feasible {
        return Err(wrong(format!(
            "this study is resolved, all its values stand; --set and --feasible take the study file, such as {TEXT}"
        )));
    }
    let read = |path: &Path| read_text(path, RESULT_BYTES, "give the study file itself").map_err(|error| error.to_string());
    let text = read(path).map_err(Error::Request)?;
    let described = serde_json::from_str(&text).map_err(|error| wrong(format!("it is no resolved study: {error}")))?;
    let study = Study::from_description(&described).map_err(|problem| wrong(format!("it is no resolved study: {problem}")))?;
    let written = read(&path.with_file_name(TEXT)).map_err(|why| wrong(format!("its text, {TEXT}, belongs beside it: {why}")))?;
    Ok((study, written))
}

/// Refuses to write into a folder that has anything but the resolved form of a study, and without `force` also where it has one.
///
/// # Errors
/// [`Error::Request`] that names what is in the way.
pub fn refuse_to_replace(folder: &Path, force: bool) -> Result<()> {
    if !is_there(folder) {
        return Ok(());
    }
    let foreign = |path: &Path| {
        let (path, folder) = (path.display(), folder.display());
        Error::Request(format!("{path} is in the way: the study of the jobs is written into {folder}; {MOVE} directory with --jobs"))
    };
    if !folder.is_dir() {
        return Err(foreign(folder));
    }
    for entry in std::fs::read_dir(folder).map_err(Error::io(folder))? {
        let path = entry.map_err(Error::io(folder))?.path();
        if ![RESOLVED, TEXT].into_iter().any(|name| path == folder.join(name)) {
            return Err(foreign(&path));
        }
        // Neither a directory nor a link.
        refuse_foreign(&path, MOVE, |_| true)?;
    }
    let resolved = folder.join(RESOLVED);
    let is_own = || {
        let text = read_text(&resolved, RESULT_BYTES, MOVE).ok()?;
        Study::from_description(&serde_json::from_str(&text).ok()?).ok()
    };
    match [RESOLVED, TEXT].map(|name| folder.join(name)).into_iter().find(|path| is_there(path)) {
        Some(path) if is_own().is_none() => Err(foreign(&path)),
        Some(_) if !force => Err(Error::Request(format!(
            "{} has a study already; replace it with --force, or write to another directory with --jobs",
            folder.display()
        ))),
        _ => Ok(()),
    }
}

/// Writes the resolved form of a study into a folder with the text that it was made of; tells the path of the form.
///
/// # Errors
/// [`Error::Io`].
pub fn write(folder: &Path, study: &Study, text: &str) -> Result<PathBuf> {
    std::fs::create_dir_all(folder).map_err(Error::io(folder))?;
    let path = folder.join(RESOLVED);
    // By the form a folder is known as one of these.
    replace(&path, (format!("{:#}", study.describe()) + "\n").as_bytes())?;
    replace(&folder.join(TEXT), text.as_bytes())?;
    Ok(path)
}
