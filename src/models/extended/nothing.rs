//! The model that a file without a base is based on: it reads nothing and gives nothing.

use crate::models::formula::Formula;
use crate::models::model::Model;
use crate::real::Real;
use crate::tape::{Fields, Set};
use std::sync::{Arc, LazyLock};

struct Nothing;

impl Formula for Nothing {
    const FIELDS: Fields = Fields::new(&[], &[], &[], 0);
    fn prepare<R: Real>(_inputs: &[R], _wanted: Set, _prepared: &mut [R]) {}
    fn conditions<R: Real>(_prepared: &[R::Shared], _inputs: &[R], _wanted: Set, _margins: &mut [R]) {}
    fn finish<R: Real>(_prepared: &[R::Shared], _inputs: &[R], _wanted: Set, _outputs: &mut [R]) {}
}

/// A model without inputs and outputs, to put formulas around.
pub fn nothing() -> Arc<Model> {
    static NOTHING: LazyLock<Arc<Model>> = LazyLock::new(|| Arc::new(Model::new("", Nothing)));
    NOTHING.clone()
}
