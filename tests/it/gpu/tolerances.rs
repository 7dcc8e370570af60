//! Tolerances that are a part of the model, on a device: the same designs as a study without them gives on the CPU.

use super::{Prepared, assert_same, device};
use crate::probability::tolerances::{DRAWN, LEVELS};

#[test]
fn tolerances_are_judged_on_a_device_as_on_the_cpu() {
    for pair in LEVELS.iter().chain(&DRAWN) {
        let [a, b] = pair.texts().map(|text| Prepared::parse(&text));
        let (state, record) = a.on(device()).unwrap_or_else(|error| panic!("{}: {error}", pair.label));
        assert_same(&b.on_cpu(), &state, pair.label);
        assert!(state.feasible > 0, "{}: nothing is feasible", pair.label);
        let other = Prepared::parse(&pair.another()).on_cpu();
        assert!((other.feasible, &other.front) != (state.feasible, &state.front), "{}: the checker sees nothing", pair.label);
        let unsure = record.unsure as f64 / record.designs as f64;
        assert!(unsure < 0.5, "{}: {unsure} of the designs are unsure", pair.label);
    }
}
