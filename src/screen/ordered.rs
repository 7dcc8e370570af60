//! Rows whose designs stand in one order: what differs between them comes in by a single number.
//!
//! Where every result of a row is one number of each design, v, with numbers of the row added, multiplied and so on, each result rises or
//! falls with v, rounding and all (see [`Steps`]). With the designs sorted by v, those that satisfy a constraint are neighbours, found by
//! halving; the least and the largest value of an objective stand at their ends; and a stretch of neighbours has no values beyond those of
//! its two ends, so that the front known so far drops most of them at once. A row of thousands of designs is judged by some dozens of
//! values, design by design only where the front is near. The answer is the one that judging each of them gives, to the last bit.

use super::tables::{BLOCK, FastBlock};
use crate::models::Set;
use crate::plan::{Plan, Source, knowns};
use crate::reduce::{KeyRule, Reducers, Reduction};
use crate::screen::Block;
use crate::tape::LaneList;
use crate::tape::{Binary, List, Node, Operation, Step, Steps, Unary};
use crate::units::Unit;
use std::ops::Range;
use std::sync::OnceLock;

/// Most bytes of sorted columns.
const MOST_BYTES: u64 = 64 << 20;
/// Bytes of a design in a sorted column: its number, and which design it is.
const DESIGN_BYTES: u64 = 8 + 2 + 2;
/// Longest chain that is followed.
const LONGEST: usize = 24;
/// A stretch of so few designs is looked at one by one.
const FEW: usize = 4;

/// From the number to a result.
#[derive(Debug)]
struct RowChain {
    steps: Steps,
    /// Slots of the row's numbers that it is combined with.
    others: Vec<usize>,
    /// Of an output: its unit.
    unit: Option<Unit>,
}

/// The designs of the fast axes sorted by their number.
#[derive(Debug)]
struct SortedColumn {
    values: Vec<f64>,
    lanes: Vec<u16>,
    /// How many numbers are below the lower edge of each of as many even steps from the least to the largest, and steps per number.
    below: Vec<u16>,
    scale: f64,
}

/// What is known of such rows; for all threads.
#[derive(Debug)]
pub(super) struct OrderedRows {
    channel: Node,
    /// What the number is made of, operands first.
    below: Vec<Node>,
    chains: Vec<RowChain>,
    /// Dimensions of the slow axes that the number depends on, with the distance of two levels among the columns.
    dimensions: Vec<(usize, u64)>,
    /// `None` for a column whose numbers are not all finite.
    columns: Vec<OnceLock<Option<SortedColumn>>>,
}

/// Room for a thread.
#[derive(Debug, Default)]
pub(super) struct OrderedNumbers {
    others: Vec<Vec<f64>>,
    offsets: Vec<u64>,
    alive: Vec<u64>,
    values: Vec<Vec<f64>>,
    open: Vec<Range<usize>>,
}

impl OrderedRows {
    /// `None` where the rows of a plan are none of that kind.
    pub(super) fn new(plan: &Plan, list: &LaneList) -> Option<Self> {
        let is_served = |source: &Source| !matches!(source, Source::LaneInput(_));
        let sources = plan.constraints.iter().chain(plan.tracked.iter().map(|(_, source)| source));
        if plan.scenarios() != 1 || plan.spectrum.is_some() || !sources.into_iter().all(is_served) {
            return None;
        }
        let over_lanes = over_lanes(plan, list);
        let paths: Vec<Vec<Node>> = list.asked().iter().map(|&node| path(list.list(), node, &over_lanes)).collect();
        let start = *paths.first()?.last()?;
        if !paths.iter().all(|path| path.last() == Some(&start) && path.len() <= LONGEST) {
            return None;
        }
        // Further up on the way that all have in common there is less left to compute, as long as that takes no more columns.
        let depends = slow_dimensions(plan, list);
        let mut channel = start;
        for &node in paths[0].iter().rev() {
            if paths.iter().all(|path| path.contains(&node)) && depends[node as usize] == depends[start as usize] {
                channel = node;
            }
        }
        let mut dimensions = Vec::new();
        let mut columns = 1u64;
        for (dimension, count) in plan.slow.dimensions().map(|(it, _)| it.count()).enumerate() {
            if depends[channel as usize].contains(dimension) {
                dimensions.push((dimension, columns));
                columns = columns.checked_mul(count)?;
            }
        }
        let fits = columns.checked_mul(plan.fast.count() * DESIGN_BYTES).is_some_and(|bytes| bytes <= MOST_BYTES);
        if !fits || plan.fast.count() >= 1 << 16 {
            return None;
        }
        let chain = |(number, path): (usize, &Vec<Node>)| {
            let output = plan.lane_outputs.get(number).map(|&output| plan.study.model.outputs[output].unit);
            chain(list.list(), path, channel, output)
        };
        Some(Self {
            channel,
            below: list.list().needed_by(&[channel]).into_iter().filter(|&node| over_lanes[node as usize]).collect(),
            chains: paths.iter().enumerate().map(chain).collect(),
            dimensions,
            columns: (0..columns).map(|_| OnceLock::new()).collect(),
        })
    }

