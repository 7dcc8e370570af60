//! What is the same for all designs of a row, kept per scenario for the rows that share it: of the slow axes, those that the first stage
//! does not read are often read by nothing that is the same for the whole row either.

use crate::plan::Plan;
use crate::tape::Set;

/// Most numbers that are kept.
const MOST: u64 = 1 << 16;

/// Condition margins and outputs of the rows that have their slow inputs in common, as far as these are read.
#[derive(Debug)]
pub(super) struct KeptRows {
    /// Slow inputs that decide them.
    reads: Set,
    conditions: Vec<usize>,
    outputs: Vec<usize>,
    fast_scenarios: u64,
    /// Of each scenario: is it known? Empty if nothing is to be kept.
    known: Vec<bool>,
    numbers: Vec<f64>,
}

impl KeptRows {
    /// For rows of a plan; nothing is known yet.
    pub(super) fn new(plan: &Plan) -> Self {
        let (conditions, outputs) = (plan.row_conditions.clone(), plan.row_outputs.iter().collect::<Vec<_>>());
        let of_conditions = conditions.iter().map(|&it| plan.dependencies.conditions[it]);
        let of_outputs = outputs.iter().map(|&it| plan.dependencies.outputs[it]);
        let slow = plan.slow.inputs();
        let reads = of_conditions.chain(of_outputs).fold(plan.dependencies.prepared, |set, it| set | it) & slow;
        let numbers = plan.scenarios().saturating_mul((conditions.len() + outputs.len()) as u64);
        let serves = !(slow - reads).is_empty() && numbers > 0 && numbers <= MOST;
        let [scenarios, numbers] = [plan.scenarios(), numbers].map(|count| if serves { count as usize } else { 0 });
        let fast_scenarios = plan.fast_scenarios.count();
        Self { reads, conditions, outputs, fast_scenarios, known: vec![false; scenarios], numbers: vec![0.0; numbers] }
    }

    /// Another row begins: forgets everything if an input that is read has changed.
    pub(super) fn turn(&mut self, before: &[f64], now: &[f64]) {
        if self.reads.iter().any(|input| before[input] != now[input]) {
            self.known.fill(false);
        }
    }

    /// Where the numbers of a slow and a fast scenario stand.
    fn place(&self, (slow, fast): (u64, u64)) -> (usize, usize) {
        let scenario = (slow * self.fast_scenarios + fast) as usize;
        (scenario, scenario * (self.conditions.len() + self.outputs.len()))
    }

    /// Writes the margins and outputs of a scenario, if they are known.
    pub(super) fn recall(&self, scenario: (u64, u64), margins: &mut [f64], outputs: &mut [f64]) -> bool {
        let (scenario, first) = self.place(scenario);
        if !self.known.get(scenario).is_some_and(|known| *known) {
            return false;
        }
        let (of_conditions, of_outputs) = self.numbers[first..].split_at(self.conditions.len());
        self.conditions.iter().zip(of_conditions).for_each(|(&to, &margin)| margins[to] = margin);
        self.outputs.iter().zip(of_outputs).for_each(|(&to, &output)| outputs[to] = output);
        true
    }

    /// Keeps the margins and outputs of a scenario.
    pub(super) fn keep(&mut self, scenario: (u64, u64), margins: &[f64], outputs: &[f64]) {
        let (scenario, first) = self.place(scenario);
        let Some(known) = self.known.get_mut(scenario) else { return };
        *known = true;
        let numbers = self.conditions.iter().map(|&it| margins[it]).chain(self.outputs.iter().map(|&it| outputs[it]));
        self.numbers[first..].iter_mut().zip(numbers).for_each(|(to, number)| *to = number);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CpuEngine, Tables};
    use super::*;
    use crate::study::study_of;

    /// The outermost of the fast axes is too much for a table: it is walked with the slow one, and nothing of the row depends on it.
    const STUDY: &str = r#"
        [design]
        groove_angle_deg  = [18, 22, 26]
        band_thickness_mm = { from = 0.10, to = 0.30, count = 200 }
        band_count        = { from = 4, to = 14 }
        band_width_mm     = { from = 6, to = 12, count = 20 }
        [operation]
        ratio     = [0.6, 1.7]
        torque_Nm = [50, 90]
        [constraints]
        stress_margin = { min = 0 }
        [objectives]
        axial_force_N = "min"
        stress_margin = "max"
    "#;

    fn plan() -> Plan {
        let plan = Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), STUDY).expect("the study is right"));
        assert_eq!((plan.slow.count(), plan.fast.count()), (600, 220));
        plan
    }

    /// Feasible designs with their worst values.
    fn judged(engine: &mut CpuEngine<'_>, width: u64, rows: impl Iterator<Item = u64>) -> Vec<(u64, [u64; 2])> {
        let mut found = Vec::new();
        for row in rows {
            engine.screen(row * width..(row + 1) * width, |block| {
                found.extend(block.feasible().map(|lane| (block.index(lane), [0, 1].map(|at| block.column(at)[lane].to_bits()))));
            });
        }
        found
    }

    #[test]
    fn rows_that_share_what_is_kept_have_the_answers_of_rows_judged_alone() {
        let plan = plan();
        let tables = Tables::new(&plan);
        let width = plan.fast.count();
        let rows = || (0..plan.slow.count()).map(|row| row * 7 % plan.slow.count()).chain(190..410);
        let alone: Vec<_> = rows().flat_map(|row| judged(&mut CpuEngine::new(&plan, &tables), width, std::iter::once(row))).collect();
        let mut engine = CpuEngine::new(&plan, &tables);
        assert!(alone.len() > 10_000 && judged(&mut engine, width, rows()) == alone);
        // Were an input forgotten that is read, another groove would have the forces of the one before.
        engine.kept_rows.reads = Set::EMPTY;
        assert!(judged(&mut engine, width, rows()) != alone);
    }

    #[test]
    fn a_scenario_is_known_until_an_input_changes_that_is_read() {
        let plan = plan();
        let input = |name: &str| plan.study.model.input(name).expect("it is an input");
        let (read, other) = (input("groove_angle_deg"), input("band_thickness_mm"));
        let mut kept = KeptRows::new(&plan);
        let [mut margins, mut outputs] = [vec![0.5; 100], vec![7.0; 100]];
        kept.keep((1, 0), &margins, &outputs);
        let before = vec![1.0; plan.study.model.inputs.len()];
        let mut recalled = |kept: &KeptRows, scenario| {
            [&mut margins, &mut outputs].into_iter().for_each(|it| it.fill(0.0));
            kept.recall(scenario, &mut margins, &mut outputs).then(|| (margins[plan.row_conditions[0]], outputs[kept.outputs[0]]))
        };
        assert_eq!((recalled(&kept, (1, 0)), recalled(&kept, (0, 1)), recalled(&kept, (1, 1))), (Some((0.5, 7.0)), None, None));
        let with = |input: usize| {
            let mut now = before.clone();
            now[input] = 2.0;
            now
        };
        kept.turn(&before, &with(other));
        assert_eq!(recalled(&kept, (1, 0)), Some((0.5, 7.0)));
        kept.turn(&before, &with(read));
        assert_eq!(recalled(&kept, (1, 0)), None);
    }
}
