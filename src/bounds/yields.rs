//! Proven bounds of the yield of a design: boxes of draws over which the formula surely keeps, or surely violates, what a draw must keep.
//!
//! The formula is recorded with the design's values as constants and run over intervals with derivatives by the place within a box. Where
//! a number decides for a part of the box only, its value at one place and the bounds of its derivatives leave a slab between two planes in
//! which it may change sign: one side surely holds, the other surely fails, and the slab narrows with the square of the box.

use super::requirement::Test;
use crate::models::{Model, input_to_si};
use crate::plan::Plan;
use crate::probability::{
    CellVerdict, DIMENSIONS, Distribution, DrawCell, DrawCells, DrawnPoint, Effect, Enclosure, Judge, Margin, ProbabilityProblem, Slabs,
    enclose,
};
use crate::real::Real;
use crate::study::{Constraint, Quantity, StatisticKind, Study};
use crate::tape::{Dual, Interval, Known, List, Node, Operation, Set};
use crate::units::Unit;
use std::rc::Rc;
use std::sync::Arc;

/// Why the yield of a study's designs cannot be bounded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EnclosureProblem {
    /// The study has no distributions.
    #[error("enclosure: no input has a distribution, so that there is no yield; give an input of [uncertainty] a distribution")]
    NothingDrawn,
    /// More uncertain inputs than boxes can be divided along.
    #[error("enclosure: {inputs} inputs have distributions, and bounds of the yield are for at most {most}; drop enclosure, or give the others levels", most = DIMENSIONS)]
    Inputs {
        /// How many there are.
        inputs: usize,
    },
    /// The model is no formula.
    #[error("enclosure: {model} is no formula that could be bounded; drop enclosure")]
    NoFormula {
        /// The model.
        model: String,
    },
    /// A draw must keep a mean or sum over operating cases.
    #[error(
        "enclosure: the constraint on {constraint} is of a mean or sum over operating cases, which boxes of draws do not bound; drop enclosure or the constraint"
    )]
    Spectrum {
        /// What is constrained.
        constraint: String,
    },
    /// The width is none.
    #[error("enclosure: the bounds are to be {width} apart, and that must be between 0 and 1")]
    Width {
        /// What was asked for.
        width: f64,
    },
    /// There is no such design.
    #[error("enclosure: there is no design {design}; the study has {designs}, counted from 0")]
    Design {
        /// The number of the design.
        design: u64,
        /// How many there are.
        designs: u64,
    },
    /// The correlations are impossible.
    #[error(transparent)]
    Probability(#[from] ProbabilityProblem),
}

/// An input that is drawn: its number, what the drawn number does to it, and how likely it is.
pub type YieldInput = (usize, Effect, Distribution);

/// A study with distributions, laid out to bound the yields of its designs.
#[derive(Debug)]
pub struct YieldBounds {
    plan: Plan,
    inputs: Vec<YieldInput>,
    correlation: Vec<(usize, usize, f64)>,
    width: f64,
}

impl YieldBounds {
    /// Boxes that the proof of a design's yield may take: some seconds.
    pub const BOXES: u64 = 200_000;

    /// Lays out a study that asks for bounds; `None` if it does not.
    ///
    /// # Errors
    /// What stands in the way, see [`EnclosureProblem`].
    pub fn asked(study: &Study) -> Result<Option<Self>, EnclosureProblem> {
        let asks = study.probability.as_ref().is_some_and(|it| it.enclosure);
        asks.then(|| Self::new(study)).transpose()
    }

    /// Lays out a study.
    ///
    /// # Errors
    /// What stands in the way, see [`EnclosureProblem`].
    pub fn new(study: &Study) -> Result<Self, EnclosureProblem> {
        let probability = study.probability.as_ref().ok_or(EnclosureProblem::NothingDrawn)?;
        let inputs: Vec<YieldInput> = probability.inputs.iter().map(|it| (it.input, it.acts(), it.distribution.clone())).collect();
        let plan = Plan::new(study.of_one_draw());
        check(&plan, &inputs)?;
        // A tenth of what may miss the wanted yield, or of one in a thousand.
        let is_yield = |it: &&Constraint| it.quantity.output().is_some_and(|it| probability.statistics[it].kind == StatisticKind::Yield);
        let wanted =
            study.constraints.iter().find(is_yield).and_then(|it| Some(it.low?.0)).filter(|it| *it > 0.0 && *it < 1.0).unwrap_or(0.999);
        Ok(Self { plan, inputs, correlation: probability.correlation.clone(), width: 0.1 * (1.0 - wanted) })
    }

