//! How a study lies on the device: which values pass between the stages, where the levels of every axis stand, how the work is
//! cut into invocations.

use super::constants::{LANE_BITS, Level, WINDOW};
use super::drawn::DrawnOnDevice;
use super::held::{beyond_f32, refuse};
use crate::error::Result;
use crate::gpu::WORKGROUP;
use crate::models::{Fields, Set, Worse, input_to_si};
use crate::plan::{Plan, Source, knowns};
use crate::space::{Product, SpaceDimension};
use crate::study::{Axis, Goal, Levels, Quantity};
use crate::tape::{Operation, SettledStages, StageLists, nearest_f32};

/// Most loop iterations of one invocation: some drivers end it after 65 535 without a word.
pub const MOST_ITERATIONS: u64 = 55_000;
/// Most workgroups of a dispatch along either side.
pub const MOST_GROUPS: u64 = 65_535;
/// Lanes of a block: their answers are the bits of one word.
const BLOCK: u64 = 32;
/// Lanes of one invocation where a design takes a single evaluation: what a row needs is then loaded rarely.
const MANY_LANES: u64 = 256;
/// Lanes that are judged together: where scenarios are many, what a row gives them is expensive to load; where there is one, registers are.
const GROUP: [u64; 2] = [4, 2];
/// Least levels of an axis along which runs lie.
const LEAST_LEVELS: u64 = 8;
/// Most runs that an invocation takes: their numbers stand in the workgroup's memory.
const MOST_TURNS: u64 = 16;
/// Evaluations of a small study.
const SMALL: u64 = 20_000_000;
/// Points in the list that the closer look compares with, where no table serves.
pub const LIST: usize = 64;
/// Bins of the look-up table along its one or two coordinates.
pub const BINS: [u64; 2] = [65_536, 256];
/// Entries of a uniform buffer that every device has.
const UNIFORM_ENTRIES: usize = 4096;

/// A slow dimension: its levels stand in the table of levels, those of the outermost one as a window of them.
#[derive(Clone, Debug)]
pub struct SlowDimension {
    /// Inputs that it sets.
    pub inputs: Vec<usize>,
    /// Number of levels.
    pub count: u64,
    /// Distance of neighbours in the study's design index.
    pub stride: u64,
    /// First entry in the table of levels.
    pub offset: u32,
}

/// How the values of a fast dimension are found from the position along it.
#[derive(Clone, Debug)]
pub enum Values {
    /// In the steady table, from this entry on, an entry per input and level.
    Table(u32),
    /// `from + position * step` in SI, within `bound`.
    Linear {
        /// First value.
        from: f32,
        /// Distance.
        step: f32,
        /// Largest distance from the f64 values.
        bound: f32,
    },
}

/// A fast dimension.
#[derive(Clone, Debug)]
pub struct FastDimension {
    /// Inputs that it sets.
    pub inputs: Vec<usize>,
    /// Number of levels.
    pub count: u64,
    /// Distance of neighbours among the lanes.
    pub lane_stride: u64,
    /// Distance of neighbours in the study's design index.
    pub stride: u64,
    /// Its values.
    pub values: Values,
}

/// Scenario inputs of one kind: an entry per input and scenario in the steady table.
#[derive(Clone, Debug)]
pub struct ScenarioTable {
    /// Inputs that they set.
    pub inputs: Vec<usize>,
    /// Number of scenarios.
    pub count: u64,
    /// First entry.
    pub offset: u32,
}

/// How work is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Lanes of one invocation.
    pub lanes_each: u64,
    /// Lanes of a block of it.
    pub block: u64,
    /// Lanes that are judged together, sharing what the row gives them.
    pub group: u64,
    /// Are judged lanes kept for the closer look? Judging again is cheaper where there is but one scenario.
    pub keeps: bool,
    /// Rows of a workgroup.
    pub group_rows: u64,
    /// Invocations of a workgroup that share a row.
    pub group_chunks: u64,
}

