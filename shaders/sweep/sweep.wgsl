// Second stage: every lane of every row over all scenarios. What is surely feasible is counted; what is unsure, and what may be
// part of an answer, is appended for f64.
//
// An invocation takes LANES_EACH lanes of one row, in blocks. It first judges the whole block, GROUP lanes at a time so that what
// they share is loaded and computed once.

@compute @workgroup_size(GROUP_ROWS, GROUP_CHUNKS)
fn sweep(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let row = group.x * GROUP_ROWS + local.x;
    let chunk = group.y * GROUP_CHUNKS + local.y;
    let at = min(row, tile.rows - 1u);
    let state = load_row(at);
    let held = hold_prepared(at);
    let horizon = horizon();
    let first = tile.first_lane + chunk * LANES_EACH;
    let open = row < tile.rows && state.verdict != NO;
    let last = select(first, min(first + LANES_EACH, tile.last_lane), open);
    var counted = vec2<u32>(0u, 0u);
    for (var block = 0u; block < BLOCKS; block++) {
        let start = first + block * BLOCK;
        let end = min(start + BLOCK, last);
        var seen = Seen(0u, 0u);
        var row_dominator = no_row_dominator();
        var kept: array<Lane, KEPT>;
        for (var i = 0u; i < BLOCK; i += GROUP) {
            if start + i >= end {
                break;
            }
            let group = judge_group(at, state, held, start + i);
            look_at_group(group, horizon, i, end - start, &seen, &row_dominator, &kept);
        }
        if USES_ROW_DOMINATORS {
            for (var i = 0u; i < ROW_DOMINATORS_EACH; i++) {
                if KEEPS {
                    row_dominator = no_row_dominator();
                    if ((seen.sure >> i) & 1u) == 1u {
                        row_dominator = row_dominator_of(keys_of(kept[i % KEPT]));
                    }
                }
                row_dominators[row_dominator_at(local.x, local.y, i)] = row_dominator;
            }
            workgroupBarrier();
        }
        counted += look_closer(seen, at, state, held, horizon, start, &kept, local);
        if USES_ROW_DOMINATORS {
            workgroupBarrier();
        }
    }
    add_to_counts(counted);
}
