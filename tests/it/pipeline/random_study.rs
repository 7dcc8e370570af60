//! Random studies as the text of study files, small enough to be judged one by one.

use super::naive::Evaluated;
use super::random_axes::{AxisDraft, Generator, three_digits, written};
use crate::effort::is_slow;
use crate::random::Random;
use beltspace::models::{self, Model, Worse};
use beltspace::study::{Axis, OverScenarios, Quantity, Study};
use std::fmt::Write;
use std::sync::Arc;

/// The range of a histogram, where it is given.
type Ends = Option<(f64, f64)>;

/// A study file in parts.
pub struct Draft {
    pub model: Arc<Model>,
    title: String,
    sample: Option<String>,
    /// Design, operation, uncertainty.
    axes: [Vec<AxisDraft>; 3],
    fixed: Vec<(usize, f64)>,
    constraints: Vec<String>,
    /// Quantity, goal, resolution.
    objectives: Vec<(Quantity, &'static str, Option<f64>)>,
    /// What becomes of each objective over the scenarios, if it is not the worst; all of it goes with `spectrum`.
    over: Vec<Option<&'static str>>,
    /// Does an operation axis have weights?
    spectrum: bool,
    /// Further report columns as they are written.
    columns: Vec<String>,
    /// Quantity, bins, range.
    histograms: Vec<(Quantity, usize, Ends)>,
    /// Only what bounds can serve: nothing that asks about every design.
    for_bounds: bool,
    report: Vec<String>,
}

const ROLES: [&str; 3] = ["design", "operation", "uncertainty"];
/// Most evaluations that a small study costs the oracle.
const MOST_EVALUATIONS: u64 = 30_000;
/// Most evaluations of a study that the sweep judges instead.
const MOST_BY_THE_SWEEP: u64 = 1_000_000;

impl Draft {
    /// A study without constraints: those are placed once its designs are known.
    pub fn new(seed: u64) -> Self {
        Self::drawn(seed, false)
    }

    /// The same for a study that bounds can serve, which may have more designs.
    pub fn for_bounds(seed: u64) -> Self {
        Self::drawn(seed, true)
    }

