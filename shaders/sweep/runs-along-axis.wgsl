// Runs of lanes that differ in one axis alone. Judged with the middle of its ends for an input and half of their distance as the error
// bound, a run shows what all its lanes have in common.

// A run, and which of its lanes the tile has.
struct Run {
    row: u32,
    digits: Digits,
    first_lane: u32,
    first: u32,
    last: u32,
}

// Run number `number` of a row.
fn run_of(row: u32, number: u32) -> Run {
    var run: Run;
    run.row = row;
    run.digits = digits_of_run(number);
    run.first_lane = lane_of(run.digits);
    // A tile that is part of a row begins and ends anywhere.
    let before = max(tile.first_lane, run.first_lane) - run.first_lane;
    let until = max(tile.last_lane, run.first_lane) - run.first_lane;
    run.first = (before + (RUN_STEP - 1u)) / RUN_STEP;
    run.last = min((until + (RUN_STEP - 1u)) / RUN_STEP, levels_of_run(run.digits));
    run.last = select(0u, run.last, number < RUNS);
    return run;
}

// Is it known how many of its lanes the tile has?
fn is_counted() -> bool {
    return true;
}

fn levels_of(run: Run) -> u32 {
    return levels_of_run(run.digits);
}

// What the lanes from `begin` up to `end` have in common.
fn judge_stretch(run: Run, state: RowState, held: Prepared, begin: u32, end: u32) -> Lane {
    return judge_between(run.row, state, held, along(run.digits, begin), along(run.digits, end - 1u));
}

fn judge_in_run(run: Run, state: RowState, held: Prepared, at: u32) -> Group {
    return judge_along(run.row, state, held, along(run.digits, at));
}

// What `lane_at` counts from.
fn first_of(run: Run, begin: u32) -> u32 {
    return run.first_lane + begin * RUN_STEP;
}

fn lane_at(state: RowState, first: u32, i: u32) -> u32 {
    return first + i * RUN_STEP;
}

// A bit for each lane of a block, from `begin` up to `end`, that the tile has. An open part has at least one such lane, a block of it may
// have none.
fn lanes_here(run: Run, state: RowState, begin: u32, end: u32) -> u32 {
    let all = 0xffffffffu >> (32u - (end - begin));
    return select(0u, all & (0xffffffffu << (max(run.first, begin) - begin)), run.first < end);
}
