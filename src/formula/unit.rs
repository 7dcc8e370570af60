//! Units in a formula: in brackets behind a number, `7850[kg/m^3]`, and as the end of a name, `belt_mass_kg`.

use super::dimension::{MOST_OWN_UNITS, QuantityDimension};
use crate::likeness::remedy;
use crate::units::{self, Unit};
use std::f64::consts::PI;

/// Largest power of a unit in brackets.
const MOST_POWER: i32 = 12;

/// What a unit measures, and the pair of factors to SI: `si = value * multiply / divide`.
///
/// Two factors rather than one because `/ 1000` rounds correctly where `* 0.001` does not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuantityUnit {
    /// What it measures.
    pub dimension: QuantityDimension,
    multiply: f64,
    divide: f64,
}

impl QuantityUnit {
    /// A plain number.
    pub const NONE: Self = Self::new(QuantityDimension::NONE, 1.0, 1.0);

    const fn new(dimension: QuantityDimension, multiply: f64, divide: f64) -> Self {
        Self { dimension, multiply, divide }
    }

    /// The value in SI units of a value in this unit.
    pub fn to_si(self, value: f64) -> f64 {
        value * self.multiply / self.divide
    }

    /// The value in this unit of a value in SI units.
    pub fn from_si(self, value: f64) -> f64 {
        value * self.divide / self.multiply
    }

    /// The same conversion as two factors: the SI value is the value times the first, divided by the second.
    pub fn factors(self) -> (f64, f64) {
        (self.multiply, self.divide)
    }

    fn times(self, other: Self) -> Option<Self> {
        let dimension = self.dimension.times(other.dimension)?;
        Some(Self::new(dimension, self.multiply * other.multiply, self.divide * other.divide))
    }

    fn inverse(self) -> Option<Self> {
        Some(Self::new(QuantityDimension::NONE.over(self.dimension)?, self.divide, self.multiply))
    }

    fn power(self, power: i32) -> Option<Self> {
        let base = if power < 0 { self.inverse()? } else { self };
        (0..power.abs()).try_fold(Self::NONE, |product, _| product.times(base))
    }
}

impl From<Unit> for QuantityUnit {
    fn from(unit: Unit) -> Self {
        let (multiply, divide) = unit.factors();
        Self::new(unit.dimension.into(), multiply, divide)
    }
}

/// Units that no model needs by themselves, beside those of [`units`].
const MORE: &[(&str, QuantityUnit)] = &[
    ("km", QuantityUnit::new(QuantityDimension::of(0, 1, 0, 0), 1000.0, 1.0)),
    ("s", QuantityUnit::new(QuantityDimension::of(0, 0, 1, 0), 1.0, 1.0)),
    ("ms", QuantityUnit::new(QuantityDimension::of(0, 0, 1, 0), 1.0, 1000.0)),
    ("min", QuantityUnit::new(QuantityDimension::of(0, 0, 1, 0), 60.0, 1.0)),
    ("h", QuantityUnit::new(QuantityDimension::of(0, 0, 1, 0), 3600.0, 1.0)),
    ("Hz", QuantityUnit::new(QuantityDimension::of(0, 0, -1, 0), 1.0, 1.0)),
    ("kHz", QuantityUnit::new(QuantityDimension::of(0, 0, -1, 0), 1000.0, 1.0)),
    ("rev", QuantityUnit::new(QuantityDimension::ANGLE, 2.0 * PI, 1.0)),
    ("mg", QuantityUnit::new(QuantityDimension::of(1, 0, 0, 0), 1.0, 1e6)),
    ("t", QuantityUnit::new(QuantityDimension::of(1, 0, 0, 0), 1000.0, 1.0)),
    ("lb", QuantityUnit::new(QuantityDimension::of(1, 0, 0, 0), 0.453_592_37, 1.0)),
    ("MN", QuantityUnit::new(QuantityDimension::of(1, 1, -2, 0), 1e6, 1.0)),
    ("bar", QuantityUnit::new(QuantityDimension::of(1, -1, -2, 0), 1e5, 1.0)),
    ("kNm", QuantityUnit::new(QuantityDimension::of(1, 2, -2, 0), 1000.0, 1.0)),
    ("J", QuantityUnit::new(QuantityDimension::of(1, 2, -2, 0), 1.0, 1.0)),
    ("kJ", QuantityUnit::new(QuantityDimension::of(1, 2, -2, 0), 1000.0, 1.0)),
    ("MJ", QuantityUnit::new(QuantityDimension::of(1, 2, -2, 0), 1e6, 1.0)),
    ("Wh", QuantityUnit::new(QuantityDimension::of(1, 2, -2, 0), 3600.0, 1.0)),
    ("kWh", QuantityUnit::new(QuantityDimension::of(1, 2, -2, 0), 3.6e6, 1.0)),
    ("MWh", QuantityUnit::new(QuantityDimension::of(1, 2, -2, 0), 3.6e9, 1.0)),
    ("MW", QuantityUnit::new(QuantityDimension::of(1, 2, -3, 0), 1e6, 1.0)),
    ("kgm2", QuantityUnit::new(QuantityDimension::of(1, 2, 0, 0), 1.0, 1.0)),
    ("percent", QuantityUnit::new(QuantityDimension::NONE, 1.0, 100.0)),
];