    /// How far apart the bounds should be, for the yield that the study asks for.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Bounds of the yield of a design.
    ///
    /// # Errors
    /// As [`enclose_yield`].
    pub fn of(&self, design: u64, width: f64, budget: u64) -> Result<Enclosure, EnclosureProblem> {
        enclose_yield(&self.plan, &self.inputs, &self.correlation, design, width, budget)
    }
}

fn check(plan: &Plan, inputs: &[YieldInput]) -> Result<(), EnclosureProblem> {
    let study = &plan.study;
    if inputs.is_empty() {
        return Err(EnclosureProblem::NothingDrawn);
    }
    if inputs.len() > DIMENSIONS {
        return Err(EnclosureProblem::Inputs { inputs: inputs.len() });
    }
    if study.model.kernel.formula().is_none() {
        return Err(EnclosureProblem::NoFormula { model: study.model.name.clone() });
    }
    match study.constraints.iter().find(|it| !it.over.is_worst()) {
        Some(it) => Err(EnclosureProblem::Spectrum { constraint: it.name(&study.model) }),
        None => Ok(()),
    }
}

/// Proven bounds of the yield of a design: of the probability that a draw has the status ok and keeps every constraint in all operating
/// cases, the least over all levels of what has no probability. They hold for the exact distributions, and both for exact arithmetic and
/// for what f64 computes of a drawn drive.
///
/// `plan` is of the drive of a single draw ([`Study::of_one_draw`]); `correlation` has pairs of positions in `inputs` with the correlation
/// of their normal scores. It ends when the bounds are `width` apart, a share from 0 to 1, or when another two boxes would be more than
/// `budget`; each level takes a box or a few in any case.
///
/// # Errors
/// What stands in the way, see [`EnclosureProblem`].
pub fn enclose_yield(
    plan: &Plan,
    inputs: &[YieldInput],
    correlation: &[(usize, usize, f64)],
    design: u64,
    width: f64,
    budget: u64,
) -> Result<Enclosure, EnclosureProblem> {
    check(plan, inputs)?;
    if !(0.0..=1.0).contains(&width) {
        return Err(EnclosureProblem::Width { width });
    }
    if design >= plan.designs() {
        return Err(EnclosureProblem::Design { design, designs: plan.designs() });
    }
    let question = (design, width, budget);
    match inputs.len() {
        1 => of_inputs::<1>(plan, inputs, correlation, question),
        2 => of_inputs::<2>(plan, inputs, correlation, question),
        3 => of_inputs::<3>(plan, inputs, correlation, question),
        _ => of_inputs::<4>(plan, inputs, correlation, question),
    }
}

fn of_inputs<const N: usize>(
    plan: &Plan,
    inputs: &[YieldInput],
    correlation: &[(usize, usize, f64)],
    (design, width, budget): (u64, f64, u64),
) -> Result<Enclosure, EnclosureProblem> {
    let model = &plan.study.model;
    let named: Vec<_> = inputs.iter().map(|it| (model.inputs[it.0].name.as_str(), &it.2)).collect();
    let cells = DrawCells::<N>::new(&named, correlation)?;
    let roots = cells.roots(width);
    let Some(mut judge) = DrawJudge::new(plan, inputs, design, cells) else {
        return Err(EnclosureProblem::NoFormula { model: model.name.clone() });
    };
    let open = judge.open();
    Ok(enclose(&mut judge, &roots, open, width, budget))
}

/// Where a number comes from that is required to be something.
#[derive(Clone, Copy, Debug)]
enum MarginSource {
    /// An input that is drawn, by position.
    Drawn(usize),
    /// An input that is not.
    Input(usize),
    /// An operation of the list.
    Node(Node),
}

/// What a draw must keep in an operating case.
#[derive(Debug)]
struct Required {
    source: MarginSource,
    /// Of the number; that of an operation without one is taken as it is.
    unit: Option<Unit>,
    test: Test,
    /// Must it be finite besides?
    finite: bool,
    /// Operations that it needs and that depend on what is drawn, in their order.
    needed: Vec<Node>,
}

