//! `explain`: a protocol at any stage of its processing, or the functions of the language.

use std::fmt::Write;

use serde_json::{Value, json};

use super::kit::*;
use crate::catalog::entries;
use crate::check::{
    self, Overrides,
    plan::{Clause, Plan, Report},
};
use crate::graph;
use crate::run::needs;
use crate::syntax::document::Document;
use crate::units::SYMBOLS;

#[derive(Debug, Args)]
pub struct Explain {
    /// Path of a protocol, or name of a shipped one; without it, the functions of the language are
    /// listed.
    #[arg(value_name = "PROTOCOL")]
    protocol: Option<String>,
    /// [default: plan]
    #[arg(long, value_enum, requires = "protocol")]
    stage: Option<Stage>,
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Output file [default: standard output]
    #[arg(long, short)]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Stage {
    /// Blocks and fields as written, merged with the extended protocols.
    Ast,
    /// The checked rules with the values of the parameters.
    Plan,
    /// The processing graph.
    Graph,
    /// The channels, section data and vehicle data that a campaign must have.
    Needs,
    /// The clauses that it names: computed by a rule, judged by a person, or not covered.
    Clauses,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Format {
    Text,
    Json,
    /// Of the needs only.
    Csv,
    /// Of the graph only.
    Dot,
    /// Of the graph only.
    Svg,
}

impl Explain {
    pub fn run(self, console: &Console) -> Done {
        if let (Some(protocol), Some(output)) = (&self.protocol, &self.output) {
            check_file(output, &[Path::new(protocol)])?;
        }
        let text = match &self.protocol {
            None if matches!(self.format, Format::Text | Format::Json) => {
                registry(self.format == Format::Json)
            }
            None => return Err(wrong("without a protocol the format is text or json")),
            Some(name) => self.stage_text(name, console)?,
        };
        match &self.output {
            Some(path) => console.write(path, text.as_bytes()),
            None if self.format == Format::Json => console.print_json(&text),
            None => console.print_text(&text),
        }
    }

