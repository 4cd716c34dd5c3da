//! Candidate causes: for every effect of the catalogue, the change of the features with its size.

use rayon::prelude::*;

use crate::diagnose::inputs::Trying;
use crate::diagnose::levels::workshop::BEYOND;
use crate::diagnose::linearise::{
    candidate::{Candidate, Node},
    ground::Ground,
};
use crate::diagnose::observe::{
    bench::{Bench, Runs},
    observations::Observations,
};
use crate::effects::{Action, Applied, Catalogue, Effect, Operator, Signals};
use crate::problem::Problem;

/// Data for the construction of candidates.
pub struct Workshop<'a> {
    pub seen: &'a Observations,
    pub catalogue: &'a Catalogue,
    pub bench: Option<&'a Bench<'a>>,
    pub ground: &'a Ground,
    /// Neutral values of simulator parameters.
    pub neutral: &'a (dyn Fn(&str) -> Option<f64> + Sync),
    pub trying: Trying<'a>,
}

impl std::fmt::Debug for Workshop<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Workshop")
            .field("sections", &self.seen.sections.len())
            .finish_non_exhaustive()
    }
}

impl Workshop<'_> {
    /// All candidates of the catalogue.
    pub fn candidates(&self, runs: &mut Runs) -> Vec<Candidate> {
        // They do not depend on each other: all simulations are asked for at once, so that many
        // workers have one.
        let effects: Vec<&Effect> =
            self.catalogue.effects.iter().filter(|effect| effect.candidate).collect();
        let of_effect = |effect: &&Effect| {
            (self.trying)(&effect.title);
            let mut runs = Runs::default();
            let mut found = match &effect.action {
                Action::Simulator => self.simulated(effect, &mut runs),
                Action::Signals(operator, channels) => self.operated(effect, *operator, channels),
                Action::Formulas(_) => self.expressed(effect),
            };
            let alternatives = found.len();
            found.iter_mut().for_each(|candidate| candidate.alternatives = alternatives);
            (found, runs)
        };
        let made: Vec<(Vec<Candidate>, Runs)> = effects.par_iter().map(of_effect).collect();
        made.into_iter()
            .flat_map(|(found, of_these)| {
                runs.add(of_these);
                found
            })
            .collect()
    }

    fn simulated(&self, effect: &Effect, runs: &mut Runs) -> Vec<Candidate> {
        let Some(bench) = self.bench else { return Vec::new() };
        let mut asked = Vec::new();
        for fit in &effect.fits {
            let Some(((size, sizes), others)) = fit.axes.split_first() else { continue };
            let parameter = &effect.parameters[*size];
            let moved = match bench.simulator.catalogue_name() {
                Some(name) => parameter
                    .simulators
                    .iter()
                    .find(|(known, ..)| known == name)
                    .map(|(_, key, factor)| (key, factor)),
                None => parameter.model.as_ref().map(|(key, factor)| (key, factor)),
            };
            // An external simulator may have another name for a parameter of the vehicle file.
            let of_model = || {
                parameter
                    .model
                    .as_ref()
                    .and_then(|(key, factor)| Some((self.neutral)(key)? / factor))
            };
            let neutral = parameter
                .neutral
                .or_else(|| moved.and_then(|(key, factor)| Some((self.neutral)(key)? / factor)))
                .or_else(of_model);
            for fixed in combinations(others) {
                let fixed: Vec<(String, f64)> = fixed
                    .into_iter()
                    .map(|(at, value)| (effect.parameters[at].name.clone(), value))
                    .collect();
                let none = match parameter.vanishes_high {
                    true => f64::INFINITY,
                    false => neutral.unwrap_or(0.0),
                };
                let (coarse, pending) = coarse(sizes, none);
                let none = vec![Node { size: none, change: Vec::new() }];
                asked.push((
                    Candidate { fixed, pending, ..Candidate::new(effect, parameter, none) },
                    coarse,
                ));
            }
        }
        let made: Vec<(Candidate, Runs)> = asked
            .into_par_iter()
            .map(|(mut candidate, coarse)| {
                let mut runs = Runs::default();
                self.simulate(bench, effect, &mut candidate, &coarse, &mut runs);
                (candidate, runs)
            })
            .collect();
        made.into_iter()
            .map(|(candidate, of_it)| {
                runs.add(of_it);
                candidate
            })
            .collect()
    }

    /// Simulates further sizes of a candidate.
    fn simulate(
        &self,
        bench: &Bench<'_>,
        effect: &Effect,
        candidate: &mut Candidate,
        sizes: &[f64],
        runs: &mut Runs,
    ) {
        let beside = candidate.beside.clone();
        let there = beside.as_ref().map(|there| there.on(bench));
        let from = there
            .as_ref()
            .zip(beside.as_ref())
            .map_or((bench, &self.ground.base[..]), |(bench, there)| (bench, &there.base[..]));
        let made = |size: &f64| {
            let mut values = candidate.fixed.clone();
            values.push((candidate.size.clone(), *size));
            self.run(from, &applied(effect, values))
        };
        let made: Vec<Result<Vec<f64>, Problem>> = sizes.par_iter().map(made).collect();
        for (size, made) in sizes.iter().zip(made) {
            match made {
                Ok(change) => candidate.nodes.push(Node { size: *size, change }),
                Err(problem) => {
                    runs.failed.push(format!("{} = {size}: {}", candidate.size, problem.says))
                }
            }
            runs.made += self.seen.sections.len();
        }
        candidate.nodes.sort_by(|a, b| a.size.total_cmp(&b.size));
    }

    /// Simulates the remaining sizes of a candidate on the side of `towards`.
    pub fn refine(&self, candidate: &mut Candidate, towards: f64, runs: &mut Runs) {
        let (pending, left) =
            candidate.pending.iter().partition(|pending| candidate.same_side(**pending, towards));
        candidate.pending = left;
        let pending: Vec<f64> = pending;
        if let Some(effect) = self.catalogue.effect(&candidate.effect) {
            (self.trying)(&effect.title);
            pending.into_iter().for_each(|size| self.add_size(candidate, size, runs));
        }
    }

    /// Adds one size of a candidate: simulated, or applied to the signals.
    pub fn add_size(&self, candidate: &mut Candidate, size: f64, runs: &mut Runs) {
        let Some(effect) = self.catalogue.effect(&candidate.effect) else { return };
        match (&effect.action, self.bench) {
            (Action::Simulator, Some(bench)) => {
                self.simulate(bench, effect, candidate, &[size], runs)
            }
            (Action::Signals(operator, _), _) => {
                if let Some(change) = self.operate(*operator, size, &candidate.channels) {
                    candidate.nodes.push(Node { size, change });
                    candidate.nodes.sort_by(|a, b| a.size.total_cmp(&b.size));
                }
            }
            _ => {}
        }
    }

    /// The change of the features with an effect in the simulator.
    ///
    /// # Errors
    /// A section fails, or the catalogue does not define the effect for this simulator.
    fn run(
        &self,
        (bench, base): (&Bench<'_>, &[f64]),
        applied: &Applied,
    ) -> Result<Vec<f64>, Problem> {
        let effects = std::slice::from_ref(applied);
        let plan = crate::simulate::Plan::new(
            self.catalogue,
            effects,
            &self.seen.sections[0].section,
            bench.simulator.catalogue_name(),
        )?;
        let made = bench.features(&plan.settings)?;
        Ok(made.iter().zip(base).map(|(made, base)| made - base).collect())
    }

    fn operated(&self, effect: &Effect, operator: Operator, channels: &[String]) -> Vec<Candidate> {
        let present =
            |name: &String| self.seen.layout.channels.iter().any(|channel| channel.name == *name);
        let lists: Vec<Vec<String>> = if operator == Operator::Swap {
            self.pairs(channels)
        } else {
            effect.fits.iter().flat_map(|fit| fit.channels.clone()).collect()
        };
        let parameter = &effect.parameters[0];
        let trials: Vec<f64> = if operator == Operator::Swap {
            vec![1.0]
        } else {
            effect
                .fits
                .first()
                .and_then(|fit| fit.axes.first())
                .map_or(Vec::new(), |(_, trials)| trials.clone())
        };
        let discrete = matches!(operator, Operator::Swap | Operator::Polarity);
        let make = |list: Vec<String>| {
            let list: Vec<String> = if operator == Operator::Crosstalk {
                list
            } else {
                list.into_iter().filter(present).collect()
            };
            if list.is_empty() {
                return None;
            }
            let mut sizes = trials.clone();
            if operator == Operator::Offset {
                // In the unit of the channel, which the catalogue does not contain: up to the range
                // of the channel.
                let reach = self.reach(&list);
                sizes.retain(|size| size.abs() < reach);
                sizes.extend([-reach, reach]);
            }
            let mut nodes =
                vec![Node { size: parameter.neutral.unwrap_or(0.0), change: Vec::new() }];
            for size in sizes {
                if let Some(change) = self.operate(operator, size, &list) {
                    nodes.push(Node { size, change });
                }
            }
            let mut made =
                Candidate { channels: list, discrete, ..Candidate::new(effect, parameter, nodes) };
            if let (Operator::Offset, Some(first), Some(last)) =
                (operator, made.nodes.first(), made.nodes.last())
            {
                made.range = (first.size, last.size);
                if let Some(channel) = self
                    .seen
                    .layout
                    .channels
                    .iter()
                    .find(|channel| channel.name == made.channels[0])
                {
                    made.unit = channel.unit.clone();
                }
            }
            if let Some(neutral) = made.neutral().filter(|_| !discrete) {
                made.pending = beyond(made.range, neutral);
            }
            Some(made)
        };
        lists.into_par_iter().filter_map(make).collect()
    }

    /// Effects by expressions on the signals: each set of sizes is applied to the simulation as it
    /// would have been recorded.
    fn expressed(&self, effect: &Effect) -> Vec<Candidate> {
        let mut found = Vec::new();
        for fit in &effect.fits {
            let Some(((size, sizes), others)) = fit.axes.split_first() else { continue };
            let parameter = &effect.parameters[*size];
            let neutral = parameter.neutral.unwrap_or(0.0);
            for fixed in combinations(others) {
                let fixed: Vec<(String, f64)> = fixed
                    .into_iter()
                    .map(|(at, value)| (effect.parameters[at].name.clone(), value))
                    .collect();
                let mut nodes = vec![Node { size: neutral, change: Vec::new() }];
                for size in sizes.iter().filter(|size| **size != neutral) {
                    let mut values = fixed.clone();
                    values.push((parameter.name.clone(), *size));
                    if let Ok(change) = self.expression(&applied(effect, values)) {
                        nodes.push(Node { size: *size, change });
                    }
                }
                found.push(Candidate { fixed, ..Candidate::new(effect, parameter, nodes) });
            }
        }
        found
    }

    fn expression(&self, applied: &Applied) -> Result<Vec<f64>, Problem> {
        let effects = std::slice::from_ref(applied);
        let each = |at: usize| {
            let section = &self.seen.sections[at].section;
            let mut signals = self.ground.recorded.signals[at].clone();
            crate::simulate::Plan::new(self.catalogue, effects, section, None)?
                .operate(&mut signals, section)?;
            Ok(self.seen.of(at, &signals, false))
        };
        let parts: Result<Vec<Vec<f64>>, Problem> =
            (0..self.ground.recorded.signals.len()).into_par_iter().map(each).collect();
        Ok(parts?
            .concat()
            .iter()
            .zip(&self.ground.recorded.features)
            .map(|(made, without)| made - without)
            .collect())
    }

    /// Pairs of channels of one group, for exchange.
    fn pairs(&self, channels: &[String]) -> Vec<Vec<String>> {
        let of = &self.seen.layout.channels;
        let mut pairs = Vec::new();
        for (i, a) in of.iter().enumerate() {
            for b in &of[i + 1..] {
                if a.group == b.group && channels.contains(&a.name) && channels.contains(&b.name) {
                    pairs.push(vec![a.name.clone(), b.name.clone()]);
                }
            }
        }
        pairs
    }

    /// The largest magnitude of the channels, simulated or measured, as an upper bound of an
    /// offset.
    fn reach(&self, channels: &[String]) -> f64 {
        let sides = self
            .seen
            .sections
            .iter()
            .flat_map(|observed| [&observed.simulated, &observed.measured]);
        let all =
            sides.flat_map(|signals| channels.iter().filter_map(|name| signals.channel(name)));
        all.flat_map(|channel| channel.values.iter()).fold(0.0, |most, value| value.abs().max(most))
    }

    /// The change of the features with an operation on the simulation as it would have been
    /// recorded; nothing where it cannot be applied.
    pub fn operate(&self, operator: Operator, size: f64, channels: &[String]) -> Option<Vec<f64>> {
        let seen = self.seen;
        let touched = |name: &str| {
            operator == Operator::Shift || channels.iter().any(|channel| channel == name)
        };
        let mut change = Vec::with_capacity(seen.len());
        for (at, recorded) in self.ground.recorded.signals.iter().enumerate() {
            let mut signals = Signals {
                axis: recorded.axis.clone(),
                over_time: recorded.over_time,
                rate: recorded.rate,
                channels: recorded
                    .channels
                    .iter()
                    .filter(|channel| touched(&channel.name))
                    .cloned()
                    .collect(),
            };
            signals.apply(operator, size, channels, 0).ok()?;
            for (number, channel) in seen.layout.channels.iter().enumerate() {
                let from = change.len();
                let wanted =
                    seen.features.iter().filter(|feature| feature.channel == number).count();
                if touched(&channel.name) {
                    seen.of_channel(at, &signals, number, false, &mut change);
                    let without = &self.ground.recorded.features[from..];
                    change[from..]
                        .iter_mut()
                        .zip(without)
                        .for_each(|(value, without)| *value -= without);
                } else {
                    change.resize(from + wanted, 0.0);
                }
            }
        }
        Some(change)
    }
}

