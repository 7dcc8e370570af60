//! The device's side of a sweep: buffers, tiles in flight, and what comes back.

use super::constants::Level;
use super::constants::{
    APPENDED, DIGIT_VECTORS, FIRST_REPORTED, GROUPS, IS_UNSURE, LANE_BITS, MAY_BE_END, MAY_BE_FRONT, MAY_BE_IN_MAP, OPEN, OPEN_PARTS,
    SCENARIO_PER_LANE, SCENARIO_PER_ROW, SINGLY, SURE, SURVIVOR_HEAD, UNDECIDED,
};
use super::cut::{Extras, MOST_GROUPS, Runs};
use super::held::histogram_beyond_f32;
use super::held::refuse;
use super::kernel::{self, Coordinate, check_words, coordinates, entries, survivor_words, text};
use super::known::{self, KnownUniform};
use super::layout::{KernelLayout, push_level};
use super::row_scenarios::RowScenarios;
use super::wrong::Wrong;
use crate::decision::Decision;
use crate::error::Result;
use crate::gpu::constants::{UNSURE, YES};
use crate::gpu::{Buffer, Device, Program, WORKGROUP, Wait};
use crate::plan::Plan;
use crate::reduce::{Answers, MOST_OBJECTIVES, ReducerNeeds, Reported};
use crate::screen::Tables;
use crate::study::{Best, Quantity};
use crate::tape::RunningError;
use bytemuck::{Pod, Zeroable};
use std::mem::offset_of;
use std::ops::Range;

/// Most bytes of the table that passes between the stages.
const PREPARED_BYTES: u64 = 64 << 20;
/// Least survivors that come back with the counts. As many come as twice those of the tile before; more take a second trip.
const LEAST_TRIP: u64 = 1 << 14;
/// Most designs of a tile: counts and places are 32-bit numbers.
const MOST_DESIGNS: u64 = 1 << 31;
/// Evaluations of a first dispatch.
const FIRST_EVALUATIONS: u64 = 1 << 26;

/// The uniform `Tile` of the kernel.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Tile {
    rows: u32,
    first_lane: u32,
    last_lane: u32,
    capacity: u32,
    index: [u32; 2],
    window: u32,
    open_room: u32,
    digits: [u32; 4 * DIGIT_VECTORS as usize],
}

impl Tile {
    /// Its members as the kernel must have them.
    const MEMBERS: [(&'static str, usize); 8] = [
        ("rows", offset_of!(Tile, rows)),
        ("first_lane", offset_of!(Tile, first_lane)),
        ("last_lane", offset_of!(Tile, last_lane)),
        ("capacity", offset_of!(Tile, capacity)),
        ("index", offset_of!(Tile, index)),
        ("window", offset_of!(Tile, window)),
        ("open_room", offset_of!(Tile, open_room)),
        ("digits", offset_of!(Tile, digits)),
    ];
}

/// A design that the device cannot decide alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Survivor {
    /// Its position in the sweep's order.
    pub position: u64,
    /// Not counted by the device: f64 decides whether it is feasible.
    pub unsure: bool,
    /// May it be part of the top list or a sample, or an extreme?
    pub end: bool,
    /// A lower bound of each coordinate of the front, as the device has it, if it may be on the front.
    pub front: Option<[f32; MOST_OBJECTIVES]>,
    /// A lower and an upper bound of the key in each map of values, if it may be the best of a cell.
    pub maps: Option<Vec<[f32; 2]>>,
}

/// The survivors of a tile, as they came back: in the order in which the device met them, which is roughly that of the rows.
#[derive(Clone, Debug)]
pub struct Survivors {
    records: Vec<u32>,
    /// Words of a record.
    words: usize,
    first_row: u64,
    /// Designs of a row.
    width: u64,
    objectives: usize,
}

impl Survivors {
    /// How many.
    pub fn len(&self) -> usize {
        self.records.len() / self.words
    }

