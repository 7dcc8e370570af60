//! Reads a study file: one walk over its syntax tree reports all mistakes at once, with line and column.
//!
//! | file            | reads                                              |
//! |-----------------|----------------------------------------------------|
//! | `syntax.rs`     | TOML and its syntax errors                         |
//! | `table.rs`      | tables, positions, problems                        |
//! | `value.rs`      | numbers, units, words                              |
//! | `axes.rs`       | `[design]`, `[operation]`, `[uncertainty]`, `[fixed]` |
//! | `range.rs`      | `{ from, to, ... }`                                |
//! | `cases.rs`      | joint axes, from rows or a CSV file                |
//! | `spectrum.rs`   | axes with weights, and `over_scenarios`             |
//! | `weights.rs`    | the weights of cases                               |
//! | `roles.rs`      | who gives inputs values                            |
//! | `labels.rs`     | `labels`                                           |
//! | `presets.rs`    | axes over presets                                  |
//! | `formulas.rs`   | `units`, `[curves]`, `[formulas]`                   |
//! | `model_file.rs` | the file of a model, and in `model_inputs.rs` its inputs |
//! | `quantities.rs` | `[constraints]`, `[objectives]`                    |
//! | `report.rs`     | `[report]`                                         |
//! | `sensitivity.rs` | its key `sensitivity`                          |
//! | `contours.rs`   | the contours of its maps                           |
//! | `law.rs`        | distributions of `[uncertainty]`                    |
//! | `tolerance.rs`  | tolerances that become a part of the model          |
//! | `drawn.rs`      | `[probability]`, and what is asked of draws         |
//! | `set.rs`        | values in place of what a study says               |
//! | `part.rs`       | parts of a study that are given another value      |
//! | `place.rs`      | where in its text they are written                 |

mod axes;
mod cases;
mod contours;
mod csv_file;
mod drawn;
mod formulas;
pub(super) mod keys;
mod labels;
mod law;
mod model_file;
mod model_inputs;
mod part;
mod place;
mod presets;
mod quantities;
mod range;
mod report;
mod roles;
mod sensitivity;
mod set;
mod spectrum;
mod syntax;
mod table;
#[cfg(test)]
pub(crate) mod tests;
mod tolerance;
mod value;
mod weights;

pub(super) use formulas::CurvePoints;
pub(super) use law::{DISCRETE, LAWS, LEFT_OUT, LISTED, PARAMETERS};
pub(super) use model_file::KEYS as MODEL_KEYS;
pub use model_file::{FileKind, file_kind, parse_model, read_model};
pub(super) use model_file::{ModelText, read_model_text};
#[cfg(feature = "pictures")]
pub(crate) use part::entry_names;
#[cfg(feature = "cli")]
pub(crate) use part::{entry_leaves, quoted_key, with_whole_paths};
pub(super) use quantities::MOST_OBJECTIVES;
pub(super) use range::check_levels;
pub(super) use report::{BINS, FRONT_BUDGET, MOST_CELLS, MOST_FEASIBLE, MOST_SAMPLE, MOST_TOP, MOST_VARIANTS};
pub(super) use value::shown;
pub(crate) use value::{checked as input_value_checked, input_text};

use super::axis::{Axis, Method, Sample};
use super::drawn::{Probability, UncertainInput};
use super::label::Label;
use super::resolved::{Constraint, Objective, Report, Study};
use super::spectrum::Spectrum;
use crate::error::Result;
use crate::likeness::remedy;
use crate::models::{Model, Models};
use crate::probability::Effect;
use labels::{DeclaredLabel, check_label_names, read_labels};
use roles::{AxisClaim, AxisRole};
use set::SetAxes;
pub use set::StudyEdits;
use std::cell::{Cell, RefCell};
use std::path::Path;
use std::sync::Arc;
use table::{Entry, Problems, TomlNode, TomlTable, list, shortened};
use value::whole;

