//! The equations that `beltspace models NAME` prints, read back as formulas and computed by a small evaluator of their own: they must give
//! what the model gives.

use crate::random::Random;
use beltspace::formula::{ComparisonSign, Expression, ExpressionNode, Operator};
use beltspace::models::{Model, evaluate, find};
use beltspace::tape::{EquationLine, FormulaEquations};
use std::collections::HashMap;
use std::f64::consts::PI;

/// Values by name.
type Values = HashMap<String, f64>;

/// A name that formulas may have.
fn legal(text: &str) -> String {
    text.replace('~', "_tilde").replace('\'', "_prime")
}

fn parsed(text: &str) -> Expression {
    Expression::parse(&legal(text)).unwrap_or_else(|problem| panic!("{text}: {}", problem.message))
}

/// The value of an expression. `inside`: the lines of the function of a root that it may have.
fn value(expression: &Expression, values: &Values, inside: &[(String, Expression)]) -> f64 {
    let of = |part: &Expression| value(part, values, inside);
    match &expression.node {
        ExpressionNode::Number(number, _) => *number,
        ExpressionNode::Name(name) if name == "pi" => PI,
        ExpressionNode::Name(name) => *values.get(name).unwrap_or_else(|| panic!("{name} is not computed before it is read")),
        ExpressionNode::Negative(part) => -of(part),
        ExpressionNode::Binary(operator, left, right) => match (operator, of(left), of(right)) {
            (Operator::Add, a, b) => a + b,
            (Operator::Subtract, a, b) => a - b,
            (Operator::Multiply, a, b) => a * b,
            (Operator::Divide, a, b) => a / b,
            (Operator::Power, a, b) => a.powf(b),
        },
        ExpressionNode::If(sign, parts) => {
            let [left, right, then, otherwise] = &**parts;
            let holds = match sign {
                ComparisonSign::AtLeast => of(left) >= of(right),
                ComparisonSign::AtMost => of(left) <= of(right),
                other => panic!("equations have no {other:?}"),
            };
            if holds { of(then) } else { of(otherwise) }
        }
        ExpressionNode::Root(unknown, parts, _) => {
            let [from, to, function] = &**parts;
            let (mut low, mut high) = (of(from), of(to));
            let at = |x: f64| {
                let mut values = values.clone();
                values.insert(unknown.clone(), x);
                for (name, line) in inside {
                    let number = value(line, &values, &[]);
                    values.insert(name.clone(), number);
                }
                value(function, &values, &[])
            };
            for _ in 0..200 {
                let middle = (low + high) / 2.0;
                if at(middle) < 0.0 { low = middle } else { high = middle }
            }
            (low + high) / 2.0
        }
        ExpressionNode::Call(name, arguments) => {
            let arguments: Vec<f64> = arguments.iter().map(of).collect();
            match (&name[..], &arguments[..]) {
                ("min", [a, b]) => a.min(*b),
                ("max", [a, b]) => a.max(*b),
                ("abs", [a]) => a.abs(),
                ("sqrt", [a]) => a.sqrt(),
                ("sin", [a]) => a.sin(),
                ("cos", [a]) => a.cos(),
                ("asin", [a]) => a.asin(),
                ("exp_m1", [a]) => a.exp_m1(),
                ("ln_1p", [a]) => a.ln_1p(),
                ("floor", [a]) => a.floor(),
                _ => panic!("{name} of {} numbers", arguments.len()),
            }
        }
        other => panic!("equations have no {other:?}"),
    }
}

