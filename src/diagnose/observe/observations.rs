//! A campaign as features: measured and simulated, section by section.

use std::sync::OnceLock;

use rayon::prelude::*;

use crate::data::{Campaign, RecordKind, checks::whole, hash::sha256};
use crate::diagnose::levels::observations::ROUNDED;
use crate::diagnose::observe::{
    faults::faults,
    increments::{Increments, Limit},
    layout::{ChannelFeatures, Feature, Kind, Layout, Spectrum, VERSION, of_channel},
    observed::{Observed, piece},
    scatter::{Scatter, scatter},
};
use crate::diagnose::settings::{GroupFeatures, Settings};
use crate::effects::{Catalogue, Signals};
use crate::problem::{Problem, Problems, Severity};
use crate::result::diagnosis::Fault;
use crate::simulate::{Section, in_units, interpolated, recorded_inside};
use crate::units::Unit;

/// All sections of a campaign that have both records.
#[derive(Debug)]
pub struct Observations {
    pub layout: Layout,
    pub features: Vec<Feature>,
    pub sections: Vec<Observed>,
    /// Standard deviation of white noise per sample, by channel of the layout.
    pub noise: Vec<f64>,
    /// Excluded sections, with the reason.
    pub left_out: Vec<(String, String)>,
    /// Faulty channels.
    pub faults: Vec<Fault>,
    /// See [`Observations::identity`].
    pub hashed: OnceLock<String>,
}

impl Observations {
    /// Reads the records of a campaign in the units given by `unit`, else in those of the
    /// simulation, and finds the channels that both sides have.
    ///
    /// Problems: no section can be read; no channel of the catalogue is in the records.
    pub fn read(
        campaign: &Campaign,
        sections: Vec<Section>,
        catalogue: &Catalogue,
        settings: &Settings,
        declared: &dyn Fn(&str) -> Option<f64>,
        unit: &(dyn Fn(&str) -> Option<Unit> + Sync),
        problems: &mut Problems,
    ) -> Option<Self> {
        type Both = (Section, Result<(Signals, Signals), Problem>);
        let read: Vec<Both> = sections
            .into_par_iter()
            .map(|section| {
                let both = both_sides(campaign, &section, unit);
                (section, both)
            })
            .collect();
        let mut left_out = Vec::new();
        let mut good = Vec::new();
        for (section, both) in read {
            match both {
                Ok((simulated, measured)) => good.push((section, simulated, measured)),
                Err(problem) => {
                    left_out.push((section.name().to_string(), problem.says.clone()));
                    problems.push(Problem { severity: Severity::Warning, ..problem });
                }
            }
        }
        if good.is_empty() {
            let reason = left_out.first().map_or(String::new(), |(section, reason)| {
                format!("; section `{section}`: {reason}")
            });
            problems.push(Problem::error(
                "no-sections",
                format!("no section of the campaign can be compared{reason}"),
            ));
            return None;
        }
        let mut sections: Vec<Observed> = Vec::new();
        for (section, simulated, measured) in good {
            let again = section
                .fact("repeat of")
                .is_some_and(|of| sections.iter().any(|known| known.section.name() == of))
                || sections.iter().any(|known| known.measured.channels == measured.channels);
            sections.push(Observed {
                section,
                simulated,
                measured,
                references: Vec::new(),
                scatter: Vec::new(),
                increments: Vec::new(),
                again,
            });
        }
        let mut layout = Layout {
            channels: Vec::new(),
            edges: settings.edges.clone(),
            alike: settings.alike,
            furthest: settings.furthest,
        };
        let everywhere = |name: &String| {
            sections.iter().all(|observed| {
                observed.simulated.channel(name).is_some()
                    && observed.measured.channel(name).is_some()
            })
        };
        let channels = |group: &GroupFeatures| {
            catalogue.channels(&group.name).unwrap_or_default().into_iter().filter(everywhere)
        };
        let all: Vec<String> = settings.groups.iter().flat_map(&channels).collect();
        let faults = faults(&sections, &all);
        let mut noise = Vec::new();
        for (at, group) in settings.groups.iter().enumerate() {
            for name in
                channels(group).filter(|name| faults.iter().all(|fault| fault.channel != *name))
            {
                noise.push(group.noise.as_deref().and_then(declared).unwrap_or(0.0));
                let bands = group.bands.min(settings.edges.len().saturating_sub(1));
                layout.channels.push(ChannelFeatures {
                    name,
                    group: at,
                    unit: group.unit.clone(),
                    level: group.level,
                    bands,
                    alike: group.alike,
                    increments: 0,
                });
            }
        }
        if layout.channels.is_empty() {
            let known: Vec<String> =
                catalogue.groups.iter().flat_map(|group| group.channels.clone()).collect();
            let says = format!(
                "no channel of the catalogue `{}` is in both records of every section",
                catalogue.name
            );
            problems.push(
                Problem::error("no-channels", says)
                    .help(format!("the catalogue lists {}", known.join(", "))),
            );
            return None;
        }
        if let Some(problem) = above_nyquist(catalogue, &layout, &sections) {
            problems.push(problem);
            return None;
        }
        let features = layout.features();
        sections.par_iter_mut().enumerate().for_each(|(at, observed)| {
            let of = |signals: &Signals, of: &ChannelFeatures| {
                piece(signals, &of.name, &observed.section)
            };
            let spectrum = |channel: &ChannelFeatures| {
                of(&observed.simulated, channel).map(|piece| Spectrum::new(&piece))
            };
            observed.references = layout.channels.iter().map(spectrum).collect();
            let scatter = |(channel, reference): (&ChannelFeatures, &Option<Spectrum>)| {
                let (measured, simulated) =
                    of(&observed.measured, channel).zip(of(&observed.simulated, channel))?;
                Some(scatter(&layout, &measured, &simulated, reference.as_ref()?, at as u64))
            };
            let both = layout.channels.iter().zip(&observed.references);
            observed.scatter = both
                .map(|both| scatter(both).unwrap_or(Scatter { level: 0.0, has_lag: false }))
                .collect();
        });
        Some(Self { layout, features, sections, noise, left_out, faults, hashed: OnceLock::new() })
    }

