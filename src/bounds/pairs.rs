//! Counting a box whose axes act in two groups: lists of either group in place of all their pairs.
//!
//! With the axes that both groups share at one level, a requirement is about the first group alone, about the second alone, or about
//! both through a [`Chain`]: then every member of the second group has a threshold, and what counts is how many numbers of the first
//! group's list are on its good side. That is exact in f64, because a chain never swaps the order of two numbers.

use super::axes::{Axes, Span, Spans};
use super::box_columns::BoxColumns;
use super::chain::Chain;
use super::pairing::{PairRole, Pairing};
use super::requirement::{NumberSource, Requirement};
use super::sorted::Buckets;
use super::study_tape::StudyTape;
use crate::tape::CHUNK;
use crate::tape::Node;
use std::sync::atomic::{AtomicBool, Ordering};

/// A requirement in one scenario.
#[derive(Clone, Copy, Debug)]
pub struct Instance<'a> {
    /// What is required.
    pub requirement: &'a Requirement,
    /// Its place among what the pairing is about.
    pub role: usize,
    /// The scenario: its levels stand in these spans.
    pub scenario: Spans,
}

/// The most extreme value of a number over feasible designs, and the lowest index of a design that has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestPair {
    /// Is the largest sought, or the least?
    pub largest: bool,
    /// The value so far; beyond it something is to be found.
    pub value: f64,
    /// The design, if one was found here.
    pub index: u64,
}

impl BestPair {
    /// Would this be better, or the same at a lower index?
    pub fn beats(&self, value: f64, index: u64) -> bool {
        let further = if self.largest { value > self.value } else { value < self.value };
        further || value == self.value && index < self.index
    }
    fn reaches(&self, value: f64) -> bool {
        if self.largest { value >= self.value } else { value <= self.value }
    }
}

/// What is counted: the pairs of a box, and what is known of each member of the second group.
struct Listed<'a> {
    pairing: &'a Pairing,
    spans: &'a Spans,
    instances: &'a [Instance<'a>],
    links: Vec<Link>,
}

/// A chain in one scenario: where its starts and its others are.
#[derive(Debug)]
struct Link {
    instance: usize,
    channel: usize,
    /// First of its others per member of the second group, and how many each has.
    others: Vec<f64>,
    width: usize,
}

/// One list of starts.
#[derive(Debug, Default)]
struct Channel {
    node: Node,
    scenario: usize,
    values: Vec<f64>,
    ends: (f64, f64),
    finite: bool,
    buckets: Buckets,
    cast: bool,
}

/// Counts boxes by pairs; one per thread, with room that is used again.
#[derive(Debug)]
pub struct Pairs<'t> {
    tape: &'t StudyTape,
    axes: &'t Axes,
    columns: BoxColumns<'t>,
    /// Members of the first group that are not out by themselves.
    members: Vec<u32>,
    /// Evaluations so far, of members of either group.
    pub evaluated: u64,
    stop: &'t AtomicBool,
}

impl<'t> Pairs<'t> {
    /// A counter for a tape. Once `stop` is set its results are incomplete and must be dropped.
    pub fn new(tape: &'t StudyTape, axes: &'t Axes, stop: &'t AtomicBool) -> Self {
        Self { tape, axes, columns: BoxColumns::new(tape, axes), members: Vec::new(), evaluated: 0, stop }
    }

