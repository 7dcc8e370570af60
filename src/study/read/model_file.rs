//! The file of a model: what it is, its inputs, formulas, conditions, outputs and presets.

use super::formulas::{CurvePoints, ExtensionPlaces, formula_text, read_curves, read_formulas, read_units, tell, words_of};
use super::table::{Entry, Lines, Problems, TomlTable, list, shortened};
use super::value::{input_value, truth};
use super::{Problem, StudyErrors, TOP_LEVEL, section, syntax, text};
use crate::error::Result;
use crate::files::{STUDY_BYTES, read_bytes};
use crate::likeness::remedy;
use crate::models::{ConditionSource, Extension, FileSource, FormulaSource, Input, Model, Models, OVERFLOW, Preset, extended, nothing};
use crate::names::column_of_tables;
use std::path::Path;
use std::sync::Arc;

/// Keys and tables at the top level of the file of a model.
pub(in super::super) const KEYS: [&str; 11] =
    ["summary", "source", "limits", "base", "units", "inputs", "curves", "formulas", "conditions", "outputs", "presets"];

/// The text of the file of a model.
pub(in super::super) struct ModelText<'a> {
    /// Its name: the file's without `.toml`.
    pub(in super::super) name: &'a str,
    pub(in super::super) text: &'a str,
    /// What messages call the file.
    pub(in super::super) file: &'a str,
    pub(in super::super) curves: CurvePoints<'a>,
}

/// Reads the model in a file, which may be based on a model of the program.
///
/// # Errors
/// [`Error::Io`](crate::error::Error::Io) if the file cannot be read, [`Error::Study`](crate::error::Error::Study) with all mistakes in
/// it.
pub fn read_model(path: &Path) -> Result<Arc<Model>> {
    let (text, file) = text_of(path, "long tables go into CSV files")?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let curves = CurvePoints::Folder(path.parent().unwrap_or(Path::new("")), "model");
    let source = ModelText { name: &name, text: &text, file: &file, curves };
    read_model_text(&Models::new(), source).map_err(|problems| StudyErrors { problems }.into())
}

/// Checks a model given as text in the form of a model's file. `name` becomes its name, `file` is what messages call the text, and `folder`
/// what paths of CSV files are relative to; it may be based on any of `models`.
///
/// # Errors
/// Everything that is wrong, in the order of the text.
pub fn parse_model(models: &Models, name: &str, text: &str, file: &str, folder: &Path) -> std::result::Result<Arc<Model>, StudyErrors> {
    let source = ModelText { name, text, file, curves: CurvePoints::Folder(folder, "model") };
    read_model_text(models, source).map_err(|problems| StudyErrors { problems })
}

/// What a file is, by the keys at its top level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// It names a model or what a study asks for.
    Study,
    /// It has inputs, formulas or conditions of its own and no model.
    Model,
    /// Neither.
    Other,
}

/// Is this text a study or a model? A text that is no TOML counts by what of it can be read, and as a study if that says nothing.
pub fn file_kind(text: &str) -> FileKind {
    let (tree, errors) = toml::de::DeTable::parse_recoverable(text);
    let top = TomlTable::new(tree.get_ref(), 0);
    let has = |keys: &[&str]| keys.iter().any(|key| top.get(key).is_some());
    if has(&["model", "design", "operation", "uncertainty", "fixed", "constraints", "objectives", "report", "sample"]) {
        FileKind::Study
    } else if has(&["base", "inputs", "formulas", "conditions", "outputs", "presets"]) {
        FileKind::Model
    } else if errors.is_empty() {
        FileKind::Other
    } else {
        FileKind::Study
    }
}

/// The text of a file, and what messages call it.
pub(super) fn text_of(path: &Path, remedy: &str) -> Result<(String, String)> {
    let bytes = read_bytes(path, STUDY_BYTES, remedy)?;
    let file = path.display().to_string();
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let (line, column) = Lines::new(&String::from_utf8_lossy(&error.as_bytes()[..good])).position(good);
        let message = "this is not UTF-8 text; save the file in the encoding UTF-8".to_owned();
        StudyErrors { problems: vec![Problem { file: file.clone(), line, column, message }] }
    })?;
    Ok((text, file))
}

