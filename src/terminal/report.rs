//! The summary of a sweep on the terminal.

use super::{TextGrid, bold, counted, dim, grouped, scaled, short, span, width};
use beltspace::certify::Row;
use beltspace::export::{Certified, Confirmed, DrawnTally, RunRecord, Summary};
use beltspace::influence::{InfluenceMethod, InfluenceReport, QuantityVerdict};
use beltspace::models::OVERFLOW;
use beltspace::study::{Axis, Goal, Study};
use std::path::{Path, PathBuf};
use textplots::{Chart, LabelBuilder, LabelFormat, Plot, Shape};

/// Designs of the front that are shown.
const SHOWN: usize = 8;

/// The summary as text.
#[allow(clippy::cast_precision_loss, reason = "shares for people")]
pub fn summary(outcome: &Certified<'_>, record: &RunRecord, out: &Path, page: Option<&PathBuf>) -> String {
    let plan = outcome.plan;
    let study = &plan.study;
    let feasible = outcome.state.feasible;
    let share = 100.0 * feasible as f64 / plan.designs() as f64;
    let mut facts = TextGrid::default();
    let mut fact = |what: &str, value: String| facts.row([bold(what), value]);
    let (designs, time, rate) = (grouped(plan.designs()), span(record.time.as_secs_f64()), record.rate());
    fact(
        "designs",
        match plan.scenarios() {
            1 if record.designs == 0 => format!("{designs}, all judged before this run"),
            scenarios if record.designs == 0 => format!("{designs} x {}, all judged before this run", counted(scenarios, "scenario")),
            scenarios => {
                let of = if scenarios == 1 { String::new() } else { format!(" x {}", counted(scenarios, "scenario")) };
                // Draws and operating cases are evaluations too.
                let judged = match plan.evaluations() {
                    1 => String::new(),
                    evaluations => format!(", up to {}evaluations/s", scaled(rate * evaluations as f64)),
                };
                format!("{designs}{of} in {time}, {}designs/s{judged}", scaled(rate))
            }
        },
    );
    fact("feasible", format!("{} ({} %)", grouped(feasible), short((share * 100.0).round() / 100.0)));
    if let Some(certificate) = &record.method.certificate {
        let evaluations = counted(certificate.evaluations(), "evaluation");
        let boxes = if certificate.boxes() == 1 { "1 box".to_owned() } else { format!("{} boxes", grouped(certificate.boxes())) };
        fact("bounds", format!("{boxes} and {evaluations} settled every design; run.json counts them by rule"));
    }
    if let Some(left) = &record.method.left {
        let (settled, judged) = (counted(left.counted, "design"), grouped(left.judged));
        let (spent, were) = (span(left.forecast.spent), if left.judged == 1 { "was" } else { "were" });
        fact("bounds", format!("given up after {spent} ({}), with {settled} settled; {judged} {were} judged one by one", left.at));
    }
    if let Some(device) = &record.device {
        let count = |name: &str| device[name].as_u64().unwrap_or(0);
        let compared = grouped(device["compared_with_f64"]["designs"].as_u64().unwrap_or(0));
        let name = device["adapter"].as_str().unwrap_or_default();
        fact(
            "GPU",
            format!(
                "{name}: {} left to f64, {} of them unsure; {compared} compared with f64",
                counted(count("survivors"), "design"),
                grouped(count("unsure_designs"))
            ),
        );
    }
    if !study.objectives.is_empty() {
        let designs = match outcome.front.len() {
            0 => "empty".to_owned(),
            count => counted(count as u64, "design") + if count > 1 { ", each" } else { "" },
        };
        let certified = if outcome.front.is_empty() { "" } else { " certified in f64 over every scenario" };
        fact("front", format!("{designs}{certified}"));
    }
    let confirmed = Confirmed::of(outcome);
    if let Some(Confirmed { draws, designs, wanted, together, .. }) = confirmed {
        let kept = wanted.map_or(String::new(), |(wanted, kept)| {
            let keep = if kept == 1 { "keeps" } else { "keep" };
            format!("{} of {} {keep} a yield of {wanted} in ", grouped(kept), counted(designs, "design"))
        });
        let have = if designs == 1 { "it has".to_owned() } else { format!("all {} have", grouped(designs)) };
        let all = format!("{have} {} or more with 99 % confidence", short(together));
        fact("confirmed", format!("{kept}{}; {all}", counted(draws, "fresh draw")));
    }
    let mut text = format!("{}\n\n{}", bold(&super::told(&study.title)), facts.indented(0));
    text.push_str(&limits(outcome));
    if !outcome.front.is_empty() {
        text.push_str(&front(outcome, confirmed.as_ref()));
        text.push_str(&plot(outcome));
    }
    text.push_str(&influence(outcome));
    for finding in outcome.findings.in_words(study) {
        text.push_str(&format!("\n{} {finding}", bold("finding")));
    }
    if !outcome.findings.is_empty() {
        text.push('\n');
    }
    for remark in study.remarks() {
        text.push_str(&format!("\n{} {remark}\n", bold("note")));
    }
    text.push_str(&format!("\n{} {}\n", bold("result"), out.display()));
    if let Some(page) = page {
        text.push_str(&format!("{}   {}\n", bold("page"), page.display()));
    }
    text
}

