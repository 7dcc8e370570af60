//! What is the same for all designs of a row, over all scenarios at once, and where these are few also over all rows of the innermost slow
//! axis, or a stretch of it: the first stage, conditions and outputs of the row, and what the [inner loop](crate::tape::LaneList) reads of
//! it.
//!
//! Operations that neither a scenario nor that axis sets are one number; the others are a column. From row to row only what depends on
//! another input that has changed is computed again. The bits are those of the formula.

use super::tables::{Setting, settings};
use super::turned_list::{NumberReads, RowFormula, TurnedList};
use crate::models::input_to_si;
use crate::plan::Plan;
use crate::space::SpaceDimension;
use crate::tape::{CHUNK, ColumnValue, Node, NodeColumns, Operation, Set};
use crate::tape::{LaneList, LaneNumbers};
use std::ops::Range;

/// Shorter columns would not pay; longer ones would fill the caches.
const PLACES: std::ops::RangeInclusive<u64> = 8..=4 * CHUNK as u64;
/// Most places where they are those of several rows: not all of these may be asked for.
const MOST_OF_ROWS: u64 = 256;
/// Most operations, for the same reason.
const MOST_OPERATIONS: usize = 1024;
/// Most levels of an axis that is taken stretch by stretch: all their values are kept.
const MOST_LEVELS: u64 = 4096;

/// The operations of a row; for all threads.
#[derive(Debug)]
pub(super) struct RowList {
    /// The formula up to what is the same for the whole row.
    whole: TurnedList,
    /// What the inner loop makes of it before its designs come in, if there is one.
    lanes: Option<TurnedList>,
    /// Of each number that the first stage passes on to the inner loop: its result of `whole`.
    passed: Vec<Option<Node>>,
    /// Conditions and outputs of the model that the row decides, with their results.
    conditions: Vec<(usize, Node)>,
    outputs: Vec<(usize, Node)>,
    /// Values of the inputs that differ within a column, in SI units, by input.
    column_inputs: Vec<(usize, Vec<f64>)>,
    /// Rows of a column, which are levels of the innermost slow axis next to each other, and scenarios of a row.
    rows: u64,
    /// All levels of that axis, and the inputs that it sets.
    levels: u64,
    of_rows: Set,
    scenarios: u64,
    fast_scenarios: u64,
}

