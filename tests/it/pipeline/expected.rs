//! What a result directory must contain, by brute force.

use super::answer::{Answer, Cell, Table, whole};
use super::naive::{Evaluated, Failures, front, key, needed, worst_end, worst_end_over};
use beltspace::models::Worse;
use beltspace::study::{Axis, Best, Goal, Objective, OverScenarios, Quantity, Study};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// A column of the design tables.
struct Column {
    name: String,
    quantity: Quantity,
    over: OverScenarios,
    /// The end that it shows, unless it depends.
    end: Option<Worse>,
    /// How bad a value is: more is worse.
    badness: Box<dyn Fn(f64) -> f64>,
}

/// Objectives, constraints and report columns in file order, each quantity once unless its worst scenario differs. What a design axis
/// sets has its column among the design inputs.
fn columns(study: &Study) -> Vec<Column> {
    let end = |worse: Worse| -> Box<dyn Fn(f64) -> f64> {
        if worse == Worse::Higher { Box::new(|value| value) } else { Box::new(|value: f64| -value) }
    };
    let mut columns: Vec<Column> = Vec::new();
    let name_of = |quantity: Quantity, over: OverScenarios| match over {
        OverScenarios::Worst => quantity.name(&study.model).to_owned(),
        OverScenarios::Mean => format!("{}_mean", quantity.name(&study.model)),
        OverScenarios::Sum => format!("{}_sum", quantity.name(&study.model)),
    };
    for objective in &study.objectives {
        let (quantity, over) = (objective.quantity, objective.over);
        let worse = if objective.goal == Goal::Min { Worse::Higher } else { Worse::Lower };
        columns.push(Column { name: name_of(quantity, over), quantity, over, end: Some(worse), badness: end(worse) });
    }
    for &constraint in &study.constraints {
        let (quantity, over) = (constraint.quantity, constraint.over);
        let name = name_of(quantity, over);
        let objective = study.objectives.iter().find(|it| it.quantity == quantity && it.over == over);
        // A bound on the end that is the objective's worst has its worst scenario too.
        let served = matches!(
            (objective.map(|it| it.goal), constraint.low, constraint.high),
            (Some(Goal::Min), None, Some(_)) | (Some(Goal::Max), Some(_), None)
        );
        let margin = move |value: f64| {
            let low = constraint.low.map_or(f64::INFINITY, |(bound, _)| value - bound);
            let high = constraint.high.map_or(f64::INFINITY, |(bound, _)| bound - value);
            -(if low < high { low } else { high })
        };
        let suffix = if objective.is_some() { "_constrained" } else { "" };
        if !served {
            let only = match (constraint.low, constraint.high) {
                (Some(_), None) => Some(Worse::Lower),
                (None, Some(_)) => Some(Worse::Higher),
                _ => None,
            };
            columns.push(Column { name: format!("{name}{suffix}"), quantity, over, end: only, badness: Box::new(margin) });
        }
    }
    for asked in &study.report.columns {
        let (quantity, over) = (asked.of, asked.over);
        let same = |column: &&Column| column.quantity == quantity && column.over == over;
        let worse = asked.worst.unwrap_or_else(|| worst_end_over(study, quantity, over));
        let name = name_of(quantity, over);
        let suffix = if worse == Worse::Higher { "highest" } else { "lowest" };
        let name = match asked.worst {
            _ if !columns.iter().any(|column| same(&column)) => name,
            Some(_) if columns.iter().filter(same).all(|column| column.end != Some(worse)) => format!("{name}_{suffix}"),
            _ => continue,
        };
        columns.push(Column { name, quantity, over, end: Some(worse), badness: end(worse) });
    }
    let set: Vec<usize> = study.design.iter().flat_map(Axis::inputs).copied().collect();
    columns.retain(|column| set.iter().all(|&input| column.quantity != Quantity::Input(input)));
    columns
}

/// The value that an input has in a table.
fn input_cell(study: &Study, input: usize, value: f64) -> Cell {
    study.model.inputs[input].word_for(value).map_or(Cell::number(value), |word| Cell::Text(word.to_owned()))
}

