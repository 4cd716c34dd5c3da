//! The probability that a verdict is the right one: what the channels may really have been is drawn
//! from the declared uncertainties and evaluated through the graph (JCGM 101:2008, 7).

use rayon::prelude::*;

use super::channels::Channel;
use crate::check::plan::Plan;
use crate::data::{
    Campaigns,
    campaign::{Size, Uncertainty},
};
use crate::metrics::{
    disturb::stream,
    interval::wilson,
    normal::normal_quantile,
    random::{GOLDEN, mixed},
};
use crate::problem::{Problem, Problems, error, problem};
use crate::result::{
    StatisticResult, Verdict,
    margin::{Changed, Drawn, Probability, Risk, Wrong},
};
use crate::run::{Change, Holding, Line, Lines};

/// Guard band in standard uncertainties: a value that meets a limit by this much does so with a
/// probability of 95 %, of a normal distribution (JCGM 106:2012, 8.3).
const GUARD: f64 = 1.645;

/// An uncertainty of a channel of the protocol.
#[derive(Clone, Debug)]
pub struct OfChannel {
    drawn: Drawn,
    /// Standard deviation: of the factor, or of what is added, SI.
    si: f64,
}

/// The uncertainties that a campaign declares.
#[derive(Clone, Debug, Default)]
pub struct Declared {
    pub uncertainties: Vec<OfChannel>,
    /// Of channels that the protocol does not read.
    pub not_used: Vec<String>,
}

/// # Errors
/// `unit-mismatch`; `uncertainty-contradiction`: campaigns that are evaluated as one state
/// different ones.
pub fn declared(campaigns: Campaigns<'_>, channels: &[Channel]) -> Result<Declared, Problems> {
    let first = campaigns.get(0);
    let alike = |a: &Uncertainty, b: &Uncertainty| {
        (&a.channel.value, &a.size, a.correlated) == (&b.channel.value, &b.size, b.correlated)
    };
    for other in campaigns.iter().skip(1) {
        let (a, b) = (&first.uncertainties, &other.uncertainties);
        if a.len() != b.len() || !a.iter().zip(b).all(|(a, b)| alike(a, b)) {
            let says = "campaigns that are evaluated as one declare different uncertainties";
            let at = |of: &crate::data::Campaign| of.tree.span_or_start("uncertainty");
            let problem = error("uncertainty-contradiction", says, &at(other));
            return Err(problem.also(&at(first), "those of the first campaign").into());
        }
    }
    let mut declared = Declared::default();
    let mut problems = Problems::default();
    for of in &first.uncertainties {
        match of_channel(of, channels) {
            Ok(Some(found)) => declared.uncertainties.push(found),
            Ok(None) => declared.not_used.push(of.channel.value.clone()),
            Err(problem) => problems.push(problem),
        }
    }
    if problems.any_error() { Err(problems) } else { Ok(declared) }
}

/// A name is that of a channel, or of one of its columns.
fn of_channel(of: &Uncertainty, channels: &[Channel]) -> Result<Option<OfChannel>, Problem> {
    let name = &of.channel.value;
    let found = channels.iter().find_map(|channel| match channel.name == *name {
        true => Some((channel, channel.columns.clone())),
        false => channel.columns.contains(name).then(|| (channel, vec![name.clone()])),
    });
    let Some((channel, columns)) = found else { return Ok(None) };
    let (changed, si, standard, unit) = match &of.size {
        Size::Gain(si) => (Changed::Gain, *si, 100.0 * si, "%"),
        Size::Offset(si, unit) if unit.dimension == channel.unit.dimension => {
            let standard = channel.unit.from_si(*si);
            (Changed::Offset, *si, standard, channel.unit.text.as_str())
        }
        Size::Offset(_, unit) => {
            let problem = problem!(
                "unit-mismatch",
                &of.span,
                "the uncertainty of `{name}` is in {unit}, the protocol reads the channel in {}",
                channel.unit
            );
            return Err(problem.help("an uncertainty of the gain is in `%`"));
        }
    };
    let drawn = Drawn {
        channel: name.clone(),
        of: changed,
        standard,
        unit: unit.to_owned(),
        correlated: of.correlated,
        columns,
    };
    Ok(Some(OfChannel { drawn, si }))
}

/// A number of the standard normal distribution: a function of the seed, the draw and the name.
fn normal(seed: u64, draw: usize, name: &str, of: &str) -> f64 {
    let start = mixed(stream([name, of]) ^ mixed(seed.wrapping_add(GOLDEN)));
    let word = mixed(start.wrapping_add((draw as u64 + 1).wrapping_mul(GOLDEN)));
    // In the middle of one of 2^53 equal parts: never 0 or 1.
    let share = ((word >> 11) as f64 + 0.5) / (1_u64 << 53) as f64;
    normal_quantile(share).unwrap_or(0.0)
}

