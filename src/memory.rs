//! Estimates the peak memory of a sweep and the sizes of its files before it begins. For `check` and for the jobs of a cluster.
//!
//! A run has three phases, and the largest of them decides: the sweep, with the states of the reducers; the tables, made in memory one
//! after the other; and the page. What each takes per cell, row and value was measured; `benches/memory` compares the estimate with the
//! peaks of whole runs.

use crate::certify::{self, Column};
use crate::models::{Effort, to_si};
use crate::names::MOST_ON_PAGE;
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::reduce::{Reduction, Reported};
use crate::screen::{CpuEngine, Tables};
use crate::study::{Axis, InfluenceOver, Levels};
use std::ops::Range;
use std::time::{Duration, Instant};

/// The program itself, with a small study.
const PROGRAM: u64 = 15_500_000;
/// A thread with its blocks.
const THREAD: u64 = 350_000;
/// Bytes of a cell of a map in the state, and with the copy and the serialised bytes while a checkpoint is saved.
const CELL: u64 = 24;
const CELL_SAVED: u64 = 70;
/// Bytes of a cell that a chunk has touched, as far as the tables do not use them again, and the most cells that a chunk may touch.
const CELL_MET: u64 = 9;
const MET: u64 = 1 << 20;
/// Bytes of a cell in each column of a map's table, and while the table is written.
const CELL_COLUMN: u64 = 16;
const CELL_WRITTEN: u64 = 20;
/// Bytes of a value in a list of cases, and while `study.json` is written.
const CASE: u64 = 30;
const CASE_DESCRIBED: u64 = 680;
/// Bytes of a row of a table of designs, of each of its columns (a quantity that no design axis sets has two), and of each input.
const ROW: u64 = 310;
const ROW_COLUMN: u64 = 140;
const ROW_INPUT: u64 = 50;
/// Bytes of a label of such a row, a text of some twenty characters: held, as text and in Parquet.
const ROW_LABEL: u64 = 100;
/// Bytes of the page, of a number in a cell of a map that it shows (a cell has three or four, read as text), of a design on it, of each
/// output of such a design, and of a row of the list of all designs.
const PAGE: u64 = 1_000_000;
const PAGE_NUMBER: u64 = 76;
const PAGE_ROW: u64 = 1_000;
const PAGE_OUTPUT: u64 = 50;
const PAGE_VARIANT: u64 = 1_500;
/// Bytes of the slices around the knee, which are free again before the rest of the page takes as much.
const AROUND: u64 = 2_700_000;
/// Bytes of a column or an axis of a design that is a dot on the page: packed, as text, and what its row of the table leaves.
const DOT: u64 = 90;
/// Bytes of a combination of inputs whose sensitivity is looked at.
const COMPARED: u64 = 1_500;
/// Indices kept per design of a sample: up to twice as many as are wanted may wait.
const INDICES: u64 = 2;
/// Copies of packed numbers: those that are kept, and while a checkpoint is saved a copy and its bytes.
const PACKED_COPIES: u64 = 3;
/// Copies of a point of the front during the sweep.
const POINT_COPIES: u64 = 6;
/// Measured peaks scatter, so the estimate is multiplied by this many per cent: rather too high than too low.
const MARGIN: u64 = 112;
/// If only coarser grids were judged, the front of the whole study may be larger than expected by one part in this many.
const UNSEEN: u64 = 8;
/// Designs for which the memory of solving them is asked.
const ASKED: u64 = 192;

/// About how long fronts of coarser grids are computed.
const LOOK: Duration = Duration::from_millis(600);

/// The memory that a run of a study needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Needs {
    /// Expected number of designs on the front.
    pub front: u64,
    /// Bytes of memory at the peak of a whole run.
    pub run: u64,
    /// Bytes of memory at the peak of a shard, which leaves no tables.
    pub shard: u64,
    /// Bytes of memory at the peak of merging shards.
    pub merge: u64,
}

/// Sizes of the parts of a study.
struct StudySizes {
    /// Cells of all maps, and bytes of the largest table of one.
    cells: u64,
    table: u64,
    bins: u64,
    /// Numbers in the cells of the maps that a page shows.
    shown: u64,
    /// Values of lists of cases.
    cases: u64,
    /// Rows of tables of designs besides the front.
    rows: u64,
    variants: u64,
    /// Designs of which only the index is kept during a sweep, and designs that are dots on a page.
    indices: u64,
    dots: u64,
    /// Bytes of packed numbers of designs.
    packed: u64,
    /// Bytes of a row.
    row: u64,
    outputs: u64,
    objectives: u64,
    /// Columns and axes of a design that is a dot.
    dotted: u64,
}

