//! Roots over a chunk of designs: Newton's steps of all lanes side by side, each lane's the very steps that it takes alone.

use super::columns::{ColumnValue, NodeColumns};
use super::{List, ListRoot, Node, Operation};

/// Steps of a root at most, and what counts as rounding: those of `bracketed_newton`.
const MOST_STEPS: usize = 100;

/// Room for the roots of a list.
#[derive(Debug)]
pub struct RootColumns {
    /// The functions' operations, over the lanes that are still under way.
    numbers: NodeColumns,
    /// Of every lane under way: its place in the chunk, and where its search is.
    lanes: Vec<Lane>,
}

/// The search of one lane.
#[derive(Clone, Copy, Debug)]
struct Lane {
    place: u32,
    low: f64,
    high: f64,
    x: f64,
    last_step: f64,
}

impl Lane {
    /// Takes a step; true if it was the last.
    #[inline(always)]
    fn step(&mut self, value: f64, slope: f64) -> bool {
        let above = value > 0.0;
        self.high = if above { self.x } else { self.high };
        self.low = if above { self.low } else { self.x };
        let newton = self.x - value / slope;
        let next = if newton >= self.low && newton <= self.high { newton } else { 0.5 * (self.low + self.high) };
        let step = (next - self.x).abs();
        let at_rounding = step <= 1e4 * f64::EPSILON * self.x.abs();
        self.x = next;
        let ends = step == 0.0 || (at_rounding && step >= 0.5 * self.last_step);
        self.last_step = step;
        ends
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
        Self { numbers: NodeColumns::plain(list), lanes: Vec::new() }
    }

    /// The roots of a chunk; `of` gives what the function reads from outside.
    pub fn find<'c>(&mut self, list: &List, number: u8, of: &dyn Fn(Node) -> ColumnValue<'c>, column: &mut [f64]) {
        let Self { numbers, lanes } = self;
        let ListRoot { root, inner } = &list.roots[number as usize];
        let (low, high, start) = (of(root.bracket.0), of(root.bracket.1), of(root.start));
        lanes.clear();
        lanes.extend((0..column.len()).map(|lane| {
            let (low, high) = (low.at(lane), high.at(lane));
            let x = f64::min(f64::max(start.at(lane), low), high);
            Lane { place: lane as u32, low, high, x, last_step: f64::INFINITY }
        }));
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
            numbers.begin(lanes.len());
            if gathered != lanes.len() {
                gathered = lanes.len();
                for &node in &differs {
                    let ColumnValue::Each(values) = of(node) else { continue };
                    numbers.fill(node, |to| to.iter_mut().zip(&*lanes).for_each(|(to, lane)| *to = values[lane.place as usize]));
                }
            }
            numbers.fill(root.argument, |to| to.iter_mut().zip(&*lanes).for_each(|(to, lane)| *to = lane.x));
            for &node in inner {
                numbers.compute(list, node, each);
            }
            let (value, slope) = (numbers.value(root.value, each), numbers.value(root.slope, each));
            let mut kept = 0;
            for at in 0..lanes.len() {
                let mut lane = lanes[at];
                if lane.step(value.at(at), slope.at(at)) {
                    column[lane.place as usize] = lane.x;
                } else {
                    lanes[kept] = lane;
                    kept += 1;
                }
            }
            lanes.truncate(kept);
            if lanes.is_empty() {
                return;
            }
        }
        lanes.iter().for_each(|lane| column[lane.place as usize] = lane.x);
    }
}
