//! Roots over a chunk of designs: Newton's steps of all lanes side by side, each lane's the very steps that it takes alone.

use super::columns::{ColumnValue, NodeColumns};
use super::{KnownFunction, List, ListRoot, Node, Operation, RootParameter};
use crate::real::{MOST_STEPS, ROOT_PARAMETERS, RootSearch, Smoothness, has_ended, newton_step};
use multiversion::multiversion;

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
    /// Room for the parameters of a function that has been compiled.
    parameters: [Vec<f64>; ROOT_PARAMETERS],
}

/// Of every lane that is looked at: its place in the chunk, and where its search is.
#[derive(Debug, Default)]
struct RootLanes {
    place: Vec<u32>,
    now: RootSearch<Vec<f64>>,
    /// Room for what a step leaves.
    next: RootSearch<Vec<f64>>,
    /// Room for the value and slope of a function that has one number for all lanes.
    value: Vec<f64>,
    slope: Vec<f64>,
}

impl RootSearch<Vec<f64>> {
    fn all(&mut self) -> [&mut Vec<f64>; 4] {
        [&mut self.x, &mut self.low, &mut self.high, &mut self.last_step]
    }

    fn read(&self) -> RootSearch<&[f64]> {
        RootSearch { x: &self.x, low: &self.low, high: &self.high, last_step: &self.last_step }
    }

    /// Room for so many lanes.
    fn written(&mut self, count: usize) -> RootSearch<&mut [f64]> {
        self.all().into_iter().for_each(|numbers| numbers.resize(count, 0.0));
        RootSearch { x: &mut self.x, low: &mut self.low, high: &mut self.high, last_step: &mut self.last_step }
    }
}

impl RootLanes {
    fn begin(&mut self, count: usize, low: ColumnValue<'_>, high: ColumnValue<'_>, start: ColumnValue<'_>) {
        self.place.clear();
        self.place.extend(0..count as u32);
        let RootSearch { x, low: lows, high: highs, last_step } = &mut self.now;
        refill(lows, low, count);
        refill(highs, high, count);
        refill(x, start, count);
        x.iter_mut().zip(&*lows).zip(&*highs).for_each(|((x, &low), &high)| *x = f64::min(f64::max(*x, low), high));
        last_step.clear();
        last_step.resize(count, f64::INFINITY);
    }

    /// Number of lanes that are looked at.
    fn count(&self) -> usize {
        self.place.len()
    }

    /// Takes a step in each lane from where its function was asked; the number of lanes that go on.
    fn step(&mut self, asked: &[f64], value: ColumnValue<'_>, slope: ColumnValue<'_>, smoothness: Smoothness) -> usize {
        let count = asked.len();
        let value = of_all(value, &mut self.value, count);
        let slope = of_all(slope, &mut self.slope, count);
        let RootSearch { low, high, last_step, .. } = self.now.read();
        let next = self.next.written(count);
        let left = steps(asked, value, slope, low, high, last_step, next.x, next.low, next.high, next.last_step, smoothness);
        std::mem::swap(&mut self.now, &mut self.next);
        left
    }

    /// The same of a function that has been compiled; `None` where it takes a rare way.
    fn step_of(&mut self, function: &KnownFunction, parameters: [&[f64]; ROOT_PARAMETERS]) -> Option<usize> {
        let left = (function.step)(parameters, self.now.read(), self.next.written(self.place.len()))?;
        std::mem::swap(&mut self.now, &mut self.next);
        Some(left)
    }

    /// Have all lanes ended, of which so many go on? Then they are written.
    fn have_ended(&mut self, column: &mut [f64], left: usize) -> bool {
        // Lanes that have ended cost less than to sort them out, unless they are many.
        if 3 * left <= self.count() {
            self.keep_open(column, left);
        }
        left == 0
    }

