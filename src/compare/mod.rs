//! Protocols side by side over campaigns: verdicts, agreement, sensitivity, applicability, and what
//! each difference of two protocols does.
//!
//! | file | content |
//! |---|---|
//! | `subject` | the protocols and campaigns of a comparison; compiling with the parameters of each campaign |
//! | `metric` | the metrics of a protocol, and their numbers |
//! | `found` | what the protocols made of a campaign |
//! | `campaign` | one campaign by all protocols: `run::several`, reduced to plain numbers |
//! | `agreement` | contingency tables and rank correlations |
//! | `sensitivity` | change of each metric over the size of each disturbance |
//! | `applicability` | tries with one quantity, one section, doubled and exchanged records |
//! | `rules` | each changed rule by itself in the first of two protocols |
//!
//! # Definitions
//!
//! **Metric.** The limits of a protocol that are about the same kind of number: for differences of
//! values the estimate (`mean`, `standard deviation (n-1)`), for metrics of both signals the metric
//! (`sprague-geers magnitude`), with its estimate where it is not `each`. The *numbers* of a metric
//! are its ratios value / limit, one for each limit and group, with their sign; where every value
//! has its own limit, the worst, without sign. A quantity without a limit has its mean value as its
//! number.
//!
//! **Score of a section.** The largest |value| / limit over the values of the section and the
//! limits of a metric, or of a protocol. The limit of a pooled estimate stands for the values of
//! the section too: |difference| over the limit of the mean, over that of the standard deviation.
//! Up to 1, the section *meets* the requirement. Scores are the comparable units of agreement:
//! contingency tables count sections met and not met, Spearman's correlation ranks them; sections
//! of all campaigns together.
//!
//! **Disturbance of size x.** It changes the measured samples of a section by x times their
//! standard deviation, as an rms over the section, before any filter: an offset of x standard
//! deviations; a gain, and white noise, of that rms; for a shift in time, which all channels share,
//! the rms is over the channels. `choice of sections` of size x leaves out the share x of the
//! sections, drawn `sensitivity::DRAWS` times. The sensitivity is the root mean square of the
//! change of a metric's numbers. Sections that are not used stay unused, and plausibility rules are
//! not asked again.
//!
//! **Applicability.** What a campaign gives if all but one section, or the values of all but one
//! quantity, are withheld: whether the metric has a number, and whether the protocol has a verdict.
//!
//! **A rule by itself.** A difference is a block or a field of the protocols as merged with their
//! ancestors (`check::diff`). It is made to the merged first protocol, which is then checked and
//! evaluated as any other; so nothing is approximated. Where the result is no protocol, since the
//! rule needs another one, that is said with the first problem. Protocols are compared rule by rule
//! only if one extends the other, both extend the same, or half of the rules of the first stand in
//! the second (`rules::related`).

mod agreement;
mod applicability;
mod campaign;
mod found;
mod metric;
mod rules;
mod sensitivity;
mod subject;

use crate::certify::{Compiled, Set, protocol_info};
use crate::check::{diff::Change, family::Family};
use crate::data::Campaign;
use crate::problem::{Problems, all};
use crate::result::{
    FORMAT, THIS,
    comparison::{Compared, Comparison, OnCampaign, Work},
};
use crate::run::{
    Counts, Progress, find,
    trial::{Disturbance, Kind, Trial},
};
use subject::{Subject, WithProtocols};

pub use rules::{ALL, related};
pub use subject::{campaigns, of_protocol, unknown_parameters};

/// Settings of a comparison.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Sizes of disturbances; none for no sensitivities.
    pub sizes: Vec<f64>,
    /// Parameters that are set, of every protocol that has them.
    pub set: Vec<Set>,
}

/// Sizes of disturbances, if none are given.
pub const SIZES: [f64; 3] = [0.1, 0.2, 0.4];

/// A disturbance of records and its name.
const KINDS: [(Kind, &str); 4] = [
    (Kind::Offset, "offset"),
    (Kind::Gain, "gain"),
    (Kind::Shift, "time shift"),
    (Kind::Noise, "noise"),
];

/// The trials of a campaign, in the order of [`KINDS`] and sizes, then those for the applicability.
fn trials(sizes: &[f64]) -> Vec<Trial> {
    let disturbed = KINDS.iter().flat_map(|(kind, _)| {
        sizes.iter().map(|size| Trial::Disturbed(Disturbance { kind: *kind, size: *size }))
    });
    disturbed.chain([Trial::Doubled, Trial::Exchanged]).collect()
}

/// Gives a campaign the sections that the first protocol which looks for sections finds in its
/// runs: all protocols are compared on the same.
fn with_found_sections(opened: WithProtocols, problems: &mut Problems) -> Option<WithProtocols> {
    let WithProtocols { name, campaign, compiled } = opened;
    let campaign = on_found_sections(&compiled.protocols, campaign, problems)?;
    Some(WithProtocols { name, campaign, compiled })
}