    /// Survived none?
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Number `at`.
    pub fn get(&self, at: usize) -> Survivor {
        let record = &self.records[at * self.words..(at + 1) * self.words];
        let (lane, why) = (u64::from(record[1] & ((1 << LANE_BITS) - 1)), record[1] >> LANE_BITS);
        let keys = &record[SURVIVOR_HEAD as usize..];
        let front = (why & MAY_BE_FRONT != 0).then(|| {
            let mut lower = [0.0; MOST_OBJECTIVES];
            lower.iter_mut().zip(&keys[..self.objectives]).for_each(|(key, &bits)| *key = f32::from_bits(bits));
            lower
        });
        let maps = (why & MAY_BE_IN_MAP != 0)
            .then(|| keys[self.objectives..].chunks(2).map(|it| [f32::from_bits(it[0]), f32::from_bits(it[1])]).collect());
        let position = (self.first_row + u64::from(record[0])) * self.width + lane;
        Survivor { position, unsure: why & IS_UNSURE != 0, end: why & MAY_BE_END != 0, front, maps }
    }

    /// One after the other.
    pub fn iter(&self) -> impl Iterator<Item = Survivor> {
        (0..self.len()).map(|at| self.get(at))
    }
}

/// What a device counted in a tile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileCounts {
    /// Surely feasible designs.
    pub sure: u64,
    /// Designs that f64 must decide.
    pub unsure: u64,
    /// Runs that were judged in parts: as a whole they were not settled.
    pub open_runs: u64,
    /// Designs that were judged singly: neither the run that they are in nor its part settled them.
    pub singly: u64,
    /// What each reducer asks to be counted.
    pub reported: Vec<Vec<u32>>,
}

/// A tile that the device is working on.
#[derive(Debug)]
pub struct InFlight {
    /// Its positions.
    pub range: Range<u64>,
    rows: Range<u64>,
    slot: usize,
    /// Words that come back at once.
    words: usize,
    wait: Wait,
}

/// One design as the device judged it, for comparison with f64.
#[derive(Clone, Debug)]
pub struct Checked {
    /// Is it feasible?
    pub verdict: Decision,
    /// Worst value and error bound of each tracked quantity, outputs in SI.
    pub worst: Vec<RunningError>,
    /// Value and error bound of each used output in one scenario, in SI.
    pub asked: Vec<RunningError>,
    /// That scenario: slow, fast.
    pub scenario: (u64, u64),
}

/// Buffers of a tile; there are two, so that one is read while the other is worked on.
#[derive(Debug)]
struct Slot {
    tile: Buffer,
    known: Buffer,
    dominator_table: Buffer,
    counts: Buffer,
    survivors: Buffer,
    landing: Buffer,
    bound: wgpu::BindGroup,
}

/// Judges tiles of a study on a device.
#[derive(Debug)]
pub struct GpuEngine<'p> {
    plan: &'p Plan,
    layout: KernelLayout,
    coordinates: Vec<Coordinate>,
    device: Device,
    program: Program,
    levels: Buffer,
    zeros: Buffer,
    cells: Buffer,
    /// Room for open runs, and for their open parts.
    open_room: u64,
    /// The workgroups that judge open runs, and those that judge open parts.
    groups: Buffer,
    /// What finds the scenarios that decide about a row, where rows are told, and where these stand.
    row_scenarios: Option<RowScenarios<'p>>,
    decisive: Buffer,
    slots: Vec<Slot>,
    next: usize,
    /// Levels of the outermost slow dimension that the device has.
    window: Range<u64>,
    window_room: u64,
    count_words: u64,
    /// Of these, what each reducer asks to be counted.
    counted: Vec<usize>,
    words: usize,
    most_rows: u64,
    /// Survivors that come back with a tile's counts.
    trip: u64,
}

