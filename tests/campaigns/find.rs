//! Sections found in runs: against a search written by itself here, against the same sections as
//! records of their own, and what is refused.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::common::program::{certify, fishplate};
use serde_json::Value;
use tempfile::TempDir;

/// Curvature [1/m] of the track, piece by piece: up to where, and how much. Whole metres.
const TRACK: [(f64, f64); 9] = [
    (620.0, 0.0),
    (660.0, 0.001),
    (1010.0, 0.002),
    (1050.0, 0.001),
    (2300.0, 0.0),
    (2420.0, -0.004),
    (3000.0, 0.0),
    (3555.0, 0.002),
    (4000.0, 0.0),
];
/// Samples per second, and the distance of the first sample of each side.
const RATE: f64 = 50.0;
const FIRST: [f64; 2] = [3.0, 11.0];
const END: f64 = 3990.0;

fn curvature(at: f64) -> f64 {
    TRACK.iter().find(|(to, _)| at < *to).map_or(0.0, |(_, curvature)| *curvature)
}

/// 20 m/s, from 1300 to 1700 m 24 m/s, with ramps of 40 m.
fn speed(at: f64) -> f64 {
    20.0 + 4.0 * ((at - 1300.0) / 40.0).clamp(0.0, 1.0)
        - 4.0 * ((at - 1700.0) / 40.0).clamp(0.0, 1.0)
}

/// A row of a record: time, distance, speed [km/h], force [kN].
fn rows(side: usize) -> Vec<[f64; 4]> {
    let (mut time, mut at, mut rows) = (0.0, FIRST[side], Vec::new());
    while at < END {
        let force = 10.0
            + 3.0 * (at / 7.0).sin()
            + (0.3 + 2.0 * at / END) * (at / (1.3 + side as f64 * 0.01)).cos();
        rows.push([
            time,
            (at * 1e3).round() / 1e3,
            (speed(at) * 3.6 * 100.0).round() / 100.0,
            (force * 1e3).round() / 1e3,
        ]);
        at += speed(at) / RATE;
        time += 1.0 / RATE;
    }
    rows
}

fn csv(rows: &[[f64; 4]]) -> String {
    let mut text = String::from("time [s],distance [m],speed [km/h],F [kN]\n");
    for [time, at, speed, force] in rows {
        let _ = writeln!(text, "{time:.3},{at:.3},{speed:.2},{force:.3}");
    }
    text
}

const CAMPAIGN: &str = "name: Runs\nvehicle: vehicle.yaml\nruns:\n  R1:\n    measurement: runs/measurement.csv\n    simulation: runs/simulation.csv\n    track: runs/track.csv\n    country: IT\n";

const PROTOCOL: &str = r#"protocol runs "Sections of runs"
  axis  distance in m
  time  time in s

channel running_speed "Speed"
  in      km/h
  column  "speed"

channel F "Force"
  in  kN

channel curvature "Curvature"
  in      1/m
  record  track

section zone "Zone"
  one of  zones

section radius "Radius"
  in     m
  found  1 / |mean of curvature| when |mean of curvature| > 0.0001 1/m

section direction "Direction"
  one of  right, left, straight
  found   right when mean of curvature > 0.0001 1/m, left when mean of curvature < -0.0001 1/m, otherwise straight

section speed "Speed"
  in     km/h
  found  mean of running_speed

section country "Country"
  one of  IT, FR

zone 1 "Straight"
  where           direction is straight
  minimum length  100 m

zone 2 "Curves"
  where           radius >= 400 m
  minimum length  70 m

sections
  use     found sections
  zone    zone
  step    1 m
  margin  20 m

find curve "Constant curvature"
  require  range of curvature <= 0.000001 1/m
  lead     30 m
  tail     10 m

find steady "Steady speed"
  require  range of running_speed <= 2 km/h

quantity F_rms
  of          F
  filter      band-pass 0.4 Hz to 10 Hz, order 4, zero-phase
  value       rms
  difference  simulated - measured
  limit       std 5 kN

quantity F_mean
  of          F
  filter      low-pass 20 Hz, order 4, zero-phase
  value       mean
  difference  simulated - measured
  limit       std 5 kN
"#;

