//! Rows whose designs stand in one order: what differs between them comes in by a single number.
//!
//! Where every result of a row is one number of each design, v, with numbers of the row added, multiplied and so on, each result rises or
//! falls with v, rounding and all (see [`Steps`](crate::tape::Steps)). With the designs sorted by v, those that satisfy a constraint are
//! neighbours, found by halving; the least and the largest value of an objective stand at their ends; and a stretch of neighbours has no
//! values beyond those of its two ends, so that the front known so far drops most of them at once. A row of thousands of designs is judged
//! by some dozens of values, design by design only where the front is near. The answer is the one that judging each of them gives, to the
//! last bit.
//!
//! An objective may be an input that differs within the row, as a number of bands does. Then the designs that share its value are
//! sorted a second time, as a group.

mod chain;
mod column;
mod row;
mod run;
mod sorted_row;

use column::ColumnGroup;
pub(super) use column::SortedColumn;
pub(super) use row::{OrderedNumbers, OrderedRow};
pub(super) use run::RowRun;
pub use sorted_row::{SortedDesigns, SortedRow};

use crate::models::Set;
use crate::plan::{Plan, Source, knowns};
use crate::reduce::{FreeObjectives, slice_bytes};
use crate::study::{Best, Constraint};
use crate::tape::{LaneList, List, Node};
#[cfg(feature = "gpu")]
pub(super) use chain::RowChannel;
#[cfg(not(feature = "gpu"))]
use chain::RowChannel;
use chain::{RowChain, chain};
use std::collections::HashSet;
use std::sync::OnceLock;

/// Most groups (designs that share all inputs that are objectives), and fewest designs of a group on average; otherwise designs are judged
/// one by one.
const MOST_GROUPS: u64 = 256;
const LEAST_GROUPED: u64 = 8;
/// Most bytes of sorted columns.
const MOST_BYTES: u64 = 64 << 20;
/// Bytes of a design in a sorted column: its number, which design it is, and a step; and its number once more where lanes are counted.
const DESIGN_BYTES: u64 = 8 + 2 + 2;
const COUNTED_BYTES: u64 = 8;

/// What is known of such rows; for all threads.
#[derive(Debug)]
pub(super) struct OrderedRows {
    channel: Node,
    /// What the number is made of, operands first.
    below: Vec<Node>,
    chains: Vec<RowChain>,
    /// What these read of a row.
    reads: Vec<Node>,
    /// Chains, and between what their results must lie.
    bounds: Vec<(usize, (f64, f64))>,
    /// Inputs of the fast axes that are constraints, and between what they must lie.
    input_bounds: Vec<(usize, (f64, f64))>,
    /// Of each tracked quantity: the input of the fast axes that it is, if it is an objective.
    inputs: Vec<Option<usize>>,
    /// The two objectives that can differ within a group; `None` if more can.
    free: Option<FreeObjectives>,
    /// Dimensions of the slow axes that the number depends on, with the distance of two levels among the columns.
    dimensions: Vec<(usize, u64)>,
    /// Are feasible designs counted lane by lane?
    counts_lanes: bool,
    /// How many settings of [`Self::inputs`] there are; zero where no objective is such an input.
    groups: u64,
    /// `None` for a column whose numbers are not all finite.
    columns: Vec<OnceLock<Option<SortedColumn>>>,
}

