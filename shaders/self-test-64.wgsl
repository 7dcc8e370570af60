// May the first stage of a kernel compute in f64? The arithmetic of self-test.wgsl, in f64.

@group(0) @binding(0) var<storage, read> given: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read_write> found: array<f64>;

// A number that f32 does not hold: the product is exact, so the sum is rounded once however it is computed.
fn number(leading: f32, behind: f32) -> f64 {
    return f64(leading) + f64(behind) * 9.313225746154785e-10;
}

@compute @workgroup_size(WORKGROUP)
fn arithmetic_64(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&given) {
        return;
    }
    let pair = given[id.x];
    let a = number(pair.x, pair.y);
    let b = number(pair.y, pair.x);
    write_results(id.x * RESULTS, a, b);
}
