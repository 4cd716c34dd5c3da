//! The files of a report and its summary, of `certify` and of `judge`.

use super::{kit::*, sign};
use crate::deliver::{self, Reports};
use crate::disk::SIGNATURE;
use crate::provenance::{
    carried::REPORT_PDF,
    signature::{self, SecretKey, secret_key},
    statement,
};
use crate::report::{
    estimates::{self, OfLimit},
    findings, number, rules,
};
use crate::result::{Certification, QuantityResult, Reason, StatisticResult, Verdict};
use crate::run::Settings;
use crate::words;

/// Default number of distance plots of a report.
pub const PLOTS: usize = 8;

#[derive(Debug, Args)]
pub struct Report {
    /// Output folder; created if missing.
    #[arg(long, short)]
    pub out: PathBuf,
    /// Outputs in addition to results.json and the tables.
    #[arg(long, value_enum, default_value_t = Only::All)]
    only: Only,
    /// Number of distance plots.
    #[arg(long, default_value_t = PLOTS)]
    plots: usize,
    /// Mark every page as a draft, and end with exit code 1, while values are not confirmed.
    #[arg(long = "final")]
    is_final: bool,
    /// Sign report.pdf and statement.json with this secret key; see `fishplate sign`.
    #[arg(long, value_name = "KEY")]
    sign: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Only {
    /// results.json, tables, report.pdf, report.html.
    All,
    /// results.json and tables.
    Results,
    /// results.json, tables, report.html.
    Html,
    /// results.json, tables, report.pdf.
    Pdf,
}

impl Report {
    pub fn settings(&self) -> Settings {
        Settings { traces: if self.only == Only::Results { 0 } else { self.plots } }
    }

    /// The key for signatures. The password is read before the computation, so that a wrong one is
    /// reported at once.
    ///
    /// # Errors
    /// The key cannot be read.
    pub fn key(&self) -> Result<Option<SecretKey>, Problem> {
        self.sign.as_deref().map(|path| secret_key(path, sign::password())).transpose()
    }

    /// Writes all files or none, and prints the summary.
    ///
    /// # Errors
    /// The report cannot be made, or a file not be written.
    pub fn write(
        &self,
        mut found: Certification,
        key: Option<&SecretKey>,
        console: &Console,
    ) -> Done {
        found.draft = self.is_final && !found.provisional.is_empty();
        let found = &found;
        let files = self.files(found, key).map_err(Ended::unfinished)?;
        console.write_all(SetKind::Report, &self.out, &files)?;
        console.written(&summary(found, console), &self.out)?;
        let holds = found.verdict == Verdict::Validated && !found.draft;
        Ok(if holds { Exit::Done } else { Exit::DoesNotHold })
    }

