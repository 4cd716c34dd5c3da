//! Cells of quantity, position, band and sections, in which the gap is tested.

use crate::diagnose::levels::cells::FALSE_DISCOVERIES;
use crate::diagnose::observe::layout::Kind;
use crate::diagnose::run::Found;
use crate::diagnose::settings::{Position, Settings};
use crate::simulate::Units;

/// Features of one group of channels and one kind, at one position, in some sections.
#[derive(Debug)]
pub struct Cell {
    pub group: usize,
    pub position: String,
    pub sections: Vec<usize>,
    pub kind: Kind,
    /// Features, by section and number.
    pub members: Vec<(usize, usize)>,
}

impl Cell {
    /// Its channels, in order of first occurrence.
    pub fn signals(&self, found: &Found) -> Vec<String> {
        let mut signals: Vec<String> = Vec::new();
        for (_, feature) in &self.members {
            let name = &found.seen.layout.channels[found.seen.features[*feature].channel].name;
            if !signals.contains(name) {
                signals.push(name.clone());
            }
        }
        signals
    }

    /// The unit of its differences: that of the first channel for levels, `-` for ratios.
    pub fn unit(&self, found: &Found, units: &Units) -> String {
        let signals = self.signals(found);
        let unit = units
            .iter()
            .find(|(name, _)| self.kind == Kind::Level && Some(name) == signals.first());
        unit.map_or_else(|| "-".into(), |(_, unit)| unit.text.clone())
    }

    /// The kind of feature, in words.
    pub fn band(&self, found: &Found) -> String {
        let edges = &found.seen.layout.edges;
        match self.kind {
            Kind::Level => "quasi-static".into(),
            Kind::Band(band) => format!("{} to {} Hz", edges[band], edges[band + 1]),
            Kind::Gain => "alike".into(),
            Kind::Lag => "lag".into(),
            Kind::Increment(_) => "sample by sample".into(),
        }
    }
}

/// Positions of the catalogue; if it has none, one position with all channels.
pub fn positions(settings: &Settings) -> Vec<Position> {
    let every = || Position { name: "all".into(), straight: Vec::new(), mirrored: Vec::new() };
    if settings.positions.is_empty() { vec![every()] } else { settings.positions.clone() }
}

/// Levels and every band.
pub fn kinds(found: &Found) -> impl Iterator<Item = Kind> {
    std::iter::once(Kind::Level)
        .chain((0..found.seen.layout.edges.len().saturating_sub(1)).map(Kind::Band))
}

/// The non-empty cells of one kind and position, for each group of channels and each set of
/// sections.
pub fn cells(
    settings: &Settings,
    found: &Found,
    kind: Kind,
    position: &Position,
    among: &[Vec<usize>],
) -> Vec<Cell> {
    let everywhere = position.straight.is_empty() && position.mirrored.is_empty();
    let members = |group: usize, at: usize| {
        let section = &found.seen.sections[at].section;
        let mirrored = settings
            .mirror
            .as_ref()
            .is_some_and(|(column, value)| section.fact(column) == Some(value));
        let names = if mirrored { &position.mirrored } else { &position.straight };
        let here = move |(_, feature): &(usize, &crate::diagnose::observe::layout::Feature)| {
            let channel = &found.seen.layout.channels[feature.channel];
            feature.kind == kind
                && channel.group == group
                && (everywhere || names.contains(&channel.name))
        };
        found.seen.features.iter().enumerate().filter(here).map(move |(number, _)| (at, number))
    };
    let cell = |group: usize, sections: &Vec<usize>| Cell {
        group,
        position: position.name.clone(),
        sections: sections.clone(),
        kind,
        members: sections.iter().flat_map(|at| members(group, *at)).collect(),
    };
    let all = (0..settings.groups.len())
        .flat_map(|group| among.iter().map(move |sections| (group, sections)));
    all.map(|(group, sections)| cell(group, sections))
        .filter(|cell| !cell.members.is_empty())
        .collect()
}

/// The largest p-value that is significant (Benjamini and Yekutieli 2001: valid under any
/// dependence); below zero if none is.
pub fn significant_up_to(probabilities: &[f64]) -> f64 {
    let mut order = probabilities.to_vec();
    order.sort_by(f64::total_cmp);
    let count = order.len() as f64;
    let harmonic: f64 = (1..=order.len()).map(|i| 1.0 / i as f64).sum();
    let passes =
        |(rank, p): &(usize, f64)| *p <= FALSE_DISCOVERIES * (rank + 1) as f64 / (count * harmonic);
    order.into_iter().enumerate().rev().find(passes).map_or(-1.0, |(_, p)| p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::linearise::response::ResponseError;
    use crate::diagnose::linearise::whiten::Covariance;

    /// Two of four features, with the covariance written out: C = [[1 + 0.25 + 1, 0.5], [0.5, 3 +
    /// 0.25]].
    #[test]
    fn what_is_not_named_counts_nothing() {
        let covariance = Covariance {
            diagonal: vec![1.0, 2.0, 0.5, 3.0],
            inside: vec![(0, vec![0.5, -1.0])],
            shared: vec![vec![1.0, 0.0, 1.0, 0.5]],
            size: 2,
            response: ResponseError::default(),
        };
        let (a, b, c) = (1.0 + 0.25 + 1.0, 0.5, 3.0 + 0.25);
        let (x, y) = (1.0, -2.0);
        let by_hand = (c * x * x - 2.0 * b * x * y + a * y * y) / (a * c - b * b);
        let among = covariance.among(&[(0, 0), (1, 1)]);
        assert!((among.chi_squared(&[x, y]) - by_hand).abs() < 1e-12);
    }

    /// Unit variance and a common offset: the slope is that of ordinary least squares, 0.5 with the
    /// error 1 / sqrt(5), since the offset is a free parameter of the fit.
    #[test]
    fn slope_of_a_line() {
        let covariance = Covariance {
            diagonal: vec![1.0; 4],
            inside: Vec::new(),
            shared: vec![vec![2.0; 4]],
            size: 1,
            response: ResponseError::default(),
        };
        let (slope, error) = covariance
            .among(&[(0, 0), (1, 0), (2, 0), (3, 0)])
            .slope([&[1.0; 4], &[0.0, 1.0, 2.0, 3.0]], &[3.0, 3.6, 4.2, 4.5])
            .expect("the columns differ");
        // sum (x - 1.5) y / sum (x - 1.5)^2 = (-1.5 * 3 - 0.5 * 3.6 + 0.5 * 4.2 + 1.5 * 4.5) / 5.
        assert!((slope - 0.51).abs() < 1e-9 && (error - 0.2_f64.sqrt()).abs() < 1e-9);
    }

    /// Ten p-values with the limits 0.05 k / (10 * 2.929): 0.0017, 0.0034, 0.0051.
    #[test]
    fn false_discoveries_are_kept_rare() {
        let mut p = vec![0.5; 10];
        assert!(significant_up_to(&p) < 0.0);
        p[4] = 0.0016;
        assert!((significant_up_to(&p) - 0.0016).abs() < 1e-15);
        (p[5], p[6]) = (0.0036, 0.0050);
        assert!((significant_up_to(&p) - 0.0050).abs() < 1e-15);
    }
}
