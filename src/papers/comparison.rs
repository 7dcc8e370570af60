//! Compares what a paper prints with what is computed, and gives the reason.

use super::{Paper, numbers, words};
use crate::pictures::number::significant;
use crate::table::Table;

/// The verdict of a comparison. It is computed from the two numbers, never written by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within half a unit of the last printed digit, inside the printed range, or as the statement says.
    Agrees,
    /// Agrees because an input that the paper does not print was chosen to make it agree.
    Fitted,
    /// Does not agree.
    Differs,
    /// A printed input, used as printed: nothing was computed.
    Input,
    /// The paper prints nothing to compare with.
    NotPrinted,
}

impl Verdict {
    /// The verdict in a word or two.
    pub fn word(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Fitted => "fitted",
            Self::Differs => "differs",
            Self::Input => "input",
            Self::NotPrinted => "not printed",
        }
    }
}

/// A printed number, with what it can mean after rounding.
#[derive(Clone, Debug, PartialEq)]
pub struct Printed {
    text: String,
    /// What a difference is measured from.
    value: Option<f64>,
    range: (f64, f64),
}

impl Printed {
    /// A number as printed; it agrees with every number that rounds to it.
    ///
    /// # Panics
    /// If the text is no number.
    pub fn digits(text: &str) -> Self {
        let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let unit: f64 = format!("1e-{decimals}").parse().expect("a power of ten");
        Self::rounded(text, unit)
    }

    /// A number as printed that was rounded to multiples of `unit`.
    ///
    /// # Panics
    /// If the text is no number.
    pub fn rounded(text: &str, unit: f64) -> Self {
        let value: f64 = text.replace(' ', "").parse().expect("a printed number");
        // A value half-way between is rounded either way.
        let half = 0.5 * unit * (1.0 + 1e-9);
        Self { text: text.to_owned(), value: Some(value), range: (value - half, value + half) }
    }

    /// Anything between two printed numbers.
    pub fn between(low: f64, high: f64) -> Self {
        Self { text: format!("{low} to {high}"), value: None, range: (low, high) }
    }
}

/// One row: what a paper prints, what is computed, and why they agree or differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The paper.
    pub group: Paper,
    /// Where it stands in the paper.
    pub at: &'static str,
    /// What is compared.
    pub what: String,
    /// Unit of both; empty for plain numbers and statements.
    pub unit: &'static str,
    /// As the paper prints it; `-` if it does not.
    pub printed: String,
    /// The computed value, in as many digits as a reader wants.
    pub computed: String,
    /// The same in full, if it is a number.
    pub value: Option<f64>,
    /// Computed over printed, in per cent, or distance to the printed range; `-` if there is none.
    pub difference: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Why: never empty.
    pub reason: String,
}

/// Refuses comparisons that give no reason.
///
/// # Errors
/// A sentence that names the first of them.
pub fn check(rows: &[Comparison]) -> Result<(), String> {
    match rows.iter().find(|row| row.reason.trim().is_empty()) {
        Some(row) => Err(format!("the comparison \"{}: {}\" gives no reason", row.at, row.what)),
        None => Ok(()),
    }
}

/// Collects the rows of one paper.
pub(super) struct Rows {
    paper: Paper,
    rows: Vec<Comparison>,
}

impl Rows {
    pub fn of(paper: Paper) -> Self {
        Self { paper, rows: Vec::new() }
    }

    pub fn done(self) -> Vec<Comparison> {
        self.rows
    }

    /// A number beside a printed number or range.
    pub fn number(&mut self, at: &'static str, what: &str, unit: &'static str, printed: &Printed, value: f64, reason: impl Into<String>) {
        let (low, high) = printed.range;
        let inside = low <= value && value <= high;
        let difference = match printed.value {
            Some(expected) => percent(value / expected - 1.0),
            None if inside => "inside".to_owned(),
            None if value < low => format!("{} below", significant(low - value, 2)),
            None => format!("{} above", significant(value - high, 2)),
        };
        let verdict = if inside { Verdict::Agrees } else { Verdict::Differs };
        let computed = digits(value);
        self.push(
            ComparisonRow { at, what, unit, printed: &printed.text, computed, value: Some(value), difference, verdict },
            reason.into(),
        );
    }

    /// The same, if an input was chosen to make it agree.
    pub fn fitted(&mut self, at: &'static str, what: &str, unit: &'static str, printed: &Printed, value: f64, reason: impl Into<String>) {
        self.number(at, what, unit, printed, value, reason);
        self.soften(Verdict::Fitted);
    }

    /// A printed input beside the input that was used.
    pub fn input(&mut self, at: &'static str, what: &str, unit: &'static str, printed: &Printed, value: f64, reason: impl Into<String>) {
        self.number(at, what, unit, printed, value, reason);
        self.soften(Verdict::Input);
    }

    /// Changes the word for agreement of the last row.
    fn soften(&mut self, verdict: Verdict) {
        if let Some(row) = self.rows.last_mut().filter(|row| row.verdict == Verdict::Agrees) {
            row.verdict = verdict;
        }
    }

    /// A statement of the paper beside what was found; `holds` is computed, not judged by hand.
    pub fn statement(&mut self, at: &'static str, what: &str, printed: &str, computed: String, holds: bool, reason: impl Into<String>) {
        let verdict = if holds { Verdict::Agrees } else { Verdict::Differs };
        self.push(ComparisonRow { at, what, unit: "", printed, computed, value: None, difference: "-".to_owned(), verdict }, reason.into());
    }

