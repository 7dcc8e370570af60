//! Which scenarios decide about the designs of a row.
//!
//! What a scenario does to the designs of a row comes in by a few numbers that are the same for all of them: a force, a curvature. Where
//! a result rises or falls with each of these numbers, rounding and all, a scenario whose numbers are all as bad as those of another or
//! worse gives the worse result for every design of the row, and the other one need not be looked at. Of hundreds of scenarios a handful
//! is left. Sums, products, quotients, minima and maxima never swap the order of two numbers when they round; which way a result goes
//! follows from the signs of what is multiplied, which intervals over the row give. They also show that nothing overflows on the way.

use crate::models::Worse;
use crate::plan::{Plan, Source};
use crate::tape::LaneList;
use crate::tape::{Binary, Interval, Node, Operation, Unary};

/// Most scenarios, and most numbers of each, that are compared.
const MOST_SCENARIOS: u64 = 1 << 14;
const MOST_SCALARS: usize = 64;
/// With more scenarios that decide than this, finding them would take as long as judging the designs in all of them.
const MOST_KEPT: usize = 128;
/// Fewer designs times scenarios than this are judged in all of them before it is known which decide.
const LEAST_WORK: u64 = 1024;
/// Beyond this a change of units might overflow.
const LARGE: f64 = 1e280;

/// Which scalars a number rises with, and which it falls with; those that are in both it may do either with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Trend {
    rises: u64,
    falls: u64,
}

impl Trend {
    fn and(self, other: Self) -> Self {
        Self { rises: self.rises | other.rises, falls: self.falls | other.falls }
    }

    fn turned(self) -> Self {
        Self { rises: self.falls, falls: self.rises }
    }

    fn unknown(self) -> Self {
        let either = self.rises | self.falls;
        Self { rises: either, falls: either }
    }

    /// Times a factor, or through anything that goes with its sign.
    fn times(self, factor: Interval) -> Self {
        match factor {
            it if it.low >= 0.0 => self,
            it if it.high <= 0.0 => self.turned(),
            _ => self.unknown(),
        }
    }
}

/// What is asked of a result: which of its ends matter.
#[derive(Clone, Copy, Debug)]
struct AskedEnds {
    result: usize,
    low: bool,
    high: bool,
}

/// Finds the scenarios that decide about a row; one per thread.
#[derive(Debug)]
pub(super) struct Decisive {
    asked: Vec<AskedEnds>,
    /// The scalars of each scenario that was added.
    scalars: Vec<f64>,
    width: usize,
    /// Numbers of the scenarios that decide.
    kept: Vec<usize>,
    ranges: Vec<Interval>,
    trends: Vec<Trend>,
}

impl Decisive {
    /// `None` where a plan has too few or too many scenarios, or sums over them.
    pub(super) fn new(plan: &Plan, list: &LaneList) -> Option<Self> {
        let (scenarios, width) = (plan.scenarios(), list.scalars().len());
        if scenarios > MOST_SCENARIOS || width > MOST_SCALARS || plan.spectrum.is_some() {
            return None;
        }
        let mut asked = Vec::new();
        for (constraint, source) in plan.study.constraints.iter().zip(&plan.constraints) {
            if let Source::LaneOutput(result) = *source {
                asked.push(AskedEnds { result, low: constraint.low.is_some(), high: constraint.high.is_some() });
            }
        }
        for (tracked, source) in &plan.tracked {
            if let Source::LaneOutput(result) = *source {
                asked.push(AskedEnds { result, low: tracked.worse == Worse::Lower, high: tracked.worse == Worse::Higher });
            }
        }
        let margins = plan.lane_outputs.len();
        asked.extend((0..plan.lane_conditions.len()).map(|number| AskedEnds { result: margins + number, low: true, high: false }));
        Some(Self {
            asked,
            scalars: Vec::new(),
            width,
            kept: Vec::new(),
            ranges: list.ranges().to_vec(),
            trends: vec![Trend::default(); list.ranges().len()],
        })
    }

