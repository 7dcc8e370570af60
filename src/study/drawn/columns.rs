//! Many draws of one design at once, by the recorded formula of the drive: which of them hold, and what they are in all cases.

use super::super::quantity::Quantity;
use super::super::resolved::Constraint;
use super::drive::{DrawnDrive, needs};
use super::statistic::{AskedQuantity, Statistic, StatisticKind};
use super::tracks::{CaseFold, IN, keep_folds};
use crate::masks::{keep_between, keep_finite, keep_margin, keep_marked, mask};
use crate::models::{Worse, input_to_si};
use crate::probability::Effect;
use crate::tape::{CHUNK, ColumnValue, Known, LIST_CHUNK, List, ListColumns, Set};

/// Most draws computed together, and most numbers in memory for each of them.
pub const BLOCK: usize = 8192;
const MOST_NUMBERS: usize = 512;
/// Most operations of a formula: each has a column of its own.
pub(super) const MOST_OPERATIONS: usize = 1000;

/// What is asked of every draw besides whether it holds.
#[derive(Debug, Default)]
pub struct AskedDraws {
    /// Is this constraint kept?
    pub keeping: Vec<Constraint>,
    /// What is this quantity over the cases?
    pub quantities: Vec<AskedQuantity>,
}

/// What came of some draws, one entry per draw.
#[derive(Debug)]
pub struct DrawnBlock {
    /// All ones where it holds, else zero.
    pub holds: Vec<u64>,
    /// The same of each constraint of [`AskedDraws::keeping`].
    pub kept: Vec<Vec<u64>>,
    /// The values of [`AskedDraws::quantities`]; NaN where there is none.
    pub values: Vec<Vec<f64>>,
}

/// The formula of a drive as a list of operations over draws.
#[derive(Debug)]
pub struct DrawColumns {
    list: List,
    drawn: Set,
    /// The quantities that are read, each once; outputs among them by place.
    quantities: Vec<Quantity>,
    outputs: Vec<(usize, usize)>,
    conditions: Vec<ListedCondition>,
    keeping: Vec<Constraint>,
    asked: Vec<AskedQuantity>,
    /// What is folded over the cases: what is asked for, then both ends of what constraints on a mean or sum are of.
    folded: Vec<AskedQuantity>,
}

/// A condition of the drive that matters.
#[derive(Debug)]
struct ListedCondition {
    /// Its result in the list.
    result: usize,
    strict: bool,
    /// Does a draw that fails it not hold? Quiet conditions only take values away.
    is_status: bool,
    /// Places of the quantities that have no value where it fails.
    takes: Vec<usize>,
}

impl AskedDraws {
    /// What statistics need.
    pub fn of(statistics: &[Statistic]) -> Self {
        let keeping = |it: &Statistic| if let StatisticKind::YieldOf(constraint) = it.kind { Some(constraint) } else { None };
        Self {
            keeping: statistics.iter().filter_map(keeping).collect(),
            quantities: statistics.iter().filter_map(|it| it.kind.asked()).collect(),
        }
    }
}

impl DrawnBlock {
    /// Of no draw.
    pub fn new(asked: &AskedDraws) -> Self {
        Self { holds: Vec::new(), kept: vec![Vec::new(); asked.keeping.len()], values: vec![Vec::new(); asked.quantities.len()] }
    }

    /// Is what came of a draw also what came of one of another block? To the bit, but for the sign of zero, which no statistic has.
    pub fn is_same(&self, draw: usize, other: &Self, of_other: usize) -> bool {
        let [own, others] = [(self, draw), (other, of_other)].map(|(block, draw)| {
            let masks = [&block.holds].into_iter().chain(&block.kept).map(move |it| it[draw]);
            // What has no value is a NaN, whichever.
            masks.chain(block.values.iter().map(move |it| if it[draw].is_nan() { u64::MAX } else { (it[draw] + 0.0).to_bits() }))
        });
        own.eq(others)
    }
}

