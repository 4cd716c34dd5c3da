//! The processing graph: acyclic by construction, common parts once, and drawn so that any text
//! stays text.

// Each test file uses a part of what they share.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use crate::common::xml;
use fishplate::check::{self, Overrides, family};
use fishplate::graph::{self, Graph, Operation, Stage, from_plan};
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::source::Source;

fn compiled(source: &std::sync::Arc<Source>) -> Graph {
    let mut problems = Problems::default();
    let family = family::read(source, &library::parent, &mut problems);
    let plan = check::check(&family, &Overrides::new(), &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)));
    from_plan(&plan)
}

fn shipped() -> Vec<(&'static str, Graph)> {
    library::SHIPPED
        .iter()
        .map(|shipped| {
            (shipped.name, compiled(&library::shipped(shipped.name).expect("a shipped protocol")))
        })
        .collect()
}

fn small() -> Graph {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/cases/graph/small.fp");
    compiled(&Source::new("small.fp", fs::read_to_string(path).expect("a readable case")))
}

fn all() -> Vec<(&'static str, Graph)> {
    shipped().into_iter().chain([("small", small())]).collect()
}

#[test]
fn inputs_come_before_nodes_and_stages_never_go_back() {
    for (name, graph) in all() {
        for (id, node) in graph.nodes.iter().enumerate() {
            for &input in &node.inputs {
                assert!(input < id, "{name}: n{input} is not before n{id}");
                // Deriving and filtering may alternate; what follows them does not.
                let (from, to) = (graph.nodes[input].operation.stage(), node.operation.stage());
                assert!(
                    from <= to || (from <= Stage::Filter && to <= Stage::Filter),
                    "{name}: {from:?} before {to:?}"
                );
            }
            assert!(
                node.from.line() >= 1 && !node.from.source.text.is_empty(),
                "{name}: n{id} comes from nowhere"
            );
        }
    }
}

#[test]
fn every_node_is_used() {
    for (name, graph) in all() {
        let mut used: BTreeSet<usize> =
            graph.nodes.iter().flat_map(|node| node.inputs.iter().copied()).collect();
        used.extend(graph.verdicts.iter().copied());
        // Checks on sections end by themselves; so does a signal before its cut where a metric cuts
        // for itself.
        used.extend(graph.checks.iter().flatten().map(|input| input.node));
        let find = &graph.find;
        used.extend(
            find.data
                .iter()
                .chain(&find.conditions)
                .flatten()
                .chain(&find.prefer)
                .map(|input| input.node),
        );
        let positions = || graph.plausibility.iter().flat_map(|rule| &rule.positions);
        used.extend(positions().flat_map(|position| {
            position.own.into_iter().chain(position.inputs.iter().map(|input| input.node))
        }));
        used.extend(
            graph
                .quantities
                .iter()
                .flat_map(|quantity| quantity.signals.iter().map(|signal| signal.filtered)),
        );
        // What is reported ends in its number.
        used.extend(graph.quantities.iter().flat_map(|quantity| &quantity.reports));
        // A quantity without limits ends in its values.
        let reported = graph.quantities.iter().filter(|quantity| quantity.limits.is_empty());
        used.extend(
            reported.flat_map(|quantity| quantity.signals.iter().map(|signal| signal.compare)),
        );
        let idle: Vec<&str> = (0..graph.nodes.len())
            .filter(|id| !used.contains(id))
            .map(|id| graph.nodes[id].label.text.as_str())
            .collect();
        assert!(idle.is_empty(), "{name}: {idle:?}");
    }
}

#[test]
fn common_parts_stand_once() {
    for (name, graph) in all() {
        let mut seen = BTreeSet::new();
        for node in &graph.nodes {
            let what = match &node.operation {
                // Their expressions hold places; that there is one for each quantity and signal is
                // their meaning. So do verdicts: a person may judge several.
                Operation::Value(_)
                | Operation::Compare(_)
                | Operation::Estimate(_)
                | Operation::Report(_)
                | Operation::Limit(_)
                | Operation::Verdict(_) => {
                    continue;
                }
                Operation::Constant(expr) => format!("constant {}", check::evaluate::shape(expr)),
                Operation::Select(conditions) => format!(
                    "select {:?}",
                    conditions.iter().map(check::evaluate::shape).collect::<Vec<_>>()
                ),
                operation => format!("{operation:?}"),
            };
            assert!(
                seen.insert((what.clone(), node.inputs.clone())),
                "{name}: {what} of {:?} stands twice",
                node.inputs
            );
        }
    }
}

