//! The prelude's part on histograms, maps and the records of the comparison with f64.

use super::*;

impl Prelude<'_> {
    /// Histograms, maps and the check's records.
    pub(super) fn report(&mut self) {
        let plan = self.plan;
        let report = &plan.study.report;
        let mut lines = Vec::new();
        let mut add = Vec::new();
        let mut offset = FIRST_REPORTED as usize;
        for (number, spec) in report.histograms.iter().enumerate() {
            let worse = crate::plan::worst_end(&plan.study, spec.of);
            let at = plan.position(spec.of, worse);
            let bins = spec.bins;
            lines.push(format!("let h{number} = bins_of(lane.t{at}, HISTOGRAM_{number}, PER_UNIT_{number}, {bins}.0);"));
            // Where f64 has a value on the upper edge of the last bin, it belongs to that bin: never a sure answer here.
            lines.push(format!("if h{number}.x != h{number}.y || !is_known(lane.t{at}) {{ return false; }}"));
            // An undefined bin, which a comparison need not notice, must not become a place outside the counts.
            add.push(format!("atomicAdd(&counts[{offset}u + min(u32(h{number}.x + 1.0), {}u)], 1u);", bins + 1));
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
        let numbers: Vec<usize> = plan.used_outputs().iter().collect();
        let mut lines: Vec<_> = numbers.iter().map(|&output| format!("let o{output} = {};", self.bounded(output))).collect();
        lines.extend(pairs(numbers.iter().map(|output| format!("o{output}")).collect()));
        self.function("write_asked(at: u32, out: Outputs)", &lines);
    }
}
