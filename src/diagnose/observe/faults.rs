//! Faults of the recording, detected first: a constant channel, a saturated channel.

use crate::diagnose::levels::faults::{MOVES, ROW, STILL, TIMES};
use crate::diagnose::observe::observed::Observed;
use crate::effects::Signals;
use crate::result::diagnosis::Fault;

/// All faults of the channels, each with its sections.
pub fn faults(sections: &[Observed], channels: &[String]) -> Vec<Fault> {
    let mut found: Vec<Fault> = Vec::new();
    for channel in channels {
        for observed in sections {
            let Some(measured) = inside(&observed.measured, channel, observed) else { continue };
            let Some(simulated) = inside(&observed.simulated, channel, observed) else { continue };
            let fault =
                still(&measured, &simulated, observed.measured.rate).map(|says| ("dropout", says));
            let Some((fault, says)) =
                fault.or_else(|| cut_off(&measured, &simulated).map(|says| ("clipping", says)))
            else {
                continue;
            };
            match found.iter_mut().find(|known| known.channel == *channel && known.fault == fault) {
                Some(known) => known.sections.push(observed.section.name().to_string()),
                None => found.push(Fault {
                    fault: fault.into(),
                    channel: channel.clone(),
                    sections: vec![observed.section.name().to_string()],
                    says: format!("{channel} {says}"),
                }),
            }
        }
    }
    found
}

fn inside(signals: &Signals, channel: &str, observed: &Observed) -> Option<Vec<f64>> {
    crate::diagnose::observe::observed::piece(signals, channel, &observed.section)
        .map(|piece| piece.values)
}

fn range(values: &[f64]) -> f64 {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(*value), high.max(*value))
        });
    (high - low).max(0.0)
}

/// The longest time with a constant value; not a fault where the simulation is constant, too.
fn still(measured: &[f64], simulated: &[f64], rate: f64) -> Option<String> {
    let (mut longest, mut from) = ((0, 0), 0);
    for i in 1..=measured.len() {
        if i == measured.len() || measured[i].to_bits() != measured[from].to_bits() {
            if i - from > longest.1 - longest.0 {
                longest = (from, i);
            }
            from = i;
        }
    }
    let seconds = (longest.1 - longest.0) as f64 / rate;
    let meanwhile = simulated.get(longest.0..longest.1.min(simulated.len())).map_or(0.0, range);
    (seconds >= STILL && meanwhile > MOVES * range(simulated) && meanwhile > 0.0).then(|| {
        format!(
            "keeps the value {} for {seconds:.1} s while the simulated signal varies",
            measured[longest.0]
        )
    })
}

/// Runs of samples at the extreme value. If the simulation does not exceed the bound, saturation
/// cannot be detected.
fn cut_off(measured: &[f64], simulated: &[f64]) -> Option<String> {
    let most = measured.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = measured.iter().copied().fold(f64::INFINITY, f64::min);
    let beyond = |bound: f64, over: bool| {
        simulated.iter().any(|value| if over { *value > bound } else { *value < bound })
    };
    for (bound, over) in [(most, true), (least, false)] {
        let rows = measured
            .chunk_by(|a, b| a.to_bits() == b.to_bits())
            .filter(|row| row[0] == bound && row.len() >= ROW)
            .count();
        if rows >= TIMES && range(measured) > 0.0 && beyond(bound, over) {
            return Some(format!(
                "is saturated: it does not go {} {bound}",
                if over { "above" } else { "below" }
            ));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: usize) -> Vec<f64> {
        (0..n).map(|i| (i as f64 * 0.05).sin() * 10.0 + (i as f64 * 0.0137).cos()).collect()
    }

    #[test]
    fn a_channel_that_stands_still_is_found() {
        let simulated = wave(1000);
        let mut measured = simulated.clone();
        assert_eq!(still(&measured, &simulated, 200.0), None);
        measured[300..450].fill(1.25);
        assert!(
            still(&measured, &simulated, 200.0).is_some_and(|says| says.contains("1.25 for 0.8 s"))
        );
        assert_eq!(still(&[2.0; 1000], &[3.0; 1000], 200.0), None);
    }

    #[test]
    fn a_channel_that_is_cut_off_is_found() {
        let simulated = wave(1000);
        let measured: Vec<f64> = simulated.iter().map(|value| value.min(7.0)).collect();
        assert!(cut_off(&measured, &simulated).is_some_and(|says| says.contains("above 7")));
        assert_eq!(cut_off(&simulated, &simulated), None);
        // The rounded signal has runs at its peaks, but at different values.
        let rounded: Vec<f64> =
            simulated.iter().map(|value| (value * 100.0).round() / 100.0).collect();
        assert_eq!(cut_off(&rounded, &simulated), None);
    }
}
