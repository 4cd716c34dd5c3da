//! Families of blocks: a block with `for each` stands for one block for each member.
//!
//! Families are expanded on the document before it is checked, so that all later stages have plain
//! blocks. Printing keeps the document as written.

mod each;
mod fill;

use std::{collections::BTreeMap, sync::Arc};

use indexmap::IndexMap;

use super::{
    document::{Block, Comments, Document, Field, Text},
    from_pest,
    keys::{self, EACH, Kind, Sort},
    layout::Quotes,
    lines,
};
use crate::problem::{Problem, Problems, error, nearest, problem};
use crate::source::{Filled, Member, Span, Spanned};
use each::{Group, Word};
use fill::{Template, Use};

/// Largest number of members of a family. More are probably a mistake in a list.
const MOST_MEMBERS: usize = 1000;
/// Largest number of blocks of all families of a protocol. Merging compares blocks in pairs by
/// name.
const MOST_BLOCKS: usize = 10_000;
/// Largest size of all expanded families, in bytes: ten times the largest protocol that is read.
const MOST_BYTES: usize = 20 << 20;

/// Places by name, each with its positions.
pub type Places = IndexMap<String, Vec<String>>;

/// A family of an ancestor. A variant can override or remove it by its name as written.
#[derive(Clone, Debug)]
pub struct Known {
    pub kind: String,
    pub name: String,
    each: Vec<Field>,
    /// Names of its blocks.
    pub members: Vec<String>,
}

/// Expands the families of a document. `before` is the merged document of its ancestors, `known`
/// contains their families; those of the document are added to it. Also returns the names, as written, of the blocks
/// that are missing because a family could not be expanded.
pub fn expand(
    document: &Document,
    before: Option<&Document>,
    known: &mut Vec<Known>,
    problems: &mut Problems,
) -> (Document, Vec<String>) {
    let mut places = Places::new();
    let blocks = before.into_iter().chain([document]).flat_map(|document| &document.blocks);
    for block in blocks.filter(|block| block.kind.text == "place") {
        // Errors of a place are reported where the place is checked.
        let members = block
            .field("members")
            .and_then(|field| from_pest::list(&field.value, &mut Problems::default()));
        if let Some(members) = members {
            places
                .insert(block.own_name(), members.into_iter().map(|member| member.node).collect());
        }
    }
    let mut writer = Writer {
        places,
        before,
        known,
        problems,
        blocks: Vec::new(),
        seen: BTreeMap::new(),
        count: 0,
        bytes: 0,
        lost: Vec::new(),
    };
    for block in &document.blocks {
        writer.block(block);
    }
    let (blocks, lost) = (writer.blocks, writer.lost);
    (Document { blocks, ..document.clone() }, lost)
}

/// The place with a name in the singular or plural: `wheelset`, `wheelsets`, `axle boxes`,
/// `bodies`.
pub fn place_called<'a>(
    word: &str,
    names: impl Iterator<Item = &'a str> + Clone,
) -> Option<&'a str> {
    let plural = |name: &str| {
        [format!("{name}s"), format!("{name}es")].contains(&word.to_string())
            || name.strip_suffix('y').is_some_and(|stem| format!("{stem}ies") == word)
    };
    names.clone().find(|name| *name == word).or_else(|| names.clone().find(|name| plural(name)))
}

struct Writer<'a> {
    places: Places,
    before: Option<&'a Document>,
    known: &'a mut Vec<Known>,
    problems: &'a mut Problems,
    blocks: Vec<Block>,
    /// Kind and name of each block, and whether it is from a family.
    seen: BTreeMap<(String, String), (Span, bool)>,
    count: usize,
    bytes: usize,
    lost: Vec<String>,
}

