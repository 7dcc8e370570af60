//! Which files a result has.

use crate::files::was_to_become;
use crate::influence::{InfluenceSubject, files_of, is_influence_file};
use crate::names::{CHECKPOINT, KNEE_PICTURES, MARK, PAGE, RUN, knee_name};
use crate::reduce::Reported;
use crate::study::Study;

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
    names.extend(InfluenceSubject::of_report(study, 0).ok().flatten().iter().flat_map(files_of));
    names.extend([RUN, PAGE, MARK].map(str::to_owned));
    names.retain(|name| is_written(name));
    names
}

/// Does this build of the library write such a file? Without pictures there is no page either.
fn is_written(name: &str) -> bool {
    (cfg!(feature = "pictures") || !(name.ends_with(".svg") || name == PAGE)) && (cfg!(feature = "parquet") || !name.ends_with(".parquet"))
}

/// May a result of some study have a file of this name?
pub fn is_ours(name: &str) -> bool {
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
    let knee = extension == "svg" && stem.strip_prefix("knee-").is_some_and(|it| KNEE_PICTURES.contains(&it));
    knee || FIXED.contains(&name) || Reported::is_file(name) || is_influence_file(name)
}

/// Is this the temporary name of such a file while it is written, or of the checkpoint while it is made or removed?
pub fn is_remains(name: &str) -> bool {
    was_to_become(name).is_some_and(|it| is_ours(it) || it == CHECKPOINT)
}
