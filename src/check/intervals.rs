//! Checks ends of confidence intervals, and regressions over the data of sections.

use super::{
    estimates::{bare, reducer_name},
    prelude::*,
};
use crate::catalog::Statistic;
use crate::metrics::rounded;
use crate::syntax::phrase::Fit as WrittenFit;

/// Largest number of regressors. With more, the number of sections of usual tests is too small for
/// a regression.
const MOST_REGRESSORS: usize = 8;

/// Confidence levels that a bootstrap of 2000 draws can resolve: 10 draws lie beyond each of these
/// limits.
const DRAWN: (f64, f64) = (0.005, 0.995);

/// Smallest confidence level. Below it, the upper end of a one-sided interval lies below the
/// estimate: `upper 5 %` would accept more than no confidence at all, and is usually an error
/// probability.
const LEAST_CONFIDENCE: f64 = 0.5;

/// Whether it is the arithmetic mean.
fn is_mean(statistic: Statistic) -> bool {
    matches!(statistic, Statistic::Named(entry) if entry.name == "mean")
}

impl Checker<'_> {
    /// An end of a confidence interval: `upper 95 % of std`.
    pub fn group_bound(
        &mut self,
        (upper, confidence, bootstrap): (bool, &Phrase, bool),
        of: &Phrase,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let Some(dimension) = scope.values() else { return self.no_values(span) };
        let confidence = self.confidence(confidence)?;
        let named = matches!(of.node, Node::Path(_) | Node::Percentile(_));
        let name = if named { reducer_name(of) } else { bare(&of.words()) };
        let estimate = if named && !self.names.estimates.contains_key(&name) {
            let statistic = self.statistic(&of.with(name))?;
            let statistic = self.not_each(statistic, "group", span)?;
            self.of_statistic(statistic)
        } else {
            let kind = self.of_values(of, dimension, scope.zone.clone().as_deref())?;
            if kind.taken.iter().any(|taking| matches!(taking, Taking::Bound { .. })) {
                return self.refuse(error(
                    "interval-of-interval",
                    "the end of a confidence interval has no confidence interval of its own",
                    span,
                ));
            }
            Estimate {
                title: name.clone(),
                name,
                kind: EstimateKind::Of(Box::new(kind)),
                of_scatter: false,
                unit: None,
            }
        };
        let weighted = estimate.weighted().map(|(statistic, ..)| statistic);
        let of_scatter = estimate.of_scatter || weighted.is_some_and(Statistic::of_scatter);
        let closed = match estimate.statistic() {
            Some((Statistic::Named(entry), ddof)) => {
                entry.name == "mean" || entry.name == "std" && ddof == 1
            }
            _ => weighted.is_some_and(is_mean),
        };
        let estimate = Estimate { of_scatter, ..estimate };
        if (bootstrap || !closed) && !(DRAWN.0..=DRAWN.1).contains(&confidence) {
            return self.refuse(error(
                "out-of-range",
                "a bootstrap of 2000 draws cannot give a bound outside 0.5 % to 99.5 %",
                span,
            ));
        }
        let dimension = match &estimate.kind {
            EstimateKind::Of(of) if estimate.statistic().is_none() => of.expr.dimension(),
            _ => dimension,
        };
        scope.take(Taking::Bound { of: estimate, upper, confidence, bootstrap }, dimension, span)
    }

    /// A regression or prediction: `prediction over cant_deficiency at 143 mm, confidence 99 %`.
    pub fn group_fit(
        &mut self,
        written: &WrittenFit,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let Some(dimension) = scope.values() else { return self.no_values(span) };
        if written.over.len() > MOST_REGRESSORS {
            return self.refuse(problem!(
                "too-large",
                span,
                "{} regressors; there can be at most {MOST_REGRESSORS}",
                written.over.len()
            ));
        }
        if written.over.len() != written.at.len() {
            let help = "write for instance `prediction over a, b at 1, 2`";
            return self.refuse(
                problem!(
                    "arguments",
                    span,
                    "a regression over {} regressors needs as many values after `at`; there are {}",
                    written.over.len(),
                    written.at.len()
                )
                .help(help),
            );
        }
        let confidence =
            if_written(written.confidence.as_ref().map(|written| self.confidence(written)))?;
        if written.prediction && confidence.is_none() {
            let says = "a prediction bound needs a confidence level";
            let help =
                "add `, confidence 99 %`; the fitted value itself is `regression over ... at ...`";
            return self.refuse(error("missing-confidence", says, span).help(help));
        }
        let pairs = all(written.over.iter().zip(&written.at).map(|(regressor, target)| {
            let regressor = self.expr(regressor, &mut scope.of_section());
            let target = self.of_group(target, None, scope);
            let (regressor, target) = (regressor?, target?);
            let (of, read) = (self.number_type(&regressor), self.number_type(&target.expr));
            let (of, read) = (of?, read?);
            if of == read {
                return Some((regressor, target));
            }
            self.refuse(
                problem!(
                    "unit-mismatch",
                    &target.expr,
                    "the regressor is {}, the value after `at` is {}",
                    of.in_words(),
                    read.in_words()
                )
                .also(&regressor, of.in_words()),
            )
        }))?;
        let (over, at) = pairs.into_iter().unzip();
        let fit = Fit {
            prediction: written.prediction,
            over,
            at,
            confidence,
            one_sided: written.one_sided,
            lower: written.lower,
        };
        scope.take(Taking::Fit(Box::new(fit)), dimension, span)
    }

    /// A confidence level, from 0 to 1.
    fn confidence(&mut self, written: &Phrase) -> Option<f64> {
        let share = self.constant_of("confidence", Dimension::ONE, "a share", written)?;
        if (LEAST_CONFIDENCE..1.0).contains(&share) {
            return Some(share);
        }
        let help = if share > 0.0 && share < LEAST_CONFIDENCE {
            let [error, confidence] = [share, 1.0 - share].map(|share| rounded(100.0 * share));
            format!("an error probability of {error} % is a confidence of {confidence} %")
        } else {
            "write it as a percentage: `95 %`".into()
        };
        let says = "a confidence level must be at least 50 % and below 100 %";
        let at = self.set_at(written);
        self.refuse(error("out-of-range", says, written).also_if(at, "its value").help(help))
    }
}
