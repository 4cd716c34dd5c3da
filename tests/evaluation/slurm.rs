//! The job files of `examples/slurm`, with a stand-in for `sbatch` that runs the tasks here.

#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::program::{Ran, fishplate, ran};
use tempfile::TempDir;

/// Runs a job as `sbatch` does: the options of the job file and of the command line, a task for
/// each number of the array with the variables that Slurm sets, and the number of the job on
/// standard output. A task that `KILLED` names is killed as soon as it has started.
const SBATCH: &str = r##"#!/bin/sh
array= ; script=
for word in "$@"; do
  case "$word" in
    --array=*) array=${word#--array=} ;;
    --dependency=afterany:*) grep -qx "${word#--dependency=afterany:}" "$JOBS/done" || exit 9 ;;
    --*) ;;
    *) script=$word ;;
  esac
done
job=$(( $(cat "$JOBS/done" 2>/dev/null | wc -l) + 1 ))
first=${array%-*} ; last=${array#*-}
[ -n "$array" ] || { first=0; last=0; }
number=$first
while [ "$number" -le "$last" ]; do
  (
    if [ -n "$array" ]; then
      export SLURM_ARRAY_TASK_ID=$number SLURM_ARRAY_TASK_COUNT=$((last - first + 1)) SLURM_CPUS_PER_TASK=1
    fi
    if [ "${KILLED:-}" = "$number" ] && [ -n "$array" ]; then
      sh "$script" > "$JOBS/$job-$number.out" 2>&1 & task=$!
      kill -9 "$task"; wait "$task"
    else
      sh "$script" > "$JOBS/$job-$number.out" 2>&1
    fi
    echo $? > "$JOBS/$job-$number.code"
  )
  number=$((number + 1))
done
echo "$job" >> "$JOBS/done"
echo "$job"
"##;

struct Cluster(TempDir);

impl Cluster {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let sbatch = folder.path().join("sbatch");
        fs::write(&sbatch, SBATCH).expect("written");
        fs::set_permissions(&sbatch, fs::Permissions::from_mode(0o755)).expect("executable");
        Self(folder)
    }

    fn place(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// A command with the stand-in and the program on the path.
    fn command(&self, words: &[&str]) -> Command {
        let program = Path::new(env!("CARGO_BIN_EXE_fishplate")).parent().expect("a folder");
        let path = format!(
            "{}:{}:{}",
            self.0.path().display(),
            program.display(),
            std::env::var("PATH").unwrap_or_default()
        );
        let mut command = Command::new(words[0]);
        command.args(&words[1..]).env("PATH", path).env("JOBS", self.0.path());
        command
    }

    fn submit(&self, campaign: &str, killed: &str) -> Ran {
        let (values, report) = (
            self.place("values").display().to_string(),
            self.place("report").display().to_string(),
        );
        ran(self
            .command(&["examples/slurm/submit.sh", campaign, &values, &report, "4"])
            .env("KILLED", killed))
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.place(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }
}

fn certified(cluster: &Cluster, campaign: &str) -> PathBuf {
    let whole = cluster.place("whole");
    assert!(fishplate(&["certify", campaign, "--out", &whole.display().to_string()]).code < 2);
    whole
}

#[test]
fn an_array_of_jobs_makes_the_report_of_certify() {
    let cluster = Cluster::new();
    let submitted = cluster.submit("examples/coach-good", "");
    assert_eq!((submitted.code, submitted.stdout.trim()), (0, "2"), "{}", submitted.stderr);
    let whole = certified(&cluster, "examples/coach-good");
    for name in ["results.json", "report.pdf", "report.html", "statement.json"] {
        let read = |folder: &Path| fs::read(folder.join(name)).expect("written");
        assert!(
            read(&whole) == read(&cluster.place("report")),
            "{name}: {}",
            cluster.text("2-0.out")
        );
    }
    assert_eq!(cluster.text("2-0.code").trim(), "0");
}

/// A task that is killed leaves no file; the report says what is missing. Repeated alone, it gives
/// the same report.
#[test]
fn a_task_that_is_killed_is_told_and_repeated() {
    let cluster = Cluster::new();
    cluster.submit("examples/coach-good", "2");
    assert_eq!(cluster.text("1-2.code").trim(), "137");
    assert!(!cluster.place("values/values-2.parquet").exists());
    assert_eq!(cluster.text("2-0.code").trim(), "1");
    let says = "values of 3 of 13 sections are missing: S09, S10, S11";
    assert!(cluster.text("2-0.out").contains(says), "{}", cluster.text("2-0.out"));

    let (values, report) = (cluster.place("values"), cluster.place("report"));
    let again = |words: &[&str]| {
        let mut command = cluster.command(words);
        let ran = ran(command
            .env("CAMPAIGN", "examples/coach-good")
            .env("VALUES", &values)
            .env("REPORT", &report)
            .env("PARTS", "4"));
        assert_eq!(ran.code, 0, "{}", ran.stderr);
    };
    again(&["sbatch", "--array=2-2", "examples/slurm/reduce.sbatch"]);
    again(&["sbatch", "examples/slurm/judge.sbatch"]);
    let whole = certified(&cluster, "examples/coach-good");
    assert!(
        fs::read(report.join("report.pdf")).expect("a report")
            == fs::read(whole.join("report.pdf")).expect("a report")
    );
}
