// For lanes that are not sorted: how one is judged again, and which ones the comparison with f64 judges.

fn judge_at(row: u32, state: RowState, held: Prepared, first: u32, i: u32) -> Lane {
    return judge(row, state, held, digits_of_lane(lane_at(state, first, i)));
}

fn checked_lanes() -> u32 {
    return tile.last_lane - tile.first_lane;
}

fn checked_group(row: u32, state: RowState, held: Prepared, at: u32) -> Group {
    return judge_group(row, state, held, tile.first_lane + at);
}

fn checked_lane(state: RowState, at: u32) -> u32 {
    return tile.first_lane + at;
}