/// Most levels of one axis given by a rule: up to here an index is an exact f64.
pub(super) const MOST_LEVELS: u64 = 1 << 53;
/// Most scenarios of a study.
pub(super) const MOST_SCENARIOS: u64 = 1 << 32;
/// Keys and tables at the top level of a study file.
pub(super) const TOP_LEVEL: &[&str] = &[
    "model",
    "preset",
    "title",
    "design",
    "operation",
    "uncertainty",
    "probability",
    "fixed",
    "constraints",
    "objectives",
    "report",
    "sample",
    "units",
    "curves",
    "formulas",
    "labels",
];

/// One mistake in a study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// The file: the study's, or that of a CSV file it names.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1; in a CSV file the field.
    pub column: usize,
    /// What is wrong and what would be right.
    pub message: String,
}

impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}:{}: {}", self.file, self.line, self.column, self.message)
    }
}

/// All mistakes in a study, in file order. Shown as one line per problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudyErrors {
    /// The problems, at least one.
    pub problems: Vec<Problem>,
}

impl std::fmt::Display for StudyErrors {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (index, problem) in self.problems.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            write!(f, "{problem}")?;
        }
        Ok(())
    }
}

impl std::error::Error for StudyErrors {}

impl Study {
    /// Reads and checks a study file; returns the study and its text.
    ///
    /// # Errors
    /// [`Error::Io`](crate::error::Error::Io) if the file cannot be read, [`Error::Study`](crate::error::Error::Study) with all mistakes
    /// in it.
    pub fn read(path: &Path) -> Result<(Self, String)> {
        Self::read_set(path, &[])
    }

    /// The same with values in place of what the file gives some inputs, each as `NAME=VALUE`: of an axis, a fixed value or a formula. The
    /// text is that of the file with these values.
    ///
    /// # Errors
    /// As [`Study::read`]; [`Error::Request`](crate::error::Error::Request) for what is wrong with the values.
    pub fn read_set(path: &Path, set: &[String]) -> Result<(Self, String)> {
        Self::read_with(path, StudyEdits { set, feasible: false })
    }

    /// The same with all that may be asked of a study besides what its file says.
    ///
    /// # Errors
    /// As [`Study::read_set`].
    #[doc(hidden)]
    pub fn read_with(path: &Path, edits: StudyEdits<'_>) -> Result<(Self, String)> {
        Self::read_edited(path, edits, SetAxes::Go)
    }

    /// The same for one design that is asked about: a design axis whose input is set stays, with that value only.
    ///
    /// # Errors
    /// As [`Study::read_set`].
    #[doc(hidden)]
    pub fn read_what_if(path: &Path, set: &[String]) -> Result<Self> {
        Self::read_edited(path, StudyEdits { set, feasible: false }, SetAxes::Stay).map(|(study, _)| study)
    }

    fn read_edited(path: &Path, edits: StudyEdits<'_>, axes: SetAxes) -> Result<(Self, String)> {
        let (text, file) = model_file::text_of(path, "long lists of values go into a CSV file")?;
        Self::parse_edited(&Models::new(), &text, &file, path.parent().unwrap_or(Path::new("")), edits, axes)
    }

    /// Checks a study given as text, such as `include_str!("study.toml")`. CSV files that it names are looked for in the current folder.
    ///
    /// # Errors
    /// Everything that is wrong, in the order of the text, which messages call `study`.
    pub fn parse(text: &str) -> std::result::Result<Self, StudyErrors> {
        Self::parse_in(text, "study", Path::new("."))
    }

    /// The same where it comes from a file: `file` is its name in messages, `folder` what paths of CSV files are relative to.
    ///
    /// # Errors
    /// Everything that is wrong, in file order.
    pub fn parse_in(text: &str, file: &str, folder: &Path) -> std::result::Result<Self, StudyErrors> {
        Self::parse_with(&Models::new(), text, file, folder)
    }

