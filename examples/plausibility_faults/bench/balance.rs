//! Faults that only the balance of forces over the campaign shows: gains, offsets, drifts, facts of
//! the vehicle and of the sections, another state of load.

use std::path::Path;

use fishplate::data::Campaign;
use fishplate::problem::Problems;
use fishplate::simulate::{Builtin, Simulator, Task, sections};

use super::Kind;
use super::fault::{Draw, Fault, Size, Told, concerned, of_kind, own, texts};
use super::folder::{Folder, Side};
use super::signal::each;

/// Rules that name a gain of a kind of channels.
fn gain(kind: &str) -> &'static [&'static str] {
    match kind {
        "Y" => &["guiding_gain"],
        "Q" => &["total_load", "vertical_siblings"],
        "ay" => &["lateral_gain", "lateral_agreement"],
        _ => &[],
    }
}

const OFFSET: &[&str] = &["vertical_siblings", "guiding_zero"];
const DRIFT: &[&str] = &["drift", "vertical_drift", "guiding_drift"];
/// Rules that name the static load of the vehicle file, or another load.
const LOAD: &[&str] = &["total_load", "modelled_load", "static_load"];

/// Rules that name a column of the table of sections.
fn column_of_curves(column: &str) -> &'static [&'static str] {
    match column {
        "radius" => &["track_curvature", "table_of_curves"],
        "cant" => &["track_cant", "table_of_curves", "vertical_agreement"],
        _ => &["running_speed", "table_of_curves"],
    }
}

