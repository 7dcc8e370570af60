//! Bounds of a number over a box of designs and a box of scenarios.
//!
//! The recorded formula runs over intervals, and over intervals with derivatives. Where a derivative has one sign all over the box, the
//! number is largest at one end of that axis and least at the other, and the bounds of the corner are as good as a single design's.
//! Elsewhere the middle and the largest derivative do. Both bound the exact value; what f64 may differ from it by is added.

use super::axes::{AXES, Axes, BoxAxis, Span, Spans};
use super::requirement::NumberSource;
use super::study_tape::StudyTape;
use crate::real::Real;
use crate::tape::{Dual, EVERYTHING, Interval};
use crate::tape::{Node, Operation};
use rustc_hash::FxHashMap;

/// Most directions that derivatives are followed in: the first axes of a study.
pub const DIRECTIONS: usize = 8;

/// More than rounding can make of a sum of a few products.
const OUTWARD: f64 = 1.0 + 64.0 * f64::EPSILON;

/// Most spans of one axis whose numbers are kept.
const KEPT: usize = 1 << 14;

/// A number type that a box can be evaluated with.
trait Boxed: Real<Shared = Self> {
    /// An input that covers an interval, changed along an axis.
    fn input(values: Interval, direction: Option<usize>) -> Self;
}

impl Boxed for Interval {
    fn input(values: Interval, _direction: Option<usize>) -> Self {
        values
    }
}

impl<const N: usize> Boxed for Dual<Interval, N> {
    fn input(values: Interval, direction: Option<usize>) -> Self {
        match direction {
            Some(direction) if direction < N => Self::variable(values, direction),
            _ => Self::fixed(values),
        }
    }
}

/// Runs the tape with derivatives, in as many directions as it takes: each costs time, whether it is needed or not.
trait Sloped: std::fmt::Debug + Send {
    /// A number over a box, and its derivatives along the first axes.
    fn slopes(&mut self, asked: &AskedNumber, node: Node, spans: &Spans) -> (Interval, [Interval; DIRECTIONS]);
}

impl<const N: usize> Sloped for Runner<'_, Dual<Interval, N>> {
    fn slopes(&mut self, asked: &AskedNumber, node: Node, spans: &Spans) -> (Interval, [Interval; DIRECTIONS]) {
        self.run(asked, spans);
        let it = &self.slots[node as usize];
        let mut slopes = [Interval::point(0.0); DIRECTIONS];
        slopes[..N].copy_from_slice(&it.slopes);
        (it.value, slopes)
    }
}

/// Runs the tape over boxes with one number type. What depends on one axis alone is kept by span.
#[derive(Debug)]
struct Runner<'t, R> {
    tape: &'t StudyTape,
    axes: &'t Axes,
    alone: Vec<Vec<Node>>,
    /// Of these: what others read or the study asks for, and its values by span.
    read: Vec<Vec<Node>>,
    kept: Vec<FxHashMap<Span, Box<[R]>>>,
    now: [Option<Span>; AXES],
    slots: Vec<R>,
    /// When every axis turned to its span, and when every operation was computed, in turns and runs.
    clock: u64,
    turned: [u64; AXES],
    computed: Vec<u64>,
}

impl<'t, R: Boxed> Runner<'t, R> {
    fn new(tape: &'t StudyTape, axes: &'t Axes) -> Self {
        let mut slots = vec![R::constant(0.0); tape.list.operations.len()];
        for node in (0..tape.list.operations.len()).filter(|&node| !tape.list.inner[node] && tape.axes[node] == 0) {
            tape.list.compute(node as Node, &mut slots);
        }
        Self {
            tape,
            axes,
            alone: tape.alone(axes.all.len()),
            read: tape.kept(axes.all.len()),
            kept: (0..axes.all.len()).map(|_| FxHashMap::default()).collect(),
            now: [None; AXES],
            clock: 1,
            turned: [0; AXES],
            computed: vec![0; slots.len()],
            slots,
        }
    }

    /// Computes what `asked` needs over a box.
    fn run(&mut self, asked: &AskedNumber, spans: &Spans) {
        self.clock += 1;
        for &axis in &asked.axes {
            self.turn(axis, spans[axis]);
        }
        // What another box, or another number of this one, needed over the same spans is there already.
        for &node in &asked.several {
            let mut set = self.tape.axes[node as usize];
            let mut last = 0;
            while set != 0 {
                last = last.max(self.turned[set.trailing_zeros() as usize]);
                set &= set - 1;
            }
            if self.computed[node as usize] < last {
                self.tape.list.compute(node, &mut self.slots);
                self.computed[node as usize] = self.clock;
            }
        }
    }

