//! The stages of a formula cut to one study: where the ranges of all inputs are known, many a choice is no choice.
//!
//! A formula that is read from text asks at every division, root and logarithm whether it has a value, and goes on with another number
//! where it has none. In the ranges of a study nearly all of these questions have one answer, which intervals prove for f64; on a device
//! they would be asked with error bounds for every design and scenario.
//!
//! A study also says which inputs change slowly. What depends on these alone is computed once for all that have them in common, however
//! the formula was written: so a model that is read from a file takes a device no longer than one of the program.

use super::list::needed;
use super::{Binary, EVERYTHING, Fields, Interval, Known, List, Node, Operation, Reads, Recordable, Recording, Set, Unary, Whole};
use crate::interned::{interned, interned_list};

/// The lists of a formula's two stages, as a device runs them.
#[derive(Clone, Debug)]
pub struct StageLists {
    /// What the first stage passes on: a result for each field of [`Fields::places`](super::Fields::places), `None` where nobody reads it.
    pub first: List,
    /// Margins of the conditions.
    pub conditions: List,
    /// Outputs.
    pub finish: List,
}

impl StageLists {
    /// Of a formula with so many conditions, for any inputs.
    pub fn whole(formula: &dyn Recordable, conditions: usize) -> Self {
        let (first, second) = formula.stages(Set::ALL, Set::ALL);
        let cut = |recording: &Recording, nodes: &[Node]| List::cut(recording, &nodes.iter().copied().map(Some).collect::<Vec<_>>());
        Self {
            first: cut(&first.recording, &first.prepared),
            conditions: cut(&second.recording, &second.conditions[..conditions]),
            finish: cut(&second.recording, &second.outputs),
        }
    }
}

/// A formula's stages for inputs of known ranges.
#[derive(Clone, Debug)]
pub struct SettledStages {
    /// What is computed.
    pub lists: StageLists,
    /// The conditions that are to be asked: the others surely hold.
    pub open: Set,
    /// What the second stage reads.
    pub reads: Reads,
    /// The names of the values, with what passes between these stages.
    pub fields: Fields,
    /// The second stage from one number on, if one was chosen.
    pub onwards: Option<Onwards>,
}

/// The second stage of a formula from one number on: all that changes quickly comes in by this number.
#[derive(Clone, Debug)]
pub struct Onwards {
    /// What the number is made of; its one result.
    pub number: List,
    /// Inputs that it depends on.
    pub inputs: Set,
    /// Its name, a field behind those that pass between the stages.
    pub field: &'static str,
    /// Margins of the conditions, as in [`StageLists`], that read the number instead of making it.
    pub conditions: List,
    /// The same of the outputs.
    pub finish: List,
}

/// Chooses a number of a second stage, given its list and which inputs of the formula each operation depends on.
pub type Choice<'a> = &'a dyn Fn(&List, &[Set]) -> Option<Node>;

/// Most numbers that the first stage may pass on. A formula that would need more is divided as it was written.
const MOST_PASSED: usize = 200;

impl SettledStages {
    /// As [`SettledStages::new`], for a study in which the inputs in `slow` change slowly.
    ///
    /// What depends on slow inputs alone is the first stage, unless the formula has loops or tables: then it is divided as it was written.
    pub fn divided(formula: &dyn Recordable, known: &[Known], wanted: Set, conditions: &[(usize, bool)], slow: Set) -> Self {
        Self::divided_with(formula, known, wanted, conditions, slow, &|_, _| None)
    }

    /// The same; the second stage is also given from the number on that `choice` takes, if it takes one.
    pub fn divided_with(
        formula: &dyn Recordable,
        known: &[Known],
        wanted: Set,
        conditions: &[(usize, bool)],
        slow: Set,
        choice: Choice<'_>,
    ) -> Self {
        Self::by_inputs(formula, known, wanted, conditions, slow, choice).unwrap_or_else(|| Self::new(formula, known, wanted, conditions))
    }

