//! The standing discrepancy from the campaigns of known state.

use crate::data::Campaign;
use crate::diagnose::inputs::{Inputs, Reference, value_of};
use crate::diagnose::levels::standing::OWN;
use crate::diagnose::linearise::{
    covariance::{covariance, discrepancies, expect},
    declared::Declared,
    sensitivity::sensitivities,
    standing::{Shown, Standing},
    whiten::less,
};
use crate::diagnose::observe::{
    bench::{Bench, Runs},
    observations::Observations,
};
use crate::diagnose::settings::{Over, Settings};
use crate::problem::{Problem, Problems};
use crate::yaml::{Key, Node};

/// The standing part, from all references of a diagnosis.
///
/// Problems: records that cannot be read; no section or channel to compare.
pub fn learnt(inputs: &Inputs<'_>, runs: &mut Runs, problems: &mut Problems) -> Option<Standing> {
    let shown: Option<Vec<Shown>> = inputs
        .references
        .iter()
        .map(|reference| shown(inputs, reference, runs, problems))
        .collect();
    Some(Standing::learn(&shown?))
}

/// Numbers of a vehicle file that differ from another file, with the other value, by their paths.
fn differing<'a>(
    own: &'a Node,
    other: Option<&'a Node>,
    path: &str,
) -> Vec<(String, &'a Node, Option<&'a Node>)> {
    let of = |(key, node): &'a (Key, Node)| {
        let (path, there) =
            (format!("{path}{}", key.text), other.and_then(|other| other.get(&key.text)));
        let below = differing(node, there, &format!("{path}."));
        let number = |node| crate::simulate::number_of(node, &path);
        let differs = number(node).is_some() && number(node) != there.and_then(number);
        differs.then_some((path, node, there)).into_iter().chain(below)
    };
    own.entries().iter().flat_map(of).collect()
}

/// Warns where the vehicle file of a reference differs from the campaign's: the standing part is a
/// property of one vehicle.
fn check_vehicle(inputs: &Inputs<'_>, reference: &Campaign, problems: &mut Problems) {
    let found = differing(&inputs.campaign.vehicle, Some(&reference.vehicle), "");
    let Some((path, own, there)) = found.first() else { return };
    let more = if found.len() > 1 {
        format!(" ({} more numbers differ)", found.len() - 1)
    } else {
        String::new()
    };
    let has = there.map_or("not there".to_string(), |there| there.raw.clone());
    let says = format!(
        "the reference `{}` has another vehicle: `{path}` is {has} there{more}",
        reference.name
    );
    problems.push(
        Problem::warning("reference", says)
            .at(&own.span)
            .help("the standing discrepancy is estimated as if the vehicle were the same"),
    );
}

fn shown(
    inputs: &Inputs<'_>,
    reference: &Reference<'_>,
    runs: &mut Runs,
    problems: &mut Problems,
) -> Option<Shown> {
    (inputs.trying)(&format!("standing discrepancy from `{}`", reference.campaign.name));
    let (campaign, settings) = (reference.campaign, inputs.settings);
    check_vehicle(inputs, campaign, problems);
    let admitted = Declared::read(campaign, settings, problems);
    let declared = |name: &str| admitted.get(name);
    let unit = |channel: &str| reference.simulator?.unit(channel);
    let sections = crate::simulate::sections(campaign, problems)?;
    let seen = Observations::read(
        campaign,
        sections,
        inputs.catalogue,
        settings,
        &declared,
        &unit,
        problems,
    )?;
    let simulated = seen.all(true, |observed| &observed.simulated);
    let mut difference = less(&seen.all(false, |observed| &observed.measured), &simulated);
    let bench = reference.simulator.map(|simulator| Bench {
        seen: &seen,
        simulator,
        cache: reference.cache.clone(),
        set: Vec::new(),
    });
    let columns = match &bench {
        Some(bench) => {
            let base = bench.features(&[]).map_err(|problem| problems.push(problem)).ok()?;
            let value = |key: &str| value_of(campaign, key);
            sensitivities(bench, settings, &base, &value, &declared, &|_| true, runs)
                .into_iter()
                .flatten()
                .collect()
        }
        None => Vec::new(),
    };
    expect(&columns, &mut difference);
    let own = own(settings);
    let covariance =
        covariance(&seen, &own, &simulated, &columns, &declared, Some(&Standing::default()));
    Some(Shown { covariance, columns: discrepancies(&seen, settings).0, difference })
}

/// The settings with only the part of each discrepancy that varies between campaigns; scatter
/// between sections is kept in full.
fn own(settings: &Settings) -> Settings {
    let mut own = settings.clone();
    let shared =
        own.discrepancies.iter_mut().filter(|discrepancy| discrepancy.over != Over::Sections);
    shared.for_each(|discrepancy| discrepancy.sd.iter_mut().for_each(|sd| *sd *= OWN));
    own
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    #[test]
    fn numbers_that_another_vehicle_has_not() {
        let read = |text: &str| {
            crate::yaml::load(&Source::new("vehicle.yaml", text), &mut Problems::default())
                .expect("a map")
        };
        let own = read("name: A\nfriction: 0.35\nbody:\n  mass: 32000.0\n  height: 1.8\n");
        let other = read("name: B\nfriction: 0.350\nbody:\n  mass: 28000\n");
        let found: Vec<(String, Option<&str>)> = differing(&own, Some(&other), "")
            .into_iter()
            .map(|(path, _, there)| (path, there.map(|there| there.raw.as_str())))
            .collect();
        assert_eq!(
            found,
            [("body.mass".to_string(), Some("28000")), ("body.height".to_string(), None)]
        );
        assert!(differing(&own, Some(&own), "").is_empty());
    }
}