impl OrderedRows {
    /// `None` where the rows of a plan are none of that kind.
    pub(super) fn new(plan: &Plan, list: &LaneList) -> Option<Self> {
        if plan.scenarios() != 1 || plan.spectrum.is_some() {
            return None;
        }
        let inputs = lane_objectives(plan);
        let groups = groups(plan, &inputs);
        if groups > 0 && (groups > MOST_GROUPS || groups * LEAST_GROUPED > plan.fast.count()) {
            return None;
        }
        let over_lanes = over_lanes(plan, list);
        let depends = slow_dimensions(plan, list);
        let RowChannel { node: channel, paths } = RowChannel::new(list.list(), list.asked(), &over_lanes, &depends)?;
        let mut dimensions = Vec::new();
        let mut columns = 1u64;
        for (dimension, count) in plan.slow.dimensions().map(|(it, _)| it.count()).enumerate() {
            if depends[channel as usize].contains(dimension) {
                dimensions.push((dimension, columns));
                columns = columns.checked_mul(count)?;
            }
        }
        let counts_lanes = plan.study.report.maps.iter().any(|map| map.value == Best::Share);
        let bytes = column_bytes(plan, counts_lanes, groups) + size_of::<OnceLock<Option<SortedColumn>>>() as u64;
        let fits = columns.checked_mul(bytes).is_some_and(|bytes| bytes <= MOST_BYTES);
        if !fits || plan.fast.count() >= 1 << 16 {
            return None;
        }
        let mut reads = Vec::new();
        let chain = |(number, path): (usize, &Vec<Node>)| {
            let output = plan.lane_outputs.get(number).map(|&output| plan.study.model.outputs[output].unit);
            chain(list.list(), path, channel, output, &mut reads)
        };
        let chains = paths.iter().enumerate().map(chain).collect();
        Some(Self {
            channel,
            below: list.list().needed_by(&[channel]).into_iter().filter(|&node| over_lanes[node as usize]).collect(),
            bounds: (0..paths.len()).flat_map(|result| bounds(plan, result).into_iter().map(move |it| (result, it))).collect(),
            chains,
            reads,
            input_bounds: input_bounds(plan),
            inputs,
            free: free_objectives(plan),
            dimensions,
            counts_lanes,
            groups,
            columns: (0..columns).map(|_| OnceLock::new()).collect(),
        })
    }

    /// Bytes of all sorted columns.
    pub(super) fn bytes(&self, plan: &Plan) -> u64 {
        let one = size_of::<OnceLock<Option<SortedColumn>>>() as u64 + column_bytes(plan, self.counts_lanes, self.groups);
        self.columns.len() as u64 * one
    }

    /// Bytes of the slices of the front that a thread compares with.
    pub(super) fn slice_bytes(&self, plan: &Plan) -> u64 {
        let is_of_row = |&tracked: &usize| matches!(plan.tracked[tracked].1, Source::RowInput(_) | Source::RowOutput(_));
        let of_rows = if plan.objectives.iter().any(is_of_row) { u64::MAX } else { 1 };
        if self.free.is_some() { slice_bytes(plan.objectives.len(), self.groups.max(1).saturating_mul(of_rows)) } else { 0 }
    }

    /// What the chains read of a row, given the numbers of its operations.
    pub(super) fn others(&self, number: impl Fn(Node) -> f64) -> impl Iterator<Item = f64> {
        self.reads.iter().map(move |&node| number(node))
    }

    /// Which sorted column is that of a row, and how far it is to that of the next one along the innermost slow axis.
    pub(super) fn column_of(&self, plan: &Plan, row: u64) -> (u64, u64) {
        let column = self.dimensions.iter().map(|&(dimension, stride)| plan.slow.digit(dimension, row) * stride).sum();
        let innermost = plan.slow.dimensions().count().wrapping_sub(1);
        let step = self.dimensions.iter().find(|(dimension, _)| *dimension == innermost).map_or(0, |(_, stride)| *stride);
        (column, step)
    }

    /// A sorted column, made by `sorted` where nobody has asked for it before; `None` if rows with it are none of that kind.
    pub(super) fn column(&self, column: u64, sorted: impl FnOnce() -> Option<SortedColumn>) -> Option<&SortedColumn> {
        self.columns[column as usize].get_or_init(sorted).as_ref()
    }

    /// Chains, and between what their results must lie.
    fn bounds(&self) -> impl Iterator<Item = (&RowChain, (f64, f64))> {
        self.bounds.iter().map(|&(chain, bounds)| (&self.chains[chain], bounds))
    }

    /// A sorted column, if it has been made.
    fn made(&self, column: u64) -> Option<&SortedColumn> {
        self.columns[column as usize].get()?.as_ref()
    }
}

/// Bytes of a sorted column, without the table that it stands in.
fn column_bytes(plan: &Plan, counts_lanes: bool, groups: u64) -> u64 {
    let designs = plan.fast.count() * (DESIGN_BYTES + if counts_lanes { COUNTED_BYTES } else { 0 }) + 2;
    // Each design stands in a group once more.
    let own = (size_of::<ColumnGroup>() + 8 * plan.tracked.len() + 2) as u64;
    designs + if groups > 0 { plan.fast.count() * DESIGN_BYTES + groups * own } else { 0 }
}

