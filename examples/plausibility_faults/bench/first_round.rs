//! Faults of kinds that occur in real campaigns, one at a time, and the expected finding.

use super::fault::{Told, own, texts};
use super::folder::{Folder, SECTIONS, Side};
use super::signal::{deviation, each, mean};

pub struct Fault {
    pub name: &'static str,
    pub put: Box<dyn Fn(&mut Folder) -> Told + Send + Sync>,
}

const G: f64 = 9.806_65;

fn names(sections: Vec<String>, channels: &[&str]) -> Told {
    Told { sections, channels: texts(channels) }
}

fn fault(name: &'static str, put: impl Fn(&mut Folder) -> Told + Send + Sync + 'static) -> Fault {
    Fault { name, put: Box::new(put) }
}

fn of_vehicle(
    name: &'static str,
    key: &'static str,
    value: impl Fn(f64) -> String + Send + Sync + 'static,
) -> Fault {
    fault(name, move |folder| {
        let number = |old: &str| {
            old.split_whitespace().next().and_then(|first| first.parse().ok()).unwrap_or(0.0)
        };
        folder.vehicle(key, |old| value(number(old)));
        names(Vec::new(), &[])
    })
}

/// Channels multiplied by a factor in all sections.
fn scaled(
    name: &'static str,
    side: Side,
    begins: &'static [&'static str],
    factor: f64,
    told: &'static [&'static str],
) -> Fault {
    fault(name, move |folder| {
        let sections = folder.sections("");
        folder.channels(side, &sections, begins, |values| {
            values.iter().map(|value| value * factor).collect()
        });
        names(Vec::new(), told)
    })
}

/// A channel changed in the second section of a zone.
fn in_section(
    name: &'static str,
    side: Side,
    zone: &'static str,
    channel: &'static str,
    change: impl Fn(&[f64]) -> Vec<f64> + Send + Sync + 'static,
) -> Fault {
    fault(name, move |folder| {
        let section = folder.sections(zone)[1].clone();
        folder.channels(side, std::slice::from_ref(&section), &[channel], &change);
        Told { sections: vec![section], channels: own(channel) }
    })
}

fn held_from(from: f64, to: f64) -> impl Fn(&[f64]) -> Vec<f64> + Send + Sync {
    move |values| {
        let (a, b) = ((from * values.len() as f64) as usize, (to * values.len() as f64) as usize);
        each(values, |at, value| if (a..b).contains(&at) { values[a] } else { value })
    }
}

fn drifting(by: f64) -> impl Fn(&[f64]) -> Vec<f64> + Send + Sync {
    move |values| each(values, |at, value| value + by * at as f64 / values.len() as f64)
}

fn clipped(at: f64) -> impl Fn(&[f64]) -> Vec<f64> + Send + Sync {
    move |values| {
        let (mean, most) = (mean(values), at * deviation(values));
        values.iter().map(|value| mean + (value - mean).clamp(-most, most)).collect()
    }
}

fn coarse(step: f64) -> impl Fn(&[f64]) -> Vec<f64> + Send + Sync {
    move |values| values.iter().map(|value| (value / step).round() * step).collect()
}

/// White noise with twice the range of the signal, as of an open input.
fn hiss(values: &[f64]) -> Vec<f64> {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(*value), high.max(*value))
        });
    let mut state = 3_u64;
    let mut uniform = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    values.iter().map(|_| (high - low) * (2.0 * uniform() - 1.0)).collect()
}

/// Replaces columns of the records of some sections by others, by name.
fn copied(folder: &mut Folder, side: Side, sections: &[String], from: &str, to: &str) {
    for kind in side.folders() {
        for section in sections {
            let record = folder.record_mut(&format!("{kind}/{section}.csv"));
            record.set(to, record.values(from).to_vec());
        }
    }
}

fn exchanged(folder: &mut Folder, side: Side, sections: &[String], a: &str, b: &str) {
    for kind in side.folders() {
        for section in sections {
            let record = folder.record_mut(&format!("{kind}/{section}.csv"));
            let (a, b) =
                (record.column(a).expect("a channel"), record.column(b).expect("a channel"));
            record.columns.swap(a, b);
        }
    }
}

