// Where a number lies among steps or bins, given its error bound.

// The steps of a resolution that a value may be in.
fn steps(low: f32, high: f32, resolution: f32) -> vec2<f32> {
    let first = low / resolution;
    let last = high / resolution;
    return vec2<f32>(floor(first - abs(first) * 1e-6), floor(last + abs(last) * 1e-6));
}

// The bin of a value, -1 below the first and `bins` above the last; the bins of both ends of its bound.
fn bins_of(number: Real, low: Real, per_unit: f32, bins: f32) -> vec2<f32> {
    let away = number.bound + low.bound + (abs(number.value) + abs(low.value)) * 2.0 * ROUNDING;
    let middle = (number.value - low.value) * per_unit;
    let slack = away * per_unit + abs(middle) * 1e-6 + 1e-30;
    let bin = clamp(floor(vec2<f32>(middle - slack, middle + slack)), vec2<f32>(-1.0), vec2<f32>(bins));
    let exact = number.bound == 0.0 && low.bound == 0.0 && number.value == low.value;
    return select(bin, vec2<f32>(0.0), exact);
}
