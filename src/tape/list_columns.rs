//! Results of a list over many designs, a chunk at a time.

use super::{ColumnValue, List, Node, NodeColumns, Operation};

/// Most designs in a chunk of a list: all the columns that are read at a time fit the second-level cache. Not a power of two: columns that
/// begin a multiple of 4 kB apart would share the same few places of the caches, which takes twice the time.
pub const LIST_CHUNK: usize = 676;

/// A list over a block of designs: which operations are needed, and which have a number per design.
#[derive(Debug)]
pub struct ListColumns {
    numbers: NodeColumns,
    needed: Vec<Node>,
    each: Vec<bool>,
}

impl ListColumns {
    /// Room for a list.
    pub fn new(list: &List) -> Self {
        Self { numbers: NodeColumns::new(list), needed: Vec::new(), each: Vec::new() }
    }

    /// Turns to these results, where these inputs of the list differ between designs.
    pub fn turn_to(&mut self, list: &List, results: impl Iterator<Item = usize>, varying: impl Fn(u16) -> bool) {
        let nodes: Vec<Node> = results.filter_map(|result| list.results[result]).collect();
        self.needed = list.needed_by(&nodes);
        self.each = list.dependencies(|input| Bits(varying(input))).into_iter().map(|it| it.0).collect();
        let order: Vec<Node> = self.needed.iter().copied().filter(|&node| self.each[node as usize]).collect();
        self.numbers.share(list, &order, &nodes);
    }

    /// Computes `count` designs, a chunk at a time; `input` gives the list's inputs, `take` is given every chunk.
    pub fn run<'c>(
        &mut self,
        list: &List,
        count: usize,
        input: impl Fn(u16) -> ColumnValue<'c>,
        mut take: impl FnMut(&Self, usize, usize),
    ) {
        for first in (0..count).step_by(LIST_CHUNK) {
            let length = LIST_CHUNK.min(count - first);
            self.chunk(list, length, |number, node, numbers| match input(number) {
                ColumnValue::One(value) => numbers.slots[node as usize] = value,
                ColumnValue::Each(column) => numbers.fill(node, |to| to.copy_from_slice(&column[first..first + length])),
            });
            take(self, first, length);
        }
    }

    /// Computes one chunk of `length` designs; `input` is asked for each input of the list: it sets its slot or fills its column.
    pub fn chunk(&mut self, list: &List, length: usize, input: impl Fn(u16, Node, &mut NodeColumns)) {
        let Self { numbers, needed, each } = self;
        numbers.begin(length);
        for &node in &*needed {
            match list.operations[node as usize] {
                Operation::Input(number) => input(number, node, numbers),
                _ if each[node as usize] => numbers.compute(list, node, |node| each[node as usize]),
                _ => list.compute(node, &mut numbers.slots),
            }
        }
    }

    /// The operations that are computed, operands first.
    pub fn needed(&self) -> &[Node] {
        &self.needed
    }

    /// Has an operation a number of its own for each design?
    pub fn differs(&self, node: Node) -> bool {
        self.each[node as usize]
    }

    /// A result of the list over the current chunk.
    pub fn result(&self, list: &List, result: usize) -> ColumnValue<'_> {
        self.asked_result(list, result).expect("every result is asked for")
    }

    /// The same; `None` if nobody asked for it.
    pub fn asked_result(&self, list: &List, result: usize) -> Option<ColumnValue<'_>> {
        list.results[result].map(|node| self.numbers.value(node, |node| self.each[node as usize]))
    }
}

/// One bit, to be joined over what a number depends on.
#[derive(Clone, Copy, Default)]
struct Bits(bool);

impl std::ops::BitOrAssign for Bits {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}