/// Runs: lanes that differ in one fast axis alone, which are judged together first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Runs {
    /// The fast dimension along which they lie.
    pub dimension: usize,
    /// Most lanes of a run.
    pub length: u64,
    /// Distance of its neighbours among the lanes.
    pub step: u64,
    /// Runs of a row.
    pub of_row: u64,
    /// Runs of one row that a workgroup takes.
    pub at_once: u64,
    /// Rows of a workgroup.
    pub rows: u64,
}

/// A field that passes from the first stage to the second, and where it stands among those that do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Passed {
    /// Number of the field: tables count on after the single numbers.
    pub field: usize,
    /// Its first number.
    pub offset: usize,
    /// Its numbers.
    pub length: usize,
}

/// These fields, one after the other.
fn passed(fields: &Fields, read: Set) -> Vec<Passed> {
    let mut next = 0;
    let fields = fields.places().enumerate().filter(|&(field, _)| read.contains(field));
    fields
        .map(|(field, (_, length))| {
            next += length;
            Passed { field, offset: next - length, length }
        })
        .collect()
}

/// What a device computes of a design.
#[derive(Clone, Debug)]
pub enum FormulaOnDevice {
    /// The model's formula, settled and divided for the study.
    Own(Box<SettledStages>),
    /// Statistics over the draws of a study with distributions.
    Drawn(Box<DrawnOnDevice>),
}

/// A study as a device sees it.
#[derive(Clone, Debug)]
pub struct KernelLayout {
    /// The names of the formula's values.
    pub fields: Fields,
    /// What is computed.
    pub formula: FormulaOnDevice,
    /// The place of the first entry of draws in the steady table.
    pub first_case: u32,
    /// What passes from the first stage to the second.
    pub prepared: Vec<Passed>,
    /// Slow dimensions, outermost first.
    pub slow: Vec<SlowDimension>,
    /// Fast dimensions, outermost first.
    pub fast: Vec<FastDimension>,
    /// Inputs of a row that the second stage reads.
    pub row_inputs: Vec<usize>,
    /// Scenarios that the first stage reads.
    pub slow_scenarios: ScenarioTable,
    /// The others.
    pub fast_scenarios: ScenarioTable,
    /// Entries that never change.
    pub steady: Vec<Level>,
    /// Entries of the levels of all slow dimensions but the outermost, whose window follows them.
    pub levels: Vec<Level>,
    /// Can any design satisfy the constraints on inputs that are no design axes?
    pub possible: bool,
    /// Inputs whose values, rounded to f32, still differ wherever they differ in f64: as objectives they compare exactly.
    pub exact: Set,
    /// Inputs that f32 holds exactly.
    pub represented: Set,
    /// The cut.
    pub cut: Cut,
    /// Runs of lanes, if the second stage judges these first.
    pub runs: Option<Runs>,
}

