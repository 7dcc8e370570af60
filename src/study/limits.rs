//! Limits that the reader of study files and the check of every study share.

/// Most rows of a joint axis, and most values in them.
pub(super) const MOST_ROWS: usize = 1 << 21;
pub(super) const MOST_VALUES: usize = 1 << 23;
/// Most histograms of a study, and most maps.
pub(super) const MOST_PICTURES: usize = 100;
/// Most values of a quantity at which a map has lines.
pub(super) const MOST_THRESHOLDS: usize = 1000;
