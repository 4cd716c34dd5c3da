//! Common inputs of the subcommands that evaluate a protocol on a campaign.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::output::{Console, Exit};
use super::protocols::load;
use crate::certify::{Compiled, compile};
use crate::check::family::{self, Family};
use crate::check::{Override, Overrides, plan::SetBy};
use crate::data::text::read_text;
use crate::data::{Campaign, Campaigns};
use crate::library;
use crate::problem::{Problem, Problems};
use crate::result::found::FoundSections;
use crate::run::find;
use crate::source::{Source, Spanned};
use crate::syntax::document::Text;

/// Maximum number of records processed in parallel. Each takes a thread, and memory for its text and signals. The value exceeds the number
/// of cores of the machines the program is used on.
const MOST_JOBS: usize = 256;

/// Starts the requested number of threads.
///
/// # Errors
/// The number exceeds [`MOST_JOBS`]; the exit code.
pub fn start_jobs(jobs: Option<NonZeroUsize>, console: &Console) -> Result<(), Exit> {
    let Some(jobs) = jobs.map(NonZeroUsize::get) else { return Ok(()) };
    if jobs > MOST_JOBS {
        let says = format!("`--jobs {jobs}` exceeds the maximum of {MOST_JOBS}");
        return Err(console.fail(Problem::error("jobs", says).help("omit it to use one per core"), Exit::Wrong));
    }
    // Fails only if the thread pool exists already, which is not the case here.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(jobs).build_global();
    Ok(())
}

/// A compiled protocol and its campaign.
#[derive(Debug)]
pub struct Prepared {
    pub compiled: Compiled,
    pub campaign: Campaign,
}

/// A compiled protocol and the campaigns that it is evaluated on as one.
#[derive(Debug)]
pub struct Pool {
    pub compiled: Compiled,
    pub campaigns: Vec<Campaign>,
    pub overrides: Overrides,
    /// How the sections of campaigns with runs were found.
    pub found: Vec<FoundSections>,
}

/// Opens a campaign and compiles the protocol named on the command line, else the campaign's, else the first shipped one.
pub fn prepare(folder: &Path, protocol: Option<&str>, set: &[String], problems: &mut Problems) -> Option<Prepared> {
    let Pool { compiled, mut campaigns, .. } = prepare_all(&[folder.to_path_buf()], protocol, set, problems)?;
    Some(Prepared { compiled, campaign: campaigns.pop()? })
}

/// As [`prepare`], of several campaigns. Sections that the protocol looks for in runs are found.
pub fn prepare_all(folders: &[PathBuf], protocol: Option<&str>, set: &[String], problems: &mut Problems) -> Option<Pool> {
    let mut pool = compiled_for(folders, protocol, set, problems)?;
    if problems.any_error() {
        return Some(pool);
    }
    match find::in_all(&pool.compiled.plan, &pool.compiled.graph, &mut pool.campaigns) {
        Ok(found) => pool.found = found,
        Err(told) => told.0.into_iter().for_each(|problem| problems.push(problem)),
    }
    Some(pool)
}

/// As [`prepare_all`], before sections are looked for.
pub fn compiled_for(folders: &[PathBuf], protocol: Option<&str>, set: &[String], problems: &mut Problems) -> Option<Pool> {
    let opened: Vec<Option<Campaign>> = folders.iter().map(|folder| Campaign::open(folder, problems)).collect();
    let campaigns: Vec<Campaign> = opened.into_iter().collect::<Option<_>>()?;
    Campaigns::from(&campaigns).check(problems);
    let family = match protocol {
        Some(name) => load(name, problems),
        None => own_protocol(&campaigns, problems),
    }?;
    let overrides = overrides(set, &campaigns, problems)?;
    let compiled = compile(family, &overrides, problems)?;
    if protocol.is_none()
        && let Some(problem) = campaigns.iter().find_map(|campaign| of_another_kind(&compiled, campaign))
    {
        problems.push(problem);
        return None;
    }
    campaigns.iter().for_each(|campaign| facts_like_parameters(&compiled, campaign, problems));
    Some(Pool { compiled, campaigns, overrides, found: Vec::new() })
}

