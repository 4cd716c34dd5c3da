//! What the change of a protocol would have decided over an archive of campaigns: from their records,
//! or from values that were made of them.
//!
//! | file | content |
//! |---|---|
//! | `touched` | the changed rules that can touch a verdict, and which of its parts; how a protocol makes values |
//! | `variants` | the old protocol with sets of changed rules, compiled; those that show every part of a verdict under every combination |
//! | `source` | a campaign and its values, made once in each way |
//! | `verdicts` | the verdict under any set of rules, put together from its parts |
//! | `minimal` | the smallest sets that give the new verdict |
//! | `margin` | the smallest change of a limit that gives another verdict |
//! | `shares` | shares of campaigns whose verdict holds |
//!
//! # Definitions
//!
//! **Set of rules.** The changes of `check::diff`, each made to the merged text of the old protocol,
//! which is then checked and judged as any other. A set with which the text is no valid protocol is
//! none.
//!
//! **Parts.** A verdict is put together (`run::overall`) from what all sections, each quantity and the
//! rule of the verdict come to. Each part depends on the changed rules whose names stand in the texts
//! that it is made from, so it is judged under the combinations of these alone. Every set that is told
//! is judged once more as a whole.

mod margin;
mod minimal;
mod shares;
mod source;
mod touched;
mod variants;
mod verdicts;

use std::{collections::BTreeMap, sync::Arc};

use rayon::prelude::*;

use crate::certify::{Compiled, Set, overrides};
use crate::check::{Overrides, diff::Change, family::Family};
use crate::compare::{campaigns, compared, on_found_sections, related, unknown_parameters};
use crate::data::Campaign;
use crate::problem::{Problem, Problems};
use crate::result::{
    FORMAT, Outcome, Reason, THIS,
    impact::{Flip, Impact, Judged, Margin, Near, NotReplayed, Work},
};
use crate::run::{self, Evaluated, Progress};
use crate::source::Span;
use crate::values::Joined;
pub use margin::{Written, limits};
use minimal::minimal;
use shares::Groups;
use source::{From, Source};
use touched::Touched;
use variants::{Variant, Variants};
use verdicts::{Frame, Verdicts, decided};

/// The old and the new protocol, and the archive.
#[derive(Debug)]
pub struct Prepared {
    families: [Family; 2],
    names: [String; 2],
    touched: Touched,
    /// Campaigns with the same values of parameters.
    groups: Vec<(Overrides, Vec<Source>)>,
}

/// An archive: campaigns with records, and values of campaigns.
#[derive(Debug)]
pub struct Archive {
    pub campaigns: Vec<Campaign>,
    pub values: Vec<Joined>,
    /// Parameters that are set for all campaigns with records.
    pub set: Vec<Set>,
}

impl Prepared {
    /// Problems: `protocols-unrelated`, `campaign-twice`; those of parameters, and of sections that are looked for.
    pub fn new(
        (names, families): ([String; 2], [Family; 2]),
        archive: Archive,
        problems: &mut Problems,
    ) -> Option<Self> {
        if !related(&families[0], &families[1]) {
            let [old, new] = &names;
            let says = format!("`{old}` and `{new}` are not two texts of one protocol");
            let problem = Problem::error("protocols-unrelated", says);
            problems.push(problem.help("`fishplate compare` puts any protocols side by side"));
            return None;
        }
        let touched = Touched::of(&families[0].merged, &families[1].merged);
        let mut all: Vec<(Overrides, Source)> = Vec::new();
        for (name, campaign) in campaigns(archive.campaigns, problems) {
            let set = overrides(&archive.set, std::slice::from_ref(&campaign), problems)?;
            let number = all.len();
            all.push((set, Source { name, from: From::Records(Box::new(campaign)), number }));
        }
        for joined in archive.values {
            let name = joined.head.about.names().collect::<Vec<_>>().join(" + ");
            if all.iter().any(|(_, known)| known.name == name) {
                let says = format!("there are several campaigns `{name}` in the archive");
                problems
                    .push(Problem::error("campaign-twice", says).help(
                        "give each campaign once: its folder, or all of its files of values",
                    ));
            }
            let set = joined.head.rules.overrides();
            let number = all.len();
            all.push((set, Source { name, from: From::Values(Box::new(joined)), number }));
        }
        // The same parameters are compiled once.
        let mut groups: BTreeMap<String, (Overrides, Vec<Source>)> = BTreeMap::new();
        for (set, source) in all {
            let values: Vec<_> =
                set.iter().map(|(name, of)| (name, &of.text.text, of.set_by)).collect();
            let key = format!("{values:?} {:?}", set.confirmed);
            groups.entry(key).or_insert_with(|| (set, Vec::new())).1.push(source);
        }
        unknown_parameters(&archive.set, &families, problems);
        for (set, _) in groups.values() {
            Variants::new(&touched, [&families[0], &families[1]], set.clone(), problems)?;
        }
        (!problems.any_error()).then_some(Self {
            families,
            names,
            touched,
            groups: groups.into_values().collect(),
        })
    }

