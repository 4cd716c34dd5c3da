//! Checks blocks that declare the content of records, of the vehicle file and of the table of
//! sections: places, data, channels, signals.

use super::{
    names::{Place, Signal},
    positions::joined,
    prelude::*,
};
use crate::syntax::{families, is_each, phrase::Pick};

/// Largest number of positions of a place: the wheels of a train of sixty vehicles. A signal at
/// several places has the product of their numbers.
const MOST_MEMBERS: usize = 500;
/// Written in place of a list of words.
const ANY_WORD: &str = "any word";

impl Checker<'_> {
    /// The positions of a place and their aliases.
    pub fn place(&mut self, name: &str, block: &Block) -> Option<Place> {
        let field = self.required(block, "members")?;
        let written = from_pest::list(&field.value, self.problems)?;
        if written.len() > MOST_MEMBERS {
            let help = "declare the positions that are compared; put the others into another place";
            return self.refuse(
                problem!(
                    "too-large",
                    field,
                    "`{name}` has {} positions; there can be at most {MOST_MEMBERS}",
                    written.len()
                )
                .help(help),
            );
        }
        let mut members: Vec<String> = Vec::new();
        for member in written {
            let place = member.place();
            if let Some(sign) = member.node.chars().find(|c| matches!(c, '-' | '.')) {
                self.tell(problem!("bad-name", &place, "`{}` cannot be a position of `{name}`: in an expression, `{sign}` is not read as part of a name",
                    member.node));
            } else if members.contains(&member.node) {
                self.tell(problem!("duplicate-name", &place, "`{}` is named twice", member.node));
            } else {
                members.push(member.node);
            }
        }
        let mut aliases = Vec::new();
        for field in block.fields_named("alias") {
            let Some(alias) = from_pest::alias(&field.value, self.problems) else { continue };
            if members.contains(&alias.name.node) {
                self.tell(
                    problem!(
                        "name-clash",
                        &alias.name,
                        "`{}` is both a position of `{name}` and an alias",
                        alias.name.node
                    )
                    .also(block, "the members"),
                );
            }
            for (member, _) in &alias.cases {
                if !members.contains(&member.node) {
                    self.tell(
                        problem!(
                            "unknown-place",
                            member,
                            "`{}` is not a position of `{name}`",
                            member.node
                        )
                        .suggest(&member.node, &members),
                    );
                }
            }
            aliases.push(alias);
        }
        Some(Place { members, aliases })
    }

    /// A value of the vehicle file or a column of the table of sections, yet without range and default.
    pub fn datum(
        &mut self,
        name: &str,
        block: &Block,
        key: &str,
        standard_key: String,
    ) -> Option<Datum> {
        let kind = match (block.field("in"), block.field("one of")) {
            (Some(unit), None) => DatumKind::Number(self.unit(&unit.value)?),
            (None, Some(words)) if normalised(&words.value.text) == ANY_WORD => DatumKind::AnyWord,
            (None, Some(words)) => {
                let words = from_pest::list(&words.value, self.problems)?;
                let mut words: Vec<String> = words.into_iter().map(|word| word.node).collect();
                // The names of the zone blocks. A further zone then needs one block and no change
                // of a list.
                if words == ["zones"] {
                    words.clone_from(&self.zone_names);
                }
                let flag = words == ["true", "false"] || words == ["false", "true"];
                if flag { DatumKind::Flag } else { DatumKind::Words(words) }
            }
            _ => {
                return self.refuse(
                    problem!(
                        "missing-field",
                        block,
                        "{} `{name}` needs a field `in` or `one of`",
                        block.kind.text
                    )
                    .help("`in kN` for a number, `one of right, left` for a word"),
                );
            }
        };
        let key =
            block.field(key).map_or(standard_key, |field| field.value.text.trim().to_string());
        Some(Datum {
            name: name.to_string(),
            title: block.title_in_words(),
            key,
            kind,
            default: None,
            range: None,
            optional: self.optional(block)?,
            computed: block.field(super::find::COMPUTED).is_some(),
            span: block.place(),
        })
    }

    /// The range of a number of the vehicle, in its unit.
    fn datum_range(&mut self, name: &str, kind: &DatumKind, field: &Field) -> Option<DatumRange> {
        let DatumKind::Number(unit) = kind else {
            return self.refuse(problem!(
                "unknown-field",
                &field.key,
                "`{name}` is a choice of words and cannot have a range"
            ));
        };
        let [low, high] = self.range_ends(name, unit.dimension, field, None)?;
        if low > high {
            return self.refuse(problem!(
                "out-of-range",
                field,
                "the range of `{name}` has its upper end below its lower end"
            ));
        }
        Some(DatumRange {
            low,
            high,
            words: normalised(&field.value.text),
            span: field.value.span.clone(),
        })
    }

    /// Range and default of a datum, after all names are known.
    pub fn datum_default(&mut self, name: &str, block: &Block) -> Option<()> {
        let data =
            if block.kind.text == "vehicle" { &self.names.vehicle } else { &self.names.columns };
        let Some(index) = data.iter().position(|datum| datum.name == name) else { return Some(()) };
        let data_kind = data[index].kind.clone();
        let range = block.field("range");
        if let Some(range) = range {
            let range = self.datum_range(name, &data_kind, range)?;
            self.names.vehicle[index].range = Some(range);
        }
        let Some(field) = block.field("default") else { return Some(()) };
        let word = field.value.text.trim();
        let default = match data_kind {
            DatumKind::Number(unit) => {
                let (value, dimension) = self.constant(&field.value)?;
                if dimension != unit.dimension {
                    let problem = problem!(
                        "unit-mismatch",
                        field,
                        "`{name}` is {}, its default is {}",
                        unit.dimension.in_words(),
                        dimension.in_words()
                    )
                    .label(dimension.in_words());
                    return self.refuse(match block.field("in") {
                        Some(unit_field) => problem.also(unit_field, unit.dimension.in_words()),
                        None => problem,
                    });
                }
                if let Some(range) = range {
                    self.within_range(name, value, dimension, &field.value, range);
                }
                Scalar::Number(value)
            }
            DatumKind::Flag if matches!(word, "true" | "false") => Scalar::Flag(word == "true"),
            DatumKind::Words(words) if words.iter().any(|known| known == word) => {
                Scalar::Word(word.to_string())
            }
            DatumKind::AnyWord => Scalar::Word(word.trim_matches('"').to_string()),
            DatumKind::Words(words) if self.stands_for_one_of(word, &words, &field.value.span) => {
                Scalar::Word(self.choice_word(word, &field.value.span)?)
            }
            kind => {
                let words = if let DatumKind::Words(words) = kind {
                    words
                } else {
                    vec!["true".into(), "false".into()]
                };
                return self.refuse(
                    problem!(
                        "unknown-choice",
                        field,
                        "`{word}` is not one of the words of `{name}`"
                    )
                    .suggest(word, &words),
                );
            }
        };
        let data = if block.kind.text == "vehicle" {
            &mut self.names.vehicle
        } else {
            &mut self.names.columns
        };
        data[index].default = Some(default);
        Some(())
    }

    /// Whether a word is a choice parameter whose value is one of `words`.
    fn stands_for_one_of(&mut self, word: &str, words: &[String], span: &Span) -> bool {
        self.names.parameter_blocks.contains_key(word)
            && self.choice_word(word, span).is_some_and(|choice| words.contains(&choice))
    }

    /// Adds a channel to the names.
    pub fn channel(&mut self, name: &str, block: &Block) -> Option<()> {
        let unit = self.required(block, "in").and_then(|field| self.unit(&field.value));
        let places = self.places_of(block);
        let (unit, places) = (unit?, places?);
        let pattern = self.pattern(name, &places, block, "column");
        let track = match block.field("record").map(|field| (field.value.text.trim(), field)) {
            None => false,
            Some(("track", _)) => true,
            Some((other, field)) => {
                self.tell(
                    problem!("unknown-record", field, "`{other}` is not a kind of record")
                        .help("write `record track` for the track file; without `record`, the channel is in the records of simulation and measurement"),
                );
                false
            }
        };
        if let Some(optional) = self.optional(block)? {
            let columns = self.all_columns(&pattern, &places);
            let name = name.to_string();
            self.names.optional.push(OptionalChannel { name, columns, track, optional });
        }
        let span = block.place();
        let channel = Signal { places, is: None, unit: Some(unit), pattern, track, span };
        self.names.signals.insert(name.to_string(), channel);
        Some(())
    }

    /// Adds a computed signal to the names; a channel of the same name goes before it.
    pub fn computed_signal(&mut self, name: &str, block: &Block) -> Option<()> {
        let is = self.required(block, "is").and_then(|field| self.written(field));
        let places = self.places_of(block);
        let unit = block.field("in").map(|field| self.unit(&field.value));
        let (is, places, unit) = (Some(is?), places?, if_written(unit)?);
        let pattern = self.pattern(name, &places, block, "named");
        let signal = Signal { places, is, unit, pattern, track: false, span: block.place() };
        self.names.signals.entry(name.to_string()).or_insert(signal);
        Some(())
    }

    /// The columns of a channel, one for each position.
    fn all_columns(&self, pattern: &str, places: &[String]) -> Vec<String> {
        places.iter().fold(vec![pattern.to_string()], |columns, place| {
            let members = self.names.places.get(place).map_or(&[][..], |place| &place.members);
            let with = |column: String| {
                let filled = |member: &String| column.replace(&format!("{{{place}}}"), member);
                members.iter().map(filled).collect::<Vec<_>>()
            };
            columns.into_iter().flat_map(with).collect()
        })
    }

    fn places_of(&mut self, block: &Block) -> Option<Vec<String>> {
        block.field("at").map_or(Some(Vec::new()), |field| self.place_names(field))
    }

    /// The names of the positions, as the block states or such as `ay_{running_gear}`. Every place
    /// must occur in it; otherwise two positions would have the same column.
    fn pattern(&mut self, name: &str, places: &[String], block: &Block, key: &str) -> String {
        let field = block.field(key);
        let braces: String = places.iter().map(|place| format!("{{{place}}}")).collect();
        let pattern = match field {
            Some(field) => field.value.text.clone(),
            None if braces.is_empty() => name.to_string(),
            None => format!("{name}_{braces}"),
        };
        let span = field.map_or_else(|| block.place(), Field::place);
        for place in places {
            if !pattern.contains(&format!("{{{place}}}")) {
                self.tell(
                    problem!(
                        "pattern",
                        &span,
                        "`{pattern}` gives the same column for every {place}"
                    )
                    .help(format!("write {{{place}}} where the column name contains it")),
                );
            }
        }
        for part in pattern.split('{').skip(1) {
            let inside = part.split('}').next().unwrap_or("");
            if !places.iter().any(|place| place == inside) {
                self.tell(
                    problem!(
                        "pattern",
                        &span,
                        "`{{{inside}}}` in `{pattern}` is not a place of this channel"
                    )
                    .suggest(inside, places),
                );
            }
        }
        pattern
    }

    /// The place names of a field such as `each wheelset and side`.
    fn place_names(&mut self, field: &Field) -> Option<Vec<String>> {
        let picks = from_pest::places(&field.value, self.problems)?;
        let mut found = Vec::new();
        for Pick { words, more } in picks {
            let more = more.into_iter().map(|word| vec![word]);
            for mut words in std::iter::once(words).chain(more) {
                words.retain(|word| !is_each(&word.node));
                let Some(place) = self.place_called(&joined(&words)) else {
                    self.unknown_place(&words, field);
                    return None;
                };
                found.push(place);
            }
        }
        Some(found)
    }

    /// The place with a name in the singular or plural: `wheelset`, `wheelsets`, `axle boxes`,
    /// `bodies`.
    pub fn place_called(&self, word: &str) -> Option<String> {
        families::place_called(word, self.names.places.keys().map(String::as_str))
            .map(str::to_owned)
    }
}
