//! Draws as the formula of a model: of a design, every draw in every operating case, one after the other.

use super::super::quantity::Quantity;
use super::super::resolved::Constraint;
use super::columns::{AskedDraws, BLOCK, DrawColumns, DrawnBlock};
use super::confirm::FreshDraws;
use super::drive::{DrawnDrive, margin_of};
use super::early::least_counts;
use super::fold::{of_any, over_cases, over_draws};
use super::lanes::DrawnLanes;
use super::statistic::{AskedQuantity, ConfirmedEnd, Statistic, StatisticKind};
use crate::masks::{count, mask};
use crate::models::{Columns, Dependencies, Footprint, Kernel, Scratch, Sizes, Status, Worse, judge, shown};
use crate::probability::{Effect, REPLICATES, replicated};
use crate::tape::{Known, Set};
use rustc_hash::FxHashMap;
use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Fewest draws that are computed together.
pub(super) const TOGETHER: usize = 256;
/// Of a block of draws computed together, one in so many is computed by the scalar formula too; of one block in so many, every draw.
const COMPARED: usize = 64;
const WHOLE: u64 = 256;
/// Most designs whose fresh draws are remembered.
const MOST_HELD: usize = 10_000;

/// Draws as a formula.
pub struct DrawnKernel {
    drive: DrawnDrive,
    /// What the statistics need of every draw, and the formula over many draws at a time, where that is possible.
    asked: AskedDraws,
    together: OnceLock<Option<DrawColumns>>,
    /// The same for fresh draws, of which only those that hold are counted.
    counting: OnceLock<Option<DrawColumns>>,
    /// Fresh draws that hold, of designs by their inputs: who certifies a design, who looks for values below zero and the page all ask for them.
    held: Mutex<FxHashMap<Vec<u64>, u64>>,
    /// Blocks of draws that were computed together so far.
    blocks: AtomicU64,
    /// Tells kernels apart where a result is kept for the next call.
    id: u64,
}

static NEXT: AtomicU64 = AtomicU64::new(0);

/// The last design that a thread computed: of which kernel, its inputs, what was wanted, and its results.
type LastDesign = (u64, Vec<u64>, Set, Vec<Option<f64>>);

thread_local! {
    static LAST: RefCell<Option<LastDesign>> = const { RefCell::new(None) };
}

impl std::ops::Deref for DrawnKernel {
    type Target = DrawnDrive;

    fn deref(&self) -> &DrawnDrive {
        &self.drive
    }
}

impl DrawnKernel {
    /// Of a drive.
    pub fn new(drive: DrawnDrive) -> Self {
        let asked = AskedDraws::of(&drive.statistics);
        let [together, counting] = [OnceLock::new(), OnceLock::new()];
        Self {
            asked,
            together,
            counting,
            held: Mutex::default(),
            blocks: AtomicU64::new(0),
            drive,
            id: NEXT.fetch_add(1, Ordering::Relaxed),
        }
    }

    /// The value of a quantity of the drive in its unit.
    fn value(&self, quantity: Quantity, si: &[f64], outputs: &[f64], present: Set) -> f64 {
        match quantity {
            Quantity::Input(input) => self.base.inputs[input].unit.from_si(si[input]),
            Quantity::Output(output) => shown(&self.base, outputs, present, output).unwrap_or(f64::NAN),
        }
    }

    /// The results of one design, given its inputs in SI units: of each statistic its value, if it has one and is wanted.
    pub fn results(&self, design: &[f64], wanted: Set) -> Vec<Option<f64>> {
        let key: Vec<u64> = design.iter().map(|it| it.to_bits()).collect();
        let known = LAST.with_borrow(|last| {
            // Only the fresh draws wait until they are asked for.
            let asked = wanted.iter().filter(|&it| self.is_confirmed(it)).all(|it| last.as_ref().is_some_and(|last| last.2.contains(it)));
            let serves = |it: &&LastDesign| it.0 == self.id && it.1 == key && asked;
            last.as_ref().filter(serves).map(|it| it.3.clone())
        });
        known.unwrap_or_else(|| {
            let results = self.computed(design, wanted);
            LAST.set(Some((self.id, key, wanted, results.clone())));
            results
        })
    }

