//! The pulley model against converged finite elements: harmonic ones, which agree within 0.1 % with swept three-dimensional ones of
//! another program, for the pressed cup under the loads of the paper's Table 1.

use beltspace::models::{CHECK_POINT_STRESSES, Model, Status, evaluate, find};
use std::sync::Arc;

fn model() -> Arc<Model> {
    find("pulley").expect("it is a model")
}

/// Outputs by name, of the paper's example with changes.
struct Answers(Vec<Option<f64>>);

impl Answers {
    fn of(changes: &[(&str, f64)]) -> Self {
        let mut inputs = model().preset("paper").expect("it is a preset");
        for (name, value) in changes {
            inputs[model().input(name).unwrap_or_else(|| panic!("{name} is an input"))] = *value;
        }
        let evaluation = evaluate(&model(), &inputs);
        assert_eq!(evaluation.status, Status::Ok, "{changes:?}");
        Self(evaluation.outputs)
    }

    fn get(&self, name: &str) -> f64 {
        self.0[model().output(name).unwrap_or_else(|| panic!("{name} is an output"))].unwrap_or_else(|| panic!("{name} has a value"))
    }
}

#[track_caller]
fn close(found: f64, expected: f64, percent: f64, what: &str) {
    let error = 100.0 * (found / expected - 1.0);
    assert!(error.abs() <= percent, "{what}: {found} for {expected}, {error:.3} %");
}

/// The word of an input.
fn word(input: &str, word: &str) -> f64 {
    let input = &model().inputs[model().input(input).expect("it is an input")];
    input.words.iter().find(|(name, _)| *name == word).expect("it is a word of the input").1
}

/// A sheet of the reference: 6 elements through it, harmonics to 48.
struct Reference {
    thickness: f64,
    largest: f64,
    theta: f64,
    points: [f64; 10],
    rim: f64,
    volume: f64,
}

const REFERENCES: [Reference; 3] = [
    Reference {
        thickness: 1.4,
        largest: 347.6,
        theta: 61.0,
        points: [26.5, 41.4, 78.09, 52.46, 54.34, 88.02, 293.7, 189.8, 338.4, 217.5],
        rim: 0.377_82,
        volume: 40_381.0,
    },
    Reference {
        thickness: 1.8,
        largest: 240.9,
        theta: 60.0,
        points: [20.6, 32.6, 50.71, 31.04, 33.24, 61.11, 199.2, 116.6, 233.6, 133.3],
        rim: 0.204_47,
        volume: 51_745.7,
    },
    Reference {
        thickness: 2.4,
        largest: 158.5,
        theta: 59.0,
        points: [17.9, 26.3, 30.74, 17.11, 18.15, 44.04, 130.7, 67.1, 153.3, 75.1],
        rim: 0.103_12,
        volume: 68_648.8,
    },
];

fn compare(accuracy: &str, largest: f64, hub: f64, points: f64) {
    for reference in &REFERENCES {
        let answers = Answers::of(&[("thickness_mm", reference.thickness), ("accuracy", word("accuracy", accuracy))]);
        let what = |name: &str| format!("{accuracy}, {} mm, {name}", reference.thickness);
        close(answers.get("max_stress_MPa"), reference.largest, largest, &what("largest"));
        let theta = answers.get("max_stress_theta_deg");
        assert!((theta - reference.theta).abs() < 3.0, "{}: {theta}", what("its angle"));
        let place = (answers.get("max_stress_z_mm") - 25.11).hypot(answers.get("max_stress_r_mm") - 53.07);
        assert!(place < 0.6, "{}: {place} mm off", what("its place"));
        for (number, (name, expected)) in CHECK_POINT_STRESSES.iter().zip(reference.points).enumerate() {
            // Bend B is near the bracket's edge: the reference itself has 1.5 % there.
            close(answers.get(name), expected, if number < 2 { hub } else { points }, &what(name));
        }
        close(answers.get("rim_displacement_mm"), reference.rim, 0.5, &what("rim"));
        close(answers.get("volume_mm3"), reference.volume, 0.1, &what("volume"));
    }
}

#[test]
fn pulley_at_usual_accuracy_is_within_two_percent_of_the_reference() {
    compare("usual", 2.0, 5.0, 2.0);
}

#[test]
fn pulley_at_fine_accuracy_is_within_half_a_percent_of_the_reference() {
    compare("fine", 0.5, 3.5, 1.0);
}

