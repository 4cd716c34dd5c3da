//! Whether an operation on the signals has one size over the whole campaign.

use nalgebra::{DMatrix, DVector};

use super::causes::short;
use crate::diagnose::allowed::whiten::Covariance;
use crate::diagnose::gap::trends::{CERTAIN, Covariate, NINETY, covariates};
use crate::diagnose::observe::features::Kind;
use crate::diagnose::run::Found;
use crate::diagnose::search::fit::Fitted;
use crate::diagnose::search::lack::{left, with_room};
use crate::diagnose::settings::Settings;
use crate::effects::{CHANNEL, Catalogue};
use crate::result::diagnosis::Drift;
use statrs::distribution::{ContinuousCDF, Normal};

/// Of a squared length, what rounding leaves of it.
const NOTHING: f64 = 1e-9;

/// How the size of each operation on the signals changes with what the sections differ in: by least squares beside the sizes of all
/// members, whitened by what may differ beside the answer. What is simulated is not looked at: what the model is wrong in may itself grow
/// with the curvature. Sizes between which nothing lies, as of a polarity, are the same everywhere or confined.
#[must_use]
pub fn drifts(settings: &Settings, found: &Found) -> Vec<Drift> {
    let exact = |member: &&Fitted| found.candidates[member.candidate].exact && !found.candidates[member.candidate].discrete;
    let operations: Vec<&Fitted> = found.chosen.members.iter().filter(exact).collect();
    if operations.is_empty() {
        return Vec::new();
    }
    let whitener = with_room(&may_differ(found), &found.candidates, &found.masks, &found.chosen).whitener();
    let rest: DVector<f64> = whitener.apply(&left(&found.candidates, &found.masks, &found.beside.difference, &found.chosen)).into();
    let columns: Vec<DVector<f64>> =
        found.chosen.members.iter().map(|member| whitener.apply(&member.tangent(&found.candidates, &found.masks)).into()).collect();
    let sizes = DMatrix::from_columns(&columns).qr().q();
    let covariates = covariates(settings, &found.seen);
    let of = |member: &Fitted, covariate: &Covariate| {
        let mut growing = member.tangent(&found.candidates, &found.masks);
        let features = found.seen.features.len();
        growing.iter_mut().enumerate().for_each(|(at, change)| *change *= covariate.values[at / features]);
        let growing = DVector::from(whitener.apply(&growing));
        // What no size that is the same everywhere can do.
        let own = &growing - &sizes * sizes.tr_mul(&growing);
        let length = own.norm_squared();
        if length <= NOTHING * growing.norm_squared() {
            return None;
        }
        let candidate = &found.candidates[member.candidate];
        let (change, error) = (own.dot(&rest) / length, 1.0 / length.sqrt());
        let [from, to] = covariate.ends.clone();
        Some(Drift {
            effect: candidate.effect.clone(),
            signals: candidate.channels.clone(),
            parameter: candidate.size.replace(&format!(".{CHANNEL}"), ""),
            unit: candidate.unit.to_string(),
            covariate: covariate.name.clone(),
            from,
            to,
            change,
            low: change - NINETY * error,
            high: change + NINETY * error,
            p_value: 2.0 * Normal::standard().sf((change / error).abs()),
        })
    };
    operations.iter().flat_map(|member| covariates.iter().filter_map(|covariate| of(member, covariate))).collect()
}

/// What may differ beside the answer, with room for what a simulated member has wrong as one; lags that jump with its size do not count.
/// Sections that stand out alone do: what drifts stands out at its ends.
fn may_differ(found: &Found) -> Covariance {
    let mut covariance = found.settled.covariance.clone();
    for (at, _) in found.seen.features.iter().enumerate().filter(|(_, feature)| feature.kind != Kind::Lag) {
        for place in (0..found.seen.sections.len()).map(|section| found.seen.place(section, at)) {
            covariance.diagonal[place] = found.beside.covariance.diagonal[place];
        }
    }
    covariance
}

/// The drift that is least probable, if it is no chance among all that were looked at (Bonferroni).
#[must_use]
pub fn certain(drifts: &[Drift]) -> Option<&Drift> {
    let least = drifts.iter().min_by(|a, b| a.p_value.total_cmp(&b.p_value))?;
    (least.p_value * (drifts.len() as f64) < CERTAIN).then_some(least)
}

/// In words, if it is certain.
#[must_use]
pub fn worth_a_word(catalogue: &Catalogue, drifts: &[Drift]) -> Option<String> {
    let drift = certain(drifts)?;
    let title = catalogue.effect(&drift.effect).map_or(drift.effect.as_str(), |effect| effect.title.as_str());
    let on = if drift.signals.len() > 2 { String::new() } else { format!(" ({})", drift.signals.join(", ")) };
    let unit = if drift.unit == "-" { String::new() } else { format!(" {}", drift.unit) };
    Some(format!(
        "{title}{on}: no one size holds over the campaign. It follows {}: {} changes by {}{unit} ({} to {}) from {} to {}.",
        drift.covariate,
        drift.parameter,
        short(drift.change),
        short(drift.low),
        short(drift.high),
        drift.from,
        drift.to
    ))
}
