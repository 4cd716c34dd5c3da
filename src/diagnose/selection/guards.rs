//! Guards: views without common features must agree on the size of an effect, and no single section
//! may carry its evidence.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::diagnose::features::layout::Kind;
use crate::diagnose::features::observations::Observations;
use crate::diagnose::inference::chosen::Judged;
use crate::diagnose::inference::fit::{Fitted, Fitter};
use crate::diagnose::levels::guards::{
    DIFFERENT, ENOUGH, EXPECTED, HETEROGENEOUS, KEPT, MODEL, PRECISE, SOME, SPILL, SPILT, SURE,
    VERY_STRONG,
};
use crate::diagnose::response::candidate::Candidate;
use crate::diagnose::response::mask::Mask;
use crate::diagnose::uncertainty::whiten::{Covariance, Whitener, dot};

/// A part of the data that is fitted separately: some features of some sections.
#[derive(Clone, Debug)]
pub struct View {
    pub says: String,
    pub sections: Vec<usize>,
    pub features: Vec<usize>,
}

impl Covariance {
    /// The covariance of some features of some sections. A section listed twice counts as two
    /// independent sections.
    #[must_use]
    pub fn part(&self, sections: &[usize], features: &[usize]) -> Self {
        let pick = |column: &[f64], section: usize| {
            features
                .iter()
                .map(move |feature| column[section * self.size + feature])
                .collect::<Vec<f64>>()
        };
        let whole = |column: &Vec<f64>| {
            sections.iter().flat_map(|section| pick(column, *section)).collect::<Vec<f64>>()
        };
        let inside = self.inside.iter().flat_map(|(section, column)| {
            let part: Vec<f64> = features.iter().map(|feature| column[*feature]).collect();
            let there = part.iter().any(|x| *x != 0.0);
            let places = sections.iter().enumerate().filter(move |(_, of)| there && *of == section);
            places.map(move |(at, _)| (at, part.clone()))
        });
        Self {
            diagonal: whole(&self.diagonal),
            inside: inside.collect(),
            shared: self
                .shared
                .iter()
                .map(whole)
                .filter(|column| column.iter().any(|x| *x != 0.0))
                .collect(),
            size: features.len(),
            response: self.response.part(sections, features),
        }
    }
}

/// The part of a column in a view.
#[must_use]
pub fn part(column: &[f64], size: usize, view: &View) -> Vec<f64> {
    view.sections
        .iter()
        .flat_map(|section| {
            view.features.iter().map(move |feature| column[section * size + feature])
        })
        .collect()
}

/// The share of an effect that a view shows (1: all), and its standard error.
#[must_use]
pub fn share_seen(
    covariance: &Covariance,
    view: &View,
    change: &[f64],
    rest: &[f64],
) -> Option<(f64, f64)> {
    let direction = part(change, covariance.size, view);
    if direction.iter().all(|x| *x == 0.0) {
        return None;
    }
    let products = covariance.part(&view.sections, &view.features).products();
    let (length, along) = products.of(&direction, &part(rest, covariance.size, view), false)[0];
    (length > 0.0).then(|| (along / length, 1.0 / length.sqrt()))
}

