//! Requirements that are not decided yet over a box of designs, each with the scenarios that still matter.

use super::axes::{Axes, Span, Spans};
use super::bounder::{AskedNumber, Bounder, Bounds, Wanted};
use super::requirement::{Requirement, Test};
use std::sync::Arc;

/// Most boxes of scenarios that a requirement is followed over.
const COVER: usize = 64;
/// And a number whose worst value is bounded.
const WORST_COVER: usize = 32;

/// A requirement, ready to be bounded.
#[derive(Debug)]
pub struct Bounded {
    /// What is required.
    pub requirement: Requirement,
    /// Its number, worse in the direction of the bound.
    pub asked: AskedNumber,
}

/// A requirement that some design of a box may violate in some of these scenarios.
#[derive(Clone, Debug)]
pub struct Open {
    /// Its place among all requirements.
    pub requirement: usize,
    /// Boxes of scenarios; their spans of design axes are not read.
    pub cover: Arc<[Spans]>,
}

/// What became of the requirements over a box.
pub enum Decided {
    /// Every design of the box violates one of them in some scenario.
    Infeasible,
    /// These are open; how much every axis moves them is summed up, relative to what is left to decide; and where they hold better.
    Open(Vec<Open>, [f64; super::axes::AXES], BetterEnds),
}

/// Ends of axes that are better in every respect.
#[derive(Clone, Copy, Debug)]
pub struct BetterEnds {
    /// Axes whose first level is no worse than any other, as a bit set.
    pub first: u64,
    /// Axes whose last level is.
    pub last: u64,
    /// Of either: axes of which the better end is better than every other level, whatever the design's index.
    pub strict: u64,
}

impl BetterEnds {
    /// Before anything was asked for.
    pub const ANY: Self = Self { first: u64::MAX, last: u64::MAX, strict: 0 };

    /// Narrows them down by one more number. `strictly`: does being better in it make up for a higher index?
    pub fn narrow(&mut self, asked: &AskedNumber, bounds: &Bounds, worse_is_sought: bool, strictly: bool) {
        // What has no part in a number leaves it as it is, bit by bit; elsewhere f64 must not swap two levels.
        let untouched = !asked.axis_set();
        let last = bounds.strict & if worse_is_sought { !bounds.better_at_last } else { bounds.better_at_last };
        let first = bounds.strict & if worse_is_sought { bounds.better_at_last } else { !bounds.better_at_last };
        self.first &= untouched | first;
        self.last &= untouched | last;
        if strictly {
            self.strict |= bounds.strict & asked.axis_set();
        }
    }

    /// Keeps every level of a set of axes, whatever is better.
    pub fn keep(&mut self, set: u64) {
        self.first &= !set;
        self.last &= !set;
    }

    /// A box without the designs that one of its ends makes superfluous.
    pub fn collapse(&self, spans: &Spans, axes: &Axes) -> Spans {
        let mut left = *spans;
        for axis in (0..axes.designs).filter(|&axis| !spans[axis].is_single()) {
            // Of equals the lowest index counts, and that is at the first level.
            if self.first >> axis & 1 == 1 {
                left[axis] = Span::at(spans[axis].low);
            } else if self.last >> axis & self.strict >> axis & 1 == 1 {
                left[axis] = Span::at(spans[axis].high);
            }
        }
        left
    }
}

/// Spans of designs with those of a scenario box.
pub fn over(designs: &Spans, scenarios: &Spans, axes: &Axes) -> Spans {
    super::pairs::with_scenario(designs, scenarios, axes)
}

/// All requirements over all scenarios.
pub fn all_open(requirements: &[Bounded], axes: &Axes) -> Vec<Open> {
    (0..requirements.len()).map(|requirement| Open { requirement, cover: Arc::new([axes.whole()]) }).collect()
}

