//! `beltspace sensitivity`: which input matters.

use super::{read_study_with, threads};
use crate::cli;
use crate::terminal::{self, TextGrid, bold, grouped, scaled, short, span};
use beltspace::directory::Contents;
use beltspace::error::{Error, Result};
use beltspace::influence::{
    Estimate, InfluenceMethod, InfluenceReport, InfluenceSubject, InputReport, QuantityReport, QuantityVerdict, TornadoReport,
    is_influence_file, write,
};
use beltspace::study::StudyEdits;
use std::path::Path;

/// Seconds of work that are told before it begins.
const TOLD: f64 = 1.0;

pub fn run(request: &cli::SensitivityArgs) -> Result<()> {
    let (study, _) = read_study_with(&request.study, StudyEdits { set: &request.set, feasible: false })?;
    if let Some(out) = &request.out {
        refuse_a_results(out)?;
    }
    let over = request.over.unwrap_or_else(|| study.influence_over());
    let seed = request.seed.unwrap_or_else(|| InfluenceSubject::seed_of(&study));
    let subject = InfluenceSubject::new(&study, over, request.design, &request.of, request.draws, seed)?;
    let threads = threads(request.threads);
    if !request.quiet {
        tell_cost(&subject, threads)?;
    }
    let report = subject.report(threads)?;
    if let Some(out) = &request.out {
        write(&report, out, &terminal::command_line())?;
    }
    if request.quiet {
        return Ok(());
    }
    for quantity in &report.quantities {
        let refusal = quantity.refusal(over);
        if !refusal.is_empty() {
            terminal::remark("note", &refusal);
        }
    }
    if subject.is_correlated() {
        terminal::remark("note", "inputs are correlated, so Sobol indices have no meaning; Shapley effects do");
    }
    let mut text = format!("{}\n\n{}", bold(&terminal::told(&report.title)), head(&report));
    for quantity in &report.quantities {
        text.push_str(&of_quantity(quantity));
    }
    if let Some(out) = &request.out {
        text.push_str(&format!("\nresult {}\n", out.display()));
    }
    terminal::tell(&text)
}

/// The files that `[report]` asked for belong to their result, whose page shows them.
fn refuse_a_results(out: &Path) -> Result<()> {
    let own = Contents::of(out).and_then(|it| it.own_files()).unwrap_or_default();
    let Some(name) = own.iter().find(|name| is_influence_file(name)) else { return Ok(()) };
    let message = format!("{} belongs to the result there, which [report] asked for it; name another --out", out.join(name).display());
    Err(Error::Request(message))
}

/// Tells how long it will take, if that is long.
#[allow(clippy::cast_precision_loss, reason = "an estimate for people")]
pub fn tell_cost(subject: &InfluenceSubject, threads: usize) -> Result<()> {
    let work = subject.work()?;
    let seconds = subject.seconds_each()? * work.combinations as f64 / threads as f64;
    if seconds < TOLD {
        return Ok(());
    }
    let drawn = if work.sets > 0 { format!("{} sets of {} draws, ", grouped(work.sets), grouped(subject.draws)) } else { String::new() };
    let orders = work.orders.map_or(String::new(), |orders| format!("{orders} orders of the inputs, "));
    let cheaper = if work.sets > 0 { "; fewer --draws take less" } else { "" };
    let evaluations = scaled(work.evaluations as f64);
    terminal::remark("note", &format!("{drawn}{orders}{evaluations}evaluations take about {}{cheaper}", span(seconds)));
    Ok(())
}

/// What was looked at, and how.
fn head(report: &InfluenceReport) -> String {
    let mut grid = TextGrid::default();
    let (over, cases) = match report.design {
        Some(design) => (format!("the uncertainty of design {design}"), "operating cases"),
        None => ("the design".to_owned(), "scenarios"),
    };
    let each = if report.scenarios == 1 { String::new() } else { format!(", in {} {cases} each", grouped(report.scenarios)) };
    grid.row([bold("over"), format!("{over}{each}")]);
    let how = match report.method {
        InfluenceMethod::Grid { combinations } => format!("exact: all {} combinations of the levels", grouped(combinations)),
        InfluenceMethod::Draws { draws, sets, seed, .. } => {
            format!("estimated: {} sets of {} draws, seed {seed}; with intervals of 95 %", grouped(sets), grouped(draws))
        }
        InfluenceMethod::Screening => "screened only: there are more inputs than Sobol points have dimensions for".to_owned(),
    };
    grid.row([bold("shares"), how]);
    if let Some(orders) = report.orders {
        grid.row([bold("Shapley"), format!("from {orders} of all orders of the inputs")]);
    }
    if let Some((looked_at, hold)) = report.held_grid {
        let what = if matches!(report.method, InfluenceMethod::Grid { .. }) { "designs" } else { "designs of a coarser grid" };
        grid.row([bold("holding"), format!("{} of {} {what}", grouped(hold), grouped(looked_at))]);
    }
    if let Some(walks) = report.walks {
        grid.row([bold("screening"), format!("{walks} walks after Morris, from end to end of each input")]);
    }
    grid.indented(0)
}

