//! A recorded formula as equations for people: what a model computes, operation by operation, with its symbols.
//!
//! What the formula names stands in a line of its own, and so does what is read more than once and is more than a few signs. Everything is
//! in SI units.

use super::{Binary, Fields, List, ListLoop, ListRoot, Node, Operation, Recordable, Rolled, Set, Store, Unary};
use crate::decimal::plain;
use crate::real::Place;
use std::collections::{HashMap, HashSet};
use std::f64::consts::PI;

/// What is read more than once and is no longer than this is written where it is read.
const SHORT: usize = 28;
/// How tightly what stands around binds.
const LOOSE: u8 = 0;
const SUM: u8 = 10;
const PRODUCT: u8 = 20;
const SIGN: u8 = 25;
const POWER: u8 = 30;

/// A line: `left = right`, or a heading such as that of a loop.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct EquationLine {
    /// How deep it lies in loops and the functions of roots.
    pub depth: usize,
    /// What is computed; empty for a heading.
    pub left: String,
    /// How.
    pub right: String,
    /// The equation of the source that it comes from, as far as the formula says.
    pub source: String,
}

/// What a formula's numbers are called.
#[derive(Clone, Debug, Default)]
pub struct Symbols {
    /// Of each input; empty: the formula's own name.
    pub inputs: Vec<String>,
    /// Of each output.
    pub outputs: Vec<String>,
}

/// The equations of a formula.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct FormulaEquations {
    /// What is computed on the way, and then the outputs, operands first.
    pub lines: Vec<EquationLine>,
    /// The margin of each condition, with what is computed for it on the way. A condition holds where its margin is at least zero (above
    /// zero if it is strict).
    pub margins: Vec<String>,
}

impl FormulaEquations {
    /// Of a formula with so many outputs and conditions that its model lists.
    pub fn of(formula: &dyn Recordable, symbols: &Symbols, outputs: usize, conditions: usize) -> Self {
        let fields = formula.fields();
        let (first, second) = formula.stages(Set::ALL, Set::ALL);
        let mut names = SymbolTable::new(&fields, symbols);
        let asked: Vec<Option<Node>> = first.prepared.iter().copied().map(Some).collect();
        let list = List::cut(&first.recording, &asked);
        let mut lines = Vec::new();
        {
            let of_input = |input: usize, _: &str| names.inputs[input].clone();
            let mut printer = Printer::new(&list, &of_input, names.taken.clone(), &names.prepared, "a");
            for (&result, (table, _)) in list.results[fields.prepared.len()..].iter().flatten().zip(fields.tables) {
                printer.tables.insert(list.table(result), (*table).to_owned());
            }
            printer.kept_lines();
            for (place, node) in list.results[..fields.prepared.len()].iter().enumerate() {
                printer.result(*node, &names.prepared[place], "");
            }
            names.taken.extend(printer.taken.iter().cloned());
            lines.append(&mut printer.lines);
        }
        let passed: Vec<(usize, usize)> = fields.places().collect();
        let of_input = |input: usize, index: &str| match input.checked_sub(fields.inputs.len()) {
            None => names.inputs[input].clone(),
            Some(at) => match names.prepared.get(at) {
                Some(name) => name.clone(),
                None => {
                    let in_table = |(_, (first, length)): &(usize, &(usize, usize))| (*first..first + length).contains(&at);
                    let (field, (first, _)) = passed.iter().enumerate().find(in_table).expect("it is in a table");
                    let index = if index.is_empty() { (at - first).to_string() } else { index.to_owned() };
                    format!("{}[{index}]", fields.tables[field - fields.prepared.len()].0)
                }
            },
        };
        let results = second.outputs[..outputs].iter().chain(&second.conditions[..conditions]).copied().map(Some);
        let list = List::cut(&second.recording, &results.collect::<Vec<_>>());
        let mut printer = Printer::new(&list, &of_input, names.taken, &names.outputs[..outputs], "b");
        printer.kept_lines();
        for (output, node) in list.results[..outputs].iter().enumerate() {
            printer.result(*node, &names.outputs[output], "");
        }
        let margins = list.results[outputs..].iter().map(|node| node.map_or_else(String::new, |node| printer.operand(node, LOOSE)));
        let margins = margins.collect();
        lines.append(&mut printer.lines);
        Self { lines, margins }
    }
}

