//! What nearly every file of a run uses: the parts of a plan and of a graph, campaigns, and what
//! results say.

pub(super) use crate::check::evaluate::{flag, number};
pub(super) use crate::check::plan::*;
pub(super) use crate::data::{Campaign, Campaigns, RecordKind, WhichRecord};
pub(super) use crate::graph::{Graph, InputNode, NodeId, Operation};
pub(super) use crate::problem::{Problem, Problems};
pub(super) use crate::result::{
    FileHash, Finding, FindingData, Occurrence, Reason, RecordName, Remark, Subject,
};
