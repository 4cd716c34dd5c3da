//! Reads the names of channels word by word, by the words of a convention.
//!
//! A name is split where a blank or punctuation stands, between letters and digits, and where a
//! capital follows a small letter. Every word must say something: what is recorded, at which place,
//! or nothing. A name with a word that is not known is not read, but for words that most names of
//! the file have (`MBS`, the name of the model).

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::look::Look;
use crate::import::mapping::{Convention, Order, Quantity};

/// A channel of the protocol that a name may stand for.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Reading {
    pub channel: String,
    /// By which order of digits, where the name says no more; an index of [`Convention::orders`].
    pub order: Option<usize>,
    /// What its quantity is called in the convention, and the members of its places.
    quantity: String,
    members: Vec<String>,
}

/// What the names of a file say.
#[derive(Debug)]
pub struct Names {
    /// For each channel of the file.
    readings: Vec<Vec<Reading>>,
    /// The orders of digits that all names of the file allow.
    pub orders: Vec<usize>,
    /// Why one of several was chosen.
    pub decided: Option<String>,
}

/// A name in words, in lower case. Two dots, stars, strokes and accents that follow a letter belong
/// to it: `y..`, `z*`, `y''`. So does a `$` before one.
fn words(name: &str) -> Vec<String> {
    // File systems and programs of macOS write accents apart.
    const APART: [(&str, &str); 7] = [
        ("a\u{308}", "ä"),
        ("o\u{308}", "ö"),
        ("u\u{308}", "ü"),
        ("y\u{308}", "ÿ"),
        ("e\u{301}", "é"),
        ("e\u{300}", "è"),
        ("a\u{302}", "â"),
    ];
    let name = APART.iter().fold(name.to_owned(), |name, (two, one)| name.replace(two, one));
    let mut all: Vec<String> = Vec::new();
    let mut word = String::new();
    let letters: Vec<char> = name.chars().collect();
    let is_mark = |at: usize| {
        let twice = |sign: char| {
            letters[at] == sign
                && (letters.get(at + 1) == Some(&sign) || at > 0 && letters[at - 1] == sign)
        };
        ['*', '+', '\u{a8}'].contains(&letters[at])
            || ('\u{300}'..='\u{36f}').contains(&letters[at])
            || twice('.')
            || twice('\'')
    };
    let mut end = |word: &mut String| {
        if !word.is_empty() {
            all.push(std::mem::take(word));
        }
    };
    for (at, &letter) in letters.iter().enumerate() {
        let before = at.checked_sub(1).map(|before| letters[before]);
        if letter == '$' {
            end(&mut word);
            word.push(letter);
        } else if letter.is_alphanumeric() {
            let other = before.is_some_and(|before| {
                before.is_alphanumeric() && before.is_numeric() != letter.is_numeric()
                    || before.is_lowercase() && letter.is_uppercase() && word.chars().count() > 1
                    || !before.is_alphanumeric() && before != '$'
            });
            if other {
                end(&mut word);
            }
            word.extend(letter.to_lowercase());
        } else if word.chars().next().is_some_and(char::is_alphabetic) && is_mark(at) {
            word.push(letter);
        } else {
            end(&mut word);
        }
    }
    end(&mut word);
    all
}

/// The words of a convention.
struct Vocabulary<'c> {
    convention: &'c Convention,
    quantities: Vec<OfQuantity<'c>>,
    /// Words of places, and of their members with the member.
    places: BTreeMap<&'c str, OfPlace>,
    nothing: BTreeSet<String>,
    known: BTreeSet<String>,
}

struct OfQuantity<'c> {
    quantity: &'c Quantity,
    /// The places in the name of its channel.
    places: Vec<&'c str>,
    phrases: Vec<Vec<String>>,
}

#[derive(Default)]
struct OfPlace {
    words: BTreeSet<String>,
    members: BTreeMap<String, String>,
}

