//! Pictures of a V-belt pulley: [`section()`] with its dimensions, [`deformed()`] with its stresses, the stresses of the check points
//! [`around()`] the circumference, and the [`unrolled()`] surface.

mod around;
mod deformed;
mod drawing;
mod section;
mod shape;
mod unrolled;

pub use around::around;
pub use deformed::deformed;
pub use section::section;
pub use unrolled::unrolled;
