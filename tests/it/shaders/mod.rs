//! The shaders of the models: `shaders/models` must have what the program generates from the formulas.
//!
//! `shaders/write` writes them again.

use crate::every_function::every_function;
use beltspace::gpu::PointKernel;
use beltspace::models::{self, Model, Set};
use beltspace::real::{Place, Smoothness};
use beltspace::tape::{Binary, List, Node, Operation, Recording, Rolled, RolledLoop, Root, Store, Unary, wgsl};
use loops::{Held, Whole};
use std::collections::{BTreeMap, BTreeSet};
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use wgpu::naga;

mod loops;

/// Where a model's shader stands.
fn path(model: &Model) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders/models").join(format!("{}.wgsl", model.name))
}

/// The whole file.
fn expected(model: &Model) -> String {
    let formula = model.kernel.formula().expect("what is recorded is a formula");
    let source = format!("src/models/{}.rs", model.name.replace('-', "_"));
    let equations: Vec<_> = model.outputs.iter().map(|output| output.source.as_str()).collect();
    format!("// Generated from {source} by shaders/write.\n{}", wgsl::text(formula, model.conditions.len(), &equations))
}

fn recorded() -> impl Iterator<Item = &'static Arc<Model>> {
    models::all().iter().filter(|model| model.on_gpu)
}

#[test]
fn the_shaders_in_the_repository_are_those_of_the_formulas() {
    let writes = std::env::var_os("BELTSPACE_WRITE_SHADERS").is_some();
    let mut models = 0;
    for model in recorded() {
        let (path, text) = (path(model), expected(model));
        if writes {
            std::fs::write(&path, &text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        }
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(found == text, "{} is not what the formula gives: run shaders/write", path.display());
        models += 1;
    }
    assert!(models >= 3, "{models}");
}

/// What a function of a shader computes, as operations of a list.
struct Reader<'a> {
    module: &'a naga::Module,
    /// Operations of the list, and whatever else the text asks for.
    operations: &'a mut Recording,
    /// Fields of the two structures that a function is given, as operations.
    leaf: &'a dyn Fn(&str, &str) -> Operation,
    /// Calls that were read, but for those that make constants.
    calls: usize,
    /// What is wrong with a root.
    problem: Option<String>,
    /// The names of the tables, by number, and what each was last written as.
    tables: Vec<String>,
    /// How many numbers each of them has.
    lengths: Vec<usize>,
    versions: Vec<Node>,
    /// Of every loop: the numbers of its state that are in use.
    states: Vec<Vec<u8>>,
    /// The loop that is being read, and where its counter begins.
    open: Option<(u8, Whole)>,
    /// What ends it where it is zero.
    left_at_zero: Option<Node>,
}

/// The function that is being read, with the values of its arguments.
struct Body<'a> {
    function: &'a naga::Function,
    arguments: Vec<Value>,
    /// By the expression of its result: every call.
    calls: BTreeMap<usize, (naga::Handle<naga::Function>, Vec<naga::Handle<naga::Expression>>)>,
    /// What a root's function is asked at.
    argument: Option<Node>,
    /// Expressions that were read: each stands for one number, however often it is used.
    known: BTreeMap<usize, Value>,
    /// What its variables hold.
    held: BTreeMap<usize, Held>,
    /// What it has assigned to the fields of its result.
    results: BTreeMap<String, Node>,
}

#[derive(Clone, Debug)]
enum Value {
    Number(Node),
    /// A whole number that is none of the formula's.
    Whole(Whole),
    /// A structure that a function was given, by the argument's name.
    Given(String),
}

fn gather(block: &naga::Block, into: &mut BTreeMap<usize, (naga::Handle<naga::Function>, Vec<naga::Handle<naga::Expression>>)>) {
    for statement in block {
        match statement {
            naga::Statement::Call { function, arguments, result: Some(result) } => {
                into.insert(result.index(), (*function, arguments.clone()));
            }
            naga::Statement::Block(inner) => gather(inner, into),
            naga::Statement::Loop { body, continuing, .. } => [body, continuing].into_iter().for_each(|block| gather(block, into)),
            naga::Statement::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|block| gather(block, into)),
            _ => {}
        }
    }
}