impl KernelLayout {
    /// Lays out a study. `grouped`: lanes are judged in groups even where the study is small; `in_runs`: and these in runs first, which on a
    /// software device takes longer than it saves.
    ///
    /// # Errors
    /// [`Error::NotOnDevice`] if it cannot be screened on a device, and why.
    pub fn new(plan: &Plan, limited_loops: bool, grouped: bool, in_runs: bool) -> Result<Self> {
        let model = &plan.study.model;
        let used = plan.used_outputs();
        let known = knowns(&plan.study, &plan.space);
        let (fields, reads, formula) = match DrawnOnDevice::new(plan)? {
            Some(drawn) => (drawn.fields, drawn.reads, FormulaOnDevice::Drawn(Box::new(drawn))),
            None => {
                let asked = plan.row_conditions.iter().chain(&plan.lane_conditions);
                let asked: Vec<_> = asked.map(|&it| (it, model.conditions[it].strict)).collect();
                let fast = plan.fast.inputs() | plan.fast_scenarios.inputs();
                let slow: Set = (0..model.inputs.len()).filter(|&input| !fast.contains(input)).collect();
                let own = SettledStages::divided(model.on_device()?, &known, used, &asked, slow);
                (own.fields, own.reads, FormulaOnDevice::Own(Box::new(own)))
            }
        };
        let scenarios = [&plan.slow_scenarios, &plan.fast_scenarios].map(Product::count);
        let iterations = scenarios[0].saturating_mul(scenarios[1] + 1).saturating_mul(1 + fields.iterations);
        if iterations > MOST_ITERATIONS && (limited_loops || iterations > u64::from(u32::MAX) / 4) {
            return Err(refuse(format!(
                "{iterations} loop iterations over its scenarios are more than the {MOST_ITERATIONS} that this driver can be trusted with"
            )));
        }
        let set_by_axes = plan.space.designs.inputs() | plan.space.scenarios.inputs();
        let cpu_only = model
            .inputs
            .iter()
            .enumerate()
            .find(|(input, it)| it.cpu_only && (set_by_axes.contains(*input) || plan.study.fixed[*input] != it.default));
        if let Some((_, input)) = cpu_only {
            return Err(refuse(format!("the shader knows {} = {} only", input.name, input.default)));
        }
        if let Some(why) = beyond_f32(plan) {
            return Err(refuse(why));
        }
        if scenarios[0] > MOST_GROUPS {
            return Err(refuse(format!("{} slow scenarios are more than {MOST_GROUPS}", scenarios[0])));
        }
        if plan.fast.count() >= 1 << LANE_BITS {
            return Err(refuse(format!("a row of {} designs is too long", plan.fast.count())));
        }
        let mut steady = Vec::new();
        let slow_scenarios = scenario_table(plan, &plan.slow_scenarios, &mut steady);
        let fast_scenarios = scenario_table(plan, &plan.fast_scenarios, &mut steady);
        let (mut exact, mut represented) = (Set::EMPTY, Set::EMPTY);
        for product in [&plan.slow, &plan.fast] {
            for (dimension, _) in product.dimensions() {
                for (column, &input) in dimension.inputs().iter().enumerate() {
                    let (holds, differs) = in_f32(dimension, column);
                    if holds {
                        represented.insert(input);
                    }
                    if differs {
                        exact.insert(input);
                    }
                }
            }
        }
        let asked = asked_inputs(plan);
        let mut fast = Vec::new();
        let mut lane_stride = plan.fast.count();
        for (dimension, stride) in plan.fast.dimensions() {
            lane_stride /= dimension.count();
            let inputs = dimension.inputs().to_vec();
            let linear = (inputs.len() == 1 && !asked.contains(inputs[0])).then(|| linear(plan, dimension, inputs[0])).flatten();
            let values = linear.unwrap_or_else(|| {
                let offset = steady.len() as u32;
                (0..dimension.count()).for_each(|level| push_level(plan, dimension, level, &mut steady));
                Values::Table(offset)
            });
            fast.push(FastDimension { inputs, count: dimension.count(), lane_stride, stride, values });
        }

        let first_case = steady.len() as u32;
        if let FormulaOnDevice::Drawn(drawn) = &formula {
            steady.extend(&drawn.entries);
        }
        if steady.len() as u64 > WINDOW {
            return Err(refuse(format!("its rows of {} designs and its scenarios have {} values", plan.fast.count(), steady.len())));
        }
        let mut levels = Vec::new();
        let mut slow = Vec::new();
        for (number, (dimension, stride)) in plan.slow.dimensions().enumerate() {
            let count = dimension.count();
            if number > 0 && levels.len() as u64 + count * dimension.inputs().len() as u64 > WINDOW {
                let names: Vec<_> = dimension.inputs().iter().map(|&input| model.inputs[input].name.as_str()).collect();
                return Err(refuse(format!("the axis {} has {count} values and is not the first one", names.join(" + "))));
            }
            let offset = if number == 0 { u32::MAX } else { levels.len() as u32 };
            if number > 0 {
                (0..count).for_each(|level| push_level(plan, dimension, level, &mut levels));
            }
            slow.push(SlowDimension { inputs: dimension.inputs().to_vec(), count, stride, offset });
        }
        if let Some(outermost) = slow.first_mut() {
            outermost.offset = levels.len() as u32;
        }
        let slow_inputs = plan.slow.inputs();
        let cut = Cut::new(plan, fields.iterations, grouped);
        let runs = match &formula {
            FormulaOnDevice::Own(own) if in_runs && covers_ranges(&own.lists) => Runs::new(plan, &fast, asked, cut, fields.iterations),
            _ => None,
        };
        Ok(Self {
            fields,
            formula,
            first_case,
            prepared: passed(&fields, reads.prepared),
            row_inputs: (reads.inputs & slow_inputs).iter().collect(),
            slow,
            fast,
            slow_scenarios,
            fast_scenarios,
            steady,
            levels,
            possible: is_possible(plan),
            exact,
            represented,
            cut,
            runs,
        })
    }

