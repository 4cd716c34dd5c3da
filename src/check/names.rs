//! The names of a protocol and their meanings, gathered first, so that rules can refer to blocks
//! further down.

use indexmap::IndexMap;
use std::collections::BTreeSet;

use super::{prelude::*, references::LIMIT};
use crate::catalog::{Reducer, Statistic};
use crate::syntax::phrase::Alias;
use crate::units::SYMBOLS;

/// A parameter with the value that is used.
#[derive(Clone, Debug)]
pub struct ParameterDef {
    pub title: String,
    /// Without one, what follows where it is not set.
    pub value: Result<Scalar, Optional>,
    pub ty: Type,
    pub value_words: String,
    pub default_words: String,
    pub set_by: SetBy,
    /// The place and the positions selected, where the parameter is a selection.
    pub selects: Option<(String, Vec<String>)>,
    /// Both ends of the range of a number, in SI.
    pub range: Option<[f64; 2]>,
}

/// The positions of a place and their aliases.
#[derive(Clone, Debug)]
pub struct Place {
    pub members: Vec<String>,
    pub aliases: Vec<Alias>,
}

/// A channel, or a signal that is computed from others: one for each position.
#[derive(Clone, Debug)]
pub struct Signal {
    pub places: Vec<String>,
    /// How a computed signal follows from others; `None` for a channel.
    pub is: Option<Phrase>,
    /// The unit that is stated; a channel always has one.
    pub unit: Option<Unit>,
    /// The column of a channel, or the name of a computed signal, with the places in braces.
    pub pattern: String,
    /// Whether it is a channel of the track record.
    pub track: bool,
    pub span: Span,
}

/// All names of a protocol.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Parameters checked so far.
    pub parameters: IndexMap<String, ParameterDef>,
    pub parameter_blocks: IndexMap<String, Block>,
    pub places: IndexMap<String, Place>,
    pub vehicle: Vec<Datum>,
    pub columns: Vec<Datum>,
    pub records: Vec<DeclaredRecord>,
    pub optional: Vec<OptionalChannel>,
    /// Channels, then the signals that are computed from them.
    pub signals: IndexMap<String, Signal>,
    pub defines: IndexMap<String, Phrase>,
    /// Names of the arguments of those definitions that have some.
    pub arguments: IndexMap<String, Vec<String>>,
    pub estimates: IndexMap<String, Phrase>,
    /// Blocks of the filters.
    pub filters: IndexMap<String, Block>,
    /// Names whose block has an error. They are not reported as unknown.
    pub failed: BTreeSet<String>,
}