impl<'c> Vocabulary<'c> {
    fn new(convention: &'c Convention) -> Self {
        let phrases = |all: &[String]| all.iter().map(|phrase| words(phrase)).collect::<Vec<_>>();
        let one = |all: &[String]| all.iter().flat_map(|word| words(word)).collect::<BTreeSet<_>>();
        let quantity = |quantity: &'c Quantity| OfQuantity {
            quantity,
            places: inserted(&quantity.channel),
            phrases: [phrases(&quantity.words.0), phrases(&quantity.of.0)].concat(),
        };
        let quantities: Vec<OfQuantity<'c>> = convention.quantities.iter().map(quantity).collect();
        let mut places: BTreeMap<&str, OfPlace> = BTreeMap::new();
        for (name, place) in &convention.places.0 {
            let own = places.entry(&name.text).or_default();
            own.words = one(&place.words.0);
            for (member, names) in &place.members.0 {
                let names = one(&names.0).into_iter().map(|word| (word, member.text.clone()));
                own.members.extend(names);
            }
        }
        let nothing = one(&convention.other.0);
        let of_quantities = quantities.iter().flat_map(|of| of.phrases.iter().flatten()).cloned();
        let of_places = places.values().flat_map(|of| of.words.iter().chain(of.members.keys()));
        let known = of_quantities.chain(of_places.cloned()).chain(nothing.iter().cloned());
        let known = known.collect();
        Self { convention, quantities, places, nothing, known }
    }

    /// Whether a word by itself says what is recorded.
    fn is_of_quantity(&self, word: &str) -> bool {
        let own = |of: &OfQuantity<'_>| of.phrases.iter().any(|phrase| *phrase == [word]);
        self.quantities.iter().any(own)
    }

    fn is_of_place(&self, word: &str) -> bool {
        let own = |of: &OfPlace| of.words.contains(word) || of.members.contains_key(word);
        self.places.values().any(own)
    }

    /// The words of a name; one that is not known, but is two known ones without a gap, is those.
    fn words(&self, name: &str) -> Vec<String> {
        let apart = |word: String| -> Vec<String> {
            if self.known.contains(&word) || !word.chars().all(char::is_alphabetic) {
                return vec![word];
            }
            let cuts = word.char_indices().skip(1).map(|(at, _)| word.split_at(at));
            // One says what is recorded, the other where.
            let known = |(a, b): &(&str, &str)| {
                self.is_of_quantity(a) && self.is_of_place(b)
                    || self.is_of_place(a) && self.is_of_quantity(b)
            };
            match cuts.filter(known).collect::<Vec<_>>()[..] {
                [(a, b)] => vec![a.to_owned(), b.to_owned()],
                _ => vec![word],
            }
        };
        words(name).into_iter().flat_map(apart).collect()
    }

    fn read(&self, words: &[String]) -> Vec<Reading> {
        let words: Vec<&String> =
            words.iter().filter(|word| !self.nothing.contains(*word)).collect();
        // Of several quantities, the one that more words are about.
        let mut best: (usize, Vec<Reading>) = (0, Vec::new());
        for of in &self.quantities {
            let all = |phrase: &&Vec<String>| phrase.iter().all(|word| words.contains(&word));
            let about: BTreeSet<&String> = of.phrases.iter().filter(all).flatten().collect();
            let said = of.phrases[..of.quantity.words.0.len()].iter().any(|phrase| all(&phrase));
            if !said {
                continue;
            }
            let rest: Vec<&String> =
                words.iter().copied().filter(|word| !about.contains(word)).collect();
            let count = words.len() - rest.len();
            let found = self.places(of, &rest);
            if found.is_empty() || count < best.0 {
                continue;
            }
            if count > best.0 {
                best = (count, Vec::new());
            }
            best.1.extend(found);
        }
        best.1
    }

    /// The channels of a quantity that the other words of a name stand for.
    fn places(&self, of: &OfQuantity<'_>, rest: &[&String]) -> Vec<Reading> {
        let mut found: BTreeMap<&str, String> = BTreeMap::new();
        let mut digits: Vec<char> = Vec::new();
        let mut waiting: Option<&str> = None;
        for word in rest {
            let own = || {
                of.places.iter().copied().filter_map(|name| Some((name, self.places.get(name)?)))
            };
            if let Some(numeral) = word.chars().next().filter(|_| is_number(word)) {
                let member = waiting.take().and_then(|name| {
                    let member = self.places[name].members.get(word.trim_start_matches('0'))?;
                    Some((name, member.clone()))
                });
                match member {
                    Some((name, member)) => {
                        if found.insert(name, member).is_some() {
                            return Vec::new();
                        }
                    }
                    None if word.len() > 2 => return Vec::new(),
                    None if numeral == '0' => digits.extend(word.chars().skip(1)),
                    None => digits.extend(word.chars()),
                }
            } else if let Some((name, member)) = own().find_map(|(name, place)| {
                Some((name, place.members.get(*word)?)).filter(|_| !found.contains_key(name))
            }) {
                found.insert(name, member.clone());
            } else if let Some((name, _)) = own().find(|(_, place)| place.words.contains(*word)) {
                waiting = Some(name);
            } else {
                return Vec::new();
            }
        }
        let open: Vec<&str> =
            of.places.iter().copied().filter(|name| !found.contains_key(name)).collect();
        let reading = |found: &BTreeMap<&str, String>, order: Option<usize>| {
            let with = |name: String, (place, member): (&&str, &String)| {
                name.replace(&format!("{{{place}}}"), member)
            };
            let quantity = of.quantity.channel.clone();
            let members = of.places.iter().filter_map(|place| found.get(place).cloned()).collect();
            Reading { channel: found.iter().fold(quantity.clone(), with), order, quantity, members }
        };
        let member = |place: &str, digit: char| {
            self.places.get(place)?.members.get(&digit.to_string()).cloned()
        };
        match (&open[..], &digits[..]) {
            ([], []) => vec![reading(&found, None)],
            ([place], [digit]) => {
                let Some(member) = member(place, *digit) else { return Vec::new() };
                found.insert(place, member);
                vec![reading(&found, None)]
            }
            ([_, _], [_, _]) => {
                let by = |(at, order): (usize, &Order)| {
                    let mut found = found.clone();
                    for (place, digit) in order.places.0.iter().zip(&digits) {
                        let own = order.digits.0.iter().find(|(name, _)| name.text == *place);
                        let member = match own {
                            Some((_, of)) => {
                                let digit = digit.to_string();
                                of.0.iter().find(|(key, _)| key.text == digit)?.1.clone()
                            }
                            None => member(place, *digit)?,
                        };
                        found.insert(open.iter().find(|name| *name == place)?, member);
                    }
                    Some(reading(&found, Some(at)))
                };
                self.convention.orders.iter().enumerate().filter_map(by).collect()
            }
            _ => Vec::new(),
        }
    }
}