/// Sizes on either side of the plausible range, so that a difference with an implausible size is
/// distinguished from one at the bound.
fn beyond(range: (f64, f64), neutral: f64) -> Vec<f64> {
    let further = |end: f64| {
        let along = end + BEYOND * (end - neutral);
        // A scale factor or a cut-off frequency does not change sign.
        if neutral.is_finite() && along * end > 0.0 { along } else { end / (1.0 + BEYOND) }
    };
    [range.0, range.1]
        .into_iter()
        .filter(|end| end.is_finite() && *end != neutral)
        .map(further)
        .collect()
}

/// Splits sizes into every other one, counted from neutral to either side, and the rest. The nearer
/// of two is taken, since an effect with a threshold may have no influence at half of the farther
/// one.
fn coarse(sizes: &[f64], none: f64) -> (Vec<f64>, Vec<f64>) {
    let (mut first, mut later) = (Vec::new(), Vec::new());
    let below = sizes.iter().rev().filter(|size| **size < none).copied().collect::<Vec<_>>();
    let above = sizes.iter().filter(|size| **size > none).copied().collect::<Vec<_>>();
    for side in [below, above] {
        for (at, size) in side.iter().enumerate() {
            let chosen = if side.len() <= 2 { at == 0 } else { at % 2 == 1 };
            if chosen { first.push(*size) } else { later.push(*size) }
        }
    }
    (first, later)
}