impl Checker<'_> {
    /// Gathers the names of all blocks.
    pub fn gather_names(&mut self) {
        let blocks = self.blocks.clone();
        for block in &blocks {
            let name = block.own_name();
            self.usable_name(block);
            let gathered = match block.kind.text.as_str() {
                "parameter" => {
                    self.names.parameter_blocks.insert(name.clone(), block.clone());
                    Some(())
                }
                "filter" => {
                    self.names.filters.insert(name.clone(), block.clone());
                    Some(())
                }
                "place" => self.place(&name, block).map(|place| {
                    self.names.places.insert(name.clone(), place);
                }),
                kind @ ("define" | "estimate") => self.expression_named(kind, &name, block),
                "record" => {
                    self.declared_record(&name, block).map(|record| self.names.records.push(record))
                }
                "vehicle" => self
                    .datum(&name, block, "key", name.clone())
                    .map(|datum| self.names.vehicle.push(datum)),
                "section" => self
                    .datum(&name, block, "column", name.replace('_', " "))
                    .map(|datum| self.names.columns.push(datum)),
                _ => Some(()),
            };
            if gathered.is_none() {
                self.names.failed.insert(name);
            }
        }
        for block in &blocks {
            let name = block.own_name();
            let found = match block.kind.text.as_str() {
                "parameter" => self.parameter(&name, block.span()).map(drop),
                "vehicle" | "section" => self.datum_default(&name, block),
                "channel" => self.channel(&name, block),
                "signal" => self.computed_signal(&name, block),
                _ => Some(()),
            };
            if found.is_none() {
                self.names.failed.insert(name);
            }
        }
        self.names.signals.sort_by(|_, a, _, b| a.is.is_some().cmp(&b.is.is_some()));
        self.clashes(&blocks);
    }

    /// A definition or an estimate.
    fn expression_named(&mut self, kind: &str, name: &str, block: &Block) -> Option<()> {
        let is = self.required(block, "is").and_then(|field| self.written(field))?;
        if let Some(field) = block.field("of") {
            let arguments = self.argument_names(field)?;
            self.names.arguments.insert(name.to_string(), arguments);
        }
        let known = match kind {
            "define" => &mut self.names.defines,
            _ => &mut self.names.estimates,
        };
        known.insert(name.to_string(), is);
        Some(())
    }

    /// The names of the arguments of a definition, each once.
    fn argument_names(&mut self, field: &Field) -> Option<Vec<String>> {
        let written = from_pest::list(&field.value, self.problems)?;
        let mut names: Vec<String> = Vec::new();
        for argument in &written {
            let name = &argument.node;
            if names.contains(name) {
                let says = format!("`{name}` is named twice");
                return self.refuse(error("duplicate-name", says, argument));
            }
            if from_pest::is_word_of_language(name)
                || name == LIMIT
                || Reducer::named(name).is_some()
            {
                let says = format!("`{name}` is a word of the language and no name of an argument");
                return self.refuse(error("reserved-name", says, argument));
            }
            names.push(name.clone());
        }
        Some(names)
    }

    /// Reports a name that an expression could not use or would read as something else.
    fn usable_name(&mut self, block: &Block) {
        const IN_EXPRESSIONS: [&str; 10] = [
            "record",
            "parameter",
            "place",
            "vehicle",
            "section",
            "channel",
            "signal",
            "filter",
            "define",
            "estimate",
        ];
        let (kind, name) = (block.kind.text.as_str(), block.name_text());
        if name.is_empty() || !IN_EXPRESSIONS.contains(&kind) {
            return;
        }
        let percentile = name
            .strip_prefix('p')
            .is_some_and(|rest| !rest.is_empty() && rest.chars().all(|c| c.is_ascii_digit()));
        // `limit of std` would read as a product.
        const OF_NUMBERS: [&str; 5] = ["parameter", "vehicle", "section", "define", "estimate"];
        const OF_GROUPS: [&str; 8] =
            ["n", "value", "share", "total", "upper", "lower", "prediction", "regression"];
        let taken = if from_pest::is_word_of_language(name)
            || kind == "estimate" && OF_GROUPS.contains(&name)
            || name == LIMIT && OF_NUMBERS.contains(&kind)
        {
            Some("a word of the language")
        } else if percentile {
            Some("a percentile")
        } else if Reducer::named(name).is_some() {
            Some("a value taken from a signal")
        } else if Statistic::named(name).is_some() {
            Some("a statistic")
        } else {
            None
        };
        if let Some(what) = taken {
            let help = format!("for instance `{name}_1`, or a longer name");
            self.tell(
                problem!(
                    "reserved-name",
                    block,
                    "`{name}` is {what}, so this {kind} needs another name"
                )
                .help(help),
            );
        } else if let Some(sign) = name
            .chars()
            .find(|c| !c.is_ascii_alphanumeric() && *c != '_')
            .or_else(|| name.chars().next().filter(char::is_ascii_digit))
        {
            self.tell(
                problem!("bad-name", block, "a {kind} cannot be called `{name}`: in an expression, `{sign}` is not read as part of a name")
                    .help("use letters, digits and `_`, and begin with a letter"),
            );
        } else if let Some(unit) =
            SYMBOLS.iter().find(|unit| unit.symbol == name && kind != "filter" && kind != "place")
        {
            self.tell(
                warning("unit-name", format!("`{name}` is also a unit ({})", unit.name), block)
                    .help(format!("after a number, `{name}` is read as the unit, elsewhere as the {kind}; a longer name is clearer")),
            );
        }
    }

    /// Reports names with two roles: an expression could not tell which is meant.
    fn clashes(&mut self, blocks: &[Block]) {
        const ROLES: [&str; 8] = [
            "parameter",
            "channel",
            "signal",
            "filter",
            "define",
            "estimate",
            "section",
            "vehicle",
        ];
        let mut seen: IndexMap<&str, &Block> = IndexMap::new();
        for block in blocks.iter().filter(|block| ROLES.contains(&block.kind.text.as_str())) {
            let name = block.name_text();
            let Some(first) = seen.get(name) else {
                seen.insert(name, block);
                continue;
            };
            let (a, b) = (first.kind.text.as_str(), block.kind.text.as_str());
            // `vehicle.speed` and `section.speed` distinguish these.
            let data = |kind: &str| matches!(kind, "vehicle" | "section");
            if a != b && !(data(a) && data(b)) {
                self.tell(
                    problem!("name-clash", block, "`{name}` is a {a} and a {b}")
                        .also(first, format!("the {a}")),
                );
            }
        }
    }

    /// The expression in a field.
    pub fn written(&mut self, field: &Field) -> Option<Phrase> {
        from_pest::expression(&field.value, self.problems)
    }

    /// A required field.
    pub fn required<'b>(&mut self, block: &'b Block, key: &str) -> Option<&'b Field> {
        self.all_required(block, &[key]);
        block.field(key)
    }

    /// Reports all missing required fields in one problem.
    pub fn all_required(&mut self, block: &Block, keys: &[&str]) {
        let missing: Vec<String> = keys
            .iter()
            .filter(|key| block.field(key).is_none())
            .map(|key| format!("`{key}`"))
            .collect();
        let Some(first) = missing.first() else { return };
        let kind = &block.kind.text;
        let list = match missing.split_last() {
            Some((last, before)) if !before.is_empty() => {
                format!("{} and no {last}", before.join(", no "))
            }
            _ => first.clone(),
        };
        // A variant that names a quantity its parent lacks has most likely misspelt it.
        let siblings =
            self.parent_names.iter().filter(|(of, _)| of == kind).map(|(_, name)| name.as_str());
        let help = match crate::problem::nearest(block.name_text(), siblings) {
            Some(near) => format!("the parent has `{near}`: to override it, use that name"),
            None if missing.len() == 1 => format!("add a line {first} ..."),
            None => format!("add lines {} ...", missing.join(" ..., ")),
        };
        let name = format!("{kind} {}", block.name_text());
        self.tell(
            problem!("missing-field", block, "`{}` has no {list}", name.trim())
                .help(help.replace("` ...", " ...`")),
        );
    }

    /// The section column of a name; a problem where there is none.
    pub fn column_called(&mut self, what: &str, name: &str, at: &impl Located) -> Option<usize> {
        let columns = &self.names.columns;
        let found = columns.iter().position(|datum| datum.name == name);
        if found.is_none() {
            let known = columns.iter().map(|datum| &datum.name);
            self.tell(
                problem!("unknown-name", at, "no section {what} is called `{name}`")
                    .suggest(name, known),
            );
        }
        found
    }

    /// The unit of a text; a problem if it is not known.
    pub fn unit(&mut self, text: &Text) -> Option<Unit> {
        let unknown = match Unit::parse(&text.text) {
            Ok(unit) => return Some(unit),
            Err(unknown) => unknown,
        };
        let help = match unknown.near {
            Some(near) => format!("did you mean `{near}`?"),
            None => "units are written like kN, m/s^2, km/h, mrad, `-` for a plain number".into(),
        };
        self.refuse(
            problem!("unknown-unit", text, "`{}` is not a known unit", unknown.word).help(help),
        )
    }
}

/// The word, where a phrase is one word only, such as a choice.
pub fn bare_word(phrase: &Phrase) -> Option<&str> {
    match &phrase.node {
        Node::Path(path) if !path.contains('.') => Some(path),
        _ => None,
    }
}