impl<'p> GpuEngine<'p> {
    /// An engine for a plan. `ranges`: of the study's histograms. `limited_loops`: does the driver end long loops?
    ///
    /// # Errors
    /// [`Error::NotOnDevice`](crate::error::Error::NotOnDevice) if the study cannot be screened on a device,
    /// [`Error::Gpu`](crate::error::Error::Gpu) if the device fails.
    pub fn new(plan: &'p Plan, ranges: &[(f64, f64)], device: &Device, limited_loops: bool, wrong: &Wrong) -> Result<Self> {
        supports_report(plan)?;
        // Sorted lanes and scenarios stand in a ninth storage buffer; WebGPU promises eight.
        let has_room = device.limits.max_storage_buffers_per_shader_stage > 8;
        let extras = Extras { axis: device.is_hardware || wrong.is_grouped(), order: has_room, scenarios: has_room };
        let (layout, sorted_lanes) = KernelLayout::with_lanes(plan, limited_loops, wrong.is_grouped(), extras)?;
        supports_histograms(plan, ranges)?;
        let source = wrong.text(kernel_text(plan, &layout, ranges, device.has_f64(), &wrong.perturb));
        let program = if wrong.keeps_text() {
            // SAFETY: the text is ours; what a study adds are formulas of numbers, without an index or a loop that ours do not have. Each
            // index is compared with the length of its array, or cut to it, or comes from a buffer that only this engine and its kernel
            // write, with what is below that length, or is a count of what the array has room for. Where no run is open, the pass that
            // reads the last one has no workgroups. Where a group of lanes reads beyond the last lane, its buffer is longer by a group
            // less one. Loops count up or down between numbers that are known when they begin, halve a range, or clear bits. Integers are
            // divided by constants that are not zero, and by a number of groups, of which there is at least one.
            #[allow(unsafe_code, reason = "wgpu has no other way to leave its checks out")]
            unsafe {
                Program::without_checks(device, &source, &entries(&layout))?
            }
        } else {
            Program::new(device, &source, &entries(&layout))?
        };
        program.require_structure("Tile", size_of::<Tile>(), &Tile::MEMBERS)?;
        program.require_structure("KnownUniform", size_of::<KnownUniform>(), &KnownUniform::MEMBERS)?;
        let coordinates = coordinates(plan, &layout);
        let storage = wgpu::BufferUsages::STORAGE;
        let binding = device.limits.max_storage_buffer_binding_size.min(device.limits.max_buffer_size);

        // The window holds the levels of the outermost dimension that a tile's rows can touch.
        let inner: u64 = layout.slow.iter().skip(1).map(|it| it.count).product();
        let row_words = 3 + plan.study.report.maps.len() as u64 + 2 * (plan.tracked.len() + layout.row_inputs.len()) as u64;
        let row_words = row_words + u64::from(layout.sorted.is_some());
        let row_scenarios = layout.tells_scenarios.then(|| RowScenarios::new(plan));
        let scenario_words = if row_scenarios.is_some() { RowScenarios::words(plan, 1) } else { 0 };
        let row_bytes = layout.prepared_bytes().max(4 * row_words).max(4 * scenario_words);
        let outermost = layout.slow.first().map_or(1, |it| it.count);
        let columns = layout.slow.first().map_or(1, |it| it.inputs.len()) as u64;
        let level_rows = (PREPARED_BYTES.min(binding / 2) / 16).saturating_sub(layout.levels.len() as u64) / columns;
        let most_rows = (PREPARED_BYTES.min(binding / 2) / row_bytes).min(level_rows.saturating_sub(2).max(1).saturating_mul(inner));
        let most_rows = most_rows.clamp(1, 1 << 21).min(plan.slow.count());
        let window_room = (most_rows / inner.max(1) + 2).min(outermost);
        let levels = device.buffer("levels", (layout.levels.len() as u64 + window_room * columns) * 16, storage);
        device.write(&levels, 0, &layout.levels);

        let cells_of = |spec: &crate::study::MapSpec| plan.study.design[spec.x].count() * plan.study.design[spec.y].count();
        let counted = Reported::new(plan, ranges).count_words();
        let count_words = (FIRST_REPORTED as usize + counted.iter().sum::<usize>()) as u64;
        let value_cells: u64 = plan.study.report.maps.iter().filter(|it| it.value != Best::Share).map(cells_of).sum();
        if count_words.max(value_cells) * 4 > binding {
            return Err(device.error("the maps of this study are larger than a buffer of this device; use --engine cpu"));
        }
        let words = survivor_words(plan).max(check_words(plan));
        let capacity = wrong.capacity().min(binding / (4 * words as u64));

        let steady: &[Level] = if layout.steady.is_empty() { &[[0.0; 4]] } else { &layout.steady };
        let steady = if layout.steady_is_uniform() { device.uniform("steady", steady) } else { device.storage("steady", steady) };
        let prepared = device.buffer("prepared", most_rows * layout.prepared_bytes(), storage);
        let open_room =
            |runs: Runs| wrong.open_runs().min(most_rows * runs.of_row * runs.parts()).min((binding / 4 - most_rows * row_words) / 2);
        let open_room = layout.runs.map_or(0, open_room);
        let rows = device.buffer("rows", 4 * (most_rows * row_words + 2 * open_room), storage);
        let groups = device.buffer("groups", 24, wgpu::BufferUsages::INDIRECT);
        let cells = device.buffer("cells", value_cells * 4, storage);
        let scenario_words = if row_scenarios.is_some() { RowScenarios::words(plan, most_rows) } else { 0 };
        let decisive = device.buffer("decisive", 4 * scenario_words, storage);
        let sorted_lanes = device.storage("sorted_lanes", &sorted_lanes);
        let zeros = device.storage("zeros", &vec![0u32; count_words as usize]);
        let list = known::room(&coordinates);
        let slots = (0..2).map(|_| {
            let tile = device.buffer("tile", size_of::<Tile>() as u64, wgpu::BufferUsages::UNIFORM);
            let known = device.buffer("known", size_of::<KnownUniform>() as u64, wgpu::BufferUsages::UNIFORM);
            let dominator_table = device.buffer("dominator_table", list * 4, storage);
            let counts = device.buffer("counts", count_words * 4, storage);
            let survivors = device.buffer("survivors", capacity * words as u64 * 4, storage);
            let landing = count_words * 4 + capacity * survivor_words(plan) as u64 * 4;
            let landing = device.landing("landing", landing.min(device.limits.max_buffer_size / 16 * 16));
            let bound = program.bind(&[
                ("tile", &tile),
                ("known", &known),
                ("steady", &steady),
                ("levels", &levels),
                ("prepared_table", &prepared),
                ("row_table", &rows),
                ("counts", &counts),
                ("survivors", &survivors),
                ("dominator_table", &dominator_table),
                ("cells", &cells),
                ("sorted_lanes", &sorted_lanes),
                ("decisive", &decisive),
            ]);
            Slot { tile, known, dominator_table, counts, survivors, landing, bound }
        });
        let slots = slots.collect();
        device.check()?;
        Ok(Self {
            plan,
            layout,
            coordinates,
            device: device.clone(),
            program,
            levels,
            zeros,
            cells,
            open_room,
            groups,
            row_scenarios,
            decisive,
            slots,
            next: 0,
            window: 0..0,
            window_room,
            count_words,
            counted,
            words,
            most_rows,
            trip: LEAST_TRIP,
        })
    }