fn is_number(word: &str) -> bool {
    word.chars().all(|letter| letter.is_ascii_digit())
}

/// The places in the name of a channel: `wheelset` and `side` of `Y_{wheelset}{side}`.
fn inserted(channel: &str) -> Vec<&str> {
    let parts = channel.split('{').skip(1);
    parts.filter_map(|part| part.split_once('}')).map(|(name, _)| name).collect()
}

/// All channels of the quantities of a convention.
pub fn all_channels(convention: &Convention) -> Vec<String> {
    let of_quantity = |quantity: &Quantity| {
        let with = |names: Vec<String>, place: &str| {
            let members = convention.places.0.iter().find(|(name, _)| name.text == place);
            let members = members.map_or(&[][..], |(_, place)| &place.members.0);
            let filled = |name: &String| {
                let one = |member: &str| name.replace(&format!("{{{place}}}"), member);
                members.iter().map(|(key, _)| one(&key.text)).collect::<Vec<_>>()
            };
            names.iter().flat_map(filled).collect()
        };
        inserted(&quantity.channel).into_iter().fold(vec![quantity.channel.clone()], with)
    };
    convention.quantities.iter().flat_map(of_quantity).collect()
}

/// Share of the names of a file that have a word, above which it says nothing of a single channel,
/// in a file with so many names.
const COMMON: f64 = 0.5;
const SEVERAL: usize = 4;

impl Names {
    pub fn read(looks: &[Look], convention: &Convention) -> Self {
        let vocabulary = Vocabulary::new(convention);
        let mut all: Vec<Vec<String>> =
            looks.iter().map(|look| vocabulary.words(&look.name)).collect();
        let mut often: HashMap<&String, usize> = HashMap::new();
        for words in &all {
            for word in words.iter().collect::<BTreeSet<_>>() {
                *often.entry(word).or_default() += 1;
            }
        }
        let (all_names, many) = (all.len(), COMMON * all.len() as f64);
        let says_nothing = |(word, count): (&&String, &usize)| {
            all_names >= SEVERAL
                && *count as f64 > many
                && !vocabulary.known.contains(*word)
                && !is_number(word)
        };
        let common: BTreeSet<String> = often
            .iter()
            .filter(|one| says_nothing(*one))
            .map(|(word, _)| (*word).clone())
            .collect();
        for words in &mut all {
            // The number behind such a word is that of the channel in the file.
            let is_common = |at: usize| common.contains(&words[at]);
            let drops =
                |at: usize| is_common(at) || at > 0 && is_common(at - 1) && is_number(&words[at]);
            let kept = (0..words.len()).filter(|at| !drops(*at)).map(|at| words[at].clone());
            *words = kept.collect();
        }
        let readings: Vec<Vec<Reading>> = all.iter().map(|words| vocabulary.read(words)).collect();
        let mut names = Self { readings, orders: Vec::new(), decided: None };
        names.orders = names.possible(convention.orders.len());
        names.keep(&names.orders.clone());
        names
    }

