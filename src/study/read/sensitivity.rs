//! `sensitivity` in `[report]`: which input matters.

use super::super::resolved::Study;
use super::super::sensitivity::{InfluenceOver, SensitivitySpec};
use super::roles::AxisRole;
use super::table::{Entry, Problems, TomlTable};
use super::value::whole;
use super::{Reader, choice, text};
use toml::de::DeValue;

/// How it is called in messages.
const LABEL: &str = "sensitivity";
/// What may be written.
const EXAMPLE: &str = "sensitivity = true or { over = \"design\" }";
/// What may vary, as it is written.
const OVER: &[(&str, InfluenceOver)] = &[("design", InfluenceOver::Design), ("uncertainty", InfluenceOver::Uncertainty)];

impl Reader<'_> {
    /// True or false, or a table that says more. Whether the study has an answer is asked where all of it is known.
    pub(super) fn sensitivity(&self, entry: &Entry<'_>) -> Option<SensitivitySpec> {
        let problems = self.problems;
        let is_uncertain = self.claims.borrow().iter().any(|claim| claim.role == AxisRole::Uncertainty);
        let default = if is_uncertain { InfluenceOver::Uncertainty } else { InfluenceOver::Design };
        let plain = SensitivitySpec { over: default, of: Vec::new(), draws: SensitivitySpec::DRAWS };
        if let DeValue::Boolean(wanted) = entry.node.value {
            return wanted.then_some(plain);
        }
        let Some(table) = entry.node.table() else {
            problems.add(entry.node.at, format!("{LABEL}: found {}, wanted true, false or a table, such as {EXAMPLE}", entry.node.found()));
            return None;
        };
        let good = table.check_keys(problems, LABEL, super::keys::SENSITIVITY);
        let over = table.get("over").map_or(Some(default), |it| choice(it, problems, LABEL, OVER));
        let of = table.get("of").map_or(Some(Vec::new()), |it| self.asked_names(it));
        let ends = (SensitivitySpec::DRAWS_FROM, SensitivitySpec::DRAWS_TO);
        let draws = table.get("draws").map_or(Some(plain.draws), |it| whole(it, problems, LABEL, ends.0, ends.1));
        let (over, of, draws) = (over?, of?, draws?);
        good.then_some(SensitivitySpec { over, of, draws })
    }

    /// A list of names.
    fn asked_names(&self, entry: &Entry<'_>) -> Option<Vec<String>> {
        let Some(nodes) = entry.node.list().filter(|nodes| nodes.len() > 0) else {
            let found = if entry.node.list().is_some() { "an empty list".to_owned() } else { entry.node.found() };
            let message = format!("{LABEL}: of: found {found}, wanted a list of names such as [\"holds\"]; drop it for all");
            self.problems.add(entry.node.at, message);
            return None;
        };
        let names: Vec<_> = nodes.map(|node| text(node, self.problems, LABEL)).collect();
        names.into_iter().collect()
    }
}

/// Reports what the study cannot answer, at its place.
pub(super) fn check(study: &Study, top: &TomlTable<'_>, problems: &Problems<'_>) {
    let Some(spec) = study.report.sensitivity.as_ref().filter(|_| problems.count() == 0) else { return };
    let report = top.get("report").and_then(|it| it.node.table());
    let Some(entry) = report.as_ref().and_then(|it| it.get(LABEL)) else { return };
    let table = entry.node.table();
    let names: Vec<usize> = table.and_then(|it| Some(it.get("of")?.node.list()?.map(|node| node.at).collect())).unwrap_or_default();
    for flaw in study.flaws_of_sensitivity(spec) {
        problems.add(flaw.name.and_then(|name| names.get(name).copied()).unwrap_or(entry.node.at), flaw.message);
    }
}
