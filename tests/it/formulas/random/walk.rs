//! Formulas around a model, evaluated by walking over their trees, in other words than the crate's.
//!
//! Only the model itself is asked of the crate. A walk can be shaken: then every operation that rounds is off by a little. What is
//! another answer when shaken depends on rounding, and no second implementation can be expected to agree with it.

use super::measure::of_name;
use super::tree::{Curve, Named, Tree};
use beltspace::models::{Evaluation, Model, Status, evaluate};
use std::cell::Cell;
use std::collections::HashMap;
use std::sync::Arc;

/// How far a shaken operation is off, relative: far more than rounding, far less than what counts as a whole number.
const SHAKE: f64 = 2e-11;
/// What is so near to a whole number is one.
const NEAR_WHOLE: f64 = 1e-9;

/// Powers of e below this one are not told from zero by everyone.
const LEAST_EXPONENT: f64 = -700.0;

/// What a name stands for in a design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Held {
    /// In SI units.
    Value(f64),
    /// A word, by the number that encodes it.
    Word(f64),
    Absent,
    /// A formula failed on the way to it.
    Broken,
}

/// The numbers of a design by name.
pub type Numbers = HashMap<String, Held>;

/// A mistake to be noticed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slip {
    /// This function is taken for the other.
    Function(&'static str, &'static str),
    /// This operator is taken for the other.
    Operator(char, char),
    /// A curve goes on beyond its ends as it ends.
    CurveEnd,
    /// A number just below a whole one is not taken as that one.
    NearWhole,
    /// An absent value is zero.
    AbsentIsZero,
    /// A formula may give an input what it cannot be.
    NoRanges,
}

/// A model with formulas around it.
pub struct Walker {
    pub base: Arc<Model>,
    pub formulas: Vec<Named>,
    pub curves: Vec<Curve>,
    /// Other numbers shake otherwise; 0 does not.
    pub shake: u64,
    pub slip: Option<Slip>,
    /// Did something come up that has no meaning of its own, such as the difference of two infinite numbers?
    pub doubtful: Cell<bool>,
}

/// What one formula came to in a design.
pub struct FormulaResult {
    pub held: Held,
    /// Why it has no value.
    pub reason: Option<String>,
}

/// The value of a part, if it is there; an error if it failed.
type Part = Result<Option<f64>, ()>;

impl Walker {
    pub fn new(base: Arc<Model>) -> Self {
        Self { base, formulas: Vec::new(), curves: Vec::new(), shake: 0, slip: None, doubtful: Cell::new(false) }
    }

    /// The same with something else about it.
    pub fn with(&self, shake: u64, slip: Option<Slip>) -> Self {
        let (formulas, curves) = (self.formulas.clone(), self.curves.clone());
        Self { base: self.base.clone(), formulas, curves, shake, slip, doubtful: Cell::new(false) }
    }

    fn doubt(&self) {
        self.doubtful.set(true);
    }

    /// A result that is off by a little where that is asked for. `from` says which results are off alike.
    fn shaken(&self, value: f64, tag: &str, from: &[f64]) -> f64 {
        if value.is_nan() {
            self.doubt();
        }
        if self.shake == 0 {
            return value;
        }
        let bits = tag.bytes().map(u64::from).chain(from.iter().map(|it| (it + 0.0).to_bits()));
        let mixed = bits.fold(self.shake, |hash, it| {
            let mixed = (hash ^ it).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            mixed ^ mixed >> 29
        });
        let off = (mixed.wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        value * (1.0 + SHAKE * off)
    }

    /// What is exactly rounded everywhere, so that equal results are off alike; whole numbers of whole ones are exact.
    fn rounded(&self, value: f64, of: &[f64]) -> f64 {
        let whole = |it: &f64| it.fract() == 0.0 && it.abs() < 9e15;
        if value == 0.0 || (whole(&value) && of.iter().all(whole)) || of.contains(&value) {
            return value;
        }
        self.shaken(value, "", &[value])
    }

    /// A number of a name in SI units.
    pub fn si(&self, name: &str, value: f64) -> f64 {
        let measured = of_name(name);
        if measured.multiply == measured.divide { value } else { self.rounded(measured.to_si(value), &[]) }
    }

    fn unit(&self, name: &str, si: f64) -> f64 {
        let measured = of_name(name);
        if measured.multiply == measured.divide { si } else { self.rounded(measured.of_si(si), &[]) }
    }

    fn is_formula(&self, name: &str) -> bool {
        self.formulas.iter().any(|it| it.name == name)
    }

    /// Numbers of the formulas: each behind those that it reads, else as in the file.
    pub fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = Vec::new();
        while order.len() < self.formulas.len() {
            let done = |name: &&str| !self.is_formula(name) || order.iter().any(|&it| self.formulas[it].name == **name);
            let next = (0..self.formulas.len()).find(|it| !order.contains(it) && self.formulas[*it].tree.names().iter().all(done));
            order.push(next.expect("no formulas read each other in a circle"));
        }
        order
    }