    /// Writes where all lanes are, and keeps those that go on.
    fn keep_open(&mut self, column: &mut [f64], left: usize) {
        // As long as none was sorted out each stands at its place.
        if left == 0 && self.count() == column.len() {
            return column.copy_from_slice(&self.now.x);
        }
        let Self { place, now, .. } = self;
        let mut kept = 0;
        for lane in 0..place.len() {
            column[place[lane] as usize] = now.x[lane];
            // Without a branch: whether a lane goes on cannot be foreseen. What does not is overwritten by the next.
            place[kept] = place[lane];
            for numbers in now.all() {
                numbers[kept] = numbers[lane];
            }
            kept += usize::from(!has_ended(now.last_step[kept]));
        }
        place.truncate(kept);
        now.all().into_iter().for_each(|numbers| numbers.truncate(kept));
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

/// The step of `bracketed_newton` in each lane; how many go on.
///
/// What is left is written elsewhere than what was there: else the compiler stores under masks, which takes many times as long.
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
    smoothness: Smoothness,
) -> usize {
    let count = asked.len();
    let (value, slope, x) = (&value[..count], &slope[..count], &mut x[..count]);
    let (low, high, last_step) = (&low[..count], &high[..count], &last_step[..count]);
    let (next_low, next_high, next_last) = (&mut next_low[..count], &mut next_high[..count], &mut next_last[..count]);
    let mut left = 0_u64;
    for lane in 0..count {
        let at = RootSearch { x: asked[lane], low: low[lane], high: high[lane], last_step: last_step[lane] };
        let next = newton_step(at, value[lane], slope[lane], f64::EPSILON, smoothness);
        (x[lane], next_low[lane], next_high[lane], next_last[lane]) = (next.x, next.low, next.high, next.last_step);
        left += u64::from(!has_ended(next.last_step));
    }
    left as usize
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
        Self {
            numbers: NodeColumns::plain(list),
            outside,
            lanes: RootLanes::default(),
            differs: Vec::new(),
            each: Vec::new(),
            parameters: Default::default(),
        }
    }

    /// The roots of a chunk; `of` gives what the function reads from outside.
    pub fn find<'c>(&mut self, list: &List, number: u8, of: &dyn Fn(Node) -> ColumnValue<'c>, column: &mut [f64]) {
        let ListRoot { root, .. } = &list.roots[number as usize];
        self.lanes.begin(column.len(), of(root.bracket.0), of(root.bracket.1), of(root.start));
        let steps = match &root.function {
            Some(function) => self.find_by(function, of, column),
            None => 0,
        };
        if steps < MOST_STEPS {
            self.find_by_operations(list, number, of, column, steps);
        }
    }

    /// The same of a function that has been compiled. How many steps were taken: all of them, unless it takes a rare way in some lane.
    fn find_by<'c>(&mut self, function: &KnownFunction, of: &dyn Fn(Node) -> ColumnValue<'c>, column: &mut [f64]) -> usize {
        let Self { lanes, parameters: room, .. } = self;
        let values = function.parameters.map(|parameter| match parameter {
            RootParameter::Number(number) => ColumnValue::One(number),
            RootParameter::Node(node) => of(node),
        });
        let mut gathered = 0;
        for steps in 0..MOST_STEPS {
            let (looked_at, is_whole) = (lanes.count(), lanes.count() == column.len());
            if gathered != looked_at {
                gathered = looked_at;
                for (room, &values) in room.iter_mut().zip(&values) {
                    match values {
                        ColumnValue::One(_) => refill(room, values, looked_at),
                        ColumnValue::Each(_) if is_whole => {}
                        ColumnValue::Each(values) => {
                            room.clear();
                            room.extend(lanes.place.iter().map(|&place| values[place as usize]));
                        }
                    }
                }
            }
            let at = |number: usize| match values[number] {
                ColumnValue::Each(values) if is_whole => values,
                _ => &room[number][..],
            };
            let Some(left) = lanes.step_of(function, std::array::from_fn(at)) else { return steps };
            if lanes.have_ended(column, left) {
                return MOST_STEPS;
            }
        }
        lanes.keep_open(column, lanes.count());
        MOST_STEPS
    }

    /// The same operation by operation, where so many steps have been taken.
    fn find_by_operations<'c>(&mut self, list: &List, number: u8, of: &dyn Fn(Node) -> ColumnValue<'c>, column: &mut [f64], taken: usize) {
        let Self { numbers, lanes, outside, differs, each, .. } = self;
        let ListRoot { root, inner } = &list.roots[number as usize];
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
        for _ in taken..MOST_STEPS {
            let looked_at = lanes.count();
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
            numbers.swap(root.argument, &mut lanes.now.x);
            for &node in inner {
                numbers.compute(list, node, each);
            }
            let ColumnValue::Each(asked) = numbers.value(root.argument, each) else { unreachable!("it differs between lanes") };
            let left = lanes.step(asked, numbers.value(root.value, each), numbers.value(root.slope, each), root.smoothness);
            if lanes.have_ended(column, left) {
                return;
            }
        }
        lanes.keep_open(column, lanes.count());
    }
}
