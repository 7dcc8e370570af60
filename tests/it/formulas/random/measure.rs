//! Units once more: what a name or a number measures, from a table of its own.

use std::f64::consts::PI;

/// Powers of kilogram, metre, second, radian and the two own units.
pub type Powers = [i8; 6];

/// A plain number.
pub const PLAIN: Powers = [0; 6];
/// An angle.
pub const ANGLE: Powers = [0, 0, 0, 1, 0, 0];
/// The units that random studies have of their own.
pub const OWN: [&str; 2] = ["EUR", "part"];

/// What a quantity measures, and the factors to SI: times the first, over the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    pub powers: Powers,
    pub multiply: f64,
    pub divide: f64,
}

impl Measured {
    const PLAIN: Self = Self { powers: PLAIN, multiply: 1.0, divide: 1.0 };

    pub fn to_si(self, value: f64) -> f64 {
        value * self.multiply / self.divide
    }

    pub fn of_si(self, value: f64) -> f64 {
        value * self.divide / self.multiply
    }

    fn inverse(self) -> Self {
        Self { powers: self.powers.map(|it| -it), multiply: self.divide, divide: self.multiply }
    }

    fn raised(self, power: i8) -> Self {
        let base = if power < 0 { self.inverse() } else { self };
        (0..power.abs()).fold(Self::PLAIN, |product, _| product.times(base))
    }

    fn times(self, other: Self) -> Self {
        Self { powers: product(self.powers, other.powers), multiply: self.multiply * other.multiply, divide: self.divide * other.divide }
    }
}

/// What a product measures.
pub fn product(a: Powers, b: Powers) -> Powers {
    std::array::from_fn(|at| a[at] + b[at])
}

/// What a quotient measures.
pub fn quotient(a: Powers, b: Powers) -> Powers {
    std::array::from_fn(|at| a[at] - b[at])
}

/// What a power with the exponent `above / below` measures, if its powers are whole.
pub fn fraction(powers: Powers, above: i8, below: i8) -> Option<Powers> {
    powers.iter().all(|it| (it * above) % below == 0).then(|| powers.map(|it| it * above / below))
}

/// Are the powers such as units and formulas can still be written for?
pub fn is_small(powers: Powers) -> bool {
    powers.iter().all(|it| it.abs() <= 4)
}