/// The model in a file that a study names, which stands at the byte `at`.
pub(super) fn named_model(models: &Models, name: &str, at: usize, problems: &Problems<'_>, folder: &Path) -> Option<Arc<Model>> {
    let path = folder.join(name);
    let (text, _) = match text_of(&path, "long tables go into CSV files") {
        Ok(read) => read,
        Err(crate::error::Error::Study(StudyErrors { problems: of_file })) => {
            problems.adopt(at, of_file);
            return None;
        }
        Err(error) => {
            problems.add(at, format!("model: {error}; paths are relative to the folder of the study"));
            return None;
        }
    };
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let curves = CurvePoints::Folder(path.parent().unwrap_or(Path::new("")), "model");
    let source = ModelText { name: &stem, text: &text, file: &problems.beside(name), curves };
    read_model_text(models, source).map_err(|of_file| problems.adopt(at, of_file)).ok()
}

/// The model in a text, or everything that is wrong with it.
pub(in super::super) fn read_model_text(models: &Models, source: ModelText<'_>) -> std::result::Result<Arc<Model>, Vec<Problem>> {
    let problems = Problems::new(source.text, source.file);
    let model = syntax::understandable(source.text, &problems).and_then(|text| {
        let (tree, _) = toml::de::DeTable::parse_recoverable(&text);
        ModelReader { models, source: &source, problems: &problems, top: TomlTable::new(tree.get_ref(), 0) }.read()
    });
    match (model, problems.into_sorted()) {
        (Some(model), problems) if problems.is_empty() => Ok(model),
        (_, mut problems) => {
            if problems.is_empty() {
                let message = "the model cannot be understood".to_owned();
                problems.push(Problem { file: source.file.to_owned(), line: 1, column: 1, message });
            }
            Err(problems)
        }
    }
}

pub(super) struct ModelReader<'a> {
    models: &'a Models,
    source: &'a ModelText<'a>,
    pub(super) problems: &'a Problems<'a>,
    pub(super) top: TomlTable<'a>,
}

