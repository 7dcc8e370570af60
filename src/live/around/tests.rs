//! Slices around a design.

use super::places::edges;
use super::*;
use crate::live::given::given_ranges;
use crate::study::study_of;

/// A push belt whose thickness has many more levels than a slice has places.
fn plan(levels: &str) -> Plan {
    let text = format!(
        "[design]\nband_thickness_mm = {levels}\nband_count = [6, 9]\n[fixed]\ntorque_Nm = 100\nstrength_MPa = 900\ntraction = 0.3\n[operation]\nratio = {{ from = 0.5, to = 2, count = 9 }}\n\
         [constraints]\nstress_margin = {{ min = 0 }}\n[objectives]\naxial_force_N = \"min\"\n"
    );
    Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right"))
}

#[test]
fn the_end_of_what_is_feasible_is_the_very_level() {
    let plan = plan("{ from = 0.1, to = 0.4, count = 3001 }");
    let control = Control::default();
    let columns = certify::columns(&plan.study);
    let all: Vec<u64> = (0..plan.designs()).collect();
    let feasible: Vec<bool> = certify::rows(&plan, &columns, &all, 2, &control).expect("rows").iter().map(|it| it.feasible).collect();
    let design = (0..plan.designs()).find(|&it| feasible[it as usize]).expect("some are feasible");
    let count = plan.space.inputs(design, 0);
    let own = |at: u64| plan.space.inputs(at, 0)[plan.study.design[1].inputs()[0]] == count[plan.study.design[1].inputs()[0]];
    let thickness = |at: u64| plan.space.inputs(at, 0)[plan.study.design[0].inputs()[0]];
    let mut line: Vec<(f64, bool)> = all.iter().filter(|&&at| own(at)).map(|&at| (thickness(at), feasible[at as usize])).collect();
    line.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (_, slices) = around(&plan, design, PLACES, 2, &control).expect("slices");
    let slice = &slices[0];
    assert!(slice.values.len() < 80 && slice.values.len() as u64 <= most_designs(PLACES));
    let here = slice.values.iter().position(|it| *it == slice.own).expect("its own place");
    let [_, up] = edges(&slice.rows, here);
    let (last, next) = up.expect("it ends somewhere");
    let at = line.iter().position(|(value, _)| *value == slice.values[next]).expect("it is a level");
    assert!(line[at - 1].0 == slice.values[last] && line[at - 1].1 && !line[at].1, "{:?}", &line[at - 1..=at]);
    // The slice over the bands has their two levels, and no other.
    assert_eq!(slices[1].values, [6.0, 9.0]);
}

#[test]
fn the_largest_load_that_a_design_bears_is_found() {
    let text = "[design]\nband_thickness_mm = [0.15, 0.2]\n[operation]\ntorque_Nm = [50, 100]\nratio = { from = 0.5, to = 2, count = 5 }\n[fixed]\nstrength_MPa = 900\ntraction = 0.3\n\
                [constraints]\nstress_margin = { min = 0 }\n[objectives]\naxial_force_N = \"min\"\n";
    let study = |torque: f64| {
        let text = text.replace("[50, 100]", &format!("[50, {torque:?}]"));
        study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right")
    };
    let plan = Plan::new(study(100.0));
    let control = Control::default();
    let load = |axis: usize, from: f64, to: f64| {
        let input = plan.study.operation[axis].inputs()[0];
        GivenRange::End(ScenarioEnd { is_uncertain: false, axis, input, is_largest: true, from, to })
    };
    let given = [load(0, 50.0, 400.0), load(1, 0.5, 2.5)];
    let (columns, slices) = around_with(&plan, 1, PLACES, &given, 2, &control).expect("slices");
    let slice = &slices[1];
    assert_eq!((slice.name.as_str(), slice.own, slices.len()), ("torque_Nm, the largest", 100.0, 3));
    // Each place is the study that has this load, its own place that of the study.
    assert_eq!(slice.values[0], 50.0);
    // A study may not list a load twice.
    for (value, row) in slice.values.iter().zip(&slice.rows).skip(1) {
        let alone = &certify::rows(&Plan::new(study(*value)), &columns, &[1], 1, &control).expect("a row")[0];
        let bits = |row: &Row| row.columns.iter().map(|at| at.value.map(f64::to_bits)).collect::<Vec<_>>();
        assert_eq!((bits(row), row.feasible), (bits(alone), alone.feasible), "{value} N m");
    }
    let here = slice.values.iter().position(|it| *it == slice.own).expect("its own place");
    let [down, up] = edges(&slice.rows, here);
    assert!(down.is_none() && up.is_some_and(|(last, next)| slice.values[next] - slice.values[last] < 0.2), "{:?}", slice.values);
    // The end of a range stretches it.
    assert_eq!(slices[2].values[0], 0.5);
    assert_eq!(slices[2].values.last(), Some(&2.5));
}

