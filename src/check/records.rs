//! Records that a protocol declares, and which records a quantity takes or compares.

use super::prelude::*;

/// Which records are compared.
#[derive(Clone, Copy, Debug)]
pub enum Compare {
    Pairs(Pairing),
    /// Each record with what is central of several.
    With(Chosen, Chosen, Center),
}

const WAYS: &str = "write `simulated with measured`, `simulated with mean of simulated` (for several records), `measured with each other` \
    or `repeats with originals`; a record may stand in place of `simulated` and `measured`";

impl Checker<'_> {
    /// `is simulated simpack, vampire`
    pub fn declared_record(&mut self, name: &str, block: &Block) -> Option<DeclaredRecord> {
        let field = self.required(block, "is")?;
        if ["repeats", "originals"].contains(&name) {
            let help = format!("for instance `{name}_1`");
            return self.refuse(
                problem!(
                    "reserved-name",
                    block,
                    "`{name}` is a word of the language and cannot be the name of this record"
                )
                .help(help),
            );
        }
        let text = &field.value.text;
        let start = text.len() - text.trim_start().len();
        let end = text[start..].find(char::is_whitespace).map_or(text.len(), |at| start + at);
        let word = &text[start..end];
        let Some(side) = Side::named(word) else {
            let problem = problem!(
                "unknown-record",
                &field.value.place(start..end),
                "a record is simulated or measured, and not `{word}`"
            )
            .suggest(word, Side::ALL.map(Side::in_words));
            return self.refuse(match problem.help {
                Some(_) => problem,
                None => problem.help("`is simulated simpack, vampire`: the side, and the names that the campaign gives to its records"),
            });
        };
        let mut members: Vec<Spanned<String>> = Vec::new();
        let mut at = end;
        for piece in text[end..].split(',') {
            let range = at + (piece.len() - piece.trim_start().len())..at + piece.trim_end().len();
            at += piece.len() + 1;
            let member = piece.trim().trim_matches('"').trim();
            if member.is_empty() {
                if text[end..].trim().is_empty() {
                    break;
                }
                return self.refuse(
                    error("syntax", "between commas, the name of a record is missing", field)
                        .help("`is simulated simpack, vampire`"),
                );
            }
            let place = field.value.place(range);
            if let Some(first) = members.iter().find(|known| known.value == member) {
                return self.refuse(
                    problem!("duplicate-name", &place, "`{member}` is named twice")
                        .also(&first.span, "the first"),
                );
            }
            members.push(Spanned::new(member.to_string(), place));
        }
        let (name, title, span) = (name.to_string(), block.title_in_words(), block.place());
        Some(DeclaredRecord { name, title, side, members, span })
    }

    /// `simulated`, `measured`, or the name of a record.
    fn chosen_named(&self, word: &str) -> Option<Chosen> {
        if let Some(side) = Side::named(word) {
            return Some(Chosen { side, record: None });
        }
        let index = self.names.records.iter().position(|record| record.name == word)?;
        Some(Chosen { side: self.names.records[index].side, record: Some(index) })
    }

    /// As [`Self::chosen_named`], with a problem where there is no such record.
    fn chosen(&mut self, word: &str, at: &Span) -> Option<Chosen> {
        let found = self.chosen_named(word);
        if found.is_none() && !self.is_failed(word) {
            let declared = self.names.records.iter().map(|record| record.name.as_str());
            let known = Side::ALL.map(Side::in_words).into_iter().chain(declared);
            let problem = problem!("unknown-record", at, "`{word}` is not a record of a campaign")
                .suggest(word, known);
            self.tell(match problem.help {
                Some(_) => problem,
                None => problem.help("`simulated`, `measured`, or the name of a block `record`"),
            });
        }
        found
    }

    /// What it is called in words: its name, or its side.
    pub fn chosen_in_words(&self, chosen: Chosen) -> &str {
        chosen.record.map_or(chosen.side.in_words(), |index| &self.names.records[index].name)
    }

    /// `from measured`, `from codes`
    pub fn from(&mut self, field: &Field) -> Option<Chosen> {
        let word = self.choice_field(field)?;
        self.chosen(&word, &field.value.span)
    }

    /// Which records a metric takes its two signals of.
    pub fn of_metric(&mut self, field: &Field, metric: &Span) -> Option<Pairing> {
        match self.compare(field)? {
            Compare::Pairs(pairing) => Some(pairing),
            Compare::With(..) => {
                let says =
                    "a metric compares two signals; a mean of several signals is not available";
                let problem = error("metric-and-spread", says, field).also(metric, "the metric");
                let help = "use `value` and `difference`, or compare `simulated with measured` or `repeats with originals`";
                self.refuse(problem.help(help))
            }
        }
    }

    /// `simulated with measured`, `codes with reference`, `codes with mean of simulated`, `runs
    /// with each other`, `repeats with originals`.
    pub fn compare(&mut self, field: &Field) -> Option<Compare> {
        let words = normalised(&field.value.text);
        let all: Vec<&str> = words.split(' ').collect();
        let refuse = |checker: &mut Self, says: &str, help: &str| {
            checker.refuse(error("unknown-comparison", says, field).help(help))
        };
        match all.as_slice() {
            ["repeats", "with", "originals"] => Some(Compare::Pairs(Pairing::Repeats)),
            [of, "with", "each", "other"] => {
                let of = self.chosen(of, &part(&field.value, of))?;
                self.several(of, &field.value.span)?;
                Some(Compare::Pairs(Pairing::EachOther(of)))
            }
            [of, "with", center @ ("mean" | "median"), "of", among] => {
                let of = self.chosen(of, &part(&field.value, of));
                let (of, among) = (of?, self.chosen(among, &part(&field.value, among))?);
                self.several(among, &field.value.span)?;
                if of.side != among.side {
                    let says = "records are compared with the mean or median of their own side";
                    return refuse(self, says, WAYS);
                }
                Some(Compare::With(
                    of,
                    among,
                    if *center == "mean" { Center::Mean } else { Center::Median },
                ))
            }
            [first, "with", second] if *first != "repeats" && *second != "originals" => {
                let one = self.chosen(first, &part(&field.value, first));
                let (one, other) = (one?, self.chosen(second, &part(&field.value, second))?);
                if (one.side, other.side) == (Side::Measured, Side::Simulated) {
                    let says = "simulated records are compared with measured ones";
                    let help = format!("the other way round: `{second} with {first}`");
                    return refuse(self, says, &help);
                }
                if one == other {
                    let says = format!("`{words}` compares records with themselves");
                    let help =
                        format!("`{first} with each other`, or `{first} with mean of {first}`");
                    return refuse(self, &says, &help);
                }
                Some(Compare::Pairs(Pairing::Each(one, other)))
            }
            _ => {
                let says = format!("`{words}` does not say which records are compared");
                refuse(self, &says, WAYS)
            }
        }
    }

    /// One record cannot be compared with others of its own.
    fn several(&mut self, of: Chosen, at: &Span) -> Option<()> {
        let record = of.record.map(|index| &self.names.records[index]);
        let Some(record) = record.filter(|record| record.members.len() == 1) else {
            return Some(());
        };
        self.refuse(
            problem!("one-record", at, "`{}` is one record, and several are compared", record.name)
                .also(&record.span, "declared here"),
        )
    }

    /// The words of a comparison with what stands in a row in place of `simulated` and `measured`.
    pub fn paired_words(&self, pairing: Pairing, comparison: &str) -> String {
        let (first, second) = match pairing {
            Pairing::Repeats => ("repeat", "original"),
            Pairing::EachOther(_) => ("one", "other"),
            Pairing::Each(first, second) => {
                (self.chosen_in_words(first), self.chosen_in_words(second))
            }
        };
        if pairing == Pairing::SIDES {
            return comparison.to_string();
        }
        let replaced = |word: &str| match word {
            "simulated" => first.to_string(),
            "measured" => second.to_string(),
            other => other.to_string(),
        };
        // Word by word, since a record may be called by a part of another's name.
        let mut words = String::new();
        let mut word = String::new();
        for c in comparison.chars().chain(Some(' ')) {
            if c.is_alphanumeric() || c == '_' {
                word.push(c);
            } else {
                words.push_str(&replaced(&word));
                word.clear();
                words.push(c);
            }
        }
        words.pop();
        words
    }
}

/// The place of a word in a text; of the whole text where it cannot be told.
fn part(text: &Text, word: &str) -> Span {
    let is_word = |at: usize| {
        let around = |c: Option<char>| c.is_none_or(|c| !(c.is_alphanumeric() || c == '_'));
        around(text.text[..at].chars().next_back())
            && around(text.text[at + word.len()..].chars().next())
    };
    let found = text.text.match_indices(word).map(|(at, _)| at).find(|&at| is_word(at));
    found.map_or_else(|| text.span.clone(), |at| text.place(at..at + word.len()))
}
