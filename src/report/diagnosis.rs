//! A diagnosis as a document: answer, location of the gap, causes, reduction of the gap, detectable
//! effects.

use crate::report::detectable::detectable;
use crate::report::figure;
use crate::report::number;
use crate::report::study::{Chapter, Document, Head, Item, Table};
use crate::report::view::{self, Fact, Finding};
use crate::result::Certification;
use crate::result::diagnosis::{
    Cause, Diagnosis, Invariant, NamedEffect, QuantityShrink, Ratio, Shape, Shrink, Slope, Trend,
    Value, Where,
};

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
#[must_use]
pub fn document(found: &Diagnosis, before: &Certification) -> Document {
    let mut chapters = vec![answer(found), places(found)];
    if !found.causes.is_empty() || !found.vetoed.is_empty() {
        chapters.push(causes(found));
    }
    if let Some(shrink) = &found.shrink {
        chapters.push(shrunk(shrink));
    }
    chapters.extend(signals(found));
    chapters.push(chapter("seen", "Detectable effects", detectable(found)));
    chapters.push(how(found));
    let class = match &*found.verdict {
        "explained" | "no significant gap" => "good",
        "ambiguous" => "open",
        _ => "bad",
    };
    let share = |value: f64| format!("{} %", number::fixed(100.0 * value, 0));
    Document {
        title: format!("Diagnosis: {}", found.campaign),
        kind: "Differences between simulation and measurement, and their causes".into(),
        program: concat!("Fishplate ", env!("CARGO_PKG_VERSION")).into(),
        headline: Finding { word: found.verdict.to_string(), class, sign: sign(class) },
        sentence: found.says.first().cloned().unwrap_or_default(),
        key_facts: vec![
            Fact { name: "Verdict before".into(), value: before.verdict_word().into() },
            Fact {
                name: "Verdict with the effects".into(),
                value: found.shrink.as_ref().map_or("-".into(), |shrink| {
                    before.protocol.verdict_words.word(shrink.verdict_after).to_owned()
                }),
            },
            Fact {
                name: "Gap removed".into(),
                value: found
                    .shrink
                    .as_ref()
                    .map_or("-".into(), |shrink| share(shrink.fraction_removed)),
            },
            Fact { name: "Sections".into(), value: found.how.sections.to_string() },
        ],
        symbols: before.quantities.iter().map(|quantity| quantity.symbol.clone()).collect(),
        campaign: view::campaign(&before.campaign),
        protocol: view::protocol_view(&before.protocol),
        chapters,
    }
}

fn sign(class: &str) -> &'static str {
    match class {
        "good" => "\u{2713}",
        "bad" => "\u{2717}",
        _ => "?",
    }
}

/// All figures by their names in the document.
#[must_use]
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

fn chapter(id: &str, title: &str, items: Vec<Item>) -> Chapter {
    Chapter { id: id.into(), title: title.into(), items }
}

fn answer(found: &Diagnosis) -> Chapter {
    let printed = |texts: &[String]| texts.iter().map(|text| number::raised(text)).collect();
    let mut items = vec![Item::List { entries: printed(&found.says) }];
    if let Some(measure) = &found.discriminating_measurement {
        items.push(Item::text(format!("The causes can be distinguished by: {measure}.")));
    }
    if !found.notes.is_empty() {
        items.push(Item::Heading { text: "Remarks".into() });
        items.push(Item::List { entries: printed(&found.notes) });
    }
    chapter("answer", "Answer", items)
}