#[test]
fn an_uncertain_input_may_be_more_uncertain_as_far_as_the_design_bears_it() {
    let study = |levels: &str| {
        let text = format!(
            "[design]\nband_thickness_mm = [0.15, 0.2]\n[operation]\ntorque_Nm = [50, 100]\n[uncertainty]\n{levels}\n[fixed]\nstrength_MPa = 900\ntraction = 0.3\n\
             [constraints]\nslip_margin = {{ min = 0 }}\n[objectives]\naxial_force_N = \"min\"\n"
        );
        study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right")
    };
    let even = |from: f64| format!("friction = {{ from = {from:?}, to = 0.1, count = 3 }}\nratio = [1, 2]");
    let plan = Plan::new(study(&even(0.08)));
    let control = Control::default();
    let input = plan.study.model.input("friction").expect("it is an input");
    let end =
        |is_largest: bool, from: f64, to: f64| GivenRange::End(ScenarioEnd { is_uncertain: true, axis: 0, input, is_largest, from, to });
    let (columns, slices) = around_with(&plan, 1, PLACES, &[end(false, 0.01, 0.1), end(true, 0.08, 0.2)], 2, &control).expect("slices");
    let names: Vec<_> = slices[1..].iter().map(|it| (it.name.as_str(), it.own)).collect();
    assert_eq!(names, [("friction, the least", 0.08), ("friction, the largest", 0.1)]);
    let slice = &slices[1];
    // Each place is the study whose range begins there.
    for (value, row) in slice.values.iter().zip(&slice.rows).filter(|(value, _)| **value < 0.1) {
        let alone = &certify::rows(&Plan::new(study(&even(*value))), &columns, &[1], 1, &control).expect("a row")[0];
        let bits = |row: &Row| row.columns.iter().map(|at| at.value.map(f64::to_bits)).collect::<Vec<_>>();
        assert_eq!((bits(row), row.feasible), (bits(alone), alone.feasible), "friction {value}");
    }
    // Less friction makes it slip; more does not, where only slip is asked about.
    let here = |slice: &Slice| slice.values.iter().position(|it| *it == slice.own).expect("its own place");
    let [down, up] = edges(&slice.rows, here(slice));
    assert!(down.is_some_and(|(next, last)| slice.values[last] - slice.values[next] < 0.001) && up.is_none(), "{:?}", slice.values);
    assert_eq!(edges(&slices[2].rows, here(&slices[2])), [None, None]);
}

#[test]
fn where_something_is_drawn_a_load_is_that_of_every_draw() {
    let text = "[design]\nband_thickness_mm = [0.15, 0.2]\n[operation]\ncases = [{ torque_Nm = 50, ratio = 0.5 }, { torque_Nm = 100, ratio = 2 }, { torque_Nm = 100, ratio = 1 }]\n\
                [uncertainty]\nfriction = { normal = { mean = 0.09, sd = 0.005 } }\n[probability]\ndraws = 256\n[fixed]\nstrength_MPa = 900\ntraction = 0.3\n\
                [constraints]\nstress_margin = { min = 0 }\nyield = { min = 0.5 }\n[objectives]\nyield = \"max\"\n";
    let study = |torque: f64| {
        let text = text.replace("torque_Nm = 100", &format!("torque_Nm = {torque:?}"));
        study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right")
    };
    let plan = Plan::new(study(100.0));
    let control = Control::default();
    let input = plan.study.model.input("torque_Nm").expect("it is an input");
    let given = [GivenRange::End(ScenarioEnd { is_uncertain: false, axis: 0, input, is_largest: true, from: 50.0, to: 400.0 })];
    let (columns, slices) = around_with(&plan, 1, 9, &given, 2, &control).expect("slices");
    let slice = &slices[1];
    assert_eq!((slice.name.as_str(), slice.own), ("torque_Nm, the largest", 100.0));
    let mut yields = std::collections::BTreeSet::new();
    for (value, row) in slice.values.iter().zip(&slice.rows) {
        let alone = &certify::rows(&Plan::new(study(*value)), &columns, &[1], 1, &control).expect("a row")[0];
        let bits = |row: &Row| row.columns.iter().map(|at| at.value.map(f64::to_bits)).collect::<Vec<_>>();
        assert_eq!((bits(row), row.feasible), (bits(alone), alone.feasible), "{value} N m");
        yields.insert(bits(row));
    }
    assert!(yields.len() > 1, "more torque must cost yield");
}

