//! The pictures of an analysis.

use super::results::{Estimate, InfluenceMethod, InfluenceReport, InputReport, QuantityReport, TornadoReport};
use crate::pictures::{BarGroup, PlotBar, PlotQuantity, Swing, bars, spaced, tornado};
use crate::study::InfluenceOver;

/// Names and texts of the pictures: one of the shares of each quantity that has some, and a tornado.
pub(super) fn pictures(report: &InfluenceReport) -> Vec<(String, String)> {
    let mut pictures = Vec::new();
    for quantity in &report.quantities {
        if let Some(svg) = shares(report, quantity) {
            pictures.push((quantity.asked.shares_file(), svg));
        }
        if let Some(found) = quantity.tornado.as_ref().filter(|it| it.moves()) {
            pictures.push((quantity.asked.tornado_file(), swings(report, quantity, found)));
        }
    }
    pictures
}

/// What the picture is of.
fn subject(report: &InfluenceReport) -> String {
    match (report.over, report.design) {
        (InfluenceOver::Uncertainty, Some(design)) => format!("{}: uncertainty of design {design}", report.title),
        _ => format!("{}: over the design", report.title),
    }
}

/// A kind of share, by its name.
type ShareOf = (&'static str, fn(&InputReport) -> Option<Estimate>);

fn shares(report: &InfluenceReport, quantity: &QuantityReport) -> Option<String> {
    let kinds: [ShareOf; 4] = [
        ("first order", |it| it.first),
        ("total", |it| it.total),
        ("Shapley", |it| it.shapley),
        ("Shapley, designs that hold", |it| it.within),
    ];
    let shown: Vec<&ShareOf> = kinds.iter().filter(|(_, of)| quantity.inputs.iter().any(|input| of(input).is_some())).collect();
    let what = spaced(&quantity.asked.name);
    let title = format!("{}, {what}", subject(report));
    if shown.is_empty() {
        // Many inputs without shares: their effects instead.
        quantity.inputs.iter().find(|it| it.screening.is_some())?;
        let group = |input: &InputReport| {
            let bar = input.screening.as_ref().map(|it| PlotBar { value: it.mean_absolute, whisker: None });
            let spread = input.screening.as_ref().map(|it| PlotBar { value: it.sd, whisker: None });
            BarGroup { name: input.name.clone(), bars: vec![bar, spread] }
        };
        let axis = PlotQuantity::new(format!("change of {what} per range of the input"), quantity.asked.unit.clone());
        let series = ["mean absolute effect", "standard deviation of the effects"].map(str::to_owned);
        return Some(bars(&title, &axis, &series, &quantity.inputs.iter().map(group).collect::<Vec<_>>()));
    }
    let bar = |it: Estimate| PlotBar { value: it.value, whisker: it.confidence };
    let group = |input: &InputReport| {
        let bars = shown.iter().map(|(_, of)| of(input).map(bar)).collect();
        BarGroup { name: input.name.clone(), bars }
    };
    let series: Vec<String> = shown.iter().map(|(name, _)| (*name).to_owned()).collect();
    let how = if matches!(report.method, InfluenceMethod::Draws { .. }) { ", bars of 95 % confidence" } else { "" };
    let axis = PlotQuantity::new(format!("share of the variance{how}"), "");
    Some(bars(&title, &axis, &series, &quantity.inputs.iter().map(group).collect::<Vec<_>>()))
}

fn swings(report: &InfluenceReport, quantity: &QuantityReport, found: &TornadoReport) -> String {
    let swing = |it: &super::TornadoBar| {
        let [low, high] = it.ends();
        Swing { name: it.name.clone(), low, high, at_low: it.at_low, at_high: it.at_high }
    };
    let swings: Vec<Swing> = found.widest_first().into_iter().map(swing).collect();
    tornado(&subject(report), &PlotQuantity::new(&quantity.asked.name, &quantity.asked.unit), found.middle, &swings)
}