    /// How many designs of a box satisfy all instances; looks for the `best` value of the number in role `goal` on the way, if asked to.
    /// Axes that do not vary in what is asked stay at their first level and count once.
    pub fn count(&mut self, pairing: &Pairing, spans: &Spans, instances: &[Instance<'_>], mut best: Option<(usize, &mut BestPair)>) -> u64 {
        let mut total = 0;
        self.each_outer(pairing, spans, |pairs, at| {
            let best = best.as_mut().map(|(role, best)| (*role, &mut **best));
            total += pairs.count_at(pairing, at, instances, best, &mut |_, _| ());
        });
        total
    }

    /// Counts them apart by the levels of all axes but those of the first group: `tell` is told of such levels, and how many satisfy all.
    pub fn count_each(&mut self, pairing: &Pairing, spans: &Spans, instances: &[Instance<'_>], mut tell: impl FnMut(&Spans, u64)) {
        self.each_outer(pairing, spans, |pairs, at| {
            pairs.count_at(pairing, at, instances, None, &mut |member, found| {
                tell(&at.at(pairing.second.iter().copied(), member as u64), found);
            });
        });
    }

    /// Calls for every combination of the levels of the shared axes.
    fn each_outer(&mut self, pairing: &Pairing, spans: &Spans, mut call: impl FnMut(&mut Self, &Spans)) {
        let mut at = *spans;
        pairing.outer.iter().for_each(|&axis| at[axis] = Span::at(spans[axis].low));
        loop {
            call(self, &at);
            let mut rest = pairing.outer.iter().rev();
            loop {
                let Some(&axis) = rest.next().filter(|_| !self.stop.load(Ordering::Relaxed)) else { return };
                if at[axis].low < spans[axis].high {
                    at[axis] = Span::at(at[axis].low + 1);
                    break;
                }
                at[axis] = Span::at(spans[axis].low);
            }
        }
    }

    /// The same with the shared axes at one level.
    fn count_at(
        &mut self,
        pairing: &Pairing,
        spans: &Spans,
        instances: &[Instance<'_>],
        best: Option<(usize, &mut BestPair)>,
        tell: &mut dyn FnMut(usize, u64),
    ) -> u64 {
        let scenarios = scenarios_of(instances, self.axes);
        for instance in instances.iter().filter(|it| pairing.roles[it.role] == PairRole::Outer) {
            if !self.holds_for_one(spans, instance) {
                return 0;
            }
        }
        let mut channels: Vec<Channel> = Vec::new();
        if !self.list_first(pairing, spans, instances, &scenarios, best.as_ref().map(|it| it.0), &mut channels) {
            return 0;
        }
        let (alive, links) = self.list_second(pairing, spans, instances, &scenarios, &channels);
        let second: Vec<usize> = (0..alive.len()).filter(|&member| alive[member]).collect();
        let goal = best.and_then(|(role, best)| match &pairing.roles[role] {
            PairRole::Both(chain) => {
                let channel = channels.iter().position(|it| it.node == chain.channel)?;
                let (_, others) = self.others_of(pairing, spans, chain, &scenarios[channels[channel].scenario]);
                Some(PairGoal { chain, channel, others, best })
            }
            _ => None,
        });
        self.count_members(&Listed { pairing, spans, instances, links }, &mut channels, &second, goal, tell)
    }

    /// Does a requirement hold that no varying axis but the shared ones has to do with?
    fn holds_for_one(&mut self, spans: &Spans, instance: &Instance<'_>) -> bool {
        let spans = with_scenario(spans, &instance.scenario, self.axes);
        let value = match instance.requirement.source {
            NumberSource::Known(value) => value,
            NumberSource::Axis(axis, column) => self.axes.all[axis].own[column][spans[axis].low as usize],
            NumberSource::Node(node, _) => {
                self.columns.enter(&instance.requirement.needed, &spans, &[]);
                instance.requirement.source.shown(self.columns.value(node).at(0))
            }
        };
        self.evaluated += 1;
        instance.requirement.holds(value)
    }

    /// Members of the first group that satisfy what is about them alone, and their starts of all chains; false if there are none.
    fn list_first(
        &mut self,
        pairing: &Pairing,
        spans: &Spans,
        instances: &[Instance<'_>],
        scenarios: &[Spans],
        goal: Option<usize>,
        channels: &mut Vec<Channel>,
    ) -> bool {
        let size = pairing.first.iter().map(|&axis| spans[axis].count()).product::<u64>() as usize;
        let mut alive = vec![true; size];
        for (number, scenario) in scenarios.iter().enumerate() {
            let here: Vec<&Instance<'_>> = instances.iter().filter(|it| same_scenario(&it.scenario, scenario, self.axes)).collect();
            let masks: Vec<&Requirement> =
                here.iter().filter(|it| pairing.roles[it.role] == PairRole::First).map(|it| it.requirement).collect();
            let roles = here.iter().map(|it| it.role).chain(goal.filter(|_| number == 0));
            let mut starts: Vec<Node> = Vec::new();
            for role in roles {
                if let PairRole::Both(chain) = &pairing.roles[role]
                    && !starts.contains(&chain.channel)
                {
                    starts.push(chain.channel);
                }
            }
            let asked = masks.iter().filter_map(|it| if let NumberSource::Node(node, _) = it.source { Some(node) } else { None });
            let needed = self.tape.list.needed_by(&asked.chain(starts.iter().copied()).collect::<Vec<_>>());
            let from = channels.len();
            channels.extend(starts.iter().map(|&node| Channel {
                node,
                scenario: number,
                values: Vec::with_capacity(size),
                ..Channel::default()
            }));
            self.columns.enter(&needed, &with_scenario(spans, scenario, self.axes), &pairing.first);
            self.evaluated += size as u64;
            for first in (0..size).step_by(CHUNK) {
                let count = CHUNK.min(size - first);
                self.columns.chunk(&needed, first as u64, count);
                self.judge(&masks, first, &mut alive[first..first + count]);
                for channel in &mut channels[from..] {
                    let value = self.columns.value(channel.node);
                    channel.values.extend((0..count).map(|lane| value.at(lane)));
                }
            }
        }
        self.members.clear();
        self.members.extend((0..size).filter(|&member| alive[member]).map(|member| member as u32));
        if self.members.len() < size {
            for channel in channels.iter_mut() {
                channel.values = self.members.iter().map(|&member| channel.values[member as usize]).collect();
            }
        }
        for channel in channels {
            let ends = channel.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &it| (low.min(it), high.max(it)));
            channel.finite = channel.values.iter().fold(true, |finite, it| finite & it.is_finite());
            channel.ends = ends;
        }
        !self.members.is_empty()
    }

    /// Judges what the last chunk of columns says of requirements.
    fn judge(&self, requirements: &[&Requirement], first: usize, alive: &mut [bool]) {
        for requirement in requirements {
            match requirement.source {
                NumberSource::Node(node, _) => {
                    let value = self.columns.value(node);
                    for (lane, alive) in alive.iter_mut().enumerate() {
                        *alive &= requirement.holds(requirement.source.shown(value.at(lane)));
                    }
                }
                NumberSource::Axis(axis, column) => {
                    for (lane, alive) in alive.iter_mut().enumerate() {
                        let level = self.columns.levels((first + lane) as u64)[axis];
                        *alive &= requirement.holds(self.axes.all[axis].own[column][level as usize]);
                    }
                }
                NumberSource::Known(value) => alive.iter_mut().for_each(|alive| *alive &= requirement.holds(value)),
            }
        }
    }

    /// Which members of the second group satisfy what is about them alone, and what every chain combines its starts with.
    fn list_second(
        &mut self,
        pairing: &Pairing,
        spans: &Spans,
        instances: &[Instance<'_>],
        scenarios: &[Spans],
        channels: &[Channel],
    ) -> (Vec<bool>, Vec<Link>) {
        let size = pairing.second.iter().map(|&axis| spans[axis].count()).product::<u64>() as usize;
        let mut alive = vec![true; size];
        let mut links = Vec::new();
        for (number, scenario) in scenarios.iter().enumerate() {
            let here = |it: &&Instance<'_>| same_scenario(&it.scenario, scenario, self.axes);
            let masks: Vec<&Requirement> =
                instances.iter().filter(here).filter(|it| pairing.roles[it.role] == PairRole::Second).map(|it| it.requirement).collect();
            if !masks.is_empty() {
                let asked: Vec<Node> =
                    masks.iter().filter_map(|it| if let NumberSource::Node(node, _) = it.source { Some(node) } else { None }).collect();
                let needed = self.tape.list.needed_by(&asked);
                self.columns.enter(&needed, &with_scenario(spans, scenario, self.axes), &pairing.second);
                self.evaluated += size as u64;
                for first in (0..size).step_by(CHUNK) {
                    let count = CHUNK.min(size - first);
                    self.columns.chunk(&needed, first as u64, count);
                    self.judge(&masks, first, &mut alive[first..first + count]);
                }
            }
            for (at, instance) in instances.iter().enumerate().filter(|(_, it)| same_scenario(&it.scenario, scenario, self.axes)) {
                if let PairRole::Both(chain) = &pairing.roles[instance.role] {
                    let channel = channels.iter().position(|it| it.node == chain.channel && it.scenario == number);
                    let (width, others) = self.others_of(pairing, spans, chain, scenario);
                    links.push(Link { instance: at, channel: channel.expect("every chain's start was listed"), others, width });
                }
            }
        }
        (alive, links)
    }

    /// What a chain combines its starts with, for every member of the second group.
    fn others_of(&mut self, pairing: &Pairing, spans: &Spans, chain: &Chain, scenario: &Spans) -> (usize, Vec<f64>) {
        let size = pairing.second.iter().map(|&axis| spans[axis].count()).product::<u64>() as usize;
        let needed = self.tape.list.needed_by(&chain.others);
        self.columns.enter(&needed, &with_scenario(spans, scenario, self.axes), &pairing.second);
        self.evaluated += size as u64;
        let width = chain.others.len();
        let mut others = Vec::with_capacity(size * width);
        for first in (0..size).step_by(CHUNK) {
            let count = CHUNK.min(size - first);
            self.columns.chunk(&needed, first as u64, count);
            for lane in 0..count {
                others.extend(chain.others_at(&self.columns, lane));
            }
        }
        (width, others)
    }

    /// Counts the pairs, member by member of the second group; `tell` is told of each that has some.
    fn count_members(
        &self,
        listed: &Listed<'_>,
        channels: &mut [Channel],
        second: &[usize],
        mut goal: Option<PairGoal<'_>>,
        tell: &mut dyn FnMut(usize, u64),
    ) -> u64 {
        let Listed { pairing, spans, instances, links } = listed;
        let mut total = 0;
        // Of every channel: between which starts all is well.
        let mut limits = vec![(f64::NEG_INFINITY, f64::INFINITY); channels.len()];
        let mut unclear: Vec<usize> = Vec::new();
        'members: for &member in second {
            limits.fill((f64::NEG_INFINITY, f64::INFINITY));
            unclear.clear();
            for (number, link) in links.iter().enumerate() {
                let (channel, requirement) = (&channels[link.channel], instances[link.instance].requirement);
                let PairRole::Both(chain) = &pairing.roles[instances[link.instance].role] else { continue };
                let others = &link.others[member * link.width..][..link.width];
                let (low, high) = channel.ends;
                let Some(ends) = chain.ends(low, high, others).filter(|_| channel.finite) else {
                    unclear.push(number);
                    continue;
                };
                match (requirement.holds(ends.0), requirement.holds(ends.1)) {
                    (true, true) => {}
                    (false, false) => continue 'members,
                    (true, false) => {
                        let last = threshold(|start| chain.value(start, others), requirement, (low, ends.0), (high, ends.1));
                        limits[link.channel].1 = limits[link.channel].1.min(last);
                    }
                    (false, true) => {
                        let last = threshold(|start| chain.value(start, others), requirement, (high, ends.1), (low, ends.0));
                        limits[link.channel].0 = limits[link.channel].0.max(last);
                    }
                }
            }
            let limited = |limits: &(f64, f64)| limits.0 > f64::NEG_INFINITY || limits.1 < f64::INFINITY;
            let mut which = (0..limits.len()).filter(|&channel| limited(&limits[channel]));
            let found = match (which.next(), which.next(), unclear.is_empty()) {
                (None, _, true) => self.members.len() as u64,
                (Some(only), None, true) => channels[only].within(limits[only]),
                _ => {
                    let all = 0..self.members.len();
                    all.filter(|&at| is_inside(channels, &limits, at) && listed.is_clear(channels, &unclear, member, at)).count() as u64
                }
            };
            total += found;
            if found > 0 {
                tell(member, found);
            }
            if let Some(goal) = &mut goal
                && found > 0
                && goal.may_improve(channels, &limits, member)
            {
                for at in 0..self.members.len() {
                    if is_inside(channels, &limits, at) && listed.is_clear(channels, &unclear, member, at) {
                        let value = goal.value(channels, member, at);
                        if goal.best.reaches(value) {
                            let index = self.index(pairing, spans, u64::from(self.members[at]), member as u64);
                            if goal.best.beats(value, index) {
                                (goal.best.value, goal.best.index) = (value, index);
                            }
                        }
                    }
                }
            }
        }
        total
    }

    /// The design index of a pair.
    fn index(&self, pairing: &Pairing, spans: &Spans, first: u64, second: u64) -> u64 {
        let pair = spans.at(pairing.first.iter().copied(), first).at(pairing.second.iter().copied(), second);
        self.axes.least_index(&pair)
    }
}

impl Listed<'_> {
    /// Does a pair satisfy what no threshold was found for?
    fn is_clear(&self, channels: &[Channel], unclear: &[usize], member: usize, at: usize) -> bool {
        unclear.iter().all(|&number| {
            let link = &self.links[number];
            let instance = &self.instances[link.instance];
            let PairRole::Both(chain) = &self.pairing.roles[instance.role] else { return true };
            let value = chain.value(channels[link.channel].values[at], &link.others[member * link.width..][..link.width]);
            instance.requirement.holds(value)
        })
    }
}

/// What is sought besides the count.
struct PairGoal<'a> {
    chain: &'a Chain,
    channel: usize,
    others: Vec<f64>,
    best: &'a mut BestPair,
}

impl PairGoal<'_> {
    fn others(&self, member: usize) -> &[f64] {
        let width = self.chain.others.len();
        &self.others[member * width..][..width]
    }

