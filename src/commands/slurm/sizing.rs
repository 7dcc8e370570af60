//! The number of shards, and the time limit of each.

use super::Scheduler;
use beltspace::error::{Error, Result};

/// Seconds that a shard should take if their number is not given: long against the overhead of a job, short against the limits of a queue.
const GOAL: f64 = 600.0;
/// Least time limit in seconds: nodes differ in speed, and asking for this little does not make a job wait longer.
const LEAST_LIMIT: f64 = 600.0;
/// The time limit is the expected time times this factor, rounded up to whole steps.
const CAUTION: f64 = 4.0;
const LIMIT_STEP: u64 = 300;
/// Largest time limit if bounds are used.
const LONGEST_OF_BOUNDS: f64 = 86_400.0;

/// The work of a study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    pub designs: u64,
    /// Seconds per design on one CPU.
    pub seconds: f64,
    /// Designs that every shard judges in addition to its own.
    pub sample: u64,
    /// Designs that are judged again when the shards are merged.
    pub again: u64,
    /// CPUs per job.
    pub cpus: u16,
}

#[allow(clippy::cast_precision_loss, reason = "an estimate")]
impl Work {
    fn judging(&self, designs: u64) -> f64 {
        designs.div_ceil(self.cpus.into()) as f64 * self.seconds
    }

    /// Seconds that a single job would take for the whole study.
    pub fn of_all(&self) -> f64 {
        self.judging(self.designs)
    }

    /// Seconds that one of this many shards takes for its own designs.
    pub fn of_own(&self, shards: u64) -> f64 {
        self.judging(self.designs.div_ceil(shards))
    }

    /// Seconds that one of this many shards takes.
    pub fn of_shard(&self, shards: u64) -> f64 {
        self.of_own(shards) + self.judging(self.sample)
    }

    /// Seconds that merging the shards takes, without the front.
    pub fn of_merge(&self) -> f64 {
        self.judging(self.again)
    }
}

/// What the user wants of the number of shards.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// Do shards use bounds? Each would search for the whole front, so there is only one unless the number is given.
    pub bounds: bool,
    pub shards: Option<u64>,
    /// Least time of a shard in seconds.
    pub shortest: u32,
    /// Most jobs of one array.
    pub limit: Option<u64>,
}

/// The number of shards.
///
/// # Errors
/// [`Error::Request`] for more shards than there are designs or than the scheduler accepts.
pub fn shards(work: &Work, wish: &Wish, scheduler: Scheduler) -> Result<u64> {
    let limit = wish.limit.unwrap_or(scheduler.usual_limit());
    let Some(asked) = wish.shards else {
        return Ok(if wish.bounds { 1 } else { ((work.of_all() / GOAL).ceil() as u64).clamp(1, limit.min(work.designs)) });
    };
    if asked > work.designs {
        let (designs, word) = (work.designs, if work.designs == 1 { "design" } else { "designs" });
        return Err(Error::Request(format!(
            "--shards {asked}: the study has {designs} {word}, and a shard needs one; ask for at most {designs}"
        )));
    }
    // However short the whole takes, one shard remains.
    let worth = if wish.shortest == 0 { asked } else { (work.of_all() / f64::from(wish.shortest)).floor() as u64 };
    let shards = asked.min(worth.max(1));
    if shards > limit {
        let name = scheduler.name();
        return Err(Error::Request(format!(
            "--shards {asked}: {name} usually accepts {limit} jobs in one array ({}); ask for at most {limit}, or say with --array-limit that \
             yours takes more",
            scheduler.where_the_limit_is()
        )));
    }
    Ok(shards)
}

/// The time limit in seconds for a job that is expected to take this long.
pub fn limit(expected: f64) -> u64 {
    // The cast saturates.
    ((CAUTION * expected).max(LEAST_LIMIT).ceil() as u64).div_ceil(LIMIT_STEP).saturating_mul(LIMIT_STEP)
}

/// The time limit in seconds for a job that uses bounds. All that is known of its time is that judging every design usually takes longer,
/// whether the job is a shard or the whole study.
pub fn limit_of_bounds(exhaustive: f64) -> u64 {
    limit(exhaustive.min(LONGEST_OF_BOUNDS / CAUTION))
}