    /// Does it pay to find the scenarios that decide about so many designs?
    pub(super) fn is_worth_it(scenarios: u64, designs: u64) -> bool {
        scenarios > 1 && scenarios.saturating_mul(designs) >= LEAST_WORK
    }

    /// Bytes that it takes for a plan.
    pub(super) fn bytes(plan: &Plan, list: &LaneList) -> u64 {
        Self::new(plan, list).map_or(0, |it| {
            let slots = it.ranges.len() * (size_of::<Interval>() + size_of::<Trend>());
            8 * plan.scenarios() * (it.width as u64 + 1) + slots as u64
        })
    }

    /// Begins a row.
    pub(super) fn begin(&mut self) {
        self.scalars.clear();
        self.kept.clear();
    }

    /// Adds a scenario of the row.
    pub(super) fn add(&mut self, scalars: impl Iterator<Item = f64>) {
        self.scalars.extend(scalars);
    }

    /// The scenarios that decide about the row, as numbers in the order in which they were added.
    #[cfg(feature = "gpu")]
    pub(super) fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// How many scenarios decide about the row.
    pub(super) fn count(&self) -> usize {
        self.kept.len()
    }

    /// The scalars of one of them.
    pub(super) fn scalars(&self, number: usize) -> &[f64] {
        &self.scalars[self.kept[number] * self.width..][..self.width]
    }

    /// Finds which of `count` scenarios decide about so many designs, in their order: all of them where nothing is sure.
    pub(super) fn settle(&mut self, list: &LaneList, count: usize, designs: u64) {
        self.kept.clear();
        if !Self::is_worth_it(count as u64, designs) || !self.find_trends(list) {
            return self.kept.extend(0..count);
        }
        let mut is_kept = vec![false; count];
        let mut looked_at: Vec<Trend> = Vec::new();
        for &AskedEnds { result, low, high } in &self.asked {
            let trend = self.trends[list.asked()[result] as usize];
            // What makes it worse, be it too high or too low.
            for worse in [high.then_some(trend), low.then_some(trend.turned())].into_iter().flatten() {
                if !looked_at.contains(&worse) {
                    looked_at.push(worse);
                    worst(&self.scalars, self.width, worse, &mut is_kept);
                }
            }
        }
        self.kept.extend((0..count).filter(|&scenario| is_kept[scenario]));
        if self.kept.is_empty() {
            self.kept.push(0);
        }
    }

    /// Finds how every operation goes with the scalars; false if something may overflow or have no value.
    fn find_trends(&mut self, list: &LaneList) -> bool {
        for (place, &node) in list.scalars().iter().enumerate() {
            let mut range = (f64::INFINITY, f64::NEG_INFINITY);
            for scenario in self.scalars.chunks_exact(self.width) {
                let value = scenario[place];
                if !value.is_finite() {
                    return false;
                }
                range = (range.0.min(value), range.1.max(value));
            }
            self.ranges[node as usize] = Interval::new(range.0, range.1);
            self.trends[node as usize] = Trend { rises: 1 << place, falls: 0 };
        }
        for &node in list.each() {
            self.trends[node as usize] = self.trend_of(list, node);
            list.list().compute(node, &mut self.ranges);
            let range = self.ranges[node as usize];
            if !(range.low > -LARGE && range.high < LARGE) {
                return false;
            }
        }
        true
    }

