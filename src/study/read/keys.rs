//! The keys of the tables of a study file and of a model's file, as the reader takes them and the schema tells them.

/// Of a catalogue: rows of a CSV file.
pub(in super::super) const CSV_ROWS: &[&str] = &["csv", "unused"];
/// Of contours of a map.
pub(in super::super) const CONTOURS: &[&str] = &["of", "at"];
/// Of `[probability]`.
pub(in super::super) const PROBABILITY: &[&str] = &["draws", "confirm", "seed", "method", "correlation", "enclosure"];
/// Of a quantile over draws.
pub(in super::super) const QUANTILE: &[&str] = &["quantile"];
/// Of a formula.
pub(in super::super) const FORMULA: &[&str] = &["is", "worst", "integer", "hidden", "symbol", "doc", "source"];
/// Of a measured curve.
pub(in super::super) const CURVE: &[&str] = &["csv", "x", "y"];
/// Of measured values of a distribution.
pub(in super::super) const MEASURED: &[&str] = &["csv", "column"];
/// Of `[sample]`.
pub(in super::super) const SAMPLE: &[&str] = &["method", "count", "seed"];
/// Of an output of a model's file.
pub(in super::super) const OUTPUT: &[&str] = &["worst", "symbol", "doc", "source"];
/// Of a condition of a model's file.
pub(in super::super) const CONDITION: &[&str] = &["margin", "strict", "quiet", "invalidates", "doc"];
/// Of the valid range of an input of a model's file.
pub(in super::super) const VALID: &[&str] = &["min", "above", "max", "below"];
/// Of an input of a model's file.
pub(in super::super) const INPUT: &[&str] =
    &["default", "valid", "usual", "integer", "words", "only_for", "follows", "instead_of", "symbol", "doc", "source"];
/// Of a constraint.
pub(in super::super) const CONSTRAINT: &[&str] = &["min", "max", "above", "below", "of", "over_scenarios"];
/// Of an objective.
pub(in super::super) const OBJECTIVE: &[&str] = &["goal", "resolution", "of", "over_scenarios"];
/// Of a range.
pub(in super::super) const RANGE: &[&str] = &["from", "to", "count", "step", "spacing"];
/// Of `[report]`.
pub(in super::super) const REPORT: &[&str] =
    &["columns", "top", "histograms", "maps", "sample", "front_budget", "variants", "feasible", "sensitivity"];
/// Of its `sample`.
pub(in super::super) const REPORT_SAMPLE: &[&str] = &["count", "seed"];
/// Of a column of it.
pub(in super::super) const REPORT_COLUMN: &[&str] = &["of", "worst", "over_scenarios"];
/// Of its `top`.
pub(in super::super) const TOP: &[&str] = &["by", "count", "goal"];
/// Of a histogram.
pub(in super::super) const HISTOGRAM: &[&str] = &["of", "bins", "from", "to"];
/// Of a map.
pub(in super::super) const MAP: &[&str] = &["x", "y", "value", "best", "contours"];
/// Of its `sensitivity`.
pub(in super::super) const SENSITIVITY: &[&str] = &["over", "of", "draws"];
/// Of an axis with weights.
pub(in super::super) const SPECTRUM: &[&str] = &["cases", "weight"];
