//! Other results over the page of a result, and what all of this looks like.

use crate::browser::Browser;
use crate::explore_page::{CONTRAST, axe, broken_rules};
use crate::report_page::Swept;
use crate::report_page_choose::{Goals, points, ranked};
use serde_json::Value;
use std::path::Path;

/// What is said when a file cannot be shown.
fn refused(browser: &mut Browser, file: &Path) -> String {
    browser.evaluate("document.querySelector('#others [role=alert]').textContent = ''");
    browser.choose_file("#other-file", file);
    browser.wait("document.querySelector('#others [role=alert]').textContent !== ''");
    browser.text("document.querySelector('#others [role=alert]').textContent")
}

/// Of `points` those that one of `others` beats.
fn beaten(points: &[Vec<f64>], others: &[Vec<f64>]) -> usize {
    let beats = |a: &Vec<f64>, b: &Vec<f64>| a.iter().zip(b).all(|(a, b)| a <= b) && a != b;
    points.iter().filter(|point| others.iter().any(|other| beats(other, point))).count()
}

const BELT: &str = r#"
model = "metal-cvt"
title = "TITLE"
[design]
groove_angle_deg  = { from = 18, to = 30, count = 13 }
band_thickness_mm = { from = 0.10, to = 0.30, count = 21 }
band_count        = { from = 6, to = 14 }
traction          = { from = 0.30, to = 0.50, count = 9 }
[operation]
torque_Nm = [50, 150]
[fixed]
strength_MPa = 800
[constraints]
stress_margin = { min = 0 }
slip_margin   = { min = 0 }
[objectives]
axial_force_N = "min"
stress_margin = "max"
slip_margin   = "max"
"#;

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn another_result_is_laid_over_this_one_and_compared() {
    let goals: Goals<'_> = &[("axial_force_N", false), ("stress_margin", true), ("slip_margin", true)];
    let title = "<img src=x onerror=window.hacked=1> & \\\"other\\\"";
    let here = Swept::text(&BELT.replace("TITLE", "Here"));
    let there = Swept::text(&BELT.replace("TITLE", title).replace("count = 21", "count = 20"));
    let mut browser = Browser::open(&here.page(), "");
    assert_eq!(broken_rules(&mut browser, &axe()), Vec::<String>::new());
    let (own, theirs) = (points(&here.front(), goals), points(&there.front(), goals));
    let (own_beaten, their_beaten) = (beaten(&own, &theirs), beaten(&theirs, &own));
    assert!(own_beaten > 0 && own_beaten < own.len() && their_beaten < theirs.len(), "{own_beaten} {their_beaten}");

    let colour = "(() => { const c = document.querySelector('#splom canvas'); const p = new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer); \
                  const wanted = beltspace.page.pixel(beltspace.page.variable('--other-square')); return p.reduce((n, it) => n + (it === wanted ? 1 : 0), 0); })()";
    assert_eq!(browser.number(colour), 0.0);
    browser.choose_file("#other-file", &there.page());
    browser.wait("document.querySelector('#others li')?.innerText.includes('beaten')");
    let said = browser.text("document.querySelector('#others li').innerText");
    let counts = format!("{their_beaten} of its {} designs", theirs.len());
    let own_counts = format!("{own_beaten} of the {} here by one of its", own.len());
    assert!(said.contains(&counts) && said.contains(&own_counts), "{counts}, {own_counts}: {said}");
    assert!(said.contains("<img src=x onerror=window.hacked=1> & \"other\"") && said.contains("report.html"), "{said}");
    assert_eq!(browser.evaluate("window.hacked ?? null"), Value::Null);
    browser.wait(&format!("{colour} > 20"));
    // Its designs are within the axes.
    let widest = browser.number("beltspace.page.wideDomain(beltspace.page.front.byName.get('axial_force_N'))[1]");
    assert!(theirs.iter().all(|it| it[0] <= widest));

    // The same as a table, with marks of its own; a third one, and no fourth.
    browser.choose_file("#other-file", &there.file("front.csv"));
    browser.wait(
        "document.querySelectorAll('#others li').length === 2 && document.querySelectorAll('#others li')[1].innerText.includes('beaten')",
    );
    let table = browser.text("document.querySelectorAll('#others li')[1].innerText");
    assert!(table.contains(&counts) && table.contains(&own_counts) && table.contains("does not say its goals"), "{table}");
    browser.choose_file("#other-file", &here.page());
    browser.wait(
        "document.querySelectorAll('#others li').length === 3 && document.querySelectorAll('#others li')[2].innerText.includes('beaten')",
    );
    let same = browser.text("document.querySelectorAll('#others li')[2].innerText");
    assert!(same.contains(&format!("0 of its {} designs are beaten", own.len())) && same.contains("0 of the "), "{same}");
    for theme in ["light", "dark"] {
        browser.evaluate(&format!("(() => {{ beltspace.state.theme = '{theme}'; beltspace.page.applyTheme(); }})()"));
        let contrast = browser.number(CONTRAST);
        assert!(contrast >= 3.0, "{theme}: {contrast}");
        browser.evaluate("document.querySelector('#matrix-section').scrollIntoView()");
        browser.picture(&format!("others-{theme}"));
    }
    assert_eq!(browser.evaluate("document.querySelector('[data-testid=load-other]').disabled"), true);
    for left in [2, 1, 0] {
        browser.click_on("#others li button");
        browser.wait(&format!("document.querySelectorAll('#others li').length === {left}"));
    }
    browser.wait(&format!("{colour} === 0"));

    // What cannot be compared is refused, in words; nothing changes.
    let folder = tempfile::tempdir().expect("there is room");
    let write = |name: &str, text: &str| {
        let file = folder.path().join(name);
        std::fs::write(&file, text).expect("it can be written");
        file
    };
    let page = std::fs::read_to_string(there.page()).expect("it is there");
    let table = std::fs::read_to_string(there.file("front.csv")).expect("it is there");
    let turned = Swept::text(&BELT.replace("TITLE", "Other goals").replace("slip_margin   = \"max\"", "slip_margin   = \"min\""));
    let packed = page.find("\"packed\":\"").expect("it has numbers") + 10;
    let force = table.lines().next().and_then(|it| it.split(',').position(|name| name == "axial_force_N")).expect("a column");
    let value = table.lines().nth(1).and_then(|it| it.split(',').nth(force)).expect("a value");
    let worded = table.replacen(value, "eight", 1);
    let broken = format!("{}AAAA{}", &page[..packed], &page[packed + 4..]);
    let cases = [
        (turned.page(), "its objectives are axial_force_N (min), stress_margin (max), slip_margin (min); here they are"),
        (write("kilo.html", &page.replace("\"unit\":\"N\"", "\"unit\":\"kN\"")), "axial_force_N is in kN there and in N here"),
        (write("broken.html", &broken), "its numbers cannot be read"),
        (write("cut.html", &page[..packed + 200]), "it is not a page of beltspace"),
        (write("other.html", "<!DOCTYPE html><p>hello"), "it is not a page of beltspace"),
        (write("data.html", "<script type=\"application/json\" id=\"data\">{</script>"), "its data is broken"),
        (write("notes.txt", "hello"), "its first column is not design_index"),
        (write("short.csv", &table.replace("stress_margin", "stress")), "it has no numbers of stress_margin"),
        (write("torn.csv", &table[..table.len() - 20]), "cells where there should be"),
        (write("words.csv", &worded), "it has no numbers of axial_force_N"),
    ];
    for (file, words) in cases {
        let said = refused(&mut browser, &file);
        assert!(said.contains(words) && said.contains("cannot be shown here"), "{}: {said}", file.display());
        assert_eq!(browser.number("document.querySelectorAll('#others li').length + beltspace.page.others.length"), 0.0);
    }
    browser.picture("others-refused");
    // Dropped on the plots.
    browser.evaluate(&format!(
        "(() => {{ const dropped = new DataTransfer(); dropped.items.add(new File([{}], 'dropped.csv')); \
         document.querySelector('#splom').dispatchEvent(new DragEvent('drop', {{ dataTransfer: dropped, bubbles: true, cancelable: true }})); }})()",
        serde_json::json!(table)
    ));
    browser.wait("document.querySelector('#others li')?.innerText.includes('dropped.csv')");
    // Counting pixels, as this test does and the page does not, is told to be slow.
    browser.complaints.retain(|it| !it.contains("willReadFrequently"));
    // Firefox tells of a file that cannot be unpacked, which the page says too.
    browser.complaints.retain(|it| !it.contains("Failed to read data from the ReadableStream"));
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn what_was_added_is_clear_to_everybody_on_screens_of_any_size_and_on_paper() {
    let study = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/metal-cvt.toml")).expect("it is there");
    let swept = Swept::text(&study.replace("sample = 1000", "sample = 2000"));
    let size = std::fs::metadata(swept.page()).expect("there is a page").len();
    assert!(size < 2_000_000, "{size} bytes");
    let other = Swept::text(&study.replace("strength_MPa = 800", "strength_MPa = 820"));
    let mut browser = Browser::open(&swept.page(), "#w=stress_margin:80&a=band_count:10");
    browser.wait("beltspace.timings.explained > 0");
    browser.choose_file("#other-file", &other.page());
    browser.wait("document.querySelector('#others li')?.innerText.includes('beaten')");
    ranked(&mut browser);
    browser.evaluate("beltspace.openCard(beltspace.page.chosenRow())");
    let axe = axe();
    for theme in ["light", "dark"] {
        browser.evaluate(&format!("(() => {{ beltspace.state.theme = '{theme}'; beltspace.page.applyTheme(); }})()"));
        assert_eq!(broken_rules(&mut browser, &axe), Vec::<String>::new(), "{theme}");
        for id in ["matrix-section", "weigh", "explained"] {
            browser.evaluate(&format!("document.querySelector('#{id}').scrollIntoView()"));
            browser.picture(&format!("choose-{theme}-{id}"));
        }
    }
    browser.evaluate("beltspace.closeCard()");
    browser.resize(400, 800);
    std::thread::sleep(std::time::Duration::from_millis(600));
    assert!(browser.number("document.documentElement.scrollWidth") <= 400.0);
    for id in ["others", "weigh", "ranked", "explained"] {
        browser.evaluate(&format!("document.querySelector('#{id}').scrollIntoView()"));
        browser.picture(&format!("choose-narrow-{id}"));
    }
    browser.resize(1400, 1000);
    let paper = browser.paper();
    assert!(paper.len() > 10_000);
    if let Some(folder) = std::env::var_os("BELTSPACE_PICTURES") {
        std::fs::write(Path::new(&folder).join("choose.pdf"), paper).expect("it can be written");
    }
    assert_eq!(browser.complaints, Vec::<String>::new());
}
