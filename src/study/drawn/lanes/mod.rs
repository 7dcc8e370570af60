//! Many designs at once: the same bits as for single designs, draw by draw.

mod case;
mod list;
#[cfg(test)]
pub(in crate::study::drawn) mod tests;

use self::list::{DrawnList, LEAST_LANES};
use super::super::quantity::Quantity;
use super::super::resolved::Constraint;
use super::drive::{DrawnDrive, margin_of, needs};
use super::early::{LeastCount, decided};
use super::fold::{over_draws, worse_of};
use super::statistic::{AskedQuantity, OverDraws, StatisticKind};
use super::tracks::{CaseFold, IN, Track, keep, keep_folds};
use crate::masks::{add_one, keep_marked};
use crate::models::{Columns, Condition, LANES, Scratch, Worse, input_to_si};
use crate::tape::Set;
use std::ops::Range;

/// Most values of draws that are kept at a time, and most designs that are given at once.
const MOST_KEPT: usize = 1 << 21;
const MOST_LANES: u64 = 512;
/// Draws between two looks at which designs can still be feasible.
const LOOK: usize = 16;

/// Designs whose values of all draws are kept at a time, of so many statistics that need them.
fn lanes_at_a_time(draws: usize, statistics: usize) -> usize {
    (MOST_KEPT / (draws * statistics).max(1) / LANES * LANES).max(LANES)
}

/// Numbers that a thread keeps for statistics that need the values of all draws.
pub fn most_kept(draws: u64, statistics: u64, designs: u64) -> u64 {
    let lanes = lanes_at_a_time(usize::try_from(draws).unwrap_or(usize::MAX), statistics as usize) as u64;
    lanes.min(MOST_LANES).min(designs) * draws.saturating_mul(statistics)
}

/// What fresh draws say of a design, given its inputs and the number of the statistic.
pub type FreshOf<'a> = &'a dyn Fn(&[f64], usize) -> Option<f64>;

/// Room for designs under way; one per thread.
pub struct DrawnLanes {
    scratch: Scratch,
    /// The statistics that are asked for, is the yield one of them, and what of the drive they need.
    wanted: Set,
    counts: bool,
    outputs: Vec<usize>,
    conditions: Vec<usize>,
    /// Least counts without which a design is surely infeasible.
    least: Vec<LeastCount>,
    prepared: Vec<Vec<f64>>,
    /// The drive as a list for designs that differ in these inputs, where that serves, and whether it does for the current ones.
    list: Option<(Set, Option<DrawnList>)>,
    is_listed: bool,
    si: Vec<f64>,
    /// Inputs that differ between the designs that are still open: as the designs have them, and as the draw changes them.
    nominal: Vec<(usize, Vec<f64>)>,
    varying: Vec<(usize, Vec<f64>)>,
    /// Where these designs stand among those that were asked for.
    places: Vec<usize>,
    /// What of the drive differs between the designs, and what is the same for all: outputs and conditions.
    of_lanes: Parts,
    of_row: Parts,
    /// Outputs and margins of the drive in the current draw and case: of each design, and those that all share.
    results: Vec<Vec<f64>>,
    row_outputs: Vec<f64>,
    row_margins: Vec<f64>,
    /// Which designs could be built, and which hold so far in the current draw.
    built: Vec<u64>,
    holds: Vec<u64>,
    /// Constraints of a mean or sum that a draw must keep to hold: the folds of both ends.
    of_spectrum: Vec<(Constraint, [usize; 2])>,
    /// Quantities over the cases of the current draw, and what each statistic makes of the draws.
    folds: Vec<CaseFold>,
    tracks: Vec<Track>,
    /// Of every condition of the drive: what it takes away where it fails.
    takes: Vec<Takes>,
    /// A value that all designs share, as a column.
    same: Vec<f64>,
}

/// Outputs and conditions of the drive.
#[derive(Default)]
struct Parts {
    outputs: Vec<usize>,
    conditions: Vec<usize>,
}

/// What the failing of a condition takes away: the draw's holding, and the values of these folds and tracks.
struct Takes {
    holds: bool,
    folds: Vec<usize>,
    tracks: Vec<usize>,
}

