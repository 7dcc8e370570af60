//! Checks what a formula means: names, dimensions, whole numbers, words. What comes out can be evaluated.

mod call;

use super::dimension::QuantityDimension;
use super::evaluate::constant;
use super::expression::{ComparisonSign, Expression, ExpressionNode, Operator};
use super::function::{FUNCTIONS, is_reserved};
use super::problem::Fault;
use super::scope::Scope;
use super::typed::{IfTest, MOST_PARAMETERS, Need, Typed};
use crate::likeness::remedy;

/// Most problems that are told of one formula.
const MOST_PROBLEMS: usize = 20;

/// Why a value cannot be computed.
pub(super) mod reason {
    pub const ZERO: &str = "division by zero";
    pub const ROOT: &str = "root of a negative number";
    pub const LOGARITHM: &str = "logarithm of a number that is not positive";
    pub const ARC_SINE: &str = "arc sine of a number beyond -1 to 1";
    pub const ARC_COSINE: &str = "arc cosine of a number beyond -1 to 1";
    pub const NEGATIVE_BASE: &str = "power of a negative number";
    pub const BASE: &str = "power of a number that is not positive";
    pub const SIZE: &str = "exponent beyond 700";
    pub const NO_ROOT: &str = "no root between its ends";
}

/// What a name stands for.
#[derive(Clone, Debug)]
pub(super) struct SlotType {
    pub(super) name: String,
    pub(super) dimension: QuantityDimension,
    pub(super) whole: bool,
    /// Words that it may be.
    pub(super) words: Vec<(String, f64)>,
    pub(super) only_words: bool,
    /// Slots of the names whose absence makes it absent.
    pub(super) absent: Vec<usize>,
}

/// What a part of a formula measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum QuantityType {
    Of(QuantityDimension),
    /// A bare 0, which fits every dimension.
    Zero,
    /// Something is wrong with it that has been told.
    Broken,
}

impl QuantityType {
    fn dimension(self) -> Option<QuantityDimension> {
        match self {
            Self::Of(dimension) => Some(dimension),
            Self::Zero => Some(QuantityDimension::NONE),
            Self::Broken => None,
        }
    }
}

/// A checked part of a formula.
#[derive(Clone, Debug)]
pub(super) struct CheckedTree {
    pub(super) typed: Typed,
    pub(super) kind: QuantityType,
    /// Is every value a whole number?
    pub(super) whole: bool,
    /// Slots of the names whose absence makes it absent, in increasing order.
    pub(super) absent: Vec<usize>,
    /// Does it depend on the unknown of the root around it?
    varies: bool,
}

impl CheckedTree {
    fn new(typed: Typed, kind: QuantityType, whole: bool, of: &[&Self]) -> Self {
        let mut absent: Vec<usize> = of.iter().flat_map(|part| part.absent.iter().copied()).collect();
        absent.sort_unstable();
        absent.dedup();
        Self { typed, kind, whole, absent, varies: of.iter().any(|part| part.varies) }
    }

    fn broken() -> Self {
        Self { typed: Typed::Constant(1.0), kind: QuantityType::Broken, whole: true, absent: Vec::new(), varies: false }
    }
}

/// The unknown of a root while its expression is checked.
struct Unknown<'e> {
    name: &'e str,
    kind: QuantityType,
    parameters: Vec<usize>,
}

/// Checks one formula.
pub(super) struct Checker<'s, 'e> {
    pub(super) scope: &'s Scope,
    pub(super) slots: &'s [SlotType],
    pub(super) faults: Vec<Fault>,
    pub(super) needs: Vec<Need>,
    pub(super) roots: usize,
    unknown: Option<Unknown<'e>>,
    /// Slots and words of the comparisons of which the branch that is being checked is the other one.
    excluded: Vec<(usize, &'e str)>,
}

impl<'s, 'e> Checker<'s, 'e> {
    pub(super) fn new(scope: &'s Scope, slots: &'s [SlotType]) -> Self {
        Self { scope, slots, faults: Vec::new(), needs: Vec::new(), roots: 0, unknown: None, excluded: Vec::new() }
    }