/// A constant as f32 has it: the text knows no more of it.
fn constant(value: f32) -> Operation {
    Operation::Constant(f64::from(value).to_bits())
}

impl Reader<'_> {
    fn named(&self, name: &str) -> naga::Handle<naga::Function> {
        let found = self.module.functions.iter().find(|(_, function)| function.name.as_deref() == Some(name));
        found.unwrap_or_else(|| panic!("there is no function {name}")).0
    }

    fn literal(body: &Body<'_>, expression: naga::Handle<naga::Expression>) -> f32 {
        match body.function.expressions[expression] {
            naga::Expression::Literal(naga::Literal::F32(value)) => value,
            naga::Expression::Unary { op: naga::UnaryOperator::Negate, expr } => -Self::literal(body, expr),
            ref other => panic!("{other:?} is no literal"),
        }
    }

    fn number(&mut self, body: &mut Body<'_>, expression: naga::Handle<naga::Expression>) -> Node {
        let value = match body.known.get(&expression.index()) {
            Some(value) => value.clone(),
            None => self.value(body, expression),
        };
        body.known.insert(expression.index(), value.clone());
        match value {
            Value::Number(node) => node,
            other => panic!("{other:?} is no number"),
        }
    }

    fn push(&mut self, operation: Operation) -> Value {
        Value::Number(self.operations.push(operation))
    }

    /// An expression, with error bounds or in plain f32.
    fn value(&mut self, body: &mut Body<'_>, expression: naga::Handle<naga::Expression>) -> Value {
        use naga::{BinaryOperator as Of, Expression, MathFunction};
        match body.function.expressions[expression].clone() {
            Expression::FunctionArgument(number) => body.arguments[number as usize].clone(),
            // Value and bound of a number stand for it.
            Expression::AccessIndex { base, index } => match self.value(body, base) {
                Value::Given(structure) => {
                    let ty = body.function.arguments.iter().find(|it| it.name.as_deref() == Some(&structure)).expect("it is one").ty;
                    let naga::TypeInner::Struct { members, .. } = &self.module.types[ty].inner else { panic!("no structure") };
                    let field = members[index as usize].name.clone().expect("it has a name");
                    let operation = (self.leaf)(&structure, &field);
                    self.push(operation)
                }
                number => {
                    assert_eq!(index, 0, "nobody reads a bound");
                    number
                }
            },
            // The place of a search; other variables were read where the text does.
            Expression::Load { .. } => Value::Number(body.argument.expect("only a search has variables")),
            Expression::Compose { components, .. } => match body.function.expressions[components[1]] {
                // The bound is infinite.
                Expression::CallResult(_) => self.push(Operation::Rolled(Rolled::Unknown)),
                _ => self.push(constant(Self::literal(body, components[0]))),
            },
            Expression::Literal(naga::Literal::F32(value)) => self.push(constant(value)),
            Expression::CallResult(_) => self.called(body, expression),
            Expression::Unary { op: naga::UnaryOperator::Negate, expr } => match body.function.expressions[expr] {
                Expression::Literal(naga::Literal::F32(value)) => self.push(constant(-value)),
                _ => {
                    let a = self.number(body, expr);
                    self.push(Operation::Unary(Unary::Neg, a))
                }
            },
            Expression::Binary { op, left, right } => {
                let scale = match body.function.expressions[left] {
                    Expression::Literal(naga::Literal::F32(value)) if op == Of::Multiply => Some(value),
                    _ => None,
                };
                if let Some(factor) = scale {
                    let a = self.number(body, right);
                    return self.scaled(a, factor);
                }
                let (a, b) = (self.number(body, left), self.number(body, right));
                let of = match op {
                    Of::Add => Binary::Add,
                    Of::Subtract => Binary::Sub,
                    Of::Multiply => Binary::Mul,
                    Of::Divide => Binary::Div,
                    other => panic!("{other:?}"),
                };
                self.push(Operation::Binary(of, a, b))
            }
            Expression::Math { fun, arg, arg1, .. } => {
                let a = self.number(body, arg);
                match (fun, arg1) {
                    (MathFunction::Min, Some(b)) => {
                        let b = self.number(body, b);
                        self.push(Operation::Binary(Binary::Min, a, b))
                    }
                    // Under a root the clamp belongs to it.
                    (MathFunction::Max, Some(b)) if self.is_zero(body, b) => Value::Number(a),
                    (MathFunction::Max, Some(b)) => {
                        let b = self.number(body, b);
                        self.push(Operation::Binary(Binary::Max, a, b))
                    }
                    (MathFunction::Sqrt, None) => self.push(Operation::Unary(Unary::Sqrt, a)),
                    (MathFunction::Abs, None) => self.push(Operation::Unary(Unary::Abs, a)),
                    (MathFunction::Floor, None) => self.push(Operation::Unary(Unary::Floor, a)),
                    other => panic!("{other:?}"),
                }
            }
            other => panic!("{other:?} is not known"),
        }
    }

    fn is_zero(&self, body: &Body<'_>, expression: naga::Handle<naga::Expression>) -> bool {
        matches!(body.function.expressions[expression], naga::Expression::Literal(naga::Literal::F32(0.0)))
    }

    fn scaled(&mut self, a: Node, factor: f32) -> Value {
        let power = factor.log2() as i16;
        assert_eq!(2f32.powi(power.into()), factor);
        self.push(Operation::Unary(Unary::Scale(power), a))
    }

    /// The result of a call.
    fn called(&mut self, body: &mut Body<'_>, result: naga::Handle<naga::Expression>) -> Value {
        let (function, arguments) = body.calls[&result.index()].clone();
        let name = self.module.functions[function].name.clone().expect("functions have names");
        if name == "constant" {
            let inner = body.function.expressions[arguments[0]].clone();
            return match inner {
                // The place that a search ended at.
                naga::Expression::CallResult(_) => Value::Number(body.argument.expect("only a root has one")),
                naga::Expression::As { expr, .. } => match self.whole(body, expr) {
                    Whole::Place(Place { number: 0, of: Some(of) }) => self.push(Operation::Rolled(Rolled::Index(of))),
                    other => panic!("{other:?} is no place of a loop"),
                },
                _ => self.push(constant(Self::literal(body, arguments[0]))),
            };
        }
        if name == "if_known" {
            return self.if_known(body, arguments[0], arguments[1]);
        }
        if self.tables.contains(&name) {
            let first = (self.leaf)("p", &name);
            let at = self.whole(body, arguments[1]);
            return match (at, first) {
                (Whole::Literal(at), Operation::Input(first)) => self.push(Operation::Input(first + at as u16)),
                (Whole::Place(place), _) => {
                    let table = self.operations.push(first);
                    self.push(Operation::Rolled(Rolled::Get(table, place)))
                }
                (Whole::Of(index), _) => {
                    let table = self.operations.push(first);
                    self.push(Operation::Rolled(Rolled::GetAt(table, index)))
                }
                other => panic!("{other:?}"),
            };
        }
        let unary = [
            ("neg", Unary::Neg),
            ("sqrt_", Unary::Sqrt),
            ("abs_", Unary::Abs),
            ("exp_m1_", Unary::ExpM1),
            ("ln_1p_", Unary::Ln1p),
            ("sin_", Unary::Sin),
            ("cos_", Unary::Cos),
            ("asin_", Unary::Asin),
            ("floor_", Unary::Floor),
            ("twice", Unary::Scale(1)),
            ("half", Unary::Scale(-1)),
            ("exp_m1", Unary::ExpM1),
            ("ln_1p", Unary::Ln1p),
            ("sine", Unary::Sin),
            ("cosine", Unary::Cos),
            ("arc_sine", Unary::Asin),
        ];
        let binary = [
            ("add", Binary::Add),
            ("sub", Binary::Sub),
            ("mul", Binary::Mul),
            ("mul_or_zero", Binary::Mul),
            ("div", Binary::Div),
            ("min_", Binary::Min),
            ("max_", Binary::Max),
            ("plus_whole", Binary::PlusWhole),
        ];
        let found = unary.iter().find(|(it, _)| *it == name).map(|&(_, of)| of);
        let found_binary = binary.iter().find(|(it, _)| *it == name).map(|&(_, of)| of);
        if name == "scaled_" {
            let factor = Self::literal(body, arguments[1]);
            self.calls += 1;
            let a = self.number(body, arguments[0]);
            return self.scaled(a, factor);
        }
        let values: Vec<Node> = arguments.iter().map(|&argument| self.number(body, argument)).collect();
        self.calls += 1;
        match (found, found_binary, name.as_str()) {
            (Some(of), ..) => self.push(Operation::Unary(of, values[0])),
            (_, Some(of), _) => self.push(Operation::Binary(of, values[0], values[1])),
            (.., "square") => self.push(Operation::Binary(Binary::Mul, values[0], values[0])),
            (.., "select_") => self.push(Operation::Select(values[0], values[1], values[2])),
            (.., root) => self.root(root.to_owned(), &values),
        }
    }

    /// A root: its two functions must ask for the same, one in plain f32 and one with bounds.
    fn root(&mut self, name: String, values: &[Node]) -> Value {
        let number = u8::try_from(self.operations.roots.len()).expect("few roots");
        let argument = self.operations.push(Operation::Argument(number));
        let given: Vec<Value> = values.iter().map(|&node| Value::Number(node)).collect();
        let ends = |reader: &mut Self, function: &str, call: &str| -> Vec<Node> {
            let handle = reader.named(function);
            // The module outlives the reader: the body may be read while operations are pushed.
            let module = reader.module;
            let function = &module.functions[handle];
            let mut calls = BTreeMap::new();
            gather(&function.body, &mut calls);
            let (known, held, results) = Default::default();
            let mut body = Body { function, arguments: given.clone(), calls, argument: Some(argument), known, held, results };
            let of = body.calls.values().find(|(it, _)| module.functions[*it].name.as_deref() == Some(call)).expect("it is called").clone();
            of.1.iter().skip(usize::from(call != "begin_search")).map(|&it| reader.number(&mut body, it)).collect()
        };
        let near = name.replace("_root", "_near");
        let calls = self.calls;
        let bracket = ends(self, &near, "begin_search");
        let step = ["newton_step", "smooth_newton_step"].into_iter().find(|it| self.calls_of(&near).contains(*it)).expect("it searches");
        let plain = ends(self, &near, step);
        self.calls = calls;
        let bounded = ends(self, &name, "root");
        if plain != bounded {
            self.problem = Some(format!("{name}: the search asks for something else than its bound"));
        }
        self.operations.roots.push(Root {
            bracket: (bracket[0], bracket[1]),
            start: bracket[2],
            argument,
            value: bounded[0],
            slope: bounded[1],
            smoothness: if step == "newton_step" { Smoothness::Unknown } else { Smoothness::Smooth },
            function: None,
        });
        self.push(Operation::Root(number))
    }

    /// The names of the functions that a function calls.
    fn calls_of(&self, function: &str) -> BTreeSet<String> {
        let mut calls = BTreeMap::new();
        gather(&self.module.functions[self.named(function)].body, &mut calls);
        calls.values().filter_map(|(it, _)| self.module.functions[*it].name.clone()).collect()
    }

    /// What a function stores in a structure or array, by field name or index.
    fn results(&mut self, function: &str) -> BTreeMap<String, Node> {
        let module = self.module;
        let handle = self.named(function);
        let function = &module.functions[handle];
        let given = function.arguments.iter().map(|it| Value::Given(it.name.clone().expect("arguments have names"))).collect();
        let mut calls = BTreeMap::new();
        gather(&function.body, &mut calls);
        let (known, held, results) = Default::default();
        let mut body = Body { function, arguments: given, calls, argument: None, known, held, results };
        self.begin(&mut body);
        self.block(&mut body, &function.body);
        body.results
    }
}

