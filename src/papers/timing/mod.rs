//! The paper on incomplete meshing of a timing belt.

mod figures;
mod printed;
mod reading;
mod rows;

use super::{Inputs, Lost, Paper, Repair, Reproduction};

/// Everything of this paper.
pub(super) fn reproduce() -> Reproduction {
    Reproduction { figures: figures::all(), tables: Vec::new(), comparisons: rows::all(), repairs: REPAIRS.to_vec(), lost: LOST.to_vec() }
}

const REPAIRS: &[Repair] = &[
    Repair { group: Paper::TimingBelt, at: "(5), (7), (13)", words: "Printed 1/AE is l/AE, with the length of the tooth part." },
    Repair { group: Paper::TimingBelt, at: "(8)", words: "Line i has T(N-1)' where T(i-1)' is meant." },
    Repair { group: Paper::TimingBelt, at: "(14)", words: "Line M has T(M) on both sides; the right one is T(M-1)." },
    Repair {
        group: Paper::TimingBelt,
        at: "(15)",
        words: "The printed v is w, and v = f cos(phi - theta) is missing. Y1 is printed with C6 and C7 where C5 and C6 are meant.",
    },
    Repair {
        group: Paper::TimingBelt,
        at: "(17)-(19)",
        words: "Tooth j - 1 meshes: its belt leaves at phi in (17) and in nu, which (9) has with the psi of the slack span. With phi - theta in both places, as (17) has it, T* moves by 0.04 %. In (18) f is missing before two cosines; (19) has it.",
    },
    Repair {
        group: Paper::TimingBelt,
        at: "(20)",
        words: "Specific weight is used as density. Section 2.3 names two volumes V2; the first is V1.",
    },
    Repair { group: Paper::TimingBelt, at: "step (4), Fig. 9", words: "Step (4) calls j the boundary; Fig. 9 calls j - 1 = 15 so." },
    Repair {
        group: Paper::TimingBelt,
        at: "section 3",
        words: "f = 2.55 m/N has lost its prefix and is read as micrometres; omega is printed in rpm where (21) needs rad/s.",
    },
    Repair {
        group: Paper::TimingBelt,
        at: "section 2.3",
        words: "The sum of the radial inward forces is not printed. Taken as (T_in + T) sin(phi + beta) + Q (mu cos alpha - sin alpha) of a whole pitch whose land carries nothing.",
    },
];

const LOST: &[Lost] = &[
    Lost {
        group: Paper::TimingBelt,
        what: "the values of the loads in Figs 8 to 11",
        why: "The scan has no pictures, and the text prints no load: boundaries and directions of change are all that can be compared.",
    },
    Lost {
        group: Paper::TimingBelt,
        what: "Figs 1 to 7",
        why: "Sketches of the drive, the mesh and belt elements: there is nothing to compute in them.",
    },
];

/// Tooth loads of a pulley.
struct TimingMesh {
    speed: f64,
    tension: f64,
    tooth: Vec<f64>,
    /// Loads of the mesh as it is, N.
    load: Vec<f64>,
    /// Loads if every tooth meshed, N.
    complete: Vec<f64>,
    /// Tensions of the mesh as it is, N.
    tensions: Vec<f64>,
    /// First lifted tooth.
    first_lifted: usize,
}

impl TimingMesh {
    fn of(pulley: &Inputs) -> Self {
        Self {
            speed: pulley.input("pulley_speed_rpm"),
            tension: pulley.input("tight_tension_N"),
            tooth: pulley.column("tooth"),
            load: pulley.column("tooth_load_N"),
            complete: pulley.column("tooth_load_complete_N"),
            tensions: pulley.column("tension_N"),
            first_lifted: pulley.output("boundary_tooth") as usize,
        }
    }

    /// What the boundary does to the load of each tooth, as a share of the complete mesh's.
    fn changes(&self) -> Vec<f64> {
        self.load.iter().zip(&self.complete).map(|(load, complete)| load / complete - 1.0).collect()
    }
}

/// The driven pulley at a speed, rpm, and a tight tension, N.
fn driven(speed: f64, tension: f64) -> Inputs {
    Inputs::preset("timing-belt", "ohc-driven").with(&[("pulley_speed_rpm", speed), ("tight_tension_N", tension)])
}

/// The driver at a tight tension, at rest.
fn driver_at_rest(tension: f64) -> Inputs {
    Inputs::preset("timing-belt", "ohc-driver").with(&[("pulley_speed_rpm", 0.0), ("tight_tension_N", tension)])
}