/// Units whose zero is not zero: no factor converts them.
const WITH_OFFSET: [&str; 6] = ["degC", "°C", "C", "degF", "°F", "F"];

/// Is this a symbol of one unit, rather than an expression of several?
fn is_symbol(text: &str) -> bool {
    !text.is_empty() && text.chars().all(is_of_symbol)
}

fn is_of_symbol(letter: char) -> bool {
    letter.is_alphabetic() || matches!(letter, '%' | '°')
}

/// Every symbol of one unit that comes with the program.
fn symbols() -> impl Iterator<Item = (&'static str, QuantityUnit)> {
    let of_models = units::all().flat_map(|(unit, names)| names.iter().map(move |&name| (name, QuantityUnit::from(unit))));
    of_models.filter(|(name, _)| is_symbol(name)).chain(MORE.iter().copied())
}

/// What is wrong with a unit, and where in its text.
pub(super) struct WrongUnit {
    pub(super) at: usize,
    pub(super) message: String,
}

/// The units of a study: those that come with the program, and its own, each a dimension of its own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Units {
    own: Vec<String>,
}

impl Units {
    /// Units with these besides, such as `EUR`.
    ///
    /// # Errors
    /// A sentence on each that cannot be one, with its position.
    pub fn new(own: &[String]) -> Result<Self, Vec<(usize, String)>> {
        let mut problems = Vec::new();
        for (at, unit) in own.iter().enumerate() {
            let problem = if at >= MOST_OWN_UNITS {
                Some(format!("there may be at most {MOST_OWN_UNITS} own units"))
            } else if unit.is_empty() || unit.len() > 16 || !unit.bytes().all(|byte| byte.is_ascii_alphabetic()) {
                Some(format!("\"{unit}\" cannot be a unit; use up to 16 letters from A to Z, such as \"EUR\""))
            } else if symbols().any(|(known, _)| known == unit) || unit == "per" {
                Some(format!("\"{unit}\" is known already; choose another name"))
            } else if own[..at].contains(unit) {
                Some(format!("\"{unit}\" is given twice; keep one of the two"))
            } else {
                None
            };
            problems.extend(problem.map(|problem| (at, problem)));
        }
        if problems.is_empty() { Ok(Self { own: own.to_vec() }) } else { Err(problems) }
    }

    /// A study's own units.
    pub fn own(&self) -> &[String] {
        &self.own
    }

    /// A dimension in words: `a length`, `a quantity in EUR/kg`.
    pub fn in_words(&self, dimension: QuantityDimension) -> String {
        dimension.in_words(&self.own)
    }

    fn symbol(&self, symbol: &str) -> Option<QuantityUnit> {
        let own = || self.own.iter().position(|own| own == symbol).map(|own| QuantityUnit::new(QuantityDimension::own(own), 1.0, 1.0));
        symbols().find(|(known, _)| *known == symbol).map(|(_, measure)| measure).or_else(own)
    }

