//! Verification of a report, alone and against its campaign.

use std::path::{Path, PathBuf};

use serde_json::Value;

pub use super::check::{Check, Outcome, lines};
pub use super::files::Again;
use super::{
    carried::Carried,
    compare::{Compared, Difference, compare},
    files::{as_imported, end, pages},
};
use crate::certify::{Compiled, certify, protocol_info};
use crate::check::family::Family;
use crate::data::{Campaign, Campaigns, fingerprint::fingerprint, hash::sha256};
use crate::problem::{Problem, Problems};
use crate::result::{self, Certification, ConfirmedValue, Kind, THIS, confirmation::Signed};
use crate::run::{Settings, find, replay::replay};

/// Checks of the report alone; returns also its compiled protocol, if possible.
pub fn alone(carried: &Carried, given: Option<&Family>) -> (Vec<Check>, Option<Compiled>) {
    let mut checks = vec![form(carried)];
    checks.extend(carried.pdf.as_deref().map(end));
    checks.extend(files_beside(carried));
    let sources = match carried.sources(given) {
        Ok(sources) => sources,
        Err(problem) => {
            checks.push(Check::not_possible("protocol text", with_help(&problem)));
            return (checks, None);
        }
    };
    let texts: Vec<&str> = sources.iter().map(|source| source.text.as_str()).collect();
    checks.push(protocol_text(carried, &texts));
    let mut problems = Problems::default();
    let compiled = carried.compiled(&sources, &mut problems).filter(|_| !problems.any_error());
    let Some(compiled) = compiled else {
        checks.push(Check::differs(
            "protocol rules",
            "the protocol in the report has errors",
            lines(&problems),
        ));
        return (checks, None);
    };
    let again = Certification { protocol: protocol_info(&compiled), ..carried.results.clone() };
    let again = carried.comparable(&again);
    let found = compare(&carried.value["protocol"], &again["protocol"], "protocol");
    checks.push(Check::of(
        "protocol rules",
        format!(
            "{} and the parameters are those of the report",
            count(compiled.plan.quantities.len(), "quantity", "quantities")
        ),
        "the protocol in the report contradicts its results",
        details(&found),
    ));
    checks.extend(whose(&compiled));
    checks.push(statistics(carried, &compiled));
    (checks, Some(compiled))
}

/// Whose protocol it is, by its texts and not by what the report says.
fn whose(compiled: &Compiled) -> Option<Check> {
    const NAME: &str = "protocol";
    let found = protocol_info(compiled);
    let Some(own) = &found.own else {
        return Some(Check::agrees(NAME, format!("shipped, edition {}", found.shipped_edition?)));
    };
    if own.taken.is_some() {
        let says = "a text has a shipped name and another content";
        return Some(Check::differs(NAME, says, vec![own.text().into()]));
    }
    Some(Check::agrees(NAME, own.text()))
}

fn with_help(problem: &Problem) -> String {
    problem
        .help
        .as_ref()
        .map_or_else(|| problem.says.clone(), |help| format!("{}: {help}", problem.says))
}

/// Checks the text form of the results, which is unique, so that manual changes such as a repeated
/// key are detected.
fn form(carried: &Carried) -> Check {
    if carried.results.fishplate != THIS {
        let says = format!(
            "written by fishplate {}, this is {THIS}: the form is not compared",
            carried.results.fishplate
        );
        return Check::not_asked("form", says);
    }
    let again = result::text(&carried.value);
    if again == carried.text {
        return Check::agrees("form", "results.json has the form in which the program writes it");
    }
    let line = again.lines().zip(carried.text.lines()).position(|(a, b)| a != b);
    let line = line.unwrap_or_else(|| again.lines().count().min(carried.text.lines().count())) + 1;
    Check::differs(
        "form",
        "results.json does not have the form in which the program writes it",
        vec![format!("first difference at line {line}")],
    )
}

