//! What most commands use.

pub use std::num::NonZeroUsize;
pub use std::path::{Path, PathBuf};

pub use clap::{Args, ValueEnum};

pub use super::convert_records::Records;
pub use super::inputs::{
    check_outputs, check_report, opened_all, prepare, prepare_all, start_jobs, with_protocols,
};
pub use super::output::{Console, Done, Ended, Exit};
pub use super::places::{CAMPAIGN, REPORT, check_file, check_folder, same};
pub use super::protocols::load;
pub use super::values::from_one;
pub use crate::data::record::Format;
pub use crate::data::text::read_text;
pub use crate::data::write::Outputs;
pub use crate::data::{Campaign, RecordKind};
pub use crate::disk::{self, SetKind};
pub use crate::library;
pub use crate::problem::{Problem, Problems, all};
pub use crate::terminal::Lines;
