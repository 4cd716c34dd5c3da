//! Time and distance of a record: where they are from.

use super::channels::ChannelMap;
use super::sections::Sections;
use super::stated::Stated;
use crate::problem::{Problem, error};
use crate::source::{Span, Spanned};
use crate::units::{Dimension, Unit};
use crate::yaml::{
    Entries, FromNode, Hertz, Key, Metres, Node, OneOrMore, Ratio, Reader, Seconds, Value, Words,
    fields, span_of_value,
};

/// Largest drift of a clock: a watch crystal is below 100 ppm, and 1 % is a wrong rate.
const MOST_DRIFT: f64 = 0.01;

fields! {
    /// Where the time of a record is from.
    pub struct Time in &Sections: "`time`" {
        /// The channel; several names where the groups of a file call it differently. Empty: rate
        /// of the file.
        "from" from: OneOrMore<Spanned<String>>,
        "unit" unit: Option<Spanned<Unit>>,
        /// Sampling rate where there is no channel and the file states none.
        "rate" rate: Option<Hertz>,
        /// Added to the time.
        "shift" shift: Option<Stated<Seconds>>,
        /// When the tables of a file start, each by its name, where the file does not state it.
        "starts" starts: Entries<Seconds>,
        /// How much the clock of the record is fast.
        "drift" drift: Ratio = Ratio(0.0),
    } also {
        span: Span = span_of_value,
    }
}

#[derive(Clone, Debug)]
pub enum Distance {
    Channel(ChannelMap),
    /// Integral of a speed over time.
    Speed {
        speed: ChannelMap,
        start: Option<Stated<Metres>>,
    },
    /// A pulse after each length.
    Trigger {
        channel: ChannelMap,
        every: f64,
        threshold: Option<f64>,
        start: Option<Stated<Metres>>,
    },
}

impl Distance {
    /// The channel that it is made of.
    pub fn channel(&self) -> &ChannelMap {
        match self {
            Self::Channel(channel)
            | Self::Speed { speed: channel, .. }
            | Self::Trigger { channel, .. } => channel,
        }
    }
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

impl Time {
    /// A time of which the file says all.
    pub(super) fn from_file(from: Vec<Spanned<String>>, span: Span) -> Self {
        let from = OneOrMore(from);
        let (unit, rate, shift, starts) = (None, None, None, Entries(Vec::new()));
        Self { from, unit, rate, shift, starts, drift: Ratio(0.0), span }
    }
}

/// `time: NAME`, a list of names, or a map with more.
#[derive(Clone, Debug)]
pub struct SideTime(pub Time);

impl FromNode<&Sections> for SideTime {
    fn from_node(reader: &mut Reader<'_, &Sections>, key: &Key, node: &Node) -> Option<Self> {
        if !matches!(node.value, Value::Map(_)) {
            let OneOrMore(names) = OneOrMore::from_node(reader, key, node)?;
            return Some(Self(Time::from_file(names, node.span.clone())));
        }
        let time = Time::from_node(reader, key, node)?;
        let Ratio(drift) = time.drift;
        if drift.abs() > MOST_DRIFT {
            let says = format!("a drift of {drift} is more than {MOST_DRIFT}");
            let problem = error("out-of-range", says, node.span_of("drift"));
            reader.tell(
                problem.help("write it in parts per million: `50 ppm`; another rate is `rate`"),
            );
        }
        if let (Some(Hertz(rate)), Some(from)) = (time.rate, time.from.0.first()) {
            let says = format!(
                "the time is from the channel `{}`, and a rate of {rate} Hz is stated",
                from.value
            );
            reader.fault("contradiction", says, &from.span);
        }
        if let (Some((start, _)), Some(from)) = (time.starts.0.first(), time.from.0.first()) {
            let says = format!(
                "the time is from the channel `{}`, and starts of tables are stated",
                from.value
            );
            reader.fault("contradiction", says, &start.span);
        }
        if let Some(Spanned { value: unit, span }) = &time.unit
            && unit.dimension != Dimension::TIME
        {
            let says = format!("the time is in {unit}, which is {}", unit.dimension.in_words());
            reader.fault("unit-mismatch", says, span);
        }
        Some(Self(time))
    }
}

fields! {
    /// A distance of which more is stated than its name in the file.
    struct Written in &Sections: "`distance`" {
        "from" from: Option<Node>,
        "from speed" from_speed: Option<Node>,
        "from trigger" from_trigger: Option<Node>,
        "every" every: Option<Spanned<Metres>>,
        "threshold" threshold: Option<f64>,
        "start" start: Option<Stated<Metres>>,
        "match" matched: Option<Match>,
        /// What is done where the distance jumps, as kilometre posts do.
        "jumps" jumps: Option<Spanned<Jumps>>,
        "unit" unit: Option<Node>,
        "factor" factor: Option<Node>,
        "offset" offset: Option<Node>,
        "table" table: Option<Node>,
    }
}

/// Keys that the channel itself takes.
const OF_CHANNEL: [&str; 4] = ["unit", "factor", "offset", "table"];

/// What is done where a distance jumps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jumps {
    /// It goes on from the sample before.
    RunOn,
}

