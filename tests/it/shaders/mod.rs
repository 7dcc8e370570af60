//! The shaders of the models: `shaders/models` must have what the program generates from the formulas.
//!
//! `shaders/write` writes them again.

use crate::every_function::every_function;
use beltspace::gpu::PointKernel;
use beltspace::models::{self, Model, Set};
use beltspace::tape::{List, Node, Operation, Recording, Rolled, RolledLoop, Root, Store, wgsl};
use reader::{Reader, constant};
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use wgpu::naga;

mod loops;
mod reader;

/// Where a model's shader stands.
fn path(model: &Model) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders/models").join(format!("{}.wgsl", model.name))
}

/// The whole file.
fn expected(model: &Model) -> String {
    let formula = model.kernel.formula().expect("what is recorded is a formula");
    let source = format!("src/models/{}.rs", model.name.replace('-', "_"));
    let equations: Vec<_> = model.outputs.iter().map(|output| output.source.as_str()).collect();
    format!("// Generated from {source} by shaders/write.\n{}", wgsl::text(formula, model.conditions.len(), &equations))
}

fn recorded() -> impl Iterator<Item = &'static Arc<Model>> {
    models::all().iter().filter(|model| model.on_gpu)
}

#[test]
fn the_shaders_in_the_repository_are_those_of_the_formulas() {
    let writes = std::env::var_os("BELTSPACE_WRITE_SHADERS").is_some();
    let mut models = 0;
    for model in recorded() {
        let (path, text) = (path(model), expected(model));
        if writes {
            std::fs::write(&path, &text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        }
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(found == text, "{} is not what the formula gives: run shaders/write", path.display());
        models += 1;
    }
    assert!(models >= 3, "{models}");
}

/// A list as its text can tell it: constants as f32 has them, roots and loops that are in use, and where the results are.
struct Expected {
    recording: Recording,
    results: Vec<Node>,
    roots: Vec<Root>,
    loops: Vec<RolledLoop>,
    /// By table: what it was made as, if that is filled with zeros.
    tables: Vec<Node>,
    /// Of every loop: the numbers of its state that are in use.
    states: Vec<Vec<u8>>,
}

fn rounded(list: &List) -> Expected {
    let mut recording = Recording::default();
    let mut place: Vec<Node> = Vec::new();
    let mut tables = vec![Node::MAX; list.tables.len()];
    for &operation in &list.operations {
        let at = |node: Node| place[node as usize];
        let operation = match operation {
            Operation::Constant(bits) => constant(f64::from_bits(bits) as f32),
            Operation::Unary(of, a) => Operation::Unary(of, at(a)),
            Operation::Binary(of, a, b) => Operation::Binary(of, at(a), at(b)),
            Operation::Select(margin, a, b) => Operation::Select(at(margin), at(a), at(b)),
            Operation::Rolled(rolled) => Operation::Rolled(rolled.map(at)),
            other => other,
        };
        place.push(recording.push(operation));
        if let Operation::Rolled(Rolled::Table(table, fill)) = operation
            && recording.operations[fill as usize] == Operation::Constant(0)
        {
            tables[usize::from(table)] = place[place.len() - 1];
        }
    }
    let at = |node: Node| place[node as usize];
    let root = |Root { bracket, start, argument, value, slope, smoothness, .. }| Root {
        bracket: (at(bracket.0), at(bracket.1)),
        start: at(start),
        argument: at(argument),
        value: at(value),
        slope: at(slope),
        smoothness,
        // No shader is told of it.
        function: None,
    };
    let used = |number: &usize| list.operations.contains(&Operation::Root(*number as u8));
    let roots = (0..list.roots.len()).filter(used).map(|number| root(list.roots[number].root)).collect();
    let in_use = |used: &[bool]| (0..used.len()).filter(|&at| used[at]).collect::<Vec<_>>();
    let one = |it: &beltspace::tape::ListLoop| RolledLoop {
        end: at(it.recorded.end),
        state: in_use(&it.used).into_iter().map(|number| it.recorded.state[number]).map(|(begin, next)| (at(begin), at(next))).collect(),
        names: &[],
        stores: it.recorded.stores.iter().map(|store| Store { number: at(store.number), ..*store }).collect(),
        ..it.recorded.clone()
    };
    let states = list.loops.iter().map(|it| in_use(&it.used).into_iter().map(|number| number as u8).collect()).collect();
    let results = list.results.iter().flatten().map(|&node| at(node)).collect();
    let loops = list.loops.iter().map(one).collect();
    Expected { recording, results, roots, loops, tables, states }
}

/// Reads a stage back, and says what differs. `fields` are the names of its results, then those of its tables by number.
fn difference(
    source: &str,
    function: &str,
    list: &List,
    fields: &[String],
    tables: &[String],
    leaf: &dyn Fn(&str, &str) -> Operation,
) -> Option<String> {
    let module = naga::front::wgsl::parse_str(source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)));
    let Expected { mut recording, results: expected, roots, loops, tables: versions, states } = rounded(list);
    let before = recording.operations.len();
    let (open, left_at_zero, problem) = Default::default();
    let (calls, tables) = (0, tables.to_vec());
    let lengths = list.tables.iter().map(|table| table.length).collect();
    let operations = &mut recording;
    let mut reader = Reader { module: &module, operations, leaf, calls, problem, tables, lengths, versions, states, open, left_at_zero };
    let found = reader.results(function);
    let (calls, versions) = (reader.calls, reader.versions.clone());
    if reader.problem.is_some() {
        return reader.problem;
    }
    if recording.operations.len() != before {
        return Some(format!("it asks for {:?} and more", recording.operations[before]));
    }
    let is_call = |operation: &&Operation| {
        use Operation::{Argument, Constant, Input, Rolled};
        !matches!(operation, Input(_) | Constant(_) | Argument(_) | Rolled(_))
    };
    let asked = list.operations.iter().filter(is_call).count();
    if calls != asked {
        return Some(format!("{calls} calls for {asked} operations"));
    }
    for (field, expected) in fields.iter().zip(&expected) {
        if found.get(field) != Some(expected) {
            return Some(format!("{field} is another number"));
        }
    }
    if found.len() != fields.len() {
        return Some(format!("{} results for {}", found.len(), fields.len()));
    }
    if let Some(table) = expected[fields.len()..].iter().find(|it| !versions.contains(it)) {
        return Some(format!("no table is {:?}", recording.operations[*table as usize]));
    }
    if recording.roots != roots {
        return Some(format!("it looks for {:?}, not for {roots:?}", recording.roots));
    }
    (recording.loops != loops).then(|| format!("its loops are {:?}, not {loops:?}", recording.loops))
}

