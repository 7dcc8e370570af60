//! What is around a design: along each axis of the study, the values of objectives and constraints, all else as it is.

mod places;

use crate::certify::{self, Column, Role, Row};
use crate::error::{Error, Result};
use crate::parallel::one_after_another;
use crate::plan::Plan;
use crate::probability::Effect;
use crate::screen::Control;
use crate::study::{Axis, Label, Levels, Report, Study, TOGETHER};
use crate::table::written;
use places::{AxisPlaces, HALVINGS, along_places, spread};
use std::collections::HashSet;

/// Places along an axis.
pub const PLACES: u64 = 33;
/// The same over a load where something is drawn: each place prepares the formula of its draws anew.
const DRAWN_PLACES: u64 = 9;
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
    /// An input that the study fixes, or leaves at its default, over the levels of this axis.
    Fixed(Axis),
    /// An end of what an input is in the scenarios.
    End(ScenarioEnd),
    /// The scenarios with one of the words of an axis alone.
    Alone {
        /// Is the input uncertain? Else it is one of the operating cases.
        is_uncertain: bool,
        /// Number of the axis among those of its kind.
        axis: usize,
    },
    /// The mean of a distribution: all draws move with it.
    Mean {
        /// Number of the input among those that are drawn.
        drawn: usize,
        /// Least value that is looked at.
        from: f64,
        /// Largest value that is looked at.
        to: f64,
    },
}

/// An end of the values that an input has in the scenarios of a study, and where else it is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScenarioEnd {
    /// Is the input uncertain? Else it is one of the operating cases.
    pub is_uncertain: bool,
    /// Number of the axis among those of its kind.
    pub axis: usize,
    /// The input.
    pub input: usize,
    /// Is it the largest value? Else it is the least one; a single value is both.
    pub is_largest: bool,
    /// Least value that is looked at.
    pub from: f64,
    /// Largest value that is looked at.
    pub to: f64,
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
    let needs_draws = given.iter().any(|it| !matches!(it, GivenRange::Fixed(_)));
    let drawn = if needs_draws { study.drawn_columns().map_err(Error::Request)? } else { Vec::new() };
    let line = DesignLine { study, inputs: plan.space.inputs(design, 0), columns: &columns, drawn, threads, control };
    let own = sliced(plan).map(|axis| line.slice(axis, most));
    let given = given.iter().map(|it| match it {
        GivenRange::Fixed(axis) => line.slice(axis, most),
        GivenRange::End(end) => line.scenario_end(*end, most),
        GivenRange::Alone { is_uncertain, axis } => line.alone((*is_uncertain, *axis)),
        GivenRange::Mean { drawn, from, to } => line.mean(*drawn, (*from, *to), most),
    });
    let slices = own.chain(given).collect::<Result<Vec<_>>>()?;
    Ok((columns, slices))
}

