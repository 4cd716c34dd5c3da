//! Scores of diagnoses against known truths. The diagnosis does not use this module.

use indexmap::IndexMap;
use serde_json::Value;

use super::campaign::Really;
use crate::diagnose::levels::score::DETECTABLE;
use crate::diagnose::observe::observed::Observed;
use crate::effects::{Action, Applied, CHANNEL, Catalogue, Confined};
use crate::metrics::interval::wilson;
use crate::result::{
    FORMAT, THIS,
    blind::{Blind, BySize, Calibration, Case, Places, Score},
    diagnosis::{Cause, Diagnosis, NamedEffect},
};

/// One effect of a truth.
#[derive(Clone, Debug, PartialEq)]
pub struct True {
    pub name: String,
    pub parameters: Vec<(String, Value)>,
    pub confined: Option<Confined>,
}

/// Known modifications of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// `single`, `pair`, `none`, `outside` or `trap`.
    pub kind: String,
    pub effects: Vec<True>,
}

impl Truth {
    /// Reads a `truth.json`.
    ///
    /// # Errors
    /// The text is not JSON, or a key is missing; the message says which.
    pub fn read(text: &str) -> Result<Self, String> {
        let json: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let kind = json["kind"].as_str().ok_or("it has no `kind`")?.to_string();
        let effects = json["effects"].as_array().cloned().unwrap_or_default();
        let one = |effect: &Value| {
            let confined = ["zones", "direction", "sections"]
                .iter()
                .find_map(|key| effect.get(*key).and_then(|values| confined(key, values)));
            let parameters = effect["parameters"]
                .as_object()
                .into_iter()
                .flatten()
                .map(|(key, value)| (key.clone(), value.clone()));
            Ok(True {
                name: effect["name"].as_str().ok_or("an effect has no `name`")?.to_string(),
                parameters: parameters.collect(),
                confined,
            })
        };
        Ok(Self { kind, effects: effects.iter().map(one).collect::<Result<_, String>>()? })
    }

    /// The effects as the catalogue applies them; nothing if the catalogue does not contain one of
    /// them.
    pub fn applied(&self, catalogue: &Catalogue) -> Option<Vec<Applied>> {
        self.effects.iter().map(|effect| effect.applied(catalogue)).collect()
    }
}

/// The sections of an effect as truths and answers write them: a key, and one value or a list.
fn confined(key: &str, values: &Value) -> Option<Confined> {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_string);
    let column = match key {
        "zones" => "zone",
        "sections" => "section",
        other => other,
    };
    let values = match values {
        Value::Null => return None,
        Value::Array(items) => items.iter().map(text).collect(),
        one => vec![text(one)],
    };
    Some(Confined { column: column.to_string(), values })
}

impl True {
    fn applied(&self, catalogue: &Catalogue) -> Option<Applied> {
        let known = catalogue.effect(&self.name)?;
        let mut applied = Applied {
            effect: self.name.clone(),
            values: Vec::new(),
            channels: Vec::new(),
            confined: self.confined.clone(),
        };
        for (key, value) in &self.parameters {
            if key.ends_with("_channels") {
                applied.channels = value
                    .as_array()?
                    .iter()
                    .filter_map(|name| Some(name.as_str()?.to_string()))
                    .collect();
                continue;
            }
            let found = known.parameters.iter().find_map(|parameter| {
                match parameter.name.strip_suffix(CHANNEL) {
                    Some(stem) => {
                        key.strip_prefix(stem).map(|channel| (parameter, Some(channel.to_string())))
                    }
                    None => (parameter.name == *key).then_some((parameter, None)),
                }
            });
            let (parameter, channel) = found?;
            applied.channels.extend(channel);
            let number = value.as_f64().or_else(|| match value.as_str() {
                Some("both") => Some(0.0),
                Some("R") => Some(1.0),
                Some("L") => Some(-1.0),
                _ => None,
            });
            match number {
                Some(number) => applied.values.push((parameter.name.clone(), number)),
                // Pairs of channels.
                None => {
                    applied.channels.extend(
                        value
                            .as_array()?
                            .iter()
                            .flat_map(|pair| pair.as_array().cloned().unwrap_or_default())
                            .filter_map(|name| Some(name.as_str()?.to_string())),
                    );
                    applied.values.push((parameter.name.clone(), parameter.default));
                }
            }
        }
        if applied.channels.is_empty()
            && let Action::Signals(_, all) = &known.action
        {
            applied.channels.clone_from(all);
        }
        applied.values.dedup_by(|a, b| a.0 == b.0);
        Some(applied)
    }