fn along(
    name: &'static str,
    side: Side,
    column: &'static str,
    change: impl Fn(&[f64]) -> Vec<f64> + Send + Sync + 'static,
) -> Fault {
    fault(name, move |folder| {
        let sections = folder.sections("");
        folder.channels(side, &sections, &[column], &change);
        names(sections, &[])
    })
}

/// A record with reversed order.
fn mirrored(name: &'static str, side: Side) -> Fault {
    fault(name, move |folder| {
        let sections = folder.sections("");
        let own = ["Y", "Q", "a"];
        folder.channels(side, &sections, &own, |values| values.iter().rev().copied().collect());
        names(sections, &[])
    })
}

/// Replaces a record by another.
fn record(folder: &mut Folder, from: &str, to: &str) {
    let copy = folder.record(from).clone();
    folder.put(to, copy);
}

/// A cell of the table of sections in the second section of a zone.
fn in_table(
    name: &'static str,
    zone: &'static str,
    column: &'static str,
    change: impl Fn(&str) -> String + Send + Sync + 'static,
) -> Fault {
    fault(name, move |folder| {
        let section = folder.sections(zone)[1].clone();
        let cell = folder.cell(&section, column);
        *cell = change(cell);
        names(vec![section], &[])
    })
}

fn number(text: &str, change: impl Fn(f64) -> f64) -> String {
    format!("{}", change(text.parse().unwrap_or(0.0)))
}

const Y: &[&str] = &["Y"];
const Q: &[&str] = &["Q"];
const AY: &[&str] = &["ay_"];
const AZ: &[&str] = &["az_"];
const OF_Y: &[&str] = &["Y_", "SigmaY", "TotalY", "YQ_"];
const OF_Q: &[&str] = &["Q_", "SigmaQ", "DeltaQ", "YQ_"];
const OF_AY: &[&str] = &["ay_"];
const OF_AZ: &[&str] = &["az_"];

/// All faults, in groups of a kind.
pub fn all() -> Vec<Fault> {
    let mut all = vehicle();
    all.extend(units());
    all.extend(signs());
    all.extend(channels());
    all.extend(clocks_and_distances());
    all.extend(copies());
    all.extend(tables());
    all
}

fn vehicle() -> Vec<Fault> {
    let key = "static_wheel_load";
    let mut all = vec![
        of_vehicle("static wheel load in N", key, |q| format!("{}", 1000.0 * q)),
        of_vehicle("static wheel load 0", key, |_| "0".into()),
        of_vehicle("static wheel load negative", key, |q| format!("{}", -q)),
        of_vehicle("load of the axle", key, |q| format!("{}", 2.0 * q)),
        of_vehicle("load of the bogie", key, |q| format!("{}", 4.0 * q)),
        of_vehicle("load of the vehicle", key, |q| format!("{}", 8.0 * q)),
        of_vehicle("static wheel load in t", key, |q| format!("{}", q / G)),
        of_vehicle("half of the static wheel load", key, |q| format!("{}", 0.5 * q)),
    ];
    let word = |name, key: &'static str, value: &'static str| {
        fault(name, move |folder: &mut Folder| {
            folder.vehicle(key, |_| value.into());
            names(Vec::new(), &[])
        })
    };
    all.push(word("single axles for bogies", "running_gear", "single_axles"));
    all
}

