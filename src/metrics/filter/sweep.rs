//! Running the sections over signals: the hot path.
//!
//! A recursion waits for its own last value, so one signal keeps a processor mostly idle. Up to four signals are laid
//! side by side, sample by sample, and up to four sections work on them in one sweep: the compiler turns the lanes into
//! vectors and the processor overlaps the sections. Each lane does the operations of a single signal in the same order.

use super::{Filter, Phase, section::Section};

impl Filter {
    /// Signals of equal length, longer than the padding.
    pub(super) fn run<const LANES: usize>(&self, signals: [&[f64]; LANES]) -> [Vec<f64>; LANES] {
        let mut samples = self.laid_out(signals);
        let last = samples.len() - 1;
        match self.phase {
            Phase::CausalFromRest => sweep_all::<LANES, false>(&self.sections, &mut samples, [0.0; LANES]),
            Phase::Causal => {
                let level = samples[0];
                sweep_all::<LANES, false>(&self.sections, &mut samples, level);
            }
            Phase::Zero => {
                let level = samples[0];
                sweep_all::<LANES, false>(&self.sections, &mut samples, level);
                let level = samples[last];
                sweep_all::<LANES, true>(&self.sections, &mut samples, level);
            }
        }
        let inner = &samples[self.padding..samples.len() - self.padding];
        std::array::from_fn(|lane| inner.iter().map(|sample| sample[lane]).collect())
    }

    /// The signals side by side, both ends reflected about their end points, times the gain of all passes.
    fn laid_out<const LANES: usize>(&self, signals: [&[f64]; LANES]) -> Vec<[f64; LANES]> {
        let gain = if self.phase == Phase::Zero { self.gain * self.gain } else { self.gain };
        let length = signals[0].len();
        let signals: [&[f64]; LANES] = signals.map(|signal| &signal[..length]);
        let reflected = |about: usize, from: usize| signals.map(|signal| gain * (2.0 * signal[about] - signal[from]));
        let mut samples = Vec::with_capacity(length + 2 * self.padding);
        samples.extend((1..=self.padding).rev().map(|k| reflected(0, k)));
        samples.extend((0..length).map(|k| signals.map(|signal| gain * signal[k])));
        samples.extend((1..=self.padding).map(|k| reflected(length - 1, length - 1 - k)));
        samples
    }
}

/// One pass of all sections, in place, forward or backward, from the steady state of `level`.
fn sweep_all<const LANES: usize, const BACKWARD: bool>(sections: &[Section], samples: &mut [[f64; LANES]], mut level: [f64; LANES]) {
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

/// Some sections in one sweep; gives the level that reaches the sections after them.
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
    // Most numerators end in 1: one multiplication fewer, by which nothing changes.
    if sections.iter().all(|section| section.b2 == 1.0) {
        sweep::<LANES, SECTIONS, BACKWARD, true>(sections, samples, states);
    } else {
        sweep::<LANES, SECTIONS, BACKWARD, false>(sections, samples, states);
    }
    level
}

/// Direct form II transposed.
fn sweep<const LANES: usize, const SECTIONS: usize, const BACKWARD: bool, const ENDS_IN_ONE: bool>(
    sections: &[Section; SECTIONS],
    samples: &mut [[f64; LANES]],
    mut states: [[[f64; LANES]; 2]; SECTIONS],
) {
    let mut step = |sample: &mut [f64; LANES]| {
        let mut values = *sample;
        for (section, [first, second]) in sections.iter().zip(&mut states) {
            for lane in 0..LANES {
                let input = values[lane];
                let output = input + first[lane];
                // The product with the output comes last: nothing else has to wait for it.
                first[lane] = (section.b1 * input + second[lane]) - section.a1 * output;
                second[lane] = if ENDS_IN_ONE { input } else { section.b2 * input } - section.a2 * output;
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
