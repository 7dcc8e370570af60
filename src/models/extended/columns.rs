//! An extended model over many designs at once: the formulas as lists over columns, the model as it computes its own.

use super::surroundings::{ConditionPlace, SlotNumbers, Surroundings};
use crate::models::LANES;
use crate::models::formula::{Columns, Scratch};
use crate::tape::{ColumnValue, Known, List, ListColumns, Node, Operation, Recording, Set, Trace};

/// What formulas compute, as lists.
#[derive(Debug)]
pub struct Lists {
    /// From inputs to the inputs of the model that formulas give.
    before: List,
    /// From inputs to what the first stage passes on.
    pub first: List,
    /// From inputs, outputs of the model, margins of its conditions and what the first stage passed on to what formulas give that is
    /// shown, and the margins of all conditions.
    pub after: List,
    /// The two halves of it, for a single design of formulas alone.
    pub outputs: List,
    pub margins: List,
    base_outputs: usize,
    base_conditions: usize,
}

impl Lists {
    /// Records the formulas.
    pub fn new(around: &Surroundings) -> Self {
        let [inputs, outputs, conditions] = [around.inputs.len(), around.base_outputs(), around.base.conditions.len()];
        let of_inputs = |results: &dyn Fn(&SlotNumbers<Trace>) -> Vec<Trace>| {
            let (recording, nodes) = Recording::of(&vec![Known::ANY; inputs], |named| results(&around.before(named)));
            List::cut(&recording, &nodes.into_iter().map(Some).collect::<Vec<_>>())
        };
        let before = of_inputs(&|numbers| around.given.iter().map(|&slot| numbers.slots[slot]).collect());
        let first = of_inputs(&|numbers| around.passed(numbers).collect());
        let all = inputs + outputs + conditions + around.first.passed.len();
        let (recording, nodes) = Recording::of(&vec![Known::ANY; all], |named: &[Trace]| {
            let (named, rest) = named.split_at(inputs);
            let (of_base, rest) = rest.split_at(outputs);
            let (margins, passed) = rest.split_at(conditions);
            let mut numbers = around.before_second(named, passed);
            around.after(&mut numbers, of_base, margins);
            around.own_outputs(&numbers).chain(around.margins(&numbers, margins)).collect()
        });
        let cut = |nodes: &[Node]| List::cut(&recording, &nodes.iter().copied().map(Some).collect::<Vec<_>>());
        let (of_outputs, of_margins) = nodes.split_at(around.shown.len());
        let [after, outputs_alone, margins_alone] = [&nodes[..], of_outputs, of_margins].map(cut);
        Self { before, first, after, outputs: outputs_alone, margins: margins_alone, base_outputs: outputs, base_conditions: conditions }
    }

    /// Where an output or condition of the extended model comes from.
    fn place(&self, around: &Surroundings, asked: AskedResult) -> ResultPlace {
        match asked {
            AskedResult::Output(output) => match output.checked_sub(self.base_outputs) {
                None => ResultPlace::Base(output),
                Some(own) => ResultPlace::Own(own),
            },
            AskedResult::Condition(condition) => match around.conditions[condition] {
                ConditionPlace::Base(number) => ResultPlace::Base(self.base_outputs + number),
                _ => ResultPlace::Own(around.shown.len() + condition),
            },
        }
    }

    /// Number of an input of the second list among outputs of the model and then margins of its conditions, or of what was passed on.
    fn source(&self, around: &Surroundings, input: u16) -> ListSource {
        let base = self.base_outputs + self.base_conditions;
        match usize::from(input).checked_sub(around.inputs.len()) {
            None => ListSource::Input(input.into()),
            Some(of_base) if of_base < base => ListSource::Base(of_base),
            Some(beyond) => ListSource::Passed(beyond - base),
        }
    }
}

/// Where a result comes from.
#[derive(Clone, Copy)]
enum ResultPlace {
    /// From the model: number among its outputs and then the margins of its conditions.
    Base(usize),
    /// From the second list, by the number of its result.
    Own(usize),
}

