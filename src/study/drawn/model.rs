//! The model whose outputs are yields and statistics over the draws.

use super::super::Study;
use super::super::axis::Axis;
use super::super::spectrum::{OverScenarios, unit_over};
use super::cases::OperatingCases;
use super::confirm::FreshDraws;
use super::drive::{Asking, DrawnDrive, Requirements};
use super::kernel::DrawnKernel;
use super::probability::{Drive, Probability};
use super::statistic::{AskedQuantity, ConfirmedEnd, SCREENED, Statistic, StatisticKind};
use crate::interned::interned;
use crate::models::{Condition, Model, Output, Worse};
use crate::probability::{ProbabilityProblem, REPLICATES, Sampling};
use crate::units::{NONE, Unit};
use std::sync::Arc;

/// Evaluations that counting the reasons of infeasible designs may take, and the least number of designs that are looked at.
const SAMPLE_EVALUATIONS: u64 = 20_000_000;
const LEAST_SAMPLE: u64 = 64;

impl Probability {
    /// The model whose outputs are what the study asks of the draws.
    pub(in super::super) fn model(&self) -> Result<Model, String> {
        if let Some(flaw) = self.flaw() {
            return Err(flaw);
        }
        let problem = |problem: ProbabilityProblem| problem.to_string();
        let fresh = FreshDraws::new(self.confirming().map_err(problem)?, self.inputs.len(), self.levels);
        Ok(model(self, DrawnKernel::new(self.drawn(Some(fresh)).map_err(problem)?)))
    }

    /// The drive with the draws that choose designs, and those that judge what they have chosen.
    pub(crate) fn drawn(&self, fresh: Option<FreshDraws>) -> Result<DrawnDrive, ProbabilityProblem> {
        let draws = self.choosing()?;
        Ok(self.drive_of(draws.columns(0..draws.count()), fresh))
    }

    fn drive_of(&self, columns: Vec<Vec<f64>>, fresh: Option<FreshDraws>) -> DrawnDrive {
        let Drive { model: base, operation, spectrum, constraints } = &self.drive;
        let drawn = self.inputs.iter().map(|it| (it.input, it.acts())).collect();
        let cases = OperatingCases::new(operation, spectrum.as_ref());
        let asking = Asking(self.statistics.clone(), fresh);
        DrawnDrive::new(base.clone(), drawn, columns, cases, Requirements(constraints.clone()), asking)
    }
}

impl Study {
    /// The same with so many draws, each for itself: a first idea of what many say. `None` where nothing is drawn.
    pub(crate) fn with_draws(&self, draws: u64) -> Option<Self> {
        let few = Probability { draws, sampling: Sampling::Random, ..(**self.probability.as_ref()?).clone() };
        let model = Arc::new(few.model().ok()?);
        Some(Self { model, probability: Some(Arc::new(few)), ..self.clone() })
    }

    /// The axes of the operating cases: scenarios of the study, or where something is drawn what every draw must survive.
    pub(crate) fn operating(&self) -> &[Axis] {
        self.probability.as_ref().map_or(&self.operation, |it| &it.drive.operation)
    }

    /// The draws that choose, a column for each input that is drawn; none where nothing is.
    pub(crate) fn drawn_columns(&self) -> Result<Vec<Vec<f64>>, String> {
        let Some(probability) = &self.probability else { return Ok(Vec::new()) };
        let draws = probability.choosing().map_err(|problem| problem.to_string())?;
        Ok(draws.columns(0..draws.count()))
    }

    /// The same with other draws, a column for each input that is drawn. It has no fresh draws, so that nothing can be confirmed.
    pub(crate) fn with_drawn(&self, drawn: Vec<Vec<f64>>) -> Self {
        let Some(probability) = &self.probability else { return self.clone() };
        let model = model(probability, DrawnKernel::new(probability.drive_of(drawn, None)));
        Self { model: Arc::new(model), ..self.clone() }
    }

    /// The same with other operating cases on as many axes; `drawn` are its [`Study::drawn_columns`]. It has no fresh draws, so that nothing
    /// can be confirmed.
    ///
    /// # Errors
    /// If they are too many for each draw.
    pub(crate) fn with_operating(&self, operation: Vec<Axis>, drawn: &[Vec<f64>]) -> Result<Self, String> {
        let Some(probability) = &self.probability else { return Ok(Self { operation, ..self.clone() }) };
        let other = Probability { drive: Drive { operation, ..probability.drive.clone() }, ..(**probability).clone() };
        if let Some(flaw) = other.flaw() {
            return Err(flaw);
        }
        let model = model(&other, DrawnKernel::new(other.drive_of(drawn.to_vec(), None)));
        Ok(Self { model: Arc::new(model), probability: Some(Arc::new(other)), ..self.clone() })
    }
}

