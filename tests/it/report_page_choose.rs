//! What the page of a result says beyond its files, computed once more by other means: the order by weights, trade-offs, and what explains
//! the feasible designs.

use crate::browser::Browser;
use crate::report_page::{Swept, number};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Objectives of a study: name, and whether more of it is better.
pub type Goals<'a> = &'a [(&'a str, bool)];

const METAL: Goals<'static> =
    &[("axial_force_upper_N", false), ("stress_margin", true), ("clamping_utilisation", false), ("band_count", false)];

/// Objectives of every design so that less is better: `[design][objective]`.
pub fn points(table: &[BTreeMap<String, String>], goals: Goals<'_>) -> Vec<Vec<f64>> {
    let point = |row: &BTreeMap<String, String>| {
        goals.iter().map(|(name, more)| if *more { -number(&row[*name]) } else { number(&row[*name]) }).collect()
    };
    table.iter().map(point).collect()
}

/// Least and largest value of every objective.
fn ends(points: &[Vec<f64>]) -> Vec<(f64, f64)> {
    let of = |at: usize| points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (low.min(it[at]), high.max(it[at])));
    (0..points[0].len()).map(of).collect()
}

/// How far each objective of a design is from the best value, or from the wished one: the definition on the page.
fn shortfalls(points: &[Vec<f64>], wishes: &[Option<f64>]) -> Vec<Vec<f64>> {
    let ends = ends(points);
    let scaled = |at: usize, value: f64| (value - ends[at].0) / (ends[at].1 - ends[at].0);
    let short =
        |point: &Vec<f64>| (0..point.len()).map(|at| scaled(at, point[at]) - wishes[at].map_or(0.0, |wish| scaled(at, wish))).collect();
    points.iter().map(short).collect()
}

fn score(short: &[f64], weights: &[f64]) -> f64 {
    let products = short.iter().zip(weights).filter(|(_, weight)| **weight > 0.0).map(|(short, weight)| short * weight);
    products.fold(f64::NEG_INFINITY, f64::max) + 1e-3 * short.iter().sum::<f64>()
}

/// Rows from the least score to the largest.
fn order(short: &[Vec<f64>], weights: &[f64]) -> Vec<usize> {
    let mut rows: Vec<usize> = (0..short.len()).collect();
    rows.sort_by(|&a, &b| score(&short[a], weights).total_cmp(&score(&short[b], weights)).then(a.cmp(&b)));
    rows
}

/// The page's generator of random numbers, mulberry32.
struct Mulberry(u32);

impl Mulberry {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x6d2b_79f5);
        let mut mixed = (self.0 ^ self.0 >> 15).wrapping_mul(1 | self.0);
        mixed = mixed.wrapping_add((mixed ^ mixed >> 7).wrapping_mul(61 | mixed)) ^ mixed;
        f64::from(mixed ^ mixed >> 14) / 4_294_967_296.0
    }
}

/// How often each design comes first, by looking at all of them in all sets.
fn wins(short: &[Vec<f64>], weights: &[f64], near: bool) -> BTreeMap<usize, u32> {
    let mut random = Mulberry(22);
    let mut wins = BTreeMap::new();
    for _ in 0..1000 {
        let set: Vec<f64> = if near {
            weights.iter().map(|it| it * (0.8 + 0.4 * random.next())).collect()
        } else {
            let parts: Vec<f64> = weights.iter().map(|_| -(1.0 - random.next()).ln()).collect();
            let sum: f64 = parts.iter().sum();
            parts.iter().map(|it| it / sum).collect()
        };
        let first = (0..short.len()).min_by(|&a, &b| score(&short[a], &set).total_cmp(&score(&short[b], &set))).expect("there are designs");
        *wins.entry(first).or_insert(0) += 1;
    }
    wins
}

/// Rows of the table of first designs, each with how often it comes first, once all sets were tried.
pub fn ranked(browser: &mut Browser) -> Vec<(usize, u32)> {
    browser.wait("document.querySelector('#ranked').dataset.done === 'yes'");
    let rows = browser.evaluate(
        "[...document.querySelectorAll('#ranked tbody tr')].map((it) => [Number(it.dataset.row), Number(it.querySelector('[data-wins]').dataset.wins)])",
    );
    serde_json::from_value(rows).expect("rows and numbers")
}

