//! The files of a map: its cells, the lines over it, and its picture; what they are called and how large they are.

use super::super::naming::{is_named, numbered};
use super::super::reducer::{Put, ReducerResults, ReducerRoom};
use super::Map;
#[cfg(feature = "pictures")]
use super::picture::picture;
use super::shown::{has_words, value_of};
use crate::contours::{Along, Contour, contours as lines_over};
use crate::error::Result;
use crate::plan::Plan;
use crate::study::{Best, MapSpec, Study};
use crate::table::csv;
#[cfg(feature = "parquet")]
use crate::table::parquet;
use crate::table::written;
use crate::table::{Data, Table, TableColumn};

/// Maps of more cells are written as Parquet rather than CSV, where the library is built with it.
pub const CSV_CELLS: u64 = 100_000;

/// Names of the tables of a study's maps, without their extension.
pub fn names(study: &Study) -> Vec<String> {
    numbered(study.report.maps.iter().map(|spec| format!("map-{}", value_of(study, spec).0)))
}

/// File of the map whose table has that name.
fn map_name(study: &Study, spec: &MapSpec, name: &str) -> String {
    let in_parquet = cfg!(feature = "parquet") && cells_of(study, spec) > CSV_CELLS;
    format!("{name}.{}", if in_parquet { "parquet" } else { "csv" })
}

/// File of the lines over the map of that name.
pub fn contours_name(map: &str) -> String {
    format!("{}.csv", map.replacen("map-", "contours-", 1))
}

fn cells_of(study: &Study, spec: &MapSpec) -> u64 {
    study.design[spec.x].count().saturating_mul(study.design[spec.y].count())
}

/// The files of all maps of a study.
pub fn all(study: &Study) -> Vec<String> {
    let mut files = Vec::new();
    for (name, spec) in names(study).iter().zip(&study.report.maps) {
        files.extend([map_name(study, spec, name), format!("{name}.svg")]);
        if !spec.contours.is_empty() {
            files.push(contours_name(name));
        }
    }
    files
}

/// May a map of some study have a file of this name?
pub fn is_file(name: &str) -> bool {
    is_named(name, "map-", &["csv", "parquet", "svg"]) || is_named(name, "contours-", &["csv"])
}

/// What the maps of a study take.
pub fn room(study: &Study) -> ReducerRoom {
    let report = &study.report;
    let columns = |spec: &MapSpec| if spec.value == Best::Share { 3 } else { 4 };
    let cells = || report.maps.iter().map(|spec| cells_of(study, spec));
    let files = report.maps.iter().zip(names(study)).map(|(spec, name)| {
        // The axes repeat themselves and take nearly nothing.
        (map_name(study, spec, &name), cells_of(study, spec).saturating_mul(2))
    });
    ReducerRoom {
        cells: cells().fold(0, u64::saturating_add),
        tables: report.maps.iter().map(|spec| (cells_of(study, spec), columns(spec))).collect(),
        shown: report.maps.iter().zip(cells()).filter(|(_, cells)| *cells <= CSV_CELLS).map(|(spec, cells)| cells * columns(spec)).sum(),
        files: files.collect(),
        ..ReducerRoom::default()
    }
}

/// Writes the files of a map. The lines over it are found here, on several threads: they depend on the plan alone, so no checkpoint need
/// keep them.
pub fn write(map: &Map, results: &ReducerResults<'_>, put: &mut Put<'_>) -> Result<()> {
    let study = &results.plan.study;
    let spec = &study.report.maps[results.number];
    let name = &names(study)[results.number];
    let table = cells(results.plan, spec, map);
    let file = map_name(study, spec, name);
    put(&file, bytes_of(&file, &table)?)?;
    let found = lines_over(results.plan, spec, results.threads);
    if !spec.contours.is_empty() {
        put(&contours_name(name), csv::write(&contours(study, spec, &found)))?;
    }
    #[cfg(feature = "pictures")]
    put(&format!("{name}.svg"), picture(study, spec, map, &table, &found).into_bytes())?;
    Ok(())
}

/// The table of a map in the form that its file's name says.
#[cfg(feature = "parquet")]
fn bytes_of(file: &str, table: &Table) -> Result<Vec<u8>> {
    if file.ends_with(".parquet") { parquet::write(table) } else { Ok(csv::write(table)) }
}

