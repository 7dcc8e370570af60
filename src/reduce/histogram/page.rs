//! Histograms as pictures and on the page, there from their files.

use super::{Histogram, names};
use crate::error::Result;
use crate::pictures::{self, PlotQuantity};
use crate::reading::{Folder, changed, owned, rows_of};
use crate::study::{HistogramSpec, Study};
use serde_json::{Map, Value, json};

/// The picture of a histogram.
pub fn picture(study: &Study, spec: &HistogramSpec, histogram: &Histogram) -> String {
    let quantity = PlotQuantity::new(spec.of.name(&study.model), spec.of.unit(&study.model));
    let Histogram { from, to, counts, below, above, .. } = histogram;
    pictures::histogram(&study.title, &quantity, *from, *to, counts, *below, *above)
}

/// All histograms of a study.
pub fn histograms(folder: &Folder<'_>, data: &mut Map<String, Value>) -> Result<()> {
    let study = &folder.plan.study;
    let all = study.report.histograms.iter().zip(names(study)).map(|(spec, name)| histogram(folder, spec, &name));
    data.insert("histograms".to_owned(), all.collect::<Result<Vec<_>>>()?.into());
    Ok(())
}

/// A histogram of all feasible designs, from its file.
fn histogram(folder: &Folder<'_>, spec: &HistogramSpec, name: &str) -> Result<Value> {
    let study = &folder.plan.study;
    let file = folder.path.join(format!("{name}.csv"));
    let rows = rows_of(&file, &owned(["from", "to", "designs"]), spec.bins + 2)?;
    let [below, bins @ .., above] = &rows[..] else {
        return Err(changed(&file, "it is no histogram"));
    };
    let counts: Option<Vec<u64>> = rows.iter().map(|row| row[2].parse().ok()).collect();
    let counts = counts.ok_or_else(|| changed(&file, "a number of designs is none"))?;
    let sum = counts.iter().try_fold(0, |sum: u64, &it| sum.checked_add(it));
    if bins.len() != spec.bins || sum != Some(folder.feasible) {
        return Err(changed(&file, "its bins or their designs are not those of the study"));
    }
    let edges = |at: usize| -> Option<Vec<f64>> { bins.iter().map(|row| row[at].parse().ok().filter(|it: &f64| it.is_finite())).collect() };
    let (from, to) = edges(0).zip(edges(1)).ok_or_else(|| changed(&file, "an edge is no number"))?;
    let joined = from.iter().skip(1).eq(to.iter().take(to.len().saturating_sub(1))) && from.iter().zip(&to).all(|(from, to)| from <= to);
    let ends = below[0].is_empty() && above[1].is_empty() && below[1] == bins[0][0] && above[0] == bins[bins.len() - 1][1];
    if !joined || !ends {
        return Err(changed(&file, "its bins do not follow each other"));
    }
    Ok(json!({
        "of": spec.of.name(&study.model), "unit": spec.of.unit(&study.model), "doc": spec.of.doc(&study.model),
        "from": from, "to": to, "designs": counts[1..=bins.len()], "below": counts[0], "above": counts[bins.len() + 1],
    }))
}
