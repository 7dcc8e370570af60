//! GPUs: which there are, whether their drivers can be trusted, and how a kernel is run on one.
//!
//! Nothing here knows of a study. An [`Adapter`] is chosen by kind or by name, opened as a [`Device`] and put through the
//! [`self_test`] before anything it says is believed. A device never panics: what goes wrong on it, also later and elsewhere,
//! comes back as [`Error::Gpu`](crate::error::Error::Gpu) from the next call.

mod adapter;
pub(crate) mod constants;
mod device;
pub(crate) mod operations;
mod points;
mod program;

#[doc(hidden)]
pub mod self_test;
pub(crate) mod source;

pub use adapter::{Adapter, AdapterKind, adapters, choose};
pub(crate) use constants::{WORKGROUP, shared_constants};
#[doc(hidden)]
pub use device::Device;
pub(crate) use device::{Buffer, Wait};
pub(crate) use operations::Operations;
#[doc(hidden)]
pub use points::PointKernel;
pub(crate) use program::Program;
pub(crate) use source::{model_prelude, model_source, onwards_source, stages_source, stages_source_64, structure, tables};
