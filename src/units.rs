//! Units: the suffix in a name, the word in a study file, and the one place where numbers are converted to SI.
//!
//! Outside, every quantity carries its unit in its name (`centre_distance_mm`); inside, formulas work in SI units.

use std::f64::consts::PI;

/// What a unit measures. Values can be converted only between units of the same dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Dimension {
    None,
    Angle,
    Length,
    Force,
    Stress,
    Torque,
    Power,
    RotationalSpeed,
    Speed,
    LinearDensity,
    ForcePerLength,
    Area,
    Mass,
    Compliance,
    Density,
    Volume,
    /// What only formulas of a study measure.
    Other,
}

impl Dimension {
    /// The dimension in words, for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "a plain number",
            Self::Angle => "an angle",
            Self::Length => "a length",
            Self::Force => "a force",
            Self::Stress => "a stress",
            Self::Torque => "a torque",
            Self::Power => "a power",
            Self::RotationalSpeed => "a rotational speed",
            Self::Speed => "a speed",
            Self::LinearDensity => "a mass per length",
            Self::ForcePerLength => "a force per length",
            Self::Area => "an area",
            Self::Mass => "a mass",
            Self::Compliance => "a deflection per force",
            Self::Density => "a density",
            Self::Volume => "a volume",
            Self::Other => "a quantity of its own",
        }
    }
}

/// A unit: a symbol and an exact pair of factors to SI, `si = value * multiply / divide`.
///
/// Two factors rather than one because `/ 1000` rounds correctly where `* 0.001` does not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// As printed and as written in a study file, such as `N/mm`.
    pub symbol: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    multiply: f64,
    divide: f64,
}

impl Unit {
    const fn new(symbol: &'static str, dimension: Dimension, multiply: f64, divide: f64) -> Self {
        Self { symbol, dimension, multiply, divide }
    }

    /// The unit of a quantity that formulas give: one of the units below if there is such, else one of its own with these factors.
    pub(crate) fn of_formulas(symbol: &'static str, (multiply, divide): (f64, f64)) -> Self {
        let known = UNITS.iter().map(|(unit, _)| *unit).find(|unit| unit.symbol == symbol && unit.factors() == (multiply, divide));
        known.unwrap_or(Self::new(symbol, Dimension::Other, multiply, divide))
    }

    /// The value in SI units of a value in this unit.
    #[inline(always)]
    pub fn to_si(self, value: f64) -> f64 {
        value * self.multiply / self.divide
    }

    /// The value in this unit of a value in SI units.
    #[inline(always)]
    pub fn from_si(self, value: f64) -> f64 {
        value * self.divide / self.multiply
    }

    /// The same conversion as two factors, for any number type: the SI value is the value times the first, divided by the second.
    pub fn factors(self) -> (f64, f64) {
        (self.multiply, self.divide)
    }

    /// Is a value in this unit the SI value itself?
    pub fn is_si(self) -> bool {
        self.multiply == 1.0 && self.divide == 1.0
    }

    /// The unit as a suffix of a name: `N_per_mm` for `N/mm`; empty for plain numbers.
    pub fn suffix(self) -> String {
        self.symbol.replace('/', "_per_").replace('²', "2").replace('³', "3")
    }
}