/// Of each tracked quantity: the input of the fast axes that it is, if it is an objective.
fn lane_objectives(plan: &Plan) -> Vec<Option<usize>> {
    let input = |(tracked, source): (usize, Source)| match source {
        Source::LaneInput(input) if plan.objectives.contains(&tracked) => Some(input),
        _ => None,
    };
    plan.tracked.iter().map(|it| it.1).enumerate().map(input).collect()
}

/// The two objectives that can differ within a group; `None` if more can. If fewer can, objectives that the group shares make up two.
fn free_objectives(plan: &Plan) -> Option<FreeObjectives> {
    let differs = |objective: &usize| matches!(plan.tracked[plan.objectives[*objective]].1, Source::LaneOutput(_));
    let (free, common): (Vec<usize>, Vec<usize>) = (0..plan.objectives.len()).partition(differs);
    match (&free[..], &common[..]) {
        (&[first, second], _) | (&[first], &[second, ..]) | ([], &[first, second, ..]) => Some(FreeObjectives(first, second)),
        _ => None,
    }
}

/// How many different settings the fast axes have of the inputs that are objectives; zero where there are no such inputs.
fn groups(plan: &Plan, inputs: &[Option<usize>]) -> u64 {
    let read: Set = inputs.iter().flatten().copied().collect();
    let mut values = plan.study.fixed.clone();
    let mut settings = HashSet::new();
    for design in 0..if read.is_empty() { 0 } else { plan.fast.count() } {
        plan.fast.set(design, &mut values);
        settings.insert(read.iter().map(|input| values[input].to_bits()).collect::<Vec<_>>());
    }
    settings.len() as u64
}

/// Inputs of the fast axes that are constraints, and between what they must lie.
fn input_bounds(plan: &Plan) -> Vec<(usize, (f64, f64))> {
    let bounds = |(constraint, source): (&Constraint, &Source)| match *source {
        Source::LaneInput(input) => Some((input, constraint.ends())),
        _ => None,
    };
    plan.study.constraints.iter().zip(&plan.constraints).filter_map(bounds).collect()
}

/// Between what a result of the inner loop must lie: outputs come first, then margins of conditions.
fn bounds(plan: &Plan, result: usize) -> Vec<(f64, f64)> {
    match result.checked_sub(plan.lane_outputs.len()) {
        None => {
            let constraints = plan.study.constraints.iter().zip(&plan.constraints);
            constraints.filter(|(_, source)| **source == Source::LaneOutput(result)).map(|(it, _)| it.ends()).collect()
        }
        Some(margin) => {
            let strict = plan.study.model.conditions[plan.lane_conditions[margin]].strict;
            vec![(if strict { f64::from_bits(1) } else { 0.0 }, f64::INFINITY)]
        }
    }
}

/// Which operations depend on inputs that differ within a row.
fn over_lanes(plan: &Plan, list: &LaneList) -> Vec<bool> {
    let lane_inputs = plan.fast.inputs();
    let sets = list.list().dependencies(|input| if list.is_input(input) { Set::one(input.into()) } else { Set::EMPTY });
    sets.into_iter().map(|set| set.meets(lane_inputs)).collect()
}

/// Which dimensions of the slow axes each operation depends on.
fn slow_dimensions(plan: &Plan, list: &LaneList) -> Vec<Set> {
    let dimensions: Vec<Set> = plan.slow.dimensions().map(|(it, _)| it.inputs().iter().collect()).collect();
    let of_inputs = |inputs: Set| -> Set { (0..dimensions.len()).filter(|&dimension| dimensions[dimension].meets(inputs)).collect() };
    let formula = plan.study.model.kernel.formula().expect("what was laid out was recorded");
    let known = knowns(&plan.study, &plan.space);
    let whole = formula.whole(&known[..formula.fields().inputs.len()], Set::ALL, Set::ALL);
    let first = List::cut(&whole.recording, &whole.prepared.iter().copied().map(Some).collect::<Vec<_>>());
    let sets = first.dependencies(|input| Set::one(input.into()));
    let passed: Vec<Set> = first.results.iter().map(|result| result.map_or(Set::EMPTY, |node| sets[node as usize])).collect();
    list.list().dependencies(|input| match list.passed_on(input) {
        None => of_inputs(Set::one(input.into())),
        Some(number) => of_inputs(passed[number]),
    })
}

