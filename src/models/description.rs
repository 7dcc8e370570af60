//! What a model's tables are made of: inputs, outputs, conditions, presets, profiles.

use crate::units::Unit;
use serde::{Deserialize, Serialize};

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
        if self.low.is_infinite() && self.high.is_infinite() {
            return "any number".to_owned();
        }
        let low = if self.includes_low { format!("at least {}", self.low) } else { format!("greater than {}", self.low) };
        if self.high.is_infinite() {
            return low;
        }
        let high = if self.includes_high { format!("at most {}", self.high) } else { format!("less than {}", self.high) };
        if self.low.is_infinite() {
            return high;
        }
        format!("{low} and {high}")
    }
}

/// The words of another input for which an input is read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct OnlyFor {
    /// Name of the other input.
    pub input: String,
    /// The words of it.
    pub words: Vec<String>,
}

impl OnlyFor {
    /// As a person says it: `section = "machined" or "welded-discs"`.
    pub fn in_words(&self) -> String {
        format!("{} = {}", self.input, either(self.words.iter().map(String::as_str)))
    }
}

/// One input of a model. Its name carries the unit.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Input {
    /// Name in study files, on the command line and in results, such as `groove_angle_deg`.
    pub name: String,
    /// Symbol in the source.
    pub symbol: String,
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
    pub words: Vec<(String, f64)>,
    /// When this input is read at all; `None`: always.
    pub only_for: Option<OnlyFor>,
    /// The input whose value its words stand for, if it is that simple: single designs show that value instead of the word.
    pub follows: Option<String>,
    /// The input that a number for this one takes the place of: giving both is a contradiction.
    pub instead_of: Option<String>,
    /// Is any other value than the default computed on the CPU only?
    pub cpu_only: bool,
    /// What it is, in a sentence.
    pub doc: String,
    /// Where the default and the usual range come from.
    pub source: String,
}

impl Input {
    /// An input that takes any number greater than zero; another range is set by [`Input::valid`].
    pub fn new(
        name: impl Into<String>,
        symbol: impl Into<String>,
        unit: Unit,
        default: f64,
        usual: (f64, f64),
        doc: impl Into<String>,
        source: impl Into<String>,
    ) -> Self {
        Self {
            name: name.into(),
            symbol: symbol.into(),
            unit,
            default,
            valid: Range::POSITIVE,
            usual,
            integer: false,
            words: Vec::new(),
            only_for: None,
            follows: None,
            instead_of: None,
            cpu_only: false,
            doc: doc.into(),
            source: source.into(),
        }
    }

    /// An input whose every value is one of these words; `default` is the number that encodes one of them.
    pub fn enumeration(
        name: impl Into<String>,
        symbol: impl Into<String>,
        words: &[(&str, f64)],
        default: f64,
        doc: impl Into<String>,
        source: impl Into<String>,
    ) -> Self {
        let input = Self::new(name, symbol, crate::units::NONE, default, (default, default), doc, source);
        Self { valid: Range::NONE, ..input }.with_words(words)
    }

    /// The same input, which takes the numbers of this range.
    #[must_use]
    pub fn valid(self, valid: Range) -> Self {
        Self { valid, ..self }
    }

    /// The same input, which takes whole numbers only.
    #[must_use]
    pub fn whole(self) -> Self {
        Self { integer: true, ..self }
    }

    /// The same input, which takes these words too, each for the number that encodes it.
    #[must_use]
    pub fn with_words(self, words: &[(&str, f64)]) -> Self {
        Self { words: valued(words), ..self }
    }

    /// The same input, read only where the input of that name is one of these words of it.
    #[must_use]
    pub fn read_only_for(self, input: impl Into<String>, words: &[&str]) -> Self {
        Self { only_for: Some(OnlyFor { input: input.into(), words: owned(words) }), ..self }
    }

    /// The same input, whose words stand for the value of another one.
    #[must_use]
    pub fn following(self, other: impl Into<String>) -> Self {
        Self { follows: Some(other.into()), ..self }
    }

    /// The same input, whose numbers take the place of another one's values.
    #[must_use]
    pub fn instead_of(self, other: impl Into<String>) -> Self {
        Self { instead_of: Some(other.into()), ..self }
    }

    /// Is every value of the input a word?
    pub fn is_enumeration(&self) -> bool {
        self.valid.is_empty()
    }

    /// The value as a person writes it, if it is one of the input's words.
    pub fn word_for(&self, value: f64) -> Option<&str> {
        self.words.iter().find(|(_, encoded)| *encoded == value).map(|(word, _)| word.as_str())
    }

    /// The number that a word stands for.
    pub fn value_of(&self, word: &str) -> Option<f64> {
        self.words.iter().find(|(it, _)| it == word).map(|&(_, encoded)| encoded)
    }

