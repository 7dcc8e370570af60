//! The `[report]` table: what else to report.

use super::super::axis::Axis;
use super::super::limits::MOST_PICTURES;
use super::super::quantity::Quantity;
use super::super::resolved::{Best, Goal, HistogramSpec, MapSpec, Objective, Report, ReportColumn, SampleSpec, TopSpec};
use super::contours::Plane;
use super::quantities::GOALS;
use super::roles::AxisRole;
use super::table::{Entry, TomlNode, TomlTable};
use super::value::{shown_in, whole};
use super::{Reader, choice, text};
use crate::models::Worse;
use toml::de::DeValue;

/// Default of `front_budget`, and its largest value.
pub(in super::super) const FRONT_BUDGET: (u64, u64) = (1_000_000, 1_000_000_000);
/// Default of `bins` of a histogram, and its largest value.
pub(in super::super) const BINS: (usize, u64) = (50, 100_000);
/// Most designs of the top list.
pub(in super::super) const MOST_TOP: u64 = 1_000_000;
/// Most designs of a sample of the feasible ones, and its seed unless the study says otherwise.
pub(in super::super) const MOST_SAMPLE: u64 = 1_000_000;
const SEED: u64 = 0;
/// Most designs of a list of all.
pub(in super::super) const MOST_VARIANTS: u64 = 10_000;
/// Most designs of a study all feasible ones of which are written.
pub(in super::super) const MOST_FEASIBLE: u64 = 100_000_000;
/// Most cells of a map.
pub(in super::super) const MOST_CELLS: u64 = 1 << 26;

/// What the keys of `[report]` refer to.
struct ReportContext<'a> {
    /// The table `[objectives]`, which also has the objectives with problems.
    named: Option<&'a TomlTable<'a>>,
    objectives: &'a [Objective],
    design: &'a [Axis],
    fixed: &'a [f64],
}

impl ReportContext<'_> {
    /// The goal of the objective for this quantity in its worst scenario.
    fn goal(&self, quantity: Quantity) -> Option<Goal> {
        self.objectives.iter().find(|it| it.quantity == quantity && it.over.is_worst()).map(|objective| objective.goal)
    }
}

