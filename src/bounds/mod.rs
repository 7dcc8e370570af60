//! Exact answers without looking at every design: boxes of designs are bounded, and settled whole where their bounds decide.
//!
//! The formula of a study is recorded as a tape (`tape`) and run over intervals and derivatives (`bounder`). Feasible designs are
//! counted by boxes (`count`), what a result names is searched for by branch and bound (`search`); both end in f64, with the bits of
//! the ordinary engines, so a result does not show how it was found. Which rule settled how many designs is the [`Certificate`].

mod axes;
mod bins;
mod bounder;
mod box_columns;
mod cells;
mod chain;
mod count;
mod drawn;
mod leaf;
mod open;
mod pairing;
mod pairs;
mod queue;
mod requirement;
mod rival;
mod search;
mod shared;
mod sorted;
mod sought;
mod staircase;
mod study_tape;
#[cfg(test)]
mod tests;
mod trial;
pub(crate) mod yields;

pub use count::{BoxCounter, Settled};
pub use search::Worker;
pub use shared::Shared;
pub use sought::{Searched, Sought};
pub use yields::{EnclosureProblem, YieldBounds, YieldInput, enclose_yield};

use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::reduce::{KeyRule, ReducerNeeds, Reducers, Reduction, Reported, histogram, map};
use crate::screen::{CpuEngine, Tables};
use crate::study::{Axis, Best, Constraint, Goal, MapSpec, Objective, OverScenarios, Quantity};
use axes::{Axes, Spans};
use bins::{Binned, BinnedNumber};
use bounder::{AskedNumber, Bounder};
use cells::CellAxes;
use open::{Bounded, Decided, all_open};
use pairing::Pairing;
use pairs::{BestPair, Pairs};
use requirement::{NumberSource, Test, requirements};
use search::BoxSearch;
use serde_json::{Value, json};
use shared::{Followers, Rest};
use sought::{ObjectiveProduct, QuotientLimit, Target};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use study_tape::{Merit, StudyTape};

/// Why bounds cannot serve a study: something that asks about every design; `None` if they can.
pub fn refusal(plan: &Plan) -> Option<String> {
    let study = &plan.study;
    if study.probability.is_some() {
        return Some("yields are counted draw by draw, and bounds know levels only".to_owned());
    }
    if study.model.kernel.formula().is_none() {
        return Some(format!("{} is no formula that could be bounded", study.model.name));
    }
    if study.decides_by_spectrum() {
        return Some("a mean or sum over the cases of a spectrum is no worst value, and bounds are on worst values".to_owned());
    }
    if study.sample.is_some() {
        return Some("[sample] draws single designs, and bounds need a grid".to_owned());
    }
    if study.design.iter().any(|axis| matches!(axis, Axis::Joint { .. })) {
        return Some("cases in [design] are single designs, and bounds need a grid".to_owned());
    }
    if let Some(why) = Reported::needs(&study.report).into_iter().find_map(ReducerNeeds::beyond_bounds) {
        return Some(why.to_owned());
    }
    if study.report.sample.is_some() && plan.designs() > drawn::MOST_DESIGNS {
        let most = drawn::MOST_DESIGNS;
        return Some(format!(
            "sample in [report] takes the first feasible designs of a shuffled order, and bounds look up the places of {most} designs at most"
        ));
    }
    let cells = |map: &MapSpec| study.design[map.x].count().saturating_mul(study.design[map.y].count());
    if study.report.maps.iter().any(|map| cells(map) > MOST_CELLS) {
        return Some(format!("a map in [report] has more than {MOST_CELLS} cells"));
    }
    if study.report.variants {
        return Some("variants in [report] lists every design".to_owned());
    }
    Axes::problem(plan)
}

/// Most cells of a map: every thread may meet all of them.
const MOST_CELLS: u64 = 1 << 20;

/// Where a search looks, and who follows it.
#[derive(Clone, Copy)]
pub struct SearchJob<'a> {
    /// The study.
    pub plan: &'a Plan,
    /// What keeps the designs that are found.
    pub reduction: &'a Reduction,
    /// Positions of the designs that are searched.
    pub range: &'a Range<u64>,
    /// Ends the search.
    pub stop: &'a AtomicBool,
    /// Is told how many designs were settled.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

/// A study laid out for bounds.
#[derive(Debug)]
pub struct BoundedStudy {
    axes: Axes,
    tape: StudyTape,
    requirements: Vec<Bounded>,
    /// The numbers of the histograms, and the axes of the maps.
    histograms: Vec<BinnedNumber>,
    maps: Vec<CellAxes>,
    /// Points of a front at which a search gives up.
    pub most_points: u64,
    /// Boxes at which a search gives up.
    pub most_boxes: u64,
}

