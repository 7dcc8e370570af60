//! A formula as a tree, and the tree as text.

use std::fmt::{self, Display, Formatter};
use std::ops::Range;

/// Operators between two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

impl Operator {
    /// How tightly it binds what stands on its left, and on its right.
    pub(super) fn binding(self) -> (u8, u8) {
        match self {
            Self::Add | Self::Subtract => (10, 11),
            Self::Multiply | Self::Divide => (20, 21),
            // From the right: 2^3^2 is 2^(3^2), and 2^-1 is 2^(-1).
            Self::Power => (31, NEGATIVE),
        }
    }

    /// As it is written.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Power => "^",
        }
    }
}

/// How tightly a minus sign binds what follows it: tighter than a product and less than a power, so that -3^2 is -9.
pub(super) const NEGATIVE: u8 = 25;

/// Comparisons, which stand in `if` only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum ComparisonSign {
    Less,
    AtMost,
    Greater,
    AtLeast,
    Equal,
}

impl ComparisonSign {
    /// As it is written.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Less => "<",
            Self::AtMost => "<=",
            Self::Greater => ">",
            Self::AtLeast => ">=",
            Self::Equal => "==",
        }
    }
}

/// What an expression is.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ExpressionNode {
    /// A number, with the unit in brackets behind it as it was written.
    Number(f64, Option<String>),
    /// The name of a quantity, of `pi`, or of the unknown of a root.
    Name(String),
    /// A word of an input, in quotes.
    Word(String),
    /// With a minus sign.
    Negative(Box<Expression>),
    /// Two numbers with an operator between them.
    Binary(Operator, Box<Expression>, Box<Expression>),
    /// `if(left < right, then, otherwise)`.
    If(ComparisonSign, Box<[Expression; 4]>),
    /// `root(unknown, from, to, expression)`, with the last three, and where the search starts if that is said.
    Root(String, Box<[Expression; 3]>, Option<Box<Expression>>),
    /// A function or a curve.
    Call(String, Vec<Expression>),
}

/// A part of a formula, and where it stands in its text. Two are equal if they say the same, wherever they stand.
#[derive(Clone, Debug)]
pub struct Expression {
    /// What it is.
    pub node: ExpressionNode,
    /// Bytes of the text.
    pub span: Range<usize>,
    /// How many expressions lie inside one another, this one counted.
    pub(super) depth: usize,
}

impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        self.node == other.node
    }
}

impl Expression {
    pub(super) fn new(node: ExpressionNode, span: Range<usize>) -> Self {
        let mut expression = Self { node, span, depth: 0 };
        let inner = expression.parts().map(|part| part.depth).max();
        expression.depth = inner.map_or(1, |inner| inner + 1);
        expression
    }

    /// The expressions that it is made of.
    pub fn parts(&self) -> impl Iterator<Item = &Self> {
        let parts: Vec<&Self> = match &self.node {
            ExpressionNode::Number(..) | ExpressionNode::Name(_) | ExpressionNode::Word(_) => Vec::new(),
            ExpressionNode::Negative(of) => vec![of],
            ExpressionNode::Binary(_, left, right) => vec![left, right],
            ExpressionNode::If(_, parts) => parts.iter().collect(),
            ExpressionNode::Root(_, parts, start) => parts.iter().chain(start.as_deref()).collect(),
            ExpressionNode::Call(_, arguments) => arguments.iter().collect(),
        };
        parts.into_iter()
    }

    /// How many roots there are in it.
    pub fn roots(&self) -> usize {
        usize::from(matches!(self.node, ExpressionNode::Root(..))) + self.parts().map(Self::roots).sum::<usize>()
    }

    /// The names that it reads, each with its place, in the order of the text; the unknowns of its roots are not among them.
    pub fn names(&self) -> Vec<(&str, usize)> {
        let mut names = Vec::new();
        self.collect(&mut Vec::new(), &mut names);
        names
    }

    /// The same formula with other names, such as the symbols of a model's quantities; those that have none stay. For people: what
    /// it prints need not be a formula.
    #[must_use]
    pub fn renamed(&self, name: &dyn Fn(&str) -> Option<String>) -> Self {
        self.replaced(&|part| match &part.node {
            ExpressionNode::Name(own) => name(own).map(ExpressionNode::Name),
            _ => None,
        })
    }

