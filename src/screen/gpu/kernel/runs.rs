//! The prelude's part on runs: lanes with results that are near each other, judged together.

use super::*;
use crate::screen::gpu::cut::{Runs, RunsAlong};

impl Prelude<'_> {
    /// Where the second stage finds the lanes of a block, if it has no runs.
    pub(super) fn runs(&mut self) {
        let Some(runs) = self.layout.runs else {
            self.function("lane_at(state: RowState, first: u32, i: u32) -> u32", &["return first + i;".to_owned()]);
            return;
        };
        for (name, value) in [
            ("RUN_LENGTH", runs.length),
            ("PART", runs.part),
            ("PARTS", runs.parts()),
            ("RUNS", runs.of_row),
            ("RUNS_EACH", runs.each),
            ("RUN_CHUNKS", runs.chunks()),
            ("OPEN_LIST", runs.each.max(runs.parts()) * u64::from(WORKGROUP)),
        ] {
            declare(&mut self.text, name, u32::try_from(value).expect("the layout is cut to 32-bit numbers"));
        }
        match runs.along {
            RunsAlong::Axis { dimension, step } => self.runs_along_axis(runs, dimension, step),
            RunsAlong::Order => self.runs_in_order(),
        }
    }

    /// From a run's number to its place, and the inputs of a stretch of it with the error bound that covers all of its lanes.
    fn runs_along_axis(&mut self, runs: Runs, axis: usize, step: u64) {
        declare(&mut self.text, "RUN_STEP", u32::try_from(step).expect("the layout is cut to 32-bit numbers"));
        self.text.push('\n');
        let fast = &self.layout.fast;
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

        let mut set =
            vec!["var at_first = *inputs;".to_owned(), "set_lane(&at_first, first);".to_owned(), "set_lane(inputs, last);".to_owned()];
        for &input in &fast[axis].inputs {
            let name = self.input(input);
            set.push(format!("(*inputs).{name} = between(at_first.{name}, (*inputs).{name});"));
        }
        self.function("set_stretch(inputs: ptr<function, Inputs>, first: Digits, last: Digits)", &set);
    }

    /// Which scenarios decide about the designs of each row.
    pub(super) fn scenarios(&mut self) {
        if self.layout.tells_scenarios {
            put!(
                self,
                "// Where the scenarios that decide about the designs of a row begin, row by row, and where the last ones end; then these."
            );
            put!(self, "@group(0) @binding(11) var<storage, read> decisive: array<u32>;\n");
        }
    }

    /// The number of a lane by its place in the order, and which lane it is.
    fn runs_in_order(&mut self) {
        declare(&mut self.text, "WIDTH", u32::try_from(self.plan.fast.count()).expect("the layout is cut to 32-bit numbers"));
        self.text.push('\n');
        put!(self, "// Of each lane in order: its number, and which one it is.");
        put!(self, "@group(0) @binding(10) var<storage, read> sorted_lanes: array<vec2<u32>>;\n");
        let at = "sorted_lanes[state.column + place]";
        self.function("sorted_lane(state: RowState, place: u32) -> u32", &[format!("return {at}.y;")]);
        self.function("sorted_number(state: RowState, place: u32) -> Real", &[format!("return near(bitcast<f32>({at}.x));")]);
    }

    /// The field of the number that lanes are sorted by.
    pub(super) fn sorted_by(&self) -> Option<&'static str> {
        match (&self.layout.formula, &self.layout.sorted) {
            (FormulaOnDevice::Own(own), Some(_)) => own.onwards.as_ref().map(|it| it.field),
            _ => None,
        }
    }

    /// What a stretch of sorted lanes is judged from: the number that they differ by, with a bound that covers all of theirs.
    pub(super) fn sorted(&mut self) {
        let Some(field) = self.sorted_by() else { return };
        let lines = [
            "var there = prepared;".to_owned(),
            format!("there.{field} = stretch(sorted_number(state, first), sorted_number(state, last));"),
            "return there;".to_owned(),
        ];
        self.function("numbers_between(prepared: Prepared, state: RowState, first: u32, last: u32) -> Prepared", &lines);
    }
}
