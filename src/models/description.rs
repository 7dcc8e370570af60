//! What a model says of itself: the table behind `beltspace models`, the study file, the result columns and the docs.

use super::evaluation::Evaluation;
use super::formula::{Kernel, Twin};
use crate::error::{Error, Result};
use crate::units::Unit;

/// Numbers that an input may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end; infinite if there is none.
    pub high: f64,
    /// Does the lower end itself belong to the range?
    pub includes_low: bool,
    /// Does the upper end itself belong to the range?
    pub includes_high: bool,
}

impl Range {
    /// All numbers greater than zero.
    pub const POSITIVE: Self = Self { low: 0.0, high: f64::INFINITY, includes_low: false, includes_high: false };
    /// No number at all: what an input has whose every value is a word.
    pub const NONE: Self = Self::between(0.0, 0.0);
    /// Zero and all greater numbers.
    pub const NOT_NEGATIVE: Self = Self { low: 0.0, high: f64::INFINITY, includes_low: true, includes_high: false };

    /// Numbers strictly between two ends.
    pub const fn between(low: f64, high: f64) -> Self {
        Self { low, high, includes_low: false, includes_high: false }
    }

    /// Numbers from `low` inclusive to `high` exclusive.
    pub const fn from_until(low: f64, high: f64) -> Self {
        Self { low, high, includes_low: true, includes_high: false }
    }

    /// Does no number lie in the range?
    pub fn is_empty(&self) -> bool {
        self.low > self.high || (self.low == self.high && !(self.includes_low && self.includes_high))
    }

    /// Does `value` lie in the range? NaN and infinity never do.
    pub fn contains(&self, value: f64) -> bool {
        let above = value > self.low || (self.includes_low && value == self.low);
        let below = value < self.high || (self.includes_high && value == self.high);
        value.is_finite() && above && below
    }

    /// The range in words: `greater than 0`, `at least 0 and less than 1`.
    pub fn in_words(&self) -> String {
        let low = if self.includes_low { format!("at least {}", self.low) } else { format!("greater than {}", self.low) };
        if self.high.is_infinite() {
            return low;
        }
        let high = if self.includes_high { format!("at most {}", self.high) } else { format!("less than {}", self.high) };
        format!("{low} and {high}")
    }
}

/// One input of a model. Its name carries the unit.
#[derive(Clone, Copy, Debug)]
pub struct Input {
    /// Name in study files, on the command line and in results, such as `groove_angle_deg`.
    pub name: &'static str,
    /// Symbol in the source.
    pub symbol: &'static str,
    /// Unit of the values.
    pub unit: Unit,
    /// Value where none is given.
    pub default: f64,
    /// The numbers that the formula accepts; [`Range::NONE`] where every value is one of [`Input::words`].
    pub valid: Range,
    /// What the source covers: outside, `check` warns and the sweep goes on.
    pub usual: (f64, f64),
    /// Only whole numbers make sense.
    pub integer: bool,
    /// Words that stand for values (`"limit"`), each with the number that encodes it.
    pub words: &'static [(&'static str, f64)],
    /// The words of the model's first [enumeration](Input::is_enumeration) for which this input is read at all; empty: always.
    pub only_for: &'static [&'static str],
    /// The input whose value its words stand for, if it is that simple: single designs show that value instead of the word.
    pub follows: Option<&'static str>,
    /// Does the twin know the default only? Then a study that sets it otherwise is for the processor.
    pub processor_only: bool,
    /// What it is, in a sentence.
    pub doc: &'static str,
    /// Where the default and the usual range come from.
    pub source: &'static str,
}

impl Input {
    /// An input that takes any number greater than zero; other ranges are set in place.
    pub const fn new(
        name: &'static str,
        symbol: &'static str,
        unit: Unit,
        default: f64,
        usual: (f64, f64),
        doc: &'static str,
        source: &'static str,
    ) -> Self {
        Self {
            name,
            symbol,
            unit,
            default,
            valid: Range::POSITIVE,
            usual,
            integer: false,
            words: &[],
            only_for: &[],
            follows: None,
            processor_only: false,
            doc,
            source,
        }
    }