impl Reader<'_> {
    /// What else to report.
    pub(super) fn report(
        &self,
        table: Option<&TomlTable<'_>>,
        named: Option<&TomlTable<'_>>,
        objectives: &[Objective],
        design: &[Axis],
        fixed: &[f64],
    ) -> Report {
        let mut report = Report { front_budget: FRONT_BUDGET.0, ..Report::default() };
        let Some(table) = table else { return report };
        let known = ReportContext { named, objectives, design, fixed };
        table.check_keys(self.problems, "[report]", super::keys::REPORT);
        if let Some(entry) = table.get("columns") {
            report.columns = self.columns_of_report(entry, &known);
        }
        if let Some(entry) = table.get("top") {
            report.top = self.table_of(entry.node, "top", "{ by = \"...\", count = 20 }").and_then(|table| self.top(&table, &known));
        }
        let items = |key: &str, example: &str| self.tables_of(table.get(key), key, example);
        report.histograms =
            items("histograms", "{ of = \"...\", bins = 50 }").iter().filter_map(|table| self.histogram(table, &known)).collect();
        report.maps =
            items("maps", "{ x = \"...\", y = \"...\", value = \"...\" }").iter().filter_map(|table| self.map(table, &known)).collect();
        report.sample = table.get("sample").and_then(|entry| self.sample(entry));
        if let Some(budget) = table.get("front_budget").and_then(|entry| whole(entry, self.problems, "[report]", 1, FRONT_BUDGET.1)) {
            report.front_budget = budget;
        }
        report.variants = table.get("variants").is_some_and(|entry| self.variants(entry, design));
        report.feasible = table.get("feasible").is_some_and(|entry| self.feasible(entry, design));
        report.sensitivity = table.get("sensitivity").and_then(|entry| self.sensitivity(entry));
        report
    }

    /// A number of designs, or a table with it.
    fn sample(&self, entry: &Entry<'_>) -> Option<SampleSpec> {
        let (label, example) = ("sample", "sample = 2000 or { count = 2000, seed = 1 }");
        let Some(table) = entry.node.table() else {
            let DeValue::Integer(_) = entry.node.value else {
                let found = entry.node.found();
                self.problems.add(entry.node.at, format!("{label}: found {found}, wanted a number of designs, such as {example}"));
                return None;
            };
            let count = whole(entry, self.problems, "[report]", 1, MOST_SAMPLE)?;
            return Some(SampleSpec { count: usize::try_from(count).ok()?, seed: SEED });
        };
        let good = table.check_keys(self.problems, label, super::keys::REPORT_SAMPLE);
        let count = self.needed(&table, "count", label, example).and_then(|it| whole(it, self.problems, label, 1, MOST_SAMPLE));
        let seed = table.get("seed").map_or(Some(SEED), |it| whole(it, self.problems, label, 0, u64::MAX));
        let (count, seed) = (count?, seed?);
        if good { Some(SampleSpec { count: usize::try_from(count).ok()?, seed }) } else { None }
    }

    /// Is every design to be listed?
    fn variants(&self, entry: &Entry<'_>, design: &[Axis]) -> bool {
        let wanted = self.is_wanted(entry);
        let designs = design.iter().fold(1u64, |product, axis| product.saturating_mul(axis.count()));
        if wanted && (self.sampled || designs > MOST_VARIANTS) {
            let found =
                if self.sampled { "this study samples its designs".to_owned() } else { format!("this study has {designs} designs") };
            let message = format!("variants: {found}; a list of all is for grids of at most {MOST_VARIANTS}: use top or the front");
            self.problems.add(entry.node.at, message);
            return false;
        }
        wanted
    }

    /// Are all feasible designs to be written?
    fn feasible(&self, entry: &Entry<'_>, design: &[Axis]) -> bool {
        let wanted = self.is_wanted(entry);
        let designs = self.sample_count.unwrap_or_else(|| design.iter().fold(1u64, |product, axis| product.saturating_mul(axis.count())));
        if wanted && designs > MOST_FEASIBLE {
            let message = format!(
                "feasible: this study has {designs} designs; all feasible ones are written of at most {MOST_FEASIBLE}: \
                 use a sample of them (sample = 100000), or fewer levels"
            );
            self.problems.add(entry.node.at, message);
            return false;
        }
        wanted
    }

    /// True or false.
    fn is_wanted(&self, entry: &Entry<'_>) -> bool {
        if let DeValue::Boolean(wanted) = entry.node.value {
            return *wanted;
        }
        self.problems.add(entry.node.at, format!("{}: found {}, wanted true or false", entry.key, entry.node.found()));
        false
    }

    /// A node that must be a table.
    fn table_of<'n>(&self, node: TomlNode<'n>, label: &str, example: &str) -> Option<TomlTable<'n>> {
        let table = node.table();
        if table.is_none() {
            self.problems.add(node.at, format!("{label}: found {}, wanted a table such as {example}", node.found()));
        }
        table
    }

    /// A list of tables.
    fn tables_of<'n>(&self, entry: Option<&Entry<'n>>, label: &str, example: &str) -> Vec<TomlTable<'n>> {
        let Some(entry) = entry else { return Vec::new() };
        let Some(nodes) = entry.node.list() else {
            self.problems.add(entry.node.at, format!("{label}: found {}, wanted a list such as [{example}]", entry.node.found()));
            return Vec::new();
        };
        if nodes.len() == 0 {
            self.problems.add(entry.node.at, format!("{label}: the list is empty; write [{example}] or drop the line"));
        }
        if nodes.len() > MOST_PICTURES {
            self.problems.add(entry.node.at, format!("{label}: there are {}; at most {MOST_PICTURES} fit on a page", nodes.len()));
            return Vec::new();
        }
        nodes.filter_map(|node| self.table_of(node, label, example)).collect()
    }

    /// A key that must be there.
    fn needed<'t, 'n>(&self, table: &'t TomlTable<'n>, key: &str, label: &str, example: &str) -> Option<&'t Entry<'n>> {
        let entry = table.get(key);
        if entry.is_none() {
            self.problems.add(table.at, format!("{label}: \"{key}\" is missing; write {example}"));
        }
        entry
    }

    /// The numeric quantity that a text names.
    fn named(&self, entry: &Entry<'_>, label: &str, known: &ReportContext<'_>) -> Option<Quantity> {
        let name = text(entry.node, self.problems, label)?;
        self.numeric(&name, entry.node.at, label, known.fixed)
    }

    fn columns_of_report(&self, entry: &Entry<'_>, known: &ReportContext<'_>) -> Vec<ReportColumn> {
        let mut columns: Vec<ReportColumn> = Vec::new();
        let Some(nodes) = entry.node.list() else {
            let found = entry.node.found();
            self.problems
                .add(entry.node.at, format!("columns: found {found}, wanted a list of names such as [\"{}\"]", self.some_output()));
            return columns;
        };
        for node in nodes.take_while(|_| !self.problems.is_full()) {
            let Some(column) = self.column_of_report(node, known) else { continue };
            let name = column.of.name(self.model);
            match column.of {
                Quantity::Input(number) if self.is_chosen(number) => {
                    self.problems.add(node.at, format!("columns: \"{name}\" is a design input, which the tables have anyway; drop it"));
                }
                _ if columns.contains(&column) => self.problems.add(node.at, format!("columns: \"{name}\" is listed twice; drop one")),
                _ => columns.push(column),
            }
        }
        columns
    }

    /// A column: a name, or a table that says more.
    fn column_of_report(&self, node: TomlNode<'_>, known: &ReportContext<'_>) -> Option<ReportColumn> {
        let label = "columns";
        let Some(table) = node.table() else {
            let name = text(node, self.problems, label)?;
            return self.numeric(&name, node.at, label, known.fixed).map(ReportColumn::from);
        };
        let good = table.check_keys(self.problems, label, &self.with_draws(super::keys::REPORT_COLUMN, &[]));
        let example = format!("{{ of = \"{}\", worst = \"lowest\" }}", self.some_output());
        let of = self.needed(&table, "of", label, &example).and_then(|entry| self.named(entry, label, known))?;
        let over = self.over(&table, of, label)?;
        let ends = [("lowest", Worse::Lower), ("highest", Worse::Higher)];
        let worst = match table.get("worst") {
            Some(entry) => Some(choice(entry, self.problems, label, &ends)?),
            None => None,
        };
        good.then_some(ReportColumn { of, over, worst })
    }

    /// Is everything that this table asks for a worst value? What counts designs or lists the best has no means and sums.
    fn is_of_worst(&self, table: &TomlTable<'_>, label: &str) -> bool {
        let Some(entry) = table.get("over_scenarios") else { return true };
        let message = format!("{label}: over_scenarios is for constraints, objectives and columns, not in {label}; drop it");
        self.problems.add(entry.key_at, message);
        false
    }

    /// An output for examples in messages, one that studies often use.
    pub(super) fn some_output(&self) -> &str {
        let outputs = &self.model.outputs;
        outputs.iter().find(|output| output.name.contains("force")).or(outputs.first()).map_or("", |output| &output.name)
    }

    fn top(&self, table: &TomlTable<'_>, known: &ReportContext<'_>) -> Option<TopSpec> {
        if !self.is_of_worst(table, "top") {
            return None;
        }
        let good = table.check_keys(self.problems, "top", &self.with_draws(super::keys::TOP, &[]));
        let example = format!("top = {{ by = \"{}\", count = 20 }}", self.some_output());
        let by = self.needed(table, "by", "top", &example).and_then(|entry| self.named(entry, "top", known));
        let count = self.needed(table, "count", "top", &example).and_then(|entry| whole(entry, self.problems, "top", 1, MOST_TOP));
        let goal = table.get("goal").map(|entry| choice(entry, self.problems, "top", GOALS));
        let by = by?;
        let best = || match by.worse(self.model) {
            Worse::Higher => Goal::Min,
            Worse::Lower => Goal::Max,
        };
        let goal = goal.unwrap_or_else(|| Some(known.goal(by).unwrap_or_else(best)))?;
        good.then_some(TopSpec { by, goal, count: usize::try_from(count?).ok()? })
    }

    fn histogram(&self, table: &TomlTable<'_>, known: &ReportContext<'_>) -> Option<HistogramSpec> {
        let label = "histograms";
        if !self.is_of_worst(table, label) {
            return None;
        }
        let good = table.check_keys(self.problems, label, &self.with_draws(super::keys::HISTOGRAM, &[]));
        let example = format!("{{ of = \"{}\", bins = 50 }}", self.some_output());
        let of = self.needed(table, "of", label, &example).and_then(|entry| self.named(entry, label, known));
        let bins = match table.get("bins") {
            Some(entry) => whole(entry, self.problems, label, 1, BINS.1).and_then(|bins| usize::try_from(bins).ok()),
            None => Some(BINS.0),
        };
        let of = of?;
        let range = match (table.get("from"), table.get("to")) {
            (None, None) => None,
            (Some(from), Some(to)) => {
                let (low, high) = (self.quantity_value(from, of, label), self.quantity_value(to, of, label));
                let (low, high) = (low?, high?);
                let width = high - low;
                if width <= 0.0 || !width.is_finite() {
                    let unit = self.unit(of);
                    let ends = format!("from {} to {}", shown_in(low, unit), shown_in(high, unit));
                    self.problems.add(from.key_at.max(to.key_at), format!("{label}: there are no bins {ends}; from must be less than to"));
                    return None;
                }
                Some((low, high))
            }
            (Some(entry), None) | (None, Some(entry)) => {
                let message = format!("{label}: only {} is given; give both from and to, or neither", entry.key);
                self.problems.add(entry.key_at, message);
                return None;
            }
        };
        Some(HistogramSpec { of, range, bins: bins.filter(|_| good)? })
    }

    fn map(&self, table: &TomlTable<'_>, known: &ReportContext<'_>) -> Option<MapSpec> {
        let label = "maps";
        let problems = self.problems;
        if !self.is_of_worst(table, label) {
            return None;
        }
        let good = table.check_keys(problems, label, &self.with_draws(super::keys::MAP, &[]));
        if self.sampled {
            problems.add(table.at, format!("{label}: sampled designs lie on no grid, so there is no map; drop it or [sample]"));
            return None;
        }
        let example = format!("{{ x = \"...\", y = \"...\", value = \"{}\" }}", self.some_output());
        let side = |key: &str| self.needed(table, key, label, &example).and_then(|entry| self.map_axis(entry, known.design));
        let (x, y) = (side("x"), side("y"));
        let value = self.map_value(table, known);
        // An axis with a problem of its own has been reported.
        let (x, y) = (x??, y??);
        if x == y {
            let last = ["x", "y"].iter().filter_map(|key| table.get(key)).map(|entry| entry.node.at).max();
            problems.add(last.unwrap_or(table.at), format!("{label}: x and y are the same axis; choose two"));
            return None;
        }
        let (columns, rows) = (known.design[x].count(), known.design[y].count());
        if columns.checked_mul(rows).is_none_or(|cells| cells > MOST_CELLS) {
            problems.add(
                table.at,
                format!("{label}: {columns} x {rows} cells are too many, at most {MOST_CELLS} fit; use fewer levels or choose other axes"),
            );
            return None;
        }
        let plane = Plane { design: known.design, x, y, value, fixed: known.fixed };
        let contours = table.get("contours").map_or_else(Vec::new, |entry| self.contours(entry, &plane));
        good.then_some(MapSpec { x, y, value: value?, contours })
    }

    /// Position of the design axis that a text names; inside `None` if that axis has a problem of its own.
    #[allow(clippy::option_option, reason = "reported here, reported elsewhere, or found")]
    fn map_axis(&self, entry: &Entry<'_>, design: &[Axis]) -> Option<Option<usize>> {
        let name = text(entry.node, self.problems, "maps")?;
        let (at, label) = (entry.node.at, "maps");
        let Some(number) = self.model.input(&name) else {
            self.problems.add(at, format!("{label}: {} must be a design axis; {}", entry.key, self.no_input(&name)));
            return None;
        };
        let claims = self.claims.borrow();
        let chosen = claims.iter().find(|claim| claim.input == number && claim.role == AxisRole::Design);
        match chosen {
            None => {
                let message = format!("{label}: \"{name}\" is no design axis; choose one of [design], or put it there");
                if !self.misnamed.get() {
                    self.problems.add_if_complete(at, message);
                }
                None
            }
            Some(claim) if !claim.single => {
                let message =
                    format!("{label}: \"{name}\" belongs to a joint axis, which cannot be an axis of a map; choose an axis of one input");
                self.problems.add(at, message);
                None
            }
            Some(_) => Some(design.iter().position(|axis| matches!(axis, Axis::Single { input, .. } if *input == number))),
        }
    }

    fn map_value(&self, table: &TomlTable<'_>, known: &ReportContext<'_>) -> Option<Best> {
        let (problems, label) = (self.problems, "maps");
        let bests = [("min", Some(Goal::Min)), ("max", Some(Goal::Max)), ("share", None)];
        let best = match table.get("best") {
            Some(entry) => Some((choice(entry, problems, label, &bests)?, entry.node.at)),
            None => None,
        };
        match (table.get("value"), best) {
            (None, Some((None, _))) => Some(Best::Share),
            (Some(entry), Some((None, _))) => {
                problems
                    .add(entry.key_at, format!("{label}: the share of feasible designs needs no value; drop value or best = \"share\""));
                None
            }
            (None, _) => {
                problems.add(table.at, format!("{label}: \"value\" is missing; name an objective, or write best = \"share\""));
                None
            }
            (Some(entry), best) => {
                let quantity = self.named(entry, label, known)?;
                let name = quantity.name(self.model);
                match (known.goal(quantity), best.and_then(|(goal, at)| goal.map(|goal| (goal, at)))) {
                    (Some(goal), Some((other, at))) if goal != other => {
                        problems.add(at, format!("{label}: \"{name}\" is an objective with the other goal; drop best"));
                        None
                    }
                    (Some(goal), _) | (None, Some((goal, _))) => Some(Best::Value(quantity, goal)),
                    (None, None) => {
                        // An objective with a problem of its own, or with a wrong name, has been reported.
                        let is_objective = |entry: &Entry<'_>| entry.key == name || self.find_quantity(entry.key).is_none();
                        let is_wrong =
                            |table: &TomlTable<'_>| table.entries.len() > known.objectives.len() && table.entries.iter().any(is_objective);
                        if !known.named.is_some_and(is_wrong) {
                            let message =
                                format!("{label}: \"{name}\" is no objective; say which value is best: best = \"min\" or best = \"max\"");
                            problems.add_if_complete(entry.node.at, message);
                        }
                        None
                    }
                }
            }
        }
    }
}
