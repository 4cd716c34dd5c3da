//! Left and right curves laid on each other: the outer wheel of one is the inner wheel of the other.

use super::features::Kind;
use super::observe::Observations;
use super::settings::Settings;

/// Which channel takes the place of which in mirrored sections, and which levels turn with the curve.
#[derive(Clone, Debug)]
pub struct Fold {
    /// By channel of the layout.
    partner: Vec<usize>,
    /// By channel of the layout.
    turns: Vec<bool>,
    /// By section.
    mirrored: Vec<bool>,
}

impl Fold {
    /// As the positions of the catalogue pair the channels; a level turns with the curve if it does so in the simulated features.
    #[must_use]
    pub fn new(settings: &Settings, seen: &Observations, simulated: &[f64]) -> Self {
        let number = |name: &String| seen.layout.channels.iter().position(|channel| channel.name == *name);
        let pairs = settings.positions.iter().flat_map(|position| position.straight.iter().zip(&position.mirrored));
        let mut partner: Vec<usize> = (0..seen.layout.channels.len()).collect();
        for (here, there) in pairs.filter_map(|(here, there)| Some((number(here)?, number(there)?))) {
            partner[here] = there;
        }
        let side: Vec<f64> = seen.sections.iter().map(|observed| settings.side(&observed.section)).collect();
        let mut fold = Self { turns: vec![false; partner.len()], partner, mirrored: side.iter().map(|side| *side < 0.0).collect() };
        // Of a channel laid on its partner: what turns with the curve against what stays.
        let lean = |channel: usize| {
            let level =
                |at: usize| seen.find(fold.channel(at, channel), Kind::Level).map_or(0.0, |feature| simulated[seen.place(at, feature)]);
            let curves = || (0..side.len()).filter(|at| side[*at] != 0.0);
            let turning: f64 = curves().map(|at| side[at] * level(at)).sum();
            let staying: f64 = curves().map(level).sum();
            turning.abs() - staying.abs()
        };
        let lean: Vec<f64> = (0..fold.partner.len()).map(lean).collect();
        let group = |channel: usize| seen.layout.channels[channel].group;
        let of_group =
            |channel: usize| (0..lean.len()).filter(|other| group(*other) == group(channel)).map(|other| lean[other]).sum::<f64>();
        fold.turns = (0..lean.len()).map(|channel| of_group(channel) > 0.0).collect();
        fold
    }

    /// The channel that stands at this one's place in a section; and the other way round.
    fn channel(&self, section: usize, channel: usize) -> usize {
        if self.mirrored[section] { self.partner[channel] } else { channel }
    }

    /// -1 for a level that turns with the curve, in a mirrored section; 1 otherwise.
    #[must_use]
    pub fn sign(&self, section: usize, channel: usize, kind: Kind) -> f64 {
        if kind == Kind::Level && self.turns[channel] && self.mirrored[section] { -1.0 } else { 1.0 }
    }
}
