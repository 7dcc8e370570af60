//! What is looked at: the inputs that vary, the quantities that are asked about, and how much work that is.

use super::factor::InputFactor;
use crate::certify::{self, Column};
use crate::error::{Error, Result};
use crate::likeness::remedy;
use crate::models::Worse;
use crate::screen::Control;
use crate::sensitivity::ShapleySets;
use crate::space::Space;
use crate::study::{Axis, HOLDS, InfluenceOver, Quantity, ReportColumn, SensitivitySpec, StatisticKind, Study};
use std::collections::BTreeSet;
use std::time::Instant;

/// Most evaluations for which all combinations of levels are looked at, and the least number of combinations for which they are in any case.
const MOST_EXACT: u64 = 2_000_000;
const LEAST_EXACT: u64 = 64;
/// Seconds of a thread, by the model's own figures, that they may take.
const MOST_SECONDS: f64 = 300.0;
/// More factors are screened, too.
const SCREENED: usize = 10;
/// Sobol points have so many dimensions at most, and a factor takes two.
const MOST_DRAWN: usize = 50;
/// Walks of a screening.
pub(super) const WALKS: u64 = 20;

/// A quantity that is asked about.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantityAsked {
    /// Name of its column in tables of designs; `holds`.
    pub name: String,
    /// Unit; empty for plain numbers.
    pub unit: String,
    /// What it is, in a sentence or two.
    pub doc: String,
    /// Position of its column; `None`: whether the design holds.
    pub(super) column: Option<usize>,
}

impl QuantityAsked {
    /// File of the picture of its shares.
    pub fn shares_file(&self) -> String {
        format!("sensitivity-{}.svg", self.name)
    }

    /// File of its tornado.
    pub fn tornado_file(&self) -> String {
        format!("tornado-{}.svg", self.name)
    }
}

/// Inputs that vary, and quantities that are asked about.
#[derive(Debug)]
pub struct InfluenceSubject {
    /// Which inputs vary.
    pub over: InfluenceOver,
    /// The design whose uncertainty is looked at.
    pub design: Option<u64>,
    /// The inputs that vary.
    pub factors: Vec<InputFactor>,
    /// What is asked about.
    pub quantities: Vec<QuantityAsked>,
    /// Draws of each set, where there are too many combinations.
    pub draws: u64,
    /// Seed of draws, walks and orders.
    pub seed: u64,
    pub(super) correlation: Vec<(usize, usize, f64)>,
    /// The study without the axes of the factors.
    pub(super) base: Study,
    pub(super) columns: Vec<Column>,
    /// Evaluations that one combination takes.
    evaluations: u64,
    /// Did the user name the quantities?
    pub(super) is_chosen: bool,
    scenarios: u64,
}

/// What a subject takes to be looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InfluenceWork {
    /// Combinations of levels that are looked at, all or a coarser grid.
    pub grid: u64,
    /// Are these all that there are?
    pub exact: bool,
    /// Draws in all sets together.
    pub drawn: u64,
    /// Sets of draws.
    pub sets: u64,
    /// Orders of the factors that Shapley effects are computed from, where there are too many to look at all.
    pub orders: Option<usize>,
    /// Points of walks and of the tornado.
    pub single: u64,
    /// All combinations together: of the grid, the draws, the walks and the tornado.
    pub combinations: u64,
    /// Evaluations of the model for all of these.
    pub evaluations: u64,
}

