//! The catalogues that come with the program: every row has its source, and values that a typing slip changed are found.
//!
//! A slip is found because tables of a trade hang together: a dimension goes smoothly with another one, values are printed in two units or
//! fulfil an equation, rows repeat. [`flaws`] knows these ties for every file, and `a_changed_digit_is_found` counts how many slips they find.

use beltspace::Study;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("catalogues")
}

/// A catalogue as text.
#[derive(Clone)]
struct Catalogue {
    name: String,
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Catalogue {
    fn read(path: &Path) -> Self {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).expect("it can be read");
        let header = reader.headers().expect("it has a header").iter().map(str::to_owned).collect();
        let rows = reader.records().map(|row| row.expect("rows are as long as the header").iter().map(str::to_owned).collect());
        Self { name: path.file_name().expect("a file").to_string_lossy().into_owned(), header, rows: rows.collect() }
    }

    fn column(&self, name: &str) -> usize {
        self.header.iter().position(|it| it == name).unwrap_or_else(|| panic!("{} has no column {name}", self.name))
    }

    fn number(&self, row: usize, name: &str) -> f64 {
        let cell = &self.rows[row][self.column(name)];
        cell.parse().unwrap_or_else(|_| panic!("{}: {name} is {cell}", self.name))
    }

    /// Half a unit of the last digit that is printed.
    fn half_unit(&self, row: usize, name: &str) -> f64 {
        let decimals = self.rows[row][self.column(name)].split_once('.').map_or(0, |(_, decimals)| decimals.len());
        0.5 * 10f64.powi(-i32::try_from(decimals).expect("a few digits"))
    }

    /// Are all cells of a column numbers?
    fn is_numeric(&self, column: usize) -> bool {
        self.rows.iter().all(|row| row[column].parse::<f64>().is_ok())
    }
}

/// All catalogues, by name.
fn catalogues() -> Vec<Catalogue> {
    let files = std::fs::read_dir(folder()).expect("catalogues are shipped").map(|entry| entry.expect("a file").path());
    let mut all: Vec<_> = files.filter(|path| path.extension().is_some_and(|it| it == "csv")).map(|path| Catalogue::read(&path)).collect();
    all.sort_by(|a, b| a.name.cmp(&b.name));
    all
}

/// The flaws of a catalogue.
struct Flaws<'c> {
    of: &'c Catalogue,
    found: Vec<String>,
}

impl Flaws<'_> {
    fn require(&mut self, row: usize, holds: bool, what: &str) {
        if !holds {
            self.found.push(format!("{}, row {}: {what}", self.of.name, row + 1));
        }
    }

    /// Two values that must be equal but for so much.
    fn equal(&mut self, row: usize, value: f64, expected: f64, within: f64, what: &str) {
        self.require(row, (value - expected).abs() <= within, &format!("{what}: {value} where {expected} is expected"));
    }

    /// Rows in runs of one text in this column.
    fn runs(&self, column: &str) -> Vec<Vec<usize>> {
        let column = self.of.column(column);
        let mut runs: Vec<Vec<usize>> = Vec::new();
        for (row, cells) in self.of.rows.iter().enumerate() {
            match runs.last_mut().filter(|run| self.of.rows[run[0]][column] == cells[column]) {
                Some(run) => run.push(row),
                None => runs.push(vec![row]),
            }
        }
        runs
    }

    /// In the logarithm each value must lie on the line through its two nearest neighbours, but for `within`: at the ends of the rows that
    /// line is extended.
    fn smooth(&mut self, rows: &[usize], by: &str, column: &str, within: f64) {
        let point = |row: usize| (self.of.number(row, by).ln(), self.of.number(row, column).ln());
        let points: Vec<_> = rows.iter().map(|&row| point(row)).collect();
        for at in 0..points.len() {
            let (a, b) = match at {
                0 => (1, 2),
                at if at + 1 == points.len() => (at - 2, at - 1),
                at => (at - 1, at + 1),
            };
            let slope = (points[b].1 - points[a].1) / (points[b].0 - points[a].0);
            let expected = points[a].1 + slope * (points[at].0 - points[a].0);
            let (value, expected) = (points[at].1.exp(), expected.exp());
            // Not so for what is no number, such as the logarithm of nothing.
            let near = (value / expected).ln().abs() <= within;
            self.require(rows[at], near, &format!("{column} is {value}, its neighbours say {expected:.4}"));
        }
    }

    /// Values of a run of rows that must all be the same.
    fn same(&mut self, run: &[usize], columns: &[&str]) {
        for column in columns {
            let at = self.of.column(column);
            for &row in run {
                self.require(row, self.of.rows[row][at] == self.of.rows[run[0]][at], &format!("{column} differs from the rows beside it"));
            }
        }
    }

    /// Values that must rise from row to row of a run.
    fn rising(&mut self, run: &[usize], column: &str) {
        for pair in run.windows(2) {
            let rises = self.of.number(pair[0], column) < self.of.number(pair[1], column);
            self.require(pair[1], rises, &format!("{column} does not rise"));
        }
    }
}