    /// The same formula with other parts, where there are such.
    pub(super) fn replaced(&self, other: &dyn Fn(&Self) -> Option<ExpressionNode>) -> Self {
        if let Some(node) = other(self) {
            return Self { node, ..self.clone() };
        }
        let replaced = |part: &Self| part.replaced(other);
        let boxed = |part: &Self| Box::new(replaced(part));
        let node = match &self.node {
            ExpressionNode::Name(_) | ExpressionNode::Number(..) | ExpressionNode::Word(_) => self.node.clone(),
            ExpressionNode::Negative(of) => ExpressionNode::Negative(boxed(of)),
            ExpressionNode::Binary(operator, left, right) => ExpressionNode::Binary(*operator, boxed(left), boxed(right)),
            ExpressionNode::If(comparison, parts) => {
                ExpressionNode::If(*comparison, Box::new(std::array::from_fn(|part| replaced(&parts[part]))))
            }
            ExpressionNode::Root(unknown, parts, start) => {
                let parts = Box::new(std::array::from_fn(|part| replaced(&parts[part])));
                ExpressionNode::Root(unknown.clone(), parts, start.as_deref().map(boxed))
            }
            ExpressionNode::Call(function, arguments) => ExpressionNode::Call(function.clone(), arguments.iter().map(replaced).collect()),
        };
        Self { node, ..self.clone() }
    }

    fn collect<'e>(&'e self, unknowns: &mut Vec<&'e str>, names: &mut Vec<(&'e str, usize)>) {
        match &self.node {
            ExpressionNode::Name(name) if name != "pi" && !unknowns.contains(&name.as_str()) => names.push((name, self.span.start)),
            ExpressionNode::Root(unknown, parts, start) => {
                let [from, to, body] = &**parts;
                from.collect(unknowns, names);
                to.collect(unknowns, names);
                unknowns.push(unknown);
                body.collect(unknowns, names);
                unknowns.pop();
                if let Some(start) = start {
                    start.collect(unknowns, names);
                }
            }
            _ => self.parts().for_each(|part| part.collect(unknowns, names)),
        }
    }

    /// Writes it, in parentheses if what stands around binds tighter than `least`.
    fn write(&self, out: &mut Formatter<'_>, least: u8) -> fmt::Result {
        let own = match &self.node {
            ExpressionNode::Negative(_) => NEGATIVE,
            ExpressionNode::Binary(operator, ..) => operator.binding().0.min(30),
            _ => u8::MAX,
        };
        if own < least {
            out.write_str("(")?;
        }
        match &self.node {
            ExpressionNode::Number(value, unit) => {
                number(*value, out)?;
                if let Some(unit) = unit {
                    write!(out, "[{unit}]")?;
                }
            }
            ExpressionNode::Name(name) => out.write_str(name)?,
            ExpressionNode::Word(word) => {
                let quote = if word.contains('\'') { '"' } else { '\'' };
                write!(out, "{quote}{word}{quote}")?;
            }
            ExpressionNode::Negative(of) => {
                out.write_str("-")?;
                of.write(out, NEGATIVE)?;
            }
            ExpressionNode::Binary(operator, left, right) => {
                let (before, behind) = operator.binding();
                left.write(out, before)?;
                let space = if *operator == Operator::Power { "" } else { " " };
                write!(out, "{space}{}{space}", operator.symbol())?;
                right.write(out, behind)?;
            }
            ExpressionNode::If(comparison, parts) => {
                let [left, right, then, otherwise] = &**parts;
                write!(out, "if({left} {} {right}, {then}, {otherwise})", comparison.symbol())?;
            }
            ExpressionNode::Root(unknown, parts, start) => {
                let [from, to, body] = &**parts;
                write!(out, "root({unknown}, {from}, {to}, {body}")?;
                if let Some(start) = start {
                    write!(out, ", {start}")?;
                }
                out.write_str(")")?;
            }
            ExpressionNode::Call(name, arguments) => {
                write!(out, "{name}(")?;
                for (at, argument) in arguments.iter().enumerate() {
                    write!(out, "{}{argument}", if at == 0 { "" } else { ", " })?;
                }
                out.write_str(")")?;
            }
        }
        if own < least { out.write_str(")") } else { Ok(()) }
    }
}

/// The shortest number that reads back as this one, without rows of zeros.
fn number(value: f64, out: &mut Formatter<'_>) -> fmt::Result {
    if value == 0.0 || (1e-5..1e15).contains(&value.abs()) { write!(out, "{value}") } else { write!(out, "{value:e}") }
}

/// The formula as a person writes it; it reads back as the same expression.
impl Display for Expression {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        self.write(out, 0)
    }
}
