//! The block `report` of `campaign.yaml`: identification of the report, customer, test item,
//! equipment and dates.

use crate::data::prelude::*;

/// The key of the block.
pub const REPORT_KEY: &str = "report";

/// An item that an assessor expects in a test report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// The enclosing map inside the block, if any.
    pub group: Option<&'static str>,
    pub key: &'static str,
    pub title: &'static str,
    /// Clause of ISO/IEC 17025:2017 that requires it, if any.
    pub clause: Option<&'static str>,
}

/// `clause` is empty where no clause requires the item.
const fn field(
    group: Option<&'static str>,
    key: &'static str,
    title: &'static str,
    clause: &'static str,
) -> Field {
    let clause = if clause.is_empty() { None } else { Some(clause) };
    Field { group, key, title, clause }
}

const ITEM: Option<&str> = Some("test item");
const DATES: Option<&str> = Some("dates");
/// The date of issue of the report.
const ISSUE: &str = "issue";

/// In the order of printing.
pub const FIELDS: &[Field] = &[
    field(None, "number", "Report number", "7.8.2.1 d)"),
    field(None, "revision", "Revision", "7.8.8"),
    field(None, "customer", "Customer", "7.8.2.1 e)"),
    field(None, "laboratory", "Laboratory", "7.8.2.1 b)"),
    field(None, "location", "Location of the tests", "7.8.2.1 c)"),
    field(ITEM, "description", "Test item", "7.8.2.1 g)"),
    field(ITEM, "vehicle number", "Test item: vehicle number", "7.8.2.1 g)"),
    field(ITEM, "state", "Test item: state", "7.8.2.1 g)"),
    field(DATES, "receipt", "Date of receipt of the test item", "7.8.2.1 h)"),
    field(DATES, "test", "Date of test", "7.8.2.1 i)"),
    field(DATES, ISSUE, "Date of issue", "7.8.2.1 j)"),
    field(None, "sampling", "Sampling plan or choice of sections", "7.8.2.1 k)"),
    field(None, "simulation software", "Simulation software", ""),
    field(None, "model version", "Model version", ""),
    field(None, "instrumentation", "Instrumentation", "7.8.3.1 a)"),
    field(None, "calibration", "Calibration and traceability", "6.5"),
    field(None, "uncertainty", "Measurement uncertainty", "7.8.3.1 c)"),
    field(None, "decision rule", "Decision rule", "7.8.6"),
    field(None, "external providers", "Results from external providers", "7.8.2.1 p)"),
    field(None, "authorised by", "Person authorising the report", "7.8.2.1 o)"),
    field(None, "distribution", "Distribution", ""),
];

/// A field of [`FIELDS`] and its value.
pub type Stated = (&'static Field, Option<String>);

/// The block: all fields in the order of [`FIELDS`]; missing ones are `None`.
#[derive(Clone, Debug)]
pub struct Report(pub Vec<Stated>);

impl Default for Report {
    fn default() -> Self {
        Self(FIELDS.iter().map(|field| (field, None)).collect())
    }
}

impl Report {
    /// Reads the block. `above`: the keys of the campaign, which were meant if they stand here.
    ///
    /// Problems: `unknown-key` (with the nearest one), `key-twice`, `wrong-kind`, `report-date`
    /// (not a date).
    pub fn read(node: &Node, above: &[&str], problems: &mut Problems) -> Self {
        let mut report = Self::default();
        if !matches!(node.value, Value::Map(_) | Value::Null) {
            let what = format!("`{REPORT_KEY}`");
            problems.push(node.is_not(&what, "a map of keys and values"));
        }
        for (key, node) in node.entries() {
            report.entry(key, node, above, problems);
        }
        report
    }

    fn entry(&mut self, key: &Key, node: &Node, above: &[&str], problems: &mut Problems) {
        let name = plain(&key.text);
        let groups = || FIELDS.iter().filter_map(|field| field.group);
        let Some(group) = groups().find(|group| *group == name) else {
            // `date of issue` at the top level is `issue` of the dates.
            let at = match name.strip_prefix("date of ") {
                Some(dated) => position(DATES, dated),
                None => position(None, &name),
            };
            if let Some(at) = at {
                return self.state(at, key, node, problems);
            }
            let dates = ["date of receipt", "date of test", "date of issue"];
            let problem = unknown(key, "a report", members(None).chain(groups()).chain(dates));
            return problems.push(match above.contains(&key.text.as_str()) {
                true => problem.help(at_the_margin(&key.text)),
                false => problem,
            });
        };
        let description = position(Some(group), "description");
        match (&node.value, description) {
            (Value::Null, _) => {}
            (Value::Map(entries), _) => {
                for (inner, node) in entries {
                    match position(Some(group), &plain(&inner.text)) {
                        Some(at) => self.state(at, inner, node, problems),
                        None => {
                            let what = format!("`{group}` of a report");
                            problems.push(unknown(inner, &what, members(Some(group))));
                        }
                    }
                }
            }
            // A test item given as text.
            (_, Some(at)) if node.is_scalar() => self.state(at, key, node, problems),
            _ => {
                let keys: Vec<String> =
                    members(Some(group)).map(|key| format!("`{key}`")).collect();
                let be = format!("a map with {}", keys.join(", "));
                problems.push(node.is_not(&format!("`{group}`"), &be));
            }
        }
    }

    fn state(&mut self, at: usize, key: &Key, node: &Node, problems: &mut Problems) {
        let (field, stated) = &mut self.0[at];
        let text = match &node.value {
            Value::Null => return,
            Value::List(items) => {
                let items: Option<Vec<&str>> = items.iter().map(Node::scalar_text).collect();
                items.map(|items| items.join("; "))
            }
            _ => node.scalar_text().map(str::to_owned),
        };
        let Some(text) = text else {
            let what = format!("`{}`", key.text);
            return problems.push(node.is_not(&what, "text or a list of texts"));
        };
        let text = text.trim();
        if text.is_empty() {
            return;
        }
        if (field.group, field.key) == (DATES, ISSUE) && date(text).is_none() {
            problems.push(
                problem!("report-date", &node.span, "`{text}` is not a valid date of issue")
                    .help("write year-month-day, such as 2026-03-31"),
            );
        } else if stated.is_some() {
            problems.push(problem!(
                "key-twice",
                &key.span,
                "the {} is stated twice",
                field.title.to_lowercase()
            ));
        } else {
            *stated = Some(text.to_owned());
        }
    }
}

/// Help for a key of the campaign that was indented into a block.
pub fn at_the_margin(key: &str) -> String {
    format!("`{key}` is a key of the campaign: it stands at the left margin")
}

/// The place of a field in [`FIELDS`].
fn position(group: Option<&str>, key: &str) -> Option<usize> {
    FIELDS.iter().position(|field| field.group == group && field.key == key)
}

/// Keys of a map inside the block, or of the block itself.
fn members(group: Option<&str>) -> impl Iterator<Item = &'static str> {
    FIELDS.iter().filter(move |field| field.group == group).map(|field| field.key)
}

