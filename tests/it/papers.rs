//! The papers, computed again: the committed files are what is computed, and the computed values are right.

use beltspace::papers::{Basis, Comparison, Paper, Reproduction, Verdict, reproduce};
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
    (Paper::Cvt, "effective friction mu', rubber", 1.5455, 5e-5, Verdict::Identity),
    (Paper::Cvt, "effective friction mu', metal", 0.4193, 5e-5, Verdict::Identity),
    (Paper::Cvt, "initial belt radius r0, rubber", 169.66, 5e-3, Verdict::Differs),
    (Paper::Cvt, "initial belt radius r0, metal", 97.56, 5e-3, Verdict::Differs),
    (Paper::Cvt, "minimum belt radius r1, rubber", 56.619, 5e-4, Verdict::Differs),
    (Paper::Cvt, "minimum belt radius r1, metal", 31.270, 5e-4, Verdict::Differs),
    (Paper::Cvt, "C_R with the printed radii", 18.503, 5e-4, Verdict::Differs),
    (Paper::Cvt, "C_R with r0 163 mm", 20.5, 0.05, Verdict::Fitted),
    (Paper::Cvt, "C_R with the belt's own r0", 20.1, 0.05, Verdict::Differs),
    (Paper::Cvt, "C_M with the printed radii", 107.06, 5e-3, Verdict::Differs),
    (Paper::Cvt, "r1 30.58 mm", 112.9, 0.05, Verdict::Fitted),
    (Paper::Cvt, "C_M with the belt's own r0 and r1", 114.1, 0.05, Verdict::Differs),
    (Paper::Cvt, "traction of x = 1.36", 0.581, 5e-4, Verdict::Identity),
    // (26) and section 3.
    (Paper::Cvt, "optimum band thickness, printed r0 163 and r1", 0.148, 5e-4, Verdict::ReadingMisses),
    (Paper::Cvt, "optimum band thickness, own r0 and r1", 0.110, 5e-4, Verdict::ReadingMisses),
    (Paper::Cvt, "optimum band thickness, own r0 and printed r1", 0.199, 5e-4, Verdict::ReadingMeets),
    // (19): 2/E sigma_t r0 r1/(r0 - r1) with sigma_t 9 and E 600.
    (Paper::Cvt, "optimum belt thickness, rubber, printed", 1.865, 5e-4, Verdict::NotPrinted),
    (Paper::Cvt, "optimum belt thickness, rubber, own", 2.549, 5e-4, Verdict::NotPrinted),
    // The indices and the "6 to 7", read otherwise.
    (Paper::Cvt, "index of the rubber belt, printed C_R over printed C_M", 18.16, 5e-3, Verdict::Differs),
    (Paper::Cvt, "index of the rubber belt, C_R at the printed radii", 16.4, 0.05, Verdict::ReadingMeets),
    (Paper::Cvt, "printed C_M over C_R at the printed radii", 6.10, 5e-3, Verdict::ReadingMeets),
    (Paper::Cvt, "index of the rubber belt, metal force with mu 0.11", 34.3, 0.05, Verdict::ReadingMeets),
    // Table 2.
    (Paper::Cvt, "tight side tension T1", 2250.0, 1e-6, Verdict::Identity),
    (Paper::Cvt, "band tension T", 2724.1, 0.05, Verdict::Differs),
    (Paper::Cvt, "driver axial force, rubber", 4724.0, 0.5, Verdict::Agrees),
    (Paper::Cvt, "driver axial force, metal, T 2800 N", 15_780.0, 5.0, Verdict::Agrees),
    (Paper::Cvt, "driver axial force, metal over rubber", 3.34, 5e-3, Verdict::Agrees),
    // Slip: Figs 2, 7, 9.
    (Paper::Cvt, "largest traction as measured", 0.985, 5e-4, Verdict::Differs),
    (Paper::Cvt, "slips, mu 0.08", 0.577, 5e-4, Verdict::ReadingMeets),
    (Paper::Cvt, "slips, mu 0.11", 0.719, 5e-4, Verdict::Differs),
    // mu = atanh(lambda) 2/pi sin(alpha/2).
    (Paper::Cvt, "friction with which (12) gives the measured slip, rubber", 0.181_02, 5e-6, Verdict::NotPrinted),
    (Paper::Cvt, "friction with which (12) gives the measured slip, metal", 0.080_471, 5e-7, Verdict::NotPrinted),
    (Paper::Cvt, "end of the curve R = 2", 0.730, 5e-4, Verdict::NotPrinted),
    (Paper::Cvt, "end of the curve R = 1", 0.677, 5e-4, Verdict::NotPrinted),
    // H. S. Kim, C. K. Yeo, I. H. Lee: Fig. 9.
    (Paper::TimingBelt, "first lifted tooth j", 16.0, 0.0, Verdict::Fitted),
    (Paper::TimingBelt, "boundary tooth j - 1", 15.0, 0.0, Verdict::Fitted),
    (Paper::TimingBelt, "first lifted tooth of an ordinary car belt", 7.0, 0.0, Verdict::NotPrinted),
    (Paper::TimingBelt, "first lifted tooth j of that belt, 5000 rpm of the engine", 16.0, 0.0, Verdict::ReadingMeets),
    (Paper::TimingBelt, "tooth compliance", 2.55, 5e-3, Verdict::Identity),
    // (17)-(19), each way of reading them.
    (Paper::TimingBelt, "T*: phi - theta in (17), psi in nu", 45.602, 5e-4, Verdict::NotPrinted),
    (Paper::TimingBelt, "T*: phi in (17), psi in nu", 45.817, 5e-4, Verdict::NotPrinted),
    (Paper::TimingBelt, "T*: phi - theta in (17), phi in nu", 46.447, 5e-4, Verdict::NotPrinted),
    (Paper::TimingBelt, "T*: phi - theta in (17) and in nu", 46.651, 5e-4, Verdict::NotPrinted),
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
    (Paper::Pulley, "thickness chosen, friction as in the paper", 1.8, 0.0, Verdict::ReadingMeets),
    (Paper::Pulley, "thickness chosen, friction around", 2.0, 0.0, Verdict::ReadingMisses),
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
        (Paper::Cvt, "driven force, R = 1: traction 0 to 0.3"),
        (Paper::TimingBelt, "loads of the driven pulley's teeth"),
        (Paper::TimingBelt, "loads before the boundary"),
        (Paper::TimingBelt, "loads behind the boundary"),
        (Paper::TimingBelt, "boundary at 4000 rpm"),
        (Paper::TimingBelt, "boundary at 196 N"),
    ] {
        let row = row(paper, words);
        assert_eq!(row.verdict, Verdict::Agrees, "{words}: {}", row.computed);
    }
    // (19) read so that tooth j - 1 meshes is the system, and the printed equation in itself is 0.04 % from it.
    let repaired = row(Paper::TimingBelt, "boundary tension T*: phi in (17) and in nu");
    assert_eq!(repaired.verdict, Verdict::ReadingMeets, "{}", repaired.computed);
    for (words, off) in [("T*: phi - theta in (17), psi in nu", "−2.3 %"), ("T*: phi - theta in (17) and in nu", "−0.04")] {
        let reason = &row(Paper::TimingBelt, words).reason;
        assert!(reason.contains(off), "{words}: {reason}");
    }
    // The first lifted teeth behind Figs 10 and 11.
    assert_eq!(row(Paper::TimingBelt, "boundary at 4000 rpm").computed, "first lifted tooth 19, then 22");
    assert_eq!(row(Paper::TimingBelt, "boundary at 196 N").computed, "first lifted tooth 23, 21, 19, 16");
}

