//! The controls of `beltspace explore` in Chromium: fields for rows, words, lists, distributions, and what people type into them.

use crate::browser::Browser;
use crate::explore_page::{COUNT, Explored, SMALL, answered, differs, open, study_file};
use crate::random::Random;

/// Types a number into the field of a part, as a person does who leaves it with Enter: what the field complains about, and what is in it.
fn typed(browser: &mut Browser, part: &str, text: &str) -> String {
    browser.evaluate(COUNT);
    let field = format!("document.querySelector('#controls input[type=text][data-part=\"{part}\"]')");
    browser.evaluate(&format!(
        "(() => {{ const f = {field}; f.focus(); f.value = '{text}'; f.dispatchEvent(new Event('input', {{ bubbles: true }})); \
         f.dispatchEvent(new Event('change', {{ bubbles: true }})); }})()"
    ));
    let told = browser.evaluate(&format!("(() => {{ const f = {field}; return f.validationMessage + '|' + f.value; }})()"));
    told.as_str().expect("a text").to_owned()
}

fn changes(browser: &mut Browser) -> Vec<String> {
    serde_json::from_value(browser.evaluate("beltspace.page.changeList()")).expect("texts")
}

/// Presses Ctrl+Z where the cursor is.
fn undo(browser: &mut Browser) {
    browser.evaluate(COUNT);
    browser.evaluate("document.activeElement.dispatchEvent(new KeyboardEvent('keydown', { key: 'z', ctrlKey: true, bubbles: true }))");
    answered(browser);
}

pub const DRAWN: &str = r#"
model = "metal-cvt"
[design]
band_count        = { from = 6, to = 12 }
band_thickness_mm = { from = 0.14, to = 0.2, step = 0.02 }
traction          = [0.3, 0.35, 0.4]
[operation]
cases = [{ ratio = 0.5, torque_Nm = 70 }, { ratio = 2, torque_Nm = 120 }]
[uncertainty]
friction       = { normal = { mean = 0.08, sd = 0.005 }, from = 0.06, to = 0.1 }
belt_length_mm = { plus = { triangular = [-1, 0, 1] } }
[probability]
draws   = 512
confirm = 1000
[fixed]
strength_MPa = 800
[constraints]
no_slip = { of = "slip_margin", min = 0 }
yield   = { min = 0.5 }
[objectives]
axial_force_N = { goal = "min", over_draws = { quantile = 0.9 } }
yield         = "max"
"#;

#[test]
#[ignore = "needs the browser of the Debian package chromium"]
fn rows_and_distributions_are_changed_in_fields_and_the_front_is_that_of_a_fresh_sweep() {
    let (folder, file) = study_file(DRAWN);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    for (part, text) in [
        ("operation.cases.2.torque_Nm", "110"),
        ("uncertainty.friction.normal.sd", "0.004"),
        ("uncertainty.belt_length_mm.plus.triangular.3", "1.5"),
        ("probability.draws", "600"),
        ("constraints.no_slip.min", "0.01"),
    ] {
        assert_eq!(typed(&mut browser, part, text), format!("|{text}"), "{part}");
        answered(&mut browser);
        assert!(changes(&mut browser).contains(&format!("{part}={text}")), "{part}");
        // What fresh draws say comes with the certified front.
        browser.wait("beltspace.timings.certified === beltspace.timings.answered");
        let wrong = differs(&mut browser, DRAWN, folder.path());
        assert_eq!(wrong, None, "{part}");
    }
    assert!(browser.evaluate("beltspace.page.front.rows").as_u64() > Some(0));
    // What is drawn has no slider as if it were fixed.
    let twice = browser
        .evaluate("['torque_Nm', 'ratio', 'friction'].filter((name) => document.querySelector(`#controls [data-part=\"${name}\"]`))");
    assert_eq!(twice, serde_json::json!([]));
}