/// Of a scenario, what is not settled over a box.
type OpenRequirements = Vec<(u32, Arc<[u16]>)>;

/// Numbers of the list over a box or at a place of it.
#[derive(Debug)]
struct Slots<R> {
    slots: Vec<R>,
    computed: Vec<u64>,
    clock: u64,
}

/// Judges boxes of draws of one design.
struct DrawJudge<'a, const N: usize> {
    model: &'a Model,
    inputs: &'a [YieldInput],
    cells: DrawCells<N>,
    list: List,
    required: Vec<Required>,
    /// Operations of the drawn inputs, by position.
    places: Vec<(Node, usize)>,
    /// Operations that depend on the scenario and not on what is drawn, and are read by others that do.
    loaded: Vec<Node>,
    /// Of every scenario: their values, and the design's values of the drawn inputs, in SI units.
    scenarios: Vec<(Box<[Interval]>, [f64; N])>,
    /// Of every scenario: inputs in their units.
    given: Vec<Vec<f64>>,
    levels: usize,
    over: Slots<Dual<Interval, N>>,
    at: Slots<Interval>,
}

impl<'a, const N: usize> DrawJudge<'a, N> {
    /// `None` if the model is no formula.
    fn new(plan: &'a Plan, inputs: &'a [YieldInput], design: u64, cells: DrawCells<N>) -> Option<Self> {
        let study = &plan.study;
        let model: &Model = &study.model;
        let drawn: Set = inputs.iter().map(|it| it.0).collect();
        let given: Vec<Vec<f64>> = (0..plan.scenarios()).map(|scenario| plan.space.inputs(design, scenario)).collect();
        let si: Vec<Vec<f64>> =
            given.iter().map(|given| model.inputs.iter().zip(given).map(|(input, &value)| input_to_si(input, value)).collect()).collect();
        let known: Vec<Known> = (0..model.inputs.len())
            .map(|input| {
                let ends = si.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (low.min(it[input]), high.max(it[input])));
                match ends {
                    _ if drawn.contains(input) => Known::ANY,
                    (low, high) if low == high => Known::Fixed(low),
                    (low, high) => Known::Within(low, high),
                }
            })
            .collect();
        let wanted = plan.used_outputs();
        let mattering: Set = plan.row_conditions.iter().chain(&plan.lane_conditions).collect();
        let whole = model.kernel.formula()?.whole(&known, wanted, mattering);
        let list = whole.list(wanted, mattering);
        let depends = list.dependencies(|input| Set::one(input.into()));
        let varies = |node: Node| depends[node as usize].meets(drawn);
        let (outputs, conditions) = list.results.split_at(whole.outputs.len());
        let required = required(plan, inputs, (outputs, conditions), |node| {
            list.needed_by(&[node]).into_iter().filter(|&node| varies(node)).collect()
        });
        let mut read = vec![false; list.operations.len()];
        list.results.iter().flatten().for_each(|&node| read[node as usize] = true);
        for node in (0..list.operations.len()).filter(|&node| !list.inner[node] && varies(node as Node)) {
            let mut mark = |operand: Node| read[operand as usize] = true;
            match list.operations[node] {
                Operation::Root(number) => list.outside(number, mark),
                operation => operation.operands(&mut mark),
            }
        }
        let fixed = (0..list.operations.len()).filter(|&node| !list.inner[node] && !varies(node as Node));
        let (constant, of_scenario): (Vec<usize>, Vec<usize>) = fixed.partition(|&node| depends[node].is_empty());
        let loaded: Vec<Node> = of_scenario.iter().copied().filter(|&node| read[node]).map(|node| node as Node).collect();
        let mut slots = vec![Interval::point(0.0); list.operations.len()];
        constant.iter().for_each(|&node| list.compute(node as Node, &mut slots));
        let mut scenario = |si: &Vec<f64>| -> (Box<[Interval]>, [f64; N]) {
            for &node in &of_scenario {
                match list.operations[node] {
                    Operation::Input(input) => slots[node] = Interval::point(si[usize::from(input)]),
                    _ => list.compute(node as Node, &mut slots),
                }
            }
            let nominal = std::array::from_fn(|it| si[inputs[it].0]);
            (loaded.iter().map(|&node| slots[node as usize]).collect(), nominal)
        };
        let scenarios = si.iter().map(&mut scenario).collect();
        let places = (0..list.operations.len()).filter_map(|node| match list.operations[node] {
            Operation::Input(input) => inputs.iter().position(|it| it.0 == usize::from(input)).map(|at| (node as Node, at)),
            _ => None,
        });
        let levels = study.uncertainty.iter().map(|axis| axis.count() as usize).product();
        Some(Self {
            model,
            inputs,
            cells,
            places: places.collect(),
            required,
            loaded,
            scenarios,
            given,
            levels,
            over: Slots::new(slots.iter().map(|&it| Dual::fixed(it)).collect()),
            at: Slots::new(slots),
            list,
        })
    }

    /// What is to be asked at every level: everything in all operating cases.
    fn open(&self) -> Vec<Rc<OpenRequirements>> {
        let all: Arc<[u16]> = (0..self.required.len() as u16).collect();
        // The levels vary fastest.
        let cases = |level: usize| (level..self.scenarios.len()).step_by(self.levels);
        (0..self.levels).map(|level| Rc::new(cases(level).map(|scenario| (scenario as u32, all.clone())).collect())).collect()
    }

    /// The actual value of a drawn input in SI units.
    fn actual<R: Real>(&self, position: usize, drawn: R, nominal: f64) -> R {
        let (input, effect, _) = &self.inputs[position];
        let (multiply, divide) = self.model.inputs[*input].unit.factors();
        let si = || scaled(scaled(drawn, multiply, false), divide, true);
        match effect {
            Effect::Is => si(),
            Effect::Times => R::constant(nominal) * drawn,
            Effect::Plus => R::constant(nominal) + si(),
        }
    }

    /// A number over the box or at a place of it, in the unit that it is asked for in.
    fn number<R: Real>(&self, slots: &mut Slots<R>, required: &Required, drawn: &[R; N], scenario: usize) -> R {
        let value = match required.source {
            MarginSource::Drawn(position) => self.actual(position, drawn[position], self.scenarios[scenario].1[position]),
            MarginSource::Input(input) => return R::constant(self.given[scenario][input]),
            MarginSource::Node(node) => {
                for &node in &required.needed {
                    if slots.computed[node as usize] < slots.clock {
                        self.list.compute(node, &mut slots.slots);
                        slots.computed[node as usize] = slots.clock;
                    }
                }
                slots.slots[node as usize]
            }
        };
        match required.unit {
            Some(unit) => {
                let (multiply, divide) = unit.factors();
                scaled(scaled(value, divide, false), multiply, true)
            }
            None => value,
        }
    }

    /// Turns to a scenario.
    fn turn<R: Real>(&self, slots: &mut Slots<R>, scenario: usize, drawn: &[R; N], of: impl Fn(Interval) -> R) {
        slots.clock += 1;
        let (values, nominal) = &self.scenarios[scenario];
        for (&node, &value) in self.loaded.iter().zip(values) {
            slots.slots[node as usize] = of(value);
        }
        for &(node, position) in &self.places {
            slots.slots[node as usize] = self.actual(position, drawn[position], nominal[position]);
            slots.computed[node as usize] = slots.clock;
        }
    }
}