    fn by_inputs(
        formula: &dyn Recordable,
        known: &[Known],
        wanted: Set,
        conditions: &[(usize, bool)],
        slow: Set,
        choice: Choice<'_>,
    ) -> Option<Self> {
        let own = formula.fields();
        let (first, second) = formula.stages(wanted, Set::ALL);
        let is_plain = |it: &Recording| it.loops.is_empty() && it.tables.is_empty();
        if !own.tables.is_empty() || !is_plain(&first.recording) || !is_plain(&second.recording) {
            return None;
        }
        let asked: Set = conditions.iter().map(|(condition, _)| condition).collect();
        let whole = formula.whole(known, wanted, asked);
        let ranges: Vec<Interval> = known.iter().map(range_of).collect();
        let (settled, results) = settled(&whole.recording, &whole.asked(wanted, asked), &ranges);
        let (outputs, margins) = results.split_at(own.outputs.len());
        let open = open(conditions, margins);
        let outputs: Vec<_> = outputs.iter().map(|&(node, _)| node).collect();
        let margins: Vec<_> = margins.iter().enumerate().map(|(number, &(node, _))| node.filter(|_| open.contains(number))).collect();

        let passed = passed_on(&settled, &[&outputs[..], &margins].concat(), slow);
        if passed.len() > MOST_PASSED {
            return None;
        }
        // A structure in WGSL has at least one field.
        let is_none = passed.is_empty();
        let mut names: Vec<_> = (0..passed.len().max(1)).map(|number| interned(&format!("k{number}"))).collect();
        let mut first: Vec<_> = passed.iter().copied().map(Some).chain(is_none.then_some(None)).collect();
        let all = [&outputs[..], &margins].concat();
        let inputs_of = by_node(&settled, &all, |list| list.dependencies(|input| Set::one(input.into())));
        let before = settled.clone();
        let mut second = settled;
        for (number, node) in passed.into_iter().enumerate() {
            let input = u16::try_from(own.inputs.len() + number).expect("there are few");
            second.operations[node as usize] = Operation::Input(input);
        }
        let [conditions, finish] = [&margins, &outputs].map(|nodes| List::cut(&second, nodes));
        let list = List::cut(&second, &all);
        let nodes: Vec<usize> = needed(&second, &all).iter().enumerate().filter(|(_, needed)| **needed).map(|(node, _)| node).collect();
        let inputs: Vec<Set> = nodes.iter().map(|&node| inputs_of[node]).collect();
        let onwards = choice(&list, &inputs).map(|chosen| {
            let node = nodes[chosen as usize];
            let field = interned(&format!("k{}", names.len()));
            let number = List::cut(&second, &[Some(node as Node)]);
            let input = u16::try_from(own.inputs.len() + names.len()).expect("there are few");
            second.operations[node] = Operation::Input(input);
            names.push(field);
            first.push(None);
            let [conditions, finish] = [&margins, &outputs].map(|nodes| List::cut(&second, nodes));
            Onwards { number, inputs: inputs_of[node], field, conditions, finish }
        });
        let fields = Fields { prepared: interned_list(&names), ..own };
        let first = List::cut(&before, &first);
        let reads = Reads::of_lists(&fields, &[&conditions, &finish]);
        Some(Self { lists: StageLists { first, conditions, finish }, open, reads, fields, onwards })
    }

    /// For these outputs and these conditions, of each of which is told whether its margin must be greater than zero (else at least zero).
    pub fn new(formula: &dyn Recordable, known: &[Known], wanted: Set, conditions: &[(usize, bool)]) -> Self {
        let fields = formula.fields();
        let (first, second) = formula.stages(Set::ALL, Set::ALL);
        let mut ranges: Vec<Interval> = known.iter().map(range_of).collect();
        let prepared: Vec<_> = first.prepared.iter().copied().map(Some).collect();
        let (first, prepared) = settled(&first.recording, &prepared, &ranges);
        ranges.extend(fields.places().zip(&prepared).flat_map(|((_, length), &(_, range))| {
            let range = if length == 1 { range } else { EVERYTHING };
            std::iter::repeat_n(range, length)
        }));

        let asked: Set = conditions.iter().map(|(condition, _)| condition).collect();
        let of = |nodes: &[Node], set: Set| -> Vec<Option<Node>> {
            nodes.iter().enumerate().map(|(number, &node)| set.contains(number).then_some(node)).collect()
        };
        let nodes = [of(&second.outputs, wanted), of(&second.conditions, asked)].concat();
        let (second, results) = settled(&second.recording, &nodes, &ranges);
        let (outputs, margins) = results.split_at(fields.outputs.len());
        let open = open(conditions, margins);
        let margins = margins.iter().enumerate().map(|(condition, &(node, _))| node.filter(|_| open.contains(condition)));
        let conditions = List::cut(&second, &margins.collect::<Vec<_>>());
        let finish = List::cut(&second, &outputs.iter().map(|&(node, _)| node).collect::<Vec<_>>());

        let reads = Reads::of_lists(&fields, &[&conditions, &finish]);
        // One loop may write several tables: a kernel leaves out those that nobody reads where it stores their numbers.
        let is_passed = |field: usize| reads.prepared.contains(field) || field >= fields.prepared.len();
        let passed = prepared.iter().enumerate().map(|(field, &(node, _))| node.filter(|_| is_passed(field)));
        let first = List::cut(&first, &passed.collect::<Vec<_>>());
        Self { lists: StageLists { first, conditions, finish }, open, reads, fields, onwards: None }
    }
}

