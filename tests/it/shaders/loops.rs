//! Reads the statements of a shader's function back: what it assigns, its loops, and what these write into tables.

use super::reader::{Body, Reader, Value};
use beltspace::real::Place;
use beltspace::tape::{Node, Operation, Rolled, RolledLoop, Store};
use wgpu::naga::{Block, Expression, Handle, Literal, LocalVariable, MathFunction, Statement, TypeInner, UnaryOperator};

/// A whole number of the text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Whole {
    Literal(i64),
    /// A place of a table.
    Place(Place),
    /// A number of the formula.
    Of(Node),
    /// The same, but not above a limit: the end of a loop, or of a table.
    End(Node, i64),
}

/// What a local variable holds.
#[derive(Clone, Debug)]
pub enum Held {
    Number(Node),
    Whole(Whole),
    /// A table: its number.
    Table(u8),
    /// A number of a loop's state at the beginning of an iteration.
    State(u8, u8),
    /// One that the loop has left.
    Left(u8, u8),
}

/// A loop while its body is read.
#[derive(Clone, Copy)]
struct Open {
    number: u8,
    /// The variable that counts.
    counter: Handle<LocalVariable>,
}

impl Reader<'_> {
    /// Reads a block; what it assigns to the fields of a structure or array is in `body.results` afterwards.
    pub fn block(&mut self, body: &mut Body<'_>, block: &Block) {
        for statement in block {
            match statement {
                Statement::Emit(range) => {
                    for expression in range.clone() {
                        if matches!(body.function.expressions[expression], Expression::Load { .. }) && body.argument.is_none() {
                            self.load(body, expression);
                        }
                    }
                }
                Statement::Store { pointer, value } => self.store(body, *pointer, *value),
                Statement::Call { function, arguments, result: None } => {
                    let name = self.module.functions[*function].name.clone().expect("functions have names");
                    let table = name.strip_prefix("set_").unwrap_or_else(|| panic!("{name} has no result")).to_owned();
                    let number = self.number(body, arguments[1]);
                    let table = self.tables.iter().position(|it| *it == table).expect("it is a table") as u8;
                    self.put(body, table, arguments[0], number);
                }
                Statement::Call { .. } | Statement::Return { .. } => {}
                Statement::Block(inner) => self.block(body, inner),
                Statement::Loop { body: inner, continuing, .. } => self.read_loop(body, inner, continuing),
                Statement::If { condition, accept, reject } => self.exit(body, *condition, accept, reject),
                other => panic!("{other:?} is not known"),
            }
        }
    }

    fn variable(body: &Body<'_>, pointer: Handle<Expression>) -> Option<Handle<LocalVariable>> {
        match body.function.expressions[pointer] {
            Expression::LocalVariable(variable) => Some(variable),
            _ => None,
        }
    }

    fn load(&mut self, body: &mut Body<'_>, expression: Handle<Expression>) {
        let Expression::Load { pointer } = body.function.expressions[expression] else { return };
        let (base, index) = match body.function.expressions[pointer] {
            Expression::Access { base, index } => (base, Some(index)),
            _ => (pointer, None),
        };
        let Some(variable) = Self::variable(body, base) else { return };
        let held = body.held.get(&variable.index()).cloned();
        let value = match (held, index) {
            (Some(Held::Number(node)), None) => Value::Number(node),
            (Some(Held::Whole(whole)), None) => Value::Whole(whole),
            (Some(Held::State(of, state)), None) => self.push(Operation::Rolled(Rolled::State(of, state))),
            (Some(Held::Left(of, state)), None) => self.push(Operation::Rolled(Rolled::Folded(of, state))),
            (Some(Held::Table(table)), Some(index)) => {
                let Whole::Place(place) = self.whole(body, index) else { panic!("no place") };
                let version = self.versions[usize::from(table)];
                self.push(Operation::Rolled(Rolled::Get(version, place)))
            }
            // The result, when it is returned.
            (None, None) => return,
            other => panic!("{other:?}"),
        };
        body.known.insert(expression.index(), value);
    }

    /// A whole number.
    pub fn whole(&mut self, body: &mut Body<'_>, expression: Handle<Expression>) -> Whole {
        if let Some(Value::Whole(whole)) = body.known.get(&expression.index()) {
            return *whole;
        }
        match body.function.expressions[expression].clone() {
            Expression::Literal(Literal::U32(number)) => Whole::Literal(number.into()),
            Expression::Literal(Literal::I32(number)) => Whole::Literal(number.into()),
            Expression::CallResult(_) => {
                let (function, arguments) = body.calls[&expression.index()].clone();
                assert_eq!(self.module.functions[function].name.as_deref(), Some("whole"));
                Whole::Of(self.number(body, arguments[0]))
            }
            Expression::Math { fun: MathFunction::Min, arg, arg1: Some(most), .. } => match (self.whole(body, arg), self.whole(body, most))
            {
                (Whole::Of(node), Whole::Literal(most)) => Whole::End(node, most),
                other => panic!("{other:?}"),
            },
            Expression::Binary { op, left, right } => {
                use wgpu::naga::BinaryOperator::{Add, Subtract};
                match (self.whole(body, left), self.whole(body, right), op) {
                    (Whole::Place(place), Whole::Literal(1), Add) => Whole::Place(place.next()),
                    (Whole::Place(place), Whole::Literal(1), Subtract) => Whole::Place(Place { number: place.number - 1, ..place }),
                    other => panic!("{other:?}"),
                }
            }
            other => panic!("{other:?} is no whole number"),
        }
    }

    fn store(&mut self, body: &mut Body<'_>, pointer: Handle<Expression>, value: Handle<Expression>) {
        match body.function.expressions[pointer] {
            Expression::LocalVariable(variable) => {
                let is_number = matches!(self.module.types[body.function.local_variables[variable].ty].inner, TypeInner::Struct { .. });
                let held = if is_number { Held::Number(self.number(body, value)) } else { Held::Whole(self.whole(body, value)) };
                body.held.insert(variable.index(), held);
            }
            Expression::AccessIndex { base, index } => {
                let variable = Self::variable(body, base).expect("it is a variable");
                let field = match &self.module.types[body.function.local_variables[variable].ty].inner {
                    TypeInner::Struct { members, .. } => members[index as usize].name.clone().expect("fields have names"),
                    _ => index.to_string(),
                };
                let node = self.number(body, value);
                body.results.insert(field, node);
            }
            Expression::Access { base, index } => {
                let variable = Self::variable(body, base).expect("it is a variable");
                let number = self.number(body, value);
                let Some(Held::Table(table)) = body.held.get(&variable.index()) else { panic!("no table") };
                self.put(body, *table, index, number);
            }
            ref other => panic!("{other:?}"),
        }
    }

    /// Writes into a table: in a loop at a place, outside behind its last number.
    fn put(&mut self, body: &mut Body<'_>, table: u8, index: Handle<Expression>, number: Node) {
        match self.whole(body, index) {
            Whole::Place(place) => {
                let of = place.of.expect("only loops write at places");
                self.operations.loops[usize::from(of)].stores.push(Store { table, place, number });
            }
            // Past the last place is the last place: nothing else keeps a number of teeth that a formula finds inside the table.
            Whole::End(end, last) => {
                assert_eq!(last + 1, self.lengths[usize::from(table)] as i64, "the last place of a table");
                let before = self.versions[usize::from(table)];
                self.versions[usize::from(table)] = self.operations.push(Operation::Rolled(Rolled::PutLast(before, end, number)));
            }
            other => panic!("{other:?}"),
        }
    }

    /// What the function's variables hold at its beginning; an array is the table of its name.
    pub fn begin(&self, body: &mut Body<'_>) {
        for (variable, declared) in body.function.local_variables.iter() {
            if let Some(init) = declared.init
                && let Expression::Literal(Literal::U32(number)) = body.function.expressions[init]
            {
                body.held.insert(variable.index(), Held::Whole(Whole::Literal(number.into())));
            }
            let name = declared.name.as_deref().unwrap_or_default();
            if let Some(table) = self.tables.iter().position(|it| it == name) {
                body.held.insert(variable.index(), Held::Table(table as u8));
            }
        }
    }

    fn read_loop(&mut self, body: &mut Body<'_>, inner: &Block, continuing: &Block) {
        let stored = stored_variables(body, [inner, continuing]);
        let (counters, states): (Vec<_>, Vec<_>) = stored.into_iter().partition(|&variable| {
            !matches!(self.module.types[body.function.local_variables[variable].ty].inner, TypeInner::Struct { .. })
        });
        let [counter] = counters[..] else { panic!("{} counters", counters.len()) };
        if states.is_empty() {
            return self.fill(body, inner);
        }
        let begins = match body.held.get(&counter.index()) {
            Some(Held::Whole(whole)) => *whole,
            other => panic!("a loop begins at {other:?}"),
        };
        let number = u8::try_from(self.operations.loops.len()).expect("few loops");
        let open = Open { number, counter };
        // A loop that counts down is left at one above its place.
        let backwards = matches!(begins, Whole::End(..));
        let mut at = Place { number: 0, of: Some(number) };
        if backwards {
            at = at.next();
        }
        body.held.insert(counter.index(), Held::Whole(Whole::Place(at)));
        let numbers = self.states[usize::from(number)].clone();
        assert_eq!(numbers.len(), states.len(), "loop {number}");
        let mut begin = std::collections::BTreeMap::new();
        for (&variable, &state) in states.iter().zip(&numbers) {
            let before = body.held.insert(variable.index(), Held::State(number, state));
            let Some(Held::Number(before)) = before else { panic!("{before:?}") };
            begin.insert(state, before);
        }
        self.operations.loops.push(RolledLoop {
            first: usize::MAX,
            end: Node::MAX,
            most: 0,
            backwards,
            until_zero: None,
            state: Vec::new(),
            names: &[],
            stores: Vec::new(),
        });
        self.open = Some((open.number, begins));
        self.block(body, inner);
        let counted = Self::counts(body, continuing);
        assert_eq!(counted, (open.counter, if backwards { -1 } else { 1 }), "how a loop counts");
        self.open = None;
        let mut state = Vec::new();
        for (&variable, &number_of) in states.iter().zip(&numbers) {
            let Some(Held::Number(next)) = body.held.get(&variable.index()).cloned() else { panic!("no number") };
            state.push((begin[&number_of], next));
            body.held.insert(variable.index(), Held::Left(number, number_of));
        }
        let until_zero = self.left_at_zero.take().map(|node| state.iter().position(|(_, next)| *next == node).expect("it is of the state"));
        let recorded = &mut self.operations.loops[usize::from(number)];
        recorded.until_zero = until_zero.map(|at| numbers[at]);
        recorded.state = state;
        let mut written: Vec<u8> = self.operations.loops[usize::from(number)].stores.iter().map(|store| store.table).collect();
        written.sort_unstable();
        written.dedup();
        for table in written {
            let before = self.versions[usize::from(table)];
            self.versions[usize::from(table)] = self.operations.push(Operation::Rolled(Rolled::Written(number, table, before)));
        }
        body.held.insert(counter.index(), Held::Whole(Whole::Place(at)));
    }

    /// Which variable a loop counts with, and in which direction.
    fn counts(body: &Body<'_>, continuing: &Block) -> (Handle<LocalVariable>, i32) {
        for statement in continuing {
            if let Statement::Store { pointer, value } = *statement
                && let Some(variable) = Self::variable(body, pointer)
                && let Expression::Binary { op, right, .. } = body.function.expressions[value]
                && matches!(body.function.expressions[right], Expression::Literal(Literal::U32(1) | Literal::I32(1)))
            {
                return (variable, if op == wgpu::naga::BinaryOperator::Add { 1 } else { -1 });
            }
        }
        panic!("it does not count")
    }

    /// A table is filled with one number.
    fn fill(&mut self, body: &mut Body<'_>, inner: &Block) {
        for statement in inner {
            let (Statement::Block(block), _) = (statement, ()) else { continue };
            for statement in block {
                if let Statement::Store { pointer, value } = *statement
                    && let Expression::Access { base, .. } = body.function.expressions[pointer]
                    && let Some(variable) = Self::variable(body, base)
                    && let Some(Held::Table(table)) = body.held.get(&variable.index()).cloned()
                {
                    let number = self.number(body, value);
                    self.versions[usize::from(table)] = self.operations.push(Operation::Rolled(Rolled::Table(table, number)));
                    return;
                }
            }
        }
        panic!("a loop without a state that fills nothing");
    }

    /// Where a loop is left: at its end, or where a number of its state is zero.
    fn exit(&mut self, body: &mut Body<'_>, condition: Handle<Expression>, accept: &Block, reject: &Block) {
        use wgpu::naga::BinaryOperator::{Greater, Less};
        let leaves = |block: &Block| matches!(block.iter().next(), Some(Statement::Break)) && block.len() == 1;
        let (number, begins) = self.open.expect("only loops have branches");
        let recorded = usize::from(number);
        let mut going_on = leaves(reject) && accept.is_empty();
        let mut condition = condition;
        if let Expression::Unary { op: UnaryOperator::LogicalNot, expr } = body.function.expressions[condition] {
            assert!(leaves(accept));
            (condition, going_on) = (expr, true);
        }
        match body.function.expressions[condition] {
            Expression::Binary { op: op @ (Less | Greater), left, right } if going_on => {
                let (Whole::Place(_), other) = (self.whole(body, left), self.whole(body, right)) else { panic!("no place") };
                let (first, end) = if op == Less { (begins, other) } else { (other, begins) };
                assert_eq!(op == Greater, self.operations.loops[recorded].backwards);
                let (Whole::Literal(first), Whole::End(end, most)) = (first, end) else { panic!("{first:?} {end:?}") };
                let it = &mut self.operations.loops[recorded];
                (it.first, it.end, it.most) = (first as usize, end, most as usize);
            }
            Expression::CallResult(_) if leaves(accept) => {
                let (function, arguments) = body.calls[&condition.index()].clone();
                assert_eq!(self.module.functions[function].name.as_deref(), Some("is_zero"));
                let node = self.number(body, arguments[0]);
                self.left_at_zero = Some(node);
            }
            ref other => panic!("{other:?}"),
        }
    }
}

