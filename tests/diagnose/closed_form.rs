//! The diagnosis on a simulator that is a formula, so that its covariance and its sizes follow by hand.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use fishplate::data::Campaign;
use fishplate::diagnose::run::{Found, Inputs, find};
use fishplate::diagnose::settings::Settings;
use fishplate::effects::{Channel, Signals};
use fishplate::library;
use fishplate::problem::{Problem, Problems};
use fishplate::simulate::{Section, Simulator, Task, model_parameters, sections};
use fishplate::source::Source;

/// Loads of the sections.
const LOADS: [f64; 8] = [1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5];
const STIFFNESS: f64 = 2.0;
const RISE: f64 = 3.0;
/// Of the rise, everywhere; the effect adds to it.
const SLACK: f64 = 0.1;
/// One standard deviation of the rise, as a share of it, and of a level in N.
const RISE_SD: f64 = 0.05;
const LEVEL_SD: f64 = 0.2;

/// A force `stiffness * load - slack * (stiffness * load - rise * load^2)`: the more slack, the more the rise matters.
fn force(load: f64, slack: f64, rise: f64, stiffness: f64) -> f64 {
    let all = slack + SLACK;
    stiffness * load - all * (stiffness * load - rise * load * load)
}

/// What the measurement has that the simulation has not.
#[derive(Clone, Copy)]
struct Truth {
    slack: f64,
    /// Standard deviations of the rise.
    off: f64,
    /// Factor of the stiffness.
    stiffness: f64,
    /// Of the force in the section number [`ALONE`], in N.
    jump: f64,
}

const ALONE: usize = 5;
const NOTHING: Truth = Truth { slack: 0.0, off: 0.0, stiffness: 1.0, jump: 0.0 };

struct Formula;

impl Simulator for Formula {
    fn name(&self) -> &'static str {
        "a formula"
    }

    fn catalogue_name(&self) -> Option<&str> {
        Some("formula")
    }

    fn run(&self, task: &Task<'_>) -> Result<Signals, Problem> {
        let value = |key: &str, otherwise: f64| task.settings.iter().find(|(name, _)| name == key).map_or(otherwise, |(_, value)| *value);
        let load = task.section.number("load").unwrap();
        let level = force(load, value("slack", 0.0), value("rise", RISE), value("stiffness", STIFFNESS));
        let axis: Vec<f64> = (0..400).map(|at| f64::from(at) * 0.1).collect();
        let values = vec![level; axis.len()];
        Ok(Signals { axis, over_time: false, rate: 100.0, channels: vec![Channel { name: "F".into(), values }] })
    }
}

const EFFECTS: &str = "
catalogue: formula
title: A formula
groups: {forces: [F]}
units: {forces: N}
effects:
  slack:
    title: Slack
    means: it hangs loose
    acts on: vehicle
    parameters:
      slack: {unit: '-', neutral: 0, default: 0.5, range: [0, 2], trials: [0.25, 0.5, 1, 1.5], means: share, simulators: {formula: slack}}
diagnosis:
  groups:
    forces: {unit: N, level: true, bands: 0, says: force, level sd: 0.2}
  tolerances:
    rise: {default: 0.05, scales: [rise]}
";

/// In a line more, the stiffness as a suspect.
const SUSPECT: &str = "    stiffness: {default: 0.02, suspects: true, scales: [stiffness]}\n";

fn campaign(folder: &Path, truth: Truth) {
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    let paths = "vehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\n";
    write("campaign.yaml", &format!("name: a formula\n{paths}sampling_rate [Hz]: 100\n"));
    write("vehicle.yaml", &format!("name: none\ncategory: passenger\nrise: {RISE}\nstiffness: {STIFFNESS}\n"));
    let mut table = "section,zone [-],start [m],end [m],load [-]\n".to_string();
    for (at, load) in LOADS.iter().enumerate() {
        writeln!(table, "S{at},1,0,39.9,{load}").unwrap();
        let measured = force(*load, truth.slack, RISE * (1.0 + truth.off * RISE_SD), STIFFNESS * truth.stiffness);
        let measured = measured + if at == ALONE { truth.jump } else { 0.0 };
        let truths = [("simulation", force(*load, 0.0, RISE, STIFFNESS)), ("measurement", measured)];
        for (kind, level) in truths {
            let mut record = "time [s],distance [m],F [N]\n".to_string();
            (0..400).for_each(|at| writeln!(record, "{},{},{level}", f64::from(at) * 0.01, f64::from(at) * 0.1).unwrap());
            write(&format!("{kind}/S{at}.csv"), &record);
        }
    }
    write("sections.csv", &table);
}

