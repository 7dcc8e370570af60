//! The pulley as a three-dimensional model for CalculiX: its loads, and its solution against the harmonics.

use crate::pulleys::{cup, discs, double, job, machined};
use beltspace::pulley::calculix::{Comparison, Forces, Job, Results, Sweep, closed_form, compare, export, write_deck};
use beltspace::pulley::mesh::{Face, Mesh};
use beltspace::pulley::response::{LONGEST, View, respond};
use beltspace::pulley::section::{Fineness, Kind, mesh};
use beltspace::pulley::turn::{Case, Turn};
use glam::DVec3;
use std::collections::HashMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// One element through the sheet, as in the smallest of the reference models.
const COARSE: Fineness = Fineness { through: 1, straight: 2.0, bend: 1.2, held: 2.0, solid: 2.5, harmonics: 24, every: false };

fn coarse() -> Job {
    job(Kind::PressedCup, cup(), COARSE, 50)
}

fn mesh_of(job: &Job) -> Mesh {
    mesh(job.kind, &job.dimensions, &job.fineness).expect("the section is possible")
}

fn deck_of(job: &Job) -> String {
    let mut deck = Vec::new();
    write_deck(&mut deck, &mesh_of(job), job).expect("it is written to memory");
    String::from_utf8(deck).expect("it is text")
}

/// Force and moment about the origin of everything under `*CLOAD`, read from the text alone.
fn loads_of(deck: &str) -> (DVec3, DVec3) {
    let mut nodes: HashMap<usize, DVec3> = HashMap::new();
    let (mut force, mut moment) = (DVec3::ZERO, DVec3::ZERO);
    let mut card = "";
    for line in deck.lines().filter(|line| !line.starts_with("**")) {
        if line.starts_with('*') {
            card = line;
            continue;
        }
        let words: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |place: usize| -> f64 { words[place].parse().expect("it is a number") };
        if card.starts_with("*NODE, NSET=NALL") {
            nodes.insert(number(0) as usize, DVec3::new(number(1), number(2), number(3)));
        } else if card.starts_with("*CLOAD") {
            assert!(words.iter().all(|word| word.len() <= 20), "CalculiX reads twenty characters: {line}");
            let load = DVec3::AXES[number(1) as usize - 1] * number(2);
            force += load;
            moment += nodes[&(number(0) as usize)].cross(load);
        }
    }
    (force, moment)
}

fn near(value: f64, expected: f64, tolerance: f64) -> bool {
    (value - expected).abs() <= tolerance
}

/// How far a quadratic element of one of 50 sectors is from the circle, relative: a tenth of the fourth power of half its angle.
const ROUND: f64 = 1.6e-6;

#[test]
fn the_forces_of_the_deck_add_up_to_the_pull_of_the_strands_the_torque_and_the_bolts() {
    let (force, moment) = loads_of(&deck_of(&coarse()));
    // Tt - F and Ts - F as vectors; (Tt - Ts) R_b; four bolts of 8333.33 N.
    assert!(near(force.x, -819.572, 5e-4) && near(force.y, -632.296, 5e-4), "{force}");
    assert!(near(force.z, -33_333.333, 5e-3), "{force}");
    assert!(near(moment.z, 9549.297, ROUND * 9549.297), "{moment}");
    // The belt pulls in the groove's mid-plane, and the bolts do not tilt.
    let plane = 10.0 + 3.4 + 3.4 * 18f64.to_radians().cos() + 6.5;
    assert!(near(moment.x, plane * 632.2963, 0.02) && near(moment.y, -plane * 819.5717, 0.02), "{moment}");
    for (kind, dimensions) in [(Kind::Machined, machined()), (Kind::WeldedDiscs, discs()), (Kind::DoubleGroove, double())] {
        let job = job(kind, dimensions, COARSE, 36);
        let (force, moment) = loads_of(&deck_of(&job));
        let expected = closed_form(&job.dimensions, &job.case);
        assert!(force.distance(expected.force) < 1e-6 * expected.force.length(), "{}: {force} {expected:?}", kind.name());
        assert!(near(moment.z, expected.moment.z, 4.0 * ROUND * expected.moment.z), "{}: {moment} {expected:?}", kind.name());
    }
}

