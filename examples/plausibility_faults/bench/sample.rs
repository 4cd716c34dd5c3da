//! Faults of single samples and of the spectrum of a channel.

use std::f64::consts::TAU;

use fishplate::effects::Gauss;
use fishplate::metrics::filter::Band;

use super::Kind;
use super::fault::{Draw, Fault, Size, Told, concerned, own};
use super::folder::{Folder, Side};
use super::signal::{deviation, each, filtered, percentile, with_noise};

const SPIKES: &[&str] = &["spikes"];
/// A wheel force of zero is told where something is divided by it.
const DROPOUTS: &[&str] = &["interrupted", "spikes", "live", "unloaded", "divided-by-zero"];
const GAPS: &[&str] = &["interrupted", "live"];
/// The distance of what follows is shifted.
const LOST: &[&str] = &["aligned", "lost_rows"];
const STAIRS: &[&str] = &["repeated_samples"];
const FILTERED: &[&str] = &["filtered", "lacking"];
const LINE: &[&str] = &["hum", "hum_vertical"];
const WANDER: &[&str] = &["drift"];
const NOISE: &[&str] = &["noise", "noisy", "noisy_guiding", "noisy_simulation"];
const CLIPPED: &[&str] = &["saturated", "clipped"];
const COARSE: &[&str] = &["coarse"];

pub const KINDS: &[Kind] = &[
    ("spikes", |draw, folder| {
        let (count, width, seed) = (1 + draw.0.below(12), 1 + draw.0.below(3), draw.seed());
        sought(
            draw,
            folder,
            &format!("{count} spikes of {width} samples, in deviations"),
            (12.0, 200.0),
            SPIKES,
            move |values, _, size, n| {
                let mut random = Gauss::new(seed + n);
                let mut spiked = values.to_vec();
                let by = size * deviation(values);
                for _ in 0..count {
                    let at = random.below(values.len() - width);
                    let sign = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
                    spiked[at..at + width].iter_mut().for_each(|value| *value += sign * by);
                }
                spiked
            },
        )
    }),
    ("short dropouts", |draw, folder| {
        let (seconds, seed) = (draw.log_between(0.01, 0.08), draw.seed());
        sought(
            draw,
            folder,
            &format!("drops out for {seconds:.3} s, in a share of the seconds of"),
            (1.0, 4.0),
            DROPOUTS,
            move |values, rate, size, n| {
                let (mut random, long) = (Gauss::new(seed + n), (seconds * rate).ceil() as usize);
                let mut dropped = values.to_vec();
                let count = (size * values.len() as f64 / rate).ceil() as usize;
                for _ in 0..count {
                    let at = random.below(values.len() - long);
                    dropped[at..at + long].fill(0.0);
                }
                dropped
            },
        )
    }),
    ("interpolated gaps", |draw, folder| {
        let seed = draw.seed();
        sought(
            draw,
            folder,
            "straight lines over gaps, each of s",
            (0.4, 1.5),
            GAPS,
            move |values, rate, size, n| {
                let mut random = Gauss::new(seed + n);
                let long = ((size * rate) as usize).clamp(2, values.len() / 3);
                let mut lines = values.to_vec();
                for _ in 0..4 {
                    let at = random.below(values.len() - long - 1);
                    let (from, to) = (lines[at], lines[at + long]);
                    for k in 0..long {
                        lines[at + k] = from + (to - from) * k as f64 / long as f64;
                    }
                }
                lines
            },
        )
    }),
    ("lost rows with new numbering", |draw, folder| {
        let (side, section) = (draw.side(), draw.of(&folder.sections("")).clone());
        let (place, seconds) = (draw.between(0.3, 0.6), draw.log_between(0.05, 0.6));
        Fault {
            says: format!("rows of {section} lost in the {}, numbered anew, s", side.folders()[0]),
            size: Size::Fact(seconds),
            told: Told { sections: vec![section.clone()], channels: Vec::new() },
            right: LOST,
            put: Box::new(move |folder, seconds| {
                let record = folder.record_mut(&format!("{}/{section}.csv", side.folders()[0]));
                let (at, long) = (
                    (place * record.rows() as f64) as usize,
                    (seconds * super::signal::rate(record)) as usize,
                );
                let axes = ["time", "distance"].map(|axis| record.values(axis).to_vec());
                record.keep(|row| !(at..at + long).contains(&row));
                for (axis, values) in ["time", "distance"].iter().zip(axes) {
                    record.set(axis, values[..record.rows()].to_vec());
                }
            }),
        }
    }),
    ("stairs", |draw, folder| {
        let steps = 0.02 * draw.log_between(1.0, 8.0);
        drawn(draw, folder, "held for s", steps, STAIRS, |values, rate, size, _| {
            let hold = ((size * rate).round() as usize).max(2);
            each(values, |n, _| values[n - n % hold])
        })
    }),
    ("smoothing", |draw, folder| {
        sought(draw, folder, "smoothed over s", (0.15, 0.8), FILTERED, |values, rate, size, _| {
            let half = ((size * rate / 2.0) as usize).max(1);
            each(values, |n, _| {
                let (from, to) = (n.saturating_sub(half), (n + half + 1).min(values.len()));
                values[from..to].iter().sum::<f64>() / (to - from) as f64
            })
        })
    }),
    ("a filter too many", |draw, folder| {
        let cut = draw.log_between(2.0, 12.0);
        drawn(draw, folder, "low-passed at Hz", cut, FILTERED, |values, rate, size, _| {
            filtered(values, Band::LowPass(size), rate)
        })
    }),
    ("a filter too many on both sides", |draw, folder| {
        let cut = draw.log_between(1.5, 8.0);
        let channel = draw.channel();
        let sections = folder.sections("");
        Fault {
            says: format!("{channel} on both sides low-passed at Hz"),
            size: Size::Drawn(cut),
            told: Told { sections: Vec::new(), channels: own(&channel) },
            right: FILTERED,
            put: Box::new(move |folder, size| {
                folder.channel(Side::Both, &sections, &channel, |values, rate, _| {
                    filtered(values, Band::LowPass(size), rate)
                });
            }),
        }
    }),
    ("missing energy in a band", |draw, folder| {
        let low = draw.log_between(0.7, 4.0);
        let high = low * draw.between(1.8, 4.0);
        drawn(
            draw,
            folder,
            &format!("without the band {low:.1} to {high:.1} Hz"),
            1.0,
            FILTERED,
            move |values, rate, _, _| {
                let band = filtered(values, Band::BandPass(low, high), rate);
                each(values, |n, value| value - band[n])
            },
        )
    }),
    ("hum", |draw, folder| {
        let frequency = *draw.of(&[3.0, 7.0, 16.7, 16.7, 10.0]);
        let phase = draw.between(0.0, TAU);
        sought(
            draw,
            folder,
            &format!("hum at {frequency} Hz, in deviations"),
            (0.5, 8.0),
            LINE,
            move |values, rate, size, _| {
                let amplitude = size * deviation(values);
                each(values, |n, value| {
                    value + amplitude * (TAU * frequency * n as f64 / rate + phase).sin()
                })
            },
        )
    }),
    ("wander", |draw, folder| {
        let (period, phase) = (draw.between(3.0, 12.0), draw.between(0.0, TAU));
        sought_of(
            draw,
            folder,
            &["Y", "Q"],
            &format!("wanders with a period of {period:.1} s, in deviations"),
            (1.0, 12.0),
            WANDER,
            move |values, rate, size, n| {
                let amplitude = size * deviation(values);
                let phase = phase + 2.4 * n as f64;
                each(values, |k, value| {
                    value + amplitude * (TAU * k as f64 / rate / period + phase).sin()
                })
            },
        )
    }),
    ("white noise", |draw, folder| {
        let seed = draw.seed();
        sought(
            draw,
            folder,
            "white noise, in deviations",
            (0.5, 12.0),
            NOISE,
            move |values, _, size, n| with_noise(values, size * deviation(values), seed + n),
        )
    }),
    ("clipping", |draw, folder| {
        sought(
            draw,
            folder,
            "clipped, a share at each end",
            (0.01, 0.06),
            CLIPPED,
            |values, _, size, _| {
                let (low, high) = (percentile(values, size), percentile(values, 1.0 - size));
                each(values, |_, value| value.clamp(low, high))
            },
        )
    }),
    ("coarse steps", |draw, folder| {
        sought(draw, folder, "in steps, in deviations", (0.6, 4.0), COARSE, |values, _, size, _| {
            let step = size * deviation(values);
            each(values, |_, value| (value / step).round() * step)
        })
    }),
];

