//! The page of a result in Chromium, used with mouse and keys. These tests need a browser, so they run where they are asked for, as in the
//! full stage of the checks, and a missing browser is a failure.

use crate::browser::Browser;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

pub fn beltspace(words: &[&str]) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new(env!("CARGO_BIN_EXE_beltspace")).args(words).current_dir(root).output().expect("the program starts");
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// The page of a study of its own.
pub struct Swept {
    pub folder: TempDir,
}

impl Swept {
    pub fn shipped(name: &str) -> Self {
        Self::of(&format!("studies/{name}.toml"))
    }

    pub fn text(study: &str) -> Self {
        let folder = tempfile::tempdir().expect("there is room");
        let file = folder.path().join("study.toml");
        std::fs::write(&file, study).expect("it can be written");
        Self::of(file.to_str().expect("a path of characters"))
    }

    pub fn of(study: &str) -> Self {
        let folder = tempfile::tempdir().expect("there is room");
        beltspace(&["sweep", study, "--out", folder.path().join("r").to_str().expect("a path of characters"), "--quiet"]);
        Self { folder }
    }

    pub fn page(&self) -> PathBuf {
        self.file("report.html")
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join("r").join(name)
    }

    pub fn front(&self) -> Vec<BTreeMap<String, String>> {
        self.table("front.csv")
    }

    pub fn table(&self, name: &str) -> Vec<BTreeMap<String, String>> {
        let mut reader = csv::Reader::from_path(self.file(name)).expect("there is such a table");
        reader.deserialize().map(|row| row.expect("rows are complete")).collect()
    }
}

pub fn number(text: &str) -> f64 {
    text.parse().expect("it is a number")
}

/// The first number in which the open card differs from a row of the front table.
fn card_differs(browser: &mut Browser, table: &BTreeMap<String, String>) -> Option<String> {
    let values: Vec<_> = table.iter().filter(|(name, _)| !name.ends_with("_scenario") && *name != "design_index").collect();
    assert!(values.len() >= 8, "{}", values.len());
    values.into_iter().find_map(|(name, value)| {
        let shown = browser.text(&format!("document.querySelector('#card [data-name=\"{name}\"]').dataset.value"));
        (number(&shown).to_bits() != number(value).to_bits()).then(|| format!("{name}: the card says {shown}, the table {value}"))
    })
}