impl Takes {
    fn new(kernel: &DrawnDrive, counts: bool, folds: &[CaseFold], tracks: &[Track]) -> Vec<Self> {
        let base = &kernel.base;
        let of = |condition: &Condition| {
            let takes = |quantity: Quantity| quantity.output().is_some_and(|it| condition.invalidates.contains(&base.outputs[it].name));
            let is_taken = |track: &Track| matches!(track, Track::Keeping { constraint, .. } if takes(constraint.quantity));
            Self {
                holds: !condition.quiet || (counts && kernel.holds.iter().any(|it| takes(it.quantity))),
                folds: (0..folds.len()).filter(|&it| takes(folds[it].asked.quantity)).collect(),
                tracks: (0..tracks.len()).filter(|&it| is_taken(&tracks[it])).collect(),
            }
        };
        base.conditions.iter().map(of).collect()
    }
}

impl DrawnLanes {
    /// Room for the statistics of a kernel that are asked for.
    pub fn new(kernel: &DrawnDrive, wanted: Set) -> Self {
        let base = &kernel.base;
        let asked = || kernel.statistics.iter().enumerate().filter(|(number, _)| wanted.contains(*number)).map(|(_, it)| it.kind);
        let counts = asked().any(|kind| kind == StatisticKind::Yield);
        let holds = kernel.holds.iter().filter(|_| counts).map(|it| it.quantity);
        let (outputs, conditions) = needs(base, holds.chain(asked().filter_map(|kind| kind.of())));
        let mut folds: Vec<CaseFold> = Vec::new();
        let sums = kernel.cases.weights.as_ref().map_or(0, |it| it.sums);
        let mut fold = |asked: AskedQuantity| {
            folds.iter().position(|it| it.asked == asked).unwrap_or_else(|| {
                let sums = if asked.over.is_worst() { 0 } else { sums };
                folds.push(CaseFold { asked, present: Vec::new(), result: Vec::new(), sums: vec![Vec::new(); sums] });
                folds.len() - 1
            })
        };
        let mut ends = |constraint: &Constraint| {
            [Worse::Lower, Worse::Higher].map(|worse| fold(AskedQuantity { quantity: constraint.quantity, over: constraint.over, worse }))
        };
        let of_spectrum = kernel.holds.iter().filter(|it| counts && !it.over.is_worst()).map(|it| (*it, ends(it))).collect();
        let mut keeping = |constraint: Constraint| {
            let folds = (!constraint.over.is_worst()).then(|| ends(&constraint));
            Track::Keeping { constraint, kept: Vec::new(), folds, count: Vec::new() }
        };
        let shares: Vec<Option<Track>> = kernel
            .statistics
            .iter()
            .enumerate()
            .map(|(number, it)| match it.kind {
                _ if !wanted.contains(number) => Some(Track::Idle),
                StatisticKind::Yield => Some(Track::Holding(Vec::new())),
                StatisticKind::YieldOf(constraint) => Some(keeping(constraint)),
                StatisticKind::Confirmed(_) => Some(Track::Fresh),
                StatisticKind::Plain(_) | StatisticKind::Over(..) => None,
            })
            .collect();
        let tracks = shares.into_iter().zip(&kernel.statistics).map(|(share, statistic)| {
            share.unwrap_or_else(|| match statistic.kind {
                StatisticKind::Over(asked, OverDraws::Mean) => Track::Sum { fold: fold(asked), sum: Vec::new() },
                StatisticKind::Over(asked, OverDraws::Sd | OverDraws::Quantile(_)) => Track::All { fold: fold(asked), values: Vec::new() },
                StatisticKind::Plain(asked) | StatisticKind::Over(asked, OverDraws::Worst) => {
                    let in_any = matches!(statistic.kind, StatisticKind::Plain(_));
                    Track::Worst { fold: fold(asked), worst: Vec::new(), present: Vec::new(), in_any }
                }
                StatisticKind::Yield | StatisticKind::YieldOf(_) | StatisticKind::Confirmed(_) => unreachable!("it is a share"),
            })
        });
        let tracks: Vec<Track> = tracks.collect();
        Self {
            takes: Takes::new(kernel, counts, &folds, &tracks),
            scratch: Scratch::new(base.inputs.len(), &*base.kernel),
            wanted,
            counts,
            outputs: outputs.iter().collect(),
            conditions: conditions.iter().collect(),
            least: Vec::new(),
            prepared: Vec::new(),
            list: None,
            is_listed: false,
            si: vec![0.0; base.inputs.len()],
            nominal: Vec::new(),
            varying: Vec::new(),
            places: Vec::new(),
            of_lanes: Parts::default(),
            of_row: Parts::default(),
            results: Vec::new(),
            row_outputs: vec![0.0; base.kernel.sizes().outputs],
            row_margins: vec![0.0; base.kernel.sizes().conditions],
            built: Vec::new(),
            holds: Vec::new(),
            of_spectrum,
            folds,
            tracks,
            same: Vec::new(),
        }
    }