/// What an input of the second list is.
#[derive(Clone, Copy)]
enum ListSource {
    Input(usize),
    Base(usize),
    Passed(usize),
}

#[derive(Clone, Copy)]
enum AskedResult {
    Output(usize),
    Condition(usize),
}

/// Room for a thread.
#[derive(Debug)]
pub struct ExtendedColumns {
    before: ListColumns,
    after: ListColumns,
    of_base: Scratch,
    /// What the rest was laid out for: inputs that vary, outputs, conditions.
    laid_out: Option<(Vec<usize>, Vec<usize>, Vec<usize>)>,
    /// Of the model: its inputs, those of them that vary, what it is asked for, and what it answers.
    base_inputs: Vec<f64>,
    varying: Vec<(usize, Vec<f64>)>,
    outputs: Vec<usize>,
    conditions: Vec<usize>,
    answers: Vec<Vec<f64>>,
}

impl ExtendedColumns {
    /// Room for a model with these formulas.
    pub fn new(around: &Surroundings, lists: &Lists) -> Self {
        Self {
            before: ListColumns::new(&lists.before),
            after: ListColumns::new(&lists.after),
            of_base: Scratch::new(around.base.inputs.len(), &*around.base.kernel),
            laid_out: None,
            base_inputs: vec![0.0; around.base.inputs.len()],
            varying: Vec::new(),
            outputs: Vec::new(),
            conditions: Vec::new(),
            answers: Vec::new(),
        }
    }

    /// Lays out what a block needs that asks this.
    fn lay_out(&mut self, around: &Surroundings, lists: &Lists, columns: &Columns<'_>) {
        let varying: Vec<usize> = columns.varying.iter().map(|(input, _)| *input).collect();
        let asked = (&varying[..], columns.outputs, columns.conditions);
        if self.laid_out.as_ref().is_some_and(|(a, b, c)| (&a[..], &b[..], &c[..]) == asked) {
            return;
        }
        self.before.turn_to(&lists.before, 0..around.given.len(), |input| varying.contains(&usize::from(input)));
        let own = asked_of(columns).filter_map(|it| match lists.place(around, it) {
            ResultPlace::Own(result) => Some(result),
            ResultPlace::Base(_) => None,
        });
        // What the model computes counts as different from design to design.
        self.after.turn_to(&lists.after, own, |input| match lists.source(around, input) {
            ListSource::Input(input) => varying.contains(&input),
            ListSource::Base(_) => true,
            ListSource::Passed(_) => false,
        });
        let (mut outputs, mut conditions) = (Set::EMPTY, Set::EMPTY);
        let mut ask = |of_base: usize| match of_base.checked_sub(lists.base_outputs) {
            None => outputs.insert(of_base),
            Some(condition) => conditions.insert(condition),
        };
        for &node in self.after.needed() {
            if let Operation::Input(input) = lists.after.operations[node as usize]
                && let ListSource::Base(of_base) = lists.source(around, input)
            {
                ask(of_base);
            }
        }
        for asked in asked_of(columns) {
            if let ResultPlace::Base(of_base) = lists.place(around, asked) {
                ask(of_base);
            }
        }
        self.outputs = outputs.iter().collect();
        self.conditions = conditions.iter().collect();
        self.answers = vec![Vec::new(); self.outputs.len() + self.conditions.len()];
        let kept = varying.iter().map(|&input| around.inputs[input]).filter(|&slot| slot < around.base.inputs.len());
        let given = around.given.iter().enumerate().filter(|(result, _)| {
            let node = lists.before.results[*result].expect("every result is asked for");
            self.before.differs(node)
        });
        self.varying = kept.chain(given.map(|(_, &slot)| slot)).map(|slot| (slot, Vec::new())).collect();
        self.laid_out = Some((varying, columns.outputs.to_vec(), columns.conditions.to_vec()));
    }

