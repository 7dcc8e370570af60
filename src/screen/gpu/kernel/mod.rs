//! The kernel of a study: the shared texts, the model's text, the sweep's entry points, and a prelude that knows the study.
//!
//! Fixed inputs are constants, the axes are known, and only what the study asks for is read or written, so that the compiler
//! drops the rest of the model.

/// Appends a line to the prelude.
macro_rules! put {
    ($self:ident, $($format:tt)*) => {
        writeln!($self.text, $($format)*).expect("a text takes everything")
    };
}

mod front;
mod judging;
mod lanes;
mod report;
mod rows;
mod runs;

use super::constants::{DOMINATORS, FIRST_REPORTED, NEWTON_STEPS_OF_DRAWS, SURVIVOR_HEAD, sweep_constants};
use super::cut::{RunsAlong, looks_at_all, row_dominators};
use super::held::on_device;
use super::layout::{BINS, FormulaOnDevice, KernelLayout, LIST, Values, scenario_worst, sign};
use super::texts::{keep_between, least_bad, literal};
use crate::gpu::constants::declare;
use crate::gpu::{Operations, WORKGROUP, model_prelude, onwards_source, source, stages_source, stages_source_64, tables};
use crate::models::{CONDITION_BOUND_FACTOR, Model, Worse};
use crate::plan::{Plan, Source};
use crate::reduce::Shuffle;
use crate::study::{Best, Constraint, Goal, MapSpec, Objective, Quantity};
use crate::tape::nearest_f32;
use std::fmt::Write;

/// Entry points of every kernel.
const ENTRIES: &[&str] = &["prepare_rows", "judge_rows", "sweep", "check"];
/// Those before `sweep` where lanes are judged in runs first.
const ENTRIES_OF_RUNS: &[&str] = &["judge_runs", "count_groups", "judge_parts"];

/// Entry points of a study's kernel.
pub fn entries(layout: &KernelLayout) -> Vec<&'static str> {
    let of_runs = if layout.runs.is_some() { ENTRIES_OF_RUNS } else { &[] };
    [ENTRIES, of_runs].concat()
}

/// How a design is compared by an objective on the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// An output with its bound.
    Plain,
    /// Steps of the resolution.
    Stepped,
    /// An input whose values f32 tells apart, or an output that is a whole number or a share that is counted.
    Exact,
}

/// Does f32 tell an input's values apart, so that they compare as in f64?
pub fn is_exact(plan: &Plan, layout: &KernelLayout, input: usize) -> bool {
    layout.exact.contains(input) || !plan.space.designs.inputs().contains(input)
}

/// The kind of each objective's coordinate.
pub fn coordinates(plan: &Plan, layout: &KernelLayout) -> Vec<Coordinate> {
    let kind = |objective: &Objective| match objective.quantity {
        _ if objective.resolution.is_some() => Coordinate::Stepped,
        Quantity::Input(input) if is_exact(plan, layout, input) => Coordinate::Exact,
        Quantity::Output(output) if plan.study.model.outputs[output].integer || layout.counts(output) => Coordinate::Exact,
        _ => Coordinate::Plain,
    };
    plan.study.objectives.iter().map(kind).collect()
}

/// Does the look-up table serve: two or three coordinates, none of steps, of which many designs share one?
pub fn uses_table(coordinates: &[Coordinate]) -> bool {
    matches!(coordinates.len(), 2 | 3) && !coordinates.contains(&Coordinate::Stepped)
}

/// Does the closer look search the front itself? Along a curve that is a matter of halving.
pub fn looks_through_front(coordinates: &[Coordinate]) -> bool {
    uses_table(coordinates) && coordinates.len() == 2
}

/// Bins along each coordinate of the table.
pub fn bins(coordinates: &[Coordinate]) -> u64 {
    BINS[usize::from(coordinates.len() == 3)]
}

/// The words of a survivor: row, lane with the reason, a lower key per objective, a lower and an upper key per map of values.
pub fn survivor_words(plan: &Plan) -> usize {
    SURVIVOR_HEAD as usize + plan.study.objectives.len() + 2 * value_maps(plan).count()
}

/// The maps that show a value, with the position of what they show among the tracked quantities.
pub fn value_maps(plan: &Plan) -> impl Iterator<Item = (&MapSpec, usize, Goal)> {
    plan.study.report.maps.iter().filter_map(|spec| {
        let Best::Value(quantity, goal) = spec.value else { return None };
        Some((spec, plan.position(quantity, goal.worse()), goal))
    })
}

/// The words of a check record: verdict, then value and bound per tracked quantity, then per used output.
pub fn check_words(plan: &Plan) -> usize {
    1 + 2 * plan.tracked.len() + 2 * plan.used_outputs().len()
}