    /// Drops the readings of a quantity that would be recorded at one side of each wheelset only:
    /// its numbers are then those of wheels, or of other things.
    fn drop_odd(&mut self) {
        let mut found: BTreeMap<String, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
        for one in self.readings.iter().flatten() {
            if let [first, second] = &one.members[..] {
                let of = found.entry(one.quantity.clone()).or_default();
                of.entry(first.clone()).or_default().insert(second.clone());
            }
        }
        let odd = |of: &BTreeMap<String, BTreeSet<String>>| {
            let all: BTreeSet<&String> = of.values().flatten().collect();
            of.len() > 1 && all.len() > 1 && of.values().all(|second| second.len() == 1)
        };
        found.retain(|_, of| odd(of));
        for all in &mut self.readings {
            all.retain(|one| !found.contains_key(&one.quantity));
        }
    }

    /// The orders in which every name with bare digits stands for a channel of its own, which no
    /// other name says without them. A name that stands in several tables counts once.
    fn possible(&self, orders: usize) -> Vec<usize> {
        let by_digits = |all: &&Vec<Reading>| all.iter().any(|one| one.order.is_some());
        let bare: BTreeSet<&Vec<Reading>> = self.readings.iter().filter(by_digits).collect();
        let sure: BTreeSet<&str> =
            self.sure().filter(|(at, _)| !self.is_by_digits(*at)).map(|(_, name)| name).collect();
        let fits = |order: &usize| {
            let in_order = |one: &&Reading| one.order == Some(*order);
            let channels: Vec<&Reading> =
                bare.iter().filter_map(|all| all.iter().find(in_order)).collect();
            let once: BTreeSet<&str> = channels.iter().map(|one| one.channel.as_str()).collect();
            let each = channels.len() == bare.len() && once.len() == channels.len();
            !bare.is_empty() && each && once.is_disjoint(&sure)
        };
        (0..orders).filter(fits).collect()
    }

    /// Drops what is read by other orders of digits.
    pub fn keep(&mut self, orders: &[usize]) {
        for all in &mut self.readings {
            all.retain(|one| one.order.is_none_or(|order| orders.contains(&order)));
        }
        self.orders = orders.to_vec();
        self.exclude();
        self.drop_odd();
    }

    /// Drops readings as channels for which another name has no other meaning.
    fn exclude(&mut self) {
        loop {
            let sure = |all: &Vec<Reading>| match &all[..] {
                [one] => Some(one.channel.clone()),
                _ => None,
            };
            let sure: BTreeSet<String> = self.readings.iter().filter_map(sure).collect();
            let mut changed = false;
            // Orders of digits are all or none.
            let several = |all: &&mut Vec<Reading>| all.len() > 1 && all[0].order.is_none();
            for all in self.readings.iter_mut().filter(several) {
                let before = all.len();
                all.retain(|one| !sure.contains(&one.channel));
                changed |= all.len() != before;
            }
            if !changed {
                return;
            }
        }
    }

    /// The channels of a file whose names stand for a channel, and whether for no other one.
    pub fn of(&self, channel: &str) -> Vec<(usize, bool)> {
        let is = |all: &Vec<Reading>| all.iter().any(|one| one.channel == channel);
        let found = self.readings.iter().enumerate().filter(|(_, all)| is(all));
        found.map(|(at, all)| (at, all.len() == 1)).collect()
    }

    /// The channels whose names stand for one channel of the protocol.
    pub fn sure(&self) -> impl Iterator<Item = (usize, &str)> {
        self.readings.iter().enumerate().filter_map(|(at, all)| match &all[..] {
            [one] => Some((at, one.channel.as_str())),
            _ => None,
        })
    }

    /// Whether the name of a channel of the file is read by an order of digits.
    pub fn is_by_digits(&self, at: usize) -> bool {
        self.readings[at].iter().any(|one| one.order.is_some())
    }

