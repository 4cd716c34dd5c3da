//! Wall time and peak memory of the program, beside an independent Python evaluation of the same
//! job where one is given.
//!
//! ```text
//! cargo bench --bench certify -- [CAMPAIGN...]
//! ```
//!
//! - `FISHPLATE_PEER`: a Python script with `run(folder, jobs=N)` and `--make-test-campaign DIR`.
//!   Its process start and imports are not counted (see `peer.py`); those of `fishplate` are. The
//!   rows "both started anew" count them for both, as a user of a shell sees them. Its synthetic
//!   campaign of 33 sections is timed too. A library below it may use more threads than `jobs` asks
//!   for (polars reads with all; `POLARS_MAX_THREADS=1` holds it to one).
//!
//! Each campaign is timed twice: as it is, and with its records as Parquet files, which the peer
//! reads with polars (left out with a word if it has none). Both are also timed by the same
//! protocol without its plausibility rules: the peer has none, so that this is the same work.
//! Beside the time by the clock stands that of the processors, which is fair where others use them.
//!
//! - `FISHPLATE_PYTHON`: the interpreter, `python3` by default.
//! - `FISHPLATE_QUIET`: longest wait in s before each round until the machine is idle, 0 by
//!   default; for machines that others use.
//! - `FISHPLATE_ROUNDS`: rounds that count, 7 by default. One more goes before them, to warm up
//!   caches.
//!
//! Both take turns in each round, so that a change in the load of the machine meets both.

#![expect(clippy::print_stdout, reason = "a benchmark speaks to the terminal")]

use std::error::Error;
use std::ffi::OsStr;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};
use std::{env, fs, thread};

type Outcome<T> = Result<T, Box<dyn Error>>;

const FISHPLATE: &str = env!("CARGO_BIN_EXE_fishplate");
const SCRATCH: &str = env!("CARGO_TARGET_TMPDIR");
const ROOT: &str = env!("CARGO_MANIFEST_DIR");

fn main() -> Outcome<()> {
    let rounds = env::var("FISHPLATE_ROUNDS").ok().map_or(Ok(7), |text| text.parse())?;
    let mut campaigns: Vec<PathBuf> =
        env::args().skip(1).filter(|word| !word.starts_with("--")).map(PathBuf::from).collect();
    let mut peer = env::var_os("FISHPLATE_PEER").map(|script| Peer::start(&script)).transpose()?;
    // The peer does not read the units in the file of the coach.
    if campaigns.is_empty() && peer.is_none() {
        campaigns.push(Path::new(ROOT).join("examples/coach"));
    }
    if let Some(peer) = &peer {
        campaigns.push(peer.synthetic_campaign()?);
    }
    println!(
        "{} processors, load {}, {rounds} rounds; seconds: minimum, median",
        threads(),
        load()
    );
    println!("\n{:<40} {:>8} {:>8}   {:>8} {:>8}   {:>7}", "", "here", "", "peer", "", "peer/here");
    for campaign in &campaigns {
        time_campaign(campaign, rounds, peer.as_mut())?;
    }
    time_protocols(rounds)?;
    println!("\nload {}", load());
    Ok(())
}

