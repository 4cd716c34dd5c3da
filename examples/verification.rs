//! Code comparison: records of the reference model against the simulated records of campaigns,
//! which an independent program computed from the same description. `cargo run --release --example
//! verification -- CAMPAIGN...` prints the table, writes it into `docs/verification.md` and draws
//! `docs/images/verification-*.svg`.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

#[path = "../tests/simulation/model/common.rs"]
#[allow(dead_code)]
mod common;

use std::fmt::Write as _;
use std::path::Path;

use common::{Section, deviation, median};
use fishplate::model::{CHANNELS, Record};
use fishplate::report::figure::axis::{over, title};
use fishplate::report::figure::canvas::Canvas;
use fishplate::report::figure::frame::Frame;
use fishplate::report::figure::legend::{Entry, Legend};
use fishplate::report::figure::style::{BLUE, MEASURED, Pen, TICK, WIDTH, color, look};
use rayon::prelude::*;

/// Groups of channels: prefix of the names, label, unit, and the value above which a relative
/// deviation is meaningful.
const GROUPS: [(&str, &str, &str, f64); 5] = [
    ("Y", "guiding forces Y", "kN", 1.0),
    ("Q", "wheel forces Q", "kN", 1.0),
    ("ay_", "body, lateral", "m/s^2", 0.05),
    ("az_", "body, vertical", "m/s^2", 0.05),
    ("ayb_", "bogie, lateral", "m/s^2", 0.05),
];

/// One channel of one section: medians, standard deviations about the mean, and the largest
/// difference of a sample.
struct Pair {
    group: usize,
    ours: [f64; 2],
    theirs: [f64; 2],
    worst: f64,
}

fn group(channel: &str) -> usize {
    GROUPS.iter().position(|group| channel.starts_with(group.0)).unwrap()
}

fn pairs(section: &Section, record: &Record) -> Vec<Pair> {
    let pair = |i: usize| {
        let ours = section.inside(&record.distance, &record.channels[i]);
        let theirs = section.inside(&record.distance, &section.recorded[1 + i]);
        let worst = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let numbers = |signal: &[f64]| [median(signal), deviation(signal)];
        Pair { group: group(CHANNELS[i].0), ours: numbers(&ours), theirs: numbers(&theirs), worst }
    };
    (0..CHANNELS.len()).map(pair).collect()
}

fn main() {
    let campaigns: Vec<String> = std::env::args().skip(1).collect();
    if campaigns.is_empty() {
        println!("arguments: CAMPAIGN...");
        std::process::exit(2);
    }
    let mut table = String::from(
        "| campaign | channels | values | medians differ by | of values above | rms differs by | of values above | samples differ by |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let mut all = Vec::new();
    for (number, campaign) in campaigns.iter().enumerate() {
        let vehicle = common::vehicle(campaign, &[]);
        let profile = common::profile(campaign, &vehicle);
        let sections = common::sections(campaign);
        let records: Vec<Record> = sections
            .par_iter()
            .map(|section| section.simulate(&vehicle, &profile).unwrap())
            .collect();
        let found: Vec<Pair> = sections
            .iter()
            .zip(&records)
            .flat_map(|(section, record)| pairs(section, record))
            .collect();
        let name = Path::new(campaign).file_name().unwrap().to_string_lossy().into_owned();
        for (n, (_, words, unit, matters)) in GROUPS.iter().enumerate() {
            let of: Vec<&Pair> = found.iter().filter(|pair| pair.group == n).collect();
            let most = |value: &dyn Fn(&Pair) -> f64| {
                of.iter().map(|pair| value(pair)).fold(0.0, f64::max)
            };
            let share = |k: usize| {
                let large = of.iter().filter(|pair| pair.theirs[k].abs() > *matters);
                large
                    .map(|pair| (pair.ours[k] / pair.theirs[k] - 1.0).abs() * 100.0)
                    .fold(0.0, f64::max)
            };
            let unit = unit.replace("^2", "²");
            writeln!(
                table,
                "| {name} | {words} | {} | {:.4} {unit}, {:.2} % | {matters} {unit} | {:.2} % | {matters} {unit} | {:.4} {unit} |",
                of.len(),
                most(&|pair| (pair.ours[0] - pair.theirs[0]).abs()),
                share(0),
                share(1),
                most(&|pair| pair.worst),
            )
            .unwrap();
        }
        if number == 0 {
            let at = sections.iter().position(|section| section.name == "S13").unwrap_or(0);
            write(
                Path::new("docs/images/verification-section.svg"),
                &traces(&sections[at], &records[at]),
            );
        }
        all.push((name, found));
    }
    println!("{table}");
    write(Path::new("docs/images/verification-rms.svg"), &scatter(&all));
    insert(&table);
}

/// Writes a file relative to the repository.
fn write(path: &Path, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}

/// Inserts the table between its marks.
fn insert(table: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/verification.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) =
        page.split_once("<!-- table -->\n").expect("the page has the mark `<!-- table -->`");
    let (_, after) = rest
        .split_once("<!-- end of table -->")
        .expect("the page has the mark `<!-- end of table -->`");
    std::fs::write(&path, format!("{before}<!-- table -->\n{table}<!-- end of table -->{after}"))
        .unwrap();
}