impl Whole {
    /// What these outputs and the margins of all conditions need for inputs of known ranges. A condition that surely holds has no result; of
    /// each is told whether its margin must be greater than zero (else at least zero).
    pub fn settled(&self, known: &[Known], outputs: &[usize], strict: impl IntoIterator<Item = bool>) -> List {
        let ranges: Vec<Interval> = known.iter().map(range_of).collect();
        let conditions: Vec<(usize, bool)> = strict.into_iter().enumerate().collect();
        let asked = outputs.iter().map(|&it| self.outputs[it]).chain(conditions.iter().map(|&(it, _)| self.conditions[it]));
        let (recording, results) = settled(&self.recording, &asked.map(Some).collect::<Vec<_>>(), &ranges);
        let (outputs, margins) = results.split_at(outputs.len());
        let open = open(&conditions, margins);
        let margins = margins.iter().enumerate().map(|(condition, &(node, _))| node.filter(|_| open.contains(condition)));
        List::cut(&recording, &outputs.iter().map(|&(node, _)| node).chain(margins).collect::<Vec<_>>())
    }
}

fn range_of(known: &Known) -> Interval {
    match *known {
        Known::Fixed(value) => Interval::point(value),
        Known::Within(least, largest) => Interval::new(least, largest),
    }
}

/// The conditions that do not surely hold, given the ranges of all margins.
fn open(conditions: &[(usize, bool)], margins: &[(Option<Node>, Interval)]) -> Set {
    let is_open = |&&(condition, strict): &&(usize, bool)| {
        let margin = margins[condition].1;
        if strict { margin.low <= 0.0 } else { margin.low < 0.0 }
    };
    conditions.iter().filter(is_open).map(|(condition, _)| condition).collect()
}

/// What depends on `slow` inputs alone and is read by what does not, or is a result: inputs and constants are at hand, and signs and
/// factors of two cost nothing.
fn passed_on(recording: &Recording, results: &[Option<Node>], slow: Set) -> Vec<Node> {
    let list = List::cut(recording, results);
    let inputs = list.dependencies(|input| Set::one(input.into()));
    let is_passed = |node: Node| {
        let is_slow = (inputs[node as usize] - slow).is_empty() && !list.inner[node as usize];
        let operation = list.operations[node as usize];
        let is_cheap = matches!(operation, Operation::Input(_) | Operation::Constant(_) | Operation::Argument(_));
        is_slow && !is_cheap && !matches!(operation, Operation::Unary(Unary::Neg | Unary::Scale(_), _))
    };
    let mut passed = vec![false; list.operations.len()];
    let mut read = vec![false; list.operations.len()];
    list.results.iter().flatten().for_each(|&node| read[node as usize] = true);
    for node in (0..list.operations.len()).rev() {
        passed[node] = read[node] && is_passed(node as Node);
        if !read[node] || passed[node] {
            continue;
        }
        match list.operations[node] {
            Operation::Root(number) => list.roots[number as usize].root.reads(|operand| read[operand as usize] = true),
            operation => operation.operands(|operand| read[operand as usize] = true),
        }
    }
    let needed = needed(recording, results);
    let nodes = (0..recording.operations.len()).filter(|&node| needed[node]);
    nodes.zip(passed).filter(|&(_, is_passed)| is_passed).map(|(node, _)| node as Node).collect()
}

/// What a list that is cut to some results has for each of its operations, by the recording's.
fn by_node<T: Clone + Default>(recording: &Recording, results: &[Option<Node>], each: impl Fn(&List) -> Vec<T>) -> Vec<T> {
    let mut of_list = each(&List::cut(recording, results)).into_iter();
    let needed = needed(recording, results);
    needed.into_iter().map(|needed| if needed { of_list.next().expect("the list has it") } else { T::default() }).collect()
}

/// Zero, as it is recorded.
const ZERO: Operation = Operation::Constant(0);

