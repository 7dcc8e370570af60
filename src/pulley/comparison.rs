//! Variants of a pulley side by side: stresses at the check points, the largest stress, volume and rim displacement.

use super::field::degrees;
use super::response::CHECK_POINTS;
use super::turn::Summary;
use crate::export::{Data, Table, TableColumn};

/// One variant.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// What tells it from the others: `t = 1.8 mm`.
    pub name: String,
    /// What its load case tells.
    pub summary: Summary,
    /// Volume, mm^3.
    pub volume: f64,
}

/// The table of some variants; a check point that none of them has gets no column.
pub fn table(variants: &[Variant]) -> Table {
    let column = |name: &str, unit: &str, words: &str, values: Vec<Option<f64>>| TableColumn {
        unit: unit.to_owned(),
        ..TableColumn::new(name, "comparison", words, Data::Number(values))
    };
    let each = |value: fn(&Variant) -> f64| variants.iter().map(|variant| Some(value(variant))).collect::<Vec<_>>();
    let names = variants.iter().map(|variant| variant.name.clone()).collect();
    let mut columns = vec![TableColumn::new("variant", "index", "the variant", Data::Text(names))];
    for (number, name) in CHECK_POINTS.iter().enumerate() {
        let values: Vec<_> = variants.iter().map(|variant| variant.summary.check_points[number].map(|peak| peak.stress)).collect();
        if values.iter().any(Option::is_some) {
            columns.push(column(&format!("stress_{name}_MPa"), "MPa", "largest von Mises stress at the check point over the turn", values));
        }
    }
    let largest = "largest von Mises stress outside the clamped zone";
    columns.push(column("max_stress_MPa", "MPa", largest, each(|variant| variant.summary.largest.stress)));
    columns.push(column("max_stress_theta_deg", "deg", "its angle from the slack end", each(|it| degrees(it.summary.largest.theta))));
    columns.push(column("rim_displacement_mm", "mm", "largest displacement of the rim", each(|it| it.summary.rim_displacement)));
    columns.push(column("volume_mm3", "mm3", "volume of the pulley", each(|variant| variant.volume)));
    Table { columns }
}

/// A table of names and numbers as aligned text; numbers with as many decimals as five digits of the largest of their column have.
pub fn aligned(table: &Table) -> String {
    let columns: Vec<Vec<String>> = table.columns.iter().map(cells).collect();
    let widths: Vec<usize> = columns.iter().map(|cells| cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0)).collect();
    let mut text = String::new();
    for row in 0..=table.rows() {
        let mut line = String::new();
        for ((column, cells), width) in table.columns.iter().zip(&columns).zip(&widths) {
            let cell = &cells[row];
            match column.data {
                Data::Text(_) => line += &format!("{cell:<width$}  "),
                _ => line += &format!("{cell:>width$}  "),
            }
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// Head and cells of a column.
fn cells(column: &TableColumn) -> Vec<String> {
    let head = std::iter::once(column.name.clone());
    match &column.data {
        Data::Text(values) => head.chain(values.iter().cloned()).collect(),
        Data::Whole(values) => head.chain(values.iter().map(|it| it.map_or("-".to_owned(), |it| it.to_string()))).collect(),
        Data::Number(values) => {
            let largest = values.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
            let decimals = (0..8).find(|&it| largest * decade(it) >= 10_000.0).unwrap_or(8);
            head.chain(values.iter().map(|it| it.map_or("-".to_owned(), |it| format!("{it:.decimals$}")))).collect()
        }
    }
}

fn decade(exponent: usize) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * 10.0)
}

#[cfg(test)]
mod tests {
    use super::super::turn::Peak;
    use super::*;
    use crate::export::csv_text;

    fn variant(name: &str, stress: f64, has_f: bool) -> Variant {
        let peak = |stress| Some(Peak { stress, ..Peak::default() });
        let mut check_points = [None; CHECK_POINTS.len()];
        (check_points[0], check_points[8]) = (peak(20.64), if has_f { peak(stress - 5.0) } else { None });
        let largest = Peak { stress, theta: 1.0471975511965976, ..Peak::default() };
        let summary = Summary { largest, check_points, own_points: [None; 2], rim_displacement: 0.204_47, fatigue: None };
        Variant { name: name.to_owned(), summary, volume: 51_745.7 }
    }

    #[test]
    fn one_row_per_variant_and_no_column_for_points_that_none_has() {
        let table = table(&[variant("t = 1.8", 240.9, true), variant("flat, thick", 158.5, false)]);
        let csv = String::from_utf8(csv_text(&table)).unwrap();
        let rows: Vec<&str> = csv.lines().collect();
        assert_eq!(rows[0], "variant,stress_Bl_MPa,stress_Fl_MPa,max_stress_MPa,max_stress_theta_deg,rim_displacement_mm,volume_mm3");
        assert_eq!(rows[1], "t = 1.8,20.64,235.9,240.9,60,0.20447,51745.7");
        assert!(rows[2].starts_with("\"flat, thick\",20.64,,158.5,"), "{csv}");
        let text = aligned(&table);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines[1].starts_with("t = 1.8 ") && lines[1].contains(" 240.90 ") && lines[1].ends_with(" 51746"), "{text}");
        assert!(lines[2].contains(" - "), "{text}");
        assert!(lines.iter().all(|line| line.chars().count() == lines[0].chars().count()), "{text}");
    }
}
