//! The pictures of the pages in README and manual, with what their captions say in them. This makes them anew:
//! `BELTSPACE_PICTURES=docs/pictures cargo test --locked --test it -- --ignored pages_in_docs --test-threads 1`.

use crate::browser::Browser;
use crate::explore_page::{COUNT, Explored, answered, open};
use std::path::Path;
use std::process::Command;
use std::time::Duration;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Brings an element below the bar, which stays at the top of the window.
fn below_the_bar(browser: &mut Browser, selector: &str) {
    browser.evaluate(&format!(
        "(() => {{ const bar = document.querySelector('#bar').getBoundingClientRect(); \
         window.scrollBy({{ top: document.querySelector({selector:?}).getBoundingClientRect().top - bar.height - 12, behavior: 'instant' }}); }})()"
    ));
    std::thread::sleep(Duration::from_millis(300));
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored pages_in_docs --test-threads 1"]
fn explore_has_its_controls_the_old_front_and_a_card() {
    let manual = std::fs::read_to_string(root().join("docs/explore.md")).expect("there is a manual");
    let study = manual.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("it has a study");
    let folder = tempfile::tempdir().expect("there is room");
    std::fs::write(folder.path().join("belt.toml"), study).expect("it can be written");
    let explored = Explored::in_folder(folder.path(), Path::new("belt.toml"), &[]);
    let mut browser = open(&explored);
    browser.resize(1366, 900);
    std::thread::sleep(Duration::from_millis(600));
    browser.evaluate(COUNT);
    browser.evaluate(
        "(() => { const field = document.querySelector('#controls .entry input[data-part=strength_MPa]'); \
         field.focus(); field.value = '760'; \
         field.dispatchEvent(new Event('change', { bubbles: true })); field.blur(); })()",
    );
    answered(&mut browser);
    browser.wait("document.querySelector('#command').textContent.includes('--set strength_MPa=760') && /feasible/.test(document.querySelector('#live').textContent)");
    std::thread::sleep(Duration::from_millis(800));
    assert_eq!(browser.evaluate("beltspace.page.ghost !== null"), true, "the old front stays behind");
    browser.evaluate("window.scrollTo({ top: 0, behavior: 'instant' })");
    browser.picture("explore");

    browser.click_on("#open-knee");
    browser.wait("document.querySelector('#card-pin')");
    browser.click_on("#card-pin");
    browser.wait("document.querySelectorAll('#around .slice').length > 4");
    std::thread::sleep(Duration::from_millis(600));
    below_the_bar(&mut browser, "#around");
    browser.picture("explore-card");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored pages_in_docs --test-threads 1"]
fn a_result_is_brushed_in_two_cells_and_a_card_stands_beside() {
    let folder = tempfile::tempdir().expect("there is room");
    let study = root().join("studies/metal-cvt.toml");
    let swept = Command::new(env!("CARGO_BIN_EXE_beltspace"))
        .args(["sweep", study.to_str().expect("characters"), "--out", "my-belt", "--quiet"])
        .current_dir(folder.path())
        .output()
        .expect("the program starts");
    assert!(swept.status.success(), "{}", String::from_utf8_lossy(&swept.stderr));
    let mut browser = Browser::open(&folder.path().join("my-belt/report.html"), "");
    browser.resize(1400, 1000);
    std::thread::sleep(Duration::from_millis(600));
    browser.evaluate("beltspace.brushCell('axial_force_upper_N', 'stress_margin', [57600, 68430], [0.16, 0.316])");
    browser.evaluate("beltspace.brushCell('stress_margin', 'clamping_utilisation', [0.057, 0.316], [0.8, 0.89])");
    std::thread::sleep(Duration::from_millis(300));
    let selected = browser.number("beltspace.selected().length");
    assert!(selected > 50.0 && selected < browser.number("beltspace.page.front.rows") / 3.0, "{selected}");
    below_the_bar(&mut browser, "#matrix-section");
    browser.picture("metal-cvt-brushed");

    browser.evaluate("beltspace.page.openCard(beltspace.selected()[0])");
    browser.wait("document.querySelector('#card .drive')");
    std::thread::sleep(Duration::from_millis(600));
    below_the_bar(&mut browser, "#matrix-section");
    browser.evaluate("document.querySelector('#card .drive-stage').scrollIntoView({ block: 'center', behavior: 'instant' })");
    std::thread::sleep(Duration::from_millis(300));
    browser.picture("metal-cvt-card");
    assert_eq!(browser.complaints, Vec::<String>::new());
}
