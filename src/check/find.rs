//! Checks how sections are found in the runs of a campaign: data, conditions, length; and how many
//! of them are kept.

use super::{evaluate::is_whole, prelude::*, quantities::MOST_COUNTED};

/// What `use` says of sections that are looked for in runs.
pub const FOUND_SECTIONS: &str = "found sections";
/// Where each field `keep` begins, and what stands before its groups.
pub const AT_MOST: &str = "at most";
/// Fields by which section data follow from others: of found sections, and of all.
const FOUND: &str = "found";
pub const COMPUTED: &str = "is";
const FOR_EACH: &str = " for each ";

impl Checker<'_> {
    /// How sections are found, where the protocol says so.
    pub fn find(
        &mut self,
        block: Option<&Block>,
        rules: &SectionRules,
        zones: usize,
    ) -> Option<Find> {
        let blocks = self.blocks.clone();
        let of = |kind: &'static str| blocks.iter().filter(move |block| block.kind.text == kind);
        let conditions: Vec<&Block> = of("find").collect();
        let used = block
            .and_then(|block| block.field("use"))
            .filter(|field| normalised(&field.value.text) == FOUND_SECTIONS);
        let Some(used) = used else {
            if let Some(first) = conditions.first() {
                self.tell(
                    warning("find-unused", "the protocol has conditions on found sections, and does not look for sections", first).help(format!("write in the block `sections`: `use {FOUND_SECTIONS}`")),
                );
            }
            return None;
        };
        let block = block?;
        let step = match block.field("step") {
            Some(field) => self.along_axis(field, true),
            None => {
                let says = "`sections` has no `step`: where sections are looked for";
                let help = "add the distance between two places that are tried: `step 1 m`";
                self.refuse(error("missing-field", says, used).help(help))
            }
        };
        let length = block.field("length").map(|field| self.found_length(field));
        if length.is_none() && (rules.zone.is_none() || zones == 0) {
            self.tell(
                error("missing-field", "a found section has no length: there is no field `length`, and no zone with a minimum length", used)
                    .help("add `length 100 m`"),
            );
        }
        if length.is_none() && rules.zone.is_some() {
            for zone in of("zone").filter(|block| block.field("minimum length").is_none()) {
                let help = "give the zone a `minimum length`, or `sections` a `length`";
                self.tell(
                    problem!(
                        "missing-field",
                        zone,
                        "a found section of zone {} has no length",
                        zone.name_text()
                    )
                    .help(help),
                );
            }
        }
        let prefer = block
            .field("prefer")
            .filter(|field| normalised(&field.value.text) != "first")
            .map(|field| {
                self.of_section(field, &[]).filter(|of| self.number_type(&of.expr).is_some())
            });
        let data = self.found_data(rules);
        let conditions = all(conditions.into_iter().map(|block| self.find_condition(block)));
        Some(Find {
            step: step?,
            length: if_written(length)?,
            prefer: if_written(prefer)?,
            data: data?,
            conditions: conditions?,
        })
    }

    fn found_length(&mut self, field: &Field) -> Option<Expr> {
        let expr = self.expression(&field.value, &mut Scope::section())?;
        self.length_of_section(expr, field)
    }

    /// An expression for the length of a section, if it has the dimension of the axis.
    pub fn length_of_section(&mut self, expr: Expr, field: &Field) -> Option<Expr> {
        let axis = self.axis_dimension();
        let found = self.number_type(&expr)?;
        if found == axis {
            return Some(expr);
        }
        let unit = self.axis.as_ref().filter(|_| found == Dimension::ONE).map(|axis| &axis.unit);
        let help = unit.map(|unit| format!("write its unit, such as {unit}"));
        self.refuse(
            problem!(
                "unit-mismatch",
                field,
                "the length of a section is {}, this is {}",
                axis.in_words(),
                found.in_words()
            )
            .help_if(help),
        )
    }

    fn find_condition(&mut self, block: &Block) -> Option<FindCondition> {
        let field = self.required(block, "require")?;
        let require = self.of_section(field, &[]).filter(|of| self.flag_type(&of.expr).is_some());
        let mut reach =
            |key: &str| block.field(key).map_or(Some(0.0), |field| self.along_axis(field, false));
        let (lead, tail) = (reach("lead"), reach("tail"));
        Some(FindCondition {
            name: block.own_name(),
            title: block.title_in_words(),
            require: require?,
            lead: lead?,
            tail: tail?,
            span: block.place(),
        })
    }

    /// An expression over values of signals. `words` may stand for themselves.
    fn of_section(&mut self, field: &Field, words: &[String]) -> Option<OfSection> {
        let of_records = Scope::reducing(None, self.axis_dimension());
        let mut scope = Scope { words: words.to_vec(), ..of_records };
        let expr = self.expression(&field.value, &mut scope)?;
        for input in &scope.inputs {
            self.found_before(input)?;
        }
        Some(OfSection { expr, inputs: scope.inputs, words: normalised(&field.value.text) })
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
        let problem = error("find-signal", says, &input.span);
        self.refuse(problem.also_if(needs, "this is known only when the section is found"))
    }

    /// Section data by their fields `found`, and those that are computed: each after those that it
    /// needs.
    fn found_data(&mut self, rules: &SectionRules) -> Option<Vec<DerivedDatum>> {
        let computed = rules.computed.iter().cloned().map(Some);
        let all = computed.chain(self.derived(FOUND, rules.zone)).collect();
        self.in_order("found-loop", all, rules.zone)
    }

    /// Section data by their fields `is`: each after those that it needs.
    pub fn computed_data(&mut self, zone: Option<usize>) -> Option<Vec<DerivedDatum>> {
        let computed = self.derived(COMPUTED, zone);
        self.in_order("computed-loop", computed, None)
    }

    /// Section data by one of the fields `found` and `is`, in the order of the text; `None` after a
    /// problem.
    fn derived(&mut self, key: &str, zone: Option<usize>) -> Vec<Option<DerivedDatum>> {
        let mut all = Vec::new();
        for block in self.blocks.clone().iter().filter(|block| block.kind.text == "section") {
            let columns = &self.names.columns;
            let named = columns.iter().position(|datum| datum.name == block.name_text());
            let (Some(field), Some(column)) = (block.field(key), named) else { continue };
            let datum = columns[column].clone();
            let of = match datum.computed {
                true if key == COMPUTED => {
                    self.computed(block, field, &datum, zone == Some(column))
                }
                // Refused where it is computed.
                true => continue,
                false if zone == Some(column) => {
                    let says = "the zone of a found section follows from the conditions `where` of the zones";
                    self.refuse(error("found-zone", says, &field.key).help("remove the line"))
                }
                false => {
                    // A case that does not apply leaves it without a value, as an empty cell does.
                    self.partial = true;
                    let of = self.of_section(field, &words_of(&datum));
                    self.partial = false;
                    of
                }
            };
            let of = of.filter(|of| self.is_of_datum(&of.expr, &datum, field));
            all.push(of.map(|of| DerivedDatum { column, of }));
        }
        all
    }

    /// The field `is` of a section datum.
    fn computed(
        &mut self,
        block: &Block,
        field: &Field,
        datum: &Datum,
        is_zone: bool,
    ) -> Option<OfSection> {
        if is_zone {
            let says = "the zone of a section is stated in the table of sections, and not computed";
            let help = "remove the line; the field `where` of a zone checks what is stated";
            return self.refuse(error("computed-zone", says, &field.key).help(help));
        }
        let others = [FOUND, "default", "optional", "column"];
        if let Some(other) = others.iter().find_map(|key| block.field(key)) {
            let says = format!("a datum that is computed has no `{}`", other.key.text);
            let problem = error("computed-datum", says, &other.key);
            let problem = problem.also(&field.key, "computed here");
            return self.refuse(problem.help("remove one of the two"));
        }
        let mut scope = Scope { words: words_of(datum), ..Scope::section() };
        let expr = self.expression(&field.value, &mut scope)?;
        Some(OfSection { expr, inputs: Vec::new(), words: normalised(&field.value.text) })
    }

    fn is_of_datum(&mut self, expr: &Expr, datum: &Datum, field: &Field) -> bool {
        let wanted = match &datum.kind {
            DatumKind::Number(unit) => unit.dimension.in_words(),
            DatumKind::Flag => "a condition".to_string(),
            DatumKind::Words(_) | DatumKind::AnyWord | DatumKind::Campaign => "a word".to_string(),
        };
        let fits = match (&datum.kind, &expr.ty) {
            (DatumKind::Number(unit), Type::Number(dimension)) => unit.dimension == *dimension,
            (DatumKind::Words(words), Type::Word(of)) => {
                !of.is_empty() && of.iter().all(|word| words.contains(word))
            }
            (DatumKind::AnyWord, Type::Word(_)) => true,
            (DatumKind::Flag, Type::Flag) => true,
            _ => false,
        };
        if !fits {
            self.tell(
                problem!(
                    "unit-mismatch",
                    field,
                    "`{}` is {wanted}, this is {}",
                    datum.name,
                    expr.ty.in_words()
                )
                .also(&datum.span, "declared here"),
            );
        }
        fits
    }

    fn in_order(
        &mut self,
        code: &'static str,
        all: Vec<Option<DerivedDatum>>,
        zone: Option<usize>,
    ) -> Option<Vec<DerivedDatum>> {
        let sound = all.iter().all(Option::is_some);
        let mut left: Vec<DerivedDatum> = all.into_iter().flatten().collect();
        let mut ordered: Vec<DerivedDatum> = Vec::new();
        while !left.is_empty() {
            let waits = |datum: &DerivedDatum| {
                datum.of.expr.any(&|part| matches!(part.kind, Kind::Column(of) if left.iter().any(|other| other.column == of)))
            };
            let Some(at) = left.iter().position(|datum| !waits(datum)) else {
                let names: Vec<String> = left
                    .iter()
                    .map(|datum| format!("`{}`", self.names.columns[datum.column].name))
                    .collect();
                let span = left[0].of.expr.span.span.clone();
                let help = "let one of them follow from no other: from signals only (`found mean of ...`), or from the table of sections";
                let says = format!("section data need each other: {}", names.join(", "));
                return self.refuse(error(code, says, &span).help(help));
            };
            ordered.push(left.remove(at));
        }
        let is_zone = |part: &Expr| matches!(part.kind, Kind::Column(of) if Some(of) == zone);
        if let Some(part) = ordered.iter().find_map(|datum| datum.of.expr.find(&is_zone)) {
            let at = part.span.span.clone();
            return self.refuse(error("found-zone", "the zone of a found section follows from its data, so its data cannot depend on the zone", &at)
                        .help("use it in a block `find`, where the zone is known"));
        }
        Some(ordered).filter(|_| sound)
    }

    /// A constant along the axis: a step, a margin.
    pub fn along_axis(&mut self, field: &Field, above_zero: bool) -> Option<f64> {
        let (value, dimension) = self.constant(&field.value)?;
        let axis = self.axis_dimension();
        let says = if dimension != axis {
            format!("`{}` is {}, this is {}", field.key.text, axis.in_words(), dimension.in_words())
        } else if value < 0.0 || (above_zero && value == 0.0) {
            let must = if above_zero { "be above zero" } else { "not be below zero" };
            format!("`{}` must {must}", field.key.text)
        } else {
            return Some(value);
        };
        let code = if dimension == axis { "out-of-range" } else { "unit-mismatch" };
        self.refuse(error(code, says, field))
    }

    /// `at most 9 for each zone and country`.
    pub fn keep(&mut self, field: &Field) -> Option<Keep> {
        let text = &field.value.text;
        let wrong = |checker: &mut Self, says: String| {
            let help = "for instance: `keep at most 9 for each zone and country`";
            checker.refuse(error("keep", says, field).help(help))
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
        if dimension != Dimension::ONE || !is_whole(most, 1.0..=MOST_COUNTED) {
            return wrong(self, format!("`{}` is not a number of sections", count.trim()));
        }
        let mut each = Vec::new();
        for name in groups
            .into_iter()
            .flat_map(|groups| groups.split(',').flat_map(|some| some.split(" and ")))
            .map(str::trim)
        {
            let at = part(name).span;
            let index = self.column_called("datum", name, &at)?;
            if matches!(self.names.columns[index].kind, DatumKind::Number(_)) {
                return self.refuse(problem!(
                    "not-a-word",
                    &at,
                    "`{name}` is a number; only a column of words can form groups"
                ));
            }
            each.push(index);
        }
        Some(Keep { most: most as usize, each, words: normalised(text) })
    }
}

/// Words that stand for themselves where the datum is given.
fn words_of(datum: &Datum) -> Vec<String> {
    if let DatumKind::Words(words) = &datum.kind { words.clone() } else { Vec::new() }
}

/// Where a signal needs what is known only of a section: its data, its ends, one of its numbers.
fn needs_section(signal: &Expr) -> Option<Span> {
    let known_later = |part: &Expr| {
        matches!(
            part.kind,
            Kind::Column(_) | Kind::Start | Kind::End | Kind::Level(..) | Kind::Side(_)
        )
    };
    signal.find(&known_later).map(|part| part.span.span.clone())
}