impl Reader<'_> {
    /// `if_known`: a number of a table that is known where its index is, or what a loop leaves once it has come to its end.
    pub fn if_known(&mut self, body: &mut Body<'_>, condition: Handle<Expression>, number: Handle<Expression>) -> Value {
        use wgpu::naga::BinaryOperator::{Equal, GreaterEqual, InclusiveOr, LessEqual};
        let node = self.number(body, number);
        let Expression::Binary { op, left, right } = body.function.expressions[condition] else { panic!("no condition") };
        match (op, self.operations.operations[node as usize]) {
            (Equal, Operation::Rolled(Rolled::GetAt(_, index))) => {
                let Expression::AccessIndex { base, index: 1 } = body.function.expressions[left] else { panic!("no bound") };
                assert_eq!(self.number(body, base), index, "the bound of another number");
                assert!(self.is_zero(body, right));
            }
            (InclusiveOr, Operation::Rolled(Rolled::Folded(of, _))) => {
                assert_eq!(self.ends(body, left, GreaterEqual), of);
                assert!(matches!(body.function.expressions[right], Expression::CallResult(_)));
                assert!(self.operations.loops[usize::from(of)].until_zero.is_some());
            }
            (GreaterEqual | LessEqual, Operation::Rolled(Rolled::Folded(of, _))) => {
                let backwards = self.operations.loops[usize::from(of)].backwards;
                assert_eq!(self.ends(body, condition, if backwards { LessEqual } else { GreaterEqual }), of);
            }
            other => panic!("{other:?}"),
        }
        Value::Number(node)
    }

    /// Which loop has come to its end where this comparison holds.
    fn ends(&mut self, body: &mut Body<'_>, comparison: Handle<Expression>, expected: wgpu::naga::BinaryOperator) -> u8 {
        let Expression::Binary { op, left, right } = body.function.expressions[comparison] else { panic!("no comparison") };
        assert_eq!(op, expected);
        let Whole::Place(Place { of: Some(of), .. }) = self.whole(body, left) else { panic!("no place") };
        let recorded = &self.operations.loops[usize::from(of)];
        let (first, end) = (Whole::Literal(recorded.first as i64), Whole::End(recorded.end, recorded.most as i64));
        assert_eq!(self.whole(body, right), if expected == wgpu::naga::BinaryOperator::LessEqual { first } else { end });
        of
    }
}

/// The local variables that some blocks assign, in the order of their declaration.
fn stored_variables(body: &Body<'_>, blocks: [&Block; 2]) -> Vec<Handle<LocalVariable>> {
    let mut found = Vec::new();
    let mut open: Vec<&Block> = blocks.to_vec();
    while let Some(block) = open.pop() {
        for statement in block {
            match statement {
                Statement::Store { pointer, .. } => {
                    if let Expression::LocalVariable(variable) = body.function.expressions[*pointer] {
                        found.push(variable);
                    }
                }
                Statement::Block(inner) => open.push(inner),
                Statement::If { accept, reject, .. } => open.extend([accept, reject]),
                _ => {}
            }
        }
    }
    found.sort_by_key(|variable| variable.index());
    found.dedup();
    found
}
