//! Roots over a chunk of designs: Newton's steps of all lanes side by side, each lane's the very steps that it takes alone.

use super::columns::{ColumnValue, NodeColumns};
use super::{List, ListRoot, Node, Operation};
use multiversion::multiversion;

/// Steps of a root at most, and what counts as rounding: those of `bracketed_newton`.
const MOST_STEPS: usize = 100;

/// Room for the roots of a list.
#[derive(Debug)]
pub struct RootColumns {
    /// The functions' operations, over the lanes that are looked at.
    numbers: NodeColumns,
    lanes: RootLanes,
    /// Of every root: what its function reads that does not depend on where it is asked, each once.
    outside: Vec<Vec<Node>>,
    /// Of the root that is looked for: what of that differs between lanes, and of every operation whether it has a number for each.
    differs: Vec<Node>,
    each: Vec<bool>,
}

/// Of every lane that is looked at: its place in the chunk, and where its search is.
#[derive(Debug, Default)]
struct RootLanes {
    place: Vec<u32>,
    /// Where the function is asked next.
    x: Vec<f64>,
    now: Brackets,
    /// Room for what a step leaves.
    next: Brackets,
    /// Room for the value and slope of a function that has one number for all lanes.
    value: Vec<f64>,
    slope: Vec<f64>,
}

/// What is known of the roots.
#[derive(Debug, Default)]
struct Brackets {
    low: Vec<f64>,
    high: Vec<f64>,
    /// How far the step before went; below zero where the search has ended, which stays where it is.
    last_step: Vec<f64>,
}

impl Brackets {
    fn resize(&mut self, count: usize) {
        [&mut self.low, &mut self.high, &mut self.last_step].into_iter().for_each(|numbers| numbers.resize(count, 0.0));
    }
}

impl RootLanes {
    fn begin(&mut self, count: usize, low: ColumnValue<'_>, high: ColumnValue<'_>, start: ColumnValue<'_>) {
        self.place.clear();
        self.place.extend(0..count as u32);
        let Self { x, now: Brackets { low: lows, high: highs, last_step }, .. } = self;
        refill(lows, low, count);
        refill(highs, high, count);
        refill(x, start, count);
        x.iter_mut().zip(&*lows).zip(&*highs).for_each(|((x, &low), &high)| *x = f64::min(f64::max(*x, low), high));
        last_step.clear();
        last_step.resize(count, f64::INFINITY);
    }

    /// Takes a step in each lane from where its function was asked; the number of lanes that go on.
    fn step(&mut self, asked: &[f64], value: ColumnValue<'_>, slope: ColumnValue<'_>) -> usize {
        let count = asked.len();
        self.x.resize(count, 0.0);
        self.next.resize(count);
        let value = of_all(value, &mut self.value, count);
        let slope = of_all(slope, &mut self.slope, count);
        let Brackets { low, high, last_step } = &self.now;
        let next = &mut self.next;
        let left = steps(asked, value, slope, low, high, last_step, &mut self.x, &mut next.low, &mut next.high, &mut next.last_step);
        std::mem::swap(&mut self.now, &mut self.next);
        usize::try_from(left).unwrap_or(count)
    }

    /// Writes where all lanes are, and keeps those that go on.
    fn keep_open(&mut self, column: &mut [f64], left: usize) {
        // As long as none was sorted out each stands at its place.
        if left == 0 && self.x.len() == column.len() {
            return column.copy_from_slice(&self.x);
        }
        let Self { place, x, now: Brackets { low, high, last_step }, .. } = self;
        let mut kept = 0;
        for lane in 0..x.len() {
            column[place[lane] as usize] = x[lane];
            // Without a branch: whether a lane goes on cannot be foreseen. What does not is overwritten by the next.
            place[kept] = place[lane];
            for numbers in [&mut *low, high, x, last_step] {
                numbers[kept] = numbers[lane];
            }
            kept += usize::from(!has_ended(last_step[kept]));
        }
        place.truncate(kept);
        [low, high, x, last_step].into_iter().for_each(|numbers| numbers.truncate(kept));
    }
}

/// A column with a number for each lane.
fn of_all<'a>(values: ColumnValue<'a>, room: &'a mut Vec<f64>, count: usize) -> &'a [f64] {
    if let ColumnValue::Each(values) = values {
        return values;
    }
    refill(room, values, count);
    room
}

/// Fills a column anew with a number for each lane.
fn refill(column: &mut Vec<f64>, values: ColumnValue<'_>, count: usize) {
    column.clear();
    match values {
        ColumnValue::Each(values) => column.extend_from_slice(&values[..count]),
        ColumnValue::One(value) => column.resize(count, value),
    }
}

/// Told by the last step: one that is no number, as between two infinities, ends nothing.
#[inline(always)]
fn has_ended(last_step: f64) -> bool {
    last_step < 0.0
}

