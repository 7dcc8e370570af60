//! What is around a design: along each axis of the study, the values of objectives and constraints, all else as it is.

use crate::certify::{self, Column, Role, Row};
use crate::error::{Error, Result};
use crate::parallel::one_after_another;
use crate::plan::Plan;
use crate::screen::Control;
use crate::study::{Axis, Label, Levels, Report, Study, TOGETHER};
use crate::table::written;
use std::collections::HashSet;

/// Places along an axis.
pub const PLACES: u64 = 33;
/// The same over a load where something is drawn: each place prepares the formula of its draws anew.
const DRAWN_PLACES: u64 = 9;
/// Times that the end of what is feasible is looked for between two places: of 33 places over 1e6 levels that finds the very level.
const HALVINGS: usize = 16;
/// The same where an axis has no levels.
const HALVINGS_BETWEEN: usize = 6;
/// Axes with more levels are taken for ranges.
const MOST_LEVELS: u64 = 1 << 20;
/// Inputs that the name of a row without labels says.
const NAMED: usize = 3;

/// Designs that differ along one axis.
#[derive(Debug)]
pub struct Slice {
    /// The axis.
    pub name: String,
    /// Unit of its values, as text.
    pub unit: String,
    /// Its value in the design; of words and rows their number.
    pub own: f64,
    /// Its values, from the least.
    pub values: Vec<f64>,
    /// What the values are called, where they have no order: words, and rows of a catalogue.
    pub words: Option<Vec<String>>,
    /// The design at each of them, by the f64 reference.
    pub rows: Vec<Row>,
}

/// The axes along which a slice can be laid: those with several levels.
pub fn sliced(plan: &Plan) -> impl Iterator<Item = &Axis> {
    plan.study.design.iter().filter(|axis| axis.count() > 1)
}

/// Most designs of one slice that has about so many places.
pub fn most_designs(places: u64) -> u64 {
    places + 3 + 2 * HALVINGS as u64
}

/// The slices around a design, each of about `most` places, and the columns of their rows: objectives and constraints. What is only reported
/// may cost more than all else, as fresh draws do.
///
/// # Errors
/// [`Error::Stopped`](crate::error::Error::Stopped) after `control.stop`.
pub fn around(plan: &Plan, design: u64, most: u64, threads: usize, control: &Control) -> Result<(Vec<Column>, Vec<Slice>)> {
    around_with(plan, design, most, &[], threads, control)
}

/// What a study gives every design, varied: how far can it go?
#[derive(Clone, Debug)]
pub enum GivenRange {
    /// An input that the study fixes, over the levels of this axis.
    Fixed(Axis),
    /// The largest value of an input over the operating cases.
    Load {
        /// Number of the axis of the operating cases.
        axis: usize,
        /// The input.
        input: usize,
        /// Least value that is looked at: that of the cases if they have several.
        from: f64,
        /// Largest value that is looked at.
        to: f64,
    },
}

/// The same, and slices over what the study gives.
///
/// # Errors
/// As [`around`].
pub fn around_with(
    plan: &Plan,
    design: u64,
    most: u64,
    given: &[GivenRange],
    threads: usize,
    control: &Control,
) -> Result<(Vec<Column>, Vec<Slice>)> {
    let study = &plan.study;
    let columns: Vec<Column> = certify::columns(study).into_iter().filter(|it| it.role != Role::Report).collect();
    let line = DesignLine { study, inputs: plan.space.inputs(design, 0), columns: &columns, threads, control };
    let own = sliced(plan).map(|axis| line.slice(axis, most));
    let given = given.iter().map(|it| match it {
        GivenRange::Fixed(axis) => line.slice(axis, most),
        GivenRange::Load { axis, input, from, to } => line.load(*axis, *input, (*from, *to), most),
    });
    let slices = own.chain(given).collect::<Result<Vec<_>>>()?;
    Ok((columns, slices))
}

/// How designs along a line through one are judged.
struct DesignLine<'a> {
    study: &'a Study,
    inputs: Vec<f64>,
    columns: &'a [Column],
    threads: usize,
    control: &'a Control,
}