    fn turn(&mut self, axis: usize, span: Span) {
        if self.now[axis] == Some(span) {
            return;
        }
        self.now[axis] = Some(span);
        self.turned[axis] = self.clock;
        if let Some(values) = self.kept[axis].get(&span) {
            for (&node, &value) in self.read[axis].iter().zip(values) {
                self.slots[node as usize] = value;
            }
            return;
        }
        let table: &BoxAxis = &self.axes.all[axis];
        for &node in &self.alone[axis] {
            if let Operation::Input(input) = self.tape.list.operations[node as usize] {
                let column = self.tape.input_axes[input as usize].map_or(0, |(_, column)| column as usize);
                let (low, high) = BoxAxis::ends(&table.si[column], table.ordered, span);
                let direction = (!table.is_joint() && low < high).then_some(axis);
                self.slots[node as usize] = R::input(Interval::new(low, high), direction);
            } else {
                self.tape.list.compute(node, &mut self.slots);
            }
        }
        if self.kept[axis].len() >= KEPT {
            self.kept[axis].clear();
        }
        let values = self.read[axis].iter().map(|&node| self.slots[node as usize]).collect();
        self.kept[axis].insert(span, values);
    }
}

/// A number that bounds are asked of.
#[derive(Clone, Debug)]
pub struct AskedNumber {
    /// Where it comes from.
    pub source: NumberSource,
    /// Is a larger value worse?
    pub higher_is_worse: bool,
    /// Axes that it depends on.
    axes: Vec<usize>,
    axis_set: u64,
    /// Operations that depend on several axes, in their order.
    several: Vec<Node>,
}

impl AskedNumber {
    /// A number of a tape.
    pub fn new(tape: &StudyTape, source: NumberSource, higher_is_worse: bool) -> Self {
        let needed = if let NumberSource::Node(node, _) = source { tape.list.needed_by(&[node]) } else { Vec::new() };
        // What is needed may depend on an axis that the result does not: a selection with equal branches.
        let axis_set = needed.iter().fold(source.axes(tape), |set, &node| set | tape.axes[node as usize]);
        Self {
            source,
            higher_is_worse,
            axes: (0..AXES).filter(|axis| axis_set >> axis & 1 == 1).collect(),
            axis_set,
            several: needed.into_iter().filter(|&node| tape.axes[node as usize].count_ones() > 1).collect(),
        }
    }

    /// The axes that it depends on, as a bit set.
    pub fn axis_set(&self) -> u64 {
        self.axis_set
    }

    /// How bad a value is: the larger the worse.
    #[inline(always)]
    fn badness(&self, (low, high): (f64, f64)) -> (f64, f64) {
        if self.higher_is_worse { (low, high) } else { (-high, -low) }
    }
}

/// What is known of a number over a box of designs and one of scenarios, as badness in its unit: the larger the worse.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// No design of the box is worse in any of the scenarios.
    pub most: f64,
    /// Every design of the box is at least as bad as this in one of the scenarios.
    pub least: f64,
    /// Is every value surely a finite number?
    pub finite: bool,
    /// How much each axis moves the number over the box, as far as it does so in both directions or which is not known; in SI units.
    pub spread: [f64; AXES],
    /// Axes along which the number surely rises or falls all over the box, as a bit set.
    pub monotone: u64,
    /// Of these: the axes whose last level is the better end.
    pub better_at_last: u64,
    /// Of these: the axes along which every level is better than the one before it (or after it) in f64 too, rounding and unit included.
    pub strict: u64,
}

impl Bounds {
    /// Is the last level of an axis the better end of the box? `None` if that is not sure, or the axis moves nothing.
    pub fn better_up(&self, axis: usize) -> Option<bool> {
        (self.monotone >> axis & 1 == 1 && self.spread[axis] > 0.0).then(|| self.better_at_last >> axis & 1 == 1)
    }
}

/// Bounds numbers over boxes; one per thread.
#[derive(Debug)]
pub struct Bounder<'t> {
    axes: &'t Axes,
    values: Runner<'t, Interval>,
    slopes: Box<dyn Sloped + 't>,
    /// Bounds that were found last: requirements and objectives are often about the same number.
    recent: Vec<Bounding>,
    oldest: usize,
}

/// Which end of a number is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// [`Bounds::most`].
    Most,
    /// [`Bounds::least`].
    Least,
    /// Both.
    Both,
}

/// Bounds that were found, and the corners that were not looked at yet, with what is to be added there.
#[derive(Debug)]
struct Bounding {
    /// With its unit: two numbers of one operation may have different ones.
    source: NumberSource,
    higher_is_worse: bool,
    spans: Spans,
    bounds: Bounds,
    worst: Option<(Spans, f64)>,
    best: Option<(Spans, f64)>,
}

