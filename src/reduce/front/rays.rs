//! Where a row of designs on a ray may still reach the front.
//!
//! Two objectives that are both a factor of the row times one number y of each design put the row's designs on a ray from the origin.
//! For each bin of the first coordinate the table of the front says from which second coordinate on a design is surely beaten, and so
//! how steep a ray is beaten in the whole bin. The largest of these numbers in groups of bins finds those of a range where a ray is not.
//! Rounding to whole steps can make a key less than its ray by up to `cut`, so the table is shifted by that much.

use super::filter::BinTable;
use std::ops::Range;

/// What the edges of bins and the factors of rays may be off by, relative: far more than they are rounded by.
const SLACK: f64 = 1e-9;
/// Bins in a group.
const GROUP: usize = 16;
/// With more bins than this per magnitude of a coordinate, which bin it belongs to may be off by more than is allowed for.
const MOST_BINS: f64 = 1e8;

/// How steep a ray must be to be beaten all over a bin, for rays that fall along one coordinate and rise along the other.
#[derive(Debug)]
pub(super) struct Rays<const BINS: usize> {
    /// Is the first coordinate below zero, and does the second rise along a ray?
    is_steep: bool,
    /// Of each bin.
    least: Vec<f64>,
    /// The largest of the [inner bins](Self::INNER) of each group, of each two groups next to each other, each four and so on, by the first
    /// of them.
    of_groups: Vec<Vec<f64>>,
    low: f64,
    scale: f64,
    /// The second coordinate from which on what is in the last bin is surely beaten.
    best_of_last: f64,
}

impl<const BINS: usize> Rays<BINS> {
    /// Bins that rays may be beaten in. Nothing is better than what belongs to the first two; the last has no upper edge.
    const INNER: Range<usize> = 2..BINS - 1;

    /// From a table, for rays whose first coordinate is below zero, or else above it with the second below. Rounding to whole steps may
    /// make the coordinates of a design less than those of its ray by up to `cut`.
    pub(super) fn new(table: &BinTable<BINS>, is_steep: bool, cut: (f64, f64)) -> Self {
        let (low, scale) = table.line();
        let (low, best) = (low + cut.0, |bin| table.best(bin) + cut.1);
        let mut least = vec![f64::INFINITY; BINS];
        let is_sharp = scale > 0.0 && scale * low.abs() < MOST_BINS;
        for bin in if is_sharp { Self::INNER } else { 0..0 } {
            // The first coordinate is at most this, whichever way it was rounded.
            let edge = low + (bin as f64 - 0.5 + 1e-6) / scale;
            let edge = edge + SLACK * edge.abs();
            if if is_steep { edge < 0.0 } else { edge > 0.0 } {
                least[bin] = best(bin) / edge.abs();
            }
        }
        let largest = |first: usize| {
            least[first.max(Self::INNER.start)..Self::INNER.end.min(first + GROUP)].iter().copied().fold(f64::NEG_INFINITY, f64::max)
        };
        let of_groups: Vec<f64> = (0..BINS).step_by(GROUP).map(largest).collect();
        let twice = |shorter: &Vec<f64>, apart: usize| shorter.iter().zip(shorter.iter().skip(apart)).map(|(a, b)| a.max(*b)).collect();
        let mut of_groups = vec![of_groups];
        while let Some(last) = of_groups.last().filter(|last| last.len() > 1 << (of_groups.len() - 1)) {
            of_groups.push(twice(last, 1 << (of_groups.len() - 1)));
        }
        Self { is_steep, least, of_groups, low, scale, best_of_last: best(BINS - 1) }
    }

    /// Is it for rays of this kind?
    pub(super) fn is_for(&self, is_steep: bool) -> bool {
        self.is_steep == is_steep
    }

    /// Calls `each` with ranges of the number y between `from` and `to` (both at least zero) outside of which every design with the coordinates
    /// `factors.0 * y` and `factors.1 * y` is surely beaten.
    pub(super) fn open(&self, factors: (f64, f64), (from, to): (f64, f64), mut each: impl FnMut(f64, f64)) {
        let steepness = factors.1 / factors.0.abs();
        let steepness = steepness - SLACK * steepness.abs();
        if !steepness.is_finite() {
            return each(from, to);
        }
        let place = |y: f64| (factors.0 * y - self.low) * self.scale + 1.0;
        let bin = |place: f64| (place.clamp(0.0, (BINS - 1) as f64)) as usize;
        let (a, b) = (place(from), place(to));
        // One bin more on either side: places are rounded.
        let (first, mut last) = (bin(a.min(b) - 1.0), bin(a.max(b) + 1.5));
        // The last bin has no upper edge, but there is a least number.
        if self.is_steep && last == BINS - 1 && first < last && factors.1 * from * (1.0 - SLACK) >= self.best_of_last {
            last -= 1;
        }
        let mut bin = first;
        while let Some(open) = self.next_open(bin, last, steepness) {
            let mut end = open;
            while end < last && self.least[end + 1] > steepness {
                end += 1;
            }
            // What lies beyond the outer bins belongs to them.
            let edge = |place: f64| (self.low + place / self.scale) / factors.0;
            let (x, y) = (edge(open as f64 - 1.6), edge(end as f64 - 0.4));
            let (mut low, mut high) = (x.min(y), x.max(y));
            if factors.0 < 0.0 {
                (low, high) = (if end == BINS - 1 { from } else { low }, if open == 0 { to } else { high });
            } else {
                (low, high) = (if open == 0 { from } else { low }, if end == BINS - 1 { to } else { high });
            }
            each(low - SLACK * low.abs(), high + SLACK * high.abs());
            bin = end + 1;
        }
    }