    /// Does this room serve these statistics?
    pub fn serves(&self, wanted: Set) -> bool {
        self.wanted == wanted
    }

    /// From now on designs that have not one of these counts are left alone.
    pub fn ask_for(&mut self, least: Vec<LeastCount>) {
        self.least = least;
    }

    /// The statistics and conditions asked for, of designs that share the inputs that do not vary; of a design that is left
    /// alone only what shows that.
    /// `fresh` is asked for what fresh draws say of a design, by its inputs and the number of the statistic.
    pub fn run(&mut self, kernel: &DrawnDrive, inputs: &[f64], columns: &Columns<'_>, results: &mut [Vec<f64>], fresh: FreshOf<'_>) {
        let kept = self.tracks.iter().filter(|it| matches!(it, Track::All { .. })).count();
        let most = if kept == 0 { columns.count.next_multiple_of(LANES) } else { lanes_at_a_time(kernel.draws(), kept) };
        self.divide(kernel, columns);
        let absentees: Vec<usize> = kernel.absentees().collect();
        for first in (0..columns.count).step_by(most) {
            let range = first..columns.count.min(first + most);
            self.draw_all(kernel, inputs, columns, &range, &mut |lanes, at, place| {
                let lane = first + place;
                let mut design = inputs.to_vec();
                columns.varying.iter().for_each(|(input, values)| design[*input] = values[lane]);
                for (&output, result) in columns.outputs.iter().zip(&mut *results) {
                    result[lane] = if matches!(lanes.tracks[output], Track::Fresh) {
                        fresh(&design, output).unwrap_or(f64::NAN)
                    } else {
                        lanes.result(kernel, output, at, range.len()).unwrap_or(f64::NAN)
                    };
                }
                for (&condition, result) in columns.conditions.iter().zip(&mut results[columns.outputs.len()..]) {
                    let statistic = absentees[condition];
                    result[lane] = margin_of(lanes.result(kernel, statistic, at, range.len()).is_some());
                }
            });
        }
    }

    /// What of the drive differs between the designs of a block.
    fn divide(&mut self, kernel: &DrawnDrive, columns: &Columns<'_>) {
        let varying: Set = columns.varying.iter().map(|it| it.0).collect();
        let split =
            |all: &[usize], depends: &[Set]| -> (Vec<usize>, Vec<usize>) { all.iter().partition(|&&it| depends[it].meets(varying)) };
        let (outputs, row_outputs) = split(&self.outputs, &kernel.depends().outputs);
        let (conditions, row_conditions) = split(&self.conditions, &kernel.depends().conditions);
        self.of_lanes = Parts { outputs, conditions };
        self.of_row = Parts { outputs: row_outputs, conditions: row_conditions };
        if self.list.as_ref().is_none_or(|it| it.0 != varying) && columns.count >= LEAST_LANES {
            self.list = Some((varying, DrawnList::new(kernel, &self.of_lanes, &self.of_row, varying)));
        }
    }

    /// A statistic of a design after all draws.
    fn result(&self, kernel: &DrawnDrive, statistic: usize, lane: usize, count: usize) -> Option<f64> {
        let draws = kernel.draws();
        match (&self.tracks[statistic], kernel.statistics[statistic].kind) {
            (Track::Holding(count) | Track::Keeping { count, .. }, _) => Some(count[lane] as f64),
            (Track::Sum { sum, .. }, _) => Some(sum[lane] / draws as f64 + 0.0).filter(|it| it.is_finite()),
            (Track::Worst { worst, present, .. }, _) => (present[lane] != 0).then_some(worst[lane] + 0.0),
            (Track::All { values, .. }, StatisticKind::Over(asked, over)) => {
                let own: Vec<f64> = (0..draws).map(|draw| values[draw * count + lane]).collect();
                over_draws(&asked, over, &own)
            }
            (Track::All { .. }, _) => unreachable!("only sd and quantiles need all values"),
            (Track::Fresh | Track::Idle, _) => unreachable!("fresh draws are asked elsewhere, and others that nobody wants not at all"),
        }
    }

