//! The library as its users see it, in memory: with whatever features it is built.

#[cfg(feature = "gpu")]
#[path = "../examples/engine.rs"]
mod engine;
#[path = "../examples/evaluate.rs"]
mod evaluate;
#[path = "../examples/own_model.rs"]
mod own_model;
#[path = "../examples/read.rs"]
mod read;
#[path = "../examples/sweep.rs"]
mod sweep;
#[path = "../examples/uncertain.rs"]
mod uncertain;

use beltspace::run::Control;
use beltspace::{Data, Engine, Error, Judging, Options, Outcome, Stored, Study};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

fn committed(study: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("results/studies").join(study)
}

fn shipped(study: &str) -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("studies/{study}.toml"));
    Study::read(&path).expect("a shipped study is right").0
}

/// Are these the tables that the result directory has?
fn assert_committed(study: &str, outcome: &Outcome) {
    let folder = committed(study);
    let single = [
        ("front", Some(&outcome.front).filter(|it| it.rows() > 0)),
        ("top", outcome.top.as_ref()),
        ("sample", outcome.sample.as_ref()),
        ("variants", outcome.variants.as_ref()),
    ];
    let single = single.into_iter().filter_map(|(name, table)| Some((name.to_owned(), table?)));
    let named = outcome.histograms.iter().chain(&outcome.maps).chain(&outcome.contours).map(|(name, table)| (name.clone(), table));
    for (name, table) in single.chain(named) {
        // Large maps are committed in Parquet.
        let Ok(bytes) = std::fs::read(folder.join(format!("{name}.csv"))) else {
            assert!(table.rows() > 100_000, "{study}: there is no {name}.csv");
            continue;
        };
        assert_eq!(String::from_utf8_lossy(&table.csv()), String::from_utf8_lossy(&bytes), "{study}: {name}");
    }
}

#[test]
fn an_outcome_has_the_tables_and_numbers_of_the_result_directory() {
    for study in ["metal-cvt", "pulley-load", "timing-map"] {
        let outcome = shipped(study).sweep(Options::default().engine(Engine::Cpu)).expect("it can be swept");
        assert_committed(study, &outcome);
        let stored = Stored::read(&committed(study)).expect("it is a result");
        let summary: serde_json::Value = serde_json::from_str(&stored.summary).expect("it is JSON");
        assert_eq!((stored.designs, stored.feasible), (outcome.counts.designs, outcome.counts.feasible), "{study}");
        assert_eq!(stored.front.csv(), if outcome.counts.front > 0 { outcome.front.csv() } else { stored.front.csv() }, "{study}");
        let knee = outcome.summary.knee.and_then(|knee| outcome.front.design(knee.row));
        assert_eq!(summary["knee"]["design_index"].as_u64(), knee, "{study}");
        for ideal in &outcome.summary.ideal {
            assert_eq!(summary["ideal"][&ideal.name].as_f64(), Some(ideal.value), "{study}: {}", ideal.name);
        }
        for spread in &outcome.summary.spreads {
            let stored = &summary["extremes"][&spread.name];
            assert_eq!(stored["least"]["value"].as_f64(), Some(spread.least.value), "{study}: {}", spread.name);
            assert_eq!(stored["largest"]["design_index"].as_u64(), Some(spread.largest.index), "{study}: {}", spread.name);
        }
    }
}

#[test]
fn every_method_gives_the_same_outcome() {
    let text = r#"
        model = "metal-cvt"
        [design]
        groove_angle_deg = { from = 18, to = 30, count = 25 }
        band_thickness_mm = { from = 0.1, to = 0.3, count = 41 }
        band_count = { from = 4, to = 14 }
        [operation]
        torque_Nm = [50, 150]
        [constraints]
        stress_margin = { min = 0 }
        [objectives]
        axial_force_N = "min"
        stress_margin = "max"
    "#;
    let study = Study::parse(text).expect("the study is right");
    let outcome = |judging| study.sweep(Options::default().engine(Engine::Cpu).judging(judging).threads(2)).expect("it can be swept");
    let (each, bounds) = (outcome(Judging::Exhaustive), outcome(Judging::Bounds));
    assert_eq!((each.course.method, bounds.course.method), ("exhaustive", "bounds"));
    assert_eq!((&each.front, each.counts, &each.summary), (&bounds.front, bounds.counts, &bounds.summary));
}

