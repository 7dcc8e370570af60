//! Feasible designs by the bins of a histogram, counted in boxes.
//!
//! What is in a bin is the worst value over all scenarios. A box whose bounds of it lie in one bin is counted whole; where two groups of axes
//! meet in it, an edge is one more requirement, and what lies in a bin is the difference of two counts.

use super::axes::Spans;
use super::bounder::{AskedNumber, Wanted};
use super::count::{BoxCounter, Inside, LARGE, LEAF, SAVING, SettledBy, instances};
use super::open::{Open, add_pull, each_scenario, scenarios, worst_of};
use super::pairs::Instance;
use super::requirement::{NumberSource, Requirement, Test};
use super::study_tape::StudyTape;
use crate::models::Worse;
use crate::plan::{Plan, worst_end};
use crate::reduce::Histogram;
use crate::study::HistogramSpec;
use crate::tape::Node;
use std::ops::RangeInclusive;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Pairs are worth their lists where they take this much less than all designs, whatever the number of edges.
const LEAST_SAVING: f64 = 2.0;

/// The number that a histogram is of.
#[derive(Debug)]
pub struct BinnedNumber {
    asked: AskedNumber,
    /// Operations of the tape that it needs, in their order.
    needed: Vec<Node>,
}

impl BinnedNumber {
    /// That of a histogram of a plan.
    pub fn new(plan: &Plan, tape: &StudyTape, spec: &HistogramSpec) -> Self {
        let source = NumberSource::of(spec.of, plan, tape);
        let needed = match source {
            NumberSource::Node(node, _) => tape.list.needed_by(&[node]),
            _ => Vec::new(),
        };
        Self { asked: AskedNumber::new(tape, source, worst_end(&plan.study, spec.of) == Worse::Higher), needed }
    }
}

/// How many designs lie at each place of a histogram: below the first bin, in every bin, above the last.
pub struct Binned<'a> {
    number: &'a BinnedNumber,
    histogram: &'a Histogram,
    /// Designs by place.
    pub counts: Vec<u64>,
}

impl<'a> Binned<'a> {
    /// Nothing counted yet.
    pub fn new(number: &'a BinnedNumber, histogram: &'a Histogram) -> Self {
        Self { number, counts: vec![0; histogram.counts.len() + 2], histogram }
    }

    /// Where the worst value may lie, by bounds of how bad it is.
    fn places(&self, (least, most): (f64, f64)) -> RangeInclusive<usize> {
        let (low, high) = if self.number.asked.higher_is_worse { (least, most) } else { (-most, -least) };
        let first = if low.is_nan() { 0 } else { self.histogram.place(low) };
        first..=if high.is_nan() { self.counts.len() - 1 } else { self.histogram.place(high) }
    }

    /// The requirement that the worst value lies on the good side of the edge between a place and the next one.
    fn divide(&self, place: usize) -> Requirement {
        let edge = self.histogram.edge(place);
        // The last edge itself is in the bin below it, any other in the bin above.
        let is_last = place == self.histogram.counts.len();
        let test = if self.number.asked.higher_is_worse { Test::High(edge, !is_last) } else { Test::Low(edge, is_last) };
        Requirement { source: self.number.asked.source, test, finite: false, needed: self.number.needed.clone() }
    }
}

/// A box on its way to the bins.
struct BinBox<'a> {
    spans: Spans,
    open: &'a [Open],
    /// Scenarios in which the number may be worst.
    cover: Arc<[Spans]>,
    /// How many designs of the study each feasible one stands for.
    each: u64,
    inside: Inside,
}

