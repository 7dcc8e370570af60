//! Random studies with formulas: what stands around a model, as text and as trees.

use super::grow::{Grower, Readable, constants_are_good};
use super::measure::{OWN, SUFFIXES, of_name};
use super::tree::{Curve, Named, Tree};
use super::walk::{Held, Numbers, Walker};
use crate::pipeline::random_axes::{AxisDraft, Generator, three_digits};
use crate::random::Random;
use beltspace::models::{self, Model, Status, evaluate};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

/// The models that formulas can be put around on every engine.
pub const MODELS: [&str; 5] = ["metal-cvt", "rubber-cvt", "pulley-load", "flat-belt", "timing-belt"];
/// Designs that formulas are tried on while they are made.
const SAMPLES: usize = 24;
/// Tables that give names values.
pub const ROLES: [&str; 4] = ["design", "operation", "uncertainty", "fixed"];

/// A line of a table that gives names values.
pub struct Given {
    pub role: usize,
    pub key: String,
    text: String,
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Given {
    fn of(model: &Model, role: usize, axis: AxisDraft) -> Self {
        let names = axis.inputs.iter().map(|&input| model.inputs[input].name.clone()).collect();
        Self { role, key: axis.key, text: axis.text, names, rows: axis.rows }
    }

    /// Is it an axis of one name?
    pub fn is_single(&self) -> bool {
        self.names.len() == 1
    }
}

/// What a study puts around a model.
pub struct Around {
    pub walker: Walker,
    pub given: Vec<Given>,
    pub variables: Vec<String>,
    title: String,
}

/// Builds one; `None` if the draw comes to nothing.
struct Builder<'r> {
    random: &'r mut Random,
    model: Arc<Model>,
    given: Vec<Given>,
    variables: Vec<String>,
    /// Inputs that formulas give.
    by_formula: Vec<usize>,
    walker: Walker,
    samples: Vec<Numbers>,
    /// Is the model's status ok there?
    good: Vec<bool>,
}

impl Around {
    /// Draws what stands around a model; `None` if hardly any design would have a meaning.
    pub fn new(seed: u64, random: &mut Random) -> Option<Self> {
        let model = models::find(MODELS[seed as usize % MODELS.len()]).expect("it is a model");
        let mut builder = Builder {
            random,
            walker: Walker::new(model.clone()),
            model,
            given: Vec::new(),
            variables: Vec::new(),
            by_formula: Vec::new(),
            samples: Vec::new(),
            good: Vec::new(),
        };
        builder.axes();
        builder.variables();
        builder.curves();
        builder.draw_samples();
        builder.before()?;
        builder.model()?;
        builder.after()?;
        builder.use_variables()?;
        builder.random.shuffle(&mut builder.walker.formulas);
        let Builder { walker, given, variables, .. } = builder;
        Some(Self { walker, given, variables, title: format!("Random study {seed} with formulas") })
    }

    /// The study file up to its constraints.
    pub fn text(&self) -> String {
        let mut text = format!("model = \"{}\"\ntitle = \"{}\"\nunits = {OWN:?}\n", self.walker.base.name, self.title);
        let mut section = |name: &str, lines: Vec<String>| {
            if !lines.is_empty() {
                write!(text, "\n[{name}]\n{}\n", lines.join("\n")).expect("a text takes everything");
            }
        };
        let curve = |it: &Curve| format!("{} = {{ csv = \"{}.csv\", x = \"{}\", y = \"{}\" }}", it.name, it.name, it.x, it.y);
        section("curves", self.walker.curves.iter().map(curve).collect());
        for (number, role) in ROLES.iter().enumerate() {
            let of = self.given.iter().filter(|it| it.role == number);
            section(role, of.map(|it| format!("{} = {}", it.key, it.text)).collect());
        }
        section("formulas", self.walker.formulas.iter().map(|it| format!("{} = \"{}\"", it.name, it.tree)).collect());
        text
    }

    /// Writes the files of the curves.
    pub fn write_curves(&self, folder: &Path, random: &mut Random) {
        for curve in &self.walker.curves {
            let mut text = if random.chance(0.3) { "# as measured\n".to_owned() } else { String::new() };
            let more = random.chance(0.3);
            writeln!(text, "{}{}, {}", if more { "number," } else { "" }, curve.x, curve.y).expect("a text takes everything");
            for (number, (x, y)) in curve.points.iter().enumerate() {
                let number = if more { format!("{number},") } else { String::new() };
                writeln!(text, "{number}{x},{y}").expect("a text takes everything");
            }
            std::fs::write(folder.join(format!("{}.csv", curve.name)), text).expect("a file can be written");
        }
    }
}