    /// The same where the model may be any of these.
    ///
    /// # Errors
    /// As [`Study::parse_in`].
    pub fn parse_with(models: &Models, text: &str, file: &str, folder: &Path) -> std::result::Result<Self, StudyErrors> {
        let problems = Problems::new(text, file);
        let study = syntax::understandable(text, &problems).and_then(|text| {
            // The syntax has been checked on this very text, so that there is nothing left to recover from.
            let (tree, _) = toml::de::DeTable::parse_recoverable(&text);
            read_study(models, &TomlTable::new(tree.get_ref(), 0), &problems, folder)
        });
        match (study, problems.into_sorted()) {
            (Some(study), problems) if problems.is_empty() => study.check().map(|()| study).map_err(|problem| {
                let message = format!("this study is impossible: {problem}");
                StudyErrors { problems: vec![Problem { file: file.to_owned(), line: 1, column: 1, message }] }
            }),
            (_, mut problems) => {
                if problems.is_empty() {
                    // Unreachable as long as every `None` comes with a problem; a message is better than a panic.
                    let message = "the study cannot be understood".to_owned();
                    problems.push(Problem { file: file.to_owned(), line: 1, column: 1, message });
                }
                Err(StudyErrors { problems })
            }
        }
    }
}

/// State shared by all parts of the reader.
struct Reader<'a> {
    model: &'a Arc<Model>,
    problems: &'a Problems<'a>,
    folder: &'a Path,
    /// The value of every input where the study gives none: the default, or what the preset says.
    base: Vec<f64>,
    /// Are the designs sampled?
    sampled: bool,
    /// How many are, where that is understood.
    sample_count: Option<u64>,
    /// Every place that gives an input values.
    claims: RefCell<Vec<AxisClaim>>,
    /// Is an input given values under a wrong name? Then it is unknown which inputs have none.
    misnamed: Cell<bool>,
    /// Where an axis has weights, or should have.
    weighted_at: Cell<Option<usize>>,
    /// The axis with weights, if it is right.
    spectrum: RefCell<Option<Spectrum>>,
    /// The labels that the study declares, and those that its axes have.
    declared: &'a [DeclaredLabel],
    labels: RefCell<Vec<Label>>,
    /// Is there a CSV file that was not read?
    unread: Cell<bool>,
    /// Does an input have a distribution, right or wrong?
    has_laws: Cell<bool>,
    /// Inputs with distributions, with their places.
    uncertain: RefCell<Vec<(UncertainInput, usize)>>,
    /// Inputs with levels of a tolerance, with their places.
    toleranced: RefCell<Vec<(String, usize)>>,
    /// What names mean where something is asked of draws, and the drive of which that is.
    meanings: Option<(drawn::Meanings, &'a Probability)>,
    /// The whole file.
    top: &'a TomlTable<'a>,
    /// What was left out of catalogues.
    left_out: RefCell<Vec<String>>,
    /// Ranges whose steps end before their end.
    short_ranges: RefCell<Vec<String>>,
}

/// Walks the whole file. `None` if a problem was reported that leaves no study.
fn read_study(models: &Models, top: &TomlTable<'_>, problems: &Problems<'_>, folder: &Path) -> Option<Study> {
    read_study_of(model_named(models, top, problems, folder), top, problems, folder)
}

