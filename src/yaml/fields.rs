//! Maps with known keys as structs: the fields of a struct are the table of its keys.
//!
//! Serde would stop at the first problem. Here every field is read, and each problem is told with
//! its place.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::{Key, Node, Value};
use crate::problem::{Problem, Problems, error, problem};
use crate::source::{Span, Spanned};
use crate::units::{Dimension, Unit, UnknownUnit, number};

/// Reads the values of a tree, and collects what is wrong with them.
#[derive(Debug)]
pub struct Reader<'a, C = ()> {
    /// What the values of this kind of file are read with: its folder, names that exist.
    pub with: C,
    pub problems: &'a mut Problems,
}

/// A value that a key can have.
pub trait FromNode<C>: Sized {
    /// The keys, if it is a map with known ones.
    const INNER: &'static [&'static str] = &[];

    /// The value; `None` if it is faulty, which is told.
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self>;

    /// The value where the key is not there; `None` if it must be.
    fn absent() -> Option<Self> {
        None
    }
}

/// A struct whose fields are the keys of a map, read in their order.
///
/// ```text
/// fields! {
///     /// How the clock of a record runs.
///     pub struct Time in &Sections: "`{key}`" {
///         /// The channel.
///         "from" from: OneOrMore<String>,
///         "drift" drift: f64 = 0.0,
///         "file" file: Option<String> => "the path of the record",
///     } also {
///         span: Span = span_of_value,
///     }
/// }
/// ```
///
/// `in` gives the type of [`Reader::with`], the text says what the map is. Of a key, `=` gives the
/// value where it is missing or faulty, and `=>` tells that it must be there, and what it is. A
/// function in brackets reads the value of an optional key, as [`FromNode::from_node`] would. After
/// `also` stand fields that a function makes of the key and the value of the map. `or Free` after
/// the text allows further keys.
///
/// Problems: `wrong-kind`, `unknown-key` with the nearest key, `key-missing`, those of the values.
macro_rules! fields {
    ($(#[$about:meta])* $seen:vis struct $name:ident in $with:ty: $($rest:tt)*) => {
        $crate::yaml::fields!(@all [] [$with] [$(#[$about])* $seen] $name $($rest)*);
    };
    ($(#[$about:meta])* $seen:vis struct $name:ident: $($rest:tt)*) => {
        $crate::yaml::fields!(@all [C] [C] [$(#[$about])* $seen] $name $($rest)*);
    };
    (@all [$($free:ident)?] [$with:ty] [$(#[$about:meta])* $seen:vis] $name:ident $what:literal $(or $others:ident)? {
        $($(#[$says:meta])* $key:literal $field:ident $(($read:path))?: $kind:ty $(= $default:expr)? $(=> $missing:literal)?,)*
    } $(also { $($(#[$tells:meta])* $other:ident: $type:ty = $make:path,)* })?) => {
        $(#[$about])*
        // A key may be there only to be known: its value is read from the tree, or by others.
        #[allow(dead_code)]
        #[derive(Clone, Debug)]
        $seen struct $name {
            $($(#[$says])* pub $field: $kind,)*
            $($($(#[$tells])* pub $other: $type,)*)?
        }

        impl $name {
            /// The keys of the map.
            pub const KEYS: &[&str] = &[$($key),*];
        }

        impl $(<$free>)? $crate::yaml::FromNode<$with> for $name {
            const INNER: &'static [&'static str] = Self::KEYS;

            fn from_node(
                reader: &mut $crate::yaml::Reader<'_, $with>,
                key: &$crate::yaml::Key,
                node: &$crate::yaml::Node,
            ) -> Option<Self> {
                let inner = [$(($key, $crate::yaml::fields!(@inner [$with] [$($read)?] $kind)),)*];
                let others = [$($crate::yaml::OtherKeys::$others,)? $crate::yaml::OtherKeys::Refused][0];
                if !reader.keys(node, &$what.replace("{key}", &key.text), &inner, others) {
                    return None;
                }
                $(let $field = $crate::yaml::fields!(@value reader node $key $(($read))? $(= $default)? $(=> $missing)?);)*
                Some(Self { $($field: $field?,)* $($($other: $make(reader, key, node),)*)? })
            }
        }
    };
    (@inner [$with:ty] [] $kind:ty) => { <$kind as $crate::yaml::FromNode<$with>>::INNER };
    (@inner [$with:ty] [$read:path] $kind:ty) => { &[] as &[&str] };
    (@value $reader:ident $node:ident $key:literal ($read:path)) => {
        Some($node.entry($key).and_then(|(key, node)| $read($reader, key, node)))
    };
    (@value $reader:ident $node:ident $key:literal = $default:expr) => {
        $reader.optional($node, $key).or_else(|| Some($default))
    };
    (@value $reader:ident $node:ident $key:literal => $missing:literal) => {
        $reader.value($node, $key, $missing)
    };
    (@value $reader:ident $node:ident $key:literal) => {
        $reader.value($node, $key, "")
    };
}
pub(crate) use fields;

/// What keys are that a map is not known to have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OtherKeys {
    /// Faults.
    Refused,
    /// Whatever the file states beyond; one letter off a known key, they are slips of it.
    Free,
    /// Of other programs.
    Ignored,
}

impl<C> Reader<'_, C> {
    /// Tells a problem.
    pub fn tell(&mut self, problem: Problem) {
        self.problems.push(problem);
    }

    /// Tells a problem at a place.
    pub fn fault(&mut self, code: &'static str, says: impl Into<String>, at: &Span) {
        self.tell(error(code, says, at));
    }

    /// The value of a result; a problem is told.
    pub fn keep<T>(&mut self, result: Result<T, Problem>) -> Option<T> {
        self.problems.value(result)
    }

    /// A whole file, of which nothing stands above.
    pub fn file<T: FromNode<C>>(&mut self, tree: &Node) -> Option<T> {
        let top = Key { text: String::new(), span: tree.span.part(0..0), exact: false };
        T::from_node(self, &top, tree)
    }

    /// The value of a key that is there and right.
    pub fn optional<T: FromNode<C>>(&mut self, map: &Node, key: &str) -> Option<T> {
        let (key, node) = map.entry(key)?;
        T::from_node(self, key, node)
    }

    /// The value of a key. It must be there if its type does not allow that it is missing, or if
    /// it is said `what` it is.
    pub fn value<T: FromNode<C>>(&mut self, map: &Node, key: &str, what: &str) -> Option<T> {
        if map.get(key).is_some() {
            return self.optional(map, key);
        }
        let absent = T::absent();
        if absent.is_none() || !what.is_empty() {
            let colon = if what.is_empty() { "" } else { ": " };
            let problem =
                problem!("key-missing", &map.span.part(0..0), "`{key}` is missing{colon}{what}");
            self.tell(problem.help(format!("write `{key}: ...`")));
        }
        absent
    }

    /// Whether the node is a map; keys that are not known are told. `inner`: the keys, and those of
    /// the maps below each, where an unknown one may belong.
    pub fn keys(
        &mut self,
        node: &Node,
        what: &str,
        inner: &[(&str, &[&str])],
        others: OtherKeys,
    ) -> bool {
        let Value::Map(entries) = &node.value else {
            self.tell(node.is_not(what, "a map of keys and values"));
            return false;
        };
        let known = || inner.iter().map(|(key, _)| *key);
        for (key, value) in entries.iter().filter(|(key, _)| known().all(|known| known != key.text))
        {
            let name = key.text.as_str();
            let problem = problem!("unknown-key", "{what} has no key `{name}`");
            let problem = problem.at(&key.span);
            let lower = name.to_lowercase();
            let slip = known().find(|known| strsim::damerau_levenshtein(&lower, known) <= 1);
            let above = inner.iter().find(|(_, below)| below.contains(&name));
            self.tell(match (others, slip, above) {
                (OtherKeys::Refused, _, Some((map, _))) => problem.help(format!(
                    "`{name}` stands in `{map}`: `{map}: {{{name}: {}}}`",
                    value.raw
                )),
                (OtherKeys::Refused, _, None) => problem.suggest(name, known()),
                (OtherKeys::Free, Some(near), _) => problem.meant(near),
                _ => continue,
            });
        }
        true
    }

    /// The unit of a text.
    pub fn unit(&mut self, text: &str, at: &Span) -> Option<Unit> {
        self.keep(Unit::parse(text).map_err(|unknown| unknown_unit(&unknown, at)))
    }
}

impl Node {
    /// The problem that a value is of another kind: `what` must `be` something else.
    pub fn is_not(&self, what: &str, be: &str) -> Problem {
        problem!("wrong-kind", &self.span, "{what} must be {be}, not {}", self.kind_in_words())
    }
}

/// The problem of a text that is no unit.
pub fn unknown_unit(unknown: &UnknownUnit, at: &Span) -> Problem {
    let problem = problem!("unknown-unit", at, "`{}` is not a known unit", unknown.word);
    match unknown.near {
        Some(near) => problem.meant(near),
        None => problem,
    }
}

/// The place of a value, for a field that is no key.
pub fn span_of_value<C>(_: &mut Reader<'_, C>, _: &Key, node: &Node) -> Span {
    node.span.clone()
}

/// Help for a value that begins with a brace, which is a map for YAML.
pub fn quoted(key: &str, value: &str) -> String {
    format!("a value that begins with `{{` needs quotes: `{key}: \"{value}\"`")
}

impl<C> FromNode<C> for Node {
    fn from_node(_: &mut Reader<'_, C>, _: &Key, node: &Node) -> Option<Self> {
        Some(node.clone())
    }
}

/// A text that is not empty, without blanks around it.
impl<C> FromNode<C> for String {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        let text = node.scalar_text().map(str::trim).filter(|text| !text.is_empty());
        if text.is_none() {
            let problem = node.is_not(&format!("`{}`", key.text), "text");
            // `{section}` alone is a map for YAML.
            let braces = matches!(node.entries(), [(_, value)] if value.value == Value::Null);
            let help = braces.then(|| quoted(&key.text, node.span.text()));
            reader.tell(problem.help_if(help));
        }
        text.map(str::to_string)
    }
}

/// A text as it stands, with blanks and line breaks.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Literal(pub String);

impl<C> FromNode<C> for Literal {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        let text = node.is_scalar().then(|| Self(node.raw.clone()));
        reader.read(key, node, "text", text)
    }
}

impl<C> Reader<'_, C> {
    /// What was read of a node; that nothing was is told with what it must `be`.
    fn read<T>(&mut self, key: &Key, node: &Node, be: &str, read: Option<T>) -> Option<T> {
        if read.is_none() {
            self.tell(node.is_not(&format!("`{}`", key.text), be));
        }
        read
    }
}

impl<C> FromNode<C> for f64 {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        reader.read(key, node, "a number", node.number())
    }
}

impl<C> FromNode<C> for usize {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        let number = node.scalar_text().and_then(|text| text.trim().parse().ok());
        reader.read(key, node, "a whole number", number)
    }
}

impl<C> FromNode<C> for bool {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        let truth = if let Value::Bool(truth) = node.value { Some(truth) } else { None };
        reader.read(key, node, "true or false", truth)
    }
}

impl<C> FromNode<C> for Unit {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        let text = String::from_node(reader, key, node)?;
        reader.unit(&text, &node.span)
    }
}

/// A value with its place.
impl<C, T: FromNode<C>> FromNode<C> for Spanned<T> {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        Some(Self::new(T::from_node(reader, key, node)?, node.span.clone()))
    }
}

/// A value that may be missing; a faulty one is told, and missing as well.
impl<C, T: FromNode<C>> FromNode<C> for Option<T> {
    const INNER: &'static [&'static str] = T::INNER;

    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        Some(T::from_node(reader, key, node))
    }

    fn absent() -> Option<Self> {
        Some(None)
    }
}

/// A list of values; those that are right.
impl<C, T: FromNode<C>> FromNode<C> for Vec<T> {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        if !matches!(node.value, Value::List(_) | Value::Null) {
            reader.tell(node.is_not(&format!("`{}`", key.text), "a list"));
        }
        Some(node.items().iter().filter_map(|item| T::from_node(reader, key, item)).collect())
    }

    fn absent() -> Option<Self> {
        Some(Self::new())
    }
}

/// A list of values, or a single one without the brackets.
#[derive(Clone, Debug, Default)]
pub struct OneOrMore<T>(pub Vec<T>);

impl<C, T: FromNode<C>> FromNode<C> for OneOrMore<T> {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        if matches!(node.value, Value::List(_)) {
            return Vec::from_node(reader, key, node).map(Self);
        }
        Some(Self(T::from_node(reader, key, node).into_iter().collect()))
    }

    fn absent() -> Option<Self> {
        Some(Self(Vec::new()))
    }
}

/// A map with free keys; the entries that are right, in the order written.
#[derive(Clone, Debug, Default)]
pub struct Entries<T>(pub Vec<(Key, T)>);

impl<C, T: FromNode<C>> FromNode<C> for Entries<T> {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        if !matches!(node.value, Value::Map(_)) {
            let problem = node.is_not(&format!("`{}`", key.text), "a map of names and values");
            reader.tell(problem);
        }
        let mut read = |(key, node): &(Key, Node)| {
            T::from_node(reader, key, node).map(|value| (key.clone(), value))
        };
        Some(Self(node.entries().iter().filter_map(&mut read).collect()))
    }

    fn absent() -> Option<Self> {
        Some(Self(Vec::new()))
    }
}

impl<C, T: FromNode<C>> FromNode<C> for IndexMap<String, T> {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        let Entries(entries) = Entries::from_node(reader, key, node)?;
        Some(entries.into_iter().map(|(key, value)| (key.text, value)).collect())
    }

    fn absent() -> Option<Self> {
        Some(Self::new())
    }
}

/// Values that are written as words.
pub trait Words: Copy + PartialEq + 'static {
    /// The code of the problem that a word is none of them.
    const CODE: &'static str = "unknown-word";
    /// Every word with its value; of several words for one value, the first is printed.
    const WORDS: &'static [(&'static str, Self)];

    /// The word of a value.
    fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, value)| *value == self).map_or("", |(word, _)| word)
    }

    /// The value of a word.
    fn from_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(known, _)| *known == word).map(|(_, value)| *value)
    }
}