    /// Its words as a person lists them, `"a", "b" or "c"`; `None` if it has none.
    pub fn words_listed(&self) -> Option<String> {
        (!self.words.is_empty()).then(|| either(self.words.iter().map(|(word, _)| word.as_str())))
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

/// Texts of a table, as a model owns them.
fn owned(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

/// Names with their numbers, as a model owns them.
fn valued(pairs: &[(&str, f64)]) -> Vec<(String, f64)> {
    pairs.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
}

/// Words in quotes, the last two joined by "or".
pub(crate) fn either<'a>(words: impl Iterator<Item = &'a str>) -> String {
    let mut quoted: Vec<_> = words.map(|word| format!("\"{word}\"")).collect();
    let last = quoted.pop().unwrap_or_default();
    if quoted.is_empty() { last } else { format!("{} or {last}", quoted.join(", ")) }
}

/// Which end of a value's scatter over the scenarios is the worst, where no objective or constraint says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Worse {
    /// The largest value (stresses, forces).
    Higher,
    /// The least value (margins, capacities).
    Lower,
}

impl Worse {
    /// The end in a word, as a study writes it: `highest` or `lowest`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Higher => "highest",
            Self::Lower => "lowest",
        }
    }

    /// The value that every other one is worse than.
    pub(crate) fn least_bad(self) -> f64 {
        match self {
            Self::Higher => f64::NEG_INFINITY,
            Self::Lower => f64::INFINITY,
        }
    }
}

/// One output of a model. Its name carries the unit.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Output {
    /// Name in study files and results.
    pub name: String,
    /// Symbol in the source.
    pub symbol: String,
    /// Unit of the values.
    pub unit: Unit,
    /// The worse end.
    pub worse: Worse,
    /// What it is, in a sentence.
    pub doc: String,
    /// The equation it comes from.
    pub source: String,
    /// How far f32 may be from f64, in units of its running error bound: at least four times the worst that was seen.
    pub bound_factor: f64,
    /// Are all its values whole numbers?
    pub integer: bool,
}

impl Output {
    /// An output whose error bound is the running one; a multiple of it is set with [`Output::with_bound_factor`].
    pub fn new(
        name: impl Into<String>,
        symbol: impl Into<String>,
        unit: Unit,
        worse: Worse,
        source: impl Into<String>,
        doc: impl Into<String>,
    ) -> Self {
        let [name, symbol, source, doc] = [name.into(), symbol.into(), source.into(), doc.into()];
        Self { name, symbol, unit, worse, doc, source, bound_factor: 1.0, integer: false }
    }

    /// The same output with a multiple of the running error bound: where few roundings add up, some value comes close to the bound itself.
    #[must_use]
    pub fn with_bound_factor(self, bound_factor: f64) -> Self {
        Self { bound_factor, ..self }
    }

    /// The same output, whose values are whole numbers: a map of it has lines where it changes.
    #[must_use]
    pub fn whole(self) -> Self {
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

/// The error bound of a condition's margin, in units of the running one; some are single differences of inputs.
pub const CONDITION_BOUND_FACTOR: f64 = 4.5;

/// A condition under which the formula, or a part of it, has a meaning: a signed margin that must not be negative.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Condition {
    /// The status of a design that fails it, such as `slip`.
    pub reason: String,
    /// Must the margin be greater than zero (rather than at least zero)?
    pub strict: bool,
    /// Fails without making the status other than ok: only the outputs it invalidates are absent.
    pub quiet: bool,
    /// Outputs that have no meaning when it fails.
    pub invalidates: Vec<String>,
    /// What it means, in a sentence.
    pub doc: String,
}

impl Condition {
    /// A condition that gives the status when it fails; one that does not is made by [`Condition::quiet`].
    pub fn new(reason: impl Into<String>, strict: bool, invalidates: &[&str], doc: impl Into<String>) -> Self {
        Self { reason: reason.into(), strict, quiet: false, invalidates: owned(invalidates), doc: doc.into() }
    }

    /// The same condition, which takes outputs away and leaves the status as it is.
    #[must_use]
    pub fn quiet(self) -> Self {
        Self { quiet: true, ..self }
    }
}

/// A named set of inputs that differ from the defaults.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Preset {
    /// Name on the command line and in study files.
    pub name: String,
    /// Names of the inputs that it sets, with their values in the inputs' units.
    pub changes: Vec<(String, f64)>,
    /// What it is and where its values come from; may be empty.
    pub about: String,
}

impl Preset {
    /// A preset of that name that sets these inputs.
    pub fn new(name: impl Into<String>, changes: &[(&str, f64)]) -> Self {
        Self { name: name.into(), changes: valued(changes), about: String::new() }
    }

    /// The same preset, with what it is and where its values come from.
    #[must_use]
    pub fn about(self, about: impl Into<String>) -> Self {
        Self { about: about.into(), ..self }
    }
}

/// A column of a [`Profile`].
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileColumn {
    /// Name in the table, with its unit.
    pub name: String,
    /// Unit of the values.
    pub unit: Unit,
    /// The quantity that it is drawn as, together with others of the same; `None` if it is not drawn.
    pub drawn: Option<String>,
    /// What tells it from those others; empty for one alone.
    pub label: String,
}

impl ProfileColumn {
    /// A column that is drawn for itself.
    pub fn new(name: impl Into<String>, unit: Unit) -> Self {
        let name = name.into();
        Self { drawn: Some(name.clone()), name, unit, label: String::new() }
    }

    /// The same column, drawn as `quantity` beside others of that name.
    #[must_use]
    pub fn drawn(self, quantity: impl Into<String>, label: impl Into<String>) -> Self {
        Self { drawn: Some(quantity.into()), label: label.into(), ..self }
    }

    /// The same column, in the table only.
    #[must_use]
    pub fn hidden(self) -> Self {
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