/// A table of designs.
fn designs_table(study: &Study, evaluated: &Evaluated, designs: &[u64]) -> Table {
    let columns = columns(study);
    let inputs: Vec<usize> = study.design.iter().flat_map(Axis::inputs).copied().collect();
    let input_names = inputs.iter().map(|&input| study.model.inputs[input].name.to_owned());
    let column_names = columns.iter().flat_map(|column| [column.name.clone(), format!("{}_scenario", column.name)]);
    let header = std::iter::once("design_index".to_owned()).chain(input_names).chain(column_names).collect();
    let row = |&design: &u64| {
        let cases = evaluated.cases(design);
        let mut row = vec![whole(design)];
        row.extend(inputs.iter().map(|&input| input_cell(study, input, cases[0].inputs[input])));
        for column in &columns {
            let mut worst: Option<(f64, f64, usize)> = None;
            for group in evaluated.groups(column.over) {
                if let Some(value) = evaluated.value_over(design, &group, column.quantity, column.over)
                    && worst.is_none_or(|(badness, _, _)| (column.badness)(value) > badness)
                {
                    worst = Some(((column.badness)(value), value, group[0]));
                }
            }
            row.push(worst.map_or(Cell::Absent, |(_, value, _)| Cell::number(value)));
            row.push(worst.map_or(Cell::Absent, |(_, _, scenario)| whole(scenario as u64)));
        }
        row
    };
    Table { header, rows: designs.iter().map(row).collect() }
}

/// The answer to a study, and what happened on the way.
pub struct Expected {
    pub answer: Answer,
    pub feasible: Vec<u64>,
    pub front: Vec<u64>,
    pub failures: Vec<Failures>,
    /// Feasible designs that are off the front only because a lower index has the same objective values.
    pub ties: usize,
}

