//! The models compared with their second implementation and with the numbers that the papers print.

use crate::effort::is_slow;
use crate::random::Random;
use crate::second::{GOLDEN, Golden, SECOND, Values, timing_belt, timing_data};
use beltspace::models::{self, Evaluation, Input, Model, Set, Status, evaluate, find};
use beltspace::tape::Known;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

/// Inputs by name, as the second implementation takes them: a word beside numbers is the absence of one, and words alone are numbered.
fn by_name(model: &Model, inputs: &[f64]) -> BTreeMap<String, f64> {
    let numbers = model.inputs.iter().zip(inputs).filter(|(input, value)| input.is_enumeration() || input.word_for(**value).is_none());
    numbers.map(|(input, &value)| (input.name.to_owned(), value)).collect()
}

fn second(model: &Model, inputs: &[f64]) -> (&'static str, Values) {
    let (_, implementation) = SECOND.iter().find(|(name, _)| *name == model.name).expect("a formula has a second implementation");
    implementation(&by_name(model, inputs))
}

/// Does the status change where one input does by so little?
fn changes_nearby(model: &Model, inputs: &[f64], by: f64) -> bool {
    let status = second(model, inputs).0;
    let changes = |(input, factor): (usize, f64)| {
        let mut other = inputs.to_vec();
        other[input] *= factor;
        second(model, &other).0 != status
    };
    (0..inputs.len()).flat_map(|input| [(input, 1.0 - by), (input, 1.0 + by)]).any(changes)
}

/// Smallest relative distance of these inputs to a point where the status changes.
fn distance_to_boundary(model: &Model, inputs: &[f64]) -> f64 {
    let get = |name: &str| inputs[model.input(name).expect("it is an input")];
    let relative = |margin: f64, scale: f64| (margin / scale).abs();
    if model.name == "timing-belt" {
        let (force, margins) = timing_belt::margins(&by_name(model, inputs));
        let space = get("space_half_angle_deg");
        let lift = get("lift_angle_deg");
        let of_lift = if lift == space || lift < 0.0 { 1.0 } else { relative(space - lift, space) };
        // A draw that goes exactly once around the pulley, or hardly more or less.
        let pitches = get("teeth_in_mesh") * 2.0 * (get("land_half_angle_deg") + space);
        let of_teeth = margins.iter().map(|margin| relative(*margin, force.max(1e-3 * get("tight_tension_N"))));
        return of_teeth
            .chain([
                of_lift,
                relative(pitches - 360.0, 360.0),
                relative(get("tight_tension_N") - get("slack_tension_N"), get("tight_tension_N")),
            ])
            .fold(1.0, f64::min);
    }
    if model.name != "pulley-load" && model.input("ratio").is_none() {
        return if changes_nearby(model, inputs, 1e-8) { 0.0 } else { 1.0 };
    }
    let half_groove = (get("groove_angle_deg") / 2.0).to_radians();
    let values = second(model, inputs).1;
    let mut distance = f64::INFINITY;
    if model.name == "pulley-load" {
        let speed = get("speed_rpm") * PI / 30.0 * get("mean_radius_mm") / 1000.0;
        let fixed = get("tensioning") == 2.0;
        let tension = if fixed { get("installed_tension_N") } else { get("slack_tension_N") };
        let slack = if fixed { tension - 500.0 * get("power_kW") / speed } else { tension };
        distance = distance.min(relative(slack - get("belt_mass_kg_per_m") * speed * speed, tension));
        distance = distance.min(values.get("friction_margin").map_or(1.0, |margin| margin.abs()));
        let direction = get("friction_direction_deg").to_radians();
        if let Some(friction) = values.get("effective_friction") {
            distance = distance.min(relative(direction.cos() - friction * direction.sin() * half_groove.cos(), direction.cos()));
        }
        return distance;
    }
    let (length, centre, ratio) = (get("belt_length_mm"), get("centre_distance_mm"), get("ratio"));
    distance = distance.min(relative(length - 2.0 * centre, length));
    distance = distance.min(relative(2.0 * PI * centre * ratio.max(1.0) - length * (ratio - 1.0).abs(), length));
    distance = distance.min(relative(get("friction") * half_groove.tan() - 1.0, 1.0));
    if let Some(driver) = values.get("driver_radius_mm") {
        distance = distance.min(relative(centre - driver * (1.0 + ratio), centre));
    }
    let [clamping, traction] = ["clamping_force_N", "traction"].map(get);
    if clamping >= 0.0 {
        // At the slip force the utilisation is 1, whether the belt holds or not.
        distance = values.get("clamping_utilisation").map_or(distance, |used| distance.min(relative(1.0 - used, 1.0)));
    }
    let used = if clamping >= 0.0 { values.get("traction_used").copied() } else { Some(traction).filter(|it| *it >= 0.0) };
    for limit in ["driven_traction_limit", "driver_traction_limit"] {
        if let (Some(limit), Some(used)) = (values.get(limit), used) {
            distance = distance.min(relative(limit - used, *limit));
        }
    }
    distance
}

