//! The tables of the formula against its own direct solve.

use super::*;
use crate::models::to_si;

/// Inputs in SI units: the default belt with these changes.
fn belt(changes: &[(usize, f64)]) -> [f64; INPUTS] {
    let mut inputs = MODEL.defaults();
    changes.iter().for_each(|&(input, value)| inputs[input] = value);
    to_si(&MODEL, &inputs)
}

#[test]
fn every_boundary_of_the_tables_is_that_of_the_direct_solve() {
    let number = Inputs::NUMBER;
    let mut compared = 0;
    for teeth in [2.0, 3.0, 4.0, 11.0, 23.0, 60.0] {
        for (lift, friction) in [(SPACE, 0.45), (0.0, 0.3), (1.0, 0.0)] {
            let si = belt(&[(number.teeth_in_mesh, teeth), (number.lift_angle, lift), (number.friction, friction)]);
            let i = Inputs::read(&si);
            let rows = mesh::Rows::new(&i);
            let elimination = mesh::Elimination::new(&rows);
            let complete = mesh::complete(&rows, &elimination);
            let boundaries = mesh::boundaries(&rows, &elimination, &complete);
            for j in 1..=teeth as usize + 1 {
                for (tight, slack) in [(1.0, 0.0), (1.0, 0.4), (0.0, 1.0)] {
                    let solved = mesh::solve(&rows, tight, slack, j as f64, 0.0, 0.0);
                    let table = boundaries[j - 1].map(|it| it.tight * tight + it.slack * slack);
                    let lifts = j <= teeth as usize;
                    let at = |tooth: usize| solved.load[tooth - 1];
                    let last = teeth as usize;
                    // Beside a boundary; without one the first and the last load stand in for those beside it.
                    let (own, before) = if lifts { (at(j), at(j.max(2) - 1)) } else { (at(1), at(last)) };
                    let expected = [if lifts { solved.star } else { 0.0 }, at(1), own, if j == 1 { at(1) } else { before }, at(last)];
                    for (table, expected) in table.into_iter().zip(expected) {
                        compared += 1;
                        assert!((table - expected).abs() < 1e-12, "{teeth} teeth, j {j}, {tight} {slack}: {table} {expected}");
                    }
                }
            }
        }
    }
    assert!(compared > 4000, "{compared}");
}

#[test]
fn loads_fall_towards_the_slack_side_so_that_four_of_them_tell_the_extremes() {
    let number = Inputs::NUMBER;
    for teeth in [4.0, 23.0, 60.0] {
        let si = belt(&[(number.teeth_in_mesh, teeth)]);
        let rows = mesh::Rows::new(&Inputs::read(&si));
        for j in 1..=teeth as usize + 1 {
            for slack in [0.0, 0.3, 0.99] {
                let loads = mesh::solve(&rows, 1.0, slack, j as f64, 0.0, 0.0).load;
                let (meshed, lifted) = loads[..teeth as usize].split_at((j - 1).min(teeth as usize));
                for side in [meshed, lifted] {
                    assert!(side.windows(2).all(|pair| pair[0] > pair[1]), "{teeth} teeth, j {j}, slack {slack}");
                }
            }
        }
    }
}

#[test]
fn with_the_option_off_the_direct_solve_needs_no_second_round() {
    let si = belt(&[]);
    let i = Inputs::read(&si);
    let rows = mesh::Rows::new(&i);
    let solve = |option| mesh::solve(&rows, i.tight_tension, 0.0, 16.0, option, centrifugal_tension(&i));
    // The centrifugal tension of the default belt is 52 N: the lands behind it carry less.
    assert!((centrifugal_tension(&i) - 52.0).abs() < 0.1);
    assert!(solve(1.0).star > solve(0.0).star + 1.0, "the option changes the tensions");
    let outputs = |on: f64| {
        let si = belt(&[(Inputs::NUMBER.centrifugal_land_friction, on)]);
        let mut out = [0.0; OUTPUTS];
        TimingBelt::finish::<f64>(&MODEL.kernel.prepared(&si), &si, u64::MAX, &mut out);
        out
    };
    let (on, off) = (outputs(1.0), outputs(0.0));
    assert_eq!(on[OUT.boundary_tension].to_bits(), solve(1.0).star.to_bits());
    assert_eq!(on[OUT.boundary_tooth], off[OUT.boundary_tooth], "the boundary is that of the plain complete mesh");
}
