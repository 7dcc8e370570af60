//! Many points and lines on the page of a result, in Chromium: how soon a brush is drawn, what can be told from the ground, and what lies
//! over what.

use crate::browser::Browser;
use crate::random::Random;
use crate::report_page::{Swept, brush};
use serde_json::Value;
use std::fmt::Write as _;

const POINTS: u32 = 100_000;

/// A catalogue whose rows are all on the front, most of them at middle speeds and some far from these.
fn crowded() -> Swept {
    let folder = tempfile::tempdir().expect("there is room");
    let random = &mut Random::new(1);
    let mut rows = String::from("power_kW,slack_tension_N,speed_rpm\n");
    for at in 0..POINTS {
        // More power and less slack tension: each row gives up some of one for the other.
        let part = (f64::from(at) + random.unit()) / f64::from(POINTS);
        let middling = (0..6).map(|_| random.unit()).sum::<f64>() / 6.0;
        let share = if at % 997 == 0 { random.unit() } else { middling };
        writeln!(rows, "{},{},{}", 1.0 + 4.0 * part, 400.0 + 300.0 * part, 2000.0 + 2000.0 * share).expect("text grows");
    }
    std::fs::write(folder.path().join("rows.csv"), rows).expect("it can be written");
    let text = "model = \"pulley-load\"\ntitle = \"A catalogue of 100 000 drives\"\n[design]\ncases = { csv = \"rows.csv\" }\n\
                [objectives]\npower_kW = \"max\"\nslack_tension_N = \"min\"\n[report]\n\
                columns = [\"torque_Nm\", \"resultant_force_N\", \"friction_used\", \"tight_tension_N\"]\n";
    std::fs::write(folder.path().join("catalogue.toml"), text).expect("it can be written");
    Swept::of(folder.path().join("catalogue.toml").to_str().expect("a path of characters"))
}

/// Of all colours on a canvas that are not its ground, the least and the greatest contrast to it.
fn contrasts(browser: &mut Browser, canvas: &str) -> [f64; 2] {
    let found = browser.evaluate(&format!(
        "(() => {{ const from = document.querySelector({canvas:?}); const to = document.createElement('canvas'); \
         [to.width, to.height] = [from.width, from.height]; const context = to.getContext('2d', {{ willReadFrequently: true }}); \
         context.drawImage(from, 0, 0); \
         const seen = new Set(new Uint32Array(context.getImageData(0, 0, to.width, to.height).data.buffer)); \
         const part = (v) => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; \
         const light = (p) => 0.2126 * part(p & 255) + 0.7152 * part((p >> 8) & 255) + 0.0722 * part((p >> 16) & 255); \
         const ground = beltspace.page.pixel(beltspace.page.variable('--plot')); \
         const ratios = [...seen].filter((p) => p >>> 24 === 255 && p !== ground).map(light).map((l) => \
         (Math.max(l, light(ground)) + 0.05) / (Math.min(l, light(ground)) + 0.05)); \
         return [Math.min(...ratios), Math.max(...ratios)]; }})()"
    ));
    serde_json::from_value(found).unwrap_or_else(|_| panic!("nothing is painted on {canvas}"))
}

