//! The plan of a sweep: which axes are slow and which are fast, what is tracked over the scenarios, and where each value comes from.
//!
//! The dependencies come from the recorded formula. Design axes that `prepare` reads are slow, the others fast; a *row* is one combination
//! of the slow axes with all combinations of the fast ones. An output that depends on no fast design axis is one number for the whole row,
//! so it is evaluated once per row and scenario and never in the inner loop.

use crate::models::{Dependencies, Effort, Worse, input_to_si};
use crate::space::{Product, Space};
pub use crate::study::worst_end;
use crate::study::{Axis, OverScenarios, Quantity, Spectrum, Study};
use crate::tape::{Known, Set};

/// Most combinations of the fast design axes in a row, so that their values fit into a table.
pub const FAST_DESIGNS: u64 = 1 << 15;

/// Most parts of a thread's share of designs, and its fewest rows where parts are whole rows.
const PARTS: usize = 16;
const ROWS: usize = 4;

/// Most bytes of prepared numbers that a thread keeps for a row.
const KEPT_BYTES: u64 = 256 << 20;
/// Most slow scenarios for which it keeps them.
const KEPT_SCENARIOS: u64 = 1 << 15;

/// A quantity whose worst scenario is tracked, with the end that is worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tracked {
    /// The quantity.
    pub quantity: Quantity,
    /// Which end of its range is the worst.
    pub worse: Worse,
    /// What becomes of its values over the scenarios.
    pub over: OverScenarios,
}

impl Tracked {
    /// A quantity in the worst of all scenarios.
    pub fn worst(quantity: Quantity, worse: Worse) -> Self {
        Self { quantity, worse, over: OverScenarios::Worst }
    }
}

/// Where a value in a row comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// An input that is the same for the whole row.
    RowInput(usize),
    /// An output that is the same for the whole row.
    RowOutput(usize),
    /// An input that a fast design axis sets; it is the same in every scenario.
    LaneInput(usize),
    /// An output that differs within the row: its position among [`Plan::lane_outputs`].
    LaneOutput(usize),
}

impl Source {
    /// Is the value the same for all designs of a row?
    pub fn is_row(self) -> bool {
        matches!(self, Self::RowInput(_) | Self::RowOutput(_))
    }
}

/// How the cases of a spectrum are summed while the sweep walks through the scenarios.
///
/// Its axis is the innermost of the slow or of the fast scenario axes. So the cases come in order for every scenario of the other axes,
/// and few sums are under way at a time.
#[derive(Debug)]
pub struct SpectrumPlan {
    /// The weight of each case.
    pub weights: Vec<f64>,
    /// The sum of the weights.
    pub total: f64,
    /// Is its axis among the slow ones?
    pub is_slow: bool,
    /// Sums of one value that are under way at a time.
    pub under_way: u64,
    /// Distance of two cases in the study's index of scenarios.
    pub stride: u64,
    /// The values that are summed during the sweep, each once.
    pub sums: Vec<Source>,
}

/// Where a scenario stands in the sum over its cases.
#[derive(Clone, Copy, Debug)]
pub struct CasePlace {
    /// Number of the case.
    pub case: usize,
    /// Its weight.
    pub weight: f64,
    /// Is it the last case, after which the sum is known?
    pub is_last: bool,
    /// Which of the sums under way it belongs to.
    pub slot: u64,
}

impl SpectrumPlan {
    /// The place of a slow and a fast scenario.
    pub fn place(&self, (slow, fast): (u64, u64)) -> CasePlace {
        let cases = self.weights.len();
        let (along, slot) = if self.is_slow { (slow, fast) } else { (fast, 0) };
        let case = (along % cases as u64) as usize;
        CasePlace { case, weight: self.weights[case], is_last: case + 1 == cases, slot }
    }

    /// The weight of a scenario of the study.
    pub fn weight_of(&self, scenario: u64) -> f64 {
        self.weights[(scenario / self.stride % self.weights.len() as u64) as usize]
    }

