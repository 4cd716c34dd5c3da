//! Reads the `diagnosis` part of a catalogue.

use super::{
    Discrepancy, FeatureKind, GroupFeatures, INVERSE, Moves, Over, Position, Response, Settings,
    Shape, Times, Tolerance,
};
use crate::diagnose::levels::settings::{FALSE_NAMES, FURTHEST};
use crate::effects::Catalogue;
use crate::problem::{Problem, Problems};
use crate::source::Span;
use crate::units::Unit;
use crate::yaml::{Key, Node, Value};

const TOP: [&str; 15] = [
    "bands",
    "alike",
    "furthest lag",
    "groups",
    "tolerances",
    "discrepancies",
    "response error",
    "false name rate",
    "confine to",
    "covariates",
    "mirrored",
    "strata",
    "positions",
    "invariants",
    "shape",
];
const GROUP: [&str; 14] = [
    "level", "bands", "alike", "samples", "level sd", "band sd", "gain sd", "lag sd", "noise",
    "offset", "gain", "axis", "says", "unit",
];
const SHAPE: [&str; 3] = ["range", "percentile", "wheel radius"];
const TOLERANCE: [&str; 9] =
    ["default", "unit", "expected", "scales", "adds", "sets", "each section", "shared", "besides"];
const RESPONSE: [&str; 4] = ["levels", "others", "groups", "common"];
const DISCREPANCY: [&str; 7] = ["of", "channels", "sd", "together", "sections", "times", "means"];

impl Settings {
    /// Reads the settings. A catalogue without them cannot be used for a diagnosis.
    ///
    /// Problems: `key-missing`, `unknown-key`, `wrong-kind`, `range`, `unknown-channel`.
    pub fn read(catalogue: &Catalogue, problems: &mut Problems) -> Option<Self> {
        let before = problems.errors();
        let Some(node) = &catalogue.diagnosis else {
            let says = format!(
                "the catalogue `{}` has no part `diagnosis`, which lists the features to be compared",
                catalogue.name
            );
            problems.push(Problem::error("key-missing", says).at(&catalogue.source.span(0..0)));
            return None;
        };
        let mut reader = Reader { catalogue, problems };
        let settings = reader.settings(node);
        (problems.errors() == before).then_some(settings)
    }
}

struct Reader<'a> {
    catalogue: &'a Catalogue,
    problems: &'a mut Problems,
}

