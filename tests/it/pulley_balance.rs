//! The loads on a V-belt pulley, added up as vectors: they must balance the two strands and carry the torque.

use crate::random::Random;
use beltspace::models::{Model, Status, evaluate, find};
use std::f64::consts::PI;
use std::sync::Arc;

struct Pulley {
    model: Arc<Model>,
    inputs: Vec<f64>,
    outputs: Vec<Option<f64>>,
}

impl Pulley {
    fn new(inputs: Vec<f64>) -> Option<Self> {
        let model = find("pulley-load").expect("it is a model");
        let evaluation = evaluate(&model, &inputs);
        (evaluation.status == Status::Ok).then_some(Self { model, inputs, outputs: evaluation.outputs })
    }

    fn with(&self, name: &str, value: f64) -> Option<Self> {
        let mut inputs = self.inputs.clone();
        inputs[self.model.input(name).expect("it is an input")] = value;
        Self::new(inputs)
    }

    fn get(&self, name: &str) -> f64 {
        match self.model.input(name) {
            Some(input) => self.inputs[input],
            None => self.outputs[self.model.output(name).expect("it is an output")].expect("status ok has every output"),
        }
    }

    /// Force vector and torque (N, N mm) of flank pressure and friction over the wrap. The slack end is at angle 0 on the x axis,
    /// the tight end at the wrap angle. `inwards` is the share of the flank friction that points to the axis.
    fn loads(&self, inwards: f64) -> ([f64; 2], f64) {
        let wrap = self.get("wrap_angle_deg").to_radians();
        let radius = self.get("mean_radius_mm");
        let half = (self.get("groove_angle_deg") / 2.0).to_radians();
        let direction = self.get("friction_direction_deg").to_radians();
        let friction = self.get("friction_used");
        let flanks = 2.0 * self.get("groove_count");
        let (start, end) = (self.get("slack_end_flank_force_N_per_mm"), self.get("tight_end_flank_force_N_per_mm"));
        let growth = (end / start).ln() / wrap;
        let steps = 400;
        let (mut force, mut torque) = ([0.0; 2], 0.0);
        // Simpson's rule over the wrap.
        for step in 0..=steps {
            let weight = if step == 0 || step == steps {
                1.0
            } else if step % 2 == 1 {
                4.0
            } else {
                2.0
            };
            let length = weight * wrap / f64::from(steps) / 3.0 * radius;
            let angle = wrap * f64::from(step) / f64::from(steps);
            let normal = flanks * start * (growth * angle).exp();
            let to_axis = normal * (half.sin() + friction * direction.sin() * inwards);
            let to_tight_end = normal * friction * direction.cos();
            force[0] += length * (-to_axis * angle.cos() - to_tight_end * angle.sin());
            force[1] += length * (-to_axis * angle.sin() + to_tight_end * angle.cos());
            torque += length * radius * to_tight_end;
        }
        (force, torque)
    }

    /// The pull of the two strands, without the tension that only bends the moving belt.
    fn strands(&self) -> [f64; 2] {
        let wrap = self.get("wrap_angle_deg").to_radians();
        let slack = self.get("slack_tension_used_N") - self.get("centrifugal_tension_N");
        let tight = self.get("tight_tension_N") - self.get("centrifugal_tension_N");
        [-tight * wrap.sin(), tight * wrap.cos() - slack]
    }

    fn cosine(&self) -> f64 {
        (self.get("groove_angle_deg") / 2.0).to_radians().cos()
    }
}