    fn trend_of(&self, list: &LaneList, node: Node) -> Trend {
        let (trend, range) = (|node: Node| self.trends[node as usize], |node: Node| self.ranges[node as usize]);
        match list.list().operations[node as usize] {
            Operation::Unary(Unary::Neg, a) => trend(a).turned(),
            Operation::Unary(Unary::Sqrt | Unary::Floor | Unary::Scale(_), a) => trend(a),
            Operation::Unary(Unary::Abs, a) => trend(a).times(range(a)),
            Operation::Binary(Binary::Add | Binary::Min | Binary::Max, a, b) => trend(a).and(trend(b)),
            Operation::Binary(Binary::Sub, a, b) => trend(a).and(trend(b).turned()),
            Operation::Binary(Binary::Mul, a, b) => trend(a).times(range(b)).and(trend(b).times(range(a))),
            Operation::Binary(Binary::Div, a, b) => {
                let divisor = range(b);
                let of_divisor = if divisor.low > 0.0 || divisor.high < 0.0 { trend(b).turned() } else { trend(b).unknown() };
                // A quotient falls with its divisor, wherever that keeps its sign, if it is positive itself.
                trend(a).times(divisor).and(of_divisor.times(range(a)))
            }
            Operation::Select(margin, a, b) => match range(margin) {
                it if it.low >= 0.0 => trend(a),
                it if it.high < 0.0 => trend(b),
                _ => trend(margin).unknown().and(trend(a)).and(trend(b)),
            },
            other => {
                let mut all = Trend::default();
                other.operands(|operand| all = all.and(trend(operand)));
                all.unknown()
            }
        }
    }
}

