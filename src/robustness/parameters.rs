//! The verdict as a function of parameters and rules of the protocol, each varied by itself.

use super::{Settings, case_of, joined, rule::Rule, scale::Scale, unshifted};
use crate::certify::{Compiled, compile};
use crate::check::{
    Override, Overrides,
    family::Family,
    plan::{Parameter, Plan, SetBy},
};
use crate::data::Campaigns;
use crate::problem::{Problem, Problems};
use crate::result::study::{
    AtValue, Largest, ParameterStudy, Selected, Study, StudyResult, Varied,
};
use crate::run::{Evaluated, Progress};
use crate::source::Source;
use crate::study::marked;
use crate::syntax::document::Text;

/// A parameter or a rule, and its values as written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vary {
    /// The name of a parameter, or the words that lead to a rule: `quantity NAME limit std`, or to
    /// several: `every limit std`.
    pub name: String,
    pub values: Vec<String>,
}

/// Every parameter with a choice of words, over all its words.
pub fn all_choices(plan: &Plan) -> Vec<Vary> {
    let choices = plan.parameters.iter().filter(|parameter| !parameter.choices.is_empty());
    choices
        .map(|parameter| Vary { name: parameter.name.clone(), values: parameter.choices.clone() })
        .collect()
}

/// Evaluates the protocol for each value of each parameter or rule, with the others unchanged.
///
/// `progress` receives the value that is being evaluated.
///
/// # Errors
/// A value that the protocol does not allow; as [`crate::run::run`].
pub fn parameters<'a>(
    compiled: &Compiled,
    campaigns: impl Into<Campaigns<'a>>,
    overrides: &Overrides,
    settings: &Settings,
    vary: &[Vary],
    progress: Progress<'_>,
) -> Result<Study, Problems> {
    let campaigns = campaigns.into();
    // All values are compiled before any is evaluated, so that an invalid one is reported at once.
    let mut compiled_values = Vec::new();
    let mut problems = Problems::default();
    for varied in vary {
        if let Some(found) = Variable::find(compiled, &varied.name, &mut problems) {
            let each = varied
                .values
                .iter()
                .map(|value| found.with(&compiled.family, overrides, value, &mut problems));
            let values: Vec<Option<Compiled>> = each.collect();
            compiled_values.push((varied, found, values));
        }
    }
    if problems.any_error() {
        return Err(problems);
    }
    let quiet = |_: &str| {};
    let evaluated = unshifted(compiled, campaigns, &quiet)?;
    progress("baseline");
    let base = at_value(&evaluated, compiled, settings, "baseline", true);
    let mut parameters = Vec::new();
    for (varied, variable, values) in compiled_values {
        let as_it_is = variable.as_it_is();
        let mut found = Vec::new();
        for (value, other) in varied.values.iter().zip(values.into_iter().flatten()) {
            let shown = variable.shown(value, &other.plan);
            progress(&format!("{} {shown}", varied.name));
            if shown == as_it_is {
                found.push(AtValue { value: shown, ..base.clone() });
                continue;
            }
            let evaluated = unshifted(&other, campaigns, &quiet)?;
            found.push(at_value(&evaluated, &other, settings, &shown, false));
        }
        parameters.push(Varied {
            name: varied.name.clone(),
            title: variable.title(),
            base: as_it_is,
            decides: found.iter().any(|at| at.verdict != base.verdict),
            values: found,
        });
    }
    Ok(joined(
        compiled,
        campaigns,
        &evaluated,
        StudyResult::Parameters(ParameterStudy { base, parameters }),
    ))
}

/// A parameter, a rule or a group of limits.
enum Variable<'a> {
    Parameter(&'a Parameter),
    Rule(Rule),
    Scale(Scale),
}

