//! The tables of the formula against its own direct solve.

use super::*;
use crate::models::{Columns, Model, find, to_si};
use std::sync::Arc;

/// The model.
fn timing_belt() -> Arc<Model> {
    find("timing-belt").expect("it is in the list")
}

/// Inputs in SI units: the default belt with these changes.
fn belt(changes: &[(usize, f64)]) -> Vec<f64> {
    let mut inputs = timing_belt().defaults();
    changes.iter().for_each(|&(input, value)| inputs[input] = value);
    to_si(&timing_belt(), &inputs)
}

#[test]
fn every_boundary_of_the_tables_is_that_of_the_direct_solve() {
    let number = Inputs::NUMBER;
    let mut compared = 0;
    for teeth in [2.0, 3.0, 4.0, 11.0, 23.0, 60.0] {
        for (lift, friction) in [(SPACE, 0.45), (0.0, 0.3), (1.0, 0.0)] {
            let si = belt(&[(number.teeth_in_mesh, teeth), (number.lift_angle, lift), (number.friction, friction)]);
            let i = Inputs::read(&si);
            let rows = mesh::RowCoefficients::new(&i);
            let elimination = mesh::Elimination::new(&rows);
            let mut inward = [0.0; 2 * TEETH];
            let mut tables = [[0.0; 2 * BOUNDARIES]; 5];
            let mut found =
                mesh::ToothTables { inward: in_two(&mut inward), boundaries: Some(tables.each_mut().map(|table| in_two(table))) };
            mesh::back(&rows, &elimination, &mut found);
            for j in 1..=teeth as usize + 1 {
                for (tight, slack) in [(1.0, 0.0), (1.0, 0.4), (0.0, 1.0)] {
                    let solved = mesh::solve(&rows, tight, slack, j as f64, 0.0, 0.0);
                    let table = tables.map(|it| it[j - 1] * tight + it[BOUNDARIES + j - 1] * slack);
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
        let rows = mesh::RowCoefficients::new(&Inputs::read(&si));
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
    let rows = mesh::RowCoefficients::new(&i);
    let solve = |option| mesh::solve(&rows, i.tight_tension, 0.0, 16.0, option, centrifugal_tension(&i));
    // The centrifugal tension of the default belt is 52 N: the lands behind it carry less.
    assert!((centrifugal_tension(&i) - 52.0).abs() < 0.1);
    assert!(solve(1.0).star > solve(0.0).star + 1.0, "the option changes the tensions");
    let outputs = |on: f64| {
        let si = belt(&[(Inputs::NUMBER.centrifugal_land_friction, on)]);
        timing_belt().kernel.outputs(&timing_belt().kernel.prepared(&si), &si, Set::ALL)
    };
    let (on, off) = (outputs(1.0), outputs(0.0));
    assert_eq!(on[OUT.boundary_tension].to_bits(), solve(1.0).star.to_bits());
    assert_eq!(on[OUT.boundary_tooth], off[OUT.boundary_tooth], "the boundary is that of the plain complete mesh");
}

#[test]
fn a_block_at_one_pair_of_tensions_has_the_bits_of_its_designs() {
    let number = Inputs::NUMBER;
    let outputs = [OUT.incomplete_teeth, OUT.boundary_tooth];
    let shorter = |varying: &[(usize, Vec<f64>)], count: usize, prepared: &[f64], si: &[f64]| {
        let columns = Columns { count, varying, outputs: &outputs, conditions: &[0] };
        let mut results = vec![vec![f64::NAN; count.next_multiple_of(8)]; 3];
        let lanes: Vec<_> = si.iter().copied().map(Lanes::splat).collect();
        (block::teeth_at_one_load(prepared, &lanes, &columns, &mut results), results)
    };
    for (teeth, slack, count) in [(23.0, 0.0, 100), (60.0, 40.0, 33), (4.0, 100.0, 8)] {
        let si = belt(&[(number.teeth_in_mesh, teeth), (number.slack_tension, slack), (number.friction, 0.3)]);
        let prepared = timing_belt().kernel.prepared(&si);
        let padded = usize::next_multiple_of(count, 8);
        let speeds: Vec<f64> = (0..padded).map(|lane| 1500.0 / count as f64 * lane.min(count - 1) as f64).collect();
        let varying = [(number.pulley_speed, speeds.clone()), (number.tight_tension, vec![250.0; padded])];
        let (taken, results) = shorter(&varying, count, &prepared, &si);
        assert!(taken);
        let mut seen = std::collections::BTreeSet::new();
        for lane in 0..count {
            let mut design = si.clone();
            (design[number.pulley_speed], design[number.tight_tension]) = (speeds[lane], 250.0);
            let kernel = &timing_belt().kernel;
            let out = kernel.outputs(&prepared, &design, Set::ALL);
            let expected = [out[OUT.incomplete_teeth], out[OUT.boundary_tooth], kernel.margins(&prepared, &design)[0]];
            let found: Vec<_> = results.iter().map(|column| column[lane].to_bits()).collect();
            assert_eq!(found, expected.map(f64::to_bits), "{teeth} teeth, lane {lane}");
            seen.insert(expected[1].to_bits());
        }
        assert!(seen.len() >= 3, "{teeth} teeth: {seen:?}");
        // Tensions that differ are for the walk.
        let mut other = varying.clone();
        other[1].1[padded - 1] = 251.0;
        assert!(!shorter(&other, count, &prepared, &si).0);
        // So is anything else that is asked for.
        let columns = Columns { count, varying: &varying, outputs: &[OUT.boundary_position], conditions: &[] };
        let lanes: Vec<_> = si.iter().copied().map(Lanes::splat).collect();
        assert!(!block::teeth_at_one_load(&prepared, &lanes, &columns, &mut [vec![0.0; padded]]));
    }
}
