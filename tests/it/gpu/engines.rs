//! The device compared with the CPU: the same answers, however a sweep is divided, interrupted or continued on the other engine.

use super::{Prepared, RUNS, SMALL, along_axis, assert_same, device, larger, long_runs, open, shipped, wrong};
use beltspace::checkpoint::{Checkpoint, Saved};
use beltspace::error::Error;
use beltspace::files::Claim;
use beltspace::names::CHECKPOINT;
use beltspace::screen::gpu::{Wrong, supports};
use beltspace::study::Study;
use beltspace::sweep::{Control, Settings, sweep, sweep_on_device};
use beltspace::tiles::Shard;
use std::sync::atomic::Ordering;
use std::time::Duration;

#[test]
fn small_studies_of_every_model_give_the_same_answers() {
    for text in SMALL {
        let study = Prepared::parse(text);
        let (state, record) = study.on(device()).expect("the device works");
        assert_same(&state, &study.on_cpu(), &study.plan.study.model.name);
        assert_eq!(record.designs, study.plan.designs());
        assert_eq!(record.recheck.designs, study.plan.designs().min(100_000));
        assert!(record.unsure * 100 < record.designs, "{record:?}");
    }
}

#[test]
fn shipped_studies_give_the_same_answers_and_few_designs_are_unsure() {
    for path in shipped() {
        let study = Prepared::new(Study::read(&path).expect("the study is right").0);
        let judged = study.on(device());
        if study.plan.study.decides_by_spectrum() {
            let refused = judged.map(|_| ()).expect_err("sums are for the CPU").to_string();
            assert!(refused.contains("mean or sum over the cases"), "{refused}");
            continue;
        }
        let (state, record) = judged.expect("the device works");
        assert_same(&state, &study.on_cpu(), &path.display().to_string());
        assert_eq!(record.designs, study.plan.designs());
        assert!(record.unsure * 100 < record.designs, "{}: {record:?}", path.display());
        assert!(record.recheck.designs >= 100_000.min(study.plan.designs()), "{record:?}");
    }
}

#[test]
fn designs_judged_in_runs_give_the_same_answers() {
    let mapped = format!("{RUNS}[report]\nmaps = [{{ x = \"friction\", y = \"ratio\", value = \"torque_capacity_Nm\" }}]\n");
    let reported = format!("{RUNS}[report]\ntop = {{ by = \"torque_capacity_Nm\", count = 20 }}\n");
    let counted = format!("{RUNS}[report]\nhistograms = [{{ of = \"torque_capacity_Nm\", bins = 12 }}]\nsample = 50\n");
    let logarithmic = RUNS.replace(
        "band_thickness_mm = { from = 0.1, to = 0.4, count = 150 }",
        "band_thickness_mm = { from = 0.4, to = 0.1, count = 90, spacing = \"log\" }",
    );
    let long = long_runs();
    let all = [RUNS, &reported, &counted, &logarithmic, &long];
    let in_order = all.iter().map(|&text| (text.to_owned(), "const WIDTH"));
    let along_axis = all.iter().map(|text| along_axis(text)).chain([mapped]).map(|text| (text, "const RUN_STEP"));
    for (text, piece) in in_order.chain(along_axis) {
        let study = Prepared::parse(&text);
        // The kernel must have such runs to be told so.
        let runs = vec![(piece.to_owned(), piece.to_owned())];
        let (state, record) = study.on(&wrong(Wrong { grouped: true, replace: runs, ..Wrong::default() })).expect("the device works");
        assert_same(&state, &study.on_cpu(), &text);
        assert_eq!(record.designs, study.plan.designs());
        assert!(record.unsure * 10_000 < record.designs, "{record:?}");
        // Tiles that share a row count their own lanes alone.
        assert!((1..=record.designs).contains(&record.singly), "{record:?}");
        let looks_at_all = text.contains("histograms") || text.contains("maps");
        assert_eq!(record.open_runs == 0, looks_at_all, "{record:?}");
    }
}

