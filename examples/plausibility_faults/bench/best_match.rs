//! Records, channels and sections that are not what their names say.

use super::Kind;
use super::answer::LEFT_OUT;
use super::fault::{Draw, Fault, Size, Told, concerned, own, texts};
use super::folder::{Folder, SECTIONS, Side};
use super::signal::{deviation, with_noise};

const EXCHANGED: &[&str] = &["exchanged"];
/// Rules that name an exchange of the left and the right wheel.
const SIDES: &[&str] = &["exchanged", "load_transfer"];
/// Rules that name a copy; `exchanged` does where two records or channels are nearly the same.
const COPIES: &[&str] = &["copies", "exchanged"];
/// Rules that name records of other sections in a section.
const SECTIONS_EXCHANGED: &[&str] = &["exchanged"];
/// Rules that name an exchange of both folders.
const FOLDERS: &[&str] = &["exchanged_folders"];
/// Rules that name a sensor at another place.
const SENSOR: &[&str] = &["exchanged", "other_sensor"];

pub const KINDS: &[Kind] = &[
    ("exchanged sections", |draw, folder| {
        let (side, zone) = (draw.side(), *draw.of(&["1", "2", "3", "4"]));
        let (a, b) = two(draw, &folder.sections(zone));
        Fault {
            says: format!("records of {a} and {b} exchanged in the {}", side.folders()[0]),
            size: Size::Drawn(1.0),
            told: Told { sections: vec![a.clone(), b.clone()], channels: Vec::new() },
            right: SECTIONS_EXCHANGED,
            put: Box::new(move |folder, _| {
                let [x, y] = [&a, &b].map(|one| format!("{}/{one}.csv", side.folders()[0]));
                let (of_x, of_y) = (onto(folder, &y, &x), onto(folder, &x, &y));
                folder.put(&x, of_x);
                folder.put(&y, of_y);
            }),
        }
    }),
    ("exchanged wheelsets", |draw, folder| {
        let (side, sections) = (draw.side(), draw.sections(folder, 0.7));
        let (a, b) = (*draw.of(&["1", "3"]), *draw.of(&["2", "4"]));
        let (a, b) = if draw.chance(0.4) { ("1", "3") } else { (a, b) };
        let pairs: Vec<(String, String)> = ["Y", "Q"]
            .iter()
            .flat_map(|kind| {
                ["R", "L"].map(|s| (format!("{kind}_{a}{s}"), format!("{kind}_{b}{s}")))
            })
            .collect();
        exchanged(folder, side, (sections, pairs), &format!("wheelsets {a} and {b}"), EXCHANGED)
    }),
    ("exchanged channels", |draw, folder| {
        let (side, sections) = (draw.side(), draw.sections(folder, 0.6));
        let a = draw.channel();
        let mut b = draw.channel_of(a.split('_').next().unwrap_or("Y"));
        while a == b {
            b = draw.channel_of(a.split('_').next().unwrap_or("Y"));
        }
        let says = format!("{a} and {b}");
        exchanged(folder, side, (sections, vec![(a, b)]), &says, EXCHANGED)
    }),
    ("exchanged sides of a wheelset", |draw, folder| {
        let (side, sections) = (draw.side(), draw.sections(folder, 0.6));
        let (kind, wheelset) = (*draw.of(&["Y", "Q"]), *draw.of(&["1", "3"]));
        let pair = (format!("{kind}_{wheelset}R"), format!("{kind}_{wheelset}L"));
        let says = format!("{kind} of both sides of wheelset {wheelset}");
        exchanged(folder, side, (sections, vec![pair]), &says, SIDES)
    }),
    ("exchanged folders", |draw, folder| {
        let sections = if draw.chance(0.5) {
            folder.sections("")
        } else {
            vec![draw.of(&folder.sections("")).clone()]
        };
        let told = Told {
            sections: if sections.len() == 1 { sections.clone() } else { Vec::new() },
            channels: texts(&["simulation", "measurement", "Y_", "Q_", "ay_", "az_"]),
        };
        Fault {
            says: format!(
                "folders exchanged for {}",
                if sections.len() == 1 { &sections[0] } else { "all sections" }
            ),
            size: Size::Drawn(1.0),
            told,
            right: FOLDERS,
            put: Box::new(move |folder, _| {
                for section in &sections {
                    let [a, b] =
                        ["simulation", "measurement"].map(|kind| format!("{kind}/{section}.csv"));
                    let (of_a, of_b) = (folder.record(&a).clone(), folder.record(&b).clone());
                    folder.put(&a, of_b);
                    folder.put(&b, of_a);
                }
            }),
        }
    }),
    ("bogie for body", |draw, folder| {
        let (side, sections) = (draw.side(), draw.sections(folder, 0.7));
        let channel = draw.channel_of("ay");
        let told = concerned(folder, &sections, own(&channel));
        Fault {
            says: format!("{channel} {} is that of the bogie", side.in_words()),
            size: Size::Drawn(1.0),
            told,
            right: SENSOR,
            put: Box::new(move |folder, _| {
                let of_bogie = channel.replace("ay_", "ayb_");
                for kind in side.folders() {
                    for section in &sections {
                        let record = folder.record_mut(&format!("{kind}/{section}.csv"));
                        if record.column(&of_bogie).is_some() {
                            record.set(&channel, record.values(&of_bogie).to_vec());
                        }
                    }
                }
            }),
        }
    }),
    ("near copy of a channel", |draw, folder| {
        let (side, sections) = (draw.side(), draw.sections(folder, 0.7));
        let (noise, seed, a) = (draw.log_between(0.005, 0.1), draw.seed(), draw.channel());
        let mut b = draw.channel_of(a.split('_').next().unwrap_or("Y"));
        while a == b {
            b = draw.channel_of(a.split('_').next().unwrap_or("Y"));
        }
        let told = concerned(folder, &sections, own(&a).into_iter().chain(own(&b)).collect());
        Fault {
            says: format!("{a} {} is {b} with noise of a share", side.in_words()),
            size: Size::Drawn(noise),
            told,
            right: COPIES,
            put: Box::new(move |folder, size| {
                for kind in side.folders() {
                    for (n, section) in sections.iter().enumerate() {
                        let record = folder.record_mut(&format!("{kind}/{section}.csv"));
                        let from = record.values(&b);
                        let copy = with_noise(from, size * deviation(from), seed + n as u64);
                        record.set(&a, copy);
                    }
                }
            }),
        }
    }),
    ("one curve many times", |draw, folder| {
        let zone = *draw.of(&["1", "2", "3", "4"]);
        repeated(draw, folder, zone, false)
    }),
    ("overlap", |draw, folder| {
        let zone = *draw.of(&["1", "2", "3", "4"]);
        repeated(draw, folder, zone, true)
    }),
    ("diluted set", |draw, folder| {
        let (from, seed) = (draw.of(&folder.sections("1")).clone(), draw.seed());
        let (count, noise) = (4 + draw.0.below(12), draw.log_between(0.002, 0.05));
        Fault {
            says: format!("{count} near copies of {from} added, with noise of a share"),
            size: Size::Drawn(noise),
            told: Told {
                sections: (0..count).map(|n| format!("T{n:02}")).chain([from.clone()]).collect(),
                channels: Vec::new(),
            },
            right: COPIES,
            put: Box::new(move |folder, noise| {
                for n in 0..count {
                    let name = format!("T{n:02}");
                    near_copy(folder, &from, &name, noise, seed + 100 * n as u64);
                    let table = folder.tables.get_mut(SECTIONS).expect("a table");
                    let row =
                        table.rows.iter().find(|row| row[0] == from).expect("a section").clone();
                    table.rows.push([vec![name], row[1..].to_vec()].concat());
                }
            }),
        }
    }),
    ("sections left out", |draw, folder| {
        let all = folder.sections("");
        let count = 1 + draw.0.below(3);
        let mut out: Vec<String> = (0..count).map(|_| draw.of(&all).clone()).collect();
        out.dedup();
        Fault {
            says: format!("{} left out of the table, the records are there", out.join(", ")),
            size: Size::Drawn(1.0),
            told: Told { sections: out.clone(), channels: Vec::new() },
            right: &[LEFT_OUT],
            put: Box::new(move |folder, _| {
                let table = folder.tables.get_mut(SECTIONS).expect("a table");
                table.rows.retain(|row| !out.contains(&row[0]));
            }),
        }
    }),
    ("unrelated channel", |draw, folder| {
        let (side, zone, channel) = (draw.side(), *draw.of(&["1", "2", "3", "4"]), draw.channel());
        let (a, b) = two(draw, &folder.sections(zone));
        Fault {
            says: format!("{channel} {} of {a} is that of {b}", side.in_words()),
            size: Size::Drawn(1.0),
            told: Told { sections: vec![a.clone()], channels: own(&channel) },
            right: COPIES,
            put: Box::new(move |folder, _| {
                let kind = side.folders()[0];
                let (to, from) = (format!("{kind}/{a}.csv"), format!("{kind}/{b}.csv"));
                let values = onto(folder, &from, &to).values(&channel).to_vec();
                folder.record_mut(&to).set(&channel, values);
            }),
        }
    }),
];

