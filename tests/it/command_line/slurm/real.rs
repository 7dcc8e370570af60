//! The scripts under a real Slurm on this machine: one node, started for the test and stopped after it. The test runs where it is asked
//! for, as in the full stage of the checks, and a missing Slurm is a failure.

use super::Place;
use crate::command_line::{files, json_of, larger, read, same_result};
use std::fmt::Write as _;
use std::io::Read as _;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Longest time that anything here may take before the test gives up.
const PATIENCE: Duration = Duration::from_secs(180);

/// A Slurm cluster of one node with two CPUs, and what it needs: munge, ports, folders.
struct Slurm {
    folder: TempDir,
    daemons: Vec<Child>,
}

impl Slurm {
    fn start() -> Self {
        let folder = tempfile::tempdir().expect("there is room");
        let mut slurm = Self { folder, daemons: Vec::new() };
        let path = |name: &str| slurm.folder.path().join(name);
        let shown = |name: &str| path(name).display().to_string();
        for name in ["state", "spool"] {
            std::fs::create_dir(path(name)).expect("it can be made");
        }
        let mut key = [0; 128];
        std::fs::File::open("/dev/urandom").and_then(|mut it| it.read_exact(&mut key)).expect("there are random numbers");
        std::fs::write(path("munge.key"), key).expect("it can be written");
        let private = <std::fs::Permissions as std::os::unix::fs::PermissionsExt>::from_mode(0o400);
        std::fs::set_permissions(path("munge.key"), private).expect("it is ours");
        // Held together until both are known, so that they differ.
        let listeners = [0, 1].map(|_| TcpListener::bind("127.0.0.1:0").expect("there are free ports"));
        let ports = listeners.each_ref().map(|it| it.local_addr().expect("it is bound").port());
        drop(listeners);
        let name = read(Path::new("/proc/sys/kernel/hostname"));
        let name = name.trim().split('.').next().unwrap_or_default().to_owned();
        let user = Command::new("id").arg("-un").output().expect("it runs").stdout;
        let user = String::from_utf8_lossy(&user).trim().to_owned();
        let configuration = [
            "ClusterName=beltspace".to_owned(),
            format!("SlurmctldHost={name}(127.0.0.1)\nSlurmctldPort={}\nSlurmdPort={}", ports[0], ports[1]),
            format!("SlurmUser={user}\nSlurmdUser={user}"),
            // A requeued job starts again as soon as its old credential has expired.
            format!("AuthType=auth/munge\nAuthInfo=cred_expire=5,socket={}", shown("munge.socket")),
            format!("StateSaveLocation={}\nSlurmdSpoolDir={}", shown("state"), shown("spool")),
            format!("SlurmctldPidFile={}\nSlurmdPidFile={}", shown("slurmctld.pid"), shown("slurmd.pid")),
            "ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nJobAcctGatherType=jobacct_gather/none".to_owned(),
            "SelectType=select/cons_tres\nSelectTypeParameters=CR_CPU_Memory\nReturnToService=2\nKillWait=2".to_owned(),
            "SchedulerParameters=sched_interval=1,batch_sched_delay=0,bf_interval=1".to_owned(),
            format!("NodeName={name} NodeAddr=127.0.0.1 CPUs=2 RealMemory=1500 State=UNKNOWN"),
            format!("PartitionName=all Nodes={name} Default=YES MaxTime=INFINITE State=UP\n"),
        ];
        std::fs::write(path("slurm.conf"), configuration.join("\n")).expect("it can be written");
        let (socket, key, seed) = (shown("munge.socket"), shown("munge.key"), shown("munge.seed"));
        let (pid, log) = (shown("munged.pid"), shown("munged-itself.log"));
        let munged = [
            "--foreground",
            "--force",
            "--socket",
            &socket,
            "--key-file",
            &key,
            "--pid-file",
            &pid,
            "--seed-file",
            &seed,
            "--log-file",
            &log,
        ];
        slurm.daemon("munged", &munged);
        slurm.wait("munge listens", |it| it.folder.path().join("munge.socket").exists());
        slurm.daemon("slurmctld", &["-D", "-i"]);
        slurm.daemon("slurmd", &["-D"]);
        slurm.wait("the node is idle", |it| it.try_ask("sinfo", &["--noheader", "--format=%T"]).is_ok_and(|state| state.trim() == "idle"));
        slurm
    }