    /// All draws of some of the designs. `tell` is given each of them when it is done: where it stands now, and where it stood in the range.
    fn draw_all(
        &mut self,
        kernel: &DrawnDrive,
        inputs: &[f64],
        columns: &Columns<'_>,
        range: &Range<usize>,
        tell: &mut dyn FnMut(&Self, usize, usize),
    ) {
        let base = &kernel.base;
        self.begin(kernel, columns, range);
        self.list_designs(inputs);
        let wanted = Set::of(&self.outputs);
        let cases = kernel.cases.rows.len();
        // What the first stage reads decides how often it must run: for every draw, every case, or once.
        let reads = kernel.depends().prepared;
        let by_draw = reads.meets(kernel.drawn.iter().map(|it| it.0).collect());
        let by_case = reads.meets(kernel.cases.inputs.iter().collect());
        self.prepared.resize(if by_case { cases } else { 1 }, Vec::new());
        self.prepared.iter_mut().for_each(|it| it.resize(base.kernel.prepared_len(), 0.0));
        let total = kernel.cases.weights.as_ref().map_or(1.0, |it| it.total);
        // The first cases for which the first stage has run; a draw that nothing survives leaves the rest to later ones.
        let mut ready = 0;
        for draw in 0..kernel.draws() {
            let count = self.places.len();
            self.begin_draw(count);
            for case in 0..cases {
                self.turn(kernel, inputs, (draw, case));
                let place = if by_case { case } else { 0 };
                if self.is_listed {
                    // The list has its own first stage.
                } else if (by_draw && (by_case || case == 0)) || place >= ready {
                    base.kernel.prepare(&self.si, wanted, &mut self.prepared[place]);
                    ready = ready.max(place + 1);
                }
                if !self.take_case(kernel, (draw, case, place), count) {
                    break;
                }
            }
            let Self { folds, built, .. } = self;
            folds.iter_mut().for_each(|fold| fold.end(count, total, built));
            self.take_draw(draw, count);
            if (draw + 1) % LOOK == 0 && draw + 1 < kernel.draws() && !self.leave_out((kernel.draws() - draw - 1) as u64, tell) {
                return;
            }
        }
        (0..self.places.len()).for_each(|at| tell(self, at, self.places[at]));
    }

    /// Tells of designs that are surely infeasible whatever the draws that remain, and leaves them out; false if none is left.
    fn leave_out(&mut self, remain: u64, tell: &mut dyn FnMut(&Self, usize, usize)) -> bool {
        let count = self.places.len();
        let open: Vec<usize> = (0..count).filter(|&at| !decided(&self.least, &self.tracks, at, remain)).collect();
        let stays = self.tracks.iter().any(|it| matches!(it, Track::All { .. }));
        // Moving the others costs as much as a draw or so: it must pay.
        if !open.is_empty() && (stays || 4 * open.len() > 3 * count) {
            return true;
        }
        let mut next = open.iter().copied().peekable();
        for at in 0..count {
            if next.next_if_eq(&at).is_none() {
                tell(self, at, self.places[at]);
            }
        }
        if open.is_empty() {
            return false;
        }
        let Self { nominal, varying, places, tracks, .. } = self;
        keep(places, &open);
        places.truncate(open.len());
        let padded = open.len().next_multiple_of(LANES);
        for column in nominal.iter_mut().chain(varying).map(|it| &mut it.1) {
            keep(column, &open);
            column.truncate(padded);
        }
        tracks.iter_mut().for_each(|track| track.keep(&open));
        self.is_listed &= open.len() >= LEAST_LANES;
        if let Some((_, Some(list))) = self.list.as_mut().filter(|_| self.is_listed) {
            list.keep(&open);
        }
        true
    }

    fn begin(&mut self, kernel: &DrawnDrive, columns: &Columns<'_>, range: &Range<usize>) {
        let count = range.len();
        let padded = count.next_multiple_of(LANES);
        self.places = (0..count).collect();
        self.nominal.clear();
        self.nominal.extend(columns.varying.iter().map(|(input, values)| (*input, values[range.start..range.start + padded].to_vec())));
        self.varying.clone_from(&self.nominal);
        self.results.resize(self.of_lanes.outputs.len() + self.of_lanes.conditions.len(), Vec::new());
        let fit = |column: &mut Vec<f64>| column.resize(padded.max(column.len()), 0.0);
        self.results.iter_mut().for_each(fit);
        fit(&mut self.same);
        self.built.resize(padded, 0);
        self.holds.resize(padded, 0);
        for fold in &mut self.folds {
            fold.present.resize(padded, 0);
            fold.result.resize(padded, 0.0);
            fold.sums.iter_mut().for_each(|sum| sum.resize(padded, 0.0));
        }
        for (track, statistic) in self.tracks.iter_mut().zip(&kernel.statistics) {
            track.begin(statistic, (kernel.draws(), count, padded));
        }
    }

