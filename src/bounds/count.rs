//! How many designs of a box are feasible, without looking at each.
//!
//! A box that surely violates a requirement counts nothing, one that surely satisfies all counts whole. Axes that nothing open depends
//! on multiply; requirements that share no axis are counted apart and multiplied; two groups of axes that meet in one number are
//! counted by [`Pairs`]; small boxes are evaluated in f64, the others are cut in two. Counts by bins and by cells of a map (`bins`, `cells`)
//! follow the same rules.

use super::axes::{AXES, Axes, Span, Spans};
use super::bounder::{AskedNumber, Bounder};
use super::box_columns::BoxColumns;
use super::open::{Bounded, Decided, Open, decide, each_scenario, over, scenarios};
use super::pairing::Pairing;
use super::pairs::{Instance, Pairs};
use super::requirement::NumberSource;
use super::study_tape::StudyTape;
use crate::tape::{CHUNK, Node};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};

/// A box is evaluated where that takes about as many operations as a few more bounds.
pub const LEAF: f64 = 2e5;
/// Pairs are worth their lists where they take this much less than all designs.
pub const SAVING: f64 = 20.0;
/// Least operations that all designs must take before pairs are thought of.
pub const LARGE: f64 = 1e6;
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

    /// As it stands in `run.json`.
    pub(super) fn to_json(self) -> Value {
        json!({
            "designs": self.designs(), "in_infeasible_boxes": self.infeasible, "in_feasible_boxes": self.feasible,
            "in_products": self.products, "in_pairs_of_lists": self.pairs, "judged_in_f64": self.evaluated,
            "boxes": self.boxes, "evaluations": self.evaluations,
        })
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
    pub(super) tape: &'t StudyTape,
    pub(super) axes: &'t Axes,
    pub(super) requirements: &'t [Bounded],
    pub(super) bounder: Bounder<'t>,
    columns: BoxColumns<'t>,
    pub(super) pairs: Pairs<'t>,
    pub(super) stop: &'t AtomicBool,
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
pub enum Inside {
    /// Its own, for so many designs of the study as each of its designs stands for.
    Box(u64),
    /// That of the product.
    Product,
}

/// Which rule settles a box.
#[derive(Clone, Copy)]
pub enum SettledBy {
    /// It surely violates a requirement.
    Infeasible,
    /// It surely satisfies all.
    Feasible,
    /// Requirements share no axis.
    Product,
    /// Pairs of two groups of axes.
    Pairs,
    /// Its designs were evaluated.
    Evaluation,
}

/// What of a box bears on some of its axes.
pub struct Bearing {
    /// Axes that nothing bears on are at their first level.
    pub spans: Spans,
    /// The requirements that share axes with them, directly or through others.
    pub open: Vec<Open>,
    /// How many feasible designs each feasible one of these spans stands for.
    pub each: u64,
    /// How its parts are settled.
    pub inside: Inside,
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
        let found = self.count_box(spans, open, Inside::Box(1));
        self.settled.evaluations += self.pairs.evaluated - before;
        found
    }

    /// Notes by which rule the designs of a box were settled.
    pub(super) fn settle(&mut self, by: SettledBy, size: u64, inside: Inside) {
        let Inside::Box(weight) = inside else { return };
        let rule = match by {
            SettledBy::Infeasible => &mut self.settled.infeasible,
            SettledBy::Feasible => &mut self.settled.feasible,
            SettledBy::Product => &mut self.settled.products,
            SettledBy::Pairs => &mut self.settled.pairs,
            SettledBy::Evaluation => &mut self.settled.evaluated,
        };
        *rule += size * weight;
        (self.told.0)(size * weight);
    }

    /// What is open over a box, and how much every axis moves it; `Some(None)` if all of its designs are infeasible, and settled; `None` if
    /// it was stopped.
    pub(super) fn decide(&mut self, spans: &Spans, open: &[Open], inside: Inside) -> Option<Option<(Vec<Open>, [f64; AXES])>> {
        if self.stop.load(Ordering::Relaxed) {
            return None;
        }
        self.settled.boxes += 1;
        Some(match decide(self.requirements, &mut self.bounder, self.axes, spans, open) {
            Decided::Infeasible => {
                self.settle(SettledBy::Infeasible, self.axes.count(spans), inside);
                None
            }
            Decided::Open(open, pull, _) => Some((open, pull)),
        })
    }

    /// Of one of its boxes.
    fn count_box(&mut self, spans: &Spans, open: &[Open], inside: Inside) -> Option<u64> {
        match self.decide(spans, open, inside)? {
            Some((open, pull)) => self.count_decided(spans, open, &pull, inside),
            None => Some(0),
        }
    }

    /// Of one of which it is known what is open.
    pub(super) fn count_decided(&mut self, spans: &Spans, open: Vec<Open>, pull: &[f64; AXES], inside: Inside) -> Option<u64> {
        let size = self.axes.count(spans);
        if open.is_empty() {
            self.settle(SettledBy::Feasible, size, inside);
            return Some(size);
        }
        let sets = self.sets(spans, &open);
        let groups = groups(&sets);
        let live = groups.iter().fold(0, |all, group| all | group);
        // Axes that nothing open depends on stay at their first level and multiply.
        let reduced = reduce(spans, live, self.axes);
        let free = size / self.axes.count(&reduced);
        if groups.len() > 1 {
            self.settle(SettledBy::Product, size, inside);
            return Some(free * self.product(&reduced, &open, &sets, &groups)?);
        }
        let designs = self.axes.count(&reduced);
        let exhaustive = designs as f64 * self.operations_of(&open);
        if exhaustive <= LEAF || designs == 1 {
            self.settle(SettledBy::Evaluation, size, inside);
            let alive = self.evaluate(&reduced, &open);
            return Some(free * alive.into_iter().filter(|&alive| alive).count() as u64);
        }
        if exhaustive > LARGE
            && let Some(found) = self.count_pairs(&reduced, &open, exhaustive)
        {
            self.settle(SettledBy::Pairs, size, inside);
            return (!self.stop.load(Ordering::Relaxed)).then_some(free * found);
        }
        let axis = self.axis_to_cut(&reduced, &open, 0, pull);
        let mut total = 0;
        for part in reduced.halves(axis) {
            total += self.count_box(&part, &open, inside.of_each(free))?;
        }
        Some(free * total)
    }

    /// The varying design axes that each of these depends on.
    fn sets(&self, spans: &Spans, open: &[Open]) -> Vec<u64> {
        let varying = varying(spans, self.axes);
        open.iter().map(|item| self.requirements[item.requirement].asked.axis_set() & varying).collect()
    }

    /// Counts requirements that share no axis each by itself and multiplies; those of no axis at all are decided by one design.
    fn product(&mut self, spans: &Spans, open: &[Open], sets: &[u64], groups: &[u64]) -> Option<u64> {
        let of = |is_in: &dyn Fn(u64) -> bool| -> Vec<Open> {
            open.iter().zip(sets).filter(|(_, set)| is_in(**set)).map(|(item, _)| item.clone()).collect()
        };
        let mut product = 1;
        for &group in groups {
            let part = reduce(spans, group, self.axes);
            product *= self.count_box(&part, &of(&|set| set & group != 0), Inside::Product)?;
            if product == 0 {
                return Some(0);
            }
        }
        let constant = of(&|set| set == 0);
        if !constant.is_empty() {
            product *= u64::from(self.evaluate(&reduce(spans, 0, self.axes), &constant)[0]);
        }
        Some(product)
    }

    /// What of a box bears on a set of axes. The other requirements are counted; axes that nothing bears on multiply. `Some(None)` if no
    /// design is feasible, and settled; `None` if it was stopped.
    pub(super) fn bearing_on(&mut self, set: u64, spans: &Spans, open: &[Open], inside: Inside) -> Option<Option<Bearing>> {
        let sets = self.sets(spans, open);
        let size = self.axes.count(spans);
        let asked = set & varying(spans, self.axes);
        let mut others = groups(&sets.iter().copied().chain([asked]).collect::<Vec<_>>());
        let own = others.iter().position(|group| group & asked != 0).map_or(0, |at| others.swap_remove(at));
        let live = others.iter().fold(own, |all, group| all | group);
        let free = size / self.axes.count(&reduce(spans, live, self.axes));
        let apart = |set: u64| set & own == 0;
        if !sets.iter().any(|&set| apart(set)) {
            return Some(Some(Bearing {
                spans: reduce(spans, own, self.axes),
                open: open.to_vec(),
                each: free,
                inside: inside.of_each(free),
            }));
        }
        self.settle(SettledBy::Product, size, inside);
        let (open_apart, sets_apart): (Vec<_>, Vec<_>) =
            open.iter().zip(&sets).filter(|(_, set)| apart(**set)).map(|(item, &set)| (item.clone(), set)).unzip();
        let product = self.product(spans, &open_apart, &sets_apart, &others)?;
        let own_open = open.iter().zip(&sets).filter(|(_, set)| !apart(**set)).map(|(item, _)| item.clone()).collect();
        let bearing = Bearing { spans: reduce(spans, own, self.axes), open: own_open, each: free * product, inside: Inside::Product };
        Some((product > 0).then_some(bearing))
    }

    /// About how many operations these take per design.
    pub(super) fn operations_of(&self, open: &[Open]) -> f64 {
        let of = |item: &Open| {
            let it = &self.requirements[item.requirement];
            (it.requirement.needed.len() as f64 + 2.0) * scenarios(&item.cover, &it.asked, self.axes) as f64
        };
        open.iter().map(of).sum()
    }

    /// Counts a box as pairs of two groups of axes, if that takes much less than evaluating it.
    fn count_pairs(&mut self, spans: &Spans, open: &[Open], exhaustive: f64) -> Option<u64> {
        let (pairing, cost) = self.pairing(0, spans, open, None)?;
        if cost * SAVING > exhaustive {
            return None;
        }
        let instances = instances(self.requirements, open, self.axes);
        Some(self.pairs.count(&pairing, spans, &instances, None))
    }

    /// How a box is made of pairs for its open requirements, and for a number besides them in so many scenarios; and what counting them
    /// costs. No unwanted axis is in the first group.
    pub(super) fn pairing(
        &self,
        unwanted: u64,
        spans: &Spans,
        open: &[Open],
        besides: Option<(NumberSource, u64)>,
    ) -> Option<(Pairing, f64)> {
        let bounded = |item: &Open| &self.requirements[item.requirement];
        let of_open: u64 = open.iter().map(|item| scenarios(&item.cover, &bounded(item).asked, self.axes)).sum();
        let scenarios = of_open + besides.map_or(0, |it| it.1);
        if scenarios > PAIRED_SCENARIOS {
            return None;
        }
        let sources = open.iter().map(|item| bounded(item).requirement.source).chain(besides.map(|it| it.0));
        let sources: Vec<NumberSource> = sources.collect();
        let pairing = Pairing::find(unwanted, self.tape, self.axes, spans, &sources)?;
        let cost = pairing.cost * scenarios as f64 / sources.len() as f64;
        (cost <= AT_ONCE).then_some((pairing, cost))
    }

    /// The axis along which the open requirements, and what is `besides` them, differ most; first one that several of them share, so that
    /// they come apart.
    pub(super) fn axis_to_cut(&self, spans: &Spans, open: &[Open], besides: u64, pull: &[f64; AXES]) -> usize {
        let sets = || open.iter().map(|item| self.requirements[item.requirement].asked.axis_set()).chain([besides]);
        let shared = |axis: usize| sets().filter(|set| set >> axis & 1 == 1).count();
        let candidates = (0..self.axes.designs).filter(|&axis| !spans[axis].is_single());
        let by = |axis: &usize| (shared(*axis) as f64, pull[*axis], spans[*axis].count() as f64);
        let first = |a: &(f64, f64, f64), b: &(f64, f64, f64)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2));
        candidates.max_by(|a, b| first(&by(a), &by(b))).expect("a box of more than one design has such an axis")
    }

    /// Judges every design of a box in f64, in all scenarios that are open: which are feasible.
    pub(super) fn evaluate(&mut self, spans: &Spans, open: &[Open]) -> Vec<bool> {
        let mut alive = vec![true; self.axes.count(spans) as usize];
        for item in open {
            let it = &self.requirements[item.requirement];
            self.values(&it.asked, &it.requirement.needed, spans, &item.cover, |design, value| {
                alive[design] &= it.requirement.holds(value)
            });
        }
        alive
    }

    /// A number of every design of a box in f64, in all scenarios of a cover: the design's place in the box, and the value.
    pub(super) fn values(
        &mut self,
        asked: &AskedNumber,
        needed: &[Node],
        spans: &Spans,
        cover: &[Spans],
        mut take: impl FnMut(usize, f64),
    ) {
        let varying: Vec<usize> = (0..self.axes.designs).filter(|&axis| !spans[axis].is_single()).collect();
        let size = self.axes.count(spans) as usize;
        let (columns, axes) = (&mut self.columns, self.axes);
        let evaluations = &mut self.settled.evaluations;
        each_scenario(cover, asked, axes, |scenario| {
            let spans = over(spans, &scenario, axes);
            *evaluations += size as u64;
            match asked.source {
                NumberSource::Known(value) => (0..size).for_each(|design| take(design, value)),
                NumberSource::Axis(axis, column) => {
                    columns.enter(&[], &spans, &varying);
                    for design in 0..size {
                        let level = if axis < axes.designs { columns.levels(design as u64)[axis] } else { spans[axis].low };
                        take(design, axes.all[axis].own[column][level as usize]);
                    }
                }
                NumberSource::Node(node, _) => {
                    columns.enter(needed, &spans, &varying);
                    for first in (0..size).step_by(CHUNK) {
                        let count = CHUNK.min(size - first);
                        columns.chunk(needed, first as u64, count);
                        let value = columns.value(node);
                        (0..count).for_each(|lane| take(first + lane, asked.source.shown(value.at(lane))));
                    }
                }
            }
        });
    }
}

impl Inside {
    /// Of parts of a box each of whose designs stands for so many of the box.
    pub(super) fn of_each(self, free: u64) -> Self {
        match self {
            Self::Box(weight) => Self::Box(weight * free),
            Self::Product => Self::Product,
        }
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
pub fn reduce(spans: &Spans, set: u64, axes: &Axes) -> Spans {
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