/// What does not hang together in a catalogue, given the others as they are shipped.
fn flaws(of: &Catalogue, others: &[Catalogue]) -> Vec<String> {
    let mut flaws = Flaws { of, found: Vec::new() };
    let all: Vec<usize> = (0..of.rows.len()).collect();
    let number = |row: usize, column: &str| of.number(row, column);
    match of.name.as_str() {
        "v-belts.csv" => {
            flaws.smooth(&all, "belt_top_width_mm", "belt_height_mm", 0.06);
            for pair in all.windows(2) {
                let step = number(pair[1], "belt_top_width_mm") / number(pair[0], "belt_top_width_mm");
                flaws.require(pair[1], (1.28..1.48).contains(&step), "sections widen by a third to a half");
            }
            all.iter().for_each(|&row| flaws.equal(row, number(row, "belt_angle_deg"), 40.0, 0.0, "every V-belt has 40 degrees"));
        }
        "v-grooves.csv" => {
            let belts = others.iter().find(|it| it.name == "v-belts.csv").expect("it is shipped");
            for run in flaws.runs("section") {
                let belt = belts.rows.iter().position(|belt| belt[0] == of.rows[run[0]][0]).expect("every section is a belt");
                for &row in &run {
                    for column in ["belt_top_width_mm", "belt_height_mm"] {
                        flaws.equal(row, number(row, column), belts.number(belt, column), 0.0, column);
                    }
                    let angle = number(row, "groove_angle_deg");
                    flaws.require(row, [34.0, 36.0, 38.0].contains(&angle), "a groove has 34, 36 or 38 degrees");
                    let wide = number(row, "groove_width_mm") / number(row, "belt_top_width_mm");
                    flaws.equal(row, wide, 1.01, 0.03, "a groove is as wide as its belt");
                    // Limits are whole inches, or fifths of one.
                    let limit = number(row, "up_to_diameter_mm");
                    let fifths = limit / 5.08;
                    let is_limit = limit == 100_000.0 || (fifths - fifths.round()).abs() < 0.1;
                    flaws.require(row, is_limit, "limits of diameters are fifths of an inch");
                }
                flaws.rising(&run, "groove_angle_deg");
                let (first, last) = (run[0], run[run.len() - 1]);
                flaws.equal(first, number(first, "above_diameter_mm"), 0.0, 0.0, "the first range has no lower end");
                flaws.equal(last, number(last, "up_to_diameter_mm"), 100_000.0, 0.0, "the last range has no upper end");
                flaws.equal(first, number(first, "groove_angle_deg"), 34.0, 0.0, "the smallest pulleys have 34 degrees");
                flaws.equal(last, number(last, "groove_angle_deg"), 38.0, 0.0, "the largest pulleys have 38 degrees");
                for pair in run.windows(2) {
                    let [before, after] = [pair[0], pair[1]];
                    flaws.equal(after, number(after, "above_diameter_mm"), number(before, "up_to_diameter_mm"), 0.0, "ranges join");
                    let wider = number(after, "groove_width_mm") - number(before, "groove_width_mm");
                    flaws.require(after, (0.15..=0.45).contains(&wider), "a groove widens a little with its angle");
                }
                let times = number(first, "up_to_diameter_mm") / number(first, "belt_top_width_mm");
                flaws.require(first, (9.0..11.1).contains(&times), "the first limit is some ten belt widths");
            }
        }
        "automotive-grooves.csv" => {
            for run in flaws.runs("size") {
                let size: f64 = of.rows[run[0]][0].trim_end_matches('A').parse().expect("a size begins with its width");
                flaws.same(&run, &["groove_width_mm"]);
                run.iter().for_each(|&row| flaws.equal(row, number(row, "groove_width_mm"), size, 0.35, "the size is the width"));
                let angles: &[f64] = if run.len() == 1 { &[36.0] } else { &[34.0, 36.0, 38.0] };
                flaws.require(run[0], run.len() == angles.len(), "a size comes with one angle or three");
                for (&row, &angle) in run.iter().zip(angles) {
                    flaws.equal(row, number(row, "groove_angle_deg"), angle, 0.0, "the angle of the groove");
                }
            }
        }
        "timing-profiles.csv" => {
            for &row in &all {
                for what in ["pitch", "tooth_height", "belt_thickness"] {
                    let [mm, inches] = [format!("{what}_mm"), format!("{what}_in")];
                    let within = of.half_unit(row, &mm) + 25.4 * of.half_unit(row, &inches);
                    // What is given in whole millimetres is exact.
                    let within = if number(row, &mm).fract() == 0.0 { 25.4 * of.half_unit(row, &inches) } else { within };
                    flaws.equal(row, number(row, &mm), 25.4 * number(row, &inches), within * 1.001, &format!("{what} in both units"));
                }
                let slender = number(row, "tooth_height_mm") / number(row, "pitch_mm");
                flaws.require(row, (0.19..0.43).contains(&slender), "a tooth is a fifth to two fifths of its pitch high");
            }
        }
        "htd-belts.csv" => {
            let runs = flaws.runs("profile");
            for run in &runs {
                let pitch: f64 = of.rows[run[0]][0].trim_matches(['H', 'M']).parse().expect("a profile is named by its pitch");
                run.iter().for_each(|&row| flaws.equal(row, number(row, "pitch_mm"), pitch, 0.0, "the profile is named by its pitch"));
                flaws.same(run, &["tooth_height_mm", "belt_thickness_mm", "pitch_line_differential_mm"]);
                flaws.rising(run, "belt_width_mm");
                for &row in run {
                    let mils = number(row, "pitch_line_differential_mm") / 0.0127;
                    flaws.equal(row, mils, mils.round(), 0.05, "pitch line differentials are half mils");
                    let width = number(row, "belt_width_mm") / pitch;
                    flaws.require(row, (1.75..=17.1).contains(&width), "belts are two to seventeen pitches wide");
                }
                for pair in run.windows(2) {
                    let step = number(pair[1], "belt_width_mm") / number(pair[0], "belt_width_mm");
                    flaws.require(pair[1], (1.15..1.71).contains(&step), "widths rise by a sixth to two thirds");
                }
            }
            let firsts: Vec<usize> = runs.iter().map(|run| run[0]).collect();
            flaws.smooth(&firsts, "pitch_mm", "tooth_height_mm", 0.1);
            flaws.smooth(&firsts, "pitch_mm", "belt_thickness_mm", 0.1);
        }
        "metal-bands.csv" => {
            // Every thickness with every width, and the name says which.
            for &row in &all {
                let name = format!("{}-{:.0}", number(row, "element_width_mm"), 100.0 * number(row, "band_thickness_mm"));
                flaws.require(row, of.rows[row][0] == name, "the name is element width and thickness");
                let share = number(row, "band_width_mm") / number(row, "element_width_mm");
                flaws.require(row, (0.37..0.44).contains(&share), "a band takes some two fifths of its element");
            }
            let pairs: BTreeSet<_> = of.rows.iter().map(|row| (row[1].clone(), row[2].clone(), row[3].clone())).collect();
            let [thin, wide] = [1, 2].map(|column| of.rows.iter().map(|row| row[column].clone()).collect::<BTreeSet<_>>().len());
            flaws.require(0, pairs.len() == of.rows.len() && thin * wide == of.rows.len(), "every thickness comes with every width once");
        }
        "bolts-m6.csv" => {
            let runs = flaws.runs("seat");
            for run in &runs {
                flaws.same(run, &["seat_diameter_mm"]);
                flaws.smooth(run, "bolt_friction", "torque_factor", 0.035);
                flaws.smooth(run, "bolt_friction", "preload_kN", 0.035);
                flaws.smooth(run, "preload_kN", "seat_pressure_MPa", 0.02);
                for &row in run {
                    let torque = number(row, "torque_factor") * number(row, "preload_kN") * 6.0;
                    flaws.equal(row, torque, 10.0, 0.03, "T = K F d in N m");
                    let hole = 6.6;
                    let area = std::f64::consts::PI / 4.0 * (number(row, "seat_diameter_mm").powi(2) - hole * hole);
                    let pressure = 1000.0 * number(row, "preload_kN") / area;
                    flaws.equal(row, number(row, "seat_pressure_MPa") / pressure, 1.0, 0.006, "the pressure is preload over seat");
                }
            }
            let [one, other] = [&runs[0], &runs[runs.len() - 1]];
            for (&a, &b) in one.iter().zip(other) {
                flaws.equal(b, number(b, "bolt_friction"), number(a, "bolt_friction"), 0.0, "both seats have the same frictions");
            }
        }
        "glass-cords.csv" => {
            for &row in &all {
                let strands = number(row, "strands");
                flaws.require(row, of.rows[row][0] == format!("3/{strands}"), "the name says how many strands");
                flaws.equal(row, number(row, "cord_mass_g_per_km") / strands, 134.6, 0.5, "mass per strand");
                flaws.equal(row, number(row, "cord_diameter_mm").powi(2) / strands, 0.114, 0.002, "cross-section per strand");
                flaws.equal(row, number(row, "cord_strength_N") / strands, 85.8, 1.2, "strength per strand");
            }
        }
        other => panic!("{other}: say in this test what hangs together in it"),
    }
    flaws.found
}

