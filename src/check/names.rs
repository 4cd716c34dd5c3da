//! What the names of a protocol stand for: gathered first, so that rules may refer to what stands further down.

use indexmap::IndexMap;

use super::plan::{Datum, DatumKind, Scalar, SetBy, Type};
use super::scalars::Scope;
use super::{Checker, Override};
use crate::problem::Problem;
use crate::source::Span;
use crate::syntax::document::{Block, Field, Text};
use crate::syntax::from_pest;
use crate::syntax::phrase::{Alias, At, Node, Phrase, Pick};
use crate::units::{Dimension, Unit};

/// A phrase and the field it stands in, which knows its place.
#[derive(Clone, Debug)]
pub struct Written {
    pub phrase: Phrase,
    pub text: Text,
}

#[derive(Clone, Debug)]
pub struct ParameterDef {
    pub title: String,
    pub value: Scalar,
    pub ty: Type,
    pub value_words: String,
    pub default_words: String,
    pub set_by: SetBy,
}

#[derive(Clone, Debug)]
pub struct Place {
    pub members: Vec<String>,
    pub aliases: Vec<(Alias, Text)>,
}

#[derive(Clone, Debug)]
pub struct Channel {
    pub places: Vec<String>,
    pub unit: Unit,
    pub column: String,
    pub track: bool,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct SignalDef {
    pub places: Vec<String>,
    pub is: Written,
    pub unit: Option<Unit>,
    pub named: String,
    pub span: Span,
}

#[derive(Clone, Debug, Default)]
pub struct Names {
    pub parameters: IndexMap<String, ParameterDef>,
    pub places: IndexMap<String, Place>,
    pub vehicle: Vec<Datum>,
    pub columns: Vec<Datum>,
    pub channels: IndexMap<String, Channel>,
    pub signals: IndexMap<String, SignalDef>,
    pub defines: IndexMap<String, Written>,
    /// Filters: the block they stand in.
    pub filters: IndexMap<String, Block>,
}

/// Which position of each place is meant.
pub type Assignment = IndexMap<String, String>;

impl Checker<'_> {
    pub(super) fn gather_names(&mut self) {
        let blocks = std::mem::take(&mut self.blocks);
        for block in &blocks {
            let name = block.name_text().to_string();
            match block.kind.text.as_str() {
                "parameter" => self.parameter(&name, block),
                "place" => self.place(&name, block),
                "filter" => {
                    self.names.filters.insert(name, block.clone());
                }
                "define" => {
                    if let Some(is) = self.required(block, "is").and_then(|field| self.written(field)) {
                        self.names.defines.insert(name, is);
                    }
                }
                _ => {}
            }
        }
        for block in &blocks {
            let name = block.name_text().to_string();
            match block.kind.text.as_str() {
                "vehicle" => {
                    if let Some(datum) = self.datum(&name, block, "key", name.clone()) {
                        self.names.vehicle.push(datum);
                    }
                }
                "section" => {
                    if let Some(datum) = self.datum(&name, block, "column", name.replace('_', " ")) {
                        self.names.columns.push(datum);
                    }
                }
                "channel" => self.channel(&name, block),
                "signal" => self.signal_def(&name, block),
                _ => {}
            }
        }
        self.clashes(&blocks);
        self.blocks = blocks;
    }

    /// A name in two roles would make `radius` mean whichever the checker looks at first.
    fn clashes(&mut self, blocks: &[Block]) {
        const ROLES: [&str; 6] = ["parameter", "channel", "signal", "filter", "define", "section"];
        let mut seen: IndexMap<&str, &Block> = IndexMap::new();
        for block in blocks.iter().filter(|block| ROLES.contains(&block.kind.text.as_str())) {
            let name = block.name_text();
            if let Some(first) = seen.get(name) {
                if first.kind.text != block.kind.text {
                    self.problems.push(
                        Problem::error("name-clash", format!("`{name}` is a {} and a {}", first.kind.text, block.kind.text))
                            .at(block.span())
                            .also(first.span(), format!("the {}", first.kind.text)),
                    );
                }
            } else {
                seen.insert(name, block);
            }
        }
    }

    pub(super) fn written(&mut self, field: &Field) -> Option<Written> {
        let phrase = from_pest::expression(&field.value, self.problems)?;
        Some(Written { phrase, text: field.value.clone() })
    }

