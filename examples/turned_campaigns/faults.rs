//! Causes outside the catalogue: parameters that differ from the vehicle file, and faults of the
//! measuring chain.

use std::f64::consts::TAU;
use std::fmt;

use fishplate::effects::{Catalogue, Signals};
use fishplate::simulate::Section;

use super::base::Base;
use super::cases::channel;
use super::draw::Draw;

type Does = dyn Fn(&mut Signals, &Section, usize) + Send + Sync;

/// A cause outside the catalogue.
pub struct Fault {
    pub says: String,
    /// Values in the vehicle file that differ from the measured vehicle.
    pub vehicle: Vec<(String, f64)>,
    /// Change of the record of a section, in the order of the sections.
    pub does: Box<Does>,
}

impl fmt::Debug for Fault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.says)
    }
}

type Make = fn(&mut Draw, &Base, &Catalogue) -> Fault;

pub const ALL: [Make; 26] = [
    |draw, base, _| scaled(base, "primary.kz", *draw.one(&[&0.5, &2.0])),
    |draw, base, _| scaled(base, "secondary.kz", *draw.one(&[&0.55, &1.8])),
    |draw, base, _| scaled(base, "secondary.ky", *draw.one(&[&0.5, &2.0])),
    |_, base, _| scaled(base, "bogie.mass", 1.6),
    |_, base, _| scaled(base, "car_body.inertia_yaw", 0.6),
    |_, base, _| scaled(base, "primary.cz", 0.3),
    |_, base, _| scaled(base, "primary.ky", 0.4),
    |_, base, _| scaled(base, "contact.vertical_stiffness", 0.4),
    |_, base, _| scaled(base, "contact.kalker_scale", 0.5),
    |_, base, _| higher(base, "car_body.cog_height", 0.35),
    |_, base, _| higher(base, "secondary.height", -0.2),
    |_, base, _| higher(base, "contact.stop_displacement", 0.003),
    |draw, _, catalogue| {
        let bogie = draw.one(&["Y_1R Y_1L Y_2R Y_2L", "Q_3R Q_3L Q_4R Q_4L"]);
        drift(named(catalogue, bogie), draw.between(0.4, 0.7, 3))
    },
    |draw, _, catalogue| {
        drift(vec![channel(draw, catalogue, &["accelerations"])], draw.between(0.02, 0.04, 3))
    },
    |draw, base, catalogue| {
        let group = draw.one(&["guiding forces", "vertical forces"]);
        fading(named(catalogue, group), draw.between(0.6, 0.75, 2), base.sections.len())
    },
    |draw, _, catalogue| {
        hum(
            named(catalogue, "vertical forces"),
            draw.between(2.0, 4.0, 1),
            draw.between(3.0, 11.0, 1),
        )
    },
    |draw, _, catalogue| {
        hum(
            named(catalogue, "accelerations"),
            draw.between(0.15, 0.3, 2),
            draw.between(2.0, 7.0, 1),
        )
    },
    |draw, _, catalogue| {
        let width = draw.between(1.5, 3.0, 1);
        let dead =
            move |value: f64| if value.abs() < width { 0.0 } else { value - width.copysign(value) };
        values(
            format!("dead zone of {width} kN of the guiding forces"),
            named(catalogue, "guiding forces"),
            move |value, _, _| dead(value),
        )
    },
    |draw, _, catalogue| {
        let curved = draw.between(0.2, 0.4, 2);
        let says = format!("guiding forces with a curved characteristic: {curved} more at 50 kN");
        values(says, named(catalogue, "guiding forces"), move |value, _, _| {
            value * (1.0 + curved * value / 50.0)
        })
    },
    |draw, _, _| guiding_in_vertical(draw.between(0.06, 0.12, 2)),
    |draw, base, _| {
        let deviation = draw.between(4.0, 8.0, 1);
        let shifts = scattered(draw, base, deviation);
        record(
            format!("records shifted anew in each section, by {deviation} m"),
            move |signals, _, at| {
                signals.axis.iter_mut().for_each(|x| *x += shifts[at]);
            },
        )
    },
    |draw, _, _| {
        let longer = draw.between(0.02, 0.04, 3);
        record(format!("distance counted too long by {longer}"), move |signals, section, _| {
            signals.axis.iter_mut().for_each(|x| *x += longer * (*x - section.start));
        })
    },
    |draw, base, _| {
        wheel_flat(1 + draw.below(4), draw.between(15.0, 30.0, 0), base.value("wheelset.radius"))
    },
    |draw, base, catalogue| {
        let bogie = draw.one(&["Y_1R Y_1L Y_2R Y_2L", "Q_3R Q_3L Q_4R Q_4L"]);
        let deviation = draw.between(3.0, 5.0, 1);
        let offsets = scattered(draw, base, deviation);
        values(
            format!("offset anew in each section, by {deviation} kN, of {bogie}"),
            named(catalogue, bogie),
            move |value, _, at| value + offsets[at],
        )
    },
    |draw, _, catalogue| with_speed(named(catalogue, "ay_I ay_II"), draw.between(0.06, 0.12, 3)),
    |draw, _, catalogue| {
        with_speed(named(catalogue, "Y_1R Y_2R Y_3R Y_4R"), draw.between(1.0, 2.0, 2))
    },
];

