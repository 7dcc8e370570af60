//! A model made at run time serves wherever one of the program's own does: studies, sweeps, checkpoints, hashes.

use beltspace::checkpoint::{Checkpoint, Saved};
use beltspace::files::Claim;
use beltspace::models::{Condition, Effort, Fields, Formula, Input, Model, Models, Output, Preset, Set, Shader, Status, Worse, evaluate};
use beltspace::names::CHECKPOINT;
use beltspace::plan::Plan;
use beltspace::real::Real;
use beltspace::reduce::Reduction;
use beltspace::screen::Tables;
use beltspace::study::Study;
use beltspace::sweep::{self, Control, Settings};
use beltspace::tiles::Shard;
use beltspace::units::{DEGREE, NEWTON, NONE};
use std::sync::Arc;

/// Eytelwein: the tight tension that a flat belt can have, and what is left of it over the wanted one.
struct FlatBelt;

/// Numbers of the inputs.
const SLACK: usize = 0;
const FRICTION: usize = 1;
const WRAP: usize = 2;
const WANTED: usize = 3;

impl Formula for FlatBelt {
    const FIELDS: Fields = Fields {
        inputs: &["slack_tension", "friction", "wrap", "wanted_tension"],
        prepared: &["grip"],
        tables: &[],
        turns: 0,
        conditions: 1,
        outputs: &["tight_tension", "slip_reserve"],
    };

    fn prepare<R: Real>(inputs: &[R], _wanted: Set, prepared: &mut [R]) {
        prepared[0] = (inputs[FRICTION] * inputs[WRAP]).exp_m1() + R::constant(1.0);
    }

    fn conditions<R: Real>(_prepared: &[R::Shared], inputs: &[R], _wanted: Set, margins: &mut [R]) {
        margins[0] = inputs[SLACK];
    }

    fn finish<R: Real>(prepared: &[R::Shared], inputs: &[R], _wanted: Set, outputs: &mut [R]) {
        outputs[0] = inputs[SLACK] * R::shared(prepared[0]);
        outputs[1] = R::constant(1.0) - inputs[WANTED] / outputs[0];
    }
}

/// The model; its names are put together at run time, as those from a file would be.
fn flat_belt(version: &str) -> Arc<Model> {
    let input = |quantity: &str, unit, default, usual| Input::new(quantity.to_owned(), "", unit, default, usual, "An input.", "chosen");
    let tension = |which: &str| format!("{which}_tension_N");
    Arc::new(Model {
        name: ["flat", "belt"].join("-"),
        version: version.to_owned(),
        summary: "Flat belt after Eytelwein".to_owned(),
        source: "Eytelwein".to_owned(),
        limits: "Nothing but friction.".to_owned(),
        inputs: vec![
            input(&tension("slack"), NEWTON, 100.0, (10.0, 1000.0)),
            input("friction", NONE, 0.3, (0.1, 0.6)),
            input("wrap_deg", DEGREE, 180.0, (90.0, 270.0)),
            input(&tension("wanted"), NEWTON, 150.0, (10.0, 1000.0)),
        ],
        outputs: vec![
            Output::new(tension("tight"), "", NEWTON, Worse::Lower, "", "Largest tension of the tight side."),
            Output::new("slip_reserve", "", NONE, Worse::Lower, "", "What is left of it."),
        ],
        conditions: vec![Condition::new("slack belt", true, &["slip_reserve"], "The belt is tight.")],
        presets: vec![Preset::new("crossed", &[("wrap_deg", 230.0)])],
        starter: String::new(),
        kernel: Arc::new(FlatBelt),
        effort: Effort { prepare: 1e-7, finish: 1e-8 },
        sample: 1000,
        shader: Some(Shader::Recorded),
        remarks: None,
        notes: None,
        profile: None,
        pulley: None,
    })
}

const STUDY: &str = r#"
    model = "flat-belt"
    preset = "crossed"
    [design]
    slack_tension_N = { from = 10, to = 300, count = 291 }
    friction = [0.2, 0.3, 0.4]
    [operation]
    wanted_tension_N = [150, 300]
    [constraints]
    slip_reserve = { min = 0.1 }
    [objectives]
    slack_tension_N = "min"
    slip_reserve = "max"
"#;

#[test]
fn a_model_made_at_run_time_is_swept_kept_and_taken_up_again() {
    let models = Models::new().with(flat_belt("1")).expect("it is right");
    let model = models.find("flat-belt").expect("it was added");
    let evaluation = evaluate(&model, &model.defaults());
    let expected = 100.0 * (0.3 * std::f64::consts::PI).exp();
    assert_eq!(evaluation.status, Status::Ok);
    assert!((evaluation.outputs[0].expect("it has a value") - expected).abs() < 1e-9);

    let unknown = Study::parse_in(STUDY, "study.toml", ".".as_ref()).expect_err("the program does not know it").to_string();
    assert!(unknown.contains("unknown model \"flat-belt\""), "{unknown}");
    let study = Study::parse_with(&models, STUDY, "study.toml", ".".as_ref()).expect("it is right");
    assert_eq!(Study::from_description_with(&models, &study.describe()).expect("it comes back"), study);
    assert!(Study::from_description(&study.describe()).is_err());

    let plan = Plan::new(study.clone());
    let (tables, reduction) = (Tables::new(&plan), Reduction::new(&plan, &[]));
    let (options, control) = (Settings::default(), Control::default());
    let folder = tempfile::tempdir().expect("a folder");
    let claim = Claim::new(folder.path(), "a test").expect("nobody has it");
    let mut checkpoint = Checkpoint::create(&claim, &study, STUDY, Shard::WHOLE, plan.designs()).expect("it is made");
    let swept = sweep::sweep(&plan, &tables, &reduction, &options, Some(&mut checkpoint), &control).expect("nobody stops it");
    let feasible = (0..plan.designs()).filter(|&design| {
        let holds = |scenario| {
            let evaluation = evaluate(&model, &plan.space.inputs(design, scenario));
            evaluation.status == Status::Ok && evaluation.outputs[1].is_some_and(|reserve| reserve >= 0.1)
        };
        (0..plan.scenarios()).all(holds)
    });
    assert_eq!(swept.state.feasible, feasible.count() as u64);
    assert!(swept.state.feasible > 100 && !swept.state.front.is_empty());

    let at = folder.path().join(CHECKPOINT);
    assert!(Saved::read(&at).expect_err("the program does not know it").to_string().contains("unknown model \"flat-belt\""));
    let saved = Saved::read_with(&models, &at).expect("it was kept");
    assert!(saved.is_finished() && *saved.study() == study);
    let later = Models::new().with(flat_belt("2")).expect("it is right");
    let refused = Saved::read_with(&later, &at).expect_err("its formula is another one").to_string();
    assert!(refused.contains("it describes another study than it has"), "{refused}");
}

#[test]
fn the_version_of_a_model_is_part_of_a_studys_hash_and_of_its_description() {
    let study_of = |version: &str| {
        let models = Models::new().with(flat_belt(version)).expect("it is right");
        Study::parse_with(&models, STUDY, "study.toml", ".".as_ref()).expect("it is right")
    };
    let (none, first, second) = (study_of(""), study_of("1"), study_of("2"));
    assert!(none.describe().get("model_version").is_none());
    assert_eq!(first.describe()["model_version"], "1");
    assert!(none.hash() != first.hash() && first.hash() != second.hash());
    assert_eq!(beltspace::study::differences(&first.describe(), &second.describe()), ["model_version: was \"1\", is \"2\""]);
    assert!(first != second && first == first.clone());
}