fn campaign() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, text).expect("written");
    };
    write("campaign.yaml", CAMPAIGN);
    write("vehicle.yaml", "name: none\n");
    write("runs/measurement.csv", &csv(&rows(0)));
    write("runs/simulation.csv", &csv(&rows(1)));
    let track: String = (0..=8000)
        .map(|at| format!("{},{}\n", at as f64 / 2.0, curvature(at as f64 / 2.0)))
        .collect();
    write("runs/track.csv", &format!("distance [m],curvature [1/m]\n{track}"));
    write("runs.fp", PROTOCOL);
    folder
}

/// Start, end and zone of each section, and why other places are none: written without the program.
fn expected() -> (Vec<(f64, f64, u8)>, [usize; 4]) {
    let measured = rows(0);
    let last = [rows(0), rows(1)]
        .map(|rows| rows[rows.len() - 1][1])
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    let (mut found, mut rejected, mut at) = (Vec::new(), [0; 4], 11.0_f64);
    while at <= last {
        let mut reason = None;
        let mut fits = None;
        for (zone, length) in [(1_u8, 100.0), (2, 70.0)] {
            let end = at + length;
            if at - 20.0 < 11.0 || end + 20.0 > last {
                reason.get_or_insert(0);
                continue;
            }
            let track = |from: f64, to: f64| -> Vec<f64> {
                (0..=8000)
                    .map(|at| at as f64 / 2.0)
                    .filter(|x| (from..=to).contains(x))
                    .map(curvature)
                    .collect()
            };
            let inside = track(at, end);
            let mean = inside.iter().sum::<f64>() / inside.len() as f64;
            let is = if mean.abs() <= 0.0001 {
                1
            } else if 1.0 / mean.abs() >= 400.0 {
                2
            } else {
                0
            };
            if is != zone {
                continue;
            }
            let range = |of: &[f64]| {
                of.iter().copied().fold(f64::MIN, f64::max)
                    - of.iter().copied().fold(f64::MAX, f64::min)
            };
            let speeds: Vec<f64> = measured
                .iter()
                .filter(|row| (at..=end).contains(&row[1]))
                .map(|row| row[2])
                .collect();
            let condition = if at - 30.0 < 0.0 || range(&track(at - 30.0, end + 10.0)) > 0.000001 {
                Some(2)
            } else if range(&speeds) > 2.0 + 1e-9 {
                Some(3)
            } else {
                None
            };
            match condition {
                Some(condition) => {
                    reason =
                        if reason.is_none_or(|known| known < 2) { Some(condition) } else { reason }
                }
                None => {
                    fits = Some((at, end, zone));
                    break;
                }
            }
        }
        match fits {
            Some(place) => {
                found.push(place);
                at = place.1;
            }
            None => {
                rejected[reason.unwrap_or(1)] += 1;
                at += 1.0;
            }
        }
    }
    (found, rejected)
}

fn path(folder: &TempDir, name: &str) -> String {
    folder.path().join(name).display().to_string()
}