fn two(draw: &mut Draw, all: &[String]) -> (String, String) {
    let a = draw.0.below(all.len());
    let b = (a + 1 + draw.0.below(all.len() - 1)) % all.len();
    (all[a].clone(), all[b].clone())
}

/// The channels of a record along the distance of another, sample by sample; beyond its end it
/// begins again.
fn onto(folder: &Folder, from: &str, to: &str) -> super::folder::Record {
    let (from, mut record) = (folder.record(from).clone(), folder.record(to).clone());
    for channel in record.channels() {
        let values = from.values(&channel);
        let cycled = values.iter().chain(values.iter().rev()).cycle();
        let count = record.rows();
        record.set(&channel, cycled.take(count).copied().collect());
    }
    record
}

fn exchanged(
    folder: &Folder,
    side: Side,
    (sections, pairs): (Vec<String>, Vec<(String, String)>),
    what: &str,
    right: &'static [&'static str],
) -> Fault {
    let names = pairs.iter().flat_map(|(a, b)| own(a).into_iter().chain(own(b))).collect();
    let told = concerned(folder, &sections, names);
    let at = if sections.len() == 1 { sections[0].as_str() } else { "all sections" };
    Fault {
        says: format!("{what} exchanged in the {} of {at}", side.folders()[0]),
        size: Size::Drawn(1.0),
        told,
        right,
        put: Box::new(move |folder, _| {
            for section in &sections {
                let record = folder.record_mut(&format!("{}/{section}.csv", side.folders()[0]));
                for (a, b) in &pairs {
                    let [a, b] = [a, b].map(|one| record.column(one).expect("a channel"));
                    record.columns.swap(a, b);
                }
            }
        }),
    }
}

