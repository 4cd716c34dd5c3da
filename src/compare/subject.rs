//! The protocols and campaigns of a comparison, and the protocols compiled for each campaign.

use std::sync::Arc;

use super::Settings;
use crate::certify::{Compiled, Set, compile, overrides};
use crate::check::{Overrides, diff::Change, family::Family};
use crate::data::Campaign;
use crate::problem::{Problem, Problems, Severity};

/// A protocol with the name it has in the comparison.
#[derive(Clone, Debug)]
pub struct Subject {
    pub name: String,
    pub family: Family,
}

/// Names protocols; one that is given twice is a problem.
pub fn protocols(families: Vec<Family>, problems: &mut Problems) -> Vec<Subject> {
    let mut subjects: Vec<Subject> = Vec::new();
    for family in families {
        let own = family
            .merged
            .blocks
            .iter()
            .find(|block| block.kind.text == "protocol")
            .map_or("", |block| block.name_text());
        let same = |known: &&Subject| {
            let (a, b) = (&known.family.sources, &family.sources);
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.text == b.text)
        };
        if let Some(known) = subjects.iter().find(same) {
            let problem = Problem::error(
                "protocol-twice",
                format!("the protocol `{}` is given twice", known.name),
            );
            problems.push(
                problem.help("give each protocol once; its variants differ in at least one rule"),
            );
            continue;
        }
        let file = family.sources.first().map_or_else(String::new, |source| source.file_name());
        let taken = |name: &str| subjects.iter().any(|known| known.name == name);
        let name = unused(own, &file, taken);
        subjects.push(Subject { name, family });
    }
    subjects
}

/// Names campaigns; one that is given twice is a problem.
pub fn campaigns(opened: Vec<Campaign>, problems: &mut Problems) -> Vec<(String, Campaign)> {
    let mut named: Vec<(String, Campaign)> = Vec::new();
    for campaign in opened {
        let folder = campaign.inputs().folder;
        if let Some((name, _)) = named.iter().find(|(_, known)| known.inputs().folder == folder) {
            problems.push(
                Problem::error("campaign-twice", format!("the campaign `{name}` is given twice"))
                    .help("give each campaign once"),
            );
            continue;
        }
        let file =
            folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let taken = |name: &str| named.iter().any(|(known, _)| known == name);
        let name = unused(&campaign.name, &file, taken);
        named.push((name, campaign));
    }
    named
}

/// A name that no other has: with the name of the file, if need be with a number.
fn unused(name: &str, file: &str, taken: impl Fn(&str) -> bool) -> String {
    if !taken(name) {
        return name.to_string();
    }
    let with_file = format!("{name} ({file})");
    let numbered = (2..).map(|number| format!("{name} ({file}, {number})"));
    std::iter::once(with_file).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
}

/// The protocols as compiled for a campaign, and the first with each changed rule.
#[derive(Debug)]
pub struct CompiledAll {
    pub protocols: Vec<Compiled>,
    /// Why a rule cannot be applied alone.
    pub changed: Vec<Result<Compiled, String>>,
}

/// A campaign, and the protocols as compiled for it.
#[derive(Debug)]
pub struct WithProtocols {
    pub name: String,
    pub campaign: Campaign,
    pub compiled: Arc<CompiledAll>,
}

/// Compiles every protocol with the parameters of each campaign and of the command line, as far as
/// it has them.
///
/// # Errors
/// A protocol or a value of a parameter is not valid; no protocol has a parameter of the command
/// line.
pub fn opened(
    protocols: &[Subject],
    campaigns: Vec<(String, Campaign)>,
    changes: &[Change],
    settings: &Settings,
    problems: &mut Problems,
) -> Option<Vec<WithProtocols>> {
    unknown_parameters(&settings.set, protocols.iter().map(|subject| &subject.family), problems);
    // Campaigns that set the same parameters share the compiled protocols.
    type Known = (Vec<(String, String)>, Arc<CompiledAll>);
    let mut known: Vec<Known> = Vec::new();
    let mut all = Vec::new();
    for (name, campaign) in campaigns {
        let overrides = overrides(&settings.set, std::slice::from_ref(&campaign), problems)?;
        let values = overrides.iter().map(|(name, set)| (name.clone(), set.text.text.clone()));
        let values = values.collect();
        let compiled = match known.iter().find(|(of, _)| *of == values) {
            Some((_, compiled)) => Arc::clone(compiled),
            None => {
                let new = Arc::new(compiled_with(protocols, changes, &overrides, problems)?);
                known.push((values, Arc::clone(&new)));
                new
            }
        };
        all.push(WithProtocols { name, campaign, compiled });
    }
    (!problems.any_error()).then_some(all)
}

/// A parameter of the command line that no protocol has.
///
/// Problems: `unknown-parameter`.
pub fn unknown_parameters<'a>(
    set: &[Set],
    families: impl IntoIterator<Item = &'a Family>,
    problems: &mut Problems,
) {
    let known: Vec<&str> = families.into_iter().flat_map(parameters).collect();
    for (name, _) in set.iter().filter(|(name, _)| !known.contains(&name.as_str())) {
        let says = format!("no protocol of the comparison has a parameter `{name}`");
        let problem = Problem::error("unknown-parameter", says);
        problems.push(problem.suggest(name, known.iter().copied()));
    }
}

fn compiled_with(
    protocols: &[Subject],
    changes: &[Change],
    overrides: &Overrides,
    problems: &mut Problems,
) -> Option<CompiledAll> {
    let mut all = Vec::new();
    for subject in protocols {
        let mut own = Problems::default();
        let compiled =
            compile(subject.family.clone(), &of_protocol(&subject.family, overrides), &mut own);
        // A warning of a protocol is told once, not for each campaign.
        for problem in own.0 {
            if problem.severity == Severity::Error
                || !problems.0.iter().any(|known| known.says == problem.says)
            {
                problems.push(problem);
            }
        }
        all.extend(compiled);
    }
    if all.len() < protocols.len() {
        return None;
    }
    let changed = protocols.first().map_or_else(Vec::new, |first| {
        let one =
            |change: &Change| alone(&first.family, change, |family| of_protocol(family, overrides));
        changes.iter().map(one).collect()
    });
    Some(CompiledAll { protocols: all, changed })
}

fn parameters(family: &Family) -> impl Iterator<Item = &str> {
    family
        .merged
        .blocks
        .iter()
        .filter(|block| block.kind.text == "parameter")
        .map(|block| block.name_text())
}

/// Those that a protocol has.
pub fn of_protocol(family: &Family, overrides: &Overrides) -> Overrides {
    let has = |name: &String| parameters(family).any(|known| known == name);
    let mut own: Overrides = overrides
        .iter()
        .filter(|(name, _)| has(name))
        .map(|(name, set)| (name.clone(), set.clone()))
        .collect();
    own.confirmed.clone_from(&overrides.confirmed);
    own
}

/// The protocol with one change.
///
/// # Errors
/// It is then no valid protocol: the first problem, which tells what the rule needs.
fn alone(
    family: &Family,
    change: &Change,
    overrides: impl Fn(&Family) -> Overrides,
) -> Result<Compiled, String> {
    let family = Family { merged: change.applied(&family.merged), ..family.clone() };
    let mut problems = Problems::default();
    let overrides = overrides(&family);
    let compiled = compile(family, &overrides, &mut problems).filter(|_| !problems.any_error());
    compiled.ok_or_else(|| {
        let first = problems.0.iter().find(|problem| problem.severity == Severity::Error);
        let says = first.map_or("the protocol is then not valid", |problem| problem.says.as_str());
        format!("cannot be applied alone: {says}")
    })
}
