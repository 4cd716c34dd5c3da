//! Reads a catalogue of effects from YAML, and reports every fault with its place.

use std::sync::Arc;

use super::{
    catalogue::{Action, Acts, Catalogue, Effect, Fit, Group, Parameter},
    operators::Operator,
};
use crate::problem::{Problem, Problems, problem};
use crate::source::{Source, Span, Spanned};
use crate::units::Unit;
use crate::yaml::{self, Entries, FromNode, Key, Node, OneOrMore, Value, fields};

/// Placeholder for a channel in the name of a parameter.
pub const CHANNEL: &str = "<channel>";
/// Most catalogues that extend one another.
const DEEPEST: usize = 8;

/// Finds the text of an extended catalogue.
pub type Find<'a> = &'a dyn Fn(&str, &Source) -> Result<Arc<Source>, Problem>;

/// The parameters of the built-in model: names with units.
pub type ModelParameters<'a> = [(&'a str, &'a str)];

/// Names that the effects of a catalogue may use.
pub(super) struct Known<'a> {
    model: &'a ModelParameters<'a>,
    groups: Vec<Group>,
    pub units: Vec<(String, Unit)>,
}

pub(super) type Reader<'a, 'k> = yaml::Reader<'a, Known<'k>>;

fields! {
    /// A catalogue as it is written.
    struct Written: "a catalogue" {
        "catalogue" name: Option<String> => "its name",
        "title" title: Option<String>,
        "extends" extends: Option<Spanned<String>>,
        "groups" groups: Entries<OneOrMore<String>>,
        "units" units: Entries<Spanned<Unit>>,
        "effects" effects: Entries<Node>,
        "diagnosis" diagnosis: Option<Node>,
    }
}

fields! {
    /// An effect as it is written.
    pub(super) struct WrittenEffect in Known<'_>: "an effect" {
        "title" title: Option<String>,
        "means" means: Option<String>,
        "acts on" acts: Acts,
        "parameters" parameters: Entries<Parameter>,
        "operator" operator: Option<Operator>,
        "signals" signals: Option<Node>,
        "channels" channels: Option<Channels>,
        "together" together: Vec<Channels>,
        "each" each: Option<Channels>,
        "fit" fit: Option<Vec<Spanned<OneOrMore<String>>>>,
        "candidate" candidate: bool = true,
        "confinable" confinable: Option<bool>,
        "settled by" settled_by: Option<String>,
        "tolerance" tolerance: Option<String>,
    }
}

fields! {
    /// A parameter as it is written.
    struct WrittenParameter: "a parameter" {
        "unit" unit: Unit,
        /// None if the vehicle file has it.
        "neutral" neutral (neutral): Option<f64>,
        "default" default: Option<f64>,
        "range" range: Vec<f64>,
        "trials" trials: Vec<f64>,
        "means" meaning: Option<String>,
        "model" model: Option<Spanned<String>>,
        "simulators" simulators: Entries<SimulatorParameter>,
        "vanishes" vanishes: Option<String>,
    }
}

fields! {
    /// A parameter of another simulator.
    struct Target: "a parameter of a simulator" {
        "parameter" parameter: String,
        "factor" factor: f64 = 1.0,
    }
}

/// Reads a catalogue. An extended catalogue is read first; effects of the same name replace its
/// effects.
///
/// `model` lists the parameters of the built-in model.
///
/// Problems: `yaml`, `unknown-key`, `key-missing`, `wrong-kind`, `unknown-unit`, `unit-mismatch`,
/// `range`, `unknown-operator`, `unknown-channel`, `unknown-parameter`, `extends-loop`; those of
/// expressions: `unit-missing`, `unknown-name`, `not-here`, `contradiction`.
pub fn read(
    source: &Arc<Source>,
    find: Find<'_>,
    model: &ModelParameters<'_>,
    problems: &mut Problems,
) -> Option<Catalogue> {
    read_below(source, find, model, problems, 0)
}

