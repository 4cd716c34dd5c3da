//! All selections of three sections from each zone, against a reference program in Python (numba),
//! side by side in one run.
//!
//! `cargo bench --bench combinations`; with `FISHPLATE_PEER_COMBINATIONS` naming the reference
//! program, both get the same differences, their times alternate, and their results are compared.
//! With `--plot FILE`, the cost against the number of sections as SVG.

#![allow(clippy::print_stdout)]

use std::fmt::Write as _;
use std::process::Command;
use std::time::Instant;

use fishplate::catalog::Statistic;
use fishplate::run::pool::{
    Bounds, Pool, Pooled, PooledLimit, PooledQuantity, Rule, Section, Zone,
};
use fishplate::study::case::Case;
use fishplate::study::enumerate::core;
use fishplate::study::halves::Halves;
use fishplate::study::random::Random;

const QUANTITIES: usize = 12;
const SIGNALS: usize = 2;
const RUNS: usize = 5;

/// Differences of the size of the limits, with something in common between the signals of a
/// section.
fn pool(counts: &[usize]) -> Pool {
    let all: usize = counts.iter().sum();
    let mut random = Random::new(20_160_516, all as u64);
    let mut normal =
        || (0..12).map(|_| random.below(1 << 30) as f64 / f64::from(1 << 30)).sum::<f64>() - 6.0;
    let named = |name: &str| Statistic::named(name).expect("a statistic");
    let limit = |name: &str, bound: f64| PooledLimit {
        estimate: Pooled::Statistic(named(name), 1),
        direction: fishplate::result::Direction::Magnitude,
        edge: false,
        title: name.into(),
        scope: fishplate::result::Scope::default(),
        positions: Vec::new(),
        inside: vec![true; all],
        bounds: Bounds::Common(bound),
    };
    let quantities = (0..QUANTITIES).map(|at| {
        let values = (0..all).map(|_| {
            let base = 0.15 + 0.65 * normal();
            (0..SIGNALS).map(|signal| (signal, base + 0.45 * normal())).collect()
        });
        PooledQuantity {
            id: format!("q{at:02}"),
            title: String::new(),
            symbol: String::new(),
            unit: "-".into(),
            values: values.collect(),
            minimum_signals: 2,
            minimum_pairs: 24,
            minimum_of_groups: Vec::new(),
            limits: vec![limit("std", 1.0), limit("mean", 2.0 / 3.0)],
        }
    });
    let zone_of = counts
        .iter()
        .enumerate()
        .flat_map(|(zone, count)| (0..*count).map(move |_| (zone + 1).to_string()));
    Pool {
        quantities: quantities.collect(),
        sections: zone_of
            .enumerate()
            .map(|(at, zone)| Section {
                name: format!("s{:02}", at + 1),
                zone: Some(zone),
                site: at,
                used: true,
                reason: None,
            })
            .collect(),
        zones: (1..=counts.len())
            .map(|zone| Zone { name: zone.to_string(), title: String::new(), needed: 3 })
            .collect(),
        minimum: 12,
        rule: Some(Rule::EveryLimit),
    }
}

/// Seconds, selections validated, and minimum, quartiles and maximum of every statistic.
fn ours(case: &Case) -> (f64, u64, Vec<f64>) {
    let start = Instant::now();
    let halves = Halves::of(case);
    let (found, verdicts) = core(case, &halves);
    let validated = (halves.rows.count * halves.columns.count) as u64 - verdicts.any.count();
    let seconds = start.elapsed().as_secs_f64();
    let values = found.iter().flatten().flat_map(|over_all| {
        let spread = over_all.spread.expect("values");
        [spread.min, spread.quartiles[0], spread.quartiles[1], spread.quartiles[2], spread.max]
    });
    (seconds, validated, values.collect())
}

struct Peer {
    seconds: f64,
    /// Of all its threads.
    cpu: f64,
    validated: u64,
    values: Vec<f64>,
}

fn peer(script: &str, pool: &Pool, folder: &std::path::Path) -> Option<Peer> {
    let (input, output) = (folder.join("differences.csv"), folder.join("result.json"));
    let mut text = String::from("section,zone,quantity,signal,difference,limit\n");
    for (at, section) in pool.sections.iter().enumerate() {
        for quantity in &pool.quantities {
            for (signal, value) in &quantity.values[at] {
                let zone = section.zone.as_deref().unwrap_or_default();
                let _ = writeln!(
                    text,
                    "{},{zone},{},{},{value:?},1.0",
                    section.name,
                    quantity.id,
                    signal + 1
                );
            }
        }
    }
    std::fs::write(&input, text).ok()?;
    let run = Command::new("python3")
        .arg(script)
        .arg("--diffs")
        .arg(&input)
        .arg("--json")
        .arg(&output)
        .output()
        .ok()?;
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    // `numba: 13829760 selections in 1.74 s (1.71 s CPU); validated ...`; compiling is told on a
    // line of its own.
    let seconds = said.split("selections in ").nth(1)?.split(' ').next()?.parse().ok()?;
    let cpu =
        said.split("selections in ").nth(1)?.split('(').nth(1)?.split(' ').next()?.parse().ok()?;
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&output).ok()?).ok()?;
    let of = |id: &str, statistic: &str| {
        let found = &json["quantities"][id][statistic];
        ["min", "q25", "q50", "q75", "max"].map(|key| found[key].as_f64().unwrap_or(f64::NAN))
    };
    let values = pool
        .quantities
        .iter()
        .flat_map(|quantity| [of(&quantity.id, "std"), of(&quantity.id, "mean")].concat())
        .collect();
    Some(Peer { seconds, cpu, validated: json["validated"].as_u64()?, values })
}

