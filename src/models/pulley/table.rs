//! What the pulley model says of itself.

use super::super::description::{Condition, Effort, Input, Output, Preset, Range, Worse};
use super::super::evaluation::to_si;
use super::super::model::Model;
use super::super::pulley_load;
use super::fields::{ANGLE_WORST, FINE, FROM_TENSILE, POINT_NONE, TORQUE};
use super::{CHECK_POINT_STRESSES, Design, Pulley, notes, profile, read_by};
use crate::pulley::section::SectionKind;
use crate::units::{CUBIC_MILLIMETRE, DEGREE, GRAM, KILOGRAM_PER_CUBIC_METRE, MEGAPASCAL, MILLIMETRE, NEWTON, NEWTON_METRE, NONE};
use std::sync::Arc;

const MACHINED: &str = "machined";
const DISCS: &str = "welded-discs";
const DOUBLE: &str = "double-groove";
const CUP: &str = "pressed-cup";

const PAPER: &str = "paper, Table 1";
const TYPE_4: &str = "chosen for the example; not printed";
const TYPE_1: &str = "chosen for type 1; not printed";
const CUSTOM: &str = "customary";

/// A length greater than zero.
fn length(name: &str, symbol: &str, default: f64, usual: (f64, f64), doc: &str, source: &str) -> Input {
    Input::new(name, symbol, MILLIMETRE, default, usual, doc, source)
}

fn strength(name: &str, symbol: &str, default: f64, usual: (f64, f64), doc: &str, source: &str) -> Input {
    Input::new(name, symbol, MEGAPASCAL, default, usual, doc, source)
}

/// A coordinate of a place of the engineer's own.
fn place_r(name: &str, symbol: &str) -> Input {
    Input {
        valid: Range::NOT_NEGATIVE,
        ..length(
            name,
            symbol,
            POINT_NONE,
            (0.0, 500.0),
            "Distance from the axis of a place whose stress you want (taken at the nearest point of the surface).",
            CUSTOM,
        )
        .with_words(&[("none", POINT_NONE)])
    }
}
fn place_z(name: &str, symbol: &str) -> Input {
    Input {
        valid: Range { low: -1000.0, high: 1000.0, includes_low: true, includes_high: true },
        ..length(name, symbol, 0.0, (-500.0, 500.0), "Distance of that place from the bracket face.", CUSTOM)
    }
}

