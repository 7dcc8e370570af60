//! The answer of a study by brute force: every design in every scenario, all pairs compared, nothing shared with the sweep but
//! `models::evaluate`, the axis values and the resolved study.

use beltspace::models::{Evaluation, Status, Worse, evaluate};
use beltspace::space::Space;
use beltspace::study::{Axis, Best, Constraint, Goal, OverScenarios, Quantity, Study};

/// A design in a scenario.
pub struct Case {
    pub inputs: Vec<f64>,
    pub evaluation: Evaluation,
}

/// Every design in every scenario.
pub struct Evaluated {
    pub designs: u64,
    pub scenarios: u64,
    /// The weights of a spectrum, and the distance of two of its cases among the scenarios.
    spectrum: Option<(Vec<f64>, usize)>,
    cases: Vec<Case>,
}

/// Sets the inputs of one combination of axes; the last axis varies fastest.
fn set(axes: &[&Axis], mut index: u64, inputs: &mut [f64]) {
    for axis in axes.iter().rev() {
        let level = index % axis.count();
        index /= axis.count();
        for (column, &input) in axis.inputs().iter().enumerate() {
            inputs[input] = axis.value(column, level);
        }
    }
}

fn combinations(axes: &[&Axis]) -> u64 {
    axes.iter().map(|axis| axis.count()).product()
}

impl Evaluated {
    pub fn new(study: &Study) -> Self {
        let designs = study.sample.map_or_else(|| combinations(&study.design.iter().collect::<Vec<_>>()), |sample| sample.count);
        Self::of(study, 0..designs)
    }

    /// Some designs, which are numbered anew.
    pub fn of(study: &Study, chosen: impl IntoIterator<Item = u64>) -> Self {
        Self::by(study, chosen, &|inputs| evaluate(&study.model, inputs))
    }

    /// The same by another evaluation, which is given the values of all inputs.
    pub fn by(study: &Study, chosen: impl IntoIterator<Item = u64>, evaluate: &dyn Fn(&[f64]) -> Evaluation) -> Self {
        let design: Vec<&Axis> = study.design.iter().collect();
        let scenario: Vec<&Axis> = study.operation.iter().chain(&study.uncertainty).collect();
        // The sampler has tests of its own: its designs are taken as they come.
        let space = Space::new(study);
        let scenarios = combinations(&scenario);
        let (mut cases, mut designs) = (Vec::new(), 0);
        for index in chosen {
            designs += 1;
            let mut inputs = study.fixed.clone();
            if study.sample.is_some() {
                let sampled = space.inputs(index, 0);
                design.iter().flat_map(|axis| axis.inputs()).for_each(|&input| inputs[input] = sampled[input]);
            } else {
                set(&design, index, &mut inputs);
            }
            for number in 0..scenarios {
                set(&scenario, number, &mut inputs);
                cases.push(Case { evaluation: evaluate(&inputs), inputs: inputs.clone() });
            }
        }
        let spectrum = study.spectrum.as_ref().map(|spectrum| {
            let inner: u64 = scenario[spectrum.axis + 1..].iter().map(|axis| axis.count()).product();
            (spectrum.weights.clone(), inner as usize)
        });
        Self { designs, scenarios, spectrum, cases }
    }

    /// The weight of a scenario, if the study has weights.
    pub fn weight(&self, scenario: usize) -> Option<f64> {
        self.spectrum.as_ref().map(|(weights, stride)| weights[scenario / stride % weights.len()])
    }

    /// The scenarios whose cases add up, each group by the numbers of its cases; without a sum every scenario is its own.
    pub fn groups(&self, over: OverScenarios) -> Vec<Vec<usize>> {
        let scenarios = 0..self.scenarios as usize;
        match &self.spectrum {
            Some((weights, stride)) if over != OverScenarios::Worst => {
                let first = scenarios.filter(|scenario| (scenario / stride) % weights.len() == 0);
                first.map(|first| (0..weights.len()).map(|case| first + case * stride).collect()).collect()
            }
            _ => scenarios.map(|scenario| vec![scenario]).collect(),
        }
    }