/// Which inputs to draw.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Region {
    /// Over the usual ranges.
    Usual,
    /// Well beyond them, where the formula still has a meaning.
    Wide,
    /// Usual, but several inputs at a value where something changes.
    Edges,
}

/// Random inputs. Three of four belts are given a length that closes around their pulleys.
///
/// Of a model that is slow and has presets it is one of those, changed a little where the first stage reads it: dimensions at random
/// make no section.
pub fn draw(model: &Model, region: Region, random: &mut Random) -> Vec<f64> {
    if is_slow(model) {
        return near_a_preset(model, region, random);
    }
    let mut inputs: Vec<f64> = Vec::new();
    for input in &model.inputs {
        let (low, high) = input.usual;
        let (low, high) = match (region, input.name.as_str()) {
            (Region::Wide, "groove_angle_deg") => (2.0, 170.0),
            (Region::Wide, "traction") => (0.001, 0.999),
            (Region::Wide, "wrap_angle_deg") => (1.0, 359.0),
            (Region::Wide, "friction_direction_deg") => (0.0, 89.0),
            (Region::Wide, "band_count" | "groove_count") => (1.0, 40.0),
            (Region::Wide, "land_half_angle_deg" | "space_half_angle_deg" | "lift_angle_deg") => (0.01, 29.0),
            (Region::Wide, "pressure_angle_deg") => (0.0, 44.0),
            (Region::Wide, "tight_span_angle_deg" | "slack_span_angle_deg") => (0.0, 59.0),
            (Region::Wide, "teeth_in_mesh" | "centrifugal_land_friction") => (low, high),
            (Region::Wide, _) => (low / 5.0, high * 5.0),
            _ => (low, high),
        };
        let mut value = if low > 0.0 { random.log_between(low, high) } else { random.between(low, high) };
        if input.integer {
            value = value.round();
        }
        let of_words = if input.instead_of.is_some() { 0.5 } else { 0.3 };
        if !input.words.is_empty() && (input.is_enumeration() || random.chance(of_words)) {
            value = random.word(&input.words);
        }
        inputs.push(value);
    }
    if let (Some(lift), true) = (model.input("lift_angle_deg"), random.chance(0.8)) {
        // Most lifted teeth stay in their space.
        let space = inputs[model.input("space_half_angle_deg").expect("it has a space")];
        let part = space * random.unit();
        inputs[lift] = random.pick(&[-1.0, 0.0, part]);
    }
    if model.name == "timing-belt" && random.chance(0.9) {
        fit_around_the_pulley(model, &mut inputs, random);
    }
    if let (Some(length), true) = (model.input("belt_length_mm"), random.chance(0.75)) {
        close_the_belt(model, length, &mut inputs, random);
    }
    if let (Some(installed), true) = (model.input("installed_tension_N"), random.chance(0.5)) {
        tighten_the_belt(model, installed, &mut inputs, random);
    }
    if region == Region::Edges {
        for _ in 0..2 {
            put_on_an_edge(model, &mut inputs, random);
        }
    }
    inputs
}

