//! What the design says of an input with a tolerance: `nominal(NAME)` is a name like any other, with a slot of its own.

use super::expression::{Expression, ExpressionNode};

/// The function that asks for it.
pub(super) const NOMINAL: &str = "nominal";

/// The name of what the design says of an input.
pub fn nominal_name(of: &str) -> String {
    format!("{NOMINAL}({of})")
}

/// The input of which a name is what the design says; `None` for every other name.
pub fn nominal_of(name: &str) -> Option<&str> {
    name.strip_prefix(NOMINAL)?.strip_prefix('(')?.strip_suffix(')')
}

/// What a person calls the formula of this name: where the input that it gives has a tolerance, it is a formula for the input all the same.
pub(super) fn own_name(name: &str) -> &str {
    nominal_of(name).unwrap_or(name)
}

/// What a call asks of, if it is `nominal(NAME)`.
fn asked<'e>(function: &str, arguments: &'e [Expression]) -> Option<&'e str> {
    match arguments {
        [Expression { node: ExpressionNode::Name(name), .. }] if function == NOMINAL => Some(name),
        _ => None,
    }
}

/// The inputs of which an expression asks what the design says.
pub fn nominals_in(expression: &Expression) -> Vec<&str> {
    let own = match &expression.node {
        ExpressionNode::Call(function, arguments) => asked(function, arguments),
        _ => None,
    };
    expression.parts().flat_map(nominals_in).chain(own).collect()
}

/// The expression with names in place of calls of `nominal` that are known.
pub(super) fn with_nominal_names(expression: &Expression, is_known: &dyn Fn(&str) -> bool) -> Expression {
    expression.replaced(&|part| match &part.node {
        ExpressionNode::Call(function, arguments) => {
            asked(function, arguments).map(nominal_name).filter(|name| is_known(name)).map(ExpressionNode::Name)
        }
        _ => None,
    })
}