    /// Bytes of all sorted columns.
    pub(super) fn bytes(&self, plan: &Plan) -> u64 {
        let one = size_of::<OnceLock<Option<SortedColumn>>>() as u64 + plan.fast.count() * DESIGN_BYTES;
        self.columns.len() as u64 * one
    }

    /// The sorted column of a row, given the row's numbers.
    fn column(&self, plan: &Plan, list: &LaneList, blocks: &[FastBlock], row: u64, numbers: &[f64]) -> Option<&SortedColumn> {
        let column: u64 = self.dimensions.iter().map(|&(dimension, stride)| plan.slow.digit(dimension, row) * stride).sum();
        self.columns[column as usize].get_or_init(|| self.sorted(list, blocks, numbers)).as_ref()
    }

    fn sorted(&self, list: &LaneList, blocks: &[FastBlock], numbers: &[f64]) -> Option<SortedColumn> {
        let mut slots = numbers.to_vec();
        let mut members: Vec<(f64, u16)> = Vec::new();
        for block in blocks {
            for lane in 0..block.count {
                for &node in &self.below {
                    match list.list().operations[node as usize] {
                        Operation::Input(input) => slots[node as usize] = block.si(input.into())[lane],
                        _ => list.list().compute(node, &mut slots),
                    }
                }
                members.push((slots[self.channel as usize], members.len() as u16));
            }
        }
        if !members.iter().all(|(value, _)| value.is_finite()) {
            return None;
        }
        members.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (values, lanes): (Vec<f64>, _) = members.into_iter().unzip();
        let (least, range) = (values[0], values[values.len() - 1] - values[0]);
        let scale = if range > 0.0 { (values.len() as f64 / range).min(f64::MAX) } else { 0.0 };
        let mut column = SortedColumn { below: Vec::with_capacity(values.len()), values, lanes, scale };
        let mut place = 0;
        for step in 0..column.values.len() {
            while column.values[place] < least + step as f64 / scale {
                place += 1;
            }
            column.below.push(place as u16);
        }
        Some(column)
    }
}

impl SortedColumn {
    /// About how many numbers are below this one.
    fn guess(&self, value: f64) -> usize {
        let step = ((value - self.values[0]) * self.scale).clamp(0.0, (self.below.len() - 1) as f64);
        usize::from(self.below[step as usize])
    }