/// Times a factor, or divided by it; unchanged where that changes nothing.
fn scaled<R: Real>(value: R, factor: f64, divides: bool) -> R {
    match (factor == 1.0, divides) {
        (true, _) => value,
        (false, true) => value / R::constant(factor),
        (false, false) => value * R::constant(factor),
    }
}

impl<R> Slots<R> {
    fn new(slots: Vec<R>) -> Self {
        Self { computed: vec![0; slots.len()], slots, clock: 0 }
    }
}

/// All that a draw must keep in every operating case; `needed` tells the operations that one depends on.
fn required(
    plan: &Plan,
    inputs: &[YieldInput],
    (outputs, conditions): (&[Option<Node>], &[Option<Node>]),
    needed: impl Fn(Node) -> Vec<Node>,
) -> Vec<Required> {
    let model: &Model = &plan.study.model;
    let shown = |unit: Unit| (!unit.is_si()).then_some(unit);
    let mut all = Vec::new();
    // A drawn value that the input cannot have is a drive that cannot be built.
    for (position, (input, ..)) in inputs.iter().enumerate() {
        let input = &model.inputs[*input];
        let range = input.valid;
        let low = range.low.is_finite().then_some(Test::Low(range.low, !range.includes_low));
        let high = range.high.is_finite().then_some(Test::High(range.high, !range.includes_high));
        for test in [low, high].into_iter().flatten() {
            all.push(Required { source: MarginSource::Drawn(position), unit: shown(input.unit), test, finite: true, needed: Vec::new() });
        }
    }
    for (condition, node) in conditions.iter().enumerate() {
        if let &Some(node) = node {
            let test = Test::Low(0.0, model.conditions[condition].strict);
            all.push(Required { source: MarginSource::Node(node), unit: None, test, finite: false, needed: needed(node) });
        }
    }
    for constraint in &plan.study.constraints {
        let (source, unit) = match constraint.quantity {
            Quantity::Input(input) => match inputs.iter().position(|it| it.0 == input) {
                Some(position) => (MarginSource::Drawn(position), shown(model.inputs[input].unit)),
                None => (MarginSource::Input(input), None),
            },
            Quantity::Output(output) => match outputs[output] {
                Some(node) => (MarginSource::Node(node), shown(model.outputs[output].unit)),
                None => continue,
            },
        };
        let low = constraint.low.map(|(bound, strict)| Test::Low(bound, strict));
        let high = constraint.high.map(|(bound, strict)| Test::High(bound, strict));
        for test in [low, high].into_iter().flatten() {
            let needed = if let MarginSource::Node(node) = source { needed(node) } else { Vec::new() };
            all.push(Required { source, unit, test, finite: true, needed });
        }
    }
    all
}