fn unknown<'a>(key: &Key, block: &str, known: impl Iterator<Item = &'a str>) -> Problem {
    let mut known: Vec<&str> = known.collect();
    known.dedup();
    let problem = problem!("unknown-key", &key.span, "{block} has no key `{}`", key.text)
        .suggest(&plain(&key.text), &known);
    if problem.help.is_some() {
        problem
    } else {
        problem.help(format!("the keys are {}", known.join(", ")))
    }
}

/// Underscores are equivalent to spaces.
fn plain(key: &str) -> String {
    key.trim().replace('_', " ")
}

/// Year, month and day of `2026-03-31`; `None` if this is not a valid date.
pub fn date(text: &str) -> Option<(i32, u8, u8)> {
    let form = |(at, byte): (usize, u8)| match at {
        4 | 7 => byte == b'-',
        _ => byte.is_ascii_digit(),
    };
    if text.len() != 10 || !text.bytes().enumerate().all(form) {
        return None;
    }
    let (year, month, day): (u16, u8, u8) =
        (text[..4].parse().ok()?, text[5..7].parse().ok()?, text[8..].parse().ok()?);
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        2 if leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        1..=12 => 31,
        _ => return None,
    };
    (year > 0 && (1..=days).contains(&day)).then_some((i32::from(year), month, day))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    fn stated(text: &str) -> (Vec<(String, String)>, String) {
        let mut problems = Problems::default();
        let source = Source::new("campaign.yaml", text);
        let tree = crate::yaml::load(&source, &mut problems);
        let node = tree.as_ref().and_then(|tree| tree.get(REPORT_KEY));
        let found = node.map(|node| Report::read(node, &[], &mut problems));
        let Report(found) = found.unwrap_or_default();
        let given = found
            .into_iter()
            .filter_map(|(field, value)| Some((field.title.to_owned(), value?)))
            .collect();
        (given, problems.render(false))
    }

    #[test]
    fn a_block_is_read_in_either_way() {
        let (given, problems) = stated(
            "report:\n  number: R 7\n  test_item:\n    vehicle number: 61 81 20\n  date of issue: 2026-02-28\n  calibration: [a, b]\n",
        );
        assert_eq!(problems, "");
        let want = [
            ("Report number", "R 7"),
            ("Test item: vehicle number", "61 81 20"),
            ("Date of issue", "2026-02-28"),
            ("Calibration and traceability", "a; b"),
        ];
        assert_eq!(given, want.map(|(a, b)| (a.to_owned(), b.to_owned())));
        assert_eq!(
            stated("report:\n  test item: coach\n  dates: {test: spring}\n").0[0].1,
            "coach"
        );
        assert!(stated("name: x\n").0.is_empty() && stated("report:\n").1.is_empty());
    }

    #[test]
    fn what_is_wrong_is_told_with_the_nearest_key() {
        for (text, says) in [
            ("report:\n  custommer: x\n", "customer"),
            ("report:\n  test item:\n    vehicel number: x\n", "vehicle number"),
            ("report:\n  zzz: x\n", "the keys are number"),
            ("report:\n  dates: 2026-01-01\n", "must be a map"),
            ("report: [a]\n", "must be a map"),
            ("report:\n  number: {a: b}\n", "text or a list"),
            ("report:\n  date of issue: 2026-02-30\n", "is not a valid date of issue"),
            (
                "report:\n  date of issue: 2026-02-01\n  dates: {issue: 2026-02-02}\n",
                "stated twice",
            ),
        ] {
            let problems = stated(text).1;
            assert!(
                problems.contains(says) && problems.contains("campaign.yaml:"),
                "{text}: {problems}"
            );
        }
    }

    #[test]
    fn days_of_the_calendar() {
        assert_eq!(date("2024-02-29"), Some((2024, 2, 29)));
        assert_eq!(
            (date("2023-02-29"), date("1900-02-29"), date("2000-02-29").is_some()),
            (None, None, true)
        );
        assert_eq!(
            (
                date("2026-13-01"),
                date("2026-04-31"),
                date("26-04-01"),
                date("2026/04/01"),
                date("0000-01-01")
            ),
            (None, None, None, None, None)
        );
    }
}
