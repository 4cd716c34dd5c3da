//! A simulation that was made from the measurement, or a measurement from the simulation.

use fishplate::metrics::filter::Band;

use super::Kind;
use super::fault::{Draw, Fault, Size, Told, own};
use super::folder::{Folder, Side};
use super::signal::{at_distances, delayed, deviation, each, filtered, mean, rate, with_noise};

/// Rules that say that one side was made from the other.
const RIGHT: &[&str] = &["shared_noise", "copied_section", "independent", "copies"];
/// Peaks that end where those of the other side do.
const CLIPPED: &[&str] =
    &["shared_noise", "copied_section", "independent", "copies", "clipped", "saturated"];

pub const KINDS: &[Kind] = &[
    ("plus noise", |draw, folder| {
        let (share, seed) = (draw.log_between(0.01, 0.3), draw.seed());
        made(
            draw,
            folder,
            "with noise of a share of its deviation",
            share,
            move |from, _, size, n| with_noise(from, size * deviation(from), seed + n),
        )
    }),
    ("filtered", |draw, folder| {
        let cut = draw.log_between(4.0, 30.0);
        made(draw, folder, "low-passed at Hz", cut, |from, at, size, _| {
            filtered(from, Band::LowPass(size), at.rate)
        })
    }),
    ("delayed", |draw, folder| {
        let seconds = draw.log_between(0.01, 0.15);
        made(draw, folder, "delayed by s", seconds, |from, at, size, _| {
            delayed(from, size * at.rate)
        })
    }),
    ("scaled", |draw, folder| {
        let gain = 1.0 + draw.sign() * draw.log_between(0.01, 0.12);
        made(draw, folder, "times", gain, |from, _, size, _| each(from, |_, value| size * value))
    }),
    ("blended", |draw, folder| {
        let share = draw.between(0.5, 0.95);
        made(draw, folder, "blended with a share of", share, |from, at, size, _| {
            each(from, |n, value| size * value + (1.0 - size) * at.own[n])
        })
    }),
    ("clipped to its range", |draw, folder| {
        let rest = draw.log_between(0.5, 3.0);
        let fault = made(
            draw,
            folder,
            "clipped to it, with the own deviations times",
            rest,
            |from, at, size, _| {
                let (low, high) = from
                    .iter()
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
                let middle = mean(at.own) - mean(from);
                let wider =
                    |n: usize| mean(at.own) + size.max(1.0) * (at.own[n] - mean(at.own)) - middle;
                each(from, |n, _| wider(n).clamp(low, high))
            },
        );
        Fault { right: CLIPPED, ..fault }
    }),
    ("offsets removed by zone", |draw, folder| offsets(draw, folder, false)),
    ("offsets removed by section", |draw, folder| offsets(draw, folder, true)),
    ("one channel", |draw, folder| {
        let (share, seed, channel) = (draw.log_between(0.01, 0.2), draw.seed(), draw.channel());
        let reverse = draw.chance(0.3);
        from_other(
            folder,
            vec![channel],
            reverse,
            "with noise of a share of its deviation",
            share,
            move |from, _, size, n| with_noise(from, size * deviation(from), seed + n),
        )
    }),
    ("noise and filter", |draw, folder| {
        let (share, seed) = (draw.log_between(0.02, 0.2), draw.seed());
        let cut = draw.log_between(8.0, 30.0);
        made(draw, folder, "low-passed, with noise of a share", share, move |from, at, size, n| {
            let from = filtered(from, Band::LowPass(cut), at.rate);
            with_noise(&from, size * deviation(&from), seed + n)
        })
    }),
];

/// Where a channel is made from that of the other side.
struct At<'a> {
    rate: f64,
    own: &'a [f64],
}

