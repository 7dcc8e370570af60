//! Sweeps of a model that takes its time.

use super::*;
use crate::certify;
use crate::checkpoint::Checkpoint;
use crate::files::Claim;
use crate::models::Model;
use crate::models::tests::watched;
use crate::study::{Study, study_of};
use std::path::Path;
use std::sync::Arc;

/// A study with that many designs.
fn study(designs: u64) -> String {
    format!(
        "[design]\npower_kW = {{ from = 1, to = 4, count = {designs} }}\n[fixed]\nfriction_direction_deg = 45\n\
         [constraints]\nfriction_margin = {{ min = 0.7 }}\n[objectives]\ntorque_Nm = \"max\"\nfriction_margin = \"max\"\n"
    )
}

fn plan_of(model: Arc<Model>, designs: u64) -> Plan {
    Plan::new(study_of(&model, &study(designs)).expect("the study is right"))
}

fn swept(plan: &Plan, options: &Settings, checkpoint: Option<&mut Checkpoint>, control: &Control) -> Result<Swept> {
    sweep(plan, &Tables::new(plan), &Reduction::new(plan, &[]), options, checkpoint, control)
}

#[test]
fn a_few_slow_designs_are_shared_between_the_threads() {
    let (model, kernel) = watched(Duration::from_millis(10), 0);
    let plan = plan_of(model, 20);
    let control = Control::default();
    let options = Settings { threads: 2, ..Settings::default() };
    let done = swept(&plan, &options, None, &control).expect("nobody stops it");
    assert_eq!((done.designs, control.done.load(Ordering::Relaxed), kernel.prepared.load(Ordering::Relaxed)), (20, 20, 20));
    assert_eq!(kernel.threads.lock().expect("nobody panics with it").len(), 2);
}

#[test]
fn a_slow_sweep_stops_at_once_and_goes_on_where_it_was() {
    let (model, kernel) = watched(Duration::from_millis(2), 0);
    let control: &Control = Box::leak(Box::default());
    assert!(kernel.stop.set((100, control)).is_ok());
    let plan = plan_of(model, 400);
    let folder = tempfile::tempdir().expect("a folder");
    let claim = Claim::new(folder.path(), "a test").expect("nobody has it");
    let text = study(400);
    let mut checkpoint = Checkpoint::create(&claim, &plan.study, &text, Shard::WHOLE, plan.designs()).expect("it is made");
    let options = Settings { threads: 2, ..Settings::default() };
    let stopped = swept(&plan, &options, Some(&mut checkpoint), control);
    assert!(matches!(stopped, Err(Error::Stopped { .. })), "{stopped:?}");
    let done = control.done.load(Ordering::Relaxed);
    assert!((90..=102).contains(&done) && kernel.prepared.load(Ordering::Relaxed) < 104, "{done}");
    drop(checkpoint);

    let (model, kernel) = watched(Duration::ZERO, 0);
    let plan = plan_of(model, 400);
    let mut checkpoint = Checkpoint::open(&claim).expect("it was kept");
    let resumed = swept(&plan, &options, Some(&mut checkpoint), &Control::default()).expect("nobody stops it");
    assert_eq!((resumed.designs, kernel.prepared.load(Ordering::Relaxed)), (400 - done, 400 - done));
    let whole = swept(&plan, &Settings { threads: 1, ..Settings::default() }, None, &Control::default()).expect("nobody stops it");
    assert!(whole.state.feasible > 0 && whole.state.feasible < 400);
    assert_eq!((resumed.state.feasible, &resumed.state.front), (whole.state.feasible, &whole.state.front));
}

#[test]
fn what_takes_much_longer_than_the_model_says_is_kept_in_parts() {
    let (slow, _) = watched(Duration::from_millis(2), 0);
    // It claims to be fast, so that the first chunk is the whole study.
    let effort = crate::models::find("pulley-load").expect("it is a model").effort;
    let plan = plan_of(Arc::new(Model { effort, ..Model::clone(&slow) }), 600);
    let folder = tempfile::tempdir().expect("a folder");
    let claim = Claim::new(folder.path(), "a test").expect("nobody has it");
    let mut checkpoint = Checkpoint::create(&claim, &plan.study, &study(600), Shard::WHOLE, plan.designs()).expect("it is made");
    let control = Control::default();
    let options = Settings { threads: 1, tile: 50, ..Settings::default() };
    std::thread::scope(|scope| {
        let run = scope.spawn(|| swept(&plan, &options, Some(&mut checkpoint), &control));
        while control.done.load(Ordering::Relaxed) < 300 {
            std::thread::sleep(Duration::from_millis(5));
        }
        let manifest = std::fs::read_to_string(folder.path().join("checkpoint/manifest.json")).expect("it is there");
        let manifest: serde_json::Value = serde_json::from_str(&manifest).expect("it is JSON");
        assert!(!manifest["manifest"]["state"].is_null(), "nothing is kept yet of {:?}", control.done);
        control.stop.store(true, Ordering::Relaxed);
        assert!(matches!(run.join().expect("it does not panic"), Err(Error::Stopped { .. })));
    });
}

#[test]
fn certifying_can_be_watched_and_stopped() {
    let (model, _) = watched(Duration::ZERO, 0);
    let plan = plan_of(model, 400);
    let points = swept(&plan, &Settings::default(), None, &Control::default()).expect("nobody stops it").state.front;
    let columns = certify::columns(&plan.study);
    let control = Control::default();
    let rows = certify::front(&plan, &columns, &points, 2, &control).expect("nobody stops it");
    assert!(rows.len() > 40 && rows.len() == points.indices.len());
    assert_eq!(control.certified.load(Ordering::Relaxed), rows.len() as u64);

    let (model, kernel) = watched(Duration::from_millis(1), 0);
    let control: &Control = Box::leak(Box::default());
    assert!(kernel.stop.set((20, control)).is_ok());
    let stopped = certify::front(&plan_of(model, 400), &columns, &points, 2, control);
    assert!(matches!(stopped, Err(Error::Stopped { .. })), "{stopped:?}");
    assert!(kernel.prepared.load(Ordering::Relaxed) < 24 && control.certified.load(Ordering::Relaxed) < 24);
}

#[test]
fn draws_are_computed_for_a_block_at_a_time_however_long_one_design_takes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    let of = |name: &str, draws: u64| {
        let text = std::fs::read_to_string(folder.join(name)).expect("it is there");
        let text = text.replace("draws       = 10000", &format!("draws = {draws}"));
        least_tile(&Plan::new(Study::parse_in(&text, name, &folder).unwrap_or_else(|errors| panic!("{errors}"))))
    };
    let drawn = "push-belt-yield.toml";
    assert_eq!(of(drawn, 10_000), BLOCK as u64);
    // Only a block that would take very long is cut.
    let long = of(drawn, 1_000_000);
    assert!((1..BLOCK as u64).contains(&long), "{long}");
    assert_eq!(of("pulley-thickness.toml", 0), 1);
}
