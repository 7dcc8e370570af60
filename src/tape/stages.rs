//! A model's formula recorded: as a whole, and as the two stages that a sweep runs it in.

use super::{Known, List, Loops, Node, Operation, Recording, Set, Trace};
use crate::real::Real;

/// The names of a formula's values, in the order of its arrays.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Fields {
    /// Of the inputs.
    pub inputs: &'static [&'static str],
    /// Of the single numbers that the first stage passes on.
    pub prepared: &'static [&'static str],
    /// Of the tables that it passes on after them, with their lengths.
    pub tables: &'static [(&'static str, usize)],
    /// Most loop iterations that the shader's second stage and conditions take together, for drivers that end long loops.
    pub iterations: u64,
    /// How many conditions it has; there may be more than the model lists.
    pub conditions: usize,
    /// Of the outputs; there may be more than the model lists.
    pub outputs: &'static [&'static str],
}

impl Fields {
    /// Of a formula without tables.
    pub const fn new(
        inputs: &'static [&'static str],
        prepared: &'static [&'static str],
        outputs: &'static [&'static str],
        conditions: usize,
    ) -> Self {
        Self { inputs, prepared, tables: &[], iterations: 0, conditions, outputs }
    }

    /// How many numbers the first stage passes on.
    pub fn prepared_len(&self) -> usize {
        self.tables.iter().fold(self.prepared.len(), |sum, (_, length)| sum + length)
    }

    /// Of each field that the first stage passes on, tables after single numbers: where it starts and how long it is.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        let lengths = self.prepared.iter().map(|_| 1).chain(self.tables.iter().map(|(_, length)| *length));
        lengths.scan(0, |next, length| {
            *next += length;
            Some((*next - length, length))
        })
    }
}

/// A formula that can be recorded as a list of operations: its stages over names of numbers, and what is made of them.
pub trait Recordable: Send + Sync {
    /// The names of the formula's values.
    fn fields(&self) -> Fields;
    /// First stage, as in a sweep.
    fn trace_prepare(&self, inputs: &[Trace], wanted: Set, prepared: &mut [Trace]);
    /// Margins of the conditions, as in a sweep.
    fn trace_conditions(&self, prepared: &[Trace], inputs: &[Trace], wanted: Set, margins: &mut [Trace]);
    /// Second stage, as in a sweep.
    fn trace_finish(&self, prepared: &[Trace], inputs: &[Trace], wanted: Set, outputs: &mut [Trace]);

    /// The whole formula, given what is known of its inputs, for the outputs and conditions of these sets.
    fn whole(&self, known: &[Known], wanted: Set, conditions: Set) -> Whole {
        let fields = self.fields();
        let (recording, nodes) = Recording::of(known, |named| {
            let mut prepared = vec![Trace::constant(0.0); fields.prepared_len()];
            self.trace_prepare(named, wanted, &mut prepared);
            let results = self.results(&fields, &prepared, named, wanted, conditions);
            [prepared, results].concat()
        });
        let (prepared, rest) = nodes.split_at(fields.prepared_len());
        let (outputs, conditions) = rest.split_at(fields.outputs.len());
        Whole { recording, prepared: prepared.to_vec(), outputs: outputs.to_vec(), conditions: conditions.to_vec() }
    }

    /// Its second stage.
    fn second(&self, known: &[Known], wanted: Set, conditions: Set) -> Second {
        self.recorded_second(Loops::EveryIteration, known, wanted, conditions)
    }

    /// Both stages as a device runs them: nothing known of the inputs, and loops recorded once.
    fn stages(&self, wanted: Set, conditions: Set) -> (First, Second) {
        let fields = self.fields();
        let known = vec![Known::ANY; fields.inputs.len()];
        let (recording, prepared) = Recording::recorded(Loops::Once, &known, |named| {
            let mut prepared = Trace::to_pass_on(&fields);
            self.trace_prepare(named, wanted, &mut prepared);
            fields.places().map(|(first, _)| prepared[first].as_written()).collect()
        });
        (First { recording, prepared }, self.recorded_second(Loops::Once, &known, wanted, conditions))
    }

