//! Values of inputs as text.

pub use crate::decimal::{brief, plain, short};
use crate::models::Input;

/// A value of an input as people write it.
pub fn written(input: &Input, value: f64) -> String {
    input.word_for(value).map_or_else(|| plain(value), str::to_owned)
}

/// A large number in groups of three digits: 20 615 771.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) && digits.len() > 4 {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// So many of what has this name in the singular: `1 design`, `20 615 771 designs`.
pub fn counted(count: u64, one: &str) -> String {
    format!("{} {one}{}", grouped(count), if count == 1 { "" } else { "s" })
}
