//! A recorded formula as text in WGSL: the functions `prepare`, `conditions` and `finish` of a model.
//!
//! Every operation of the list is one call of a function in `shaders/common/numbers.wgsl`, which computes in f32 with an error bound; the text
//! of a first stage can be rewritten for f64.
//! What the formula names, and what is read more than once, stands in a line of its own. A root is found in plain f32, and its bound
//! comes from one evaluation of its function there.

mod calls;
mod lines;
mod loops;

use super::{Binary, Fields, List, ListRoot, Node, Onwards, Operation, Recordable, Rolled, Root, StageLists};
use crate::real::Smoothness;
use calls::{bounded_binary, bounded_unary, constant, plain_binary, plain_unary};
use lines::put;

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

/// What the functions of every kernel are called, and what WGSL keeps for itself: no number may be.
const TAKEN: &[&str] = &[
    "a",
    "abs",
    "add",
    "cosine",
    "const",
    "cos",
    "div",
    "exp",
    "f32",
    "floor",
    "floor_",
    "fn",
    "half",
    "i",
    "in",
    "last",
    "let",
    "log",
    "loop",
    "max",
    "min",
    "mul",
    "mul_or_zero",
    "near",
    "neg",
    "number",
    "out",
    "p",
    "pow",
    "root",
    "round",
    "same",
    "scaled_",
    "search",
    "select",
    "sin",
    "sine",
    "sqrt",
    "square",
    "step",
    "sub",
    "tan",
    "twice",
    "value",
    "var",
    "x",
];

/// The precision of a function's constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Precision {
    /// As f32 has them, with what it loses.
    Single,
    /// As they are.
    Double,
}

/// How a list's numbers are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Arithmetic {
    /// With error bounds, by the functions of the shared text.
    Bounded,
    /// In plain f32, inside the search for a root.
    Plain,
}

/// The text of a model's formula with so many conditions; `equations` has where each output comes from, as far as that is known.
pub fn text(formula: &dyn Recordable, conditions: usize, equations: &[&str]) -> String {
    stages_text(&OWN, &formula.fields(), &StageLists::whole(formula, conditions), equations)
}

/// What the functions and structures of a formula are called in a kernel.
#[derive(Clone, Copy, Debug)]
pub struct StageNames {
    /// The function of the first stage.
    pub prepare: &'static str,
    /// What it gives.
    pub prepared: &'static str,
    /// The function of the conditions' margins.
    pub conditions: &'static str,
    /// The number of these.
    pub count: &'static str,
    /// The function of the second stage.
    pub finish: &'static str,
    /// What it gives.
    pub outputs: &'static str,
}

/// The names of a kernel's own formula.
pub const OWN: StageNames = StageNames {
    prepare: "prepare",
    prepared: "Prepared",
    conditions: "conditions",
    count: "CONDITIONS",
    finish: "finish",
    outputs: "Outputs",
};

/// The same of a formula's lists.
pub fn stages_text(names: &StageNames, fields: &Fields, lists: &StageLists, equations: &[&str]) -> String {
    first_stage(names, fields, &lists.first, Precision::Single) + &second_stage(names, fields, lists, equations)
}

/// The first stage alone, with its constants in all their digits, to be rewritten for f64. `None` if it has loops or tables.
pub fn first_stage_in_f64(names: &StageNames, fields: &Fields, list: &List) -> Option<String> {
    let is_rolled = |operation: &Operation| matches!(operation, Operation::Rolled(_));
    let plain = fields.tables.is_empty() && !list.operations.iter().any(is_rolled);
    plain.then(|| first_stage(names, fields, list, Precision::Double))
}

fn first_stage(names: &StageNames, fields: &Fields, list: &List, precision: Precision) -> String {
    let leaf = |input: usize, _: &str| format!("i.{}", fields.inputs[input]);
    let results: Vec<Assignment> =
        fields.prepared.iter().map(|field| Assignment { to: format!("p.{field}"), name: field, equation: "" }).collect();
    let StageNames { prepare, prepared, .. } = names;
    let mut writer = Writer { precision, ..Writer::new(prepare, fields, list, &leaf, &results) };
    for (&result, (table, _)) in list.results[results.len()..].iter().flatten().zip(fields.tables) {
        writer.tables.insert(list.table(result), table);
    }
    writer.function(&format!("{prepare}(i: Inputs) -> {prepared}"), &format!("var p: {prepared};"), &results, "return p;");
    writer.text()
}

