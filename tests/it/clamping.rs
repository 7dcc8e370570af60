//! The variator with a clamping force: both pulleys may slip, the axial force has two bounds, speed and mass count. Properties that hold
//! for any belt; the numbers themselves are compared in `physics`.

use crate::physics::{Region, draw};
use crate::random::Random;
use beltspace::models::{Evaluation, Model, Status, evaluate, find};

const BELTS: [&str; 2] = ["rubber-cvt", "metal-cvt"];
const WORD: f64 = -1.0;

/// A belt by the names of its inputs.
#[derive(Clone)]
struct Belt<'m> {
    model: &'m Model,
    inputs: Vec<f64>,
    found: Evaluation,
}

impl<'m> Belt<'m> {
    fn new(model: &'m Model, inputs: Vec<f64>) -> Self {
        let found = evaluate(model, &inputs);
        Self { model, inputs, found }
    }

    fn with(&self, changes: &[(&str, f64)]) -> Self {
        let mut inputs = self.inputs.clone();
        for (name, value) in changes {
            inputs[self.model.input(name).expect("it is an input")] = *value;
        }
        Self::new(self.model, inputs)
    }

    fn input(&self, name: &str) -> f64 {
        self.inputs[self.model.input(name).expect("it is an input")]
    }

    fn output(&self, name: &str) -> Option<f64> {
        self.found.outputs[self.model.output(name).expect("it is an output")]
    }

    fn get(&self, name: &str) -> f64 {
        self.output(name).unwrap_or_else(|| panic!("no {name}: {} of {:?}", self.status(), self.inputs))
    }

    fn status(&self) -> String {
        self.found.status.reason(self.model).to_owned()
    }

    fn is_ok(&self) -> bool {
        self.found.status == Status::Ok
    }
}

