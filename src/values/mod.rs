//! Files of values: what a part of a campaign came to, to be judged together with other parts, on
//! another machine or later.
//!
//! | file | content |
//! |---|---|
//! | `mod` | what a file contains; `reduce` makes it |
//! | `rows` | the table of values as columns |
//! | `seal` | the hash of a file inside the file; binary contents as text |
//! | `write`, `read` | the bytes of a file |
//! | `join` | files of one campaign together, and their judgement |

mod join;
mod read;
mod rows;
pub mod seal;
mod write;

use serde::{Deserialize, Serialize};

use crate::certify::{About, Opened, Rules};
use crate::problem::Problems;
use crate::result::found::FoundSections;
use crate::run::{self, Basis, Kept, Numbered, Progress, Shard};

pub use join::{Joined, join};
pub use read::{File, open, read};
pub use write::write;

/// Version of the program, which writes files of values for itself only: other versions may compute
/// other numbers.
pub const PROGRAM: &str = env!("CARGO_PKG_VERSION");
/// The form of the files.
pub const FORM: u32 = 5;

/// What all parts of a campaign have in common.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Head {
    pub rules: Rules,
    pub about: About,
    pub basis: Basis,
    /// How sections were found in runs.
    pub found: Vec<FoundSections>,
}

/// The values of a part of a campaign.
#[derive(Clone, Debug)]
pub struct Values {
    pub program: String,
    pub head: Head,
    pub shard: Shard,
    pub sections: Vec<Numbered>,
    pub traces: Vec<Kept>,
    /// Of each section.
    pub labels: Vec<Label>,
}

/// Where a section is from, for readers of the table.
#[derive(Clone, Debug, Default)]
pub struct Label {
    pub campaign: String,
    pub run: Option<String>,
    pub state: Option<String>,
}

/// Which sections are evaluated, and what is kept beside their values.
#[derive(Clone, Copy, Debug)]
pub struct ReduceJob {
    pub shard: Shard,
    /// Whether signals are kept for the plots of a report.
    pub plots: bool,
}

/// Evaluates the sections of a part.
///
/// # Errors
/// As [`run::reduce`].
pub fn reduce(
    opened: &Opened,
    part: ReduceJob,
    progress: Progress<'_>,
) -> Result<Values, Problems> {
    let (compiled, campaigns) = (&opened.compiled, opened.campaigns());
    let reduced = run::reduce(
        &compiled.plan,
        &compiled.graph,
        campaigns,
        (part.shard, part.plots),
        progress,
    )?;
    let about = About::of(&compiled.plan, campaigns, reduced.basis.vehicle(&compiled.plan));
    let label = |(number, _): &Numbered| {
        let Some(unit) = reduced.basis.units().get(*number) else { return Label::default() };
        let campaign = campaigns.get(unit.campaign);
        let before: usize =
            campaigns.iter().take(unit.campaign).map(|campaign| campaign.vehicles.len()).sum();
        Label {
            campaign: campaign.short_name.value.clone(),
            run: campaign.run_of(&unit.cell).map(|run| run.name.value.clone()),
            state: unit
                .vehicle
                .checked_sub(before)
                .and_then(|number| campaign.vehicles.get(number)?.state.clone()),
        }
    };
    Ok(Values {
        program: PROGRAM.into(),
        labels: reduced.sections.iter().map(label).collect(),
        head: Head {
            rules: Rules::of(compiled),
            about,
            basis: reduced.basis,
            found: opened.found.clone(),
        },
        shard: part.shard,
        sections: reduced.sections,
        traces: reduced.traces,
    })
}