impl InfluenceSubject {
    /// What is uncertain about design number `design` of a study, or its design axes.
    ///
    /// `of` names quantities, as columns of the result, inputs, outputs or `holds`; none: those of the study's objectives, constraints and
    /// report columns that are outputs, and `holds`.
    ///
    /// # Errors
    /// [`Error::Request`] if nothing varies, the design is not one of the study's, or a quantity is not known.
    pub fn new(study: &Study, over: InfluenceOver, design: Option<u64>, of: &[String], draws: u64, seed: u64) -> Result<Self> {
        let Varied { mut base, axes, drawn, correlation, design } = match over {
            InfluenceOver::Design => of_designs(study, design)?,
            InfluenceOver::Uncertainty => of_one_design(study, design)?,
        };
        // What has one level does not vary.
        for axis in axes.iter().filter(|axis| axis.count() < 2) {
            axis.inputs().iter().enumerate().for_each(|(column, &input)| base.fixed[input] = axis.value(column, 0));
        }
        let factors = drawn.into_iter().chain(axes.iter().filter(|axis| axis.count() > 1).map(|it| InputFactor::of_axis(it, &base.model)));
        let factors: Vec<_> = factors.collect();
        if factors.is_empty() {
            return Err(Error::Request(match over {
                InfluenceOver::Design => "nothing varies over the design: give an axis of [design] more than one level".to_owned(),
                InfluenceOver::Uncertainty => "nothing is uncertain: give inputs levels or distributions in [uncertainty], \
                                               or ask for --over design"
                    .to_owned(),
            }));
        }
        let names = asked_names(&mut base, of)?;
        let columns = certify::columns(&base);
        if columns.iter().any(|it| it.name == HOLDS) {
            return Err(Error::Request(format!("the study has a quantity \"{HOLDS}\", which means here whether all is kept; rename it")));
        }
        let of_column = |(number, column): (usize, &Column)| QuantityAsked {
            name: column.name.clone(),
            unit: column.unit(&base),
            doc: column.doc(&base),
            column: Some(number),
        };
        let known: Vec<QuantityAsked> = columns.iter().enumerate().map(of_column).chain([holds(over)]).collect();
        let is_asked = |it: &&QuantityAsked| match &names {
            Some(names) => names.contains(&it.name),
            None => it.column.is_none_or(|column| columns[column].quantity.output().is_some()),
        };
        let quantities = known.iter().filter(is_asked).cloned().collect();
        let scenarios = Space::new(&base).scenarios.count();
        let evaluations = base.probability.as_ref().map_or(1, |it| it.evaluations()).saturating_mul(scenarios);
        let is_chosen = !of.is_empty();
        Ok(Self { over, design, factors, quantities, draws, seed, correlation, base, columns, evaluations, is_chosen, scenarios })
    }

    /// What the study's report asks for, of this design where one design is looked at; `None` if it asks for nothing.
    ///
    /// # Errors
    /// As [`InfluenceSubject::new`], for a design that the study does not have.
    pub fn of_report(study: &Study, design: u64) -> Result<Option<Self>> {
        let Some(SensitivitySpec { over, of, draws }) = &study.report.sensitivity else { return Ok(None) };
        let design = (*over == InfluenceOver::Uncertainty).then_some(design);
        Self::new(study, *over, design, of, *draws, Self::seed_of(study)).map(Some)
    }

    /// The seed unless another one is asked for: that of the study's draws.
    pub fn seed_of(study: &Study) -> u64 {
        study.probability.as_ref().map_or(1, |it| it.seed)
    }

    /// Do inputs have correlations, so that Sobol indices have no meaning?
    pub fn is_correlated(&self) -> bool {
        !self.correlation.is_empty()
    }

    /// Title of the study.
    pub fn title(&self) -> &str {
        &self.base.title
    }

    /// Scenarios in which each combination is looked at.
    pub fn scenarios(&self) -> u64 {
        self.scenarios
    }

    /// Are there draws of the factors?
    pub(super) fn is_drawn(&self) -> bool {
        self.grid_of_all().is_none() && self.factors.len() <= MOST_DRAWN
    }

    /// Are there more factors than a screening is needed for?
    pub fn is_screened(&self) -> bool {
        self.factors.len() > SCREENED
    }

