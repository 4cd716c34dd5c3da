//! Location of the gap: cells of quantity, position, stratum and band, tested against noise,
//! declared tolerances and the allowed model discrepancy.

use crate::diagnose::describe::cells::{Cell, cells, kinds, positions, significant_up_to};
use crate::diagnose::levels::locate::MOVED;
use crate::diagnose::observe::layout::Kind;
use crate::diagnose::run::Found;
use crate::diagnose::settings::Settings;
use crate::result::diagnosis::Where;
use crate::simulate::Units;

/// All cells in decreasing order of their share of the gap.
pub fn locate(settings: &Settings, found: &Found, units: &Units) -> Vec<Where> {
    use rayon::prelude::*;
    let cells = map(settings, found);
    let measured = found.seen.all(false, |observed| &observed.measured);
    let tested: Vec<Tested> = cells.par_iter().map(|cell| test(found, &measured, cell)).collect();
    let total: f64 = tested.iter().map(|test| test.excess.max(0.0)).sum::<f64>().max(1e-300);
    let limit = significant_up_to(&tested.iter().map(|test| test.p_value).collect::<Vec<f64>>());
    let place = |(cell, test): (&Cell, &Tested)| Where {
        quantity: settings.groups[cell.group].says.clone(),
        position: cell.position.clone(),
        says: says(settings, found, cell),
        signals: cell.signals(found),
        zones: vec![stratum(settings, found, cell).to_string()],
        sections: cell
            .sections
            .iter()
            .map(|at| found.seen.sections[*at].section.name().to_string())
            .collect(),
        wavelength_or_band: cell.band(found),
        frequency: match cell.kind {
            Kind::Band(band) => Some(found.seen.layout.edges[band]),
            _ => None,
        },
        difference: test.mean,
        difference_rms: test.rms,
        unit: cell.unit(found, units),
        share_of_gap: test.excess.max(0.0) / total,
        p_value: test.p_value,
        significant: test.p_value <= limit,
    };
    let mut places: Vec<Where> = cells.iter().zip(&tested).map(place).collect();
    places.sort_by(|a, b| {
        (b.significant, b.share_of_gap)
            .partial_cmp(&(a.significant, a.share_of_gap))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    places
}

/// Names of the cells that a change of the features moves by more than three standard deviations:
/// the significant cells expected for a known effect.
pub fn moved(settings: &Settings, found: &Found, change: &[f64]) -> Vec<String> {
    let far = |cell: &Cell| {
        let values: Vec<f64> = cell
            .members
            .iter()
            .map(|(section, feature)| change[found.seen.place(*section, *feature)])
            .collect();
        found.alone.covariance.among(&cell.members).chi_squared(&values) > MOVED * MOVED
    };
    map(settings, found).into_iter().filter(far).map(|cell| says(settings, found, &cell)).collect()
}

/// All cells of the map.
fn map(settings: &Settings, found: &Found) -> Vec<Cell> {
    let positions = positions(settings);
    let of_kind = |kind: Kind| {
        positions
            .iter()
            .flat_map(move |position| cells(settings, found, kind, position, &found.strata))
    };
    kinds(found).flat_map(of_kind).collect()
}

/// The common stratum of the sections of a cell.
fn stratum<'a>(settings: &Settings, found: &'a Found, cell: &Cell) -> &'a str {
    let of = |(column, at): (&str, &usize)| found.seen.sections[*at].section.fact(column);
    settings.stratum.as_deref().zip(cell.sections.first()).and_then(of).unwrap_or("")
}

fn says(settings: &Settings, found: &Found, cell: &Cell) -> String {
    let (group, column) =
        (&settings.groups[cell.group].says, settings.stratum.as_deref().unwrap_or("all"));
    format!(
        "{group}, {}, {}, {column} {}",
        cell.position,
        cell.band(found),
        stratum(settings, found, cell)
    )
}

struct Tested {
    /// Chi-squared less its expectation from noise and tolerances.
    excess: f64,
    p_value: f64,
    /// Simulated - measured: levels in their unit, bands as simulated / measured - 1.
    mean: f64,
    rms: f64,
}

/// Tests a cell. `measured` are the measured features, whose sign decides the sign convention of
/// levels.
fn test(found: &Found, measured: &[f64], cell: &Cell) -> Tested {
    let values: Vec<f64> = cell
        .members
        .iter()
        .map(|(section, feature)| found.alone.difference[found.seen.place(*section, *feature)])
        .collect();
    // `difference` is measured - simulated; reported is simulated - measured, as in the protocol. A
    // level is multiplied by the sign of the measured value, so that left and right curves do not
    // cancel.
    let side = |(section, feature): &(usize, usize)| match cell.kind {
        Kind::Level => -measured[found.seen.place(*section, *feature)].signum(),
        _ => -1.0,
    };
    let freedom = values.len() as f64;
    let mean =
        cell.members.iter().zip(&values).map(|(member, value)| side(member) * value).sum::<f64>()
            / freedom;
    // Bands are logarithms of ratios.
    let relative = |value: f64| if cell.kind == Kind::Level { value } else { value.exp() - 1.0 };
    let rms = (values.iter().map(|value| relative(-value).powi(2)).sum::<f64>() / freedom).sqrt();
    let chi = found.alone.covariance.among(&cell.members).chi_squared(&values);
    let p_value = statrs::distribution::ChiSquared::new(freedom)
        .map_or(1.0, |law| statrs::distribution::ContinuousCDF::sf(&law, chi));
    Tested { excess: chi - freedom, p_value, mean: relative(mean), rms }
}