impl DesignLine<'_> {
    fn slice(&self, axis: &Axis, most: u64) -> Result<Slice> {
        let model = &self.study.model;
        match axis {
            Axis::Single { input, levels } => {
                let table = &model.inputs[*input];
                let (name, unit) = (table.name.clone(), table.unit.symbol.to_owned());
                let has_words =
                    table.is_enumeration() || (0..levels.count().min(1000)).any(|at| table.word_for(levels.value(at)).is_some());
                if !has_words {
                    return self.along_levels(axis, levels, most).map(|(values, rows)| {
                        let own = self.inputs[*input];
                        Slice { name, unit, own, values, words: None, rows }
                    });
                }
                let values: Vec<f64> = (0..levels.count()).map(|level| levels.value(level)).collect();
                let rows: Vec<Vec<f64>> = values.iter().map(|&value| vec![value]).collect();
                self.along_rows(axis, &rows, most).map(|slice| Slice { name, ..slice })
            }
            Axis::Joint { inputs, rows } => {
                let (name, names) = self.row_names(axis, inputs, rows);
                self.along_rows(axis, rows, most).map(|slice| {
                    let words = names.map(|names| slice.values.iter().map(|&row| names[row as usize].clone()).collect());
                    Slice { name, words: words.or(slice.words), ..slice }
                })
            }
        }
    }

    /// What an axis of rows is called, and its rows where they have labels: the texts of these, and as many inputs as tell apart those that
    /// have the same texts.
    fn row_names(&self, axis: &Axis, inputs: &[usize], rows: &[Vec<f64>]) -> (String, Option<Vec<String>>) {
        let study = self.study;
        let labels: Vec<&Label> = study.labels_of(axis).collect();
        if labels.is_empty() {
            return (axis.name(&study.model), None);
        }
        let mut heads: Vec<&str> = labels.iter().map(|it| it.name.as_str()).collect();
        let text = |row: usize| labels.iter().map(|it| it.texts[row].as_str()).collect::<Vec<_>>().join(", ");
        let mut names: Vec<String> = (0..rows.len()).map(text).collect();
        let distinct = |names: &[String]| names.iter().collect::<HashSet<_>>().len();
        for (column, &input) in inputs.iter().enumerate() {
            let told = distinct(&names);
            if told == names.len() {
                break;
            }
            let described = &study.model.inputs[input];
            let longer: Vec<String> =
                names.iter().zip(rows).map(|(name, row)| format!("{name}, {}", written(described, row[column]))).collect();
            if distinct(&longer) > told {
                names = longer;
                heads.push(&described.name);
            }
        }
        (heads.join(TOGETHER), Some(names))
    }

    /// Along rows without an order.
    fn along_rows(&self, axis: &Axis, rows: &[Vec<f64>], most: u64) -> Result<Slice> {
        let inputs = axis.inputs();
        let is_own = |row: &&Vec<f64>| inputs.iter().zip(*row).all(|(&input, value)| value.to_bits() == self.inputs[input].to_bits());
        let own = rows.iter().position(|row| is_own(&row)).unwrap_or(0);
        let chosen = spread(rows.len(), most, own);
        let values: Vec<Vec<f64>> = chosen.iter().map(|&row| rows[row].clone()).collect();
        let word = |row: &Vec<f64>| {
            let each = inputs.iter().zip(row).take(NAMED).map(|(&input, &value)| written(&self.study.model.inputs[input], value));
            each.collect::<Vec<_>>().join(", ")
        };
        let words = Some(values.iter().map(word).collect());
        let found = self.judged(axis, &values)?;
        let place = |&row: &usize| row as f64;
        Ok(Slice {
            name: String::new(),
            unit: String::new(),
            own: place(&own),
            values: chosen.iter().map(place).collect(),
            words,
            rows: found,
        })
    }

    /// Along numbers: some of them, and from the design on to either side the last feasible one and the one after it.
    fn along_levels(&self, axis: &Axis, levels: &Levels, most: u64) -> Result<(Vec<f64>, Vec<Row>)> {
        let own = self.inputs[axis.inputs()[0]];
        let rows = |values: &[f64]| values.iter().map(|&it| vec![it]).collect::<Vec<_>>();
        let (values, mut found) = along_places(&AxisPlaces::new(levels, own), own, most, |values| self.judged(axis, &rows(values)))?;
        let line = self.along(axis, &rows(&values));
        certify::keep_scenarios(&Plan::new(line), self.columns, &mut found, self.control);
        Ok((values, found))
    }

    /// Over the largest value of an input in the operating cases. These are others at each place, so that each is a study of its own.
    fn load(&self, number: usize, input: usize, (low, high): (f64, f64), most: u64) -> Result<Slice> {
        let study = self.study;
        let axis = &study.operating()[number];
        let column = axis.inputs().iter().position(|it| *it == input).unwrap_or(0);
        let (least, largest) = axis.ends(column);
        let first = &study.design[0];
        let alone = self.along(first, &[first.inputs().iter().map(|&it| self.inputs[it]).collect()]);
        let drawn = study.drawn_columns().map_err(Error::Request)?;
        let judged = |values: &[f64]| {
            let row = |value: f64| {
                let mut operation = study.operating().to_vec();
                operation[number] = with_largest(axis, column, value);
                let plan = Plan::new(alone.with_operating(operation, &drawn).map_err(Error::Request)?);
                Ok(certify::rows(&plan, self.columns, &[0], 1, self.control)?.remove(0))
            };
            let each = one_after_another(values.to_vec(), self.threads, || (), |(), value| row(value));
            each.into_iter().collect::<Result<Vec<Row>>>()
        };
        let most = if study.probability.is_some() { most.min(DRAWN_PLACES) } else { most };
        let places = AxisPlaces::Between { low, high, log: false, own: largest };
        let (values, mut rows) = along_places(&places, largest, most, judged)?;
        // Scenarios of one number are others at each place: whether another one becomes the worst cannot be told by them.
        rows.iter_mut().flat_map(|row| &mut row.columns).for_each(|at| at.scenario = 0);
        let described = &study.model.inputs[input];
        let which = if least < largest { ", the largest" } else { "" };
        let (name, unit) = (format!("{}{which}", described.name), described.unit.symbol.to_owned());
        Ok(Slice { name, unit, own: largest, values, words: None, rows })
    }
}