    fn drawn(seed: u64, for_bounds: bool) -> Self {
        let random = &mut Random::new(seed);
        // Features that a short loop must not miss depend on the seed; everything else is random.
        let turn = seed as usize;
        // A solver is too slow for studies of this size: it has one of its own.
        let models: Vec<_> = models::all().iter().filter(|model| !is_slow(model)).collect();
        // A large one now and then, of a model of which enough designs are feasible: only those give the front a head start.
        let large = turn % 20 == 7;
        let of_large = models.iter().position(|model| model.name == "pulley-load").expect("it is a formula");
        let model = models[if large { of_large } else { turn % models.len() }];
        let mut generator = Generator { random, model: model.clone(), joint_designs: !for_bounds };
        let sampled = turn.is_multiple_of(4) && !for_bounds;
        let designs = match turn % 6 {
            0 if for_bounds => generator.random.log_between(3e4, 2e5),
            _ if for_bounds => generator.random.log_between(1.0, 3e4),
            _ if large => generator.random.between(33e3, 50e3),
            _ => generator.random.log_between(50.0, 3000.0),
        };
        let most = if for_bounds { MOST_BY_THE_SWEEP } else { MOST_EVALUATIONS };
        let scenarios = generator.random.log_between(1.0, 40.0).min(most as f64 / designs).max(1.0);
        // What a shader does not know would keep the study from the device.
        let mut free: Vec<usize> = (0..model.inputs.len()).filter(|&input| for_bounds || !model.inputs[input].cpu_only).collect();
        // What takes the place of another input cannot stand beside it.
        for (number, other) in model.inputs.iter().enumerate().filter_map(|(number, it)| Some((number, it.instead_of.as_ref()?))) {
            let other = model.input(other).expect("it is an input");
            let gone = if generator.random.chance(0.5) { number } else { other };
            free.retain(|&input| input != gone);
        }
        generator.random.shuffle(&mut free);
        let design = generator.axes(0, &mut free, if for_bounds { 5 } else { 4 }, designs, sampled);
        let operation = generator.axes(1, &mut free, 2, scenarios.sqrt(), false);
        let uncertainty = generator.axes(2, &mut free, 2, scenarios.sqrt(), false);
        let fixed = free.into_iter().filter(|_| generator.random.chance(0.2)).collect::<Vec<_>>();
        let fixed = fixed.into_iter().map(|input| (input, generator.value(input))).collect();
        let random = generator.random;
        let sample = sampled.then(|| {
            let method = ["sobol", "latin-hypercube", "random"][turn / 4 % 3];
            format!("method = \"{method}\"\ncount = {}\nseed = {}", designs as u64, random.below(1000))
        });
        let mut draft = Self {
            model: model.clone(),
            title: format!("Random study {seed}"),
            sample,
            axes: [design, operation, uncertainty],
            fixed,
            constraints: Vec::new(),
            objectives: Vec::new(),
            over: Vec::new(),
            spectrum: false,
            columns: Vec::new(),
            histograms: Vec::new(),
            for_bounds,
            report: Vec::new(),
        };
        let listed: usize = draft.axes[0].iter().map(|axis| axis.rows.len()).product();
        if turn % 3 == 1 && !sampled && !for_bounds && listed <= 1000 {
            draft.report.push("variants = true".to_owned());
        }
        if turn % 4 == 1 && !for_bounds {
            draft.report.push("feasible = true".to_owned());
        }
        // Models go by the seed too, and four of them share a factor with ten numbers.
        let number = if for_bounds { turn + turn / 4 } else { turn };
        draft.ask(random, [2, 3, 1, 0, 2, 4, 6, 2, 5, 3][number % 10]);
        if !for_bounds {
            // Numbers of their own, so that all else stays as it is without.
            draft.weigh(&mut Random::new(seed ^ 0x5BEC_7124));
        }
        draft
    }

    /// Gives the cases of an operation axis weights, some of them 0, and asks for means and sums.
    fn weigh(&mut self, random: &mut Random) {
        let model = self.model.clone();
        let Some(axis) = self.axes[1].iter_mut().find(|axis| !axis.log && !axis.rows.is_empty()) else { return };
        let mut weights: Vec<f64> = axis.rows.iter().map(|_| if random.chance(0.2) { 0.0 } else { random.between(0.0, 2.0) }).collect();
        weights[0] = if weights.iter().all(|&weight| weight == 0.0) { 0.25 } else { weights[0] };
        let name = random.pick(&["share", "time_h"]);
        let row = |(row, weight): (&Vec<f64>, &f64)| {
            let cells = axis.inputs.iter().zip(row).map(|(&input, &value)| (&model.inputs[input].name, written(&model, input, value)));
            let cells: String = cells.map(|(name, value)| format!("{name} = {value}, ")).collect();
            format!("{{ {cells}{name} = {weight} }}")
        };
        let rows: Vec<String> = axis.rows.iter().zip(&weights).map(row).collect();
        axis.text = format!("{{ cases = [{}], weight = \"{name}\" }}", rows.join(", "));
        axis.key = "duty".to_owned();
        self.spectrum = true;
        let over = |random: &mut Random| random.pick(&["mean", "sum"]);
        for (quantity, ..) in &self.objectives {
            // A map takes the goal of its objective, which must be one of worst values.
            let name = format!("value = \"{}\" }}", quantity.name(&model));
            let is_free = !self.is_chosen(*quantity) && !self.report.iter().any(|line| line.contains(&name));
            self.over.push((is_free && random.chance(0.5)).then(|| over(random)));
        }
        let quantities: Vec<Quantity> = self.quantities().into_iter().filter(|it| !self.is_chosen(*it)).collect();
        for _ in 0..random.below(4) {
            let name = self.draw(random, &quantities).name(&model);
            let worst = random.pick(&["", ", worst = \"lowest\"", ", worst = \"highest\""]);
            let column = match random.below(3) {
                0 => format!("{{ of = \"{name}\"{worst} }}"),
                _ => format!("{{ of = \"{name}\"{worst}, over_scenarios = \"{}\" }}", over(random)),
            };
            if !self.columns.contains(&column) && !self.report.iter().any(|line| line.contains(&format!("\"{name}\""))) {
                self.columns.push(column);
            }
        }
    }

