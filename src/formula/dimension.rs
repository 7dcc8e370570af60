//! What a number measures: powers of mass, length, time, angle and of a study's own units.

use crate::units::Dimension as Of;

/// Most units of its own that a study may have.
pub const MOST_OWN_UNITS: usize = 8;
/// Largest power of a base unit: no quantity of engineering comes near.
const MOST_POWER: i32 = 24;
/// Powers are kept in twelfths, so that square, cube, fourth and sixth roots are exact.
const PARTS: i32 = 12;
/// Mass, length, time and angle, in this order.
const BASES: [&str; 4] = ["kg", "m", "s", "rad"];
const SIZE: usize = BASES.len() + MOST_OWN_UNITS;

/// A dimension: the power of each base unit. An angle is a dimension, and so is each of a study's own units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct QuantityDimension {
    /// In twelfths.
    powers: [i16; SIZE],
}

impl QuantityDimension {
    /// A plain number.
    pub const NONE: Self = Self::of(0, 0, 0, 0);
    /// An angle.
    pub const ANGLE: Self = Self::of(0, 0, 0, 1);

    /// These powers of mass, length, time and angle.
    pub const fn of(mass: i16, length: i16, time: i16, angle: i16) -> Self {
        let mut powers = [0; SIZE];
        let part = PARTS as i16;
        powers[0] = mass * part;
        powers[1] = length * part;
        powers[2] = time * part;
        powers[3] = angle * part;
        Self { powers }
    }

    /// The dimension of a study's own unit of that number.
    pub(super) fn own(number: usize) -> Self {
        let mut powers = [0; SIZE];
        powers[BASES.len() + number] = PARTS as i16;
        Self { powers }
    }

    /// Is it a plain number?
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    fn each(self, other: Self, of: impl Fn(i32, i32) -> Option<i32>) -> Option<Self> {
        let mut powers = [0; SIZE];
        for (power, (a, b)) in powers.iter_mut().zip(self.powers.into_iter().zip(other.powers)) {
            let result = of(a.into(), b.into()).filter(|result| result.abs() <= MOST_POWER * PARTS)?;
            *power = i16::try_from(result).ok()?;
        }
        Some(Self { powers })
    }

    /// Of a product; `None` where a power is beyond 24.
    pub fn times(self, other: Self) -> Option<Self> {
        self.each(other, |a, b| Some(a + b))
    }

    /// Of a quotient; `None` where a power is beyond 24.
    pub fn over(self, other: Self) -> Option<Self> {
        self.each(other, |a, b| Some(a - b))
    }

    /// Of a power; `None` where the result is beyond 24 or no multiple of a twelfth.
    pub fn power(self, exponent: f64) -> Option<Self> {
        self.each(Self::NONE, |a, _| {
            let exact = f64::from(a) * exponent;
            let whole = exact.round();
            // A third has no exact f64.
            let near = (exact - whole).abs() <= 1e-9 && whole.abs() <= f64::from(MOST_POWER * PARTS);
            #[allow(clippy::cast_possible_truncation, reason = "a small whole number")]
            near.then_some(whole as i32)
        })
    }

    /// Its powers of base units, `kg m/s^2`; empty for a plain number.
    pub(super) fn in_base_units(self, own: &[String]) -> String {
        let names = BASES.iter().copied().chain(own.iter().map(String::as_str));
        let (mut above, mut below) = (Vec::new(), Vec::new());
        for (name, power) in names.zip(self.powers) {
            match power {
                0 => {}
                1.. => above.push(powered(name, power.into())),
                _ => below.push(powered(name, -i32::from(power))),
            }
        }
        let over = if above.is_empty() { "1".to_owned() } else { above.join(" ") };
        match below.len() {
            0 if above.is_empty() => String::new(),
            0 => over,
            1 => format!("{over}/{}", below[0]),
            _ => format!("{over}/({})", below.join(" ")),
        }
    }

    /// The dimension in words, for messages.
    pub(super) fn in_words(self, own: &[String]) -> String {
        NAMED
            .iter()
            .find(|(dimension, _)| *dimension == self)
            .map_or_else(|| format!("a quantity in {}", self.in_base_units(own)), |&(_, name)| name.to_owned())
    }
}

/// A base unit to a power in twelfths: `m`, `m^3`, `m^(1/2)`.
fn powered(name: &str, twelfths: i32) -> String {
    let common = (1..=PARTS).rev().find(|part| twelfths % part == 0 && PARTS % part == 0).unwrap_or(1);
    match (twelfths / common, PARTS / common) {
        (1, 1) => name.to_owned(),
        (power, 1) => format!("{name}^{power}"),
        (power, part) => format!("{name}^({power}/{part})"),
    }
}

/// What people call a dimension.
const NAMED: &[(QuantityDimension, &str)] = &[
    (QuantityDimension::NONE, "a plain number"),
    (QuantityDimension::ANGLE, "an angle"),
    (QuantityDimension::of(1, 0, 0, 0), "a mass"),
    (QuantityDimension::of(0, 1, 0, 0), "a length"),
    (QuantityDimension::of(0, 0, 1, 0), "a time"),
    (QuantityDimension::of(0, 2, 0, 0), "an area"),
    (QuantityDimension::of(0, 3, 0, 0), "a volume"),
    (QuantityDimension::of(0, 0, -1, 0), "a frequency"),
    (QuantityDimension::of(0, 0, -1, 1), "a rotational speed"),
    (QuantityDimension::of(0, 1, -1, 0), "a speed"),
    (QuantityDimension::of(0, 1, -2, 0), "an acceleration"),
    (QuantityDimension::of(1, 1, -2, 0), "a force"),
    (QuantityDimension::of(1, -1, -2, 0), "a stress"),
    (QuantityDimension::of(1, 2, -2, 0), "a torque or an energy"),
    (QuantityDimension::of(1, 2, -3, 0), "a power"),
    (QuantityDimension::of(1, -1, 0, 0), "a mass per length"),
    (QuantityDimension::of(1, 0, -2, 0), "a force per length"),
    (QuantityDimension::of(-1, 0, 2, 0), "a deflection per force"),
    (QuantityDimension::of(1, -3, 0, 0), "a density"),
];

impl From<Of> for QuantityDimension {
    fn from(of: Of) -> Self {
        match of {
            // What other formulas give is known by its measure, not by this.
            Of::None | Of::Other => Self::NONE,
            Of::Angle => Self::ANGLE,
            Of::Length => Self::of(0, 1, 0, 0),
            Of::Force => Self::of(1, 1, -2, 0),
            Of::Stress => Self::of(1, -1, -2, 0),
            Of::Torque => Self::of(1, 2, -2, 0),
            Of::Power => Self::of(1, 2, -3, 0),
            Of::RotationalSpeed => Self::of(0, 0, -1, 1),
            Of::Speed => Self::of(0, 1, -1, 0),
            Of::LinearDensity => Self::of(1, -1, 0, 0),
            Of::ForcePerLength => Self::of(1, 0, -2, 0),
            Of::Area => Self::of(0, 2, 0, 0),
            Of::Mass => Self::of(1, 0, 0, 0),
            Of::Compliance => Self::of(-1, 0, 2, 0),
            Of::Density => Self::of(1, -3, 0, 0),
            Of::Volume => Self::of(0, 3, 0, 0),
        }
    }
}
