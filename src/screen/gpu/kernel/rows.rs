//! The prelude's part on rows: their inputs, what passes between the stages, what all lanes of a row share.

use super::*;

/// An arithmetic in which inputs are given.
#[derive(Clone, Copy)]
pub(super) struct Stage {
    /// What the names of its functions end with.
    name: &'static str,
    /// The function that makes a number of a level's entry.
    level: &'static str,
    /// A number as a literal.
    number: fn(f64) -> String,
}

/// The position of a row along a slow dimension. The outermost digit counts from the window's first level.
fn slow_digit(number: usize) -> String {
    let base = if number == 0 { " + tile.window" } else { "" };
    format!("(digits[{number}]{base})")
}

impl Prelude<'_> {
    /// f32, then f64 if that is what the first stage computes in.
    fn stages(&self) -> Vec<Stage> {
        let single = Stage { name: "", level: "level", number: real };
        let double = Stage { name: "_64", level: "level_64", number: |value| format!("constant_64({value:?})") };
        if self.f64 { vec![single, double] } else { vec![single] }
    }

    /// Fixed inputs and scenarios.
    pub(super) fn inputs(&mut self) {
        let plan = self.plan;
        let model = &plan.study.model;
        // Inputs that a stage does not depend on still decide selections: every one has a value of its own axis.
        let first = crate::models::to_si(model, &plan.space.inputs(0, 0));
        for Stage { name, level: _, number } in self.stages() {
            let mut lines = vec![format!("var inputs: Inputs{name};")];
            for (input, &value) in first.iter().enumerate().take(model.inputs.len()) {
                lines.push(format!("inputs.{} = {};", self.input(input), number(value)));
            }
            lines.push("return inputs;".to_owned());
            self.function(&format!("fixed_inputs{name}() -> Inputs{name}"), &lines);
        }
        for (name, table) in [("slow", &self.layout.slow_scenarios), ("fast", &self.layout.fast_scenarios)] {
            let columns = table.inputs.len();
            for Stage { name: stage, level, .. } in self.stages() {
                let set = |(column, &input): (usize, &usize)| {
                    let entry = format!("steady[{}u + scenario * {columns}u]", table.offset as usize + column);
                    format!("(*inputs).{} = {level}({entry});", self.input(input))
                };
                let lines: Vec<_> = table.inputs.iter().enumerate().map(set).collect();
                self.function(&format!("set_{name}_scenario{stage}(inputs: ptr<function, Inputs{stage}>, scenario: u32)"), &lines);
            }
        }
    }

    /// From a row's number to its place, inputs and index.
    pub(super) fn rows(&mut self) {
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
        let mut set = Vec::new();
        let mut allowed = vec!["var allowed = 1.0;".to_owned()];
        let mut index = vec!["var index = tile.index;".to_owned()];
        for (number, dimension) in slow.iter().enumerate() {
            for (column, &input) in dimension.inputs.iter().enumerate() {
                let entry = entry(number, column);
                set.push((self.input(input), entry.clone()));
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
        for Stage { name, level, .. } in self.stages() {
            let lines: Vec<_> = set.iter().map(|(input, entry)| format!("(*inputs).{input} = {level}({entry});")).collect();
            self.function(&format!("set_row{name}(inputs: ptr<function, Inputs{name}>, digits: array<u32, DIMENSIONS>)"), &lines);
        }
        self.function("is_allowed(digits: array<u32, DIMENSIONS>) -> bool", &allowed);
        self.function("index_of_row(digits: array<u32, DIMENSIONS>) -> vec2<u32>", &index);
    }

    /// Values of the first stage, and what all lanes of a row share.
    pub(super) fn passing(&mut self) {
        let (plan, layout) = (self.plan, self.layout);
        let fields = layout.fields;
        let width = layout.prepared_width();
        let place = format!("q * {width}u * tile.rows + row");
        let at = |offset: usize| format!("prepared_table[{place} + {offset}u * tile.rows]");
        let mut store = Vec::new();
        let mut load = vec!["var prepared: Prepared;".to_owned()];
        for passed in &layout.prepared {
            let offset = passed.offset;
            // Tables were stored number by number while they were made.
            if let Some(name) = fields.prepared.get(passed.field) {
                store.push(format!("{} = prepared.{name};", at(offset)));
                load.push(format!("prepared.{name} = {};", at(offset)));
            }
        }
        let mut begin = Vec::new();
        if !fields.tables.is_empty() {
            load.push(format!("prepared.place = {place};"));
            begin.push(format!("table_place = {place};"));
        }
        self.function("begin_prepared(q: u32, row: u32)", &begin);
        let stage = self.stages().last().expect("the first stage has an arithmetic").name;
        let mut lines = vec![
            format!("var inputs = fixed_inputs{stage}();"),
            format!("set_row{stage}(&inputs, digits_of_row(row));"),
            format!("set_slow_scenario{stage}(&inputs, q);"),
        ];
        if stage.is_empty() {
            lines.push("return prepare(inputs);".to_owned());
        } else {
            lines.push("let exact = prepare_64(inputs);".to_owned());
            lines.push("var prepared: Prepared;".to_owned());
            let names = layout.prepared.iter().filter_map(|passed| fields.prepared.get(passed.field));
            lines.extend(names.map(|name| format!("prepared.{name} = narrowed(exact.{name});")));
            lines.push("return prepared;".to_owned());
        }
        self.function("prepare_row(q: u32, row: u32) -> Prepared", &lines);
        load.push("return prepared;".to_owned());
        self.function("store_prepared(q: u32, row: u32, prepared: Prepared)", &store);
        self.function("load_prepared(q: u32, row: u32) -> Prepared", &load);
        let hold = if layout.slow_scenarios.count == 1 { "return load_prepared(0u, row);" } else { "var none: Prepared; return none;" };
        self.function("hold_prepared(row: u32) -> Prepared", &[hold.to_owned()]);

        // Verdict, index, cell of each map, tracked values, inputs.
        let tracked: Vec<usize> = (0..plan.tracked.len()).filter(|&at| plan.tracked[at].1.is_row()).collect();
        let maps = plan.study.report.maps.len();
        put!(self, "struct RowState {{\n    verdict: u32,\n    index: vec2<u32>,");
        (0..maps).for_each(|map| put!(self, "    cell{map}: u32,"));
        if layout.sorted.is_some() {
            put!(self, "    // Where its lanes begin among the sorted ones.");
            put!(self, "    column: u32,");
        }
        tracked.iter().for_each(|at| put!(self, "    t{at}: Real,"));
        layout.row_inputs.iter().for_each(|&input| put!(self, "    {}: Real,", self.input(input)));
        put!(self, "}}\n");
        let mut words = vec!["verdict".to_owned(), "index.x".to_owned(), "index.y".to_owned()];
        words.extend((0..maps).map(|map| format!("cell{map}")));
        words.extend(layout.sorted.iter().map(|_| "column".to_owned()));
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
        if let Some(sorted) = &layout.sorted {
            let terms = sorted.dimensions.iter().map(|&(number, distance)| format!("{} * {distance}u", slow_digit(number)));
            start.push(format!("state.column = {};", terms.reduce(|a, b| format!("{a} + {b}")).unwrap_or_else(|| "0u".to_owned())));
        }
        for &at in &tracked {
            start.push(format!("state.t{at} = {};", self.row_start(at)));
        }
        start.extend(layout.row_inputs.iter().map(|&input| format!("state.{0} = inputs.{0};", self.input(input))));
        start.push("return state;".to_owned());
        self.function("start_row(digits: array<u32, DIMENSIONS>, inputs: Inputs) -> RowState", &start);
    }

    /// What a row adds to the number of a map's cell.
    pub(super) fn cell_of_row(&self, map: usize) -> String {
        let terms = self.map_terms(map).into_iter().filter_map(|(stride, count, factor)| {
            let number = self.layout.slow.iter().position(|it| (it.stride, it.count) == (stride, count))?;
            Some(format!("{} * {factor}u", slow_digit(number)))
        });
        let terms: Vec<_> = terms.collect();
        if terms.is_empty() { "0u".to_owned() } else { terms.join(" + ") }
    }

    /// Of each axis of a map: its stride in the design index and its length, which together tell it from the others (an axis of one
    /// value has the stride of its neighbour), and what a step along it adds to the cell's number.
    pub(super) fn map_terms(&self, map: usize) -> [(u64, u64, u64); 2] {
        let study = &self.plan.study;
        let spec = &study.report.maps[map];
        let stride = |axis: usize| study.design[axis + 1..].iter().map(crate::study::Axis::count).product::<u64>();
        let [x, y] = [spec.x, spec.y].map(|axis| (stride(axis), study.design[axis].count()));
        [(x.0, x.1, 1), (y.0, y.1, x.1)]
    }

    /// The value of a row's tracked quantity before any scenario.
    pub(super) fn row_start(&self, at: usize) -> String {
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
    pub(super) fn own_value(&self, input: usize, entry: &str) -> String {
        if self.layout.represented.contains(input) { format!("constant({entry})") } else { format!("near({entry})") }
    }
}