pub const KINDS: &[Kind] = &[
    ("gain of a channel", |draw, _| {
        let (side, kind) = (draw.side(), *draw.of(&["Y", "Q", "ay", "az"]));
        let channel = draw.channel_of(kind);
        whole(
            side,
            vec![channel.clone()],
            own(&channel),
            "times 1 +",
            signed(draw, 0.05, 0.5),
            gain(kind),
            |v, s, _| v * (1.0 + s),
        )
    }),
    ("gain of a side", |draw, folder| {
        let (side, kind) = (draw.side(), *draw.of(&["Y", "Q", "ay", "az"]));
        whole(
            side,
            all(folder, kind),
            of_kind(kind),
            "times 1 +",
            signed(draw, 0.05, 0.5),
            gain(kind),
            |v, s, _| v * (1.0 + s),
        )
    }),
    ("offset of a channel", |draw, _| {
        let (side, kind) = (draw.side(), *draw.of(&["Y", "Y", "Q", "Q", "ay"]));
        let channel = draw.channel_of(kind);
        let (from, most) = offset(kind);
        whole(
            side,
            vec![channel.clone()],
            own(&channel),
            "plus",
            signed(draw, from, most),
            OFFSET,
            |v, s, _| v + s,
        )
    }),
    ("offset of a side", |draw, folder| {
        let (side, kind) = (draw.side(), *draw.of(&["Y", "Q", "ay"]));
        let (from, most) = offset(kind);
        whole(
            side,
            all(folder, kind),
            of_kind(kind),
            "plus",
            signed(draw, from, most),
            OFFSET,
            |v, s, _| v + s,
        )
    }),
    ("zero drift in the sections", |draw, folder| {
        let (side, kind) = (draw.side(), *draw.of(&["Y", "Q", "ay"]));
        let channel = draw.channel_of(kind);
        let (from, most) = offset(kind);
        let sections = draw.sections(folder, 0.5);
        let told = concerned(folder, &sections, own(&channel));
        Fault {
            says: format!("{channel} {} drifts in {}, by", side.in_words(), list(&sections)),
            size: signed(draw, from, 4.0 * most),
            told,
            right: DRIFT,
            put: Box::new(move |folder, size| {
                folder.channel(side, &sections, &channel, |values, _, _| {
                    each(values, |n, value| value + size * n as f64 / values.len() as f64)
                });
            }),
        }
    }),
    ("drift over the campaign", |draw, folder| {
        let (side, kind) = (draw.side(), *draw.of(&["Y", "Q", "ay"]));
        let channel = draw.channel_of(kind);
        let (from, most) = offset(kind);
        let count = folder.sections("").len() as f64;
        whole(
            side,
            vec![channel.clone()],
            own(&channel),
            "drifts over the campaign by",
            signed(draw, from, 4.0 * most),
            DRIFT,
            move |v, s, n| v + s * n as f64 / count,
        )
    }),
    ("gain that fades", |draw, folder| {
        let (side, kind) = (draw.side(), *draw.of(&["Y", "Q"]));
        let channel = draw.channel_of(kind);
        let count = folder.sections("").len() as f64;
        let right: &[&str] =
            if kind == "Y" { &["drift", "guiding_gain"] } else { &["drift", "vertical_siblings"] };
        whole(
            side,
            vec![channel.clone()],
            own(&channel),
            "times 1 + a share that grows to",
            signed(draw, 0.1, 0.6),
            right,
            move |v, s, n| v * (1.0 + s * n as f64 / count),
        )
    }),
    ("static wheel load", |draw, _| {
        let factor = 1.0 + draw.sign() * draw.between(0.15, 0.3);
        Fault {
            says: "static wheel load times".into(),
            size: Size::Fact(factor),
            told: Told {
                sections: Vec::new(),
                channels: texts(&[
                    "Q0",
                    "static_wheel_load",
                    "static wheel load",
                    "SigmaQ",
                    "TotalQ",
                    "Q_",
                ]),
            },
            right: LOAD,
            put: Box::new(|folder, size| {
                folder.vehicle("static_wheel_load", |old| {
                    let (number, unit) = old.split_once(' ').unwrap_or((old, ""));
                    format!("{:.4} {unit}", size * number.parse::<f64>().unwrap_or(0.0))
                        .trim()
                        .to_string()
                });
            }),
        }
    }),
    ("radii", |draw, folder| {
        in_table(
            draw,
            folder,
            "radius",
            "times",
            |draw| 1.0 + draw.sign() * draw.log_between(0.03, 0.1),
            |v, s| v * s,
        )
    }),
    ("cant", |draw, folder| {
        in_table(
            draw,
            folder,
            "cant",
            "plus mm",
            |draw| draw.sign() * draw.log_between(10.0, 40.0),
            |v, s| v + s,
        )
    }),
    ("speed", |draw, folder| {
        in_table(
            draw,
            folder,
            "speed",
            "times",
            |draw| 1.0 + draw.sign() * draw.log_between(0.02, 0.08),
            |v, s| v * s,
        )
    }),
    ("clock", |draw, folder| {
        let (side, sections) = (draw.side(), draw.sections(folder, 0.6));
        let factor = 1.0 + draw.sign() * draw.log_between(0.015, 0.06);
        let mut told = concerned(folder, &sections, texts(&["time", "clock", "speed", "distance"]));
        told.channels.extend(texts(side.folders()));
        Fault {
            says: format!("clock of the {} of {} times", side.folders()[0], list(&sections)),
            size: Size::Fact(factor),
            told,
            right: &["running_speed", "clock"],
            put: Box::new(move |folder, size| {
                folder
                    .channel(side, &sections, "time", |values, _, _| each(values, |_, v| size * v));
            }),
        }
    }),
    ("load of another state", |draw, _| {
        let share = draw.sign() * draw.between(0.12, 0.3);
        Fault {
            says: "simulated with the mass of the car body times 1 +".into(),
            size: Size::Drawn(share),
            told: Told { sections: Vec::new(), channels: of_kind("Q") },
            right: LOAD,
            put: Box::new(|folder, share| {
                let path = folder.path().to_path_buf();
                other_load(folder, &path, share);
            }),
        }
    }),
];

/// Where the search of an offset of a kind of channel begins, and its largest, in kN or m/s^2.
fn offset(kind: &str) -> (f64, f64) {
    if kind == "ay" || kind == "az" { (0.2, 1.5) } else { (2.0, 25.0) }
}

fn signed(draw: &mut Draw, from: f64, most: f64) -> Size {
    Size::Sought { from: from * draw.sign(), most }
}

/// The channels of a kind.
fn all(folder: &Folder, kind: &str) -> Vec<String> {
    let record = folder.record(&format!("simulation/{}.csv", folder.sections("")[0]));
    let of_kind = |name: &String| name.split('_').next() == Some(kind);
    record.channels().into_iter().filter(of_kind).collect()
}

fn list(sections: &[String]) -> String {
    if let [one] = sections { one.clone() } else { "all sections".into() }
}

