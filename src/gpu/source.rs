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

/// The declarations that a model's text relies on: its records as the Rust code has them, and which of its outputs (a bit set) and
/// conditions are asked for. Tables of the first stage are private arrays `made_...`; how the second stage reads them,
/// [`table_readers`] or a kernel's own functions say.
pub fn model_prelude(model: &Model, wanted: u64, conditions: &[usize]) -> String {
    let Fields { inputs, prepared, tables, outputs, .. } = model.kernel.fields();
    let mut text = format!("const CONDITIONS: u32 = {CONDITIONS}u;\n");
    for (number, field) in outputs.iter().enumerate() {
        writeln!(text, "const WANTS_{field}: bool = {};", wanted >> number & 1 == 1).expect("a text takes everything");
    }
    for number in 0..model.conditions.len() {
        writeln!(text, "const ASKS_CONDITION_{number}: bool = {};", conditions.contains(&number)).expect("a text takes everything");
    }
    text.push('\n');
    structure(&mut text, "Inputs", inputs);
    let members: String = prepared.iter().map(|field| format!("    {field}: Real,\n")).collect();
    // Where the tables of one row and slow scenario start.
    let place = if tables.is_empty() { "" } else { "    place: u32,\n" };
    write!(text, "struct Prepared {{\n{members}{place}}}\n\n").expect("a text takes everything");
    structure(&mut text, "Outputs", outputs);
    for (table, length) in tables {
        writeln!(text, "var<private> made_{table}: array<Real, {length}>;").expect("a text takes everything");
    }
    text
}

/// Functions that read every table of a model from where `entry` says its numbers stand, given its name.
pub fn table_readers(model: &Model, entry: impl Fn(usize, &str) -> String) -> String {
    let fields = model.kernel.fields();
    let reader = |(number, (table, _)): (usize, &(&str, usize))| {
        format!("fn {table}(p: Prepared, at: u32) -> Real {{\n    return {};\n}}\n\n", entry(fields.prepared.len() + number, table))
    };
    fields.tables.iter().enumerate().map(reader).collect()
}
