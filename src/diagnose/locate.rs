//! Where the gap lies: cells of quantity, position, stratum and band, tested against noise, declared tolerances and what a model of
//! this kind is allowed to be wrong in.

use super::features::Kind;
use super::guards::{View, part};
use super::lack::left;
use super::run::Found;
use super::settings::{Position, Settings};
use crate::result::diagnosis::Where;
use crate::simulate::Units;

/// Share of false cells among those called significant.
const FALSE_DISCOVERIES: f64 = 0.05;

struct Cell {
    group: usize,
    position: String,
    stratum: String,
    sections: Vec<usize>,
    kind: Kind,
    /// Feature by section and number.
    members: Vec<(usize, usize)>,
}

/// All cells, the largest share of the gap first.
#[must_use]
pub fn locate(settings: &Settings, found: &Found, units: &Units) -> Vec<Where> {
    use rayon::prelude::*;
    let cells = cells(settings, found);
    let tested: Vec<(f64, f64, f64)> = cells.par_iter().map(|cell| test(found, cell)).collect();
    let total: f64 = tested.iter().map(|(excess, ..)| excess.max(0.0)).sum::<f64>().max(1e-300);
    // Benjamini and Yekutieli (2001): valid whatever depends on what.
    let mut order: Vec<usize> = (0..cells.len()).collect();
    order.sort_by(|a, b| tested[*a].1.total_cmp(&tested[*b].1));
    let harmonic: f64 = (1..=cells.len()).map(|i| 1.0 / i as f64).sum();
    let passed = order
        .iter()
        .enumerate()
        .rev()
        .find(|(rank, at)| tested[**at].1 <= FALSE_DISCOVERIES * (rank + 1) as f64 / (cells.len() as f64 * harmonic));
    let limit = passed.map_or(-1.0, |(_, at)| tested[*at].1);
    let mut found_cells: Vec<Where> = cells
        .iter()
        .zip(&tested)
        .map(|(cell, (excess, p_value, mean))| {
            let group = &settings.groups[cell.group];
            let band = band(found, cell.kind);
            let mut signals: Vec<String> = Vec::new();
            for (_, feature) in &cell.members {
                let name = &found.seen.layout.channels[found.seen.features[*feature].channel].name;
                if !signals.contains(name) {
                    signals.push(name.clone());
                }
            }
            let named: Vec<String> = cell.sections.iter().map(|at| found.seen.sections[*at].section.name().to_string()).collect();
            let stratum = settings.stratum.as_deref().unwrap_or("all");
            let unit =
                units.iter().find(|(name, _)| Some(name) == signals.first()).map_or_else(|| "-".into(), |(_, unit)| unit.text.clone());
            Where {
                quantity: group.says.clone(),
                says: format!("{}, {}, {band}, {stratum} {}", group.says, cell.position, cell.stratum),
                signals,
                zones: vec![cell.stratum.clone()],
                sections: named,
                wavelength_or_band: band,
                difference: if cell.kind == Kind::Level { *mean } else { mean.exp() - 1.0 },
                unit: if cell.kind == Kind::Level { unit } else { "-".into() },
                share_of_gap: excess.max(0.0) / total,
                p_value: *p_value,
                significant: *p_value <= limit,
            }
        })
        .collect();
    found_cells
        .sort_by(|a, b| (b.significant, b.share_of_gap).partial_cmp(&(a.significant, a.share_of_gap)).unwrap_or(std::cmp::Ordering::Equal));
    found_cells
}

fn band(found: &Found, kind: Kind) -> String {
    match kind {
        Kind::Level => "quasi-static".into(),
        Kind::Band(band) => format!("{} to {} Hz", found.seen.layout.edges[band], found.seen.layout.edges[band + 1]),
        Kind::Gain => "alike".into(),
        Kind::Lag => "lag".into(),
    }
}

fn cells(settings: &Settings, found: &Found) -> Vec<Cell> {
    let mut cells = Vec::new();
    let every = Position { name: "all".into(), straight: Vec::new(), mirrored: Vec::new() };
    let positions: Vec<&Position> = if settings.positions.is_empty() { vec![&every] } else { settings.positions.iter().collect() };
    let kinds = (0..found.seen.layout.edges.len().saturating_sub(1)).map(Kind::Band);
    for kind in std::iter::once(Kind::Level).chain(kinds) {
        for group in 0..settings.groups.len() {
            for position in &positions {
                for sections in &found.strata {
                    let mut members = Vec::new();
                    for at in sections {
                        let section = &found.seen.sections[*at].section;
                        let mirrored = settings.mirror.as_ref().is_some_and(|(column, value)| section.fact(column) == Some(value));
                        let names = if mirrored { &position.mirrored } else { &position.straight };
                        for (number, feature) in found.seen.features.iter().enumerate() {
                            let channel = &found.seen.layout.channels[feature.channel];
                            let here = names.is_empty() && positions.len() == 1 || names.contains(&channel.name);
                            if feature.kind == kind && channel.group == group && here {
                                members.push((*at, number));
                            }
                        }
                    }
                    if !members.is_empty() {
                        let first = &found.seen.sections[sections[0]].section;
                        let stratum = settings.stratum.as_deref().and_then(|column| first.fact(column)).unwrap_or("").to_string();
                        cells.push(Cell { group, position: position.name.clone(), stratum, sections: sections.clone(), kind, members });
                    }
                }
            }
        }
    }
    cells
}