    fn computed(&self, design: &[f64], wanted: Set) -> Vec<Option<f64>> {
        let draws = self.draws();
        // Of each replicate, if there are such.
        let replicates = self.statistics.iter().any(|it| it.kind == StatisticKind::Confirmed(ConfirmedEnd::StandardError));
        let mut held = vec![0u64; if replicates { REPLICATES as usize } else { 0 }];
        let mut holds = 0;
        let mut kept = vec![0; self.asked.keeping.len()];
        let mut values: Vec<Vec<f64>> = self.asked.quantities.iter().map(|_| Vec::with_capacity(draws)).collect();
        let together = self.recorded(&self.together, &self.asked, draws);
        for first in (0..draws).step_by(BLOCK) {
            let columns: Vec<&[f64]> = self.columns.iter().map(|it| &it[first..draws.min(first + BLOCK)]).collect();
            let block = self.block(together, &self.asked, design, &columns);
            holds += count(&block.holds);
            kept.iter_mut().zip(&block.kept).for_each(|(sum, kept)| *sum += count(kept));
            values.iter_mut().zip(&block.values).for_each(|(to, from)| to.extend(from));
            if replicates {
                (first..).zip(&block.holds).for_each(|(draw, holds)| held[draw * REPLICATES as usize / draws] += holds & 1);
            }
        }
        let holding = (0..self.statistics.len()).any(|it| wanted.contains(it) && self.is_confirmed(it)).then(|| self.holding(design));
        let (mut kept, mut values) = (kept.into_iter(), values.iter());
        let mut own = || values.next().expect("every quantity that is asked for has values");
        let result = |statistic: &Statistic| match statistic.kind {
            StatisticKind::Yield => Some(holds as f64),
            StatisticKind::YieldOf(_) => kept.next().map(|count| count as f64),
            StatisticKind::Plain(asked) => of_any(&asked, own()),
            StatisticKind::Over(asked, over) => over_draws(&asked, over, own()),
            StatisticKind::Confirmed(ConfirmedEnd::StandardError) => {
                let shares: Vec<f64> = held.iter().map(|it| *it as f64 * REPLICATES as f64 / draws as f64).collect();
                replicated(&shares).ok()?.standard_error
            }
            StatisticKind::Confirmed(end) => self.fresh.as_ref().zip(holding).map(|(fresh, holding)| fresh.told(end, holding)),
        };
        self.statistics.iter().map(result).collect()
    }

    /// The formula over many draws, if so many are worth it.
    fn recorded<'k>(&'k self, kept: &'k OnceLock<Option<DrawColumns>>, asked: &AskedDraws, draws: usize) -> Option<&'k DrawColumns> {
        if draws < TOGETHER { None } else { kept.get_or_init(|| DrawColumns::new(&self.drive, asked)).as_ref() }
    }

    /// What comes of a block of draws (a column per drawn input): computed together where that is possible, and then some of them, or all,
    /// by the scalar formula too. Where the two differ, all are computed by the scalar formula.
    pub(super) fn block(&self, together: Option<&DrawColumns>, asked: &AskedDraws, design: &[f64], columns: &[&[f64]]) -> DrawnBlock {
        let draws = columns.first().map_or(0, |it| it.len());
        let alone = |draws: &mut dyn Iterator<Item = usize>| {
            let mut block = DrawnBlock::new(asked);
            draws.for_each(|draw| self.add_draw(asked, &self.cases_of(&|input| columns[input][draw], design), &mut block));
            block
        };
        let Some(together) = together else { return alone(&mut (0..draws)) };
        let found = together.run(&self.drive, design, columns);
        let is_whole = self.blocks.fetch_add(1, Ordering::Relaxed).is_multiple_of(WHOLE);
        let compared = || (0..draws).step_by(if is_whole { 1 } else { COMPARED });
        let others = alone(&mut compared());
        if compared().enumerate().all(|(at, draw)| found.is_same(draw, &others, at)) { found } else { alone(&mut (0..draws)) }
    }

    /// Adds what comes of a draw in all cases.
    fn add_draw(&self, asked: &AskedDraws, cases: &[CaseOfDraw], block: &mut DrawnBlock) {
        block.holds.push(mask(self.draw_holds(cases)));
        block.kept.iter_mut().zip(&asked.keeping).for_each(|(kept, constraint)| kept.push(mask(self.keeps(constraint, cases))));
        let value = |asked: &AskedQuantity| self.over_cases(asked, cases).unwrap_or(f64::NAN);
        block.values.iter_mut().zip(&asked.quantities).for_each(|(values, asked)| values.push(value(asked)));
    }

