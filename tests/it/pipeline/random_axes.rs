//! Random axes as a study file writes them, with the values that they mean.

use crate::random::Random;
use beltspace::models::Model;
use std::sync::Arc;

/// An axis as it is written, with the values that it means.
pub struct AxisDraft {
    pub key: String,
    pub text: String,
    pub inputs: Vec<usize>,
    /// One row per level; empty for a continuous range.
    pub rows: Vec<Vec<f64>>,
    /// Computed in logarithms: equal to rounding only.
    pub log: bool,
    pub kind: &'static str,
}

/// Values of an input among which many designs have a meaning.
fn range(model: &Model, number: usize) -> (f64, f64) {
    let input = &model.inputs[number];
    match (model.name.as_str(), input.name.as_str()) {
        (_, "belt_length_mm") => (0.85 * input.default, 1.15 * input.default),
        (_, "centre_distance_mm") => (0.9 * input.default, 1.25 * input.default),
        ("timing-belt", "slack_tension_N") => (0.0, 150.0),
        ("timing-belt", "tight_tension_N") => (100.0, 1500.0),
        ("timing-belt", "pulley_speed_rpm") => (500.0, 8000.0),
        ("timing-belt", "lift_angle_deg") => (0.0, 2.4),
        ("timing-belt", "space_half_angle_deg") => (2.2, 4.0),
        ("timing-belt", "land_half_angle_deg") => (0.5, 2.5),
        ("timing-belt", "teeth_in_mesh") => (4.0, 30.0),
        ("rubber-cvt", "elastic_modulus_MPa") => (100.0, 2500.0),
        ("rubber-cvt", "strength_MPa") => (5.0, 60.0),
        ("metal-cvt", "traction") => (0.1, 0.6),
        (_, "traction") => (0.3, 0.9),
        (_, "speed_rpm") => (500.0, 6000.0),
        (_, "power_kW") => (0.5, 12.0),
        (_, "mean_radius_mm") => (30.0, 120.0),
        (_, "slack_tension_N" | "installed_tension_N") => (100.0, 1500.0),
        (_, "wrap_angle_deg") => (60.0, 220.0),
        _ => input.usual,
    }
}

/// A value as a study file writes it.
pub fn written(model: &Model, input: usize, value: f64) -> String {
    model.inputs[input].word_for(value).map_or_else(|| value.to_string(), |word| format!("\"{word}\""))
}

/// A number as a person would round it.
pub fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().expect("a number was printed")
}

/// Draws axes and values of a model's inputs.
pub struct Generator<'r> {
    pub random: &'r mut Random,
    pub model: Arc<Model>,
    /// May design axes walk several inputs together?
    pub joint_designs: bool,
}