    /// The places within a range whose numbers are between two.
    fn between(&self, range: Range<usize>, low: f64, high: f64) -> Range<usize> {
        let first = turn(&range, self.guess(low), |it| self.values[it] < low);
        first..turn(&(first..range.end), self.guess(high), |it| self.values[it] <= high)
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

/// From a result down to the first number that more than one operand makes different for each design; the result first.
fn path(list: &List, result: Node, over_lanes: &[bool]) -> Vec<Node> {
    let mut path = vec![result];
    let mut node = result;
    while path.len() <= LONGEST {
        node = match list.operations[node as usize] {
            Operation::Unary(Unary::Neg | Unary::Sqrt, a) => a,
            Operation::Binary(binary, a, b) if a != b && binary != Binary::PlusWhole => {
                match (over_lanes[a as usize], over_lanes[b as usize]) {
                    (true, false) => a,
                    (false, true) => b,
                    _ => break,
                }
            }
            _ => break,
        };
        path.push(node);
    }
    path
}

/// The operations from `channel` up along a path.
fn chain(list: &List, path: &[Node], channel: Node, unit: Option<Unit>) -> RowChain {
    let mut made = RowChain { steps: Steps::default(), others: Vec::new(), unit: unit.filter(|unit| !unit.is_si()) };
    let start = path.iter().position(|&node| node == channel).expect("every path goes through it");
    for pair in path[..=start].windows(2).rev() {
        let (node, below) = (pair[0], pair[1]);
        let step = match list.operations[node as usize] {
            Operation::Unary(unary, _) => Step::Alone(unary),
            Operation::Binary(binary, a, b) => {
                let other = made.others.len();
                made.others.push(if a == below { b } else { a } as usize);
                if a == below { Step::First(binary, other) } else { Step::Second(binary, other) }
            }
            other => unreachable!("{other:?} is on no path"),
        };
        made.steps.0.push(step);
    }
    made
}

/// A whole row, to be judged at once.
pub(super) struct OrderedRow<'a> {
    pub(super) plan: &'a Plan,
    pub(super) list: &'a LaneList,
    pub(super) blocks: &'a [FastBlock],
    /// Position of the row, and its part of the design index.
    pub(super) row: u64,
    pub(super) row_index: u64,
    /// Worst values that are the same for the whole row, by tracked quantity.
    pub(super) row_worst: &'a [f64],
    /// What the list reads of the row.
    pub(super) numbers: &'a [f64],
}

impl OrderedRow<'_> {
    /// Judges the row, for the number of feasible designs, the front and the extremes; false if it is not sure of the order.
    pub(super) fn judge(&self, rows: &OrderedRows, room: &mut OrderedNumbers, reduction: &Reduction, reducers: &mut Reducers) -> bool {
        let Some(column) = rows.column(self.plan, self.list, self.blocks, self.row, self.numbers) else { return false };
        let OrderedNumbers { others, .. } = room;
        others.resize(rows.chains.len(), Vec::new());
        for (others, chain) in others.iter_mut().zip(&rows.chains) {
            others.clear();
            others.extend(chain.others.iter().map(|&slot| self.numbers[slot]));
        }
        let Some(feasible) = self.feasible(rows, column, others) else { return false };
        if feasible.is_empty() {
            return true;
        }
        reducers.feasible += feasible.len() as u64;
        self.search(rows, column, feasible, room, reduction, reducers);
        true
    }

    /// The feasible designs, by their places in the column; `None` if a result may not rise or fall all the way.
    fn feasible(&self, rows: &OrderedRows, column: &SortedColumn, others: &[Vec<f64>]) -> Option<Range<usize>> {
        let plan = self.plan;
        let values = &column.values;
        let mut feasible = 0..values.len();
        for (number, chain) in rows.chains.iter().enumerate() {
            let others = &others[number];
            let (first, last) = chain.ends(*values.first()?, *values.last()?, others)?;
            let mut narrow = |(low, high): (f64, f64)| {
                let holds = |value: f64| value >= low && value <= high;
                if holds(first) && holds(last) {
                    return;
                }
                // Up to where they are on the one side, and from where on the other.
                let value = |place: usize| chain.value(values[place], others);
                let guess = |bound: f64| column.guess(chain.factor(others).map_or(f64::NAN, |factor| bound / factor));
                let (start, end) = if first <= last {
                    (turn(&feasible, guess(low), |it| value(it) < low), turn(&feasible, guess(high), |it| value(it) <= high))
                } else {
                    (turn(&feasible, guess(high), |it| value(it) > high), turn(&feasible, guess(low), |it| value(it) >= low))
                };
                feasible = start..end.max(start);
            };
            match number.checked_sub(plan.lane_outputs.len()) {
                None => {
                    let constraints = plan.study.constraints.iter().zip(&plan.constraints);
                    constraints.filter(|(_, source)| **source == Source::LaneOutput(number)).for_each(|(it, _)| narrow(it.ends()));
                }
                Some(margin) => {
                    let strict = plan.study.model.conditions[plan.lane_conditions[margin]].strict;
                    narrow((if strict { f64::from_bits(1) } else { 0.0 }, f64::INFINITY));
                }
            }
        }
        Some(feasible)
    }