#[test]
fn a_wrong_sign_of_a_load_shows_in_the_sums() {
    let job = coarse();
    let mesh = mesh_of(&job);
    let sweep = Sweep::new(&mesh, job.sectors);
    let positions = sweep.positions(&mesh);
    let expected = closed_form(&job.dimensions, &job.case);
    let total = |case: &Case| Forces::new(&mesh, &sweep, &job.dimensions, case).total(&positions);
    let slight = ROUND * expected.moment.z;
    let right = total(&job.case);
    assert!(right.force.distance(expected.force) < 0.01 && near(right.moment.z, expected.moment.z, slight), "{right:?} {expected:?}");
    // Friction towards the slack end: the torque turns round.
    let slack = total(&Case { around: -job.case.around, ..job.case });
    assert!(near(slack.moment.z, -expected.moment.z, slight), "{slack:?}");
    // Friction outwards along the flank: a quarter of the pull is missing.
    let outwards = total(&Case { along: -job.case.along, ..job.case }).force;
    let share = outwards.truncate().length() / expected.force.truncate().length();
    assert!(near(share, 1.0 - 0.261, 2e-3), "{share}");
    // Bolt heads that pull.
    let pulling = total(&Case { pressure: -job.case.pressure, ..job.case });
    assert!(near(pulling.force.z, -expected.force.z, 0.01), "{pulling:?}");
    // A flank whose outside is taken for its inside pushes the pulley away from the shaft.
    let mut inside_out = mesh.clone();
    for edge in inside_out.surface.iter_mut().filter(|edge| edge.face == Face::Band) {
        edge.nodes.reverse();
    }
    let pushed = Forces::new(&inside_out, &sweep, &job.dimensions, &job.case).total(&positions);
    assert!(pushed.force.x > 0.0, "{pushed:?}");
}

#[test]
fn the_deck_says_all_that_it_was_made_from() {
    for (kind, dimensions) in [(Kind::Machined, machined()), (Kind::PressedCup, cup())] {
        let job = job(kind, dimensions, COARSE, 12);
        let deck = deck_of(&job);
        assert_eq!(Job::from_deck(&deck).expect("it reads its own decks"), job);
        let missing = deck.replace("load.wrap =", "load.wrop =");
        let error = Job::from_deck(&missing).expect_err("the wrap is missing").to_string();
        assert_eq!(error, "the deck's first lines do not say load.wrap");
    }
}

#[test]
fn a_deck_whose_nodes_were_moved_is_not_compared() {
    let directory = tempfile::tempdir().expect("there is room");
    export(&job(Kind::Machined, machined(), COARSE, 12), directory.path()).expect("the deck is written");
    let results = " displacements\n 1 0.0 0.0 0.0\n forces\n 1 0.0 0.0 0.0\n";
    std::fs::write(directory.path().join("pulley.dat"), results).expect("it is written");
    let message = || compare(directory.path()).expect_err("the results are of one node").to_string();
    assert!(message().contains("has no displacement in the results"), "{}", message());
    let deck = directory.path().join("pulley.inp");
    let text = std::fs::read_to_string(&deck).expect("it is there");
    let first = text.lines().find(|line| line.starts_with("1,")).expect("there is a first node");
    std::fs::write(&deck, text.replacen(first, "1,10.,0.5,0.", 1)).expect("it is written");
    assert!(message().starts_with("the deck has other nodes"), "{}", message());
}

#[test]
fn sectors_share_their_planes_and_the_last_closes_on_the_first() {
    let job = job(Kind::Machined, machined(), COARSE, 12);
    let mesh = mesh_of(&job);
    let sweep = Sweep::new(&mesh, job.sectors);
    let positions = sweep.positions(&mesh);
    assert_eq!(positions.len(), sweep.nodes());
    let mut used = vec![false; positions.len()];
    for sector in 0..job.sectors {
        for element in &mesh.elements {
            let nodes = sweep.element(sector, element);
            assert_eq!(nodes.len(), 5 * element.corners());
            nodes.iter().for_each(|&node| used[node] = true);
            let [a, b, c] = [0, 1, 2].map(|place| positions[nodes[place]]);
            let up = positions[nodes[element.corners()]] - a;
            assert!((b - a).cross(c - a).dot(up) > 0.0, "inside out");
            // The middle of a side between the planes stands on the circle, half-way.
            let (end, middle) = (positions[nodes[element.corners()]], positions[nodes[4 * element.corners()]]);
            assert!((middle.truncate().length() - a.truncate().length()).abs() < 1e-9);
            assert!((middle.distance(a) - middle.distance(end)).abs() < 1e-9);
        }
    }
    assert!(used.iter().all(|used| *used), "a node without element");
}