    fn fault(&mut self, at: usize, message: impl Into<String>) -> CheckedTree {
        if self.faults.len() < MOST_PROBLEMS {
            self.faults.push(Fault::new(at, message));
        }
        CheckedTree::broken()
    }

    fn need(&mut self, reason: impl Into<String>, strict: bool) -> usize {
        let need = Need { reason: reason.into(), strict };
        self.needs.iter().position(|known| *known == need).unwrap_or_else(|| {
            self.needs.push(need);
            self.needs.len() - 1
        })
    }

    fn words(&self, kind: QuantityType) -> String {
        match kind {
            QuantityType::Of(dimension) => self.scope.units.in_words(dimension),
            QuantityType::Zero => "zero".to_owned(),
            QuantityType::Broken => "something unknown".to_owned(),
        }
    }

    /// Checks an expression.
    pub(super) fn check(&mut self, expression: &'e Expression) -> CheckedTree {
        if self.faults.len() >= MOST_PROBLEMS {
            return CheckedTree::broken();
        }
        let needs = self.needs.len();
        let checked = match &expression.node {
            ExpressionNode::Number(value, unit) => self.number(*value, unit.as_deref(), expression),
            ExpressionNode::Name(name) => self.name(name, expression.span.start),
            ExpressionNode::Word(word) => {
                self.fault(expression.span.start, format!("the word '{word}' can be compared only: if(NAME == '{word}', x, y)"))
            }
            ExpressionNode::Negative(of) => {
                let of = self.check(of);
                CheckedTree::new(Typed::Negative(Box::new(of.typed.clone())), of.kind, of.whole, &[&of])
            }
            ExpressionNode::Binary(operator, left, right) => self.binary(*operator, left, right),
            ExpressionNode::If(comparison, parts) => self.choice(*comparison, parts, expression.span.start),
            ExpressionNode::Root(unknown, parts, start) => self.root(unknown, parts, start.as_deref(), expression.span.start),
            ExpressionNode::Call(name, arguments) => self.call(name, arguments, expression.span.start),
        };
        self.folded(checked, needs, expression.span.start)
    }

    /// The number that an expression without names comes to.
    fn folded(&mut self, checked: CheckedTree, needs: usize, at: usize) -> CheckedTree {
        if checked.kind == QuantityType::Broken {
            return checked;
        }
        match constant(&checked.typed, self.scope, &self.needs) {
            None => checked,
            Some(Ok(value)) if value.is_finite() => {
                self.needs.truncate(needs);
                CheckedTree { typed: Typed::Constant(value), ..checked }
            }
            Some(Ok(_)) => self.fault(at, "this comes to a number beyond 1.8e308"),
            Some(Err(reason)) => self.fault(at, format!("this has no value: {reason}")),
        }
    }

    fn number(&mut self, value: f64, unit: Option<&str>, expression: &Expression) -> CheckedTree {
        let kind = |dimension| if value == 0.0 && unit.is_none() { QuantityType::Zero } else { QuantityType::Of(dimension) };
        let Some(text) = unit else {
            return CheckedTree::new(Typed::Constant(value), kind(QuantityDimension::NONE), value.fract() == 0.0, &[]);
        };
        match self.scope.units.read(text) {
            Ok(measure) => CheckedTree::new(Typed::Constant(measure.to_si(value)), kind(measure.dimension), false, &[]),
            Err(wrong) => self.fault(expression.span.end - 1 - text.len() + wrong.at, wrong.message),
        }
    }

