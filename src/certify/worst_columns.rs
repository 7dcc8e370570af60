//! Rows of many designs at once: the formula over a chunk of designs, scenario after scenario. The same bits as one by one.

use super::worst_lanes::FoundWorst;
use super::{Column, Row, pays_together};
use crate::error::{Error, Result};
use crate::models::{ColumnJudge, JudgeRoom, input_to_si};
use crate::parallel::on_threads;
use crate::plan::{Plan, knowns};
use crate::screen::Control;
use crate::study::{Axis, Quantity, Study};
use crate::tape::{ColumnValue, Known, List, Node, NodeColumns, Operation, Set};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Designs of a chunk: what the formula computes of them stays in the second-level cache.
const DESIGNS: usize = 420;
/// Formulas with more operations than this are evaluated one by one.
const MOST_OPERATIONS: usize = 4096;
/// Scenarios with more axes than this likewise.
const MOST_AXES: usize = 32;

/// Inputs that differ from design to design, with a value of each.
#[derive(Clone, Copy, Debug)]
pub struct DesignColumns<'a> {
    /// The inputs, by number.
    pub inputs: &'a [usize],
    /// Of each: one value per design, in its unit.
    pub values: &'a [&'a [f64]],
}

/// A number of a set of axes.
#[derive(Clone, Copy, Default)]
struct AxisSet {
    axes: u32,
    designs: bool,
}

impl std::ops::BitOrAssign for AxisSet {
    fn bitor_assign(&mut self, other: Self) {
        self.axes |= other.axes;
        self.designs |= other.designs;
    }
}

/// What is computed in every scenario, and what only where an axis turns.
struct WorstColumns<'p> {
    plan: &'p Plan,
    columns: &'p [Column],
    designs: DesignColumns<'p>,
    /// The axes of scenarios, the innermost last, each with the distance of two levels in the study's order.
    axes: Vec<(&'p Axis, u64)>,
    /// Outputs that are computed, by number.
    outputs: Vec<usize>,
    judge: ColumnJudge,
    list: List,
    each: Vec<bool>,
    /// Of each output that is computed, with the conditions that take it away, and of each condition behind them: its axes.
    results: Vec<AxisSet>,
    /// Of each axis: the operations that change when it or one further inside turns; and those that must be computed once.
    turns: Vec<Vec<Node>>,
    once: Vec<Node>,
}

impl<'p> WorstColumns<'p> {
    /// For these designs; `None` where the formula cannot be recorded, or the study asks for more than the worst scenario.
    fn new(plan: &'p Plan, columns: &'p [Column], designs: DesignColumns<'p>) -> Option<Self> {
        let study = &plan.study;
        let model = &study.model;
        if study.spectrum.is_some() || study.probability.is_some() {
            return None;
        }
        let formula = model.kernel.formula()?;
        let asked = columns.iter().map(|it| it.quantity).chain(study.constraints.iter().map(|it| it.quantity));
        let asked: Set = asked.chain(plan.tracked.iter().map(|(it, _)| it.quantity)).filter_map(Quantity::output).collect();
        let outputs: Vec<usize> = (0..model.outputs.len()).filter(|&it| asked.contains(it) || plan.used_outputs().contains(it)).collect();
        let of_study = axes(study);
        if of_study.len() > MOST_AXES {
            return None;
        }
        let known = known(study, designs, &of_study);
        let whole = formula.whole(&known, Set::of(&outputs), (0..model.conditions.len()).collect());
        let list = whole.settled(&known, &outputs, model.conditions.iter().map(|it| it.strict));
        if list.operations.len() > MOST_OPERATIONS {
            return None;
        }
        let axes = ordered(&list, of_study);
        let sets = dependencies(&list, &axes, designs);
        let nodes: Vec<Node> = list.results.iter().flatten().copied().collect();
        let needed = list.needed_by(&nodes);
        let reads = |node: &Node, from: usize| sets[*node as usize].axes >> from != 0;
        let turns = (0..axes.len()).map(|axis| needed.iter().copied().filter(|node| reads(node, axis)).collect()).collect();
        let once = needed.iter().copied().filter(|node| !reads(node, 0)).collect();
        let each = sets.iter().map(|it| it.designs).collect();
        let judge = ColumnJudge::new(model, &outputs, |output| plan.used_outputs().contains(output));
        let mut results: Vec<AxisSet> =
            list.results.iter().map(|node| node.map_or_else(AxisSet::default, |it| sets[it as usize])).collect();
        for place in 0..outputs.len() {
            for &condition in judge.takers(place) {
                let taker = results[outputs.len() + condition];
                results[place] |= taker;
            }
        }
        Some(Self { plan, columns, designs, axes, outputs, judge, list, each, results, turns, once })
    }

