//! A diagnosis as a document: answer, location of the gap, causes, reduction of the gap, detectable
//! effects.

use crate::report::{
    detectable::detectable,
    document::*,
    figure, number,
    view::{self, Opening},
};
use crate::result::{
    Certification,
    diagnosis::{
        Cause, Diagnosis, Invariant, NamedEffect, Picture, QuantityShrink, Ratio, Shape, Shrink,
        Slope, Trend, Value, Where,
    },
};
use crate::words;

/// Number of significant cells listed, and of cells listed where fewer are significant;
/// diagnosis.json contains all.
const CELLS: usize = 30;
const FIRST_CELLS: usize = 12;
/// Share of the gap below which a cell is not listed.
const LEAST_SHARE: f64 = 0.0005;
/// Number of trends listed, and where none is significant.
const TRENDS: usize = 12;
const FEW: usize = 4;

/// The diagnosis as printed in both reports. `before` is the protocol evaluated on the campaign as
/// it is.
pub fn document(found: &Diagnosis, before: &Certification) -> Document {
    let mut chapters = vec![answer(found), places(found)];
    if !found.causes.is_empty() || !found.vetoed.is_empty() {
        chapters.push(causes(found));
    }
    if let Some(shrink) = &found.shrink {
        chapters.push(shrunk(shrink));
    }
    chapters.extend(signals(found));
    chapters.push(Chapter::new("seen", "Detectable effects", detectable(found)));
    chapters.push(how(found));
    let shrink = found.shrink.as_ref();
    let verdict_after =
        shrink.map_or("-", |one| before.protocol.verdict_words.word(one.verdict_after));
    let removed = shrink.map_or("-".into(), |shrink| share(shrink.fraction_removed));
    let holds = match &*found.verdict {
        "explained" | "no significant gap" => Some(true),
        "ambiguous" => None,
        _ => Some(false),
    };
    let opening = Opening {
        headline: Finding::new(holds, &found.verdict, &found.verdict, &found.verdict),
        sentence: words::or_nothing(found.says.first()),
        facts: vec![
            Fact::new("Verdict before", before.verdict_word()),
            Fact::new("Verdict with the effects", verdict_after),
            Fact::new("Gap removed", removed),
            Fact::new("Sections", found.how.sections.to_string()),
        ],
    };
    view::study(
        (
            format!("Diagnosis: {}", found.campaign),
            "Differences between simulation and measurement, and their causes",
        ),
        opening,
        (&before.campaign, &before.protocol),
        chapters,
    )
}

/// `69 %`
fn share(value: f64) -> String {
    format!("{} %", percent(value))
}

fn percent(value: f64) -> String {
    number::fixed(100.0 * value, 0)
}