/// Channels changed in all sections: from a sample, the size, and the number of the section.
fn whole(
    side: Side,
    channels: Vec<String>,
    names: Vec<String>,
    says: &str,
    size: Size,
    right: &'static [&'static str],
    change: impl Fn(f64, f64, usize) -> f64 + Send + Sync + 'static,
) -> Fault {
    Fault {
        says: format!("{} {} {says}", channels.join(", "), side.in_words()),
        size,
        told: Told { sections: Vec::new(), channels: names },
        right,
        put: Box::new(move |folder, size| {
            let sections = folder.sections("");
            for channel in &channels {
                folder.channel(side, &sections, channel, |values, _, section| {
                    each(values, |_, value| change(value, size, section))
                });
            }
        }),
    }
}

/// A column of the table of sections, in all curves or in one; the cant deficiency is computed
/// from it again, as by whoever made the table.
fn in_table(
    draw: &mut Draw,
    folder: &Folder,
    column: &'static str,
    says: &str,
    size: impl Fn(&mut Draw) -> f64,
    change: impl Fn(f64, f64) -> f64 + Send + Sync + 'static,
) -> Fault {
    let curves: Vec<String> = folder
        .sections("")
        .into_iter()
        .filter(|one| folder.fact(one, "radius").is_some())
        .collect();
    let sections = if draw.chance(0.6) { curves } else { vec![draw.of(&curves).clone()] };
    let told = if sections.len() == 1 { sections.clone() } else { Vec::new() };
    let size = size(draw);
    Fault {
        says: format!(
            "{column} of {} {says}",
            if sections.len() == 1 { &sections[0] } else { "all curves" }
        ),
        size: Size::Fact(size),
        told: Told {
            sections: told,
            channels: texts(&[
                column,
                "curvature",
                "track_cant",
                "cant",
                "ay_",
                "TotalY",
                "SigmaY",
                "clock",
                "speed",
            ]),
        },
        right: column_of_curves(column),
        put: Box::new(move |folder, size| {
            for section in &sections {
                let fact = |folder: &Folder, name: &str| folder.fact(section, name).unwrap_or(0.0);
                let deficiency = |folder: &Folder| {
                    let speed = fact(folder, "speed") / 3.6;
                    1500.0 * speed * speed / (9.806_65 * fact(folder, "radius"))
                        - fact(folder, "cant")
                };
                let before = deficiency(folder);
                *folder.cell(section, column) =
                    format!("{:.2}", change(fact(folder, column), size));
                let by = deficiency(folder) - before;
                let new = fact(folder, "cant deficiency") + by;
                *folder.cell(section, "cant deficiency") = format!("{new:.1}");
            }
        }),
    }
}

/// The simulation repeated with another mass of the car body: its vertical forces are those of
/// another state of load than the vehicle file says.
fn other_load(folder: &mut Folder, path: &Path, share: f64) {
    let mut problems = Problems::default();
    let campaign = Campaign::open(path, &mut problems).expect("a campaign");
    let simulator = Builtin::new(&campaign, &mut problems).expect("a vehicle of the model");
    let known = sections(&campaign, &mut problems).expect("sections");
    let number = |key: &str| {
        let node = campaign.vehicle.lookup(key)?;
        fishplate::simulate::number_of(node, key)
    };
    let settings: Vec<(String, f64)> = [
        "car_body.mass",
        "car_body.inertia_roll",
        "car_body.inertia_pitch",
        "car_body.inertia_yaw",
    ]
    .iter()
    .map(|key| ((*key).to_string(), (1.0 + share) * number(key).expect("a number")))
    .collect();
    for section in &known {
        let task = Task { section, settings: &settings, shift: 0.0, inside_only: false };
        let Ok(made) = simulator.run(&task) else { continue };
        let record = folder.record_mut(&format!("simulation/{}.csv", section.name()));
        let distances = record.values("distance").to_vec();
        for channel in record.channels() {
            let Some(from) = made.channel(&channel) else { continue };
            let mut at = 0;
            let of =
                |x: &f64| fishplate::simulate::interpolated(&made.axis, &from.values, *x, &mut at);
            record.set(&channel, distances.iter().map(of).collect());
        }
    }
}
