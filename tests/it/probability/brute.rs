//! Every draw in every operating case by brute force: nothing shared with the product but the draws themselves, `models::evaluate`, the
//! values of axes and the resolved study.

use crate::pipeline::naive::satisfied;
use beltspace::models::{Evaluation, Model, Status, Worse, evaluate};
use beltspace::probability::{Effect, clopper_pearson, simultaneous};
use beltspace::study::{
    AskedQuantity, Axis, ConfirmedEnd, Constraint, OverDraws, OverScenarios, Probability, Quantity, StatisticKind, Study,
};

/// An operating case: the inputs that it sets, and of a spectrum the number of its sum and its weight.
type Case = (Vec<(usize, f64)>, Option<(Vec<u64>, f64)>);

/// The operating cases of a study and its draws, as plain lists.
pub struct Brute<'s> {
    probability: &'s Probability,
    cases: Vec<Case>,
    choosing: Vec<Vec<f64>>,
    confirming: Vec<Vec<f64>>,
}

/// A draw in a case: its inputs and what the model says of them, unless a drawn value is none that its input may have.
pub struct DrawnCase {
    inputs: Vec<f64>,
    evaluation: Option<Evaluation>,
}

impl DrawnCase {
    /// The value of a quantity in its unit.
    pub fn value(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::Input(input) => self.evaluation.as_ref().map(|_| self.inputs[input]),
            Quantity::Output(output) => self.evaluation.as_ref()?.outputs[output],
        }
    }

    /// Why it has no result, in words; `None` if it has one.
    pub fn reason(&self, model: &Model) -> Option<String> {
        match &self.evaluation {
            None => Some("a drawn value that its input cannot have".to_owned()),
            Some(it) => matches!(it.status, Status::Failed(_)).then(|| it.status.reason(model).to_owned()),
        }
    }

    /// Has the drive a result?
    fn is_ok(&self) -> bool {
        // What is too large for a number is absent: that matters where it is asked for.
        self.evaluation.as_ref().is_some_and(|it| !matches!(it.status, Status::Failed(_)))
    }
}

/// The worse of many values.
fn worst(values: impl IntoIterator<Item = f64>, worse: Worse) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    if worse == Worse::Higher { values[values.len() - 1] } else { values[0] }
}

fn cases(operation: &[Axis], weighted: Option<(usize, &[f64])>) -> Vec<Case> {
    let mut levels: Vec<Vec<u64>> = vec![Vec::new()];
    for axis in operation {
        levels = levels.iter().flat_map(|start| (0..axis.count()).map(|level| [&start[..], &[level]].concat())).collect();
    }
    let case = |levels: Vec<u64>| {
        let of_axis = |(axis, &level): (&Axis, &u64)| -> Vec<(usize, f64)> {
            axis.inputs().iter().enumerate().map(|(column, &input)| (input, axis.value(column, level))).collect()
        };
        let inputs = operation.iter().zip(&levels).flat_map(of_axis).collect();
        let weight = weighted.map(|(axis, weights)| {
            let others = levels.iter().enumerate().filter(|(it, _)| *it != axis).map(|it| *it.1).collect();
            (others, weights[levels[axis] as usize])
        });
        (inputs, weight)
    };
    levels.into_iter().map(case).collect()
}

impl<'s> Brute<'s> {
    pub fn new(study: &'s Study) -> Self {
        let probability = study.probability.as_deref().expect("inputs have distributions");
        let drive = &probability.drive;
        let weighted = drive.spectrum.as_ref().map(|it| (it.axis, &it.weights[..]));
        let choosing = probability.choosing().expect("they can be drawn");
        let confirming = probability.confirming().expect("they can be drawn");
        assert_eq!((choosing.count(), confirming.count()), (probability.draws, probability.confirm));
        Self {
            probability,
            cases: cases(&drive.operation, weighted),
            choosing: choosing.columns(0..probability.draws),
            confirming: confirming.columns(0..probability.confirm),
        }
    }

    /// The drive that is drawn.
    pub fn model(&self) -> &Model {
        &self.probability.drive.model
    }

    /// Number of operating cases.
    pub fn case_count(&self) -> usize {
        self.cases.len()
    }

    /// Draws that choose.
    pub fn draws(&self) -> usize {
        self.choosing.first().map_or(0, Vec::len)
    }

    /// A draw that chooses in all cases, of a design with these inputs.
    pub fn drawn(&self, design: &[f64], draw: usize) -> Vec<DrawnCase> {
        self.in_cases(design, &self.choosing, draw)
    }

    fn in_cases(&self, design: &[f64], columns: &[Vec<f64>], draw: usize) -> Vec<DrawnCase> {
        let model = self.model();
        let mut found = Vec::new();
        for (set, _) in &self.cases {
            let mut inputs = design.to_vec();
            set.iter().for_each(|&(input, value)| inputs[input] = value);
            let mut fits = true;
            for (uncertain, column) in self.probability.inputs.iter().zip(columns) {
                let value = &mut inputs[uncertain.input];
                *value = match uncertain.acts() {
                    Effect::Is => column[draw],
                    Effect::Times => *value * column[draw],
                    Effect::Plus => *value + column[draw],
                };
                let valid = &model.inputs[uncertain.input].valid;
                fits &= if valid.includes_low { *value >= valid.low } else { *value > valid.low };
                fits &= if valid.includes_high { *value <= valid.high } else { *value < valid.high };
            }
            found.push(DrawnCase { evaluation: fits.then(|| evaluate(model, &inputs)), inputs });
        }
        found
    }

