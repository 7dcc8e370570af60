//! The paper on rubber and metal V-belt variators.

mod figures;
mod rows;
mod table_rows;
mod tables;

use super::{Inputs, Lost, Paper, Repair, Reproduction};
use crate::models::wedge_factor;
use std::f64::consts::PI;

/// Everything of this paper.
pub(super) fn reproduce() -> Reproduction {
    Reproduction {
        figures: figures::all(),
        tables: tables::all(),
        comparisons: rows::all(),
        repairs: REPAIRS.to_vec(),
        lost: LOST.to_vec(),
    }
}

const REPAIRS: &[Repair] = &[
    Repair {
        group: Paper::Cvt,
        at: "(8), (11)",
        words: "The denominator is printed mu - tan(alpha/2). Read as mu + tan(alpha/2), as in (6), (15), (16); only so Table 2 comes out.",
    },
    Repair {
        group: Paper::Cvt,
        at: "(13)",
        words: "The exponent is printed mu theta_a. Read with mu/sin(alpha/2) in place of mu, consistent with (12).",
    },
    Repair {
        group: Paper::Cvt,
        at: "(16)",
        words: "The middle line has a factor 2 too many in its last denominator; the last line is right.",
    },
    Repair { group: Paper::Cvt, at: "after (4)", words: "The second symbol is F_N; both are printed F_R." },
    Repair { group: Paper::Cvt, at: "4.1.2", words: "The text's (2) for the coefficient x means (24)." },
    Repair {
        group: Paper::Cvt,
        at: "speed ratio",
        words: "R is not defined. Read as driven over driver radius: above 1 the driver runs on its small radius.",
    },
];

const LOST: &[Lost] = &[
    Lost {
        group: Paper::Cvt,
        what: "measured points of Figs 2 and 9",
        why: "The scan has no pictures; of the points the text says only where they end (traction 0.8 and 0.58) and which curve they follow.",
    },
    Lost {
        group: Paper::Cvt,
        what: "Figs 3 to 6, 8 and 10",
        why: "Sketches of the belt, its drive, belt elements and the test rig: there is nothing to compute in them.",
    },
];

/// The rubber belt of the paper.
fn rubber() -> Inputs {
    Inputs::of("rubber-cvt")
}

/// The metal belt of the paper.
fn metal() -> Inputs {
    Inputs::of("metal-cvt")
}

/// r0 = L/(2 pi) of (18), mm: the radius at which the belt is free of bending.
fn free_radius(belt: &Inputs) -> f64 {
    belt.input("belt_length_mm") / (2.0 * PI)
}

/// Driver axial force of (1), (6) from the force of the tight side, N; `wrap` in radians. For Table 2, whose traction 0.58 lies just
/// beyond the slip limit of its own friction, so that the model gives no force.
fn driver_force(belt: &Inputs, tight_force: f64, wrap: f64) -> f64 {
    let half = belt.input("groove_angle_deg").to_radians() / 2.0;
    tight_force / 2.0 * wrap * wedge_factor(belt.input("friction"), libm::sin(half), libm::cos(half))
}

/// The two axial forces per sum of belt forces over the traction, up to gross slip.
struct PaperCurve {
    traction: Vec<f64>,
    driver: Vec<f64>,
    driven: Vec<f64>,
}

impl PaperCurve {
    fn of(belt: &Inputs) -> Self {
        let limit = belt.output("traction_limit");
        let inside = (0..100).map(|step| f64::from(step) / 100.0).filter(|traction| *traction < limit);
        let designs = inside.map(|traction| (traction, belt.with(&[("traction", traction)])));
        let mut curve = Self { traction: Vec::new(), driver: Vec::new(), driven: Vec::new() };
        for (traction, design) in designs.chain([(limit, belt.with_word("traction", "limit"))]) {
            let outputs = design.outputs();
            curve.traction.push(traction);
            curve.driver.push(outputs.get("driver_axial_coefficient"));
            curve.driven.push(outputs.get("driven_axial_coefficient"));
        }
        curve
    }

    /// Value of a force at the traction nearest to this one.
    fn near(&self, force: &[f64], traction: f64) -> f64 {
        let distance = |at: usize| (self.traction[at] - traction).abs();
        let nearest = (0..self.traction.len()).min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        force[nearest.expect("a curve has points")]
    }

    /// Largest distance of the driver's force from the straight line between its ends, per rise.
    fn driver_bend(&self) -> f64 {
        let last = self.traction.len() - 1;
        let rise = self.driver[last] - self.driver[0];
        let line = |traction: f64| self.driver[0] + rise * (traction - self.traction[0]) / (self.traction[last] - self.traction[0]);
        let distances = self.traction.iter().zip(&self.driver).map(|(traction, force)| ((force - line(*traction)) / rise).abs());
        distances.fold(0.0, f64::max)
    }
}