    /// The number of the sum of this value.
    ///
    /// # Panics
    /// If the plan does not sum it.
    pub fn number(&self, source: Source) -> usize {
        self.sums.iter().position(|&it| it == source).expect("the plan sums what a mean or sum is asked of")
    }
}

/// A study with its plan for sweeping.
#[derive(Debug)]
pub struct Plan {
    /// The study.
    pub study: Study,
    /// Its designs and scenarios.
    pub space: Space,
    /// Design axes that `prepare` reads.
    pub slow: Product,
    /// The other design axes.
    pub fast: Product,
    /// Scenario axes that `prepare` reads.
    pub slow_scenarios: Product,
    /// The other scenario axes.
    pub fast_scenarios: Product,
    /// The sums over the cases of a spectrum, if the study has one.
    pub spectrum: Option<SpectrumPlan>,
    /// Quantities whose worst value is needed during the sweep, without duplicates.
    pub tracked: Vec<(Tracked, Source)>,
    /// Positions of the objectives among `tracked`.
    pub objectives: Vec<usize>,
    /// Source of each constraint.
    pub constraints: Vec<Source>,
    /// Outputs evaluated once per row and scenario.
    pub row_outputs: Set,
    /// Outputs evaluated for every design and scenario.
    pub lane_outputs: Vec<usize>,
    /// Conditions that are the same for the whole row.
    pub row_conditions: Vec<usize>,
    /// Conditions evaluated for every design and scenario.
    pub lane_conditions: Vec<usize>,
    /// Which inputs each output and condition depends on.
    pub dependencies: Dependencies,
}

/// The worst end: that of the objective, else that of the report's use of the quantity, else that of the model.
fn quantities_to_track(study: &Study, further: &[Tracked]) -> Vec<Tracked> {
    let mut tracked: Vec<Tracked> = Vec::new();
    let mut track = |entry| {
        if !tracked.contains(&entry) {
            tracked.push(entry);
        }
    };
    for objective in &study.objectives {
        track(Tracked { quantity: objective.quantity, worse: objective.goal.worse(), over: objective.over });
    }
    for (quantity, worse) in study.report.followed(study) {
        track(Tracked::worst(quantity, worse));
    }
    further.iter().copied().for_each(track);
    tracked
}

impl Plan {
    /// The texts of the study's labels for a design, in the order of the labels.
    pub fn labels(&self, design: u64) -> impl Iterator<Item = &str> {
        self.study.labels.iter().map(move |label| {
            let row = usize::try_from(self.space.level(label.axis, design)).expect("rows are held in memory");
            label.texts[row].as_str()
        })
    }

    /// Plans a study.
    pub fn new(study: Study) -> Self {
        Self::following(study, &[])
    }