impl BoundedStudy {
    /// Lays out a plan; `None` if bounds cannot serve it, see [`refusal`].
    pub fn new(plan: &Plan) -> Option<Self> {
        if refusal(plan).is_some() {
            return None;
        }
        let axes = Axes::new(plan)?;
        let tape = StudyTape::new(plan, &axes)?;
        let bounded = |requirement: requirement::Requirement| {
            let asked = AskedNumber::new(&tape, requirement.source, matches!(requirement.test, Test::High(..)));
            Bounded { requirement, asked }
        };
        let requirements = requirements(plan, &tape, &axes).into_iter().map(bounded).collect();
        let most_points = crate::reduce::most_points(plan.study.objectives.len(), crate::reduce::FRONT_BYTES);
        let histograms = plan.study.report.histograms.iter().map(|spec| BinnedNumber::new(plan, &tape, spec)).collect();
        let maps = plan.study.report.maps.iter().map(|spec| CellAxes::new(plan, &axes, spec)).collect();
        Some(Self { axes, tape, requirements, histograms, maps, most_points, most_boxes: u64::MAX })
    }

    /// A counter for one thread.
    pub fn counter<'a>(&'a self, stop: &'a AtomicBool) -> BoxCounter<'a> {
        BoxCounter::new(&self.tape, &self.axes, &self.requirements, stop)
    }

    /// What a thread searches with.
    pub fn worker<'a>(&'a self, plan: &'a Plan, tables: &'a Tables, stop: &'a AtomicBool) -> Worker<'a> {
        Worker { bounder: Bounder::new(&self.tape, &self.axes), engine: CpuEngine::new(plan, tables).stopping_on(stop) }
    }

    /// Feasible designs at a range of positions; `None` if it was stopped.
    pub fn count(&self, counter: &mut BoxCounter<'_>, range: &Range<u64>) -> Option<u64> {
        let open = all_open(&self.requirements, &self.axes);
        let mut total = 0;
        for spans in self.axes.boxes(range) {
            total += counter.count(&spans, &open)?;
        }
        Some(total)
    }

    /// What a result of this plan counts besides the feasible designs.
    pub fn tallies(plan: &Plan) -> Vec<BoxTally> {
        let report = &plan.study.report;
        let histograms = (0..report.histograms.len()).map(BoxTally::Histogram);
        let maps = report.maps.iter().enumerate().filter(|(_, spec)| spec.value == Best::Share);
        histograms.chain(maps.map(|(number, _)| BoxTally::Map(number))).collect()
    }

    /// Counts the feasible designs at a range of positions by bin or by cell, into what the report asks for. Returns how many there are;
    /// `None` if it was stopped.
    pub fn count_by(&self, tally: BoxTally, counter: &mut BoxCounter<'_>, range: &Range<u64>, into: &mut Reported) -> Option<u64> {
        let open = all_open(&self.requirements, &self.axes);
        match tally {
            BoxTally::Histogram(number) => {
                let mut binned = Binned::new(&self.histograms[number], &into.histograms[number]);
                for spans in self.axes.boxes(range) {
                    counter.count_bins(&mut binned, &spans, &open)?;
                }
                let counts = binned.counts;
                into.histograms[number].add(&counts);
                Some(counts.iter().sum())
            }
            BoxTally::Map(number) => {
                let mut total = 0;
                let mut take = |cell: u64, count: u64| {
                    total += count;
                    into.maps[number].add_feasible(cell, count);
                };
                for spans in self.axes.boxes(range) {
                    counter.count_cells(self.maps[number], &spans, &open, &mut take)?;
                }
                Some(total)
            }
        }
    }

    /// The end of a range that starts at `range.start`, has about `about` designs and consists of few boxes.
    pub fn round(&self, range: &Range<u64>, about: u64) -> u64 {
        let step = self.axes.steps.iter().copied().filter(|&step| step <= about.max(1)).max().unwrap_or(1);
        let end = range.start.saturating_add(about.max(1)) / step * step;
        if end > range.start { end.min(range.end) } else { range.end.min(range.start.saturating_add(step)) }
    }

    /// All that a result of this plan names and a search can find.
    pub fn sought(plan: &Plan) -> Vec<Sought> {
        let objectives = plan.study.objectives.len();
        let front = (objectives > 0).then_some(Sought::Front);
        let top = plan.study.report.top.map(|_| Sought::Top);
        let extremes = (0..objectives).flat_map(|objective| [false, true].map(|largest| Sought::Extreme { objective, largest }));
        let maps = plan.study.report.maps.iter().enumerate().filter(|(_, spec)| spec.value != Best::Share);
        front.into_iter().chain(top).chain(extremes).chain(maps.map(|(number, _)| Sought::Cells(number))).collect()
    }