fn time_campaign(campaign: &Path, rounds: usize, mut peer: Option<&mut Peer>) -> Outcome<()> {
    let out = Path::new(SCRATCH).join("out");
    let columns = Path::new(SCRATCH).join("as-parquet");
    if columns.exists() {
        fs::remove_dir_all(&columns)?;
    }
    seconds(
        &[
            "convert-records".as_ref(),
            campaign.as_os_str(),
            "--to".as_ref(),
            "parquet".as_ref(),
            "--out".as_ref(),
            columns.as_os_str(),
        ],
        1,
    )?;
    let bare = Path::new(SCRATCH).join("bare.fp");
    fs::write(&bare, BARE)?;
    let results = results_of(campaign, &out);
    let without_rules = ["--protocol".as_ref(), bare.as_os_str()];
    let runs = [
        ("results", results.clone(), 0),
        ("results without plausibility", [results.as_slice(), &without_rules].concat(), 0),
        ("results from Parquet", results_of(&columns, &out), 1),
        (
            "from Parquet without plausibility",
            [results_of(&columns, &out).as_slice(), &without_rules].concat(),
            1,
        ),
    ];
    let sizes = [folder_size(campaign)?, folder_size(&columns)?].map(|bytes| bytes as f64 / 1e6);
    println!("\n{}, {:.1} MB; as Parquet {:.1} MB", campaign.display(), sizes[0], sizes[1]);
    let mut counts = vec![1, threads()];
    counts.dedup();
    for jobs in counts {
        let (mut here, mut there) = (runs.each_ref().map(|_| Vec::new()), [Vec::new(), Vec::new()]);
        let mut anew = [Vec::new(), Vec::new()];
        for round in 0..=rounds {
            for (at, (_, words, _)) in runs.iter().enumerate() {
                wait_until_idle();
                let ours = run(words, jobs)?;
                here[at].extend((round > 0).then_some(ours));
            }
            for (at, folder) in [campaign, &columns].into_iter().enumerate() {
                wait_until_idle();
                let able = |peer: &&mut &mut Peer| at == 0 || peer.columns;
                let theirs =
                    peer.as_mut().filter(able).map(|peer| peer.run(folder, jobs)).transpose()?;
                there[at].extend(theirs.map(|(time, _)| time).filter(|_| round > 0));
                wait_until_idle();
                let from_start = peer
                    .as_ref()
                    .filter(|peer| at == 0 || peer.columns)
                    .map(|peer| peer.run_anew(folder, jobs))
                    .transpose()?;
                anew[at].extend(from_start.filter(|_| round > 0));
            }
        }
        let of = format!("{jobs} thread{}", if jobs == 1 { "" } else { "s" });
        for ((what, _, format), here) in runs.iter().zip(&here) {
            print_times(&format!("{what}, {of}"), here, &there[*format]);
        }
        for (at, anew) in anew.into_iter().enumerate().filter(|(_, anew)| !anew.is_empty()) {
            let (what, _, _) = &runs[2 * at + 1];
            println!("  {what}, {of},");
            print_row(
                "  both started anew",
                here[2 * at + 1].iter().map(|time: &Time| time.clock).collect(),
                anew,
            );
        }
    }
    if peer.as_ref().is_some_and(|peer| !peer.columns) {
        println!("  the peer has no polars and was not timed on Parquet");
    }
    let whole = ["certify".as_ref(), campaign.as_os_str(), "--out".as_ref(), out.as_os_str()];
    print_row(
        "results and report (PDF, HTML)",
        repeat(rounds, || seconds(&whole, threads()))?,
        Vec::new(),
    );
    let memory = [
        peak_memory(&results, 1)?,
        peak_memory(&results, threads())?,
        peak_memory(&whole, threads())?,
    ];
    let [one, all, whole] = memory
        .map(|peak| peak.map_or("unknown".to_string(), |megabytes| format!("{megabytes:.0} MB")));
    println!("  peak memory: results {one} with 1 thread, {all} with all; with report {whole}");
    if let Some(peer) = peer {
        println!("  peak memory of the peer so far: {:.0} MB", peer.run(campaign, threads())?.1);
    }
    Ok(())
}

fn results_of<'a>(campaign: &'a Path, out: &'a Path) -> Vec<&'a OsStr> {
    vec![
        "certify".as_ref(),
        campaign.as_os_str(),
        "--only".as_ref(),
        "results".as_ref(),
        "--out".as_ref(),
        out.as_os_str(),
    ]
}

fn time_protocols(rounds: usize) -> Outcome<()> {
    let mut protocols: Vec<PathBuf> = fs::read_dir(Path::new(ROOT).join("protocols"))?
        .map(|entry| Ok(entry?.path()))
        .collect::<Outcome<_>>()?;
    protocols.retain(|path| {
        path.extension().is_some_and(|extension| extension == "fp" || extension == "yaml")
    });
    protocols.sort();
    println!("\ncheck");
    for protocol in protocols {
        let name = protocol.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let check = ["check".as_ref(), protocol.as_os_str()];
        print_row(&name, repeat(rounds, || seconds(&check, threads()))?, Vec::new());
    }
    Ok(())
}

/// The protocol of the campaigns without its plausibility rules.
const BARE: &str = "protocol bare \"Annex T without plausibility rules\"\n  extends  en14363-2016-annex-t\n\nremove\n  plausibility  every\n";

