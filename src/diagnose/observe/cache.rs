//! Features of runs that were made before: a diagnosis that was interrupted goes on where it was.

use std::path::{Path, PathBuf};

use crate::data::hash::sha256;

/// A folder of features by what made them.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: PathBuf,
    /// Everything that features depend on beside the settings.
    of: String,
}

impl Cache {
    /// A cache in `folder` for one campaign, layout and simulator.
    #[must_use]
    pub fn new(folder: &Path, of: String) -> Self {
        Self { folder: folder.to_path_buf(), of }
    }

    /// `settings` section by section.
    fn path(&self, settings: &[Vec<(String, f64)>]) -> PathBuf {
        let mut key = self.of.clone();
        for (name, value) in settings.iter().flat_map(|of| of.iter().map(|(name, value)| (name.as_str(), *value)).chain([("", 0.0)])) {
            key += &format!("\n{name}={:016x}", value.to_bits());
        }
        self.folder.join(format!("{}.features", &sha256(key.as_bytes())[..32]))
    }

    /// The features of a run with settings, if it was made; `wanted` numbers.
    #[must_use]
    pub fn get(&self, settings: &[Vec<(String, f64)>], wanted: usize) -> Option<Vec<f64>> {
        let bytes = std::fs::read(self.path(settings)).ok()?;
        let (chunks, rest) = bytes.as_chunks::<8>();
        let values: Vec<f64> = chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect();
        (rest.is_empty() && values.len() == wanted && values.iter().all(|value| value.is_finite())).then_some(values)
    }

    /// Keeps the features of a run. A cache that cannot be written is no fault: the run is made again.
    pub fn put(&self, settings: &[Vec<(String, f64)>], features: &[f64]) {
        let bytes: Vec<u8> = features.iter().flat_map(|value| value.to_le_bytes()).collect();
        let _ = crate::data::write::write_whole(&self.path(settings), &bytes);
    }
}
