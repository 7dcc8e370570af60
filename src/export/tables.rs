//! The tables of a result: designs, histogram bins, map cells.

use super::Outcome;
use super::table::{Data, Table, TableColumn};
use crate::certify::{Role, Row};
use crate::contours::{Along, Contour};
use crate::models::Input;
use crate::plan::Plan;
use crate::reduce::{Histogram, Map};
use crate::study::{Axis, Best, Goal, Levels, MapSpec, Study};

/// Designs: index, design inputs, then every column's worst value and its scenario.
pub fn designs(outcome: &Outcome<'_>, rows: &[Row]) -> Table {
    let study = &outcome.plan.study;
    let model = study.model;
    let mut columns = vec![TableColumn::index("design_index", "Index of the design in the study.", rows.iter().map(|row| Some(row.index)))];
    for &input in study.design.iter().flat_map(Axis::inputs) {
        let table = &model.inputs[input];
        let values = rows.iter().map(|row| row.inputs[input]);
        let words = table.is_enumeration() || values.clone().any(|value| table.word_for(value).is_some());
        let data =
            if words { Data::Text(values.map(|value| written(table, value)).collect()) } else { Data::Number(values.map(Some).collect()) };
        let column = TableColumn::new(table.name, "design", table.doc, data);
        columns.push(TableColumn { unit: table.unit.symbol.to_owned(), ..column });
    }
    for (at, column) in outcome.columns.iter().enumerate() {
        let (role, direction) = match column.role {
            Role::Objective(objective) => {
                ("objective", if study.objectives[objective].goal == Goal::Min { "min".to_owned() } else { "max".to_owned() })
            }
            Role::Constraint(constraint) => ("constraint", study.constraints[constraint].in_words()),
            Role::Report => ("report", String::new()),
        };
        columns.push(TableColumn {
            unit: column.quantity.unit(model).to_owned(),
            direction,
            ..TableColumn::new(
                &column.name,
                role,
                column.quantity.doc(model),
                Data::Number(rows.iter().map(|row| row.columns[at].value).collect()),
            )
        });
        let scenarios = rows.iter().map(|row| row.columns[at].value.map(|_| row.columns[at].scenario));
        columns.push(TableColumn::index(&format!("{}_scenario", column.name), "The scenario in which it is the worst.", scenarios));
    }
    Table { columns }
}

/// Every design, feasible or not.
pub fn variants(outcome: &Outcome<'_>, rows: &[Row]) -> Table {
    let mut table = designs(outcome, rows);
    let words = rows.iter().map(|row| if row.feasible { "yes" } else { "no" }.to_owned()).collect();
    table.columns.push(TableColumn::new("feasible", "feasible", "Does it satisfy everything in every scenario?", Data::Text(words)));
    table
}

/// A value of an input as a person writes it.
pub fn written(input: &Input, value: f64) -> String {
    input.word_for(value).map_or_else(|| super::plain(value), str::to_owned)
}

/// Is a level of this axis of one input a word?
pub fn has_words(study: &Study, axis: &Axis) -> bool {
    let input = &study.model.inputs[axis.inputs()[0]];
    // Levels given by a rule are numbers.
    let listed = !matches!(axis, Axis::Single { levels: Levels::Even { .. } | Levels::Step { .. } | Levels::Continuous { .. }, .. });
    listed && (0..axis.count()).any(|level| input.word_for(axis.value(0, level)).is_some())
}

/// Bins of a histogram; the first row counts what lies below, the last what lies above.
pub fn histogram(histogram: &Histogram) -> Table {
    let bins = histogram.counts.len();
    let edges = |shift: usize| (0..bins).map(move |bin| Some(histogram.edge(bin + shift)));
    let from = std::iter::once(None).chain(edges(0)).chain([Some(histogram.to)]).collect();
    let to = std::iter::once(Some(histogram.from)).chain(edges(1)).chain([None]).collect();
    let counts = std::iter::once(histogram.below).chain(histogram.counts.iter().copied()).chain([histogram.above]).map(Some).collect();
    Table {
        columns: vec![
            TableColumn::new("from", "bin", "Lower edge of the bin, included.", Data::Number(from)),
            TableColumn::new("to", "bin", "Upper edge of the bin, excluded but for the last bin.", Data::Number(to)),
            TableColumn::new("designs", "count", "Feasible designs whose worst value lies in the bin.", Data::Whole(counts)),
        ],
    }
}

/// What a map shows: name and unit.
pub fn map_value(study: &Study, spec: &MapSpec) -> (&'static str, &'static str) {
    match spec.value {
        Best::Value(quantity, _) => (quantity.name(study.model), quantity.unit(study.model)),
        Best::Share => ("feasible_share", ""),
    }
}

/// Cells of a map, row by row: x, y, value and the best design; absent where no design is feasible.
#[allow(clippy::cast_precision_loss, reason = "a share of counted designs")]
pub fn map(plan: &Plan, spec: &MapSpec, map: &Map) -> Table {
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
        TableColumn { unit: table.unit.symbol.to_owned(), ..TableColumn::new(table.name, "design", table.doc, data) }
    };
    let (name, unit) = map_value(study, spec);
    let value = |cell| match spec.value {
        Best::Value(..) => map.cell(cell).map(|cell| map.value(cell)),
        Best::Share => Some(map.cell(cell).map_or(0.0, |cell| cell.feasible as f64 / of_cell)),
    };
    let values = Data::Number(cells.clone().map(value).collect());
    let mut columns = vec![
        axis(spec.x, &|cell| cell % width),
        axis(spec.y, &|cell| cell / width),
        TableColumn { unit: unit.to_owned(), ..TableColumn::new(name, "value", "The best over all other axes.", values) },
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
    let model = study.model;
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
            along.push(if vertex.along == Along::X { x.name } else { y.name }.to_owned());
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
            TableColumn { unit: x.unit.symbol.to_owned(), ..TableColumn::new(x.name, "design", x.doc, Data::Number(across)) },
            TableColumn { unit: y.unit.symbol.to_owned(), ..TableColumn::new(y.name, "design", y.doc, Data::Number(up)) },
            TableColumn::new("bracket", "contour", "Width of the bracket around the vertex that was bisected.", Data::Number(bracket)),
            TableColumn::new("along", "contour", "The axis that the bracket lies on, in its unit.", Data::Text(along)),
        ],
    }
}
