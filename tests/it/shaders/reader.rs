//! Reads a function of a shader back, as operations of a list.

use super::loops::{Held, Whole};
use beltspace::real::{Place, Smoothness};
use beltspace::tape::{Binary, Node, Operation, Recording, Rolled, Root, Unary};
use std::collections::{BTreeMap, BTreeSet};
use wgpu::naga;

/// What a function of a shader computes, as operations of a list.
pub struct Reader<'a> {
    pub module: &'a naga::Module,
    /// Operations of the list, and whatever else the text asks for.
    pub operations: &'a mut Recording,
    /// Fields of the two structures that a function is given, as operations.
    pub leaf: &'a dyn Fn(&str, &str) -> Operation,
    /// Calls that were read, but for those that make constants.
    pub calls: usize,
    /// What is wrong with a root.
    pub problem: Option<String>,
    /// The names of the tables, by number, and what each was last written as.
    pub tables: Vec<String>,
    /// How many numbers each of them has.
    pub lengths: Vec<usize>,
    pub versions: Vec<Node>,
    /// Of every loop: the numbers of its state that are in use.
    pub states: Vec<Vec<u8>>,
    /// The loop that is being read, and where its counter begins.
    pub open: Option<(u8, Whole)>,
    /// What ends it where it is zero.
    pub left_at_zero: Option<Node>,
}

/// The function that is being read, with the values of its arguments.
pub struct Body<'a> {
    pub function: &'a naga::Function,
    pub arguments: Vec<Value>,
    /// By the expression of its result: every call.
    pub calls: BTreeMap<usize, (naga::Handle<naga::Function>, Vec<naga::Handle<naga::Expression>>)>,
    /// What a root's function is asked at.
    pub argument: Option<Node>,
    /// Expressions that were read: each stands for one number, however often it is used.
    pub known: BTreeMap<usize, Value>,
    /// What its variables hold.
    pub held: BTreeMap<usize, Held>,
    /// What it has assigned to the fields of its result.
    pub results: BTreeMap<String, Node>,
}

#[derive(Clone, Debug)]
pub enum Value {
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
pub fn constant(value: f32) -> Operation {
    Operation::Constant(f64::from(value).to_bits())
}

impl Reader<'_> {
    pub fn named(&self, name: &str) -> naga::Handle<naga::Function> {
        let found = self.module.functions.iter().find(|(_, function)| function.name.as_deref() == Some(name));
        found.unwrap_or_else(|| panic!("there is no function {name}")).0
    }

    pub fn literal(body: &Body<'_>, expression: naga::Handle<naga::Expression>) -> f32 {
        match body.function.expressions[expression] {
            naga::Expression::Literal(naga::Literal::F32(value)) => value,
            naga::Expression::Unary { op: naga::UnaryOperator::Negate, expr } => -Self::literal(body, expr),
            ref other => panic!("{other:?} is no literal"),
        }
    }

    pub fn number(&mut self, body: &mut Body<'_>, expression: naga::Handle<naga::Expression>) -> Node {
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

    pub fn push(&mut self, operation: Operation) -> Value {
        Value::Number(self.operations.push(operation))
    }

    /// An expression, with error bounds or in plain f32.
    pub fn value(&mut self, body: &mut Body<'_>, expression: naga::Handle<naga::Expression>) -> Value {
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

    pub fn is_zero(&self, body: &Body<'_>, expression: naga::Handle<naga::Expression>) -> bool {
        matches!(body.function.expressions[expression], naga::Expression::Literal(naga::Literal::F32(0.0)))
    }

    pub fn scaled(&mut self, a: Node, factor: f32) -> Value {
        let power = factor.log2() as i16;
        assert_eq!(2f32.powi(power.into()), factor);
        self.push(Operation::Unary(Unary::Scale(power), a))
    }

    /// The result of a call.
    pub fn called(&mut self, body: &mut Body<'_>, result: naga::Handle<naga::Expression>) -> Value {
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
    pub fn root(&mut self, name: String, values: &[Node]) -> Value {
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
    pub fn calls_of(&self, function: &str) -> BTreeSet<String> {
        let mut calls = BTreeMap::new();
        gather(&self.module.functions[self.named(function)].body, &mut calls);
        calls.values().filter_map(|(it, _)| self.module.functions[*it].name.clone()).collect()
    }

    /// What a function stores in a structure or array, by field name or index.
    pub fn results(&mut self, function: &str) -> BTreeMap<String, Node> {
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
