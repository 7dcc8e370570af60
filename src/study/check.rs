//! Checks of every study, whether it was read from a text, a result's description or a checkpoint.
//!
//! The reader of study files reports mistakes line by line. Here the resulting numbers are checked once more, so that a study from a
//! file that somebody changed cannot ask for anything that a study file could not.

use super::axis::{Axis, Levels, Sample};
use super::label::{Label, MOST_LABELS, flaw_of_name, flaw_of_text};
use super::limits::{MOST_PICTURES, MOST_ROWS, MOST_THRESHOLDS, MOST_VALUES};
use super::quantity::Quantity;
use super::read::{
    BINS, FRONT_BUDGET, MOST_CELLS, MOST_FEASIBLE, MOST_LEVELS, MOST_OBJECTIVES, MOST_SAMPLE, MOST_SCENARIOS, MOST_TOP, MOST_VARIANTS,
    check_levels,
};
use super::resolved::{Best, Constraint, ContourSpec, MapSpec, Report, Study, Thresholds};
use super::spectrum::OverScenarios;
use crate::models::{Model, Set};
use std::collections::HashSet;

/// Most cells of all maps of a study together.
const MOST_CELLS_IN_ALL: u64 = 2 * MOST_CELLS;

type CheckResult = Result<(), String>;

fn require(good: bool, problem: impl FnOnce() -> String) -> CheckResult {
    if good { Ok(()) } else { Err(problem()) }
}

