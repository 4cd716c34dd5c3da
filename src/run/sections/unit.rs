//! A section as it is evaluated: what the table says of it, and why it is not used.

use serde::{Deserialize, Serialize};

use crate::check::plan::{Plan, Scalar};
use crate::data::campaign::Part;
use crate::data::table::Cell;
use crate::result::{CheckResult, Reason};
use crate::source::Span;

/// Start and end of a section on the axis, SI.
pub type Extent = (f64, f64);

/// A section, or a whole record where there are no sections.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Unit {
    /// Of its own; in a pool with the campaign's: `series 2/S01`.
    pub name: String,
    /// Number of its campaign, and what that is called where there are several.
    pub campaign: usize,
    pub campaign_name: Option<String>,
    /// Number of its vehicle in [`crate::run::Facts::vehicles`].
    pub vehicle: usize,
    /// The section name with its place in the table; it is also the name of the records.
    pub cell: Cell,
    pub zone: Option<String>,
    /// Index of its site: sections of the same stretch of track have the same.
    pub site: usize,
    /// Name of the first section of the site.
    pub site_name: String,
    /// Index of the section that it repeats.
    pub original: Option<usize>,
    /// `None` for a whole record.
    pub extent: Option<Extent>,
    /// Of a section of a run: what is read for it and its neighbours.
    #[serde(skip)]
    pub stretch: Option<Stretch>,
    /// The range that a report states: that of the section, or of the measured record.
    pub covered: Option<Extent>,
    /// One for each [`crate::check::plan::Plan::columns`].
    pub columns: Vec<Result<Scalar, Reason>>,
    pub checks: Vec<CheckResult>,
    /// Why it is not used.
    pub fault: Option<Reason>,
    /// Whether the fault is in the data and not in a requirement.
    pub faulty: bool,
    /// Row of the table of sections.
    pub span: Option<Span>,
}

/// A part of a run that is read for the sections inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    pub number: usize,
    pub extent: Extent,
}

impl Stretch {
    /// What is read.
    pub fn part(&self, plan: &Plan) -> Part {
        Part { axis: plan.axis.column.clone(), from: self.extent.0, to: self.extent.1 }
    }
}

impl Unit {
    /// A whole record, of which nothing else is known.
    pub fn new(name: &Cell, site: usize, columns: Vec<Result<Scalar, Reason>>) -> Self {
        Self {
            name: name.value.clone(),
            campaign: 0,
            campaign_name: None,
            vehicle: 0,
            cell: name.clone(),
            zone: None,
            site,
            site_name: name.value.clone(),
            original: None,
            extent: None,
            stretch: None,
            covered: None,
            columns,
            checks: Vec::new(),
            fault: None,
            faulty: false,
            span: None,
        }
    }

    /// The part of a run that the section reads by itself; `None` of a whole record.
    pub fn part(&self, plan: &Plan) -> Option<Part> {
        self.extent.map(|extent| Part::around(&plan.axis.column, extent, plan.sections.margin))
    }

    /// Records the first reason not to use it.
    pub fn refuse(&mut self, reason: Reason, faulty: bool) {
        if self.fault.is_none() {
            self.fault = Some(reason);
            self.faulty = faulty;
        }
    }
}
