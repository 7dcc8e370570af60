//! Studies with distributions: what is drawn, and the model whose outputs are yields and statistics.
//!
//! A *draw* is one drive as built: a value of every uncertain input that has a distribution. It *holds* if in all operating cases the
//! status is ok and every constraint is kept. To the rest of the program a study with distributions is one of another model: its inputs
//! are those of the drive, its outputs are the share of draws that hold and what is asked of quantities over the draws; only the levels of
//! `[uncertainty]`, which have no probability, are left as scenarios. So everything that judges, ranks and shows designs serves it too.

mod cases;
mod columns;
mod confirm;
mod drive;
mod early;
mod failures;
mod fold;
mod kernel;
mod lanes;
mod law;
mod model;
mod probability;
mod statistic;
mod tracks;

#[cfg(feature = "gpu")]
pub(crate) use drive::{DrawnDrive, needs};
#[cfg(feature = "gpu")]
pub(crate) use early::{LeastCount, least_counts};
pub(crate) use failures::{DrawFailures, NO_SUCH_DRIVE};
pub(crate) use kernel::DrawnKernel;
pub use law::{LawText, NamedLaw};
pub use probability::{Drive, MOST_CASES, MOST_CONFIRM, MOST_DRAWS, Probability, REPLICATES, UncertainInput};
pub use statistic::{AskedQuantity, ConfirmedEnd, OVER_DRAWS, OverDraws, SCREENED, Statistic, StatisticKind, YIELD};
