//! The numbers of the shipped protocol, by what they do: each limit, and each edge from both sides.
//!
//! Source of the table: Goetz & Polach, "Verification and validation of simulations in a rail
//! vehicle certification context", Table 1 and sections 3.1 f. (limits, pairs, sections, full
//! curve, 70 m). Radii and the other lengths of the zones have no source at hand, as the protocol
//! says: here they only cannot change unseen.

use crate::common::texts::texts;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::common::campaign::{cell, certified, lines, tiny};
use fishplate::certify::compile;
use fishplate::check::{Overrides, family};
use fishplate::data::Campaign;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::result::{Certification, SectionResult, Verdict};
use fishplate::run::{Shifts, evaluate};
use fishplate::source::Source;
use fishplate::study::case::Case;

const ANNEX_T: &str = "en14363-2016-annex-t";

/// The protocol without its plausibility rules, which the made-up signals of [`tiny`] do not
/// satisfy.
fn numbers_alone() -> String {
    numbers_and("")
}

/// As [`numbers_alone`], with one of the rules.
fn numbers_and(kept: &str) -> String {
    let shipped = library::shipped(ANNEX_T).expect("the protocol");
    let rules = shipped.text.lines().filter_map(|line| line.strip_prefix("plausibility "));
    let names = rules.map(|rule| rule.split(' ').next().unwrap_or_default());
    let removed: String = names
        .filter(|name| *name != kept)
        .map(|name| format!("  plausibility  {name}\n"))
        .collect();
    format!("protocol numbers-alone \"Numbers alone\"\n  extends  {ANNEX_T}\n\nremove\n{removed}")
}

fn run(folder: &Path, set: &[&str]) -> Certification {
    run_by(&numbers_alone(), folder, set)
}

fn run_by(text: &str, folder: &Path, set: &[&str]) -> Certification {
    let protocol = folder.join("protocol.fp");
    fs::write(&protocol, text).expect("written");
    certified(folder, &protocol.display().to_string(), set)
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)))
}

/// Row of the first section of each zone in the table of [`tiny`], and its name.
const FIRST: [(usize, &str); 4] = [(1, "S01"), (4, "S04"), (7, "S07"), (10, "S10")];

/// The first section of a zone after one cell of it was changed.
fn changed(zone: usize, column: &str, value: &str, set: &[&str]) -> SectionResult {
    let folder = tiny();
    let (row, name) = FIRST[zone - 1];
    cell(&folder.path().join("sections.csv"), row, column, value);
    let found = run(folder.path(), set);
    found.sections.into_iter().find(|section| section.section == name).expect("the section")
}

#[track_caller]
fn edge(zone: usize, column: &str, inside: &[&str], outside: &[&str]) {
    for (values, used) in [(inside, true), (outside, false)] {
        for value in values {
            let section = changed(zone, column, value, &[]);
            assert_eq!(section.used, used, "zone {zone}, {column} {value}: {:?}", section.reason);
        }
    }
}

/// Zones by radius: above 600 m, 400 m to 600 m, 250 m to below 400 m.
#[test]
fn radii_of_the_zones() {
    edge(2, "radius [m]", &["600.001", "5000"], &["600", "500"]);
    edge(3, "radius [m]", &["600", "400"], &["600.001", "399.999"]);
    edge(4, "radius [m]", &["399.999", "250"], &["400", "249.999"]);
}

/// Very large radii belong to zone 1 up to a cant deficiency of 40 mm.
#[test]
fn curves_of_zone_1() {
    for (radius, deficiency, used) in
        [("2000", "40", true), ("2000", "40.001", false), ("600", "40", false)]
    {
        let folder = tiny();
        let table = folder.path().join("sections.csv");
        for (column, value) in
            [("direction", "right"), ("radius [m]", radius), ("cant deficiency [mm]", deficiency)]
        {
            cell(&table, 1, column, value);
        }
        let section = run(folder.path(), &[]).sections.remove(0);
        assert_eq!(section.used, used, "{radius} {deficiency}: {:?}", section.reason);
    }
}