/// The protocol that the campaigns name: all the same one.
fn own_protocol(campaigns: &[Campaign], problems: &mut Problems) -> Option<Family> {
    let first = campaigns.first()?;
    let name = |campaign: &Campaign| campaign.protocol.as_ref().map(|named| named.value.clone());
    let at = |campaign: &Campaign| campaign.protocol.as_ref().map_or(campaign.short_name.span.clone(), |named| named.span.clone());
    let called = |campaign: &Campaign| name(campaign).map_or_else(|| "none".to_string(), |name| format!("`{name}`"));
    if let Some(other) = campaigns.iter().find(|other| name(other) != name(first)) {
        let says = format!("the campaigns name different protocols: {} and {}", called(first), called(other));
        let problem = Problem::error("several-protocols", says).at(&at(other)).also(&at(first), "the first");
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

/// A campaign that names no protocol, and whose vehicle file has none of the data that the default one needs, is of another kind of machine.
fn of_another_kind(compiled: &Compiled, campaign: &Campaign) -> Option<Problem> {
    let needed = || compiled.plan.vehicle.iter().filter(|datum| datum.default.is_none() && !datum.may_be_absent);
    let described = !campaign.vehicle.entries().is_empty();
    if campaign.protocol.is_some()
        || !described
        || needed().next().is_none()
        || needed().any(|one| campaign.vehicle.lookup(&one.key).is_some())
    {
        return None;
    }
    let says = format!("the campaign names no protocol, and its vehicle file has nothing that the default `{}` needs", compiled.plan.name);
    let problem = Problem::error("no-protocol", says).at(&campaign.tree.span.part(0..0));
    Some(problem.help("name one: `protocol: protocol.fp` in this file, or `--protocol`"))
}

/// A fact of the campaign sets nothing; one with the name of a parameter was most likely meant to.
fn facts_like_parameters(compiled: &Compiled, campaign: &Campaign, problems: &mut Problems) {
    for fact in campaign.facts.iter().filter(|fact| compiled.plan.parameters.iter().any(|parameter| parameter.name == fact.name)) {
        let says = format!("`{}` is a parameter of the protocol, and is not set by a fact of the campaign", fact.name);
        let problem = Problem::warning("fact-like-parameter", says).at(&fact.span);
        problems.push(problem.help("to set it, let it stand below `parameters`, indented"));
    }
}

/// Parameters of the campaigns, which must set them alike, and over them those of the command line.
fn overrides(set: &[String], campaigns: &[Campaign], problems: &mut Problems) -> Option<Overrides> {
    let mut overrides = Overrides::new();
    let on_command_line = |name: &str| set.iter().any(|set| set.split_once('=').is_some_and(|(set, _)| set.trim() == name));
    for parameter in campaigns.iter().flat_map(|campaign| &campaign.parameters) {
        let name = &parameter.name.text;
        let same =
            |other: &&Campaign| other.parameters.iter().any(|other| (&other.name.text, &other.value.raw) == (name, &parameter.value.raw));
        if let Some(other) = campaigns.iter().find(|other| !same(other)).filter(|_| !on_command_line(name)) {
            let says =
                format!("the parameter `{name}` is `{}` here, and not in the campaign `{}`", parameter.value.raw, other.short_name.value);
            let set = other.parameters.iter().find(|other| other.name.text == *name);
            let place = set.map_or(&other.short_name.span, |set| &set.value.span);
            let problem = Problem::error("parameters-differ", says).at(&parameter.value.span);
            let problem = problem.also(place, if set.is_some() { "another value" } else { "not set" });
            problems.push(problem.help(format!("set one for all: `--set {name}=...`")));
            return None;
        }
        let value = &parameter.value;
        let text = Text { text: value.raw.clone(), span: value.span.clone(), exact: value.exact };
        overrides.insert(parameter.name.text.clone(), Override { text, set_by: SetBy::Campaign });
    }
    for set in set {
        let Some((name, value)) = set.split_once('=') else {
            problems.push(Problem::error("set", format!("`--set {set}` has no `=`")).help("write `--set name=value`"));
            return None;
        };
        let source = Source::new("--set", set.clone());
        let span = source.span(name.len() + 1..set.len());
        overrides.insert(
            name.trim().to_string(),
            Override { text: Text { text: value.to_string(), span, exact: true }, set_by: SetBy::CommandLine },
        );
    }
    Some(overrides)
}

/// The protocol that a campaign names: a shipped one, or a file inside the campaign; the same for those it extends.
fn campaign_protocol(campaign: &Campaign, named: &Spanned<String>, problems: &mut Problems) -> Option<Family> {
    let inside = |named: &Spanned<String>| {
        if let Some(shipped) = library::shipped(&named.value) {
            return Ok(shipped);
        }
        let place = campaign.place(named)?;
        read_text(&place.path, &place.shown).map(|(source, _)| source).map_err(|problem| {
            let problem = if problem.at.is_some() { problem } else { problem.at(&named.span) };
            if problem.code == "file-missing" { problem.suggest(&named.value, library::names()) } else { problem }
        })
    };
    let source = inside(named).map_err(|problem| problems.push(problem)).ok()?;
    let parent = |name: &str, from: &Source| {
        if let Some(shipped) = library::shipped(name) {
            return Ok(shipped);
        }
        let beside = Path::new(campaign.inside(&from.name)).parent().unwrap_or(Path::new(""));
        inside(&Spanned::new(beside.join(name).display().to_string(), source.whole())).map_err(Box::new)
    };
    Some(family::read(&source, &parent, problems))
}

/// A progress bar on a terminal; nothing if the output is redirected.
pub fn progress_bar(console: &Console, steps: usize) -> Arc<ProgressBar> {
    let bar = ProgressBar::new(steps as u64);
    if console.quiet {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    Arc::new(bar)
}
