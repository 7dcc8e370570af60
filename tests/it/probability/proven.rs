//! Proven bounds of the yield in tables: those that `eval` tells, on any number of threads, and refused before anything is swept.

use beltspace::bounds::YieldBounds;
use beltspace::{Options, Study};

const STUDY: &str = r#"model = "metal-cvt"
[design]
clamping_force_N = [24000, 26000, 28000]
[operation]
cases = [{ torque_Nm = 90, ratio = 0.5 }, { torque_Nm = 90, ratio = 2.0 }]
[uncertainty]
friction       = { normal = { mean = 0.08, sd = 0.005 }, from = 0.06, to = 0.10 }
belt_length_mm = { plus = { normal = { mean = 0, sd = 0.3 } } }
[probability]
confirm   = 4000
enclosure = true
[constraints]
slip_margin = { min = 0 }
yield       = { min = 0.99 }
[objectives]
yield            = "max"
clamping_force_N = "min"
[report]
top = { by = "clamping_force_N", count = 3 }
"#;

#[test]
fn tables_have_the_proven_bounds_of_every_reported_design() {
    let study = Study::parse(STUDY).expect("a study");
    let bounds = YieldBounds::asked(&study).expect("they can be proven").expect("they are asked for");
    for threads in [1, 3] {
        let outcome = study.sweep(Options::default().threads(threads)).expect("it is swept");
        assert!(outcome.front.rows() >= 2);
        for table in [&outcome.front, outcome.top.as_ref().expect("it is asked for")] {
            for row in 0..table.rows() {
                let value = |name: &str| table.number(name, row).unwrap_or_else(|| panic!("there is no {name}"));
                let proven = bounds.of(value("design_index") as u64, bounds.width(), YieldBounds::BOXES).expect("they can be proven");
                assert_eq!((value("yield_at_least"), value("yield_at_most")), (proven.at_least, proven.at_most));
                // Wide enough for 4000 draws, narrow enough to tell something.
                assert!(value("yield_at_least") <= value("yield_high") && value("yield_low") <= value("yield_at_most"));
                assert!(value("yield_at_most") - value("yield_at_least") <= 0.001 + 1e-12);
            }
        }
    }
}

#[test]
fn without_the_wish_there_are_no_such_columns() {
    let study = Study::parse(&STUDY.replace("enclosure = true", "")).expect("a study");
    let outcome = study.sweep(Options::default()).expect("it is swept");
    assert_eq!((outcome.front.number("yield_at_least", 0), outcome.front.number("yield", 0).is_some()), (None, true));
}

#[test]
fn what_cannot_be_proven_is_refused_before_anything_is_swept() {
    let laws =
        ["strength_MPa", "elastic_modulus_MPa", "band_width_mm"].map(|it| format!("{it} = {{ times = {{ uniform = [0.9, 1.1] }} }}\n"));
    let study = Study::parse(&STUDY.replace("[probability]", &format!("{}[probability]", laws.concat()))).expect("a study");
    let error = study.sweep(Options::default()).expect_err("there are too many inputs").to_string();
    let expected =
        "enclosure: 5 inputs have distributions, and bounds of the yield are for at most 4; drop enclosure, or give the others levels";
    assert_eq!(error, expected);
}