    /// Most lanes of a row that one dispatch can take.
    pub fn widest(&self) -> u64 {
        self.runs.map_or(self.cut.widest(), |runs| (MOST_GROUPS * runs.at_once).min(1 << LANE_BITS))
    }

    /// Most rows that one dispatch can take.
    pub fn most_rows(&self) -> u64 {
        MOST_GROUPS * self.runs.map_or(self.cut.group_rows, |runs| runs.rows)
    }

    /// Workgroups that cover `rows` rows and `lanes` lanes.
    pub fn groups(&self, rows: u64, lanes: u64) -> [u32; 2] {
        match self.runs {
            Some(runs) => [rows.div_ceil(runs.rows), runs.of_row.div_ceil(runs.at_once)].map(|groups| groups as u32),
            None => self.cut.groups(rows, lanes),
        }
    }

    /// Is this condition to be asked? Not if it surely holds.
    pub fn asks(&self, condition: usize) -> bool {
        match &self.formula {
            FormulaOnDevice::Own(own) => own.open.contains(condition),
            FormulaOnDevice::Drawn(_) => true,
        }
    }

    /// Is this output a count, or the share that one is of all draws?
    pub fn counts(&self, output: usize) -> bool {
        matches!(&self.formula, FormulaOnDevice::Drawn(drawn) if drawn.counts.contains(output))
    }

    /// Do the steady entries fit a uniform buffer? A storage buffer serves too, at twice the price of a load.
    pub fn steady_is_uniform(&self) -> bool {
        self.steady.len() <= UNIFORM_ENTRIES
    }

    /// Bytes that the values passed between the stages take per row.
    pub fn prepared_bytes(&self) -> u64 {
        self.prepared_width().max(1) as u64 * self.slow_scenarios.count * 8
    }

    /// Numbers that pass between the stages, per row and slow scenario.
    pub fn prepared_width(&self) -> usize {
        self.prepared.last().map_or(0, |last| last.offset + last.length)
    }
}

/// Do the bounds of a formula's second stage hold however large those of its inputs are? What the bound of a root and of a number from a
/// table says holds near their values only.
fn covers_ranges(lists: &StageLists) -> bool {
    let is_near = |operation: &Operation| matches!(operation, Operation::Root(_) | Operation::Rolled(_));
    [&lists.conditions, &lists.finish].into_iter().all(|list| !list.operations.iter().any(is_near))
}

impl Runs {
    /// Runs along the longest fast axis whose values only rise or only fall, and that nothing asks for by itself. None where lanes are judged
    /// singly, or where neighbours in a row decide over each other.
    fn new(plan: &Plan, fast: &[FastDimension], asked: Set, cut: Cut, own: u64) -> Option<Self> {
        if cut.group == 1 || row_dominators(plan) || plan.lane_outputs.is_empty() {
            return None;
        }
        let serves = |(_, (it, (dimension, _))): &(usize, (&FastDimension, (&SpaceDimension, u64)))| {
            it.count >= LEAST_LEVELS && it.inputs.iter().all(|&input| !asked.contains(input)) && is_monotone(dimension)
        };
        let axes = fast.iter().zip(plan.fast.dimensions()).enumerate().filter(serves);
        let (dimension, (axis, _)) = axes.max_by_key(|(_, (it, _))| it.count)?;
        let length = axis.count.div_ceil(axis.count.div_ceil(BLOCK));
        let of_row = plan.fast.count() / axis.count * axis.count.div_ceil(length);
        let (shared, alone) = Cut::iterations(plan, own, cut.keeps);
        let turns = MOST_ITERATIONS / ((1 + length.div_ceil(cut.group)) * shared + length * alone);
        let most = turns.min(MOST_TURNS) * u64::from(WORKGROUP);
        if most == 0 {
            return None;
        }
        let at_once = of_row.min(most);
        Some(Self { dimension, length, step: axis.lane_stride, of_row, at_once, rows: most / at_once })
    }

