//! Loops that are recorded once, and the tables that they write and read, as text.

use super::{Arithmetic, Writer, put};
use crate::real::Place;
use crate::tape::{FormulaTable, ListLoop, Node, Operation, Rolled};

impl Writer<'_> {
    /// What an operation of a loop or table is, as a number.
    pub(super) fn rolled(&mut self, rolled: Rolled) -> String {
        match rolled {
            Rolled::Index(number) => format!("constant(f32(place_{number}))"),
            Rolled::State(number, at) | Rolled::Folded(number, at) => self.state(number, at),
            Rolled::Unknown => "Real(0.0, infinity())".to_owned(),
            Rolled::Get(table, place) => self.entry(table, &index(place)),
            Rolled::GetAt(table, at) => {
                let at = self.operand(at, Arithmetic::Bounded);
                // The place of a tooth that a loop over the table has found; what is less than zero becomes zero.
                let entry = self.entry(table, &format!("whole({at})"));
                format!("if_known({at}.bound == 0.0, {entry})")
            }
            Rolled::Table(..) | Rolled::Written(..) | Rolled::PutLast(..) => unreachable!("a table is no number"),
        }
    }

    /// A number of a table.
    fn entry(&mut self, table: Node, index: &str) -> String {
        match self.list.operations[table as usize] {
            Operation::Input(input) => (self.leaf)(input.into(), index),
            _ => format!("{}[{index}]", self.list.tables[self.list.table(table)].name),
        }
    }

    /// Writes a number of a table.
    fn put(&self, table: usize, index: &str, number: &str) -> String {
        match self.tables.get(&table) {
            Some(name) => format!("set_{name}({index}, {number});"),
            _ => format!("{}[{index}] = {number};", self.list.tables[table].name),
        }
    }

    /// The variable that holds a number of a loop's state.
    fn state(&mut self, number: u8, at: u8) -> String {
        let state = Operation::Rolled(Rolled::State(number, at));
        match self.list.operations.iter().position(|operation| *operation == state) {
            Some(node) => {
                self.call(node as Node, &format!("state_{number}_{at}"));
                self.names[&(node as Node)].clone()
            }
            // It does not matter for the next iteration.
            None => self.list.loops[number as usize]
                .recorded
                .names
                .get(usize::from(at))
                .map_or_else(|| format!("state_{number}_{at}"), |name| format!("{name}_{number}")),
        }
    }

    /// The lines of what is no number, or of a number that a loop leaves; `None` for what is a line like any other.
    pub(super) fn statement(&mut self, rolled: Rolled, node: Node, indent: &str) -> Option<String> {
        let mut text = String::new();
        match rolled {
            // It is a variable of its loop.
            Rolled::State(..) => {}
            Rolled::Table(table, fill) => {
                let table = usize::from(table);
                if !self.tables.contains_key(&table) {
                    let FormulaTable { name, length, .. } = self.list.tables[table];
                    put(&mut text, indent, &format!("var {name}: array<Real, {length}>;"), "");
                    if self.list.operations[fill as usize] != Operation::Constant(0) {
                        let fill = self.operand(fill, Arithmetic::Bounded);
                        put(&mut text, indent, &format!("for (var at = 0; at < {length}; at++) {{ {name}[at] = {fill}; }}"), "");
                    }
                }
            }
            Rolled::PutLast(table, end, number) => {
                let [end, number] = [end, number].map(|node| self.operand(node, Arithmetic::Bounded));
                let table = self.list.table(table);
                // Past the last place is the last place, as in f64: a number of teeth that a formula finds may be any number.
                let place = format!("min(whole({end}), {}u)", self.list.tables[table].length - 1);
                put(&mut text, indent, &self.put(table, &place, &number), "");
            }
            Rolled::Written(number, ..) => text = self.loop_once(number, indent),
            Rolled::Folded(number, at) => {
                text = self.loop_once(number, indent);
                let state = self.state(number, at);
                let name = self.name(node);
                put(&mut text, indent, &format!("let {name} = if_known(whole_{number}, {state});"), "");
            }
            _ => return None,
        }
        Some(text)
    }

    /// A loop, where it is first needed.
    fn loop_once(&mut self, number: u8, indent: &str) -> String {
        let list = self.list;
        let ListLoop { recorded, used, inner } = &list.loops[number as usize];
        let mut text = String::new();
        if !self.written.insert(number) {
            return text;
        }
        let end = self.operand(recorded.end, Arithmetic::Bounded);
        put(&mut text, indent, &format!("let end_{number} = min(whole({end}), {}u);", recorded.most), "");
        let states: Vec<usize> = (0..used.len()).filter(|&at| used[at]).collect();
        for &at in &states {
            let begin = self.operand(recorded.state[at].0, Arithmetic::Bounded);
            put(&mut text, indent, &format!("var {} = {begin};", self.state(number, at as u8)), "");
        }
        let first = recorded.first;
        if recorded.backwards {
            put(&mut text, indent, &format!("var left_{number} = end_{number};"), "");
            put(&mut text, indent, &format!("for (; left_{number} > {first}u; left_{number}--) {{"), "");
            put(&mut text, indent, &format!("    let place_{number} = left_{number} - 1u;"), "");
        } else {
            put(&mut text, indent, &format!("var place_{number} = {first}u;"), "");
            put(&mut text, indent, &format!("for (; place_{number} < end_{number}; place_{number}++) {{"), "");
        }
        let deeper = format!("{indent}    ");
        // What the next iteration begins with is computed before any of it is assigned.
        let is_state = |node: Node| matches!(list.operations[node as usize], Operation::Rolled(Rolled::State(..)));
        let mut next: Vec<(String, String)> = Vec::new();
        let kept: Vec<Node> = inner.iter().copied().filter(|&node| self.is_kept(node)).collect();
        text.push_str(&self.lines(&kept, Arithmetic::Bounded, &deeper));
        for store in recorded.stores.iter().filter(|store| store.number != Node::MAX) {
            let number = self.operand(store.number, Arithmetic::Bounded);
            put(&mut text, &deeper, &self.put(store.table.into(), &index(store.place), &number), "");
        }
        for &at in &states {
            let node = recorded.state[at].1;
            let (name, value) = (self.state(number, at as u8), self.operand(node, Arithmetic::Bounded));
            if states.len() > 1 && (is_state(node) || !self.is_kept(node)) && name != value {
                put(&mut text, &deeper, &format!("let next_{number}_{at} = {value};"), "");
                next.push((name, format!("next_{number}_{at}")));
            } else if name != value {
                next.push((name, value));
            }
        }
        for (name, value) in next {
            put(&mut text, &deeper, &format!("{name} = {value};"), "");
        }
        let mut ended = if recorded.backwards { format!("left_{number} <= {first}u") } else { format!("place_{number} >= end_{number}") };
        if let Some(at) = recorded.until_zero {
            let state = self.state(number, at);
            put(&mut text, &deeper, &format!("if is_zero({state}) {{ break; }}"), "");
            ended = format!("({ended}) | is_zero({state})");
        }
        put(&mut text, indent, "}", "");
        let leaves = |operation: &Operation| matches!(*operation, Operation::Rolled(Rolled::Folded(of, _)) if of == number);
        if !list.operations.iter().any(leaves) {
            return text;
        }
        put(&mut text, indent, "// A driver that ends long loops must not make a part of the iterations look like all of them.", "");
        put(&mut text, indent, &format!("let whole_{number} = {ended};"), "");
        text
    }
}

/// The index of a place in a table.
fn index(place: Place) -> String {
    match (place.of, place.number) {
        (None, number) => format!("{number}u"),
        (Some(of), 0) => format!("place_{of}"),
        (Some(of), number) if number < 0 => format!("place_{of} - {}u", -number),
        (Some(of), number) => format!("place_{of} + {number}u"),
    }
}
