//! Evaluates checked formulas over any number type.
//!
//! What can fail leaves a margin and goes on with a harmless number. The margin counts only where the value is used: not in the branch
//! of an `if` that is not taken, and not where an operand is absent.

use super::function::Function;
use super::scope::{MeasuredCurve, Scope, slope};
use super::typed::{IfTest, MOST_PARAMETERS, Need, Typed};
use super::value::{LARGEST_EXPONENT, Value, both};
use crate::real::{Real, Smoothness};

/// The numbers that a formula reads.
pub(super) struct SlotValues<'a, R> {
    pub(super) slots: &'a [R],
    pub(super) present: &'a [Option<R>],
    pub(super) curves: &'a [MeasuredCurve],
}

/// The expression of a root, and the number that it is asked at.
struct Within<R> {
    parameters: [R; MOST_PARAMETERS],
    present: [Option<R>; MOST_PARAMETERS],
    unknown: Value<R>,
}

/// Where a margin counts: where another is at least zero, or below it.
struct Guard<'g, R> {
    margin: R,
    at_least_zero: bool,
    outer: Option<&'g Guard<'g, R>>,
}

/// Where an expression is evaluated.
struct EvaluationPlace<'a, R> {
    around: &'a SlotValues<'a, R>,
    within: Option<&'a Within<R>>,
    guard: Option<&'a Guard<'a, R>>,
}

impl<R> Clone for EvaluationPlace<'_, R> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<R> Copy for EvaluationPlace<'_, R> {}

/// The value of a formula; writes one margin for each of its needs.
pub(super) fn evaluate<R: Real>(typed: &Typed, around: &SlotValues<'_, R>, margins: &mut [R]) -> Value<R> {
    let mut found = vec![None; margins.len()];
    let value = TreeEvaluation { margins: &mut found }.of(typed, EvaluationPlace { around, within: None, guard: None });
    for (margin, found) in margins.iter_mut().zip(found) {
        *margin = found.unwrap_or(R::constant(1.0));
    }
    value
}

/// The number that an expression comes to whose parts are all constants, or why it has none; `None` if a part is not constant.
pub(super) fn constant(typed: &Typed, scope: &Scope, needs: &[Need]) -> Option<Result<f64, String>> {
    let fixed = |parts: &[Typed]| parts.iter().all(|part| part.constant().is_some());
    let is_constant = match typed {
        Typed::Constant(_) => true,
        Typed::Slot(_) | Typed::Parameter(_) | Typed::Unknown | Typed::Root(..) => false,
        Typed::Negative(of) | Typed::WholePower(of, ..) | Typed::Curve(_, of, _) => of.constant().is_some(),
        Typed::Sum(parts) | Typed::Difference(parts) | Typed::Product(parts) | Typed::Quotient(parts, _) | Typed::Power { parts, .. } => {
            fixed(&**parts)
        }
        Typed::Apply(_, parts, _) => fixed(parts),
        Typed::If(_, parts) => fixed(&**parts),
    };
    is_constant.then(|| {
        let mut margins = vec![1.0; needs.len()];
        let around = SlotValues { slots: &[], present: &[], curves: &scope.curves };
        let value = evaluate::<f64>(typed, &around, &mut margins).value;
        let broken = needs.iter().zip(&margins).find(|(need, margin)| if need.strict { **margin <= 0.0 } else { **margin < 0.0 });
        broken.map_or(Ok(value), |(need, _)| Err(need.reason.clone()))
    })
}

/// The margins found so far. What an expression may be is never inlined into what walks over it: a walk a hundred levels deep, with
/// eight lanes a number, has to fit on the stack of a thread.
struct TreeEvaluation<'m, R> {
    margins: &'m mut [Option<R>],
}

