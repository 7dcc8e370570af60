//! The page of `beltspace explore` on the screens that people have: both views of the designs are seen together on a laptop, and titles can
//! be read on every screen.

use crate::browser::Browser;
use crate::explore_page::{Explored, open};
use std::path::Path;
use std::time::Duration;

/// Left, top, right and bottom of each element that a selector finds.
fn boxes(browser: &mut Browser, selector: &str) -> Vec<[f64; 4]> {
    let found = browser.evaluate(&format!(
        "[...document.querySelectorAll({selector:?})].map((it) => it.getBoundingClientRect()).map((it) => [it.left, it.top, it.right, it.bottom])"
    ));
    serde_json::from_value(found).expect("numbers")
}

/// Scrolls to the views and waits until their places stay.
fn resized(browser: &mut Browser, width: u32, height: u32) {
    browser.resize(width, height);
    std::thread::sleep(Duration::from_millis(600));
    browser.evaluate("document.querySelector('#views').scrollIntoView({ block: 'start', behavior: 'instant' })");
    std::thread::sleep(Duration::from_millis(200));
}

fn overlap(a: &[f64; 4], b: &[f64; 4]) -> bool {
    a[0].max(b[0]) < a[2].min(b[2]) - 0.5 && a[1].max(b[1]) < a[3].min(b[3]) - 0.5
}

/// Titles of the matrix are as wide as their letters make them, none smaller than 9 px, none over another one, and none beyond its plot.
fn titles_are_clear(browser: &mut Browser) {
    assert_eq!(browser.number("document.querySelectorAll('#splom [textLength]').length"), 0.0);
    let least = browser.number(
        "Math.min(...[...document.querySelectorAll('#splom .axis-title, #parallel .axis-name')].map((it) => parseFloat(getComputedStyle(it).fontSize)))",
    );
    assert!(least >= 9.0, "{least} px");
    // All of them say the goals in words, or none does.
    let words = "new Set([...document.querySelectorAll('#splom .axis-title')].map((it) => it.textContent.includes('is better'))).size";
    assert_eq!(browser.number(words), 1.0);
    let titles = boxes(browser, "#splom .axis-title");
    let [stage] = boxes(browser, "#splom .stage")[..] else { panic!("one matrix") };
    assert!(titles.len() >= 4, "{titles:?}");
    for (at, title) in titles.iter().enumerate() {
        assert!(titles[..at].iter().all(|other| !overlap(title, other)), "{at} of {titles:?}");
        assert!(title[0] >= stage[0] - 1.0 && title[2] <= stage[2] + 2.0 && title[3] <= stage[3] + 2.0, "{title:?} in {stage:?}");
    }
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn both_views_are_seen_together_on_a_laptop_and_titles_are_clear_on_every_screen() {
    let explored = Explored::new(Path::new("studies/metal-cvt.toml"), &[]);
    let mut browser = open(&explored);
    for (width, height) in [(1366, 768), (1920, 1080)] {
        resized(&mut browser, width, height);
        browser.picture(&format!("explore-{width}"));
        let (wide, high) = (f64::from(width), f64::from(height));
        let [bar] = boxes(&mut browser, "#bar")[..] else { panic!("one bar") };
        let [matrix] = boxes(&mut browser, "#splom .stage")[..] else { panic!("one matrix") };
        let [lines] = boxes(&mut browser, "#parallel .stage")[..] else { panic!("one plot") };
        let [section] = boxes(&mut browser, "#matrix-section")[..] else { panic!("one section") };
        for view in [&matrix, &lines] {
            assert!(view[1] >= bar[3] && view[3] <= high, "{view:?} below {bar:?} at {width} x {height}");
        }
        assert!(matrix[2] <= section[2] + 1.0 && section[2] < lines[0], "{matrix:?} in {section:?} beside {lines:?}");
        let axes = boxes(&mut browser, "#parallel .axis-head");
        let seen = axes.iter().filter(|it| it[0] >= lines[0] - 1.0 && it[2] <= wide).count();
        assert!(axes.len() >= 8 && 10 * seen >= 9 * axes.len(), "{seen} of {} axes at {width}", axes.len());
        titles_are_clear(&mut browser);
    }
    // With a card too: it stands below both where there is no room beside them, and brings them into sight.
    browser.resize(1366, 768);
    browser.evaluate("scrollTo({ top: 0, behavior: 'instant' })");
    browser.evaluate("beltspace.openCard(beltspace.page.front.knee)");
    let [card] = boxes(&mut browser, "#card")[..] else { panic!("one card") };
    let [views] = boxes(&mut browser, "#views")[..] else { panic!("one row of views") };
    assert!(views[1] >= 0.0 && card[1] - views[1] > 250.0, "{views:?} {card:?}");
    for (width, height) in [(1280, 720), (1440, 900), (1700, 900)] {
        resized(&mut browser, width, height);
        browser.picture(&format!("explore-card-{width}"));
        let [controls] = boxes(&mut browser, "#controls")[..] else { panic!("one panel") };
        let [card] = boxes(&mut browser, "#card")[..] else { panic!("one card") };
        let [matrix] = boxes(&mut browser, "#splom .stage")[..] else { panic!("one matrix") };
        let [lines] = boxes(&mut browser, "#parallel")[..] else { panic!("one plot") };
        assert!(
            controls[2] <= card[0] + 1.0 && controls[2] <= matrix[0] && matrix[2] < lines[0],
            "{controls:?} {card:?} {matrix:?} {lines:?}"
        );
        // What is in sight of both.
        let seen = [&matrix, &lines].map(|view| view[3].min(card[1].max(f64::from(height) * f64::from(width > 1660))) - view[1]);
        assert!(seen.iter().all(|high| *high > 180.0) && (width < 1660 || lines[2] <= card[0]), "{seen:?} at {width}, {lines:?} {card:?}");
        let scrolls =
            "[document.querySelector('#card')].map((it) => [it.scrollWidth <= it.clientWidth, it.scrollHeight > it.clientHeight + 400])[0]";
        assert_eq!(browser.evaluate(scrolls), serde_json::json!([true, true]), "at {width}");
        // Its buttons stay while the rest is scrolled.
        browser.evaluate("document.querySelector('#card').scrollTo({ top: 400, behavior: 'instant' })");
        let [head] = boxes(&mut browser, "#card-close")[..] else { panic!("one button") };
        assert!(width > 1660 || overlap(&head, &card), "{head:?} {card:?}");
        browser.evaluate("document.querySelector('#card').scrollTo({ top: 0, behavior: 'instant' })");
    }
    browser.evaluate("beltspace.page.closeCard()");
    // On a phone the matrix is as wide as the page.
    resized(&mut browser, 400, 800);
    browser.picture("explore-400");
    let [matrix] = boxes(&mut browser, "#splom .stage")[..] else { panic!("one matrix") };
    assert!(matrix[2] <= 400.0, "{matrix:?}");
    titles_are_clear(&mut browser);
    // A squeezed title would be seen.
    browser.evaluate("document.querySelector('#splom .axis-title').setAttribute('textLength', 20)");
    assert_eq!(browser.number("document.querySelectorAll('#splom [textLength]').length"), 1.0);
    assert_eq!(browser.complaints, Vec::<String>::new());
}
