//! Lanes sorted by the one number that they differ by.
//!
//! Where all that differs within a row comes into its results by one number, neighbours in the order of that number have results next to
//! each other, which neighbours along an axis need not have. A stretch of them is a narrow run: nearly all are settled as a whole. For each
//! setting of the slow axes that the number depends on there is a column of its lanes. The host computes and sorts them in f64.

use super::held::holds;
use crate::models::{Set, to_si};
use crate::plan::{FAST_DESIGNS, Plan, Source};
use crate::screen::ordered::RowChannel;
use crate::tape::{List, Node, Onwards, SettledStages, nearest_f32};

/// Most lanes of all columns.
const MOST_ENTRIES: u64 = 1 << 22;
/// Fewest designs for each of them: sorting must cost less than it saves.
const LEAST_DESIGNS: u64 = 64;

/// Numbers nearer to zero than this have error bounds that a device may take for zero.
const LEAST_NUMBER: f64 = 1e-30;

/// A lane in its order: the bits of its number in f32, and which lane it is.
pub type SortedLane = [u32; 2];

/// Which columns there are.
#[derive(Clone, Debug)]
pub struct SortedLanes {
    /// Slow dimensions that the number depends on, with the distance in lanes between the columns of two neighbouring levels.
    pub dimensions: Vec<(usize, u64)>,
    /// Lanes of all columns.
    pub entries: u64,
}

/// The number by which all that differs within a row comes into results that are asked for, if a study has one.
pub fn chosen(plan: &Plan, list: &List, inputs: &[Set]) -> Option<Node> {
    let fast = plan.fast.inputs();
    let asks_lanes = plan.constraints.iter().chain(plan.tracked.iter().map(|(_, source)| source));
    if plan.scenarios() != 1
        || plan.fast.count() > FAST_DESIGNS
        || !plan.study.report.maps.is_empty()
        || asks_lanes.clone().any(|it| matches!(it, Source::LaneInput(_)))
    {
        return None;
    }
    let over_lanes: Vec<bool> = inputs.iter().map(|set| set.meets(fast)).collect();
    let slow: Vec<Set> = inputs.iter().map(|&set| set - fast).collect();
    let results: Vec<Node> = list.results.iter().flatten().copied().filter(|&node| over_lanes[node as usize]).collect();
    Some(RowChannel::new(list, &results, &over_lanes, &slow)?.node)
}

impl SortedLanes {
    /// `None` where sorting does not pay, or a kernel would hold too much. `always`: where the study is small too.
    pub fn new(plan: &Plan, onwards: &Onwards, always: bool) -> Option<Self> {
        let mut entries = plan.fast.count();
        let mut dimensions = Vec::new();
        for (number, (dimension, _)) in plan.slow.dimensions().enumerate() {
            if dimension.inputs().iter().any(|&input| onwards.inputs.contains(input)) {
                dimensions.push((number, entries));
                entries = entries.checked_mul(dimension.count())?;
            }
        }
        let pays = always || entries.saturating_mul(LEAST_DESIGNS) <= plan.designs();
        (pays && entries <= MOST_ENTRIES).then_some(Self { dimensions, entries })
    }

    /// The lanes of all columns, each column in order. `None` if a number is none that f32 holds: such rows have no order.
    pub fn made(&self, plan: &Plan, stages: &SettledStages) -> Option<Vec<SortedLane>> {
        let onwards = stages.onwards.as_ref()?;
        let model = &plan.study.model;
        let width = plan.fast.count();
        let mut values = plan.study.fixed.clone();
        plan.slow_scenarios.set(0, &mut values);
        plan.fast_scenarios.set(0, &mut values);
        let fast: Vec<usize> = plan.fast.inputs().iter().collect();
        let lanes: Vec<f64> = (0..width)
            .flat_map(|lane| {
                plan.fast.set(lane, &mut values);
                let si = to_si(model, &values);
                fast.iter().map(move |&input| si[input]).collect::<Vec<_>>()
            })
            .collect();
        let mut sorted = Vec::with_capacity(self.entries as usize);
        for column in 0..self.entries / width {
            plan.slow.set(self.row_of(plan, column), &mut values);
            let mut inputs = to_si(model, &values);
            inputs.extend(stages.lists.first.run(&inputs));
            let mut numbers = onwards.number.values(&inputs, f64::NAN);
            let varies = onwards.number.dependencies(|input| fast.contains(&usize::from(input)));
            let result = onwards.number.results[0]?;
            let mut places: Vec<(f64, u32)> = Vec::with_capacity(width as usize);
            for (lane, own) in (0..).zip(lanes.chunks(fast.len().max(1))) {
                fast.iter().zip(own).for_each(|(&input, &value)| inputs[input] = value);
                onwards.number.refill(&inputs, |node| varies[node], &mut numbers);
                let number = numbers[result as usize];
                if !holds(number) || (number != 0.0 && number.abs() < LEAST_NUMBER) {
                    return None;
                }
                places.push((number, lane));
            }
            places.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            sorted.extend(places.into_iter().map(|(number, lane)| [nearest_f32(number).0.to_bits(), lane]));
        }
        Some(sorted)
    }

