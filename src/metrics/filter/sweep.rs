//! Runs the sections over signals. Most of the computing time is spent here.
//!
//! A recursion depends on its own previous value, so that a single signal leaves most of a
//! processor idle. Therefore up to four signals are stored side by side, sample by sample, and up
//! to four sections are applied in one sweep. The compiler turns the signals into vector
//! instructions, and the processor overlaps the sections. Each signal gets the same operations in
//! the same order as alone.

use super::{Filter, Phase, section::Section};

/// Number of rows copied between the signals and the lanes at a time; they fit in the first-level
/// cache.
const ROWS: usize = 64;

impl Filter {
    /// Signals of equal length, longer than the padding. `samples` is working memory.
    pub fn run<const LANES: usize>(
        &self,
        signals: [&[f64]; LANES],
        samples: &mut Vec<[f64; LANES]>,
    ) -> [Vec<f64>; LANES] {
        self.lay_out(signals, samples);
        let from = match self.phase {
            Phase::Zero | Phase::Causal => samples[0],
            Phase::CausalFromRest => [0.0; LANES],
        };
        sweep_all::<LANES, false>(&self.sections, samples, from);
        if self.phase == Phase::Zero {
            let from = samples[samples.len() - 1];
            sweep_all::<LANES, true>(&self.sections, samples, from);
        }
        let inner = &samples[self.padding..samples.len() - self.padding];
        let mut filtered = signals.map(|signal| Vec::with_capacity(signal.len()));
        for rows in inner.chunks(ROWS) {
            for (lane, values) in filtered.iter_mut().enumerate() {
                values.extend(rows.iter().map(|row| row[lane]));
            }
        }
        filtered
    }

    /// The signals side by side, with both ends reflected about their end points, multiplied by the
    /// gain of all passes.
    fn lay_out<const LANES: usize>(
        &self,
        signals: [&[f64]; LANES],
        samples: &mut Vec<[f64; LANES]>,
    ) {
        let gain = if self.phase == Phase::Zero { self.gain * self.gain } else { self.gain };
        let length = signals[0].len();
        samples.clear();
        samples.resize(length + 2 * self.padding, [0.0; LANES]);
        let (before, rest) = samples.split_at_mut(self.padding);
        let (inner, after) = rest.split_at_mut(length);
        for (lane, signal) in signals.into_iter().enumerate() {
            for (row, value) in before.iter_mut().rev().zip(&signal[1..]) {
                row[lane] = gain * (2.0 * signal[0] - value);
            }
            for (row, value) in after.iter_mut().zip(signal[..length - 1].iter().rev()) {
                row[lane] = gain * (2.0 * signal[length - 1] - value);
            }
        }
        for (block, rows) in inner.chunks_mut(ROWS).enumerate() {
            for (lane, signal) in signals.into_iter().enumerate() {
                for (row, value) in rows.iter_mut().zip(&signal[block * ROWS..]) {
                    row[lane] = gain * value;
                }
            }
        }
    }
}

/// One pass of all sections, in place, forward or backward, from the steady state of `level`.
fn sweep_all<const LANES: usize, const BACKWARD: bool>(
    sections: &[Section],
    samples: &mut [[f64; LANES]],
    mut level: [f64; LANES],
) {
    let (fours, rest) = sections.as_chunks::<4>();
    for four in fours {
        level = sweep_some::<LANES, 4, BACKWARD>(four, samples, level);
    }
    match *rest {
        [] => {}
        [a] => _ = sweep_some::<LANES, 1, BACKWARD>(&[a], samples, level),
        [a, b] => _ = sweep_some::<LANES, 2, BACKWARD>(&[a, b], samples, level),
        [a, b, c, ..] => _ = sweep_some::<LANES, 3, BACKWARD>(&[a, b, c], samples, level),
    }
}

/// Applies some sections in one sweep; returns the level of the input of the sections after them.
fn sweep_some<const LANES: usize, const SECTIONS: usize, const BACKWARD: bool>(
    sections: &[Section; SECTIONS],
    samples: &mut [[f64; LANES]],
    mut level: [f64; LANES],
) -> [f64; LANES] {
    let states = sections.map(|section| {
        let steady = section.steady();
        let states = steady.state.map(|state| level.map(|level| state * level));
        level = level.map(|level| level * steady.output);
        states
    });
    // Most numerators end in 1: one multiplication less, with the same result.
    if sections.iter().all(|section| section.b2 == 1.0) {
        sweep::<LANES, SECTIONS, BACKWARD, true>(sections, samples, states);
    } else {
        sweep::<LANES, SECTIONS, BACKWARD, false>(sections, samples, states);
    }
    level
}

/// Direct form II transposed.
fn sweep<
    const LANES: usize,
    const SECTIONS: usize,
    const BACKWARD: bool,
    const ENDS_IN_ONE: bool,
>(
    sections: &[Section; SECTIONS],
    samples: &mut [[f64; LANES]],
    mut states: [[[f64; LANES]; 2]; SECTIONS],
) {
    let mut step = |sample: &mut [f64; LANES]| {
        let mut values = *sample;
        for k in 0..SECTIONS {
            let Section { b1, b2, a1, a2 } = sections[k];
            for lane in 0..LANES {
                let input = values[lane];
                let output = input + states[k][0][lane];
                // The product with the output is last, as nothing else depends on it.
                states[k][0][lane] = (b1 * input + states[k][1][lane]) - a1 * output;
                states[k][1][lane] = if ENDS_IN_ONE { input } else { b2 * input } - a2 * output;
                values[lane] = output;
            }
        }
        *sample = values;
    };
    if BACKWARD {
        samples.iter_mut().rev().for_each(&mut step);
    } else {
        samples.iter_mut().for_each(&mut step);
    }
}
