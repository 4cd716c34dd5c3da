//! Track input: curvature, cant and irregularities along the line.

use super::{parameters::Vehicle, spline::Spline};

/// A measured track: one value per point, distance strictly increasing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrackTable {
    /// In m.
    pub distance: Vec<f64>,
    /// In 1/m, positive in a right-hand curve.
    pub curvature: Vec<f64>,
    /// In mm, positive if the left rail is higher.
    pub cant: Vec<f64>,
    /// In mm, positive to the right.
    pub alignment: Vec<f64>,
    /// In mm, positive downward.
    pub level: Vec<f64>,
    /// In mm, positive if the left rail is higher.
    pub cross_level: Vec<f64>,
    /// Deviation from the design gauge in mm.
    pub gauge: Vec<f64>,
}

/// Length over which the irregularities are faded in, in m.
const FADE: f64 = 10.0;

/// A track prepared for one vehicle: interpolated, with the track parameters of that vehicle.
#[derive(Clone, Debug)]
pub struct Track {
    distance: Vec<f64>,
    /// One per interval of `distance`.
    pieces: Vec<Piece>,
    /// The line behind the last point.
    end: Line,
}

/// Four cubic polynomials in the distance u within an interval: c0 + u (c1 + u (c2 + u c3)).
#[derive(Clone, Copy, Debug, Default)]
struct Piece {
    /// Curvature, cant angle, heading (integral of the curvature), lateral position (integral of
    /// the heading).
    line: [[f64; 4]; 4],
    /// Alignment, gauge, height of the right rail and of the left.
    uneven: [[f64; 4]; 4],
}

/// The line at a body: curvature in 1/m, cant angle in rad, heading in rad, lateral position in m.
#[derive(Clone, Copy, Debug, Default)]
pub struct Line {
    pub kappa: f64,
    pub cant: f64,
    pub theta: f64,
    pub y: f64,
}

/// The irregularities under a wheelset, in m; rates per m of distance.
#[derive(Clone, Copy, Debug, Default)]
pub struct Irregularity {
    pub alignment: f64,
    pub gauge: f64,
    /// Right rail, left rail.
    pub height: [f64; 2],
    pub slope: [f64; 2],
}

/// Interval of the last lookup; positions increase.
pub type Hint = usize;

impl Track {
    /// A track of two or more points for `vehicle`.
    pub fn new(table: &TrackTable, vehicle: &Vehicle) -> Self {
        let distance = table.distance.clone();
        let curvature: Vec<f64> =
            table.curvature.iter().map(|kappa| kappa * vehicle.curvature_scale).collect();
        let sharpest = curvature.iter().fold(0.0_f64, |most, kappa| most.max(kappa.abs()));
        let error =
            |kappa: f64| if sharpest > 0.0 { vehicle.cant_error * kappa / sharpest } else { 0.0 };
        let angle = |i: usize| {
            (table.cant[i] + error(curvature[i])) * 1e-3 / (2.0 * vehicle.half_contact_spacing)
        };
        let spline = |values: &[f64], function: u64| {
            let mut uneven: Vec<f64> =
                values.iter().map(|value| value * 1e-3 * vehicle.irregularity_scale).collect();
            if vehicle.residual_irregularity > 0.0 {
                let unseen = short_waves(&distance, function);
                uneven.iter_mut().zip(unseen).for_each(|(value, unseen)| {
                    *value += vehicle.residual_irregularity * 1e-3 * unseen
                });
            }
            Spline::new(&distance, uneven)
        };
        let (alignment, gauge) = (spline(&table.alignment, 1), spline(&table.gauge, 2));
        let (level, cross_level) = (spline(&table.level, 3), spline(&table.cross_level, 4));
        let (mut theta, mut y) = (0.0, 0.0);
        let mut pieces = Vec::with_capacity(distance.len() - 1);
        for i in 0..distance.len() - 1 {
            let width = distance[i + 1] - distance[i];
            let (from, rise) = (curvature[i], (curvature[i + 1] - curvature[i]) / width);
            let (cant, cant_rise) = (angle(i), (angle(i + 1) - angle(i)) / width);
            let line = [
                [from, cant, theta, y],
                [rise, cant_rise, from, theta],
                [0.0, 0.0, 0.5 * rise, 0.5 * from],
                [0.0, 0.0, 0.0, rise / 6.0],
            ];
            let (level, cross) = (level.cubic(i, width), cross_level.cubic(i, width));
            let (alignment, mut gauge) = (alignment.cubic(i, width), gauge.cubic(i, width));
            gauge[0] += vehicle.gauge_error * 1e-3;
            let uneven = [0, 1, 2, 3].map(|n| {
                [alignment[n], gauge[n], level[n] + 0.5 * cross[n], level[n] - 0.5 * cross[n]]
            });
            pieces.push(Piece { line, uneven });
            y += width * (theta + width * (0.5 * from + width * rise / 6.0));
            theta += width * (from + 0.5 * width * rise);
        }
        let last = distance.len() - 1;
        let end = Line { kappa: curvature[last], cant: angle(last), theta, y };
        Self { distance, pieces, end }
    }

