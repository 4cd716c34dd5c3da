//! What the checker refuses and how it is said, in both forms; what it accepts, and that it means
//! what was written.
//!
//! Expected output lies beside each case as `<case>.out`; `UPDATE_EXPECT=1 cargo test` rewrites it.
//! Every bad case is tried in YAML too, converted by the printer: the same faults must be found, at
//! places in the YAML (`<case>.yaml.out`).

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fishplate::check::diff::diff;
use fishplate::check::family::{self, Family};
use fishplate::check::plan::{Plan, SetBy};
use fishplate::check::{self, Override, Overrides};
use fishplate::graph;
use fishplate::library;
use fishplate::problem::{Problem, Problems, Severity};
use fishplate::result::confirmation::Signed;
use fishplate::result::{Confirmation, Direction, StatedValue};
use fishplate::source::Source;
use fishplate::syntax::document::Text;
use fishplate::syntax::{self, print_text, print_yaml};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Protocol files of a folder, in order of their names.
fn files(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join(folder)).expect("a folder of cases");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "fp"));
    files.sort();
    files
}

fn name(path: &Path) -> String {
    path.file_name().expect("a file").to_string_lossy().into_owned()
}

/// The text of a case under its bare name, so that messages do not hold folders of a machine.
fn source(path: &Path) -> Arc<Source> {
    Source::new(name(path), fs::read_to_string(path).expect("a readable case"))
}

/// A case as `fishplate fmt` writes it, since a graph shows the words of rules.
fn spelled(path: &Path) -> Arc<Source> {
    Source::new(name(path), print_text(&syntax::read(&source(path), &mut Problems::default())))
}

/// Shipped protocols, cases beside a case, and an endless line of ancestors.
fn find(name: &str, from: &Source) -> Result<Arc<Source>, Problem> {
    if let Some(number) =
        name.strip_prefix("ancestor-").and_then(|number| number.parse::<usize>().ok())
    {
        return Ok(Source::new(
            name,
            format!("protocol {name} \"An ancestor\"\n  extends  ancestor-{}\n", number + 1),
        ));
    }
    for folder in ["bad", "good"] {
        let path = root().join("tests/cases/check").join(folder).join(name);
        if path.is_file() {
            return Ok(source(&path));
        }
    }
    library::parent(name, from)
}

fn checked_with(source: &Arc<Source>, overrides: &Overrides) -> (Family, Option<Plan>, Problems) {
    let mut problems = Problems::default();
    let family = family::read(source, &find, &mut problems);
    let plan = check::check(&family, overrides, &mut problems);
    (family, plan, problems)
}

fn checked(source: &Arc<Source>) -> (Family, Option<Plan>, Problems) {
    checked_with(source, &Overrides::new())
}

fn codes(problems: &Problems) -> Vec<&'static str> {
    let mut codes: Vec<&str> = problems.0.iter().map(|problem| problem.code).collect();
    codes.sort_unstable();
    codes
}

#[track_caller]
fn compare_or_update(case: &Path, found: &str) {
    let mut out = case.as_os_str().to_owned();
    out.push(".out");
    let out = PathBuf::from(out);
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        fs::write(&out, found).expect("a writable case");
    } else {
        let expected = fs::read_to_string(&out).unwrap_or_default();
        assert!(expected == found, "{} differs from what is found:\n{found}", out.display());
    }
}

#[test]
fn bad_protocols_are_refused_in_words() {
    for path in files("tests/cases/check/bad") {
        let (_, plan, problems) = checked(&source(&path));
        assert!(plan.is_none() && problems.any_error(), "{} is taken for good", path.display());
        compare_or_update(&path, &problems.render(false));
    }
}

/// The same fault in YAML: the same codes, each pointing at a place in the YAML.
#[test]
fn both_forms_name_a_fault_alike() {
    let mut tried = 0;
    for path in files("tests/cases/check/bad") {
        let text = source(&path);
        let mut syntax_problems = Problems::default();
        let document = syntax::read(&text, &mut syntax_problems);
        assert!(!syntax_problems.any_error(), "{}", syntax_problems.render(false));
        if text.text.contains("extends  \"") {
            continue;
        }
        let yaml = Source::new(name(&path).replace(".fp", ".yaml"), print_yaml(&document));
        let (_, _, problems) = checked(&text);
        let (_, plan, of_yaml) = checked(&yaml);
        assert!(plan.is_none());
        assert_eq!(codes(&of_yaml), codes(&problems), "{}", path.display());
        for problem in &of_yaml.0 {
            let at = problem.at.as_ref().expect("a place");
            assert!(
                !at.source.name.ends_with(".fp") || at.source.name.starts_with("protocols/"),
                "{at} of {}",
                problem.code
            );
        }
        compare_or_update(&path.with_extension("yaml"), &of_yaml.render(false));
        tried += 1;
    }
    assert!(tried >= 12, "{tried}");
}

