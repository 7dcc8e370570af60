//! A study with distributions on a device: the drive's whole formula, asked for every draw in every operating case of a design.
//!
//! To the rest of the kernel this is a formula like others. What it says of a yield is how many draws surely hold and how many possibly do,
//! as the middle between the two and its distance from either; both are whole numbers, so where no draw is unsure the count is exact.

use super::constants::{Level, NEWTON_STEPS_OF_DRAWS, WINDOW};
use super::held::{holds, refuse};
use super::texts::{keep_between, least_bad, literal};
use crate::error::Result;
use crate::gpu::constants::declare;
use crate::gpu::structure;
use crate::interned::{interned, interned_list};
use crate::models::{CONDITION_BOUND_FACTOR, Worse, input_to_si};
use crate::plan::{Plan, knowns};
use crate::probability::Effect;
use crate::study::{AskedQuantity, Constraint, DrawnDrive, LeastCount, OverDraws, Quantity, StatisticKind, least_counts, needs};
use crate::tape::wgsl::StageNames;
use crate::tape::{Fields, Known, List, Operation, Reads, Set, SettledStages, nearest_f32, wgsl};
use std::fmt::Write;

/// What the drive's functions and structures are called.
const DRIVE: StageNames = StageNames {
    prepare: "prepare_drive",
    prepared: "PreparedDrive",
    conditions: "drive_conditions",
    count: "DRIVE_CONDITIONS",
    finish: "finish_drive",
    outputs: "DriveOutputs",
};
/// Operating cases of which the results of the drive's first stage are held for all draws.
const MOST_HELD: usize = 64;
/// Draws whose values are added up before they go to the sum of all: what f32 loses of a sum grows with its length.
const ADDED: usize = 64;

/// The model of a study's draws as a device has it.
#[derive(Clone, Debug)]
pub struct DrawnOnDevice {
    /// The names of its values.
    pub fields: Fields,
    /// What it reads of a design.
    pub reads: Reads,
    /// Outputs that are counts.
    pub counts: Set,
    /// The inputs that operating cases set, case by case; then the draws, draw by draw. The text finds them from `FIRST_CASE` on.
    pub entries: Vec<Level>,
    /// Its functions in WGSL.
    pub text: String,
}

impl DrawnOnDevice {
    /// Of a plan; `None` if nothing is drawn.
    ///
    /// # Errors
    /// [`Error::CpuOnly`](crate::error::Error::CpuOnly) if the drive is computed on the CPU only,
    /// [`Error::NotOnDevice`](crate::error::Error::NotOnDevice) for what is not for a device, by name.
    pub fn new(plan: &Plan) -> Result<Option<Self>> {
        let Some(probability) = plan.study.probability.as_deref() else { return Ok(None) };
        let drive = &probability.drawn(None).map_err(|problem| refuse(problem.to_string()))?;
        let used: Vec<usize> = plan.used_outputs().iter().collect();
        let base = &*drive.base;
        let formula = base.on_device()?;
        supports(drive, &used)?;
        let of_statistics = used.iter().filter_map(|&it| drive.statistics[it].kind.of());
        let quantities: Vec<Quantity> = drive.holds.iter().map(|it| it.quantity).chain(of_statistics).collect();
        let (outputs, conditions) = needs(base, quantities.iter().copied());
        let own = formula.fields();
        if !own.tables.is_empty() {
            return Err(refuse(format!("draws of {} need its tables by the draw, which the CPU computes", base.name)));
        }
        let asked: Vec<_> = conditions.iter().map(|it| (it, base.conditions[it].strict)).collect();
        let stages = SettledStages::new(formula, &knowns_of_draws(plan, drive), outputs, &asked);
        let entries = entries(drive)?;
        let of_inputs: Set = quantities.iter().filter_map(|it| it.input()).collect();
        let drawn: Set = drive.drawn.iter().map(|it| it.0).collect();
        let replaced: Set =
            drive.cases.inputs.iter().copied().chain(drive.drawn.iter().filter(|it| it.1 == Effect::Is).map(|it| it.0)).collect();
        let first = Reads::of_lists(&own, &[&stages.lists.first]).inputs;
        let inputs = (first | stages.reads.inputs | of_inputs | drawn) - replaced;
        // The first stage once for each case if draws do not change it.
        let cases = drive.cases.rows.len();
        let held = (!first.meets(drawn) && cases <= MOST_HELD).then_some(cases);
        let of_roots = |list: &List| {
            let roots = list.operations.iter().filter(|it| matches!(it, Operation::Root(_))).count() as u64;
            roots * u64::from(NEWTON_STEPS_OF_DRAWS + 1)
        };
        let of_first = of_roots(&stages.lists.first);
        let of_second = of_roots(&stages.lists.conditions) + of_roots(&stages.lists.finish);
        let each = 1 + of_second + own.iterations + if held.is_some() { 0 } else { of_first };
        let iterations = (drive.draws() * cases) as u64 * each + drive.draws() as u64 + cases as u64 * (1 + of_first);
        let names: Vec<&'static str> = (0..drive.statistics.len()).map(|number| interned(&format!("s{number}"))).collect();
        let fields = Fields {
            iterations,
            ..Fields::new(own.inputs, interned_list(&[interned("none")]), interned_list(&names), drive.absentees().count())
        };
        let is_count = |number: &usize| matches!(drive.statistics[*number].kind, StatisticKind::Yield | StatisticKind::YieldOf(_));
        let counts = (0..drive.statistics.len()).filter(is_count).collect();
        let mut text = String::new();
        let least = least_counts(drive, &plan.least_values());
        DrawnText { drive, used: &used, conditions, stages: &stages, own: &own, least, held, text: &mut text }.write();
        Ok(Some(Self { fields, reads: Reads { prepared: Set::EMPTY, inputs }, counts, entries, text }))
    }
}