    /// Whether a named effect is this one: the same name and, where given, the same channel.
    fn is(&self, named: &NamedEffect) -> bool {
        if self.name != named.name {
            return false;
        }
        let channels: Vec<&String> = self
            .parameters
            .iter()
            .map(|(key, _)| key)
            .filter(|key| !named.parameters.contains_key(*key))
            .collect();
        let by_channel = named.parameters.keys().any(|key| {
            key.contains("gain.") || key.contains("offset.") || key.contains("polarity.")
        });
        !by_channel || channels.len() < self.parameters.len()
    }

    /// The sections where this effect acts, and those where it was named; nothing if both are all
    /// sections.
    fn sections(&self, named: &NamedEffect, sections: &[Observed]) -> Option<Places> {
        let told =
            named.confined_to.iter().flatten().find_map(|(key, values)| confined(key, values));
        if self.confined.is_none() && told.is_none() {
            return None;
        }
        let acts = |confined: &Option<Confined>, at: &Observed| {
            confined.as_ref().is_none_or(|confined| {
                at.section.fact(&confined.column).is_some_and(|value| confined.has(value))
            })
        };
        let both: Vec<(bool, bool)> =
            sections.iter().map(|at| (acts(&self.confined, at), acts(&told, at))).collect();
        let count =
            |holds: &dyn Fn(&(bool, bool)) -> bool| both.iter().filter(|one| holds(one)).count();
        Some(Places {
            truly: count(&|one| one.0),
            told: count(&|one| one.1),
            both: count(&|one| one.0 && one.1),
        })
    }

    fn error(&self, named: &NamedEffect) -> Option<f64> {
        self.parameters.iter().find_map(|(key, value)| {
            let (truth, said) = (value.as_f64()?, named.parameters.get(key)?.value.as_f64()?);
            (truth != 0.0).then(|| (said - truth).abs() / truth.abs())
        })
    }
}

/// Cells called significant against cells that the truth changes. With no effect hidden, no cell is
/// true.
fn cells(diagnosis: &Diagnosis, truth: &Truth, really: Option<&Really>) -> Option<Places> {
    let moved: &[String] = match really {
        Some(really) => &really.cells,
        None if truth.kind == "none" => &[],
        None => return None,
    };
    let told: Vec<&String> = diagnosis
        .r#where
        .iter()
        .filter(|place| place.significant)
        .map(|place| &place.says)
        .collect();
    Some(Places {
        truly: moved.len(),
        told: told.len(),
        both: told.iter().filter(|says| moved.contains(says)).count(),
    })
}