    /// Hands the designs that were begun to the list, if it serves them.
    fn list_designs(&mut self, inputs: &[f64]) {
        self.is_listed = false;
        if let Some((_, Some(list))) = &mut self.list
            && self.places.len() >= LEAST_LANES
        {
            list.begin(inputs, &self.nominal);
            self.is_listed = true;
        }
    }

    fn begin_draw(&mut self, count: usize) {
        self.built[..count].fill(IN);
        self.holds[..count].fill(IN);
        self.folds.iter_mut().for_each(|fold| fold.begin(count));
        for track in &mut self.tracks {
            if let Track::Keeping { kept, .. } = track {
                kept[..count].fill(IN);
            }
        }
    }

    /// Turns the inputs to a draw in a case.
    fn turn(&mut self, kernel: &DrawnDrive, inputs: &[f64], (draw, case): (usize, usize)) {
        let count = self.places.len();
        self.si.copy_from_slice(inputs);
        for (&input, &value) in kernel.cases.inputs.iter().zip(&kernel.cases.rows[case]) {
            self.si[input] = input_to_si(&kernel.base.inputs[input], value);
        }
        for (&(input, effect), column) in kernel.drawn.iter().zip(&kernel.columns) {
            let drawn = column[draw];
            match self.nominal.iter().position(|it| it.0 == input) {
                None => {
                    self.si[input] = kernel.actual((input, effect), self.si[input], drawn);
                    if !kernel.fits(input, self.si[input]) {
                        self.built[..count].fill(0);
                    }
                }
                // What the design says is the same in every case.
                Some(_) if case > 0 => {}
                Some(at) => {
                    let nominal = &self.nominal[at].1;
                    for (lane, value) in self.varying[at].1.iter_mut().enumerate() {
                        *value = kernel.actual((input, effect), nominal[lane], drawn);
                        if lane < count && !kernel.fits(input, *value) {
                            self.built[lane] = 0;
                        }
                    }
                }
            }
        }
    }

    /// Takes in a draw, all cases of which are known.
    fn take_draw(&mut self, draw: usize, count: usize) {
        let Self { built, holds, of_spectrum, folds, tracks, .. } = self;
        keep_marked(holds, built);
        for (constraint, ends) in of_spectrum {
            keep_folds(&mut holds[..count], constraint, *ends, folds);
        }
        for track in tracks {
            match track {
                Track::Holding(counts) => add_one(counts, &holds[..count]),
                Track::Keeping { constraint, kept, folds: ends, count: counts } => {
                    keep_marked(kept, built);
                    if let Some(ends) = ends {
                        keep_folds(&mut kept[..count], constraint, *ends, folds);
                    }
                    add_one(counts, &kept[..count]);
                }
                Track::Sum { fold, sum } => {
                    let CaseFold { present, result, .. } = &folds[*fold];
                    for ((sum, value), present) in sum.iter_mut().zip(&result[..count]).zip(present) {
                        *sum += if *present == 0 { f64::NAN } else { *value };
                    }
                }
                Track::Worst { fold, worst, present: all, in_any } => {
                    let CaseFold { asked, present, result, .. } = &folds[*fold];
                    for lane in 0..count {
                        if present[lane] != 0 {
                            worst[lane] = worse_of(asked.worse, worst[lane], result[lane]);
                        }
                        all[lane] = if *in_any { all[lane] | present[lane] } else { all[lane] & present[lane] };
                    }
                }
                Track::All { fold, values } => {
                    let CaseFold { present, result, .. } = &folds[*fold];
                    for ((to, value), present) in values[draw * count..].iter_mut().zip(&result[..count]).zip(present) {
                        *to = if *present == 0 { f64::NAN } else { *value };
                    }
                }
                Track::Fresh | Track::Idle => {}
            }
        }
    }
}
