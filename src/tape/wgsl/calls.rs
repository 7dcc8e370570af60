//! One operation as text: with error bounds a call of the shared functions, else plain f32.

use super::{Arithmetic, Precision};
use crate::tape::{Binary, Unary, nearest_f32};

/// A constant: exact in f32, or with what f32 loses of it.
pub(super) fn constant(value: f64, arithmetic: Arithmetic, precision: Precision) -> String {
    if precision == Precision::Double {
        return match arithmetic {
            Arithmetic::Plain if value < 0.0 => format!("({value:?}lf)"),
            Arithmetic::Plain => format!("{value:?}lf"),
            Arithmetic::Bounded => format!("constant({value:?}lf)"),
        };
    }
    let (near, bound) = nearest_f32(value);
    match arithmetic {
        Arithmetic::Plain if near < 0.0 => format!("({near:?})"),
        Arithmetic::Plain => format!("{near:?}"),
        Arithmetic::Bounded if bound == 0.0 => format!("constant({near:?})"),
        Arithmetic::Bounded => format!("Real({near:?}, {bound:?})"),
    }
}

pub(super) fn bounded_unary(operation: Unary, a: &str) -> String {
    match operation {
        Unary::Neg => format!("neg({a})"),
        Unary::Sqrt => format!("sqrt_({a})"),
        Unary::Abs => format!("abs_({a})"),
        Unary::ExpM1 => format!("exp_m1_({a})"),
        Unary::Ln1p => format!("ln_1p_({a})"),
        Unary::Sin => format!("sin_({a})"),
        Unary::Cos => format!("cos_({a})"),
        Unary::Asin => format!("asin_({a})"),
        Unary::Floor => format!("floor_({a})"),
        Unary::Scale(1) => format!("twice({a})"),
        Unary::Scale(-1) => format!("half({a})"),
        Unary::Scale(power) => format!("scaled_({a}, {:?})", 2f32.powi(power.into())),
    }
}

pub(super) fn plain_unary(operation: Unary, a: &str) -> String {
    match operation {
        Unary::Neg => format!("(-{a})"),
        // As with bounds: rounding may take a number that is zero below it.
        Unary::Sqrt => format!("sqrt(max({a}, 0.0))"),
        Unary::Abs => format!("abs({a})"),
        Unary::ExpM1 => format!("exp_m1({a})"),
        Unary::Ln1p => format!("ln_1p({a})"),
        Unary::Sin => format!("sine({a})"),
        Unary::Cos => format!("cosine({a})"),
        Unary::Asin => format!("arc_sine({a})"),
        Unary::Floor => format!("floor({a})"),
        Unary::Scale(power) => format!("({:?} * {a})", 2f32.powi(power.into())),
    }
}

pub(super) fn bounded_binary(operation: Binary, a: &str, b: &str) -> String {
    let name = match operation {
        Binary::Add => "add",
        Binary::Sub => "sub",
        Binary::Mul => "mul",
        Binary::Div => "div",
        Binary::Min => "min_",
        Binary::Max => "max_",
        Binary::PlusWhole => "plus_whole",
    };
    format!("{name}({a}, {b})")
}

pub(super) fn plain_binary(operation: Binary, a: &str, b: &str) -> String {
    match operation {
        Binary::Add | Binary::PlusWhole => format!("({a} + {b})"),
        Binary::Sub => format!("({a} - {b})"),
        Binary::Mul => format!("({a} * {b})"),
        Binary::Div => format!("({a} / {b})"),
        Binary::Min => format!("min({a}, {b})"),
        Binary::Max => format!("max({a}, {b})"),
    }
}
