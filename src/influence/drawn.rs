//! Shares estimated from draws, and screening by walks.

use super::evaluated::QuantityColumns;
use super::results::{Estimate, InfluenceMethod, InfluenceReport, QuantityVerdict, of_replicates};
use super::subject::{InfluenceSubject, WALKS};
use crate::error::Result;
use crate::probability::{Distribution, PairedDraws, ProbabilityProblem};
use crate::screen::Control;
use crate::sensitivity::{MorrisWalks, PairedValues, ShapleySets, all_but, all_of};
use std::collections::{BTreeMap, BTreeSet};

/// What is found of a quantity while its sets of draws are looked at.
struct Gathered {
    /// Values where all factors are of the first set, and where none is.
    both: Option<PairedValues>,
    /// Of sets of factors: the share of the variance that is left if they are known, in each replicate.
    left: BTreeMap<u64, Vec<f64>>,
    /// Of each factor, by the number of the set that it needs.
    first: BTreeMap<u64, Estimate>,
    absent: u64,
}

impl InfluenceSubject {
    /// Estimates the shares from draws.
    pub(super) fn by_draws(&self, threads: usize, control: &Control, report: &mut InfluenceReport) -> Result<()> {
        let laws =
            self.factors.iter().map(|it| Ok((it.name.as_str(), it.distribution()?))).collect::<Result<Vec<(&str, Distribution)>>>()?;
        let draws = PairedDraws::new(&laws, &self.correlation, self.draws, self.seed)?;
        let (sets, orders, count) = (self.sets()?, self.shapley_sets()?, self.factors.len());
        let at = |kept: u64| -> Result<QuantityColumns> { self.at_drawn(&draws.columns(kept)?, threads, control) };
        let missing = |values: &[f64]| values.iter().filter(|it| it.is_nan()).count() as u64;
        let mut gathered = Vec::new();
        for ((first, second), quantity) in at(all_of(count))?.into_iter().zip(at(0)?).zip(&mut report.quantities) {
            let absent = missing(&first) + missing(&second);
            let value = first[0];
            let both = match PairedValues::new(first, second) {
                Ok(both) => Some(both),
                Err(ProbabilityProblem::Constant) => {
                    quantity.verdict = QuantityVerdict::Constant { value };
                    None
                }
                Err(ProbabilityProblem::Absent { .. }) => None,
                Err(other) => return Err(other.into()),
            };
            let left = both.iter().flat_map(|both| [(0, both.all_left()), (all_of(count), vec![0.0; both.all_left().len()])]).collect();
            gathered.push(Gathered { both, left, first: BTreeMap::new(), absent });
        }
        let alone: BTreeSet<u64> = (0..count).map(|factor| all_but(factor, count)).collect();
        for &set in sets.iter().filter(|set| **set != 0 && **set != all_of(count)) {
            for (values, gathered) in at(set)?.iter().zip(&mut gathered) {
                gathered.absent += missing(values);
                let Some(both) = gathered.both.as_ref().filter(|_| gathered.absent == 0) else { continue };
                gathered.left.insert(set, both.left(values));
                if alone.contains(&set) && !self.is_correlated() {
                    gathered.first.insert(set, Estimate::of_replicated(both.first_order(values)?));
                }
            }
        }
        let all = sets.len() as u64 * draws.rows() as u64;
        report.method =
            InfluenceMethod::Draws { draws: self.draws, sets: sets.len() as u64, seed: self.seed, correlated: self.is_correlated() };
        for (gathered, quantity) in gathered.into_iter().zip(&mut report.quantities) {
            if gathered.absent > 0 {
                quantity.verdict = QuantityVerdict::Absent { absent: gathered.absent, of: all };
                continue;
            }
            let Some(both) = &gathered.both else { continue };
            quantity.verdict = QuantityVerdict::Shares;
            (quantity.mean, quantity.sd) = (Some(both.mean()), Some(libm::sqrt(both.variance())));
            let shapley = shapley(&gathered.left, &orders)?;
            for (factor, (input, shapley)) in quantity.inputs.iter_mut().zip(shapley).enumerate() {
                let set = all_but(factor, count);
                input.shapley = Some(shapley);
                if !self.is_correlated() {
                    input.first = gathered.first.get(&set).copied();
                    input.total = gathered.left.get(&set).map(|left| of_replicates(left)).transpose()?;
                }
            }
        }
        Ok(())
    }

    /// Screens the factors by walks.
    pub(super) fn by_walks(&self, threads: usize, control: &Control, report: &mut InfluenceReport) -> Result<()> {
        let names: Vec<&str> = self.factors.iter().map(|it| it.name.as_str()).collect();
        let walks = MorrisWalks::new(&names, WALKS, self.seed)?;
        let points = walks.points();
        let column = |factor: usize| -> Result<Vec<f64>> {
            points.iter().map(|point| Ok(self.factors[factor].at(point[factor])?.drawn)).collect::<Result<Vec<f64>>>()
        };
        let columns = (0..self.factors.len()).map(column).collect::<Result<Vec<_>>>()?;
        let values = self.at_drawn(&columns, threads, control)?;
        for (quantity, values) in report.quantities.iter_mut().zip(values) {
            let place = |factor: usize, place: f64| self.factors[factor].at(place).map_or(f64::NAN, |it| it.place);
            // Without a value on some walk there is no effect to tell.
            let Ok(effects) = walks.effects(&values, place) else { continue };
            quantity.inputs.iter_mut().zip(effects).for_each(|(input, effects)| input.screening = Some(effects));
        }
        report.walks = Some(WALKS);
        Ok(())
    }
}

/// Shapley effects as shares, from what is left of the variance in each replicate.
fn shapley(left: &BTreeMap<u64, Vec<f64>>, orders: &ShapleySets) -> Result<Vec<Estimate>> {
    let mean = |values: &Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    // What all factors explain together is what is left without any of them: with that as the whole, the shares add up to 1.
    let whole = mean(&left[&0]);
    let over_orders = orders.effects(|set| -mean(&left[&set]) / whole)?;
    let replicates = left[&0].len();
    let mut of_replicate: Vec<Vec<f64>> = vec![Vec::new(); over_orders.len()];
    (0..replicates).try_for_each(|replicate| -> Result<()> {
        let effects = orders.effects(|set| -left[&set][replicate] / whole)?;
        of_replicate.iter_mut().zip(effects).for_each(|(all, effect)| all.push(effect.0));
        Ok(())
    })?;
    let estimate = |(values, (_, error)): (Vec<f64>, (f64, f64))| Ok(of_replicates(&values)?.with_orders(error, orders.orders()));
    of_replicate.into_iter().zip(over_orders).map(estimate).collect()
}
