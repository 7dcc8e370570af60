//! A model made at run time works wherever a built-in one does: studies, sweeps, checkpoints, hashes.

#[allow(dead_code, reason = "tests/library.rs runs its main")]
#[path = "../../examples/own_model.rs"]
mod example;

use beltspace::checkpoint::{Checkpoint, Saved};
use beltspace::files::Claim;
use beltspace::models::{Model, Models, Status, evaluate};
use beltspace::names::CHECKPOINT;
use beltspace::plan::Plan;
use beltspace::reduce::Reduction;
use beltspace::screen::Tables;
use beltspace::study::Study;
use beltspace::sweep::{self, Control, Settings};
use beltspace::tiles::Shard;
use example::{STUDY, band_brake};
use std::sync::Arc;

/// The model of the example in some version.
fn model(version: &str) -> Arc<Model> {
    Arc::new(band_brake().version(version))
}

#[test]
fn a_model_made_at_run_time_is_swept_kept_and_taken_up_again() {
    let models = Models::new().with(model("1")).expect("it is right");
    let brake = models.find("band-brake").expect("it was added");
    let evaluation = evaluate(&brake, &brake.defaults());
    let expected = 100.0 * (0.3 * 1.5 * std::f64::consts::PI).exp();
    assert_eq!(evaluation.status, Status::Ok);
    assert!((evaluation.outputs[0].expect("it has a value") - expected).abs() < 1e-9);

    let unknown = Study::parse_in(STUDY, "study.toml", ".".as_ref()).expect_err("the program does not know it").to_string();
    assert!(unknown.contains("unknown model \"band-brake\""), "{unknown}");
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
            let evaluation = evaluate(&brake, &plan.space.inputs(design, scenario));
            evaluation.status == Status::Ok && evaluation.outputs[1].is_some_and(|torque| torque >= 30.0)
        };
        (0..plan.scenarios()).all(holds)
    });
    assert_eq!(swept.state.feasible, feasible.count() as u64);
    assert!(swept.state.feasible > 100 && !swept.state.front.is_empty());

    let at = folder.path().join(CHECKPOINT);
    assert!(Saved::read(&at).expect_err("the program does not know it").to_string().contains("there is no model \"band-brake\""));
    let saved = Saved::read_with(&models, &at).expect("it was kept");
    assert!(saved.is_finished() && *saved.study() == study);
    let later = Models::new().with(model("2")).expect("it is right");
    let refused = Saved::read_with(&later, &at).expect_err("its formula is another one").to_string();
    assert!(refused.contains("model_version: was \"1\", is \"2\""), "{refused}");
}

#[test]
fn the_version_of_a_model_is_part_of_a_studys_hash_and_of_its_description() {
    let study_of = |version: &str| {
        let models = Models::new().with(model(version)).expect("it is right");
        Study::parse_with(&models, STUDY, "study.toml", ".".as_ref()).expect("it is right")
    };
    let (none, first, second) = (study_of(""), study_of("1"), study_of("2"));
    assert!(none.describe().get("model_version").is_none());
    assert_eq!(first.describe()["model_version"], "1");
    assert!(none.hash() != first.hash() && first.hash() != second.hash());
    assert_eq!(beltspace::study::differences(&first.describe(), &second.describe()), ["model_version: was \"1\", is \"2\""]);
    assert!(first != second && first == first.clone());
}
