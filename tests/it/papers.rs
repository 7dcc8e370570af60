//! The papers, computed again: the committed files are what is computed, and the computed values are right.

use beltspace::papers::{Comparison, Paper, Reproduction, Verdict, reproduce};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

static ALL: LazyLock<Reproduction> = LazyLock::new(|| reproduce().expect("every comparison has a reason"));

fn committed() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("results/papers")
}

#[test]
fn what_is_committed_is_what_comes_out() {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let claim = beltspace::files::Claim::new(folder.path(), "a test").expect("nobody has it");
    ALL.write(&claim).expect("the files can be written");
    let files = |folder: &Path| -> BTreeSet<String> {
        let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
    };
    let own = files(folder.path());
    // The page of papers.html is another command's.
    let there: BTreeSet<String> = files(&committed()).into_iter().filter(|name| !name.ends_with(".html")).collect();
    assert_eq!(there, own);
    for name in own {
        let [committed, own] = [&committed(), folder.path()].map(|folder| fs::read(folder.join(&name)).expect("it is there"));
        assert!(committed == own, "results/papers/{name} is not what comes out: beltspace reproduce --force");
    }
}

#[test]
fn every_figure_and_table_is_there() {
    let figures: Vec<_> = ALL.figures.iter().map(|figure| figure.id).collect();
    let expected = [
        "cvt-fig-1",
        "cvt-fig-2",
        "cvt-fig-7",
        "cvt-fig-9",
        "cvt-conclusion-1",
        "timing-fig-8",
        "timing-fig-9",
        "timing-fig-10",
        "timing-fig-11",
        "pulley-loads",
        "pulley-thickness",
        "pulley-fig-13-machined",
        "pulley-fig-13-welded-discs",
        "pulley-fig-13-double-groove",
        "pulley-fig-13-pressed-cup",
    ];
    assert_eq!(figures, expected);
    let tables: Vec<_> = ALL.tables.iter().map(|table| table.id).collect();
    assert_eq!(tables, ["cvt-table-1", "cvt-table-2", "pulley-table-1", "pulley-thickness-table"]);
    let page = ALL.files().into_iter().find(|(name, _)| name == "README.md").expect("there is a page").1;
    let page = String::from_utf8(page).expect("text");
    for figure in &ALL.figures {
        assert!(!figure.caption.is_empty() && figure.table.rows() > 10, "{}", figure.id);
        assert!(
            page.contains(&format!("]({})", figure.svg_name())) && page.contains(&format!("]({})", figure.csv_name())),
            "{}",
            figure.id
        );
    }
    for table in &ALL.tables {
        assert!(!table.caption.is_empty() && page.contains(&format!("]({})", table.csv_name())), "{}", table.id);
    }
    for paper in Paper::ALL {
        assert!(ALL.comparisons.iter().any(|row| row.group == paper) && ALL.lost.iter().any(|lost| lost.group == paper), "{paper:?}");
    }
}

#[test]
fn no_row_is_without_a_reason_or_doubled() {
    beltspace::papers::check(&ALL.comparisons).expect("every row has a reason");
    let mut names = BTreeSet::new();
    for row in &ALL.comparisons {
        assert!(names.insert((row.at, &row.what)), "twice: {} {}", row.at, row.what);
    }
    let silent = Comparison { reason: " ".to_owned(), ..ALL.comparisons[0].clone() };
    assert!(beltspace::papers::check(&[silent]).is_err());
}