#[test]
fn pulley_friction_around_the_circumference_alone_is_the_heavier_case() {
    let around = ("friction_direction_deg", 0.0);
    let answers = Answers::of(&[around]);
    close(answers.get("max_stress_MPa"), 284.9, 2.0, "largest");
    close(answers.get("rim_displacement_mm"), 0.226_63, 0.5, "rim");
    let fine = Answers::of(&[around, ("accuracy", word("accuracy", "fine"))]);
    close(fine.get("max_stress_MPa"), 284.9, 0.5, "largest, fine");
    // The thinnest sheet of 1.4, 1.6, .. 2.4 mm below 270 MPa: 1.8 with the paper's friction, 2.0 with this.
    let safe = |thickness: f64, more: &[(&str, f64)]| {
        let safety = Answers::of(&[more, &[("thickness_mm", thickness)]].concat()).get("yield_safety");
        safety >= 1.0
    };
    assert_eq!([safe(1.6, &[]), safe(1.8, &[])], [false, true]);
    assert_eq!([safe(1.8, &[around]), safe(2.0, &[around])], [false, true]);
}

/// An audit's numbers, to the MPa.
#[test]
fn pulley_idling_is_the_worst_load_with_the_papers_friction_and_the_least_without() {
    let largest = |direction: f64, power: f64, more: &[(&str, f64)]| {
        // At 20 kW more friction is needed than there is: it shows the trend.
        let own = [("friction_direction_deg", direction), ("power_kW", power), ("friction_limit", 1.0)];
        Answers::of(&[&own, more].concat()).get("max_stress_MPa")
    };
    for (power, expected) in [(0.0, 250.0), (3.0, 242.0), (10.0, 221.0), (20.0, 168.0)] {
        assert!((largest(45.0, power, &[]) - expected).abs() <= 0.5, "{power} kW");
    }
    for (power, expected) in [(0.0, 250.0), (3.0, 286.0), (10.0, 378.0)] {
        assert!((largest(0.0, power, &[]) - expected).abs() <= 0.5, "{power} kW");
    }
    let fixed = [("tensioning", word("tensioning", "fixed-centres")), ("installed_tension_N", 700.0)];
    for more in [&[][..], &fixed] {
        let by_power = [0.0, 0.5, 2.0, 5.0, 9.0, 14.0].map(|power| largest(0.0, power, more));
        assert!(by_power.is_sorted() && by_power[5] > 1.05 * by_power[0], "{by_power:?}");
    }
    assert_eq!(largest(0.0, 0.0, &fixed), largest(0.0, 0.0, &[]), "at rest both laws have the same tensions");
}

/// The stress area of M6 is 20.1 mm^2 in ISO 898-1, whose class 8.8 has a proof load of 11 600 N.
#[test]
fn pulley_bolts_have_the_proof_load_of_the_standard() {
    let bolts = Answers::of(&[("clamp_force_N", 11_600.0), ("accuracy", word("accuracy", "usual"))]);
    close(bolts.get("bolt_utilisation"), 1.0, 0.6, "proof load");
    close(bolts.get("seat_pressure_MPa"), 11_600.0 / (std::f64::consts::FRAC_PI_4 * (144.0 - 43.56)), 1e-9, "pressure");
    // Four bolts on a circle of 45 mm, friction 0.15, against 9.549 N m.
    close(bolts.get("joint_slip_safety"), 4.0 * 11_600.0 * 0.15 * 0.0225 / 9.549_297, 1e-5, "slip of the joint");
    // An audit's case: 40 N m, 379 MPa under the heads.
    let tight = Answers::of(&[("clamp_force_N", word("clamp_force_N", "torque")), ("tightening_torque_Nm", 40.0)]);
    assert!((tight.get("seat_pressure_MPa") - 379.0).abs() < 0.5 && tight.get("bolt_utilisation") > 2.5);
    let notes = |torque: f64| {
        let mut inputs = model().defaults();
        for (name, value) in [("clamp_force_N", word("clamp_force_N", "torque")), ("tightening_torque_Nm", torque)] {
            inputs[model().input(name).expect("it is an input")] = value;
        }
        model().notes_on(&inputs, &evaluate(&model(), &inputs)).join("\n")
    };
    let said = notes(40.0);
    assert!(said.contains("press with 379 MPa, more than yield_strength_MPa 270"), "{said}");
    assert!(said.contains("tightened to 1484 MPa, more than bolt_proof_strength_MPa 580"), "{said}");
    let said = notes(10.0);
    assert!(!said.contains("press with") && !said.contains("tightened to"), "{said}");
}

