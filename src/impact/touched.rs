//! Which changed rules each part of a verdict can depend on: found from the names in the texts of
//! both protocols, in doubt one too many.

use std::collections::BTreeSet;

use indexmap::IndexMap;

use crate::check::{
    diff::{self, Change},
    normalised,
};
use crate::result::impact::ChangedRule;
use crate::syntax::document::{Block, Document, Field};

/// A set of changed rules, by their numbers.
pub type Mask = u64;

/// Kinds of blocks whose rules hold only where their names are used. All others hold everywhere.
const NAMED: [&str; 4] = ["define", "filter", "signal", "estimate"];
/// Fields of a quantity that are asked of its values when these are there.
const ASKED_OF_VALUES: [&str; 5] =
    ["limit", "outcome", "reported", "minimum signals", "minimum pairs"];
/// Fields of other blocks of which the same holds.
const ASKED_OF_SECTIONS: [(&str, &str); 5] = [
    ("zone", "minimum sections"),
    ("sections", "minimum"),
    ("sections", "removed"),
    ("sections", "keep"),
    ("domain", "otherwise"),
];
/// Fields of the verdict without a name that say how it is decided; the others say how quantities
/// are counted.
const DECIDING: [&str; 3] = ["validated", "words", "outcome"];
/// Fields of a quantity that name no other records and positions, as long as they name the same
/// signals.
const PROCESSING: [&str; 4] = ["filter", "value", "difference", "metric"];
/// So many changes of how values are made are taken together with what holds everywhere: a section
/// that one of them excludes is then excluded for all quantities, without another look.
const TOGETHER: u32 = 4;
/// So many rules are told apart; those behind them are taken together.
pub const MOST: usize = 63;

/// The set of one rule.
pub fn bit(at: usize) -> Mask {
    1 << at.min(MOST)
}

/// The changed rules that can touch a verdict, and what each of them can touch.
#[derive(Debug)]
pub struct Touched {
    pub changes: Vec<Change>,
    /// What is told of them, in the same order.
    pub told: Vec<ChangedRule>,
    /// Number of differences that touch no verdict.
    pub only_words: usize,
    /// What holds for every section and quantity.
    pub everywhere: Mask,
    /// Of each quantity: what its result depends on, the former included.
    pub quantities: IndexMap<String, Mask>,
    /// What decides, once all quantities have a result.
    pub verdicts: Mask,
    /// Whether values are made differently beside what holds everywhere.
    pub apart: bool,
}

impl Touched {
    /// Of two protocols, as merged with what they extend.
    pub fn of(before: &Document, after: &Document) -> Self {
        let all = diff::changes(before, after);
        let count = all.len();
        let some: Vec<Change> = all.into_iter().filter(|change| !change.only_words()).collect();
        let found = Self::by_names(some, [before, after]);
        let touching =
            found.everywhere | found.verdicts | found.quantities.values().fold(0, |a, b| a | b);
        let keeps = |at: usize| touching & bit(at) != 0;
        let numbers: Vec<usize> = (0..found.changes.len()).filter(|at| keeps(*at)).collect();
        // The numbers of those that are left.
        let moved = |mask: Mask| {
            let in_it = numbers.iter().enumerate().filter(|(_, from)| mask & bit(**from) != 0);
            in_it.map(|(to, _)| bit(to)).fold(0, |a, b| a | b)
        };
        let quantities = found.quantities.iter().map(|(id, mask)| (id.clone(), moved(*mask)));
        let changes: Vec<Change> = numbers.iter().map(|at| found.changes[*at].clone()).collect();
        Self {
            only_words: count - changes.len(),
            told: told(&changes),
            quantities: quantities.collect(),
            everywhere: moved(found.everywhere),
            verdicts: moved(found.verdicts),
            apart: found.apart,
            changes,
        }
    }