fn places(found: &Diagnosis) -> Chapter {
    let told = |(at, place): &(usize, &Where)| {
        place.significant || *at < FIRST_CELLS && place.share_of_gap >= LEAST_SHARE
    };
    let size = |place: &Where, value: f64| match place.unit.as_str() {
        "-" => number::with_unit(&number::fixed(100.0 * value, 0), "%"),
        unit => number::with_unit(
            &number::fixed(value, number::decimals_of([place.difference_rms], 3)),
            unit,
        ),
    };
    let rows = found.r#where.iter().enumerate().filter(told).take(CELLS).map(|(_, place)| {
        let p = if place.p_value < 1e-6 {
            "<\u{a0}0.000001".into()
        } else {
            number::significant(place.p_value, 2)
        };
        vec![
            place.quantity.clone(),
            place
                .says
                .split(", ")
                .skip(1)
                .take(2)
                .filter(|part| *part != place.wavelength_or_band)
                .collect::<Vec<_>>()
                .join(", "),
            place.wavelength_or_band.clone(),
            place.zones.join(", "),
            size(place, place.difference),
            size(place, place.difference_rms),
            number::with_unit(&number::fixed(100.0 * place.share_of_gap, 1), "%"),
            format!("{p}{}", if place.significant { " *" } else { "" }),
        ]
    });
    let head = vec![
        Head::short("Quantity"),
        Head::text("Position"),
        Head::short("Band"),
        Head::short("Zone"),
        Head::number("Mean"),
        Head::number("Rms"),
        Head::number("Share"),
        Head::number("p"),
    ];
    let caption = "Cells by their share of the gap, tested against noise, declared tolerances and the allowed model discrepancy; \
                   * significant at a false discovery rate of 5 %. Mean and rms are over the sections and channels \
                   of a cell: of sign(measured) (simulated - measured) for quasi-static values, of rms simulated / measured - 1 for bands";
    let table = Table { caption: caption.into(), head, rows: rows.collect() };
    let significant = found.r#where.iter().filter(|place| place.significant).count();
    let mut text = format!(
        "{significant} of {} cells differ by more than noise, declared tolerances and the allowed model discrepancy.",
        found.r#where.len()
    );
    if significant == 0 && !found.causes.is_empty() {
        text.push_str(" No single cell does; the conclusions below rest on all cells together.");
    }
    let caption = "Share of the gap by quantity and position, zone and band; darker cells have a larger share (scale below); a dot marks significant cells";
    let map =
        Item::figure("map", caption, "Map of cells, darker where the share of the gap is larger");
    let mut items = vec![Item::text(text), map, Item::Table { table }];
    if !found.invariants.is_empty() {
        items.push(Item::Table { table: invariants(&found.invariants, !found.causes.is_empty()) });
    }
    items.extend(trends(found));
    if !found.shapes.is_empty() {
        items.push(Item::Table { table: shapes(&found.shapes) });
        items.push(Item::List {
            entries: found.shapes.iter().map(|shape| shape.says.clone()).collect(),
        });
    }
    chapter("where", "Where the gap lies", items)
}

/// With columns for the effects if any are named.
fn invariants(all: &[Invariant], named: bool) -> Table {
    let rows = all.iter().map(|one| {
        let decimals = number::decimals_of([one.before, one.after, one.allowed], 3);
        let number = |value: f64| number::with_unit(&number::fixed(value, decimals), &one.unit);
        let off = |value: f64, allowed: f64| {
            if allowed > 0.0 {
                number::fixed(value.abs() / allowed, 1)
            } else {
                number::NONE.to_owned()
            }
        };
        let mut cells = vec![one.name.clone(), one.parity.to_string(), number(one.before)];
        cells.extend(named.then(|| number(one.after)));
        cells.extend([number(one.allowed), off(one.before, one.allowed)]);
        cells.extend(named.then(|| off(one.after, one.allowed_after)));
        cells
    });
    let caption = "Sums of quasi-static forces that only some causes can change, simulated - measured, mean over the sections; \
                   allowed is one standard deviation, which is the unit of the deviations (after: including the effects)";
    let mut head = vec![Head::text("Sum"), Head::text("Symmetry"), Head::number("As simulated")];
    head.extend(named.then(|| Head::number("With the effects")));
    head.extend([
        Head::number("Allowed"),
        Head::number(if named { "Deviation before" } else { "Deviation" }),
    ]);
    head.extend(named.then(|| Head::number("Deviation after")));
    Table { caption: caption.into(), head, rows: rows.collect() }
}

/// Trends that are significant before or after, or else the closest ones.
fn trends(found: &Diagnosis) -> Vec<Item> {
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
        let mut cells = vec![
            format!("{}, {}", trend.quantity, trend.position),
            trend.wavelength_or_band.clone(),
            over(trend),
            change(&trend.before),
        ];
        cells.extend(named.then(|| change(last)));
        cells.push(number::fixed(last.correlation, 2));
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
    let mut head = vec![
        Head::text("Quantity"),
        Head::short("Band"),
        Head::text("Over"),
        Head::number("As simulated"),
    ];
    head.extend(named.then(|| Head::number("With effects")));
    head.push(Head::number("r"));
    let table = Table { caption, head, rows: listed.iter().take(TRENDS).map(row).collect() };
    if table.rows.is_empty() {
        vec![Item::text(text)]
    } else {
        vec![Item::text(text), Item::Table { table }]
    }
}

