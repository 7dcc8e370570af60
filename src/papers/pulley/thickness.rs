//! The thickness study of sections 4.2 to 4.4.

use super::super::{Figure, Inputs, Paper, PaperTable, numbers, words};
use super::example;
use crate::models::CHECK_POINT_STRESSES;
use crate::pictures::{Guide, Line, Marker, PlotQuantity, Scale, Stroke, lines};
use crate::table::{Data, Table, TableColumn};

/// The paper's direction of friction, deg from the circumference, and the customary one.
pub(super) const DIRECTIONS: [f64; 2] = [45.0, 0.0];
/// What the table shows, mm: three around the printed choice, as the paper's three were, and their neighbours.
const THICKNESSES: [f64; 6] = [1.4, 1.6, 1.8, 2.0, 2.2, 2.4];

/// One sheet under one direction of friction.
pub(super) struct SheetCase {
    pub direction: f64,
    pub thickness: f64,
    pub stress: f64,
    pub volume: f64,
    points: [f64; CHECK_POINT_STRESSES.len()],
    /// Is it the thinnest of the table whose stress stays below the yield strength?
    pub chosen: bool,
}

/// The example with every thickness of the table, in both directions of friction.
pub(super) fn study() -> Vec<SheetCase> {
    let example = example();
    let limit = example.input("yield_strength_MPa");
    let mut sheets = Vec::new();
    for direction in DIRECTIONS {
        let of_thickness = |thickness: f64| {
            let outputs = example.with(&[("thickness_mm", thickness), ("friction_direction_deg", direction)]).outputs();
            SheetCase {
                direction,
                thickness,
                stress: outputs.get("max_stress_MPa"),
                volume: outputs.get("volume_mm3"),
                points: CHECK_POINT_STRESSES.map(|name| outputs.get(name)),
                chosen: false,
            }
        };
        let mut of_one: Vec<SheetCase> = THICKNESSES.map(of_thickness).into();
        if let Some(thinnest) = of_one.iter_mut().find(|sheet| sheet.stress <= limit) {
            thinnest.chosen = true;
        }
        sheets.extend(of_one);
    }
    sheets
}

/// The thickness that is chosen in a direction of friction, mm.
pub(super) fn choice(studied: &[SheetCase], direction: f64) -> f64 {
    let of_one = |sheet: &&SheetCase| sheet.direction == direction && sheet.chosen;
    studied.iter().find(of_one).expect("some sheet is thick enough").thickness
}

/// The table of the study.
pub(super) fn table(studied: &[SheetCase]) -> PaperTable {
    let each = |of: fn(&SheetCase) -> f64| studied.iter().map(move |sheet| Some(of(sheet)));
    let mut columns = vec![
        numbers("friction_direction_deg", "deg", "Direction of friction from the circumference.", each(|sheet| sheet.direction)),
        numbers("thickness_mm", "mm", "Thickness of the sheet.", each(|sheet| sheet.thickness)),
    ];
    for (at, name) in CHECK_POINT_STRESSES.into_iter().enumerate() {
        columns.push(numbers(
            name,
            "MPa",
            "Largest von Mises stress at the check point.",
            studied.iter().map(|sheet| Some(sheet.points[at])),
        ));
    }
    columns.push(numbers("max_stress_MPa", "MPa", "Largest von Mises stress.", each(|sheet| sheet.stress)));
    columns.push(numbers("volume_mm3", "mm³", "Volume of the pulley.", each(|sheet| sheet.volume)));
    let choice = studied.iter().map(|sheet| if sheet.chosen { "chosen" } else { "" });
    columns.push(words("choice", "The thinnest of these that stays below the yield strength.", choice));
    PaperTable {
        id: "pulley-thickness-table",
        title: "Thickness study: stresses at the check points, largest stress and volume".to_owned(),
        caption: "As in the paper's last dialog, for the pressed cup at a yield strength of 270 MPa. The paper tried three thicknesses and prints the \
                  chosen one alone, 1.8 mm; 1.6 and 2.0 mm beside it and the others are our choice, and so is the section."
            .to_owned(),
        group: Paper::Pulley,
        table: Table { columns },
    }
}