/// The same for a model that has been found; `None` if that has a problem of its own.
fn read_study_of(model: Option<Arc<Model>>, top: &TomlTable<'_>, problems: &Problems<'_>, folder: &Path) -> Option<Study> {
    check_top_level(top, model.as_deref(), problems);
    let title = top.get("title").and_then(|entry| text(entry.node, problems, "title"));
    let sample_table = section(top, "sample", problems);
    let sample = sample_table.as_ref().and_then(|table| read_sample(table, problems));
    let declared = read_labels(top, problems);
    let model = formulas::with_formulas(model?, top, &declared, problems, folder)?;
    check_label_names(&declared, &model, problems);

    let reader = Reader {
        model: &model,
        problems,
        folder,
        base: read_preset(top, &model, problems),
        sampled: top.get("sample").is_some(),
        sample_count: sample.map(|it| it.count),
        claims: RefCell::default(),
        misnamed: Cell::default(),
        weighted_at: Cell::default(),
        spectrum: RefCell::default(),
        declared: &declared,
        labels: RefCell::default(),
        unread: Cell::default(),
        has_laws: Cell::default(),
        uncertain: RefCell::default(),
        toleranced: RefCell::default(),
        meanings: None,
        top,
        left_out: RefCell::default(),
        short_ranges: RefCell::default(),
    };
    let axes = |role: AxisRole| section(top, role.name(), problems).map_or_else(Vec::new, |table| reader.axes(role, &table));
    let (design, operation, uncertainty) = (axes(AxisRole::Design), axes(AxisRole::Operation), axes(AxisRole::Uncertainty));
    let mut fixed = reader.fixed(section(top, "fixed", problems).as_ref());
    reader.check_claims();
    reader.toleranced.borrow().iter().for_each(|(name, at)| reader.check_toleranced(name, *at, &fixed));
    reader.check_replaced([&design, &operation, &uncertainty], &fixed, top);
    reader.check_labels();
    reader.check_sizes(top, &design, &[&operation, &uncertainty]);

    let title = title.unwrap_or_else(|| model.summary.to_owned());
    let checked = |study: Study| {
        sensitivity::check(&study, top, problems);
        Some(study)
    };
    if !reader.has_laws.get() {
        reader.probability(top, &drawn::DriveParts { operation: &operation, uncertainty: &uncertainty, fixed: &fixed });
        let (constraints, objectives, report) = reader.asked_of_designs(top, &design, &fixed);
        let spectrum = reader.spectrum.take();
        let (labels, left_out, short_ranges) = (reader.labels.take(), reader.left_out.take(), reader.short_ranges.take());
        let probability = None;
        return checked(Study {
            model,
            title,
            design,
            labels,
            sample,
            operation,
            spectrum,
            uncertainty,
            probability,
            fixed,
            constraints,
            objectives,
            report,
            left_out,
            short_ranges,
        });
    }
    if reader.uncertain.borrow().is_empty() {
        return None;
    }
    for (it, _) in reader.uncertain.borrow().iter().filter(|(it, _)| it.effect == Effect::Is) {
        fixed[it.input] = it.distribution.quantile(0.5).unwrap_or(fixed[it.input]);
    }
    let (probability, meanings) =
        reader.probability(top, &drawn::DriveParts { operation: &operation, uncertainty: &uncertainty, fixed: &fixed })?;
    let outer = drawn::model_of(&probability, &reader)?;
    let reader = Reader { model: &outer, meanings: Some((meanings, &probability)), ..reader };
    let (constraints, objectives, mut report) = reader.asked_of_designs(top, &design, &fixed);
    report.columns.extend(drawn::confirmed_columns(&probability));
    let (labels, left_out, short_ranges) = (reader.labels.take(), reader.left_out.take(), reader.short_ranges.take());
    drop(reader);
    let probability = Some(Arc::new(probability));
    let (operation, spectrum) = (Vec::new(), None);
    checked(Study {
        model: outer,
        title,
        design,
        labels,
        sample,
        operation,
        spectrum,
        uncertainty,
        probability,
        fixed,
        constraints,
        objectives,
        report,
        left_out,
        short_ranges,
    })
}

/// Is a model's name that of a file?
fn is_model_file(name: &str) -> bool {
    name.ends_with(".toml")
}

/// The model that the file names.
fn model_named(models: &Models, top: &TomlTable<'_>, problems: &Problems<'_>, folder: &Path) -> Option<Arc<Model>> {
    let names = || list(models.iter().map(|model| model.name.as_str()));
    let Some(entry) = top.get("model") else {
        problems.add_if_complete(0, format!("no model is named; write model = \"...\", models are: {}", names()));
        return None;
    };
    let name = text(entry.node, problems, "model")?;
    if is_model_file(&name) {
        return model_file::named_model(models, &name, entry.node.at, problems, folder);
    }
    let model = models.find(&name);
    if model.is_none() {
        problems.add(entry.node.at, format!("unknown model \"{}\"; models are: {}", shortened(&name), names()));
    }
    model
}