    /// Starts a daemon in the foreground, its words in a log.
    fn daemon(&mut self, program: &str, words: &[&str]) {
        let log = std::fs::File::create(self.log(program)).expect("it can be written");
        let mut command = Command::new(program);
        command.args(words).env("SLURM_CONF", self.configuration()).stdin(Stdio::null());
        let child = command.stdout(log.try_clone().expect("it is open")).stderr(log).spawn();
        self.daemons.push(child.unwrap_or_else(|error| panic!("{program} does not start (Debian packages slurm-wlm and munge): {error}")));
    }

    fn configuration(&self) -> PathBuf {
        self.folder.path().join("slurm.conf")
    }

    fn log(&self, program: &str) -> PathBuf {
        self.folder.path().join(format!("{program}.log"))
    }

    fn try_ask(&self, program: &str, words: &[&str]) -> Result<String, String> {
        let output = Command::new(program).args(words).env("SLURM_CONF", self.configuration()).current_dir("/").output();
        let output = output.map_err(|error| format!("{program}: {error}"))?;
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        if output.status.success() { Ok(text(&output.stdout)) } else { Err(text(&output.stderr)) }
    }

    /// What a program says that must succeed.
    #[track_caller]
    fn ask(&self, program: &str, words: &[&str]) -> String {
        self.try_ask(program, words).unwrap_or_else(|error| panic!("{program} {words:?}: {error}{}", self.logs()))
    }