    /// A field that must be there.
    pub(super) fn required<'b>(&mut self, block: &'b Block, key: &str) -> Option<&'b Field> {
        let field = block.field(key);
        if field.is_none() {
            let kind = &block.kind.text;
            self.problems.push(
                Problem::error("missing-field", format!("{kind} `{}` has no `{key}`", block.name_text()))
                    .at(block.span())
                    .help(self.complete_hint(block, key)),
            );
        }
        field
    }

    /// A variant that names a quantity its parent lacks most likely misspelt it.
    fn complete_hint(&self, block: &Block, key: &str) -> String {
        let siblings = self.parent_names.iter().filter(|(kind, _)| *kind == block.kind.text).map(|(_, name)| name.as_str());
        match crate::problem::nearest(block.name_text(), siblings) {
            Some(near) => format!("the parent has `{near}`: to override it, use that name"),
            None => format!("add a line `{key} ...`"),
        }
    }

    pub(super) fn unit(&mut self, text: &Text) -> Option<Unit> {
        match Unit::parse(&text.text) {
            Ok(unit) => Some(unit),
            Err(unknown) => {
                let problem = Problem::error("unknown-unit", format!("`{}` is no unit", unknown.word)).at(&text.span);
                self.problems.push(match unknown.near {
                    Some(near) => problem.help(format!("did you mean `{near}`?")),
                    None => problem.help("units are written like kN, m/s^2, km/h, mrad, `-` for a plain number"),
                });
                None
            }
        }
    }

    fn parameter(&mut self, name: &str, block: &Block) {
        let Some(default) = self.required(block, "default") else { return };
        let title = block.title.as_ref().map_or(String::new(), |title| title.text.clone());
        let given = self.overrides.get(name).cloned();
        let default_words = normalised(&default.value.text);
        let (source, set_by) = match &given {
            Some(Override { text, set_by }) => (text.clone(), *set_by),
            None => (default.value.clone(), SetBy::Default),
        };
        let (value, ty) = if let Some(choices) = block.field("one of") {
            let Some(choices) = from_pest::list(&choices.value, self.problems) else { return };
            let choices: Vec<String> = choices.into_iter().map(|choice| choice.node).collect();
            for text in [&default.value, &source] {
                if !choices.contains(&text.text.trim().to_string()) {
                    self.problems.push(
                        Problem::error("unknown-choice", format!("`{}` is none of the choices of `{name}`", text.text.trim()))
                            .at(&text.span)
                            .suggest(text.text.trim(), choices.iter().map(String::as_str)),
                    );
                    return;
                }
            }
            (Scalar::Word(source.text.trim().to_string()), Type::Word(choices))
        } else {
            let Some((default_value, dimension)) = self.constant(&default.value) else { return };
            let Some((value, given_dimension)) = (if given.is_some() { self.constant(&source) } else { Some((default_value, dimension)) })
            else {
                return;
            };
            if given_dimension != dimension {
                self.problems.push(
                    Problem::error(
                        "unit-mismatch",
                        format!("parameter `{name}` is {}, this is {}", dimension.in_words(), given_dimension.in_words()),
                    )
                    .at(&source.span)
                    .also(&default.value.span, "its default"),
                );
                return;
            }
            if let Some(range) = block.field("range") {
                self.within_range(name, value, dimension, &source, range);
            }
            (Scalar::Number(value), Type::Number(dimension))
        };
        let value_words = normalised(&source.text);
        self.names.parameters.insert(name.to_string(), ParameterDef { title, value, ty, value_words, default_words, set_by });
    }

    fn within_range(&mut self, name: &str, value: f64, dimension: Dimension, source: &Text, range: &Field) {
        let Some((low, high)) = from_pest::range(&range.value, self.problems) else { return };
        let mut ends = [0.0; 2];
        for (end, phrase) in ends.iter_mut().zip([low, high]) {
            let Some((found, of)) = self.constant_phrase(&phrase, &range.value) else { return };
            if of != dimension {
                self.problems.push(
                    Problem::error(
                        "unit-mismatch",
                        format!("parameter `{name}` is {}, its range is {}", dimension.in_words(), of.in_words()),
                    )
                    .at(&range.value.place(phrase.range.clone()))
                    .also(&source.span, dimension.in_words()),
                );
                return;
            }
            *end = found;
        }
        if !(ends[0]..=ends[1]).contains(&value) {
            self.problems.push(
                Problem::error("out-of-range", format!("`{}` is outside the range of `{name}`", normalised(&source.text)))
                    .at(&source.span)
                    .also(&range.value.span, "the range")
                    .help(format!("allowed: {}", normalised(&range.value.text))),
            );
        }
    }

    /// A number that follows from constants alone, with its dimension.
    pub(super) fn constant(&mut self, text: &Text) -> Option<(f64, Dimension)> {
        let phrase = from_pest::expression(text, self.problems)?;
        self.constant_phrase(&phrase, text)
    }

    pub(super) fn constant_phrase(&mut self, phrase: &Phrase, text: &Text) -> Option<(f64, Dimension)> {
        let expr = self.expr(phrase, text, &mut Scope::constant())?;
        match (&expr.kind, &expr.ty) {
            (super::plan::Kind::Constant(Scalar::Number(value)), Type::Number(dimension)) => Some((*value, *dimension)),
            _ => {
                self.problems.push(
                    Problem::error("not-constant", format!("`{}` is not a number known beforehand", super::evaluate::words(&expr)))
                        .at(&expr.span)
                        .help("write a number with its unit, a parameter, or an expression of these"),
                );
                None
            }
        }
    }

    fn place(&mut self, name: &str, block: &Block) {
        let Some(members) = self.required(block, "members").and_then(|field| from_pest::list(&field.value, self.problems)) else { return };
        let members: Vec<String> = members.into_iter().map(|member| member.node).collect();
        let mut aliases = Vec::new();
        for field in block.fields_named("alias") {
            let Some(alias) = from_pest::alias(&field.value, self.problems) else { continue };
            for (member, _) in &alias.cases {
                if !members.contains(&member.node) {
                    self.problems.push(
                        Problem::error("unknown-place", format!("`{}` is no {name}", member.node))
                            .at(&field.value.place(member.range.clone()))
                            .suggest(&member.node, members.iter().map(String::as_str)),
                    );
                }
            }
            aliases.push((alias, field.value.clone()));
        }
        self.names.places.insert(name.to_string(), Place { members, aliases });
    }

    fn datum(&mut self, name: &str, block: &Block, key: &str, standard_key: String) -> Option<Datum> {
        let title = block.title.as_ref().map_or_else(|| name.replace('_', " "), |title| title.text.clone());
        let kind = match (block.field("in"), block.field("one of")) {
            (Some(unit), None) => DatumKind::Number(self.unit(&unit.value)?),
            (None, Some(words)) => {
                let words: Vec<String> = from_pest::list(&words.value, self.problems)?.into_iter().map(|word| word.node).collect();
                if words.len() == 2 && words.contains(&"true".to_string()) && words.contains(&"false".to_string()) {
                    DatumKind::Flag
                } else {
                    DatumKind::Words(words)
                }
            }
            _ => {
                self.problems.push(
                    Problem::error("missing-field", format!("{} `{name}` needs either `in` or `one of`", block.kind.text))
                        .at(block.span())
                        .help("`in kN` for a number, `one of right, left` for a word"),
                );
                return None;
            }
        };
        let default = match block.field("default") {
            None => None,
            Some(field) => Some(match &kind {
                DatumKind::Number(unit) => {
                    let (value, dimension) = self.constant(&field.value)?;
                    if dimension != unit.dimension {
                        self.problems.push(
                            Problem::error(
                                "unit-mismatch",
                                format!("`{name}` is {}, its default is {}", unit.dimension.in_words(), dimension.in_words()),
                            )
                            .at(&field.value.span),
                        );
                    }
                    Scalar::Number(value)
                }
                DatumKind::Flag => Scalar::Flag(field.value.text.trim() == "true"),
                DatumKind::Words(_) => Scalar::Word(field.value.text.trim().to_string()),
            }),
        };
        let key = block.field(key).map_or(standard_key, |field| field.value.text.trim().to_string());
        Some(Datum { name: name.to_string(), title, key, kind, default, span: block.span().clone() })
    }

    fn channel(&mut self, name: &str, block: &Block) {
        let Some(unit) = self.required(block, "in").and_then(|field| self.unit(&field.value)) else { return };
        let places = block.field("at").map_or(Some(Vec::new()), |field| self.place_names(field));
        let Some(places) = places else { return };
        let column = block.field("column").map_or_else(|| self.standard_pattern(name, &places), |field| field.value.text.clone());
        self.check_pattern(&column, &places, block, "column");
        let track = match block.field("record").map(|field| (field.value.text.trim(), field)) {
            None => false,
            Some(("track", _)) => true,
            Some((other, field)) => {
                self.problems.push(
                    Problem::error("unknown-record", format!("`{other}` is no kind of record of its own"))
                        .at(&field.value.span)
                        .help("`record track` for the track file; without `record` a channel stands in simulation and measurement"),
                );
                false
            }
        };
        self.names.channels.insert(name.to_string(), Channel { places, unit, column, track, span: block.span().clone() });
    }

    fn signal_def(&mut self, name: &str, block: &Block) {
        let Some(is) = self.required(block, "is").and_then(|field| self.written(field)) else { return };
        let places = block.field("at").map_or(Some(Vec::new()), |field| self.place_names(field));
        let Some(places) = places else { return };
        let unit = match block.field("in") {
            Some(field) => match self.unit(&field.value) {
                Some(unit) => Some(unit),
                None => return,
            },
            None => None,
        };
        let named = block.field("named").map_or_else(|| self.standard_pattern(name, &places), |field| field.value.text.clone());
        self.check_pattern(&named, &places, block, "named");
        self.names.signals.insert(name.to_string(), SignalDef { places, is, unit, named, span: block.span().clone() });
    }

    /// `ay_{running_gear}`
    fn standard_pattern(&self, name: &str, places: &[String]) -> String {
        let braces: String = places.iter().map(|place| format!("{{{place}}}")).collect();
        if braces.is_empty() { name.to_string() } else { format!("{name}_{braces}") }
    }

    /// Every place must appear, or two positions would share a column.
    fn check_pattern(&mut self, pattern: &str, places: &[String], block: &Block, key: &str) {
        let span = block.field(key).map_or_else(|| block.span().clone(), |field| field.value.span.clone());
        for place in places {
            if !pattern.contains(&format!("{{{place}}}")) {
                self.problems.push(
                    Problem::error("pattern", format!("`{pattern}` names the same column for every {place}"))
                        .at(&span)
                        .help(format!("put {{{place}}} where it stands in the name")),
                );
            }
        }
        for part in pattern.split('{').skip(1) {
            let inside = part.split('}').next().unwrap_or("");
            if !places.iter().any(|place| place == inside) {
                self.problems.push(
                    Problem::error("pattern", format!("`{{{inside}}}` in `{pattern}` is none of its places"))
                        .at(&span)
                        .suggest(inside, places.iter().map(String::as_str)),
                );
            }
        }
    }

    /// `each wheelset and side` into place names.
    fn place_names(&mut self, field: &Field) -> Option<Vec<String>> {
        let picks = from_pest::places(&field.value, self.problems)?;
        let mut found = Vec::new();
        for pick in picks {
            let Pick { words, more } = pick;
            let mut groups = vec![words];
            groups.extend(more.into_iter().map(|word| vec![word]));
            for group in groups {
                let words: Vec<&At<String>> = group.iter().filter(|word| !matches!(word.node.as_str(), "each" | "every" | "all")).collect();
                let joined = words.iter().map(|word| word.node.as_str()).collect::<Vec<_>>().join("_");
                match self.place_called(&joined) {
                    Some(place) => found.push(place),
                    None => {
                        let range =
                            words.first().map_or(0..field.value.text.len(), |first| first.range.start..words[words.len() - 1].range.end);
                        let names: Vec<String> = self.names.places.keys().cloned().collect();
                        self.problems.push(
                            Problem::error("unknown-place", format!("`{joined}` is no place"))
                                .at(&field.value.place(range))
                                .suggest(&joined, names.iter().map(String::as_str)),
                        );
                        return None;
                    }
                }
            }
        }
        Some(found)
    }

    /// The place of a name in the singular or plural.
    pub(super) fn place_called(&self, word: &str) -> Option<String> {
        let singular = word.strip_suffix('s').unwrap_or(word);
        self.names.places.keys().find(|name| *name == word || *name == singular).cloned()
    }
}

pub fn normalised(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Whether a phrase is one bare word, such as the name of a choice.
pub fn bare_word(phrase: &Phrase) -> Option<&str> {
    match &phrase.node {
        Node::Path(path) if !path.contains('.') => Some(path),
        _ => None,
    }
}