    /// The unit that the end of a name gives: millimetres for `belt_length_mm`, euros per kilogram for `price_EUR_per_kg`; a plain
    /// number where it gives none. What stands before `_per_` may be no unit: `flexes_per_s` is a frequency. `_min` is a minimum,
    /// never minutes.
    ///
    /// # Errors
    /// A sentence, if the name ends in `_per_min`.
    pub fn of_name(&self, name: &str) -> Result<QuantityUnit, String> {
        self.named(name).map(|(measure, _)| measure)
    }

    /// The same unit as people print it: `mm`, `EUR/kg`; empty for a plain number.
    ///
    /// # Errors
    /// As [`Units::of_name`].
    pub fn symbol_of_name(&self, name: &str) -> Result<String, String> {
        self.named(name).map(|(_, symbol)| symbol)
    }

    fn named(&self, name: &str) -> Result<(QuantityUnit, String), String> {
        let plain = || Ok((QuantityUnit::NONE, String::new()));
        let parts: Vec<&str> = name.split('_').collect();
        let [before @ .., last] = &parts[..] else { return plain() };
        let is_rate = before.last() == Some(&"per");
        if *last == "min" && is_rate {
            return Err(format!("{name} ends in _per_min, but no name is in minutes, since _min says minimum; use _per_s, or _rpm"));
        }
        let Some(unit) = self.of_part(last).filter(|_| !before.is_empty()) else { return plain() };
        if !is_rate {
            return Ok((unit, (*last).to_owned()));
        }
        let above = before.len().checked_sub(2).filter(|&above| above > 0);
        let above = above.and_then(|above| self.of_part(before[above]).map(|unit| (unit, before[above])));
        let (above, symbol) = above.unwrap_or((QuantityUnit::NONE, "1"));
        match unit.inverse().and_then(|below| above.times(below)) {
            Some(rate) => Ok((rate, format!("{symbol}/{last}"))),
            None => plain(),
        }
    }

    /// One part of a name as a unit, with a power: `mm`, `m2`.
    fn of_part(&self, part: &str) -> Option<QuantityUnit> {
        let whole = (part != "min").then(|| self.symbol(part)).flatten();
        whole.or_else(|| {
            let (symbol, power) = part.split_at(part.len().checked_sub(1).filter(|&at| part.is_char_boundary(at))?);
            let power = power.parse().ok().filter(|power| (2..=4).contains(power))?;
            self.symbol(symbol).filter(|_| symbol != "min")?.power(power)
        })
    }

    /// Reads what stands in brackets: `kg/m^3`, `N m`, `1/s`, `W/(m K)`.
    pub(super) fn read(&self, text: &str) -> Result<QuantityUnit, WrongUnit> {
        UnitReader { units: self, text, at: 0 }.expression()
    }
}

/// Reads a unit in brackets.
struct UnitReader<'t> {
    units: &'t Units,
    text: &'t str,
    at: usize,
}