/// Calls `check` with so many random belts that hold, at a clamping force.
fn for_clamped(seed: u64, check: impl Fn(&Belt<'_>, &mut Random)) {
    for name in BELTS {
        let model = find(name).expect("it is a model");
        let random = &mut Random::new(seed);
        let mut checked = 0;
        while checked < 500 {
            let belt = Belt::new(&model, draw(&model, Region::Usual, random));
            if belt.input("clamping_force_N") > 0.0 && belt.is_ok() && belt.input("torque_Nm") > 0.0 {
                checked += 1;
                check(&belt, random);
            }
        }
    }
}

fn close(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!((a - b).abs() <= tolerance * a.abs().max(b.abs()), "{what}: {a} and {b}");
}

#[test]
fn a_clamping_force_leaves_the_traction_that_needs_it() {
    for_clamped(1, |belt, _| {
        close(belt.get("driven_axial_force_N"), belt.input("clamping_force_N"), 1e-11, "the force given");
        let traction = belt.get("traction_used");
        // Given as a traction, it needs that force again, and everything else is the same.
        let again = belt.with(&[("clamping_force_N", WORD), ("traction", traction)]);
        assert!(again.is_ok(), "{}", again.status());
        for output in &belt.model.outputs {
            let (one, other) = (belt.output(&output.name), again.output(&output.name));
            let (Some(one), Some(other)) = (one, other) else {
                assert_eq!(one, other, "{}", output.name);
                continue;
            };
            // What is left of one where nearly all is used.
            let scale =
                if output.name.ends_with("_margin") || output.name == "entry_compression" { 1.0_f64.max(one.abs()) } else { one.abs() };
            assert!((one - other).abs() <= 1e-7 * scale, "{}: {one} and {other}", output.name);
        }
    });
}

#[test]
fn more_clamping_grips_better_more_torque_and_less_friction_worse() {
    for_clamped(2, |belt, random| {
        let more = 1.0 + random.unit();
        let better = |one: &Belt<'_>, other: &Belt<'_>| {
            // A belt that slips grips worst.
            let margin = |belt: &Belt<'_>| if belt.is_ok() { belt.get("slip_margin") } else { f64::NEG_INFINITY };
            assert!(margin(one) >= margin(other), "{} and {}: {:?}", margin(one), margin(other), belt.inputs);
            assert!(one.get("clamping_utilisation") <= other.get("clamping_utilisation"));
        };
        let clamped = belt.with(&[("clamping_force_N", more * belt.input("clamping_force_N"))]);
        better(&clamped, belt);
        close(clamped.get("clamping_safety"), more * belt.get("clamping_safety"), 1e-12, "safety grows as the force");
        better(belt, &belt.with(&[("torque_Nm", more * belt.input("torque_Nm"))]));
        let rough = belt.with(&[("friction", more * belt.input("friction"))]);
        if rough.status() != "friction beyond the wedge" {
            better(&rough, belt);
        }
        // More friction never asks for more force at one traction.
        let given = belt.with(&[("clamping_force_N", WORD), ("traction", belt.get("traction_used"))]);
        let rough = given.with(&[("friction", more * belt.input("friction"))]);
        if rough.is_ok() {
            for name in ["driver_axial_force_N", "driven_axial_force_N", "driven_axial_force_upper_N"] {
                assert!(rough.get(name) <= given.get(name) * (1.0 + 1e-12), "{name}: {:?}", belt.inputs);
            }
        }
    });
}

#[test]
fn at_the_slip_force_the_belt_slips_and_hardly_above_it_holds() {
    for_clamped(3, |belt, _| {
        let slip = belt.input("clamping_force_N") * belt.get("clamping_utilisation");
        let below = belt.with(&[("clamping_force_N", slip * (1.0 - 1e-9))]);
        assert_eq!(below.status(), "slip on the driven pulley");
        assert!(below.get("clamping_safety") < 1.0 && below.output("traction_used").is_none() && below.output("slip_margin").is_none());
        let above = belt.with(&[("clamping_force_N", slip * (1.0 + 1e-9))]);
        if belt.get("driven_traction_limit") <= belt.get("driver_traction_limit") {
            assert_eq!(above.status(), "ok");
            close(above.get("traction_used"), belt.get("driven_traction_limit"), 1e-3, "just holding");
        } else {
            assert_eq!(above.status(), "slip on the driver", "the driver has slipped long before");
            assert!(above.get("slip_margin") < 0.0);
        }
    });
}

#[test]
fn without_a_torque_any_force_holds_and_a_small_torque_comes_close_to_none() {
    for_clamped(4, |belt, _| {
        let none = belt.with(&[("torque_Nm", 0.0)]);
        assert_eq!((none.status().as_str(), none.output("clamping_safety")), ("ok", None));
        let expected = [("traction_used", 0.0), ("clamping_utilisation", 0.0), ("slip_margin", 1.0), ("belt_force_N", 0.0)];
        assert!(expected.iter().all(|(name, value)| none.get(name) == *value), "{:?}", belt.inputs);
        assert_eq!(none.get("tight_force_N"), none.get("slack_force_N"));
        // F1 = F2 = 2 S/(wrap k).
        let tan = (none.input("groove_angle_deg").to_radians() / 2.0).tan();
        let wedge = (1.0 - none.input("friction") * tan) / (none.input("friction") + tan);
        let force = 2.0 * none.input("clamping_force_N") / (none.get("driven_wrap_deg").to_radians() * wedge);
        close(none.get("tight_force_N"), force, 1e-12, "force of a belt at rest");
        let little = belt.with(&[("torque_Nm", 1e-9 * belt.input("torque_Nm"))]);
        for name in ["tight_force_N", "slack_force_N", "driver_axial_force_N", "axial_force_upper_N", "max_stress_MPa", "thrust_ratio"] {
            close(little.get(name), none.get(name), 1e-6, name);
        }
    });
}

#[test]
fn the_upper_bound_is_above_and_meets_the_lower_one_without_friction_along_the_radius() {
    for_clamped(5, |belt, _| {
        for pulley in ["driver_axial_force", "driven_axial_force", "axial_force"] {
            let (lower, upper) = (belt.get(&format!("{pulley}_N")), belt.get(&format!("{pulley}_upper_N")));
            assert!(upper >= lower * (1.0 - 1e-12), "{pulley}: {lower} and {upper}");
        }
        // With hardly any friction there is hardly any support: both are the same, for the traction that is then possible.
        let slippery = belt.with(&[("clamping_force_N", WORD), ("traction", WORD), ("friction", 1e-7)]);
        assert!(slippery.is_ok(), "{}", slippery.status());
        close(slippery.get("driver_axial_force_upper_N"), slippery.get("driver_axial_force_N"), 1e-5, "driver");
        close(slippery.get("driven_axial_force_upper_N"), slippery.get("driven_axial_force_N"), 1e-5, "driven");
    });
}

#[test]
fn the_pulleys_change_places_where_the_ratio_is_turned_over() {
    for_clamped(6, |belt, _| {
        let turned = belt.with(&[("ratio", 1.0 / belt.input("ratio")), ("clamping_force_N", WORD), ("traction", WORD)]);
        for (one, other) in [
            ("driver_radius_mm", "driven_radius_mm"),
            ("driven_traction_limit", "driver_traction_limit"),
            ("driver_traction_limit", "driven_traction_limit"),
            ("traction_limit", "traction_limit"),
            ("bending_stress_MPa", "bending_stress_MPa"),
        ] {
            close(belt.get(one), turned.get(other), 1e-10, one);
        }
        // A traction between the two limits slips on the driver where it is the smaller pulley, else on the driven one.
        let (driver, driven) = (belt.get("driver_traction_limit"), belt.get("driven_traction_limit"));
        if (driver - driven).abs() > 1e-6 {
            let between = belt.with(&[("clamping_force_N", WORD), ("traction", 0.5 * (driver + driven))]);
            let expected = if driver < driven { "slip on the driver" } else { "slip on the driven pulley" };
            assert_eq!(between.status(), expected);
            assert!(between.get("slip_margin") < 0.0);
        }
    });
}

#[test]
fn speed_and_mass_load_the_belt_and_not_the_pulleys() {
    for_clamped(7, |belt, random| {
        let still = belt.with(&[("driver_speed_rpm", 0.0)]);
        let speed = random.between(500.0, 6000.0);
        let fast = belt.with(&[("driver_speed_rpm", speed), ("belt_mass_kg_per_m", random.between(0.1, 1.5))]);
        for name in ["driver_axial_force_N", "axial_force_upper_N", "tight_force_N", "slip_margin", "clamping_safety", "bending_stress_MPa"]
        {
            assert_eq!(still.get(name).to_bits(), fast.get(name).to_bits(), "{name}");
        }
        let v = fast.get("driver_radius_mm") / 1000.0 * speed * std::f64::consts::TAU / 60.0;
        close(fast.get("belt_speed_m_per_s"), v, 1e-12, "speed");
        let force = fast.input("belt_mass_kg_per_m") * v * v;
        close(fast.get("centrifugal_force_N"), force, 1e-12, "m v^2");
        close(fast.get("power_kW"), fast.input("torque_Nm") * speed * std::f64::consts::TAU / 60_000.0, 1e-12, "power");
        // The stress grows by m v^2/A, and the capacity falls by what carries it.
        let area = still.get("tight_force_N") / still.get("tensile_stress_MPa");
        assert!(
            (fast.get("tensile_stress_MPa") - still.get("tensile_stress_MPa") - force / area).abs() < 1e-9 * fast.get("tensile_stress_MPa")
        );
        let traction = fast.get("traction_used");
        let lost = force * 2.0 * traction / (1.0 + traction) * fast.get("driver_radius_mm") / 1000.0;
        let (before, after) = (still.get("torque_capacity_Nm"), fast.get("torque_capacity_Nm"));
        let expected = (before - lost).max(0.0);
        assert!(before == 0.0 || (after - expected).abs() <= 1e-9 * before, "{before} less {lost} is {after}");
    });
}

#[test]
fn a_belt_that_is_soft_in_bending_is_bent_by_its_own_modulus() {
    let model = find("rubber-cvt").expect("it is a model");
    let belt = Belt::new(&model, model.preset("cogged-variable-speed").expect("it is a preset"));
    let stiff = belt.with(&[("bending_modulus_MPa", WORD)]);
    assert_eq!(stiff.get("bending_stress_MPa"), belt.with(&[("bending_modulus_MPa", 600.0)]).get("bending_stress_MPa"));
    close(stiff.get("bending_stress_MPa"), 10.0 * belt.get("bending_stress_MPa"), 1e-12, "600 and 60 MPa");
    assert_eq!(stiff.get("tensile_stress_MPa"), belt.get("tensile_stress_MPa"));
    // One modulus refuses the belt of every scooter at its smallest radius; its own does not.
    let launch = [("ratio", 2.6), ("torque_Nm", 15.0)];
    assert!(stiff.with(&launch).get("stress_margin") < 0.0 && belt.with(&launch).get("stress_margin") > 0.3);
    // Half the pressure on twice the height.
    let tall = belt.with(&[("belt_thickness_mm", 18.0)]);
    close(belt.get("flank_pressure_MPa"), 2.0 * tall.get("flank_pressure_MPa"), 1e-12, "pressure");
}