impl DrawColumns {
    /// `None` if the formula cannot be recorded, or a draw needs more than [`MOST_NUMBERS`].
    pub fn new(kernel: &DrawnDrive, asked: &AskedDraws) -> Option<Self> {
        let base = &kernel.base;
        let formula = base.kernel.formula()?;
        // Written out, the loops that fill tables are a hundred thousand operations: recording them takes 40 MB.
        if !formula.fields().tables.is_empty() {
            return None;
        }
        let constraints = || kernel.holds.iter().chain(&asked.keeping);
        let mut quantities: Vec<Quantity> = Vec::new();
        for quantity in constraints().map(|it| it.quantity).chain(asked.quantities.iter().map(|it| it.quantity)) {
            if !quantities.contains(&quantity) {
                quantities.push(quantity);
            }
        }
        let (outputs, conditions) = needs(base, quantities.iter().copied());
        let known = vec![Known::ANY; base.inputs.len()];
        let whole = formula.whole(&known, outputs, conditions);
        let list = whole.list(outputs, conditions);
        if list.operations.len() > MOST_OPERATIONS {
            return None;
        }
        let listed = |number: usize| {
            let condition = &base.conditions[number];
            let takes = |at: &usize| quantities[*at].output().is_some_and(|it| condition.invalidates.contains(&base.outputs[it].name));
            ListedCondition {
                result: whole.outputs.len() + number,
                strict: condition.strict,
                is_status: !condition.quiet,
                takes: (0..quantities.len()).filter(takes).collect(),
            }
        };
        let mut folded = asked.quantities.clone();
        for constraint in constraints().filter(|it| !it.over.is_worst()) {
            for ends in both_ends(constraint) {
                if !folded.contains(&ends) {
                    folded.push(ends);
                }
            }
        }
        let found = Self {
            conditions: conditions.iter().map(listed).collect(),
            outputs: quantities.iter().enumerate().filter_map(|(at, it)| Some((at, it.output()?))).collect(),
            drawn: kernel.drawn.iter().map(|it| it.0).collect(),
            keeping: asked.keeping.clone(),
            asked: asked.quantities.clone(),
            list,
            quantities,
            folded,
        };
        (found.numbers(kernel) <= MOST_NUMBERS).then_some(found)
    }

    /// Numbers in memory for each draw of a block.
    fn numbers(&self, kernel: &DrawnDrive) -> usize {
        let sums = kernel.cases.weights.as_ref().map_or(0, |it| it.sums);
        // A quantity has a value and a mask; a fold has these and its sums.
        2 * (kernel.drawn.len() + self.quantities.len()) + self.folded.len() * (2 + sums) + self.keeping.len() + 4
    }

    /// About how many bytes so many draws of a design take.
    pub fn bytes(&self, kernel: &DrawnDrive, draws: usize) -> u64 {
        // About four operations share a column.
        let columns = LIST_CHUNK * self.list.operations.len() / 4;
        8 * (draws.min(BLOCK) * self.numbers(kernel) + columns) as u64
    }