/// A covariate with its range; the unit is printed once.
fn over(trend: &Trend) -> String {
    let unit = |end: &str| end.rsplit_once(' ').map(|(_, unit)| unit.to_owned());
    let same = unit(&trend.from).filter(|of| Some(of) == unit(&trend.to).as_ref());
    let from = same
        .and_then(|unit| trend.from.strip_suffix(&unit).map(str::trim_end))
        .unwrap_or(&trend.from);
    format!("{}: {from} to {}", trend.covariate, trend.to)
}

fn shapes(all: &[Shape]) -> Table {
    let rows = all.iter().map(|shape| {
        let ratio = |ratio: Ratio| {
            format!(
                "{} ({} to {})",
                number::fixed(ratio.value, 2),
                number::fixed(ratio.low, 2),
                number::fixed(ratio.high, 2)
            )
        };
        let share = |share: Option<f64>| {
            share.map_or_else(
                || number::NONE.to_owned(),
                |share| format!("{} %", number::fixed(100.0 * share, 0)),
            )
        };
        vec![
            shape.quantity.clone(),
            ratio(shape.rms),
            ratio(shape.peak),
            ratio(shape.crest),
            share(shape.alike_by_frequency),
            share(shape.alike_by_wavelength),
            shape
                .keeps_to
                .as_deref()
                .or(shape.reason.as_deref())
                .unwrap_or(number::NONE)
                .to_owned(),
        ]
    });
    let caption = "Dynamic content as recorded, measured over simulated, with 90 % intervals by resampling the sections; and the share of the \
                   difference of the spectra that is common to all sections, compared at equal frequency or at equal wavelength";
    let head = vec![
        Head::text("Quantity"),
        Head::number("Rms"),
        Head::number("Peak"),
        Head::number("Crest"),
        Head::number("Common in Hz"),
        Head::number("Common in m"),
        Head::text("Scales with"),
    ];
    Table { caption: caption.into(), head, rows: rows.collect() }
}

fn value(value: &Value) -> String {
    let printed = |number: f64| number::with_unit(&number::significant(number, 4), &value.unit);
    value.value.as_f64().map_or_else(|| value.text(), printed)
}

fn assumed(value: &Value) -> String {
    value.assumed.map_or_else(
        || "-".into(),
        |assumed| number::with_unit(&number::significant(assumed, 4), &value.unit),
    )
}

fn interval(value: &Value) -> String {
    match (value.low, value.high) {
        (Some(low), Some(high)) => {
            format!("{} to {}", number::significant(low, 4), number::significant(high, 4))
        }
        _ => "-".into(),
    }
}

fn cause_rows(cause: &Cause) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for effect in &cause.effects {
        for (at, told) in effect.told().into_iter().enumerate() {
            let first = rows.is_empty();
            let only = |text: String| if first { text } else { String::new() };
            rows.push(vec![
                only(cause.rank.to_string()),
                if at == 0 {
                    format!("{}{}{}", effect.title, told.on(), effect.only_in())
                } else {
                    String::new()
                },
                told.parameter.clone(),
                assumed(told.value),
                value(told.value),
                interval(told.value),
                only(number::with_unit(&number::fixed(100.0 * cause.probability, 1), "%")),
                only(number::fixed(cause.evidence, 0)),
                only(if cause.in_ambiguity_set { "yes".into() } else { "no".into() }),
            ]);
        }
    }
    rows
}

fn found_by(effect: &NamedEffect) -> String {
    let stands = effect.stability.map_or(String::new(), |first| {
        format!(
            "; in {} % of the resamples of the sections it has the most evidence",
            number::fixed(100.0 * first, 0)
        )
    });
    format!("{}: {}{stands}", effect.title, effect.added_by)
}

