//! What a first stage passed on, kept for the next design: memory that whoever evaluates owns, so that a formula needs none.

use super::evaluation::{evaluated, to_si};
use super::formula::Kernel;
use super::model::Model;
use super::status::Evaluation;
use crate::tape::Set;
use std::sync::Arc;

/// What decides what a first stage passes on.
#[derive(Clone, Debug)]
struct Key {
    /// Inputs that it reads.
    reads: Set,
    inputs: Vec<f64>,
    wanted: Set,
}

impl Key {
    /// Is what this one gave also what these inputs give?
    fn serves(&self, inputs: &[f64], wanted: Set) -> bool {
        let same = |input: usize| self.inputs[input].to_bits() == inputs[input].to_bits();
        self.wanted == wanted && (0..inputs.len()).all(|input| !self.reads.contains(input) || same(input))
    }
}

/// The first stage of one design after the other. A design that has the same values of all that the one before
/// [read](Kernel::prepared_reads) is not prepared again.
#[derive(Clone)]
pub struct Latest {
    kernel: Arc<dyn Kernel>,
    key: Option<Key>,
    prepared: Vec<f64>,
}

impl Latest {
    /// For designs of a model; it holds nothing yet.
    pub fn new(model: &Model) -> Self {
        Self { kernel: model.kernel.clone(), key: None, prepared: Vec::new() }
    }

    /// As [`Kernel::prepare`], to the same bits: inputs in SI units, and room for [`Kernel::prepared_len`] numbers. Those beyond
    /// [`Kernel::prepared_used`] are left as they are where nothing had to be prepared.
    pub fn prepare(&mut self, inputs: &[f64], wanted: Set, prepared: &mut [f64]) {
        if self.key.as_ref().is_some_and(|key| key.serves(inputs, wanted)) {
            prepared[..self.prepared.len()].copy_from_slice(&self.prepared);
            return;
        }
        self.kernel.prepare(inputs, wanted, prepared);
        let reads = self.kernel.prepared_reads(inputs);
        if reads != Set::ALL {
            self.prepared.clear();
            self.prepared.extend(&prepared[..self.kernel.prepared_used(prepared)]);
            self.key = Some(Key { reads, inputs: inputs.to_vec(), wanted });
        }
    }
}

impl std::fmt::Debug for Latest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Latest").field("key", &self.key).finish_non_exhaustive()
    }
}

/// Evaluates designs of a model one after the other, each as [`evaluate`](super::evaluate) does; what the one before prepared serves
/// those that have the slow inputs in common with it.
#[derive(Clone, Debug)]
pub struct Evaluator {
    model: Arc<Model>,
    latest: Latest,
    prepared: Vec<f64>,
}

impl Evaluator {
    /// For designs of this model.
    pub fn new(model: &Arc<Model>) -> Self {
        Self { latest: Latest::new(model), prepared: vec![0.0; model.kernel.prepared_len()], model: model.clone() }
    }

    /// Evaluates a design in f64: one value per input of the model, in its unit. An overflow of an output that is not among those
    /// `asked` for leaves the status as it is.
    pub fn evaluate(&mut self, inputs: &[f64], asked: Set) -> Evaluation {
        let si = to_si(&self.model, inputs);
        self.latest.prepare(&si, Set::ALL, &mut self.prepared);
        evaluated(&self.model, &si, &self.prepared, asked)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::tests::watched;
    use crate::models::{evaluate, find};
    use std::sync::atomic::Ordering;
    use std::time::Duration;

    #[test]
    fn a_design_on_the_same_section_is_not_prepared_again_and_any_other_is() {
        let model = find("pulley").expect("it is a model");
        let mut evaluator = Evaluator::new(&model);
        let mut inputs = model.defaults();
        let set = |inputs: &mut Vec<f64>, name: &str, value: f64| inputs[model.input(name).expect("it is an input")] = value;
        // A load, an input that the type does not read, one that it reads, and back.
        for (name, value) in [("power_kW", 2.0), ("weld_diameter_mm", 70.0), ("thickness_mm", 1.9), ("thickness_mm", 1.8)] {
            let before = evaluator.latest.key.as_ref().map(|key| key.inputs.clone());
            set(&mut inputs, name, value);
            assert_eq!(evaluator.evaluate(&inputs, Set::ALL), evaluate(&model, &inputs), "{name} = {value}");
            let kept = evaluator.latest.key.as_ref().map(|key| key.inputs.clone()) == before;
            assert_eq!(kept, name == "weld_diameter_mm", "{name} = {value}");
        }
    }

    #[test]
    fn what_is_quickly_prepared_is_not_kept() {
        let (model, kernel) = watched(Duration::ZERO, 0);
        let mut evaluator = Evaluator::new(&model);
        for _ in 0..3 {
            assert_eq!(evaluator.evaluate(&model.defaults(), Set::ALL), evaluate(&model, &model.defaults()));
        }
        assert_eq!(kernel.prepared.load(Ordering::Relaxed), 6);
        assert!(evaluator.latest.prepared.is_empty());
    }
}