    /// Does the formula read an output of the model, itself or through others?
    pub fn reads_outputs(&self, formula: usize) -> bool {
        self.formulas[formula].tree.names().iter().any(|name| {
            let other = self.formulas.iter().position(|it| it.name == *name);
            other.map_or(self.base.output(name).is_some(), |other| self.reads_outputs(other))
        })
    }

    /// The formula and all that read it, themselves or through others.
    fn dependents(&self, formula: usize) -> Vec<usize> {
        let mut found = vec![formula];
        for &other in &self.order() {
            let names = self.formulas[other].tree.names();
            if !found.contains(&other) && found.iter().any(|&it| names.contains(&self.formulas[it].name.as_str())) {
                found.push(other);
            }
        }
        found
    }

    /// The value of a formula, given what it reads.
    pub fn formula(&self, named: &Named, numbers: &Numbers) -> FormulaResult {
        let mut reasons = Vec::new();
        collect_reasons(&named.tree, &mut reasons);
        let mut walk = Walk { of: self, numbers, unknown: None, counts: true, reasons: &reasons, failed: Vec::new(), masked: Vec::new() };
        let value = walk.part(&named.tree);
        let first = walk.failed.iter().min();
        if first.is_some_and(|first| walk.masked.iter().any(|it| it < first)) {
            self.doubt();
        }
        let held = match value {
            Ok(Some(value)) => Held::Value(value),
            Ok(None) => Held::Absent,
            Err(()) => Held::Broken,
        };
        let failed = first.map(|&first| format!("formula {}: {}", named.name, reasons[first]));
        FormulaResult { held: if failed.is_some() { Held::Broken } else { held }, reason: failed }
    }

