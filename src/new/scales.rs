//! The size of force and motion in the records, for the ranges of effects.

use super::{
    records::{Channel, Pair, Roles},
    windows::{Cut, piece},
};
use crate::diagnose::observe::layout::Spectrum;
use crate::init::protocol::identifier;
use crate::units::{Dimension, Unit};

const FORCE: Dimension = Dimension::of([1, 1, -2, 0, 0, 0]);
const MOMENT: Dimension = Dimension::of([2, 1, -2, 0, 0, 0]);
const CURRENT: Dimension = Dimension::of([0, 0, 0, 0, 1, 0]);
const VOLTAGE: Dimension = Dimension::of([2, 1, -3, 0, -1, 0]);
const PRESSURE: Dimension = Dimension::of([-1, 1, -2, 0, 0, 0]);
const FORCES: [Dimension; 5] = [FORCE, MOMENT, CURRENT, VOLTAGE, PRESSURE];
const SPEED: Dimension = Dimension::of([1, 0, -1, 0, 0, 0]);
const ACCELERATION: Dimension = Dimension::of([1, 0, -2, 0, 0, 0]);
const TURN_ACCELERATION: Dimension = Dimension::of([0, 0, -2, 0, 0, 0]);
/// Units of angles; a column in another plain number is no motion.
const ANGLES: [&str; 6] = ["rad", "mrad", "deg", "°", "rev", "urad"];
/// Parts of the spectrum in which a motion is differentiated or integrated.
const PARTS: usize = 60;

/// How often a motion was differentiated: a position 0 times, a speed once, an acceleration twice.
type Order = i32;

/// Force and motion of one set of effects: units as text and rms values in them.
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// Added to names of parameters where there are several forces: `_tau_2`.
    pub suffix: String,
    pub channel: String,
    pub force: (String, f64),
    pub position: (String, f64),
    pub speed: f64,
    pub acceleration: f64,
}

/// The column with the speed of a motion, or the position from which it follows, for the columns of
/// the section table.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    pub column: String,
    pub unit: Unit,
    pub order: i32,
}

/// A set of effects for each force that is compared; if the motion is compared, one for the force
/// among the inputs.
pub fn scales(pairs: &[Pair], roles: &Roles, cut: &Cut) -> Vec<Scales> {
    let measured = &pairs[0].measured;
    let force = |name: &&String| {
        measured.channel(name).is_some_and(|channel| FORCES.contains(&channel.unit.dimension))
    };
    let compared: Vec<&String> = roles.outputs.iter().filter(force).collect();
    let forces = if compared.is_empty() {
        roles.inputs.iter().filter(force).take(1).collect()
    } else {
        compared
    };
    let several = forces.len() > 1;
    let one = |name: &&String| {
        let channel = measured.channel(name)?;
        let motion = motion(pairs, roles, Some(name))?;
        let (unit, sizes) = sizes(pairs, cut, &motion)?;
        Some(Scales {
            suffix: if several { format!("_{}", identifier(name)) } else { String::new() },
            channel: (*name).clone(),
            force: (channel.unit.text.clone(), rms(pairs, name, &channel.unit)),
            position: (unit, sizes[0]),
            speed: sizes[1],
            acceleration: sizes[2],
        })
    };
    forces.iter().filter_map(one).collect()
}

/// The motion that belongs to a force: the one with the same number at its end, or else the first;
/// a position before a speed.
pub fn motion(pairs: &[Pair], roles: &Roles, force: Option<&str>) -> Option<Motion> {
    let measured = &pairs[0].measured;
    let number =
        |name: &str| name.chars().rev().take_while(char::is_ascii_digit).collect::<String>();
    let order = |channel: &Channel| -> Option<Order> {
        match channel.unit.dimension {
            Dimension::LENGTH => Some(0),
            Dimension::ONE if ANGLES.contains(&channel.unit.text.as_str()) => Some(0),
            SPEED | Dimension::FREQUENCY if channel.unit.text != "Hz" => Some(1),
            ACCELERATION | TURN_ACCELERATION => Some(2),
            _ => None,
        }
    };
    let all = roles.inputs.iter().chain(&roles.outputs).filter_map(|name| {
        let channel = measured.channel(name)?;
        let order = order(channel)?;
        let other =
            force.is_some_and(|force| !number(force).is_empty() && number(force) != number(name));
        Some((other, order, Motion { column: name.clone(), unit: channel.unit.clone(), order }))
    });
    all.min_by_key(|(other, order, _)| (*other, *order)).map(|(.., motion)| motion)
}

