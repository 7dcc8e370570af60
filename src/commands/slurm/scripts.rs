//! The scripts. The lines that differ between the schedulers stand side by side.

use super::Scheduler;
use crate::terminal::counted;
use std::fmt::Write as _;

/// The contents of the scripts. Paths and words are quoted for a shell.
#[derive(Debug)]
pub struct ScriptContents {
    pub scheduler: Scheduler,
    /// Title of the study.
    pub title: String,
    /// Name of the study file without its extension.
    pub name: String,
    pub program: String,
    pub study: String,
    pub out: String,
    pub jobs: String,
    pub shards: u64,
    pub cpus: u16,
    /// Memory in megabytes of a shard's job, and of the merge.
    pub memory: [u64; 2],
    /// Time limits of both.
    pub time: [String; 2],
    /// Options of the scheduler that the user asks for.
    pub options: Vec<String>,
    /// Options of the sweep that the user asks for.
    pub sweep: Vec<String>,
    /// Should the result have a page?
    pub page: bool,
}

/// Name of the job script of all shards.
pub const SHARDS: &str = "shards.sh";
/// Name of the job script that merges them.
pub const MERGE: &str = "merge.sh";
/// Name of the script that submits both.
pub const SUBMIT: &str = "submit.sh";

/// Beginning of the second line of each script, by which beltspace recognises its own scripts.
pub const FIRST_LINES: [(&str, &str); 3] =
    [(SHARDS, "# Judges a shard of \""), (MERGE, "# Puts the shards of \""), (SUBMIT, "# Submits the shards of \"")];

/// Folder of a shard, in that of the jobs. The number of shards is part of its name, so that another number begins anew.
pub fn folder(number: &str, shards: u64) -> String {
    format!("shard-{number}-of-{shards}")
}