    /// Runs that an invocation takes.
    pub fn turns(self) -> u64 {
        (self.rows * self.at_once).div_ceil(WORKGROUP.into())
    }
}

/// Do the values of an axis only rise or only fall?
fn is_monotone(dimension: &SpaceDimension) -> bool {
    let sorted = |column: usize| {
        let values = || (0..dimension.count()).map(|level| dimension.value(column, level));
        values().is_sorted() || values().map(|value| -value).is_sorted()
    };
    (0..dimension.inputs().len()).all(sorted)
}

impl Cut {
    /// Loop iterations of an invocation: those that a group of lanes shares, and those of one lane by itself: inside the formula, and in the
    /// closer look, where it meets a list, its neighbours, and its scenarios again unless it was kept. `own`: of the formula.
    fn iterations(plan: &Plan, own: u64, keeps: bool) -> (u64, u64) {
        let shared = plan.slow_scenarios.count() * (plan.fast_scenarios.count() + 1) + 1;
        let own = plan.scenarios() * own;
        (shared, own + LIST as u64 + 40 + if keeps { 0 } else { shared + own })
    }

    fn new(plan: &Plan, own: u64, grouped: bool) -> Self {
        let lanes = plan.fast.count();
        let keeps = plan.scenarios() > 1;
        let (iterations, alone) = Self::iterations(plan, own, keeps);
        // The driver's compiler takes longer over a group than a small study takes altogether.
        let small = !grouped && plan.designs().saturating_mul(plan.scenarios()) < SMALL;
        let mut group = if small { 1 } else { GROUP[usize::from(!keeps)].min(lanes) };
        while group > 1 && iterations + group * alone > MOST_ITERATIONS {
            group /= 2;
        }
        let most = (MOST_ITERATIONS / (iterations + group * alone)).max(1) * group;
        let wanted = (MANY_LANES / plan.scenarios()).clamp(group, most);
        // Chunks of equal size, so that the last one is not nearly empty.
        let chunks = lanes.div_ceil(wanted.min(lanes).max(1));
        let lanes_each = lanes.div_ceil(chunks).next_multiple_of(group);
        let chunks = lanes.div_ceil(lanes_each);
        let rows = plan.slow.count().min(8).next_power_of_two();
        let group_chunks = chunks.next_power_of_two().min(if row_dominators(plan) { 256 / rows } else { 64 / rows });
        // Row dominators stand in the workgroup's memory, of which every device has 16 KiB.
        let each = 4 * plan.objectives.len() as u64 * if keeps { group } else { 1 };
        let fits = (16_384 / (each * rows).max(1)).max(1);
        let group_chunks = if row_dominators(plan) {
            group_chunks.min(fits.next_power_of_two() >> u64::from(!fits.is_power_of_two()))
        } else {
            group_chunks
        };
        let group_rows = (64 / group_chunks).max(rows);
        let block = if keeps { group } else { lanes_each.min(BLOCK / group * group) };
        Self { lanes_each, block, group, keeps, group_rows, group_chunks }
    }

    /// Most lanes of a row that one dispatch can take.
    pub fn widest(self) -> u64 {
        MOST_GROUPS * self.lanes_each * self.group_chunks
    }

    /// Workgroups that cover `rows` rows and `lanes` lanes.
    pub fn groups(self, rows: u64, lanes: u64) -> [u32; 2] {
        [rows.div_ceil(self.group_rows), lanes.div_ceil(self.lanes_each * self.group_chunks)].map(|groups| groups as u32)
    }
}

/// Do neighbours in a row share an objective that only the row decides, while another one differs?
pub fn row_dominators(plan: &Plan) -> bool {
    let sources: Vec<Source> = plan.objectives.iter().map(|&position| plan.tracked[position].1).collect();
    plan.fast.count() > 1 && sources.iter().any(|it| it.is_row()) && sources.iter().any(|it| !it.is_row())
}