impl StudySizes {
    fn new(plan: &Plan) -> Self {
        let study = &plan.study;
        let report = &study.report;
        let room = Reported::room(plan);
        let table = |&(cells, columns): &(u64, u64)| cells.saturating_mul(columns * CELL_COLUMN + CELL_WRITTEN);
        let variants = if report.variants { plan.designs() } else { 0 };
        let bytes_of = |it: &certify::Column| if certify::design_input(study, it.quantity).is_some() { ROW_INPUT } else { ROW_COLUMN };
        let axes = study.design.iter().chain(&study.operation).chain(&study.uncertainty);
        let listed = |axis: &Axis| match axis {
            Axis::Joint { inputs, .. } => axis.count() * inputs.len() as u64,
            Axis::Single { levels: Levels::List(list), .. } => list.len() as u64,
            Axis::Single { .. } => 0,
        };
        Self {
            cells: room.cells,
            table: room.tables.iter().map(table).max().unwrap_or(0),
            bins: room.bins,
            shown: room.shown,
            cases: axes.map(listed).chain(study.labels.iter().map(|it| it.texts.len() as u64)).sum(),
            rows: variants + room.rows,
            indices: room.indices,
            dots: room.dots,
            packed: room.packed,
            variants,
            row: ROW + study.labels.len() as u64 * ROW_LABEL + certify::columns(study).iter().map(bytes_of).sum::<u64>(),
            outputs: study.model.outputs.len() as u64,
            objectives: study.objectives.len() as u64,
            dotted: (certify::columns(study).len() + study.design.len()) as u64,
        }
    }
}

impl Needs {
    /// For a study, on this many threads, with a page or without.
    pub fn of(plan: &Plan, threads: usize, page: bool) -> Self {
        let expected = if plan.study.objectives.is_empty() { Expected::Known(0) } else { expected_front(plan, threads, Look::For(LOOK)) };
        let needs = Self::with_front(plan, threads, page, expected.at_most());
        Self { front: expected.designs(), ..needs }
    }

    /// The same for a known size of the front.
    pub fn with_front(plan: &Plan, threads: usize, page: bool, front: u64) -> Self {
        let sizes = StudySizes::new(plan);
        let threads = threads.max(1) as u64;
        let sum = |parts: &[u64]| parts.iter().fold(0, |sum: u64, &part| sum.saturating_add(part));
        let times = |count: u64, bytes: u64| count.saturating_mul(bytes);

        let program = sum(&[
            PROGRAM,
            Tables::bytes(plan),
            times(sizes.cases, CASE),
            times(threads, THREAD + Tables::row_bytes(plan)),
            solving(plan, threads),
            // A thread has the edges of the bins too.
            8 * sizes.bins * (2 * threads + 2),
            times(sizes.indices, INDICES * 8 * (threads + 2)),
            times(sizes.packed, PACKED_COPIES),
            plan.study.probability.as_ref().map_or(0, |it| it.bytes(threads, plan.fast.count(), plan.used_outputs())),
        ]);
        let met = times(sizes.cells.min(MET), CELL_MET);
        let points = times(front, POINT_COPIES * 8 * (sizes.objectives + 1));
        let shard = sum(&[program, times(sizes.cells, CELL_SAVED), points]);
        let state = sum(&[program, times(sizes.cells, CELL), met]);
        let rows = times(front + sizes.rows, sizes.row);
        let columns = certify::columns(&plan.study);
        let together = |columns: &[Column], designs: u64| certify::room(plan, columns, designs, threads);
        let certifying = together(&columns, front.max(sizes.rows));
        let tables = sum(&[state, times(sizes.cases, CASE_DESCRIBED), rows, sizes.table, times(compared(plan), COMPARED), certifying]);
        let on_page = [
            times(front.min(MOST_ON_PAGE as u64), PAGE_ROW + PAGE_OUTPUT * sizes.outputs),
            times(sizes.variants, PAGE_VARIANT),
            times(sizes.shown, PAGE_NUMBER),
            times(sizes.dots, DOT * sizes.dotted),
            together(&certify::all_columns(&plan.study), front.min(MOST_ON_PAGE as u64)),
        ];
        let page = if page { sum(&[state, PAGE, sum(&on_page).max(AROUND)]) } else { 0 };
        let merged = sum(&[shard, times(sizes.cells, CELL)]);
        let with_margin = |bytes: u64| bytes / 100 * MARGIN;
        Self {
            front,
            run: with_margin(shard.max(tables).max(page)),
            shard: with_margin(shard),
            merge: with_margin(merged.max(tables).max(page)),
        }
    }
}