impl Builder<'_> {
    fn axes(&mut self) {
        let model = self.model.clone();
        // What takes the place of another input cannot stand beside it.
        let mut gone = Vec::new();
        for (number, other) in model.inputs.iter().enumerate().filter_map(|(number, it)| Some((number, it.instead_of.as_ref()?))) {
            gone.push(if self.random.chance(0.5) { number } else { model.input(other).expect("it is an input") });
        }
        let can_be_given = |it: &usize| !model.inputs[*it].is_enumeration() && !model.inputs[*it].cpu_only && !gone.contains(it);
        let mut inputs: Vec<usize> = (0..model.inputs.len()).filter(can_be_given).collect();
        self.random.shuffle(&mut inputs);
        // Whole ones are few, and tell whether formulas round as they should.
        if self.random.chance(0.35) {
            inputs.sort_by_key(|it| model.inputs[*it].integer);
        }
        for _ in 0..self.random.pick(&[0, 1, 1, 2, 2]) {
            self.by_formula.extend(inputs.pop());
        }
        let mut free: Vec<usize> = (0..model.inputs.len())
            .filter(|it| !self.by_formula.contains(it) && !gone.contains(it) && !model.inputs[*it].cpu_only)
            .collect();
        self.random.shuffle(&mut free);
        let designs = self.random.log_between(20.0, 250.0);
        let mut generator = Generator { random: self.random, model: model.clone(), joint_designs: true };
        for (role, most, size) in [(0, 3, designs), (1, 1, 3.0), (2, 1, 2.0)] {
            let axes = generator.axes(role, &mut free, most, size, false);
            self.given.extend(axes.into_iter().map(|axis| Given::of(&model, role, axis)));
        }
        for input in free {
            if generator.random.chance(0.15) {
                let value = generator.value(input);
                let text = crate::pipeline::random_axes::written(&model, input, value);
                let key = model.inputs[input].name.clone();
                self.given.push(Given { role: 3, names: vec![key.clone()], key, text, rows: vec![vec![value]] });
            }
        }
    }

    fn variables(&mut self) {
        for number in 0..self.random.whole(1, 3) {
            let role = self.random.pick(&[0, 0, 0, 1, 2, 3]);
            let name = format!("given_{number}{}", self.random.pick(&SUFFIXES));
            let size = three_digits(self.random.log_between(0.5, 50.0));
            let count = if role == 3 { 1 } else { self.random.whole(2, if role == 0 { 4 } else { 2 }) };
            let lowest = if self.random.chance(0.2) { -1 } else { 1 };
            let levels: Vec<f64> = (0..count).map(|level| size * (lowest + level as i32) as f64).collect();
            let text = match count {
                1 => levels[0].to_string(),
                _ if self.random.chance(0.3) => format!("{{ from = {}, to = {}, count = {count} }}", levels[0], levels[count - 1]),
                _ => format!("{levels:?}"),
            };
            let rows = levels.into_iter().map(|it| vec![it]).collect();
            self.given.push(Given { role, key: name.clone(), text, names: vec![name.clone()], rows });
            self.variables.push(name);
        }
    }

    fn curves(&mut self) {
        for number in 0..self.random.whole(0, 2) {
            let x = format!("at{}", self.random.pick(&SUFFIXES));
            // What is measured may well be an input.
            let given = self.by_formula.get(number).filter(|_| self.random.chance(0.6)).map(|&it| &self.model.inputs[it]);
            let (y, low, high) = match given {
                Some(input) => (input.name.clone(), input.usual.0, input.usual.1),
                None => (format!("measured{}", self.random.pick(&SUFFIXES)), 0.5, 20.0),
            };
            let mut points = Vec::new();
            let mut at = if self.random.chance(0.5) { 0.0 } else { three_digits(self.random.log_between(0.1, 10.0)) };
            for _ in 0..self.random.whole(2, 6) {
                points.push((at, three_digits(self.random.between(low, high))));
                at = three_digits(at + self.random.log_between(0.5, 20.0));
            }
            points.dedup_by_key(|point| point.0);
            if points.len() > 1 {
                self.walker.curves.push(Curve { name: format!("curve_{number}"), x, y, points });
            }
        }
    }

    /// Numbers of a few designs: inputs and variables.
    fn draw_samples(&mut self) {
        for _ in 0..SAMPLES {
            let held = |value: f64, input: Option<&beltspace::models::Input>, name: &str| match input {
                Some(input) if input.word_for(value).is_some() => Held::Word(value),
                _ => Held::Value(self.walker.si(name, value)),
            };
            let mut numbers: Numbers = self.model.inputs.iter().map(|it| (it.name.clone(), held(it.default, Some(it), &it.name))).collect();
            for line in &self.given {
                let row = &line.rows[self.random.below(line.rows.len())];
                for (name, &value) in line.names.iter().zip(row) {
                    let input = self.model.input(name).map(|it| &self.model.inputs[it]);
                    numbers.insert(name.clone(), held(value, input, name));
                }
            }
            self.samples.push(numbers);
        }
    }

    /// Everything that a formula may read now: inputs and variables, formulas made so far, and outputs if the model was evaluated.
    fn readable(&self, with_outputs: bool) -> Vec<Readable> {
        let plain = |name: &str, whole, may_lack| Readable {
            name: name.to_owned(),
            powers: of_name(name).powers,
            whole,
            words: Vec::new(),
            may_lack,
        };
        let mut known = Vec::new();
        for (number, input) in self.model.inputs.iter().enumerate() {
            let words: Vec<String> = input.words.iter().map(|(word, _)| word.clone()).collect();
            if !self.by_formula.contains(&number) {
                known.push(Readable { words, ..plain(&input.name, input.integer, false) });
            }
        }
        if with_outputs {
            // Where the model has a meaning otherwise.
            let lacks = |name: &str| self.samples.iter().zip(&self.good).any(|(numbers, &good)| good && numbers[name] == Held::Absent);
            known.extend(self.model.outputs.iter().map(|it| plain(&it.name, it.integer, lacks(&it.name))));
        }
        known.extend(self.variables.iter().map(|it| plain(it, false, false)));
        let lacks = |it: &Named| self.samples.iter().any(|numbers| numbers[&it.name] == Held::Absent);
        known.extend(self.walker.formulas.iter().map(|it| plain(&it.name, false, lacks(it))));
        known
    }

    /// Adds a formula that is drawn until enough designs of the sample like what it gives.
    fn add(&mut self, name: &str, with_outputs: bool, draw: impl Fn(&mut Grower<'_>) -> Tree, likes: impl Fn(f64) -> bool) -> Option<()> {
        let known = self.readable(with_outputs);
        // Now and then a formula of which many designs have no value, and that some surely have not.
        let (least, most) = self.random.pick(&[(0.75, 1.0), (0.75, 1.0), (0.3, 1.0), (0.4, 0.95)]);
        for attempt in 0..40 {
            let mut grower = Grower { random: self.random, known: known.clone(), walker: &self.walker, samples: &self.samples };
            let named = Named { name: name.to_owned(), tree: draw(&mut grower) };
            if !constants_are_good(&named.tree) || named.tree.to_string().len() > 1500 {
                continue;
            }
            let values: Vec<Held> = self.samples.iter().map(|numbers| self.walker.formula(&named, numbers).held).collect();
            let good = values.iter().filter(|it| match it {
                Held::Value(value) => likes(*value),
                Held::Absent => true,
                _ => false,
            });
            let differ = values.iter().any(|it| *it != values[0]);
            let share = good.count() as f64 / values.len() as f64;
            let too_good = share > most && attempt < 25;
            if share < least || too_good || (!differ && self.random.chance(0.9)) {
                continue;
            }
            for (numbers, value) in self.samples.iter_mut().zip(values) {
                numbers.insert(name.to_owned(), value);
            }
            self.walker.formulas.push(named);
            return Some(());
        }
        None
    }

    /// Formulas that the model is given something by, and some that they read.
    fn before(&mut self) -> Option<()> {
        for number in 0..self.random.below(3) {
            let name = format!("before_{number}{}", self.random.pick(&SUFFIXES));
            let depth = self.random.whole(1, 3);
            self.add(&name, false, |grower| grower.tree(of_name(&name).powers, depth), f64::is_finite)?;
        }
        for input in self.by_formula.clone() {
            let input = self.model.inputs[input].clone();
            let (measured, valid) = (of_name(&input.name), input.valid);
            let curve = self.walker.curves.iter().find(|it| it.y == input.name).cloned();
            let (low, high) = (measured.to_si(input.usual.0), measured.to_si(input.usual.1));
            let draw = |grower: &mut Grower<'_>| given_tree(grower, &input, (low, high), curve.as_ref());
            let likes = |value: f64| valid.contains(measured.of_si(value)) && value >= low * 0.5 && value <= high * 1.5;
            self.add(&input.name, false, draw, likes)?;
        }
        Some(())
    }

    /// Evaluates the model at the samples; `None` where hardly any has a meaning.
    fn model(&mut self) -> Option<()> {
        for numbers in &mut self.samples {
            let given = |input: &beltspace::models::Input| match numbers[&input.name] {
                Held::Value(si) => of_name(&input.name).of_si(si),
                Held::Word(word) => word,
                _ => f64::NAN,
            };
            let given: Vec<f64> = self.model.inputs.iter().map(given).collect();
            let valid = self.model.inputs.iter().zip(&given).all(|(input, &value)| input.accepts(value));
            let evaluation = valid.then(|| evaluate(&self.model, &given));
            self.good.push(evaluation.as_ref().is_some_and(|it| it.status == Status::Ok));
            for (at, output) in self.model.outputs.iter().enumerate() {
                let value = evaluation.as_ref().and_then(|it| it.outputs[at]);
                let held = value.map_or(Held::Absent, |value| Held::Value(self.walker.si(&output.name, value)));
                numbers.insert(output.name.clone(), held);
            }
        }
        (2 * self.good.iter().filter(|it| **it).count() > SAMPLES).then_some(())
    }

    fn after(&mut self) -> Option<()> {
        for number in 0..self.random.whole(1, 4) {
            let name = format!("after_{number}{}", self.random.pick(&SUFFIXES));
            let depth = self.random.whole(1, 3);
            self.add(&name, true, |grower| grower.tree(of_name(&name).powers, depth), f64::is_finite)?;
        }
        Some(())
    }

    /// A formula for every variable that nothing reads so far: a study refuses it otherwise.
    fn use_variables(&mut self) -> Option<()> {
        for variable in self.variables.clone() {
            let is_read = |it: &Named| it.tree.names().contains(&variable.as_str());
            if self.walker.formulas.iter().any(is_read) {
                continue;
            }
            let name = variable.replace("given_", "of_");
            let draw = |grower: &mut Grower<'_>| {
                let factor = grower.tree(super::measure::PLAIN, 1);
                Tree::binary('*', Tree::name(&variable), factor)
            };
            self.add(&name, true, draw, f64::is_finite)?;
        }
        Some(())
    }
}