/// Inputs that are tracked or constrained themselves.
fn asked_inputs(plan: &Plan) -> Set {
    let asked = plan.tracked.iter().map(|(it, _)| it.quantity).chain(plan.study.constraints.iter().map(|it| it.quantity));
    let inputs = asked.filter_map(|quantity| match quantity {
        Quantity::Input(input) => Some(input),
        Quantity::Output(_) => None,
    });
    inputs.collect()
}

/// The entry of one input's value.
#[allow(clippy::cast_possible_truncation, reason = "rounding to f32 is the point")]
fn level(plan: &Plan, input: usize, value: f64) -> Level {
    let exact = input_to_si(&plan.study.model.inputs[input], value);
    let (si, bound) = nearest_f32(exact);
    // With its sign the bound is what f32 loses, but for its own rounding.
    let lost = if exact < f64::from(si) { -bound } else { bound };
    let allowed = constraints_on(plan, input).all(|constraint| constraint.holds(value));
    [si, lost, value as f32, if allowed { 1.0 } else { 0.0 }]
}

/// Appends the entries of one level of a dimension, an entry per input.
pub fn push_level(plan: &Plan, dimension: &SpaceDimension, at: u64, entries: &mut Vec<Level>) {
    for (column, &input) in dimension.inputs().iter().enumerate() {
        entries.push(level(plan, input, dimension.value(column, at)));
    }
}

fn constraints_on(plan: &Plan, input: usize) -> impl Iterator<Item = &crate::study::Constraint> {
    plan.study.constraints.iter().filter(move |it| it.quantity == Quantity::Input(input))
}

fn scenario_table(plan: &Plan, product: &Product, steady: &mut Vec<Level>) -> ScenarioTable {
    let offset = steady.len() as u32;
    let inputs: Vec<usize> = product.inputs().iter().collect();
    let mut values = plan.study.fixed.clone();
    for scenario in 0..product.count() {
        product.set(scenario, &mut values);
        steady.extend(inputs.iter().map(|&input| level(plan, input, values[input])));
    }
    ScenarioTable { inputs, count: product.count(), offset }
}

/// Does f32 hold all levels of an input exactly, and do they differ in f32 wherever they differ in f64?
#[allow(clippy::cast_possible_truncation, reason = "rounding to f32 is the question")]
fn in_f32(dimension: &SpaceDimension, column: usize) -> (bool, bool) {
    if matches!(dimension, SpaceDimension::Sampled(_)) || dimension.count() > WINDOW {
        return (false, false);
    }
    let mut values: Vec<f64> = (0..dimension.count()).map(|level| dimension.value(column, level)).collect();
    let holds = values.iter().all(|&value| f64::from(value as f32) == value);
    values.sort_by(f64::total_cmp);
    values.dedup();
    (holds, values.windows(2).all(|pair| (pair[0] as f32) < pair[1] as f32))
}

/// The linear rule of a fast axis, with the largest error that its evaluation in f32 can have, whether it is contracted or not.
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "the rounding is measured")]
fn linear(plan: &Plan, dimension: &SpaceDimension, input: usize) -> Option<Values> {
    let SpaceDimension::Axis(Axis::Single { levels, .. }) = dimension else { return None };
    if !matches!(levels, Levels::Even { log: false, .. } | Levels::Step { log: false, .. }) || levels.count() > WINDOW {
        return None;
    }
    let table = &plan.study.model.inputs[input];
    let si = |level: u64| input_to_si(table, levels.value(level));
    let from = si(0) as f32;
    let step = if levels.count() > 1 { ((si(levels.count() - 1) - si(0)) / (levels.count() - 1) as f64) as f32 } else { 0.0 };
    let error = |level: u64| {
        let position = level as f32;
        let apart = f64::from(from + position * step);
        let fused = f64::from(position.mul_add(step, from));
        (apart - si(level)).abs().max((fused - si(level)).abs())
    };
    let bound = (0..levels.count()).map(error).fold(0.0, f64::max);
    let bound = if bound == 0.0 { 0.0 } else { (bound as f32).next_up() };
    Some(Values::Linear { from, step, bound })
}