#[test]
fn results_of_calculix_are_read_as_it_prints_them() {
    let text = "\n displacements (vx,vy,vz) for set NSURFACE and time  0.1000000E+01\n\n         1  1.500000E-01 -2.000000E-02  3.0E+00\n\
        \n forces (fx,fy,fz) for set NFIXED and time  0.1000000E+01\n\n         7  0.000000E+00  1.000000E+00 -2.500000E+01\n\
        \n total volume for set EALL and time  0.1000000E+01\n\n        5.174574E+04\n";
    let results = Results::new(text).expect("they are complete");
    assert_eq!(results.displacements[&0], DVec3::new(0.15, -0.02, 3.0));
    assert_eq!(results.reactions[&6], DVec3::new(0.0, 1.0, -25.0));
    assert_eq!(results.volume, Some(51_745.74));
    let unfinished = Results::new("\n").expect_err("it is empty").to_string();
    assert!(unfinished.contains("has not finished"), "{unfinished}");
}

/// Where CalculiX is, if it is installed; if it has to be and is not, that is a failure.
fn calculix() -> Option<PathBuf> {
    let found = std::env::var_os("PATH")
        .and_then(|path| std::env::split_paths(&path).map(|directory| directory.join("ccx")).find(|program| program.is_file()));
    if found.is_none() {
        assert!(std::env::var_os("BELTSPACE_CALCULIX").is_none_or(|it| it != "1"), "BELTSPACE_CALCULIX=1, but ccx is not on PATH");
        // Past the capture of a passing test's output.
        let _ = writeln!(std::io::stderr(), "calculix: SKIPPED, ccx is not installed");
    }
    found
}

/// Exports, solves and compares; also the seconds that CalculiX took, and those of its processors.
fn solved(program: &Path, job: &Job, directory: &Path) -> (Vec<Comparison>, [f64; 2]) {
    export(job, directory).expect("the deck is written");
    let start = Instant::now();
    // The shell says what its children used of the processors, last.
    let mut run = Command::new("sh");
    run.args(["-c", "\"$0\" -i pulley || exit 1; times"]).arg(program).current_dir(directory).env("OMP_NUM_THREADS", "2");
    let run = run.output().expect("the shell runs");
    let seconds = start.elapsed().as_secs_f64();
    let text = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{text}");
    let part = |word: &str| -> Option<f64> {
        let (minutes, seconds) = word.trim_end_matches('s').split_once('m')?;
        Some(60.0 * minutes.parse::<f64>().ok()? + seconds.parse::<f64>().ok()?)
    };
    let used = text.lines().last().unwrap_or_default().split_whitespace().filter_map(part).sum();
    (compare(directory).expect("the results are complete"), [seconds, used])
}

fn shown(rows: &[Comparison]) -> String {
    let mut text =
        "quantity,unit,harmonics,harmonics_same_section,calculix,difference_percent,difference_same_section_percent\n".to_owned();
    for row in rows {
        let numbers = [row.harmonic, row.same_section, row.calculix].map(|it| format!("{it:.6}"));
        let differences = [row.difference(), row.difference_on_same_section()].map(|it| format!("{it:.3}"));
        text += &format!("{},{},{},{}\n", row.quantity, row.unit, numbers.join(","), differences.join(","));
    }
    text
}

#[test]
fn harmonics_and_calculix_agree_on_a_coarse_pressed_cup() {
    let Some(program) = calculix() else { return };
    let directory = tempfile::tempdir().expect("there is room");
    let (rows, seconds) = solved(&program, &coarse(), directory.path());
    println!("ccx took {:.1} s\n{}", seconds[0], shown(&rows));
    // Per cent, between a swept model and harmonics on the same section.
    let tolerance = |quantity: &str| match quantity {
        "rim displacement" => 0.02,
        "volume" => 0.001,
        "largest stress" => 0.1,
        // The clamp's patches have edges that a coarse model does not resolve.
        "stress at Bl" | "stress at Br" => 1.3,
        "stress at Dl" | "stress at Dr" => 0.4,
        "largest stress: angle" => 1.0,
        quantity if quantity.starts_with("reaction") => 2e-4,
        _ => 0.2,
    };
    for row in &rows {
        let off = row.difference_on_same_section();
        assert!(off.abs() <= tolerance(&row.quantity), "{}: {off} %\n{}", row.quantity, shown(&rows));
    }
    assert_eq!(rows.len(), 20, "{}", shown(&rows));
    let outside = |rows: &[Comparison]| -> Vec<String> {
        let wrong = rows.iter().filter(|row| row.difference_on_same_section().abs() > tolerance(&row.quantity));
        wrong.map(|row| row.quantity.clone()).collect()
    };
    // Harmonics with friction towards the other end do not pass for the same.
    let deck = directory.path().join("pulley.inp");
    let text = std::fs::read_to_string(&deck).expect("it is there");
    std::fs::write(&deck, text.replace("load.around = ", "load.around = -")).expect("it is written");
    let turned = outside(&compare(directory.path()).expect("the deck is complete"));
    assert!(["rim displacement", "stress at Fl", "reaction torque"].iter().all(|name| turned.iter().any(|it| it == name)), "{turned:?}");
    std::fs::write(&deck, text).expect("it is written");
    // Nor does a result that is a hundredth off.
    let data = directory.path().join("pulley.dat");
    let text = std::fs::read_to_string(&data).expect("it is there");
    let mut bent = String::new();
    let mut moved = false;
    for line in text.lines() {
        moved = if line.contains("displacements") { true } else { moved && !line.contains("forces") };
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            [node, x, y, z] if moved && !line.contains('(') => {
                let scaled = [x, y, z].map(|it| 1.01 * it.parse::<f64>().expect("it is a number"));
                bent += &format!("{node} {:.6e} {:.6e} {:.6e}\n", scaled[0], scaled[1], scaled[2]);
            }
            _ => bent += &format!("{line}\n"),
        }
    }
    std::fs::write(&data, bent).expect("it is written");
    let wrong = outside(&compare(directory.path()).expect("the results are complete"));
    assert!(["rim displacement", "stress at Fl"].iter().all(|name| wrong.iter().any(|it| it == name)), "{wrong:?}");
}