/// All figures by their names in the document.
pub fn figures(found: &Diagnosis) -> Vec<(String, String)> {
    let mut drawn = Vec::new();
    if !found.r#where.is_empty() {
        drawn.push(("map".to_owned(), figure::map(&found.r#where)));
    }
    if let Some(shrink) = &found.shrink {
        drawn.push(("before-after".to_owned(), figure::before_after(shrink)));
    }
    for (at, picture) in found.pictures.iter().enumerate() {
        drawn.push((format!("signals-{at}"), figure::signals(picture)));
    }
    drawn
}

fn answer(found: &Diagnosis) -> Chapter {
    let mut blocks = vec![Block::list(
        found.says.iter().map(|line| number::raised(String::from(words::text(line)))),
    )];
    if let Some(measure) = &found.discriminating_measurement {
        blocks.push(Block::text(format!("The causes can be distinguished by: {measure}.")));
    }
    if !found.notes.is_empty() {
        blocks.push(Block::heading("Remarks"));
        blocks.push(Block::list(found.notes.iter().map(|note| number::raised(note.text()))));
    }
    Chapter::new("answer", "Answer", blocks)
}

fn places(found: &Diagnosis) -> Chapter {
    let significant = found.r#where.iter().filter(|place| place.significant).count();
    let mut text = format!(
        "{significant} of {} cells differ by more than noise, declared tolerances and the allowed model discrepancy.",
        found.r#where.len()
    );
    if significant == 0 && !found.causes.is_empty() {
        text.push_str(" No single cell does; the conclusions below rest on all cells together.");
    }
    let caption = "Share of the gap by quantity and position, zone and band; darker cells have a larger share (scale below); a dot marks significant cells";
    let alt = "Map of cells, darker where the share of the gap is larger";
    let map = Figure::new("map", caption, alt, 200);
    let mut blocks = vec![Block::text(text), map.into(), cells(found).into()];
    if !found.invariants.is_empty() {
        blocks.push(invariants(&found.invariants, !found.causes.is_empty()).into());
    }
    blocks.extend(trends(found));
    if !found.shapes.is_empty() {
        blocks.push(shapes(&found.shapes).into());
        blocks.push(Block::list(found.shapes.iter().map(|shape| &shape.says)));
    }
    Chapter::new("where", "Where the gap lies", blocks)
}

/// Cells of the gap: those that are significant, and the first of all.
fn cells(found: &Diagnosis) -> Table {
    let told = |(at, place): &(usize, &Where)| {
        place.significant || *at < FIRST_CELLS && place.share_of_gap >= LEAST_SHARE
    };
    let size = |place: &Where, value: f64| match place.unit.as_str() {
        "-" => Cell::text(number::with_unit(&percent(value), "%")),
        unit => {
            let decimals = number::decimals_of([place.difference_rms], 3);
            Cell::text(number::with_unit(&number::fixed(value, decimals), unit))
        }
    };
    let rows = found.r#where.iter().enumerate().filter(told).take(CELLS).map(|(_, place)| {
        let p = if place.p_value < 1e-6 {
            "<\u{a0}0.000001".into()
        } else {
            number::significant(place.p_value, 2)
        };
        cells![
            place.quantity,
            place.position,
            place.wavelength_or_band,
            place.zones.join(", "),
            size(place, place.difference),
            size(place, place.difference_rms),
            number::with_unit(&number::fixed(100.0 * place.share_of_gap, 1), "%"),
            format!("{p}{}", if place.significant { " *" } else { "" })
        ]
    });
    let caption = "Cells by their share of the gap, tested against noise, declared tolerances and the allowed model discrepancy; \
                   * significant at a false discovery rate of 5 %. Mean and rms are over the sections and channels \
                   of a cell: of sign(measured) (simulated - measured) for quasi-static values, of rms simulated / measured - 1 for bands";
    Table::new(caption)
        .short("Quantity")
        .text("Position")
        .short("Band")
        .name("Zone")
        .numbers(["Mean", "Rms", "Share", "p"])
        .rows(rows)
}

/// With columns for the effects if any are named.
fn invariants(all: &[Invariant], named: bool) -> Table {
    let row = |one: &Invariant| {
        let decimals = number::decimals_of([one.before, one.after, one.allowed], 3);
        let number =
            |value: f64| Cell::from(number::with_unit(&number::fixed(value, decimals), &one.unit));
        let off = |value: f64, allowed: f64| {
            let times = (allowed > 0.0).then(|| value.abs() / allowed);
            Cell::number(times, Format::Fixed(1))
        };
        let mut row = cells![one.name, &*one.parity, number(one.before)];
        row.extend(named.then(|| number(one.after)));
        row.extend([number(one.allowed), off(one.before, one.allowed)]);
        row.extend(named.then(|| off(one.after, one.allowed_after)));
        row
    };
    let caption = "Sums of quasi-static forces that only some causes can change, simulated - measured, mean over the sections; \
                   allowed is one standard deviation, which is the unit of the deviations (after: including the effects)";
    Table::new(caption)
        .text("Sum")
        .text("Symmetry")
        .number("As simulated")
        .when(named, |table| table.number("With the effects"))
        .numbers(["Allowed", if named { "Deviation before" } else { "Deviation" }])
        .when(named, |table| table.number("Deviation after"))
        .rows(all.iter().map(row))
}