impl<const N: usize> Judge for DrawJudge<'_, N> {
    type Open = OpenRequirements;

    fn judge(&mut self, _level: usize, cell: &DrawCell, open: &Rc<OpenRequirements>) -> CellVerdict<OpenRequirements> {
        let failed = |open: &Rc<OpenRequirements>| CellVerdict { holds: 0.0, fails: 1.0, split: None, open: open.clone() };
        let drawn_over = self.cells.over(cell);
        let over = drawn_over.map(|DrawnPoint { value, slopes }| Dual { value, slopes });
        let middles: [Option<u64>; N] = std::array::from_fn(|axis| self.cells.middle(cell, axis));
        let within = std::array::from_fn(|axis| middles[axis].map_or(0.5, |place| cell.within(axis, place)));
        let mut slabs = Slabs::<N>::new(within);
        // The first requirement without a derivative: its scenario, its number, and the axes that it depends on.
        let mut without_slope: Option<(usize, u16, [bool; N])> = None;
        let mut reference: Option<[Interval; N]> = None;
        let (mut slots, mut points) = (take(&mut self.over), take(&mut self.at));
        let mut left: OpenRequirements = Vec::new();
        let mut fails = false;
        'scenarios: for (scenario, numbers) in open.iter() {
            let scenario_number = *scenario as usize;
            self.turn(&mut slots, scenario_number, &over, Dual::fixed);
            let mut turned = false;
            let mut unsure: Vec<u16> = Vec::new();
            for &number in numbers.iter() {
                let required = &self.required[usize::from(number)];
                let value = self.number(&mut slots, required, &over, scenario_number);
                match decided(required, value.value) {
                    Some(true) => continue,
                    Some(false) => {
                        fails = true;
                        break 'scenarios;
                    }
                    None => {}
                }
                let is_placed = middles.iter().zip(&value.slopes).all(|(place, slope)| place.is_some() || slope.is_zero());
                let mut at = None;
                if is_placed {
                    let drawn = match reference {
                        Some(drawn) => drawn,
                        None => *reference.insert(self.cells.at(&middles, &drawn_over)),
                    };
                    if !turned {
                        self.turn(&mut points, scenario_number, &drawn, |it| it);
                        turned = true;
                    }
                    at = Some(self.number(&mut points, required, &drawn, scenario_number));
                }
                let margin = margin(required, at, &value);
                if without_slope.is_none() && !margin.is_bounded() {
                    without_slope = Some((scenario_number, number, margin.slopes.map(|slope| !slope.is_zero())));
                }
                match slabs.add(&margin) {
                    Some(true) => continue,
                    Some(false) => {
                        fails = true;
                        break 'scenarios;
                    }
                    None => {}
                }
                unsure.push(number);
            }
            if !unsure.is_empty() {
                left.push((*scenario, if unsure.len() == numbers.len() { numbers.clone() } else { unsure.into() }));
            }
        }
        let mut split = None;
        if !fails && let Some(without_slope) = without_slope {
            split = self.axis_at_fault(cell, &middles, without_slope, &mut slots);
        }
        (self.over, self.at) = (slots, points);
        if fails {
            return failed(open);
        }
        if left.is_empty() {
            return CellVerdict { holds: 1.0, fails: 0.0, split: None, open: open.clone() };
        }
        let (holds, fails) = slabs.shares();
        let split = split.or_else(|| slabs.longest().into_iter().find(|&axis| middles[axis].is_some()));
        let split = split.and_then(|axis| Some((axis, middles[axis]?)));
        CellVerdict { holds, fails, split, open: Rc::new(left) }
    }
}