#[test]
fn runs_in_order_leave_few_designs_to_be_judged_singly_and_fewer_to_f64() {
    let text = RUNS.replace("count = 150 }", "count = 1500 }");
    let study = Prepared::parse(&text);
    let (state, record) = study.on(&wrong(Wrong { grouped: true, ..Wrong::default() })).expect("the device works");
    assert_same(&state, &study.on_cpu(), &text);
    assert!(record.singly > 0 && record.singly * 40 < record.designs, "{record:?}");
    // Most of the 32 lanes of an open run are settled by its parts.
    assert!(record.singly < record.open_runs * 12, "{record:?}");
    assert!(record.survivors > 0 && record.survivors * 1000 < record.designs, "{record:?}");
}

#[test]
fn runs_along_an_axis_are_judged_in_the_scenarios_that_decide() {
    let text = along_axis(RUNS).replace("[480, 500]", "{ from = 480, to = 500, count = 8 }");
    let study = Prepared::parse(&text);
    let pieces = ["const RUN_STEP", "let last = decisive[row + 1u];"].map(|it| (it.to_owned(), it.to_owned())).to_vec();
    let (state, record) = study.on(&wrong(Wrong { grouped: true, replace: pieces, ..Wrong::default() })).expect("the device works");
    assert_same(&state, &study.on_cpu(), &text);
    assert!(record.open_runs > 0 && record.singly > 0, "{record:?}");
}

#[test]
fn a_tile_with_too_many_open_runs_is_repeated_in_parts() {
    for text in [RUNS.to_owned(), along_axis(RUNS)] {
        let study = Prepared::parse(&text);
        let on = wrong(Wrong { grouped: true, open_runs: Some(400), ..Wrong::default() });
        let (state, record) = study.on(&on).expect("the device works");
        assert!(record.repeated > 0, "{record:?}");
        assert_same(&state, &study.on_cpu(), "in parts");
    }
}

#[test]
fn walks_over_teeth_in_many_scenarios_stay_within_the_turns_of_a_driver() {
    // 60 teeth, 160 scenarios: four lanes at once would take more iterations than a driver that ends long loops allows.
    let text = r#"model = "timing-belt"
[design]
tight_tension_N = { from = 400, to = 500, count = 40 }
pulley_speed_rpm = { from = 300, to = 320, count = 2 }
[operation]
slack_tension_N = { from = 0, to = 100, count = 160 }
[fixed]
teeth_in_mesh = 60
[constraints]
incomplete_teeth = { max = 0 }
[objectives]
boundary_tooth = "max"
lift_speed_rpm = "max"
tight_tension_N = "min"
"#;
    let study = Prepared::parse(text);
    let on = wrong(Wrong { grouped: true, ..Wrong::default() });
    let (state, record) = study.on(&on).expect("the device works");
    assert_same(&state, &study.on_cpu(), "many iterations");
    assert!(record.unsure * 20 < record.designs, "{record:?}");
}

#[test]
fn a_tile_with_too_many_survivors_is_repeated_in_parts() {
    let study = Prepared::parse(SMALL[0]);
    let on = wrong(Wrong { capacity: Some(600), ..Wrong::default() });
    let (state, record) = study.on(&on).expect("the device works");
    assert!(record.repeated > 0, "{record:?}");
    assert_same(&state, &study.on_cpu(), "in parts");
}

#[test]
fn a_long_axis_is_seen_through_a_window_and_maps_find_their_cells() {
    // The outermost axis has more levels than the device is told of at a time; rows of several tiles share windows.
    let text = r#"model = "metal-cvt"
[design]
groove_angle_deg = { from = 18, to = 30, count = 60001 }
traction = [0.3, 0.4, 0.5]
band_count = { from = 6, to = 8 }
[constraints]
stress_margin = { min = -0.5 }
[objectives]
axial_force_N = "min"
stress_margin = "max"
[report]
maps = [{ x = "traction", y = "groove_angle_deg", value = "axial_force_N" }]
"#;
    let study = Prepared::parse(text);
    let (state, _) = study.on(device()).expect("the device works");
    assert_same(&state, &study.on_cpu(), "a long axis");
}

