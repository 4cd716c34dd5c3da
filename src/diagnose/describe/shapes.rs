//! Differences of the dynamic content: peaks and rms, and whether the ratio of spectra scales with
//! frequency, as a mode of the vehicle does, or with wavelength, as track and wheels do.
//!
//! Sections are treated as repetitions: intervals and the choice between the two scalings are by
//! bootstrap over sections, so that no model of noise is needed.

use crate::diagnose::levels::{
    common::RESAMPLES,
    shapes::{
        ALIKE, ERRORS, LARGE, LEAST_POINTS, RESOLVED, SPREAD, SURE, TO_THE_OCTAVE, TURNS, USABLE,
        WHOLE,
    },
};
use crate::diagnose::observe::{
    layout::{Piece, Spectrum},
    observations::Observations,
    observed::piece,
};
use crate::diagnose::settings::{Settings, Shape as Wanted};
use crate::effects::{Gauss, Signals};
use crate::metrics::{
    percentile::{Method, percentiles},
    statistics::{Divisor, standard_deviation},
};
use crate::result::{
    Statement,
    diagnosis::{Ratio, Shape, Strongest},
};
use crate::words;

/// All groups of channels whose dynamic content is compared; none where the catalogue does not
/// specify it.
pub fn shapes(
    settings: &Settings,
    seen: &Observations,
    radius: &dyn Fn(&str) -> Option<f64>,
    seed: u64,
) -> Vec<Shape> {
    let Some(wanted) = &settings.shape else { return Vec::new() };
    let radius = wanted.wheel_radius.as_deref().and_then(radius).filter(|radius| *radius > 0.0);
    let one = |group: usize| {
        let of = &seen.layout.channels;
        let channels: Vec<usize> =
            (0..of.len()).filter(|at| of[*at].group == group && of[*at].bands > 0).collect();
        let sections: Vec<Compared> = seen
            .first_runs()
            .into_iter()
            .filter_map(|at| Compared::new(seen, at, &channels, wanted))
            .collect();
        if sections.len() < 2 {
            return None;
        }
        let signals = channels.iter().map(|channel| of[*channel].name.clone()).collect();
        Some(shape(&sections, &settings.groups[group].says, signals, wanted, radius, seed))
    };
    (0..settings.groups.len()).filter_map(one).collect()
}

/// One section: logarithms of measured / simulated, averaged over the channels.
struct Compared {
    rms: f64,
    peak: f64,
    crest: f64,
    /// Mean speed in the unit of the axis per s.
    speed: f64,
    /// Simulated and measured spectra by channel, with the noise power per Hz to be added to the
    /// simulated one.
    spectra: Vec<(Spectrum, Spectrum, f64)>,
    /// Length of the record in s.
    length: f64,
    nyquist: f64,
}

impl Compared {
    fn new(seen: &Observations, at: usize, channels: &[usize], wanted: &Wanted) -> Option<Self> {
        let observed = &seen.sections[at];
        let pair = |channel: &usize| {
            let of = |signals: &Signals| {
                piece(signals, &seen.layout.channels[*channel].name, &observed.section)
            };
            Some((of(&observed.simulated)?, of(&observed.measured)?, seen.noise[*channel]))
        };
        Self::of(&channels.iter().map(pair).collect::<Option<Vec<_>>>()?, wanted.percentile)
    }

    /// From pieces simulated and measured by channel, with the standard deviation of the white
    /// noise to be added to the simulated one. Nothing where a channel is constant, since its ratio
    /// is not defined.
    fn of(pairs: &[(Piece, Piece, f64)], percentile: f64) -> Option<Self> {
        let (_, measured, _) = pairs.first()?;
        let mut own = Self {
            rms: 0.0,
            peak: 0.0,
            crest: 0.0,
            speed: measured.step * measured.rate,
            spectra: Vec::new(),
            length: measured.values.len() as f64 / measured.rate,
            nyquist: 0.5 * measured.rate,
        };
        let part = 1.0 / pairs.len() as f64;
        for (simulated, measured, noise) in pairs {
            let spread = |values: &[f64]| standard_deviation(values, Divisor::Population);
            let rms = spread(&measured.values)? / spread(&simulated.values)?.hypot(*noise);
            let peak = peak(&measured.values, percentile)? / peak(&simulated.values, percentile)?;
            if !(rms.is_normal() && peak.is_normal()) {
                return None;
            }
            own.rms += part * rms.ln();
            own.peak += part * peak.ln();
            own.crest += part * (peak / rms).ln();
            own.spectra.push((
                Spectrum::new(simulated),
                Spectrum::new(measured),
                noise * noise / own.nyquist,
            ));
        }
        Some(own)
    }