    /// From now on rows are told which scenarios decide about their designs, where so many threads find that out.
    pub fn look_for_scenarios(&mut self, tables: &'p Tables, threads: usize) {
        if let Some(scenarios) = &mut self.row_scenarios {
            scenarios.set_hosts(self.plan, tables, threads);
        }
    }

    /// Designs of a first dispatch, of whose speed nothing is known yet: it must not look hung.
    pub fn at_once(&self) -> u64 {
        (FIRST_EVALUATIONS / self.plan.evaluations()).max(1)
    }

    /// The longest tile that starts at `range.start`, lies within `range` and has about `designs` designs.
    pub fn tile(&self, range: &Range<u64>, designs: u64) -> Range<u64> {
        let width = self.plan.fast.count();
        let widest = self.layout.widest();
        let wanted = designs.clamp(1, MOST_DESIGNS).min(range.end - range.start);
        let inside = range.start % width;
        if inside != 0 || wanted < width || width > widest {
            // Part of one row.
            return range.start..range.start + wanted.min(width - inside).min(widest);
        }
        let rows = (wanted / width).min(self.most_rows).min(self.layout.most_rows());
        range.start..range.start + rows * width
    }

    /// Tells the device the best keys of the maps' cells.
    pub fn tell_cells(&mut self, answers: &Answers) {
        self.device.write(&self.cells, 0, &known::cells(self.plan, answers));
    }

