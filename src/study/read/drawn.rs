//! `[probability]`, and what a study with distributions asks of its draws.
//!
//! Such a study is read twice: once for the drive that is drawn, with the constraints that a draw must keep, and once more for what is
//! asked of all draws, where the names mean statistics.

use super::super::axis::Axis;
use super::super::drawn::{
    AskedQuantity, ConfirmedEnd, Drive, MOST_CASES, MOST_CONFIRM, MOST_DRAWS, OVER_DRAWS, OverDraws, Probability, REPLICATES, SCREENED,
    Statistic, StatisticKind, UncertainInput, YIELD,
};
use super::super::quantity::Quantity;
use super::super::resolved::{Constraint, Goal, ReportColumn};
use super::super::spectrum::OverScenarios;
use super::law::is_law;
use super::quantities::GOALS;
use super::table::{Entry, TomlNode, TomlTable, shortened};
use super::value::{number, truth, whole};
use super::{Reader, choice, section, text};
use crate::models::{Model, Worse};
use crate::probability::{Effect, Sampling};
use crate::tape::{Known, Set};
use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::Arc;

/// Draws that choose designs and draws that judge them, unless the study says otherwise; and the most of each.
const DRAWS: (u64, u64) = (4096, MOST_DRAWS);
const CONFIRM: (u64, u64) = (100_000, MOST_CONFIRM);
/// What names in the second reading mean, by the place where they stand. One without a meaning has been reported.
pub(super) type Meanings = HashMap<usize, Option<Quantity>>;

/// What is asked of draws, as it is found.
struct Asks<'r, 'a> {
    reader: &'r Reader<'a>,
    fixed: &'r [f64],
    /// Of each output of the drive: the inputs that it depends on.
    depends: Vec<Set>,
    drawn: Set,
    statistics: RefCell<Vec<Statistic>>,
    meanings: RefCell<Meanings>,
}

/// Axes and inputs of the drive.
pub(super) struct DriveParts<'p> {
    pub(super) operation: &'p [Axis],
    pub(super) uncertainty: &'p [Axis],
    pub(super) fixed: &'p [f64],
}

