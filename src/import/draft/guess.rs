//! Which channel of the protocol a channel of a file may be: by name, and by what is in it.

use indexmap::IndexSet;

use super::look::{Look, short};
use super::names::{Names, all_channels};
use crate::import::mapping::{Common, Convention};
use crate::run::needs::ChannelNeed;
use crate::units::{Dimension, Unit};

/// A channel of the protocol with what was found for it.
#[derive(Debug, PartialEq)]
pub struct Guess {
    pub channel: String,
    /// The foreign channel; `None` where a person must decide.
    pub from: Option<String>,
    /// Foreign channels that a person may choose.
    pub candidates: Vec<String>,
    /// Reasons and figures, one comment each.
    pub reasons: Vec<String>,
}

/// A mean this many standard deviations from zero is a load and not a vibration.
const STEADY: f64 = 3.0;
/// The products of means of opposite sign are together so many times those of equal sign where the
/// leading wheelsets decide. In the practice campaigns they are 20 to 40 times as large in curves
/// below 600 m, and about as large in wide curves, which decide nothing.
const CLEARLY: f64 = 4.0;
/// A mean this share above the median of its group is told.
const ABOVE: f64 = 1.03;

/// Letters and digits in lower case; `*` stands for a derivative and is kept.
fn plain(name: &str) -> String {
    name.to_lowercase()
        .chars()
        .filter(|letter| letter.is_alphanumeric() || *letter == '*')
        .collect()
}

/// Whether a foreign name is known for a channel.
fn is_name_of(convention: &Convention, foreign: &str, channel: &str) -> bool {
    let foreign = plain(foreign);
    let known = convention
        .names
        .0
        .iter()
        .find(|(name, _)| name.text == channel)
        .map_or(&[][..], |(_, others)| &others.0);
    plain(channel) == foreign || known.iter().any(|other| plain(other) == foreign)
}

/// The channels of a file, with what their names say.
#[derive(Clone, Copy, Debug)]
pub struct Named<'a> {
    pub looks: &'a [Look],
    pub convention: &'a Convention,
    pub names: &'a Names,
}

impl<'a> Named<'a> {
    /// The foreign channels whose name stands for a channel, and those whose name may stand for
    /// another one as well.
    fn of(&self, channel: &str) -> [Vec<&'a Look>; 2] {
        let whole = |look: &&Look| is_name_of(self.convention, &look.name, channel);
        let whole: Vec<&Look> = self.looks.iter().filter(whole).collect();
        if !whole.is_empty() {
            return [whole, Vec::new()];
        }
        let found = self.names.of(channel);
        [true, false].map(|sure| {
            found.iter().filter(|of| of.1 == sure).map(|(at, _)| &self.looks[*at]).collect()
        })
    }

    /// The channels of the convention.
    fn channels(&self) -> IndexSet<String> {
        let whole = self.convention.names.0.iter().map(|(name, _)| name.text.clone());
        whole.chain(all_channels(self.convention)).collect()
    }

    /// Whether the name of a channel is read by an order of digits.
    fn by_digits(&self, look: &Look) -> bool {
        let at = self.looks.iter().position(|other| std::ptr::eq(other, look));
        at.is_some_and(|at| self.names.is_by_digits(at))
    }

    /// The orders of digits that names may be read by.
    fn orders(&self) -> Vec<&'a str> {
        let orders = self.names.orders.iter();
        orders.map(|&at| self.convention.orders[at].title.as_str()).collect()
    }
}

/// The foreign channels that carry a whole name of an axis.
fn named<'a>(looks: &'a [Look], convention: &Convention, axis: &str) -> Vec<&'a Look> {
    looks.iter().filter(|look| is_name_of(convention, &look.name, axis)).collect()
}

/// The channel of time or distance: by name, else by content.
pub fn axis<'a>(
    looks: &'a [Look],
    convention: &Convention,
    name: &str,
    dimension: Dimension,
) -> (Option<&'a Look>, String) {
    let fits = |look: &&&Look| look.unit.as_ref().is_some_and(|unit| unit.dimension == dimension);
    let named = named(looks, convention, name);
    if let [one, ..] = named.iter().filter(fits).collect::<Vec<_>>()[..] {
        let content = match (one.increases, one.even) {
            (true, true) => "increases in even steps",
            (true, false) => "increases",
            (false, _) => "BUT does not increase",
        };
        return (Some(one), format!("by name; {content}"));
    }
    // A text without units: the name says what it may be, and the unit is left open.
    let without = |look: &&&Look| look.unit_text.is_empty() && look.increases;
    if let Some(one) = named.iter().find(without) {
        let even = if one.even { " in even steps" } else { "" };
        return (Some(one), format!("by name; increases{even}"));
    }
    let content: Vec<&Look> =
        looks.iter().filter(|look| fits(&look)).filter(|look| look.increases).collect();
    match content[..] {
        [one] => (Some(one), format!("by content: the only {} that increases", words(dimension))),
        _ => (None, String::new()),
    }
}

