//! "Is there a point at least as good in everything?", answered over a growing set of points.
//!
//! Points are minimised in every coordinate. They are kept in trees of doubling size (the logarithmic method of Bentley and
//! Saxe), each a k-d tree whose nodes know the best corner of what they hold: a node whose corner is not at least as good as
//! the point asked about cannot hold one that is.

use std::ops::Range;

/// Points in a leaf.
const LEAF: usize = 16;
/// Most nodes that wait in a search: one for each time that all points can be halved, and the one looked at.
const MOST_PENDING: usize = 65;
/// Points that are searched one by one before they become a tree.
const BUFFER: usize = 64;

/// A set of points with design indices, in at most six coordinates.
#[derive(Debug, Default)]
pub struct Dominance {
    dimensions: usize,
    trees: Vec<Tree>,
    buffer: PointSet,
}

/// Coordinates, point after point, and the design index of each.
#[derive(Clone, Debug, Default)]
struct PointSet {
    keys: Vec<f64>,
    indices: Vec<u64>,
}

impl PointSet {
    fn key(&self, point: usize, dimensions: usize) -> &[f64] {
        &self.keys[point * dimensions..][..dimensions]
    }

    /// The first of some points that makes another one superfluous.
    fn find<const D: usize>(&self, points: Range<usize>, key: &[f64; D], index: u64) -> Option<usize> {
        let keys = &self.keys.as_chunks::<D>().0[points.clone()];
        let beats = |(own, &own_index): (&[f64; D], &u64)| is_no_worse(own, key) && (own_index < index || own != key);
        keys.iter().zip(&self.indices[points.clone()]).position(beats).map(|place| points.start + place)
    }

    fn push(&mut self, key: &[f64], index: u64) {
        self.keys.extend_from_slice(key);
        self.indices.push(index);
    }
}

/// A node holds the points `first..last`; an inner node's left child follows it directly.
#[derive(Debug)]
struct TreeNode {
    first: usize,
    last: usize,
    right: Option<usize>,
}

#[derive(Debug)]
struct Tree {
    points: PointSet,
    nodes: Vec<TreeNode>,
    /// Best corner of every node.
    corners: Vec<f64>,
}

/// Does `a` make `b` superfluous: at least as good everywhere, and better somewhere or the same with a lower index?
pub fn beats(a: &[f64], a_index: u64, b: &[f64], b_index: u64) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b) && (a_index < b_index || a.iter().zip(b).any(|(a, b)| a < b))
}

/// Is `a` at least as good everywhere? One comparison waits for no other.
#[inline(always)]
fn is_no_worse<const D: usize>(a: &[f64; D], b: &[f64; D]) -> bool {
    (0..D).fold(true, |all, at| all & (a[at] <= b[at]))
}

impl Dominance {
    /// An empty set of points with so many coordinates.
    pub fn new(dimensions: usize) -> Self {
        Self { dimensions, trees: Vec::new(), buffer: PointSet::default() }
    }

    /// The set of these points: coordinates point after point, and an index each. Faster than to insert one by one.
    pub fn of(dimensions: usize, keys: &[f64], indices: &[u64]) -> Self {
        let points = PointSet { keys: keys.to_vec(), indices: indices.to_vec() };
        let trees = if indices.is_empty() { Vec::new() } else { vec![Tree::new(points, dimensions)] };
        Self { dimensions, trees, buffer: PointSet::default() }
    }

    /// Adds a point.
    pub fn insert(&mut self, key: &[f64], index: u64) {
        self.buffer.push(key, index);
        if self.buffer.indices.len() < BUFFER {
            return;
        }
        let mut points = std::mem::take(&mut self.buffer);
        // Trees of at most the size so far are absorbed, so that sizes double and a point moves a logarithm of times.
        while let Some(tree) = self.trees.pop_if(|tree| tree.points.indices.len() <= points.indices.len()) {
            points.keys.extend_from_slice(&tree.points.keys);
            points.indices.extend_from_slice(&tree.points.indices);
        }
        self.trees.push(Tree::new(points, self.dimensions));
    }

    /// A point of the set that makes this one superfluous, if there is one: its coordinates and index.
    pub fn dominator(&self, key: &[f64], index: u64) -> Option<(&[f64], u64)> {
        // Asked of every design that may be on a front: compiled for each number of coordinates.
        let (points, point) = match self.dimensions {
            1 => self.find::<1>(key, index),
            2 => self.find::<2>(key, index),
            3 => self.find::<3>(key, index),
            4 => self.find::<4>(key, index),
            5 => self.find::<5>(key, index),
            6 => self.find::<6>(key, index),
            more => panic!("{more} coordinates: there are 1 to 6"),
        }?;
        Some((points.key(point, self.dimensions), points.indices[point]))
    }