macro_rules! units {
    ($($(#[$doc:meta])* $constant:ident = $symbol:literal $(| $alias:literal)*, $dimension:ident, $multiply:expr, $divide:expr;)*) => {
        $($(#[$doc])* pub const $constant: Unit = Unit::new($symbol, Dimension::$dimension, $multiply, $divide);)*
        /// Every unit with the ways to write it.
        const UNITS: &[(Unit, &[&str])] = &[$(($constant, &[$symbol $(, $alias)*])),*];
    };
}

const POUND_FORCE: f64 = 4.448_221_615_260_5;
const INCH: f64 = 0.0254;

units! {
    /// A plain number.
    NONE = "" | "1", None, 1.0, 1.0;
    /// Per cent of one.
    PERCENT = "%", None, 1.0, 100.0;
    /// Degree.
    DEGREE = "deg" | "°", Angle, PI, 180.0;
    /// Radian.
    RADIAN = "rad", Angle, 1.0, 1.0;
    /// Millimetre.
    MILLIMETRE = "mm", Length, 1.0, 1000.0;
    /// Micrometre.
    MICROMETRE = "um" | "µm", Length, 1.0, 1e6;
    /// Centimetre.
    CENTIMETRE = "cm", Length, 1.0, 100.0;
    /// Metre.
    METRE = "m", Length, 1.0, 1.0;
    /// International inch.
    INCH_UNIT = "in" | "inch", Length, INCH, 1.0;
    /// International foot.
    FOOT = "ft", Length, 0.3048, 1.0;
    /// Newton.
    NEWTON = "N", Force, 1.0, 1.0;
    /// Kilonewton.
    KILONEWTON = "kN", Force, 1000.0, 1.0;
    /// Kilogram-force.
    KILOGRAM_FORCE = "kgf", Force, 9.806_65, 1.0;
    /// Pound-force.
    POUND = "lbf", Force, POUND_FORCE, 1.0;
    /// Megapascal, a newton per square millimetre.
    MEGAPASCAL = "MPa" | "N/mm2" | "N/mm²", Stress, 1e6, 1.0;
    /// Pascal.
    PASCAL = "Pa", Stress, 1.0, 1.0;
    /// Kilopascal.
    KILOPASCAL = "kPa", Stress, 1000.0, 1.0;
    /// Gigapascal.
    GIGAPASCAL = "GPa", Stress, 1e9, 1.0;
    /// Pound-force per square inch.
    PSI = "psi", Stress, POUND_FORCE, INCH * INCH;
    /// Thousand pounds-force per square inch.
    KSI = "ksi", Stress, POUND_FORCE * 1000.0, INCH * INCH;
    /// Newton metre.
    NEWTON_METRE = "Nm" | "N m" | "N*m" | "N.m", Torque, 1.0, 1.0;
    /// Newton millimetre.
    NEWTON_MILLIMETRE = "Nmm" | "N mm" | "N*mm", Torque, 1.0, 1000.0;
    /// Pound-force foot.
    POUND_FOOT = "lbf ft" | "ft lbf" | "lbf*ft", Torque, POUND_FORCE * 0.3048, 1.0;
    /// Pound-force inch.
    POUND_INCH = "lbf in" | "in lbf" | "lbf*in", Torque, POUND_FORCE * INCH, 1.0;
    /// Kilowatt.
    KILOWATT = "kW", Power, 1000.0, 1.0;
    /// Watt.
    WATT = "W", Power, 1.0, 1.0;
    /// Mechanical horsepower (550 ft lbf/s).
    HORSEPOWER = "hp", Power, 550.0 * 0.3048 * POUND_FORCE, 1.0;
    /// Metric horsepower (75 kgf m/s).
    METRIC_HORSEPOWER = "PS", Power, 735.498_75, 1.0;
    /// Revolution per minute.
    RPM = "rpm" | "rev/min" | "1/min", RotationalSpeed, PI, 30.0;
    /// Radian per second.
    RADIAN_PER_SECOND = "rad/s", RotationalSpeed, 1.0, 1.0;
    /// Revolution per second.
    REVOLUTION_PER_SECOND = "rev/s" | "1/s", RotationalSpeed, 2.0 * PI, 1.0;
    /// Metre per second.
    METRE_PER_SECOND = "m/s", Speed, 1.0, 1.0;
    /// Kilogram per metre.
    KILOGRAM_PER_METRE = "kg/m", LinearDensity, 1.0, 1.0;
    /// Gram per metre.
    GRAM_PER_METRE = "g/m", LinearDensity, 1.0, 1000.0;
    /// Pound (mass) per foot.
    POUND_PER_FOOT = "lb/ft", LinearDensity, 0.453_592_37, 0.3048;
    /// Newton per millimetre.
    NEWTON_PER_MILLIMETRE = "N/mm", ForcePerLength, 1000.0, 1.0;
    /// Newton per metre.
    NEWTON_PER_METRE = "N/m", ForcePerLength, 1.0, 1.0;
    /// Square millimetre.
    SQUARE_MILLIMETRE = "mm2" | "mm²", Area, 1.0, 1e6;
    /// Square inch.
    SQUARE_INCH = "in2" | "in²", Area, INCH * INCH, 1.0;
    /// Gram.
    GRAM = "g", Mass, 1.0, 1000.0;
    /// Kilogram.
    KILOGRAM = "kg", Mass, 1.0, 1.0;
    /// Ounce (mass).
    OUNCE = "oz", Mass, 0.453_592_37, 16.0;
    /// Micrometre per newton.
    MICROMETRE_PER_NEWTON = "um/N" | "µm/N", Compliance, 1.0, 1e6;
    /// Millimetre per kilogram-force.
    MILLIMETRE_PER_KILOGRAM_FORCE = "mm/kgf", Compliance, 1.0, 9806.65;
    /// Metre per newton.
    METRE_PER_NEWTON = "m/N", Compliance, 1.0, 1.0;
    /// Kilogram per cubic metre.
    KILOGRAM_PER_CUBIC_METRE = "kg/m3" | "kg/m³", Density, 1.0, 1.0;
    /// Gram per cubic centimetre.
    GRAM_PER_CUBIC_CENTIMETRE = "g/cm3" | "g/cm³", Density, 1000.0, 1.0;
    /// Cubic millimetre.
    CUBIC_MILLIMETRE = "mm3" | "mm³", Volume, 1.0, 1e9;
    /// Cubic centimetre.
    CUBIC_CENTIMETRE = "cm3" | "cm³", Volume, 1.0, 1e6;
    /// Cubic metre.
    CUBIC_METRE = "m3" | "m³", Volume, 1.0, 1.0;
    /// Pound-force per inch.
    POUND_PER_INCH = "lbf/in", ForcePerLength, POUND_FORCE, INCH;
}

/// Every unit with the ways to write it.
pub(crate) fn all() -> impl Iterator<Item = (Unit, &'static [&'static str])> {
    UNITS.iter().copied()
}

/// Why a text is not a value in the wanted unit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnitError {
    /// The text does not start with a number.
    #[error("\"{text}\" is not a number with a unit; write for example {example}")]
    NoNumber {
        /// What was given.
        text: String,
        /// What could have been given.
        example: String,
    },
    /// The unit is not known.
    #[error("unknown unit \"{unit}\"; {what} may be given in {known}")]
    UnknownUnit {
        /// The unit given.
        unit: String,
        /// The wanted dimension in words.
        what: &'static str,
        /// Units of that dimension.
        known: String,
    },
    /// The unit measures something else.
    #[error("\"{unit}\" measures {got}, but {what} is wanted; use {known}")]
    WrongDimension {
        /// The unit given.
        unit: String,
        /// What it measures.
        got: &'static str,
        /// The wanted dimension in words.
        what: &'static str,
        /// Units of that dimension.
        known: String,
    },
}

/// Every unit by what it measures, each with the ways to write it, the first of which names use.
pub(crate) fn by_dimension() -> Vec<(&'static str, Vec<&'static [&'static str]>)> {
    let mut found: Vec<(&'static str, Vec<&'static [&'static str]>)> = Vec::new();
    for (unit, names) in UNITS {
        let names: &[&str] = if names[0].is_empty() { &names[1..] } else { names };
        match found.iter_mut().find(|(what, _)| *what == unit.dimension.name()) {
            Some((_, units)) => units.push(names),
            None => found.push((unit.dimension.name(), vec![names])),
        }
    }
    found
}

/// Reads a text such as `"0.25 in"`, `"12 lbf"` or `"200 rad/s"` and returns its value in `wanted`.
///
/// A number without a unit is taken to be in `wanted` already.
///
/// # Errors
/// [`UnitError`] if the text is no number, or its unit is unknown or measures something else.
pub fn parse_value(text: &str, wanted: Unit) -> Result<f64, UnitError> {
    let text = text.trim();
    let no_number = || UnitError::NoNumber { text: text.to_owned(), example: format!("\"12 {}\"", wanted.symbol).replace(" \"", "\"") };
    // The longest prefix that is a number: "12e3 N" has an exponent, "12 e" has a unit.
    let end = (1..=text.len())
        .rev()
        .filter(|&end| text.is_char_boundary(end))
        .find(|&end| text[..end].trim_end().parse::<f64>().is_ok())
        .ok_or_else(no_number)?;
    let value: f64 = text[..end].trim_end().parse().map_err(|_| no_number())?;
    if !value.is_finite() {
        return Err(no_number());
    }
    let name = text[end..].trim();
    if name.is_empty() {
        return Ok(value);
    }
    // A decimal comma, or thousands.
    if name.starts_with([',', '.']) {
        let written = if text.contains(',') && text.contains('.') { text.replace(',', "") } else { text.replace(',', ".") };
        return Err(UnitError::NoNumber { text: text.to_owned(), example: format!("\"{written}\"") });
    }
    let known = || {
        let of_dimension = UNITS.iter().filter(|(unit, _)| unit.dimension == wanted.dimension && !unit.symbol.is_empty());
        let symbols: Vec<_> = of_dimension.map(|(unit, _)| unit.symbol).collect();
        if symbols.is_empty() { "no unit".to_owned() } else { symbols.join(", ") }
    };
    let what = wanted.dimension.name();
    let Some((unit, _)) = UNITS.iter().find(|(_, names)| names.contains(&name)) else {
        return Err(UnitError::UnknownUnit { unit: name.to_owned(), what, known: known() });
    };
    if unit.dimension != wanted.dimension {
        let got = unit.dimension.name();
        return Err(UnitError::WrongDimension { unit: name.to_owned(), got, what, known: known() });
    }
    Ok(if *unit == wanted { value } else { wanted.from_si(unit.to_si(value)) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_convert_within_a_dimension() {
        assert_eq!(parse_value("0.25 in", MILLIMETRE), Ok(6.35));
        assert_eq!(parse_value("12", NEWTON), Ok(12.0));
        assert_eq!(parse_value(" 1e3 N ", NEWTON), Ok(1000.0));
        assert!((parse_value("12 lbf", NEWTON).unwrap() - 53.378_659_383_126).abs() < 1e-9);
        assert!((parse_value("200 rad/s", RPM).unwrap() - 1_909.859_317_102_744).abs() < 1e-9);
        assert!((parse_value("100ksi", MEGAPASCAL).unwrap() - 689.475_729_316_836).abs() < 1e-9);
        assert!((parse_value("1 hp", KILOWATT).unwrap() - 0.745_699_871_582_270).abs() < 1e-12);
        assert_eq!(parse_value("8 %", NONE), Ok(0.08));
        assert_eq!(parse_value("7.85 g/cm³", KILOGRAM_PER_CUBIC_METRE), Ok(7850.0));
        assert_eq!(parse_value("12.5 cm3", CUBIC_MILLIMETRE), Ok(12_500.0));
        assert_eq!(parse_value("2e-6 m³", CUBIC_CENTIMETRE), Ok(2.0));
        assert_eq!((KILOGRAM_PER_CUBIC_METRE.suffix().as_str(), CUBIC_MILLIMETRE.suffix().as_str()), ("kg_per_m3", "mm3"));
    }

    #[test]
    fn what_is_wrong_is_named() {
        assert!(matches!(parse_value("12 lbf", MILLIMETRE), Err(UnitError::WrongDimension { got: "a force", .. })));
        assert!(matches!(parse_value("12 furlong", MILLIMETRE), Err(UnitError::UnknownUnit { .. })));
        for text in ["", "mm", "inf mm", "NaN", "é"] {
            assert!(matches!(parse_value(text, MILLIMETRE), Err(UnitError::NoNumber { .. })), "{text}");
        }
    }

    #[test]
    fn every_way_to_write_a_unit_is_unique_and_ends_exact() {
        let mut names: Vec<_> = UNITS.iter().flat_map(|(_, names)| names.iter()).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
        for (unit, _) in UNITS {
            let there_and_back = unit.from_si(unit.to_si(3.7));
            assert!((there_and_back - 3.7).abs() <= 1e-15 * 3.7, "{}", unit.symbol);
        }
    }
}