#[test]
fn the_mean_of_a_distribution_moves_all_draws() {
    let study = |mean: f64, change: f64| {
        let text = format!(
            "[design]\nband_thickness_mm = [0.15, 0.2]\n[operation]\ntorque_Nm = [50, 100]\n[uncertainty]\nfriction = {{ normal = {{ mean = {mean:?}, sd = 0.005 }} }}\n\
             band_width_mm = {{ plus = {{ uniform = [{:?}, {:?}] }} }}\n[probability]\ndraws = 256\n[fixed]\nstrength_MPa = 900\ntraction = 0.3\n\
             [constraints]\nslip_margin = {{ min = 0 }}\nyield = {{ min = 0.5 }}\n[objectives]\nyield = \"max\"\naxial_force_N = {{ goal = \"min\", over_draws = \"mean\" }}\n\
             max_stress_MPa = {{ goal = \"min\", over_draws = \"mean\" }}\n",
            change - 0.1,
            change + 0.1
        );
        study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right")
    };
    let plan = Plan::new(study(0.09, 0.0));
    let control = Control::default();
    let given = [GivenRange::Mean { drawn: 0, from: 0.05, to: 0.12 }, GivenRange::Mean { drawn: 1, from: -0.5, to: 0.5 }];
    let (columns, slices) = around_with(&plan, 1, PLACES, &given, 2, &control).expect("slices");
    let told: Vec<_> = slices[1..].iter().map(|it| (it.name.as_str(), it.unit.as_str(), it.own)).collect();
    assert_eq!(told, [("friction, its mean", "", 0.09), ("band_width_mm, its mean deviation", "mm", 0.0)]);
    for (number, slice) in slices[1..].iter().enumerate() {
        let mut met = std::collections::HashSet::new();
        for (value, row) in slice.values.iter().zip(&slice.rows) {
            let moved = if number == 0 { study(*value, 0.0) } else { study(0.09, *value) };
            let alone = &certify::rows(&Plan::new(moved), &columns, &[1], 1, &control).expect("a row")[0];
            assert_eq!(row.feasible, alone.feasible, "{} {value}", slice.name);
            for (at, alone) in row.columns.iter().zip(&alone.columns) {
                match (at.value, alone.value) {
                    (Some(found), Some(wanted)) => {
                        assert!((found - wanted).abs() <= 1e-9 * wanted.abs(), "{} {value}: {found} {wanted}", slice.name);
                        met.insert(found.to_bits());
                    }
                    (found, wanted) => assert_eq!(found, wanted, "{} {value}", slice.name),
                }
            }
        }
        assert!(met.len() > slice.values.len(), "{}: it makes a difference", slice.name);
    }
}

#[test]
fn places_are_levels_and_those_beside_the_design_are_there() {
    let levels = Levels::Step { from: 0.0, step: 1.0, count: 1000, log: false };
    let values = AxisPlaces::new(&levels, 401.0).some(33);
    assert!([400.0, 401.0, 402.0, 0.0, 999.0].iter().all(|it| values.contains(it)) && values.iter().all(|it| it.fract() == 0.0));
    assert_eq!(spread(5, 33, 2), [0, 1, 2, 3, 4]);
    assert_eq!(spread(100, 3, 7), [0, 7, 50, 99]);
    // A zero is one place, whichever sign it has.
    let around_zero = AxisPlaces::new(&Levels::List(vec![-1.0, 0.0, 1.0]), -0.0);
    assert!(matches!(around_zero, AxisPlaces::Levels { ref levels, own: 1 } if levels.len() == 3));
    let anywhere = AxisPlaces::new(&Levels::Continuous { from: 1.0, to: 100.0, log: true }, 10.0);
    assert_eq!(anywhere.between(1.0, 100.0), Some(10.0));
}