/// A kind of share, by its name.
type ShownShare = (&'static str, fn(&InputReport) -> Option<Estimate>);

fn of_quantity(quantity: &QuantityReport) -> String {
    let unit = if quantity.asked.unit.is_empty() { String::new() } else { format!(" {}", quantity.asked.unit) };
    let spread = |mean: f64, sd: f64| format!("mean {}{unit}, standard deviation {}{unit}", short(mean), short(sd));
    let what = match (quantity.verdict, quantity.mean.zip(quantity.sd)) {
        (QuantityVerdict::Constant { value }, _) => format!("always {}{unit}, so nothing matters", short(value)),
        (QuantityVerdict::Absent { absent, of }, _) => format!("no value in {} of {}", grouped(absent), grouped(of)),
        (_, Some((mean, sd))) => spread(mean, sd),
        (_, None) => "screened only".to_owned(),
    };
    let mut text = format!("\n{}: {what}\n", bold(&quantity.asked.name));
    if let Some(within) = quantity.within {
        text.push_str(&format!("  where it holds: {}\n", spread(within.mean, within.sd)));
    }
    let kinds: [ShownShare; 4] = [
        ("first order", |it| it.first),
        ("total", |it| it.total),
        ("Shapley", |it| it.shapley),
        ("Shapley where it holds", |it| it.within),
    ];
    let shown: Vec<_> = kinds.iter().filter(|(_, of)| quantity.inputs.iter().any(|input| of(input).is_some())).collect();
    let is_screened = quantity.inputs.iter().any(|it| it.screening.is_some());
    if !shown.is_empty() || is_screened {
        let mut grid = TextGrid::default();
        let of_walks = if is_screened { &["mu", "mu*", "sigma"][..] } else { &[] };
        let names = shown.iter().map(|it| it.0).chain(of_walks.iter().copied());
        grid.row(std::iter::once(String::new()).chain(names.map(str::to_owned)));
        for input in &quantity.inputs {
            let shares = shown.iter().map(|(_, of)| of(input).map_or("-".to_owned(), told));
            let effects = input.screening.as_ref().map(|it| [it.mean, it.mean_absolute, it.sd].map(short));
            grid.row(std::iter::once(input.name.clone()).chain(shares).chain(effects.into_iter().flatten()));
        }
        text.push_str(&grid.indented(2));
    }
    if let Some(tornado) = quantity.tornado.as_ref().filter(|_| !matches!(quantity.verdict, QuantityVerdict::Constant { .. })) {
        text.push_str(&of_tornado(tornado, &unit));
    }
    text
}

fn of_tornado(tornado: &TornadoReport, unit: &str) -> String {
    let value = |value: Option<f64>| value.map_or("no value".to_owned(), short);
    let mut grid = TextGrid::default();
    grid.row(["alone, low to high", "low", "high", "at low", "at high"].map(str::to_owned));
    for bar in tornado.widest_first() {
        let [low, high] = bar.ends();
        grid.row([bar.name.clone(), low, high, value(bar.at_low), value(bar.at_high)]);
    }
    let middle = tornado.middle.map_or("no value".to_owned(), |it| format!("{}{unit}", short(it)));
    format!("{}  all in the middle: {middle}\n", grid.indented(2))
}

/// A share in three digits behind the point, with its interval.
fn told(it: Estimate) -> String {
    // No minus in front of what is 0 in these digits.
    let digits = |value: f64| format!("{:.3}", (value * 1e3).round() / 1e3 + 0.0);
    it.confidence.map_or(digits(it.value), |confidence| format!("{} ± {}", digits(it.value), digits(confidence)))
}