/// Symbols, each with mass, length, time and angle and its factors. The first few of a kind are those that names end in.
const SYMBOLS: [(&str, [i8; 4], f64, f64); 42] = [
    ("kg", [1, 0, 0, 0], 1.0, 1.0),
    ("g", [1, 0, 0, 0], 1.0, 1000.0),
    ("mg", [1, 0, 0, 0], 1.0, 1e6),
    ("t", [1, 0, 0, 0], 1000.0, 1.0),
    ("lb", [1, 0, 0, 0], 0.453_592_37, 1.0),
    ("mm", [0, 1, 0, 0], 1.0, 1000.0),
    ("m", [0, 1, 0, 0], 1.0, 1.0),
    ("cm", [0, 1, 0, 0], 1.0, 100.0),
    ("um", [0, 1, 0, 0], 1.0, 1e6),
    ("km", [0, 1, 0, 0], 1000.0, 1.0),
    ("ft", [0, 1, 0, 0], 0.3048, 1.0),
    ("s", [0, 0, 1, 0], 1.0, 1.0),
    ("ms", [0, 0, 1, 0], 1.0, 1000.0),
    ("h", [0, 0, 1, 0], 3600.0, 1.0),
    ("Hz", [0, 0, -1, 0], 1.0, 1.0),
    ("kHz", [0, 0, -1, 0], 1000.0, 1.0),
    ("rad", [0, 0, 0, 1], 1.0, 1.0),
    ("deg", [0, 0, 0, 1], PI, 180.0),
    ("rev", [0, 0, 0, 1], 2.0 * PI, 1.0),
    ("N", [1, 1, -2, 0], 1.0, 1.0),
    ("kN", [1, 1, -2, 0], 1000.0, 1.0),
    ("MN", [1, 1, -2, 0], 1e6, 1.0),
    ("MPa", [1, -1, -2, 0], 1e6, 1.0),
    ("Pa", [1, -1, -2, 0], 1.0, 1.0),
    ("kPa", [1, -1, -2, 0], 1000.0, 1.0),
    ("GPa", [1, -1, -2, 0], 1e9, 1.0),
    ("bar", [1, -1, -2, 0], 1e5, 1.0),
    ("Nm", [1, 2, -2, 0], 1.0, 1.0),
    ("kNm", [1, 2, -2, 0], 1000.0, 1.0),
    ("Nmm", [1, 2, -2, 0], 1.0, 1000.0),
    ("J", [1, 2, -2, 0], 1.0, 1.0),
    ("kJ", [1, 2, -2, 0], 1000.0, 1.0),
    ("MJ", [1, 2, -2, 0], 1e6, 1.0),
    ("Wh", [1, 2, -2, 0], 3600.0, 1.0),
    ("kWh", [1, 2, -2, 0], 3.6e6, 1.0),
    ("kW", [1, 2, -3, 0], 1000.0, 1.0),
    ("W", [1, 2, -3, 0], 1.0, 1.0),
    ("PS", [1, 2, -3, 0], 735.498_75, 1.0),
    ("rpm", [0, 0, -1, 1], PI, 30.0),
    ("kgm2", [1, 2, 0, 0], 1.0, 1.0),
    ("percent", [0, 0, 0, 0], 1.0, 100.0),
    ("min", [0, 0, 1, 0], 60.0, 1.0),
];

fn symbol(text: &str) -> Option<Measured> {
    if let Some(own) = OWN.iter().position(|own| *own == text) {
        let mut powers = PLAIN;
        powers[4 + own] = 1;
        return Some(Measured { powers, ..Measured::PLAIN });
    }
    SYMBOLS.iter().find(|(known, ..)| *known == text).map(|&(_, of, multiply, divide)| Measured {
        powers: [of[0], of[1], of[2], of[3], 0, 0],
        multiply,
        divide,
    })
}

/// What the end of a name says.
pub fn of_name(name: &str) -> Measured {
    let part = |text: &str| {
        let power = text.chars().last().and_then(|last| last.to_digit(10));
        symbol(text)
            .filter(|_| text != "min")
            .or_else(|| symbol(&text[..text.len() - 1]).zip(power).map(|(unit, power)| unit.raised(power as i8)))
    };
    let parts: Vec<&str> = name.split('_').collect();
    match parts[..] {
        [_, .., above, "per", below] if parts.len() > 3 && part(above).is_some() && part(below).is_some() => {
            part(above).expect("it is one").times(part(below).expect("it is one").inverse())
        }
        [_, .., "per", below] => part(below).map_or(Measured::PLAIN, Measured::inverse),
        [_, .., last] if !last.is_empty() => part(last).unwrap_or(Measured::PLAIN),
        _ => Measured::PLAIN,
    }
}

/// Ends of names for what formulas and variables give.
pub const SUFFIXES: [&str; 38] = [
    "",
    "",
    "",
    "",
    "_mm",
    "_cm",
    "_m",
    "_kg",
    "_g",
    "_N",
    "_kN",
    "_Nm",
    "_MPa",
    "_deg",
    "_rad",
    "_EUR",
    "_EUR",
    "_EUR_per_kg",
    "_EUR_per_part",
    "_part",
    "_m_per_s",
    "_s",
    "_h",
    "_kWh",
    "_kJ",
    "_W",
    "_kW",
    "_mm2",
    "_cm3",
    "_percent",
    "_N_per_mm",
    "_kg_per_m3",
    "_rpm",
    "_Hz",
    "_per_s",
    "_EUR_per_h",
    "_J_per_m2",
    "_um_per_N",
];

