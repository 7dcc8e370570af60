//! A number with what a formula keeps beside it: its slope by the unknown of a root, and whether it is there at all.

#[allow(unused_imports, reason = "what Real itself has is taken from there")]
use crate::real::Real;

/// Keeps divisors of slopes away from zero; f32 holds it too.
const TINY: f64 = 1e-30;
/// Largest exponent of e; f64 overflows at 709.8.
pub(super) const LARGEST_EXPONENT: f64 = 700.0;
/// A number this near to a whole one, relative to its size or to 1, is taken as that one.
const NEAR: f64 = 1e-9;

/// A value while a formula is evaluated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Value<R> {
    pub(super) value: R,
    /// By the unknown of the root around it; `None` is zero.
    pub(super) slope: Option<R>,
    /// At least zero if it has a value; `None` if it always has.
    pub(super) present: Option<R>,
}

/// The smaller of two margins.
pub(super) fn both<R: Real>(a: Option<R>, b: Option<R>) -> Option<R> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (one, other) => one.or(other),
    }
}

impl<R: Real> Value<R> {
    pub(super) fn fixed(value: R) -> Self {
        Self { value, slope: None, present: None }
    }

    pub(super) fn constant(value: f64) -> Self {
        Self::fixed(R::constant(value))
    }

    /// A function of this number, with its slope.
    pub(super) fn chain(self, value: R, slope: impl FnOnce(R) -> R) -> Self {
        Self { value, slope: self.slope.map(slope), ..self }
    }

    /// A function of two numbers; each slope is made of one of theirs.
    fn merge(self, other: Self, value: R, of_self: impl FnOnce(R) -> R, of_other: impl FnOnce(R) -> R) -> Self {
        let slope = match (self.slope.map(of_self), other.slope.map(of_other)) {
            (Some(a), Some(b)) => Some(a + b),
            (one, other) => one.or(other),
        };
        Self { value, slope, present: both(self.present, other.present) }
    }

    pub(super) fn negative(self) -> Self {
        self.chain(-self.value, |slope| -slope)
    }

    pub(super) fn plus(self, other: Self) -> Self {
        self.merge(other, self.value + other.value, |slope| slope, |slope| slope)
    }

    pub(super) fn minus(self, other: Self) -> Self {
        self.merge(other, self.value - other.value, |slope| slope, |slope| -slope)
    }

    pub(super) fn times(self, other: Self) -> Self {
        self.merge(other, self.value * other.value, |slope| slope * other.value, |slope| slope * self.value)
    }

    /// The quotient by what is not zero.
    pub(super) fn over(self, other: Self) -> Self {
        let value = self.value / other.value;
        self.merge(other, value, |slope| slope / other.value, |slope| -(value * slope / other.value))
    }