fn read_below(
    source: &Arc<Source>,
    find: Find<'_>,
    model: &ModelParameters<'_>,
    problems: &mut Problems,
    depth: usize,
) -> Option<Catalogue> {
    let before = problems.errors();
    let tree = yaml::load(source, problems)?;
    let mut reader = yaml::Reader { with: (), problems };
    let written: Written = reader.file(&tree)?;
    let base = written.extends.as_ref().and_then(|named| {
        if depth > DEEPEST {
            reader.fault("extends-loop", "catalogues extend each other in a circle", &named.span);
            return None;
        }
        let found = find(&named.value, source).map_err(|problem| problem.or_at(&named.span));
        let text = reader.keep(found)?;
        // The file may be of any kind; its lines are then not printed.
        let tree = yaml::load(&text, &mut Problems::default());
        if tree.is_none_or(|tree| tree.entry("catalogue").is_none()) {
            let (name, at) = (&named.value, &named.span);
            let problem = problem!("not-a-catalogue", at, "`{name}` is not a catalogue of effects");
            reader.tell(problem.help("`fishplate effects` with this file tells its faults"));
            return None;
        }
        read_below(&text, find, model, reader.problems, depth + 1)
    });
    let (mut groups, mut units, mut effects, diagnosis) = base
        .map(|base| (base.groups, base.units, base.effects, base.diagnosis))
        .unwrap_or_default();
    for (key, channels) in written.groups.0 {
        groups.retain(|group: &Group| group.name != key.text);
        groups.push(Group { name: key.text, channels: channels.0 });
    }
    let mut reader = yaml::Reader { with: Known { model, groups, units: Vec::new() }, problems };
    for (key, unit) in written.units.0 {
        for channel in reader.channels(vec![key.text], &key.span) {
            units.retain(|(known, _)| *known != channel);
            units.push((channel, unit.value.clone()));
        }
    }
    reader.with.units.clone_from(&units);
    for (key, node) in written.effects.0 {
        let removed = node.scalar_text() == Some("remove");
        if removed && !effects.iter().any(|effect: &Effect| effect.name == key.text) {
            let known = effects.iter().map(|effect| &effect.name);
            let problem = problem!(
                "unknown-effect",
                &key.span,
                "there is no effect `{}` to remove",
                key.text
            );
            reader.tell(problem.suggest(&key.text, known));
        }
        effects.retain(|effect| effect.name != key.text);
        if !removed {
            effects.extend(Effect::from_node(&mut reader, &key, &node));
        }
    }
    let Known { groups, .. } = reader.with;
    (problems.errors() == before).then(|| Catalogue {
        name: written.name.unwrap_or_default(),
        title: written.title.unwrap_or_default(),
        source: Arc::clone(source),
        groups,
        units,
        effects,
        diagnosis: written.diagnosis.or(diagnosis),
    })
}

/// Channels, written as groups and channels by name.
#[derive(Clone, Debug)]
pub(super) struct Channels(Vec<String>);

impl FromNode<Known<'_>> for Channels {
    fn from_node(reader: &mut Reader<'_, '_>, key: &Key, node: &Node) -> Option<Self> {
        let OneOrMore(names) = OneOrMore::from_node(reader, key, node)?;
        Some(Self(reader.channels(names, &node.span)))
    }
}

/// A neutral value; none if the vehicle file has it.
fn neutral<C>(reader: &mut yaml::Reader<'_, C>, key: &Key, node: &Node) -> Option<f64> {
    let of_vehicle = node.scalar_text() == Some("vehicle");
    if of_vehicle { None } else { f64::from_node(reader, key, node) }
}

impl FromNode<Known<'_>> for Effect {
    fn from_node(reader: &mut Reader<'_, '_>, key: &Key, node: &Node) -> Option<Self> {
        let written = WrittenEffect::from_node(reader, key, node)?;
        let parameters: Vec<Parameter> =
            written.parameters.0.iter().map(|(_, parameter)| parameter.clone()).collect();
        if parameters.is_empty() {
            // If all parameters are faulty, this is reported already.
            if node.get("parameters").is_none_or(|node| node.entries().is_empty()) {
                reader.fault(
                    "key-missing",
                    format!("the effect `{}` has no parameters", key.text),
                    &key.span,
                );
            }
            return None;
        }
        let action = match (&written.signals, written.operator) {
            (Some(signals), _) => reader.formulas(node, signals, &parameters)?,
            (None, None) => Action::Simulator,
            (None, Some(operator)) => {
                let all = || reader.with.groups.iter().flat_map(|group| group.channels.clone());
                let named = written.channels.clone().map(|Channels(named)| named);
                Action::Signals(operator, named.unwrap_or_else(|| all().collect()))
            }
        };
        Some(Self {
            name: key.text.clone(),
            fits: reader.fits(&written, &parameters, &action),
            title: written.title.unwrap_or_else(|| key.text.replace('_', " ")),
            means: written.means.unwrap_or_default(),
            acts: written.acts,
            parameters,
            candidate: written.candidate,
            confinable: written.confinable.unwrap_or(!matches!(action, Action::Signals(..))),
            action,
            settled_by: written.settled_by,
            tolerance: written.tolerance,
            span: key.span.clone(),
        })
    }
}

impl Reader<'_, '_> {
    /// The channels of groups and channels by name.
    pub fn channels(&mut self, names: Vec<String>, at: &Span) -> Vec<String> {
        let mut channels = Vec::new();
        for name in names {
            let groups = &self.with.groups;
            if let Some(group) = groups.iter().find(|group| group.name == name) {
                channels.extend(group.channels.iter().cloned());
            } else if groups.iter().any(|group| group.channels.contains(&name)) {
                channels.push(name);
            } else {
                let known = groups
                    .iter()
                    .flat_map(|group| [&group.name].into_iter().chain(&group.channels));
                let problem = problem!(
                    "unknown-channel",
                    at,
                    "`{name}` is neither a group nor a channel of a group"
                )
                .suggest(&name, known);
                self.tell(problem);
            }
        }
        channels
    }