impl Study {
    /// Could a study file ask for this? The model has every input and output, inputs accept their values, designs and scenarios can be
    /// numbered, and what is reported fits into memory.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check(&self) -> Result<(), String> {
        self.check_parts()?;
        let Report { top, sample, variants, feasible, histograms, maps, .. } = &self.report;
        let lists = top.is_some() || sample.is_some() || *variants || *feasible;
        let asks = !self.objectives.is_empty() || lists || !histograms.is_empty() || !maps.is_empty();
        require(asks, || "the study asks for nothing".to_owned())?;
        if let Some(flaw) = self.report.sensitivity.as_ref().and_then(|spec| self.flaws_of_sensitivity(spec).into_iter().next()) {
            return Err(flaw.message);
        }
        // The drive of a draw is asked nothing of its own.
        if self.probability.is_some() { self.of_one_draw().check_parts() } else { Ok(()) }
    }

    /// Everything but that something is asked.
    fn check_parts(&self) -> CheckResult {
        let model = &self.model;
        let inputs = &model.inputs;
        require(self.fixed.len() == inputs.len(), || format!("there are {} fixed values for {} inputs", self.fixed.len(), inputs.len()))?;
        for (input, &value) in inputs.iter().zip(&self.fixed) {
            require(input.accepts(value), || format!("{} cannot be {value:e}", input.name))?;
        }
        require(!self.design.is_empty(), || "there is nothing to choose; name at least one input in [design]".to_owned())?;
        let mut taken = HashSet::new();
        self.check_labels()?;
        for (number, axis) in self.axes().enumerate() {
            let labels: Vec<_> = self.labels.iter().filter(|it| it.axis == number).collect();
            check_axis(model, axis, &labels, &mut taken)?;
        }
        self.check_sizes()?;
        self.check_spectrum()?;
        let (number, most) = (self.constraints.len(), Set::SIZE);
        require(number <= most, || format!("there are {number} constraints, at most {most} are possible"))?;
        let mut seen = HashSet::new();
        for it in &self.constraints {
            self.check_over(it.quantity, it.over)?;
            let name = it.name(model);
            require(seen.insert((it.quantity, it.over)), || format!("\"{name}\" is constrained twice"))?;
            check_bounds(it).map_err(|problem| format!("constraint \"{name}\": {problem}"))?;
        }
        require(self.objectives.len() <= MOST_OBJECTIVES, || {
            format!("the study has {} objectives, at most {MOST_OBJECTIVES} are possible", self.objectives.len())
        })?;
        seen.clear();
        for it in &self.objectives {
            self.check_over(it.quantity, it.over)?;
            let name = it.name(model);
            require(seen.insert((it.quantity, it.over)), || format!("\"{name}\" is an objective twice"))?;
            require(it.resolution.is_none_or(|it| it > 0.0 && it.is_finite()), || {
                format!("objective \"{name}\": its resolution must be greater than 0")
            })?;
        }
        self.check_report(&self.report)
    }

    /// All axes.
    fn axes(&self) -> impl Iterator<Item = &Axis> {
        self.design.iter().chain(&self.operation).chain(&self.uncertainty)
    }

    /// Does every label have a name of its own, and a text for every row of a joint design axis?
    fn check_labels(&self) -> CheckResult {
        require(self.labels.len() <= MOST_LABELS, || format!("there are {} labels, at most {MOST_LABELS} fit", self.labels.len()))?;
        let mut known = HashSet::new();
        for Label { name, axis, texts } in &self.labels {
            let wrong = |problem: &str| format!("label \"{name}\": {problem}");
            require(known.insert(name), || wrong("it is there twice"))?;
            flaw_of_name(name, &self.model).map_or(Ok(()), |flaw| Err(wrong(&flaw)))?;
            let rows = match self.design.get(*axis) {
                Some(Axis::Joint { rows, .. }) => rows.len(),
                _ => return Err(wrong("it is of no joint design axis")),
            };
            require(texts.len() == rows, || wrong(&format!("it has {} texts for {rows} rows", texts.len())))?;
            texts.iter().find_map(|text| flaw_of_text(text)).map_or(Ok(()), |flaw| Err(wrong(&flaw)))?;
        }
        // So that the order of the columns is that of the axes.
        require(self.labels.is_sorted_by_key(|it| it.axis), || "the labels are not in the order of their axes".to_owned())
    }

    /// Can designs and scenarios be numbered?
    fn check_sizes(&self) -> CheckResult {
        let product = |axes: &mut dyn Iterator<Item = &Axis>| axes.map(Axis::count).try_fold(1, u64::checked_mul);
        match self.sample {
            Some(Sample { count, .. }) => {
                require((1..=MOST_LEVELS).contains(&count), || {
                    format!("{count} designs cannot be sampled; count must be 1 to {MOST_LEVELS}")
                })?;
            }
            None => {
                require(product(&mut self.design.iter()).is_some(), || "the space has more designs than can be numbered".to_owned())?;
            }
        }
        let continuous = |axis: &Axis| matches!(axis, Axis::Single { levels: Levels::Continuous { .. }, .. });
        let sampled = if self.sample.is_some() { &self.design[..] } else { &[] };
        let unruled = self.axes().filter(|axis| continuous(axis)).count() - sampled.iter().filter(|axis| continuous(axis)).count();
        require(unruled == 0, || "a range has neither count nor step, and is not sampled".to_owned())?;
        let scenarios = product(&mut self.operation.iter().chain(&self.uncertainty));
        require(scenarios.is_some_and(|it| it <= MOST_SCENARIOS), || {
            format!("[operation] and [uncertainty] make more than {MOST_SCENARIOS} scenarios")
        })
    }

    /// Is this a quantity of the model whose values are all numbers?
    fn check_quantity(&self, quantity: Quantity) -> CheckResult {
        let model = &self.model;
        let number = match quantity {
            Quantity::Input(number) => number,
            Quantity::Output(number) => {
                return require(number < model.outputs.len(), || format!("{} has no output number {number}", model.name));
            }
        };
        let input = model.inputs.get(number).ok_or_else(|| format!("{} has no input number {number}", model.name))?;
        let is_word = |value: f64| input.word_for(value).is_some();
        let of_axis = self.axes().find_map(|axis| Some((axis, axis.inputs().iter().position(|&it| it == number)?)));
        let words = input.is_enumeration()
            || match of_axis {
                Some((Axis::Single { levels: Levels::List(values), .. }, _)) => values.iter().copied().any(is_word),
                Some((Axis::Single { .. }, _)) => false,
                Some((Axis::Joint { rows, .. }, column)) => rows.iter().any(|row| is_word(row[column])),
                None => is_word(self.fixed[number]),
            };
        require(!words, || format!("\"{}\" takes words, which have no order", input.name))
    }

    /// Is it an input that a design axis sets?
    fn is_chosen(&self, quantity: Quantity) -> bool {
        matches!(quantity, Quantity::Input(input) if self.design.iter().any(|axis| axis.inputs().contains(&input)))
    }

    /// Weights belong to the cases of a joint axis.
    fn check_spectrum(&self) -> CheckResult {
        let Some(spectrum) = &self.spectrum else { return Ok(()) };
        let cases = match self.operation.get(spectrum.axis) {
            Some(Axis::Joint { rows, .. }) => rows.len(),
            _ => return Err("the weighted axis is no joint axis of [operation]".to_owned()),
        };
        let weights = &spectrum.weights;
        require(weights.len() == cases, || format!("there are {} weights for {cases} cases", weights.len()))?;
        require(weights.iter().all(|it| it.is_finite() && *it >= 0.0), || "a weight is not a finite number of at least 0".to_owned())?;
        require(spectrum.total() > 0.0 && spectrum.total().is_finite(), || "the weights add up to nothing, or beyond any number".to_owned())
    }

    /// The same as [`Study::check_quantity`], and a mean or sum must have weights.
    fn check_over(&self, quantity: Quantity, over: OverScenarios) -> CheckResult {
        self.check_quantity(quantity)?;
        let name = quantity.name(&self.model);
        let word = over.word();
        require(over.is_worst() || self.spectrum.is_some(), || format!("the {word} of \"{name}\" needs an axis with weights"))?;
        require(over.is_worst() || !self.is_chosen(quantity), || format!("\"{name}\" is a design input, the same in every case"))?;
        let column = over.column(quantity, &self.model);
        let taken = self.model.output(&column).is_some() || self.model.input(&column).is_some();
        require(over.is_worst() || !taken, || format!("the {word} of \"{name}\" would have the name of another quantity, {column}"))
    }

    fn check_report(&self, report: &Report) -> CheckResult {
        let mut seen = HashSet::new();
        for column in &report.columns {
            self.check_over(column.of, column.over)?;
            let name = column.over.column(column.of, &self.model);
            require(!self.is_chosen(column.of), || format!("columns: \"{name}\" is a design input, which the tables have anyway"))?;
            let taken = column.worst.map(|end| format!("{name}_{}", end.word())).filter(|it| self.model.output(it).is_some());
            require(taken.is_none(), || format!("columns: \"{name}\" at one end would have the name of another quantity"))?;
            require(seen.insert(column), || format!("columns: \"{name}\" is listed twice"))?;
        }
        if let Some(top) = report.top {
            self.check_quantity(top.by)?;
            require((1..=MOST_TOP).contains(&(top.count as u64)), || format!("top: count must be 1 to {MOST_TOP}"))?;
        }
        if let Some(sample) = report.sample {
            require((1..=MOST_SAMPLE).contains(&(sample.count as u64)), || format!("sample: count must be 1 to {MOST_SAMPLE}"))?;
        }
        let (histograms, maps) = (&report.histograms, &report.maps);
        require(histograms.len().max(maps.len()) <= MOST_PICTURES, || format!("there are more than {MOST_PICTURES} histograms or maps"))?;
        for it in histograms {
            self.check_quantity(it.of)?;
            require((1..=BINS.1).contains(&(it.bins as u64)), || format!("histograms: bins must be 1 to {}", BINS.1))?;
            let range = it.range.is_none_or(|(low, high)| low < high && (high - low).is_finite());
            require(range, || "histograms: from must be less than to".to_owned())?;
        }
        let mut cells = 0;
        for it in maps {
            cells += self.check_map(it).map_err(|problem| format!("maps: {problem}"))?;
        }
        require(cells <= MOST_CELLS_IN_ALL, || {
            format!("maps: they have {cells} cells together, at most {MOST_CELLS_IN_ALL} fit; use fewer levels or fewer maps")
        })?;
        require((1..=FRONT_BUDGET.1).contains(&report.front_budget), || format!("front_budget must be 1 to {}", FRONT_BUDGET.1))?;
        let designs = self.design.iter().fold(1, |product: u64, axis| product.saturating_mul(axis.count()));
        require(!report.variants || (self.sample.is_none() && designs <= MOST_VARIANTS), || {
            format!("variants: a list of all is for grids of at most {MOST_VARIANTS} designs")
        })?;
        let all = self.sample.map_or(designs, |sample| sample.count);
        require(!report.feasible || all <= MOST_FEASIBLE, || {
            format!("feasible: all feasible designs are written of studies of at most {MOST_FEASIBLE} designs")
        })?;
        Ok(())
    }

    /// The number of cells.
    fn check_map(&self, map: &MapSpec) -> Result<u64, String> {
        require(self.sample.is_none(), || "sampled designs lie on no grid".to_owned())?;
        require(map.x != map.y, || "x and y are the same axis".to_owned())?;
        for axis in [map.x, map.y] {
            require(matches!(self.design.get(axis), Some(Axis::Single { .. })), || {
                format!("number {axis} is no design axis of one input")
            })?;
        }
        let cells = self.design[map.x].count().checked_mul(self.design[map.y].count()).filter(|&it| it <= MOST_CELLS);
        let cells = cells.ok_or_else(|| format!("one has more than {MOST_CELLS} cells; use fewer levels or choose other axes"))?;
        if let Best::Value(quantity, _) = map.value {
            self.check_quantity(quantity)?;
        }
        let mut seen = HashSet::new();
        for it in &map.contours {
            require(seen.insert(it.of), || "contours: a quantity is listed twice".to_owned())?;
            self.check_contours(map, it).map_err(|problem| format!("contours: {problem}"))?;
        }
        Ok(cells)
    }

    /// Contours need a plane: two axes of numbers in order, and no other design axis.
    fn check_contours(&self, map: &MapSpec, contours: &ContourSpec) -> CheckResult {
        self.check_quantity(contours.of)?;
        let varies = |(at, axis): (usize, &Axis)| ![map.x, map.y].contains(&at) && axis.count() > 1;
        require(!self.design.iter().enumerate().any(varies), || "the map's axes must be the only design axes".to_owned())?;
        for axis in [map.x, map.y].map(|axis| &self.design[axis]) {
            self.check_quantity(Quantity::Input(axis.inputs()[0]))?;
            let Axis::Single { levels: Levels::List(values), .. } = axis else { continue };
            require(values.is_sorted() || values.iter().rev().is_sorted(), || "the levels of an axis are not in order".to_owned())?;
        }
        match &contours.at {
            Thresholds::Changes => require(contours.of.is_whole(&self.model), || "only a whole number has changes".to_owned()),
            Thresholds::At(values) => {
                require((1..=MOST_THRESHOLDS).contains(&values.len()), || format!("there must be 1 to {MOST_THRESHOLDS} values"))?;
                require(values.iter().all(|it| it.is_finite()), || "a value is not finite".to_owned())
            }
        }
    }
}

