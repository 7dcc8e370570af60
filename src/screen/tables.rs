//! What the threads of the CPU engine share: settings of scenarios, and the designs of the fast axes by blocks.

use super::judged::JudgedDesigns;
use super::ordered::OrderedRows;
use super::row_list::RowList;
use super::rows_together::RowsTogether;
use crate::models::{self, LANES};
use crate::plan::{FAST_DESIGNS, Plan, knowns};
use crate::reduce::Reported;
use crate::space::Product;
use crate::tape::{LaneList, List, Node, Set, Varies};

/// Most designs in a block: its columns stay in the first-level cache.
pub const BLOCK: usize = 512;

/// Most scenarios, slow or fast, whose settings are kept rather than computed again.
const TABLE: u64 = 1 << 15;

/// Values that one combination of scenario axes sets: input number, in its unit, in SI.
pub(super) type Setting = Vec<(usize, f64, f64)>;

/// Values of the designs of a block, by input number.
pub(super) type InputColumns = Vec<(usize, Vec<f64>)>;

/// The inputs of the designs of one block that the fast axes set.
#[derive(Debug)]
pub(super) struct FastBlock {
    pub(super) count: usize,
    pub(super) offsets: Vec<u64>,
    /// By input number, in SI units.
    pub(super) si: InputColumns,
    /// By input number, in the input's unit, where the plan tracks or constrains the input itself.
    pub(super) own: InputColumns,
    /// What the list of [`Tables::lanes`] has in common over all rows.
    pub(super) shared: Vec<Vec<f64>>,
}

/// What all threads of an engine share: made once per plan.
#[derive(Debug)]
pub struct Tables {
    /// Settings of the slow and of the fast scenarios, while they are few.
    pub(super) slow_scenarios: Vec<Setting>,
    pub(super) fast_scenarios: Vec<Setting>,
    /// Blocks of the fast design axes, while they are few.
    pub(super) blocks: Vec<FastBlock>,
    /// The second stage as operations over columns, where that serves.
    pub(super) lanes: Option<LaneList>,
    /// Rows whose designs stand in one order, if they are of that kind.
    pub(super) ordered: Option<OrderedRows>,
    /// What is the same for a whole row as operations over all scenarios, where that serves.
    pub(super) rows: Option<RowList>,
    /// The whole formula over blocks of designs, where a row has no more than one.
    pub(super) together: Option<RowsTogether>,
    /// Designs that need not be judged any more.
    pub(super) judged: JudgedDesigns,
}

impl Tables {
    /// The tables of a plan.
    pub fn new(plan: &Plan) -> Self {
        let kept = if plan.fast.count() <= FAST_DESIGNS { plan.fast.count() } else { 0 };
        let lanes = lane_list(plan);
        let block = |first: u64| FastBlock::new(plan, lanes.as_ref(), first..kept.min(first + BLOCK as u64));
        let blocks = (0..kept).step_by(BLOCK).map(block).collect();
        let ordered = lanes.as_ref().filter(|_| kept > 0).and_then(|list| OrderedRows::new(plan, list));
        let (slow_scenarios, fast_scenarios) = (settings(plan, &plan.slow_scenarios), settings(plan, &plan.fast_scenarios));
        let rows = RowList::new(plan, lanes.as_ref(), (&slow_scenarios, &fast_scenarios));
        Self {
            slow_scenarios,
            fast_scenarios,
            blocks,
            lanes,
            ordered,
            rows,
            together: RowsTogether::new(plan),
            judged: JudgedDesigns::default(),
        }
    }

    /// From now on these designs are taken over as they are.
    pub fn take_over(&mut self, judged: JudgedDesigns) {
        self.judged = judged;
    }

    /// Are rows judged at once, by the order of their designs? Then columns are sorted when a sweep first meets them, and how fast it is
    /// depends on the front that it knows.
    pub fn has_ordered_rows(&self) -> bool {
        self.ordered.is_some()
    }

    /// Are whole rows, or several of them, judged at once?
    pub(super) fn has_rows_together(&self) -> bool {
        self.ordered.is_some() || self.together.is_some()
    }

    /// Bytes that a thread takes for rows that are judged at once: slices of the front; if the study has reports, also values and indices of a
    /// row's designs and lane counts of each map.
    pub fn row_bytes(plan: &Plan) -> u64 {
        if plan.fast.count() > FAST_DESIGNS {
            return 0;
        }
        let Some(ordered) = lane_list(plan).and_then(|list| OrderedRows::new(plan, &list)) else { return 0 };
        let (tracked, maps) = (plan.tracked.len(), plan.study.report.maps.len());
        let is_reported = !Reported::needs(&plan.study.report).is_empty();
        let designs = if is_reported { plan.fast.count() * (8 * (tracked + 2) + 12 * maps) as u64 } else { 0 };
        ordered.slice_bytes(plan) + designs
    }

    /// About how many bytes the tables of a plan take.
    pub fn bytes(plan: &Plan) -> u64 {
        let settings = |product: &Product| {
            let one = size_of::<Setting>() + product.inputs().len() * size_of::<(usize, f64, f64)>();
            if product.count() <= TABLE { product.count() * one as u64 } else { 0 }
        };
        let settings = settings(&plan.slow_scenarios) + settings(&plan.fast_scenarios);
        let settings = settings + JudgedDesigns::bytes(plan);
        if plan.fast.count() > FAST_DESIGNS {
            return settings;
        }
        let list = lane_list(plan);
        let shared = list.as_ref().map_or(0, LaneList::kept);
        let numbers = 1 + (2 * plan.fast.inputs().len() + shared) as u64;
        let sorted = list.and_then(|list| Some(OrderedRows::new(plan, &list)?.bytes(plan))).unwrap_or(0);
        settings + plan.fast.count() * 8 * numbers + sorted
    }
}