/// Constraints on fixed inputs and on scenario inputs hold for every design or for none.
fn is_possible(plan: &Plan) -> bool {
    let design = plan.space.designs.inputs();
    let holds = |input: usize, value: f64| constraints_on(plan, input).all(|constraint| constraint.holds(value));
    let scenario = plan.space.scenarios.dimensions().all(|(dimension, _)| {
        dimension
            .inputs()
            .iter()
            .enumerate()
            .all(|(column, &input)| (0..dimension.count()).all(|at| holds(input, dimension.value(column, at))))
    });
    let scenario_inputs = plan.space.scenarios.inputs();
    let fixed = (0..plan.study.model.inputs.len())
        .filter(|&input| !(design | scenario_inputs).contains(input))
        .all(|input| holds(input, plan.study.fixed[input]));
    scenario && fixed
}

/// The worst value over the scenarios of an input that is no design axis.
pub fn scenario_worst(plan: &Plan, input: usize, worse: Worse) -> f64 {
    let ends = plan.space.scenarios.dimensions().find_map(|(dimension, _)| {
        let column = dimension.inputs().iter().position(|&it| it == input)?;
        Some(dimension.ends(column))
    });
    let (low, high) = ends.unwrap_or((plan.study.fixed[input], plan.study.fixed[input]));
    if worse == Worse::Higher { high } else { low }
}

/// +1 where less is better.
pub fn sign(goal: Goal) -> f64 {
    if goal == Goal::Min { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    #[test]
    fn an_invocation_never_takes_more_iterations_than_a_driver_allows() {
        let study = |model: &str, axis: &str, objective: &str, scenarios: u64| {
            let text = format!(
                "model = \"{model}\"\n[design]\n{axis}\n[operation]\ncases = [{}]\n[objectives]\n{objective} = \"min\"\n",
                (0..scenarios)
                    .map(|it| format!("{{ {} = {} }}", if model == "timing-belt" { "slack_tension_N" } else { "torque_Nm" }, it + 1))
                    .collect::<Vec<_>>()
                    .join(", "),
            );
            Plan::new(Study::parse_in(&text, "test.toml", std::path::Path::new(".")).unwrap_or_else(|errors| panic!("{errors}")))
        };
        let (mut accepted, mut in_runs) = (0, 0);
        for scenarios in [1, 2, 7, 40, 91, 130, 160, 302, 400, 5000] {
            for (model, axis, objective) in [
                ("timing-belt", "tight_tension_N = { from = 6000, to = 9000, count = 3000 }", "tight_tension_N"),
                ("timing-belt", "tight_tension_N = [6000, 7000, 8000]", "tight_tension_N"),
                ("rubber-cvt", "belt_thickness_mm = { from = 1, to = 9, count = 3000 }", "belt_thickness_mm"),
                ("rubber-cvt", "belt_thickness_mm = { from = 1, to = 9, count = 3000 }", "max_stress_MPa"),
            ] {
                let plan = study(model, axis, objective, scenarios);
                for grouped in [false, true] {
                    let Ok(layout) = KernelLayout::new(&plan, true, grouped, true) else { continue };
                    let cut = layout.cut;
                    let (shared, alone) = Cut::iterations(&plan, layout.fields.iterations, cut.keeps);
                    let iterations = cut.lanes_each.div_ceil(cut.group) * shared + cut.lanes_each * alone;
                    // What one lane takes may pass the target by its closer look.
                    assert!(iterations <= MOST_ITERATIONS + 200, "{model}, {scenarios} scenarios: {cut:?} takes {iterations} iterations");
                    if let Some(runs) = layout.runs {
                        let each = (1 + runs.length.div_ceil(cut.group)) * shared + runs.length * alone;
                        assert!(runs.turns() * each <= MOST_ITERATIONS, "{model}, {scenarios} scenarios: {runs:?} of {each} iterations");
                        in_runs += 1;
                    }
                    accepted += 1;
                }
            }
        }
        assert!(accepted > 40 && in_runs > 5, "{accepted}, {in_runs}");
    }
}