    /// The same where further values are followed. A design that has none of one of these counts as infeasible.
    pub(crate) fn following(study: Study, further: &[Tracked]) -> Self {
        let space = Space::new(&study);
        let dependencies = study.model.kernel.dependencies(&knowns(&study, &space));
        let (slow, fast) = space.designs.split(dependencies.prepared);
        // The values of the fast axes are tabulated: axes that would make the table too large are treated like slow ones.
        let (outer, fast) = fast.narrow(FAST_DESIGNS);
        let slow = slow.with(&outer);
        let scenarios = space.scenarios.split(dependencies.prepared);
        let (slow_scenarios, fast_scenarios) = with_cases_inside(&study, scenarios);
        let lane_inputs = fast.inputs();
        let mut row_outputs = Set::EMPTY;
        let mut lane_outputs = Vec::new();
        let mut used_outputs = Set::EMPTY;
        let mut source = |quantity| match quantity {
            Quantity::Input(input) if lane_inputs.contains(input) => Source::LaneInput(input),
            Quantity::Input(input) => Source::RowInput(input),
            Quantity::Output(output) => {
                used_outputs.insert(output);
                if !dependencies.outputs[output].meets(lane_inputs) {
                    row_outputs.insert(output);
                    Source::RowOutput(output)
                } else {
                    let position = lane_outputs.iter().position(|&it| it == output).unwrap_or_else(|| {
                        lane_outputs.push(output);
                        lane_outputs.len() - 1
                    });
                    Source::LaneOutput(position)
                }
            }
        };
        let tracked: Vec<_> = quantities_to_track(&study, further).into_iter().map(|it| (it, source(it.quantity))).collect();
        let constraints: Vec<Source> = study.constraints.iter().map(|constraint| source(constraint.quantity)).collect();
        let spectrum = spectrum_plan(&study, &tracked, &constraints, (&slow_scenarios, &fast_scenarios));
        let objectives = study.objectives.iter().map(|objective| {
            let wanted = Tracked { quantity: objective.quantity, worse: objective.goal.worse(), over: objective.over };
            tracked.iter().position(|(it, _)| *it == wanted).expect("every objective is tracked")
        });
        let objectives = objectives.collect();
        // A quiet condition matters only if it invalidates an output that is used.
        let model = &study.model;
        let matters = |number: &usize| {
            let condition = &model.conditions[*number];
            !condition.quiet
                || condition.invalidates.iter().filter_map(|name| model.output(name)).any(|output| used_outputs.contains(output))
        };
        let (row_conditions, lane_conditions) =
            (0..model.conditions.len()).filter(matters).partition(|&number| !dependencies.conditions[number].meets(lane_inputs));
        Self {
            slow,
            fast,
            slow_scenarios,
            fast_scenarios,
            spectrum,
            tracked,
            objectives,
            constraints,
            row_outputs,
            lane_outputs,
            row_conditions,
            lane_conditions,
            dependencies,
            space,
            study,
        }
    }

    /// Position among [`Plan::tracked`] of a quantity whose worst value the study tracks.
    ///
    /// # Panics
    /// If it is not tracked.
    pub fn position(&self, quantity: Quantity, worse: Worse) -> usize {
        let wanted = Tracked::worst(quantity, worse);
        self.tracked.iter().position(|(it, _)| *it == wanted).expect("the plan tracks what the report needs")
    }

    /// Outputs that the study asks for.
    pub fn used_outputs(&self) -> Set {
        self.row_outputs | Set::of(&self.lane_outputs)
    }

    /// The spectrum whose weights are no input, so that they stand in a column of their own where scenarios are listed.
    pub fn listed_weights(&self) -> Option<(&Spectrum, &SpectrumPlan)> {
        let spectrum = self.study.spectrum.as_ref().filter(|it| self.study.model.input(&it.weight).is_none())?;
        Some((spectrum, self.spectrum.as_ref()?))
    }

    /// Number of designs.
    pub fn designs(&self) -> u64 {
        self.space.designs.count()
    }

    /// Number of scenarios.
    pub fn scenarios(&self) -> u64 {
        self.space.scenarios.count()
    }

    /// Outputs with the least value that a constraint on their worst asks for, and whether that is itself too little.
    pub(crate) fn least_values(&self) -> Vec<(usize, f64, bool)> {
        let constraints = self.study.constraints.iter().filter(|it| it.over.is_worst());
        constraints.filter_map(|it| it.quantity.output().zip(it.low)).map(|(output, (value, strict))| (output, value, strict)).collect()
    }

    /// Evaluations of the model that a design takes: its scenarios, and the draws and operating cases in each.
    pub fn evaluations(&self) -> u64 {
        self.scenarios().saturating_mul(self.study.probability.as_ref().map_or(1, |it| it.evaluations()))
    }

    /// Seconds that a thread takes over all scenarios, by the model's own figures: for the first stage of a row and the second of a design.
    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    pub fn effort(&self) -> Effort {
        let Effort { prepare, finish } = self.study.model.effort;
        Effort { prepare: prepare * self.slow_scenarios.count() as f64, finish: finish * self.scenarios() as f64 }
    }

