//! A study with axes of words: every file has the words, and never the numbers that stand for them.

use super::Certified;
use crate::models::tests::with_a_section;
use crate::plan::Plan;
use crate::reduce::Reduction;
use crate::screen::{Tables, Tally};
use crate::study::study_of;
use crate::sweep::{Control, Settings, sweep};

const STUDY: &str = r#"
    preset = "welded"
    [design]
    section = ["machined", "pressed-cup"]
    power_kW = [2, 3]
    [operation]
    cases = [{ groove_count = 1, slack_tension_N = 700 }, { groove_count = 2, slack_tension_N = 900 }]
    [objectives]
    torque_Nm = "max"
    [report]
    top = { by = "torque_Nm", count = 4 }
    maps = [{ x = "section", y = "power_kW", value = "torque_Nm" }]
"#;

/// The files of a study of the model with a section.
fn files(text: &str) -> Vec<(String, String)> {
    let plan = Plan::new(study_of(&with_a_section(), text).expect("the study is right"));
    let tables = Tables::new(&plan);
    let tally = Tally::new(&plan, &tables, 1);
    let reduction = Reduction::new(&plan, &tally.histogram_ranges(&plan));
    let swept = sweep(&plan, &tables, &reduction, &Settings::default(), None, &Control::default()).expect("the sweep ends");
    let outcome = Certified::certify(&plan, swept.state, tally, 1, &Control::default()).expect("it is certified");
    let mut files = Vec::new();
    let mut put = |name: &str, part: super::Part<'_>| {
        let mut bytes = Vec::new();
        part.write(&mut bytes).expect("there is memory");
        files.push((name.to_owned(), String::from_utf8_lossy(&bytes).into_owned()));
        Ok(())
    };
    outcome.make_files(text, 1, &Control::default(), &mut put).expect("the tables are written");
    files
}

#[test]
fn words_stand_in_every_file() {
    let found = files(STUDY);
    let file = |name: &str| &found.iter().find(|(it, _)| it == name).unwrap_or_else(|| panic!("{name} is missing")).1;
    let sections = |name: &str, column: usize| -> Vec<String> {
        file(name).lines().skip(1).map(|line| line.split(',').nth(column).expect("a column").to_owned()).collect()
    };
    // Of equals the first stays.
    assert_eq!(sections("front.csv", 1), ["machined"]);
    assert_eq!(sections("top.csv", 1), ["machined", "pressed-cup", "machined", "pressed-cup"]);
    assert_eq!(sections("map-torque_Nm.csv", 0), ["machined", "pressed-cup", "machined", "pressed-cup"]);
    let picture = file("map-torque_Nm.svg");
    assert!(picture.contains("\nmachined\n") && picture.contains("\npressed-cup\n"), "{picture}");
    assert!(file("summary.json").contains("\"section\": \"machined\""), "{}", file("summary.json"));
    assert!(file("study.json").contains("\"disc_mass_g\": 10"));
}

#[test]
fn words_stand_in_scenarios_and_among_what_is_fixed() {
    let text = STUDY.replace("section = [\"machined\", \"pressed-cup\"]", "friction_limit = [0.3, 0.4]");
    let text = text.replace("groove_count = 1,", "section = \"pressed-cup\",").replace("groove_count = 2,", "section = \"double-groove\",");
    let found = files(&text.replace("x = \"section\"", "x = \"friction_limit\""));
    let scenarios = &found.iter().find(|(name, _)| name == "scenarios.csv").expect("it is there").1;
    assert_eq!(*scenarios, "scenario,section,slack_tension_N\n0,pressed-cup,700\n1,double-groove,900\n");
}