/// Inputs that what is prepared depends on, as far as the model can say without their values.
pub fn slow_inputs(model: &Model) -> Set {
    let least = |table: &Input| table.words.iter().fold(0.0, |least: f64, (_, word)| word.min(least));
    let inputs: Vec<Known> = model.inputs.iter().map(|table| Known::Within(least(table), 1e9)).collect();
    model.kernel.dependencies(&inputs).prepared
}

/// Presets whose first stage takes no longer than the model says. A solid section takes a hundred times as long: it is tried where
/// each input is changed in turn.
fn quick_presets(model: &Model) -> impl Iterator<Item = &str> {
    model.presets.iter().map(|it| it.name.as_str()).filter(|name| *name != "machined")
}

fn near_a_preset(model: &Model, region: Region, random: &mut Random) -> Vec<f64> {
    let presets: Vec<_> = quick_presets(model).collect();
    let mut inputs = model.preset(random.pick(&presets)).expect("it is one of them");
    let slow = slow_inputs(model);
    let part = if region == Region::Wide { 0.05 } else { 0.005 };
    for (number, (value, input)) in inputs.iter_mut().zip(&model.inputs).enumerate() {
        let of_section = slow.contains(number);
        if input.is_enumeration() || (of_section && input.integer) {
            continue;
        }
        let (low, high) = input.usual;
        *value = match of_section {
            true => *value * (1.0 + random.between(-part, part)),
            false if !input.words.is_empty() && random.chance(0.3) => random.word(&input.words),
            false if low > 0.0 => random.log_between(low, high),
            false => random.between(low, high),
        };
    }
    inputs
}

/// Chooses tensions that go with what the belt pulls and weighs.
fn tighten_the_belt(model: &Model, installed: usize, inputs: &mut [f64], random: &mut Random) {
    let get = |name: &str| inputs[model.input(name).expect("it is an input")];
    let speed = get("speed_rpm") * PI / 30.0 * get("mean_radius_mm") / 1000.0;
    let needed = get("belt_mass_kg_per_m") * speed * speed + 1000.0 * get("power_kW") / speed;
    for tension in [installed, model.input("slack_tension_N").expect("it is an input")] {
        inputs[tension] = needed * random.log_between(0.8, 20.0);
    }
}

/// Chooses a driver radius for the belt and the length that goes with it.
fn close_the_belt(model: &Model, length: usize, inputs: &mut [f64], random: &mut Random) {
    let get = |name: &str| inputs[model.input(name).expect("it is an input")];
    let (centre, ratio) = (get("centre_distance_mm"), get("ratio"));
    let driver = centre / (1.0 + ratio) * random.between(0.05, 0.99);
    let lean = ((ratio - 1.0) * driver / centre).asin();
    inputs[length] = 2.0 * centre * lean.cos() + PI * (1.0 + ratio) * driver + 2.0 * lean * (ratio - 1.0) * driver;
}

/// Leaves as many lands and spaces, in their proportion, on the pulley as teeth are in mesh, or more.
fn fit_around_the_pulley(model: &Model, inputs: &mut [f64], random: &mut Random) {
    let [teeth, land, space, lift] = ["teeth_in_mesh", "land_half_angle_deg", "space_half_angle_deg", "lift_angle_deg"]
        .map(|name| model.input(name).expect("it is an input"));
    let wrap = 2.0 * inputs[teeth] * (inputs[land] + inputs[space]);
    if wrap > 359.0 {
        let scale = random.between(120.0, 359.0) / wrap;
        inputs[land] *= scale;
        inputs[space] *= scale;
        if inputs[lift] > 0.0 {
            inputs[lift] *= scale;
        }
    }
}