fn pulleys(seed: u64) -> impl Iterator<Item = Pulley> {
    let model = find("pulley-load").expect("it is a model");
    let mut random = Random::new(seed);
    let inputs = move || -> Vec<f64> {
        let value = |input: &beltspace::models::Input| {
            let value = random.between(input.usual.0, input.usual.1);
            match &input.words[..] {
                [] if input.integer => value.round(),
                [] => value,
                words => random.word(words),
            }
        };
        model.inputs.iter().map(value).collect()
    };
    std::iter::repeat_with(inputs).filter_map(Pulley::new).take(2000)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[test]
fn flank_pressure_and_friction_add_up_to_the_pull_of_the_strands_and_the_torque() {
    for pulley in pulleys(1) {
        let (force, torque) = pulley.loads(pulley.cosine());
        let strands = pulley.strands();
        let size = strands[0].hypot(strands[1]);
        let scale = pulley.get("tight_tension_N");
        assert!(distance(force, strands) < 1e-7 * scale, "{force:?} {strands:?} {:?}", pulley.inputs);
        assert!((size - pulley.get("resultant_force_N")).abs() < 1e-9 * scale, "{:?}", pulley.inputs);
        let expected = 1000.0 * pulley.get("torque_Nm");
        assert!((torque - expected).abs() < 1e-7 * expected.max(1.0), "{torque} {expected} {:?}", pulley.inputs);
    }
}

#[test]
fn friction_along_the_flank_taken_as_radial_does_not_balance() {
    let model = find("pulley-load").expect("it is a model");
    let example = Pulley::new(model.preset("paper").expect("it is a preset")).expect("the paper's example has a meaning");
    let strands = example.strands();
    let radial = example.loads(1.0).0;
    let off = radial[0].hypot(radial[1]) / strands[0].hypot(strands[1]) - 1.0;
    // The paper's words taken literally: two thirds of a percent off in its example.
    assert!((off - 0.0067).abs() < 2e-4, "{off}");
}

#[test]
fn power_is_torque_times_speed() {
    for pulley in pulleys(2) {
        let omega = pulley.get("speed_rpm") * 2.0 * PI / 60.0;
        let power = pulley.get("torque_Nm") * omega / 1000.0;
        assert!((power - pulley.get("power_kW")).abs() < 1e-13 * power, "{:?}", pulley.inputs);
        let tight = pulley.get("slack_tension_used_N") + pulley.get("effective_tension_N");
        assert!((tight - pulley.get("tight_tension_N")).abs() < 1e-12 * tight, "{:?}", pulley.inputs);
        let belt = pulley.get("effective_tension_N") * pulley.get("belt_speed_m_per_s") / 1000.0;
        assert!((belt - power).abs() < 1e-13 * power, "{:?}", pulley.inputs);
    }
}

#[test]
fn the_direction_of_friction_has_the_two_known_members() {
    let mut both = 0;
    for pulley in pulleys(3) {
        let half = (pulley.get("groove_angle_deg") / 2.0).to_radians();
        let needed = pulley.get("effective_friction");
        if let Some(around) = pulley.with("friction_direction_deg", 0.0) {
            // The usual V-belt: mu' = mu / sin(beta/2).
            assert!((around.get("friction_used") / half.sin() - needed).abs() < 1e-13 * needed, "{:?}", pulley.inputs);
        }
        if let Some(paper) = pulley.with("friction_direction_deg", 45.0) {
            // (12), the paper's mu both ways: the total is sqrt(2) times it.
            let mu = needed * half.sin() / (1.0 - needed * half.cos());
            assert!((paper.get("friction_used") - 2f64.sqrt() * mu).abs() < 1e-11 * mu, "{:?}", pulley.inputs);
            let line = paper.get("slack_end_line_force_N_per_mm");
            let flank = line / (2.0 * paper.get("groove_count") * (half.sin() + mu * half.cos()));
            assert!((flank - paper.get("slack_end_flank_force_N_per_mm")).abs() < 1e-11 * flank, "{:?}", pulley.inputs);
            both += 1;
        }
    }
    assert!(both > 1000, "{both}");
}

#[test]
fn tension_and_loads_grow_along_the_wrap_as_the_profile_says() {
    let model = find("pulley-load").expect("it is a model");
    for pulley in pulleys(4).take(200) {
        let profile = model.along_the_belt(&pulley.inputs).expect("the model has a profile");
        let column = |name: &str| profile.columns.iter().position(|it| it.name == name).expect("it is a column");
        let (first, last) = (&profile.rows[0], &profile.rows[profile.rows.len() - 1]);
        let ends = [
            (first, "tension_N", pulley.get("slack_tension_used_N")),
            (last, "tension_N", pulley.get("tight_tension_N")),
            (first, "line_force_N_per_mm", pulley.get("slack_end_line_force_N_per_mm")),
            (last, "line_force_N_per_mm", pulley.get("tight_end_line_force_N_per_mm")),
            (first, "flank_force_N_per_mm", pulley.get("slack_end_flank_force_N_per_mm")),
            (last, "flank_force_N_per_mm", pulley.get("tight_end_flank_force_N_per_mm")),
        ];
        for (row, name, expected) in ends {
            assert!((row[column(name)] - expected).abs() < 1e-11 * expected, "{name}: {:?}", pulley.inputs);
        }
        assert_eq!((first[0], last[0]), (0.0, pulley.get("wrap_angle_deg")));
        // Euler: the pressing tension grows by the same factor from row to row.
        let pressing = |row: &Vec<f64>| row[column("tension_N")] - pulley.get("centrifugal_tension_N");
        let factor = pressing(&profile.rows[1]) / pressing(first);
        for pair in profile.rows.windows(2) {
            assert!((pressing(&pair[1]) / pressing(&pair[0]) - factor).abs() < 1e-9, "{:?}", pulley.inputs);
        }
    }
}

/// Outputs of random pulleys as they come and with changes to their inputs: a status other than ok gives `None`.
fn changed(pulley: &Pulley, changes: &[(&str, f64)]) -> Option<Pulley> {
    let mut inputs = pulley.inputs.clone();
    for (name, value) in changes {
        inputs[pulley.model.input(name).expect("it is an input")] = *value;
    }
    Pulley::new(inputs)
}

const FIXED_CENTRES: f64 = 2.0;

#[test]
fn between_fixed_centres_the_tensions_add_up_to_twice_the_installed_one() {
    let mut fixed = 0;
    for pulley in pulleys(5).filter(|pulley| pulley.get("tensioning") == FIXED_CENTRES) {
        let [slack, tight, installed] = ["slack_tension_used_N", "tight_tension_N", "installed_tension_N"].map(|name| pulley.get(name));
        assert!((slack + tight - 2.0 * installed).abs() < 1e-12 * installed, "{:?}", pulley.inputs);
        // What is not read changes nothing.
        let other = pulley.with("slack_tension_N", 1.7 * pulley.get("slack_tension_N")).expect("it is the same");
        assert_eq!(other.outputs, pulley.outputs);
        // The same tension of the slack side, given.
        let given = changed(&pulley, &[("tensioning", 1.0), ("slack_tension_N", slack)]).expect("the same belt grips");
        for (output, (one, other)) in pulley.outputs.iter().zip(&given.outputs).enumerate() {
            let (one, other) = (one.expect("status ok"), other.expect("status ok"));
            assert!((one - other).abs() <= 1e-11 * one.abs().max(1e-3), "{}: {one} {other}", pulley.model.outputs[output].name);
        }
        fixed += 1;
    }
    assert!(fixed > 300, "{fixed}");
}

#[test]
fn a_belt_that_carries_nothing_has_one_tension_by_either_law() {
    for pulley in pulleys(6).take(500) {
        let tension = pulley.get("slack_tension_used_N");
        let idle = |law: f64, power: f64| {
            let own = [("tensioning", law), ("power_kW", power), ("slack_tension_N", tension), ("installed_tension_N", tension)];
            changed(&pulley, &own).expect("it grips without load")
        };
        let (slack, fixed) = (idle(1.0, 0.0), idle(FIXED_CENTRES, 0.0));
        assert_eq!(slack.outputs, fixed.outputs);
        assert_eq!((slack.get("friction_margin"), slack.get("tight_tension_N")), (1.0, tension));
        // The limit is no jump.
        for law in [1.0, FIXED_CENTRES] {
            let nearly = idle(law, 1e-9);
            assert!((nearly.get("resultant_force_N") / slack.get("resultant_force_N") - 1.0).abs() < 1e-6);
            assert!((nearly.get("friction_margin") - 1.0).abs() < 1e-6);
        }
        // Nor is the mass of a belt that weighs nothing: all of its tension presses.
        let light = changed(&pulley, &[("belt_mass_kg_per_m", 1e-12)]).expect("it presses harder");
        let pressed = light.get("slack_tension_used_N") / light.get("mean_radius_mm");
        assert!((light.get("slack_end_line_force_N_per_mm") / pressed - 1.0).abs() < 1e-6, "{:?}", light.inputs);
    }
}

#[test]
fn along_the_circumference_more_power_never_presses_less() {
    let mut seen = [0; 2];
    for pulley in pulleys(7).filter_map(|pulley| pulley.with("friction_direction_deg", 0.0)) {
        let Some(more) = pulley.with("power_kW", 1.1 * pulley.get("power_kW")) else { continue };
        let end = "tight_end_flank_force_N_per_mm";
        assert!(more.get(end) > pulley.get(end) && more.get("friction_used") > pulley.get("friction_used"), "{:?}", pulley.inputs);
        let start = "slack_end_flank_force_N_per_mm";
        let fixed = pulley.get("tensioning") == FIXED_CENTRES;
        assert!(if fixed { more.get(start) < pulley.get(start) } else { more.get(start) == pulley.get(start) }, "{:?}", pulley.inputs);
        seen[usize::from(fixed)] += 1;
    }
    assert!(seen.iter().all(|&count| count > 300), "{seen:?}");
    // With the paper's direction the slack end is pressed the less the more the belt transmits.
    let paper = find("pulley-load").expect("it is a model").preset("paper").expect("it is a preset");
    let [idle, loaded] = [0.0, 3.0].map(|power| Pulley::new(paper.clone()).and_then(|it| it.with("power_kW", power)).expect("it grips"));
    assert!(loaded.get("slack_end_flank_force_N_per_mm") < 0.9 * idle.get("slack_end_flank_force_N_per_mm"));
}

#[test]
fn a_belt_slips_where_it_needs_more_friction_than_there_is() {
    let model = find("pulley-load").expect("it is a model");
    for pulley in pulleys(8).take(300) {
        let used = pulley.get("friction_used");
        let status = |limit: f64| {
            let mut inputs = pulley.inputs.clone();
            inputs[model.input("friction_limit").expect("it is an input")] = limit;
            evaluate(&model, &inputs).status.reason(&model).to_owned()
        };
        assert_eq!([status(used * (1.0 + 1e-9)), status(used * (1.0 - 1e-9))], ["ok", "slip"], "{:?}", pulley.inputs);
    }
}
