//! What a feasible design satisfies in every scenario, one bound at a time.

use super::axes::Axes;
use super::study_tape::StudyTape;
use crate::models::Model;
use crate::plan::Plan;
use crate::study::Quantity;
use crate::tape::Node;
use crate::units::Unit;

/// A bound on a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Test {
    /// Least value, and whether it is itself excluded.
    Low(f64, bool),
    /// Largest value, and whether it is itself excluded.
    High(f64, bool),
    /// Any number, but a number.
    Finite,
}

impl Test {
    /// Does the number satisfy it? NaN never does.
    #[inline(always)]
    pub fn holds(self, value: f64) -> bool {
        match self {
            Self::Low(bound, false) => value >= bound,
            Self::Low(bound, true) => value > bound,
            Self::High(bound, false) => value <= bound,
            Self::High(bound, true) => value < bound,
            Self::Finite => value.is_finite(),
        }
    }
}

/// Where a number comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NumberSource {
    /// The same for all.
    Known(f64),
    /// An input, in its unit: axis and column.
    Axis(usize, usize),
    /// An operation of the tape, in this unit; `None`: as it is.
    Node(Node, Option<Unit>),
}

impl NumberSource {
    /// A quantity of a plan.
    pub fn of(quantity: Quantity, plan: &Plan, tape: &StudyTape) -> Self {
        match quantity {
            Quantity::Input(input) => match tape.input_axes[input] {
                Some((axis, column)) => Self::Axis(axis as usize, column as usize),
                None => Self::Known(plan.study.fixed[input]),
            },
            Quantity::Output(output) => {
                let unit = plan.study.model.outputs[output].unit;
                Self::Node(tape.outputs[output].expect("the plan asks for it"), (!unit.is_si()).then_some(unit))
            }
        }
    }

    /// The axes that it depends on.
    pub fn axes(self, tape: &StudyTape) -> u64 {
        match self {
            Self::Known(_) => 0,
            Self::Axis(axis, _) => 1 << axis,
            Self::Node(node, _) => tape.axes[node as usize],
        }
    }

    /// A number of the tape in the unit that it is asked for in.
    #[inline(always)]
    pub fn shown(self, si: f64) -> f64 {
        match self {
            Self::Node(_, Some(unit)) => unit.from_si(si),
            _ => si,
        }
    }
}

/// One bound that a design must keep in every scenario.
#[derive(Clone, Debug)]
pub struct Requirement {
    /// Of which number.
    pub source: NumberSource,
    /// What of it.
    pub test: Test,
    /// Must the number be finite besides? Outputs must, margins of conditions need not.
    pub finite: bool,
    /// Operations of the tape that it needs, in their order.
    pub needed: Vec<Node>,
}

impl Requirement {
    /// Does a number, in the unit that it is asked for in, satisfy it?
    #[inline(always)]
    pub fn holds(&self, value: f64) -> bool {
        self.test.holds(value) && (!self.finite || value.is_finite())
    }
}

/// All that a feasible design of a plan satisfies.
pub fn requirements(plan: &Plan, tape: &StudyTape, axes: &Axes) -> Vec<Requirement> {
    let model: &Model = &plan.study.model;
    let mut all = Vec::new();
    let needed = |source: NumberSource| match source {
        NumberSource::Node(node, _) => tape.list.needed_by(&[node]),
        _ => Vec::new(),
    };
    for (number, node) in tape.conditions.iter().enumerate() {
        if let Some(node) = node {
            let source = NumberSource::Node(*node, None);
            all.push(Requirement { source, test: Test::Low(0.0, model.conditions[number].strict), finite: false, needed: needed(source) });
        }
    }
    let mut bounded = Vec::new();
    for constraint in &plan.study.constraints {
        let source = NumberSource::of(constraint.quantity, plan, tape);
        bounded.push(source);
        let finite = matches!(source, NumberSource::Node(..));
        let low = constraint.low.map(|(bound, strict)| Test::Low(bound, strict));
        let high = constraint.high.map(|(bound, strict)| Test::High(bound, strict));
        all.extend([low, high].into_iter().flatten().map(|test| Requirement { source, test, finite, needed: needed(source) }));
    }
    for (tracked, _) in &plan.tracked {
        let source = NumberSource::of(tracked.quantity, plan, tape);
        if matches!(source, NumberSource::Node(..)) && !bounded.contains(&source) {
            bounded.push(source);
            all.push(Requirement { source, test: Test::Finite, finite: true, needed: needed(source) });
        }
    }
    // What every design violates, and what none does, is found out by bounds like the rest; here only what costs nothing is dropped.
    let levels = |axis: usize| axes.all[axis].count();
    all.retain(|it| !matches!(it.source, NumberSource::Known(value) if it.holds(value)) && !matches!(it.source, NumberSource::Axis(axis, column) if levels(axis) > 0 && axes.all[axis].own[column].iter().all(|&value| it.holds(value))));
    all
}