/// Inputs in the order of [`Inputs`](super::fields::Inputs): the belt's, then the pulley's.
fn inputs(belt: Vec<Input>) -> Vec<Input> {
    let own = vec![
        Input::enumeration(
            "section",
            "",
            &[(MACHINED, 1.0), (DISCS, 2.0), (DOUBLE, 3.0), (CUP, 4.0)],
            4.0,
            "Type of the section, 1 to 4 of the paper; `--preset` has each type's dimensions.",
            "paper, types 1-4",
        ),
        Input::enumeration(
            "accuracy",
            "",
            &[("usual", 2.0), ("fine", FINE)],
            2.0,
            "Mesh and harmonics for an error of 2 % (usual) or 0.5 % (fine) of the stress away from bracket and bolts.",
            "convergence study in results/pulley",
        ),
        length(
            "thickness_mm",
            "t",
            1.8,
            (0.8, 12.0),
            "Thickness of the sheet; of hub plate and web of the machined type.",
            "paper, the one chosen of three",
        ),
        length("bore_diameter_mm", "", 20.0, (8.0, 60.0), "Diameter of the bore.", TYPE_4),
        length(
            "cup_diameter_mm",
            "",
            66.0,
            (30.0, 300.0),
            "Where the hub's back would meet the cup's wall, unrounded; outside of the wall of the machined type.",
            TYPE_4,
        ),
        length("wall_diameter_mm", "", 78.0, (30.0, 400.0), "Where the cup's wall would meet the radial wall, unrounded.", TYPE_4),
        length("wall_offset_mm", "", 10.0, (2.0, 40.0), "Distance of the back of the radial wall from the bracket face.", TYPE_4),
        length("hub_bend_radius_mm", "R_B", 5.0, (1.0, 12.0), "Bend radius B between hub and wall, on the back.", TYPE_4),
        length("web_bend_radius_mm", "R_C", 3.0, (1.0, 12.0), "Bend radius C between cup and radial wall, on the back.", TYPE_4),
        length(
            "fold_radius_mm",
            "R_D",
            3.4,
            (1.5, 12.0),
            "Radius D of the fold (pressed-cup) or of the ridges (double-groove), on the outside.",
            TYPE_4,
        ),
        length(
            "ridge_width_mm",
            "",
            6.0,
            (4.0, 20.0),
            "Width of a ridge beside a groove between its unrounded corners.",
            "widened so that the bends exist",
        ),
        length(
            "weld_diameter_mm",
            "",
            66.0,
            (30.0, 300.0),
            "Diameter up to which the two discs are welded.",
            "chosen for type 2; not printed",
        ),
        length("wall_thickness_mm", "", 6.0, (2.0, 20.0), "Thickness of the cup's wall.", TYPE_1),
        length("rim_thickness_mm", "", 5.0, (2.0, 20.0), "Distance from the groove's floor inwards to the rim's underside.", TYPE_1),
        length("lip_thickness_mm", "", 4.0, (1.5, 15.0), "Thickness of the groove's sides at the rim's edge.", TYPE_1),
        length("fillet_radius_mm", "", 1.5, (0.5, 6.0), "Radius of the fillets of inner corners.", "sharp ones are singular"),
        length("groove_offset_mm", "", 16.0, (5.0, 60.0), "Distance of the groove's mid-plane from the bracket face.", TYPE_1),
        length("groove_width_mm", "", 13.0, (8.0, 32.0), "Width of the groove at its top.", TYPE_4),
        length("groove_height_mm", "", 5.0, (2.0, 12.0), "Distance from the mean radius outwards to the groove's top.", TYPE_4),
        length("floor_depth_mm", "", 7.0, (3.0, 20.0), "Distance from the mean radius inwards to the groove's floor.", TYPE_4),
        length(
            "floor_bend_radius_mm",
            "R_E, R_F",
            1.5,
            (0.5, 6.0),
            "Bend radii E and F at the groove's floor, on the belt's side.",
            TYPE_4,
        ),
        Input {
            valid: Range::NOT_NEGATIVE,
            ..length("rim_height_mm", "", 1.5, (0.0, 6.0), "Distance from the groove's top outwards to the rim's edge.", TYPE_4)
        },
        length(
            "contact_height_mm",
            "h",
            9.0,
            (3.0, 20.0),
            "Radial height of the band of the flank that the belt touches, centred on the mean radius.",
            TYPE_4,
        ),
        length("bracket_diameter_mm", "", 55.0, (25.0, 250.0), "Diameter of the bracket, on which the hub's back is fixed.", PAPER),
        Input {
            integer: true,
            valid: Range { low: 2.0, high: 12.0, includes_low: true, includes_high: true },
            ..Input::new("bolt_count", "n_b", NONE, 4.0, (3.0, 8.0), "Number of bolts.", PAPER)
        },
        length("bolt_circle_mm", "PCD", 45.0, (20.0, 200.0), "Diameter of the bolt circle.", PAPER),
        length("bolt_hole_mm", "D_i", 6.6, (3.0, 25.0), "Diameter of the bolt holes.", "ISO 273, M6"),
        length("bolt_head_mm", "D_o", 12.0, (5.0, 50.0), "Diameter of the bolt heads or washers.", "ISO 7089, M6"),
        Input {
            valid: Range { high: 360.0, includes_high: true, ..Range::NOT_NEGATIVE },
            ..Input::new(
                "bolt_angle_deg",
                "phi",
                DEGREE,
                44.0,
                (0.0, 360.0),
                "Angle of the first bolt from the belt's slack end; \"worst\": the angle with the largest stress.",
                "middle of the wrap",
            )
            .with_words(&[("worst", ANGLE_WORST)])
        },
        Input {
            valid: Range::NOT_NEGATIVE,
            ..Input::new(
                "clamp_force_N",
                "F_bolt",
                NEWTON,
                8333.333,
                (0.0, 100_000.0),
                "Force of one bolt; \"torque\" computes it from tightening_torque_Nm.",
                "10 N m/(0.2 x 6 mm)",
            )
            .with_words(&[("torque", TORQUE)])
        },
        Input::new(
            "tightening_torque_Nm",
            "M",
            NEWTON_METRE,
            10.0,
            (1.0, 400.0),
            "Tightening torque of a bolt, read if clamp_force_N = \"torque\".",
            PAPER,
        ),
        Input::new("bolt_friction", "mu_s, mu_w", NONE, 0.15, (0.08, 0.25), "Friction in the thread and under the head.", CUSTOM),
        length("bolt_pitch_mm", "p", 1.0, (0.5, 3.0), "Pitch of the thread.", "paper, M6x1"),
        length("bolt_pitch_diameter_mm", "d_2", 5.35, (2.5, 25.0), "Pitch diameter of the thread.", "ISO 724, M6"),
        strength(
            "bolt_proof_strength_MPa",
            "S_p",
            580.0,
            (225.0, 970.0),
            "Proof strength of the bolts: up to this stress no length is lost.",
            "ISO 898-1, class 8.8 up to M16",
        ),
        Input::new(
            "joint_friction",
            "mu_j",
            NONE,
            0.15,
            (0.08, 0.25),
            "Friction between hub and bracket, which carries the torque.",
            "customary: dry, machined steel",
        ),
        strength("elastic_modulus_MPa", "E", 206_000.0, (60_000.0, 220_000.0), "Elastic modulus.", "steel"),
        Input {
            valid: Range { low: 0.0, high: 0.5, includes_low: true, includes_high: false },
            ..Input::new("poisson_ratio", "nu", NONE, 0.29, (0.2, 0.35), "Poisson's ratio.", "steel")
        },
        Input {
            valid: Range::NOT_NEGATIVE,
            ..Input::new("density_kg_per_m3", "rho", KILOGRAM_PER_CUBIC_METRE, 7850.0, (2600.0, 8000.0), "Density.", "steel")
        },
        strength("yield_strength_MPa", "S_y", 270.0, (100.0, 1000.0), "Yield strength.", PAPER),
        strength("tensile_strength_MPa", "S_u", 370.0, (150.0, 1500.0), "Tensile strength.", "chosen; not printed"),
        Input {
            ..strength(
                "endurance_limit_MPa",
                "S_e",
                FROM_TENSILE,
                (50.0, 600.0),
                "Amplitude that is endured at zero mean stress; \"from-tensile\": 0.33 times the tensile strength.",
                "chosen; not printed",
            )
            .with_words(&[("from-tensile", FROM_TENSILE)])
        },
        place_r("point_1_r_mm", "P1"),
        place_z("point_1_z_mm", "P1"),
        place_r("point_2_r_mm", "P2"),
        place_z("point_2_z_mm", "P2"),
    ];
    let mut inputs = [belt, own].concat();
    let kinds = SectionKind::ALL.map(|kind| (kind.name(), read_by(kind)));
    for (number, input) in inputs.iter_mut().enumerate() {
        let readers: Vec<_> = kinds.iter().filter(|(_, read)| read.contains(number)).map(|(name, _)| *name).collect();
        if (1..SectionKind::ALL.len()).contains(&readers.len()) {
            *input = input.clone().read_only_for("section", &readers);
        }
    }
    inputs
}