    fn name(&mut self, name: &'e str, at: usize) -> CheckedTree {
        if name == "pi" {
            return CheckedTree::new(Typed::Constant(std::f64::consts::PI), QuantityType::Of(QuantityDimension::NONE), false, &[]);
        }
        if let Some(unknown) = self.unknown.as_ref().filter(|unknown| unknown.name == name) {
            let checked = CheckedTree::new(Typed::Unknown, unknown.kind, false, &[]);
            return CheckedTree { varies: true, ..checked };
        }
        let Some(slot) = self.slots.iter().position(|slot| slot.name == name) else {
            let message = self.unknown_name(name);
            return self.fault(at, message);
        };
        let slots = self.slots;
        let known = &slots[slot];
        let is_excluded = |word: &str| !known.only_words && self.excluded.contains(&(slot, word));
        if let Some((word, _)) = known.words.iter().find(|(word, _)| !is_excluded(word)) {
            let but = if known.only_words { "is a word" } else { "may be a word" };
            return self.fault(at, format!("{name} {but}, and no number can be computed from it; write if({name} == '{word}', x, y)"));
        }
        self.slot(slot, at)
    }

    /// The value in a slot, whatever it is.
    fn slot(&mut self, slot: usize, at: usize) -> CheckedTree {
        let slots = self.slots;
        let known = &slots[slot];
        let typed = match &mut self.unknown {
            None => Typed::Slot(slot),
            Some(unknown) => {
                let number = unknown.parameters.iter().position(|&known| known == slot).unwrap_or(unknown.parameters.len());
                if number == MOST_PARAMETERS {
                    return self.fault(
                        at,
                        format!("the expression of a root reads at most {MOST_PARAMETERS} names; give what {name} is part of a formula of its own", name = known.name),
                    );
                }
                if number == unknown.parameters.len() {
                    unknown.parameters.push(slot);
                }
                Typed::Parameter(number)
            }
        };
        let absent = known.absent.clone();
        CheckedTree { typed, kind: QuantityType::Of(known.dimension), whole: known.whole, absent, varies: false }
    }

    fn unknown_name(&self, name: &str) -> String {
        if self.scope.curves.iter().any(|curve| curve.name == name) {
            return format!("{name} is a curve; write {name}(x)");
        }
        if let Some((.., usage, _)) = FUNCTIONS.iter().find(|(function, ..)| *function == name) {
            return format!("{name} is a function; write {usage}");
        }
        if is_reserved(name) {
            return format!(
                "{name} is a function; write {}",
                if name == "if" { "if(a < b, x, y)" } else { "root(r, from, to, expression)" }
            );
        }
        let curves = self.scope.curves.iter().map(|curve| curve.name.as_str());
        let known: Vec<&str> = self.slots.iter().map(|slot| slot.name.as_str()).chain(curves).chain(["pi"]).collect();
        let otherwise = || "it is no input, output, variable, formula or curve".to_owned();
        format!("unknown name \"{name}\"; {}", remedy(name, &known, otherwise))
    }

    /// What two parts measure that must measure the same.
    fn unified(&mut self, left: &CheckedTree, right: &CheckedTree, at: usize, message: impl FnOnce(&str, &str) -> String) -> QuantityType {
        match (left.kind, right.kind) {
            (QuantityType::Broken, _) | (_, QuantityType::Broken) => QuantityType::Broken,
            (QuantityType::Zero, other) | (other, QuantityType::Zero) => other,
            (QuantityType::Of(a), QuantityType::Of(b)) if a == b => left.kind,
            (a, b) => {
                let mut message = message(&self.words(a), &self.words(b));
                // A bare number beside a quantity most likely lacks its unit.
                let bare = |part: &CheckedTree| part.typed.constant().filter(|_| part.kind == QuantityType::Of(QuantityDimension::NONE));
                let wanted = |kind: QuantityType| kind.dimension().map(|it| it.in_base_units(self.scope.units.own())).unwrap_or_default();
                let hint = bare(left).map(|it| (it, wanted(b))).or_else(|| bare(right).map(|it| (it, wanted(a))));
                if let Some((value, unit)) = hint.filter(|(_, unit)| !unit.is_empty()) {
                    message += &format!("; write the number with its unit, such as {value}[{unit}]");
                }
                self.fault(at, message);
                QuantityType::Broken
            }
        }
    }