impl<'a> Variable<'a> {
    /// A name without spaces is a parameter; several words address a rule, `every limit` and a
    /// statistic several rules.
    fn find(compiled: &'a Compiled, name: &str, problems: &mut Problems) -> Option<Self> {
        if Scale::asked(name) {
            return Scale::find(&compiled.family.merged, name)
                .map(Self::Scale)
                .map_err(|problem| problems.push(problem))
                .ok();
        }
        if name.contains(char::is_whitespace) {
            return Rule::find(&compiled.family.merged, name)
                .map(Self::Rule)
                .map_err(|problem| problems.push(problem))
                .ok();
        }
        let parameters = &compiled.plan.parameters;
        if let Some(parameter) = parameters.iter().find(|parameter| parameter.name == name) {
            return Some(Self::Parameter(parameter));
        }
        let known = parameters.iter().map(|parameter| parameter.name.as_str());
        let says = format!("protocol `{}` has no parameter `{name}`", compiled.plan.name);
        problems.push(Problem::error("unknown-parameter", says).suggest(name, known));
        None
    }

    /// The protocol with another value.
    fn with(
        &self,
        family: &Family,
        overrides: &Overrides,
        value: &str,
        problems: &mut Problems,
    ) -> Option<Compiled> {
        match self {
            Self::Parameter(parameter) => {
                with(family.clone(), overrides, &parameter.name, value, problems)
            }
            Self::Rule(rule) => compile(rule.with(family, value), overrides, problems),
            Self::Scale(scale) => {
                compile(scale.with(family, value, problems)?, overrides, problems)
            }
        }
    }

    fn as_it_is(&self) -> String {
        match self {
            Self::Parameter(parameter) => parameter.value.clone(),
            Self::Rule(rule) => rule.as_it_is.clone(),
            Self::Scale(_) => "1".to_owned(),
        }
    }

    fn title(&self) -> String {
        match self {
            Self::Parameter(parameter) => parameter.title.clone(),
            Self::Rule(rule) => rule.title.clone(),
            Self::Scale(scale) => scale.title(),
        }
    }

    /// A value in the protocol's notation.
    fn shown(&self, value: &str, plan: &Plan) -> String {
        match self {
            Self::Parameter(parameter) => {
                let set = plan.parameters.iter().find(|other| other.name == parameter.name);
                set.map_or_else(|| value.to_owned(), |set| set.value.clone())
            }
            Self::Scale(_) => value
                .trim()
                .parse::<f64>()
                .map_or_else(|_| value.to_owned(), |factor| factor.to_string()),
            Self::Rule(_) => value.split_whitespace().collect::<Vec<_>>().join(" "),
        }
    }
}

/// The protocol with another value of a parameter.
pub fn with(
    family: Family,
    overrides: &Overrides,
    name: &str,
    value: &str,
    problems: &mut Problems,
) -> Option<Compiled> {
    let mut overrides = overrides.clone();
    let source = Source::new("--vary", format!("{name}={value}"));
    let span = source.span(name.len() + 1..source.text.len());
    let text = Text { text: value.to_owned(), span, exact: true };
    overrides.insert(name.to_owned(), Override { text, set_by: SetBy::CommandLine });
    compile(family, &overrides, problems)
}

fn at_value(
    evaluated: &Evaluated,
    compiled: &Compiled,
    settings: &Settings,
    value: &str,
    is_base: bool,
) -> AtValue {
    let judged = evaluated.judge(&compiled.plan);
    let statistics: Vec<Selected> = judged
        .quantities
        .iter()
        .flat_map(|quantity| {
            quantity.statistics.iter().map(|statistic| Selected {
                id: quantity.id.clone(),
                symbol: quantity.symbol.clone(),
                name: statistic.name.clone(),
                scope: statistic.scope.clone(),
                normalised: statistic.normalised,
                holds: statistic.holds == Some(true),
            })
        })
        .collect();
    let largest = statistics
        .iter()
        .filter_map(|statistic| {
            statistic.normalised.map(|normalised| {
                (format!("{} of {}", statistic.name, statistic.symbol), normalised)
            })
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(statistic, normalised)| Largest { statistic, normalised });
    let study = case_of(evaluated, &compiled.plan, settings)
        .map(|(case, _)| marked(&case, &settings.selections).0.counted);
    let share = study.as_ref().ok().map(|study| &study.share);
    AtValue {
        value: value.to_owned(),
        is_base,
        verdict: judged.verdict,
        reasons: judged.reasons,
        statistics,
        largest,
        combinations: study.as_ref().map_or(0.0, |study| study.combinations),
        share: share.map(|share| share.share),
        exact: share.map(|share| share.exact),
        interval: share.and_then(|share| share.interval),
        reason: study.err(),
    }
}