/// Marks the scenarios none of which has all scalars as bad as another's or worse; of equal ones the first.
fn worst(scalars: &[f64], width: usize, worse: Trend, is_kept: &mut [bool]) {
    let signs: Vec<(usize, f64)> = (0..width)
        .flat_map(|place| {
            let rises = (worse.rises >> place & 1 == 1).then_some((place, 1.0));
            rises.into_iter().chain((worse.falls >> place & 1 == 1).then_some((place, -1.0)))
        })
        .collect();
    let Some(&(first_place, first_sign)) = signs.first() else { return };
    let badness = |scenario: usize, (place, sign): (usize, f64)| sign * scalars[scenario * width + place];
    let mut order: Vec<usize> = (0..is_kept.len()).collect();
    // Who comes later is never worse in the first number.
    order.sort_by(|&a, &b| badness(b, (first_place, first_sign)).total_cmp(&badness(a, (first_place, first_sign))).then(a.cmp(&b)));
    let mut kept: Vec<usize> = Vec::new();
    for (place, &scenario) in order.iter().enumerate() {
        if kept.len() == MOST_KEPT {
            order[place..].iter().for_each(|&rest| is_kept[rest] = true);
            return;
        }
        let covers = |&other: &usize| signs.iter().all(|&sign| badness(other, sign) >= badness(scenario, sign));
        match kept.iter().position(covers) {
            // Who covers one scenario often covers the next.
            Some(by) => kept.swap(0, by),
            None => {
                kept.push(scenario);
                is_kept[scenario] = true;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CpuEngine, Tables};
    use super::*;
    use crate::study::study_of;
    use std::collections::BTreeMap;

    fn plan(model: &str, text: &str) -> Plan {
        Plan::new(study_of(&crate::models::find(model).expect("it is a model"), text).expect("the study is right"))
    }

    /// Feasible designs with their worst values, and how many scenarios were looked at for how many rows.
    fn judged(plan: &Plan, change: impl Fn(&mut CpuEngine<'_>)) -> (BTreeMap<u64, Vec<u64>>, usize, usize) {
        let tables = Tables::new(plan);
        let mut engine = CpuEngine::new(plan, &tables);
        change(&mut engine);
        let (mut found, mut scenarios, mut rows) = (BTreeMap::new(), 0, 0);
        let width = plan.fast.count();
        for row in 0..plan.slow.count() {
            engine.screen(row * width..(row + 1) * width, |block| {
                let values = |lane: usize| block.values.iter().map(|column| (column[lane] + 0.0).to_bits()).collect();
                found.extend(block.feasible().map(|lane| (block.index(lane), values(lane))));
            });
            if let Some((_, decisive)) = &engine.numbers
                && decisive.count() > 0
            {
                (scenarios, rows) = (scenarios + decisive.count(), rows + 1);
            }
        }
        (found, scenarios, rows)
    }

    const STUDIES: [(&str, &str, usize); 3] = [
        (
            "metal-cvt",
            "[design]\ngroove_angle_deg = [18, 22, 30]\nband_thickness_mm = { from = 0.1, to = 0.3, count = 21 }\nband_count = { from = 6, to = 14 }\n\
             traction = [0.3, 0.4]\n[operation]\nratio = { from = 0.5, to = 2, count = 9 }\ntorque_Nm = [50, 150]\n\
             [uncertainty]\nfriction = [0.065, 0.08, 0.095]\n[fixed]\nstrength_MPa = 800\n[constraints]\nslip_margin = { min = 0 }\n\
             stress_margin = { min = 0, max = 0.6 }\n[objectives]\naxial_force_N = \"min\"\nstress_margin = \"max\"\nband_count = \"min\"\n",
            54,
        ),
        // Curvatures change their sign between ratios, and both ends of a quantity matter.
        (
            "rubber-cvt",
            "[design]\nbelt_thickness_mm = { from = 4, to = 16, count = 25 }\nbelt_width_mm = { from = 20, to = 60, count = 9 }\n\
             [operation]\nratio = { from = 0.6, to = 1.8, count = 7 }\ntorque_Nm = [0, 5, 10]\n[objectives]\nmax_stress_MPa = \"min\"\n\
             bending_stress_MPa = \"max\"\n[constraints]\nmax_stress_MPa = { min = 0.1, max = 60 }\n",
            21,
        ),
        // Conditions of single designs.
        (
            "flat-belt",
            "[design]\nbelt_width_mm = { from = 80, to = 400, count = 30 }\ntension_per_width_N_per_mm = { from = 8, to = 30, count = 11 }\n\
             [operation]\npower_kW = { from = 1, to = 30, count = 12 }\n[uncertainty]\nfriction = [0.6, 0.7, 0.8]\n\
             [objectives]\nbelt_width_mm = \"min\"\nslip_margin = \"max\"\n",
            36,
        ),
    ];

    #[test]
    fn the_scenarios_that_decide_give_the_answers_of_all() {
        for (model, text, all) in STUDIES {
            let plan = plan(model, text);
            assert_eq!(plan.scenarios() as usize, all, "{model}");
            let (every, ..) = judged(&plan, |engine| engine.numbers = None);
            let (found, scenarios, rows) = judged(&plan, |_| {});
            assert!(every.len() > 100 && every == found, "{model}: {} and {}", every.len(), found.len());
            assert!(rows > 0 && 2 * scenarios < all * rows, "{model}: {scenarios} scenarios of {rows} rows");
            // Without what is asked of the results, one scenario alone would be looked at.
            let (wrong, ..) = judged(&plan, |engine| engine.numbers.as_mut().expect("it serves").1.asked.clear());
            assert!(wrong != every, "{model}");
        }
    }

    #[test]
    fn the_worst_scenarios_are_those_that_no_other_covers() {
        let scalars = [1.0, 5.0, 2.0, 4.0, 1.5, 4.0, 2.0, 4.0, 0.0, 6.0];
        let kept = |worse| {
            let mut kept = [false; 5];
            worst(&scalars, 2, worse, &mut kept);
            kept
        };
        assert_eq!(kept(Trend { rises: 0b11, falls: 0 }), [true, true, false, false, true]);
        assert_eq!(kept(Trend { rises: 0b01, falls: 0 }), [false, true, false, false, false]);
        assert_eq!(kept(Trend { rises: 0b01, falls: 0b10 }), [false, true, false, false, false]);
        // What may go either way must be the same.
        assert_eq!(kept(Trend { rises: 0b01, falls: 0b01 }), [true, true, true, false, true]);
        assert_eq!(kept(Trend::default()), [false; 5]);
    }

    #[test]
    fn a_trend_that_depends_on_a_sign_is_open_where_that_changes() {
        let rising = Trend { rises: 1, falls: 0 };
        assert_eq!(rising.times(Interval::new(0.0, 2.0)), rising);
        assert_eq!(rising.times(Interval::new(-2.0, 0.0)), Trend { rises: 0, falls: 1 });
        assert_eq!(rising.times(Interval::new(-1.0, 2.0)), Trend { rises: 1, falls: 1 });
    }
}
