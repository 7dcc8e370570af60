//! Many designs of a model, evaluated one by one in f64.

use super::{Evaluation, Model, Status, evaluate};
use crate::error::{Error, Result};
use crate::likeness::closest;
use crate::parallel::on_threads;

/// Rows that a thread is started for at least.
const ROWS_PER_THREAD: usize = 256;

/// What many evaluations give, one entry per row of the columns that they were asked with.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Evaluations {
    /// Ok, or why not.
    pub statuses: Vec<Status>,
    /// One column per output of the model, in the order of the model and in the output's unit; `None` where it has no meaning.
    pub outputs: Vec<Vec<Option<f64>>>,
}

impl Evaluations {
    /// The column of the output of that name.
    pub fn output(&self, model: &Model, name: &str) -> Option<&[Option<f64>]> {
        self.outputs.get(model.output(name)?).map(Vec::as_slice)
    }
}

/// Evaluates a model in f64 for every row of some columns, on every core: the same numbers as [`evaluate`] gives, in the order of the rows.
///
/// A column is the name of an input and its values, in the input's unit; all are equally long. Inputs without a column have their
/// defaults. As in [`evaluate`] values are not checked against the inputs' ranges.
///
/// ```
/// use beltspace::models;
///
/// let model = models::find("metal-cvt").unwrap();
/// let found = models::evaluate_many(&model, &[("band_count", &[6.0, 9.0, 12.0]), ("torque_Nm", &[50.0, 100.0, 150.0])])?;
/// let forces = found.output(&model, "axial_force_N").unwrap();
/// assert!(forces[0] < forces[2]);
/// # Ok::<(), beltspace::Error>(())
/// ```
///
/// # Errors
/// [`Error::NoSuchInput`] for a name that the model does not have; [`Error::Columns`] if an input has two columns or columns differ in
/// length.
pub fn evaluate_many(model: &Model, columns: &[(&str, &[f64])]) -> Result<Evaluations> {
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    let mut given: Vec<(usize, &[f64])> = Vec::with_capacity(columns.len());
    for &(name, values) in columns {
        let input = model.input(name).ok_or_else(|| no_such_input(model, name))?;
        if given.iter().any(|(it, _)| *it == input) || values.len() != rows {
            return Err(Error::Columns { name: name.to_owned(), rows: values.len(), expected: rows });
        }
        given.push((input, values));
    }
    let evaluated = |rows: std::ops::Range<usize>| -> Vec<Evaluation> {
        let mut inputs = model.defaults();
        let row = |row: usize| {
            given.iter().for_each(|&(input, values)| inputs[input] = values[row]);
            evaluate(model, &inputs)
        };
        rows.map(row).collect()
    };
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let share = rows.div_ceil(threads).max(ROWS_PER_THREAD);
    let parts = on_threads((0..rows).step_by(share).map(|first| first..rows.min(first + share)), evaluated);
    let mut found = Evaluations { statuses: Vec::with_capacity(rows), outputs: vec![Vec::with_capacity(rows); model.outputs.len()] };
    for Evaluation { status, outputs } in parts.into_iter().flatten() {
        found.statuses.push(status);
        found.outputs.iter_mut().zip(outputs).for_each(|(column, value)| column.push(value));
    }
    Ok(found)
}

fn no_such_input(model: &Model, name: &str) -> Error {
    let names: Vec<_> = model.inputs.iter().map(|it| it.name.as_str()).collect();
    Error::NoSuchInput { model: model.name.to_owned(), name: name.to_owned(), closest: closest(name, &names).map(str::to_owned) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_are_the_same_as_one_by_one_on_every_model() {
        for model in crate::models::all() {
            let rows = if model.name == "pulley" { 3 } else { 700 };
            let input = &model.inputs[0];
            let values: Vec<f64> = (0..rows).map(|row| input.default * (1.0 + 0.001 * f64::from(row))).collect();
            let found = evaluate_many(model, &[(&input.name, &values)]).expect("the names are the model's");
            let mut inputs = model.defaults();
            for (row, &value) in values.iter().enumerate() {
                inputs[0] = value;
                let one = evaluate(model, &inputs);
                assert_eq!(found.statuses[row], one.status);
                assert!(found.outputs.iter().zip(&one.outputs).all(|(column, value)| column[row] == *value), "{} {row}", model.name);
            }
        }
    }

    #[test]
    fn wrong_columns_are_named() {
        let model = crate::models::find("metal-cvt").expect("it is a model");
        let refused = |columns: &[(&str, &[f64])]| evaluate_many(&model, columns).expect_err("it is refused").to_string();
        assert_eq!(refused(&[("frictoin", &[0.1])]), "frictoin is no input of metal-cvt; did you mean friction?");
        assert_eq!(refused(&[("friction", &[0.1]), ("band_count", &[3.0, 4.0])]), "the column band_count has 2 rows, the first has 1");
        assert_eq!(refused(&[("friction", &[0.1]), ("friction", &[0.2])]), "there are two columns friction");
    }
}