/// Scores one diagnosis against its truth.
pub fn case(
    campaign: &str,
    diagnosis: &Diagnosis,
    truth: &Truth,
    really: Option<&Really>,
    sections: &[Observed],
) -> Case {
    let names =
        |cause: &Cause| cause.effects.iter().map(|effect| effect.name.clone()).collect::<Vec<_>>();
    let right = |cause: &Cause| {
        !truth.effects.is_empty()
            && truth.effects.len() == cause.effects.len()
            && truth.effects.iter().all(|one| cause.effects.iter().any(|named| one.is(named)))
    };
    let answered = matches!(&*diagnosis.verdict, "explained" | "ambiguous");
    let causes: &[Cause] = if answered { &diagnosis.causes } else { &[] };
    let set: Vec<&Cause> = causes.iter().filter(|cause| cause.in_ambiguity_set).collect();
    let first = causes.first();
    let error = first.and_then(|cause| {
        let pairs = truth.effects.iter().filter_map(|one| {
            cause.effects.iter().find(|named| one.is(named)).and_then(|named| one.error(named))
        });
        pairs.reduce(f64::max)
    });
    let acts = first.and_then(|cause| {
        truth.effects.iter().find_map(|one| {
            cause
                .effects
                .iter()
                .find(|named| one.is(named))
                .and_then(|named| one.sections(named, sections))
        })
    });
    let moving = really.filter(|really| !really.cells.is_empty());
    let first_cell = moving
        .zip(diagnosis.r#where.first())
        .map(|(really, place)| really.cells.contains(&place.says));
    Case {
        campaign: campaign.to_string(),
        kind: truth.kind.clone(),
        truth: truth.effects.iter().map(|one| one.name.clone()).collect(),
        verdict: diagnosis.verdict.to_string(),
        named: first.map(names).unwrap_or_default(),
        ambiguity_set: set.iter().flat_map(|cause| names(cause)).collect(),
        detectability: really.map(|really| really.detectability),
        weakest: really.and_then(|really| really.weakest),
        first_is_right: first.is_some_and(right),
        in_first_two: causes.iter().take(2).any(right),
        in_set: set.iter().any(|cause| right(cause)),
        parameter_error: error,
        shrink_said: diagnosis
            .shrink
            .as_ref()
            .filter(|_| answered)
            .map(|shrink| shrink.fraction_removed),
        shrink_true: really.map(|really| really.removed),
        probability: first.map(|cause| cause.probability),
        cells: cells(diagnosis, truth, really),
        first_cell_moved: first_cell,
        sections: acts,
        fault: None,
    }
}

/// Scores of all cases.
pub fn blind(cases: Vec<Case>) -> Blind {
    let good: Vec<&Case> = cases.iter().filter(|case| case.fault.is_none()).collect();
    let of = |kind: &str| good.iter().copied().filter(|case| case.kind == kind).collect::<Vec<_>>();
    let seen = |case: &&Case| case.detectability.is_some_and(|d| d >= DETECTABLE);
    let singles: Vec<&Case> = of("single").into_iter().filter(seen).collect();
    let apart = |case: &&Case| case.weakest.is_some_and(|d| d >= DETECTABLE);
    let pairs: Vec<&Case> = of("pair").into_iter().filter(apart).collect();
    let portion = |name: &str, k: usize, n: usize| {
        let (value, interval) = (k as f64 / n as f64, wilson(k as u64, n as u64));
        let known = |value: f64| (n > 0).then_some(value);
        Score {
            name: name.into(),
            cases: n,
            value: known(value),
            low: known(interval.0),
            high: known(interval.1),
        }
    };
    let share = |name: &str, cases: &[&Case], holds: &dyn Fn(&Case) -> bool| {
        portion(name, cases.iter().filter(|case| holds(case)).count(), cases.len())
    };
    let places = |of: &dyn Fn(&Case) -> Option<Places>| {
        let join = |a: Places, b: Places| Places {
            truly: a.truly + b.truly,
            told: a.told + b.told,
            both: a.both + b.both,
        };
        good.iter().filter_map(|case| of(case)).fold(Places::default(), join)
    };
    let (cells, sections) = (places(&|case| case.cells), places(&|case| case.sections));
    let placed: Vec<&Case> =
        good.iter().copied().filter(|case| case.first_cell_moved.is_some()).collect();
    let quantile = |name: &str, mut values: Vec<f64>, at: f64| {
        values.sort_by(f64::total_cmp);
        let value =
            (!values.is_empty()).then(|| values[((values.len() - 1) as f64 * at).round() as usize]);
        Score { name: name.into(), cases: values.len(), value, low: None, high: None }
    };
    let size = |case: &&Case| case.ambiguity_set.len() as f64 / case.truth.len().max(1) as f64;
    let shrink: Vec<f64> = good
        .iter()
        .filter_map(|case| Some(100.0 * (case.shrink_said? - case.shrink_true?).abs()))
        .collect();
    let errors: Vec<f64> = good
        .iter()
        .filter(|case| case.first_is_right)
        .filter_map(|case| case.parameter_error)
        .collect();
    let sizes: Vec<f64> =
        singles.iter().filter(|case| !case.ambiguity_set.is_empty()).map(size).collect();
    let mean_size = (!sizes.is_empty()).then(|| sizes.iter().sum::<f64>() / sizes.len() as f64);
    let scores = vec![
        share("single effects, d >= 5: named first", &singles, &|case| case.first_is_right),
        share("single effects, d >= 5: among the first two", &singles, &|case| case.in_first_two),
        share("single effects, d >= 5: in the ambiguity set", &singles, &|case| case.in_set),
        Score {
            name: "mean size of the ambiguity set".into(),
            cases: sizes.len(),
            value: mean_size,
            low: None,
            high: None,
        },
        share("single effects, all: named first", &of("single"), &|case| case.first_is_right),
        share("no effect: a cause named", &of("none"), &|case| !case.named.is_empty()),
        share("outside the catalogue: named with confidence", &of("outside"), &|case| {
            case.verdict == "explained"
        }),
        share("outside the catalogue: said to be unexplained", &of("outside"), &|case| {
            case.verdict == "unexplained"
        }),
        share("traps avoided", &of("trap"), &|case| case.first_is_right || case.named.is_empty()),
        share("pairs: both found", &of("pair"), &|case| {
            case.truth.iter().all(|name| case.named.contains(name))
        }),
        share("pairs, each d >= 5 given the other: both found", &pairs, &|case| {
            case.truth.iter().all(|name| case.named.contains(name))
        }),
        share("pairs: at least one found", &of("pair"), &|case| {
            case.truth.iter().any(|name| case.named.contains(name))
        }),
        portion("cells of the map called significant: moved by the truth", cells.both, cells.told),
        portion("cells of the map moved by the truth: called significant", cells.both, cells.truly),
        share("first cell of the map: moved by the truth", &placed, &|case| {
            case.first_cell_moved == Some(true)
        }),
        portion("confined effects, sections named: true", sections.both, sections.told),
        portion("confined effects, true sections: named", sections.both, sections.truly),
        quantile("error of the shrink, median, percentage points", shrink.clone(), 0.5),
        quantile("error of the shrink, 90 %, percentage points", shrink, 0.9),
        quantile("error of the parameter, median, relative", errors.clone(), 0.5),
        quantile("error of the parameter, 90 %, relative", errors, 0.9),
    ];
    let mut confusion: IndexMap<String, IndexMap<String, usize>> = IndexMap::new();
    for case in &good {
        let join = |names: &[String], none: &str| {
            if names.is_empty() { none.to_string() } else { names.join(" + ") }
        };
        let named = join(&case.named, &case.verdict);
        *confusion.entry(join(&case.truth, &case.kind)).or_default().entry(named).or_default() += 1;
    }
    let edges = [0.0, 3.0, 5.0, 8.0, 12.0, 20.0, 40.0];
    let by_detectability = edges.iter().enumerate().map(|(at, low)| {
        let high = edges.get(at + 1).copied().unwrap_or(f64::INFINITY);
        let inside: Vec<&&Case> = good
            .iter()
            .filter(|case| {
                case.kind == "single" && case.detectability.is_some_and(|d| d >= *low && d < high)
            })
            .collect();
        let named = inside.iter().filter(|case| case.first_is_right).count();
        let interval = wilson(named as u64, inside.len() as u64);
        BySize { from: *low, cases: inside.len(), named, low: interval.0, high: interval.1 }
    });
    let by_detectability = by_detectability.collect();
    let bins = (0..5).filter_map(|bin| {
        let (low, high) = (0.2 * f64::from(bin), 0.2 * f64::from(bin + 1) + 1e-9);
        let inside: Vec<&&Case> = good
            .iter()
            .filter(|case| case.probability.is_some_and(|p| p >= low && p < high))
            .collect();
        let (cases, right) =
            (inside.len(), inside.iter().filter(|case| case.first_is_right).count());
        let said = inside.iter().filter_map(|case| case.probability).sum::<f64>() / cases as f64;
        let interval = wilson(right as u64, cases as u64);
        (cases > 0).then_some(Calibration { said, cases, right, low: interval.0, high: interval.1 })
    });
    let calibration = bins.collect();
    Blind {
        fishplate: THIS.into(),
        format: FORMAT,
        scores,
        confusion,
        by_detectability,
        calibration,
        cases,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn truths_are_read() {
        let text = r#"{"kind": "single", "effects": [{"name": "friction", "parameters": {"friction": 0.5}, "zones": [4]}]}"#;
        let truth = Truth::read(text).expect("a truth");
        assert_eq!(
            truth.effects[0].confined,
            Some(Confined { column: "zone".into(), values: vec!["4".into()] })
        );
        assert!(Truth::read("{}").is_err() && Truth::read("no json").is_err());
    }

    /// Cells and sections are counted over all cases: 7 of 8 reported cells are true, 7 of 10 true
    /// cells are reported. A case without a hidden effect and with one reported cell adds one false
    /// cell.
    #[test]
    fn places_are_counted_over_all_cases() {
        let places = |truly, told, both| Some(Places { truly, told, both });
        let case =
            |cells, sections| Case { kind: "single".into(), cells, sections, ..Case::default() };
        let scored = blind(vec![
            case(places(6, 5, 5), None),
            case(places(4, 2, 2), places(4, 5, 3)),
            case(places(0, 1, 0), None),
        ]);
        let of = |name: &str| {
            scored.scores.iter().find(|score| score.name == name).expect("a score of this name")
        };
        let (precision, recall) = (
            of("cells of the map called significant: moved by the truth"),
            of("cells of the map moved by the truth: called significant"),
        );
        assert_eq!(
            (precision.cases, precision.value, recall.cases, recall.value),
            (8, Some(0.875), 10, Some(0.7))
        );
        assert_eq!(precision.low.zip(precision.high), Some(wilson(7, 8)));
        assert_eq!(of("confined effects, sections named: true").value, Some(0.6));
        assert_eq!(of("confined effects, true sections: named").value, Some(0.75));
        assert_eq!(of("traps avoided").value, None);
    }

    /// Three pairs, both named in two of them. In the third, the weaker effect is not detectable
    /// together with the other.
    #[test]
    fn pairs_that_can_be_told_apart_are_counted_by_themselves() {
        let truth = vec!["a".to_string(), "b".to_string()];
        let case = |named: &[&str], weakest| Case {
            kind: "pair".into(),
            truth: truth.clone(),
            named: named.iter().map(|name| (*name).to_string()).collect(),
            weakest: Some(weakest),
            ..Case::default()
        };
        let scored = blind(vec![case(&["a", "b"], 6.0), case(&["b", "a"], 9.0), case(&["a"], 4.9)]);
        let of = |name: &str| {
            scored
                .scores
                .iter()
                .find(|score| score.name == name)
                .map(|score| (score.cases, score.value))
        };
        assert_eq!(of("pairs: both found"), Some((3, Some(2.0 / 3.0))));
        assert_eq!(of("pairs, each d >= 5 given the other: both found"), Some((2, Some(1.0))));
    }
}
