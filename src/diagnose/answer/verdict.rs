//! The verdict of a diagnosis: one table of rules over what was found, of which the first that
//! applies decides.

use crate::diagnose::levels::{
    common::NINETY,
    verdict::{MISFIT, ROOMY},
};
use crate::diagnose::run::Found;
use crate::result::{
    Remark, Statement, Verdict as OfProtocol,
    diagnosis::{Fit, Shrink},
};

/// The verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    NoSignificantGap,
    Explained,
    Ambiguous,
    Unexplained,
}

impl Verdict {
    /// As in `diagnosis.json`.
    pub fn word(self) -> &'static str {
        match self {
            Self::NoSignificantGap => "no significant gap",
            Self::Explained => "explained",
            Self::Ambiguous => "ambiguous",
            Self::Unexplained => "unexplained",
        }
    }
}

/// What the verdict depends on.
#[derive(Clone, Copy, Debug, Default)]
pub struct Facts {
    /// Whether effects are named.
    pub named: bool,
    /// Whether a recording is faulty.
    pub faulty: bool,
    /// Whether a channel differs by more than is allowed, or a trend or a sum of forces remains.
    pub lacking: bool,
    pub systematic: bool,
    /// Whether most of the excess remains, a parameter outside the catalogue explains more, or an
    /// effect that the data contradict does.
    pub much_left: bool,
    /// Whether names and sizes did not stand still.
    pub moving: bool,
    /// Whether alternatives are as good, or another effect is better in many resamples.
    pub tied: bool,
    /// Whether the criteria of the protocol are not met without effects.
    pub protocol_fails: bool,
    /// The gap on sections excluded from the fit that the effects remove, as a share; nothing where
    /// no quantity of the protocol feels them.
    pub removed: Option<f64>,
    /// The same on the sections that the campaign holds out, and the upper end of its interval.
    pub held_out: Option<(f64, f64)>,
    /// What is left, in units of what is allowed.
    pub misfit: f64,
}

/// A rule: its condition, its verdict, and its reason where the answer does not state it elsewhere.
struct Rule {
    applies: fn(&Facts) -> bool,
    verdict: Verdict,
    reason: Option<Statement>,
}

const fn rule(applies: fn(&Facts) -> bool, verdict: Verdict, reason: Option<Statement>) -> Rule {
    Rule { applies, verdict, reason }
}

/// In this order.
static RULES: [Rule; 11] = [
    rule(|of| !of.named && (of.faulty || of.lacking || of.systematic), Verdict::Unexplained, None),
    rule(
        |of| !of.named && of.protocol_fails,
        Verdict::Unexplained,
        Some(Statement::CriteriaNotMet),
    ),
    rule(|of| !of.named, Verdict::NoSignificantGap, None),
    rule(|of| of.systematic || of.much_left, Verdict::Unexplained, None),
    rule(|of| of.misfit > MISFIT, Verdict::Unexplained, Some(Statement::LargerThanAllowed)),
    rule(
        |of| of.held_out.is_some_and(|(_, high)| high < 0.0),
        Verdict::Unexplained,
        Some(Statement::NotSmallerOnHeldOut),
    ),
    rule(|of| of.moving, Verdict::Ambiguous, Some(Statement::StillMoving)),
    rule(
        |of| {
            of.removed.is_some_and(|removed| removed <= 0.0)
                || of.held_out.is_some_and(|(removed, _)| removed <= 0.0)
        },
        Verdict::Ambiguous,
        Some(Statement::NotSmaller),
    ),
    rule(|of| of.tied, Verdict::Ambiguous, None),
    rule(
        |of| of.removed.is_none() && of.protocol_fails,
        Verdict::Explained,
        Some(Statement::CriteriaNotTouched),
    ),
    rule(|_| true, Verdict::Explained, None),
];

/// The verdict, and its reason where the answer does not state it elsewhere.
pub fn verdict(facts: &Facts) -> (Verdict, Option<Statement>) {
    let first = RULES.iter().find(|rule| (rule.applies)(facts));
    first.map_or((Verdict::Unexplained, None), |rule| (rule.verdict, rule.reason.clone()))
}

/// Whether criteria of the protocol are not met.
pub fn fails(protocol: OfProtocol) -> bool {
    protocol == OfProtocol::NotValidated
}

