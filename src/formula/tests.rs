//! The language from text to number.

use super::*;
use crate::units;

mod broken;
mod meaning;
mod printed;
mod random;
mod sets;
mod slopes;
mod units_of_formulas;

/// A drive with inputs, variables and outputs of several kinds.
fn scope() -> Scope {
    let input = |name: &str, unit: units::Unit| ScopeName::new(name, NameRole::Input, unit.into());
    let output = |name: &str, unit: units::Unit| ScopeName::new(name, NameRole::Output, unit.into());
    let variable = |name: &str, unit: units::Unit| ScopeName::new(name, NameRole::Variable, unit.into());
    let words = |words: &[(&str, f64)]| words.iter().map(|(word, code)| ((*word).to_owned(), *code)).collect::<Vec<_>>();
    let names = vec![
        input("torque_Nm", units::NEWTON_METRE),
        input("radius_mm", units::MILLIMETRE),
        input("friction", units::NONE),
        input("band_count", units::NONE).whole(),
        input("section", units::NONE).words(words(&[("machined", 0.0), ("pressed-cup", 1.0)]), true),
        input("traction", units::NONE).words(words(&[("limit", -1.0)]), false),
        input("speed_rpm", units::RPM),
        variable("pulley_teeth", units::NONE).whole(),
        variable("pitch_mm", units::MILLIMETRE),
        output("wrap_deg", units::DEGREE),
        output("force_N", units::NEWTON).maybe_absent(),
        output("slip_margin", units::NONE).maybe_absent(),
    ];
    let slip = MeasuredCurve::new("slip", units::METRE_PER_SECOND.into(), QuantityUnit::NONE, &[(0.0, 0.1), (10.0, 0.2), (20.0, 0.15)]);
    Scope::new(Units::new(&["EUR".to_owned()]).expect("a unit"), names, vec![slip.expect("a curve")])
}

fn sources(formulas: &[(&str, &str)]) -> Vec<(String, String)> {
    formulas.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect()
}

/// The value in SI units of one formula that reads `values`, by name; other names are 1 and there.
fn value(name: &str, text: &str, values: &[(&str, f64)]) -> f64 {
    evaluated(name, text, values).0
}

/// Its value and the status that it gives, if any.
fn evaluated(name: &str, text: &str, values: &[(&str, f64)]) -> (f64, Option<String>) {
    let scope = scope();
    let formulas = Formulas::new(&scope, &sources(&[(name, text)])).unwrap_or_else(|problems| panic!("{text}: {}", problems[0]));
    let mut slots = vec![1.0; formulas.slots()];
    for (name, value) in values {
        slots[scope.slot(name).expect("a name")] = *value;
    }
    let mut present = vec![None; formulas.slots()];
    let mut margins = vec![f64::NAN; formulas.requirements().len()];
    formulas.evaluate_all(&mut slots, &mut present, &mut margins);
    let broken = |(requirement, margin): (&FormulaRequirement, &f64)| {
        assert!(!margin.is_nan(), "{text}");
        let holds = if requirement.strict { *margin > 0.0 } else { *margin >= 0.0 };
        (!holds).then(|| requirement.status.clone())
    };
    let status = formulas.requirements().iter().zip(&margins).find_map(broken);
    (slots[formulas.all()[0].slot], status)
}
