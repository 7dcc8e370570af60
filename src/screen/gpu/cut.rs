//! How the work of a tile is cut into invocations: lanes of a row in blocks or in runs.

use super::constants::MOST_GROUPS as MOST_GROUPS_U32;
use super::layout::{FastDimension, LIST};
use crate::gpu::WORKGROUP;
use crate::models::Set;
use crate::plan::{Plan, Source};
use crate::space::SpaceDimension;
use crate::tape::{List, Operation};

/// Most loop iterations of one invocation: some drivers end it after 65 535 without a word.
pub const MOST_ITERATIONS: u64 = 55_000;
/// Most workgroups of a dispatch along either side.
pub const MOST_GROUPS: u64 = MOST_GROUPS_U32 as u64;
/// Lanes of a block: their answers are the bits of one word. Also most lanes of a run: the longer, the fewer runs there are, and the more
/// of them are open.
const BLOCK: u64 = 32;
/// Lanes of a part of a run: the shorter, the more parts of an open run there are to judge, and the fewer lanes are judged singly then.
const PART: u64 = 8;
/// Lanes of one invocation where a design takes a single evaluation: what a row needs is then loaded rarely.
const MANY_LANES: u64 = 256;
/// Lanes that are judged together: where scenarios are many, what a row gives them is expensive to load; where there is one, registers are.
const GROUP: [u64; 2] = [4, 2];
/// Least levels of an axis along which runs lie.
const LEAST_LEVELS: u64 = 8;
/// Most runs that an invocation of the first pass takes: those that are open stand in the workgroup's memory.
const MOST_TURNS: u64 = 16;
/// Those that are open, and open parts of a run, are bits of one word.
const _: () = assert!(MOST_TURNS <= 32 && BLOCK / PART <= 32);
/// Evaluations of a small study.
const SMALL: u64 = 20_000_000;

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

/// Runs: lanes with results that are near each other, which are judged together first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Runs {
    /// What neighbours in a run have in common.
    pub along: RunsAlong,
    /// Most lanes of a run.
    pub length: u64,
    /// Most lanes of a part of an open run.
    pub part: u64,
    /// Runs of a row.
    pub of_row: u64,
    /// Runs that an invocation of the first pass takes, all of one row.
    pub each: u64,
}

/// What neighbours in a run have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunsAlong {
    /// They differ in one fast axis alone.
    Axis {
        /// The fast dimension.
        dimension: usize,
        /// Their distance among the lanes.
        step: u64,
    },
    /// They are next to each other in the order of the one number that lanes differ by.
    Order,
}

/// Do the bounds of a formula's second stage hold however large those of its inputs are? What the bound of a root and of a number from a
/// table says holds near their values only.
pub fn covers_ranges(lists: [&List; 2]) -> bool {
    let is_near = |operation: &Operation| matches!(operation, Operation::Root(_) | Operation::Rolled(_));
    lists.into_iter().all(|list| !list.operations.iter().any(is_near))
}

/// What a device is given where a study allows it.
#[derive(Clone, Copy, Debug)]
pub struct Extras {
    /// Runs along an axis: they cost a software device more than they save.
    pub axis: bool,
    /// Runs in the order of the one number that lanes differ by.
    pub order: bool,
    /// The scenarios that decide about a row.
    pub scenarios: bool,
}

impl Extras {
    /// All.
    pub const ALL: Self = Self { axis: true, order: true, scenarios: true };
}

impl Runs {
    /// Runs along the longest fast axis whose values only rise or only fall, and that nothing asks for by itself. None where lanes are
    /// judged singly, or where neighbours in a row decide over each other.
    pub fn new(plan: &Plan, fast: &[FastDimension], asked: Set, cut: Cut, own: u64) -> Option<Self> {
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
        Self::cut(plan, RunsAlong::Axis { dimension, step: axis.lane_stride }, length, of_row, cut, own)
    }

    /// Runs of lanes next to each other in their order.
    pub fn in_order(plan: &Plan, cut: Cut, own: u64) -> Option<Self> {
        if cut.group == 1 || row_dominators(plan) {
            return None;
        }
        let lanes = plan.fast.count();
        let length = lanes.div_ceil(lanes.div_ceil(BLOCK));
        Self::cut(plan, RunsAlong::Order, length, lanes.div_ceil(length), cut, own)
    }

