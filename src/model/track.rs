//! What the vehicle runs over: curvature, cant and irregularities along the line.

use super::parameters::Vehicle;
use super::spline::Spline;

/// A track as measured: one number per point, distance strictly increasing.
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

/// Over which the irregularities are faded in, in m.
const FADE: f64 = 10.0;

/// A track made ready for one vehicle: interpolated, and with the effects on the track input of that vehicle.
#[derive(Clone, Debug)]
pub struct Track {
    distance: Vec<f64>,
    curvature: Vec<f64>,
    /// Cant angle in rad.
    cant: Vec<f64>,
    /// Integral of the curvature and its integral.
    heading: Vec<f64>,
    lateral: Vec<f64>,
    alignment: Spline,
    level: Spline,
    cross_level: Spline,
    gauge: Spline,
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

/// Where the last look into the table was: positions only go forward.
pub type Hint = usize;

impl Track {
    /// A track of two or more points for `vehicle`.
    #[must_use]
    pub fn new(table: &TrackTable, vehicle: &Vehicle) -> Self {
        let distance = table.distance.clone();
        let curvature = table.curvature.clone();
        let sharpest = curvature.iter().fold(0.0_f64, |most, kappa| most.max(kappa.abs()));
        let error = |kappa: f64| if sharpest > 0.0 { vehicle.cant_error * kappa / sharpest } else { 0.0 };
        let cant =
            table.cant.iter().zip(&curvature).map(|(cant, kappa)| (cant + error(*kappa)) * 1e-3 / (2.0 * vehicle.half_contact_spacing));
        let cant = cant.collect();
        let (mut heading, mut lateral) = (vec![0.0], vec![0.0]);
        for i in 1..distance.len() {
            let width = distance[i] - distance[i - 1];
            let (from, to) = (curvature[i - 1], curvature[i]);
            let theta = heading[i - 1];
            lateral.push(lateral[i - 1] + width * (theta + width * (from / 3.0 + to / 6.0)));
            heading.push(theta + 0.5 * width * (from + to));
        }
        let spline =
            |values: &[f64]| Spline::new(&distance, values.iter().map(|value| value * 1e-3 * vehicle.irregularity_scale).collect());
        let (alignment, level) = (spline(&table.alignment), spline(&table.level));
        let (cross_level, gauge) = (spline(&table.cross_level), spline(&table.gauge));
        Self { distance, curvature, cant, heading, lateral, alignment, level, cross_level, gauge }
    }

    /// Distance of the first point in m.
    #[must_use]
    pub fn start(&self) -> f64 {
        self.distance[0]
    }

    /// Distance of the last point in m.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.distance[self.distance.len() - 1]
    }

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

    /// Straight and level before the table; as at its end behind it.
    pub fn line(&self, s: f64, hint: &mut Hint) -> Line {
        if s <= self.start() {
            return Line::default();
        }
        let last = self.distance.len() - 1;
        if s >= self.end() {
            let (kappa, u) = (self.curvature[last], s - self.end());
            let theta = self.heading[last];
            let y = self.lateral[last] + u * (theta + 0.5 * u * kappa);
            return Line { kappa, cant: self.cant[last], theta: theta + u * kappa, y };
        }
        let i = self.interval(s, hint);
        let width = self.distance[i + 1] - self.distance[i];
        let u = s - self.distance[i];
        let share = u / width;
        let (from, rise) = (self.curvature[i], self.curvature[i + 1] - self.curvature[i]);
        let cant = self.cant[i] + share * (self.cant[i + 1] - self.cant[i]);
        let theta = self.heading[i] + u * (from + 0.5 * share * rise);
        let y = self.lateral[i] + u * (self.heading[i] + u * (0.5 * from + share * rise / 6.0));
        Line { kappa: from + share * rise, cant, theta, y }
    }

    /// Zero outside the table; faded in over its first metres.
    pub fn irregularity(&self, s: f64, hint: &mut Hint) -> Irregularity {
        if s <= self.start() || s >= self.end() {
            return Irregularity::default();
        }
        let i = self.interval(s, hint);
        let width = self.distance[i + 1] - self.distance[i];
        let share = (s - self.distance[i]) / width;
        let into = (s - self.start()) / FADE;
        let (fade, fading) = if into < 1.0 { (into, 1.0 / FADE) } else { (1.0, 0.0) };
        let (level, level_slope) = self.level.at(i, width, share);
        let (cross, cross_slope) = self.cross_level.at(i, width, share);
        let rail = |k: f64| level + k * 0.5 * cross;
        let slope = |k: f64| fade * (level_slope + k * 0.5 * cross_slope) + fading * rail(k);
        Irregularity {
            alignment: fade * self.alignment.at(i, width, share).0,
            gauge: fade * self.gauge.at(i, width, share).0,
            height: [fade * rail(1.0), fade * rail(-1.0)],
            slope: [slope(1.0), slope(-1.0)],
        }
    }
}