/// Compares the files of an output folder with the report.
fn files_beside(carried: &Carried) -> Vec<Check> {
    let Some(folder) = &carried.folder else { return Vec::new() };
    let mut checks = Vec::new();
    if carried.pdf.is_some() {
        let differs = if carried.other_results {
            vec!["results.json differs from the one inside report.pdf".to_string()]
        } else {
            Vec::new()
        };
        let agrees = "results.json is the same as inside report.pdf";
        checks.push(Check::of("results.json", agrees, "two results", differs));
    }
    checks.push(super::statement::check(folder));
    checks
}

fn protocol_text(carried: &Carried, texts: &[&str]) -> Check {
    let named = &carried.results.protocol;
    let mut details = Vec::new();
    for (file, text) in named.files.iter().zip(texts) {
        let found = sha256(text.as_bytes());
        if found != file.sha256 {
            details.push(format!(
                "{}: SHA-256 {} in the results, {found} of the text",
                file.name, file.sha256
            ));
        }
    }
    let all = sha256(texts.concat().as_bytes());
    if details.is_empty() && all != named.sha256 {
        details.push(format!(
            "all files together: SHA-256 {} in the results, {all} of the texts",
            named.sha256
        ));
    }
    let agrees = match texts.len() {
        1 => "its file has the SHA-256 given in the results".to_string(),
        many => format!("{many} files have the SHA-256 given in the results"),
    };
    Check::of(
        "protocol text",
        agrees,
        "the protocol in the report is not the one that was evaluated",
        details,
    )
}

/// Checks that statistics, verdict and reasons follow from the printed values.
fn statistics(carried: &Carried, compiled: &Compiled) -> Check {
    const NAME: &str = "statistics";
    let replayed = replay(&compiled.plan, &carried.results);
    let replayed = match replayed {
        Ok(replayed) => replayed,
        Err(says) => {
            return Check::differs(
                NAME,
                "the values cannot be evaluated with the protocol",
                vec![says],
            );
        }
    };
    let value = |key: &str| carried.value.get(key).unwrap_or(&Value::Null);
    let mut details: Vec<String> = replayed.contradictions;
    let mut numbers = 0;
    let judged = replayed.judged;
    let again = Certification {
        verdict_text: Kind::of(&judged.quantities).verdict_words(judged.verdict).into(),
        verdict: judged.verdict,
        own_word: judged.own_word,
        outcome: judged.outcome,
        reasons: judged.reasons,
        provisional: compiled.plan.values.provisional.clone(),
        verdicts: judged.verdicts,
        drawn: judged.drawn,
        quantities: judged.quantities,
        zones: judged.zones,
        application: replayed.application,
        ..carried.results.clone()
    };
    let again = carried.comparable(&again);
    // Reports of the first versions say nothing of values that are to be confirmed.
    let provisional = carried.value.get("provisional").map(|_| "provisional");
    // So do those of a verdict without draws.
    let drawn =
        (!again["drawn"].is_null() || carried.value.get("drawn").is_some()).then_some("drawn");
    let keys =
        ["verdict", "verdict_word", "reasons", "verdicts", "quantities", "zones", "application"];
    for key in keys.into_iter().chain(provisional).chain(drawn) {
        let found = compare(value(key), again.get(key).unwrap_or(&Value::Null), key);
        numbers += found.numbers;
        details.extend(found.differences.iter().map(|one| told(one, "follows from the values")));
    }
    let of: usize =
        carried.results.quantities.iter().map(|quantity| quantity.statistics.len()).sum();
    let values: usize =
        carried.results.quantities.iter().map(|quantity| quantity.values.len()).sum();
    let agrees = format!(
        "{of} statistics, their limits and the verdict follow from {values} values ({numbers} numbers compared)"
    );
    Check::of(NAME, agrees, "statistics or the verdict do not follow from the values", details)
}