/// Rows whose two sides are the same by definition.
const IDENTITIES: &[(Paper, &str)] = &[
    (Paper::Cvt, "driver force against traction, R = 1"),
    (Paper::Cvt, "nondimensional forces of both belts with the same data"),
    (Paper::Cvt, "effective friction mu', rubber"),
    (Paper::Cvt, "effective friction mu', metal"),
    (Paper::Cvt, "contact angle at R = 1, rubber"),
    (Paper::Cvt, "contact angle at R = 1, metal"),
    (Paper::Cvt, "traction of x = 1.36"),
    (Paper::Cvt, "tight side tension T1, rubber"),
    (Paper::Cvt, "driver force at constant T1 + T2, rubber"),
    (Paper::Cvt, "driver force at constant band tension T, metal"),
    (Paper::TimingBelt, "tooth compliance f of 0.025 mm/kgf, unit printed as m/N"),
    (Paper::TimingBelt, "tight tension 20 kgf"),
    (Paper::TimingBelt, "tight tension 50 kgf"),
    (Paper::TimingBelt, "cord modulus E, 8000 kgf/mm2"),
];

#[test]
fn identities_are_counted_apart_from_agreements() {
    for (paper, words) in IDENTITIES {
        assert_eq!(row(*paper, words).verdict, Verdict::Identity, "{words}");
    }
    // The index .18 of the text shares its words with the table's, which differs.
    assert_eq!(ALL.comparisons.iter().find(|row| row.at == "4.1.2").map(|row| row.verdict), Some(Verdict::Identity));
    assert_eq!(ALL.count(Verdict::Identity), IDENTITIES.len() + 1);
    assert_eq!(Verdict::ALL.map(|verdict| ALL.count(verdict)).iter().sum::<usize>(), ALL.comparisons.len());
    for row in &ALL.comparisons {
        assert_eq!(row.verdict == Verdict::Agrees, row.basis == Basis::Equation && row.meets, "{}", row.what);
    }
    // Called an agreement, an identity is refused; so is a verdict that the numbers do not give.
    let identity = row(Paper::TimingBelt, "tight tension 20 kgf");
    let as_agreement = Comparison { verdict: Verdict::Agrees, ..identity.clone() };
    let refused = beltspace::papers::check(&[as_agreement]).expect_err("an identity is no agreement");
    assert!(refused.contains("is called \"agrees\" but is \"identity\""), "{refused}");
    let differing = row(Paper::Cvt, "C_R with the printed radii");
    assert!(beltspace::papers::check(&[Comparison { verdict: Verdict::Agrees, ..differing.clone() }]).is_err());
    let silent = Comparison { fails_if: "", ..identity.clone() };
    let refused = beltspace::papers::check(&[silent]).expect_err("it does not say what would make it fail");
    assert!(refused.contains("does not say what would make it fail"), "{refused}");
}

#[test]
fn rows_that_a_chosen_section_can_hardly_fail_say_what_would() {
    let of_figure: Vec<_> = ALL.comparisons.iter().filter(|row| row.at == "5, Fig. 13").collect();
    assert_eq!(of_figure.len(), 6);
    for row in of_figure {
        assert!(row.basis == Basis::Reading && !row.fails_if.is_empty(), "{}", row.what);
        assert!(row.explanation().ends_with(&format!("Would fail if {}.", row.fails_if)), "{}", row.explanation());
    }
}

#[test]
fn the_page_of_the_papers_has_the_counts() {
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/manual/papers.md")).expect("it is there");
    let flowing = readme.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(flowing.contains(&ALL.summary()), "docs/manual/papers.md should say: {}", ALL.summary());
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
    for verdict in Verdict::ALL {
        assert!(printed.contains(&format!("{}: {}", verdict.word(), verdict.meaning())), "{}", verdict.word());
    }
    assert_eq!(fs::read(out.join("cvt-fig-1.svg")).ok(), fs::read(committed().join("cvt-fig-1.svg")).ok());
}
