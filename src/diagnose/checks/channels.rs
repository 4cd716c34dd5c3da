//! What is left by channel: chi-squared of the residual beyond the allowed difference.

use crate::diagnose::levels::channels::{FAR_BEYOND, LACK, MOST_LEFT, ONE_IN};
use crate::diagnose::linearise::whiten::Covariance;
use crate::diagnose::observe::{layout::Kind, observations::Observations};

/// A part of the data that is fitted separately: some features of some sections.
#[derive(Clone, Debug)]
pub struct View {
    pub sections: Vec<usize>,
    pub features: Vec<usize>,
}

impl Covariance {
    /// The covariance of some features of some sections. A section listed twice counts as two
    /// independent sections.
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
pub fn part(column: &[f64], size: usize, view: &View) -> Vec<f64> {
    view.sections
        .iter()
        .flat_map(|section| {
            view.features.iter().map(move |feature| column[section * size + feature])
        })
        .collect()
}

/// Lack of fit of a channel, in its levels or in all other features.
#[derive(Clone, Debug)]
pub struct Lack {
    pub channel: String,
    pub kind: Kind,
    /// Standardised: standard deviations of chi-squared.
    pub sigma: f64,
    /// Chi-squared less its expectation.
    pub excess: f64,
    /// Outlying sections, which are excluded.
    pub alone: Vec<usize>,
    /// Standard deviations with the outlying sections included.
    pub sigma_with_them: f64,
}

/// Lack of fit by channel, separately for levels and all other features.
pub fn lack_of_fit(covariance: &Covariance, seen: &Observations, rest: &[f64]) -> Vec<Lack> {
    use rayon::prelude::*;
    let all: Vec<usize> = seen.first_runs();
    let mut views = Vec::new();
    for (channel, of) in seen.layout.channels.iter().enumerate() {
        for level in [true, false] {
            let keep = |kind: Kind| (kind == Kind::Level) == level;
            let features: Vec<usize> = seen
                .features
                .iter()
                .enumerate()
                .filter(|(_, f)| f.channel == channel && keep(f.kind))
                .map(|(at, _)| at)
                .collect();
            if !features.is_empty() {
                let kind = if level { Kind::Level } else { Kind::Band(0) };
                views.push((of.name.clone(), kind, View { sections: all.clone(), features }));
            }
        }
    }
    let each = |(channel, kind, mut view): (String, Kind, View)| {
        let count = |view: &View| (view.sections.len() * view.features.len()) as f64;
        let beyond = |chi: f64, n: f64| (chi - n) / (2.0 * n).sqrt();
        let all = count(&view);
        let (with_them, chi, alone) = without_those_alone(covariance, &mut view, rest);
        let n = count(&view);
        Lack {
            channel,
            kind,
            sigma: beyond(chi, n),
            excess: chi - n,
            alone,
            sigma_with_them: beyond(with_them, all),
        }
    };
    views.into_par_iter().map(each).collect()
}

/// Chi-squared of a view with and without outlying sections, and these. A section is outlying if
/// its conditional chi-squared given the others exceeds [`LACK`] standard deviations. The sections
/// are removed from the view.
fn without_those_alone(
    covariance: &Covariance,
    view: &mut View,
    rest: &[f64],
) -> (f64, f64, Vec<usize>) {
    let own = view.features.len();
    let most = view.sections.len() / ONE_IN;
    let (mut first, mut alone) = (None, Vec::new());
    loop {
        let features = &view.features;
        let every = view
            .sections
            .iter()
            .flat_map(|section| features.iter().map(move |feature| (*section, *feature)));
        let among = covariance.among(&every.collect::<Vec<_>>());
        let rest = part(rest, covariance.size, view);
        let whole = among.chi_squared(&rest);
        let with_them = *first.get_or_insert(whole);
        let others = if alone.len() < most { among.without_each(&rest, own) } else { Vec::new() };
        let least = others.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        match least {
            Some((at, left)) if whole - left > own as f64 + LACK * (2.0 * own as f64).sqrt() => {
                alone.push(view.sections.remove(at))
            }
            _ => return (with_them, whole, alone),
        }
    }
}

/// Excess of chi-squared over all channels.
pub fn excess(lack: &[Lack]) -> f64 {
    lack.iter().map(|lack| lack.excess.max(0.0)).sum()
}

/// The share of the excess that remains, and whether the gap is unexplained: more than half
/// remains, in more than one kind of feature or channel or far beyond the threshold. One of some
/// forty may exceed the threshold by a little.
pub fn unexplained(before: &[Lack], after: &[Lack]) -> (f64, bool) {
    let (gap, rest) = (excess(before), excess(after));
    let share = if gap > 0.0 { (rest / gap).clamp(0.0, 1.0) } else { 0.0 };
    let beyond: Vec<f64> =
        after.iter().map(|lack| lack.sigma).filter(|sigma| *sigma > LACK).collect();
    (
        share,
        share > MOST_LEFT
            && (beyond.len() > 1 || beyond.iter().any(|sigma| *sigma > FAR_BEYOND * LACK)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::linearise::response::ResponseError;

    /// Sixteen sections of nine features of unit variance; a difference of 10 in each feature gives
    /// a chi-squared of 900.
    #[test]
    fn two_of_sixteen_sections_may_stand_out_alone() {
        let covariance = Covariance {
            diagonal: vec![1.0; 16 * 9],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 9,
            response: ResponseError::default(),
        };
        let lack = |off: &[usize]| {
            let rest: Vec<f64> =
                (0..16 * 9).map(|at| if off.contains(&(at / 9)) { 10.0 } else { 0.0 }).collect();
            let mut view = View { sections: (0..16).collect(), features: (0..9).collect() };
            without_those_alone(&covariance, &mut view, &rest)
        };
        assert_eq!(lack(&[]), (0.0, 0.0, vec![]));
        assert_eq!(lack(&[3]), (900.0, 0.0, vec![3]));
        let (with_them, chi, alone) = lack(&[3, 7, 11]);
        assert_eq!((with_them, chi, alone.len()), (2700.0, 900.0, 2));
    }
}
