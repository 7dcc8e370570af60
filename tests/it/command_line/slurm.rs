//! `slurm`: the scripts that it writes, run in order by an imitation of the scheduler. For a real Slurm see `real`.

/// A real Slurm.
mod real;

use super::{Answer, Files, SMALL, ask, ask_words, changed, files, folder_with, json_of, read, same_result, write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Records its arguments and runs the script at once: as an array if it is one, and not at all if a job that it depends on has failed.
const SCHEDULER: &str = r#"#!/bin/bash
set -eu
printf '%s\n' "$*" >> "$FAKE/asked"
job=$(($(ls "$FAKE/jobs" | wc -l) + 1))
script=${!#}
case $0 in
*sbatch)
  array=$(sed -n 's/^#SBATCH --array=1-//p' "$script")
  log=$(sed -n 's/^#SBATCH --output=//p' "$script")
  variable=SLURM_ARRAY_TASK_ID
  before=$(sed -n 's/.*--dependency=afterok:\([0-9]*\).*/\1/p' <<< "$*")
  number="$job;cluster"
  ;;
*qsub)
  array=$(sed -n 's/^#PBS -J 1-//p' "$script")
  log=$(sed -n 's/^#PBS -o //p' "$script")
  variable=PBS_ARRAY_INDEX
  before=$(sed -n 's/.*depend=afterok:\([0-9]*\).*/\1/p' <<< "$*")
  number="$job[].server"
  ;;
esac
state=ok
[ -z "$before" ] || state=$(cat "$FAKE/jobs/$before")
if [ "$state" = ok ]; then
  if [ -n "$array" ]; then
    for k in $(seq "$array"); do
      file=${log/\%a/$k}
      env "$variable=$k" bash "$script" >> "${file/^array_index^/$k}" 2>&1 || state=failed
    done
  else
    bash "$script" >> "$log" 2>&1 || state=failed
  fi
fi
echo "$state" > "$FAKE/jobs/$job"
echo "$number"
"#;

/// A folder with programs that imitate those of a scheduler.
struct Cluster(TempDir);

impl Cluster {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("there is room");
        std::fs::create_dir(folder.path().join("jobs")).expect("it can be made");
        for name in ["sbatch", "qsub"] {
            write(folder.path(), name, SCHEDULER);
            std::fs::set_permissions(folder.path().join(name), PermissionsExt::from_mode(0o755)).expect("it is ours");
        }
        Self(folder)
    }

    /// Runs a script of that name, with the imitations first in the PATH.
    fn bash(&self, script: &Path) -> Answer {
        let path = std::env::var_os("PATH").unwrap_or_default();
        let path = [self.0.path().to_owned()].into_iter().chain(std::env::split_paths(&path));
        let path = std::env::join_paths(path).expect("no separator in it");
        let mut command = Command::new("bash");
        command.arg(script).current_dir("/").env("PATH", path).env("FAKE", self.0.path());
        command.output().expect("bash runs").into()
    }

    /// The words of all requests.
    fn asked(&self) -> Vec<String> {
        read(&self.0.path().join("asked")).lines().map(str::to_owned).collect()
    }
}

/// A study in a folder whose name a shell does not read as one word, with a table beside it.
struct Place {
    _folder: TempDir,
    /// Folder of the study.
    path: PathBuf,
}

impl Place {
    fn new(study: &str) -> Self {
        let folder = tempfile::tempdir().expect("there is room");
        let path = folder.path().join("it's a \"$HOME\" of its own");
        std::fs::create_dir(&path).expect("it can be made");
        write(&path, "my study.toml", study);
        write(&path, "loads.csv", "ratio,torque_Nm\n0.5,50\n1,150\n2,150\n");
        Self { _folder: folder, path }
    }