fn fe(name: &str, unit: crate::units::Unit, worse: Worse, doc: &str) -> Output {
    Output::new(name, "", unit, worse, "finite elements", doc)
}

/// The stress at a check point.
fn at(name: &str, doc: &str) -> Output {
    fe(name, MEGAPASCAL, Worse::Higher, doc)
}

use Worse::{Higher, Lower};

/// Outputs in the order of [`Result`]: the belt's, then the pulley's.
fn outputs(belt: Vec<Output>) -> Vec<Output> {
    let own = vec![
        at("max_stress_MPa", "Largest von Mises stress of the surface outside excluded_radius_mm."),
        fe("max_stress_r_mm", MILLIMETRE, Higher, "Its distance from the axis."),
        fe("max_stress_z_mm", MILLIMETRE, Higher, "Its distance from the bracket face."),
        fe("max_stress_theta_deg", DEGREE, Higher, "Its angle from the belt's slack end towards the tight end."),
        at("stress_Bl_MPa", "Largest von Mises stress over one revolution at bend B, left (back) side."),
        at("stress_Br_MPa", "The same at bend B, right (front) side; machined: at the fillet between hub plate and wall."),
        at("stress_Cl_MPa", "At bend C, left side; machined: at the fillet between wall and web."),
        at("stress_Cr_MPa", "At bend C, right side."),
        at("stress_Dl_MPa", "At fold or ridge D, left (outer) side; machined: between web and rim; welded discs: back of the first flank."),
        at("stress_Dr_MPa", "At D, right side; welded discs: the first flank in the groove."),
        at("stress_El_MPa", "At bend E, groove side; welded discs: the second flank in the groove."),
        at("stress_Er_MPa", "At bend E, back side; welded discs: back of the second flank."),
        at("stress_Fl_MPa", "At bend F, groove side."),
        at("stress_Fr_MPa", "At bend F, back side."),
        at("stress_P1_MPa", "At the surface point nearest to point_1_r_mm, point_1_z_mm."),
        at("stress_P2_MPa", "At the surface point nearest to point_2_r_mm, point_2_z_mm."),
        fe("rim_displacement_mm", MILLIMETRE, Higher, "Largest displacement of the rim's edge over one revolution."),
        Output::new("volume_mm3", "V", CUBIC_MILLIMETRE, Higher, "section", "Volume of the pulley without bolt holes."),
        Output::new("mass_g", "m", GRAM, Higher, "density V", "Mass of the pulley without bolt holes."),
        Output::new("yield_safety", "", NONE, Lower, "S_y/max_stress", "Yield strength over the largest stress."),
        Output::new(
            "fatigue_safety",
            "",
            NONE,
            Lower,
            "Goodman: 1/(S_a/S_e + S_m/S_u)",
            "Least safety against fatigue over one revolution.",
        ),
        fe(
            "fatigue_amplitude_MPa",
            MEGAPASCAL,
            Higher,
            "Amplitude at the point of least fatigue safety: largest von Mises stress of half the difference between two angles.",
        ),
        fe(
            "fatigue_mean_MPa",
            MEGAPASCAL,
            Higher,
            "Mean stress there: signed von Mises stress midway between these angles, clamp and spin included.",
        ),
        Output::new(
            "excluded_radius_mm",
            "",
            MILLIMETRE,
            Higher,
            "edges of bracket and bolt heads",
            "Stress inside this radius does not count as the largest: beside the edges of bracket and bolt heads it has no limit.",
        ),
        Output::new(
            "seat_pressure_MPa",
            "p",
            MEGAPASCAL,
            Higher,
            "F/(pi/4 (D_o^2 - D_i^2))",
            "Pressure under the bolt heads: it presses on the section, and should stay below the yield strength of the sheet.",
        ),
        Output::new(
            "bolt_utilisation",
            "",
            NONE,
            Higher,
            "F/(A_s S_p), A_s of ISO 898-1",
            "Stress of a bolt from its clamp force, over its proof strength; the belt's pull is not in it.",
        ),
        Output::new(
            "joint_slip_safety",
            "",
            NONE,
            Lower,
            "n_b F mu_j PCD/(2 torque)",
            "Torque that friction between hub and bracket holds, over the torque; absent without torque.",
        ),
    ];
    [belt, own].concat()
}