/// 250, 100, 100 and 70 m: sections begin at 40 m and are just long enough.
#[test]
fn lengths_of_the_zones() {
    for (zone, length) in [(1, 250.0), (2, 100.0), (3, 100.0), (4, 70.0)] {
        let (enough, short) = (40.0 + length, 40.0 + length - 0.01);
        edge(zone, "end [m]", &[&enough.to_string()], &[&short.to_string()]);
    }
}

/// The limits of the standard deviation; those of the mean are two thirds of them.
#[test]
fn limits() {
    const Q0: f64 = 50.0;
    let wanted = [
        ("Y_qst", 5.0),
        ("Q_qst", 4.0 * (1.0 + 0.01 * Q0)),
        ("YQ_qst", 0.07),
        ("SigmaY_qst", 6.0),
        ("Y_max", 9.0),
        ("Q_max", 6.0 * (1.0 + 0.01 * Q0)),
        ("YQ_max", 0.10),
        ("SigmaY_max", 9.0),
        ("ay_rms", 0.15),
        ("az_rms", 0.15),
        ("ay_max", 0.40),
        ("az_max", 0.40),
    ];
    let folder = tiny();
    let found = run(folder.path(), &[]);
    let ids: Vec<&str> = found.quantities.iter().map(|quantity| quantity.id.as_str()).collect();
    assert_eq!(ids, wanted.map(|(id, _)| id));
    for (quantity, (id, std)) in found.quantities.iter().zip(wanted) {
        let limits: Vec<(String, f64)> = quantity
            .statistics
            .iter()
            .map(|statistic| (statistic.name.to_string(), statistic.limit.expect("a limit")))
            .collect();
        let [(std_name, first), (mean, second)] = &limits[..] else { panic!("{id}: {limits:?}") };
        assert_eq!([std_name, mean], ["std", "mean"], "{id}");
        assert!((first / std - 1.0).abs() < 1e-12, "{id}: {first}");
        assert!((second / (std * 2.0 / 3.0) - 1.0).abs() < 1e-12, "{id}: {second}");
        // Twelve sections; four wheels, else two wheelsets or two running gears.
        let signals =
            if ["Y_", "Q_", "YQ"].iter().any(|start| id.starts_with(start)) { 4 } else { 2 };
        assert_eq!(quantity.statistics[0].count, 12 * signals, "{id}");
    }
}

/// Three sections in each zone, and 24 pairs of each quantity, however few sections a zone needs.
#[test]
fn numbers_of_sections_and_pairs() {
    let folder = tiny();
    assert_eq!(run(folder.path(), &[]).verdict, Verdict::Validated);
    lines(&folder.path().join("sections.csv"), |lines| {
        lines.pop();
    });
    let found = run(folder.path(), &[]);
    assert_eq!(found.verdict, Verdict::NotAssessable);
    assert!(texts(&found.reasons).iter().any(|reason| reason.starts_with("zone 4 has 2 ")));
    let found = run(folder.path(), &["sections_per_zone=2"]);
    assert_eq!(found.verdict, Verdict::NotAssessable);
    let reasons = texts(&found.reasons);
    let told = reasons.iter().filter(|reason| reason.contains("22 pairs"));
    // Those with two signals a section; the six others have 44.
    assert_eq!(told.count(), 6, "{:?}", texts(&found.reasons));
}

