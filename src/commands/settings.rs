//! `--preset` and `--set` of a model.

use beltspace::error::{Error, Result};
use beltspace::likeness::closest;
use beltspace::models::Model;
use beltspace::units::parse_value;

/// Defaults, then the preset, then every `--set`.
pub(super) fn inputs_of(model: &Model, preset: Option<&str>, set: &[String]) -> Result<Vec<f64>> {
    let mut inputs = match preset {
        Some(name) => model.preset(name).map_err(Error::Request)?,
        None => model.defaults(),
    };
    let mut problems = Vec::new();
    for assignment in set {
        match parse_assignment(model, assignment) {
            Ok((input, value)) => inputs[input] = value,
            Err(problem) => problems.push(problem),
        }
    }
    let gives = |name: &str| set.iter().any(|it| it.split_once('=').is_some_and(|(own, _)| own.trim() == name));
    let is_number = |name: &str| gives(name) && model.input(name).is_some_and(|at| model.inputs[at].word_for(inputs[at]).is_none());
    if let Some((input, other)) = model.contradiction(is_number, gives).filter(|_| problems.is_empty()) {
        problems.push(format!("{other} cannot be set beside {input}, which takes its place; drop one of the two"));
    }
    if problems.is_empty() { Ok(inputs) } else { Err(Error::Request(problems.join("\n       "))) }
}

fn parse_assignment(model: &Model, assignment: &str) -> std::result::Result<(usize, f64), String> {
    let (name, text) = assignment
        .split_once('=')
        .map(|(name, text)| (name.trim(), text.trim()))
        .filter(|(name, _)| !name.is_empty())
        .ok_or_else(|| format!("--set \"{assignment}\": write NAME=VALUE"))?;
    let Some(number) = model.input(name) else {
        if model.output(name).is_some() {
            return Err(format!("{name} is an output of {}; only inputs can be set", model.name));
        }
        let names: Vec<_> = model.inputs.iter().map(|it| it.name.as_str()).collect();
        let remedy = match closest(name, &names) {
            Some(near) => format!("did you mean {near}?"),
            None => format!("beltspace models {} lists them", model.name),
        };
        return Err(format!("{name} is no input of {}; {remedy}", model.name));
    };
    let input = &model.inputs[number];
    if let Some(value) = input.value_of(text) {
        return Ok((number, value));
    }
    let words = input.words_listed().unwrap_or_default();
    if input.is_enumeration() {
        return Err(format!("{name} = {text}: {name} takes words only; write {words}"));
    }
    let or_word = if words.is_empty() { words } else { format!(", or {words}") };
    let value = parse_value(text, input.unit).map_err(|error| format!("{name}: {error}{or_word}"))?;
    // The number that stands for a word is not a value that a user may give.
    if input.accepts(value) && input.word_for(value).is_none() {
        return Ok((number, value));
    }
    let whole = if input.integer && value.fract() != 0.0 { "must be a whole number" } else { "is out of range" };
    Err(format!("{name} = {text} {whole}; it must be {}{or_word}", input.valid.in_words()))
}

/// The error for `--preset` with a study.
pub(super) fn no_preset() -> Error {
    Error::Request("--preset is for models; a study names its own".to_owned())
}

#[cfg(test)]
mod tests {
    use super::super::unlike::with_a_section;
    use super::*;

    #[test]
    fn an_enumeration_is_set_by_its_words_only() {
        let model = with_a_section();
        let section = model.input("section").expect("it has one");
        assert_eq!(parse_assignment(&model, "section = welded-discs"), Ok((section, 2.0)));
        for wrong in ["2", "cast", ""] {
            let expected = format!("section = {wrong}: section takes words only; write \"machined\", \"welded-discs\" or \"pressed-cup\"");
            assert_eq!(parse_assignment(&model, &format!("section={wrong}")), Err(expected));
        }
    }
}
