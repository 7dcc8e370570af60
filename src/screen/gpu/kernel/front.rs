//! The prelude's part on the front: coordinates of the objectives, what they are compared with, top list and extremes.

use super::*;

impl Prelude<'_> {
    /// Coordinates of the objectives, and what they are compared with.
    pub(super) fn front(&mut self) {
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

        // Dominators and lists hold what a key must reach to be certainly no better; strictly so for a coordinate with bounds.
        let mixed = !self.coordinates.contains(&Coordinate::Plain);
        let compare = |of: &dyn Fn(usize) -> String| {
            let each: Vec<_> = (0..objectives.len()).map(|number| (of(number), format!("keys.k{number}.x"))).collect();
            let behind: Vec<_> = each.iter().map(|(dominator, key)| format!("{dominator} <= {key}")).collect();
            let apart: Vec<_> = each.iter().map(|(dominator, key)| format!("{dominator} < {key}")).collect();
            if mixed { format!("({}) && ({})", behind.join(" && "), apart.join(" || ")) } else { behind.join(" && ") }
        };
        // A uniform is loaded anew wherever it is read: what every lane is compared with is loaded once per invocation.
        put!(self, "struct Horizon {{\n    top: f32,\n    table: vec4<f32>,");
        for number in 0..objectives.len() {
            put!(self, "    extreme{number}: vec2<f32>,");
            (0..DOMINATORS).for_each(|dominator| put!(self, "    n{dominator}_{number}: f32,"));
        }
        put!(self, "}}\n");
        let mut lines = ["var horizon: Horizon;", "horizon.top = known.top.x;", "horizon.table = known.table;"].map(str::to_owned).to_vec();
        for number in 0..objectives.len() {
            lines.push(format!("horizon.extreme{number} = known.extremes[{number}].xy;"));
            lines.extend((0..DOMINATORS).map(|dominator| {
                format!("horizon.n{dominator}_{number} = known.dominators[{}][{}];", 2 * dominator + number / 4, number % 4)
            }));
        }
        lines.push("return horizon;".to_owned());
        self.function("horizon() -> Horizon", &lines);
        let mut dominators = vec!["var beaten = false;".to_owned()];
        if objectives.len() == 2 && !mixed {
            // Along a curve the dominators are sorted: the last one that is not beyond the first coordinate is the best.
            dominators = vec!["var least = infinity();".to_owned()];
            for dominator in 0..DOMINATORS {
                dominators.push(format!("least = select(least, horizon.n{dominator}_1, horizon.n{dominator}_0 <= keys.k0.x);"));
            }
            dominators.push("let beaten = least <= keys.k1.x;".to_owned());
        } else if !objectives.is_empty() {
            for dominator in 0..DOMINATORS {
                let of = |number: usize| format!("horizon.n{dominator}_{number}");
                dominators.push(format!("beaten = beaten || ({});", compare(&of)));
            }
        }
        if self.looks_up_at_once() {
            dominators = vec!["let beaten = false;".to_owned()];
        }
        dominators.push("return beaten;".to_owned());
        self.function("beaten_by_dominators(keys: Keys, horizon: Horizon) -> bool", &dominators);

        let table = if objectives.is_empty() {
            vec!["return false;".to_owned()]
        } else if uses_table(&self.coordinates) {
            let bins = bins(&self.coordinates);
            let bin = |number: usize| {
                let [low, scale] = [["x", "y"], ["z", "w"]][number];
                // The limit is on the whole number: of an undefined f32 a limit may be undefined too.
                format!("min(u32((keys.k{number}.x - horizon.table.{low}) * horizon.table.{scale}), {}u)", bins - 1)
            };
            let last = objectives.len() - 1;
            let at = if last == 1 { bin(0) } else { format!("{} * {bins}u + {}", bin(0), bin(1)) };
            vec![format!("return dominator_table[{at}] < keys.k{last}.x;")]
        } else {
            let of = |number: usize| format!("dominator_table[i * {}u + {number}u]", objectives.len());
            vec![
                format!("for (var i = 0u; i < {LIST}u; i++) {{"),
                format!("    if {} {{ return true; }}", compare(&of)),
                "}".to_owned(),
                "return false;".to_owned(),
            ]
        };
        self.function("beaten_by_table(keys: Keys, horizon: Horizon) -> bool", &table);

        let mut front = vec!["return false;".to_owned()];
        if looks_through_front(&self.coordinates) {
            let first = bins(&self.coordinates);
            let point = |at: &str, number: usize| format!("dominator_table[{}u + 2u * {at}]", first + number as u64);
            // Of all points that are not beyond the first coordinate the last one has the least second coordinate.
            front = vec![
                "var low = 0u;".to_owned(),
                "var high = known.points.x;".to_owned(),
                "while low < high {".to_owned(),
                "    let middle = (low + high) / 2u;".to_owned(),
                format!("    if {} <= keys.k0.x {{ low = middle + 1u; }} else {{ high = middle; }}", point("middle", 0)),
                "}".to_owned(),
                "if low == 0u { return false; }".to_owned(),
                format!("return {};", compare(&|number| point("(low - 1u)", number))),
            ];
        }
        self.function("beaten_by_front(keys: Keys) -> bool", &front);

        // Upper ends of the objectives that differ within a row.
        let differing: Vec<usize> = (0..objectives.len()).filter(|&at| !plan.tracked[plan.objectives[at]].1.is_row()).collect();
        put!(self, "struct RowDominator {{");
        differing.iter().for_each(|at| put!(self, "    u{at}: f32,"));
        if differing.is_empty() {
            put!(self, "    none: f32,");
        }
        put!(self, "}}\n");
        let parts = |part: &dyn Fn(usize) -> String, none: &str| {
            if differing.is_empty() { none.to_owned() } else { differing.iter().map(|&at| part(at)).collect::<Vec<_>>().join(", ") }
        };
        let none = format!("return RowDominator({});", parts(&|_| "infinity()".to_owned(), "0.0"));
        self.function("no_row_dominator() -> RowDominator", &[none]);
        let of = format!("return RowDominator({});", parts(&|at| format!("keys.k{at}.y"), "0.0"));
        self.function("row_dominator_of(keys: Keys) -> RowDominator", &[of]);
        let all = |compare: &dyn Fn(usize) -> String, with: &str| differing.iter().map(|&at| compare(at)).collect::<Vec<_>>().join(with);
        let (worse, beats) = if differing.is_empty() {
            ("false".to_owned(), "false".to_owned())
        } else {
            let as_good = all(&|at| format!("row_dominator.u{at} <= keys.k{at}.x"), " && ");
            let better = all(&|at| format!("row_dominator.u{at} < keys.k{at}.x"), " || ");
            (all(&|at| format!("other.u{at} <= row_dominator.u{at}"), " && "), format!("({as_good}) && ({better})"))
        };
        self.function("is_worse_row_dominator(row_dominator: RowDominator, other: RowDominator) -> bool", &[format!("return {worse};")]);
        self.function("beats_in_the_row(row_dominator: RowDominator, keys: Keys) -> bool", &[format!("return {beats};")]);
    }

    /// The ends of a tracked value. An input that f32 tells apart is compared as f32 has it, on both sides.
    pub(super) fn ends(&self, at: usize) -> [String; 2] {
        let value = format!("lane.t{at}");
        match self.plan.tracked[at].0.quantity {
            Quantity::Input(input) if self.is_exact(input) => [format!("{value}.value"), format!("{value}.value")],
            _ => [format!("lower({value})"), format!("upper({value})")],
        }
    }

    pub(super) fn is_exact(&self, input: usize) -> bool {
        is_exact(self.plan, self.layout, input)
    }

    /// The ends of an objective's coordinate.
    pub(super) fn key(&self, number: usize, objective: &Objective) -> String {
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

    /// Do all lanes meet the look-up table? Where runs have settled what is far behind the front, some dominators beat few of the others.
    fn looks_up_at_once(&self) -> bool {
        self.layout.runs.is_some() && uses_table(&self.coordinates)
    }

    /// Top list and extremes. A tie with what is known is lost by the higher index; only a known end that f32 holds shows ties.
    pub(super) fn others(&mut self) {
        let plan = self.plan;
        let study = &plan.study;
        let (mut may, mut unknown) = ("false".to_owned(), "false".to_owned());
        if let Some(top) = study.report.top {
            let [low, high] = self.ends(plan.position(top.by, top.goal.worse()));
            let key = if top.goal == Goal::Min { low } else { format!("-{high}") };
            may = format!("{key} <= horizon.top");
            unknown = format!("!(known.top.y == 1.0 && {key} == known.top.x && wide_less(known.top_index.xy, index))");
        }
        self.function("may_be_top(lane: Lane, horizon: Horizon) -> bool", &[format!("return {may};")]);
        self.function("is_known_top(lane: Lane, horizon: Horizon, index: vec2<u32>) -> bool", &[format!("return !({may} && {unknown});")]);

        let mut lines = vec!["return false;".to_owned()];
        if study.report.feasible {
            lines = vec!["return true;".to_owned()];
        } else if let Some(sample) = study.report.sample {
            lines = vec!["var place = index;".to_owned()];
            lines.extend(Shuffle::new(sample.seed).keys.map(|key| format!("place = shuffled(place, {key}u);")));
            lines.push("return !wide_less(known.last_place.xy, place);".to_owned());
        }
        self.function("may_be_sampled(index: vec2<u32>) -> bool", &lines);

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
        } else if self.looks_up_at_once() {
            "!beaten_by_table(keys_of(lane), horizon) || may_be_extreme(lane, horizon)"
        } else {
            "!beaten_by_dominators(keys_of(lane), horizon) || may_be_extreme(lane, horizon)"
        };
        self.function("may_matter(lane: Lane, horizon: Horizon) -> bool", &[format!("return {front} || may_be_top(lane, horizon);")]);
    }
}