    /// The channels that names of the file stand for by an order of digits.
    pub fn by_order(&self, order: usize) -> impl Iterator<Item = (usize, &str)> {
        self.readings.iter().enumerate().flat_map(move |(at, all)| {
            let in_order = all.iter().filter(move |one| one.order.is_none_or(|of| of == order));
            in_order.map(move |one| (at, one.channel.as_str()))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a file with these names is read as.
    fn read(names: &[&str]) -> Vec<Vec<String>> {
        let shipped = crate::library::CONVENTIONS.iter().find(|one| one.name == "bogie-vehicle");
        let text = shipped.expect("a convention").text;
        let mut problems = crate::problem::Problems::default();
        let source = crate::source::Source::new("c.yaml", text);
        let tree = crate::yaml::load(&source, &mut problems).expect("YAML");
        let mut reader = crate::yaml::Reader { with: (), problems: &mut problems };
        let convention: Convention = reader.file(&tree).expect("a convention");
        let looks: Vec<Look> =
            names.iter().map(|name| Look { name: (*name).into(), ..Look::default() }).collect();
        let all = Names::read(&looks, &convention).readings.into_iter();
        all.map(|all| all.into_iter().map(|one| one.channel).collect()).collect()
    }

    /// Filtered and summed signals, ratios, displacements, numbers of wheels and of three digits
    /// are not what they begin with.
    #[test]
    fn names_with_more_to_say_are_not_read() {
        for name in [
            "Y_1R_LP20",
            "Y_1R_2m",
            "SumY_1",
            "Y/Q 1R",
            "Q0",
            "dQ_1R",
            "Y_soll_1R",
            "Y 111",
            "Y_5R",
            "lateral displacement ws 1 right",
            "Y wheel 3 right",
            "Q_1",
            "ay",
            "x 1R",
            "acc_x_body_1",
            "y_body_1",
            "roll rate bogie 1",
            "Q_1R_1L",
            "bogie 3 lat acc",
            "Y_1R min",
        ] {
            assert_eq!(read(&[name, "Zeit"])[0], Vec::<String>::new(), "{name}");
            assert_eq!(read(&[name])[0], Vec::<String>::new(), "{name}");
        }
        // One wheel on each side in turn: numbers of wheels.
        let wheels = ["Y 1 R", "Y 2 L", "Y 3 R", "Y 4 L"];
        assert!(read(&wheels).iter().all(Vec::is_empty));
        // What may be of the body or of the bogie is both, unless another name says which.
        assert_eq!(read(&["y_pp_1"])[0], ["ay_I", "ayb_I"]);
        assert_eq!(read(&["y_pp_1", "y_pp_DG_1"]), [["ay_I"], ["ayb_I"]]);
        assert_eq!(read(&["Y12", "Y11"])[0].len(), 3);
        let side_first = read(&["Y11", "Y21", "Y14", "Y24"]);
        assert_eq!(side_first, [["Y_1R"], ["Y_1L"], ["Y_4R"], ["Y_4L"]]);
        // By every order, one of them is the channel that another name says without digits.
        let beside = read(&["Y_1R", "Y11", "Y12", "Y21", "Y22"]);
        assert_eq!(beside[0], ["Y_1R"]);
        assert!(beside[1..].iter().all(Vec::is_empty), "{beside:?}");
        let beside = read(&["Y_1R", "Y_1L", "Y12", "Y22", "Y13", "Y23"]);
        assert_eq!(beside[2..], [["Y_2R"], ["Y_2L"], ["Y_3R"], ["Y_3L"]]);
        // Both are the same channel: the draft leaves it open.
        assert_eq!(read(&["Y_1R", "Fy ws1 right"]), [["Y_1R"], ["Y_1R"]]);
    }

    #[test]
    fn names_fall_apart_into_words() {
        let of = |name: &str| words(name).join(" ");
        assert_eq!(of("Führungskraft Y Radsatz 1 rechts"), "führungskraft y radsatz 1 rechts");
        assert_eq!(of("MBS_Y_1R"), "mbs y 1 r");
        assert_eq!(of("$R_Y11"), "$r y 11");
        assert_eq!(of("WK1 y.."), "wk 1 y..");
        assert_eq!(of("z* II"), "z* ii");
        assert_eq!(of("LatForceWs2Right"), "lat force ws 2 right");
        assert_eq!(of("vehicle.ws1.Y_R [kN]"), "vehicle ws 1 y r kn");
        assert_eq!(of("y'' DG1"), "y'' dg 1");
        assert_eq!(of("Fu\u{308}hrungskraft Y"), "führungskraft y");
    }
}