/// Every code that the checker can give is given by some case.
#[test]
fn every_fault_has_a_case() {
    let mut given: BTreeSet<String> = BTreeSet::new();
    for path in files("tests/cases/check/bad") {
        given.extend(checked(&source(&path)).2.0.iter().map(|problem| problem.code.to_string()));
    }
    // Faults of the program, which nothing written can bring about, and what needs a campaign or
    // command line (tested below).
    given.extend(["internal", "not-constant", "unknown-parameter"].map(String::from));
    let mut missing = BTreeSet::new();
    let folders = ["src/check", "src/check/plan"]
        .map(|folder| fs::read_dir(root().join(folder)).expect("sources"));
    let sources = folders
        .into_iter()
        .flatten()
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_file());
    for path in sources {
        let text = fs::read_to_string(path).expect("a source");
        for part in text.split("Problem::error(").chain(text.split("Problem::warning(")).skip(1) {
            let code =
                part.trim_start().split('"').nth(1).filter(|_| part.trim_start().starts_with('"'));
            missing.extend(code.map(String::from).filter(|code| !given.contains(code)));
        }
    }
    assert!(missing.is_empty(), "no case for {missing:?}");
}

#[test]
fn ten_faults_are_reported_in_one_go() {
    let (_, _, problems) = checked(&source(&root().join("tests/cases/check/bad/ten_faults.fp")));
    assert_eq!(problems.errors(), 11, "{}", problems.render(false));
}

/// No message says "you", ends in a full stop, or shows how a thing is called inside the program.
#[test]
fn messages_state_facts() {
    for path in files("tests/cases/check/bad") {
        for problem in checked(&source(&path)).2.0 {
            for text in [Some(&problem.says), problem.help.as_ref(), problem.label.as_ref()]
                .into_iter()
                .flatten()
            {
                let lower = text.to_lowercase().replace("did you mean", "");
                assert!(
                    !lower
                        .split(|c: char| !c.is_alphabetic())
                        .any(|word| word == "you" || word == "your"),
                    "{text}"
                );
                assert!(!text.ends_with('.') || text.ends_with("..."), "{text}");
                assert!(
                    !text.contains("Some(")
                        && !text.contains("Dimension")
                        && !text.contains("None"),
                    "{text}"
                );
            }
        }
    }
}

fn set(name: &str, value: &str) -> Overrides {
    let campaign = Source::new("campaign.yaml", format!("parameters:\n  {name}: {value}\n"));
    let start = campaign.text.rfind(value).expect("the value");
    let span = campaign.span(start..start + value.len());
    Overrides::from_iter([(
        name.to_string(),
        Override { text: Text { text: value.into(), span, exact: true }, set_by: SetBy::Campaign },
    )])
}

#[test]
fn parameters_of_a_campaign_are_checked_where_they_stand() {
    let protocol = library::shipped("en14363-2016-annex-t").expect("a shipped protocol");
    for (name, value, code, says) in [
        (
            "lowpass_frequency",
            "20 m",
            "unit-mismatch",
            "parameter `lowpass_frequency` is a frequency, the given value is a length",
        ),
        (
            "lowpass_frequency",
            "25",
            "unit-mismatch",
            "parameter `lowpass_frequency` is a frequency, the given value is a plain number",
        ),
        (
            "lowpass_frequency",
            "90 Hz",
            "out-of-range",
            "`90 Hz` is outside the range of `lowpass_frequency`",
        ),
        ("lowpass_frequency", "20 Herz", "unknown-unit", "`Herz` is not a known unit"),
        (
            "lowpas_frequency",
            "20 Hz",
            "unknown-parameter",
            "protocol `en14363-2016-annex-t` has no parameter `lowpas_frequency`",
        ),
        (
            "filter_phase",
            "zerophase",
            "unknown-choice",
            "`zerophase` is not one of the choices of `filter_phase`",
        ),
        ("lowpass_order", "4 +", "syntax", "an expression ends too early"),
    ] {
        let (_, plan, problems) = checked_with(&protocol, &set(name, value));
        assert!(plan.is_none());
        let [problem] = problems.0.as_slice() else { panic!("{}", problems.render(false)) };
        assert_eq!((problem.code, problem.says.as_str()), (code, says));
        let at = problem.at.as_ref().expect("a place");
        assert_eq!((at.source.name.as_str(), at.line()), ("campaign.yaml", 2));
    }
    let (_, plan, problems) = checked_with(&protocol, &set("lowpass_frequency", "0.025 kHz"));
    assert!(problems.0.is_empty(), "{}", problems.render(false));
    let plan = plan.expect("a plan");
    assert!(
        plan.filters[0].steps[0].words.starts_with("low-pass 25 Hz"),
        "{}",
        plan.filters[0].steps[0].words
    );
}