#[test]
fn a_map_over_an_axis_of_one_value_finds_its_cells() {
    let text = r#"model = "metal-cvt"
[design]
groove_angle_deg = { from = 18, to = 30, count = 5 }
strength_MPa = [800]
band_thickness_mm = { from = 0.1, to = 0.3, count = 30 }
band_count = [10]
[constraints]
stress_margin = { min = 0 }
[objectives]
axial_force_N = "min"
[report]
maps = [
    { x = "strength_MPa", y = "band_thickness_mm", value = "axial_force_N" },
    { x = "band_count", y = "groove_angle_deg", best = "share" },
    { x = "groove_angle_deg", y = "strength_MPa", value = "stress_margin", best = "max" },
]
"#;
    let study = Prepared::parse(text);
    let (state, _) = study.on(device()).expect("the device works");
    assert_same(&state, &study.on_cpu(), "maps over one value");
    assert_eq!(
        state.reported.maps[1].cell(0).map(|cell| cell.feasible),
        study.on_cpu().reported.maps[1].cell(0).map(|cell| cell.feasible),
        "feasible designs of a cell"
    );
}

#[test]
fn plateaus_and_inert_axes_are_no_trouble() {
    // Capacity 0 over much of the space, a slip margin of exactly 0 everywhere, and an axis that changes nothing.
    let text = r#"model = "rubber-cvt"
[design]
torque_Nm = { from = 1, to = 50, count = 40 }
belt_thickness_mm = { from = 5, to = 40, count = 60 }
groove_angle_deg = [26, 30, 34]
[fixed]
traction = "limit"
[objectives]
torque_capacity_Nm = "max"
slip_margin = "max"
[report]
top = { by = "slip_margin", count = 5 }
histograms = [{ of = "torque_capacity_Nm", from = 0, to = 100, bins = 10 }]
"#;
    let study = Prepared::parse(text);
    let (state, record) = study.on(device()).expect("the device works");
    assert_same(&state, &study.on_cpu(), "plateaus");
    assert_eq!(record.unsure, 0, "a plateau is a sure answer: {record:?}");
}

#[test]
fn shards_and_halves_go_together_whatever_ran_them() {
    let study = Prepared::parse(SMALL[0]);
    let whole = study.on_cpu();
    let folder = tempfile::tempdir().expect("a folder can be made");
    let text = SMALL[0];
    let mut shards = Vec::new();
    for number in 1..=3 {
        let shard = Shard { number, of: 3 };
        let options = Settings { shard, threads: 1, ..Settings::default() };
        let path = folder.path().join(number.to_string());
        let claim = Claim::new(&path, "a test").expect("nobody has it");
        let mut checkpoint =
            Checkpoint::create(&claim, &study.plan.study, text, shard, study.plan.designs()).expect("a folder can be made");
        let control = Control::default();
        let Prepared { plan, tables, reduction } = &study;
        if number == 2 {
            sweep(plan, tables, reduction, &options, Some(&mut checkpoint), &control).expect("the sweep ends");
        } else {
            sweep_on_device(plan, tables, reduction, &options, Some(&mut checkpoint), &control, device()).expect("the sweep ends");
        }
        drop(checkpoint);
        shards.push((path.clone(), Saved::read(&path.join(CHECKPOINT)).expect("it was kept")));
    }
    let merged = beltspace::merge::merge(&study.plan, &study.reduction, shards).expect("the shards are complete");
    assert_same(&merged, &whole, "shards of both engines");
}

/// Runs until `end` has been called after the first tiles; gives back the error.
fn interrupted(text: &str, study: &Prepared, folder: &std::path::Path, end: impl Fn(&Control, &beltspace::gpu::Device) + Sync) -> Error {
    let on = open();
    let control = Control::default();
    let claim = Claim::new(folder, "a test").expect("nobody has it");
    let mut checkpoint =
        Checkpoint::create(&claim, &study.plan.study, text, Shard::WHOLE, study.plan.designs()).expect("a folder can be made");
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while control.done.load(Ordering::Relaxed) == 0 {
                std::thread::sleep(Duration::from_millis(1));
            }
            end(&control, &on.device);
        });
        let options = Settings { threads: 1, ..Settings::default() };
        let swept = sweep_on_device(&study.plan, &study.tables, &study.reduction, &options, Some(&mut checkpoint), &control, &on);
        swept.map(|_| ()).expect_err("it was interrupted")
    })
}

