//! The prelude's part on lanes: their place in the row, their inputs, and what they start with.

use super::*;

impl Prelude<'_> {
    /// From a lane's number to its place, inputs and index.
    pub(super) fn lanes(&mut self) {
        let (plan, layout) = (self.plan, self.layout);
        let fast = &layout.fast;
        put!(self, "struct Digits {{");
        fast.iter().enumerate().for_each(|(number, _)| put!(self, "    d{number}: u32,"));
        if fast.is_empty() {
            put!(self, "    none: u32,");
        }
        put!(self, "}}\n");
        let mut of_lane = vec!["var digits: Digits;".to_owned()];
        let mut index = vec!["let digits = digits_of_lane(lane);".to_owned(), "var index = vec2<u32>(0u, 0u);".to_owned()];
        for (number, it) in fast.iter().enumerate() {
            // Beyond the last lane the outermost digit begins again; nothing reads what comes of it.
            of_lane.push(format!("digits.d{number} = lane / {}u % {}u;", it.lane_stride, it.count));
            index.push(format!(
                "index = wide_add(index, wide_mul(digits.d{number}, vec2<u32>({}u, {}u)));",
                it.stride & 0xffff_ffff,
                it.stride >> 32
            ));
        }
        of_lane.push("return digits;".to_owned());
        index.push("return index;".to_owned());
        self.function("digits_of_lane(lane: u32) -> Digits", &of_lane);
        self.function("index_of_lane(lane: u32) -> vec2<u32>", &index);
        let mut advance = Vec::new();
        for (number, it) in fast.iter().enumerate().rev() {
            let step = if number + 1 == fast.len() { "1u".to_owned() } else { format!("select(0u, 1u, carry{})", number + 1) };
            advance.push(format!("(*digits).d{number} += {step};"));
            advance.push(format!("let carry{number} = (*digits).d{number} == {}u;", it.count));
            advance.push(format!("(*digits).d{number} = select((*digits).d{number}, 0u, carry{number});"));
        }
        self.function("advance(digits: ptr<function, Digits>)", &advance);

        let mut set = Vec::new();
        let mut allowed = Vec::new();
        let mut start = vec!["var lane: Lane;".to_owned(), "lane.verdict = state.verdict;".to_owned()];
        for (number, it) in fast.iter().enumerate() {
            match it.values {
                Values::Linear { from, step, bound } => {
                    let value = format!("{} + f32(digits.d{number}) * {}", literal(from), literal(step));
                    set.push(format!("(*inputs).{} = Real({value}, {});", self.input(it.inputs[0]), literal(bound)));
                }
                Values::Table(offset) => {
                    for (column, &input) in it.inputs.iter().enumerate() {
                        let entry = format!("steady[{}u + digits.d{number} * {}u]", offset as usize + column, it.inputs.len());
                        set.push(format!("(*inputs).{} = level({entry});", self.input(input)));
                        if plan.study.constraints.iter().any(|constraint| constraint.quantity == Quantity::Input(input)) {
                            allowed.push(format!("lane.verdict = select(NO, lane.verdict, {entry}.w == 1.0);"));
                        }
                    }
                }
            }
        }
        start.extend(allowed);
        put!(self, "struct Lane {{\n    verdict: u32,");
        (0..plan.tracked.len()).for_each(|at| put!(self, "    t{at}: Real,"));
        put!(self, "}}\n");
        for (at, (tracked, source)) in plan.tracked.iter().enumerate() {
            let value = match *source {
                Source::RowInput(_) | Source::RowOutput(_) => format!("state.t{at}"),
                Source::LaneOutput(_) => least_bad(tracked.worse),
                Source::LaneInput(input) => {
                    let entry = fast.iter().enumerate().find_map(|(number, it)| {
                        let column = it.inputs.iter().position(|&one| one == input)?;
                        let Values::Table(offset) = it.values else { return None };
                        Some(format!("steady[{}u + digits.d{number} * {}u].z", offset as usize + column, it.inputs.len()))
                    });
                    self.own_value(input, &entry.expect("an input that is asked for itself stands in the table"))
                }
            };
            start.push(format!("lane.t{at} = {value};"));
        }
        start.push("return lane;".to_owned());
        self.function("set_lane(inputs: ptr<function, Inputs>, digits: Digits)", &set);
        self.function("start_lane(state: RowState, digits: Digits) -> Lane", &start);
    }
}