/// A unit as it stands in brackets.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    pub text: String,
    pub measured: Measured,
}

/// Units in brackets for these powers, drawn by `pick` (a number below its argument); `None` only for a plain number, which needs none.
pub fn bracket(powers: Powers, mut pick: impl FnMut(usize) -> usize) -> Option<Bracket> {
    let single: Vec<&str> =
        SYMBOLS.iter().filter(|&&(text, ..)| symbol(text).is_some_and(|it| it.powers == powers)).map(|(text, ..)| *text).collect();
    if powers == PLAIN {
        let text = if pick(6) == 0 { "percent" } else { return None };
        return Some(Bracket { text: text.to_owned(), measured: symbol(text).expect("it is known") });
    }
    if !single.is_empty() && pick(4) > 0 {
        let text = single[pick(single.len())];
        return Some(Bracket { text: text.to_owned(), measured: symbol(text).expect("it is known") });
    }
    // A force or two in front, the rest in base units.
    let mut left = powers;
    let mut factors: Vec<(&str, i8)> = Vec::new();
    if powers[2] <= -2 && powers[0] >= 1 && pick(2) == 0 {
        left = quotient(left, [1, 1, -2, 0, 0, 0]);
        factors.push((["N", "kN"][pick(2)], 1));
    }
    let bases: [&[&str]; 6] = [&["kg", "g", "t"], &["m", "mm", "cm"], &["s", "h", "min"], &["rad", "deg"], &[OWN[0]], &[OWN[1]]];
    for (names, power) in bases.iter().zip(left) {
        if power != 0 {
            factors.push((names[pick(names.len())], power));
        }
    }
    let measured = factors.iter().fold(Measured::PLAIN, |all, (text, power)| all.times(symbol(text).expect("it is known").raised(*power)));
    let caret = ["^", ""][pick(2)];
    let one =
        |text: &str, power: i8| if power == 1 { text.to_owned() } else { format!("{text}{}{power}", if power < 0 { "^" } else { caret }) };
    let (above, below): (Vec<_>, Vec<_>) = factors.iter().partition(|(_, power)| *power > 0);
    let text = if pick(5) == 0 {
        // Everything in a row, with negative powers.
        factors.iter().map(|(text, power)| one(text, *power)).collect::<Vec<_>>().join(" ")
    } else {
        let between = ["*", " "][pick(2)];
        let row = |of: &[&(&str, i8)], sign: i8| of.iter().map(|(text, power)| one(text, sign * power)).collect::<Vec<_>>().join(between);
        let over = if above.is_empty() { "1".to_owned() } else { row(&above, 1) };
        match below.len() {
            0 => over,
            1 => format!("{over}/{}", row(&below, -1)),
            _ => format!("{over}/({})", row(&below, -1)),
        }
    };
    Some(Bracket { text, measured })
}

#[test]
fn ends_of_names_are_read() {
    let close = |name: &str, powers: Powers, factor: f64| {
        let found = of_name(name);
        assert!(found.powers == powers && (found.to_si(1.0) / factor - 1.0).abs() < 1e-15, "{name}: {found:?}");
    };
    close("tooth_compliance_um_per_N", [-1, 0, 2, 0, 0, 0], 1e-6);
    close("tension_per_width_N_per_mm", [1, 0, -2, 0, 0, 0], 1000.0);
    close("cord_area_mm2", [0, 2, 0, 0, 0, 0], 1e-6);
    close("driver_speed_rpm", [0, 0, -1, 1, 0, 0], 2.0 * PI / 60.0);
    close("price_EUR_per_kg", [-1, 0, 0, 0, 1, 0], 1.0);
    close("flexes_per_s", [0, 0, -1, 0, 0, 0], 1.0);
    close("boundary_tooth", PLAIN, 1.0);
}
