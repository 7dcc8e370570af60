//! Two groups of axes that meet in one number: how they are found.

use super::axes::{AXES, Axes, Span, Spans};
use super::chain::Chain;
use super::requirement::NumberSource;
use super::study_tape::StudyTape;
use crate::tape::Node;

/// Most members of the first group's list: they are held in memory.
const LIST: u64 = 1 << 22;
/// What looking for a threshold costs, in operations of a column.
const THRESHOLD: f64 = 150.0;

/// How a number is made of the two groups.
#[derive(Clone, Debug, PartialEq)]
pub enum PairRole {
    /// Of neither.
    Outer,
    /// Of the first alone.
    First,
    /// Of the second alone.
    Second,
    /// Of both.
    Both(Chain),
}

/// Two groups of axes, and those that both share.
#[derive(Clone, Debug)]
pub struct Pairing {
    /// Axes that both groups share.
    pub outer: Vec<usize>,
    /// Axes of the first group, outermost first.
    pub first: Vec<usize>,
    /// Axes of the second group.
    pub second: Vec<usize>,
    /// Of every number asked for: how it is made of the two.
    pub roles: Vec<PairRole>,
    /// About how many operations of f64 it takes, for one scenario.
    pub cost: f64,
}

fn list(set: u64) -> Vec<usize> {
    (0..AXES).filter(|axis| set >> axis & 1 == 1).collect()
}

impl Pairing {
    /// The cheapest way to see the numbers asked for as made of two groups of the axes that vary in a box, with no unwanted one in the first.
    pub fn find(unwanted: u64, tape: &StudyTape, axes: &Axes, spans: &Spans, sources: &[NumberSource]) -> Option<Self> {
        let varying = (0..axes.designs).filter(|&axis| !spans[axis].is_single()).fold(0u64, |set, axis| set | 1 << axis);
        let widest = sources.iter().max_by_key(|source| (source.axes(tape) & varying).count_ones())?;
        let mut best: Option<Self> = None;
        for chain in Chain::all(tape, *widest, varying) {
            if let Some(found) = Self::about(tape, spans, sources, varying, &chain)
                && found.first.iter().all(|axis| unwanted >> axis & 1 == 0)
                && best.as_ref().is_none_or(|best| found.cost < best.cost)
            {
                best = Some(found);
            }
        }
        best
    }

    /// Is the number in this role made of both groups?
    pub fn is_through_both(&self, role: usize) -> bool {
        matches!(self.roles[role], PairRole::Both(_))
    }

    /// How many designs of a box differ along the axes of both groups and those that they share.
    pub fn size(&self, spans: &Spans) -> u64 {
        [&self.outer, &self.first, &self.second].into_iter().flatten().map(|&axis| spans[axis].count()).product()
    }

    /// Splits a box into about that many parts which cost no more when they are counted apart.
    pub fn parts(&self, spans: &Spans, count: usize) -> Vec<Spans> {
        let Some(&axis) = self.outer.iter().max_by_key(|&&axis| spans[axis].count()) else { return vec![*spans] };
        let Span { low, high } = spans[axis];
        let levels = spans[axis].count();
        let count = (count as u64).min(levels);
        let edge = |part: u64| low + (levels * part / count) as u32;
        let part = |part: u64| {
            let mut own = *spans;
            own[axis] = Span { low: edge(part), high: (edge(part + 1) - 1).min(high) };
            own
        };
        (0..count).map(part).collect()
    }

    /// The groups that one chain suggests.
    fn about(tape: &StudyTape, spans: &Spans, sources: &[NumberSource], varying: u64, chain: &Chain) -> Option<Self> {
        let (start, others) = (tape.axes[chain.channel as usize] & varying, chain.other_axes & varying);
        let mut outer = start & others;
        let (first, second) = (start & !outer, others & !outer);
        if first == 0 || second == 0 {
            return None;
        }
        let within = |set: u64, outer: u64, group: u64| set & varying & !outer & !group == 0;
        let mut roles = Vec::new();
        for &source in sources {
            let own = source.axes(tape) & varying;
            outer |= own & !(first | second);
            roles.push(if within(own, outer, 0) {
                PairRole::Outer
            } else if within(own, outer, first) {
                PairRole::First
            } else if within(own, outer, second) {
                PairRole::Second
            } else {
                let fits = |it: &Chain| within(tape.axes[it.channel as usize], outer, first) && within(it.other_axes, outer, second);
                let same = |it: &&Chain| it.channel == chain.channel && fits(it);
                let all = Chain::all(tape, source, varying);
                PairRole::Both(all.iter().find(same).or_else(|| all.iter().find(|it| fits(it)))?.clone())
            });
        }
        let size = |set: u64| list(set).into_iter().map(|axis| spans[axis].count()).product::<u64>();
        if size(first) > LIST || size(second) > LIST {
            return None;
        }
        let needed = |nodes: &[Node]| tape.list.needed_by(nodes).len() as f64;
        let both: Vec<&Chain> = roles.iter().filter_map(|role| if let PairRole::Both(chain) = role { Some(chain) } else { None }).collect();
        let channels: Vec<Node> = both.iter().map(|chain| chain.channel).collect();
        let of_others: Vec<Node> = both.iter().flat_map(|chain| chain.others.iter().copied()).collect();
        let per_first = needed(&channels) + 10.0;
        let per_second = needed(&of_others) + THRESHOLD * both.len() as f64;
        let cost = size(outer) as f64 * (size(first) as f64 * per_first + size(second) as f64 * per_second);
        Some(Self { outer: list(outer), first: list(first), second: list(second), roles, cost })
    }
}
