//! Which model a name means, and what a model must be so that everything else can rely on it.

use super::description::{Input, OnlyFor};
use super::formula::Sizes;
use super::model::Model;
use crate::error::{Error, Result};
use crate::tape::Set;
use std::collections::HashSet;
use std::sync::Arc;

/// The models that names mean: those that come with the program, and others that were made at run time.
///
/// Whatever reads a model's name (a study, a result, a checkpoint) is given one of these, or knows the program's own only.
#[derive(Clone, Debug, Default)]
pub struct Models {
    others: Vec<Arc<Model>>,
}

impl Models {
    /// Those that come with the program.
    pub fn new() -> Self {
        Self::default()
    }

    /// The same and another one.
    ///
    /// # Errors
    /// [`Error::Request`] if its name is taken, or as [`Model::check`].
    pub fn with(mut self, model: Arc<Model>) -> Result<Self> {
        model.check()?;
        if self.find(&model.name).is_some() {
            return Err(Error::Request(format!("there is a model \"{}\" already", model.name)));
        }
        self.others.push(model);
        Ok(self)
    }

    /// All of them, those of the program first.
    pub fn iter(&self) -> impl Iterator<Item = &Arc<Model>> {
        super::all().iter().chain(&self.others)
    }

    /// The model of that name.
    pub fn find(&self, name: &str) -> Option<Arc<Model>> {
        self.iter().find(|model| model.name == name).cloned()
    }
}

/// Is this a name that may stand before `=` in a study file and in a file's name?
pub(crate) fn is_name(name: &str) -> bool {
    name.starts_with(|it: char| it.is_ascii_alphabetic()) && name.bytes().all(|it| it.is_ascii_alphanumeric() || it == b'_')
}

impl Model {
    /// Checks that the tables fit each other: names are unique and end in their units, defaults and presets are accepted, words and
    /// conditions name what exists.
    ///
    /// # Errors
    /// [`Error::Request`] with the first thing that is wrong.
    pub fn check(&self) -> Result<()> {
        self.flaw().map_or(Ok(()), |flaw| Err(Error::Request(format!("the model \"{}\" cannot be: {flaw}", self.name))))
    }

    fn flaw(&self) -> Option<String> {
        if self.name.is_empty() || !self.name.bytes().all(|it| it.is_ascii_alphanumeric() || it == b'-' || it == b'_') {
            return Some("its name has other characters than letters, digits, - and _".to_owned());
        }
        if let Some(flaw) = self.flaw_of_sizes() {
            return Some(flaw);
        }
        let mut seen = HashSet::new();
        let of_inputs = self.inputs.iter().map(|it| (&it.name, it.unit));
        for (name, unit) in of_inputs.chain(self.outputs.iter().map(|it| (&it.name, it.unit))) {
            let suffix = unit.suffix();
            if !is_name(name) {
                return Some(format!("\"{name}\" is no name: letters, digits and _ make one, a letter first"));
            }
            if !seen.insert(name) {
                return Some(format!("{name} stands twice"));
            }
            if !suffix.is_empty() && !name.ends_with(&format!("_{suffix}")) {
                return Some(format!("{name} is in {}, so its name must end in _{suffix}", unit.symbol));
            }
        }
        let flaw = self.inputs.iter().find_map(|input| self.flaw_of_input(input));
        flaw.or_else(|| self.presets.iter().find_map(|preset| preset.changes.iter().find_map(|it| self.flaw_of_change(&preset.name, it))))
            .or_else(|| {
                let mut names = self.conditions.iter().flat_map(|it| it.invalidates.iter().map(move |name| (&it.reason, name)));
                let (reason, name) = names.find(|(_, name)| self.output(name).is_none())?;
                Some(format!("the condition \"{reason}\" takes away {name}, which is no output"))
            })
    }

