//! Constants that Rust and WGSL both know. They are declared in Rust alone and written into the text of the kernels, so that the two can
//! never differ.

use crate::tape::error_bound;
use std::fmt::Write;

/// A type that both languages have.
pub(crate) trait InWgsl {
    /// Its name in WGSL.
    const TYPE: &'static str;
    /// A value as a literal.
    fn literal(self) -> String;
}

impl InWgsl for u32 {
    const TYPE: &'static str = "u32";
    fn literal(self) -> String {
        format!("{self}u")
    }
}

impl InWgsl for f32 {
    const TYPE: &'static str = "f32";
    fn literal(self) -> String {
        format!("{self:?}")
    }
}

impl InWgsl for f64 {
    const TYPE: &'static str = "f64";
    fn literal(self) -> String {
        format!("{self:?}lf")
    }
}

impl InWgsl for bool {
    const TYPE: &'static str = "bool";
    fn literal(self) -> String {
        self.to_string()
    }
}

/// Appends the declaration of a constant to a kernel's text.
pub(crate) fn declare<T: InWgsl>(text: &mut String, name: &str, value: T) {
    writeln!(text, "const {name}: {} = {};", T::TYPE, value.literal()).expect("a text takes everything");
}

/// Declares constants, and a function that gives their declarations in WGSL.
macro_rules! shared_constants {
    ($(#[$about:meta])* fn $function:ident; $($(#[$doc:meta])* const $name:ident: $type:ident = $value:expr;)*) => {
        $($(#[$doc])* pub(crate) const $name: $type = $value;)*

        $(#[$about])*
        pub(crate) fn $function() -> String {
            let mut text = String::new();
            $($crate::gpu::constants::declare(&mut text, stringify!($name), $name);)*
            text
        }
    };
}
pub(crate) use shared_constants;

/// So many correctly rounded operations of f32, as a device carries its bounds.
const fn roundings(relative: f64) -> f32 {
    (relative / error_bound::ROUNDING) as f32 * ROUNDING
}

shared_constants! {
    /// What `shaders/common` and the entry points rely on.
    fn common_constants;

    /// Half an ULP, raised by a thousandth for the rounding of the bound itself, which a device carries in f32 too.
    const ROUNDING: f32 = 5.9665e-8;
    /// Relative error of a division.
    const DIVISION: f32 = roundings(error_bound::DIVISION);
    /// Relative error of a square root.
    const SQUARE_ROOT: f32 = roundings(error_bound::SQUARE_ROOT);
    /// Relative error of one of our own functions.
    const FUNCTION: f32 = roundings(error_bound::FUNCTION);
    /// Results below it may be flushed to zero.
    const FLUSH: f32 = error_bound::FLUSH as f32;
    /// The largest divisor, and the inverse of the least, for which WGSL says how accurate a quotient is.
    const LARGEST_DIVISOR: f32 = error_bound::LARGEST_DIVISOR as f32;
    /// A decision: surely not. Their order makes `min` of two decisions that of "both".
    const NO: u32 = 0;
    /// A decision that f64 must make.
    const UNSURE: u32 = 1;
    /// A decision: surely.
    const YES: u32 = 2;
    /// Invocations of a workgroup, where the study does not say.
    const WORKGROUP: u32 = 64;
}

/// Relative error of a sum or product in f64: four times half an ULP. A device's values are held against those of the CPU, which rounds too.
const ROUNDING_64: f64 = 4.0 / (1u64 << 53) as f64;

/// How many ULP a quotient, a root and a function may be off in f64. No standard says how accurate a device is there, so the self-test measures
/// it and allows a quarter of this. It is still less than a ten thousandth of what f32 loses.
pub(crate) const ULP_64: f64 = 4096.0;

/// The constants of `shaders/common` for f64.
pub(crate) fn constants_64() -> String {
    let mut text = String::new();
    declare(&mut text, "ROUNDING_64", ROUNDING_64);
    for name in ["DIVISION_64", "SQUARE_ROOT_64", "FUNCTION_64"] {
        declare(&mut text, name, ULP_64 * ROUNDING_64);
    }
    declare(&mut text, "FLUSH_64", f64::MIN_POSITIVE);
    declare(&mut text, "LARGEST_DIVISOR_64", 1.0 / f64::MIN_POSITIVE);
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_device_calls_half_an_ulp_is_a_thousandth_more() {
        let raised = f64::from(ROUNDING) / error_bound::ROUNDING;
        assert!(raised > 1.001 && raised < 1.0011, "{raised}");
        assert_eq!((DIVISION, SQUARE_ROOT, FUNCTION), (5.0 * ROUNDING, 9.0 * ROUNDING, 8.0 * ROUNDING));
        assert_eq!((FLUSH, LARGEST_DIVISOR), (f32::MIN_POSITIVE, 2f32.powi(126)));
    }

    #[test]
    fn constants_are_written_as_they_are() {
        let text = common_constants();
        assert!(text.starts_with("const ROUNDING: f32 = 5.9665e-8;\n") && text.ends_with("const WORKGROUP: u32 = 64u;\n"), "{text}");
    }
}
