//! How a signal was recorded: held values, saturation, quantisation, noise.

use std::{cell::OnceCell, ops::Deref};

use super::{
    spectrum::strongest_line,
    statistics::{Divisor, median, standard_deviation},
};

/// The samples of a signal, with what several of its numbers are computed from, each once.
#[derive(Debug)]
pub struct Traits<'a> {
    samples: &'a [f64],
    differences: OnceCell<Option<Differences>>,
    line: OnceCell<Option<(f64, f64)>>,
}

/// Magnitudes of the fourth differences, and their median.
type Differences = (Vec<f64>, f64);

impl<'a> Traits<'a> {
    pub const fn of(samples: &'a [f64]) -> Self {
        Self { samples, differences: OnceCell::new(), line: OnceCell::new() }
    }

    /// As [`strongest_line`].
    pub fn line(&self) -> Option<(f64, f64)> {
        *self.line.get_or_init(|| strongest_line(self))
    }

    fn differences(&self) -> Option<&Differences> {
        self.differences.get_or_init(|| fourth_differences(self)).as_ref()
    }
}

impl Deref for Traits<'_> {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        self.samples
    }
}

/// Share of the samples in the longest run of equal values: near 0 for a signal that varies, 1 for
/// a constant one.
///
/// `None` without samples.
pub fn longest_held_share(values: &[f64]) -> Option<f64> {
    let (mut longest, mut run) = (usize::from(!values.is_empty()), 1);
    // Without branches, which noise would make unpredictable.
    for [before, value] in values.array_windows() {
        run = if value == before { run + 1 } else { 1 };
        longest = longest.max(run);
    }
    // A single sample is not a run.
    let longest = if longest == 1 && values.len() > 1 { 0 } else { longest };
    (!values.is_empty()).then(|| longest as f64 / values.len() as f64)
}

/// The longest run of samples other than 0, from the first to the last of them, in the unit of the
/// axis; 0 for a run of one sample and for none.
///
/// `None` without samples.
pub fn longest_run(axis: &[f64], holds: &[f64]) -> Option<f64> {
    let (mut longest, mut start): (f64, Option<f64>) = (0.0, None);
    for (&at, &holds) in axis.iter().zip(holds) {
        start = start.or(Some(at)).filter(|_| holds != 0.0);
        longest = start.map_or(longest, |start| longest.max(at - start));
    }
    (!holds.is_empty()).then_some(longest)
}

/// How often samples other than 0 follow one that is 0: the upward crossings of a level, of a signal
/// that is 1 above it. One that begins above it has not crossed it.
///
/// `None` without samples.
pub fn onsets(holds: &[f64]) -> Option<f64> {
    let onsets = holds.windows(2).filter(|pair| pair[0] == 0.0 && pair[1] != 0.0).count();
    (!holds.is_empty()).then_some(onsets as f64)
}

/// Share of the samples at the smallest or at the largest value, the larger of both. It is large
/// for a saturated recorder.
///
/// `None` without samples, or with one that is not finite.
pub fn share_at_extreme(values: &[f64]) -> Option<f64> {
    let (least, greatest) = ends(values)?;
    let at = |end: f64| values.iter().map(|value| u64::from(*value == end)).sum::<u64>();
    Some(at(least).max(at(greatest)) as f64 / values.len() as f64)
}

/// The smallest change between consecutive samples, in their unit: the quantisation step of a
/// signal that varies; 0 for a constant one.
///
/// `None` without samples, or with one that is not finite.
pub fn resolution(values: &[f64]) -> Option<f64> {
    let (least, greatest) = ends(values)?;
    // Values with a fixed number of decimals differ by rounding of the last bit after conversion to
    // SI.
    let rounding = ROUNDING * least.abs().max(greatest.abs());
    let step = |before: f64, value: f64| (value - before).abs();
    let change = |before, value| {
        if step(before, value) > rounding { step(before, value) } else { f64::INFINITY }
    };
    let smallest = least_of(&values[..values.len() - 1], &values[1..], change);
    Some(if smallest < f64::INFINITY { smallest } else { 0.0 })
}