#[test]
fn a_lost_device_leaves_a_checkpoint_from_which_either_engine_goes_on() {
    let text = larger();
    let study = Prepared::parse(&text);
    let whole = study.on_cpu();
    for on_device in [false, true] {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let error = interrupted(&text, &study, folder.path(), |_, device| device.lose());
        assert!(matches!(&error, Error::Gpu { problem, .. } if problem.contains("lost")), "{error}");
        let claim = Claim::new(folder.path(), "a test").expect("nobody has it");
        let mut checkpoint = Checkpoint::open(&claim).expect("it was kept");
        assert!(checkpoint.saved().has_progress(), "what was done before the loss is kept");
        let (control, options) = (Control::default(), Settings::default());
        let Prepared { plan, tables, reduction } = &study;
        let state = if on_device {
            let swept = sweep_on_device(plan, tables, reduction, &options, Some(&mut checkpoint), &control, device());
            swept.expect("another device goes on").0.state
        } else {
            sweep(plan, tables, reduction, &options, Some(&mut checkpoint), &control).expect("the CPU continues").state
        };
        assert_same(&state, &whole, "resumed after a loss");
    }
}

#[test]
fn a_stopped_run_goes_on_on_the_processor() {
    let text = larger();
    let study = Prepared::parse(&text);
    let folder = tempfile::tempdir().expect("a folder can be made");
    let error = interrupted(&text, &study, folder.path(), |control, _| control.stop.store(true, Ordering::Relaxed));
    assert!(matches!(error, Error::Stopped { .. }), "{error}");
    let claim = Claim::new(folder.path(), "a test").expect("nobody has it");
    let mut checkpoint = Checkpoint::open(&claim).expect("it was kept");
    let swept = sweep(&study.plan, &study.tables, &study.reduction, &Settings::default(), Some(&mut checkpoint), &Control::default());
    assert_same(&swept.expect("the sweep ends").state, &study.on_cpu(), "stopped and resumed");
}

#[test]
fn a_broken_error_bound_keeps_nothing_that_the_device_counted() {
    let text = larger();
    let study = Prepared::parse(&text);
    let folder = tempfile::tempdir().expect("a folder can be made");
    let claim = Claim::new(folder.path(), "a test").expect("nobody has it");
    let mut checkpoint =
        Checkpoint::create(&claim, &study.plan.study, &text, Shard::WHOLE, study.plan.designs()).expect("a folder can be made");
    // Wrong in a way that is noticed only at the end.
    let lost = Wrong { replace: vec![("    return beaten;".to_owned(), "    return true;".to_owned())], ..Wrong::default() };
    let (options, control) = (Settings::default(), Control::default());
    let Prepared { plan, tables, reduction } = &study;
    let swept = sweep_on_device(plan, tables, reduction, &options, Some(&mut checkpoint), &control, &wrong(lost));
    let error = swept.map(|_| ()).expect_err("the front lacks designs");
    assert!(matches!(error, Error::ErrorBound(_)), "{error}");
    drop(checkpoint);
    let mut checkpoint = Checkpoint::open(&claim).expect("the folder is there");
    assert!(!checkpoint.saved().has_progress(), "what was counted is not kept");
    let swept = sweep(plan, tables, reduction, &options, Some(&mut checkpoint), &control);
    assert_same(&swept.expect("the sweep ends").state, &study.on_cpu(), "after a broken error bound");
}

#[test]
fn a_study_that_no_device_serves_is_refused_with_the_reason() {
    let text = |scenarios: u64| {
        format!(
            "model = \"metal-cvt\"\n[design]\nband_count = {{ from = 6, to = 14 }}\n[operation]\nratio = {{ from = 0.5, to = 2, count = {scenarios} }}\n\
             [objectives]\nstress_margin = \"max\"\n"
        )
    };
    assert!(supports(&Prepared::parse(&text(1000)).plan, true).is_ok());
    let refused = supports(&Prepared::parse(&text(30_000)).plan, true).expect_err("the loops are too long").to_string();
    assert!(refused.contains("60000 loop iterations") && refused.contains("--engine cpu"), "{refused}");
    assert!(supports(&Prepared::parse(&text(30_000)).plan, false).is_ok(), "another driver can");
}
