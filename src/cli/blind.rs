//! `blind`: diagnoses every campaign first, then reads the truths and scores the answers.

use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicUsize, Ordering},
};

use rayon::prelude::*;

use super::{diagnose::Asked, kit::*, simulate::load_catalogue};
use crate::data::campaign::CAMPAIGN_FILE;
use crate::diagnose::{
    Outcome, Really, effect_of_truth,
    score::{Truth, blind, case},
    settings::Settings,
};
use crate::effects::Catalogue;
use crate::report::{blind as report, html};
use crate::result::{blind::Case, text};

/// Maximum size of a truth file in bytes.
const LARGEST_TRUTH: u64 = 1 << 20;
/// Maximum depth of the search for campaigns.
const DEEPEST: usize = 6;

#[derive(Debug, Args)]
pub struct Blinded {
    /// Folders. Every campaign in them is diagnosed.
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Path of a protocol, or name of a shipped one.
    #[arg(long, short)]
    protocol: Option<String>,
    /// Catalogue of effects: a path, or the name of a shipped one.
    #[arg(long = "effects", value_name = "CATALOGUE", default_value = library::CATALOGUES[0].name)]
    catalogue: String,
    /// Folder for blind.json, blind.html and the diagnoses.
    #[arg(long, short, default_value = "blind")]
    out: PathBuf,
    /// Folder for intermediate results, so that an interrupted run can be resumed.
    #[arg(long, value_name = "DIR")]
    resume: Option<PathBuf>,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Blinded {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(None)?;
        let mut campaigns = Vec::new();
        self.folders.iter().for_each(|folder| find(folder, &mut campaigns, 0));
        campaigns.sort();
        campaigns.dedup_by(|one, other| same(one, other));
        if campaigns.is_empty() {
            let says = "these folders contain no campaign";
            return Err(Problem::error("no-campaigns", says).into());
        }
        let mut problems = Problems::default();
        // A fault of the catalogue is reported once, not for every campaign.
        let catalogue = load_catalogue(&self.catalogue, &mut problems)
            .filter(|catalogue| Settings::read(catalogue, &mut problems).is_some());
        // So is one of the protocol.
        if let Some(named) = &self.protocol {
            load(named, &mut problems);
        }
        let Some(catalogue) = catalogue.filter(|_| !problems.any_error()) else {
            return Err(problems.into());
        };
        let diagnosed = AtomicUsize::new(0);
        let out = Mutex::new(Outputs::new(&self.out));
        // In parallel, since one diagnosis does not use all cores all the time.
        let one = |(at, folder): (usize, &PathBuf)| {
            console.say(&format!("{} of {}: {}", at + 1, campaigns.len(), folder.display()));
            self.diagnose_folder(folder, &catalogue, &out, &diagnosed, console)
        };
        let cases: Result<Vec<Case>, Problem> =
            campaigns.par_iter().enumerate().with_max_len(1).map(one).collect();
        let scored = blind(cases.map_err(Ended::unfinished)?);
        if diagnosed.load(Ordering::Relaxed) == 0 {
            let says = "none of the campaigns could be diagnosed";
            return Err(Problem::error("no-diagnosis", says).into());
        }
        let document = report::document("Diagnoses against withheld truths", &scored);
        let page = html::html(&document, &[]).map_err(Ended::unfinished)?;
        let mut outputs = out.into_inner().unwrap_or_else(PoisonError::into_inner);
        let files = [("blind.json", text(&scored)), ("blind.html", page)];
        let added = files.iter().try_for_each(|(name, text)| outputs.add(name, text.as_bytes()));
        console.commit(added.map(|()| outputs))?;
        for score in &scored.scores {
            let value = score.value.map_or("-".to_string(), |value| format!("{value:.3}"));
            let interval = score
                .low
                .zip(score.high)
                .map_or(String::new(), |(low, high)| format!("  ({low:.2} to {high:.2})"));
            console.say(&format!("{:56} {:4}  {value}{interval}", score.name, score.cases));
        }
        Ok(Exit::Done)
    }

    /// The diagnosis is written and closed before the truth is opened.
    fn diagnose_folder(
        &self,
        folder: &Path,
        catalogue: &Catalogue,
        out: &Mutex<Outputs>,
        diagnosed: &AtomicUsize,
        console: &Console,
    ) -> Result<Case, Problem> {
        let mut problems = Problems::default();
        let asked = Asked {
            folder,
            protocol: self.protocol.as_deref(),
            catalogue: &self.catalogue,
            simulator: None,
            resume: self.resume.as_deref(),
            references: &[],
            seed: self.seed,
        };
        let name = folder
            .file_name()
            .map_or_else(|| "campaign".to_string(), |name| name.to_string_lossy().into_owned());
        let places = |campaign: &Campaign| check_folder(&self.out, REPORT, campaign);
        let found = super::diagnose::diagnosed(&asked, &places, &|_| {}, &mut problems);
        console.problems(&problems);
        let Some((files, outcome)) = found else {
            let first = problems.0.into_iter().next();
            return Ok(without(&name, first.map_or("no diagnosis".into(), |first| first.says)));
        };
        diagnosed.fetch_add(1, Ordering::Relaxed);
        out.lock()
            .unwrap_or_else(PoisonError::into_inner)
            .add(&format!("{name}/diagnosis.json"), text(&outcome.diagnosis).as_bytes())?;
        let text = disk::read(&folder.join("truth.json"), LARGEST_TRUTH)
            .map_err(|error| error.to_string())
            .and_then(|bytes| String::from_utf8(bytes).map_err(|error| error.to_string()));
        let truth = match text.and_then(|text| Truth::read(&text)) {
            Ok(truth) => truth,
            Err(fault) => return Ok(without(&name, format!("truth.json: {fault}"))),
        };
        let really = self.true_effect(folder, &files.campaign, &outcome, catalogue, &truth);
        Ok(case(&name, &outcome.diagnosis, &truth, really.as_ref(), &outcome.found.seen.sections))
    }

    /// Influence of the true effects; nothing if there are none, or if the catalogue does not
    /// contain them.
    fn true_effect(
        &self,
        folder: &Path,
        campaign: &Campaign,
        outcome: &Outcome,
        catalogue: &Catalogue,
        truth: &Truth,
    ) -> Option<Really> {
        let effects = truth.applied(catalogue).filter(|effects| !effects.is_empty())?;
        let mut problems = Problems::default();
        let (compiled, _) = prepare(folder, self.protocol.as_deref(), &[], &mut problems)?;
        effect_of_truth(campaign, &compiled, outcome, catalogue, &effects)
    }
}

fn without(campaign: &str, fault: String) -> Case {
    Case { campaign: campaign.to_string(), fault: Some(fault), ..Case::default() }
}

/// Campaigns in a folder or below it.
fn find(folder: &Path, found: &mut Vec<PathBuf>, depth: usize) {
    if disk::may_be_file(&folder.join(CAMPAIGN_FILE)) {
        found.push(folder.to_path_buf());
        return;
    }
    for name in disk::names(folder).unwrap_or_default() {
        let below = folder.join(name);
        if depth < DEEPEST && disk::is_folder(&below).unwrap_or(false) {
            find(&below, found, depth + 1);
        }
    }
}
