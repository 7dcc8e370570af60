//! Stripes on a map that are no physics: each cell shows its best design over the other axes, and where that design changes to another level
//! of one of them, the value jumps back.

use crate::plan::Plan;
use crate::study::{Axis, MapSpec};
use crate::table::short;

/// Cells that a line over the map must have, so that jumps in it can be told from its course.
const LONG: usize = 8;
/// Jumps in a line from which on it is striped.
const STRIPED: usize = 2;

/// A sentence on the stripes of a map, whose cells are given row by row in y, then x; `None` if it has none.
pub fn stripes(plan: &Plan, spec: &MapSpec, values: &[f64], designs: &[Option<u64>]) -> Option<String> {
    let study = &plan.study;
    let [width, height] = [spec.x, spec.y].map(|axis| study.design[axis].count() as usize);
    let inputs: Vec<Option<Vec<f64>>> = designs.iter().map(|design| design.map(|it| plan.space.inputs(it, 0))).collect();
    let along_x = (0..height).map(|y| (0..width).map(|x| y * width + x).collect::<Vec<_>>());
    let along_y = (0..width).map(|x| (0..height).map(|y| y * width + x).collect::<Vec<_>>());
    let lines = [(spec.x, along_x.collect::<Vec<_>>()), (spec.y, along_y.collect())];
    for (axis, lines) in lines {
        for (other, at) in study.design.iter().enumerate().filter(|(other, _)| *other != spec.x && *other != spec.y) {
            let Axis::Single { input, .. } = at else { continue };
            let level = |cell: usize| inputs[cell].as_ref().map(|it| it[*input]);
            let found: Vec<Vec<usize>> = lines.iter().map(|line| jumps(line, values, &level)).collect();
            let striped = found.iter().filter(|it| it.len() >= STRIPED).count();
            // In most of the lines, or it is the course of the value in some corner.
            if 2 * striped <= lines.len() {
                continue;
            }
            let (line, first) = found.iter().enumerate().find(|(_, it)| it.len() >= STRIPED)?;
            let name = |axis: &Axis| study.model.inputs[axis.inputs()[0]].name.clone();
            let along = &study.design[axis];
            let shown = |&cell: &usize| short(along.value(0, lines[line].iter().position(|it| *it == cell).unwrap_or(0) as u64));
            let places = first.iter().take(4).map(shown).collect::<Vec<_>>().join(", ");
            let more = if first.len() > 4 { " and further" } else { "" };
            let (along, levels, other) = (name(along), study.design[other].count(), name(at));
            return Some(format!(
                "Stripes: along {along} the value jumps back at {places}{more}, where the best design of a cell is on another level of \
                 {other}. These steps come from the {levels} levels of {other}, not from the drive: give {other} more levels, or make it \
                 an axis of the map."
            ));
        }
    }
    None
}

/// The cells of a line to which the value jumps against its course, while the level of another axis changes there and not beside it.
fn jumps(line: &[usize], values: &[f64], level: &dyn Fn(usize) -> Option<f64>) -> Vec<usize> {
    let line: Vec<(usize, f64, f64)> = line.iter().filter_map(|&cell| Some((cell, values[cell], level(cell)?))).collect();
    if line.len() < LONG {
        return Vec::new();
    }
    let step = |at: usize| line[at + 1].1 - line[at].1;
    let changes = |at: usize| line[at + 1].2.to_bits() != line[at].2.to_bits();
    let against = |at: usize| step(at) * step(at - 1) < 0.0 && step(at) * step(at + 1) < 0.0;
    (1..line.len() - 2).filter(|&at| against(at) && changes(at) && !changes(at - 1) && !changes(at + 1)).map(|at| line[at + 1].0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    fn told(other: &str, value: impl Fn(f64) -> (f64, u64)) -> Option<String> {
        let text = format!(
            "model = \"metal-cvt\"\n[design]\nband_thickness_mm = [0.1, 0.2]\ngroove_angle_deg = {{ from = 20, to = 30, count = 21 }}\n\
             {other}\n[objectives]\naxial_force_N = \"min\"\n[report]\n\
             maps = [{{ x = \"band_thickness_mm\", y = \"groove_angle_deg\", value = \"axial_force_N\" }}]\n"
        );
        let plan = Plan::new(Study::parse(&text).expect("a study"));
        let spec = plan.study.report.maps[0].clone();
        let at = |level: u64| value(20.0 + 0.5 * level as f64);
        let cells = || (0..21).flat_map(|y| (0..2).map(move |x| (x, y)));
        let values: Vec<f64> = cells().map(|(_, y)| at(y).0).collect();
        // The last axis runs fastest.
        let levels = plan.study.design[2].count();
        let designs: Vec<_> = cells().map(|(x, y)| Some((x * 21 + y) * levels + at(y).1)).collect();
        stripes(&plan, &spec, &values, &designs)
    }

    #[test]
    fn a_saw_of_the_levels_of_another_axis_is_found_and_a_course_is_not() {
        let traction = "traction = { from = 0.2, to = 0.5, count = 4 }";
        // The value falls, and each 3 degrees the next level is needed, which costs more.
        let saw = |angle: f64| {
            let level = ((angle - 20.0) / 3.0).floor();
            (1000.0 - 10.0 * angle + 60.0 * level, level as u64)
        };
        let said = told(traction, saw).expect("stripes");
        assert!(said.contains("along groove_angle_deg") && said.contains("23, 26, 29") && said.contains("4 levels of traction"), "{said}");
        // The same levels without a jump, a jump without another level, and a single one.
        assert_eq!(told(traction, |angle| (1000.0 - 10.0 * angle, saw(angle).1)), None);
        assert_eq!(told(traction, |angle| (saw(angle).0, 0)), None);
        let once = |angle: f64| (1000.0 - 10.0 * angle + if angle < 25.0 { 0.0 } else { 60.0 }, u64::from(angle >= 25.0));
        assert_eq!(told(traction, once), None);
    }
}