impl Generator<'_> {
    /// One value of an input, now and then one at the edge of what it may be.
    pub fn value(&mut self, input: usize) -> f64 {
        let table = &self.model.inputs[input];
        let (low, high) = range(&self.model, input);
        if !table.words.is_empty() && (table.is_enumeration() || self.random.chance(0.25)) {
            return self.random.word(&table.words);
        }
        if table.valid.includes_low && self.random.chance(0.08) {
            return table.valid.low;
        }
        if table.integer {
            return self.random.whole(low as usize, high as usize) as f64;
        }
        let value = self.random.between(low, high);
        if self.random.chance(0.7) { three_digits(value) } else { value }
    }

    /// An axis of one input with about `count` levels.
    fn single(&mut self, input: usize, count: u64, continuous: bool) -> AxisDraft {
        let table = &self.model.inputs[input];
        let key = table.name.to_owned();
        let axis = |kind, text: String, values: Vec<f64>, log| AxisDraft {
            key,
            text,
            inputs: vec![input],
            rows: values.into_iter().map(|value| vec![value]).collect(),
            log,
            kind,
        };
        if count <= 1 {
            let value = self.value(input);
            return axis("one value", written(&self.model, input, value), vec![value], false);
        }
        let (low, high) = range(&self.model, input);
        if table.integer {
            return self.integer(input, count, axis);
        }
        let listed = table.is_enumeration() || (!table.words.is_empty() && self.random.chance(0.4));
        let kind = if listed { 0 } else { self.random.below(if continuous { 7 } else { 5 }) };
        let (mut from, mut to) = (self.random.between(low, 0.6 * low + 0.4 * high), self.random.between(0.4 * low + 0.6 * high, high));
        (from, to) = if self.random.chance(0.7) { (three_digits(from), three_digits(to)) } else { (from, to) };
        let gaps = (count - 1) as f64;
        match kind {
            0 => {
                let mut values: Vec<f64> = Vec::new();
                let most = if table.is_enumeration() { table.words.len() } else { 8 };
                while (values.len() as u64) < count.min(most as u64) {
                    let value = self.value(input);
                    if values.iter().all(|other| other.to_bits() != value.to_bits()) {
                        values.push(value);
                    }
                }
                let text = values.iter().map(|&value| written(&self.model, input, value)).collect::<Vec<_>>().join(", ");
                axis("list", format!("[{text}]"), values, false)
            }
            1 | 2 => {
                if self.random.chance(0.2) {
                    (from, to) = (to, from);
                }
                let log = kind == 2;
                let level = |i: u64| match i {
                    0 => from,
                    _ if i == count - 1 => to,
                    _ if log => (from.ln() + i as f64 * (to.ln() - from.ln()) / gaps).exp(),
                    _ => from + i as f64 * (to - from) / gaps,
                };
                let spacing = if log { ", spacing = \"log\"" } else { "" };
                let text = format!("{{ from = {from}, to = {to}, count = {count}{spacing} }}");
                axis(if log { "log count" } else { "count" }, text, (0..count).map(level).collect(), log)
            }
            3 | 4 => {
                let log = kind == 4;
                let width = if log { (to / from).log10() } else { to - from };
                let step = three_digits(width / gaps);
                let level = |i: u64| if log { from * 10f64.powf(i as f64 * step) } else { from + i as f64 * step };
                // An end that is hit but for rounding belongs to the axis; powers round too much to tell.
                if log {
                    to = level(count - 1) * 1.000_001;
                } else if self.random.chance(0.5) {
                    to = level(count - 1) * (1.0 - f64::EPSILON);
                }
                let values = (0..).map(level).take_while(|value| *value <= to * (1.0 + 1e-12)).collect();
                let spacing = if log { ", spacing = \"log\"" } else { "" };
                let text = format!("{{ from = {from}, to = {to}, step = {step}{spacing} }}");
                axis(if log { "log step" } else { "step" }, text, values, log)
            }
            _ => {
                let spacing = if kind == 6 { ", spacing = \"log\"" } else { "" };
                axis("continuous", format!("{{ from = {from}, to = {to}{spacing} }}"), Vec::new(), false)
            }
        }
    }

    fn integer(&mut self, input: usize, count: u64, axis: impl FnOnce(&'static str, String, Vec<f64>, bool) -> AxisDraft) -> AxisDraft {
        let (low, high) = range(&self.model, input);
        let (low, high) = (low as u64, high as u64);
        // Of two values there are, neither twice.
        let from = (low + self.random.below(2) as u64).min(high - 1);
        let to = (from + count - 1).min(high);
        let values = |step: u64| (from..=to).step_by(step as usize).map(|value| value as f64).collect();
        let (text, values): (_, Vec<f64>) = match self.random.below(4) {
            0 => (format!("{{ from = {from}, to = {to} }}"), values(1)),
            1 => (format!("{{ from = {from}, to = {to}, count = {} }}", to - from + 1), values(1)),
            2 => (format!("{{ from = {from}, to = {to}, step = 2 }}"), values(2)),
            _ => (format!("[{from}, {to}]"), vec![from as f64, to as f64]),
        };
        axis("whole numbers", text, values, false)
    }

    /// An axis of several inputs that walk together.
    fn joint(&mut self, key: &str, inputs: &[usize], count: u64) -> AxisDraft {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        while (rows.len() as u64) < count.clamp(2, 12) {
            let row: Vec<f64> = inputs.iter().map(|&input| self.value(input)).collect();
            if !rows.contains(&row) {
                rows.push(row);
            }
        }
        let name = |input: usize| &self.model.inputs[input].name;
        let row_text = |row: &Vec<f64>| {
            let cells: Vec<_> = inputs
                .iter()
                .zip(row)
                .map(|(&input, &value)| format!("{} = {}", name(input), written(&self.model, input, value)))
                .collect();
            format!("{{ {} }}", cells.join(", "))
        };
        let text = format!("[{}]", rows.iter().map(row_text).collect::<Vec<_>>().join(", "));
        AxisDraft { key: key.to_owned(), text, inputs: inputs.to_vec(), rows, log: false, kind: "joint" }
    }

    /// Axes of one role whose levels multiply to about `size`, from the inputs in `free`.
    pub fn axes(&mut self, role: usize, free: &mut Vec<usize>, most: usize, size: f64, continuous: bool) -> Vec<AxisDraft> {
        let number = self.random.whole(usize::from(role == 0), most);
        let mut axes = Vec::new();
        let mut left = size;
        for axis in 0..number {
            let even = left.powf(1.0 / (number - axis) as f64);
            let count = (even * self.random.between(0.6, 1.5)).round().max(1.0).min(left.max(1.0)) as u64;
            let Some(input) = free.pop() else { break };
            let made = if (role > 0 || self.joint_designs) && self.random.chance(0.2) && !free.is_empty() {
                let mut inputs = vec![input, free.pop().expect("it is not empty")];
                if self.random.chance(0.3) {
                    inputs.extend(free.pop());
                }
                self.joint(&format!("cases_{role}{axis}"), &inputs, count)
            } else {
                self.single(input, count, continuous)
            };
            left /= made.rows.len().max(1) as f64;
            axes.push(made);
        }
        axes
    }
}