/// Waits until all lines are drawn.
fn drawn(browser: &mut Browser, what: &str) {
    browser.evaluate("beltspace.timings.linesDone = 0");
    browser.evaluate(what);
    browser.wait("beltspace.timings.linesDone > 0");
    browser.evaluate("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 50)))");
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_hundred_thousand_points_are_brushed_and_a_lone_one_is_seen() {
    let swept = crowded();
    assert_eq!(swept.front().len(), POINTS as usize);
    let mut browser = Browser::open(&swept.page(), "");
    let loaded = browser.number("beltspace.timings.firstPaint");
    brush(&mut browser, "power_kW", "slack_tension_N", [0.1, 0.1], [0.5, 0.95]);
    let selected = browser.number("beltspace.selected().length");
    assert!(selected > 1000.0 && selected < 99_000.0, "{selected}");
    browser.evaluate("beltspace.clear()");
    browser.evaluate("beltspace.chooseColumns('matrix', ['power_kW', 'speed_rpm', 'torque_Nm', 'resultant_force_N'])");
    // Each brush in a frame of its own, as the pointer moves it: what it computes, and what the matrix then takes to draw.
    let times = browser.evaluate(
        "(async () => { const times = []; for (let at = 0; at < 31; at++) { const start = performance.now(); \
         beltspace.brushAxis('power_kW', [1 + 0.06 * at, 3 + 0.06 * at]); const took = performance.now() - start; \
         await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 20)))); \
         times.push([took, beltspace.timings.matrixDraw, beltspace.timings.linesSlice]); } return times; })()",
    );
    let times: Vec<[f64; 3]> = serde_json::from_value(times).expect("times");
    let median = |of: &dyn Fn(&[f64; 3]) -> f64| {
        let mut times: Vec<f64> = times.iter().map(of).collect();
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    };
    let (brushed, slice) = (median(&|it| it[0] + it[1]), median(&|it| it[2]));
    eprintln!(
        "100 000 designs: brushable {loaded:.0} ms after navigation began; a brush takes {:.1} ms and six cells {:.1} ms to draw, \
         a slice of lines {slice:.1} ms, in the median",
        median(&|it| it[0]),
        median(&|it| it[1])
    );
    // On an idle machine half of this; others may be at work here too.
    assert!(brushed < 60.0 && slice < 60.0, "{times:?}");

    for theme in ["light", "dark"] {
        let themed = format!("(() => {{ beltspace.state.theme = '{theme}'; beltspace.page.applyTheme(); }})()");
        for brushed in ["beltspace.clear()", "beltspace.brushAxis('power_kW', [2, 4])"] {
            browser.evaluate(brushed);
            drawn(&mut browser, &themed);
            for canvas in ["#splom canvas", "#parallel canvas"] {
                let [least, most] = contrasts(&mut browser, canvas);
                eprintln!("{theme}, {brushed}: contrasts of {least:.2} to {most:.2} on {canvas}");
                assert!(least >= 3.0, "{theme}, {brushed}: {least} on {canvas}");
                assert!(most > 6.0, "{theme}, {brushed}: density is not seen on {canvas}, {most} at most");
            }
        }
        let said = browser.text("document.querySelector('[data-testid=crowd]').textContent");
        let more = if theme == "light" { "Darker" } else { "Brighter" };
        assert_eq!(said, format!("{more}: more designs in one place"));
        assert!(browser.text("document.querySelector('#crowd-hint').textContent").contains(more));
        browser.picture(&format!("hundred-thousand-{theme}"));
    }
    assert!(browser.complaints.is_empty(), "{:#?}", browser.complaints);
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_pixel_is_the_darker_the_more_points_it_has_and_its_hue_stays() {
    let swept = Swept::shipped("metal-cvt");
    let mut browser = Browser::open(&swept.page(), "#t=light");
    // 1, 30 and 1000 points in three places; 1 and 1000 lines between two axes.
    let painted = browser.evaluate(
        "(() => { const p = beltspace.page; const ground = p.pixel(p.variable('--plot')); const index = new Uint16Array(1031).fill(200); \
         const ofPoint = (i) => (i < 1 ? 4 : i < 31 ? 14 : 24); const places = Int16Array.from(index, (_, i) => ofPoint(i)); \
         const crowd = p.crowd(30, 30); crowd.addPoints(places, places, null, null, index); \
         const target = new Uint32Array(900).fill(ground); crowd.paint(target, p.shades(), true); \
         const shown = (x, y) => { const it = d3.hcl(`rgb(${target[y * 30 + x] & 255},${(target[y * 30 + x] >> 8) & 255},${(target[y * 30 + x] >> 16) & 255})`); return [it.l, it.h]; }; \
         const points = [4, 14, 24].map((at) => shown(at, at)); const bare = target.filter((it) => it === ground).length; \
         crowd.clear(); target.fill(ground); const rows = Uint32Array.from({ length: 1001 }, (_, i) => i); \
         crowd.addLines(rows, 0, 1001, [2, 27], [0, 1].map(() => Float32Array.from(rows, (i) => (i ? 20 : 10))), index); \
         crowd.paint(target, p.shades(), false); return { points, bare, lines: [10, 20].map((y) => shown(15, y)) }; })()",
    );
    let lit = |kind: &str| -> Vec<[f64; 2]> { serde_json::from_value(painted[kind].clone()).expect("lightness and hue") };
    let (points, lines) = (lit("points"), lit("lines"));
    assert!(points[0][0] > points[1][0] + 5.0 && points[1][0] > points[2][0] + 5.0, "{painted}");
    assert!(lines[0][0] > lines[1][0] + 10.0, "{painted}");
    assert_eq!(painted["bare"], 900 - 3 * 4, "each place is two pixels wide and high");
    let apart = |a: f64, b: f64| (a - b + 540.0).rem_euclid(360.0) - 180.0;
    assert!(points.iter().chain(&lines).all(|it| apart(it[1], points[0][1]).abs() < 15.0), "{painted}");
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn the_best_designs_are_painted_over_the_others() {
    let swept = Swept::shipped("metal-cvt");
    let mut browser = Browser::open(&swept.page(), "");
    // Scores by the definition on the page, all weights being equal: the largest loss, and a little of their sum.
    let scores = "(() => { const short = beltspace.page.front.objectives.map(({ column, goal }) => { const span = column.high - column.low; \
                  return Array.from(column.values, (v) => (goal === 'max' ? column.high - v : v - column.low) / span); }); \
                  return short[0].map((_, row) => Math.max(...short.map((it) => it[row])) / short.length + 1e-3 * d3.sum(short, (it) => it[row])); })()";
    let scores: Vec<f64> = serde_json::from_value(browser.evaluate(scores)).expect("a score of each row");
    let order = browser.evaluate("[...beltspace.page.paintOrder()]");
    let order: Vec<usize> = serde_json::from_value(order).expect("rows");
    assert!(order.len() == scores.len() && order.len() > 100, "{} of {}", order.len(), scores.len());
    assert!(order.windows(2).all(|it| scores[it[0]] >= scores[it[1]] - 1e-12), "the order is not from worst to best");
    assert!(scores[order[0]] > scores[order[order.len() - 1]] + 0.1);
    // On the canvas: the middle of the best one has its own colour in every cell, though others lie around it.
    let best = order[order.len() - 1];
    let of_cells = |browser: &mut Browser| {
        browser.evaluate(&format!(
            "(() => {{ const p = beltspace.page; const canvas = document.querySelector('#splom canvas'); const box = canvas.getBoundingClientRect(); \
             const scale = canvas.width / box.width; const context = canvas.getContext('2d'); return [...document.querySelectorAll('#splom .cell')].map((cell) => {{ \
             const frame = cell.querySelector('.frame').getBoundingClientRect(); const extent = Math.round(Number(cell.querySelector('.frame').getAttribute('width')) * scale); \
             const at = (name) => {{ const column = p.front.byName.get(name); const [low, high] = p.wideDomain(column); return (column.values[{best}] - low) / (high - low); }}; \
             const x = Math.round((frame.left - box.left) * scale) + Math.round(at(cell.dataset.x) * (extent - 1)); \
             const y = Math.round((frame.top - box.top) * scale) + Math.round((1 - at(cell.dataset.y)) * (extent - 1)); \
             const [r, g, b] = context.getImageData(x, y, 1, 1).data; return p.pixel(`rgb(${{r}},${{g}},${{b}})`) === p.colours()[{best}]; }}); }})()"
        ))
    };
    let is_on_top = of_cells(&mut browser);
    assert!(is_on_top.as_array().is_some_and(|cells| cells.len() >= 3 && cells.iter().all(|it| *it == true)), "{is_on_top}");
    // Painted first, it is covered somewhere: this would be seen.
    browser.evaluate("(() => { const p = beltspace.page; const order = p.paintOrder; p.paintOrder = () => order().slice().reverse(); p.events.call('colour'); })()");
    browser.evaluate("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 100)))");
    let reversed = of_cells(&mut browser);
    assert!(reversed.as_array().is_some_and(|cells| cells.contains(&Value::Bool(false))), "{reversed}");
}