    fn binary(&mut self, operator: Operator, left_part: &'e Expression, right_part: &'e Expression) -> CheckedTree {
        let (left, right) = (self.check(left_part), self.check(right_part));
        let at = left_part.span.start;
        if operator == Operator::Power {
            return self.power(&left, &right, right_part.span.start);
        }
        let parts = Box::new([left.typed.clone(), right.typed.clone()]);
        let whole = left.whole && right.whole && operator != Operator::Divide;
        let (typed, kind) = match operator {
            Operator::Add => (Typed::Sum(parts), self.unified(&left, &right, at, |a, b| format!("{a} and {b} cannot be added"))),
            Operator::Subtract => {
                (Typed::Difference(parts), self.unified(&left, &right, at, |a, b| format!("{b} cannot be subtracted from {a}")))
            }
            Operator::Multiply => (Typed::Product(parts), self.product(left.kind, right.kind, at, QuantityDimension::times)),
            Operator::Divide | Operator::Power => {
                let divisor = right.typed.constant();
                if divisor == Some(0.0) && right.kind != QuantityType::Broken {
                    return self.fault(right_part.span.start, "this is always zero, and nothing can be divided by it");
                }
                let need = divisor.is_none().then(|| self.need(reason::ZERO, true));
                (Typed::Quotient(parts, need), self.product(left.kind, right.kind, at, QuantityDimension::over))
            }
        };
        CheckedTree::new(typed, kind, whole, &[&left, &right])
    }

    fn product(
        &mut self,
        left: QuantityType,
        right: QuantityType,
        at: usize,
        of: impl Fn(QuantityDimension, QuantityDimension) -> Option<QuantityDimension>,
    ) -> QuantityType {
        match (left, right) {
            (QuantityType::Broken, _) | (_, QuantityType::Broken) => QuantityType::Broken,
            (QuantityType::Zero, _) | (_, QuantityType::Zero) => QuantityType::Zero,
            (QuantityType::Of(a), QuantityType::Of(b)) => of(a, b).map_or_else(
                || {
                    self.fault(at, format!("the units of {} with {} come to powers beyond 24", self.words(left), self.words(right)));
                    QuantityType::Broken
                },
                QuantityType::Of,
            ),
        }
    }

    fn power(&mut self, base: &CheckedTree, exponent: &CheckedTree, exponent_at: usize) -> CheckedTree {
        let (Some(of), Some(by)) = (base.kind.dimension(), exponent.kind.dimension()) else { return CheckedTree::broken() };
        if !by.is_none() {
            return self.fault(exponent_at, format!("an exponent is a plain number, not {}", self.words(exponent.kind)));
        }
        let known = exponent.typed.constant();
        let kind = match known {
            _ if of.is_none() => QuantityType::Of(of),
            None => {
                return self.fault(exponent_at, format!("a power of {} needs a constant exponent", self.words(base.kind)));
            }
            Some(power) => match of.power(power) {
                Some(dimension) => QuantityType::Of(dimension),
                None => {
                    let message = format!(
                        "{} to the power of {power} is no quantity: powers of units are multiples of 1/12, up to 24",
                        self.words(base.kind)
                    );
                    return self.fault(exponent_at, message);
                }
            },
        };
        let small = known.filter(|power| power.fract() == 0.0 && power.abs() <= 8.0);
        if let Some(power) = small {
            #[allow(clippy::cast_possible_truncation, reason = "a whole number from -8 to 8")]
            let whole_power = power as i8;
            let need = (power < 0.0).then(|| self.need(reason::ZERO, true));
            let whole = base.whole && power >= 0.0;
            return CheckedTree::new(Typed::WholePower(Box::new(base.typed.clone()), whole_power, need), kind, whole, &[base, exponent]);
        }
        let of_zero = known.is_some_and(|power| power > 0.0);
        let need = if of_zero { self.need(reason::NEGATIVE_BASE, false) } else { self.need(reason::BASE, true) };
        // The logarithm of an f64 is at most 709.8 and at least -745: a small power cannot come to much.
        let size = known.is_none_or(|power| power.abs() > 0.9).then(|| self.need(reason::SIZE, false));
        let parts = Box::new([base.typed.clone(), exponent.typed.clone()]);
        CheckedTree::new(Typed::Power { parts, of_zero, base: need, size }, kind, false, &[base, exponent])
    }