#[test]
fn every_row_has_a_source_and_hangs_together_with_the_others() {
    let all = catalogues();
    assert!(all.len() >= 8, "{}", all.len());
    for catalogue in &all {
        assert_eq!(catalogue.header.last().map(String::as_str), Some("source"), "{}", catalogue.name);
        assert!(catalogue.rows.iter().all(|row| row.last().is_some_and(|it| it.len() > 10)), "{}: a row has no source", catalogue.name);
        let text = std::fs::read_to_string(folder().join(&catalogue.name)).expect("it can be read");
        assert!(text.starts_with("# "), "{} does not say what it is", catalogue.name);
        assert!(!text.contains('\r') && text.ends_with('\n'), "{}", catalogue.name);
        let rows: BTreeSet<_> = catalogue.rows.iter().collect();
        assert_eq!(rows.len(), catalogue.rows.len(), "{} has a row twice", catalogue.name);
        let found = flaws(catalogue, &all);
        assert!(found.is_empty(), "{}", found.join("\n"));
    }
}

/// Copies of a catalogue with one digit changed: any but the last one of a number that has several, to any other digit.
fn slips(of: &Catalogue) -> Vec<(String, Catalogue)> {
    let mut slips = Vec::new();
    for column in (0..of.header.len()).filter(|&column| of.is_numeric(column)) {
        for row in 0..of.rows.len() {
            let cell = &of.rows[row][column];
            let digits: Vec<usize> = cell.char_indices().filter(|(_, c)| c.is_ascii_digit()).map(|(at, _)| at).collect();
            for &at in &digits[..digits.len() - 1] {
                for digit in ('0'..='9').filter(|&digit| !cell[at..].starts_with(digit)) {
                    let mut changed = of.clone();
                    changed.rows[row][column].replace_range(at..=at, &digit.to_string());
                    slips.push((format!("{}, row {}: {cell} as {}", of.name, row + 1, changed.rows[row][column]), changed));
                }
            }
        }
    }
    slips
}