    fn by_names(changes: Vec<Change>, documents: [&Document; 2]) -> Self {
        let texts = Texts::of(&documents);
        let at_nodes = |nodes: &BTreeSet<Name>, but: &dyn Fn(&Change) -> bool| {
            mask(&changes, |change| !but(change) && nodes.contains(&name_of(change.block())))
        };
        let none = |_: &Change| false;
        let global = |change: &Change| match kind(change.block()) {
            "quantity" => false,
            "verdict" => {
                change.block().name.is_none()
                    && !field_key(change).is_some_and(|key| DECIDING.contains(&key))
            }
            kind => !NAMED.contains(&kind),
        };
        let reach = texts.reached(&texts.everywhere);
        let mut everywhere = mask(&changes, global) | at_nodes(&reach, &none);
        let (mut reduced, mut judged): (Mask, IndexMap<String, Mask>) = (0, IndexMap::new());
        let asked = |change: &Change| {
            kind(change.block()) == "quantity"
                && field_key(change).is_some_and(|key| ASKED_OF_VALUES.contains(&key))
        };
        for (id, [makes, asks]) in &texts.quantities {
            let own = ("quantity".to_string(), id.clone());
            let with_own = |text: &str| {
                let mut nodes = texts.reached(text);
                nodes.insert(own.clone());
                nodes
            };
            reduced |= at_nodes(&with_own(makes), &asked);
            judged.insert(id.clone(), at_nodes(&with_own(&format!("{makes} {asks}")), &none));
        }
        let other_signals = |change: &Change| texts.other_signals(change);
        everywhere |= reduced & mask(&changes, other_signals);
        if (reduced & !everywhere).count_ones() <= TOGETHER {
            everywhere |= reduced;
        }
        // A reduction of the sections asks for the values and limits of all quantities.
        if texts.keeps {
            everywhere = mask(&changes, |_| true);
        }
        judged.values_mut().for_each(|mask| *mask |= everywhere);
        let decides = |change: &Change| match kind(change.block()) {
            "quantity" => change.field().is_none(),
            kind => kind == "verdict" && !global(change),
        };
        Self {
            verdicts: mask(&changes, decides),
            apart: reduced & !everywhere != 0,
            told: Vec::new(),
            only_words: 0,
            quantities: judged,
            everywhere,
            changes,
        }
    }

    /// All of them.
    pub fn all(&self) -> Mask {
        mask(&self.changes, |_| true)
    }

    /// The names of the rules of a set.
    pub fn names(&self, set: Mask) -> Vec<String> {
        let rules = self.told.iter().enumerate().filter(|(at, _)| set & bit(*at) != 0);
        rules.map(|(_, told)| told.rule.clone()).collect()
    }
}

/// The rules by names that differ: a number stands behind one that is there several times.
fn told(changes: &[Change]) -> Vec<ChangedRule> {
    let of = |(at, Change { deviation, .. }): (usize, &Change)| {
        let same = |some: &[Change]| {
            some.iter().filter(|other| other.deviation.rule == deviation.rule).count()
        };
        let several = same(changes) > 1;
        let number =
            if several { format!(" ({})", 1 + same(&changes[..at])) } else { String::new() };
        ChangedRule {
            rule: format!("{}{number}", deviation.rule),
            before: deviation.before.clone(),
            after: deviation.after.clone(),
            reason: None,
        }
    };
    changes.iter().enumerate().map(of).collect()
}

fn mask(changes: &[Change], of: impl Fn(&Change) -> bool) -> Mask {
    let some = changes.iter().enumerate().filter(|(_, change)| of(change));
    some.map(|(at, _)| bit(at)).fold(0, |a, b| a | b)
}

fn kind(block: &Block) -> &str {
    &block.kind.text
}

fn field_key(change: &Change) -> Option<&str> {
    let [old, new] = change.field()?;
    Some(&old.or(new)?.key.text)
}

/// Kind and name of a block.
type Name = (String, String);

fn name_of(block: &Block) -> Name {
    (block.kind.text.clone(), block.name_text().to_string())
}

/// What stands in one or several documents, without what is only printed.
struct Texts {
    /// The text of each block that holds only where it is named.
    named: IndexMap<Name, String>,
    /// By which the values of a quantity are made, and what is asked of them.
    quantities: IndexMap<String, [String; 2]>,
    everywhere: String,
    /// Names of all blocks but filters.
    signals: BTreeSet<String>,
    keeps: bool,
}