    /// Number of times that progress is told.
    pub fn steps(&self) -> usize {
        self.groups.iter().map(|(_, sources)| sources.len()).sum()
    }

    /// Judges every campaign by both protocols, and by those between them.
    ///
    /// # Errors
    /// A protocol is not valid with the parameters of a campaign.
    pub fn impact(self, progress: Progress<'_>) -> Result<Impact, Problems> {
        let Self { families: [old, new], names, touched, groups } = self;
        let mut problems = Problems::default();
        let (mut cases, mut work, mut told) = (Vec::new(), Work::default(), None);
        let mut rules = touched.told.clone();
        for (overrides, sources) in groups {
            let Some(variants) = Variants::new(&touched, [&old, &new], overrides, &mut problems)
            else {
                return Err(problems);
            };
            let (Ok(before), Ok(after)) = (variants.get(0), variants.get(touched.all())) else {
                return Err(problems);
            };
            for (at, rule) in rules.iter_mut().enumerate() {
                let alone = variants.get(touched::bit(at)).err();
                let reason = alone.map(|says| format!("cannot be applied alone: {says}"));
                rule.reason = rule.reason.take().or(reason.map(Reason::said));
            }
            let parts = verdicts::parts(&touched);
            let cover = variants::cover(&parts, &variants);
            let frame =
                Frame { touched: &touched, variants: &variants, cover: &cover, parts: &parts };
            let group = Group::new(&frame, [&before, &after]);
            let found = sources.into_par_iter().map(|source| group.case(source, progress));
            cases.extend(found.collect::<Result<Vec<Case>, Problems>>()?);
            work.protocols += variants.compiled();
            work.operations =
                [&before, &after].map(|one| one.compiled.graph.nodes.len()).iter().sum();
            told.get_or_insert_with(|| {
                [(&names[0], &before), (&names[1], &after)]
                    .map(|(name, one)| compared(name, &one.compiled))
            });
        }
        let Some([old, new]) = told else { return Err(nothing()) };
        cases.sort_by_key(|case| case.number);
        work.sets = cases.iter().map(|case| case.sets).sum();
        let mut near: Vec<Near> = cases.iter().filter_map(|case| case.near.clone()).collect();
        near.sort_by(|a, b| a.margin.distance().total_cmp(&b.margin.distance()));
        let replayed = || cases.iter().filter(|case| case.lacks.is_none());
        Ok(Impact {
            fishplate: THIS.into(),
            format: FORMAT,
            old,
            new,
            campaigns: replayed().count(),
            rules,
            only_words: touched.only_words,
            flips: cases.iter().filter_map(|case| case.flip.clone()).collect(),
            near,
            not_replayed: cases.iter().filter_map(|case| case.lacks.clone()).collect(),
            shares: shares::shares(replayed().map(|case| (&case.groups, case.holds))),
            archive: cases.into_iter().map(|case| case.judged).collect(),
            work,
        })
    }
}

fn nothing() -> Problems {
    Problem::error("no-campaign", "the archive has no campaign").into()
}

/// What is found of one campaign.
#[derive(Debug)]
struct Case {
    number: usize,
    judged: Judged,
    flip: Option<Flip>,
    near: Option<Near>,
    lacks: Option<NotReplayed>,
    groups: Groups,
    holds: [bool; 2],
    sets: usize,
}

/// Campaigns with the same parameters.
struct Group<'a> {
    frame: &'a Frame<'a>,
    before: &'a Arc<Variant>,
    after: &'a Arc<Variant>,
    limits: Vec<Written>,
}