    fn choice(&mut self, comparison: ComparisonSign, parts: &'e [Expression; 4], at: usize) -> CheckedTree {
        let [left, right, then, otherwise] = parts;
        let compared = match (&left.node, &right.node) {
            (ExpressionNode::Word(_), ExpressionNode::Word(_)) => {
                self.fault(left.span.start, "two words are compared; one side must be the name of an input");
                None
            }
            (ExpressionNode::Word(word), _) => self.word(comparison, right, word, left.span.start),
            (_, ExpressionNode::Word(word)) => self.word(comparison, left, word, right.span.start),
            _ => self.numbers(comparison, left, right),
        };
        let then = self.check(then);
        // What is none of the words of an input is a number.
        let excluded = self.excluded_by([left, right]);
        self.excluded.extend(excluded);
        let otherwise = self.check(otherwise);
        self.excluded.truncate(self.excluded.len() - usize::from(excluded.is_some()));
        let kind =
            self.unified(&then, &otherwise, at, |a, b| format!("both values of if(...) must measure the same; these are {a} and {b}"));
        let Some((test, left, right)) = compared else { return CheckedTree::broken() };
        let whole = then.whole && otherwise.whole;
        let typed = Typed::If(test, Box::new([&left, &right, &then, &otherwise].map(|part| part.typed.clone())));
        CheckedTree::new(typed, kind, whole, &[&left, &right, &then, &otherwise])
    }