/// Combinations of which the sensitivity has all numbers in memory at a time.
fn compared(plan: &Plan) -> u64 {
    const MOST: u64 = 1 << 14;
    plan.study.report.sensitivity.as_ref().map_or(0, |it| match it.over {
        InfluenceOver::Design => plan.designs().max(it.draws).min(MOST),
        InfluenceOver::Uncertainty => it.draws.min(MOST),
    })
}

/// Bytes that this many threads need to solve designs: the most of some designs from all over the study.
fn solving(plan: &Plan, threads: u64) -> u64 {
    let kernel = &plan.study.model.kernel;
    let asked = ASKED.min(plan.designs());
    let design = |step| if asked == plan.designs() { step } else { plan.spread(step) };
    let needs = (0..asked).map(|step| kernel.footprint(&to_si(&plan.study.model, &plan.space.inputs(design(step), 0))));
    let (prepared, scratch) = needs.fold((0, 0), |most, needs| (most.0.max(needs.prepared), most.1.max(needs.scratch)));
    let kept = prepared.saturating_mul(plan.kept_scenarios());
    // Certification and completing the page each have a table per thread, and one of the two has the tables of all scenarios.
    threads * (kept + 2 * 8 * kernel.prepared_len() as u64 + scratch) + kept
}

/// The expected number of designs on the front.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Expected {
    /// Exact, because all designs were judged, or an upper limit.
    Known(u64),
    /// A guess from the fronts of coarser grids.
    Guessed(u64),
}

impl Expected {
    fn designs(self) -> u64 {
        let (Self::Known(designs) | Self::Guessed(designs)) = self;
        designs
    }

    /// The number, with a reserve if it is a guess.
    fn at_most(self) -> u64 {
        match self {
            Self::Known(designs) => designs,
            Self::Guessed(designs) => designs.saturating_add(designs / 100 * UNSEEN),
        }
    }
}

/// How long coarser grids are judged.
#[derive(Clone, Copy, Debug)]
enum Look {
    /// About this long.
    For(Duration),
    /// This many grids, however long that takes.
    #[cfg_attr(not(test), allow(dead_code, reason = "a clock is no test"))]
    Grids(usize),
}

