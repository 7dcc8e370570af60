//! How many operations a function of a kernel takes, counted in its text.

use std::collections::HashMap;
use wgpu::naga::{self, Expression, Function, Handle, Literal, Statement, TypeInner};

/// A kernel's text, to count in.
pub(crate) struct Operations {
    module: naga::Module,
    info: naga::valid::ModuleInfo,
}

impl Operations {
    /// Of a text that compiles.
    ///
    /// # Panics
    /// If it does not.
    pub(crate) fn of(text: &str) -> Self {
        let (module, info) = super::program::parsed(text).expect("a kernel of the program compiles");
        Self { module, info }
    }

    /// Of a function with all that it calls: arithmetic, comparisons and selections of single numbers. Where it branches both sides count,
    /// unless the kernel's constants decide; the body of a loop counts once.
    ///
    /// # Panics
    /// If there is no such function.
    pub(crate) fn in_function(&self, name: &str) -> u64 {
        let named = |(_, it): &(Handle<Function>, &Function)| it.name.as_deref() == Some(name);
        let (function, _) = self.module.functions.iter().find(named).expect("the kernel has it");
        self.count(function, &mut HashMap::new())
    }

    fn count(&self, function: Handle<Function>, known: &mut HashMap<Handle<Function>, u64>) -> u64 {
        if let Some(&count) = known.get(&function) {
            return count;
        }
        let count = self.in_block(&self.module.functions[function].body, function, known);
        known.insert(function, count);
        count
    }

    fn in_block(&self, block: &naga::Block, function: Handle<Function>, known: &mut HashMap<Handle<Function>, u64>) -> u64 {
        let mut count = 0;
        for statement in block {
            count += match statement {
                Statement::Emit(range) => range.clone().map(|it| self.in_expression(it, function)).sum(),
                Statement::Block(block) => self.in_block(block, function, known),
                Statement::If { condition, accept, reject } => {
                    let sides = match self.decided(*condition, function) {
                        Some(true) => vec![accept],
                        Some(false) => vec![reject],
                        None => vec![accept, reject],
                    };
                    sides.into_iter().map(|side| self.in_block(side, function, known)).sum()
                }
                Statement::Switch { cases, .. } => cases.iter().map(|case| self.in_block(&case.body, function, known)).sum(),
                Statement::Loop { body, continuing, .. } => {
                    self.in_block(body, function, known) + self.in_block(continuing, function, known)
                }
                Statement::Call { function, .. } => self.count(*function, known),
                Statement::Atomic { .. } => 1,
                _ => 0,
            };
        }
        count
    }

    /// A condition that constants decide.
    fn decided(&self, condition: Handle<Expression>, function: Handle<Function>) -> Option<bool> {
        let literal = match self.module.functions[function].expressions[condition] {
            Expression::Literal(literal) => literal,
            Expression::Constant(constant) => match self.module.global_expressions[self.module.constants[constant].init] {
                Expression::Literal(literal) => literal,
                _ => return None,
            },
            _ => return None,
        };
        if let Literal::Bool(holds) = literal { Some(holds) } else { None }
    }

    /// A number for each component.
    fn in_expression(&self, expression: Handle<Expression>, function: Handle<Function>) -> u64 {
        let counts = matches!(
            self.module.functions[function].expressions[expression],
            Expression::Unary { .. }
                | Expression::Binary { .. }
                | Expression::Select { .. }
                | Expression::Relational { .. }
                | Expression::Math { .. }
                | Expression::As { convert: Some(_), .. }
        );
        match self.info[function][expression].ty.inner_with(&self.module.types) {
            _ if !counts => 0,
            TypeInner::Vector { size, .. } => *size as u64,
            _ => 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operations_are_counted_with_those_of_called_functions_and_without_what_constants_leave_out() {
        let text = "const SKIPS: bool = false;\nfn twice(x: f32) -> f32 { return x + x; }\n\
            fn f(v: vec2<f32>, n: u32) -> f32 {\n    let w = 2.0 * v;\n    if SKIPS { return twice(twice(w.x)); }\n    var sum = 0.0;\n    \
            for (var i = 0u; i < n; i++) { sum += twice(w.x); }\n    return select(sum, w.y, sum > 1.0);\n}\n\
            @compute @workgroup_size(1) fn main() { _ = f(vec2<f32>(1.0), 2u); }";
        let operations = Operations::of(text);
        assert_eq!(operations.in_function("twice"), 1);
        // Two products; of the loop a comparison, a sum, the called one, a step; a comparison and a selection.
        assert_eq!(operations.in_function("f"), 2 + 4 + 2);
    }
}