/// The text of a second stage.
pub fn second_stage(names: &StageNames, fields: &Fields, lists: &StageLists, equations: &[&str]) -> String {
    second_stage_of(names, fields, [&lists.conditions, &lists.finish], equations, None)
}

/// The text of a second stage from one number on.
pub fn onwards(names: &StageNames, fields: &Fields, onwards: &Onwards, equations: &[&str]) -> String {
    let passed = fields.prepared.iter().position(|field| *field == onwards.field).expect("the number is one of the fields");
    let number = u16::try_from(fields.inputs.len() + passed).expect("there are few");
    second_stage_of(names, fields, [&onwards.conditions, &onwards.finish], equations, Some(number))
}

fn second_stage_of(
    names: &StageNames,
    fields: &Fields,
    [of_margins, of_outputs]: [&List; 2],
    equations: &[&str],
    plateau: Option<u16>,
) -> String {
    let StageNames { prepared, conditions: of_conditions, count, finish: of_finish, outputs, .. } = names;
    let inputs = fields.inputs.len();
    let fields_passed: Vec<(usize, usize)> = fields.places().collect();
    // A number of a table by what is to be added to its first place.
    let leaf = |input: usize, index: &str| match input.checked_sub(inputs) {
        None => format!("i.{}", fields.inputs[input]),
        Some(passed) => match fields.prepared.get(passed) {
            Some(field) => format!("p.{field}"),
            None => {
                let in_table = |(_, (first, length)): &(usize, &(usize, usize))| (*first..first + length).contains(&passed);
                let (field, (first, _)) = fields_passed.iter().enumerate().find(in_table).expect("it is in a table");
                let index = if index.is_empty() { format!("{}u", passed - first) } else { index.to_owned() };
                format!("{}(p, {index})", fields.tables[field - fields.prepared.len()].0)
            }
        },
    };
    let margin = |number: usize| Assignment { to: format!("margins[{number}]"), name: "", equation: "" };
    let lines: Vec<Assignment> = (0..of_margins.results.len()).map(margin).collect();
    let mut conditions = Writer { plateau, ..Writer::new(of_conditions, fields, of_margins, &leaf, &lines) };
    let margins = format!("array<Real, {count}>");
    let head = format!("{of_conditions}(p: {prepared}, i: Inputs) -> {margins}");
    conditions.function(&head, &format!("var margins: {margins};"), &lines, "return margins;");
    let line = |(number, field): (usize, &&'static str)| Assignment {
        to: format!("out.{field}"),
        name: field,
        equation: equations.get(number).copied().unwrap_or_default(),
    };
    let lines: Vec<Assignment> = fields.outputs.iter().enumerate().map(line).collect();
    let mut finish = Writer { plateau, ..Writer::new(of_finish, fields, of_outputs, &leaf, &lines) };
    let head = format!("{of_finish}(p: {prepared}, i: Inputs) -> {outputs}");
    finish.function(&head, &format!("var out: {outputs};"), &lines, "return out;");
    conditions.text() + &finish.text()
}

/// Where a result goes.
struct Assignment<'a> {
    /// The place that it is assigned to.
    to: String,
    /// What it is called; empty for one without a name.
    name: &'a str,
    /// The equation that it comes from; empty for none.
    equation: &'a str,
}