    pub(crate) fn flaw_of_sizes(&self) -> Option<String> {
        let Sizes { inputs, outputs, conditions, .. } = self.kernel.sizes();
        let fields = self.kernel.formula().map_or(0, |formula| formula.fields().places().count());
        let limited = [
            ("inputs and outputs", self.inputs.len() + outputs.max(self.outputs.len())),
            ("conditions", self.conditions.len()),
            ("fields that its first stage passes on", fields),
        ];
        if let Some((what, count)) = limited.into_iter().find(|(_, count)| *count > Set::SIZE) {
            return Some(format!("it has {count} {what}, at most {} are possible", Set::SIZE));
        }
        // Two models may share a formula that gives more than one of them lists.
        let tables = [
            ("inputs", self.inputs.len(), inputs..=inputs),
            ("outputs", self.outputs.len(), 0..=outputs),
            ("conditions", self.conditions.len(), 0..=conditions),
        ];
        let (what, listed, possible) = tables.into_iter().find(|(_, listed, possible)| !possible.contains(listed))?;
        Some(format!("it lists {listed} {what}, and its formula has {}", possible.end()))
    }

    fn flaw_of_input(&self, input: &Input) -> Option<String> {
        let Input { name, words, only_for, follows, instead_of, .. } = input;
        let [mut texts, mut numbers] = [(); 2].map(|()| HashSet::new());
        if !words.iter().all(|(word, number)| texts.insert(word.clone()) && numbers.insert(number.to_bits().to_string())) {
            return Some(format!("two words of {name} are the same, or stand for the same number"));
        }
        if let Some((word, number)) = words.iter().find(|(_, number)| input.valid.contains(*number)) {
            return Some(format!("the word \"{word}\" of {name} stands for {number}, which is also a value of its own"));
        }
        if !input.accepts(input.default) {
            return Some(format!("the default of {name} must be {}", input.valid_in_words()));
        }
        if let Some(OnlyFor { input: of, words }) = only_for {
            let Some(number) = self.input(of) else { return Some(format!("{name} is read for words of {of} only, which is no input")) };
            if let Some(word) = words.iter().find(|word| self.inputs[number].value_of(word).is_none()) {
                return Some(format!("{name} is read for {of} = \"{word}\" only, which is no word of it"));
            }
        }
        if let Some(other) = follows.as_ref().filter(|other| self.input(other).is_none()) {
            return Some(format!("a word of {name} stands for {other}, which is no input"));
        }
        let other = instead_of.as_ref()?;
        match self.input(other) {
            // An input of the extended model may be given by a formula, and is an output then.
            None if self.output(other).is_none() => Some(format!("{name} takes the place of {other}, which is no input")),
            _ if input.word_for(input.default).is_none() => {
                Some(format!("{name} takes the place of {other}, so its default must be a word"))
            }
            _ => None,
        }
    }

    /// Inputs whose numbers take the place of another input's, each with that other one: of this model and of those it is made from.
    fn replacements(&self) -> Vec<(String, String)> {
        let own = self.inputs.iter().filter_map(|input| Some((input.name.clone(), input.instead_of.clone()?)));
        let of_base = self.origin.as_ref().map_or_else(Vec::new, |origin| origin.base.replacements());
        let mut all: Vec<_> = own.chain(of_base).collect();
        all.sort();
        all.dedup();
        all
    }

    /// Does a number among these inputs take the place of this one?
    pub fn is_replaced(&self, name: &str, inputs: &[f64]) -> bool {
        let mut all = self.inputs.iter().zip(inputs);
        all.any(|(input, value)| input.instead_of.as_deref() == Some(name) && input.word_for(*value).is_none())
    }

    /// Does a formula of a study or of a model's file give this input?
    pub(crate) fn is_given_by_formula(&self, name: &str) -> bool {
        self.origin.as_ref().is_some_and(|it| it.extension.formulas.iter().any(|it| it.name == name) || it.base.is_given_by_formula(name))
    }

    /// An input that is given a number and takes the place of another one that is given too: the first such pair. The caller says which
    /// inputs it gives numbers, and which it gives anything; what formulas give comes besides.
    pub fn contradiction(&self, gives_numbers: impl Fn(&str) -> bool, gives: impl Fn(&str) -> bool) -> Option<(String, String)> {
        let mut pairs = self.replacements().into_iter();
        pairs.find(|(input, other)| {
            (gives_numbers(input) || self.is_given_by_formula(input)) && (gives(other) || self.is_given_by_formula(other))
        })
    }