/// An axis with another largest value of one of its inputs: what was the largest goes there.
fn with_largest(axis: &Axis, column: usize, value: f64) -> Axis {
    let (_, largest) = axis.ends(column);
    let moved = |it: f64| if it == largest { value } else { it };
    let (input, levels) = match axis {
        Axis::Single { input, levels } => (input, levels),
        Axis::Joint { inputs, rows } => {
            let other = |row: &Vec<f64>| row.iter().enumerate().map(|(at, &it)| if at == column { moved(it) } else { it }).collect();
            return Axis::Joint { inputs: inputs.clone(), rows: rows.iter().map(other).collect() };
        }
    };
    let levels = match levels {
        Levels::List(values) => Levels::List(values.iter().map(|&it| moved(it)).collect()),
        Levels::Even { from, to, count, log } => Levels::Even { from: moved(*from), to: moved(*to), count: *count, log: *log },
        Levels::Step { count, log, .. } => {
            Levels::Even { from: moved(levels.value(0)), to: moved(levels.value(count - 1)), count: *count, log: *log }
        }
        Levels::Continuous { .. } => levels.clone(),
    };
    Axis::Single { input: *input, levels }
}

/// Some places of an axis, the ends of what is feasible to either side of the own one among them, and the design at each.
fn along_places(places: &AxisPlaces, own: f64, most: u64, judged: impl Fn(&[f64]) -> Result<Vec<Row>>) -> Result<(Vec<f64>, Vec<Row>)> {
    let mut values = places.some(most);
    let mut rows = judged(&values)?;
    for _ in 0..places.halvings() {
        let here = values.iter().position(|it| *it == own).unwrap_or(0);
        let further: Vec<f64> =
            edges(&rows, here).into_iter().flatten().filter_map(|(a, b)| places.between(values[a], values[b])).collect();
        if further.is_empty() {
            break;
        }
        let found = judged(&further)?;
        let mut all: Vec<(f64, Row)> = values.into_iter().zip(rows).chain(further.into_iter().zip(found)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        (values, rows) = all.into_iter().unzip();
    }
    Ok((values, rows))
}

impl DesignLine<'_> {
    fn judged(&self, axis: &Axis, rows: &[Vec<f64>]) -> Result<Vec<Row>> {
        let line = Plan::new(self.along(axis, rows));
        let designs: Vec<u64> = (0..line.designs()).collect();
        certify::rows(&line, self.columns, &designs, self.threads, self.control)
    }

    /// The study of the designs that differ along one axis.
    fn along(&self, varied: &Axis, rows: &[Vec<f64>]) -> Study {
        let study = self.study;
        let fixed = |&input: &usize| Axis::Single { input, levels: Levels::List(vec![self.inputs[input]]) };
        let others = study.design.iter().filter(|axis| !std::ptr::eq(*axis, varied)).flat_map(Axis::inputs).map(fixed);
        let axis = match varied {
            Axis::Single { input, .. } => Axis::Single { input: *input, levels: Levels::List(rows.iter().map(|row| row[0]).collect()) },
            Axis::Joint { inputs, .. } => Axis::Joint { inputs: inputs.clone(), rows: rows.to_vec() },
        };
        Study {
            design: others.chain([axis]).collect(),
            labels: Vec::new(),
            sample: None,
            report: Report { columns: study.report.columns.clone(), front_budget: study.report.front_budget, ..Report::default() },
            ..study.clone()
        }
    }
}