/// Views by kind of feature, by stratum, by group of channels and by halves; the views of a family
/// have no common feature.
#[must_use]
pub fn families(seen: &Observations, strata: &[Vec<usize>]) -> Vec<Vec<View>> {
    let all: Vec<usize> = seen.first_runs();
    let features = |keep: &dyn Fn(usize, Kind) -> bool| -> Vec<usize> {
        seen.features
            .iter()
            .enumerate()
            .filter(|(_, feature)| keep(feature.channel, feature.kind))
            .map(|(at, _)| at)
            .collect()
    };
    let view = |says: &str, sections: &[usize], features: Vec<usize>| View {
        says: says.into(),
        sections: sections.to_vec(),
        features,
    };
    let kinds = vec![
        view("quasi-static values", &all, features(&|_, kind| kind == Kind::Level)),
        view("dynamic content", &all, features(&|_, kind| kind != Kind::Level)),
    ];
    let every = features(&|_, _| true);
    let strata = strata.iter().map(|sections| {
        let named: Vec<&str> =
            sections.iter().map(|at| seen.sections[*at].section.name()).collect();
        view(&format!("sections {}", named.join(", ")), sections, every.clone())
    });
    let mut groups: Vec<usize> = seen.layout.channels.iter().map(|channel| channel.group).collect();
    groups.dedup();
    let groups = groups.into_iter().map(|group| {
        let named: Vec<&str> = seen
            .layout
            .channels
            .iter()
            .filter(|channel| channel.group == group)
            .map(|channel| channel.name.as_str())
            .collect();
        view(
            &named.join(", "),
            &all,
            features(&|channel, _| seen.layout.channels[channel].group == group),
        )
    });
    let (even, odd): (Vec<usize>, Vec<usize>) = all.iter().partition(|at| *at % 2 == 0);
    let halves = vec![
        view("every second section", &even, every.clone()),
        view("the other sections", &odd, every.clone()),
    ];
    let mut families = vec![kinds, strata.collect(), groups.collect(), halves];
    // A catalogue may have levels only, and a campaign one section.
    families.iter_mut().for_each(|family| {
        family.retain(|view| !view.sections.is_empty() && !view.features.is_empty())
    });
    families
}

/// The section without which the evidence of a change falls most, and the share that remains, if
/// that section carries the evidence. With few sections, one always does.
#[must_use]
pub fn carried(
    covariance: &Covariance,
    mask: &Mask,
    change: &[f64],
    rest: &[f64],
) -> Option<(usize, f64)> {
    let inside: Vec<usize> = (0..mask.sections.len()).filter(|at| mask.sections[*at]).collect();
    let moved = |at: &usize| {
        change[at * covariance.size..(at + 1) * covariance.size].iter().any(|x| *x != 0.0)
    };
    if inside.iter().filter(|at| moved(at)).count() < 3 {
        return None;
    }
    let evidence =
        |(length, along): &(f64, f64)| if *length > 0.0 { along * along / length } else { 0.0 };
    let products = covariance.products().of(change, rest, true);
    let (all, left) = (evidence(&products[0]), |at: usize| evidence(&products[at + 1]));
    let at = inside.into_iter().min_by(|a, b| left(*a).total_cmp(&left(*b)))?;
    if left(at) >= ENOUGH.min(KEPT * all) {
        return None;
    }
    let expected = all * products[at + 1].0 / products[0].0;
    (left(at) < VERY_STRONG.max(EXPECTED * expected)).then(|| (at, left(at) / all))
}

/// A candidate fitted in a view.
#[derive(Debug)]
pub struct InView {
    pub fitted: Fitted,
    pub whitener: Whitener,
    /// The whitened difference of the view.
    pub z: Vec<f64>,
}

/// Fits a candidate under a mask to a view of a difference; nothing where it changes nothing there.
#[must_use]
pub fn in_view(
    covariance: &Covariance,
    view: &View,
    (candidate, mask): (&Candidate, &Mask),
    rest: &[f64],
) -> Option<InView> {
    let whitener = covariance.part(&view.sections, &view.features).whitener();
    let mut seen = candidate.clone();
    for node in seen.nodes.iter_mut().filter(|node| !node.change.is_empty()) {
        node.change = part(&mask.on(&node.change), covariance.size, view);
    }
    let moved = seen.nodes.iter().any(|node| node.change.iter().any(|x| *x != 0.0));
    let z = whitener.apply(&part(rest, covariance.size, view));
    let all = Mask { confined: None, sections: vec![true; view.sections.len()], asked_by: None };
    let fitted = Fitter::new(&whitener, std::slice::from_ref(&seen), vec![all])
        .fit(&z, 0, 0)
        .filter(|_| moved)?;
    Some(InView { fitted, whitener, z })
}