    /// The first where the margin is at least zero, else the second; whether they are there goes with them.
    pub(super) fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
        let [zero, one] = [0.0, 1.0].map(R::constant);
        let slope = match (at_least_zero.slope, below_zero.slope, margin.slope) {
            (None, None, None) => None,
            (a, b, of_margin) => {
                let [of_margin, a, b] = [of_margin, a, b].map(|slope| slope.unwrap_or(zero));
                Some(R::select_slope(margin.value, of_margin, a, b))
            }
        };
        let present = match (at_least_zero.present, below_zero.present) {
            (None, None) => None,
            (a, b) => Some(R::select(margin.value, a.unwrap_or(one), b.unwrap_or(one))),
        };
        Self { value: R::select(margin.value, at_least_zero.value, below_zero.value), slope, present: both(margin.present, present) }
    }

    /// One of two whose values are equal where the choice changes.
    fn kinked(self, other: Self, value: R, margin: R) -> Self {
        let slope = match (self.slope, other.slope) {
            (None, None) => None,
            (a, b) => Some(R::select(margin, a.unwrap_or(R::constant(0.0)), b.unwrap_or(R::constant(0.0)))),
        };
        Self { value, slope, present: both(self.present, other.present) }
    }

    pub(super) fn min(self, other: Self) -> Self {
        self.kinked(other, self.value.min(other.value), other.value - self.value)
    }

    pub(super) fn max(self, other: Self) -> Self {
        self.kinked(other, self.value.max(other.value), self.value - other.value)
    }

    pub(super) fn abs(self) -> Self {
        self.chain(self.value.abs(), |slope| R::select(self.value, slope, -slope))
    }

    /// With one in place of zero.
    pub(super) fn not_zero(self) -> Self {
        Self { value: R::select(-self.value.abs(), R::constant(1.0), self.value), ..self }
    }

    /// With one in place of what is not positive.
    pub(super) fn positive(self) -> Self {
        Self { value: R::select(-self.value, R::constant(1.0), self.value), ..self }
    }

    /// Multiplied by itself from left to right, one to eight times.
    pub(super) fn whole_power(self, power: i8) -> Self {
        let square = || Self { value: self.value.squared(), ..self.times(self) };
        (2..power).fold(if power == 1 { self } else { square() }, |product, _| product.times(self))
    }

    pub(super) fn sqrt(self) -> Self {
        let root = self.value.max(R::constant(0.0)).sqrt();
        self.chain(root, |slope| slope * R::constant(0.5) / root.max(R::constant(TINY)))
    }

    fn bounded_exponent(self) -> R {
        self.value.min(R::constant(LARGEST_EXPONENT))
    }

    pub(super) fn exp(self) -> Self {
        let value = self.bounded_exponent().exp();
        self.chain(value, |slope| slope * value)
    }

    pub(super) fn exp_m1(self) -> Self {
        let value = self.bounded_exponent().exp_m1();
        self.chain(value, |slope| slope * (value + R::constant(1.0)))
    }

    /// Of what is positive.
    pub(super) fn ln(self) -> Self {
        self.chain(self.value.ln(), |slope| slope / self.value)
    }

    /// Of what is positive.
    pub(super) fn log10(self) -> Self {
        self.chain(self.value.log10(), |slope| slope / self.value * R::constant(std::f64::consts::LOG10_E))
    }

    /// Of anything; what is not beyond -1 is taken as 0.
    pub(super) fn ln_1p(self) -> Self {
        let one = R::constant(1.0);
        let inside = R::select(-(self.value + one), R::constant(0.0), self.value);
        self.chain(inside.ln_1p(), |slope| slope / (inside + one))
    }

    pub(super) fn tanh(self) -> Self {
        let value = self.value.tanh();
        self.chain(value, |slope| slope * (R::constant(1.0) - value * value))
    }

    pub(super) fn sin(self) -> Self {
        self.chain(self.value.sin(), |slope| slope * self.value.cos())
    }

    pub(super) fn cos(self) -> Self {
        self.chain(self.value.cos(), |slope| -(slope * self.value.sin()))
    }

    pub(super) fn tan(self) -> Self {
        let value = self.value.tan();
        self.chain(value, |slope| slope * (R::constant(1.0) + value * value))
    }

    /// Within -1 and 1.
    fn as_sine(self) -> R {
        let one = R::constant(1.0);
        self.value.min(one).max(-one)
    }

    /// The other leg of the triangle whose hypotenuse is 1.
    fn other_leg(sine: R) -> R {
        let one = R::constant(1.0);
        ((one - sine) * (one + sine)).max(R::constant(TINY)).sqrt()
    }

    pub(super) fn asin(self) -> Self {
        let sine = self.as_sine();
        self.chain(sine.asin(), |slope| slope / Self::other_leg(sine))
    }

    pub(super) fn acos(self) -> Self {
        let cosine = self.as_sine();
        self.chain(cosine.acos(), |slope| -(slope / Self::other_leg(cosine)))
    }

    pub(super) fn atan(self) -> Self {
        self.chain(self.value.atan(), |slope| slope / (R::constant(1.0) + self.value * self.value))
    }

    pub(super) fn atan2(self, x: Self) -> Self {
        let square = (self.value * self.value + x.value * x.value).max(R::constant(TINY));
        self.merge(x, self.value.atan2(x.value), |slope| slope * x.value / square, |slope| -(slope * self.value / square))
    }

    pub(super) fn hypot(self, other: Self) -> Self {
        let value = self.value.hypot(other.value);
        let divisor = value.max(R::constant(TINY));
        self.merge(other, value, |slope| slope * self.value / divisor, |slope| slope * other.value / divisor)
    }

    /// A whole number by this rule, or the one that is nearest where rounding alone keeps the number from it.
    fn whole(self, by: impl FnOnce(R) -> R) -> Self {
        let near = self.value.round();
        let room = R::constant(NEAR) * self.value.abs().max(R::constant(1.0));
        let value = R::select(room - (self.value - near).abs(), near, by(self.value));
        Self { value, slope: None, ..self }
    }

    pub(super) fn round(self) -> Self {
        Self { value: self.value.round(), slope: None, ..self }
    }

    pub(super) fn floor(self) -> Self {
        self.whole(|value| value.floor())
    }

    pub(super) fn ceil(self) -> Self {
        self.whole(|value| value.ceil())
    }
}