impl Writer<'_> {
    fn block(&mut self, block: &Block) {
        let Some(kind) = keys::of_block(block).filter(|kind| kind.has_families()) else {
            self.blocks.push(block.clone());
            return;
        };
        let each: Vec<Field> = block.fields_named(EACH).cloned().collect();
        let (of, name) = (block.kind.text.as_str(), block.name_text());
        let of_kind = || self.known.iter().filter(|family| family.kind == of);
        if !each.is_empty() {
            return self.family(kind, block, &each, None);
        }
        if !name.contains('{') {
            match self.no_braces(kind, block) {
                true => self.add(block.clone(), false),
                false => self.lost.push(block.own_name()),
            }
            return;
        }
        if let Some(family) = of_kind().find(|family| family.name == name).cloned() {
            // The fields are those of the variant. The members are those of the parent that still
            // exist.
            let left: Vec<String> =
                family.members.into_iter().filter(|member| self.parent_has(of, member)).collect();
            return self.family(kind, block, &family.each, Some(&left));
        }
        let help = match nearest(name, of_kind().map(|family| family.name.as_str())) {
            Some(near) => format!("the parent has `{near}`: to override it, use that name"),
            None => format!("add a line `{EACH}  variable in one, another`"),
        };
        self.problems.push(
            problem!(
                "unknown-variable",
                block,
                "`{name}` has braces like the name of a family, but the block has no `{EACH}`"
            )
            .help(help),
        );
        self.lost.push(block.own_name());
    }

    fn parent_has(&self, kind: &str, name: &str) -> bool {
        self.before.is_some_and(|before| {
            before.blocks.iter().any(|block| block.kind.text == kind && block.name_text() == name)
        })
    }

    /// Whether a block that is not a family has no braces; they are reported.
    fn no_braces(&mut self, kind: &Kind, block: &Block) -> bool {
        let mut none = true;
        for field in block
            .fields
            .iter()
            .filter(|field| kind.key(&field.key.text).is_some_and(|key| key.sort == Sort::Phrase))
            // A verdict names the quantities of a family as it is written.
            .filter(|field| (kind.word, field.key.text.as_str()) != ("verdict", "of"))
        {
            let mut quotes = Quotes::default();
            let text = &field.value.text;
            let brace = text.char_indices().find(|(_, c)| {
                quotes.pass(*c);
                !quotes.inside && *c == '{'
            });
            let Some((at, _)) = brace else { continue };
            let end = text[at..].find('}').map_or(at + 1, |end| at + end + 1);
            let help = format!(
                "add a line `{EACH}  variable in one, another`, and `{{variable}}` to the name"
            );
            let place = field.value.place(at..end);
            self.problems.push(
                problem!(
                    "unknown-variable",
                    &place,
                    "`{}` is not a variable: the block has no `{EACH}`",
                    &text[at..end]
                )
                .help(help),
            );
            none = false;
        }
        none
    }

    /// Adds a block unless there is one with its name.
    fn add(&mut self, block: Block, of_family: bool) {
        let key = (block.kind.text.clone(), block.own_name());
        if let Some((first, other)) = self.seen.get(&key)
            && (of_family || *other)
        {
            let help =
                "write what differs between members with a variable, or override it in a variant";
            let problem =
                problem!("duplicate-name", &block, "there are two blocks `{} {}`", key.0, key.1);
            self.problems.push(problem.also(first, "the first").help(help));
            return;
        }
        self.seen.insert(key, (block.span().clone(), of_family));
        self.blocks.push(block);
    }

    /// Expands a family; with `only`, just the members with these names.
    fn family(&mut self, kind: &Kind, block: &Block, each: &[Field], only: Option<&[String]>) {
        if self.expanded(kind, block, each, only).is_none() {
            self.lost.push(block.own_name());
        }
    }

    /// Nothing where the family could not be expanded.
    fn expanded(
        &mut self,
        kind: &Kind,
        block: &Block,
        each: &[Field],
        only: Option<&[String]>,
    ) -> Option<()> {
        let groups = self.groups(block, each)?;
        let variables: Vec<Spanned<String>> =
            groups.iter().flat_map(|group| group.variables.iter().cloned()).collect();
        let parts = Parts::new(kind, block, &variables, self.problems)?;
        for (index, variable) in variables.iter().enumerate() {
            if only.is_none() && !parts.uses(index) {
                let name = &variable.value;
                let help = format!(
                    "write `{{{name}}}` where its members are inserted, or remove the variable"
                );
                self.problems.push(
                    problem!("unused-variable", variable, "the variable `{name}` is not used")
                        .help(help),
                );
            }
        }
        let mut names: IndexMap<String, Vec<Word>> = IndexMap::new();
        for words in product(&groups) {
            let name = parts.name.text(&words);
            if only.is_some_and(|only| !only.contains(&name)) {
                continue;
            }
            if let Some(first) = names.get(&name) {
                self.problems.push(same_name(block, &name, first, &words, &variables, &parts.name));
                break;
            }
            self.count += 1;
            self.bytes += parts.cost(&words);
            if self.count > MOST_BLOCKS || self.bytes > MOST_BYTES {
                let says = if self.count > MOST_BLOCKS {
                    format!(
                        "the families of the protocol have more than {MOST_BLOCKS} members in total"
                    )
                } else {
                    format!(
                        "the families of the protocol are longer than {} megabytes when expanded",
                        MOST_BYTES >> 20
                    )
                };
                let help = "use fewer members or shorter texts";
                self.problems.push(error("too-large", says, block).help(help));
                return None;
            }
            let member = Arc::new(Member { name: name.clone(), family: block.own_name() });
            let filled = parts.fill(block, &words, &member);
            if !lines::is_name(&name)
                && let Some(text) = &filled.name
            {
                let help = "use letters a to z, digits, `_`, `-` and `.`";
                self.problems
                    .push(problem!("bad-name", text, "`{name}` cannot be a name").help(help));
            }
            self.add(filled, true);
            names.insert(name, words);
        }
        if names.is_empty() {
            let help = format!("give it members with `{EACH}`");
            self.problems.push(
                problem!(
                    "no-members",
                    block,
                    "no member of the family `{}` of the parent is left",
                    block.name_text()
                )
                .help(help),
            );
        }
        let members: Vec<String> = names.into_keys().collect();
        let same = |family: &&mut Known| {
            family.kind == block.kind.text && family.name == block.name_text()
        };
        let (kind, name, each) = (block.kind.text.clone(), block.own_name(), each.to_vec());
        match self.known.iter_mut().find(same) {
            Some(family) => {
                family.each = each;
                let new = |member: &String| !family.members.contains(member);
                let new: Vec<String> = members.into_iter().filter(new).collect();
                family.members.extend(new);
            }
            None => self.known.push(Known { kind, name, each, members }),
        }
        Some(())
    }

    /// The variables and members of a family.
    fn groups(&mut self, block: &Block, each: &[Field]) -> Option<Vec<Group>> {
        let read: Vec<Option<Vec<Group>>> = each
            .iter()
            .map(|field| each::read(&field.value, &self.places, self.problems))
            .collect();
        let groups: Vec<Group> =
            read.into_iter().collect::<Option<Vec<_>>>()?.into_iter().flatten().collect();
        let mut sound = true;
        let mut seen: Vec<&Spanned<String>> = Vec::new();
        for variable in groups.iter().flat_map(|group| &group.variables) {
            let name = &variable.value;
            if let Some(first) = seen.iter().find(|known| known.value == *name) {
                let problem = problem!(
                    "duplicate-name",
                    variable,
                    "`{name}` is declared twice as a variable of this family"
                );
                self.problems.push(problem.also(*first, "the first"));
                sound = false;
            } else if self.places.contains_key(name) {
                let help = format!("give the variable another name: `{EACH}  x in {name}`");
                self.problems.push(
                    problem!("name-clash", variable, "`{name}` is both a place and a variable")
                        .help(help),
                );
                sound = false;
            }
            seen.push(variable);
        }
        let count =
            groups.iter().fold(1_usize, |count, group| count.saturating_mul(group.rows.len()));
        if count > MOST_MEMBERS {
            let at = each.first().map_or(block.span(), |field| &field.value.span);
            self.problems.push(
                problem!(
                    "too-large",
                    at,
                    "the family `{}` has {count} members; there can be at most {MOST_MEMBERS}",
                    block.name_text()
                )
                .help("split it or use fewer members"),
            );
            sound = false;
        }
        sound.then_some(groups)
    }
}

