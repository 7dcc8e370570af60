//! How soon the page of `beltspace explore` answers, in Chromium.

use crate::browser::Browser;
use crate::explore_page::{COUNT, Explored, SMALL, answered, differs, move_one, open, study_file};
use crate::random::Random;
use beltspace::Study;
use beltspace::models::Models;
use beltspace::plan::Plan;
use std::path::Path;

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn a_hundred_million_evaluations_move_with_a_slider() {
    for file in ["studies/metal-cvt.toml", "benches/studies/metal-cvt-traction.toml"] {
        let explored = Explored::new(Path::new(file), &[]);
        let mut browser = open(&explored);
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
        let text = std::fs::read_to_string(&path).expect("it is there");
        let random = &mut Random::new(7);
        let skipped = browser.number("beltspace.timings.answers.length");
        // Enough for the slowest twentieth to be more than two or three of them.
        for round in 0..120 {
            move_one(&mut browser, random);
            if round % 12 == 11 {
                assert_eq!(differs(&mut browser, &text, path.parent().expect("it has a folder")), None, "{file}, round {round}");
                browser.evaluate(COUNT);
                browser.evaluate("beltspace.page.resetChanges()");
                answered(&mut browser);
            }
        }
        let answers = browser.evaluate("beltspace.timings.answers.map((it) => [it.took, it.engine, it.set])");
        let answers: Vec<(Option<f64>, f64, Vec<String>)> = serde_json::from_value(answers).expect("times");
        let folder = path.parent().expect("it has a folder");
        let evaluations = |set: &[String]| {
            let (study, _) = Study::parse_set(&Models::new(), &text, "study.toml", folder, set).expect("the engine took it");
            let plan = Plan::new(study);
            plan.designs() as f64 * plan.scenarios() as f64
        };
        let moves = answers.iter().skip(skipped as usize);
        let moves = moves.filter_map(|(took, engine, set)| Some(((*took)?, 1000.0 * engine, evaluations(set))));
        let moves: Vec<(f64, f64, f64)> = moves.collect();
        // Moves add up, and some make the study larger: those of about its own size are told by themselves.
        let own = 1.1 * evaluations(&[]);
        let mut median = f64::NAN;
        for (which, most) in [("moves", f64::INFINITY), ("of these whose study is no larger than the file's", own)] {
            let part = || moves.iter().filter(|it| it.2 <= most);
            let at = |of: &dyn Fn(&(f64, f64, f64)) -> f64, share: f64| {
                let mut times: Vec<f64> = part().map(of).collect();
                times.sort_by(f64::total_cmp);
                times[((times.len() - 1) as f64 * share).round() as usize]
            };
            let (took, engine) = (|it: &(f64, f64, f64)| it.0, |it: &(f64, f64, f64)| it.1);
            median = at(&took, 0.5);
            eprintln!(
                "{file}: {} {which}, from the event to the painted exact front: median {median:.0} ms, 95 % within {:.0} ms; the engine: median {:.0} ms, 95 % within {:.0} ms",
                part().count(),
                at(&took, 0.95),
                at(&engine, 0.5),
                at(&engine, 0.95),
            );
        }
        assert!(moves.len() >= 80, "{}", moves.len());
        // Other programs may be at work here too; the measure is in the lines above.
        assert!(median < 1000.0, "{moves:?}");
        assert_eq!(browser.complaints, Vec::<String>::new());
    }
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn a_billion_designs_answer_coarsely_first() {
    let text = SMALL.replace("count = 7 }", "count = 1501 }").replace("step = 0.02", "count = 2001").replace("count = 5 }", "count = 41 }");
    let (_folder, file) = study_file(&text);
    let explored = Explored::new(&file, &[]);
    let mut browser = Browser::open_at(&explored.address);
    browser.wait("beltspace.page.front && beltspace.page.front.rows > 0");
    let designs = browser.number("beltspace.page.data.study.designs");
    assert!(designs > 1e9, "{designs}");
    assert_eq!(browser.text("document.querySelector('#live').dataset.kind"), "coarse");
    let times: Vec<f64> = (0..8)
        .map(|round| {
            let bound = 0.005 * f64::from(round);
            browser.number(&format!(
                "new Promise((done) => {{ const start = performance.now(); beltspace.timings.coarse = 0; \
                 beltspace.change({{ 'constraints.slip_margin.min': '{bound}' }}); const look = () => beltspace.timings.coarse > start ? \
                 requestAnimationFrame(() => done(performance.now() - start)) : setTimeout(look, 1); look(); }})"
            ))
        })
        .collect();
    let mut sorted = times.clone();
    sorted.sort_by(f64::total_cmp);
    eprintln!(
        "{designs:.2e} designs: a coarse front after {:.0} ms in the median, {:.0} ms at most",
        sorted[sorted.len() / 2],
        sorted[sorted.len() - 1]
    );
    assert!(sorted[sorted.len() / 2] < 1500.0, "{times:?}");
    browser.picture("explore-coarse");
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored explore_page --test-threads 1"]
fn a_question_is_given_up_at_its_coarse_front_where_the_exact_one_takes_long() {
    let (_folder, file) = study_file(SMALL);
    let explored = Explored::new(&file, &[]);
    let mut browser = open(&explored);
    // Two changes in a row, of which the second waits; then the first one's coarse front, whose exact one comes after so many seconds. How
    // many questions have been asked before it, and how many at once after it?
    let mut asked = |exact_after: f64, bound: f64| {
        let counts = browser.text(&format!(
            "(() => {{ const p = beltspace.page; const ask = p.ask; let asked = 0; let tell = null; \
             p.ask = (path, question, each, signal) => {{ if (path !== '/answer') return ask(path, question, each, signal); \
             asked++; tell = each; return new Promise(() => {{}}); }}; \
             beltspace.change({{ 'constraints.slip_margin.min': '{bound}' }}); const first = tell; \
             beltspace.change({{ 'constraints.slip_margin.min': '{}' }}); const before = asked; \
             first({{ kind: 'coarse', looked_at: 1, exact_after: {exact_after}, front: {{ rows: 0 }} }}, new ArrayBuffer(0)); \
             p.ask = ask; return `${{before}} ${{asked}}`; }})()",
            bound + 0.001
        ));
        browser.evaluate(COUNT);
        browser.evaluate("beltspace.page.resetChanges()");
        answered(&mut browser);
        counts
    };
    assert_eq!((asked(0.05, 0.01), asked(5.0, 0.02), asked(0.1, 0.03)), ("1 1".to_owned(), "1 2".to_owned(), "1 1".to_owned()));
    assert_eq!(differs(&mut browser, SMALL, file.parent().expect("it has a folder")), None);
}
