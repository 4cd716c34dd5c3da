//! Guards: views that share no feature must agree on the size of an effect, and what is left must be within what is allowed for.

use super::features::Kind;
use super::fit::Mask;
use super::observe::Observations;
use super::whiten::{Covariance, dot};

/// Features of some sections: a part of the data that is looked at on its own.
#[derive(Clone, Debug)]
pub struct View {
    pub says: String,
    pub sections: Vec<usize>,
    pub features: Vec<usize>,
}

impl Covariance {
    /// The covariance of some features of some sections.
    #[must_use]
    pub fn part(&self, sections: &[usize], features: &[usize]) -> Self {
        let pick = |column: &[f64], section: usize| {
            features.iter().map(move |feature| column[section * self.size + feature]).collect::<Vec<f64>>()
        };
        let whole = |column: &Vec<f64>| sections.iter().flat_map(|section| pick(column, *section)).collect::<Vec<f64>>();
        let inside = self.inside.iter().filter_map(|(section, column)| {
            let at = sections.iter().position(|of| of == section)?;
            let part: Vec<f64> = features.iter().map(|feature| column[*feature]).collect();
            part.iter().any(|x| *x != 0.0).then_some((at, part))
        });
        Self {
            diagonal: whole(&self.diagonal),
            inside: inside.collect(),
            shared: self.shared.iter().map(whole).filter(|column| column.iter().any(|x| *x != 0.0)).collect(),
            size: features.len(),
        }
    }
}

/// The part of a column that a view sees.
#[must_use]
pub fn part(column: &[f64], size: usize, view: &View) -> Vec<f64> {
    view.sections.iter().flat_map(|section| view.features.iter().map(move |feature| column[section * size + feature])).collect()
}

/// What a view says about an effect: how much of it is there (1: all), and the standard error of that.
#[must_use]
pub fn share_seen(covariance: &Covariance, view: &View, change: &[f64], rest: &[f64]) -> Option<(f64, f64)> {
    let direction = part(change, covariance.size, view);
    if direction.iter().all(|x| *x == 0.0) {
        return None;
    }
    let whitener = covariance.part(&view.sections, &view.features).whitener();
    let direction = whitener.apply(&direction);
    let rest = whitener.apply(&part(rest, covariance.size, view));
    let length = dot(&direction, &direction);
    (length > 0.0).then(|| (dot(&direction, &rest) / length, 1.0 / length.sqrt()))
}

/// Views by kind of feature, by stratum, and by group of channels; the views of a family share no feature.
#[must_use]
pub fn families(seen: &Observations, strata: &[Vec<usize>]) -> Vec<Vec<View>> {
    let all: Vec<usize> = (0..seen.sections.len()).collect();
    let features = |keep: &dyn Fn(usize, Kind) -> bool| -> Vec<usize> {
        seen.features.iter().enumerate().filter(|(_, feature)| keep(feature.channel, feature.kind)).map(|(at, _)| at).collect()
    };
    let view = |says: &str, sections: &[usize], features: Vec<usize>| View { says: says.into(), sections: sections.to_vec(), features };
    let kinds = vec![
        view("quasi-static values", &all, features(&|_, kind| kind == Kind::Level)),
        view("dynamic content", &all, features(&|_, kind| kind != Kind::Level)),
    ];
    let every = features(&|_, _| true);
    let strata = strata.iter().map(|sections| {
        let named: Vec<&str> = sections.iter().map(|at| seen.sections[*at].section.name()).collect();
        view(&format!("sections {}", named.join(", ")), sections, every.clone())
    });
    let mut groups: Vec<usize> = seen.layout.channels.iter().map(|channel| channel.group).collect();
    groups.dedup();
    let groups = groups.into_iter().map(|group| {
        let named: Vec<&str> =
            seen.layout.channels.iter().filter(|channel| channel.group == group).map(|channel| channel.name.as_str()).collect();
        view(&named.join(", "), &all, features(&|channel, _| seen.layout.channels[channel].group == group))
    });
    let (even, odd): (Vec<usize>, Vec<usize>) = all.iter().partition(|at| *at % 2 == 0);
    let halves = vec![view("every second section", &even, every.clone()), view("the other sections", &odd, every.clone())];
    vec![kinds, strata.collect(), groups.collect(), halves]
}