fn causes(found: &Diagnosis) -> Chapter {
    let head = vec![
        Head::short("Rank"),
        Head::text("Effect"),
        Head::short("Parameter"),
        Head::number("Assumed"),
        Head::number("Found"),
        Head::number("90 % interval"),
        Head::number("Probability"),
        Head::number("Evidence"),
        Head::short("Possible"),
    ];
    let mut items = Vec::new();
    if !found.causes.is_empty() {
        let caption = "Candidate causes; evidence is twice the logarithm of the Bayes factor against no effect";
        let rows = found.causes.iter().flat_map(cause_rows).collect();
        items.push(Item::Table { table: Table { caption: caption.into(), head, rows } });
        let entries: Vec<String> = found.causes[0].effects.iter().map(found_by).collect();
        items
            .push(Item::Heading { text: "How the effects were found, and their stability".into() });
        items.push(Item::List { entries });
    }
    if !found.vetoed.is_empty() {
        items.push(Item::Heading { text: "Rejected effects".into() });
        items.push(Item::List {
            entries: found.vetoed.iter().map(|vetoed| vetoed.says.clone()).collect(),
        });
    }
    chapter("which", "Cause", items)
}

fn shrunk(shrink: &Shrink) -> Chapter {
    let number = |value: Option<f64>| {
        value.map_or_else(|| number::NONE.to_owned(), |value| number::fixed(value, 3))
    };
    let percent = |value: f64| number::fixed(100.0 * value, 0);
    let share = |value: Option<f64>| {
        value.map_or_else(|| number::NONE.to_owned(), |value| format!("{} %", percent(value)))
    };
    let row = |quantity: &QuantityShrink| {
        vec![
            quantity.id.clone(),
            number(quantity.normalised_mean_before),
            number(quantity.normalised_mean_after),
            number(quantity.normalised_std_before),
            number(quantity.normalised_std_after),
            format!(
                "{} ({} to {}) %",
                percent(quantity.fraction_removed),
                percent(quantity.low),
                percent(quantity.high)
            ),
            share(quantity.variance_explained),
            share(quantity.variance_explained_above_noise),
        ]
    };
    let head = vec![
        Head::text("Quantity"),
        Head::number("Mean before"),
        Head::number("after"),
        Head::number("Std before"),
        Head::number("after"),
        Head::number("Removed"),
        Head::number("Variance removed"),
        Head::number("above noise"),
    ];
    let mut items = vec![
        Item::text(format!(
            "Each section was simulated with parameters fitted to the other sections. The {} changes from {} to {}.",
            shrink.measure,
            number::fixed(shrink.before, 3),
            number::fixed(shrink.after, 3)
        )),
        Item::figure("before-after", "Statistics divided by their limits, before and with the effects", "Two marks per statistic, joined by a line"),
        Item::Table {
            table: Table {
                caption: "Mean and standard deviation divided by their limits, before and with the effects; fraction of their root mean square that is removed, \
                          with a 90 % interval by resampling sections; fraction of the squared differences that is removed, in total and \
                          above the declared noise of the channels"
                    .into(),
                head,
                rows: shrink.quantities.iter().map(row).collect(),
            },
        },
    ];
    if let Some(touched) = &shrink.touched {
        let share = |value: f64| number::fixed(100.0 * value, 0);
        items.push(Item::text(format!(
            "In the quantities affected ({}), {} % of the gap is removed (90 % interval {} to {} %, by resampling sections).",
            touched.quantities.join(", "),
            share(touched.fraction_removed),
            share(touched.low),
            share(touched.high)
        )));
    }
    if shrink.shares.len() > 1 {
        let entries = shrink
            .shares
            .iter()
            .map(|(name, share)| format!("{name}: {} %", number::fixed(100.0 * share, 0)))
            .collect();
        items.push(Item::Heading { text: "Contribution of each effect".into() });
        items.push(Item::List { entries });
    }
    chapter("how-far", "Reduction of the gap", items)
}

fn signals(found: &Diagnosis) -> Option<Chapter> {
    let item = |(at, picture): (usize, &crate::result::diagnosis::Picture)| {
        let caption = format!("Section {}: {}", picture.section, picture.says);
        Item::figure(
            format!("signals-{at}"),
            caption,
            "Measured and simulated signals over distance",
        )
    };
    let items: Vec<Item> = found.pictures.iter().enumerate().map(item).collect();
    (!items.is_empty()).then(|| chapter("signals", "Signals with the largest gap", items))
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
    let table = Table {
        caption: "Settings of the diagnosis".into(),
        head: vec![Head::text("Setting"), Head::text("Value")],
        rows: rows.map(|(name, value)| vec![name.to_string(), value]).to_vec(),
    };
    chapter("how", "Method and settings", vec![Item::Table { table }])
}
