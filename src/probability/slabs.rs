//! Margins that are not sure over a box: for which part of it they are.
//!
//! By the mean value theorem a margin is its value at one place of the box plus its derivatives times the way from there. That place
//! divides the box into orthants. In each of them bounds of the derivatives give a plane below the margin and one above it; between the
//! two it may change sign, beyond them it does not. They are as far apart as the derivatives differ over the box, so the slab between them
//! narrows with the square of the box.

use super::half_space::share_below;
use crate::real::Real;
use crate::tape::Interval;

/// More than rounding can make of a sum of a few products.
const OUTWARD: f64 = 1.0 + 64.0 * f64::EPSILON;

/// What is known of a margin over a box, in which places go from 0 to 1 along every axis.
#[derive(Clone, Copy, Debug)]
pub struct Margin<const N: usize> {
    /// Its value at one place.
    pub at: Option<Interval>,
    /// Its derivatives anywhere in the box.
    pub slopes: [Interval; N],
    /// How far f64 may be off its exact value anywhere in the box.
    pub error: f64,
}

impl<const N: usize> Margin<N> {
    /// Has it a value at one place, and bounded derivatives?
    pub fn is_bounded(&self) -> bool {
        self.at.is_some_and(|it| it.is_finite()) && self.slopes.iter().all(|slope| slope.is_finite())
    }
}

/// A margin with a value at one place and bounded derivatives.
#[derive(Clone, Copy, Debug)]
struct Slab<const N: usize> {
    /// At that place, with the error of f64.
    low: f64,
    high: f64,
    slopes: [Interval; N],
}

/// A plane over the unit cube.
#[derive(Clone, Copy, Debug)]
struct LimitPlane<const N: usize> {
    /// At the origin.
    value: f64,
    slopes: [f64; N],
}

impl<const N: usize> LimitPlane<N> {
    fn scale(&self) -> f64 {
        self.slopes.iter().fold(0.0, |most: f64, it| most.max(it.abs()))
    }

    /// Bounds of the share of the cube in which it is not above zero.
    fn negative(&self) -> (f64, f64) {
        share_below(&self.slopes, -self.value)
    }
}

/// A part of the cube around a place: along each axis what lies below it, or above it.
#[derive(Clone, Copy, Debug)]
struct Orthant<const N: usize> {
    /// Length of the sides, with the sign of the direction away from the place.
    sides: [f64; N],
}

impl<const N: usize> Orthant<N> {
    /// All orthants around a place, along the axes that matter.
    fn around(within: &[f64; N], matters: &[bool; N]) -> impl Iterator<Item = Self> {
        (0..1usize << N).filter_map(move |number| {
            let mut sides = [1.0; N];
            for axis in 0..N {
                let is_lower = number >> axis & 1 == 1;
                if is_lower && !matters[axis] {
                    return None;
                }
                if matters[axis] {
                    sides[axis] = if is_lower { -within[axis] } else { 1.0 - within[axis] };
                }
            }
            Some(Self { sides })
        })
    }

    /// Its share of the cube.
    fn size(&self) -> f64 {
        self.sides.iter().map(|side| side.abs()).product()
    }

    /// The plane below (or above) a margin, from the place at the origin to the far corner of the orthant at (1, .., 1).
    fn plane(&self, slab: &Slab<N>, is_above: bool) -> LimitPlane<N> {
        let mut plane = LimitPlane { value: if is_above { slab.high } else { slab.low }, slopes: [0.0; N] };
        let mut size = plane.value.abs();
        for axis in 0..N {
            let (slope, side) = (slab.slopes[axis], self.sides[axis]);
            plane.slopes[axis] = side * if (side > 0.0) == is_above { slope.high } else { slope.low };
            size += plane.slopes[axis].abs();
        }
        let rounding = (OUTWARD - 1.0) * size;
        plane.value += if is_above { rounding } else { -rounding };
        plane
    }
}

/// The slabs of a box that must keep several margins at zero or above.
#[derive(Debug)]
pub struct Slabs<const N: usize> {
    /// The place at which margins are known.
    within: [f64; N],
    slabs: Vec<Slab<N>>,
    /// How much shorter axes would narrow the slabs.
    effects: [f64; N],
    /// Is there a margin without a slab?
    is_open: bool,
}

impl<const N: usize> Slabs<N> {
    /// Of margins that are known at a place `within` the box.
    pub fn new(within: [f64; N]) -> Self {
        Self { within, slabs: Vec::new(), effects: [0.0; N], is_open: false }
    }

