//! Constants of the sweep that its kernel and the host both know.

use crate::gpu::shared_constants;
use crate::reduce::MOST_OBJECTIVES;

/// Most dominators that every design is compared with.
pub const DOMINATORS: usize = 8;

/// Most levels of one dimension that are kept on the device at a time.
pub const WINDOW: u64 = 1 << 20;
/// Most steps of the search for a root in a draw. Newton's method takes about five; what a search misses that needs more stands in the
/// bound of its root, and the draw is left to f64.
pub const NEWTON_STEPS_OF_DRAWS: u32 = 8;

/// A device's entry of one level of one input: value in SI, what f32 loses of it, value in its unit, 1 if constraints on inputs allow it.
pub type Level = [f32; 4];

shared_constants! {
    /// What `shaders/sweep` relies on.
    fn sweep_constants;

    /// Word of the counts: surely feasible designs.
    const SURE: u32 = 0;
    /// Word of the counts: designs that f64 must decide.
    const UNDECIDED: u32 = 1;
    /// Word of the counts: survivors, those for which there was no room among them.
    const APPENDED: u32 = 2;
    /// Word of the counts: runs that must be judged in parts, also those for which there was no room in their list.
    const OPEN: u32 = 3;
    /// Word of the counts: parts of these whose lanes must be judged singly, also those for which there was no room in their list.
    const OPEN_PARTS: u32 = 4;
    /// Word of the counts: their lanes.
    const SINGLY: u32 = 5;
    /// Six words of the counts: the workgroups that judge open runs, and those that judge open parts.
    const GROUPS: u32 = 6;
    /// First word of the counts that reducers ask for.
    const FIRST_REPORTED: u32 = 12;
    /// Most workgroups of a dispatch along either side.
    const MOST_GROUPS: u32 = 65_535;
    /// Why a design survives: f64 must decide whether it is feasible. The reasons are bits.
    const IS_UNSURE: u32 = 1;
    /// It may be on the front.
    const MAY_BE_FRONT: u32 = 2;
    /// It may be an extreme, in the top list, or in a sample.
    const MAY_BE_END: u32 = 4;
    /// It may be the best of a map's cell.
    const MAY_BE_IN_MAP: u32 = 8;
    /// Words of a survivor before its keys: its row, its lane with the reasons.
    const SURVIVOR_HEAD: u32 = 2;
    /// Bits of the lane's number in the second of these; the reasons stand above them.
    const LANE_BITS: u32 = 24;
    /// Which scenario of a design is compared with f64: row and lane times these numbers, so that all scenarios come up.
    const SCENARIO_PER_ROW: u32 = 7919;
    /// The same for the lane.
    const SCENARIO_PER_LANE: u32 = 104_729;
    /// Vectors of four digits that say where a tile begins, one digit a slow dimension.
    const DIGIT_VECTORS: u32 = 12;
    /// Vectors of four coordinates of the designs that every other is compared with, two vectors each.
    const DOMINATOR_VECTORS: u32 = 2 * DOMINATORS as u32;
    /// Pairs of extremes, one for each of the most objectives that a study may have.
    const EXTREMES: u32 = MOST_OBJECTIVES as u32;
}
