//! What a report tells beside the verdict.
//!
//! | file | content |
//! |---|---|
//! | `domain` | the validity domain, and wanted operation against it |
//! | `reports` | estimates without a limit |
//! | `spreads` | how far several records of one side are from each other |
//! | `traces` | signals for plots |
//! | `told`, `not_asked` | findings about vehicle data, and about what was not assessed or asked |

pub mod domain;
pub mod not_asked;
pub mod reports;
pub mod spreads;
pub mod told;
pub mod traces;
