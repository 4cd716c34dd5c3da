//! Several campaigns evaluated as one: a pool. A single campaign is a pool of one.

use super::campaign::{Campaign, VehicleState};
use crate::data::prelude::*;

/// The campaigns of a run, in the order given; at least one.
#[derive(Clone, Copy, Debug)]
pub struct Campaigns<'a>(&'a [Campaign]);

impl<'a> From<&'a Campaign> for Campaigns<'a> {
    fn from(one: &'a Campaign) -> Self {
        Self(std::slice::from_ref(one))
    }
}

impl<'a> From<&'a [Campaign]> for Campaigns<'a> {
    fn from(all: &'a [Campaign]) -> Self {
        Self(all)
    }
}

impl<'a> From<&'a Vec<Campaign>> for Campaigns<'a> {
    fn from(all: &'a Vec<Campaign>) -> Self {
        Self(all)
    }
}

/// What stands between the name of a campaign and that of a section or file of it. Section names
/// contain none.
const BETWEEN: char = '/';

/// The name of a section or file in the results of a pool: `series 2/S01`.
pub fn qualified(campaign: Option<&str>, name: &str) -> String {
    campaign.map_or_else(|| name.to_string(), |campaign| format!("{campaign}{BETWEEN}{name}"))
}

impl<'a> Campaigns<'a> {
    pub fn iter(self) -> std::slice::Iter<'a, Campaign> {
        self.0.iter()
    }

    pub fn get(self, number: usize) -> &'a Campaign {
        &self.0[number]
    }

    /// Whether there are several.
    pub fn pooled(self) -> bool {
        self.0.len() > 1
    }

    /// What one of several is called in results; nothing where there is one.
    pub fn name_of(self, number: usize) -> Option<&'a str> {
        self.pooled().then(|| self.0[number].short_name.value.as_str())
    }

    /// What a vehicle of a campaign is called, where there are several: `series 2`, `laden`,
    /// `series 2, laden`.
    pub fn vehicle_name(self, number: usize, vehicle: &VehicleState) -> Option<String> {
        let parts: Vec<&str> =
            self.name_of(number).into_iter().chain(vehicle.state.as_deref()).collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    }

    /// How many sections, or whole records, there are in all.
    pub fn sections(self) -> usize {
        self.0.iter().map(|campaign| campaign.names.len()).sum()
    }

    /// As [`Campaign::one_of_each`], of each campaign.
    pub fn one_of_each(self) -> Result<(), Problem> {
        self.0.iter().try_for_each(Campaign::one_of_each)
    }

    /// What campaigns need to stand side by side.
    ///
    /// Problems: `campaign-twice`, `duplicate-name`, `name-invalid`.
    pub fn check(self, problems: &mut Problems) {
        const HELP: &str = "give it a name of its own in campaign.yaml: `short name: series 2`";
        for (at, campaign) in self.0.iter().enumerate().filter(|_| self.pooled()) {
            let Spanned { value: name, span } = &campaign.short_name;
            if name.contains(BETWEEN) || name.contains(char::is_control) {
                let says = format!(
                    "`{name}` cannot be the name of one of several campaigns: it contains `{BETWEEN}`"
                );
                problems.push(error("name-invalid", says, span).help(HELP));
            }
            let before = &self.0[..at];
            let same = |other: &Campaign| other.folder() == campaign.folder();
            if campaign.on_disk() && before.iter().any(same) {
                problems.push(
                    problem!("campaign-twice", span, "the campaign `{name}` is given twice")
                        .help("name each folder once"),
                );
            } else if let Some(other) = before.iter().find(|other| other.short_name.value == *name)
            {
                let problem = problem!("duplicate-name", span, "two campaigns are called `{name}`");
                problems.push(problem.also(&other.short_name.span, "the first").help(HELP));
            }
        }
    }
}