/// Everything that the equations compute of inputs in SI units, and the margins.
fn computed(model: &Model, equations: &FormulaEquations, si: &[f64]) -> (Values, Vec<f64>) {
    let fields = model.kernel.formula().expect("it can be recorded").fields();
    let symbol = |symbol: &str, field: &str| {
        if symbol.is_empty() || legal(symbol).contains([' ', '/', '(', '*']) { field.to_owned() } else { legal(symbol) }
    };
    let mut values: Values =
        model.inputs.iter().zip(fields.inputs).zip(si).map(|((it, field), &value)| (symbol(&it.symbol, field), value)).collect();
    let mut lines = equations.lines.iter().peekable();
    while let Some(EquationLine { depth, left, right, .. }) = lines.next() {
        assert_eq!(*depth, 0, "{left}");
        let mut inside = Vec::new();
        while let Some(line) = lines.next_if(|line| line.depth > 0) {
            inside.push((legal(&line.left), parsed(&line.right)));
        }
        let number = value(&parsed(right), &values, &inside);
        assert!(values.insert(legal(left), number).is_none(), "{left} is computed twice");
    }
    let margins = equations.margins.iter().map(|margin| value(&parsed(margin), &values, &[])).collect();
    (values, margins)
}

/// Compares what the equations give with the model at random inputs; returns how many numbers were compared.
fn compare(model: &Model, equations: &FormulaEquations) -> Result<usize, String> {
    let fields = model.kernel.formula().expect("it can be recorded").fields();
    let mut random = Random::new(7);
    let mut compared = 0;
    for _ in 0..200 {
        let inputs: Vec<f64> = model
            .inputs
            .iter()
            .map(|it| {
                let (low, high) = it.usual;
                let value = low + (high - low) * random.unit();
                if !it.words.is_empty() && random.chance(0.3) {
                    return random.word(&it.words);
                }
                if it.integer { value.round() } else { value }
            })
            .collect();
        let si: Vec<f64> = model
            .inputs
            .iter()
            .zip(&inputs)
            .map(|(it, &value)| if it.word_for(value).is_some() { value } else { it.unit.to_si(value) })
            .collect();
        let (values, margins) = computed(model, equations, &si);
        let evaluation = evaluate(model, &inputs);
        let near = |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-9 * scale.max(a.abs());
        for (condition, (own, margin)) in margins.iter().zip(model.kernel.margins(&model.kernel.prepared(&si), &si)).enumerate() {
            if margin.is_finite() && !near(*own, margin, 1e-3) {
                return Err(format!("condition {condition}: {own}, not {margin}"));
            }
            compared += 1;
            // What comes after a condition that fails need not mean anything.
            if margin <= 0.0 {
                break;
            }
        }
        for ((output, field), expected) in model.outputs.iter().zip(fields.outputs).zip(&evaluation.outputs) {
            let Some(expected) = *expected else { continue };
            let names = [legal(&output.symbol), (*field).to_owned()];
            let own = names.iter().find_map(|name| values.get(name)).ok_or(format!("{field} is not computed"))?;
            let own = output.unit.from_si(*own);
            if !near(own, expected, 1e-6) {
                return Err(format!("{}: {own}, not {expected}", output.name));
            }
            compared += 1;
        }
    }
    Ok(compared)
}

#[test]
fn the_printed_equations_compute_what_the_model_computes() {
    for name in ["metal-cvt", "rubber-cvt", "pulley-load", "flat-belt"] {
        let model = find(name).expect("it is a model");
        let equations = model.equations().expect("it has equations");
        let compared = compare(&model, &equations).unwrap_or_else(|problem| panic!("{name}: {problem}"));
        assert!(compared > 1000, "{name}: {compared}");
        // A wrong line is found.
        let mut wrong = equations.clone();
        let line = wrong.lines.iter_mut().rev().find(|line| line.right.contains(" / ")).expect("something is divided");
        line.right = line.right.replacen(" / ", " * ", 1);
        assert!(compare(&model, &wrong).is_err(), "{name}");
    }
}

#[test]
fn loops_stand_once_and_a_model_without_a_formula_has_no_equations() {
    let equations = find("timing-belt").expect("it is a model").equations().expect("it has equations");
    let heading = |line: &&EquationLine| line.left.is_empty();
    assert!(equations.lines.iter().filter(heading).all(|line| line.right.starts_with("for k from ")));
    assert!(equations.lines.iter().filter(heading).count() >= 3 && equations.lines.len() < 200);
    assert!(find("pulley").expect("it is a model").equations().is_none());
}