impl<'a> Group<'a> {
    fn new(frame: &'a Frame<'a>, [before, after]: [&'a Arc<Variant>; 2]) -> Self {
        let changed = |span: &Span| {
            let new = |change: &Change| Some(change.field()?[1]?.value.span.clone());
            let at =
                frame.touched.changes.iter().position(|change| {
                    new(change).is_some_and(|new| margin::same_place(&new, span))
                });
            Some(frame.touched.told[at?].rule.clone())
        };
        Self { frame, before, after, limits: margin::limits(&after.compiled, changed) }
    }

    /// # Errors
    /// Sections cannot be looked for in the runs of the campaign.
    fn case(&self, source: Source, progress: Progress<'_>) -> Result<Case, Problems> {
        let source = self.with_found_sections(source)?;
        let frame = self.frame;
        let protocols = frame.cover.masks.iter().filter_map(|mask| frame.variants.get(*mask).ok());
        let made = source.made(&protocols.collect::<Vec<_>>(), progress);
        let mut lacks = made.lacks(self.before);
        let mut more = made.lacks(self.after);
        more.retain(|id| !lacks.contains(id));
        lacks.extend(more);
        let all = frame.touched.all();
        let ends = made
            .evaluated(self.before, 0)
            .zip(made.evaluated(self.after, all & frame.touched.everywhere));
        let Some((old, new)) = ends.filter(|_| lacks.is_empty()) else {
            let sections = !made.has_sections(self.before) || !made.has_sections(self.after);
            return Ok(Case::not_replayed(&source, lacks, sections));
        };
        let [before, after] = [(self.before, old.as_ref()), (self.after, new.as_ref())]
            .map(|(protocol, evaluated)| Ended::of(&protocol.compiled, evaluated));
        let mut case = Case {
            number: source.number,
            judged: Judged {
                of: source.told(new.as_ref().as_ref().ok()),
                from: source.from.in_words().into(),
                before: Some(before.word.clone()),
                after: Some(after.word.clone()),
                reasons: after.reasons.clone(),
            },
            flip: None,
            near: None,
            lacks: None,
            groups: after.evaluated.map_or_else(Vec::new, |evaluated| {
                shares::groups(&self.after.compiled.plan, evaluated)
            }),
            holds: [before.outcome, after.outcome].map(|outcome| outcome == Outcome::Holds),
            sets: 0,
        };
        if before.outcome == after.outcome {
            case.near = self.near(&source.name, &after);
        } else {
            let found =
                minimal(&mut Verdicts::new(frame, &made), after.outcome, frame.cover.complete);
            case.sets = found.looked_at;
            case.flip = Some(Flip {
                campaign: source.name.clone(),
                before: before.word,
                margin: self.margins(&after, |_| true),
                after: after.word,
                minimal: found.sets.iter().map(|set| frame.touched.names(*set)).collect(),
                exact: found.exact && !(frame.touched.apart && made.vary()),
                looked_at: found.most,
            });
        }
        Ok(case)
    }

    fn with_found_sections(&self, source: Source) -> Result<Source, Problems> {
        let From::Records(campaign) = source.from else { return Ok(source) };
        let mut problems = Problems::default();
        let protocols = [&self.before.compiled, &self.after.compiled];
        let found = on_found_sections(protocols, *campaign, &mut problems);
        let campaign = Box::new(found.ok_or(problems)?);
        Ok(Source { from: From::Records(campaign), ..source })
    }

    fn margins(&self, ended: &Ended<'_>, which: impl Fn(&Written) -> bool) -> Vec<Margin> {
        let (Some(evaluated), Some(judged)) = (ended.evaluated, &ended.judged) else {
            return Vec::new();
        };
        let found = margin::Found { plan: &self.after.compiled.plan, evaluated, judged };
        self.limits
            .iter()
            .filter(|limit| which(limit))
            .filter_map(|limit| found.margin(limit))
            .collect()
    }

    fn near(&self, name: &str, ended: &Ended<'_>) -> Option<Near> {
        let all = self.margins(ended, |limit| limit.changed).into_iter();
        let nearest = all.min_by(|a, b| a.distance().total_cmp(&b.distance()))?;
        Some(Near { campaign: name.into(), verdict: ended.word.clone(), margin: nearest })
    }
}

impl Case {
    fn not_replayed(source: &Source, quantities: Vec<String>, sections: bool) -> Self {
        let campaign = source.name.clone();
        Self {
            number: source.number,
            judged: Judged {
                of: source.told(None),
                from: source.from.in_words().into(),
                before: None,
                after: None,
                reasons: Vec::new(),
            },
            flip: None,
            near: None,
            lacks: Some(NotReplayed { campaign, quantities, sections }),
            groups: Vec::new(),
            holds: [false; 2],
            sets: 0,
        }
    }
}

/// What a campaign comes to under a protocol.
struct Ended<'a> {
    evaluated: Option<&'a Evaluated>,
    judged: Option<run::Judged>,
    outcome: Outcome,
    word: String,
    reasons: Vec<Reason>,
}

impl<'a> Ended<'a> {
    fn of(Compiled { plan, .. }: &Compiled, evaluated: &'a Result<Evaluated, Problems>) -> Self {
        let judged = evaluated.as_ref().ok().map(|evaluated| evaluated.judge(plan));
        let outcome =
            judged.as_ref().map_or(Outcome::NotAssessable, |judged| decided(plan, judged));
        let own = judged.as_ref().and_then(|judged| judged.own_word.clone());
        let word = match outcome {
            Outcome::Open => "open".into(),
            _ => own.unwrap_or_else(|| outcome.overall().in_words().into()),
        };
        let reasons = match (evaluated, &judged) {
            (Err(problems), _) => {
                let says = problems.0.iter().map(|problem| Reason::said(problem.says.clone()));
                says.take(1).collect()
            }
            (_, judged) => judged.as_ref().map_or_else(Vec::new, |judged| judged.reasons.clone()),
        };
        Self { evaluated: evaluated.as_ref().ok(), judged, outcome, word, reasons }
    }
}