impl RowList {
    /// `None` where the scenarios are better taken one by one, or the inner loop is no list.
    pub(super) fn new(plan: &Plan, lanes: Option<&LaneList>, settings: (&[Setting], &[Setting])) -> Option<Self> {
        if lanes.is_none() && plan.lane_outputs.len() + plan.lane_conditions.len() > 0 {
            return None;
        }
        let (slow_settings, fast_settings) = settings;
        let scenarios = plan.scenarios();
        let are_listed = (slow_settings.len() * fast_settings.len()) as u64 == scenarios;
        let innermost = plan.slow.dimensions().last().map(|(it, _)| it);
        let levels = innermost.map_or(1, SpaceDimension::count);
        let rows = match scenarios.saturating_mul(levels) {
            all if all <= MOST_OF_ROWS => levels,
            // A long axis is taken stretch by stretch, all of about the same length.
            _ if scenarios == 1 && levels <= MOST_LEVELS => levels.div_ceil(levels.div_ceil(MOST_OF_ROWS)),
            _ => 1,
        };
        if !PLACES.contains(&(scenarios.saturating_mul(rows))) || !are_listed {
            return None;
        }
        let innermost = innermost.filter(|_| rows > 1);
        let read_of_list = |lanes: &LaneList, number: usize| {
            lanes.list().needed_by(lanes.scalars()).iter().any(
                |&node| matches!(lanes.list().operations[node as usize], Operation::Input(input) if lanes.passed_on(input) == Some(number)),
            )
        };
        let read = |number: usize| lanes.is_some_and(|lanes| read_of_list(lanes, number));
        let prepared = plan.study.model.kernel.prepared_len();
        let passed: Vec<usize> = (0..prepared).filter(|&number| read(number)).collect();
        let formula = RowFormula::new(plan, &passed)?;
        if formula.list.operations.len() + lanes.map_or(0, |it| it.list().operations.len()) > MOST_OPERATIONS {
            return None;
        }
        let mut places = vec![None; prepared];
        passed.iter().zip(&formula.passed).for_each(|(&number, &node)| places[number] = Some(node));
        let results = formula.results();
        let of_scenarios = plan.slow_scenarios.inputs() | plan.fast_scenarios.inputs();
        let of_rows: Set = innermost.into_iter().flat_map(SpaceDimension::inputs).copied().collect();
        let stretches = if rows > 1 { levels.div_ceil(rows) } else { 1 };
        let turning = if stretches > 1 { plan.slow.inputs() } else { plan.slow.inputs() - of_rows };
        let of_input = |input: usize| NumberReads { turning: Set::one(input) & turning, each: (of_scenarios | of_rows).contains(input) };
        let RowFormula { list, conditions, outputs, .. } = formula;
        let part = TurnedList::new(list, &results, |input| of_input(input.into()));
        let of_lanes = lanes.map(|lanes| {
            let of_lane_input = |input: u16| match lanes.passed_on(input) {
                None => of_input(input.into()),
                Some(number) => places[number].map_or(NumberReads::default(), |node| part.reads(node)),
            };
            TurnedList::new(lanes.list().clone(), lanes.scalars(), of_lane_input)
        });
        let scenario_inputs = of_scenarios.iter().map(|input| {
            let of = |setting: &Setting| setting.iter().find(|(it, _, _)| *it == input).map(|(_, _, si)| *si);
            let value = |slow: &Setting, fast: &Setting| of(fast).or(of(slow)).expect("a scenario sets it");
            let values = || slow_settings.iter().flat_map(|slow| fast_settings.iter().map(move |fast| value(slow, fast)));
            (input, (0..stretches * rows).flat_map(|_| values()).collect())
        });
        let row_inputs = innermost.into_iter().flat_map(|dimension| {
            dimension.inputs().iter().enumerate().map(move |(number, &input)| {
                let value = move |level: u64| input_to_si(&plan.study.model.inputs[input], dimension.value(number, level));
                // The last stretch may be shorter than the others; what stands in its place is never asked for.
                let levels = (0..stretches * rows).map(|level| level.min(levels - 1));
                (input, levels.flat_map(|level| std::iter::repeat_n(value(level), scenarios as usize)).collect())
            })
        });
        Some(Self {
            column_inputs: scenario_inputs.chain(row_inputs).collect(),
            passed: places,
            conditions,
            outputs,
            whole: part,
            lanes: of_lanes,
            rows,
            levels: if rows > 1 { levels } else { 1 },
            of_rows,
            scenarios,
            fast_scenarios: plan.fast_scenarios.count(),
        })
    }

    /// Are there numbers of several rows in a column?
    pub(super) fn has_rows(&self) -> bool {
        self.rows > 1
    }

    /// The rows whose numbers stand in the same columns as those of a row.
    pub(super) fn rows_beside(&self, row: u64) -> Range<u64> {
        let first = row - self.stretch(row).1;
        first..(first + self.rows).min((row / self.levels + 1) * self.levels)
    }

    /// The stretch of the innermost axis that a row belongs to, and its place there.
    fn stretch(&self, row: u64) -> (u64, u64) {
        let level = row % self.levels;
        (level / self.rows, level % self.rows)
    }

    /// Places of a column.
    fn places(&self) -> usize {
        (self.rows * self.scenarios) as usize
    }

    /// Bytes of a thread's room.
    pub(super) fn room(plan: &Plan, lanes: Option<&LaneList>) -> u64 {
        let [slow, fast] = [&plan.slow_scenarios, &plan.fast_scenarios].map(|product| settings(plan, product));
        Self::new(plan, lanes, (&slow, &fast)).map_or(0, |it| {
            let places = it.places();
            it.whole.bytes(places) + it.lanes.as_ref().map_or(0, |lanes| lanes.bytes(places))
        })
    }
}

