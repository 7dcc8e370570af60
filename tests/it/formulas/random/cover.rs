//! What the random studies had, so that they cannot end up testing nothing.

use super::Drawn;
use super::measure::{OWN, of_name};
use super::tree::Tree;
use crate::pipeline::Coverage;
use beltspace::models::Status;
use beltspace::plan::Plan;
use beltspace::study::{Best, Quantity};
use std::collections::BTreeSet;

/// What a few of all studies must have.
const FEATURES: &[&str] = &[
    // The language.
    "+",
    "-",
    "*",
    "/",
    "minus sign",
    "<",
    "<=",
    ">",
    ">=",
    "==",
    "== word",
    "if",
    "pi",
    "curve",
    "root",
    "default",
    "min",
    "max",
    "abs",
    "sqrt",
    "exp",
    "ln",
    "log10",
    "exp_m1",
    "ln_1p",
    "tanh",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "hypot",
    "clamp",
    "round",
    "floor",
    "ceil",
    "whole power",
    "negative power",
    "large power",
    "fractional power",
    "power of a formula",
    "unit",
    "composite unit",
    "own unit",
    "angle unit",
    // Where formulas stand.
    "gives an input",
    "gives a whole number",
    "gives an input by a curve",
    "reads a formula",
    "reads an output",
    "reads an output that may be absent",
    "formula as objective",
    "formula as constraint",
    "formula as top",
    "formula in a histogram",
    "formula in a map",
    "formula as column",
    "input as objective",
    "output as objective",
    "variable as objective",
    "variable in design",
    "variable in operation",
    "variable in fixed",
    // What happened.
    "division by zero",
    "root of a negative number",
    "logarithm of a number that is not positive",
    "arc sine of a number beyond -1 to 1",
    "power of a negative number",
    "exponent beyond 700",
    "beyond its ends",
    "no root between its ends",
    "out of range",
    "a status of the model",
    "absent formula",
    "absent formula, design feasible",
    "empty front",
    "front of 1",
    "front of at least 5",
    "some feasible",
    "several scenarios",
    "by bounds",
    "on the device",
];

/// Features that too few studies had. The short run has too few studies for the rare ones.
pub fn missing(coverage: &Coverage, full: bool) -> Vec<String> {
    let rare = |feature: &str| SHORT.contains(&feature);
    let wanted = FEATURES.iter().filter(|feature| full || rare(feature));
    let least = if full { 2 } else { 1 };
    wanted.filter(|feature| coverage.get(**feature).copied().unwrap_or(0) < least).map(|it| (*it).to_owned()).collect()
}

/// What even the short run has.
const SHORT: &[&str] = &[
    "+",
    "-",
    "*",
    "/",
    "minus sign",
    "if",
    "curve",
    "default",
    "min",
    "max",
    "abs",
    "sqrt",
    "clamp",
    "whole power",
    "unit",
    "own unit",
    "gives an input",
    "reads a formula",
    "reads an output",
    "formula as objective",
    "formula as constraint",
    "variable in design",
    "some feasible",
    "several scenarios",
    "by bounds",
    "on the device",
    "empty front",
    "front of 1",
];

/// Counts what a study had.
pub fn count(drawn: &Drawn, plan: &Plan, coverage: &mut Coverage) {
    let mut had: BTreeSet<String> = BTreeSet::new();
    let walker = &drawn.around.walker;
    let base = &walker.base;
    had.insert(base.name.clone());
    for formula in &walker.formulas {
        formula.tree.visit(&mut |part| language(part, &mut had));
        let mut note = |feature: &str, there: bool| {
            if there {
                had.insert(feature.to_owned());
            }
        };
        if let Some(input) = base.input(&formula.name) {
            note("gives an input", true);
            note("gives a whole number", base.inputs[input].integer);
            note("gives an input by a curve", matches!(formula.tree, Tree::Curve(..)));
        }
        for name in formula.tree.names() {
            note("reads a formula", walker.formulas.iter().any(|it| it.name == name));
            note("reads an output", base.output(name).is_some());
            let taken = base.conditions.iter().any(|it| it.invalidates.iter().any(|taken| taken == name));
            note("reads an output that may be absent", taken);
        }
        let powers = of_name(&formula.name).powers;
        note("own unit", powers[4] != 0 || powers[5] != 0);
    }
    roles(drawn, plan, &mut had);
    happened(drawn, plan, &mut had);
    for feature in had {
        *coverage.entry(feature).or_default() += 1;
    }
    let thrown = drawn.thrown;
    for (what, count) in [("meaningless", thrown.meaningless), ("unsure", thrown.unsure), ("one-sided", thrown.one_sided)] {
        *coverage.entry(format!("thrown away: {what}")).or_default() += count;
    }
}