/// Annex T filters each channel once for all quantities: Y, Q and Y/Q of four wheels, the sum of
/// guiding forces of two wheelsets.
#[test]
fn a_filter_runs_once_for_each_channel() {
    let (_, graph) = shipped().remove(0);
    let filters = |word: &str| {
        graph
            .nodes
            .iter()
            .filter(|node| {
                matches!(node.operation, Operation::Step(_)) && node.label.text.starts_with(word)
            })
            .count()
    };
    assert_eq!(filters("low-pass"), 4 + 4 + 4 + 2);
    assert_eq!(filters("band-pass"), 2 + 2);
    let reads =
        graph.nodes.iter().filter(|node| matches!(node.operation, Operation::Read { .. })).count();
    // Y and Q of eight wheels (plausibility looks at all of them), two accelerations at two places,
    // curvature and cant of the track, distance and time.
    assert_eq!(reads, 16 + 4 + 2 + 2);
}

#[test]
fn the_small_protocol_compiles_as_expected() {
    let found = graph::text(&small());
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/cases/graph/small.out");
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        fs::write(&path, &found).expect("a writable case");
    }
    assert_eq!(fs::read_to_string(&path).expect("a case"), found);
}

#[test]
fn pictures_are_well_formed() {
    for (name, graph) in all() {
        let svg = graph::svg(&graph);
        xml::balanced(&svg, &[]);
        let tags = xml::tags(&svg);
        assert_eq!(tags[0].name, "svg");
        let (width, height) = (tags[0].number("width"), tags[0].number("height"));
        for tag in tags.iter().filter(|tag| matches!(tag.name, "rect" | "text")) {
            assert!(
                (0.0..=width).contains(&tag.get("x").map_or(0.0, |_| tag.number("x"))),
                "{name}: {tag:?}"
            );
            assert!(
                (0.0..=height).contains(&tag.get("y").map_or(0.0, |_| tag.number("y"))),
                "{name}: {tag:?}"
            );
        }
        // An ampersand begins an entity, nothing else.
        for rest in svg.split('&').skip(1) {
            assert!(
                ["amp;", "lt;", "gt;", "quot;"].iter().any(|entity| rest.starts_with(entity)),
                "{name}: &{}",
                &rest[..8.min(rest.len())]
            );
        }
    }
}

#[test]
fn text_in_a_picture_stays_text() {
    let graph = small();
    let svg = graph::svg(&graph);
    assert!(svg.contains("Y &lt;&amp;&gt; &quot;R&quot; \\"), "{svg}");
    assert!(graph::dot(&graph).contains(r#"read\nY <&> \"R\" \\""#), "{}", graph::dot(&graph));
}

#[test]
fn dot_names_every_node_and_edge() {
    for (name, graph) in all() {
        let dot = graph::dot(&graph);
        let lines: Vec<&str> = dot.lines().collect();
        assert_eq!((lines[0], lines[lines.len() - 1]), ("digraph protocol {", "}"));
        let edges: usize = graph.nodes.iter().map(|node| node.inputs.len()).sum();
        assert_eq!(lines.iter().filter(|line| line.contains(" -> ")).count(), edges, "{name}");
        assert_eq!(
            lines.iter().filter(|line| line.contains("[label=\"")).count(),
            graph.nodes.len(),
            "{name}"
        );
        for line in &lines[1..lines.len() - 1] {
            let quotes = line.replace("\\\\", "").replace("\\\"", "").matches('"').count();
            assert!(line.ends_with(';') && quotes % 2 == 0, "{name}: {line}");
        }
    }
}

#[test]
fn json_holds_the_same_graph() {
    for (name, graph) in all() {
        let json = graph::json(&graph);
        let nodes = json["nodes"].as_array().expect("nodes");
        assert_eq!(nodes.len(), graph.nodes.len(), "{name}");
        for (node, json) in graph.nodes.iter().zip(nodes) {
            assert_eq!(json["inputs"].as_array().expect("inputs").len(), node.inputs.len());
            assert!(json["from"]["line"].as_u64().is_some_and(|line| line >= 1));
        }
    }
}