/// The names of inputs, of what the first stage passes on, and of outputs.
struct SymbolTable {
    inputs: Vec<String>,
    prepared: Vec<String>,
    outputs: Vec<String>,
    taken: HashSet<String>,
}

impl SymbolTable {
    fn new(fields: &Fields, symbols: &Symbols) -> Self {
        let mut taken = HashSet::new();
        let mut free = |wanted: &str, field: &str| {
            // A symbol such as "F1 - F2" would not be read as one in an equation.
            let is_one = !wanted.is_empty() && wanted.chars().all(|it| it.is_alphanumeric() || "_~'".contains(it));
            let name = if !is_one || taken.contains(wanted) { field } else { wanted };
            let mut name = name.to_owned();
            while !taken.insert(name.clone()) {
                name.push('\'');
            }
            name
        };
        let symbol = |of: &[String], at: usize| of.get(at).cloned().unwrap_or_default();
        let inputs: Vec<String> = fields.inputs.iter().enumerate().map(|(at, field)| free(&symbol(&symbols.inputs, at), field)).collect();
        let outputs: Vec<String> =
            fields.outputs.iter().enumerate().map(|(at, field)| free(&symbol(&symbols.outputs, at), field)).collect();
        // What is passed on under the name of an output is that output.
        let prepared = fields.prepared.iter().map(|field| match fields.outputs.iter().position(|output| output == field) {
            Some(output) => outputs[output].clone(),
            None => free("", field),
        });
        let prepared = prepared.collect();
        Self { inputs, prepared, outputs, taken }
    }
}

/// Writes one list.
struct Printer<'a> {
    list: &'a List,
    of_input: &'a dyn Fn(usize, &str) -> String,
    /// Tables that are called otherwise than in the list.
    tables: HashMap<usize, String>,
    reads: Vec<u32>,
    names: HashMap<Node, String>,
    taken: HashSet<String>,
    /// Numbers that are short enough to be written where they are read.
    inlined: HashSet<Node>,
    written: HashSet<u8>,
    /// What numbers without a name are called, before their count.
    unnamed: &'static str,
    count: usize,
    depth: usize,
    lines: Vec<EquationLine>,
}

impl<'a> Printer<'a> {
    /// Of a list whose first results have these names.
    fn new(
        list: &'a List,
        of_input: &'a dyn Fn(usize, &str) -> String,
        taken: HashSet<String>,
        results: &[String],
        unnamed: &'static str,
    ) -> Self {
        let mut reads = vec![0; list.operations.len()];
        let mut read = |node: Node| reads[node as usize] += 1;
        list.results.iter().flatten().for_each(|&node| read(node));
        for ListLoop { recorded, used, inner } in &list.loops {
            let stored = recorded.stores.iter().map(|store| store.number);
            let next = recorded.state.iter().zip(used).filter(|(_, used)| **used).map(|(state, _)| state.1);
            stored.chain(next).filter(|&node| node != Node::MAX).for_each(&mut read);
            // What is the same in every iteration is computed before them.
            let fixed = inner
                .iter()
                .copied()
                .filter(|&node| matches!(list.operations[node as usize], Operation::Unary(..) | Operation::Binary(..)));
            for node in fixed {
                list.operations[node as usize].operands(|operand| {
                    if !list.inner[operand as usize] {
                        read(operand);
                    }
                });
            }
        }
        for operation in &list.operations {
            match *operation {
                Operation::Root(number) => list.roots[number as usize].root.reads(&mut read),
                operation => operation.operands(&mut read),
            }
        }
        let (tables, names, inlined, written) = Default::default();
        let (count, depth, lines) = Default::default();
        let mut printer = Self { list, of_input, tables, reads, names, taken, inlined, written, unnamed, count, depth, lines };
        for (node, name) in list.results.iter().zip(results) {
            let Some(node) = *node else { continue };
            if !matches!(list.operations[node as usize], Operation::Input(_) | Operation::Constant(_) | Operation::Rolled(_)) {
                printer.names.entry(node).or_insert_with(|| name.clone());
            }
        }
        for (node, name) in list.names.iter().enumerate() {
            if let Some((name, _)) = name {
                printer.call(node as Node, name);
            }
        }
        printer
    }