fn put_on_an_edge(model: &Model, inputs: &mut [f64], random: &mut Random) {
    let at = random.below(model.inputs.len());
    let near = [0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, -1e-9];
    match model.inputs[at].name.as_str() {
        "ratio" => inputs[at] = 1.0 + random.pick(&near),
        "clamping_force_N" => {
            // The force at which the driven pulley slips, and hardly more.
            let used = second(model, inputs).1.get("clamping_utilisation").copied().filter(|it| *it > 0.0);
            if let (Some(used), true) = (used, inputs[at] > 0.0) {
                inputs[at] *= used * random.pick(&[1.0 - 1e-6, 1.0 + 1e-6, 1.0 + 1e-3]);
            }
        }
        "driver_speed_rpm" | "belt_mass_kg_per_m" if model.input("ratio").is_some() => inputs[at] = 0.0,
        "torque_Nm" | "power_kW" | "pulley_speed_rpm" | "slack_tension_N" | "installed_tension_N" => {
            inputs[at] = random.pick(&[0.0, 1e-12])
        }
        "friction" if model.name == "timing-belt" => inputs[at] = random.pick(&[0.0, 1e-9]),
        "lift_angle_deg" => inputs[at] = random.pick(&[0.0, -1.0]),
        "pitch_mass_g" => inputs[at] = -1.0,
        "pitch_line_mm" => inputs[at] = 0.0,
        "teeth_in_mesh" => inputs[at] = random.pick(&[4.0, 5.0, 60.0]),
        "traction" => {
            // Zero, hardly anything, the word, and just below the slip limit.
            let limit = second(model, inputs).1.get("traction_limit").copied().unwrap_or(0.5);
            let edges = [0.0, 1e-9, 1e-4, -1.0, limit * (1.0 - 1e-6), limit * (1.0 + 1e-6)];
            inputs[at] = random.pick(&edges).min(1.0 - 1e-9);
        }
        "friction_direction_deg" => inputs[at] = random.pick(&[0.0, 45.0]),
        "wrap_angle_deg" => inputs[at] = random.pick(&[90.0, 180.0, 270.0]),
        _ => {}
    }
}

/// Outputs that are a difference from one: what matters is how far off they are on the scale of one.
fn is_margin(name: &str) -> bool {
    name.ends_with("_margin") || name == "entry_compression"
}

/// The traction that a belt runs at; 0 for what has none.
fn traction(values: &Values) -> f64 {
    values.get("traction_used").copied().unwrap_or(0.0)
}

/// What one comparison of many designs found.
#[derive(Debug, Default)]
struct Comparison {
    compared: usize,
    skipped: usize,
    /// Designs of which three outputs are not compared.
    cancelled: usize,
    worst: f64,
    worst_output: String,
    statuses: BTreeMap<&'static str, usize>,
}

/// Status and values of one design in both implementations: the largest error and whose it is, or what they disagree on.
fn agree(model: &Model, evaluation: &Evaluation, (status, values): &(&str, Values), rest: f64) -> Result<(f64, String), String> {
    let own = evaluation.status.reason(model);
    if own != *status {
        return Err(format!("the status is {own}, should be {status}"));
    }
    let mut worst = (0.0, String::new());
    for (output, value) in model.outputs.iter().zip(&evaluation.outputs) {
        let (value, other) = match (*value, values.get(output.name.as_str()).copied()) {
            (None, None) => continue,
            (Some(value), Some(other)) => (value, other),
            (value, other) => return Err(format!("{} is {value:?}, should be {other:?}", output.name)),
        };
        let scale = match output.name.as_str() {
            name if is_margin(name) => other.abs().max(1.0),
            // The least load is what is left of the largest where the teeth at the slack side carry nothing.
            "least_tooth_load_N" => other.abs().max(1e-3 * values["peak_tooth_load_N"].abs()),
            _ => other.abs(),
        };
        let error = if value == other { 0.0 } else { (value - other).abs() / scale };
        if rest < CANCELLED && HANGS_ON_THE_REST.contains(&output.name.as_str()) {
            continue;
        }
        if error > 1e-9 || error.is_nan() {
            return Err(format!("{} is {value:e}, should be {other:e}: {error:e} apart", output.name));
        }
        if error > worst.0 {
            worst = (error, output.name.clone());
        }
    }
    Ok(worst)
}

