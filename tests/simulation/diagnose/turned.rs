//! What the generator of `examples/turned_campaigns` says of its campaigns holds.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::{copy, fishplate, folder};
use crate::hidden;

#[path = "../../../examples/turned_campaigns/base.rs"]
mod base;
#[path = "../../../examples/turned_campaigns/cases.rs"]
#[allow(dead_code)]
mod cases;
#[path = "../../../examples/turned_campaigns/draw.rs"]
mod draw;
#[path = "../../../examples/turned_campaigns/faults.rs"]
mod faults;
#[path = "../../../examples/turned_campaigns/turn.rs"]
mod turn;

use base::Base;
use cases::{Case, Hidden};

/// Channels of the record of section S01.
fn record(campaign: &Path, kind: &str) -> Vec<(String, Vec<f64>)> {
    let text = fs::read_to_string(campaign.join(kind).join("S01.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let column = |at: usize| rows[1..].iter().map(|row| row[at].parse().unwrap()).collect();
    rows[0]
        .iter()
        .enumerate()
        .map(|(at, heading)| (heading.split(' ').next().unwrap().to_string(), column(at)))
        .collect()
}

fn furthest(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

/// Of a campaign with a gain of 0.78 that its truth tells: the gain is taken off; payload is
/// missing in vehicle file and simulation, which go together; wind stands in the records as the
/// model's own increment; a gain as a factor.
#[test]
fn a_campaign_turned_round_hides_what_its_truth_says() {
    let (from, out) = (folder().join("to-turn"), folder().join("turned"));
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/coach-good"), &from);
    let gain =
        r#"{"effects": [{"name": "sensor_gain", "parameters": {"measurement.gain.Y_3R": 0.78}}]}"#;
    fs::write(from.join("truth.json"), gain).unwrap();
    let catalogue = hidden::catalogue().unwrap();
    let base = Base::open(&from, &catalogue).unwrap();
    let hide = |effects: &[&str], added: &[&str], vehicle: &[(&str, f64)]| Hidden {
        effects: effects.iter().map(ToString::to_string).collect(),
        added: added.iter().map(ToString::to_string).collect(),
        vehicle: vehicle.iter().map(|(key, value)| ((*key).to_string(), *value)).collect(),
    };
    let hidden = hide(
        &["payload=4000", "crosswind=9000", "sensor_gain=0.5 on Q_1L"],
        &["crosswind=9000"],
        &[("car_body.mass", base.value("car_body.mass") - 4000.0)],
    );
    turn::campaign(&out, &base, &Case { base: 0, kind: "pair", hidden, fault: None }, &catalogue)
        .unwrap();

    // The simulation is what the vehicle file makes of the track.
    let (again, windy, still) = (
        folder().join("turned-again"),
        folder().join("turned-windy"),
        folder().join("turned-still"),
    );
    let simulate = |campaign: &Path, to: &Path, further: &[&str]| {
        let ran = fishplate(
            &[
                &["simulate", campaign.to_str().unwrap(), "--out", to.to_str().unwrap(), "--quiet"],
                further,
            ]
            .concat(),
        );
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    };
    simulate(&out, &again, &[]);
    assert_eq!(
        fs::read(out.join("simulation/S01.csv")).unwrap(),
        fs::read(again.join("simulation/S01.csv")).unwrap()
    );
    let load = |campaign: &Path| -> f64 {
        let vehicle: serde_yaml::Value =
            serde_yaml::from_str(&fs::read_to_string(campaign.join("vehicle.yaml")).unwrap())
                .unwrap();
        let load = &vehicle["static_wheel_load"];
        // In kN, with the unit or without.
        load.as_f64().or_else(|| load.as_str()?.strip_suffix(" kN")?.parse().ok()).unwrap()
    };
    // Eight wheels carry four tonnes.
    assert!(
        (load(&from) - load(&out) - 4.0 * 9.81 / 8.0).abs() < 1e-3,
        "{} {}",
        load(&from),
        load(&out)
    );

    // Forces are written to 0.01 kN, three of them are compared with each other.
    simulate(&from, &windy, &["--effect", "crosswind=9000"]);
    simulate(&from, &still, &[]);
    let [before, after] = [&from, &out].map(|campaign| record(campaign, "measurement"));
    let [windy, still] = [&windy, &still].map(|campaign| record(campaign, "simulation"));
    let (distance, axis) = (before[1].1.clone(), still[1].1.clone());
    for (at, (name, before)) in
        before.iter().enumerate().filter(|(_, (name, _))| name.starts_with(['Y', 'Q']))
    {
        let column = |of: &[(String, Vec<f64>)]| {
            of.iter().find(|(known, _)| known == name).unwrap().1.clone()
        };
        let (windy, still) = (column(&windy), column(&still));
        let factor = if name == "Q_1L" { 0.5 } else { 1.0 };
        let taken_off = if name == "Y_3R" { 0.78 } else { 1.0 };
        let wind =
            windy.iter().zip(&still).map(|(windy, still)| windy - still).collect::<Vec<f64>>();
        // Linear between samples, as the distance steps evenly.
        let at_distance = |x: f64| {
            let place = ((x - axis[0]) / (axis[axis.len() - 1] - axis[0])
                * (axis.len() - 1) as f64)
                .clamp(0.0, (axis.len() - 1) as f64);
            let from = (place as usize).min(axis.len() - 2);
            wind[from] + (place - from as f64) * (wind[from + 1] - wind[from])
        };
        let expected: Vec<f64> = before
            .iter()
            .zip(&distance)
            .map(|(before, x)| factor * (before / taken_off + at_distance(*x)))
            .collect();
        let off = furthest(&expected, &after[at].1);
        assert!(off < 0.06, "{name}: {off} kN");
    }
    let truth: Value =
        serde_json::from_str(&fs::read_to_string(out.join("truth.json")).unwrap()).unwrap();
    let told = [
        ("payload", "payload.mass", 4000.0),
        ("crosswind", "crosswind.force", 9000.0),
        ("sensor_gain", "measurement.gain.Q_1L", 0.5),
    ];
    for (effect, (name, parameter, value)) in truth["effects"].as_array().unwrap().iter().zip(told)
    {
        assert_eq!(
            (effect["name"].as_str(), effect["parameters"][parameter].as_f64()),
            (Some(name), Some(value))
        );
    }

    // What is in no catalogue cannot be taken off.
    fs::write(
        from.join("truth.json"),
        r#"{"effects": [{"name": "temperature_drift", "parameters": {}}]}"#,
    )
    .unwrap();
    assert!(Base::open(&from, &catalogue).is_err());
    let drawn = cases::drawn(&[base], &catalogue, 3);
    let count = |kind: &str| drawn.iter().filter(|case| case.kind == kind).count();
    assert_eq!(["single", "none", "outside", "pair"].map(count), [36, 10, 20, 10]);
}
