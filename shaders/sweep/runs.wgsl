// Second stage where lanes with results that are near each other stand in runs. Judged once, a run shows what all its lanes have in common.
// Most are settled by that: no lane is feasible, or all are and the front beats them. The others are judged again in parts, since it is a
// border that leaves them open, which crosses one part or two. Only the lanes of these are judged one by one.
//
// A first pass judges the runs and lists those that are open; a second one has an invocation for each of these and lists their open parts; a
// third one has an invocation for each part. Within one pass the invocations that meet a settled run would wait for their neighbours, and a
// software device would compute what it then drops.

// What a workgroup found open. It is put there when an invocation has met all of its own: a software device takes the lanes of a vector one
// after the other to it.
var<workgroup> open_list: array<u32, OPEN_LIST>;
var<workgroup> open_count: atomic<u32>;
// Lanes of open parts, where it is known by now how many the tile has.
var<workgroup> open_lanes: atomic<u32>;
// Where what is open begins in the list of the tile.
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
    let beaten = beaten_by_dominators(keys, horizon) || beaten_by_table(keys, horizon);
    return !beaten || may_be_extreme(judged, horizon);
}

// Does what a stretch of lanes has in common leave any of them to be judged by itself?
fn is_open(judged: Lane, horizon: Horizon, counted: bool) -> bool {
    if judged.verdict == NO {
        return false;
    }
    return judged.verdict == UNSURE || LOOK_AT_ALL || !counted || may_be_part(judged, horizon);
}

// Where an open run stands in the list of the tile, which is behind its rows, and where an open part does, behind the runs.
fn open_run_at(number: u32) -> u32 {
    return ROW_WORDS * tile.rows + number;
}

fn open_part_at(number: u32) -> u32 {
    return ROW_WORDS * tile.rows + tile.open_room + number;
}

// Puts what a workgroup found open into the list of the tile that begins at word `list` and whose length stands in `counts`. Each invocation
// comes with a bit for each that it found, counted from number `first`.
fn list_open(invocation: u32, bits: u32, first: u32, list: u32, length: u32) {
    var place = atomicAdd(&open_count, countOneBits(bits));
    for (var rest = bits; rest != 0u; rest &= rest - 1u) {
        open_list[place] = first + firstTrailingBit(rest);
        place++;
    }
    workgroupBarrier();
    let open = atomicLoad(&open_count);
    if invocation == 0u && open > 0u {
        first_open = atomicAdd(&counts[length], open);
    }
    workgroupBarrier();
    for (var i = invocation; i < open; i += WORKGROUP) {
        if first_open + i < tile.open_room {
            row_table[list + first_open + i] = open_list[i];
        }
    }
}

// How many of a list there was room for.
fn listed(length: u32) -> u32 {
    return min(atomicLoad(&counts[length]), tile.open_room);
}

@compute @workgroup_size(WORKGROUP)
fn judge_runs(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let row = id.x / RUN_CHUNKS;
    let chunk = id.x % RUN_CHUNKS;
    let at = min(row, tile.rows - 1u);
    let state = load_row(at);
    let held = hold_prepared(at);
    let horizon = horizon();
    let is_whole = is_counted();
    let is_there = row < tile.rows && state.verdict != NO;
    let first = chunk * RUNS_EACH;
    var counted = vec2<u32>(0u, 0u);
    var open = 0u;
    for (var turn = 0u; turn < RUNS_EACH; turn++) {
        let run = run_of(at, first + turn);
        if is_there && run.first < run.last {
            let judged = judge_stretch(run, state, held, 0u, levels_of(run));
            if is_open(judged, horizon, is_whole) {
                open |= 1u << turn;
            } else if judged.verdict == YES {
                counted.x += run.last - run.first;
            }
        }
    }
    add_to_counts(counted);
    list_open(invocation, open, at * RUNS + first, open_run_at(0u), OPEN);
}

// How many workgroups the second pass takes, and once that has run, the third one.
@compute @workgroup_size(1)
fn count_groups() {
    let runs = (listed(OPEN) + (WORKGROUP - 1u)) / WORKGROUP;
    let parts = (listed(OPEN_PARTS) + (WORKGROUP - 1u)) / WORKGROUP;
    for (var level = 0u; level < 2u; level++) {
        let groups = select(parts, runs, level == 0u);
        atomicStore(&counts[GROUPS + 3u * level], min(groups, MOST_GROUPS));
        atomicStore(&counts[GROUPS + 3u * level + 1u], (groups + (MOST_GROUPS - 1u)) / MOST_GROUPS);
        atomicStore(&counts[GROUPS + 3u * level + 2u], 1u);
    }
}

// Which of a list an invocation takes.
fn number_of(id: vec3<u32>) -> u32 {
    return id.y * (MOST_GROUPS * WORKGROUP) + id.x;
}

// Judges the parts of an open run.
@compute @workgroup_size(WORKGROUP)
fn judge_parts(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let number = number_of(id);
    let open_runs = listed(OPEN);
    let open_run = row_table[open_run_at(min(number, open_runs - 1u))];
    let run = run_of(open_run / RUNS, open_run % RUNS);
    let horizon = horizon();
    let is_whole = is_counted();
    let state = load_row(run.row);
    let held = hold_prepared(run.row);
    var counted = vec2<u32>(0u, 0u);
    var open = 0u;
    var lanes = 0u;
    for (var part = 0u; part < PARTS; part++) {
        let begin = part * PART;
        let end = min(begin + PART, run.last);
        let here = max(begin, run.first);
        if number < open_runs && here < end {
            if PARTS > 1u {
                let judged = judge_stretch(run, state, held, begin, end);
                if !is_open(judged, horizon, is_whole) {
                    counted.x += select(0u, end - here, judged.verdict == YES);
                    continue;
                }
            }
            open |= 1u << part;
            lanes += end - here;
        }
    }
    add_to_counts(counted);
    atomicAdd(&open_lanes, select(0u, lanes, is_whole));
    list_open(invocation, open, open_run * PARTS, open_part_at(0u), OPEN_PARTS);
    if invocation == 0u {
        atomicAdd(&counts[SINGLY], atomicLoad(&open_lanes));
    }
}

// Judges the lanes of an open part one by one.
@compute @workgroup_size(WORKGROUP)
fn sweep(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let number = number_of(id);
    if number >= listed(OPEN_PARTS) {
        return;
    }
    let open = row_table[open_part_at(number)];
    let run = run_of(open / PARTS / RUNS, open / PARTS % RUNS);
    let first = open % PARTS * PART;
    let last = min(first + PART, run.last);
    let horizon = horizon();
    let state = load_row(run.row);
    let held = hold_prepared(run.row);
    var counted = vec2<u32>(0u, 0u);
    for (var begin = first; begin < last; begin += BLOCK) {
        let end = min(begin + BLOCK, last);
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
        let here = lanes_here(run, state, begin, end);
        if !is_counted() {
            atomicAdd(&counts[SINGLY], countOneBits(here));
        }
        seen.sure &= here;
        seen.flagged &= here;
        counted += look_closer(seen, run.row, state, held, horizon, first_of(run, begin), &kept, local);
    }
    add_to_counts(counted);
}