/// The share of the gap that the effects remove on sections excluded from the fit: of all
/// quantities or of those that the effects change, whichever is larger. Nothing where they change
/// none.
pub fn removed(shrink: Option<&Shrink>) -> Option<f64> {
    let shrink = shrink?;
    let touched = shrink.touched.as_ref()?;
    Some(shrink.fraction_removed.max(touched.fraction_removed))
}

/// How well the answer fits: chi-squared of all that is left, with the model error of the simulated
/// effects allowed.
pub fn fit(found: &Found) -> Fit {
    use statrs::distribution::{ChiSquared, ContinuousCDF};
    let z = found.wider().whitener().apply(&found.left());
    let features = z.len().max(1) as f64;
    let chi_squared: f64 = z.iter().map(|z| z * z).sum();
    let freedom = (features - found.answer.chosen.set().len() as f64).max(1.0);
    let p_value = ChiSquared::new(freedom).map_or(f64::NAN, |law| law.sf(chi_squared));
    let per_feature = chi_squared / features;
    let scale = per_feature.sqrt();
    Fit {
        chi2_per_feature: per_feature,
        p_value,
        allowance_scale: scale,
        allowance_scale_sd: scale / (2.0 * freedom).sqrt(),
    }
}

/// A remark where what is allowed does not fit what is left.
pub fn remark(fit: &Fit) -> Option<Remark> {
    let Fit { chi2_per_feature, allowance_scale: factor, allowance_scale_sd, .. } = *fit;
    let within = NINETY * allowance_scale_sd;
    let larger = chi2_per_feature > MISFIT;
    (larger || chi2_per_feature < ROOMY).then_some(Remark::WrongAllowance {
        larger,
        chi2_per_feature,
        factor,
        within,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each fact alone, from an answer that explains everything and from no answer.
    #[test]
    fn each_fact_decides_as_the_table_says() {
        let answer = Facts { named: true, removed: Some(0.6), misfit: 1.0, ..Facts::default() };
        let nothing = Facts { misfit: 1.0, ..Facts::default() };
        let of = |facts: Facts| verdict(&facts).0;
        assert_eq!(of(answer), Verdict::Explained);
        assert_eq!(of(Facts { tied: true, ..answer }), Verdict::Ambiguous);
        for facts in [
            Facts { systematic: true, ..answer },
            Facts { much_left: true, ..answer },
            Facts { misfit: 7.8, ..answer },
            Facts { held_out: Some((-0.11, -0.01)), ..answer },
            Facts { held_out: Some((-0.11, -0.01)), tied: true, ..answer },
        ] {
            assert_eq!(of(facts), Verdict::Unexplained, "{facts:?}");
        }
        // An effect that no quantity of the protocol feels is not refuted by the protocol; that it
        // does not explain it is said.
        // Excluded sections refute nothing: they are other parts of the same records. Held-out ones
        // do, unless the interval contains zero.
        for unsure in [
            Facts { removed: Some(-0.11), ..answer },
            Facts { held_out: Some((-0.11, 0.05)), ..answer },
        ] {
            assert_eq!(verdict(&unsure), (Verdict::Ambiguous, Some(Statement::NotSmaller)));
        }
        let unfelt = Facts { removed: None, protocol_fails: true, ..answer };
        assert_eq!(of(unfelt), Verdict::Explained);
        assert_eq!(verdict(&unfelt).1, Some(Statement::CriteriaNotTouched));
        assert_eq!(of(nothing), Verdict::NoSignificantGap);
        for facts in [
            Facts { lacking: true, ..nothing },
            Facts { faulty: true, ..nothing },
            Facts { systematic: true, ..nothing },
        ] {
            assert_eq!(verdict(&facts), (Verdict::Unexplained, None), "{facts:?}");
        }
        let (within, reason) = verdict(&Facts { protocol_fails: true, ..nothing });
        assert_eq!(within, Verdict::Unexplained);
        assert_eq!(reason, Some(Statement::CriteriaNotMet));
    }

    #[test]
    fn allowances_far_from_what_is_left_are_told() {
        let of = |per_feature: f64| {
            let scale = per_feature.sqrt();
            remark(&Fit {
                chi2_per_feature: per_feature,
                p_value: 0.5,
                allowance_scale: scale,
                allowance_scale_sd: scale / 20.0,
            })
            .map(|remark| remark.text().to_string())
        };
        assert!(of(1.0).is_none());
        assert!(of(7.8).is_some_and(|says| says.contains("2.79 \u{b1} 0.23 times as large")));
        assert!(of(0.04).is_some_and(|says| says.contains("0.20 \u{b1} 0.02")));
    }
}
