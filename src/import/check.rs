//! The campaign of a mapping before its records are read: what `certify` would refuse is told here,
//! and nothing is written.

use super::mapping::Mapping;
use super::write::{campaign_tree, small_files};
use crate::data::Campaign;
use crate::data::campaign::{Memory, RUN_COLUMN};
use crate::data::record::Format;
use crate::disk;
use crate::problem::{Problem, Problems, error};
use crate::source::Source;

/// The campaign that a mapping makes, without its records.
#[derive(Debug)]
pub struct NotWritten {
    pub campaign: Campaign,
    /// Names of its files inside the campaign, and those that the user knows.
    names: Vec<(String, String)>,
}

impl NotWritten {
    /// Problems: those of [`Campaign::not_written`]; `file-missing`, `column-missing`.
    pub fn new(mapping: &Mapping, problems: &mut Problems) -> Option<Self> {
        let before = problems.errors();
        tracks(mapping, problems);
        let files = problems.value(small_files(mapping))?;
        let names: Vec<(String, String)> =
            files.iter().map(|file| (file.inside.clone(), file.shown.clone())).collect();
        let texts = files.into_iter().map(|file| (file.inside, file.bytes)).collect();
        let memory = Memory { texts, ..Memory::default() };
        let mut found = Problems::default();
        let campaign = Campaign::not_written(
            campaign_tree(mapping, Format::Csv),
            memory,
            mapping.sections.names.clone(),
            &mut found,
        );
        found.0.into_iter().for_each(|problem| problems.push(placed(problem, &names)));
        let campaign = campaign?;
        if let (Some(runs), Some(table)) = (&mapping.runs, &campaign.sections)
            && table.column(RUN_COLUMN).is_none()
        {
            let says = format!(
                "the table of sections has no column `{RUN_COLUMN}`: from which run a section is cut"
            );
            let at = runs.table.as_ref().map_or(&mapping.sections.span, |written| &written.span);
            let problem = error("column-missing", says, at);
            let known = table.columns.iter().map(|column| column.name.as_str());
            let near = problem.suggest(RUN_COLUMN, known);
            let names = mapping.sections.names.iter().map(|name| name.value.as_str());
            let runs = names.collect::<Vec<_>>().join(", ");
            let help = format!("add it, with a run in each row: {runs}");
            problems.push(if near.near.is_some() { near } else { near.help(help) });
        }
        (problems.errors() == before).then_some(Self { campaign, names })
    }

    /// Checks the campaign, and shows files where the mapping has them.
    pub fn checked<T>(
        &self,
        problems: &mut Problems,
        check: impl FnOnce(&Campaign, &mut Problems) -> T,
    ) -> T {
        let mut found = Problems::default();
        let result = check(&self.campaign, &mut found);
        found.0.into_iter().for_each(|problem| problems.push(placed(problem, &self.names)));
        result
    }
}

/// Every section or run has a track file, if the mapping names any.
fn tracks(mapping: &Mapping, problems: &mut Problems) {
    let Some(pattern) = &mapping.track else { return };
    let word = mapping.sections.word;
    let all = mapping.sections.names.iter();
    let places = all.map(|name| Ok((name, mapping.place_of(pattern, &name.value)?)));
    let Some(places) = problems.value(places.collect::<Result<Vec<_>, Problem>>()) else { return };
    if let Some((name, place)) = places.iter().find(|(_, at)| !disk::may_be_file(&at.path)) {
        let problem = Problem::error(
            "file-missing",
            format!("there is no track file `{}` of {word} `{}`", place.shown, name.value),
        );
        problems.push(problem.at(&pattern.span).help(format!(
            "`track` is a folder with a file for each {word}, or a path with `{{{word}}}` in place of its name: `track: track/{{{word}}}.csv`"
        )));
    }
}

/// A problem of a copied file, with the name that the file has beside the mapping.
fn placed(mut problem: Problem, names: &[(String, String)]) -> Problem {
    let spans = problem.at.iter_mut().chain(problem.also.iter_mut().map(|(span, _)| span));
    for span in spans {
        let Source { name, text, first_line, .. } = &*span.source;
        if let Some((_, shown)) = names.iter().find(|(inside, _)| inside == name) {
            span.source = Source::excerpt(shown.as_str(), text.as_str(), *first_line);
        }
    }
    problem
}