    /// Logarithm of the amplitude ratio around a frequency in Hz.
    fn ratio(&self, frequency: f64) -> f64 {
        let (low, high) = band(frequency, self.length);
        let one = |(simulated, measured, noise): &(Spectrum, Spectrum, f64)| {
            let allowed = simulated.power(low, high) + noise * (high - low);
            0.5 * ((measured.power(low, high) + 1e-12) / (allowed + 1e-12)).ln()
        };
        self.spectra.iter().map(one).sum::<f64>() / self.spectra.len() as f64
    }
}

/// The band in Hz around a frequency, for a record of `length` s.
fn band(frequency: f64, length: f64) -> (f64, f64) {
    let half = (0.5 * RESOLVED / length)
        .max(0.5 * frequency * (2f64.powf(1.0 / TO_THE_OCTAVE) - 2f64.powf(-1.0 / TO_THE_OCTAVE)));
    (frequency - half, frequency + half)
}

/// Largest distance of the percentiles from the median.
fn peak(values: &[f64], percentile: f64) -> Option<f64> {
    let at = percentiles(values, &[100.0 - percentile, 50.0, percentile], Method::Linear).ok()?;
    Some((at[2] - at[1]).max(at[1] - at[0]))
}

/// Ratios, one row per section, at common frequencies or at common wavelengths.
fn rows(sections: &[Compared], points: &[f64], speed: f64, by_wavelength: bool) -> Vec<Vec<f64>> {
    let factor = |section: &Compared| if by_wavelength { section.speed / speed } else { 1.0 };
    sections
        .iter()
        .map(|section| points.iter().map(|point| section.ratio(point * factor(section))).collect())
        .collect()
}

/// Share of the variance of the rows that their mean row explains. Each row is weighted by its
/// number of draws.
fn alike(rows: &[Vec<f64>], times: &[f64]) -> f64 {
    let count: f64 = times.iter().sum();
    let points = rows.first().map_or(0, Vec::len);
    let level = |row: &[f64]| row.iter().sum::<f64>() / row.len().max(1) as f64;
    let levels: Vec<f64> = rows.iter().map(|row| level(row)).collect();
    let (mut common, mut all) = (0.0, 0.0);
    for point in 0..points {
        let about = |at: usize| rows[at][point] - levels[at];
        let mean = (0..rows.len()).map(|at| times[at] * about(at)).sum::<f64>() / count;
        common += count * mean * mean;
        all += (0..rows.len()).map(|at| times[at] * about(at).powi(2)).sum::<f64>();
    }
    if all > 0.0 { common / all } else { 0.0 }
}