#[cfg(test)]
mod tests {
    use super::super::{CpuEngine, Tables};
    use super::*;
    use crate::reduce::{Reduction, State};
    use crate::study::study_of;

    const GRID: &str = "[design]\nfriction = { from = 0.06, to = 0.12, count = 5 }\ngroove_angle_deg = { from = 18, to = 30, count = 7 }\n\
                        ratio = { from = 0.5, to = 2, count = 9 }\nband_thickness_mm = { from = 0.1, to = 0.4, count = 31 }\n\
                        band_count = { from = 4, to = 14 }\n[fixed]\ntraction = \"limit\"\n";

    fn plan(text: &str) -> Plan {
        Plan::new(
            study_of(&crate::models::find("metal-cvt").expect("it is a model"), &format!("{GRID}{text}")).expect("the study is right"),
        )
    }

    #[derive(Clone, Copy, Debug, PartialEq)]
    enum RowsJudged {
        OneByOne,
        ByRows,
        ByRuns,
    }

    /// What remains of all designs; `between` sees the engine between parts.
    fn swept_with(plan: &Plan, judged: RowsJudged, between: impl FnMut(&mut CpuEngine<'_>, u64)) -> State {
        let mut tables = Tables::new(plan);
        assert!(tables.ordered.is_some() && tables.rows.is_some());
        match judged {
            RowsJudged::OneByOne => tables.ordered = None,
            RowsJudged::ByRows => tables.rows = None,
            RowsJudged::ByRuns => {}
        }
        let (state, has_runs) = swept_by(plan, &tables, between);
        assert_eq!(has_runs, judged == RowsJudged::ByRuns);
        state
    }

    /// The same with these tables, and whether there were runs of rows.
    fn swept_by(plan: &Plan, tables: &Tables, mut between: impl FnMut(&mut CpuEngine<'_>, u64)) -> (State, bool) {
        let ranges: Vec<_> = plan.study.report.histograms.iter().map(|it| it.range.expect("the study gives it")).collect();
        let reduction = Reduction::new(plan, &ranges);
        let mut reducers = reduction.start();
        let mut engine = CpuEngine::new(plan, tables);
        // Not whole rows at the ends, and in parts, so that the front is known to the later ones. One part ends where a run does.
        let width = plan.fast.count();
        for (first, last) in [(0, 1000), (1000, 36 * width), (36 * width, plan.designs() / 2), (plan.designs() / 2, plan.designs())] {
            between(&mut engine, first / width);
            assert_eq!(engine.screen_for(first..last, &reduction, &mut reducers), last);
            reducers.front.points();
        }
        let has_runs = engine.row_run.first.is_some();
        (reducers.state(), has_runs)
    }

    fn swept(plan: &Plan, judged: RowsJudged) -> State {
        swept_with(plan, judged, |_, _| {})
    }

    #[test]
    fn rows_judged_at_once_leave_what_their_designs_leave() {
        let constraints = [
            "[constraints]\ncapacity_axial_force_N = { max = 30000 }\ntorque_capacity_Nm = { above = 0 }\n",
            "[constraints]\ncapacity_axial_force_N = { min = 5000, max = 20000 }\ntorque_capacity_Nm = { max = 150 }\n",
            "[constraints]\ncapacity_axial_force_N = { max = 20000 }\nband_count = { max = 12 }\nband_thickness_mm = { above = 0.12 }\n",
            "",
        ];
        let objectives = [
            "[objectives]\ntorque_capacity_Nm = \"max\"\ncapacity_axial_force_N = \"min\"\n",
            "[objectives]\ncapacity_axial_force_N = \"min\"\ntorque_capacity_Nm = \"max\"\n",
            "[objectives]\ntorque_capacity_Nm = \"min\"\ncapacity_axial_force_N = \"max\"\n",
            "[objectives]\ntorque_capacity_Nm = { goal = \"max\", resolution = 5 }\ncapacity_axial_force_N = \"min\"\n",
            "[objectives]\ncapacity_axial_force_N = \"max\"\n",
            "[objectives]\ntorque_capacity_Nm = \"max\"\ncapacity_axial_force_N = \"min\"\nfriction = \"min\"\n",
            "[objectives]\ntorque_capacity_Nm = \"min\"\ncapacity_axial_force_N = \"min\"\n",
            // Inputs of the fast axes, alone and beside others.
            "[objectives]\ntorque_capacity_Nm = \"max\"\ncapacity_axial_force_N = \"min\"\nband_count = \"min\"\n",
            "[objectives]\nband_thickness_mm = \"min\"\ncapacity_axial_force_N = { goal = \"min\", resolution = 100 }\nratio = \"max\"\n",
            "[objectives]\ntorque_capacity_Nm = { goal = \"max\", resolution = 5 }\ncapacity_axial_force_N = { goal = \"min\", resolution = 100 }\n",
            "[objectives]\ncapacity_axial_force_N = { goal = \"min\", resolution = 100 }\ntorque_capacity_Nm = { goal = \"max\", resolution = 5 }\n\
             friction = \"min\"\nband_count = \"min\"\n",
            "[objectives]\nband_count = { goal = \"max\", resolution = 3 }\ncapacity_axial_force_N = \"min\"\n",
            "[objectives]\ntorque_capacity_Nm = \"max\"\nband_count = \"min\"\n",
        ];
        let mut sizes = Vec::new();
        for constraints in constraints {
            for objectives in objectives {
                let plan = plan(&format!("{constraints}{objectives}"));
                let [one_by_one, by_rows, by_runs] =
                    [RowsJudged::OneByOne, RowsJudged::ByRows, RowsJudged::ByRuns].map(|it| swept(&plan, it));
                assert!(by_rows == by_runs, "{constraints}{objectives}: {} and {}", by_rows.front.len(), by_runs.front.len());
                assert!(one_by_one == by_rows, "{constraints}{objectives}: {} and {}", one_by_one.front.len(), by_rows.front.len());
                assert!(by_rows.feasible > 1000, "{constraints}{objectives}");
                sizes.push(by_rows.front.len());
            }
        }
        assert!(sizes.iter().filter(|size| **size > 50).count() > 6, "{sizes:?}");
    }

    #[test]
    fn reports_on_rows_judged_at_once_are_those_on_their_designs() {
        let constraints = [
            "[constraints]\ncapacity_axial_force_N = { max = 20000 }\ntorque_capacity_Nm = { above = 0 }\n",
            "[constraints]\ncapacity_axial_force_N = { min = 5000, max = 20000 }\ntorque_capacity_Nm = { max = 150 }\n",
            "[constraints]\ncapacity_axial_force_N = { max = 20000 }\nband_count = { min = 7 }\nband_thickness_mm = { below = 0.3 }\n",
            "",
        ];
        // Of numbers that rise with what the row is sorted by, of the row's own, and of inputs that differ within it.
        let of = ["torque_capacity_Nm", "capacity_axial_force_N", "ratio", "traction_limit", "band_count", "band_thickness_mm"];
        let to = [200.0, 12345.6, 2.0, 0.8, 14.0, 0.35];
        // Many narrow bins, few wide ones, and one that some are below and some above.
        let histogram = |(of, to): (&str, f64), (from, bins): (f64, usize)| {
            format!("{{ of = \"{of}\", from = {}, to = {to}, bins = {bins} }}, ", from * to)
        };
        let each = |of| [(0.0, 900), (0.01, 7), (0.3, 1)].map(|bins| histogram(of, bins)).concat();
        let histograms: String = of.into_iter().zip(to).map(each).collect();
        // Cells of rows, of designs within rows, and of both, in dense maps.
        let axes = [
            ("friction", "ratio"),
            ("ratio", "band_count"),
            ("band_thickness_mm", "groove_angle_deg"),
            ("band_count", "band_thickness_mm"),
        ];
        let map = |what: &str| axes.map(|(x, y)| format!("{{ x = \"{x}\", y = \"{y}\", {what} }}, ")).concat();
        let both = |of: &str| ["min", "max"].map(|goal| map(&format!("value = \"{of}\", best = \"{goal}\""))).concat();
        let objectives = of[..2].iter().map(|of| map(&format!("value = \"{of}\""))).collect::<String>();
        let maps = map("best = \"share\"") + &objectives + &of[2..].iter().map(|of| both(of)).collect::<String>();
        let mut met = [0; 3];
        for constraints in constraints {
            for (top, goals) in of.into_iter().zip([["min", "max"], ["max", "min"]].into_iter().cycle()) {
                let report = format!(
                    "[objectives]\ntorque_capacity_Nm = \"{}\"\ncapacity_axial_force_N = \"{}\"\n[report]\nhistograms = [{histograms}]\n\
                     maps = [{maps}]\ntop = {{ by = \"{top}\", count = 500, goal = \"{}\" }}\nsample = {{ count = 100 }}\nfeasible = true\n",
                    goals[0],
                    goals[1],
                    goals[usize::from(top != of[0])],
                );
                let plan = plan(&format!("{constraints}{report}"));
                let [one_by_one, by_rows, by_runs] =
                    [RowsJudged::OneByOne, RowsJudged::ByRows, RowsJudged::ByRuns].map(|it| swept(&plan, it));
                assert!(by_rows == by_runs, "{constraints}{top}");
                assert!(one_by_one == by_rows, "{constraints}{top}: {:?}", one_by_one.reported.lacks(&by_rows.reported));
                let histograms = &by_rows.reported.histograms;
                met[0] += histograms.iter().filter(|it| it.below > 0 && it.above > 0).count();
                met[1] += histograms.iter().filter(|it| it.counts.iter().filter(|count| **count > 0).count() > 50).count();
                met[2] += usize::from(by_rows.feasible == plan.designs());
            }
        }
        assert!(met.into_iter().all(|times| times > 5), "{met:?}");
    }

    #[test]
    fn reports_without_objectives_and_maps_of_many_cells_are_those_of_single_designs() {
        let text = GRID.replace("count = 31", "count = 700").replace("count = 9", "count = 101").replace("count = 5", "count = 2");
        let text = text.replace("count = 7", "count = 1").replace("to = 30", "to = 18");
        let report = "[report]\nhistograms = [{ of = \"torque_capacity_Nm\", from = 0, to = 200, bins = 30 }]\nmaps = [\n\
                      { x = \"ratio\", y = \"band_thickness_mm\", best = \"share\" },\n\
                      { x = \"band_thickness_mm\", y = \"ratio\", value = \"torque_capacity_Nm\", best = \"max\" }]\n";
        let text = format!("{text}[constraints]\ncapacity_axial_force_N = {{ max = 20000 }}\n{report}");
        let plan = Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right"));
        let [one_by_one, by_rows, by_runs] = [RowsJudged::OneByOne, RowsJudged::ByRows, RowsJudged::ByRuns].map(|it| swept(&plan, it));
        assert!(one_by_one == by_rows && by_rows == by_runs && by_runs.front.is_empty());
        let maps = &by_runs.reported.maps;
        let met = |map: &crate::reduce::Map| (0..101 * 700).filter(|&at| map.cell(at).is_some()).count();
        assert!(met(&maps[0]) > 5_000 && met(&maps[0]) == met(&maps[1]) && by_runs.feasible < plan.designs(), "{}", met(&maps[0]));
    }

    #[test]
    fn there_is_a_column_for_each_level_that_the_number_depends_on() {
        let plan = plan("[objectives]\ntorque_capacity_Nm = \"max\"\ncapacity_axial_force_N = \"min\"\n");
        let (mut tables, reduction) = (Tables::new(&plan), Reduction::new(&plan, &[]));
        // The tension that the bands can take depends on the ratio, of the slow axes.
        let ordered = tables.ordered.as_mut().expect("it is of that kind");
        assert_eq!(ordered.columns.len(), 9);
        // Were that overlooked, what is left would be wrong.
        ordered.dimensions.clear();
        let mut wrong = reduction.start();
        CpuEngine::new(&plan, &tables).screen_for(0..plan.designs(), &reduction, &mut wrong);
        assert!(wrong.state() != swept(&plan, RowsJudged::ByRuns));
    }

    #[test]
    fn inputs_of_the_fast_axes_are_objectives_and_constraints() {
        let plan = plan(
            "[constraints]\nband_count = { max = 12 }\n[objectives]\ntorque_capacity_Nm = \"max\"\nband_count = \"min\"\n\
             band_thickness_mm = { goal = \"min\", resolution = 0.05 }\n",
        );
        // Grouped by both inputs, too few designs share a group.
        assert!(Tables::new(&plan).ordered.is_none());
        let plan = self::plan(
            "[constraints]\nband_count = { max = 12 }\ntorque_capacity_Nm = { above = 0 }\n[objectives]\nband_thickness_mm = \"min\"\n\
             capacity_axial_force_N = \"min\"\n",
        );
        let with = |change: &dyn Fn(&mut OrderedRows)| {
            let mut tables = Tables::new(&plan);
            change(tables.ordered.as_mut().expect("it is of that kind"));
            swept_by(&plan, &tables, |_, _| {}).0
        };
        let right = with(&|_| ());
        assert!(right == swept(&plan, RowsJudged::OneByOne));
        // Were an input overlooked or taken for another one, what is left would be wrong.
        assert!(with(&|rows| rows.input_bounds.clear()).feasible > right.feasible);
        let bands = plan.study.model.input("band_count");
        assert!(with(&|rows| rows.inputs.iter_mut().filter(|it| it.is_some()).for_each(|it| *it = bands)).front != right.front);
    }

    #[test]
    fn rows_of_a_long_axis_are_judged_by_stretches() {
        let text = GRID.replace("count = 9", "count = 301").replace("count = 5", "count = 3").replace("count = 7", "count = 2");
        for goals in ["", "friction = \"min\"\nratio = \"max\"\n"] {
            let text = format!("{text}[objectives]\ntorque_capacity_Nm = \"max\"\ncapacity_axial_force_N = \"min\"\n{goals}");
            let plan = Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right"));
            // Two stretches of the ratio, the last of which is the shorter one.
            let rows = Tables::new(&plan).rows.expect("there are several rows in a column");
            assert_eq!([0, 150, 151, 301].map(|row| rows.rows_beside(row)), [0..151, 0..151, 151..301, 301..452]);
            let [one_by_one, by_runs] = [RowsJudged::OneByOne, RowsJudged::ByRuns].map(|it| swept(&plan, it));
            assert!(one_by_one == by_runs, "{} and {}", one_by_one.front.len(), by_runs.front.len());
            assert!(by_runs.front.len() > 50, "{}", by_runs.front.len());
        }
    }

    #[test]
    fn rows_whose_designs_are_all_alike_are_judged() {
        // Bands so thick that bending leaves them no tension, so that no design has a capacity.
        let text = GRID.replace("from = 0.1, to = 0.4", "from = 1, to = 2");
        let text = format!("{text}[objectives]\ntorque_capacity_Nm = \"max\"\ncapacity_axial_force_N = \"min\"\n");
        let plan = Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right"));
        let [one_by_one, by_rows, by_runs] = [RowsJudged::OneByOne, RowsJudged::ByRows, RowsJudged::ByRuns].map(|it| swept(&plan, it));
        assert!(one_by_one == by_rows && by_rows == by_runs && by_runs.feasible == plan.designs());
    }

    #[test]
    fn rows_of_a_run_have_their_own_numbers() {
        let plan = plan(
            "[constraints]\ncapacity_axial_force_N = { max = 20000 }\n[objectives]\ntorque_capacity_Nm = \"max\"\ncapacity_axial_force_N = \"min\"\n",
        );
        // Were a run taken for that of the next rows, what is left would be wrong.
        let wrong = swept_with(&plan, RowsJudged::ByRuns, |engine, row| {
            let first = engine.row_run.first.as_mut();
            first.filter(|_| row == 36).into_iter().for_each(|first| *first = 36);
        });
        assert!(wrong != swept(&plan, RowsJudged::ByRuns));
    }
}
