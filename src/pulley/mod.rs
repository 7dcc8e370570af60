//! V-belt pulleys: sections, finite elements in harmonics around the axis, stresses over the turn.
//!
//! A pulley's geometry is axisymmetric and its loads are not: they are expanded in harmonics around the axis, each of which is one
//! linear problem on the (r, z) section. Inside this module lengths are in mm, forces in N, stresses in MPa and angles in rad.
//!
//! The steps: [`section`] makes a [`mesh`] from dimensions, [`response`] solves it for unit loads ([`loads`], [`equations`] made of
//! [`element`] and [`band`], stresses by [`recovery`]), and [`turn`] combines them to a load case. [`field`] is the whole section at one
//! angle, for pictures; [`calculix`] writes the same pulley as a three-dimensional model and compares the results.

pub mod around;
pub mod band;
pub mod calculix;
mod chunk;
mod design;
pub mod element;
pub mod equations;
pub mod field;
#[cfg(test)]
pub(crate) mod fixtures;
pub mod loads;
pub mod mesh;
mod numbering;
pub mod recovery;
pub mod response;
pub mod section;
mod spline;
pub mod surface;
#[cfg(test)]
mod tests;
pub mod turn;
pub mod wide;

pub use design::Design;