    /// Gives a number a name, unless it has one or needs none.
    fn call(&mut self, node: Node, name: &str) {
        let is_leaf = matches!(self.list.operations[node as usize], Operation::Input(_) | Operation::Constant(_));
        if is_leaf || self.names.contains_key(&node) {
            return;
        }
        let mut free = name.to_owned();
        while !self.taken.insert(free.clone()) {
            free.push('\'');
        }
        self.names.insert(node, free);
    }

    fn name(&mut self, node: Node) -> String {
        if !self.names.contains_key(&node) {
            self.count += 1;
            self.call(node, &format!("{}{}", self.unnamed, self.count));
        }
        self.names[&node].clone()
    }

    /// Does a number stand in a line of its own?
    fn is_kept(&self, node: Node) -> bool {
        match self.list.operations[node as usize] {
            Operation::Input(_) | Operation::Constant(_) | Operation::Argument(_) => false,
            Operation::Rolled(Rolled::Folded(..) | Rolled::Written(..) | Rolled::Table(..) | Rolled::PutLast(..)) => true,
            Operation::Rolled(_) => false,
            Operation::Root(_) => true,
            _ => self.names.contains_key(&node) || self.reads[node as usize] > 1 && !self.inlined.contains(&node),
        }
    }

    /// Adds the lines of everything that is computed outside of roots and loops.
    fn kept_lines(&mut self) {
        let list = self.list;
        let nodes: Vec<Node> = (0..list.operations.len() as Node).filter(|&node| !list.inner[node as usize]).collect();
        self.lines_of(&nodes);
    }

    fn lines_of(&mut self, nodes: &[Node]) {
        for &node in nodes.iter() {
            if !self.is_kept(node) {
                continue;
            }
            if let Operation::Rolled(rolled) = self.list.operations[node as usize] {
                self.of_loop(rolled, node);
                continue;
            }
            let right = self.expression(node, LOOSE);
            if !self.names.contains_key(&node) && right.chars().count() <= SHORT {
                self.inlined.insert(node);
                continue;
            }
            let left = self.name(node);
            let source = self.list.names[node as usize].map_or("", |(_, source)| source);
            self.line(left, right, source);
            if let Operation::Root(number) = self.list.operations[node as usize] {
                self.depth += 1;
                let inner = self.list.roots[number as usize].inner.clone();
                self.lines_of(&inner);
                self.depth -= 1;
            }
        }
    }

    fn line(&mut self, left: String, right: String, source: &str) {
        self.lines.push(EquationLine { depth: self.depth, left, right, source: source.to_owned() });
    }

    /// The line of a result, unless it is that number itself.
    fn result(&mut self, node: Option<Node>, name: &str, source: &str) {
        let Some(node) = node else { return };
        let right = self.operand(node, LOOSE);
        if right != name {
            self.line(name.to_owned(), right, source);
        }
    }

    /// The text of a number: its name, or how it is computed, in parentheses if what stands around binds tighter.
    fn operand(&mut self, node: Node, around: u8) -> String {
        if self.is_kept(node) { self.name(node) } else { self.expression(node, around) }
    }

    fn expression(&mut self, node: Node, around: u8) -> String {
        let (text, binding) = match self.list.operations[node as usize] {
            Operation::Input(input) => ((self.of_input)(input.into(), ""), u8::MAX),
            Operation::Constant(bits) => constant(f64::from_bits(bits)),
            Operation::Argument(_) => ("x".to_owned(), u8::MAX),
            Operation::Root(number) => (self.root(number), u8::MAX),
            Operation::Unary(operation, a) => self.unary(operation, a),
            Operation::Binary(operation, a, b) => self.binary(operation, a, b),
            Operation::Select(margin, a, b) => {
                let test = match self.list.operations[margin as usize] {
                    Operation::Binary(Binary::Sub, left, right) if !self.is_kept(margin) => {
                        format!("{} >= {}", self.operand(left, SUM), self.operand(right, SUM))
                    }
                    Operation::Unary(Unary::Neg, of) if !self.is_kept(margin) => format!("{} <= 0", self.operand(of, SUM)),
                    _ => format!("{} >= 0", self.operand(margin, SUM)),
                };
                let [a, b] = [a, b].map(|node| self.operand(node, LOOSE));
                (format!("if({test}, {a}, {b})"), u8::MAX)
            }
            Operation::Rolled(rolled) => (self.rolled(rolled), u8::MAX),
        };
        if binding < around { format!("({text})") } else { text }
    }