/// A channel changed in all sections or in one: from its samples, the rate, the size, and the
/// number of the section; the size is sought.
fn sought(
    draw: &mut Draw,
    folder: &Folder,
    says: &str,
    (from, most): (f64, f64),
    right: &'static [&'static str],
    change: impl Fn(&[f64], f64, f64, u64) -> Vec<f64> + Send + Sync + 'static,
) -> Fault {
    sought_of(draw, folder, &["Y", "Q", "ay", "az"], says, (from, most), right, change)
}

/// As [`sought`], of one of some kinds of channels.
fn sought_of(
    draw: &mut Draw,
    folder: &Folder,
    kinds: &[&str],
    says: &str,
    (from, most): (f64, f64),
    right: &'static [&'static str],
    change: impl Fn(&[f64], f64, f64, u64) -> Vec<f64> + Send + Sync + 'static,
) -> Fault {
    let kind = *draw.of(kinds);
    let fault = drawn_of(draw, folder, kind, says, from, right, change);
    Fault { size: Size::Sought { from, most }, ..fault }
}

fn drawn(
    draw: &mut Draw,
    folder: &Folder,
    says: &str,
    size: f64,
    right: &'static [&'static str],
    change: impl Fn(&[f64], f64, f64, u64) -> Vec<f64> + Send + Sync + 'static,
) -> Fault {
    let kind = *draw.of(&["Y", "Q", "ay", "az"]);
    drawn_of(draw, folder, kind, says, size, right, change)
}

fn drawn_of(
    draw: &mut Draw,
    folder: &Folder,
    kind: &str,
    says: &str,
    size: f64,
    right: &'static [&'static str],
    change: impl Fn(&[f64], f64, f64, u64) -> Vec<f64> + Send + Sync + 'static,
) -> Fault {
    let (channel, side, sections) =
        (draw.channel_of(kind), draw.side(), draw.sections(folder, 0.6));
    let at = if let [one] = sections.as_slice() { one.clone() } else { "all sections".into() };
    Fault {
        says: format!("{channel} {} in {at} {says}", side.in_words()),
        size: Size::Drawn(size),
        told: concerned(folder, &sections, own(&channel)),
        right,
        put: Box::new(move |folder, size| {
            folder.channel(side, &sections, &channel, |values, rate, n| {
                change(values, rate, size, n as u64)
            });
        }),
    }
}