fn units() -> Vec<Fault> {
    let (both, one, other) = (Side::Both, Side::Measurement, Side::Simulation);
    vec![
        scaled("forces in N on both sides", both, &["Y", "Q"], 1000.0, OF_Q),
        scaled("guiding forces in N on both sides", both, Y, 1000.0, OF_Y),
        scaled("guiding forces in MN on both sides", both, Y, 0.001, OF_Y),
        scaled("guiding forces in t on both sides", both, Y, 1.0 / G, OF_Y),
        scaled("guiding forces in daN on both sides", both, Y, 100.0, OF_Y),
        scaled("guiding forces 10 times on both sides", both, Y, 10.0, OF_Y),
        scaled("vertical forces in N on both sides", both, Q, 1000.0, OF_Q),
        scaled("vertical forces in t on both sides", both, Q, 1.0 / G, OF_Q),
        scaled("vertical forces 10 times on both sides", both, Q, 10.0, OF_Q),
        scaled("lateral acceleration in g on both sides", both, AY, 1.0 / G, OF_AY),
        scaled("lateral acceleration 9.81 times on both sides", both, AY, G, OF_AY),
        scaled("lateral acceleration in mm/s^2 on both sides", both, AY, 1000.0, OF_AY),
        scaled("vertical acceleration in g on both sides", both, AZ, 1.0 / G, OF_AZ),
        scaled("vertical acceleration 9.81 times on both sides", both, AZ, G, OF_AZ),
        scaled("vertical acceleration 1000 times on both sides", both, AZ, 1000.0, OF_AZ),
        scaled("guiding forces measured in N", one, Y, 1000.0, OF_Y),
        scaled("guiding forces measured in t", one, Y, 1.0 / G, OF_Y),
        scaled("guiding forces simulated 10 times", other, Y, 10.0, OF_Y),
        scaled("vertical forces measured in t", one, Q, 1.0 / G, OF_Q),
        scaled("vertical forces simulated in N", other, Q, 1000.0, OF_Q),
        scaled("lateral acceleration simulated in g", other, AY, 1.0 / G, OF_AY),
        scaled("lateral acceleration measured 9.81 times", one, AY, G, OF_AY),
        scaled("vertical acceleration measured in g", one, AZ, 1.0 / G, OF_AZ),
        scaled("vertical acceleration simulated 9.81 times", other, AZ, G, OF_AZ),
    ]
}

fn signs() -> Vec<Fault> {
    let (both, one, other) = (Side::Both, Side::Measurement, Side::Simulation);
    let turned = |values: &[f64]| values.iter().map(|value| -value).collect::<Vec<f64>>();
    vec![
        scaled("guiding forces turned on both sides", both, Y, -1.0, OF_Y),
        scaled("vertical forces turned on both sides", both, Q, -1.0, OF_Q),
        scaled("lateral acceleration turned on both sides", both, AY, -1.0, OF_AY),
        scaled("all forces turned on both sides", both, &["Y", "Q"], -1.0, OF_Q),
        scaled("guiding forces measured turned", one, Y, -1.0, OF_Y),
        scaled("vertical forces measured turned", one, Q, -1.0, OF_Q),
        scaled("lateral acceleration measured turned", one, AY, -1.0, OF_AY),
        scaled("vertical acceleration measured turned", one, AZ, -1.0, OF_AZ),
        scaled("vertical acceleration simulated turned", other, AZ, -1.0, OF_AZ),
        in_section("Y_1R measured turned in a section", one, "4", "Y_1R", turned),
        in_section("Y_3L simulated turned in a section", other, "3", "Y_3L", turned),
        in_section("ay_II simulated turned in a straight section", other, "1", "ay_II", turned),
        in_section("az_I measured turned in a section", one, "2", "az_I", turned),
        fault("left and right vertical forces exchanged on both sides", |folder| {
            let sections = folder.sections("");
            for wheelset in 1..=4 {
                let [right, left] = ["R", "L"].map(|side| format!("Q_{wheelset}{side}"));
                exchanged(folder, Side::Both, &sections, &right, &left);
            }
            names(Vec::new(), OF_Q)
        }),
        fault("guiding forces of two wheelsets exchanged in the measurement", |folder| {
            let sections = folder.sections("");
            exchanged(folder, Side::Measurement, &sections, "Y_1R", "Y_3L");
            names(Vec::new(), &["Y_1R", "Y_3L"])
        }),
        fault("accelerations of both ends exchanged in the measurement", |folder| {
            let sections = folder.sections("");
            exchanged(folder, Side::Measurement, &sections, "az_I", "az_II");
            names(Vec::new(), &["az_I", "az_II"])
        }),
        fault("noise in place of the acceleration az_I in a section", |folder| {
            let sections = folder.sections("").into_iter().take(1).collect::<Vec<_>>();
            folder.channels(Side::Measurement, &sections, &["az_I"], hiss);
            names(sections, &["az_I"])
        }),
        fault("left and right guiding forces exchanged on both sides", |folder| {
            let sections = folder.sections("");
            for wheelset in 1..=4 {
                let [right, left] = ["R", "L"].map(|side| format!("Y_{wheelset}{side}"));
                exchanged(folder, Side::Both, &sections, &right, &left);
            }
            names(Vec::new(), OF_Y)
        }),
    ]
}