/// A number with what f32 loses of it.
fn real(value: f64) -> String {
    let (value, bound) = nearest_f32(value);
    format!("Real({}, {})", literal(value), literal(bound))
}

/// The text of the kernel. `f64`: for a device that has it. `perturb`: outputs that are to come out wrong by this fraction of their value, for
/// testing.
pub fn text(plan: &Plan, layout: &KernelLayout, f64: bool, perturb: &[(usize, f64)]) -> String {
    let model = &plan.study.model;
    let double = match &layout.formula {
        FormulaOnDevice::Own(own) if f64 => stages_source_64(model, &layout.fields, &own.lists),
        _ => None,
    };
    let f64 = double.is_some();
    let mut prelude = Prelude { plan, layout, f64, text: String::new(), coordinates: coordinates(plan, layout) };
    prelude.constants();
    prelude.inputs();
    prelude.rows();
    prelude.passing();
    prelude.lanes();
    prelude.runs();
    prelude.sorted();
    prelude.scenarios();
    prelude.judging(perturb);
    prelude.front();
    prelude.others();
    prelude.report();
    let conditions = plan.row_conditions.iter().chain(&plan.lane_conditions).copied();
    let asked: Vec<usize> = conditions.filter(|&number| layout.asks(number)).collect();
    let (common, of_model) = match &layout.formula {
        FormulaOnDevice::Own(own) => (source::common(), double.unwrap_or_else(|| stages_source(model, &layout.fields, &own.lists))),
        FormulaOnDevice::Drawn(drawn) => (source::common_with(NEWTON_STEPS_OF_DRAWS), drawn.text.clone()),
    };
    let around_first_stage = if f64 { include_str!("../../../../shaders/sweep/first-stage-64.wgsl") } else { "" };
    let (by_lane, runs) = (include_str!("../../../../shaders/sweep/by-lane.wgsl"), include_str!("../../../../shaders/sweep/runs.wgsl"));
    let second_stage = match layout.runs.map(|it| it.along) {
        None => [by_lane, include_str!("../../../../shaders/sweep/sweep.wgsl")].join("\n"),
        Some(RunsAlong::Axis { .. }) => [by_lane, include_str!("../../../../shaders/sweep/runs-along-axis.wgsl"), runs].join("\n"),
        Some(RunsAlong::Order) => [include_str!("../../../../shaders/sweep/runs-in-order.wgsl"), runs].join("\n"),
    };
    let of_model = of_model + &onwards(model, layout);
    [
        &common,
        &sweep_constants(),
        include_str!("../../../../shaders/common/wide.wgsl"),
        &model_prelude(&layout.fields, model.conditions.len(), plan.used_outputs(), &asked),
        &passed_tables(layout),
        &of_model,
        include_str!("../../../../shaders/sweep/tile.wgsl"),
        around_first_stage,
        include_str!("../../../../shaders/sweep/shuffle.wgsl"),
        include_str!("../../../../shaders/sweep/bins.wgsl"),
        &prelude.text,
        include_str!("../../../../shaders/sweep/prepare.wgsl"),
        include_str!("../../../../shaders/sweep/look.wgsl"),
        &second_stage,
        include_str!("../../../../shaders/sweep/check.wgsl"),
    ]
    .join("\n")
}

/// How many operations the inner loops of a kernel take, counted in its text.
pub fn operations_line(layout: &KernelLayout, text: &str) -> String {
    let operations = Operations::of(text);
    let count = |functions: &[&str]| functions.iter().map(|name| operations.in_function(name)).sum::<u64>();
    let group = layout.cut.group;
    let singly = |judge: &str| count(&[judge, "look_at_group"]).div_ceil(group);
    let counts = match layout.runs {
        Some(runs) => {
            let part = if runs.parts() > 1 { format!(" and for a part of up to {}", runs.part) } else { String::new() };
            format!(
                "{} for a run of up to {} designs{part}, {} for a design that is judged singly",
                count(&["run_of", "judge_stretch", "is_open"]),
                runs.length,
                singly("judge_in_run")
            )
        }
        None => format!("{} for a design", singly("judge_group")),
    };
    format!("// Operations in the inner loops, a loop within them counted once: {counts}.\n")
}

/// The second stage from the number on that lanes are sorted by.
fn onwards(model: &Model, layout: &KernelLayout) -> String {
    match (&layout.formula, &layout.sorted) {
        (FormulaOnDevice::Own(own), Some(_)) => {
            own.onwards.as_ref().map_or_else(String::new, |it| onwards_source(model, &layout.fields, it))
        }
        _ => String::new(),
    }
}