type Make = dyn Fn(&[f64], &At<'_>, f64, u64) -> Vec<f64> + Send + Sync;

/// All channels, or those of a kind, made from those of the other side; as `from_other`.
fn made(
    draw: &mut Draw,
    folder: &Folder,
    says: &str,
    size: f64,
    make: impl Fn(&[f64], &At<'_>, f64, u64) -> Vec<f64> + Send + Sync + 'static,
) -> Fault {
    let all = folder.record(&format!("simulation/{}.csv", folder.sections("")[0])).channels();
    let begin = ["", "", "", "Y", "Q", "a"];
    let begin = *draw.of(&begin);
    let reverse = draw.chance(0.25);
    let channels = all.into_iter().filter(|name| name.starts_with(begin)).collect();
    from_other(folder, channels, reverse, says, size, make)
}

/// Channels of the simulation made from the measurement, or the reverse.
fn from_other(
    folder: &Folder,
    channels: Vec<String>,
    reverse: bool,
    says: &str,
    size: f64,
    make: impl Fn(&[f64], &At<'_>, f64, u64) -> Vec<f64> + Send + Sync + 'static,
) -> Fault {
    let (from, to) =
        if reverse { ("simulation", "measurement") } else { ("measurement", "simulation") };
    let make: Box<Make> = Box::new(make);
    let all = folder.record(&format!("{to}/{}.csv", folder.sections("")[0])).channels().len();
    let told = if channels.len() == all {
        Told::default()
    } else {
        Told { sections: Vec::new(), channels: channels.iter().flat_map(|one| own(one)).collect() }
    };
    let of = if channels.len() == all { "all channels".into() } else { channels.join(", ") };
    Fault {
        says: format!("{to} of {of} is the {from} {says}"),
        size: Size::Drawn(size),
        told,
        right: RIGHT,
        put: Box::new(move |folder, size| {
            for (n, section) in folder.sections("").iter().enumerate() {
                let source = folder.record(&format!("{from}/{section}.csv")).clone();
                let record = folder.record_mut(&format!("{to}/{section}.csv"));
                for (m, channel) in channels.iter().enumerate() {
                    let values = at_distances(&source, channel, record.values("distance"));
                    let at = At { rate: rate(record), own: record.values(channel) };
                    let values = make(&values, &at, size, (100 * n + m) as u64);
                    record.set(channel, values);
                }
            }
        }),
    }
}

/// The simulation with the mean differences to the measurement added, by zone or by section.
fn offsets(draw: &mut Draw, _: &Folder, by_section: bool) -> Fault {
    let kinds = [&["Y", "Q", "ay"][..], &["Y"], &["Q"]];
    let kinds = *draw.of(&kinds);
    let share = draw.between(0.8, 1.0);
    let what = if by_section { "section" } else { "zone" };
    Fault {
        says: format!("offsets of the simulation of {} removed by {what}, share", kinds.join(", ")),
        size: Size::Drawn(share),
        told: Told {
            sections: Vec::new(),
            channels: kinds.iter().flat_map(|kind| super::fault::of_kind(kind)).collect(),
        },
        right: RIGHT,
        put: Box::new(move |folder, share| {
            let groups: Vec<Vec<String>> = match by_section {
                true => folder.sections("").into_iter().map(|section| vec![section]).collect(),
                false => ["1", "2", "3", "4"].map(|zone| folder.sections(zone)).to_vec(),
            };
            for sections in &groups {
                let first = folder.record(&format!("simulation/{}.csv", sections[0]));
                for channel in first.channels() {
                    if !kinds.iter().any(|kind| channel.starts_with(kind)) {
                        continue;
                    }
                    let of = |folder: &Folder, kind: &str| {
                        let level = |section: &String| {
                            mean(folder.record(&format!("{kind}/{section}.csv")).values(&channel))
                        };
                        sections.iter().map(level).sum::<f64>() / sections.len() as f64
                    };
                    let by = share * (of(folder, "measurement") - of(folder, "simulation"));
                    folder.channel(Side::Simulation, sections, &channel, |values, _, _| {
                        each(values, |_, value| value + by)
                    });
                }
            }
        }),
    }
}