    /// Is it a statistic that the fresh draws tell? Formulas of statistics have numbers behind those of all statistics.
    fn is_confirmed(&self, output: usize) -> bool {
        self.statistics.get(output).is_some_and(|it| matches!(it.kind, StatisticKind::Confirmed(_)))
    }

    /// How many of the fresh draws hold.
    fn holding(&self, design: &[f64]) -> u64 {
        let held = || self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let key: Vec<u64> = design.iter().map(|it| it.to_bits()).collect();
        let known = held().get(&key).copied();
        known.unwrap_or_else(|| {
            let count = self.count_fresh(design);
            let mut held = held();
            if held.len() < MOST_HELD {
                held.insert(key, count);
            }
            count
        })
    }

    /// Counts the fresh draws that hold.
    fn count_fresh(&self, design: &[f64]) -> u64 {
        let nothing = AskedDraws::default();
        let mut held = |columns: &[Vec<f64>]| {
            let counting = self.recorded(&self.counting, &nothing, columns.first().map_or(0, Vec::len));
            let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            count(&self.block(counting, &nothing, design, &columns).holds)
        };
        self.fresh.as_ref().map_or(0, |fresh| fresh.holding(&mut held))
    }

    /// One of the draws that choose, in all cases.
    pub(super) fn drawn_cases(&self, design: &[f64], draw: usize) -> Vec<CaseOfDraw> {
        self.cases_of(&|input| self.columns[input][draw], design)
    }

    /// One draw of a design in all cases.
    fn cases_of(&self, drawn: &dyn Fn(usize) -> f64, design: &[f64]) -> Vec<CaseOfDraw> {
        let (base, kernel) = (&self.base, &*self.base.kernel);
        let wanted: Set = self.outputs.iter().copied().collect();
        let sizes = kernel.sizes();
        let mut si = vec![0.0; design.len()];
        let case = |case: usize| {
            if !self.turn(drawn, case, design, &mut si) {
                return CaseOfDraw { status: None, si: si.clone(), outputs: Vec::new(), present: Set::EMPTY };
            }
            let mut prepared = vec![0.0; kernel.prepared_len()];
            kernel.prepare(&si, wanted, &mut prepared);
            let [mut outputs, mut margins] = [sizes.outputs, sizes.conditions].map(|length| vec![0.0; length]);
            kernel.finish_with_conditions(&prepared, &si, wanted, &mut outputs, &mut margins);
            let (status, present) = judge(base, &margins);
            CaseOfDraw { status: Some(status), si: si.clone(), outputs, present }
        };
        (0..self.cases.rows.len()).map(case).collect()
    }

    fn draw_holds(&self, cases: &[CaseOfDraw]) -> bool {
        cases.iter().all(|it| it.status == Some(Status::Ok)) && self.holds.iter().all(|constraint| self.keeps(constraint, cases))
    }

    /// Does a draw keep a constraint in all cases?
    pub(super) fn keeps(&self, constraint: &Constraint, cases: &[CaseOfDraw]) -> bool {
        if constraint.over.is_worst() {
            return cases.iter().all(|it| {
                let value = self.in_case(constraint.quantity, it);
                value.is_finite() && constraint.holds(value)
            });
        }
        [Worse::Higher, Worse::Lower].into_iter().all(|worse| {
            let asked = AskedQuantity { quantity: constraint.quantity, over: constraint.over, worse };
            self.over_cases(&asked, cases).is_some_and(|value| constraint.holds(value))
        })
    }

    fn over_cases(&self, asked: &AskedQuantity, cases: &[CaseOfDraw]) -> Option<f64> {
        let values: Vec<f64> = cases.iter().map(|it| self.in_case(asked.quantity, it)).collect();
        over_cases(asked, &self.cases, &values)
    }

    /// The value of a quantity in a case; NaN if it has none.
    pub(super) fn in_case(&self, quantity: Quantity, case: &CaseOfDraw) -> f64 {
        // Of a draw that cannot be built nothing has a value.
        if case.status.is_none() {
            return f64::NAN;
        }
        self.value(quantity, &case.si, &case.outputs, case.present)
    }
}