// ---- good protocols

#[test]
fn good_protocols_are_accepted_as_meant() {
    for path in files("tests/cases/check/good") {
        let (_, plan, problems) = checked(&source(&path));
        assert!(!problems.any_error(), "{}", problems.render(false));
        let plan = plan.expect("a plan");
        compare_or_update(&path, &(problems.render(false) + &described(&plan)));
    }
}

/// What was understood, in a form that shows a change of meaning.
fn described(plan: &Plan) -> String {
    let mut out =
        format!("{}: {} zones, {}\n", plan.name, plan.zones.len(), plan.overall().criterion);
    for verdict in plan.verdicts.iter().filter(|verdict| verdict.name.is_some()) {
        out += &format!(
            "verdict {}: {:?}, {} | {}\n",
            verdict.title,
            verdict.decision,
            verdict.criterion,
            verdict.words.join(" | ")
        );
    }
    for quantity in &plan.quantities {
        let signals: Vec<&str> =
            quantity.positions.iter().map(|position| position.name.as_str()).collect();
        out += &format!("quantity {} [{}] of {}\n", quantity.id, quantity.unit, signals.join(", "));
        out += &format!(
            "  {} | {} | {}\n",
            quantity.words.filter, quantity.words.processing, quantity.words.comparison
        );
        for limit in &quantity.limits {
            let bound = check::evaluate::shape(&limit.bound.expr);
            let least = match limit.direction {
                Direction::Magnitude => "",
                Direction::AtMost => " at most",
                Direction::AtLeast => " at least",
            };
            let zones = limit.scope.zones.join(", ");
            let zones = if zones.is_empty() { zones } else { format!(" for {zones}") };
            let each: String =
                limit.scope.each.iter().map(|key| format!(" each {key:?}")).collect();
            let condition = limit
                .scope
                .condition
                .as_ref()
                .map_or(String::new(), |(_, words)| format!(" where {words}"));
            out += &format!("  {}{least} {bound}{zones}{each}{condition}\n", limit.estimate.name);
        }
    }
    out
}

#[test]
fn shipped_protocols_are_without_remarks_and_canonical() {
    for shipped in library::SHIPPED {
        let source = library::shipped(shipped.name).expect("a shipped protocol");
        let (_, plan, problems) = checked(&source);
        assert!(plan.is_some() && problems.0.is_empty(), "{}", problems.render(false));
    }
    for path in files("protocols") {
        let text = fs::read_to_string(&path).expect("a readable protocol");
        let document = syntax::read(&source(&path), &mut Problems::default());
        assert!(
            print_text(&document) == text,
            "{} is not as `fishplate fmt` writes it",
            path.display()
        );
    }
}

/// What no rule uses is told in the text that has it: not in its parent, and not in a text without
/// quantities.
#[test]
fn unused_parts_are_told() {
    let quantity = "quantity q\n  of          ay\n  value       rms\n  difference  signed\n  limit       std allowed\n";
    let parts = "parameter allowed\n  default  base * 2\n\ndefine base\n  is  1 m/s^2\n\ndefine other\n  is  third\n\nparameter third\n  default  3\n\nestimate fourth\n  is  mean + std\n\n";
    let told = |text: &str| {
        let (_, plan, problems) = checked(&Source::new("p.fp", text));
        assert!(plan.is_some(), "{}", problems.render(false));
        let told = |problem: &Problem| {
            assert_eq!((problem.code, problem.severity), ("unused", Severity::Warning));
            problem.at.as_ref().map_or(String::new(), |at| at.text().to_string())
        };
        problems.0.iter().map(told).collect::<Vec<_>>()
    };
    let head = "protocol p \"P\"\n  extends  en14363-2016-annex-t\n\n";
    assert_eq!(told(&format!("{head}{parts}{quantity}")), ["other", "third", "fourth"]);
    // The parameters of the parent are there, and nothing uses them here.
    assert_eq!(told(&format!("{head}{parts}remove\n  quantity  every\n\n{quantity}")).len(), 3);
}