/// The inputs of the model's preset that the file names, else the defaults.
fn read_preset(top: &TomlTable<'_>, model: &Model, problems: &Problems<'_>) -> Vec<f64> {
    let named = top.get("preset").and_then(|entry| Some((entry.node.at, text(entry.node, problems, "preset")?)));
    let found = named.map(|(at, name)| model.preset(&shortened(&name)).map_err(|error| problems.add(at, format!("preset: {error}"))));
    found.and_then(std::result::Result::ok).unwrap_or_else(|| model.defaults())
}

/// Reports unknown keys at the top level.
fn check_top_level(top: &TomlTable<'_>, model: Option<&Model>, problems: &Problems<'_>) {
    for entry in top.unknown(TOP_LEVEL).take_while(|_| !problems.is_full()) {
        let key = entry.key;
        // A likely mistake: a value of the model written outside of a table.
        let misplaced = model.and_then(|model| {
            if model.input(key).is_some() {
                Some("it is an input, put it into [design], [operation], [uncertainty] or [fixed]")
            } else if model.output(key).is_some() {
                Some("it is an output, put it into [constraints] or [objectives]")
            } else {
                None
            }
        });
        let similar = || remedy(key, TOP_LEVEL, || format!("a study has {}", list(TOP_LEVEL)));
        let remedy = misplaced.map_or_else(similar, str::to_owned);
        problems.add(entry.key_at, format!("unknown key \"{}\"; {remedy}", shortened(key)));
        if entry.node.table().is_some() {
            problems.mark_incomplete();
        }
    }
}

/// The table of that name at the top level, if the file has one.
fn section<'a>(top: &TomlTable<'a>, name: &str, problems: &Problems<'_>) -> Option<TomlTable<'a>> {
    let entry = top.get(name)?;
    let table = entry.node.table();
    if table.is_none() {
        problems
            .add(entry.node.at, format!("\"{name}\" must be a table, found {}; write [{name}] on a line of its own", entry.node.found()));
    }
    table
}

/// A text, with a report if it is something else.
fn text(node: TomlNode<'_>, problems: &Problems<'_>, what: &str) -> Option<String> {
    let text = node.value.as_str().map(str::to_owned);
    if text.is_none() {
        problems.add(node.at, format!("{what}: found {}, wanted a text in quotes", node.found()));
    }
    text
}

/// A text that is one of a few words.
fn choice<T: Copy>(entry: &Entry<'_>, problems: &Problems<'_>, what: &str, choices: &[(&str, T)]) -> Option<T> {
    let name = text(entry.node, problems, what)?;
    let found = choices.iter().find(|(word, _)| *word == name).map(|&(_, value)| value);
    if found.is_none() {
        let words: Vec<_> = choices.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        problems.add(entry.node.at, format!("{what}: unknown {} \"{}\"; write {}", entry.key, shortened(&name), words.join(" or ")));
    }
    found
}

/// The `[sample]` table.
fn read_sample(table: &TomlTable<'_>, problems: &Problems<'_>) -> Option<Sample> {
    let methods = [("sobol", Method::Sobol), ("latin-hypercube", Method::LatinHypercube), ("random", Method::Random)];
    table.check_keys(problems, "[sample]", keys::SAMPLE);
    let needed = |key: &str, example: &str| {
        let entry = table.get(key);
        if entry.is_none() {
            problems.add_if_complete(table.at, format!("[sample]: \"{key}\" is missing; write {key} = {example}"));
        }
        entry
    };
    let method = needed("method", "\"sobol\"").and_then(|entry| choice(entry, problems, "[sample]", &methods));
    let count = needed("count", "100000").and_then(|entry| whole(entry, problems, "[sample]", 1, MOST_LEVELS));
    let seed = table.get("seed").map_or(Some(0), |entry| whole(entry, problems, "[sample]", 0, u64::MAX));
    Some(Sample { method: method?, count: count?, seed: seed? })
}

