//! `new`: a campaign of any machine from simulated and measured records.

use super::{
    kit::*,
    scaffold::{Scaffold, scaffold},
};
use crate::check::{self, Overrides};
use crate::new::{DOMAINS, Made, PROTOCOL_FILE, files, records::Pair};
use crate::prepare;
use crate::source::Source;

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Domain {
    Rail,
    Drive,
    Oscillator,
    Arm,
    Generic,
}

#[derive(Debug, Args)]
pub struct New {
    /// Folder to create; it must not exist, or be empty.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Kind of machine: which effects the catalogue offers.
    #[arg(long, value_enum, default_value = "generic")]
    domain: Domain,
    /// A simulated and a measured record of the same run, with units in their headers; may be
    /// repeated.
    #[arg(long, num_args = 2, value_names = ["SIM.csv", "MEAS.csv"], required = true)]
    from: Vec<PathBuf>,
}

impl New {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(None)?;
        scaffold(&self.folder, console, |name, problems| {
            let Made { files, told } = self.made(name, problems)?;
            let folder = self.folder.display();
            let with = format!("--effects {folder}/effects.yaml --simulator {folder}/sim.yaml");
            let after = vec![
                format!("next: fishplate certify {folder} --out {folder}/report"),
                format!("      fill in {folder}/simulator.py, then"),
                format!("      fishplate diagnose {folder} {with} --preflight"),
                format!("      fishplate diagnose {folder} {with} --out {folder}/diagnosis"),
            ];
            Some(Scaffold { files, before: told, after })
        })
    }

    fn made(&self, name: &str, problems: &mut Problems) -> Option<Made> {
        let mut told = Vec::new();
        let read = |(at, pair): (usize, &[PathBuf])| {
            Pair::read(format!("R{}", at + 1), &pair[0], &pair[1], &mut told, problems)
        };
        // Problems of all records are told.
        let pairs = all(self.from.chunks_exact(2).enumerate().map(read))?;
        let made = problems.value(files(name, DOMAINS[self.domain as usize], &pairs))?;
        // What is written must be sound, whatever the columns are called.
        let (_, text) = made.files.iter().find(|(path, _)| path == PROTOCOL_FILE)?;
        let source = Source::new(PROTOCOL_FILE, text.clone());
        let family = prepare::read(&source, &library::parent, problems);
        check::check(&family, &Overrides::new(), problems)?;
        problems.0.retain(|problem| problem.severity == crate::problem::Severity::Error);
        Some(Made { told: [told, made.told].concat(), ..made })
    }
}
