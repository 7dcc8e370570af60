//! The page of a study with one objective: its designs along one axis, with all that a plot of two has.

use crate::browser::Browser;
use crate::explore_page::{COUNT, Explored, answered, open, study_file};
use crate::report_page::Swept;

const ONE: &str = r#"
model = "metal-cvt"
title = "One objective"
[design]
groove_angle_deg = { from = 18, to = 30, count = 13 }
band_count       = { from = 6, to = 14 }
[operation]
torque_Nm = [50, 100]
[constraints]
band_count = { min = 7, max = 30 }
[objectives]
band_count = "min"
[report]
sample = 50
"#;

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn one_objective_has_marks_pins_limits_the_sample_and_other_results() {
    let swept = Swept::text(ONE);
    assert_eq!(swept.front().len(), 1, "of equal designs the first");
    let mut browser = Browser::open(&swept.page(), "");
    let count = |browser: &mut Browser, selector: &str| browser.number(&format!("document.querySelectorAll({selector:?}).length"));
    assert_eq!(browser.text("document.querySelector('#sample').textContent"), "below the front: a sample of 50 feasible designs");
    // The sample has a tick for each of its 8 numbers of bands; the front has one.
    let ticks = |browser: &mut Browser, line: &str| {
        browser.number(&format!("document.querySelector('#splom [data-line=\"{line}\"]').getAttribute('d').split('M').length - 1"))
    };
    assert_eq!(ticks(&mut browser, "feasible"), 8.0);
    assert_eq!(ticks(&mut browser, "the front"), 1.0);
    assert_eq!(count(&mut browser, "#splom .limit"), 1.0, "at least 7");
    assert_eq!(count(&mut browser, "#splom .limit-beyond"), 1.0, "at most 30 is further away");
    assert_eq!(count(&mut browser, "#splom .range-end"), 2.0, "6 and 14 bands");
    assert_eq!(count(&mut browser, "#splom .knee"), 1.0);
    browser.evaluate("beltspace.page.pin(0); beltspace.openCard(0)");
    browser.wait("document.querySelector('#splom [data-letter=A]') && document.querySelector('.strip-current').getAttribute('d')");
    // With the keyboard, spoken.
    browser.evaluate("document.querySelector('#splom .cell').focus()");
    browser.key("ArrowRight", 39);
    let said = browser.text("document.querySelector('#said').textContent");
    assert!(said.starts_with("design ") && said.contains("band_count 7"), "{said}");
    let csv = std::fs::read_to_string(swept.file("front.csv")).expect("a table");
    browser.evaluate(&format!("beltspace.page.addOther(new File([{}], 'another.csv'))", serde_json::json!(csv)));
    browser.wait("document.querySelector('#splom [data-line=\"other result\"]')");
    browser.picture("one-objective");
    // Two columns are a plot of points again.
    browser.evaluate("beltspace.chooseColumns('matrix', ['band_count', 'groove_angle_deg'])");
    browser.wait("document.querySelector('#splom canvas') && !document.querySelector('#splom .rug')");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_live_page_of_one_objective_has_the_old_front_and_keeps_the_focus() {
    let (_folder, file) = study_file(ONE);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    browser.evaluate("document.querySelector('#splom .cell').focus()");
    browser.evaluate(COUNT);
    browser.evaluate("beltspace.change({ 'constraints.band_count.min': '9' })");
    answered(&mut browser);
    browser.wait("document.querySelector('#splom [data-line=\"old front\"]')?.getAttribute('d')");
    assert_eq!(browser.evaluate("document.activeElement.dataset.x"), "band_count");
    // What is counted moves the page a little: a click then may miss.
    browser.wait("beltspace.page.data.study.feasible !== null");
    browser.click_on("#ghost");
    browser.wait("!document.querySelector('#splom [data-line=\"old front\"]')");
    assert_eq!(browser.complaints, Vec::<String>::new());
}