    /// Starts a tile, as [`GpuEngine::tile`] cuts them. There may be two at a time.
    pub fn start(&mut self, range: Range<u64>, answers: &Answers) -> InFlight {
        let slot = self.next;
        self.next = (self.next + 1) % self.slots.len();
        let exact = |quantity| matches!(quantity, Quantity::Input(input) if kernel::is_exact(self.plan, &self.layout, input));
        let (known, dominator_table) = known::known(self.plan, &self.coordinates, exact, answers);
        self.device.write(&self.slots[slot].known, 0, &[known]);
        self.device.write(&self.slots[slot].dominator_table, 0, &dominator_table);
        let (rows, groups) = self.place(slot, &range);
        let it = &self.slots[slot];
        let counts = self.count_words * 4;
        let trip = self.trip * survivor_words(self.plan) as u64 * 4;
        let trip = trip.min(it.landing.size() - counts).min(it.survivors.size()) / 4 * 4;
        let wait = self.device.submit(|encoder| {
            encoder.copy_buffer_to_buffer(&self.zeros, 0, &it.counts, 0, counts);
            self.first_stage(encoder, it, &rows);
            if self.layout.runs.is_some() {
                self.program.dispatch(encoder, "judge_runs", &it.bound, groups);
                for (pass, entry) in (0..).zip(["judge_parts", "sweep"]) {
                    let at = 12 * pass;
                    self.program.dispatch(encoder, "count_groups", &it.bound, [1, 1]);
                    encoder.copy_buffer_to_buffer(&it.counts, u64::from(GROUPS) * 4 + at, &self.groups, at, 12);
                    self.program.dispatch_counted(encoder, entry, &it.bound, (&self.groups, at));
                }
            } else {
                self.program.dispatch(encoder, "sweep", &it.bound, groups);
            }
            encoder.copy_buffer_to_buffer(&it.counts, 0, &it.landing, 0, counts);
            encoder.copy_buffer_to_buffer(&it.survivors, 0, &it.landing, counts, trip);
        });
        InFlight { range, rows, slot, words: ((counts + trip) / 4) as usize, wait }
    }

    fn first_stage(&self, encoder: &mut wgpu::CommandEncoder, slot: &Slot, rows: &Range<u64>) {
        let groups = ((rows.end - rows.start) as u32).div_ceil(WORKGROUP);
        self.program.dispatch(encoder, "prepare_rows", &slot.bound, [groups, self.layout.slow_scenarios.count as u32]);
        self.program.dispatch(encoder, "judge_rows", &slot.bound, [groups, 1]);
    }

    /// Writes a slot's tile; returns its rows and the workgroups of its second stage.
    fn place(&mut self, slot: usize, range: &Range<u64>) -> (Range<u64>, [u32; 2]) {
        let width = self.plan.fast.count();
        let rows = range.start / width..range.end.div_ceil(width);
        let lanes = range.start % width..if rows.end - rows.start == 1 { (range.end - 1) % width + 1 } else { width };
        let digits = self.plan.slow.digits(rows.start);
        let mut tile = Tile::zeroed();
        tile.rows = (rows.end - rows.start) as u32;
        (tile.first_lane, tile.last_lane) = (lanes.start as u32, lanes.end as u32);
        tile.open_room = self.open_room as u32;
        tile.capacity = (self.slots[slot].survivors.size() / (4 * survivor_words(self.plan) as u64)) as u32;
        if let Some(&outermost) = digits.first() {
            let last = self.plan.slow.digits(rows.end - 1)[0];
            self.move_window(outermost, last);
            for (to, &digit) in tile.digits.iter_mut().zip(&digits) {
                *to = digit as u32;
            }
            tile.digits[0] = (outermost - self.window.start) as u32;
            let index = self.window.start.wrapping_mul(self.layout.slow[0].stride);
            tile.index = [index as u32, (index >> 32) as u32];
            tile.window = self.window.start as u32;
        }
        self.device.write(&self.slots[slot].tile, 0, &[tile]);
        if let Some(scenarios) = &mut self.row_scenarios {
            self.device.write(&self.decisive, 0, &scenarios.of_rows(rows.clone()));
        }
        let groups = self.layout.groups(rows.end - rows.start, lanes.end - lanes.start);
        (rows, groups)
    }