impl ScriptContents {
    /// Every script with its name, the one to submit last.
    pub fn scripts(&self) -> [(&'static str, String); 3] {
        [(SHARDS, self.shards()), (MERGE, self.merge()), (SUBMIT, self.submit())]
    }

    fn shards(&self) -> String {
        let Self { jobs, program, study, shards, .. } = self;
        let variable = match self.scheduler {
            Scheduler::Slurm => "SLURM_ARRAY_TASK_ID",
            Scheduler::Pbs => "PBS_ARRAY_INDEX",
        };
        // PBS makes no array of a single job, and gives it no number.
        let number = if *shards == 1 { "-1" } else { ":?is not set: submit with submit.sh, or set it to the number of a shard" };
        let mut script = self.head(
            &format!(
                "# Judges a shard of \"{}\". What was interrupted goes on from its checkpoint, what is finished costs nothing.",
                self.title
            ),
            0,
        );
        let folder = folder("$k", *shards);
        let _ = write!(
            script,
            "k=${{{variable}{number}}}\njobs={jobs}\nexec {program} sweep {study} --shard \"$k/{shards}\" --out \"$jobs/{folder}\" \
             --resume --quiet --threads {}",
            self.threads()
        );
        for word in &self.sweep {
            let _ = write!(script, " {word}");
        }
        script.push('\n');
        script
    }

    fn merge(&self) -> String {
        let Self { jobs, program, out, shards, .. } = self;
        let mut script = self.head(&format!("# Puts the shards of \"{}\" together: the same files as one run.", self.title), 1);
        let folder = folder("$k", *shards);
        let page = if self.page { "" } else { " --no-report" };
        let _ = write!(
            script,
            "jobs={jobs}\nshards=()\nfor ((k = 1; k <= {shards}; k++)); do shards+=(\"$jobs/{folder}\"); done\n\
             # --force: what an interrupted merge left is its own.\n\
             exec {program} merge \"${{shards[@]}}\" --out {out} --force --threads {}{page}\n",
            self.threads()
        );
        script
    }

    fn submit(&self) -> String {
        let Self { jobs, shards, .. } = self;
        let (array, merge) = match self.scheduler {
            Scheduler::Slurm => (
                format!("sbatch --parsable {SHARDS}"),
                // If a shard fails, the merge is cancelled rather than left waiting.
                format!("sbatch --parsable --dependency=\"afterok:$array\" --kill-on-invalid-dep=yes {MERGE}"),
            ),
            Scheduler::Pbs => (format!("qsub {SHARDS}"), format!("qsub -W depend=\"afterok:$array\" {MERGE}")),
        };
        // With several clusters Slurm prints the cluster's name after the number.
        let number = |name: &str| match self.scheduler {
            Scheduler::Slurm => format!("{name}=${{{name}%%;*}}\n"),
            Scheduler::Pbs => String::new(),
        };
        let (array_number, merge_number) = (number("array"), number("merge"));
        let what = counted(*shards, "shard");
        format!(
            "#!/bin/bash\n# Submits the shards of \"{}\", and the job that puts them together once all of them have succeeded.\n\
             # After a failure submit again: finished shards cost nothing, the others go on from their checkpoints.\n\
             set -euo pipefail\ncd -- {jobs}\nmkdir -p logs\narray=$({array})\n{array_number}\
             merge=$({merge})\n{merge_number}echo \"{what}: job $array, then the merge: job $merge; logs in $PWD/logs\"\n",
            self.title
        )
    }

    /// The head of a job script: a comment on what it does, and the options for the scheduler. `which` job: 0, a shard; 1, the merge.
    fn head(&self, what: &str, which: usize) -> String {
        let kind = ["shards", "merge"][which];
        let (cpus, memory, time) = (self.cpus, self.memory[which], &self.time[which]);
        let log = |number: &str| if which == 0 { format!("logs/shard-{number}.txt") } else { "logs/merge.txt".to_owned() };
        let mut lines = Vec::new();
        match self.scheduler {
            Scheduler::Slurm => {
                lines.push(format!("--job-name={}-{kind}", self.name));
                if which == 0 {
                    lines.push(format!("--array=1-{}", self.shards));
                }
                lines.extend([
                    "--nodes=1".to_owned(),
                    "--ntasks=1".to_owned(),
                    format!("--cpus-per-task={cpus}"),
                    format!("--mem={memory}M"),
                    format!("--time={time}"),
                    format!("--output={}", log("%a")),
                    "--open-mode=append".to_owned(),
                    "--requeue".to_owned(),
                ]);
            }
            Scheduler::Pbs => {
                // Some versions accept names of at most 15 characters.
                let short: String = self.name.chars().take(14 - kind.len()).collect();
                lines.push(format!("-N {short}-{kind}"));
                if which == 0 && self.shards > 1 {
                    lines.push(format!("-J 1-{}", self.shards));
                }
                lines.extend([
                    "-S /bin/bash".to_owned(),
                    format!("-l select=1:ncpus={cpus}:mem={memory}mb"),
                    format!("-l walltime={time}"),
                    "-j oe".to_owned(),
                    format!("-o {}", log(if self.shards > 1 { "^array_index^" } else { "1" })),
                    "-r y".to_owned(),
                ]);
            }
        }
        lines.extend(self.options.iter().cloned());
        let mark = match self.scheduler {
            Scheduler::Slurm => "#SBATCH",
            Scheduler::Pbs => "#PBS",
        };
        let mut text = format!("#!/bin/bash\n{what}\n");
        for line in lines {
            let _ = writeln!(text, "{mark} {line}");
        }
        text.push_str("\nset -euo pipefail\n");
        text
    }

    /// The number of CPUs that the job was given, if the scheduler says so.
    fn threads(&self) -> String {
        let variable = match self.scheduler {
            Scheduler::Slurm => "SLURM_CPUS_PER_TASK",
            Scheduler::Pbs => "NCPUS",
        };
        format!("\"${{{variable}:-{}}}\"", self.cpus)
    }
}
