//! The protocol: identification, text, parameters, and deviations from its parent.

use serde::Serialize;

use super::FigureView;
use crate::report::number;
use crate::result::{Deviation, FilterInfo, ParameterInfo, ProtocolFile, ProtocolInfo};

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ProtocolView {
    pub name: String,
    pub title: String,
    pub edition: Option<String>,
    pub source: Option<String>,
    pub scope: Option<String>,
    pub notes: Vec<String>,
    pub sha256: String,
    pub verdict_rule: String,
    /// The protocol first, then its parent, and so on.
    pub files: Vec<SourceFile>,
    pub deviations: Vec<DeviationView>,
    pub parameters: Vec<ParameterView>,
    pub filters: Vec<FilterView>,
    pub graph_nodes: usize,
    /// `None` if there is no drawing.
    pub graph: Option<FigureView>,
}

/// A file of the protocol, line by line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SourceFile {
    pub name: String,
    pub sha256: String,
    pub lines: Vec<SourceLine>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SourceLine {
    pub number: usize,
    /// Tabs as four spaces, without trailing white space.
    pub text: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DeviationView {
    pub rule: String,
    pub before: Option<String>,
    pub after: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ParameterView {
    pub name: String,
    pub title: String,
    pub value: String,
    pub default: String,
    pub set_by: String,
    /// Differs from the default.
    pub changed: bool,
    pub unconfirmed: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FilterView {
    pub name: String,
    pub title: String,
    pub steps: String,
    pub source: Option<String>,
}

/// The protocol as printed.
pub fn view(protocol: &ProtocolInfo) -> ProtocolView {
    ProtocolView {
        name: protocol.name.clone(),
        title: protocol.title.clone(),
        edition: protocol.edition.clone(),
        source: protocol.source.clone(),
        scope: protocol.scope.clone(),
        notes: protocol.notes.iter().map(|note| number::raised(note)).collect(),
        sha256: protocol.sha256.clone(),
        verdict_rule: protocol.verdict_rule.clone(),
        files: protocol.files.iter().map(source_file).collect(),
        deviations: protocol.deviations.iter().map(deviation).collect(),
        parameters: protocol.parameters.iter().map(parameter).collect(),
        filters: protocol.filters.iter().map(|one| filter(one, protocol.source.as_deref())).collect(),
        graph_nodes: protocol.graph_nodes,
        graph: (!protocol.graph_svg.trim().is_empty()).then(|| FigureView {
            name: "graph".into(),
            caption: format!("Processing graph, {} operations; those of plausibility rules alone are not drawn", protocol.graph_nodes),
            alt: format!("Processing graph of the protocol with {} operations, from the channels to the statistics.", protocol.graph_nodes),
        }),
    }
}

fn source_file(file: &ProtocolFile) -> SourceFile {
    let lines = file.text.lines().enumerate();
    SourceFile {
        name: file.name.clone(),
        sha256: file.sha256.clone(),
        lines: lines
            .map(|(at, text)| SourceLine {
                number: at + 1,
                text: text.replace('\t', "    ").trim_end().to_owned(),
            })
            .collect(),
    }
}

fn deviation(deviation: &Deviation) -> DeviationView {
    DeviationView {
        rule: deviation.rule.clone(),
        before: deviation.before.clone(),
        after: deviation.after.clone(),
    }
}

fn parameter(parameter: &ParameterInfo) -> ParameterView {
    ParameterView {
        name: parameter.name.clone(),
        title: parameter.title.clone(),
        value: parameter.value.clone(),
        default: parameter.default.clone(),
        set_by: parameter.set_by.clone(),
        changed: parameter.value != parameter.default,
        unconfirmed: parameter.unconfirmed.clone(),
    }
}

fn filter(filter: &FilterInfo, work: Option<&str>) -> FilterView {
    FilterView {
        name: filter.name.clone(),
        title: filter.title.clone(),
        steps: filter.steps.clone(),
        source: filter.source.as_deref().map(|source| super::with_work(source, work)),
    }
}
