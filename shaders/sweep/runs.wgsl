// Second stage where lanes with results that are near each other stand in runs. Judged once, a run shows what all its lanes have in common.
// Most are settled by that: no lane is feasible, or all are and the front beats them. What leaves a run open is a border that crosses it,
// and a border crosses one or two of its parts. So open runs are judged again in parts, and only lanes of parts that are still open are
// judged one by one.
//
// A first pass judges the runs and lists those that are open; a second one has an invocation for each of these and lists their open parts;
// a third one has an invocation for each part. Within one pass the invocations that meet a settled run would wait for their neighbours, and
// a software device would compute what it then drops.

// What a workgroup found open. An invocation puts all of its own there at once, after its loop: a software device does an atomic operation
// lane by lane.
var<workgroup> open_list: array<u32, OPEN_LIST>;
var<workgroup> open_count: atomic<u32>;
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

// Does what a stretch of lanes has in common leave any of them to be judged by itself? `is_whole`: does the tile have all lanes of its rows,
// or is it known which?
fn is_open(judged: Lane, horizon: Horizon, is_whole: bool) -> bool {
    if judged.verdict == NO {
        return false;
    }
    return judged.verdict == UNSURE || LOOK_AT_ALL || !is_whole || may_be_part(judged, horizon);
}

// Open runs are listed behind the rows of the tile, open parts behind the room for open runs.
fn open_run_at(number: u32) -> u32 {
    return ROW_WORDS * tile.rows + number;
}

fn open_part_at(number: u32) -> u32 {
    return ROW_WORDS * tile.rows + tile.open_room + number;
}

// Puts what a workgroup found open into a list of the tile. Bit `i` of `bits` stands for number `first + i`; `list` is the first word of
// the list, `length` the word of `counts` with its length.
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

// How many entries of a list are stored.
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

// Workgroups of the second and the third pass. It runs before each of them: those of the third one are right the second time.
@compute @workgroup_size(1)
fn count_groups() {
    store_groups(listed(OPEN), GROUPS);
    store_groups(listed(OPEN_PARTS), GROUPS + 3u);
}

fn store_groups(invocations: u32, word: u32) {
    let groups = (invocations + (WORKGROUP - 1u)) / WORKGROUP;
    atomicStore(&counts[word], min(groups, MOST_GROUPS));
    atomicStore(&counts[word + 1u], (groups + (MOST_GROUPS - 1u)) / MOST_GROUPS);
    atomicStore(&counts[word + 2u], 1u);
}

// The place in its list of what an invocation takes.
fn number_of(id: vec3<u32>) -> u32 {
    return id.y * (MOST_GROUPS * WORKGROUP) + id.x;
}

// Judges the parts of an open run. Where no run is open this pass has no workgroups.
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
        }
    }
    add_to_counts(counted);
    list_open(invocation, open, open_run * PARTS, open_part_at(0u), OPEN_PARTS);
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
    var singly = 0u;
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
        singly += countOneBits(here);
        seen.sure &= here;
        seen.flagged &= here;
        counted += look_closer(seen, run.row, state, held, horizon, first_of(run, begin), &kept, local);
    }
    add_to_counts(counted);
    atomicAdd(&counts[SINGLY], singly);
}