/// Whether as many campaigns are given as the report is of.
///
/// # Errors
/// There are more, or fewer.
pub fn of_as_many(carried: &Carried, campaigns: &[PathBuf]) -> Result<(), Problem> {
    let members = &carried.results.campaign.members;
    if campaigns.len() == members.len().max(1) {
        return Ok(());
    }
    let says = match members.len() {
        0 => format!("the report is of one campaign, not of {}", campaigns.len()),
        many => {
            let names: Vec<&str> =
                members.iter().map(|member| member.short_name.as_str()).collect();
            format!(
                "the report is of {many} campaigns, not of {}; give these: {}",
                campaigns.len(),
                names.join("; ")
            )
        }
    };
    Err(Problem::error("number-of-campaigns", says))
}

/// Checks of inputs, numbers and pages against the campaign, or all of a pool: as many as
/// [`of_as_many`] wants.
pub fn against(carried: &Carried, compiled: Option<&Compiled>, again: Again<'_>) -> Vec<Check> {
    let opened = open(carried, again.campaigns);
    let mut lost = Vec::new();
    for file in &carried.results.campaign.files {
        let Some((folder, inside)) = place(carried, again.campaigns, &opened, &file.path) else {
            lost.push(format!("missing: {}", file.path));
            continue;
        };
        match fingerprint(folder, inside) {
            Ok(Some((hash, _))) if hash == file.sha256 => {}
            Ok(Some((hash, bytes))) => lost.push(format!(
                "changed: {}: SHA-256 {} ({} bytes) in the report, {hash} ({bytes} bytes) now",
                file.path, file.sha256, file.bytes
            )),
            Ok(None) => lost.push(format!("missing: {}", file.path)),
            Err(problem) => lost.push(format!("not readable: {}: {}", file.path, problem.says)),
        }
    }
    lost.extend(opened.iter().flat_map(|campaigns| not_confirmed(carried, campaigns)));
    let certified = compiled.map(|compiled| -> Result<Certification, Problems> {
        let mut campaigns = opened.as_ref().map_err(Clone::clone)?.clone();
        let found = find::in_all(&compiled.plan, &compiled.graph, &mut campaigns)?;
        let certified = certify(
            compiled,
            Campaigns::from(&campaigns),
            Settings { traces: again.plots },
            again.progress,
        )?;
        Ok(Certification { found, draft: carried.results.draft, ..certified })
    });
    if let Some(Ok(found)) = &certified {
        let known =
            |path: &str| carried.results.campaign.files.iter().any(|file| file.path == path);
        let extra = found.campaign.files.iter().filter(|file| !known(&file.path));
        lost.extend(extra.map(|file| {
            format!("extra: {} is read now, but was not read for the report", file.path)
        }));
        let unread = carried
            .results
            .campaign
            .files
            .iter()
            .filter(|file| !found.campaign.files.iter().any(|now| now.path == file.path));
        lost.extend(unread.map(|file| format!("no longer read: {}", file.path)));
    }
    let files = count(carried.results.campaign.files.len(), "file has", "files have");
    let inputs = Check::of(
        "input files",
        format!("{files} the SHA-256 of the report"),
        "the campaign differs from that of the report",
        lost,
    );
    let same = inputs.outcome == Outcome::Agrees;
    let mut checks = vec![inputs];
    if let Ok(campaigns) = &opened {
        checks.extend(campaigns.iter().filter_map(as_imported));
    }
    match certified {
        None => checks.push(Check::not_possible("run again", "the protocol cannot be evaluated")),
        Some(Err(problems)) => {
            checks.push(Check::differs(
                "run again",
                "the campaign can no longer be evaluated",
                lines(&problems),
            ));
        }
        Some(Ok(found)) => checks.extend(compared(carried, &found, again, same)),
    }
    checks
}

/// Values that the report calls confirmed and that the campaigns do not confirm.
fn not_confirmed(carried: &Carried, campaigns: &[Campaign]) -> Vec<String> {
    let stated = |value: &&ConfirmedValue| {
        let Signed { by, date } = &value.signed;
        campaigns
            .iter()
            .flat_map(|campaign| &campaign.confirmed)
            .any(|one| (&one.name, &one.by, &one.date) == (&value.value.name, by, date))
    };
    let all = carried.results.confirmed.iter().filter(|value| !stated(value));
    all.map(|one| format!("not confirmed by the campaign: {}", one.value.name)).collect()
}

