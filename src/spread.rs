//! How sampled numbers are spread evenly: Sobol points, and permutations without a table.

use sobol::Sobol;
use sobol::params::JoeKuoD6;

/// The points of Sobol with the direction numbers of Joe and Kuo.
#[derive(Clone, Debug)]
pub(crate) struct SobolSequence {
    directions: Vec<Vec<u64>>,
}

impl SobolSequence {
    /// Most dimensions that there are direction numbers for.
    pub const MOST_DIMENSIONS: usize = 100;

    /// With at most [`MOST_DIMENSIONS`](Self::MOST_DIMENSIONS) dimensions.
    pub fn new(dimensions: usize) -> Self {
        let directions = match dimensions {
            0 => Vec::new(),
            _ => Sobol::<u64>::init_direction_vals::<u32>(dimensions, 64, &JoeKuoD6::minimal()),
        };
        Self { directions }
    }

    /// The coordinate of point number `index` as a binary fraction of 64 bits.
    pub fn point(&self, dimension: usize, index: u64) -> u64 {
        let gray = index ^ index >> 1;
        let directions = &self.directions[dimension];
        (0..64).filter(|bit| gray >> bit & 1 == 1).fold(0, |point, bit| point ^ directions[bit as usize])
    }
}

/// The image of `index` under a random permutation of `0..count` that `key` chooses, without a table: a Feistel network over
/// the next even power of two, walked until it lands inside.
pub(crate) fn permuted(index: u64, count: u64, key: u64) -> u64 {
    let half = (64 - (count - 1).leading_zeros()).div_ceil(2).max(1);
    let mask = (1u64 << half) - 1;
    let mut x = index;
    loop {
        let (mut left, mut right) = (x >> half, x & mask);
        for round in 0..6u64 {
            let mixed = mix(right ^ key.rotate_left(round as u32 * 11) ^ round << 56);
            (left, right) = (right, left ^ (mixed & mask));
        }
        x = left << half | right;
        if x < count {
            return x;
        }
    }
}

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): every input bit reaches every output bit.
pub(crate) fn mix(x: u64) -> u64 {
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_permutation_hits_every_number_once() {
        for count in [1, 2, 3, 64, 1000, 4097] {
            let mut seen: Vec<_> = (0..count).map(|i| permuted(i, count, 99)).collect();
            assert!(count < 64 || seen.iter().enumerate().filter(|&(i, &x)| i as u64 == x).count() < 10, "it should mix");
            seen.sort_unstable();
            assert!(seen.into_iter().eq(0..count), "{count}");
        }
    }
}