/// The size in a view as a share of the size of the joint fit, and its standard error. The fit
/// follows the path of the candidate, since the change need not be linear in the size. The error is
/// that of the slope at the view's size or, if larger, that of the likelihood ratio between the
/// joint size and the view's size.
fn size_seen(
    covariance: &Covariance,
    view: &View,
    candidate: &Candidate,
    mask: &Mask,
    fit: &Fitted,
    rest: &[f64],
) -> Option<(f64, f64)> {
    let neutral = candidate.neutral().unwrap_or(0.0);
    let change = fit.change(std::slice::from_ref(candidate), std::slice::from_ref(mask));
    if candidate.discrete || !neutral.is_finite() || fit.size == neutral {
        return share_seen(covariance, view, &change, rest);
    }
    let InView { fitted, whitener, z } = in_view(covariance, view, (candidate, mask), rest)?;
    let full = fit.size - neutral;
    let (share, slope) = ((fitted.size - neutral) / full, (fitted.slope * full).abs());
    let whole = whitener.apply(&part(&change, covariance.size, view));
    let ratio = fitted.fall - (2.0 * dot(&z, &whole) - dot(&whole, &whole));
    // For an operation on the signals the slope is reliable. For a simulated path it may not be.
    let by_ratio =
        if ratio > 0.0 && !candidate.exact { (share - 1.0).abs() / ratio.sqrt() } else { 0.0 };
    (slope > 0.0).then(|| (share, by_ratio.max(1.0 / slope)))
}