struct Writer<'a> {
    /// The function that is written.
    stage: &'static str,
    precision: Precision,
    list: &'a List,
    /// What an input is called; of one in a table, given the index.
    leaf: &'a dyn Fn(usize, &str) -> String,
    /// Tables that are passed on to the second stage; others are variables of the function.
    tables: HashMap<usize, &'static str>,
    /// Loops that are written already.
    written: HashSet<u8>,
    /// An input that may be exactly zero.
    plateau: Option<u16>,
    /// How often each number is read.
    reads: Vec<u32>,
    /// What each number that is kept is called.
    names: HashMap<Node, String>,
    /// Numbers that the function is given, and what they are called there.
    given: HashMap<Node, String>,
    taken: HashSet<String>,
    /// The functions of roots, which come first.
    roots: String,
    text: String,
}

impl<'a> Writer<'a> {
    fn new(
        stage: &'static str,
        fields: &Fields,
        list: &'a List,
        leaf: &'a dyn Fn(usize, &str) -> String,
        results: &[Assignment<'_>],
    ) -> Self {
        let mut reads = vec![0; list.operations.len()];
        let mut read = |node: Node| reads[node as usize] += 1;
        list.results.iter().flatten().for_each(|&node| read(node));
        for it in &list.loops {
            let stored = it.recorded.stores.iter().map(|store| store.number);
            let next = it.recorded.state.iter().zip(&it.used).filter(|(_, used)| **used).map(|(state, _)| state.1);
            stored.chain(next).filter(|&node| node != Node::MAX).for_each(&mut read);
            // What is the same in every iteration is computed before them.
            for &node in &it.inner {
                list.operations[node as usize].operands(|operand| {
                    if !list.inner[operand as usize] {
                        read(operand);
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
        let tables = fields.tables.iter().map(|&(table, _)| table).chain(list.tables.iter().map(|table| table.name));
        let taken = TAKEN.iter().copied().chain(tables).map(str::to_owned).collect();
        let (roots, text, tables, written, names, given) = Default::default();
        let mut writer = Self {
            stage,
            precision: Precision::Single,
            list,
            leaf,
            tables,
            written,
            plateau: None,
            reads,
            names,
            given,
            taken,
            roots,
            text,
        };
        for (node, name) in list.names.iter().enumerate() {
            if let Some((name, _)) = name {
                writer.call(node as Node, name);
            }
        }
        for (node, operation) in list.operations.iter().enumerate() {
            if let Operation::Rolled(Rolled::State(number, at)) = *operation
                && let Some(name) = list.loops[number as usize].recorded.names.get(at as usize)
            {
                writer.call(node as Node, name);
            }
        }
        for (line, node) in results.iter().zip(&list.results) {
            if let Some(node) = *node
                && writer.reads[node as usize] > 1
                && !line.name.is_empty()
            {
                writer.call(node, line.name);
            }
        }
        writer
    }

    /// Gives a number a name, unless it has one or needs none.
    fn call(&mut self, node: Node, name: &str) {
        if self.names.contains_key(&node) || matches!(self.list.operations[node as usize], Operation::Input(_) | Operation::Constant(_)) {
            return;
        }
        let mut free = name.to_owned();
        while !self.taken.insert(free.clone()) {
            free.push('_');
        }
        self.names.insert(node, free);
    }

    /// The name of a number that is kept.
    fn name(&mut self, node: Node) -> String {
        self.call(node, &format!("n{node}"));
        self.names[&node].clone()
    }

    /// Is a number written in a line of its own?
    fn is_kept(&self, node: Node) -> bool {
        match self.list.operations[node as usize] {
            Operation::Input(_) | Operation::Constant(_) | Operation::Argument(_) => false,
            Operation::Rolled(Rolled::Index(_) | Rolled::Unknown) => false,
            Operation::Root(_) | Operation::Rolled(_) => true,
            _ => self.reads[node as usize] > 1 || self.names.contains_key(&node),
        }
    }

    /// The text of a number: its name, or how it is computed.
    fn operand(&mut self, node: Node, arithmetic: Arithmetic) -> String {
        match self.given.get(&node) {
            Some(name) => name.clone(),
            None if self.is_kept(node) => self.name(node),
            None => self.expression(node, arithmetic),
        }
    }

    /// How a number is computed.
    fn expression(&mut self, node: Node, arithmetic: Arithmetic) -> String {
        match self.list.operations[node as usize] {
            Operation::Input(input) => (self.leaf)(input.into(), ""),
            Operation::Rolled(rolled) => self.rolled(rolled),
            Operation::Constant(bits) => constant(f64::from_bits(bits), arithmetic, self.precision),
            Operation::Argument(_) => "x".to_owned(),
            Operation::Root(number) => self.root(node, number, arithmetic),
            Operation::Unary(operation, a) => {
                let a = self.operand(a, arithmetic);
                if arithmetic == Arithmetic::Bounded { bounded_unary(operation, &a) } else { plain_unary(operation, &a) }
            }
            Operation::Binary(Binary::Mul, a, b) if a == b && arithmetic == Arithmetic::Bounded => {
                format!("square({})", self.operand(a, arithmetic))
            }
            Operation::Binary(Binary::Mul, a, b) if arithmetic == Arithmetic::Bounded && (self.may_be_zero(a) || self.may_be_zero(b)) => {
                format!("mul_or_zero({}, {})", self.operand(a, arithmetic), self.operand(b, arithmetic))
            }
            Operation::Binary(operation, a, b) => {
                let (a, b) = (self.operand(a, arithmetic), self.operand(b, arithmetic));
                if arithmetic == Arithmetic::Bounded { bounded_binary(operation, &a, &b) } else { plain_binary(operation, &a, &b) }
            }
            Operation::Select(margin, a, b) => {
                let [margin, a, b] = [margin, a, b].map(|node| self.operand(node, arithmetic));
                match arithmetic {
                    Arithmetic::Bounded => format!("select_({margin}, {a}, {b})"),
                    Arithmetic::Plain => format!("select({b}, {a}, {margin} >= 0.0)"),
                }
            }
        }
    }

    /// Does the formula make a number exactly zero somewhere: by a clamp at zero, or as a product with one?
    fn may_be_zero(&self, node: Node) -> bool {
        let is_zero = |node: Node| self.list.operations[node as usize] == Operation::Constant(0);
        match self.list.operations[node as usize] {
            Operation::Input(input) => self.plateau == Some(input),
            Operation::Binary(Binary::Max | Binary::Min, a, b) => is_zero(a) || is_zero(b),
            Operation::Binary(Binary::Mul, a, b) => self.may_be_zero(a) || self.may_be_zero(b),
            _ => false,
        }
    }

    /// The lines that keep these numbers, operands first.
    fn lines(&mut self, nodes: &[Node], arithmetic: Arithmetic, indent: &str) -> String {
        let mut text = String::new();
        for &node in nodes {
            if let Operation::Rolled(rolled) = self.list.operations[node as usize]
                && let Some(statement) = self.statement(rolled, node, indent)
            {
                text.push_str(&statement);
                continue;
            }
            let expression = self.expression(node, arithmetic);
            let name = self.name(node);
            let equation = self.list.names[node as usize].map_or("", |(_, equation)| equation);
            put(&mut text, indent, &format!("let {name} = {expression};"), equation);
        }
        text
    }

    /// Writes a function that assigns the results.
    fn function(&mut self, head: &str, begin: &str, results: &[Assignment<'_>], end: &str) {
        let list = self.list;
        let kept: Vec<Node> = (0..list.operations.len() as Node).filter(|&node| !list.inner[node as usize] && self.is_kept(node)).collect();
        let lines = self.lines(&kept, Arithmetic::Bounded, "    ");
        let mut text = format!("\nfn {head} {{\n{lines}    {begin}\n");
        for (line, node) in results.iter().zip(&list.results) {
            if let Some(node) = *node {
                let value = self.operand(node, Arithmetic::Bounded);
                put(&mut text, "    ", &format!("{} = {value};", line.to), line.equation);
            }
        }
        write!(text, "    {end}\n}}\n").expect("a text takes everything");
        self.text.push_str(&text);
    }

    /// The functions that find a root, and the call of one.
    fn root(&mut self, node: Node, number: u8, arithmetic: Arithmetic) -> String {
        let list = self.list;
        let ListRoot { root: Root { bracket, start, argument, value, slope, smoothness, .. }, inner } = &list.roots[number as usize];
        let own = self.name(node);
        let name = format!("{}_{own}", self.stage);
        // What the root and its function read, besides what depends on where the function is asked.
        let mut outside = Vec::new();
        let mut read = |node: Node| {
            let is_constant = matches!(list.operations[node as usize], Operation::Constant(_));
            if !is_constant && node != *argument && !inner.contains(&node) && !outside.contains(&node) {
                outside.push(node);
            }
        };
        list.roots[number as usize].root.reads(&mut read);
        inner.iter().for_each(|&node| list.operations[node as usize].operands(&mut read));
        let given: Vec<String> = outside.iter().map(|&node| self.operand(node, arithmetic)).collect();
        let call = format!("{name}_{}({})", if arithmetic == Arithmetic::Bounded { "root" } else { "near" }, given.join(", "));
        if self.roots.contains(&format!("fn {name}_near(")) {
            return call;
        }

        let mut inside = Writer {
            stage: self.stage,
            precision: self.precision,
            list,
            leaf: self.leaf,
            tables: HashMap::new(),
            written: HashSet::new(),
            plateau: self.plateau,
            reads: self.reads.clone(),
            names: self.names.clone(),
            given: HashMap::new(),
            taken: self.taken.clone(),
            roots: String::new(),
            text: String::new(),
        };
        let mut names = Vec::new();
        for (at, &node) in outside.iter().enumerate() {
            let mut own = match (list.operations[node as usize], self.names.get(&node)) {
                (_, Some(name)) => name.clone(),
                (Operation::Input(input), _) => (self.leaf)(input.into(), "").rsplit('.').next().unwrap_or_default().to_owned(),
                _ => format!("given_{at}"),
            };
            if !self.names.contains_key(&node) {
                while !inside.taken.insert(own.clone()) {
                    own.push('_');
                }
            }
            inside.given.insert(node, own.clone());
            names.push(own);
        }
        let kept: Vec<Node> = inner.iter().copied().filter(|&node| inside.is_kept(node)).collect();
        let [low, high, first] = [bracket.0, bracket.1, *start].map(|node| inside.operand(node, Arithmetic::Plain));
        let plain = inside.lines(&kept, Arithmetic::Plain, "        ");
        let step = match smoothness {
            Smoothness::Smooth => "smooth_newton_step",
            Smoothness::Unknown => "newton_step",
        };
        let [near_value, near_slope] = [*value, *slope].map(|node| inside.operand(node, Arithmetic::Plain));
        let bounded = inside.lines(&kept, Arithmetic::Bounded, "    ");
        let [value, slope] = [*value, *slope].map(|node| inside.operand(node, Arithmetic::Bounded));
        let parameters = |of: &str| names.iter().map(|name| format!("{name}: {of}")).collect::<Vec<_>>().join(", ");
        let values = names.iter().map(|name| format!("{name}.value")).collect::<Vec<_>>().join(", ");
        let mut text = String::new();
        put(&mut text, "\n", &format!("fn {name}_near({}) -> f32 {{", parameters("f32")), "");
        put(&mut text, "    ", &format!("var search = begin_search({low}, {high}, {first});"), "");
        text.push_str("    for (var i = 0; i < NEWTON_STEPS && !search.done; i++) {\n        let x = search.x;\n");
        text.push_str(&plain);
        put(&mut text, "        ", &format!("search = {step}(search, {near_value}, {near_slope});"), "");
        text.push_str("    }\n    return search.x;\n}\n");
        put(&mut text, "\n", &format!("fn {name}_root({}) -> Real {{", parameters("Real")), "");
        put(&mut text, "    ", &format!("let x = constant({name}_near({values}));"), "");
        text.push_str(&bounded);
        put(&mut text, "    ", &format!("return root(x.value, {value}, {slope});"), "");
        text.push_str("}\n");
        self.roots.push_str(&inside.roots);
        self.roots.push_str(&text);
        call
    }

    fn text(self) -> String {
        self.roots + &self.text
    }
}
