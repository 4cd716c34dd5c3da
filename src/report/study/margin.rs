//! Text of the study of the margin: how far the verdict is from another one.

use super::share_with;
use crate::report::{document::*, number, view::Opening};
use crate::result::{
    VerdictWords,
    margin::{Changed, Drawn, Margin, MarginStudy, Probability, Risk, Wrong},
};

/// Digits of a change: it was searched to 0.1 %.
const CHANGE: Format = Format::Change(3);

impl Changed {
    /// `gain of`, before the name of what is changed.
    fn title(self) -> &'static str {
        match self {
            Self::Gain => "Gain",
            Self::Offset => "Offset",
            Self::Shift => "Shift along",
            Self::Parameter => "Parameter",
            Self::Sections => "Left out:",
            Self::Limit => "Limit",
        }
    }
}

/// `Gain of Y`, as rows of the table and of the figure are called.
pub fn name(margin: &Margin) -> String {
    let of = match margin.change {
        Changed::Gain | Changed::Offset => " of",
        _ => "",
    };
    format!("{}{of} {}", margin.change.title(), margin.of)
}

/// A change with its sign, rounded towards none: within what is printed, the verdict stays. A
/// parameter is printed as a value.
fn end(margin: &Margin, value: f64) -> String {
    let (format, value) = match margin.change {
        Changed::Parameter | Changed::Sections => (Format::Significant(3), value),
        _ => (CHANGE, inward(value)),
    };
    number::with_unit(&format.print(value), &margin.unit)
}

fn inward(value: f64) -> f64 {
    if value == 0.0 {
        return value;
    }
    let unit = 10_f64.powf(value.abs().log10().floor() - 2.0);
    // A number that has no more digits stays.
    (value / unit * (1.0 + 1e-9)).trunc() * unit
}

/// From where to where the verdict stays, as far as it was searched.
pub fn range(margin: &Margin) -> String {
    if margin.change == Changed::Sections {
        return match (margin.high, margin.tried) {
            (Some(most), _) if most < 1.0 => "none".to_owned(),
            (Some(most), _) => format!("up to {most}, whichever they are"),
            (None, Some(tried)) => format!("up to {tried}, no flip"),
            (None, None) => "–".to_owned(),
        };
    }
    match (margin.low, margin.high, margin.searched) {
        (Some(low), Some(high), _) => format!("{} to {}", end(margin, low), end(margin, high)),
        (Some(low), None, searched) => {
            let to = searched.map(|of| format!(" to {}", end(margin, of.to)));
            format!("from {}{}", end(margin, low), to.unwrap_or_default())
        }
        (None, Some(high), searched) => {
            let from = searched.map(|of| format!("{} ", end(margin, of.from)));
            format!("{}to {}", from.unwrap_or_default(), end(margin, high))
        }
        (None, None, Some(of)) => {
            format!("{} to {}, no flip", end(margin, of.from), end(margin, of.to))
        }
        (None, None, None) if !margin.flips_with.is_empty() => {
            format!("not with {}", margin.flips_with.join(", "))
        }
        (None, None, None) => margin.tried.map_or_else(
            || "any".to_owned(),
            |tried| {
                if tried == 1 {
                    "other value too".into()
                } else {
                    format!("all {tried} others too")
                }
            },
        ),
    }
}

fn found_by(margin: &Margin) -> String {
    match (margin.exact, &margin.searched, margin.change) {
        (_, _, Changed::Limit) => "from the estimates".to_owned(),
        (true, _, _) => "exact".to_owned(),
        (false, Some(of), _) => {
            let step = number::with_unit(&number::significant(of.step, 3), &margin.unit);
            format!("steps of {step}, bisected")
        }
        (false, None, _) => "not all tried".to_owned(),
    }
}

fn beyond(margin: &Margin, words: &VerdictWords) -> String {
    let mut found: Vec<&str> = [margin.verdict_low, margin.verdict_high]
        .into_iter()
        .flatten()
        .map(|verdict| words.word(verdict))
        .collect();
    found.dedup();
    found.join("; ")
}

/// `gains of Y within −9 % and +4 %`; `None` where no gain flips the verdict.
fn within(margin: &Margin) -> Option<String> {
    let plural = match margin.change {
        Changed::Gain => "gains of",
        Changed::Offset => "offsets of",
        Changed::Shift => "shifts along",
        Changed::Parameter | Changed::Sections | Changed::Limit => return None,
    };
    let of = &margin.of;
    match (margin.low, margin.high) {
        (Some(low), Some(high)) => {
            Some(format!("{plural} {of} within {} and {}", end(margin, low), end(margin, high)))
        }
        (Some(low), None) => Some(format!("{plural} {of} from {}", end(margin, low))),
        (None, Some(high)) => Some(format!("{plural} {of} up to {}", end(margin, high))),
        (None, None) => None,
    }
}

/// How near the nearer end is, in steps of the search.
fn nearness(margin: &Margin) -> f64 {
    let step = margin.searched.map_or(1.0, |of| of.step);
    let ends = [margin.low, margin.high].into_iter().flatten().map(f64::abs);
    ends.fold(f64::INFINITY, f64::min) / step
}