    /// An input whose every value is one of these words; `default` is the number that encodes one of them.
    pub const fn enumeration(
        name: &'static str,
        symbol: &'static str,
        words: &'static [(&'static str, f64)],
        default: f64,
        doc: &'static str,
        source: &'static str,
    ) -> Self {
        let input = Self::new(name, symbol, crate::units::NONE, default, (default, default), doc, source);
        Self { valid: Range::NONE, words, ..input }
    }

    /// Is every value of the input a word?
    pub fn is_enumeration(&self) -> bool {
        self.valid.is_empty()
    }

    /// The value as a person writes it, if it is one of the input's words.
    pub fn word_for(&self, value: f64) -> Option<&'static str> {
        self.words.iter().find(|(_, encoded)| *encoded == value).map(|&(word, _)| word)
    }

    /// The number that a word stands for.
    pub fn value_of(&self, word: &str) -> Option<f64> {
        self.words.iter().find(|(it, _)| *it == word).map(|&(_, encoded)| encoded)
    }

    /// Its words as a person lists them, `"a", "b" or "c"`; `None` if it has none.
    pub fn words_listed(&self) -> Option<String> {
        (!self.words.is_empty()).then(|| either(self.words.iter().map(|(word, _)| *word)))
    }

    /// What it may be: `whole, at least 0`, `greater than 0, or "limit"`, or its words alone.
    pub fn valid_in_words(&self) -> String {
        let numbers = format!("{}{}", if self.integer { "whole, " } else { "" }, self.valid.in_words());
        match self.words_listed() {
            Some(words) if self.is_enumeration() => words,
            Some(words) => format!("{numbers}, or {words}"),
            None => numbers,
        }
    }

    /// May the input take this value (its words included)?
    pub fn accepts(&self, value: f64) -> bool {
        self.word_for(value).is_some() || (self.valid.contains(value) && (!self.integer || value.fract() == 0.0))
    }
}

/// Words in quotes, the last two joined by "or".
pub(crate) fn either<'a>(words: impl Iterator<Item = &'a str>) -> String {
    let mut quoted: Vec<_> = words.map(|word| format!("\"{word}\"")).collect();
    let last = quoted.pop().unwrap_or_default();
    if quoted.is_empty() { last } else { format!("{} or {last}", quoted.join(", ")) }
}

/// Which end of a value's scatter over the scenarios is the worst, where no objective or constraint says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Worse {
    /// The largest value (stresses, forces).
    Higher,
    /// The least value (margins, capacities).
    Lower,
}

/// One output of a model. Its name carries the unit.
#[derive(Clone, Copy, Debug)]
pub struct Output {
    /// Name in study files and results.
    pub name: &'static str,
    /// Symbol in the source.
    pub symbol: &'static str,
    /// Unit of the values.
    pub unit: Unit,
    /// The worse end.
    pub worse: Worse,
    /// What it is, in a sentence.
    pub doc: &'static str,
    /// The equation it comes from.
    pub source: &'static str,
    /// How far f32 may be from f64, in units of its running error bound: at least four times the worst that was seen.
    pub promise: f64,
    /// Are all its values whole numbers?
    pub integer: bool,
}

impl Output {
    /// An output that is promised to its running error bound; a larger promise is set with [`Output::promising`].
    pub const fn new(name: &'static str, symbol: &'static str, unit: Unit, worse: Worse, source: &'static str, doc: &'static str) -> Self {
        Self { name, symbol, unit, worse, doc, source, promise: 1.0, integer: false }
    }

    /// The same output with another promise: where few roundings add up, some value comes close to the bound itself.
    pub const fn promising(self, promise: f64) -> Self {
        Self { promise, ..self }
    }

    /// The same output, whose values are whole numbers: a map of it has lines where it changes.
    pub const fn whole(self) -> Self {
        Self { integer: true, ..self }
    }
}

/// How long a thread takes for one design in one scenario, roughly. It decides how work is cut and what `check` expects of a study
/// that is too slow to be tried, never a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Seconds of the first stage.
    pub prepare: f64,
    /// Seconds of the second stage, with the conditions.
    pub finish: f64,
}

/// Most designs of which it is counted why they are not feasible, where a model has no reason for fewer.
pub const SAMPLE: u64 = 65_536;

/// What the margin of a condition is promised to, in units of its running error bound; some are single differences of inputs.
pub const CONDITION_PROMISE: f64 = 4.5;

/// A condition under which the formula, or a part of it, has a meaning: a signed margin that must not be negative.
#[derive(Clone, Copy, Debug)]
pub struct Condition {
    /// The status of a design that fails it, such as `slip`.
    pub reason: &'static str,
    /// Must the margin be greater than zero (rather than at least zero)?
    pub strict: bool,
    /// Fails without making the status other than ok: only the outputs it invalidates are absent.
    pub quiet: bool,
    /// Outputs that have no meaning when it fails.
    pub invalidates: &'static [&'static str],
    /// What it means, in a sentence.
    pub doc: &'static str,
}

/// A column of a [`Profile`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileColumn {
    /// Name in the table, with its unit.
    pub name: &'static str,
    /// Unit of the values.
    pub unit: Unit,
    /// The quantity that it is drawn as, together with others of the same; `None` if it is not drawn.
    pub drawn: Option<&'static str>,
    /// What tells it from those others; empty for one alone.
    pub label: &'static str,
}

