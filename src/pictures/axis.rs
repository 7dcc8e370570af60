//! One axis of a panel: its range, its ticks and the text at each.

use super::number;
use super::sheet::UNIT;
use super::words::text_width;
use plotters::coord::ranged1d::{KeyPointHint, KeyPointWeight, NoDefaultFormatting, Ranged, ValueFormatter};

/// Height of tick text, in pixels.
pub(super) const TICK_TEXT: i32 = 12;

/// Least space between labels side by side, in units of paper.
const LABEL_GAP: i32 = 12 * UNIT;

/// How long tick labels may become before a power of ten moves into the axis label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Numbers {
    /// Up to 999 999 and down to 0.001.
    Long,
    /// Up to 9 999 and down to 0.01, for small panels.
    Short,
}

impl Numbers {
    /// The power of ten for an axis whose values reach `magnitude`: 0, or a multiple of 3.
    fn exponent(self, magnitude: f64) -> i32 {
        let plain = match self {
            Numbers::Long => -3..=5,
            Numbers::Short => -2..=3,
        };
        match number::scientific(magnitude).1 {
            exponent if plain.contains(&exponent) => 0,
            exponent => exponent.div_euclid(3) * 3,
        }
    }
}

/// A linear axis with its own choice of ticks. plotters can choose them too, but with an absolute tolerance, which fails for quantities
/// around 1e-12, and without regard for the width of their labels.
#[derive(Debug, Clone)]
pub(super) struct PlotAxis {
    low: f64,
    high: f64,
    ticks: Vec<Tick>,
    /// Tick labels are in units of ten to this.
    pub(super) exponent: i32,
}

#[derive(Debug, Clone)]
struct Tick {
    at: f64,
    label: String,
}

impl Tick {
    fn width(&self) -> i32 {
        text_width(&self.label, TICK_TEXT)
    }
}

impl PlotAxis {
    /// Horizontal numeric axis on `room` units of paper; labels that would stick out by more than `overhang` at either end are left out.
    pub(super) fn horizontal((low, high): (f64, f64), room: i32, overhang: i32, numbers: Numbers) -> Self {
        let most = (room / (20 * UNIT)).clamp(2, 12);
        let exponent = numbers.exponent(low.abs().max(high.abs()));
        let axis = |steps| Self::numeric(low, high, steps, exponent);
        let fits = |axis: &Self| axis.is_clear(room);
        let found = (2..=most).rev().map(axis).find(fits);
        let mut axis = found.unwrap_or_else(|| axis(1));
        axis.hide_labels_outside(room, overhang);
        axis
    }

    /// Vertical numeric axis on `room` units of paper.
    pub(super) fn vertical((low, high): (f64, f64), room: i32, numbers: Numbers) -> Self {
        let exponent = numbers.exponent(low.abs().max(high.abs()));
        Self::numeric(low, high, (room / (28 * UNIT)).clamp(2, 11), exponent)
    }

    /// Vertical axis of counts from 0: whole numbers only.
    pub(super) fn counts(high: f64, room: i32) -> Self {
        let whole = (high.clamp(2.0, 11.0)) as i32;
        let most = (room / (28 * UNIT)).clamp(2, whole);
        Self::numeric(0.0, high, most, Numbers::Long.exponent(high))
    }

    /// Vertical axis of whole numbers.
    pub(super) fn whole((low, high): (f64, f64), room: i32) -> Self {
        let most = (room / (28 * UNIT)).clamp(2, 11);
        let exponent = Numbers::Long.exponent(low.abs().max(high.abs()));
        Self::stepped(low, high, ((high - low) / f64::from(most)).max(1.0), exponent)
    }

    /// Axis over `low` to `high` with ticks chosen elsewhere: their places and texts.
    pub(super) fn with_ticks((low, high): (f64, f64), ticks: impl Iterator<Item = (f64, String)>) -> Self {
        let ticks = ticks.map(|(at, label)| Tick { at, label }).collect();
        Self { low, high, ticks, exponent: 0 }
    }

    /// Drops the ticks outside a section of the range.
    pub(super) fn within(mut self, low: f64, high: f64) -> Self {
        let slack = 1e-9 * (high - low);
        self.ticks.retain(|tick| low - slack <= tick.at && tick.at <= high + slack);
        self
    }

