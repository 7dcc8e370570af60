//! Random formulas: every number type agrees with a plain walk over the tree, and no text is too strange.

use super::*;
use crate::real::{LANES, Lanes, Real};
use crate::tape::{Interval, Known, List, Recording, Trace};

/// The same numbers in every run.
pub(super) struct RandomTree(u64);

impl RandomTree {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number of the sequence "splitmix64".
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    fn one<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Any tree, whether it means something or not.
    pub(super) fn tree(&mut self, depth: usize) -> Expression {
        let node = match if depth == 0 { self.below(3) } else { self.below(10) } {
            0 => {
                let unit = [None, None, Some("mm".to_owned()), Some("kg/m^3".to_owned())][self.below(4)].clone();
                ExpressionNode::Number(f64::from_bits(self.next() >> 2 & 0x7fdf_ffff_ffff_ffff).min(1e308), unit)
            }
            1 => ExpressionNode::Name((*self.one(&["a", "pi", "belt_mass_kg"])).to_owned()),
            2 => ExpressionNode::Word((*self.one(&["machined", "it's", "pressed-cup", "\"x\"", ""])).to_owned()),
            3 => ExpressionNode::Negative(Box::new(self.tree(depth - 1))),
            4..=6 => {
                let operators = [Operator::Add, Operator::Subtract, Operator::Multiply, Operator::Divide, Operator::Power];
                ExpressionNode::Binary(*self.one(&operators), Box::new(self.tree(depth - 1)), Box::new(self.tree(depth - 1)))
            }
            7 => {
                let all =
                    [ComparisonSign::Less, ComparisonSign::AtMost, ComparisonSign::Greater, ComparisonSign::AtLeast, ComparisonSign::Equal];
                ExpressionNode::If(*self.one(&all), Box::new(std::array::from_fn(|_| self.tree(depth - 1))))
            }
            8 => ExpressionNode::Root("r".to_owned(), Box::new(std::array::from_fn(|_| self.tree(depth - 1))), self.start(depth)),
            _ => {
                let arguments = self.below(4);
                ExpressionNode::Call((*self.one(&["min", "f", "slip"])).to_owned(), (0..arguments).map(|_| self.tree(depth - 1)).collect())
            }
        };
        Expression::new(node, 0..0)
    }

    /// Where a root starts, or nothing.
    fn start(&mut self, depth: usize) -> Option<Box<Expression>> {
        (self.below(2) == 0).then(|| Box::new(self.tree(depth - 1)))
    }

    /// The text of a formula for a plain number.
    fn plain(&mut self, depth: usize, roots: bool) -> String {
        if depth == 0 {
            return match self.below(3) {
                0 => format!("{}", self.below(60) as f64 / 8.0),
                _ => (*self.one(&NAMES)).to_owned(),
            };
        }
        let part = |random: &mut Self| random.plain(depth - 1, roots);
        match self.below(if roots { 20 } else { 19 }) {
            0..=4 => {
                let (a, b) = (part(self), part(self));
                format!("({a}) {} ({b})", self.one(&["+", "-", "*", "/"]))
            }
            5 => format!("-({})", part(self)),
            6 => format!("({})^{}", part(self), *self.one(&["0", "1", "2", "3", "8", "-1", "-3", "10", "0.5", "1.7", "-0.25"])),
            7 => format!("({})^({})", part(self), part(self)),
            8 | 9 => {
                let (a, b, x, y) = (part(self), part(self), part(self), part(self));
                format!("if({a} {} {b}, {x}, {y})", self.one(&["<", "<=", ">", ">="]))
            }
            10 => format!("if(round({}) == band_count, {}, {})", part(self), part(self), part(self)),
            11 | 12 => {
                let function = *self.one(&["abs", "sqrt", "exp", "ln", "log10", "exp_m1", "ln_1p", "tanh"]);
                format!("{function}({})", part(self))
            }
            13 => format!("{}(({}) * 1[rad])", *self.one(&["sin", "cos", "tan"]), part(self)),
            14 => format!("{}({}) / 1[rad]", *self.one(&["asin", "acos", "atan"]), part(self)),
            15 => format!("{}({}, {})", *self.one(&["min", "max", "hypot", "1[1/rad] * atan2"]), part(self), part(self)),
            16 => format!("{}({})", *self.one(&["round", "floor", "ceil"]), part(self)),
            17 => format!("slip(({}) * 1[m/s])", part(self)),
            18 => format!("clamp({}, {}, {})", part(self), part(self), part(self)),
            _ => {
                let (a, b) = (self.plain(1, false), self.plain(depth - 1, false));
                format!("root(r, {a}, 20, r^3 + 2 * r + exp_m1(r / 5) - ({b}))")
            }
        }
    }
}