/// A time limit as both schedulers write it.
pub fn clock(seconds: u64) -> String {
    format!("{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

/// A time limit that the user wrote.
///
/// # Errors
/// [`Error::Request`] if it is not a time.
pub fn read_clock(text: &str) -> Result<String> {
    let refuse = || Error::Request(format!("--time {text}: a time limit is HH:MM:SS, such as 02:30:00; hours may be more than 24"));
    let parts: Vec<u64> = text
        .split(':')
        .map(|part| part.bytes().all(|it| it.is_ascii_digit()).then(|| part.parse().ok()).flatten().ok_or_else(refuse))
        .collect::<Result<_>>()?;
    match parts[..] {
        [hours, minutes, seconds] if hours < 100_000 && minutes < 60 && seconds < 60 && hours + minutes + seconds > 0 => {
            Ok(clock(hours * 3600 + minutes * 60 + seconds))
        }
        _ => Err(refuse()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORK: Work = Work { designs: 1_000_000, seconds: 0.01, sample: 0, again: 0, cpus: 4 };

    fn shards_of(work: &Work, wish: &Wish) -> Result<u64> {
        shards(work, wish, Scheduler::Slurm)
    }

    #[test]
    fn a_shard_takes_about_ten_minutes() {
        let free = Wish { bounds: false, shards: None, shortest: 60, limit: None };
        // 2500 s on four CPUs.
        assert_eq!(shards_of(&WORK, &free).ok(), Some(5));
        assert_eq!(shards_of(&Work { cpus: 1, ..WORK }, &free).ok(), Some(17));
        assert_eq!(shards_of(&Work { seconds: 1e-6, ..WORK }, &free).ok(), Some(1));
        // No more than an array accepts, and no more than there are designs.
        assert_eq!(shards_of(&Work { seconds: 1e9, ..WORK }, &free).ok(), Some(1000));
        assert_eq!(shards_of(&Work { seconds: 1e9, designs: 3, ..WORK }, &free).ok(), Some(3));
        assert_eq!(shards(&Work { seconds: 1e9, ..WORK }, &free, Scheduler::Pbs).ok(), Some(10_000));
    }

    #[test]
    fn bounds_take_one_shard_unless_more_are_asked_for() {
        let of = |shards| shards_of(&WORK, &Wish { bounds: true, shards, shortest: 60, limit: None }).ok();
        assert_eq!([of(None), of(Some(7))], [Some(1), Some(7)]);
        assert_eq!([1.0, 601.0, 1e9].map(limit_of_bounds).map(clock), ["00:10:00", "00:45:00", "24:00:00"]);
    }

    #[test]
    fn a_shard_takes_no_less_than_asked_for() {
        let of = |asked, shortest| shards_of(&WORK, &Wish { bounds: false, shards: Some(asked), shortest, limit: None }).ok();
        assert_eq!([of(3, 60), of(41, 60), of(42, 60), of(900, 60)], [Some(3), Some(41), Some(41), Some(41)]);
        assert_eq!([of(900, 0), of(900, 1), of(2, 86_400)], [Some(900), Some(900), Some(1)]);
    }

    #[test]
    fn more_shards_than_designs_or_places_in_an_array_are_refused() {
        let refusal = |shards, limit| {
            let wish = Wish { bounds: false, shards: Some(shards), shortest: 0, limit };
            shards_of(&Work { designs: 5000, ..WORK }, &wish).expect_err("it is too many").to_string()
        };
        assert_eq!(refusal(5001, None), "--shards 5001: the study has 5000 designs, and a shard needs one; ask for at most 5000");
        assert_eq!(
            refusal(1001, None),
            "--shards 1001: Slurm usually accepts 1000 jobs in one array (MaxArraySize of scontrol show config, less one); ask for at most \
             1000, or say with --array-limit that yours takes more"
        );
        assert!(refusal(11, Some(10)).contains("ask for at most 10"));
        let wish = Wish { bounds: false, shards: Some(4000), shortest: 0, limit: Some(4000) };
        assert_eq!(shards_of(&Work { designs: 5000, ..WORK }, &wish).ok(), Some(4000));
    }

    #[test]
    fn what_every_shard_judges_beside_its_own_counts() {
        let slow = Work { designs: 3000, seconds: 1.0, sample: 3000, again: 3000, cpus: 2 };
        assert_eq!([slow.of_all(), slow.of_own(10), slow.of_shard(10), slow.of_merge()], [1500.0, 150.0, 1650.0, 1500.0]);
        // Designs are not divided: seven on two CPUs take as long as eight.
        assert_eq!(Work { designs: 7, sample: 0, ..slow }.of_shard(1), 4.0);
    }

    #[test]
    fn limits_are_generous_and_whole() {
        assert_eq!([limit(0.0), limit(150.0), limit(151.0), limit(600.0)].map(clock), ["00:10:00", "00:10:00", "00:15:00", "00:40:00"]);
        assert_eq!(clock(limit(100_000.0)), "111:10:00");
        assert_eq!(read_clock("2:05:00").ok().as_deref(), Some("02:05:00"));
        assert_eq!(read_clock("300:00:00").ok().as_deref(), Some("300:00:00"));
        for wrong in ["", "10", "1:2", "1:60:00", "00:00:00", "1:00:-1", "1:00:+1", "x:00:00", "1:00:00\n", "1-00:00:00"] {
            assert!(read_clock(wrong).is_err(), "{wrong:?}");
        }
    }
}
