//! Weights, trade-offs and what explains the feasible designs on the page of `beltspace explore`, while the study changes.

use crate::browser::Browser;
use crate::explore_page::{COUNT, Explored, SMALL, answered, axe, broken_rules, open, study_file};
use crate::report_page::Swept;
use std::collections::BTreeMap;

/// The first designs that the page ranks, once it has tried all sets of weights.
fn ranked(browser: &mut Browser) -> Vec<String> {
    browser.wait("document.querySelector('#ranked').dataset.done === 'yes'");
    let found = browser.evaluate(
        "[...document.querySelectorAll('#ranked tbody tr')].slice(0, 5).map((it) => beltspace.page.designOf(Number(it.dataset.row)))",
    );
    serde_json::from_value(found).expect("texts")
}

/// The same of a fresh front, by the definition on the page, with weights of 90, 50 and 50.
fn expected(browser: &mut Browser) -> Vec<String> {
    let front = browser.evaluate(
        "({ index: [...beltspace.page.front.index.exact], columns: ['axial_force_N', 'stress_margin', 'slip_margin'].map((name) => [...beltspace.page.front.byName.get(name).values]) })",
    );
    let index: Vec<String> = serde_json::from_value(front["index"].clone()).expect("texts");
    let columns: Vec<Vec<f64>> = serde_json::from_value(front["columns"].clone()).expect("numbers");
    let short = columns.iter().zip([1.0, -1.0, -1.0]).map(|(values, sign)| {
        let (low, high) = values.iter().map(|it| sign * it).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), it| (it.min(a), it.max(b)));
        values.iter().map(|it| (sign * it - low) / (high - low)).collect::<Vec<_>>()
    });
    let short: Vec<Vec<f64>> = short.collect();
    let score = |row: usize| {
        let largest = short.iter().zip([90.0, 50.0, 50.0]).map(|(it, weight)| weight / 190.0 * it[row]).fold(f64::NEG_INFINITY, f64::max);
        largest + 1e-3 * short.iter().map(|it| it[row]).sum::<f64>()
    };
    let mut rows: Vec<usize> = (0..index.len()).collect();
    rows.sort_by(|&a, &b| score(a).total_cmp(&score(b)).then(a.cmp(&b)));
    rows.into_iter().take(5).map(|row| index[row].clone()).collect()
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn weights_stay_while_the_study_changes_and_rank_each_new_front() {
    let (_folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    browser.click_on("#weigh summary");
    browser.evaluate("(() => { const e = document.querySelector('[data-weight=axial_force_N]'); e.value = 90; e.dispatchEvent(new Event('input', { bubbles: true })); })()");
    let first = ranked(&mut browser);
    assert_eq!(first, expected(&mut browser));
    browser.evaluate(COUNT);
    browser.evaluate("document.querySelector('#ranked').dataset.done = 'no'; beltspace.change({ 'constraints.slip_margin.min': '0.15' })");
    answered(&mut browser);
    browser.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))");
    let second = ranked(&mut browser);
    assert_eq!(second, expected(&mut browser));
    assert_ne!(first, second, "another front has another order");
    browser.wait(&format!("document.querySelector('#open-knee')?.textContent.includes('the first: design {}')", second[0]));
    // Its card has trade-offs, and keeps all outputs when a weight moves.
    browser.evaluate("beltspace.openCard(beltspace.page.chosenRow())");
    browser.wait("document.querySelector('#all-outputs table') && document.querySelectorAll('#tradeoffs [data-trade]').length >= 2");
    assert!(browser.text("document.querySelector('#card-title').textContent").contains("first by weights"));
    browser.evaluate("beltspace.page.setWeight('slip_margin', 100)");
    assert_eq!(browser.evaluate("document.querySelector('#all-outputs table') !== null"), true);
    browser.evaluate("beltspace.page.setWeight('slip_margin', 50)");
    // An address brings weights and changes back.
    browser.wait("location.hash.includes('w=axial_force_N:90') && location.hash.includes('s=constraints.slip_margin.min')");
    let hash = browser.text("location.hash");
    let address = explored.address.split("/?").next().expect("it has a host").to_owned();
    browser.go_to_address(&format!("{address}/{hash}"));
    answered(&mut browser);
    assert_eq!(ranked(&mut browser), second, "{hash}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn what_explains_the_feasible_designs_follows_the_study() {
    let (_folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    let shares = "Object.fromEntries([...document.querySelectorAll('#explained [data-share]')].map((it) => [it.dataset.of, Number(it.dataset.share)]))";
    let mut seen = Vec::new();
    for set in ["", "constraints.stress_margin.min=0.1"] {
        if let Some((part, value)) = set.split_once('=') {
            browser.evaluate(COUNT);
            browser.evaluate(&format!("beltspace.timings.explained = 0; beltspace.change({{ '{part}': '{value}' }})"));
            answered(&mut browser);
        }
        browser.wait("beltspace.timings.explained > 0");
        let found: BTreeMap<String, f64> = serde_json::from_value(browser.evaluate(shares)).expect("numbers");
        // A sweep that samples as many designs, which are all feasible ones here, gives the same shares.
        let least = if set.is_empty() { "0" } else { "0.1" };
        let text = SMALL.replace("[report]\n", "[report]\nsample = 2000\n");
        let text = text.replace("stress_margin = { min = 0 }", &format!("stress_margin = {{ min = {least} }}"));
        let rows = Swept::text(&text).table("sample.csv");
        for axis in ["groove_angle_deg", "band_thickness_mm", "band_count", "traction"] {
            let values: Vec<(u64, f64)> = rows
                .iter()
                .map(|row| [axis, "axial_force_N"].map(|it| row[it].parse::<f64>().expect("a number")))
                .map(|[level, value]| (level.to_bits(), value))
                .collect();
            let mean = |it: &mut dyn Iterator<Item = f64>| {
                let (sum, n) = it.fold((0.0, 0.0), |(sum, n), value| (sum + value, n + 1.0));
                sum / n
            };
            let all = mean(&mut values.iter().map(|it| it.1));
            let mut groups: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
            values.iter().for_each(|(level, value)| groups.entry(*level).or_default().push(*value));
            let within: f64 = groups
                .values()
                .map(|it| {
                    let own = mean(&mut it.iter().copied());
                    it.iter().map(|value| (value - own).powi(2)).sum::<f64>()
                })
                .sum();
            let total: f64 = values.iter().map(|it| (it.1 - all).powi(2)).sum();
            let n = values.len() as f64;
            let expected = 1.0 - within / (n - groups.len() as f64) * (n - 1.0) / total;
            let shown = found[&format!("{axis} axial_force_N")];
            assert!((shown - expected).abs() < 2e-4, "{axis}: {shown}, by its definition {expected}");
        }
        let said = browser.text("document.querySelector('#explained').innerText").replace('\u{202f}', "");
        assert!(said.contains(&format!("all {} feasible designs", rows.len())), "{} {said}", rows.len());
        seen.push(found);
    }
    assert_ne!(seen[0], seen[1]);
    assert_eq!(broken_rules(&mut browser, &axe()), Vec::<String>::new());
    browser.evaluate("document.querySelector('#explained').scrollIntoView()");
    browser.picture("explore-explained");
    assert_eq!(browser.complaints, Vec::<String>::new());
}