    /// Is it an input that a design axis sets?
    fn is_chosen(&self, quantity: Quantity) -> bool {
        matches!(quantity, Quantity::Input(input) if self.axes[0].iter().any(|axis| axis.inputs.contains(&input)))
    }

    /// Names of all quantities with a number: a traction that takes "limit" has none.
    fn quantities(&self) -> Vec<Quantity> {
        let written = |input: usize| {
            let axis = self.axes.iter().flatten().find(|axis| axis.inputs.contains(&input));
            let fixed = self.fixed.iter().find(|(it, _)| *it == input).map(|(_, value)| *value);
            match axis {
                Some(axis) => {
                    let column = axis.inputs.iter().position(|it| *it == input).expect("it was found");
                    axis.rows.iter().map(|row| row[column]).collect()
                }
                None => vec![fixed.unwrap_or(self.model.inputs[input].default)],
            }
        };
        let has_numbers = |input: &usize| written(*input).iter().all(|&value| self.model.inputs[*input].word_for(value).is_none());
        let inputs = (0..self.model.inputs.len()).filter(has_numbers).map(Quantity::Input);
        (0..self.model.outputs.len()).map(Quantity::Output).chain(inputs).collect()
    }

    /// Draws a quantity: mostly an output, else mostly an input that is chosen.
    fn draw(&self, random: &mut Random, quantities: &[Quantity]) -> Quantity {
        let favourites = [
            "torque_capacity_Nm",
            "capacity_axial_force_N",
            "stress_margin",
            "slip_margin",
            "axial_force_N",
            "axial_force_upper_N",
            "clamping_utilisation",
            "friction_margin",
            "boundary_tooth",
            "lift_speed_rpm",
            "peak_tooth_load_N",
        ];
        let chosen = |it: &&Quantity| matches!(it, Quantity::Input(input) if self.axes[0].iter().any(|axis| axis.inputs.contains(input)));
        let favourite = |it: &&Quantity| favourites.contains(&it.name(&self.model));
        let output = |it: &&Quantity| matches!(it, Quantity::Output(_));
        let filtered: Vec<Quantity> = match random.below(20) {
            0..8 => quantities.iter().filter(favourite).copied().collect(),
            8..16 => quantities.iter().filter(output).copied().collect(),
            16..19 => quantities.iter().filter(chosen).copied().collect(),
            _ => quantities.to_vec(),
        };
        if filtered.is_empty() { random.pick(quantities) } else { random.pick(&filtered) }
    }

