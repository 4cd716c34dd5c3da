//! Records of other systems: every channel of every format against the same record as CSV, and
//! files that are damaged on purpose.
//!
//! `data` holds 200 rows of one section, written by the libraries that measuring systems and MATLAB
//! users have: asammdf (MDF 4.10, compressed, two groups), SciPy (MAT v5), h5py (MAT v7.3),
//! pyarrow, openpyxl, npTDMS.

mod channels;
mod damage;
mod dialects;
mod exports;
mod loggers;

use std::path::PathBuf;

use fishplate::foreign::{File, Options, read};
use fishplate::problem::{Problem, Problems};

pub fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/campaigns/foreign/data").join(name)
}

/// Every file of the folder in another format, and whether the vehicle was measured or simulated.
pub const FILES: [(&str, &str); 13] = [
    ("windows.csv", "measurement"),
    ("simpack.dat", "simulation"),
    ("groups.mf4", "measurement"),
    ("v5.mat", "measurement"),
    ("v5_plain.mat", "measurement"),
    ("v73.mat", "simulation"),
    ("book.xlsx", "measurement"),
    ("zstd.parquet", "simulation"),
    ("lz4.feather", "simulation"),
    ("zstd.arrow", "simulation"),
    ("plain.arrow", "simulation"),
    ("group.tdms", "measurement"),
    ("measurement.csv", "measurement"),
];

#[track_caller]
pub fn good(name: &str, options: &Options) -> File {
    read(&data(name), name, options)
        .unwrap_or_else(|problems| panic!("{}", Problems(problems).render(false)))
}

/// Reads a text that is given.
pub fn text(name: &str, content: &[u8], options: &Options) -> Result<File, Vec<Problem>> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, content).expect("written");
    read(&path, name, options)
}