/// What a row came out as: a part of its words, its value to half a unit, its verdict.
const GOLDEN: &[(Paper, &str, f64, f64, Verdict)] = &[
    // H. S. Kim, K. W. Kim: Table 1 and (18), (21), (28).
    (Paper::Cvt, "effective friction mu', rubber", 1.5455, 5e-5, Verdict::Agrees),
    (Paper::Cvt, "effective friction mu', metal", 0.4193, 5e-5, Verdict::Agrees),
    (Paper::Cvt, "initial belt radius r0, rubber", 169.66, 5e-3, Verdict::Differs),
    (Paper::Cvt, "initial belt radius r0, metal", 97.56, 5e-3, Verdict::Differs),
    (Paper::Cvt, "minimum belt radius r1, rubber", 56.619, 5e-4, Verdict::Differs),
    (Paper::Cvt, "minimum belt radius r1, metal", 31.270, 5e-4, Verdict::Differs),
    (Paper::Cvt, "C_R with the printed radii", 18.503, 5e-4, Verdict::Differs),
    (Paper::Cvt, "C_R with r0 163 mm", 20.5, 0.05, Verdict::Agrees),
    (Paper::Cvt, "C_R with the belt's own r0", 20.1, 0.05, Verdict::Differs),
    (Paper::Cvt, "C_M with the printed radii", 107.06, 5e-3, Verdict::Differs),
    (Paper::Cvt, "r1 30.58 mm", 112.9, 0.05, Verdict::Fitted),
    (Paper::Cvt, "C_M with the belt's own r0 and r1", 114.1, 0.05, Verdict::Differs),
    (Paper::Cvt, "traction of x = 1.36", 0.581, 5e-4, Verdict::Agrees),
    // (26) and section 3.
    (Paper::Cvt, "optimum band thickness at r1 = 45 mm", 0.199, 5e-4, Verdict::Agrees),
    // Table 2.
    (Paper::Cvt, "tight side tension T1", 2250.0, 1e-6, Verdict::Agrees),
    (Paper::Cvt, "band tension T", 2724.1, 0.05, Verdict::Differs),
    (Paper::Cvt, "driver axial force, rubber", 4724.0, 0.5, Verdict::Agrees),
    (Paper::Cvt, "driver axial force, metal, T 2800 N", 15_780.0, 5.0, Verdict::Agrees),
    (Paper::Cvt, "driver axial force, metal over rubber", 3.34, 5e-3, Verdict::Agrees),
    // Slip: Figs 2, 7, 9.
    (Paper::Cvt, "largest traction as measured", 0.985, 5e-4, Verdict::Differs),
    (Paper::Cvt, "slips, mu 0.08", 0.577, 5e-4, Verdict::Agrees),
    (Paper::Cvt, "slips, mu 0.11", 0.719, 5e-4, Verdict::Differs),
    (Paper::Cvt, "end of the curve R = 1", 0.677, 5e-4, Verdict::NotPrinted),
    // H. S. Kim, C. K. Yeo, I. H. Lee: Fig. 9.
    (Paper::TimingBelt, "first lifted tooth j", 16.0, 0.0, Verdict::Fitted),
    (Paper::TimingBelt, "boundary tooth j - 1", 15.0, 0.0, Verdict::Fitted),
    (Paper::TimingBelt, "tooth compliance", 2.55, 5e-3, Verdict::Agrees),
    // K.-S. Lee et al.: Table 1 with (2), (10), (12)-(15), and section 4.4.
    (Paper::Pulley, "belt speed v", 18.850, 5e-4, Verdict::NotPrinted),
    (Paper::Pulley, "tight tension T_t", 859.155, 5e-4, Verdict::NotPrinted),
    (Paper::Pulley, "centrifugal tension", 39.084, 5e-4, Verdict::NotPrinted),
    (Paper::Pulley, "effective friction mu'", 0.140_481, 5e-7, Verdict::NotPrinted),
    (Paper::Pulley, "friction mu, along the flank", 0.050_106, 5e-7, Verdict::NotPrinted),
    (Paper::Pulley, "total friction", 0.070_860, 5e-7, Verdict::NotPrinted),
    (Paper::Pulley, "flank force R at the slack end", 15.4418, 5e-5, Verdict::NotPrinted),
    (Paper::Pulley, "resultant", 1035.131, 5e-4, Verdict::NotPrinted),
    (Paper::Pulley, "torque", 9.549_30, 5e-6, Verdict::NotPrinted),
    (Paper::Pulley, "bolt force of 10 N m, M/(0.2 d)", 8333.3, 0.05, Verdict::NotPrinted),
    (Paper::Pulley, "bolt force of 10 N m, thread and head", 7470.0, 5.0, Verdict::NotPrinted),
    (Paper::Pulley, "thickness chosen, friction as in the paper", 1.8, 0.0, Verdict::Agrees),
    (Paper::Pulley, "thickness chosen, friction around", 2.0, 0.0, Verdict::Differs),
    // Converged finite elements of the example: 240.9 MPa and 51745.7 mm3.
    (Paper::Pulley, "largest stress at 1.8 mm", 240.9, 0.02 * 240.9, Verdict::NotPrinted),
    (Paper::Pulley, "volume at 1.8 mm", 51_745.7, 0.5, Verdict::NotPrinted),
];

