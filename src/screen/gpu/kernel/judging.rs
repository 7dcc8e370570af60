//! The prelude's part on judging: conditions, constraints and worst values, of rows, single lanes and groups of lanes.

use super::*;

/// A function that judges lanes over all scenarios.
#[derive(Clone, Copy)]
struct JudgingText<'a> {
    name: &'a str,
    /// Where: its last parameters.
    at: &'a str,
    /// A line that makes the first lane's digits of it.
    begin: &'a str,
    members: &'a [u64],
    /// The line from one member's digits to the next one's.
    next: &'a str,
    /// The line that sets the inputs of a member, or the number that takes their place.
    set: &'a str,
    /// The function that judges a lane in one scenario.
    judge: &'a str,
}

impl Prelude<'_> {
    /// Conditions, constraints and worst values in one scenario, of rows and of lanes.
    pub(super) fn judging(&mut self, perturb: &[(usize, f64)]) {
        let plan = self.plan;
        let onwards = if self.layout.sorted.is_some() { "_onwards" } else { "" };
        for name in if onwards.is_empty() { vec![""] } else { vec!["", onwards] } {
            let mut wrong = vec![format!("var out = finish{name}(prepared, inputs);")];
            for &(output, part) in perturb {
                let field = self.output(output);
                wrong.push(format!("out.{field}.value *= {};", literal((1.0 + part) as f32)));
            }
            wrong.push("return out;".to_owned());
            self.function(&format!("finish_perturbed{name}(prepared: Prepared, inputs: Inputs) -> Outputs"), &wrong);
        }
        for (number, constraint) in plan.study.constraints.iter().enumerate() {
            if matches!(constraint.quantity, Quantity::Output(_)) {
                let lines = keep(plan, constraint);
                self.function(&format!("keeps_{number}(number: Real) -> u32"), &lines);
            }
        }
        let of_rows = ("judge_row", "RowState", &plan.row_conditions, true, "");
        let of_lanes = ("judge_lane", "Lane", &plan.lane_conditions, false, "");
        let sorted = ("judge_lane_onwards", "Lane", &plan.lane_conditions, false, onwards);
        for (name, state, conditions, row, onwards) in [of_rows, of_lanes, sorted].into_iter().take(if onwards.is_empty() { 2 } else { 3 })
        {
            let mut lines = vec![
                format!("let out = finish_perturbed{onwards}(prepared, inputs);"),
                format!("let margins = conditions{onwards}(prepared, inputs);"),
                "var verdict = (*state).verdict;".to_owned(),
            ];
            for &number in conditions.iter().filter(|&&number| self.layout.asks(number)) {
                let question = if plan.study.model.conditions[number].strict { "above_zero" } else { "at_least_zero" };
                let factor = literal(CONDITION_BOUND_FACTOR as f32);
                lines.push(format!("verdict = min(verdict, {question}(bounded(margins[{number}], {factor})));"));
            }
            for (number, (constraint, source)) in plan.study.constraints.iter().zip(&plan.constraints).enumerate() {
                if let Quantity::Output(output) = constraint.quantity
                    && source.is_row() == row
                {
                    lines.push(format!("verdict = min(verdict, keeps_{number}({}));", self.bounded(output)));
                }
            }
            for (at, (tracked, source)) in plan.tracked.iter().enumerate() {
                if let Quantity::Output(output) = tracked.quantity
                    && source.is_row() == row
                {
                    let fold = if tracked.worse == Worse::Higher { "max" } else { "min" };
                    lines.push(format!("let v{at} = {};", self.bounded(output)));
                    lines.push(format!("verdict = min(verdict, select(UNSURE, YES, is_known(v{at})));"));
                    lines.push(format!(
                        "(*state).t{at} = Real({fold}((*state).t{at}.value, v{at}.value), max((*state).t{at}.bound, v{at}.bound));"
                    ));
                }
            }
            lines.push("(*state).verdict = verdict;".to_owned());
            self.function(&format!("{name}(prepared: Prepared, inputs: Inputs, state: ptr<function, {state}>)"), &lines);
        }
        self.judging_of_groups();
    }

    /// A lane alone, and GROUP neighbouring lanes together, over all scenarios.
    pub(super) fn judging_of_groups(&mut self) {
        let group = self.layout.cut.group;
        let all: Vec<u64> = (0..group).collect();
        put!(self, "struct Group {{");
        all.iter().for_each(|it| put!(self, "    l{it}: Lane,"));
        put!(self, "}}\n");
        let of_group = format!("return Group({});", all.iter().map(|it| format!("l{it}")).collect::<Vec<_>>().join(", "));
        // Beyond the last lane the members of a group repeat earlier ones or leave the axis; nobody looks at them.
        let one = JudgingText {
            name: "judge",
            at: "digits: Digits",
            begin: "",
            members: &all[..1],
            next: "",
            set: "set_lane(&inputs, d{member});",
            judge: "judge_lane",
        };
        let group = JudgingText {
            name: "judge_group",
            at: "first: u32",
            begin: "var digits = digits_of_lane(first);",
            members: &all,
            next: "advance(&digits);",
            ..one
        };
        let along = JudgingText {
            name: "judge_along",
            at: "first: Digits",
            begin: "var digits = first;",
            next: "digits = along(digits, 1u);",
            ..group
        };
        let stretch = JudgingText {
            name: "judge_between",
            at: "digits: Digits, at_last: Digits",
            set: "set_stretch(&inputs, d{member}, at_last);",
            ..one
        };
        let onwards = JudgingText { name: "judge_onwards", set: "", judge: "judge_lane_onwards", ..one };
        let number = self.sorted_by().map(|field| format!("prepared.{field} = sorted_number(state, first + {{member}}u);"));
        let in_order = JudgingText {
            name: "judge_sorted",
            begin: "var digits: Digits;",
            next: "",
            set: number.as_deref().unwrap_or_default(),
            judge: "judge_lane_onwards",
            ..group
        };
        let runs = match self.layout.runs.map(|it| it.along) {
            Some(RunsAlong::Axis { .. }) => vec![along, stretch],
            Some(RunsAlong::Order) => vec![onwards, in_order],
            None => Vec::new(),
        };
        for judged in [one, group].into_iter().chain(runs) {
            let JudgingText { name, at, begin, members, next, .. } = judged;
            let mut lines = vec!["var inputs = fixed_inputs();".to_owned(), "set_row_inputs(&inputs, state);".to_owned()];
            if !begin.is_empty() {
                lines.insert(0, begin.to_owned());
            }
            for it in members {
                lines.push(format!("let d{it} = digits;"));
                lines.push(format!("var l{it} = start_lane(state, d{it});"));
                if members.len() > 1 {
                    lines.push(next.to_owned());
                }
            }
            lines.extend(self.scenario_loops(judged));
            let (kind, result) = if begin.is_empty() { ("Lane", "return l0;") } else { ("Group", of_group.as_str()) };
            lines.push(result.to_owned());
            self.function(&format!("{name}(row: u32, state: RowState, held: Prepared, {at}) -> {kind}"), &lines);
        }
        let look = all.iter().map(|it| format!("look_at(group.l{it}, horizon, i + {it}u, count, seen, row_dominator);"));
        let keep = all.iter().map(|it| format!("(*kept)[i + {it}u] = group.l{it};"));
        let lines: Vec<_> = if self.layout.cut.keeps { look.chain(keep).collect() } else { look.collect() };
        self.function(
            "look_at_group(group: Group, horizon: Horizon, i: u32, count: u32, seen: ptr<function, Seen>, row_dominator: ptr<function, RowDominator>, kept: ptr<function, array<Lane, KEPT>>)",
            &lines,
        );
        let check = all.iter().map(|it| format!("check_lane(group.l{it}, row, state, first + {it}u);"));
        self.function("check_group(group: Group, row: u32, state: RowState, first: u32)", &check.collect::<Vec<_>>());
    }

    fn scenario_loops(&self, JudgingText { members, set, judge, .. }: JudgingText<'_>) -> Vec<String> {
        let (plan, layout) = (self.plan, self.layout);
        if plan.lane_outputs.is_empty() && plan.lane_conditions.is_empty() {
            return Vec::new();
        }
        let once = |name: &str, index: &str| format!("set_{name}_scenario(&inputs, {index});");
        let lines = |it: &u64| [set.replace("{member}", &it.to_string()), format!("{judge}(prepared, inputs, &l{it});")];
        let each = members.iter().flat_map(lines);
        let told: Vec<String> = each.clone().collect();
        let mut inner: Vec<String> = Vec::new();
        if layout.fast_scenarios.count == 1 {
            inner.push(once("fast", "0u"));
            inner.extend(each);
        } else {
            inner.push("for (var t = 0u; t < FAST_SCENARIOS; t++) {".to_owned());
            inner.push(format!("    {}", once("fast", "t")));
            inner.extend(each.map(|line| format!("    {line}")));
            inner.push("}".to_owned());
        }
        if layout.slow_scenarios.count == 1 && !layout.tells_scenarios {
            let mut lines = vec!["var prepared = held;".to_owned(), once("slow", "0u")];
            lines.extend(inner);
            return lines;
        }
        let verdicts = members.iter().map(|it| format!("l{it}.verdict"));
        let best = verdicts.reduce(|a, b| format!("max({a}, {b})")).expect("a group has a member");
        let mut lines = if layout.tells_scenarios {
            vec![
                "let last = decisive[row + 1u];".to_owned(),
                "for (var place = decisive[row]; place < last; place++) {".to_owned(),
                "    let q = decisive[place] / FAST_SCENARIOS;".to_owned(),
                format!("    {}", once("fast", "decisive[place] % FAST_SCENARIOS")),
            ]
        } else {
            vec!["for (var q = 0u; q < SLOW_SCENARIOS; q++) {".to_owned()]
        };
        lines.push("    let prepared = load_prepared(q, row);".to_owned());
        lines.push(format!("    {}", once("slow", "q")));
        let inner = if layout.tells_scenarios { told } else { inner };
        lines.extend(inner.into_iter().map(|line| format!("    {line}")));
        lines.push(format!("    if {best} == NO {{ break; }}"));
        lines.push("}".to_owned());
        lines
    }

    pub(super) fn bounded(&self, output: usize) -> String {
        let factor = self.plan.study.model.outputs[output].bound_factor;
        format!("bounded(out.{}, {})", self.output(output), literal(factor as f32))
    }
}

/// Does a value keep to a constraint of the study?
fn keep(plan: &Plan, constraint: &Constraint) -> Vec<String> {
    // The unit is converted in f64, which rounds too; what has no unit stays as it is.
    let plain = matches!(constraint.quantity, Quantity::Output(output) if plan.study.model.outputs[output].unit.is_si());
    keep_between([constraint.low, constraint.high], plain, |bound| on_device(plan, constraint.quantity, bound))
}
