//! Trends of the difference: every quantity, position and band against each number of the section
//! table, the direction of the curve and the order of the sections.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::diagnose::describe::{
    cells::{Cell, cells, kinds, positions, significant_up_to},
    fold::Fold,
};
use crate::diagnose::levels::{
    common::NINETY,
    trends::{CERTAIN, TOGETHER},
};
use crate::diagnose::linearise::whiten::Covariance;
use crate::diagnose::observe::{
    covariates::{Covariate, covariates},
    layout::Kind,
};
use crate::diagnose::run::Found;
use crate::diagnose::settings::{Position, Settings};
use crate::result::{
    Statement,
    diagnosis::{Slope, Trend},
};
use crate::simulate::Units;

/// All trends in increasing order of p-value, and the correlated covariates, in words.
pub fn trends(settings: &Settings, found: &Found, units: &Units) -> (Vec<Trend>, Vec<String>) {
    use rayon::prelude::*;
    let sections = [found.seen.first_runs()];
    let covariates = covariates(settings, &found.seen);
    // Single channels are included: a drift or a fading gain belongs to one channel, whichever side
    // of the curve its wheel is on. They are not folded.
    let alone = |name: &str| Position {
        name: name.into(),
        straight: vec![name.into()],
        mirrored: vec![name.into()],
    };
    let channels = found.seen.layout.channels.iter().map(|of| (alone(&of.name), false));
    let places: Vec<(Position, bool)> =
        positions(settings).into_iter().map(|position| (position, true)).chain(channels).collect();
    let of_place = |kind: Kind, (position, turns): &(Position, bool)| {
        cells(settings, found, kind, position, &sections)
            .into_iter()
            .map(|cell| (cell, *turns))
            .collect::<Vec<(Cell, bool)>>()
    };
    let cells: Vec<(Cell, bool)> = kinds(found)
        .flat_map(|kind| places.iter().flat_map(move |place| of_place(kind, place)))
        .collect();
    let wider = found.wider();
    let rest = found.left();
    let fold = Fold::new(settings, &found.seen, &found.ground.simulated);
    let of_cell = |(cell, turns): &(Cell, bool)| {
        let sign = |(section, feature): &(usize, usize)| match turns {
            true => fold.sign(*section, found.seen.features[*feature].channel, cell.kind),
            false => 1.0,
        };
        let sides: Vec<f64> = cell.members.iter().map(sign).collect();
        let before = slopes(
            found,
            cell,
            &sides,
            &covariates,
            (&found.alone.covariance, &found.alone.difference),
        );
        let after = slopes(found, cell, &sides, &covariates, (&wider, &rest));
        let trend = |((covariate, before), after): ((&Covariate, Option<Slope>), Option<Slope>)| {
            let [from, to] = covariate.ends.clone();
            Some(Trend {
                quantity: settings.groups[cell.group].says.clone(),
                position: cell.position.clone(),
                signals: cell.signals(found),
                wavelength_or_band: cell.band(found),
                covariate: covariate.name.clone(),
                from,
                to,
                from_without_unit: covariate.from.clone(),
                unit: cell.unit(found, units),
                before: before?,
                after: after?,
            })
        };
        covariates.iter().zip(before).zip(after).filter_map(trend).collect::<Vec<Trend>>()
    };
    let mut trends: Vec<Trend> = cells.par_iter().flat_map(of_cell).collect();
    let limit = |of: &dyn Fn(&Trend) -> f64| {
        significant_up_to(&trends.iter().map(of).collect::<Vec<f64>>())
    };
    let (before, after) =
        (limit(&|trend| trend.before.p_value), limit(&|trend| trend.after.p_value));
    for trend in &mut trends {
        trend.before.significant = trend.before.p_value <= before;
        trend.after.significant = trend.after.p_value <= after;
    }
    trends.sort_by(|a, b| a.before.p_value.total_cmp(&b.before.p_value));
    (trends, together(&covariates, &sections[0]))
}

