//! Screening on a GPU. Without any device these tests fail: `tests/run` installs a software one.

mod accuracy;
mod bites;
mod commands;
mod draws;
mod engines;
mod hardware;
mod predicted;
mod rooted;
mod tolerances;

use beltspace::gpu::{Adapter, adapters, self_test};
use beltspace::plan::Plan;
use beltspace::reduce::{Reduction, State};
use beltspace::screen::gpu::Wrong;
use beltspace::screen::{Tables, Tally};
use beltspace::study::Study;
use beltspace::sweep::{Control, DeviceRecord, OnDevice, Settings, sweep, sweep_on_device};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The device of all tests: a software one if there is one, which every machine can have, else the best.
pub fn device() -> &'static OnDevice {
    static DEVICE: OnceLock<OnDevice> = OnceLock::new();
    DEVICE.get_or_init(open)
}

/// The same adapter, opened once more: for tests that lose it.
fn open() -> OnDevice {
    let adapters = adapters();
    opened(adapters.last().expect("there is no GPU driver: tests/run installs lavapipe (Debian package mesa-vulkan-drivers)"))
}

fn opened(adapter: &Adapter) -> OnDevice {
    let device = adapter.open().expect("the adapter opens");
    let report = self_test::run(&device).expect("the self-test runs");
    assert_eq!(report.problems(), Vec::<String>::new(), "{}", adapter.in_words());
    OnDevice { limited_loops: report.limited_loops(), device, wrong: Wrong::default() }
}

/// The device, with an error in the kernel.
pub fn wrong(wrong: Wrong) -> OnDevice {
    OnDevice { wrong, ..device().clone() }
}

/// A study with its plan and what its sweeps need.
pub struct Prepared {
    pub plan: Plan,
    pub tables: Tables,
    pub reduction: Reduction,
}

impl Prepared {
    pub fn new(study: Study) -> Self {
        let plan = Plan::new(study);
        let tables = Tables::new(&plan);
        let ranges = Tally::new(&plan, &tables, 2).histogram_ranges(&plan);
        let reduction = Reduction::new(&plan, &ranges);
        Self { plan, tables, reduction }
    }

    fn parse(text: &str) -> Self {
        Self::new(Study::parse_in(text, "test.toml", Path::new(".")).unwrap_or_else(|errors| panic!("{errors}")))
    }

    pub fn on(&self, device: &OnDevice) -> beltspace::error::Result<(State, DeviceRecord)> {
        let options = Settings { threads: 2, ..Settings::default() };
        let (swept, record) = sweep_on_device(&self.plan, &self.tables, &self.reduction, &options, None, &Control::default(), device)?;
        Ok((swept.state, record))
    }

    fn on_cpu(&self) -> State {
        let swept = sweep(&self.plan, &self.tables, &self.reduction, &Settings::default(), None, &Control::default());
        swept.expect("the sweep ends").state
    }
}

/// Do two states lead to the same files? In a map of values only the best of each cell is reported.
fn assert_same(a: &State, b: &State, what: &str) {
    assert_eq!(a.feasible, b.feasible, "{what}: feasible");
    assert_eq!(a.front, b.front, "{what}: front");
    assert_eq!(a.extremes, b.extremes, "{what}: extremes");
    assert_eq!(a.reported.histograms, b.reported.histograms, "{what}: histograms");
    let best = |state: &State| state.reported.top.first().map(beltspace::reduce::Top::indices);
    assert_eq!(best(a), best(b), "{what}: top list");
    assert_eq!(a.reported.samples, b.reported.samples, "{what}: sample");
    for (a, b) in a.reported.maps.iter().zip(&b.reported.maps) {
        let (width, height) = a.size();
        for at in 0..width * height {
            let value = |map: &beltspace::reduce::Map| map.cell(at).map(|cell| map.value(cell).to_bits());
            assert_eq!(value(a), value(b), "{what}: cell {at} of a map");
        }
    }
}

/// The studies that come with the program.
fn all_shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    let mut paths: Vec<_> = std::fs::read_dir(folder).expect("studies are shipped").map(|it| it.expect("it is listed").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|it| it == "toml"));
    paths.sort();
    paths
}

/// Those that a device does not serve, each with what the program says of it.
const NOT_ON_A_DEVICE: [(&str, &str); 5] = [
    ("pulley-design", "pulley is computed in f64 on the CPU only"),
    ("pulley-thickness", "pulley is computed in f64 on the CPU only"),
    ("pulley-types", "pulley is computed in f64 on the CPU only"),
    // On a driver that does not end long loops it is served.
    (LONG_LOOPS, "loop iterations over its scenarios are more than"),
    ("timing-tension", "peak_tooth_load_N_draw_q99 is a quantile over the draws, which the CPU computes"),
];

/// The shipped study whose draws take more loop iterations than some drivers give.
const LONG_LOOPS: &str = "push-belt-yield";

/// The studies that come with the program, but for those.
fn shipped() -> Vec<PathBuf> {
    let mut paths = all_shipped();
    paths.retain(|path| NOT_ON_A_DEVICE.iter().all(|it| path.file_stem().is_none_or(|stem| stem != it.0)));
    assert!(paths.len() >= 4 && paths.iter().all(|path| Study::read(path).expect("a shipped study is right").0.model.on_gpu));
    paths
}