#[cfg(not(feature = "parquet"))]
#[allow(clippy::unnecessary_wraps, reason = "as with Parquet, which may fail")]
fn bytes_of(_: &str, table: &Table) -> Result<Vec<u8>> {
    Ok(csv::write(table))
}

/// Cells of a map, row by row: x, y, value and the best design; absent where no design is feasible.
#[allow(clippy::cast_precision_loss, reason = "a share of counted designs")]
pub fn cells(plan: &Plan, spec: &MapSpec, map: &Map) -> Table {
    let study = &plan.study;
    let (width, height) = map.size();
    let of_cell = (plan.designs() / (width * height)) as f64;
    let cells = 0..width * height;
    let axis = |axis: usize, digit: &dyn Fn(u64) -> u64| {
        let table = &study.model.inputs[study.design[axis].inputs()[0]];
        let values = cells.clone().map(|cell| study.design[axis].value(0, digit(cell)));
        let data = if has_words(study, &study.design[axis]) {
            Data::Text(values.map(|value| written(table, value)).collect())
        } else {
            Data::Number(values.map(Some).collect())
        };
        TableColumn { unit: table.unit.symbol.to_owned(), ..TableColumn::new(&table.name, "design", &table.doc, data) }
    };
    let (name, unit) = value_of(study, spec);
    // A map of what one of its axes is has that twice: the axis and the best value of the cell.
    let is_axis = [spec.x, spec.y].iter().any(|&axis| study.model.inputs[study.design[axis].inputs()[0]].name == name);
    let name = if is_axis { format!("{name}_value") } else { name.to_owned() };
    let value = |cell| match spec.value {
        Best::Value(..) => map.cell(cell).map(|cell| map.value(cell)),
        Best::Share => Some(map.cell(cell).map_or(0.0, |cell| cell.feasible as f64 / of_cell)),
    };
    let values = Data::Number(cells.clone().map(value).collect());
    let mut columns = vec![
        axis(spec.x, &|cell| cell % width),
        axis(spec.y, &|cell| cell / width),
        TableColumn { unit: unit.to_owned(), ..TableColumn::new(&name, "value", "The best over all other axes.", values) },
    ];
    if spec.value != Best::Share {
        columns.push(TableColumn::index(
            "design_index",
            "The design that has it.",
            cells.map(|cell| map.cell(cell).map(|cell| cell.index)),
        ));
    }
    Table { columns }
}

/// The lines over a map, vertex by vertex: what of, where, and between which ends each was found.
pub fn contours(study: &Study, spec: &MapSpec, contours: &[Contour]) -> Table {
    let model = &study.model;
    let [x, y] = [spec.x, spec.y].map(|axis| &model.inputs[study.design[axis].inputs()[0]]);
    let mut of = Vec::new();
    let mut line = Vec::new();
    let mut along = Vec::new();
    let [mut at, mut across, mut up, mut bracket] = [const { Vec::new() }; 4];
    let lines = contours.iter().flat_map(|contour| contour.lines.iter().map(move |line| (contour, line)));
    for (number, (contour, vertices)) in (0..).zip(lines) {
        for vertex in vertices {
            of.push(contour.of.name(model).to_owned());
            at.push(Some(contour.at));
            line.push(Some(number));
            across.push(Some(vertex.x));
            up.push(Some(vertex.y));
            bracket.push(Some(vertex.bracket));
            along.push(if vertex.along == Along::X { &x.name } else { &y.name }.clone());
        }
    }
    Table {
        columns: vec![
            TableColumn::new("of", "contour", "The quantity.", Data::Text(of)),
            TableColumn::new(
                "at",
                "contour",
                "Its worst value over all scenarios is at least this on the left of the line.",
                Data::Number(at),
            ),
            TableColumn::index("line", "Number of the polyline.", line),
            TableColumn { unit: x.unit.symbol.to_owned(), ..TableColumn::new(&x.name, "design", &x.doc, Data::Number(across)) },
            TableColumn { unit: y.unit.symbol.to_owned(), ..TableColumn::new(&y.name, "design", &y.doc, Data::Number(up)) },
            TableColumn::new("bracket", "contour", "Width of the bracket around the vertex that was bisected.", Data::Number(bracket)),
            TableColumn::new("along", "contour", "The axis that the bracket lies on, in its unit.", Data::Text(along)),
        ],
    }
}