pub fn opening(found: &MarginStudy, words: &VerdictWords) -> Opening {
    let word = words.word(found.verdict);
    let mut near: Vec<&Margin> =
        found.margin.iter().filter(|margin| within(margin).is_some()).collect();
    near.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)));
    let holds: Vec<String> = near.iter().filter_map(|margin| within(margin)).take(3).collect();
    let sentence = if holds.is_empty() {
        "No gain, offset or shift that was searched flips the verdict.".to_owned()
    } else {
        format!("The verdict stays for {}, each by itself.", holds.join("; "))
    };
    let count = found.margin.iter().filter(|margin| margin.flips()).count();
    let mut facts = vec![
        Fact::new("Verdict", word),
        Fact::new("Changes that flip it", format!("{count} of {}", found.margin.len())),
    ];
    if let Some((share, probability)) = found.probability_right.zip(found.probability.as_ref()) {
        let share = share_with(share, Some(probability.interval_95));
        facts.push(Fact::new("Probability that it is right", share));
    }
    Opening {
        headline: Finding::neutral(format!("Margin of the verdict '{word}'")),
        sentence,
        facts,
    }
}

pub fn chapters(found: &MarginStudy, words: &VerdictWords) -> Vec<Chapter> {
    let about = "One thing is changed at a time. A gain multiplies the measured channel, an offset is added to it, at all its positions together; a shift moves the measurement along the axis. The range is that within which the verdict stays as it is. Where it changes back and forth, the nearest flip on the grid counts; what lies between two points of the grid is not seen. A limit is changed alone, without limits that are shares of it.";
    let row = |margin: &Margin| -> Vec<Cell> {
        let reason = margin.reason.as_ref().map(|reason| reason.text().to_string());
        let with = match margin.change {
            Changed::Sections => margin.flips_with.join(", "),
            _ => String::new(),
        };
        let beyond = [beyond(margin, words), with, reason.unwrap_or_default()];
        let beyond: Vec<String> = beyond.into_iter().filter(|text| !text.is_empty()).collect();
        cells![
            name(margin),
            margin.as_it_is.clone().unwrap_or_default(),
            range(margin),
            beyond.join("; "),
            found_by(margin)
        ]
    };
    let caption = format!("Changes within which the verdict stays '{}'", words.word(found.verdict));
    let table = Table::new(caption)
        .text("Change")
        .breaks(NAME)
        .short("Is")
        .sparse()
        .text("Verdict stays")
        .text("Beyond")
        .text("Found")
        .rows(found.margin.iter().map(row));
    let figure = Figure::new(
        "margins",
        "The range of each change within which the verdict stays, with a triangle where it flips; gains, and limits, are drawn to the same scale, all others each to that of its search",
        "A bar for each change from where to where the verdict stays; the numbers are in the table.",
        220,
    );
    let blocks = vec![Block::text(about), figure.into(), table.into()];
    let mut chapters =
        vec![Chapter::new("margin", "Smallest changes that flip the verdict", blocks)];
    if let Some((share, probability)) = found.probability_right.zip(found.probability.as_ref()) {
        chapters.push(probable(share, probability));
    }
    chapters
}

/// Letters of a name that is not broken.
const NAME: usize = 24;

fn probable(share: f64, found: &Probability) -> Chapter {
    let says = format!(
        "The verdict is the right one with a probability of {} (95 % interval of {} draws).",
        share_with(share, Some(found.interval_95)),
        found.draws
    );
    let of = |one: &Drawn| -> Vec<Cell> {
        let standard = number::with_unit(&number::significant(one.standard, 3), &one.unit);
        let alike = if one.correlated { "one for all" } else { "one for each" };
        cells![
            one.channel,
            one.of.title().to_lowercase(),
            standard,
            alike,
            one.columns.len().to_string()
        ]
    };
    let caption = "Uncertainties that were drawn, as campaign.yaml declares them";
    let drawn = Table::new(caption)
        .name("Channel")
        .short("Error")
        .short("Standard uncertainty")
        .short("Errors")
        .number("Columns")
        .rows(found.channels.iter().map(of));
    let mut limits: Vec<&Risk> = found.limits.iter().collect();
    limits.sort_by(|a, b| b.risk.total_cmp(&a.risk));
    let of = |one: &&Risk| -> Vec<Cell> {
        let wrong = match one.risk_of {
            Wrong::FalseAcceptance => "acceptance",
            Wrong::FalseRejection => "rejection",
        };
        vec![
            Cell::symbol(&one.symbol, ""),
            super::scoped(&one.statistic, &one.scope).into(),
            Cell::number(one.value, Format::Significant(4)),
            Cell::number(one.limit, Format::Significant(4)),
            number::unit(&one.unit).into(),
            Cell::number(one.standard_uncertainty, Format::Significant(2)),
            Cell::number(one.guard_band, Format::Significant(2)),
            (if one.within_guard_band { "within" } else { "outside" }).into(),
            format!("{} ({wrong})", super::percent(one.risk)).into(),
        ]
    };
    let caption = "Every limit with the probability that its result is wrong, the largest first";
    let risks = Table::new(caption)
        .text("Quantity")
        .short("Statistic")
        .number("Value")
        .number("Limit")
        .short("Unit")
        .number("Std. uncertainty")
        .number("Guard band")
        .short("Value is")
        .number("Risk of false")
        .rows(limits.iter().map(of));
    let blocks = vec![Block::text(says), Block::text(&found.method), drawn.into(), risks.into()];
    Chapter::new("probability", "Probability that the verdict is right", blocks)
}