const NAMES: [&str; 4] = ["friction", "band_count", "pulley_teeth", "slip_margin"];

/// Why a plain walk ends.
#[derive(Debug, PartialEq)]
enum TreeEnd {
    /// The formula has no value.
    Status,
    /// A number overflowed, which is not the formulas' business.
    Overflow,
}

fn kept(condition: bool, value: f64) -> Result<f64, TreeEnd> {
    match (condition, value.is_finite()) {
        (false, _) => Err(TreeEnd::Status),
        (true, false) => Err(TreeEnd::Overflow),
        (true, true) => Ok(value),
    }
}

/// A formula as its tree says, branches only where they are taken. Units are such as are 1 in SI.
fn walk(expression: &Expression, name: &dyn Fn(&str) -> f64) -> Result<f64, TreeEnd> {
    let of = |expression: &Expression| walk(expression, name);
    let whole = |x: f64, by: fn(f64) -> f64| {
        let near = (x + 0.5).floor();
        if (x - near).abs() <= 1e-9 * x.abs().max(1.0) { near } else { by(x) }
    };
    match &expression.node {
        ExpressionNode::Number(value, _) => Ok(*value),
        ExpressionNode::Name(text) => Ok(name(text)),
        ExpressionNode::Negative(inner) => Ok(-of(inner)?),
        ExpressionNode::Binary(operator, a, b) => {
            let constant = b.names().is_empty();
            let (a, b) = (of(a)?, of(b)?);
            match operator {
                Operator::Add => kept(true, a + b),
                Operator::Subtract => kept(true, a - b),
                Operator::Multiply => kept(true, a * b),
                Operator::Divide => kept(b != 0.0, a / b),
                Operator::Power if constant && b.fract() == 0.0 && b.abs() <= 8.0 => {
                    let product = (1..b.abs() as usize).fold(if b == 0.0 { 1.0 } else { a }, |product, _| product * a);
                    if b >= 0.0 {
                        return kept(true, product);
                    }
                    kept(a != 0.0, 1.0 / product)
                }
                Operator::Power => {
                    if constant && b > 0.0 && a == 0.0 {
                        return Ok(0.0);
                    }
                    if a <= 0.0 {
                        return Err(TreeEnd::Status);
                    }
                    let exponent = b * Real::ln(a);
                    kept((constant && b.abs() <= 0.9) || exponent <= 700.0, Real::exp(exponent.min(700.0)))
                }
            }
        }
        ExpressionNode::If(comparison, parts) => {
            let [a, b, then, otherwise] = &**parts;
            let (a, b) = (of(a)?, of(b)?);
            let taken = match comparison {
                ComparisonSign::Less => a < b,
                ComparisonSign::AtMost => a <= b,
                ComparisonSign::Greater => a > b,
                ComparisonSign::AtLeast => a >= b,
                ComparisonSign::Equal => a == b,
            };
            of(if taken { then } else { otherwise })
        }
        ExpressionNode::Call(function, arguments) => {
            let all = arguments.iter().map(of).collect::<Result<Vec<f64>, TreeEnd>>()?;
            let (x, y) = (all[0], all.get(1).copied().unwrap_or(0.0));
            match function.as_str() {
                "abs" => Ok(if x < 0.0 { -x } else { x.abs() }),
                "sqrt" => kept(x >= 0.0, x.sqrt()),
                "exp" => kept(x <= 700.0, Real::exp(x)),
                "exp_m1" => kept(x <= 700.0, libm::expm1(x)),
                "ln" => kept(x > 0.0, Real::ln(x)),
                "log10" => kept(x > 0.0, Real::log10(x)),
                "ln_1p" => kept(x > -1.0, libm::log1p(x)),
                "tanh" => Ok(Real::tanh(x)),
                "sin" => Ok(libm::sin(x)),
                "cos" => Ok(libm::cos(x)),
                "tan" => kept(true, Real::tan(x)),
                "asin" => kept(x.abs() <= 1.0, libm::asin(x)),
                "acos" => kept(x.abs() <= 1.0, Real::acos(x)),
                "atan" => Ok(Real::atan(x)),
                "atan2" => Ok(Real::atan2(x, y)),
                "hypot" => kept(true, Real::hypot(x, y)),
                "min" => Ok(if y < x { y } else { x }),
                "max" => Ok(if y > x { y } else { x }),
                "clamp" => {
                    let above = if y > x { y } else { x };
                    Ok(if all[2] < above { all[2] } else { above })
                }
                "round" => Ok((x + 0.5).floor()),
                "floor" => Ok(whole(x, f64::floor)),
                "ceil" => Ok(whole(x, f64::ceil)),
                "slip" => {
                    let on = |x: f64, a: (f64, f64), b: (f64, f64)| a.1 + (x - a.0) * ((b.1 - a.1) / (b.0 - a.0));
                    let value = if x == 20.0 {
                        0.15
                    } else if x >= 10.0 {
                        on(x, (10.0, 0.2), (20.0, 0.15))
                    } else {
                        on(x, (0.0, 0.1), (10.0, 0.2))
                    };
                    kept((0.0..=20.0).contains(&x), value)
                }
                other => panic!("no {other} here"),
            }
        }
        other => panic!("no {other:?} here"),
    }
}