    /// The rows of a chunk of designs, from the first; `None` if it was stopped.
    fn rows(&self, first: usize, count: usize, numbers: &mut NodeColumns, control: &Control) -> Option<Vec<Row>> {
        let (plan, model) = (self.plan, &self.plan.study.model);
        let conditions = self.outputs.len();
        let mut steps = vec![0_u64; self.axes.len()];
        let mut inputs = plan.study.fixed.clone();
        self.axes.iter().for_each(|(axis, _)| set(&mut inputs, axis, level(axis, 0)));
        numbers.begin(count);
        self.compute(&self.once, numbers, first, count, &inputs);
        let mut found = FoundWorst::new(plan, self.columns, count);
        let mut room = JudgeRoom::default();
        let mut statuses = vec![0; count];
        let mut outputs = vec![vec![0.0; count]; self.outputs.len()];
        let (mut turned, mut is_first) = (0, true);
        loop {
            if control.stop.load(Ordering::Relaxed) {
                return None;
            }
            if let Some(nodes) = self.turns.get(turned) {
                self.compute(nodes, numbers, first, count, &inputs);
            }
            // A condition that surely holds has no result.
            let result = |place: usize| self.list.results[place].map(|node| numbers.value(node, |node| self.each[node as usize]));
            let is_same = |place: usize| !is_first && self.results[place].axes >> turned == 0;
            let new = |place: usize| result(place).filter(|_| !is_same(place));
            let mut places: Vec<&mut [f64]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
            self.judge.judge(model, |condition| new(conditions + condition), new, &mut statuses, &mut places, &mut room);
            let scenario = steps.iter().zip(&self.axes).map(|(&step, (axis, stride))| level(axis, step) * stride).sum();
            let value = |quantity: Quantity| match quantity {
                Quantity::Output(output) => {
                    let place = self.outputs.iter().position(|&it| it == output).expect("it is computed");
                    (ColumnValue::Each(&outputs[place]), is_same(place))
                }
                Quantity::Input(input) => match self.designs.inputs.iter().position(|&it| it == input) {
                    Some(column) => (ColumnValue::Each(&self.designs.values[column][first..first + count]), !is_first),
                    None => (ColumnValue::One(inputs[input]), false),
                },
            };
            found.take(scenario, &statuses, value);
            is_first = false;
            // The next scenario: the innermost axis turns fastest.
            let Some(axis) = (0..steps.len()).rev().find(|&axis| steps[axis] + 1 < self.axes[axis].0.count()) else { break };
            steps[axis] += 1;
            steps[axis + 1..].fill(0);
            (axis..steps.len()).for_each(|axis| set(&mut inputs, self.axes[axis].0, level(self.axes[axis].0, steps[axis])));
            turned = axis;
        }
        control.certified.fetch_add(count as u64, Ordering::Relaxed);
        let mut of_first = plan.study.fixed.clone();
        axes(&plan.study).iter().for_each(|(axis, _)| set(&mut of_first, axis, 0));
        let inputs_of = |lane: usize| {
            let mut inputs = of_first.clone();
            self.designs.inputs.iter().zip(self.designs.values).for_each(|(&input, values)| inputs[input] = values[first + lane]);
            inputs
        };
        Some(found.into_rows(first, inputs_of))
    }

    fn compute(&self, nodes: &[Node], numbers: &mut NodeColumns, first: usize, count: usize, inputs: &[f64]) {
        let model = &self.plan.study.model;
        for &node in nodes {
            match self.list.operations[node as usize] {
                Operation::Input(number) => {
                    let number = usize::from(number);
                    let input = &model.inputs[number];
                    match self.designs.inputs.iter().position(|&it| it == number) {
                        Some(column) => {
                            let values = &self.designs.values[column][first..first + count];
                            numbers.fill(node, |to| to.iter_mut().zip(values).for_each(|(to, &value)| *to = input_to_si(input, value)));
                        }
                        None => numbers.slots[node as usize] = input_to_si(input, inputs[number]),
                    }
                }
                _ if self.each[node as usize] => numbers.compute(&self.list, node, |node| self.each[node as usize]),
                _ => self.list.compute(node, &mut numbers.slots),
            }
        }
    }
}

