//! Folding of left and right curves: the outer wheel of one takes the place of the inner wheel of
//! the other.

use crate::diagnose::observe::{layout::Kind, observations::Observations};
use crate::diagnose::settings::Settings;

/// The channel that replaces each channel in mirrored sections, and the levels that change sign
/// with the curve.
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
    /// The positions of the catalogue pair the channels. A level changes sign with the curve if its
    /// simulated values do.
    pub fn new(settings: &Settings, seen: &Observations, simulated: &[f64]) -> Self {
        let number =
            |name: &String| seen.layout.channels.iter().position(|channel| channel.name == *name);
        let pairs = settings
            .positions
            .iter()
            .flat_map(|position| position.straight.iter().zip(&position.mirrored));
        let mut partner: Vec<usize> = (0..seen.layout.channels.len()).collect();
        for (here, there) in pairs.filter_map(|(here, there)| Some((number(here)?, number(there)?)))
        {
            partner[here] = there;
        }
        let side: Vec<f64> =
            seen.sections.iter().map(|observed| settings.side(&observed.section)).collect();
        let mut fold = Self {
            turns: vec![false; partner.len()],
            partner,
            mirrored: side.iter().map(|side| *side < 0.0).collect(),
        };
        // Magnitude of the antisymmetric part of a channel and its partner against the symmetric
        // part.
        let lean = |channel: usize| {
            let level = |at: usize| {
                seen.find(fold.channel(at, channel), Kind::Level)
                    .map_or(0.0, |feature| simulated[seen.place(at, feature)])
            };
            let curves = || (0..side.len()).filter(|at| side[*at] != 0.0);
            let turning: f64 = curves().map(|at| side[at] * level(at)).sum();
            let staying: f64 = curves().map(level).sum();
            turning.abs() - staying.abs()
        };
        let lean: Vec<f64> = (0..fold.partner.len()).map(lean).collect();
        let group = |channel: usize| seen.layout.channels[channel].group;
        let of_group = |channel: usize| {
            (0..lean.len())
                .filter(|other| group(*other) == group(channel))
                .map(|other| lean[other])
                .sum::<f64>()
        };
        fold.turns = (0..lean.len()).map(|channel| of_group(channel) > 0.0).collect();
        fold
    }

    /// The channel at this one's position in a section, and vice versa.
    fn channel(&self, section: usize, channel: usize) -> usize {
        if self.mirrored[section] { self.partner[channel] } else { channel }
    }

    /// -1 for a level that changes sign with the curve, in a mirrored section; 1 otherwise.
    pub fn sign(&self, section: usize, channel: usize, kind: Kind) -> f64 {
        if kind == Kind::Level && self.turns[channel] && self.mirrored[section] {
            -1.0
        } else {
            1.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::observe::layout::{ChannelFeatures, Feature, Layout};
    use crate::diagnose::observe::observed::Observed;
    use crate::diagnose::settings::Position;
    use crate::effects::Signals;
    use crate::simulate::{Fact, Section};
    use crate::units::Unit;

    /// A right and a left curve: the guiding force of the outer wheel is 10 and -10, its vertical
    /// force is 60 in both.
    #[test]
    fn guiding_forces_turn_with_the_curve_and_vertical_forces_do_not() {
        let section = |direction: &str| {
            let fact =
                |name: &str, text: &str| Fact { name: name.into(), text: text.into(), unit: None };
            Section {
                facts: vec![fact("radius", "300"), fact("direction", direction)],
                ..Section::nowhere()
            }
        };
        let none =
            || Signals { axis: Vec::new(), over_time: false, rate: 1.0, channels: Vec::new() };
        let observed = |direction: &str| Observed {
            section: section(direction),
            simulated: none(),
            measured: none(),
            references: Vec::new(),
            scatter: Vec::new(),
            increments: Vec::new(),
            again: false,
        };
        let channel = |(name, group): (&str, usize)| ChannelFeatures {
            name: name.into(),
            group,
            unit: Unit::one(),
            level: true,
            bands: 0,
            alike: false,
            increments: 0,
        };
        let channels = [("Y_L", 0), ("Y_R", 0), ("Q_L", 1), ("Q_R", 1)].map(channel).to_vec();
        let seen = Observations {
            features: (0..4).map(|channel| Feature { channel, kind: Kind::Level }).collect(),
            layout: Layout { channels, edges: Vec::new(), alike: (0.0, 1.0), furthest: 1.0 },
            sections: vec![observed("right"), observed("left")],
            noise: Vec::new(),
            left_out: Vec::new(),
            faults: Vec::new(),
            hashed: std::sync::OnceLock::new(),
        };
        let names = |names: [&str; 2]| names.map(str::to_string).to_vec();
        let position = |name: &str, straight, mirrored| Position {
            name: name.into(),
            straight: names(straight),
            mirrored: names(mirrored),
        };
        let settings = Settings {
            mirror: Some(("direction".into(), "left".into())),
            positions: vec![
                position("outer", ["Y_L", "Q_L"], ["Y_R", "Q_R"]),
                position("inner", ["Y_R", "Q_R"], ["Y_L", "Q_L"]),
            ],
            ..Settings::default()
        };
        let fold = Fold::new(&settings, &seen, &[10.0, -3.0, 60.0, 50.0, 3.0, -10.0, 50.0, 60.0]);
        let signs =
            |section: usize| [0, 1, 2, 3].map(|channel| fold.sign(section, channel, Kind::Level));
        assert_eq!((signs(0), signs(1)), ([1.0; 4], [-1.0, -1.0, 1.0, 1.0]));
        assert_eq!([0, 1, 2, 3].map(|channel| fold.channel(1, channel)), [1, 0, 3, 2]);
        assert_eq!(fold.sign(1, 0, Kind::Band(0)), 1.0);
    }
}
