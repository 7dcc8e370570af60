//! Values of inputs as text.

pub use crate::decimal::{plain, short};
use crate::models::Input;

/// A value of an input as people write it.
pub fn written(input: &Input, value: f64) -> String {
    input.word_for(value).map_or_else(|| plain(value), str::to_owned)
}