/// Whether a trend of the residual is certain.
pub fn certain(trends: &[Trend]) -> bool {
    let tested = trends.len() as f64;
    trends.iter().any(|trend| trend.after.p_value * tested < CERTAIN)
}

/// The trend with the smallest p-value with the causes added, if it is significant.
pub fn worth_a_word(trends: &[Trend]) -> Option<Statement> {
    let trend = trends
        .iter()
        .filter(|trend| trend.after.significant)
        .min_by(|a, b| a.after.p_value.total_cmp(&b.after.p_value))?
        .clone();
    Some(Statement::DependsOn {
        quantity: trend.quantity,
        position: trend.position,
        band: trend.wavelength_or_band,
        covariate: trend.covariate,
        change: trend.after.change,
        unit: trend.unit,
        from: trend.from,
        to: trend.to,
        correlation: trend.after.correlation,
    })
}

/// A change in the unit of its trend.
pub fn change(trend: &Trend, change: f64) -> String {
    if trend.unit == "-" {
        format!("{:.0} %", 100.0 * change)
    } else {
        format!("{change:.2} {}", trend.unit)
    }
}

/// The slope of a cell over each covariate, with the signs of its folded members; nothing where the
/// covariate is constant over its sections.
fn slopes(
    found: &Found,
    cell: &Cell,
    turns: &[f64],
    covariates: &[Covariate],
    (covariance, rest): (&Covariance, &[f64]),
) -> Vec<Option<Slope>> {
    let place = |(section, feature): &(usize, usize)| found.seen.place(*section, *feature);
    // The residual is measured - simulated; reported is simulated - measured, as in the protocol.
    let values: Vec<f64> = cell.members.iter().map(|member| -rest[place(member)]).collect();
    let among = covariance.among(&cell.members);
    let of = |covariate: &Covariate| {
        let x: Vec<f64> =
            cell.members.iter().map(|(section, _)| covariate.values[*section]).collect();
        let turned: Vec<f64> = x.iter().zip(turns).map(|(x, side)| x * side).collect();
        let (change, error) = among.slope([turns, &turned], &values)?;
        let upright: Vec<f64> =
            values.iter().zip(turns).map(|(value, side)| value * side).collect();
        let law = Normal::standard();
        let in_words =
            |value: f64| if cell.kind == Kind::Level { value } else { value.exp() - 1.0 };
        Some(Slope {
            change: in_words(change),
            low: in_words(change - NINETY * error),
            high: in_words(change + NINETY * error),
            correlation: correlation(&x, &upright),
            p_value: 2.0 * law.sf((change / error).abs()),
            significant: false,
        })
    };
    covariates.iter().map(of).collect()
}

/// Pairs of correlated covariates, in words.
fn together(covariates: &[Covariate], sections: &[usize]) -> Vec<String> {
    let values = |covariate: &Covariate| {
        sections.iter().map(|at| covariate.values[*at]).collect::<Vec<f64>>()
    };
    let pairs = covariates
        .iter()
        .enumerate()
        .flat_map(|(at, one)| covariates[at + 1..].iter().map(move |other| (one, other)));
    let with = pairs.map(|(one, other)| (one, other, correlation(&values(one), &values(other))));
    with.filter(|(.., r)| r.abs() > TOGETHER)
        .map(|(one, other, r)| format!("{} and {} ({r:.2})", one.name, other.name))
        .collect()
}

fn correlation(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sum =
        |f: &dyn Fn(f64, f64) -> f64| x.iter().zip(y).map(|(x, y)| f(x - mx, y - my)).sum::<f64>();
    let (xy, xx, yy) = (sum(&|x, y| x * y), sum(&|x, _| x * x), sum(&|_, y| y * y));
    if xx > 0.0 && yy > 0.0 { xy / (xx * yy).sqrt() } else { 0.0 }
}
