//! The belt's load over the wrap, and Fig. 13: stresses of the four types.

use super::super::{Figure, Inputs, Paper, numbers};
use super::Stressed;
use crate::export::pulley::NodeStress;
use crate::pictures::{PlotQuantity, Series, curves};
use crate::table::Table;

/// Tension, line force and flank force over the wrap.
pub(super) fn loads() -> Figure {
    let belt = Inputs::preset("pulley-load", "paper");
    let position = belt.column("wrap_position_deg");
    let columns = [
        ("tension_N", "belt tension T", "N", "Belt tension, (14)."),
        ("line_force_N_per_mm", "force on the pulley Q", "N/mm", "Radial force of the belt per length, (9)."),
        ("flank_force_N_per_mm", "force on a flank R", "N/mm", "Normal force on one flank per length, (10)."),
    ];
    let values = columns.map(|(name, ..)| belt.column(name));
    let panel = |((_, words, unit, _), y): (&(&str, &str, &str, &str), &Vec<f64>)| {
        let series = Series { label: String::new(), x: position.clone(), y: y.clone() };
        (PlotQuantity::new(*words, *unit), vec![series])
    };
    let panels: Vec<_> = columns.iter().zip(&values).map(panel).collect();
    let title = "Loads over the wrap, from the slack end (0°) to the tight end";
    let mut table = vec![numbers("wrap_position_deg", "deg", "Angle from the slack end.", position.iter().copied().map(Some))];
    for ((name, _, unit, words), values) in columns.iter().zip(&values) {
        table.push(numbers(name, unit, words, values.iter().copied().map(Some)));
    }
    Figure {
        id: "pulley-loads",
        title: title.to_owned(),
        caption: "(14), (9) and (10) with the data of Table 1 (700 N, 88°, 3 kW, 3000 rpm). Mean radius 60 mm, groove angle 36°, one groove and \
                  0.11 kg/m of belt are not printed and chosen. The paper applies these loads as a surface over the wrap; it prints no picture \
                  of them."
            .to_owned(),
        group: Paper::Pulley,
        svg: curves(title, &PlotQuantity::new("wrap position α", "deg"), &panels),
        table: Table { columns: table },
    }
}

/// The stressed, deformed section of one type.
pub(super) fn stresses(stressed: &Stressed) -> Figure {
    let column = |name: &str, unit: &str, words: &str, of: fn(&NodeStress) -> f64| {
        numbers(name, unit, words, stressed.nodes.iter().map(|node| Some(of(node))))
    };
    Figure {
        id: stressed.of.id,
        title: stressed.title.clone(),
        caption: format!(
            "The section at the angle of its largest stress, which stands {}. Dimensions are chosen, the paper's are lost; loads and bolts are \
             those of Table 1.",
            stressed.place.words
        ),
        group: Paper::Pulley,
        svg: stressed.svg.clone(),
        table: Table {
            columns: vec![
                column("z_mm", "mm", "Distance from the bracket face.", |node| node.place[0]),
                column("r_mm", "mm", "Distance from the axis.", |node| node.place[1]),
                column("displacement_z_mm", "mm", "Displacement along the axis.", |node| node.displacement[0]),
                column("displacement_r_mm", "mm", "Displacement away from the axis.", |node| node.displacement[1]),
                column("von_mises_MPa", "MPa", "Von Mises stress.", |node| node.von_mises),
            ],
        },
    }
}
