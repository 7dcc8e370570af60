//! A set of small numbers: which inputs, outputs or conditions of a model are meant.

use std::ops::{BitAnd, BitOr, BitOrAssign, Sub};

const WORDS: usize = 4;
const WORD: usize = u64::BITS as usize;

/// A set of numbers below [`Set::SIZE`]: of inputs, of outputs, of conditions, or of what a first stage passes on.
///
/// It is copied like a number and can be made in a constant, so a formula asks it within the inner loop.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Set([u64; WORDS]);

impl Set {
    /// Numbers from 0 to one below this fit in.
    pub const SIZE: usize = WORDS * WORD;
    /// No number.
    pub const EMPTY: Self = Self([0; WORDS]);
    /// Every number.
    pub const ALL: Self = Self([u64::MAX; WORDS]);

    /// The set of one number.
    ///
    /// # Panics
    /// If the number is not below [`Set::SIZE`], which [`Model::check`](crate::models::Model::check) rules out.
    #[inline(always)]
    pub const fn one(number: usize) -> Self {
        let mut words = [0; WORDS];
        words[number / WORD] = 1 << (number % WORD);
        Self(words)
    }

    /// The set of these numbers.
    #[inline(always)]
    pub const fn of(numbers: &[usize]) -> Self {
        let (mut set, mut i) = (Self::EMPTY, 0);
        while i < numbers.len() {
            set = set.with(Self::one(numbers[i]));
            i += 1;
        }
        set
    }

    /// The set of all numbers from `first` to `last`, both included.
    pub const fn between(first: usize, last: usize) -> Self {
        let (mut set, mut number) = (Self::EMPTY, first);
        while number <= last {
            set = set.with(Self::one(number));
            number += 1;
        }
        set
    }

    /// What is in either set: `|`, also in constants.
    #[inline(always)]
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        let (Self(mut words), mut i) = (self, 0);
        while i < WORDS {
            words[i] |= other.0[i];
            i += 1;
        }
        Self(words)
    }

    /// Is this number in the set?
    #[inline(always)]
    pub const fn contains(self, number: usize) -> bool {
        self.0[number / WORD] >> (number % WORD) & 1 == 1
    }

    /// Is some number in both sets?
    #[inline(always)]
    pub fn meets(self, other: Self) -> bool {
        !(self & other).is_empty()
    }

    /// Is no number in the set?
    #[inline(always)]
    pub fn is_empty(self) -> bool {
        self.0.iter().fold(0, |all, word| all | word) == 0
    }

    /// How many numbers are in the set?
    pub fn len(self) -> usize {
        self.0.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Adds a number.
    #[inline(always)]
    pub fn insert(&mut self, number: usize) {
        *self |= Self::one(number);
    }

    /// Its numbers, ascending.
    pub fn iter(self) -> impl Iterator<Item = usize> {
        (0..Self::SIZE).filter(move |&number| self.contains(number))
    }
}

impl BitOr for Set {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        self.with(other)
    }
}

impl BitOrAssign for Set {
    #[inline(always)]
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}

impl BitAnd for Set {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] & other.0[i]))
    }
}

impl Sub for Set {
    type Output = Self;
    /// What is in the first set and not in the second.
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] & !other.0[i]))
    }
}

impl FromIterator<usize> for Set {
    fn from_iter<I: IntoIterator<Item = usize>>(numbers: I) -> Self {
        numbers.into_iter().fold(Self::EMPTY, |set, number| set | Self::one(number))
    }
}

impl<'a> FromIterator<&'a usize> for Set {
    fn from_iter<I: IntoIterator<Item = &'a usize>>(numbers: I) -> Self {
        numbers.into_iter().copied().collect()
    }
}

impl FromIterator<Self> for Set {
    /// What is in any of the sets.
    fn from_iter<I: IntoIterator<Item = Self>>(sets: I) -> Self {
        sets.into_iter().fold(Self::EMPTY, Self::with)
    }
}

impl std::fmt::Debug for Set {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if *self == Self::ALL { f.write_str("{all}") } else { f.debug_set().entries(self.iter()).finish() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn a_set_holds_the_numbers_that_were_put_in_also_beyond_the_first_word() {
        const MADE: Set = Set::of(&[0, 63, 64, 130, 255]);
        let same = [255, 130, 64, 63, 0].iter().collect::<Set>();
        assert_eq!(MADE, same);
        assert_eq!(MADE.iter().collect::<Vec<_>>(), [0, 63, 64, 130, 255]);
        assert_eq!((MADE.len(), Set::EMPTY.len(), Set::ALL.len()), (5, 0, Set::SIZE));
        assert_eq!(Set::between(62, 65), Set::of(&[62, 63, 64, 65]));
        assert_eq!(format!("{MADE:?} {:?}", Set::ALL), "{0, 63, 64, 130, 255} {all}");
    }

    #[test]
    fn operations_are_those_of_sets() {
        let numbers =
            |seed: u64| -> BTreeSet<usize> { (0..40).map(|i| ((seed * 7919 + i) * 104_729 / 13 % Set::SIZE as u64) as usize).collect() };
        for seed in 0..50 {
            let (a, b) = (numbers(seed), numbers(seed + 50));
            let [of_a, of_b] = [&a, &b].map(|it| it.iter().collect::<Set>());
            let same = |set: Set, expected: BTreeSet<usize>| assert_eq!(set.iter().collect::<BTreeSet<_>>(), expected);
            same(of_a | of_b, &a | &b);
            same(of_a & of_b, &a & &b);
            same(of_a - of_b, &a - &b);
            same([of_a, of_b].into_iter().collect(), &a | &b);
            assert_eq!(of_a.meets(of_b), !a.is_disjoint(&b));
            assert!(!(of_a - of_b).meets(of_b) && (of_a - of_a).is_empty() && of_a.meets(Set::ALL) && !of_a.meets(Set::EMPTY));
            let mut more = of_a;
            more.insert(*b.first().expect("it has some"));
            assert_eq!(more, of_a | Set::one(*b.first().expect("it has some")));
        }
    }
}
