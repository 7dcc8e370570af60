//! The drive as a list of operations: over the designs of a block what differs between these, over the draws what all of them share.
//! The bits are those of the formula.

use super::super::columns::MOST_OPERATIONS;
use super::super::drive::DrawnDrive;
use super::super::tracks::keep;
use super::Parts;
use crate::models::{LANES, input_to_si};
use crate::tape::{ColumnValue, Known, LaneBlock, LaneList, LaneNumbers, List, ListColumns, Node, Set, Varies};

/// Fewer designs are faster by the drive's own loop.
pub(super) const LEAST_LANES: usize = 16;
/// Most draws whose shared numbers are computed at a time, and most of these numbers that are kept.
const MOST_DRAWS: usize = 256;
const MOST_NUMBERS: usize = 1 << 18;

/// The drive for blocks of designs that differ in certain inputs; one per thread.
pub(super) struct DrawnList {
    /// What differs between designs, with the numbers that it reads; `None` where nothing does.
    lanes: Option<(LaneList, LaneNumbers)>,
    /// What the block has in common over all draws and cases, and how many designs there is room for.
    shared: Vec<Vec<f64>>,
    room: usize,
    /// What all designs share: numbers that the lanes read, outputs, margins.
    rows: List,
    running: ListColumns,
    /// Inputs of the block in SI units, those that differ between its designs being anybody's.
    inputs: Vec<f64>,
    /// Of each case: the first draw that it has numbers of, if any, and the numbers, draw by draw.
    cases: Vec<(Option<usize>, Vec<f64>)>,
    draws: usize,
    /// Values of the drawn inputs that all designs share, draw by draw, in SI units.
    drawn: Vec<Vec<f64>>,
}

impl DrawnList {
    /// `None` where the drive cannot be recorded, or its own loop is as good.
    pub(super) fn new(kernel: &DrawnDrive, of_lanes: &Parts, of_row: &Parts, varying: Set) -> Option<Self> {
        let base = &kernel.base;
        let formula = base.kernel.formula()?;
        // Written out, these would be too many operations.
        if !formula.fields().tables.is_empty() || formula.fields().iterations > 0 {
            return None;
        }
        let set = |part: fn(&Parts) -> &[usize]| part(of_lanes).iter().chain(part(of_row)).copied().collect::<Set>();
        let known = vec![Known::ANY; base.inputs.len()];
        let whole = formula.whole(&known, set(|it| &it.outputs), set(|it| &it.conditions));
        let results = |parts: &Parts| -> Vec<Option<Node>> {
            let outputs = parts.outputs.iter().map(|&it| Some(whole.outputs[it]));
            outputs.chain(parts.conditions.iter().map(|&it| Some(whole.conditions[it]))).collect()
        };
        let of_each = results(of_lanes);
        let list = List::cut(&whole.recording, &[of_each.as_slice(), &results(of_row)].concat());
        if list.operations.len() > MOST_OPERATIONS {
            return None;
        }
        let results: Vec<Node> = list.results.iter().flatten().copied().collect();
        let (of_each, of_row) = results.split_at(of_each.len());
        let turned: Set = kernel.cases.inputs.iter().copied().chain(kernel.drawn.iter().map(|it| it.0)).collect();
        let of_input = |input: u16| Varies { over_lanes: varying.contains(input.into()), over_rows: turned.contains(input.into()) };
        let lanes = if of_each.is_empty() {
            None
        } else {
            let units: Vec<(f64, f64)> = of_lanes.outputs.iter().map(|&it| base.outputs[it].unit.factors()).collect();
            let lanes = LaneList::new(list.clone(), base.inputs.len(), of_each.to_vec(), &units, of_input)?;
            let numbers = lanes.numbers(0);
            Some((lanes, numbers))
        };
        let scalars = lanes.iter().flat_map(|(lanes, _)| lanes.scalars());
        let rows = List { results: scalars.chain(of_row).copied().map(Some).collect(), ..list };
        let drawn: Set = kernel.drawn.iter().map(|it| it.0).collect();
        let mut running = ListColumns::new(&rows);
        running.turn_to(&rows, 0..rows.results.len(), |input| drawn.contains(input.into()));
        let cases = kernel.cases.rows.len();
        let draws = (MOST_NUMBERS / (cases * rows.results.len()).max(1)).min(MOST_DRAWS);
        if draws == 0 {
            return None;
        }
        Some(Self {
            lanes,
            shared: Vec::new(),
            room: 0,
            rows,
            running,
            inputs: Vec::new(),
            cases: vec![(None, Vec::new()); cases],
            draws,
            drawn: vec![Vec::new(); kernel.drawn.len()],
        })
    }

