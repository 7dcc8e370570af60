//! Names of statistics, standard deviations, and standard errors of replicates, against plain sums over `evaluate`.

use super::random::parse;
use beltspace::certify::{columns, rows};
use beltspace::models::{Status, evaluate};
use beltspace::plan::Plan;
use beltspace::sweep::Control;

const DRAWN: &str = "model = \"metal-cvt\"\n[design]\nclamping_force_N = [26000, 27000, 30000]\n[operation]\nratio = [0.5, 1, 2]\n\
    [uncertainty]\nfriction = { uniform = [0.065, 0.085] }\nbelt_length_mm = [604, 613]\n\
    [probability]\ndraws = 256\nconfirm = 1\nmethod = \"latin-hypercube\"\n\
    [constraints]\nslip_margin = { min = 0 }\nspread = { of = \"slip_margin\", over_draws = \"sd\", max = 1 }\n\
    [objectives]\nyield = \"max\"\n[report]\ncolumns = [{ of = \"stress_margin\", over_draws = \"sd\" }]\n";
/// The drive that is drawn, as a study without distributions.
const DRIVE: &str = "model = \"metal-cvt\"\n[design]\nclamping_force_N = [26000, 27000, 30000]\n[operation]\nratio = [0.5, 1, 2]\n\
    [uncertainty]\nbelt_length_mm = [604, 613]\n[constraints]\nslip_margin = { min = 0 }\n[objectives]\naxial_force_N = \"min\"\n";

#[test]
fn a_spread_is_of_the_worst_case_of_each_draw_and_the_largest_of_the_levels() {
    let (drawn, drive) = (Plan::new(parse(DRAWN)), Plan::new(parse(DRIVE)));
    let model = &drive.study.model;
    let probability = drawn.study.probability.as_deref().expect("it has distributions");
    let frictions = probability.choosing().expect("they can be drawn").columns(0..256).remove(0);
    let friction = model.input("friction").expect("it is an input");
    let held = columns(&drawn.study);
    let column = |name: &str| held.iter().position(|it| it.name == name).unwrap_or_else(|| panic!("there is no {name}: {held:?}"));
    let told = rows(&drawn, &held, &[0, 1, 2], 1, &Control::default()).expect("nobody stops it");
    let (mut differ, mut errors, mut stressed) = (0, 0, 0);
    for (design, row) in told.iter().enumerate() {
        // Of each level.
        let mut found: Vec<(f64, f64, Option<f64>)> = Vec::new();
        for level in 0..2 {
            let (mut slips, mut stresses, mut holding) = (Vec::new(), Vec::new(), [0u32; 16]);
            for (draw, value) in frictions.iter().enumerate() {
                let cases: Vec<_> = (0..3)
                    .map(|case| {
                        let mut inputs = drive.space.inputs(design as u64, 2 * case + level);
                        inputs[friction] = *value;
                        evaluate(model, &inputs)
                    })
                    .collect();
                let least = |name: &str| {
                    let output = model.output(name).expect("it is an output");
                    // A case without a value leaves the draw without one.
                    let values: Option<Vec<f64>> = cases.iter().map(|it| it.outputs[output]).collect();
                    values.map_or(f64::NAN, |it| it.into_iter().fold(f64::INFINITY, f64::min))
                };
                slips.push(least("slip_margin"));
                stresses.push(least("stress_margin"));
                let holds = cases.iter().all(|it| it.status == Status::Ok) && least("slip_margin") >= 0.0;
                // Sixteen sets of sixteen draws.
                holding[draw / 16] += u32::from(holds);
            }
            let sd = |values: &[f64], less: f64| {
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                (values.iter().map(|it| (it - mean) * (it - mean)).sum::<f64>() / (values.len() as f64 - less)).sqrt()
            };
            let shares = holding.map(|it| f64::from(it) / 16.0);
            let error = (shares.iter().any(|it| *it != shares[0])).then(|| sd(&shares, 1.0) / 4.0);
            found.push((sd(&slips, 0.0), sd(&stresses, 0.0), error));
        }
        let close = |name: &str, wanted: f64| {
            let told = row.columns[column(name)].value.unwrap_or_else(|| panic!("{name} of design {design} is missing"));
            assert!((told / wanted - 1.0).abs() < 1e-9, "{name} of design {design}: {told} and {wanted}");
        };
        close("slip_margin_draw_sd", found[0].0.max(found[1].0));
        if found.iter().all(|it| it.1.is_finite()) {
            close("stress_margin_draw_sd", found[0].1.max(found[1].1));
            stressed += 1;
        }
        differ += u32::from(found[0].0 != found[1].0);
        let error = found.iter().filter_map(|it| it.2).reduce(f64::max);
        match error {
            Some(error) => close("yield_screened_standard_error", error),
            None => assert_eq!(row.columns[column("yield_screened_standard_error")].value, None, "design {design}"),
        }
        errors += u32::from(error.is_some());
    }
    assert!(differ > 1 && stressed > 0, "{differ} designs differ between levels, {stressed} have a stress in every draw");
    assert!(errors > 0 && errors < 3, "{errors} designs have a standard error");
}