/// A column called `zone` is one like others where there are no zones.
#[test]
fn a_column_of_zones_forms_groups_without_zone_blocks() {
    let text = "protocol p \"P\"\n  axis  distance in m\n\nchannel Y\n  in  kN\n\nsection zone\n  one of  a, b\n\nquantity q\n  from    measured\n  of      Y\n  value   mean\n  limit   std 3 kN for each zone\n  report  mean of (mean for each zone)\n";
    let (_, plan, problems) = checked(&Source::new("p.fp", text));
    assert!(problems.0.is_empty(), "{}", problems.render(false));
    assert_eq!(plan.expect("a plan").quantities[0].limits[0].scope.each.len(), 1);
    let without = text.replace("section zone\n  one of  a, b\n", "");
    let (_, _, problems) = checked(&Source::new("p.fp", without));
    assert!(
        problems.0.iter().all(|problem| problem.code == "unknown-zone" && problem.help.is_some())
    );
}

/// A block of a variant without a name is pointed at in the variant.
#[test]
fn a_verdict_that_is_overridden_stands_in_the_variant() {
    let text = "protocol p \"P\"\n  extends  en14363-2016-annex-t\n\nverdict\n  validated  when at least 10 quantities hold\n";
    let (_, plan, _) = checked(&Source::new("p.fp", text));
    assert_eq!(plan.expect("a plan").overall().span.source.name, "p.fp");
}

/// Two surfaces, one meaning: plan and graph of a protocol and of what it is converted to are the
/// same, places aside.
#[test]
fn both_forms_mean_the_same() {
    for path in files("protocols").into_iter().chain(files("tests/cases/check/good")) {
        let text = spelled(&path);
        let document = syntax::read(&text, &mut Problems::default());
        let yaml = Source::new(name(&path).replace(".fp", ".yaml"), print_yaml(&document));
        let (a, plan_a, problems) = checked(&text);
        let (b, plan_b, problems_b) = checked(&yaml);
        assert_eq!(codes(&problems), codes(&problems_b));
        let (plan_a, plan_b) = (plan_a.expect("a plan"), plan_b.expect("a plan"));
        assert_eq!(described(&plan_a), described(&plan_b));
        assert_eq!(graph_of(&plan_a), graph_of(&plan_b));
        assert!(diff(&a.merged, &b.merged).is_empty(), "{}", path.display());
    }
}

/// The YAML beside the text form is its conversion, and the program reads it as the same protocol.
#[test]
fn the_shipped_yaml_is_the_shipped_text() {
    let path = root().join("protocols/en14363-2016-annex-t.fp");
    let document = syntax::read(&source(&path), &mut Problems::default());
    let yaml = path.with_extension("yaml");
    let wanted = print_yaml(&document);
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        fs::write(&yaml, &wanted).expect("a writable protocol");
    }
    assert_eq!(fs::read_to_string(&yaml).expect("the protocol in YAML"), wanted);
}

/// The nodes without the places they come from.
fn graph_of(plan: &Plan) -> serde_json::Value {
    let mut json = graph::json(&graph::from_plan(plan));
    for node in json["nodes"].as_array_mut().expect("nodes") {
        node.as_object_mut().expect("a node").remove("from");
    }
    json
}

// ---- variants and differences

#[track_caller]
fn variant(text: &str) -> (Family, Option<Plan>, Problems) {
    checked(&Source::new(
        "variant.fp",
        format!("protocol variant \"A variant\"\n  extends  en14363-2016-annex-t\n\n{text}"),
    ))
}

#[track_caller]
fn deviations(text: &str) -> Vec<(String, Option<String>, Option<String>)> {
    let (family, plan, problems) = variant(text);
    assert!(plan.is_some(), "{}", problems.render(false));
    let parent = family.parent().expect("a parent");
    diff(parent, &family.merged)
        .into_iter()
        .map(|deviation| (deviation.rule, deviation.before, deviation.after))
        .collect()
}

#[test]
fn a_variant_overrides_field_by_field() {
    let some = |text: &str| Some(text.to_string());
    assert_eq!(
        deviations("quantity ay_max\n  limit  std 0.28 m/s^2\n"),
        [(
            "quantity ay_max, limit std".into(),
            some("std 0.4 m/s^2, doubled when lighter_requirements"),
            some("std 0.28 m/s^2")
        )]
    );
    assert_eq!(
        deviations("quantity ay_max \"Another title\"\n  filter  LP20\n"),
        [
            (
                "quantity ay_max, title".into(),
                some("Car body lateral acceleration, maximum"),
                some("Another title")
            ),
            ("quantity ay_max, filter".into(), some("BP"), some("LP20")),
        ]
    );
    // A metric takes the place of value and difference.
    let rules: Vec<String> =
        deviations("quantity Y_max\n  metric  sprague-geers phase\n  limit   std 0.2\n")
            .into_iter()
            .map(|(rule, ..)| rule)
            .collect();
    assert_eq!(
        rules,
        [
            "quantity Y_max, value",
            "quantity Y_max, difference",
            "quantity Y_max, metric",
            "quantity Y_max, limit std"
        ]
    );
    assert_eq!(
        deviations("zone 1\n  minimum sections  5\n"),
        [("zone 1, minimum sections".into(), some("sections_per_zone"), some("5"))]
    );
    assert_eq!(
        deviations("remove\n  limit  az_max mean\n"),
        [(
            "quantity az_max, limit mean".into(),
            some("mean mean_limit_share of limit of std"),
            None
        )]
    );
    let removed = deviations("remove\n  quantity  az_max\n");
    assert_eq!(
        (removed.len(), removed[0].0.as_str(), &removed[0].2),
        (1, "quantity az_max", &None)
    );
}