/// Puts a slider or a field to a value, as a hand does.
fn set(browser: &mut Browser, selector: &str, value: &str, event: &str) {
    browser.evaluate(&format!(
        "(() => {{ const e = document.querySelector({selector:?}); document.querySelector('#ranked').dataset.done = 'no'; \
         e.value = {value:?}; e.dispatchEvent(new Event({event:?}, {{ bubbles: true }})); }})()"
    ));
    browser.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))");
}

fn weight(browser: &mut Browser, name: &str, value: &str) {
    set(browser, &format!("[data-weight={name}]"), value, "input");
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn weights_and_wishes_rank_the_front_and_say_how_stable_that_is() {
    let swept = Swept::shipped("metal-cvt");
    let table = swept.front();
    let points = points(&table, METAL);
    let mut browser = Browser::open(&swept.page(), "");
    // Without weights the knee stands for equal ones.
    browser.click_on("#weigh summary");
    let said = browser.text("document.querySelector('#ranked').innerText");
    let knee = browser.text("beltspace.page.designOf(beltspace.page.front.knee)");
    assert!(said.contains("All weights are equal") && said.contains(&format!("design {knee}")), "{said}");
    assert!(browser.text("document.querySelector('#open-knee').textContent").contains(&format!("the knee: design {knee}")));
    browser.picture("weigh-equal");

    // One weight by the keyboard, from 50 to 51.
    browser.evaluate("document.querySelector('[data-weight=stress_margin]').focus()");
    browser.key("ArrowRight", 39);
    browser.wait("beltspace.page.weightOf('stress_margin') === 51");
    weight(&mut browser, "axial_force_upper_N", "90");
    weight(&mut browser, "band_count", "0");
    let given = [90.0, 51.0, 50.0, 0.0];
    let sum: f64 = given.iter().sum();
    let weights: Vec<f64> = given.iter().map(|it| it / sum).collect();
    let short = shortfalls(&points, &[None; 4]);
    let expected = order(&short, &weights);
    let all = wins(&short, &weights, true);
    let shown = ranked(&mut browser);
    assert_eq!(shown.iter().take(5).map(|it| it.0).collect::<Vec<_>>(), expected[..5], "the first five");
    assert!(shown.iter().all(|(row, count)| all.get(row).copied().unwrap_or(0) == *count), "{shown:?} {all:?}");
    let rest: u32 = all.iter().filter(|(row, _)| shown.iter().all(|it| it.0 != **row)).map(|it| it.1).sum();
    let said = browser.text("document.querySelector('#ranked').innerText");
    assert_eq!(rest > 0, said.contains("in the remaining"), "{rest} {said}");
    assert_ne!(order(&short, &[0.25; 4])[0], expected[0], "weights that change nothing would not be noticed");
    // Every view names the first design in place of the knee.
    let first = &table[expected[0]]["design_index"];
    assert!(browser.text("document.querySelector('#open-knee').textContent").contains(first));
    assert!(browser.text("document.querySelector('#readout').innerText").contains("first by weights"));
    let place = browser.evaluate(&format!(
        "(() => {{ const p = beltspace.page; const x = p.front.byName.get('axial_force_upper_N'); const [low, high] = p.wideDomain(x); \
         const size = Number(document.querySelector('.cell .frame').getAttribute('width')); \
         return [document.querySelector('.cell .knee').getAttribute('d').slice(1).split(',')[0], size * (x.values[{}] - low) / (high - low)]; }})()",
        expected[0]
    ));
    let drawn = number(place[0].as_str().expect("a place"));
    assert!((drawn - place[1].as_f64().expect("a place")).abs() < 0.01, "{place}");

    // A wished value counts from there; a field that is emptied wishes for nothing.
    set(&mut browser, "[data-wish=stress_margin]", "0.15", "change");
    let short = shortfalls(&points, &[None, Some(-0.15), None, None]);
    let expected = order(&short, &weights);
    let shown = ranked(&mut browser);
    assert_eq!(shown.iter().take(5).map(|it| it.0).collect::<Vec<_>>(), expected[..5]);
    let reached = table.iter().filter(|row| number(&row["stress_margin"]) >= 0.15).count();
    let said = browser.text("document.querySelector('#ranked').innerText").replace('\u{202f}', "");
    assert!(said.contains(&format!("{reached} of {} designs on the front reach every wished value", table.len())), "{reached}: {said}");
    set(&mut browser, "#near", "any", "change");
    let all = wins(&short, &weights, false);
    let shown = ranked(&mut browser);
    assert!(shown.iter().all(|(row, count)| all.get(row).copied().unwrap_or(0) == *count), "{shown:?} {all:?}");
    assert!(shown.len() > 5 && all.len() > 3, "{all:?}");
    browser.evaluate("document.querySelector('#weigh').scrollIntoView()");
    browser.picture("weigh");

    // All of it is in the address, and comes back.
    browser.wait("location.hash.includes('wn=any')");
    let hash = browser.text("location.hash");
    assert!(hash.contains("a=stress_margin:0.15") && hash.contains("axial_force_upper_N:90"), "{hash}");
    browser.go_to(&swept.page(), &hash);
    assert_eq!(ranked(&mut browser), shown, "{hash}");
    assert_eq!(browser.text("document.querySelector('[data-wish=stress_margin]').value"), "0.15");
    browser.click_on("#clear-weights");
    browser.wait("document.querySelector('#ranked').innerText.includes('All weights are equal')");
    browser.wait("!location.hash.includes('w=') && !location.hash.includes('a=')");
    // What makes no sense in an address is left out.
    for hash in ["#w=axial_force_upper_N:900,nothing:3,stress_margin", "#w=%E0%A4%A:1&a=stress_margin:x&wn=__proto__", "#a=:&w=:"] {
        browser.go_to(&swept.page(), hash);
        assert_eq!(browser.evaluate("beltspace.page.isWeighed()"), false, "{hash}");
    }
    assert_eq!(browser.complaints, Vec::<String>::new());
}

/// Rates of a design by their definition, pair by pair: of `b` for each unit of `a`, with the row of the neighbour.
fn rate(points: &[Vec<f64>], row: usize, a: usize, b: usize, gain: bool) -> Option<f64> {
    let ends = ends(points);
    let range = |at: usize| ends[at].1 - ends[at].0;
    let by = |other: usize, at: usize| {
        let by = points[row][at] - points[other][at];
        if by.abs() <= 1e-9 * range(at) { 0.0 } else { by }
    };
    let sign = if gain { -1.0 } else { 1.0 };
    let away = |other: usize| sign * by(other, a);
    let next = (0..points.len()).map(away).filter(|it| *it > 0.0).fold(f64::INFINITY, f64::min);
    let reach = (0.1 * range(a)).max(next) * (1.0 + 1e-12);
    let no_worse = |other: usize, without: &[usize]| (0..points[row].len()).all(|at| without.contains(&at) || by(other, at) >= 0.0);
    let near = (0..points.len()).filter(|&it| away(it) > 0.0 && away(it) <= reach);
    let rates = near.filter(|&it| if gain { no_worse(it, &[a]) && by(it, b) > 0.0 } else { no_worse(it, &[b]) && by(it, b) < 0.0 });
    let rates = rates.map(|it| by(it, b).abs() / away(it));
    if gain { rates.reduce(f64::max) } else { rates.reduce(f64::min) }
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn trade_offs_are_those_of_neighbours_on_the_front() {
    // By hand: from 2 kW at 410 N, a kilowatt more takes 30 N, and one less saves 10 N.
    let folder = tempfile::tempdir().expect("there is room");
    std::fs::write(folder.path().join("rows.csv"), "power_kW,slack_tension_N\n1,400\n2,410\n3,440\n").expect("it can be written");
    let text =
        "model = \"pulley-load\"\n[design]\ncases = { csv = \"rows.csv\" }\n[objectives]\npower_kW = \"max\"\nslack_tension_N = \"min\"\n";
    std::fs::write(folder.path().join("study.toml"), text).expect("it can be written");
    let swept = Swept::of(folder.path().join("study.toml").to_str().expect("a path of characters"));
    let mut browser = Browser::open(&swept.page(), "");
    let cells = "Object.fromEntries([...document.querySelectorAll('#tradeoffs [data-trade]')].map((it) => [it.dataset.trade, Number(it.dataset.rate)]))";
    browser.evaluate("beltspace.openCard(beltspace.page.rowOf('1'))");
    let expected = json!({ "cost power_kW slack_tension_N": 30.0, "gain power_kW slack_tension_N": 10.0,
        "cost slack_tension_N power_kW": 0.1, "gain slack_tension_N power_kW": 1.0 / 30.0 });
    let numbers = |it: &Value| -> BTreeMap<String, f64> { serde_json::from_value(it.clone()).expect("numbers") };
    let shown = numbers(&browser.evaluate(cells));
    for (name, value) in numbers(&expected) {
        assert!((shown[&name] - value).abs() < 1e-12, "{name}: {shown:?}");
    }
    // The step is 1 kW, which is counted in whole numbers here, and 1 % of the tension; the text says what it costs.
    let said = browser.text("document.querySelector('#tradeoffs').innerText").replace('\t', " ");
    assert!(said.contains("power_kW by 1 kW") && said.contains("+30") && said.contains("−10"), "{said}");
    // At the end of the front there is no neighbour on one side.
    browser.evaluate("beltspace.openCard(beltspace.page.rowOf('0'))");
    let shown = numbers(&browser.evaluate(cells));
    assert_eq!(shown.keys().map(String::as_str).collect::<Vec<_>>(), ["cost power_kW slack_tension_N", "gain slack_tension_N power_kW"]);
    assert!(browser.text("document.querySelector('#tradeoffs').innerText").contains("–: the front has no such neighbour"));

    // Many designs and four objectives, by brute force.
    let swept = Swept::shipped("metal-cvt");
    let points = points(&swept.front(), METAL);
    let mut browser = Browser::open(&swept.page(), "");
    let (mut there, mut absent) = (0, 0);
    for row in (0..points.len()).step_by(97) {
        browser.evaluate(&format!("beltspace.openCard({row})"));
        let shown = numbers(&browser.evaluate(cells));
        for (a, (of, _)) in METAL.iter().enumerate() {
            for (b, (in_, _)) in METAL.iter().enumerate().filter(|(b, _)| *b != a) {
                for (key, gain) in [("cost", false), ("gain", true)] {
                    let expected = rate(&points, row, a, b, gain);
                    let found = shown.get(&format!("{key} {of} {in_}")).copied();
                    match (expected, found) {
                        (Some(expected), Some(found)) => assert!((expected - found).abs() <= 1e-9 * expected, "row {row} {key} {of} {in_}"),
                        (None, None) => absent += 1,
                        other => panic!("row {row} {key} {of} {in_}: {other:?}"),
                    }
                    there += usize::from(expected.is_some());
                }
            }
        }
    }
    assert!(there > 100 && absent > 50, "{there} rates, {absent} absent");
    assert!((rate(&points, 97, 0, 1, false).or(rate(&points, 97, 0, 2, false))).is_some_and(|it| it > 0.0));
    browser.picture("tradeoffs");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

/// The share of the variance between levels, corrected for their number, by its definition.
fn share(levels: &[f64], values: &[f64]) -> f64 {
    let mean = |it: &[f64]| it.iter().sum::<f64>() / it.len() as f64;
    let squares = |it: &[f64]| it.iter().map(|value| (value - mean(it)).powi(2)).sum::<f64>();
    let mut groups: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    levels.iter().zip(values).for_each(|(level, value)| groups.entry(level.to_bits()).or_default().push(*value));
    let within: f64 = groups.values().map(|it| squares(it)).sum();
    let n = values.len() as f64;
    1.0 - within / (n - groups.len() as f64) * (n - 1.0) / squares(values)
}

/// Every design is feasible; `sum` is 3 of one axis and 1 of another.
const ADDED: &str = r#"
model = "metal-cvt"
title = "What adds up"
[design]
groove_angle_deg = { from = 18, to = 30, count = 13 }
band_count       = { from = 6, to = 14 }
strength_MPa     = [800, 900]
[formulas]
sum = "3 * groove_angle_deg / 12[deg] + band_count / 8"
[objectives]
axial_force_N = "min"
stress_margin = "max"
[report]
columns = ["sum"]
sample = COUNT
"#;

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn what_explains_the_feasible_designs_is_their_share_of_the_variance() {
    let shares = "Object.fromEntries([...document.querySelectorAll('#explained [data-share]')].map((it) => [it.dataset.of, Number(it.dataset.share)]))";
    let halves =
        "[...document.querySelectorAll('#explained [data-of$=\" stress_margin\"]')].map((it) => Number(it.textContent.split('±')[1]))";
    let swept = Swept::text(&ADDED.replace("COUNT", "2000"));
    let mut browser = Browser::open(&swept.page(), "");
    browser.wait("beltspace.timings.explained > 0");
    let found: BTreeMap<String, f64> = serde_json::from_value(browser.evaluate(shares)).expect("numbers");
    let table = swept.table("sample.csv");
    assert_eq!(table.len(), 234, "every design is feasible and in the sample");
    let column = |name: &str| -> Vec<f64> { table.iter().map(|row| number(&row[name])).collect() };
    let axes = ["groove_angle_deg", "band_count", "strength_MPa"];
    for of in ["axial_force_N", "stress_margin", "sum"] {
        for axis in axes {
            let expected = share(&column(axis), &column(of));
            let shown = found[&format!("{axis} {of}")];
            assert!((shown - expected).abs() < 2e-4, "{axis} {of}: {shown}, by its definition {expected}");
        }
    }
    // On paper: a uniform grid of L levels over a width w has the variance w^2 (L + 1) / (12 (L - 1)), and sums add up.
    let variance = |width: f64, levels: f64| width * width * (levels + 1.0) / (12.0 * (levels - 1.0));
    let (angle, bands) = (variance(3.0, 13.0), variance(1.0, 9.0));
    assert!((found["groove_angle_deg sum"] - angle / (angle + bands)).abs() < 0.01, "{found:?}");
    assert!(found["strength_MPa sum"].abs() < 0.01 && (found["band_count sum"] - bands / (angle + bands)).abs() < 0.05, "{found:?}");
    let said = browser.text("document.querySelector('#explained').innerText");
    assert!(said.contains("all 234 feasible designs") && said.contains("200 resamples (bootstrap, seed 22)"), "{said}");
    let first = browser.text("document.querySelector('#explained').innerText");
    let wide: Vec<f64> = serde_json::from_value(browser.evaluate(halves)).expect("numbers");
    browser.go_to(&swept.page(), "");
    browser.wait("beltspace.timings.explained > 0");
    assert_eq!(browser.text("document.querySelector('#explained').innerText"), first, "the same each time");
    browser.evaluate("document.querySelector('#explained').scrollIntoView()");
    browser.picture("explained");

    // A smaller sample is less sure of itself; too small a one says nothing.
    browser.go_to(&Swept::text(&ADDED.replace("COUNT", "60")).page(), "");
    browser.wait("beltspace.timings.explained > 0");
    let wider: Vec<f64> = serde_json::from_value(browser.evaluate(halves)).expect("numbers");
    let sum = |it: &[f64]| it.iter().sum::<f64>();
    assert!(wide.len() == 3 && sum(&wider) > 1.4 * sum(&wide) && sum(&wide) > 0.0, "{wide:?} {wider:?}");
    assert!(browser.text("document.querySelector('#explained').innerText").contains("a sample of 60 feasible designs"));
    let (few, none) = (Swept::text(&ADDED.replace("COUNT", "12")), Swept::text(&ADDED.replace("sample = COUNT\n", "")));
    let influence = "sample = 100\nsensitivity = { over = \"design\" }\n";
    let asked = Swept::text(&ADDED.replace("sample = COUNT\n", influence));
    for (swept, words) in [(&few, "too few to say"), (&none, "sample = 2000"), (&asked, "asked for this itself")] {
        browser.go_to(&swept.page(), "");
        browser.wait(&format!("document.querySelector('#explained').innerText.includes({words:?})"));
        assert_eq!(browser.number("document.querySelectorAll('#explained [data-share]').length"), 0.0);
    }
    browser.click_on("#to-sensitivity");
    assert_eq!(browser.evaluate("document.activeElement.matches('#table-sensitivity, [data-figure^=sensitivity]')"), true);
    assert_eq!(browser.complaints, Vec::<String>::new());
}