/// The axes of scenarios in the study's order, with the distance of two levels of each.
fn axes(study: &Study) -> Vec<(&Axis, u64)> {
    let mut stride = 1;
    let mut axes: Vec<(&Axis, u64)> = Vec::new();
    for axis in study.operation.iter().chain(&study.uncertainty).rev() {
        axes.push((axis, stride));
        stride *= axis.count();
    }
    axes.reverse();
    axes
}

/// The level of an axis that comes at a step: its ends first, where the worst is as a rule, so that all others change little.
fn level(axis: &Axis, step: u64) -> u64 {
    if step == 0 { axis.count() - 1 } else { step - 1 }
}

fn set(inputs: &mut [f64], axis: &Axis, level: u64) {
    axis.inputs().iter().enumerate().for_each(|(column, &input)| inputs[input] = axis.value(column, level));
}

/// What is known of every input, in SI units.
fn known(study: &Study, designs: DesignColumns<'_>, axes: &[(&Axis, u64)]) -> Vec<Known> {
    let model = &study.model;
    let si = |input: usize, value: f64| input_to_si(&model.inputs[input], value);
    let mut known: Vec<Known> = study.fixed.iter().enumerate().map(|(input, &value)| Known::Fixed(si(input, value))).collect();
    let within = |input: usize, values: &mut dyn Iterator<Item = f64>| {
        let ends =
            values.map(|value| si(input, value)).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (low.min(it), high.max(it)));
        Known::Within(ends.0, ends.1)
    };
    for (&input, values) in designs.inputs.iter().zip(designs.values) {
        known[input] = within(input, &mut values.iter().copied());
    }
    for (axis, _) in axes {
        for (column, &input) in axis.inputs().iter().enumerate() {
            known[input] = within(input, &mut (0..axis.count()).map(|level| axis.value(column, level)));
        }
    }
    known
}

/// Of every operation: the axes that it depends on, and whether it differs from design to design.
fn dependencies(list: &List, axes: &[(&Axis, u64)], designs: DesignColumns<'_>) -> Vec<AxisSet> {
    list.dependencies(|input| {
        let input = usize::from(input);
        let axis = axes.iter().position(|(axis, _)| axis.inputs().contains(&input));
        AxisSet { axes: axis.map_or(0, |axis| 1 << axis), designs: designs.inputs.contains(&input) }
    })
}

/// The axes with that one innermost on which the least work depends, and so on outwards.
fn ordered<'a>(list: &List, mut axes: Vec<(&'a Axis, u64)>) -> Vec<(&'a Axis, u64)> {
    let none = DesignColumns { inputs: &[], values: &[] };
    let sets = dependencies(list, &axes, none);
    let effort = |operation: &Operation| match operation {
        Operation::Root(_) => 100,
        Operation::Unary(..) => 8,
        Operation::Input(_) | Operation::Constant(_) => 0,
        _ => 1,
    };
    let work = |axis: usize| -> u64 {
        list.operations.iter().zip(&sets).filter(|(_, set)| set.axes >> axis & 1 == 1).map(|(it, _)| effort(it)).sum()
    };
    let mut work: Vec<u64> = (0..axes.len()).map(work).collect();
    for place in (1..axes.len()).rev() {
        let least = (0..=place).rev().min_by_key(|&axis| work[axis]).unwrap_or(place);
        axes[least..=place].rotate_left(1);
        work[least..=place].rotate_left(1);
    }
    axes
}

/// Bytes of an operation while a formula is recorded and cut to what is asked for.
const RECORDED: u64 = 150;

