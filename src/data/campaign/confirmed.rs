//! Values of the protocol that a person has confirmed, as `campaign.yaml` states them.

use crate::yaml::fields;

fields! {
    /// A value that is confirmed for one edition of a protocol.
    pub struct Confirmed: "a confirmation" {
        "name" name: String => "the parameter, definition or quantity, or `zone 1`",
        "value" value: String => "the value that was checked",
        "unit" unit: Option<String>,
        /// Where it was found.
        "clause" clause: Option<String>,
        /// As the protocol states it.
        "edition" edition: Option<String>,
        "by" by: String => "who confirms it",
        "date" date: String => "when it was confirmed",
    }
}
