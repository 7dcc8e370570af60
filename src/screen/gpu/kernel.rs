//! The kernel of a study: the shared texts, the model's text, the sweep's entry points, and a prelude that knows the study.
//!
//! Fixed inputs are constants, the axes are known, and only what the study asks for is read or written, so that the compiler
//! drops the rest of the model.

use super::layout::{BINS, KILLERS, LIST, Layout, Values, champions, on_device, scenario_worst, sign, used_outputs};
use crate::gpu::{model_prelude, model_source, source};
use crate::models::{CONDITION_PROMISE, Worse};
use crate::plan::{Plan, Source};
use crate::real::nearest_f32;
use crate::study::{Best, Constraint, Goal, MapSpec, Objective, Quantity};
use std::fmt::Write;

/// Entry points of the kernel.
pub const ENTRIES: &[&str] = &["prepare_rows", "judge_rows", "sweep", "check"];

/// How a design is compared by an objective on the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// An output with its bound.
    Plain,
    /// Steps of the resolution.
    Stepped,
    /// An input whose values f32 tells apart.
    Exact,
}

/// Does f32 tell an input's values apart, so that they compare as in f64?
pub fn is_exact(plan: &Plan, layout: &Layout, input: usize) -> bool {
    layout.exact >> input & 1 == 1 || plan.space.designs.inputs() >> input & 1 == 0
}

/// The kind of each objective's coordinate.
pub fn coordinates(plan: &Plan, layout: &Layout) -> Vec<Coordinate> {
    let kind = |objective: &Objective| match objective.quantity {
        _ if objective.resolution.is_some() => Coordinate::Stepped,
        Quantity::Input(input) if is_exact(plan, layout, input) => Coordinate::Exact,
        _ => Coordinate::Plain,
    };
    plan.study.objectives.iter().map(kind).collect()
}

/// Does the look-up table serve: two or three coordinates, none of steps, of which many designs share one?
pub fn uses_table(coordinates: &[Coordinate]) -> bool {
    matches!(coordinates.len(), 2 | 3) && !coordinates.contains(&Coordinate::Stepped)
}

/// Bins along each coordinate of the table.
pub fn bins(coordinates: &[Coordinate]) -> u64 {
    BINS[usize::from(coordinates.len() == 3)]
}

/// The words of a survivor: row, lane with the reason, a lower key per objective, a lower and an upper key per map of values.
pub fn survivor_words(plan: &Plan) -> usize {
    2 + plan.study.objectives.len() + 2 * value_maps(plan).count()
}

/// The maps that show a value, with the position of what they show among the tracked quantities.
pub fn value_maps(plan: &Plan) -> impl Iterator<Item = (&MapSpec, usize, Goal)> {
    plan.study.report.maps.iter().filter_map(|spec| {
        let Best::Value(quantity, goal) = spec.value else { return None };
        let at = plan.tracked.iter().position(|(it, _)| it.quantity == quantity && it.worse == goal.worse());
        Some((spec, at.expect("what a map shows is tracked"), goal))
    })
}

/// The words of a check record: verdict, then value and bound per tracked quantity, then per used output.
pub fn check_words(plan: &Plan) -> usize {
    1 + 2 * plan.tracked.len() + 2 * used_outputs(plan).count_ones() as usize
}

/// A number of the kernel's text that reads back as the same f32.
fn literal(value: f32) -> String {
    if value.is_finite() {
        format!("f32({value:?})")
    } else if value > 0.0 {
        "infinity()".to_owned()
    } else {
        "(-infinity())".to_owned()
    }
}

/// A number with what f32 loses of it.
fn real(value: f64) -> String {
    let (value, bound) = nearest_f32(value);
    format!("Real({}, {})", literal(value), literal(bound))
}

/// The text of the kernel. `perturb`: outputs that are to come out wrong by this part of their value, for testing.
pub fn text(plan: &Plan, layout: &Layout, perturb: &[(usize, f64)]) -> String {
    let model = plan.study.model;
    let mut prelude = Prelude { plan, layout, text: String::new(), coordinates: coordinates(plan, layout) };
    prelude.constants();
    prelude.inputs();
    prelude.rows();
    prelude.passing();
    prelude.lanes();
    prelude.judging(perturb);
    prelude.front();
    prelude.others();
    prelude.report();
    [
        source::COMMON,
        include_str!("../../../shaders/common/wide.wgsl"),
        &model_prelude(model),
        &model_source(model),
        include_str!("../../../shaders/sweep/tile.wgsl"),
        &prelude.text,
        include_str!("../../../shaders/sweep/prepare.wgsl"),
        include_str!("../../../shaders/sweep/sweep.wgsl"),
        include_str!("../../../shaders/sweep/check.wgsl"),
    ]
    .join("\n")
}

struct Prelude<'a> {
    plan: &'a Plan,
    layout: &'a Layout,
    text: String,
    coordinates: Vec<Coordinate>,
}

macro_rules! put {
    ($self:ident, $($format:tt)*) => {
        writeln!($self.text, $($format)*).expect("a text takes everything")
    };
}