    /// All files of the report, by path relative to the output folder.
    fn files(
        &self,
        found: &Certification,
        key: Option<&SecretKey>,
    ) -> Result<Vec<(String, Vec<u8>)>, Problems> {
        let pdf = matches!(self.only, Only::All | Only::Pdf);
        let html = matches!(self.only, Only::All | Only::Html);
        let mut files = deliver::certification(found, Reports { pdf, html })?;
        if let Some(key) = key {
            let signed = files
                .iter()
                .filter(|(name, _)| [REPORT_PDF, statement::FILE].contains(&name.as_str()));
            let signed = signed.map(|(name, bytes)| {
                Ok((format!("{name}{SIGNATURE}"), signature::sign(key, name, bytes)?.into_bytes()))
            });
            files.extend(signed.collect::<Result<Vec<_>, Problem>>()?);
        }
        Ok(files)
    }
}

/// The table of verdicts for the terminal.
fn summary(found: &Certification, console: &Console) -> Lines {
    let mut out = Lines::default();
    out += &found.campaign.name;
    out += &found.protocol.title;
    out += "\n";
    for table in [statistics(found, console), estimated(found, console)].iter().flatten() {
        out.append(table);
        out += "\n";
    }
    let used = found.sections.iter().filter(|section| section.used).count();
    out += &format!("{used} of {} sections used\n", found.sections.len());
    for section in found.sections.iter().filter(|section| !section.used) {
        let reason = words::or_nothing(section.reason.as_ref());
        out += &format!("  {} not used: {reason}\n", section.section);
    }
    for finding in &found.findings {
        out += &format!("finding: {}\n", findings::line(finding));
    }
    for note in &found.notes {
        out += &format!("note: {}\n", note.text());
    }
    for deviation in found.deviations.iter().filter(|one| !rules::is_of_rules(&one.what)) {
        out += &format!("deviation: {}\n", deviation.what.text());
    }
    for value in &found.provisional {
        out += &format!("not confirmed: {} = {}\n", value.name, value.in_words());
    }
    if found.draft {
        out += "the report is marked as a draft: campaign.yaml confirms values below `confirmed`\n";
    }
    let holds = found.verdict == Verdict::Validated;
    let overall = found.verdicts.iter().find(|verdict| verdict.overall);
    let title = overall.map_or(String::new(), |verdict| format!(", {}", verdict.title));
    let words = format!("Verdict{title}: {}", found.verdict_in_words());
    out += "\n";
    out += &console.paint(words, Some(holds));
    for says in rules::beside_verdict(found) {
        out += &format!("  {says}");
    }
    for reason in &found.reasons {
        out += &format!("  {}\n", reason.text());
    }
    // Of a rule that does not hold, a reason tells it.
    for drawn in found.drawn.iter().filter(|drawn| drawn.holds() == Some(true)) {
        let of = drawn.verdict.as_ref().map_or(String::new(), |name| format!("{name}: "));
        out += &format!("  {of}{}\n", Reason::InDraws(drawn.clone()).text());
    }
    for verdict in found.verdicts.iter().filter(|verdict| !verdict.overall) {
        let word = console.paint(verdict.word.clone(), verdict.outcome.holds());
        out += &format!("{}: {word}\n", verdict.title);
        for reason in &verdict.reasons {
            out += &format!("  {}\n", reason.text());
        }
    }
    out
}

fn verdict(
    quantity: &QuantityResult,
    holds: Option<bool>,
    marginal: bool,
    console: &Console,
) -> String {
    let word = match holds {
        Some(true) => "met",
        Some(false) => "NOT MET",
        None => open(quantity),
    };
    console.paint(format!("{word}{}", if marginal { ", marginal" } else { "" }), holds)
}

/// What is said of a limit of a quantity that neither holds nor does not.
fn open(quantity: &QuantityResult) -> &'static str {
    match quantity.reason.as_ref().is_some_and(Reason::is_of_optional) {
        true => "not assessed",
        false => "not assessable",
    }
}

fn shown(value: Option<f64>) -> String {
    value.map_or("-".to_string(), |value| number::significant(value, 4))
}

fn bound(statistic: &StatisticResult) -> String {
    match statistic.between() {
        Some((low, high)) => format!("{} to {}", shown(Some(low)), shown(Some(high))),
        None => format!("{}{}", statistic.direction.sign(), shown(statistic.limit)),
    }
}

fn ratio(statistic: &StatisticResult) -> String {
    let share = |share: f64| if share < 1000.0 { format!("{share:.3}") } else { "> 1000".into() };
    statistic.normalised.map_or("-".to_string(), share)
}

