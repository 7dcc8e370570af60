//! The functions that a formula may call.

/// A function of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Min,
    Max,
    Abs,
    Sqrt,
    Exp,
    Ln,
    Log10,
    ExpM1,
    Ln1p,
    Tanh,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Hypot,
    Clamp,
    Round,
    Floor,
    Ceil,
    Default,
}

impl Function {
    /// Has it corners or jumps?
    pub(super) fn has_corners(self) -> bool {
        use Function::{Abs, Atan2, Ceil, Clamp, Default, Floor, Hypot, Max, Min, Round};
        matches!(self, Min | Max | Abs | Clamp | Round | Floor | Ceil | Default | Hypot | Atan2)
    }
}

/// What the arguments of a function may measure, and what its value does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Arguments and value measure the same, whatever it is.
    Same,
    /// The value measures the root of what the argument does.
    Root,
    /// Plain numbers.
    Plain,
    /// Plain numbers, of which the value is a whole one.
    Whole,
    /// An angle gives a plain number.
    OfAngle,
    /// A plain number gives an angle.
    ToAngle,
    /// Two arguments that measure the same give an angle.
    Direction,
}

use Kind::{Direction, OfAngle, Plain, Root, Same, ToAngle, Whole};

/// Every function with its name, how it is called (as many arguments as there are commas and one) and what it takes.
pub(super) const FUNCTIONS: [(&str, Function, &str, Kind); 23] = [
    ("min", Function::Min, "min(a, b)", Same),
    ("max", Function::Max, "max(a, b)", Same),
    ("abs", Function::Abs, "abs(x)", Same),
    ("sqrt", Function::Sqrt, "sqrt(x)", Root),
    ("exp", Function::Exp, "exp(x)", Plain),
    ("ln", Function::Ln, "ln(x)", Plain),
    ("log10", Function::Log10, "log10(x)", Plain),
    ("exp_m1", Function::ExpM1, "exp_m1(x)", Plain),
    ("ln_1p", Function::Ln1p, "ln_1p(x)", Plain),
    ("tanh", Function::Tanh, "tanh(x)", Plain),
    ("sin", Function::Sin, "sin(angle)", OfAngle),
    ("cos", Function::Cos, "cos(angle)", OfAngle),
    ("tan", Function::Tan, "tan(angle)", OfAngle),
    ("asin", Function::Asin, "asin(x)", ToAngle),
    ("acos", Function::Acos, "acos(x)", ToAngle),
    ("atan", Function::Atan, "atan(x)", ToAngle),
    ("atan2", Function::Atan2, "atan2(y, x)", Direction),
    ("hypot", Function::Hypot, "hypot(a, b)", Same),
    ("clamp", Function::Clamp, "clamp(x, low, high)", Same),
    ("round", Function::Round, "round(x)", Whole),
    ("floor", Function::Floor, "floor(x)", Whole),
    ("ceil", Function::Ceil, "ceil(x)", Whole),
    ("default", Function::Default, "default(x, y)", Same),
];

/// Names that mean something else than a quantity, besides the functions.
pub(super) const RESERVED: [&str; 4] = ["if", "root", "nominal", "pi"];

/// Does the name mean something in every formula, as `sqrt`, `if` and `pi` do? No quantity can have it.
pub fn is_reserved(name: &str) -> bool {
    RESERVED.contains(&name) || FUNCTIONS.iter().any(|(function, ..)| *function == name)
}
