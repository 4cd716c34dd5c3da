//! Marks of a signal, by which copies of it are found.

use serde::{Deserialize, Serialize};

use crate::data::WhichRecord;
use crate::metrics::random::mixed;

/// Number of consecutive samples of a mark. Two independent signals with a resolution of a
/// thousandth of their range agree in eight consecutive samples by chance at one of 10^21 places.
const RUN: usize = 8;
/// One run of samples in this many becomes a mark. It is chosen by its content, so that the same
/// runs are chosen wherever they are in a record.
const ONE_IN: u64 = 16;
/// Fewest different steps of a mark, of seven: a smooth signal with few decimals has few, and such
/// runs of samples are equal by chance.
const DIFFERENT: usize = 5;

/// Marks of one signal in one section.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Print {
    pub rule: String,
    pub channel: String,
    pub which: WhichRecord,
    /// The record in words: `measurement run1`.
    pub record: String,
    /// Hash of all samples.
    pub whole: u64,
    /// Sorted, without duplicates. A file of values has them in binary form.
    #[serde(skip)]
    pub marks: Vec<u32>,
}

impl Print {
    pub fn of(
        rule: &str,
        channel: &str,
        (which, record): (WhichRecord, String),
        samples: &[f64],
    ) -> Self {
        let mut marks = marks(samples);
        marks.sort_unstable();
        marks.dedup();
        let whole = samples.iter().fold(0, |whole: u64, value| mixed(whole ^ hash_of(*value)));
        Self { rule: rule.to_string(), channel: channel.to_string(), which, record, whole, marks }
    }
}

/// Samples whose runs are hashed together: the hashes stay in the first-level cache.
const TOGETHER: usize = 256;

/// Marks of a signal: hashes of runs of samples. Runs of few different steps are equal in many
/// places and give no mark.
fn marks(samples: &[f64]) -> Vec<u32> {
    let mut found = Vec::with_capacity(2 * samples.len() / ONE_IN as usize);
    let mut hashes = [0; TOGETHER + RUN];
    for start in (0..samples.len().saturating_sub(RUN - 1)).step_by(TOGETHER) {
        let part = &samples[start..samples.len().min(start + TOGETHER + RUN - 1)];
        for (hash, value) in hashes.iter_mut().zip(part) {
            *hash = hash_of(*value);
        }
        // The hash of a run is made of those of its halves: no step waits for the one before.
        for half in [1, 2, 4] {
            for at in 0..TOGETHER + RUN - half {
                hashes[at] =
                    hashes[at].rotate_left(TURN * half as u32).wrapping_add(hashes[at + half]);
            }
        }
        for (run, samples) in hashes.iter().zip(part.windows(RUN)) {
            if run.is_multiple_of(ONE_IN) && different(samples) >= DIFFERENT {
                found.push(shortened(mixed(*run)));
            }
        }
    }
    found
}

/// The number of steps of different size between the samples of a run.
fn different(run: &[f64]) -> usize {
    /// Steps of equal decimal numbers differ by rounding, as a share of the numbers.
    const ROUNDING: f64 = 1e-12;
    let least = ROUNDING * run.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let step = |at: usize| run[at + 1] - run[at];
    let is_new = |at: &usize| (0..*at).all(|other| (step(other) - step(*at)).abs() > least);
    (0..run.len() - 1).filter(is_new).count()
}

/// Of consecutive samples, the hash of one is turned by so many bits against that of the next.
const TURN: u32 = 9;

fn hash_of(value: f64) -> u64 {
    /// Odd, with its bits well spread (the golden ratio).
    const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;
    let bits = value.to_bits();
    let hash = (bits ^ bits >> 32).wrapping_mul(SPREAD);
    hash ^ hash >> 32
}

/// Half of the bits: two signals with a thousand marks each agree in one by chance once in 4000
/// pairs, and copies share several.
pub fn shortened(hash: u64) -> u32 {
    (hash >> 32) as u32
}