/// The second stage of a plan's formula as operations over columns; `None` where the formula's own loop serves better.
pub(super) fn lane_list(plan: &Plan) -> Option<LaneList> {
    let model = &plan.study.model;
    let formula = model.kernel.formula()?;
    let inputs = formula.fields().inputs.len();
    if plan.lane_outputs.len() + plan.lane_conditions.len() == 0 || formula.fields().iterations > 0 {
        return None;
    }
    let known = knowns(&plan.study, &plan.space);
    let second = formula.second(&known[..inputs], Set::of(&plan.lane_outputs), Set::of(&plan.lane_conditions));
    let outputs = plan.lane_outputs.iter().map(|&it| Some(second.outputs[it]));
    let asked: Vec<Option<Node>> = outputs.chain(plan.lane_conditions.iter().map(|&it| Some(second.conditions[it]))).collect();
    let list = List::cut(&second.recording, &asked);
    let asked = list.results.iter().flatten().copied().collect();
    let units: Vec<(f64, f64)> = plan.lane_outputs.iter().map(|&it| model.outputs[it].unit.factors()).collect();
    let lane_inputs = plan.fast.inputs();
    let laid = LaneList::new(list, inputs, asked, &units, |input| {
        let over_lanes = lane_inputs.contains(input.into()) && usize::from(input) < inputs;
        Varies { over_lanes, over_rows: !over_lanes }
    })?;
    Some(laid.knowing(&known))
}

impl FastBlock {
    /// The given designs of the fast axes, at most [`BLOCK`].
    pub(super) fn new(plan: &Plan, lanes: Option<&LaneList>, designs: impl Iterator<Item = u64>) -> Self {
        let model = &plan.study.model;
        let set = plan.fast.inputs();
        let mut columns: InputColumns =
            (0..model.inputs.len()).filter(|&input| set.contains(input)).map(|input| (input, Vec::with_capacity(BLOCK))).collect();
        let mut inputs = vec![0.0; model.inputs.len()];
        let mut offsets = Vec::with_capacity(BLOCK);
        for design in designs {
            plan.fast.set(design, &mut inputs);
            offsets.push(plan.fast.source_index(design));
            for (input, column) in &mut columns {
                column.push(inputs[*input]);
            }
        }
        let count = offsets.len();
        for (_, column) in &mut columns {
            // Idle lanes repeat the last design, so that they are as harmless as it is.
            column.resize(count.next_multiple_of(LANES), *column.last().expect("a block has a design"));
        }
        let si = columns.iter().map(|(input, column)| {
            let input_table = &model.inputs[*input];
            (*input, column.iter().map(|&value| models::input_to_si(input_table, value)).collect())
        });
        let si: InputColumns = si.collect();
        let shared = lanes.map_or_else(Vec::new, |lanes| lanes.shared_columns(&si, &[]));
        Self { count, offsets, si, own: columns, shared }
    }

    /// The same, out of the blocks that are kept.
    pub(super) fn picked(plan: &Plan, tables: &Tables, designs: &[u64]) -> Self {
        let Some(first) = tables.blocks.first() else { return Self::new(plan, tables.lanes.as_ref(), designs.iter().copied()) };
        let room = designs.len().next_multiple_of(LANES);
        let picked = |of: &dyn Fn(&Self) -> &[f64]| {
            let mut column = Vec::with_capacity(room);
            column.extend(designs.iter().map(|&design| of(&tables.blocks[design as usize / BLOCK])[design as usize % BLOCK]));
            column.resize(room, *column.last().expect("a block has a design"));
            column
        };
        let columns = |of: fn(&Self) -> &InputColumns| -> InputColumns {
            of(first).iter().enumerate().map(|(number, (input, _))| (*input, picked(&|block| &of(block)[number].1))).collect()
        };
        Self {
            count: designs.len(),
            offsets: designs.iter().map(|&design| tables.blocks[design as usize / BLOCK].offsets[design as usize % BLOCK]).collect(),
            si: columns(|it| &it.si),
            own: columns(|it| &it.own),
            shared: (0..first.shared.len()).map(|number| picked(&|block| &block.shared[number])).collect(),
        }
    }

    pub(super) fn si(&self, input: usize) -> &[f64] {
        &self.si.iter().find(|(it, _)| *it == input).expect("a lane input is set by a fast axis").1
    }

    pub(super) fn own(&self, input: usize) -> &[f64] {
        &self.own.iter().find(|(it, _)| *it == input).expect("a lane input is set by a fast axis").1
    }
}

/// The settings of all combinations of scenario axes, if they are few.
pub(super) fn settings(plan: &Plan, product: &Product) -> Vec<Setting> {
    let kept = if product.count() <= TABLE { product.count() } else { 0 };
    (0..kept).map(|index| setting(plan, product, index)).collect()
}

/// What one combination of scenario axes sets.
pub(super) fn setting(plan: &Plan, product: &Product, index: u64) -> Setting {
    let model = &plan.study.model;
    let mut inputs = plan.study.fixed.clone();
    product.set(index, &mut inputs);
    let set = product.inputs();
    let each = (0..model.inputs.len()).filter(|&input| set.contains(input));
    each.map(|input| (input, inputs[input], models::input_to_si(&model.inputs[input], inputs[input]))).collect()
}