impl Reader<'_> {
    /// What the study says of its draws, and what names mean where something is asked of them; `None` if nothing is drawn, or a problem was
    /// reported that leaves nothing.
    pub(super) fn probability(&self, top: &TomlTable<'_>, parts: &DriveParts<'_>) -> Option<(Probability, Meanings)> {
        let problems = self.problems;
        let table = section(top, "probability", problems);
        let inputs = self.uncertain.borrow();
        if inputs.is_empty() {
            if let Some(entry) = top.get("probability") {
                let example = "friction = { normal = { mean = 0.08, sd = 0.006 } }";
                let message = format!("[probability]: nothing is drawn; give an input of [uncertainty] a distribution, such as {example}");
                problems.add_if_complete(entry.key_at, message);
            }
            return None;
        }
        let before = problems.count();
        for (it, at) in inputs.iter().filter(|(it, _)| it.effect != Effect::Is) {
            self.check_toleranced(&it.name, *at, parts.fixed);
        }
        let cases = parts.operation.iter().map(Axis::count).try_fold(1, u64::checked_mul);
        if cases.is_none_or(|cases| cases > MOST_CASES) {
            let at = top.get("operation").map_or(0, |entry| entry.node.at);
            problems.add(
                at,
                format!("[operation]: a draw is judged in all operating cases, and there are more than {MOST_CASES}; use fewer levels"),
            );
        }
        let mut probability = self.settings(table.as_ref(), &inputs, section(top, "uncertainty", problems).as_ref())?;
        let asks = Asks::new(self, &inputs, parts.fixed);
        let drive = Drive {
            model: self.model.clone(),
            operation: parts.operation.to_vec(),
            spectrum: self.spectrum.borrow().clone(),
            constraints: asks.constraints(section(top, "constraints", problems).as_ref()),
        };
        asks.objectives(section(top, "objectives", problems).as_ref());
        asks.report(section(top, "report", problems).as_ref());
        let (mut statistics, meanings) = (asks.statistics.take(), asks.meanings.take());
        let told = |end: ConfirmedEnd| Statistic { name: end.name().to_owned(), kind: StatisticKind::Confirmed(end) };
        let is_told = |end: &ConfirmedEnd| match end {
            ConfirmedEnd::StandardError => probability.sampling != Sampling::Random,
            _ => probability.enclosure || !end.is_proven(),
        };
        statistics.extend(ConfirmedEnd::ALL.into_iter().filter(is_told).map(told));
        if !statistics.iter().any(|it| it.kind == StatisticKind::Yield) {
            let remedy = "write yield = { min = 0.999 } in [constraints] or yield = \"max\" in [objectives]";
            let message = format!("inputs have distributions, but nothing is asked of the yield; {remedy}");
            problems.add_if_complete(inputs.first().map_or(0, |it| it.1), message);
        }
        (probability.drive, probability.statistics) = (drive, statistics);
        probability.levels = parts.uncertainty.iter().map(Axis::count).product();
        let drawn = probability.choosing().map_err(|problem| {
            let at = table.as_ref().map_or(0, |table| table.get("correlation").map_or(table.at, |entry| entry.node.at));
            problems.add(at, format!("[probability]: {problem}"));
        });
        (problems.count() == before && drawn.is_ok()).then_some((probability, meanings))
    }

    /// The `[probability]` table.
    fn settings(
        &self,
        table: Option<&TomlTable<'_>>,
        inputs: &[(UncertainInput, usize)],
        uncertainty: Option<&TomlTable<'_>>,
    ) -> Option<Probability> {
        let (problems, label) = (self.problems, "[probability]");
        let before = problems.count();
        let part = |key: &str| table.and_then(|table| table.get(key));
        if let Some(table) = table {
            table.check_keys(problems, label, super::keys::PROBABILITY);
        }
        let count = |key: &str, (default, most): (u64, u64)| part(key).map_or(Some(default), |it| whole(it, problems, label, 1, most));
        let (draws, confirm) = (count("draws", DRAWS), count("confirm", CONFIRM));
        let seed = part("seed").map_or(Some(1), |it| whole(it, problems, label, 0, u64::MAX));
        let methods = [
            ("random", Sampling::Random),
            ("latin-hypercube", Sampling::LatinHypercube { replicates: REPLICATES }),
            ("sobol", Sampling::Sobol { replicates: REPLICATES }),
        ];
        let sampling = part("method").map_or(Some(Sampling::Random), |entry| choice(entry, problems, label, &methods));
        let enclosure = part("enclosure").map_or(Some(false), |entry| truth(entry, problems, label));
        let correlation = part("correlation").map_or_else(Vec::new, |entry| self.correlations(entry.node, inputs, uncertainty));
        let (draws, confirm, seed, sampling, enclosure) = (draws?, confirm?, seed?, sampling?, enclosure?);
        let drive = Drive { model: self.model.clone(), operation: Vec::new(), spectrum: None, constraints: Vec::new() };
        let inputs = inputs.iter().map(|it| it.0.clone()).collect();
        let probability =
            Probability { inputs, correlation, draws, confirm, seed, sampling, levels: 1, enclosure, drive, statistics: Vec::new() };
        (problems.count() == before).then_some(probability)
    }

    fn correlations(
        &self,
        node: TomlNode<'_>,
        inputs: &[(UncertainInput, usize)],
        uncertainty: Option<&TomlTable<'_>>,
    ) -> Vec<(usize, usize, f64)> {
        let problems = self.problems;
        let example = "[[\"friction\", \"tight_tension_N\", -0.3]]";
        let Some(pairs) = node.list() else {
            problems.add(node.at, format!("correlation: found {}, wanted a list of pairs such as {example}", node.found()));
            return Vec::new();
        };
        let pair = |node: TomlNode<'_>| {
            let parts: Vec<TomlNode<'_>> = node.list().map_or_else(Vec::new, Iterator::collect);
            let [first, second, value] = parts[..] else {
                problems.add(node.at, format!("correlation: wanted two inputs and a number, such as {example}"));
                return None;
            };
            let place = |node: TomlNode<'_>| {
                let name = text(node, problems, "correlation")?;
                let found = inputs.iter().position(|it| it.0.name == name);
                // One whose distribution is wrong has been told of.
                if found.is_none() && uncertainty.is_none_or(|it| it.get(&name).is_none_or(|it| !is_law(it))) {
                    let known: Vec<_> = inputs.iter().map(|it| it.0.name.as_str()).collect();
                    let message = format!("correlation: {} has no distribution; these have: {}", shortened(&name), known.join(", "));
                    problems.add(node.at, message);
                }
                found
            };
            let (first, second) = (place(first), place(second));
            let found = number(value).unwrap_or_else(|| Err(format!("found {}, wanted a number", value.found())));
            let value = found.map_err(|error| problems.add(value.at, format!("correlation: {error}"))).ok();
            Some((first?, second?, value?))
        };
        pairs.filter_map(pair).collect()
    }
}