    #[track_caller]
    fn wait(&self, what: &str, is_so: impl Fn(&Self) -> bool) {
        let start = Instant::now();
        while !is_so(self) {
            assert!(start.elapsed() < PATIENCE, "never so: {what}\n{}", self.logs());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn wait_until_all_is_done(&self) {
        self.wait("no job is left", |it| it.ask("squeue", &["--noheader"]).is_empty());
    }

    /// The last lines of every log.
    fn logs(&self) -> String {
        let mut text = self.try_ask("squeue", &[]).unwrap_or_default();
        for program in ["munged", "slurmctld", "slurmd"] {
            let log = std::fs::read_to_string(self.log(program)).unwrap_or_default();
            let lines: Vec<&str> = log.lines().collect();
            let _ = writeln!(text, "{program}:\n{}", lines[lines.len().saturating_sub(25)..].join("\n"));
        }
        text
    }

    /// Submits both jobs; their numbers.
    #[track_caller]
    fn submit(&self, place: &Place) -> [String; 2] {
        let said = self.ask("bash", &[&place.jobs().join("submit.sh").display().to_string()]);
        print!("{said}");
        let number = |before: &str| {
            let rest = said.split(before).nth(1).unwrap_or_else(|| panic!("{said}"));
            rest.chars().take_while(char::is_ascii_digit).collect()
        };
        [number("shards: job "), number("merge: job ")]
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        // Jobs are no children of ours: the daemons are asked to end them, and given a while for it.
        for state in ["PENDING", "RUNNING"] {
            let _ = self.try_ask("scancel", &["--state", state]);
        }
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(10) && self.try_ask("squeue", &["--noheader"]).is_ok_and(|jobs| !jobs.is_empty()) {
            std::thread::sleep(Duration::from_millis(50));
        }
        // The last one started first: it still needs the others.
        for daemon in self.daemons.iter_mut().rev() {
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
    }
}

impl Place {
    fn jobs(&self) -> PathBuf {
        self.path.join("results/my study-jobs")
    }

    fn manifest(&self, shard: u32, of: u32) -> PathBuf {
        self.jobs().join(format!("shard-{shard}-of-{of}/checkpoint/manifest.json"))
    }

    /// Has a shard judged some of its designs, and not all?
    fn is_under_way(&self, shard: u32, of: u32) -> bool {
        self.judged(shard, of).is_some_and(|(judged, all)| 0 < judged && judged < all)
    }

    /// Designs that a shard has judged, and how many it has.
    fn judged(&self, shard: u32, of: u32) -> Option<(u64, u64)> {
        let manifest = self.manifest(shard, of);
        let manifest = &manifest.exists().then(|| json_of(&manifest))?["manifest"];
        let range = |it: &serde_json::Value| Some(it["end"].as_u64()? - it["start"].as_u64()?);
        let judged = manifest["done"].as_array()?.iter().filter_map(range).sum();
        let (designs, shard, of) = (manifest["designs"].as_u64()?, u64::from(shard), u64::from(of));
        Some((judged, designs * shard / of - designs * (shard - 1) / of))
    }

    #[track_caller]
    fn assert_is_one_run(&self, slurm: &Slurm) {
        let log =
            std::fs::read_to_string(self.jobs().join("logs/merge.txt")).unwrap_or_else(|error| format!("no log of the merge: {error}"));
        let out = self.path.join("results/my study");
        assert!(out.exists(), "there is no result\n{log}\n{}", slurm.logs());
        assert_eq!(same_result(&self.plain(), &files(&out)), Ok(()), "{log}");
    }
}

#[test]
#[ignore = "starts a Slurm of its own: cargo test --test it -- --ignored slurm::real"]
fn shards_and_their_merge_run_under_slurm() {
    let start = Instant::now();
    let say = |what: &str| println!("{:6.1} s  {what}", start.elapsed().as_secs_f64());
    let slurm = Slurm::start();
    say(slurm.ask("sinfo", &["--version"]).trim());

    let shipped = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/metal-cvt.toml"));
    let place = Place::new(&shipped);
    place.ask("--shards 4 --shortest 0 --memory 500").text();
    slurm.submit(&place);
    slurm.wait_until_all_is_done();
    place.assert_is_one_run(&slurm);
    say("four shards of metal-cvt, merged: the files of one run");

    // A node takes back a job and starts it again; another job is cancelled, so that its array fails.
    let place = Place::new(&larger(161));
    place.ask("--shards 2 --shortest 0 --memory 500").text();
    let [array, merge] = slurm.submit(&place);
    slurm.wait("shard 1 is under way", |_| place.is_under_way(1, 2));
    slurm.ask("scontrol", &["requeue", &format!("{array}_1")]);
    slurm.wait("shard 1 waits again", |it| it.ask("squeue", &["--noheader", "--states=PENDING", "--format=%K"]).contains('1'));
    assert!(place.is_under_way(1, 2), "it was taken back in the midst: {:?}", place.judged(1, 2));
    say(&format!("shard 1 taken back with {:?} designs judged", place.judged(1, 2)));
    slurm.wait("shard 2 is under way", |_| place.is_under_way(2, 2));
    slurm.ask("scancel", &[&format!("{array}_2")]);
    slurm.wait_until_all_is_done();
    let (first, second) = (place.judged(1, 2), place.judged(2, 2));
    say(&format!("shard 1 went on to {first:?}, shard 2 cancelled at {second:?}"));
    assert!(first.is_some_and(|(judged, all)| judged == all), "shard 1 was not finished: {first:?}");
    assert!(place.is_under_way(2, 2), "shard 2 was cancelled in the midst: {second:?}");
    let state = slurm.ask("scontrol", &["show", "job", &merge]);
    assert!(state.contains("JobState=CANCELLED"), "the merge must not run: {state}");
    assert!(!place.path.join("results/my study").exists() && !place.jobs().join("logs/merge.txt").exists(), "something was merged");
    let before = read(&place.manifest(1, 2));
    slurm.submit(&place);
    slurm.wait_until_all_is_done();
    assert_eq!(read(&place.manifest(1, 2)), before, "what is finished is left as it is");
    place.assert_is_one_run(&slurm);
    say("submitted again and merged: the files of one run");
}