    /// What a quantity comes to over the cases of a draw.
    fn over_cases(&self, quantity: Quantity, over: OverScenarios, worse: Worse, cases: &[DrawnCase]) -> Option<f64> {
        let values: Vec<f64> = cases.iter().map(|it| it.value(quantity)).collect::<Option<_>>()?;
        if over == OverScenarios::Worst {
            return Some(worst(values, worse));
        }
        let of_spectrum: Vec<&(Vec<u64>, f64)> = self.cases.iter().map(|it| it.1.as_ref().expect("there are weights")).collect();
        let mut results = Vec::new();
        for &(others, _) in &of_spectrum {
            let (mut sum, mut total) = (0.0, 0.0);
            for (value, (_, weight)) in values.iter().zip(&of_spectrum).filter(|(_, it)| it.0 == *others) {
                sum += weight * value;
                total += weight;
            }
            results.push(if over == OverScenarios::Mean { sum / total } else { sum });
        }
        results.iter().all(|it| it.is_finite()).then(|| worst(results, worse))
    }

    pub fn keeps(&self, constraint: &Constraint, cases: &[DrawnCase]) -> bool {
        if constraint.over == OverScenarios::Worst {
            return cases.iter().all(|it| it.value(constraint.quantity).is_some_and(|value| satisfied(constraint, value)));
        }
        [Worse::Lower, Worse::Higher].into_iter().all(|worse| {
            self.over_cases(constraint.quantity, constraint.over, worse, cases).is_some_and(|value| satisfied(constraint, value))
        })
    }

    pub fn holds(&self, cases: &[DrawnCase]) -> bool {
        cases.iter().all(DrawnCase::is_ok) && self.probability.drive.constraints.iter().all(|it| self.keeps(it, cases))
    }

    fn over_draws(&self, asked: &AskedQuantity, over: OverDraws, draws: &[Vec<DrawnCase>]) -> Option<f64> {
        let values: Vec<Option<f64>> = draws.iter().map(|it| self.over_cases(asked.quantity, asked.over, asked.worse, it)).collect();
        if let OverDraws::Quantile(share) = over {
            return quantile(&values, share, asked.worse);
        }
        let values: Vec<f64> = values.into_iter().collect::<Option<_>>()?;
        let count = values.len() as f64;
        let mut sum = 0.0;
        values.iter().for_each(|value| sum += value);
        let mean = sum / count;
        match over {
            OverDraws::Mean => Some(mean),
            OverDraws::Worst => Some(worst(values, asked.worse)),
            _ => {
                let mut squares = 0.0;
                values.iter().for_each(|value| squares += (value - mean) * (value - mean));
                Some((squares / count).sqrt())
            }
        }
    }

    /// What the study's outputs are for a design at a level, given the values of all inputs.
    pub fn evaluation(&self, design: &[f64]) -> Evaluation {
        let draws: Vec<Vec<DrawnCase>> = (0..self.draws()).map(|draw| self.drawn(design, draw)).collect();
        let share = |count: usize, of: usize| Some(count as f64 / of as f64);
        let fresh = self.confirming.first().map_or(0, Vec::len);
        let told = |end: ConfirmedEnd, holding: u64| match end {
            ConfirmedEnd::Share => holding as f64 / fresh as f64,
            ConfirmedEnd::Low => clopper_pearson(holding, fresh as u64, 0.95).expect("these are counts").low,
            // Which level is the worst is not known either.
            ConfirmedEnd::High => simultaneous(holding, fresh as u64, 0.95, self.probability.levels).expect("these are counts").high,
            ConfirmedEnd::AtLeast | ConfirmedEnd::AtMost => unreachable!("nothing is proven in these studies"),
            ConfirmedEnd::StandardError => unreachable!("it is of the draws that choose"),
        };
        let holding = (0..fresh).filter(|&draw| self.holds(&self.in_cases(design, &self.confirming, draw))).count() as u64;
        let result = |kind: &StatisticKind| match kind {
            StatisticKind::Yield => share(draws.iter().filter(|it| self.holds(it)).count(), draws.len()),
            StatisticKind::YieldOf(constraint) => share(draws.iter().filter(|it| self.keeps(constraint, it)).count(), draws.len()),
            StatisticKind::Confirmed(ConfirmedEnd::StandardError) => {
                // Sixteen sets one behind the other.
                let sets =
                    draws.chunks(draws.len() / 16).map(|set| set.iter().filter(|it| self.holds(it)).count() as f64 / set.len() as f64);
                let shares: Vec<f64> = sets.collect();
                let mean = shares.iter().sum::<f64>() / 16.0;
                let squares: f64 = shares.iter().map(|it| (it - mean) * (it - mean)).sum();
                (shares.iter().any(|it| *it != shares[0])).then(|| (squares / 15.0 / 16.0).sqrt())
            }
            StatisticKind::Confirmed(end) => Some(told(*end, holding)),
            StatisticKind::Over(asked, over) => self.over_draws(asked, *over, &draws),
            StatisticKind::Plain(asked) => {
                let present: Vec<f64> =
                    draws.iter().filter_map(|it| self.over_cases(asked.quantity, asked.over, asked.worse, it)).collect();
                (!present.is_empty()).then(|| worst(present, asked.worse))
            }
        };
        Evaluation { status: Status::Ok, outputs: self.probability.statistics.iter().map(|it| result(&it.kind)).collect() }
    }
}

/// The ceil(q n)-th best of n values; one that is absent is worse than any.
fn quantile(values: &[Option<f64>], share: f64, worse: Worse) -> Option<f64> {
    let mut present: Vec<f64> = values.iter().flatten().copied().collect();
    present.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    if worse == Worse::Lower {
        present.reverse();
    }
    // In whole numbers: the shares of these tests have at most three decimals.
    let thousandths = (share * 1000.0).round() as usize;
    present.get((thousandths * values.len()).div_ceil(1000).max(1) - 1).copied()
}