impl Expected {
    pub fn new(study: &Study, evaluated: &Evaluated) -> Self {
        let failures: Vec<Failures> = (0..evaluated.designs).map(|design| Failures::of(study, evaluated, design)).collect();
        let feasible: Vec<u64> = (0..evaluated.designs).filter(|&design| failures[design as usize].none()).collect();
        let keys: Vec<Vec<f64>> = feasible.iter().map(|&design| key(study, evaluated, design)).collect();
        let front_positions = if study.objectives.is_empty() { Vec::new() } else { front(&keys) };
        let bits = |position: usize| keys[position].iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        let on_front: HashSet<Vec<u64>> = front_positions.iter().map(|&position| bits(position)).collect();
        let ties = (0..keys.len()).filter(|&position| on_front.contains(&bits(position))).count() - front_positions.len();
        let mut front: Vec<u64> = front_positions.iter().map(|&position| feasible[position]).collect();
        let value = |design: u64, objective: &Objective| worst_of(evaluated, design, objective);
        let signed = |design: u64, objective: &Objective| value(design, objective) * if objective.goal == Goal::Min { 1.0 } else { -1.0 };
        front.sort_by(|&a, &b| {
            let differences = study.objectives.iter().map(|it| signed(a, it).partial_cmp(&signed(b, it)).expect("numbers"));
            differences.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then).then(a.cmp(&b))
        });
        let mut expected = Self { answer: Answer::default(), feasible, front, failures, ties };
        expected.fill_tables(study, evaluated);
        expected.fill_summary(study, evaluated);
        expected
    }

    fn fill_tables(&mut self, study: &Study, evaluated: &Evaluated) {
        let model = &study.model;
        let tables = &mut self.answer.tables;
        let scenario_inputs: Vec<usize> = study.operation.iter().chain(&study.uncertainty).flat_map(Axis::inputs).copied().collect();
        let names = scenario_inputs.iter().map(|&input| model.inputs[input].name.to_owned());
        let scenarios = evaluated.cases(0).iter().enumerate().map(|(number, case)| {
            let inputs = scenario_inputs.iter().map(|&input| input_cell(study, input, case.inputs[input]));
            let weight = evaluated.weight(number).map(Cell::number);
            std::iter::once(whole(number as u64)).chain(inputs).chain(weight).collect()
        });
        let weight = study.spectrum.as_ref().map(|spectrum| spectrum.weight.clone());
        let header = std::iter::once("scenario".to_owned()).chain(names).chain(weight).collect();
        tables.insert("scenarios.csv".to_owned(), Table { header, rows: scenarios.collect() });
        if !study.objectives.is_empty() {
            tables.insert("front.csv".to_owned(), designs_table(study, evaluated, &self.front));
        }
        if let Some(top) = study.report.top {
            let worse = if top.goal == Goal::Min { Worse::Higher } else { Worse::Lower };
            let sign = if top.goal == Goal::Min { 1.0 } else { -1.0 };
            let mut best = self.feasible.clone();
            // A stable sort: the lowest index of equals comes first.
            best.sort_by(|&a, &b| {
                (sign * evaluated.worst(a, top.by, worse)).partial_cmp(&(sign * evaluated.worst(b, top.by, worse))).expect("numbers")
            });
            best.truncate(top.count);
            tables.insert("top.csv".to_owned(), designs_table(study, evaluated, &best));
        }
        if let Some(sample) = study.report.sample {
            let mut drawn = self.feasible.clone();
            drawn.sort_by_key(|&design| place(design, sample.seed));
            drawn.truncate(sample.count);
            drawn.sort_unstable();
            tables.insert("sample.csv".to_owned(), designs_table(study, evaluated, &drawn));
        }
        if study.report.feasible {
            tables.insert("feasible.parquet".to_owned(), designs_table(study, evaluated, &self.feasible));
        }
        if study.report.variants {
            let all: Vec<u64> = (0..evaluated.designs).collect();
            let mut table = designs_table(study, evaluated, &all);
            table.header.push("feasible".to_owned());
            for (row, failures) in table.rows.iter_mut().zip(&self.failures) {
                row.push(Cell::Text(if failures.none() { "yes" } else { "no" }.to_owned()));
            }
            tables.insert("variants.csv".to_owned(), table);
        }
        let unique = |tables: &BTreeMap<String, Table>, stem: String| {
            let mut name = format!("{stem}.csv");
            let mut number = 1;
            while tables.contains_key(&name) {
                number += 1;
                name = format!("{stem}-{number}.csv");
            }
            name
        };
        for spec in &study.report.histograms {
            let worst = |&design: &u64| evaluated.worst(design, spec.of, worst_end(study, spec.of));
            let values: Vec<f64> = self.feasible.iter().map(worst).collect();
            let name = unique(tables, format!("histogram-{}", spec.of.name(model)));
            tables.insert(name, histogram(&values, spec.range, spec.bins));
        }
        for spec in &study.report.maps {
            let (x, y) = (&study.design[spec.x], &study.design[spec.y]);
            let value = match spec.value {
                Best::Value(quantity, _) => quantity.name(model),
                Best::Share => "feasible_share",
            };
            let [x_name, y_name] = [x, y].map(|axis| model.inputs[axis.inputs()[0]].name.as_str());
            // A map of what one of its axes is.
            let column = if [x_name, y_name].contains(&value) { format!("{value}_value") } else { value.to_owned() };
            let mut header = vec![x_name, y_name, &column];
            header.extend((spec.value != Best::Share).then_some("design_index"));
            let place = |&design: &u64| {
                let inputs = &evaluated.cases(design)[0].inputs;
                (inputs[x.inputs()[0]].to_bits(), inputs[y.inputs()[0]].to_bits())
            };
            let (mut all, mut met): (HashMap<_, u64>, HashMap<_, Vec<u64>>) = Default::default();
            (0..evaluated.designs).for_each(|design| *all.entry(place(&design)).or_default() += 1);
            self.feasible.iter().for_each(|design| met.entry(place(design)).or_default().push(*design));
            let mut rows = Vec::new();
            for (v, u) in (0..y.count()).flat_map(|v| (0..x.count()).map(move |u| (v, u))) {
                let (x_value, y_value) = (x.value(0, u), y.value(0, v));
                let place = (x_value.to_bits(), y_value.to_bits());
                let mut row = vec![input_cell(study, x.inputs()[0], x_value), input_cell(study, y.inputs()[0], y_value)];
                let feasible = met.get(&place).map_or(&[][..], Vec::as_slice);
                match spec.value {
                    Best::Share => row.push(Cell::number(feasible.len() as f64 / all[&place] as f64)),
                    Best::Value(quantity, goal) => {
                        let (worse, sign) = if goal == Goal::Min { (Worse::Higher, 1.0) } else { (Worse::Lower, -1.0) };
                        let mut best: Option<(f64, u64)> = None;
                        for &design in feasible {
                            let value = sign * evaluated.worst(design, quantity, worse);
                            if best.is_none_or(|(held, _)| value < held) {
                                best = Some((value, design));
                            }
                        }
                        row.push(best.map_or(Cell::Absent, |(value, _)| Cell::number(sign * value)));
                        row.push(best.map_or(Cell::Absent, |(_, design)| whole(design)));
                    }
                }
                rows.push(row);
            }
            let name = unique(tables, format!("map-{value}"));
            tables.insert(name, Table { header: header.into_iter().map(str::to_owned).collect(), rows });
        }
    }

    fn fill_summary(&mut self, study: &Study, evaluated: &Evaluated) {
        let value = |design: u64, objective: &Objective| worst_of(evaluated, design, objective);
        let mut summary = BTreeMap::new();
        let mut put = |name: &str, cell: Cell| summary.insert(name.to_owned(), cell);
        put("designs", whole(evaluated.designs));
        put("scenarios", whole(evaluated.scenarios));
        put("feasible", whole(self.feasible.len() as u64));
        put("front", whole(self.front.len() as u64));
        put("model", Cell::Text(study.model.name.to_owned()));
        put("title", Cell::Text(study.title.clone()));
        put("tally.sampled", whole(evaluated.designs));
        put("tally.feasible", whole(self.feasible.len() as u64));
        let conditions = &study.model.conditions;
        for condition in conditions.iter().filter(|condition| !condition.quiet) {
            // Both ends of an input's range say the same.
            let says_so = |&number: &usize| conditions[number].reason == condition.reason;
            let failed = self.failures.iter().filter(|it| it.statuses.iter().any(says_so)).count();
            put(&format!("tally.status.{}", condition.reason), whole(failed as u64));
        }
        for (reason, count) in lacking(study, evaluated) {
            put(&format!("tally.status.{reason}"), whole(count));
        }
        for number in 0..study.constraints.len() {
            let violated = self.failures.iter().filter(|it| it.constraints.contains(&number)).count();
            let alone = |it: &&Failures| it.statuses.is_empty() && !it.meaningless && it.constraints == [number];
            put(&format!("tally.constraints.{number}.violated"), whole(violated as u64));
            put(&format!("tally.constraints.{number}.only"), whole(self.failures.iter().filter(alone).count() as u64));
        }
        if self.front.is_empty() {
            put("ideal", Cell::Absent);
            put("knee", Cell::Absent);
        }
        let mut scaled = vec![0.0; self.front.len()];
        for objective in &study.objectives {
            let suffix = match objective.over {
                OverScenarios::Worst => "",
                OverScenarios::Mean => "_mean",
                OverScenarios::Sum => "_sum",
            };
            let name = format!("{}{suffix}", objective.quantity.name(&study.model));
            for (end, sign) in [("least", 1.0), ("largest", -1.0)] {
                let further =
                    |a: &&u64, b: &&u64| (sign * value(**a, objective)).partial_cmp(&(sign * value(**b, objective))).expect("numbers");
                // Of equal designs `min_by` gives the first.
                if let Some(&design) = self.feasible.iter().min_by(further) {
                    put(&format!("extremes.{name}.{end}.value"), Cell::number(value(design, objective)));
                    put(&format!("extremes.{name}.{end}.design_index"), whole(design));
                }
            }
            let values: Vec<f64> = self.front.iter().map(|&design| value(design, objective)).collect();
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let ideal = if objective.goal == Goal::Min { low } else { high };
            if !values.is_empty() {
                put(&format!("ideal.{name}"), Cell::number(ideal));
            }
            for (sum, value) in scaled.iter_mut().zip(values) {
                let distance: f64 = if high > low { (value - ideal) / (high - low) } else { 0.0 };
                *sum += distance * distance;
            }
        }
        let distances: Vec<(f64, u64)> = scaled.into_iter().map(f64::sqrt).zip(self.front.iter().copied()).collect();
        if let Some(&(distance, design)) = distances.iter().min_by(|a, b| a.partial_cmp(b).expect("numbers")) {
            put("knee.distance", Cell::number(distance));
            put("knee.design_index", whole(design));
        }
        self.answer.summary = summary;
    }
}