/// Share of the evidence that must be left whichever section is taken away.
const KEPT: f64 = 0.5;

/// The section without which most of the evidence for a change is gone, if one carries it; one of few sections always does.
#[must_use]
pub fn carried(covariance: &Covariance, mask: &Mask, change: &[f64], rest: &[f64]) -> Option<String> {
    use rayon::prelude::*;
    let inside: Vec<usize> = (0..mask.sections.len()).filter(|at| mask.sections[*at]).collect();
    let moved = |at: &usize| change[at * covariance.size..(at + 1) * covariance.size].iter().any(|x| *x != 0.0);
    if inside.iter().filter(|at| moved(at)).count() < 4 {
        return None;
    }
    let features: Vec<usize> = (0..covariance.size).collect();
    let evidence = |without: Option<usize>| {
        let sections = (0..mask.sections.len()).filter(|at| Some(*at) != without).collect();
        let view = View { says: String::new(), sections, features: features.clone() };
        share_seen(covariance, &view, change, rest).map_or(0.0, |(share, error)| (share / error).powi(2))
    };
    let all = evidence(None);
    let (at, least) = inside.into_par_iter().map(|at| (at, evidence(Some(at)))).min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))?;
    (least < KEPT * all).then(|| format!("without section {} only {:.0} % of the evidence is left", at + 1, 100.0 * least / all))
}

/// How views of a family contradict each other: the two that differ most, if they differ by more than chance (Cochran's Q).
#[must_use]
pub fn contradiction(covariance: &Covariance, family: &[View], change: &[f64], rest: &[f64]) -> Option<String> {
    let seen: Vec<(&View, f64, f64)> =
        family.iter().filter_map(|view| share_seen(covariance, view, change, rest).map(|(share, error)| (view, share, error))).collect();
    let good: Vec<&(&View, f64, f64)> = seen.iter().filter(|(_, _, error)| *error < 0.35).collect();
    if good.len() < 2 {
        return None;
    }
    let weight: f64 = good.iter().map(|(_, _, error)| error.powi(-2)).sum();
    let mean = good.iter().map(|(_, share, error)| share * error.powi(-2)).sum::<f64>() / weight;
    // The change is not linear in the size: views may differ by a part of it.
    let q: f64 = good.iter().map(|(_, share, error)| (share - mean).powi(2) / (error.powi(2) + 0.15_f64.powi(2))).sum();
    let freedom = (good.len() - 1) as f64;
    let limit = statrs::distribution::ContinuousCDF::inverse_cdf(&statrs::distribution::ChiSquared::new(freedom).ok()?, 0.99);
    if q < limit {
        return None;
    }
    let low = good.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let high = good.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    if high.1 - low.1 < 0.6 {
        return None;
    }
    Some(format!("{} ask for {:.0} % of it, {} for {:.0} %", high.0.says, 100.0 * high.1, low.0.says, 100.0 * low.1))
}

/// How far what is left goes beyond what is allowed for, channel by channel and kind by kind: standard deviations of chi-squared.
#[must_use]
pub fn lack_of_fit(covariance: &Covariance, seen: &Observations, rest: &[f64]) -> Vec<(String, Kind, f64, f64)> {
    use rayon::prelude::*;
    let all: Vec<usize> = (0..seen.sections.len()).collect();
    let mut views = Vec::new();
    for (channel, of) in seen.layout.channels.iter().enumerate() {
        for level in [true, false] {
            let keep = |kind: Kind| (kind == Kind::Level) == level;
            let features: Vec<usize> =
                seen.features.iter().enumerate().filter(|(_, f)| f.channel == channel && keep(f.kind)).map(|(at, _)| at).collect();
            if !features.is_empty() {
                let kind = if level { Kind::Level } else { Kind::Band(0) };
                views.push((of.name.clone(), kind, View { says: String::new(), sections: all.clone(), features }));
            }
        }
    }
    let each = |(name, kind, view): (String, Kind, View)| {
        let z = covariance.part(&view.sections, &view.features).whitener().apply(&part(rest, covariance.size, &view));
        let n = z.len() as f64;
        let chi = dot(&z, &z);
        (name, kind, (chi - n) / (2.0 * n).sqrt(), chi - n)
    };
    views.into_par_iter().map(each).collect()
}
