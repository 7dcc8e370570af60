//! The pulley as a three-dimensional model for CalculiX: its loads, and its solution compared with the harmonics.
//!
//! CalculiX checks the solver and the way around the axis alone: section mesh, loads and supports of the deck are those of the harmonics, so
//! an error in them shows in neither. The loads are therefore held against closed forms here, and against the balance of the belt in
//! `pulley_balance.rs`.

use crate::pulleys::{COARSE, calculix, job, shown, solved};
use beltspace::pulley::calculix::{ComparedQuantity, Forces, Job, Results, Sweep, closed_form, compare, export, write_deck};
use beltspace::pulley::loads::{Seat, clamp_harmonic};
use beltspace::pulley::mesh::{Face, Mesh};
use beltspace::pulley::section::{Fineness, SectionKind, mesh};
use beltspace::pulley::turn::Case;
use glam::DVec3;
use std::collections::HashMap;

fn coarse() -> Job {
    job(SectionKind::PressedCup, COARSE, 50)
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
    for kind in [SectionKind::Machined, SectionKind::WeldedDiscs, SectionKind::DoubleGroove] {
        let job = job(kind, COARSE, 36);
        let (force, moment) = loads_of(&deck_of(&job));
        let expected = closed_form(&job.dimensions, &job.case);
        assert!(force.distance(expected.force) < 1e-6 * expected.force.length(), "{}: {force} {expected:?}", kind.name());
        assert!(near(moment.z, expected.moment.z, 4.0 * ROUND * expected.moment.z), "{}: {moment} {expected:?}", kind.name());
    }
}

/// Integration that leaves out where heads and holes begin is four per cent off beside the heads on a coarse mesh.
#[test]
fn harmonics_of_the_bolt_heads_are_integrated_to_their_edges() {
    for kind in SectionKind::ALL {
        let d = job(kind, COARSE, 12).dimensions;
        for fineness in [Fineness::USUAL, Fineness { solid: 4.0, straight: 4.0, held: 4.0, ..COARSE }] {
            let mesh = mesh(kind, &d, &fineness).expect("the section is possible");
            let seat = Seat::new(&mesh, &d);
            let (from, width) = (d.bolt_circle_radius - d.bolt_head_radius, 2.0 * d.bolt_head_radius);
            let force = d.bolt_count * (d.bolt_head_radius.powi(2) - d.bolt_hole_radius.powi(2)) / 2.0;
            for k in [0, 4, 24] {
                let mut sum = 0.0;
                seat.load(&d, k, |place, load| {
                    assert_eq!(place % 3, 1, "along the axis");
                    sum += load;
                });
                const STEPS: usize = 100_000;
                let at = |step: usize| from + width * (step as f64 + 0.5) / STEPS as f64;
                let expected: f64 = (0..STEPS).map(|step| -clamp_harmonic(&d, at(step), k) * at(step) * width / STEPS as f64).sum();
                assert!(near(sum, expected, 3e-6 * force), "{} {k}: {sum} {expected}", kind.name());
                assert!(k > 0 || near(sum, -force, 1e-6 * force), "{}: {sum} {force}", kind.name());
            }
        }
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
    // Friction towards the slack end: the torque changes its sign.
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
    for kind in [SectionKind::Machined, SectionKind::PressedCup] {
        let job = job(kind, COARSE, 12);
        let deck = deck_of(&job);
        assert_eq!(Job::from_deck(&deck).expect("it reads its own decks"), job);
        let missing = deck.replace("load.wrap =", "load.wrop =");
        let error = Job::from_deck(&missing).expect_err("the wrap is missing").to_string();
        assert_eq!(error, "the deck's first lines do not say load.wrap");
    }
}

/// What no export writes would take all memory, divide by zero or never end.
#[test]
fn numbers_of_a_deck_that_no_export_writes_are_refused() {
    let deck = deck_of(&job(SectionKind::PressedCup, COARSE, 12));
    let wrong = [
        ("mesh.sectors", "1e18", "1e18, and it is 8 to 720"),
        ("mesh.sectors", "12.5", "12.5, and it is a whole number"),
        ("mesh.straight", "0", "0e0, and it is 0.05 to 10000"),
        ("mesh.bend", "NaN", "NaN, and it is 0.05 to 10000"),
        ("mesh.through", "-1", "-1e0, and it is 1 to 16"),
        ("mesh.harmonics", "1e9", "1e9, and it is 1 to 200"),
        ("section.type", "5", "5e0, and it is 1 to 4"),
        ("section.bolt_count", "0", "0e0, and it is 1 to 100"),
        ("section.mean_radius", "1e300", "1e300, and it is -10000 to 10000"),
        ("load.normal", "inf", "inf, and it is -1000000000000000 to 1000000000000000"),
        ("material.poisson", "0.5", "5e-1, and it is 0 to 0.499"),
    ];
    for (name, value, said) in wrong {
        let line = deck.lines().find(|line| line.contains(&format!("{name} ="))).unwrap_or_else(|| panic!("{name} is in the deck"));
        let error = Job::from_deck(&deck.replace(line, &format!("** {name} = {value}"))).expect_err(name).to_string();
        assert_eq!(error, format!("the deck's first lines say {name} = {said}; export the pulley again"));
    }
}

#[test]
fn results_of_nodes_that_the_deck_has_not_are_refused() {
    let directory = tempfile::tempdir().expect("there is room");
    let job = job(SectionKind::Machined, COARSE, 12);
    export(&job, directory.path()).expect("the deck is written");
    let nodes = Sweep::new(&mesh_of(&job), job.sectors).nodes();
    let displaced: String = (1..=nodes).map(|node| format!("{node} 0.0 0.0 0.0\n")).collect();
    let write = |reacting: usize| {
        let results = format!(" displacements\n{displaced} forces\n {reacting} 0.0 0.0 1.0\n total volume\n 1.0\n");
        std::fs::write(directory.path().join("pulley.dat"), results).expect("it is written");
    };
    write(nodes);
    compare(directory.path()).expect("the last node is one of the deck");
    write(nodes + 1);
    let error = compare(directory.path()).expect_err("there is no such node").to_string();
    assert_eq!(error, "the results have a node that the deck has not: they are of another deck");
    // Of a coarser pulley with finer numbers than its lines could hold.
    let deck = directory.path().join("pulley.inp");
    let text = std::fs::read_to_string(&deck).expect("it is there");
    std::fs::write(&deck, text.replace("mesh.sectors = 12", "mesh.sectors = 720")).expect("it is written");
    let error = compare(directory.path()).expect_err("it has other nodes").to_string();
    assert!(error.starts_with("the deck has other nodes"), "{error}");
}

#[test]
fn a_deck_whose_nodes_were_moved_is_not_compared() {
    let directory = tempfile::tempdir().expect("there is room");
    export(&job(SectionKind::Machined, COARSE, 12), directory.path()).expect("the deck is written");
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
    let job = job(SectionKind::Machined, COARSE, 12);
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
            // The middle of a side between the planes is on the circle, halfway.
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

#[test]
#[ignore = "runs CalculiX: cargo test --test it -- --ignored calculix"]
fn harmonics_and_calculix_agree_on_a_coarse_pressed_cup() {
    let program = calculix();
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
    let outside = |rows: &[ComparedQuantity]| -> Vec<String> {
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