/// Bounds the open requirements over a box.
pub fn decide(requirements: &[Bounded], bounder: &mut Bounder<'_>, axes: &Axes, designs: &Spans, open: &[Open]) -> Decided {
    let mut left = Vec::new();
    let mut pull = [0.0; super::axes::AXES];
    let mut ends = BetterEnds::ANY;
    for item in open {
        let it = &requirements[item.requirement];
        // The scenarios that are left: mostly the same as before.
        let mut cover: Option<Vec<Spans>> = None;
        for (at, part) in item.cover.iter().enumerate() {
            let spans = over(designs, part, axes);
            // Without derivatives it is cheaper, and often enough.
            if !bounder.has(&it.asked, &spans) {
                let (low, high) = bounder.range(&it.asked, &spans);
                let finite = !it.requirement.finite || low > f64::NEG_INFINITY && high < f64::INFINITY;
                if finite && it.requirement.test.holds(low) && it.requirement.test.holds(high) {
                    cover.get_or_insert_with(|| item.cover[..at].to_vec());
                    continue;
                }
                if violated(it.requirement.test, low, high) {
                    return Decided::Infeasible;
                }
            }
            let bounds = bounder.bounds(&it.asked, &spans, Wanted::Both);
            let (worst, best) = if it.asked.higher_is_worse { (bounds.most, bounds.least) } else { (-bounds.most, -bounds.least) };
            if (bounds.finite || !it.requirement.finite) && it.requirement.test.holds(worst) {
                cover.get_or_insert_with(|| item.cover[..at].to_vec());
                continue;
            }
            if !matches!(it.requirement.test, Test::Finite) && !it.requirement.test.holds(best) && !best.is_nan() {
                return Decided::Infeasible;
            }
            add_pull(&mut pull, &bounds, &spans, axes);
            if matches!(it.requirement.test, Test::Finite) {
                // Which designs have a number is not told by its bounds.
                ends.first &= !it.asked.axis_set();
                ends.last &= !it.asked.axis_set();
            } else {
                ends.narrow(&it.asked, &bounds, false, false);
            }
            let room = item.cover.len() < COVER;
            let worst = worst_scenarios(part, &bounds, axes);
            if worst != *part && !matches!(it.requirement.test, Test::Finite) {
                cover.get_or_insert_with(|| item.cover[..at].to_vec()).push(worst);
                continue;
            }
            match scenario_to_split(&it.asked, &bounds, &spans, axes).filter(|_| room) {
                Some(axis) => cover.get_or_insert_with(|| item.cover[..at].to_vec()).extend(part.halves(axis)),
                None => {
                    if let Some(cover) = &mut cover {
                        cover.push(*part);
                    }
                }
            }
        }
        match cover {
            None => left.push(item.clone()),
            Some(cover) if cover.is_empty() => {}
            Some(cover) => left.push(Open { requirement: item.requirement, cover: cover.into() }),
        }
    }
    Decided::Open(left, pull, ends)
}

/// Does every number between two ends violate the test?
fn violated(test: Test, low: f64, high: f64) -> bool {
    match test {
        Test::Low(..) => !test.holds(high),
        Test::High(..) => !test.holds(low),
        Test::Finite => false,
    }
}

/// Does every design of a box violate one of the requirements, as far as bounds without derivatives tell?
pub fn is_infeasible(requirements: &[Bounded], bounder: &mut Bounder<'_>, axes: &Axes, designs: &Spans, open: &[Open]) -> bool {
    open.iter().any(|item| {
        let it = &requirements[item.requirement];
        item.cover.iter().any(|part| {
            let (low, high) = bounder.range(&it.asked, &over(designs, part, axes));
            violated(it.requirement.test, low, high)
        })
    })
}

/// Adds how much each axis of designs moves a number, relative to the sum over all axes.
pub fn add_pull(pull: &mut [f64; super::axes::AXES], bounds: &Bounds, spans: &Spans, axes: &Axes) {
    let moves = |axis: usize| if spans[axis].is_single() { 0.0 } else { bounds.spread[axis] };
    let all: f64 = (0..axes.designs).map(moves).sum();
    for (axis, pull) in pull.iter_mut().enumerate().take(axes.designs) {
        let own = moves(axis);
        if own > 0.0 {
            // Where a derivative is unbounded, the axes that may be to blame share it.
            *pull += if all.is_finite() { own / all } else { f64::from(u8::from(own.is_infinite())) };
        }
    }
}

/// Of a box of scenarios: those that decide about a number for every design that its bounds are of, in f64 too.
pub fn worst_scenarios(part: &Spans, bounds: &Bounds, axes: &Axes) -> Spans {
    let mut worst = *part;
    if bounds.finite {
        for axis in (axes.designs..axes.all.len()).filter(|&axis| bounds.strict >> axis & 1 == 1) {
            worst[axis] = Span::at(if bounds.better_at_last >> axis & 1 == 1 { part[axis].low } else { part[axis].high });
        }
    }
    worst
}

