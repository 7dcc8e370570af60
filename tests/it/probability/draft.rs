//! A random study with distributions, as text.

use super::kinds::{KINDS, Kind};
use super::laws::law;
use crate::random::Random;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// A bound that is set once it is known what values there are.
#[derive(Clone, Debug)]
pub struct Bound {
    /// What is bounded.
    pub of: String,
    /// `min`, `above`, `max` or `below`.
    pub key: &'static str,
    pub value: f64,
    /// Whatever else the entry says.
    pub more: String,
    pub role: Role,
}

/// What a bound is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// Each draw.
    Draw,
    /// The share of draws that keep it.
    OwnYield,
    /// A statistic over the draws.
    Statistic,
}

/// A random study.
pub struct Draft {
    pub kind: &'static Kind,
    lines: Vec<(&'static str, String)>,
    pub bounds: Vec<Bound>,
    /// Least yield, if it is a constraint.
    pub least_yield: Option<f64>,
    /// What the study has, for the count at the end.
    pub features: BTreeSet<String>,
}

impl Draft {
    pub fn new(seed: u64) -> Self {
        let random = &mut Random::new(seed);
        let kind = &KINDS[seed as usize % KINDS.len()];
        let mut draft = Self { kind, lines: Vec::new(), bounds: Vec::new(), least_yield: None, features: BTreeSet::new() };
        draft.note(kind.label);
        draft.axes(random);
        draft.ask(random);
        draft
    }

    fn note(&mut self, feature: impl Into<String>) {
        self.features.insert(feature.into());
    }

    fn line(&mut self, section: &'static str, line: String) {
        self.lines.push((section, line));
    }

    fn axes(&mut self, random: &mut Random) {
        let kind = self.kind;
        for (number, axis) in kind.design.iter().enumerate() {
            if number < 2 || random.chance(0.5) {
                self.line("design", (*axis).to_owned());
            }
        }
        self.operation(random);
        // A range is a level axis too.
        for level in kind.levels {
            if random.chance(0.45) {
                self.line("uncertainty", (*level).to_owned());
                self.note("levels");
            }
        }
        let mut drawn: Vec<String> = Vec::new();
        for (number, &(name, low, high)) in kind.drawn.iter().enumerate() {
            if number == 0 && !kind.first_is_needed && random.chance(0.2) || number > 0 && random.chance(0.5) {
                continue;
            }
            let (text, label) = law(random, low, high);
            self.line("uncertainty", format!("{name} = {text}"));
            self.note(label);
            drawn.push(name.to_owned());
        }
        for &(name, spread) in kind.toleranced {
            if drawn.len() >= 4 || random.chance(if drawn.is_empty() { 0.0 } else { 0.65 }) {
                continue;
            }
            let (effect, (text, label)) = match random.chance(0.6) {
                true => ("times", law(random, 0.85, 1.2)),
                false => ("plus", law(random, -spread, spread)),
            };
            self.line("uncertainty", format!("{name} = {{ {effect} = {text} }}"));
            self.note(label);
            self.note(effect);
            drawn.push(name.to_owned());
        }
        self.probability(random, &drawn);
    }

    fn operation(&mut self, random: &mut Random) {
        let value = |random: &mut Random, low: f64, high: f64| (random.between(low, high) * 1e4).round() / 1e4;
        let [(first, low, high), (second, from, to)] = self.kind.cases;
        match random.below(5) {
            0 => self.note("one operating case"),
            1 => {
                let values = [value(random, low, high), value(random, low, high)];
                self.line("operation", format!("{first} = [{}, {}]", values[0], values[1] + high));
                if random.chance(0.5) {
                    self.line("operation", format!("{second} = [{}]", value(random, from, to)));
                }
                self.note("operation axes");
            }
            2 => {
                let mut case = |_| format!("{{ {first} = {}, {second} = {} }}", value(random, low, high), value(random, from, to));
                let cases: Vec<String> = (0..3).map(&mut case).collect();
                self.line("operation", format!("cases = [{}]", cases.join(", ")));
                self.note("operating cases");
            }
            _ => {
                let mut case = |number: usize| {
                    let share = if number == 1 { 0.0 } else { 1.0 + random.below(8) as f64 };
                    format!("{{ {first} = {}, share = {share} }}", value(random, low, high))
                };
                let cases: Vec<String> = (0..3).map(&mut case).collect();
                self.line("operation", format!("duty = {{ cases = [{}], weight = \"share\" }}", cases.join(", ")));
                if random.chance(0.5) {
                    self.line("operation", format!("{second} = [{}, {}]", value(random, from, to), to));
                    self.note("spectrum beside other cases");
                }
                self.note("spectrum");
            }
        }
    }

    fn probability(&mut self, random: &mut Random, drawn: &[String]) {
        let method = random.pick(&["random", "random", "latin-hypercube", "sobol"]);
        let draws = match method {
            "random" => random.pick(&[1, 40, 64, 97, 150]),
            "sobol" => random.pick(&[32, 64, 128]),
            _ => random.pick(&[32, 48, 112]),
        };
        self.note(method);
        self.line("probability", format!("draws = {draws}\nconfirm = {}\nmethod = \"{method}\"", random.whole(1, 90)));
        if random.chance(0.5) {
            self.line("probability", format!("seed = {}", random.next() >> 12));
        }
        let pairs: Vec<String> = (1..drawn.len())
            .filter_map(|it| {
                let value = random.between(-0.6, 0.6);
                random.chance(0.5).then(|| format!("[\"{}\", \"{}\", {value:.3}]", drawn[it], drawn[it - 1]))
            })
            .collect();
        if !pairs.is_empty() {
            self.line("probability", format!("correlation = [{}]", pairs.join(", ")));
            self.note("correlation");
        }
    }