/// How many bounds are remembered.
const RECENT: usize = 8;

impl<'t> Bounder<'t> {
    /// A bounder for a tape.
    pub fn new(tape: &'t StudyTape, axes: &'t Axes) -> Self {
        let slopes: Box<dyn Sloped + 't> = match axes.all.len() {
            0..=3 => Box::new(Runner::<Dual<Interval, 3>>::new(tape, axes)),
            4 | 5 => Box::new(Runner::<Dual<Interval, 5>>::new(tape, axes)),
            _ => Box::new(Runner::<Dual<Interval, DIRECTIONS>>::new(tape, axes)),
        };
        Self { axes, values: Runner::new(tape, axes), slopes, recent: Vec::new(), oldest: 0 }
    }

    /// The number without derivatives: least and largest value in its unit, and whether all are finite.
    pub fn range(&mut self, asked: &AskedNumber, spans: &Spans) -> (f64, f64) {
        match asked.source {
            NumberSource::Known(value) => (value, value),
            NumberSource::Axis(axis, column) => {
                let axis_table = &self.axes.all[axis];
                BoxAxis::ends(&axis_table.own[column], axis_table.ordered, spans[axis])
            }
            NumberSource::Node(node, _) => {
                self.values.run(asked, spans);
                let it = self.values.slots[node as usize];
                shown(asked.source, it.low, it.high)
            }
        }
    }

    /// Bounds of the worst over the scenarios that the box spans; what is not asked for is bounded less well.
    pub fn bounds(&mut self, asked: &AskedNumber, spans: &Spans, wanted: Wanted) -> Bounds {
        let NumberSource::Node(node, _) = asked.source else { return self.of_axis(asked, spans) };
        let at = self.place_of(asked, spans).unwrap_or_else(|| {
            let found = self.look(asked, node, spans);
            if self.recent.len() < RECENT {
                self.recent.push(found);
                return self.recent.len() - 1;
            }
            self.oldest = (self.oldest + 1) % RECENT;
            self.recent[self.oldest] = found;
            self.oldest
        });
        if matches!(wanted, Wanted::Most | Wanted::Both)
            && let Some((corner, beyond)) = self.recent[at].worst.take()
        {
            let most = self.corner(asked, node, &corner, beyond).1;
            let bounds = &mut self.recent[at].bounds;
            bounds.most = bounds.most.min(most);
        }
        if matches!(wanted, Wanted::Least | Wanted::Both)
            && let Some((corner, beyond)) = self.recent[at].best.take()
        {
            let known = self.recent[at].bounds.least;
            let mut least = known;
            if beyond < f64::INFINITY {
                least = least.max(self.corner(asked, node, &corner, beyond).0);
            }
            let scenarios = self.axes.designs..;
            if least == known && corner.0[scenarios.clone()] != spans.0[scenarios.clone()] {
                // A single scenario bounds what the worst is at least, derivatives or not.
                let mut only = *spans;
                only.0[scenarios.clone()].copy_from_slice(&corner.0[scenarios]);
                let range = self.range(asked, &only);
                least = least.max(asked.badness(range).0);
            }
            self.recent[at].bounds.least = least;
        }
        self.recent[at].bounds
    }

    /// Are the bounds of a number at hand?
    pub fn has(&self, asked: &AskedNumber, spans: &Spans) -> bool {
        self.place_of(asked, spans).is_some()
    }

    fn place_of(&self, asked: &AskedNumber, spans: &Spans) -> Option<usize> {
        self.recent.iter().position(|it| it.source == asked.source && it.higher_is_worse == asked.higher_is_worse && it.spans == *spans)
    }

    /// The bounds of an input.
    fn of_axis(&mut self, asked: &AskedNumber, spans: &Spans) -> Bounds {
        let whole = self.range(asked, spans);
        let (mut least, most) = asked.badness(whole);
        if let NumberSource::Axis(axis, _) = asked.source
            && axis >= self.axes.designs
        {
            least = most;
        }
        let mut bounds = Bounds { most, least, finite: true, spread: [0.0; AXES], monotone: 0, better_at_last: 0, strict: 0 };
        if let NumberSource::Axis(axis, column) = asked.source {
            let (table, span) = (&self.axes.all[axis], spans[axis]);
            bounds.spread[axis] = whole.1 - whole.0;
            if table.ordered {
                let values = &table.own[column];
                let rises = values[span.low as usize] <= values[span.high as usize];
                bounds.monotone = 1 << axis;
                bounds.better_at_last = u64::from(rises != asked.higher_is_worse) << axis;
                bounds.strict = u64::from(values.windows(2).all(|it| it[0] != it[1])) << axis;
            }
        }
        bounds
    }

    /// Bounds by the formula over the whole box, and the corners that may tell more.
    fn look(&mut self, asked: &AskedNumber, node: Node, spans: &Spans) -> Bounding {
        let (value, slopes) = self.slopes.slopes(asked, node, spans);
        let mut spread = [0.0; AXES];
        let (mut monotone, mut better_at_last, mut strict) = (0u64, 0u64, 0u64);
        // What rounding and the conversion to a unit may hide.
        let hidden = 4.0 * value.error + 8.0 * f64::EPSILON * value.low.abs().max(value.high.abs());
        // The corners where the number is worst, and where it is best in the scenario that is worst there. Along axes whose direction is
        // not known they are in the middle, and as much is added as the number can change from there.
        let (mut worst, mut best) = (*spans, *spans);
        let (mut beyond_worst, mut beyond_best) = (0.0, 0.0);
        for &axis in &asked.axes {
            if spans[axis].is_single() {
                continue;
            }
            let is_scenario = axis >= self.axes.designs;
            let table = &self.axes.all[axis];
            let known = axis < DIRECTIONS && !table.is_joint();
            let slope = if known { slopes[axis] } else { EVERYTHING };
            let (low, high) = BoxAxis::ends(&table.si[0], table.ordered, spans[axis]);
            let middle = spans[axis].low + (spans[axis].high - spans[axis].low) / 2;
            spread[axis] = slope.low.abs().max(slope.high.abs()) * (high - low);
            if spread[axis].is_nan() {
                spread[axis] = f64::INFINITY;
            }
            if table.ordered && (slope.low >= 0.0 || slope.high <= 0.0) {
                monotone |= 1 << axis;
                let rises = (slope.low >= 0.0) == (table.si[0][spans[axis].low as usize] <= table.si[0][spans[axis].high as usize]);
                let (up, down) =
                    if rises == asked.higher_is_worse { (spans[axis].high, spans[axis].low) } else { (spans[axis].low, spans[axis].high) };
                better_at_last |= u64::from(down == spans[axis].high) << axis;
                strict |= u64::from(slope.low.abs().min(slope.high.abs()) * table.least_step > hidden) << axis;
                worst[axis] = Span::at(up);
                best[axis] = Span::at(if is_scenario { up } else { down });
            } else {
                worst[axis] = Span::at(middle);
                best[axis] = Span::at(middle);
                let centre = table.si[0][middle as usize];
                let up = (slope.high * (high - centre)).max(slope.low * (low - centre));
                let down = (slope.low * (high - centre)).min(slope.high * (low - centre));
                let (worse, better) = if asked.higher_is_worse { (up, -down) } else { (-down, up) };
                beyond_worst += or_infinite(worse);
                beyond_best += if is_scenario { 0.0 } else { or_infinite(better) };
            }
        }
        let (least, most) = asked.badness(shown(asked.source, value.low, value.high));
        let is_known = value.error < f64::INFINITY;
        let margin = |beyond: f64| value.error + beyond * OUTWARD;
        let has_other_scenario = best.0[self.axes.designs..] != spans.0[self.axes.designs..];
        Bounding {
            source: asked.source,
            higher_is_worse: asked.higher_is_worse,
            spans: *spans,
            bounds: Bounds { most, least, finite: value.is_finite(), spread, monotone, better_at_last, strict },
            worst: (is_known && beyond_worst < f64::INFINITY).then(|| (worst, margin(beyond_worst))),
            best: (is_known && beyond_best < f64::INFINITY || has_other_scenario)
                .then(|| (best, if is_known { margin(beyond_best) } else { f64::INFINITY })),
        }
    }

    /// Badness over a part of the box, for designs of the whole box that are no better or worse but for rounding.
    fn corner(&mut self, asked: &AskedNumber, node: Node, spans: &Spans, error: f64) -> (f64, f64) {
        self.values.run(asked, spans);
        let it = self.values.slots[node as usize];
        asked.badness(shown(asked.source, (it.low - error).next_down(), (it.high + error).next_up()))
    }
}

/// What is not a number may be anything.
fn or_infinite(value: f64) -> f64 {
    if value.is_nan() { f64::INFINITY } else { value.max(0.0) }
}

/// Ends in the unit that the number is shown in: the conversion never swaps the order of two numbers, and what f64 computes is converted
/// from a number between the ends.
fn shown(source: NumberSource, low: f64, high: f64) -> (f64, f64) {
    (source.shown(low), source.shown(high))
}