    /// Begins a block of designs, given the inputs that they share and the columns of the others, in SI units.
    pub(super) fn begin(&mut self, inputs: &[f64], varying: &[(usize, Vec<f64>)]) {
        self.inputs.clear();
        self.inputs.extend(inputs);
        self.cases.iter_mut().for_each(|(first, _)| *first = None);
        let room = varying.first().map_or(0, |it| it.1.len());
        if let Some((lanes, numbers)) = &mut self.lanes {
            self.shared = lanes.shared_columns(varying, inputs);
            if room > self.room {
                (self.room, *numbers) = (room, lanes.numbers(room));
            }
        }
    }

    /// Keeps the designs at these places only.
    pub(super) fn keep(&mut self, places: &[usize]) {
        let padded = places.len().next_multiple_of(LANES);
        for column in &mut self.shared {
            keep(column, places);
            column.truncate(padded);
        }
    }

    /// Turns to a draw in a case; the outputs and margins that all designs share, as they were asked for.
    pub(super) fn turn(&mut self, kernel: &DrawnDrive, varying: &[(usize, Vec<f64>)], (draw, case): (usize, usize)) -> &[f64] {
        let first = draw - draw % self.draws;
        if self.cases[case].0 != Some(first) {
            self.compute(kernel, varying, (first, case));
        }
        let length = self.rows.results.len();
        let numbers = &self.cases[case].1[(draw - first) * length..][..length];
        let Some((lanes, of_lanes)) = &mut self.lanes else { return numbers };
        let (scalars, rest) = numbers.split_at(lanes.scalars().len());
        of_lanes.set_scalars(lanes, scalars);
        rest
    }

    /// The numbers of some draws from `first` on in a case.
    fn compute(&mut self, kernel: &DrawnDrive, varying: &[(usize, Vec<f64>)], (first, case): (usize, usize)) {
        let count = self.draws.min(kernel.draws() - first);
        let mut si = self.inputs.clone();
        for (&input, &value) in kernel.cases.inputs.iter().zip(&kernel.cases.rows[case]) {
            si[input] = input_to_si(&kernel.base.inputs[input], value);
        }
        for ((&(input, effect), column), to) in kernel.drawn.iter().zip(&kernel.columns).zip(&mut self.drawn) {
            to.clear();
            if !varying.iter().any(|it| it.0 == input) {
                to.extend(column[first..first + count].iter().map(|&drawn| kernel.actual((input, effect), si[input], drawn)));
            }
        }
        let Self { rows, running, cases, drawn, .. } = self;
        let (of, numbers) = &mut cases[case];
        *of = Some(first);
        let length = rows.results.len();
        numbers.resize(length * self.draws, 0.0);
        let input = |input: u16| {
            let place = kernel.drawn.iter().position(|it| it.0 == usize::from(input));
            place.map_or(ColumnValue::One(si[usize::from(input)]), |at| ColumnValue::Each(&drawn[at]))
        };
        running.run(rows, count, input, |running, start, part| {
            for result in 0..length {
                let value = running.result(rows, result);
                (0..part).for_each(|draw| numbers[(start + draw) * length + result] = value.at(draw));
            }
        });
    }

    /// Computes the outputs, in their units, and margins that differ between the designs, for the draw and case that it was turned to.
    pub(super) fn run(&mut self, varying: &[(usize, Vec<f64>)], count: usize, results: &mut [Vec<f64>]) {
        let Some((lanes, numbers)) = &mut self.lanes else { return };
        let column = |&input: &u16| varying.iter().find(|it| it.0 == usize::from(input)).map_or(&[] as &[f64], |it| &it.1);
        let given: Vec<&[f64]> = lanes.given().iter().map(column).collect();
        lanes.run(numbers, LaneBlock { shared: &self.shared, given: &given, count }, results);
    }
}
