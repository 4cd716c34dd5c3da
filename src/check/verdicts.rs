//! Checks verdicts: the quantities they use, their rule and their words.

use std::collections::BTreeSet;

use super::{
    evaluate::is_whole,
    outcomes::{NEITHER, bare, ends, outcomes_told, says_passed},
    prelude::*,
};
use crate::syntax::phrase::{Needed, Outcome, OverVerdicts, Verdict as Written};

/// Words of the verdict without a name.
const VALIDATED: [&str; 2] = ["validated", "not validated"];
/// Words of a verdict with a name.
const HOLDS: [&str; 2] = ["holds", "does not hold"];
/// Words in `of` that stand for all quantities of a kind.
const KINDS: [&str; 3] = ["measured", "simulated", "compared"];

/// Names of the verdicts that a rule can use, and the index of the first of them in the plan.
struct Names {
    names: Vec<String>,
    first: usize,
}

/// Smallest share of draws in which a rule may have to hold: a rule that fails in most of them is
/// usually one whose share was written the wrong way round.
const LEAST_DRAWS: f64 = 0.5;

/// Every limit of some quantities.
fn every(quantities: Vec<usize>) -> Decision {
    Decision::Limits { rule: Rule::EveryLimit, quantities, draws: None }
}

impl Checker<'_> {
    /// All verdicts of the protocol, the overall one first.
    pub fn verdicts(
        &mut self,
        unnamed: Option<&Block>,
        head: &Block,
        quantities: &[Quantity],
    ) -> Vec<VerdictRule> {
        let blocks: Vec<Block> =
            self.blocks_of("verdict").filter(|block| block.name.is_some()).cloned().collect();
        let first = usize::from(unnamed.is_some() || blocks.is_empty());
        let names = Names { names: blocks.iter().map(|block| block.own_name()).collect(), first };
        let mut verdicts = Vec::new();
        if first == 1 {
            verdicts.push(self.without_name(unnamed, head, quantities, &names));
        }
        verdicts.extend(blocks.iter().map(|block| self.with_name(block, quantities, &names)));
        let mut done = BTreeSet::new();
        for (at, block) in blocks.iter().enumerate() {
            self.follow(first + at, &verdicts, &block.place(), &mut done);
        }
        self.without_verdict(quantities, &verdicts);
        verdicts
    }

    fn without_name(
        &mut self,
        block: Option<&Block>,
        head: &Block,
        quantities: &[Quantity],
        names: &Names,
    ) -> VerdictRule {
        let all: Vec<usize> = (0..quantities.len()).collect();
        let all_of = all.clone();
        let outcomes =
            block.and_then(|block| self.outcomes(block, &all_of, None, quantities, names));
        let (words, own_words) = match &outcomes {
            Some(grades) => (ends(grades), true),
            None => self.verdict_words(block, VALIDATED),
        };
        let field = block.and_then(|block| block.field("validated"));
        let rule =
            field.map_or("when every limit holds".into(), |field| normalised(&field.value.text));
        let decision = match (outcomes, field) {
            (Some(grades), _) => Decision::Ordered(grades),
            (_, Some(field)) => self.decision(field, all, None, quantities, names),
            _ => every(all),
        };
        VerdictRule {
            name: None,
            title: block.and_then(Block::title_text).unwrap_or_else(|| "Verdict".into()),
            criterion: match &decision {
                Decision::Ordered(_) => outcomes_told(block),
                _ => format!("{} {rule}", words[0]),
            },
            decision,
            words,
            own_words,
            clause: None,
            source: None,
            notes: block.map_or_else(Vec::new, Block::notes),
            span: block.unwrap_or(head).place(),
        }
    }

    fn with_name(&mut self, block: &Block, quantities: &[Quantity], names: &Names) -> VerdictRule {
        let of = block.field("of");
        let about = self.about(of, quantities);
        let outcomes = self.outcomes(block, &about, of, quantities, names);
        let (words, own_words) = match &outcomes {
            Some(grades) => (ends(grades), true),
            None => self.verdict_words(Some(block), HOLDS),
        };
        let (holds, person) = (block.field("holds"), block.field("judged by"));
        let mut criterion = holds.map_or_else(String::new, |field| {
            format!("{} {}", words[0], normalised(&field.value.text))
        });
        if let Some(of) = of {
            criterion = format!("{criterion} (of {})", normalised(&of.value.text));
        }
        let decision = match (holds, person) {
            _ if let Some(grades) = outcomes => {
                if let Some(other) = holds.or(person) {
                    let says = "a verdict has either outcomes or one rule";
                    self.tell(error("verdict-rule", says, &other.key));
                }
                criterion = outcomes_told(Some(block));
                Decision::Ordered(grades)
            }
            (Some(field), None) => self.decision(field, about, of, quantities, names),
            (None, Some(field)) => {
                self.needs_limits(of, "a person decides this verdict");
                let person = normalised(&field.value.text);
                criterion = format!("judged by {person}");
                Decision::Person(person)
            }
            (holds, _) => {
                let has = match holds {
                    None => "neither `holds` nor `judged by`",
                    Some(_) => "both `holds` and `judged by`",
                };
                let help = "write one of `holds` and `judged by`";
                self.tell(
                    problem!("verdict-rule", block, "verdict `{}` has {has}", block.name_text())
                        .help(help),
                );
                every(about)
            }
        };
        VerdictRule {
            name: Some(block.own_name()),
            title: block.title_in_words(),
            decision,
            words,
            own_words,
            criterion,
            clause: block.text("clause"),
            source: block.text("source"),
            notes: block.notes(),
            span: block.place(),
        }
    }

    /// The outcomes of a verdict in order; `None` where it has none.
    fn outcomes(
        &mut self,
        block: &Block,
        about: &[usize],
        of: Option<&Field>,
        quantities: &[Quantity],
        names: &Names,
    ) -> Option<Vec<Grade>> {
        let fields: Vec<Field> = block.fields_named("outcome").cloned().collect();
        if fields.is_empty() {
            return None;
        }
        let written: Vec<_> = fields
            .iter()
            .map(|field| from_pest::outcome_of_verdict(&field.value, self.problems))
            .collect();
        self.outcomes_in_order(&fields, &written.iter().flatten().map(bare).collect::<Vec<_>>());
        let grade = |written: Outcome<Written>| Grade {
            word: written.word.node.clone(),
            holds: written.holds,
            when: written
                .when
                .map(|rule| Box::new(self.decided(rule, of, about.to_vec(), quantities, names))),
        };
        Some(written.into_iter().flatten().map(grade).collect())
    }

    /// The two words of a verdict, and whether the protocol states them.
    fn verdict_words(&mut self, block: Option<&Block>, default: [&str; 2]) -> ([String; 2], bool) {
        let default = (default.map(String::from), false);
        let Some(field) = block.and_then(|block| block.field("words")) else { return default };
        let parts: Vec<String> = field
            .value
            .text
            .split(',')
            .map(|word| normalised(word.trim().trim_matches('"')))
            .collect();
        let wrong = match parts.as_slice() {
            [good, bad] if good == bad => Some("the two words of a verdict are the same".to_string()),
            [good, bad] if good.is_empty() || bad.is_empty() => Some("one of the two words is missing".to_string()),
            [good, bad] if *good == format!("not {bad}") => Some(format!("`{good}` stands first, as the word if the verdict holds")),
            [good, bad] if says_passed(bad, good) => Some(format!("`{bad}`, the word if the verdict does not hold, reads as if it did")),
            [good, bad] => [good, bad]
                .into_iter()
                .find(|word| NEITHER.contains(&word.as_str()))
                .map(|word| format!("`{word}` is reserved for a verdict that cannot be given or is not given yet")),
            _ => Some(format!("a verdict has two words, here {} {}", if parts.len() == 1 { "is" } else { "are" }, parts.len())),
        };
        if let Some(says) = wrong {
            self.tell(
                error("verdict-words", says, field).help("write the word if it holds and the word if it does not, separated by a comma: `accepted, not accepted`"),
            );
            return default;
        }
        <[String; 2]>::try_from(parts).map_or(default, |words| (words, true))
    }

    /// The quantities that a verdict uses, each once, in their order; all where it has no `of`.
    fn about(&mut self, of: Option<&Field>, quantities: &[Quantity]) -> Vec<usize> {
        let all = || (0..quantities.len()).collect();
        let Some(field) = of else { return all() };
        let Some(items) = from_pest::list(&field.value, self.problems) else { return all() };
        let known: Vec<String> = self.blocks_of("quantity").map(|block| block.own_name()).collect();
        let mut found = BTreeSet::new();
        for item in &items {
            let name = item.node.as_str();
            if known.iter().any(|known| known == name) {
                // A quantity that is not in the plan has an error that is reported elsewhere.
                found.extend(quantities.iter().position(|quantity| quantity.id == name));
            } else if let members = self.members_of(name)
                && !members.is_empty()
            {
                let here = |quantity: &Quantity| members.contains(&quantity.id);
                found.extend((0..quantities.len()).filter(|&at| here(&quantities[at])));
            } else if KINDS.contains(&name) {
                let before = found.len();
                found.extend((0..quantities.len()).filter(|&at| kind(&quantities[at]) == name));
                if found.len() == before && !self.problems.any_error() {
                    let of_kind = match name {
                        "compared" => "a comparison".into(),
                        side => format!("`from {side}`"),
                    };
                    self.tell(problem!("unknown-quantity", item, "no quantity is {of_kind}"));
                }
            } else {
                self.tell(
                    problem!("unknown-quantity", item, "there is no quantity `{name}`")
                        .suggest(name, known.iter().map(String::as_str).chain(KINDS)),
                );
            }
        }
        found.into_iter().collect()
    }

    /// The quantities of a family, by its name as written.
    fn members_of(&self, family: &str) -> Vec<String> {
        let of_family = |block: &&Block| {
            block.span().filled.as_ref().is_some_and(|filled| filled.member.family == family)
        };
        self.blocks_of("quantity").filter(of_family).map(Block::own_name).collect()
    }

    /// Reports a field `of` where no limits count.
    fn needs_limits(&mut self, of: Option<&Field>, why: &str) {
        if let Some(field) = of {
            self.tell(
                problem!(
                    "verdict-of",
                    &field.key,
                    "`of` names quantities whose limits count, but {why}"
                )
                .help("remove `of`"),
            );
        }
    }

    fn decision(
        &mut self,
        field: &Field,
        about: Vec<usize>,
        of: Option<&Field>,
        quantities: &[Quantity],
        names: &Names,
    ) -> Decision {
        match from_pest::verdict(&field.value, self.problems) {
            None => every(about),
            Some(written) => self.decided(written, of, about, quantities, names),
        }
    }

    /// What a rule means: over the limits of quantities, or over other verdicts.
    fn decided(
        &mut self,
        written: Written,
        of: Option<&Field>,
        about: Vec<usize>,
        quantities: &[Quantity],
        names: &Names,
    ) -> Decision {
        let (needed, draws) = match written {
            Written::Limits { needed, draws } => (needed, draws),
            Written::Over(over) => {
                self.needs_limits(of, "this rule uses other verdicts");
                return self.over(&over, names).map_or_else(|| every(about), Decision::Verdicts);
            }
        };
        let rule = needed.and_then(|Needed { count, of_limits }| {
            let (there, what) = match (of_limits, of) {
                (true, _) => (
                    about.iter().map(|&at| quantities[at].limits_written()).sum::<usize>(),
                    "limits",
                ),
                (false, Some(_)) => (about.len(), "quantities"),
                (false, None) => (self.blocks_of("quantity").count(), "quantities"),
            };
            let wanted = self.how_many(&count, there, what)?;
            Some(if of_limits {
                Rule::AtLeastLimits(wanted)
            } else {
                Rule::AtLeastQuantities(wanted)
            })
        });
        let draws = draws.and_then(|share| self.of_draws(&share, &about, quantities));
        Decision::Limits { rule: rule.unwrap_or(Rule::EveryLimit), quantities: about, draws }
    }

    /// The share of draws in which a rule is to hold.
    fn of_draws(
        &mut self,
        share: &Phrase,
        about: &[usize],
        quantities: &[Quantity],
    ) -> Option<f64> {
        let limits = about.iter().flat_map(|&at| &quantities[at].limits);
        let of_estimate = |limit: &Limit| match &limit.estimate.kind {
            EstimateKind::Of(of) => of.has_bound(),
            EstimateKind::Each => false,
        };
        let twice = limits.map(|limit| limit.as_ref());
        if let Some(limit) = twice.into_iter().find(|one| of_estimate(one) || one.bound.has_bound())
        {
            let says = "the draws and this confidence interval count the scatter between the \
                        sections twice";
            let problem = error("interval-of-draws", says, &limit.span);
            let help = "limit the statistic itself (`std` in place of `upper 95 % of std`), or \
                        leave out `in ... of draws`";
            return self.refuse(problem.also(share, "the rule of the verdict").help(help));
        }
        let found = self.constant_of("share of draws", Dimension::ONE, "a share", share)?;
        if (LEAST_DRAWS..1.0).contains(&found) {
            return Some(found);
        }
        let says = "a share of draws must be at least 50 % and below 100 %";
        let at = self.set_at(share);
        let help = "write it as a percentage: `95 %`";
        self.refuse(error("out-of-range", says, share).also_if(at, "its value").help(help))
    }

    /// A whole number, not larger than the number of things there are.
    fn how_many(&mut self, count: &Phrase, there: usize, what: &str) -> Option<usize> {
        let (wanted, dimension) = self.constant_phrase(count)?;
        if dimension != Dimension::ONE || !is_whole(wanted, 1.0..=f64::INFINITY) {
            let at = self.set_at(count);
            let problem = error("not-a-count", "expected a whole number above zero", count);
            return self.refuse(problem.also_if(at, "its value"));
        }
        let wanted = wanted as usize;
        if wanted > there && !self.problems.any_error() {
            self.tell(problem!(
                "out-of-range",
                count,
                "the rule needs {wanted} {what}, there are {there}"
            ));
        }
        Some(wanted)
    }

    fn over(&mut self, over: &OverVerdicts, names: &Names) -> Option<Over> {
        Some(match over {
            OverVerdicts::Holds(name) => Over::Holds(self.verdict_named(name, names)?),
            OverVerdicts::Same(one, other) => {
                let (one, other) =
                    (self.verdict_named(one, names), self.verdict_named(other, names));
                Over::Same(one?, other?)
            }
            OverVerdicts::AtLeast { count, of } => {
                let mut found = all(of.iter().map(|name| self.verdict_named(name, names)))?;
                found.sort_unstable();
                found.dedup();
                Over::AtLeast(self.how_many(count, found.len(), "verdicts")?, found)
            }
            OverVerdicts::Not(inner) => Over::Not(Box::new(self.over(inner, names)?)),
            OverVerdicts::All(parts) => {
                Over::All(all(parts.iter().map(|part| self.over(part, names)))?)
            }
            OverVerdicts::Any(parts) => {
                Over::Any(all(parts.iter().map(|part| self.over(part, names)))?)
            }
        })
    }

    fn verdict_named(&mut self, name: &At<String>, names: &Names) -> Option<usize> {
        let found = names.names.iter().position(|known| *known == name.node);
        if found.is_none() {
            self.tell(
                problem!("unknown-verdict", name, "there is no verdict `{}`", name.node)
                    .suggest(&name.node, &names.names),
            );
        }
        Some(found? + names.first)
    }

    /// Finds verdicts that depend on themselves.
    fn follow(
        &mut self,
        at: usize,
        verdicts: &[VerdictRule],
        from: &Span,
        done: &mut BTreeSet<usize>,
    ) {
        let verdict = &verdicts[at];
        let Some(name) = &verdict.name else { return };
        let others = verdict.decision.verdicts();
        if done.contains(&at) {
            return;
        }
        self.deeper(from, |checker| {
            checker.inside("verdict", name, from, |checker| {
                others
                    .into_iter()
                    .for_each(|next| checker.follow(next, verdicts, &verdict.span, done));
                Some(())
            })
        });
        done.insert(at);
    }

    /// Warns of a limit that no verdict uses, as it has no effect.
    fn without_verdict(&mut self, quantities: &[Quantity], verdicts: &[VerdictRule]) {
        let about =
            |at: usize| verdicts.iter().any(|verdict| verdict.decision.quantities().contains(&at));
        for (at, quantity) in quantities.iter().enumerate() {
            if !quantity.limits.is_empty() && !about(at) {
                let id = &quantity.id;
                let says = format!("no verdict uses quantity `{id}`: its limits have no effect");
                self.tell(warning("quantity-without-verdict", says, &quantity.span));
            }
        }
    }
}

/// The word of [`KINDS`] for a quantity.
fn kind(quantity: &Quantity) -> &'static str {
    match quantity.evaluation.as_ref() {
        Evaluation::Values { records: Records::Of(of), .. } if of.side == Side::Measured => {
            "measured"
        }
        Evaluation::Values { records: Records::Of(_), .. } => "simulated",
        _ => "compared",
    }
}
