//! A model evaluated point by point on a device: every output and condition margin with its bound.

use super::constants::declare;
use super::source::{common, margins_len};
use super::{Device, Program, WORKGROUP, model_prelude, model_source, tables};
use crate::error::Result;
use crate::models::{Fields, Model, Set};
use crate::tape::{RunningError, nearest_f32};
use std::fmt::Write;
use std::sync::Arc;

/// Points per dispatch.
const BATCH: usize = 1 << 16;
/// Numbers in the tables of a dispatch.
const BATCH_TABLES: usize = 1 << 22;

/// Numbers in a model's tables.
fn table_numbers(fields: &Fields) -> usize {
    fields.prepared_len() - fields.prepared.len()
}

/// A model's formula on a device, for points one by one.
#[derive(Debug)]
pub struct PointKernel {
    model: Arc<Model>,
    /// Numbers in the tables of one point.
    table_numbers: usize,
    device: Device,
    program: Program,
}

/// What a device finds for one point, in SI units: outputs and margins.
pub type PointValues = (Vec<RunningError>, Vec<RunningError>);

impl PointKernel {
    /// The kernel's text. `perturb`: outputs that are to come out wrong by this fraction of their value, for testing.
    ///
    /// # Errors
    /// [`Error::Request`](crate::error::Error::Request) if the model is computed on the CPU only.
    pub fn source(model: &Model, perturb: &[(usize, f64)]) -> Result<String> {
        let formula = model.on_device()?;
        let fields = formula.fields();
        let all: Vec<usize> = (0..model.conditions.len()).collect();
        let mut text = model_prelude(&fields, all.len(), Set::ALL, &all);
        let places: Vec<usize> = fields.places().map(|(first, _)| first).collect();
        text.push_str(&tables(&fields, |field, place| Some(format!("scratch[{place} + {}u + at]", places[field] - fields.prepared.len()))));
        let (begin, hold) = if fields.tables.is_empty() { ("", "") } else { ("table_place = place;", "(*held).place = place;") };
        let (inputs, outputs) = (fields.inputs.len(), model.outputs.len());
        for (name, value) in [("INPUTS", inputs), ("OUTPUTS", outputs), ("TABLE_NUMBERS", table_numbers(&fields))] {
            declare(&mut text, name, value as u32);
        }
        let mut line = |it: std::fmt::Arguments<'_>| writeln!(text, "{it}").expect("a text takes everything");
        line(format_args!("\nfn begin_tables(place: u32) {{\n    {begin}\n}}\n"));
        line(format_args!("fn hold_tables(held: ptr<function, Prepared>, place: u32) {{\n    {hold}\n}}\n"));
        line(format_args!("fn read_inputs(at: u32) -> Inputs {{\n    var inputs: Inputs;"));
        for (number, field) in fields.inputs.iter().enumerate() {
            line(format_args!("    inputs.{field} = given[at + {number}u];"));
        }
        line(format_args!("    return inputs;\n}}\n"));
        line(format_args!("fn write_outputs(at: u32, out: Outputs) {{"));
        for (number, field) in fields.outputs.iter().take(outputs).enumerate() {
            let factor = perturb.iter().filter(|(output, _)| *output == number).fold(1.0, |factor, (_, part)| factor * (1.0 + part));
            line(format_args!("    found[at + {number}u] = Real(out.{field}.value * {factor:?}, out.{field}.bound);"));
        }
        line(format_args!("}}\n"));
        Ok([&common(), &text, &model_source(model, formula), include_str!("../../shaders/evaluate.wgsl")].join("\n"))
    }

    /// Compiles the kernel of a model.
    ///
    /// # Errors
    /// [`Error::Gpu`](crate::error::Error::Gpu); [`Error::Request`](crate::error::Error::Request) if the model is computed on the
    /// CPU only.
    pub fn new(device: &Device, model: &Arc<Model>, perturb: &[(usize, f64)]) -> Result<Self> {
        Self::from_source(device, model, &Self::source(model, perturb)?)
    }

    /// Compiles a kernel of this text, such as one with a mistake that a test must notice.
    ///
    /// # Errors
    /// As [`PointKernel::new`].
    pub fn from_source(device: &Device, model: &Arc<Model>, source: &str) -> Result<Self> {
        let table_numbers = table_numbers(&model.on_device()?.fields());
        let program = Program::new(device, source, &["evaluate"])?;
        Ok(Self { model: model.clone(), table_numbers, device: device.clone(), program })
    }

    /// Evaluates points given in SI units.
    ///
    /// # Errors
    /// [`Error::Gpu`](crate::error::Error::Gpu).
    pub fn evaluate(&self, points: &[Vec<f64>]) -> Result<Vec<PointValues>> {
        let mut found = Vec::with_capacity(points.len());
        // Tables of many points at once would fill a device.
        let batch = (BATCH_TABLES / self.table_numbers.max(1)).clamp(1, BATCH);
        for batch in points.chunks(batch) {
            found.extend(self.batch(batch)?);
        }
        Ok(found)
    }

    fn batch(&self, points: &[Vec<f64>]) -> Result<Vec<PointValues>> {
        let (outputs, conditions) = (self.model.outputs.len(), self.model.conditions.len());
        let given: Vec<[f32; 2]> = points.iter().flat_map(|point| point.iter().map(|&value| nearest_f32(value).into())).collect();
        let width = outputs + margins_len(conditions);
        let device = &self.device;
        let results = device.buffer("found", (points.len() * width * 8) as u64, wgpu::BufferUsages::STORAGE);
        let given = device.storage("given", &given);
        let header = device.uniform("points", &[points.len() as u32, 0, 0, 0]);
        let scratch = device.buffer("scratch", (points.len() * self.table_numbers * 8).max(8) as u64, wgpu::BufferUsages::STORAGE);
        let bound = self.program.bind(&[("points", &header), ("given", &given), ("found", &results), ("scratch", &scratch)]);
        let groups = (points.len() as u32).div_ceil(WORKGROUP);
        device.submit(|encoder| self.program.dispatch(encoder, "evaluate", &bound, [groups, 1]));
        let values: Vec<[f32; 2]> = device.fetch(&results, points.len() * width)?;
        let number = |[value, bound]: [f32; 2]| RunningError { value, bound: f64::from(bound) };
        let numbers = |row: &[[f32; 2]]| row.iter().copied().map(number).collect();
        Ok(values.chunks(width).map(|row| (numbers(&row[..outputs]), numbers(&row[outputs..outputs + conditions]))).collect())
    }
}