    /// As [`Kernel::finish_columns`](crate::models::Kernel::finish_columns).
    pub fn run(
        &mut self,
        around: &Surroundings,
        lists: &Lists,
        prepared: &[f64],
        inputs: &[f64],
        columns: &Columns<'_>,
        results: &mut [Vec<f64>],
    ) {
        self.lay_out(around, lists, columns);
        let count = columns.count;
        let room = count.next_multiple_of(LANES);
        let column_of = |input: usize| columns.varying.iter().find(|(it, _)| *it == input).map(|(_, column)| &column[..]);
        let of_input = |input: usize| column_of(input).map_or(ColumnValue::One(inputs[input]), ColumnValue::Each);

        let Self { before, after, of_base, base_inputs, varying, outputs, conditions, answers, .. } = self;
        varying.iter_mut().for_each(|(_, column)| column.resize(room.max(column.len()), 1.0));
        for (input, &slot) in around.inputs.iter().enumerate().filter(|(_, slot)| **slot < around.base.inputs.len()) {
            base_inputs[slot] = inputs[input];
            if let (Some(from), Some((_, to))) = (column_of(input), varying.iter_mut().find(|(it, _)| *it == slot)) {
                to[..room].copy_from_slice(&from[..room]);
            }
        }
        before.run(
            &lists.before,
            count,
            |input| of_input(input.into()),
            |before, first, length| {
                for (result, &slot) in around.given.iter().enumerate() {
                    match before.result(&lists.before, result) {
                        ColumnValue::One(value) => base_inputs[slot] = value,
                        ColumnValue::Each(values) => {
                            let (_, column) = varying.iter_mut().find(|(it, _)| *it == slot).expect("it was laid out");
                            column[first..first + length].copy_from_slice(values);
                        }
                    }
                }
            },
        );
        // Lanes beyond the last design are computed too, of numbers like those of the last.
        varying.iter_mut().for_each(|(_, column)| {
            let last = column[count - 1];
            column[count..room].fill(last);
        });

        answers.iter_mut().for_each(|answer| answer.resize(room.max(answer.len()), 0.0));
        if !answers.is_empty() {
            let asked = Columns { count, varying, outputs, conditions };
            around.base.kernel.finish_columns(prepared, base_inputs, &asked, of_base, answers);
        }
        let answer = |of_base: usize| match of_base.checked_sub(lists.base_outputs) {
            None => outputs.iter().position(|&it| it == of_base),
            Some(condition) => conditions.iter().position(|&it| it == condition).map(|at| outputs.len() + at),
        };
        let answered = |of_base: usize| &answers[answer(of_base).expect("the model was asked for it")];
        let passed = around.passed_of(prepared);
        let of_after = |input: u16| match lists.source(around, input) {
            ListSource::Input(input) => of_input(input),
            ListSource::Base(of_base) => ColumnValue::Each(answered(of_base)),
            ListSource::Passed(number) => ColumnValue::One(passed[number]),
        };
        for (asked, result) in asked_of(columns).zip(&mut *results) {
            if let ResultPlace::Base(of_base) = lists.place(around, asked) {
                result[..count].copy_from_slice(&answered(of_base)[..count]);
            }
        }
        after.run(&lists.after, count, of_after, |after, first, length| {
            for (asked, result) in asked_of(columns).zip(&mut *results) {
                let ResultPlace::Own(own) = lists.place(around, asked) else { continue };
                match after.result(&lists.after, own) {
                    ColumnValue::One(value) => result[first..first + length].fill(value),
                    ColumnValue::Each(values) => result[first..first + length].copy_from_slice(values),
                }
            }
        });
    }
}

/// What a block is asked for, in the order of its results.
fn asked_of<'c>(columns: &Columns<'c>) -> impl Iterator<Item = AskedResult> + use<'c> {
    let (outputs, conditions) = (columns.outputs, columns.conditions);
    outputs.iter().map(|&it| AskedResult::Output(it)).chain(conditions.iter().map(|&it| AskedResult::Condition(it)))
}