/// Standard deviation of white noise in a signal, from its fourth differences, which a signal of
/// less than a tenth of the sampling rate hardly has. Their median magnitude is used, so that steps
/// and shocks do not count.
///
/// `None` for fewer than nine samples, or with one that is not finite.
pub fn noise_floor(values: &Traits<'_>) -> Option<f64> {
    /// Standard deviation of the fourth difference of white noise: the root of 1 + 16 + 36 + 16 +
    /// 1.
    const OF_DIFFERENCE: f64 = 8.366_600_265_340_756;
    /// Median magnitude of a normal distribution.
    const MEDIAN: f64 = 0.674_489_750_196_082;
    Some(values.differences()?.1 / (MEDIAN * OF_DIFFERENCE))
}

/// By how much a single sample is out of line with two neighbours on either side, at most, in the
/// unit of the samples: the height of a spike. A jump counts with half its height, a peak that
/// rises over several samples with less.
///
/// `None` for fewer than nine samples, or with one that is not finite.
pub fn spike(values: &Traits<'_>) -> Option<f64> {
    /// The weight of the middle sample in a fourth difference.
    const OF_MIDDLE: f64 = 6.0;
    let largest = values.differences()?.0.iter().copied().fold(0.0, f64::max);
    Some(largest / OF_MIDDLE)
}

/// The number of samples of the longest stretch that follows a smooth curve while the signal as a
/// whole does not: a gap that was filled with a value, a straight line or a spline. The fourth
/// differences of such curves are zero but for rounding.
///
/// `None` for fewer than nine samples, with one that is not finite, or where most of the signal is
/// smooth.
pub fn smooth_stretch(values: &Traits<'_>) -> Option<f64> {
    /// What counts as smooth, as a share of the median of the differences: of white noise, one
    /// difference in ten is that small, and ten in a row are one in 10^10.
    const SMOOTH: f64 = 0.2;
    let (differences, middle) = values.differences()?;
    let most = SMOOTH * Some(middle).filter(|middle| **middle > 0.0)?;
    let (mut longest, mut run) = (0_usize, 0);
    for difference in differences {
        run = if *difference <= most { run + 1 } else { 0 };
        longest = longest.max(run);
    }
    Some((longest + WINDOW - 1) as f64)
}

/// Samples of a fourth difference.
const WINDOW: usize = 5;

/// Of nine samples at least, for a median.
fn fourth_differences(values: &[f64]) -> Option<Differences> {
    ends(values).filter(|_| values.len() >= 2 * WINDOW - 1)?;
    let fourth = |[a, b, c, d, e]: &[f64; WINDOW]| (a - 4.0 * b + 6.0 * c - 4.0 * d + e).abs();
    let all: Vec<f64> = values.array_windows().map(fourth).collect();
    let middle = median(&all)?;
    Some((all, middle))
}

/// Share of the samples that repeat the one before, where the signal changes by more than a step of
/// its resolution otherwise: near 0 for a signal that varies or that is only coarse, 0.75 for one in
/// which each value was written four times.
///
/// `None` without samples, or with one that is not finite.
pub fn repeated_share(values: &[f64]) -> Option<f64> {
    /// A change is larger than a step from here on, in steps.
    const MORE: f64 = 1.5;
    let step = resolution(values)?;
    let (mut equal, mut more) = (0_usize, 0_usize);
    for [before, value] in values.array_windows() {
        let change = (value - before).abs();
        equal += usize::from(change < step / 2.0);
        more += usize::from(change > MORE * step);
    }
    let changes = values.len().saturating_sub(1);
    let changed = changes - equal;
    Some(if changed == 0 {
        0.0
    } else {
        equal as f64 / changes as f64 * more as f64 / changed as f64
    })
}