    /// The slot and the word that are not equal where the comparison does not hold.
    fn excluded_by(&self, sides: [&'e Expression; 2]) -> Option<(usize, &'e str)> {
        let (word, name) = match sides.map(|side| &side.node) {
            [ExpressionNode::Word(word), ExpressionNode::Name(name)] | [ExpressionNode::Name(name), ExpressionNode::Word(word)] => {
                (word, name)
            }
            _ => return None,
        };
        Some((self.slots.iter().position(|slot| slot.name == *name)?, word))
    }

    fn numbers(
        &mut self,
        comparison: ComparisonSign,
        left_part: &'e Expression,
        right_part: &'e Expression,
    ) -> Option<(IfTest, CheckedTree, CheckedTree)> {
        let (left, right) = (self.check(left_part), self.check(right_part));
        let at = left_part.span.start;
        let kind = self.unified(&left, &right, at, |a, b| format!("{a} and {b} cannot be compared"));
        let test = match comparison {
            ComparisonSign::Less => IfTest::Less,
            ComparisonSign::AtMost => IfTest::AtMost,
            ComparisonSign::Greater => IfTest::Greater,
            ComparisonSign::AtLeast => IfTest::AtLeast,
            ComparisonSign::Equal => {
                if kind != QuantityType::Broken && !(left.whole && right.whole) {
                    self.fault(at, "\"==\" compares whole numbers and words only; write \"<=\" or \">=\", or round(...) both sides");
                    return None;
                }
                IfTest::EqualWhole
            }
        };
        (kind != QuantityType::Broken).then_some((test, left, right))
    }

    /// A name compared with a word.
    fn word(
        &mut self,
        comparison: ComparisonSign,
        other: &'e Expression,
        word: &str,
        at: usize,
    ) -> Option<(IfTest, CheckedTree, CheckedTree)> {
        if comparison != ComparisonSign::Equal {
            self.fault(at, format!("a word is compared with \"==\" only, not with \"{}\"", comparison.symbol()));
            return None;
        }
        let ExpressionNode::Name(name) = &other.node else {
            self.fault(other.span.start, format!("'{word}' can be compared with the name of an input only"));
            return None;
        };
        let slots = self.slots;
        let Some(slot) = slots.iter().position(|slot| slot.name == *name) else {
            let message = self.unknown_name(name);
            self.fault(other.span.start, message);
            return None;
        };
        let known = &slots[slot];
        let Some(&(_, code)) = known.words.iter().find(|(known, _)| known == word) else {
            let words: Vec<&str> = known.words.iter().map(|(word, _)| word.as_str()).collect();
            let message = if words.is_empty() {
                format!("{name} takes numbers only, no words")
            } else {
                format!("{name} is never '{word}'; {}", remedy(word, &words, || format!("its words are {}", words.join(", "))))
            };
            self.fault(at, message);
            return None;
        };
        let codes_are_whole = known.only_words && known.words.iter().all(|(_, code)| code.fract() == 0.0);
        let test = if codes_are_whole { IfTest::EqualWhole } else { IfTest::EqualWord };
        let value = self.slot(slot, other.span.start);
        let code = CheckedTree::new(Typed::Constant(code), value.kind, true, &[]);
        Some((test, value, code))
    }

    fn root(&mut self, unknown: &'e str, parts: &'e [Expression; 3], start: Option<&'e Expression>, at: usize) -> CheckedTree {
        let [from_part, to_part, body] = parts;
        if self.unknown.is_some() {
            return self.fault(at, "a root cannot lie within another root's expression; give it a formula of its own");
        }
        if self.slots.iter().any(|slot| slot.name == unknown)
            || self.scope.curves.iter().any(|curve| curve.name == unknown)
            || is_reserved(unknown)
        {
            return self.fault(at, format!("{unknown} is known already; choose another name for the unknown of the root"));
        }
        let (from, to) = (self.check(from_part), self.check(to_part));
        let ends = self
            .unified(&from, &to, from_part.span.start, |a, b| format!("both ends of a root must measure the same; these are {a} and {b}"));
        let start = start.map(|part| {
            let start = self.check(part);
            self.unified(&from, &start, part.span.start, |a, b| format!("a root starts between its ends; these are {a} and {b}"));
            start
        });
        // Two bare zeros are no bracket, and say nothing of the unknown.
        let kind = if ends == QuantityType::Zero { QuantityType::Of(QuantityDimension::NONE) } else { ends };
        self.unknown = Some(Unknown { name: unknown, kind, parameters: Vec::new() });
        let function = self.check(body);
        let parameters = self.unknown.take().map_or_else(Vec::new, |unknown| unknown.parameters);
        let is_broken = |part: &CheckedTree| part.kind == QuantityType::Broken;
        if ends == QuantityType::Broken || is_broken(&function) || start.as_ref().is_some_and(is_broken) {
            return CheckedTree::broken();
        }
        if !function.varies {
            return self.fault(body.span.start, format!("the expression of this root does not depend on {unknown}"));
        }
        self.roots += 1;
        let need = self.need(reason::NO_ROOT, false);
        let parts = Box::new([&from, &to, &function].map(|part| part.typed.clone()));
        let typed =
            Typed::Root(parts, start.as_ref().map(|part| Box::new(part.typed.clone())), parameters, need, function.typed.smoothness());
        let of: Vec<&CheckedTree> = [&from, &to, &function].into_iter().chain(&start).collect();
        // The unknown stays within.
        CheckedTree { varies: false, ..CheckedTree::new(typed, kind, false, &of) }
    }
}
