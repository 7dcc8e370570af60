// Runs of lanes next to each other in the order of the one number that all lanes of a row differ by. From that number on a run is judged
// with the middle of its ends for it and half of their distance as the error bound.

// A run, and how many lanes it has.
struct Run {
    row: u32,
    number: u32,
    first: u32,
    last: u32,
}

// Run number `number` of a row.
fn run_of(row: u32, number: u32) -> Run {
    var run: Run;
    run.row = row;
    run.number = number;
    run.first = 0u;
    run.last = select(0u, min(RUN_LENGTH, WIDTH - number * RUN_LENGTH), number < RUNS);
    return run;
}

// Is it known how many of its lanes the tile has? Those of a tile that is part of a row stand anywhere in the order.
fn is_counted() -> bool {
    return tile.first_lane == 0u && tile.last_lane == WIDTH;
}

// The numbers between two, which may be the same one.
fn stretch(a: Real, b: Real) -> Real {
    let all = between(a, b);
    let same = a.value == b.value;
    return Real(select(all.value, a.value, same), select(all.bound, a.bound, same));
}

fn levels_of(run: Run) -> u32 {
    return run.last;
}

// What the lanes from `begin` up to `end` have in common.
fn judge_stretch(run: Run, state: RowState, held: Prepared, begin: u32, end: u32) -> Lane {
    var digits: Digits;
    return judge_onwards(run.row, state, numbers_between(held, state, first_of(run, begin), first_of(run, end) - 1u), digits);
}

fn judge_in_run(run: Run, state: RowState, held: Prepared, at: u32) -> Group {
    return judge_sorted(run.row, state, held, run.number * RUN_LENGTH + at);
}

// What `lane_at` counts from.
fn first_of(run: Run, begin: u32) -> u32 {
    return run.number * RUN_LENGTH + begin;
}

// A lane by its place, judged again.
fn judge_at(row: u32, state: RowState, held: Prepared, first: u32, i: u32) -> Lane {
    return judge_sorted(row, state, held, first + i).l0;
}

// What the comparison with f64 judges: all places, of which a tile may have any.
fn checked_lanes() -> u32 {
    return WIDTH;
}

fn checked_group(row: u32, state: RowState, held: Prepared, at: u32) -> Group {
    return judge_sorted(row, state, held, at);
}

fn checked_lane(state: RowState, at: u32) -> u32 {
    return sorted_lane(state, at);
}

fn lane_at(state: RowState, first: u32, i: u32) -> u32 {
    return sorted_lane(state, first + i);
}

// A bit for each lane of a block, from `begin` up to `end`, that the tile has.
fn lanes_here(run: Run, state: RowState, begin: u32, end: u32) -> u32 {
    if is_counted() {
        return 0xffffffffu >> (32u - (end - begin));
    }
    var here = 0u;
    for (var i = 0u; i < end - begin; i++) {
        let lane = lane_at(state, first_of(run, begin), i);
        here |= select(0u, 1u << i, lane >= tile.first_lane && lane < tile.last_lane);
    }
    return here;
}