    /// Seconds that a thread takes per design, by the model's own figures, if whole rows are judged.
    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    pub fn seconds_per_design(&self) -> f64 {
        let Effort { prepare, finish } = self.effort();
        prepare / self.fast.count() as f64 + finish
    }

    /// Must each shard judge the sample itself? Yes, if the study leaves the range of a histogram to the sample.
    pub fn shards_sample(&self) -> bool {
        self.study.report.histograms.iter().any(|it| it.range.is_none())
    }

    /// Number of slow scenarios, from the first, whose prepared numbers a thread keeps for all designs of a row.
    pub fn kept_scenarios(&self) -> u64 {
        let bytes = 8 * self.study.model.kernel.prepared_len().max(1) as u64;
        self.slow_scenarios.count().min(KEPT_SCENARIOS).min(KEPT_BYTES / bytes)
    }

    /// The design index at a position of the sweep: rows of the slow axes outside, the fast axes inside.
    pub fn design_at(&self, position: u64) -> u64 {
        let fast = self.fast.count();
        self.slow.source_index(position / fast) + self.fast.source_index(position % fast)
    }

    /// The position of a design index in the sweep.
    pub fn position_of(&self, design: u64) -> u64 {
        self.slow.index_of(design) * self.fast.count() + self.fast.index_of(design)
    }

    /// Sorted positions in parts for so many threads: whole rows, of which some may take far longer than others, or one part for each thread
    /// where there are few rows.
    pub(crate) fn parts<'s>(&self, positions: &'s [u64], threads: usize) -> Vec<&'s [u64]> {
        let (threads, width) = (threads.max(1), self.fast.count());
        let rows: Vec<&[u64]> = positions.chunk_by(|a, b| a / width == b / width).collect();
        if rows.len() < ROWS * threads {
            return positions.chunks(positions.len().div_ceil(threads).max(1)).collect();
        }
        let share = positions.len().div_ceil(PARTS * threads);
        let mut parts = Vec::new();
        let (mut first, mut last) = (0, 0);
        for row in rows {
            last += row.len();
            if last - first >= share || last == positions.len() {
                parts.push(&positions[first..last]);
                first = last;
            }
        }
        parts
    }

    /// A position for every step, spread evenly over the study after any number of steps.
    pub fn spread(&self, step: u64) -> u64 {
        spread(self.designs(), step)
    }

    /// Positions of the design axes that affect nothing that the study asks for.
    pub fn inert_axes(&self) -> Vec<usize> {
        let study = &self.study;
        let asked = self.tracked.iter().map(|(it, _)| it.quantity);
        let asked = asked.chain(study.constraints.iter().map(|it| it.quantity)).chain(study.report.columns.iter().map(|it| it.of));
        let quantities = asked.map(|quantity| match quantity {
            Quantity::Input(input) => Set::one(input),
            Quantity::Output(output) => self.dependencies.outputs[output],
        });
        let conditions = self.row_conditions.iter().chain(&self.lane_conditions).map(|&condition| self.dependencies.conditions[condition]);
        let mattering: Set = quantities.chain(conditions).collect();
        let shown = study.report.axes();
        let inert = |axis: &usize| study.design[*axis].inputs().iter().all(|&input| !mattering.contains(input));
        (0..study.design.len()).filter(inert).filter(|axis| !shown.contains(axis)).collect()
    }
}

/// A place among `count` for every step, spread evenly after any number of steps: multiples of the golden section.
pub fn spread(count: u64, step: u64) -> u64 {
    ((u128::from(count) * u128::from(step.wrapping_mul(0x9e37_79b9_7f4a_7c15))) >> 64) as u64
}

/// Most sums of one value over the cases of a spectrum that are under way at a time.
const MOST_UNDER_WAY: u64 = 256;