/// Below this share of 1 - traction too little of it is left in an f64 to compare what hangs on it.
const CANCELLED: f64 = 1e-6;
const HANGS_ON_THE_REST: [&str; 3] = ["slack_force_N", "printed_torque_coefficient_N_per_mm", "entry_compression"];

fn compare(model: &Model, region: Region, count: u64, random: &mut Random) -> Comparison {
    let mut found = Comparison::default();
    for number in 0..count {
        let inputs = draw(model, region, random);
        if distance_to_boundary(model, &inputs) < 1e-9 {
            found.skipped += 1;
            continue;
        }
        let expected = second(model, &inputs);
        let rest = 1.0 - traction(&expected.1);
        let (error, output) = agree(model, &evaluate(model, &inputs), &expected, rest)
            .unwrap_or_else(|problem| panic!("{} {region:?}, design {number}: {problem}: {:?}", model.name, by_name(model, &inputs)));
        *found.statuses.entry(expected.0).or_default() += 1;
        found.compared += 1;
        found.cancelled += usize::from(rest < CANCELLED);
        if error > found.worst {
            (found.worst, found.worst_output) = (error, output);
        }
    }
    found
}

/// Models without a second implementation, each with the reason.
///
/// What `pulley` computes of stresses is the answer of finite elements, which another program repeats to 1e-9 only by being the same
/// elements. In its place stand closed forms, a reference table and another solver on the same mesh; the belt's loads, which are a
/// formula, are held against `pulley-load` below, and that against its second implementation here.
const NOT_COMPARED: [&str; 1] = ["pulley"];

fn compared() -> impl Iterator<Item = &'static Arc<Model>> {
    assert!(NOT_COMPARED.iter().all(|name| find(name).is_some_and(|model| is_slow(&model))), "only a solver may do without");
    models::all().iter().filter(|model| !NOT_COMPARED.contains(&model.name.as_str()))
}

#[test]
fn the_belt_loads_of_a_pulley_are_those_of_pulley_load() {
    let [load, pulley] = ["pulley-load", "pulley"].map(|name| find(name).expect("it is a model"));
    let count = load.outputs.len();
    for (own, other) in load.inputs.iter().zip(&pulley.inputs).map(|(own, other)| (&own.name, &other.name)) {
        assert_eq!(own, other);
    }
    for (own, other) in load.outputs.iter().zip(&pulley.outputs) {
        assert_eq!((&own.name, &own.doc), (&other.name, &other.doc));
    }
    let random = &mut Random::new(44);
    let defaults = pulley.defaults();
    let both = |loads: &[f64]| (loads.to_vec(), loads.iter().chain(&defaults[loads.len()..]).copied().collect::<Vec<_>>());
    let mut statuses = BTreeMap::<_, u64>::new();
    for number in 0..6000 {
        let region = random.pick(&[Region::Usual, Region::Wide, Region::Edges]);
        let (own, other) = both(&draw(&load, region, random));
        // The loads alone ask for no elements; a few are evaluated in full.
        let wanted: Set = (0..count).collect();
        let [expected, found] = [(&load, &own), (&pulley, &other)].map(|(model, inputs)| {
            let si = |(input, &value): (&Input, &f64)| if input.word_for(value).is_some() { value } else { input.unit.to_si(value) };
            let si: Vec<f64> = model.inputs.iter().zip(inputs).map(si).collect();
            let mut prepared = vec![0.0; model.kernel.prepared_len()];
            model.kernel.prepare(&si, wanted, &mut prepared);
            let outputs = model.kernel.outputs(&prepared, &si, wanted);
            let margins = model.kernel.margins(&prepared, &si);
            (
                outputs[..count].iter().map(|value| value.to_bits()).collect::<Vec<_>>(),
                margins[..load.conditions.len()].iter().map(|margin| margin.to_bits()).collect::<Vec<_>>(),
            )
        });
        assert_eq!(expected, found, "{own:?}");
        if number % 600 == 0 {
            let [expected, found] = [evaluate(&load, &own), evaluate(&pulley, &other)];
            assert_eq!(expected.outputs, found.outputs[..count], "{own:?}");
            let reason = expected.status.reason(&load);
            assert!(reason == "ok" || reason == found.status.reason(&pulley), "{own:?}: {reason}");
            *statuses.entry(reason).or_default() += 1;
        }
    }
    assert!(statuses.len() >= 2 && statuses["ok"] > 0, "{statuses:?}");
}