    fn cut(plan: &Plan, along: RunsAlong, length: u64, of_row: u64, cut: Cut, own: u64) -> Option<Self> {
        let (shared, alone) = Cut::iterations(plan, own, cut.keeps);
        let part = if looks_at_all(plan) { length } else { PART.min(length) };
        let each = (MOST_ITERATIONS / (shared + alone)).clamp(1, MOST_TURNS);
        // Of equal size, so that the last invocation of a row does not idle.
        let each = of_row.div_ceil(of_row.div_ceil(each));
        let runs = Self { along, length, part, of_row, each };
        let fits = runs.iterations_of_open(cut, (shared, alone)) <= MOST_ITERATIONS;
        (fits && runs.chunks() <= MOST_GROUPS * u64::from(WORKGROUP)).then_some(runs)
    }

    /// Most loop iterations of an invocation that judges the parts of an open run, or the lanes of an open part.
    fn iterations_of_open(self, cut: Cut, (shared, alone): (u64, u64)) -> u64 {
        (self.parts() * (shared + alone)).max(self.part.div_ceil(cut.group) * shared + self.part * alone)
    }

    /// Most parts of a run.
    pub fn parts(self) -> u64 {
        self.length.div_ceil(self.part)
    }

    /// Invocations of the first pass that share a row.
    pub fn chunks(self) -> u64 {
        self.of_row.div_ceil(self.each)
    }

    /// Most rows that one dispatch can take.
    pub fn most_rows(self) -> u64 {
        MOST_GROUPS * u64::from(WORKGROUP) / self.chunks()
    }

    /// Workgroups of the first pass that cover `rows` rows.
    pub fn groups(self, rows: u64) -> [u32; 2] {
        [(rows * self.chunks()).div_ceil(WORKGROUP.into()) as u32, 1]
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
    /// Loop iterations of an invocation: those that a group of lanes shares, and those of one lane by itself: inside the formula, and in
    /// the closer look, where it meets a list, its neighbours, and its scenarios again unless it was kept. `own`: of the formula.
    fn iterations(plan: &Plan, own: u64, keeps: bool) -> (u64, u64) {
        let shared = plan.slow_scenarios.count() * (plan.fast_scenarios.count() + 1) + 1;
        let own = plan.scenarios() * own;
        (shared, own + LIST as u64 + 40 + if keeps { 0 } else { shared + own })
    }

    pub fn new(plan: &Plan, own: u64, grouped: bool) -> Self {
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

/// Does the report need each feasible design by itself? Then a part of a run is settled only if nothing in it is feasible, which saves little.
pub fn looks_at_all(plan: &Plan) -> bool {
    let report = &plan.study.report;
    !report.maps.is_empty() || !report.histograms.is_empty() || report.sample.is_some() || report.feasible
}

/// Do neighbours in a row share an objective that only the row decides, while another one differs?
pub fn row_dominators(plan: &Plan) -> bool {
    let sources: Vec<Source> = plan.objectives.iter().map(|&position| plan.tracked[position].1).collect();
    plan.fast.count() > 1 && sources.iter().any(|it| it.is_row()) && sources.iter().any(|it| !it.is_row())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::screen::gpu::layout::KernelLayout;
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
                    let Ok(layout) = KernelLayout::new(&plan, true, grouped, Extras::ALL) else { continue };
                    let cut = layout.cut;
                    let (shared, alone) = Cut::iterations(&plan, layout.fields.iterations, cut.keeps);
                    let iterations = cut.lanes_each.div_ceil(cut.group) * shared + cut.lanes_each * alone;
                    // What one lane takes may pass the target by its closer look.
                    assert!(iterations <= MOST_ITERATIONS + 200, "{model}, {scenarios} scenarios: {cut:?} takes {iterations} iterations");
                    if let Some(runs) = layout.runs {
                        let of_parts = runs.length.div_ceil(runs.part) * (shared + alone);
                        let of_lanes = runs.part.div_ceil(cut.group) * shared + runs.part * alone;
                        for iterations in [runs.each * (shared + alone), of_parts, of_lanes] {
                            assert!(
                                iterations <= MOST_ITERATIONS,
                                "{model}, {scenarios} scenarios: {runs:?} takes {iterations} iterations"
                            );
                        }
                        in_runs += 1;
                    }
                    accepted += 1;
                }
            }
        }
        assert!(accepted > 40 && in_runs > 5, "{accepted}, {in_runs}");
    }
}
