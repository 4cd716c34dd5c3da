//! Checks estimates without a limit: what of the values of a quantity, and of the data of the
//! sections, is printed.

use super::{
    estimates::{bare, reducer_name},
    groups::Grouped,
    prelude::*,
};
use crate::catalog::Statistic;
use crate::syntax::phrase::Report as Written;

/// What the reports of a block are of.
#[derive(Clone, Copy, Debug)]
enum Of {
    /// The values of a quantity; `None` where they have an error.
    Values(Option<Dimension>),
    /// The sections used.
    Sections,
}

impl Checker<'_> {
    /// The reports of a quantity, after its limits: of the same groups. Where its values have an error (no dimension), all else is
    /// checked.
    pub fn reports(&mut self, block: &Block, dimension: Option<Dimension>) -> Option<Vec<Report>> {
        self.reports_of(block, Of::Values(dimension))
    }

    /// The reports of the sections.
    pub fn reports_of_sections(&mut self, block: Option<&Block>) -> Vec<Report> {
        self.grouped = Grouped::sections();
        block.and_then(|block| self.reports_of(block, Of::Sections)).unwrap_or_default()
    }

    fn reports_of(&mut self, block: &Block, of: Of) -> Option<Vec<Report>> {
        let unconfirmed = self.values.open(&block.own_name());
        let mut reports: Vec<Report> = Vec::new();
        let mut seen: Vec<(Written, &Field)> = Vec::new();
        let mut ok = true;
        for field in block.fields_named("report") {
            let written = from_pest::report(&field.value, &mut Default::default());
            if let Some((_, first)) = seen.iter().find(|(known, _)| Some(known) == written.as_ref())
            {
                let says = "the same is reported twice";
                self.tell(error("duplicate-field", says, field).also(first, "the first"));
                ok = false;
                continue;
            }
            seen.extend(written.map(|written| (written, field)));
            match self.report(field, of, unconfirmed) {
                Some(found) => reports.extend(found),
                None => ok = false,
            }
        }
        ok.then_some(reports)
    }

    /// The reports of a field: one, or one for every zone.
    fn report(&mut self, field: &Field, of: Of, unconfirmed: bool) -> Option<Vec<Report>> {
        let text = &field.value;
        let written = from_pest::report(text, self.problems)?;
        let name = written.of.with(written.of.words());
        let (name, phrase) = self.with_statistic(name, written.of);
        let scope = self.scope_of(&written.scope);
        let mut reports = Vec::new();
        for (scope, zone) in self.zone_by_zone(scope) {
            self.unconfirmed = unconfirmed;
            let estimate = match of {
                Of::Values(dimension) => self.estimate(&name, &phrase, dimension, zone.as_deref()),
                Of::Sections => self.of_sections(&name, &phrase, zone.as_deref()),
            };
            let (mut estimate, scope) = (estimate?, scope?);
            if matches!(estimate.kind, super::plan::EstimateKind::Each) {
                return self.refuse(error("each-value", "`each` stands for every single value, and all values are in the report anyway", &name).help("name a statistic: `report maximum`"));
            }
            if let Some(unit) = &written.unit {
                let values = if let Of::Values(dimension) = of { dimension } else { None };
                estimate.unit = Some(self.unit_of_report(&estimate, unit, values)?);
            }
            if self.unconfirmed {
                estimate.title += self.to_be_confirmed();
            }
            reports.push(Report {
                estimate,
                scope,
                words: self.with_values(&normalised(&text.text)),
                span: text.span.clone(),
            });
        }
        Some(reports)
    }

    /// An expression over data of sections.
    fn of_sections(
        &mut self,
        name: &At<String>,
        phrase: &Phrase,
        zone: Option<&str>,
    ) -> Option<Estimate> {
        let found = self.of_group(phrase, None, &Scope::zone(zone))?;
        let says = "this expression uses no data of the sections";
        let help = "for instance `total of length`, `mean of radius`, `share of sections where radius < 300 m`";
        let found = self.of_something(found, says, help)?;
        self.named_estimate(&bare(&name.node), found, None)
    }

    /// The unit that a report states.
    fn unit_of_report(
        &mut self,
        estimate: &Estimate,
        unit: &At<String>,
        values: Option<Dimension>,
    ) -> Option<Unit> {
        let found = self.unit(&unit.to_text())?;
        let dimension = estimate.unit.as_ref().map(|unit| unit.dimension).or(values)?;
        if found.dimension == dimension {
            return Some(found);
        }
        self.refuse(problem!(
            "unit-mismatch",
            unit,
            "this estimate is {}, `{}` is a unit of {}",
            dimension.in_words(),
            unit.node,
            found.dimension.in_words()
        ))
    }

    /// A choice parameter in place of an estimate stands for the statistic that it names, and a
    /// parameter of a percentile for its number.
    pub fn with_statistic(
        &mut self,
        mut name: At<String>,
        mut estimate: Phrase,
    ) -> (At<String>, Phrase) {
        if let Node::PercentileBy(_) = estimate.node
            && let Some(found) = self.with_percentile(&estimate)
        {
            name.node = reducer_name(&found);
            return (name, found);
        }
        let word = name.node.clone();
        let named = Statistic::named(&word).is_some() || self.names.estimates.contains_key(&word);
        let parameter = self.names.parameter_blocks.contains_key(&word);
        if let (false, true, Node::Path(_)) = (named, parameter, &estimate.node)
            && let Some(choice) = self.choice_word(&word, &name.place())
        {
            estimate.node = match Statistic::named(&choice) {
                Some(Statistic::Percentile(percent)) => Node::Percentile(percent),
                _ => Node::Path(choice.clone()),
            };
            name.node = choice;
        }
        (name, estimate)
    }
}
