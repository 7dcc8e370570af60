//! How many designs of a box are feasible, without looking at each.
//!
//! A box that surely violates a requirement counts nothing, one that surely satisfies all counts whole. Axes that nothing open depends
//! on multiply; requirements that share no axis are counted apart and multiplied; two groups of axes that meet in one number are
//! counted by [`Pairs`]; small boxes are evaluated in f64, the others are cut in two.

use super::axes::{AXES, Axes, Span, Spans};
use super::bounder::Bounder;
use super::box_columns::BoxColumns;
use super::open::{Bounded, Decided, Open, decide, each_scenario, over, scenarios};
use super::pairing::Pairing;
use super::pairs::{Instance, Pairs};
use super::requirement::NumberSource;
use super::study_tape::StudyTape;
use crate::tape::CHUNK;
use std::sync::atomic::{AtomicBool, Ordering};

/// A box is evaluated where that takes about as many operations as a few more bounds.
const LEAF: f64 = 2e5;
/// Pairs are worth their lists where they take this much less than all designs.
const SAVING: f64 = 20.0;
/// Least operations that all designs must take before pairs are thought of.
const LARGE: f64 = 1e6;
/// Most operations of a box by pairs: about how long nobody can stop it.
const AT_ONCE: f64 = 4e9;
/// Most scenarios that pairs are counted in.
const PAIRED_SCENARIOS: u64 = 64;

/// How the designs of a count were settled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settled {
    /// In boxes that surely violate a requirement.
    pub infeasible: u64,
    /// In boxes that surely satisfy all.
    pub feasible: u64,
    /// In boxes whose requirements share no axis.
    pub products: u64,
    /// In boxes of two groups of axes.
    pub pairs: u64,
    /// In boxes evaluated in f64.
    pub evaluated: u64,
    /// Boxes looked at.
    pub boxes: u64,
    /// Evaluations in f64, of designs or of members of a group, in one scenario each.
    pub evaluations: u64,
}

impl Settled {
    /// All designs that were settled.
    pub fn designs(&self) -> u64 {
        self.infeasible + self.feasible + self.products + self.pairs + self.evaluated
    }

    /// Leaves what was settled since an earlier time.
    pub fn subtract(&mut self, earlier: &Self) {
        self.infeasible -= earlier.infeasible;
        self.feasible -= earlier.feasible;
        self.products -= earlier.products;
        self.pairs -= earlier.pairs;
        self.evaluated -= earlier.evaluated;
        self.boxes -= earlier.boxes;
        self.evaluations -= earlier.evaluations;
    }

    /// Adds what another count settled.
    pub fn add(&mut self, other: &Self) {
        self.infeasible += other.infeasible;
        self.feasible += other.feasible;
        self.products += other.products;
        self.pairs += other.pairs;
        self.evaluated += other.evaluated;
        self.boxes += other.boxes;
        self.evaluations += other.evaluations;
    }
}

/// Counts boxes; one per thread.
#[derive(Debug)]
pub struct BoxCounter<'t> {
    tape: &'t StudyTape,
    axes: &'t Axes,
    requirements: &'t [Bounded],
    bounder: Bounder<'t>,
    columns: BoxColumns<'t>,
    pairs: Pairs<'t>,
    stop: &'t AtomicBool,
    /// How designs were settled.
    pub settled: Settled,
    told: Told<'t>,
}

/// Who is told of every box how many designs were settled.
#[derive(Clone, Copy)]
struct Told<'t>(&'t dyn Fn(u64));

impl std::fmt::Debug for Told<'_> {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.write_str("Told")
    }
}

/// Which rule settled a box: where it is not the box's own, but that of a part of a product.
#[derive(Clone, Copy, PartialEq)]
enum Inside {
    Box,
    Product,
}

impl<'t> BoxCounter<'t> {
    /// A counter for a tape.
    pub fn new(tape: &'t StudyTape, axes: &'t Axes, requirements: &'t [Bounded], stop: &'t AtomicBool) -> Self {
        Self {
            tape,
            axes,
            requirements,
            bounder: Bounder::new(tape, axes),
            columns: BoxColumns::new(tape, axes),
            pairs: Pairs::new(tape, axes, stop),
            stop,
            settled: Settled::default(),
            told: Told(&|_| ()),
        }
    }

    /// Tells of every box how many designs were settled.
    pub fn telling(self, told: &'t dyn Fn(u64)) -> Self {
        Self { told: Told(told), ..self }
    }