#[test]
#[ignore = "needs the browser of the Debian package chromium"]
fn what_people_type_is_taken_as_it_is_meant_or_refused() {
    let (_folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    let part = "constraints.slip_margin.min";
    assert_eq!(typed(&mut browser, part, "0,05"), "|0.05");
    answered(&mut browser);
    assert_eq!(changes(&mut browser), ["constraints.slip_margin.min=0.05"]);
    // Thousands, or a decimal comma? Nothing changes, and what was typed stays to be mended.
    for text in ["1,500", "x", "1..5"] {
        let told = typed(&mut browser, part, text);
        assert!(told.starts_with("This is no number") && told.ends_with(&format!("|{text}")), "{told}");
        assert_eq!(changes(&mut browser), ["constraints.slip_margin.min=0.05"]);
    }
    assert_eq!(typed(&mut browser, "strength_MPa", "1 000"), "|1000");
    answered(&mut browser);
    // Undone from within the field.
    undo(&mut browser);
    assert_eq!(changes(&mut browser), ["constraints.slip_margin.min=0.05"]);
    let field = "document.querySelector('#controls input[type=text][data-part=\"strength_MPa\"]').value";
    assert_eq!(browser.evaluate(field), "800");
    // A constraint that counts again has the bound that it had.
    let click = "document.querySelector('#controls [data-control=\"constraints.slip_margin\"] input[type=checkbox]').click()";
    for wanted in ["constraints.slip_margin=off", "constraints.slip_margin.min=0.05"] {
        browser.evaluate(COUNT);
        browser.evaluate(click);
        answered(&mut browser);
        assert_eq!(changes(&mut browser), [wanted]);
    }
    // Another page at this address has nothing to undo.
    browser.wait("location.hash.includes('slip_margin.min') && !location.hash.includes('strength')");
    let address = browser.evaluate("location.href");
    drop(browser);
    let mut browser =
        Browser::open_at(&(explored.address.clone() + address.as_str().and_then(|it| it.find('#').map(|at| &it[at..])).expect("changes")));
    answered(&mut browser);
    assert_eq!(changes(&mut browser), ["constraints.slip_margin.min=0.05"]);
    assert_eq!(browser.evaluate("document.querySelector('#undo').disabled"), true);
    // The slider of one end of an axis stops where the other end is.
    browser.evaluate(COUNT);
    browser.evaluate(
        "(() => { const s = document.querySelector('#controls input[type=range][data-part=\"design.groove_angle_deg.from\"]'); \
         s.value = s.max; s.dispatchEvent(new Event('input', { bubbles: true })); s.dispatchEvent(new Event('change', { bubbles: true })); })()",
    );
    answered(&mut browser);
    assert!(changes(&mut browser).contains(&"design.groove_angle_deg.from=29.9".to_owned()), "{:?}", changes(&mut browser));
}

#[test]
#[ignore = "needs the browser of the Debian package chromium"]
fn while_nothing_comes_the_line_says_that_what_is_shown_is_older() {
    let (_folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    // An engine that does not answer.
    browser.evaluate("(() => { window.asked = beltspace.page.ask; beltspace.page.ask = () => new Promise(() => {}); })()");
    browser.evaluate("beltspace.change({ strength_MPa: 700 })");
    browser.wait("document.querySelector('#live-text').textContent === 'computing …; what is shown is of the study before the change'");
    // The head is dimmed until the answer is there.
    let is_older = "document.body.classList.contains('older')";
    assert_eq!(browser.evaluate(is_older), true);
    browser.evaluate(COUNT);
    browser.evaluate("(() => { beltspace.page.ask = window.asked; beltspace.change({ strength_MPa: 710 }); })()");
    answered(&mut browser);
    browser.wait("document.querySelector('#live-text').textContent.startsWith('exact')");
    assert_eq!(browser.evaluate(is_older), false);
    browser.wait("[...document.querySelectorAll('.slice-row h3')].filter((it) => it.textContent.endsWith(', the largest')).length === 3");
    // What is around a design follows the weights, as all else does, until a card is open.
    browser.evaluate("(() => { const e = document.querySelector('[data-weight=axial_force_N]'); e.value = 100; e.dispatchEvent(new Event('input', { bubbles: true })); })()");
    browser.wait("beltspace.page.chosenRow() !== beltspace.page.front.knee");
    browser.wait("document.querySelector('#around-title')?.textContent === `Around design ${beltspace.page.designOf(beltspace.page.chosenRow())} (${beltspace.page.chosenWord()})`");
}

#[test]
#[ignore = "needs the browser of the Debian package chromium"]
fn words_and_long_lists_are_chosen_from() {
    let text = SMALL.replace("torque_Nm = [50, 150]", "torque_Nm = [50, 60, 70, 80, 90, 100, 110, 120, 150]");
    let text = text.replace("{ from = 0.30, to = 0.50, count = 5 }", "[\"limit\", 0.3, 0.4]");
    let (folder, file) = study_file(&text);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    let told = typed(&mut browser, "operation.torque_Nm", "50 100; 140");
    assert!(told.starts_with('|'), "{told}");
    answered(&mut browser);
    assert_eq!(changes(&mut browser), ["operation.torque_Nm=[50, 100, 140]"]);
    assert_eq!(differs(&mut browser, &text, folder.path()), None);
    // Levels of which some are words.
    let told = typed(&mut browser, "design.traction", "0,35 limit nowhere");
    assert!(told.contains("Write numbers, or limit with a space between them"), "{told}");
    assert_eq!(typed(&mut browser, "design.traction", "0,35 limit"), "|0.35, limit");
    answered(&mut browser);
    assert_eq!(changes(&mut browser), ["operation.torque_Nm=[50, 100, 140]", "design.traction=[0.35, \"limit\"]"]);
    assert_eq!(differs(&mut browser, &text, folder.path()), None);
    // Words of a pulley that are levels, and a word in place of a number.
    let text = "model = \"pulley-load\"\n[design]\nwidth_known = [1]\n";
    drop(browser);
    let text = text
        .replace("width_known = [1]", "tensioning = [\"fixed-centres\", \"slack\"]\nmean_radius_mm = { from = 50, to = 90, step = 10 }")
        + "[operation]\ncases = [{ power_kW = 2, speed_rpm = 1450 }]\n[fixed]\ninstalled_tension_N = 300\n\
           [objectives]\nmean_radius_mm = \"min\"\nfriction_margin = \"max\"\n\
           [report]\ncolumns = [\"tight_tension_N\", \"resultant_force_N\", \"torque_Nm\"]\n";
    let (folder, file) = study_file(&text);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    let click = "document.querySelector('#controls input[type=checkbox][data-part=\"design.tensioning\"][value=\"slack\"]').click()";
    browser.evaluate(COUNT);
    browser.evaluate(click);
    answered(&mut browser);
    assert_eq!(changes(&mut browser), ["design.tensioning=[\"fixed-centres\"]"]);
    assert_eq!(differs(&mut browser, &text, folder.path()), None);
}

#[test]
#[ignore = "needs the browser of the Debian package chromium"]
fn a_page_begins_with_what_the_command_sets_and_its_saved_study_runs_anywhere() {
    let text = SMALL.replace("[design]\n", "[design]\ncases = { csv = \"widths.csv\" }\n");
    let (folder, file) = study_file(&text);
    std::fs::write(folder.path().join("widths.csv"), "band_width_mm,belt_length_mm\n9,703\n9.5,703\n").expect("it can be written");
    // A whole axis is replaced, and a bound.
    let set = ["--set", "friction=0.08", "--set", "constraints.slip_margin.min=0.02"];
    let explored = Explored::new(&file, &set);
    let mut browser = open(&explored);
    assert_eq!(changes(&mut browser), Vec::<String>::new());
    let field = |part: &str| format!("document.querySelector('#controls input[type=text][data-part=\"{part}\"]')?.value ?? null");
    assert_eq!(browser.evaluate(&field("constraints.slip_margin.min")), "0.02");
    assert_eq!(browser.evaluate(&field("friction")), "0.08");
    assert_eq!(browser.evaluate(&field("uncertainty.friction.from")), serde_json::Value::Null);
    assert_eq!(typed(&mut browser, "constraints.slip_margin.min", "0.03"), "|0.03");
    answered(&mut browser);
    browser.wait("document.querySelector('#command').textContent.endsWith('--set friction=0.08 --set constraints.slip_margin.min=0.03')");
    // The downloaded study finds the rows wherever it stands.
    let saved = browser.evaluate("beltspace.page.data.study.saved");
    let elsewhere = tempfile::tempdir().expect("there is room");
    let study = beltspace::Study::parse_in(saved.as_str().expect("a text"), "study.toml", elsewhere.path());
    let hash = browser.evaluate("beltspace.page.data.study.hash");
    assert_eq!(study.expect("it is right").hash(), hash.as_str().expect("a text"));
    let shown = browser.evaluate("beltspace.page.data.study.text");
    assert!(shown.as_str().is_some_and(|text| text.contains("csv = \"widths.csv\"")), "{shown}");
}

#[test]
#[ignore = "needs the browser of the Debian package chromium"]
fn what_is_saved_and_copied_is_the_study_as_it_is_changed_now() {
    let (_folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    browser.evaluate(
        "beltspace.page.download = (name, type, text) => (window.saved = text); beltspace.page.copyText = (text) => (window.copied = text)",
    );
    // Pressed before any answer can be there.
    browser.evaluate("beltspace.change({ 'constraints.slip_margin.min': '0.0475' }), document.querySelector('#save').click(), document.querySelector('[data-testid=copy-command]').click()");
    browser.wait("window.saved && window.copied");
    let (saved, copied) = (browser.text("window.saved"), browser.text("window.copied"));
    assert!(saved.contains("min = 0.0475") && copied.ends_with("--set constraints.slip_margin.min=0.0475"), "{saved} {copied}");
    // A change that nothing can answer is not left out in silence.
    browser.evaluate("window.saved = null, beltspace.change({ 'operation.no_such_input': '1' }), document.querySelector('#save').click()");
    browser.wait("document.querySelector('#done').textContent.startsWith('not saved: ') && beltspace.page.isAnswered()");
    assert_eq!(browser.evaluate("window.saved"), serde_json::Value::Null);
    // The engine's own line, which came with it or after it, left it alone.
    assert!(browser.text("document.querySelector('#done').textContent").contains("operation.no_such_input"));
    assert!(browser.text("document.querySelector('#live-text').textContent").contains("operation.no_such_input"));
    assert_eq!(browser.text("document.querySelector('#done').dataset.kind"), "error");
    // The next change puts it away; then it tells the name of what is saved.
    browser.evaluate("beltspace.change({ 'operation.no_such_input': null })");
    assert_eq!(browser.text("document.querySelector('#done').textContent"), "");
    browser.evaluate("document.querySelector('#save').click()");
    browser.wait("window.saved");
    browser.wait("document.querySelector('#done').textContent === 'saved as study-explored.toml'");
    // Nothing moves above the plots, and nothing is said of a study that has changed meanwhile.
    let place = "(() => { const at = document.querySelector('#save').getBoundingClientRect(); return [at.left, at.top, document.querySelector('#live').offsetHeight].join(); })()";
    let said = browser.text(place);
    browser.evaluate(
        "document.querySelector('#save').click(), beltspace.change({ 'constraints.slip_margin.min': '0.05' }), window.saved = null",
    );
    browser.wait("window.saved && beltspace.page.isAnswered()");
    assert_eq!(browser.text("document.querySelector('#done').textContent"), "");
    assert_eq!(browser.text(place), said);
}

#[test]
#[ignore = "needs the browser of the Debian package chromium"]
fn no_control_is_under_the_head_of_the_panel_when_the_focus_goes_back_to_it() {
    let (_folder, file) = study_file(DRAWN);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    browser.resize(1366, 500);
    let mut covered = || {
        browser.evaluate("document.querySelector('#theme').focus()");
        let mut found = 0;
        for _ in 0..50 {
            browser.shift_tab();
            found += usize::from(
                browser.evaluate(
                    "(() => { const at = document.activeElement; const head = document.querySelector('.controls-head'); \
                     return at.closest('#controls') !== null && !head.contains(at) && at.getBoundingClientRect().top < head.getBoundingClientRect().bottom - 1; })()",
                ) == true,
            );
        }
        // Without its rule the panel lets them go there.
        browser.evaluate("document.querySelector('#controls').style.scrollPaddingTop = '0'");
        found
    };
    assert_eq!(covered(), 0);
    assert!(covered() > 0, "this test sees nothing");
}

#[test]
#[ignore = "needs the browser of the Debian package chromium"]
fn slices_go_over_fixed_values_too_and_the_yield_stands_with_its_interval() {
    let (_folder, file) = study_file(DRAWN);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    browser
        .wait("beltspace.page.front.byName.has('yield_low') && beltspace.page.front.byName.get('yield_low').values.some(Number.isFinite)");
    browser.evaluate("beltspace.openCard(0)");
    browser.wait("[...document.querySelectorAll('.slice-row h3')].some((it) => it.textContent === 'strength_MPa')");
    // They come behind those of the axes, under a heading of their own.
    let order = browser
        .evaluate("[...document.querySelectorAll('.slices > *')].map((it) => it.querySelector('h3')?.textContent ?? it.textContent)");
    let order: Vec<String> = serde_json::from_value(order).expect("texts");
    let place = |name: &str| order.iter().position(|it| it == name).unwrap_or_else(|| panic!("{name} in {order:?}"));
    assert!(
        place("band_count") < place("With other loads, uncertainties and fixed values")
            && place("With other loads, uncertainties and fixed values") < place("strength_MPa")
    );
    // Loads that every draw must survive too.
    assert!(place("With other loads, uncertainties and fixed values") < place("torque_Nm, the largest"), "{order:?}");
    let said = browser.text("document.querySelector('.slices').textContent");
    assert!(said.contains("not beyond its other values") && !said.contains("end of its slider"), "{said}");
    // What the study leaves at its default is folded up, drawn once it is opened, and only then saved.
    let fold = |browser: &mut Browser, is_open: bool| {
        browser.evaluate(&format!("document.querySelector('#around details.slice-group').open = {is_open}"));
    };
    let saved = "beltspace.page.pictureOf([document.querySelector('#around .slices')]).text.includes('over centre_distance_mm: ')";
    assert_eq!(browser.number("document.querySelectorAll('#around details.slice-group h3').length"), 0.0);
    fold(&mut browser, true);
    browser.wait("document.querySelector('#around details.slice-group h3')");
    assert!(browser.text("document.querySelector('#around details.slice-group').textContent").contains("as far as this looks"));
    assert_eq!(browser.evaluate(saved), true);
    fold(&mut browser, false);
    assert_eq!(browser.evaluate(saved), false);
    // The last feasible value and the next one are not the same number.
    browser.evaluate(
        "(() => { const box = document.createElement('div'); box.id = 'apart'; document.body.append(box); \
         beltspace.page.drawSlices(box, { columns: [{ name: 'margin', unit: '', doc: '' }], slices: [{ input: 'speed_rpm', unit: 'rpm', \
         own: 1450, words: null, at: [1431.9, 1432.1, 1450], feasible: [false, true, true], status: [null, null, null], \
         lines: [{ values: [-1, 1, 2], scenarios: [0, 0, 7] }] }], given_left_out: true }); })()",
    );
    let said = browser.text("document.querySelector('#apart').textContent");
    assert!(said.contains("to 1432.1 rpm; at 1431.9 rpm "), "{said}");
    // Another scenario is the worst at the last place; and what took too long to judge is said to be missing.
    assert_eq!(
        browser.evaluate("[...document.querySelectorAll('#apart .switch title')].map((it) => it.textContent)"),
        serde_json::json!(["from here on the worst scenario is #7"])
    );
    assert!(said.contains("Other loads, uncertainties and fixed values are left out"), "{said}");
    assert_eq!(browser.number("document.querySelectorAll('#around [data-testid=given-left-out]').length"), 0.0);
    // However long the value, the name beside it is whole.
    assert_eq!(browser.evaluate("[...document.querySelectorAll('#readout dt')].every((it) => it.scrollWidth <= it.clientWidth)"), true);
    let told = browser.evaluate("document.querySelector('#readout').textContent");
    let ends = browser.evaluate(
        "['yield_low', 'yield_high'].map((name) => beltspace.page.short(beltspace.page.front.byName.get(name).values[0])).join(' to ')",
    );
    assert!(told.as_str().is_some_and(|told| told.contains(ends.as_str().expect("a text"))), "{told} has no {ends}");
    let drawn = browser.evaluate("[...document.querySelectorAll('path.interval')].filter((it) => it.getAttribute('d')).length");
    assert!(drawn.as_u64() > Some(0), "the interval is drawn through the design");
}

/// Moves of sliders, boxes and fields in a row, most of them before the one before is answered.
#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn the_front_after_a_burst_of_moves_is_that_of_the_last() {
    let (folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    let random = &mut Random::new(23);
    let (mut asked, mut refused) = (0.0, 0);
    for burst in 0..20 {
        let (seed, before) = (random.whole(1, 1 << 30), browser.number("beltspace.timings.answers.length"));
        // Each move is another one, after 0 to 60 ms: some are answered in between, most are not.
        let moved = browser.number(&format!(
            "(async () => {{ let state = {seed}; const next = () => (state = (state * 48271) % 2147483647) / 2147483647; \
             const of = (selector) => [...document.querySelectorAll(`#controls ${{selector}}`)].filter((it) => it.closest('details').dataset.group !== 'others'); \
             let moves = 0; for (let i = 0; i < 8; i++) {{ const kind = next(); const before = String(beltspace.page.changeList()); \
             if (kind < 0.15) {{ const boxes = of('[data-group=constraints] input[type=checkbox]'); boxes[Math.floor(next() * boxes.length)].click(); }} \
             else if (kind < 0.4) {{ const fields = of('input[type=text]'); const field = fields[Math.floor(next() * fields.length)]; \
             field.value = String(Number(field.value) * (0.9 + 0.2 * next())); field.dispatchEvent(new Event('input', {{ bubbles: true }})); field.dispatchEvent(new Event('change', {{ bubbles: true }})); }} \
             else {{ const sliders = of('input[type=range]'); const slider = sliders[Math.floor(next() * sliders.length)]; \
             slider.value = Number(slider.min) + next() * (Number(slider.max) - Number(slider.min)); slider.dispatchEvent(new Event('input', {{ bubbles: true }})); }} \
             moves += Number(before !== String(beltspace.page.changeList())); await new Promise((done) => setTimeout(done, 60 * next())); }} return moves; }})()"
        ));
        asked += moved;
        browser.wait("beltspace.page.isAnswered()");
        if browser.evaluate("document.querySelector('#live').dataset.kind") == "error" {
            refused += 1;
        } else {
            assert_eq!(differs(&mut browser, SMALL, folder.path()), None, "burst {burst}: {moved} moves after {before} answers");
        }
        browser.evaluate(COUNT);
        browser.evaluate("beltspace.page.resetChanges()");
        answered(&mut browser);
        assert_eq!(differs(&mut browser, SMALL, folder.path()), None, "after burst {burst}");
    }
    let answers = browser.number("beltspace.timings.answers.length");
    eprintln!("20 bursts: {asked} moves, {answers} answers, {refused} refused");
    assert!(refused < 12 && answers < asked, "{answers} answers to {asked} moves, {refused} refused");
}
