// For the comparison with f64: verdict, worst values and one scenario's outputs of every design of a tile, nothing left out.

@compute @workgroup_size(WORKGROUP)
fn check(@builtin(global_invocation_id) id: vec3<u32>) {
    let groups = (checked_lanes() + GROUP - 1u) / GROUP;
    let row = id.x / groups;
    if row >= tile.rows {
        return;
    }
    let first = id.x % groups * GROUP;
    let state = load_row(row);
    let group = checked_group(row, state, hold_prepared(row), first);
    check_group(group, row, state, first);
}

fn check_lane(judged: Lane, row: u32, state: RowState, at: u32) {
    if at >= checked_lanes() {
        return;
    }
    let lane = checked_lane(state, at);
    if lane < tile.first_lane || lane >= tile.last_lane {
        return;
    }
    let word = (row * (tile.last_lane - tile.first_lane) + lane - tile.first_lane) * CHECK_WORDS;
    survivors[word] = judged.verdict;
    write_worst(word + 1u, judged);
    // Any scenario will do, as long as all of them come up.
    let scenario = (row * SCENARIO_PER_ROW + lane * SCENARIO_PER_LANE) % (SLOW_SCENARIOS * FAST_SCENARIOS);
    let q = scenario / FAST_SCENARIOS;
    var inputs = fixed_inputs();
    set_row_inputs(&inputs, state);
    set_lane(&inputs, digits_of_lane(lane));
    set_slow_scenario(&inputs, q);
    set_fast_scenario(&inputs, scenario % FAST_SCENARIOS);
    write_asked(word + 1u + WORST_WORDS, finish_perturbed(load_prepared(q, row), inputs));
}
