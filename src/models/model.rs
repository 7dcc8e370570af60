//! A model: its tables, its formula, and what the rest of the program knows of it besides.

use super::description::{Condition, Effort, Input, Output, Preset, Profile, SAMPLE};
use super::formula::Kernel;
use super::source::{Extension, FormulaSource};
use super::status::Evaluation;
use crate::error::{Error, Result};
use crate::pulley::Design;
use crate::tape::{FormulaEquations, Recordable, Symbols};
use std::sync::Arc;

/// Sentences on a study, from the values of the inputs that no axis sets.
pub type Remarks = Arc<dyn Fn(&[Option<f64>]) -> Vec<String> + Send + Sync>;
/// Sentences on one evaluation of the model, from its inputs in their units.
pub type Notes = Arc<dyn Fn(&Model, &[f64], &Evaluation) -> Vec<String> + Send + Sync>;
/// Sentences on inputs in their units that contradict each other.
pub type Doubts = Arc<dyn Fn(&Model, &[f64]) -> Vec<String> + Send + Sync>;
/// Values along the belt of the model, from inputs in their units.
pub type AlongTheBelt = Arc<dyn Fn(&Model, &[f64]) -> Profile + Send + Sync>;
/// The pulley behind inputs of the model in their units.
pub type PulleyOf = Arc<dyn Fn(&Model, &[f64]) -> Design + Send + Sync>;

/// A model and what was added to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin {
    /// The model without it.
    pub base: Arc<Model>,
    /// What was added.
    pub extension: Extension,
}

/// A model: everything that the rest of the program knows about it.
///
/// It is plain data with a formula, so one may be made at run time ([`Model::new`]) as well as be one of [`all`](super::all). It is
/// passed about as `Arc<Model>`; to change one, clone what it points to. Two are equal if their tables are and they share one formula.
#[derive(Clone)]
#[non_exhaustive]
pub struct Model {
    /// Name in study files and on the command line.
    pub name: String,
    /// What tells this model from an earlier one of its name; empty for those that come with the program. Where it is not empty it is
    /// part of a study's hash, so that results of two versions are never put together.
    pub version: String,
    /// One line on what it computes.
    pub summary: String,
    /// Where the formula comes from.
    pub source: String,
    /// What the model does not cover, in plain sentences.
    pub limits: String,
    /// Its inputs; the position is the input's number.
    pub inputs: Vec<Input>,
    /// Its outputs; the position is the output's number.
    pub outputs: Vec<Output>,
    /// Its conditions, the first failing one being the status.
    pub conditions: Vec<Condition>,
    /// Named sets of inputs that differ from the defaults.
    pub presets: Vec<Preset>,
    /// A study to start from, in the study file's language.
    pub starter: String,
    /// The formula in f64.
    pub kernel: Arc<dyn Kernel>,
    /// How long it takes.
    pub effort: Effort,
    /// Most designs of which it is counted why they are not feasible: [`SAMPLE`], or fewer of a slow model. Part of every result.
    pub sample: u64,
    /// May it be computed on a GPU? Its shader is written from the recorded formula; without one it is computed on the CPU only.
    pub on_gpu: bool,
    /// What a person should know of a whole study's answer, given the values of the inputs that no axis sets.
    pub remarks: Option<Remarks>,
    /// What a person should know of one evaluation besides its numbers.
    pub notes: Option<Notes>,
    /// What inputs may say against each other, though the formula takes them.
    pub doubts: Option<Doubts>,
    /// Values along the belt, where the model has such.
    pub profile: Option<AlongTheBelt>,
    /// The pulley that its inputs describe, where designs are solved by finite elements: there are pictures of such.
    pub pulley: Option<PulleyOf>,
    /// What it was made of, if a study's formulas stand around it.
    pub(crate) origin: Option<Arc<Origin>>,
}