/// Slow and fast scenario axes, with the cases of a spectrum innermost. Fast axes that would keep too many sums under way are treated like
/// slow ones.
fn with_cases_inside(study: &Study, (slow, fast): (Product, Product)) -> (Product, Product) {
    let Some(spectrum) = &study.spectrum else { return (slow, fast) };
    let inputs: Set = study.operation[spectrum.axis].inputs().iter().collect();
    let inside = |product: &Product| {
        let (cases, others) = product.split(inputs);
        (others, cases)
    };
    if !slow.inputs().meets(inputs) {
        let (others, cases) = inside(&fast);
        return (slow, others.with(&cases));
    }
    let (others, cases) = inside(&slow);
    let (outer, inner) = fast.narrow(MOST_UNDER_WAY);
    // One axis alone may be too long.
    let too_long = if inner.count() > MOST_UNDER_WAY { inner.inputs() } else { Set::EMPTY };
    let (long, inner) = inner.split(too_long);
    (others.with(&outer).with(&long).with(&cases), inner)
}

fn spectrum_plan(
    study: &Study,
    tracked: &[(Tracked, Source)],
    constraints: &[Source],
    (slow, fast): (&Product, &Product),
) -> Option<SpectrumPlan> {
    let spectrum = study.spectrum.as_ref()?;
    let inputs: Set = study.operation[spectrum.axis].inputs().iter().collect();
    let of_constraints = study.constraints.iter().zip(constraints).filter(|(it, _)| !it.over.is_worst()).map(|(_, &source)| source);
    let of_tracked = tracked.iter().filter(|(it, _)| !it.over.is_worst()).map(|&(_, source)| source);
    let mut sums = Vec::new();
    for source in of_tracked.chain(of_constraints) {
        if !sums.contains(&source) {
            sums.push(source);
        }
    }
    let is_slow = slow.inputs().meets(inputs);
    let inner = study.operation[spectrum.axis + 1..].iter().chain(&study.uncertainty).map(Axis::count);
    Some(SpectrumPlan {
        weights: spectrum.weights.clone(),
        total: spectrum.total(),
        is_slow,
        under_way: if is_slow { fast.count() } else { 1 },
        stride: inner.product(),
        sums,
    })
}

/// The inputs of a study: fixed numbers, or ranges that an axis covers.
pub(crate) fn knowns(study: &Study, space: &Space) -> Vec<Known> {
    let si = |input: usize, value: f64| input_to_si(&study.model.inputs[input], value);
    let mut inputs: Vec<Known> = study.fixed.iter().enumerate().map(|(input, &value)| Known::Fixed(si(input, value))).collect();
    for product in [&space.designs, &space.scenarios] {
        product.for_each_range(|input, (least, largest)| inputs[input] = Known::Within(si(input, least), si(input, largest)));
    }
    inputs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::study_of;

    #[test]
    fn parts_are_whole_rows_unless_there_are_few() {
        let plan = |angles: u64| {
            let text = format!(
                "[design]\ngroove_angle_deg = {{ from = 18, to = 30, count = {angles} }}\nband_count = {{ from = 4, to = 14 }}\n\
                 [objectives]\naxial_force_N = \"min\""
            );
            Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right"))
        };
        let (many, few) = (plan(200), plan(3));
        let width = many.fast.count();
        assert!(width > 1 && many.slow.count() == 200, "a row is an angle");
        // Of each row every third design.
        let positions: Vec<u64> = (0..many.designs()).filter(|it| it % 3 == 0).collect();
        for threads in [1, 2, 5] {
            let parts = many.parts(&positions, threads);
            assert_eq!(parts.concat(), positions);
            assert!(parts.len() > 4 * threads && parts.len() <= 16 * threads, "{} parts", parts.len());
            assert!(parts.windows(2).all(|it| it[0].last().map(|it| it / width) < it[1].first().map(|it| it / width)));
        }
        let positions: Vec<u64> = (0..few.designs()).collect();
        let parts = few.parts(&positions, 2);
        assert_eq!((parts.len(), parts.concat()), (2, positions));
        assert!(few.parts(&[], 2).is_empty() && many.parts(&[7], 0) == [[7]]);
    }
}