    /// What a quantity comes to in a group of scenarios: its value, or the mean or sum; `None` if it has no meaning in one of them.
    pub fn value_over(&self, design: u64, group: &[usize], quantity: Quantity, over: OverScenarios) -> Option<f64> {
        let cases = self.cases(design);
        if over == OverScenarios::Worst {
            return cases[group[0]].value(quantity);
        }
        let (weights, _) = self.spectrum.as_ref().expect("a mean or sum has weights");
        let (mut sum, mut total) = (0.0, 0.0);
        for (&scenario, weight) in group.iter().zip(weights) {
            sum += weight * cases[scenario].value(quantity)?;
            total += weight;
        }
        let result: f64 = if over == OverScenarios::Mean { sum / total } else { sum };
        result.is_finite().then_some(result)
    }

    /// The worst mean or sum of a quantity that has one in every scenario of the other axes.
    pub fn worst_over(&self, design: u64, quantity: Quantity, over: OverScenarios, worse: Worse) -> f64 {
        let values = self.groups(over).into_iter();
        let mut values: Vec<f64> =
            values.map(|group| self.value_over(design, &group, quantity, over).expect("it has a meaning in every scenario")).collect();
        values.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        (if worse == Worse::Higher { values[values.len() - 1] } else { values[0] }) + 0.0
    }

    /// The scenarios of a design.
    pub fn cases(&self, design: u64) -> &[Case] {
        let scenarios = self.scenarios as usize;
        &self.cases[design as usize * scenarios..][..scenarios]
    }

    /// Worst values, in order, of the designs in which the quantity has a meaning everywhere; `None` if there are none.
    pub fn sorted_worst_values(&self, study: &Study, quantity: Quantity, worse: Worse) -> Option<Vec<f64>> {
        self.sorted_values_over(study, quantity, OverScenarios::Worst, worse)
    }

    /// The same of a mean or sum.
    pub fn sorted_values_over(&self, study: &Study, quantity: Quantity, over: OverScenarios, worse: Worse) -> Option<Vec<f64>> {
        let ok = |design: &u64| {
            let fine = |case: &Case| case.evaluation.status == Status::Ok && case.value(quantity).is_some();
            self.cases(*design).iter().all(fine)
        };
        let mut values: Vec<f64> = (0..self.designs).filter(ok).map(|design| self.worst_over(design, quantity, over, worse)).collect();
        debug_assert_eq!(study.fixed.len(), self.cases[0].inputs.len());
        values.sort_by(f64::total_cmp);
        (!values.is_empty()).then_some(values)
    }

    /// The worst value of a quantity that has a meaning in every scenario.
    pub fn worst(&self, design: u64, quantity: Quantity, worse: Worse) -> f64 {
        let values = self.cases(design).iter().map(|case| case.value(quantity).expect("it has a meaning in every scenario"));
        let worst = match worse {
            Worse::Higher => values.fold(f64::NEG_INFINITY, |worst, value| if value > worst { value } else { worst }),
            Worse::Lower => values.fold(f64::INFINITY, |worst, value| if value < worst { value } else { worst }),
        };
        worst + 0.0
    }
}

impl Case {
    pub fn value(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::Input(input) => Some(self.inputs[input]),
            Quantity::Output(output) => self.evaluation.outputs[output],
        }
    }
}

/// Does a bound hold?
pub fn satisfied(constraint: &Constraint, value: f64) -> bool {
    let low = match constraint.low {
        Some((bound, true)) => value > bound,
        Some((bound, false)) => value >= bound,
        None => true,
    };
    let high = match constraint.high {
        Some((bound, true)) => value < bound,
        Some((bound, false)) => value <= bound,
        None => true,
    };
    low && high
}

/// The worst end of a quantity: that of its objective, else that of the model.
pub fn worst_end(study: &Study, quantity: Quantity) -> Worse {
    worst_end_over(study, quantity, OverScenarios::Worst)
}

/// The same of a mean or sum: an objective of the same kind goes before another of the quantity.
pub fn worst_end_over(study: &Study, quantity: Quantity, over: OverScenarios) -> Worse {
    for same in [true, false] {
        for objective in study.objectives.iter().filter(|it| (it.over == over) == same) {
            if objective.quantity == quantity {
                return if objective.goal == Goal::Min { Worse::Higher } else { Worse::Lower };
            }
        }
    }
    match quantity {
        Quantity::Input(_) => Worse::Higher,
        Quantity::Output(output) => study.model.outputs[output].worse,
    }
}

