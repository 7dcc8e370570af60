//! Names of the files of a result directory that several modules know, and how to recognise what this program wrote.

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

/// Most designs on a page; of a larger front this many are shown, evenly along the table.
pub const MOST_ON_PAGE: usize = 200_000;
/// Most designs of a sample on a page; of more this many are shown, evenly along the table.
pub const MOST_DOTS: u64 = 20_000;

/// Columns that tables have besides quantities: nothing that a study names may be called so.
const COLUMNS: [&str; 10] = ["design_index", "scenario", "feasible", "feasible_share", "status", "of", "at", "line", "bracket", "along"];
/// What is told of the draws of a study with distributions. `yield` means the same in every study.
pub const YIELDS: [&str; 7] =
    ["yield", "yield_screened", "yield_screened_standard_error", "yield_low", "yield_high", "yield_at_least", "yield_at_most"];
/// What is added to the name of a quantity where it has a further column.
const ADDED: [&str; 6] = ["_scenario", "_constrained", "_constrained_scenario", "_value", "_lowest", "_highest"];

/// What a table's column of this name holds besides a quantity of this name, if some table may have such; `is_known` knows the names of
/// the study's quantities. Two columns of one name cannot be told apart, and most readers of tables drop one.
pub fn column_of_tables(name: &str, is_known: impl Fn(&str) -> bool) -> Option<String> {
    if COLUMNS.contains(&name) {
        return Some("in tables of results".to_owned());
    }
    if YIELDS.contains(&name) {
        return Some("that tells the share of draws that hold".to_owned());
    }
    let of = ADDED.iter().filter_map(|added| name.strip_suffix(added)).find(|of| is_known(of));
    of.map(|of| format!("that tables of results have beside \"{of}\""))
}

/// File of a picture of the knee.
pub fn knee_name(picture: &str) -> String {
    format!("knee-{picture}.svg")
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