/// What is known of the inputs of the drive over all draws and cases.
fn knowns_of_draws(plan: &Plan, drive: &DrawnDrive) -> Vec<Known> {
    let mut known = knowns(&plan.study, &plan.space);
    let within = |values: &mut dyn Iterator<Item = f64>| {
        let (least, largest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, largest), it| (least.min(it), largest.max(it)));
        Known::Within(least, largest)
    };
    for (column, &input) in drive.cases.inputs.iter().enumerate() {
        known[input] = within(&mut drive.cases.rows.iter().map(|row| input_to_si(&drive.base.inputs[input], row[column])));
    }
    for (&(input, effect), column) in drive.drawn.iter().zip(&drive.columns) {
        known[input] = match effect {
            Effect::Is => within(&mut column.iter().map(|it| drive.base.inputs[input].unit.to_si(*it))),
            Effect::Times | Effect::Plus => Known::ANY,
        };
    }
    known
}

/// Is all that is asked of the draws for a device?
fn supports(drive: &DrawnDrive, used: &[usize]) -> Result<()> {
    let mut over = drive.holds.iter().map(|it| it.over).collect::<Vec<_>>();
    for statistic in used.iter().map(|&it| &drive.statistics[it]) {
        let what = match statistic.kind {
            StatisticKind::Over(_, OverDraws::Sd) => "a standard deviation over the draws",
            StatisticKind::Over(_, OverDraws::Quantile(_)) => "a quantile over the draws",
            StatisticKind::Confirmed(_) => "told by the fresh draws",
            StatisticKind::YieldOf(constraint) => {
                over.push(constraint.over);
                continue;
            }
            _ => {
                over.extend(statistic.kind.asked().map(|it| it.over));
                continue;
            }
        };
        return Err(refuse(format!("{} is {what}, which the CPU computes", statistic.name)));
    }
    if over.iter().any(|it| !it.is_worst()) {
        return Err(refuse("it asks for a mean or sum over the cases of a spectrum, and these are added up on the CPU".to_owned()));
    }
    Ok(())
}

/// What the device is given of cases and draws.
fn entries(drive: &DrawnDrive) -> Result<Vec<Level>> {
    let base = &drive.base;
    let of_cases = drive.cases.rows.iter().flat_map(|row| {
        drive.cases.inputs.iter().zip(row).map(|(&input, &value)| (&base.inputs[input], input_to_si(&base.inputs[input], value)))
    });
    let of_draws = (0..drive.draws()).flat_map(|draw| {
        drive.drawn.iter().zip(&drive.columns).map(move |(&(input, effect), column)| {
            let input = &base.inputs[input];
            (input, if effect == Effect::Times { column[draw] } else { input.unit.to_si(column[draw]) })
        })
    });
    let numbers = drive.cases.rows.len() * drive.cases.inputs.len() + drive.draws() * drive.drawn.len();
    if numbers as u64 > WINDOW {
        return Err(refuse(format!("its draws and operating cases have {numbers} numbers, more than the {WINDOW} that a device is given")));
    }
    let entry = |(input, value): (&crate::models::Input, f64)| {
        if !holds(value) {
            return Err(refuse(format!("a value {value:e} of {} in SI units is none of a device's numbers of 32 bits", input.name)));
        }
        let (near, bound) = nearest_f32(value);
        Ok([near, bound, 0.0, 1.0])
    };
    of_cases.chain(of_draws).map(entry).collect()
}