#[test]
fn words_and_rows_of_a_catalogue_have_slices_too() {
    let text = "[design]\ncases = [{ band_count = 6, band_thickness_mm = 0.2 }, { band_count = 9, band_thickness_mm = 0.15 }]\n\
                traction = [\"limit\", 0.3]\n[objectives]\naxial_force_N = \"min\"\n";
    let plan = Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), text).expect("the study is right"));
    let (_, slices) = around(&plan, 0, PLACES, 1, &Control::default()).expect("slices");
    let words: Vec<_> = slices.iter().map(|it| (it.name.as_str(), it.words.clone().expect("words"), it.rows.len())).collect();
    assert_eq!(words[0], ("band_count + band_thickness_mm", vec!["6, 0.2".to_owned(), "9, 0.15".to_owned()], 2));
    assert_eq!(words[1], ("traction", vec!["limit".to_owned(), "0.3".to_owned()], 2));
}

#[test]
fn rows_with_labels_are_called_by_them_and_by_what_tells_them_apart() {
    let text = |maker: &str| {
        format!(
            "labels = [\"grade\", \"maker\"]\n[design]\ncases = [{{ grade = \"thin\", maker = \"one\", band_thickness_mm = 0.2, band_count = 6 }}, \
             {{ grade = \"thin\", maker = \"{maker}\", band_thickness_mm = 0.2, band_count = 9 }}]\n[objectives]\naxial_force_N = \"min\"\n"
        )
    };
    let told = |maker: &str| {
        let study = study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text(maker)).expect("the study is right");
        let (_, slices) = around(&Plan::new(study), 0, PLACES, 1, &Control::default()).expect("slices");
        (slices[0].name.clone(), slices[0].words.clone().expect("words"))
    };
    assert_eq!(told("two"), ("grade + maker".to_owned(), vec!["thin, one".to_owned(), "thin, two".to_owned()]));
    // The thickness is the same and tells nothing.
    assert_eq!(told("one"), ("grade + maker + band_count".to_owned(), vec!["thin, one, 6".to_owned(), "thin, one, 9".to_owned()]));
}

#[test]
fn a_scenario_that_is_the_worst_by_rounding_only_is_no_other_one() {
    // Bending does not depend on the torque, and the radii depend on the ratio.
    let text = "[design]\nband_thickness_mm = [0.1, 0.15, 0.2]\n[operation]\ntorque_Nm = [50, 100]\nratio = [0.5, 2]\n\
                [objectives]\nbending_stress_MPa = \"min\"\n";
    let plan = Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), text).expect("the study is right"));
    let columns = certify::columns(&plan.study);
    let control = Control::default();
    let mut rows = certify::rows(&plan, &columns, &[0, 1, 2], 1, &control).expect("rows");
    let worst = rows[0].columns[0].scenario;
    let [of_other_torque, of_other_ratio] = [worst ^ 2, worst ^ 1];
    rows[1].columns[0].scenario = of_other_torque;
    rows[2].columns[0].scenario = of_other_ratio;
    // Another ratio has another stress, so this row stays as it is told.
    rows[2].columns[0].value = rows[2].columns[0].value.map(|it| 1.1 * it);
    certify::keep_scenarios(&plan, &columns, &mut rows, &control);
    let scenarios: Vec<u64> = rows.iter().map(|row| row.columns[0].scenario).collect();
    assert_eq!(scenarios, [worst, worst, of_other_ratio]);
}

/// A study of the pulley of a belt with this operation, and with these fixed inputs.
fn pulley(operation: &str, fixed: &str) -> (Plan, String) {
    let text = format!(
        "model = \"pulley-load\"\n[design]\nmean_radius_mm = [50, 60]\n[operation]\n{operation}[fixed]\n{fixed}\
         [constraints]\nfriction_margin = {{ min = 0 }}\n[objectives]\nresultant_force_N = \"min\"\ntight_end_flank_force_N_per_mm = \"min\"\n"
    );
    (Plan::new(crate::study::Study::parse(&text).unwrap_or_else(|errors| panic!("{errors}"))), text)
}

/// The values of a design's columns in the first of a study, by their bits.
fn bits_of(plan: &Plan, columns: &[Column]) -> Vec<Option<u64>> {
    let row = &certify::rows(plan, columns, &[0], 1, &Control::default()).expect("a row")[0];
    row.columns.iter().map(|at| at.value.map(f64::to_bits)).collect()
}