/// Largest stress over the thickness.
pub(super) fn figure(studied: &[SheetCase]) -> Figure {
    let example = example();
    let limit = example.input("yield_strength_MPa");
    let finely: Vec<f64> = (0..=20).map(|step| f64::from(140 + 5 * step) / 100.0).collect();
    let stress = |direction: f64, thickness: f64| largest(&example, direction, thickness);
    let curves = DIRECTIONS.map(|direction| finely.iter().map(|thickness| stress(direction, *thickness)).collect::<Vec<_>>());
    let labels = ["friction at 45°, as in the paper", "friction along the circumference, as is customary"];
    let mut drawn = Vec::new();
    for (colour, (direction, label)) in DIRECTIONS.into_iter().zip(labels).enumerate() {
        let curve = Line {
            label: label.to_owned(),
            x: finely.clone(),
            y: curves[colour].clone(),
            colour,
            stroke: Stroke::Solid,
            marker: Marker::None,
        };
        let of_one: Vec<&SheetCase> = studied.iter().filter(|sheet| sheet.direction == direction).collect();
        let marks = |chosen: bool| of_one.iter().copied().filter(move |sheet| sheet.chosen == chosen);
        let dots = |label: &str, chosen: bool, marker| Line {
            // Once in the legend is enough.
            label: if colour == 0 { label.to_owned() } else { String::new() },
            x: marks(chosen).map(|sheet| sheet.thickness).collect(),
            y: marks(chosen).map(|sheet| sheet.stress).collect(),
            stroke: Stroke::None,
            marker,
            ..curve.clone()
        };
        let all = [dots("tried", false, Marker::Open), dots("thinnest below the yield strength", true, Marker::Filled)];
        drawn.push(curve);
        drawn.extend(all);
    }
    let title = "Thickness study: largest stress of the pressed cup over the sheet's thickness";
    let x = Scale { quantity: PlotQuantity::new("sheet thickness t", "mm"), range: Some((1.35, 2.45)) };
    let y = Scale { quantity: PlotQuantity::new("largest von Mises stress", "MPa"), range: Some((0.0, 450.0)) };
    let guides = [
        Guide { at: limit, upright: false, words: format!("yield strength {limit} MPa"), colour: None },
        Guide { at: 1.8, upright: true, words: "chosen in the paper: 1.8 mm".to_owned(), colour: None },
    ];
    let both = |values: &[Vec<f64>; 2]| values.iter().flatten().copied().map(Some).collect::<Vec<_>>();
    let directions = DIRECTIONS.map(|direction| vec![direction; finely.len()]);
    let thicknesses = [finely.clone(), finely.clone()];
    Figure {
        id: "pulley-thickness",
        title: title.to_owned(),
        caption: "With the friction of the paper, equal parts along the flank and around, the thinnest sheet in steps of 0.2 mm is the paper's \
                  1.8 mm. With friction around the circumference alone, which is customary, the same sheet would yield and 2.0 mm is needed: the \
                  paper's assumption is not the safe one."
            .to_owned(),
        group: Paper::Pulley,
        svg: lines(title, &x, &y, &drawn, &guides),
        table: Table {
            columns: vec![
                numbers("friction_direction_deg", "deg", "Direction of friction from the circumference.", both(&directions)),
                numbers("thickness_mm", "mm", "Thickness of the sheet.", both(&thicknesses)),
                TableColumn { unit: "MPa".to_owned(), ..TableColumn::new("max_stress_MPa", "paper", "Largest von Mises stress.", Data::Number(both(&curves))) },
            ],
        },
    }
}

/// Largest stress of the example, MPa.
fn largest(example: &Inputs, direction: f64, thickness: f64) -> f64 {
    example.with(&[("thickness_mm", thickness), ("friction_direction_deg", direction)]).output("max_stress_MPa")
}