/// What limits feasibility, worst first.
fn limits(outcome: &Certified<'_>) -> String {
    let tally = &outcome.tally;
    let study = &outcome.plan.study;
    let model = &study.model;
    let statuses = tally.statuses(study).into_iter();
    let mut reasons: Vec<(u64, u64, String)> = statuses.map(|(reason, count)| (count, 0, reason.to_owned())).collect();
    reasons.push((tally.overflow, 0, OVERFLOW.to_owned()));
    for (constraint, (&violated, &only)) in study.constraints.iter().zip(tally.constraints.iter().zip(&tally.only)) {
        let unit = study.unit_over(constraint.quantity, constraint.over);
        reasons.push((violated, only, format!("{} {} {unit}", constraint.name(model), constraint.in_words()).trim_end().to_owned()));
    }
    let what = if tally.sampled == outcome.plan.designs() {
        "of all designs".to_owned()
    } else {
        format!("of a sample of {}", counted(tally.sampled, "design"))
    };
    listed(&format!("{} {what}", bold("what limits feasibility,")), reasons, tally.sampled)
        + &outcome.drawn.as_ref().map_or_else(String::new, |drawn| draw_limits(drawn, study))
}

/// What draws fail at, worst first.
pub fn draw_limits(drawn: &DrawnTally, study: &Study) -> String {
    let Some(probability) = &study.probability else { return String::new() };
    let drive = &probability.drive;
    let mut reasons: Vec<(u64, u64, String)> = drawn.statuses.iter().map(|(reason, count)| (*count, 0, reason.clone())).collect();
    for (constraint, &(violated, only)) in drive.constraints.iter().zip(&drawn.constraints) {
        let unit = drive.unit_of(constraint);
        reasons.push((violated, only, format!("{} {} {unit}", constraint.name(&drive.model), constraint.in_words()).trim_end().to_owned()));
    }
    let what =
        if drawn.sampled == drawn.of { "of all draws".to_owned() } else { format!("of a sample of {}", counted(drawn.sampled, "draw")) };
    listed(&format!("{} {what}", bold("what draws fail at,")), reasons, drawn.sampled)
}

/// Reasons with how many of `all` fail for them, and how many for nothing else, worst first.
fn listed(head: &str, mut reasons: Vec<(u64, u64, String)>, all: u64) -> String {
    reasons.retain(|(count, ..)| *count > 0);
    reasons.sort_by_key(|(count, ..)| std::cmp::Reverse(*count));
    if reasons.is_empty() {
        return String::new();
    }
    let mut grid = TextGrid::default();
    for (count, only, reason) in reasons {
        let alone = if only > 0 { dim(&format!("(alone: {})", share(only, all))) } else { String::new() };
        grid.row([reason, format!("fails {}", share(count, all)), alone]);
    }
    format!("\n{head}\n{}", grid.indented(2))
}

