//! Names of the files of a result directory, and how to recognise that this program wrote a file.

use crate::files::was_to_become;
use crate::reduce::Reported;
use crate::study::Study;

/// The file that marks a directory as a finished result.
pub const MARK: &str = "summary.json";
/// Folder of the checkpoint within a result directory.
pub const CHECKPOINT: &str = "checkpoint";
/// The page that shows a result; like [`RUN`] it may differ from run to run.
pub const PAGE: &str = "report.html";
/// How the result was computed.
pub const RUN: &str = "run.json";
/// Pictures of the knee, for models that have some: each is `knee-<name>.svg`.
pub const KNEE_PICTURES: [&str; 4] = ["section", "deformed", "around", "surface"];

/// Near the start of every page: the program that wrote it.
pub const GENERATOR: &str = "name=\"generator\" content=\"beltspace\"";

/// The files that any result may have, besides those of its reducers.
const FIXED: [&str; 10] =
    ["front.csv", "front.parquet", "front.svg", "variants.csv", "scenarios.csv", "study.toml", "study.json", RUN, PAGE, MARK];

/// Every file that the result of a study may have, with its page, as this build of the library writes them.
pub fn result_files(study: &Study) -> Vec<String> {
    let mut names = vec!["study.toml".to_owned(), "study.json".to_owned(), "scenarios.csv".to_owned()];
    if !study.objectives.is_empty() {
        names.extend(["front.csv", "front.parquet", "front.svg"].map(str::to_owned));
    }
    names.extend(Reported::files(study));
    if study.report.variants {
        names.push("variants.csv".to_owned());
    }
    if study.model.pulley.is_some() {
        names.extend(KNEE_PICTURES.map(knee_name));
    }
    names.extend([RUN, PAGE, MARK].map(str::to_owned));
    names.retain(|name| is_written(name));
    names
}

/// Does this build of the library write such a file? Without pictures there is no page either.
fn is_written(name: &str) -> bool {
    (cfg!(feature = "pictures") || !(name.ends_with(".svg") || name == PAGE)) && (cfg!(feature = "parquet") || !name.ends_with(".parquet"))
}

/// Most designs on a page; of a larger front this many are shown, evenly along the table.
pub const MOST_ON_PAGE: usize = 200_000;
/// Most designs of a sample on a page; of more this many are shown, evenly along the table.
pub const MOST_DOTS: u64 = 20_000;

/// File of a picture of the knee.
pub fn knee_name(picture: &str) -> String {
    format!("knee-{picture}.svg")
}

/// May a result of some study have a file of this name?
pub fn is_ours(name: &str) -> bool {
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
    let knee = extension == "svg" && stem.strip_prefix("knee-").is_some_and(|it| KNEE_PICTURES.contains(&it));
    knee || FIXED.contains(&name) || Reported::is_file(name)
}

/// Is this the temporary name of such a file while it is written, or of the checkpoint while it is made or removed?
pub fn is_remains(name: &str) -> bool {
    was_to_become(name).is_some_and(|it| is_ours(it) || it == CHECKPOINT)
}

/// Is this the beginning of a page of this program?
pub fn is_page(head: &str) -> bool {
    head.contains(GENERATOR)
}

/// Is this the beginning of a picture of this program?
pub fn is_picture(head: &str) -> bool {
    let mut lines = head.lines();
    let [first, second] = [lines.next().unwrap_or_default(), lines.next().unwrap_or_default()];
    first.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"")
        && second.starts_with("<rect x=\"0\" y=\"0\" width=\"")
        && second.ends_with(" opacity=\"1\" fill=\"#FFFFFF\" stroke=\"none\"/>")
}