    /// ` , over_scenarios = ...` where there is a spectrum.
    fn over(&mut self, random: &mut Random) -> String {
        if !self.features.contains("spectrum") || random.chance(0.4) {
            return String::new();
        }
        self.note("mean or sum over cases");
        format!(", over_scenarios = \"{}\"", random.pick(&["mean", "sum"]))
    }

    /// `over_draws = ...`.
    fn statistic(&mut self, random: &mut Random) -> String {
        let over = random.pick(&["\"mean\"", "\"sd\"", "\"worst\"", "{ quantile = 0.95 }", "{ quantile = 0.5 }", "{ quantile = 0.07 }"]);
        self.note(over.split(" =").next().unwrap_or(over).trim_matches(['"', '{', ' ']));
        format!("over_draws = {over}")
    }

    fn ask(&mut self, random: &mut Random) {
        let mut outputs = self.kind.outputs.to_vec();
        random.shuffle(&mut outputs);
        let mut places = outputs.iter().map(|it| (*it).to_owned()).cycle();
        let mut next = || places.next().expect("there are outputs");
        for number in 0..random.whole(1, 4) {
            let role = [Role::Draw, Role::OwnYield, Role::Statistic, Role::Draw][number];
            let mut more = self.over(random);
            match role {
                Role::Draw => self.note("constraint of single draws"),
                Role::OwnYield => self.note("constraint with its own yield"),
                Role::Statistic => {
                    more += ", ";
                    more += &self.statistic(random);
                    self.note("constraint of a statistic");
                }
            }
            let key = random.pick(&["min", "max", "above", "below"]);
            self.bounds.push(Bound { of: next(), key, value: 0.0, more, role });
        }
        let by_yield = random.below(3);
        if by_yield != 0 {
            self.line("objectives", "yield = \"max\"".to_owned());
            self.note("yield as objective");
        }
        if by_yield != 1 {
            self.least_yield = Some(0.0);
            self.note("yield as constraint");
        }
        for number in 0..random.whole(1, 2) {
            let (of, goal) = (next(), random.pick(&["min", "max"]));
            let over = self.over(random) + ", " + &self.statistic(random);
            self.line("objectives", format!("objective_{number} = {{ of = \"{of}\", goal = \"{goal}\"{over} }}"));
        }
        if random.chance(0.3) {
            let axis = self.kind.design[0].split(' ').next().unwrap_or("");
            self.line("objectives", format!("{axis} = \"min\""));
            self.note("design input as objective");
        }
        self.report(random, &mut next);
    }

    fn report(&mut self, random: &mut Random, next: &mut dyn FnMut() -> String) {
        if random.chance(0.5) {
            let over = self.statistic(random);
            let end = random.pick(&["", ", worst = \"lowest\"", ", worst = \"highest\""]);
            self.line("report", format!("columns = [{{ of = \"{}\", {over}{end} }}]", next()));
            self.note("column");
        }
        if random.chance(0.4) {
            let (over, goal) = (self.statistic(random), random.pick(&["min", "max"]));
            self.line("report", format!("top = {{ by = \"{}\", {over}, goal = \"{goal}\", count = 5 }}", next()));
            self.note("top");
        }
        if random.chance(0.3) {
            let over = self.statistic(random);
            self.line("report", format!("histograms = [{{ of = \"{}\", {over}, bins = 6 }}, {{ of = \"yield\", bins = 4 }}]", next()));
            self.note("histogram");
        }
        if random.chance(0.3) {
            let over = self.statistic(random);
            let [x, y] = [0, 1].map(|axis| self.kind.design[axis].split(' ').next().unwrap_or(""));
            self.line("report", format!("maps = [{{ x = \"{x}\", y = \"{y}\", value = \"{}\", best = \"min\", {over} }}]", next()));
            self.note("map");
        }
        for (key, chance) in [("variants = true", 0.3), ("feasible = true", 0.3), ("sample = 3", 0.2)] {
            if random.chance(chance) {
                self.line("report", key.to_owned());
                self.note(key.split(' ').next().unwrap_or(key));
            }
        }
    }

    /// The study. `pilot`: without the constraints of single draws and of the yield, and such that every design is feasible.
    pub fn text(&self, pilot: bool) -> String {
        let kind = self.kind;
        let mut text = format!("model = \"{}\"\ntitle = \"A random study\"\n{}\n", kind.model, kind.head);
        for section in ["design", "operation", "uncertainty", "probability", "constraints", "objectives", "report"] {
            let _ = writeln!(text, "[{section}]");
            for (_, line) in self.lines.iter().filter(|it| it.0 == section) {
                let _ = writeln!(text, "{line}");
            }
            if section == "objectives" && pilot && !text.contains("yield = \"max\"") {
                let _ = writeln!(text, "yield = \"max\"");
            }
            if section != "constraints" || pilot {
                continue;
            }
            for (number, Bound { of, key, value, more, role }) in self.bounds.iter().enumerate() {
                let share = if *role == Role::OwnYield { ", yield = 0.5" } else { "" };
                let _ = writeln!(text, "bound_{number} = {{ of = \"{of}\", {key} = {value:?}{more}{share} }}");
            }
            if let Some(least) = self.least_yield {
                let _ = writeln!(text, "yield = {{ min = {least:?} }}");
            }
        }
        text + kind.tail
    }
}