/// The tables that pass between the stages.
fn passed_tables(layout: &KernelLayout) -> String {
    tables(&layout.fields, |field, place| {
        let passed = layout.prepared.iter().find(|it| it.field == field)?;
        Some(format!("prepared_table[{place} + ({}u + at) * tile.rows]", passed.offset))
    })
}

struct Prelude<'a> {
    plan: &'a Plan,
    layout: &'a KernelLayout,
    /// Is the first stage in f64?
    f64: bool,
    text: String,
    coordinates: Vec<Coordinate>,
}

impl Prelude<'_> {
    fn input(&self, input: usize) -> &'static str {
        self.layout.fields.inputs[input]
    }

    fn output(&self, output: usize) -> &'static str {
        self.layout.fields.outputs[output]
    }

    /// A function of these lines.
    fn function(&mut self, head: &str, lines: &[String]) {
        put!(self, "fn {head} {{");
        for line in lines {
            put!(self, "    {line}");
        }
        put!(self, "}}\n");
    }

    fn constants(&mut self) {
        let (plan, layout) = (self.plan, self.layout);
        let cut = layout.cut;
        let uses_row_dominators = row_dominators(plan);
        let each = if cut.keeps { cut.block } else { 1 };
        // No block is longer than a part of a run. It is shorter where lanes are kept, or where a row has few.
        let block = layout.runs.map_or(cut.block, |runs| cut.block.min(runs.part));
        let shared = if uses_row_dominators { cut.group_rows * cut.group_chunks * each } else { 1 };
        for (name, value) in [
            ("SLOW_SCENARIOS", layout.slow_scenarios.count),
            ("FAST_SCENARIOS", layout.fast_scenarios.count),
            ("OBJECTIVES", plan.study.objectives.len() as u64),
            ("LANES_EACH", cut.lanes_each),
            ("BLOCK", block),
            ("BLOCKS", cut.lanes_each.div_ceil(cut.block)),
            ("GROUP", cut.group),
            ("KEPT", if cut.keeps { cut.block } else { 1 }),
            ("GROUP_ROWS", cut.group_rows),
            ("GROUP_CHUNKS", cut.group_chunks),
            ("ROW_DOMINATORS", shared),
            ("ROW_DOMINATORS_EACH", each),
            ("SURVIVOR_WORDS", survivor_words(plan) as u64),
            ("CHECK_WORDS", check_words(plan) as u64),
            ("WORST_WORDS", 2 * plan.tracked.len() as u64),
            ("FIRST_CASE", layout.first_case.into()),
        ] {
            declare(&mut self.text, name, u32::try_from(value).expect("the layout is cut to 32-bit numbers"));
        }
        for (name, value) in [("KEEPS", cut.keeps), ("USES_ROW_DOMINATORS", uses_row_dominators), ("LOOK_AT_ALL", looks_at_all(plan))] {
            declare(&mut self.text, name, value);
        }
        self.text.push('\n');
        let space = if layout.steady_is_uniform() { "uniform" } else { "storage, read" };
        put!(self, "// Levels that never change: scenarios, then fast design axes, then what is drawn.");
        put!(self, "@group(0) @binding(2) var<{space}> steady: array<vec4<f32>, {}>;\n", layout.steady.len().max(1));
    }
}

/// Constants of the histograms, whose ranges are known only when the study has been sampled.
pub fn histogram_constants(plan: &Plan, ranges: &[(f64, f64)]) -> String {
    let mut text = String::new();
    for (number, (spec, &(from, to))) in plan.study.report.histograms.iter().zip(ranges).enumerate() {
        let [from, to] = [from, to].map(|end| on_device(plan, spec.of, end));
        let per_unit = (spec.bins as f64 / (to - from)) as f32;
        writeln!(text, "const HISTOGRAM_{number}: Real = {};\nconst PER_UNIT_{number}: f32 = {};", real(from), literal(per_unit))
            .expect("a text takes everything");
    }
    text
}

/// What an objective's f64 key becomes on the device: the least f32 that a design's lower end must reach to be certainly no better
/// (for a coordinate with bounds: certainly worse).
pub fn threshold(plan: &Plan, objective: &Objective, coordinate: Coordinate, key: f64) -> f32 {
    match coordinate {
        // Steps are whole numbers.
        Coordinate::Stepped => round_up(key),
        // The very rounding that the levels had; a share becomes the count that it is of.
        Coordinate::Exact => (sign(objective.goal) * on_device(plan, objective.quantity, sign(objective.goal) * key)) as f32,
        Coordinate::Plain => {
            let value = sign(objective.goal) * on_device(plan, objective.quantity, sign(objective.goal) * key);
            round_up(value).next_up()
        }
    }
}

/// The least f32 that is not less.
#[allow(clippy::cast_possible_truncation, reason = "rounded up where it was rounded down")]
pub fn round_up(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}
