//! The language of formulas: text in, checked formulas out, evaluated over any number type.
//!
//! A formula computes with quantities, not with bare numbers: every name has a unit, every number may have one in brackets behind it,
//! and a sum of a length and a mass is an error with its place. An angle is a dimension of its own. Arithmetic is in SI units.
//!
//! ```
//! use beltspace::formula::{Formulas, QuantityUnit, ScopeName, NameRole, Scope, Units};
//! use beltspace::units::MILLIMETRE;
//!
//! let units = Units::new(&["EUR".to_owned()]).expect("a unit of our own");
//! let names = vec![ScopeName::new("belt_length_mm", NameRole::Input, QuantityUnit::from(MILLIMETRE))];
//! let scope = Scope::new(units, names, Vec::new());
//! let formulas = Formulas::new(
//!     &scope,
//!     &[
//!         ("belt_mass_kg".to_owned(), "belt_length_mm * 9[mm] * 2[mm] * 7850[kg/m^3]".to_owned()),
//!         ("cost_EUR".to_owned(), "14[EUR/kg] * belt_mass_kg".to_owned()),
//!     ],
//! )
//! .expect("both are right");
//! let mut slots: Vec<f64> = vec![0.7, 0.0, 0.0];
//! formulas.evaluate_all(&mut slots, &mut [None; 3], &mut []);
//! let [mass, cost] = [slots[1], slots[2]];
//! assert!((mass - 0.09891).abs() < 1e-12 && (cost - 1.38474).abs() < 1e-12);
//! ```
//!
//! What may fail (a division by zero, the root of a negative number) does not stop anything: it leaves a signed margin, and the value
//! behind it is some finite number. See [`Formulas::requirements`].
//!
//! `root(r, from, to, expression)` trusts that its expression increases with `r` between its ends.

mod check;
mod dimension;
mod evaluate;
mod expression;
mod function;
mod nominal;
mod order;
mod parse;
mod problem;
mod scope;
mod set;
#[cfg(test)]
mod tests;
mod token;
mod typed;
mod unit;
mod value;
mod written;

pub use dimension::{MOST_OWN_UNITS, QuantityDimension};
pub use expression::{ComparisonSign, Expression, ExpressionNode, Operator};
pub use function::is_reserved;
pub(crate) use nominal::{nominal_name, nominal_of, nominals_in};
pub use parse::{MOST_BYTES, MOST_DEPTH};
pub use problem::FormulaProblem;
pub use scope::{MOST_POINTS, MeasuredCurve, NameRole, Scope, ScopeName};
pub use set::{FormulaRequirement, Formulas, MOST_FORMULAS, MOST_ROOTS, StudyFormula, meant};
pub use unit::{QuantityUnit, Units};
pub use written::{FormulaKind, WrittenFormula};
