// Second stage where an axis has many levels: lanes that differ in that axis alone are a run. Judged once, with the middle of its ends
// for an input and half of their distance as the error bound, a run shows what all its lanes have in common. Most are settled by that:
// no lane is feasible, or all are and the front beats them. Only the lanes of the others are judged one by one.
//
// A workgroup first judges the runs of its rows, then shares those that are open among its invocations, so that none waits for another.

var<workgroup> open_runs: array<u32, OPEN_RUNS>;
var<workgroup> open_count: atomic<u32>;

// A run, and which of its lanes the tile has.
struct Run {
    row: u32,
    digits: Digits,
    first_lane: u32,
    first: u32,
    last: u32,
}

// Run number `at` of a workgroup.
fn run_of(group: vec3<u32>, at: u32) -> Run {
    let row = group.x * RUN_ROWS + at / RUNS_AT_ONCE;
    let number = group.y * RUNS_AT_ONCE + at % RUNS_AT_ONCE;
    var run: Run;
    run.row = min(row, tile.rows - 1u);
    run.digits = digits_of_run(number);
    run.first_lane = lane_of(run.digits);
    // A tile that is part of a row begins and ends anywhere.
    let before = max(tile.first_lane, run.first_lane) - run.first_lane;
    let until = max(tile.last_lane, run.first_lane) - run.first_lane;
    run.first = (before + (RUN_STEP - 1u)) / RUN_STEP;
    run.last = min((until + (RUN_STEP - 1u)) / RUN_STEP, levels_of_run(run.digits));
    let is_there = row < tile.rows && number < RUNS;
    run.last = select(0u, run.last, is_there);
    return run;
}

// Can a lane whose keys are no better than these be part of an answer?
fn may_be_part(judged: Lane, horizon: Horizon) -> bool {
    if may_be_top(judged, horizon) {
        return true;
    }
    if OBJECTIVES == 0u {
        return false;
    }
    let keys = keys_of(judged);
    let beaten = beaten_by_dominators(keys, horizon) || beaten_by_table(keys);
    return !beaten || may_be_extreme(judged, horizon);
}

// Judges the lanes of an open run one by one.
fn judge_lanes(run: Run, horizon: Horizon, local: vec3<u32>) -> vec2<u32> {
    let state = load_row(run.row);
    let held = hold_prepared(run.row);
    var counted = vec2<u32>(0u, 0u);
    for (var begin = 0u; begin < RUN_LENGTH; begin += BLOCK) {
        let end = min(begin + BLOCK, run.last);
        var seen = Seen(0u, 0u);
        var none = no_row_dominator();
        var kept: array<Lane, KEPT>;
        for (var i = 0u; i < BLOCK; i += GROUP) {
            if begin + i >= end {
                break;
            }
            let group = judge_along(run.row, state, held, along(run.digits, begin + i));
            look_at_group(group, horizon, i, end - begin, &seen, &none, &kept);
        }
        let here = select(0u, 0xffffffffu << (max(run.first, begin) - begin), run.first < begin + BLOCK);
        seen.sure &= here;
        seen.flagged &= here;
        counted += look_closer(seen, run.row, state, held, horizon, run.first_lane + begin * RUN_STEP, RUN_STEP, &kept, local);
    }
    return counted;
}

@compute @workgroup_size(WORKGROUP)
fn sweep(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let horizon = horizon();
    var counted = vec2<u32>(0u, 0u);
    for (var turn = 0u; turn < RUN_TURNS; turn++) {
        let at = turn * WORKGROUP + invocation;
        let run = run_of(group, at);
        if at < OPEN_RUNS && run.first < run.last {
            let state = load_row(run.row);
            if state.verdict != NO {
                let judged = judge_run(run.row, state, hold_prepared(run.row), run.digits);
                if judged.verdict != NO {
                    if judged.verdict == UNSURE || LOOK_AT_ALL || may_be_part(judged, horizon) {
                        open_runs[atomicAdd(&open_count, 1u)] = at;
                    } else {
                        counted.x += run.last - run.first;
                    }
                }
            }
        }
    }
    workgroupBarrier();
    let open = atomicLoad(&open_count);
    for (var number = invocation; number < open; number += WORKGROUP) {
        counted += judge_lanes(run_of(group, open_runs[number]), horizon, local);
    }
    add_to_counts(counted);
}
