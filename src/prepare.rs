//! Inputs of an evaluation: campaigns, and a protocol compiled for them. Programs and packages that
//! evaluate begin here.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::certify::{Compiled, Opened, Set, compile, overrides, taken_names};
use crate::check::family::{self, Family};
use crate::data::{Campaign, Campaigns};
use crate::diagnose::settings::Settings;
use crate::effects::{self, Catalogue};
use crate::import::{
    check::NotWritten,
    mapping::{Mapping, agree},
};
use crate::library;
use crate::problem::{Problem, Problems, all, error};
use crate::run::{self, find, needs::needs};
use crate::simulate::{Section, model_parameters, sections};
use crate::source::{Source, Spanned};
use crate::syntax::document::Text;

/// A protocol that is asked for.
#[derive(Clone, Copy, Debug)]
pub enum Protocol<'a> {
    /// By its path, or by the name of a shipped one.
    Named(&'a str),
    Text(&'a str),
}

impl Protocol<'_> {
    /// The protocol and its ancestors.
    pub fn load(self, problems: &mut Problems) -> Option<Family> {
        match self {
            Self::Named(name) => load(name, problems),
            Self::Text(text) => {
                Some(read(&Source::new(IN_MEMORY, text), &library::parent, problems))
            }
        }
    }
}

/// The name of a protocol that is not in a file, in messages and results.
const IN_MEMORY: &str = "protocol.fp";

/// A protocol and its ancestors, by name or path.
pub fn load(name: &str, problems: &mut Problems) -> Option<Family> {
    let source = problems.value(library::find(name, None))?;
    Some(read(&source, &library::parent, problems))
}

/// Reads a protocol and its ancestors. A shipped name stands for the shipped rules alone.
///
/// Problems: as of [`family::read`]; `shipped-name`.
pub fn read(source: &Arc<Source>, find: family::Find<'_>, problems: &mut Problems) -> Family {
    let family = family::read(source, find, problems);
    for name in taken_names(&family) {
        let says =
            format!("`{0}` is a shipped protocol, and this text has another content", name.text);
        let help = format!(
            "give it a name of its own; to change rules of the shipped one, write `extends {}`",
            name.text
        );
        problems.push(error("shipped-name", says, name).help(help));
    }
    family
}

/// What a diagnosis needs beside the protocol: the catalogue and its settings, and the sections of
/// the campaign.
///
/// Problems: of the catalogue; `section-in-run`, `several-records`, `several-vehicles`; of the
/// table of sections.
pub fn for_diagnosis(
    campaign: &Campaign,
    catalogue: &str,
    problems: &mut Problems,
) -> Option<(Catalogue, Settings, Vec<Section>)> {
    problems.value(campaign.file_for_each_section())?;
    let catalogue = load_catalogue(catalogue, problems)?;
    let settings = Settings::read(&catalogue, problems)?;
    let sections = sections(campaign, problems)?;
    problems.value(campaign.one_of_each().and_then(|()| campaign.one_vehicle()))?;
    Some((catalogue, settings, sections))
}

/// A catalogue of effects, by path or name.
pub fn load_catalogue(name: &str, problems: &mut Problems) -> Option<Catalogue> {
    let source = problems.value(library::find_catalogue(name, None))?;
    effects::read(&source, &library::parent_catalogue, &model_parameters(), problems)
}

/// The protocol of a mapping with the parameters that the mapping sets, if it names one. Mapping,
/// protocol, tables and vehicle are checked against each other as an evaluation does it, before any
/// record is read.
pub fn for_import(mapping: &Mapping, problems: &mut Problems) -> Option<Option<Compiled>> {
    let before = problems.errors();
    let made = NotWritten::new(mapping, problems)?;
    let Some(named) = &mapping.protocol else { return Some(None) };
    let source = match library::shipped(&named.value) {
        Some(source) => source,
        None => problems.value(
            mapping.paths.read_text(named).map(|(source, _)| source).map_err(|problem| {
                let suggest = problem.code == "file-missing" && problem.near.is_none();
                if suggest { problem.suggest(&named.value, library::names()) } else { problem }
            }),
        )?,
    };
    let parent = |name: &str, from: &Source| match library::shipped(name) {
        Some(shipped) => Ok(shipped),
        None => mapping.paths.parent(name, from, &named.span),
    };
    let family = read(&source, &parent, problems);
    let overrides = overrides(&[], std::slice::from_ref(&made.campaign), problems)?;
    let compiled = compile(family, &overrides, problems)?;
    agree::agree(mapping, &needs(&compiled.plan, &compiled.graph), problems);
    if problems.errors() == before {
        made.checked(problems, |campaign, problems| {
            facts_like_parameters(&compiled, campaign, problems);
            run::check_data(&compiled.plan, campaign, problems);
        });
    }
    (problems.errors() == before).then_some(Some(compiled))
}