/// Share of the samples that are piled up at the largest or at the smallest value, the larger of
/// both: those at the value itself beyond twice as many as any of the three steps before it hold. A
/// step is that of the resolution, or 2 % of the standard deviation. A signal that turns by itself
/// has its samples spread over the last steps.
///
/// `None` without samples, or with one that is not finite.
pub fn piled_up(values: &[f64]) -> Option<f64> {
    /// Width of a step, as a share of the standard deviation.
    const WIDTH: f64 = 0.02;
    /// Steps that are compared.
    const STEPS: usize = 3;
    /// A pile holds more than this many times the samples of a step ...
    const MORE: f64 = 2.0;
    /// ... and one sample, since every signal has a largest value.
    const LEAST: f64 = 1.0;
    /// Fewer samples than this beyond them are chance, in a short section as in a long one.
    const FEWEST: f64 = 3.0;
    let (least, greatest) = ends(values)?;
    let step = resolution(values)?;
    let width = step.max(WIDTH * standard_deviation(values, Divisor::Population)?);
    if width <= 0.0 {
        return Some(0.0);
    }
    let pile = |end: f64| {
        let (mut at_end, mut before) = (0_usize, [0_usize; STEPS]);
        for value in values {
            let from = (value - end).abs() - step / 2.0;
            if from < 0.0 {
                at_end += 1;
            } else if let Some(count) = before.get_mut((from / width) as usize) {
                *count += 1;
            }
        }
        let most = before.into_iter().max().unwrap_or(0);
        at_end as f64 - MORE * most as f64 - LEAST
    };
    let pile = pile(least).max(pile(greatest));
    Some(if pile < FEWEST { 0.0 } else { pile / values.len() as f64 })
}

/// Relative to the largest value; smaller changes count as none.
const ROUNDING: f64 = 1e-12;

/// Smallest and largest value.
fn ends(values: &[f64]) -> Option<(f64, f64)> {
    // The loop checks all values without an early exit, which is faster.
    if values.is_empty() || !values.iter().fold(true, |all, value| all & value.is_finite()) {
        return None;
    }
    Some((least_of(values, values, |value, _| value), -least_of(values, values, |value, _| -value)))
}