/// The words of each member, in the order of the lists; the last variables change fastest.
fn product(groups: &[Group]) -> impl Iterator<Item = Vec<Word>> {
    let count: usize = groups.iter().map(|group| group.rows.len()).product();
    (0..count).map(|number| {
        let mut rows: Vec<&[Word]> = Vec::with_capacity(groups.len());
        let mut rest = number;
        for group in groups.iter().rev() {
            rows.push(&group.rows[rest % group.rows.len()]);
            rest /= group.rows.len();
        }
        rows.into_iter().rev().flatten().cloned().collect()
    })
}

/// The texts of a family, split at their variables.
struct Parts<'a> {
    name: Template<'a>,
    title: Option<Template<'a>>,
    fields: Vec<(&'a Text, Template<'a>)>,
}

impl<'a> Parts<'a> {
    /// Reports all braces that contain no variable.
    fn new(
        kind: &Kind,
        block: &'a Block,
        variables: &[Spanned<String>],
        problems: &mut Problems,
    ) -> Option<Self> {
        let name = Template::new(block.name.as_ref()?, Use::Name, variables, problems);
        let title =
            block.title.as_ref().map(|title| Template::new(title, Use::Prose, variables, problems));
        let mut fields = Vec::new();
        for field in block.fields.iter().filter(|field| field.key.text != EACH) {
            let of = match kind.key(&field.key.text) {
                Some(key) if key.pattern => Use::Pattern,
                Some(key) if key.sort == Sort::Text => Use::Prose,
                _ => Use::Phrase,
            };
            fields.push(
                Template::new(&field.value, of, variables, problems)
                    .map(|template| (&field.key, template)),
            );
        }
        let title = match title {
            Some(title) => Some(title?),
            None => None,
        };
        Some(Self { name: name?, title, fields: fields.into_iter().collect::<Option<_>>()? })
    }