/// What the belt's pressure gives besides the stresses at the check points.
const OF_THE_PRESSURE: [&str; 11] = [
    "max_stress_MPa",
    "max_stress_r_mm",
    "max_stress_z_mm",
    "max_stress_theta_deg",
    "stress_P1_MPa",
    "stress_P2_MPa",
    "rim_displacement_mm",
    "yield_safety",
    "fatigue_safety",
    "fatigue_amplitude_MPa",
    "fatigue_mean_MPa",
];

/// What section and bolts give besides.
const OF_THE_SECTION: [&str; 6] =
    ["volume_mm3", "mass_g", "excluded_radius_mm", "seat_pressure_MPa", "bolt_utilisation", "joint_slip_safety"];

fn without(reason: &str, invalidates: &[&str], doc: &str) -> Condition {
    Condition::new(reason, false, invalidates, doc).quiet()
}

fn conditions() -> Vec<Condition> {
    let stresses = [&CHECK_POINT_STRESSES[..], &OF_THE_PRESSURE].concat();
    let all = [&stresses[..], &OF_THE_SECTION].concat();
    let own = [
        Condition::new(
            "no section",
            false,
            &all,
            "The dimensions make a section: every bend has an inside radius, bends do not overlap, the outline does not cross itself, and the type has this number of grooves.",
        ),
        Condition::new("contact band off the flank", false, &all, "The belt touches the straight part of the flanks only."),
        Condition::new(
            "no seat for bolts and bracket",
            false,
            &all,
            "Bolt heads and bracket are on the flat hub, heads do not touch each other, holes are inside the bracket and heads outside the bore.",
        ),
        without(
            "one side",
            &["stress_Bl_MPa", "stress_Cr_MPa", "stress_Er_MPa", "stress_Fr_MPa"],
            "A machined section has one surface at B, C, E and F.",
        ),
        without("no bend F", &["stress_Fl_MPa", "stress_Fr_MPa"], "Welded discs have no groove floor."),
        without("no point P1", &["stress_P1_MPa"], "point_1_r_mm is given."),
        without("no point P2", &["stress_P2_MPa"], "point_2_r_mm is given."),
        Condition::new("no torque", true, &["joint_slip_safety"], "There is torque that the joint could slip under.").quiet(),
    ];
    pulley_load::conditions(&all, &stresses).into_iter().chain(own).collect()
}

