//! Test whether an operation on the signals has the same size over the whole campaign.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use super::causes::short;
use crate::diagnose::features::layout::Kind;
use crate::diagnose::inference::fit::Fitted;
use crate::diagnose::levels::common::NINETY;
use crate::diagnose::levels::steady::NOTHING;
use crate::diagnose::levels::trends::CERTAIN;
use crate::diagnose::localisation::trends::{Covariate, covariates};
use crate::diagnose::response::candidate::Candidate;
use crate::diagnose::run::Found;
use crate::diagnose::selection::lack::{left, with_room};
use crate::diagnose::settings::Settings;
use crate::diagnose::uncertainty::whiten::Covariance;
use crate::effects::{CHANNEL, Catalogue};
use crate::result::diagnosis::Drift;

/// Covariate name for a size that varies between sections without order.
const SECTION: &str = "the section alone";

/// Trends of the size of each operation on the signals, over each covariate and between sections.
/// Least squares together with the sizes of all members, whitened by the covariance with the
/// answer. Simulated effects are excluded, since the model error may itself depend on the
/// curvature. Discrete sizes such as a polarity cannot vary; they are the same everywhere or
/// confined.
#[must_use]
pub fn drifts(settings: &Settings, found: &Found) -> Vec<Drift> {
    let exact = |member: &&Fitted| {
        found.candidates[member.candidate].exact && !found.candidates[member.candidate].discrete
    };
    let operations: Vec<&Fitted> = found.answer.chosen.members.iter().filter(exact).collect();
    if operations.is_empty() {
        return Vec::new();
    }
    let whitener =
        with_room(&may_differ(found), &found.candidates, &found.masks, &found.answer.chosen)
            .whitener();
    let rest: DVector<f64> = whitener
        .apply(&left(
            &found.candidates,
            &found.masks,
            &found.allowed.beside.difference,
            &found.answer.chosen,
        ))
        .into();
    let columns: Vec<DVector<f64>> = found
        .answer
        .chosen
        .members
        .iter()
        .map(|member| whitener.apply(&member.tangent(&found.candidates, &found.masks)).into())
        .collect();
    let sizes = DMatrix::from_columns(&columns).qr().q();
    let covariates = covariates(settings, &found.seen);
    let of = |member: &Fitted, covariate: &Covariate| {
        let mut growing = member.tangent(&found.candidates, &found.masks);
        let features = found.seen.features.len();
        growing
            .iter_mut()
            .enumerate()
            .for_each(|(at, change)| *change *= covariate.values[at / features]);
        let growing = DVector::from(whitener.apply(&growing));
        // The component that no constant size reproduces.
        let own = &growing - &sizes * sizes.tr_mul(&growing);
        let length = own.norm_squared();
        if length <= NOTHING * growing.norm_squared() {
            return None;
        }
        let (change, error) = (own.dot(&rest) / length, 1.0 / length.sqrt());
        let [from, to] = covariate.ends.clone();
        let p_value = 2.0 * Normal::standard().sf((change / error).abs());
        Some(drift(
            &found.candidates[member.candidate],
            (covariate.name.clone(), from, to),
            (change, error),
            p_value,
        ))
    };
    let apart = |member: &Fitted| {
        let tangent = member.tangent(&found.candidates, &found.masks);
        let features = found.seen.features.len();
        let alone = |at: usize| {
            let mut alone = vec![0.0; tangent.len()];
            alone[at * features..][..features]
                .copy_from_slice(&tangent[at * features..][..features]);
            DVector::from(whitener.apply(&alone))
        };
        let (sections, columns): (Vec<usize>, Vec<DVector<f64>>) = (0..found.seen.sections.len())
            .map(|at| (at, alone(at)))
            .filter(|(_, column)| column.norm_squared() > 0.0)
            .unzip();
        let apart = Apart::fit(&columns, &sizes, &rest)?;
        let name = |at: usize| found.seen.sections[sections[at]].section.name().to_string();
        let names = (SECTION.into(), name(apart.from), name(apart.to));
        Some(drift(
            &found.candidates[member.candidate],
            names,
            (apart.change, apart.error),
            apart.p_value,
        ))
    };
    let all = |member: &&Fitted| -> Vec<Drift> {
        covariates
            .iter()
            .filter_map(|covariate| of(member, covariate))
            .chain(apart(member))
            .collect()
    };
    operations.iter().flat_map(all).collect()
}

fn drift(
    candidate: &Candidate,
    (covariate, from, to): (String, String, String),
    (change, error): (f64, f64),
    p_value: f64,
) -> Drift {
    Drift {
        effect: candidate.effect.clone(),
        signals: candidate.channels.clone(),
        parameter: candidate.size.replace(&format!(".{CHANNEL}"), ""),
        unit: candidate.unit.to_string(),
        covariate,
        from,
        to,
        change,
        low: change - NINETY * error,
        high: change + NINETY * error,
        p_value,
    }
}