    /// A design in a scenario: values of the study's inputs in their units; what the study's model should say of it.
    pub fn evaluate(&self, model: &Model, inputs: &[f64]) -> Evaluation {
        let base = &self.base;
        let held = |input: &beltspace::models::Input, value: f64| match input.word_for(value) {
            Some(_) => Held::Word(value),
            None => Held::Value(self.si(&input.name, value)),
        };
        let mut numbers: Numbers =
            model.inputs.iter().zip(inputs).map(|(input, &value)| (input.name.clone(), held(input, value))).collect();
        let mut reasons: Vec<Option<String>> = vec![None; self.formulas.len()];
        let order = self.order();
        let mut run = |numbers: &mut Numbers, after: bool| {
            for &it in order.iter().filter(|&&it| self.reads_outputs(it) == after) {
                let result = self.formula(&self.formulas[it], numbers);
                numbers.insert(self.formulas[it].name.clone(), result.held);
                reasons[it] = result.reason;
            }
        };
        run(&mut numbers, false);

        // What the model is given; a word only where no formula gives the input.
        let mut given = Vec::new();
        let mut status = None;
        for input in &base.inputs {
            let value = match numbers[&input.name] {
                Held::Word(word) => word,
                Held::Value(si) if self.is_formula(&input.name) => self.unit(&input.name, si),
                Held::Value(_) => inputs[model.input(&input.name).expect("it is an input of the study's model")],
                Held::Absent | Held::Broken => f64::NAN,
            };
            if value.is_infinite() {
                self.doubt();
            }
            given.push(value);
        }
        // Formulas that give inputs are looked at in their order.
        for &it in &order {
            let name = &self.formulas[it].name;
            if let Some(number) = base.input(name) {
                let valid = base.inputs[number].valid;
                let (value, reason) = (given[number], format!("input {name} out of range"));
                if !valid.contains(value) && !value.is_nan() && self.slip != Some(Slip::NoRanges) {
                    let is_reason = |condition: &beltspace::models::Condition| condition.reason == reason;
                    let mut ends = model.conditions.iter().enumerate().filter(|(_, condition)| is_reason(condition)).map(|(at, _)| at);
                    let low = value <= valid.low;
                    status = status.or(if low { ends.next() } else { ends.next_back() });
                }
            }
        }
        let in_range = status.is_none() && given.iter().all(|it| !it.is_nan());
        let evaluation = in_range.then(|| evaluate(base, &given));
        for (at, output) in base.outputs.iter().enumerate() {
            let value = evaluation.as_ref().and_then(|it| it.outputs[at]);
            numbers.insert(output.name.clone(), value.map_or(Held::Absent, |value| Held::Value(self.si(&output.name, value))));
        }
        run(&mut numbers, true);

        let condition = |reason: &str| model.conditions.iter().position(|it| it.reason == reason).unwrap_or_else(|| panic!("no {reason}"));
        let failing = |after: bool| {
            let mut of = order.iter().filter(|&&it| self.reads_outputs(it) == after);
            of.find_map(|&it| reasons[it].as_ref()).map(|reason| condition(reason))
        };
        let of_base = evaluation.as_ref().and_then(|it| match it.status {
            Status::Failed(number) => Some(condition(&base.conditions[usize::from(number)].reason)),
            Status::Ok => None,
            Status::Overflow => {
                self.doubt();
                None
            }
        });
        let status = failing(false).or(status).or(of_base).or_else(|| failing(true));

        let mut taken = vec![false; self.formulas.len()];
        let mut nothing = !in_range;
        for (it, _) in reasons.iter().enumerate().filter(|(_, reason)| reason.is_some()) {
            let dependents = self.dependents(it);
            nothing |= dependents.iter().any(|&other| base.input(&self.formulas[other].name).is_some());
            dependents.into_iter().for_each(|other| taken[other] = true);
        }
        let mut overflow = false;
        let outputs = model.outputs.iter().map(|output| {
            let own = self.formulas.iter().position(|it| it.name == output.name);
            match numbers[&output.name] {
                _ if nothing || own.is_some_and(|own| taken[own]) => None,
                Held::Value(si) if own.is_some() => {
                    let value = self.unit(&output.name, si);
                    overflow |= !value.is_finite();
                    value.is_finite().then_some(value)
                }
                Held::Value(_) => evaluation.as_ref().and_then(|it| it.outputs[base.output(&output.name).expect("it is the model's")]),
                _ => None,
            }
        });
        let outputs: Vec<Option<f64>> = outputs.collect();
        let status = match status {
            Some(condition) => Status::failed(condition),
            None if overflow => Status::Overflow,
            None => Status::Ok,
        };
        Evaluation { status, outputs }
    }
}

/// A whole exponent that is multiplied out.
fn multiplied(exponent: f64) -> bool {
    exponent.fract() == 0.0 && exponent.abs() <= 8.0
}

/// The number that a tree of numbers alone comes to.
pub fn constant(tree: &Tree) -> Option<f64> {
    let (walker, numbers) = (Walker::new(beltspace::models::all()[0].clone()), Numbers::new());
    let mut reasons = Vec::new();
    tree.visit(&mut |part| reasons.extend(reason(part)));
    let mut walk =
        Walk { of: &walker, numbers: &numbers, unknown: None, counts: true, reasons: &reasons, failed: Vec::new(), masked: Vec::new() };
    walk.part(tree).ok().flatten().filter(|value| value.is_finite())
}

