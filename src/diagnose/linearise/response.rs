//! The model error of a simulated response: a relative error of the change that an effect causes.
//!
//! The simulated change `d` of the features with an effect is not exact. Its error is `e_g d` on
//! each group `g` of features, with independent relative errors `e_g`. Features of a kind
//! (quasi-static values, dynamic content, gains and lags) have one error in common over the whole
//! campaign; each group of channels has a further one, and each group of channels in each stratum.
//! An operation on the signals has no such error in the fit.

use crate::diagnose::observe::{layout::Kind, observations::Observations, strata::strata};
use crate::diagnose::settings::{Response, Settings};

/// Features with a common relative error.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    /// Numbers of the features in a section, and of the sections.
    features: Vec<usize>,
    sections: Vec<usize>,
    sd: f64,
}

/// The relative error of a simulated response.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResponseError {
    parts: Vec<Part>,
    /// A further relative error of each feature by itself, for the test of what is left.
    pub each: f64,
    /// A further relative error common to all features, for the interval of a size.
    pub common: f64,
}

impl ResponseError {
    /// For the features and strata of a campaign.
    pub fn new(seen: &Observations, settings: &Settings) -> Self {
        let all: Vec<usize> = (0..seen.sections.len()).collect();
        let strata = strata(seen, settings);
        let mut groups: Vec<usize> =
            seen.layout.channels.iter().map(|channel| channel.group).collect();
        groups.sort_unstable();
        groups.dedup();
        let Response { levels, others, groups: further, common: of_all } = settings.response;
        let mut parts = Vec::new();
        let of = |kept: &dyn Fn(Kind) -> bool, group: Option<usize>| -> Vec<usize> {
            let inside = |channel: usize| {
                group.is_none_or(|group| seen.layout.channels[channel].group == group)
            };
            let features = seen.features.iter().enumerate();
            let features = features.filter(|(_, of)| kept(of.kind) && inside(of.channel));
            features.map(|(at, _)| at).collect()
        };
        let level = |kind| kind == Kind::Level;
        let band = |kind| matches!(kind, Kind::Band(_) | Kind::Increment(_));
        let every = |features, sd| Part { features, sections: all.clone(), sd };
        parts.push(every(of(&level, None), levels));
        parts.push(every(of(&band, None), others));
        parts.push(every(of(&|kind| !level(kind) && !band(kind), None), others));
        for (is_level, group) in
            [true, false].into_iter().flat_map(|is| groups.iter().map(move |group| (is, *group)))
        {
            let features = of(&|kind| level(kind) == is_level, Some(group));
            parts.push(every(features.clone(), further));
            parts.extend(strata.iter().map(|of| Part {
                features: features.clone(),
                sections: of.clone(),
                sd: further,
            }));
        }
        parts.retain(|part| !part.features.is_empty() && !part.sections.is_empty());
        Self { parts, each: others, common: of_all }
    }

    /// One error common to the features in each list, for tests.
    #[cfg(test)]
    pub fn of(parts: &[(&[usize], f64)], sections: usize) -> Self {
        let part = |(features, sd): &(&[usize], f64)| Part {
            features: features.to_vec(),
            sections: (0..sections).collect(),
            sd: *sd,
        };
        Self { parts: parts.iter().map(part).collect(), each: 0.0, common: 0.0 }
    }

    /// Columns of the covariance for the change of all features, `size` of them per section.
    pub fn columns(&self, change: &[f64], size: usize) -> Vec<Vec<f64>> {
        let column = |part: &Part| {
            let mut column = vec![0.0; change.len()];
            for place in part.sections.iter().flat_map(|section| {
                part.features.iter().map(move |feature| section * size + feature)
            }) {
                column[place] = part.sd * change[place];
            }
            column
        };
        self.parts.iter().map(column).filter(|column| column.iter().any(|x| *x != 0.0)).collect()
    }

    /// For some features of some sections.
    pub fn part(&self, sections: &[usize], features: &[usize]) -> Self {
        let places = |of: &[usize], kept: &[usize]| -> Vec<usize> {
            kept.iter().enumerate().filter(|(_, old)| of.contains(old)).map(|(at, _)| at).collect()
        };
        let part = |part: &Part| Part {
            features: places(&part.features, features),
            sections: places(&part.sections, sections),
            sd: part.sd,
        };
        let mut parts: Vec<Part> = self.parts.iter().map(part).collect();
        parts.retain(|part| !part.features.is_empty() && !part.sections.is_empty());
        Self { parts, each: self.each, common: self.common }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two sections of three features; the first two have an error of 0.1 in common.
    #[test]
    fn an_error_is_a_share_of_the_change_of_its_features() {
        let error = ResponseError::of(&[(&[0, 1], 0.1), (&[2], 0.5)], 2);
        let columns = error.columns(&[10.0, 0.0, 4.0, -20.0, 5.0, 0.0], 3);
        assert_eq!(columns, [[1.0, 0.0, 0.0, -2.0, 0.5, 0.0], [0.0, 0.0, 2.0, 0.0, 0.0, 0.0]]);
        // The second section alone, with its last two features.
        assert_eq!(error.part(&[1], &[1, 2]).columns(&[5.0, 2.0], 2), [[0.5, 0.0], [0.0, 1.0]]);
        assert!(ResponseError::default().columns(&[1.0], 1).is_empty());
    }
}