/// The point with the largest significant mean difference, and the mean there.
fn strongest(rows: &[Vec<f64>]) -> Option<(usize, f64)> {
    let n = rows.len() as f64;
    let at = |point: usize| {
        let mean = rows.iter().map(|row| row[point]).sum::<f64>() / n;
        let variance = rows.iter().map(|row| (row[point] - mean).powi(2)).sum::<f64>() / (n - 1.0);
        (mean.abs() >= LARGE.ln() && mean.abs() > ERRORS * (variance / n).sqrt())
            .then_some((point, mean))
    };
    (0..rows.first()?.len()).filter_map(at).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

fn shape(
    sections: &[Compared],
    says: &str,
    signals: Vec<String>,
    wanted: &Wanted,
    radius: Option<f64>,
    seed: u64,
) -> Shape {
    let mut random = Gauss::new(seed);
    let draws: Vec<Vec<f64>> = (0..RESAMPLES)
        .map(|_| {
            let mut times = vec![0.0; sections.len()];
            sections.iter().for_each(|_| times[random.below(sections.len())] += 1.0);
            times
        })
        .collect();
    let mean = |of: &dyn Fn(&Compared) -> f64, times: &[f64]| {
        sections.iter().zip(times).map(|(section, times)| times * of(section)).sum::<f64>()
            / sections.len() as f64
    };
    let ratio = |of: &dyn Fn(&Compared) -> f64| {
        let mut drawn: Vec<f64> = draws.iter().map(|times| mean(of, times)).collect();
        drawn.sort_by(f64::total_cmp);
        let at = |share: f64| drawn[((RESAMPLES - 1) as f64 * share) as usize].exp();
        Ratio { value: mean(of, &vec![1.0; sections.len()]).exp(), low: at(0.05), high: at(0.95) }
    };
    let (rms, peak, crest) = (
        ratio(&|section| section.rms),
        ratio(&|section| section.peak),
        ratio(&|section| section.crest),
    );
    let scaling = scaling(sections, wanted, &draws);
    let mut shape = Shape {
        quantity: says.to_string(),
        signals,
        rms,
        peak,
        crest,
        keeps_to: scaling.keeps_to.ok().map(Into::into),
        reason: scaling.keeps_to.err().map(Into::into),
        alike_by_frequency: scaling.alike.map(|alike| alike.0),
        alike_by_wavelength: scaling.alike.map(|alike| alike.1),
        strongest: scaling.strongest.map(|strongest| Strongest {
            per_wheel_turn: strongest
                .wavelength
                .zip(radius)
                .map(|(wavelength, radius)| std::f64::consts::TAU * radius / wavelength),
            ..strongest
        }),
        says: String::new(),
    };
    shape.says = words::text(&statement(&shape)).into();
    shape
}

struct Scaling {
    keeps_to: Result<&'static str, &'static str>,
    alike: Option<(f64, f64)>,
    strongest: Option<Strongest>,
}

fn scaling(sections: &[Compared], wanted: &Wanted, draws: &[Vec<f64>]) -> Scaling {
    let speed = (sections.iter().map(|section| section.speed.max(1e-9).ln()).sum::<f64>()
        / sections.len() as f64)
        .exp();
    let (slowest, fastest) =
        sections.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), section| {
            (low.min(section.speed), high.max(section.speed))
        });
    let moving = fastest > SPREAD * slowest;
    // Points that every section covers, in frequency and in wavelength.
    let shortest = sections.iter().map(|section| section.length).fold(f64::INFINITY, f64::min);
    let nyquist = sections.iter().map(|section| section.nyquist).fold(f64::INFINITY, f64::min);
    let low = wanted.range.0.max(RESOLVED / shortest) * speed / slowest;
    let high = wanted.range.1.min(USABLE * nyquist) * speed / fastest;
    let count = ((high / low).log2() * TO_THE_OCTAVE).floor();
    if count.is_nan() || count < LEAST_POINTS {
        return Scaling {
            keeps_to: Err("records are too short for their spectra"),
            alike: None,
            strongest: None,
        };
    }
    let points: Vec<f64> =
        (0..=count as usize).map(|at| low * 2f64.powf(at as f64 / TO_THE_OCTAVE)).collect();
    let by_frequency = rows(sections, &points, speed, false);
    if !moving {
        let strongest = strongest(&by_frequency).map(|(at, mean)| found(mean, points[at], None));
        return Scaling { keeps_to: Err("speeds are too similar"), alike: None, strongest };
    }
    let by_wavelength = rows(sections, &points, speed, true);
    let once = vec![1.0; sections.len()];
    let both = |times: &[f64]| (alike(&by_frequency, times), alike(&by_wavelength, times));
    let (frequency, wavelength) = both(&once);
    let longer = draws
        .iter()
        .map(|times| both(times))
        .filter(|(frequency, wavelength)| wavelength > frequency)
        .count();
    let share = longer as f64 / draws.len() as f64;
    let (keeps_to, rows) = match () {
        () if share >= SURE => (Ok("wavelength"), &by_wavelength),
        () if share <= 1.0 - SURE => (Ok("frequency"), &by_frequency),
        () => (
            Err("either fits as well"),
            if wavelength > frequency { &by_wavelength } else { &by_frequency },
        ),
    };
    let strongest =
        strongest(rows).map(|(at, mean)| found(mean, points[at], Some(speed / points[at])));
    let keeps_to = if strongest.is_none() {
        Err("no significant difference of the spectra")
    } else {
        keeps_to
    };
    Scaling { keeps_to, alike: Some((frequency, wavelength)), strongest }
}

fn found(mean: f64, frequency: f64, wavelength: Option<f64>) -> Strongest {
    Strongest { ratio: mean.exp(), frequency, wavelength, per_wheel_turn: None }
}

/// The group of channels whose spectra differ most consistently.
pub fn worth_a_word(all: &[Shape]) -> Option<Statement> {
    let share = |shape: &Shape| {
        shape.alike_by_frequency.unwrap_or(0.0).max(shape.alike_by_wavelength.unwrap_or(0.0))
    };
    let known = all.iter().filter(|shape| shape.keeps_to.is_some() && share(shape) >= ALIKE);
    known.max_by(|a, b| share(a).total_cmp(&share(b))).map(statement)
}

