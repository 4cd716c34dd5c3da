//! The parts of rules: what expressions and signals each of them holds.

use crate::check::plan::{
    Estimate, EstimateKind, Evaluation, Expr, Input, Key, Kind, Limit, OfGroup, OfSignals,
    Quantity, Records, Report, Scope, Taking, Valued,
};
use crate::units::Unit;

/// Parts of rules: expressions, and columns of records with channel and unit.
pub(super) trait See {
    fn expr(&mut self, expr: &Expr);
    fn column(&mut self, _index: usize) {}
    fn channel(&mut self, _column: &str, _channel: &str, _unit: &Unit, _track: bool) {}
}

pub(super) fn quantity(rule: &Quantity, see: &mut dyn See) {
    rule.only.iter().for_each(|only| see.expr(only));
    for position in &rule.positions {
        signal(&position.signal, see);
        position.only.iter().for_each(|only| see.expr(only));
    }
    match rule.evaluation.as_ref() {
        Evaluation::Values { values, records } => {
            values.iter().for_each(|value| valued(value, see));
            match records {
                Records::Compared { difference, .. } | Records::Spread { difference, .. } => {
                    see.expr(difference)
                }
                Records::Of(_) => {}
            }
        }
        Evaluation::Metric { over, .. } => over.iter().for_each(|part| signal(part, see)),
        Evaluation::Combined { of, .. } => valued(of, see),
    }
    rule.limits.iter().for_each(|one| limit(one, see));
    rule.reports.iter().for_each(|one| report(one, see));
    rule.minimum_of_groups.iter().for_each(|minimum| scope(&minimum.scope, see));
}

pub(super) fn of_signals(of: &OfSignals, see: &mut dyn See) {
    see.expr(&of.expr);
    of.inputs.iter().for_each(|part| input(part, see));
}

fn valued(value: &Valued, see: &mut dyn See) {
    see.expr(&value.expr);
    value.inputs.iter().flatten().for_each(|part| input(part, see));
}

pub(super) fn input(input: &Input, see: &mut dyn See) {
    input.signal.iter().chain(&input.over).for_each(|part| signal(part, see));
}

pub(super) fn signal(of: &Expr, see: &mut dyn See) {
    of.visit(&mut |part| {
        if let Kind::Channel { column, channel, unit } = &part.kind {
            see.channel(column, channel, unit, part.track());
        }
    });
    see.expr(of);
}

fn limit(limit: &Limit, see: &mut dyn See) {
    estimate(&limit.estimate, see);
    of_group(&limit.bound, see);
    limit
        .factors
        .iter()
        .flat_map(|(factor, when)| [factor, when])
        .chain(&limit.only_when)
        .for_each(|part| see.expr(part));
    scope(&limit.scope, see);
}

pub(super) fn report(report: &Report, see: &mut dyn See) {
    estimate(&report.estimate, see);
    scope(&report.scope, see);
}

fn scope(scope: &Scope, see: &mut dyn See) {
    scope.condition.iter().for_each(|(condition, _)| see.expr(condition));
    keys(&scope.each, see);
}

fn keys(keys: &[Key], see: &mut dyn See) {
    for key in keys {
        if let Key::Column(index) = key {
            see.column(*index);
        }
    }
}

fn estimate(of: &Estimate, see: &mut dyn See) {
    if let EstimateKind::Of(group) = &of.kind {
        of_group(group, see);
    }
}

fn of_group(group: &OfGroup, see: &mut dyn See) {
    see.expr(&group.expr);
    group.taken.iter().for_each(|taken| taking(taken, see));
}

fn taking(of: &Taking, see: &mut dyn See) {
    match of {
        Taking::Bound { of, .. } => estimate(of, see),
        Taking::Weighted { by, .. } => see.expr(by),
        Taking::EachGroup { keys: each, of, .. } => {
            keys(each, see);
            of_group(of, see);
        }
        Taking::Share { condition, others, by, .. } => {
            see.expr(condition);
            by.iter().for_each(|by| see.expr(by));
            others.iter().for_each(|other| taking(other, see));
        }
        Taking::Data { of, by, .. } => {
            see.expr(of);
            by.iter().for_each(|by| see.expr(by));
        }
        Taking::Fit(fit) => {
            fit.over.iter().for_each(|part| see.expr(part));
            fit.at.iter().for_each(|part| of_group(part, see));
        }
        Taking::Statistic(..) | Taking::Count | Taking::Other { .. } => {}
    }
}