impl UnitReader<'_> {
    fn peek(&self) -> Option<char> {
        self.text[self.at..].chars().next()
    }

    fn skip(&mut self, skipped: impl Fn(char) -> bool) {
        while let Some(letter) = self.peek().filter(|&letter| skipped(letter)) {
            self.at += letter.len_utf8();
        }
    }

    fn wrong<T>(&self, message: impl Into<String>) -> Result<T, WrongUnit> {
        Err(WrongUnit { at: self.at, message: message.into() })
    }

    fn expression(mut self) -> Result<QuantityUnit, WrongUnit> {
        self.skip(char::is_whitespace);
        if self.peek().is_none() {
            return self.wrong("the brackets are empty; write a unit such as [mm], or leave them out");
        }
        let mut unit = if self.peek() == Some('1') {
            self.at += 1;
            self.skip(char::is_whitespace);
            if !matches!(self.peek(), None | Some('/')) {
                return self.wrong("behind the 1 of a unit stands \"/\"; write [1/s]");
            }
            QuantityUnit::NONE
        } else {
            self.product()?
        };
        if self.peek() == Some('/') {
            let slash = self.at;
            self.at += 1;
            self.skip(char::is_whitespace);
            let below = if self.peek() == Some('(') {
                self.at += 1;
                let below = self.product()?;
                if self.peek() != Some(')') {
                    return self.wrong("a parenthesis of the unit is not closed; add \")\"");
                }
                self.at += 1;
                self.skip(char::is_whitespace);
                below
            } else {
                let below = self.factor()?;
                self.separator();
                if self.peek().is_some_and(is_of_symbol) {
                    return self.wrong("put what the unit is divided by in parentheses: [W/(m K)]");
                }
                below
            };
            let rate = below.inverse().and_then(|below| unit.times(below));
            unit = rate.ok_or_else(|| WrongUnit { at: slash, message: "the powers of this unit are too large".to_owned() })?;
        }
        match self.peek() {
            None => Ok(unit),
            Some('/') => self.wrong("a unit has one \"/\" only; put what it is divided by in parentheses: [W/(m K)]"),
            Some(other) => self.wrong(format!("\"{other}\" has no place in a unit; write for example [N m], [kg/m^3] or [1/s]")),
        }
    }

    fn separator(&mut self) {
        self.skip(|letter| letter.is_whitespace() || matches!(letter, '*' | '·' | '.'));
    }

    fn product(&mut self) -> Result<QuantityUnit, WrongUnit> {
        let mut product = QuantityUnit::NONE;
        loop {
            self.skip(char::is_whitespace);
            let at = self.at;
            let factor = self.factor()?;
            product = product.times(factor).ok_or_else(|| WrongUnit { at, message: "the powers of this unit are too large".to_owned() })?;
            self.separator();
            if !self.peek().is_some_and(is_of_symbol) {
                return Ok(product);
            }
        }
    }

    /// A symbol with its power: `m`, `m2`, `m^3`, `m²`, `s^-1`.
    fn factor(&mut self) -> Result<QuantityUnit, WrongUnit> {
        let start = self.at;
        self.skip(|letter| is_of_symbol(letter) || letter.is_ascii_digit());
        // As in names: kgm2 is one symbol, and m2 is not.
        let whole = self.units.symbol(&self.text[start..self.at]);
        if let Some(measure) = whole.filter(|_| !matches!(self.peek(), Some('^' | '²' | '³'))) {
            return Ok(measure);
        }
        self.at = start;
        self.skip(is_of_symbol);
        let symbol = &self.text[start..self.at];
        if symbol.is_empty() {
            let found = self.peek().map_or("the unit ends here".to_owned(), |letter| format!("\"{letter}\" has no place in a unit"));
            return self.wrong(format!("{found}; write for example [N m], [kg/m^3] or [1/s]"));
        }
        let Some(measure) = self.units.symbol(symbol) else {
            return Err(WrongUnit { at: start, message: self.unknown(symbol) });
        };
        let power_at = self.at;
        let power: i32 = match self.peek() {
            Some('²') => {
                self.at += '²'.len_utf8();
                2
            }
            Some('³') => {
                self.at += '³'.len_utf8();
                3
            }
            Some(letter) if letter == '^' || letter.is_ascii_digit() => {
                self.at += usize::from(letter == '^');
                let digits = self.at;
                self.at += usize::from(self.peek() == Some('-'));
                self.skip(|letter| letter.is_ascii_digit());
                self.text[digits..self.at].parse().unwrap_or(0)
            }
            _ => 1,
        };
        let raised = (power != 0 && power.abs() <= MOST_POWER).then(|| measure.power(power)).flatten();
        raised.ok_or_else(|| WrongUnit {
            at: power_at,
            message: format!(
                "the power of a unit is a whole number from -{MOST_POWER} to {MOST_POWER} other than 0, as in [m^3] or [s^-1]"
            ),
        })
    }

    fn unknown(&self, symbol: &str) -> String {
        if WITH_OFFSET.contains(&symbol) {
            return format!(
                "\"{symbol}\" counts from a zero of its own, which no factor converts; take differences of temperature in a unit of your own, units = [\"K\"]"
            );
        }
        let known: Vec<&str> = symbols().map(|(symbol, _)| symbol).chain(self.units.own.iter().map(String::as_str)).collect();
        let declare = || format!("if it is one of your own, write units = [\"{symbol}\"] at the top of the study");
        format!("unknown unit \"{symbol}\"; {}", remedy(symbol, &known, declare))
    }
}