    /// Adds the comparison sample by sample, for the channels of some groups. `with` are the
    /// signals of each section with each effect.
    pub fn compare_samples(&mut self, groups: &[bool], with: &[Vec<Signals>]) {
        let channels = &mut self.layout.channels;
        channels
            .iter_mut()
            .filter(|channel| groups[channel.group])
            .for_each(|channel| channel.increments = with.len());
        let (channels, edges) = (&self.layout.channels, &self.layout.edges);
        self.sections.par_iter_mut().enumerate().for_each(|(at, observed)| {
            let of = |channel: &ChannelFeatures| {
                if channel.increments == 0 {
                    return None;
                }
                let values = |signals: &Signals| on_axis(observed, signals, &channel.name);
                let (simulated, measured) =
                    (values(&observed.simulated), values(&observed.measured));
                let change = |with: &Vec<Signals>| {
                    values(&with[at])
                        .iter()
                        .zip(&simulated)
                        .map(|(with, base)| with - base)
                        .collect()
                };
                let highest = if channel.bands > 0 { edges.get(channel.bands) } else { None };
                let limit = highest.and_then(|edge| Limit::new(observed.simulated.rate, *edge));
                Increments::new(
                    &with.iter().map(change).collect::<Vec<_>>(),
                    &simulated,
                    &measured,
                    limit,
                )
            };
            observed.increments = channels.iter().map(of).collect();
        });
        self.features = self.layout.features();
        self.hashed = OnceLock::new();
    }

    /// What the features of a simulated record depend on besides the record: under another
    /// identity, kept features are not valid.
    pub fn identity(&self) -> &str {
        self.hashed.get_or_init(|| {
            let named = |observed: &Observed| {
                format!(
                    "{} {:?} {:?}",
                    observed.section.name(),
                    observed.section.start,
                    observed.section.end
                )
            };
            let sections: Vec<String> = self.sections.iter().map(named).collect();
            let of = |increments: &Option<Increments>| {
                increments.as_ref().map_or(String::new(), Increments::identity)
            };
            let samples: Vec<String> = self
                .sections
                .iter()
                .flat_map(|observed| observed.increments.iter().map(of))
                .collect();
            sha256(
                format!(
                    "{VERSION}\n{:?}\n{:?}\n{sections:?}\n{samples:?}",
                    self.layout, self.noise
                )
                .as_bytes(),
            )
        })
    }

    /// Sections that do not repeat an earlier one.
    pub fn first_runs(&self) -> Vec<usize> {
        (0..self.sections.len()).filter(|at| !self.sections[*at].again).collect()
    }

