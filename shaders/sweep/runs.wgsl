// Second stage where lanes with results that are near each other stand in runs. Judged once, a run shows what all its lanes have in common.
// Most are settled by that: no lane is feasible, or all are and the front beats them. Only the lanes of the others are judged one by one.
//
// A first pass judges the runs and lists those that are open; a second one has an invocation for each of these. Within one pass the
// invocations that meet a settled run would wait for their neighbours, and a software device would compute what it then drops.

// The open runs of a workgroup, and how many lanes they have, where that is known by now.
var<workgroup> open_runs: array<u32, OPEN_RUNS>;
var<workgroup> open_count: atomic<u32>;
var<workgroup> open_lanes: atomic<u32>;
// Where they begin in the list of the tile.
var<workgroup> first_open: u32;

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

// Where an open run stands in the list of the tile, which is behind its rows.
fn open_run_at(number: u32) -> u32 {
    return ROW_WORDS * tile.rows + number;
}

@compute @workgroup_size(WORKGROUP)
fn judge_runs(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let row = id.x / RUN_CHUNKS;
    let chunk = id.x % RUN_CHUNKS;
    let at = min(row, tile.rows - 1u);
    let state = load_row(at);
    let held = hold_prepared(at);
    let horizon = horizon();
    var counted = vec2<u32>(0u, 0u);
    for (var turn = 0u; turn < RUNS_EACH; turn++) {
        let number = chunk * RUNS_EACH + turn;
        let run = run_of(row, number);
        if state.verdict != NO && run.first < run.last {
            let judged = judge_run(run, state, held);
            if judged.verdict != NO {
                if judged.verdict == UNSURE || LOOK_AT_ALL || !is_counted() || may_be_part(judged, horizon) {
                    open_runs[atomicAdd(&open_count, 1u)] = at * RUNS + number;
                    atomicAdd(&open_lanes, select(0u, run.last - run.first, is_counted()));
                } else {
                    counted.x += run.last - run.first;
                }
            }
        }
    }
    add_to_counts(counted);
    workgroupBarrier();
    let open = atomicLoad(&open_count);
    if invocation == 0u && open > 0u {
        first_open = atomicAdd(&counts[OPEN], open);
        atomicAdd(&counts[SINGLY], atomicLoad(&open_lanes));
    }
    workgroupBarrier();
    for (var i = invocation; i < open; i += WORKGROUP) {
        if first_open + i < tile.open_room {
            row_table[open_run_at(first_open + i)] = open_runs[i];
        }
    }
}

// How many workgroups the second pass takes.
@compute @workgroup_size(1)
fn count_groups() {
    let groups = (min(atomicLoad(&counts[OPEN]), tile.open_room) + (WORKGROUP - 1u)) / WORKGROUP;
    atomicStore(&counts[GROUPS], min(groups, MOST_GROUPS));
    atomicStore(&counts[GROUPS + 1u], (groups + (MOST_GROUPS - 1u)) / MOST_GROUPS);
    atomicStore(&counts[GROUPS + 2u], 1u);
}

// Judges the lanes of an open run one by one.
@compute @workgroup_size(WORKGROUP)
fn sweep(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let number = id.y * (MOST_GROUPS * WORKGROUP) + id.x;
    if number >= min(atomicLoad(&counts[OPEN]), tile.open_room) {
        return;
    }
    let open = row_table[open_run_at(number)];
    let run = run_of(open / RUNS, open % RUNS);
    let horizon = horizon();
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
            let group = judge_in_run(run, state, held, begin + i);
            look_at_group(group, horizon, i, end - begin, &seen, &none, &kept);
        }
        let here = lanes_here(run, state, begin);
        if !is_counted() {
            atomicAdd(&counts[SINGLY], countOneBits(here));
        }
        seen.sure &= here;
        seen.flagged &= here;
        counted += look_closer(seen, run.row, state, held, horizon, first_of(run, begin), &kept, local);
    }
    add_to_counts(counted);
}