/// The worst value of an objective.
fn worst_of(evaluated: &Evaluated, design: u64, objective: &Objective) -> f64 {
    let worse = if objective.goal == Goal::Min { Worse::Higher } else { Worse::Lower };
    evaluated.worst_over(design, objective.quantity, objective.over, worse)
}

/// The place of a design in the shuffled order that a sample of feasible designs is taken from: four rounds over halves of 32 bits.
pub fn place(design: u64, seed: u64) -> u64 {
    let mask = u64::from(u32::MAX);
    let mut key = seed;
    let (mut high, mut low) = (design >> 32, design & mask);
    for _ in 0..4 {
        // The finaliser of SplitMix64, of which a key is the upper half.
        key = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
        key = (key ^ key >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        key = (key ^ key >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        key ^= key >> 31;
        let mut hash = low ^ key >> 32;
        hash = ((hash ^ hash >> 16) * 0x21f0_aaad) & mask;
        hash = ((hash ^ hash >> 15) * 0x735a_2d97) & mask;
        (high, low) = (low, high ^ hash ^ hash >> 15);
    }
    high << 32 | low
}

/// Counts per bin, with what lies below and above; without a range over what there is.
fn histogram(values: &[f64], range: Option<(f64, f64)>, bins: usize) -> Table {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (from, to) = match range {
        Some(range) => range,
        None if values.is_empty() => (0.0, 1.0),
        None if low < high => (low, high),
        None => (low - low.abs().max(1.0) / 2.0, low + low.abs().max(1.0) / 2.0),
    };
    let edge = |bin: usize| if bin == bins { to } else { from + bin as f64 * (to - from) / bins as f64 };
    let count = |inside: &dyn Fn(f64) -> bool| whole(values.iter().filter(|&&value| inside(value)).count() as u64);
    let mut rows = vec![vec![Cell::Absent, Cell::number(from), count(&|value| value < from)]];
    for bin in 0..bins {
        let last = bin + 1 == bins;
        let inside = |value: f64| value >= edge(bin) && if last { value <= to } else { value < edge(bin + 1) };
        rows.push(vec![Cell::number(edge(bin)), Cell::number(edge(bin + 1)), count(&inside)]);
    }
    rows.push(vec![Cell::number(to), Cell::Absent, count(&|value| value > to)]);
    Table { header: ["from", "to", "designs"].map(str::to_owned).to_vec(), rows }
}

/// Of a study with distributions: how many designs lack a statistic that the study needs, by the reason of the first that is missing.
fn lacking(study: &Study, evaluated: &Evaluated) -> BTreeMap<String, u64> {
    let mut found = BTreeMap::new();
    if study.probability.is_none() {
        return found;
    }
    let model = &study.model;
    let needed = needed(study);
    for design in 0..evaluated.designs {
        let reasons = evaluated.cases(design).iter().filter_map(|case| {
            let is_missing = |name: &String| {
                let quantity = Quantity::Output(model.output(name).expect("it is an output"));
                needed.contains(&quantity) && case.value(quantity).is_none()
            };
            model.conditions.iter().find(|it| it.invalidates.iter().any(is_missing)).map(|it| it.reason.clone())
        });
        // Each counts once, whatever the level.
        for reason in reasons.collect::<BTreeSet<_>>() {
            *found.entry(reason).or_default() += 1;
        }
    }
    found
}
