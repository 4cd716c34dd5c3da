//! `certify`: evaluates a protocol on a campaign and writes the report.

use super::{kit::*, report::Report};

#[derive(Debug, Args)]
pub struct Certify {
    /// Folder of the campaign; several are evaluated as one.
    #[arg(required = true, value_name = "CAMPAIGN")]
    campaigns: Vec<PathBuf>,
    /// Path of a protocol, or name of a shipped one [default: the one in campaign.yaml, else
    /// en14363-2016-annex-t]
    #[arg(long, short)]
    protocol: Option<String>,
    /// Set a parameter of the protocol.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    report: Report,
    /// Number of records processed in parallel [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

impl Certify {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(self.jobs)?;
        let opened = console.read(|problems| {
            let protocol = self.protocol.as_deref();
            let opened = prepare_all(&self.campaigns, protocol, &self.set, problems)?;
            check_outputs(&self.report.out, REPORT, &opened.campaigns, problems);
            Some(opened)
        })?;
        let key = self.report.key()?;
        let found = console.with_progress(opened.campaigns().sections(), |progress| {
            opened.certify(self.report.settings(), progress)
        })?;
        self.report.write(found, key.as_ref(), console)
    }
}