/// Time by the clock and of the processors [s].
#[derive(Clone, Copy)]
struct Time {
    clock: f64,
    processors: f64,
}

/// As [`seconds`], with the time of the processors; the kernel of Linux tells that of ended
/// children, to 10 ms.
fn run(words: &[&OsStr], jobs: usize) -> Outcome<Time> {
    let before = children_time();
    let clock = seconds(words, jobs)?;
    Ok(Time {
        clock,
        processors: children_time().zip(before).map_or(f64::NAN, |(after, before)| after - before),
    })
}

/// Processor time of all children that have ended [s].
fn children_time() -> Option<f64> {
    /// Ticks in a second, the same on all systems in use.
    const TICKS: f64 = 100.0;
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    // Behind the name, which may have blanks: state, 12 others, then the times of children in user
    // and system mode.
    let words: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |at: usize| words.get(at)?.parse::<f64>().ok();
    Some((ticks(13)? + ticks(14)?) / TICKS)
}

/// One run of the program from its start to its end [s]. A verdict that does not hold (exit code 1)
/// is a result as well.
fn seconds(words: &[&OsStr], jobs: usize) -> Outcome<f64> {
    let mut command = Command::new(FISHPLATE);
    command
        .args(words)
        .arg("--quiet")
        .env("RAYON_NUM_THREADS", jobs.to_string())
        .stdout(Stdio::null());
    let start = Instant::now();
    let done = command.output()?;
    let seconds = start.elapsed().as_secs_f64();
    match done.status.code() {
        Some(0 | 1) => Ok(seconds),
        _ => {
            Err(format!("{command:?}: {}\n{}", done.status, String::from_utf8_lossy(&done.stderr))
                .into())
        }
    }
}

/// Peak resident memory of one run [MB], from `/usr/bin/time` where there is one: the standard
/// library does not tell.
fn peak_memory(words: &[&OsStr], jobs: usize) -> Outcome<Option<f64>> {
    let timer = Path::new("/usr/bin/time");
    if !timer.exists() {
        return Ok(None);
    }
    let mut command = Command::new(timer);
    command
        .args(["-f", "%M", FISHPLATE])
        .args(words)
        .arg("--quiet")
        .env("RAYON_NUM_THREADS", jobs.to_string());
    let said = String::from_utf8(command.output()?.stderr)?;
    Ok(said
        .lines()
        .last()
        .and_then(|line| line.trim().parse::<f64>().ok())
        .map(|kilobytes| kilobytes / 1024.0))
}

fn repeat(rounds: usize, mut run: impl FnMut() -> Outcome<f64>) -> Outcome<Vec<f64>> {
    run()?;
    (0..rounds)
        .map(|_| {
            wait_until_idle();
            run()
        })
        .collect()
}

/// An evaluation in Python that stays up between requests.
struct Peer {
    script: PathBuf,
    process: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
    /// Whether it reads Parquet files.
    columns: bool,
}

impl Peer {
    fn start(script: &OsStr) -> Outcome<Self> {
        let driver = Path::new(ROOT).join("benches/peer.py");
        let mut process = python()
            .arg(driver)
            .arg(script)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let requests = process.stdin.take().ok_or("no pipe to the peer")?;
        let mut answers = BufReader::new(process.stdout.take().ok_or("no pipe from the peer")?);
        let mut able = String::new();
        answers.read_line(&mut able)?;
        Ok(Self {
            script: script.into(),
            process,
            requests,
            answers,
            columns: able.trim() == "parquet",
        })
    }

    /// Time of one evaluation and peak memory of the process so far [MB].
    fn run(&mut self, campaign: &Path, jobs: usize) -> Outcome<(Time, f64)> {
        writeln!(self.requests, "{jobs} {}", campaign.display())?;
        let mut answer = String::new();
        self.answers.read_line(&mut answer)?;
        let words: Vec<&str> = answer.split_whitespace().collect();
        let [clock, processors, memory] = words.as_slice() else {
            return Err(format!("the peer failed on {}", campaign.display()).into());
        };
        Ok((Time { clock: clock.parse()?, processors: processors.parse()? }, memory.parse()?))
    }