/// A draw in one case.
pub(super) struct CaseOfDraw {
    /// `None` where a drawn value is none that its input can have.
    pub(super) status: Option<Status>,
    si: Vec<f64>,
    outputs: Vec<f64>,
    present: Set,
}

impl Kernel for DrawnKernel {
    fn sizes(&self) -> Sizes {
        let conditions = self.absentees().count();
        Sizes { inputs: self.base.inputs.len(), prepared: 0, outputs: self.statistics.len(), conditions }
    }

    fn prepare(&self, _inputs: &[f64], _wanted: Set, _prepared: &mut [f64]) {}

    fn conditions(&self, _prepared: &[f64], inputs: &[f64], margins: &mut [f64]) {
        if margins.is_empty() {
            return;
        }
        let results = self.results(inputs, Set::EMPTY);
        margins.iter_mut().zip(self.absentees()).for_each(|(margin, it)| *margin = margin_of(results[it].is_some()));
    }

    fn finish(&self, _prepared: &[f64], inputs: &[f64], wanted: Set, outputs: &mut [f64]) {
        let results = self.results(inputs, wanted);
        outputs.iter_mut().zip(results).for_each(|(to, value)| *to = value.unwrap_or(f64::NAN));
    }

    fn finish_columns(&self, _prepared: &[f64], inputs: &[f64], columns: &Columns<'_>, scratch: &mut Scratch, results: &mut [Vec<f64>]) {
        let absentees: Vec<usize> = self.absentees().collect();
        let wanted: Set = columns.outputs.iter().copied().chain(columns.conditions.iter().map(|&it| absentees[it])).collect();
        let least = least_counts(&self.drive, &scratch.least);
        let own = scratch.own.get_or_insert_with(|| Box::new(DrawnLanes::new(&self.drive, wanted)));
        let lanes = own.downcast_mut::<DrawnLanes>().expect("scratch serves one model");
        if !lanes.serves(wanted) {
            *lanes = DrawnLanes::new(&self.drive, wanted);
        }
        let fresh = |design: &[f64], statistic: usize| self.results(design, Set::one(statistic))[statistic];
        lanes.ask_for(least);
        lanes.run(&self.drive, inputs, columns, results, &fresh);
    }

    fn footprint(&self, _inputs: &[f64]) -> Footprint {
        let fresh = self.fresh.as_ref().map_or(0, FreshDraws::at_a_time);
        let both = [(&self.together, &self.asked, self.draws()), (&self.counting, &AskedDraws::default(), fresh)];
        let bytes = both.map(|(kept, asked, draws)| self.recorded(kept, asked, draws).map_or(0, |it| it.bytes(&self.drive, draws)));
        Footprint { prepared: 0, scratch: bytes[0].max(bytes[1]) }
    }

    fn dependencies(&self, inputs: &[Known]) -> Dependencies {
        // Inputs that vary below are not what they are above.
        let mut known = inputs.to_vec();
        let own: Set = self.cases.inputs.iter().copied().chain(self.drawn.iter().map(|it| it.0)).collect();
        own.iter().for_each(|input| known[input] = Known::ANY);
        let of_base = self.base.kernel.dependencies(&known);
        let replaced: Set =
            self.cases.inputs.iter().copied().chain(self.drawn.iter().filter(|it| it.1 == Effect::Is).map(|it| it.0)).collect();
        let conditions = self.conditions.iter().map(|&it| of_base.conditions[it]);
        let all: Set = self.outputs.iter().map(|&it| of_base.outputs[it]).chain(conditions).collect();
        let of_inputs =
            self.holds.iter().map(|it| it.quantity).chain(self.statistics.iter().filter_map(|it| Some(it.kind.asked()?.quantity)));
        let of_inputs: Set = of_inputs.filter_map(|it| if let Quantity::Input(input) = it { Some(input) } else { None }).collect();
        let toleranced: Set = self.drawn.iter().map(|it| it.0).collect();
        let all = (all | of_inputs | of_base.prepared | toleranced) - replaced;
        Dependencies {
            prepared: of_base.prepared - replaced,
            outputs: vec![all; self.statistics.len()],
            conditions: vec![all; self.absentees().count()],
        }
    }
}