fn lines(uncertainties: &[OfChannel], (seed, draw): (u64, usize)) -> Lines {
    let mut lines = Lines::new();
    for OfChannel { drawn, si } in uncertainties {
        for column in &drawn.columns {
            let name = if drawn.correlated { &drawn.channel } else { column };
            let line = lines.entry(column.clone()).or_insert(Line::SAME);
            match drawn.of {
                Changed::Gain => line.factor += si * normal(seed, draw, name, "gain"),
                _ => line.offset += si * normal(seed, draw, name, "offset"),
            }
        }
    }
    lines
}

/// What one draw makes of the verdict and of the statistics, in the order of the result: the value,
/// and whether the limit is met.
type OfDraw = (Verdict, Vec<(Option<f64>, Option<bool>)>);

/// The share of the draws that have the verdict as it is, and what it rests on; `None` where no
/// uncertainty is declared.
pub fn drawn(
    plan: &Plan,
    holding: &Holding<'_>,
    uncertainties: &[OfChannel],
    (draws, seed): (usize, u64),
) -> Option<(f64, Probability)> {
    if uncertainties.is_empty() || draws == 0 {
        return None;
    }
    let base = holding.base.judge(plan);
    let draw = |draw: usize| -> OfDraw {
        let lines = lines(uncertainties, (seed, draw));
        let judged = holding.with(Change::Calibrated(&lines)).judge(plan);
        let all = judged.quantities.iter().flat_map(|quantity| &quantity.statistics);
        (judged.verdict, all.map(|one| (one.value, one.holds)).collect())
    };
    let all: Vec<OfDraw> = (0..draws).into_par_iter().map(draw).collect();
    let right = all.iter().filter(|(verdict, _)| *verdict == base.verdict).count();
    let statistics =
        base.quantities.iter().flat_map(|of| of.statistics.iter().map(move |one| (of, one)));
    let count = statistics.clone().count();
    // Where groups come and go with a draw, it says nothing of single ones.
    let same: Vec<&OfDraw> = all.iter().filter(|(_, found)| found.len() == count).collect();
    let limits = statistics.enumerate().filter_map(|(at, (quantity, one))| {
        let risk = risk(one, same.iter().map(|(_, found)| found[at]))?;
        Some(Risk { quantity: quantity.id.clone(), symbol: quantity.symbol.clone(), ..risk })
    });
    let method = format!(
        "Monte Carlo method (JCGM 101:2008, 7): {draws} draws of the true gains and offsets of the measured channels from normal distributions with the declared standard uncertainties, seed {seed}, each evaluated through the protocol. The measured values are multiplied by one plus the gain, and the offset is added. Specific risks and guard bands by JCGM 106:2012, 8.3 and 9.3: the guard band is {GUARD} standard uncertainties, for a probability of conformity of 95 % at a one-sided limit."
    );
    let probability = Probability {
        draws,
        seed,
        interval_95: wilson(right as u64, draws as u64),
        method,
        channels: uncertainties.iter().map(|of| of.drawn.clone()).collect(),
        limits: limits.collect(),
    };
    Some((right as f64 / draws as f64, probability))
}

/// `None` of a statistic without a result, or in fewer than two draws.
fn risk(
    one: &StatisticResult,
    draws: impl Iterator<Item = (Option<f64>, Option<bool>)>,
) -> Option<Risk> {
    let (value, holds) = (one.value?, one.holds?);
    let (mut values, mut wrong, mut all) = (Vec::new(), 0_usize, 0_usize);
    for (value, found) in draws {
        values.extend(value);
        all += 1;
        wrong += usize::from(found == Some(!holds));
    }
    if values.len() < 2 {
        return None;
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let uncertainty = (squares / (values.len() - 1) as f64).sqrt();
    let guard_band = GUARD * uncertainty;
    Some(Risk {
        quantity: String::new(),
        symbol: String::new(),
        statistic: one.name.clone(),
        scope: one.scope.clone(),
        unit: one.unit.clone(),
        value,
        limit: one.limit,
        standard_uncertainty: uncertainty,
        risk_of: if holds { Wrong::FalseAcceptance } else { Wrong::FalseRejection },
        risk: wrong as f64 / all as f64,
        guard_band,
        within_guard_band: one
            .limit
            .is_some_and(|limit| one.direction.distance(value, limit).abs() < guard_band),
    })
}
