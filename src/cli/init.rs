//! `init`: the draft of a protocol and an empty campaign.

use std::sync::Arc;

use super::{
    kit::*,
    scaffold::{Scaffold, scaffold},
};
use crate::check::{self, Overrides, family::Family};
use crate::data::record::{listed_headings, read_headings};
use crate::graph;
use crate::init::{
    File, campaign,
    channels::{Listed, channels, listed},
    protocol::{self, Parent},
};
use crate::prepare;
use crate::run::needs;
use crate::source::Source;

const PROTOCOL: &str = "protocol.fp";

#[derive(Debug, Args)]
pub struct Init {
    /// Folder to create; it must not exist, or be empty.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Channels with their units, separated by commas: "Y_1R [kN], Y_1L [kN], ay_I [m/s^2]".
    #[arg(long, value_name = "LIST", conflicts_with = "channels_from", required_unless_present_any = ["channels_from", "extends"])]
    channels: Option<String>,
    /// A record whose header lists the channels.
    #[arg(long, value_name = "RECORD.csv")]
    channels_from: Option<PathBuf>,
    /// Protocol that the new one extends: a shipped name, or a path; the campaign then has what it
    /// needs.
    #[arg(long, value_name = "PROTOCOL")]
    extends: Option<String>,
}

impl Init {
    pub fn run(self, console: &Console) -> Done {
        scaffold(&self.folder, console, |name, problems| {
            let files = self.files(name, problems)?;
            let after = files.iter().map(|(path, _)| format!("  {path}")).collect();
            Some(Scaffold { files, before: Vec::new(), after })
        })
    }

    fn listed(&self, problems: &mut Problems) -> Option<Listed> {
        let headings = match (&self.channels, &self.channels_from) {
            (Some(list), _) => listed_headings(list, "--channels"),
            (None, Some(path)) => read_headings(path, &path.display().to_string()),
            (None, None) => return None,
        };
        let headings = problems.value(headings)?;
        let found = channels(&headings, problems);
        if problems.any_error() {
            return None;
        }
        let (first, last) = (headings.first(), headings.last());
        let listed = listed(found, self.channels_from.is_some()).map_err(|problem| match first {
            Some(first) => problem.at(&first.span),
            None => problem,
        });
        let listed = problems.value(listed)?;
        if listed.groups.is_empty() && self.extends.is_none() {
            let problem =
                Problem::error("no-channels", "there is no channel besides axis and time")
                    .help("add those that are to be compared");
            problems.push(match first.zip(last) {
                Some((first, last)) => problem.at(&first.span.to(&last.span)),
                None => problem,
            });
            return None;
        }
        Some(listed)
    }

    fn files(&self, name: &str, problems: &mut Problems) -> Option<Vec<File>> {
        let mut listed = self.listed(problems);
        let family = self.extends.as_ref().map(|name| load(name, problems));
        if problems.any_error() {
            return None;
        }
        let family = family.flatten();
        let copies = family.as_ref().map(|family| copies(family, problems)).unwrap_or_default();
        if let (Some(family), Some(listed)) = (&family, &mut listed) {
            without_known(family, listed, problems)?;
        }
        let parent = family.as_ref().map(parent);
        let text = protocol::text(name, listed.as_ref(), parent.as_ref());
        let source = Source::new(PROTOCOL, problems.value(text)?);
        let find = |name: &str, from: &Source| match copies.iter().find(|(path, _)| path == name) {
            Some((_, source)) => Ok(Arc::clone(source)),
            None => library::parent(name, from),
        };
        let family = prepare::read(&source, &find, problems);
        let plan = check::check(&family, &Overrides::new(), problems)?;
        let needs = needs::needs(&plan, &graph::from_plan(&plan));
        let mut files = vec![(PROTOCOL.to_string(), source.text.clone())];
        files.extend(copies.into_iter().map(|(path, source)| (path, source.text.clone())));
        let campaign = campaign::files(name, &needs);
        files.extend(problems.value(campaign)?);
        Some(files)
    }
}

/// What a protocol in the draft says of its parent.
fn parent(family: &Family) -> Parent<'_> {
    let (protocol, others): (Vec<_>, Vec<_>) =
        family.merged.blocks.iter().partition(|block| block.kind.text == "protocol");
    let name = protocol.first().map_or("", |block| block.name_text());
    let own = &family.sources[0];
    let extends =
        if is_shipped(own) { name.to_string() } else { format!("\"{}\"", file_name(own)) };
    let names = others.into_iter().map(|block| block.name_text().to_string()).collect();
    Parent { name, extends, names }
}

fn is_shipped(source: &Source) -> bool {
    library::texts().any(|known| {
        source.name == format!("protocols/{}.fp", known.name) && source.text == known.text
    })
}

fn file_name(source: &Source) -> String {
    let name = Path::new(&source.name).file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// The protocols of the chain that are not shipped. They go into the campaign, which can extend
/// nothing outside of it.
fn copies(family: &Family, problems: &mut Problems) -> Vec<(String, Arc<Source>)> {
    let own: Vec<&Arc<Source>> =
        family.sources.iter().filter(|source| !is_shipped(source)).collect();
    let folder = |source: &Source| Path::new(&source.name).parent().map(Path::to_path_buf);
    for source in &own {
        if folder(source) != folder(own[0]) || file_name(source) == PROTOCOL {
            let says = format!("`{}` cannot be copied beside the new protocol", source.name);
            let problem = Problem::error("extends-outside", says)
                .at(&source.span(0..source.text.lines().next().map_or(0, str::len)));
            problems.push(problem.help(format!(
                "the protocols that are extended stand in one folder, and none is called {PROTOCOL}"
            )));
        }
    }
    own.into_iter().map(|source| (file_name(source), Arc::clone(source))).collect()
}

/// Takes the columns that the parent reads out of a list; axis and time are those of the parent.
fn without_known(family: &Family, listed: &mut Listed, problems: &mut Problems) -> Option<()> {
    let plan = check::check(family, &Overrides::new(), problems)?;
    let known = needs::needs(&plan, &graph::from_plan(&plan)).channels;
    let is_known = |column: &str| known.iter().any(|need| need.column == column);
    listed.groups.retain_mut(|group| {
        if group.positions.is_empty() {
            return !is_known(&group.stem);
        }
        let column = |position: &String| format!("{}{}{position}", group.stem, group.separator);
        group.positions.retain(|position| !is_known(&column(position)));
        !group.positions.is_empty()
    });
    listed.time = listed.time.take().filter(|_| plan.time.is_some());
    Some(())
}