/// Why a part may have no value.
fn reason(tree: &Tree) -> Option<String> {
    let reason = match tree {
        Tree::Binary('/', parts) if !parts[1].is_constant() => "division by zero",
        Tree::Binary('^', parts) => match parts[1].is_constant().then(|| constant(&parts[1])).flatten() {
            Some(power) if multiplied(power) => return (power < 0.0).then(|| "division by zero".to_owned()),
            Some(power) if power > 0.0 => "power of a negative number",
            _ => "power of a number that is not positive",
        },
        Tree::Call("sqrt", _) => "root of a negative number",
        Tree::Call("ln" | "log10" | "ln_1p", _) => "logarithm of a number that is not positive",
        Tree::Call("asin", _) => "arc sine of a number beyond -1 to 1",
        Tree::Call("acos", _) => "arc cosine of a number beyond -1 to 1",
        Tree::Call("exp" | "exp_m1", _) => SIZE,
        Tree::Curve(name, _) => return Some(format!("{name} beyond its ends")),
        Tree::Root(_) => "no root between its ends",
        _ => return None,
    };
    Some(reason.to_owned())
}

const SIZE: &str = "exponent beyond 700";

/// Every reason why a formula may have no value, each once: those of operands in front of those of what is made of them.
fn collect_reasons(tree: &Tree, reasons: &mut Vec<String>) {
    if tree.is_constant() {
        return;
    }
    tree.parts().into_iter().for_each(|part| collect_reasons(part, reasons));
    let mut add = |reason: String| {
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    };
    if let Some(reason) = reason(tree) {
        let power = reason.starts_with("power");
        add(reason);
        if power {
            add(SIZE.to_owned());
        }
    }
}

/// A walk over one formula.
struct Walk<'w> {
    of: &'w Walker,
    numbers: &'w Numbers,
    unknown: Option<f64>,
    /// Does what fails here fail the formula?
    counts: bool,
    reasons: &'w [String],
    /// Numbers of the reasons that came up.
    failed: Vec<usize>,
    /// Numbers of reasons that may come up as well, of parts whose operands have failed.
    masked: Vec<usize>,
}