/// Trends that are significant before or after, or else the closest ones.
fn trends(found: &Diagnosis) -> Vec<Block> {
    if found.trends_tested == 0 {
        return Vec::new();
    }
    let significant: Vec<&Trend> = found
        .trends
        .iter()
        .filter(|trend| trend.before.significant || trend.after.significant)
        .collect();
    let gone = significant.iter().filter(|trend| !trend.after.significant).count();
    let mut text = format!(
        "Of {} trends of a difference over a column of the section table, ",
        found.trends_tested
    );
    let named = !found.causes.is_empty();
    text += &match (significant.len(), named) {
        (0, _) if found.trends.is_empty() => "none exceeds the allowed difference.".to_owned(),
        (0, _) => "none exceeds the allowed difference; the closest ones are listed.".to_owned(),
        (some, true) => {
            format!(
                "{some} exceed the allowed difference, as simulated or with the effects; {gone} of these no longer do with the effects."
            )
        }
        (some, false) => format!("{some} exceed the allowed difference."),
    };
    if !found.together.is_empty() {
        text += &format!(
            " A trend over one of two correlated columns may belong to the other (correlation in brackets): {}.",
            found.together.join("; ")
        );
    }
    let listed: Vec<&Trend> =
        if significant.is_empty() { found.trends.iter().take(FEW).collect() } else { significant };
    let row = |trend: &&Trend| {
        let change = |slope: &Slope| {
            let decimals = number::decimals_of([slope.change, slope.low, slope.high], 2);
            let of = |value: f64| {
                if trend.unit == "-" {
                    number::fixed(100.0 * value, 0)
                } else {
                    number::fixed(value, decimals)
                }
            };
            let unit = if trend.unit == "-" { "%" } else { &trend.unit };
            let mark = if slope.significant { " *" } else { "" };
            let between = format!("({} to {})", of(slope.low), of(slope.high));
            format!("{} {}{mark}", of(slope.change), number::with_unit(&between, unit))
        };
        let last = if named { &trend.after } else { &trend.before };
        let (from, to) = (&trend.from_without_unit, &trend.to);
        let mut cells = cells![
            format!("{}, {}", trend.quantity, trend.position),
            trend.wavelength_or_band,
            format!("{}: {from} to {to}", trend.covariate),
            change(&trend.before)
        ];
        cells.extend(named.then(|| Cell::from(change(last))));
        cells.push(Cell::number(last.correlation, Format::Fixed(2)));
        cells
    };
    let caption = format!(
        "Change of simulated - measured over the range of a column of the section table, by generalised least squares on that column \
         alone, with a 90 % interval; * significant at a false discovery rate of 5 %. {}r is the correlation of the differences as simulated{}",
        // A machine without left and right curves has none.
        if found.mirrored {
            "Levels that change sign with the curve are turned to one direction. "
        } else {
            ""
        },
        if named { ", with the effects" } else { "" }
    );
    let table = Table::new(caption)
        .text("Quantity")
        .short("Band")
        .text("Over")
        .number("As simulated")
        .when(named, |table| table.number("With effects"))
        .number("r")
        .rows(listed.iter().take(TRENDS).map(row));
    let table = (!listed.is_empty()).then(|| table.into());
    std::iter::once(Block::text(text)).chain(table).collect()
}

fn shapes(all: &[Shape]) -> Table {
    let row = |shape: &Shape| {
        let ratio = |ratio: Ratio| {
            let two = |value: f64| number::fixed(value, 2);
            format!("{} ({} to {})", two(ratio.value), two(ratio.low), two(ratio.high))
        };
        vec![
            Cell::from(&shape.quantity),
            ratio(shape.rms).into(),
            ratio(shape.peak).into(),
            ratio(shape.crest).into(),
            Cell::or_missing(shape.alike_by_frequency.map(share)),
            Cell::or_missing(shape.alike_by_wavelength.map(share)),
            Cell::or_missing(shape.keeps_to.as_deref().or(shape.reason.as_deref())),
        ]
    };
    let caption = "Dynamic content as recorded, measured over simulated, with 90 % intervals by resampling the sections; and the share of the \
                   difference of the spectra that is common to all sections, compared at equal frequency or at equal wavelength";
    Table::new(caption)
        .text("Quantity")
        .numbers(["Rms", "Peak", "Crest", "Common in Hz", "Common in m"])
        .text("Scales with")
        .rows(all.iter().map(row))
}