/// The numbers of a chunk of the places.
#[derive(Debug)]
struct PlaceChunk {
    first: usize,
    count: usize,
    whole: NodeColumns,
    lanes: Option<NodeColumns>,
}

/// The numbers of the current row; one per thread.
#[derive(Debug)]
pub(super) struct RowNumbers {
    chunks: Vec<PlaceChunk>,
    /// Inputs of the row that they are of, in SI units; none before the first.
    inputs: Vec<f64>,
    /// The first row of the column, which stretch of the innermost axis it is, and the first place of the current row there.
    column: Option<u64>,
    stretch: u64,
    first: usize,
}

impl RowNumbers {
    /// Room for a thread.
    pub(super) fn new(list: &RowList) -> Self {
        let chunk = |first: usize| {
            let count = CHUNK.min(list.places() - first);
            let room = |part: &TurnedList| {
                let mut numbers = NodeColumns::new(&part.list);
                numbers.begin(count);
                numbers
            };
            let (whole, lanes) = (room(&list.whole), list.lanes.as_ref().map(room));
            PlaceChunk { first, count, whole, lanes }
        };
        Self { chunks: (0..list.places()).step_by(CHUNK).map(chunk).collect(), inputs: Vec::new(), column: None, stretch: 0, first: 0 }
    }

    /// Are the numbers of a row among those that are there?
    pub(super) fn holds(&self, list: &RowList, row: u64) -> bool {
        self.column == Some(list.rows_beside(row).start)
    }

    /// Turns to a row with these inputs, in SI units.
    pub(super) fn turn(&mut self, list: &RowList, lane_list: Option<&LaneList>, row: u64, inputs: &[f64]) {
        // The innermost axis turns from row to row.
        let (stretch, place) = list.stretch(row);
        self.first = (place * list.scenarios) as usize;
        if self.holds(list, row) {
            return;
        }
        self.column = Some(list.rows_beside(row).start);
        let differs = |&input: &usize| self.inputs[input].to_bits() != inputs[input].to_bits();
        let of_stretch = if stretch == self.stretch { Set::EMPTY } else { list.of_rows };
        let changed = (!self.inputs.is_empty()).then(|| ((0..inputs.len()).filter(differs).collect::<Set>() - list.of_rows) | of_stretch);
        self.stretch = stretch;
        let before = (stretch * list.rows * list.scenarios) as usize;
        for PlaceChunk { first, count, whole, lanes } in &mut self.chunks {
            let model_input = |number: u16| {
                let column = list.column_inputs.iter().find(|(input, _)| *input == usize::from(number));
                column.map_or_else(
                    || ColumnValue::One(inputs[usize::from(number)]),
                    |(_, it)| ColumnValue::Each(&it[before..][*first..*first + *count]),
                )
            };
            list.whole.turn(whole, changed, model_input);
            let whole = &*whole;
            let (Some(part), Some(numbers), Some(lane_list)) = (&list.lanes, lanes, lane_list) else { continue };
            part.turn(numbers, changed, |number| match lane_list.passed_on(number) {
                Some(passed) => list.whole.value(whole, list.passed[passed].expect("what is read was asked for")),
                None => model_input(number),
            });
        }
        self.inputs.clear();
        self.inputs.extend(inputs);
    }

    /// Where a slow and a fast scenario of the row stand.
    fn place(&self, list: &RowList, (slow, fast): (u64, u64)) -> usize {
        self.first + (slow * list.fast_scenarios + fast) as usize
    }

    /// Writes the condition margins and outputs of the row in a scenario.
    pub(super) fn recall(&self, list: &RowList, scenario: (u64, u64), margins: &mut [f64], outputs: &mut [f64]) {
        self.recall_at(list, self.place(list, scenario), margins, outputs);
    }