impl ModelReader<'_> {
    fn read(&self) -> Option<Arc<Model>> {
        self.check_name();
        self.check_keys();
        let problems = self.problems;
        let words = |key: &str| self.top.get(key).and_then(|entry| text(entry.node, problems, key));
        let base = self.base()?;
        let before = problems.count();
        let mut places = ExtensionPlaces::default();
        let units = read_units(&self.top, problems, &mut places);
        let inputs = self.inputs(&units, &base);
        let curves = read_curves(&self.top, problems, self.source.curves, &mut places);
        let mut formulas = read_formulas(&self.top, problems, &mut places);
        for (name, at) in self.keys("formulas").into_iter().filter(|(name, _)| inputs.iter().any(|input| input.name == *name)) {
            problems.add(at, format!("{} is an input of this model already; choose another name", shortened(name)));
        }
        self.refuse_names_of_columns(&base);
        let known = problems.count() == before && !problems.is_incomplete();
        let outputs = self.outputs(&mut formulas);
        let conditions = self.conditions(&base, &formulas, outputs.as_deref(), &mut places);
        let presets = self.presets(&base, &inputs);
        if formulas.is_empty() && section(&self.top, "formulas", problems).is_none_or(|table| table.entries.is_empty()) {
            problems.add_if_complete(0, "a model needs formulas; write [formulas] and below it NAME = \"...\"");
        }
        let file = FileSource {
            name: self.source.name.to_owned(),
            text: self.source.text.to_owned(),
            summary: words("summary"),
            source: words("source"),
            limits: words("limits"),
            inputs,
            conditions,
            outputs,
            presets,
        };
        // Formulas can be checked only where everything that they may read is known.
        if !known {
            return None;
        }
        let extension = Extension { units, variables: Vec::new(), curves, formulas, file: Some(Box::new(file)) };
        let made = extended(&base, extension).map_err(|found| found.into_iter().for_each(|it| tell(it, &places, &self.top, problems)));
        made.ok().map(Arc::new)
    }

    /// The name of the file is that of the model.
    fn check_name(&self) {
        let name = self.source.name;
        if name.is_empty() || !name.bytes().all(|it| it.is_ascii_alphanumeric() || it == b'-' || it == b'_') {
            let message = format!("\"{}\" is no name of a model; name the file with letters, digits, \"-\" and \"_\"", shortened(name));
            self.problems.add(0, message);
        } else if self.models.find(name).is_some() {
            self.problems.add(0, format!("there is a model \"{name}\" already; choose another name for the file"));
        }
    }

    /// Reports inputs and formulas whose column in a table of a result would have the name of another one.
    fn refuse_names_of_columns(&self, base: &Model) {
        let own: Vec<(&str, usize)> = ["inputs", "formulas"].into_iter().flat_map(|table| self.keys(table)).collect();
        let is_known = |name: &str| base.input(name).is_some() || base.output(name).is_some() || own.iter().any(|it| it.0 == name);
        for &(name, at) in &own {
            if let Some(column) = column_of_tables(name, is_known) {
                self.problems.add(at, format!("\"{}\" is the name of a column {column}; choose another name", shortened(name)));
            }
        }
    }

    fn check_keys(&self) {
        for entry in self.top.unknown(&KEYS).take_while(|_| !self.problems.is_full()) {
            let key = entry.key;
            let similar = || remedy(key, &KEYS, || format!("a model has {}", list(KEYS)));
            let remedy = if TOP_LEVEL.contains(&key) { "it belongs into a study".to_owned() } else { similar() };
            self.problems.add(entry.key_at, format!("unknown key \"{}\"; {remedy}", shortened(key)));
            if entry.node.table().is_some() {
                self.problems.mark_incomplete();
            }
        }
    }

    /// The model that it is based on.
    fn base(&self) -> Option<Arc<Model>> {
        let Some(entry) = self.top.get("base") else { return Some(nothing()) };
        let name = text(entry.node, self.problems, "base")?;
        let model = self.models.find(&name);
        if model.is_none() {
            let names = list(self.models.iter().map(|model| model.name.as_str()));
            self.problems.add(entry.node.at, format!("base: there is no model \"{}\"; models are: {names}", shortened(&name)));
        }
        model
    }

    /// The keys of a table, with their places.
    fn keys(&self, table: &str) -> Vec<(&str, usize)> {
        let table = self.top.get(table).and_then(|entry| entry.node.table());
        table.map_or_else(Vec::new, |table| table.entries.iter().map(|entry| (entry.key, entry.key_at)).collect())
    }

    /// The formulas that are outputs, which are given what is said of them here.
    fn outputs(&self, formulas: &mut [FormulaSource]) -> Option<Vec<String>> {
        let problems = self.problems;
        let table = section(&self.top, "outputs", problems)?;
        let names: Vec<String> = formulas.iter().map(|it| it.name.clone()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut outputs = Vec::new();
        for Entry { key, key_at, node } in &table.entries {
            let label = format!("output \"{}\"", shortened(key));
            let Some(formula) = formulas.iter_mut().find(|it| it.name == *key) else {
                // A formula that could not be read has been reported.
                if !self.keys("formulas").iter().any(|(name, _)| name == key) {
                    let remedy = remedy(key, &names, || "write a formula of that name in [formulas]".to_owned());
                    problems.add_if_complete(*key_at, format!("{label}: there is no such formula; {remedy}"));
                }
                continue;
            };
            if formula.hidden {
                problems.add(*key_at, format!("{label}: the formula is hidden; drop that, or this line"));
            }
            if let Some(parts) = node.table() {
                parts.check_keys(problems, &label, super::keys::OUTPUT);
                *formula = words_of(&parts, problems, &label, std::mem::take(formula));
            } else if let Some(doc) = node.value.as_str() {
                doc.clone_into(&mut formula.doc);
            } else {
                problems.add(node.at, format!("{label}: found {}, wanted a sentence or {{ doc = \"...\" }}", node.found()));
            }
            outputs.push((*key).to_owned());
        }
        Some(outputs)
    }

    fn conditions(
        &self,
        base: &Model,
        formulas: &[FormulaSource],
        outputs: Option<&[String]>,
        places: &mut ExtensionPlaces,
    ) -> Vec<ConditionSource> {
        let problems = self.problems;
        let Some(table) = section(&self.top, "conditions", problems) else { return Vec::new() };
        let is_output = |it: &&FormulaSource| outputs.map_or(!it.hidden, |outputs| outputs.contains(&it.name));
        let own = formulas.iter().filter(is_output).map(|it| &*it.name);
        let outputs: Vec<&str> = base.outputs.iter().map(|it| &*it.name).chain(own).collect();
        let condition = |entry: &Entry<'_>| {
            let reason = entry.key;
            let label = format!("condition \"{}\"", shortened(reason));
            if reason.is_empty() || ["ok", OVERFLOW].contains(&reason) || base.conditions.iter().any(|it| it.reason == reason) {
                problems.add(entry.key_at, format!("{label}: there is such a status already; choose another"));
            }
            let Some(parts) = entry.node.table() else {
                let found = entry.node.found();
                problems.add(entry.node.at, format!("{label}: found {found}, wanted {{ margin = \"...\", doc = \"...\" }}"));
                return None;
            };
            parts.check_keys(problems, &label, super::keys::CONDITION);
            let [strict, quiet] = ["strict", "quiet"].map(|key| parts.get(key).and_then(|it| truth(it, problems, &label)).unwrap_or(false));
            let invalidates = parts.get("invalidates").map_or_else(Vec::new, |it| self.names(it, &label, &outputs, formulas));
            if quiet && parts.get("invalidates").is_none() {
                problems.add(parts.at, format!("{label}: a quiet condition only takes outputs away; name them: invalidates = [\"...\"]"));
            }
            let doc = parts.get("doc").and_then(|it| text(it.node, problems, &label)).unwrap_or_default();
            let Some(margin) = parts.get("margin") else {
                problems.add_if_complete(
                    parts.at,
                    format!("{label}: \"margin\" is missing; write margin = \"...\", at least 0 where all is well"),
                );
                return None;
            };
            let margin = formula_text(margin.node, problems, &label, places)?;
            Some(ConditionSource { reason: reason.to_owned(), margin, strict, quiet, invalidates, doc })
        };
        table.entries.iter().take_while(|_| !problems.is_full()).filter_map(condition).collect()
    }

    /// A list of names of which each is one of these.
    fn names(&self, entry: &Entry<'_>, label: &str, known: &[&str], formulas: &[FormulaSource]) -> Vec<String> {
        let problems = self.problems;
        let Some(nodes) = entry.node.list() else {
            problems.add(entry.node.at, format!("{label}: found {}; {} must be a list of outputs", entry.node.found(), entry.key));
            return Vec::new();
        };
        let mut names = Vec::new();
        for node in nodes {
            let Some(name) = text(node, problems, label) else { continue };
            // A formula that could not be read has been reported.
            let is_unread = || self.keys("formulas").iter().any(|(key, _)| *key == name) && !formulas.iter().any(|it| it.name == name);
            if !known.contains(&&*name) && !is_unread() {
                let remedy = remedy(&name, known, || "name outputs of this model".to_owned());
                problems.add_if_complete(node.at, format!("{label}: there is no output \"{}\"; {remedy}", shortened(&name)));
            }
            names.push(name);
        }
        names
    }

    fn presets(&self, base: &Model, inputs: &[Input]) -> Vec<Preset> {
        let problems = self.problems;
        let Some(table) = section(&self.top, "presets", problems) else { return Vec::new() };
        let inputs: Vec<&Input> = base.inputs.iter().chain(inputs).collect();
        let names: Vec<&str> = inputs.iter().map(|it| it.name.as_str()).collect();
        let preset = |entry: &Entry<'_>| {
            let label = format!("preset \"{}\"", shortened(entry.key));
            if base.presets.iter().any(|it| it.name == entry.key) {
                problems.add(entry.key_at, format!("{label}: {} has such a preset already; choose another name", base.name));
            }
            let Some(parts) = entry.node.table() else {
                problems.add(entry.node.at, format!("{label}: found {}, wanted {{ INPUT = VALUE, ... }}", entry.node.found()));
                return None;
            };
            let mut changes = Vec::new();
            for Entry { key, key_at, node } in &parts.entries {
                // An input that could not be read has been reported.
                let Some(input) = inputs.iter().find(|it| it.name == *key) else {
                    if !self.keys("inputs").iter().any(|(name, _)| name == key) {
                        let remedy = remedy(key, &names, || format!("inputs are {}", list(&names)));
                        problems.add_if_complete(*key_at, format!("{label}: there is no input \"{}\"; {remedy}", shortened(key)));
                    }
                    continue;
                };
                match input_value(*node, input) {
                    Ok(value) => changes.push((*key, value)),
                    Err(error) => problems.add(node.at, format!("{label}, {}: {error}", shortened(key))),
                }
            }
            Some(Preset::new(entry.key, &changes))
        };
        table.entries.iter().take_while(|_| !problems.is_full()).filter_map(preset).collect()
    }
}
