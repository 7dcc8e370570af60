//! A study: one request, read from a file, checked as a whole and resolved to numbers.
//!
//! What comes out of [`Study::read`] can be swept: every name is a number of an input or output, every value is in the unit of its
//! name, every range is expanded to a rule for its levels. A result and a checkpoint keep its description ([`Study::describe`]), from
//! which it is read back: shards are merged without the file that they came from.

mod axis;
mod check;
mod describe;
mod described;
mod drawn;
mod label;
mod limits;
mod quantity;
mod read;
mod resolved;
mod schema;
mod sensitivity;
mod sensitivity_flaws;
mod spectrum;

pub(crate) use axis::TOGETHER;
pub use axis::{Axis, Levels, Method, Sample};
#[doc(hidden)]
pub use describe::{differences, number, value_of};
pub use drawn::{AskedQuantity, ConfirmedEnd, Drive, LawText, NamedLaw, OverDraws, Probability, Statistic, StatisticKind, UncertainInput};
pub(crate) use drawn::{DrawFailures, DrawnKernel, NO_SUCH_DRIVE};
#[cfg(feature = "gpu")]
pub(crate) use drawn::{DrawnDrive, LeastCount, least_counts, needs};
pub use label::Label;
pub use quantity::Quantity;
#[doc(hidden)]
pub use read::StudyEdits;
#[cfg(feature = "pictures")]
pub(crate) use read::entry_names;
#[cfg(test)]
pub(crate) use read::tests::study_of;
pub use read::{FileKind, Problem, StudyErrors, file_kind, parse_model, read_model};
#[cfg(feature = "cli")]
pub(crate) use read::{entry_leaves, quoted_key, with_whole_paths};
pub(crate) use read::{input_text, input_value_checked};
pub use resolved::{
    Best, Constraint, ContourSpec, Goal, HistogramSpec, MapSpec, Objective, Report, ReportColumn, SampleSpec, Study, Thresholds, TopSpec,
};
#[doc(hidden)]
pub use resolved::{worst_end, worst_end_over};
pub use schema::{model_schema, study_reference, study_schema};
pub use sensitivity::{HOLDS, InfluenceOver, SensitivitySpec};
pub use spectrum::{OverScenarios, Spectrum};