impl Walk<'_> {
    fn number_of(&self, reason: &str) -> Option<usize> {
        self.reasons.iter().position(|it| it == reason)
    }

    /// The value, if nothing is against it.
    fn needing(&mut self, holds: bool, tree: &Tree, value: f64) -> Part {
        match reason(tree) {
            Some(reason) if !holds => self.fails(&reason),
            _ => Ok(Some(value)),
        }
    }

    fn fails(&mut self, reason: &str) -> Part {
        if self.counts {
            let number = self.number_of(reason).unwrap_or_else(|| panic!("{reason} is no reason here"));
            self.failed.push(number);
        }
        Err(())
    }

    /// A part whose operands have failed: it may fail as well.
    fn mask(&mut self, tree: &Tree) -> Part {
        let mut reasons = Vec::new();
        reasons.extend(reason(tree));
        if reasons.iter().any(|it| it.starts_with("power")) {
            reasons.push(SIZE.to_owned());
        }
        if let Tree::If(_, parts) = tree {
            parts[2..].iter().for_each(|branch| collect_reasons(branch, &mut reasons));
        }
        self.masked.extend(reasons.iter().filter_map(|it| self.reasons.iter().position(|known| known == it)));
        Err(())
    }

    fn part(&mut self, tree: &Tree) -> Part {
        match tree {
            Tree::Number(value, None) => Ok(Some(*value)),
            Tree::Number(value, Some(bracket)) => Ok(Some(self.of.rounded(bracket.measured.to_si(*value), &[*value]))),
            Tree::Pi => Ok(Some(std::f64::consts::PI)),
            Tree::Unknown => Ok(self.unknown),
            Tree::Name(name) => match self.numbers[name] {
                Held::Value(value) => Ok(Some(value)),
                Held::Absent if self.of.slip == Some(Slip::AbsentIsZero) => Ok(Some(0.0)),
                Held::Absent => Ok(None),
                Held::Broken => Err(()),
                Held::Word(_) => panic!("{name} is a word"),
            },
            Tree::If(sign, parts) => {
                let (a, b) = (self.part(&parts[0]), self.part(&parts[1]));
                let (Ok(a), Ok(b)) = (a, b) else { return self.mask(tree) };
                let (Some(a), Some(b)) = (a, b) else { return Ok(None) };
                if a.is_infinite() && b.is_infinite() {
                    self.of.doubt();
                }
                let holds = match *sign {
                    "<" => a < b,
                    "<=" => a <= b,
                    ">" => a > b,
                    ">=" => a >= b,
                    _ => a == b,
                };
                self.part(&parts[if holds { 2 } else { 3 }])
            }
            Tree::IfWord(name, word, parts) => {
                let input = &self.of.base.inputs[self.of.base.input(name).expect("words are of inputs")];
                let code = input.words.iter().find(|(it, _)| it == word).expect("it is one of its words").1;
                self.part(&parts[if self.numbers[name] == Held::Word(code) { 0 } else { 1 }])
            }
            Tree::Call("default", parts) => match self.part(&parts[0])? {
                Some(value) => Ok(Some(value)),
                None => self.part(&parts[1]),
            },
            Tree::Root(parts) => self.root(tree, parts),
            _ => {
                let operands: Vec<Part> = tree.parts().into_iter().map(|part| self.part(part)).collect();
                let Ok(operands) = operands.into_iter().collect::<Result<Vec<Option<f64>>, ()>>() else { return self.mask(tree) };
                let Some(operands) = operands.into_iter().collect::<Option<Vec<f64>>>() else { return Ok(None) };
                self.combined(tree, &operands)
            }
        }
    }

    fn combined(&mut self, tree: &Tree, of: &[f64]) -> Part {
        let walker = self.of;
        let (x, y) = (of[0], of.get(1).copied().unwrap_or(0.0));
        match tree {
            Tree::Negative(_) => Ok(Some(-x)),
            Tree::Binary('^', parts) => self.power(tree, x, y, parts[1].is_constant()),
            Tree::Binary(operator, _) => {
                let operator = match walker.slip {
                    Some(Slip::Operator(taken, other)) if taken == *operator => other,
                    _ => *operator,
                };
                let value = match operator {
                    '+' => x + y,
                    '-' => x - y,
                    '*' => x * y,
                    _ if y == 0.0 => return self.needing(false, tree, 0.0),
                    _ => x / y,
                };
                Ok(Some(walker.rounded(value, of)))
            }
            Tree::Curve(name, _) => {
                let curve = walker.curves.iter().find(|it| it.name == *name).expect("there is such a curve");
                let points: Vec<(f64, f64)> = curve.points.iter().map(|&(x, y)| (walker.si(&curve.x, x), walker.si(&curve.y, y))).collect();
                let (first, last) = (points[0], points[points.len() - 1]);
                if walker.slip == Some(Slip::CurveEnd) && !(first.0..=last.0).contains(&x) {
                    return Ok(Some(if x < first.0 { first.1 } else { last.1 }));
                }
                let segment = points.windows(2).find(|pair| pair[0].0 <= x && x <= pair[1].0);
                let Some(&[from, to]) = segment else { return self.needing(false, tree, 0.0) };
                let share = (x - from.0) / (to.0 - from.0);
                let value = from.1 * (1.0 - share) + to.1 * share;
                Ok(Some(if share == 0.0 || share == 1.0 || from.1 == to.1 { value } else { walker.shaken(value, name, &[x]) }))
            }
            Tree::Call(function, _) => {
                let function = match walker.slip {
                    Some(Slip::Function(taken, other)) if taken == *function => other,
                    _ => function,
                };
                self.call(tree, function, of)
            }
            other => panic!("{other} is evaluated elsewhere"),
        }
    }

    fn power(&mut self, tree: &Tree, base: f64, exponent: f64, is_constant: bool) -> Part {
        if is_constant && multiplied(exponent) {
            let product = (0..exponent.abs() as i32).fold(1.0, |product, _| self.of.rounded(product * base, &[product, base]));
            let value = if exponent < 0.0 { self.of.rounded(1.0 / product, &[product]) } else { product };
            return self.needing(exponent >= 0.0 || base != 0.0, tree, value);
        }
        if base == 0.0 && is_constant && exponent > 0.0 {
            return Ok(Some(0.0));
        }
        if base <= 0.0 {
            return self.needing(false, tree, 0.0);
        }
        let size = exponent * base.ln();
        if size > 700.0 && !(is_constant && exponent.abs() <= 0.9) {
            return self.fails(SIZE);
        }
        if size < LEAST_EXPONENT {
            self.of.doubt();
        }
        if base == 1.0 || exponent == 0.0 {
            return Ok(Some(1.0));
        }
        Ok(Some(self.of.shaken(base.powf(exponent), "^", &[base, exponent])))
    }

    fn call(&mut self, tree: &Tree, function: &str, of: &[f64]) -> Part {
        let (x, y) = (of[0], of.get(1).copied().unwrap_or(0.0));
        let least = |of: &[f64]| of.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = |of: &[f64]| of.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let exact = |value: f64| Ok(Some(value));
        let whole = |by: fn(f64) -> f64| {
            let near = (x + 0.5).floor();
            let is_near = (x - near).abs() <= NEAR_WHOLE * x.abs().max(1.0) && self.of.slip != Some(Slip::NearWhole);
            exact(if is_near { near } else { by(x) })
        };
        let (value, holds) = match function {
            "min" => return exact(least(of)),
            "max" => return exact(largest(of)),
            "clamp" => return exact(x.max(y).min(of[2])),
            "abs" => return exact(x.abs()),
            "round" => return exact((x + 0.5).floor()),
            "floor" => return whole(f64::floor),
            "ceil" => return whole(f64::ceil),
            "sqrt" => (x.max(0.0).sqrt(), x >= 0.0),
            "exp" => (x.exp(), x <= 700.0),
            "exp_m1" => (x.exp_m1(), x <= 700.0),
            "ln" => (x.ln(), x > 0.0),
            "log10" => (x.log10(), x > 0.0),
            "ln_1p" => (x.ln_1p(), x > -1.0),
            "tanh" => (x.tanh(), true),
            "sin" => (x.sin(), true),
            "cos" => (x.cos(), true),
            "tan" => (x.tan(), true),
            "asin" => (x.asin(), x.abs() <= 1.0),
            "acos" => (x.acos(), x.abs() <= 1.0),
            "atan" => (x.atan(), true),
            "atan2" => (x.atan2(y), true),
            "hypot" => (x.hypot(y), true),
            other => panic!("no {other} here"),
        };
        if !holds {
            return self.needing(false, tree, 0.0);
        }
        if function == "exp" && x < LEAST_EXPONENT {
            self.of.doubt();
        }
        exact(self.of.shaken(value, function, of))
    }

    fn root(&mut self, tree: &Tree, parts: &[Tree; 3]) -> Part {
        let (from, to) = (self.part(&parts[0]), self.part(&parts[1]));
        let (Ok(from), Ok(to)) = (from, to) else { return self.mask(tree) };
        let (Some(from), Some(to)) = (from, to) else { return Ok(None) };
        // On the way to the root nothing that fails counts.
        let counts = std::mem::replace(&mut self.counts, false);
        let mut at = |unknown: f64| {
            self.unknown = Some(unknown);
            self.part(&parts[2])
        };
        let (below, above) = (at(from), at(to));
        let (Ok(below), Ok(above)) = (below, above) else {
            self.of.doubt();
            (self.counts, self.unknown) = (counts, None);
            return Err(());
        };
        let (Some(below), Some(above)) = (below, above) else {
            (self.counts, self.unknown) = (counts, None);
            return Ok(None);
        };
        let (mut low, mut high) = (from, if below == 0.0 { from } else { to });
        let holds = below <= 0.0 && above >= 0.0 && from <= to;
        loop {
            let middle = low + (high - low) / 2.0;
            if !holds || middle <= low || middle >= high {
                break;
            }
            match at(middle) {
                Ok(Some(value)) if value < 0.0 => low = middle,
                Ok(Some(_)) => high = middle,
                _ => panic!("{tree} has a value at both ends"),
            }
        }
        (self.counts, self.unknown) = (counts, None);
        let value = self.of.shaken(high, "root", &[high]);
        self.needing(holds, tree, value)
    }
}