/// Milliseconds that harmonics take for the same pulley at the usual fineness, the best of several runs on one processor: mesh,
/// answers to unit loads, load case.
fn milliseconds_of_harmonics(job: &Job) -> f64 {
    let mut table = vec![0.0; LONGEST];
    let mut run = || {
        let start = Instant::now();
        let mesh = mesh(job.kind, &job.dimensions, &Fineness::USUAL).expect("the section is possible");
        let length = respond(&mesh, job.kind, &job.dimensions, job.poisson, &Fineness::USUAL, &mut table);
        let summary = Turn::new(View::new(&table[..length]), job.case).summary(None, [None; 2]);
        assert!(summary.largest.stress > 0.0);
        1e3 * start.elapsed().as_secs_f64()
    };
    (0..7).map(|_| run()).fold(f64::INFINITY, f64::min)
}

/// The models behind `results/calculix`: minutes and gigabytes. BELTSPACE_CALCULIX_OUT is where the tables go,
/// BELTSPACE_CALCULIX_ONLY one model alone.
#[test]
#[ignore = "minutes and gigabytes; results/calculix/compare runs it"]
fn models_of_the_results() {
    let program = calculix().expect("ccx is needed");
    let out = PathBuf::from(std::env::var_os("BELTSPACE_CALCULIX_OUT").expect("BELTSPACE_CALCULIX_OUT says where the tables go"));
    let only = std::env::var("BELTSPACE_CALCULIX_ONLY").ok();
    let sheet = Fineness { through: 2, straight: 1.0, bend: 0.4, held: 0.7, solid: 1.6, harmonics: 24, every: true };
    let models = [
        ("pressed-cup-coarse", coarse()),
        ("pressed-cup-usual", job(Kind::PressedCup, cup(), Fineness::USUAL, Job::USUAL_SECTORS)),
        ("machined", job(Kind::Machined, machined(), sheet, 36)),
        // More and thus shorter sectors, for the narrow stress beside the bolt heads at Br; fewer nodes in the section make room.
        ("machined-90-sectors", job(Kind::Machined, machined(), Fineness { solid: 4.0, bend: 1.0, ..sheet }, 90)),
        ("welded-discs", job(Kind::WeldedDiscs, discs(), sheet, 60)),
        ("double-groove", job(Kind::DoubleGroove, double(), Fineness { straight: 1.5, ..sheet }, 60)),
        ("pressed-cup", job(Kind::PressedCup, cup(), sheet, 68)),
    ];
    for (name, job) in models.into_iter().filter(|(name, _)| only.as_ref().is_none_or(|only| only == name)) {
        let mesh = mesh_of(&job);
        let (section, nodes) = (mesh.nodes.len(), Sweep::new(&mesh, job.sectors).nodes());
        let (rows, seconds) = solved(&program, &job, &out.join(format!("{name}.run")));
        let harmonics = milliseconds_of_harmonics(&job);
        let times = format!(
            "section_nodes,nodes,ccx_s,ccx_processor_s,harmonics_ms\n{section},{nodes},{:.1},{:.1},{harmonics:.1}\n",
            seconds[0], seconds[1]
        );
        println!("{name}\n{times}{}", shown(&rows));
        std::fs::write(out.join(format!("{name}.csv")), shown(&rows)).expect("the table is written");
        std::fs::write(out.join(format!("{name}.time.csv")), times).expect("the times are written");
    }
}