    /// How many times a range is searched for what a result of this plan names.
    pub fn searches(plan: &Plan) -> usize {
        Self::sought(plan).len() + usize::from(plan.study.report.sample.is_some())
    }

    /// Searches a range of positions and takes what it finds into `found`; `None` if it was stopped, or the front has more than
    /// [`BoundedStudy::most_points`], or it took more than [`BoundedStudy::most_boxes`].
    pub fn search(&self, job: SearchJob<'_>, sought: Sought, workers: &mut [Worker<'_>], found: &mut Reducers) -> Option<Searched> {
        self.search_sharing(job, sought, &mut Shared::alone(), workers, found)
    }

    /// Searches boxes; where others follow, it may judge some for them too.
    fn search_boxes(
        &self,
        job: SearchJob<'_>,
        sought: Sought,
        roots: &[Spans],
        followers: Option<Followers<'_>>,
        workers: &mut [Worker<'_>],
        found: &mut Reducers,
    ) -> Option<(Searched, Option<Rest>)> {
        let SearchJob { plan, reduction, range, stop, progress } = job;
        let targets = self.targets(plan, sought);
        let search = BoxSearch {
            axes: &self.axes,
            range,
            requirements: &self.requirements,
            reduction,
            stop,
            progress,
            sought,
            targets,
            cells: if let Sought::Cells(number) = sought { Some(self.maps[number]) } else { None },
            product: (sought == Sought::Front).then(|| self.product(plan)).flatten(),
            plan,
            effort: plan.effort(),
            bounding: self.tape.list.operations.len() as f64 * OPERATION,
            row: plan.fast.count(),
            most_points: self.most_points,
            most_boxes: self.most_boxes,
            followers,
        };
        search.run(roots, workers, found)
    }

    fn targets(&self, plan: &Plan, sought: Sought) -> Vec<Target> {
        let target = |objective: &Objective, at_the_bad_end: bool| {
            let source = NumberSource::of(objective.quantity, plan, &self.tape);
            let asked = AskedNumber::new(&self.tape, source, objective.goal == Goal::Min);
            let limits = self.limits(plan, objective.quantity, asked.higher_is_worse == at_the_bad_end);
            Target { asked, rule: KeyRule::from(objective), at_the_bad_end, limits }
        };
        let best = |quantity, goal| target(&Objective { quantity, goal, resolution: None, over: OverScenarios::Worst }, false);
        match sought {
            Sought::Front => plan.study.objectives.iter().map(|objective| target(objective, false)).collect(),
            Sought::Top => plan.study.report.top.iter().map(|top| best(top.by, top.goal)).collect(),
            Sought::Cells(number) => match plan.study.report.maps[number].value {
                Best::Value(quantity, goal) => vec![best(quantity, goal)],
                Best::Share => Vec::new(),
            },
            Sought::Extreme { objective, largest } => {
                let objective = &plan.study.objectives[objective];
                vec![target(objective, (objective.goal == Goal::Min) == largest)]
            }
        }
    }

    /// A product or quotient of two outputs, if factors cancel and scenarios do not matter; with what takes it to their units.
    fn merit(&self, plan: &Plan, merit: Merit) -> Option<(AskedNumber, f64)> {
        let &(_, node) = self.tape.merits.iter().find(|(it, _)| *it == merit)?;
        let outputs = [merit.first, merit.second];
        let all = outputs.iter().filter_map(|(output, _)| self.tape.outputs[*output]).chain([node]);
        let depends = all.fold(0, |set, node| set | self.tape.axes[node as usize]);
        if (self.axes.designs..self.axes.all.len()).any(|axis| depends >> axis & 1 == 1 && self.axes.all[axis].count() > 1) {
            return None;
        }
        let unit = outputs.iter().fold(1.0, |unit, &(output, is_above)| {
            let own = plan.study.model.outputs[output].unit.from_si(1.0);
            if is_above { unit * own } else { unit / own }
        });
        Some((AskedNumber::new(&self.tape, NumberSource::Node(node, None), true), unit))
    }

    /// The product of two objectives that are compared as they are.
    fn product(&self, plan: &Plan) -> Option<ObjectiveProduct> {
        let [a, b] = &plan.study.objectives[..] else { return None };
        let (Quantity::Output(first), Quantity::Output(second)) = (a.quantity, b.quantity) else { return None };
        if a.resolution.is_some() || b.resolution.is_some() {
            return None;
        }
        let largest = [a.goal == Goal::Max, b.goal == Goal::Max];
        let (asked, unit) = self.merit(plan, Merit { first: (first, largest[0]), second: (second, largest[1]) })?;
        Some(ObjectiveProduct { asked, unit, largest })
    }

    /// What limits a quantity of which large (or small) values are sought.
    fn limits(&self, plan: &Plan, quantity: Quantity, is_large_sought: bool) -> Vec<QuotientLimit> {
        let Quantity::Output(first) = quantity else { return Vec::new() };
        let limit = |constraint: &Constraint| {
            let Quantity::Output(second) = constraint.quantity else { return None };
            let (bound, _) = if is_large_sought { constraint.high } else { constraint.low }?;
            let (quotient, unit) = self.merit(plan, Merit { first: (first, is_large_sought), second: (second, !is_large_sought) })?;
            let limited = AskedNumber::new(&self.tape, NumberSource::of(constraint.quantity, plan, &self.tape), false);
            // A quotient of the better over the worse: for small values it stands in the denominator.
            Some(QuotientLimit { quotient, limited, bound: if is_large_sought { bound * unit } else { bound / unit } })
        };
        plan.study.constraints.iter().filter_map(limit).collect()
    }

    /// The extreme of a number that a requirement cuts off at that very end: almost every box on the cut might hold it, so bounds alone
    /// would not get far. Pairs find it while they count; `None` if the study is not made of pairs.
    fn extreme_of_pairs(
        &self,
        job: SearchJob<'_>,
        sought: Sought,
        target: &Target,
        roots: &[Spans],
        workers: &mut [Worker<'_>],
        found: &mut Reducers,
    ) -> Option<Searched> {
        let Sought::Extreme { objective, largest } = sought else { return None };
        let SearchJob { reduction, stop, .. } = job;
        let NumberSource::Node(node, _) = target.asked.source else { return None };
        let cuts = |it: &&Bounded| it.requirement.source == target.asked.source && matches!(it.requirement.test, Test::High(..)) == largest;
        // What comes near a bound of 0 has a small factor, and boxes do tell where that is.
        let is_far = |it: &&Bounded| matches!(it.requirement.test, Test::High(bound, _) | Test::Low(bound, _) if bound != 0.0);
        self.requirements.iter().filter(is_far).find(cuts)?;
        let scenario_axes = (self.axes.designs..self.axes.all.len()).filter(|&axis| self.axes.all[axis].count() > 1);
        if scenario_axes.clone().any(|axis| self.tape.axes[node as usize] >> axis & 1 == 1) {
            return None;
        }
        let mut searched = Searched::default();
        let held = if largest { found.extremes.largest[objective] } else { found.extremes.least[objective] };
        let beyond = if largest { f64::NEG_INFINITY } else { f64::INFINITY };
        let mut best =
            held.map_or(BestPair { largest, value: beyond, index: u64::MAX }, |it| BestPair { largest, value: it.value, index: it.index });
        let (mut planned, mut feasible) = (Vec::new(), 0);
        for spans in roots {
            searched.boxes += 1;
            let open = all_open(&self.requirements, &self.axes);
            let open = match open::decide(&self.requirements, &mut workers[0].bounder, &self.axes, spans, &open) {
                Decided::Infeasible => {
                    searched.infeasible += self.axes.count(spans);
                    continue;
                }
                Decided::Open(open, ..) => open,
            };
            let sources: Vec<NumberSource> = open.iter().map(|it| self.requirements[it.requirement].requirement.source).collect();
            let sources: Vec<NumberSource> = sources.into_iter().chain([target.asked.source]).collect();
            let pairing = Pairing::find(0, &self.tape, &self.axes, spans, &sources)?;
            if !pairing.is_through_both(open.len()) || pairing.cost > self.axes.count(spans) as f64 || pairing.cost > PAIRED_EXTREME {
                return None;
            }
            planned.push((*spans, open, pairing));
        }
        for (spans, open, pairing) in planned {
            let instances = count::instances(&self.requirements, &open, &self.axes);
            let parts = pairing.parts(&spans, workers.len());
            let count = |part: &Spans| {
                let mut own = best;
                let mut pairs = Pairs::new(&self.tape, &self.axes, stop);
                let found = pairs.count(&pairing, part, &instances, Some((open.len(), &mut own)));
                (own, pairs.evaluated, found)
            };
            // Of the axes that nothing asked for depends on, each level has as many.
            let each = self.axes.count(&spans) / pairing.size(&spans);
            let counted = on_threads(&parts, count);
            for (own, evaluations, found) in counted {
                searched.evaluations += evaluations;
                feasible += each * found;
                if best.beats(own.value, own.index) {
                    best = own;
                }
            }
            searched.pairs += self.axes.count(&spans);
        }
        if stop.load(Ordering::Relaxed) {
            return Some(searched);
        }
        searched.counted = Some(feasible);
        if best.index < u64::MAX && held.is_none_or(|held| held.index != best.index) {
            let mut reducers = reduction.start();
            let position = [self.position_of(best.index)];
            workers[0].engine.screen_some(&position, |block| reduction.absorb_counted(&mut reducers, block));
            found.merge(reducers.into_fresh());
        }
        Some(searched)
    }

    /// The position of a design index.
    fn position_of(&self, index: u64) -> u64 {
        let each = self.axes.all[..self.axes.designs].iter().zip(&self.axes.steps);
        each.map(|(axis, step)| index / axis.stride % axis.count() * step).sum()
    }
}

/// What is counted besides the number of feasible designs, by its number in the report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoxTally {
    /// A histogram.
    Histogram(usize),
    /// A map of shares.
    Map(usize),
}