#[test]
fn a_mean_over_cases_and_one_over_draws_have_names_of_their_own() {
    let text = "model = \"metal-cvt\"\n[design]\nclamping_force_N = [26000, 30000]\n\
        [operation]\nduty = { cases = [{ ratio = 0.5, share = 1 }, { ratio = 2, share = 3 }], weight = \"share\" }\n\
        [uncertainty]\nfriction = { uniform = [0.075, 0.085] }\n[probability]\ndraws = 16\nconfirm = 1\n[objectives]\nyield = \"max\"\n\
        [report]\ncolumns = [{ of = \"axial_force_N\", over_draws = \"mean\" },\n\
        { of = \"axial_force_N\", over_scenarios = \"mean\", over_draws = \"mean\" },\n\
        { of = \"axial_force_N\", over_scenarios = \"sum\", over_draws = { quantile = 0.999 } },\n\
        { of = \"axial_force_N\", over_draws = \"worst\" }, { of = \"axial_force_N\", over_draws = \"sd\" }]\n";
    let names: Vec<String> = columns(&parse(text)).into_iter().map(|it| it.name).collect();
    let expected = [
        "yield_screened",
        "axial_force_N_draw_mean",
        "axial_force_N_mean_draw_mean",
        "axial_force_N_sum_draw_q99_9",
        "axial_force_N_draw_worst",
        "axial_force_N_draw_sd",
        "yield",
        "yield_low",
        "yield_high",
    ];
    assert_eq!(names, expected);
}

#[test]
fn where_the_yield_is_an_objective_alone_one_draw_that_holds_makes_a_design_feasible() {
    let text = "model = \"metal-cvt\"\n[design]\nclamping_force_N = [10000, 22000, 30000]\n[operation]\nratio = [0.5, 2]\n\
        [uncertainty]\nfriction = { uniform = [0.07, 0.09] }\n[probability]\ndraws = 64\nconfirm = 1\n\
        [constraints]\nslip_margin = { min = 0 }\n[objectives]\nyield = \"max\"\n";
    let plan = Plan::new(parse(text));
    let held = columns(&plan.study);
    let told = rows(&plan, &held, &[0, 1, 2], 1, &Control::default()).expect("nobody stops it");
    let shares: Vec<f64> = told.iter().map(|it| it.columns[0].value.expect("a share is always known")).collect();
    assert!(held[0].name == "yield_screened" && shares[0] == 0.0 && shares[1] > 0.0 && shares[1] < 1.0 && shares[2] == 1.0, "{shares:?}");
    assert_eq!(told.iter().map(|it| it.feasible).collect::<Vec<_>>(), [false, true, true]);
}
