//! The prelude's part on runs: lanes that differ in one axis alone, judged together.

use super::*;

impl Prelude<'_> {
    /// From a run's number to its place, and its inputs with the error bound that covers all of its lanes.
    pub(super) fn runs(&mut self) {
        let Some(runs) = self.layout.runs else { return };
        for (name, value) in [
            ("RUN_LENGTH", runs.length),
            ("RUN_STEP", runs.step),
            ("RUNS", runs.of_row),
            ("RUNS_AT_ONCE", runs.at_once),
            ("RUN_ROWS", runs.rows),
            ("OPEN_RUNS", runs.rows * runs.at_once),
            ("RUN_TURNS", runs.turns()),
        ] {
            declare(&mut self.text, name, u32::try_from(value).expect("the layout is cut to 32-bit numbers"));
        }
        self.text.push('\n');
        let fast = &self.layout.fast;
        let axis = runs.dimension;
        let levels = fast[axis].count;
        let pieces = levels.div_ceil(runs.length);
        let mut of_run = vec!["var digits: Digits;".to_owned(), format!("var rest = run / {pieces}u;")];
        for (number, it) in fast.iter().enumerate().rev().filter(|it| it.0 != axis) {
            of_run.push(format!("digits.d{number} = rest % {}u;", it.count));
            of_run.push(format!("rest /= {}u;", it.count));
        }
        of_run.push(format!("digits.d{axis} = run % {pieces}u * RUN_LENGTH;"));
        of_run.push("return digits;".to_owned());
        self.function("digits_of_run(run: u32) -> Digits", &of_run);
        let terms = fast.iter().enumerate().map(|(number, it)| format!("digits.d{number} * {}u", it.lane_stride));
        let sum = terms.collect::<Vec<_>>().join(" + ");
        self.function("lane_of(digits: Digits) -> u32", &[format!("return {sum};")]);
        self.function("levels_of_run(digits: Digits) -> u32", &[format!("return min(RUN_LENGTH, {levels}u - digits.d{axis});")]);
        let lines = ["var there = digits;".to_owned(), format!("there.d{axis} += steps;"), "return there;".to_owned()];
        self.function("along(digits: Digits, steps: u32) -> Digits", &lines);

        let mut set = vec![
            "var at_first = *inputs;".to_owned(),
            "set_lane(&at_first, digits);".to_owned(),
            "set_lane(inputs, along(digits, levels_of_run(digits) - 1u));".to_owned(),
        ];
        for &input in &fast[axis].inputs {
            let name = self.input(input);
            set.push(format!("(*inputs).{name} = between(at_first.{name}, (*inputs).{name});"));
        }
        self.function("set_run(inputs: ptr<function, Inputs>, digits: Digits)", &set);
    }
}