impl BoxTally {
    /// By its name, which is that of its file.
    pub fn in_words(self, plan: &Plan) -> String {
        match self {
            Self::Histogram(number) => histogram::names(&plan.study)[number].replacen('-', " of ", 1),
            Self::Map(number) => map::names(&plan.study)[number].replacen('-', " of ", 1),
        }
    }
}

/// Seconds that an operation of a formula takes in all bounds of a box.
const OPERATION: f64 = 1e-7;
/// Most operations of a search by pairs: some hours of one thread.
const PAIRED_EXTREME: f64 = 1e14;

/// What settled every design: once for the count, and once for each thing that was searched for.
#[derive(Clone, Debug, Default)]
pub struct Certificate {
    /// For the count of feasible designs.
    pub count: Settled,
    /// For each histogram and each map of shares: what, and how.
    pub tallies: Vec<(String, Settled)>,
    /// For each search: what for, and how.
    pub searches: Vec<(String, Searched)>,
    /// Designs of random ranges that were judged one by one besides, and compared.
    pub compared: u64,
}

impl Certificate {
    /// Boxes that were looked at in all.
    pub fn boxes(&self) -> u64 {
        self.counts().map(|it| it.boxes).sum::<u64>() + self.searches.iter().map(|(_, it)| it.boxes).sum::<u64>()
    }