/// The expected number of designs on the front, from the fronts of coarser grids, each four times as large as the one before, as many as
/// the time allows. It is exact if one of them is the whole study.
///
/// The front of a grid grows with a power of the grid's size, which the last two grids show. (Random designs would not do: where quantities
/// rise or fall all along an axis, the front is at the ends of the axis.)
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an estimate for people")]
fn expected_front(plan: &Plan, threads: usize, look: Look) -> Expected {
    let time = if let Look::For(time) = look { time } else { LOOK };
    let threads = threads.max(1);
    let Effort { prepare, finish } = plan.effort();
    let designs = plan.designs();
    let affordable = (time.as_secs_f64() / (prepare + finish)) as u64 * threads as u64;
    if affordable < 2 {
        return Expected::Known(designs.min(plan.study.report.front_budget));
    }
    let tables = Tables::new(plan);
    let reduction = Reduction::new(plan, &vec![(0.0, 1.0); plan.study.report.histograms.len()]);
    let start = Instant::now();
    // `None` if it takes too long.
    let front_of = |pieces: &[Range<u64>], until: Option<Instant>| {
        let share = pieces.len().div_ceil(threads);
        let parts = on_threads(pieces.chunks(share), |pieces| {
            let (mut engine, mut reducers) = (CpuEngine::new(plan, &tables), reduction.start());
            for piece in pieces {
                if until.is_some_and(|until| Instant::now() > until) {
                    return None;
                }
                engine.screen(piece.clone(), |block| reduction.absorb(&mut reducers, block));
            }
            Some(reducers.into_fresh())
        });
        let mut reducers = reduction.start();
        parts.into_iter().try_for_each(|part| part.map(|part| reducers.merge(part)))?;
        Some(reducers.state().front.len() as u64)
    };
    if matches!(look, Look::For(_)) && designs as f64 * plan.seconds_per_design() / (threads as f64) < time.as_secs_f64() {
        let pieces: Vec<_> = (0..designs).step_by(PIECE).map(|first| first..designs.min(first + PIECE as u64)).collect();
        // Allow some more time, because the machine may have other work too, and without this grid the guess is far less certain.
        if let Some(front) = front_of(&pieces, Some(start + 3 * time)) {
            return Expected::Known(front);
        }
    }
    let start = Instant::now();
    let (mut fronts, mut most): (Vec<(f64, f64)>, _) = (Vec::new(), LEAST_GRID.min(affordable));
    let goes_on = |grids: usize| match look {
        Look::For(time) => 4 * start.elapsed() < time,
        Look::Grids(most) => grids < most,
    };
    while fronts.is_empty() || goes_on(fronts.len()) {
        let mut positions: Vec<u64> = plan.space.designs.coarse(most).iter().map(|&design| plan.position_of(design)).collect();
        positions.sort_unstable();
        let pieces: Vec<_> = positions.chunk_by(|a, b| a + 1 == *b).map(|piece| piece[0]..piece[piece.len() - 1] + 1).collect();
        // The first grid is small. If judging it takes long, it is all that is known.
        let until = matches!(look, Look::For(_)) && !fronts.is_empty();
        let Some(front) = front_of(&pieces, until.then(|| start + 2 * time)) else { break };
        if positions.len() as u64 == designs {
            return Expected::Known(front);
        }
        fronts.push((positions.len() as f64, front as f64));
        most = 4 * positions.len() as u64;
    }
    let &[.., (size, front)] = &fronts[..] else {
        return Expected::Known(designs.min(plan.study.report.front_budget));
    };
    let (before, least) = if fronts.len() > 1 { fronts[fronts.len() - 2] } else { (1.0, 1.0) };
    let growth = (front.max(1.0) / least.max(1.0)).ln() / (size / before).ln().max(f64::MIN_POSITIVE);
    let whole = front * (designs as f64 / size).powf(growth.clamp(0.0, 1.0));
    Expected::Guessed((whole as u64).min(designs).min(plan.study.report.front_budget.max(front as u64)))
}

/// Designs of the coarsest grid.
const LEAST_GRID: u64 = 256;
/// Designs that are judged at a time where all of them are.
const PIECE: usize = 1 << 12;

/// `check` lists files larger than this.
const LARGE: u64 = 100_000_000;
/// Characters of a number in a table with its comma, on average over long tables.
const NUMBER: u64 = 19;
/// Bytes of a value in Parquet.
const PACKED: u64 = 8;

/// Of a study that asks for all feasible designs: as many as there may be, and about how many bytes each takes in their file.
pub fn most_feasible(plan: &Plan) -> Option<(u64, u64)> {
    plan.study.report.feasible.then(|| (plan.designs(), PACKED * plan.study.row_numbers()))
}