/// The scenario axis that a box of scenarios should be cut along, if the scenarios leave more open than the designs do.
pub fn scenario_to_split(asked: &AskedNumber, bounds: &Bounds, spans: &Spans, axes: &Axes) -> Option<usize> {
    let all = axes.all.len();
    let undecided = |axis: &usize| asked.axis_set() >> axis & 1 == 1 && !spans[*axis].is_single() && bounds.monotone >> axis & 1 == 0;
    let widest = (axes.designs..all).filter(undecided).max_by(|a, b| bounds.spread[*a].total_cmp(&bounds.spread[*b]))?;
    let of_designs = (0..axes.designs).filter(|&axis| asked.axis_set() >> axis & 1 == 1 && !spans[axis].is_single());
    let designs: f64 = of_designs.map(|axis| bounds.spread[axis]).sum();
    let is_single = (0..axes.designs).all(|axis| spans[axis].is_single() || asked.axis_set() >> axis & 1 == 0);
    (is_single || bounds.spread[widest] >= designs || bounds.spread[widest].is_infinite()).then_some(widest)
}

/// Bounds of the worst value of a number over all scenarios, as badness: no design of the box is worse than the second, none better than
/// the first. The cover becomes the scenarios that may be worst; `each` is told of their bounds and boxes.
pub fn worst_of(
    asked: &AskedNumber,
    bounder: &mut Bounder<'_>,
    axes: &Axes,
    designs: &Spans,
    cover: &mut Arc<[Spans]>,
    wanted: Wanted,
    mut each: impl FnMut(&Bounds, &Spans),
) -> (f64, f64) {
    // Which of several scenarios decides takes both ends of each.
    let wanted = if cover.len() == 1 { wanted } else { Wanted::Both };
    let bounded: Vec<_> = cover.iter().map(|part| (*part, bounder.bounds(asked, &over(designs, part, axes), wanted))).collect();
    let least = bounded.iter().fold(f64::NEG_INFINITY, |least, (_, it)| least.max(it.least));
    // What is not a number may be anything.
    let more = |most: f64, it: f64| if most.is_nan() || it.is_nan() { f64::NAN } else { most.max(it) };
    let most = bounded.iter().fold(f64::NEG_INFINITY, |most, (_, it)| more(most, it.most));
    let room = cover.len() < WORST_COVER;
    let mut left = Vec::new();
    // Where another scenario is worse for every design of the box, this one decides nothing.
    for (part, it) in bounded.iter().filter(|(_, it)| it.most >= least || it.most.is_nan()) {
        let part = &worst_scenarios(part, it, axes);
        let whole = over(designs, part, axes);
        each(it, &whole);
        match scenario_to_split(asked, it, &whole, axes).filter(|_| room) {
            Some(axis) => left.extend(part.halves(axis)),
            None => left.push(*part),
        }
    }
    if left[..] != cover[..] {
        *cover = left.into();
    }
    (least, most)
}

/// The scenarios of all boxes of a cover, one by one.
pub fn each_scenario(cover: &[Spans], asked: &AskedNumber, axes: &Axes, mut each: impl FnMut(Spans)) {
    for part in cover {
        let mut at = *part;
        let moving: Vec<usize> = (axes.designs..axes.all.len()).filter(|&axis| asked.axis_set() >> axis & 1 == 1).collect();
        for axis in axes.designs..axes.all.len() {
            at[axis] = Span::at(part[axis].low);
        }
        'scenarios: loop {
            each(at);
            for &axis in moving.iter().rev() {
                if at[axis].low < part[axis].high {
                    at[axis] = Span::at(at[axis].low + 1);
                    continue 'scenarios;
                }
                at[axis] = Span::at(part[axis].low);
            }
            break;
        }
    }
}

/// How many scenarios a cover has, of those that make a difference to the number.
pub fn scenarios(cover: &[Spans], asked: &AskedNumber, axes: &Axes) -> u64 {
    let differing = |part: &Spans| -> u64 {
        (axes.designs..axes.all.len()).filter(|&axis| asked.axis_set() >> axis & 1 == 1).map(|axis| part[axis].count()).product()
    };
    cover.iter().map(differing).sum()
}