    /// Computes draws (a column per drawn input) of a design, given its inputs in SI units. Every draw has the bits that it has when computed
    /// alone.
    pub fn run(&self, kernel: &DrawnDrive, design: &[f64], columns: &[&[f64]]) -> DrawnBlock {
        let base = &kernel.base;
        let draws = columns.first().map_or(0, |it| it.len());
        let mut running = ListColumns::new(&self.list);
        let results = self.conditions.iter().map(|it| it.result).chain(self.outputs.iter().map(|it| it.1));
        running.turn_to(&self.list, results, |input| self.drawn.contains(input.into()));
        let mut found = DrawnBlock {
            holds: vec![IN; draws],
            kept: vec![vec![IN; draws]; self.keeping.len()],
            values: vec![Vec::new(); self.asked.len()],
        };
        let mut folds = self.begin(kernel, draws);
        let mut actual: Vec<Vec<f64>> = vec![vec![0.0; draws]; columns.len()];
        let mut values: Vec<Vec<f64>> = vec![vec![0.0; draws]; self.quantities.len()];
        let mut present: Vec<Vec<u64>> = vec![vec![IN; draws]; self.quantities.len()];
        let (mut built, mut built_in_all, mut ok) = (vec![IN; draws], vec![IN; draws], vec![IN; draws]);
        let mut si = design.to_vec();
        let mut room = vec![0.0; CHUNK];
        for (case, row) in kernel.cases.rows.iter().enumerate() {
            si.copy_from_slice(design);
            for (&input, &value) in kernel.cases.inputs.iter().zip(row) {
                si[input] = input_to_si(&base.inputs[input], value);
            }
            built.fill(IN);
            for ((&(input, effect), drawn), actual) in kernel.drawn.iter().zip(columns).zip(&mut actual) {
                for ((to, drawn), built) in actual.iter_mut().zip(*drawn).zip(&mut built) {
                    *to = kernel.actual((input, effect), if effect == Effect::Is { 0.0 } else { si[input] }, *drawn);
                    *built &= mask(kernel.fits(input, *to));
                }
            }
            keep_marked(&mut built_in_all, &built);
            ok.copy_from_slice(&built);
            present.iter_mut().for_each(|it| it.copy_from_slice(&built));
            let place = |input: usize| kernel.drawn.iter().position(|it| it.0 == input);
            let of_input =
                |input: u16| place(input.into()).map_or(ColumnValue::One(si[input as usize]), |at| ColumnValue::Each(&actual[at]));
            running.run(&self.list, draws, of_input, |running, first, length| {
                let chunk = first..first + length;
                let mut column = |result: usize, take: &mut dyn FnMut(&[f64])| match running.result(&self.list, result) {
                    ColumnValue::Each(values) => take(values),
                    ColumnValue::One(value) => {
                        room[..length].fill(value);
                        take(&room[..length]);
                    }
                };
                for condition in &self.conditions {
                    column(condition.result, &mut |margins| {
                        if condition.is_status {
                            keep_margin(&mut ok[chunk.clone()], margins, condition.strict);
                        }
                        condition.takes.iter().for_each(|&at| keep_margin(&mut present[at][chunk.clone()], margins, condition.strict));
                    });
                }
                for &(at, output) in &self.outputs {
                    let unit = base.outputs[output].unit;
                    let to = &mut values[at][chunk.clone()];
                    column(output, &mut |from| to.iter_mut().zip(from).for_each(|(to, from)| *to = unit.from_si(*from)));
                }
            });
            for ((quantity, values), present) in self.quantities.iter().zip(&mut values).zip(&mut present) {
                if let Quantity::Input(input) = *quantity {
                    let unit = base.inputs[input].unit;
                    match place(input) {
                        Some(at) => values.iter_mut().zip(&actual[at]).for_each(|(to, from)| *to = unit.from_si(*from)),
                        None => values.fill(unit.from_si(si[input])),
                    }
                }
                keep_finite(present, values);
                values.iter_mut().zip(present).for_each(|(value, present)| *value = if *present == 0 { f64::NAN } else { *value });
            }
            keep_marked(&mut found.holds, &ok);
            self.keep(kernel, &mut found, |constraint, alive| {
                if constraint.over.is_worst() {
                    let (low, high) = constraint.ends();
                    keep_between(alive, &values[self.place(constraint.quantity)], low, high);
                }
            });
            for fold in &mut folds {
                let sum = kernel.cases.weights.as_ref().filter(|_| !fold.asked.over.is_worst()).map(|it| it.places[case]);
                fold.take(&values[self.place(fold.asked.quantity)], sum);
            }
        }
        let total = kernel.cases.weights.as_ref().map_or(1.0, |it| it.total);
        folds.iter_mut().for_each(|it| it.end(draws, total, &built_in_all));
        self.keep(kernel, &mut found, |constraint, alive| {
            if !constraint.over.is_worst() {
                let fold = |asked| self.folded.iter().position(|it| *it == asked).expect("both ends are folded");
                keep_folds(alive, constraint, both_ends(constraint).map(fold), &folds);
            }
        });
        for (to, fold) in found.values.iter_mut().zip(folds) {
            let value = |(value, present): (f64, u64)| if present == 0 { f64::NAN } else { value };
            *to = fold.result.into_iter().zip(fold.present).map(value).collect();
        }
        found
    }

    /// The folds before the first case.
    fn begin(&self, kernel: &DrawnDrive, draws: usize) -> Vec<CaseFold> {
        let sums = kernel.cases.weights.as_ref().map_or(0, |it| it.sums);
        let fold = |&asked: &AskedQuantity| {
            let sums = if asked.over.is_worst() { 0 } else { sums };
            let mut fold = CaseFold { asked, present: vec![0; draws], result: vec![0.0; draws], sums: vec![vec![0.0; draws]; sums] };
            fold.begin(draws);
            fold
        };
        self.folded.iter().map(fold).collect()
    }

    fn place(&self, quantity: Quantity) -> usize {
        self.quantities.iter().position(|it| *it == quantity).expect("all that is read is listed")
    }

    /// Takes out of every mask the draws that do not keep its constraints.
    fn keep(&self, kernel: &DrawnDrive, found: &mut DrawnBlock, keep: impl Fn(&Constraint, &mut [u64])) {
        kernel.holds.iter().for_each(|constraint| keep(constraint, &mut found.holds));
        self.keeping.iter().zip(&mut found.kept).for_each(|(constraint, kept)| keep(constraint, kept));
    }
}