impl Prelude<'_> {
    fn input(&self, input: usize) -> &'static str {
        self.plan.study.model.kernel.fields().inputs[input]
    }

    fn output(&self, output: usize) -> &'static str {
        self.plan.study.model.kernel.fields().outputs[output]
    }

    /// A function of these lines.
    fn function(&mut self, head: &str, lines: &[String]) {
        put!(self, "fn {head} {{");
        for line in lines {
            put!(self, "    {line}");
        }
        put!(self, "}}\n");
    }

    fn constants(&mut self) {
        let (plan, layout) = (self.plan, self.layout);
        let cut = layout.cut;
        let share_or_value = !plan.study.report.maps.is_empty();
        let all = share_or_value || !plan.study.report.histograms.is_empty();
        let uses_champions = champions(plan);
        let each = if cut.keeps { cut.block } else { 1 };
        let shared = if uses_champions { cut.group_rows * cut.group_chunks * each } else { 1 };
        for (name, value) in [
            ("SLOW_SCENARIOS", layout.slow_scenarios.count),
            ("FAST_SCENARIOS", layout.fast_scenarios.count),
            ("OBJECTIVES", plan.study.objectives.len() as u64),
            ("LANES_EACH", cut.lanes_each),
            ("BLOCK", cut.block),
            ("BLOCKS", cut.lanes_each.div_ceil(cut.block)),
            ("GROUP", cut.group),
            ("KEPT", if cut.keeps { cut.block } else { 1 }),
            ("GROUP_ROWS", cut.group_rows),
            ("GROUP_CHUNKS", cut.group_chunks),
            ("CHAMPIONS", shared),
            ("CHAMPIONS_EACH", each),
            ("SURVIVOR_WORDS", survivor_words(plan) as u64),
            ("CHECK_WORDS", check_words(plan) as u64),
            ("WORST_WORDS", 2 * plan.tracked.len() as u64),
        ] {
            put!(self, "const {name}: u32 = {value}u;");
        }
        put!(self, "const KEEPS: bool = {};", cut.keeps);
        put!(self, "const USES_CHAMPIONS: bool = {uses_champions};");
        put!(self, "const LOOK_AT_ALL: bool = {all};\n");
        let space = if layout.steady_is_uniform() { "uniform" } else { "storage, read" };
        put!(self, "// Levels that never change: scenarios, then fast design axes.");
        put!(self, "@group(0) @binding(2) var<{space}> steady: array<vec4<f32>, {}>;\n", layout.steady.len().max(1));
    }

    /// Fixed inputs and scenarios.
    fn inputs(&mut self) {
        let plan = self.plan;
        let model = plan.study.model;
        // Inputs that a stage does not depend on still decide selections: every one has a value of its own axis.
        let first = crate::models::to_si(model, &plan.space.inputs(0, 0));
        let mut lines = vec!["var inputs: Inputs;".to_owned()];
        for (input, &value) in first.iter().enumerate().take(model.inputs.len()) {
            lines.push(format!("inputs.{} = {};", self.input(input), real(value)));
        }
        lines.push("return inputs;".to_owned());
        self.function("fixed_inputs() -> Inputs", &lines);
        for (name, table) in [("slow", &self.layout.slow_scenarios), ("fast", &self.layout.fast_scenarios)] {
            let columns = table.inputs.len();
            let set = |(column, &input): (usize, &usize)| {
                let entry = format!("steady[{}u + scenario * {columns}u]", table.offset as usize + column);
                format!("(*inputs).{} = Real({entry}.x, {entry}.y);", self.input(input))
            };
            let lines: Vec<_> = table.inputs.iter().enumerate().map(set).collect();
            self.function(&format!("set_{name}_scenario(inputs: ptr<function, Inputs>, scenario: u32)"), &lines);
        }
    }

    /// From a row's number to its place, inputs and index.
    fn rows(&mut self) {
        let slow = &self.layout.slow;
        put!(self, "const DIMENSIONS: u32 = {}u;\n", slow.len().max(1));
        let mut lines = vec!["var digits: array<u32, DIMENSIONS>;".to_owned(), "var rest = row;".to_owned()];
        for (number, dimension) in slow.iter().enumerate().rev() {
            let sum = format!("tile.digits[{}][{}] + rest", number / 4, number % 4);
            if number == 0 {
                lines.push(format!("digits[0] = {sum};"));
            } else {
                lines.push(format!("digits[{number}] = ({sum}) % {}u;", dimension.count));
                lines.push(format!("rest = ({sum}) / {}u;", dimension.count));
            }
        }
        lines.push("return digits;".to_owned());
        self.function("digits_of_row(row: u32) -> array<u32, DIMENSIONS>", &lines);

        let entry = |number: usize, column: usize| {
            let dimension = &slow[number];
            format!("levels[{}u + digits[{number}] * {}u]", dimension.offset as usize + column, dimension.inputs.len())
        };
        let mut lines = Vec::new();
        let mut allowed = vec!["var allowed = 1.0;".to_owned()];
        let mut index = vec!["var index = tile.index;".to_owned()];
        for (number, dimension) in slow.iter().enumerate() {
            for (column, &input) in dimension.inputs.iter().enumerate() {
                let entry = entry(number, column);
                lines.push(format!("(*inputs).{} = Real({entry}.x, {entry}.y);", self.input(input)));
                allowed.push(format!("allowed = min(allowed, {entry}.w);"));
            }
            let stride = dimension.stride;
            index.push(format!(
                "index = wide_add(index, wide_mul(digits[{number}], vec2<u32>({}u, {}u)));",
                stride & 0xffff_ffff,
                stride >> 32
            ));
        }
        allowed.push("return allowed == 1.0;".to_owned());
        index.push("return index;".to_owned());
        self.function("set_row(inputs: ptr<function, Inputs>, digits: array<u32, DIMENSIONS>)", &lines);
        self.function("is_allowed(digits: array<u32, DIMENSIONS>) -> bool", &allowed);
        self.function("index_of_row(digits: array<u32, DIMENSIONS>) -> vec2<u32>", &index);
    }

    /// Values of the first stage, and what all lanes of a row share.
    fn passing(&mut self) {
        let (plan, layout) = (self.plan, self.layout);
        let fields = plan.study.model.kernel.fields().prepared;
        let width = layout.prepared.len();
        let at = |number: usize| format!("prepared_table[(q * {width}u + {number}u) * tile.rows + row]");
        let passed = layout.prepared.iter().enumerate();
        let store: Vec<_> = passed.clone().map(|(number, &field)| format!("{} = prepared.{};", at(number), fields[field])).collect();
        self.function("store_prepared(q: u32, row: u32, prepared: Prepared)", &store);
        let mut load = vec!["var prepared: Prepared;".to_owned()];
        load.extend(passed.map(|(number, &field)| format!("prepared.{} = {};", fields[field], at(number))));
        load.push("return prepared;".to_owned());
        self.function("load_prepared(q: u32, row: u32) -> Prepared", &load);
        let hold = if layout.slow_scenarios.count == 1 { "return load_prepared(0u, row);" } else { "var none: Prepared; return none;" };
        self.function("hold_prepared(row: u32) -> Prepared", &[hold.to_owned()]);

        // Verdict, index, cell of each map, tracked values, inputs.
        let tracked: Vec<usize> = (0..plan.tracked.len()).filter(|&at| plan.tracked[at].1.is_row()).collect();
        let maps = plan.study.report.maps.len();
        put!(self, "struct RowState {{\n    verdict: u32,\n    index: vec2<u32>,");
        (0..maps).for_each(|map| put!(self, "    cell{map}: u32,"));
        tracked.iter().for_each(|at| put!(self, "    t{at}: Real,"));
        layout.row_inputs.iter().for_each(|&input| put!(self, "    {}: Real,", self.input(input)));
        put!(self, "}}\n");
        let mut words = vec!["verdict".to_owned(), "index.x".to_owned(), "index.y".to_owned()];
        words.extend((0..maps).map(|map| format!("cell{map}")));
        let whole = words.len();
        words.extend(tracked.iter().flat_map(|at| [format!("t{at}.value"), format!("t{at}.bound")]));
        words.extend(layout.row_inputs.iter().flat_map(|&it| ["value", "bound"].map(|part| format!("{}.{part}", self.input(it)))));
        put!(self, "const ROW_WORDS: u32 = {}u;\n", words.len());
        let at = |word: usize| format!("row_table[{word}u * tile.rows + row]");
        let store = words.iter().enumerate().map(|(word, it)| {
            format!("{} = {};", at(word), if word < whole { format!("state.{it}") } else { format!("bitcast<u32>(state.{it})") })
        });
        self.function("store_row(row: u32, state: RowState)", &store.collect::<Vec<_>>());
        let mut load = vec!["var state: RowState;".to_owned()];
        load.extend(
            words
                .iter()
                .enumerate()
                .map(|(word, it)| format!("state.{it} = {};", if word < whole { at(word) } else { format!("bitcast<f32>({})", at(word)) })),
        );
        load.push("return state;".to_owned());
        self.function("load_row(row: u32) -> RowState", &load);
        let set: Vec<_> = layout.row_inputs.iter().map(|&input| format!("(*inputs).{0} = state.{0};", self.input(input))).collect();
        self.function("set_row_inputs(inputs: ptr<function, Inputs>, state: RowState)", &set);

        let mut start = vec!["var state: RowState;".to_owned()];
        let possible = if layout.possible { "is_allowed(digits)" } else { "false" };
        start.push(format!("state.verdict = select(NO, YES, {possible});"));
        start.push("state.index = index_of_row(digits);".to_owned());
        for map in 0..maps {
            start.push(format!("state.cell{map} = {};", self.cell_of_row(map)));
        }
        for &at in &tracked {
            start.push(format!("state.t{at} = {};", self.row_start(at)));
        }
        start.extend(layout.row_inputs.iter().map(|&input| format!("state.{0} = inputs.{0};", self.input(input))));
        start.push("return state;".to_owned());
        self.function("start_row(digits: array<u32, DIMENSIONS>, inputs: Inputs) -> RowState", &start);
    }

    /// What a row adds to the number of a map's cell.
    fn cell_of_row(&self, map: usize) -> String {
        let terms = self.map_terms(map).into_iter().filter_map(|(stride, count, factor)| {
            let number = self.layout.slow.iter().position(|it| (it.stride, it.count) == (stride, count))?;
            // The outermost digit counts from the window's first level.
            let base = if number == 0 { " + tile.window" } else { "" };
            Some(format!("(digits[{number}]{base}) * {factor}u"))
        });
        let terms: Vec<_> = terms.collect();
        if terms.is_empty() { "0u".to_owned() } else { terms.join(" + ") }
    }

    /// Of each axis of a map: its stride in the design index and its length, which together tell it from the others (an axis of one
    /// value has the stride of its neighbour), and what a step along it adds to the cell's number.
    fn map_terms(&self, map: usize) -> [(u64, u64, u64); 2] {
        let study = &self.plan.study;
        let spec = &study.report.maps[map];
        let stride = |axis: usize| study.design[axis + 1..].iter().map(crate::study::Axis::count).product::<u64>();
        let [x, y] = [spec.x, spec.y].map(|axis| (stride(axis), study.design[axis].count()));
        [(x.0, x.1, 1), (y.0, y.1, x.1)]
    }

    /// The value of a row's tracked quantity before any scenario.
    fn row_start(&self, at: usize) -> String {
        let (tracked, source) = self.plan.tracked[at];
        match source {
            Source::RowInput(input) => {
                let slow = self.layout.slow.iter().enumerate().find_map(|(number, dimension)| {
                    let column = dimension.inputs.iter().position(|&it| it == input)?;
                    Some(format!("levels[{}u + digits[{number}] * {}u].z", dimension.offset as usize + column, dimension.inputs.len()))
                });
                match slow {
                    Some(entry) => self.own_value(input, &entry),
                    None => real(scenario_worst(self.plan, input, tracked.worse)),
                }
            }
            _ => least_bad(tracked.worse),
        }
    }

    /// An input's value in its unit, with the bound of its rounding.
    fn own_value(&self, input: usize, entry: &str) -> String {
        if self.layout.represented >> input & 1 == 1 { format!("constant({entry})") } else { format!("near({entry})") }
    }

    /// From a lane's number to its place, inputs and index.
    fn lanes(&mut self) {
        let (plan, layout) = (self.plan, self.layout);
        let fast = &layout.fast;
        put!(self, "struct Digits {{");
        fast.iter().enumerate().for_each(|(number, _)| put!(self, "    d{number}: u32,"));
        if fast.is_empty() {
            put!(self, "    none: u32,");
        }
        put!(self, "}}\n");
        let mut of_lane = vec!["var digits: Digits;".to_owned()];
        let mut index = vec!["var index = vec2<u32>(0u, 0u);".to_owned()];
        for (number, it) in fast.iter().enumerate() {
            // Beyond the last lane the outermost digit runs on; nothing reads it.
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
        self.function("index_of_lane(digits: Digits) -> vec2<u32>", &index);
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
                        set.push(format!("(*inputs).{} = Real({entry}.x, {entry}.y);", self.input(input)));
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

    /// Conditions, constraints and worst values in one scenario, of rows and of lanes.
    fn judging(&mut self, perturb: &[(usize, f64)]) {
        let plan = self.plan;
        let mut wrong = vec!["var out = finish(prepared, inputs);".to_owned()];
        for &(output, part) in perturb {
            let field = self.output(output);
            wrong.push(format!("out.{field}.value *= {};", literal((1.0 + part) as f32)));
        }
        wrong.push("return out;".to_owned());
        self.function("finish_perturbed(prepared: Prepared, inputs: Inputs) -> Outputs", &wrong);
        for (number, constraint) in plan.study.constraints.iter().enumerate() {
            if matches!(constraint.quantity, Quantity::Output(_)) {
                let lines = keep(plan, constraint);
                self.function(&format!("keeps_{number}(number: Real) -> u32"), &lines);
            }
        }
        for (name, state, conditions, row) in
            [("judge_row", "RowState", &plan.row_conditions, true), ("judge_lane", "Lane", &plan.lane_conditions, false)]
        {
            let mut lines = vec![
                "let out = finish_perturbed(prepared, inputs);".to_owned(),
                "let margins = conditions(prepared, inputs);".to_owned(),
                "var verdict = (*state).verdict;".to_owned(),
            ];
            for &number in conditions {
                let question = if plan.study.model.conditions[number].strict { "above_zero" } else { "at_least_zero" };
                let promise = literal(CONDITION_PROMISE as f32);
                lines.push(format!("verdict = min(verdict, {question}(promised(margins[{number}], {promise})));"));
            }
            for (number, (constraint, source)) in plan.study.constraints.iter().zip(&plan.constraints).enumerate() {
                if let Quantity::Output(output) = constraint.quantity
                    && source.is_row() == row
                {
                    lines.push(format!("verdict = min(verdict, keeps_{number}({}));", self.promised(output)));
                }
            }
            for (at, (tracked, source)) in plan.tracked.iter().enumerate() {
                if let Quantity::Output(output) = tracked.quantity
                    && source.is_row() == row
                {
                    let fold = if tracked.worse == Worse::Higher { "max" } else { "min" };
                    lines.push(format!("let v{at} = {};", self.promised(output)));
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
    fn judging_of_groups(&mut self) {
        let group = self.layout.cut.group;
        let all: Vec<u64> = (0..group).collect();
        put!(self, "struct Group {{");
        all.iter().for_each(|it| put!(self, "    l{it}: Lane,"));
        put!(self, "}}\n");
        for (head, members, result) in [
            ("judge(row: u32, state: RowState, held: Prepared, digits: Digits) -> Lane", &all[..1], "return l0;".to_owned()),
            (
                "judge_group(row: u32, state: RowState, held: Prepared, first: u32) -> Group",
                &all[..],
                format!("return Group({});", all.iter().map(|it| format!("l{it}")).collect::<Vec<_>>().join(", ")),
            ),
        ] {
            let mut lines = vec!["var inputs = fixed_inputs();".to_owned(), "set_row_inputs(&inputs, state);".to_owned()];
            if head.contains("first") {
                // Beyond the last lane the members repeat earlier ones; nobody looks at them.
                lines.insert(0, "var digits = digits_of_lane(first);".to_owned());
            }
            for it in members {
                lines.push(format!("let d{it} = digits;"));
                lines.push(format!("var l{it} = start_lane(state, d{it});"));
                if members.len() > 1 {
                    lines.push("advance(&digits);".to_owned());
                }
            }
            lines.extend(self.scenario_loops(members));
            lines.push(result);
            self.function(head, &lines);
        }
        let look = all.iter().map(|it| format!("look_at(group.l{it}, horizon, i + {it}u, count, seen, champion);"));
        let keep = all.iter().map(|it| format!("(*kept)[i + {it}u] = group.l{it};"));
        let lines: Vec<_> = if self.layout.cut.keeps { look.chain(keep).collect() } else { look.collect() };
        self.function(
            "look_at_group(group: Group, horizon: Horizon, i: u32, count: u32, seen: ptr<function, Seen>, champion: ptr<function, Champion>, kept: ptr<function, array<Lane, KEPT>>)",
            &lines,
        );
        let check = all.iter().map(|it| format!("check_lane(group.l{it}, row, state, first + {it}u, lanes);"));
        self.function("check_group(group: Group, row: u32, state: RowState, first: u32, lanes: u32)", &check.collect::<Vec<_>>());
    }

    fn scenario_loops(&self, members: &[u64]) -> Vec<String> {
        let (plan, layout) = (self.plan, self.layout);
        if plan.lane_outputs.is_empty() && plan.lane_conditions.is_empty() {
            return Vec::new();
        }
        let once = |name: &str, index: &str| format!("set_{name}_scenario(&inputs, {index});");
        let each = members.iter().flat_map(|it| [format!("set_lane(&inputs, d{it});"), format!("judge_lane(prepared, inputs, &l{it});")]);
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
        if layout.slow_scenarios.count == 1 {
            let mut lines = vec!["let prepared = held;".to_owned(), once("slow", "0u")];
            lines.extend(inner);
            return lines;
        }
        let verdicts = members.iter().map(|it| format!("l{it}.verdict"));
        let best = verdicts.reduce(|a, b| format!("max({a}, {b})")).expect("a group has a member");
        let mut lines = vec![
            "for (var q = 0u; q < SLOW_SCENARIOS; q++) {".to_owned(),
            "    let prepared = load_prepared(q, row);".to_owned(),
            format!("    {}", once("slow", "q")),
        ];
        lines.extend(inner.into_iter().map(|line| format!("    {line}")));
        lines.push(format!("    if {best} == NO {{ break; }}"));
        lines.push("}".to_owned());
        lines
    }

    fn promised(&self, output: usize) -> String {
        let promise = self.plan.study.model.outputs[output].promise;
        format!("promised(out.{}, {})", self.output(output), literal(promise as f32))
    }

    /// Coordinates of the objectives, and what they are compared with.
    fn front(&mut self) {
        let plan = self.plan;
        let objectives = &plan.study.objectives;
        put!(self, "// Lower and upper end of each objective's coordinate; less is better.\nstruct Keys {{");
        (0..objectives.len()).for_each(|at| put!(self, "    k{at}: vec2<f32>,"));
        if objectives.is_empty() {
            put!(self, "    none: u32,");
        }
        put!(self, "}}\n");
        let mut keys = vec!["var keys: Keys;".to_owned()];
        for (number, objective) in objectives.iter().enumerate() {
            keys.push(format!("keys.k{number} = {};", self.key(number, objective)));
        }
        keys.push("return keys;".to_owned());
        self.function("keys_of(lane: Lane) -> Keys", &keys);
        let write = (0..objectives.len()).map(|number| format!("survivors[at + {number}u] = bitcast<u32>(keys.k{number}.x);"));
        let mut lines = vec!["let keys = keys_of(judged);".to_owned()];
        lines.extend(write);
        self.function("write_keys(at: u32, judged: Lane)", &lines);

        // Killers and lists hold what a key must reach to be certainly no better; strictly so for a coordinate with bounds.
        let mixed = !self.coordinates.contains(&Coordinate::Plain);
        let compare = |of: &dyn Fn(usize) -> String| {
            let each: Vec<_> = (0..objectives.len()).map(|number| (of(number), format!("keys.k{number}.x"))).collect();
            let behind: Vec<_> = each.iter().map(|(killer, key)| format!("{killer} <= {key}")).collect();
            let apart: Vec<_> = each.iter().map(|(killer, key)| format!("{killer} < {key}")).collect();
            if mixed { format!("({}) && ({})", behind.join(" && "), apart.join(" || ")) } else { behind.join(" && ") }
        };
        // A uniform is loaded anew wherever it is read: what every lane is compared with is loaded once per invocation.
        put!(self, "struct Horizon {{\n    top: f32,");
        for number in 0..objectives.len() {
            put!(self, "    extreme{number}: vec2<f32>,");
            (0..KILLERS).for_each(|killer| put!(self, "    n{killer}_{number}: f32,"));
        }
        put!(self, "}}\n");
        let mut lines = vec!["var horizon: Horizon;".to_owned(), "horizon.top = known.top.x;".to_owned()];
        for number in 0..objectives.len() {
            lines.push(format!("horizon.extreme{number} = known.extremes[{number}].xy;"));
            lines.extend(
                (0..KILLERS)
                    .map(|killer| format!("horizon.n{killer}_{number} = known.killers[{}][{}];", 2 * killer + number / 4, number % 4)),
            );
        }
        lines.push("return horizon;".to_owned());
        self.function("horizon() -> Horizon", &lines);
        let mut killers = vec!["var beaten = false;".to_owned()];
        if objectives.len() == 2 && !mixed {
            // Along a curve the killers are sorted: the last one that is not beyond the first coordinate is the best.
            killers = vec!["var least = infinity();".to_owned()];
            for killer in 0..KILLERS {
                killers.push(format!("least = select(least, horizon.n{killer}_1, horizon.n{killer}_0 <= keys.k0.x);"));
            }
            killers.push("let beaten = least <= keys.k1.x;".to_owned());
        } else if !objectives.is_empty() {
            for killer in 0..KILLERS {
                let of = |number: usize| format!("horizon.n{killer}_{number}");
                killers.push(format!("beaten = beaten || ({});", compare(&of)));
            }
        }
        killers.push("return beaten;".to_owned());
        self.function("beaten_by_killers(keys: Keys, horizon: Horizon) -> bool", &killers);

        let table = if objectives.is_empty() {
            vec!["return false;".to_owned()]
        } else if uses_table(&self.coordinates) {
            let bins = bins(&self.coordinates);
            let bin = |number: usize| {
                let [low, scale] = [["x", "y"], ["z", "w"]][number];
                format!("u32(clamp((keys.k{number}.x - known.table.{low}) * known.table.{scale}, 0.0, {}.0))", bins - 1)
            };
            let last = objectives.len() - 1;
            let at = if last == 1 { bin(0) } else { format!("{} * {bins}u + {}", bin(0), bin(1)) };
            vec![format!("return beaters[{at}] < keys.k{last}.x;")]
        } else {
            let of = |number: usize| format!("beaters[i * {}u + {number}u]", objectives.len());
            vec![
                format!("for (var i = 0u; i < {LIST}u; i++) {{"),
                format!("    if {} {{ return true; }}", compare(&of)),
                "}".to_owned(),
                "return false;".to_owned(),
            ]
        };
        self.function("beaten_by_table(keys: Keys) -> bool", &table);

        // Upper ends of the objectives that differ within a row.
        let differing: Vec<usize> = (0..objectives.len()).filter(|&at| !plan.tracked[plan.objectives[at]].1.is_row()).collect();
        put!(self, "struct Champion {{");
        differing.iter().for_each(|at| put!(self, "    u{at}: f32,"));
        if differing.is_empty() {
            put!(self, "    none: f32,");
        }
        put!(self, "}}\n");
        let parts = |part: &dyn Fn(usize) -> String, none: &str| {
            if differing.is_empty() { none.to_owned() } else { differing.iter().map(|&at| part(at)).collect::<Vec<_>>().join(", ") }
        };
        let none = format!("return Champion({});", parts(&|_| "infinity()".to_owned(), "0.0"));
        self.function("no_champion() -> Champion", &[none]);
        let of = format!("return Champion({});", parts(&|at| format!("keys.k{at}.y"), "0.0"));
        self.function("champion_of(keys: Keys) -> Champion", &[of]);
        let all = |compare: &dyn Fn(usize) -> String, with: &str| differing.iter().map(|&at| compare(at)).collect::<Vec<_>>().join(with);
        let (worse, beats) = if differing.is_empty() {
            ("false".to_owned(), "false".to_owned())
        } else {
            let as_good = all(&|at| format!("champion.u{at} <= keys.k{at}.x"), " && ");
            let better = all(&|at| format!("champion.u{at} < keys.k{at}.x"), " || ");
            (all(&|at| format!("other.u{at} <= champion.u{at}"), " && "), format!("({as_good}) && ({better})"))
        };
        self.function("is_worse_champion(champion: Champion, other: Champion) -> bool", &[format!("return {worse};")]);
        self.function("beats_in_the_row(champion: Champion, keys: Keys) -> bool", &[format!("return {beats};")]);
    }

    /// The ends of a tracked value. An input that f32 tells apart is compared as f32 has it, on both sides.
    fn ends(&self, at: usize) -> [String; 2] {
        let value = format!("lane.t{at}");
        match self.plan.tracked[at].0.quantity {
            Quantity::Input(input) if self.is_exact(input) => [format!("{value}.value"), format!("{value}.value")],
            _ => [format!("lower({value})"), format!("upper({value})")],
        }
    }

    fn is_exact(&self, input: usize) -> bool {
        is_exact(self.plan, self.layout, input)
    }

    /// The ends of an objective's coordinate.
    fn key(&self, number: usize, objective: &Objective) -> String {
        let [low, high] = self.ends(self.plan.objectives[number]);
        match self.coordinates[number] {
            Coordinate::Stepped => {
                let resolution = on_device(self.plan, objective.quantity, objective.resolution.expect("steps have a width"));
                let steps = format!("steps({low}, {high}, {})", literal(resolution as f32));
                if objective.goal == Goal::Min { steps } else { format!("(-({steps}).yx)") }
            }
            _ if objective.goal == Goal::Min => format!("vec2<f32>({low}, {high})"),
            _ => format!("vec2<f32>(-{high}, -{low})"),
        }
    }

    /// Top list and extremes. A tie with what is known is lost by the higher index; only a known end that f32 holds shows ties.
    fn others(&mut self) {
        let plan = self.plan;
        let study = &plan.study;
        let (mut may, mut unknown) = ("false".to_owned(), "false".to_owned());
        if let Some(top) = study.report.top {
            let position = plan.tracked.iter().position(|(it, _)| it.quantity == top.by && it.worse == top.goal.worse());
            let [low, high] = self.ends(position.expect("the top list's quantity is tracked"));
            let key = if top.goal == Goal::Min { low } else { format!("-{high}") };
            may = format!("{key} <= horizon.top");
            unknown = format!("!(known.top.y == 1.0 && {key} == known.top.x && wide_less(known.top_index.xy, index))");
        }
        self.function("may_be_top(lane: Lane, horizon: Horizon) -> bool", &[format!("return {may};")]);
        self.function("is_known_top(lane: Lane, horizon: Horizon, index: vec2<u32>) -> bool", &[format!("return !({may} && {unknown});")]);

        let mut may = vec!["var may = false;".to_owned()];
        let mut unknown = may.clone();
        for (number, &position) in plan.objectives.iter().enumerate() {
            let [low, high] = self.ends(position);
            let extremes = format!("known.extremes[{number}]");
            for (end, side, held, exact, index) in [(low, "<=", "x", "z", "xy"), (high, ">=", "y", "w", "zw")] {
                let reaches = format!("{end} {side} horizon.extreme{number}.{held}");
                let tie = format!("{extremes}.{exact} == 1.0 && {end} == {extremes}.{held}");
                may.push(format!("may = may || {reaches};"));
                unknown.push(format!("may = may || ({reaches} && !({tie} && wide_less(known.extreme_indices[{number}].{index}, index)));"));
            }
        }
        may.push("return may;".to_owned());
        unknown.push("return !may;".to_owned());
        self.function("may_be_extreme(lane: Lane, horizon: Horizon) -> bool", &may);
        self.function("is_known_extreme(lane: Lane, horizon: Horizon, index: vec2<u32>) -> bool", &unknown);
        let front = if study.objectives.is_empty() {
            "false"
        } else {
            "!beaten_by_killers(keys_of(lane), horizon) || may_be_extreme(lane, horizon)"
        };
        self.function("may_matter(lane: Lane, horizon: Horizon) -> bool", &[format!("return {front} || may_be_top(lane, horizon);")]);
    }

    /// Histograms, maps and the check's records.
    fn report(&mut self) {
        let plan = self.plan;
        let report = &plan.study.report;
        put!(
            self,
            "// The steps of a resolution that a value may be in.\nfn steps(low: f32, high: f32, resolution: f32) -> vec2<f32> {{\n    \
             let first = low / resolution;\n    let last = high / resolution;\n    \
             return vec2<f32>(floor(first - abs(first) * 1e-6), floor(last + abs(last) * 1e-6));\n}}\n\n\
             // The bin of a value, -1 below the first and `bins` above the last; the bins of both ends of its bound.\n\
             fn bins_of(number: Real, low: Real, per_unit: f32, bins: f32) -> vec2<f32> {{\n    \
             let away = number.bound + low.bound + (abs(number.value) + abs(low.value)) * 2.0 * ROUNDING;\n    \
             let middle = (number.value - low.value) * per_unit;\n    \
             let slack = away * per_unit + abs(middle) * 1e-6 + 1e-30;\n    \
             let bin = clamp(floor(vec2<f32>(middle - slack, middle + slack)), vec2<f32>(-1.0), vec2<f32>(bins));\n    \
             let exact = number.bound == 0.0 && low.bound == 0.0 && number.value == low.value;\n    \
             return select(bin, vec2<f32>(0.0), exact);\n}}\n"
        );
        let mut lines = Vec::new();
        let mut add = Vec::new();
        let mut offset = 3;
        for (number, spec) in report.histograms.iter().enumerate() {
            let worse = crate::plan::worst_end(&plan.study, spec.of);
            let at = plan.tracked.iter().position(|(it, _)| it.quantity == spec.of && it.worse == worse).expect("it is tracked");
            let bins = spec.bins;
            lines.push(format!("let h{number} = bins_of(lane.t{at}, HISTOGRAM_{number}, PER_UNIT_{number}, {bins}.0);"));
            // Where f64 has a value on the upper edge of the last bin, it belongs to that bin: never a sure answer here.
            lines.push(format!("if h{number}.x != h{number}.y || !is_known(lane.t{at}) {{ return false; }}"));
            add.push(format!("atomicAdd(&counts[u32({offset} + i32(h{number}.x) + 1)], 1u);"));
            offset += bins + 2;
        }
        lines.extend(add);
        lines.push("return true;".to_owned());
        self.function("enters_histograms(lane: Lane) -> bool", &lines);

        // The ends of what each map of values shows, as keys: less is better.
        let ends: Vec<[String; 2]> = value_maps(plan)
            .map(|(_, at, goal)| {
                let [best, worst] = if goal == Goal::Min { ["lower", "upper"] } else { ["-upper", "-lower"] };
                [format!("{best}(lane.t{at})"), format!("{worst}(lane.t{at})")]
            })
            .collect();
        let mut lines = vec!["var why = 0u;".to_owned()];
        let mut cell_offset = 0;
        let mut value = 0;
        for (number, spec) in report.maps.iter().enumerate() {
            let terms = self.map_terms(number).into_iter().filter_map(|(stride, count, factor)| {
                let fast = self.layout.fast.iter().position(|it| (it.stride, it.count) == (stride, count))?;
                Some(format!(" + digits.d{fast} * {factor}u"))
            });
            lines.push(format!("let cell{number} = state.cell{number}{};", terms.collect::<String>()));
            let cells = plan.study.design[spec.x].count() * plan.study.design[spec.y].count();
            if spec.value == Best::Share {
                lines.push(format!("atomicAdd(&counts[{offset}u + cell{number}], 1u);"));
                offset += cells as usize;
            } else {
                let [best, worst] = &ends[value];
                lines.push(format!("let best{number} = atomicMin(&cells[{cell_offset}u + cell{number}], ordered({worst}));"));
                lines.push(format!("why |= select(0u, MAY_BE_IN_MAP, ordered({best}) <= best{number});"));
                cell_offset += cells;
                value += 1;
            }
        }
        lines.push("return why;".to_owned());
        self.function("enter_maps(lane: Lane, state: RowState, digits: Digits) -> u32", &lines);
        let keys = ends.iter().flatten().enumerate().map(|(word, end)| format!("survivors[at + {word}u] = bitcast<u32>({end});"));
        self.function("write_map_keys(at: u32, lane: Lane)", &keys.collect::<Vec<_>>());

        let word = |at: usize, value: String| format!("survivors[at + {at}u] = bitcast<u32>({value});");
        let pairs = |names: Vec<String>| -> Vec<String> {
            let both = |(number, name): (usize, String)| {
                [word(2 * number, format!("{name}.value")), word(2 * number + 1, format!("{name}.bound"))]
            };
            names.into_iter().enumerate().flat_map(both).collect()
        };
        let worst = pairs((0..plan.tracked.len()).map(|at| format!("judged.t{at}")).collect());
        self.function("write_worst(at: u32, judged: Lane)", &worst);
        let used = used_outputs(plan);
        let numbers: Vec<usize> = (0..plan.study.model.outputs.len()).filter(|output| used >> output & 1 == 1).collect();
        let mut lines: Vec<_> = numbers.iter().map(|&output| format!("let o{output} = {};", self.promised(output))).collect();
        lines.extend(pairs(numbers.iter().map(|output| format!("o{output}")).collect()));
        self.function("write_asked(at: u32, out: Outputs)", &lines);
    }
}

/// The value that every other one is worse than; its bound is the least.
fn least_bad(worse: Worse) -> String {
    if worse == Worse::Higher { "Real(-infinity(), 0.0)".to_owned() } else { "Real(infinity(), 0.0)".to_owned() }
}

/// Does a value keep to a constraint? The bound is in SI, with what f32 loses of it.
fn keep(plan: &Plan, constraint: &Constraint) -> Vec<String> {
    let mut lines = vec!["var answer = YES;".to_owned()];
    for (bound, towards) in [(constraint.low, 1.0), (constraint.high, -1.0)] {
        let Some((bound, strict)) = bound else { continue };
        let (value, lost) = nearest_f32(on_device(plan, constraint.quantity, bound));
        // The unit is converted in f64, which rounds too; zero stays zero.
        let lost = if value == 0.0 { lost } else { lost + value.abs() * 1e-12 };
        let question = if strict { "above_zero" } else { "at_least_zero" };
        let difference =
            if towards > 0.0 { format!("number.value - {}", literal(value)) } else { format!("{} - number.value", literal(value)) };
        lines.push(format!("{{ let margin = {difference};"));
        lines
            .push(format!("answer = min(answer, {question}(Real(margin, number.bound + {} + abs(margin) * ROUNDING))); }}", literal(lost)));
    }
    lines.push("return answer;".to_owned());
    lines
}

/// Constants of the histograms, whose ranges are known only when the study has been sampled.
pub fn histogram_constants(plan: &Plan, ranges: &[(f64, f64)]) -> String {
    let mut text = String::new();
    for (number, (spec, &(from, to))) in plan.study.report.histograms.iter().zip(ranges).enumerate() {
        let [from, to] = [from, to].map(|end| on_device(plan, spec.of, end));
        let per_unit = (spec.bins as f64 / (to - from)) as f32;
        writeln!(text, "const HISTOGRAM_{number}: Real = {};\nconst PER_UNIT_{number}: f32 = {};", real(from), literal(per_unit))
            .expect("a text takes everything");
    }
    text
}

/// What an objective's f64 key becomes on the device: the least f32 that a design's lower end must reach to be certainly no better
/// (for a coordinate with bounds: certainly worse).
pub fn threshold(plan: &Plan, objective: &Objective, coordinate: Coordinate, key: f64) -> f32 {
    match coordinate {
        // Steps are whole numbers.
        Coordinate::Stepped => round_up(key),
        // The very rounding that the levels had.
        Coordinate::Exact => key as f32,
        Coordinate::Plain => {
            let value = sign(objective.goal) * on_device(plan, objective.quantity, sign(objective.goal) * key);
            round_up(value).next_up()
        }
    }
}

/// The least f32 that is not less.
#[allow(clippy::cast_possible_truncation, reason = "rounded up where it was rounded down")]
pub fn round_up(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}