/// The smallest `term` of two signals of equal length; infinite if there is none.
fn least_of(left: &[f64], right: &[f64], term: impl Fn(f64, f64) -> f64) -> f64 {
    let smaller = |a: f64, b: f64| if b < a { b } else { a };
    // Several minima side by side: no comparison waits for the one before.
    let mut lanes = [f64::INFINITY; 8];
    let ((left, left_rest), (right, right_rest)) = (left.as_chunks::<8>(), right.as_chunks::<8>());
    for (left, right) in left.iter().zip(right) {
        for lane in 0..8 {
            lanes[lane] = smaller(lanes[lane], term(left[lane], right[lane]));
        }
    }
    let rest = left_rest.iter().zip(right_rest).map(|(left, right)| term(*left, *right));
    rest.chain(lanes).fold(f64::INFINITY, smaller)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise of standard deviation 0.2 on a slow wave of amplitude 5; and neither a step nor a
    /// smooth signal has noise.
    #[test]
    fn noise_is_found_below_a_signal() {
        let mut state = 7_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let wave = |at: usize| 5.0 * (at as f64 * 0.05).sin() + if at > 900 { 30.0 } else { 0.0 };
        let noisy: Vec<f64> = (0..2000)
            .map(|at| wave(at) + 0.2 * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0))
            .collect();
        let found = noise_floor(&Traits::of(&noisy)).expect("finite");
        assert!((found - 0.2).abs() < 0.02, "{found}");
        let smooth: Vec<f64> = (0..2000).map(wave).collect();
        assert!(noise_floor(&Traits::of(&smooth)).is_some_and(|floor| floor < 1e-4));
        assert_eq!(
            [&[1.0; 8] as &[f64], &[1.0, f64::NAN], &[3.0; 20]]
                .map(|of| noise_floor(&Traits::of(of))),
            [None, None, Some(0.0)]
        );
    }

    /// The plain definitions, on signals of every length and with plateaus, ends and zeros of both
    /// signs.
    #[test]
    fn fast_loops_give_what_the_definitions_say() {
        let mut state = 3_u64;
        let mut value = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % 7) as f64 * 0.25 - 0.75
        };
        for count in 1..70 {
            let values: Vec<f64> = (0..count).map(|_| value()).collect();
            let longest = values.chunk_by(|a, b| a == b).map(<[f64]>::len).max().expect("a sample");
            let longest = if longest == 1 && count > 1 { 0 } else { longest };
            assert_eq!(longest_held_share(&values), Some(longest as f64 / count as f64));
            let (least, greatest) = values
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
            let at = |end: f64| values.iter().filter(|value| **value == end).count();
            assert_eq!(
                share_at_extreme(&values),
                Some(at(least).max(at(greatest)) as f64 / count as f64)
            );
            let steps =
                values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 1e-9);
            assert_eq!(
                resolution(&values),
                Some(steps.fold(f64::INFINITY, f64::min)).map(|step| if step < 1.0 / 0.0 {
                    step
                } else {
                    0.0
                })
            );
            let mut damaged = values.clone();
            damaged[count / 2] = f64::NAN;
            assert_eq!((share_at_extreme(&damaged), resolution(&damaged)), (None, None));
        }
    }

    /// A wave of 5 with noise of +-0.05, and the same with a fault.
    fn noisy_wave(count: usize) -> Vec<f64> {
        let noise = |at: usize| 0.1 * ((at * 7919 % 1009) as f64 / 1009.0 - 0.5);
        (0..count).map(|at| 5.0 * (at as f64 * 0.05).sin() + noise(at)).collect()
    }

    /// A single sample counts with its height, a jump with half of it, and a peak over several
    /// samples with less.
    #[test]
    fn the_height_of_a_spike() {
        let wave = noisy_wave(1000);
        let with = |change: &dyn Fn(usize) -> f64| {
            let changed: Vec<f64> =
                wave.iter().enumerate().map(|(at, value)| value + change(at)).collect();
            spike(&Traits::of(&changed)).expect("finite")
        };
        assert!(with(&|_| 0.0) < 0.15);
        let single = with(&|at| if at == 400 { 4.0 } else { 0.0 });
        assert!((single - 4.0).abs() < 0.15, "{single}");
        let jump = with(&|at| if at >= 400 { 4.0 } else { 0.0 });
        assert!((jump - 2.0).abs() < 0.15, "{jump}");
        let peak = with(&|at| 4.0 * (-((at as f64 - 400.0) / 4.0).powi(2)).exp());
        assert!(peak < 0.3, "{peak}");
        assert_eq!(
            [&[1.0; 8] as &[f64], &[f64::NAN; 20], &[1.0; 9]].map(|of| spike(&Traits::of(of))),
            [None, None, Some(0.0)]
        );
    }

    /// A gap of forty samples that was filled with a value, a line or a parabola.
    #[test]
    fn a_gap_that_was_filled() {
        let wave = noisy_wave(1000);
        let filled = |with: &dyn Fn(f64) -> f64| {
            let mut values = wave.clone();
            for (at, value) in values[300..340].iter_mut().enumerate() {
                *value = with(at as f64);
            }
            smooth_stretch(&Traits::of(&values)).expect("finite")
        };
        for with in [&(|_| 1.0) as &dyn Fn(f64) -> f64, &|at| 0.1 * at, &|at| 0.01 * at * at] {
            assert!((40.0..46.0).contains(&filled(with)), "{}", filled(with));
        }
        assert!(smooth_stretch(&Traits::of(&wave)).is_some_and(|longest| longest < 14.0));
        // Most of it is smooth: no stretch stands out.
        assert_eq!(smooth_stretch(&Traits::of(&[2.0; 50])), None);
    }

    /// Each value written four times; a coarse signal repeats its values, too, but changes by one
    /// step.
    #[test]
    fn values_that_were_repeated() {
        let wave = noisy_wave(1000);
        let stairs: Vec<f64> = (0..1000).map(|at| wave[at / 4 * 4]).collect();
        let coarse: Vec<f64> = wave.iter().map(|value| (value / 0.5).round() * 0.5).collect();
        assert!(repeated_share(&stairs).is_some_and(|share| (0.7..=0.75).contains(&share)));
        assert!(repeated_share(&wave).is_some_and(|share| share < 0.02));
        assert!(repeated_share(&coarse).is_some_and(|share| share < 0.1));
        assert_eq!((repeated_share(&[]), repeated_share(&[1.0; 9])), (None, Some(0.0)));
    }

    /// The highest tenth of a wave cut off: its samples at the bound, less twice those of a step.
    #[test]
    fn peaks_that_were_cut_off() {
        let wave = noisy_wave(1000);
        let mut sorted = wave.clone();
        sorted.sort_by(f64::total_cmp);
        let clipped = |share: f64| {
            let bound = sorted[(1000.0 * (1.0 - share)) as usize];
            let values: Vec<f64> = wave.iter().map(|value| value.min(bound)).collect();
            piled_up(&values).expect("finite")
        };
        assert!((0.05..=0.1).contains(&clipped(0.1)), "{}", clipped(0.1));
        assert!(piled_up(&wave).is_some_and(|share| share < 0.002));
        assert_eq!((piled_up(&[]), piled_up(&[4.0; 10])), (None, Some(0.0)));
        // Three equal samples at the end are chance; four of them are not.
        let ended = |equal: usize| -> Vec<f64> {
            let rising = (0..100).map(|k| f64::from(k) * 0.04);
            rising.chain(std::iter::repeat_n(5.0, equal)).collect()
        };
        assert_eq!(piled_up(&ended(3)), Some(0.0));
        assert_eq!(piled_up(&ended(4)), Some(3.0 / 104.0));
    }

    #[test]
    fn by_hand() {
        assert_eq!(longest_held_share(&[1.0, 1.0, 1.0, 2.0, 2.0]), Some(0.6));
        assert_eq!(longest_held_share(&[1.0, 2.0, 3.0, 4.0]), Some(0.0));
        assert_eq!(longest_held_share(&[7.0; 9]), Some(1.0));
        let axis = [0.0, 1.0, 2.0, 3.5, 4.0, 6.0];
        assert_eq!(longest_run(&axis, &[1.0, 1.0, 0.0, 1.0, 1.0, 1.0]), Some(2.5));
        assert_eq!(longest_run(&axis, &[1.0, 1.0, 1.0, 0.0, 0.0, 1.0]), Some(2.0));
        assert_eq!(longest_run(&axis, &[0.0, 1.0, 0.0, 0.0, 0.0, 0.0]), Some(0.0));
        assert_eq!(longest_run(&[], &[]), None);
        assert_eq!(onsets(&[1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0]), Some(2.0));
        assert_eq!(
            (onsets(&[1.0; 3]), onsets(&[0.0, 1.0]), onsets(&[])),
            (Some(0.0), Some(1.0), None)
        );
        assert_eq!(share_at_extreme(&[-1.0, 0.5, 2.0, 2.0, 2.0, 0.0]), Some(0.5));
        assert_eq!(resolution(&[0.5, 1.0, 0.75, 1.25]), Some(0.25));
        assert_eq!(resolution(&[3.0, 3.0]), Some(0.0));
        assert_eq!(
            (longest_held_share(&[]), share_at_extreme(&[]), resolution(&[f64::NAN])),
            (None, None, None)
        );
    }

    /// Values with two decimals in kN, converted to N: steps of 10 N in spite of rounding.
    #[test]
    fn steps_survive_the_change_of_unit() {
        let values: Vec<f64> =
            (0..500).map(|k| f64::from(k * k * 7 % 101) * 0.01 * 1000.0 + 54_540.0).collect();
        let found = resolution(&values).expect("finite");
        assert!((found - 10.0).abs() < 1e-6, "{found}");
    }
}