    /// A number that the paper does not print.
    pub fn unprinted(&mut self, at: &'static str, what: &str, unit: &'static str, value: f64, reason: impl Into<String>) {
        let (computed, difference) = (digits(value), "-".to_owned());
        let row = ComparisonRow { at, what, unit, printed: "-", computed, value: Some(value), difference, verdict: Verdict::NotPrinted };
        self.push(row, reason.into());
    }

    /// Something found that is not a number and that the paper does not print.
    pub fn remark(&mut self, at: &'static str, what: &str, computed: String, reason: impl Into<String>) {
        let row = ComparisonRow {
            at,
            what,
            unit: "",
            printed: "-",
            computed,
            value: None,
            difference: "-".to_owned(),
            verdict: Verdict::NotPrinted,
        };
        self.push(row, reason.into());
    }

    fn push(&mut self, row: ComparisonRow<'_>, reason: String) {
        let ComparisonRow { at, what, unit, printed, computed, value, difference, verdict } = row;
        let (what, printed) = (what.to_owned(), printed.to_owned());
        self.rows.push(Comparison { group: self.paper, at, what, unit, printed, computed, value, difference, verdict, reason });
    }
}

/// A row before its reason.
struct ComparisonRow<'a> {
    at: &'static str,
    what: &'a str,
    unit: &'static str,
    printed: &'a str,
    computed: String,
    value: Option<f64>,
    difference: String,
    verdict: Verdict,
}

/// A number for people: up to five digits, grouped from 10 000 on, as the papers print them.
pub(super) fn digits(value: f64) -> String {
    let text = significant(value, 5);
    if value.abs() < 10_000.0 { text.replace(|c: char| c.is_whitespace(), "") } else { text }
}

/// A share in per cent, with its sign.
pub(super) fn percent(share: f64) -> String {
    percent_to(share, 2)
}

/// The same with so many significant digits.
pub(super) fn percent_to(share: f64, count: usize) -> String {
    // A remainder of rounding is no difference.
    if share.abs() < 1e-10 {
        return "0 %".to_owned();
    }
    let sign = if share > 0.0 { "+" } else { "" };
    format!("{sign}{} %", significant(100.0 * share, count))
}

/// All rows as a table, with numbers in full.
pub(super) fn table(rows: &[Comparison]) -> Table {
    let text = |name: &str, description: &str, of: fn(&Comparison) -> &str| words(name, description, rows.iter().map(of));
    Table {
        columns: vec![
            text("paper", "The paper.", |row| row.group.key()),
            text("at", "Where in the paper.", |row| row.at),
            text("what", "What is compared.", |row| &row.what),
            text("unit", "Unit of both values.", |row| row.unit),
            text("printed", "As the paper prints it.", |row| &row.printed),
            text("computed", "What comes out, rounded.", |row| &row.computed),
            numbers("computed_in_full", "", "What comes out.", rows.iter().map(|row| row.value)),
            text("difference", "Computed over printed, or distance to the printed range.", |row| &row.difference),
            text("verdict", "How it came out.", |row| row.verdict.word()),
            text("reason", "Why.", |row| &row.reason),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(reason: &str) -> Vec<Comparison> {
        let mut rows = Rows::of(Paper::Cvt);
        rows.number("Table 1", "a number", "N", &Printed::digits("20.5"), 20.46, "a reason");
        rows.unprinted("Table 1", "another", "N", 3.0, reason);
        rows.done()
    }

    #[test]
    fn a_row_without_a_reason_is_refused() {
        assert_eq!(check(&rows("because")), Ok(()));
        for reason in ["", " ", "\n\t"] {
            assert_eq!(check(&rows(reason)), Err("the comparison \"Table 1: another\" gives no reason".to_owned()));
        }
    }

    #[test]
    fn the_verdict_follows_from_the_numbers() {
        let verdict = |printed: &Printed, value: f64| {
            let mut rows = Rows::of(Paper::Cvt);
            rows.number("", "", "", printed, value, "because");
            rows.fitted("", "", "", printed, value, "because");
            rows.done().into_iter().map(|row| (row.verdict, row.difference)).collect::<Vec<_>>()
        };
        let agrees = |difference: &str| vec![(Verdict::Agrees, difference.to_owned()), (Verdict::Fitted, difference.to_owned())];
        let differs = |difference: &str| vec![(Verdict::Differs, difference.to_owned()); 2];
        assert_eq!(verdict(&Printed::digits("20.5"), 20.541), agrees("+0.2 %"));
        assert_eq!(verdict(&Printed::digits("20.5"), 18.503), differs("−9.7 %"));
        assert_eq!(verdict(&Printed::rounded("15 780", 10.0), 15_784.0), agrees("+0.025 %"));
        assert_eq!(verdict(&Printed::rounded("15 780", 10.0), 15_786.0), differs("+0.038 %"));
        assert_eq!(verdict(&Printed::between(5.0, 6.0), 5.5), agrees("inside"));
        assert_eq!(verdict(&Printed::between(6.0, 7.0), 5.5), differs("0.5 below"));
        assert_eq!(verdict(&Printed::between(3.0, 4.0), 4.25), differs("0.25 above"));
        assert_eq!(verdict(&Printed::digits("2"), 2.0), agrees("0 %"));
    }
}
