//! Figs 8 to 11: load of every tooth.

use super::super::{Figure, Paper, numbers, words};
use super::{TimingMesh, driven, driver_at_rest};
use crate::pictures::{Guide, Line, Marker, PlotQuantity, Scale, Stroke, lines};
use crate::table::{Data, Table, TableColumn};

/// Every figure of the paper that has something to compute.
pub(super) fn all() -> Vec<Figure> {
    vec![figure_8(), figure_9(), figure_10(), figure_11()]
}

fn figure_8() -> Figure {
    let meshes = [("driver pulley", TimingMesh::of(&driver_at_rest(490.0))), ("driven pulley", TimingMesh::of(&driven(0.0, 490.0)))];
    let drawn: Vec<Line> = meshes.iter().enumerate().map(|(colour, (label, mesh))| whole(label, mesh, &mesh.load, colour)).collect();
    figure(
        "timing-fig-8",
        "Fig. 8: tooth loads of both pulleys at rest, tight tension 490 N, slack tension 0",
        "Complete meshing, (8) and (9). The driven pulley shares the same load among 23 teeth, the driver among 11, so its teeth carry less. \
         Pulley sizes, angles and the belt's section are not printed: a belt of ISO trapezoid L is taken.",
        &drawn,
        &[],
        &meshes.each_ref().map(|(label, mesh)| (*label, mesh)),
    )
}

fn figure_9() -> Figure {
    let mesh = TimingMesh::of(&driven(5000.0, 196.0));
    let mut drawn = vec![reference("complete meshing, at rest", &mesh, 4)];
    drawn.extend(lifted("5000 rpm", &mesh, 0));
    drawn.push(open_marks());
    figure(
        "timing-fig-9",
        "Fig. 9: tooth loads at 5000 rpm and at rest, driven pulley, tight tension 196 N",
        "Before the boundary the loads are a little above those of complete meshing, behind it below. That tooth 16 is the first to lift is \
         no prediction: the paper does not print the belt's mass nor the radial balance that it uses, and the mass is set so that its tooth 16 \
         comes out.",
        &drawn,
        &[boundary(&mesh, 0)],
        &[("driven pulley", &mesh)],
    )
}

fn figure_10() -> Figure {
    let meshes = [196.0, 490.0].map(|tension| (format!("{tension} N"), TimingMesh::of(&driven(4000.0, tension))));
    let mut drawn = Vec::new();
    for (colour, (label, mesh)) in meshes.iter().enumerate() {
        drawn.push(reference(&format!("{label}, complete meshing"), mesh, colour));
        drawn.extend(lifted(label, mesh, colour));
    }
    drawn.push(open_marks());
    let guides: Vec<Guide> = meshes.iter().enumerate().map(|(colour, (_, mesh))| boundary(mesh, colour)).collect();
    figure(
        "timing-fig-10",
        "Fig. 10: tooth loads for two tight tensions, driven pulley, 4000 rpm",
        "A higher tight tension moves the boundary towards the slack side: fewer teeth lift.",
        &drawn,
        &guides,
        &meshes.each_ref().map(|(_, mesh)| ("driven pulley", mesh)),
    )
}

fn figure_11() -> Figure {
    let meshes = [2000.0, 3000.0, 4000.0, 5000.0].map(|speed| (format!("{speed} rpm"), TimingMesh::of(&driven(speed, 196.0))));
    let mut drawn = vec![reference("complete meshing, at rest", &meshes[0].1, 4)];
    for (colour, (label, mesh)) in meshes.iter().enumerate() {
        drawn.extend(lifted(label, mesh, colour));
    }
    drawn.push(open_marks());
    let guides: Vec<Guide> = meshes.iter().enumerate().map(|(colour, (_, mesh))| boundary(mesh, colour)).collect();
    figure(
        "timing-fig-11",
        "Fig. 11: tooth loads for four speeds, driven pulley, tight tension 196 N",
        "A higher speed moves the boundary towards the tight side: more teeth lift. Of the four boundaries only the one at 5000 rpm is printed \
         (Fig. 9).",
        &drawn,
        &guides,
        &meshes.each_ref().map(|(_, mesh)| ("driven pulley", mesh)),
    )
}

/// All teeth, in complete meshing.
fn whole(label: &str, mesh: &TimingMesh, loads: &[f64], colour: usize) -> Line {
    let (x, y) = (mesh.tooth.clone(), loads.to_vec());
    Line { label: label.to_owned(), x, y, colour, stroke: Stroke::Solid, marker: Marker::Filled }
}

