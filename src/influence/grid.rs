//! All combinations of the factors' levels, or those of a coarser grid.

use super::evaluated::QuantityColumns;
use super::results::{Estimate, InfluenceMethod, InfluenceReport, QuantityVerdict, WithinHolding, of_orders};
use super::subject::InfluenceSubject;
use crate::error::Result;
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::screen::Control;
use crate::sensitivity::{GridTally, all_but};
use crate::study::InfluenceOver;
use std::collections::{BTreeMap, BTreeSet};

/// Levels of a range, of which a coarser grid takes some.
const LEVELS_OF_RANGE: u64 = 1001;

impl InfluenceSubject {
    /// Looks at the combinations of all levels, at most `limit`. If these are all, they give exact shares; in any case they tell of the designs
    /// that hold.
    pub(super) fn on_grid(&self, limit: u64, threads: usize, control: &Control, report: &mut InfluenceReport) -> Result<()> {
        let Some(axes) = self.factors.iter().map(|it| it.as_levels(LEVELS_OF_RANGE)).collect::<Option<Vec<_>>>() else { return Ok(()) };
        let plan = self.with_axes(axes);
        let designs = plan.space.designs.coarse(limit);
        let levels = self.levels_of(&plan, &designs);
        let (values, holding) = self.of_designs(&plan, &designs, threads, control)?;
        if self.grid_of_all().is_some() {
            report.method = InfluenceMethod::Grid { combinations: designs.len() as u64 };
            self.of_all(&levels, &values, threads, report)?;
        }
        if self.over == InfluenceOver::Design {
            report.held_grid = Some((designs.len() as u64, holding.iter().filter(|it| **it).count() as u64));
            self.of_holding(&levels, (&values, &holding), threads, report)?;
        }
        Ok(())
    }

    /// Of each factor: how many of its levels the designs have.
    fn levels_of(&self, plan: &Plan, designs: &[u64]) -> Vec<usize> {
        let of_factor = |factor: usize| -> BTreeSet<u64> { designs.iter().map(|&it| plan.space.designs.digit(factor, it)).collect() };
        (0..self.factors.len()).map(|factor| of_factor(factor).len()).collect()
    }

    /// Shares in the variance over all combinations.
    fn of_all(&self, levels: &[usize], values: &QuantityColumns, threads: usize, report: &mut InfluenceReport) -> Result<()> {
        let count = levels.len();
        let (sets, orders) = (self.sets()?, self.shapley_sets()?);
        let alone = (0..count).map(|factor| 1 << factor);
        let sets: Vec<u64> = sets.into_iter().chain(alone).collect::<BTreeSet<_>>().into_iter().collect();
        for (quantity, values) in report.quantities.iter_mut().zip(values) {
            let absent = values.iter().filter(|it| it.is_nan()).count() as u64;
            if absent > 0 {
                quantity.verdict = QuantityVerdict::Absent { absent, of: values.len() as u64 };
                continue;
            }
            let Some(tally) = GridTally::new(levels.to_vec(), values.iter().map(|it| Some(*it))) else {
                quantity.verdict = QuantityVerdict::Constant { value: values[0] };
                continue;
            };
            quantity.verdict = QuantityVerdict::Shares;
            (quantity.mean, quantity.sd) = (Some(tally.mean()), Some(libm::sqrt(tally.variance())));
            let explained = explained(&tally, &sets, threads);
            let share = |set: u64| explained[&set] / tally.variance();
            let shapley = orders.effects(share)?;
            for (factor, input) in quantity.inputs.iter_mut().enumerate() {
                input.first = Some(Estimate::exact(share(1 << factor)));
                // What rounding leaves below 0 is none.
                input.total = Some(Estimate::exact((1.0 - share(all_but(factor, count))).max(0.0)));
                input.shapley = Some(of_orders(shapley[factor], orders.orders()));
            }
        }
        Ok(())
    }

    /// Shapley effects over the combinations that hold.
    fn of_holding(
        &self,
        levels: &[usize],
        (values, holding): (&QuantityColumns, &[bool]),
        threads: usize,
        report: &mut InfluenceReport,
    ) -> Result<()> {
        let orders = self.shapley_sets()?;
        let sets = orders.needed();
        for (number, (quantity, values)) in report.quantities.iter_mut().zip(values).enumerate() {
            let held = values.iter().zip(holding).map(|(value, holds)| holds.then_some(*value));
            // Of what holds, whether it holds does not vary.
            if self.quantities[number].column.is_none() || held.clone().flatten().any(f64::is_nan) {
                continue;
            }
            let Some(tally) = GridTally::new(levels.to_vec(), held) else { continue };
            let explained = explained(&tally, &sets, threads);
            let effects = orders.effects(|set| explained[&set] / tally.variance())?;
            quantity.within = Some(WithinHolding { mean: tally.mean(), sd: libm::sqrt(tally.variance()) });
            for (input, effect) in quantity.inputs.iter_mut().zip(effects) {
                input.within = Some(of_orders(effect, orders.orders()));
            }
        }
        Ok(())
    }
}

/// The variance that each of these sets of factors explains. What all factors explain is all.
fn explained(tally: &GridTally, sets: &[u64], threads: usize) -> BTreeMap<u64, f64> {
    let share = sets.len().div_ceil(threads.max(1)).max(1);
    let parts = on_threads(sets.chunks(share), |sets| sets.iter().map(|&set| (set, tally.explained(set))).collect::<Vec<_>>());
    parts.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensitivity::all_of;

    #[test]
    fn all_factors_explain_all() {
        let values = (0..24).map(|it| Some(f64::from(it * it % 7)));
        let tally = GridTally::new(vec![2, 3, 4], values).expect("it varies");
        let found = explained(&tally, &[0, 5, all_of(3)], 2);
        assert!((found[&7] - tally.variance()).abs() < 1e-12 && found[&0].abs() < 1e-12 && found[&5] < found[&7]);
    }
}