/// A share in percent with one digit; 0 and 100 are none and all.
#[allow(clippy::cast_precision_loss, reason = "a share for people")]
fn share(count: u64, all: u64) -> String {
    let percent = format!("{:.1}", 100.0 * count as f64 / all as f64);
    match percent.as_str() {
        "0.0" if count > 0 => "<0.1 %".to_owned(),
        "100.0" if count < all => ">99.9 %".to_owned(),
        _ => format!("{percent} %"),
    }
}

/// A label as it is listed: a long one is cut off, and the tables have all of it.
fn shown_label(text: &str) -> String {
    const MOST: usize = 32;
    let text = super::told(text);
    if text.chars().nth(MOST).is_none() { text } else { text.chars().take(MOST - 3).chain("...".chars()).collect() }
}

/// Ideal, knee and the best designs by the first objective, and what the knee is made of.
fn front(outcome: &Certified<'_>, confirmed: Option<&Confirmed>) -> String {
    let study = &outcome.plan.study;
    let model = &study.model;
    let summary = Summary::new(outcome);
    let columns = outcome.objective_columns();
    let goals = study.objectives.iter().map(|it| format!("{} ({})", it.name(model), if it.goal == Goal::Min { "min" } else { "max" }));
    let mut grid = TextGrid::default();
    let labels = study.labels.iter().map(|it| it.name.clone());
    let missing = confirmed.map_or(&[][..], |it| &it.missing);
    let fresh = (!missing.is_empty()).then(|| "in fresh draws".to_owned());
    grid.row(std::iter::once(String::new()).chain(goals.chain(["design".to_owned()]).chain(labels).chain(fresh).map(|head| bold(&head))));
    if let Some(ideal) = &summary.ideal {
        grid.row(std::iter::once("ideal".to_owned()).chain(ideal.iter().map(|&value| short(value))));
    }
    let mut row = |label: &str, row: &Row| {
        let objectives = columns.iter().map(|&column| row.columns[column].value.map_or(String::new(), short));
        let labels = outcome.plan.labels(row.index).map(shown_label);
        let missed = missing.iter().find(|it| it.0 == row.index).map(|it| format!("{}, too few", short(it.1)));
        grid.row(std::iter::once(label.to_owned()).chain(objectives).chain([row.index.to_string()]).chain(labels).chain(missed));
    };
    let knee = summary.knee.map(|knee| &outcome.front[knee.row]);
    if let Some(knee) = knee {
        row("knee", knee);
    }
    for design in outcome.front.iter().take(SHOWN) {
        row("", design);
    }
    let more = outcome.front.len().saturating_sub(SHOWN);
    let more = if more > 0 {
        dim(&format!("  ... and {} more, best of the first objective first, in front.csv\n", grouped(more as u64)))
    } else {
        String::new()
    };
    let inputs = knee.map_or(String::new(), |knee| {
        let each = study.design.iter().flat_map(Axis::inputs).map(|&input| {
            let value = knee.inputs[input];
            format!("{} {}", model.inputs[input].name, model.inputs[input].word_for(value).map_or_else(|| short(value), str::to_owned))
        });
        let labels = study.labels.iter().zip(outcome.plan.labels(knee.index));
        let labels = labels.map(|(label, text)| format!("{} {}", label.name, shown_label(text)));
        format!("\n{} {} (design {})\n", bold("knee:"), labels.chain(each).collect::<Vec<_>>().join(", "), knee.index)
    });
    format!("\n{}\n{}{more}{inputs}", bold("front"), grid.indented(2))
}