fn channels() -> Vec<Fault> {
    let (both, one, other) = (Side::Both, Side::Measurement, Side::Simulation);
    let constant = |by: f64| move |values: &[f64]| vec![by; values.len()];
    vec![
        fault("all channels 1 on both sides", |folder| {
            let sections = folder.sections("");
            folder.channels(Side::Both, &sections, &["Y", "Q", "a"], |values| {
                vec![1.0; values.len()]
            });
            names(sections, &["Y_1R", "Q_1R"])
        }),
        in_section("Y_1R measured dead at 0", one, "4", "Y_1R", constant(0.0)),
        in_section("Q_3L measured dead at 54 kN", one, "2", "Q_3L", constant(54.0)),
        in_section("az_I simulated dead", other, "1", "az_I", constant(0.0)),
        in_section("ay_II dead on both sides", both, "3", "ay_II", constant(0.1)),
        in_section("Q_1L measured stuck from the middle on", one, "3", "Q_1L", held_from(0.5, 1.0)),
        in_section("Y_3R measured stuck for a fifth", one, "1", "Y_3R", held_from(0.4, 0.6)),
        in_section("az_II measured stuck for a tenth", one, "4", "az_II", held_from(0.45, 0.55)),
        in_section("Y_1R measured drifts by 25 kN", one, "1", "Y_1R", drifting(25.0)),
        in_section("Q_1L measured drifts by 40 kN", one, "2", "Q_1L", drifting(40.0)),
        in_section("ay_I measured drifts by 2 m/s^2", one, "1", "ay_I", drifting(2.0)),
        in_section("az_I measured drifts by 3 m/s^2", one, "3", "az_I", drifting(3.0)),
        in_section("Y_1L measured saturated", one, "3", "Y_1L", clipped(1.2)),
        in_section("az_II measured saturated", one, "2", "az_II", clipped(1.5)),
        in_section("Q_3R simulated saturated", other, "4", "Q_3R", clipped(1.2)),
        in_section("ay_I measured saturated", one, "1", "ay_I", clipped(1.5)),
        in_section("Y_1R measured in steps of 5 kN", one, "3", "Y_1R", coarse(5.0)),
        in_section("Q_1R measured in steps of 10 kN", one, "2", "Q_1R", coarse(10.0)),
        in_section("az_I measured in steps of 0.5 m/s^2", one, "1", "az_I", coarse(0.5)),
        in_section("ay_II measured in steps of 0.5 m/s^2", one, "4", "ay_II", coarse(0.5)),
    ]
}

fn clocks_and_distances() -> Vec<Fault> {
    let (both, one, other) = (Side::Both, Side::Measurement, Side::Simulation);
    let times = |factor: f64| {
        move |values: &[f64]| values.iter().map(|value| value * factor).collect::<Vec<f64>>()
    };
    let plus =
        |by: f64| move |values: &[f64]| values.iter().map(|value| value + by).collect::<Vec<f64>>();
    vec![
        along("clock fast by a fifth on both sides", both, "time", times(1.2)),
        along("clock twice as fast in the measurement", one, "time", times(2.0)),
        along("clock slow by a fifth in the measurement", one, "time", times(1.0 / 1.2)),
        along("clock twice as fast in the simulation", other, "time", times(2.0)),
        along("distance of the measurement shifted by 6 m", one, "distance", plus(6.0)),
        along("distance of the measurement shifted by -12 m", one, "distance", plus(-12.0)),
        along("distance of the measurement scaled by 1.08", one, "distance", times(1.08)),
        along("distance of the simulation scaled by 1.03", other, "distance", times(1.03)),
        mirrored("measurement mirrored", one),
        mirrored("simulation mirrored", other),
    ]
}

