//! Cache of computed features, so that an interrupted diagnosis can be resumed.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

use crate::data::{hash::sha256, write::keep};
use crate::diagnose::levels::cache::{LARGEST, SEAL};
use crate::disk;
use crate::problem::Problem;

/// A folder of features, keyed by the settings of the simulation.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: PathBuf,
    /// What the simulations depend on apart from the settings.
    of: String,
    /// Entries whose checksum does not match.
    damaged: Arc<Mutex<Vec<PathBuf>>>,
}

impl Cache {
    /// A cache in `folder` for one campaign and simulator.
    pub fn new(folder: &Path, of: String) -> Self {
        Self { folder: folder.to_path_buf(), of, damaged: Arc::default() }
    }

    /// The key of an entry: what the features depend on, and the settings by section.
    fn key(&self, identity: &str, settings: &[Vec<(String, f64)>]) -> String {
        let mut key = format!("{}\n{identity}", self.of);
        for (name, value) in settings.iter().flat_map(|of| {
            of.iter().map(|(name, value)| (name.as_str(), *value)).chain([("", 0.0)])
        }) {
            key += &format!("\n{name}={:016x}", value.to_bits());
        }
        key
    }

    fn path(&self, key: &str) -> PathBuf {
        self.folder.join(format!("{}.features", &sha256(key.as_bytes())[..32]))
    }

    /// The cached features of a simulation, if present; `wanted` is their number.
    pub fn get(
        &self,
        identity: &str,
        settings: &[Vec<(String, f64)>],
        wanted: usize,
    ) -> Option<Vec<f64>> {
        let key = self.key(identity, settings);
        let path = self.path(&key);
        if let Ok(None) = disk::kind(&path) {
            return None;
        }
        let values = disk::read(&path, LARGEST).ok().and_then(|bytes| {
            let (sealed, bytes) = bytes.split_at_checked(SEAL)?;
            let (chunks, rest) = bytes.as_chunks::<8>();
            let values: Vec<f64> = chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect();
            let whole = rest.is_empty()
                && values.len() == wanted
                && values.iter().all(|value| value.is_finite());
            (whole && sealed == seal(&key, bytes).as_bytes()).then_some(values)
        });
        if let (None, Ok(mut damaged)) = (&values, self.damaged.lock()) {
            damaged.push(path);
        }
        values
    }

    /// A warning of damaged entries, which were computed again.
    pub fn warning(&self) -> Option<Problem> {
        let damaged = self.damaged.lock().ok()?;
        let first = damaged.iter().min()?.display().to_string();
        let says = match damaged.len() {
            1 => format!("the cached result `{first}` is damaged; it was computed again"),
            count => format!(
                "{count} cached results are damaged, among them `{first}`; they were computed again"
            ),
        };
        Some(Problem::warning("cache-damaged", says))
    }

    /// Stores the features of a simulation. A write error is ignored: the simulation is then
    /// repeated.
    pub fn put(&self, identity: &str, settings: &[Vec<(String, f64)>], features: &[f64]) {
        let key = self.key(identity, settings);
        let bytes: Vec<u8> = features.iter().flat_map(|value| value.to_le_bytes()).collect();
        let _ = keep(&self.path(&key), &[seal(&key, &bytes).as_bytes(), &bytes].concat());
    }
}

/// Checksum of key and features, so that an entry under a wrong key is detected as well.
fn seal(key: &str, bytes: &[u8]) -> String {
    sha256(&[key.as_bytes(), b"\n", bytes].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_are_what_was_kept_or_nothing() {
        let temp = tempfile::tempdir().expect("a temporary folder");
        let cache = Cache::new(temp.path(), "campaign".into());
        let settings = [1.0, 2.0].map(|value| vec![vec![("friction".to_string(), value)]]);
        assert_eq!((cache.get("A", &settings[0], 2), cache.warning()), (None, None));
        cache.put("A", &settings[0], &[1.5, -2.0]);
        cache.put("A", &settings[1], &[3.5, 4.0]);
        assert_eq!(cache.get("A", &settings[0], 2), Some(vec![1.5, -2.0]));
        assert_eq!((cache.get("B", &settings[0], 2), cache.warning()), (None, None));
        let paths = settings.each_ref().map(|settings| cache.path(&cache.key("A", settings)));
        let first = std::fs::read(&paths[0]).expect("read");
        for at in 0..first.len() {
            let mut bytes = first.clone();
            bytes[at] ^= 1;
            std::fs::write(&paths[0], &bytes).expect("written");
            assert_eq!(cache.get("A", &settings[0], 2), None, "byte {at}");
            std::fs::write(&paths[0], &first[..at]).expect("written");
            assert_eq!(cache.get("A", &settings[0], 2), None, "{at} bytes");
        }
        std::fs::copy(&paths[1], &paths[0]).expect("copied");
        assert_eq!(cache.get("A", &settings[0], 2), None);
        assert_eq!(cache.get("A", &settings[1], 2), Some(vec![3.5, 4.0]));
        assert_eq!(cache.warning().map(|warning| warning.code), Some("cache-damaged"));
    }
}