impl<'r, 'a> Asks<'r, 'a> {
    fn new(reader: &'r Reader<'a>, inputs: &[(UncertainInput, usize)], fixed: &'r [f64]) -> Self {
        let model = reader.model;
        let depends = model.kernel.dependencies(&vec![Known::ANY; model.inputs.len()]);
        let drawn = inputs.iter().map(|it| it.0.input).collect();
        // What is passed on by the first stage reads what that stage reads.
        let depends = depends.outputs;
        Self { reader, fixed, depends, drawn, statistics: RefCell::default(), meanings: RefCell::default() }
    }

    /// Registers what stands at a place, and returns its meaning.
    fn means(&self, at: usize, kind: Option<StatisticKind>) -> Option<Quantity> {
        let quantity = kind.map(|kind| {
            let mut statistics = self.statistics.borrow_mut();
            let known = statistics.iter().position(|it| it.kind == kind);
            Quantity::Output(known.unwrap_or_else(|| {
                let name = self.name(&kind, &statistics);
                statistics.push(Statistic { name, kind });
                statistics.len() - 1
            }))
        });
        self.meanings.borrow_mut().insert(at, quantity);
        quantity
    }

    /// A name that no other statistic and no input has.
    fn name(&self, kind: &StatisticKind, taken: &[Statistic]) -> String {
        let model: &Model = self.reader.model;
        let name = match kind {
            StatisticKind::Yield => SCREENED.to_owned(),
            StatisticKind::Confirmed(end) => end.name().to_owned(),
            StatisticKind::YieldOf(constraint) => format!("{}_yield", constraint.name(model)),
            StatisticKind::Plain(asked) => asked.name(None, model),
            StatisticKind::Over(asked, over) => asked.name(Some(*over), model),
        };
        let is_taken = |name: &str| {
            let confirmed = ConfirmedEnd::ALL.iter().any(|it| it.name() == name);
            taken.iter().any(|it| it.name == name) || model.input(name).is_some() || (confirmed && *kind != StatisticKind::Yield)
        };
        if !is_taken(&name) {
            return name;
        }
        let end = kind.asked().map_or("other", |asked| asked.worse.word());
        (0..)
            .map(|more| if more == 0 { format!("{name}_{end}") } else { format!("{name}_{end}_{more}") })
            .find(|name| !is_taken(name))
            .unwrap_or(name)
    }

    /// The statistic of a name: `table` is where it is said what becomes of its values, `end` the worse end if the place says one.
    fn ask(&self, table: Option<&TomlTable<'_>>, (name, at): (&str, usize), label: &str, end: Option<Worse>) {
        let reader = self.reader;
        if name == YIELD {
            let wrong = table.and_then(|table| [OVER_DRAWS, "over_scenarios"].iter().find_map(|key| table.get(key)));
            if let Some(wrong) = wrong {
                reader.problems.add(wrong.key_at, format!("{label}: the yield is a share of the draws already; drop {}", wrong.key));
            }
            self.means(at, Some(StatisticKind::Yield));
            return;
        }
        let kind = self.kind(table, (name, at), label, end);
        match kind {
            Some(Ok(kind)) => self.means(at, Some(kind)),
            Some(Err(input)) => {
                self.meanings.borrow_mut().insert(at, Some(input));
                None
            }
            None => self.means(at, None),
        };
    }

    /// The kind of statistic, or an input that the design sets.
    fn kind(
        &self,
        table: Option<&TomlTable<'_>>,
        (name, at): (&str, usize),
        label: &str,
        end: Option<Worse>,
    ) -> Option<Result<StatisticKind, Quantity>> {
        let reader = self.reader;
        let quantity = reader.numeric(name, at, label, self.fixed)?;
        let over = table.map_or(Some(OverScenarios::Worst), |table| reader.over(table, quantity, label))?;
        let draws = match table.and_then(|table| table.get(OVER_DRAWS)) {
            Some(entry) => Some((self.over_draws(entry, label)?, entry.key_at)),
            None => None,
        };
        if let Quantity::Input(input) = quantity
            && reader.is_chosen(input)
        {
            if let Some((_, at)) = draws {
                let message = format!("{label}: \"{name}\" is a design input, the same in every draw; drop {OVER_DRAWS}");
                reader.problems.add(at, message);
                return None;
            }
            return Some(Err(quantity));
        }
        // A bound or goal of a standard deviation is about how much the values differ, and says nothing of which case is the worst.
        let end = end.filter(|_| !matches!(draws, Some((OverDraws::Sd, _))));
        let asked = AskedQuantity { quantity, over, worse: end.unwrap_or_else(|| quantity.worse(reader.model)) };
        if let Some((draws, _)) = draws {
            return Some(Ok(StatisticKind::Over(asked, draws)));
        }
        let depends = match quantity {
            Quantity::Input(input) => Set::one(input),
            Quantity::Output(output) => self.depends[output],
        };
        if depends.meets(self.drawn) {
            let remedy = format!("write {{ of = \"{name}\", {OVER_DRAWS} = \"mean\" }} or \"worst\", \"sd\", {{ quantile = 0.95 }}");
            reader.problems.add(at, format!("{label}: \"{name}\" differs from draw to draw; {remedy}"));
            return None;
        }
        Some(Ok(StatisticKind::Plain(asked)))
    }