    /// Feasible designs of a box; `None` if it was stopped.
    pub fn count(&mut self, spans: &Spans, open: &[Open]) -> Option<u64> {
        let before = self.pairs.evaluated;
        let found = self.count_box(spans, open, 1, Inside::Box);
        self.settled.evaluations += self.pairs.evaluated - before;
        found
    }

    /// Of a box that stands for `weight` designs each.
    fn count_box(&mut self, spans: &Spans, open: &[Open], weight: u64, inside: Inside) -> Option<u64> {
        if self.stop.load(Ordering::Relaxed) {
            return None;
        }
        self.settled.boxes += 1;
        let size = self.axes.count(spans);
        let told = self.told;
        let settle = |rule: &mut u64, designs: u64| {
            if inside == Inside::Box {
                *rule += designs * weight;
                (told.0)(designs * weight);
            }
        };
        let (open, pull) = match decide(self.requirements, &mut self.bounder, self.axes, spans, open) {
            Decided::Infeasible => {
                settle(&mut self.settled.infeasible, size);
                return Some(0);
            }
            Decided::Open(open, pull, _) => (open, pull),
        };
        if open.is_empty() {
            settle(&mut self.settled.feasible, size);
            return Some(size);
        }
        let set_of = |item: &Open| self.requirements[item.requirement].asked.axis_set() & varying(spans, self.axes);
        let groups = groups(&open.iter().map(set_of).collect::<Vec<_>>());
        let live = groups.iter().fold(0, |all, group| all | group);
        // Axes that nothing open depends on stay at their first level and multiply.
        let reduced = reduce(spans, live, self.axes);
        let free = size / self.axes.count(&reduced);
        if groups.len() > 1 {
            settle(&mut self.settled.products, size);
            let mut product = free;
            for group in groups {
                let own: Vec<Open> = open.iter().filter(|item| set_of(item) & !group == 0 && set_of(item) != 0).cloned().collect();
                let part = reduce(&reduced, group, self.axes);
                product *= self.count_box(&part, &own, 1, Inside::Product)?;
                if product == 0 {
                    break;
                }
            }
            // Those of no axis at all are decided by one design.
            let constant: Vec<Open> = open.iter().filter(|item| set_of(item) == 0).cloned().collect();
            if product > 0 && !constant.is_empty() {
                product *= self.evaluate(&reduce(&reduced, 0, self.axes), &constant);
            }
            return Some(product);
        }
        let designs = self.axes.count(&reduced);
        let operations: f64 = open.iter().map(|item| self.operations(item)).sum();
        let exhaustive = designs as f64 * operations;
        if exhaustive <= LEAF || designs == 1 {
            settle(&mut self.settled.evaluated, size);
            return Some(free * self.evaluate(&reduced, &open));
        }
        if exhaustive > LARGE
            && let Some(found) = self.count_pairs(&reduced, &open, exhaustive)
        {
            settle(&mut self.settled.pairs, size);
            return (!self.stop.load(Ordering::Relaxed)).then_some(free * found);
        }
        let axis = self.axis_to_cut(&reduced, &open, &pull);
        let mut total = 0;
        for half in reduced[axis].halves() {
            let mut part = reduced;
            part[axis] = half;
            total += self.count_box(&part, &open, weight * free, inside)?;
        }
        Some(free * total)
    }

    /// About how many operations a requirement takes per design.
    fn operations(&self, item: &Open) -> f64 {
        let it = &self.requirements[item.requirement];
        (it.requirement.needed.len() as f64 + 2.0) * scenarios(&item.cover, &it.asked, self.axes) as f64
    }

    /// Counts a box as pairs of two groups of axes, if that takes much less than evaluating it.
    fn count_pairs(&mut self, spans: &Spans, open: &[Open], exhaustive: f64) -> Option<u64> {
        let many = |item: &Open| scenarios(&item.cover, &self.requirements[item.requirement].asked, self.axes);
        let scenarios: u64 = open.iter().map(many).sum();
        if scenarios > PAIRED_SCENARIOS {
            return None;
        }
        let sources: Vec<NumberSource> = open.iter().map(|item| self.requirements[item.requirement].requirement.source).collect();
        let pairing = Pairing::find(self.tape, self.axes, spans, &sources)?;
        let cost = pairing.cost * scenarios as f64 / open.len() as f64;
        if cost * SAVING > exhaustive || cost > AT_ONCE {
            return None;
        }
        let instances = instances(self.requirements, open, self.axes);
        Some(self.pairs.count(&pairing, spans, &instances, None))
    }

