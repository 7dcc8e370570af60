//! Numbers as decimal text.

/// The shortest decimal text that reads back as the same f64; plain where that is short, with an exponent beyond; no "-0".
pub fn plain(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-5..1e16).contains(&magnitude) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// A number with at most six significant digits.
pub fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    plain(rounded)
}

/// A number as sentences and pages tell it: four significant digits, and from a thousand on a whole number.
pub fn brief(value: f64) -> String {
    let magnitude = value.abs();
    let rounded = if (1e3..1e9).contains(&magnitude) { value.round() } else { format!("{value:.3e}").parse().unwrap_or(value) };
    plain(rounded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back() {
        let cases =
            [(0.0, "0"), (-0.0, "0"), (30.0, "30"), (0.1, "0.1"), (1e300, "1e300"), (-2.5e-7, "-2.5e-7"), (1e15, "1000000000000000")];
        for (value, text) in cases {
            assert_eq!(plain(value), text);
            assert_eq!(text.parse::<f64>().unwrap(), value);
        }
    }

    #[test]
    fn sentences_have_four_digits() {
        let cases =
            [(0.0, "0"), (-0.41746, "-0.4175"), (12.3456, "12.35"), (999.96, "1000"), (58_137.64, "58138"), (-1.23456e-7, "-1.235e-7")];
        for (value, text) in cases {
            assert_eq!(brief(value), text);
        }
    }
}