/// The unit of the position, and rms values of position, speed and acceleration, from the spectra
/// of a motion in all records.
fn sizes(pairs: &[Pair], cut: &Cut, motion: &Motion) -> Option<(String, [f64; 3])> {
    let (low, high) = cut.content;
    let edge = |n: usize| low * (high / low).powf(n as f64 / PARTS as f64);
    let mut squares = [0.0; 3];
    let mut lasts = 0.0;
    for pair in pairs {
        let (from, to) = pair.common(false);
        let Some(piece) = piece(&pair.measured, &motion.column, false, from, to) else { continue };
        // A long record counts as much more as it is longer. Records may be in different units.
        let weight = piece.values.len() as f64 / piece.rate;
        let factor = pair
            .measured
            .channel(&motion.column)
            .map_or(1.0, |channel| channel.unit.factor / motion.unit.factor);
        let spectrum = Spectrum::new(&piece);
        lasts += weight;
        for n in 0..PARTS {
            let (a, b) = (edge(n), edge(n + 1));
            let power = weight * factor * factor * spectrum.power(a, b);
            for (of, square) in squares.iter_mut().enumerate() {
                *square += power
                    * (2.0 * std::f64::consts::PI * (a * b).sqrt())
                        .powi(2 * (of as Order - motion.order));
            }
        }
    }
    if lasts == 0.0 {
        return None;
    }
    let squares = squares.map(|square| square / lasts);
    // A speed in km/h integrates to km/h s: positions of speeds and accelerations are in SI.
    let si = motion.unit.factor;
    let turns =
        matches!(motion.unit.dimension, Dimension::ONE | Dimension::FREQUENCY | TURN_ACCELERATION);
    let (unit, factor) = match motion.order {
        0 => (motion.unit.text.clone(), 1.0),
        _ => (if turns { "rad" } else { "m" }.to_string(), si),
    };
    Some((unit, squares.map(|square: f64| factor * square.sqrt())))
}

/// The rms value of a measured channel over all records, in a unit.
fn rms(pairs: &[Pair], name: &str, unit: &Unit) -> f64 {
    let channels = || pairs.iter().filter_map(|pair| pair.measured.channel(name));
    let square = |channel: &Channel| -> f64 {
        channel.values.iter().map(|value| unit.from_si(channel.unit.to_si(*value)).powi(2)).sum()
    };
    let count: usize = channels().map(|channel| channel.values.len()).sum();
    (channels().map(square).sum::<f64>() / count.max(1) as f64).sqrt()
}

/// Unit and scale of a parameter by what it multiplies, as `of` in the list of effects.
pub fn scale_of(of: &str, scales: &Scales) -> Option<(String, f64)> {
    let ((force, size), (position, amplitude)) = (&scales.force, &scales.position);
    Some(match of {
        "F" => (force.clone(), *size),
        "X" => (position.clone(), *amplitude),
        "F/V" => (format!("{force} s/{position}"), size / scales.speed),
        "F/A" => (format!("{force} s^2/{position}"), size / scales.acceleration),
        "F/X" => (format!("{force}/{position}"), size / amplitude),
        "F/X^2" => (format!("{force}/{position}^2"), size / amplitude.powi(2)),
        "F/X^3" => (format!("{force}/{position}^3"), size / amplitude.powi(3)),
        _ => return None,
    })
}
