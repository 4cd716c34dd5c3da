//! What the rules of a protocol read beside the nodes of the graph.

use crate::run::prelude::*;

/// The expressions of a rule, and the columns by which it groups sections.
#[derive(Default)]
pub struct Reads<'a> {
    pub exprs: Vec<&'a Expr>,
    pub columns: Vec<usize>,
}

/// The rules, each with its name, whether it is a quantity, and what it reads.
pub fn rules(plan: &Plan) -> Vec<(String, bool, Reads<'_>)> {
    let mut rules: Vec<(String, bool, Reads<'_>)> = Vec::new();
    for rule in &plan.quantities {
        let mut reads = Reads::default();
        reads.quantity(rule);
        rules.push((rule.id.clone(), true, reads));
    }
    let mut add = |name: String, reads| rules.push((name, false, reads));
    let mut sections = Reads::default();
    sections.columns.extend(plan.sections.zone);
    sections.exprs.extend(&plan.sections.only);
    plan.sections.reports.iter().for_each(|report| sections.report(report));
    add("sections".into(), sections);
    if let Some(find) = &plan.sections.find {
        for datum in find.data.iter().filter(|datum| !plan.columns[datum.column].computed) {
            add(format!("found {}", plan.columns[datum.column].key), Reads::signals(&datum.of));
        }
        for condition in &find.conditions {
            add(format!("find {}", condition.name), Reads::signals(&condition.require));
        }
        let mut rest = Reads::default();
        rest.exprs.extend(&find.length);
        find.prefer.iter().for_each(|prefer| rest.of_section(prefer));
        add("find".into(), rest);
    }
    if let Some(keep) = &plan.sections.keep {
        add("keep".into(), Reads { columns: keep.each.clone(), ..Reads::default() });
    }
    for zone in &plan.zones {
        let exprs = zone.condition.iter().chain(&zone.minimum_length).collect();
        add(format!("zone {}", zone.name), Reads { exprs, ..Reads::default() });
    }
    for check in &plan.checks {
        let exprs = std::iter::once(&check.require).chain(&check.unless).collect();
        let mut reads = Reads { exprs, ..Reads::default() };
        reads.inputs(&check.inputs);
        add(format!("check {}", check.name), reads);
    }
    for rule in &plan.plausibility {
        let signals = rule.signals.iter().map(|(_, signal)| signal);
        let mut reads = Reads { exprs: signals.chain(&rule.unless).collect(), ..Reads::default() };
        if let Test::Require(requirement) = &rule.test {
            reads.exprs.push(&requirement.holds);
            reads.inputs(&requirement.inputs);
        }
        add(format!("plausibility {}", rule.name), reads);
    }
    for domain in &plan.domains {
        let exprs = domain.over.iter().map(|coordinate| &coordinate.expr).collect();
        add(format!("domain {}", domain.name), Reads { exprs, columns: domain.each.clone() });
    }
    if let Independent::Column(index) = plan.independent {
        add("verdict".into(), Reads { columns: vec![index], ..Reads::default() });
    }
    rules
}

impl<'a> Reads<'a> {
    fn signals(of: &'a OfSection) -> Self {
        let mut reads = Self::default();
        reads.of_section(of);
        reads
    }

    fn quantity(&mut self, rule: &'a Quantity) {
        self.exprs.extend(&rule.only);
        for position in &rule.positions {
            self.exprs.push(&position.signal);
            self.exprs.extend(&position.only);
        }
        match rule.evaluation.as_ref() {
            Evaluation::Values { values, records } => {
                values.iter().for_each(|value| self.valued(value));
                match records {
                    Records::Compared { difference, .. } | Records::Spread { difference, .. } => {
                        self.exprs.push(difference)
                    }
                    Records::Of(_) => {}
                }
            }
            Evaluation::Metric { over, .. } => self.exprs.extend(over),
            Evaluation::Combined { of, .. } => self.valued(of),
        }
        rule.limits.iter().for_each(|limit| self.limit(limit));
        rule.reports.iter().for_each(|report| self.report(report));
        rule.minimum_of_groups.iter().for_each(|minimum| self.scope(&minimum.scope));
    }

    fn of_section(&mut self, of: &'a OfSection) {
        self.exprs.push(&of.expr);
        self.inputs(&of.inputs);
    }

    fn valued(&mut self, value: &'a Valued) {
        self.exprs.push(&value.expr);
        value.inputs.iter().for_each(|inputs| self.inputs(inputs));
    }

    fn inputs(&mut self, inputs: &'a [Input]) {
        self.exprs.extend(inputs.iter().flat_map(|input| input.signal.iter().chain(&input.over)));
    }

    fn limit(&mut self, limit: &'a Limit) {
        self.estimate(&limit.estimate);
        self.of_group(&limit.bound);
        let factors = limit.factors.iter().flat_map(|(factor, when)| [factor, when]);
        self.exprs.extend(factors.chain(&limit.only_when));
        self.scope(&limit.scope);
    }

    fn report(&mut self, report: &'a Report) {
        self.estimate(&report.estimate);
        self.scope(&report.scope);
    }

    fn scope(&mut self, scope: &'a Scope) {
        self.exprs.extend(scope.condition.iter().map(|(condition, _)| condition));
        self.keys(&scope.each);
    }

    fn keys(&mut self, keys: &[Key]) {
        self.columns.extend(keys.iter().filter_map(|key| match key {
            Key::Column(index) => Some(index),
            _ => None,
        }));
    }

    fn estimate(&mut self, of: &'a Estimate) {
        if let EstimateKind::Of(group) = &of.kind {
            self.of_group(group);
        }
    }

    fn of_group(&mut self, group: &'a OfGroup) {
        self.exprs.push(&group.expr);
        group.taken.iter().for_each(|taken| self.taking(taken));
    }

    fn taking(&mut self, of: &'a Taking) {
        match of {
            Taking::Bound { of, .. } => self.estimate(of),
            Taking::Weighted { by, .. } => self.exprs.push(by),
            Taking::EachGroup { keys, of, .. } => {
                self.keys(keys);
                self.of_group(of);
            }
            Taking::Where { condition, others, by, .. } => {
                self.exprs.push(condition);
                self.exprs.extend(by);
                others.iter().for_each(|other| self.taking(other));
            }
            Taking::Data { of, by, .. } => {
                self.exprs.push(of);
                self.exprs.extend(by);
            }
            Taking::Fit(fit) => {
                self.exprs.extend(&fit.over);
                fit.at.iter().for_each(|at| self.of_group(at));
            }
            Taking::Statistic(..) | Taking::Count | Taking::Other { .. } => {}
        }
    }
}