/// What a constraint on a mean or sum is of: both ends of it must keep it.
fn both_ends(constraint: &Constraint) -> [AskedQuantity; 2] {
    [Worse::Lower, Worse::Higher].map(|worse| AskedQuantity { quantity: constraint.quantity, over: constraint.over, worse })
}

#[cfg(test)]
mod tests {
    use super::super::confirm::FreshDraws;
    use super::super::fold::{of_any, over_draws};
    use super::super::kernel::{DrawnKernel, TOGETHER};
    use super::super::lanes::tests::STUDIES;
    use super::super::probability::Probability;
    use super::*;
    use crate::masks::count;
    use crate::models::Kernel;
    use crate::study::Study;

    /// Draws that cannot be built, shares of single constraints, quantities that some draws have no value of.
    const ABSENCES: &str = r#"model = "rubber-cvt"
        [design]
        belt_width_mm = { from = 35, to = 60, count = 50 }
        belt_thickness_mm = { from = 2, to = 12, count = 50 }
        [operation]
        duty = { cases = [{ ratio = 0.8, share = 2 }, { ratio = 1.4, share = 5 }], weight = "share" }
        [uncertainty]
        friction = { normal = { mean = 0.4, sd = 0.03 }, from = 0.3, to = 0.5 }
        belt_thickness_mm = { plus = { normal = { mean = 0, sd = 1.5 } } }
        [probability]
        draws = 700
        [constraints]
        slip_margin = { min = 0, yield = 0.1 }
        flank_pressure_MPa = { max = 3, over_scenarios = "mean", yield = 0.1 }
        axial_force_N = { max = 9000, over_scenarios = "sum" }
        belt_thickness_mm = { min = 2 }
        [objectives]
        yield = "max"
        axial_force_N = { goal = "min", over_draws = { quantile = 0.95 } }
        [report]
        columns = [{ of = "max_stress_MPa", over_draws = "sd", over_scenarios = "mean" }]
        "#;

    #[test]
    fn draws_computed_together_have_the_bits_that_each_has_alone() {
        let studies = STUDIES.into_iter().chain([(ABSENCES, true)]);
        let (mut held, mut kept, mut absent) = ([0, 0], [0, 0], 0);
        for (text, serves) in studies {
            let study = Study::parse_in(text, "test.toml", ".".as_ref()).unwrap_or_else(|errors| panic!("{errors}"));
            let drive = || study.probability.as_ref().expect("it has draws").drawn(None).expect("it can be drawn");
            let (drive, kernel) = (drive(), DrawnKernel::new(drive()));
            let asked = AskedDraws::of(&drive.statistics);
            let together = DrawColumns::new(&drive, &asked);
            assert_eq!(together.is_some(), serves, "{text}");
            // Memory is asked for only where draws are computed together: at least a mask, a value and an input of each.
            let check = |kernel: &DrawnKernel, draws: usize| {
                let needs = kernel.footprint(&[]).scratch;
                let least = if serves && draws >= TOGETHER { 3 * 8 * draws as u64 } else { 0 };
                assert!(if least > 0 { (least..100 * least).contains(&needs) } else { needs == 0 }, "{needs}, {draws} draws: {text}");
            };
            check(&kernel, drive.draws());
            // With fresh draws it is that of the larger blocks.
            let probability =
                Probability { confirm: 3 * BLOCK as u64, ..Probability::clone(study.probability.as_ref().expect("it has draws")) };
            let fresh = FreshDraws::new(probability.confirming().expect("they can be drawn"), probability.inputs.len(), 1);
            check(&DrawnKernel::new(probability.drawn(Some(fresh)).expect("it can be drawn")), BLOCK);
            let Some(together) = together else { continue };
            let columns: Vec<&[f64]> = drive.columns.iter().map(Vec::as_slice).collect();
            for share in [0.0, 0.3, 0.6, 1.0] {
                let mut design: Vec<f64> = drive.base.inputs.iter().map(|it| input_to_si(it, it.default)).collect();
                for axis in study.design.iter().filter(|it| it.count() == 50) {
                    let (least, most) = axis.ends(0);
                    let input = axis.inputs()[0];
                    design[input] = input_to_si(&drive.base.inputs[input], least + (most - least) * share);
                }
                let found = together.run(&drive, &design, &columns);
                let alone = kernel.block(None, &asked, &design, &columns);
                let differs = (0..drive.draws()).find(|&draw| !found.is_same(draw, &alone, draw));
                assert_eq!((found.holds.len(), differs), (drive.draws(), None), "{share}: {text}");
                found.holds.iter().for_each(|it| held[usize::from(*it != 0)] += 1);
                found.kept.iter().flatten().for_each(|it| kept[usize::from(*it != 0)] += 1);
                absent += found.values.iter().flatten().filter(|it| it.is_nan()).count();
            }
        }
        assert!(held.iter().chain(&kept).all(|it| *it > 100) && absent > 100, "{held:?} {kept:?} {absent}");
    }