    /// Most combinations that may be looked at one by one.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a limit")]
    fn most_combinations(&self) -> u64 {
        let effort = self.base.model.effort;
        let by_time = (MOST_SECONDS / ((effort.prepare + effort.finish) * self.scenarios as f64)) as u64;
        (MOST_EXACT / self.evaluations).min(by_time).max(LEAST_EXACT)
    }

    /// Number of all combinations, if all factors have levels and these are few enough.
    pub(super) fn grid_of_all(&self) -> Option<u64> {
        let combinations = self.factors.iter().try_fold(1u64, |all, it| all.checked_mul(it.levels()?.count()))?;
        (combinations <= self.most_combinations()).then_some(combinations)
    }

    /// Most combinations of a grid: all, or as many as may be looked at. A grid that is not whole serves designs only: it tells of those
    /// that hold.
    pub(super) fn grid_limit(&self) -> Option<u64> {
        let most = self.most_combinations();
        // Two levels of each factor at least.
        let has_room = self.factors.len() < 64 && 1 << self.factors.len() <= most;
        self.grid_of_all().or((self.over == InfluenceOver::Design && has_room).then_some(most))
    }

    /// What it takes to look at it.
    ///
    /// # Errors
    /// There are no factors.
    pub fn work(&self) -> Result<InfluenceWork> {
        let exact = self.grid_of_all();
        let sets = if self.is_drawn() { self.sets()?.len() as u64 } else { 0 };
        let walks = if self.is_screened() { WALKS * (self.factors.len() as u64 + 1) } else { 0 };
        let tornado = if self.over == InfluenceOver::Uncertainty { 2 * self.factors.len() as u64 + 1 } else { 0 };
        let (grid, single) = (self.grid_limit().unwrap_or(0), walks + tornado);
        let drawn = sets * self.draws;
        let combinations = grid + drawn + single;
        let evaluations = combinations.saturating_mul(self.evaluations);
        let orders = self.shapley_sets()?.orders();
        Ok(InfluenceWork { grid, exact: exact.is_some(), drawn, sets, orders, single, combinations, evaluations })
    }

    /// The sets of factors that Shapley effects are computed from.
    pub(super) fn shapley_sets(&self) -> Result<ShapleySets> {
        Ok(ShapleySets::new(self.factors.len(), self.seed)?)
    }

    /// All sets of factors that are needed: those of Shapley effects, and for Sobol indices each factor alone and all but each.
    pub(super) fn sets(&self) -> Result<BTreeSet<u64>> {
        let count = self.factors.len();
        let mut sets: BTreeSet<u64> = self.shapley_sets()?.needed().into_iter().collect();
        sets.extend([0, crate::sensitivity::all_of(count)]);
        if !self.is_correlated() {
            sets.extend((0..count).map(|factor| crate::sensitivity::all_but(factor, count)));
        }
        Ok(sets)
    }

    /// About how many seconds a thread takes for one combination, as measured now.
    ///
    /// # Errors
    /// As [`InfluenceSubject::report`].
    pub fn seconds_each(&self) -> Result<f64> {
        let places = [0.1, 0.4, 0.6, 0.9];
        let column = |it: &InputFactor| places.iter().map(|&place| Ok(it.at(place)?.drawn)).collect::<Result<Vec<f64>>>();
        let columns = self.factors.iter().map(column).collect::<Result<Vec<_>>>()?;
        self.at_drawn(&columns, 1, &Control::default())?;
        let start = Instant::now();
        self.at_drawn(&columns, 1, &Control::default())?;
        Ok(start.elapsed().as_secs_f64() / places.len() as f64)
    }
}

/// What varies of a study.
struct Varied {
    base: Study,
    axes: Vec<Axis>,
    drawn: Vec<InputFactor>,
    correlation: Vec<(usize, usize, f64)>,
    design: Option<u64>,
}