    /// Every tick: its place and its text.
    pub(super) fn ticks(&self) -> impl Iterator<Item = (f64, &str)> + '_ {
        self.ticks.iter().map(|tick| (tick.at, &tick.label[..]))
    }

    /// Width of the widest tick label, in units of paper.
    pub(super) fn label_width(&self) -> i32 {
        self.ticks.iter().map(Tick::width).max().unwrap_or(0)
    }

    /// Ticks at multiples of 1, 2 or 5 times a power of ten, with at most `most` steps between
    /// them; their labels in units of ten to the `exponent`.
    fn numeric(low: f64, high: f64, most: i32, exponent: i32) -> Self {
        Self::stepped(low, high, (high - low) / f64::from(most), exponent)
    }

    /// The same with steps of at least a given width.
    fn stepped(low: f64, high: f64, least: f64, exponent: i32) -> Self {
        let (mantissa, power) = number::scientific(least);
        let (mantissa, power) = match mantissa {
            m if m <= 1.0 => (1, power),
            m if m <= 2.0 => (2, power),
            m if m <= 5.0 => (5, power),
            _ => (1, power + 1),
        };
        let step = f64::from(mantissa) * number::power_of_ten(power);
        // A tick that is just outside the range because of rounding still belongs to it.
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        let tick = |k: i64| {
            let digits = i128::from(k) * i128::from(mantissa);
            Tick { at: (digits as f64 * number::power_of_ten(power)).clamp(low, high), label: number::decimal(digits, power - exponent) }
        };
        let ticks = (first..=last).map(tick).collect();
        Self { low, high, ticks, exponent }
    }

    /// Are the labels far enough from each other on `room` units of paper?
    pub(super) fn is_clear(&self, room: i32) -> bool {
        match self.ticks.as_slice() {
            [a, b, ..] => {
                let spacing = (b.at - a.at) / (self.high - self.low) * f64::from(room);
                f64::from(self.label_width() + LABEL_GAP) <= spacing
            }
            _ => true,
        }
    }

    fn hide_labels_outside(&mut self, room: i32, overhang: i32) {
        let (low, high) = (self.low, self.high);
        for tick in &mut self.ticks {
            let place = (tick.at - low) / (high - low) * f64::from(room);
            let reach = f64::from(tick.width() / 2 - overhang);
            if place - reach < 0.0 || place + reach > f64::from(room) {
                tick.label.clear();
            }
        }
    }
}

impl Ranged for PlotAxis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (start, end): (i32, i32)) -> i32 {
        let share = ((value - self.low) / (self.high - self.low)).clamp(-1.0, 2.0);
        start + (share * f64::from(end - start)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match hint.weight() {
            // plotters asks a second time for grid lines between the ticks, which would be clutter.
            KeyPointWeight::Any => Vec::new(),
            KeyPointWeight::Bold => self.ticks().map(|(at, _)| at).collect(),
        }
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for PlotAxis {
    fn format_ext(&self, value: &f64) -> String {
        let tick = self.ticks.iter().find(|tick| tick.at == *value);
        tick.map(|tick| tick.label.clone()).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &PlotAxis) -> Vec<&str> {
        axis.ticks().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round_numbers_in_plain_digits() {
        let axis = |range| PlotAxis::vertical(range, 250 * UNIT, Numbers::Long);
        assert_eq!(labels(&axis((0.0, 1.2))), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0", "1.2"]);
        assert_eq!(labels(&axis((-25.0, 60.0))), ["−20", "0", "20", "40", "60"]);
        let tiny = axis((1e-12, 3e-12));
        assert_eq!((tiny.exponent, labels(&tiny)), (-12, vec!["1.0", "1.5", "2.0", "2.5", "3.0"]));
        let huge = axis((0.0, 2e12));
        assert_eq!((huge.exponent, labels(&huge)), (12, vec!["0.0", "0.5", "1.0", "1.5", "2.0"]));
    }

    #[test]
    fn horizontal_labels_never_touch() {
        for room in [60, 140, 400, 800].map(|pixels| pixels * UNIT) {
            for range in [(0.0, 1.0), (20_000.0, 50_000.0), (1e6, 1e6 + 1.0), (-3e-7, 3e-7)] {
                let axis = PlotAxis::horizontal(range, room, 0, Numbers::Long);
                assert!(axis.is_clear(room), "{axis:?}");
                let ends = axis.ticks().filter(|(_, label)| !label.is_empty());
                assert!(ends.count() <= 13);
            }
        }
    }

    #[test]
    fn counts_have_no_fractions() {
        for high in [1.0, 2.0, 3.0, 7.0, 1e9] {
            let axis = PlotAxis::counts(high * 1.04, 380 * UNIT);
            assert!(labels(&axis).iter().all(|l| high > 1e3 || !l.contains('.')), "{axis:?}");
            assert!(axis.ticks().count() >= 2);
        }
    }
}