/// A list as its text can tell it: constants as f32 has them, roots and loops that are in use, and where the results are.
struct Expected {
    recording: Recording,
    results: Vec<Node>,
    roots: Vec<Root>,
    loops: Vec<RolledLoop>,
    /// By table: what it was made as, if that is filled with zeros.
    tables: Vec<Node>,
    /// Of every loop: the numbers of its state that are in use.
    states: Vec<Vec<u8>>,
}

fn rounded(list: &List) -> Expected {
    let mut recording = Recording::default();
    let mut place: Vec<Node> = Vec::new();
    let mut tables = vec![Node::MAX; list.tables.len()];
    for &operation in &list.operations {
        let at = |node: Node| place[node as usize];
        let operation = match operation {
            Operation::Constant(bits) => constant(f64::from_bits(bits) as f32),
            Operation::Unary(of, a) => Operation::Unary(of, at(a)),
            Operation::Binary(of, a, b) => Operation::Binary(of, at(a), at(b)),
            Operation::Select(margin, a, b) => Operation::Select(at(margin), at(a), at(b)),
            Operation::Rolled(rolled) => Operation::Rolled(rolled.map(at)),
            other => other,
        };
        place.push(recording.push(operation));
        if let Operation::Rolled(Rolled::Table(table, fill)) = operation
            && recording.operations[fill as usize] == Operation::Constant(0)
        {
            tables[usize::from(table)] = place[place.len() - 1];
        }
    }
    let at = |node: Node| place[node as usize];
    let root = |Root { bracket, start, argument, value, slope, smoothness, .. }| Root {
        bracket: (at(bracket.0), at(bracket.1)),
        start: at(start),
        argument: at(argument),
        value: at(value),
        slope: at(slope),
        smoothness,
        // No shader is told of it.
        function: None,
    };
    let used = |number: &usize| list.operations.contains(&Operation::Root(*number as u8));
    let roots = (0..list.roots.len()).filter(used).map(|number| root(list.roots[number].root)).collect();
    let in_use = |used: &[bool]| (0..used.len()).filter(|&at| used[at]).collect::<Vec<_>>();
    let one = |it: &beltspace::tape::ListLoop| RolledLoop {
        end: at(it.recorded.end),
        state: in_use(&it.used).into_iter().map(|number| it.recorded.state[number]).map(|(begin, next)| (at(begin), at(next))).collect(),
        names: &[],
        stores: it.recorded.stores.iter().map(|store| Store { number: at(store.number), ..*store }).collect(),
        ..it.recorded.clone()
    };
    let states = list.loops.iter().map(|it| in_use(&it.used).into_iter().map(|number| number as u8).collect()).collect();
    let results = list.results.iter().flatten().map(|&node| at(node)).collect();
    let loops = list.loops.iter().map(one).collect();
    Expected { recording, results, roots, loops, tables, states }
}

