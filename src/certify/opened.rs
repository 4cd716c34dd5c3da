//! The opened inputs of an evaluation.

use super::{Compiled, certify};
use crate::check::{Override, Overrides, plan::SetBy};
use crate::data::{Campaign, Campaigns, campaign::Confirmed};
use crate::problem::{Problem, Problems};
use crate::result::{Certification, Confirmation, confirmation::Signed, found::FoundSections};
use crate::run::{Progress, Settings};
use crate::syntax::document::Text;

/// A compiled protocol, and the campaigns that it is evaluated on as one.
#[derive(Debug)]
pub struct Opened {
    pub compiled: Compiled,
    pub campaigns: Vec<Campaign>,
    /// Values of parameters that the campaigns and the command line set.
    pub overrides: Overrides,
    /// How the sections of campaigns with runs were found.
    pub found: Vec<FoundSections>,
}

/// A parameter of a `--set name=value`.
pub type Set = (String, Text);

impl Opened {
    /// The campaigns as one.
    pub fn campaigns(&self) -> Campaigns<'_> {
        Campaigns::from(&self.campaigns)
    }

    /// Evaluates the protocol on the campaigns.
    ///
    /// # Errors
    /// As of [`certify`].
    pub fn certify(
        &self,
        settings: Settings,
        progress: Progress<'_>,
    ) -> Result<Certification, Problems> {
        let found = certify(&self.compiled, self.campaigns(), settings, progress)?;
        Ok(Certification { found: self.found.clone(), ..found })
    }
}

/// Parameters of the campaigns, which must set them alike, and over them those of the command line.
///
/// Problems: `parameters-differ`.
pub fn overrides(
    set: &[Set],
    campaigns: &[Campaign],
    problems: &mut Problems,
) -> Option<Overrides> {
    let mut overrides = Overrides::new();
    let on_command_line = |name: &str| set.iter().any(|(set, _)| set == name);
    for parameter in campaigns.iter().flat_map(|campaign| &campaign.parameters) {
        let name = &parameter.name.text;
        let same = |other: &&Campaign| {
            other
                .parameters
                .iter()
                .any(|other| (&other.name.text, &other.value.raw) == (name, &parameter.value.raw))
        };
        if let Some(other) =
            campaigns.iter().find(|other| !same(other)).filter(|_| !on_command_line(name))
        {
            let says = format!(
                "the parameter `{name}` is `{}` here, and not in the campaign `{}`",
                parameter.value.raw, other.short_name.value
            );
            let set = other.parameters.iter().find(|other| other.name.text == *name);
            let place = set.map_or(&other.short_name.span, |set| &set.value.span);
            let problem = Problem::error("parameters-differ", says).at(&parameter.value.span);
            let problem =
                problem.also(place, if set.is_some() { "another value" } else { "not set" });
            problems.push(problem.help(format!("set one for all: `--set {name}=...`")));
            return None;
        }
        let value = &parameter.value;
        let text = Text { text: value.raw.clone(), span: value.span.clone(), exact: value.exact };
        overrides.insert(parameter.name.text.clone(), Override { text, set_by: SetBy::Campaign });
    }
    for (name, text) in set.iter().cloned() {
        overrides.insert(name, Override { text, set_by: SetBy::CommandLine });
    }
    let all = campaigns.iter().flat_map(|campaign| &campaign.confirmed);
    overrides.confirmed = all.cloned().map(confirmation).collect();
    Some(overrides)
}

fn confirmation(of: Confirmed) -> Confirmation {
    let Confirmed { name, value, unit, clause, edition, by, date } = of;
    Confirmation { name, value, unit, clause, edition, signed: Signed { by, date } }
}