    fn all(&self) -> impl Iterator<Item = &Template<'a>> {
        [&self.name]
            .into_iter()
            .chain(&self.title)
            .chain(self.fields.iter().map(|(_, template)| template))
    }

    fn uses(&self, variable: usize) -> bool {
        self.all().any(|template| template.uses(variable))
    }

    fn cost(&self, words: &[Word]) -> usize {
        self.all().map(|template| template.cost(words)).sum()
    }

    fn fill(&self, block: &Block, words: &[Word], member: &Arc<Member>) -> Block {
        let of_member = |key: &Text| {
            let filled =
                Filled { text: key.text.clone(), member: Arc::clone(member), pieces: Vec::new() };
            Text {
                span: Span { filled: Some(Arc::new(filled)), ..key.span.clone() },
                ..key.clone()
            }
        };
        let field = |(key, template): &(&Text, Template<'_>)| Field {
            key: of_member(key),
            value: template.fill(words, member),
            comments: Comments::default(),
        };
        Block {
            kind: block.kind.clone(),
            name: Some(self.name.fill(words, member)),
            title: self.title.as_ref().map(|title| title.fill(words, member)),
            fields: self.fields.iter().map(field).collect(),
            comments: Comments::default(),
        }
    }
}

/// Reports two members of a family with the same name.
fn same_name(
    block: &Block,
    name: &str,
    first: &[Word],
    second: &[Word],
    variables: &[Spanned<String>],
    written: &Template<'_>,
) -> Problem {
    let differs: Vec<usize> =
        (0..variables.len()).filter(|index| first[*index].value != second[*index].value).collect();
    let repeated = variables
        .iter()
        .enumerate()
        .find(|(index, _)| first[*index].span != second[*index].span && !differs.contains(index));
    if let Some((index, _)) = repeated.filter(|_| differs.is_empty()) {
        return problem!(
            "duplicate-name",
            &*second[index],
            "the member `{}` is given twice",
            second[index].value
        )
        .also(&*first[index], "the first");
    }
    let problem =
        problem!("duplicate-name", block, "two members of the family are called `{name}`");
    match differs.iter().find(|index| !written.uses(**index)) {
        Some(index) => problem.help(format!("write `{{{}}}` in the name", variables[*index].value)),
        None => problem.help(
            "the names differ only in characters that a name cannot contain; add a variable for the name: `band, name in (1 Hz, low), (2 Hz, high)`",
        ),
    }
}