    fn over_draws(&self, entry: &Entry<'_>, label: &str) -> Option<OverDraws> {
        let problems = self.reader.problems;
        let Some(table) = entry.node.table() else {
            let words = [("mean", OverDraws::Mean), ("sd", OverDraws::Sd), ("worst", OverDraws::Worst)];
            return choice(entry, problems, label, &words);
        };
        table.check_keys(problems, label, super::keys::QUANTILE);
        let Some(share) = table.get("quantile") else {
            problems.add(table.at, format!("{label}: {OVER_DRAWS}: \"quantile\" is missing; write {{ quantile = 0.95 }}"));
            return None;
        };
        let found = number(share.node).unwrap_or_else(|| Err(format!("found {}, wanted a number", share.node.found())));
        let value = found.map_err(|error| problems.add(share.node.at, format!("{label}: quantile: {error}"))).ok()?;
        if !(value > 0.0 && value <= 1.0) {
            problems.add(share.node.at, format!("{label}: the quantile {value} is none; it must be above 0 and at most 1"));
            return None;
        }
        Some(OverDraws::Quantile(value))
    }

    /// What an entry of `[constraints]` or `[objectives]` is about: its name and place.
    fn about<'e>(&self, entry: &'e Entry<'_>, table: Option<&'e TomlTable<'_>>, label: &str) -> Option<(String, usize)> {
        match table.and_then(|table| table.get("of")) {
            None => Some((entry.key.to_owned(), entry.key_at)),
            Some(of) => Some((text(of.node, self.reader.problems, label)?, of.node.at)),
        }
    }

    /// Constraints of single draws; what is asked of all draws is registered.
    fn constraints(&self, table: Option<&TomlTable<'_>>) -> Vec<Constraint> {
        let reader = self.reader;
        let problems = reader.problems;
        let mut own: Vec<Constraint> = Vec::new();
        for entry in table.iter().flat_map(|table| &table.entries).take_while(|_| !problems.is_full()) {
            let label = format!("constraint \"{}\"", shortened(entry.key));
            let table = entry.node.table();
            let has = |key: &str| table.as_ref().is_some_and(|table| table.get(key).is_some());
            let Some((name, at)) = self.about(entry, table.as_ref(), &label) else { continue };
            if name == YIELD {
                self.ask(table.as_ref(), (&name, at), &label, None);
                self.check_share(table.as_ref(), &["min", "above"], &label);
            } else if has(OVER_DRAWS) && has(YIELD) {
                let remedy = "a yield of its own counts draws, over_draws asks for a number over all of them; drop one of the two";
                problems.add(entry.key_at, format!("{label}: {remedy}"));
                self.means(at, None);
            } else if has(OVER_DRAWS) {
                let bounded = |keys: [&str; 2]| keys.iter().any(|key| has(key));
                let end = match (bounded(["min", "above"]), bounded(["max", "below"])) {
                    (true, false) => Worse::Lower,
                    (false, true) => Worse::Higher,
                    _ => {
                        problems.add(
                            entry.key_at,
                            format!("{label}: {OVER_DRAWS} needs one bound, min or max; write another entry with of for the other"),
                        );
                        self.means(at, None);
                        continue;
                    }
                };
                self.ask(table.as_ref(), (&name, at), &label, Some(end));
            } else if let Some(constraint) = reader.constraint(entry, self.fixed) {
                if has(YIELD) {
                    self.check_share(table.as_ref(), &[YIELD], &label);
                    self.means(at, Some(StatisticKind::YieldOf(constraint)));
                } else if own.iter().any(|it| (it.quantity, it.over) == (constraint.quantity, constraint.over)) {
                    problems.add(entry.key_at, format!("{label}: an entry before asks for the same; give all bounds in one entry"));
                } else {
                    own.push(constraint);
                }
            }
        }
        own
    }

    /// A wanted yield is a share.
    fn check_share(&self, table: Option<&TomlTable<'_>>, keys: &[&str], label: &str) {
        for entry in keys.iter().filter_map(|key| table?.get(key)) {
            if let Some(Ok(value)) = number(entry.node)
                && !(0.0..=1.0).contains(&value)
            {
                let message = format!("{label}: the yield {value} is none; it is a share of the draws, from 0 to 1");
                self.reader.problems.add(entry.node.at, message);
            }
        }
    }

    fn objectives(&self, table: Option<&TomlTable<'_>>) {
        for entry in table.iter().flat_map(|table| &table.entries).take_while(|_| !self.reader.problems.is_full()) {
            let label = format!("objective \"{}\"", shortened(entry.key));
            let table = entry.node.table();
            let goal = match &table {
                Some(table) => table.get("goal").and_then(|it| it.node.value.as_str()),
                None => entry.node.value.as_str(),
            };
            let goal = goal.and_then(|word| GOALS.iter().find(|(known, _)| *known == word)).map(|it| it.1);
            if let Some((name, at)) = self.about(entry, table.as_ref(), &label) {
                self.ask(table.as_ref(), (&name, at), &label, goal.map(Goal::worse));
            }
        }
    }

    fn report(&self, table: Option<&TomlTable<'_>>) {
        let Some(table) = table else { return };
        let problems = self.reader.problems;
        let ends = [("lowest", Worse::Lower), ("highest", Worse::Higher)];
        fn word<'t>(table: &TomlTable<'t>, key: &str) -> Option<&'t str> {
            table.get(key).and_then(|entry| entry.node.value.as_str())
        }
        let named = |table: Option<&TomlTable<'_>>, node: TomlNode<'_>, label: &str, end: Option<Worse>| {
            let Some(name) = node.value.as_str() else { return };
            if label == "columns" && ConfirmedEnd::ALL.iter().any(|it| it.name() == name) {
                problems.add(node.at, format!("columns: the tables have {name} anyway; drop it"));
                self.means(node.at, None);
                return;
            }
            self.ask(table, (name, node.at), label, end);
        };
        let items = |key: &str| table.get(key).and_then(|entry| entry.node.list()).into_iter().flatten();
        for node in items("columns") {
            match node.table() {
                None => named(None, node, "columns", None),
                Some(column) => {
                    let end = word(&column, "worst").and_then(|word| ends.iter().find(|it| it.0 == word)).map(|it| it.1);
                    if let Some(of) = column.get("of") {
                        named(Some(&column), of.node, "columns", end);
                    }
                }
            }
        }
        let goal = |table: &TomlTable<'_>, key: &str| {
            word(table, key).and_then(|word| GOALS.iter().find(|it| it.0 == word)).map(|it| it.1.worse())
        };
        let top = table.get("top").and_then(|entry| entry.node.table());
        for (label, key, end, part) in top
            .into_iter()
            .map(|it| ("top", "by", "goal", it))
            .chain(items("histograms").filter_map(|it| it.table()).map(|it| ("histograms", "of", "", it)))
            .chain(items("maps").filter_map(|it| it.table()).map(|it| ("maps", "value", "best", it)))
        {
            if let Some(contours) = part.get("contours") {
                problems.add(contours.key_at, "contours: a study with distributions has none; drop contours");
            }
            if let Some(entry) = part.get(key) {
                named(Some(&part), entry.node, label, goal(&part, end));
            }
        }
    }
}

/// Columns that every table of a study with distributions has: what fresh draws say of the yield.
pub(super) fn confirmed_columns(probability: &Probability) -> impl Iterator<Item = ReportColumn> {
    let is_told = |it: &usize| matches!(probability.statistics[*it].kind, StatisticKind::Confirmed(_));
    (0..probability.statistics.len()).filter(is_told).map(|it| ReportColumn::from(Quantity::Output(it)))
}

/// The model whose outputs are what the study asks of its draws.
pub(super) fn model_of(probability: &Probability, reader: &Reader<'_>) -> Option<Arc<Model>> {
    let model = probability.model().map_err(|problem| reader.problems.add(0, problem)).ok()?;
    let flaw = model.flaw_of_sizes();
    if let Some(flaw) = &flaw {
        reader.problems.add(0, format!("the study asks for too much of its draws: {flaw}"));
    }
    flaw.is_none().then(|| Arc::new(model))
}