    /// Objectives and report.
    fn ask(&mut self, random: &mut Random, wanted: usize) {
        let model = &self.model;
        let quantities = self.quantities();
        let mut objectives: Vec<Quantity> = Vec::new();
        while objectives.len() < wanted {
            let quantity = self.draw(random, &quantities);
            if !objectives.contains(&quantity) {
                objectives.push(quantity);
                let natural = if quantity.worse(model) == Worse::Higher { "min" } else { "max" };
                let goal = if random.chance(0.8) { natural } else { random.pick(&["min", "max"]) };
                self.objectives.push((quantity, goal, None));
            }
        }
        let goal = |random: &mut Random| random.pick(&["min", "max"]);
        if random.chance(0.5) || wanted == 0 {
            let (by, count) = (self.draw(random, &quantities).name(model), random.pick(&[1, 3, 20, 5000]));
            let goal = if random.chance(0.5) { format!(", goal = \"{}\"", goal(random)) } else { String::new() };
            self.report.push(format!("top = {{ by = \"{by}\", count = {count}{goal} }}"));
        }
        for _ in 0..random.pick(&[0, 0, 1, 2]) {
            let bins = random.pick(&[1, 7, 50]);
            self.histograms.push((self.draw(random, &quantities), bins, None));
        }
        let mut single: Vec<&str> = self.axes[0].iter().filter(|axis| axis.kind != "joint").map(|axis| axis.key.as_str()).collect();
        if self.sample.is_none() && single.len() >= 2 {
            let mut maps = Vec::new();
            for _ in 0..random.pick(&[0, 1, 1, 3]) {
                random.shuffle(&mut single);
                let quantity = self.draw(random, &quantities);
                let value = match random.below(3) {
                    0 => "best = \"share\"".to_owned(),
                    _ if objectives.contains(&quantity) => format!("value = \"{}\"", quantity.name(model)),
                    _ => format!("value = \"{}\", best = \"{}\"", quantity.name(model), goal(random)),
                };
                maps.push(format!("{{ x = \"{}\", y = \"{}\", {value} }}", single[0], single[1]));
            }
            if !maps.is_empty() {
                self.report.push(format!("maps = [{}]", maps.join(", ")));
            }
        }
        match random.below(6) {
            0 => self.report.push(format!("sample = {}", random.pick(&[1, 7, 100, 10_000]))),
            1 => self.report.push(format!("sample = {{ count = {}, seed = {} }}", random.pick(&[3, 40]), random.below(1000))),
            _ => {}
        }
        let mut columns: Vec<String> = Vec::new();
        for _ in 0..random.below(4) {
            let quantity = self.draw(random, &quantities);
            let chosen = matches!(quantity, Quantity::Input(input) if self.axes[0].iter().any(|axis| axis.inputs.contains(&input)));
            let name = format!("\"{}\"", quantity.name(model));
            if !chosen && !columns.contains(&name) {
                columns.push(name);
            }
        }
        if !columns.is_empty() {
            self.report.push(format!("columns = [{}]", columns.join(", ")));
        }
    }

    /// Places bounds where some designs just touch them, steps of resolution, and ranges of histograms that cut something off.
    pub fn constrain(&mut self, seed: u64, study: &Study, evaluated: &Evaluated) {
        let random = &mut Random::new(seed ^ 0xC0_57A1);
        let quantities = self.quantities();
        let mut used = Vec::new();
        for _ in 0..random.pick(&[0, 1, 1, 2, 3]) {
            let quantity = self.draw(random, &quantities);
            let high = random.chance(0.5);
            let worse = if high { Worse::Higher } else { Worse::Lower };
            let Some(values) = evaluated.sorted_worst_values(study, quantity, worse) else { continue };
            if used.contains(&quantity) {
                continue;
            }
            used.push(quantity);
            // Mostly a bound that some design takes in its worst scenario; now and then one that nothing can meet.
            let quantile = random.between(0.3, 0.98);
            let place = (quantile * values.len() as f64) as usize;
            let bound = if high { values[place] } else { values[values.len() - 1 - place] };
            let impossible = random.chance(0.04);
            let width = (values[values.len() - 1] - values[0]).abs().max(1.0);
            let bound = match impossible {
                true if high => values[0] - width,
                true => values[values.len() - 1] + width,
                false => bound,
            };
            let key = random.pick(if high { &["max", "below"] } else { &["min", "above"] });
            let inner = values[if high { values.len() / 10 } else { values.len() - 1 - values.len() / 10 }];
            let other = match random.below(5) {
                1 if self.for_bounds && high && inner < bound => format!(", {} = {inner}", random.pick(&["min", "above"])),
                1 if self.for_bounds && !high && inner > bound => format!(", {} = {inner}", random.pick(&["max", "below"])),
                0 if high => format!(", min = {}", values[0] - 0.1 * width),
                0 => format!(", max = {}", values[values.len() - 1] + 0.1 * width),
                _ => String::new(),
            };
            let (bound, other) = (bound + 0.0, if impossible { String::new() } else { other });
            self.constraints.push(format!("{} = {{ {key} = {bound}{other} }}", quantity.name(&self.model)));
        }
        if self.for_bounds && random.chance(0.4) {
            self.bound_at_zero(random, &used);
        }
        self.constrain_sums(&mut Random::new(seed ^ 0x5BEC_C057), study, evaluated);
        let worst_values = |quantity: Quantity| {
            let values = evaluated.sorted_worst_values(study, quantity, quantity.worse(&self.model))?;
            (values[0] < values[values.len() - 1]).then_some(values)
        };
        for (quantity, _, resolution) in &mut self.objectives {
            if random.chance(0.25) {
                *resolution = worst_values(*quantity)
                    .map(|values| three_digits((values[values.len() - 1] - values[0]) / random.between(2.0, 40.0)))
                    .filter(|width| *width > 0.0);
            }
        }
        for (quantity, _, range) in &mut self.histograms {
            if random.chance(0.5) {
                // The ends are values that some design has: they belong to the first and the last bin.
                let ends = worst_values(*quantity).map(|values| (values[values.len() / 10], values[values.len() - 1 - values.len() / 5]));
                *range = ends.filter(|(low, high)| low < high);
            }
        }
    }