/// The one row of that name, or else the first with these words.
fn row(paper: Paper, words: &str) -> &'static Comparison {
    let of_paper = || ALL.comparisons.iter().filter(move |row| row.group == paper);
    let found = of_paper().find(|row| row.what == words).or_else(|| of_paper().find(|row| row.what.contains(words)));
    found.unwrap_or_else(|| panic!("{paper:?} has no row \"{words}\""))
}

#[test]
fn the_comparisons_are_those_worked_out_by_hand() {
    for (paper, words, expected, half_a_unit, verdict) in GOLDEN {
        let row = row(*paper, words);
        let value = row.value.unwrap_or_else(|| panic!("{words} is no number"));
        assert!((value - expected).abs() <= *half_a_unit, "{words}: {value}, expected {expected}");
        assert_eq!(row.verdict, *verdict, "{words}: {} {} ({})", row.printed, row.computed, row.difference);
    }
}

#[test]
fn the_figures_say_what_the_papers_say() {
    for (paper, words) in [
        (Paper::Cvt, "driver force against traction"),
        (Paper::Cvt, "driven force, R = 1: traction 0 to 0.3"),
        (Paper::Cvt, "nondimensional forces of both belts"),
        (Paper::Cvt, "driver force at constant T1 + T2, rubber"),
        (Paper::Cvt, "driver force at constant band tension T, metal"),
        (Paper::TimingBelt, "loads of the driven pulley's teeth"),
        (Paper::TimingBelt, "loads before the boundary"),
        (Paper::TimingBelt, "loads behind the boundary"),
        (Paper::TimingBelt, "boundary at 4000 rpm"),
        (Paper::TimingBelt, "boundary at 196 N"),
    ] {
        let row = row(paper, words);
        assert_eq!(row.verdict, Verdict::Agrees, "{words}: {}", row.computed);
    }
    // 2.3 % at the default belt: what the repair of (17)-(19) is worth.
    assert!(row(Paper::TimingBelt, "boundary tension T*").computed.contains("−2.3 %"));
    // The first lifted teeth behind Figs 10 and 11.
    assert_eq!(row(Paper::TimingBelt, "boundary at 4000 rpm").computed, "first lifted tooth 19, then 22");
    assert_eq!(row(Paper::TimingBelt, "boundary at 196 N").computed, "first lifted tooth 23, 21, 19, 16");
}

#[test]
fn files_that_are_there_stay_unless_forced() {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let out = folder.path().join("papers");
    let run = |more: &[&str]| {
        let program = Command::new(env!("CARGO_BIN_EXE_beltspace")).arg("reproduce").arg("--out").arg(&out).args(more).output();
        let output = program.expect("the program starts");
        (output.status.code(), String::from_utf8(output.stdout).expect("text"), String::from_utf8(output.stderr).expect("text"))
    };
    fs::create_dir(&out).expect("a folder");
    fs::write(out.join("cvt-fig-1.svg"), "mine").expect("a file");
    for option in ["--quiet", "--force"] {
        let (code, _, error) = run(&[option]);
        assert_eq!(code, Some(2));
        assert!(error.contains("cvt-fig-1.svg") && error.contains("beltspace did not write them: move them away"), "{error}");
        assert_eq!(fs::read_to_string(out.join("cvt-fig-1.svg")).expect("it is there"), "mine");
    }
    // With a comparison beside it, it is the figure of an older reproduction.
    fs::copy(committed().join("comparison.csv"), out.join("comparison.csv")).expect("a file");
    let (code, _, error) = run(&["--quiet"]);
    assert_eq!(code, Some(2));
    assert!(error.contains("(cvt-fig-1.svg and 1 more); replace them with --force"), "{error}");
    let (code, printed, error) = run(&["--force"]);
    assert_eq!((code, error.as_str()), (Some(0), ""));
    assert!(printed.contains("C_R with the printed radii") && printed.contains(&ALL.summary()), "{printed}");
    assert_eq!(fs::read(out.join("cvt-fig-1.svg")).ok(), fs::read(committed().join("cvt-fig-1.svg")).ok());
}