/// Bytes that certifying so many designs together takes on so many threads: the recorded formula, and the numbers of each thread. Of a
/// formula that is too long to be computed together, what recording it took; 0 for fewer designs than [`pays_together`] asks for.
pub(crate) fn room(plan: &Plan, columns: &[Column], designs: u64, threads: u64) -> u64 {
    let Some(formula) = plan.study.model.kernel.formula().filter(|_| pays_together(plan, designs)) else { return 0 };
    let known = knowns(&plan.study, &plan.space);
    let conditions: Vec<usize> = (0..plan.study.model.conditions.len()).collect();
    let whole = formula.whole(&known[..formula.fields().inputs.len()], plan.used_outputs(), Set::of(&conditions));
    let recorded = RECORDED * whole.recording.operations.len() as u64;

    let inputs: Vec<usize> = plan.study.design.iter().flat_map(Axis::inputs).copied().collect();
    let ends = |axis: &Axis, column: usize| {
        let values = (0..axis.count()).map(|level| axis.value(column, level));
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], it| [low.min(it), high.max(it)])
    };
    let of_axis = |axis: &'_ Axis| (0..axis.inputs().len()).map(|column| ends(axis, column)).collect::<Vec<_>>();
    let values: Vec<[f64; 2]> = plan.study.design.iter().flat_map(of_axis).collect();
    let values: Vec<&[f64]> = values.iter().map(<[f64; 2]>::as_slice).collect();
    let found = WorstColumns::new(plan, columns, DesignColumns { inputs: &inputs, values: &values });
    let numbers = found.map_or(0, |it| it.each.iter().filter(|each| **each).count() + it.outputs.len() + 3 * columns.len());
    recorded + 8 * numbers as u64 * designs.div_ceil(threads).min(DESIGNS as u64) * threads
}