const SMALL_GROOVE: [(&str, f64); 3] = [("mean_radius_mm", 55.5), ("groove_width_mm", 12.7), ("groove_height_mm", 4.5)];

/// The model.
pub fn model() -> Model {
    let load = pulley_load::model();
    Model {
        name: "pulley".into(),
        version: String::new(),
        summary: "V-belt pulley: stresses by finite elements, safety, displacement and mass of four types of section".into(),
        source: "K.-S. Lee et al.: design and analysis system for V-belt pulleys; finite elements in harmonics around the axis".into(),
        limits: "Linear and elastic, axisymmetric but for its loads: no lightening holes, no bolt holes outside the bracket, no residual \
             stress or thinning from forming, no contact between welded discs. The back of the hub is fixed inside the bracket. \
             Stress at the edges of bracket and bolt heads has no limit and is left out. Of the bolts only preload, seat pressure and the \
             joint's friction are looked at."
            .into(),
        inputs: inputs(load.inputs),
        outputs: outputs(load.outputs),
        conditions: conditions(),
        presets: vec![
            Preset::new(
                MACHINED,
                &[
                    ("section", 1.0),
                    SMALL_GROOVE[0],
                    SMALL_GROOVE[1],
                    SMALL_GROOVE[2],
                    ("floor_depth_mm", 9.5),
                    ("rim_height_mm", 1.0),
                    ("thickness_mm", 8.0),
                    ("bore_diameter_mm", 25.0),
                    ("cup_diameter_mm", 74.0),
                ],
            ),
            Preset::new(
                DISCS,
                &[
                    ("section", 2.0),
                    SMALL_GROOVE[0],
                    SMALL_GROOVE[1],
                    SMALL_GROOVE[2],
                    ("rim_height_mm", 1.0),
                    ("thickness_mm", 1.6),
                    ("bore_diameter_mm", 30.0),
                ],
            ),
            Preset::new(
                DOUBLE,
                &[
                    ("section", 3.0),
                    ("groove_count", 2.0),
                    SMALL_GROOVE[0],
                    SMALL_GROOVE[1],
                    SMALL_GROOVE[2],
                    ("floor_depth_mm", 8.5),
                    ("rim_height_mm", 2.5),
                    ("thickness_mm", 2.3),
                    ("bore_diameter_mm", 30.0),
                    ("cup_diameter_mm", 63.4),
                    ("wall_diameter_mm", 71.4),
                    ("wall_offset_mm", 8.0),
                    ("hub_bend_radius_mm", 4.5),
                ],
            ),
            Preset::new(CUP, &[]),
            // The example of the paper: the pressed cup, with the paper's friction.
            Preset::new("paper", &[pulley_load::PAPERS_FRICTION]),
        ],
        starter: include_str!("../../../studies/pulley-thickness.toml").into(),
        kernel: Arc::new(Pulley),
        on_gpu: false,
        effort: Effort { prepare: 8e-3, finish: 7e-4 },
        // The sample costs as much as the sweep of so many designs.
        sample: 4096,
        profile: Some(Arc::new(profile::profile)),
        notes: Some(Arc::new(notes::notes)),
        remarks: None,
        doubts: None,
        pulley: Some(Arc::new(|model, inputs| Design::new(&to_si(model, inputs)))),
        origin: None,
    }
}