/// The range of every operation of a list that is not inside the function of a root. What may be no number has every range: there the
/// answers to comparisons are others than the ends of a range would give.
fn ranges(list: &List, inputs: &[Interval]) -> Vec<Interval> {
    let mut ranges = vec![EVERYTHING; list.operations.len()];
    for (node, &operation) in list.operations.iter().enumerate().filter(|(node, _)| !list.inner[*node]) {
        if let Operation::Input(input) = operation {
            ranges[node] = inputs[usize::from(input)];
            continue;
        }
        list.compute(node as Node, &mut ranges);
        let mut may_be_none = false;
        match operation {
            Operation::Unary(kind, a) => {
                let range = ranges[a as usize];
                may_be_none = range == EVERYTHING
                    || match kind {
                        Unary::Sqrt => range.low < 0.0,
                        Unary::Asin => range.low < -1.0 || range.high > 1.0,
                        Unary::Sin | Unary::Cos => !range.is_finite(),
                        _ => false,
                    };
            }
            Operation::Root(number) => list.outside(number, |read| may_be_none |= ranges[read as usize] == EVERYTHING),
            _ => {}
        }
        if may_be_none {
            ranges[node] = EVERYTHING;
        }
    }
    ranges
}

/// A recording in which every choice that is sure where inputs have these ranges is what was chosen, with what each result is then and the
/// range that it lies in.
fn settled(recording: &Recording, results: &[Option<Node>], inputs: &[Interval]) -> (Recording, Vec<(Option<Node>, Interval)>) {
    let list = List::cut(recording, results);
    let values = ranges(&list, inputs);
    // Of every operation, the one that it comes to.
    let mut same: Vec<Node> = (0..recording.operations.len() as Node).collect();
    let needed = needed(recording, results);
    let places = (0..same.len()).filter(|&node| needed[node]);
    for ((node, operation), inner) in places.zip(&list.operations).zip(&list.inner) {
        // Of what is inside the function of a root the range is not known.
        let range = |node: Node| if list.inner[node as usize] { EVERYTHING } else { values[node as usize] };
        let is_first = match *operation {
            _ if *inner => None,
            Operation::Select(margin, ..) if range(margin).low >= 0.0 => Some(true),
            Operation::Select(margin, ..) if range(margin).high < 0.0 => Some(false),
            // Of equal numbers either may be taken, but for the sign of zero.
            Operation::Binary(kind @ (Binary::Min | Binary::Max), a, b) if range(a).high < range(b).low => Some(kind == Binary::Min),
            Operation::Binary(kind @ (Binary::Min | Binary::Max), a, b) if range(b).high < range(a).low => Some(kind == Binary::Max),
            Operation::Binary(kind, a, b) => {
                // The operands as they are now: a zero may have come to them.
                let is_zero = |node: Node| recording.operations[same[node as usize] as usize] == ZERO;
                let is_positive = |node: Node| range(node).low > 0.0 && range(node).is_finite();
                let [a_now, b_now] = match recording.operations[node] {
                    Operation::Binary(_, a, b) => [a, b],
                    other => unreachable!("{other:?} is no operation on two numbers"),
                };
                match kind {
                    // Without a mass or a speed there is no centrifugal force.
                    Binary::Mul if is_zero(a_now) && (is_zero(b_now) || is_positive(b)) => Some(true),
                    Binary::Mul if is_zero(b_now) && is_positive(a) => Some(false),
                    Binary::Sub if is_zero(b_now) => Some(true),
                    _ => None,
                }
            }
            _ => None,
        };
        let chosen = is_first.map(|is_first| match recording.operations[node] {
            Operation::Select(_, a, b) | Operation::Binary(_, a, b) => {
                if is_first {
                    a
                } else {
                    b
                }
            }
            other => unreachable!("{other:?} chooses nothing"),
        });
        if let Some(chosen) = chosen {
            same[node] = same[chosen as usize];
        }
    }
    let at = |node: Node| same.get(node as usize).copied().unwrap_or(node);
    let mut settled = recording.clone();
    settled.operations.iter_mut().for_each(|operation| *operation = operation.map(at));
    settled.roots.iter_mut().for_each(|root| *root = root.map(at));
    settled.loops.iter_mut().for_each(|it| *it = it.map(at, |number| number));
    let range = |place: Option<Node>| place.map_or(EVERYTHING, |place| values[place as usize]);
    let results = results.iter().zip(&list.results).map(|(node, &place)| (node.map(at), range(place)));
    let results = results.collect();
    (settled, results)
}
