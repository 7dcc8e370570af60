//! The texts of the shaders, and the declarations that follow from a model's Rust records.

use crate::models::{CONDITIONS, Fields, Model};
use std::fmt::Write;

/// Numbers, own functions and decisions, for every kernel.
pub const COMMON: &str = concat!(
    include_str!("../../shaders/common/numbers.wgsl"),
    "\n",
    include_str!("../../shaders/common/functions.wgsl"),
    "\n",
    include_str!("../../shaders/common/decisions.wgsl"),
    "\n"
);

/// The text of a model: its own file, after what it shares with others.
pub fn model_source(model: &Model) -> String {
    model.shader.join("\n")
}

/// A structure of `Real`s.
fn structure(text: &mut String, name: &str, fields: &[&str]) {
    let members: String = fields.iter().map(|field| format!("    {field}: Real,\n")).collect();
    write!(text, "struct {name} {{\n{members}}}\n\n").expect("a text takes everything");
}

/// The declarations that a model's text relies on: its records as the Rust code has them.
pub fn model_prelude(model: &Model) -> String {
    let Fields { inputs, prepared, outputs } = model.kernel.fields();
    let mut text = format!("const CONDITIONS: u32 = {CONDITIONS}u;\n\n");
    structure(&mut text, "Inputs", inputs);
    structure(&mut text, "Prepared", prepared);
    structure(&mut text, "Outputs", outputs);
    text
}
