//! Axes given by a rule: `{ from, to, count }`, `{ from, to, step }`, linear or logarithmic.

use super::super::axis::Levels;
use super::law::likely_law;
use super::roles::AxisRole;
use super::table::TomlTable;
use super::value::{checked, input_number, measured, shown, shown_in, whole};
use super::{MOST_LEVELS, Reader, choice};
use crate::models::Input;
use crate::table::short;
use crate::units::NONE;

/// Neighbouring levels closer than this, relative to the larger end, would round to the same number.
const LEAST_STEP: f64 = 4.0 * f64::EPSILON;
/// How far the last level may exceed `to`, relative: 0.1 + 2 * 0.1 is a little more than 0.3.
const SLACK: f64 = 1e-12;

/// The two ends. Their distance times any number of levels is finite.
#[derive(Clone, Copy)]
struct RangeEnds {
    from: f64,
    to: f64,
    log: bool,
}

impl RangeEnds {
    /// Distance of the ends: their difference, or decades on a logarithmic axis.
    fn width(self) -> f64 {
        if self.log { libm::log10(self.to) - libm::log10(self.from) } else { self.to - self.from }
    }

    /// Least distance at which two levels are different numbers, in the same measure.
    fn least_step(self) -> f64 {
        if self.log { LEAST_STEP } else { LEAST_STEP * self.from.abs().max(self.to.abs()) }
    }
}

/// Checks levels that do not come from a study's text: they must be such as a text could give.
pub(in super::super) fn check_levels(levels: &Levels, input: &Input) -> Result<(), String> {
    if !matches!(levels, Levels::List(_)) && input.is_enumeration() {
        return Err(format!("{} takes words only, and a range has none", input.name));
    }
    let counted = |count: u64| {
        let good = (1..=MOST_LEVELS).contains(&count);
        if good { Ok(()) } else { Err(format!("{count} levels are out of range; there must be 1 to {MOST_LEVELS}")) }
    };
    let ends = |from, to, log| {
        let ends = RangeEnds { from: checked(from, input)?, to, log };
        check_ends(ends, input).map(|()| ends)
    };
    match *levels {
        Levels::List(ref values) => match values.iter().find(|&&value| !input.accepts(value)) {
            Some(&value) => checked(value, input).map(|_| ()),
            None if values.is_empty() => Err("the list is empty; give at least one value".to_owned()),
            None => Ok(()),
        },
        Levels::Even { from, to, count, log } => {
            counted(count)?;
            checked(to, input)?;
            even(ends(from, to, log)?, count, input)?;
            within(levels, input)
        }
        Levels::Step { from, step, count, log } => {
            counted(count)?;
            if !step.is_finite() {
                return Err(format!("the step {step} cannot be used; give a finite number"));
            }
            checked_step(step, input)?;
            within(levels, input)?;
            stepped(ends(from, levels.value(count - 1), log)?, step, input).map(|_| ())
        }
        Levels::Continuous { from, to, log } => {
            checked(to, input)?;
            ends(from, to, log)?;
            if from == to { Err(format!("from and to are both {}; write the value alone", shown(from))) } else { Ok(()) }
        }
    }
}

/// The ends are in range, but the last level may exceed them by rounding.
fn within(levels: &Levels, input: &Input) -> Result<(), String> {
    let (low, high) = levels.ends();
    match [low, high].into_iter().find(|&level| !input.accepts(level)) {
        Some(beyond) => Err(format!("the level {} is out of range; it must be {}; use count", shown(beyond), input.valid.in_words())),
        None => Ok(()),
    }
}