/// The channel of the speed.
pub fn speed<'a>(looks: &'a [Look], convention: &Convention) -> (Option<&'a Look>, String) {
    let speed = Dimension::LENGTH / Dimension::TIME;
    let all: Vec<&Look> = looks
        .iter()
        .filter(|look| look.unit.as_ref().is_some_and(|unit| unit.dimension == speed))
        .collect();
    let without = || {
        looks
            .iter()
            .find(|look| look.unit_text.is_empty() && is_name_of(convention, &look.name, "speed"))
    };
    let by_name = all.iter().copied().find(|look| is_name_of(convention, &look.name, "speed"));
    match (by_name.or_else(without), &all[..]) {
        (Some(one), _) => (Some(one), "by name".into()),
        (None, [one]) => (Some(one), "by content: the only speed".into()),
        _ => (None, String::new()),
    }
}

fn words(dimension: Dimension) -> String {
    dimension.in_words().split_once(' ').map_or_else(String::new, |(_, word)| word.to_string())
}

/// The mean that steady channels of a group have in common.
struct CommonMean {
    /// Median of the means in SI.
    median: f64,
    /// Number of channels near it.
    near: usize,
}

impl CommonMean {
    /// `None` if fewer channels than the group has are near the median.
    fn new(looks: &[Look], dimension: Dimension, group: &Common) -> Option<Self> {
        let mean = |look: &Look| {
            let unit = look.unit.as_ref().filter(|unit| unit.dimension == dimension)?;
            (look.mean.abs() > STEADY * look.deviation).then(|| unit.to_si(look.mean))
        };
        let mut means: Vec<f64> = looks.iter().filter_map(mean).collect();
        means.sort_by(f64::total_cmp);
        let median = *means.get(means.len() / 2)?;
        let near = means.iter().filter(|mean| is_near(*mean / median, group)).count();
        (near >= group.channels.0.len()).then_some(Self { median, near })
    }
}

/// Whether a mean with this ratio to the common one is common as well.
fn is_near(ratio: f64, group: &Common) -> bool {
    let within = group.within.value;
    (1.0 / within..=within).contains(&ratio)
}

/// One guess for each channel that is needed, and for each other one of the convention that a file
/// has; in the order of the convention.
pub fn guesses(named: Named<'_>, needs: &[&ChannelNeed]) -> Vec<Guess> {
    let Named { looks, convention, .. } = named;
    let mut guesses: Vec<Guess> = needs.iter().map(|need| guess_channel(named, need)).collect();
    let axes = ["time", "distance", "speed"];
    let channels = named.channels();
    let names = || channels.iter();
    for name in names().filter(|name| {
        !axes.contains(&name.as_str()) && !needs.iter().any(|need| need.column == **name)
    }) {
        if let [[look], []] = named.of(name).each_ref().map(|all| &all[..]) {
            let reasons =
                vec!["by name; the protocol does not need it".to_string(), look.in_words()];
            guesses.push(Guess {
                channel: name.clone(),
                from: Some(look.name.clone()),
                candidates: Vec::new(),
                reasons,
            });
        }
    }
    let place =
        |guess: &Guess| names().position(|name| *name == guess.channel).unwrap_or(usize::MAX);
    guesses.sort_by_key(place);
    for group in &convention.opposite {
        let look = |guesses: &[Guess], name: &str| {
            let guess = guesses.iter().find(|guess| guess.channel == name)?;
            looks.iter().find(|look| Some(&look.name) == guess.from.as_ref())
        };
        let pairs: Vec<(&String, &Look, &Look)> = group
            .pairs
            .0
            .iter()
            .filter_map(|(right, left)| {
                Some((left, look(&guesses, &right.text)?, look(&guesses, left)?))
            })
            .collect();
        // A file has one convention. In curves the leading wheelsets show it, whose means are the
        // largest; those of the others may have any sign.
        let sum = |sign: f64| {
            let of = |(_, first, second): &(&String, &Look, &Look)| first.mean * second.mean * sign;
            pairs.iter().map(of).filter(|product| *product > 0.0).sum::<f64>()
        };
        if sum(1.0) * CLEARLY <= sum(-1.0) {
            continue;
        }
        for (left, first, second) in pairs {
            let Some(guess) = guesses.iter_mut().find(|guess| guess.channel == *left) else {
                continue;
            };
            let name = &second.name;
            let sign =
                if first.mean * second.mean > 0.0 { "the sign of" } else { "the sign opposite to" };
            guess.from = None;
            guess.candidates.push(name.clone());
            guess.reasons.insert(0, format!("{name}, or with the other sign: -{name}"));
            let (mean, other, unit) = (short(second.mean), short(first.mean), &second.unit_text);
            guess.reasons.push(format!(
                "its mean {mean} {unit} has {sign} {} ({other} {unit}); {}",
                first.name, group.title
            ));
        }
    }
    guesses
}

