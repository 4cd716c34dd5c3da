//! Checks how sections are found in the runs of a campaign: data, conditions, length; and how many
//! of them are kept.

use super::Checker;
use super::names::normalised;
use super::plan::{
    AxisOperation, Datum, DatumKind, Expr, Find, FindCondition, FoundDatum, Input, Keep, Kind,
    OfSignals, SectionRules, Signal, SignalKind, Taken, Type,
};
use super::scalars::in_words;
use super::scope::Scope;
use crate::problem::Problem;
use crate::source::Span;
use crate::syntax::document::{Block, Field, Text};
use crate::syntax::from_pest;
use crate::units::Dimension;

/// What `use` says of sections that are looked for in runs.
pub(super) const FOUND_SECTIONS: &str = "found sections";
/// Where each field `keep` begins, and what stands before its groups.
const AT_MOST: &str = "at most";
const FOR_EACH: &str = " for each ";

impl Checker<'_> {
    /// How sections are found, where the protocol says so.
    pub(super) fn find(
        &mut self,
        block: Option<&Block>,
        rules: &SectionRules,
        zones: usize,
    ) -> Option<Find> {
        let blocks = self.blocks.clone();
        let conditions: Vec<&Block> =
            blocks.iter().filter(|block| block.kind.text == "find").collect();
        let used = block
            .and_then(|block| block.field("use"))
            .filter(|field| normalised(&field.value.text) == FOUND_SECTIONS);
        let Some(used) = used else {
            if let Some(first) = conditions.first() {
                let says =
                    "the protocol has conditions on found sections, and does not look for sections";
                let problem = Problem::warning("find-unused", says).at(first.span());
                self.problems.push(
                    problem.help(format!("write in the block `sections`: `use {FOUND_SECTIONS}`")),
                );
            }
            return None;
        };
        let block = block?;
        let step = match block.field("step") {
            Some(field) => self.along_axis(field, true),
            None => {
                let problem = Problem::error(
                    "missing-field",
                    "`sections` has no `step`: where sections are looked for",
                )
                .at(&used.value.span);
                self.problems.push(
                    problem.help("add the distance between two places that are tried: `step 1 m`"),
                );
                None
            }
        };
        let length = block.field("length").map(|field| self.found_length(field));
        if length.is_none() && (rules.zone.is_none() || zones == 0) {
            let says = "a found section has no length: there is no field `length`, and no zone with a minimum length";
            self.problems.push(
                Problem::error("missing-field", says)
                    .at(&used.value.span)
                    .help("add `length 100 m`"),
            );
        }
        if length.is_none() && rules.zone.is_some() {
            for zone in blocks.iter().filter(|block| {
                block.kind.text == "zone" && block.field("minimum length").is_none()
            }) {
                let says = format!("a found section of zone {} has no length", zone.name_text());
                let help = "give the zone a `minimum length`, or `sections` a `length`";
                self.problems
                    .push(Problem::error("missing-field", says).at(zone.span()).help(help));
            }
        }
        let prefer = match block.field("prefer") {
            None => None,
            Some(field) if normalised(&field.value.text) == "first" => None,
            Some(field) => {
                Some(self.of_signals(field, &[]).filter(|of| self.number_type(&of.expr).is_some()))
            }
        };
        let data = self.found_data(&blocks, rules);
        let conditions: Vec<Option<FindCondition>> =
            conditions.into_iter().map(|block| self.find_condition(block)).collect();
        let (length, prefer) = (
            length.map_or(Some(None), |length| length.map(Some)),
            prefer.map_or(Some(None), |prefer| prefer.map(Some)),
        );
        Some(Find {
            step: step?,
            length: length?,
            prefer: prefer?,
            data: data?,
            conditions: conditions.into_iter().collect::<Option<_>>()?,
        })
    }

    fn found_length(&mut self, field: &Field) -> Option<Expr> {
        let phrase = from_pest::expression(&field.value, self.problems)?;
        let expr = self.expr(&phrase, &field.value, &mut Scope::section())?;
        self.length_of_section(expr, field)
    }

    /// An expression for the length of a section, if it has the dimension of the axis.
    pub(super) fn length_of_section(&mut self, expr: Expr, field: &Field) -> Option<Expr> {
        let axis = self.axis_dimension();
        let found = self.number_type(&expr)?;
        if found == axis {
            return Some(expr);
        }
        let says = format!(
            "the length of a section is {}, this is {}",
            axis.in_words(),
            in_words(&expr.ty)
        );
        let problem = Problem::error("unit-mismatch", says).at(&field.value.span);
        self.problems.push(match (&self.axis, found) {
            (Some(axis), Dimension::ONE) => {
                problem.help(format!("write its unit, such as {}", axis.unit))
            }
            _ => problem,
        });
        None
    }

    fn find_condition(&mut self, block: &Block) -> Option<FindCondition> {
        let field = self.required(block, "require")?;
        let require = self.of_signals(field, &[]).filter(|of| self.flag_type(&of.expr).is_some());
        let mut reach =
            |key: &str| block.field(key).map_or(Some(0.0), |field| self.along_axis(field, false));
        let (lead, tail) = (reach("lead"), reach("tail"));
        Some(FindCondition {
            name: block.name_text().to_string(),
            title: block
                .title
                .as_ref()
                .map_or_else(|| block.name_text().replace('_', " "), |title| title.text.clone()),
            require: require?,
            lead: lead?,
            tail: tail?,
            span: block.span().clone(),
        })
    }

    /// An expression over values of signals. `words` may stand for themselves.
    fn of_signals(&mut self, field: &Field, words: &[String]) -> Option<OfSignals> {
        let phrase = from_pest::expression(&field.value, self.problems)?;
        let axis = self.axis_dimension();
        let mut scope = Scope { words: words.to_vec(), ..Scope::reducing(None, axis) };
        let expr = self.expr(&phrase, &field.value, &mut scope)?;
        for input in &scope.inputs {
            self.found_before(input)?;
        }
        Some(OfSignals { expr, inputs: scope.inputs, words: normalised(&field.value.text) })
    }

    /// Sections are looked for before their data are known: signals cannot use them.
    fn found_before(&mut self, input: &Input) -> Option<()> {
        let both = !matches!(input.taken, Taken::Reduced(_));
        let signals = input.signal.iter().chain(&input.over);
        let needs = signals.filter_map(needs_section).next();
        if !both && needs.is_none() {
            return Some(());
        }
        let says = match both {
            true => "a value taken from both sides cannot be used to find sections",
            false => "a signal that depends on the section cannot be used to find sections",
        };
        let problem = Problem::error("find-signal", says).at(&input.span);
        self.problems.push(match needs {
            Some(at) => problem.also(&at, "this is known only when the section is found"),
            None => problem,
        });
        None
    }

    /// The fields `found` of section data, in an order in which each needs only those before it.
    fn found_data(&mut self, blocks: &[Block], rules: &SectionRules) -> Option<Vec<FoundDatum>> {
        let mut found: Vec<FoundDatum> = Vec::new();
        let mut sound = true;
        for block in blocks.iter().filter(|block| block.kind.text == "section") {
            let Some(field) = block.field("found") else { continue };
            let Some(column) =
                self.names.columns.iter().position(|datum| datum.name == block.name_text())
            else {
                continue;
            };
            if rules.zone == Some(column) {
                let says =
                    "the zone of a found section follows from the conditions `where` of the zones";
                self.problems.push(
                    Problem::error("found-zone", says).at(&field.key.span).help("remove the line"),
                );
                sound = false;
                continue;
            }
            let datum = self.names.columns[column].clone();
            let words =
                if let DatumKind::Words(words) = &datum.kind { words.clone() } else { Vec::new() };
            // A case that does not apply leaves the datum without a value, as an empty cell does.
            self.partial = true;
            let of = self.of_signals(field, &words);
            self.partial = false;
            match of.filter(|of| self.is_of_datum(&of.expr, &datum, field)) {
                Some(of) => found.push(FoundDatum { column, of }),
                None => sound = false,
            }
        }
        let ordered = self.in_order(found, rules.zone);
        ordered.filter(|_| sound)
    }

    fn is_of_datum(&mut self, expr: &Expr, datum: &Datum, field: &Field) -> bool {
        let wanted = match &datum.kind {
            DatumKind::Number(unit) => unit.dimension.in_words(),
            DatumKind::Flag => "a condition".to_string(),
            DatumKind::Words(_) | DatumKind::Campaign => "a word".to_string(),
        };
        let fits = match (&datum.kind, &expr.ty) {
            (DatumKind::Number(unit), Type::Number(dimension)) => unit.dimension == *dimension,
            (DatumKind::Words(words), Type::Word(of)) => of.iter().all(|word| words.contains(word)),
            (DatumKind::Flag, Type::Flag) => true,
            _ => false,
        };
        if !fits {
            let says = format!("`{}` is {wanted}, this is {}", datum.name, in_words(&expr.ty));
            self.problems.push(
                Problem::error("unit-mismatch", says)
                    .at(&field.value.span)
                    .also(&datum.span, "declared here"),
            );
        }
        fits
    }

    fn in_order(
        &mut self,
        mut left: Vec<FoundDatum>,
        zone: Option<usize>,
    ) -> Option<Vec<FoundDatum>> {
        let mut ordered: Vec<FoundDatum> = Vec::new();
        while !left.is_empty() {
            let waits = |datum: &FoundDatum| {
                let mut waits = false;
                datum.of.expr.visit(&mut |part| {
                    waits |= matches!(part.kind, Kind::Column(of) if left.iter().any(|other| other.column == of));
                });
                waits
            };
            let Some(at) = left.iter().position(|datum| !waits(datum)) else {
                let names: Vec<String> = left
                    .iter()
                    .map(|datum| format!("`{}`", self.names.columns[datum.column].name))
                    .collect();
                let says = format!("section data need each other: {}", names.join(", "));
                let span = left[0].of.expr.span.span.clone();
                let help = "let one of them follow from signals only: `mean of ...`";
                self.problems.push(Problem::error("found-loop", says).at(&span).help(help));
                return None;
            };
            ordered.push(left.remove(at));
        }
        for datum in &ordered {
            let mut of_zone: Option<Span> = None;
            datum.of.expr.visit(&mut |part| {
                if matches!(part.kind, Kind::Column(of) if Some(of) == zone) {
                    of_zone = Some(part.span.span.clone());
                }
            });
            if let Some(at) = of_zone {
                let says = "the zone of a found section follows from its data, so its data cannot depend on the zone";
                self.problems.push(
                    Problem::error("found-zone", says)
                        .at(&at)
                        .help("use it in a block `find`, where the zone is known"),
                );
                return None;
            }
        }
        Some(ordered)
    }

    /// A constant along the axis: a step, a margin.
    pub(super) fn along_axis(&mut self, field: &Field, above_zero: bool) -> Option<f64> {
        let (value, dimension) = self.constant(&field.value)?;
        let axis = self.axis_dimension();
        let says = if dimension != axis {
            format!("`{}` is {}, this is {}", field.key.text, axis.in_words(), dimension.in_words())
        } else if value < 0.0 || (above_zero && value == 0.0) {
            format!(
                "`{}` must {}",
                field.key.text,
                if above_zero { "be above zero" } else { "not be below zero" }
            )
        } else {
            return Some(value);
        };
        let code = if dimension == axis { "out-of-range" } else { "unit-mismatch" };
        self.problems.push(Problem::error(code, says).at(&field.value.span));
        None
    }

    /// `at most 9 for each zone and country`.
    pub(super) fn keep(&mut self, field: &Field) -> Option<Keep> {
        let text = &field.value.text;
        let wrong = |checker: &mut Self, says: String| {
            let help = "for instance: `keep at most 9 for each zone and country`";
            checker.problems.push(Problem::error("keep", says).at(&field.value.span).help(help));
            None
        };
        let Some(rest) =
            text.strip_prefix(AT_MOST).filter(|rest| rest.starts_with(char::is_whitespace))
        else {
            return wrong(self, format!("expected `{AT_MOST}`, found `{}`", normalised(text)));
        };
        let (count, groups) =
            rest.split_once(FOR_EACH).map_or((rest, None), |(count, groups)| (count, Some(groups)));
        let part = |part: &str| {
            let from = part.as_ptr() as usize - text.as_ptr() as usize;
            Text {
                text: part.to_string(),
                span: field.value.place(from..from + part.len()),
                exact: field.value.exact,
            }
        };
        let (most, dimension) = self.constant(&part(count.trim()))?;
        if dimension != Dimension::ONE || most.fract() != 0.0 || !(1.0..=1e6).contains(&most) {
            return wrong(self, format!("`{}` is not a number of sections", count.trim()));
        }
        let mut each = Vec::new();
        for name in groups
            .into_iter()
            .flat_map(|groups| groups.split(',').flat_map(|some| some.split(" and ")))
            .map(str::trim)
        {
            let at = part(name).span;
            match self.names.columns.iter().position(|datum| datum.name == name) {
                Some(index) if !matches!(self.names.columns[index].kind, DatumKind::Number(_)) => {
                    each.push(index)
                }
                Some(_) => {
                    let says =
                        format!("`{name}` is a number; only a column of words can form groups");
                    self.problems.push(Problem::error("not-a-word", says).at(&at));
                    return None;
                }
                None => {
                    let known: Vec<String> =
                        self.names.columns.iter().map(|datum| datum.name.clone()).collect();
                    let problem = Problem::error(
                        "unknown-name",
                        format!("no section datum is called `{name}`"),
                    )
                    .at(&at);
                    self.problems.push(problem.suggest(name, known.iter().map(String::as_str)));
                    return None;
                }
            }
        }
        Some(Keep { most: most as usize, each, words: normalised(text) })
    }
}