/// An effect with values, in all sections.
pub fn applied(effect: &Effect, values: Vec<(String, f64)>) -> Applied {
    Applied { effect: effect.name.clone(), values, channels: Vec::new(), confined: None }
}

fn combinations(axes: &[(usize, Vec<f64>)]) -> Vec<Vec<(usize, f64)>> {
    axes.iter().fold(vec![Vec::new()], |known, (at, values)| {
        known
            .iter()
            .flat_map(|one| {
                values.iter().map(move |value| [one.clone(), vec![(*at, *value)]].concat())
            })
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Unit;
    use std::sync::OnceLock;

    /// A fifth beyond the range: a gain of 0.5 to 1.6, a shift of ±50 m, and a frequency that
    /// cannot be negative.
    #[test]
    fn operations_are_tried_a_fifth_beyond_what_is_plausible() {
        let near = |range: (f64, f64), neutral: f64, wanted: &[f64]| {
            let found = beyond(range, neutral);
            assert!(
                found.len() == wanted.len()
                    && found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12),
                "{found:?}"
            );
        };
        near((0.5, 1.6), 1.0, &[0.4, 1.72]);
        near((-50.0, 50.0), 0.0, &[-60.0, 60.0]);
        near((0.6, 80.0), 80.0, &[0.5]);
        near((0.6, f64::INFINITY), f64::INFINITY, &[0.5]);
    }

    /// Zero signals recorded with noise of 0.5: a gain of 0.8 reduces all bands by its logarithm,
    /// and a low-pass of 10 Hz reduces the band around 10 Hz by ln(2^1/2), as with any other
    /// signal.
    #[test]
    fn operations_act_on_noise_as_on_all_else() {
        use crate::diagnose::linearise::recorded::as_recorded;
        use crate::diagnose::observe::layout::{ChannelFeatures, Layout};
        use crate::diagnose::observe::observed::Observed;
        use crate::diagnose::settings::Settings;
        use crate::effects::Channel;
        use crate::simulate::Section;
        use crate::source::Source;

        let axis: Vec<f64> = (0..20000).map(|n| 0.1 * f64::from(n)).collect();
        let channels = vec![Channel { name: "Y".into(), values: vec![0.0; axis.len()] }];
        let silent = Signals { axis, over_time: false, rate: 200.0, channels };
        let section = Section { start: 0.0, end: 2000.0, ..Section::nowhere() };
        let observed = Observed {
            section,
            simulated: silent.clone(),
            measured: silent,
            references: vec![None],
            scatter: Vec::new(),
            increments: Vec::new(),
            again: false,
        };
        let channel = ChannelFeatures {
            name: "Y".into(),
            group: 0,
            unit: Unit::one(),
            level: false,
            bands: 3,
            alike: false,
            increments: 0,
        };
        let layout = Layout {
            channels: vec![channel],
            edges: vec![1.0, 9.5, 10.5, 20.0],
            alike: (0.5, 8.0),
            furthest: 1.0,
        };
        let (features, sections, noise) = (layout.features(), vec![observed], vec![0.5]);
        let seen = Observations {
            layout,
            features,
            sections,
            noise,
            left_out: Vec::new(),
            faults: Vec::new(),
            hashed: OnceLock::new(),
        };
        let (title, groups, units, effects) = (String::new(), Vec::new(), Vec::new(), Vec::new());
        let catalogue = Catalogue {
            name: title.clone(),
            title,
            source: Source::new("", ""),
            groups,
            units,
            effects,
            diagnosis: None,
        };
        let recorded = as_recorded(
            &seen,
            None,
            &Settings::default(),
            &|_| None,
            &|_| None,
            &mut Runs::default(),
        );
        let (neutral, trying) = (|_: &str| None, |_: &str| {});
        let ground = Ground { recorded, ..Ground::default() };
        let workshop = Workshop {
            seen: &seen,
            catalogue: &catalogue,
            bench: None,
            ground: &ground,
            neutral: &neutral,
            trying: &trying,
        };
        let operate = |operator, size| {
            workshop.operate(operator, size, &["Y".to_string()]).expect("an operation")
        };
        let gain = operate(Operator::Gain, 0.8);
        assert!(gain.iter().all(|change| (change - 0.8_f64.ln()).abs() < 1e-9), "{gain:?}");
        let band = operate(Operator::LowPass, 10.0)[1];
        assert!((band - 0.5_f64.sqrt().ln()).abs() < 0.02, "{band}");
    }
}