/// Three channels of a section, recorded and simulated, and below each the difference.
fn traces(section: &Section, record: &Record) -> String {
    const HEIGHT: f64 = 62.0;
    const REST: f64 = 26.0;
    let entries = [
        Entry::line(Pen::solid(MEASURED, 1.8), "independent program"),
        Entry::line(Pen::solid(BLUE, 0.7), "this model"),
        Entry::line(Pen::solid(color(1), 0.7), "difference"),
    ];
    let legend = Legend::new(entries, WIDTH - 50.0);
    let step = HEIGHT + REST + 20.0;
    let channels = ["Y_1L", "Q_1L", "ay_I"];
    let mut canvas =
        Canvas::new(WIDTH, legend.height() + 6.0 + step * channels.len() as f64 + 16.0);
    legend.draw(&mut canvas, (44.0, 0.0));
    let x = section.inside(&record.distance, &record.distance);
    for (n, channel) in channels.into_iter().enumerate() {
        let at = common::channel(channel);
        let unit = CHANNELS[at].1;
        let ours = section.inside(&record.distance, &record.channels[at]);
        let theirs = section.inside(&record.distance, &section.recorded[1 + at]);
        let rest: Vec<f64> = ours.iter().zip(&theirs).map(|(a, b)| a - b).collect();
        let top = legend.height() + 6.0 + step * n as f64;
        let along = (section.start, section.end);
        let (across, bottom) = ((44.0, WIDTH - 6.0), top + HEIGHT);
        let upper = Frame::new(along, over(theirs.iter().copied()), across, (top, bottom));
        let below = (bottom + 6.0, bottom + 6.0 + REST);
        let lower = Frame::new(along, over(rest.iter().copied()), across, below);
        upper.y_axis(&mut canvas, 4, &title(channel, unit));
        let words = if n + 1 == channels.len() { title("distance", "m") } else { String::new() };
        lower.x_axis(&mut canvas, 8, &words);
        lower.y_axis(&mut canvas, 2, "");
        for (frame, signal, color, width) in [
            (&upper, &theirs, MEASURED, 1.8),
            (&upper, &ours, BLUE, 0.7),
            (&lower, &rest, color(1), 0.7),
        ] {
            let points: Vec<(f64, f64)> =
                x.iter().zip(signal).map(|(x, y)| frame.at(*x, *y)).collect();
            canvas.path(&points, color, width);
        }
        upper.spine(&mut canvas);
        lower.spine(&mut canvas);
    }
    canvas.finish()
}

/// Difference of the standard deviations in per cent over the recorded one, for every channel and
/// section of all campaigns.
fn scatter(all: &[(String, Vec<Pair>)]) -> String {
    let entries = GROUPS.iter().enumerate().map(|(n, group)| Entry::mark(look(n), group.1));
    let legend = Legend::new(entries, WIDTH - 50.0);
    let top = legend.height() + 6.0;
    let points: Vec<(usize, f64, f64)> = all
        .iter()
        .flat_map(|(_, pairs)| pairs)
        .filter(|pair| pair.theirs[1] > GROUPS[pair.group].3)
        .map(|pair| {
            (pair.group, pair.theirs[1].log10(), (pair.ours[1] / pair.theirs[1] - 1.0) * 100.0)
        })
        .collect();
    let x = over(points.iter().map(|point| point.1));
    let y = over(points.iter().map(|point| point.2));
    let frame = Frame::new(x, y, (44.0, WIDTH - 6.0), (top, top + 120.0));
    let mut canvas = Canvas::new(WIDTH, top + 146.0);
    legend.draw(&mut canvas, (44.0, 0.0));
    let mut ticks = frame.x.ticks(8);
    for tick in &mut ticks {
        tick.label = format!("{:.2}", 10_f64.powf(tick.value));
    }
    frame.x_numbers(&mut canvas, &ticks, TICK);
    frame.x_title(&mut canvas, "recorded standard deviation [kN or m/s²], logarithmic");
    frame.y_axis(&mut canvas, 6, "difference [%]");
    for (group, x, y) in &points {
        canvas.mark(look(*group), frame.at(*x, *y), 1.4);
    }
    frame.spine(&mut canvas);
    canvas.finish()
}
