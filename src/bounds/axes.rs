//! The axes of a study as the search sees them: design axes in the order of the sweep, then scenario axes, each with all its values;
//! boxes of designs as spans of their indices.

use crate::models::input_to_si;
use crate::plan::Plan;
use crate::space::SpaceDimension;
use crate::study::TOGETHER;
use std::ops::Range;

/// Most axes of designs and scenarios together.
pub const AXES: usize = 16;
/// Most levels of an axis: all of them are kept.
pub const LEVELS: u64 = 1 << 20;

/// One axis.
#[derive(Debug)]
pub struct BoxAxis {
    /// The inputs that it sets.
    pub inputs: Vec<usize>,
    /// Their values by level, in their units; one column per input.
    pub own: Vec<Vec<f64>>,
    /// The same in SI.
    pub si: Vec<Vec<f64>>,
    /// Do the values of every column rise or fall all along, so that a span's ends have its extremes?
    pub ordered: bool,
    /// Least distance of two neighbouring values of the first column, in SI.
    pub least_step: f64,
    /// Distance of two neighbours in the study's index.
    pub stride: u64,
}

/// All axes of a study.
#[derive(Debug)]
pub struct Axes {
    /// Design axes, outermost of the sweep first, then scenario axes.
    pub all: Vec<BoxAxis>,
    /// Number of design axes.
    pub designs: usize,
    /// Distance of two neighbours in the position of the sweep, of each design axis.
    pub steps: Vec<u64>,
}

/// Levels `low..=high` of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Span {
    /// First level.
    pub low: u32,
    /// Last level.
    pub high: u32,
}

impl Span {
    /// One level.
    pub fn at(level: u32) -> Self {
        Self { low: level, high: level }
    }

    /// Number of levels.
    pub fn count(self) -> u64 {
        u64::from(self.high - self.low) + 1
    }

    /// Is it one level?
    pub fn is_single(self) -> bool {
        self.low == self.high
    }

    /// Both halves of more than one level.
    pub fn halves(self) -> [Self; 2] {
        let middle = self.low + (self.high - self.low) / 2;
        [Self { low: self.low, high: middle }, Self { low: middle + 1, high: self.high }]
    }
}

/// A box: a span of every axis, in the order of [`Axes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spans(pub [Span; AXES]);

impl std::ops::Index<usize> for Spans {
    type Output = Span;
    fn index(&self, axis: usize) -> &Span {
        &self.0[axis]
    }
}

impl std::ops::IndexMut<usize> for Spans {
    fn index_mut(&mut self, axis: usize) -> &mut Span {
        &mut self.0[axis]
    }
}

impl Spans {
    /// The box with some of its axes at one level each: that of a combination, numbered with the last of these axes fastest.
    pub fn at(&self, axes: impl DoubleEndedIterator<Item = usize>, combination: u64) -> Self {
        let mut levels = *self;
        let mut rest = combination;
        for axis in axes.rev() {
            let count = self[axis].count();
            levels[axis] = Span::at(self[axis].low + (rest % count) as u32);
            rest /= count;
        }
        levels
    }

    /// Both halves of a box along an axis.
    pub fn halves(&self, axis: usize) -> [Self; 2] {
        self[axis].halves().map(|half| {
            let mut part = *self;
            part[axis] = half;
            part
        })
    }
}

impl BoxAxis {
    /// Least and largest of a column over a span.
    pub fn ends(values: &[f64], ordered: bool, span: Span) -> (f64, f64) {
        let (first, last) = (values[span.low as usize], values[span.high as usize]);
        if ordered || span.is_single() {
            return (first.min(last), first.max(last));
        }
        let inside = &values[span.low as usize..=span.high as usize];
        inside.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)))
    }

    /// Number of levels.
    pub fn count(&self) -> u64 {
        self.si.first().map_or(1, |column| column.len() as u64)
    }

    /// Does it walk several inputs together?
    pub fn is_joint(&self) -> bool {
        self.inputs.len() > 1
    }
}

impl Axes {
    /// Why the axes of a plan are too many or too long, if they are.
    pub fn problem(plan: &Plan) -> Option<String> {
        let all = || plan.slow.dimensions().chain(plan.fast.dimensions()).chain(plan.space.scenarios.dimensions());
        let count = all().count();
        if count > AXES {
            return Some(format!("it has {count} axes, and bounds take {AXES} at most"));
        }
        let (long, _) = all().find(|(it, _)| it.count() > LEVELS)?;
        let names = long.inputs().iter().map(|&input| plan.study.model.inputs[input].name.as_str()).collect::<Vec<_>>().join(TOGETHER);
        Some(format!("{names} has {} levels, and bounds take {LEVELS} at most", long.count()))
    }

