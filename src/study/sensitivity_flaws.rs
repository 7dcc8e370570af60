//! What is wrong with what `[report]` asks of the sensitivity.

use super::axis::Axis;
use super::drawn::{REPLICATES, SCREENED, StatisticKind};
use super::quantity::Quantity;
use super::resolved::Study;
use super::sensitivity::{HOLDS, InfluenceOver, SensitivitySpec};
use crate::likeness::remedy;
use crate::models::Model;
use crate::probability::{Draws, Sampling};

/// What is wrong, and where: in the request as a whole, or in one of the names that it lists.
pub(super) struct SensitivityFlaw {
    /// The number of the name in the list.
    pub(super) name: Option<usize>,
    /// What is wrong and what would be right.
    pub(super) message: String,
}

impl Study {
    /// What varies unless it is said: what is uncertain, if anything is, else the design.
    pub fn influence_over(&self) -> InfluenceOver {
        if self.uncertainty.is_empty() && self.probability.is_none() { InfluenceOver::Design } else { InfluenceOver::Uncertainty }
    }

    /// What is wrong with this request to the study, which has no other flaws.
    pub(super) fn flaws_of_sensitivity(&self, spec: &SensitivitySpec) -> Vec<SensitivityFlaw> {
        let whole = |message: &str| vec![SensitivityFlaw { name: None, message: format!("sensitivity: {message}") }];
        let varies = |axes: &[Axis]| axes.iter().any(|axis| axis.count() > 1);
        match spec.over {
            InfluenceOver::Design if !varies(&self.design) => {
                return whole("nothing varies over the design; give an axis of [design] more than one level");
            }
            InfluenceOver::Uncertainty if self.probability.is_none() && !varies(&self.uncertainty) => {
                return whole("nothing is uncertain; give inputs levels or distributions in [uncertainty], or write over = \"design\"");
            }
            InfluenceOver::Uncertainty if self.objectives.is_empty() && self.report.top.is_none() => {
                return whole(
                    "over = \"uncertainty\" is about the knee or the first design of top, and this study has neither; name an objective \
                     in [objectives], or top in [report], or write over = \"design\"",
                );
            }
            _ => {}
        }
        if let Err(problem) = Draws::new(&[], spec.draws, Sampling::Sobol { replicates: REPLICATES }, 0) {
            return whole(&problem.to_string());
        }
        let over = spec.over;
        let (model, columns) = self.asked_columns(over);
        if columns.iter().any(|name| name == HOLDS) {
            return whole("the study has a quantity \"holds\", which means here whether all is kept; rename it");
        }
        let listed = || format!("the study asks for {}, holds", columns.join(", "));
        let flaw = |(number, name): (usize, &String)| {
            let flaw = |message: String| Some(SensitivityFlaw { name: Some(number), message });
            if spec.of[..number].contains(name) {
                return flaw(format!("sensitivity: \"{name}\" is listed twice; drop one"));
            }
            if model.output(name).is_some_and(|it| self.confirmed(Quantity::Output(it)).is_some()) && over == InfluenceOver::Design {
                return flaw(format!(
                    "sensitivity: \"{name}\" is of fresh draws, which judge only designs that were chosen; write \"{SCREENED}\""
                ));
            }
            let is_known = name == HOLDS || columns.contains(name);
            if is_known || model.input(name).is_some() || model.output(name).is_some() {
                return None;
            }
            let outputs = model.outputs.iter().map(|it| it.name.as_str());
            let known: Vec<&str> = columns.iter().map(String::as_str).chain([HOLDS]).chain(outputs).collect();
            flaw(format!("sensitivity: there is no quantity \"{name}\"; {}", remedy(name, &known, listed)))
        };
        spec.of.iter().enumerate().filter_map(flaw).collect()
    }

    /// The model whose quantities may be asked about, and the columns that the study asks for: of one draw, or over the draws.
    fn asked_columns(&self, over: InfluenceOver) -> (&Model, Vec<String>) {
        let mut columns: Vec<String> = Vec::new();
        let mut add = |name: String| {
            if !columns.contains(&name) {
                columns.push(name);
            }
        };
        if let (InfluenceOver::Uncertainty, Some(probability)) = (over, &self.probability) {
            let model = &probability.drive.model;
            probability.drive.constraints.iter().for_each(|it| add(it.name(model)));
            for statistic in &probability.statistics {
                match statistic.kind {
                    StatisticKind::Plain(it) | StatisticKind::Over(it, _) => add(it.over.column(it.quantity, model)),
                    StatisticKind::YieldOf(it) => add(it.name(model)),
                    StatisticKind::Yield | StatisticKind::Confirmed(_) => {}
                }
            }
            return (model, columns);
        }
        self.objectives.iter().for_each(|it| add(it.name(&self.model)));
        self.constraints.iter().for_each(|it| add(it.name(&self.model)));
        self.report.columns.iter().filter(|it| self.confirmed(it.of).is_none()).for_each(|it| add(it.over.column(it.of, &self.model)));
        (&self.model, columns)
    }
}
