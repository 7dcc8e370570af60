//! The models: what each needs, gives and means, in one place per model.
//!
//! A model is a table of inputs, outputs and conditions, and a formula in two stages over [`Real`](crate::real::Real).
//! Its twin in WGSL stands in `shaders/models/`, with the same two stages and names. Adding a model is one file here, one there,
//! one line in [`MODELS`] and one golden case; every generic test loops over the list. A model that is no such formula, such as a
//! solver in f64, implements [`Kernel`] itself and has no twin.

mod cvt;
mod description;
mod evaluation;
mod formula;
mod metal_cvt;
mod pulley;
mod pulley_load;
mod rubber_cvt;
mod timing_belt;

pub(crate) use crate::real::LANES;
pub use cvt::{optimum_thickness, printed_torque_coefficient, torque_coefficient, traction_limit, wedge_factor};
pub use description::{
    CONDITION_PROMISE, Condition, Device, Effort, Input, Model, Notes, Output, Profile, ProfileColumn, Range, Remarks, SAMPLE, Worse,
};
pub use evaluation::{Evaluation, Status, evaluate, evaluate_decided};
pub(crate) use evaluation::{holds, input_to_si, judge, shown, to_si};
pub use formula::{CONDITIONS, Columns, Fields, Formula, INPUTS, Kernel, OUTPUTS, Reach, Reads, Scratch, Twin, run};
pub use pulley::{CHECK_POINT_STRESSES, Design};

/// Something to do with a model's formula over a number type of one's own, which the table of functions in [`Model::kernel`]
/// cannot offer.
pub trait Visitor {
    /// What comes of it.
    type Output;
    /// Called with the formula.
    fn visit<F: Formula>(self) -> Self::Output;
}

/// The list of models: each is a module with its table `MODEL`; those of the first list have their formula in `Own`, those of the
/// second are computed on the processor only.
macro_rules! models {
    ($($module:ident),* ; processor: $($solver:ident),*) => {
        /// Every model, in the order in which `beltspace models` lists them.
        pub const MODELS: &[&Model] = &[$(&$module::MODEL,)* $(&$solver::MODEL,)*];

        /// Calls a visitor with the formula of the model of that name; `None` if there is no such model, or it is no formula over any
        /// number type.
        pub fn visit<V: Visitor>(name: &str, visitor: V) -> Option<V::Output> {
            match name {
                $(_ if name == $module::MODEL.name => Some(visitor.visit::<$module::Own>()),)*
                _ => None,
            }
        }
    };
}
models![rubber_cvt, metal_cvt, timing_belt, pulley_load; processor: pulley];

/// Section, loads and strength behind inputs of the model `pulley`, in their units; `None` for any other model.
pub fn pulley_design(model: &Model, inputs: &[f64]) -> Option<Design> {
    (*model == pulley::MODEL).then(|| Design::new(&to_si(model, inputs)))
}

/// The model of that name.
pub fn find(name: &str) -> Option<&'static Model> {
    MODELS.iter().copied().find(|model| model.name == name)
}

#[cfg(test)]
pub(crate) mod tests;