/// A campaign with the sections that the first protocol which looks for some finds in its runs.
pub fn on_found_sections<'a>(
    protocols: impl IntoIterator<Item = &'a Compiled>,
    campaign: Campaign,
    problems: &mut Problems,
) -> Option<Campaign> {
    let applies = |one: &&Compiled| find::applies(&one.plan, &campaign);
    let Some(first) = protocols.into_iter().find(applies) else { return Some(campaign) };
    let found = find::find(&first.plan, &first.graph, &campaign, &|_| {});
    found.map_err(|told| problems.add(told.0)).ok().map(|found| found.campaign)
}

/// A comparison, checked and compiled.
#[derive(Debug)]
pub struct Prepared {
    protocols: Vec<Subject>,
    campaigns: Vec<WithProtocols>,
    changes: Vec<Change>,
    /// Number of differences of two protocols that have nothing in common; none of them is applied
    /// alone.
    unrelated: Option<usize>,
    settings: Settings,
}

impl Prepared {
    /// Compiles every protocol with the parameters of each campaign. With two protocols, the first
    /// with each changed rule too.
    ///
    /// Problems: `protocol-twice`, `campaign-twice`, `unknown-parameter`; those of a protocol or of
    /// a value that is set.
    pub fn new(
        families: Vec<Family>,
        campaigns: Vec<Campaign>,
        settings: Settings,
        problems: &mut Problems,
    ) -> Option<Self> {
        let protocols = subject::protocols(families, problems);
        let campaigns = subject::campaigns(campaigns, problems);
        if problems.any_error() {
            return None;
        }
        let (changes, unrelated) = match protocols.as_slice() {
            [before, after] if related(&before.family, &after.family) => {
                (rules::changes(before, after), None)
            }
            [before, after] => (Vec::new(), Some(rules::changes(before, after).len())),
            _ => (Vec::new(), None),
        };
        let opened = subject::opened(&protocols, campaigns, &changes, &settings, problems)?;
        let campaigns =
            all(opened.into_iter().map(|opened| with_found_sections(opened, problems)))?;
        Some(Self { protocols, campaigns, changes, unrelated, settings })
    }

    /// Number of times that progress is told.
    pub fn steps(&self) -> usize {
        let sections: usize = self.campaigns.iter().map(|one| one.campaign.names.len()).sum();
        sections * (1 + trials(&self.settings.sizes).len())
    }

    /// Compares the protocols.
    pub fn compare(&self, progress: Progress<'_>) -> Comparison {
        let Self { protocols, campaigns, changes, unrelated, settings } = self;
        let trials = trials(&settings.sizes);
        let names: Vec<&str> = protocols.iter().map(|subject| subject.name.as_str()).collect();
        let found: Vec<found::CampaignComparison> = campaigns
            .iter()
            .map(|opened| campaign::found(opened, &names, &trials, settings, progress))
            .collect();
        let counts: Counts = found.iter().map(|found| found.counts).sum();
        let protocols = self.compared();
        let hashes: String = protocols.iter().map(|one| format!("{}\n", one.sha256)).collect();
        Comparison {
            fishplate: THIS.into(),
            format: FORMAT,
            protocols,
            campaigns: campaigns
                .iter()
                .zip(&found)
                .map(|(opened, found)| OnCampaign {
                    name: opened.name.clone(),
                    sections: opened.campaign.names.len(),
                    files: found.files.clone(),
                })
                .collect(),
            verdicts: found
                .iter()
                .flat_map(|found| found.judgements.iter().map(|one| one.cell.clone()))
                .collect(),
            ratios: found
                .iter()
                .flat_map(|found| found.judgements.iter().flat_map(|one| one.ratios.clone()))
                .collect(),
            agreement: agreement::agreement(&names, &found),
            sensitivity: sensitivity::curves(&names, &found, &settings.sizes),
            applicability: applicability::put_together(&found),
            differences: rules::differences(changes, campaigns, &found),
            unrelated: *unrelated,
            scores: found.iter().flat_map(|found| found.scores.clone()).collect(),
            work: Work {
                records_read: counts.records_read,
                records_asked: counts.records_asked,
                filters_run: counts.filters_run,
                filters_asked: counts.filters_asked,
                operations: self.compiled().iter().map(|one| one.graph.nodes.len()).sum(),
                sha256: crate::data::hash::sha256(hashes.as_bytes()),
            },
        }
    }

    /// The protocols as compiled for the first campaign.
    fn compiled(&self) -> &[Compiled] {
        self.campaigns.first().map_or(&[][..], |opened| &opened.compiled.protocols)
    }

    fn compared(&self) -> Vec<Compared> {
        let compiled = self.compiled();
        let one = |(compiled, subject): (&Compiled, &Subject)| compared(&subject.name, compiled);
        compiled.iter().zip(&self.protocols).map(one).collect()
    }
}

/// A protocol with the name it has in a comparison.
pub fn compared(name: &str, compiled: &Compiled) -> Compared {
    let info = protocol_info(compiled);
    Compared {
        name: name.into(),
        title: info.title,
        edition: info.edition,
        sha256: info.sha256,
        metrics: metric::names(&compiled.plan),
        criterion: info.verdict_rule,
        files: info.files,
    }
}