    /// Its second stage, with the loops recorded one way or the other.
    #[doc(hidden)]
    fn recorded_second(&self, loops: Loops, known: &[Known], wanted: Set, conditions: Set) -> Second {
        let fields = self.fields();
        let passed = vec![Known::ANY; fields.prepared_len()];
        let (recording, nodes) = Recording::recorded(loops, &[known, &passed].concat(), |named| {
            let (inputs, prepared) = named.split_at(known.len());
            self.results(&fields, prepared, inputs, wanted, conditions)
        });
        let (outputs, conditions) = nodes.split_at(fields.outputs.len());
        Second { recording, outputs: outputs.to_vec(), conditions: conditions.to_vec() }
    }

    /// Outputs, then margins, of the second stage.
    #[doc(hidden)]
    fn results(&self, fields: &Fields, prepared: &[Trace], inputs: &[Trace], wanted: Set, conditions: Set) -> Vec<Trace> {
        let [mut outputs, mut margins] = [fields.outputs.len(), fields.conditions].map(|length| vec![Trace::constant(0.0); length]);
        self.trace_finish(prepared, inputs, wanted, &mut outputs);
        self.trace_conditions(prepared, inputs, conditions, &mut margins);
        [outputs, margins].concat()
    }
}

/// A formula from its inputs to its results.
#[derive(Clone, Debug)]
pub struct Whole {
    /// All operations.
    pub recording: Recording,
    /// What the first stage passes on.
    pub prepared: Vec<Node>,
    /// The outputs; those that were not asked for may be anything.
    pub outputs: Vec<Node>,
    /// The conditions' margins; those that were not asked for may be anything.
    pub conditions: Vec<Node>,
}

/// A formula's first stage.
#[derive(Clone, Debug)]
pub struct First {
    /// All operations.
    pub recording: Recording,
    /// What it passes on: a number or a table for each of [`Fields::places`].
    pub prepared: Vec<Node>,
}

/// A formula's second stage, from the inputs and what the first stage passes on to the results. The inputs of the list are the
/// model's, then the numbers that are passed on.
#[derive(Clone, Debug)]
pub struct Second {
    /// All operations.
    pub recording: Recording,
    /// The outputs; those that were not asked for may be anything.
    pub outputs: Vec<Node>,
    /// The conditions' margins; those that were not asked for may be anything.
    pub conditions: Vec<Node>,
}

impl Whole {
    /// Outputs, then conditions, as far as they are in these sets.
    pub fn asked(&self, wanted: Set, conditions: Set) -> Vec<Option<Node>> {
        asked(&self.outputs, wanted, &self.conditions, conditions)
    }

    /// What these need.
    pub fn list(&self, wanted: Set, conditions: Set) -> List {
        List::cut(&self.recording, &self.asked(wanted, conditions))
    }
}

impl Second {
    /// Outputs, then conditions, as far as they are in these sets.
    pub fn list(&self, wanted: Set, conditions: Set) -> List {
        List::cut(&self.recording, &asked(&self.outputs, wanted, &self.conditions, conditions))
    }
}

fn asked(outputs: &[Node], wanted: Set, margins: &[Node], conditions: Set) -> Vec<Option<Node>> {
    let of = |nodes: &[Node], set: Set| -> Vec<Option<Node>> {
        nodes.iter().enumerate().map(|(number, &node)| set.contains(number).then_some(node)).collect()
    };
    [of(outputs, wanted), of(margins, conditions)].concat()
}

/// What a formula's second stage and conditions read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reads {
    /// Fields that the first stage passes on, by their number in [`Fields::places`].
    pub prepared: Set,
    /// Inputs.
    pub inputs: Set,
}

impl Reads {
    /// Of these lists of a second stage.
    pub fn of_lists(fields: &Fields, lists: &[&List]) -> Self {
        let field_of: Vec<usize> =
            fields.places().enumerate().flat_map(|(field, (_, length))| std::iter::repeat_n(field, length)).collect();
        let mut reads = Self { prepared: Set::EMPTY, inputs: Set::EMPTY };
        for operation in lists.iter().flat_map(|list| &list.operations) {
            if let Operation::Input(input) = *operation {
                match usize::from(input).checked_sub(fields.inputs.len()) {
                    Some(passed) => reads.prepared.insert(field_of[passed]),
                    None => reads.inputs.insert(input.into()),
                }
            }
        }
        reads
    }
}