    #[test]
    fn statistics_of_many_blocks_are_those_of_all_draws() {
        let text = ABSENCES
            .replace("draws = 700", "draws = 20000")
            .replace("[objectives]", "[objectives]\n        slip_margin = { goal = \"max\", over_draws = \"mean\" }");
        let study = Study::parse_in(&text, "test.toml", ".".as_ref()).unwrap_or_else(|errors| panic!("{errors}"));
        let drive = || study.probability.as_ref().expect("it has draws").drawn(None).expect("it can be drawn");
        let (drive, kernel) = (drive(), DrawnKernel::new(drive()));
        let asked = AskedDraws::of(&drive.statistics);
        let columns: Vec<&[f64]> = drive.columns.iter().map(Vec::as_slice).collect();
        let design: Vec<f64> = drive.base.inputs.iter().map(|it| input_to_si(it, it.default)).collect();
        assert!(drive.draws() > 2 * BLOCK && !drive.draws().is_multiple_of(BLOCK));
        let all = kernel.block(None, &asked, &design, &columns);
        let results = kernel.results(&design, Set::EMPTY);
        let (mut kept, mut values) = (all.kept.iter(), all.values.iter());
        for (statistic, found) in drive.statistics.iter().zip(results) {
            let expected = match statistic.kind {
                StatisticKind::Yield => Some(count(&all.holds) as f64),
                StatisticKind::YieldOf(_) => kept.next().map(|it| count(it) as f64),
                StatisticKind::Over(asked, over) => values.next().and_then(|it| over_draws(&asked, over, it)),
                StatisticKind::Plain(asked) => values.next().and_then(|it| of_any(&asked, it)),
                StatisticKind::Confirmed(_) => continue,
            };
            assert_eq!(found.map(f64::to_bits), expected.map(f64::to_bits), "{}", statistic.name);
        }
        let holds = count(&all.holds) as usize;
        assert!(holds > 100 && holds < drive.draws() && kept.next().is_none() && values.next().is_none(), "{holds} hold");
    }

    #[test]
    fn what_the_formula_gives_is_told_where_draws_computed_together_differ() {
        let study = Study::parse_in(ABSENCES, "test.toml", ".".as_ref()).unwrap_or_else(|errors| panic!("{errors}"));
        let drive = || study.probability.as_ref().expect("it has draws").drawn(None).expect("it can be drawn");
        let kernel = DrawnKernel::new(drive());
        let asked = AskedDraws::of(&kernel.statistics);
        let right = DrawColumns::new(&kernel, &asked).expect("it can be recorded");
        let mut wrong = DrawColumns::new(&kernel, &asked).expect("it can be recorded");
        let force = wrong.quantities.iter().position(|it| it.name(&kernel.base) == "axial_force_N").expect("it is asked for");
        let stress = wrong.quantities.iter().position(|it| it.name(&kernel.base) == "max_stress_MPa").expect("it is asked for");
        let output = |at: usize| wrong.outputs.iter().position(|it| it.0 == at).expect("it is an output");
        let (force, stress) = (output(force), output(stress));
        (wrong.outputs[force].1, wrong.outputs[stress].1) = (wrong.outputs[stress].1, wrong.outputs[force].1);
        let design: Vec<f64> = kernel.base.inputs.iter().map(|it| input_to_si(it, it.default)).collect();
        let columns: Vec<&[f64]> = kernel.columns.iter().map(Vec::as_slice).collect();
        let alone = kernel.block(None, &asked, &design, &columns);
        let told = |together: &DrawColumns| kernel.block(Some(together), &asked, &design, &columns);
        let is_alone = |block: &DrawnBlock| (0..kernel.draws()).all(|draw| block.is_same(draw, &alone, draw));
        assert!(!is_alone(&wrong.run(&kernel, &design, &columns)));
        // The first block is compared whole, those after it here and there.
        (0..3).for_each(|_| assert!(is_alone(&told(&wrong)) && is_alone(&told(&right))));
    }
}
