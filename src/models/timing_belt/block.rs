//! Many speeds at one pair of tensions, where only the boundary tooth is asked for: the rows of a map.

use super::super::formula::Columns;
use super::{Inputs, OUT, Prepared, TEETH, inward};
use crate::real::{LANES, Lanes, Place, Real};

/// Number of the condition on the tensions.
const EFFECTIVE: usize = 0;

/// The boundary tooth of designs that share both tensions. What presses the teeth inwards is then the same for all, and so is the least
/// of the first ones: the boundary tooth counts how many of these least values a design's centrifugal force does not exceed. The same
/// comparisons as in the walk over the teeth, a quarter of the work.
#[inline(always)]
pub fn teeth_at_one_load(prepared: &[f64], inputs: &[Lanes], columns: &Columns<'_>, results: &mut [Vec<f64>]) -> bool {
    let number = Inputs::NUMBER;
    let asks_teeth = columns.outputs.iter().all(|&output| output == OUT.boundary_tooth || output == OUT.incomplete_teeth);
    if !asks_teeth || columns.outputs.is_empty() || columns.conditions.iter().any(|&condition| condition != EFFECTIVE) {
        return false;
    }
    let mut shared: [f64; Inputs::<usize>::NAMES.len()] = std::array::from_fn(|input| inputs[input].0[0]);
    let padded = columns.count.next_multiple_of(LANES);
    let mut speeds = None;
    for (input, column) in columns.varying {
        let column = &column[..padded];
        if *input == number.pulley_speed {
            speeds = Some(column);
        } else if column.iter().any(|value| *value != column[0]) {
            return false;
        } else {
            shared[*input] = column[0];
        }
    }
    let i = Inputs::read(&shared);
    let p = Prepared::<f64>::shared(prepared);
    let teeth = i.teeth_in_mesh.iterations(TEETH);
    let mut held = [0.0; TEETH];
    let mut least = f64::INFINITY;
    for (tooth, held) in held[..teeth].iter_mut().enumerate() {
        let force = inward(&i, prepared, Place::at(tooth));
        if !force.is_finite() {
            return false;
        }
        least = if force < least { force } else { least };
        *held = least;
    }
    for first in (0..padded).step_by(LANES) {
        let mut force = [0.0; LANES];
        for lane in 0..LANES {
            let speed = speeds.map_or(i.pulley_speed, |speeds| speeds[first + lane]);
            force[lane] = p.mass_radius * (speed * speed);
        }
        let mut tooth = [1.0; LANES];
        for &held in &held[..teeth] {
            for lane in 0..LANES {
                tooth[lane] += if held >= force[lane] { 1.0 } else { 0.0 };
            }
        }
        for (&output, result) in columns.outputs.iter().zip(&mut *results) {
            for lane in 0..LANES {
                let lifted = i.teeth_in_mesh + 1.0 - tooth[lane];
                result[first + lane] = if output == OUT.boundary_tooth { tooth[lane] } else { lifted };
            }
        }
    }
    for result in &mut results[columns.outputs.len()..] {
        result[..padded].fill(i.tight_tension - i.slack_tension);
    }
    true
}