    /// The first bin between two where rays of this steepness are not beaten.
    fn next_open(&self, from: usize, last: usize, steepness: f64) -> Option<usize> {
        let inner = last.min(Self::INNER.end - 1);
        let mut bin = from;
        while bin <= last {
            if !Self::INNER.contains(&bin) {
                return Some(bin);
            }
            let mut group = bin / GROUP;
            if self.of_groups[0][group] > steepness {
                let end = ((group + 1) * GROUP).min(inner + 1);
                if let Some(open) = self.least[bin..end].iter().position(|least| *least > steepness) {
                    return Some(bin + open);
                }
                bin = end;
                continue;
            }
            // On past groups that are all beaten, as many at a time as may be.
            for (power, largest) in self.of_groups.iter().enumerate().rev() {
                if group + (1 << power) <= inner / GROUP + 1 && largest[group] <= steepness {
                    group += 1 << power;
                }
            }
            bin = (group * GROUP).min(inner + 1);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::super::Points;
    use super::*;

    /// A front whose first coordinate falls or rises along rays, with gaps.
    fn table(sign: f64, count: usize) -> BinTable<8192> {
        let mut points = Points::default();
        let mut firsts: Vec<f64> = (1..=count).map(|number| sign * (number as f64).powf(1.7)).collect();
        firsts.sort_by(f64::total_cmp);
        for (number, &first) in firsts.iter().enumerate() {
            // Better in the first coordinate is worse in the second.
            let second =
                if sign < 0.0 { first.abs() * (1.0 + 0.1 * (first.abs() * 0.3).sin()) } else { -first * (1.0 + 0.1 * (first * 0.3).sin()) };
            points.push([first, second - 1e-3 * number as f64], number as u64);
        }
        BinTable::new(points.keys.as_chunks().0.iter().copied())
    }

    #[test]
    fn of_rays_too_steep_for_a_number_nothing_is_left_out() {
        let table = table(-1.0, 300);
        let mut open = Vec::new();
        Rays::new(&table, true, (0.0, 0.0)).open((-1e-300, 1e300), (0.5, 2.0), |low, high| open.push((low, high)));
        assert_eq!(open, [(0.5, 2.0)]);
    }

    #[test]
    fn what_is_left_out_is_beaten_and_little_else_is_kept() {
        for sign in [-1.0, 1.0] {
            let table = table(sign, 300);
            let (mut kept, mut beaten) = (0, 0);
            for steepness in 0..60 {
                // What steps cut off is less than the bins of the table tell apart, or far more.
                let cut = [(0.0, 0.0), (1e-3, 0.0), (0.0, 30.0), (20.0, 5.0)][steepness as usize / 2 % 4];
                let rays = Rays::new(&table, sign < 0.0, cut);
                let factors = (sign * 1.3, -sign * 1.3 * (0.8 + 0.01 * f64::from(steepness)));
                // The least number of some rays is beaten beyond the last bin, of others it is not.
                let (from, to) = (if steepness % 2 == 0 { 0.5 } else { 0.75 }, 14_000.0);
                let mut open: Vec<(f64, f64)> = Vec::new();
                rays.open(factors, (from, to), |low, high| open.push((low, high)));
                for place in 0..20_000 {
                    let y = from + (to - from) * (f64::from(place) / 20_000.0).powi(2);
                    let is_beaten = table.beats(factors.0 * y - cut.0, factors.1 * y - cut.1);
                    let is_open = open.iter().any(|(low, high)| (*low..=*high).contains(&y));
                    assert!(is_beaten || is_open, "{factors:?} at {y}");
                    kept += u32::from(is_open && is_beaten);
                    beaten += u32::from(is_beaten);
                }
            }
            assert!(beaten > 200_000 && kept < beaten / 10, "{kept} of {beaten} are looked at in vain");
        }
    }
}