fn guess_channel(named: Named<'_>, need: &ChannelNeed) -> Guess {
    let Named { looks, convention, .. } = named;
    let [found, others] = named.of(&need.column);
    let names: Vec<String> = found.iter().chain(&others).map(|look| look.name.clone()).collect();
    let guess = |from: Option<&Look>, reasons: Vec<String>| Guess {
        channel: need.column.clone(),
        from: from.map(|look| look.name.clone()),
        candidates: if from.is_some() { Vec::new() } else { names.clone() },
        reasons,
    };
    let wanted = Unit::parse(&need.unit).ok();
    let ([look], []) = (&found[..], &others[..]) else {
        let why = match (&found[..], &others[..]) {
            ([], []) => format!("{}; no channel has a known name of it", need.unit),
            ([], others) => {
                let orders = named.orders();
                let by = match orders.len() {
                    0 | 1 => String::new(),
                    _ => format!("; its digits are {}", orders.join(", or ")),
                };
                let one = if others.len() > 1 { "one of them" } else { "it" };
                format!("{} may be {one}, or another channel{by}", names.join(", "))
            }
            _ => format!("several channels have a name of it: {}", names.join(", ")),
        };
        let content = by_content(looks, need, convention);
        return guess(None, std::iter::once(why).chain(content).collect());
    };
    let by = match (&named.orders()[..], named.by_digits(look)) {
        ([order], true) => {
            let why = named.names.decided.iter().map(|why| format!(" ({why})"));
            format!("by name; digits: {order}{}", why.collect::<String>())
        }
        _ => "by name".to_string(),
    };
    let mut reasons = vec![by, look.in_words()];
    if look.missing == look.rows || look.deviation == 0.0 {
        reasons.insert(0, look.name.clone());
        reasons.push("BUT it has no signal".into());
        return guess(None, reasons);
    }
    let (Some(wanted), Some(unit)) = (&wanted, &look.unit) else {
        return guess(Some(look), reasons);
    };
    if unit.dimension != wanted.dimension {
        reasons.push(format!(
            "{unit} is {}; {} is needed",
            unit.dimension.in_words(),
            wanted.dimension.in_words()
        ));
        return guess(Some(look), reasons);
    }
    for group in convention.common.iter().filter(|group| group.channels.0.contains(&need.column)) {
        let Some(CommonMean { median, near }) = CommonMean::new(looks, wanted.dimension, group)
        else {
            continue;
        };
        let ratio = unit.to_si(look.mean) / median;
        if is_near(ratio, group) {
            reasons.push(format!(
                "by content: its mean is common to {near} channels, {}",
                group.title
            ));
            if ratio > ABOVE && !group.above.is_empty() {
                reasons.push(format!(
                    "{:.0} % above the median: {}",
                    100.0 * (ratio - 1.0),
                    group.above
                ));
            }
        } else {
            reasons.insert(0, look.name.clone());
            reasons.push(format!(
                "BUT its mean is {:.2} times that of the {near} channels with a common mean ({})",
                ratio, group.title
            ));
            return guess(None, reasons);
        }
    }
    guess(Some(look), reasons)
}

