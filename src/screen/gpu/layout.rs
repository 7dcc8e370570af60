//! How a study lies on the device: which values pass between the stages, and where the levels of every axis stand. How the work is cut into
//! invocations, `cut` says.

use super::constants::{LANE_BITS, Level, WINDOW};
use super::cut::{Cut, Extras, MOST_GROUPS, MOST_ITERATIONS, Runs, RunsAlong, covers_ranges};
use super::drawn::DrawnOnDevice;
use super::held::{beyond_f32, refuse};
use super::row_scenarios::RowScenarios;
use super::sorted::{SortedLane, SortedLanes, chosen};
use crate::error::Result;
use crate::models::{Fields, Set, Worse, input_to_si};
use crate::plan::{Plan, knowns};
use crate::space::{Product, SpaceDimension};
use crate::study::{Axis, Goal, Levels, Quantity};
use crate::tape::{List, SettledStages, nearest_f32};

/// Points in the list that the closer look compares with, where no table serves.
pub const LIST: usize = 64;
/// Bins of the look-up table along its one or two coordinates.
pub const BINS: [u64; 2] = [65_536, 256];
/// Most points of a front of two objectives that the closer look searches.
pub const POINTS: usize = 1 << 16;
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
    /// The lanes in order, if runs lie along it.
    pub sorted: Option<SortedLanes>,
    /// Is a row told which scenarios decide about its designs? Else all are looked at.
    pub tells_scenarios: bool,
}

impl KernelLayout {
    /// Lays out a study. `grouped`: lanes are judged in groups, and these in runs first, even where the study is small; `extras`: what else the
    /// device is given.
    ///
    /// # Errors
    /// [`Error::NotOnDevice`] if it cannot be screened on a device, and why.
    pub fn new(plan: &Plan, limited_loops: bool, grouped: bool, extras: Extras) -> Result<Self> {
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
                let choice = |list: &List, inputs: &[Set]| if extras.order { chosen(plan, list, inputs) } else { None };
                let own = SettledStages::divided_with(model.on_device()?, &known, used, &asked, slow, &choice);
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
        let tells_scenarios = extras.scenarios && matches!(formula, FormulaOnDevice::Own(_)) && RowScenarios::serve(plan);
        let (mut runs, mut sorted) = (None, None);
        if let FormulaOnDevice::Own(own) = &formula {
            if let Some(onwards) = own.onwards.as_ref().filter(|it| covers_ranges([&it.conditions, &it.finish])) {
                runs = Runs::in_order(plan, cut, fields.iterations);
                sorted = SortedLanes::new(plan, onwards, grouped).filter(|_| runs.is_some());
            }
            if sorted.is_none() {
                let serves = extras.axis && covers_ranges([&own.lists.conditions, &own.lists.finish]);
                runs = if serves { Runs::new(plan, &fast, asked, cut, fields.iterations) } else { None };
            }
        }
        // A group of lanes may reach beyond the last level of the axis that its run lies along. What it finds there is left out.
        if let Some(Runs { along: RunsAlong::Axis { dimension, .. }, .. }) = runs
            && let FastDimension { inputs, values: Values::Table(_), .. } = &fast[dimension]
        {
            steady.resize(steady.len() + beyond(cut) * inputs.len(), Level::default());
        }
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
            sorted,
            tells_scenarios,
        })
    }

    /// The same, with the sorted lanes that it needs; none where no runs lie in their order, or where they turn out to have none.
    ///
    /// # Errors
    /// As [`KernelLayout::new`].
    pub fn with_lanes(plan: &Plan, limited_loops: bool, grouped: bool, extras: Extras) -> Result<(Self, Vec<SortedLane>)> {
        let layout = Self::new(plan, limited_loops, grouped, extras)?;
        match layout.sorted_lanes(plan) {
            Some(mut lanes) => {
                // Beyond the last lane of the last column.
                lanes.resize(lanes.len() + beyond(layout.cut), SortedLane::default());
                Ok((layout, lanes))
            }
            None => Ok((Self::new(plan, limited_loops, grouped, Extras { order: false, ..extras })?, Vec::new())),
        }
    }

    fn sorted_lanes(&self, plan: &Plan) -> Option<Vec<SortedLane>> {
        match (&self.sorted, &self.formula) {
            (Some(sorted), FormulaOnDevice::Own(own)) => sorted.made(plan, own),
            _ => Some(Vec::new()),
        }
    }

    /// Most lanes of a row that one dispatch can take.
    pub fn widest(&self) -> u64 {
        if self.runs.is_some() { 1 << LANE_BITS } else { self.cut.widest() }
    }

    /// Most rows that one dispatch can take.
    pub fn most_rows(&self) -> u64 {
        self.runs.map_or(MOST_GROUPS * self.cut.group_rows, Runs::most_rows)
    }

    /// Workgroups that cover `rows` rows and `lanes` lanes; where there are runs, of the pass that judges these.
    pub fn groups(&self, rows: u64, lanes: u64) -> [u32; 2] {
        match self.runs {
            Some(runs) => runs.groups(rows),
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

/// How many lanes beyond the last one a group of lanes may reach.
fn beyond(cut: Cut) -> usize {
    cut.group as usize - 1
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