/// An axis must set inputs that no other axis sets, to values that they accept. Rows may be equal if a label tells them apart.
fn check_axis(model: &Model, axis: &Axis, labels: &[&Label], taken: &mut HashSet<usize>) -> CheckResult {
    for &input in axis.inputs() {
        require(input < model.inputs.len(), || format!("{} has no input number {input}", model.name))?;
        require(taken.insert(input), || format!("\"{}\" is set twice", model.inputs[input].name))?;
    }
    let (first, problem) = match axis {
        Axis::Single { input, levels } => {
            let label = |problem| format!("axis \"{}\": {problem}", model.inputs[*input].name);
            check_levels(levels, &model.inputs[*input]).map_err(label)?;
            let Levels::List(values) = levels else { return Ok(()) };
            let mut known = HashSet::new();
            (*input, values.iter().any(|it| !known.insert((it + 0.0).to_bits())).then_some("a value is listed twice"))
        }
        Axis::Joint { inputs, rows } => {
            let first = *inputs.first().ok_or("a joint axis has no inputs")?;
            let taken = |row: &Vec<f64>| {
                row.len() == inputs.len() && inputs.iter().zip(row).all(|(&input, &value)| model.inputs[input].accepts(value))
            };
            let mut known = HashSet::new();
            let problem = if rows.is_empty() {
                Some("it has no rows")
            } else if rows.len() > MOST_ROWS || rows.len().saturating_mul(inputs.len()) > MOST_VALUES {
                Some("it has too many rows; split the study")
            } else if !rows.iter().all(taken) {
                Some("a row is not one of values that its inputs take")
            } else {
                let bits = |row: &Vec<f64>| row.iter().map(|it| (it + 0.0).to_bits()).collect::<Vec<_>>();
                let texts = |at: usize| labels.iter().map(|it| it.texts[at].as_str()).collect::<Vec<_>>();
                rows.iter().enumerate().any(|(at, row)| !known.insert((bits(row), texts(at)))).then_some("two rows are equal")
            };
            (first, problem)
        }
    };
    problem.map_or(Ok(()), |problem| Err(format!("axis \"{}\": {problem}", model.inputs[first].name)))
}

/// The bounds must allow some value.
fn check_bounds(constraint: &Constraint) -> CheckResult {
    let Constraint { low, high, .. } = *constraint;
    require(low.is_some() || high.is_some(), || "there are no bounds".to_owned())?;
    require(low.iter().chain(&high).all(|(bound, _)| bound.is_finite()), || "a bound is not finite".to_owned())?;
    let empty = low.zip(high).is_some_and(|((least, no_least), (most, no_most))| least > most || (least == most && (no_least || no_most)));
    require(!empty, || "no value keeps both bounds".to_owned())
}
