//! A campaign of the archive: the values of its sections, made once in each way in which protocols
//! make them.

use std::sync::{Arc, Mutex, PoisonError};

use super::{
    touched::{Key, Mask},
    variants::Variant,
};
use crate::check::plan::Plan;
use crate::data::Campaign;
use crate::graph::Graph;
use crate::problem::Problems;
use crate::result::comparison::OnCampaign;
use crate::run::{
    Evaluated, Numbered, Progress, Reduced, SectionValues, evaluated, file_hash, several::reduced,
};
use crate::values::Joined;

/// A campaign by itself, or the campaigns that files of values are of as one.
#[derive(Debug)]
pub struct Source {
    pub name: String,
    pub from: From,
    /// In the order of the archive.
    pub number: usize,
}

/// Where its values are from.
#[derive(Debug)]
pub enum From {
    Records(Box<Campaign>),
    Values(Box<Joined>),
}

impl From {
    pub fn in_words(&self) -> &'static str {
        match self {
            Self::Records(_) => "records",
            Self::Values(_) => "values",
        }
    }
}

impl Source {
    /// Number of its sections.
    pub fn sections(&self) -> usize {
        match &self.from {
            From::Records(campaign) => campaign.names.len(),
            From::Values(joined) => joined.head.basis.units().len(),
        }
    }

    /// As told in a result, with the records that were read for it.
    pub fn told(&self, evaluated: Option<&Evaluated>) -> OnCampaign {
        let mut files = match &self.from {
            From::Records(campaign) => {
                campaign.files.iter().map(|file| file_hash(file, None, None)).collect()
            }
            From::Values(joined) => joined.head.about.files().cloned().collect::<Vec<_>>(),
        };
        files.extend(evaluated.into_iter().flat_map(|evaluated| evaluated.files.iter().cloned()));
        OnCampaign { name: self.name.clone(), sections: self.sections(), files }
    }

    /// The values that protocols need: of records all, of files those that are there.
    pub fn made(&self, protocols: &[Arc<Variant>], progress: Progress<'_>) -> Made {
        let mut made = Made::default();
        match &self.from {
            From::Values(joined) => {
                let (basis, sections) = (joined.head.basis.clone(), joined.sections().to_vec());
                let key = Key::of(&joined.compiled.family.merged);
                made.ways.push((key, Ok(Reduced { basis, sections, traces: Vec::new() })));
                progress(&self.name);
            }
            From::Records(campaign) => {
                let mut some: Vec<&Arc<Variant>> = Vec::new();
                for protocol in protocols {
                    let known = || some.iter().map(|one| &one.key);
                    if !lacking(&protocol.key, known).is_empty() {
                        some.push(protocol);
                    }
                }
                let rules: Vec<(&Plan, &Graph)> =
                    some.iter().map(|one| (&one.compiled.plan, &one.compiled.graph)).collect();
                let found = reduced(&rules, campaign, &|_| {});
                made.ways = some.iter().map(|one| one.key.clone()).zip(found).collect();
                progress(&self.name);
            }
        }
        made
    }
}

/// The quantities of a protocol of which there are no values.
fn lacking<'a, T: Iterator<Item = &'a Key>>(key: &Key, known: impl Fn() -> T) -> Vec<String> {
    let has = |quantity: &&(String, String)| {
        known().any(|known| known.same_sections(key) && known.place(quantity).is_some())
    };
    key.quantities.iter().filter(|quantity| !has(quantity)).map(|(id, _)| id.clone()).collect()
}

/// Evaluated under what holds everywhere, and with a way of making values.
type Known = ((Mask, Key), Arc<Result<Evaluated, Problems>>);

/// The values of a campaign.
#[derive(Debug, Default)]
pub struct Made {
    ways: Vec<(Key, Result<Reduced, Problems>)>,
    evaluated: Mutex<Vec<Known>>,
}

impl Made {
    /// The quantities of a protocol of which there are no values.
    pub fn lacks(&self, protocol: &Variant) -> Vec<String> {
        lacking(&protocol.key, || self.ways.iter().map(|(key, _)| key))
    }

    /// Whether sections are selected and checked as a protocol does.
    pub fn has_sections(&self, protocol: &Variant) -> bool {
        self.ways.iter().any(|(key, _)| key.same_sections(&protocol.key))
    }

    /// Whether some section can be used with values made in one way and not in another.
    pub fn vary(&self) -> bool {
        let faults = |reduced: &Reduced| {
            let faulty = |(_, values): &Numbered| values.fault.is_some();
            reduced.sections.iter().map(faulty).collect::<Vec<bool>>()
        };
        let differs = |(key, one): &(Key, Result<Reduced, Problems>)| {
            self.ways.iter().filter(|(other, _)| other.same_sections(key)).any(|(_, other)| match (
                one, other,
            ) {
                (Ok(one), Ok(other)) => faults(one) != faults(other),
                (one, other) => one.is_ok() != other.is_ok(),
            })
        };
        self.ways.iter().any(differs)
    }

    /// All sections evaluated for a protocol; `None` where there are no values for it. `everywhere`
    /// are the changed rules in it that hold for all sections.
    pub fn evaluated(
        &self,
        protocol: &Variant,
        everywhere: Mask,
    ) -> Option<Arc<Result<Evaluated, Problems>>> {
        let same = |(known, _): &&Known| known.0 == everywhere && known.1 == protocol.key;
        let lock = || self.evaluated.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = lock().iter().find(same) {
            return Some(Arc::clone(known));
        }
        let found = Arc::new(self.put_together(protocol)?);
        lock().push(((everywhere, protocol.key.clone()), Arc::clone(&found)));
        Some(found)
    }

    /// The values of each quantity as they are made for the protocol.
    fn put_together(
        &self,
        Variant { compiled, key }: &Variant,
    ) -> Option<Result<Evaluated, Problems>> {
        let fitting = || self.ways.iter().filter(|(known, _)| known.same_sections(key));
        let base = &fitting().next()?.1;
        let place = |quantity| {
            fitting().find_map(|(known, reduced)| Some((reduced.as_ref(), known.place(quantity)?)))
        };
        let mut sources: Vec<(&Reduced, usize)> = Vec::new();
        for found in key.quantities.iter().map(place) {
            match found? {
                (Ok(reduced), place) => sources.push((reduced, place)),
                (Err(problems), _) => return Some(Err(problems.clone())),
            }
        }
        let base = match base {
            Ok(base) => base,
            Err(problems) => return Some(Err(problems.clone())),
        };
        let sections = base.sections.iter().enumerate().map(|(at, (number, own))| {
            let mut values =
                SectionValues { rows: Vec::new(), impossible: Vec::new(), ..own.clone() };
            for (index, (reduced, place)) in sources.iter().enumerate() {
                let Some((_, of)) = reduced.sections.get(at) else { continue };
                values.rows.push(of.rows.get(*place).cloned().unwrap_or_default());
                let own = of.impossible.iter().filter(|(quantity, _)| quantity == place);
                values.impossible.extend(own.map(|(_, reason)| (index, reason.clone())));
                values.fault = values.fault.or_else(|| of.fault.clone());
            }
            (*number, values)
        });
        Some(evaluated(&compiled.plan, &base.basis, sections.collect()))
    }
}
