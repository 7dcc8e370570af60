//! Faults put into a kernel on purpose, and what is usual without them.

/// Room for survivors of a tile.
const CAPACITY: u64 = 1 << 20;
/// Room for open runs of a tile, and for open parts of these.
const OPEN_ROOM: u64 = 8 << 20;

/// Faults put into a kernel on purpose: `--perturb` and the tests show that they are noticed.
#[derive(Clone, Debug, Default)]
pub struct Wrong {
    /// Outputs that come out wrong by this fraction of their value.
    pub perturb: Vec<(usize, f64)>,
    /// Pieces of the kernel's text to be replaced.
    #[cfg(feature = "testing")]
    pub replace: Vec<(String, String)>,
    /// Judge lanes in groups, and these in runs first, also where the study is small.
    #[cfg(feature = "testing")]
    pub grouped: bool,
    /// Room for survivors, if not the usual.
    #[cfg(feature = "testing")]
    pub capacity: Option<u64>,
    /// Room for open runs, and for open parts, if not the usual.
    #[cfg(feature = "testing")]
    pub open_runs: Option<u64>,
    /// Begin without a look at what is beside the front: where f64 has found all of it, a device that loses some does no harm.
    #[cfg(feature = "testing")]
    pub blind: bool,
}

#[cfg(feature = "testing")]
impl Wrong {
    /// These outputs come out wrong by these fractions.
    pub fn by(perturb: Vec<(usize, f64)>) -> Self {
        Self { perturb, ..Self::default() }
    }

    pub(super) fn text(&self, mut source: String) -> String {
        for (piece, other) in &self.replace {
            assert!(source.contains(piece), "the kernel has no {piece}");
            source = source.replace(piece, other);
        }
        source
    }

    /// Is a kernel what this program writes, with no piece of it replaced?
    pub(super) fn keeps_text(&self) -> bool {
        self.replace.is_empty()
    }

    pub(super) fn is_grouped(&self) -> bool {
        self.grouped
    }

    pub(super) fn capacity(&self) -> u64 {
        self.capacity.unwrap_or(CAPACITY)
    }

    pub(super) fn open_runs(&self) -> u64 {
        self.open_runs.unwrap_or(OPEN_ROOM)
    }

    /// Is the sweep to begin without a look at what is beside the front?
    pub fn is_blind(&self) -> bool {
        self.blind
    }
}

/// Where nothing is tested, a kernel is what it is.
#[cfg(not(feature = "testing"))]
#[allow(clippy::unused_self, reason = "as where it is tested")]
impl Wrong {
    /// These outputs come out wrong by these fractions.
    pub fn by(perturb: Vec<(usize, f64)>) -> Self {
        Self { perturb }
    }

    pub(super) fn text(&self, source: String) -> String {
        source
    }

    pub(super) fn keeps_text(&self) -> bool {
        true
    }

    pub(super) fn is_grouped(&self) -> bool {
        false
    }

    pub(super) fn capacity(&self) -> u64 {
        CAPACITY
    }

    pub(super) fn open_runs(&self) -> u64 {
        OPEN_ROOM
    }

    /// Is the sweep to begin without a look at what is beside the front?
    pub fn is_blind(&self) -> bool {
        false
    }
}
