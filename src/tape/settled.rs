//! The stages of a formula cut to one study: where the ranges of all inputs are known, many a choice is no choice.
//!
//! A formula that is read from text asks at every division, root and logarithm whether it has a value, and goes on with another number
//! where it has none. In the ranges of a study nearly all of these questions have one answer, which intervals prove for f64; on a device
//! they would be asked with error bounds for every design and scenario.

use super::list::needed;
use super::{Binary, EVERYTHING, Interval, Known, List, Node, Operation, Reads, Recordable, Recording, Set};

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
}

impl SettledStages {
    /// For these outputs and these conditions, of each of which is told whether its margin must be greater than zero (else at least zero).
    pub fn new(formula: &dyn Recordable, known: &[Known], wanted: Set, conditions: &[(usize, bool)]) -> Self {
        let fields = formula.fields();
        let (first, second) = formula.stages(Set::ALL, Set::ALL);
        let mut ranges: Vec<Interval> = known
            .iter()
            .map(|known| match *known {
                Known::Fixed(value) => Interval::point(value),
                Known::Within(least, largest) => Interval::new(least, largest),
            })
            .collect();
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
        let is_open = |&&(condition, strict): &&(usize, bool)| {
            let margin = margins[condition].1;
            if strict { margin.low <= 0.0 } else { margin.low < 0.0 }
        };
        let open: Set = conditions.iter().filter(is_open).map(|(condition, _)| condition).collect();
        let margins = margins.iter().enumerate().map(|(condition, &(node, _))| node.filter(|_| open.contains(condition)));
        let conditions = List::cut(&second, &margins.collect::<Vec<_>>());
        let finish = List::cut(&second, &outputs.iter().map(|&(node, _)| node).collect::<Vec<_>>());

        let reads = Reads::of_lists(&fields, &[&conditions, &finish]);
        // One loop may write several tables: a kernel leaves out those that nobody reads where it stores their numbers.
        let is_passed = |field: usize| reads.prepared.contains(field) || field >= fields.prepared.len();
        let passed = prepared.iter().enumerate().map(|(field, &(node, _))| node.filter(|_| is_passed(field)));
        let first = List::cut(&first, &passed.collect::<Vec<_>>());
        Self { lists: StageLists { first, conditions, finish }, open, reads }
    }
}

/// A recording in which every choice that is sure where inputs have these ranges is what was chosen, with what each result is then and the
/// range that it lies in.
fn settled(recording: &Recording, results: &[Option<Node>], inputs: &[Interval]) -> (Recording, Vec<(Option<Node>, Interval)>) {
    let list = List::cut(recording, results);
    let values = list.values(inputs, EVERYTHING);
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