/// The table that `sections` writes, cell by cell.
#[track_caller]
fn sections(folder: &TempDir, protocol: &str) -> Vec<Vec<String>> {
    let out = path(folder, "out.csv");
    let ran = fishplate(&[
        "sections",
        &folder.path().display().to_string(),
        "--protocol",
        &path(folder, protocol),
        "--out",
        &out,
    ]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let text = fs::read_to_string(out).expect("a table");
    text.lines().map(|line| line.split(',').map(str::to_string).collect()).collect()
}

fn with(folder: &TempDir, name: &str, more: &str) {
    fs::write(
        folder.path().join(name),
        format!("protocol variant \"Variant\"\n  extends  \"runs.fp\"\n\n{more}"),
    )
    .expect("written");
}

#[test]
fn sections_are_those_of_an_independent_search() {
    let folder = campaign();
    let table = sections(&folder, "runs.fp");
    assert_eq!(
        table[0],
        [
            "section",
            "run",
            "start [m]",
            "end [m]",
            "zone [-]",
            "radius [m]",
            "direction",
            "speed [km/h]",
            "country"
        ]
    );
    let (places, rejected) = expected();
    assert!(places.len() > 20, "{}", places.len());
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let found: Vec<(f64, f64, u8)> = table[1..]
        .iter()
        .map(|row| (number(&row[2]), number(&row[3]), row[4].parse().expect("a zone")))
        .collect();
    assert_eq!(found, places);
    assert!(table[1..].iter().all(|row| row[1] == "R1" && row[8] == "IT"));
    assert!(
        table[1..]
            .iter()
            .all(|row| (row[4] == "1") == (row[6] == "straight")
                && (row[4] == "1") == row[5].is_empty()),
        "{table:?}"
    );
    let curve = table.iter().find(|row| row[4] == "2").expect("a curve");
    assert_eq!((curve[5].as_str(), curve[6].as_str()), ("500", "right"));
    // The same in the results, with what was rejected.
    let certified =
        certify(folder.path(), &["--protocol", &path(&folder, "runs.fp"), "--only", "results"]);
    assert_eq!(certified.ran.code, 0, "{}", certified.ran.stderr);
    let results = certified.results();
    let run = &results["found_sections"][0]["runs"][0];
    assert_eq!(run["found"], places.len());
    assert_eq!(run["tried"], places.len() + rejected.iter().sum::<usize>());
    let of = |reason: &str| {
        let all = run["rejected"].as_array().expect("a list");
        all.iter()
            .find(|one| one["reason"] == reason)
            .map_or(0, |one| one["places"].as_u64().expect("a count") as usize)
    };
    let reasons = ["the record ends too close", "in no zone", "Constant curvature", "Steady speed"];
    assert_eq!(reasons.map(of), rejected);
    let stretches: u64 = run["stretches"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|one| one["places"].as_u64())
        .sum();
    assert_eq!(stretches as usize, rejected.iter().sum::<usize>());
}

fn values(results: &Value) -> Vec<(String, f64, f64)> {
    let quantities = results["quantities"].as_array().expect("a list");
    let of = |value: &Value| {
        (
            value["section"].as_str().expect("a name").to_string(),
            value["simulated"].as_f64().expect("a number"),
            value["measured"].as_f64().expect("a number"),
        )
    };
    quantities
        .iter()
        .flat_map(|quantity| quantity["values"].as_array().expect("a list").iter().map(of))
        .collect()
}

#[test]
fn a_section_of_a_run_has_the_values_of_a_record_of_its_own() {
    let folder = campaign();
    let found =
        certify(folder.path(), &["--protocol", &path(&folder, "runs.fp"), "--only", "results"])
            .results();
    // The table by hand: the same sections, cut from the same run.
    let table = sections(&folder, "runs.fp");
    fs::copy(folder.path().join("out.csv"), folder.path().join("sections.csv")).expect("copied");
    fs::write(folder.path().join("campaign.yaml"), format!("{CAMPAIGN}sections: sections.csv\n"))
        .expect("written");
    let by_table =
        certify(folder.path(), &["--protocol", &path(&folder, "runs.fp"), "--only", "results"])
            .results();
    assert!(by_table.get("found_sections").is_none());
    assert_eq!(values(&found), values(&by_table));
    // A file for each section, with the same rows around it.
    let text = table
        .iter()
        .map(|row| [&row[..1], &row[2..]].concat().join(",") + "\n")
        .collect::<String>();
    fs::write(folder.path().join("sections.csv"), text).expect("written");
    let files = "name: Runs\nvehicle: vehicle.yaml\nmeasurement: measurement\nsimulation: simulation\ntrack: track\nsections: sections.csv\n";
    fs::write(folder.path().join("campaign.yaml"), files).expect("written");
    for (side, name) in ["measurement", "simulation"].into_iter().enumerate() {
        fs::create_dir_all(folder.path().join(name)).expect("made");
        let all = rows(side);
        for row in &table[1..] {
            let [start, end] = [2, 3].map(|column| row[column].parse::<f64>().expect("a number"));
            let around = 2.0 * (end - start);
            let inside: Vec<[f64; 4]> = all
                .iter()
                .filter(|row| (start - around..=end + around).contains(&row[1]))
                .copied()
                .collect();
            fs::write(folder.path().join(name).join(format!("{}.csv", row[0])), csv(&inside))
                .expect("written");
        }
    }
    // A filter settles further in a run, where neighbours share a stretch; the other quantity is
    // not filtered.
    let by_file =
        certify(folder.path(), &["--protocol", &path(&folder, "runs.fp"), "--only", "results"])
            .results();
    let (in_run, by_file) = (values(&found), values(&by_file));
    assert_eq!(in_run.len(), by_file.len());
    for (at, ((section, simulated, measured), (same, s, m))) in
        in_run.iter().zip(&by_file).enumerate()
    {
        let within = if at < table.len() - 1 { 2e-3 } else { 0.0 };
        assert_eq!(section, same);
        assert!(
            (simulated - s).abs() <= within * s.abs() && (measured - m).abs() <= within * m.abs(),
            "{section} {simulated} {s} {measured} {m}"
        );
    }
}

#[test]
fn of_places_that_overlap_the_preferred_one_is_taken() {
    let folder = campaign();
    with(&folder, "prefer.fp", "sections\n  prefer  std of F\n");
    let first = sections(&folder, "runs.fp");
    let preferred = sections(&folder, "prefer.fp");
    let starts = |table: &[Vec<String>]| {
        table[1..].iter().map(|row| row[2].parse::<f64>().expect("a number")).collect::<Vec<f64>>()
    };
    assert_ne!(starts(&first), starts(&preferred));
    let ends: Vec<f64> =
        preferred[1..].iter().map(|row| row[3].parse().expect("a number")).collect();
    assert!(
        starts(&preferred)[1..].iter().zip(&ends).all(|(start, end)| start >= end),
        "no overlap"
    );
    let measured = rows(0);
    let deviation = |row: &Vec<String>| {
        let [start, end] = [2, 3].map(|column| row[column].parse::<f64>().expect("a number"));
        let inside: Vec<f64> = measured
            .iter()
            .filter(|row| (start..=end).contains(&row[1]))
            .map(|row| row[3])
            .collect();
        let mean = inside.iter().sum::<f64>() / inside.len() as f64;
        (inside.iter().map(|force| (force - mean).powi(2)).sum::<f64>() / (inside.len() - 1) as f64)
            .sqrt()
    };
    let highest = |table: &[Vec<String>]| table[1..].iter().map(deviation).fold(0.0, f64::max);
    assert!(highest(&preferred) > highest(&first), "{} {}", highest(&preferred), highest(&first));
}

#[test]
fn a_length_by_speed_is_that_of_the_section() {
    let folder = campaign();
    with(&folder, "length.fp", "sections\n  length  150 m when speed > 80 km/h, otherwise 60 m\n");
    let table = sections(&folder, "length.fp");
    let number = |row: &[String], at: usize| row[at].parse::<f64>().expect("a number");
    let lengths: Vec<(f64, f64)> =
        table[1..].iter().map(|row| (number(row, 3) - number(row, 2), number(row, 7))).collect();
    assert!(
        lengths.iter().all(|(length, speed)| *length == if *speed > 80.0 { 150.0 } else { 60.0 }),
        "{lengths:?}"
    );
    assert!(lengths.iter().any(|(length, _)| *length == 150.0));
}

#[test]
fn sections_are_reduced_and_the_verdict_and_its_check_use_those_kept() {
    let folder = campaign();
    with(&folder, "keep.fp", "sections\n  keep  at most 3 for each zone and country\n");
    let certified = certify(folder.path(), &["--protocol", &path(&folder, "keep.fp")]);
    assert_eq!(certified.ran.code, 0, "{}", certified.ran.stderr);
    let results = certified.results();
    let used = |section: &&Value| section["used"] == true;
    let sections = results["sections"].as_array().expect("a list");
    assert_eq!(sections.iter().filter(used).count(), 6);
    let left = sections.iter().find(|section| section["used"] == false).expect("one left out");
    assert!(
        left["reason"]
            .as_str()
            .expect("a reason")
            .starts_with("left out by the reduction to at most 3"),
        "{left}"
    );
    assert_eq!(results["quantities"][0]["pairs"], 6);
    let kept = results["reduction"]["kept"].as_array().expect("a list");
    assert_eq!(
        kept.iter().map(|group| group[0].as_str().expect("a name")).collect::<Vec<_>>(),
        ["1, IT", "2, IT"]
    );
    let scatter = results["reduction"]["scatter"].as_array().expect("a list");
    let highest = |at: usize| {
        scatter.iter().map(|row| row[at].as_f64().expect("a number")).fold(0.0, f64::max)
    };
    assert!((highest(1) - highest(2)).abs() < 0.05 * highest(1), "{scatter:?}");
    let report = certified.folder().join("report.pdf").display().to_string();
    let verified = fishplate(&["verify", &report, &folder.path().display().to_string()]);
    assert_eq!(verified.code, 0, "{}\n{}", verified.stdout, verified.stderr);
    let html = certified.text("report.html");
    assert!(html.contains("Search for sections in runs") && html.contains("Sections kept"));
    let result = certified.folder().join("results.json").display().to_string();
    let section = sections
        .iter()
        .find(used)
        .and_then(|section| section["section"].as_str())
        .expect("a section");
    let traced = fishplate(&[
        "trace",
        &result,
        "F_rms",
        section,
        "F",
        "--campaign",
        &folder.path().display().to_string(),
        "--protocol",
        &path(&folder, "keep.fp"),
    ]);
    assert_eq!(traced.code, 0, "{}\n{}", traced.stdout, traced.stderr);
}

/// A class of the speed, which the zones and other data use. Its edges are the two constant speeds
/// of the run, which are in the class above.
const CLASSES: &str = r#"section class "Class of the speed"
  one of  slow, medium, fast
  is      slow when speed < 72 km/h, medium when speed < 86.4 km/h, otherwise fast

section twice "Twice the speed where it is high"
  in     km/h
  found  2 * speed when class is fast, otherwise speed

section pace "Half of it, in another unit"
  in  m/s
  is  twice / 2

zone 1
  where  direction is straight and class is fast
"#;

/// Data of found sections are computed from what is found, and the reverse: the places are those of
/// the same conditions on the speed, the words and numbers those of the table that is written.
#[test]
fn data_of_found_sections_are_computed() {
    let folder = campaign();
    with(&folder, "classes.fp", CLASSES);
    with(&folder, "speeds.fp", "zone 1\n  where  direction is straight and speed >= 86.4 km/h\n");
    let (table, plain) = (sections(&folder, "classes.fp"), sections(&folder, "speeds.fp"));
    assert_eq!(table[0][..9], plain[0]);
    assert_eq!(table[0][9..], ["twice [km/h]"]);
    assert!(table.len() < sections(&folder, "runs.fp").len());
    assert!(table.iter().zip(&plain).skip(1).all(|(one, other)| one[..9] == other[..]));
    assert_eq!(table.len(), plain.len());

    let number = |text: &str| text.parse::<f64>().expect("a number");
    let class = |speed: f64| match speed {
        speed if speed < 72.0 => "slow",
        speed if speed < 86.4 => "medium",
        _ => "fast",
    };
    let certified = |folder: &TempDir| {
        let protocol = path(folder, "classes.fp");
        let certified = certify(folder.path(), &["--protocol", &protocol, "--only", "results"]);
        assert_eq!(certified.ran.code, 0, "{}", certified.ran.stderr);
        certified.results()["sections"].clone()
    };
    let found = certified(&folder);
    let mut seen = Vec::new();
    for (row, section) in table[1..].iter().zip(found.as_array().expect("a list")) {
        let (speed, data) = (number(&row[7]), &section["columns"]);
        let datum = |at: usize| data[at]["value"].as_str().expect("a text");
        let doubled = if class(speed) == "fast" { 2.0 * speed } else { speed };
        assert_eq!(datum(5), class(speed), "{speed}");
        assert!((number(&row[9]) - doubled).abs() < 1e-6 * doubled, "{row:?}");
        assert!((number(datum(7)) - doubled / 7.2).abs() < 1e-6 * doubled, "{row:?}");
        seen.push(class(speed));
    }
    assert!(["medium", "fast"].iter().all(|class| seen.contains(class)), "{seen:?}");

    // The table as it is written: the same sections, from the runs.
    sections(&folder, "classes.fp");
    fs::copy(path(&folder, "out.csv"), path(&folder, "sections.csv")).expect("copied");
    let yaml = folder.path().join("campaign.yaml");
    fs::write(&yaml, format!("{CAMPAIGN}sections: sections.csv\n")).expect("written");
    assert_eq!(certified(&folder), found);

    // What is computed is not stated of a run, whether its sections are found or in a table.
    for rest in ["", "sections: sections.csv\n"] {
        let stated = CAMPAIGN.replace("country: IT", "country: IT\n    class: fast") + rest;
        fs::write(&yaml, stated).expect("written");
        let ran = certify(folder.path(), &["--protocol", &path(&folder, "classes.fp")]).ran;
        assert_eq!(ran.code, 2, "{}", ran.stdout);
        for part in [
            "error[computed-column]: the protocol computes `class`, and the campaign states it",
            "campaign.yaml:9:12",
            "classes.fp:4:9",
            "help: remove the line, or rename it",
        ] {
            assert!(ran.stderr.contains(part), "`{part}` is not in:\n{}", ran.stderr);
        }
        assert_eq!(ran.stderr.matches("error[").count(), 1, "{}", ran.stderr);
    }
}

#[test]
fn what_cannot_be_found_is_told_with_its_place() {
    let refused = |change: &dyn Fn(&Path), protocol: &str, code: &str, says: &str| {
        let folder = campaign();
        change(folder.path());
        fs::write(folder.path().join("none.fp"), PROTOCOL.replace("found sections", "sections"))
            .expect("written");
        let campaign = folder.path().display().to_string();
        let ran = fishplate(&[
            "sections",
            &campaign,
            "--protocol",
            &path(&folder, protocol),
            "--out",
            &path(&folder, "out.csv"),
        ]);
        assert_eq!(ran.code, 2, "{code}: {}", ran.stdout);
        assert!(
            ran.stderr.contains(&format!("error[{code}]")) && ran.stderr.contains(says),
            "{code}: {}",
            ran.stderr
        );
        assert!(!folder.path().join("out.csv").exists(), "{code}");
    };
    let yaml = |from: &'static str, to: &'static str| {
        move |folder: &Path| {
            fs::write(folder.join("campaign.yaml"), CAMPAIGN.replace(from, to)).expect("written")
        }
    };
    refused(&|_| {}, "none.fp", "no-search", "use found sections");
    refused(&yaml("    country: IT\n", ""), "runs.fp", "missing-run-data", "campaign.yaml:4:3");
    refused(
        &|folder| {
            fs::write(
                folder.join("fine.fp"),
                PROTOCOL.replace("  step    1 m", "  step    0.00001 m"),
            )
            .expect("written")
        },
        "fine.fp",
        "too-many-places",
        "write a longer `step`",
    );
    refused(
        &yaml("country: IT", "country: Italy"),
        "runs.fp",
        "wrong-run-data",
        "campaign.yaml:8:14",
    );
    refused(
        &yaml("country: IT", "county: IT"),
        "runs.fp",
        "missing-run-data",
        "the run states `county`: if `country` is meant, write `country`",
    );
    refused(
        &yaml("    track: runs/track.csv\n", ""),
        "runs.fp",
        "key-missing",
        "the run `R1` has no `track`",
    );
    refused(
        &yaml("runs/track.csv", "runs/trak.csv"),
        "runs.fp",
        "file-missing",
        "did you mean `runs/track.csv`?",
    );
    refused(&yaml("runs/track.csv", "../track.csv"), "runs.fp", "path-outside", "campaign.yaml:7");
    refused(
        &yaml("    simulation:", "    simulatoin:"),
        "runs.fp",
        "unknown-key",
        "did you mean `simulation`?",
    );
    refused(
        &|folder| {
            fs::write(folder.join("campaign.yaml"), "name: Runs\nvehicle: vehicle.yaml\nruns: R1\n")
                .expect("written")
        },
        "runs.fp",
        "wrong-kind",
        "a map of names and runs",
    );
    refused(
        &|folder| {
            fs::write(folder.join("runs.fp"), PROTOCOL.replace("<= 2 km/h", "<= -1 km/h"))
                .expect("written")
        },
        "runs.fp",
        "nothing-found",
        "were rejected first by",
    );
    refused(
        &|folder| {
            let path = folder.join("runs/measurement.csv");
            let text = fs::read_to_string(&path).expect("a record").replacen(
                "speed [km/h]",
                "sped [km/h]",
                1,
            );
            fs::write(path, text).expect("written");
        },
        "runs.fp",
        "unknown-channel",
        "speed",
    );
    // A table that names a run which is not there.
    let folder = campaign();
    fs::write(folder.path().join("sections.csv"), "section,run,start [m],end [m]\nA,R2,100,200\n")
        .expect("written");
    fs::write(folder.path().join("campaign.yaml"), format!("{CAMPAIGN}sections: sections.csv\n"))
        .expect("written");
    let ran = certify(folder.path(), &["--protocol", &path(&folder, "runs.fp")]).ran;
    assert!(
        ran.stderr.contains("error[unknown-run]") && ran.stderr.contains("did you mean `R1`?"),
        "{}",
        ran.stderr
    );
}