impl Model {
    /// Number of the input of that name.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|input| input.name == name)
    }

    /// The formulas that the model is made of, by name and text: those of its file, then those that a study put around it.
    pub fn formulas(&self) -> Vec<(&str, &str)> {
        self.formula_sources().into_iter().map(|it| (&*it.name, &*it.text)).collect()
    }

    /// The same with all that is said of them.
    pub(crate) fn formula_sources(&self) -> Vec<&FormulaSource> {
        let Some(origin) = &self.origin else { return Vec::new() };
        origin.base.formula_sources().into_iter().chain(&origin.extension.formulas).collect()
    }

    /// Is this the name of an intermediate value, which only formulas of the same model read?
    pub(crate) fn hides(&self, name: &str) -> bool {
        self.origin.as_ref().is_some_and(|origin| origin.extension.hides(name) || origin.base.hides(name))
    }

    /// The first condition with the same reason as this one: both ends of an input's valid range have the same.
    pub fn first_of_reason(&self, condition: usize) -> usize {
        let reason = &self.conditions[condition].reason;
        self.conditions.iter().position(|it| it.reason == *reason).unwrap_or(condition)
    }

    /// Number of the output of that name.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|output| output.name == name)
    }

    /// Its formula as it is written for a GPU.
    ///
    /// # Errors
    /// [`Error::CpuOnly`] if the model is computed on the CPU only.
    pub fn on_device(&self) -> Result<&dyn Recordable> {
        let formula = self.kernel.formula().filter(|_| self.on_gpu);
        formula.ok_or_else(|| Error::CpuOnly { model: self.name.clone(), remedy: None })
    }

    /// The model that formulas of a study or file stand around; `None` for one that is no such model.
    pub fn base(&self) -> Option<&Self> {
        self.origin.as_ref().map(|origin| origin.base.base().unwrap_or(&origin.base))
    }

    /// What it computes as equations for people, in its symbols; `None` if its formula cannot be recorded.
    pub fn equations(&self) -> Option<FormulaEquations> {
        let formula = self.kernel.formula()?;
        let symbols = Symbols {
            inputs: self.inputs.iter().map(|input| input.symbol.clone()).collect(),
            outputs: self.outputs.iter().map(|output| output.symbol.clone()).collect(),
        };
        Some(FormulaEquations::of(formula, &symbols, self.outputs.len(), self.conditions.len()))
    }

    /// The defaults of all inputs, in their units.
    pub fn defaults(&self) -> Vec<f64> {
        self.inputs.iter().map(|input| input.default).collect()
    }

    /// The defaults with what a preset changes.
    ///
    /// # Errors
    /// A sentence that lists the presets, if there is none of that name.
    pub fn preset(&self, name: &str) -> std::result::Result<Vec<f64>, String> {
        let Some(preset) = self.presets.iter().find(|it| it.name == name) else {
            let names: Vec<_> = self.presets.iter().map(|it| it.name.as_str()).collect();
            let known = if names.is_empty() { "it has none".to_owned() } else { format!("presets are: {}", names.join(", ")) };
            return Err(format!("{} has no preset \"{name}\"; {known}", self.name));
        };
        let mut inputs = self.defaults();
        for (input, value) in &preset.changes {
            inputs[self.input(input).expect("a preset names inputs of its model")] = *value;
        }
        Ok(inputs)
    }

    /// What a person should know of one evaluation besides its numbers, for inputs in their units.
    pub fn notes_on(&self, inputs: &[f64], evaluation: &Evaluation) -> Vec<String> {
        let mut notes = self.notes.as_ref().map_or_else(Vec::new, |notes| notes(self, inputs, evaluation));
        let set = |input: &usize| inputs[*input] != self.inputs[*input].default;
        notes.extend((0..self.inputs.len()).filter(set).filter_map(|input| self.unread(input, |other| Some(inputs[other]))));
        notes
    }

    /// A sentence on an input that is set and not read, for the values of those inputs that have one only.
    pub fn unread(&self, input: usize, value: impl Fn(usize) -> Option<f64>) -> Option<String> {
        let Input { name, only_for, .. } = &self.inputs[input];
        let only_for = only_for.as_ref().filter(|_| self.is_unread(input, value))?;
        Some(format!("{name} is set, but it is read for {} only", only_for.in_words()))
    }

    /// Is an input not read, for the values of those inputs that have one only?
    pub(crate) fn is_unread(&self, input: usize, value: impl Fn(usize) -> Option<f64>) -> bool {
        let decided = || {
            let only_for = self.inputs[input].only_for.as_ref()?;
            let decides = self.input(&only_for.input)?;
            let word = self.inputs[decides].word_for(value(decides)?)?;
            Some(only_for.words.iter().all(|it| it != word))
        };
        decided().unwrap_or(false)
    }

    /// What inputs in their units say against each other, though the formula takes them.
    pub fn doubts_on(&self, inputs: &[f64]) -> Vec<String> {
        self.doubts.as_ref().map_or_else(Vec::new, |doubts| doubts(self, inputs))
    }

    /// Values along the belt for inputs in their units, whose status must be ok; `None` if the model has no such values.
    pub fn along_the_belt(&self, inputs: &[f64]) -> Option<Profile> {
        self.profile.as_ref().map(|profile| profile(self, inputs))
    }

    /// Section, loads and strength behind inputs in their units; `None` if the model has no pulley that is solved by finite elements.
    pub fn pulley_of(&self, inputs: &[f64]) -> Option<Design> {
        self.pulley.as_ref().map(|pulley| pulley(self, inputs))
    }

    /// The same inputs with a value in place of every word that stands for another input's; the word stays where formulas give that one.
    pub fn spelled_out(&self, inputs: &[f64]) -> Vec<f64> {
        let value = |(input, &value): (&Input, &f64)| {
            let followed = input.follows.as_ref().filter(|_| input.word_for(value).is_some());
            followed.and_then(|other| self.input(other)).map_or(value, |other| inputs[other])
        };
        self.inputs.iter().zip(inputs).map(value).collect()
    }
}

