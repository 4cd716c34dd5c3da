//! Checks the rules that belong to no quantity: axis, zones, section checks, treatment of sections,
//! independent units.

use super::{
    find::{AT_MOST, FOUND_SECTIONS},
    prelude::*,
};
use crate::metrics::percentile::Method;

impl Checker<'_> {
    /// An axis such as `distance in m`, of one of the allowed dimensions.
    pub fn axis_field(&mut self, field: &Field, allowed: &[Dimension]) -> Option<Axis> {
        let (name, unit) = from_pest::axis(&field.value, self.problems)?;
        let text = unit.to_text();
        let unit = self.unit(&text)?;
        if !allowed.contains(&unit.dimension) {
            let help =
                "write for instance `axis distance in m` or `axis time in s`; `time time in s`";
            return self.refuse(
                problem!(
                    "unit-mismatch",
                    &text,
                    "`{}` cannot be {}",
                    field.key.text,
                    unit.dimension.in_words()
                )
                .help(help),
            );
        }
        Some(Axis { column: name.node, unit, span: field.value.span.clone() })
    }

    /// A zone with its condition and minima.
    pub fn zone(&mut self, block: &Block) -> Option<Zone> {
        let (condition, condition_words) = match block.field("where") {
            Some(field) => {
                let open = self.values.open(&format!("zone {}", block.own_name()));
                let unconfirmed = if open { self.to_be_confirmed() } else { "" };
                (Some(self.section_condition(field)?), normalised(&field.value.text) + unconfirmed)
            }
            None => (None, String::new()),
        };
        let minimum_length = match block.field("minimum length") {
            None => None,
            Some(field) => {
                let mut scope = Scope { zone: Some(block.own_name()), ..Scope::section() };
                let expr = self.assuming(condition.clone(), |checker| {
                    checker.expression(&field.value, &mut scope)
                })?;
                Some(self.length_of_section(expr, field)?)
            }
        };
        let minimum_sections = self.count(block, "minimum sections", 0)?;
        Some(Zone {
            name: block.own_name(),
            title: block.title_text().unwrap_or_default(),
            condition,
            condition_words,
            minimum_sections,
            minimum_length,
            span: block.place(),
        })
    }

    /// The dimension of the axis; that of the usual one if the protocol has none, which is reported
    /// elsewhere.
    pub fn axis_dimension(&self) -> Dimension {
        self.axis.as_ref().map_or(Dimension::LENGTH, |axis| axis.unit.dimension)
    }

    /// A requirement on every section.
    pub fn section_check(&mut self, block: &Block) -> Option<Check> {
        let field = self.required(block, "require")?;
        let mut scope = Scope::reducing(None, self.axis_dimension());
        let require = self.expression(&field.value, &mut scope)?;
        self.flag_type(&require)?;
        self.inputs_of_one_record(&scope.inputs)?;
        let unless = if_written(block.field("unless").map(|field| self.section_condition(field)))?;
        let otherwise = self.on_fault(block, "otherwise", &["not used", "stop", "note"])?;
        let unchecked = self.on_fault(block, "unchecked", &["not assessable", "note"])?;
        Some(Check {
            name: block.own_name(),
            title: block.title_in_words(),
            require,
            inputs: scope.inputs,
            unless,
            words: normalised(&field.value.text),
            otherwise,
            required: otherwise != OnFault::Note && unchecked != OnFault::Note,
            span: block.place(),
        })
    }

    /// The track record has samples of its own: a check cannot combine it with simulation or
    /// measurement.
    pub fn inputs_of_one_record(&mut self, inputs: &[Input]) -> Option<()> {
        let track = |input: &Input| input.signal.as_ref().is_some_and(Expr::track);
        let Some(first) = inputs.first() else { return Some(()) };
        let Some(other) = inputs.iter().find(|input| track(input) != track(first)) else {
            return Some(());
        };
        self.refuse(
            error(
                "mixed-records",
                "a check uses either the track record or the records of simulation and measurement",
                &other.span,
            )
            .also(&first.span, "the other record")
            .help("write two checks"),
        )
    }

    /// What is done with a fault: one of the treatments that the field allows, by default the
    /// first.
    pub fn on_fault(&mut self, block: &Block, key: &str, treatments: &[&str]) -> Option<OnFault> {
        let treatments: Vec<(&str, OnFault)> = treatments
            .iter()
            .map(|word| match *word {
                "not used" => (*word, OnFault::NotUsed),
                "note" => (*word, OnFault::Note),
                "not assessable" => (*word, OnFault::NotAssessable),
                _ => (*word, OnFault::Stop),
            })
            .collect();
        let Some(field) = block.field(key) else {
            return treatments.first().map(|(_, by_default)| *by_default);
        };
        self.one_of(field, &treatments, |word| format!("`{word}` is not a treatment of faults"))
    }

    /// What the word of a field stands for; a problem that says why where it is none of them.
    fn one_of<T: Copy>(
        &mut self,
        field: &Field,
        choices: &[(&str, T)],
        says: fn(&str) -> String,
    ) -> Option<T> {
        let word = self.choice_field(field)?;
        if let Some((_, found)) = choices.iter().find(|(known, _)| *known == word) {
            return Some(*found);
        }
        let known = choices.iter().map(|(known, _)| *known);
        self.refuse(error("unknown-choice", says(&word), field).suggest(&word, known))
    }

    /// The block `sections`, but for found sections and reports.
    pub fn section_rules(&mut self, block: Option<&Block>) -> SectionRules {
        let mut rules = SectionRules {
            whole_records: false,
            find: None,
            computed: Vec::new(),
            margin: None,
            keep: None,
            zone: None,
            only: None,
            only_words: String::new(),
            faulty: OnFault::NotUsed,
            minimum: 1,
            most_removed: None,
            reports: Vec::new(),
            percentiles: Method::Linear,
        };
        let Some(block) = block else { return rules };
        if let Some(field) = block.field("use") {
            // How sections are found is looked at when all names are known.
            let uses = [("sections", false), (FOUND_SECTIONS, false), ("whole records", true)];
            let whole = self.one_of(field, &uses, |word| format!("`use` cannot be `{word}`"));
            rules.whole_records = whole == Some(true);
        }
        if let Some(field) = block.field("zone") {
            let name = normalised(&field.value.text);
            rules.zone = self.column_called("column", &name, &field.value.span);
        }
        if let Some(field) = block.field("where") {
            rules.only = self.section_condition(field);
            rules.only_words = normalised(&field.value.text);
        }
        if let Some(faulty) = self.on_fault(block, "faulty", &["not used", "stop", "note"]) {
            rules.faulty = faulty;
        }
        if let Some(minimum) = self.count(block, "minimum", 1) {
            rules.minimum = minimum;
        }
        rules.most_removed = block.field("removed").and_then(|field| self.most_removed(field));
        rules.margin = block.field("margin").and_then(|field| self.along_axis(field, false));
        rules.keep = block.field("keep").and_then(|field| self.keep(field));
        if let Some(field) = block.field("percentiles") {
            let methods = Method::NAMES.map(|(method, name)| (name, method));
            let method =
                self.one_of(field, &methods, |word| format!("`{word}` is not a percentile rule"));
            rules.percentiles = method.unwrap_or(Method::Linear);
        }
        rules
    }

    /// `at most 20 %`.
    fn most_removed(&mut self, field: &Field) -> Option<f64> {
        let text = &field.value.text;
        let share = text.strip_prefix(AT_MOST).filter(|rest| rest.starts_with(char::is_whitespace));
        let wrong = |says: String| {
            error("removed", says, field).help("for instance: `removed  at most 20 %`")
        };
        let Some(share) = share.map(str::trim) else {
            return self
                .refuse(wrong(format!("expected `{AT_MOST}`, found `{}`", normalised(text))));
        };
        let from = text.len() - share.len();
        let span = field.value.place(from..text.len());
        let (share, dimension) =
            self.constant(&Text { text: share.into(), span, exact: field.value.exact })?;
        if dimension != Dimension::ONE || !(0.0..1.0).contains(&share) {
            return self.refuse(wrong("a share of the sections is from 0 % to below 100 %".into()));
        }
        Some(share)
    }

    /// A word, or the value of the choice parameter of this name.
    pub fn choice_field(&mut self, field: &Field) -> Option<String> {
        self.choice_word(&normalised(&field.value.text), &field.value.span)
    }

    /// What is subtracted from n in the divisor of the variance.
    pub fn divisor(&mut self, block: Option<&Block>) -> usize {
        let Some(field) = block.and_then(|block| block.field("standard deviation")) else {
            return 1;
        };
        match self.choice_field(field).as_deref().unwrap_or("n-1") {
            "n-1" => 1,
            "n" => 0,
            other => {
                let problem =
                    problem!("unknown-choice", field, "`{other}` is not a divisor of the variance")
                        .help("write `n-1` or `n`");
                self.tell(problem);
                1
            }
        }
    }

    /// What counts as an independent unit, for n and for confidence intervals.
    pub fn independent(&mut self, block: Option<&Block>) -> Independent {
        let Some(field) = block.and_then(|block| block.field("independent")) else {
            return Independent::Site;
        };
        let Some(word) = self.choice_field(field) else { return Independent::Site };
        let column = self.campaign_column(&word, &field.value.span);
        match (word.as_str(), column) {
            ("site", _) => Independent::Site,
            ("section", _) => Independent::Section,
            (_, Some(index)) => Independent::Column(index),
            _ => {
                let known = self.names.columns.iter().map(|datum| datum.name.as_str());
                let known = known.chain(["site", "section", "campaign"]);
                self.tell(
                    problem!(
                        "unknown-name",
                        field,
                        "`{word}` is neither `site`, `section` nor a section column"
                    )
                    .suggest(&word, known),
                );
                Independent::Site
            }
        }
    }

    /// The zones of the protocol and the words of the zone column must agree; otherwise some
    /// sections would have no zone.
    pub fn zones_match(&mut self, rules: &SectionRules) {
        let Some(index) = rules.zone else {
            if let Some(block) = self.blocks.iter().find(|block| block.kind.text == "zone") {
                let says = "there are zones, but no section column states the zone of a section";
                let help = "add to `sections`: `zone zone`";
                self.tell(error("no-zone-column", says, block).help(help));
            }
            return;
        };
        let datum = self.names.columns[index].clone();
        let DatumKind::Words(words) = &datum.kind else {
            self.tell(
                error("zone-column", "the zone column must be a choice of words", &datum.span)
                    .help("write `one of zones`, which stands for the names of the zone blocks"),
            );
            return;
        };
        self.zone = Some(Expr {
            kind: Kind::Column(index),
            ty: Type::Word(words.clone()),
            span: Origin { span: datum.span.clone(), words: datum.name.as_str().into() },
        });
        for word in words.iter().filter(|word| !self.zone_names.contains(word)) {
            self.problems.push(
                problem!(
                    "unknown-zone",
                    &datum.span,
                    "sections may be of zone {word}, which has no block"
                )
                .help(format!(
                    "add a block `zone {word}`, or declare the column with `one of zones`"
                )),
            );
        }
        let strange = |block: &&Block| !words.iter().any(|word| word == block.name_text());
        for block in self.blocks.iter().filter(|block| block.kind.text == "zone").filter(strange) {
            self.problems.push(
                problem!("unknown-zone", block, "no section can be of zone {}", block.name_text())
                    .also(&datum.span, "its words are those of the zone column")
                    .help("declare the column with `one of zones`"),
            );
        }
    }
}
