//! Deviation of a simulator from a record from elsewhere.

use super::{Section, Simulator, add::interpolated};
use crate::effects::Signals;
use crate::problem::{Problem, error};

/// Deviation of one channel in one section.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    pub section: String,
    pub channel: String,
    /// Root mean square of the difference over the section, in the unit of the channel.
    pub rms: f64,
    /// Root mean square of the recorded channel.
    pub of: f64,
}

impl Deviation {
    /// The deviation as a share of the channel's rms; 0 if both are zero.
    pub fn share(&self) -> f64 {
        if self.rms == 0.0 { 0.0 } else { self.rms / self.of }
    }
}

/// The deviations of all common channels, in the order of the record. Both must be in the same
/// units.
///
/// # Errors
/// `too-short`: fewer than two samples of the section are in both.
pub fn deviations(
    made: &Signals,
    recorded: &Signals,
    section: &Section,
) -> Result<Vec<Deviation>, Problem> {
    let ends = |signals: &Signals| signals.axis.first().copied().zip(signals.axis.last().copied());
    let (from, to) = match (ends(made), ends(recorded)) {
        (Some(a), Some(b)) => (a.0.max(b.0).max(section.start), a.1.min(b.1).min(section.end)),
        _ => (0.0, -1.0),
    };
    let inside: Vec<usize> =
        (0..recorded.axis.len()).filter(|at| (from..=to).contains(&recorded.axis[*at])).collect();
    if inside.len() < 2 {
        let says = "the records of the simulator and of the campaign do not overlap";
        return Err(section.named(error("too-short", says, &section.cell.span)));
    }
    let mut found = Vec::new();
    for channel in &recorded.channels {
        let Some(mine) = made.channel(&channel.name) else { continue };
        let mut at = 0;
        let (mut off, mut all) = (0.0, 0.0);
        for n in &inside {
            let difference = interpolated(&made.axis, &mine.values, recorded.axis[*n], &mut at)
                - channel.values[*n];
            off += difference * difference;
            all += channel.values[*n] * channel.values[*n];
        }
        let rms = |sum: f64| (sum / inside.len() as f64).sqrt();
        found.push(Deviation {
            section: section.name().to_string(),
            channel: channel.name.clone(),
            rms: rms(off),
            of: rms(all),
        });
    }
    Ok(found)
}

/// A warning if a simulator without effects deviates from the campaign's simulation by more than
/// the tolerance in any channel.
pub fn baseline_warning(
    simulator: &dyn Simulator,
    tolerance: f64,
    deviations: &[Deviation],
) -> Option<Problem> {
    let beyond: Vec<&Deviation> = deviations.iter().filter(|one| one.share() > tolerance).collect();
    let worst = beyond.iter().max_by(|a, b| a.share().total_cmp(&b.share()))?;
    let says = format!(
        "{} without effects does not reproduce the campaign's simulation: `{}` of section `{}` deviates by {:.1} % (rms of the difference / \
         rms of the channel); {} of {} channels deviate by more than {} %",
        simulator.name(),
        worst.channel,
        worst.section,
        100.0 * worst.share(),
        beyond.len(),
        deviations.len(),
        100.0 * tolerance
    );
    let help = "check that both used the same vehicle and tracks, or add effects to the campaign's own records with `--increment`";
    Some(Problem::warning("baseline", says).help(help))
}