/// Statistics that are told one by one: those of comparisons.
fn statistics(found: &Certification, console: &Console) -> Option<Lines> {
    let told: Vec<_> = found
        .quantities
        .iter()
        .filter(|quantity| quantity.from.is_none() || quantity.statistics.is_empty())
        .collect();
    let has_row = |quantity: &&QuantityResult| {
        !estimates::single(quantity).is_empty()
            || quantity.statistics.is_empty() && quantity.reason.is_some()
    };
    if !told.iter().any(has_row) && !found.quantities.is_empty() {
        return None;
    }
    let width = told.iter().map(|quantity| quantity.id.chars().count()).max().unwrap_or(8).max(8);
    let mut out = Lines::default();
    out += &format!(
        "{:width$}  {:>8}  {:<26} {:>5}  {:>4}  {:>12}  {:>12}  {:>8}\n",
        "quantity", "unit", "statistic", "pairs", "n", "value", "limit", "|v|/limit"
    );
    for quantity in told {
        // With too few pairs, statistics that are within their limits do not meet them.
        let is_open = quantity.holds.is_none()
            && quantity.reason.as_ref().is_some_and(|reason| !reason.is_of_optional());
        for (index, statistic) in estimates::single(quantity).into_iter().enumerate() {
            let first = index == 0;
            let name = if first { &*quantity.id } else { "" };
            let own = first || statistic.unit != quantity.unit;
            out += &format!(
                "{name:width$}  {:>8}  {:<26} {:>5}  {:>4}  {:>12}  {:>12}  {:>8}  {}\n",
                if own { &*statistic.unit } else { "" },
                format!("{}{}", statistic.title, statistic.scope.suffix()),
                statistic.count,
                statistic.n,
                shown(statistic.value),
                bound(statistic),
                ratio(statistic),
                verdict(
                    quantity,
                    statistic.holds.filter(|_| !is_open),
                    statistic.marginal && !is_open,
                    console
                )
            );
        }
        match &quantity.reason {
            Some(reason) if quantity.statistics.is_empty() => {
                out += &format!("{:width$}  {}\n", quantity.id, reason.text())
            }
            Some(reason) if quantity.holds.is_none() => {
                out += &format!("{:width$}  {}: {}\n", "", open(quantity), reason.text());
            }
            _ => {}
        }
    }
    Some(out)
}

/// One line for each limit of assessed quantities and each limit by group: how many groups hold,
/// and the largest ratio with its place.
fn estimated(found: &Certification, console: &Console) -> Option<Lines> {
    let limits: Vec<_> = found
        .quantities
        .iter()
        .flat_map(|quantity| {
            estimates::condensed(quantity).into_iter().map(move |limit| (quantity, limit))
        })
        .collect();
    if limits.is_empty() {
        return None;
    }
    let longest =
        |texts: &mut dyn Iterator<Item = usize>, least: usize| texts.max().unwrap_or(0).max(least);
    let ids = longest(&mut limits.iter().map(|(quantity, _)| quantity.id.chars().count()), 8);
    let titles =
        longest(&mut limits.iter().map(|(_, limit)| limit.results[0].title.chars().count()), 8);
    let place = |limit: &OfLimit<'_>| limit.decisive().scope.to_string();
    let places = longest(&mut limits.iter().map(|(_, limit)| place(limit).chars().count()), 10);
    let mut out = Lines::default();
    out += &format!(
        "{:ids$}  {:>8}  {:titles$}  {:>12}  {:>12}  {:>9}  {:places$}  groups met\n",
        "quantity", "unit", "estimate", "largest", "limit", "|v|/limit", "where"
    );
    let mut before = "";
    for (quantity, limit) in &limits {
        let decisive = limit.decisive();
        out += &format!(
            "{:ids$}  {:>8}  {:titles$}  {:>12}  {:>12}  {:>9}  {:places$}  {}, {}\n",
            if before == quantity.id { "" } else { &quantity.id },
            decisive.unit,
            decisive.title,
            shown(decisive.value),
            bound(decisive),
            ratio(decisive),
            if decisive.value.is_some() { place(limit) } else { "-".into() },
            limit.holding(),
            verdict(quantity, limit.holds(), limit.results.iter().any(|one| one.marginal), console)
        );
        before = &quantity.id;
    }
    if limits.iter().any(|(_, limit)| limit.by_group()) {
        out += "all groups: report, results.json\n";
    }
    Some(out)
}
