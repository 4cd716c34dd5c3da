//! A line: sections of four zones, with irregularities drawn from the spectra of ORE B 176.

use fishplate::effects::Gauss;
use fishplate::model::TrackTable;

use super::vehicles::Design;

/// Distance of the points of a track table in m.
const STEP: f64 = 0.25;
/// Spectra of ORE B 176, in m rad, and their corners in rad/m: S = A Oc^2 / ((W^2 + Or^2) (W^2 +
/// Oc^2)).
const VERTICAL: f64 = 4.032e-7;
const LATERAL: f64 = 2.119e-7;
const CORNERS: (f64, f64) = (0.8246, 0.0206);
/// Range of the wave numbers of the irregularities in rad/m, and their number.
const WAVES: (f64, f64) = (0.08, 6.0);
const COUNT: usize = 260;

/// One section.
#[derive(Clone, Debug)]
pub struct Stretch {
    pub name: String,
    pub zone: usize,
    /// In m.
    pub start: f64,
    pub end: f64,
    /// In m; none on straight track.
    pub radius: Option<f64>,
    pub left: bool,
    /// In mm.
    pub cant: f64,
    pub deficiency: f64,
    /// In km/h.
    pub speed: f64,
}

impl Stretch {
    pub fn direction(&self) -> &'static str {
        match self.radius {
            None => "straight",
            Some(_) if self.left => "left",
            Some(_) => "right",
        }
    }

    /// Curvature in 1/m and cant in mm, with the sign of the curve.
    fn curve(&self) -> (f64, f64) {
        let side = if self.left { -1.0 } else { 1.0 };
        self.radius.map_or((0.0, 0.0), |radius| (side / radius, side * self.cant))
    }
}

/// Sections for a vehicle, as many in each of four zones.
pub fn stretches(design: &Design, per_zone: usize, random: &mut Gauss) -> Vec<Stretch> {
    let mut all = Vec::new();
    for zone in 1..=4 {
        let radii = [(0.0, 0.0), (800.0, 2000.0), (405.0, 595.0), (255.0, 395.0)][zone - 1];
        for n in 0..per_zone {
            let name = format!("S{:02}", all.len() + 1);
            let between =
                |random: &mut Gauss, (low, high): (f64, f64)| low + (high - low) * random.uniform();
            if zone == 1 {
                let speed = between(random, (0.8 * design.speeds.1, design.speeds.1));
                all.push(Stretch {
                    name,
                    zone,
                    start: 100.0,
                    end: 350.0,
                    radius: None,
                    left: false,
                    cant: 0.0,
                    deficiency: 0.0,
                    speed,
                });
                continue;
            }
            let radius = (between(random, radii) / 5.0).round() * 5.0;
            let cant =
                [0.0, 50.0, 95.0, 95.0][zone - 1] + 5.0 * (between(random, (-5.0, 5.0))).round();
            let wanted = between(random, (0.45 * design.deficiency, design.deficiency));
            let speed = (3.6 * (9.81 * radius * (wanted + cant) / 1500.0).sqrt())
                .clamp(design.speeds.0, design.speeds.1);
            let deficiency = 1500.0 * (speed / 3.6).powi(2) / (9.81 * radius) - cant;
            let start = 40.0 + ramp(cant) + 30.0;
            let long = if zone == 4 { 80.0 } else { 110.0 };
            all.push(Stretch {
                name,
                zone,
                start,
                end: start + long,
                radius: Some(radius),
                left: n % 2 == 1,
                cant,
                deficiency,
                speed,
            });
        }
    }
    all
}

/// Length of a transition in m.
pub fn ramp(cant: f64) -> f64 {
    (0.8 * cant).max(40.0)
}

/// Amplitudes and phases of the irregularities of a section: four functions of distance.
pub struct Irregularities {
    waves: Vec<(f64, [f64; 4], [f64; 4])>,
    modulation: (f64, f64),
}

impl Irregularities {
    pub fn draw(random: &mut Gauss) -> Self {
        let (low, high) = WAVES;
        let ratio = (high / low).powf(1.0 / COUNT as f64);
        let waves = (0..COUNT)
            .map(|n| {
                let from = low * ratio.powi(n as i32);
                let (wave, width) = (from * ratio.sqrt(), from * (ratio - 1.0));
                let spectrum = |a: f64| {
                    a * CORNERS.0.powi(2)
                        / ((wave.powi(2) + CORNERS.1.powi(2)) * (wave.powi(2) + CORNERS.0.powi(2)))
                };
                let amplitude = |a: f64| 1e3 * (2.0 * spectrum(a) * width).sqrt();
                let (vertical, lateral) = (amplitude(1.5 * VERTICAL), amplitude(1.5 * LATERAL));
                let mut phase = || std::f64::consts::TAU * random.uniform();
                (
                    wave,
                    [lateral, vertical, 0.8 * vertical, 0.4 * lateral],
                    [phase(), phase(), phase(), phase()],
                )
            })
            .collect();
        Self {
            waves,
            modulation: (0.02 + 0.03 * random.uniform(), std::f64::consts::TAU * random.uniform()),
        }
    }

    /// Alignment, level, cross level and gauge in mm.
    fn at(&self, s: f64) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for (wave, amplitude, phase) in &self.waves {
            (0..4).for_each(|i| sum[i] += amplitude[i] * (wave * s + phase[i]).cos());
        }
        let stronger = 1.0 + 0.25 * (self.modulation.0 * s + self.modulation.1).sin();
        sum.map(|value| stronger * value)
    }
}

/// The track of a section as recorded.
pub fn measured(stretch: &Stretch, irregularities: &Irregularities) -> TrackTable {
    let (kappa, cant) = stretch.curve();
    let ramp = ramp(stretch.cant);
    let mut table = TrackTable::default();
    let points = ((stretch.end + 65.0) / STEP) as usize;
    for n in 0..points {
        let s = n as f64 * STEP;
        let share = ((s - 40.0) / ramp).clamp(0.0, 1.0);
        let [alignment, level, cross, gauge] = irregularities.at(s);
        table.distance.push(s);
        table.curvature.push(share * kappa);
        table.cant.push(share * cant);
        table.alignment.push(alignment);
        table.level.push(level);
        table.cross_level.push(cross);
        table.gauge.push(gauge);
    }
    table
}
