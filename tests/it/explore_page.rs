//! The page of `beltspace explore` in Chromium, used as a person uses it. These tests need a browser, so they run where they are asked for.

use crate::browser::Browser;
use crate::random::Random;
use beltspace::models::Models;
use beltspace::{Data, Engine, Judging, Options, Study, Table};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A server that ends with the test.
pub struct Explored {
    process: Child,
    pub address: String,
}

impl Explored {
    pub fn new(study: &Path, words: &[&str]) -> Self {
        Self::in_folder(Path::new(env!("CARGO_MANIFEST_DIR")), study, words)
    }

    pub fn in_folder(folder: &Path, study: &Path, words: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_beltspace"))
            .arg("explore")
            .arg(study)
            .arg("--no-browser")
            .args(words)
            .current_dir(folder)
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("it is piped")).read_line(&mut line).expect("it prints its address");
        let address = line.split_whitespace().find(|word| word.starts_with("http://")).expect("it has an address").to_owned();
        Self { process, address }
    }
}

impl Drop for Explored {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

pub fn study_file(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("there is room");
    let file = folder.path().join("study.toml");
    std::fs::write(&file, text).expect("it can be written");
    (folder, file)
}

pub const SMALL: &str = r#"
model = "metal-cvt"
title = "A small belt"
[design]
groove_angle_deg  = { from = 18, to = 30, count = 7 }
band_thickness_mm = { from = 0.10, to = 0.30, step = 0.02 }
band_count        = { from = 6, to = 14 }
traction          = { from = 0.30, to = 0.50, count = 5 }
[operation]
ratio     = { from = 0.5, to = 2.0, count = 9, spacing = "log" }
torque_Nm = [50, 150]
[uncertainty]
friction = { from = 0.065, to = 0.095, count = 3 }
[fixed]
strength_MPa = 800
[constraints]
slip_margin   = { min = 0 }
stress_margin = { min = 0 }
[objectives]
axial_force_N = "min"
stress_margin = "max"
slip_margin   = "max"
[report]
columns = ["max_stress_MPa"]
"#;

/// Waits for the exact answer to what was changed, and the frame that shows it.
pub fn answered(browser: &mut Browser) {
    browser.wait("beltspace.page.isAnswered() && beltspace.timings.answers.length >= (window.wanted || 1)");
}

/// Starts anew to count answers.
pub const COUNT: &str = "(() => { window.wanted = beltspace.timings.answers.length + 1; })()";

pub fn open(explored: &Explored) -> Browser {
    let mut browser = Browser::open_at(&explored.address);
    answered(&mut browser);
    browser
}

/// In which column and row the page's front differs from a fresh sweep of the same changes.
pub fn differs(browser: &mut Browser, text: &str, folder: &Path) -> Option<String> {
    let set: Vec<String> = serde_json::from_value(browser.evaluate("beltspace.page.changeList()")).expect("texts");
    let shown = browser.evaluate(
        "({ index: beltspace.page.front.index ? [...beltspace.page.front.index.exact] : [], \
         columns: Object.fromEntries(beltspace.page.front.columns.filter((it) => it.type === 'f64').map((it) => [it.name, \
         [...it.values].map((v) => Number.isNaN(v) ? null : v)])) })",
    );
    let (study, _) = Study::parse_set(&Models::new(), text, "study.toml", folder, &set).unwrap_or_else(|error| panic!("{set:?}: {error}"));
    let options = Options::default().engine(Engine::Cpu).judging(Judging::Exhaustive);
    let outcome = study.sweep(options).unwrap_or_else(|error| panic!("{set:?}: {error}"));
    difference(&shown, &outcome.front).map(|where_| format!("{set:?}: {where_}"))
}

fn difference(shown: &Value, front: &Table) -> Option<String> {
    let indices = match &front.columns[0].data {
        Data::Whole(indices) => indices.iter().map(|it| it.expect("each has one").to_string()).collect::<Vec<_>>(),
        other => panic!("the first column is {other:?}"),
    };
    let own: Vec<String> = serde_json::from_value(shown["index"].clone()).expect("texts");
    if own != indices {
        return Some(format!("the page has {} designs, the sweep {}", own.len(), indices.len()));
    }
    let columns = shown["columns"].as_object().expect("columns by name");
    let mut compared = 0;
    for column in &front.columns {
        let Data::Number(values) = &column.data else { continue };
        let own = columns.get(&column.name).unwrap_or_else(|| panic!("the page has no {}", column.name)).as_array().expect("numbers");
        for (row, (own, value)) in own.iter().zip(values).enumerate() {
            if own.as_f64().map(f64::to_bits) != value.map(f64::to_bits) {
                return Some(format!("{} in row {row}: the page has {own}, the sweep {value:?}", column.name));
            }
        }
        compared += 1;
    }
    assert!(compared >= 4, "{compared} columns were compared");
    None
}

/// Moves one slider or field of those in the panel to a random place, and waits for the answer.
pub fn move_one(browser: &mut Browser, random: &mut Random) {
    browser.evaluate(COUNT);
    let at = random.unit();
    let pick = random.unit();
    let moved = browser.evaluate(&format!(
        "(() => {{ const sliders = [...document.querySelectorAll('#controls input[type=range]')].filter((it) => it.closest('details').dataset.group !== 'others'); \
         const slider = sliders[Math.floor({pick} * sliders.length)]; const before = String(beltspace.page.changeList()); \
         slider.value = Number(slider.min) + {at} * (Number(slider.max) - Number(slider.min)); \
         slider.dispatchEvent(new Event('input', {{ bubbles: true }})); slider.dispatchEvent(new Event('change', {{ bubbles: true }})); \
         return before !== String(beltspace.page.changeList()) ? slider.dataset.part : null; }})()"
    ));
    if !moved.is_null() {
        browser.wait("beltspace.page.isAnswered() && (beltspace.timings.answers.length >= window.wanted || document.querySelector('#live').dataset.kind === 'error')");
        // What the engine refuses, such as an end beyond the other, is taken back.
        if browser.evaluate("document.querySelector('#live').dataset.kind") == "error" {
            browser.evaluate(COUNT);
            browser.evaluate("beltspace.page.undoChange()");
            answered(browser);
        }
    }
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn the_front_after_two_hundred_moves_of_sliders_is_that_of_a_fresh_sweep() {
    let (folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    let random = &mut Random::new(22);
    let (mut empty, mut compared) = (0, 0);
    for round in 0..200 {
        move_one(&mut browser, random);
        if browser.number("beltspace.page.front.rows") == 0.0 {
            empty += 1;
        }
        assert_eq!(differs(&mut browser, SMALL, folder.path()), None, "round {round}");
        compared += 1;
        // Now and then back, so that not everything stands at its end.
        if round % 12 == 11 {
            browser.evaluate(COUNT);
            browser.evaluate("beltspace.page.resetChanges()");
            answered(&mut browser);
        }
    }
    eprintln!("200 moves: {compared} fronts are those of a fresh sweep, {empty} of them empty");
    assert!(empty < 150, "{empty} of 200 fronts were empty");
    // Of another study the front is another: a wrong front would be seen.
    let other = SMALL.replace("strength_MPa = 800", "strength_MPa = 700");
    browser.evaluate("beltspace.page.resetChanges()");
    std::thread::sleep(Duration::from_millis(500));
    assert!(differs(&mut browser, &other, folder.path()).is_some());
    let asked: Vec<_> = browser.complaints.iter().filter(|it| !it.contains("Log.entryAdded")).cloned().collect();
    assert_eq!(asked, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn changes_are_undone_shared_saved_and_compared() {
    let (folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    let before = browser.number("beltspace.page.front.rows");
    // With the mouse: a slider is dragged; all of that is one step back.
    let slider = "#controls input[type=range][data-part=\"constraints.stress_margin.min\"]";
    let [left, top, width, height] = browser.rectangle(slider);
    browser.evaluate(COUNT);
    // The handle, 16 pixels wide, moves between the ends of the track.
    let at = |part: f64| [left + 8.0 + part * (width - 16.0), top + height / 2.0];
    let value: f64 =
        browser.number(&format!("(() => {{ const e = document.querySelector('{slider}'); return (0 - e.min) / (e.max - e.min); }})()"));
    // To where it leaves half of the front.
    let to: f64 = browser.number(&format!(
        "(() => {{ const e = document.querySelector('{slider}'); \
         const values = Array.from(beltspace.page.front.columns.find((it) => it.name === 'stress_margin').values).sort((a, b) => a - b); \
         return (values[values.length >> 1] - e.min) / (e.max - e.min); }})()"
    ));
    browser.drag(at(value), at(to));
    answered(&mut browser);
    let after = browser.number("beltspace.page.front.rows");
    assert!(after > 0.0 && after < before, "{after} of {before}");
    assert_eq!(browser.number("beltspace.page.changes().size"), 1.0);
    let first = browser.text("beltspace.page.changeList().join()");
    // The front of before stays behind as a ghost, as long as it is asked for.
    let ghosts = "(() => { const drawn = document.querySelector('#splom canvas'); const { page } = beltspace; \
         const copy = Object.assign(document.createElement('canvas'), { width: drawn.width, height: drawn.height }); \
         const context = copy.getContext('2d', { willReadFrequently: true }); context.drawImage(drawn, 0, 0); \
         const { buffer } = context.getImageData(0, 0, copy.width, copy.height).data; \
         const own = page.pixel(page.variable('--ghost')); return new Uint32Array(buffer).filter((it) => it === own).length; })()";
    assert_eq!(browser.number("beltspace.page.ghost.rows"), before);
    assert!(browser.number(ghosts) > 20.0, "no ghost is painted");
    // What is counted moves the page a little: a click then may miss.
    browser.wait("beltspace.page.data.study.feasible !== null");
    browser.click_on("#ghost");
    assert_eq!(browser.number(ghosts), 0.0);
    browser.click_on("#ghost");
    browser.picture("explore-dragged");
    assert_eq!(differs(&mut browser, SMALL, folder.path()), None);
    browser.evaluate(COUNT);
    browser.click_on("#undo");
    answered(&mut browser);
    assert_eq!(browser.number("beltspace.page.front.rows"), before);
    browser.evaluate(COUNT);
    browser.evaluate("beltspace.timings.counted = 0");
    browser.click_on("#redo");
    answered(&mut browser);
    assert_eq!(browser.text("beltspace.page.changeList().join()"), first);
    // The certified front renews an open card; a button that is pressed meanwhile would be gone before it is released.
    browser.wait("beltspace.timings.counted > 0");
    // The command line says it, a moment later, and gives the same front.
    browser.wait("document.querySelector('#command').textContent.includes('--set constraints.stress_margin.min=')");
    let command = browser.text("document.querySelector('#command').textContent");
    assert!(command.contains("--set constraints.stress_margin.min="), "{command}");
    // A design is pinned, another one too, and they are compared.
    browser.evaluate("beltspace.openCard(0)");
    browser.click_on("#card-pin");
    browser.wait("document.querySelectorAll('.pins thead .pin-letter').length === 1");
    browser.evaluate("beltspace.openCard(beltspace.page.front.rows - 1)");
    browser.click_on("#card-pin");
    browser.wait("document.querySelectorAll('.pins thead .pin-letter').length === 2");
    assert!(browser.number("document.querySelectorAll('.pins tr.differs').length") >= 2.0);
    browser.wait("document.querySelector('#all-outputs table')");
    // A chart for each value that an input changes, the others in words.
    browser.wait("document.querySelectorAll('#around svg.slice').length >= 4");
    assert!(browser.text("document.querySelector('#around').innerText").contains("leaves unchanged"));
    // The drive is drawn to scale here too, and stays at its ratio from card to card.
    browser.evaluate("(() => { const e = document.querySelector('#drive-ratio'); e.value = 0; e.dispatchEvent(new Event('input')); })()");
    assert!(browser.text("document.querySelector('#card svg.drive title').textContent").contains("at ratio 0.5"));
    browser.evaluate("beltspace.openCard(0)");
    assert!(browser.text("document.querySelector('#card svg.drive title').textContent").contains("at ratio 0.5"));
    // By its name in the table of pinned designs too.
    browser.evaluate("document.querySelectorAll('.pins .pin-name')[1].click()");
    assert_eq!(browser.number("beltspace.page.state.card"), browser.number("beltspace.page.front.rows - 1"));
    browser.wait("document.querySelector('#all-outputs table')");
    // With other changes they are not on the front; what is known of them, and the changes, are shown all the same.
    let design = browser.text("String(beltspace.page.pins()[1].design)");
    browser.evaluate(COUNT);
    browser.click_on("#undo");
    answered(&mut browser);
    browser.evaluate("document.querySelectorAll('.pins .pin-name')[1].click()");
    let said = browser.text("document.querySelector('#card').innerText");
    assert!(said.contains(&format!("Design {design}")) && said.contains(&format!("with {first}")), "{said}");
    assert!(said.contains("stress_margin") && said.contains("band_count"), "{said}");
    browser.evaluate(COUNT);
    browser.click_on("#redo");
    answered(&mut browser);
    browser.evaluate("document.querySelectorAll('.pins .pin-name')[1].click()");
    browser.wait("document.querySelector('#all-outputs table')");
    // Findings come after the plots, which stay where they are; beside the card the button covers nothing.
    browser.wait("document.querySelector('#tally .findings li')");
    // A sample of the feasible designs lies behind the front, and another result may be laid over it.
    browser.wait("!document.querySelector('#sample').hidden && document.querySelector('#sample').innerText.includes('behind the front')");
    assert_eq!(browser.number("document.querySelectorAll('#others button[data-testid=load-other]').length"), 1.0);
    let covered = "(() => { const of = (it) => it.getBoundingClientRect(); const own = of(document.querySelector('#open-knee')); \
         return [...document.querySelectorAll('#overview dl, #overview p, #overview li, #overview h1, #overview summary, #live')].filter((it) => it.checkVisibility()).map((it) => [it, of(it)]) \
         .filter(([, it]) => it.left < own.right - 0.5 && own.left < it.right - 0.5 && it.top < own.bottom - 0.5 && own.top < it.bottom - 0.5) \
         .map(([it]) => it.outerHTML); })()";
    assert_eq!(browser.evaluate(covered), serde_json::json!([]));
    browser.picture("explore-card");
    // All of this is in the address.
    browser.wait("location.hash.includes('s=constraints.stress_margin.min') && /p=[0-9]+,[0-9]+/.test(location.hash)");
    let hash = browser.text("location.hash");
    let address = explored.address.split("/?").next().expect("it has a host").to_owned();
    browser.go_to_address(&format!("{address}/{hash}"));
    answered(&mut browser);
    assert_eq!(browser.text("beltspace.page.changeList().join()"), first, "{hash}");
    assert_eq!(browser.number("beltspace.page.front.rows"), after);
    assert_eq!(browser.number("beltspace.page.pins().length"), 2.0, "{hash}");
    // Saved: the text is a study that gives this front.
    let saved = browser.text("beltspace.page.data.study.text");
    let study = Study::parse_in(&saved, "saved.toml", folder.path()).expect("it is a study");
    assert_eq!(study.sweep(Options::default().engine(Engine::Cpu)).expect("it is swept").counts.front as f64, after);
    // What the engine refuses is told, and the next change is answered.
    browser.evaluate("beltspace.change({ 'friction': '-1' })");
    browser.wait("document.querySelector('#live').dataset.kind === 'error'");
    let said = browser.text("document.querySelector('#live-text').textContent");
    assert!(said.contains("out of range"), "{said}");
    browser.evaluate(COUNT);
    browser.evaluate("beltspace.page.undoChange()");
    answered(&mut browser);
    // Nothing feasible: by how much.
    browser.evaluate("beltspace.change({ 'constraints.stress_margin.min': '5' })");
    browser.wait("!document.querySelector('#lead').hidden && document.querySelector('#lead .findings')");
    let said = browser.text("document.querySelector('#lead').innerText");
    assert!(said.contains("the best of all designs has") || said.contains("lets"), "{said}");
    browser.picture("explore-none");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn designs_that_a_first_front_lacks_stay_pinned_and_on_the_card() {
    let (_folder, file) = study_file(&SMALL.replace("count = 7 }", "count = 1401 }").replace("step = 0.02", "count = 151"));
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    browser.wait("document.querySelector('#open-knee')");
    browser.evaluate(COUNT);
    browser.evaluate("beltspace.change({ 'fixed.strength_MPa': '790' })");
    answered(&mut browser);
    // Of the exact front, in the middle of the objectives' ranges: no coarser grid has them all.
    browser.evaluate("(() => { const n = beltspace.page.front.rows; for (const at of [n >> 2, n >> 1, (3 * n) >> 2]) beltspace.page.pin(at); beltspace.openCard(n >> 1); })()");
    browser.wait("location.hash.includes('d=') && (location.hash.match(/p=[^&]*/)?.[0].split('%2C').join(',').split(',').length === 3)");
    let hash = browser.text("location.hash");
    let pins = "beltspace.page.pins().map((it) => it.letter + it.design).join()";
    let (pinned, card) = (browser.text(pins), browser.text("beltspace.page.designOf(beltspace.page.state.card)"));
    // Of every front that is shown: does it lack the design of the card, and what becomes of the card and the pins?
    let watch = format!(
        "(() => {{ window.seen = []; beltspace.page.events.on('front.test', () => seen.push({{ \
         lacks: beltspace.page.rowOf('{card}') < 0, hidden: document.querySelector('#card').hidden, inert: document.querySelector('#card').inert, \
         waits: beltspace.page.awaitsPins() }})); }})()"
    );
    browser.evaluate(&watch);
    // The study changes: the card goes through a front that lacks its design.
    browser.evaluate(COUNT);
    browser.evaluate("beltspace.change({ 'fixed.strength_MPa': '791' })");
    answered(&mut browser);
    assert_ne!(browser.number("window.seen.filter((it) => it.lacks).length"), 0.0, "no first front: the test sees nothing");
    assert_eq!(
        browser.evaluate("window.seen.every((it) => !it.hidden && it.inert === it.lacks)"),
        true,
        "{}",
        browser.evaluate("window.seen")
    );
    assert_eq!(browser.text("beltspace.page.designOf(beltspace.page.state.card)"), card);
    // The address is entered again, first in the page, then in a new one.
    browser.evaluate(COUNT);
    browser.evaluate(&format!("(() => {{ window.seen = []; location.hash = {hash:?}; }})()"));
    browser.wait("window.seen.length > 0");
    answered(&mut browser);
    assert_ne!(browser.number("window.seen.filter((it) => it.lacks).length"), 0.0, "no first front: the test sees nothing");
    // The certified front of before may come in between.
    assert_eq!(browser.evaluate("window.seen.some((it) => it.waits) && !window.seen.at(-1).waits"), true, "no first front lacks a pin");
    assert_eq!(browser.text(pins), pinned);
    assert_eq!(browser.text("beltspace.page.designOf(beltspace.page.state.card)"), card);
    // What is refused after a first front leaves no card that nobody can use; it comes back with its front.
    browser.evaluate(
        "(() => { const ask = beltspace.page.ask; let over = false; \
         beltspace.page.ask = (path, question, each, signal) => ask(path, question, (told, buffer) => { if (over) return; each(told, buffer); \
         if (path !== '/answer' || beltspace.page.state.awaited === null) return; \
         over = true; beltspace.page.ask = ask; each({ kind: 'error', message: 'no' }, buffer); }, signal); })()",
    );
    browser.evaluate("beltspace.change({ 'fixed.strength_MPa': '792' })");
    browser.wait("document.querySelector('#live').dataset.kind === 'error'");
    assert_eq!(browser.evaluate("document.querySelector('#card').hidden && !document.querySelector('#card').inert"), true);
    browser.evaluate(COUNT);
    browser.evaluate("beltspace.page.undoChange()");
    answered(&mut browser);
    browser.wait(&format!("!document.querySelector('#card').hidden && beltspace.page.designOf(beltspace.page.state.card) === '{card}'"));
    browser.evaluate(COUNT);
    browser.evaluate("beltspace.change({ 'fixed.strength_MPa': '793' })");
    answered(&mut browser);
    let address = explored.address.split("/?").next().expect("it has a host").to_owned();
    browser.go_to_address(&format!("{address}/{hash}"));
    answered(&mut browser);
    assert!(browser.number("beltspace.timings.coarse || beltspace.timings.few") > 0.0, "no first front: the test sees nothing");
    browser.wait("!document.querySelector('#card').hidden");
    assert_eq!(browser.text(pins), pinned);
    assert_eq!(browser.text("beltspace.page.designOf(beltspace.page.state.card)"), card);
    assert_eq!(browser.evaluate("document.querySelector('#card').inert"), false);
    browser.wait(&format!("location.hash === {hash:?}"));
    // A card whose design the exact front lacks too stays, and says why it is not there; it is on the front again with the study of before.
    browser.evaluate(COUNT);
    browser.evaluate("beltspace.change({ 'constraints.stress_margin.min': String(Math.max(...beltspace.page.front.columns.find((it) => it.name === 'stress_margin').values) - 1e-9) })");
    answered(&mut browser);
    browser.wait("beltspace.page.state.known && beltspace.page.state.card === null && beltspace.page.state.awaited === null");
    let said = browser.text("document.querySelector('#card').innerText");
    assert!(said.starts_with(&format!("Design {card}")) && said.contains("\ninfeasible\n") && said.contains("Drawn to scale"), "{said}");
    let command = browser.text("document.querySelector('#evaluate').textContent");
    assert!(command.contains("--set constraints.stress_margin.min=") && command.ends_with(&format!("--design {card}")), "{command}");
    assert!(browser.text("document.querySelector('#readout').innerText").contains(&format!("design {card} (card, not on the front)")));
    let margin = "Number(document.querySelector('[data-name=\"margin of stress_margin\"]').dataset.value)";
    assert!(browser.number(margin) < 0.0, "{said}");
    assert_eq!(browser.evaluate("document.querySelector('#card').inert"), false);
    browser.wait("document.querySelector('#all-outputs table')");
    browser.evaluate(COUNT);
    browser.evaluate("beltspace.page.undoChange()");
    answered(&mut browser);
    browser.wait(&format!("beltspace.page.state.known === null && beltspace.page.designOf(beltspace.page.state.card) === '{card}'"));
    assert!(browser.text("document.querySelector('#card').innerText").contains("of the front"));
    browser.evaluate(COUNT);
    browser.evaluate("beltspace.page.redoChange()");
    answered(&mut browser);
    browser.wait("beltspace.page.state.known");
    // What was pinned before the change stays pinned, and is in the address with the changes that it is of.
    browser.wait(&format!("location.hash.includes('d={card}') && location.hash.includes('~')"));
    let hash = browser.text("location.hash");
    browser.go_to_address(&format!("{address}/#"));
    browser.wait("beltspace.page.pins().length === 0");
    browser.go_to_address(&format!("{address}/{hash}"));
    browser.wait(&format!("beltspace.page?.pins().length === {}", pinned.split(',').count()));
    assert_eq!(browser.text(pins), pinned);
    // So is the card of the address, and there is none of a design that the study has not.
    browser.wait(&format!("beltspace.page.state.known?.design === '{card}' && !document.querySelector('#card').hidden"));
    // Again until it is taken: the page may be about to write its own.
    browser.wait(
        "(() => { location.hash = location.hash.replace(/d=[0-9]+/, 'd=99999999999'); \
         return document.querySelector('#card').hidden && !document.querySelector('#card').inert; })()",
    );
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn a_front_that_is_there_already_or_has_nothing_is_not_drawn() {
    let (_folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    browser.wait("beltspace.timings.certified > 0");
    // In place of the engine's first fronts comes one that is the exact one, or one of nothing.
    browser.evaluate(
        "(() => { const ask = beltspace.page.ask; window.draws = 0; beltspace.page.events.on('front.test', () => { window.draws++; }); \
         beltspace.page.ask = (path, question, each, signal) => { let study; return ask(path, question, (told, buffer) => { \
         study = told.study ?? study; const { study: _, ...rest } = told; \
         if (told.kind === 'coarse' || told.kind === 'few') return; \
         if (path !== '/answer' || told.kind !== 'exact') return each(told, buffer); \
         const first = window.first === 'same' ? rest.front : { ...rest.front, rows: 0 }; \
         window.draws = 0; each({ ...rest, study, kind: 'few', in_scenarios: 3, front: first }, window.first === 'same' ? buffer : new ArrayBuffer(0)); \
         window.seen = [window.draws, beltspace.page.front.rows, document.querySelector('#matrix-section').hidden, document.querySelector('#live').dataset.kind]; \
         each(rest, buffer); window.seen.push(window.draws, beltspace.page.front.rows, document.querySelector('#live').dataset.kind); }, signal); }; })()",
    );
    let mut seen = |first: &str, strength: u32| {
        browser.evaluate(&format!("(() => {{ window.first = '{first}'; }})()"));
        browser.evaluate(COUNT);
        browser.evaluate(&format!("beltspace.change({{ 'fixed.strength_MPa': '{strength}' }})"));
        answered(&mut browser);
        (browser.evaluate("window.seen"), browser.number("beltspace.page.front.rows"))
    };
    let (same, rows) = seen("same", 780);
    assert!(rows > 0.0, "there is something to draw");
    assert_eq!(same, serde_json::json!([1, rows as u64, false, "coarse", 1, rows as u64, "exact"]));
    let (nothing, others) = seen("nothing", 760);
    assert_eq!(nothing, serde_json::json!([0, rows as u64, false, "coarse", 1, others as u64, "exact"]));
    // The values of the exact front are those of a fresh sweep of what is shown.
    assert_eq!(differs(&mut browser, SMALL, file.parent().expect("it has a folder")), None);
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn an_input_that_varies_for_the_first_time_becomes_an_axis() {
    let (_folder, file) = study_file(&SMALL.replace("[constraints]\n", "[constraints]\ntraction = { max = 0.32 }\n"));
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    let axes = "beltspace.page.state.parallel.join()";
    let drawn = "[...document.querySelectorAll('#parallel .axis-head')].length === beltspace.page.state.parallel.length";
    let up_to = |browser: &mut Browser, most: &str| {
        browser.evaluate(COUNT);
        browser.evaluate(&format!("beltspace.change({{ 'constraints.traction.max': '{most}' }})"));
        answered(browser);
        browser.wait(drawn);
        browser.text(axes)
    };
    // All designs of the front have a traction of 0.3, and thin bands; then some have 0.35, and thicker ones.
    let constant = browser.text(axes);
    assert!(!constant.contains("traction"), "{constant}");
    let varying = up_to(&mut browser, "0.37");
    assert_eq!(varying, constant.replace("groove_angle_deg", "groove_angle_deg,band_thickness_mm,traction"));
    // An axis stays where it varies no more, and one that was taken away does not come back.
    assert_eq!(up_to(&mut browser, "0.32"), varying);
    browser.evaluate("beltspace.page.chooseColumns('parallel', beltspace.page.state.parallel.filter((it) => it !== 'traction'))");
    assert_eq!(up_to(&mut browser, "0.42"), varying.replace("traction,", ""));
    assert_eq!(browser.complaints, Vec::<String>::new());
}

/// Rules of axe that it finds broken, with the elements.
pub fn broken_rules(browser: &mut Browser, axe: &str) -> Vec<String> {
    browser.evaluate(&format!("{axe}; 1"));
    let found = browser.evaluate("axe.run(document, { resultTypes: ['violations'] }).then((it) => it.violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.target.join(' ')).join(', ').slice(0, 300)}`))");
    serde_json::from_value(found).expect("texts")
}

/// The script of axe-core, from npm or, on a machine without it, from a Python package that brings it along.
pub fn axe() -> String {
    let folder = tempfile::tempdir().expect("there is room");
    let path = |name: &str| folder.path().join(name);
    let run = |program: &Path, words: &[&str]| {
        let done = Command::new(program).args(words).current_dir(folder.path()).stdin(Stdio::null()).output();
        done.map_err(|error| error.to_string()).and_then(|it| match it.status.success() {
            true => Ok(()),
            false => Err(String::from_utf8_lossy(&it.stderr).into_owned()),
        })
    };
    let read = |name: &str| std::fs::read_to_string(path(name)).map_err(|error| format!("{name}: {error}"));
    let npm = run(Path::new("npm"), &["install", "--silent", "--no-audit", "--no-fund", "--prefix", ".", "axe-core@4"]);
    let script = npm.and_then(|()| read("node_modules/axe-core/axe.min.js")).or_else(|npm| {
        run(Path::new("python3"), &["-m", "venv", "own"])
            .and_then(|()| {
                run(&path("own/bin/pip"), &["install", "--quiet", "--no-deps", "--target", "package", "axe-playwright-python==0.1.*"])
            })
            .and_then(|()| read("package/axe_playwright_python/axe.min.js"))
            .map_err(|pip| format!("npm: {npm}; pip: {pip}"))
    });
    script.unwrap_or_else(|error| panic!("axe-core, which looks for what keeps people out, cannot be installed. {error}"))
}

/// The least contrast of the marks that are drawn on the plots: of every colour of both scales, of points behind and of unselected ones.
pub const CONTRAST: &str = "(() => { const light = (c) => { const { r, g, b } = d3.rgb(c); const f = (v) => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; \
     return 0.2126 * f(r) + 0.7152 * f(g) + 0.0722 * f(b); }; const p = beltspace.page; const ground = light(p.variable('--plot')); \
     const ratio = (c) => { const l = light(c); return (Math.max(l, ground) + 0.05) / (Math.min(l, ground) + 0.05); }; \
     const marks = [...[p.ramp(), p.areaRamp()].flatMap((ramp) => d3.range(0, 1.001, 0.02).map(ramp)), ...['--sample', '--ghost', '--faint', '--muted', '--knee', '--ink', '--accent', '--other-square', '--other-cross', '--other-diamond', '--alone', '--shared', '--good'].map(p.variable)]; \
     const onWhite = (c) => 1.05 / (light(c) + 0.05); \
     return Math.min(...marks.map(ratio), ...p.contourColours.map(onWhite)); })()";

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn the_page_is_clear_to_everybody_in_both_themes_and_on_narrow_screens() {
    let (_folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    browser.wait("beltspace.timings.counted > 0");
    browser.evaluate("beltspace.openCard(0); beltspace.page.pin(0); beltspace.page.pin(3)");
    browser.wait("document.querySelectorAll('#around svg.slice').length >= 4 && document.querySelector('#all-outputs table')");
    let axe = axe();
    for theme in ["light", "dark"] {
        browser.evaluate(&format!("(() => {{ beltspace.state.theme = '{theme}'; beltspace.page.applyTheme(); }})()"));
        assert_eq!(browser.text("document.documentElement.dataset.theme"), theme);
        let contrast = browser.number(CONTRAST);
        assert!(contrast >= 3.0, "{theme}: {contrast}");
        browser.picture(&format!("explore-{theme}"));
        assert_eq!(broken_rules(&mut browser, &axe), Vec::<String>::new(), "{theme}");
    }
    browser.evaluate("document.querySelector('#undo').removeAttribute('aria-label'); document.querySelector('#undo').textContent = ''; document.querySelector('#undo').title = ''");
    assert!(!broken_rules(&mut browser, &axe).is_empty(), "a button without a name would go unseen");
    browser.evaluate("beltspace.closeCard()");
    browser.resize(400, 800);
    std::thread::sleep(Duration::from_millis(600));
    let wide = browser.number("document.documentElement.scrollWidth");
    browser.picture("explore-narrow");
    assert!(wide <= 400.0, "{wide} px wide");
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn a_slider_is_moved_with_the_keyboard_and_what_comes_of_it_is_told() {
    let (_folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &["--set", "strength_MPa=750"]);
    let mut browser = open(&explored);
    assert_eq!(browser.text("document.querySelector('#controls input[type=text][data-part=strength_MPa]').value"), "750");
    let part = "constraints.slip_margin.min";
    browser.evaluate(COUNT);
    browser.evaluate(&format!("document.querySelector('#controls input[type=range][data-part=\"{part}\"]').focus()"));
    browser.key("ArrowRight", 39);
    answered(&mut browser);
    assert!(browser.number(&format!("Number(beltspace.page.changedValue('{part}'))")) > 0.0);
    assert_eq!(browser.text("document.querySelector('#live-text').getAttribute('aria-live')"), "polite");
    browser.wait("document.querySelector('#live-text').textContent.startsWith('exact: ')");
    // Ctrl+Z takes it back.
    browser.evaluate(COUNT);
    browser.control_key('z');
    answered(&mut browser);
    assert_eq!(browser.text("beltspace.page.changeList().join()"), "");
    let start = Instant::now();
    drop(explored);
    browser.evaluate("beltspace.change({ 'strength_MPa': '700' })");
    browser.wait("document.querySelector('#live').dataset.kind === 'error'");
    assert!(start.elapsed() < Duration::from_secs(20));
}
