//! The range that holds the root of every design of a box, in some ten evaluations.
//!
//! A place where all functions are surely below zero lies before every root. Newton steps lead close to such a place, and to one beyond
//! every root; only what the functions are there counts, not how the places were found.

use super::{Interval, greater, lesser};
use crate::real::Smoothness;

/// The roots of increasing functions, one for each design: see [`Real::monotone_root`](super::Real::monotone_root).
pub(super) fn root_of_all(
    bracket: (Interval, Interval),
    start: Interval,
    smoothness: Smoothness,
    function: impl Fn(Interval) -> (Interval, Interval),
) -> Interval {
    let (least, largest) = (bracket.0.low, bracket.1.high);
    let anywhere = Interval::known(least, largest, f64::INFINITY);
    // What lies in the bracket of every design.
    let inner = Interval::new(bracket.0.high, bracket.1.low);
    if !anywhere.is_finite() || !inner.is_finite() {
        return anywhere;
    }
    let search = Search { inner, function: |x| function(Interval::point(x)) };
    let near = search.newton(start.middle());
    let (below, above) = (search.edge(near, true), search.edge(near, false));
    let (low, high) = match (below, above) {
        // Every design has its root between the two.
        (Some(low), Some(high)) => {
            let (value, slope) = function(Interval::new(low, high));
            let size = greater(f64::abs(low), f64::abs(high));
            // f64 stops where its value is lost in rounding. Where the slope may vanish nothing is known of how far that is from the
            // root.
            if slope.low <= 0.0 {
                return anywhere;
            }
            // What f64 foresees of a smooth function may be wrong by accident: so much where it is a thousand times as curved as those of
            // the variators.
            let foreseen = if smoothness == Smoothness::Smooth { 1e-13 } else { 1e-14 };
            let error = 3.0 * value.error / slope.low + foreseen * size;
            return Interval::known(greater(low - error, least), lesser(high + error, largest), error * 1.000_000_1);
        }
        // There may be none, and then f64 goes up from its start; what has a root has it above.
        (Some(low), None) => (lesser(low, greater(start.low, least)), largest),
        (None, Some(high)) => (least, greater(high, lesser(start.high, largest))),
        (None, None) => (least, largest),
    };
    Interval::known(low, high, f64::INFINITY)
}

/// The search for the ends of the range that roots lie in.
struct Search<F> {
    /// Where to search.
    inner: Interval,
    /// Values and slopes of all functions at one place.
    function: F,
}

/// A place and what the functions are there.
#[derive(Clone, Copy)]
struct SearchPoint {
    x: f64,
    value: Interval,
    slope: f64,
}

impl<F: Fn(f64) -> (Interval, Interval)> Search<F> {
    fn place(&self, x: f64) -> SearchPoint {
        let x = x.max(self.inner.low).min(self.inner.high);
        let (value, slope) = (self.function)(x);
        SearchPoint { x, value, slope: slope.middle() }
    }

    /// Somewhere among the roots: where the values are as much above zero as below.
    fn newton(&self, start: f64) -> SearchPoint {
        let mut place = self.place(start);
        for _ in 0..10 {
            let step = place.value.middle() / place.slope;
            let close = greater(0.1 * place.value.width() / place.slope, 1e-15 * f64::abs(place.x));
            let is_far = place.slope > 0.0 && f64::abs(step) > close;
            if !is_far {
                break;
            }
            let next = self.place(place.x - step);
            if next.x == place.x {
                break;
            }
            place = next;
        }
        place
    }

    /// A place below every root, close to the least of them (or above every root, close to the largest), if there is one to be found.
    fn edge(&self, near: SearchPoint, is_below: bool) -> Option<f64> {
        let outwards = if is_below { -1.0 } else { 1.0 };
        // Less than zero beyond all roots, by more than f64 can be wrong.
        let beyond = |value: Interval| 2.0 * value.error + if is_below { value.high } else { -value.low };
        let mut place = near;
        let mut excess = beyond(place.value);
        let mut best = None;
        let mut slope = place.slope;
        let mut pad = 0.0;
        for _ in 0..12 {
            if slope <= 0.0 || slope.is_nan() {
                break;
            }
            // Nothing is gained by an end that is known better than a small part of the range.
            let close = greater(2e-3 * place.value.width() / slope, 4e-15 * f64::abs(place.x));
            if excess < 0.0 {
                best = Some(place.x);
                if -excess <= 2.0 * close * slope {
                    break;
                }
                pad = 0.5 * close;
            } else {
                pad = greater(8.0 * pad, 0.5 * close);
            }
            let next = self.place(place.x + outwards * (excess / slope + pad));
            let moved = outwards * (next.x - place.x);
            if moved == 0.0 {
                break;
            }
            let next_excess = beyond(next.value);
            // The functions that reach zero last may be steeper or flatter than the middle of all.
            let secant = (excess - next_excess) / moved;
            slope = if secant > 0.2 * next.slope && secant < 5.0 * next.slope { secant } else { next.slope };
            (place, excess) = (next, next_excess);
        }
        best
    }
}