fn statement(shape: &Shape) -> Statement {
    let quantity = shape.quantity.clone();
    let Some(Strongest { ratio, frequency, wavelength, per_wheel_turn }) = shape.strongest else {
        return Statement::SpectraAlike { quantity };
    };
    match (shape.keeps_to.as_deref(), wavelength) {
        (Some("frequency"), _) => Statement::SpectraByFrequency { quantity, frequency, ratio },
        (Some(_), Some(wavelength)) => {
            let whole =
                |turns: f64| TURNS.into_iter().find(|whole| (turns / whole - 1.0).abs() < WHOLE);
            let turns = per_wheel_turn.and_then(whole);
            Statement::SpectraByWavelength { quantity, wavelength, ratio, turns }
        }
        _ => Statement::SpectraDiffer { quantity, frequency, ratio },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 200.0;

    /// Ten sections of 8 s, each at its own speed: noise of unit standard deviation in both
    /// records, and in the measured record a sine whose frequency may depend on the speed.
    fn sections(
        speed: impl Fn(usize) -> f64,
        sine: impl Fn(f64) -> f64,
        amplitude: f64,
    ) -> Vec<Compared> {
        let mut random = Gauss::new(7);
        let one = |at: usize| {
            let noise: Vec<f64> = (0..1600).map(|_| random.next()).collect();
            let frequency = sine(speed(at));
            let more =
                |n: usize| amplitude * (std::f64::consts::TAU * frequency * n as f64 / RATE).sin();
            let measured = noise.iter().enumerate().map(|(n, value)| value + more(n)).collect();
            let of = |values: Vec<f64>| Piece { values, rate: RATE, step: speed(at) / RATE };
            Compared::of(&[(of(noise), of(measured), 0.0)], 99.85).expect("moving signals")
        };
        (0..10).map(one).collect()
    }

    fn shape_of(sections: &[Compared]) -> Shape {
        let wanted = Wanted { range: (1.0, 30.0), percentile: 99.85, wheel_radius: None };
        shape(sections, "force", Vec::new(), &wanted, Some(0.46), 1)
    }

    #[test]
    fn a_mode_keeps_to_its_frequency_and_a_wheel_to_its_circumference() {
        let speeds = |at: usize| 16.0 + 2.0 * at as f64;
        let mode = shape_of(&sections(speeds, |_| 9.0, 1.0));
        assert_eq!(mode.keeps_to.as_deref(), Some("frequency"), "{mode:?}");
        let strongest = mode.strongest.expect("one line");
        assert!((strongest.frequency / 9.0 - 1.0).abs() < 0.06, "{strongest:?}");
        let wheel =
            shape_of(&sections(speeds, |speed| speed / (std::f64::consts::TAU * 0.46), 1.0));
        assert_eq!(wheel.keeps_to.as_deref(), Some("wavelength"), "{wheel:?}");
        let turns =
            wheel.strongest.and_then(|strongest| strongest.per_wheel_turn).expect("a wheel");
        assert!((turns - 1.0).abs() < 0.06, "{turns}");
        assert!(wheel.says.contains("one turn of a wheel"), "{}", wheel.says);
    }

    #[test]
    fn speeds_that_are_alike_cannot_tell() {
        let shape = shape_of(&sections(|_| 30.0, |_| 9.0, 1.0));
        assert_eq!(
            (shape.keeps_to.as_deref(), shape.reason.as_deref()),
            (None, Some("speeds are too similar"))
        );
        let shape = shape_of(&sections(|at| 16.0 + 2.0 * at as f64, |_| 9.0, 0.0));
        assert_eq!(
            (shape.keeps_to.as_deref(), shape.reason.as_deref()),
            (None, Some("no significant difference of the spectra"))
        );
    }

    /// A sine of amplitude 2 added to noise of unit variance increases the rms by the factor (1 +
    /// 2)^1/2.
    #[test]
    fn rms_and_crest() {
        let shape = shape_of(&sections(|at| 16.0 + 2.0 * at as f64, |_| 9.0, 2.0));
        assert!((shape.rms.value / 3f64.sqrt() - 1.0).abs() < 0.02, "{:?}", shape.rms);
        assert!((shape.crest.value - shape.peak.value / shape.rms.value).abs() < 1e-9);
        // The crest factor of a sine is 1.4, that of noise 3 at this percentile.
        assert!(
            shape.crest.value < 0.9
                && shape.rms.low <= shape.rms.value
                && shape.rms.value <= shape.rms.high
        );
    }
}