// ---- families of blocks

/// A protocol with every family written out is the same protocol.
#[test]
fn a_family_is_its_blocks_written_out() {
    let mut families = 0;
    for path in files("protocols").into_iter().chain(files("tests/cases/check/good")) {
        let (family, plan, _) = checked(&spelled(&path));
        let text = print_text(&family.merged);
        families += usize::from(source(&path).text.contains("  for each "));
        assert!(!text.contains("  for each "), "{text}");
        let (_, again, problems) =
            checked(&Source::new(name(&path), text.replace("  extends  ", "  # extends ")));
        let again = again.unwrap_or_else(|| panic!("{}", problems.render(false)));
        let plan = plan.expect("a plan");
        assert_eq!(described(&again), described(&plan), "{}", path.display());
        assert_eq!(graph_of(&again), graph_of(&plan), "{}", path.display());
    }
    assert!(families >= 2, "{families} protocols have families");
}

const PAIRS: &str = "protocol p \"P\"\n  axis  distance in m\n\nchannel {s}\n  for each  s in a, b\n  in        m\n\n\
    quantity {s}_{v}\n  for each    s in a, b and v in mean, rms\n  of          {s}\n  value       {v}\n  difference  signed\n  limit       std 1 m\n  limit       each 2 m\n";

/// Rule, before and after.
type Difference = (String, Option<String>, Option<String>);

/// The variant of a protocol with a family, and what differs.
#[track_caller]
fn of_pairs(text: &str) -> (Vec<String>, Vec<Difference>) {
    let variant = Source::new(
        "variant.fp",
        format!("protocol variant \"A variant\"\n  extends  \"pairs.fp\"\n\n{text}"),
    );
    let mut problems = Problems::default();
    let family = family::read(&variant, &|_, _| Ok(Source::new("pairs.fp", PAIRS)), &mut problems);
    let plan = check::check(&family, &Overrides::new(), &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)));
    let parent = family.parent().expect("a parent");
    let found = diff(parent, &family.merged)
        .into_iter()
        .map(|found| (found.rule, found.before, found.after))
        .collect();
    (plan.quantities.iter().map(|quantity| quantity.id.clone()).collect(), found)
}

/// One member by its name, all of them by the name of the family, or the family given again:
/// deviations are told member by member.
#[test]
fn a_variant_overrides_members_of_a_family() {
    let some = |text: &str| Some(text.to_string());
    let all = ["a_mean", "a_rms", "b_mean", "b_rms"];
    let (names, found) = of_pairs("quantity b_rms\n  limit  std 3 m\n");
    assert_eq!(names, all);
    assert_eq!(found, [("quantity b_rms, limit std".into(), some("std 1 m"), some("std 3 m"))]);

    let (names, found) = of_pairs(
        "remove\n  quantity  a_rms\n\nquantity {s}_{v} \"{v} of {s}\"\n  limit  std 3 m\n",
    );
    assert_eq!(names, ["a_mean", "b_mean", "b_rms"]);
    let rules: Vec<&str> = found.iter().map(|(rule, ..)| rule.as_str()).collect();
    assert_eq!(
        rules,
        [
            "quantity a_mean, title",
            "quantity a_mean, limit std",
            "quantity b_mean, title",
            "quantity b_mean, limit std",
            "quantity b_rms, title",
            "quantity b_rms, limit std",
            "quantity a_rms",
        ]
    );
    assert_eq!(found[2].2, some("mean of b"));

    let (names, found) = of_pairs(
        "quantity {s}_{v}\n  for each    s in b and v in rms, peak\n  of          {s}\n  value       {v}\n  difference  signed\n  limit       std 1 m\n",
    );
    assert_eq!(names, ["a_mean", "a_rms", "b_mean", "b_rms", "b_peak"]);
    assert_eq!(
        found.iter().map(|(rule, ..)| rule.as_str()).collect::<Vec<_>>(),
        ["quantity b_peak"]
    );
}

