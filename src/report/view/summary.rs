//! The summary: one row per quantity with mean and standard deviation, and one row per other
//! statistic.

use super::{View, cover, groups, statistic, verdicts, wording};
use crate::report::{document::*, estimates, findings, number};
use crate::result::{Certification, QuantityResult, StatisticName, StatisticResult};

/// What the word means behind a criterion.
const MARGINAL: &str = "Marginal: the 95 % interval of the statistic contains the limit, so that another choice of sections could change the result.";

pub fn chapter(view: &View<'_>) -> Chapter {
    let found = view.found;
    let finding = cover::finding(view);
    let tone = finding.tone;
    let verdict = Text::from(Run::Finding(finding)).and(format!(": {}", wording::sentence(found)));
    let mut opening = vec![Block::text(verdict)];
    let reasons = verdicts::reasons(view);
    if !reasons.is_empty() {
        opening.push(Block::Boxed { tone: Some(tone), title: "", entries: reasons });
    }
    if found.verdicts.len() > cover::VERDICTS {
        opening.push(verdicts::table(view, true).into());
    }
    let mut remarks = Vec::new();
    if !found.findings.is_empty() {
        remarks.push(findings::table(&found.findings).into());
    }
    remarks.extend(cover::limitations(view, usize::MAX));
    opening.extend(remarks.iter().cloned());
    let mut blocks = vec![Block::on_paper(opening)];
    blocks.extend(tables(view).into_iter().map(Block::from));
    let marginal = |quantity: &QuantityResult| quantity.statistics.iter().any(|one| one.marginal);
    if found.quantities.iter().any(marginal) {
        blocks.push(Block::text(MARGINAL));
    }
    let estimates = groups::summary(view);
    blocks.extend((!estimates.rows.is_empty()).then(|| estimates.into()));
    blocks.extend(overview(found).map(Block::from));
    blocks.push(Block::on_screen(remarks));
    Chapter { on_new_page: true, ..Chapter::new("summary", "Summary", blocks) }
}

/// Quantities judged by mean and standard deviation over all pairs, as in EN 14363, and all other
/// statistics.
fn tables(view: &View<'_>) -> Vec<Table> {
    let mut summary = Vec::new();
    let mut further: Vec<Row> = Vec::new();
    for quantity in &view.found.quantities {
        // An assessed quantity has its estimates in a table of its own.
        if quantity.from.is_some() && !quantity.statistics.is_empty() {
            continue;
        }
        let mean = quantity.overall(&StatisticName::Mean);
        let std = quantity.overall(&StatisticName::StandardDeviation);
        // A quantity without statistics is listed with its reason. One without a limit that has
        // values stands in its chapter.
        let without_limit =
            quantity.decides_nothing() && quantity.reason.is_none() && !quantity.values.is_empty();
        if mean.is_some() || std.is_some() || quantity.statistics.is_empty() && !without_limit {
            summary.push(summary_row(quantity, mean, std));
        }
        let single = estimates::single(quantity).into_iter();
        let named = [StatisticName::Mean, StatisticName::StandardDeviation];
        let others = single.filter(|one| !named.iter().any(|name| one.is_overall(name)));
        further.extend(others.map(|one| further_row(quantity, one)));
    }
    let mut tables = Vec::new();
    if !summary.is_empty() {
        let caption =
            "Mean and standard deviation of the differences over all pairs, and their limits";
        let table = Table::new(caption)
            .text("Quantity")
            .wide(0.75)
            .short("Unit")
            .text("Filter")
            .wide(1.6)
            .text("Processing")
            .wide(1.1)
            .numbers(["Limit std", "Limit mean", view.words.count, "Mean", "Std"])
            .numbers(["|Mean| / limit", "Std / limit"])
            .text("Criterion")
            .rows(summary);
        tables.push(table.class("sortable worded").size(7.5));
    }
    if !further.is_empty() {
        let caption = if tables.is_empty() {
            "Statistics and their limits"
        } else {
            "Further statistics and their limits"
        };
        let table = Table::new(caption)
            .text("Quantity")
            .wide(0.8)
            .text("Filter")
            .wide(1.7)
            .once()
            .text("Processing")
            .wide(1.1)
            .once()
            .text("Comparison")
            .only(Medium::Screen)
            .text("Statistic")
            .wide(1.2)
            .name("Scope")
            .wide(0.5)
            .short("Unit")
            .numbers([view.words.count, "Value", "Limit", "|Value| / limit"])
            .text("Criterion")
            .rows(further);
        tables.push(table.size(7.5));
    }
    tables
}

/// Limits, mean and standard deviation, and both divided by their limits.
fn summary_row(
    quantity: &QuantityResult,
    mean: Option<&StatisticResult>,
    std: Option<&StatisticResult>,
) -> Row {
    let either = mean.or(std).map(|one| (one.count, one.n));
    let (pairs, n) = either.unwrap_or((quantity.values.len(), quantity.n));
    Row::from(cells![
        statistic::symbol(quantity),
        number::unit(&quantity.unit),
        quantity.filter,
        quantity.processing,
        statistic::limit(std),
        statistic::limit(mean),
        statistic::pairs_and_n(pairs, n),
        statistic::value(mean),
        statistic::value(std),
        statistic::normalised(mean),
        statistic::normalised(std)
    ])
    .ending(Finding::of_quantity(quantity), quantity.reason.as_ref())
}

fn further_row(quantity: &QuantityResult, statistic: &StatisticResult) -> Row {
    let one = Some(statistic);
    Row::from(cells![
        statistic::symbol(quantity),
        quantity.filter,
        quantity.processing,
        quantity.comparison,
        Cell::formula(&statistic.title),
        statistic.scope,
        number::unit(&statistic.unit),
        statistic::pairs_and_n(statistic.count, statistic.n),
        statistic::value(one),
        statistic::limit(one),
        statistic::normalised(one)
    ])
    .ending(Finding::of_statistic(one), statistic.reason.as_ref())
}

fn overview(found: &Certification) -> Option<Figure> {
    let shown = found.quantities.iter().flat_map(estimates::representatives);
    let normalised: Vec<f64> = shown.filter_map(|statistic| statistic.normalised).collect();
    let by_group = found
        .quantities
        .iter()
        .any(|quantity| estimates::condensed(quantity).iter().any(estimates::OfLimit::by_group));
    let beyond = normalised.iter().filter(|value| **value > 1.0).count();
    let caption = if by_group {
        "Estimates of all quantities divided by their limits, of each the largest of its groups; a criterion is met up to 1"
    } else {
        "Statistics of all quantities divided by their limits; a criterion is met up to 1"
    };
    let alt = format!(
        "Chart of {} normalised statistics of {} quantities against the limit 1: {beyond} beyond the limit. The numbers are in the summary table.",
        normalised.len(),
        found.quantities.len()
    );
    (!normalised.is_empty()).then(|| Figure::new("overview", caption, alt, 190))
}