/// The campaigns of the report in its order.
///
/// # Errors
/// One cannot be opened, or is not of the pool.
pub fn open(carried: &Carried, folders: &[PathBuf]) -> Result<Vec<Campaign>, Problems> {
    let mut problems = Problems::default();
    let mut opened: Vec<Campaign> =
        folders.iter().filter_map(|folder| Campaign::open(folder, &mut problems)).collect();
    if problems.any_error() {
        return Err(problems);
    }
    let members: Vec<&str> =
        carried.results.campaign.members.iter().map(|member| member.short_name.as_str()).collect();
    if !members.is_empty() {
        for campaign in &opened {
            let name = &campaign.short_name;
            if !members.contains(&name.value.as_str()) {
                let problem = Problem::error(
                    "unknown-campaign",
                    format!("the report has no campaign `{}`", name.value),
                )
                .at(&name.span);
                problems.push(problem.suggest(&name.value, members.iter().copied()));
            }
        }
        opened.sort_by_key(|campaign| {
            members.iter().position(|name| *name == campaign.short_name.value)
        });
    }
    if problems.any_error() { Err(problems) } else { Ok(opened) }
}

/// The folder of a file of the report, and its path there.
fn place<'a>(
    carried: &Carried,
    folders: &'a [PathBuf],
    opened: &'a Result<Vec<Campaign>, Problems>,
    path: &'a str,
) -> Option<(&'a Path, &'a str)> {
    if carried.results.campaign.members.is_empty() {
        return Some((folders.first()?.as_path(), path));
    }
    let (name, inside) = path.split_once('/')?;
    let campaign =
        opened.as_ref().ok()?.iter().find(|campaign| campaign.short_name.value == name)?;
    Some((campaign.folder(), inside))
}

/// Compares all numbers of the report with those of a new evaluation, and then the pages.
fn compared(
    carried: &Carried,
    found: &Certification,
    again: Again<'_>,
    inputs: bool,
) -> Vec<Check> {
    let mut now = carried.comparable(found);
    let mut before = carried.value.clone();
    for value in [&mut before, &mut now] {
        if let Some(entries) = value.as_object_mut() {
            entries.remove("fishplate");
        }
        // Files are compared separately.
        if let Some(campaign) = value.get_mut("campaign").and_then(Value::as_object_mut) {
            campaign.remove("files");
        }
    }
    let mut all = compare(&before, &now, "");
    // The verdict first, as the most relevant difference.
    all.differences.sort_by_key(|one| one.path != "verdict");
    let rounded = if all.rounded == 0 {
        String::new()
    } else {
        format!(", {} of them up to rounding", all.rounded)
    };
    let agrees = format!("all {} numbers are the same as in the report{rounded}", all.numbers);
    let differs = format!(
        "{} from the report",
        count(all.differences.len(), "value differs", "values differ")
    );
    let numbers = Check::of("run again", agrees, differs, details(&all));
    let same = inputs && numbers.outcome == Outcome::Agrees;
    std::iter::once(numbers).chain(pages(carried, found, again, same)).collect()
}

fn details(found: &Compared) -> Vec<String> {
    found.differences.iter().map(|one| told(one, "now")).collect()
}

/// `quantities[4].values[17].measured (Y_max, S05, Y_1R): 21.35 in the report, 21.36 now`
fn told(one: &Difference, now: &str) -> String {
    let of = if one.of.is_empty() { String::new() } else { format!(" ({})", one.of) };
    match (&one.before, &one.after) {
        (Some(before), Some(after)) => {
            format!("{}{of}: {before} in the report, {after} {now}", one.path)
        }
        (Some(before), None) => format!("{}{of}: {before} in the report, missing {now}", one.path),
        (None, after) => format!(
            "{}{of}: missing in the report, {} {now}",
            one.path,
            after.as_deref().unwrap_or_default()
        ),
    }
}

fn count(number: usize, one: &str, many: &str) -> String {
    if number == 1 { format!("1 {one}") } else { format!("{number} {many}") }
}