    fn value(&self, channels: &[Channel], member: usize, at: usize) -> f64 {
        self.chain.value(channels[self.channel].values[at], self.others(member))
    }

    /// Might one of the starts within the limits reach the best so far?
    fn may_improve(&self, channels: &mut [Channel], limits: &[(f64, f64)], member: usize) -> bool {
        let channel = &mut channels[self.channel];
        let (low, high) = channel.nearest_within(limits[self.channel]);
        match self.chain.ends(low, high, self.others(member)).filter(|_| channel.finite) {
            Some(ends) => self.best.reaches(ends.0) || self.best.reaches(ends.1),
            None => true,
        }
    }
}

impl Channel {
    fn cast(&mut self) -> &Buckets {
        if !std::mem::replace(&mut self.cast, true) {
            self.buckets.fill(&self.values, self.ends.0, self.ends.1);
        }
        &self.buckets
    }

    /// How many starts are within limits.
    fn within(&mut self, (low, high): (f64, f64)) -> u64 {
        let buckets = self.cast();
        let most = if high < f64::INFINITY { buckets.at_most(high) } else { self.values.len() as u64 };
        let least = if low > f64::NEG_INFINITY { self.buckets.below(low) } else { 0 };
        most.saturating_sub(least)
    }

    /// The least and the largest start within limits that hold at least one.
    fn nearest_within(&mut self, (low, high): (f64, f64)) -> (f64, f64) {
        if low == f64::NEG_INFINITY && high == f64::INFINITY || !self.finite {
            return self.ends;
        }
        let ends = self.ends;
        let buckets = self.cast();
        let first = if low > f64::NEG_INFINITY { buckets.first_at_least(low).unwrap_or(ends.0) } else { ends.0 };
        let last = if high < f64::INFINITY { buckets.last_at_most(high).unwrap_or(ends.1) } else { ends.1 };
        (first, last)
    }
}

