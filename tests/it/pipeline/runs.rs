//! The pipeline, run in every way that must not affect the result.

use crate::random::Random;
use beltspace::checkpoint::{Checkpoint, Saved};
use beltspace::export::{Certified, MethodRecord, RunRecord};
use beltspace::files::Claim;
use beltspace::merge::{check_set, merge};
use beltspace::names::CHECKPOINT;
use beltspace::plan::Plan;
use beltspace::reduce::{Reduction, State};
use beltspace::screen::gpu::Wrong;
use beltspace::screen::{CpuEngine, Tables, Tally};
use beltspace::sweep::{Control, Settings, sweep, sweep_on_device};
use beltspace::tiles::{Ranges, Shard};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A study laid out, with what every run of it needs.
pub struct Pipeline<'p> {
    pub plan: &'p Plan,
    text: &'p str,
    pub tables: Tables,
    tally: Tally,
    pub reduction: Reduction,
}

/// The bytes of a result's files by name, `run.json` left out.
pub type Files = BTreeMap<String, Vec<u8>>;

impl<'p> Pipeline<'p> {
    pub fn new(plan: &'p Plan, text: &'p str) -> Self {
        let tables = Tables::new(plan);
        let tally = Tally::new(plan, &tables, 2);
        let reduction = Reduction::new(plan, &tally.histogram_ranges(plan));
        Self { plan, text, tables, tally, reduction }
    }

    /// One run over the whole study.
    pub fn whole(&self, options: &Settings) -> State {
        let control = Control::default();
        sweep(self.plan, &self.tables, &self.reduction, options, None, &control).expect("the sweep ends").state
    }

    /// One run on the device of the tests, lanes judged one by one or in groups; its state and files.
    pub fn on_device(&self, grouped: bool, folder: &Path) -> (State, Files) {
        let device = &crate::gpu::wrong(Wrong { grouped, ..Wrong::default() });
        let (options, control) = (Settings { threads: 2, ..Settings::default() }, Control::default());
        let swept = sweep_on_device(self.plan, &self.tables, &self.reduction, &options, None, &control, device);
        let state = swept.unwrap_or_else(|error| panic!("{error}")).0.state;
        let files = self.write(state.clone(), 1, folder);
        (state, files)
    }

    /// Several shards by the ordinary sweep.
    pub fn sharded(&self, random: &mut Random, folder: &Path) -> State {
        self.sharded_by(random, folder, |_, options, checkpoint| {
            sweep(self.plan, &self.tables, &self.reduction, options, Some(checkpoint), &Control::default()).expect("the sweep ends");
        })
    }

    /// Several shards, each with a checkpoint, some of them resumed halfway, merged in a random order.
    pub fn sharded_by(&self, random: &mut Random, folder: &Path, mut judge: impl FnMut(&mut Random, &Settings, &mut Checkpoint)) -> State {
        let of = random.whole(2, 5) as u64;
        let mut folders = Vec::new();
        for number in 1..=of {
            let shard = Shard { number, of };
            let folder = folder.join(format!("shard-{number}"));
            let claim = Claim::new(&folder, "a test").expect("nobody has it");
            let mut checkpoint =
                Checkpoint::create(&claim, &self.plan.study, self.text, shard, self.plan.designs()).expect("a folder can be made");
            if random.chance(0.5) {
                self.begin(random, &mut checkpoint);
                drop(checkpoint);
                checkpoint = Checkpoint::open(&claim).expect("a part is kept");
                checkpoint.saved().require(&self.plan.study, shard).expect("it is of this study and shard");
            }
            let options = Settings { shard, ..options(random, 7.max(self.plan.designs() / 2000)) };
            judge(random, &options, &mut checkpoint);
            folders.push(folder);
        }
        random.shuffle(&mut folders);
        let open = |folder: PathBuf| {
            let saved = Saved::read(&folder.join(CHECKPOINT)).expect("a finished shard is kept");
            (folder, saved)
        };
        let shards: Vec<_> = folders.into_iter().map(open).collect();
        check_set(&shards).expect("the shards are complete");
        merge(self.plan, &self.reduction, shards).expect("the shards have finished")
    }

    /// Keeps the state of some positions in the middle of a shard, as a run does that is killed later.
    fn begin(&self, random: &mut Random, checkpoint: &mut Checkpoint) {
        let range = checkpoint.saved().shard().range(self.plan.designs());
        let length = (range.end - range.start) as usize;
        let first = range.start + random.below(length + 1) as u64;
        let last = first + random.below((range.end - first) as usize + 1) as u64;
        let mut reducers = self.reduction.start();
        CpuEngine::new(self.plan, &self.tables).screen(first..last, |block| self.reduction.absorb(&mut reducers, block));
        checkpoint.save(&Ranges::of(first..last), &reducers.state()).expect("a part can be kept");
    }

    /// What is written of a state, if the reference agrees.
    pub fn certified(&self, state: State) -> beltspace::error::Result<Certified<'_>> {
        Certified::certify(self.plan, state, self.tally.clone(), 1, &Control::default())
    }

    /// Certifies and writes a result; returns its files.
    pub fn write(&self, state: State, threads: usize, folder: &Path) -> Files {
        self.try_write(state, threads, folder).expect("the reference agrees, and a result can be written")
    }

    /// The same where the reference may disagree.
    pub fn try_write(&self, state: State, threads: usize, folder: &Path) -> beltspace::error::Result<Files> {
        let outcome = Certified::certify(self.plan, state, self.tally.clone(), threads, &Control::default())?;
        let record = RunRecord {
            engine: "cpu",
            threads,
            designs: self.plan.designs(),
            scenarios: self.plan.scenarios(),
            time: Duration::from_millis(1),
            origin: "a test".to_owned(),
            certified: outcome.certified(),
            device: None,
            method: MethodRecord { name: "exhaustive", why: "a test".to_owned(), certificate: None, left: None },
        };
        let claim = Claim::new(folder, "a test").expect("nobody has it");
        let (study, designs) = (&self.plan.study, self.plan.designs());
        let checkpoint = Checkpoint::create(&claim, study, self.text, Shard::WHOLE, designs).expect("a folder can be made");
        outcome.write(checkpoint, self.text, &record, &Control::default())?;
        Ok(files(folder))
    }
}

/// How to run, with chunks so short that there are many.
pub fn options(random: &mut Random, tile: u64) -> Settings {
    let chunk = Duration::from_micros(random.pick(&[0, 10, 1000]));
    Settings { threads: random.whole(1, 3), tile, chunk, ..Settings::default() }
}

fn files(folder: &Path) -> Files {
    let read = |entry: std::io::Result<std::fs::DirEntry>| {
        let path = entry.expect("it can be listed").path();
        let name = path.file_name().expect("a file has a name").to_string_lossy().into_owned();
        (name, std::fs::read(path).expect("it can be read"))
    };
    std::fs::read_dir(folder).expect("there is a result").map(read).filter(|(name, _)| name != "run.json").collect()
}

/// The first file in which two results differ.
pub fn differing_file(a: &Files, b: &Files) -> Option<String> {
    let names = a.keys().chain(b.keys());
    names.filter(|name| a.get(*name) != b.get(*name)).map(Clone::clone).next()
}