/// Everything whose value decides what is reported: without a meaning in some scenario the design is out.
pub fn needed(study: &Study) -> Vec<Quantity> {
    let report = &study.report;
    let maps = report.maps.iter().filter_map(|map| match map.value {
        Best::Value(quantity, _) => Some(quantity),
        Best::Share => None,
    });
    let objectives = study.objectives.iter().map(|it| it.quantity);
    let constraints = study.constraints.iter().map(|it| it.quantity);
    let top = report.top.iter().map(|it| it.by);
    objectives.chain(constraints).chain(top).chain(report.histograms.iter().map(|it| it.of)).chain(maps).collect()
}

/// Why a design is out, over all its scenarios.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Failures {
    /// The conditions that were the status of some scenario.
    pub statuses: Vec<usize>,
    /// Something that is needed has no meaning in some scenario, though its status is ok.
    pub meaningless: bool,
    /// Constraints violated in some scenario in which everything needed has a meaning.
    pub constraints: Vec<usize>,
}

impl Failures {
    pub fn of(study: &Study, evaluated: &Evaluated, design: u64) -> Self {
        let needed = needed(study);
        let mut failures = Self::default();
        let mut note = |list: fn(&mut Self) -> &mut Vec<usize>, number| {
            let list = list(&mut failures);
            if !list.contains(&number) {
                list.push(number);
            }
        };
        let mut meaningless = false;
        for case in evaluated.cases(design) {
            if let Some(number) = case.evaluation.status.condition() {
                note(|failures| &mut failures.statuses, number);
            } else if needed.iter().any(|&quantity| case.value(quantity).is_none()) {
                meaningless = true;
            } else {
                for (number, constraint) in study.constraints.iter().enumerate().filter(|(_, it)| it.over == OverScenarios::Worst) {
                    if !case.value(constraint.quantity).is_some_and(|value| satisfied(constraint, value)) {
                        note(|failures| &mut failures.constraints, number);
                    }
                }
            }
        }
        let objectives = study.objectives.iter().map(|it| (it.quantity, it.over, None));
        let constraints = study.constraints.iter().enumerate().map(|(number, it)| (it.quantity, it.over, Some((number, it))));
        for (quantity, over, constraint) in objectives.chain(constraints).filter(|(_, over, _)| *over != OverScenarios::Worst) {
            for group in evaluated.groups(over) {
                // As in a single scenario: only where everything that is needed has a meaning.
                let is_ok = |&scenario: &usize| {
                    let case = &evaluated.cases(design)[scenario];
                    case.evaluation.status == Status::Ok && needed.iter().all(|&quantity| case.value(quantity).is_some())
                };
                if !group.iter().all(is_ok) {
                    continue;
                }
                match (evaluated.value_over(design, &group, quantity, over), constraint) {
                    (None, _) => meaningless = true,
                    (Some(value), Some((number, constraint))) if !satisfied(constraint, value) => {
                        note(|failures| &mut failures.constraints, number)
                    }
                    _ => {}
                }
            }
        }
        failures.meaningless = meaningless;
        failures
    }

    pub fn none(&self) -> bool {
        *self == Self::default()
    }
}

/// What dominance compares: less is better.
pub fn key(study: &Study, evaluated: &Evaluated, design: u64) -> Vec<f64> {
    let coordinate = |objective: &beltspace::study::Objective| {
        let worse = if objective.goal == Goal::Min { Worse::Higher } else { Worse::Lower };
        let value = evaluated.worst_over(design, objective.quantity, objective.over, worse);
        let value = objective.resolution.map_or(value, |resolution| (value / resolution).floor());
        if objective.goal == Goal::Min { value } else { -value }
    };
    study.objectives.iter().map(coordinate).collect()
}

/// The front by comparing all pairs: positions among `keys`, which are in the order of the design index.
pub fn front(keys: &[Vec<f64>]) -> Vec<usize> {
    let no_worse = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a <= b);
    let dominated = |this: usize| {
        keys.iter()
            .enumerate()
            .any(|(other, key)| other != this && no_worse(key, &keys[this]) && (!no_worse(&keys[this], key) || other < this))
    };
    (0..keys.len()).filter(|&this| !dominated(this)).collect()
}
