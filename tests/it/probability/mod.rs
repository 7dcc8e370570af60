//! Studies with distributions, against brute force and closed forms.

mod brute;
mod draft;
mod failing;
mod kinds;
mod laws;
mod proven;
mod random;
mod spread;
pub mod tolerances;