    fn unary(&mut self, operation: Unary, a: Node) -> (String, u8) {
        let function = match operation {
            Unary::Neg => return (format!("-{}", self.operand(a, SIGN)), SIGN),
            Unary::Scale(power) if power < 0 => {
                return (format!("{} / {}", self.operand(a, PRODUCT), plain(2f64.powi(-i32::from(power)))), PRODUCT);
            }
            Unary::Scale(power) => return (format!("{} * {}", plain(2f64.powi(power.into())), self.operand(a, PRODUCT + 1)), PRODUCT),
            Unary::Sqrt => "sqrt",
            Unary::Abs => "abs",
            Unary::ExpM1 => "exp_m1",
            Unary::Ln1p => "ln_1p",
            Unary::Sin => "sin",
            Unary::Cos => "cos",
            Unary::Asin => "asin",
            Unary::Floor => "floor",
        };
        (format!("{function}({})", self.operand(a, LOOSE)), u8::MAX)
    }

    fn binary(&mut self, operation: Binary, a: Node, b: Node) -> (String, u8) {
        let (sign, binding) = match operation {
            Binary::Min | Binary::Max => {
                let [a, b] = [a, b].map(|node| self.operand(node, LOOSE));
                return (format!("{}({a}, {b})", if operation == Binary::Min { "min" } else { "max" }), u8::MAX);
            }
            // What is added with a minus sign is subtracted.
            Binary::Add | Binary::PlusWhole if self.negated(b).is_some() => {
                let of = self.negated(b).unwrap_or_default();
                return (format!("{} - {of}", self.operand(a, SUM)), SUM);
            }
            Binary::Mul if a == b => return (format!("{}^2", self.operand(a, POWER + 1)), POWER),
            Binary::Add | Binary::PlusWhole => ("+", SUM),
            Binary::Sub => ("-", SUM),
            Binary::Mul => ("*", PRODUCT),
            Binary::Div => ("/", PRODUCT),
        };
        (format!("{} {sign} {}", self.operand(a, binding), self.operand(b, binding + 1)), binding)
    }

    /// Without its minus sign, the text of a number that is written where it is read and has one.
    fn negated(&mut self, node: Node) -> Option<String> {
        if self.is_kept(node) {
            return None;
        }
        match self.list.operations[node as usize] {
            Operation::Unary(Unary::Neg, of) => Some(self.operand(of, SUM + 1)),
            Operation::Constant(bits) if f64::from_bits(bits) < 0.0 => Some(constant(-f64::from_bits(bits)).0),
            _ => None,
        }
    }

    fn root(&mut self, number: u8) -> String {
        let ListRoot { root, .. } = self.list.roots[number as usize];
        // Short parts of the function are written where they stand, as everywhere.
        let inner = self.list.roots[number as usize].inner.clone();
        for node in inner {
            if self.is_kept(node) && !self.names.contains_key(&node) && self.expression(node, LOOSE).chars().count() <= SHORT {
                self.inlined.insert(node);
            }
        }
        let [low, high, value] = [root.bracket.0, root.bracket.1, root.value].map(|node| self.operand(node, LOOSE));
        format!("root(x, {low}, {high}, {value})")
    }

    /// A number of a loop or table.
    fn rolled(&mut self, rolled: Rolled) -> String {
        match rolled {
            Rolled::Index(_) => "k".to_owned(),
            Rolled::State(number, at) | Rolled::Folded(number, at) => self.state(number, at),
            Rolled::Get(table, place) => self.entry(table, &index(place)),
            Rolled::GetAt(table, at) => {
                let at = self.operand(at, LOOSE);
                self.entry(table, &at)
            }
            // A device leaves it to f64, where it is a loop that this list does not have.
            Rolled::Unknown => "iterated_in_f64".to_owned(),
            Rolled::Table(table, _) | Rolled::Written(_, table, _) => self.table(table.into()),
            Rolled::PutLast(table, ..) => self.table(self.list.table(table)),
        }
    }