    /// Makes the levels `first..=last` of the outermost slow dimension part of the window.
    fn move_window(&mut self, first: u64, last: u64) {
        if self.window.contains(&first) && self.window.contains(&last) {
            return;
        }
        let dimensions: Vec<_> = self.plan.slow.dimensions().collect();
        let dimension = dimensions[0].0;
        self.window = first..(first + self.window_room).min(dimension.count());
        let mut entries = Vec::new();
        self.window.clone().for_each(|level| push_level(self.plan, dimension, level, &mut entries));
        self.device.write(&self.levels, self.layout.levels.len() as u64 * 16, &entries);
    }

    /// Waits for a tile. `None` if it had more survivors, open runs or open parts than there is room for: it must be repeated in parts.
    ///
    /// # Errors
    /// [`Error::Gpu`](crate::error::Error::Gpu).
    pub fn finish(&mut self, tile: &InFlight) -> Result<Option<(TileCounts, Survivors)>> {
        let slot = &self.slots[tile.slot];
        let words = survivor_words(self.plan);
        let counted = self.count_words as usize;
        // Of what came back at once only the survivors that there are get copied.
        let used = |landed: &[u32]| landed.len().min(counted + words * landed[APPENDED as usize] as usize);
        let mut landed: Vec<u32> = self.device.read_some(&slot.landing, tile.words, &tile.wait, used)?;
        let first_trip = landed.split_off(counted);
        let counts = landed;
        let appended = counts[APPENDED as usize] as usize;
        self.trip = (2 * appended as u64).max(LEAST_TRIP);
        let open = counts[OPEN as usize].max(counts[OPEN_PARTS as usize]);
        if appended as u64 > slot.survivors.size() / (4 * words as u64) || u64::from(open) > self.open_room {
            return Ok(None);
        }
        let records =
            if appended * words <= first_trip.len() { first_trip } else { self.device.fetch(&slot.survivors, appended * words)? };
        let mut rest = &counts[FIRST_REPORTED as usize..];
        let mut take = |count: usize| {
            let (taken, left) = rest.split_at(count);
            rest = left;
            taken.to_vec()
        };
        let reported = self.counted.iter().map(|&words| take(words)).collect();
        let designs = tile.range.end - tile.range.start;
        let (open_runs, singly) = match self.layout.runs {
            Some(runs) => (if runs.parts() > 1 { counts[OPEN as usize].into() } else { 0 }, counts[SINGLY as usize].into()),
            None => (0, designs),
        };
        let (sure, unsure) = (counts[SURE as usize].into(), counts[UNDECIDED as usize].into());
        let counts = TileCounts { sure, unsure, open_runs, singly, reported };
        let (width, objectives) = (self.plan.fast.count(), self.plan.study.objectives.len());
        Ok(Some((counts, Survivors { records, words, first_row: tile.rows.start, width, objectives })))
    }

    /// Everything that the device says of the designs of a tile, in order.
    ///
    /// # Errors
    /// [`Error::Gpu`](crate::error::Error::Gpu).
    pub fn check(&mut self, range: &Range<u64>) -> Result<Vec<Checked>> {
        let mut records = Vec::new();
        let mut rest = range.clone();
        let room = self.slots[0].survivors.size() / (4 * self.words as u64);
        while !rest.is_empty() {
            let part = self.tile(&rest, room.min(MOST_GROUPS * u64::from(WORKGROUP)).min(self.at_once()));
            let (rows, _) = self.place(0, &part);
            let slot = &self.slots[0];
            let designs = part.end - part.start;
            let wait = self.device.submit(|encoder| {
                self.first_stage(encoder, slot, &rows);
                let lanes = if self.layout.sorted.is_some() { self.plan.fast.count() } else { designs / (rows.end - rows.start) };
                let groups = (rows.end - rows.start) * lanes.div_ceil(self.layout.cut.group);
                self.program.dispatch(encoder, "check", &slot.bound, [groups.div_ceil(WORKGROUP.into()) as u32, 1]);
            });
            self.device.wait(&wait)?;
            let words = check_words(self.plan);
            let values: Vec<u32> = self.device.fetch(&slot.survivors, designs as usize * words)?;
            records.extend(values.chunks(words).enumerate().map(|(at, record)| self.checked(&part, at as u64, record)));
            rest.start = part.end;
        }
        Ok(records)
    }