/// The share of changed digits that must be found in each catalogue, and in all together.
const FOUND: f64 = 0.9;
const FOUND_IN_ALL: f64 = 0.97;

#[test]
fn a_changed_digit_is_found() {
    let all = catalogues();
    let (mut found, mut tried) = (0, 0);
    for catalogue in &all {
        let slips = slips(catalogue);
        let missed: Vec<_> = slips.iter().filter(|(_, slip)| flaws(slip, &all).is_empty()).map(|(what, _)| what.as_str()).collect();
        println!("{}: {} of {} slips found; not {}", catalogue.name, slips.len() - missed.len(), slips.len(), missed.join("; "));
        assert!(!slips.is_empty() && (slips.len() - missed.len()) as f64 >= FOUND * slips.len() as f64, "{}: {missed:?}", catalogue.name);
        found += slips.len() - missed.len();
        tried += slips.len();
    }
    println!("{found} of {tried}");
    assert!(found as f64 >= FOUND_IN_ALL * f64::from(tried as u32), "{found} of {tried}");
}

#[test]
fn every_catalogue_can_be_used_as_it_is() {
    for catalogue in catalogues() {
        let numeric: Vec<&String> =
            (0..catalogue.header.len()).filter(|&it| catalogue.is_numeric(it)).map(|it| &catalogue.header[it]).collect();
        let label = &catalogue.header[0];
        // A formula that reads every column of numbers, whatever its unit.
        let formulas: String = numeric.iter().enumerate().map(|(at, name)| format!("ratio_{at} = \"{name} / {name}\"\n")).collect();
        let names: Vec<_> = (0..numeric.len()).map(|at| format!("\"ratio_{at}\"")).collect();
        let text = format!(
            "model = \"pulley-load\"\nlabels = [\"{label}\"]\n[design]\ncases = {{ csv = \"../catalogues/{}\", unused = \"ok\" }}\n[formulas]\n{formulas}\
             [objectives]\nresultant_force_N = \"min\"\n[report]\ncolumns = [{}]\n",
            catalogue.name,
            names.join(", ")
        );
        let study = Study::parse_in(&text, "study.toml", &folder()).unwrap_or_else(|errors| panic!("{}: {errors}", catalogue.name));
        assert_eq!(study.labels[0].texts, catalogue.rows.iter().map(|row| row[0].clone()).collect::<Vec<_>>());
        let left_out = format!("../catalogues/{}: nothing uses the columns \"source\"; they are left out", catalogue.name);
        assert_eq!(study.left_out, [left_out], "{}", catalogue.name);
        assert_eq!(study.design[0].inputs().len(), numeric.len());
    }
    let readme = std::fs::read_to_string(folder().join("README.md")).expect("catalogues have a README");
    for catalogue in catalogues() {
        assert!(readme.contains(&format!("`{}`", catalogue.name)), "the README does not name {}", catalogue.name);
    }
}
