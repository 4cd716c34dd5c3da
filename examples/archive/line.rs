//! The line of a run: straight track and curves in turn, with irregularities.

use std::f64::consts::TAU;

use fishplate::effects::Gauss;
use fishplate::model::TrackTable;

/// Distance of the points of a track table in m.
const STEP: f64 = 0.25;
/// Lengths in m: straight track before the first curve and between curves, a transition, a curve.
pub const STRAIGHT: f64 = 400.0;
const TRANSITION: f64 = 100.0;
const CURVE: f64 = 400.0;
/// Spectra of ORE B 176, in m rad, and their corners in rad/m: S = A Oc^2 / ((W^2 + Or^2) (W^2 +
/// Oc^2)).
const VERTICAL: f64 = 4.032e-7;
const LATERAL: f64 = 2.119e-7;
const CORNERS: (f64, f64) = (0.8246, 0.0206);
/// Range of the wave numbers of the irregularities in rad/m, and their number.
const WAVES: (f64, f64) = (0.08, 6.0);
const COUNT: usize = 160;

/// The speed of a run in km/h, and the radius in m and the cant in mm of its curves: one kind for
/// each zone of Annex T.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    pub speed: f64,
    radius: f64,
    cant: f64,
}

/// Cant deficiencies of 95 mm (zone 2), 96 mm (zone 3) and 85 mm (zone 4); straight track alone in
/// the first kind.
pub const KINDS: [Kind; 4] = [
    Kind { speed: 145.0, radius: f64::INFINITY, cant: 0.0 },
    Kind { speed: 115.0, radius: 1000.0, cant: 60.0 },
    Kind { speed: 88.0, radius: 500.0, cant: 87.0 },
    Kind { speed: 70.0, radius: 320.0, cant: 95.0 },
];

/// The track of a run of a length in m.
pub fn track(kind: &Kind, length: f64, random: &mut Gauss) -> TrackTable {
    let waves = waves(random);
    let period = STRAIGHT + 2.0 * TRANSITION + CURVE;
    let mut table = TrackTable::default();
    for n in 0..((length + STRAIGHT) / STEP) as usize {
        let s = n as f64 * STEP;
        let (turn, along) = ((s / period).floor(), s % period - STRAIGHT);
        let share = (along / TRANSITION)
            .min((2.0 * TRANSITION + CURVE - along) / TRANSITION)
            .clamp(0.0, 1.0);
        let side = if (turn as usize).is_multiple_of(2) { share } else { -share };
        let mut sum = [0.0; 4];
        for (wave, amplitude, phase) in &waves {
            (0..4).for_each(|i| sum[i] += amplitude[i] * (wave * s + phase[i]).cos());
        }
        table.distance.push(s);
        table.curvature.push(side / kind.radius);
        table.cant.push(side * kind.cant);
        table.alignment.push(sum[0]);
        table.level.push(sum[1]);
        table.cross_level.push(sum[2]);
        table.gauge.push(sum[3]);
    }
    table
}

/// Wave numbers with the amplitudes and phases of alignment, level, cross level and gauge, in mm.
fn waves(random: &mut Gauss) -> Vec<(f64, [f64; 4], [f64; 4])> {
    let (low, high) = WAVES;
    let ratio = (high / low).powf(1.0 / COUNT as f64);
    let one = |n: usize| {
        let from = low * ratio.powf(n as f64);
        let (wave, width) = (from * ratio.sqrt(), from * (ratio - 1.0));
        let shape = CORNERS.0.powi(2)
            / ((wave.powi(2) + CORNERS.1.powi(2)) * (wave.powi(2) + CORNERS.0.powi(2)));
        let amplitude = |a: f64| 1e3 * (2.0 * a * shape * width).sqrt();
        let (vertical, lateral) = (amplitude(VERTICAL), amplitude(LATERAL));
        let mut phase = || TAU * random.uniform();
        (
            wave,
            [lateral, vertical, 0.8 * vertical, 0.4 * lateral],
            [phase(), phase(), phase(), phase()],
        )
    };
    (0..COUNT).map(one).collect()
}