fn found(effects: &str, truth: Truth) -> Found {
    let folder = tempfile::tempdir().unwrap();
    campaign(folder.path(), truth);
    let mut problems = Problems::default();
    let source = Source::new("effects.yaml", effects);
    let catalogue = fishplate::effects::read(&source, &library::parent_catalogue, &model_parameters(), &mut problems);
    let settings = catalogue.as_ref().and_then(|catalogue| Settings::read(catalogue, &mut problems));
    let campaign = Campaign::open(folder.path(), &mut problems);
    let (Some(catalogue), Some(settings), Some(campaign)) = (catalogue, settings, campaign) else { panic!("{}", problems.render(false)) };
    let inputs = Inputs {
        campaign: &campaign,
        catalogue: &catalogue,
        settings: &settings,
        simulator: Some(&Formula),
        cache: None,
        references: &[],
        seed: 1,
        trying: &|_| {},
    };
    let all: Vec<Section> = sections(&campaign, &mut problems).unwrap();
    find(&inputs, all, &mut problems).unwrap_or_else(|| panic!("{}", problems.render(false)))
}

/// `a' C^-1 r / a' C^-1 a` where C has the variance of a level on its diagonal and one column c besides: a' (v I + c c')^-1 b =
/// (a'b - a'c c'b / (v + c'c)) / v.
fn least_squares(change: &[f64], column: &[f64], difference: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let v = LEVEL_SD * LEVEL_SD;
    let product = |a: &[f64], b: &[f64]| (dot(a, b) - dot(a, column) * dot(column, b) / (v + dot(column, column))) / v;
    product(change, difference) / product(change, change)
}

/// One section of eight is off by 30 N: it stands out alone, and the size is that of the seven others.
#[test]
fn what_stands_out_in_a_section_alone_does_not_pull_at_the_size() {
    let truth = 0.8;
    let found = found(EFFECTS, Truth { slack: truth, jump: 30.0, ..NOTHING });
    let [member] = &found.chosen.members[..] else { panic!("{:?}", found.refused) };
    assert_eq!(found.lack_after[0].alone, [ALONE]);
    let others = || LOADS.iter().enumerate().filter(|(at, _)| *at != ALONE).map(|(_, load)| *load);
    let change: Vec<f64> = others().map(|load| RISE * load * load - STIFFNESS * load).collect();
    let difference: Vec<f64> = others().map(|load| force(load, truth, RISE, STIFFNESS) - force(load, 0.0, RISE, STIFFNESS)).collect();
    let column: Vec<f64> = others().map(|load| found.beside.shared[0][LOADS.iter().position(|known| *known == load).unwrap()]).collect();
    let wanted = least_squares(&change, &column, &difference);
    assert!((wanted - truth).abs() < 1e-9 && (member.size - truth).abs() < 1e-6, "{} for {wanted}", member.size);
}

/// With the slack found, the rise matters by `size + SLACK` and no more by `SLACK`. The size is that of generalised least squares,
/// `a' C^-1 r / a' C^-1 a` with the change `a` per slack (Aitken 1936): first by the covariance without slack, then by the covariance
/// where that puts it.
#[test]
fn tolerances_are_weighed_as_they_act_beside_what_is_found() {
    let truth = 0.8;
    let found = found(EFFECTS, Truth { slack: truth, off: 1.5, ..NOTHING });
    let [member] = &found.chosen.members[..] else { panic!("{:?}", found.chosen.members.len()) };
    let column = |slack: f64| LOADS.map(|load| RISE_SD * (slack + SLACK) * RISE * load * load);
    let near = |seen: &[f64], wanted: &[f64]| {
        for (seen, wanted) in seen.iter().zip(wanted) {
            assert!((seen - wanted).abs() < 1e-6 * wanted.abs(), "{seen} for {wanted}");
        }
    };
    let change = LOADS.map(|load| RISE * load * load - STIFFNESS * load);
    let difference = LOADS.map(|load| {
        let simulated = force(load, 0.0, RISE, STIFFNESS);
        force(load, truth, RISE * (1.0 + 1.5 * RISE_SD), STIFFNESS) - simulated
    });
    let size = |column: &[f64]| least_squares(&change, column, &difference);
    let first = size(&column(0.0));
    near(&found.covariance.shared[0], &column(0.0));
    near(&found.settled.shared[0], &column(first));
    let wanted = size(&column(first));
    assert!((member.size - wanted).abs() < 1e-6, "{} for {wanted}", member.size);
    assert!((first - wanted).abs() > 0.01, "the test tells nothing");
}

/// A stiffness of 1.9 times what is assumed raises the force in proportion to the load, which a slack of some size does in part. No
/// effect stands for it: what is named is not the cause, and which parameter explains more is told. With a true slack it is not.
#[test]
fn a_parameter_that_no_effect_moves_is_a_suspect() {
    let effects = format!("{EFFECTS}{SUSPECT}");
    let raised = found(&effects, Truth { stiffness: 1.9, ..NOTHING });
    let suspect = raised.suspect.expect("a suspect");
    assert!(suspect.key == "stiffness" && (suspect.factor - 1.9).abs() < 1e-6, "{suspect:?}");
    assert!(suspect.evidence > suspect.answer, "{suspect:?}");
    assert!(found(&effects, Truth { slack: 0.8, ..NOTHING }).suspect.is_none());
}
