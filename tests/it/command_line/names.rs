//! No table of a result has two columns of one name.

use super::feasible::parquet;
use super::{ask, folder_with, read, write};
use std::collections::HashSet;
use std::path::Path;

/// A study in which one quantity is all that it can be: axis, objective, constraint, column, map and its axis, and what formulas give.
const EVERYTHING: &str = r#"model = "metal-cvt"
[design]
band_count = [6, 8, 10, 12]
band_thickness_mm = { from = 0.1, to = 0.3, count = 9 }
cases = [{ groove_angle_deg = 20, steel = 1 }, { groove_angle_deg = 24, steel = 1.2 }]
[operation]
torque_Nm = [50, 100]
[uncertainty]
friction = [0.08, 0.1]
[formulas]
cost = "band_count * band_thickness_mm * steel / 1[mm]"
[constraints]
band_count = { min = 6, max = 11 }
groove_angle_deg = { max = 25 }
steel = { max = 2 }
stress_margin = { min = 0, max = 0.9 }
torque_Nm = { max = 200 }
cost = { max = 100 }
[objectives]
band_count = "min"
steel = "min"
band_thickness_mm = "max"
stress_margin = "max"
cost = "min"
friction = "max"
[report]
columns = ["slip_margin", "torque_Nm", "stress_margin", "cost"]
top = { by = "band_count", goal = "min", count = 5 }
histograms = [{ of = "band_count", bins = 3 }, { of = "band_count", bins = 4 }]
maps = [
    { x = "band_count", y = "band_thickness_mm", value = "band_count" },
    { x = "band_thickness_mm", y = "band_count", value = "cost" },
    { x = "band_thickness_mm", y = "band_count", best = "share" },
]
sample = 20
variants = true
feasible = true
"#;

/// The columns of a table.
fn columns(path: &Path) -> Vec<String> {
    if path.extension().is_some_and(|it| it == "parquet") {
        return parquet(path).0;
    }
    read(path).lines().next().expect("a table has a header").split(',').map(str::to_owned).collect()
}

/// The first name that two columns have.
fn doubled(columns: &[String]) -> Option<&String> {
    let mut known = HashSet::new();
    columns.iter().find(|name| !known.insert(*name))
}

/// Looks at all tables of a folder; returns how many there are.
fn require_unique(folder: &Path) -> usize {
    let tables = folder.read_dir().expect("there is a result").map(|entry| entry.expect("it can be listed").path());
    let tables: Vec<_> = tables.filter(|path| path.extension().is_some_and(|it| it == "csv" || it == "parquet")).collect();
    for path in &tables {
        let columns = columns(path);
        assert_eq!(doubled(&columns), None, "{}: {columns:?}", path.display());
    }
    tables.len()
}

#[test]
fn every_table_has_every_name_once() {
    let folder = folder_with("study.toml", EVERYTHING);
    let at = folder.path();
    ask(at, "sweep study.toml --out r").text();
    // Scenarios, front, top, sample, variants, feasible, two histograms, three maps: those of designs also as Parquet.
    assert_eq!(require_unique(&at.join("r")), 13);
    // The axis stands where axes stand, in all its roles.
    let header = columns(&at.join("r/front.csv"));
    assert_eq!(&header[..6], ["design_index", "band_count", "band_thickness_mm", "groove_angle_deg", "steel", "stress_margin"]);
    assert!(!header.iter().any(|name| name == "band_count_scenario"), "an axis is the same in all scenarios");
    assert_eq!(columns(&at.join("r/map-band_count.csv")), ["band_count", "band_thickness_mm", "band_count_value", "design_index"]);
    let file = std::fs::File::open(at.join("r/front.parquet")).expect("it is there");
    let reader = parquet::file::reader::SerializedFileReader::new(file).expect("it is Parquet");
    let about = parquet::file::reader::FileReader::metadata(&reader).file_metadata().key_value_metadata().expect("columns are described");
    let told = |key: &str| about.iter().find(|it| it.key == key).and_then(|it| it.value.clone());
    assert_eq!(told("band_count.role").as_deref(), Some("design, objective, constraint"));
    assert_eq!(told("band_count.direction").as_deref(), Some("min, at least 6 and at most 11"));
    ask(at, "report r").text();
    // Rows that were evaluated one by one.
    write(at, "rows.csv", "band_count,band_thickness_mm,groove_angle_deg,steel,torque_Nm\n6,0.1,20,1,50\n");
    write(at, "designs.csv", "band_count,band_thickness_mm,groove_angle_deg,steel\n6,0.1,20,1\n");
    for (target, rows, out) in
        [("metal-cvt", "model.csv", "a.csv"), ("study.toml", "designs.csv", "b.csv"), ("study.toml", "designs.csv", "c.parquet")]
    {
        write(at, "model.csv", "band_count,torque_Nm\n6,50\n");
        ask(at, &format!("eval {target} --table {rows} --out {out}")).text();
        assert_eq!(doubled(&columns(&at.join(out))), None, "{out}");
    }
}

#[test]
fn the_committed_results_have_every_name_once() {
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/studies");
    let all = studies.read_dir().expect("there are results").map(|entry| entry.expect("it can be listed").path());
    let tables: usize = all.filter(|path| path.is_dir()).map(|path| require_unique(&path)).sum();
    assert!(tables > 30, "{tables}");
}

#[test]
fn the_comparison_sees_a_doubled_name() {
    let folder = folder_with("x.csv", "design_index,mass_g,mass_g\n1,2,3\n");
    assert_eq!(doubled(&columns(&folder.path().join("x.csv"))).map(String::as_str), Some("mass_g"));
}