#[test]
fn a_variant_removes_every_one_of_a_kind() {
    let one = "quantity one\n  of          a\n  value       mean\n  difference  signed\n  limit       std 1 m\n";
    for removed in ["quantity  every", "quantity  {s}_{v}", "quantity  a_rms\n  quantity  every"] {
        let (names, found) = of_pairs(&format!("remove\n  {removed}\n\n{one}"));
        assert_eq!(names, ["one"], "{removed}");
        assert_eq!(found.len(), 5, "{removed}");
    }
    let limits = |removed: &str| -> Vec<String> {
        of_pairs(&format!("remove\n  limit  {removed}\n"))
            .1
            .into_iter()
            .map(|(rule, ..)| rule)
            .collect()
    };
    assert_eq!(limits("a_rms"), ["quantity a_rms, limit std", "quantity a_rms, limit each"]);
    assert_eq!(limits("a_rms each"), ["quantity a_rms, limit each"]);
    assert_eq!(limits("every std").len(), 4);
    assert_eq!(limits("{s}_{v}").len(), 8);
    // Removed and written anew.
    let (names, found) = of_pairs("remove\n  limit  every\n\nquantity {s}_{v}\n  limit  std 1 m\n");
    assert_eq!((names.len(), found.len()), (4, 4));
}

/// The families of a variant stand over places of its parent, too; a text cannot grow without
/// bound.
#[test]
fn members_of_places_and_bounds() {
    let (family, plan, problems) =
        variant("signal v{w}\n  for each  w in wheelsets\n  is        Y at wheelset {w} side R\n");
    assert!(plan.is_some(), "{}", problems.render(false));
    let made = family
        .merged
        .blocks
        .iter()
        .filter(|block| block.kind.text == "signal" && block.name_text().starts_with('v'))
        .count();
    assert_eq!(made, 4);
    let long = "{x}".repeat(20_000);
    let members = (0..900).map(|number| format!("m{number}")).collect::<Vec<_>>().join(", ");
    let (_, plan, problems) =
        variant(&format!("quantity {{x}}\n  for each  x in {members}\n  note      \"{long}\"\n"));
    assert!(plan.is_none());
    assert_eq!(codes(&problems), ["too-large"]);
    let many: String = (0..12)
        .map(|number| {
            format!("define d{number}_{{x}}\n  for each  x in {members}\n  is        1\n\n")
        })
        .collect();
    assert_eq!(codes(&variant(&many).2), ["too-large"]);
}

/// What a committee asks for most: one more zone is one block.
#[test]
fn a_fifth_zone_is_one_block() {
    let text = "zone 5 \"Curves below 250 m\"\n  where             150 m <= radius < 250 m\n  minimum sections  sections_per_zone\n  minimum length    50 m\n";
    let (_, plan, problems) = variant(text);
    let plan = plan.unwrap_or_else(|| panic!("{}", problems.render(false)));
    assert_eq!(plan.zones.len(), 5);
    let found = deviations(text);
    assert_eq!((found.len(), found[0].0.as_str()), (1, "zone 5"));
    // And one less is one line.
    let (_, plan, problems) = variant("remove\n  zone  4\n");
    assert_eq!(plan.unwrap_or_else(|| panic!("{}", problems.render(false))).zones.len(), 3);
}

/// Other ways of writing the same number, unit, place or order of conditions are no difference.
#[test]
fn the_same_meaning_is_no_difference() {
    for text in [
        "quantity ay_max\n  limit  std 0.4 m/s², doubled when lighter_requirements\n",
        "quantity ay_max\n  limit  std 400 mm/s^2 doubled when lighter_requirements\n",
        "quantity Y_max\n  of  Y at wheelset evaluated_wheelsets\n",
        "parameter lowpass_frequency\n  default  0.02 kHz\n",
        "parameter mean_limit_share\n  range  0.010  to 1e1\n",
        "filter BP\n  step  band-pass 0.40 Hz to 10.0 Hz, order bandpass_order, filter_phase, filter_edge\n",
        "channel ay\n  in  m/s²\n",
        "zone 3\n  where  400 m ≤ radius ≤ 0.6 km\n",
    ] {
        assert_eq!(deviations(text), [], "{text}");
    }
}

/// The variants that are shipped differ from their parents in what their titles say, and in nothing
/// else.
#[test]
fn shipped_variants_differ_only_where_they_say() {
    let rules = |name: &str| {
        let (family, _, _) = checked(&library::shipped(name).expect("a shipped protocol"));
        let found = diff(family.parent().expect("a parent"), &family.merged);
        found.into_iter().map(|deviation| deviation.rule).collect::<Vec<_>>()
    };
    assert_eq!(
        rules("en14363-2016-annex-t-population-deviation"),
        ["parameter variance_divisor, default"]
    );
    let strict = rules("en14363-2016-annex-t-strict-acceleration");
    assert!(
        strict.iter().all(|rule| rule.contains("limit std") || rule.contains("source")),
        "{strict:?}"
    );
    assert_eq!(strict.len(), 8);
}

