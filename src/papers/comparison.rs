//! Compares what a paper prints with what is computed, and gives the reason.

use super::{Paper, numbers, words};
use crate::pictures::number::significant;
use crate::table::Table;

/// What the computed side of a comparison rests on, and so what it is worth that it meets the print.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// An equation of the paper with its printed data: it can fail.
    Equation,
    /// A definition, a unit conversion, or a property of the equation's form: both sides are the same, whatever the data.
    Identity,
    /// An input that the paper does not print, found by search so that the print is met.
    Fitted,
    /// One of several readings or choices where the paper leaves something open: meeting the print proves nothing, missing it refutes nothing.
    Reading,
    /// A printed input: nothing is computed.
    Input,
    /// The paper prints nothing to compare with.
    Nothing,
}

impl Basis {
    /// The verdict if the computed value meets the print, or does not.
    pub fn verdict(self, meets: bool) -> Verdict {
        match (self, meets) {
            (Self::Nothing, _) => Verdict::NotPrinted,
            (Self::Reading, true) => Verdict::ReadingMeets,
            (Self::Reading, false) => Verdict::ReadingMisses,
            (_, false) => Verdict::Differs,
            (Self::Equation, true) => Verdict::Agrees,
            (Self::Identity, true) => Verdict::Identity,
            (Self::Fitted, true) => Verdict::Fitted,
            (Self::Input, true) => Verdict::Input,
        }
    }
}

/// The verdict of a comparison. It follows from the two values and the [`Basis`], and is never written by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The paper's equation with its printed data meets the print.
    Agrees,
    /// Does not meet the print.
    Differs,
    /// Both sides are the same by definition: no agreement of physics.
    Identity,
    /// Meets the print because an input that the paper does not print was searched for.
    Fitted,
    /// One of several readings, and it meets the print.
    ReadingMeets,
    /// One of several readings, and it misses the print.
    ReadingMisses,
    /// A printed input, used as printed: nothing was computed.
    Input,
    /// The paper prints nothing to compare with.
    NotPrinted,
}

impl Verdict {
    /// All of them, in the order in which they are explained.
    pub const ALL: [Self; 8] =
        [Self::Agrees, Self::Differs, Self::Identity, Self::Fitted, Self::ReadingMeets, Self::ReadingMisses, Self::Input, Self::NotPrinted];

    /// The verdict in a word or two.
    pub fn word(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Differs => "differs",
            Self::Identity => "identity",
            Self::Fitted => "fitted",
            Self::ReadingMeets => "reading meets",
            Self::ReadingMisses => "reading misses",
            Self::Input => "input",
            Self::NotPrinted => "not printed",
        }
    }

    /// What the word means.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Agrees => {
                "the paper's equation with its printed data gives the print: within half a unit of the last printed digit, inside the printed \
                 range, or as the statement says"
            }
            Self::Differs => "the same does not give the print",
            Self::Identity => {
                "both sides are the same by definition (a unit conversion, a quotient of printed numbers, the form of an equation), so this is \
                 no agreement"
            }
            Self::Fitted => "meets the print because an input that the paper does not print was searched for",
            Self::ReadingMeets => {
                "one of several readings or choices where the paper leaves something open meets the print, which is no proof of it"
            }
            Self::ReadingMisses => "such a reading does not meet the print, which refutes nothing",
            Self::Input => "a printed input, used as printed",
            Self::NotPrinted => "the paper prints nothing to compare with",
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
    /// What the computed side rests on.
    pub basis: Basis,
    /// Does the computed value meet the print?
    pub meets: bool,
    /// The verdict, which follows from the two.
    pub verdict: Verdict,
    /// Why: never empty.
    pub reason: String,
    /// What would turn the verdict, where the two values do not show it; an identity always says it.
    pub fails_if: &'static str,
}

impl Comparison {
    /// The reason, and what would turn the verdict.
    pub fn explanation(&self) -> String {
        if self.fails_if.is_empty() { self.reason.clone() } else { format!("{} Would fail if {}.", self.reason, self.fails_if) }
    }