/// Reads a stage back, and says what differs. `fields` are the names of its results, then those of its tables by number.
fn difference(
    source: &str,
    function: &str,
    list: &List,
    fields: &[String],
    tables: &[String],
    leaf: &dyn Fn(&str, &str) -> Operation,
) -> Option<String> {
    let module = naga::front::wgsl::parse_str(source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)));
    let Expected { mut recording, results: expected, roots, loops, tables: versions, states } = rounded(list);
    let before = recording.operations.len();
    let (open, left_at_zero, problem) = Default::default();
    let (calls, tables) = (0, tables.to_vec());
    let lengths = list.tables.iter().map(|table| table.length).collect();
    let operations = &mut recording;
    let mut reader = Reader { module: &module, operations, leaf, calls, problem, tables, lengths, versions, states, open, left_at_zero };
    let found = reader.results(function);
    let (calls, versions) = (reader.calls, reader.versions.clone());
    if reader.problem.is_some() {
        return reader.problem;
    }
    if recording.operations.len() != before {
        return Some(format!("it asks for {:?} and more", recording.operations[before]));
    }
    let is_call = |operation: &&Operation| {
        use Operation::{Argument, Constant, Input, Rolled};
        !matches!(operation, Input(_) | Constant(_) | Argument(_) | Rolled(_))
    };
    let asked = list.operations.iter().filter(is_call).count();
    if calls != asked {
        return Some(format!("{calls} calls for {asked} operations"));
    }
    for (field, expected) in fields.iter().zip(&expected) {
        if found.get(field) != Some(expected) {
            return Some(format!("{field} is another number"));
        }
    }
    if found.len() != fields.len() {
        return Some(format!("{} results for {}", found.len(), fields.len()));
    }
    if let Some(table) = expected[fields.len()..].iter().find(|it| !versions.contains(it)) {
        return Some(format!("no table is {:?}", recording.operations[*table as usize]));
    }
    if recording.roots != roots {
        return Some(format!("it looks for {:?}, not for {roots:?}", recording.roots));
    }
    (recording.loops != loops).then(|| format!("its loops are {:?}, not {loops:?}", recording.loops))
}

