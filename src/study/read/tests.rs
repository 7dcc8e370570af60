//! What no shipped model has: an input that takes words only.

use super::super::axis::{Axis, Levels};
use super::super::resolved::Study;
use super::syntax;
use super::table::{Problems, TomlTable};
use super::{Problem, read_study_of};
use crate::models::Model;
use crate::models::tests::with_a_section;
use std::path::Path;
use std::sync::Arc;

/// Reads a study of a model that is in no list.
pub(crate) fn study_of(model: &Arc<Model>, text: &str) -> Result<Study, Vec<Problem>> {
    let problems = Problems::new(text, "study.toml");
    let study = syntax::understandable(text, &problems).and_then(|text| {
        let (tree, _) = toml::de::DeTable::parse_recoverable(&text);
        read_study_of(Some(model.clone()), &TomlTable::new(tree.get_ref(), 0), &problems, Path::new("tests"))
    });
    let problems = problems.into_sorted();
    if problems.is_empty() { Ok(study.expect("there is no problem")) } else { Err(problems) }
}

/// What is wrong with a study of which this is all but the model and the objective.
fn wrong(text: &str) -> Vec<String> {
    let text = format!("{text}\n[objectives]\ntorque_Nm = \"max\"\n");
    let problems = study_of(&with_a_section(), &text).expect_err("something is wrong");
    problems.into_iter().map(|it| format!("{}:{}: {}", it.line, it.column, it.message)).collect()
}

const WORDS: &str = r#""machined", "welded-discs", "double-groove" or "pressed-cup""#;

#[test]
fn an_enumeration_is_fixed_listed_and_joined_by_its_words() {
    let text = r#"
        [design]
        section = ["machined", "pressed-cup"]
        [operation]
        power_kW = [1, 2]
        [objectives]
        torque_Nm = "max"
    "#;
    let model = with_a_section();
    let study = study_of(&model, text).expect("it is right");
    let section = model.input("section").expect("it has one");
    assert_eq!(study.design, [Axis::Single { input: section, levels: Levels::List(vec![1.0, 4.0]) }]);
    assert_eq!(study.describe()["design"][0]["values"], serde_json::json!(["machined", "pressed-cup"]));
    let joint = text.replace("section = [\"machined\", \"pressed-cup\"]", "cases = [{ section = \"welded-discs\", groove_count = 2 }]");
    assert_eq!(study_of(&model, &joint).expect("it is right").design[0].value(0, 0), 2.0);
    let fixed = text
        .replace("[design]", "[fixed]")
        .replace("[\"machined\", \"pressed-cup\"]", "\"double-groove\"\n[design]\ngroove_count = [1, 2]");
    let study = study_of(&model, &fixed).expect("it is right");
    assert_eq!(study.fixed[section], 3.0);
    assert_eq!(study.describe()["fixed"]["section"], "double-groove");
}

#[test]
fn what_is_no_word_of_an_enumeration_is_refused_with_its_words() {
    for (text, at, found) in [
        ("[design]\nsection = 2", "2:11", "axis \"section\": found the number 2"),
        ("[design]\nsection = [\"machined\", 4]", "2:24", "axis \"section\": found the number 4"),
        ("[design]\nsection = \"cast\"", "2:11", "axis \"section\": found \"cast\""),
        ("[design]\nsection = true", "2:11", "axis \"section\": found true"),
        ("[design]\npower_kW = [1, 2]\n[fixed]\nsection = \"1\"", "4:11", "fixed input \"section\": found \"1\""),
        ("[design]\ncases = [{ section = 1.5, groove_count = 2 }]", "2:22", "axis \"cases\": found the number 1.5"),
    ] {
        assert_eq!(wrong(text), [format!("{at}: {found}, but section takes words only; write {WORDS}")], "{text}");
    }
    let listed = WORDS.replace(" or", ",");
    assert_eq!(
        wrong("[design]\nsection = { from = 1, to = 4 }"),
        [format!("2:11: axis \"section\": found a range, but section takes words only; list them: [{listed}]")]
    );
    assert_eq!(
        wrong("[design]\nsection = [\"machined\", \"machined\"]"),
        ["2:24: axis \"section\": \"machined\" is listed twice; drop one"]
    );
}

#[test]
fn words_have_no_order_to_constrain_or_weigh_them_by() {
    let problem = "the values of \"section\" are words, which have no order; name an input or output of numbers";
    let text = "[design]\nsection = [\"machined\", \"pressed-cup\"]\n[constraints]\nsection = { min = 1 }";
    assert_eq!(wrong(text), [format!("4:1: constraint \"section\": {problem}")]);
    let text = "[design]\npower_kW = [1, 2]\n[report]\nhistograms = [{ of = \"section\" }]";
    assert_eq!(wrong(text), [format!("4:22: histograms: {problem}")]);
}

#[test]
fn a_preset_is_the_base_of_what_is_fixed() {
    let model = with_a_section();
    let section = model.input("section").expect("it has one");
    let study = |head: &str| study_of(&model, &format!("{head}\n[design]\ngroove_count = [1, 2]\n[objectives]\ntorque_Nm = \"max\"\n"));
    let welded = study("preset = \"welded\"").expect("it is right");
    assert_eq!((welded.fixed[0], welded.fixed[section]), (5.0, 2.0));
    assert_eq!(welded.describe()["fixed"]["section"], "welded-discs");
    let explicit = study("preset = \"welded\"\n[fixed]\npower_kW = 7").expect("it is right");
    assert_eq!((explicit.fixed[0], explicit.fixed[section]), (7.0, 2.0));
    let problems = study("preset = \"cast\"").expect_err("there is no such preset");
    assert_eq!(problems[0].to_string(), "study.toml:1:10: preset: sections has no preset \"cast\"; presets are: welded");
    let problems = study("preset = 3").expect_err("that is no name");
    assert_eq!(problems[0].to_string(), "study.toml:1:10: preset: found the number 3, wanted a text in quotes");
}