impl Reader<'_> {
    fn wrong(&mut self, says: impl Into<String>, at: &Node) {
        self.problems.push(Problem::error("wrong-kind", says).at(&at.span));
    }

    fn outside(&mut self, says: impl Into<String>, at: &Node) {
        self.problems.push(Problem::error("range", says).at(&at.span));
    }

    fn keys(&mut self, node: &Node, known: &[&str]) {
        for (key, _) in node.entries() {
            if !known.contains(&key.text.as_str()) {
                let problem =
                    Problem::error("unknown-key", format!("there is no key `{}` here", key.text))
                        .at(&key.span);
                self.problems.push(problem.suggest(&key.text, known.iter().copied()));
            }
        }
    }

    fn numbers(&mut self, node: &Node) -> Vec<f64> {
        if let Some(number) = node.number() {
            return vec![number];
        }
        let numbers: Option<Vec<f64>> = node.items().iter().map(Node::number).collect();
        numbers.unwrap_or_else(|| {
            self.wrong("expected a number or a list of numbers", node);
            Vec::new()
        })
    }

    fn number(&mut self, node: &Node, key: &str, default: f64) -> f64 {
        match node.get(key) {
            None => default,
            Some(found) => found.number().unwrap_or_else(|| {
                self.wrong(format!("`{key}` must be a number"), found);
                default
            }),
        }
    }

    /// The largest lag searched.
    fn furthest(&mut self, node: &Node) -> f64 {
        let furthest = self.number(node, "furthest lag", FURTHEST);
        if let Some(found) = node.get("furthest lag").filter(|_| furthest <= 0.0) {
            self.outside("`furthest lag` is a distance or a time and must be positive", found);
        }
        furthest
    }

    /// A standard deviation.
    fn spread(&mut self, node: &Node, key: &str, default: f64) -> f64 {
        let spread = self.number(node, key, default);
        if let Some(found) = node.get(key).filter(|_| spread < 0.0) {
            self.outside(format!("`{key}` is a standard deviation and cannot be negative"), found);
        }
        spread
    }

    /// Strictly increasing frequencies in Hz.
    fn rising(&mut self, node: &Node) -> Vec<f64> {
        let found = self.numbers(node);
        if found.first().is_some_and(|first| *first < 0.0)
            || found.windows(2).any(|pair| pair[1] <= pair[0])
        {
            self.outside("frequencies in Hz must increase", node);
        }
        found
    }

    fn flag(&mut self, node: &Node, key: &str) -> bool {
        match node.get(key) {
            None => false,
            Some(Node { value: Value::Bool(flag), .. }) => *flag,
            Some(found) => {
                self.wrong(format!("`{key}` must be true or false"), found);
                false
            }
        }
    }

    fn unit(&mut self, node: &Node) -> Unit {
        let Some(found) = node.get("unit") else { return Unit::one() };
        found.scalar_text().and_then(|text| Unit::parse(text).ok()).unwrap_or_else(|| {
            self.wrong("`unit` must be a unit such as kN or mm", found);
            Unit::one()
        })
    }

    /// A name or a list of names.
    fn words(&mut self, node: Option<&Node>) -> Vec<String> {
        self.placed(node).into_iter().map(|(word, _)| word).collect()
    }

    fn placed(&mut self, node: Option<&Node>) -> Vec<(String, Span)> {
        let Some(node) = node else { return Vec::new() };
        let items = match &node.value {
            Value::List(items) => items.as_slice(),
            _ => std::slice::from_ref(node),
        };
        let mut found = Vec::new();
        for item in items {
            match item.scalar_text() {
                Some(text) => found.push((text.to_string(), item.span.clone())),
                None => self.wrong(
                    format!("expected a name or a list of names, found {}", item.kind_in_words()),
                    item,
                ),
            }
        }
        found
    }

    fn channels(&mut self, node: &Node) -> Vec<String> {
        let mut found = Vec::new();
        for name in self.words(Some(node)) {
            match self.catalogue.channels(&name) {
                Some(channels) => found.extend(channels),
                None => {
                    let problem = Problem::error(
                        "unknown-channel",
                        format!("`{name}` is neither a group nor a channel of a group"),
                    )
                    .at(&node.span);
                    self.problems.push(problem.suggest(
                        &name,
                        self.catalogue.groups.iter().map(|group| group.name.as_str()),
                    ));
                }
            }
        }
        found
    }

    /// The column whose value says that a section is mirrored, and that value.
    fn mirror(&mut self, node: Option<&Node>) -> Option<(Key, String)> {
        let node = node?;
        let only = match node.entries() {
            [(column, value)] => {
                value.scalar_text().map(|value| (column.clone(), value.to_string()))
            }
            _ => None,
        };
        if only.is_none() {
            self.wrong(
                "`mirrored` must be one column and its value, such as `{direction: left}`",
                node,
            );
        }
        only
    }

    /// A map of numbers.
    fn values(&mut self, node: &Node) -> Vec<(String, f64)> {
        let mut found = Vec::new();
        for (key, node) in node.entries() {
            match node.number() {
                Some(value) => found.push((key.text.clone(), value)),
                None => self.wrong(format!("`{}` needs a number", key.text), node),
            }
        }
        found
    }

    /// Channels with their weights.
    fn weights(&mut self, node: &Node) -> Vec<(String, f64)> {
        for (key, _) in node.entries() {
            if !self.catalogue.groups.iter().any(|group| group.channels.contains(&key.text)) {
                let problem = Problem::error(
                    "unknown-channel",
                    format!("`{}` is not a channel of a group", key.text),
                )
                .at(&key.span);
                let known = self.catalogue.groups.iter().flat_map(|group| &group.channels);
                self.problems.push(problem.suggest(&key.text, known.map(String::as_str)));
            }
        }
        self.values(node)
    }

    fn response(&mut self, node: &Node) -> Response {
        self.keys(node, &RESPONSE);
        let usual = Response::default();
        let [levels, others, groups] =
            [("levels", usual.levels), ("others", usual.others), ("groups", usual.groups)]
                .map(|(key, usual)| self.spread(node, key, usual));
        let common = self.spread(node, "common", levels.max(others).max(groups));
        Response { levels, others, groups, common }
    }

    fn false_name_rate(&mut self, node: &Node) -> f64 {
        let rate = self.number(node, "false name rate", FALSE_NAMES);
        if let Some(found) = node.get("false name rate").filter(|_| !(rate > 0.0 && rate < 1.0)) {
            self.outside("`false name rate` is a share above 0 and below 1", found);
        }
        rate
    }

    fn settings(&mut self, node: &Node) -> Settings {
        self.keys(node, &TOP);
        let alike = node.get("alike").map_or(Vec::new(), |alike| self.rising(alike));
        if let Some(found) = node.get("alike").filter(|_| alike.len() != 2) {
            self.outside("`alike` must be two frequencies in Hz", found);
        }
        let (strata, confine, covariates) = (
            self.placed(node.get("strata")),
            self.placed(node.get("confine to")),
            self.placed(node.get("covariates")),
        );
        let mirror = self.mirror(node.get("mirrored"));
        let inverse = |name: &str| name.strip_prefix(INVERSE).unwrap_or(name).to_string();
        let columns = [&strata, &confine, &covariates]
            .into_iter()
            .flatten()
            .map(|(name, span)| (inverse(name), span.clone()));
        let columns = columns
            .chain(mirror.iter().map(|(key, _)| (key.text.clone(), key.span.clone())))
            .collect();
        let names = |placed: Vec<(String, Span)>| {
            placed.into_iter().map(|(name, _)| name).collect::<Vec<_>>()
        };
        let mut settings = Settings {
            edges: node.get("bands").map_or(Vec::new(), |bands| self.rising(bands)),
            alike: (alike.first().copied().unwrap_or(0.5), alike.get(1).copied().unwrap_or(8.0)),
            furthest: self.furthest(node),
            response: node
                .get("response error")
                .map_or_else(Response::default, |node| self.response(node)),
            false_name_rate: self.false_name_rate(node),
            confine: names(confine),
            covariates: names(covariates),
            mirror: mirror.map(|(key, value)| (key.text, value)),
            stratum: names(strata).into_iter().next(),
            columns,
            ..Settings::default()
        };
        for (key, node) in node.get("groups").map_or(&[][..], Node::entries) {
            self.keys(node, &GROUP);
            if self.catalogue.group(&key.text).is_none() {
                let problem =
                    Problem::error("unknown-channel", format!("there is no group `{}`", key.text))
                        .at(&key.span);
                self.problems.push(problem.suggest(
                    &key.text,
                    self.catalogue.groups.iter().map(|group| group.name.as_str()),
                ));
                continue;
            }
            let text = |key: &str| node.get(key).and_then(Node::scalar_text).map(str::to_string);
            let (bands, most) =
                (self.number(node, "bands", 0.0), settings.edges.len().saturating_sub(1));
            if let Some(found) = node
                .get("bands")
                .filter(|_| bands.fract() != 0.0 || !(0.0..=most as f64).contains(&bands))
            {
                self.outside(format!("`bands` is the number of bands of this group, at most the {most} bands of the catalogue"), found);
            }
            settings.groups.push(GroupFeatures {
                name: key.text.clone(),
                level: self.flag(node, "level"),
                bands: bands as usize,
                alike: self.flag(node, "alike"),
                samples: self.flag(node, "samples"),
                level_sd: self.spread(node, "level sd", 0.1),
                band_sd: self.spread(node, "band sd", 0.1),
                gain_sd: self.spread(node, "gain sd", 0.1),
                lag_sd: self.spread(node, "lag sd", 1.0),
                unit: self.unit(node),
                noise: text("noise"),
                offset: text("offset"),
                gain: text("gain"),
                axis: text("axis").unwrap_or_default(),
                says: text("says").unwrap_or_else(|| key.text.clone()),
            });
        }
        for (key, node) in node.get("tolerances").map_or(&[][..], Node::entries) {
            self.keys(node, &TOLERANCE);
            let mut map = |key: &str| node.get(key).map_or_else(Vec::new, |node| self.values(node));
            let (adds, sets) = (map("adds"), map("sets"));
            let per_section = self.flag(node, "each section");
            let shared = self.spread(node, "shared", if per_section { 0.0 } else { 1.0 });
            if let Some(found) = node.get("shared").filter(|_| shared > 1.0) {
                self.outside("`shared` is the share of a standard deviation common to all sections, from 0 to 1", found);
            }
            settings.tolerances.push(Tolerance {
                name: key.text.clone(),
                unit: self.unit(node),
                default: self.spread(node, "default", 0.0),
                expected: self.number(node, "expected", 0.0),
                scales: self.words(node.get("scales")),
                adds,
                sets,
                named: named(node),
                per_section,
                shared,
                besides: self.spread(node, "besides", 0.0),
            });
        }
        for node in node.get("discrepancies").map_or(&[][..], Node::items) {
            if let Some(discrepancy) =
                self.discrepancy(node, settings.edges.len().saturating_sub(1))
            {
                settings.discrepancies.push(discrepancy);
            }
        }
        for (key, node) in node.get("invariants").map_or(&[][..], Node::entries) {
            let weights = self.weights(node);
            settings.invariants.push((key.text.clone(), weights));
        }
        for (key, node) in node.get("positions").map_or(&[][..], Node::entries) {
            let (straight, mirrored) = match (node.get("channels"), node.get("mirrored")) {
                (Some(channels), Some(mirrored)) => {
                    (self.channels(channels), self.channels(mirrored))
                }
                (Some(channels), None) => (self.channels(channels), self.channels(channels)),
                (None, None) if node.entries().is_empty() => {
                    (self.channels(node), self.channels(node))
                }
                (None, _) => {
                    let says = format!("the position `{}` needs `channels`", key.text);
                    self.problems.push(Problem::error("key-missing", says).at(&node.span));
                    continue;
                }
            };
            settings.positions.push(Position { name: key.text.clone(), straight, mirrored });
        }
        settings.shape = node.get("shape").and_then(|node| self.shape(node));
        settings
    }

    fn shape(&mut self, node: &Node) -> Option<Shape> {
        self.keys(node, &SHAPE);
        let percentile = self.number(node, "percentile", f64::NAN);
        let [low, high] = node.get("range").map(|range| self.numbers(range))?[..] else {
            self.wrong("`range` must be two frequencies in Hz", node);
            return None;
        };
        if !(low > 0.0 && high > low && (50.0..100.0).contains(&percentile)) {
            self.wrong("`range` must be two increasing frequencies in Hz, and `percentile` a number from 50 to 100", node);
            return None;
        }
        let wheel_radius = node.get("wheel radius").and_then(Node::scalar_text).map(str::to_string);
        Some(Shape { range: (low, high), percentile, wheel_radius })
    }

    /// Reads a discrepancy; `bands` is the number of bands.
    fn discrepancy(&mut self, node: &Node, bands: usize) -> Option<Discrepancy> {
        self.keys(node, &DISCREPANCY);
        let word =
            |key: &str| node.get(key).and_then(Node::scalar_text).unwrap_or_default().to_string();
        let feature = match word("of").as_str() {
            "level" => FeatureKind::Level,
            "bands" => FeatureKind::Bands,
            "amplitude" => FeatureKind::Amplitude,
            "gain" => FeatureKind::Gain,
            "lag" => FeatureKind::Lag,
            other => {
                self.wrong(
                    format!("`of` must be level, bands, amplitude, gain or lag, not `{other}`"),
                    node,
                );
                return None;
            }
        };
        let Some(channels) = node.get("channels") else {
            self.problems.push(
                Problem::error(
                    "key-missing",
                    "a discrepancy needs `channels`: groups, or channels with weights",
                )
                .at(&node.span),
            );
            return None;
        };
        let channels = if channels.entries().is_empty() {
            self.channels(channels).into_iter().map(|channel| (channel, 1.0)).collect()
        } else {
            self.weights(channels)
        };
        let moves = match word("together").as_str() {
            "" | "all" => Moves::All,
            "group" => Moves::Group,
            "channel" => Moves::Channel,
            other => {
                self.wrong(
                    format!("`together` must be all, group or channel, not `{other}`"),
                    node,
                );
                return None;
            }
        };
        let over = match word("sections").as_str() {
            "" | "all" => Over::All,
            "strata" => Over::Strata,
            "each" => Over::Sections,
            other => {
                self.wrong(format!("`sections` must be all, strata or each, not `{other}`"), node);
                return None;
            }
        };
        let times = word("times");
        let radius = times
            .split_once(" / radius")
            .and_then(|(number, sign)| Some((number.trim().parse::<f64>().ok()?, sign)));
        let times = match radius.filter(|(number, _)| number.is_finite()) {
            _ if times.is_empty() => Times::One,
            _ if times == "side" => Times::Side,
            Some((number, "")) => Times::Over(number),
            Some((number, " unsigned")) => Times::Unsigned(number),
            _ => {
                self.wrong(
                    format!("`times` must be side, `400 / radius` or `400 / radius unsigned`, not `{times}`"),
                    node.get("times").unwrap_or(node),
                );
                return None;
            }
        };
        let Some(given) = node.get("sd") else {
            self.problems.push(
                Problem::error("key-missing", "a discrepancy needs `sd`, its standard deviation")
                    .at(&node.span),
            );
            return None;
        };
        let sd = self.numbers(given);
        let most = if feature == FeatureKind::Bands { bands } else { 1 };
        if sd.is_empty() || sd.len() > most || sd.iter().any(|sd| *sd < 0.0) {
            let many = if most == 1 {
                "one number".to_string()
            } else {
                format!("one number, or one for each of the {most} bands")
            };
            self.outside(format!("`sd` must be {many}, none of them negative"), given);
        }
        Some(Discrepancy { feature, channels, sd, moves, over, times })
    }
}

