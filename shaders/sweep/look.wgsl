// What both second stages do with judged lanes: a first look at every one, which leaves two bits, and a closer look at the few whose
// bit is set. A branch or a look-up per lane would cost more than judging those again, which is what it does unless they were kept.

// Surely feasible designs: neighbours in the row are known to be equal to them in every objective that only the row decides, so
// they prune where no bound could. One per invocation, or every lane where judged lanes are kept anyway; infinite where none is.
var<workgroup> row_dominators: array<RowDominator, ROW_DOMINATORS>;

// Is a neighbour surely better, or surely as good in all and better in one?
fn beaten_in_the_row(keys: Keys, local: vec3<u32>) -> bool {
    for (var chunk = 0u; chunk < GROUP_CHUNKS; chunk++) {
        for (var i = 0u; i < ROW_DOMINATORS_EACH; i++) {
            if beats_in_the_row(row_dominators[row_dominator_at(local.x, chunk, i)], keys) {
                return true;
            }
        }
    }
    return false;
}

fn row_dominator_at(row: u32, chunk: u32, i: u32) -> u32 {
    return ((chunk * ROW_DOMINATORS_EACH + i) * GROUP_ROWS + row) % ROW_DOMINATORS;
}

// Which of the answers a surely feasible design may be part of.
fn closer_look(lane: Lane, horizon: Horizon, index: vec2<u32>, local: vec3<u32>) -> u32 {
    var why = 0u;
    if OBJECTIVES > 0u {
        let keys = keys_of(lane);
        var beaten = beaten_by_dominators(keys, horizon) || beaten_by_table(keys, horizon) || beaten_by_front(keys);
        if USES_ROW_DOMINATORS && !beaten {
            beaten = beaten_in_the_row(keys, local);
        }
        why |= select(MAY_BE_FRONT, 0u, beaten);
        why |= select(0u, MAY_BE_END, may_be_extreme(lane, horizon) && !is_known_extreme(lane, horizon, index));
    }
    why |= select(0u, MAY_BE_END, may_be_top(lane, horizon) && !is_known_top(lane, horizon, index));
    why |= select(0u, MAY_BE_END, may_be_sampled(index));
    return why;
}

// What the first look keeps of a block: a bit per lane that is surely feasible, and per lane that needs a closer look.
struct Seen {
    sure: u32,
    flagged: u32,
}

// The first look at lane number `i` of a block.
fn look_at(judged: Lane, horizon: Horizon, i: u32, count: u32, seen: ptr<function, Seen>, row_dominator: ptr<function, RowDominator>) {
    let mark = select(0u, 1u << i, i < count);
    let is_sure = judged.verdict == YES;
    (*seen).sure |= select(0u, mark, is_sure);
    let look = judged.verdict == UNSURE || (is_sure && (LOOK_AT_ALL || may_matter(judged, horizon)));
    (*seen).flagged |= select(0u, mark, look);
    if USES_ROW_DOMINATORS && !KEEPS && is_sure && i < count {
        let other = row_dominator_of(keys_of(judged));
        if is_worse_row_dominator(*row_dominator, other) {
            *row_dominator = other;
        }
    }
}

fn append(row: u32, lane: u32, why: u32, judged: Lane) {
    let at = atomicAdd(&counts[APPENDED], 1u);
    if at < tile.capacity {
        let word = at * SURVIVOR_WORDS;
        survivors[word] = row;
        survivors[word + 1u] = lane | (why << LANE_BITS);
        write_keys(word + SURVIVOR_HEAD, judged);
        write_map_keys(word + SURVIVOR_HEAD + OBJECTIVES, judged);
    }
}

// The closer look at the lanes of a block, which `lane_at` finds from `first`. How many are surely feasible, and how many are for f64 to
// count.
fn look_closer(
    seen: Seen,
    row: u32,
    state: RowState,
    held: Prepared,
    horizon: Horizon,
    first: u32,
    kept: ptr<function, array<Lane, KEPT>>,
    local: vec3<u32>,
) -> vec2<u32> {
    var sure_count = countOneBits(seen.sure);
    var unsure_count = 0u;
    var flagged = seen.flagged;
    while flagged != 0u {
        let i = firstTrailingBit(flagged);
        flagged &= flagged - 1u;
        let lane = lane_at(state, first, i);
        let place = digits_of_lane(lane);
        var judged: Lane;
        if KEEPS {
            judged = (*kept)[i % KEPT];
        } else {
            judged = judge_at(row, state, held, first, i);
        }
        // What the first look counted decides which list a design is in: judged again it may round otherwise.
        let counted = ((seen.sure >> i) & 1u) == 1u;
        var why = IS_UNSURE;
        if counted {
            if judged.verdict == YES && enters_histograms(judged) {
                why = closer_look(judged, horizon, wide_add(state.index, index_of_lane(lane)), local);
                why |= enter_maps(judged, state, place);
            } else {
                // Not sure any more, or its bin is not: f64 counts the whole design.
                sure_count -= 1u;
            }
        }
        unsure_count += why & IS_UNSURE;
        if why != 0u {
            append(row, lane, why, judged);
        }
    }
    return vec2<u32>(sure_count, unsure_count);
}

fn add_to_counts(counted: vec2<u32>) {
    if counted.x > 0u {
        atomicAdd(&counts[SURE], counted.x);
    }
    if counted.y > 0u {
        atomicAdd(&counts[UNDECIDED], counted.y);
    }
}
