//! The page of a study whose designs come from a catalogue: rows are called by their labels, and their numbers are no ranges.

use crate::browser::Browser;
use crate::report_page::Swept;

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn rows_of_a_catalogue_are_called_by_their_labels_and_are_no_ranges() {
    let swept = Swept::shipped("catalogue-v-belts");
    let mut browser = Browser::open(&swept.page(), "");
    // The section is the first axis, and the numbers of its row come after all else.
    let axes: Vec<String> = serde_json::from_value(browser.evaluate("beltspace.state.parallel")).expect("names");
    assert_eq!(axes[0], "section", "{axes:?}");
    let at = |name: &str| axes.iter().position(|it| it == name);
    assert!(at("groove_angle_deg").is_none_or(|it| Some(it) > at("rim_mass_kg")), "{axes:?}");
    // Around the knee, a groove of section C.
    let knee =
        swept.front().into_iter().find(|row| row["design_index"] == browser.text("beltspace.page.designOf(beltspace.page.front.knee)"));
    let knee = knee.expect("the knee is on the front");
    let around = browser.text("document.querySelector('#around').innerText");
    let now = format!("now {}, {}", knee["section"], knee["groove_angle_deg"]);
    assert!(around.contains("section + groove_angle_deg") && around.contains(&now), "{around}");
    // A groove of a catalogue is not at the end of a range, and a count of 1 is.
    browser.evaluate("beltspace.openCard(beltspace.page.front.knee)");
    let marked = "[...document.querySelectorAll('#card .end')].map((it) => it.parentElement.querySelector('[data-name]').dataset.name)";
    assert_eq!((browser.evaluate(marked), knee["groove_count"].as_str()), (serde_json::json!(["groove_count"]), "1"));
    let searched = browser
        .evaluate("['groove_width_mm', 'mean_radius_mm'].map((it) => beltspace.page.searchedOf(beltspace.page.front.byName.get(it)))");
    assert_eq!(searched, serde_json::json!([null, [40, 200]]));
    // The groove is drawn as wide as the catalogue has it, and what stands on a rule has no dimension.
    let groove = browser.evaluate(
        "(() => { const svg = document.querySelector('#card svg.drive'); const one = svg.querySelectorAll('path.belt'); const belt = one[one.length - 1].getBBox(); \
         const circle = svg.querySelector('circle.ghost-circle').r.baseVal.value; return { wide: belt.width / circle, text: svg.textContent }; })()",
    );
    let number = |name: &str| knee[name].parse::<f64>().expect("a number");
    let (wide, wanted) = (groove["wide"].as_f64().expect("a number"), number("groove_width_mm") / number("mean_radius_mm"));
    assert!((wide / wanted - 1.0).abs() < 1e-3, "{wide} instead of {wanted}");
    assert!(groove["text"].as_str().is_some_and(|it| it.contains("mean r") && it.matches("mm").count() == 3), "{groove}");
    // A label of many letters without a space is wrapped, in the card and in slices.
    browser.resize(1366, 900);
    browser.evaluate(
        "(() => { const { page } = beltspace; const column = page.front.byName.get('section'); const long = 'x'.repeat(180); \
         column.words[column.values[page.front.knee]] = long; beltspace.openCard(page.front.knee); \
         page.drawSlices(document.querySelector('.around-box'), { columns: [], slices: [{ input: 'section', unit: '', own: 0, words: [long], \
         at: [0], feasible: [true], status: [null], lines: [] }] }); })()",
    );
    let wide = "['#card', '#around'].map((it) => document.querySelector(it)).map((it) => it.scrollWidth > it.clientWidth)";
    assert_eq!(browser.evaluate(wide), serde_json::json!([false, false]));
    browser.evaluate("document.querySelectorAll('#card .long, .slice-head').forEach((it) => { it.style.overflowWrap = 'normal'; })");
    assert_eq!(browser.evaluate(wide), serde_json::json!([true, true]), "this test sees nothing");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn titles_of_many_axes_do_not_touch() {
    let swept = Swept::shipped("catalogue-v-belts");
    let mut browser = Browser::open(&swept.page(), "");
    // Words less than 4 px apart read as one.
    let touching = "(() => { const boxes = [...document.querySelectorAll('.axis-head :is(.axis-name, .axis-unit span)')].map((it) => { \
        const range = document.createRange(); range.selectNodeContents(it); return [...range.getClientRects()].map((box) => ({ text: it.textContent, of: it.closest('.axis-head').dataset.axis, \
        left: box.left, right: box.right, top: box.top, bottom: box.bottom })); }).flat().filter((it) => it.right > it.left); \
        const pairs = boxes.flatMap((a, i) => boxes.slice(i + 1).filter((b) => a.of !== b.of && a.left < b.right + 4 && b.left < a.right + 4 && a.top < b.bottom - 1 && b.top < a.bottom - 1) \
        .map((b) => `${a.text} and ${b.text}`)); return { count: boxes.length, pairs }; })()";
    for width in [390, 1366, 1920] {
        browser.resize(width, 900);
        browser.wait(&format!("window.innerWidth === {width} && document.querySelectorAll('.axis-head').length > 10"));
        let found = browser.evaluate(touching);
        assert!(found["count"].as_u64() > Some(20), "{width}: {found}");
        assert_eq!(found["pairs"], serde_json::json!([]), "{width}");
    }
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn letters_of_neighbours_stand_beside_each_other() {
    let swept = Swept::shipped("metal-cvt");
    let mut browser = Browser::open(&swept.page(), "");
    // Six designs that follow each other along the front.
    browser.evaluate(
        "(() => { const { page } = beltspace; const { values } = page.front.objectives[0].column; const order = [...values.keys()].sort((a, b) => values[a] - values[b]); \
         order.slice(0, 6).forEach((row) => page.pin(row)); })()",
    );
    browser.wait("document.querySelectorAll('#parallel [data-letter]').length === 6");
    let views = browser.evaluate(
        "[...document.querySelectorAll('#splom .marks, #parallel .pinned, .map-stage .marks')].map((view) => [...view.querySelectorAll('[data-letter]')] \
         .map((it) => [it.dataset.letter, it.cx.baseVal.value, it.cy.baseVal.value])).filter((it) => it.length)",
    );
    let views: Vec<Vec<(String, f64, f64)>> = serde_json::from_value(views).expect("letters");
    assert!(views.len() > 2, "{views:?}");
    for view in views {
        assert_eq!(view.len(), 6, "{view:?}");
        for (at, (a, x, y)) in view.iter().enumerate() {
            for (b, u, v) in &view[at + 1..] {
                assert!((x - u).hypot(y - v) > 14.0, "{a} and {b}: {view:?}");
            }
        }
    }
    // Those that had to step aside have a dot and a line to it.
    let aside = browser.evaluate(
        "[document.querySelectorAll('#splom .pin-leader').length, document.querySelectorAll('#splom .pin-dot:not([data-letter])').length]",
    );
    assert!(aside[0].as_u64() > Some(0) && aside[0] == aside[1], "{aside}");
    browser.picture("pins-of-neighbours");
    assert_eq!(browser.complaints, Vec::<String>::new());
}