/// CPU time of this process and its threads so far [s]; the kernel counts hundredths.
fn cpu() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    Some((fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?) / 100.0)
}

/// Most memory of this process so far [MB].
fn memory() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(at) = arguments.iter().position(|argument| argument == "--plot") {
        plot(&arguments[at + 1]);
        return;
    }
    let script = std::env::var("FISHPLATE_PEER_COMBINATIONS").ok();
    let folder = tempfile::tempdir().expect("a folder");
    for counts in [[9, 9, 8, 7], [9, 9, 9, 9]] {
        let pool = pool(&counts);
        let case = Case::of(&pool, None).expect("a case");
        let (mut own, mut theirs, mut worst) = (Vec::new(), Vec::new(), 0.0_f64);
        let (mut own_cpu, mut their_cpu) = (0.0, Vec::new());
        let mut validated = 0;
        for _ in 0..RUNS {
            let before = cpu();
            let (seconds, good, values) = ours(&case);
            own_cpu +=
                cpu().zip(before).map_or(f64::NAN, |(after, before)| after - before) / RUNS as f64;
            own.push(seconds);
            validated = good;
            if let Some(peer) =
                script.as_ref().and_then(|script| peer(script, &pool, folder.path()))
            {
                assert_eq!(peer.validated, good, "selections validated");
                worst = values
                    .iter()
                    .zip(&peer.values)
                    .fold(worst, |worst, (a, b)| worst.max((a - b).abs()));
                theirs.push(peer.seconds);
                their_cpu.push(peer.cpu);
            }
        }
        let own = median(own);
        let combinations = case.combinations();
        let values = 24.0 * combinations;
        println!(
            "{counts:?}: {combinations} selections, {validated} validated, exact quartiles of 24 statistics in {:.1} ms ({:.3} ns a value), memory {:.0} MB",
            1e3 * own,
            1e9 * own / values,
            memory().unwrap_or(f64::NAN)
        );
        if !theirs.is_empty() {
            let (theirs, their_cpu) = (median(theirs), median(their_cpu));
            println!(
                "  reference {:.0} ms: {:.1} times slower; largest difference {worst:.1e}",
                1e3 * theirs,
                theirs / own
            );
            println!(
                "  CPU time {:.0} ms and {:.0} ms: {:.1} times",
                1e3 * own_cpu,
                1e3 * their_cpu,
                their_cpu / own_cpu
            );
            assert!(worst <= 1e-12, "results differ by {worst}");
        }
    }
}

/// Cost against the number of sections in each of four zones, both axes logarithmic.
fn plot(path: &str) {
    let mut points = Vec::new();
    for sections in [4, 5, 6, 7, 8, 9, 10, 11] {
        let case = Case::of(&pool(&[sections; 4]), None).expect("a case");
        let milliseconds = 1e3 * median((0..3).map(|_| ours(&case).0).collect());
        println!(
            "{sections} sections in each zone: {} selections, {milliseconds:.2} ms",
            case.combinations()
        );
        points.push((case.combinations(), milliseconds, sections));
    }
    let x = |selections: f64| 60.0 + (selections.log10() - 2.0) / 7.0 * 400.0;
    let y = |milliseconds: f64| 250.0 - (milliseconds.log10() + 1.0) / 5.0 * 220.0;
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 480 300\" font-family=\"IBM Plex Sans, DejaVu Sans, Arial, sans-serif\" font-size=\"11\" fill=\"#1F242B\">\n<rect width=\"480\" height=\"300\" fill=\"#FFFFFF\"/>\n",
    );
    for power in 2..=9 {
        let at = x(10_f64.powi(power));
        let _ = writeln!(
            svg,
            "<path d=\"M{at:.1} 30V250\" stroke=\"#DDE1E6\"/><text x=\"{at:.1}\" y=\"266\" text-anchor=\"middle\">10<tspan dy=\"-4\" font-size=\"8\">{power}</tspan></text>"
        );
    }
    for power in -1..=4 {
        let at = y(10_f64.powi(power));
        let label =
            if power < 0 { "0.1".to_owned() } else { format!("{}", 10_i32.pow(power as u32)) };
        let _ = writeln!(
            svg,
            "<path d=\"M60 {at:.1}H460\" stroke=\"#DDE1E6\"/><text x=\"54\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
            at + 4.0
        );
    }
    let path_of: Vec<String> = points
        .iter()
        .map(|(selections, ms, _)| format!("{:.1} {:.1}", x(*selections), y(*ms)))
        .collect();
    let _ = writeln!(
        svg,
        "<path d=\"M{}\" fill=\"none\" stroke=\"#0072B2\" stroke-width=\"1.5\"/>",
        path_of.join("L")
    );
    for (selections, ms, sections) in &points {
        let (x, y) = (x(*selections), y(*ms));
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"#0072B2\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{sections}</text>",
            x - 5.0,
            y - 5.0
        );
    }
    svg += "<text x=\"260\" y=\"288\" text-anchor=\"middle\">selections (at the points: sections in each of four zones)</text>\n";
    svg += "<text x=\"16\" y=\"140\" text-anchor=\"middle\" transform=\"rotate(-90 16 140)\">time for share and 24 statistics [ms]</text>\n</svg>\n";
    std::fs::write(path, svg).expect("a file");
}