    /// Number of features of all sections.
    pub fn len(&self) -> usize {
        self.sections.len() * self.features.len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Features of the signals of a section. `noisy` adds the power of the declared noise, which
    /// simulated signals do not contain.
    pub fn of(&self, at: usize, signals: &Signals, noisy: bool) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.features.len());
        for channel in 0..self.layout.channels.len() {
            self.of_channel(at, signals, channel, noisy, &mut out);
        }
        out
    }

    /// Features of one channel of a section.
    pub fn of_channel(
        &self,
        at: usize,
        signals: &Signals,
        channel: usize,
        noisy: bool,
        out: &mut Vec<f64>,
    ) {
        let observed = &self.sections[at];
        let of = &self.layout.channels[channel];
        let before = out.len();
        if let Some(piece) = piece(signals, &of.name, &observed.section) {
            let noise = if noisy { self.noise[channel] } else { 0.0 };
            of_channel(&self.layout, of, &piece, observed.references[channel].as_ref(), noise, out);
        }
        let wanted = self.features.iter().filter(|feature| feature.channel == channel).count();
        out.resize(before + wanted - of.increments, 0.0);
        let increments = observed.increments.get(channel).and_then(Option::as_ref);
        out.extend(
            increments
                .and_then(|of_it| of_it.of(&on_axis(observed, signals, &of.name)))
                .unwrap_or_default(),
        );
        out.resize(before + wanted, 0.0);
    }

    /// Features of all sections, concatenated.
    pub fn all(&self, noisy: bool, signals: impl Fn(&Observed) -> &Signals + Sync) -> Vec<f64> {
        let each = |at: usize| self.of(at, signals(&self.sections[at]), noisy);
        (0..self.sections.len()).into_par_iter().flat_map_iter(each).collect()
    }

    /// Index of a feature of a section in the list of all.
    pub fn place(&self, section: usize, feature: usize) -> usize {
        section * self.features.len() + feature
    }

    /// Sampling rate in 1/s and length in s of a section.
    pub fn extent(&self, at: usize) -> (f64, f64) {
        let observed = &self.sections[at];
        let inside = observed
            .measured
            .axis
            .iter()
            .filter(|x| **x >= observed.section.start && **x <= observed.section.end)
            .count();
        (observed.measured.rate, inside as f64 / observed.measured.rate)
    }

    /// Index of the channel's feature of a kind.
    pub fn find(&self, channel: usize, kind: Kind) -> Option<usize> {
        self.features.iter().position(|feature| *feature == Feature { channel, kind })
    }
}

/// A channel at the positions of the simulated record inside the section, linear between its own
/// samples.
fn on_axis(observed: &Observed, signals: &Signals, name: &str) -> Vec<f64> {
    let Some(channel) = signals.channel(name) else { return Vec::new() };
    let inside = |x: &&f64| (observed.section.start..=observed.section.end).contains(*x);
    let mut at = 0;
    let axis = observed.simulated.axis.iter().filter(inside);
    axis.map(|x| interpolated(&signals.axis, &channel.values, *x, &mut at)).collect()
}

/// Simulated and measured signals in the same units: those of `unit`, else of the simulation.
fn both_sides(
    campaign: &Campaign,
    section: &Section,
    unit: &dyn Fn(&str) -> Option<Unit>,
) -> Result<(Signals, Signals), Problem> {
    let side = |kind| recorded_inside(campaign, kind, section).map_err(first);
    let (mut simulated, units) = side(RecordKind::Simulation)?;
    let (mut measured, others) = side(RecordKind::Measurement)?;
    let to = |name: &str| {
        unit(name)
            .or_else(|| units.iter().find(|(known, _)| known == name).map(|(_, unit)| unit.clone()))
    };
    in_units(&mut simulated, &units, &to)?;
    in_units(&mut measured, &others, &to)?;
    Ok((simulated, measured))
}

fn first(problems: Vec<Problem>) -> Problem {
    problems
        .into_iter()
        .next()
        .unwrap_or_else(|| Problem::error("unreadable", "the record cannot be read"))
}

/// A band that is a feature, or the band of gain and lag, that ends above half the lowest sampling
/// rate: its power would be that of the band's lower part, or of nothing.
fn above_nyquist(catalogue: &Catalogue, layout: &Layout, sections: &[Observed]) -> Option<Problem> {
    let rates = |observed: &Observed| [observed.measured.rate, observed.simulated.rate];
    let slowest = |observed: &&Observed| rates(observed)[0].min(rates(observed)[1]);
    let observed = sections.iter().min_by(|a, b| slowest(a).total_cmp(&slowest(b)))?;
    let [measured, simulated] = rates(observed);
    let (rate, side) =
        if simulated < measured { (simulated, "simulation") } else { (measured, "measurement") };
    let bands = layout.channels.iter().map(|channel| channel.bands).max().unwrap_or(0);
    let used = layout.edges.iter().enumerate().take(if bands > 0 { bands + 1 } else { 0 });
    let written = |key: &str, at: usize| {
        Some(catalogue.diagnosis.as_ref()?.get(key)?.items().get(at)?.span.clone())
    };
    let alike = layout.channels.iter().any(|channel| channel.alike).then_some(layout.alike.1);
    let all = used
        .map(|(at, edge)| (*edge, written("bands", at)))
        .chain(alike.map(|edge| (edge, written("alike", 1))));
    let (edge, at) =
        all.into_iter().find(|(edge, at)| *edge > 0.5 * rate * (1.0 + ROUNDED) && at.is_some())?;
    let says = format!(
        "a band ends at {edge} Hz, but the {side} of section `{}` has {} samples a second: above {} Hz it has no content",
        observed.section.name(),
        whole(rate),
        0.5 * whole(rate)
    );
    let problem = Problem::error("band-above-nyquist", says)
        .help("end the bands below half the sampling rate");
    Some(at.map_or(problem.clone(), |at| problem.at(&at)))
}