/// The first of the small studies on a finer grid: several tiles, of which only some designs are compared with f64.
fn larger() -> String {
    SMALL[0].replace("count = 13 }", "count = 97 }").replace("count = 21 }", "count = 101 }")
}

/// A study whose rows have one order, and an axis of many levels that nothing asks for by itself: its designs can be judged in runs.
const RUNS: &str = r#"model = "metal-cvt"
[design]
friction = { from = 0.06, to = 0.12, count = 9 }
groove_angle_deg = { from = 18, to = 30, count = 7 }
ratio = { from = 0.5, to = 2.0, count = 11 }
band_thickness_mm = { from = 0.1, to = 0.4, count = 150 }
band_count = { from = 4, to = 14 }
[fixed]
traction = "limit"
[constraints]
capacity_axial_force_N = { max = 30000 }
torque_capacity_Nm = { above = 0 }
[objectives]
torque_capacity_Nm = "max"
capacity_axial_force_N = "min"
"#;

/// The same with rows longer than a first tile: tiles begin and end within a row, and within runs.
fn long_runs() -> String {
    let fewer = |text: String, axis: &str, other: &str| {
        assert!(text.contains(axis), "{axis}");
        text.replace(axis, other)
    };
    let text = fewer(RUNS.to_owned(), "to = 0.12, count = 9 }", "to = 0.12, count = 2 }");
    let text = fewer(text, "to = 30, count = 7 }", "to = 30, count = 2 }");
    let text = fewer(text, "to = 2.0, count = 11 }", "to = 2.0, count = 3 }");
    fewer(text, "count = 150 }", "count = 9001 }")
}

/// The same study where runs lie along the long axis: over scenarios rows have no order.
fn along_axis(text: &str) -> String {
    assert!(text.contains("[fixed]\n"), "{text}");
    text.replace("[fixed]\n", "[operation]\nstrength_MPa = [480, 500]\n[fixed]\n")
}

/// One study per model with all that a report may have, small enough to be swept in a moment.
const SMALL: [&str; 4] = [
    r#"model = "metal-cvt"
[design]
groove_angle_deg = { from = 18, to = 30, count = 13 }
band_thickness_mm = { from = 0.10, to = 0.30, count = 21 }
band_count = { from = 6, to = 14 }
traction = { from = 0.30, to = 0.50, count = 11 }
[operation]
ratio = { from = 0.5, to = 2.0, count = 3, spacing = "log" }
torque_Nm = [50, 150]
[uncertainty]
friction = [0.065, 0.095]
[fixed]
strength_MPa = 800
[constraints]
slip_margin = { min = 0 }
stress_margin = { min = 0 }
[objectives]
axial_force_N = "min"
stress_margin = "max"
band_count = "min"
[report]
top = { by = "axial_force_N", count = 20 }
sample = { count = 500, seed = 11 }
histograms = [{ of = "axial_force_N", bins = 40 }]
maps = [
    { x = "band_thickness_mm", y = "groove_angle_deg", value = "axial_force_N" },
    { x = "band_thickness_mm", y = "band_count", best = "share" },
]
"#,
    r#"model = "rubber-cvt"
[design]
groove_angle_deg = { from = 24, to = 34, count = 9 }
belt_width_mm = { from = 20, to = 50, count = 16 }
belt_thickness_mm = { from = 2, to = 20, count = 31 }
[operation]
cases = [{ ratio = 2.0, torque_Nm = 60 }, { ratio = 0.5, torque_Nm = 30 }]
[uncertainty]
friction = [0.35, 0.45]
[constraints]
torque_capacity_Nm = { min = 20 }
[objectives]
torque_capacity_Nm = "max"
capacity_axial_force_N = "min"
[report]
top = { by = "stress_margin", count = 7 }
histograms = [{ of = "torque_capacity_Nm", bins = 30 }]
"#,
    r#"model = "timing-belt"
[design]
friction = { from = 0.3, to = 0.55, count = 3 }
teeth_in_mesh = { from = 18, to = 24 }
tight_tension_N = { from = 100, to = 600, count = 26 }
slack_tension_N = { from = 0, to = 60, count = 4 }
[operation]
pulley_speed_rpm = [2000, 4000]
[uncertainty]
pitch_mass_g = [0.38, 0.42]
[constraints]
boundary_tooth = { min = 16 }
[objectives]
tight_tension_N = "min"
boundary_tooth = "max"
peak_tooth_load_N = "min"
[report]
top = { by = "lift_speed_rpm", count = 9 }
histograms = [{ of = "boundary_tooth", from = 0.5, to = 25.5, bins = 25 }]
maps = [{ x = "tight_tension_N", y = "teeth_in_mesh", value = "boundary_position", best = "max" }]
"#,
    r#"model = "pulley-load"
[sample]
method = "sobol"
count = 20000
seed = 3
[design]
mean_radius_mm = { from = 40, to = 80 }
slack_tension_N = { from = 100, to = 900 }
groove_angle_deg = { from = 34, to = 38 }
[operation]
cases = [{ power_kW = 3.0, speed_rpm = 3000 }, { power_kW = 4.0, speed_rpm = 6500 }]
[constraints]
friction_margin = { min = 0 }
[objectives]
resultant_force_N = "min"
mean_radius_mm = "min"
tight_end_flank_force_N_per_mm = "min"
"#,
];