/// The records of a section under another name, with noise of a share of each deviation.
fn near_copy(folder: &mut Folder, from: &str, to: &str, noise: f64, seed: u64) {
    for kind in ["simulation", "measurement", "track"] {
        let mut record = folder.record(&format!("{kind}/{from}.csv")).clone();
        if kind != "track" {
            for (m, channel) in record.channels().iter().enumerate() {
                let values = record.values(channel);
                let copy = with_noise(values, noise * deviation(values), seed + m as u64);
                record.set(channel, copy);
            }
        }
        folder.put(&format!("{kind}/{to}.csv"), record);
    }
}

/// Sections of a zone that are one curve: near copies, or, if they overlap, the same record with
/// the section moved.
fn repeated(draw: &mut Draw, folder: &Folder, zone: &str, overlap: bool) -> Fault {
    let all = folder.sections(zone);
    let (from, to) = two(draw, &all);
    let (noise, seed) = (draw.log_between(0.002, 0.05), draw.seed());
    let says = if overlap { "overlaps" } else { "is a near copy of" };
    // A moved section must stay in the full curve and in the record.
    let by = draw.sign() * draw.between(4.0, 12.0);
    Fault {
        says: format!("{to} {says} {from}"),
        size: Size::Drawn(noise),
        told: Told { sections: vec![to.clone(), from.clone()], channels: Vec::new() },
        right: COPIES,
        put: Box::new(move |folder, noise| {
            near_copy(folder, &from, &to, if overlap { 0.0 } else { noise }, seed);
            let table = folder.tables.get_mut(SECTIONS).expect("a table");
            let row = table.rows.iter().find(|row| row[0] == from).expect("a section").clone();
            let own = table.rows.iter_mut().find(|row| row[0] == to).expect("a section");
            own[1..].clone_from_slice(&row[1..]);
            if overlap {
                for column in ["start", "end"] {
                    let cell = folder.cell(&to, column);
                    *cell = format!("{:.2}", cell.parse::<f64>().unwrap_or(0.0) + by);
                }
            }
        }),
    }
}