/// Of each quantity the inputs that matter most, and in which file more stands.
fn influence(outcome: &Certified<'_>) -> String {
    let head = bold("what matters");
    if let Some(why) = outcome.lacks_influence() {
        return format!("\n{head}: {why}\n");
    }
    let Some(report) = &outcome.influence else { return String::new() };
    let is_screened = report.method == InfluenceMethod::Screening;
    // A share in three digits.
    let shown = |value: f64| short(if is_screened { value } else { (value * 1e3).round() / 1e3 + 0.0 });
    let mut grid = TextGrid::default();
    for quantity in &report.quantities {
        let weights = quantity.leading().into_iter().filter_map(|it| Some((&it.name, shown(it.weight()?))));
        let each = weights.filter(|it| it.1 != "0").map(|(name, weight)| format!("{name} {weight}")).collect::<Vec<_>>().join(", ");
        let said = match quantity.verdict {
            QuantityVerdict::Constant { .. } => "always the same".to_owned(),
            QuantityVerdict::Absent { absent, of } if each.is_empty() => format!("no value in {} of {}", grouped(absent), grouped(of)),
            QuantityVerdict::Shares if each.is_empty() => "no share is larger than its interval; more draws tell".to_owned(),
            _ => each,
        };
        grid.row([quantity.asked.name.clone(), said]);
    }
    let over = report.design.map_or("over the design".to_owned(), |design| format!("of what is uncertain about design {design}"));
    format!("\n{head} {over}, by {}: sensitivity.csv\n{}", ranking(report), grid.indented(2))
}

/// What the inputs are ranked by.
fn ranking(report: &InfluenceReport) -> &'static str {
    match report.method {
        InfluenceMethod::Draws { correlated: true, .. } => "Shapley effects",
        InfluenceMethod::Grid { .. } | InfluenceMethod::Draws { .. } => "total indices",
        InfluenceMethod::Screening => "mean absolute effects",
    }
}

/// Digits behind the point with which both ends of an axis, and what is a tenth of it apart, read as different numbers.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number from 0 to 9")]
fn digits_between(low: f32, high: f32) -> usize {
    let span = high - low;
    if span > 0.0 { (1.0 - span.log10()).ceil().clamp(0.0, 9.0) as usize } else { 1 }
}

/// A front of two objectives as a picture of characters, where the terminal is wide enough.
#[allow(clippy::cast_possible_truncation, reason = "a picture of a few hundred dots")]
fn plot(outcome: &Certified<'_>) -> String {
    let points = Summary::new(outcome).points();
    let study = &outcome.plan.study;
    let columns = match width() {
        Some(width) if study.objectives.len() == 2 && points.len() > 1 && width >= 60 => width.min(100),
        _ => return String::new(),
    };
    let points: Vec<(f32, f32)> = points.iter().map(|point| (point[0] as f32, point[1] as f32)).collect();
    let (low, high) = points.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), point| (low.min(point.0), high.max(point.0)));
    if low >= high {
        return String::new();
    }
    // The characters are dot matrices, two dots wide.
    let dots = u32::try_from(2 * (columns - 12)).unwrap_or(120);
    let shape = Shape::Points(&points);
    let mut chart = Chart::new(dots, 48, low, high);
    let (bottom, top) = points.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), point| (low.min(point.1), high.max(point.1)));
    let label = |low: f32, high: f32| {
        let digits = digits_between(low, high);
        LabelFormat::Custom(Box::new(move |value| format!("{value:.digits$}")))
    };
    let chart = chart.lineplot(&shape).x_label_format(label(low, high)).y_label_format(label(bottom, top));
    chart.borders();
    chart.axis();
    chart.figures();
    let name = |objective: usize| study.objectives[objective].name(&study.model);
    format!(
        "\n{}\n{chart}{}\n",
        dim(&format!("{} upwards", name(1))),
        dim(&format!("{:>width$}", name(0), width = columns.saturating_sub(14)))
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_of_nearly_all_is_not_all() {
        let shares = [0, 1, 500, 9999, 10_000].map(|count| share(count, 10_000));
        assert_eq!(shares, ["0.0 %", "<0.1 %", "5.0 %", ">99.9 %", "100.0 %"]);
    }

    #[test]
    fn the_ends_of_an_axis_read_as_different_numbers() {
        for (low, high, ends) in [
            (0.9995, 1.0, ["0.99950", "1.00000"]),
            (0.4, 2.0, ["0.4", "2.0"]),
            (58_138.0, 75_000.0, ["58138", "75000"]),
            (3.0, 4.0, ["3.0", "4.0"]),
        ] {
            let digits = digits_between(low, high);
            assert_eq!([low, high].map(|it| format!("{it:.digits$}")), ends);
        }
        assert_eq!(digits_between(2.0, 2.0), 1);
    }
}
