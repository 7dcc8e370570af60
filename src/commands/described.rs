//! A study in its resolved form, `study.json`, as a result has it beside `study.toml`: no other file is needed.

use beltspace::error::{Error, Result};
use beltspace::files::replace;
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
    let read = |path: &Path| std::fs::read_to_string(path).map_err(|error| format!("cannot read study {}: {error}", path.display()));
    let text = read(path).map_err(Error::Request)?;
    let described = serde_json::from_str(&text).map_err(|error| wrong(format!("it is no resolved study: {error}")))?;
    let study = Study::from_description(&described).map_err(|problem| wrong(format!("it is no resolved study: {problem}")))?;
    let written = read(&path.with_file_name(TEXT)).map_err(|why| wrong(format!("its text, {TEXT}, belongs beside it: {why}")))?;
    Ok((study, written))
}

/// Writes the resolved form of a study into a folder with the text that it was made of; tells the path of the form.
///
/// # Errors
/// [`Error::Io`].
pub fn write(folder: &Path, study: &Study, text: &str) -> Result<PathBuf> {
    let path = folder.join(RESOLVED);
    replace(&folder.join(TEXT), text.as_bytes())?;
    replace(&path, (format!("{:#}", study.describe()) + "\n").as_bytes())?;
    Ok(path)
}