#[test]
fn a_warning_is_no_error() {
    let protocol = "quantity Y_extra\n  of          Y at wheelset 1\n  value       median\n  difference  signed\n";
    let (_, plan, problems) = variant(protocol);
    assert!(plan.is_some());
    assert_eq!(
        problems.0.iter().map(|problem| (problem.severity, problem.code)).collect::<Vec<_>>(),
        [(Severity::Warning, "no-limit")]
    );
}

/// A number of no checked source says so beside every limit that it is in, by whatever way, until
/// somebody sets it.
#[test]
fn a_number_to_be_confirmed_says_so() {
    const TEXT: &str = "parameter highest \"Highest\"\n  default      4 kN\n  unconfirmed  \"From memory.\"\n\n\
        define higher \"Higher\"\n  is           6 kN\n  unconfirmed  \"From memory.\"\n\n\
        estimate reached \"Reached\"\n  is  mean + 2 * std\n\n\
        remove\n  limit  Y_max\n  limit  Q_max mean\n\n\
        quantity Y_max\n  limit  std highest\n  limit  mean 2/3 of limit of std\n  limit  reached 12 kN\n  limit  peak 2 * higher\n\n\
        quantity Q_max\n  limit        mean 3 kN\n  unconfirmed  \"By eye.\"\n";
    const MARK: &str = ", to be confirmed against the standard";
    let words = |text: &str, overrides: &Overrides| {
        let source = Source::new(
            "variant.fp",
            format!("protocol variant \"A variant\"\n  extends  en14363-2016-annex-t\n\n{text}"),
        );
        let (_, plan, problems) = checked_with(&source, overrides);
        let plan = plan.unwrap_or_else(|| panic!("{}", problems.render(false)));
        let of = |id: &str| {
            plan.quantities
                .iter()
                .find(|quantity| quantity.id == id)
                .expect("a quantity")
                .limits
                .clone()
        };
        let marked = of("Y_max")
            .iter()
            .chain(&of("Q_max"))
            .map(|limit| limit.words.ends_with(MARK))
            .collect::<Vec<_>>();
        (marked, plan.values.provisional)
    };
    let value =
        |name: &str, title: &str, (value, unit): (&str, Option<&str>), why: Option<&str>| {
            StatedValue {
                name: name.into(),
                title: title.into(),
                value: value.into(),
                unit: unit.map(str::to_string),
                clause: None,
                why: why.map(str::to_string),
            }
        };
    let highest = |number: &str, why| value("highest", "Highest", (number, Some("kN")), why);
    let higher = value("higher", "Higher", ("6", Some("kN")), Some("From memory."));
    let of_plan = |found: Vec<StatedValue>| -> Vec<String> {
        found.into_iter().map(|one| format!("{} {:?}", one.in_words(), one.why)).collect()
    };
    let first_two = |found: (Vec<bool>, Vec<StatedValue>)| {
        assert!(found.1.iter().any(|one| one.name == "Q_max"));
        let zone = |one: &StatedValue| one.name.starts_with("zone ");
        let own = found.1.into_iter().filter(|one| one.name != "Q_max" && !zone(one)).collect();
        (found.0, of_plan(own))
    };
    // Y_max: std, mean, reached, peak; Q_max: the parent's std, mean.
    assert_eq!(
        first_two(words(TEXT, &Overrides::new())),
        (
            vec![true, true, false, true, true, true],
            of_plan(vec![highest("4", Some("From memory.")), higher.clone()])
        )
    );
    // A value that is set is an own value, which is to be confirmed as well.
    assert_eq!(
        first_two(words(TEXT, &set("highest", "5 kN"))),
        (
            vec![true, true, false, true, true, true],
            of_plan(vec![highest("5", None), higher.clone()])
        )
    );
    // Confirmed for another value or edition: not; for this one, also in another unit: the words
    // go.
    let edition = "EN 14363:2016, Annex T (method of the DynoTRAIN project)";
    let confirmed = |value: &str, unit: &str, edition: &str| {
        let mut overrides = Overrides::new();
        overrides.confirmed.push(Confirmation {
            name: "highest".into(),
            value: value.into(),
            unit: Some(unit.into()),
            clause: None,
            edition: Some(edition.into()),
            signed: Signed { by: "test".into(), date: "2026-01-01".into() },
        });
        words(TEXT, &overrides).0
    };
    let (open, done) =
        (vec![true, true, false, true, true, true], vec![false, false, false, true, true, true]);
    assert_eq!(confirmed("5", "kN", edition), open);
    assert_eq!(confirmed("4", "kN", "another"), open);
    assert_eq!(confirmed("4000", "N", edition), done);
}