    fn of_a_table(histogram: &str) -> Self {
        let operation = "ratio     = { from = 0.5, to = 2.0, count = 3, spacing = \"log\" }\ntorque_Nm = [50, 150]";
        let edits =
            [(operation, "cases = { csv = \"loads.csv\" }"), ("bins = 40", histogram), ("\"Small\"", r#""It is \"small\"\tand `quick`""#)];
        Self::new(&changed(SMALL, &edits))
    }

    fn ask(&self, line: &str) -> Answer {
        let words: Vec<&str> = ["slurm", "my study.toml"].into_iter().chain(line.split_whitespace()).collect();
        ask_words(&self.path, &words)
    }

    fn plain(&self) -> Files {
        ask_words(&self.path, &["sweep", "my study.toml", "--out", "plain"]).text();
        files(&self.path.join("plain"))
    }

    fn script(&self, name: &str) -> String {
        let path = self.path.join("results/my study-jobs").join(name);
        let checked: Answer = Command::new("bash").arg("-n").arg(&path).output().expect("bash runs").into();
        assert_eq!((checked.code, checked.err.as_str()), (Some(0), ""), "{name}");
        read(&path)
    }
}

#[test]
fn the_jobs_give_the_files_of_one_run() {
    for (flavour, histogram) in [("", "bins = 40"), ("--pbs", "from = 0, to = 60000, bins = 40")] {
        let place = Place::of_a_table(histogram);
        let cluster = Cluster::new();
        let edited = ["sweep", "my study.toml", "--out", "plain", "--set", "strength_MPa=900"];
        ask_words(&place.path, &edited).text();
        let plain = files(&place.path.join("plain"));
        let printed = place.ask(&format!("--shards 3 --shortest 0 --cpus 2 {flavour} -- --engine cpu --set strength_MPa=900")).text();
        // The jobs need neither the study file nor its table.
        for name in ["my study.toml", "loads.csv"] {
            std::fs::remove_file(place.path.join(name)).expect("it is there");
        }
        let jobs = place.path.join("results/my study-jobs");
        let submit = jobs.join("submit.sh");
        let quoted = submit.display().to_string().replace('\'', r"'\''");
        assert!(printed.ends_with(&format!("\nsubmit with: bash '{quoted}'\n")), "{printed}");
        let said = cluster.bash(&submit).text();
        let logs = jobs.join("logs");
        let (first, second) = if flavour.is_empty() { ("1", "2") } else { ("1[].server", "2[].server") };
        assert_eq!(said, format!("3 shards: job {first}, then the merge: job {second}; logs in {}\n", logs.display()));
        let asked = cluster.asked();
        let expected = if flavour.is_empty() {
            ["--parsable shards.sh", "--parsable --dependency=afterok:1 --kill-on-invalid-dep=yes merge.sh"]
        } else {
            ["shards.sh", "-W depend=afterok:1[].server merge.sh"]
        };
        assert_eq!(asked, expected);
        let log = || read(&logs.join("merge.txt"));
        assert_eq!(same_result(&plain, &files(&place.path.join("results/my study"))), Ok(()), "{flavour}: {}", log());
        assert!(log().contains("front"), "the log shows the summary: {}", log());
        for number in 1..=3 {
            assert_eq!(read(&logs.join(format!("shard-{number}.txt"))), "", "{flavour}: shard {number} is quiet");
        }
        // Once more: nothing is judged, the result is the same.
        let manifest = jobs.join("shard-2-of-3/checkpoint/manifest.json");
        let before = read(&manifest);
        cluster.bash(&submit).text();
        assert_eq!(read(&manifest), before, "a finished shard is left as it is");
        assert_eq!(same_result(&plain, &files(&place.path.join("results/my study"))), Ok(()), "{flavour}: {}", log());
    }
}

#[test]
fn a_resolved_study_needs_no_other_file() {
    let place = Place::of_a_table("bins = 40");
    let plain = place.plain();
    for name in ["my study.toml", "loads.csv"] {
        std::fs::remove_file(place.path.join(name)).expect("it is there");
    }
    let resolved = "plain/study.json";
    ask_words(&place.path, &["sweep", resolved, "--out", "again"]).text();
    assert_eq!(same_result(&plain, &files(&place.path.join("again"))), Ok(()));
    let refused = |words: &[&str]| ask_words(&place.path, words).refusal(2);
    let said = refused(&["check", resolved, "--set", "torque_Nm=90"]);
    assert!(said.contains("plain/study.json: this study is resolved") && said.contains("take the study file"), "{said}");
    write(&place.path, "other.json", "{ \"model\": \"metal-cvt\" }");
    let said = refused(&["check", "other.json"]);
    assert!(said.contains("other.json: it is no resolved study"), "{said}");
    std::fs::remove_file(place.path.join("plain/study.toml")).expect("it is there");
    let said = refused(&["check", resolved]);
    assert!(said.contains("its text, study.toml, belongs beside it"), "{said}");
}

#[test]
fn a_folder_of_the_user_where_the_study_of_the_jobs_belongs_stays() {
    let place = Place::of_a_table("bins = 40");
    let folder = place.path.join("study");
    std::fs::create_dir(&folder).expect("it can be made");
    let ask = || place.ask("--shards 2 --shortest 0 --jobs . --quiet");
    for (name, text) in [("notes.txt", "mine"), ("study.toml", "model = \"metal-cvt\""), ("study.json", "{}")] {
        write(&folder, name, text);
        let said = ask().refusal(2);
        assert!(said.contains(&format!("study/{name}")) && said.contains("--jobs"), "{said}");
        assert_eq!((read(&folder.join(name)).as_str(), place.path.join("submit.sh").exists()), (text, false));
        std::fs::remove_file(folder.join(name)).expect("it is there");
    }
    ask().text();
    // Of a study that is there nobody knows whose it is, even where no script is.
    for name in ["submit.sh", "shards.sh", "merge.sh"] {
        std::fs::remove_file(place.path.join(name)).expect("it is there");
    }
    let before = read(&folder.join("study.toml"));
    let said = place.ask("--shards 2 --shortest 0 --jobs . --quiet -- --set strength_MPa=900").refusal(2);
    assert!(said.contains("has a study already; replace it with --force"), "{said}");
    assert_eq!(read(&folder.join("study.toml")), before);
    place.ask("--shards 2 --shortest 0 --jobs . --quiet --force").text();
    assert!(read(&folder.join("study.json")).contains("metal-cvt"));
}

#[test]
fn after_a_failed_shard_there_is_no_merge_and_another_submission_goes_on() {
    let place = Place::new(SMALL);
    let cluster = Cluster::new();
    place.ask("--shards 3 --shortest 0").text();
    let jobs = place.path.join("results/my study-jobs");
    let in_the_way = jobs.join("shard-2-of-3");
    std::fs::write(&in_the_way, "").expect("it can be written");
    cluster.bash(&jobs.join("submit.sh")).text();
    let log = read(&jobs.join("logs/shard-2.txt"));
    assert!(log.contains("shard-2-of-3 is a file; name a directory with --out"), "{log}");
    assert!(!place.path.join("results/my study").exists() && !jobs.join("logs/merge.txt").exists(), "nothing is merged");
    std::fs::remove_file(&in_the_way).expect("it is there");
    let first = jobs.join("shard-1-of-3/checkpoint/manifest.json");
    let before = read(&first);
    cluster.bash(&jobs.join("submit.sh")).text();
    assert_eq!(read(&first), before, "what is finished is left as it is");
    assert_eq!(same_result(&place.plain(), &files(&place.path.join("results/my study"))), Ok(()));
}

#[test]
fn the_scripts_ask_for_what_the_user_asks_for() {
    let place = Place::new(SMALL);
    let line = "--shards 4 --shortest 0 --cpus 8 --memory 3000 --time 2:00:00 --option=--partition=long --program beltspace";
    let printed = place.ask(&format!("{line} -- --engine gpu --adapter a'b --no-report")).text();
    for fact in ["shards    4, about ", " each on 8 CPUs, measured over a moment", "8 CPUs, 3000 MB, at most 02:00:00 each; the merge"] {
        assert!(printed.contains(fact), "{fact}: {printed}");
    }
    let head = "#SBATCH --nodes=1\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=8\n#SBATCH --mem=3000M\n#SBATCH --time=02:00:00\n";
    let foot = "#SBATCH --open-mode=append\n#SBATCH --requeue\n#SBATCH --partition=long\n\nset -euo pipefail\n";
    let shards = place.script("shards.sh");
    assert!(
        shards.contains(&format!(
            "#SBATCH --job-name=my-study-shards\n#SBATCH --array=1-4\n{head}#SBATCH --output=logs/shard-%a.txt\n{foot}"
        ))
    );
    let study = place.path.join("my study.toml").display().to_string().replace('\'', r"'\''");
    let run = format!(
        "exec beltspace sweep '{study}' --shard \"$k/4\" --out \"$jobs/shard-$k-of-4\" --resume --quiet \
         --threads \"${{SLURM_CPUS_PER_TASK:-8}}\" --engine gpu --adapter 'a'\\''b' --no-report\n"
    );
    assert!(shards.ends_with(&run), "{shards}{run}");
    let merge = place.script("merge.sh");
    assert!(merge.contains(&format!("#SBATCH --job-name=my-study-merge\n{head}#SBATCH --output=logs/merge.txt\n{foot}")), "{merge}");
    assert!(merge.contains("exec beltspace merge ") && merge.ends_with(" --no-report\n"), "{merge}");
    assert!(place.script("submit.sh").starts_with("#!/bin/bash\n"));

    let printed = place.ask(&format!("--pbs --force {}", line.replace("=--partition=long", "=-qlong"))).text();
    assert!(printed.contains("/results/my study-jobs\n"), "{printed}");
    let head = "#PBS -S /bin/bash\n#PBS -l select=1:ncpus=8:mem=3000mb\n#PBS -l walltime=02:00:00\n#PBS -j oe\n#PBS -o logs/";
    let foot = "#PBS -r y\n#PBS -qlong\n\nset -euo pipefail\n";
    let shards = place.script("shards.sh");
    assert!(
        shards.contains(&format!("#PBS -N my-study-shards\n#PBS -J 1-4\n{head}shard-^array_index^.txt\n{foot}k=${{PBS_ARRAY_INDEX:?")),
        "{shards}"
    );
    assert!(shards.ends_with("--threads \"${NCPUS:-8}\"\n"), "{shards}");
    let merge = place.script("merge.sh");
    assert!(merge.contains(&format!("#PBS -N my-study-merge\n{head}merge.txt\n{foot}")), "{merge}");
    // PBS makes no array of one job.
    place.ask("--pbs --force").text();
    let shards = place.script("shards.sh");
    assert!(!shards.contains("#PBS -J") && shards.contains("k=${PBS_ARRAY_INDEX-1}\n") && shards.contains("logs/shard-1.txt"), "{shards}");
}

/// Days on any machine, and more shards than an array has.
fn endless() -> String {
    let finer = [
        ("to = 30, count = 13", "to = 30, count = 1009"),
        ("to = 0.30, count = 21", "to = 0.30, count = 1009"),
        ("to = 0.50, count = 5", "to = 0.50, count = 99999989"),
    ];
    changed(SMALL, &finer)
}

#[test]
fn a_shard_takes_minutes_and_not_seconds() {
    let place = Place::new(SMALL);
    let answer = place.ask("");
    assert!(
        answer.err.starts_with("note: a single job would take about ")
            && answer.err.contains("`beltspace sweep` on this machine is enough"),
        "{}",
        answer.err
    );
    assert!(answer.text().contains("\nshards    1, about "));
    let answer = place.ask("--shards 40 --force");
    let (short, long) = answer.err.split_once(" each; 1 shard of about ").unwrap_or_else(|| panic!("{}", answer.err));
    assert!(
        short.starts_with("warning: 40 shards would take about ") && long.ends_with(" written instead (--shortest 0 keeps 40)\n"),
        "{}",
        answer.err
    );
    assert!(place.script("shards.sh").contains("#SBATCH --array=1-1\n"));
    // Bounds are faster than judging every design, and every shard would repeat their search. So many designs that three take minutes each.
    let fine = include_str!("../../../studies/metal-grid.toml").replace("count = 37", "count = 3000");
    let place = Place::new(&fine);
    let answer = place.ask("");
    assert!(answer.err.starts_with("note: bounds settle boxes of designs at once") && answer.err.contains("one job is written"));
    assert!(answer.text().contains("\nshards    1, by bounds; every design would take about "));
    let answer = place.ask("--force --shards 3");
    assert!(answer.err.contains("every shard searches for the whole front"), "{}", answer.err);
    let text = answer.text();
    assert!(text.contains("\nshards    3, by bounds; every design would take about "), "{text}");
    let answer = place.ask("--force -- --method exhaustive");
    assert!(!answer.err.contains("bounds") && !answer.text().contains("bounds"));
    let place = Place::new(&endless());
    assert!(place.ask("").text().contains("\nshards    1000, about "));
    assert!(place.ask("--force --pbs").text().contains("\nshards    10 000, about "));
    let printed = place.ask("--force --array-limit 70 --quiet");
    assert_eq!((printed.out.as_str(), printed.err.as_str(), printed.code), ("", "", Some(0)));
    assert!(place.script("shards.sh").contains("#SBATCH --array=1-70\n"));
    assert!(place.ask("--force --shards 2000 --array-limit 4000").text().contains("\nshards    2000, about "));
}

#[test]
fn what_cannot_be_is_refused_and_writes_nothing() {
    let folder = folder_with("small.toml", SMALL);
    write(folder.path(), "endless.toml", &endless());
    write(folder.path(), "file", "");
    let refused = "options for the sweep: ";
    for (line, message) in [
        ("missing.toml", "cannot read study missing.toml: "),
        (
            "small.toml --shards 12286 --shortest 0",
            "--shards 12286: the study has 12285 designs, and a shard needs one; ask for at most 12285",
        ),
        (
            "endless.toml --shards 1001",
            "--shards 1001: Slurm usually accepts 1000 jobs in one array (MaxArraySize of scontrol show config, less one); ask for",
        ),
        (
            "endless.toml --shards 10001 --pbs",
            "PBS usually accepts 10000 jobs in one array (max_array_size of qstat -Bf); ask for at most 10000, or say",
        ),
        ("small.toml --time 90", "--time 90: a time limit is HH:MM:SS, such as 02:30:00"),
        ("small.toml --option long", "--option \"long\": an option for the scheduler is one line that begins with a dash"),
        ("small.toml --out file", "/file is a file; name a directory with --out"),
        ("small.toml --jobs file", "/file is a file; name a directory with --jobs"),
        ("small.toml -- --threads 4", refused),
        ("small.toml -- --force", refused),
        (
            "small.toml -- --engine abacus",
            "options for the sweep: invalid value 'abacus' for '--engine <ENGINE>'; after -- give options of `beltspace sweep`",
        ),
        ("small.toml -- other.toml", refused),
        ("small.toml -- --help", refused),
        ("small.toml -- --method bounds --engine gpu", "--method bounds judges on the CPU, but --engine gpu was asked for"),
    ] {
        let err = ask(folder.path(), &format!("slurm {line}")).refusal(2);
        assert!(err.contains(message), "{line}: {err}");
    }
    let option = ask_words(folder.path(), &["slurm", "small.toml", "--option", "-q long\nrm"]).refusal(2);
    assert!(option.contains(r#"--option "-q long\nrm": "#), "{option}");
    assert!(!folder.path().join("results").exists(), "a wrong request has left something");
}

#[test]
fn scripts_results_and_shards_of_another_study_stay() {
    let folder = folder_with("small.toml", SMALL);
    let cluster = Cluster::new();
    let ask = |line: &str| ask(folder.path(), line);
    ask("slurm small.toml --shards 2 --shortest 0").text();
    let err = ask("slurm small.toml").refusal(2);
    assert!(err.contains("small-jobs has a shards.sh; replace it with --force, or write to another directory with --jobs"), "{err}");
    cluster.bash(&folder.path().join("results/small-jobs/submit.sh")).text();
    let err = ask("slurm small.toml --jobs other").refusal(2);
    assert!(err.contains("results/small holds a finished result; replace it with --force, or write to another --out"), "{err}");
    // Shards of the same study are kept; those of another study are not continued.
    let state = |number: u32| json_of(&folder.path().join(format!("results/small-jobs/shard-{number}-of-2/checkpoint/manifest.json")));
    let before = state(1);
    ask("slurm small.toml --shards 2 --shortest 0 --force --cpus 2").text();
    assert_eq!(state(1), before);
    write(folder.path(), "small.toml", &changed(SMALL, &[("strength_MPa = 800", "strength_MPa = 900")]));
    let err = ask("slurm small.toml --shards 2 --shortest 0 --force").refusal(2);
    assert!(err.contains("shard-1-of-2 is of another study (") && err.contains("remove the directory of the jobs"), "{err}");
    write(&folder.path().join("results/small-jobs/shard-1-of-2/checkpoint"), "manifest.json", "{}");
    let err = ask("slurm small.toml --shards 2 --shortest 0 --force").refusal(2);
    assert!(err.contains("the manifest is damaged (") && err.contains("unless a job is at work there, remove "), "{err}");
    ask("slurm small.toml --shards 3 --shortest 0 --force").text();
    cluster.bash(&folder.path().join("results/small-jobs/submit.sh")).text();
    assert!(read(&folder.path().join("results/small/study.toml")).contains("strength_MPa = 900"), "--force replaces the result too");
}
