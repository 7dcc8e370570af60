//! The paper on the design and analysis of V-belt pulleys.

mod figures;
mod rows;
mod tables;
mod thickness;

use super::comparison::digits;
use super::evaluated::Outputs;
use super::{Inputs, Lost, Paper, Repair, Reproduction};

use crate::export::pulley::{NodeStress, deformed};

/// Everything of this paper.
pub(super) fn reproduce() -> Reproduction {
    let studied = thickness::study();
    let stressed = TYPES.map(Stressed::new);
    let mut figures = vec![figures::loads(), thickness::figure(&studied)];
    figures.extend(stressed.iter().map(figures::stresses));
    let tables = vec![tables::data(), thickness::table(&studied)];
    Reproduction { figures, tables, comparisons: rows::all(&studied, &stressed), repairs: REPAIRS.to_vec(), lost: LOST.to_vec() }
}

const REPAIRS: &[Repair] = &[
    Repair {
        group: Paper::Pulley,
        at: "section 2.1",
        words: "The names of T_t and T_s, tight and slack tension, are swapped; nomenclature and equations are right.",
    },
    Repair {
        group: Paper::Pulley,
        at: "nomenclature",
        words: "g is printed in kg m/s^2; it is m/s^2. F is a force per length there, but F ds a force in (4).",
    },
    Repair {
        group: Paper::Pulley,
        at: "(4)-(14)",
        words: "w v^2/g with w in kgf/m is in kgf, the tensions are in N. Read as w v^2 with w in kg/m.",
    },
    Repair {
        group: Paper::Pulley,
        at: "(8), (13)",
        words: "The quotient's bar is lost in the scan: the right side is the logarithm over theta.",
    },
    Repair {
        group: Paper::Pulley,
        at: "2.3, (16)",
        words: "The radial friction acts along the flank, inwards and towards the groove's middle, and circumferential friction on the pulley points to the tight end: only so the loads balance.",
    },
    Repair {
        group: Paper::Pulley,
        at: "section 2.6",
        words: "The pulley's own centrifugal load is not the belt's (4): it is density times omega^2 r over the volume.",
    },
];

const LOST: &[Lost] = &[
    Lost {
        group: Paper::Pulley,
        what: "Figs 1, 2 and 5 to 7",
        why: "The scan has no pictures: the sections of the four types, the solid model and its loads are not known. Four sections of the same \
              kinds are computed in their place, with dimensions of our choice.",
    },
    Lost {
        group: Paper::Pulley,
        what: "Figs 3 and 4",
        why: "Free bodies of belt and pulley: there is nothing to compute in them but (1) to (16).",
    },
    Lost {
        group: Paper::Pulley,
        what: "the text from the end of 3.2 into 4.2, with Figs 8 and 9",
        why: "A page is missing in the scan: it breaks off at the support of the bolt seats and goes on at the dialogs. The meshing, the rest of \
              chapter 3 and the structure of the program stood there.",
    },
    Lost {
        group: Paper::Pulley,
        what: "Figs 10 to 12",
        why: "Dialogs and flow of the program. What stood in them, three thicknesses, the points P1 and P2, stresses and volumes, is lost; the \
              text gives the chosen thickness alone.",
    },
    Lost {
        group: Paper::Pulley,
        what: "the stresses of Fig. 13",
        why: "The pictures are lost and no number is printed. The text says where stresses are high, which is compared.",
    },
];

/// A type of pulley.
struct Type {
    /// Name of the figure.
    id: &'static str,
    preset: &'static str,
    words: &'static str,
}

const TYPES: [Type; 4] = [
    Type { id: "pulley-fig-13-machined", preset: "machined", words: "type 1, machined" },
    Type { id: "pulley-fig-13-welded-discs", preset: "welded-discs", words: "type 2, two welded discs" },
    Type { id: "pulley-fig-13-double-groove", preset: "double-groove", words: "type 3, double groove" },
    Type { id: "pulley-fig-13-pressed-cup", preset: "pressed-cup", words: "type 4, pressed cup" },
];

/// A type with its stresses under the data of Table 1.
struct Stressed {
    of: Type,
    title: String,
    svg: String,
    nodes: Vec<NodeStress>,
    /// The largest stress outside the zone that is left out, MPa, and the radius of that zone, mm.
    largest: f64,
    excluded: f64,
    yield_strength: f64,
    place: PulleyPlace,
}

impl Stressed {
    fn new(of: Type) -> Self {
        let pulley = Inputs::preset("pulley", of.preset).with(&[("friction_direction_deg", thickness::DIRECTIONS[0])]);
        let title = format!("Fig. 13, {}: von Mises stress in the deformed section", of.words);
        let (svg, nodes) = deformed(&pulley.model, &title, &pulley.values).expect("the example has a solution");
        let outputs = pulley.outputs();
        let [largest, excluded] = ["max_stress_MPa", "excluded_radius_mm"].map(|name| outputs.get(name));
        let yield_strength = pulley.input("yield_strength_MPa");
        Self { of, title, svg, nodes, largest, excluded, yield_strength, place: PulleyPlace::of(&pulley, &outputs) }
    }

    /// The largest stress inside the zone that is left out, MPa: at the bolt seats and the bracket's edge.
    fn seats(&self) -> f64 {
        self.nodes.iter().filter(|node| node.place[1] < self.excluded).map(|node| node.von_mises).fold(0.0, f64::max)
    }
}

/// The example of the paper: the pressed cup under the data of Table 1.
fn example() -> Inputs {
    Inputs::preset("pulley", "paper")
}

/// Where the largest stress of a pulley stands.
struct PulleyPlace {
    words: String,
    /// Is it in a bend, a corner or at the edge of the weld?
    shape_changes: bool,
}

impl PulleyPlace {
    fn of(pulley: &Inputs, outputs: &Outputs) -> Self {
        let [r, z, theta] = ["max_stress_r_mm", "max_stress_z_mm", "max_stress_theta_deg"].map(|name| outputs.get(name));
        let section = pulley.model.input("section").expect("a pulley has a section");
        let discs = pulley.model.inputs[section].word_for(pulley.values[section]) == Some("welded-discs");
        // The floor of the groove is flat between its bends, which rise from it.
        let above_floor = r - (pulley.input("mean_radius_mm") - pulley.input("floor_depth_mm"));
        let at_floor = !discs && (0.01..=pulley.input("floor_bend_radius_mm")).contains(&above_floor);
        let at_weld = discs && (r - 0.5 * pulley.input("weld_diameter_mm")).abs() <= pulley.input("thickness_mm");
        let there = if at_floor {
            "in the bend at the groove's floor"
        } else if at_weld {
            "beside the edge of the weld"
        } else {
            "away from every change of shape"
        };
        let before_end = pulley.input("wrap_angle_deg") - theta;
        let around = if before_end >= 0.0 { "before" } else { "behind" };
        let words =
            format!("{there} (r {}, z {} mm), {}° {around} the belt's tight end", digits(r), digits(z), digits(before_end.abs().round()));
        Self { words, shape_changes: at_floor || at_weld }
    }
}
