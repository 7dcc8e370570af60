//! `--perturb` and `--emit-shader` where the program is built without the feature `gpu`: both are refused.

use beltspace::error::Result;
use beltspace::models::Model;
use beltspace::plan::Plan;
use beltspace::run::device::{Wrong, without_gpu};
use std::path::Path;

/// Refuses `--perturb`.
pub fn wrong(_: &Model, words: &[String]) -> Result<Wrong> {
    if words.is_empty() { Ok(Wrong::default()) } else { without_gpu() }
}

/// Refuses `--emit-shader`.
pub fn emit_shader(_: &Plan, _: &Wrong, _: usize, _: &Path) -> Result<()> {
    without_gpu()
}
