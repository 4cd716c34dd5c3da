//! How fast records are read, beside the `csv` crate and plain reading: `cargo bench --bench
//! read_record [-- FOLDER]`.
//!
//! Without a folder, records like those of a campaign of 66 files are made: 26 columns, 2600 rows.

#![allow(clippy::print_stdout, clippy::cast_precision_loss)]

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use fishplate::data::record::{Wanted, read_headings, read_record};
use fishplate::units::Dimension;

fn main() {
    let folder = std::env::args().skip(1).find(|word| !word.starts_with('-'));
    let temp = tempfile::tempdir().expect("a temporary folder");
    let files = match folder {
        Some(folder) => csv_files(Path::new(&folder)),
        None => made(temp.path()),
    };
    let bytes: u64 = files.iter().map(|file| file.metadata().expect("readable").len()).sum();
    println!("{} files, {:.1} MB", files.len(), bytes as f64 / 1e6);
    let time = |what: &str, read: &dyn Fn(&Path) -> f64| {
        let best = (0..7)
            .map(|_| {
                let start = Instant::now();
                std::hint::black_box(files.iter().map(|file| read(file)).sum::<f64>());
                start.elapsed().as_secs_f64()
            })
            .fold(f64::INFINITY, f64::min);
        println!("{what:40} {:6.2} GB/s {:8.1} ms", bytes as f64 / best / 1e9, best * 1e3);
    };
    time("read the bytes", &|file| std::fs::read(file).expect("readable").len() as f64);
    time("and SHA-256", &|file| {
        fishplate::data::hash::sha256(&std::fs::read(file).expect("readable")).len() as f64
    });
    time("csv crate, ByteRecord, no numbers", &|file| with_csv(file, false));
    time("csv crate, ByteRecord, fast-float2", &|file| with_csv(file, true));
    let all: Vec<Wanted> = read_headings(&files[0], "first")
        .expect("a record")
        .into_iter()
        .map(|heading| Wanted { name: heading.name, dimension: None, required: false })
        .collect();
    time("read_record, every column", &|file| checksum(file, &all));
    time("read_record, every second column", &|file| {
        checksum(file, &all.iter().step_by(2).cloned().collect::<Vec<_>>())
    });
    time("read_record, time only", &|file| {
        checksum(file, &[Wanted::new("time", Dimension::TIME).if_there()])
    });
}

fn checksum(file: &Path, wanted: &[Wanted]) -> f64 {
    let record = read_record(file, "bench", wanted).expect("a good record");
    record.columns.iter().filter_map(|column| column.values.last()).sum()
}

fn with_csv(file: &Path, numbers: bool) -> f64 {
    let bytes = std::fs::read(file).expect("readable");
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let mut columns = vec![Vec::new(); reader.byte_headers().expect("a header").len()];
    let mut record = csv::ByteRecord::new();
    let mut cells = 0;
    while reader.read_byte_record(&mut record).expect("well formed") {
        if !numbers {
            cells += record.len();
            continue;
        }
        for (cell, column) in record.iter().zip(&mut columns) {
            column.push(fast_float2::parse::<f64, _>(cell).expect("a number"));
        }
    }
    cells as f64 + columns.iter().filter_map(|column| column.last()).sum::<f64>()
}

fn csv_files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("readable").path())
        .collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "csv"));
    files.sort();
    files
}

fn made(folder: &Path) -> Vec<PathBuf> {
    let mut text = String::from("time [s],distance [m]");
    (0..24).for_each(|n| write!(text, ",c{n} [kN]").expect("in memory"));
    for row in 0..2600 {
        write!(text, "\n{:.3},{:.3}", f64::from(row) * 0.005, 70.0 + f64::from(row) * 0.18)
            .expect("in memory");
        for n in 0..24 {
            let value = 60.0 * (f64::from(row) * 0.01 + f64::from(n)).sin();
            write!(text, ",{value:.2}").expect("in memory");
        }
    }
    (0..66)
        .map(|n| {
            let file = folder.join(format!("{n:02}.csv"));
            std::fs::write(&file, &text).expect("writable");
            file
        })
        .collect()
}