/// A size with its unit.
fn with_unit(size: f64, value: &Value) -> String {
    number::with_unit(&number::significant(size, 4), &value.unit)
}

fn value(value: &Value) -> String {
    value.value.as_f64().map_or_else(|| value.text(), |size| with_unit(size, value))
}

fn interval(value: &Value) -> String {
    match (value.low, value.high) {
        (Some(low), Some(high)) => {
            format!("{} to {}", number::significant(low, 4), number::significant(high, 4))
        }
        _ => "-".into(),
    }
}

/// A row for each parameter; what is about the cause stands in the first.
fn cause_rows(cause: &Cause) -> Vec<Vec<Cell>> {
    let mut rows = Vec::new();
    for effect in &cause.effects {
        for (at, told) in effect.told().into_iter().enumerate() {
            let first = rows.is_empty();
            let only = |cell: Cell| if first { cell } else { Cell::BLANK };
            let probability = number::with_unit(&number::fixed(100.0 * cause.probability, 1), "%");
            let title = format!("{}{}{}", effect.title, told.on(), effect.only_in());
            let assumed = told.value.assumed.map(|assumed| with_unit(assumed, told.value));
            rows.push(cells![
                only(cause.rank.to_string().into()),
                if at == 0 { title.into() } else { Cell::BLANK },
                &*told.parameter,
                assumed.unwrap_or_else(|| "-".into()),
                value(told.value),
                interval(told.value),
                only(probability.into()),
                only(Cell::number(cause.evidence, Format::Fixed(0))),
                only(if cause.in_ambiguity_set { "yes" } else { "no" }.into())
            ]);
        }
    }
    rows
}

fn found_by(effect: &NamedEffect) -> String {
    let stands = effect.stability.map_or(String::new(), |first| {
        format!("; in {} of the resamples of the sections it has the most evidence", share(first))
    });
    format!("{}: {}{stands}", effect.title, effect.added_by)
}

fn causes(found: &Diagnosis) -> Chapter {
    let mut blocks = Vec::new();
    if let Some(first) = found.causes.first() {
        let caption = "Candidate causes; evidence is twice the logarithm of the Bayes factor against no effect";
        let rows = found.causes.iter().flat_map(cause_rows);
        blocks.push(
            Table::new(caption)
                .short("Rank")
                .text("Effect")
                .short("Parameter")
                .numbers(["Assumed", "Found", "90 % interval", "Probability", "Evidence"])
                .short("Possible")
                .rows(rows)
                .into(),
        );
        blocks.push(Block::heading("How the effects were found, and their stability"));
        blocks.push(Block::list(first.effects.iter().map(found_by)));
    }
    if !found.vetoed.is_empty() {
        blocks.push(Block::heading("Rejected effects"));
        blocks.push(Block::list(found.vetoed.iter().map(|vetoed| &vetoed.says)));
    }
    Chapter::new("which", "Cause", blocks)
}