    fn checked(&self, part: &Range<u64>, at: u64, record: &[u32]) -> Checked {
        let width = self.plan.fast.count();
        let first_row = part.start / width;
        let position = part.start + at;
        let (row, lane) = ((position / width - first_row) as u32, (position % width) as u32);
        let (slow, fast) = (self.layout.slow_scenarios.count as u32, self.layout.fast_scenarios.count as u32);
        let scenario = row.wrapping_mul(SCENARIO_PER_ROW).wrapping_add(lane.wrapping_mul(SCENARIO_PER_LANE)) % slow.wrapping_mul(fast);
        let number = |pair: &[u32]| RunningError { value: f32::from_bits(pair[0]), bound: f64::from(f32::from_bits(pair[1])) };
        let mut numbers = record[1..].chunks(2).map(number);
        let worst = numbers.by_ref().take(self.plan.tracked.len()).collect();
        let verdict = match record[0] {
            YES => Decision::Yes,
            UNSURE => Decision::Unsure,
            _ => Decision::No,
        };
        Checked { verdict, worst, asked: numbers.collect(), scenario: (u64::from(scenario / fast), u64::from(scenario % fast)) }
    }

    /// Does it judge stretches of a row that stand anywhere in it? Then it is whole rows that say how it does.
    pub fn judges_rows(&self) -> bool {
        self.layout.sorted.is_some()
    }

    /// The used outputs, in the order of [`Checked::asked`].
    pub fn used_outputs(&self) -> Vec<usize> {
        self.plan.used_outputs().iter().collect()
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }
}

/// Can a study be screened on a device?
///
/// # Errors
/// [`Error::NotOnDevice`](crate::error::Error::NotOnDevice) that says why not.
pub fn supports(plan: &Plan, limited_loops: bool) -> Result<()> {
    let given = plan.study.report.histograms.iter().map(|it| it.range.unwrap_or((0.0, 1.0))).collect::<Vec<_>>();
    supports_report(plan)?;
    supports_histograms(plan, &given)?;
    KernelLayout::new(plan, limited_loops, false, Extras::ALL).map(|_| ())
}

/// Does the study ask for nothing but worst values, counts and candidates?
fn supports_report(plan: &Plan) -> Result<()> {
    if plan.study.decides_by_spectrum() {
        return Err(refuse("it asks for a mean or sum over the cases of a spectrum, and these are added up on the CPU".to_owned()));
    }
    let beyond = Reported::needs(&plan.study.report).into_iter().find_map(ReducerNeeds::beyond_devices);
    beyond.map_or(Ok(()), |why| Err(refuse(why.to_owned())))
}

/// Can a device count in the bins of a study's histograms, given their ranges?
///
/// # Errors
/// [`Error::NotOnDevice`](crate::error::Error::NotOnDevice) that says why not.
pub fn supports_histograms(plan: &Plan, ranges: &[(f64, f64)]) -> Result<()> {
    histogram_beyond_f32(plan, ranges).map_or(Ok(()), |why| Err(refuse(why)))
}

/// The kernel that a study is screened with, as it would be on a software driver that ends long loops; in its first line, how many operations
/// its designs take.
///
/// # Errors
/// [`Error::NotOnDevice`](crate::error::Error::NotOnDevice) if the study cannot be screened on a device.
pub fn kernel_of(plan: &Plan, ranges: &[(f64, f64)], perturb: &[(usize, f64)]) -> Result<String> {
    supports_report(plan)?;
    supports_histograms(plan, ranges)?;
    let (layout, _) = KernelLayout::with_lanes(plan, true, false, Extras { axis: false, ..Extras::ALL })?;
    let text = kernel_text(plan, &layout, ranges, false, perturb);
    Ok(kernel::operations_line(&layout, &text) + &text)
}

fn kernel_text(plan: &Plan, layout: &KernelLayout, ranges: &[(f64, f64)], f64: bool, perturb: &[(usize, f64)]) -> String {
    kernel::histogram_constants(plan, ranges) + &text(plan, layout, f64, perturb)
}
