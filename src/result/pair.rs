//! The values of a quantity: of a pair of records, or of one record.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{RecordName, zones};

/// One section and signal.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(into = "PairInFile", from = "PairInFile")]
pub struct PairValue {
    /// Which of several campaigns.
    pub campaign: Option<String>,
    /// Name of the section (or of the record, without sections).
    pub section: String,
    pub zone: Option<String>,
    pub signal: String,
    /// Which of the quantity's values, in words, where it has several.
    pub taken: Option<String>,
    /// Which record, where the campaign has several of a side.
    pub record: Option<RecordName>,
    pub simulated: Option<f64>,
    pub measured: Option<f64>,
    /// What estimates are taken of: the difference; of a quantity without sides its metric, or the
    /// value that is assessed.
    pub difference: f64,
    /// Number of samples (or windows) of the measured value.
    pub samples: usize,
    /// Where each value has a limit: that of this one, and its share. Of several limits the one
    /// with the largest share.
    pub limit: Option<f64>,
    pub ratio: Option<f64>,
}

impl PairValue {
    /// The signal, and which value and record it is where there are several: `SigmaY_1, p99.85`.
    pub fn label(&self) -> String {
        let record = self.record.as_ref().map(ToString::to_string);
        [Some(self.signal.clone()), self.taken.clone(), record]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// A value as it stands in files: a difference with both sides, or a value by itself.
#[derive(Serialize, Deserialize, JsonSchema)]
struct PairInFile {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    campaign: Option<String>,
    section: String,
    #[serde(with = "zones")]
    #[schemars(with = "Option<zones::InFile>")]
    zone: Option<String>,
    signal: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    taken: Option<String>,
    #[serde(flatten)]
    record: Option<RecordName>,
    #[serde(flatten)]
    number: NumberInFile,
    samples: usize,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    limit: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ratio: Option<f64>,
}

/// See [`PairInFile`].
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
enum NumberInFile {
    Difference { simulated: Option<f64>, measured: Option<f64>, difference: f64 },
    Value { value: f64 },
}

impl From<PairValue> for PairInFile {
    fn from(pair: PairValue) -> Self {
        let PairValue { simulated, measured, difference, .. } = pair;
        let number = if simulated.is_some() || measured.is_some() {
            NumberInFile::Difference { simulated, measured, difference }
        } else {
            NumberInFile::Value { value: difference }
        };
        let PairValue { campaign, section, zone, signal, taken, record, samples, .. } = pair;
        let (limit, ratio) = (pair.limit, pair.ratio);
        Self { campaign, section, zone, signal, taken, record, number, samples, limit, ratio }
    }
}

impl From<PairInFile> for PairValue {
    fn from(file: PairInFile) -> Self {
        let (simulated, measured, difference) = match file.number {
            NumberInFile::Difference { simulated, measured, difference } => {
                (simulated, measured, difference)
            }
            NumberInFile::Value { value } => (None, None, value),
        };
        let (limit, ratio) = (file.limit, file.ratio);
        let PairInFile { campaign, section, zone, signal, taken, record, samples, .. } = file;
        Self {
            campaign,
            section,
            zone,
            signal,
            taken,
            record,
            simulated,
            measured,
            difference,
            samples,
            limit,
            ratio,
        }
    }
}