/// The step of `bracketed_newton` in each lane that has not ended; how many go on.
///
/// What is left is written elsewhere than what was there, and no condition waits for another one (`|` for `||`): else the compiler stores
/// under masks, which takes many times as long.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
#[allow(clippy::too_many_arguments, reason = "the compiler must know that none overlaps another")]
fn steps(
    asked: &[f64],
    value: &[f64],
    slope: &[f64],
    low: &[f64],
    high: &[f64],
    last_step: &[f64],
    x: &mut [f64],
    next_low: &mut [f64],
    next_high: &mut [f64],
    next_last: &mut [f64],
) -> u64 {
    let count = asked.len();
    let (value, slope, x) = (&value[..count], &slope[..count], &mut x[..count]);
    let (low, high, last_step) = (&low[..count], &high[..count], &last_step[..count]);
    let (next_low, next_high, next_last) = (&mut next_low[..count], &mut next_high[..count], &mut next_last[..count]);
    let mut left = 0;
    for lane in 0..count {
        let at = asked[lane];
        let above = value[lane] > 0.0;
        let high = if above { at } else { high[lane] };
        let low = if above { low[lane] } else { at };
        let newton = at - value[lane] / slope[lane];
        let halved = 0.5 * (low + high);
        let then = if (newton >= low) & (newton <= high) { newton } else { halved };
        let step = (then - at).abs();
        let at_rounding = step <= 1e4 * f64::EPSILON * at.abs();
        let had_ended = has_ended(last_step[lane]);
        let ends = had_ended | (step == 0.0) | (at_rounding & (step >= 0.5 * last_step[lane]));
        x[lane] = if had_ended { at } else { then };
        next_low[lane] = low;
        next_high[lane] = high;
        next_last[lane] = if ends { -1.0 } else { step };
        left += u64::from(!ends);
    }
    left
}

impl List {
    /// Are all its roots found over columns?
    pub(crate) fn has_roots_in_columns(&self) -> bool {
        self.operations.iter().all(|it| !matches!(it, Operation::Root(number) if !serves(self, *number)))
    }
}

/// Can a root be found over columns? Its function must be plain operations.
pub fn serves(list: &List, number: u8) -> bool {
    let plain = |node: &Node| {
        matches!(
            list.operations[*node as usize],
            Operation::Unary(..) | Operation::Binary(..) | Operation::Select(..) | Operation::Constant(_)
        )
    };
    list.roots[number as usize].inner.iter().all(plain)
}

impl RootColumns {
    /// Room for a list.
    pub fn new(list: &List) -> Self {
        // A cut list keeps roots that nothing asks for; the operations that they name are not in it.
        let mut outside = vec![Vec::new(); list.roots.len()];
        for operation in &list.operations {
            let Operation::Root(number) = *operation else { continue };
            let nodes = &mut outside[number as usize];
            list.outside(number, |node| nodes.push(node));
            nodes.sort_unstable();
            nodes.dedup();
        }
        Self { numbers: NodeColumns::plain(list), lanes: RootLanes::default(), outside, differs: Vec::new(), each: Vec::new() }
    }

    /// The roots of a chunk; `of` gives what the function reads from outside.
    pub fn find<'c>(&mut self, list: &List, number: u8, of: &dyn Fn(Node) -> ColumnValue<'c>, column: &mut [f64]) {
        let Self { numbers, lanes, outside, differs, each } = self;
        let ListRoot { root, inner } = &list.roots[number as usize];
        let (low, high, start) = (of(root.bracket.0), of(root.bracket.1), of(root.start));
        lanes.begin(column.len(), low, high, start);
        differs.clear();
        for &node in &outside[number as usize] {
            match of(node) {
                ColumnValue::Each(_) => differs.push(node),
                ColumnValue::One(value) => numbers.slots[node as usize] = value,
            }
        }
        // What has a number of its own in each lane: what the function reads of that kind, and all that it computes.
        each.clear();
        each.resize(list.operations.len(), false);
        differs.iter().chain(inner).chain([&root.argument]).for_each(|&node| each[node as usize] = true);
        let each = |node: Node| each[node as usize];
        let mut gathered = 0;
        for _ in 0..MOST_STEPS {
            let looked_at = lanes.x.len();
            numbers.begin(looked_at);
            if gathered != looked_at {
                gathered = looked_at;
                for &node in &*differs {
                    let ColumnValue::Each(values) = of(node) else { continue };
                    numbers.fill(node, |to| {
                        if to.len() == values.len() {
                            to.copy_from_slice(values);
                        } else {
                            to.iter_mut().zip(&lanes.place).for_each(|(to, &place)| *to = values[place as usize]);
                        }
                    });
                }
            }
            numbers.swap(root.argument, &mut lanes.x);
            for &node in inner {
                numbers.compute(list, node, each);
            }
            let ColumnValue::Each(asked) = numbers.value(root.argument, each) else { unreachable!("it differs between lanes") };
            let left = lanes.step(asked, numbers.value(root.value, each), numbers.value(root.slope, each));
            // Lanes that have ended cost less than to sort them out, unless they are many.
            if 3 * left <= looked_at {
                lanes.keep_open(column, left);
                if left == 0 {
                    return;
                }
            }
        }
        lanes.keep_open(column, lanes.x.len());
    }
}