impl<C, T: Words> FromNode<C> for T {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        let text = String::from_node(reader, key, node)?;
        let value = T::from_word(&text);
        if value.is_none() {
            let problem = problem!(T::CODE, "`{}` cannot be `{text}`", key.text);
            let known = T::WORDS.iter().map(|(word, _)| *word);
            reader.tell(problem.at(&node.span).suggest(&text, known));
        }
        value
    }
}

/// A number in SI that states its unit, each type for one dimension.
pub trait Quantity: Copy {
    /// The SI unit.
    fn unit() -> Unit;

    /// In SI.
    fn si(self) -> f64;
}

macro_rules! quantities {
    ($($(#[$about:meta])* $name:ident $unit:literal $dimension:ident,)*) => {$(
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name(pub f64);

        impl Quantity for $name {
            fn unit() -> Unit {
                Unit { text: $unit.into(), factor: 1.0, dimension: Dimension::$dimension }
            }

            fn si(self) -> f64 {
                self.0
            }
        }

        impl<C> FromNode<C> for $name {
            fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
                let text = String::from_node(reader, key, node)?;
                let read = quantity(&key.text, &text, &node.span, &Self::unit());
                reader.keep(read).map(Self)
            }
        }
    )*};
}

quantities! {
    /// A length in m.
    Metres "m" LENGTH,
    /// A time in s.
    Seconds "s" TIME,
    /// A rate in Hz.
    Hertz "Hz" FREQUENCY,
    /// A number without a dimension; it may be in `%` or `ppm`.
    Ratio "-" ONE,
}

/// The number of a text in SI. It states its unit, unless it has no dimension.
fn quantity(key: &str, text: &str, at: &Span, unit: &Unit) -> Result<f64, Problem> {
    let read = number::read(text, unit).map_err(|refused| {
        problem!("wrong-number", at, "`{key}`: {}", refused.says).help_if(refused.help)
    })?;
    if read.unit_stated || unit.dimension == Dimension::ONE {
        return Ok(read.si);
    }
    let help = format!("write `{text} {unit}`, if that is meant");
    Err(problem!("unit-missing", at, "`{key}` has no unit; it is {}", unit.dimension.in_words())
        .help(help))
}