/// Opens a campaign and compiles the protocol named on the command line, else the campaign's, else
/// the first shipped one.
pub fn prepare(
    folder: &Path,
    protocol: Option<&str>,
    set: &[String],
    problems: &mut Problems,
) -> Option<(Compiled, Campaign)> {
    let Opened { compiled, mut campaigns, .. } =
        prepare_all(&[folder.to_path_buf()], protocol, set, problems)?;
    Some((compiled, campaigns.pop()?))
}

/// As [`prepare`], of several campaigns. Sections that the protocol looks for in runs are found.
pub fn prepare_all(
    folders: &[PathBuf],
    protocol: Option<&str>,
    set: &[String],
    problems: &mut Problems,
) -> Option<Opened> {
    with_sections(compiled_for(folders, protocol, set, problems)?, problems)
}

/// As [`prepare_all`], of campaigns that are open, with a protocol that is named or given as a
/// text.
pub fn prepare_opened(
    campaigns: Vec<Campaign>,
    protocol: Option<Protocol<'_>>,
    set: &[String],
    problems: &mut Problems,
) -> Option<Opened> {
    with_sections(compiled_with(campaigns, protocol, set, problems)?, problems)
}

fn with_sections(mut opened: Opened, problems: &mut Problems) -> Option<Opened> {
    if problems.any_error() {
        return Some(opened);
    }
    let Opened { compiled, campaigns, .. } = &mut opened;
    match find::in_all(&compiled.plan, &compiled.graph, campaigns) {
        Ok(found) => opened.found = found,
        Err(told) => problems.add(told.0),
    }
    Some(opened)
}

/// Opens campaigns.
pub fn opened_all(folders: &[PathBuf], problems: &mut Problems) -> Option<Vec<Campaign>> {
    all(folders.iter().map(|folder| Campaign::open(folder, problems)))
}

/// As [`prepare_all`], before sections are looked for.
pub fn compiled_for(
    folders: &[PathBuf],
    protocol: Option<&str>,
    set: &[String],
    problems: &mut Problems,
) -> Option<Opened> {
    compiled_with(opened_all(folders, problems)?, protocol.map(Protocol::Named), set, problems)
}

fn compiled_with(
    campaigns: Vec<Campaign>,
    protocol: Option<Protocol<'_>>,
    set: &[String],
    problems: &mut Problems,
) -> Option<Opened> {
    Campaigns::from(&campaigns).check(problems);
    let family = match protocol {
        Some(protocol) => protocol.load(problems),
        None => own_protocol(&campaigns, problems),
    }?;
    let set = set_by_hand(set, problems)?;
    let overrides = overrides(&set, &campaigns, problems)?;
    let compiled = compile(family, &overrides, problems)?;
    if protocol.is_none()
        && let Some(problem) =
            campaigns.iter().find_map(|campaign| of_another_kind(&compiled, campaign))
    {
        problems.push(problem);
        return None;
    }
    campaigns.iter().for_each(|campaign| facts_like_parameters(&compiled, campaign, problems));
    Some(Opened { compiled, campaigns, overrides, found: Vec::new() })
}

/// The protocol that the campaigns name: all the same one.
fn own_protocol(campaigns: &[Campaign], problems: &mut Problems) -> Option<Family> {
    let first = campaigns.first()?;
    let name = |campaign: &Campaign| campaign.protocol.as_ref().map(|named| named.value.clone());
    let at = |campaign: &Campaign| {
        campaign
            .protocol
            .as_ref()
            .map_or(campaign.short_name.span.clone(), |named| named.span.clone())
    };
    let called = |campaign: &Campaign| {
        name(campaign).map_or_else(|| "none".to_string(), |name| format!("`{name}`"))
    };
    if let Some(other) = campaigns.iter().find(|other| name(other) != name(first)) {
        let says = format!(
            "the campaigns name different protocols: {} and {}",
            called(first),
            called(other)
        );
        let problem =
            Problem::error("several-protocols", says).at(&at(other)).also(&at(first), "the first");
        problems.push(problem.help("name the one that is meant: `--protocol`"));
        return None;
    }
    match &first.protocol {
        Some(named) if campaigns.len() > 1 && library::shipped(&named.value).is_none() => {
            let says = format!("each campaign has a protocol `{}` of its own", named.value);
            let problem = Problem::error("several-protocols", says).at(&named.span);
            problems.push(problem.help("name the one that is meant: `--protocol`"));
            None
        }
        Some(named) => campaign_protocol(first, named, problems),
        None => load(library::SHIPPED[0].name, problems),
    }
}

