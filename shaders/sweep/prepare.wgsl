// First stage: `prepare` once per row and slow scenario, in f64 where the device has it, and what is the same for all lanes of a row.

@compute @workgroup_size(WORKGROUP)
fn prepare_rows(@builtin(global_invocation_id) id: vec3<u32>) {
    let row = id.x;
    let q = id.y;
    if row >= tile.rows {
        return;
    }
    begin_prepared(q, row);
    store_prepared(q, row, prepare_row(q, row));
}

// Judges what the lanes of a row share, over all scenarios.
@compute @workgroup_size(WORKGROUP)
fn judge_rows(@builtin(global_invocation_id) id: vec3<u32>) {
    let row = id.x;
    if row >= tile.rows {
        return;
    }
    let digits = digits_of_row(row);
    var inputs = fixed_inputs();
    set_row(&inputs, digits);
    var state = start_row(digits, inputs);
    for (var q = 0u; q < SLOW_SCENARIOS; q++) {
        let prepared = load_prepared(q, row);
        set_slow_scenario(&inputs, q);
        for (var t = 0u; t < FAST_SCENARIOS; t++) {
            set_fast_scenario(&inputs, t);
            judge_row(prepared, inputs, &state);
        }
    }
    store_row(row, state);
}
