//! The comments of a YAML text, assigned in reading order to blocks and fields.

use std::{iter::Peekable, sync::Arc, vec::IntoIter};

use crate::source::{Source, Span};
use crate::yaml::{self, Remark};

#[derive(Debug)]
pub struct Remarks {
    source: Arc<Source>,
    ahead: Peekable<IntoIter<Remark>>,
    /// Comments that belong to the next block or field.
    waiting: Vec<String>,
}

impl Remarks {
    pub fn new(source: &Arc<Source>) -> Self {
        Self {
            source: Arc::clone(source),
            ahead: yaml::remarks(source).into_iter().peekable(),
            waiting: Vec::new(),
        }
    }

    /// Comments at the top that a blank line separates from the first key.
    pub fn leading(&mut self, first: usize) -> Vec<String> {
        let mut leading = Vec::new();
        while let Some(remark) = self.ahead.next_if(|remark| remark.span.start < first) {
            self.waiting.push(remark.text);
            let next = self.ahead.peek().map_or(first, |next| next.span.start.min(first));
            let between = self.source.text.get(remark.span.end..next).unwrap_or("");
            let lines: Vec<&str> = between.split('\n').collect();
            if lines
                .get(1..lines.len().saturating_sub(1))
                .unwrap_or(&[])
                .iter()
                .any(|line| line.trim().is_empty())
            {
                leading.append(&mut self.waiting);
            }
        }
        leading
    }

    /// Moves on to a place: comments before it belong to what begins there.
    pub fn pass(&mut self, to: usize) {
        while let Some(remark) = self.ahead.next_if(|remark| remark.span.start < to) {
            self.waiting.push(remark.text);
        }
    }

    /// As [`Self::pass`], for a list item. Returns the comment on the line directly above the start
    /// of its text, which is next to the `- >` of a folded text.
    pub fn pass_to_item(&mut self, to: usize) -> Option<String> {
        let mut beside = None;
        while let Some(remark) = self.ahead.next_if(|remark| remark.span.start < to) {
            let between = self.source.text.get(remark.span.end..to).unwrap_or("");
            if remark.beside && between.trim().is_empty() && between.matches('\n').count() == 1 {
                beside = Some(remark.text);
            } else {
                self.waiting.push(remark.text);
            }
        }
        beside
    }

    /// Assigns the comment next to something to what follows below.
    pub fn pass_beside(&mut self, end: usize) {
        let beside = self.beside(end);
        self.waiting.extend(beside);
    }

    /// Comments that were passed and not yet assigned.
    pub fn above(&mut self) -> Vec<String> {
        std::mem::take(&mut self.waiting)
    }

    /// The comment on the line on which something ends.
    pub fn beside(&mut self, end: usize) -> Option<String> {
        let text = &self.source.text;
        // A block scalar ends where the next line begins; no comment is next to it.
        if text.get(..end)?.trim_end_matches(' ').ends_with('\n') {
            return None;
        }
        let on_line = |remark: &Remark| {
            remark.beside
                && text.get(end..remark.span.start).is_some_and(|between| !between.contains('\n'))
        };
        self.ahead.next_if(on_line).map(|remark| remark.text)
    }

    /// Comment lines before a place with a deeper indentation than the head of a block.
    pub fn deeper(&mut self, head: &Span, end: usize) -> Vec<String> {
        let mut deeper = Vec::new();
        let source = Arc::clone(&self.source);
        let column =
            |at: usize| source.text[..at].bytes().rev().take_while(|byte| *byte != b'\n').count();
        let least = column(head.start);
        while let Some(remark) = self.ahead.next_if(|remark| {
            !remark.beside && remark.span.start < end && column(remark.span.start) > least
        }) {
            deeper.push(remark.text);
        }
        deeper
    }

    /// All remaining comments.
    pub fn rest(mut self) -> Vec<String> {
        self.pass(usize::MAX);
        self.waiting
    }
}
