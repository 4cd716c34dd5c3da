//! The diagnosis on a simulator that is a formula, so that its covariance and its sizes follow by
//! hand.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use fishplate::data::Campaign;
use fishplate::diagnose::answer::causes::interval;
use fishplate::diagnose::checks::heterogeneity::certain as heterogeneous;
use fishplate::diagnose::describe::trends::certain;
use fishplate::diagnose::inputs::{Inputs, Reference};
use fishplate::diagnose::run::{Found, find};
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

/// A force `stiffness * load - slack * (stiffness * load - rise * load^2)`: the more slack, the
/// more the rise matters.
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
    /// Of the force in all sections, in N.
    lift: f64,
    /// Factor of what is recorded, in the first section and in the last, along a line between.
    gain: (f64, f64),
}

const ALONE: usize = 5;
const NOTHING: Truth =
    Truth { slack: 0.0, off: 0.0, stiffness: 1.0, jump: 0.0, lift: 0.0, gain: (1.0, 1.0) };

struct Formula;

impl Simulator for Formula {
    fn name(&self) -> &'static str {
        "a formula"
    }

    fn catalogue_name(&self) -> Option<&str> {
        Some("formula")
    }

    fn run(&self, task: &Task<'_>) -> Result<Signals, Problem> {
        let value = |key: &str, otherwise: f64| {
            task.settings
                .iter()
                .find(|(name, _)| name == key)
                .map_or(otherwise, |(_, value)| *value)
        };
        let load = task.section.number("load").unwrap();
        let level =
            force(load, value("slack", 0.0), value("rise", RISE), value("stiffness", STIFFNESS));
        let axis: Vec<f64> = (0..400).map(|at| f64::from(at) * 0.1).collect();
        let values = vec![level; axis.len()];
        Ok(Signals {
            axis,
            over_time: false,
            rate: 100.0,
            channels: vec![Channel { name: "F".into(), values }],
        })
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
  covariates: [load, 1 / load, zone]
  tolerances:
    rise: {default: 0.05, scales: [rise]}
";

/// In a line more, a tolerance of the stiffness.
const STIFFNESS_TOLERANCE: &str = "    stiffness: {default: 0.02, scales: [stiffness]}\n";

fn campaign(folder: &Path, truth: Truth) {
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    let paths = "vehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\n";
    write("campaign.yaml", &format!("name: a formula\n{paths}sampling_rate [Hz]: 100\n"));
    write(
        "vehicle.yaml",
        &format!("name: none\ncategory: passenger\nrise: {RISE}\nstiffness: {STIFFNESS}\n"),
    );
    let mut table = "section,zone [-],start [m],end [m],load [-]\n".to_string();
    for (at, load) in LOADS.iter().enumerate() {
        writeln!(table, "S{at},1,0,39.9,{load}").unwrap();
        let measured = force(
            *load,
            truth.slack,
            RISE * (1.0 + truth.off * RISE_SD),
            STIFFNESS * truth.stiffness,
        );
        let measured = measured + truth.lift + if at == ALONE { truth.jump } else { 0.0 };
        let (first, last) = truth.gain;
        let measured = measured * (first + (last - first) * at as f64 / (LOADS.len() - 1) as f64);
        let truths =
            [("simulation", force(*load, 0.0, RISE, STIFFNESS)), ("measurement", measured)];
        for (kind, level) in truths {
            let mut record = "time [s],distance [m],F [N]\n".to_string();
            (0..400).for_each(|at| {
                writeln!(record, "{},{},{level}", f64::from(at) * 0.01, f64::from(at) * 0.1)
                    .unwrap()
            });
            write(&format!("{kind}/S{at}.csv"), &record);
        }
    }
    write("sections.csv", &table);
}

fn found(effects: &str, truth: Truth) -> Found {
    found_by(effects, truth, &[]).0
}

/// `known` are campaigns whose state is known.
fn found_by(effects: &str, truth: Truth, known: &[Truth]) -> (Found, Settings) {
    let folder = tempfile::tempdir().unwrap();
    campaign(folder.path(), truth);
    let mut problems = Problems::default();
    let source = Source::new("effects.yaml", effects);
    let catalogue = fishplate::effects::read(
        &source,
        &library::parent_catalogue,
        &model_parameters(),
        &mut problems,
    );
    let settings =
        catalogue.as_ref().and_then(|catalogue| Settings::read(catalogue, &mut problems));
    let campaign = Campaign::open(folder.path(), &mut problems);
    let (Some(catalogue), Some(settings), Some(campaign)) = (catalogue, settings, campaign) else {
        panic!("{}", problems.render(false))
    };
    let known: Vec<(tempfile::TempDir, Campaign)> = known
        .iter()
        .map(|truth| {
            let folder = tempfile::tempdir().unwrap();
            self::campaign(folder.path(), *truth);
            let campaign = Campaign::open(folder.path(), &mut problems).unwrap();
            (folder, campaign)
        })
        .collect();
    let references: Vec<Reference<'_>> = known
        .iter()
        .map(|(_, campaign)| Reference { campaign, simulator: Some(&Formula), cache: None })
        .collect();
    let inputs = Inputs {
        campaign: &campaign,
        catalogue: &catalogue,
        settings: &settings,
        simulator: Some(&Formula),
        cache: None,
        references: &references,
        seed: 1,
        trying: &|_| {},
    };
    let all: Vec<Section> = sections(&campaign, &mut problems).unwrap();
    let found =
        find(&inputs, all, &mut problems).unwrap_or_else(|| panic!("{}", problems.render(false)));
    (found, settings)
}

/// `a' C^-1 r / a' C^-1 a` where C has the variance of a level on its diagonal and one column c
/// besides: a' (v I + c c')^-1 b = (a'b - a'c c'b / (v + c'c)) / v.
fn least_squares(change: &[f64], column: &[f64], difference: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let v = LEVEL_SD * LEVEL_SD;
    let product = |a: &[f64], b: &[f64]| {
        (dot(a, b) - dot(a, column) * dot(column, b) / (v + dot(column, column))) / v
    };
    product(change, difference) / product(change, change)
}

/// One section of eight is off by 30 N: it stands out alone.
#[test]
fn what_stands_out_in_a_section_alone_is_told() {
    let found = found(EFFECTS, Truth { slack: 0.8, jump: 30.0, ..NOTHING });
    assert_eq!(found.answer.chosen.members.len(), 1, "{:?}", found.answer.refused);
    assert_eq!(found.answer.lack_after[0].alone, [ALONE]);
}

/// With the slack found, the rise matters by `size + SLACK` and no more by `SLACK`. The size is
/// that of generalised least squares, `a' C^-1 r / a' C^-1 a` with the change `a` per slack (Aitken
/// 1936): first by the covariance without slack, then by the covariance where that puts it.
#[test]
fn tolerances_are_weighed_as_they_act_beside_what_is_found() {
    let truth = 0.8;
    let found = found(EFFECTS, Truth { slack: truth, off: 1.5, ..NOTHING });
    let [member] = &found.answer.chosen.members[..] else {
        panic!("{:?}", found.answer.chosen.members.len())
    };
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
    near(&found.alone.covariance.shared[0], &column(0.0));
    near(&found.fitted.covariance.shared[0], &column(first));
    let wanted = size(&column(first));
    assert!((member.size - wanted).abs() < 1e-6, "{} for {wanted}", member.size);
    assert!((first - wanted).abs() > 0.01, "the test tells nothing");
}

/// Where the rise is off by seven of its standard deviations, the covariance without slack asks for
/// 1.175 of it, and the one where that puts it for a fifth less. The tolerances are those of that
/// point, where names changed last, and the size is the one that they ask for.
#[test]
fn tolerances_and_what_they_act_beside_are_found_together() {
    let off = 7.0;
    let found = found(EFFECTS, Truth { slack: 0.8, off, ..NOTHING });
    let [member] = &found.answer.chosen.members[..] else {
        panic!("{} members", found.answer.chosen.members.len())
    };
    let change = LOADS.map(|load| RISE * load * load - STIFFNESS * load);
    let difference = LOADS.map(|load| {
        force(load, 0.8, RISE * (1.0 + off * RISE_SD), STIFFNESS)
            - force(load, 0.0, RISE, STIFFNESS)
    });
    let size = |slack: f64| {
        let column = LOADS.map(|load| RISE_SD * (slack + SLACK) * RISE * load * load);
        least_squares(&change, &column, &difference)
    };
    let first = size(0.0);
    let beside =
        found.fitted.covariance.shared[0][0] / (RISE_SD * RISE * LOADS[0] * LOADS[0]) - SLACK;
    assert!((first / size(first) - 1.0).abs() > 0.1, "the test tells nothing: {first}");
    assert!((beside - first).abs() < 1e-6, "{beside} for {first}");
    assert!((member.size - size(beside)).abs() < 1e-6, "{} for {}", member.size, size(beside));
}

/// The interval of a size contains the size, and is narrow where the data are.
#[test]
fn a_size_has_an_interval() {
    let found = found(EFFECTS, Truth { slack: 0.8, ..NOTHING });
    assert!(
        interval(&found, &found.answer.chosen.members[0])
            .is_some_and(|(low, high)| 0.5 < low && low < 0.8 && 0.8 < high && high < 1.1)
    );
}

/// The force was recorded with the wrong sign: beside that, more rise lowers what is recorded as
/// much as it raised it before.
#[test]
fn tolerances_act_on_what_was_recorded() {
    let turned = "
  turned:
    title: Sign
    means: the wrong sign
    acts on: measuring chain
    operator: polarity
    channels: [forces]
    each: [forces]
    parameters:
      polarity.<channel>: {unit: '-', neutral: 1, default: -1, range: [-1, 1], trials: [-1], means: -1 where inverted}
diagnosis:";
    let found =
        found(&EFFECTS.replace("\ndiagnosis:", turned), Truth { gain: (-1.0, -1.0), ..NOTHING });
    let [member] = &found.answer.chosen.members[..] else {
        panic!("{:?}", found.answer.chosen.members.len())
    };
    assert_eq!(found.candidate(member).effect, "turned");
    for (at, load) in LOADS.iter().enumerate() {
        let wanted = RISE_SD * SLACK * RISE * load * load;
        let (before, beside) =
            (found.alone.covariance.shared[0][at], found.fitted.covariance.shared[0][at]);
        assert!(
            (before - wanted).abs() < 1e-6 * wanted && (beside + wanted).abs() < 1e-6 * wanted,
            "{before} and {beside} for {wanted}"
        );
    }
}

/// Of a tolerance that each section has for itself, seven tenths are common to all: a column over
/// all sections of 0.7 standard deviations, and a whole one in each.
#[test]
fn of_a_tolerance_of_single_sections_all_have_a_part_in_common() {
    let effects =
        EFFECTS.replace("default: 0.05,", "default: 0.05, each section: true, shared: 0.7,");
    let found = found(&effects, NOTHING);
    let whole = LOADS.map(|load| RISE_SD * SLACK * RISE * load * load);
    assert_eq!(
        (found.alone.covariance.shared.len(), found.alone.covariance.inside.len()),
        (1, LOADS.len())
    );
    for (at, whole) in whole.iter().enumerate() {
        assert!((found.alone.covariance.shared[0][at] - 0.7 * whole).abs() < 1e-6 * whole);
        let (section, own) = &found.alone.covariance.inside[at];
        assert!(*section == at && (own[0] - whole).abs() < 1e-6 * whole);
    }
}

/// Half a standard deviation of the rise is expected, and there. Without slack that is little; with
/// the slack that is found it is nine times as much, and that is taken off: the size is that of
/// generalised least squares with both as they act there.
#[test]
fn what_is_expected_of_a_tolerance_is_what_it_does_beside_what_is_found() {
    let (truth, expected) = (0.8, 0.5);
    let effects = EFFECTS.replace("default: 0.05,", "default: 0.05, expected: 0.5,");
    let found = found(&effects, Truth { slack: truth, off: expected, ..NOTHING });
    let [member] = &found.answer.chosen.members[..] else {
        panic!("{:?}", found.answer.chosen.members.len())
    };
    let change = LOADS.map(|load| RISE * load * load - STIFFNESS * load);
    let size = |slack: f64| {
        let column = LOADS.map(|load| RISE_SD * (slack + SLACK) * RISE * load * load);
        let difference = std::array::from_fn::<f64, 8, _>(|at| {
            let load = LOADS[at];
            let measured = force(load, truth, RISE * (1.0 + expected * RISE_SD), STIFFNESS);
            measured - force(load, 0.0, RISE, STIFFNESS) - expected * column[at]
        });
        least_squares(&change, &column, &difference)
    };
    let first = size(0.0);
    let wanted = size(first);
    assert!((member.size - wanted).abs() < 1e-6, "{} for {wanted}", member.size);
    assert!(
        (wanted - truth).abs() < 0.1 * (first - truth).abs(),
        "{first} and {wanted} for {truth}"
    );
}

/// A stiffness of 1.9 times what is assumed raises the force in proportion to the load, which a
/// slack of some size does in part. No effect stands for it: that the stiffness explains more is
/// told, with its distance of 0.9 / 0.02 = 45 declared standard deviations. With a true slack it is
/// not.
#[test]
fn a_parameter_that_no_effect_moves_is_told_with_its_deviation() {
    let effects = format!("{EFFECTS}{STIFFNESS_TOLERANCE}");
    let raised = found(&effects, Truth { stiffness: 1.9, ..NOTHING }).answer.further;
    let free = raised.suspect().or(raised.tolerance.as_ref()).expect("a tolerance").clone();
    assert!(free.parameter == "stiffness" && (free.deviations - 45.0).abs() < 1.0, "{free:?}");
    let slack = found(&effects, Truth { slack: 0.8, ..NOTHING }).answer.further;
    assert!(slack.suspect().is_none(), "{slack:?}");
}

/// Two newtons in one section of eight, downwards: their mean over the cell, their root mean
/// square, and their probability by the covariance of one column c and the variance v of a level:
/// chi-squared is 4 (1 - c_5^2 / (v + c'c)) / v, with eight degrees of freedom.
#[test]
fn a_cell_tells_mean_and_root_mean_square_of_its_differences() {
    use statrs::distribution::{ChiSquared, ContinuousCDF};
    let (found, settings) = found_by(EFFECTS, Truth { jump: -2.0, ..NOTHING }, &[]);
    let places = fishplate::diagnose::describe::locate::locate(&settings, &found, &Vec::new());
    let [place] = &places[..] else { panic!("{places:?}") };
    assert!((place.difference - 2.0 / 8.0).abs() < 1e-9, "{}", place.difference);
    assert!((place.difference_rms - 2.0 / 8.0_f64.sqrt()).abs() < 1e-9, "{}", place.difference_rms);
    assert!((place.share_of_gap - 1.0).abs() < 1e-12);
    let (column, v) = (&found.alone.covariance.shared[0], LEVEL_SD * LEVEL_SD);
    let chi =
        4.0 * (1.0 - column[ALONE].powi(2) / (v + column.iter().map(|c| c * c).sum::<f64>())) / v;
    let wanted = ChiSquared::new(8.0).unwrap().sf(chi);
    assert!(
        (place.p_value / wanted - 1.0).abs() < 1e-6 && place.significant,
        "{} for {wanted}",
        place.p_value
    );
}

/// What was measured is half a newton more than was simulated, everywhere: both say -0.5 N,
/// simulated - measured.
#[test]
fn diagnosis_and_certification_tell_a_difference_with_the_same_sign() {
    const PROTOCOL: &str = "protocol sign \"Sign\"\n  axis distance in m\n  time time in s\nchannel F \"Force\"\n  in N\n\
        sections\n  use sections\nquantity F_mean \"Mean force\"\n  of F\n  value mean\n  difference signed\n  limit mean 9 N\n\
        verdict\n  validated when every limit holds\n";
    let truth = Truth { lift: 0.5, ..NOTHING };
    let (found, settings) = found_by(EFFECTS, truth, &[]);
    let places = fishplate::diagnose::describe::locate::locate(&settings, &found, &Vec::new());
    let [place] = &places[..] else { panic!("{places:?}") };
    let folder = tempfile::tempdir().unwrap();
    campaign(folder.path(), truth);
    let mut problems = Problems::default();
    let family = fishplate::check::family::read(
        &Source::new("sign.fp", PROTOCOL),
        &library::parent,
        &mut problems,
    );
    let compiled =
        fishplate::certify::compile(family, &fishplate::check::Overrides::new(), &mut problems);
    let opened = Campaign::open(folder.path(), &mut problems);
    let (Some(compiled), Some(opened)) = (compiled, opened) else {
        panic!("{}", problems.render(false))
    };
    let run = fishplate::run::Settings { traces: 0 };
    let certified = fishplate::certify::certify(&compiled, &opened, run, &|_| {})
        .unwrap_or_else(|all| panic!("{}", all.render(false)));
    let mean = certified.quantities[0].statistics[0].value.expect("a mean");
    assert!(
        (mean + 0.5).abs() < 1e-9 && (place.difference - mean).abs() < 1e-9,
        "{mean} and {}",
        place.difference
    );
}

/// A stiffness of 1.2 times what is assumed lifts the force by 0.2 (1 - slack) stiffness times the
/// load: 1.26 N from the least load to the most, whatever the covariance, and as much from the
/// first section to the last, loads being in order. Its error is that of generalised least squares
/// with the covariance written out.
#[test]
fn a_difference_that_grows_with_a_column_is_told_with_its_slope() {
    let (found, settings) = found_by(EFFECTS, Truth { stiffness: 1.2, ..NOTHING }, &[]);
    let (trends, together) =
        fishplate::diagnose::describe::trends::trends(&settings, &found, &Vec::new());
    let over = |name: &str| {
        trends
            .iter()
            .find(|trend| trend.covariate == name)
            .unwrap_or_else(|| panic!("no trend over {name}"))
    };
    let load = over("load");
    // Simulated - measured.
    let wanted = -0.2 * (1.0 - SLACK) * STIFFNESS * (LOADS[7] - LOADS[0]);
    assert!((load.before.change - wanted).abs() < 1e-6, "{} for {wanted}", load.before.change);
    assert!((load.before.correlation + 1.0).abs() < 1e-9);
    assert_eq!((load.from.as_str(), load.to.as_str()), ("1", "4.5"));
    // Of the matrix X' C^-1 X, X = [1, scaled load], the lower right of the inverse.
    let column = &found.alone.covariance.shared[0];
    let ones = [1.0; 8];
    let scaled = LOADS.map(|load| (load - LOADS[0]) / (LOADS[7] - LOADS[0]));
    let product = |a: &[f64; 8], b: &[f64; 8]| {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let v = LEVEL_SD * LEVEL_SD;
        (dot(a, b) - dot(a, column) * dot(column, b) / (v + dot(column, column))) / v
    };
    let (aa, ab, bb) = (product(&ones, &ones), product(&ones, &scaled), product(&scaled, &scaled));
    let error = (aa / (aa * bb - ab * ab)).sqrt();
    assert!(
        (load.before.high - wanted - 1.645 * error).abs() < 1e-6,
        "{} for {}",
        load.before.high,
        wanted + 1.645 * error
    );
    assert!((over("the order of the sections").before.change - wanted).abs() < 1e-6);
    // 12.6 standard errors: no chance among a few trends. Nothing grows with nothing. Six trends:
    // their chance is below 1e-5 from 4.79 standard errors on, which lies between 1.26 and 1.28
    // times the stiffness.
    let (head, tail) = (EFFECTS.find("effects:").unwrap(), EFFECTS.find("diagnosis:").unwrap());
    let no_effects = format!("{}effects: {{}}\n{}", &EFFECTS[..head], &EFFECTS[tail..]);
    for (stiffness, sure) in [(1.26, false), (1.28, true)] {
        let (found, settings) = found_by(&no_effects, Truth { stiffness, ..NOTHING }, &[]);
        let errors = (stiffness - 1.0) / 0.2 * -wanted / error;
        assert!(found.answer.chosen.members.is_empty() && (errors > 4.79) == sure, "{errors}");
        assert_eq!(
            certain(
                &fishplate::diagnose::describe::trends::trends(&settings, &found, &Vec::new()).0
            ),
            sure
        );
    }
    assert_eq!(over("1 / load").from, "load 4.5", "the reciprocal is least where the load is most");
    assert!(
        trends.iter().all(|trend| trend.covariate != "zone"),
        "what is the same everywhere is no covariate"
    );
    assert!(
        together.iter().any(|pair| pair.starts_with("the order of the sections and load (1.00)")),
        "{together:?}"
    );
}

/// A gain that falls from the first section to the last has no single size: the last third asks for
/// less of it than the first. A constant gain has one.
#[test]
fn a_gain_that_is_not_the_same_all_along_is_told() {
    let slack = EFFECTS.find("  slack:").unwrap();
    let tail = EFFECTS.find("diagnosis:").unwrap();
    let gain = "  gain:
    title: Gain
    means: a factor
    acts on: measuring chain
    operator: gain
    channels: [forces]
    together: [forces]
    parameters:
      gain.<channel>: {unit: '-', neutral: 1, default: 0.8, range: [0.3, 1.5], trials: [0.5, 1.5], means: factor}
";
    let effects = format!("{}{gain}{}", &EFFECTS[..slack], &EFFECTS[tail..]);
    let tests = |fall: f64| {
        let found = found(&effects, Truth { gain: (0.7, 0.7 - fall), ..NOTHING });
        assert_eq!(found.answer.chosen.members.len(), 1, "{:?}", found.answer.refused);
        found.answer.heterogeneity
    };
    assert!(heterogeneous(&tests(0.0)).is_none());
    let all = tests(0.3);
    let told = heterogeneous(&all).expect("no single size");
    assert_eq!(told.view, "the order of the sections");
    // As a share of the change of the gain, which is negative.
    let deviation =
        |part: &str| told.parts.iter().find(|(name, ..)| name == part).expect("a third").1;
    let [first, last] = [0, LOADS.len() - 1].map(|at| format!("sections near S{at}"));
    assert!(deviation(&last) > 0.0 && deviation(&first) < 0.0, "{told:?}");
}

/// An effect that moves the stiffness, beside the slack.
fn stiff(effects: &str) -> String {
    let stiff = "  stiff:
    title: Stiff
    means: it is stiffer
    acts on: vehicle
    parameters:
      stiffness: {unit: '-', neutral: 2, default: 3, range: [0, 10], trials: [3, 4, 5, 7, 9], means: stiffness, simulators: {formula: stiffness}}
";
    effects.replacen("diagnosis:", &format!("{stiff}diagnosis:"), 1)
}

/// What slack takes from the force grows with the stiffness k: the force is (0.9 - slack) k load +
/// 3 (0.1 + slack) load^2, by 1.8 load more where k is 6 and the slack 0.3. Their changes alone,
/// -0.6 load of the slack and 0.9 (k - 2) load of the stiffness, would ask for a k of 4.67.
/// Simulated beside each other both come out as they are.
#[test]
fn a_further_effect_is_what_it_is_beside_the_first() {
    let found = found(&stiff(EFFECTS), Truth { slack: 0.3, stiffness: 3.0, ..NOTHING });
    let near = |effect: &str, truth: f64| {
        let member = found
            .answer
            .chosen
            .members
            .iter()
            .find(|member| found.candidate(member).effect == effect);
        let size = member.unwrap_or_else(|| panic!("no {effect}: {:?}", found.answer.refused)).size;
        assert!((size / truth - 1.0).abs() < 0.01, "{effect}: {size}");
    };
    near("slack", 0.3);
    near("stiff", 6.0);
}

/// The same stiffness with an effect that moves it: what is named is that, and it is no suspect
/// beside itself.
#[test]
fn a_parameter_that_an_effect_moves_is_no_suspect() {
    let effects = stiff(&format!("{EFFECTS}{STIFFNESS_TOLERANCE}"));
    let found = found(&effects, Truth { stiffness: 1.9, ..NOTHING });
    let [member] = &found.answer.chosen.members[..] else {
        panic!("{} members", found.answer.chosen.members.len())
    };
    assert!(
        found.candidate(member).effect == "stiff" && (member.size - 1.9 * STIFFNESS).abs() < 1e-6,
        "{}",
        member.size
    );
    assert!(!found.answer.further.refutes(), "{:?}", found.answer.further);
}

/// One column of 2 N for all sections, three quarters of whose variance stands. Two references that
/// are off by 1.5 N and 1.1 N say what it is, by Bayes' rule for a single number: the eight
/// sections of each weigh 8 / (v + 8 * 2^2 / 4). What is expected of it is taken off, and what is
/// left of it is in the covariance.
#[test]
fn what_stands_is_learnt_from_campaigns_of_known_state() {
    let (sd, lifts, own) = (2.0, [1.5, 1.1], 0.25);
    let tolerances = EFFECTS.find("  tolerances:").unwrap();
    let effects = format!(
        "{}  discrepancies: [{{of: level, channels: {{F: 1}}, sd: {sd}}}]\n",
        &EFFECTS[..tolerances]
    );
    let known = lifts.map(|lift| Truth { lift, ..NOTHING });
    let (found, _) = found_by(&effects, Truth { lift: 1.3, ..NOTHING }, &known);
    let weigh = 8.0 / (LEVEL_SD * LEVEL_SD + 8.0 * own * sd * sd);
    let stands = 1.0 - own;
    let variance = 1.0 / (1.0 + 2.0 * weigh * stands * sd * sd);
    let mean = variance * stands * sd * weigh * (lifts[0] + lifts[1]);
    for difference in &found.alone.difference {
        assert!(
            (difference - (1.3 - sd * mean)).abs() < 1e-9,
            "{difference} for {}",
            1.3 - sd * mean
        );
    }
    let [column] = &found.alone.covariance.shared[..] else {
        panic!("{} columns", found.alone.covariance.shared.len())
    };
    let wanted = sd * (own + stands * variance).sqrt();
    assert!(column.iter().all(|value| (value - wanted).abs() < 1e-9), "{column:?} for {wanted}");
}