impl Texts {
    fn of(documents: &[&Document]) -> Self {
        let (named, quantities, everywhere) = Default::default();
        let mut texts =
            Self { named, quantities, everywhere, signals: BTreeSet::new(), keeps: false };
        for block in documents.iter().flat_map(|document| &document.blocks) {
            if kind(block) != "filter" {
                texts.signals.insert(block.name_text().to_string());
            }
            let id = || block.name_text().to_string();
            match kind(block) {
                "verdict" => {}
                "protocol" => {
                    let axes = |field: &Field| matches!(&*field.key.text, "axis" | "time");
                    texts.everywhere.push_str(&fields(block, axes));
                }
                "quantity" => {
                    let [makes, asks] = texts.quantities.entry(id()).or_default();
                    let asked = |field: &Field| ASKED_OF_VALUES.contains(&&*field.key.text);
                    makes.push_str(&fields(block, |field| !asked(field)));
                    asks.push_str(&fields(block, asked));
                }
                of if NAMED.contains(&of) => {
                    let text = fields(block, |_| true);
                    texts.named.entry(name_of(block)).or_default().push_str(&text);
                }
                of => {
                    texts.keeps |= of == "sections" && block.field("keep").is_some();
                    let reduces =
                        |field: &Field| !ASKED_OF_SECTIONS.contains(&(of, field.key.text.as_str()));
                    let text = fields(block, reduces);
                    texts.everywhere.push_str(&format!("{of} {} {text}\n", block.name_text()));
                }
            }
        }
        texts
    }

    /// The blocks that a text names, and those that these name.
    fn reached(&self, text: &str) -> BTreeSet<Name> {
        let mut found = BTreeSet::new();
        let mut open = vec![text];
        while let Some(text) = open.pop() {
            let words: BTreeSet<&str> = words(text).collect();
            for (name, own) in &self.named {
                if names(text, &words, &name.1) && found.insert(name.clone()) {
                    open.push(own);
                }
            }
            let of_quantities = self.quantities.iter().filter(|(id, _)| names(text, &words, id));
            for (id, [makes, asks]) in of_quantities {
                if found.insert(("quantity".to_string(), id.clone())) {
                    open.extend([makes.as_str(), asks.as_str()]);
                }
            }
        }
        found
    }

    fn signals_in<'f>(&self, field: Option<&'f Field>) -> BTreeSet<&'f str> {
        let words = field.into_iter().flat_map(|field| words(&field.value.text));
        words.filter(|word| self.signals.contains(*word)).collect()
    }

    /// Whether a change may have other channels read.
    fn other_signals(&self, change: &Change) -> bool {
        match change.field() {
            _ if kind(change.block()) == "filter" => false,
            None => true,
            Some([old, new]) => {
                let key = field_key(change).unwrap_or_default();
                let in_place = kind(change.block()) == "define" || PROCESSING.contains(&key);
                !in_place || self.signals_in(old) != self.signals_in(new)
            }
        }
    }
}

/// Fields with their keys, as text.
fn fields(block: &Block, which: impl Fn(&Field) -> bool) -> String {
    let read = |field: &&Field| !diff::PRINTED.contains(&&*field.key.text) && which(field);
    let field = |field: &Field| format!("{} {}; ", field.key.text, normalised(&field.value.text));
    block.fields.iter().filter(read).map(field).collect()
}

fn is_letter(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !is_letter(c)).filter(|word| !word.is_empty())
}

/// Whether a text has a name in it; one that is no single word anywhere.
fn names(text: &str, words: &BTreeSet<&str>, name: &str) -> bool {
    if name.chars().all(is_letter) { words.contains(name) } else { text.contains(name) }
}

/// How the values of a protocol are made: two documents with the same key make the same ones.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Key {
    everywhere: String,
    /// Each quantity, in the order of the text.
    pub quantities: Vec<(String, String)>,
}

impl Key {
    pub fn of(document: &Document) -> Self {
        let texts = Texts::of(&[document]);
        let with_named = |text: &str| {
            let own = texts.reached(text);
            let of =
                |name: &Name| Some(format!("\n{} {}: {}", name.0, name.1, texts.named.get(name)?));
            format!("{text}{}", own.iter().filter_map(of).collect::<String>())
        };
        let quantities: Vec<(String, String)> = texts
            .quantities
            .iter()
            .map(|(id, [makes, _])| (id.clone(), with_named(makes)))
            .collect();
        // Plausibility rules ask which channels quantities read.
        let read: BTreeSet<&str> = quantities
            .iter()
            .flat_map(|(_, text)| words(text).filter(|word| texts.signals.contains(*word)))
            .collect();
        let everywhere = format!("{}\n{read:?}", with_named(&texts.everywhere));
        Self { everywhere, quantities }
    }

    /// Whether sections are the same, whatever their values are.
    pub fn same_sections(&self, other: &Self) -> bool {
        self.everywhere == other.everywhere
    }

    /// The place of a quantity that has the same values.
    pub fn place(&self, (id, text): &(String, String)) -> Option<usize> {
        self.quantities.iter().position(|(known, own)| known == id && own == text)
    }
}