fn copies() -> Vec<Fault> {
    let (both, one, other) = (Side::Both, Side::Measurement, Side::Simulation);
    let channel =
        |name, side: Side, from: &'static str, to: &'static str, told: &'static [&'static str]| {
            fault(name, move |folder: &mut Folder| {
                let sections = folder.sections("");
                copied(folder, side, &sections, from, to);
                names(sections, told)
            })
        };
    let section = |name, side: Side| {
        fault(name, move |folder: &mut Folder| {
            let all = folder.sections("4");
            for kind in side.folders() {
                record(
                    folder,
                    &format!("{kind}/{}.csv", all[0]),
                    &format!("{kind}/{}.csv", all[1]),
                );
            }
            for column in ["start", "end"] {
                let value = folder.cell(&all[0], column).clone();
                *folder.cell(&all[1], column) = value;
            }
            names(vec![all[1].clone()], &["Y_1R"])
        })
    };
    vec![
        channel("Y_1R measured is a copy of Y_1L", one, "Y_1L", "Y_1R", &["Y_1R"]),
        channel("Y_3R simulated is a copy of Y_1R", other, "Y_1R", "Y_3R", &["Y_3R"]),
        channel("az_II measured is a copy of az_I", one, "az_I", "az_II", &["az_II"]),
        channel("Q_3L is a copy of Q_1L on both sides", both, "Q_1L", "Q_3L", &["Q_3L"]),
        section("a section is a copy of another, on both sides", both),
        section("the measurement of a section is that of another", one),
        fault("the measurement is a copy of the simulation", |folder| {
            let sections = folder.sections("");
            for section in &sections {
                record(
                    folder,
                    &format!("simulation/{section}.csv"),
                    &format!("measurement/{section}.csv"),
                );
            }
            names(sections, &["Y_1R"])
        }),
        fault("Q_1R measured is a copy of the simulation in a section", |folder| {
            let section = folder.sections("3")[1].clone();
            let values =
                folder.record(&format!("simulation/{section}.csv")).values("Q_1R").to_vec();
            folder.record_mut(&format!("measurement/{section}.csv")).set("Q_1R", values);
            names(vec![section], &["Q_1R"])
        }),
        fault("one section three times in its zone", |folder| {
            let all = folder.sections("2");
            all[1..3].iter().for_each(|other| same(folder, &all[0], other));
            names(all[1..3].to_vec(), &["Y_1R"])
        }),
        fault("a section is another one under its name", |folder| {
            let all = folder.sections("1");
            same(folder, &all[0], &all[1]);
            names(vec![all[1].clone()], &["Y_1R"])
        }),
    ]
}

/// The records and the row of a section under the name of another.
fn same(folder: &mut Folder, from: &str, to: &str) {
    for kind in ["simulation", "measurement", "track"] {
        record(folder, &format!("{kind}/{from}.csv"), &format!("{kind}/{to}.csv"));
    }
    let table = folder.tables.get_mut(SECTIONS).expect("a table");
    let first = table.rows.iter().find(|row| row[0] == from).expect("a section").clone();
    let row = table.rows.iter_mut().find(|row| row[0] == to).expect("a section");
    row[1..].clone_from_slice(&first[1..]);
}

fn tables() -> Vec<Fault> {
    vec![
        in_table("radius 10 % too large", "4", "radius", |text| {
            number(text, |radius| 1.1 * radius)
        }),
        in_table("radius of a large curve halved", "2", "radius", |text| {
            number(text, |radius| 0.5 * radius)
        }),
        in_table("direction turned", "3", "direction", |text| {
            if text == "right" { "left".into() } else { "right".into() }
        }),
        in_table("straight for a curve", "2", "direction", |_| "straight".into()),
        in_table("zone 3 for zone 4", "4", "zone", |_| "3".into()),
        in_table("zone 1 for zone 2", "2", "zone", |_| "1".into()),
        in_table("cant 50 mm too large", "3", "cant", |text| number(text, |cant| cant + 50.0)),
        in_table("cant deficiency 40 mm too large", "4", "cant deficiency", |text| {
            number(text, |cant| cant + 40.0)
        }),
        in_table("speed 15 % too large", "3", "speed", |text| number(text, |speed| 1.15 * speed)),
        in_table("speed in m/s", "1", "speed", |text| number(text, |speed| speed / 3.6)),
        fault("track file of another zone", |folder| {
            let (curve, straight) =
                (folder.sections("4")[1].clone(), folder.sections("1")[1].clone());
            record(folder, &format!("track/{straight}.csv"), &format!("track/{curve}.csv"));
            names(vec![curve], &[])
        }),
        fault("track file of a curve for a straight section", |folder| {
            let (curve, straight) =
                (folder.sections("4")[1].clone(), folder.sections("1")[1].clone());
            record(folder, &format!("track/{curve}.csv"), &format!("track/{straight}.csv"));
            names(vec![straight], &[])
        }),
    ]
}