fn language(part: &Tree, had: &mut BTreeSet<String>) {
    let mut note = |feature: &str| {
        had.insert(feature.to_owned());
    };
    match part {
        Tree::Pi => note("pi"),
        Tree::Negative(_) => note("minus sign"),
        Tree::Binary('^', parts) => match parts[1].is_constant().then(|| super::walk::constant(&parts[1])).flatten() {
            None => note("power of a formula"),
            Some(power) if power.fract() != 0.0 => note("fractional power"),
            Some(power) if power.abs() > 8.0 => note("large power"),
            Some(power) => note(if power < 0.0 { "negative power" } else { "whole power" }),
        },
        Tree::Binary(operator, _) => note(&operator.to_string()),
        Tree::If(sign, _) => {
            note("if");
            note(sign);
        }
        Tree::IfWord(..) => note("== word"),
        Tree::Call(function, _) => note(function),
        Tree::Curve(..) => note("curve"),
        Tree::Root(_) => note("root"),
        Tree::Number(_, Some(bracket)) => {
            note("unit");
            if bracket.text.contains([' ', '/', '*']) {
                note("composite unit");
            }
            if OWN.iter().any(|own| bracket.text.contains(own)) {
                note("own unit");
            }
            if bracket.measured.powers[3] != 0 {
                note("angle unit");
            }
        }
        Tree::Number(_, None) | Tree::Name(_) | Tree::Unknown => {}
    }
}

fn roles(drawn: &Drawn, plan: &Plan, had: &mut BTreeSet<String>) {
    let study = &plan.study;
    let kind = |quantity: Quantity| {
        let name = quantity.name(&study.model);
        let is_formula = drawn.around.walker.formulas.iter().any(|it| it.name == name);
        match quantity {
            _ if is_formula => "formula",
            Quantity::Output(_) => "output",
            Quantity::Input(_) if drawn.around.variables.iter().any(|it| it == name) => "variable",
            Quantity::Input(_) => "input",
        }
    };
    let report = &study.report;
    let used = [
        ("as objective", study.objectives.iter().map(|it| it.quantity).collect::<Vec<_>>()),
        ("as constraint", study.constraints.iter().map(|it| it.quantity).collect()),
        ("as top", report.top.iter().map(|it| it.by).collect()),
        ("in a histogram", report.histograms.iter().map(|it| it.of).collect()),
        ("as column", report.columns.iter().map(|it| it.of).collect()),
    ];
    for (role, quantities) in used {
        had.extend(quantities.into_iter().map(|it| format!("{} {role}", kind(it))));
    }
    for map in &report.maps {
        if let Best::Value(quantity, _) = map.value {
            had.insert(format!("{} in a map", kind(quantity)));
        }
    }
    for line in drawn.around.given.iter().filter(|it| drawn.around.variables.contains(&it.key)) {
        had.insert(format!("variable in {}", super::study::ROLES[line.role]));
    }
}

fn happened(drawn: &Drawn, plan: &Plan, had: &mut BTreeSet<String>) {
    let (model, evaluated, expected) = (&plan.study.model, &drawn.whole.evaluated, &drawn.expected);
    let own = drawn.around.walker.base.outputs.len()..model.outputs.len();
    for design in 0..evaluated.designs {
        let feasible = expected.feasible.binary_search(&design).is_ok();
        for case in evaluated.cases(design) {
            match case.evaluation.status {
                Status::Failed(number) => {
                    let reason = &model.conditions[usize::from(number)].reason;
                    let of_formula = reason.split_once(": ").filter(|_| reason.starts_with("formula ")).map(|(_, why)| why);
                    had.insert(match of_formula {
                        Some(why) if why.ends_with("beyond its ends") => "beyond its ends".to_owned(),
                        Some(why) => why.to_owned(),
                        None if reason.ends_with("out of range") => "out of range".to_owned(),
                        None => "a status of the model".to_owned(),
                    });
                }
                Status::Ok if case.evaluation.outputs[own.clone()].contains(&None) => {
                    had.insert("absent formula".to_owned());
                    if feasible {
                        had.insert("absent formula, design feasible".to_owned());
                    }
                }
                Status::Ok => {}
                Status::Overflow => {
                    had.insert("overflow".to_owned());
                }
            }
        }
    }
    let (feasible, front) = (expected.feasible.len() as u64, expected.front.len());
    let mut note = |feature: &str, there: bool| {
        if there {
            had.insert(feature.to_owned());
        }
    };
    let objectives = !plan.study.objectives.is_empty();
    note("empty front", objectives && front == 0);
    note("front of 1", front == 1);
    note("front of at least 5", front >= 5);
    note("nothing feasible", feasible == 0);
    note("all feasible", feasible == plan.designs());
    note("some feasible", feasible > 0 && feasible < plan.designs());
    note("between 2 % and 98 % feasible", (0.02..=0.98).contains(&(feasible as f64 / plan.designs() as f64)));
    note("several scenarios", evaluated.scenarios > 1);
}
