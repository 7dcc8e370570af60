//! The models: what each needs, gives and means, in one place per model.
//!
//! A model is data, a table of inputs, outputs and conditions, and a formula in two stages over [`Real`](crate::real::Real). The program
//! comes with [`all`] of these; a [`Model`] of one's own, made at run time, serves wherever one of them does.
//! Its shader is written from the recorded formula ([`tape`](crate::tape)). Adding a model is one file here, one line in the list
//! below, a study and one golden case; every generic test loops over the list. A model that is no such formula, such as a solver in
//! f64, implements [`Kernel`] itself and is computed on the CPU only.
//!
//! Each file here uses those before it only: `description`, `source`, `status`, `formula`, `model`, `known`, `evaluation`, `latest`,
//! `many`, `extended`,
//! then the models.

mod cvt;
mod description;
mod evaluation;
mod extended;
mod flat_belt;
mod formula;
mod known;
mod latest;
mod many;
mod metal_cvt;
mod model;
mod pulley;
mod pulley_load;
mod rubber_cvt;
mod source;
mod status;
mod timing_belt;
mod tolerance;

pub use crate::pulley::Design;
pub(crate) use crate::real::LANES;
pub use crate::tape::{Fields, Reads, Recordable, Set};
pub use cvt::{optimum_thickness, printed_torque_coefficient, torque_coefficient, traction_limit, wedge_factor};
pub use description::{
    CONDITION_BOUND_FACTOR, Condition, Effort, Input, OnlyFor, Output, Preset, Profile, ProfileColumn, Range, SAMPLE, Worse,
};
pub use evaluation::{evaluate, evaluate_asked};
pub(crate) use evaluation::{fill_si, holds, input_to_si, judge, shown, to_si};
pub(crate) use extended::{ExtensionProblem, extended, nothing, unit_of_name};
pub use formula::{Columns, Dependencies, Footprint, Formula, Kernel, Scratch, Sizes};
pub use known::Models;
pub(crate) use known::is_name;
pub use latest::{Evaluator, Latest};
pub(crate) use many::{ColumnCheck, ColumnEnds, ColumnJudge, JudgeRoom, ends};
pub use many::{EvaluatedColumns, Evaluations, ManyOptions, ResultColumns, evaluate_columns, evaluate_into, evaluate_many};
pub use model::{AlongTheBelt, Doubts, Model, Notes, PulleyOf, Remarks};
pub use pulley::CHECK_POINT_STRESSES;
pub(crate) use source::{ConditionSource, CurveSource, Extension, FileSource, FormulaSource};
pub use status::{Evaluation, OVERFLOW, Status};
use std::sync::{Arc, LazyLock};
pub(crate) use tolerance::ModelTolerance;

/// The models that come with the program: each is a module with its tables in `model()`.
macro_rules! models {
    ($($module:ident),*) => {
        static MODELS: LazyLock<Vec<Arc<Model>>> = LazyLock::new(|| vec![$(Arc::new($module::model())),*]);
    };
}
models![rubber_cvt, metal_cvt, timing_belt, pulley_load, pulley, flat_belt];

/// The models that come with the program, in the order in which `beltspace models` lists them.
pub fn all() -> &'static [Arc<Model>] {
    &MODELS
}

/// The model of that name among those that come with the program.
pub fn find(name: &str) -> Option<Arc<Model>> {
    MODELS.iter().find(|model| model.name == name).cloned()
}

#[cfg(test)]
pub(crate) mod tests;