/// What differs between a model's shader, with a piece of its text replaced, and the recorded formula.
fn differences(model: &Model, piece: &str, other: &str) -> Vec<String> {
    let source = PointKernel::source(model, &[]).expect("it has a kernel");
    assert!(source.contains(piece), "{}: {piece}", model.name);
    let source = source.replacen(piece, other, 1);
    let formula = model.kernel.formula().expect("it is a formula");
    let names = formula.fields();
    let inputs = names.inputs.len();
    let number = |list: &[&str], field: &str| list.iter().position(|it| *it == field);
    let leaf = |structure: &str, field: &str| {
        let at = match structure {
            "i" => number(names.inputs, field),
            _ => number(names.prepared, field).map(|at| inputs + at).or_else(|| {
                let table = names.tables.iter().position(|(table, _)| *table == field)?;
                names.places().nth(names.prepared.len() + table).map(|(first, _)| inputs + first)
            }),
        };
        Operation::Input(at.expect("it is a field") as u16)
    };
    let (first, second) = formula.stages(Set::ALL, Set::ALL);
    let of = |recording: &Recording, nodes: &[Node]| List::cut(recording, &nodes.iter().copied().map(Some).collect::<Vec<_>>());
    let texts = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
    let numbers: Vec<String> = (0..model.conditions.len()).map(|it| it.to_string()).collect();
    [
        ("prepare", of(&first.recording, &first.prepared), texts(names.prepared)),
        ("conditions", of(&second.recording, &second.conditions[..model.conditions.len()]), numbers),
        ("finish", of(&second.recording, &second.outputs), texts(names.outputs)),
    ]
    .into_iter()
    .filter_map(|(function, list, fields)| {
        // Tables of the first stage that are passed on have the names of the fields; the second stage reads these.
        let mut tables: Vec<String> = list.tables.iter().map(|table| table.name.to_owned()).collect();
        let passed = names.tables.iter().map(|&(table, _)| table.to_owned());
        if function == "prepare" {
            let results = list.results[names.prepared.len()..].iter().flatten();
            results.zip(passed).for_each(|(&result, table)| tables[list.table(result)] = table);
        } else {
            tables.extend(passed);
        }
        difference(&source, function, &list, &fields, &tables, &leaf).map(|what| format!("{}: {function}: {what}", model.name))
    })
    .collect()
}

