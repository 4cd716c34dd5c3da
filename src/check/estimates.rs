//! Checks estimates: expressions over the values of a group of rows and over the data of its
//! sections.

use super::prelude::*;
use crate::catalog::{STATISTICS, Statistic};
use crate::syntax::phrase::Counted;

/// Name of the number of independent units of a group.
const COUNT: &str = "n";

/// Statistics that depend on weights, beside percentiles.
const WITH_WEIGHTS: [&str; 4] = ["mean", "std", "rms", "median"];

/// Whether values can count by a weight in a statistic.
pub fn has_weights(statistic: Statistic) -> bool {
    match statistic {
        Statistic::Each => false,
        Statistic::Percentile(_) => true,
        Statistic::Named(entry) => WITH_WEIGHTS.contains(&entry.name),
    }
}

/// The name of a statistic as written: `p95`, `mean`.
pub fn reducer_name(reducer: &Phrase) -> String {
    match &reducer.node {
        Node::Percentile(percent) => format!("p{percent}"),
        Node::Path(path) => path.clone(),
        _ => String::new(),
    }
}

impl Checker<'_> {
    /// The estimate of a limit, in one zone if it is for each. Without a dimension (values that
    /// have an error), only names are checked.
    pub fn estimate(
        &mut self,
        name: &At<String>,
        phrase: &Phrase,
        dimension: Option<Dimension>,
        zone: Option<&str>,
    ) -> Option<Estimate> {
        let plain = bare(&name.node);
        if let Node::Path(_) | Node::Percentile(_) = phrase.node
            && !self.names.estimates.contains_key(&plain)
            && plain != COUNT
        {
            return self.statistic(&name.with(plain)).map(|statistic| self.of_statistic(statistic));
        }
        let kind = self.of_values(phrase, dimension?, zone)?;
        self.named_estimate(&plain, kind, dimension)
    }

    /// An expression over a group with its name, title and unit. `values` is the dimension of the
    /// values, if there are any.
    pub fn named_estimate(
        &self,
        name: &str,
        kind: OfGroup,
        values: Option<Dimension>,
    ) -> Option<Estimate> {
        let block = self.blocks_of("estimate").find(|block| block.name_text() == name);
        let title = block.and_then(Block::title_text).unwrap_or_else(|| self.with_values(name));
        let of_scatter = match &kind.taken[..] {
            [Taking::Bound { of, .. }] => of.of_scatter,
            [Taking::Weighted { statistic, .. }] => statistic.of_scatter(),
            _ => false,
        };
        let of_scatter = of_scatter && matches!(kind.expr.kind, Kind::Input(0));
        let Type::Number(found) = kind.expr.ty else { return None };
        let of_data = kind.taken.iter().find_map(|taking| match taking {
            Taking::Data { of, .. } => self.datum_unit(of, found),
            _ => None,
        });
        let unit =
            (Some(found) != values).then(|| of_data.unwrap_or_else(|| self.own_unit("", found)));
        Some(Estimate {
            name: name.to_string(),
            title,
            kind: EstimateKind::Of(Box::new(kind)),
            of_scatter,
            unit,
        })
    }

    pub fn of_statistic(&self, statistic: Statistic) -> Estimate {
        let kind = match statistic {
            Statistic::Each => EstimateKind::Each,
            statistic => {
                let source = crate::source::Source::new("statistic", statistic.name());
                let span = Origin { span: source.whole(), words: statistic.name().into() };
                let expr = Expr::number(Kind::Input(0), Dimension::ONE, &span);
                let taken = vec![Taking::Statistic(statistic, self.ddof)];
                EstimateKind::Of(Box::new(OfGroup { expr, taken }))
            }
        };
        Estimate {
            name: statistic.name(),
            title: statistic.title(self.ddof),
            kind,
            of_scatter: statistic.of_scatter(),
            unit: None,
        }
    }

    /// An expression over the values of a group. It must have the dimension of the values.
    pub fn of_values(
        &mut self,
        phrase: &Phrase,
        dimension: Dimension,
        zone: Option<&str>,
    ) -> Option<OfGroup> {
        let found = self.of_group(phrase, Some(dimension), &Scope::zone(zone))?;
        let says = "this expression uses no statistic of the values";
        self.of_something(found, says, "for instance `mean + 3 * std`")
    }

    /// A number that uses something of a group.
    pub fn of_something(&mut self, found: OfGroup, says: &str, help: &str) -> Option<OfGroup> {
        if found.taken.is_empty() {
            return self.refuse(error("estimate-of-nothing", says, &found.expr).help(help));
        }
        self.number_type(&found.expr)?;
        Some(found)
    }

    /// An expression over a group; the scope `with` gives the other names it can use.
    pub fn of_group(
        &mut self,
        phrase: &Phrase,
        values: Option<Dimension>,
        with: &Scope,
    ) -> Option<OfGroup> {
        let mut scope = with.of_group(values);
        let expr = self.expr(phrase, &mut scope)?;
        Some(OfGroup { expr, taken: scope.group.map_or_else(Vec::new, |group| group.taken) })
    }

    /// The statistic of a name; a problem where there is none.
    pub fn statistic(&mut self, written: &At<String>) -> Option<Statistic> {
        let found = Statistic::named(&written.node);
        if found.is_none() && !self.is_failed(&written.node) {
            let name = &written.node;
            if let Some(percent) = name.strip_prefix('p').and_then(|percent| percent.parse().ok()) {
                self.is_percentage(percent, written)?;
            }
            let known = STATISTICS.iter().map(|entry| entry.name).chain(["each"]);
            let known = known.chain(self.names.estimates.keys().map(String::as_str));
            self.tell(
                problem!("unknown-statistic", written, "`{name}` is not a statistic")
                    .suggest(name, known),
            );
        }
        found
    }

    /// A statistic of many values. `each` is none: it stands for every single value.
    pub fn not_each(
        &mut self,
        statistic: Statistic,
        of: &str,
        at: &impl Located,
    ) -> Option<Statistic> {
        if statistic != Statistic::Each {
            return Some(statistic);
        }
        self.refuse(problem!(
            "each-value",
            at,
            "`each` stands for every single value and is not a statistic of a {of}"
        ))
    }

    /// A name with a meaning in a group: a statistic, `n`, an estimate.
    pub fn group_path(
        &mut self,
        path: &str,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Option<Expr>> {
        scope.group.as_ref()?;
        if let Some(written) = self.names.estimates.get(path).cloned() {
            self.used_defines.insert(format!("estimate {path}"));
            self.unconfirmed |= self.values.open(path);
            return Some(self.estimate_named(path, &written, span, scope));
        }
        let dimension = scope.values()?;
        let counts = path == COUNT
            && !self.names.parameter_blocks.contains_key(path)
            && (scope.limits.is_none() || !self.is_declared(path));
        let statistic = Statistic::named(path);
        if (counts || statistic.is_some()) && self.like_a_limit(path, span, scope) {
            return Some(None);
        }
        if counts {
            return Some(scope.take(Taking::Count, Dimension::ONE, span));
        }
        let statistic = statistic?;
        Some(self.not_each(statistic, "group", span).and_then(|statistic| {
            scope.take(Taking::Statistic(statistic, self.ddof), dimension, span)
        }))
    }

    fn estimate_named(
        &mut self,
        name: &str,
        written: &Phrase,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let limits = scope.limits.take();
        let found = self.inside("estimate", name, span, |checker| checker.expr(written, scope));
        scope.limits = limits;
        found
    }

    /// A percentile of the values of a group, such as `p95`.
    pub fn group_percentile(
        &mut self,
        percent: f64,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let Some(dimension) = scope.values() else { return self.no_values(span) };
        self.is_percentage(percent, span)?;
        if self.like_a_limit(&format!("p{percent}"), span, scope) {
            return None;
        }
        let taking = Taking::Statistic(Statistic::Percentile(percent), self.ddof);
        scope.take(taking, dimension, span)
    }

    /// A number of the sections of a group: `mean of radius`, `total of length`, `mean of radius
    /// weighted by length`.
    pub fn group_data(
        &mut self,
        reducer: &Phrase,
        of: &Phrase,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let found = self.group_reducer(reducer, "the sections of a group")?;
        // `mean of radius weighted by length` reads as `mean of (radius weighted by length)`.
        let (of, by) = match &of.node {
            Node::Weighted(of, by) => (of.as_ref(), Some(by.as_ref())),
            _ => (of, None),
        };
        if let Node::Path(signal) = &of.node
            && self.is_signal(signal)
        {
            let name = reducer_name(reducer);
            let help = "here only section data can be used: `mean of radius`";
            return self.refuse(problem!("no-records", span, "`{name} of {signal}` needs the records of a section, which are not available here").help(help));
        }
        let by = match (by, found) {
            (None, _) => None,
            (Some(by), DataReducer::Statistic(statistic, _)) if has_weights(statistic) => {
                Some(self.weight(by, scope)?)
            }
            (Some(_), _) => {
                let what = format!("the {} of section data", reducer_name(reducer));
                return self.no_weight(&what, span);
            }
        };
        let of_rows = scope.values().is_some() && self.names_value(of);
        let mut names = match of_rows {
            true => scope.of_row(scope.values(), self.grouped.sides),
            false => scope.of_section(),
        };
        let of = self.expr(of, &mut names)?;
        let dimension = self.number_type(&of)?;
        scope.take(Taking::Data { reducer: found, of, of_rows, by }, dimension, span)
    }

    /// A statistic, or `total`.
    pub fn group_reducer(&mut self, reducer: &Phrase, from: &str) -> Option<DataReducer> {
        let name = reducer_name(reducer);
        match (name.as_str(), Statistic::named(&name)) {
            ("total", _) => return Some(DataReducer::Total),
            (_, Some(Statistic::Each) | None) => {}
            (_, Some(statistic)) => return Some(DataReducer::Statistic(statistic, self.ddof)),
        }
        let known = STATISTICS.iter().map(|entry| entry.name).chain(["total"]);
        self.refuse(
            problem!("unknown-statistic", reducer, "`{name} of` cannot be computed over {from}")
                .suggest(&name, known),
        )
    }

    /// The quantity `NAME` in `p80 of NAME`, as its index and the index of its block. Only where
    /// the rows of a group are available. A section datum of the same name has priority.
    pub fn other_quantity(&self, of: &Phrase, scope: &Scope) -> Option<(usize, usize)> {
        let Node::Path(name) = &of.node else { return None };
        let of_rows = scope.group.is_some() || scope.value.is_some();
        if !of_rows || self.is_declared(name) || self.names.parameter_blocks.contains_key(name) {
            return None;
        }
        let blocks = self.blocks.iter().enumerate();
        let quantities = blocks.filter(|(_, block)| block.kind.text == "quantity");
        let mut numbered = quantities.enumerate();
        let found = numbered.find(|(_, (_, block))| block.name_text() == name);
        found.map(|(number, (at, _))| (number, at))
    }

    /// Whether a limit or an estimate uses a value of the quantity. The quantity then has an effect
    /// without a limit of its own.
    pub fn is_referred_to(&self, quantity: &str) -> bool {
        let refers = |field: &Field| {
            let words = field.value.text.split(|c: char| c.is_whitespace() || "()".contains(c));
            let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
            words.windows(2).any(|pair| pair == ["of", quantity])
        };
        let is_estimate = |block: &Block, field: &Field| match field.key.text.as_str() {
            "limit" | "report" => true,
            "is" => block.kind.text == "estimate",
            _ => false,
        };
        self.blocks.iter().any(|block| {
            block.fields.iter().any(|field| is_estimate(block, field) && refers(field))
        })
    }

    /// In a condition on one value, `p80 of ...` must name another quantity.
    pub fn no_such_quantity(&mut self, of: &Phrase, span: &Span) -> Option<Expr> {
        let name = of.words();
        let quantities = self.blocks_of("quantity").map(Block::name_text);
        self.refuse(
            problem!("no-such-quantity", span, "`{name}` is not a quantity that can be used here")
                .suggest(&name, quantities),
        )
    }

    /// A statistic of all rows of another quantity: `p80 of misfit_of_repeats`. Estimates of the
    /// other quantity cannot be used, so no two quantities can depend on each other.
    pub fn of_other(
        &mut self,
        reducer: &Phrase,
        of: &Phrase,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let (quantity, block) = self.other_quantity(of, scope)?;
        let name = reducer_name(reducer);
        if self.names.estimates.contains_key(&name) {
            let help = "use a statistic of the other quantity: `p80 of ...`, `mean of ...`";
            return self.refuse(
                problem!(
                    "unknown-statistic",
                    reducer,
                    "`{name}` is an estimate and can only be applied to the values of this quantity"
                )
                .help(help),
            );
        }
        let statistic = self.statistic(&reducer.with(name))?;
        let statistic = self.not_each(statistic, "quantity", span)?;
        let block = self.blocks.get(block)?.clone();
        let (dimension, _) = self.values_of(&block)?;
        let taking = Taking::Other { quantity, id: block.own_name(), statistic, ddof: self.ddof };
        if scope.group.is_some() {
            return scope.take(taking, dimension, span);
        }
        scope.others.push(taking);
        // Input 0 is the value itself.
        Some(Expr::number(Kind::Input(scope.others.len()), dimension, span))
    }

    /// A share of the values, or their number: `share where value <= 1`.
    pub fn group_share(
        &mut self,
        (counted, of_sections): (Counted, bool),
        condition: &Phrase,
        by: Option<&Phrase>,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        if scope.group.is_none() {
            let says = "a share needs the values of a group, which are not available here";
            return self.refuse(error("no-group", says, span));
        }
        let value = scope.values().filter(|_| !of_sections);
        if value.is_none() && !of_sections {
            return self.no_values(span);
        }
        let sides = self.grouped.sides.filter(|_| !of_sections);
        let mut of_row = scope.of_row(value, sides);
        let condition = self.condition(condition, &mut of_row)?;
        let by = if_written(by.map(|by| self.weight(by, scope)))?;
        let share = match (counted, &by) {
            (Counted::Share, _) => true,
            (Counted::Count, None) => false,
            (Counted::Count, Some(_)) => return self.no_weight("a number of values", span),
            (Counted::LongestRun { .. } | Counted::Crossings, _) => {
                let (what, words) = if counted == Counted::Crossings {
                    ("crossings are those", "crossings")
                } else {
                    ("a longest run is one", "longest run")
                };
                let says = format!("{what} of samples, and these are values of sections");
                let problem = error("run-of-values", says, span);
                return self.refuse(problem.help(format!(
                    "it stands in the `value` of a quantity: `{words} where Q < 10 kN`"
                )));
            }
        };
        let others = of_row.others;
        let taking = Taking::Where { share, condition, of_sections, others, by };
        scope.take(taking, Dimension::ONE, span)
    }

    /// Reports an estimate where there are no values.
    pub fn no_values(&mut self, span: &Span) -> Option<Expr> {
        self.refuse(error("no-group", "this estimate needs values of a group, which are not available here", span)
                .help("write it in a quantity: `limit (mean + 3 * std) 60 kN`, or `report (mean + 3 * std)`"))
    }
}

/// The words without an outer pair of parentheses.
pub fn bare(words: &str) -> String {
    let inside = words.strip_prefix('(').and_then(|rest| rest.strip_suffix(')'));
    let whole = |inside: &&str| {
        let mut depth = 0_i32;
        inside.chars().all(|c| {
            depth += i32::from(c == '(') - i32::from(c == ')');
            depth >= 0
        })
    };
    inside.filter(whole).unwrap_or(words).to_string()
}