    /// Calls it an identity, which would not hold if the words were true.
    pub(super) fn identity(&mut self, fails_if: &'static str) {
        self.on(Basis::Identity).fails_if(fails_if);
    }

    /// Calls it one of several readings.
    pub(super) fn reading(&mut self) -> &mut Self {
        self.on(Basis::Reading)
    }

    /// Says what would turn the verdict.
    pub(super) fn fails_if(&mut self, words: &'static str) {
        self.fails_if = words;
    }

    fn on(&mut self, basis: Basis) -> &mut Self {
        self.basis = basis;
        self.verdict = basis.verdict(self.meets);
        self
    }
}

/// Refuses comparisons that give no reason, whose verdict does not follow from their values, and identities that do not say what would
/// turn them.
///
/// # Errors
/// A sentence that names the first of them.
pub fn check(rows: &[Comparison]) -> Result<(), String> {
    for row in rows {
        let flaw = if row.reason.trim().is_empty() {
            "gives no reason".to_owned()
        } else if row.verdict != row.basis.verdict(row.meets) {
            format!("is called \"{}\" but is \"{}\"", row.verdict.word(), row.basis.verdict(row.meets).word())
        } else if row.basis == Basis::Identity && row.fails_if.trim().is_empty() {
            "is an identity and does not say what would make it fail".to_owned()
        } else {
            continue;
        };
        return Err(format!("the comparison \"{}: {}\" {flaw}", row.at, row.what));
    }
    Ok(())
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
    pub fn number(
        &mut self,
        at: &'static str,
        what: &str,
        unit: &'static str,
        printed: &Printed,
        value: f64,
        reason: impl Into<String>,
    ) -> &mut Comparison {
        let (low, high) = printed.range;
        let meets = low <= value && value <= high;
        let difference = match printed.value {
            Some(expected) => percent(value / expected - 1.0),
            None if meets => "inside".to_owned(),
            None if value < low => format!("{} below", significant(low - value, 2)),
            None => format!("{} above", significant(value - high, 2)),
        };
        let (printed, computed) = (printed.text.clone(), digits(value));
        self.push(Comparison {
            unit,
            value: Some(value),
            difference,
            reason: reason.into(),
            ..self.blank(at, what, printed, computed, Basis::Equation, meets)
        })
    }

    /// The same, if an input was searched for to make it agree.
    pub fn fitted(&mut self, at: &'static str, what: &str, unit: &'static str, printed: &Printed, value: f64, reason: impl Into<String>) {
        self.number(at, what, unit, printed, value, reason).on(Basis::Fitted);
    }

    /// A printed input beside the input that was used.
    pub fn input(&mut self, at: &'static str, what: &str, unit: &'static str, printed: &Printed, value: f64, reason: impl Into<String>) {
        self.number(at, what, unit, printed, value, reason).on(Basis::Input);
    }

    /// A statement of the paper beside what was found; `holds` is computed, not judged by hand.
    pub fn statement(
        &mut self,
        at: &'static str,
        what: &str,
        printed: &str,
        computed: String,
        holds: bool,
        reason: impl Into<String>,
    ) -> &mut Comparison {
        let blank = self.blank(at, what, printed.to_owned(), computed, Basis::Equation, holds);
        self.push(Comparison { reason: reason.into(), ..blank })
    }

    /// A number that the paper does not print.
    pub fn unprinted(&mut self, at: &'static str, what: &str, unit: &'static str, value: f64, reason: impl Into<String>) {
        let blank = self.blank(at, what, "-".to_owned(), digits(value), Basis::Nothing, false);
        self.push(Comparison { unit, value: Some(value), reason: reason.into(), ..blank });
    }

    /// Something found that is not a number and that the paper does not print.
    pub fn remark(&mut self, at: &'static str, what: &str, computed: String, reason: impl Into<String>) {
        let blank = self.blank(at, what, "-".to_owned(), computed, Basis::Nothing, false);
        self.push(Comparison { reason: reason.into(), ..blank });
    }

    /// A row without number and reason.
    fn blank(&self, at: &'static str, what: &str, printed: String, computed: String, basis: Basis, meets: bool) -> Comparison {
        Comparison {
            group: self.paper,
            at,
            what: what.to_owned(),
            unit: "",
            printed,
            computed,
            value: None,
            difference: "-".to_owned(),
            basis,
            meets,
            verdict: basis.verdict(meets),
            reason: String::new(),
            fails_if: "",
        }
    }

    fn push(&mut self, row: Comparison) -> &mut Comparison {
        self.rows.push(row);
        self.rows.last_mut().expect("it was pushed")
    }
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
    let reasons: Vec<String> = rows.iter().map(Comparison::explanation).collect();
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
            words("reason", "Why.", reasons.iter().map(String::as_str)),
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
    fn the_verdict_follows_from_the_numbers_and_what_they_rest_on() {
        let verdict = |printed: &Printed, value: f64| {
            let mut rows = Rows::of(Paper::Cvt);
            rows.number("", "", "", printed, value, "because");
            rows.fitted("", "", "", printed, value, "because");
            rows.input("", "", "", printed, value, "because");
            rows.number("", "", "", printed, value, "because").identity("it were not");
            rows.number("", "", "", printed, value, "because").reading();
            rows.done().into_iter().map(|row| (row.verdict, row.difference)).collect::<Vec<_>>()
        };
        let with = |verdicts: [Verdict; 5], difference: &str| verdicts.map(|verdict| (verdict, difference.to_owned())).to_vec();
        let meets = |difference: &str| {
            with([Verdict::Agrees, Verdict::Fitted, Verdict::Input, Verdict::Identity, Verdict::ReadingMeets], difference)
        };
        let misses = |difference: &str| {
            with([Verdict::Differs, Verdict::Differs, Verdict::Differs, Verdict::Differs, Verdict::ReadingMisses], difference)
        };
        assert_eq!(verdict(&Printed::digits("20.5"), 20.541), meets("+0.2 %"));
        assert_eq!(verdict(&Printed::digits("20.5"), 18.503), misses("−9.7 %"));
        assert_eq!(verdict(&Printed::rounded("15 780", 10.0), 15_784.0), meets("+0.025 %"));
        assert_eq!(verdict(&Printed::rounded("15 780", 10.0), 15_786.0), misses("+0.038 %"));
        assert_eq!(verdict(&Printed::between(5.0, 6.0), 5.5), meets("inside"));
        assert_eq!(verdict(&Printed::between(6.0, 7.0), 5.5), misses("0.5 below"));
        assert_eq!(verdict(&Printed::between(3.0, 4.0), 4.25), misses("0.25 above"));
        assert_eq!(verdict(&Printed::digits("2"), 2.0), meets("0 %"));
    }

    #[test]
    fn statements_turn_with_what_was_found() {
        let verdicts = [true, false].map(|holds| {
            let mut rows = Rows::of(Paper::Cvt);
            rows.statement("", "", "constant", String::new(), holds, "because");
            rows.statement("", "", "constant", String::new(), holds, "because").identity("it were not");
            rows.statement("", "", "constant", String::new(), holds, "because").reading().fails_if("it moved");
            rows.done().into_iter().map(|row| row.verdict).collect::<Vec<_>>()
        });
        assert_eq!(verdicts[0], [Verdict::Agrees, Verdict::Identity, Verdict::ReadingMeets]);
        assert_eq!(verdicts[1], [Verdict::Differs, Verdict::Differs, Verdict::ReadingMisses]);
    }

    #[test]
    fn a_verdict_that_the_numbers_do_not_give_is_refused() {
        let mut row = rows("because").remove(0);
        row.basis = Basis::Identity;
        let refused = check(&[row.clone()]).expect_err("an identity is no agreement");
        assert_eq!(refused, "the comparison \"Table 1: a number\" is called \"agrees\" but is \"identity\"");
        row.verdict = Verdict::Identity;
        let refused = check(&[row.clone()]).expect_err("it must say what would make it fail");
        assert_eq!(refused, "the comparison \"Table 1: a number\" is an identity and does not say what would make it fail");
        row.fails_if = "it were not";
        assert_eq!(check(&[row]), Ok(()));
    }
}