impl BoxCounter<'_> {
    /// Counts the feasible designs of a box by bin. `None` if it was stopped.
    pub fn count_bins(&mut self, binned: &mut Binned<'_>, spans: &Spans, open: &[Open]) -> Option<()> {
        let before = self.pairs.evaluated;
        let whole = BinBox { spans: *spans, open, cover: [self.axes.whole()].into(), each: 1, inside: Inside::Box(1) };
        let counted = self.count_bins_of(binned, &whole);
        self.settled.evaluations += self.pairs.evaluated - before;
        counted
    }

    fn count_bins_of(&mut self, binned: &mut Binned<'_>, part: &BinBox<'_>) -> Option<()> {
        let number = binned.number;
        let Some((open, mut pull)) = self.decide(&part.spans, part.open, part.inside)? else { return Some(()) };
        let mut cover = part.cover.clone();
        let axes = self.axes;
        let ends = worst_of(&number.asked, &mut self.bounder, axes, &part.spans, &mut cover, Wanted::Both, |it, whole| {
            add_pull(&mut pull, it, whole, axes);
        });
        let places = binned.places(ends);
        if places.start() == places.end() {
            binned.counts[*places.start()] += part.each * self.count_decided(&part.spans, open, &pull, part.inside)?;
            return Some(());
        }
        let Some(bearing) = self.bearing_on(number.asked.axis_set(), &part.spans, &open, part.inside)? else { return Some(()) };
        let spans = bearing.spans;
        let (open, each, inside) = (&bearing.open[..], part.each * bearing.each, bearing.inside);
        let designs = axes.count(&spans);
        let of_number = (number.needed.len() as f64 + 2.0) * scenarios(&cover, &number.asked, axes) as f64;
        let exhaustive = designs as f64 * (self.operations_of(open) + of_number);
        if exhaustive <= LEAF || designs == 1 {
            self.settle(SettledBy::Evaluation, designs, inside);
            let alive = self.evaluate(&spans, open);
            let worst = self.worst_values(number, &spans, &cover);
            for (_, value) in alive.iter().zip(worst).filter(|(alive, _)| **alive) {
                let place = binned.histogram.place(value);
                binned.counts[place] += each;
            }
            return Some(());
        }
        if exhaustive > LARGE
            && let Some(counts) = self.count_pairs_by_place(binned, &places, &spans, open, &cover, exhaustive)
        {
            self.settle(SettledBy::Pairs, designs, inside);
            places.zip(counts).for_each(|(place, count)| binned.counts[place] += each * count);
            return (!self.stop.load(Ordering::Relaxed)).then_some(());
        }
        let axis = self.axis_to_cut(&spans, open, number.asked.axis_set(), &pull);
        for spans in spans.halves(axis) {
            self.count_bins_of(binned, &BinBox { spans, open, cover: cover.clone(), each, inside })?;
        }
        Some(())
    }

    /// The worst value of every design of a box, in f64.
    fn worst_values(&mut self, number: &BinnedNumber, spans: &Spans, cover: &[Spans]) -> Vec<f64> {
        let higher_is_worse = number.asked.higher_is_worse;
        let start = if higher_is_worse { f64::NEG_INFINITY } else { f64::INFINITY };
        let mut worst = vec![start; self.axes.count(spans) as usize];
        self.values(&number.asked, &number.needed, spans, cover, |design, value| {
            if if higher_is_worse { value > worst[design] } else { value < worst[design] } {
                worst[design] = value;
            }
        });
        worst
    }

    /// Counts a box by place as pairs of two groups of axes, once for every edge, if that takes much less than evaluating it.
    fn count_pairs_by_place(
        &mut self,
        binned: &Binned<'_>,
        places: &RangeInclusive<usize>,
        spans: &Spans,
        open: &[Open],
        cover: &[Spans],
        exhaustive: f64,
    ) -> Option<Vec<u64>> {
        let asked = &binned.number.asked;
        let (pairing, cost) = self.pairing(0, spans, open, Some((asked.source, scenarios(cover, asked, self.axes))))?;
        let edges = places.end() - places.start() + 1;
        // Of many edges boxes settle little.
        let saving = (SAVING / edges as f64).max(LEAST_SAVING);
        if cost * saving * edges as f64 > exhaustive {
            return None;
        }
        let of_open = instances(self.requirements, open, self.axes);
        let all = self.pairs.count(&pairing, spans, &of_open, None);
        // How many lie on the good side of each edge.
        let mut good: Vec<u64> = Vec::with_capacity(edges + 1);
        for place in *places.start()..*places.end() {
            let requirement = binned.divide(place);
            let mut both = of_open.clone();
            each_scenario(cover, asked, self.axes, |scenario| {
                both.push(Instance { requirement: &requirement, role: open.len(), scenario });
            });
            good.push(self.pairs.count(&pairing, spans, &both, None));
            if self.stop.load(Ordering::Relaxed) {
                return Some(Vec::new());
            }
        }
        // Where higher is worse these are the designs below each edge, from none to all; else those above it, from all to none.
        let (mut counts, mut before) = (Vec::with_capacity(edges), if asked.higher_is_worse { 0 } else { all });
        for now in good.into_iter().chain([if asked.higher_is_worse { all } else { 0 }]) {
            counts.push(now.abs_diff(before));
            before = now;
        }
        Some(counts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::study_of;

    #[test]
    fn what_is_not_a_number_may_lie_anywhere() {
        let text = "[design]\npower_kW = [1, 2, 3]\n[objectives]\nfriction_margin = \"max\"\n[report]\n\
                    histograms = [{ of = \"friction_margin\", from = 0.1, to = 0.7, bins = 6 }]\n";
        let plan = Plan::new(study_of(&crate::models::find("pulley-load").expect("it is a model"), text).expect("the study is right"));
        let layout = super::super::BoundedStudy::new(&plan).expect("bounds serve it");
        let histogram = Histogram::new((0.1, 0.7), 6, 0);
        let binned = Binned::new(&layout.histograms[0], &histogram);
        assert_eq!(binned.places((f64::NAN, f64::NAN)), 0..=7);
        // The margin is worst where it is low.
        assert_eq!(binned.places((-0.35, -0.15)), 1..=3);
    }
}
