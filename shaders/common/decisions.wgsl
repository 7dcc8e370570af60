// Three-valued decisions: what a number with an error bound lets one conclude. The GPU implementation of
// src/decision.rs.
//
// The answers (NO, UNSURE and YES of src/gpu/constants.rs) are ordered so that "both must hold" is `min`: a sure no wins over an unsure,
// an unsure over a yes.

// A number with its running error bound times a factor; see `bound_factor` in src/models.
fn bounded(number: Real, factor: f32) -> Real {
    return Real(number.value, number.bound * factor);
}

fn is_known(number: Real) -> bool {
    return is_finite(abs(number.value) + number.bound);
}

fn at_least_zero(margin: Real) -> u32 {
    let answer = select(select(UNSURE, NO, margin.value < -margin.bound), YES, margin.value >= margin.bound);
    return select(UNSURE, answer, is_known(margin));
}

fn above_zero(margin: Real) -> u32 {
    let answer = select(select(UNSURE, NO, margin.value <= -margin.bound), YES, margin.value > margin.bound);
    return select(UNSURE, answer, is_known(margin));
}

// The ends of where a number may lie, a little farther out for their own rounding; an exact number is both its ends.
fn lower(number: Real) -> f32 {
    return select(number.value - number.bound - abs(number.value) * ROUNDING, number.value, number.bound == 0.0);
}

fn upper(number: Real) -> f32 {
    return select(number.value + number.bound + abs(number.value) * ROUNDING, number.value, number.bound == 0.0);
}
