//! Draws as the formula of a model: of a design, every draw in every operating case, one after the other.

use super::super::quantity::Quantity;
use super::super::resolved::Constraint;
use super::counting::DrawCounting;
use super::drive::{DrawnDrive, margin_of};
use super::early::least_counts;
use super::fold::{of_any, over_cases, over_draws};
use super::lanes::DrawnLanes;
use super::statistic::{AskedQuantity, ConfirmedEnd, Statistic, StatisticKind};
use crate::models::{Columns, Dependencies, Kernel, Scratch, Sizes, Status, Worse, judge, shown};
use crate::probability::{Effect, REPLICATES, replicated};
use crate::tape::{Known, Set};
use std::cell::RefCell;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Draws as a formula.
pub struct DrawnKernel {
    drive: DrawnDrive,
    /// How draws are counted many at a time, where that is possible.
    counting: OnceLock<Option<DrawCounting>>,
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
        Self { drive, counting: OnceLock::new(), id: NEXT.fetch_add(1, Ordering::Relaxed) }
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
        let mut counts = vec![0u64; self.statistics.len()];
        // Of each replicate, if there are such.
        let replicates = self.statistics.iter().any(|it| it.kind == StatisticKind::Confirmed(ConfirmedEnd::StandardError));
        let mut held = vec![0u64; if replicates { REPLICATES as usize } else { 0 }];
        let mut values: Vec<Vec<f64>> =
            self.statistics.iter().map(|it| Vec::with_capacity(if it.kind.may_be_absent() { draws } else { 0 })).collect();
        for draw in 0..draws {
            let cases = self.drawn_cases(design, draw);
            for (number, statistic) in self.statistics.iter().enumerate() {
                match statistic.kind {
                    StatisticKind::Yield => counts[number] += u64::from(self.draw_holds(&cases)),
                    StatisticKind::YieldOf(constraint) => counts[number] += u64::from(self.keeps(&constraint, &cases)),
                    StatisticKind::Plain(asked) | StatisticKind::Over(asked, _) => {
                        values[number].push(self.over_cases(&asked, &cases).unwrap_or(f64::NAN));
                    }
                    StatisticKind::Confirmed(ConfirmedEnd::StandardError) => {
                        held[draw * REPLICATES as usize / draws] += u64::from(self.draw_holds(&cases));
                    }
                    StatisticKind::Confirmed(_) => {}
                }
            }
        }
        let holding = (0..self.statistics.len()).any(|it| wanted.contains(it) && self.is_confirmed(it)).then(|| self.holding(design));
        let result = |(number, statistic): (usize, &Statistic)| match statistic.kind {
            StatisticKind::Yield | StatisticKind::YieldOf(_) => Some(counts[number] as f64),
            StatisticKind::Plain(asked) => of_any(&asked, &values[number]),
            StatisticKind::Over(asked, over) => over_draws(&asked, over, &values[number]),
            StatisticKind::Confirmed(ConfirmedEnd::StandardError) => {
                let shares: Vec<f64> = held.iter().map(|it| *it as f64 * REPLICATES as f64 / draws as f64).collect();
                replicated(&shares).ok()?.standard_error
            }
            StatisticKind::Confirmed(end) => self.fresh.as_ref().zip(holding).map(|(fresh, holding)| fresh.told(end, holding)),
        };
        self.statistics.iter().enumerate().map(result).collect()
    }

    /// Is it a statistic that the fresh draws tell? Formulas of statistics have numbers behind those of all statistics.
    fn is_confirmed(&self, output: usize) -> bool {
        self.statistics.get(output).is_some_and(|it| matches!(it.kind, StatisticKind::Confirmed(_)))
    }

    /// How many of the fresh draws hold.
    fn holding(&self, design: &[f64]) -> u64 {
        let counting = self.counting.get_or_init(|| DrawCounting::new(&self.drive));
        let mut count = |columns: &[Vec<f64>]| {
            if let Some(counting) = counting {
                return counting.holding(&self.drive, design, columns);
            }
            let holds = |draw: usize| self.draw_holds(&self.cases_of(&|input| columns[input][draw], design));
            (0..columns.first().map_or(0, Vec::len)).filter(|&draw| holds(draw)).count() as u64
        };
        self.fresh.as_ref().map_or(0, |fresh| fresh.holding(&mut count))
    }

    /// One of the draws that choose, in all cases.
    pub(super) fn drawn_cases(&self, design: &[f64], draw: usize) -> Vec<CaseOfDraw> {
        self.cases_of(&|input| self.columns[input][draw], design)
    }

    /// One draw of a design in all cases.
    fn cases_of(&self, drawn: &dyn Fn(usize) -> f64, design: &[f64]) -> Vec<CaseOfDraw> {
        let (base, kernel) = (&self.base, &*self.base.kernel);
        let wanted: Set = self.outputs.iter().copied().collect();
        let mut si = vec![0.0; design.len()];
        let case = |case: usize| {
            if !self.turn(drawn, case, design, &mut si) {
                return CaseOfDraw { status: None, si: si.clone(), outputs: Vec::new(), present: Set::EMPTY };
            }
            let mut prepared = vec![0.0; kernel.prepared_len()];
            kernel.prepare(&si, wanted, &mut prepared);
            let outputs = kernel.outputs(&prepared, &si, wanted);
            let (status, present) = judge(base, &kernel.margins(&prepared, &si));
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
