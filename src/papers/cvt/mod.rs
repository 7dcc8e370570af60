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

/// Traction at which a belt slips on its driven pulley, (12): the paper's limit at every ratio, whatever the driver does.
fn driven_limit(belt: &Inputs) -> f64 {
    belt.output("driven_traction_limit")
}

/// Coefficient of friction with which a belt slips at this traction: (12) the other way round, by halving.
fn friction_at_slip(belt: &Inputs, traction: f64) -> f64 {
    let (mut low, mut high) = (1e-3, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if driven_limit(&belt.with(&[("friction", middle)])) < traction {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The two axial forces per sum of belt forces over the traction, up to gross slip.
struct PaperCurve {
    traction: Vec<f64>,
    driver: Vec<f64>,
    driven: Vec<f64>,
}

impl PaperCurve {
    /// (4), (5) = (15), (16) up to the slip of the driven pulley, the only one that the paper looks at: at R = 2 the driver slips before, and the
    /// model has no force there.
    fn of(belt: &Inputs) -> Self {
        let outputs = belt.outputs();
        let [driver_wrap, driven_wrap] = ["driver_wrap_deg", "driven_wrap_deg"].map(|name| outputs.get(name).to_radians());
        let half = belt.input("groove_angle_deg").to_radians() / 2.0;
        let (friction, cosine) = (belt.input("friction"), libm::cos(half));
        let wedge = wedge_factor(friction, libm::sin(half), cosine);
        let effective = outputs.get("effective_friction");
        let limit = driven_limit(belt);
        let inside = (0..100).map(|step| f64::from(step) / 100.0).filter(|traction| *traction < limit);
        let mut curve = Self { traction: Vec::new(), driver: Vec::new(), driven: Vec::new() };
        for traction in inside.chain([limit]) {
            let active_arc = (libm::log1p(2.0 * traction / (1.0 - traction)) / effective).min(driven_wrap);
            curve.traction.push(traction);
            curve.driver.push((1.0 + traction) / 4.0 * driver_wrap * wedge);
            curve.driven.push((1.0 - traction) / 4.0 * (driven_wrap - active_arc) * wedge + traction / (2.0 * friction) * cosine);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_paper_s_equations_are_the_model_where_it_has_an_answer() {
        for (belt, ratio) in [(rubber(), 1.0), (rubber(), 2.0), (metal(), 1.0), (metal(), 2.0), (metal(), 0.5)] {
            let belt = belt.with(&[("ratio", ratio)]);
            let curve = PaperCurve::of(&belt);
            for at in [0, 10, 30, 50] {
                let outputs = belt.with(&[("traction", curve.traction[at])]).outputs();
                for (name, value) in [("driver_axial_coefficient", curve.driver[at]), ("driven_axial_coefficient", curve.driven[at])] {
                    let of_model = outputs.get(name);
                    assert!((value / of_model - 1.0).abs() < 1e-13, "{name} at R {ratio}, {}: {value}, {of_model}", curve.traction[at]);
                }
            }
        }
    }

    #[test]
    fn the_friction_of_a_slip_is_the_inverse_of_tanh() {
        // lambda = tanh(mu theta/(2 sin(alpha/2))) at theta = pi.
        for (belt, traction, half) in [(rubber(), 0.8, 15.0_f64), (metal(), 0.58, 11.0)] {
            let closed = libm::atanh(traction) * 2.0 / PI * libm::sin(half.to_radians());
            assert!((friction_at_slip(&belt, traction) / closed - 1.0).abs() < 1e-12);
        }
    }
}
