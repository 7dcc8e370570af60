//! What the page of a result lets a reader reach: every chart as a file, every listed design as a card, each table by one stop of the tab key;
//! and that it says no more than it knows.

use crate::browser::Browser;
use crate::report_page::{Swept, beltspace};
use std::collections::BTreeMap;

/// A picture that the page would save, or why there is none.
fn saved(browser: &mut Browser, selector: &str) -> String {
    browser.text(&format!("beltspace.page.pictureOf([document.querySelector({selector:?})]).text"))
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn every_chart_can_be_saved_with_its_words() {
    let swept = Swept::shipped("metal-cvt");
    let mut browser = Browser::open(&swept.page(), "");
    browser.evaluate("beltspace.openCard(beltspace.data.front.knee)");
    // Every canvas and SVG of the page is within reach of a button.
    let lost = "[...document.querySelectorAll('#main svg, #main canvas, #card svg')].filter((it) => it.getClientRects().length \
                && !it.closest('section').querySelector('.save-buttons')).map((it) => it.closest('[id]').id)";
    assert_eq!(browser.evaluate(lost), serde_json::json!([]));
    let charts = [
        ("#splom", "axial force upper [N]"),
        ("#parallel .stage", "groove"),
        (".drive-stage", "156 mm"),
        ("#around .slices", "band_"),
        (".tally", "stress_margin at least 0"),
        ("#histograms .figure", "axial force upper"),
        (".map-plate", "reserve"),
    ];
    for (selector, words) in charts {
        let picture = saved(&mut browser, selector);
        assert!(picture.contains(words) && picture.contains("</svg>"), "{selector} without {words}: {} bytes", picture.len());
        // It stands alone: nothing in it needs the page's style.
        assert!(!picture.contains("class=\"save-buttons") && !picture.contains("var(--"), "{selector}");
    }
    // On a laptop both views stand beside each other, and beside the card.
    for width in [1280, 1440] {
        browser.resize(width, 800);
        std::thread::sleep(std::time::Duration::from_millis(600));
        let sides = "['#splom .stage', '#parallel', '#card'].map((it) => document.querySelector(it).getBoundingClientRect()).flatMap((it) => [it.left, it.right])";
        let sides: Vec<f64> = serde_json::from_value(browser.evaluate(sides)).expect("numbers");
        assert!(sides.is_sorted() && sides[5] <= f64::from(width), "{sides:?}");
        let is_cut = "document.querySelector('#card').scrollWidth > document.querySelector('#card').clientWidth";
        assert_eq!(browser.evaluate(is_cut), false, "at {width}");
        browser.picture(&format!("report-card-{width}"));
    }
    // Words with a halo are painted over it, also without the page.
    assert!(saved(&mut browser, ".drive-stage").contains("paint-order=\"stroke"));
    assert!(saved(&mut browser, "#splom").contains("linearGradient"), "the colour bar");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn listed_designs_and_cells_of_maps_open_cards_and_a_table_is_one_stop() {
    let swept = Swept::shipped("metal-cvt");
    let mut browser = Browser::open(&swept.page(), "");
    for table in ["#designs", "#top table"] {
        assert_eq!(browser.number(&format!("document.querySelectorAll({:?}).length", format!("{table} [tabindex='0']"))), 1.0, "{table}");
    }
    let title = "document.querySelector('#card-title').textContent";
    browser.evaluate("document.querySelector('#top tbody tr:nth-child(3)').click()");
    let design = browser.text("document.querySelector('#top tbody tr:nth-child(3)').dataset.row");
    assert!(browser.text(title).starts_with(&format!("Design {design}")));
    browser.evaluate("beltspace.closeCard()");
    // A cell of the map, with the keyboard.
    browser.evaluate("document.querySelector('.map-stage').scrollIntoView({ block: 'center' })");
    browser.evaluate("document.querySelector('.map-stage').focus()");
    // The upper right corner, where belts are clamped hard.
    for _ in 0..60 {
        browser.key("ArrowUp", 38);
        browser.key("ArrowRight", 39);
    }
    let said = browser.text("document.querySelector('.map-readout').textContent");
    let best = said.rsplit("best design ").next().filter(|it| it.parse::<u64>().is_ok()).expect("a design").to_owned();
    browser.key("Enter", 13);
    browser.wait(&format!("!document.querySelector('#card').hidden && {title}.startsWith('Design {best}')"));
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_design_that_is_not_on_the_front_is_drawn_pinned_printed_and_in_the_address() {
    let swept = Swept::shipped("metal-cvt");
    let page = swept.page();
    let mut browser = Browser::open(&page, "");
    // One that is beaten by others: its inputs are those that the program has for its number.
    let design = browser.text(
        "(() => { const { page } = beltspace; let at = 54321; while (page.rowOf(String(at)) >= 0) at++; \
         page.openDesign(String(at), [{ name: 'axial_force_upper_N', unit: 'N', value: 80123.4 }]); return String(at); })()",
    );
    let card = browser.text("document.querySelector('#card').innerText").replace('\u{202f}', "");
    assert!(card.contains("not on the front") && card.contains("Drawn to scale") && card.contains("80123"), "{card}");
    let shown =
        "Object.fromEntries([...document.querySelectorAll('#card [data-name]')].map((it) => [it.dataset.name, Number(it.dataset.value)]))";
    let shown: BTreeMap<String, f64> = serde_json::from_value(browser.evaluate(shown)).expect("numbers");
    let study = swept.file("study.toml");
    let told = beltspace(&["eval", study.to_str().expect("a name"), "--design", &design, "--json"]);
    let told: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    for name in ["band_count", "band_thickness_mm", "groove_angle_deg", "reserve"] {
        assert_eq!(told["inputs"][name].as_f64(), Some(shown[name]), "{name}: {}", told["inputs"]);
    }
    // It is marked in the views, as far as these reach.
    assert_eq!(browser.number("document.querySelectorAll('#parallel .current-line').length"), 1.0);
    assert_eq!(browser.number("document.querySelectorAll('.map-stage .current').length"), 1.0);
    // A sheet of paper has its drawing.
    browser.evaluate("window.print = () => (window.sheet = document.body.classList.contains('sheet'))");
    browser.click_on("#card-print");
    assert_eq!(browser.evaluate("window.sheet"), true);
    browser.evaluate("beltspace.page.pin(0)");
    browser.click_on("#card-pin");
    assert_eq!(browser.text("document.querySelector('#card-pin').textContent"), "Unpin");
    assert_eq!(browser.text("document.querySelector('#said').textContent"), format!("design {design} is pinned as B, 2 of 6"));
    // Its letter stays when the one before it goes, in the address too.
    browser.evaluate("beltspace.page.unpin(beltspace.page.pins()[0])");
    browser.picture("card-not-on-the-front");
    browser.wait(&format!("location.hash.includes('p={design}@B') && location.hash.includes('d={design}')"));
    let hash = browser.text("location.hash");
    drop(browser);
    let mut browser = Browser::open(&page, &hash);
    browser.wait(&format!("document.querySelector('#card-title')?.textContent === 'Design {design}'"));
    assert_eq!(browser.evaluate("beltspace.page.pins().flatMap((it) => [it.design, it.letter])"), serde_json::json!([design, "B"]));
    browser.evaluate("beltspace.closeCard()");
    browser.click_on(".pins .pin-name");
    assert!(browser.text("document.querySelector('#card').innerText").contains("Drawn to scale"));
    // There is no such design.
    browser.evaluate("beltspace.closeCard(); beltspace.page.openDesign('99999999999999999999')");
    assert_eq!(browser.evaluate("document.querySelector('#card').hidden"), true);
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn listed_designs_are_drawn_with_what_their_models_and_formulas_say() {
    // The section of a pulley, and dimensions that formulas give.
    for name in ["pulley-design", "timing-tension"] {
        let swept = Swept::shipped(name);
        let mut browser = Browser::open(&swept.page(), "");
        browser.evaluate("[...document.querySelectorAll('#top tbody tr')].find((it) => beltspace.page.rowOf(it.dataset.row) < 0).click()");
        let card = browser.text("document.querySelector('#card').innerText");
        assert!(card.contains("not on the front") && card.contains("Drawn to scale"), "{name}: {card}");
        assert!(!card.contains("Not drawn") && !card.contains("what lies between groove and bore"), "{name}: {card}");
        assert_eq!(browser.number("document.querySelectorAll('#card svg.drive').length"), 1.0, "{name}");
        assert_eq!(browser.complaints, Vec::<String>::new(), "{name}");
    }
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_saved_picture_has_of_a_list_what_the_page_shows_of_it_and_the_names_of_other_results() {
    let swept = Swept::shipped("metal-cvt");
    let mut browser = Browser::open(&swept.page(), "");
    browser.resize(1400, 900);
    browser.wait("document.querySelector('#readout.corner')");
    let words = browser.evaluate(
        "(() => { const { page } = beltspace; const end = document.querySelector('#readout').getBoundingClientRect().bottom; \
         const svg = page.pictureOf([document.querySelector('#splom')]).text; \
         const names = [...document.querySelectorAll('#readout dt')].map((it) => ({ name: it.textContent, hidden: it.getBoundingClientRect().bottom > end + 1 })); \
         const drawn = ({ name }) => svg.includes(`>${name}<`); \
         return { hidden: names.filter((it) => it.hidden).length, wrong: names.filter((it) => drawn(it) === it.hidden).map((it) => it.name) }; })()",
    );
    assert!(words["hidden"].as_u64() > Some(3), "{words}");
    assert_eq!(words["wrong"], serde_json::json!([]));
    let csv = std::fs::read_to_string(swept.file("front.csv")).expect("a table");
    browser.evaluate(&format!("beltspace.page.addOther(new File([{}], 'another.csv'))", serde_json::json!(csv)));
    browser.evaluate("beltspace.page.download = (name, type, text) => (window.saved = text)");
    browser.wait("document.querySelector('#others li')");
    browser.evaluate("document.querySelector('[data-testid=\"svg front\"]').click()");
    browser.wait("window.saved");
    assert!(browser.text("window.saved").contains("another.csv"));
    browser.picture("front-beside-another");
    // As a PNG it has two pixels for each of the page, and colours on them.
    browser.evaluate("window.saved = null; document.querySelector('[data-testid=\"png front\"]').click()");
    browser.wait("window.saved instanceof Blob");
    let png = browser.evaluate(
        "(async () => { const picture = await createImageBitmap(window.saved); const { width, height } = beltspace.page.pictureOf([...document.querySelectorAll('#sample, #others, #splom')]); \
         const canvas = new OffscreenCanvas(picture.width, picture.height); const context = canvas.getContext('2d'); context.drawImage(picture, 0, 0); \
         const colours = new Set(new Uint32Array(context.getImageData(0, 0, picture.width, picture.height).data.buffer)); \
         return { type: window.saved.type, wide: picture.width / width, high: picture.height / height, colours: colours.size }; })()",
    );
    assert_eq!([&png["type"], &png["wide"], &png["high"]], [&serde_json::json!("image/png"), &2.into(), &2.into()], "{png}");
    assert!(png["colours"].as_u64() > Some(50), "{png}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_range_becomes_a_constraint_only_where_that_asks_the_same() {
    let swept = Swept::shipped("metal-cvt");
    let mut browser = Browser::open(&swept.page(), "");
    // What is shown is the lowest slip margin of the scenarios: an upper bound would be on the highest.
    browser.evaluate("beltspace.brushAxis('slip_margin', [0.1, 0.2])");
    browser.wait("document.querySelector('#brush-note').innerText.includes('constraints.slip_margin')");
    let note = browser.text("document.querySelector('#brush-note').innerText");
    assert!(note.contains("constraints.slip_margin.min=0.1") && !note.contains("slip_margin.max"), "{note}");
    assert!(note.contains("slip_margin is the lowest over the scenarios"), "{note}");
    // Inputs are the same in every scenario.
    browser.evaluate("beltspace.clear()");
    browser.evaluate("beltspace.brushAxis('reserve', [1.45, 1.62])");
    browser.wait("document.querySelector('#brush-note').innerText.includes('reserve.min=1.45')");
    assert!(browser.text("document.querySelector('#brush-note').innerText").contains("reserve.max=1.62"));
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn what_is_drawn_and_in_which_cases_is_in_the_header_and_on_the_card() {
    let swept = Swept::shipped("push-belt-yield");
    let mut browser = Browser::open(&swept.page(), "");
    let question = browser.text("document.querySelector('[data-testid=question]').innerText");
    for words in ["every draw must keep", "slip_margin", "at most 75\u{202f}000 N", "in every operating case of", "0.5 to 2", "normal"] {
        assert!(question.contains(words), "{words} is not in {question}");
    }
    browser.evaluate("beltspace.openCard(0)");
    let card = browser.text("document.querySelector('#card').innerText");
    assert!(card.contains("drawn from a distribution") && card.contains("plus normal mean 0, sd 0.3"), "{card}");
    // It is drawn over all ratios of its cases.
    let ends = "[...document.querySelectorAll('[data-testid=drive-ratio]')].length";
    assert_eq!(browser.number(ends), 1.0);
    assert!(card.contains("belt_length_mm: it has a distribution and is shown at its mean, 613"), "{card}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn views_of_the_same_designs_stand_side_by_side_on_a_laptop() {
    let swept = Swept::shipped("metal-cvt");
    let mut browser = Browser::open(&swept.page(), "");
    browser.resize(1366, 768);
    browser.wait("document.querySelector('#views').getBoundingClientRect().height < 700");
    let places = "[...document.querySelectorAll('#views > section')].map((it) => it.getBoundingClientRect()).map((it) => [it.left, it.top, it.right, it.height])";
    let [one, other]: [[f64; 4]; 2] = serde_json::from_value(browser.evaluate(places)).expect("two views");
    assert!(other[0] >= one[2] && other[1] == one[1] && other[2] <= 1366.0, "{one:?} {other:?}");
    assert!(one[3].max(other[3]) < 768.0 - 46.0, "{one:?} {other:?}");
    // The first link of the page leads past what stands above the plots.
    browser.evaluate("document.querySelector('[data-skip]').click()");
    assert_eq!(browser.evaluate("document.activeElement.closest('#splom') !== null"), true, "the link leads to the plots");
    // A pinned design is in every view, however far down its line stands in the table.
    browser.evaluate("beltspace.page.pin(900)");
    for view in ["#splom .pin-dot", "#parallel .pin-line", "#designs .pin-letter", ".map-stage .pin-dot"] {
        browser.wait(&format!("document.querySelector({view:?})"));
    }
    // So is the one whose card is open, as long as it is.
    browser.evaluate("beltspace.openCard(1200)");
    browser.wait("document.querySelector('#designs [data-row=\"1200\"].is-current')");
    browser.evaluate("beltspace.closeCard()");
    browser.wait("!document.querySelector('#designs [data-row=\"1200\"]')");
    // Axes of inputs have the ends of what was searched.
    assert_eq!(browser.number("document.querySelectorAll('#parallel .axis[data-name=band_thickness_mm] .range-end').length"), 2.0);
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn each_line_of_a_contour_lies_on_a_white_one() {
    let text = "model = \"metal-cvt\"\n[design]\nband_thickness_mm = { from = 0.1, to = 0.3, count = 21 }\n\
        groove_angle_deg = { from = 18, to = 30, count = 13 }\n[fixed]\ntraction = 0.4\n[objectives]\naxial_force_N = \"min\"\n\
        [report]\nmaps = [{ x = \"band_thickness_mm\", y = \"groove_angle_deg\", value = \"axial_force_N\", contours = [{ of = \"stress_margin\", at = [0.3] }] }]\n";
    let swept = Swept::text(text);
    let mut browser = Browser::open(&swept.page(), "");
    let lines = "[...document.querySelectorAll('.contour')].map((it) => [...it.children].map((line) => [line.getAttribute('d'), getComputedStyle(line).stroke]))";
    let lines: Vec<Vec<(String, String)>> = serde_json::from_value(browser.evaluate(lines)).expect("lines with colours");
    assert!(lines.iter().any(|it| !it.is_empty()), "{lines:?}");
    for pair in lines.iter().flat_map(|it| it.chunks(2)) {
        let [casing, line] = pair else { panic!("a line alone: {pair:?}") };
        assert!(casing.0 == line.0 && casing.1 == "rgb(255, 255, 255)" && line.1 != casing.1, "{casing:?} {line:?}");
    }
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn numbers_below_the_cells_do_not_touch() {
    let text = "model = \"metal-cvt\"\n[design]\nband_thickness_mm = { from = 0.1, to = 0.3, count = 9 }\nband_count = { from = 6, to = 14 }\n\
        traction = { from = 0.3, to = 0.5, count = 7 }\n[objectives]\naxial_force_N = \"min\"\nstress_margin = \"max\"\nslip_margin = \"max\"\n\
        band_count = \"min\"\nband_thickness_mm = \"max\"\n";
    let swept = Swept::text(text);
    let mut browser = Browser::open(&swept.page(), "");
    let touching = "(() => { const boxes = [...document.querySelectorAll('#splom .tick-axis[transform] .tick text')].filter((it) => it.textContent) \
        .map((it) => ({ text: it.textContent, ...it.getBoundingClientRect().toJSON() })); \
        const pairs = boxes.flatMap((a, i) => boxes.slice(i + 1).filter((b) => a.left < b.right + 1 && b.left < a.right + 1 && a.top < b.bottom && b.top < a.bottom) \
        .map((b) => `${a.text} and ${b.text}`)); return { count: boxes.length, pairs }; })()";
    // One number is no scale.
    let alone = "(() => [...document.querySelectorAll('#splom .tick-axis')].filter((it) => it.querySelector('.tick')) \
        .filter((it) => [...it.querySelectorAll('.tick text')].filter((text) => text.textContent).length < 2).length)()";
    for width in [1000, 1366] {
        browser.resize(width, 900);
        browser.wait("document.querySelectorAll('#splom .tick-axis[transform] .tick text').length > 8");
        assert_eq!(browser.number(alone), 0.0, "{width}");
        let found = browser.evaluate(touching);
        assert!(found["count"].as_u64() > Some(8), "{width}: {found}");
        assert_eq!(found["pairs"], serde_json::json!([]), "{width}");
    }
}