    /// Places bounds on means and sums where some designs just touch them.
    fn constrain_sums(&mut self, random: &mut Random, study: &Study, evaluated: &Evaluated) {
        let quantities: Vec<Quantity> = self.quantities().into_iter().filter(|it| !self.is_chosen(*it)).collect();
        let wanted = if self.spectrum { random.pick(&[0, 1, 1, 2]) } else { 0 };
        let mut used = Vec::new();
        for number in 0..wanted {
            let quantity = self.draw(random, &quantities);
            let (over, word) = random.pick(&[(OverScenarios::Mean, "mean"), (OverScenarios::Sum, "sum")]);
            let high = random.chance(0.5);
            let worse = if high { Worse::Higher } else { Worse::Lower };
            let Some(values) = evaluated.sorted_values_over(study, quantity, over, worse) else { continue };
            if used.contains(&(quantity, word)) {
                continue;
            }
            used.push((quantity, word));
            let place = (random.between(0.4, 0.98) * values.len() as f64) as usize;
            let bound = if high { values[place] } else { values[values.len() - 1 - place] };
            let key = random.pick(if high { &["max", "below"] } else { &["min", "above"] });
            let name = quantity.name(&self.model);
            self.constraints.push(format!("label_{number} = {{ of = \"{name}\", over_scenarios = \"{word}\", {key} = {} }}", bound + 0.0));
        }
    }

    /// A bound at 0, where plateaus are: what carries nothing, what lifts nowhere.
    fn bound_at_zero(&mut self, random: &mut Random, used: &[Quantity]) {
        let at_zero = [
            ("torque_capacity_Nm", "above"),
            ("torque_capacity_Nm", "min"),
            ("slip_margin", "min"),
            ("slip_margin", "above"),
            ("stress_margin", "min"),
            ("friction_margin", "min"),
            ("incomplete_teeth", "max"),
            ("least_tooth_load_N", "min"),
        ];
        let known = |name: &str| self.model.output(name).map(Quantity::Output);
        let free: Vec<_> = at_zero.into_iter().filter(|(name, _)| known(name).is_some_and(|it| !used.contains(&it))).collect();
        if !free.is_empty() {
            let (name, key) = random.pick(&free);
            self.constraints.push(format!("{name} = {{ {key} = 0 }}"));
        }
    }

