// Points one by one, all inputs given: what `verify` compares with f64.

struct Points {
    count: u32,
}

// INPUTS pairs of value and bound per point.
@group(0) @binding(0) var<uniform> points: Points;
@group(0) @binding(1) var<storage, read> given: array<Real>;
// OUTPUTS outputs, then CONDITIONS margins per point.
@group(0) @binding(2) var<storage, read_write> found: array<Real>;

// TABLE_NUMBERS numbers in the tables of a point.
@group(0) @binding(3) var<storage, read_write> scratch: array<Real>;

fn prepare_point(point: u32, inputs: Inputs) -> Prepared {
    begin_tables(point * TABLE_NUMBERS);
    var held = prepare(inputs);
    hold_tables(&held, point * TABLE_NUMBERS);
    return held;
}

@compute @workgroup_size(WORKGROUP)
fn evaluate(@builtin(global_invocation_id) id: vec3<u32>) {
    let point = id.x;
    if point >= points.count {
        return;
    }
    let inputs = read_inputs(point * INPUTS);
    let prepared = prepare_point(point, inputs);
    let margins = conditions(prepared, inputs);
    write_outputs(point * (OUTPUTS + CONDITIONS), finish(prepared, inputs));
    for (var number = 0u; number < CONDITIONS; number++) {
        found[point * (OUTPUTS + CONDITIONS) + OUTPUTS + number] = margins[number];
    }
}