    /// Evaluations in f64 in all.
    pub fn evaluations(&self) -> u64 {
        self.counts().map(|it| it.evaluations).sum::<u64>() + self.searches.iter().map(|(_, it)| it.evaluations).sum::<u64>()
    }

    /// Have bounds a part in what was counted? Otherwise every design was judged by the engine.
    pub fn is_count_bounded(&self) -> bool {
        self.counts().any(|it| it.boxes > 0 || it.evaluated < it.designs())
    }

    /// All that was counted.
    fn counts(&self) -> impl Iterator<Item = &Settled> {
        std::iter::once(&self.count).chain(self.tallies.iter().map(|(_, it)| it))
    }

    /// As it stands in `run.json`.
    pub fn to_json(&self) -> Value {
        let tallies = self.tallies.iter().map(|(name, it)| {
            let mut tally = it.to_json();
            tally["for"] = name.as_str().into();
            tally
        });
        let searches = self.searches.iter().map(|(name, it)| {
            json!({
                "for": name, "designs": it.designs(), "in_infeasible_boxes": it.infeasible, "in_beaten_boxes": it.beaten,
                "in_pairs_of_lists": it.pairs, "judged_in_f64": it.evaluated, "boxes": it.boxes, "evaluations": it.evaluations,
            })
        });
        json!({
            "count": self.count.to_json(),
            "tallies": tallies.collect::<Vec<_>>(),
            "searches": searches.collect::<Vec<_>>(),
            "boxes": self.boxes(),
            "evaluations": self.evaluations(),
            "compared_one_by_one": self.compared,
        })
    }
}

/// What a search is for, in words.
pub fn in_words(plan: &Plan, sought: Sought) -> String {
    match sought {
        Sought::Front => "front".to_owned(),
        Sought::Top => "top".to_owned(),
        Sought::Cells(number) => BoxTally::Map(number).in_words(plan),
        Sought::Extreme { objective, largest } => {
            let name = plan.study.objectives[objective].quantity.name(&plan.study.model);
            format!("{} {name}", if largest { "largest" } else { "least" })
        }
    }
}