/// Writes the functions of the model of the draws.
struct DrawnText<'a> {
    drive: &'a DrawnDrive,
    used: &'a [usize],
    /// Conditions of the drive that matter.
    conditions: Set,
    stages: &'a SettledStages,
    /// The names of the drive's values.
    own: &'a Fields,
    /// Counts without which a design is infeasible.
    least: Vec<LeastCount>,
    /// For how many cases the first stage is held.
    held: Option<usize>,
    text: &'a mut String,
}

/// Which of the lines of the loops a statement belongs to.
#[derive(Default)]
struct KernelLines {
    /// Before the draws, before the cases of a draw, in a case, after the cases, after the draws.
    begin: Vec<String>,
    draw: Vec<String>,
    case: Vec<String>,
    drawn: Vec<String>,
    end: Vec<String>,
    /// After every so many draws.
    added: Vec<String>,
    /// Verdicts on a draw: where all are no, its other cases need not be computed, unless values are followed over all of them.
    open: Vec<String>,
    follows: bool,
    /// When the draws that remain cannot make a design feasible any more.
    ends: Vec<String>,
}

impl DrawnText<'_> {
    fn put(&mut self, line: &str) {
        writeln!(self.text, "{line}").expect("a text takes everything");
    }

    fn function(&mut self, head: &str, lines: &[String]) {
        self.put(&format!("\nfn {head} {{"));
        lines.iter().for_each(|line| self.put(&format!("    {line}")));
        self.put("}");
    }

    fn write(&mut self) {
        let DrawnDrive { cases, drawn, base, .. } = self.drive;
        let passed = self.own.prepared.iter().enumerate().filter(|(field, _)| self.stages.reads.prepared.contains(*field));
        let passed: Vec<&str> = passed.map(|it| *it.1).collect();
        structure(self.text, DRIVE.prepared, if passed.is_empty() { &["none"] } else { &passed });
        structure(self.text, DRIVE.outputs, self.own.outputs);
        declare(self.text, DRIVE.count, base.conditions.len().max(1) as u32);
        self.text.push_str(&wgsl::stages_text(&DRIVE, self.own, &self.stages.lists, &[]));
        self.put("");
        self.put(&format!("const DRAWS: u32 = {}u;\nconst CASES: u32 = {}u;", self.drive.draws(), cases.rows.len()));
        self.put(&format!("const FIRST_DRAW: u32 = FIRST_CASE + {}u;", cases.rows.len() * cases.inputs.len()));
        let lines = cases.inputs.iter().enumerate().map(|(column, &input)| {
            let entry = format!("steady[FIRST_CASE + number * {}u + {column}u]", cases.inputs.len());
            format!("(*own).{} = Real({entry}.x, {entry}.y);", self.own.inputs[input])
        });
        let lines: Vec<_> = lines.collect();
        self.function("set_case(own: ptr<function, Inputs>, number: u32)", &lines);
        let mut lines = vec!["var built = YES;".to_owned()];
        let mut ranges = Vec::new();
        for (column, &(input, effect)) in drawn.iter().enumerate() {
            let entry = format!("steady[FIRST_DRAW + draw * {}u + {column}u]", drawn.len());
            let (field, entry) = (self.own.inputs[input], format!("Real({entry}.x, {entry}.y)"));
            lines.push(match effect {
                Effect::Is => format!("(*own).{field} = {entry};"),
                Effect::Times => format!("(*own).{field} = mul((*own).{field}, {entry});"),
                Effect::Plus => format!("(*own).{field} = add((*own).{field}, {entry});"),
            });
            if !self.always_fits(column) {
                let range = self.drive.base.inputs[input].valid;
                let end = |value: f64, included: bool| value.is_finite().then_some((value, !included));
                ranges.push((input, [end(range.low, range.includes_low), end(range.high, range.includes_high)]));
                lines.push(format!("built = min(built, fits_{input}((*own).{field}));"));
            }
        }
        lines.push("return built;".to_owned());
        self.put("\n// Turns the inputs of a case to those of a draw; may each input have its value?");
        self.function("set_draw(own: ptr<function, Inputs>, draw: u32) -> u32", &lines);
        for (input, ends) in ranges {
            self.keeps(&format!("fits_{input}"), Quantity::Input(input), ends);
        }
        self.count();
    }

    /// Have all draws of an input that replace what the design says values that it may have?
    fn always_fits(&self, column: usize) -> bool {
        let (input, effect) = self.drive.drawn[column];
        effect == Effect::Is
            && self.drive.columns[column].iter().all(|&it| self.drive.fits(input, self.drive.base.inputs[input].unit.to_si(it)))
    }

    /// A function that asks whether a quantity of the drive keeps to these ends, given in its unit.
    fn keeps(&mut self, name: &str, quantity: Quantity, ends: [Option<(f64, bool)>; 2]) {
        let base = &self.drive.base;
        let unit = match quantity {
            Quantity::Input(input) => base.inputs[input].unit,
            Quantity::Output(output) => base.outputs[output].unit,
        };
        let lines = keep_between(ends, unit.is_si(), |end| unit.to_si(end));
        self.function(&format!("{name}(number: Real) -> u32"), &lines);
    }

    /// A quantity of the drive in SI units.
    fn value(&self, quantity: Quantity) -> String {
        match quantity {
            Quantity::Input(input) => format!("own.{}", self.own.inputs[input]),
            Quantity::Output(output) => {
                format!("bounded(d.{}, {})", self.own.outputs[output], literal(self.drive.base.outputs[output].bound_factor as f32))
            }
        }
    }

    /// Lines that take a condition away from a verdict if it makes this quantity absent.
    fn absent(&self, verdict: &str, quantity: Quantity) -> impl Iterator<Item = String> {
        let base = &self.drive.base;
        let output = quantity.output().map(|output| &base.outputs[output].name);
        let takes = move |number: &usize| output.is_some_and(|it| base.conditions[*number].invalidates.contains(it));
        self.conditions.iter().filter(takes).map(move |number| format!("{verdict} = min({verdict}, c{number});"))
    }

    /// The function that counts.
    fn count(&mut self) {
        let base = &self.drive.base;
        let mut lines = KernelLines::default();
        for number in self.conditions.iter() {
            let question = if base.conditions[number].strict { "above_zero" } else { "at_least_zero" };
            let factor = literal(CONDITION_BOUND_FACTOR as f32);
            lines.case.push(if self.stages.open.contains(number) {
                format!("let c{number} = {question}(bounded(margins[{number}], {factor}));")
            } else {
                format!("let c{number} = YES;")
            });
        }
        let counted: Vec<(usize, Vec<Constraint>, bool)> = self
            .used
            .iter()
            .filter_map(|&number| match self.drive.statistics[number].kind {
                StatisticKind::Yield => Some((number, self.drive.holds.clone(), true)),
                StatisticKind::YieldOf(constraint) => Some((number, vec![constraint], false)),
                _ => None,
            })
            .collect();
        for (number, constraints, status) in &counted {
            for (at, constraint) in constraints.iter().enumerate() {
                self.keeps(&format!("keeps_{number}_{at}"), constraint.quantity, [constraint.low, constraint.high]);
            }
            self.counted(*number, constraints, *status, &mut lines);
        }
        for (margin, number) in self.drive.absentees().enumerate() {
            if !self.used.contains(&number) {
                continue;
            }
            match self.drive.statistics[number].kind {
                StatisticKind::Plain(asked) => self.plain(number, margin, &asked, &mut lines),
                StatisticKind::Over(asked, over) => self.over((number, margin), &asked, over, &mut lines),
                _ => unreachable!("only values of quantities may be absent"),
            }
        }
        let indented = |lines: &[String], by: usize| lines.iter().map(|line| format!("{}{line}", " ".repeat(by))).collect::<Vec<_>>();
        let mut all = vec!["var out: Outputs;".to_owned()];
        if let Some(held) = self.held {
            all.push(format!("var held: array<{}, {held}>;", DRIVE.prepared));
            all.push("for (var number = 0u; number < CASES; number++) {".to_owned());
            let own = ["var own = i;".to_owned(), "set_case(&own, number);".to_owned(), format!("held[number] = {}(own);", DRIVE.prepare)];
            all.extend(indented(&own, 4));
            all.push("}".to_owned());
        }
        all.push("// Draws that were left out because they decide nothing: each may count or not.".to_owned());
        all.push("var rest = 0u;".to_owned());
        all.extend(lines.begin);
        all.push("for (var draw = 0u; draw < DRAWS; draw++) {".to_owned());
        all.push("    var built = YES;".to_owned());
        all.extend(indented(&lines.draw, 4));
        all.push("    for (var number = 0u; number < CASES; number++) {".to_owned());
        let own = ["var own = i;", "set_case(&own, number);", "built = min(built, set_draw(&own, draw));"].map(str::to_owned);
        all.extend(indented(&own, 8));
        let prepared = if self.held.is_some() { "held[number]".to_owned() } else { format!("{}(own)", DRIVE.prepare) };
        all.push(format!("        let prepared = {prepared};"));
        all.push(format!("        let margins = {}(prepared, own);", DRIVE.conditions));
        all.push(format!("        let d = {}(prepared, own);", DRIVE.finish));
        all.extend(indented(&lines.case, 8));
        if let Some(open) = lines.open.into_iter().reduce(|a, b| format!("max({a}, {b})"))
            && !lines.follows
        {
            all.push(format!("        if min(built, {open}) == NO {{ break; }}"));
        }
        all.push("    }".to_owned());
        all.extend(indented(&lines.drawn, 4));
        if !lines.added.is_empty() {
            all.push(format!("    if (draw + 1u) % {ADDED}u == 0u || draw + 1u == DRAWS {{"));
            all.extend(indented(&lines.added, 8));
            all.push("    }".to_owned());
        }
        if let Some(ends) = lines.ends.into_iter().reduce(|a, b| format!("{a} || {b}")) {
            all.push(format!("    if {ends} {{ rest = DRAWS - draw - 1u; break; }}"));
        }
        all.push("}".to_owned());
        all.extend(lines.end);
        all.push("return out;".to_owned());
        self.put("\n// Whether each statistic has a value, as the margin of its condition: the function that counts the draws finds it.");
        self.put("var<private> presence: array<Real, CONDITIONS>;");
        self.function("prepare(i: Inputs) -> Prepared", &["var p: Prepared;".to_owned(), "return p;".to_owned()]);
        self.function("conditions(p: Prepared, i: Inputs) -> array<Real, CONDITIONS>", &["return presence;".to_owned()]);
        self.function("finish(p: Prepared, i: Inputs) -> Outputs", &all);
    }

    /// Draws that keep constraints, and those that have a result too if the `status` is asked.
    fn counted(&self, number: usize, constraints: &[Constraint], status: bool, lines: &mut KernelLines) {
        let verdict = format!("v{number}");
        lines.begin.push(format!("var surely{number} = 0u;"));
        lines.begin.push(format!("var possibly{number} = 0u;"));
        lines.draw.push(format!("var {verdict} = YES;"));
        if status {
            let loud = self.conditions.iter().filter(|&it| !self.drive.base.conditions[it].quiet);
            lines.case.extend(loud.map(|it| format!("{verdict} = min({verdict}, c{it});")));
        }
        for (at, constraint) in constraints.iter().enumerate() {
            lines.case.extend(self.absent(&verdict, constraint.quantity));
            lines.case.push(format!("{verdict} = min({verdict}, keeps_{number}_{at}({}));", self.value(constraint.quantity)));
        }
        lines.open.push(verdict.clone());
        lines.drawn.push(format!("{verdict} = min({verdict}, built);"));
        lines.drawn.push(format!("surely{number} += select(0u, 1u, {verdict} == YES);"));
        lines.drawn.push(format!("possibly{number} += select(0u, 1u, {verdict} != NO);"));
        if let Some(least) = self.least.iter().find(|it| it.statistic == number) {
            lines.ends.push(format!("possibly{number} + (DRAWS - draw - 1u) < {}u", least.count));
        }
        lines.end.push(format!(
            "out.s{number} = Real(f32(surely{number} + possibly{number} + rest) * 0.5, f32(possibly{number} - surely{number} + rest) * 0.5);"
        ));
    }

    /// The worst value of a quantity over the cases of a draw, `f`, and whether it has one in all of them, `h`.
    fn fold(&self, number: usize, asked: &AskedQuantity, lines: &mut KernelLines) {
        lines.follows = true;
        lines.draw.push(format!("var f{number} = {};", least_bad(asked.worse)));
        lines.draw.push(format!("var h{number} = YES;"));
        lines.case.extend(self.absent(&format!("h{number}"), asked.quantity));
        lines.case.push(format!("let w{number} = {};", self.value(asked.quantity)));
        lines.case.push(format!("h{number} = min(h{number}, select(UNSURE, YES, is_known(w{number})));"));
        lines.case.push(format!("f{number} = {};", worse_of(asked.worse, &format!("f{number}"), &format!("w{number}"))));
        lines.drawn.push(format!("h{number} = min(h{number}, built);"));
    }

    /// What a value of the drive, in SI units, becomes in the unit of the statistic times `part`, and what its condition says.
    fn told(&self, (number, margin): (usize, usize), asked: &AskedQuantity, part: f64, lines: &mut KernelLines) {
        let base = &self.drive.base;
        let unit = match asked.quantity {
            Quantity::Input(input) => base.inputs[input].unit,
            Quantity::Output(output) => base.outputs[output].unit,
        };
        let (multiply, divide) = unit.factors();
        let factor = divide / multiply * part;
        lines.end.push(format!("if rest > 0u {{ a{number} = UNSURE; }}"));
        let value = format!("if_known(a{number} == YES, t{number})");
        // The factor is rounded in f64 too.
        let scaled = if factor == 1.0 { value } else { format!("mul({value}, near({}))", literal(nearest_f32(factor).0)) };
        lines.end.push(format!("out.s{number} = {scaled};"));
        lines.end.push(format!("presence[{margin}] = Real(select(-1.0, 1.0, a{number} != NO), select(0.0, 2.0, a{number} == UNSURE));"));
    }

    /// A quantity that does not depend on the draws, from all that have a value.
    fn plain(&self, number: usize, margin: usize, asked: &AskedQuantity, lines: &mut KernelLines) {
        self.fold(number, asked, lines);
        lines.begin.push(format!("var t{number} = {};", least_bad(asked.worse)));
        lines.begin.push(format!("var a{number} = NO;"));
        lines.begin.push(format!("var unsure{number} = false;"));
        let worse = worse_of(asked.worse, &format!("t{number}"), &format!("f{number}"));
        lines.drawn.push(format!("if h{number} == YES {{ t{number} = {worse}; a{number} = YES; }}"));
        lines.drawn.push(format!("unsure{number} = unsure{number} || h{number} == UNSURE;"));
        // Whatever an unsure draw has may be the worst.
        lines.end.push(format!("if unsure{number} {{ a{number} = UNSURE; }}"));
        self.told((number, margin), asked, 1.0, lines);
    }

    /// The mean or the worst over all draws, each of which must have a value.
    fn over(&self, (number, margin): (usize, usize), asked: &AskedQuantity, over: OverDraws, lines: &mut KernelLines) {
        self.fold(number, asked, lines);
        lines.begin.push(format!("var a{number} = YES;"));
        lines.drawn.push(format!("a{number} = min(a{number}, h{number});"));
        if over == OverDraws::Mean {
            lines.begin.push(format!("var t{number} = constant(0.0);"));
            lines.begin.push(format!("var few{number} = constant(0.0);"));
            lines.drawn.push(format!("few{number} = add(few{number}, f{number});"));
            lines.added.push(format!("t{number} = add(t{number}, few{number});"));
            lines.added.push(format!("few{number} = constant(0.0);"));
            self.told((number, margin), asked, 1.0 / self.drive.draws() as f64, lines);
        } else {
            lines.begin.push(format!("var t{number} = {};", least_bad(asked.worse)));
            lines.drawn.push(format!("t{number} = {};", worse_of(asked.worse, &format!("t{number}"), &format!("f{number}"))));
            self.told((number, margin), asked, 1.0, lines);
        }
    }
}

/// The worse of two numbers that a kernel has, with a bound that serves both.
fn worse_of(worse: Worse, a: &str, b: &str) -> String {
    let fold = if worse == Worse::Higher { "max" } else { "min" };
    format!("Real({fold}({a}.value, {b}.value), max({a}.bound, {b}.bound))")
}