/// The large files that a run will write, with about how many bytes they will have.
pub fn large_files(plan: &Plan, front: u64) -> Vec<(String, u64)> {
    let study = &plan.study;
    let inputs = |axes: &[Axis]| axes.iter().map(|axis| axis.inputs().len() as u64).sum::<u64>();
    let columns = certify::columns(study).len() as u64;
    let scenario = inputs(&study.operation) + inputs(&study.uncertainty) + u64::from(plan.listed_weights().is_some());
    let row = NUMBER * (inputs(&study.design) + study.labels.len() as u64 + columns) + 7 * (1 + columns);
    let mut files = vec![
        ("scenarios.csv".to_owned(), plan.scenarios().saturating_mul(scenario * NUMBER + 9)),
        ("front.csv".to_owned(), front.saturating_mul(row)),
    ];
    let room = Reported::room(plan);
    files.extend(room.lists.into_iter().map(|(name, rows)| (name, rows.saturating_mul(row))));
    files.extend(room.files.into_iter().map(|(name, numbers)| (name, numbers.saturating_mul(PACKED))));
    files.retain(|(_, bytes)| *bytes > LARGE);
    files
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    fn plan(text: &str) -> Plan {
        Plan::new(Study::parse_in(text, "study.toml", ".".as_ref()).expect("it is a study"))
    }

    fn grid(levels: u64, rest: &str) -> Plan {
        plan(&format!(
            "model = \"metal-cvt\"\n[design]\ngroove_angle_deg = {{ from = 18, to = 30, count = {levels} }}\n\
             band_thickness_mm = {{ from = 0.1, to = 0.3, count = {levels} }}\n[objectives]\naxial_force_N = \"min\"\n\
             stress_margin = \"max\"\n{rest}"
        ))
    }

    #[test]
    fn the_front_of_a_small_study_is_known_and_that_of_a_large_one_about() {
        let of = |levels, look| expected_front(&grid(levels, ""), 2, look).designs();
        let long = Look::For(Duration::from_secs(600));
        let (small, large) = (of(20, long), of(120, long));
        assert!(small > 10 && large > 5 * small, "{small} {large}");
        // By coarser grids alone.
        let guessed = of(120, Look::Grids(2));
        assert!((large / 3..large * 3).contains(&guessed), "{guessed} for {large}");
        // The memory is estimated with a reserve for a guess, and without one for a known number.
        assert_eq!((Expected::Guessed(1000).at_most(), Expected::Known(1000).at_most()), (1080, 1000));
    }

    #[test]
    fn threads_pages_maps_cases_and_variants_take_memory() {
        let needs = |plan: &Plan, threads, page| Needs::with_front(plan, threads, page, 1000);
        let plain = grid(100, "");
        let one = needs(&plain, 1, false);
        // A small study takes little beside the program itself.
        assert!(one.run > PROGRAM && one.run < PROGRAM / 4 * 5, "{one:?}");
        assert!(needs(&plain, 8, false).run > one.run);
        assert!(needs(&plain, 1, true).run > one.run + 1_000_000);
        assert!(Needs::with_front(&plain, 1, false, 1_000_000).run > one.run + 300_000_000);
        let map = "[report]\nmaps = [{ x = \"groove_angle_deg\", y = \"band_thickness_mm\", best = \"share\" }]";
        let mapped = needs(&grid(3000, map), 1, false);
        // The table of the map is only made when shards are merged.
        assert!(mapped.run > mapped.shard && mapped.merge > mapped.shard && mapped.shard > 500_000_000, "{mapped:?}");
        let listed = needs(&grid(100, "[report]\nvariants = true"), 1, true);
        assert!(listed.run > needs(&plain, 1, true).run + 10_000_000);
        let drawn = needs(&grid(3000, "[report]\nsample = 1_000_000"), 2, true);
        assert!(drawn.run > needs(&grid(3000, ""), 2, true).run + 500_000_000 && drawn.shard > 60_000_000, "{drawn:?}");
        let written = grid(3000, "[report]\nfeasible = true");
        assert!(needs(&written, 2, true).shard > needs(&grid(3000, ""), 2, true).shard + 25_000_000);
        assert_eq!((most_feasible(&written), most_feasible(&plain)), (Some((9_000_000, 56)), None));
        let rows: String = (1..=50_000).map(|torque| format!("{{ torque_Nm = {torque} }},")).collect();
        let cases = plan(&format!("model = \"metal-cvt\"\n[design]\ncases = [{rows}]\n[objectives]\naxial_force_N = \"min\"\n"));
        assert!(needs(&cases, 1, false).run > one.run + 20_000_000);
    }

    #[test]
    fn large_files_are_told_with_their_sizes() {
        let scenarios = |levels| {
            plan(&format!(
                "model = \"metal-cvt\"\n[design]\nband_count = [6, 7]\n[uncertainty]\nratio = {{ from = 0.5, to = 2, count = {levels} }}\n\
                 friction = {{ from = 0.05, to = 0.09, count = 4000 }}\n[objectives]\ntorque_capacity_Nm = \"max\"\n"
            ))
        };
        let files = large_files(&scenarios(5000), 1);
        // The file of this study has 943 744 914 bytes.
        assert!(matches!(&files[..], [(name, 850_000_000..1_050_000_000)] if name == "scenarios.csv"), "{files:?}");
        assert_eq!(large_files(&scenarios(50), 1), []);
        let map = "[report]\nmaps = [{ x = \"groove_angle_deg\", y = \"band_thickness_mm\", value = \"axial_force_N\" }]";
        let sample = "[report]\nsample = 1_000_000\ncolumns = [\"max_stress_MPa\", \"slip_margin\"]";
        let files = large_files(&grid(8000, sample), 1000);
        assert!(matches!(&files[..], [(name, 100_000_001..)] if name == "sample.csv"), "{files:?}");
        let files = large_files(&grid(8000, map), 1_000_000_000);
        assert_eq!(files.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["front.csv", "map-axial_force_N.parquet"]);
    }
}