/// The scope, a formula, and its numbers.
struct RandomCase {
    formulas: Formulas,
    slots: Vec<f64>,
    text: String,
}

/// Evaluated over a number type: value, then margins.
fn over<R: Real>(case: &RandomCase, slots: &[R]) -> Vec<R> {
    let mut slots = slots.to_vec();
    let mut margins = vec![R::constant(0.0); case.formulas.requirements().len()];
    case.formulas.evaluate_all(&mut slots, &mut vec![None; case.formulas.slots()], &mut margins);
    [vec![slots[case.formulas.all()[0].slot]], margins].concat()
}

/// Formulas that can be checked, with numbers; those of whose constants there is no value are left out.
fn cases(seed: u64, count: usize, depth: usize, roots: bool) -> Vec<RandomCase> {
    let mut random = RandomTree::new(seed);
    let scope = scope();
    let mut cases = Vec::new();
    while cases.len() < count {
        let text = random.plain(depth, roots);
        let Ok(formulas) = Formulas::new(&scope, &sources(&[("it", &text)])) else { continue };
        let mut slots = vec![1.0; formulas.slots()];
        for name in NAMES {
            let whole = random.below(6) as f64 - 1.0;
            let any = [whole, random.between(-3.0, 3.0), random.between(0.0, 1.0)][random.below(3)];
            let slot = scope.slot(name).expect("a name");
            slots[slot] = if scope.names[slot].whole { whole } else { any };
        }
        cases.push(RandomCase { formulas, slots, text });
    }
    cases
}

fn status(case: &RandomCase, margins: &[f64]) -> bool {
    case.formulas.requirements().iter().zip(margins).any(|(it, &margin)| if it.strict { margin <= 0.0 } else { margin < 0.0 })
}

#[test]
fn f64_agrees_with_a_walk_over_the_tree() {
    let scope = scope();
    let (mut good, mut failed, mut seen) = (0, 0, 0);
    for case in cases(1, 20_000, 4, false) {
        let by = |name: &str| scope.slot(name).map_or(std::f64::consts::PI, |slot| case.slots[slot]);
        let expression = &case.formulas.all()[0].expression;
        let got = over(&case, &case.slots);
        let is_bad = status(&case, &got[1..]);
        match walk(expression, &by) {
            Ok(value) => {
                good += 1;
                assert!(!is_bad, "{} has a value", case.text);
                assert!(value.to_bits() == got[0].to_bits() || value == got[0], "{}: {value} and {}", case.text, got[0]);
                // A walk over another tree is noticed.
                let other = swapped(expression);
                seen += usize::from(other != *expression && walk(&other, &by) != Ok(got[0]));
            }
            Err(TreeEnd::Status) => {
                failed += 1;
                assert!(is_bad, "{} has no value, but came to {}", case.text, got[0]);
                assert!(!got[0].is_nan(), "{}", case.text);
            }
            Err(TreeEnd::Overflow) => {}
        }
    }
    assert!(good > 5000 && failed > 3000 && seen > 2000, "{good} {failed} {seen}");
}