/// The model of a study's draws.
fn model(probability: &Probability, kernel: DrawnKernel) -> Model {
    let base = &probability.drive.model;
    let evaluations = (kernel.draws() * kernel.cases.rows.len()).max(1) as u64;
    let outputs: Vec<Output> = probability.statistics.iter().map(|it| output(probability, it)).collect();
    let absent = |statistic: &Statistic| {
        let (reason, doc) = match statistic.kind {
            StatisticKind::Plain(_) => ("no value in any draw", "There is a draw in which the quantity has a value."),
            _ => ("no value in some draw", "The quantity has a value in every draw that the statistic needs."),
        };
        Condition::new(reason, false, &[&statistic.name], doc).quiet()
    };
    let conditions = probability.statistics.iter().filter(|it| it.kind.may_be_absent()).map(absent).collect();
    Model {
        outputs,
        conditions,
        effort: kernel.effort(),
        sample: base.sample.min((SAMPLE_EVALUATIONS / evaluations).max(LEAST_SAMPLE)),
        on_gpu: base.on_gpu,
        kernel: Arc::new(kernel),
        notes: None,
        doubts: None,
        ..(**base).clone()
    }
}

fn output(probability: &Probability, statistic: &Statistic) -> Output {
    let drive = &probability.drive;
    let of = |asked: &AskedQuantity, worse: Worse, doc: String| {
        let unit = unit_over(asked.quantity, asked.over, &drive.model, drive.spectrum.as_ref());
        let over = match asked.over {
            OverScenarios::Worst if drive.operation.is_empty() => String::new(),
            OverScenarios::Worst => format!(" In each draw the {} of the operating cases.", asked.worse.word()),
            over => format!(" In each draw the {} over the operating cases.", over.word()),
        };
        let doc = format!("{}{doc}{over}", asked.quantity.doc(&drive.model));
        Output::new(&statistic.name, "", Unit::of_formulas(interned(&unit), (1.0, 1.0)), worse, "the draws", doc)
    };
    let share = |doc: String| Output::new(&statistic.name, "", NONE, Worse::Lower, "the draws", doc);
    // A device counts: of what it has, the share is counted in draws.
    let counted = |doc: String| Output { unit: Unit::of_formulas("", (probability.draws as f64, 1.0)), ..share(doc) };
    match &statistic.kind {
        StatisticKind::Yield => {
            counted("Share of the draws that hold: in all operating cases the status is ok and every constraint is kept.".to_owned())
        }
        StatisticKind::Confirmed(ConfirmedEnd::Share) => share(format!("Share of {} fresh draws that hold.", probability.confirm)),
        StatisticKind::Confirmed(ConfirmedEnd::Low) => {
            share("Lower end of the interval of the yield after Clopper and Pearson, 95 %, from the fresh draws.".to_owned())
        }
        StatisticKind::Confirmed(ConfirmedEnd::High) => {
            share("Upper end of the interval of the yield after Clopper and Pearson, 95 %, from the fresh draws.".to_owned())
        }
        StatisticKind::Confirmed(ConfirmedEnd::AtLeast) => {
            share("Proven lower bound of the yield, for the distributions themselves and not for draws of them.".to_owned())
        }
        StatisticKind::Confirmed(ConfirmedEnd::AtMost) => {
            share("Proven upper bound of the yield, for the distributions themselves and not for draws of them.".to_owned())
        }
        StatisticKind::Confirmed(ConfirmedEnd::StandardError) => {
            let doc = format!("Standard error of {SCREENED}, from {REPLICATES} independent sets of its draws; none where all sets agree.");
            Output { worse: Worse::Higher, ..share(doc) }
        }
        StatisticKind::YieldOf(constraint) => {
            counted(format!("Share of the draws that keep the bounds of {} in all operating cases.", constraint.name(&drive.model)))
        }
        StatisticKind::Plain(asked) => of(asked, asked.worse, String::new()),
        StatisticKind::Over(asked, over) => of(asked, over.worse(asked.worse), format!(" The {}.", over.words())),
    }
}
