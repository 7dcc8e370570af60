//! Tests that loop over every model.

use super::*;
use std::collections::HashSet;

#[test]
fn names_are_unique_and_carry_their_unit() {
    for model in MODELS {
        let mut seen = HashSet::new();
        let quantities = model.inputs.iter().map(|i| (i.name, i.unit)).chain(model.outputs.iter().map(|o| (o.name, o.unit)));
        for (name, unit) in quantities {
            assert!(seen.insert(name), "{}: {name} stands twice", model.name);
            let suffix = unit.suffix();
            assert!(suffix.is_empty() || name.ends_with(&format!("_{suffix}")), "{}: {name} in {suffix}", model.name);
        }
        assert!(model.inputs.len() <= INPUTS && model.outputs.len() <= OUTPUTS && model.conditions.len() <= CONDITIONS);
    }
}

#[test]
fn defaults_are_usual_and_evaluate_to_every_output() {
    for model in MODELS {
        for input in model.inputs {
            let default = input.default;
            assert!(input.accepts(default), "{}: {}", model.name, input.name);
            assert!(input.word_for(default).is_some() || (input.usual.0..=input.usual.1).contains(&default), "{}", input.name);
        }
        let evaluation = evaluate(model, &model.defaults());
        assert_eq!(evaluation.status, Status::Ok, "{}", model.name);
        assert!(evaluation.outputs.iter().all(Option::is_some), "{}", model.name);
    }
}

#[test]
fn conditions_invalidate_outputs_that_exist() {
    // The two belts share one table; the rubber belt lacks the metal belt's last two outputs.
    let known: HashSet<_> = MODELS.iter().flat_map(|model| model.outputs).map(|output| output.name).collect();
    for model in MODELS {
        for condition in model.conditions {
            for name in condition.invalidates {
                assert!(known.contains(name), "{}: \"{}\" invalidates {name}", model.name, condition.reason);
            }
        }
    }
}