/// What differs between a model's shader, with a piece of its text replaced, and the recorded formula.
fn differences(model: &Model, piece: &str, other: &str) -> Vec<String> {
    let source = PointKernel::source(model, &[]).expect("it has a kernel");
    assert!(source.contains(piece), "{}: {piece}", model.name);
    let source = source.replacen(piece, other, 1);
    let formula = model.kernel.formula().expect("it is a formula");
    let names = formula.fields();
    let inputs = names.inputs.len();
    let number = |list: &[&str], field: &str| list.iter().position(|it| *it == field);
    let leaf = |structure: &str, field: &str| {
        let at = match structure {
            "i" => number(names.inputs, field),
            _ => number(names.prepared, field).map(|at| inputs + at).or_else(|| {
                let table = names.tables.iter().position(|(table, _)| *table == field)?;
                names.places().nth(names.prepared.len() + table).map(|(first, _)| inputs + first)
            }),
        };
        Operation::Input(at.expect("it is a field") as u16)
    };
    let (first, second) = formula.stages(Set::ALL, Set::ALL);
    let of = |recording: &Recording, nodes: &[Node]| List::cut(recording, &nodes.iter().copied().map(Some).collect::<Vec<_>>());
    let texts = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
    let numbers: Vec<String> = (0..model.conditions.len()).map(|it| it.to_string()).collect();
    [
        ("prepare", of(&first.recording, &first.prepared), texts(names.prepared)),
        ("conditions", of(&second.recording, &second.conditions[..model.conditions.len()]), numbers),
        ("finish", of(&second.recording, &second.outputs), texts(names.outputs)),
    ]
    .into_iter()
    .filter_map(|(function, list, fields)| {
        // Tables of the first stage that are passed on have the names of the fields; the second stage reads these.
        let mut tables: Vec<String> = list.tables.iter().map(|table| table.name.to_owned()).collect();
        let passed = names.tables.iter().map(|&(table, _)| table.to_owned());
        if function == "prepare" {
            let results = list.results[names.prepared.len()..].iter().flatten();
            results.zip(passed).for_each(|(&result, table)| tables[list.table(result)] = table);
        } else {
            tables.extend(passed);
        }
        difference(&source, function, &list, &fields, &tables, &leaf).map(|what| format!("{}: {function}: {what}", model.name))
    })
    .collect()
}