    /// Hands over the designs that the front may need, and those at the ends of objectives.
    fn search(
        &self,
        rows: &OrderedRows,
        column: &SortedColumn,
        feasible: Range<usize>,
        room: &mut OrderedNumbers,
        reduction: &Reduction,
        reducers: &mut Reducers,
    ) {
        let values = &column.values;
        let worst_at = |tracked: usize, place: usize, others: &[Vec<f64>]| match self.plan.tracked[tracked].1 {
            Source::LaneOutput(result) => rows.chains[result].value(values[place], &others[result]),
            _ => self.row_worst[tracked],
        };
        let OrderedNumbers { others, offsets, alive, values: columns, open } = room;
        columns.resize(self.plan.tracked.len(), Vec::new());
        let mut keep = |place: usize| {
            let lane = usize::from(column.lanes[place]);
            offsets.push(self.blocks[lane / BLOCK].offsets[lane % BLOCK]);
            columns.iter_mut().enumerate().for_each(|(tracked, column)| column.push(worst_at(tracked, place, others)));
        };
        for (objective, &tracked) in self.plan.objectives.iter().enumerate() {
            for (place, step) in [(feasible.start, 1isize), (feasible.end - 1, -1)] {
                let value = worst_at(tracked, place, others);
                if reducers.extremes.may_take(objective, value, self.row_index) {
                    // All that have the same value: which of them has the lowest index is seen later.
                    let mut at = place;
                    while feasible.contains(&at) && worst_at(tracked, at, others) == value {
                        keep(at);
                        at = at.wrapping_add_signed(step);
                    }
                }
            }
        }
        open.clear();
        match self.ray(rows, column, &feasible, reduction, others) {
            Some((factors, ends)) => {
                let mut add = |low, high| open.push(column.between(feasible.clone(), low, high));
                let on_ray = reducers.front.open_on_ray(factors, ends, &mut add);
                if !on_ray {
                    open.push(feasible);
                }
            }
            None => open.push(feasible),
        }
        let mut lower = [0.0; crate::reduce::MOST_OBJECTIVES];
        while let Some(stretch) = open.pop() {
            if stretch.is_empty() {
                continue;
            }
            for ((rule, &tracked), lower) in reduction.rules().iter().zip(&self.plan.objectives).zip(&mut lower) {
                let [a, b] = [stretch.start, stretch.end - 1].map(|place| rule.key(worst_at(tracked, place, others)));
                *lower = a.min(b);
            }
            if reducers.front.beats_from(&lower[..reduction.rules().len()], self.row_index) {
                continue;
            }
            if stretch.len() <= FEW {
                stretch.for_each(&mut keep);
            } else {
                let middle = stretch.start + stretch.len() / 2;
                open.extend([middle..stretch.end, stretch.start..middle]);
            }
        }
        if !offsets.is_empty() {
            alive.clear();
            alive.resize(offsets.len(), u64::MAX);
            let block = Block { row_index: self.row_index, offsets, feasible_count: offsets.len() as u64, alive, values: columns };
            reduction.absorb_objectives(reducers, &block);
            offsets.clear();
            columns.iter_mut().for_each(Vec::clear);
        }
    }
}

impl OrderedRow<'_> {
    /// Where both objectives are a factor of the row times the number: the factors of their keys, and the least and the largest number.
    fn ray(
        &self,
        rows: &OrderedRows,
        column: &SortedColumn,
        feasible: &Range<usize>,
        reduction: &Reduction,
        others: &[Vec<f64>],
    ) -> Option<((f64, f64), (f64, f64))> {
        let [first, second] = self.plan.objectives[..] else { return None };
        let ends = (column.values[feasible.start], column.values[feasible.end - 1]);
        let factor = |tracked: usize, rule: &KeyRule| {
            let Source::LaneOutput(result) = self.plan.tracked[tracked].1 else { return None };
            rows.chains[result].factor(&others[result]).filter(|_| !rule.has_steps()).map(|factor| rule.key(factor))
        };
        let factors = (factor(first, &reduction.rules()[0])?, factor(second, &reduction.rules()[1])?);
        (ends.0 >= 0.0 && factors.0.is_finite() && factors.1.is_finite()).then_some((factors, ends))
    }
}

/// The first place of a range from which on `before` no longer holds, the end if it holds all the way; found soon if the guess is good.
fn turn(range: &Range<usize>, guess: usize, before: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (range.start, range.end);
    let guess = guess.clamp(low, high);
    let mut step = 1;
    if guess < high && before(guess) {
        low = guess + 1;
        while low + step <= high {
            let next = low + step - 1;
            if !before(next) {
                high = next;
                break;
            }
            (low, step) = (next + 1, 2 * step);
        }
    } else {
        high = guess;
        while low < high {
            let next = high.saturating_sub(step).max(low);
            if before(next) {
                low = next + 1;
                break;
            }
            (high, step) = (next, 2 * step);
        }
    }
    while low < high {
        let middle = low + (high - low) / 2;
        if before(middle) { low = middle + 1 } else { high = middle }
    }
    low
}