impl Reader<'_> {
    /// The levels of a range. Reports what is wrong with it.
    pub(super) fn range(&self, table: &TomlTable<'_>, input: &Input, label: &str, role: AxisRole) -> Option<Levels> {
        let problems = self.problems;
        const KEYS: &[&str] = super::keys::RANGE;
        let misspelt = table.entries.iter().filter(|it| !KEYS.contains(&it.key)).find_map(|it| Some((it, likely_law(it.key)?)));
        if let Some((entry, law)) = misspelt.filter(|_| role == AxisRole::Uncertainty) {
            problems.add(entry.key_at, format!("{label}: unknown key \"{}\"; did you mean the distribution \"{law}\"?", entry.key));
            return None;
        }
        let known = table.check_keys(problems, label, KEYS);
        let end = |key: &str| match table.get(key) {
            Some(entry) => {
                let value = input_number(entry.node, input);
                value.map_err(|error| problems.add(entry.node.at, format!("{label}: {error}"))).ok()
            }
            None => {
                // An unknown key, which has been reported, is probably this one misspelt.
                if known {
                    problems.add(
                        table.at,
                        format!("{label}: a range needs from and to, \"{key}\" is missing; write {{ from = ..., to = ... }}"),
                    );
                }
                None
            }
        };
        let (from, to) = (end("from"), end("to"));
        let spacings = [("linear", false), ("log", true)];
        let log = table.get("spacing").map_or(Some(false), |entry| choice(entry, problems, label, &spacings));
        let count = table.get("count").map(|entry| whole(entry, problems, label, 1, MOST_LEVELS));
        let step = table.get("step").map(|entry| {
            let unit = if log == Some(true) { NONE } else { input.unit };
            let step = measured(entry.node, unit).and_then(|step| checked_step(step, input));
            step.map_err(|error| problems.add(entry.node.at, format!("{label}: {error}"))).ok()
        });
        if let (Some(_), Some(entry)) = (count, table.get("step")) {
            problems.add(entry.key_at, format!("{label}: count and step are both given; keep one of the two"));
            return None;
        }
        if !known {
            return None;
        }
        let ends = RangeEnds { from: from?, to: to?, log: log? };
        let levels = check_ends(ends, input).and_then(|()| match (count, step) {
            (Some(count), _) => count.map(|count| even(ends, count, input)).transpose(),
            (_, Some(step)) => step.map(|step| stepped(ends, step, input)).transpose(),
            (None, None) if input.integer || self.counts(ends, input) => stepped(ends, 1.0, input).map(Some),
            (None, None) => self.unruled(ends, role).map(Some),
        });
        let levels = levels.map_err(|error| problems.add(table.at, format!("{label}: {error}"))).ok().flatten()?;
        within(&levels, input).map_err(|error| problems.add(table.at, format!("{label}: {error}"))).ok()?;
        self.short_ranges.borrow_mut().extend(short_of(ends, &levels, input));
        Some(levels)
    }

    /// Is this a variable without a unit that goes from one whole number to another, where all designs are judged? Then it counts.
    fn counts(&self, RangeEnds { from, to, log }: RangeEnds, input: &Input) -> bool {
        let is_variable = self.is_variable(&input.name);
        is_variable && input.unit == NONE && from.fract() == 0.0 && to.fract() == 0.0 && !log && !self.sampled
    }

    /// A range with neither count nor step: for sampled designs only.
    fn unruled(&self, RangeEnds { from, to, log }: RangeEnds, role: AxisRole) -> Result<Levels, String> {
        let example = format!("{{ from = {}, to = {}, count = 11 }}", shown(from), shown(to));
        match (role, self.sampled) {
            (AxisRole::Design, true) if from == to => Err(format!("from and to are both {}; write the value alone", shown(from))),
            (AxisRole::Design, true) => Ok(Levels::Continuous { from, to, log }),
            (AxisRole::Design, false) => {
                Err(format!("a range needs count or step, such as {example}; or sample the designs: add [sample] with method and count"))
            }
            _ => Err(format!("a range needs count or step, such as {example}; only [design] can be sampled")),
        }
    }
}

/// What is said of steps that end before the range does.
fn short_of(RangeEnds { from, to, log }: RangeEnds, levels: &Levels, input: &Input) -> Option<String> {
    let Levels::Step { step, count, .. } = *levels else { return None };
    let last = levels.value(count - 1);
    // What rounding leaves is no gap.
    let gap = RangeEnds { from: last, to, log }.width();
    if gap <= 1e-6 * step + if log { SLACK } else { SLACK * to.abs() } {
        return None;
    }
    let [from, to, last, step] = [from, to, last, step].map(short);
    let (steps, divides) = if log { ("decades", "the decades of the range") } else { ("steps", "the range") };
    let name = &input.name;
    Some(format!(
        "{name}: {steps} of {step} from {from} end at {last}, before to = {to}; use a step that divides {divides}, count in place of step, or to = {last}"
    ))
}