impl Reader<'_> {
    /// `[constraints]`, `[objectives]` and `[report]`.
    fn asked_of_designs(&self, top: &TomlTable<'_>, design: &[Axis], fixed: &[f64]) -> (Vec<Constraint>, Vec<Objective>, Report) {
        let problems = self.problems;
        let mut constraints = section(top, "constraints", problems).map_or_else(Vec::new, |table| self.constraints(&table, fixed));
        constraints.extend(self.one_draw_at_least(&constraints));
        let objectives_table = section(top, "objectives", problems);
        let objectives = objectives_table.as_ref().map_or_else(Vec::new, |table| self.objectives(table, fixed));
        let report_table = section(top, "report", problems);
        let report = self.report(report_table.as_ref(), objectives_table.as_ref(), &objectives, design, fixed);
        self.check_purpose(top, objectives_table.as_ref(), report_table.as_ref());
        (constraints, objectives, report)
    }

    /// Can every design and every scenario have a number? Axes with problems are left out, so the counts may be too small.
    fn check_sizes(&self, top: &TomlTable<'_>, design: &[Axis], scenario: &[&Vec<Axis>]) {
        let at = |names: &[&str]| names.iter().find_map(|name| top.get(name)).map_or(0, |entry| entry.node.at);
        let named = self.claims.borrow().iter().any(|claim| claim.role == AxisRole::Design);
        let problems = self.problems;
        if design.is_empty() && !named && top.get("design").is_none_or(|entry| entry.node.table().is_some_and(|t| t.entries.is_empty())) {
            let example = self.model.inputs.first().map_or("", |input| &input.name);
            problems.add_if_complete(
                at(&["design"]),
                format!("there is nothing to choose; name at least one input in [design], such as {example} = [...]"),
            );
        }
        if !self.sampled && product(design.iter(), u64::MAX).is_none() {
            let (size, most) = (size(design.iter()), u64::MAX as f64);
            problems.add(
                at(&["design"]),
                format!("the space has {size:.1e} designs, at most {most:.1e} can be numbered; drop an axis or use fewer levels"),
            );
        }
        let axes = || scenario.iter().flat_map(|axes| axes.iter());
        if product(axes(), MOST_SCENARIOS).is_none() {
            let made = format!("[operation] and [uncertainty] make {} scenarios", shown(size(axes())));
            problems.add(
                at(&["operation", "uncertainty"]),
                format!("{made}, at most {MOST_SCENARIOS} can be numbered; drop an axis or use fewer levels"),
            );
        }
    }

    /// A study must have an objective or a report.
    fn check_purpose(&self, top: &TomlTable<'_>, objectives: Option<&TomlTable<'_>>, report: Option<&TomlTable<'_>>) {
        let asks = |key: &&str| report.is_some_and(|table| table.get(key).is_some());
        let broken = top.get("objectives").is_some() && objectives.is_none() || top.get("report").is_some() && report.is_none();
        let empty = objectives.is_none_or(|table| table.entries.is_empty());
        if empty && !broken && !["top", "histograms", "maps", "sample", "variants", "feasible"].iter().any(asks) {
            let example = self.some_output();
            self.problems.add_if_complete(
                objectives.map_or(0, |table| table.at),
                format!(
                    "the study asks for nothing; name an objective in [objectives], such as {example} = \"min\", \
                     or top, histograms, maps, a sample, variants or feasible in [report]"
                ),
            );
        }
    }
}

/// Number of combinations of the axes, if it is at most `limit`.
fn product<'a>(axes: impl Iterator<Item = &'a Axis>, limit: u64) -> Option<u64> {
    axes.map(Axis::count).try_fold(1_u64, u64::checked_mul).filter(|&count| count <= limit)
}

/// The same as a rough number, however large.
#[allow(clippy::cast_precision_loss, reason = "for a message")]
fn size<'a>(axes: impl Iterator<Item = &'a Axis>) -> f64 {
    axes.map(|axis| axis.count() as f64).product()
}