impl<const N: usize> DrawJudge<'_, N> {
    /// The axis to divide where a requirement has no bounded derivative over the box.
    ///
    /// An axis is at fault if the requirement has one as soon as the box has no extent along that axis. Of the axes at fault the longest is
    /// divided; if there are none, the longest that the requirement depends on. Boxes divided along other axes still have no derivative.
    fn axis_at_fault(
        &mut self,
        cell: &DrawCell,
        middles: &[Option<u64>; N],
        (scenario, number, depends): (usize, u16, [bool; N]),
        slots: &mut Slots<Dual<Interval, N>>,
    ) -> Option<usize> {
        let mut best = ((false, false, 0.0), None);
        for (axis, place) in middles.iter().enumerate() {
            let Some(place) = *place else { continue };
            let thin = self.cells.over(&cell.at(axis, place)).map(|DrawnPoint { value, slopes }| Dual { value, slopes });
            self.turn(slots, scenario, &thin, Dual::fixed);
            let value = self.number(slots, &self.required[usize::from(number)], &thin, scenario);
            let is_at_fault = value.value.is_finite() && value.slopes.iter().all(|slope| slope.is_finite());
            let rank = (is_at_fault, depends[axis], cell.side(axis));
            if rank > best.0 {
                best = (rank, Some(axis));
            }
        }
        best.1
    }
}

fn take<R>(slots: &mut Slots<R>) -> Slots<R> {
    std::mem::replace(slots, Slots { slots: Vec::new(), computed: Vec::new(), clock: 0 })
}

/// Does the number keep what is required all over the box, or nowhere?
fn decided(required: &Required, value: Interval) -> Option<bool> {
    let is_kept = match required.test {
        Test::Low(bound, false) => ends(value.low >= bound, value.high < bound),
        Test::Low(bound, true) => ends(value.low > bound, value.high <= bound),
        Test::High(bound, false) => ends(value.high <= bound, value.low > bound),
        Test::High(bound, true) => ends(value.high < bound, value.low >= bound),
        Test::Finite => ends(value.is_finite(), false),
    };
    is_kept.filter(|is_kept| !is_kept || !required.finite || value.is_finite())
}

fn ends(holds: bool, fails: bool) -> Option<bool> {
    if holds || fails { Some(holds) } else { None }
}

/// The margin by which a number keeps what is required, at one place and over the box.
fn margin<const N: usize>(required: &Required, at: Option<Interval>, over: &Dual<Interval, N>) -> Margin<N> {
    let (sign, bound) = match required.test {
        Test::Low(bound, _) => (1.0, bound),
        Test::High(bound, _) => (-1.0, bound),
        Test::Finite => return Margin { at: None, slopes: over.slopes, error: f64::INFINITY },
    };
    let turned = |it: Interval| if sign > 0.0 { it } else { -it };
    let at = at.filter(|_| over.value.is_finite()).map(|at| turned(at - Interval::point(bound)));
    Margin { at, slopes: over.slopes.map(turned), error: over.value.error }
}