    fn flaw_of_change(&self, preset: &str, (name, value): &(String, f64)) -> Option<String> {
        let Some(input) = self.input(name) else { return Some(format!("the preset \"{preset}\" sets {name}, which is no input")) };
        let input = &self.inputs[input];
        (!input.accepts(*value)).then(|| format!("the preset \"{preset}\" sets {name} to {value}; it must be {}", input.valid_in_words()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::{Condition, Output, Preset, Worse, all, find};
    use crate::units::NEWTON;

    /// A model that differs from one of the program in one thing.
    fn other(change: impl FnOnce(&mut Model)) -> Model {
        let mut model = Model::clone(&find("pulley-load").expect("it is a model"));
        model.name = "mine".to_owned();
        change(&mut model);
        model
    }

    #[test]
    fn the_models_of_the_program_are_right() {
        assert!(!all().is_empty());
        all().iter().for_each(|model| model.check().unwrap_or_else(|error| panic!("{error}")));
    }

    #[test]
    fn a_model_of_ones_own_is_found_by_its_name_which_nobody_else_may_have() {
        let model = Arc::new(other(|_| ()));
        let models = Models::new().with(model.clone()).expect("it is right");
        assert!(Arc::ptr_eq(&models.find("mine").expect("it was added"), &model));
        assert_eq!(models.iter().count(), all().len() + 1);
        assert!(models.find("pulley").is_some() && models.find("yours").is_none() && Models::new().find("mine").is_none());
        let taken = models.with(model).expect_err("the name is taken").to_string();
        assert_eq!(taken, "there is a model \"mine\" already");
        assert!(Models::new().with(find("pulley").expect("it is a model")).is_err());
    }

    #[test]
    fn tables_that_do_not_fit_each_other_are_refused_with_the_reason() {
        type Change = fn(&mut Model);
        let told = |change: Change| other(change).check().expect_err("it is wrong").to_string();
        let cases: [(Change, &str); 15] = [
            (|it| it.inputs[0] = it.inputs[0].clone().instead_of("speed"), "power_kW takes the place of speed, which is no input"),
            (
                |it| it.inputs[0] = it.inputs[0].clone().instead_of("speed_rpm"),
                "power_kW takes the place of speed_rpm, so its default must be a word",
            ),
            (|it| it.inputs[0].name = "power".into(), "power is in kW, so its name must end in _kW"),
            (|it| it.inputs[1].name = it.inputs[0].name.clone(), "power_kW stands twice"),
            (|it| it.inputs[0].default = -1.0, "the default of power_kW must be at least 0"),
            (|it| it.inputs[0].follows = Some("speed".into()), "a word of power_kW stands for speed, which is no input"),
            (
                |it| it.inputs[0] = it.inputs[0].clone().read_only_for("tensioning", &["slack", "spring"]),
                "power_kW is read for tensioning = \"spring\" only, which is no word of it",
            ),
            (
                |it| it.inputs[0] = it.inputs[0].clone().read_only_for("stretch", &["slack"]),
                "power_kW is read for words of stretch only, which is no input",
            ),
            (|it| it.presets = vec![Preset::new("all", &[("force_N", 1.0)])], "the preset \"all\" sets force_N, which is no input"),
            (
                |it| it.conditions[1] = Condition::new("odd", true, &["force_N"], "It is even."),
                "the condition \"odd\" takes away force_N, which is no output",
            ),
            (
                |it| it.outputs.extend((0..Set::SIZE).map(|n| Output::new(format!("f{n}_N"), "", NEWTON, Worse::Higher, "", ""))),
                "it has 282 inputs and outputs, at most 256 are possible",
            ),
            (
                |it| it.outputs.push(Output::new("force_N", "", NEWTON, Worse::Higher, "", "")),
                "it lists 15 outputs, and its formula has 14",
            ),
            (|it| it.conditions.extend(it.conditions.clone()), "it lists 8 conditions, and its formula has 4"),
            (|it| drop(it.inputs.pop()), "it lists 11 inputs, and its formula has 12"),
            (|it| it.outputs[4].name = "a b".into(), "\"a b\" is no name: letters, digits and _ make one, a letter first"),
        ];
        for (change, problem) in cases {
            assert_eq!(told(change), format!("the model \"mine\" cannot be: {problem}"));
        }
    }
}
