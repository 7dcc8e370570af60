//! The texts of the shaders, and the declarations that follow from a model's Rust records.

use super::constants::{common_constants, constants_64};
use crate::models::{Fields, Model, Set};
use crate::tape::{Onwards, Recordable, StageLists, wgsl};
use std::collections::HashSet;
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

/// What a first stage in f64 needs besides [`common`].
pub fn common_64() -> String {
    [&constants_64(), &in_f64(include_str!("../../shaders/common/numbers.wgsl")), include_str!("../../shaders/common/functions-64.wgsl")]
        .join("\n")
}

/// A text on bounded numbers of f32 as one on those of f64: f64 stands for f32, and what `shaders/common/numbers.wgsl` and the texts that go
/// with it declare is called what it is with `_64` behind it.
pub fn in_f64(text: &str) -> String {
    let constants = constants_64();
    let shared = [include_str!("../../shaders/common/numbers.wgsl"), include_str!("../../shaders/common/functions.wgsl"), &constants];
    let declared = shared.iter().flat_map(|text| text.lines()).filter_map(|line| {
        let rest = ["fn ", "struct ", "const "].iter().find_map(|word| line.strip_prefix(word))?;
        rest.split(|it: char| !is_of_name(it)).next()
    });
    let names: HashSet<&str> = declared.map(|name| name.trim_end_matches("_64")).chain(["Inputs", "Prepared"]).collect();
    let mut written = String::with_capacity(text.len() * 5 / 4);
    let mut rest = text;
    while let Some(begin) = rest.find(is_of_name) {
        written.push_str(&rest[..begin]);
        let name = rest[begin..].split(|it: char| !is_of_name(it)).next().unwrap_or_default();
        // What stands behind a point is a member.
        let is_member = rest[..begin].ends_with('.');
        match name {
            "f32" => written.push_str("f64"),
            _ if !is_member && names.contains(name) => {
                written.push_str(name);
                written.push_str("_64");
            }
            _ => written.push_str(name),
        }
        rest = &rest[begin + name.len()..];
    }
    written + rest
}

fn is_of_name(it: char) -> bool {
    it.is_ascii_alphanumeric() || it == '_'
}

/// The text of a model, written from its recorded formula.
pub fn model_source(model: &Model, formula: &dyn Recordable) -> String {
    stages_source(model, &formula.fields(), &StageLists::whole(formula, model.conditions.len()))
}

/// The same from lists of its formula, but for the first stage, which is in f64; `None` if it cannot be.
pub fn stages_source_64(model: &Model, fields: &Fields, lists: &StageLists) -> Option<String> {
    let first = wgsl::first_stage_in_f64(&wgsl::StageNames { prepare: "prepare_64", ..wgsl::OWN }, fields, &lists.first)?;
    let mut records = String::new();
    structure(&mut records, "Inputs", fields.inputs);
    structure(&mut records, "Prepared", fields.prepared);
    Some(common_64() + "\n" + &in_f64(&(records + &first)) + &wgsl::second_stage(&wgsl::OWN, fields, lists, &equations(model)))
}

fn equations(model: &Model) -> Vec<&str> {
    model.outputs.iter().map(|output| output.source.as_str()).collect()
}

/// The same from lists of its formula.
pub fn stages_source(model: &Model, fields: &Fields, lists: &StageLists) -> String {
    wgsl::stages_text(&wgsl::OWN, fields, lists, &equations(model))
}

/// The second stage of a formula from one number on: the functions `conditions_onwards` and `finish_onwards`.
pub fn onwards_source(model: &Model, fields: &Fields, onwards: &Onwards) -> String {
    let names = wgsl::StageNames { conditions: "conditions_onwards", finish: "finish_onwards", ..wgsl::OWN };
    wgsl::onwards(&names, fields, onwards, &equations(model))
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

#[cfg(test)]
mod tests {
    use super::in_f64;

    #[test]
    fn a_text_in_f64_calls_what_is_shared_otherwise_and_nothing_else() {
        let single = "fn made(i: Inputs, add_: f32) -> Prepared {\n    p.add = add(i.add, Real(add_, FLUSH)); // add\n}";
        let double = "fn made(i: Inputs_64, add_: f64) -> Prepared_64 {\n    p.add = add_64(i.add, Real_64(add_, FLUSH_64)); // add_64\n}";
        assert_eq!(in_f64(single), double);
    }
}