fn is_inside(channels: &[Channel], limits: &[(f64, f64)], at: usize) -> bool {
    channels.iter().zip(limits).all(|(channel, (low, high))| {
        channel.values[at] >= *low && channel.values[at] <= *high || *low == f64::NEG_INFINITY && *high == f64::INFINITY
    })
}

/// Guesses of a threshold by straight lines, before halves.
const STRAIGHT: u32 = 9;

/// The number with as many between it and either: near zero there are as many as anywhere else.
fn halfway(a: f64, b: f64) -> f64 {
    let flip = |bits: i64| bits ^ ((bits >> 63) as u64 >> 1) as i64;
    let (a, b) = (flip(a.to_bits() as i64), flip(b.to_bits() as i64));
    f64::from_bits(flip((a & b) + ((a ^ b) >> 1)) as u64)
}

/// The last number on the way from a good to a bad one that is good, for a function that rises or falls all the way; both come with
/// their values.
#[inline]
fn threshold(function: impl Fn(f64) -> f64, requirement: &Requirement, good: (f64, f64), bad: (f64, f64)) -> f64 {
    let bound = match requirement.test {
        super::requirement::Test::Low(bound, _) | super::requirement::Test::High(bound, _) => bound,
        super::requirement::Test::Finite => return good.0,
    };
    let (mut good, mut bad) = (good, bad);
    let towards = |from: f64, to: f64| if to > from { from.next_up() } else { from.next_down() };
    // What is nearly straight is hit at once, on one side; the other side follows in growing steps.
    for attempt in 0u32.. {
        if towards(good.0, bad.0) == bad.0 || good.0 == bad.0 {
            break;
        }
        let share = (bound - good.1) / (bad.1 - good.1);
        let straight = good.0 + (bad.0 - good.0) * share;
        let mut guess = match attempt % 3 {
            _ if attempt > STRAIGHT => halfway(good.0, bad.0),
            0 => straight,
            1 => straight + (straight.abs() * f64::EPSILON) * f64::from(1u32 << (attempt / 3)) * (bad.0 - good.0).signum(),
            _ => straight - (straight.abs() * f64::EPSILON) * f64::from(1u32 << (attempt / 3)) * (bad.0 - good.0).signum(),
        };
        let (low, high) = (good.0.min(bad.0), good.0.max(bad.0));
        if !(guess > low && guess < high) {
            guess = if attempt % 2 == 0 { towards(good.0, bad.0) } else { towards(bad.0, good.0) };
        }
        let value = function(guess);
        if requirement.holds(value) { good = (guess, value) } else { bad = (guess, value) }
    }
    good.0
}