    fn find<const D: usize>(&self, key: &[f64], index: u64) -> Option<(&PointSet, usize)> {
        let key: &[f64; D] = key.try_into().expect("it has as many coordinates as the points");
        for tree in &self.trees {
            if let Some(point) = tree.find(key, index) {
                return Some((&tree.points, point));
            }
        }
        Some((&self.buffer, self.buffer.find(0..self.buffer.indices.len(), key, index)?))
    }
}

impl Tree {
    fn new(points: PointSet, dimensions: usize) -> Self {
        let mut order: Vec<usize> = (0..points.indices.len()).collect();
        let mut tree = Self { points: PointSet::default(), nodes: Vec::new(), corners: Vec::new() };
        tree.build(&points, &mut order, 0, dimensions);
        for &point in &order {
            tree.points.push(points.key(point, dimensions), points.indices[point]);
        }
        tree
    }

    /// Builds the node of `order`, which lies at `first` in the final order, and its children.
    fn build(&mut self, points: &PointSet, order: &mut [usize], first: usize, dimensions: usize) {
        let ends = |dimension: usize, order: &[usize]| {
            let values = order.iter().map(|&point| points.keys[point * dimensions + dimension]);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
        };
        let spans: Vec<_> = (0..dimensions).map(|dimension| ends(dimension, order)).collect();
        self.corners.extend(spans.iter().map(|span| span.0));
        let node = self.nodes.len();
        self.nodes.push(TreeNode { first, last: first + order.len(), right: None });
        if order.len() <= LEAF {
            return;
        }
        let width = |dimension: &usize| spans[*dimension].1 - spans[*dimension].0;
        let widest = (0..dimensions).max_by(|a, b| width(a).total_cmp(&width(b))).expect("points have a coordinate");
        let middle = order.len() / 2;
        let value = |point: &usize| points.keys[point * dimensions + widest];
        order.select_nth_unstable_by(middle, |a, b| value(a).total_cmp(&value(b)));
        let (left, right) = order.split_at_mut(middle);
        self.build(points, left, first, dimensions);
        self.nodes[node].right = Some(self.nodes.len());
        self.build(points, right, first + middle, dimensions);
    }

    fn find<const D: usize>(&self, key: &[f64; D], index: u64) -> Option<usize> {
        let corners = self.corners.as_chunks::<D>().0;
        let (mut pending, mut count) = ([0; MOST_PENDING], 1);
        while count > 0 {
            count -= 1;
            let number = pending[count];
            if !is_no_worse(&corners[number], key) {
                continue;
            }
            let node = &self.nodes[number];
            match node.right {
                Some(right) => {
                    pending[count..count + 2].copy_from_slice(&[right, number + 1]);
                    count += 2;
                }
                None => {
                    if let Some(point) = self.points.find(node.first..node.last, key, index) {
                        return Some(point);
                    }
                }
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::mix;

    #[test]
    fn the_trees_agree_with_comparing_everything() {
        for dimensions in 1..=6 {
            // Few levels, so that ties in single coordinates and equal points are common.
            let point = |i: u64| -> Vec<f64> { (0..dimensions).map(|d| (mix(i * 8 + d + 1000 * dimensions) % 12) as f64).collect() };
            let mut set = Dominance::new(dimensions as usize);
            assert!(Dominance::of(dimensions as usize, &[], &[]).dominator(&point(0), 0).is_none());
            let points: Vec<_> = (0..700).map(point).collect();
            for (index, key) in points.iter().enumerate() {
                let beaten = points[..index].iter().enumerate().any(|(other, it)| beats(it, other as u64, key, index as u64));
                let found = set.dominator(key, index as u64);
                assert_eq!(found.is_some(), beaten, "{dimensions} dimensions, point {index}");
                if let Some((by, by_index)) = found {
                    assert!(beats(by, by_index, key, index as u64));
                }
                set.insert(key, index as u64);
                if index % 50 == 0 {
                    let keys: Vec<f64> = points[..index].concat();
                    let at_once = Dominance::of(dimensions as usize, &keys, &(0..index as u64).collect::<Vec<_>>());
                    assert_eq!(at_once.dominator(key, index as u64).is_some(), beaten, "{dimensions} dimensions, {index} points");
                }
            }
        }
    }

    #[test]
    fn an_equal_point_beats_by_its_lower_index_only() {
        assert!(beats(&[1.0, 2.0], 3, &[1.0, 2.0], 4));
        assert!(!beats(&[1.0, 2.0], 4, &[1.0, 2.0], 3));
        assert!(beats(&[1.0, 2.0], 4, &[1.0, 3.0], 3));
        assert!(!beats(&[1.0, 2.0], 1, &[0.0, 3.0], 3));
    }
}