/// Excess of chi-squared over what noise and tolerances give, its probability, and the mean difference.
fn test(found: &Found, cell: &Cell) -> (f64, f64, f64) {
    let mut features: Vec<usize> = cell.members.iter().map(|(_, feature)| *feature).collect();
    features.sort_unstable();
    features.dedup();
    let view = View { says: String::new(), sections: cell.sections.clone(), features: features.clone() };
    let mut rest = part(&found.difference, found.seen.features.len(), &view);
    // A position is other channels where the section is mirrored: what does not belong to the cell counts nothing.
    for (i, value) in rest.iter_mut().enumerate() {
        let place = (view.sections[i / features.len()], features[i % features.len()]);
        if !cell.members.contains(&place) {
            *value = 0.0;
        }
    }
    // Levels count towards the side of the simulated one, so that left and right curves do not cancel.
    let oriented = |section: usize, feature: usize| {
        let place = found.seen.place(section, feature);
        let side = if cell.kind == Kind::Level { found.simulated[place].signum() } else { 1.0 };
        side * found.difference[place]
    };
    let mean = cell.members.iter().map(|(section, feature)| oriented(*section, *feature)).sum::<f64>() / cell.members.len() as f64;
    let (chi, _) = found.covariance.part(&view.sections, &features).products().of(&rest, &rest, false)[0];
    let freedom = cell.members.len() as f64;
    let p = statrs::distribution::ChiSquared::new(freedom).map_or(1.0, |law| statrs::distribution::ContinuousCDF::sf(&law, chi));
    (chi - freedom, p, mean)
}

/// Before the name of a column whose reciprocal is meant.
const INVERSE: &str = "1 / ";

/// Which number of the section table what is left grows with, in words; nothing if with none.
#[must_use]
pub fn covariate(settings: &Settings, found: &Found) -> Option<String> {
    let worst = found.lack_after.iter().filter(|lack| lack.kind == Kind::Level).max_by(|a, b| a.sigma.total_cmp(&b.sigma))?;
    let channel = found.seen.layout.channels.iter().position(|channel| channel.name == worst.channel)?;
    let feature = found.seen.find(channel, Kind::Level)?;
    let rest = left(&found.candidates, &found.masks, &found.difference, &found.chosen);
    let values: Vec<f64> = (0..found.seen.sections.len()).map(|at| rest[found.seen.place(at, feature)]).collect();
    let order: Vec<f64> = (0..values.len()).map(|at| at as f64 + 1.0).collect();
    let mut named: Vec<(String, Vec<f64>)> = vec![("the order of the sections".into(), order)];
    let sides: Vec<f64> = found.seen.sections.iter().map(|observed| settings.side(&observed.section)).collect();
    if sides.iter().any(|side| *side != 0.0) {
        named.push(("the direction of the curve".into(), sides));
    }
    for covariate in &settings.covariates {
        let column = covariate.strip_prefix(INVERSE).unwrap_or(covariate);
        let inverse = column.len() < covariate.len();
        let numbers = found.seen.sections.iter().map(|observed| {
            let number = observed.section.number(column);
            // What has no radius is straight.
            if inverse { Some(number.map_or(0.0, |number| 1.0 / number)) } else { number }
        });
        if let Some(numbers) = numbers.collect::<Option<Vec<f64>>>() {
            named.push((covariate.clone(), numbers));
        }
    }
    let best = named.into_iter().map(|(name, x)| (name, correlation(&x, &values))).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    (best.1.abs() > 0.7).then(|| format!("What is left in {} follows {} (correlation {:.2}).", worst.channel, best.0, best.1))
}

fn correlation(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sum = |f: &dyn Fn(f64, f64) -> f64| x.iter().zip(y).map(|(x, y)| f(x - mx, y - my)).sum::<f64>();
    let (xy, xx, yy) = (sum(&|x, y| x * y), sum(&|x, _| x * x), sum(&|_, y| y * y));
    if xx > 0.0 && yy > 0.0 { xy / (xx * yy).sqrt() } else { 0.0 }
}
