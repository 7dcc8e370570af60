//! The texts of the shaders, and the declarations that follow from a model's Rust records.

use super::constants::common_constants;
use crate::models::{Fields, Model, Set};
use crate::tape::{Recordable, StageLists, wgsl};
use std::fmt::Write;

/// Most steps of the search for a root, as on the CPU.
const NEWTON_STEPS: u32 = 40;

/// Numbers, own functions and decisions, for every kernel.
pub fn common() -> String {
    common_with(NEWTON_STEPS)
}

/// The same for a kernel that searches for so many roots that each may take a few steps only.
pub fn common_with(newton_steps: u32) -> String {
    [
        &format!("const NEWTON_STEPS: i32 = {newton_steps};\n"),
        &common_constants(),
        include_str!("../../shaders/common/numbers.wgsl"),
        include_str!("../../shaders/common/functions.wgsl"),
        include_str!("../../shaders/common/decisions.wgsl"),
    ]
    .join("\n")
}

/// The text of a model, written from its recorded formula.
pub fn model_source(model: &Model, formula: &dyn Recordable) -> String {
    stages_source(model, &formula.fields(), &StageLists::whole(formula, model.conditions.len()))
}

/// The same from lists of its formula.
pub fn stages_source(model: &Model, fields: &Fields, lists: &StageLists) -> String {
    let equations: Vec<_> = model.outputs.iter().map(|output| output.source.as_str()).collect();
    wgsl::stages_text(&wgsl::OWN, fields, lists, &equations)
}

/// A structure of `Real`s.
pub fn structure(text: &mut String, name: &str, fields: &[&str]) {
    let members: String = fields.iter().map(|field| format!("    {field}: Real,\n")).collect();
    write!(text, "struct {name} {{\n{members}}}\n\n").expect("a text takes everything");
}

/// How long the array of a model's margins is in a shader, where none may be empty.
pub fn margins_len(conditions: usize) -> usize {
    conditions.max(1)
}

/// The declarations that a model's text relies on: its records as the Rust code has them, and which of its outputs and
/// its `count` conditions are asked for. What the first stage does with its tables, and how the second reads them, [`tables`] says.
pub fn model_prelude(fields: &Fields, count: usize, wanted: Set, conditions: &[usize]) -> String {
    let Fields { inputs, prepared, tables, outputs, .. } = fields;
    let mut text = format!("const CONDITIONS: u32 = {}u;\n", margins_len(count));
    for (number, field) in outputs.iter().enumerate() {
        writeln!(text, "const WANTS_{field}: bool = {};", wanted.contains(number)).expect("a text takes everything");
    }
    for number in 0..count {
        writeln!(text, "const ASKS_CONDITION_{number}: bool = {};", conditions.contains(&number)).expect("a text takes everything");
    }
    text.push('\n');
    structure(&mut text, "Inputs", inputs);
    let members: String = prepared.iter().map(|field| format!("    {field}: Real,\n")).collect();
    // Where the tables of one row and slow scenario start.
    let place = if tables.is_empty() { "" } else { "    place: u32,\n" };
    write!(text, "struct Prepared {{\n{members}{place}}}\n\n").expect("a text takes everything");
    structure(&mut text, "Outputs", outputs);
    text
}

/// Functions that set and read every table of a model, where a kernel has them: `entry` says where number `at` of a table stands,
/// given the number of its field and the place where the tables of this row start; `None` for a table that nobody reads.
pub fn tables(fields: &Fields, entry: impl Fn(usize, &str) -> Option<String>) -> String {
    if fields.tables.is_empty() {
        return String::new();
    }
    let mut text = "// Where the tables of the row that is being prepared start.\nvar<private> table_place: u32;\n\n".to_owned();
    for (number, (table, _)) in fields.tables.iter().enumerate() {
        let field = fields.prepared.len() + number;
        let (set, get) = match (entry(field, "table_place"), entry(field, "p.place")) {
            (Some(set), Some(get)) => (format!("{set} = number;"), get),
            _ => (String::new(), "constant(0.0)".to_owned()),
        };
        let set = format!("fn set_{table}(at: u32, number: Real) {{\n    {set}\n}}\n");
        write!(text, "{set}\nfn {table}(p: Prepared, at: u32) -> Real {{\n    return {get};\n}}\n\n").expect("a text takes everything");
    }
    text
}
