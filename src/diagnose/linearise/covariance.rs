//! Covariance of the residual without any effect: noise, declared tolerances, and the allowed
//! discrepancy of the model.

use crate::diagnose::levels::covariance::{BAND_SCATTER, GAIN, GAIN_SCATTER, NOTHING, ZERO_POINT};
use crate::diagnose::linearise::{
    response::ResponseError,
    standing::{Keyed, Standing},
    whiten::Covariance,
};
use crate::diagnose::observe::{
    increments::Increments,
    layout::Kind,
    observations::Observations,
    strata::{strata, stratum_of},
};
use crate::diagnose::settings::{Discrepancy, FeatureKind, Moves, Over, Settings, Times};

/// Change of the simulated features with a tolerated parameter, per standard deviation.
#[derive(Clone, Debug)]
pub struct Sensitivity {
    pub tolerance: String,
    pub parameter: String,
    pub column: Vec<f64>,
    /// Expected value of the deviation, in standard deviations.
    pub expected: f64,
    pub per_section: bool,
    /// Share of a standard deviation that is common to all sections.
    pub shared: f64,
}

/// Subtracts the expected deviation of the tolerances from a difference.
pub fn expect(sensitivities: &[Sensitivity], difference: &mut [f64]) {
    for sensitivity in sensitivities.iter().filter(|sensitivity| sensitivity.expected != 0.0) {
        difference
            .iter_mut()
            .zip(&sensitivity.column)
            .for_each(|(difference, column)| *difference -= sensitivity.expected * column);
    }
}

/// The covariance of `measured - simulated` without any effect. `simulated` are the features of the
/// campaign's simulation. Without `standing`, noise and tolerances alone are included.
pub fn covariance(
    seen: &Observations,
    settings: &Settings,
    simulated: &[f64],
    sensitivities: &[Sensitivity],
    declared: &dyn Fn(&str) -> Option<f64>,
    standing: Option<&Standing>,
) -> Covariance {
    let size = seen.features.len();
    let response = ResponseError::new(seen, settings);
    let mut covariance = Covariance {
        diagonal: diagonal(seen, settings, declared),
        inside: Vec::new(),
        shared: Vec::new(),
        size,
        response,
    };
    for sensitivity in sensitivities {
        if sensitivity.shared > 0.0 {
            covariance
                .shared
                .push(sensitivity.column.iter().map(|x| sensitivity.shared * x).collect());
        }
        if sensitivity.per_section {
            for section in 0..seen.sections.len() {
                covariance.inside.push((
                    section,
                    sensitivity.column[section * size..(section + 1) * size].to_vec(),
                ));
            }
        }
    }
    for channel in 0..seen.layout.channels.len() {
        covariance.shared.extend(calibration(seen, settings, simulated, channel, declared));
    }
    if let Some(standing) = standing {
        let (columns, inside) = discrepancies(seen, settings);
        covariance.shared.extend(standing.weighed(columns));
        covariance.inside.extend(inside);
    }
    covariance.shared.retain(|column| column.iter().any(|x| *x != 0.0));
    covariance.inside.retain(|(_, column)| column.iter().any(|x| *x != 0.0));
    covariance
}

/// A section, and a column of its features.
type Inside = (usize, Vec<f64>);

/// Columns of all discrepancies: those common to all sections, and those of single sections.
pub fn discrepancies(seen: &Observations, settings: &Settings) -> (Vec<Keyed>, Vec<Inside>) {
    let (mut shared, mut inside) = (Vec::new(), Vec::new());
    for (number, discrepancy) in settings.discrepancies.iter().enumerate() {
        discrepant(seen, settings, (number, discrepancy), &mut shared, &mut inside);
    }
    (shared, inside)
}

/// Columns for gain and offset of the channels, with declared standard deviations.
fn calibration(
    seen: &Observations,
    settings: &Settings,
    simulated: &[f64],
    channel: usize,
    declared: &dyn Fn(&str) -> Option<f64>,
) -> Vec<Vec<f64>> {
    let group = &settings.groups[seen.layout.channels[channel].group];
    let size = seen.features.len();
    let mut columns = Vec::new();
    let along = |section: usize, increment: usize, of: fn(&Increments) -> &Vec<f64>| {
        seen.sections[section]
            .increments
            .get(channel)
            .and_then(Option::as_ref)
            .map_or(0.0, |increments| of(increments)[increment])
    };
    let mut push = |of: &dyn Fn(usize, Kind) -> f64| {
        let mut column = vec![0.0; seen.len()];
        for section in 0..seen.sections.len() {
            for (at, feature) in
                seen.features.iter().enumerate().filter(|(_, feature)| feature.channel == channel)
            {
                column[section * size + at] = of(section * size + at, feature.kind);
            }
        }
        columns.push(column);
    };
    if let Some(sd) = group.gain.as_deref().and_then(declared).or(group.gain.as_ref().map(|_| GAIN))
    {
        push(&|at, kind| match kind {
            Kind::Level => sd * simulated[at],
            Kind::Band(_) | Kind::Gain => sd,
            Kind::Lag => 0.0,
            Kind::Increment(increment) => {
                sd * along(at / size, increment, |increments| &increments.signal)
            }
        });
    }
    if let Some(sd) = group.offset.as_deref().and_then(declared) {
        push(&|at, kind| match kind {
            Kind::Level => sd,
            Kind::Increment(increment) => {
                sd * along(at / size, increment, |increments| &increments.one)
            }
            _ => 0.0,
        });
    }
    columns
}