fn shrunk(shrink: &Shrink) -> Chapter {
    let about = format!(
        "Each section was simulated with parameters fitted to the other sections. The {} changes from {} to {}.",
        shrink.measure,
        number::fixed(shrink.before, 3),
        number::fixed(shrink.after, 3)
    );
    let caption = "Statistics divided by their limits, before and with the effects";
    let figure =
        Figure::new("before-after", caption, "Two marks per statistic, joined by a line", 200);
    let mut blocks = vec![Block::text(about), figure.into(), statistics(shrink).into()];
    if let Some(touched) = &shrink.touched {
        blocks.push(Block::text(format!(
            "In the quantities affected ({}), {} of the gap is removed (90 % interval {} to {}, by resampling sections).",
            touched.quantities.join(", "),
            share(touched.fraction_removed),
            percent(touched.low),
            share(touched.high)
        )));
    }
    if shrink.shares.len() > 1 {
        let entry = |(name, of_all): &(String, f64)| format!("{name}: {}", share(*of_all));
        blocks.push(Block::heading("Contribution of each effect"));
        blocks.push(Block::list(shrink.shares.iter().map(entry)));
    }
    Chapter::new("how-far", "Reduction of the gap", blocks)
}

fn statistics(shrink: &Shrink) -> Table {
    let number = |value: Option<f64>| Cell::number(value, Format::Fixed(3));
    let row = |quantity: &QuantityShrink| {
        let removed = format!(
            "{} ({} to {}) %",
            percent(quantity.fraction_removed),
            percent(quantity.low),
            percent(quantity.high)
        );
        vec![
            Cell::symbol(&quantity.id, ""),
            number(quantity.normalised_mean_before),
            number(quantity.normalised_mean_after),
            number(quantity.normalised_std_before),
            number(quantity.normalised_std_after),
            removed.into(),
            Cell::or_missing(quantity.variance_explained.map(share)),
            Cell::or_missing(quantity.variance_explained_above_noise.map(share)),
        ]
    };
    let numbers = [
        "Mean before",
        "after",
        "Std before",
        "after",
        "Removed",
        "Variance removed",
        "above noise",
    ];
    let caption = "Mean and standard deviation divided by their limits, before and with the effects; fraction of their root mean square that is removed, \
                   with a 90 % interval by resampling sections; fraction of the squared differences that is removed, in total and \
                   above the declared noise of the channels";
    Table::new(caption).text("Quantity").numbers(numbers).rows(shrink.quantities.iter().map(row))
}

fn signals(found: &Diagnosis) -> Option<Chapter> {
    let figure = |(at, picture): (usize, &Picture)| {
        let caption = format!("Section {}: {}", picture.section, picture.says);
        let alt = "Measured and simulated signals over distance";
        Figure::new(format!("signals-{at}"), caption, alt, 200).into()
    };
    let blocks: Vec<Block> = found.pictures.iter().enumerate().map(figure).collect();
    let title = "Signals with the largest gap";
    (!blocks.is_empty()).then(|| Chapter::new("signals", title, blocks))
}

fn how(found: &Diagnosis) -> Chapter {
    let how = &found.how;
    let share = |value: f64| number::with_unit(&number::fixed(100.0 * value, 1), "%");
    let rows = [
        ("Catalogue of effects", how.catalogue.clone()),
        ("Simulator", how.simulator.clone()),
        ("Combination of effects", how.mode.clone()),
        ("Tolerances", how.tolerances.clone()),
        ("Sections", how.sections.to_string()),
        ("Features", how.features.to_string()),
        ("Simulated sections", found.simulations_run.to_string()),
        ("Evidence required", number::fixed(how.threshold, 1)),
        (
            "Drawn campaigns without an effect in which one would be named",
            share(found.false_name_rate),
        ),
        ("Chi-squared per feature, before", number::fixed(how.chi_squared_before, 3)),
        ("Chi-squared per feature, after", number::fixed(how.chi_squared_after, 3)),
        (
            "Factor by which what is allowed would fit what is left",
            format!(
                "{} \u{b1} {} (90 %)",
                number::fixed(found.fit.allowance_scale, 2),
                number::fixed(1.645 * found.fit.allowance_scale_sd, 2)
            ),
        ),
        ("Seed", how.seed.to_string()),
    ];
    let rows = rows.map(|(name, value)| cells![name, value]);
    let table = Table::new("Settings of the diagnosis").text("Setting").text("Value").rows(rows);
    Chapter::new("how", "Method and settings", vec![table.into()])
}