    fn stage_text(&self, name: &str, console: &Console) -> Result<String, Ended> {
        let stage = self.stage.unwrap_or(Stage::Plan);
        if stage != Stage::Graph && matches!(self.format, Format::Dot | Format::Svg) {
            return Err(wrong("only the graph can be drawn: add `--stage graph`"));
        }
        if stage != Stage::Needs && self.format == Format::Csv {
            return Err(wrong("only the needs are a table: add `--stage needs`"));
        }
        let mut problems = Problems::default();
        let family = load(name, &mut problems);
        // The AST is printed as written; rules are checked for the later stages only.
        let checked = family.as_ref().filter(|_| stage != Stage::Ast);
        let plan =
            checked.and_then(|family| check::check(family, &Overrides::new(), &mut problems));
        let family = console.sound(family, &problems)?;
        if stage == Stage::Ast {
            return Ok(if self.format == Format::Json {
                pretty(&document_json(&family.merged))
            } else {
                document_text(&family.merged)
            });
        }
        let plan = plan.ok_or(Problems::default())?;
        Ok(match (stage, self.format) {
            (Stage::Graph, format) => {
                let graph = graph::from_plan(&plan);
                match format {
                    Format::Text | Format::Csv => graph::text(&graph),
                    Format::Json => pretty(&graph::json(&graph)),
                    Format::Dot => graph::dot(&graph),
                    Format::Svg => graph::svg(&graph),
                }
            }
            (Stage::Needs, format) => {
                let needs = needs::needs(&plan, &graph::from_plan(&plan));
                match format {
                    Format::Json => pretty(&super::needs::json(&plan, &needs)),
                    Format::Csv => super::needs::csv(&needs),
                    _ => super::needs::text(&plan, &needs),
                }
            }
            (Stage::Clauses, Format::Json) => pretty(&clauses_json(&plan)),
            (Stage::Clauses, _) => clauses_text(&plan),
            (_, Format::Json) => pretty(&plan_json(&plan)),
            _ => plan_text(&plan),
        })
    }
}

fn wrong(says: &str) -> Ended {
    Problem::error("format", says).into()
}

fn pretty(value: &Value) -> String {
    serde_json::to_string_pretty(value).unwrap_or_default() + "\n"
}

fn document_text(document: &Document) -> String {
    let mut out = String::new();
    for block in &document.blocks {
        let title =
            block.title.as_ref().map_or(String::new(), |title| format!(" \"{}\"", title.text));
        let _ =
            writeln!(out, "{} {}{title}  ({})", block.kind.text, block.name_text(), block.span());
        for field in &block.fields {
            let _ = writeln!(
                out,
                "  {}: {}  ({})",
                field.key.text,
                check::normalised(&field.value.text),
                field.value.span
            );
        }
    }
    out
}

fn document_json(document: &Document) -> Value {
    let blocks: Vec<Value> = document
        .blocks
        .iter()
        .map(|block| {
            let fields: Vec<Value> =
                block.fields.iter().map(|field| json!({"key": field.key.text, "value": check::normalised(&field.value.text), "at": field.value.span.to_string()})).collect();
            json!({"kind": block.kind.text, "name": block.name_text(), "title": block.title.as_ref().map(|title| title.text.as_str()), "at": block.span().to_string(), "fields": fields})
        })
        .collect();
    json!({ "blocks": blocks })
}

fn plan_text(plan: &Plan) -> String {
    let mut out =
        format!("{}: {}\naxis {} [{}]\n", plan.name, plan.title, plan.axis.column, plan.axis.unit);
    for parameter in &plan.parameters {
        let _ = writeln!(out, "parameter {} = {}", parameter.name, parameter.value);
    }
    for record in &plan.records {
        let members: Vec<&str> =
            record.members.iter().map(|member| member.value.as_str()).collect();
        let members = if members.is_empty() { "all".to_string() } else { members.join(", ") };
        let _ = writeln!(out, "record {}: {}, {members}", record.name, record.side.in_words());
    }
    for zone in &plan.zones {
        let _ = writeln!(
            out,
            "zone {}: {}; at least {} sections",
            zone.name, zone.condition_words, zone.minimum_sections
        );
    }
    // A report or limit `for each zone` is written once.
    let mut written: Vec<&crate::source::Span> = Vec::new();
    for report in &plan.sections.reports {
        if !written.contains(&&report.span) {
            written.push(&report.span);
            let _ = writeln!(out, "sections report {}", report.words);
        }
    }
    for check in &plan.checks {
        let _ = writeln!(out, "check {}: {}", check.name, check.words);
    }
    for quantity in &plan.quantities {
        let names: Vec<&str> =
            quantity.positions.iter().map(|position| position.name.as_str()).collect();
        let _ = writeln!(out, "quantity {} [{}]: {}", quantity.id, quantity.unit, quantity.title);
        let _ = writeln!(
            out,
            "  of          {}\n  filter      {}\n  value       {}\n  comparison  {}",
            names.join(", "),
            quantity.words.filter,
            quantity.words.processing,
            quantity.words.comparison
        );
        for limit in &quantity.limits {
            if !written.contains(&&limit.span) {
                written.push(&limit.span);
                let _ = writeln!(out, "  limit       {} {}", limit.estimate.title, limit.words);
            }
        }
        for report in &quantity.reports {
            if !written.contains(&&report.span) {
                written.push(&report.span);
                let _ = writeln!(out, "  report      {}", report.words);
            }
        }
    }
    for verdict in &plan.verdicts {
        let _ = match &verdict.name {
            None => writeln!(out, "{}", verdict.criterion),
            Some(name) => {
                let overall =
                    if verdict.name == plan.overall().name { " (the overall verdict)" } else { "" };
                let [good, bad] = &verdict.words;
                writeln!(
                    out,
                    "verdict {name}{overall}: {}\n  rule        {}\n  words       {good}, {bad}",
                    verdict.title, verdict.criterion
                )
            }
        };
    }
    out
}

fn plan_json(plan: &Plan) -> Value {
    let quantities: Vec<Value> = plan
        .quantities
        .iter()
        .map(|quantity| {
            let limits: Vec<Value> =
                quantity.limits.iter().map(|limit| json!({"statistic": limit.estimate.name, "limit": limit.words})).collect();
            let mut one = json!({
                "id": quantity.id, "title": quantity.title, "unit": quantity.unit.text,
                "signals": quantity.positions.iter().map(|position| position.name.as_str()).collect::<Vec<_>>(),
                "filter": quantity.words.filter, "value": quantity.words.processing, "comparison": quantity.words.comparison,
                "limits": limits, "minimum_signals": quantity.minimum_signals, "minimum_pairs": quantity.minimum_pairs,
            });
            with_reports(&mut one, quantity.reports.iter().map(AsRef::as_ref));
            one
        })
        .collect();
    let zones: Vec<Value> = plan
        .zones
        .iter()
        .map(|zone| json!({"zone": zone.name, "title": zone.title, "where": zone.condition_words, "minimum_sections": zone.minimum_sections}))
        .collect();
    let parameters: Vec<Value> = plan
        .parameters
        .iter()
        .map(|parameter| json!({"name": parameter.name, "value": parameter.value}))
        .collect();
    let mut json = json!({"name": plan.name, "title": plan.title, "parameters": parameters, "zones": zones, "quantities": quantities, "verdict": plan.overall().criterion});
    let verdicts: Vec<Value> = plan
        .verdicts
        .iter()
        .filter_map(|verdict| {
            Some(json!({"name": verdict.name.as_ref()?, "title": verdict.title, "rule": verdict.criterion, "words": verdict.words}))
        })
        .collect();
    with_reports(&mut json, plan.sections.reports.iter());
    if !verdicts.is_empty() {
        json["verdicts"] = json!(verdicts);
    }
    json
}

/// Each clause with what it asks for and what stands for it; then what the protocol leaves out.
fn clauses_text(plan: &Plan) -> String {
    let mut out = format!("{}: {}\n", plan.name, plan.title);
    for clause in &plan.clauses {
        let _ = writeln!(out, "\n{}: {}", clause.clause, clause.standing().in_words());
        for says in &clause.says {
            let _ = writeln!(out, "  {says}");
        }
        if !clause.rules.is_empty() {
            let _ = writeln!(out, "  by  {}", clause.rules.join(", "));
        }
        if let Some(person) = &clause.judged_by {
            let _ = writeln!(out, "  judged by  {person}");
        }
    }
    if plan.clauses.is_empty() {
        out += "\nno rule names a clause: add the field `clause` to rules\n";
    }
    for left in &plan.leaves_out {
        let _ = writeln!(out, "\nleft out: {left}");
    }
    let without: Vec<&str> = without_clause(plan).collect();
    if !without.is_empty() {
        let _ = writeln!(out, "\nlimits without a clause: {}", without.join(", "));
    }
    out
}

fn clauses_json(plan: &Plan) -> Value {
    let one = |clause: &Clause| json!({"clause": clause.clause, "says": clause.says, "standing": clause.standing().in_words(), "rules": clause.rules, "judged_by": clause.judged_by});
    let clauses: Vec<Value> = plan.clauses.iter().map(one).collect();
    let without: Vec<&str> = without_clause(plan).collect();
    json!({"protocol": plan.name, "clauses": clauses, "leaves_out": plan.leaves_out, "limits_without_clause": without})
}

/// Quantities with limits that name no clause.
fn without_clause(plan: &Plan) -> impl Iterator<Item = &str> {
    let limited = plan.quantities.iter().filter(|one| !one.limits.is_empty());
    limited.filter(|one| one.clause.is_none()).map(|one| one.id.as_str())
}

/// Estimates without a limit, each as written; no key where there are none.
fn with_reports<'a>(of: &mut Value, reports: impl Iterator<Item = &'a Report>) {
    let mut words: Vec<&str> = reports.map(|report| report.words.as_str()).collect();
    words.dedup();
    if !words.is_empty() {
        of["reports"] = json!(words);
    }
}

fn registry(as_json: bool) -> String {
    let entries = entries();
    if as_json {
        let list: Vec<Value> = entries
            .iter()
            .map(|entry| json!({"kind": entry.kind, "wording": entry.wording, "signature": entry.signature, "about": entry.in_words()}))
            .collect();
        let units: Vec<Value> =
            SYMBOLS.iter().map(|unit| json!({"symbol": unit.symbol, "name": unit.name, "dimension": unit.dimension.to_string()})).collect();
        return pretty(&json!({"registry": list, "units": units}));
    }
    let mut out = String::new();
    let mut last = "";
    for entry in &entries {
        if entry.kind != last {
            let _ = writeln!(out, "{}{}s", if last.is_empty() { "" } else { "\n" }, entry.kind);
            last = entry.kind;
        }
        let _ =
            writeln!(out, "  {}\n      {}. {}", entry.wording, entry.signature, entry.in_words());
    }
    let symbols: Vec<&str> = SYMBOLS.iter().map(|unit| unit.symbol).collect();
    let _ = writeln!(out, "\nunits\n  {}", symbols.join("  "));
    out
}
