//! Time and distance of a record: where they are from.

use super::channels::{ChannelMap, channel_map};
use super::reader::{Reader, hertz, metre, second};
use super::sections::Sections;
use super::stated::{self, Stated};
use crate::problem::Problem;
use crate::source::{Span, Spanned};
use crate::units::Unit;
use crate::yaml::{Key, Node, Value};

/// Largest drift of a clock: a watch crystal is below 100 ppm, and 1 % is a wrong rate.
const MOST_DRIFT: f64 = 0.01;

#[derive(Clone, Debug)]
pub struct Time {
    /// The channel; several names where the groups of a file call it differently. Empty: rate of
    /// the file.
    pub from: Vec<Spanned<String>>,
    pub unit: Option<Spanned<Unit>>,
    /// Sampling rate where there is no channel and the file states none, in Hz.
    pub rate: Option<f64>,
    /// Added to the time, in s.
    pub shift: Option<Stated>,
    /// How much the clock of the record is fast.
    pub drift: f64,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum Distance {
    Channel(ChannelMap),
    /// Integral of a speed over time.
    Speed {
        speed: ChannelMap,
        start: Option<Stated>,
    },
    /// A pulse after each length.
    Trigger {
        channel: ChannelMap,
        every: f64,
        threshold: Option<f64>,
        start: Option<Stated>,
    },
}

/// The distance is moved along the track file until channels of both agree best.
#[derive(Clone, Debug)]
pub struct Match {
    /// Column of the track file and channel of the record.
    pub channels: Vec<ChannelMap>,
    /// Largest move, in m.
    pub within: f64,
    pub span: Span,
}

pub(super) fn time(
    reader: &mut Reader<'_>,
    node: Option<&Node>,
    at: &Span,
    sections: &Sections,
) -> Time {
    let mut time = Time {
        from: Vec::new(),
        unit: None,
        rate: None,
        shift: None,
        drift: 0.0,
        span: stated::place(node, at),
    };
    let Some(node) = node else { return time };
    match &node.value {
        Value::Map(_) => {
            reader.keys(node, &["from", "unit", "rate", "shift", "drift"], "`time`");
            time.from = reader.texts(node, "from");
            time.rate = reader.number(node, "rate", &hertz());
            time.unit = reader
                .text(node, "unit")
                .and_then(|written| Some(Spanned::new(reader.unit(&written)?, written.span)));
            time.shift = node
                .get("shift")
                .and_then(|shift| stated::read(reader, shift, "shift", &second(), sections));
            time.drift = reader.number(node, "drift", &Unit::one()).unwrap_or(0.0);
            if time.drift.abs() > MOST_DRIFT {
                let at = stated::place(node.get("drift"), &node.span);
                let problem = Problem::error(
                    "out-of-range",
                    format!("a drift of {} is more than {MOST_DRIFT}", time.drift),
                )
                .at(&at);
                reader.problems.push(
                    problem.help("write it in parts per million: `50 ppm`; another rate is `rate`"),
                );
            }
            if let (Some(rate), Some(from)) = (time.rate, time.from.first()) {
                reader.fault(
                    "contradiction",
                    format!(
                        "the time is from the channel `{}`, and a rate of {rate} Hz is stated",
                        from.value
                    ),
                    &from.span,
                );
            }
            if let Some(unit) =
                time.unit.as_ref().filter(|unit| unit.value.dimension != second().dimension)
            {
                reader.fault(
                    "unit-mismatch",
                    format!(
                        "the time is in {}, which is {}",
                        unit.value,
                        unit.value.dimension.in_words()
                    ),
                    &unit.span,
                );
            }
        }
        Value::List(items) => {
            time.from = items.iter().filter_map(|item| reader.text_of(item, "time")).collect()
        }
        _ => time.from = reader.text_of(node, "time").into_iter().collect(),
    }
    time
}

const KEYS: [&str; 11] = [
    "from",
    "from speed",
    "from trigger",
    "every",
    "threshold",
    "start",
    "match",
    "unit",
    "factor",
    "offset",
    "table",
];
/// Those that the channel itself takes.
const OF_CHANNEL: [&str; 4] = ["unit", "factor", "offset", "table"];

pub(super) fn distance(
    reader: &mut Reader<'_>,
    key: &Key,
    node: &Node,
    sections: &Sections,
) -> (Option<Distance>, Option<Match>) {
    if !matches!(node.value, Value::Map(_)) {
        return (channel_map(reader, key, node).map(Distance::Channel), None);
    }
    reader.keys(node, &KEYS, "`distance`");
    let ways: Vec<&str> = KEYS[..3].iter().copied().filter(|way| node.get(way).is_some()).collect();
    let matched = node.entry("match").and_then(|(key, node)| matching(reader, key, node));
    let [way] = ways[..] else {
        let says = if ways.is_empty() {
            "`distance` does not say where it is from"
        } else {
            "`distance` is stated in several ways"
        };
        let problem =
            Problem::error(if ways.is_empty() { "key-missing" } else { "contradiction" }, says)
                .at(&node.span);
        reader.problems.push(problem.help("write one of `from`, `from speed` and `from trigger`"));
        return (None, matched);
    };
    let needs = |what: &str| if what == "start" { way != "from" } else { way == "from trigger" };
    for what in ["every", "threshold", "start"]
        .into_iter()
        .filter(|what| node.get(what).is_some() && !needs(what))
    {
        let at = stated::place(node.get(what), &node.span);
        let problem = Problem::error(
            "contradiction",
            format!("`{what}` has no meaning for a distance with `{way}`"),
        )
        .at(&at);
        reader.problems.push(if what == "start" {
            problem.help("write `offset` to add a length to the channel")
        } else {
            problem
        });
    }
    // The channel is read as any other, with the keys that it takes.
    let Some((_, from)) = node.entry(way) else { return (None, matched) };
    let own =
        node.entries().iter().filter(|(key, _)| OF_CHANNEL.contains(&key.text.as_str())).cloned();
    let from_key = Key { text: "from".into(), span: key.span.clone(), exact: false };
    let entries: Vec<(Key, Node)> = std::iter::once((from_key, from.clone())).chain(own).collect();
    let channel = Node { value: Value::Map(entries), ..node.clone() };
    let Some(channel) = channel_map(reader, key, &channel) else { return (None, matched) };
    let start = node
        .get("start")
        .and_then(|start| stated::read(reader, start, "start", &metre(), sections));
    let distance = match way {
        "from" => Some(Distance::Channel(channel)),
        "from speed" => Some(Distance::Speed { speed: channel, start }),
        _ => {
            let every = reader.number(node, "every", &metre());
            if every.is_none() && node.get("every").is_none() {
                let problem = Problem::error(
                    "key-missing",
                    "`every` is missing: the length from pulse to pulse",
                )
                .at(&node.span);
                reader.problems.push(problem.help("write `every: 0.5 m`"));
            }
            if every.is_some_and(|every| every <= 0.0) {
                reader.fault(
                    "out-of-range",
                    "the length from pulse to pulse must be above zero",
                    &stated::place(node.get("every"), &node.span),
                );
            }
            let threshold = node.get("threshold").and_then(|node| match node.number() {
                Some(number) => Some(number),
                None => {
                    reader.fault(
                        "wrong-kind",
                        "`threshold` must be a number in the unit of the file",
                        &node.span,
                    );
                    None
                }
            });
            every.map(|every| Distance::Trigger { channel, every, threshold, start })
        }
    };
    (distance, matched)
}

fn matching(reader: &mut Reader<'_>, key: &Key, node: &Node) -> Option<Match> {
    if !matches!(node.value, Value::Map(_)) {
        let problem = Problem::error(
            "wrong-kind",
            format!("`match` must be a map, not {}", node.kind_in_words()),
        )
        .at(&node.span);
        reader.problems.push(problem.help("write `match: {curvature: NAME, within: 20 m}`: a column of the track file and a channel"));
        return None;
    }
    let own: Vec<ChannelMap> = node
        .entries()
        .iter()
        .filter(|(key, _)| key.text != "within")
        .filter_map(|(key, node)| channel_map(reader, key, node))
        .collect();
    let within = reader.number(node, "within", &metre());
    if own.is_empty() || node.get("within").is_none() {
        let problem = Problem::error(
            "key-missing",
            "`match` needs a column of the track file with its channel, and `within`",
        )
        .at(&key.span);
        reader.problems.push(problem.help("write `match: {curvature: NAME, within: 20 m}`"));
    }
    within.filter(|_| !own.is_empty()).map(|within| Match {
        channels: own,
        within,
        span: key.span.clone(),
    })
}