#[test]
fn a_shader_has_exactly_the_operations_of_the_formula() {
    for model in recorded() {
        assert_eq!(differences(model, "", ""), Vec::<String>::new());
    }
}

#[test]
fn another_loop_in_a_shader_is_noticed() {
    let belt = models::find("timing-belt").expect("it is a model");
    for (piece, other) in [
        ("var place_0 = 1u;", "var place_0 = 2u;"),
        ("left_1 > 0u", "left_1 > 1u"),
        ("min(whole(i.teeth_in_mesh), 60u)", "min(whole(i.teeth_in_mesh), 59u)"),
        ("tight[place_0 + 1u]", "tight[place_0]"),
        ("set_star_slack(place_1, t_star_slack)", "set_star_slack(place_1, t_star_tight)"),
        ("set_star_tight(min(whole(i.teeth_in_mesh)", "set_star_slack(min(whole(i.teeth_in_mesh)"),
        ("set_own_slack(min(whole(i.teeth_in_mesh), 60u)", "set_own_slack(min(whole(i.teeth_in_mesh), 61u)"),
        ("set_own_slack(min(whole(i.teeth_in_mesh), 60u)", "set_own_slack(whole(i.teeth_in_mesh)"),
        ("tight_before = ", "short_before = "),
        ("inward_slack(p, place_0)", "inward_tight(p, place_0)"),
        ("star_tight(p, whole(", "star_slack(p, whole("),
        ("if is_zero(meshes)", "if is_zero(counted)"),
        ("least = min_(least, ", "least = max_(least, "),
    ] {
        assert!(PointKernel::source(&belt, &[]).expect("it has a kernel").contains(piece), "{piece}");
        // What is no loop of a formula at all is refused where it is read.
        let noticed = std::panic::catch_unwind(AssertUnwindSafe(|| !differences(&belt, piece, other).is_empty()));
        assert!(noticed.unwrap_or(true), "{piece} -> {other}");
    }
}

#[test]
fn another_operation_in_a_shader_is_noticed() {
    let metal = models::all().iter().find(|model| model.name == "metal-cvt").expect("it is a model");
    for (piece, other) in [
        ("sub(driven_radius", "add(driven_radius"),
        ("constant(2.0)", "constant(2.5)"),
        ("twice(lean_)", "half(lean_)"),
        ("= smooth_newton_step(", "= newton_step("),
        ("(0.0, largest_radius", "(1.0, largest_radius"),
        ("(straight + ", "(straight - "),
        ("p.traction = traction;", "p.traction = i.traction;"),
        ("out.entry_compression = p.entry_compression;", ""),
        ("mul(i.ratio, driver_radius)", "mul(driver_radius, i.ratio)"),
    ] {
        assert_ne!(differences(metal, piece, other), Vec::<String>::new(), "{piece} -> {other}");
    }
}

#[test]
fn a_shader_has_the_elementary_functions_as_the_operations_that_they_are_made_of() {
    let model = every_function();
    assert_eq!(differences(&model, "", ""), Vec::<String>::new());
    let source = PointKernel::source(&model, &[]).expect("it has a kernel");
    naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
        .validate(&naga::front::wgsl::parse_str(&source).expect("it is WGSL"))
        .expect("it is right");
}

#[test]
fn another_operation_of_an_elementary_function_in_a_shader_is_noticed() {
    let model = every_function();
    for (piece, other) in [
        ("floor_(i.step)", "abs_(i.step)"),
        ("floor((9.536743e-7 * x))", "abs((9.536743e-7 * x))"),
        ("out.ceil = neg(", "out.ceil = abs_("),
        ("constant(709.0)", "constant(708.0)"),
        ("max_(i.x, ", "min_(i.x, "),
    ] {
        assert_ne!(differences(&model, piece, other), Vec::<String>::new(), "{piece} -> {other}");
    }
}