/// The last feasible place to either side of a feasible one, with the next one, if there is one.
fn edges(rows: &[Row], here: usize) -> [Option<(usize, usize)>; 2] {
    if !rows[here].feasible {
        return [None, None];
    }
    let down = (0..here).rev().find(|&at| !rows[at].feasible).map(|at| (at, at + 1));
    let up = (here + 1..rows.len()).find(|&at| !rows[at].feasible).map(|at| (at - 1, at));
    [down, up]
}

/// About `most` of `count` rows evenly, the own one among them.
fn spread(count: usize, most: u64, own: usize) -> Vec<usize> {
    let most = (most as usize).min(count);
    let even = |at: usize| if most > 1 { (at * (count - 1) + (most - 1) / 2) / (most - 1) } else { 0 };
    let mut chosen: Vec<usize> = (0..most).map(even).chain([own]).collect();
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// Where a design may stand on an axis of numbers.
enum AxisPlaces {
    /// On one of these, from the least.
    Levels { levels: Vec<f64>, own: usize },
    /// Anywhere.
    Between { low: f64, high: f64, log: bool, own: f64 },
}

impl AxisPlaces {
    fn new(levels: &Levels, own: f64) -> Self {
        if levels.count() > MOST_LEVELS || matches!(levels, Levels::Continuous { .. }) {
            let (low, high) = levels.ends();
            let log =
                matches!(levels, Levels::Even { log: true, .. } | Levels::Step { log: true, .. } | Levels::Continuous { log: true, .. });
            return Self::Between { low: low.min(high), high: low.max(high), log, own };
        }
        let mut all: Vec<f64> = (0..levels.count()).map(|level| levels.value(level)).chain([own]).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        let place = all.iter().position(|it| *it == own).unwrap_or(0);
        Self::Levels { levels: all, own: place }
    }

    /// About so many of them: the ends, the own one, and its neighbours.
    #[allow(clippy::cast_precision_loss, reason = "a few places of a picture")]
    fn some(&self, most: u64) -> Vec<f64> {
        match self {
            Self::Levels { levels, own } => {
                let mut chosen = spread(levels.len(), most, *own);
                chosen.extend([own.saturating_sub(1), (own + 1).min(levels.len() - 1)]);
                chosen.sort_unstable();
                chosen.dedup();
                chosen.into_iter().map(|at| levels[at]).collect()
            }
            Self::Between { low, high, log, own } => {
                let place = |at: u64| {
                    let t = at as f64 / (most - 1) as f64;
                    match at {
                        0 => *low,
                        at if at == most - 1 => *high,
                        _ if *log => low * (high / low).powf(t),
                        _ => low + t * (high - low),
                    }
                };
                let mut values: Vec<f64> = (0..most).map(place).chain([*own]).collect();
                values.sort_by(f64::total_cmp);
                values.dedup();
                values
            }
        }
    }

    fn halvings(&self) -> usize {
        if matches!(self, Self::Levels { .. }) { HALVINGS } else { HALVINGS_BETWEEN }
    }

    /// One in the middle between two, if there is one.
    fn between(&self, a: f64, b: f64) -> Option<f64> {
        match self {
            Self::Levels { levels, .. } => {
                let at = |value: f64| levels.partition_point(|it| *it < value);
                let (a, b) = (at(a), at(b));
                (b > a + 1).then(|| levels[(a + b) / 2])
            }
            Self::Between { log, .. } => Some(if *log { (a * b).sqrt() } else { 0.5 * (a + b) }).filter(|it| a < *it && *it < b),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::study_of;

    /// A push belt whose thickness has many more levels than a slice has places.
    fn plan(levels: &str) -> Plan {
        let text = format!(
            "[design]\nband_thickness_mm = {levels}\nband_count = [6, 9]\n[fixed]\ntorque_Nm = 100\nstrength_MPa = 900\ntraction = 0.3\n[operation]\nratio = {{ from = 0.5, to = 2, count = 9 }}\n\
             [constraints]\nstress_margin = {{ min = 0 }}\n[objectives]\naxial_force_N = \"min\"\n"
        );
        Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right"))
    }

    #[test]
    fn the_end_of_what_is_feasible_is_the_very_level() {
        let plan = plan("{ from = 0.1, to = 0.4, count = 3001 }");
        let control = Control::default();
        let columns = certify::columns(&plan.study);
        let all: Vec<u64> = (0..plan.designs()).collect();
        let feasible: Vec<bool> = certify::rows(&plan, &columns, &all, 2, &control).expect("rows").iter().map(|it| it.feasible).collect();
        let design = (0..plan.designs()).find(|&it| feasible[it as usize]).expect("some are feasible");
        let count = plan.space.inputs(design, 0);
        let own = |at: u64| plan.space.inputs(at, 0)[plan.study.design[1].inputs()[0]] == count[plan.study.design[1].inputs()[0]];
        let thickness = |at: u64| plan.space.inputs(at, 0)[plan.study.design[0].inputs()[0]];
        let mut line: Vec<(f64, bool)> = all.iter().filter(|&&at| own(at)).map(|&at| (thickness(at), feasible[at as usize])).collect();
        line.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (_, slices) = around(&plan, design, PLACES, 2, &control).expect("slices");
        let slice = &slices[0];
        assert!(slice.values.len() < 80 && slice.values.len() as u64 <= most_designs(PLACES));
        let here = slice.values.iter().position(|it| *it == slice.own).expect("its own place");
        let [_, up] = edges(&slice.rows, here);
        let (last, next) = up.expect("it ends somewhere");
        let at = line.iter().position(|(value, _)| *value == slice.values[next]).expect("it is a level");
        assert!(line[at - 1].0 == slice.values[last] && line[at - 1].1 && !line[at].1, "{:?}", &line[at - 1..=at]);
        // The slice over the bands has their two levels, and no other.
        assert_eq!(slices[1].values, [6.0, 9.0]);
    }

    #[test]
    fn the_largest_load_that_a_design_bears_is_found() {
        let text = "[design]\nband_thickness_mm = [0.15, 0.2]\n[operation]\ntorque_Nm = [50, 100]\nratio = { from = 0.5, to = 2, count = 5 }\n[fixed]\nstrength_MPa = 900\ntraction = 0.3\n\
                    [constraints]\nstress_margin = { min = 0 }\n[objectives]\naxial_force_N = \"min\"\n";
        let study = |torque: f64| {
            let text = text.replace("[50, 100]", &format!("[50, {torque:?}]"));
            study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right")
        };
        let plan = Plan::new(study(100.0));
        let control = Control::default();
        let load = |axis: usize, from: f64, to: f64| GivenRange::Load { axis, input: plan.study.operation[axis].inputs()[0], from, to };
        let given = [load(0, 50.0, 400.0), load(1, 0.5, 2.5)];
        let (columns, slices) = around_with(&plan, 1, PLACES, &given, 2, &control).expect("slices");
        let slice = &slices[1];
        assert_eq!((slice.name.as_str(), slice.own, slices.len()), ("torque_Nm, the largest", 100.0, 3));
        // Each place is the study that has this load, its own place that of the study.
        assert_eq!(slice.values[0], 50.0);
        // A study may not list a load twice.
        for (value, row) in slice.values.iter().zip(&slice.rows).skip(1) {
            let alone = &certify::rows(&Plan::new(study(*value)), &columns, &[1], 1, &control).expect("a row")[0];
            let bits = |row: &Row| row.columns.iter().map(|at| at.value.map(f64::to_bits)).collect::<Vec<_>>();
            assert_eq!((bits(row), row.feasible), (bits(alone), alone.feasible), "{value} N m");
        }
        let here = slice.values.iter().position(|it| *it == slice.own).expect("its own place");
        let [down, up] = edges(&slice.rows, here);
        assert!(down.is_none() && up.is_some_and(|(last, next)| slice.values[next] - slice.values[last] < 0.2), "{:?}", slice.values);
        // The end of a range stretches it.
        assert_eq!(slices[2].values[0], 0.5);
        assert_eq!(slices[2].values.last(), Some(&2.5));
    }

    #[test]
    fn where_something_is_drawn_a_load_is_that_of_every_draw() {
        let text = "[design]\nband_thickness_mm = [0.15, 0.2]\n[operation]\ncases = [{ torque_Nm = 50, ratio = 0.5 }, { torque_Nm = 100, ratio = 2 }, { torque_Nm = 100, ratio = 1 }]\n\
                    [uncertainty]\nfriction = { normal = { mean = 0.09, sd = 0.005 } }\n[probability]\ndraws = 256\n[fixed]\nstrength_MPa = 900\ntraction = 0.3\n\
                    [constraints]\nstress_margin = { min = 0 }\nyield = { min = 0.5 }\n[objectives]\nyield = \"max\"\n";
        let study = |torque: f64| {
            let text = text.replace("torque_Nm = 100", &format!("torque_Nm = {torque:?}"));
            study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text).expect("the study is right")
        };
        let plan = Plan::new(study(100.0));
        let control = Control::default();
        let input = plan.study.model.input("torque_Nm").expect("it is an input");
        let given = [GivenRange::Load { axis: 0, input, from: 50.0, to: 400.0 }];
        let (columns, slices) = around_with(&plan, 1, 9, &given, 2, &control).expect("slices");
        let slice = &slices[1];
        assert_eq!((slice.name.as_str(), slice.own), ("torque_Nm, the largest", 100.0));
        let mut yields = std::collections::BTreeSet::new();
        for (value, row) in slice.values.iter().zip(&slice.rows) {
            let alone = &certify::rows(&Plan::new(study(*value)), &columns, &[1], 1, &control).expect("a row")[0];
            let bits = |row: &Row| row.columns.iter().map(|at| at.value.map(f64::to_bits)).collect::<Vec<_>>();
            assert_eq!((bits(row), row.feasible), (bits(alone), alone.feasible), "{value} N m");
            yields.insert(bits(row));
        }
        assert!(yields.len() > 1, "more torque must cost yield");
    }

    #[test]
    fn places_are_levels_and_those_beside_the_design_are_there() {
        let levels = Levels::Step { from: 0.0, step: 1.0, count: 1000, log: false };
        let values = AxisPlaces::new(&levels, 401.0).some(33);
        assert!([400.0, 401.0, 402.0, 0.0, 999.0].iter().all(|it| values.contains(it)) && values.iter().all(|it| it.fract() == 0.0));
        assert_eq!(spread(5, 33, 2), [0, 1, 2, 3, 4]);
        assert_eq!(spread(100, 3, 7), [0, 7, 50, 99]);
        // A zero is one place, whichever sign it has.
        let around_zero = AxisPlaces::new(&Levels::List(vec![-1.0, 0.0, 1.0]), -0.0);
        assert!(matches!(around_zero, AxisPlaces::Levels { ref levels, own: 1 } if levels.len() == 3));
        let anywhere = AxisPlaces::new(&Levels::Continuous { from: 1.0, to: 100.0, log: true }, 10.0);
        assert_eq!(anywhere.between(1.0, 100.0), Some(10.0));
    }

    #[test]
    fn words_and_rows_of_a_catalogue_have_slices_too() {
        let text = "[design]\ncases = [{ band_count = 6, band_thickness_mm = 0.2 }, { band_count = 9, band_thickness_mm = 0.15 }]\n\
                    traction = [\"limit\", 0.3]\n[objectives]\naxial_force_N = \"min\"\n";
        let plan = Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), text).expect("the study is right"));
        let (_, slices) = around(&plan, 0, PLACES, 1, &Control::default()).expect("slices");
        let words: Vec<_> = slices.iter().map(|it| (it.name.as_str(), it.words.clone().expect("words"), it.rows.len())).collect();
        assert_eq!(words[0], ("band_count + band_thickness_mm", vec!["6, 0.2".to_owned(), "9, 0.15".to_owned()], 2));
        assert_eq!(words[1], ("traction", vec!["limit".to_owned(), "0.3".to_owned()], 2));
    }

    #[test]
    fn rows_with_labels_are_called_by_them_and_by_what_tells_them_apart() {
        let text = |maker: &str| {
            format!(
                "labels = [\"grade\", \"maker\"]\n[design]\ncases = [{{ grade = \"thin\", maker = \"one\", band_thickness_mm = 0.2, band_count = 6 }}, \
                 {{ grade = \"thin\", maker = \"{maker}\", band_thickness_mm = 0.2, band_count = 9 }}]\n[objectives]\naxial_force_N = \"min\"\n"
            )
        };
        let told = |maker: &str| {
            let study = study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text(maker)).expect("the study is right");
            let (_, slices) = around(&Plan::new(study), 0, PLACES, 1, &Control::default()).expect("slices");
            (slices[0].name.clone(), slices[0].words.clone().expect("words"))
        };
        assert_eq!(told("two"), ("grade + maker".to_owned(), vec!["thin, one".to_owned(), "thin, two".to_owned()]));
        // The thickness is the same and tells nothing.
        assert_eq!(told("one"), ("grade + maker + band_count".to_owned(), vec!["thin, one, 6".to_owned(), "thin, one, 9".to_owned()]));
    }

    #[test]
    fn a_scenario_that_is_the_worst_by_rounding_only_is_no_other_one() {
        // Bending does not depend on the torque, and the radii depend on the ratio.
        let text = "[design]\nband_thickness_mm = [0.1, 0.15, 0.2]\n[operation]\ntorque_Nm = [50, 100]\nratio = [0.5, 2]\n\
                    [objectives]\nbending_stress_MPa = \"min\"\n";
        let plan = Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), text).expect("the study is right"));
        let columns = certify::columns(&plan.study);
        let control = Control::default();
        let mut rows = certify::rows(&plan, &columns, &[0, 1, 2], 1, &control).expect("rows");
        let worst = rows[0].columns[0].scenario;
        let [of_other_torque, of_other_ratio] = [worst ^ 2, worst ^ 1];
        rows[1].columns[0].scenario = of_other_torque;
        rows[2].columns[0].scenario = of_other_ratio;
        // Another ratio has another stress, so this row stays as it is told.
        rows[2].columns[0].value = rows[2].columns[0].value.map(|it| 1.1 * it);
        certify::keep_scenarios(&plan, &columns, &mut rows, &control);
        let scenarios: Vec<u64> = rows.iter().map(|row| row.columns[0].scenario).collect();
        assert_eq!(scenarios, [worst, worst, of_other_ratio]);
    }
}