    /// Distance of the first point in m.
    pub fn start(&self) -> f64 {
        self.distance[0]
    }

    /// Distance of the last point in m.
    pub fn end(&self) -> f64 {
        self.distance[self.distance.len() - 1]
    }

    #[inline(always)]
    fn interval(&self, s: f64, hint: &mut Hint) -> usize {
        let last = self.distance.len() - 2;
        let mut i = (*hint).min(last);
        while i > 0 && self.distance[i] > s {
            i -= 1;
        }
        while i < last && self.distance[i + 1] <= s {
            i += 1;
        }
        *hint = i;
        i
    }

    /// Straight and level before the table; constant behind it.
    #[inline(always)]
    pub fn line(&self, s: f64, hint: &mut Hint) -> Line {
        if s <= self.start() {
            return Line::default();
        }
        if s >= self.end() {
            let (Line { kappa, cant, theta, y }, u) = (self.end, s - self.end());
            return Line {
                kappa,
                cant,
                theta: theta + u * kappa,
                y: y + u * (theta + 0.5 * u * kappa),
            };
        }
        let i = self.interval(s, hint);
        let [kappa, cant, theta, y] = values(&self.pieces[i].line, s - self.distance[i]);
        Line { kappa, cant, theta, y }
    }

    /// Zero outside the table; faded in over its first metres.
    #[inline(always)]
    pub fn irregularity(&self, s: f64, hint: &mut Hint) -> Irregularity {
        if s <= self.start() || s >= self.end() {
            return Irregularity::default();
        }
        let i = self.interval(s, hint);
        let (piece, u) = (&self.pieces[i].uneven, s - self.distance[i]);
        let (value, slope) = (values(piece, u), slopes(piece, u));
        let into = (s - self.start()) / FADE;
        let (fade, fading) = if into < 1.0 { (into, 1.0 / FADE) } else { (1.0, 0.0) };
        Irregularity {
            alignment: fade * value[0],
            gauge: fade * value[1],
            height: [fade * value[2], fade * value[3]],
            slope: [fade * slope[2] + fading * value[2], fade * slope[3] + fading * value[3]],
        }
    }
}

/// Corner wavelength of the short waves in m; filtered twice with a first-order low-pass.
const SHORT_WAVES: f64 = 0.6;

/// A random function of the distance with standard deviation 1 and wavelengths of some metres and
/// less; reproducible.
fn short_waves(distance: &[f64], function: u64) -> Vec<f64> {
    let mut random = fastrand::Rng::with_seed(
        function.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ distance.len() as u64,
    );
    let mut state = [0.0; 2];
    let mut last = distance[0];
    let mut waves: Vec<f64> = distance
        .iter()
        .map(|s| {
            let share = 1.0 - (-(s - last) / SHORT_WAVES).exp();
            last = *s;
            // Uniform numbers are sufficient: after the filter they are nearly normal.
            state[0] += share * (random.f64() - 0.5 - state[0]);
            state[1] += share * (state[0] - state[1]);
            state[1]
        })
        .collect();
    let rms = (waves.iter().map(|value| value * value).sum::<f64>() / waves.len() as f64)
        .sqrt()
        .max(1e-12);
    waves.iter_mut().for_each(|value| *value /= rms);
    waves
}

#[inline(always)]
fn values(c: &[[f64; 4]; 4], u: f64) -> [f64; 4] {
    let mut value = [0.0; 4];
    for n in 0..4 {
        value[n] = c[0][n] + u * (c[1][n] + u * (c[2][n] + u * c[3][n]));
    }
    value
}

#[inline(always)]
fn slopes(c: &[[f64; 4]; 4], u: f64) -> [f64; 4] {
    let mut slope = [0.0; 4];
    for n in 0..4 {
        slope[n] = c[1][n] + u * (2.0 * c[2][n] + u * (3.0 * c[3][n]));
    }
    slope
}