/// The parameters that a tolerance changes.
fn named(node: &Node) -> Vec<(String, Span)> {
    let maps = ["adds", "sets"].into_iter().filter_map(|key| node.get(key)).flat_map(Node::entries);
    let maps = maps.map(|(key, _)| (key.text.clone(), key.span.clone()));
    let scaled = node.get("scales").into_iter().flat_map(Node::items);
    scaled
        .filter_map(|item| Some((item.scalar_text()?.to_string(), item.span.clone())))
        .chain(maps)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    const SOUND: &str = "catalogue: one
title: One
groups: {forces: [F]}
units: {forces: N}
effects: {}
diagnosis:
  bands: [1, 2, 4]
  groups: {forces: {unit: N, level: true, bands: 2, level sd: 0.2}}
  tolerances: {load: {default: 0.1, adds: {mass: 1}}}
  discrepancies: [{of: bands, channels: [forces], sd: [0.1, 0.2], times: 400 / radius}]
";

    fn read(text: &str) -> (bool, Problems) {
        let (source, mut problems) = (Source::new("effects.yaml", text), Problems::default());
        let catalogue =
            crate::effects::read(&source, &crate::library::parent_catalogue, &[], &mut problems)
                .expect("a catalogue");
        (Settings::read(&catalogue, &mut problems).is_some(), problems)
    }

    #[test]
    fn numbers_that_cannot_be_are_told_where_they_are() {
        let (sound, problems) = read(SOUND);
        assert!(sound, "{}", problems.render(false));
        for (good, bad, says, place) in [
            ("[1, 2, 4]", "[1, 4, 2]", "must increase", "7:10"),
            ("bands: 2,", "bands: 3,", "at most the 2 bands", "8:50"),
            ("bands: 2,", "bands: 1.5,", "at most the 2 bands", "8:50"),
            ("level sd: 0.2", "level sd: -0.2", "cannot be negative", "8:63"),
            ("default: 0.1", "default: -0.1", "cannot be negative", "9:32"),
            ("default: 0.1", "default: 0.1, shared: 1.5", "from 0 to 1", "9:45"),
            ("default: 0.1", "default: 0.1, besides: -1", "cannot be negative", "9:46"),
            ("mass: 1", "mass: much", "`mass` needs a number", "9:50"),
            ("sd: [0.1, 0.2]", "sd: [0.1, 0.2, 0.3]", "one for each of the 2 bands", "10:55"),
            ("sd: [0.1, 0.2]", "sd: [0.1, -0.2]", "none of them negative", "10:55"),
            ("sd: [0.1, 0.2], ", "", "needs `sd`", "10:19"),
            ("400 / radius", "much / radius", "not `much / radius`", "10:74"),
            ("channels: [forces], ", "", "needs `channels`", "10:19"),
            ("sd: [0.1, 0.2]", "sd: []", "none of them negative", "10:55"),
            ("[1, 2, 4]\n", "[1, 2, 4]\n  alike: [8]\n", "`alike` must be two", "8:10"),
            ("[1, 2, 4]\n", "[1, 2, 4]\n  furthest lag: -5\n", "must be positive", "8:17"),
            ("[1, 2, 4]\n", "[1, 2, 4]\n  false name rate: 4\n", "above 0 and below 1", "8:20"),
        ] {
            let text = SOUND.replacen(good, bad, 1);
            assert_ne!(text, SOUND);
            let (sound, problems) = read(&text);
            let told = problems.render(false);
            assert!(
                !sound && told.contains(says) && told.contains(&format!("effects.yaml:{place}\n")),
                "{bad}: {told}"
            );
        }
    }
}