#[test]
fn a_shader_has_exactly_the_operations_of_the_formula() {
    for model in recorded() {
        assert_eq!(differences(model, "", ""), Vec::<String>::new());
    }
}

#[test]
fn another_loop_in_a_shader_is_noticed() {
    let belt = models::find("timing-belt").expect("it is a model");
    for (piece, other) in [
        ("var place_0 = 1u;", "var place_0 = 2u;"),
        ("left_1 > 0u", "left_1 > 1u"),
        ("min(whole(i.teeth_in_mesh), 60u)", "min(whole(i.teeth_in_mesh), 59u)"),
        ("tight[place_0 + 1u]", "tight[place_0]"),
        ("set_star_slack(place_1, t_star_slack)", "set_star_slack(place_1, t_star_tight)"),
        ("set_star_tight(min(whole(i.teeth_in_mesh)", "set_star_slack(min(whole(i.teeth_in_mesh)"),
        ("set_own_slack(min(whole(i.teeth_in_mesh), 60u)", "set_own_slack(min(whole(i.teeth_in_mesh), 61u)"),
        ("set_own_slack(min(whole(i.teeth_in_mesh), 60u)", "set_own_slack(whole(i.teeth_in_mesh)"),
        ("tight_before = ", "short_before = "),
        ("inward_slack(p, place_0)", "inward_tight(p, place_0)"),
        ("star_tight(p, whole(", "star_slack(p, whole("),
        ("if is_zero(meshes)", "if is_zero(counted)"),
        ("least = min_(least, ", "least = max_(least, "),
    ] {
        assert!(PointKernel::source(&belt, &[]).expect("it has a kernel").contains(piece), "{piece}");
        // What is no loop of a formula at all is refused where it is read.
        let noticed = std::panic::catch_unwind(AssertUnwindSafe(|| !differences(&belt, piece, other).is_empty()));
        assert!(noticed.unwrap_or(true), "{piece} -> {other}");
    }
}

