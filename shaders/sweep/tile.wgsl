// What a tile is and where its values lie: shared by all stages of a sweep.
//
// A row is one combination of the slow design axes; its lanes are the combinations of the fast ones. The constants in capitals,
// the structures `RowState`, `Lane`, `Digits` and `Keys`, and the functions that know the study come from the prelude; those that do not
// depend on the study are declared in src/screen/gpu/constants.rs.

struct Tile {
    rows: u32,
    first_lane: u32,
    last_lane: u32,
    // Room for survivors.
    capacity: u32,
    // Design index of what the digits below count from.
    index: vec2<u32>,
    // First level of the outermost dimension's window.
    window: u32,
    // Room for open runs behind the rows, and for open parts behind these.
    open_room: u32,
    // Position of the first row along each slow dimension; of the outermost one within its window of levels.
    digits: array<vec4<u32>, DIGIT_VECTORS>,
}

// What is known of the front and of the other answers so far: what cannot be part of them need not be looked at.
struct KnownUniform {
    // Certified designs of the front that most others fall behind, two vectors of coordinates each.
    dominators: array<vec4<f32>, DOMINATOR_VECTORS>,
    // The worst of the best K: its key, and 1 where f32 holds it exactly; its index.
    top: vec4<f32>,
    top_index: vec4<u32>,
    // Per objective: least and largest value, and whether f32 holds them exactly; their indices.
    extremes: array<vec4<f32>, EXTREMES>,
    extreme_indices: array<vec4<u32>, EXTREMES>,
    // Where the look-up table starts and bins per unit, for its two coordinates.
    table: vec4<f32>,
    // The largest place, two words, that may still be part of a sample of feasible designs.
    last_place: vec4<u32>,
    // How many points of the front stand behind the look-up table.
    points: vec4<u32>,
}

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<uniform> known: KnownUniform;
// Levels of the slow design axes: value in SI and what f32 loses of it, value in its unit, 1 if constraints on inputs allow it.
@group(0) @binding(3) var<storage, read> levels: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> prepared_table: array<Real>;
// What lanes of a row share, and behind all rows the open runs and their open parts.
@group(0) @binding(5) var<storage, read_write> row_table: array<u32>;
// SURE feasible designs, UNDECIDED ones, those APPENDED to the survivors, OPEN runs, OPEN_PARTS, designs judged SINGLY, GROUPS of the second
// and the third pass; then histograms; then feasible designs per map cell.
@group(0) @binding(6) var<storage, read_write> counts: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> survivors: array<u32>;
@group(0) @binding(8) var<storage, read> dominator_table: array<f32>;
// Best key so far of each map cell, as an ordered number.
@group(0) @binding(9) var<storage, read_write> cells: array<atomic<u32>>;

// The bits of an f32 as a number of the same order.
fn ordered(x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    return select(bits | 0x80000000u, ~bits, (bits >> 31u) == 1u);
}

fn level(entry: vec4<f32>) -> Real {
    return Real(entry.x, abs(entry.y));
}