/// The complete mesh to compare with.
fn reference(label: &str, mesh: &TimingMesh, colour: usize) -> Line {
    Line { stroke: Stroke::Dotted, marker: Marker::None, ..whole(label, mesh, &mesh.complete, colour) }
}

/// The mesh as it is: teeth that mesh, and from the last of them on those that are lifted, which come first so that they lie below.
fn lifted(label: &str, mesh: &TimingMesh, colour: usize) -> [Line; 2] {
    let meshing = mesh.first_lifted - 1;
    let part = |label: String, range: std::ops::Range<usize>, stroke, marker| Line {
        label,
        x: mesh.tooth[range.clone()].to_vec(),
        y: mesh.load[range].to_vec(),
        colour,
        stroke,
        marker,
    };
    let count = mesh.tooth.len();
    [
        part(String::new(), meshing.saturating_sub(1)..count, Stroke::Dashed, Marker::Open),
        part(label.to_owned(), 0..meshing, Stroke::Solid, Marker::Filled),
    ]
}

/// What open marks mean, for the legend.
fn open_marks() -> Line {
    let label = "open marks: lifted teeth".to_owned();
    Line { label, x: Vec::new(), y: Vec::new(), colour: 4, stroke: Stroke::Dashed, marker: Marker::Open }
}

/// Between the last tooth that meshes and the first that is lifted.
fn boundary(mesh: &TimingMesh, colour: usize) -> Guide {
    let first = mesh.first_lifted;
    Guide { at: first as f64 - 0.5, upright: true, words: format!("tooth {first} is the first lifted"), colour: Some(colour) }
}

fn figure(
    id: &'static str,
    title: &str,
    caption: &str,
    drawn: &[Line],
    guides: &[Guide],
    meshes: &[(&'static str, &TimingMesh)],
) -> Figure {
    let most = drawn.iter().flat_map(|line| &line.y).copied().fold(0.0, f64::max);
    let x = Scale { quantity: PlotQuantity::new("tooth number i, from the tight side", "–"), range: Some((0.0, 24.0)) };
    let y = Scale { quantity: PlotQuantity::new("tooth load Q(i)", "N"), range: Some((0.0, 1.12 * most)) };
    Figure {
        id,
        title: title.to_owned(),
        caption: caption.to_owned(),
        group: Paper::TimingBelt,
        svg: lines(title, &x, &y, drawn, guides),
        table: table(meshes),
    }
}

fn table(meshes: &[(&'static str, &TimingMesh)]) -> Table {
    let each = |of: fn(&TimingMesh, usize) -> f64| -> Vec<Option<f64>> {
        meshes.iter().flat_map(|(_, mesh)| (0..mesh.tooth.len()).map(move |at| Some(of(mesh, at)))).collect()
    };
    let pulley = meshes.iter().flat_map(|(pulley, mesh)| mesh.tooth.iter().map(|_| *pulley));
    let whole = |of: fn(&TimingMesh, usize) -> u64| -> Vec<Option<u64>> {
        meshes.iter().flat_map(|(_, mesh)| (0..mesh.tooth.len()).map(move |at| Some(of(mesh, at)))).collect()
    };
    Table {
        columns: vec![
            words("pulley", "The pulley.", pulley),
            numbers("pulley_speed_rpm", "rpm", "Speed of the pulley.", each(|mesh, _| mesh.speed)),
            numbers("tight_tension_N", "N", "Tension of the tight side.", each(|mesh, _| mesh.tension)),
            TableColumn::new(
                "tooth",
                "paper",
                "Number of the tooth, from the tight side.",
                Data::Whole(whole(|mesh, at| mesh.tooth[at] as u64)),
            ),
            TableColumn::new(
                "lifted",
                "paper",
                "1 if the tooth is lifted.",
                Data::Whole(whole(|mesh, at| u64::from(at + 1 >= mesh.first_lifted))),
            ),
            numbers("tooth_load_N", "N", "Load of the tooth.", each(|mesh, at| mesh.load[at])),
            numbers("tooth_load_complete_N", "N", "Its load if every tooth meshed.", each(|mesh, at| mesh.complete[at])),
            numbers("change_percent", "%", "Of the load by incomplete meshing.", each(|mesh, at| 100.0 * mesh.changes()[at])),
            numbers("tension_N", "N", "Tension leaving the tooth.", each(|mesh, at| mesh.tensions[at])),
        ],
    }
}