/// Drags over an area of a cell of the matrix, given in fractions of its width and height.
pub fn brush(browser: &mut Browser, x: &str, y: &str, from: [f64; 2], to: [f64; 2]) {
    let [left, top, width, height] = browser.rectangle(&format!(".cell[data-x={x:?}][data-y={y:?}] .overlay"));
    let place = |part: [f64; 2]| [left + part[0] * width, top + part[1] * height];
    browser.drag(place(from), place(to));
    browser.evaluate("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 200)))");
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_front_is_brushed_and_a_card_says_what_the_table_says() {
    let swept = Swept::shipped("metal-cvt");
    let size = std::fs::metadata(swept.page()).expect("there is a page").len();
    assert!(size < 2_000_000, "{size} bytes");
    let mut browser = Browser::open(&swept.page(), "");
    let front = swept.front();
    assert_eq!(browser.number("beltspace.data.front.rows"), front.len() as f64);
    let brushable = browser.number("beltspace.timings.firstPaint");
    let opened = browser.opened.as_secs_f64();
    eprintln!(
        "{} designs, {size} bytes: brushable {brushable:.0} ms after navigation began, {opened:.2} s with starting Chromium",
        front.len()
    );
    assert_eq!(browser.text("document.querySelector('#selected-count').textContent").replace('\u{202f}', ""), front.len().to_string());
    browser.picture("metal-cvt");

    // A brush in a cell, then another one in a second cell: both hold.
    // A pixel inside of the corner: Firefox rounds where the mouse is.
    brush(&mut browser, "axial_force_upper_N", "stress_margin", [0.01, 0.01], [0.6, 0.6]);
    let state = "[...beltspace.state.cells.values()].map((c) => [c.x, c.y, ...c.xRange, ...c.yRange])";
    let ranges = browser.evaluate(state);
    assert_eq!(ranges.as_array().map(Vec::len), Some(1), "{ranges}");
    brush(&mut browser, "stress_margin", "clamping_utilisation", [0.2, 0.1], [1.0, 0.9]);
    browser.picture("metal-cvt-brushed");
    let ranges = browser.evaluate(state);
    let ranges: Vec<(String, String, [f64; 4])> = serde_json::from_value::<Vec<(String, String, f64, f64, f64, f64)>>(ranges)
        .expect("two brushes")
        .into_iter()
        .map(|(x, y, a, b, c, d)| (x, y, [a, b, c, d]))
        .collect();
    assert_eq!(ranges.len(), 2);
    let inside = |row: &BTreeMap<String, String>| {
        ranges.iter().all(|(x, y, [a, b, c, d])| (*a..=*b).contains(&number(&row[x])) && (*c..=*d).contains(&number(&row[y])))
    };
    let expected: Vec<u64> = (0..).zip(&front).filter(|(_, row)| inside(row)).map(|(at, _)| at).collect();
    let selected: Vec<u64> = serde_json::from_value(browser.evaluate("[...beltspace.selected()]")).expect("rows");
    assert!(expected.len() > 20 && expected.len() < front.len() - 20, "{} of {}", expected.len(), front.len());
    assert_eq!(selected, expected, "what is selected is what lies in both brushes");
    assert_eq!(browser.text("document.querySelector('#selected-count').textContent").replace('\u{202f}', ""), expected.len().to_string());

    // The card of a point that is clicked says what front.csv says of it, to the last digit.
    browser.click_on("#designs tbody tr:nth-child(3)");
    browser.wait("!document.querySelector('#card').hidden");
    let row = browser.number("beltspace.state.card") as usize;
    assert!(expected.contains(&(row as u64)));
    let table = &front[row];
    assert_eq!(card_differs(&mut browser, table), None);
    let mut wrong = table.clone();
    let last = wrong["clamping_utilisation"].clone();
    wrong.insert("clamping_utilisation".to_owned(), format!("1{last}"));
    assert!(card_differs(&mut browser, &wrong).is_some_and(|it| it.starts_with("clamping_utilisation")), "a wrong digit would go unseen");
    let card = browser.text("document.querySelector('#card').innerText");
    assert!(card.contains(&format!("--design {}", table["design_index"])), "{card}");
    browser.picture("metal-cvt-card");
    // The command on the card, run as it stands, gives the same number.
    let command =
        browser.text("[...document.querySelectorAll('#card code')].map((it) => it.textContent).find((it) => it.includes('--design'))");
    let words: Vec<&str> = command.split_whitespace().skip(1).chain(["--json"]).filter(|word| *word != "--scenario").collect();
    let again: serde_json::Value = serde_json::from_str(&beltspace(&words)).expect("--json prints JSON");
    let value = again["outputs"]["axial_force_upper_N"]["value"].as_f64();
    assert_eq!(value, Some(number(&table["axial_force_upper_N"])), "{command}");

    // Esc closes; the address holds the state, and brings it back.
    browser.key("Escape", 27);
    browser.wait("document.querySelector('#card').hidden");
    browser.wait("location.hash.includes('r=')");
    let hash = browser.text("location.hash");
    browser.go_to(&swept.page(), &hash);
    let again: Vec<u64> = serde_json::from_value(browser.evaluate("[...beltspace.selected()]")).expect("rows");
    assert_eq!(again, expected, "{hash}");
    browser.click_on("#clear");
    browser.wait(&format!("beltspace.selected().length === {}", front.len()));
    assert!(browser.complaints.is_empty(), "{:#?}", browser.complaints);
    // Whatever asks for a network is stopped by the page itself, and would be noticed here.
    browser.evaluate("fetch('http://127.0.0.1:9/').catch(() => null)");
    for _ in 0..100 {
        if browser.complaints.is_empty() {
            std::thread::sleep(std::time::Duration::from_millis(20));
            browser.evaluate("0");
        }
    }
    assert!(!browser.complaints.is_empty(), "a request would go unseen");
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn axes_are_brushed_turned_and_moved_and_a_point_is_reached_with_the_keyboard() {
    let swept = Swept::shipped("rubber-cvt");
    let mut browser = Browser::open(&swept.page(), "");
    let front = swept.front();
    // The lower half of the first axis.
    let name = browser.text("beltspace.state.parallel[0]");
    let [left, top, width, height] = browser.rectangle(&format!("#parallel .axis[data-name={name:?}] .overlay"));
    // The axis spans the range that was searched, wherever the front stands on it: to its median.
    let column = format!("beltspace.page.front.byName.get({name:?})");
    let scale = format!("((value) => {{ const [low, high] = beltspace.page.domain({column}); return (high - value) / (high - low); }})");
    let middle = browser.number(&format!("{scale}(({column}.low + {column}.high) / 2)"));
    browser.drag([left + width / 2.0, top + 10.0 + middle * (height - 20.0)], [left + width / 2.0, top + 0.98 * height]);
    browser.wait("beltspace.state.axes.size === 1");
    let range: [f64; 2] = serde_json::from_value(browser.evaluate(&format!("beltspace.state.axes.get({name:?})"))).expect("two ends");
    let expected = front.iter().filter(|row| (range[0]..=range[1]).contains(&number(&row[&name]))).count();
    assert!(expected > 0 && expected < front.len(), "{expected} of {}", front.len());
    assert_eq!(browser.number("beltspace.selected().length"), expected as f64);
    browser.picture("rubber-cvt-parallel");
    // Reversed and moved with its buttons: the first axis becomes the second.
    let second = browser.text("beltspace.state.parallel[1]");
    browser.click_on(&format!("[data-focus=\"right {name}\"]"));
    browser.wait(&format!("beltspace.state.parallel.slice(0, 2).join() === {:?}", format!("{second},{name}")));
    let tick = format!("document.querySelector('#parallel .axis[data-name={name:?}] .tick').getAttribute('transform')");
    let upright = browser.text(&tick);
    browser.click_on(&format!("[data-focus=\"invert {name}\"]"));
    // The axis is drawn the other way round.
    browser.wait(&format!("{tick} !== {upright:?}"));
    assert_eq!(browser.number("beltspace.selected().length"), expected as f64, "how an axis stands selects nothing");
    browser.click_on("#clear");
    // Dragged by its title onto the place of the fourth one.
    browser.rectangle(&format!("#parallel .axis-head[data-axis={name:?}] .axis-name"));
    let places = browser.evaluate(&format!(
        "[{name:?}, beltspace.state.parallel[3]].map((it) => document.querySelector(`#parallel .axis-head[data-axis=\"${{it}}\"] .axis-name`).getBoundingClientRect()) \
         .map((it) => [it.left + it.width / 2, it.top + it.height / 2])"
    ));
    let [from, to]: [[f64; 2]; 2] = serde_json::from_value(places).expect("two places");
    browser.drag(from, [to[0], from[1]]);
    browser.wait(&format!("beltspace.state.parallel.indexOf({name:?}) === 3"));
    // Keys only: into a cell of the matrix, to a point, its card, the next card, and out.
    browser.evaluate("document.querySelector('#splom .cell').focus()");
    browser.key("ArrowRight", 39);
    browser.wait("beltspace.state.current !== null");
    browser.key("Enter", 13);
    browser.wait("!document.querySelector('#card').hidden");
    let first = browser.number("beltspace.state.card");
    browser.key("ArrowRight", 39);
    browser.wait(&format!("beltspace.state.card !== {first}"));
    browser.key("Escape", 27);
    browser.wait("document.querySelector('#card').hidden");
    assert!(browser.complaints.is_empty(), "{:#?}", browser.complaints);
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn dark_and_light_maps_and_pictures_of_a_pulley() {
    for name in ["pulley-thickness", "timing-map", "pulley-load"] {
        let swept = Swept::shipped(name);
        let mut browser = Browser::open(&swept.page(), "#t=dark");
        assert_eq!(browser.text("document.documentElement.dataset.theme"), "dark");
        let dark = browser.text("getComputedStyle(document.body).backgroundColor");
        browser.picture(&format!("{name}-dark"));
        browser.click_on("#theme");
        browser.wait(&format!("getComputedStyle(document.body).backgroundColor !== {dark:?}"));
        let pictures = browser.number("document.querySelectorAll('#figures svg, #figures img, #maps svg, #maps img, #maps canvas').length");
        assert!(pictures >= 1.0, "{name} shows {pictures} pictures");
        // Every map can be saved, those that are too large for cells too.
        assert_eq!(browser.number("document.querySelectorAll('#maps figure:not(:has(.save-buttons))').length"), 0.0, "{name}");
        assert!(browser.complaints.is_empty(), "{name}: {:#?}", browser.complaints);
    }
}

const POINT: &str = r#"
model = "metal-cvt"
title = "One design is the best of all"
[design]
band_count = [8, 10]
[operation]
torque_Nm = [50, 100]
[constraints]
slip_margin = { min = 0 }
[objectives]
max_stress_MPa = "min"
axial_force_N = "min"
"#;

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_page_with_one_point_and_one_with_none() {
    let swept = Swept::text(POINT);
    assert_eq!(swept.front().len(), 1);
    let mut browser = Browser::open(&swept.page(), "");
    browser.picture("one-point");
    assert_eq!(browser.number("beltspace.selected().length"), 1.0);
    browser.evaluate("beltspace.openCard(0)");
    browser.wait("!document.querySelector('#card').hidden");
    assert!(browser.complaints.is_empty(), "{:#?}", browser.complaints);

    let swept = Swept::text(&POINT.replace("slip_margin = { min = 0 }", "slip_margin = { min = 0 }\nmax_stress_MPa = { max = 20 }"));
    assert!(swept.front().is_empty());
    let mut browser = Browser::open(&swept.page(), "");
    browser.picture("none-feasible");
    let said = browser.text("document.querySelector('#lead').innerText");
    assert!(said.contains("No design is feasible") && said.contains("max_stress_MPa at most 20"), "{said}");
    assert!(browser.complaints.is_empty(), "{:#?}", browser.complaints);
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn labels_stand_in_the_table_the_card_the_readout_and_what_is_selected() {
    let swept = Swept::text(
        "model = \"metal-cvt\"\nlabels = [\"part_no\", \"maker\"]\n[design]\ncases = [\n\
         { part_no = \"007\", maker = \"Alpha, Ltd\", band_thickness_mm = 0.1 },\n\
         { part_no = \"008\", maker = \"Says \\\"hi\\\"\", band_thickness_mm = 0.15 },\n]\nband_count = { from = 6, to = 12 }\n\
         [objectives]\nband_count = \"min\"\nstress_margin = \"max\"\n[report]\ntop = { by = \"stress_margin\", count = 5 }\n",
    );
    let front = swept.front();
    let mut browser = Browser::open(&swept.page(), "");
    for (row, cells) in front.iter().enumerate() {
        browser.evaluate(&format!("beltspace.openCard({row})"));
        for name in ["part_no", "maker"] {
            let shown = browser.text(&format!("document.querySelector('#card [data-name={name}]').textContent"));
            assert_eq!(shown, cells[name], "card of row {row}");
            let shown = browser.text(&format!(
                "document.querySelector('#designs tr[data-row=\"{row}\"]').cells\
                 [[...document.querySelectorAll('#designs th')].findIndex((it) => it.dataset.column === '{name}')].textContent"
            ));
            assert_eq!(shown, cells[name], "table, row {row}");
        }
    }
    let last = &front[front.len() - 1];
    browser.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))");
    let readout = browser.text("document.querySelector('#readout').textContent");
    assert!(readout.contains(&format!("part_no{}", last["part_no"])), "{readout}");
    let saved = browser.text("beltspace.csv()");
    let mut reader = csv::Reader::from_reader(saved.as_bytes());
    let rows: Vec<BTreeMap<String, String>> = reader.deserialize().map(|row| row.expect("rows are complete")).collect();
    assert!(rows.len() == front.len() && rows.iter().zip(&front).all(|(a, b)| ["part_no", "maker"].iter().all(|it| a[*it] == b[*it])));
    // A number that a list shortens stays as it is where it is a label.
    let top = browser.text("document.querySelector('#top tbody').textContent");
    assert!(top.contains("007") || top.contains("008"), "{top}");
    // Labels can be a colour and an axis.
    browser.evaluate("beltspace.setColour('maker')");
    browser.evaluate("beltspace.chooseColumns('parallel', ['part_no', 'band_count'])");
    browser.evaluate("beltspace.brushAxis('part_no', [-0.4, 0.4])");
    let selected = browser.number("beltspace.selected().length");
    assert_eq!(selected, front.iter().filter(|row| row["part_no"] == "007").count() as f64);
    browser.picture("labels");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn the_papers_have_a_page_of_the_same_kind() {
    let folder = tempfile::tempdir().expect("there is room");
    beltspace(&["reproduce", "--out", folder.path().to_str().expect("a path of characters"), "--quiet"]);
    let mut browser = Browser::open(&folder.path().join("report.html"), "");
    browser.picture("papers");
    let rows = browser.number("document.querySelectorAll('#comparison tbody tr:not(.group)').length");
    assert_eq!(rows, browser.number("beltspace.data.comparison.length"));
    assert!(rows > 60.0, "{rows}");
    let unreasoned = "[...document.querySelectorAll('#comparison td.reason')].filter((it) => it.textContent.trim() === '').length";
    assert_eq!(browser.number(unreasoned), 0.0);
    assert_eq!(browser.number("document.querySelectorAll('#figures figure svg').length"), browser.number("beltspace.data.figures.length"));
    assert!(!browser.text("document.querySelector('#overview').innerText").contains("null"));
    assert!(browser.complaints.is_empty(), "{:#?}", browser.complaints);
}