const NO_CLAMP: (&str, f64) = ("clamp_force_N", 0.0);
const NO_SPIN: (&str, f64) = ("density_kg_per_m3", 0.0);
/// A belt with almost no tension.
const NO_BELT: [(&str, f64); 3] = [("power_kW", 0.0), ("slack_tension_N", 1e-9), ("belt_mass_kg_per_m", 1e-15)];

#[test]
fn pulley_belt_clamp_and_spin_have_their_parts() {
    let largest = |changes: &[&[(&str, f64)]]| Answers::of(&changes.concat());
    let belt = largest(&[&[NO_CLAMP, NO_SPIN]]);
    close(belt.get("max_stress_MPa"), 242.6, 1.5, "belt");
    // The largest stress of the clamp stands at the edge of what is left out, which the usual mesh is too coarse for.
    let clamp = largest(&[&NO_BELT, &[NO_SPIN, ("accuracy", word("accuracy", "fine"))]]);
    close(clamp.get("max_stress_MPa"), 20.0, 1.5, "clamp");
    assert!((clamp.get("max_stress_r_mm") - 30.4).abs() < 0.1, "{}", clamp.get("max_stress_r_mm"));
    let spin = largest(&[&NO_BELT, &[NO_CLAMP]]);
    close(spin.get("max_stress_MPa"), 3.1, 2.0, "spin");
}

#[test]
fn pulley_bolts_matter_at_the_hub_and_not_in_the_groove() {
    let angles = [0.0, 22.5, 45.0, 67.5].map(|angle| Answers::of(&[("bolt_angle_deg", angle)]));
    let range = |name: &str| {
        let values = angles.iter().map(|answers| answers.get(name));
        (values.clone().fold(f64::MAX, f64::min), values.fold(0.0, f64::max))
    };
    for name in ["max_stress_MPa", "stress_El_MPa", "stress_Fl_MPa"] {
        let (low, high) = range(name);
        close(high, low, 0.05, name);
    }
    let (low, high) = range("stress_Br_MPa");
    close(low, 31.4, 4.0, "least at Br");
    close(high, 35.6, 4.0, "largest at Br");
    // Another bolt in the place of the first changes nothing.
    let turned = Answers::of(&[("bolt_angle_deg", 112.5)]);
    for (name, value) in model().outputs.iter().zip(&turned.0) {
        let (a, b) = (angles[1].0[model().output(&name.name).expect("it is one")], *value);
        assert_eq!(a.is_some(), b.is_some(), "{}", name.name);
        if let (Some(a), Some(b)) = (a, b) {
            assert!((a - b).abs() <= 1e-9 * a.abs(), "{}: {a} {b}", name.name);
        }
    }
}

#[test]
fn pulley_stresses_grow_with_the_load_and_need_no_modulus() {
    let belt = [NO_CLAMP, NO_SPIN, ("belt_mass_kg_per_m", 1e-15)];
    let of = |scale: f64| Answers::of(&[&belt[..], &[("slack_tension_N", 700.0 * scale), ("power_kW", 3.0 * scale)]].concat());
    let (one, three) = (of(1.0), of(3.0));
    for name in CHECK_POINT_STRESSES.into_iter().chain(["max_stress_MPa", "rim_displacement_mm", "fatigue_amplitude_MPa"]) {
        close(three.get(name), 3.0 * one.get(name), 1e-7, name);
    }
    close(3.0 * three.get("yield_safety"), one.get("yield_safety"), 1e-7, "safety");
    close(three.get("max_stress_theta_deg"), one.get("max_stress_theta_deg"), 1e-7, "angle");
    let (steel, soft) = (Answers::of(&[]), Answers::of(&[("elastic_modulus_MPa", 68_666.666_666_666_67)]));
    for name in CHECK_POINT_STRESSES.into_iter().chain(["max_stress_MPa", "yield_safety", "fatigue_safety"]) {
        assert_eq!(steel.get(name), soft.get(name), "{name}");
    }
    close(soft.get("rim_displacement_mm"), 3.0 * steel.get("rim_displacement_mm"), 1e-9, "rim");
}