    fn table(&self, table: usize) -> String {
        self.tables.get(&table).cloned().unwrap_or_else(|| self.list.tables[table].name.to_owned())
    }

    fn entry(&mut self, table: Node, index: &str) -> String {
        match self.list.operations[table as usize] {
            Operation::Input(input) => (self.of_input)(input.into(), index),
            _ => format!("{}[{index}]", self.table(self.list.table(table))),
        }
    }

    fn state(&self, number: u8, at: u8) -> String {
        let names = self.list.loops[number as usize].recorded.names;
        names.get(usize::from(at)).map_or_else(|| format!("state_{number}_{at}"), |name| (*name).to_owned())
    }

    /// The lines of a loop, a table or what a loop leaves.
    fn of_loop(&mut self, rolled: Rolled, node: Node) {
        match rolled {
            Rolled::Table(table, fill) => {
                let (left, right) = (format!("{}[all]", self.table(table.into())), self.operand(fill, LOOSE));
                if right != "0" {
                    self.line(left, right, "");
                }
            }
            Rolled::PutLast(table, end, number) => {
                let [end, number] = [end, number].map(|node| self.operand(node, LOOSE));
                let left = format!("{}[{end}]", self.table(self.list.table(table)));
                self.line(left, number, "");
            }
            Rolled::Written(number, ..) => self.loop_once(number),
            Rolled::Folded(number, at) => {
                self.loop_once(number);
                let state = self.state(number, at);
                if self.names.get(&node).is_none_or(|name| *name != state) && !self.names.contains_key(&node) {
                    self.names.insert(node, state);
                }
            }
            _ => {}
        }
    }

    fn loop_once(&mut self, number: u8) {
        let list = self.list;
        if !self.written.insert(number) {
            return;
        }
        let ListLoop { recorded, used, inner } = &list.loops[number as usize];
        let states: Vec<usize> = (0..used.len()).filter(|&at| used[at]).collect();
        for &at in &states {
            let begin = self.operand(recorded.state[at].0, LOOSE);
            let left = self.state(number, at as u8);
            self.line(left, begin, "");
        }
        let end = self.operand(recorded.end, SUM);
        let first = recorded.first;
        let until = recorded.until_zero.map_or(String::new(), |at| format!(", until {} is 0", self.state(number, at)));
        let heading = if recorded.backwards {
            format!("for k from {end} - 1 down to {first}{until}:")
        } else {
            format!("for k from {first} to {end} - 1{until}:")
        };
        self.line(String::new(), heading, "");
        self.depth += 1;
        self.lines_of(inner);
        for &Store { table, place, number } in recorded.stores.iter().filter(|store| store.number != Node::MAX) {
            let right = self.operand(number, LOOSE);
            let left = format!("{}[{}]", self.table(table.into()), index(place));
            self.line(left, right, "");
        }
        for &at in &states {
            let right = self.operand(recorded.state[at].1, LOOSE);
            let left = format!("next {}", self.state(number, at as u8));
            self.line(left, right, "");
        }
        self.depth -= 1;
    }
}

/// A number, with how tightly its text binds.
fn constant(value: f64) -> (String, u8) {
    let text = match value {
        _ if value == PI => "pi".to_owned(),
        _ if value == 2.0 * PI => return ("2 * pi".to_owned(), PRODUCT),
        _ if value == PI / 2.0 => return ("pi / 2".to_owned(), PRODUCT),
        _ => plain(value),
    };
    (text, if value < 0.0 { SIGN } else { u8::MAX })
}

/// The index of a place in a table.
fn index(place: Place) -> String {
    match (place.of, place.number) {
        (None, number) => number.to_string(),
        (Some(_), 0) => "k".to_owned(),
        (Some(_), number) if number < 0 => format!("k - {}", -number),
        (Some(_), number) => format!("k + {number}"),
    }
}