    /// Writes the condition margins and outputs at a place of the column.
    pub(super) fn recall_at(&self, list: &RowList, place: usize, margins: &mut [f64], outputs: &mut [f64]) {
        let (chunk, at) = (&self.chunks[place / CHUNK], place % CHUNK);
        let number = |node: Node| list.whole.value(&chunk.whole, node).at(at);
        list.conditions.iter().for_each(|&(condition, node)| margins[condition] = number(node));
        list.outputs.iter().for_each(|&(output, node)| outputs[output] = number(node));
    }

    /// Enters a scenario of the row: what the inner loop reads of it.
    pub(super) fn enter(&self, list: &RowList, scenario: (u64, u64), lanes: &LaneList, numbers: &mut LaneNumbers) {
        let place = self.place(list, scenario);
        let (chunk, at) = (&self.chunks[place / CHUNK], place % CHUNK);
        if let (Some(part), Some(of_chunk)) = (&list.lanes, &chunk.lanes) {
            numbers.enter(lanes, |node| part.value(of_chunk, node).at(at));
        }
    }

    /// What the inner loop reads of an operation in all rows of the column, of which there are [several](RowList::has_rows).
    pub(super) fn lane_column(&self, list: &RowList, node: Node) -> Option<ColumnValue<'_>> {
        let [chunk] = &self.chunks[..] else { return None };
        Some(list.lanes.as_ref()?.value(chunk.lanes.as_ref()?, node))
    }

    /// Calls `each` with every condition that a row decides and its margins in all rows of the column, of which there are
    /// [several](RowList::has_rows), in the only scenario.
    pub(super) fn conditions(&self, list: &RowList, mut each: impl FnMut(usize, ColumnValue<'_>)) {
        for chunk in &self.chunks {
            list.conditions.iter().for_each(|&(condition, node)| each(condition, list.whole.value(&chunk.whole, node)));
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::{CpuEngine, Tables};
    use super::*;
    use crate::study::Study;
    use std::ops::Range;
    use std::path::Path;

    /// Feasible designs at some positions with the bits of their worst values.
    pub(in crate::screen) fn judged(engine: &mut CpuEngine<'_>, plan: &Plan, stretches: &[Range<u64>]) -> Vec<(u64, Vec<u64>)> {
        let mut found = Vec::new();
        for positions in stretches {
            engine.screen(positions.clone(), |block| {
                let values = |lane: usize| (0..plan.tracked.len()).map(|at| block.column(at)[lane].to_bits()).collect();
                found.extend(block.feasible().map(|lane| (block.index(lane), values(lane))));
            });
        }
        found
    }

    #[test]
    fn rows_over_all_scenarios_have_the_answers_of_one_scenario_after_the_other() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
        let mut served = Vec::new();
        for name in ["metal-cvt", "rubber-cvt", "scooter-variator", "variator-pressure", "flat-belt", "pulley-load", "metal-grid"] {
            let plan = Plan::new(Study::read(&folder.join(format!("{name}.toml"))).expect("it is right").0);
            let mut tables = Tables::new(&plan);
            if tables.rows.is_none() {
                continue;
            }
            // From end to end, and some rows next to each other.
            let count = plan.slow.count();
            let rows = (0..40).map(|step| step * 7919 % count).chain((0..count).take(120));
            let width = plan.fast.count();
            let rows: Vec<Range<u64>> = rows.map(|row| row * width..(row + 1) * width).collect();
            tables.together = None;
            let together = judged(&mut CpuEngine::new(&plan, &tables), &plan, &rows);
            let mut stale = tables.rows.take();
            let alone = judged(&mut CpuEngine::new(&plan, &tables), &plan, &rows);
            assert_eq!(together, alone, "{name}");
            served.push((name, !alone.is_empty()));
            // Were an input forgotten, a row would have what another one left.
            for part in stale.iter_mut().flat_map(|it| std::iter::once(&mut it.whole).chain(&mut it.lanes)) {
                part.forget();
            }
            tables.rows = stale;
            let forgetful = judged(&mut CpuEngine::new(&plan, &tables), &plan, &rows);
            assert!(alone.is_empty() || count == 1 || forgetful != alone, "{name}");
        }
        assert!(served.iter().filter(|(_, some)| *some).count() >= 3, "{served:?}");
    }
}