/// Contradiction between the views of a family: the two that differ most, if they differ
/// significantly (Cochran's Q). `fit` is the joint fit of the candidate under the mask.
#[must_use]
pub fn contradiction(
    covariance: &Covariance,
    family: &[View],
    (candidate, mask, fit): (&Candidate, &Mask, &Fitted),
    rest: &[f64],
) -> Judged {
    use rayon::prelude::*;
    let only = Fitted { candidate: 0, mask: 0, ..fit.clone() };
    // The model error of a simulated effect extends from views that show it to views that hardly
    // show it; an operation has none.
    let whole = if candidate.exact { 0.0 } else { dot(&fit.whitened, &fit.whitened).sqrt() };
    let error_with_model = |error: f64| error.hypot((SPILL * whole * error).clamp(MODEL, SPILT));
    let each = |view: &View| size_seen(covariance, view, candidate, mask, &only, rest);
    let sizes: Vec<Option<(f64, f64)>> = family.par_iter().map(each).collect();
    let seen: Vec<(&View, f64, f64)> = family
        .iter()
        .zip(sizes)
        .filter_map(|(view, size)| size.map(|(share, error)| (view, share, error)))
        .collect();
    let good: Vec<&(&View, f64, f64)> =
        seen.iter().filter(|(_, _, error)| *error < PRECISE).collect();
    let weight: f64 = good.iter().map(|(_, _, error)| error.powi(-2)).sum();
    let mean = good.iter().map(|(_, share, error)| share * error.powi(-2)).sum::<f64>() / weight;
    let q: f64 = good
        .iter()
        .map(|(_, share, error)| ((share - mean) / error_with_model(*error)).powi(2))
        .sum();
    let by_size = |a: &&&(&View, f64, f64), b: &&&(&View, f64, f64)| a.1.total_cmp(&b.1);
    let (Ok(law), Some(low), Some(high)) = (
        ChiSquared::new(good.len().saturating_sub(1) as f64),
        good.iter().min_by(by_size),
        good.iter().max_by(by_size),
    ) else {
        return Judged::Sound;
    };
    if q < law.inverse_cdf(HETEROGENEOUS) || high.1 - low.1 < DIFFERENT {
        return Judged::Sound;
    }
    // A view that is compatible with the joint size does not contradict.
    let below = (mean - low.1) / error_with_model(low.2);
    if low.1 >= SOME || below < SURE {
        return Judged::Doubtful;
    }
    Judged::Contradicted(format!(
        "{} require {:.0} % of it, {} {:.0} %",
        high.0.says,
        100.0 * high.1,
        low.0.says,
        100.0 * low.1
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::response::candidate::Node;
    use crate::diagnose::uncertainty::response::ResponseError;

    /// Sixteen sections of one feature of unit variance. The effect changes it by 10 in the first
    /// and by 1 in each of the others, so that 15 of 115 are expected without the first.
    #[test]
    fn a_section_may_show_most_where_the_others_show_their_part() {
        let covariance = Covariance {
            diagonal: vec![1.0; 16],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 1,
            response: ResponseError::default(),
        };
        let mask = Mask { confined: None, sections: vec![true; 16], asked_by: None };
        let of = |first: f64, others: f64| [vec![first], vec![others; 15]].concat();
        let carried = |others: f64| carried(&covariance, &mask, &of(10.0, 1.0), &of(10.0, others));
        assert_eq!(carried(1.0), None);
        // (15 * 0.8)^2 / 15 = 9.6 is not very strong.
        let (section, share) = carried(0.8).expect("the first carries it");
        assert!(section == 0 && (share - 9.6 / (112.0 * 112.0 / 115.0)).abs() < 1e-12, "{share}");
        assert_eq!(carried(0.0), Some((0, 0.0)));
        // Equal sections carry it together.
        assert_eq!(super::carried(&covariance, &mask, &of(1.0, 1.0), &of(3.0, 3.0)), None);
    }

    /// Two features in each of 40 sections, each a view and of unit variance: one changes by 2 per
    /// section and shows the full effect, the other changes by 1.2 and shows none of it.
    ///
    /// By hand: lengths 12.65 and 7.59, standard errors 0.079 and 0.132, weights 160 and 57.6, so
    /// that the joint size is 0.735. An operation on the signals has an error of at most 0.15 +
    /// 0.05: 0.735 / 0.2 = 3.7 standard errors. A simulated change has in addition a tenth of the
    /// whole, 0.1 * 14.75 * 0.132 = 0.194: 0.735 / 0.235 = 3.1; with 3 and 1.2 it is 0.862 / 0.300
    /// = 2.9, which is not significant.
    #[test]
    fn a_simulated_change_may_spill_over() {
        const SECTIONS: usize = 40;
        let judged = |large: f64, exact: bool| {
            let per_section =
                |a: f64, b: f64| (0..SECTIONS).flat_map(|_| [a, b]).collect::<Vec<f64>>();
            let covariance = Covariance {
                diagonal: vec![1.0; 2 * SECTIONS],
                inside: Vec::new(),
                shared: Vec::new(),
                size: 2,
                response: ResponseError::default(),
            };
            let change = per_section(large, 1.2);
            let nodes = vec![
                Node { size: 0.0, change: Vec::new() },
                Node { size: 1.0, change: change.clone() },
            ];
            let candidate = Candidate { exact, ..Candidate::path("effect", nodes) };
            let mask = Mask { confined: None, sections: vec![true; SECTIONS], asked_by: None };
            let whitener = covariance.whitener();
            let fitter =
                Fitter::new(&whitener, std::slice::from_ref(&candidate), vec![mask.clone()]);
            let fit = fitter.fit(&change, 0, 0).expect("a path");
            let view = |feature: usize| View {
                says: format!("view {feature}"),
                sections: (0..SECTIONS).collect(),
                features: vec![feature],
            };
            contradiction(
                &covariance,
                &[view(0), view(1)],
                (&candidate, &mask, &fit),
                &per_section(large, 0.0),
            )
        };
        assert!(matches!(judged(2.0, true), Judged::Contradicted(_)));
        assert!(matches!(judged(2.0, false), Judged::Contradicted(_)));
        assert!(matches!(judged(3.0, true), Judged::Contradicted(_)));
        assert_eq!(judged(3.0, false), Judged::Doubtful);
    }
}