/// A parameter without a value needs a range that says what it is, and is a number.
#[test]
fn a_parameter_may_have_no_value() {
    const START: &str = "protocol variant \"A variant\"\n  extends  en14363-2016-annex-t\n\n";
    let told = |parameter: &str| {
        let text = format!(
            "{START}parameter highest \"Highest\"\n  optional  not assessable\n{parameter}\nquantity Y_max\n  limit  std highest\n"
        );
        let (_, plan, problems) = checked_with(&Source::new("variant.fp", text), &Overrides::new());
        (plan.is_some(), problems.0.first().map(|problem| problem.code))
    };
    assert!(told("  range  1 kN to 9 kN\n").0);
    assert_eq!(told(""), (false, Some("missing-field")));
    assert_eq!(told("  one of  a, b\n"), (false, Some("unknown-choice")));
    assert_eq!(told("  range  1 kN to 9 kN\n  default  2 kN\n"), (false, Some("duplicate-field")));
    // As the edge of a filter it would be needed before any record is read.
    let filter = "protocol variant \"A variant\"\n  extends  en14363-2016-annex-t\n\nparameter lowpass_frequency\n  optional  not assessable\n";
    let (_, plan, _) = checked_with(&Source::new("variant.fp", filter), &Overrides::new());
    assert!(plan.is_none());
}

/// The first versions wrote `default not stated`: it is read as what it is now, told, and written
/// anew.
#[test]
fn an_old_spelling_is_read_and_written_anew() {
    let text = |field: &str| {
        format!(
            "protocol old \"Old\"\n  extends  en14363-2016-annex-t\n\nvehicle bogie_mass \"Mass\"\n  in        kg\n  {field}\n"
        )
    };
    let read = |text: String| {
        let mut problems = Problems::default();
        let document = syntax::read(&Source::new("old.fp", text), &mut problems);
        (document, problems.0.iter().map(|problem| problem.code).collect::<Vec<_>>())
    };
    let (old, told) = read(text("default   not stated"));
    assert_eq!(told, ["old-spelling"]);
    let (now, told) = read(text("optional  not assessable"));
    assert!(told.is_empty());
    assert!(old == now);
    assert_eq!(print_text(&old), text("optional  not assessable"));
}

/// A word that no list has is compared as it is; one that names a datum is ambiguous.
#[test]
fn a_datum_may_be_any_word() {
    let told = |condition: &str| {
        let text = format!(
            "protocol any \"Any word\"\n  extends  en14363-2016-annex-t\n\nsection country \"Country\"\n  one of  any word\n\nquantity Y_max\n  report  maximum for sections where {condition}\n  report  n for each country\n"
        );
        let (_, plan, problems) = checked_with(&Source::new("any.fp", text), &Overrides::new());
        (plan.is_some(), problems.0.first().map(|problem| problem.code))
    };
    assert_eq!(told("country is IT"), (true, None));
    assert_eq!(told("country is not \"Great Britain\""), (true, None));
    assert_eq!(told("country is \"zone\""), (true, None));
    assert_eq!(told("country is zone"), (false, Some("not-a-word")));
    assert_eq!(told("country is 5 kN"), (false, Some("not-a-word")));
    assert_eq!(told("country < 5"), (false, Some("not-a-number")));
}

/// A variant with a slip in a name adds something, and what it was to change stays: this is told. A
/// new name is left alone.
#[test]
fn a_name_one_slip_away_from_one_of_the_parent_is_told() {
    const VARIANT: &str = r#"protocol slips "A variant with two slips"
  extends  en14363-2016-annex-t-found-sections

parameter speed_chang
  default  5 km/h

find deficency
  require  |cant_deficiency| <= 200 mm

zone 5 "Another zone"
  where  radius < 200 m
  minimum length  50 m
"#;
    let (_, plan, problems) = checked_with(&Source::new("slips.fp", VARIANT), &Overrides::new());
    assert!(plan.is_some(), "{}", problems.render(false));
    let told: Vec<(&str, Option<&str>)> =
        problems.0.iter().map(|problem| (problem.code, problem.help.as_deref())).collect();
    let helps =
        ["to override `speed_change`, use that name", "to override `deficiency`, use that name"];
    assert_eq!(told, helps.map(|help| ("near-name", Some(help))));
}