    /// Takes a margin: is it above zero all over the box, or below zero? `None` if neither is sure.
    pub fn add(&mut self, margin: &Margin<N>) -> Option<bool> {
        let Some(at) = margin.at.filter(|_| margin.is_bounded()) else {
            self.is_open = true;
            return None;
        };
        let error = margin.error * OUTWARD;
        let slab = Slab { low: at.low - error, high: at.high + error, slopes: margin.slopes };
        let (mut least, mut most) = (slab.low, slab.high);
        let mut size = slab.low.abs() + slab.high.abs();
        let (mut apart, mut scale) = ([0.0; N], 0.0f64);
        for (apart, (slope, below)) in apart.iter_mut().zip(slab.slopes.iter().zip(self.within)) {
            let above = 1.0 - below;
            least += (slope.low * above).min(-slope.high * below).min(0.0);
            most += (slope.high * above).max(-slope.low * below).max(0.0);
            size += slope.low.abs().max(slope.high.abs());
            *apart = slope.high - slope.low;
            scale = scale.max(0.5 * (slope.low + slope.high).abs());
        }
        let rounding = (OUTWARD - 1.0) * size;
        if least - rounding > 0.0 {
            return Some(true);
        }
        if most + rounding < 0.0 {
            return Some(false);
        }
        let scale = if scale > 0.0 { scale } else { 1.0 };
        (0..N).for_each(|axis| self.effects[axis] += apart[axis] / scale);
        self.slabs.push(slab);
        None
    }

    /// At least these shares of the box surely keep all margins, and surely violate one.
    pub fn shares(&self) -> (f64, f64) {
        let matters = std::array::from_fn(|axis| self.slabs.iter().any(|slab| !slab.slopes[axis].is_zero()));
        let (mut keeps, mut violates) = (0.0, 0.0);
        for orthant in Orthant::around(&self.within, &matters) {
            let above = self.slabs.iter().map(|slab| orthant.plane(slab, true).negative().0);
            violates += orthant.size() * above.fold(0.0, f64::max);
            if !self.is_open {
                let below: Vec<LimitPlane<N>> = self.slabs.iter().map(|slab| orthant.plane(slab, false)).collect();
                keeps += orthant.size() * (1.0 - possibly_negative(&below)).next_down().max(0.0);
            }
        }
        // Sizes and sums are rounded to nearest.
        ((keeps / OUTWARD).min(1.0), (violates / OUTWARD).min(1.0))
    }

    /// The axes, the one first along which shorter boxes would tell the most.
    pub fn longest(&self) -> [usize; N] {
        let mut axes: [usize; N] = std::array::from_fn(|axis| axis);
        axes.sort_by(|&a, &b| self.effects[b].total_cmp(&self.effects[a]).then(a.cmp(&b)));
        axes
    }
}

/// The largest share of the cube in which one of several planes may be negative.
///
/// It is no more than the sum of all shares; nor more than the share of a plane below all of them that is parallel to one of them. Where
/// many are nearly the same, such as those of neighbouring operating cases, that is hardly more than one.
fn possibly_negative<const N: usize>(planes: &[LimitPlane<N>]) -> f64 {
    let shares: Vec<f64> = planes.iter().map(|plane| plane.negative().1).collect();
    let first = (0..planes.len()).reduce(|best, it| if shares[it] > shares[best] { it } else { best });
    let Some(first) = first.map(|it| planes[it]) else { return 0.0 };
    let sum = (shares.iter().sum::<f64>() * OUTWARD).min(1.0);
    let of = first.scale();
    let mut beyond: f64 = 0.0;
    for plane in planes.iter().zip(&shares).filter(|(_, share)| **share > 0.0).map(|(plane, _)| plane) {
        // Signs do not change with scale.
        let scale = plane.scale() / of;
        let apart = first.slopes.iter().zip(plane.slopes).map(|(a, b)| (a - b / scale).max(0.0)).sum::<f64>();
        let rounding = (OUTWARD - 1.0) * (plane.value.abs() / scale + first.value.abs() + N as f64 * of);
        let above = first.value - plane.value / scale + apart + rounding;
        if above.is_nan() {
            return sum;
        }
        beyond = beyond.max(above);
    }
    sum.min(share_below(&first.slopes, beyond - first.value).1)
}