    /// The axes of a plan; `None` if there are too many, or one has too many levels.
    pub fn new(plan: &Plan) -> Option<Self> {
        if Self::problem(plan).is_some() {
            return None;
        }
        let designs: Vec<_> = plan.slow.dimensions().chain(plan.fast.dimensions()).collect();
        let scenarios: Vec<_> = plan.space.scenarios.dimensions().collect();
        let count = designs.len();
        let mut steps = vec![1; count];
        for axis in (1..count).rev() {
            steps[axis - 1] = steps[axis] * designs[axis].0.count();
        }
        Some(Self {
            all: designs.into_iter().chain(scenarios).map(|(dimension, stride)| axis(plan, dimension, stride)).collect(),
            designs: count,
            steps,
        })
    }
}

impl Axes {
    /// Every design and scenario.
    pub fn whole(&self) -> Spans {
        let mut spans = Spans([Span::at(0); AXES]);
        for (span, axis) in spans.0.iter_mut().zip(&self.all) {
            span.high = (axis.count() - 1) as u32;
        }
        spans
    }

    /// Number of designs of a box.
    pub fn count(&self, spans: &Spans) -> u64 {
        spans.0[..self.designs].iter().map(|span| span.count()).product()
    }

    /// The lowest design index of a box.
    pub fn least_index(&self, spans: &Spans) -> u64 {
        self.all[..self.designs].iter().zip(&spans.0).map(|(axis, span)| u64::from(span.low) * axis.stride).sum()
    }

    /// The lowest scenario index of a box.
    pub fn scenario_index(&self, spans: &Spans) -> u64 {
        self.all.iter().zip(&spans.0).skip(self.designs).map(|(axis, span)| u64::from(span.low) * axis.stride).sum()
    }

    /// The position at which the sweep meets the first design of a box.
    pub fn first_position(&self, spans: &Spans) -> u64 {
        self.steps.iter().zip(&spans.0).map(|(step, span)| u64::from(span.low) * step).sum()
    }

    /// The boxes that a range of positions consists of, in order; all scenarios.
    pub fn boxes(&self, range: &Range<u64>) -> Vec<Spans> {
        let mut boxes = Vec::new();
        if !range.is_empty() {
            self.cut(self.whole(), 0, range.start, range.end - 1, &mut boxes);
        }
        boxes
    }

    /// Positions `first..=last` of the designs that the axes from `axis` on span.
    fn cut(&self, spans: Spans, axis: usize, first: u64, last: u64, boxes: &mut Vec<Spans>) {
        if axis == self.designs {
            boxes.push(spans);
            return;
        }
        let step = self.steps[axis];
        let (mut low, mut high) = ((first / step) as u32, (last / step) as u32);
        let (head, tail) = (first % step, last % step);
        let with = |low, high| {
            let mut spans = spans;
            spans[axis] = Span { low, high };
            spans
        };
        if low == high && (head, tail) != (0, step - 1) {
            return self.cut(with(low, low), axis + 1, head, tail, boxes);
        }
        if head != 0 {
            self.cut(with(low, low), axis + 1, head, step - 1, boxes);
            low += 1;
        }
        let has_tail = tail != step - 1;
        high -= u32::from(has_tail);
        if low <= high {
            boxes.push(with(low, high));
        }
        if has_tail {
            self.cut(with(high + 1, high + 1), axis + 1, 0, tail, boxes);
        }
    }

    /// The axis of designs of which a box has most levels.
    pub fn longest(&self, spans: &Spans) -> usize {
        (0..self.designs).max_by_key(|&axis| spans[axis].count()).unwrap_or(0)
    }

    /// The rows that a box touches and the places that it has in each, ascending; a row has so many designs.
    pub fn rows(&self, spans: &Spans, row: u64) -> (Vec<u64>, Vec<u64>) {
        let slow = self.slow(row);
        let step = |axis: usize| self.steps[axis];
        let mut rows = sums(spans, 0..slow, step);
        rows.iter_mut().for_each(|position| *position /= row);
        (rows, sums(spans, slow..self.designs, step))
    }

    /// What the same rows and places add to the index of a design, in the same order.
    pub fn indices(&self, spans: &Spans, row: u64) -> (Vec<u64>, Vec<u64>) {
        let slow = self.slow(row);
        let stride = |axis: usize| self.all[axis].stride;
        (sums(spans, 0..slow, stride), sums(spans, slow..self.designs, stride))
    }