/// A step must be greater than 0, and a whole number for an integer input.
fn checked_step(step: f64, input: &Input) -> Result<f64, String> {
    if step <= 0.0 {
        let remedy = "step must be greater than 0; to run downwards use count";
        return Err(format!("the step {} cannot be used; {remedy}", shown(step)));
    }
    if input.integer && step.fract() != 0.0 {
        return Err(format!("the step {} is not a whole number, but {} takes whole numbers only; use step = 1", shown(step), input.name));
    }
    Ok(step)
}

/// Checks what every range must fulfil.
fn check_ends(ends: RangeEnds, input: &Input) -> Result<(), String> {
    let RangeEnds { from, to, log } = ends;
    if log && input.integer {
        return Err("logarithmic levels of a whole number are not whole; list them, such as [1, 10, 100]".to_owned());
    }
    if log && (from <= 0.0 || to <= 0.0) {
        let end = if from <= 0.0 { from } else { to };
        return Err(format!("logarithmic spacing cannot reach {}; from and to must be greater than 0", shown(end)));
    }
    // Levels are computed as i * width / n: that must not overflow.
    let most = if log { 300.0 } else { 1e290 };
    if ends.width().abs() > most {
        return Err(format!("from {} to {} is too wide to compute with; narrow the range", shown(from), shown(to)));
    }
    if input.integer && from.abs().max(to.abs()) > MOST_LEVELS as f64 {
        return Err(format!("whole numbers beyond {} are not exact; narrow the range", shown(MOST_LEVELS as f64)));
    }
    Ok(())
}

/// `count` levels from end to end.
#[allow(clippy::cast_precision_loss, reason = "at most 2^53 levels")]
fn even(ends: RangeEnds, count: u64, input: &Input) -> Result<Levels, String> {
    let RangeEnds { from, to, log } = ends;
    let gaps = (count - 1) as f64;
    match (count, from == to) {
        (1, true) => return Ok(Levels::Even { from, to, count, log }),
        (1, false) => {
            let (low, high) = (shown(from), shown(to));
            return Err(format!("one level cannot be both {low} and {high}; use count = 2 or more, or the value {low} alone"));
        }
        (_, true) => {
            return Err(format!("from and to are both {}, so all {count} levels would be equal; write the value alone", shown(from)));
        }
        _ => {}
    }
    if ends.width().abs() / gaps < ends.least_step() {
        return Err(format!("{count} levels from {} to {} are too close to tell apart; use fewer", shown(from), shown(to)));
    }
    if input.integer && (to - from) % gaps != 0.0 {
        let (low, high) = (shown(from), shown(to));
        return Err(format!("{count} even levels from {low} to {high} are not all whole numbers; use another count, or step = 1"));
    }
    if input.integer && gaps * (to - from).abs() > MOST_LEVELS as f64 {
        return Err(format!("{count} levels from {} to {} are too many to stay exact; use step", shown(from), shown(to)));
    }
    Ok(Levels::Even { from, to, count, log })
}

/// Levels from `from` by `step` while they do not pass `to`.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "checked to be whole and below 2^53"
)]
fn stepped(ends: RangeEnds, step: f64, input: &Input) -> Result<Levels, String> {
    let RangeEnds { from, to, log } = ends;
    let size = if log { format!("{} decades", shown(step)) } else { shown_in(step, input.unit) };
    if from > to {
        return Err(format!("from {} to {} runs downwards, which steps cannot; swap the ends or use count", shown(from), shown(to)));
    }
    // The division may be off by one: the levels themselves decide.
    let limit = to + SLACK * to.abs();
    let guess = (RangeEnds { to: limit, ..ends }.width() / step).floor();
    if guess >= MOST_LEVELS as f64 {
        return Err(format!("the step {size} makes {:.1e} levels, at most {MOST_LEVELS} can be numbered; use a larger step", guess + 1.0));
    }
    if from < to && step < ends.least_step() {
        return Err(format!("the step {size} is too small to tell levels up to {} apart; use a larger step", shown(to)));
    }
    let rule = |count| Levels::Step { from, step, count, log };
    let mut count = guess as u64 + 3;
    while count > 1 && rule(count).value(count - 1) > limit {
        count -= 1;
    }
    Ok(rule(count))
}
