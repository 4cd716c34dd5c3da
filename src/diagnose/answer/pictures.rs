//! Figures of the sections with the largest gap: measured, simulated, simulated with the effects.

use crate::diagnose::levels::pictures::{PANELS, SECTIONS, SMOOTH};
use crate::diagnose::observe::layout::Kind;
use crate::diagnose::run::Found;
use crate::diagnose::settings::Settings;
use crate::effects::Signals;
use crate::metrics::filter::{Band, Cutoff, Filter, Phase};
use crate::result::{
    Curve,
    diagnosis::{Panel, Picture},
};
use crate::simulate::{Section, Units};

/// The sections with the largest gap, each with the channels of one group and position; for forces
/// of a bogie vehicle, the four wheels of one bogie.
pub fn pictures(
    settings: &Settings,
    found: &Found,
    improved: &[Signals],
    units: &Units,
) -> Vec<Picture> {
    let seen = &found.seen;
    // Deviation of each channel in each section, in standard deviations of noise and tolerances.
    let off = |section: usize, channel: usize| {
        seen.features
            .iter()
            .enumerate()
            .filter(|(_, feature)| {
                feature.channel == channel && matches!(feature.kind, Kind::Level | Kind::Band(_))
            })
            .map(|(at, _)| {
                let place = seen.place(section, at);
                let shared: f64 =
                    found.tolerated.shared.iter().map(|column| column[place].powi(2)).sum();
                let inside: f64 = found
                    .tolerated
                    .inside
                    .iter()
                    .filter(|(of, _)| *of == section)
                    .map(|(_, column)| column[at].powi(2))
                    .sum();
                found.alone.difference[place].powi(2)
                    / (found.tolerated.diagonal[place] + shared + inside)
            })
            .sum::<f64>()
    };
    let mut ranked: Vec<(usize, usize, f64)> = Vec::new();
    for section in 0..seen.sections.len() {
        for (group, _) in settings.groups.iter().enumerate() {
            let channels: Vec<usize> = (0..seen.layout.channels.len())
                .filter(|at| seen.layout.channels[*at].group == group)
                .collect();
            for (part, some) in channels.chunks(PANELS).enumerate() {
                let sum = some.iter().map(|channel| off(section, *channel)).sum::<f64>()
                    / some.len() as f64;
                ranked.push((section, group * 100 + part, sum));
            }
        }
    }
    ranked.sort_by(|a, b| b.2.total_cmp(&a.2));
    let mut chosen: Vec<(usize, usize)> = Vec::new();
    for (section, part, _) in ranked {
        if chosen.len() < SECTIONS && !chosen.iter().any(|(known, _)| *known == section) {
            chosen.push((section, part));
        }
    }
    chosen
        .into_iter()
        .map(|(section, part)| picture(settings, found, improved, units, section, part))
        .collect()
}

fn picture(
    settings: &Settings,
    found: &Found,
    improved: &[Signals],
    units: &Units,
    at: usize,
    part: usize,
) -> Picture {
    let observed = &found.seen.sections[at];
    let (group, part) = (part / 100, part % 100);
    let channels = found
        .seen
        .layout
        .channels
        .iter()
        .filter(|channel| channel.group == group)
        .skip(part * PANELS)
        .take(PANELS);
    let section = &observed.section;
    let panels = channels.map(|channel| {
        let name = &channel.name;
        Panel {
            channel: name.clone(),
            unit: units
                .iter()
                .find(|(known, _)| known == name)
                .map_or("-".into(), |(_, unit)| unit.text.clone()),
            measured: curve(&observed.measured, name, section),
            simulated: curve(&observed.simulated, name, section),
            improved: improved
                .get(at)
                .map(|signals| curve(signals, name, section))
                .unwrap_or_default(),
        }
    });
    let stratum = settings.stratum.as_deref().and_then(|column| section.says(column));
    let facts = ["radius", "direction", "speed"].iter().filter_map(|column| section.says(column));
    Picture {
        section: section.name().to_string(),
        says: stratum.into_iter().chain(facts).collect::<Vec<_>>().join(", "),
        axis: if section.speed.is_some() { "distance [m]".into() } else { "axis".into() },
        start: section.start,
        end: section.end,
        panels: panels.collect(),
    }
}

/// A channel around its section, low-pass filtered; every second sample.
fn curve(signals: &Signals, name: &str, section: &Section) -> Curve {
    let Some(channel) = signals.channel(name) else { return Curve::default() };
    let filter =
        Filter::design(Band::LowPass(SMOOTH), 4, signals.rate, Phase::Zero, Cutoff::AsApplied);
    let values = filter
        .ok()
        .and_then(|filter| filter.apply(&channel.values).ok())
        .unwrap_or_else(|| channel.values.clone());
    let margin = 0.1 * (section.end - section.start);
    let inside = |x: &f64| {
        !margin.is_finite() || (*x >= section.start - margin && *x <= section.end + margin)
    };
    let samples: Vec<(f64, f64)> =
        signals.axis.iter().copied().zip(values).filter(|(x, _)| inside(x)).step_by(2).collect();
    Curve {
        x: samples.iter().map(|(x, _)| *x).collect(),
        y: samples.iter().map(|(_, y)| *y).collect(),
    }
}