/// The rows of designs of a study whose only design axis is these columns; `None` where they must be computed one by one.
///
/// # Errors
/// [`Error::Stopped`] after `control.stop`.
pub fn rows_of_columns(
    plan: &Plan,
    columns: &[Column],
    designs: DesignColumns<'_>,
    threads: usize,
    control: &Control,
) -> Option<Result<Vec<Row>>> {
    let found = WorstColumns::new(plan, columns, designs)?;
    let count = designs.values.first().map_or(0, |it| it.len());
    let length = count.div_ceil(threads.max(1)).clamp(1, DESIGNS);
    let chunks: Vec<usize> = (0..count).step_by(length).collect();
    // Whoever is done takes the next chunk: another program may have the core of somebody else.
    let next = AtomicUsize::new(0);
    let parts = on_threads(0..threads.max(1).min(chunks.len()), |_| {
        let mut numbers = NodeColumns::new(&found.list);
        let take = || chunks.get(next.fetch_add(1, Ordering::Relaxed)).copied();
        let rows = |first: usize| found.rows(first, length.min(count - first), &mut numbers, control);
        std::iter::from_fn(take).map(rows).collect::<Option<Vec<_>>>()
    });
    let rows = parts.into_iter().collect::<Option<Vec<_>>>().map(|parts| {
        let mut rows: Vec<Vec<Row>> = parts.into_iter().flatten().collect();
        rows.sort_unstable_by_key(|rows| rows[0].index);
        rows.into_iter().flatten().collect()
    });
    Some(rows.ok_or(Error::Stopped { kept: None }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify;
    use crate::models::Status;
    use std::path::Path;

    #[test]
    fn room_is_asked_for_where_the_designs_of_all_threads_together_are_enough() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
        let (study, _) = Study::read(&folder.join("timing-design.toml")).expect("it is right");
        let plan = Plan::new(study);
        let columns = certify::columns(&plan.study);
        let least = super::super::TOGETHER.div_ceil(plan.scenarios());
        assert_eq!(room(&plan, &columns, least - 1, 1), 0);
        let on = |threads| room(&plan, &columns, least, threads);
        assert!(on(1) > 0 && on(1) == on(least), "{} {}", on(1), on(least));
        // Each thread has its own chunk.
        let many = |threads| room(&plan, &columns, 1_000_000, threads);
        assert!(many(2) > many(1) && many(3) - many(2) == many(2) - many(1));
    }

    #[test]
    fn designs_in_columns_have_the_rows_that_each_has_alone() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
        let mut served = Vec::new();
        for name in [
            "metal-cvt",
            "rubber-cvt",
            "scooter-variator",
            "camshaft-torque",
            "timing-tension",
            "flat-belt",
            "pulley-load",
            "catalogue-v-belts",
        ] {
            let (mut study, _) = Study::read(&folder.join(format!("{name}.toml"))).expect("it is right");
            let plan = Plan::new(study.clone());
            let inputs: Vec<usize> = study.design.iter().flat_map(|axis| axis.inputs().to_vec()).collect();
            // Designs from one end of the space to the other: more chunks than threads, which must come together in order.
            let designs = plan.space.designs.coarse(700);
            let rows: Vec<Vec<f64>> = designs
                .iter()
                .map(|&design| {
                    let of_design = plan.space.inputs(design, 0);
                    inputs.iter().map(|&input| of_design[input]).collect()
                })
                .collect();
            let values: Vec<Vec<f64>> = (0..inputs.len()).map(|column| rows.iter().map(|row| row[column]).collect()).collect();
            study.labels.clear();
            study.sample = None;
            study.design = vec![Axis::Joint { inputs: inputs.clone(), rows }];
            let plan = Plan::new(study);
            let columns = certify::columns(&plan.study);
            let control = Control::default();
            let slices: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
            let designs = DesignColumns { inputs: &inputs, values: &slices };
            let Some(together) = rows_of_columns(&plan, &columns, designs, 2, &control) else { continue };
            let numbers: Vec<u64> = (0..values[0].len() as u64).collect();
            let alone = certify::one_by_one(&plan, &columns, &numbers, 2, &control).expect("nobody stops it");
            let together = together.expect("nobody stops it");
            assert_eq!(together.len(), alone.len());
            for (together, alone) in together.iter().zip(&alone) {
                assert_eq!(together, alone, "{name}");
            }
            let feasible = alone.iter().filter(|it| it.feasible).count();
            served.push((name, feasible > 0 && feasible < alone.len()));
            control.stop.store(true, Ordering::Relaxed);
            let stopped = rows_of_columns(&plan, &columns, designs, 2, &control).expect("it is served");
            assert!(matches!(stopped, Err(Error::Stopped { kept: None })));
        }
        assert!(served.len() >= 6, "{served:?}");
        assert!(served.iter().filter(|it| it.1).count() >= 4, "some hold and some do not: {served:?}");
    }

    /// The rows of a study over 6 to 14 bands with all columns, the designs computed together and one by one.
    fn together_and_alone(text: &str) -> [Vec<Row>; 2] {
        let plan = Plan::new(Study::parse(text).expect("it is right"));
        let columns = certify::all_columns(&plan.study);
        let inputs: Vec<usize> = plan.study.design.iter().flat_map(|axis| axis.inputs().to_vec()).collect();
        let values: Vec<f64> = (6..=14).map(f64::from).collect();
        let designs = DesignColumns { inputs: &inputs, values: &[&values] };
        let control = Control::default();
        let together = rows_of_columns(&plan, &columns, designs, 1, &control).expect("it is served").expect("nobody stops it");
        let alone = certify::one_by_one(&plan, &columns, &(0..9).collect::<Vec<_>>(), 1, &control).expect("nobody stops it");
        [together, alone]
    }

    #[test]
    fn what_does_not_change_with_the_scenario_overflows_in_each() {
        // With 14 bands both do: one whatever the scenario, one at the highest ratio only. With the least friction every belt slips.
        let text = "model = \"metal-cvt\"\n[design]\nband_count = { from = 6, to = 14 }\n[operation]\nratio = [0.5, 2, 1]\n[uncertainty]\nfriction = [0.07, 0.05, 0.09]\n[fixed]\ntraction = 0.4\n\
                    [formulas]\nhuge = \"1e306 * band_count ^ 2\"\nrising = \"5e305 * ratio * band_count ^ 2\"\n\
                    [constraints]\nhuge = { max = 1.5e308 }\nrising = { max = 1.6e308 }\n[objectives]\naxial_force_N = \"min\"\n";
        let [together, alone] = together_and_alone(text);
        assert_eq!(together, alone);
        let missing: Vec<u64> = together.iter().map(|row| row.without_result).collect();
        assert_eq!(missing, [3, 3, 3, 3, 3, 3, 3, 3, 9]);
        // It overflows in the first scenario already, before the belt slips in another one.
        assert_eq!([7, 8].map(|row: usize| together[row].status == Status::Overflow), [false, true]);
    }

    #[test]
    fn of_two_ends_that_are_met_the_excluded_one_counts() {
        for (bounds, holds) in [
            ("min = 0.5, below = 2", false),
            ("above = 0.5, max = 2", false),
            ("min = 0.5, max = 2", true),
            ("above = 0.5, below = 2", false),
            ("above = 0.4, below = 3", true),
        ] {
            let text = format!(
                "model = \"metal-cvt\"\n[design]\nband_count = {{ from = 6, to = 14 }}\n[operation]\nratio = [0.5, 1, 2]\n[fixed]\ntraction = 0.4\n\
                 [constraints]\nratio = {{ {bounds} }}\n[objectives]\naxial_force_N = \"min\"\n"
            );
            let [together, alone] = together_and_alone(&text);
            assert_eq!(together, alone, "{bounds}");
            assert!(together.len() == 9 && together.iter().all(|row| row.feasible == holds), "{bounds}");
        }
    }
}