/// The scenarios that occur among instances.
fn scenarios_of(instances: &[Instance<'_>], axes: &Axes) -> Vec<Spans> {
    let mut found: Vec<Spans> = Vec::new();
    for instance in instances {
        if !found.iter().any(|it| same_scenario(it, &instance.scenario, axes)) {
            found.push(instance.scenario);
        }
    }
    if found.is_empty() {
        found.push(axes.whole());
    }
    found
}

fn same_scenario(a: &Spans, b: &Spans, axes: &Axes) -> bool {
    a.0[axes.designs..] == b.0[axes.designs..]
}

/// The designs of one box in the scenarios of another.
pub fn with_scenario(designs: &Spans, scenario: &Spans, axes: &Axes) -> Spans {
    let mut spans = *designs;
    spans.0[axes.designs..].copy_from_slice(&scenario.0[axes.designs..]);
    spans
}

#[cfg(test)]
mod tests {
    use super::super::requirement::Test;
    use super::*;
    use std::cell::Cell;

    /// A threshold of a function, and how often it was asked for.
    fn found(test: Test, good: f64, bad: f64, function: fn(f64) -> f64) -> (f64, u32) {
        let requirement = Requirement { source: NumberSource::Known(0.0), test, finite: false, needed: Vec::new() };
        let asked = Cell::new(0);
        let counted = |start| {
            asked.set(asked.get() + 1);
            function(start)
        };
        (threshold(counted, &requirement, (good, function(good)), (bad, function(bad))), asked.get())
    }

    #[test]
    fn a_threshold_is_the_last_good_number_wherever_it_lies() {
        let (last, asked) = found(Test::High(3.0, false), 0.0, 100.0, |x| 3.0 * x + 1.5);
        assert!(last == 0.5 && asked < 20, "{last} after {asked}");
        let (last, asked) = found(Test::High(2.0, false), 0.0, 100.0, f64::sqrt);
        assert!(last.sqrt() == 2.0 && last.next_up().sqrt() > 2.0 && asked < 80, "{last} after {asked}");
        // Next to zero there are more numbers than between one and a thousand.
        let (last, asked) = found(Test::Low(0.0, true), 1000.0, 0.0, |x| 5.0 * x);
        assert!(last == f64::from_bits(1) && asked < 80, "{last:e} after {asked}");
        let (last, asked) = found(Test::High(0.0, true), -1000.0, 7.0, |x| x);
        assert!(last == -f64::from_bits(1) && asked < 80, "{last:e} after {asked}");
    }
}
