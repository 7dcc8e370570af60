//! One axis of the plane: the levels that are nodes of the grid, and bisection between them.

/// Width of a bracket relative to the axis: half a billionth, so that even a bracket that is widened once is no wider than a billionth.
const FINENESS: f64 = 0.5e-9;
/// How often a bracket may be widened until its ends, as read back from a file, have different answers.
const WIDENINGS: usize = 8;

/// An axis with its levels, in rising or falling order.
pub struct GridAxis<'a> {
    level: &'a (dyn Fn(u64) -> f64 + Sync),
    nodes: Vec<u64>,
    /// Do values between two levels have a meaning?
    divisible: bool,
    finest: f64,
}

/// A section of an axis whose ends have different answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bracket {
    /// Its middle.
    pub middle: f64,
    /// Its width: the ends are half of it away from the middle.
    pub width: f64,
}

impl Bracket {
    /// The lower and the upper end, as a reader of a file computes them.
    pub fn ends(self) -> (f64, f64) {
        (self.middle - 0.5 * self.width, self.middle + 0.5 * self.width)
    }
}

impl<'a> GridAxis<'a> {
    /// An axis of `count` levels, of which at most `most` become nodes: evenly chosen, the first and the last among them.
    pub fn new(count: u64, most: u64, level: &'a (dyn Fn(u64) -> f64 + Sync), divisible: bool) -> Self {
        let nodes = count.min(most.max(2));
        let steps = nodes.saturating_sub(1).max(1);
        let chosen = |node: u64| {
            let nearest = (u128::from(node) * u128::from(count - 1) + u128::from(steps / 2)) / u128::from(steps);
            u64::try_from(nearest).expect("it is a level's number")
        };
        let finest = FINENESS * (level(count - 1) - level(0)).abs();
        Self { level, nodes: (0..nodes).map(chosen).collect(), divisible, finest }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// The value of a node.
    pub fn at(&self, node: usize) -> f64 {
        (self.level)(self.nodes[node])
    }

    /// A value between a node and the next one, if there is any.
    pub(super) fn centre(&self, node: usize) -> Option<f64> {
        if self.divisible {
            return Some(middle(self.at(node), self.at(node + 1)));
        }
        let (first, last) = (self.nodes[node], self.nodes[node + 1]);
        (last - first > 1).then(|| (self.level)(first + (last - first) / 2))
    }

    /// Bisects between a node and the next one, whose answers differ, to find where the answer changes. `None` if an answer is missing on
    /// the way: then there is a gap between the two ends, and the contour has no place in it.
    pub(super) fn narrow(&self, node: usize, ask: impl Fn(f64) -> Option<bool>) -> Option<Bracket> {
        if self.divisible { self.bisect(self.at(node), self.at(node + 1), ask) } else { self.bisect_levels(node, ask) }
    }

    fn bisect(&self, mut from: f64, mut to: f64, ask: impl Fn(f64) -> Option<bool>) -> Option<Bracket> {
        let first = ask(from)?;
        while (to - from).abs() > self.finest {
            let between = middle(from, to);
            if between == from || between == to {
                break;
            }
            *(if ask(between)? == first { &mut from } else { &mut to }) = between;
        }
        // Middle and width are rounded, so the ends computed from them may differ from those that were evaluated.
        let mut found = Bracket { middle: middle(from, to), width: (to - from).abs() };
        for _ in 0..WIDENINGS {
            let ends = found.ends();
            if ends == (from.min(to), from.max(to)) || ask(ends.0)? != ask(ends.1)? {
                return Some(found);
            }
            found.width *= 2.0;
        }
        None
    }

    fn bisect_levels(&self, node: usize, ask: impl Fn(f64) -> Option<bool>) -> Option<Bracket> {
        let (mut from, mut to) = (self.nodes[node], self.nodes[node + 1]);
        let first = ask((self.level)(from))?;
        while to - from > 1 {
            let between = from + (to - from) / 2;
            *(if ask((self.level)(between))? == first { &mut from } else { &mut to }) = between;
        }
        let (from, to) = ((self.level)(from), (self.level)(to));
        Some(Bracket { middle: middle(from, to), width: (to - from).abs() })
    }
}

/// The value halfway between two.
fn middle(from: f64, to: f64) -> f64 {
    from + 0.5 * (to - from)
}
