//! What an engine finds, however often it is stopped and whatever room it has.

use super::super::Control;
use super::*;
use crate::models::Model;
use crate::models::tests::watched;
use crate::study::study_of;
use std::sync::Arc;
use std::time::Duration;

/// Three rows of four blocks, in three slow and two fast scenarios.
const STUDY: &str = r#"
    [design]
    power_kW = [2, 3, 4]
    friction_limit = { from = 0.25, to = 0.5, count = 2000 }
    [operation]
    slack_tension_N = [500, 600, 700]
    belt_mass_kg_per_m = [0.1, 0.2]
    [fixed]
    friction_direction_deg = 45
    [constraints]
    friction_margin = { min = 0.65 }
    [objectives]
    friction_margin = "max"
"#;

fn plan_of(model: Arc<Model>) -> Plan {
    let plan = Plan::new(study_of(&model, STUDY).expect("the study is right"));
    assert_eq!((plan.slow.count(), plan.fast.count()), (3, 2000));
    plan
}

/// Feasible designs with their worst values, and where the engine stopped.
fn judged(engine: &mut CpuEngine<'_>, positions: Range<u64>) -> (Vec<(u64, u64)>, u64) {
    let mut found = Vec::new();
    let end = engine.screen(positions, |block| {
        found.extend(block.feasible().map(|lane| (block.index(lane), block.column(0)[lane].to_bits())));
    });
    (found, end)
}

#[test]
fn what_there_is_no_room_for_is_prepared_again_to_the_same_answer() {
    let (model, kernel) = watched(Duration::ZERO, 0);
    let plan = plan_of(model);
    let tables = Tables::new(&plan);
    let slow = plan.slow_scenarios.count();
    let (all, end) = judged(&mut CpuEngine::new(&plan, &tables), 0..plan.designs());
    assert!(end == plan.designs() && all.len() > 1000 && (all.len() as u64) < plan.designs());
    assert_eq!(kernel.prepared.load(Ordering::Relaxed), 3 * slow, "once for each row and slow scenario");
    for room in 0..slow {
        let before = kernel.prepared.load(Ordering::Relaxed);
        let mut engine = CpuEngine::with_room(&plan, &tables, room);
        assert_eq!(judged(&mut engine, 0..plan.designs()), (all.clone(), end), "room for {room}");
        assert!(kernel.prepared.load(Ordering::Relaxed) - before > 3 * slow);
    }
}

#[test]
fn the_scenarios_that_are_chosen_are_the_only_ones_that_count() {
    let (model, _) = watched(Duration::ZERO, 0);
    let plan = plan_of(model);
    let tables = Tables::new(&plan);
    let mut engine = CpuEngine::new(&plan, &tables);
    let places: Vec<u64> = (0..plan.fast.count()).collect();
    let mut chosen = |scenarios: &[(u64, u64)]| {
        let mut found = std::collections::BTreeMap::new();
        engine.screen_rows(&[0, 1, 2], &places, scenarios, |block| {
            found.extend(block.feasible().map(|lane| (block.index(lane), block.column(0)[lane])));
        });
        found
    };
    let all: Vec<(u64, u64)> = (0..3).flat_map(|q| [(q, 0), (q, 1)]).collect();
    let whole = chosen(&[]);
    assert!(whole.len() > 1000 && chosen(&all) == whole);
    let alone: Vec<_> = all.iter().map(|&it| chosen(&[it])).collect();
    for (first, second) in (0..all.len()).flat_map(|a| (a + 1..all.len()).map(move |b| (a, b))) {
        let both = chosen(&[all[first], all[second]]);
        let expected = alone[first].iter().filter_map(|(index, a)| Some((*index, a.min(*alone[second].get(index)?))));
        assert!(both == expected.collect(), "{first} and {second}");
    }
    let different = alone.iter().filter(|it| **it != whole).count();
    assert!(different > 2, "the scenarios differ: {different}");
    // The same engine goes on with all of them.
    assert_eq!(chosen(&[]), whole);
}

#[test]
fn room_is_limited_by_memory() {
    let kept = |idle| plan_of(watched(Duration::ZERO, idle).0).kept_scenarios();
    // Of three megabytes each six scenarios fit; of a hundred and more, two; of half a gigabyte, none.
    assert_eq!([400_000, 16_000_000, 64_000_000].map(kept), [6, 2, 0]);
}

#[test]
fn a_stopped_engine_says_how_far_it_came() {
    let (reference, _) = watched(Duration::ZERO, 0);
    let plan = plan_of(reference);
    let (all, _) = judged(&mut CpuEngine::new(&plan, &Tables::new(&plan)), 0..plan.designs());
    let mut ends = std::collections::BTreeSet::new();
    for after in (0..90).step_by(7) {
        let control: &Control = Box::leak(Box::default());
        let (model, kernel) = watched(Duration::ZERO, 0);
        assert!(kernel.stop.set((after, control)).is_ok());
        let plan = plan_of(model);
        let tables = Tables::new(&plan);
        let mut engine = CpuEngine::new(&plan, &tables).stopping_on(&control.stop);
        let (mut found, end) = judged(&mut engine, 0..plan.designs());
        ends.insert(end);
        // The same engine goes on when it may, and nothing is missing or twice.
        control.stop.store(false, Ordering::Relaxed);
        let mut engine = CpuEngine { stop: None, ..engine };
        found.extend(judged(&mut engine, end..plan.designs()).0);
        assert!(found == all, "stopped after {after} stages at {end}");
    }
    assert!(ends.len() > 4 && ends.contains(&0), "{ends:?}");
}