/// The design axes. What stands in the report stays, because a design without a value for it is not feasible.
fn of_designs(study: &Study, design: Option<u64>) -> Result<Varied> {
    if design.is_some() {
        return Err(Error::Request("--design is of one design, and --over design looks at all of them; use one of the two".to_owned()));
    }
    let mut base = Study { design: Vec::new(), labels: Vec::new(), sample: None, ..study.clone() };
    // Fresh draws judge designs that were chosen. Here nothing is chosen, and they would take long.
    base.report.columns.retain(|it| study.confirmed(it.of).is_none());
    Ok(Varied { base, axes: study.design.clone(), drawn: Vec::new(), correlation: Vec::new(), design: None })
}

/// What is uncertain about one design.
fn of_one_design(study: &Study, design: Option<u64>) -> Result<Varied> {
    let space = Space::new(study);
    let last = space.designs.count() - 1;
    let design = match design {
        None if last == 0 => 0,
        None => {
            let message = format!("which design? name it by --design N, from 0 to {last}, as in front.csv; or ask for --over design");
            return Err(Error::Request(message));
        }
        Some(design) if design > last => {
            return Err(Error::Request(format!("there is no design {design}; the study's designs are 0 to {last}")));
        }
        Some(design) => design,
    };
    let mut base = study.of_one_draw();
    base.fixed = space.inputs(design, 0);
    let axes = std::mem::take(&mut base.uncertainty);
    (base.design, base.labels, base.sample) = (Vec::new(), Vec::new(), None);
    let mut drawn = Vec::new();
    let mut correlation = Vec::new();
    if let Some(probability) = &study.probability {
        drawn = probability.inputs.iter().map(|it| InputFactor::of_drawn(it, &base.model, base.fixed[it.input])).collect();
        correlation.clone_from(&probability.correlation);
        // What is asked of all draws is here asked of one.
        for statistic in &probability.statistics {
            let column = match statistic.kind {
                StatisticKind::Plain(it) | StatisticKind::Over(it, _) => {
                    ReportColumn { of: it.quantity, over: it.over, worst: Some(it.worse) }
                }
                StatisticKind::YieldOf(it) => {
                    let end = if it.low.is_some() { Worse::Lower } else { Worse::Higher };
                    ReportColumn { of: it.quantity, over: it.over, worst: Some(end) }
                }
                _ => continue,
            };
            if !base.report.columns.contains(&column) {
                base.report.columns.push(column);
            }
        }
    }
    Ok(Varied { base, axes, drawn, correlation, design: Some(design) })
}

/// The names of the quantities that are asked about, if some are; what the study does not ask for becomes a column of its report.
fn asked_names(base: &mut Study, of: &[String]) -> Result<Option<Vec<String>>> {
    if of.is_empty() {
        return Ok(None);
    }
    for name in of {
        let names: Vec<String> = certify::columns(base).into_iter().map(|it| it.name).collect();
        if name == HOLDS || names.contains(name) {
            continue;
        }
        let model = base.model.clone();
        let quantity = model.output(name).map(Quantity::Output).or_else(|| model.input(name).map(Quantity::Input));
        let Some(quantity) = quantity else {
            let outputs = model.outputs.iter().map(|it| it.name.as_str());
            let known: Vec<&str> = names.iter().map(String::as_str).chain([HOLDS]).chain(outputs).collect();
            let listed = || format!("the study asks for: {}, {HOLDS}", names.join(", "));
            return Err(Error::Request(format!("--of {name}: there is no such quantity; {}", remedy(name, &known, listed))));
        };
        base.report.columns.push(quantity.into());
    }
    Ok(Some(of.to_vec()))
}

/// Whether all constraints are kept.
fn holds(over: InfluenceOver) -> QuantityAsked {
    let cases = if over == InfluenceOver::Design { "scenarios" } else { "operating cases" };
    let doc = format!("1 where in all {cases} the status is ok and every constraint is kept, else 0.");
    QuantityAsked { name: HOLDS.to_owned(), unit: String::new(), doc, column: None }
}