    /// The axes along which a row of so many designs does not go.
    fn slow(&self, row: u64) -> usize {
        self.steps.iter().take_while(|&&step| step >= row).count()
    }
}

/// The sums of what the levels of some axes of a box add, the last axis fastest: each level as much as the one before and a step.
fn sums(spans: &Spans, axes: Range<usize>, step: impl Fn(usize) -> u64) -> Vec<u64> {
    let mut sums = vec![0];
    for axis in axes {
        let (span, step) = (spans[axis], step(axis));
        sums = sums.into_iter().flat_map(|sum| (span.low..=span.high).map(move |level| sum + u64::from(level) * step)).collect();
    }
    sums
}

fn axis(plan: &Plan, dimension: &SpaceDimension, stride: u64) -> BoxAxis {
    let inputs = dimension.inputs().to_vec();
    let own: Vec<Vec<f64>> =
        (0..inputs.len()).map(|column| (0..dimension.count()).map(|level| dimension.value(column, level)).collect()).collect();
    let table = &plan.study.model.inputs;
    let si: Vec<Vec<f64>> =
        inputs.iter().zip(&own).map(|(&input, own)| own.iter().map(|&value| input_to_si(&table[input], value)).collect()).collect();
    let ordered = own.iter().chain(&si).all(|values| values.is_sorted() || values.iter().rev().is_sorted());
    let least_step = si[0].windows(2).map(|it| (it[1] - it[0]).abs()).fold(f64::INFINITY, f64::min);
    BoxAxis { inputs, own, si, ordered, least_step, stride }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::study_of;

    #[test]
    fn of_too_many_axes_and_too_many_levels_only_what_applies_is_told() {
        let model = crate::models::find("timing-belt").expect("it is a model");
        let plain = model.inputs.iter().filter(|it| it.words.is_empty() && !it.integer && it.instead_of.is_none());
        let axes: Vec<String> = plain.map(|it| format!("{} = [{:?}, {:?}]\n", it.name, it.usual.0, it.usual.1)).collect();
        let problem = |axes: String| {
            let text = format!("[design]\n{axes}[objectives]\nlift_speed_rpm = \"max\"\n");
            Axes::problem(&Plan::new(study_of(&model, &text).expect("the study is right")))
        };
        assert_eq!(problem(axes[..AXES].concat()), None);
        assert_eq!(problem(axes[..=AXES].concat()).as_deref(), Some("it has 17 axes, and bounds take 16 at most"));
        let long = format!("friction = {{ from = 0.2, to = 0.4, count = {} }}\n", LEVELS + 1);
        assert_eq!(problem(long).as_deref(), Some("friction has 1048577 levels, and bounds take 1048576 at most"));
    }

    #[test]
    fn the_boxes_of_a_range_are_its_positions_in_order() {
        let text = "[design]\npower_kW = [1, 2, 3]\nspeed_rpm = { from = 1000, to = 4000, count = 4 }\n\
                    friction_limit = { from = 0.2, to = 0.5, count = 5 }\n[objectives]\nfriction_margin = \"max\"\n";
        let plan = Plan::new(study_of(&crate::models::find("pulley-load").expect("it is a model"), text).expect("the study is right"));
        let axes = Axes::new(&plan).expect("there are few");
        for first in 0..60 {
            for end in first..=60 {
                let mut positions = Vec::new();
                let boxes = axes.boxes(&(first..end));
                for spans in &boxes {
                    let before = positions.len() as u64;
                    let row = plan.fast.count();
                    let (rows, places) = axes.rows(spans, row);
                    positions.extend(rows.iter().flat_map(|it| places.iter().map(move |place| it * row + place)));
                    let (of_rows, of_places) = axes.indices(spans, row);
                    let indices = of_rows.iter().flat_map(|it| of_places.iter().map(move |place| it + place));
                    assert!(indices.eq(positions[before as usize..].iter().map(|&it| plan.design_at(it))));
                    assert_eq!(positions.len() as u64 - before, axes.count(spans));
                }
                assert_eq!(positions, (first..end).collect::<Vec<_>>());
                assert!(boxes.len() <= 5, "{first}..{end}: {boxes:?}");
                for spans in &boxes {
                    assert_eq!(plan.design_at(axes.first_position(spans)), axes.least_index(spans));
                }
            }
        }
    }
}
