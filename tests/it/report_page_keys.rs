//! Pages with the keyboard, and for those who hear them: the focus stays where it was, rows of buttons are one stop, what changes is said.

use crate::browser::Browser;
use crate::explore_page::{COUNT, Explored, SMALL, answered, axe, broken_rules, open, study_file};
use crate::explore_page_controls::DRAWN;
use crate::report_page::Swept;

/// What has the focus, by its name or its text.
fn focused(browser: &mut Browser) -> String {
    browser
        .text("((it) => it.dataset.focus || it.id || it.getAttribute('aria-label') || it.dataset.x || it.tagName)(document.activeElement)")
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn the_focus_stays_where_it_was_when_a_part_of_the_page_is_drawn_anew() {
    let swept = Swept::shipped("metal-cvt");
    let mut browser = Browser::open(&swept.page(), "");
    let press = |browser: &mut Browser, selector: &str| {
        browser.press(selector);
        browser.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))");
    };
    // Chips of selections, until none is left.
    browser.evaluate("beltspace.brushAxis('reserve', [1.45, 1.62]); beltspace.brushAxis('slip_margin', [0.1, 0.2])");
    browser.wait("document.querySelectorAll('#chips button').length === 2");
    press(&mut browser, "#chips button");
    assert!(focused(&mut browser).starts_with("Remove the selection slip_margin"), "{}", focused(&mut browser));
    press(&mut browser, "#chips button");
    assert_ne!(focused(&mut browser), "BODY");
    // Pins: what is compared, and a pin that is taken away.
    browser.evaluate("[0, 1, 2].forEach((row) => beltspace.page.pin(row))");
    browser.press("#only-differences");
    assert_eq!(focused(&mut browser), "only-differences");
    press(&mut browser, "[data-focus='unpin B']");
    assert_ne!(focused(&mut browser), "BODY");
    let said = browser.text("document.querySelector('#said').textContent");
    assert!(said.ends_with("is no longer pinned"), "{said}");
    // The same control, where it is still there.
    press(&mut browser, "[data-focus='unpin C']");
    press(&mut browser, "[data-focus='unpin A']");
    assert_ne!(focused(&mut browser), "BODY", "without any pin the plots have it");
    // A column is sorted by the same button once more.
    press(&mut browser, "[data-focus='sort axial_force_upper_N']");
    assert_eq!(focused(&mut browser), "sort axial_force_upper_N");
    assert_eq!(browser.text("document.querySelector('#said').textContent"), "sorted by axial_force_upper_N, the least first");
    press(&mut browser, "[data-focus='sort axial_force_upper_N']");
    assert_eq!(browser.text("document.querySelector('[data-column=axial_force_upper_N]').ariaSort"), "descending");
    // An axis goes to the left until it is there; then its other buttons have the focus.
    let axis = browser.text("beltspace.state.parallel[1]");
    press(&mut browser, &format!("[data-focus='left {axis}']"));
    assert_eq!(browser.text("beltspace.state.parallel[0]"), axis);
    assert!(focused(&mut browser).ends_with(&axis), "{}", focused(&mut browser));
    // Buttons of all axes are one stop, and so is a table with its head; arrows go on.
    browser.evaluate("[0, 1].forEach((row) => beltspace.page.pin(row)); document.querySelector('#weigh details').open = true");
    browser.wait("document.querySelector('#ranked .pin-name')");
    for stop in ["#parallel .axis-buttons button", "#designs :is(button, tr)", ".pins :is(button, tr)", "#ranked :is(button, tr, div)"] {
        assert_eq!(browser.number(&format!("document.querySelectorAll({:?}).length", format!("{stop}[tabindex='0']"))), 1.0, "{stop}");
    }
    browser.evaluate("document.querySelector('#designs tbody tr').focus()");
    browser.key("ArrowUp", 38);
    browser.key("ArrowRight", 39);
    assert_eq!(browser.number("[...document.querySelectorAll('#designs thead button')].indexOf(document.activeElement)"), 1.0);
    browser.key("ArrowDown", 40);
    assert_eq!(browser.evaluate("document.activeElement === document.querySelector('#designs tbody tr')"), true);
    browser.key("ArrowUp", 38);
    browser.key("End", 35);
    assert_eq!(browser.evaluate("document.activeElement === [...document.querySelectorAll('#designs thead button')].pop()"), true);
    // Who goes through cards hears which one it is, and which design weights put first.
    browser.evaluate("beltspace.openCard(3)");
    press(&mut browser, "#card-next");
    let next = browser.text("`design ${beltspace.page.designOf(4)}`");
    assert!(browser.text("document.querySelector('#said').textContent").starts_with(&next));
    browser.evaluate("beltspace.page.setWeight('axial_force_upper_N', 90)");
    browser.wait(
        "document.querySelector('#said').textContent === `first by weights: design ${beltspace.page.designOf(beltspace.page.chosenRow())}`",
    );
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_live_page_keeps_the_focus_and_a_press_while_the_front_changes() {
    let (_folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    for value in ["0.05", "0.1"] {
        browser.evaluate(COUNT);
        browser.evaluate(&format!("beltspace.change({{ 'constraints.slip_margin.min': '{value}' }})"));
        answered(&mut browser);
    }
    // Everything at once, and back.
    browser.evaluate(COUNT);
    browser.press("#reset");
    answered(&mut browser);
    assert_eq!(browser.evaluate("beltspace.page.changeList()"), serde_json::json!([]));
    assert_eq!(focused(&mut browser), "undo");
    browser.evaluate(COUNT);
    browser.press("#undo");
    answered(&mut browser);
    // Undo, until there is nothing left to undo.
    for _ in 0..2 {
        browser.evaluate(COUNT);
        browser.press("#undo");
        answered(&mut browser);
    }
    assert_eq!(browser.evaluate("document.querySelector('#undo').disabled"), true);
    assert_eq!(focused(&mut browser), "redo");
    // A bound that was added, and taken away.
    browser.evaluate("beltspace.change({ 'constraints.reserve.max': '1.6', 'constraints.band_count.max': '12' })");
    browser.press("#added [aria-label$='take it away']");
    assert_ne!(focused(&mut browser), "BODY");
    assert_eq!(browser.number("document.querySelectorAll('#added [aria-label$=\"take it away\"]').length"), 1.0);
    answered(&mut browser);
    browser.wait("beltspace.timings.counted === beltspace.timings.answered");
    // A new front comes while a button of the card is held down.
    browser.evaluate("beltspace.openCard(10)");
    let [left, top, width, height] = browser.rectangle("#card-pin");
    browser.mouse("mouseMoved", left + width / 2.0, top + height / 2.0);
    browser.mouse("mousePressed", left + width / 2.0, top + height / 2.0);
    let design = browser.text("beltspace.page.designOf(10)");
    browser.evaluate(COUNT);
    browser.evaluate("window.pressed = document.querySelector('#card-pin'); beltspace.change({ 'constraints.slip_margin.min': '0.05' })");
    answered(&mut browser);
    let moved = browser.evaluate("beltspace.page.state.card ?? beltspace.page.state.known?.design");
    assert_ne!(moved, 10, "its row is the same: the test sees nothing");
    assert_eq!(browser.evaluate("window.pressed.isConnected"), true);
    browser.mouse("mouseReleased", left + width / 2.0, top + height / 2.0);
    browser.wait("beltspace.page.pins().length === 1 && !window.pressed.isConnected");
    assert_eq!(browser.text("beltspace.page.pins()[0].design"), design);
    // A pin of a design that the exact front has not is there in another page too.
    browser.evaluate("beltspace.page.keepLost('1', beltspace.page.changeList())");
    browser.wait("beltspace.page.state.known?.design === '1'");
    browser.press("#card-pin");
    browser.wait(&format!("location.hash.includes('p={design},1')"));
    let hash = browser.text("location.hash");
    let address = explored.address.split("/?").next().expect("it has a host").to_owned();
    browser.go_to_address(&format!("{address}/{hash}"));
    answered(&mut browser);
    browser.wait("beltspace.page.pins().length === 2");
    assert_eq!(browser.text("beltspace.page.pins().map((it) => it.letter + it.design).join()"), format!("A{design},B1"));
    // A number that the study does not have closes the card for good.
    browser.evaluate("beltspace.openCard(0)");
    browser.evaluate("location.hash = location.hash.replace(/d=[0-9]+/, 'd=99999999999')");
    browser.wait("document.querySelector('#card').hidden && beltspace.page.state.card === null");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn pages_of_every_kind_are_clear_to_everybody() {
    let axe = axe();
    for name in ["pulley-design", "push-belt-yield", "timing-map", "catalogue-v-belts", "flat-belt", "metal-grid"] {
        let swept = Swept::shipped(name);
        let mut browser = Browser::open(&swept.page(), "");
        browser.evaluate("beltspace.data.front?.rows && beltspace.openCard(0)");
        for theme in ["light", "dark"] {
            browser.evaluate(&format!("(() => {{ beltspace.state.theme = '{theme}'; beltspace.page.applyTheme(); }})()"));
            assert_eq!(broken_rules(&mut browser, &axe), Vec::<String>::new(), "{name}, {theme}");
        }
        assert_eq!(browser.complaints, Vec::<String>::new(), "{name}");
    }
    // Without a feasible design, and with the list of columns open.
    let swept = Swept::text(&SMALL.replace("stress_margin = { min = 0 }", "stress_margin = { min = 50 }"));
    let mut browser = Browser::open(&swept.page(), "");
    assert_eq!(broken_rules(&mut browser, &axe), Vec::<String>::new(), "nothing is feasible");
    // Fields of distributions and of rows of cases.
    let (_folder, file) = study_file(DRAWN);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    browser.press("#columns");
    browser.wait("!document.querySelector('#chooser').hidden && document.querySelectorAll('#controls .case-rows').length === 1");
    assert_eq!(broken_rules(&mut browser, &axe), Vec::<String>::new(), "distributions");
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_live_page_makes_a_range_a_constraint_and_its_view_is_opened_again_by_a_command() {
    let (_folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    // A range that was typed, and one of a cell that is narrower on one side: the constraint is what both leave.
    browser.press("#columns");
    browser.evaluate(
        "(() => { const f = document.querySelector('[data-column=groove_angle_deg][data-bound=low]'); f.value = '19'; f.dispatchEvent(new Event('change', { bubbles: true })); \
         beltspace.chooseColumns('matrix', ['axial_force_N', 'groove_angle_deg', 'slip_margin']); \
         const { low, high } = beltspace.page.front.byName.get('axial_force_N'); beltspace.brushCell('axial_force_N', 'groove_angle_deg', [low, high], [18.5, 25]); })()",
    );
    browser.wait("document.querySelector('#make-constraint')");
    browser.evaluate(COUNT);
    browser.click_on("#make-constraint");
    answered(&mut browser);
    let changes = browser.text("beltspace.page.changeList().join()");
    assert!(
        changes.contains("constraints.groove_angle_deg.min=19") && changes.contains("constraints.groove_angle_deg.max=25"),
        "{changes}"
    );
    assert!(!changes.contains("min=18.5"), "{changes}");
    assert_eq!(browser.evaluate("beltspace.page.brushed()"), false);
    let widest = browser.number("beltspace.page.front.byName.get('groove_angle_deg').high");
    assert!((20.0..=25.0).contains(&widest), "{widest}");
    // A range, a pin, a weight and a card are a view.
    browser.evaluate("beltspace.brushAxis('slip_margin', [0, 0.2]); beltspace.page.pin(1); beltspace.page.setWeight('slip_margin', 80); beltspace.openCard(2)");
    browser.evaluate("beltspace.page.copyText = async (text) => { window.copied = text; return true; }");
    browser.click_on("[data-testid=copy-view]");
    browser.wait("window.copied");
    let command = browser.text("window.copied");
    let designs = browser.text("[1, 2].map(beltspace.page.designOf).join()");
    drop(browser);
    drop(explored);
    let (head, view) = command.split_once(" --view ").expect("the view");
    assert!(head.starts_with("beltspace explore ") && !head.contains("--set"), "{command}");
    let again = Explored::new(&file, &["--view", view.trim_matches('"')]);
    assert!(again.address.contains("#"), "{}", again.address);
    let mut browser = open(&again);
    browser.wait("beltspace.page.pins().length === 1 && beltspace.page.state.card !== null");
    assert_eq!(browser.text("[beltspace.page.pins()[0].design, beltspace.page.designOf(beltspace.page.state.card)].join()"), designs);
    assert_eq!(browser.evaluate("beltspace.state.axes.get('slip_margin')"), serde_json::json!([0, 0.2]));
    assert_eq!(browser.number("beltspace.page.weightOf('slip_margin')"), 80.0);
    assert_eq!(browser.number("beltspace.page.front.byName.get('groove_angle_deg').high"), widest);
    assert_eq!(browser.complaints, Vec::<String>::new());
}