    /// Time of another process of the peer by the clock, from its start to its answer [s].
    fn run_anew(&self, campaign: &Path, jobs: usize) -> Outcome<f64> {
        let start = Instant::now();
        Self::start(self.script.as_os_str())?.run(campaign, jobs)?;
        Ok(start.elapsed().as_secs_f64())
    }

    fn synthetic_campaign(&self) -> Outcome<PathBuf> {
        let folder = Path::new(SCRATCH).join("synthetic-33-sections");
        if !folder.join("sections.csv").exists() {
            let status =
                python().arg(&self.script).arg("--make-test-campaign").arg(&folder).status()?;
            if !status.success() {
                return Err(format!("the peer made no test campaign: {status}").into());
            }
        }
        Ok(folder)
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // The driver ends with its input, which closes only after this; what it would still say is
        // of no use.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn python() -> Command {
    Command::new(env::var_os("FISHPLATE_PYTHON").unwrap_or_else(|| "python3".into()))
}

fn print_row(what: &str, here: Vec<f64>, there: Vec<f64>) {
    let Some((minimum, median)) = minimum_and_median(here) else { return };
    print!("  {what:<38} {minimum:>8.4} {median:>8.4}");
    if let Some((peer_minimum, peer_median)) = minimum_and_median(there) {
        print!(
            "   {peer_minimum:>8.4} {peer_median:>8.4}   {:>5.1} {:>5.1}",
            peer_minimum / minimum,
            peer_median / median
        );
    }
    println!();
}

fn print_times(what: &str, here: &[Time], there: &[Time]) {
    let of = |times: &[Time], kind: fn(&Time) -> f64| times.iter().map(kind).collect::<Vec<f64>>();
    print_row(what, of(here, |time| time.clock), of(there, |time| time.clock));
    // The kernel counts in steps of 10 ms, which the mean evens out.
    let mean =
        |times: &[Time]| times.iter().map(|time| time.processors).sum::<f64>() / times.len() as f64;
    let (here, there) = (mean(here), mean(there));
    print!("    processors, mean                     {here:>8.4}");
    println!(
        "{}",
        if there.is_finite() {
            format!("            {there:>8.4}            {:>5.1}", there / here)
        } else {
            String::new()
        }
    );
}

fn minimum_and_median(mut values: Vec<f64>) -> Option<(f64, f64)> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let median = if values.len() % 2 == 1 {
        *values.get(middle)?
    } else {
        (values.get(middle.checked_sub(1)?)? + values.get(middle)?) / 2.0
    };
    Some((*values.first()?, median))
}

fn folder_size(folder: &Path) -> Outcome<u64> {
    let mut bytes = 0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let about = entry.metadata()?;
        bytes += if about.is_dir() { folder_size(&entry.path())? } else { about.len() };
    }
    Ok(bytes)
}

fn threads() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// Returns once less than a tenth of the processors' time is used by others, or `FISHPLATE_QUIET`
/// seconds have passed.
fn wait_until_idle() {
    let patience = env::var("FISHPLATE_QUIET")
        .ok()
        .and_then(|text| text.parse().ok())
        .map_or(Duration::ZERO, Duration::from_secs);
    let start = Instant::now();
    while start.elapsed() < patience {
        let before = processor_time();
        thread::sleep(Duration::from_millis(200));
        let (Some((idle, all)), Some((idle_after, all_after))) = (before, processor_time()) else {
            return;
        };
        if (idle_after - idle) as f64 > 0.9 * (all_after - all) as f64 {
            return;
        }
    }
}

/// Idle time and all time of all processors since they started, in ticks; the kernel of Linux
/// tells.
fn processor_time() -> Option<(u64, u64)> {
    let text = fs::read_to_string("/proc/stat").ok()?;
    // user, nice, system, idle, waiting for input, and what interrupts and other machines took.
    let ticks: Vec<u64> = text
        .lines()
        .next()?
        .split_whitespace()
        .skip(1)
        .take(8)
        .filter_map(|word| word.parse().ok())
        .collect();
    Some((ticks.get(3)? + ticks.get(4)?, ticks.iter().sum()))
}

fn load() -> String {
    fs::read_to_string("/proc/loadavg")
        .ok()
        .and_then(|text| text.split(' ').next().map(str::to_string))
        .unwrap_or_else(|| "unknown".to_string())
}
