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
}

/// Of every lane that is looked at: its place in the chunk, and where its search is.
#[derive(Debug, Default)]
struct RootLanes {
    place: Vec<u32>,
    low: Vec<f64>,
    high: Vec<f64>,
    x: Vec<f64>,
    /// How far the step before went; below zero where the search has ended, which stays where it is.
    last_step: Vec<f64>,
    /// Room for the value and slope of a function that has one number for all lanes.
    value: Vec<f64>,
    slope: Vec<f64>,
}

impl RootLanes {
    fn begin(&mut self, count: usize, low: ColumnValue<'_>, high: ColumnValue<'_>, start: ColumnValue<'_>) {
        self.place.clear();
        self.place.extend(0..count as u32);
        let Self { low: lows, high: highs, x, last_step, .. } = self;
        refill(lows, low, count);
        refill(highs, high, count);
        refill(x, start, count);
        x.iter_mut().zip(&*lows).zip(&*highs).for_each(|((x, &low), &high)| *x = f64::min(f64::max(*x, low), high));
        last_step.clear();
        last_step.resize(count, f64::INFINITY);
    }

    /// Takes a step in each lane; the number of lanes that go on.
    fn step(&mut self, value: ColumnValue<'_>, slope: ColumnValue<'_>) -> usize {
        let count = self.x.len();
        let value = of_all(value, &mut self.value, count);
        let slope = of_all(slope, &mut self.slope, count);
        let left = steps(value, slope, &mut self.low, &mut self.high, &mut self.x, &mut self.last_step);
        usize::try_from(left).unwrap_or(count)
    }

    /// Writes where all lanes are, and keeps those that go on.
    fn keep_open(&mut self, column: &mut [f64], left: usize) {
        // As long as none was sorted out each stands at its place.
        if left == 0 && self.x.len() == column.len() {
            return column.copy_from_slice(&self.x);
        }
        let mut kept = 0;
        for lane in 0..self.x.len() {
            column[self.place[lane] as usize] = self.x[lane];
            if !has_ended(self.last_step[lane]) {
                self.place[kept] = self.place[lane];
                for numbers in [&mut self.low, &mut self.high, &mut self.x, &mut self.last_step] {
                    numbers[kept] = numbers[lane];
                }
                kept += 1;
            }
        }
        self.place.truncate(kept);
        [&mut self.low, &mut self.high, &mut self.x, &mut self.last_step].into_iter().for_each(|numbers| numbers.truncate(kept));
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
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn steps(value: &[f64], slope: &[f64], low: &mut [f64], high: &mut [f64], x: &mut [f64], last_step: &mut [f64]) -> u64 {
    let count = x.len();
    let (value, slope, low, high) = (&value[..count], &slope[..count], &mut low[..count], &mut high[..count]);
    let last_step = &mut last_step[..count];
    let mut left = 0;
    for lane in 0..count {
        let above = value[lane] > 0.0;
        high[lane] = if above { x[lane] } else { high[lane] };
        low[lane] = if above { low[lane] } else { x[lane] };
        let newton = x[lane] - value[lane] / slope[lane];
        let halved = 0.5 * (low[lane] + high[lane]);
        let next = if newton >= low[lane] && newton <= high[lane] { newton } else { halved };
        let step = (next - x[lane]).abs();
        let at_rounding = step <= 1e4 * f64::EPSILON * x[lane].abs();
        let had_ended = has_ended(last_step[lane]);
        let ends = had_ended || step == 0.0 || (at_rounding && step >= 0.5 * last_step[lane]);
        x[lane] = if had_ended { x[lane] } else { next };
        last_step[lane] = if ends { -1.0 } else { step };
        left += u64::from(!ends);
    }
    left
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
        Self { numbers: NodeColumns::plain(list), lanes: RootLanes::default() }
    }

    /// The roots of a chunk; `of` gives what the function reads from outside.
    pub fn find<'c>(&mut self, list: &List, number: u8, of: &dyn Fn(Node) -> ColumnValue<'c>, column: &mut [f64]) {
        let Self { numbers, lanes } = self;
        let ListRoot { root, inner } = &list.roots[number as usize];
        let (low, high, start) = (of(root.bracket.0), of(root.bracket.1), of(root.start));
        lanes.begin(column.len(), low, high, start);
        let mut outside: Vec<Node> = Vec::new();
        list.outside(number, |node| {
            if !outside.contains(&node) {
                outside.push(node);
            }
        });
        let differs: Vec<Node> = outside.iter().copied().filter(|&node| matches!(of(node), ColumnValue::Each(_))).collect();
        for &node in outside.iter().filter(|node| !differs.contains(node)) {
            numbers.slots[node as usize] = of(node).at(0);
        }
        // What has a number of its own in each lane: what the function reads of that kind, and all that it computes.
        let mut each = vec![false; list.operations.len()];
        differs.iter().chain(inner).chain([&root.argument]).for_each(|&node| each[node as usize] = true);
        let each: &dyn Fn(Node) -> bool = &|node| each[node as usize];
        let mut gathered = 0;
        for _ in 0..MOST_STEPS {
            let looked_at = lanes.x.len();
            numbers.begin(looked_at);
            if gathered != looked_at {
                gathered = looked_at;
                for &node in &differs {
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
            // A copy: the slope of a function, or its value, may be the argument itself.
            numbers.fill(root.argument, |to| to.copy_from_slice(&lanes.x));
            for &node in inner {
                numbers.compute(list, node, each);
            }
            let left = lanes.step(numbers.value(root.value, each), numbers.value(root.slope, each));
            // Lanes that have ended cost less than to sort them out, unless they are many.
            if 4 * left <= looked_at {
                lanes.keep_open(column, left);
                if left == 0 {
                    return;
                }
            }
        }
        lanes.keep_open(column, lanes.x.len());
    }
}
