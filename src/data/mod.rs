//! Reads and writes campaigns. All input is checked. No names of channels, quantities or columns
//! are defined here; the caller requests them.
//!
//! | file | content |
//! |---|---|
//! | `campaign` | a campaign folder: `campaign.yaml`, the vehicle, the sections, where the records are |
//! | `campaigns` | several campaigns evaluated as one |
//! | `identification` | identification of the report |
//! | `place`, `folder` | where a file of a campaign is; no path leads out of its folder |
//! | `format` | the formats of records |
//! | `record` | one sampled record, as text, as Parquet or in memory; optimised for speed |
//! | `record/source` | where a record is: the one place from which campaigns read records |
//! | `conversion` | a copy of a campaign with its records in another format |
//! | `cut` | a copy of a campaign in which each section of a run has its own records |
//! | `checksum` | checksums in the Parquet files that are written |
//! | `blocks` | a long record, block by block |
//! | `table` | a small table such as `sections.csv` |
//! | `crate::yaml` | YAML with places of all values |
//! | `origin` | origin of the records of a campaign written by a program; what an import did |
//! | `sites` | sections on the same stretch of track |
//! | `checks` | checks of the samples of a record |
//! | `fingerprint` | hash of a present file of a campaign |
//! | `write` | output files |

pub mod blocks;
pub mod campaign;
mod campaigns;
pub(crate) mod cells;
pub mod checks;
mod checksum;
pub mod conversion;
pub mod cut;
pub(crate) mod faults;
pub mod fingerprint;
mod folder;
mod format;
pub mod identification;
pub mod origin;
mod place;
mod prelude;
pub mod record;
pub mod sites;
pub mod table;
pub mod text;
pub mod write;

pub use crate::hash;
pub use campaign::{Campaign, RecordKind, WhichRecord};
pub use campaigns::{Campaigns, qualified};
pub use cells::Heading;
pub use checks::{Axis, check_axis};
pub use folder::{Folder, check_file_name};
pub use place::CampaignPath;
pub use record::{Column, Record, Wanted, read_record};
pub use table::Table;