/// What gives an input of the model: mostly within what is usual of it.
fn given_tree(grower: &mut Grower<'_>, input: &beltspace::models::Input, (low, high): (f64, f64), curve: Option<&Curve>) -> Tree {
    let powers = of_name(&input.name).powers;
    if input.integer {
        let of = grower.whole(2);
        let (low, high) = (Tree::Number(low.ceil(), None), Tree::Number(high.floor(), None));
        return match grower.random.below(3) {
            0 => Tree::Call("clamp", vec![of, low, high]),
            1 => Tree::Call("max", vec![of, low]),
            _ => of,
        };
    }
    if let Some(curve) = curve.filter(|_| grower.random.chance(0.7)) {
        let x = of_name(&curve.x);
        let of = grower.tree(x.powers, 1);
        let (first, last) = (x.to_si(curve.points[0].0), x.to_si(curve.points[curve.points.len() - 1].0));
        let ends = [grower.number(x.powers, first + 0.01 * (last - first)), grower.number(x.powers, last - 0.01 * (last - first))];
        let kept = grower.random.chance(0.5);
        let at = if kept { Tree::Call("clamp", [vec![of], ends.to_vec()].concat()) } else { of };
        if !at.is_constant() {
            return Tree::Curve(curve.name.clone(), Box::new(at));
        }
    }
    let middle = grower.random.between(0.7 * low + 0.3 * high, 0.3 * low + 0.7 * high);
    match grower.random.below(3) {
        0 => {
            let of = grower.tree(powers, 2);
            let ends = [grower.number(powers, low), grower.number(powers, high)];
            Tree::Call("clamp", [vec![of], ends.to_vec()].concat())
        }
        1 => {
            let swing = Tree::Call("tanh", vec![grower.tree(super::measure::PLAIN, 2)]);
            let (half, middle) = (grower.number(powers, 0.4 * (high - low)), grower.number(powers, middle));
            Tree::binary('+', middle, Tree::binary('*', half, swing))
        }
        _ => {
            let size = grower.number(powers, middle);
            let factor = grower.tree(super::measure::PLAIN, 2);
            Tree::binary('*', size, factor)
        }
    }
}
