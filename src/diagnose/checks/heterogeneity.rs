//! The test of heterogeneity: whether the size of a member is the same in all views of the data.
//!
//! The residual is regressed on the change of the member split by view, in the metric of the fit
//! (a score test). One test for kinds of features, groups of channels, positions and sides, strata,
//! directions and covariates such as the order of the sections: it finds drifts, one-sided causes,
//! and effects that another one imitates.

use nalgebra::{Cholesky, DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::diagnose::fit::{fitter::Fitter, joint::metric, set::Chosen};
use crate::diagnose::levels::heterogeneity::{CHANCE, SEEN};
use crate::diagnose::linearise::whiten::dot;
use crate::diagnose::observe::{
    covariates::{Covariate, DIRECTION, covariates},
    layout::Kind,
    observations::Observations,
    strata::stratum_of,
};
use crate::diagnose::settings::Settings;

/// A division of the features: a label for each feature of each section; none where it is left out.
#[derive(Debug)]
pub struct View {
    pub name: String,
    labels: Vec<Option<String>>,
}

/// Deviations of a member's size between the parts of a view, as shares of its change.
#[derive(Clone, Debug)]
pub struct Heterogeneity {
    /// Number of the member.
    pub member: usize,
    pub view: String,
    /// Part, deviation from the common size, standard error.
    pub parts: Vec<(String, f64, f64)>,
    /// Probability of the data if the size is the same in all parts.
    pub p_value: f64,
}

/// The views of a campaign.
pub fn views(seen: &Observations, settings: &Settings) -> Vec<View> {
    let count = seen.sections.len();
    let view = |name: &str, label: &dyn Fn(usize, usize) -> Option<String>| View {
        name: name.into(),
        labels: (0..count)
            .flat_map(|section| (0..seen.features.len()).map(move |feature| (section, feature)))
            .map(|(section, feature)| label(section, feature))
            .collect(),
    };
    let channel = |feature: usize| &seen.layout.channels[seen.features[feature].channel];
    let middle = seen.layout.edges.len() / 2;
    let kind = |_: usize, feature: usize| match seen.features[feature].kind {
        Kind::Level => Some("quasi-static values".to_string()),
        Kind::Band(band) if band < middle => Some("low bands".into()),
        Kind::Band(_) => Some("high bands".into()),
        Kind::Gain | Kind::Increment(_) => Some("gains".into()),
        Kind::Lag => None,
    };
    let group =
        |_: usize, feature: usize| Some(settings.groups[channel(feature).group].says.clone());
    let fact = |section: usize, column: &str| {
        seen.sections[section].section.fact(column).map(str::to_owned)
    };
    let mirrored = |section: usize| {
        let of = settings.mirror.as_ref();
        of.is_some_and(|(column, value)| fact(section, column).as_ref() == Some(value))
    };
    let position = |section: usize, feature: usize| {
        let here = settings.positions.iter().find(|position| {
            let names = if mirrored(section) { &position.mirrored } else { &position.straight };
            names.contains(&channel(feature).name)
        });
        here.map(|position| position.name.clone())
    };
    // One side of the vehicle: the channels of a position that exchange with those of another one.
    let side = |_: usize, feature: usize| {
        let name = &channel(feature).name;
        let pairs = settings
            .positions
            .iter()
            .flat_map(|position| position.straight.iter().zip(&position.mirrored));
        let (here, there) = pairs.clone().find(|(here, there)| *here == name && here != there)?;
        let first =
            pairs.clone().find(|(a, b)| (*a, *b) == (here, there) || (*a, *b) == (there, here))?;
        Some(if first.0 == name { "one side" } else { "the other side" }.to_string())
    };
    let stratum = |section: usize, _: usize| {
        settings.stratum.as_ref()?;
        Some(stratum_of(seen, settings, section).to_string())
    };
    let direction = |section: usize, _: usize| {
        let (column, _) = settings.mirror.as_ref()?;
        fact(section, column)
    };
    let covariates = covariates(settings, seen);
    let thirds = |covariate: &Covariate| {
        let [least, most] = &covariate.ends;
        let part = |section: usize, _: usize| {
            Some(match (3.0 * covariate.values[section]) as usize {
                0 => format!("sections near {least}"),
                1 => "sections between".to_string(),
                _ => format!("sections near {most}"),
            })
        };
        view(&covariate.name, &part)
    };
    let stratum_name = settings.stratum.clone().unwrap_or_default();
    let direction_name = settings.mirror.as_ref().map_or_else(String::new, |of| of.0.clone());
    let mut all = vec![
        view("kind of feature", &kind),
        view("group of channels", &group),
        view("position", &position),
        view("side of the vehicle", &side),
        view(&stratum_name, &stratum),
        view(&direction_name, &direction),
    ];
    all.extend(covariates.iter().filter(|of| of.name != DIRECTION).map(thirds));
    all.retain(|view| !view.name.is_empty());
    // Lags jump where a vehicle sways, and a section that repeats another one says nothing new.
    for (at, section) in (0..count).flat_map(|section| {
        (0..seen.features.len())
            .map(move |feature| (section * seen.features.len() + feature, section))
    }) {
        let lag = seen.features[at % seen.features.len()].kind == Kind::Lag;
        if lag || seen.sections[section].again {
            all.iter_mut().for_each(|view| view.labels[at] = None);
        }
    }
    all
}

/// Tests every member over every view.
pub fn heterogeneity(fitter: &Fitter<'_>, chosen: &Chosen, views: &[View]) -> Vec<Heterogeneity> {
    use rayon::prelude::*;
    // An exact operation has an error too: the records that it acts on are not those of the
    // vehicle.
    let columns: Vec<DMatrix<f64>> = chosen
        .all()
        .map(|member| {
            let at = (member.candidate, member.mask);
            fitter.error_of_any(at, (member.segment, member.share))
        })
        .collect();
    let metric = metric(fitter.whitener.features(), &columns);
    let rest = DVector::from(metric.apply(&chosen.rest));
    let whiten = |change: &[f64]| metric.apply(&fitter.whitener.apply(change));
    // An exchange or an inversion has no size that could vary.
    let sized = |member: &usize| !fitter.candidates[chosen.members[*member].candidate].discrete;
    let pairs: Vec<(usize, &View)> = (0..chosen.members.len())
        .filter(sized)
        .flat_map(|member| views.iter().map(move |view| (member, view)))
        .collect();
    pairs
        .into_par_iter()
        .filter_map(|(member, view)| {
            let fit = &chosen.members[member];
            let change = fit.change(fitter.candidates, &fitter.masks);
            test(member, &change, view, &whiten, &rest)
        })
        .collect()
}

fn test(
    member: usize,
    change: &[f64],
    view: &View,
    whiten: &dyn Fn(&[f64]) -> Vec<f64>,
    rest: &DVector<f64>,
) -> Option<Heterogeneity> {
    let mut names: Vec<&String> = view.labels.iter().flatten().collect();
    names.sort();
    names.dedup();
    let part = |name: &String| -> Vec<f64> {
        let inside = |(label, change): (&Option<String>, &f64)| {
            if label.as_ref() == Some(name) { *change } else { 0.0 }
        };
        view.labels.iter().zip(change).map(inside).collect()
    };
    let parts: Vec<(&String, Vec<f64>)> = names
        .into_iter()
        .map(|name| (name, whiten(&part(name))))
        .filter(|(_, part)| dot(part, part) > SEEN * SEEN)
        .collect();
    if parts.len() < 2 {
        return None;
    }
    let columns: Vec<DVector<f64>> =
        parts.iter().map(|(_, part)| DVector::from_column_slice(part)).collect();
    let columns = DMatrix::from_columns(&columns);
    let gram = Cholesky::new_with_substitute(columns.tr_mul(&columns), 1e-12)?;
    let along = columns.tr_mul(rest);
    let deviation = gram.solve(&along);
    let covariance = gram.inverse();
    let law = ChiSquared::new((parts.len() - 1) as f64).ok()?;
    let told = |(at, (name, _)): (usize, &(&String, Vec<f64>))| {
        ((*name).clone(), deviation[at], covariance[(at, at)].max(0.0).sqrt())
    };
    Some(Heterogeneity {
        member,
        view: view.name.clone(),
        parts: parts.iter().enumerate().map(told).collect(),
        p_value: law.sf(along.dot(&deviation)),
    })
}

/// The test with the smallest p-value, if it is significant among all tests (Bonferroni).
pub fn certain(all: &[Heterogeneity]) -> Option<&Heterogeneity> {
    let least = all.iter().min_by(|a, b| a.p_value.total_cmp(&b.p_value))?;
    (least.p_value * (all.len() as f64) < CHANCE).then_some(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two parts of four features of unit variance each, changed by 2 per unit. Left are 0.5 in the
    /// first and -0.5 in the second part: deviations of 0.25 and -0.25 with the standard error
    /// 1 / (4 * 2^2)^1/2 = 0.25, chi-squared 2 with one degree of freedom.
    #[test]
    fn sizes_that_differ_between_parts_are_told() {
        let label = |at: usize| Some(if at < 4 { "one" } else { "other" }.to_string());
        let view = View { name: "view".into(), labels: (0..8).map(label).collect() };
        let rest: Vec<f64> = (0..8).map(|at| if at < 4 { 0.5 } else { -0.5 }).collect();
        let of = |view: &View, rest: &[f64]| {
            test(0, &[2.0; 8], view, &|change| change.to_vec(), &DVector::from_column_slice(rest))
        };
        let found = of(&view, &rest).expect("two parts");
        for ((name, share, error), (wanted, deviation)) in
            found.parts.iter().zip([("one", 0.25), ("other", -0.25)])
        {
            assert_eq!(name, wanted);
            assert!((share - deviation).abs() < 1e-12 && (error - 0.25).abs() < 1e-12);
        }
        // The upper tail of chi-squared with one degree of freedom at 2 is erfc(1) = 0.157299.
        assert!((found.p_value - 0.157_299).abs() < 1e-6, "{}", found.p_value);
        assert!(certain(&[found]).is_none());
        let strong: Vec<f64> = rest.iter().map(|rest| 10.0 * rest).collect();
        assert!(certain(&[of(&view, &strong).expect("two parts")]).is_some());
        // A single part says nothing, and features without a label are left out.
        let alone =
            View { labels: (0..8).map(|at| (at < 4).then(|| "one".into())).collect(), ..view };
        assert!(of(&alone, &rest).is_none());
    }
}
