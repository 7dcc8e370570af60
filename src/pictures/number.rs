//! Numbers as text: tick labels, counts and level values.
//!
//! Powers of ten come from Rust's own decimal formatting and parsing, which is exact and the same on every platform; the system's `log10`
//! and `pow` are not.

/// Mantissa (1 <= |m| < 10, or 0) and exponent of a finite number.
pub(super) fn scientific(value: f64) -> (f64, i32) {
    let text = format!("{value:e}");
    text.split_once('e').and_then(|(mantissa, exponent)| Some((mantissa.parse().ok()?, exponent.parse().ok()?))).unwrap_or((0.0, 0))
}

/// The double nearest to ten to the `exponent`.
pub(super) fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().expect("an integer exponent parses")
}

/// `digits * 10^exponent` in plain decimal digits, thousands apart, with a true minus sign.
pub(super) fn decimal(digits: i128, exponent: i32) -> String {
    let sign = if digits < 0 { "−" } else { "" };
    let magnitude = digits.unsigned_abs().to_string();
    if digits == 0 && exponent >= 0 {
        return "0".to_owned();
    }
    if exponent >= 0 {
        let zeros = "0".repeat(exponent as usize);
        return format!("{sign}{}", grouped(&format!("{magnitude}{zeros}")));
    }
    let decimals = exponent.unsigned_abs() as usize;
    let padded = format!("{magnitude:0>width$}", width = decimals + 1);
    let (whole, fraction) = padded.split_at(padded.len() - decimals);
    format!("{sign}{}.{fraction}", grouped(whole))
}

/// A count with its thousands apart: `123 456`.
pub(super) fn count(value: u64) -> String {
    grouped(&value.to_string())
}

/// A value to so many significant digits, trailing zeros dropped; very large and very small ones
/// in powers of ten (`1.2×10⁻¹²`).
pub(crate) fn significant(value: f64, digits: usize) -> String {
    let rounded = format!("{value:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let mantissa = match mantissa.contains('.') {
        true => mantissa.trim_end_matches('0').trim_end_matches('.'),
        false => mantissa,
    };
    if !(-4..7).contains(&exponent) {
        let sign = mantissa.replace('-', "−");
        return format!("{sign}×10{}", superscript(exponent));
    }
    let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len()) as i32;
    let digits: i128 = mantissa.replace('.', "").parse().unwrap_or(0);
    decimal(digits, exponent - decimals)
}

/// Labels for neighbouring values: four significant digits, or as many as make them different.
pub(super) fn levels(values: &[f64]) -> Vec<String> {
    let labels = |digits| -> Vec<String> { values.iter().map(|&v| significant(v, digits)).collect() };
    let apart = |labels: &Vec<String>| labels.windows(2).all(|pair| pair[0] != pair[1]);
    let found = (4..=12).map(labels).find(apart);
    let mut labels = found.unwrap_or_else(|| labels(4));
    // Labels with few decimals are easier to read if all have the same number; with many decimals, as on a logarithmic axis, they are not.
    let decimals = |label: &String| label.split_once('.').map_or(0, |(_, d)| d.len());
    let most = labels.iter().map(decimals).max().unwrap_or(0);
    if (1..=3).contains(&most) && labels.iter().all(|label| !label.contains('×')) {
        for label in &mut labels {
            let missing = most - decimals(label);
            if missing == most {
                label.push('.');
            }
            label.push_str(&"0".repeat(missing));
        }
    }
    labels
}

/// An integer as superscript digits.
pub(super) fn superscript(value: i32) -> String {
    let digit = |c: char| match c.to_digit(10) {
        Some(d) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][d as usize],
        None => '⁻',
    };
    value.to_string().chars().map(digit).collect()
}

fn grouped(digits: &str) -> String {
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_exact_and_grouped() {
        for (digits, exponent, text) in
            [(0, 3, "0"), (0, -1, "0.0"), (12, 2, "1 200"), (5, -2, "0.05"), (-25, -1, "−2.5"), (1234567, -3, "1 234.567")]
        {
            assert_eq!(decimal(digits, exponent), text);
        }
        assert_eq!(count(123456), "123 456");
        assert_eq!(count(1000000), "1 000 000");
        assert_eq!(count(999), "999");
    }

    #[test]
    fn significant_digits_drop_what_says_nothing() {
        for (value, text) in [
            (0.1 + 0.2, "0.3"),
            (18.25, "18.25"),
            (18.0, "18"),
            (-0.5, "−0.5"),
            (0.574349177, "0.5743"),
            (60000.0, "60 000"),
            (1e-12, "1×10⁻¹²"),
            (-2.5e12, "−2.5×10¹²"),
            (0.0, "0"),
        ] {
            assert_eq!(significant(value, 4), text);
        }
    }

    #[test]
    fn levels_stay_apart_and_share_their_decimals() {
        assert_eq!(levels(&[0.1, 0.12, 0.2]), ["0.10", "0.12", "0.20"]);
        assert_eq!(levels(&[18.0, 19.0]), ["18", "19"]);
        assert_eq!(levels(&[0.5, 0.57434917, 2.0]), ["0.5", "0.5743", "2"]);
        assert_eq!(levels(&[100.001, 100.002]), ["100.001", "100.002"]);
        assert_eq!(levels(&[1e-12, 1.5]), ["1×10⁻¹²", "1.5"]);
    }

    #[test]
    fn powers_of_ten_come_apart_and_together() {
        assert_eq!(scientific(1e-12), (1.0, -12));
        assert_eq!(scientific(-2500.0), (-2.5, 3));
        assert_eq!(power_of_ten(-12), 1e-12);
    }
}