    /// A row that has a column.
    fn row_of(&self, plan: &Plan, column: u64) -> u64 {
        let mut stride = plan.slow.count();
        let strides: Vec<u64> = plan
            .slow
            .dimensions()
            .map(|(dimension, _)| {
                stride /= dimension.count();
                stride
            })
            .collect();
        let counts: Vec<u64> = plan.slow.dimensions().map(|(dimension, _)| dimension.count()).collect();
        let entry = column * plan.fast.count();
        self.dimensions.iter().map(|&(number, distance)| entry / distance % counts[number] * strides[number]).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::screen::gpu::cut::{Extras, RunsAlong};
    use crate::screen::gpu::layout::{FormulaOnDevice, KernelLayout};
    use crate::study::Study;
    use std::path::Path;

    const STUDY: &str = r#"model = "metal-cvt"
[design]
friction = { from = 0.06, to = 0.12, count = 3 }
ratio = { from = 0.5, to = 2.0, count = 5 }
groove_angle_deg = { from = 18, to = 30, count = 4 }
band_thickness_mm = { from = 0.1, to = 0.4, count = 31 }
band_count = { from = 4, to = 14 }
[fixed]
traction = "limit"
[objectives]
torque_capacity_Nm = "max"
capacity_axial_force_N = "min"
"#;

    fn layout(text: &str) -> (Plan, KernelLayout) {
        let plan = Plan::new(Study::parse_in(text, "test.toml", Path::new(".")).unwrap_or_else(|errors| panic!("{errors}")));
        let layout = KernelLayout::new(&plan, true, true, Extras::ALL).expect("a device serves it");
        (plan, layout)
    }

    #[test]
    fn columns_hold_all_lanes_in_the_order_of_the_number_from_which_results_follow() {
        let (plan, layout) = layout(STUDY);
        let FormulaOnDevice::Own(own) = &layout.formula else { panic!("it draws nothing") };
        let onwards = own.onwards.as_ref().expect("its lanes differ by one number");
        let sorted = layout.sorted.as_ref().expect("they can be sorted");
        let lanes = sorted.made(&plan, own).expect("they have an order");
        let width = plan.fast.count();
        // The tight force depends on the ratio alone.
        assert_eq!(lanes.len() as u64, 5 * width);
        let mut values = plan.study.fixed.clone();
        for row in 0..plan.slow.count() {
            plan.slow.set(row, &mut values);
            let column = sorted.dimensions.iter().map(|&(number, distance)| plan.slow.digit(number, row) * distance).sum::<u64>();
            let column = &lanes[column as usize..][..width as usize];
            assert!(column.windows(2).all(|pair| f32::from_bits(pair[0][0]) <= f32::from_bits(pair[1][0])));
            let mut met: Vec<u32> = column.iter().map(|it| it[1]).collect();
            met.sort_unstable();
            assert!(met.into_iter().eq(0..width as u32));
            for &[bits, lane] in column.iter().step_by(17) {
                plan.fast.set(lane.into(), &mut values);
                let mut inputs = to_si(&plan.study.model, &values);
                inputs.extend(own.lists.first.run(&inputs));
                let number = onwards.number.run(&inputs)[0];
                assert_eq!(nearest_f32(number).0.to_bits(), bits);
                let expected = own.lists.finish.run(&inputs);
                *inputs.last_mut().expect("the number has a place") = number;
                assert_eq!(onwards.finish.run(&inputs), expected);
            }
        }
    }

    #[test]
    fn lanes_that_a_group_reaches_beyond_the_last_one_are_there() {
        let plan = Plan::new(Study::parse_in(STUDY, "test.toml", Path::new(".")).unwrap_or_else(|errors| panic!("{errors}")));
        let (layout, lanes) = KernelLayout::with_lanes(&plan, true, true, Extras::ALL).expect("a device serves it");
        let FormulaOnDevice::Own(own) = &layout.formula else { panic!("it draws nothing") };
        let made = layout.sorted.as_ref().and_then(|it| it.made(&plan, own)).expect("they have an order");
        assert!(layout.cut.group > 1 && lanes.len() == made.len() + layout.cut.group as usize - 1, "{} {}", lanes.len(), made.len());
        // Runs along an axis that is a list.
        let list: Vec<String> = (0..33).map(|it| format!("{}", 0.1 + 0.01 * f64::from(it * it) / 33.0)).collect();
        let text = STUDY.replace("{ from = 0.1, to = 0.4, count = 31 }", &format!("[{}]", list.join(", ")));
        assert_ne!(text, STUDY);
        let plan = Plan::new(Study::parse_in(&text, "test.toml", Path::new(".")).unwrap_or_else(|errors| panic!("{errors}")));
        let entries = |extras| {
            let layout = KernelLayout::new(&plan, true, true, extras).expect("a device serves it");
            (layout.steady.len(), layout.runs.map(|it| it.along), layout.cut.group as usize)
        };
        let (without, none, _) = entries(Extras { axis: false, order: false, ..Extras::ALL });
        let (with, along, group) = entries(Extras { order: false, ..Extras::ALL });
        assert!(none.is_none() && matches!(along, Some(RunsAlong::Axis { .. })), "{none:?} {along:?}");
        assert!(group > 1 && with == without + group - 1, "{with} {without} {group}");
    }

    #[test]
    fn rows_without_one_order_are_left_as_they_are() {
        let bound = STUDY.replace("[objectives]", "[constraints]\nband_count = { max = 13 }\n[objectives]");
        let scenarios = STUDY.replace("[fixed]", "[operation]\nstrength_MPa = [480, 500]\n[fixed]");
        // The stress margin is another number of the bands.
        let margin = STUDY.replace("[objectives]", "[objectives]\nstress_margin = \"max\"");
        let map = format!("{STUDY}[report]\nmaps = [{{ x = \"friction\", y = \"ratio\", value = \"torque_capacity_Nm\" }}]\n");
        for text in [bound, scenarios, margin, map] {
            assert!(layout(&text).1.sorted.is_none(), "{text}");
        }
        assert!(layout(STUDY).1.sorted.is_some());
    }
}
