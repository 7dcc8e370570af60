//! Screening after Morris (1991), with the mean of absolute effects of Campolongo et al. (2007).

use crate::probability::{Distribution, Draws, ProbabilityProblem, Sampling};

/// Values that an input takes: 0, 1/3, 2/3 and 1 of its range; a step goes over two thirds.
const STEP: f64 = 2.0 / 3.0;

/// What a step of one input does to the quantity, per range of the input, in the unit of the quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Effects {
    /// The input.
    pub name: String,
    /// Mean effect.
    pub mean: f64,
    /// Mean of the absolute effects: near 0, the input does nothing.
    pub mean_absolute: f64,
    /// Standard deviation of the effects: 0 where the quantity is linear in this input and no other changes that.
    pub sd: f64,
}

/// Walks of one step in each input.
pub(crate) struct MorrisWalks {
    names: Vec<String>,
    walks: Vec<MorrisWalk>,
}

/// A walk: where each input starts and ends, from 0 to 1, and the order in which they step.
struct MorrisWalk {
    ends: Vec<(f64, f64)>,
    order: Vec<usize>,
}

impl MorrisWalks {
    /// `trajectories` walks of these inputs.
    ///
    /// # Errors
    /// There are less than 2, or a name stands there twice.
    pub(crate) fn new(names: &[&str], trajectories: u64, seed: u64) -> Result<Self, ProbabilityProblem> {
        if trajectories < 2 {
            return Err(ProbabilityProblem::Parameter {
                of: "morris",
                parameter: "trajectories",
                value: trajectories as f64,
                limit: "at least 2",
            });
        }
        let unit = Distribution::uniform(0.0, 1.0)?;
        let drawn: Vec<_> = ["start", "order"].iter().flat_map(|what| names.iter().map(move |name| format!("{name} {what}"))).collect();
        let chances: Vec<_> = drawn.iter().map(|name| (name.as_str(), unit.clone())).collect();
        let chances = Draws::new(&chances, trajectories, Sampling::Random, seed)?.columns(0..trajectories);
        let walk = |walk: usize| {
            // Four ways to go in each input: up from 0 or 1/3, down from 2/3 or 1.
            let ends =
                |input: usize| [(0.0, STEP), (1.0 - STEP, 1.0), (STEP, 0.0), (1.0, 1.0 - STEP)][(chances[input][walk] * 4.0) as usize];
            let mut order: Vec<_> = (0..names.len()).collect();
            order.sort_by(|&a, &b| chances[names.len() + a][walk].total_cmp(&chances[names.len() + b][walk]));
            MorrisWalk { ends: (0..names.len()).map(ends).collect(), order }
        };
        let walks = (0..chances.first().map_or(0, Vec::len)).map(walk).collect();
        Ok(Self { names: names.iter().map(|name| (*name).to_owned()).collect(), walks })
    }

    /// The points of all walks, one walk after the other: of each input its place in its range, from 0 to 1.
    pub(crate) fn points(&self) -> Vec<Vec<f64>> {
        let of_walk = |walk: &MorrisWalk| {
            let mut point: Vec<f64> = walk.ends.iter().map(|ends| ends.0).collect();
            let mut points = vec![point.clone()];
            for &input in &walk.order {
                point[input] = walk.ends[input].1;
                points.push(point.clone());
            }
            points
        };
        self.walks.iter().flat_map(of_walk).collect()
    }

    /// The effects, from the value of the quantity at each point. `place` tells where in its range an input really is, which has levels.
    ///
    /// # Errors
    /// The quantity has no value at a point.
    pub(crate) fn effects(&self, values: &[f64], place: impl Fn(usize, f64) -> f64) -> Result<Vec<Effects>, ProbabilityProblem> {
        let mut effects: Vec<Vec<f64>> = vec![Vec::new(); self.names.len()];
        for (number, (walk, values)) in self.walks.iter().zip(values.chunks(self.names.len() + 1)).enumerate() {
            for (&input, pair) in walk.order.iter().zip(values.windows(2)) {
                let (start, end) = walk.ends[input];
                let effect = (pair[1] - pair[0]) / (place(input, end) - place(input, start));
                if !effect.is_finite() {
                    return Err(ProbabilityProblem::Absent { draw: number as u64 });
                }
                effects[input].push(effect);
            }
        }
        let summary = |(effects, name): (Vec<f64>, &String)| {
            let count = effects.len() as f64;
            let mean = effects.iter().sum::<f64>() / count;
            let squares: f64 = effects.iter().map(|it| (it - mean) * (it - mean)).sum();
            let mean_absolute = effects.iter().map(|it| it.abs()).sum::<f64>() / count;
            Effects { name: name.clone(), mean, mean_absolute, sd: libm::sqrt(squares / (count - 1.0)) }
        };
        Ok(effects.into_iter().zip(&self.names).map(summary).collect())
    }
}

/// The effects of each input, named with its range, on `trajectories` walks of one step in each input. A walk takes one evaluation for
/// each input and one more.
///
/// # Errors
/// There are less than 2 trajectories, a name stands there twice, a range is none, or the quantity has no value in a step.
pub fn morris_screening(
    inputs: &[(&str, f64, f64)],
    trajectories: u64,
    seed: u64,
    quantity: impl Fn(&[f64]) -> f64,
) -> Result<Vec<Effects>, ProbabilityProblem> {
    let names: Vec<_> = inputs.iter().map(|it| it.0).collect();
    let walks = MorrisWalks::new(&names, trajectories, seed)?;
    for &(_, from, to) in inputs {
        Distribution::uniform(from, to)?;
    }
    let value = |point: Vec<f64>| {
        let inputs: Vec<f64> = inputs.iter().zip(point).map(|(&(_, from, to), place)| from + place * (to - from)).collect();
        quantity(&inputs)
    };
    let values: Vec<f64> = walks.points().into_iter().map(value).collect();
    walks.effects(&values, |_, place| place)
}