#[test]
fn an_outcome_has_the_list_and_the_sample_that_a_study_asks_for() {
    let text = |report: &str| {
        format!(
            "model = \"metal-cvt\"\n[design]\nband_thickness_mm = {{ from = 0.1, to = 0.3, count = 41 }}\nband_count = {{ from = 4, to = 14 }}\n\
             [constraints]\nstress_margin = {{ min = 0 }}\n[objectives]\naxial_force_N = \"min\"\n{report}"
        )
    };
    let outcome = |report: &str, threads| {
        let study = Study::parse(&text(report)).expect("the study is right");
        study.sweep(Options::default().engine(Engine::Cpu).threads(threads)).expect("it can be swept")
    };
    let both = "[report]\ntop = { by = \"stress_margin\", goal = \"max\", count = 3 }\nhistograms = [{ of = \"axial_force_N\", bins = 5 }]\nsample = 40";
    let (one, two) = (outcome(both, 1), outcome(both, 2));
    assert_eq!((&one.top, &one.sample), (&two.top, &two.sample));
    let (top, sample) = (one.top.expect("it is asked for"), one.sample.expect("it is asked for"));
    let designs: Vec<u64> = (0..sample.rows()).filter_map(|row| sample.design(row)).collect();
    assert_eq!((top.rows(), designs.len(), designs.is_sorted()), (3, 40, true));
    let margins: Vec<f64> = (0..3).filter_map(|row| top.number("stress_margin", row)).collect();
    assert!(margins.len() == 3 && margins.is_sorted_by(|a, b| a >= b), "{margins:?}");
    let alone = outcome("[report]\nsample = 40", 1);
    assert_eq!((alone.top.is_none(), alone.sample.map(|it| it.rows())), (true, Some(40)));
    assert!(outcome("", 1).sample.is_none());
}

#[test]
fn what_is_wrong_is_a_variant_with_its_fields() {
    let Error::Study(errors) =
        Error::from(Study::parse("model = \"metal-cvt\"\n[design]\nband_cuont = [1, 2]").expect_err("there is no such input"))
    else {
        panic!("it is the study that is wrong")
    };
    let slip = errors.problems.iter().find(|it| it.message.contains("did you mean \"band_count\"?"));
    assert_eq!(slip.map(|it| (it.line, it.file.as_str())), Some((3, "study")), "{errors}");

    let study = shipped("metal-cvt");
    let control = Arc::new(Control::default());
    control.stop.store(true, Ordering::Relaxed);
    let stopped = study.sweep(Options::default().engine(Engine::Cpu).control(control)).expect_err("it is stopped");
    assert!(matches!(stopped, Error::Stopped { kept: None }));
    assert_eq!(stopped.to_string(), "stopped");

    let nothing = Stored::read(Path::new("no/such/folder")).expect_err("there is no result");
    assert!(matches!(nothing, Error::Io { .. }), "{nothing}");
}

#[cfg(not(feature = "gpu"))]
#[test]
fn a_gpu_is_refused_where_it_is_not_built_in() {
    let refused = shipped("metal-cvt").sweep(Options::default().engine(Engine::Gpu)).expect_err("there is none");
    assert!(matches!(refused, Error::Request(_)) && refused.to_string().contains("build it with the feature gpu"), "{refused}");
}

#[test]
fn a_table_read_back_has_words_and_numbers() {
    let stored = Stored::read(&committed("pulley-design")).expect("it is a result");
    let kinds = |name: &str| stored.front.column(name).map(|column| matches!(column.data, Data::Number(_)));
    assert_eq!((stored.front.design(0).is_some(), kinds("mass_g"), kinds("max_stress_MPa_scenario")), (true, Some(true), Some(false)));
}

#[test]
fn the_examples_run() {
    sweep::main().expect("it sweeps");
    evaluate::main().expect("it evaluates");
    own_model::main().expect("every engine gives the same");
    read::main().expect("it reads");
    uncertain::main().expect("it draws");
    #[cfg(feature = "gpu")]
    engine::main().expect("both engines agree");
}