impl Words for Jumps {
    const WORDS: &'static [(&'static str, Self)] = &[("run on", Self::RunOn)];
}

/// The distance, its match with the track file, and what is done where it jumps.
#[derive(Clone, Debug, Default)]
pub struct SideDistance(pub Option<Distance>, pub Option<Match>, pub Option<Jumps>);

impl FromNode<&Sections> for SideDistance {
    fn from_node(reader: &mut Reader<'_, &Sections>, key: &Key, node: &Node) -> Option<Self> {
        if !matches!(node.value, Value::Map(_)) {
            let channel = ChannelMap::from_node(reader, key, node);
            return Some(Self(channel.map(Distance::Channel), None, None));
        }
        let written = Written::from_node(reader, key, node)?;
        let jumps = written.jumps.as_ref().map(|jumps| jumps.value);
        Some(Self(way(reader, key, node, &written), written.matched, jumps))
    }
}

fn way(
    reader: &mut Reader<'_, &Sections>,
    key: &Key,
    node: &Node,
    written: &Written,
) -> Option<Distance> {
    let Written { every, threshold, start, .. } = written;
    let ways: Vec<&str> =
        Written::KEYS[..3].iter().copied().filter(|way| node.get(way).is_some()).collect();
    let [way] = ways[..] else {
        let (code, says) = match ways.is_empty() {
            true => ("key-missing", "`distance` does not say where it is from"),
            false => ("contradiction", "`distance` is stated in several ways"),
        };
        let problem = error(code, says, &node.span);
        reader.tell(problem.help("write one of `from`, `from speed` and `from trigger`"));
        return None;
    };
    for (what, belongs) in [
        ("every", way == "from trigger"),
        ("threshold", way == "from trigger"),
        ("start", way != "from"),
        ("jumps", way == "from"),
    ] {
        if let Some(other) = node.get(what).filter(|_| !belongs) {
            let says = format!("`{what}` has no meaning for a distance with `{way}`");
            let help = "write `offset` to add a length to the channel".to_string();
            let problem = error("contradiction", says, &other.span);
            reader.tell(Problem { help: (what == "start").then_some(help), ..problem });
        }
    }
    // The channel is read as any other, with the keys that it takes.
    let own =
        node.entries().iter().filter(|(key, _)| OF_CHANNEL.contains(&key.text.as_str())).cloned();
    let from = Key { text: "from".into(), span: key.span.clone(), exact: false };
    let entries = std::iter::once((from, node.get(way)?.clone())).chain(own).collect();
    let channel = Node { value: Value::Map(entries), ..node.clone() };
    let channel = ChannelMap::from_node(reader, key, &channel)?;
    let start = start.clone();
    match way {
        "from" => return Some(Distance::Channel(channel)),
        "from speed" => return Some(Distance::Speed { speed: channel, start }),
        _ => {}
    }
    if node.get("every").is_none() {
        let says = "`every` is missing: the length from pulse to pulse";
        let problem = error("key-missing", says, &node.span);
        reader.tell(problem.help("write `every: 0.5 m`"));
    }
    let Spanned { value: Metres(every), span } = every.as_ref()?;
    if *every <= 0.0 {
        reader.fault("out-of-range", "the length from pulse to pulse must be above zero", span);
    }
    Some(Distance::Trigger { channel, every: *every, threshold: *threshold, start })
}

/// `match: {curvature: NAME, within: 20 m}`
impl<C> FromNode<C> for Match {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        const HELP: &str = "write `match: {curvature: NAME, within: 20 m}`: a column of the track file and a channel";
        if !matches!(node.value, Value::Map(_)) {
            reader.tell(node.is_not("`match`", "a map").help(HELP));
            return None;
        }
        let channels = node.entries().iter().filter(|(key, _)| key.text != "within");
        let channels: Vec<ChannelMap> =
            channels.filter_map(|(key, node)| ChannelMap::from_node(reader, key, node)).collect();
        let within: Option<Metres> = reader.optional(node, "within");
        if channels.is_empty() || node.get("within").is_none() {
            let says = "`match` needs a column of the track file with its channel, and `within`";
            reader.tell(error("key-missing", says, &key.span).help(HELP));
        }
        let Metres(within) = within.filter(|_| !channels.is_empty())?;
        Some(Self { channels, within, span: key.span.clone() })
    }
}
