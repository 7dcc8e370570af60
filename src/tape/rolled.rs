//! Loops that are recorded once: for a shader, where every iteration for itself would be thousands of operations.
//!
//! The state of a loop, and the place that it is at, are numbers that only its body has. What a loop leaves is [`Rolled::Folded`], and a
//! table that it has written is another number than before: so the operations may be cut and put in order as any others.

use super::{List, Node, Operation};
use crate::real::{Place, Real};

/// Operations of recorded loops and their tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rolled {
    /// Number of the place that a loop is at.
    Index(u8),
    /// A number of a loop's state at the beginning of an iteration.
    State(u8, u8),
    /// A number of a loop's state at its end.
    Folded(u8, u8),
    /// A table as it is made: its number, and what it is filled with.
    Table(u8, Node),
    /// A table as a loop leaves it: the loop, the table's number, and the table before.
    Written(u8, u8, Node),
    /// A table with a number put behind so many others: the table before, how many others, the number.
    PutLast(Node, Node, Node),
    /// The number at a place of a table. What the first stage passed on as a table stands for itself by its first number.
    Get(Node, Place),
    /// The number of a table at a whole number.
    GetAt(Node, Node),
    /// What a device leaves to f64.
    Unknown,
}

/// A table of the formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormulaTable {
    /// What it is called, unless it is passed on to the second stage.
    pub name: &'static str,
    /// How many numbers it has.
    pub length: usize,
    /// What was last written to it, as a node.
    pub version: Node,
}

/// What a loop writes into a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Store {
    /// The table's number.
    pub table: u8,
    /// Where.
    pub place: Place,
    /// What.
    pub number: Node,
}

/// A loop that is recorded once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RolledLoop {
    /// Its first place.
    pub first: usize,
    /// One beyond its last place.
    pub end: Node,
    /// The largest that `end` may be.
    pub most: usize,
    /// Does it begin at the last place?
    pub backwards: bool,
    /// The number of the state that ends it where it is zero.
    pub until_zero: Option<u8>,
    /// The state: its numbers at the beginning, and after an iteration.
    pub state: Vec<(Node, Node)>,
    /// What the numbers of the state are called.
    pub names: &'static [&'static str],
    /// What an iteration writes.
    pub stores: Vec<Store>,
}

/// A loop with the operations of its body.
#[derive(Clone, Debug)]
pub struct ListLoop {
    /// The loop as recorded.
    pub recorded: RolledLoop,
    /// Which numbers of the state are in use.
    pub used: Vec<bool>,
    /// Operations that differ between iterations, operands first.
    pub inner: Vec<Node>,
}

impl Rolled {
    /// Calls `each` with the operands that do not belong to a loop.
    pub fn operands(self, mut each: impl FnMut(Node)) {
        match self {
            Self::Index(_) | Self::State(..) | Self::Folded(..) | Self::Unknown => {}
            Self::Table(_, a) | Self::Written(.., a) | Self::Get(a, _) => each(a),
            Self::GetAt(a, b) => [a, b].into_iter().for_each(each),
            Self::PutLast(a, b, c) => [a, b, c].into_iter().for_each(each),
        }
    }

    /// The same with other operands.
    #[must_use]
    pub fn map(self, at: impl Fn(Node) -> Node) -> Self {
        match self {
            Self::Index(_) | Self::State(..) | Self::Folded(..) | Self::Unknown => self,
            Self::Table(table, fill) => Self::Table(table, at(fill)),
            Self::Written(by, table, before) => Self::Written(by, table, at(before)),
            Self::PutLast(table, end, number) => Self::PutLast(at(table), at(end), at(number)),
            Self::Get(table, place) => Self::Get(at(table), place),
            Self::GetAt(table, index) => Self::GetAt(at(table), at(index)),
        }
    }

    /// The same with other numbers for the loops.
    #[must_use]
    pub(super) fn renumbered(self, number: impl Fn(u8) -> u8) -> Self {
        match self {
            Self::Index(of) => Self::Index(number(of)),
            Self::State(of, at) => Self::State(number(of), at),
            Self::Folded(of, at) => Self::Folded(number(of), at),
            Self::Written(of, table, before) => Self::Written(number(of), table, before),
            Self::Get(table, place) => Self::Get(table, Place { of: place.of.map(number), ..place }),
            Self::Table(..) | Self::PutLast(..) | Self::GetAt(..) | Self::Unknown => self,
        }
    }

    /// The loop that it has to do with.
    pub(super) fn any_loop(self) -> Option<u8> {
        match self {
            Self::Folded(of, _) | Self::Written(of, ..) => Some(of),
            _ => self.inside(),
        }
    }

    /// The loop whose body it belongs to.
    pub fn inside(self) -> Option<u8> {
        match self {
            Self::Index(number) | Self::State(number, _) => Some(number),
            Self::Get(_, place) => place.of,
            _ => None,
        }
    }

    /// Calls `each` with what a loop has to do with it: its numbers at the beginning and after an iteration, its end, and what it writes.
    pub fn of_loop(self, loops: &[RolledLoop], mut each: impl FnMut(Node)) {
        let (number, states, table) = match self {
            Self::State(number, state) | Self::Folded(number, state) => (number, Some(state), None),
            Self::Written(number, table, _) => (number, None, Some(table)),
            _ => return,
        };
        let it = &loops[number as usize];
        each(it.end);
        for state in it.until_zero.into_iter().chain(states) {
            let (begin, next) = it.state[state as usize];
            each(begin);
            each(next);
        }
        it.stores.iter().filter(|store| Some(store.table) == table).for_each(|store| each(store.number));
    }
}