/// The same tree with its sums turned into differences and the other way round, and all comparisons reversed.
fn swapped(expression: &Expression) -> Expression {
    let boxed = |of: &Expression| Box::new(swapped(of));
    let node = match &expression.node {
        ExpressionNode::Negative(of) => ExpressionNode::Negative(boxed(of)),
        ExpressionNode::Binary(operator, a, b) => {
            let operator = match operator {
                Operator::Add => Operator::Subtract,
                Operator::Subtract => Operator::Add,
                other => *other,
            };
            ExpressionNode::Binary(operator, boxed(a), boxed(b))
        }
        ExpressionNode::If(comparison, parts) => {
            let comparison = match comparison {
                ComparisonSign::Less => ComparisonSign::AtLeast,
                ComparisonSign::AtLeast => ComparisonSign::Less,
                ComparisonSign::Greater => ComparisonSign::AtMost,
                ComparisonSign::AtMost => ComparisonSign::Greater,
                ComparisonSign::Equal => ComparisonSign::Equal,
            };
            ExpressionNode::If(comparison, Box::new(std::array::from_fn(|part| swapped(&parts[part]))))
        }
        ExpressionNode::Call(name, arguments) => ExpressionNode::Call(name.clone(), arguments.iter().map(swapped).collect()),
        other => other.clone(),
    };
    Expression::new(node, expression.span.clone())
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

#[test]
fn lanes_have_the_bits_of_f64() {
    let mut random = RandomTree::new(7);
    let mut differ = 0;
    for case in cases(2, 3000, 4, true) {
        let mut rows: Vec<Vec<f64>> = (0..LANES).map(|_| case.slots.clone()).collect();
        rows[1..].iter_mut().flatten().for_each(|slot| *slot += random.between(-1.0, 1.0));
        let lanes: Vec<Lanes> = (0..case.slots.len()).map(|slot| Lanes(std::array::from_fn(|lane| rows[lane][slot]))).collect();
        let together = over(&case, &lanes);
        let alone: Vec<Vec<f64>> = rows.iter().map(|row| over(&case, row)).collect();
        for (at, lanes) in together.iter().enumerate() {
            for (lane, row) in alone.iter().enumerate() {
                assert!(same(lanes.0[lane], row[at]), "{}: {} and {}", case.text, lanes.0[lane], row[at]);
            }
        }
        differ += usize::from(alone[1][0] != alone[0][0]);
    }
    assert!(differ > 1000, "{differ}");
}

#[test]
fn recorded_formulas_have_the_bits_of_f64() {
    let mut operations = 0;
    for case in cases(3, 3000, 4, true) {
        let (recording, nodes) = Recording::of(&vec![Known::ANY; case.slots.len()], |named: &[Trace]| over(&case, named));
        let list = List::cut(&recording, &nodes.into_iter().map(Some).collect::<Vec<_>>());
        let (recorded, direct) = (list.run::<f64>(&case.slots), over(&case, &case.slots));
        for (recorded, direct) in recorded.iter().zip(&direct) {
            assert!(same(*recorded, *direct), "{}: {recorded} and {direct}", case.text);
        }
        operations += list.operations.len();
    }
    assert!(operations > 30_000, "{operations}");
}

#[test]
fn an_interval_holds_every_value_of_its_box() {
    let mut random = RandomTree::new(9);
    let (mut known, mut narrow, mut all) = (0, 0, 0);
    for case in cases(4, 3000, 3, true) {
        let half = [1e-9, 1e-3, 0.3][random.below(3)];
        let widths: Vec<f64> = case.slots.iter().map(|_| half * random.between(0.0, 1.0)).collect();
        let boxed: Vec<Interval> = case.slots.iter().zip(&widths).map(|(at, width)| Interval::new(at - width, at + width)).collect();
        let ranges = over(&case, &boxed);
        for corner in 0..6 {
            let point: Vec<f64> = boxed
                .iter()
                .map(|range| match corner {
                    0 => range.low,
                    1 => range.high,
                    _ => random.between(range.low, range.high).max(range.low).min(range.high),
                })
                .collect();
            for (range, value) in ranges.iter().zip(over(&case, &point)) {
                all += 1;
                known += usize::from(range.is_finite());
                narrow += usize::from(range.is_finite() && range.width() < 10.0 * half);
                assert!(value.is_nan() || range.contains(value), "{}: {value} is not in {range:?}", case.text);
            }
        }
    }
    assert!(known * 10 > all * 5 && narrow * 10 > all * 3, "{known} and {narrow} of {all}");
}

#[test]
fn the_deepest_formula_fits_on_a_small_stack() {
    let scope = scope();
    for (before, behind) in [
        ("1 + (", ")"),
        ("-(", ")"),
        ("min(1, ", ")"),
        ("(", ")^1.5"),
        ("slip(1[m/s] * (", "))"),
        ("if(friction < ", ", 1, 2)"),
        ("if(friction < 1, 1, ", ")"),
        ("default(slip_margin, ", ")"),
    ] {
        let levels = |count: usize| format!("{}friction{}", before.repeat(count), behind.repeat(count));
        let deepest = (1..MOST_DEPTH).rev().find(|&count| Expression::parse(&levels(count)).is_ok()).expect("some");
        for text in [levels(deepest), format!("root(r, 0, 1, r - ({}))", levels(deepest - 2))] {
            let formulas = Formulas::new(&scope, &sources(&[("it", &text)])).unwrap_or_else(|problems| panic!("{text}: {}", problems[0]));
            let case = RandomCase { slots: vec![0.5; formulas.slots()], formulas, text };
            let run = move || {
                let lanes = over(&case, &vec![Lanes::splat(0.5); case.slots.len()]);
                assert!(lanes[0].0[0].is_finite() || case.text.contains("^1.5"), "{}", case.text);
                assert_eq!(over(&case, &vec![Interval::point(0.5); case.slots.len()]).len(), lanes.len());
            };
            let thread = std::thread::Builder::new().stack_size(1 << 20).spawn(run).expect("a thread");
            thread.join().expect("it fits");
        }
    }
}

#[test]
fn no_text_breaks_the_language() {
    let mut random = RandomTree::new(5);
    let scope = scope();
    let pieces: Vec<&str> = vec![
        "(",
        ")",
        "[",
        "]",
        ",",
        "+",
        "-",
        "*",
        "/",
        "^",
        "<",
        "<=",
        "==",
        "=",
        "'",
        "\"",
        ".",
        "e",
        "1e9",
        "0",
        "7",
        "[mm]",
        "[1/s]",
        "if(",
        "root(r,",
        "sin(",
        "default(",
        "slip(",
        "min(",
        "friction",
        "radius_mm",
        "slip_margin",
        "section",
        "'machined'",
        "traction",
        "pi",
        "r",
        "é",
        "°",
        "−",
        "\n",
        "\0",
        " ",
        "^-1",
        "^(1/3)",
        "nominal(",
        "1e308",
        "EUR",
        "[m^12]",
        "a",
        "b_mm",
        "🦀",
    ];
    let starts = ["2 * band_count * radius_mm", "if(section == 'machined', 1, friction^2.5)", "root(r, 0, 10, r^3 - friction) + sqrt(a)"];
    let (mut good, mut bad) = (0, 0);
    for _ in 0..20_000 {
        let mut text = if random.below(4) == 0 { random.plain(3, true) } else { (*random.one(&starts)).to_owned() };
        for _ in 0..random.below(6) {
            let at = (0..=random.below(text.len() + 1)).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
            let end = (at..=(at + random.below(8)).min(text.len())).rev().find(|&end| text.is_char_boundary(end)).unwrap_or(at);
            match random.below(4) {
                0 => text.replace_range(at..end, ""),
                1 => text = format!("{}{}", &text[..end], &text[at..]),
                2 => text.replace_range(at..end, random.one::<&str>(&pieces)),
                _ => text.insert_str(at, random.one::<&str>(&pieces)),
            }
        }
        match Formulas::new(&scope, &sources(&[("it", &text), ("a", "friction"), ("b_mm", "2 * radius_mm")])) {
            Ok(formulas) => {
                good += 1;
                let mut slots = vec![0.5; formulas.slots()];
                let mut margins = vec![0.0_f64; formulas.requirements().len()];
                formulas.evaluate_all(&mut slots, &mut vec![None; formulas.slots()], &mut margins);
                assert!(margins.iter().all(|margin| !margin.is_nan()), "{text}: {margins:?}");
            }
            Err(problems) => {
                bad += 1;
                for problem in problems {
                    assert!(!problem.message.is_empty() && problem.line >= 1 && problem.column >= 1, "{problem}");
                    assert!(problem.at <= text.len().max(16) && problem.message.len() < 500, "{problem}");
                }
            }
        }
    }
    assert!(good > 2000 && bad > 5000, "{good} {bad}");
}
