//! The page of a result on paper: Chromium's PDF, read again by poppler-utils.

use crate::browser::{Browser, is_firefox};
use crate::explore_page::{Explored, SMALL, open, study_file};
use crate::report_page::Swept;
use std::path::{Path, PathBuf};
use std::process::Command;

fn read_by(program: &str, words: &[&str]) -> String {
    let output = Command::new(program).args(words).output().expect("poppler-utils are there");
    assert!(output.status.success(), "{program}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// How far down each page has ink, from 0 to 1.
fn filled(file: &Path) -> Vec<f64> {
    let folder = tempfile::tempdir().expect("there is room");
    let base = folder.path().join("page");
    read_by("pdftoppm", &["-r", "40", "-gray", file.to_str().expect("a path of characters"), base.to_str().expect("a path of characters")]);
    let mut pages: Vec<PathBuf> = std::fs::read_dir(folder.path()).expect("a folder").map(|it| it.expect("a file").path()).collect();
    pages.sort();
    pages.iter().map(|page| inked(&std::fs::read(page).expect("a picture"))).collect()
}

/// The lowest row of a PGM with a pixel that is not white, over its height.
fn inked(pgm: &[u8]) -> f64 {
    let head: Vec<&[u8]> = pgm.splitn(4, |it| it.is_ascii_whitespace()).take(3).collect();
    let number = |at: usize| std::str::from_utf8(head[at]).expect("a number").parse::<usize>().expect("a number");
    let (width, height) = (number(1), number(2));
    let pixels = &pgm[pgm.len() - width * height..];
    let last = pixels.chunks(width).rposition(|row| row.iter().any(|&it| it < 200)).unwrap_or(0);
    last as f64 / height as f64
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn the_page_is_printed_without_broken_numbers_and_half_empty_pages() {
    let swept = Swept::shipped("metal-cvt");
    let mut browser = Browser::open(&swept.page(), "");
    browser.wait("beltspace.timings.explained");
    let file = swept.folder.path().join("page.pdf");
    std::fs::write(&file, browser.paper()).expect("it can be written");
    let of_page =
        |page: &str| read_by("pdftotext", &["-layout", "-f", page, "-l", page, file.to_str().expect("a path of characters"), "-"]);
    // The question stands on the first page, with the front below it.
    let first = of_page("1");
    assert!(first.contains("Push belt for 150 N m") && first.contains("must hold") && first.contains("in every scenario of"), "{first}");
    assert!(first.contains("Pareto front"), "{first}");
    let whole = read_by("pdftotext", &["-layout", file.to_str().expect("a path of characters"), "-"]);
    // Indices and values of the designs that are listed are whole.
    for row in swept.front().iter().take(30) {
        let index = &row["design_index"];
        assert!(whole.split_whitespace().any(|it| it == index), "{index} is broken");
    }
    assert!(whole.contains("Around design") && whole.contains("clamping_force_N = "), "{whole}");
    // The list of single designs is whole, from its first column to its last.
    let listed = whole.split_once("Best single designs").expect("the list is printed").1;
    for row in swept.table("top.csv") {
        let columns = row.keys().filter(|it| !it.ends_with("_scenario")).count();
        let line =
            listed.lines().find(|line| line.split_whitespace().next() == Some(&row["design_index"])).expect("each design has a line");
        assert_eq!(line.split("  ").filter(|it| !it.is_empty()).count(), columns, "{line}");
    }
    let is_filled = |file: &Path| {
        let filled = filled(file);
        eprintln!("{} pages, filled to {filled:.2?}", filled.len());
        assert!((3..=9).contains(&filled.len()), "{filled:?}");
        assert!(filled[..filled.len() - 1].iter().all(|&it| it > 0.6), "{filled:?}");
    };
    is_filled(&file);
    // So with a range that is not an objective's, which has a note below it.
    browser.evaluate("beltspace.brushAxis('slip_margin', [0, 0.1])");
    browser.wait("!document.querySelector('#brush-note').hidden");
    std::fs::write(&file, browser.paper()).expect("it can be written");
    is_filled(&file);
    browser.evaluate("beltspace.clear()");
    // The data sheet of a design is what its card says, drawing included.
    browser.evaluate("beltspace.openCard(beltspace.page.front.knee)");
    browser.evaluate("document.body.classList.add('sheet')");
    std::fs::write(&file, browser.paper()).expect("it can be written");
    let sheet = read_by("pdftotext", &["-layout", file.to_str().expect("a path of characters"), "-"]);
    for part in ["Drawn to scale", "Dashed: pitch circles", "Outputs at their worst scenario", "Margins"] {
        assert!(sheet.contains(part), "no {part}: {sheet}");
    }
    // The words of a drawing have a halo, and Firefox prints such words as shapes.
    assert!(is_firefox() || sheet.contains("groove 28.4°"), "{sheet}");
    assert!(!sheet.contains("Pareto front"), "{sheet}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn no_sheet_of_any_study_is_half_empty_and_no_title_is_broken_inside_a_word() {
    // Of metal-cvt that is seen above.
    for name in ["scooter-variator", "pulley-thickness", "timing-design"] {
        let swept = Swept::shipped(name);
        let mut browser = Browser::open(&swept.page(), "");
        browser.wait("!beltspace.page.feasible || beltspace.timings.explained");
        let file = swept.folder.path().join("page.pdf");
        std::fs::write(&file, browser.paper()).expect("it can be written");
        let filled = filled(&file);
        eprintln!("{name}: {} pages, filled to {filled:.2?}", filled.len());
        assert!(filled[..filled.len() - 1].iter().all(|&it| it > 0.55), "{name}: {filled:?}");
        // The front stands below the question, on the first sheet.
        let path = file.to_str().expect("a path of characters");
        assert!(read_by("pdftotext", &["-layout", "-f", "1", "-l", "1", path, "-"]).contains("Pareto front"), "{name}");
        let whole = read_by("pdftotext", &["-layout", "-f", "1", "-l", "2", path, "-"]);
        let axes: Vec<String> = serde_json::from_value(browser.evaluate("beltspace.state.parallel")).expect("names");
        for part in axes.iter().flat_map(|it| it.split('_')) {
            assert!(whole.split_whitespace().any(|word| word.contains(part)), "{name}: {part} is broken");
        }
        // What was made for paper is gone again.
        assert_eq!(browser.text("document.documentElement.className"), "");
        assert_eq!(browser.complaints, Vec::<String>::new());
    }
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_live_page_is_printed_without_its_controls_and_so_is_a_sheet_of_a_design() {
    let (folder, study) = study_file(SMALL);
    let explored = Explored::new(&study, &[]);
    let mut browser = open(&explored);
    browser.wait("beltspace.timings.counted > 0 && document.querySelectorAll('#around svg.slice').length >= 4");
    let file = folder.path().join("page.pdf");
    let printed = |browser: &mut Browser| {
        std::fs::write(&file, browser.paper()).expect("it can be written");
        let filled = filled(&file);
        assert!(filled[..filled.len() - 1].iter().all(|&it| it > 0.5), "{filled:?}");
        read_by("pdftotext", &["-layout", file.to_str().expect("a path of characters"), "-"])
    };
    let whole = printed(&mut browser);
    for part in ["A small belt", "Pareto front", "Around design", "must hold", "designs are feasible"] {
        assert!(whole.contains(part), "no {part}: {whole}");
    }
    for part in ["Design axes", "Fixed values", "Save as study", "Undo"] {
        assert!(!whole.contains(part), "{part} is printed: {whole}");
    }
    browser.evaluate("beltspace.openCard(0)");
    browser.wait("document.querySelector('#all-outputs table')");
    // The button prints the card alone.
    browser.evaluate("window.print = () => { window.sheet = document.body.className; }");
    browser.click_on("#card-print");
    assert!(browser.text("window.sheet").contains("sheet"));
    browser.evaluate("document.body.classList.add('sheet')");
    let sheet = printed(&mut browser);
    for part in ["A small belt", "Drawn to scale", "Margins", "All other outputs"] {
        assert!(sheet.contains(part), "no {part}: {sheet}");
    }
    assert!(!sheet.contains("Pareto front"), "{sheet}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
fn ink_is_found_where_it_is() {
    let mut page = b"P5\n4 10\n255\n".to_vec();
    page.extend([255; 40]);
    let begin = page.len() - 40;
    page[begin + 4 * 7 + 2] = 0;
    assert_eq!(inked(&page), 0.7);
}