/// How designs along a line through one are judged.
struct DesignLine<'a> {
    study: &'a Study,
    inputs: Vec<f64>,
    columns: &'a [Column],
    /// The draws, where what the study gives is varied.
    drawn: Vec<Vec<f64>>,
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

    /// Over an end of what an input is in the scenarios. These are others at each place, so that each is a study of its own.
    fn scenario_end(&self, end: ScenarioEnd, most: u64) -> Result<Slice> {
        let study = self.study;
        let which = (end.is_uncertain, end.axis);
        let axis = &self.scenario_axes(end.is_uncertain)[end.axis];
        let described = &study.model.inputs[end.input];
        let column = axis.inputs().iter().position(|it| *it == end.input).unwrap_or(0);
        let (least, largest) = axis.ends(column);
        let own = if end.is_largest { largest } else { least };
        let other = |alone: &Study, value: f64| self.with_axis(alone, which, with_end(axis, column, described.integer, own, value));
        let places = if described.integer {
            AxisPlaces::new(&Levels::Step { from: end.from, step: 1.0, count: (end.to - end.from) as u64 + 1, log: false }, own)
        } else {
            AxisPlaces::Between { low: end.from, high: end.to, log: axis.is_logarithmic(), own }
        };
        let (values, rows) = self.of_scenarios(&places, own, self.few(most), other)?;
        let which = match end.is_largest {
            _ if least == largest => "",
            true => ", the largest",
            false => ", the least",
        };
        let (name, unit) = (format!("{}{which}", described.name), described.unit.symbol.to_owned());
        Ok(Slice { name, unit, own, values, words: None, rows })
    }

    /// The scenarios with one of the words of an axis alone, beside all of them.
    fn alone(&self, which: (bool, usize)) -> Result<Slice> {
        let axis = &self.scenario_axes(which.0)[which.1];
        let input = axis.inputs()[0];
        let described = &self.study.model.inputs[input];
        let word = |at: f64| axis.value(0, at as u64 - 1);
        let other = |alone: &Study, at: f64| match at {
            0.0 => Ok(alone.clone()),
            _ => self.with_axis(alone, which, Axis::Single { input, levels: Levels::List(vec![word(at)]) }),
        };
        let places = AxisPlaces::new(&Levels::Step { from: 0.0, step: 1.0, count: axis.count() + 1, log: false }, 0.0);
        // Words have no order: all of them are looked at.
        let (values, rows) = self.of_scenarios(&places, 0.0, axis.count() + 1, other)?;
        let called = |&at: &f64| if at == 0.0 { "all of them".to_owned() } else { format!("{} alone", written(described, word(at))) };
        let words = Some(values.iter().map(called).collect());
        Ok(Slice { name: described.name.clone(), unit: String::new(), own: 0.0, values, words, rows })
    }

    /// The axes of uncertain inputs, or of loads.
    fn scenario_axes(&self, is_uncertain: bool) -> &[Axis] {
        if is_uncertain { &self.study.uncertainty } else { self.study.operating() }
    }

    /// The study of one design with another axis of scenarios.
    fn with_axis(&self, alone: &Study, (is_uncertain, number): (bool, usize), axis: Axis) -> Result<Study> {
        let mut axes = self.scenario_axes(is_uncertain).to_vec();
        axes[number] = axis;
        if is_uncertain {
            return Ok(Study { uncertainty: axes, ..alone.clone() });
        }
        alone.with_operating(axes, &self.drawn).map_err(Error::Request)
    }

    /// As [`DesignLine::of_studies`], of studies with other scenarios: those of one number are others at each place, so whether another one
    /// becomes the worst cannot be told by them.
    fn of_scenarios(
        &self,
        places: &AxisPlaces,
        own: f64,
        most: u64,
        other: impl Fn(&Study, f64) -> Result<Study> + Sync,
    ) -> Result<(Vec<f64>, Vec<Row>)> {
        let (values, mut rows) = self.of_studies(places, own, most, other)?;
        rows.iter_mut().flat_map(|row| &mut row.columns).for_each(|at| at.scenario = 0);
        Ok((values, rows))
    }

    /// Over the mean of a distribution.
    fn mean(&self, number: usize, (low, high): (f64, f64), most: u64) -> Result<Slice> {
        let study = self.study;
        let probability = study.probability.as_ref().ok_or_else(|| Error::Request("nothing is drawn".to_owned()))?;
        let uncertain = &probability.inputs[number];
        let own = uncertain.mean();
        let other = |alone: &Study, value: f64| {
            let mut moved = self.drawn.clone();
            moved[number].iter_mut().for_each(|it| *it += value - own);
            Ok(alone.with_drawn(moved))
        };
        let (values, rows) = self.of_studies(&AxisPlaces::Between { low, high, log: false, own }, own, self.few(most), other)?;
        let (of, unit) = match uncertain.effect {
            Effect::Is => ("mean", study.model.inputs[uncertain.input].unit.symbol),
            Effect::Plus => ("mean deviation", study.model.inputs[uncertain.input].unit.symbol),
            Effect::Times => ("mean factor", ""),
        };
        Ok(Slice { name: format!("{}, its {of}", uncertain.name), unit: unit.to_owned(), own, values, words: None, rows })
    }

    /// The design in studies that differ in a number of theirs, each from the study of this design alone.
    fn of_studies(
        &self,
        places: &AxisPlaces,
        own: f64,
        most: u64,
        other: impl Fn(&Study, f64) -> Result<Study> + Sync,
    ) -> Result<(Vec<f64>, Vec<Row>)> {
        let study = self.study;
        let first = &study.design[0];
        let alone = self.along(first, &[first.inputs().iter().map(|&it| self.inputs[it]).collect()]);
        let row = |value: f64| {
            let plan = Plan::new(other(&alone, value)?);
            Ok(certify::rows(&plan, self.columns, &[0], 1, self.control)?.remove(0))
        };
        let judged = |values: &[f64]| {
            let each = one_after_another(values.to_vec(), self.threads, || (), |(), value| row(value));
            each.into_iter().collect::<Result<Vec<Row>>>()
        };
        along_places(places, own, most, judged)
    }

    /// Places along what is a study of its own at each.
    fn few(&self, most: u64) -> u64 {
        if self.study.probability.is_some() { most.min(DRAWN_PLACES) } else { most }
    }
}

/// An axis with another end of one of its inputs: what was there goes to `value`, and between the ends of a range as many levels as before
/// lie, of whole numbers as many as its steps reach.
fn with_end(axis: &Axis, column: usize, is_whole: bool, own: f64, value: f64) -> Axis {
    // As the study has it, its levels are those of its steps, to the last bit.
    if value == own {
        return axis.clone();
    }
    let moved = |it: f64| if it == own { value } else { it };
    let (input, levels) = match axis {
        Axis::Single { input, levels } => (input, levels),
        Axis::Joint { inputs, rows } => {
            let other = |row: &Vec<f64>| row.iter().enumerate().map(|(at, &it)| if at == column { moved(it) } else { it }).collect();
            return Axis::Joint { inputs: inputs.clone(), rows: rows.iter().map(other).collect() };
        }
    };
    let ends = || (moved(levels.value(0)), moved(levels.value(levels.count() - 1)));
    let levels = match levels {
        _ if is_whole && levels.count() > 1 && !matches!(levels, Levels::List(_)) => {
            let ((from, to), step) = (ends(), levels.value(1) - levels.value(0));
            let inside = (0..).map(|at| from + f64::from(at) * step).take_while(|it| (to - it) * step > 0.0);
            Levels::List(inside.chain([to]).collect())
        }
        Levels::List(values) => Levels::List(values.iter().map(|&it| moved(it)).collect()),
        Levels::Even { from, to, count, log } => Levels::Even { from: moved(*from), to: moved(*to), count: *count, log: *log },
        Levels::Step { count, log, .. } => {
            let (from, to) = ends();
            Levels::Even { from, to, count: *count, log: *log }
        }
        Levels::Continuous { .. } => levels.clone(),
    };
    Axis::Single { input: *input, levels }
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

#[cfg(test)]
mod tests;
