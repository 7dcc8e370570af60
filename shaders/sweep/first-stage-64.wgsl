// What lies about a first stage in f64: the levels that go in, and what comes out for the second stage.

// A number as the second stage has it, with what f32 loses of it.
fn narrowed(a: Real_64) -> Real {
    let near = f32(a.value);
    let away = abs(a.value - f64(near)) + a.bound;
    return Real(near, select(f32(away) * 1.000001 + FLUSH, 0.0, away == 0.0));
}

// The level of an axis: what f32 loses of it is told as an f32 too, rounded away from zero.
fn level_64(entry: vec4<f32>) -> Real_64 {
    let value = f64(entry.x) + f64(entry.y);
    return Real_64(value, select(2.4e-7 * f64(abs(entry.y)) + ROUNDING_64 * abs(value), 0.0, entry.y == 0.0));
}