    /// Candidates of the diagnosis. `fit` lists the parameters that are varied together; otherwise
    /// each parameter with trials is varied by itself. `each` and `together` list the channels on
    /// which operators act.
    fn fits(
        &mut self,
        effect: &WrittenEffect,
        parameters: &[Parameter],
        action: &Action,
    ) -> Vec<Fit> {
        let each = effect.each.iter().flat_map(|Channels(each)| each.iter().cloned());
        let mut lists: Vec<Vec<String>> = each.map(|channel| vec![channel]).collect();
        lists.extend(effect.together.iter().map(|Channels(together)| together.clone()));
        if lists.is_empty() {
            lists.push(match action {
                Action::Signals(_, channels) => channels.clone(),
                _ => Vec::new(),
            });
        }
        let varied = |at: &usize| !parameters[*at].trials.is_empty();
        let mut sets: Vec<Vec<usize>> = Vec::new();
        match &effect.fit {
            None => sets.extend((0..parameters.len()).filter(varied).map(|at| vec![at])),
            Some(fit) => {
                for Spanned { value: OneOrMore(names), span } in fit {
                    let number =
                        |name: &String| parameters.iter().position(|known| known.name == *name);
                    let set: Option<Vec<usize>> =
                        names.iter().map(|name| number(name).filter(varied)).collect();
                    if set.is_none() {
                        self.fault(
                            "unknown-parameter",
                            "`fit` must list parameters of this effect that have `trials`",
                            span,
                        );
                    }
                    sets.extend(set);
                }
            }
        }
        let axis = |at: usize| (at, parameters[at].trials.clone());
        sets.into_iter()
            .map(|set| Fit { axes: set.into_iter().map(axis).collect(), channels: lists.clone() })
            .collect()
    }

    /// The parameter of the model with this name, and the factor to its unit.
    fn model(&mut self, named: &Spanned<String>, unit: &Unit) -> Option<(String, f64)> {
        let Spanned { value: parameter, span } = named;
        let model = self.with.model;
        let Some((_, wanted)) = model.iter().find(|(known, _)| known == parameter) else {
            let problem =
                problem!("unknown-parameter", span, "the model has no parameter `{parameter}`");
            self.tell(problem.suggest(parameter, model.iter().map(|(known, _)| *known)));
            return None;
        };
        let wanted = Unit::parse(wanted).ok()?;
        if wanted.dimension != unit.dimension {
            let says = format!(
                "`{parameter}` of the model is in {wanted}, which is another quantity than {unit}"
            );
            self.fault("unit-mismatch", says, span);
            return None;
        }
        Some((parameter.clone(), unit.factor / wanted.factor))
    }
}

impl FromNode<Known<'_>> for Parameter {
    fn from_node(reader: &mut Reader<'_, '_>, key: &Key, node: &Node) -> Option<Self> {
        let written = WrittenParameter::from_node(reader, key, node)?;
        let name = &key.text;
        let [low, high] = written.range[..] else {
            let says = format!(
                "`range` of `{name}` must be two numbers, the smallest and the largest plausible value"
            );
            reader.fault("range", says, &node.span);
            return None;
        };
        if low > high {
            reader.fault(
                "range",
                format!("the range of `{name}` is empty: {low} to {high}"),
                node.span_of("range"),
            );
            return None;
        }
        let mut trials = written.trials;
        trials.sort_by(f64::total_cmp);
        for trial in trials.iter().filter(|trial| !(low..=high).contains(*trial)) {
            reader.fault(
                "range",
                format!("the trial {trial} is outside the range {low} to {high} of `{name}`"),
                node.span_of("trials"),
            );
        }
        let model = match &written.model {
            Some(named) => Some(reader.model(named, &written.unit)?),
            None => None,
        };
        let simulators =
            written.simulators.0.into_iter().map(
                |(simulator, SimulatorParameter(name, factor))| (simulator.text, name, factor),
            );
        Some(Self {
            name: name.clone(),
            unit: written.unit,
            neutral: written.neutral,
            default: written.default.or(written.neutral).unwrap_or(low),
            low,
            high,
            trials,
            meaning: written.meaning.unwrap_or_default(),
            vanishes_high: written.vanishes.as_deref() == Some("high"),
            model,
            simulators: simulators.collect(),
        })
    }
}

/// A parameter of another simulator, and the factor to its unit; `shoulder_viscous` alone is one.
#[derive(Clone, Debug)]
struct SimulatorParameter(String, f64);

impl<C> FromNode<C> for SimulatorParameter {
    fn from_node(reader: &mut yaml::Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        if !matches!(node.value, Value::Map(_)) {
            return String::from_node(reader, key, node).map(|name| Self(name, 1.0));
        }
        let Target { parameter, factor } = Target::from_node(reader, key, node)?;
        Some(Self(parameter, factor))
    }
}