#[test]
fn each_word_of_a_load_is_looked_at_alone_and_a_fixed_word_beside_the_others() {
    let (plan, text) = pulley("tensioning = [\"slack\", \"fixed-centres\"]\n", "installed_tension_N = 500\nslack_tension_N = 500\n");
    let given = given_ranges(&plan.study, &text).said;
    assert!(given.iter().any(|it| matches!(it, GivenRange::Alone { is_uncertain: false, axis: 0 })), "{given:?}");
    let (columns, slices) = around_with(&plan, 0, PLACES, &given, 1, &Control::default()).expect("slices");
    let slice = slices.iter().find(|it| it.name == "tensioning").expect("it is a load");
    assert_eq!(slice.words.as_deref(), Some(&["all of them".to_owned(), "slack alone".to_owned(), "fixed-centres alone".to_owned()][..]));
    assert_eq!((slice.own, &slice.values[..]), (0.0, &[0.0, 1.0, 2.0][..]));
    let bits = |row: &Row| row.columns.iter().map(|at| at.value.map(f64::to_bits)).collect::<Vec<_>>();
    assert_eq!(bits(&slice.rows[0]), bits_of(&plan, &columns));
    let mut differing = std::collections::BTreeSet::new();
    for (word, row) in ["slack", "fixed-centres"].into_iter().zip(&slice.rows[1..]) {
        let (alone, text) = pulley("", &format!("tensioning = \"{word}\"\ninstalled_tension_N = 500\nslack_tension_N = 500\n"));
        assert_eq!(bits(row), bits_of(&alone, &columns), "{word}");
        differing.insert(bits(row));
        // The same word where the study fixes it.
        let given = given_ranges(&alone.study, &text).said;
        let (_, slices) = around_with(&alone, 0, PLACES, &given, 1, &Control::default()).expect("slices");
        let fixed = slices.iter().find(|it| it.name == "tensioning").expect("it is fixed");
        assert_eq!(fixed.words.as_deref(), Some(&["slack".to_owned(), "fixed-centres".to_owned()][..]));
        assert_eq!(fixed.own, if word == "slack" { 0.0 } else { 1.0 });
        assert_eq!(fixed.rows.iter().map(bits).collect::<Vec<_>>(), slice.rows[1..].iter().map(bits).collect::<Vec<_>>());
    }
    assert_eq!(differing.len(), 2, "the words make a difference");
}

#[test]
fn the_ends_of_a_load_in_whole_numbers_are_whole_and_its_levels_too() {
    for (operation, least, expected) in [
        ("groove_count = { from = 2, to = 6, step = 2 }\n", 2.0, "groove_count = [3, 5, 6]\n"),
        ("groove_count = [2, 4, 6]\n", 2.0, "groove_count = [3, 4, 6]\n"),
    ] {
        let (plan, text) = pulley(operation, "");
        let given = given_ranges(&plan.study, &text).said;
        let (columns, slices) = around_with(&plan, 0, PLACES, &given, 1, &Control::default()).expect("slices");
        let slice = slices.iter().find(|it| it.name == "groove_count, the least").expect("it is a load");
        assert!(slice.own == least && slice.values.iter().all(|it| it.fract() == 0.0), "{slice:?}");
        let bits = |at: f64| {
            let row = &slice.rows[slice.values.iter().position(|it| *it == at).expect("a whole number beside it")];
            row.columns.iter().map(|at| at.value.map(f64::to_bits)).collect::<Vec<_>>()
        };
        assert_eq!(bits(3.0), bits_of(&pulley(expected, "").0, &columns), "{operation}");
        assert_ne!(bits(3.0), bits(1.0));
        assert_eq!(bits(2.0), bits_of(&plan, &columns));
    }
}

#[test]
fn instead_of_a_word_some_numbers_are_looked_at() {
    let text =
        "model = \"metal-cvt\"\n[design]\nband_count = [6, 9]\n[fixed]\ntraction = \"limit\"\n[objectives]\naxial_force_N = \"min\"\n";
    let plan = Plan::new(crate::study::Study::parse(text).unwrap_or_else(|errors| panic!("{errors}")));
    let given = given_ranges(&plan.study, text).said;
    let (_, slices) = around_with(&plan, 0, PLACES, &given, 1, &Control::default()).expect("slices");
    let slice = slices.iter().find(|it| it.name == "traction").expect("it is fixed");
    let words = slice.words.as_ref().expect("one of them is a word");
    assert_eq!(slice.own, 0.0);
    assert_eq!(words[..], ["limit", "0.05", "0.1625", "0.275", "0.3875", "0.5", "0.6125", "0.725", "0.8375", "0.95"]);
}