/// Making a model: [`Model::new`], then what it is given besides. Whatever is left out is empty, and [`Models::with`](super::Models::with)
/// says what does not fit.
impl Model {
    /// A model of this name that computes this.
    ///
    /// One that can be recorded also runs on a device; how long it takes is set with [`Model::effort`].
    pub fn new(name: impl Into<String>, kernel: impl Kernel + 'static) -> Self {
        Self {
            name: name.into(),
            version: String::new(),
            summary: String::new(),
            source: String::new(),
            limits: String::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            conditions: Vec::new(),
            presets: Vec::new(),
            starter: String::new(),
            effort: Effort { prepare: 1e-6, finish: 1e-8 },
            sample: SAMPLE,
            on_gpu: kernel.formula().is_some(),
            kernel: Arc::new(kernel),
            remarks: None,
            doubts: None,
            notes: None,
            profile: None,
            pulley: None,
            origin: None,
        }
    }

    /// The same model in this version: part of the hash of its studies, so that results of two versions are never put together.
    #[must_use]
    pub fn version(self, version: impl Into<String>) -> Self {
        Self { version: version.into(), ..self }
    }

    /// The same model with one line on what it computes.
    #[must_use]
    pub fn summary(self, summary: impl Into<String>) -> Self {
        Self { summary: summary.into(), ..self }
    }

    /// The same model with where its formula comes from.
    #[must_use]
    pub fn source(self, source: impl Into<String>) -> Self {
        Self { source: source.into(), ..self }
    }

    /// The same model with what it does not cover, in plain sentences.
    #[must_use]
    pub fn limits(self, limits: impl Into<String>) -> Self {
        Self { limits: limits.into(), ..self }
    }

    /// The same model with these inputs, in the order in which its formula reads them.
    #[must_use]
    pub fn inputs(self, inputs: impl IntoIterator<Item = Input>) -> Self {
        Self { inputs: inputs.into_iter().collect(), ..self }
    }

    /// The same model with these outputs, in the order in which its formula writes them.
    #[must_use]
    pub fn outputs(self, outputs: impl IntoIterator<Item = Output>) -> Self {
        Self { outputs: outputs.into_iter().collect(), ..self }
    }

    /// The same model with these conditions, in the order of their margins; the first one that fails is the status.
    #[must_use]
    pub fn conditions(self, conditions: impl IntoIterator<Item = Condition>) -> Self {
        Self { conditions: conditions.into_iter().collect(), ..self }
    }

    /// The same model with these named sets of inputs.
    #[must_use]
    pub fn presets(self, presets: impl IntoIterator<Item = Preset>) -> Self {
        Self { presets: presets.into_iter().collect(), ..self }
    }

    /// The same model with a study to start from.
    #[must_use]
    pub fn starter(self, study: impl Into<String>) -> Self {
        Self { starter: study.into(), ..self }
    }

    /// The same model, which takes about so long.
    #[must_use]
    pub fn effort(self, effort: Effort) -> Self {
        Self { effort, ..self }
    }
}

impl std::fmt::Debug for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Model").field(&self.name).finish()
    }
}

impl PartialEq for Model {
    fn eq(&self, other: &Self) -> bool {
        fn texts(model: &Model) -> [&String; 6] {
            let Model { name, version, summary, source, limits, starter, .. } = model;
            [name, version, summary, source, limits, starter]
        }
        let one_formula = match (&self.origin, &other.origin) {
            (Some(one), Some(other)) => one == other,
            (None, None) => Arc::ptr_eq(&self.kernel, &other.kernel),
            _ => false,
        };
        one_formula
            && texts(self) == texts(other)
            && (&self.inputs, &self.outputs, &self.conditions) == (&other.inputs, &other.outputs, &other.conditions)
            && (&self.presets, self.effort, self.sample) == (&other.presets, other.effort, other.sample)
    }
}