impl RowChain {
    /// What the number is multiplied by, if nothing else becomes of it.
    fn factor(&self, others: &[f64]) -> Option<f64> {
        let is_product = matches!(self.steps.0[..], [Step::First(Binary::Mul, 0) | Step::Second(Binary::Mul, 0)]);
        is_product.then(|| self.shown(others[0]))
    }

    #[inline(always)]
    fn value(&self, start: f64, others: &[f64]) -> f64 {
        self.shown(self.steps.value(start, others))
    }

    fn ends(&self, low: f64, high: f64, others: &[f64]) -> Option<(f64, f64)> {
        let (a, b) = self.steps.ends(low, high, others)?;
        let (a, b) = (self.shown(a), self.shown(b));
        (a.is_finite() && b.is_finite()).then_some((a, b))
    }

    /// In its unit, whose factors are above zero.
    #[inline(always)]
    fn shown(&self, value: f64) -> f64 {
        self.unit.map_or(value, |unit| unit.from_si(value))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CpuEngine, Tables};
    use super::*;
    use crate::reduce::State;
    use crate::study::study_of;

    const GRID: &str = "[design]\nfriction = { from = 0.06, to = 0.12, count = 5 }\ngroove_angle_deg = { from = 18, to = 30, count = 7 }\n\
                        ratio = { from = 0.5, to = 2, count = 9 }\nband_thickness_mm = { from = 0.1, to = 0.4, count = 31 }\n\
                        band_count = { from = 4, to = 14 }\n[fixed]\ntraction = \"limit\"\n";

    fn plan(text: &str) -> Plan {
        Plan::new(
            study_of(&crate::models::find("metal-cvt").expect("it is a model"), &format!("{GRID}{text}")).expect("the study is right"),
        )
    }

    /// What remains of all designs, judged one by one or by rows.
    fn swept(plan: &Plan, by_rows: bool) -> State {
        let (mut tables, reduction) = (Tables::new(plan), Reduction::new(plan, &[]));
        assert!(tables.ordered.is_some() && reduction.is_front_only());
        if !by_rows {
            tables.ordered = None;
        }
        let mut reducers = reduction.start();
        let mut engine = CpuEngine::new(plan, &tables);
        // Not whole rows at the ends, and in parts, so that the front is known to the later ones.
        for (first, last) in [(0, 1000), (1000, plan.designs() / 2), (plan.designs() / 2, plan.designs())] {
            assert_eq!(engine.screen_for(first..last, &reduction, &mut reducers), last);
            reducers.front.points();
        }
        reducers.state()
    }

    #[test]
    fn rows_judged_at_once_leave_what_their_designs_leave() {
        let constraints = [
            "[constraints]\ncapacity_axial_force_N = { max = 30000 }\ntorque_capacity_Nm = { above = 0 }\n",
            "[constraints]\ncapacity_axial_force_N = { min = 5000, max = 20000 }\ntorque_capacity_Nm = { max = 150 }\n",
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
        ];
        let mut sizes = Vec::new();
        for constraints in constraints {
            for objectives in objectives {
                let plan = plan(&format!("{constraints}{objectives}"));
                let [one_by_one, by_rows] = [false, true].map(|by_rows| swept(&plan, by_rows));
                assert!(one_by_one == by_rows, "{constraints}{objectives}: {} and {}", one_by_one.front.len(), by_rows.front.len());
                assert!(by_rows.feasible > 1000, "{constraints}{objectives}");
                sizes.push(by_rows.front.len());
            }
        }
        assert!(sizes.iter().filter(|size| **size > 50).count() > 6, "{sizes:?}");
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
        assert!(wrong.state() != swept(&plan, true));
    }

    #[test]
    fn a_place_is_found_from_any_guess() {
        let values = [1, 3, 3, 3, 5, 8, 13, 21, 34];
        for bound in 0..36 {
            let expected = values.iter().filter(|value| **value < bound).count();
            for guess in 0..12 {
                for (start, end) in [(0, 9), (2, 7), (4, 4)] {
                    assert_eq!(turn(&(start..end), guess, |at| values[at] < bound), expected.clamp(start, end), "{bound} from {guess}");
                }
            }
        }
    }
}
