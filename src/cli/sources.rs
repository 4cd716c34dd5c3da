//! Records imported again from their sources, for `verify --sources`.

use super::kit::*;
use crate::data::{
    campaign::CAMPAIGN_FILE,
    fingerprint::{fingerprint, of_file},
    origin::ORIGIN_FILE,
};
use crate::import::mapping::{self, Paths};
use crate::prepare::for_import;
use crate::provenance::verify::{Check, lines};
use crate::run::needs::needs;
use crate::source::Source;

const NAME: &str = "sources";

/// Imports the records of a campaign again by the mapping in its origin, whose files are in a folder,
/// and compares every file that was made. Nothing is written but to a temporary folder.
///
/// # Errors
/// The campaign cannot be opened; no temporary file can be written.
pub fn imported_again(folder: &Path, sources: &Path) -> Result<Check, Problems> {
    let mut problems = Problems::default();
    let campaign = Campaign::open(folder, &mut problems);
    let Some(campaign) = campaign.filter(|_| !problems.any_error()) else { return Err(problems) };
    let origin = campaign.origin.as_ref();
    let Some((origin, imported)) = origin.and_then(|own| Some((own, own.imported.as_ref()?)))
    else {
        return Ok(Check::not_possible(NAME, "the campaign was not written by an import"));
    };
    let source = Source::new(ORIGIN_FILE, imported.mapping.0.clone());
    let paths = problems.value(Paths::inside(sources));
    let mapping = paths.and_then(|paths| mapping::read(&source, paths, &mut problems));
    let compiled = mapping.as_ref().and_then(|mapping| for_import(mapping, &mut problems));
    let (Some(mapping), Some(compiled)) = (mapping, compiled) else {
        return Ok(not_repeated(&problems));
    };
    let mut details = Vec::new();
    for file in &origin.sources {
        let place = mapping.paths.place(&file.path, &mapping.top())?;
        let now = of_file(&place.path, &place.shown)?.map(|(hash, _)| hash);
        if now.as_ref() != Some(&file.sha256) {
            let now = now.unwrap_or_else(|| "missing".into());
            details.push(format!(
                "source {}: SHA-256 {} in the origin, {now} now",
                file.path, file.sha256
            ));
        }
    }
    let mut written = imported.records.iter().filter_map(|record| record.written.as_ref());
    let format = written.next().map_or(Format::Csv, |file| Format::of(Path::new(&file.path)));
    let needs = compiled.as_ref().map(|compiled| needs(&compiled.plan, &compiled.graph));
    let scratch = disk::scratch().map_err(|error| {
        Problem::error("write-failed", format!("no temporary folder can be made: {error}"))
    })?;
    let mut outputs = Outputs::of(SetKind::Campaign, scratch.path()).for_this_run();
    if let Err(problems) =
        crate::import::import(&mapping, needs.as_ref(), format, &mut outputs, &|_| {})
    {
        return Ok(not_repeated(&problems));
    }
    // What the user adds stands in campaign.yaml; the origin tells of the program's version.
    let made = outputs.hashes().filter(|(path, _)| ![CAMPAIGN_FILE, ORIGIN_FILE].contains(path));
    let made: Vec<(&str, &str)> = made.collect();
    for (path, sha256) in &made {
        match fingerprint(campaign.folder(), path)? {
            Some((now, _)) if now == *sha256 || is_edited(&campaign, path, &now) => {}
            Some(_) => details.push(format!("{path}: not what the import makes of its sources")),
            None => details.push(format!("{path}: missing")),
        }
    }
    let agrees = format!("imported again, {} files are those of the campaign", made.len());
    Ok(Check::of(NAME, agrees, "the campaign is not what its sources give", details))
}

/// Whether the campaign says why a record was changed.
fn is_edited(campaign: &Campaign, path: &str, sha256: &str) -> bool {
    let kind = RecordKind::ALL.into_iter().find(|kind| path.split('/').next() == Some(kind.key()));
    let changed = kind.and_then(|kind| campaign.changed(kind, path, sha256));
    changed.is_some_and(|changed| changed.reason.is_some())
}

fn not_repeated(problems: &Problems) -> Check {
    Check::differs(NAME, "the import cannot be repeated", lines(problems))
}
