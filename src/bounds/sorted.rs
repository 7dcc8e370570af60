//! Numbers in buckets: how many are at most a threshold, without sorting them all.

/// Numbers of a bucket beyond which they are sorted.
const FEW: usize = 16;

/// Numbers cast into buckets of equal width, in the order of the buckets.
#[derive(Debug, Default)]
pub struct Buckets {
    low: f64,
    scale: f64,
    /// Where each bucket begins; one more entry for the end.
    starts: Vec<u32>,
    values: Vec<f64>,
}

impl Buckets {
    /// Casts finite numbers between `low` and `high` into buckets, about one each.
    pub fn fill(&mut self, numbers: &[f64], low: f64, high: f64) {
        let count = numbers.len().max(1);
        self.low = low;
        self.scale = if high > low { (count as f64 * (1.0 - f64::EPSILON)) / (high - low) } else { 0.0 };
        if !self.scale.is_finite() {
            self.scale = 0.0;
        }
        self.starts.clear();
        self.starts.resize(count + 2, 0);
        for &number in numbers {
            let bucket = self.bucket(number);
            self.starts[bucket + 2] += 1;
        }
        for at in 2..self.starts.len() {
            self.starts[at] += self.starts[at - 1];
        }
        self.values.resize(numbers.len(), 0.0);
        for &number in numbers {
            let bucket = self.bucket(number) + 1;
            self.values[self.starts[bucket] as usize] = number;
            self.starts[bucket] += 1;
        }
        self.starts.pop();
        // A few numbers far from the others leave those in few buckets.
        for ends in self.starts.windows(2) {
            let bucket = &mut self.values[ends[0] as usize..ends[1] as usize];
            if bucket.len() > FEW {
                bucket.sort_unstable_by(f64::total_cmp);
            }
        }
    }

    /// The bucket of a number: it never falls as the number rises, so what is in lower buckets is lower.
    #[inline(always)]
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates, and the bucket is limited")]
    fn bucket(&self, number: f64) -> usize {
        (((number - self.low) * self.scale) as usize).min(self.starts.len().saturating_sub(3))
    }

    #[inline(always)]
    fn of(&self, number: f64) -> (usize, &[f64]) {
        let bucket = (((number - self.low) * self.scale) as usize).min(self.starts.len() - 2);
        let (start, end) = (self.starts[bucket] as usize, self.starts[bucket + 1] as usize);
        (start, &self.values[start..end])
    }

    /// How many are at most this.
    #[inline(always)]
    pub fn at_most(&self, number: f64) -> u64 {
        let (before, same) = self.of(number);
        (before + first_ones(same, |it| it <= number)) as u64
    }

    /// How many are below this.
    #[inline(always)]
    pub fn below(&self, number: f64) -> u64 {
        let (before, same) = self.of(number);
        (before + first_ones(same, |it| it < number)) as u64
    }

    /// The largest that is at most this.
    pub fn last_at_most(&self, number: f64) -> Option<f64> {
        let (before, same) = self.of(number);
        // The last bucket before that has any ends where this one begins.
        let own = largest(same, |it| it <= number);
        own.or_else(|| largest(self.of(*self.values[..before].last()?).1, |_| true))
    }

    /// The least that is at least this.
    pub fn first_at_least(&self, number: f64) -> Option<f64> {
        let (before, same) = self.of(number);
        let own = least(same, |it| it >= number);
        own.or_else(|| least(self.of(*self.values[before + same.len()..].first()?).1, |_| true))
    }
}

/// How many of a bucket's numbers are of a kind that larger ones are not.
#[inline(always)]
fn first_ones(bucket: &[f64], is: impl Fn(f64) -> bool) -> usize {
    if bucket.len() <= FEW { bucket.iter().map(|&it| usize::from(is(it))).sum() } else { bucket.partition_point(|&it| is(it)) }
}

/// The largest of a bucket's numbers of such a kind.
fn largest(bucket: &[f64], is: impl Fn(f64) -> bool) -> Option<f64> {
    if bucket.len() <= FEW {
        return bucket.iter().copied().filter(|&it| is(it)).reduce(f64::max);
    }
    bucket[..bucket.partition_point(|&it| is(it))].last().copied()
}

/// The least of a bucket's numbers of a kind that smaller ones are not.
fn least(bucket: &[f64], is: impl Fn(f64) -> bool) -> Option<f64> {
    if bucket.len() <= FEW {
        return bucket.iter().copied().filter(|&it| is(it)).reduce(f64::min);
    }
    bucket[bucket.partition_point(|&it| !is(it))..].first().copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::mix;

    #[test]
    fn the_buckets_agree_with_looking_at_every_number() {
        let sizes = [(1, 1), (2, 1), (50, 7), (1000, 100_000), (1000, 3)];
        for ((count, levels), far) in sizes.into_iter().flat_map(|it| [(it, false), (it, true)]) {
            let mut numbers: Vec<f64> = (0..count).map(|i| (mix(i) % levels) as f64 * 0.37 - 5.0).collect();
            if far {
                numbers.extend([-1e9, 1e12, 1e12]);
            }
            let ends = numbers.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &it| (it.min(low), it.max(high)));
            let mut buckets = Buckets::default();
            // Room that was used before must not show.
            buckets.fill(&[1.0; 3000], 1.0, 1.0);
            buckets.fill(&numbers, ends.0, ends.1);
            let asked = numbers.iter().flat_map(|&it| [it, it.next_down(), it.next_up(), it + 0.1]).chain([ends.0 - 1.0, ends.1 + 1.0]);
            for threshold in asked {
                let count = |is: fn(&f64, &f64) -> bool| numbers.iter().filter(|it| is(it, &threshold)).count() as u64;
                assert_eq!((buckets.at_most(threshold), buckets.below(threshold)), (count(f64::le), count(f64::lt)));
                let last = numbers.iter().copied().filter(|it| *it <= threshold).reduce(f64::max);
                let first = numbers.iter().copied().filter(|it| *it >= threshold).reduce(f64::min);
                assert_eq!((buckets.last_at_most(threshold), buckets.first_at_least(threshold)), (last, first));
            }
        }
    }
}