/// Variances of the single features.
fn diagonal(
    seen: &Observations,
    settings: &Settings,
    declared: &dyn Fn(&str) -> Option<f64>,
) -> Vec<f64> {
    let mut variances = Vec::with_capacity(seen.len());
    for (at, observed) in seen.sections.iter().enumerate() {
        let (_, length) = seen.extent(at);
        if observed.again {
            variances.extend(seen.features.iter().map(|_| NOTHING));
            continue;
        }
        for feature in &seen.features {
            let group = &settings.groups[seen.layout.channels[feature.channel].group];
            let scatter = &observed.scatter[feature.channel];
            variances.push(match feature.kind {
                // The zero point of a channel wanders between sections with its declared offset.
                Kind::Level => {
                    let offset = group.offset.as_deref().and_then(declared).unwrap_or(0.0);
                    scatter.level + group.level_sd.max(ZERO_POINT * offset).powi(2)
                }
                Kind::Band(band) => {
                    // Variance of ln(rms) over a band of width B and a duration T: 1 / (4 B T) for
                    // each record; half of it is common to both.
                    let width = seen.layout.edges[band + 1] - seen.layout.edges[band];
                    BAND_SCATTER / (width * length).max(0.5) + group.band_sd * group.band_sd
                }
                Kind::Gain => group.gain_sd * group.gain_sd + GAIN_SCATTER / length.max(1.0),
                Kind::Lag if scatter.has_lag => group.lag_sd * group.lag_sd,
                Kind::Lag => NOTHING,
                Kind::Increment(_) => observed.increments[feature.channel]
                    .as_ref()
                    .map_or(NOTHING, |increments| increments.variance),
            });
        }
    }
    variances
}

/// Columns of a discrepancy.
fn discrepant(
    seen: &Observations,
    settings: &Settings,
    (number, discrepancy): (usize, &Discrepancy),
    shared: &mut Vec<Keyed>,
    inside: &mut Vec<Inside>,
) {
    let size = seen.features.len();
    let bands = seen.layout.edges.len().saturating_sub(1);
    // Kinds of features that are fully correlated.
    let kinds: Vec<Vec<Kind>> = match discrepancy.feature {
        FeatureKind::Level => vec![vec![Kind::Level]],
        FeatureKind::Bands => (0..bands).map(|band| vec![Kind::Band(band)]).collect(),
        FeatureKind::Amplitude => vec![(0..bands).map(Kind::Band).collect()],
        FeatureKind::Gain => vec![vec![Kind::Gain]],
        FeatureKind::Lag => vec![vec![Kind::Lag]],
    };
    let sd = |at: usize| discrepancy.sd.get(at).or(discrepancy.sd.last()).copied().unwrap_or(0.0);
    for (at, kinds) in kinds.iter().enumerate() {
        for members in members(seen, discrepancy) {
            let value = |section: usize| {
                let mut values = vec![0.0; size];
                let times = times(seen, settings, discrepancy.times, section);
                for (channel, weight) in &members {
                    for feature in kinds.iter().filter_map(|kind| seen.find(*channel, *kind)) {
                        values[feature] = weight * sd(at) * times;
                    }
                }
                values
            };
            let names: Vec<&str> = members
                .iter()
                .map(|(channel, _)| seen.layout.channels[*channel].name.as_str())
                .collect();
            let key = format!("{number} {at} {}", names.join(" "));
            match discrepancy.over {
                Over::Sections => {
                    inside.extend((0..seen.sections.len()).map(|section| (section, value(section))))
                }
                Over::All => shared.push(Keyed {
                    key,
                    values: (0..seen.sections.len()).flat_map(value).collect(),
                }),
                Over::Strata => {
                    for stratum in strata(seen, settings) {
                        let mut values = vec![0.0; seen.len()];
                        for section in &stratum {
                            values[section * size..(section + 1) * size]
                                .copy_from_slice(&value(*section));
                        }
                        shared.push(Keyed {
                            key: format!("{key} in {}", stratum_of(seen, settings, stratum[0])),
                            values,
                        });
                    }
                }
            }
        }
    }
}

/// Channels that are fully correlated, with their weights.
fn members(seen: &Observations, discrepancy: &Discrepancy) -> Vec<Vec<(usize, f64)>> {
    let number = |name: &str| seen.layout.channels.iter().position(|channel| channel.name == name);
    let all: Vec<(usize, f64)> = discrepancy
        .channels
        .iter()
        .filter_map(|(name, weight)| Some((number(name)?, *weight)))
        .collect();
    match discrepancy.moves {
        Moves::All => vec![all],
        Moves::Channel => all.into_iter().map(|one| vec![one]).collect(),
        Moves::Group => {
            let mut groups: Vec<usize> =
                all.iter().map(|(channel, _)| seen.layout.channels[*channel].group).collect();
            groups.dedup();
            let of = |group: usize| {
                all.iter()
                    .copied()
                    .filter(|(channel, _)| seen.layout.channels[*channel].group == group)
                    .collect()
            };
            groups.into_iter().map(of).collect()
        }
    }
}

fn times(seen: &Observations, settings: &Settings, times: Times, section: usize) -> f64 {
    let section = &seen.sections[section].section;
    let over = |number: f64| {
        section
            .number("radius")
            .filter(|radius| *radius > 0.0)
            .map_or(0.0, |radius| (number / radius).min(2.0))
    };
    match times {
        Times::One => 1.0,
        Times::Side => settings.side(section),
        Times::Over(number) => settings.side(section) * over(number),
        Times::Unsigned(number) => over(number),
    }
}