impl ProfileColumn {
    /// A column that is drawn for itself.
    pub const fn new(name: &'static str, unit: Unit) -> Self {
        Self { name, unit, drawn: Some(name), label: "" }
    }

    /// The same column, drawn as `quantity` beside others of that name.
    pub const fn drawn(self, quantity: &'static str, label: &'static str) -> Self {
        Self { drawn: Some(quantity), label, ..self }
    }

    /// The same column, in the table only.
    pub const fn hidden(self) -> Self {
        Self { drawn: None, ..self }
    }
}

/// Values along a belt: one column against which the others are read.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// The columns, the first being the position.
    pub columns: Vec<ProfileColumn>,
    /// One row per position, values in the columns' units.
    pub rows: Vec<Vec<f64>>,
}

/// Sentences on a study, from the values of the inputs that no axis sets.
pub type Remarks = fn(&[Option<f64>]) -> Vec<String>;
/// Sentences on one evaluation, from its inputs in their units.
pub type Notes = fn(&[f64], &Evaluation) -> Vec<String>;

/// A model's formula on a device, with what is known of its errors.
#[derive(Clone, Copy)]
pub struct Device {
    /// The formula in WGSL: the texts that make it up, what is shared first.
    pub shader: &'static [&'static str],
    /// The formula in f32 with error bounds.
    pub twin: &'static dyn Twin,
}

impl std::fmt::Debug for Device {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Device").field(&self.twin.fields().prepared).finish()
    }
}

/// A model: everything that the rest of the program knows about it.
pub struct Model {
    /// Name in study files and on the command line.
    pub name: &'static str,
    /// One line on what it computes.
    pub summary: &'static str,
    /// Where the formula comes from.
    pub source: &'static str,
    /// What the model does not cover, in plain sentences.
    pub limits: &'static str,
    /// Its inputs; the position is the input's number.
    pub inputs: &'static [Input],
    /// Its outputs; the position is the output's number.
    pub outputs: &'static [Output],
    /// Its conditions, the first failing one being the status.
    pub conditions: &'static [Condition],
    /// Named sets of inputs that differ from the defaults.
    pub presets: &'static [(&'static str, &'static [(&'static str, f64)])],
    /// A study to start from, in the study file's language.
    pub starter: &'static str,
    /// The formula in f64.
    pub kernel: &'static dyn Kernel,
    /// How long it takes.
    pub effort: Effort,
    /// Most designs of which it is counted why they are not feasible: [`SAMPLE`], or fewer of a slow model. Part of every result.
    pub sample: u64,
    /// The formula on a device; `None`: it is computed in f64 on the processor only.
    pub device: Option<Device>,
    /// What a person should know of a whole study's answer, given the values of the inputs that no axis sets.
    pub remarks: Option<Remarks>,
    /// What a person should know of one evaluation besides its numbers, for inputs in their units.
    pub notes: Option<Notes>,
    /// Values along the belt for inputs in their units, where the model has such.
    pub profile: Option<fn(&[f64]) -> Profile>,
}

impl Model {
    /// Number of the input of that name.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|input| input.name == name)
    }

    /// Number of the output of that name.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|output| output.name == name)
    }

    /// Its formula on a device.
    ///
    /// # Errors
    /// [`Error::Request`] if the model is computed on the processor only.
    pub fn on_device(&self) -> Result<&Device> {
        self.device.as_ref().ok_or_else(|| Error::Request(format!("{} is computed in f64 on the processor only", self.name)))
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
        let Some((_, changes)) = self.presets.iter().find(|(it, _)| *it == name) else {
            let names: Vec<_> = self.presets.iter().map(|(name, _)| *name).collect();
            let known = if names.is_empty() { "it has none".to_owned() } else { format!("presets are: {}", names.join(", ")) };
            return Err(format!("{} has no preset \"{name}\"; {known}", self.name));
        };
        let mut inputs = self.defaults();
        for (input, value) in *changes {
            inputs[self.input(input).expect("a preset names inputs of its model")] = *value;
        }
        Ok(inputs)
    }

    /// The first input whose every value is a word; [`Input::only_for`] names its words.
    pub fn enumeration(&self) -> Option<usize> {
        self.inputs.iter().position(Input::is_enumeration)
    }

    /// The same inputs with a value in place of every word that stands for another input's.
    pub fn spelled_out(&self, inputs: &[f64]) -> Vec<f64> {
        let value = |(input, &value): (&Input, &f64)| match input.follows.filter(|_| input.word_for(value).is_some()) {
            Some(other) => inputs[self.input(other).expect("an input follows one of its model")],
            None => value,
        };
        self.inputs.iter().zip(inputs).map(value).collect()
    }
}

impl std::fmt::Debug for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Model").field(&self.name).finish()
    }
}

impl PartialEq for Model {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}