impl RolledLoop {
    /// The same with other nodes; numbers of the state and tables that nobody needs keep theirs.
    pub(super) fn map(&self, at: impl Fn(Node) -> Node, number: impl Fn(u8) -> u8) -> Self {
        let place = |place: Place| Place { of: place.of.map(&number), ..place };
        Self {
            end: at(self.end),
            state: self.state.iter().map(|&(begin, next)| (at(begin), at(next))).collect(),
            stores: self.stores.iter().map(|store| Store { number: at(store.number), place: place(store.place), ..*store }).collect(),
            ..self.clone()
        }
    }
}

impl List {
    /// Runs a list with recorded loops: its results, zero for those that are tables, and the tables by number.
    pub fn run_loops<R: Real<Shared = R>>(&self, inputs: &[R]) -> (Vec<R>, Vec<Vec<R>>) {
        let zero = R::constant(0.0);
        let mut slots = vec![zero; self.operations.len()];
        let mut tables: Vec<Vec<R>> = self.tables.iter().map(|table| vec![zero; table.length]).collect();
        let mut done = vec![false; self.loops.len()];
        for node in (0..self.operations.len()).filter(|&node| !self.inner[node]) {
            match self.operations[node] {
                Operation::Input(input) => slots[node] = inputs[input as usize],
                Operation::Rolled(rolled) => {
                    if let Rolled::Folded(number, _) | Rolled::Written(number, ..) = rolled
                        && !std::mem::replace(&mut done[number as usize], true)
                    {
                        self.run_loop(number, inputs, &mut slots, &mut tables);
                    }
                    if let Some(value) = self.rolled(rolled, 0, inputs, &slots, &mut tables) {
                        slots[node] = value;
                    }
                }
                _ => self.compute(node as Node, &mut slots),
            }
        }
        (self.results.iter().map(|result| result.map_or(zero, |node| slots[node as usize])).collect(), tables)
    }

    fn run_loop<R: Real<Shared = R>>(&self, number: u8, inputs: &[R], slots: &mut [R], tables: &mut [Vec<R>]) {
        let ListLoop { recorded, used, inner } = &self.loops[number as usize];
        let mut state: Vec<R> = recorded.state.iter().map(|&(begin, _)| slots.get(begin as usize).copied().unwrap_or(slots[0])).collect();
        let end = slots[recorded.end as usize].iterations(recorded.most);
        for done in recorded.first..end {
            let place = if recorded.backwards { end - 1 - (done - recorded.first) } else { done };
            for &node in inner {
                match self.operations[node as usize] {
                    Operation::Rolled(Rolled::State(_, at)) => slots[node as usize] = state[at as usize],
                    Operation::Rolled(rolled) => {
                        if let Some(value) = self.rolled(rolled, place, inputs, slots, tables) {
                            slots[node as usize] = value;
                        }
                    }
                    _ => self.compute(node, slots),
                }
            }
            for store in &recorded.stores {
                if let Some(&number) = slots.get(store.number as usize) {
                    tables[store.table as usize][store.place.within(place)] = number;
                }
            }
            for (at, &(_, next)) in recorded.state.iter().enumerate().filter(|(at, _)| used[*at]) {
                state[at] = slots[next as usize];
            }
            if recorded.until_zero.is_some_and(|at| state[at as usize].is_zero()) {
                break;
            }
        }
        for (node, operation) in self.operations.iter().enumerate() {
            if let Operation::Rolled(Rolled::Folded(of, at)) = *operation
                && of == number
            {
                slots[node] = state[at as usize];
            }
        }
    }

    /// The value of an operation, if it has one, at a place of the loop that it belongs to.
    fn rolled<R: Real<Shared = R>>(&self, rolled: Rolled, place: usize, inputs: &[R], slots: &[R], tables: &mut [Vec<R>]) -> Option<R> {
        match rolled {
            Rolled::Index(_) => Some(R::number(Place::at(place))),
            Rolled::State(..) | Rolled::Folded(..) | Rolled::Written(..) => None,
            Rolled::Unknown => Some(R::constant(f64::NAN)),
            Rolled::Table(table, fill) => {
                tables[table as usize].fill(slots[fill as usize]);
                None
            }
            Rolled::PutLast(table, end, number) => {
                R::put_last(&mut tables[self.table(table)], slots[end as usize], slots[number as usize]);
                None
            }
            Rolled::Get(table, at) => Some(match self.operations[table as usize] {
                Operation::Input(first) => inputs[first as usize + at.within(place)],
                _ => tables[self.table(table)][at.within(place)],
            }),
            Rolled::GetAt(table, index) => {
                let Operation::Input(first) = self.operations[table as usize] else { return None };
                let from = &inputs[first as usize..];
                let last = R::constant((from.len() - 1).min(usize::from(u8::MAX)) as f64);
                Some(R::passed_at(&from[..from.len().min(usize::from(u8::MAX))], slots[index as usize], last))
            }
        }
    }

    /// Number of the table that a version is of.
    pub fn table(&self, version: Node) -> usize {
        match self.operations[version as usize] {
            Operation::Rolled(Rolled::Table(table, _) | Rolled::Written(_, table, _)) => table.into(),
            Operation::Rolled(Rolled::PutLast(before, ..)) => self.table(before),
            other => unreachable!("{other:?} is no table"),
        }
    }
}