impl<R: Real> TreeEvaluation<'_, R> {
    /// Notes a margin, which counts where its operand is there and the branches around it are taken.
    fn need(&mut self, need: Option<usize>, margin: R, operand: Option<R>, place: EvaluationPlace<'_, R>) {
        let Some(kept) = need.and_then(|need| self.margins.get_mut(need)) else { return };
        let one = R::constant(1.0);
        let mut margin = operand.map_or(margin, |present| R::select(present, margin, one));
        let mut guard = place.guard;
        while let Some(around) = guard {
            margin = if around.at_least_zero { R::select(around.margin, margin, one) } else { R::select(around.margin, one, margin) };
            guard = around.outer;
        }
        *kept = both(*kept, Some(margin));
    }

    fn pair(&mut self, parts: &[Typed; 2], place: EvaluationPlace<'_, R>) -> (Value<R>, Value<R>) {
        (self.of(&parts[0], place), self.of(&parts[1], place))
    }

    fn of(&mut self, typed: &Typed, place: EvaluationPlace<'_, R>) -> Value<R> {
        match typed {
            Typed::Constant(value) => Value::constant(*value),
            Typed::Slot(slot) => Value { present: place.around.present[*slot], ..Value::fixed(place.around.slots[*slot]) },
            Typed::Parameter(number) => place.within.map_or(Value::constant(1.0), |within| Value {
                present: within.present[*number],
                ..Value::fixed(within.parameters[*number])
            }),
            Typed::Unknown => place.within.map_or(Value::constant(1.0), |within| within.unknown),
            Typed::Negative(of) => self.of(of, place).negative(),
            Typed::Sum(parts) => {
                let (a, b) = self.pair(parts, place);
                a.plus(b)
            }
            Typed::Difference(parts) => {
                let (a, b) = self.pair(parts, place);
                a.minus(b)
            }
            Typed::Product(parts) => {
                let (a, b) = self.pair(parts, place);
                a.times(b)
            }
            Typed::Quotient(parts, need) => {
                let (a, b) = self.pair(parts, place);
                if need.is_none() {
                    return a.over(b);
                }
                self.need(*need, b.value.abs(), b.present, place);
                a.over(b.not_zero())
            }
            Typed::WholePower(of, power, need) => {
                let base = self.of(of, place);
                if *power == 0 {
                    return Value { present: base.present, ..Value::constant(1.0) };
                }
                if *power > 0 {
                    return base.whole_power(*power);
                }
                self.need(*need, base.value.abs(), base.present, place);
                Value::constant(1.0).over(base.not_zero().whole_power(-power))
            }
            Typed::Power { parts, of_zero, base, size } => {
                let (of, by) = self.pair(parts, place);
                let present = both(of.present, by.present);
                self.need(Some(*base), of.value, of.present, place);
                let exponent = by.times(of.positive().ln());
                self.need(*size, R::constant(LARGEST_EXPONENT) - exponent.value, present, place);
                let power = exponent.exp();
                let of_nothing = Value { present, ..Value::constant(0.0) };
                if *of_zero { Value::select(Value::fixed(-of.value), of_nothing, power) } else { power }
            }
            Typed::Apply(function, parts, need) => self.apply(*function, parts, *need, place),
            Typed::If(test, parts) => self.choice(*test, parts, place),
            Typed::Curve(number, of, need) => {
                let at = self.of(of, place);
                self.curve(&place.around.curves[*number], at, *need, place)
            }
            Typed::Root(parts, first, slots, need, smoothness) => self.root(parts, (first.as_deref(), *smoothness), slots, *need, place),
        }
    }

    #[inline(never)]
    fn apply(&mut self, function: Function, parts: &[Typed], need: Option<usize>, place: EvaluationPlace<'_, R>) -> Value<R> {
        let one = R::constant(1.0);
        let x = self.of(&parts[0], place);
        let second = match parts.get(1) {
            Some(_) if function == Function::Default => self.otherwise(&parts[1], x.present, place),
            Some(part) => self.of(part, place),
            None => x,
        };
        let margin = match function {
            Function::Sqrt | Function::Ln | Function::Log10 => x.value,
            Function::Ln1p => x.value + one,
            Function::Asin | Function::Acos => one - x.value.abs(),
            _ => R::constant(LARGEST_EXPONENT) - x.value,
        };
        self.need(need, margin, x.present, place);
        match function {
            Function::Min => parts[2..].iter().fold(x.min(second), |least, part| least.min(self.of(part, place))),
            Function::Max => parts[2..].iter().fold(x.max(second), |largest, part| largest.max(self.of(part, place))),
            Function::Abs => x.abs(),
            Function::Sqrt => x.sqrt(),
            Function::Exp => x.exp(),
            Function::Ln => x.positive().ln(),
            Function::Log10 => x.positive().log10(),
            Function::ExpM1 => x.exp_m1(),
            Function::Ln1p => x.ln_1p(),
            Function::Tanh => x.tanh(),
            Function::Sin => x.sin(),
            Function::Cos => x.cos(),
            Function::Tan => x.tan(),
            Function::Asin => x.asin(),
            Function::Acos => x.acos(),
            Function::Atan => x.atan(),
            Function::Atan2 => x.atan2(second),
            Function::Hypot => x.hypot(second),
            Function::Clamp => x.max(second).min(self.of(&parts[2], place)),
            Function::Round => x.round(),
            Function::Floor => x.floor(),
            Function::Ceil => x.ceil(),
            Function::Default => match x.present {
                Some(present) => Value::select(Value::fixed(present), Value { present: None, ..x }, second),
                None => x,
            },
        }
    }

    /// What stands in for an absent value: its margins count only where that is absent.
    #[inline(never)]
    fn otherwise(&mut self, part: &Typed, present: Option<R>, place: EvaluationPlace<'_, R>) -> Value<R> {
        let Some(margin) = present else { return Value::constant(1.0) };
        let guard = Guard { margin, at_least_zero: false, outer: place.guard };
        self.of(part, EvaluationPlace { guard: Some(&guard), ..place })
    }

    #[inline(never)]
    fn choice(&mut self, test: IfTest, parts: &[Typed; 4], place: EvaluationPlace<'_, R>) -> Value<R> {
        let (a, b) = (self.of(&parts[0], place), self.of(&parts[1], place));
        let apart = |a: Value<R>, b: Value<R>| a.minus(b).abs();
        let (margin, then_at_least_zero) = match test {
            IfTest::AtLeast => (a.minus(b), true),
            IfTest::AtMost => (b.minus(a), true),
            IfTest::Greater => (b.minus(a), false),
            IfTest::Less => (a.minus(b), false),
            IfTest::EqualWhole => (Value::constant(0.5).minus(apart(a, b)), true),
            IfTest::EqualWord => (apart(a, b).negative(), true),
        };
        // Where what is compared is absent, neither branch is taken.
        let compared = margin.present.map(|margin| Guard { margin, at_least_zero: true, outer: place.guard });
        let mut branch = |part: &Typed, at_least_zero: bool| {
            let guard = Guard { margin: margin.value, at_least_zero, outer: compared.as_ref().or(place.guard) };
            self.of(part, EvaluationPlace { guard: Some(&guard), ..place })
        };
        let (then, otherwise) = (branch(&parts[2], then_at_least_zero), branch(&parts[3], !then_at_least_zero));
        if then_at_least_zero { Value::select(margin, then, otherwise) } else { Value::select(margin, otherwise, then) }
    }

    #[inline(never)]
    fn curve(&mut self, curve: &MeasuredCurve, at: Value<R>, need: usize, place: EvaluationPlace<'_, R>) -> Value<R> {
        let points = curve.points();
        let (first, last) = (points[0], points[points.len() - 1]);
        self.need(Some(need), (at.value - R::constant(first.0)).min(R::constant(last.0) - at.value), at.present, place);
        let mut value = R::constant(first.1);
        let mut steepness = R::constant(0.0);
        for pair in points.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let steep = R::constant(slope(from, to));
            let [x, y, end] = [from.0, from.1, to.0].map(R::constant);
            let ahead = at.value - x;
            // Within the segment, so that a range of numbers gives no more than the segment has.
            let inside = at.value.max(x).min(end) - x;
            value = R::select(ahead, y + inside * steep, value);
            steepness = R::select(ahead, steep, steepness);
        }
        value = R::select(at.value - R::constant(last.0), R::constant(last.1), value);
        at.chain(value, |own| own * steepness)
    }

    #[inline(never)]
    fn root(
        &mut self,
        parts: &[Typed; 3],
        (first, smoothness): (Option<&Typed>, Smoothness),
        slots: &[usize],
        need: usize,
        place: EvaluationPlace<'_, R>,
    ) -> Value<R> {
        let zero = R::constant(0.0);
        let (from, to) = (self.of(&parts[0], place), self.of(&parts[1], place));
        let mut parameters = [zero; MOST_PARAMETERS];
        let mut present = [None; MOST_PARAMETERS];
        for (number, &slot) in slots.iter().enumerate() {
            parameters[number] = place.around.slots[slot];
            present[number] = place.around.present[slot];
        }
        let around = place.around;
        // Nothing that fails on the way to the root counts.
        let function = |parameters: [R; MOST_PARAMETERS], unknown: Value<R>| {
            let within = Within { parameters, present: [None; MOST_PARAMETERS], unknown };
            TreeEvaluation { margins: &mut [] }.of(&parts[2], EvaluationPlace { around, within: Some(&within), guard: None })
        };
        // Ends in the wrong order fail below; here they must be a bracket all the same.
        let end = from.value.max(to.value);
        let first = first.map(|first| self.of(first, place));
        let start = first.map_or_else(|| (from.value + end) * R::constant(0.5), |first| first.value);
        let root = R::monotone_root((from.value, end), start, smoothness, parameters, |parameters, x| {
            let result = function(parameters, Value { slope: Some(R::constant(1.0)), ..Value::fixed(x) });
            (result.value, result.slope.unwrap_or(zero))
        });
        // What fails at the root itself does.
        let within = Within { parameters, present, unknown: Value::fixed(root) };
        let at_root = self.of(&parts[2], EvaluationPlace { within: Some(&within), ..place });
        let all = both(both(from.present, to.present), both(at_root.present, first.and_then(|first| first.present)));
        let [below, above] = [from, to].map(|end| function(parameters, Value::fixed(end.value)).value);
        self.need(Some(need), (-below).min(above).min(to.value - from.value), all, place);
        Value { present: all, ..Value::fixed(root) }
    }
}

/// Value and slope of the expression of a root that reads no name, at some place.
#[cfg(test)]
pub(super) fn at(root: &Typed, curves: &[MeasuredCurve], x: f64) -> (f64, f64) {
    let Typed::Root(parts, ..) = root else { panic!("{root:?} is no root") };
    let around = SlotValues { slots: &[], present: &[], curves };
    let unknown = Value { slope: Some(1.0), ..Value::fixed(x) };
    let within = Within { parameters: [0.0; MOST_PARAMETERS], present: [None; MOST_PARAMETERS], unknown };
    let value = TreeEvaluation { margins: &mut [] }.of(&parts[2], EvaluationPlace { around: &around, within: Some(&within), guard: None });
    (value.value, value.slope.unwrap_or(0.0))
}