/// Where a signal needs what is known only of a section: its data, its ends, one of its numbers.
fn needs_section(signal: &Signal) -> Option<Span> {
    let of_expr = |expr: &Expr| {
        let mut found = None;
        expr.visit(&mut |part| {
            if matches!(part.kind, Kind::Column(_) | Kind::Start | Kind::End) {
                found = Some(part.span.span.clone());
            }
        });
        found
    };
    match &signal.kind {
        SignalKind::Column { .. } => None,
        SignalKind::Scalar(expr) => of_expr(expr),
        SignalKind::Binary(_, left, right) => needs_section(left).or_else(|| needs_section(right)),
        SignalKind::Negative(inner)
        | SignalKind::Power(inner, _)
        | SignalKind::Filtered(inner, _) => needs_section(inner),
        SignalKind::Call(_, arguments) => arguments.iter().find_map(needs_section),
        SignalKind::OverAxis(AxisOperation::Shifted(distance), inner) => {
            of_expr(distance).or_else(|| needs_section(inner))
        }
        SignalKind::OverAxis(_, inner) => needs_section(inner),
        SignalKind::Level(..) | SignalKind::Side(_) => Some(signal.span.clone()),
        SignalKind::Select(arms, otherwise) => arms
            .iter()
            .find_map(|(condition, signal)| of_expr(condition).or_else(|| needs_section(signal)))
            .or_else(|| otherwise.as_deref().and_then(needs_section)),
    }
}