/// A campaign that names no protocol, and whose vehicle file has none of the data that the default
/// one needs, is of another kind of machine.
fn of_another_kind(compiled: &Compiled, campaign: &Campaign) -> Option<Problem> {
    let needed = || {
        compiled
            .plan
            .vehicle
            .iter()
            .filter(|datum| datum.default.is_none() && datum.optional.is_none())
    };
    let described = !campaign.vehicle.entries().is_empty();
    if campaign.protocol.is_some()
        || !described
        || needed().next().is_none()
        || needed().any(|one| campaign.vehicle.lookup(&one.key).is_some())
    {
        return None;
    }
    let says = format!(
        "the campaign names no protocol, and its vehicle file has nothing that the default `{}` needs",
        compiled.plan.name
    );
    let problem = Problem::error("no-protocol", says).at(&campaign.tree.span.part(0..0));
    Some(problem.help("name one: `protocol: protocol.fp` in this file, or `--protocol`"))
}

/// A fact of the campaign sets nothing; one with the name of a parameter was most likely meant to.
fn facts_like_parameters(compiled: &Compiled, campaign: &Campaign, problems: &mut Problems) {
    for fact in campaign
        .facts
        .iter()
        .filter(|fact| compiled.plan.parameters.iter().any(|parameter| parameter.name == fact.name))
    {
        let says = format!(
            "`{}` is a parameter of the protocol, and is not set by a fact of the campaign",
            fact.name
        );
        let problem = Problem::warning("fact-like-parameter", says).at(&fact.span);
        problems.push(problem.help("to set it, let it stand below `parameters`, indented"));
    }
}

/// The names and values of some `--set name=value`.
///
/// Problems: `set` (no `=`), `set-twice`.
pub fn set_by_hand(all: &[String], problems: &mut Problems) -> Option<Vec<Set>> {
    let mut found: Vec<Set> = Vec::new();
    for set in all {
        let Some((name, value)) = set.split_once('=') else {
            problems.push(
                Problem::error("set", format!("`--set {set}` has no `=`"))
                    .help("write `--set name=value`"),
            );
            return None;
        };
        let span = Source::new("--set", set.clone()).span(name.len() + 1..set.len());
        let name = name.trim();
        if let Some((_, first)) = found.iter().find(|(known, _)| known == name) {
            let problem =
                Problem::error("set-twice", format!("the parameter `{name}` is set twice"))
                    .at(&span);
            problems.push(problem.also(&first.span, "set before").help("keep one of the two"));
            return None;
        }
        found.push((name.to_string(), Text { text: value.to_string(), span, exact: true }));
    }
    Some(found)
}

/// The campaign with the files of its own protocol and of those that this one extends, for a copy
/// of it. What cannot be read is left out: a copy needs no protocol.
pub fn with_protocols(campaign: Campaign) -> Campaign {
    let named = campaign.protocol.as_ref().filter(|named| library::shipped(&named.value).is_none());
    let Some(family) =
        named.and_then(|named| campaign_protocol(&campaign, named, &mut Problems::default()))
    else {
        return campaign;
    };
    let inside =
        family.sources.iter().map(|source| campaign.inside(&source.name).to_string()).collect();
    campaign.with_protocols(inside)
}

/// The protocol that a campaign names: a shipped one, or a file inside the campaign; the same for
/// those it extends.
fn campaign_protocol(
    campaign: &Campaign,
    named: &Spanned<String>,
    problems: &mut Problems,
) -> Option<Family> {
    let inside = |named: &Spanned<String>| {
        if let Some(shipped) = library::shipped(&named.value) {
            return Ok(shipped);
        }
        let place = campaign.place(named)?;
        campaign.read_text(&place).map_err(|problem| {
            let problem = if problem.at.is_some() { problem } else { problem.at(&named.span) };
            if problem.code == "file-missing" && problem.near.is_none() {
                problem.suggest(&named.value, library::names())
            } else {
                problem
            }
        })
    };
    let source = problems.value(inside(named))?;
    let parent = |name: &str, from: &Source| {
        if let Some(shipped) = library::shipped(name) {
            return Ok(shipped);
        }
        let beside = Path::new(campaign.inside(&from.name)).parent().unwrap_or(Path::new(""));
        inside(&Spanned::new(beside.join(name).display().to_string(), source.whole()))
    };
    Some(read(&source, &parent, problems))
}