/// The channels of a group, or of a list of channels.
fn named(catalogue: &Catalogue, group: &str) -> Vec<String> {
    catalogue.channels(group).unwrap_or_else(|| group.split(' ').map(str::to_string).collect())
}

/// The vehicle has `factor` times the value of its file.
fn scaled(base: &Base, key: &str, factor: f64) -> Fault {
    Fault {
        vehicle: vec![(key.to_string(), base.value(key) / factor)],
        ..record(format!("{key} times {factor}"), |_, _, _| {})
    }
}

/// The vehicle has a larger value than its file.
fn higher(base: &Base, key: &str, by: f64) -> Fault {
    Fault {
        vehicle: vec![(key.to_string(), base.value(key) - by)],
        ..record(format!("{key} plus {by} m"), |_, _, _| {})
    }
}

fn record(
    says: String,
    does: impl Fn(&mut Signals, &Section, usize) + Send + Sync + 'static,
) -> Fault {
    Fault { says, vehicle: Vec::new(), does: Box::new(does) }
}

/// Changes each sample as a function of its value, the speed in m/s and the index of the section.
fn values(
    says: String,
    channels: Vec<String>,
    of: impl Fn(f64, f64, usize) -> f64 + Send + Sync + 'static,
) -> Fault {
    record(says, move |signals, section, at| {
        let speed = section.speed.unwrap_or(0.0);
        for channel in
            signals.channels.iter_mut().filter(|channel| channels.contains(&channel.name))
        {
            channel.values.iter_mut().for_each(|value| *value = of(*value, speed, at));
        }
    })
}

/// One random number per section.
fn scattered(draw: &mut Draw, base: &Base, deviation: f64) -> Vec<f64> {
    base.sections.iter().map(|_| draw.normal(deviation)).collect()
}

fn drift(channels: Vec<String>, rate: f64) -> Fault {
    values(
        format!("drift of {rate} a section of {}", channels.join(", ")),
        channels,
        move |value, _, at| value + rate * at as f64,
    )
}

/// Decreases to `end` in the last section.
fn fading(channels: Vec<String>, end: f64, sections: usize) -> Fault {
    let says = format!("gain that fades to {end} of {}", channels.join(", "));
    values(says, channels, move |value, _, at| {
        value * (1.0 + (end - 1.0) * at as f64 / (sections.max(2) - 1) as f64)
    })
}

fn hum(channels: Vec<String>, amplitude: f64, frequency: f64) -> Fault {
    record(
        format!("hum of {amplitude} at {frequency} Hz of {}", channels.join(", ")),
        move |signals, _, _| {
            let rate = signals.rate;
            for channel in
                signals.channels.iter_mut().filter(|channel| channels.contains(&channel.name))
            {
                for (n, value) in channel.values.iter_mut().enumerate() {
                    *value += amplitude * (TAU * frequency * n as f64 / rate).sin();
                }
            }
        },
    )
}

fn guiding_in_vertical(share: f64) -> Fault {
    record(
        format!("{share} of the guiding force in the vertical force of the same wheel"),
        move |signals, _, _| {
            let before = signals.clone();
            for channel in &mut signals.channels {
                let Some(wheel) = channel.name.strip_prefix("Q_") else { continue };
                let Some(guiding) = before.channel(&format!("Y_{wheel}")) else { continue };
                channel
                    .values
                    .iter_mut()
                    .zip(&guiding.values)
                    .for_each(|(value, guiding)| *value += share * guiding);
            }
        },
    )
}

/// An impact of 15 ms at every revolution, on both wheels.
fn wheel_flat(wheelset: usize, force: f64, radius: f64) -> Fault {
    record(
        format!("flats of wheelset {wheelset}, blows of {force} kN"),
        move |signals, section, _| {
            let turn = TAU * radius / section.speed.unwrap_or(1.0);
            let rate = signals.rate;
            for channel in signals
                .channels
                .iter_mut()
                .filter(|channel| channel.name.starts_with(&format!("Q_{wheelset}")))
            {
                for (n, value) in channel.values.iter_mut().enumerate() {
                    *value += if (n as f64 / rate) % turn < 0.015 { force } else { 0.0 };
                }
            }
        },
    )
}

/// `size` at 100 km/h.
fn with_speed(channels: Vec<String>, size: f64) -> Fault {
    let says = format!(
        "offset that grows with the square of the speed, {size} at 100 km/h, of {}",
        channels.join(", ")
    );
    values(says, channels, move |value, speed, _| value + size * (3.6 * speed / 100.0).powi(2))
}