    /// The study file.
    pub fn text(&self) -> String {
        let mut text = format!("model = \"{}\"\ntitle = \"{}\"\n", self.model.name, self.title);
        let mut section = |name: &str, lines: &[String]| {
            if !lines.is_empty() {
                write!(text, "\n[{name}]\n{}\n", lines.join("\n")).expect("a text takes everything");
            }
        };
        section("sample", self.sample.as_slice());
        for (role, axes) in ROLES.iter().zip(&self.axes) {
            section(role, &axes.iter().map(|axis| format!("{} = {}", axis.key, axis.text)).collect::<Vec<_>>());
        }
        let fixed =
            self.fixed.iter().map(|&(input, value)| format!("{} = {}", self.model.inputs[input].name, written(&self.model, input, value)));
        section("fixed", &fixed.collect::<Vec<_>>());
        section("constraints", &self.constraints);
        let objective = |(number, &(quantity, goal, resolution)): (usize, &(Quantity, &str, Option<f64>))| {
            let name = quantity.name(&self.model);
            let resolved = resolution.map_or(String::new(), |resolution| format!(", resolution = {resolution}"));
            if let Some(over) = self.over.get(number).copied().flatten() {
                return format!("{name} = {{ goal = \"{goal}\", over_scenarios = \"{over}\"{resolved} }}");
            }
            match resolution {
                Some(resolution) => format!("{name} = {{ goal = \"{goal}\", resolution = {resolution} }}"),
                None => format!("{name} = \"{goal}\""),
            }
        };
        section("objectives", &self.objectives.iter().enumerate().map(objective).collect::<Vec<_>>());
        let histogram = |&(quantity, bins, range): &(Quantity, usize, Ends)| {
            let range = range.map_or(String::new(), |(low, high)| format!(", from = {low}, to = {high}"));
            format!("{{ of = \"{}\", bins = {bins}{range} }}", quantity.name(&self.model))
        };
        let histograms: Vec<_> = self.histograms.iter().map(histogram).collect();
        let histograms = (!histograms.is_empty()).then(|| format!("histograms = [{}]", histograms.join(", ")));
        let listed = |line: &String| line.starts_with("columns = ");
        let mut columns = self.columns.clone();
        let before = self.report.iter().find(|line| listed(line)).map(|line| line["columns = [".len()..line.len() - 1].to_owned());
        columns.splice(0..0, before);
        let columns = (!columns.is_empty()).then(|| format!("columns = [{}]", columns.join(", ")));
        let report = self.report.iter().filter(|line| !listed(line)).cloned();
        section("report", &report.chain(columns).chain(histograms).collect::<Vec<_>>());
        text
    }

    /// The axes of the parsed study must have the values that the text means.
    pub fn check_axes(&self, study: &Study) {
        let parsed: [&[Axis]; 3] = [&study.design, &study.operation, &study.uncertainty];
        for (drafts, axes) in self.axes.iter().zip(parsed) {
            assert_eq!(drafts.len(), axes.len());
            for (draft, axis) in drafts.iter().zip(axes) {
                assert_eq!(draft.inputs, axis.inputs(), "{}", draft.key);
                if draft.kind == "continuous" {
                    continue;
                }
                assert_eq!(draft.rows.len() as u64, axis.count(), "{} = {}", draft.key, draft.text);
                for (index, row) in draft.rows.iter().enumerate() {
                    for (column, &value) in row.iter().enumerate() {
                        let found = axis.value(column, index as u64);
                        let close = draft.log && (found - value).abs() <= 1e-13 * value.abs();
                        assert!(found == value || close, "{} = {}: level {index} is {found}, not {value}", draft.key, draft.text);
                    }
                }
            }
        }
    }

    /// Kinds of axes, for the count of what was covered.
    pub fn kinds(&self) -> impl Iterator<Item = String> + '_ {
        self.axes.iter().zip(ROLES).flat_map(|(axes, role)| {
            axes.iter().map(move |axis| if axis.kind == "joint" { format!("joint axis in {role}") } else { axis.kind.to_owned() })
        })
    }
}