#[test]
fn the_models_agree_with_their_second_implementation() {
    for model in compared() {
        let mut seen = BTreeMap::<&str, usize>::new();
        for (region, count) in [(Region::Usual, 10_000), (Region::Wide, 8_000), (Region::Edges, 6_000)] {
            let found = compare(model, region, count, &mut Random::new(41));
            eprintln!("{} {region:?}: {found:?}", model.name);
            assert!(found.skipped * 50 < found.compared, "too many designs lie on a boundary: {found:?}");
            found.statuses.into_iter().for_each(|(status, count)| *seen.entry(status).or_default() += count);
        }
        let every_status =
            model.conditions.iter().filter(|condition| !condition.quiet).map(|condition| condition.reason.as_str()).chain(["ok"]);
        for status in every_status {
            assert!(seen.get(&status).is_some_and(|&count| count >= 10), "{}: hardly any design has the status {status}", model.name);
        }
        assert!(seen["ok"] > 10_000, "{}: {seen:?}", model.name);
    }
}

#[test]
fn the_comparison_objects_to_any_wrong_value_and_status() {
    for model in compared() {
        // Running, with a mass: none of the outputs is zero.
        let mut inputs = model.defaults();
        for (input, value) in model.inputs.iter().zip(&mut inputs).filter(|(input, value)| **value == 0.0 && !input.integer) {
            *value = if input.words.is_empty() { 0.1 * input.usual.1 } else { *value };
        }
        let expected = second(model, &inputs);
        let right = evaluate(model, &inputs);
        assert!(agree(model, &right, &expected, 1.0).is_ok());
        for (number, output) in model.outputs.iter().enumerate() {
            let wrong = |change: &dyn Fn(f64) -> Option<f64>| {
                let mut wrong = right.clone();
                wrong.outputs[number] = change(right.outputs[number].expect("defaults have every output"));
                agree(model, &wrong, &expected, 1.0).is_err()
            };
            assert!(wrong(&|value| Some(value + 3e-9 * value.abs().max(f64::from(u8::from(is_margin(&output.name)))))), "{}", output.name);
            assert!(wrong(&|_| None) && wrong(&|_| Some(f64::NAN)), "{}", output.name);
        }
        let wrong = Evaluation { status: Status::Failed(0), ..right.clone() };
        assert!(agree(model, &wrong, &expected, 1.0).is_err());
    }
}

/// The printed numbers of all papers.
fn printed() -> impl Iterator<Item = (&'static str, &'static Golden)> {
    let all = GOLDEN.iter().chain(timing_data::GOLDEN).map(|(name, golden)| (*name, golden));
    // The paper's loads are those of both models that it describes.
    let loads = GOLDEN.iter().filter(|(name, _)| *name == "pulley-load").map(|(_, golden)| ("pulley", golden));
    all.chain(loads)
}

#[test]
fn every_printed_number_comes_out() {
    for (name, golden) in printed() {
        let model = find(name).expect("it is a model");
        let mut inputs = model.defaults();
        for (input, value) in golden.inputs {
            inputs[model.input(input).expect("it is an input")] = *value;
        }
        let evaluation = evaluate(&model, &inputs);
        let output = model.output(golden.output).expect("it is an output");
        let value = evaluation.outputs[output].expect("it has a meaning");
        let error = (value - golden.expected).abs();
        let (what, source) = (golden.what, golden.source);
        assert!(error <= golden.tolerance, "{name}: {what} should be {}, is {value} ({source})", golden.expected);
    }
}

#[test]
fn the_printed_numbers_cover_every_model() {
    for model in models::all() {
        assert!(printed().any(|(name, _)| name == model.name), "{} has no golden value", model.name);
    }
}
