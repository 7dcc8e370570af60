//! A formula as a list of operations: written once in Rust over [`Real`], recorded by running it on names of numbers, and then run
//! or written by whoever needs it.
//!
//! [`Recording`] makes the list. Constants are folded with the functions of f64 and equal operations stand once, so that f64 gives the
//! same bits as the formula. [`List`] is what remains of it when some results are asked for: it runs over any number type (f32 with
//! error bounds in [`RunningError`], boxes in [`Interval`], derivatives in [`Dual`]), tells which inputs a result depends on, is computed for many designs at a time ([`NodeColumns`]),
//! and [`wgsl`] writes the shader from it.

mod columns;
mod dual;
mod equations;
pub(crate) mod error_bound;
mod interval;
mod lane_list;
mod list;
mod list_columns;
mod record;
mod rolled;
mod root_columns;
mod set;
mod settled;
mod stages;
mod steps;
#[cfg(test)]
mod tests;
pub mod wgsl;

pub use columns::{CHUNK, ColumnValue, NodeColumns};
pub use dual::Dual;
pub use equations::{EquationLine, FormulaEquations, Symbols};
pub use error_bound::{RunningError, nearest_f32};
pub use interval::{EVERYTHING, Interval};
pub(crate) use lane_list::{LaneBlock, LaneList, LaneNumbers, Varies};
pub use list::{List, ListRoot};
pub use list_columns::{LIST_CHUNK, ListColumns};
pub use record::{Known, Loops, Recording, Trace};
pub use rolled::{FormulaTable, ListLoop, Rolled, RolledLoop, Store};
pub use set::Set;
pub use settled::{Onwards, SettledStages, StageLists};
pub use stages::{Fields, First, Reads, Recordable, Second, Whole};
pub use steps::{Step, Steps};

use crate::real::{ROOT_PARAMETERS, Real, RootStep, Smoothness};

/// Number of an operation in its list.
pub type Node = u32;

/// An operation; its operands come before it in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// An input, by number.
    Input(u16),
    /// A known number, as bits.
    Constant(u64),
    /// What the function of a root is asked at.
    Argument(u8),
    /// The root of an increasing function: its number among the roots.
    Root(u8),
    /// Of one number.
    Unary(Unary, Node),
    /// Of two numbers.
    Binary(Binary, Node, Node),
    /// Margin, at least zero, below zero.
    Select(Node, Node, Node),
    /// What only a list has whose loops are recorded once.
    Rolled(Rolled),
}

/// Operations on one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names of the operations of Real")]
pub enum Unary {
    Neg,
    Sqrt,
    Abs,
    ExpM1,
    Ln1p,
    Sin,
    Cos,
    Asin,
    Floor,
    /// Times two to this power, which is exact.
    Scale(i16),
}

/// Operations on two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names of the operations of Real")]
pub enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Min,
    Max,
    PlusWhole,
}

impl Unary {
    /// Applies it.
    #[inline(always)]
    pub fn of<R: Real>(self, a: R) -> R {
        match self {
            Self::Neg => -a,
            Self::Sqrt => a.sqrt(),
            Self::Abs => a.abs(),
            Self::ExpM1 => a.exp_m1(),
            Self::Ln1p => a.ln_1p(),
            Self::Sin => a.sin(),
            Self::Cos => a.cos(),
            Self::Asin => a.asin(),
            Self::Floor => a.floor(),
            Self::Scale(power) => a.scaled(power),
        }
    }
}

impl Binary {
    /// Applies it.
    #[inline(always)]
    pub fn of<R: Real>(self, a: R, b: R) -> R {
        match self {
            Self::Add => a + b,
            Self::Sub => a - b,
            Self::Mul => a * b,
            Self::Div => a / b,
            Self::Min => a.min(b),
            Self::Max => a.max(b),
            Self::PlusWhole => a.plus_whole(b),
        }
    }
}

impl Operation {
    /// Calls `each` with every operand; those of a root's function are in [`Root`].
    pub fn operands(self, mut each: impl FnMut(Node)) {
        match self {
            Self::Input(_) | Self::Constant(_) | Self::Argument(_) | Self::Root(_) => {}
            Self::Unary(_, a) => each(a),
            Self::Binary(_, a, b) => {
                each(a);
                each(b);
            }
            Self::Select(margin, a, b) => {
                each(margin);
                each(a);
                each(b);
            }
            Self::Rolled(rolled) => rolled.operands(each),
        }
    }

    /// The same with other operands; those of a root's function are in [`Root`].
    #[must_use]
    pub fn map(self, at: impl Fn(Node) -> Node) -> Self {
        match self {
            Self::Input(_) | Self::Constant(_) | Self::Argument(_) | Self::Root(_) => self,
            Self::Unary(kind, a) => Self::Unary(kind, at(a)),
            Self::Binary(kind, a, b) => Self::Binary(kind, at(a), at(b)),
            Self::Select(margin, a, b) => Self::Select(at(margin), at(a), at(b)),
            Self::Rolled(rolled) => Self::Rolled(rolled.map(at)),
        }
    }
}

/// The root of an increasing function: where it is sought, and what the function is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Ends of the bracket.
    pub bracket: (Node, Node),
    /// Where the search starts.
    pub start: Node,
    /// Stands for what the function is asked at.
    pub argument: Node,
    /// The function's value.
    pub value: Node,
    /// The function's slope.
    pub slope: Node,
    /// What is known of the function.
    pub smoothness: Smoothness,
    /// The function, where it has been compiled for many searches at a time.
    pub function: Option<KnownFunction>,
}

/// A function whose root is sought that has been compiled.
#[derive(Clone, Copy, Debug)]
pub struct KnownFunction {
    /// A step of many searches.
    pub step: RootStep,
    /// What the function takes.
    pub parameters: [RootParameter; ROOT_PARAMETERS],
}

/// A parameter of such a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RootParameter {
    /// It is known.
    Number(f64),
    /// It is computed.
    Node(Node),
}

impl KnownFunction {
    /// The parameters that are computed.
    pub fn nodes(&self) -> impl Iterator<Item = Node> {
        self.parameters.into_iter().filter_map(|it| if let RootParameter::Node(node) = it { Some(node) } else { None })
    }
}

impl PartialEq for KnownFunction {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::fn_addr_eq(self.step, other.step) && self.parameters == other.parameters
    }
}

impl Root {
    /// Calls `each` with what the root is made of besides its argument.
    pub fn reads(&self, each: impl FnMut(Node)) {
        [self.bracket.0, self.bracket.1, self.start, self.value, self.slope].into_iter().for_each(each);
    }

    /// The same of other nodes.
    #[must_use]
    pub fn map(self, at: impl Fn(Node) -> Node) -> Self {
        let Self { bracket, start, argument, value, slope, smoothness, function } = self;
        let parameter = |it| match it {
            RootParameter::Number(_) => it,
            RootParameter::Node(node) => RootParameter::Node(at(node)),
        };
        let function = function.map(|it| KnownFunction { parameters: it.parameters.map(parameter), ..it });
        let bracket = (at(bracket.0), at(bracket.1));
        Self { bracket, start: at(start), argument: at(argument), value: at(value), slope: at(slope), smoothness, function }
    }
}