/// Candidates by content for a channel of a group with a common mean.
fn by_content(looks: &[Look], need: &ChannelNeed, convention: &Convention) -> Option<String> {
    let wanted = Unit::parse(&need.unit).ok()?;
    let group = convention.common.iter().find(|group| group.channels.0.contains(&need.column))?;
    let CommonMean { median, .. } = CommonMean::new(looks, wanted.dimension, group)?;
    let alike = looks.iter().filter(|look| {
        look.unit.as_ref().is_some_and(|unit| {
            unit.dimension == wanted.dimension && is_near(unit.to_si(look.mean) / median, group)
        })
    });
    let names: Vec<&str> = alike.map(|look| look.name.as_str()).collect();
    Some(format!(
        "by content, one of {} ({}; mean {} {wanted})",
        names.join(", "),
        group.title,
        short(wanted.from_si(median))
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Problems;
    use crate::run::needs::Users;
    use crate::source::Source;
    use crate::yaml::{self, Reader};

    fn look(name: &str, unit: &str, mean: f64) -> Look {
        Look {
            name: name.into(),
            unit_text: unit.into(),
            unit: Unit::parse(unit).ok(),
            comment: None,
            rate: Some(200.0),
            rows: 100,
            missing: 0,
            low: mean - 1.0,
            high: mean + 1.0,
            mean,
            deviation: 0.5,
            increases: false,
            even: false,
        }
    }

    fn need(column: &str, unit: &str) -> ChannelNeed {
        ChannelNeed {
            record: "measured",
            column: column.into(),
            channel: None,
            unit: unit.into(),
            required: true,
            users: Users::default(),
        }
    }

    fn convention_of(text: &str) -> Convention {
        let mut problems = Problems::default();
        let tree = yaml::load(&Source::new("c.yaml", text), &mut problems).expect("YAML");
        let convention = Reader { with: (), problems: &mut problems }.file(&tree);
        assert!(problems.0.is_empty(), "{}", problems.render(false));
        convention.expect("a convention")
    }

    fn convention() -> Convention {
        convention_of(
            "convention: c\n\
             names: {Q_1R: ST1 Q re, Y_1L: [ST1 Y li]}\n\
             common mean: [{title: vertical, channels: [Q_1R, Q_1L], within: 1.5, above: outer}]\n\
             opposite mean: [{title: guiding, pairs: {Y_1R: Y_1L}}]\n",
        )
    }

    fn guessed(looks: &[Look], needs: &[&ChannelNeed]) -> Vec<Guess> {
        let convention = convention();
        let names = Names::read(looks, &convention);
        guesses(Named { looks, convention: &convention, names: &names }, needs)
    }

    #[test]
    fn names_and_contents_agree_or_the_place_is_open() {
        let looks = [
            look("st1 q RE", "kN", 60.0),
            look("Q 1L", "N", 50_000.0),
            look("Y_1R", "kN", 2.0),
            look("ST1 Y li", "kN", 1.5),
        ];
        let needs = [
            need("Q_1R", "kN"),
            need("Q_1L", "kN"),
            need("Y_1R", "kN"),
            need("Y_1L", "kN"),
            need("az_I", "m/s^2"),
        ];
        let found = guessed(&looks, &needs.iter().collect::<Vec<_>>());
        let from: Vec<Option<&str>> = found.iter().map(|guess| guess.from.as_deref()).collect();
        // In the order of the convention. The sign of the left guiding force is open, and there is
        // no acceleration.
        assert_eq!(from, [Some("st1 q RE"), None, Some("Q 1L"), Some("Y_1R"), None]);
        assert!(
            found[0].reasons.iter().any(|reason| reason.contains("common to 2 channels")),
            "{found:?}"
        );
        assert!(found[1].reasons[0].contains("-ST1 Y li"), "{found:?}");
    }

    #[test]
    fn axes_without_a_unit_are_known_by_name() {
        let convention = convention_of(
            "convention: c\nnames: {time: [Zeit, t], distance: [Weg, s], speed: v}\n",
        );
        let rising = |name: &str| Look { increases: true, even: true, ..look(name, "", 1.0) };
        let looks = [look("v", "", 20.0), rising("Zeit"), rising("s"), rising("n")];
        let of = |name: &str, dimension| {
            axis(&looks, &convention, name, dimension).0.map(|look| look.name.as_str())
        };
        assert_eq!(
            (of("time", Dimension::TIME), of("distance", Dimension::LENGTH)),
            (Some("Zeit"), Some("s"))
        );
        assert_eq!(speed(&looks, &convention).0.map(|look| look.name.as_str()), Some("v"));
        // A channel that does not increase is no axis, whatever it is called.
        assert_eq!(
            axis(&[look("t", "", 1.0)], &convention, "time", Dimension::TIME)
                .0
                .map(|look| look.name.as_str()),
            None
        );
    }

    #[test]
    fn a_name_with_another_content_is_open() {
        let looks = [look("Q_1R", "kN", 60.0), look("Q_1L", "kN", 58.0), look("a", "kN", 59.0)];
        let mut wrong = looks.to_vec();
        wrong[0].mean = 6.0;
        let found = guessed(&wrong, &[&need("Q_1R", "kN")]);
        assert_eq!(found[0].from, None, "{found:?}");
        let looks = [look("x", "kN", 60.0), look("y", "kN", 58.0)];
        let unnamed = guessed(&looks, &[&need("Q_1R", "kN")]);
        assert!(
            unnamed[0].reasons.iter().any(|reason| reason.contains("one of x, y")),
            "{unnamed:?}"
        );
    }
}