/// Variation of a size between sections without order: least squares with one size per section in
/// addition to the constant sizes (Cochran's test of homogeneity, with correlated errors).
struct Apart {
    /// The sections with the smallest and the largest deviation from the common size; their
    /// difference and its error.
    from: usize,
    to: usize,
    change: f64,
    error: f64,
    /// Probability of the data if all sizes are the same.
    p_value: f64,
}

impl Apart {
    /// `columns` are the changes of single sections; `sizes` an orthonormal basis of the constant
    /// sizes.
    fn fit(columns: &[DVector<f64>], sizes: &DMatrix<f64>, rest: &DVector<f64>) -> Option<Self> {
        if columns.len() < 2 {
            return None;
        }
        let columns = DMatrix::from_columns(columns);
        let own = &columns - sizes * sizes.tr_mul(&columns);
        let squares = own.tr_mul(&own).symmetric_eigen();
        let least = NOTHING * squares.eigenvalues.max();
        let told: Vec<usize> =
            (0..columns.ncols()).filter(|at| squares.eigenvalues[*at] > least).collect();
        let mut covariance = DMatrix::zeros(columns.ncols(), columns.ncols());
        for at in &told {
            let vector = squares.eigenvectors.column(*at);
            covariance += vector * vector.transpose() / squares.eigenvalues[*at];
        }
        let along = own.tr_mul(rest);
        let differ = &covariance * &along;
        let (from, to) = (differ.argmin().0, differ.argmax().0);
        let variance =
            covariance[(from, from)] + covariance[(to, to)] - 2.0 * covariance[(from, to)];
        let fall = ChiSquared::new(told.len() as f64).ok()?;
        Some(Self {
            from,
            to,
            change: differ[to] - differ[from],
            error: variance.max(0.0).sqrt(),
            p_value: fall.sf(along.dot(&differ)),
        })
    }
}

/// The covariance with the answer, with the model error of simulated members as one column each.
/// Lags that jump with the size are excluded. Outlying sections are kept: a drift is largest at its
/// ends.
fn may_differ(found: &Found) -> Covariance {
    let mut covariance = found.allowed.settled.covariance.clone();
    for (at, _) in
        found.seen.features.iter().enumerate().filter(|(_, feature)| feature.kind != Kind::Lag)
    {
        for place in (0..found.seen.sections.len()).map(|section| found.seen.place(section, at)) {
            covariance.diagonal[place] = found.allowed.beside.covariance.diagonal[place];
        }
    }
    covariance
}

/// The trend with the smallest probability, if it is significant among all trends tested
/// (Bonferroni).
#[must_use]
pub fn certain(drifts: &[Drift]) -> Option<&Drift> {
    let least = drifts.iter().min_by(|a, b| a.p_value.total_cmp(&b.p_value))?;
    (least.p_value * (drifts.len() as f64) < CERTAIN).then_some(least)
}

/// A sentence on the significant trend, if there is one.
#[must_use]
pub fn worth_a_word(catalogue: &Catalogue, drifts: &[Drift]) -> Option<String> {
    let drift = certain(drifts)?;
    let title = catalogue
        .effect(&drift.effect)
        .map_or(drift.effect.as_str(), |effect| effect.title.as_str());
    let on = if drift.signals.len() > 2 {
        String::new()
    } else {
        format!(" ({})", drift.signals.join(", "))
    };
    let unit = if drift.unit == "-" { String::new() } else { format!(" {}", drift.unit) };
    Some(format!(
        "{title}{on}: no single value fits the whole campaign. It depends on {}: {} changes by {}{unit} ({} to {}) from {} to {}.",
        drift.covariate,
        drift.parameter,
        short(drift.change),
        short(drift.low),
        short(drift.high),
        drift.from,
        drift.to
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four sections of one feature each, of unit variance, that change by 5 per unit of the size.
    /// With sizes of 0.1, 0.5, 0.3, 0.3 the mean is 0.3, chi-squared 5^2 * (0.2^2 + 0.2^2) = 2 with
    /// three degrees of freedom, and the difference of two sizes has the error 2^1/2 / 5. The
    /// probability is erfc((x / 2)^1/2) + (2 x / pi)^1/2 e^(-x / 2) = 0.1573 + 0.4151 for x = 2.
    #[test]
    fn sizes_that_differ_from_section_to_section_are_told() {
        let columns: Vec<DVector<f64>> = (0..4)
            .map(|at| DVector::from_fn(5, |row, _| if row == at { 5.0 } else { 0.0 }))
            .collect();
        let sizes = DMatrix::from_column_slice(5, 1, &[0.5, 0.5, 0.5, 0.5, 0.0]);
        // The size does not change the last feature.
        let rest = DVector::from_column_slice(&[0.5, 2.5, 1.5, 1.5, 7.0]);
        let apart = Apart::fit(&columns, &sizes, &rest).expect("four sections");
        assert_eq!((apart.from, apart.to), (0, 1));
        assert!(
            (apart.change - 0.4).abs() < 1e-12 && (apart.error - 2_f64.sqrt() / 5.0).abs() < 1e-12
        );
        assert!((apart.p_value - 0.572_407).abs() < 1e-6, "{}", apart.p_value);
        assert!(Apart::fit(&columns[..1], &sizes, &rest).is_none());
    }
}