/// A curve is full where its curvature stays within 2 % and 0.00001 1/m: at 500 m radius 0.00005
/// 1/m.
#[test]
fn full_curves() {
    for (range, used) in [(4.9e-5, true), (5.1e-5, false)] {
        let folder = tiny();
        let yaml = folder.path().join("campaign.yaml");
        let text = fs::read_to_string(&yaml).expect("readable");
        fs::write(&yaml, text + "track: track\n").expect("written");
        fs::create_dir(folder.path().join("track")).expect("a folder");
        let table = fs::read_to_string(folder.path().join("sections.csv")).expect("readable");
        for (at, row) in table.lines().skip(1).enumerate() {
            let cells: Vec<&str> = row.split(',').collect();
            // Radius in the fifth column; straight track has none.
            let radius: f64 = cells[4].parse().unwrap_or(f64::INFINITY);
            let mut record = "distance [m],curvature [1/m],cant [mm]\n".to_string();
            for x in (0..=400).step_by(10) {
                let wave = if at == 6 { range / 2.0 * f64::from(x / 10 % 2 * 2 - 1) } else { 0.0 };
                let _ = writeln!(record, "{x},{:.9},100", 1.0 / radius + wave);
            }
            let name = format!("{}.csv", cells[0]);
            fs::write(folder.path().join("track").join(name), record).expect("written");
        }
        let found = run(folder.path(), &[]);
        let others = found.sections.iter().enumerate().filter(|(at, _)| *at != 6);
        for (_, section) in others {
            assert!(section.used, "{}: {:?}", section.section, section.reason);
        }
        assert_eq!(found.sections[6].used, used, "{range}: {:?}", found.sections[6].reason);
    }
}

/// Values of a section that is refused are in no statistic, neither of the verdict nor of a study:
/// not even where it is refused for what its record holds, when its values are known already.
#[test]
fn refused_sections_are_not_pooled() {
    let folder = tiny();
    let path = folder.path();
    let protocol = numbers_and("static_load");
    let all = run_by(&protocol, path, &[]);
    // Another section of zone 4, as the first of it but with forces that nobody could miss.
    lines(&path.join("sections.csv"), |lines| {
        let row = lines[10].replacen("S10", "S13", 1);
        lines.push(row);
    });
    for (kind, factor) in [("measurement", 1.0), ("simulation", 100.0)] {
        let text = fs::read_to_string(path.join(kind).join("S10.csv")).expect("readable");
        let scaled = text.lines().enumerate().map(|(at, line)| {
            let cells =
                line.split(',').enumerate().map(|(column, cell)| match cell.parse::<f64>() {
                    Ok(number) if at > 0 && column > 1 => (number * factor).to_string(),
                    _ => cell.to_string(),
                });
            cells.collect::<Vec<_>>().join(",") + "\n"
        });
        fs::write(path.join(kind).join("S13.csv"), scaled.collect::<String>()).expect("written");
    }
    let found = run_by(&protocol, path, &[]);
    let last = found.sections.last().expect("a section");
    assert!(last.section == "S13" && !last.used, "{:?}", last.reason);
    assert_eq!(found.verdict, all.verdict);
    for (found, all) in found.quantities.iter().zip(&all.quantities) {
        assert!(found.values.iter().all(|pair| pair.section != "S13"), "{}", found.id);
        for (found, all) in found.statistics.iter().zip(&all.statistics) {
            assert_eq!((found.count, found.value), (all.count, all.value));
        }
    }
    assert!(found.domain.iter().all(|range| range.count <= 12));

    let mut problems = Problems::default();
    let source = Source::new("protocol.fp", protocol);
    let family = family::read(&source, &library::parent, &mut problems);
    let compiled = compile(family, &Overrides::new(), &mut problems).expect("a plan");
    let campaign = Campaign::open(path, &mut problems).expect("a campaign");
    let evaluated = evaluate(&compiled.plan, &compiled.graph, &campaign, &Shifts::NONE, &|_| {})
        .expect("values");
    let pool = evaluated[0].pool(&compiled.plan);
    assert!(!pool.sections[12].used);
    for quantity in &pool.quantities {
        assert!(
            quantity.values[12].is_empty() && !quantity.values[11].is_empty(),
            "{}",
            quantity.id
        );
    }
    let case = Case::of(&pool, None).expect("enough sections");
    assert_eq!(case.strata[3].members, [9, 10, 11]);
}