    /// The axis along which the open requirements differ most; first one that several of them share, so that they come apart.
    fn axis_to_cut(&self, spans: &Spans, open: &[Open], pull: &[f64; AXES]) -> usize {
        let shared = |axis: usize| open.iter().filter(|item| self.requirements[item.requirement].asked.axis_set() >> axis & 1 == 1).count();
        let candidates = (0..self.axes.designs).filter(|&axis| !spans[axis].is_single());
        let by = |axis: &usize| (shared(*axis) as f64, pull[*axis], spans[*axis].count() as f64);
        let first = |a: &(f64, f64, f64), b: &(f64, f64, f64)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2));
        candidates.max_by(|a, b| first(&by(a), &by(b))).expect("a box of more than one design has such an axis")
    }

    /// Judges every design of a box in f64, in all scenarios that are open.
    fn evaluate(&mut self, spans: &Spans, open: &[Open]) -> u64 {
        let varying: Vec<usize> = (0..self.axes.designs).filter(|&axis| !spans[axis].is_single()).collect();
        let size = self.axes.count(spans) as usize;
        let mut alive = vec![true; size];
        for item in open {
            let it = &self.requirements[item.requirement];
            let (columns, axes) = (&mut self.columns, self.axes);
            let evaluations = &mut self.settled.evaluations;
            each_scenario(&item.cover, &it.asked, axes, |scenario| {
                let spans = over(spans, &scenario, axes);
                *evaluations += size as u64;
                let requirement = &it.requirement;
                match requirement.source {
                    NumberSource::Known(value) => alive.iter_mut().for_each(|alive| *alive &= requirement.holds(value)),
                    NumberSource::Axis(axis, column) => {
                        columns.enter(&[], &spans, &varying);
                        for (design, alive) in alive.iter_mut().enumerate() {
                            let level = if axis < axes.designs { columns.levels(design as u64)[axis] } else { spans[axis].low };
                            *alive &= requirement.holds(axes.all[axis].own[column][level as usize]);
                        }
                    }
                    NumberSource::Node(node, _) => {
                        columns.enter(&requirement.needed, &spans, &varying);
                        for first in (0..size).step_by(CHUNK) {
                            let count = CHUNK.min(size - first);
                            columns.chunk(&requirement.needed, first as u64, count);
                            let value = columns.value(node);
                            for (lane, alive) in alive[first..first + count].iter_mut().enumerate() {
                                *alive &= requirement.holds(requirement.source.shown(value.at(lane)));
                            }
                        }
                    }
                }
            });
        }
        alive.into_iter().filter(|&alive| alive).count() as u64
    }
}

/// The open requirements in each of their scenarios, for pairs.
pub fn instances<'a>(requirements: &'a [Bounded], open: &[Open], axes: &Axes) -> Vec<Instance<'a>> {
    let mut all = Vec::new();
    for (role, item) in open.iter().enumerate() {
        let it = &requirements[item.requirement];
        each_scenario(&item.cover, &it.asked, axes, |scenario| all.push(Instance { requirement: &it.requirement, role, scenario }));
    }
    all
}

/// Design axes with more than one level, as a bit set.
pub fn varying(spans: &Spans, axes: &Axes) -> u64 {
    (0..axes.designs).filter(|&axis| !spans[axis].is_single()).fold(0, |set, axis| set | 1 << axis)
}

/// A box with all design axes but those of a set at their first level.
fn reduce(spans: &Spans, set: u64, axes: &Axes) -> Spans {
    let mut reduced = *spans;
    for axis in (0..axes.designs).filter(|axis| set >> axis & 1 == 0) {
        reduced[axis] = Span::at(spans[axis].low);
    }
    reduced
}

/// Unites sets that have a member in common; empty ones are left out.
fn groups(sets: &[u64]) -> Vec<u64> {
    let mut groups: Vec<u64> = Vec::new();
    for &set in sets.iter().filter(|&&set| set != 0) {
        let mut united = set;
        groups.retain(|&group| {
            let meets = group & united != 0;
            if meets {
                united |= group;
            }
            !meets
        });
        groups.push(united);
    }
    groups
}