#[test]
fn another_operation_in_a_shader_is_noticed() {
    let metal = models::all().iter().find(|model| model.name == "metal-cvt").expect("it is a model");
    for (piece, other) in [
        ("sub(driven_radius", "add(driven_radius"),
        ("constant(2.0)", "constant(2.5)"),
        ("twice(lean_)", "half(lean_)"),
        ("= smooth_newton_step(", "= newton_step("),
        ("(0.0, largest_radius", "(1.0, largest_radius"),
        ("(straight + ", "(straight - "),
        ("p.traction = traction;", "p.traction = i.traction;"),
        ("out.entry_compression = p.entry_compression;", ""),
        ("mul(i.ratio, driver_radius)", "mul(driver_radius, i.ratio)"),
    ] {
        assert_ne!(differences(metal, piece, other), Vec::<String>::new(), "{piece} -> {other}");
    }
}

#[test]
fn a_shader_has_the_elementary_functions_as_the_operations_that_they_are_made_of() {
    let model = every_function();
    assert_eq!(differences(&model, "", ""), Vec::<String>::new());
    let source = PointKernel::source(&model, &[]).expect("it has a kernel");
    naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
        .validate(&naga::front::wgsl::parse_str(&source).expect("it is WGSL"))
        .expect("it is right");
}

#[test]
fn another_operation_of_an_elementary_function_in_a_shader_is_noticed() {
    let model = every_function();
    for (piece, other) in [
        ("floor_(i.step)", "abs_(i.step)"),
        ("floor((9.536743e-7 * x))", "abs((9.536743e-7 * x))"),
        ("out.ceil = neg(", "out.ceil = abs_("),
        ("constant(709.0)", "constant(708.0)"),
        ("max_(i.x, ", "min_(i.x, "),
    ] {
        assert_ne!(differences(&model, piece, other), Vec::<String>::new(), "{piece} -> {other}");
    }
}
