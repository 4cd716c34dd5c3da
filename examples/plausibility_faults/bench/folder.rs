//! A campaign folder in memory, to be changed as by an error in its preparation.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The table of sections.
pub const SECTIONS: &str = "sections.csv";

/// A CSV file of texts.
#[derive(Clone)]
pub struct Table {
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

/// A record: columns of numbers, with the decimals of their text.
#[derive(Clone)]
pub struct Record {
    pub header: Vec<String>,
    pub columns: Vec<Vec<f64>>,
    pub decimals: Vec<usize>,
    /// Cells whose text is not that of their number, by row and column.
    pub cells: Vec<(usize, usize, String)>,
}

/// The kinds of record that a fault changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Simulation,
    Measurement,
    Both,
}

impl Side {
    pub fn folders(self) -> &'static [&'static str] {
        match self {
            Self::Simulation => &["simulation"],
            Self::Measurement => &["measurement"],
            Self::Both => &["simulation", "measurement"],
        }
    }

    pub fn in_words(self) -> &'static str {
        match self {
            Self::Simulation => "simulated",
            Self::Measurement => "measured",
            Self::Both => "measured and simulated",
        }
    }
}

/// The files of a campaign as they are on the disk.
struct Origin {
    path: PathBuf,
    records: BTreeMap<String, Record>,
    others: Vec<String>,
}

/// A campaign, and what was changed in it.
#[derive(Clone)]
pub struct Folder {
    origin: Arc<Origin>,
    records: BTreeMap<String, Record>,
    pub tables: BTreeMap<String, Table>,
    pub texts: BTreeMap<String, String>,
}

impl Table {
    fn parse(text: &str) -> Self {
        let mut lines =
            text.lines().map(|line| line.split(',').map(str::to_string).collect::<Vec<_>>());
        Self { header: lines.next().unwrap_or_default(), rows: lines.collect() }
    }

    fn text(&self) -> String {
        let line = |cells: &Vec<String>| cells.join(",") + "\n";
        line(&self.header) + &self.rows.iter().map(line).collect::<String>()
    }

    /// The column of a name without its unit.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|cell| cell.split(" [").next() == Some(name))
    }
}

impl Record {
    /// `None` if a cell is not a number.
    fn parse(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        let header: Vec<String> = lines.next()?.split(',').map(str::to_string).collect();
        let mut columns = vec![Vec::new(); header.len()];
        let mut decimals = vec![0; header.len()];
        for line in lines {
            for (at, cell) in line.split(',').enumerate() {
                columns.get_mut(at)?.push(cell.parse().ok()?);
                decimals[at] = decimals[at].max(cell.split('.').nth(1).map_or(0, str::len));
            }
        }
        Some(Self { header, columns, decimals, cells: Vec::new() })
    }

    fn text(&self) -> String {
        use std::fmt::Write as _;
        let mut text = self.header.join(",") + "\n";
        for row in 0..self.rows() {
            for (at, column) in self.columns.iter().enumerate() {
                let end = if at + 1 == self.columns.len() { '\n' } else { ',' };
                let changed = self.cells.iter().find(|(r, c, _)| (*r, *c) == (row, at));
                match changed {
                    Some((.., cell)) => text.extend(cell.chars().chain([end])),
                    None => {
                        let decimals = self.decimals[at];
                        write!(text, "{:.decimals$}{end}", column[row]).expect("a text");
                    }
                }
            }
        }
        text
    }

    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// The column of a name without its unit.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|cell| name_of(cell) == name)
    }

    pub fn values(&self, name: &str) -> &[f64] {
        &self.columns[self.column(name).expect("a channel")]
    }

    pub fn set(&mut self, name: &str, values: Vec<f64>) {
        let column = self.column(name).expect("a channel");
        self.columns[column] = values;
    }

    /// Names of the channels, without those of the axis.
    pub fn channels(&self) -> Vec<String> {
        let names = self.header.iter().map(|cell| name_of(cell).to_string());
        names.filter(|name| !["time", "distance"].contains(&name.as_str())).collect()
    }

    /// Keeps some of the rows.
    pub fn keep(&mut self, keep: impl Fn(usize) -> bool) {
        for column in &mut self.columns {
            let mut row = 0;
            column.retain(|_| {
                row += 1;
                keep(row - 1)
            });
        }
    }
}

fn name_of(cell: &str) -> &str {
    cell.split(" [").next().unwrap_or_default()
}

impl Folder {
    pub fn read(path: &Path) -> Self {
        let mut origin =
            Origin { path: path.to_path_buf(), records: BTreeMap::new(), others: Vec::new() };
        let (mut tables, mut texts) = (BTreeMap::new(), BTreeMap::new());
        for name in files(path, "") {
            let Ok(text) = fs::read_to_string(path.join(&name)) else {
                origin.others.push(name);
                continue;
            };
            if !name.ends_with(".csv") {
                texts.insert(name, text);
            } else if name.contains('/') {
                match Record::parse(&text) {
                    Some(record) => drop(origin.records.insert(name, record)),
                    None => origin.others.push(name),
                }
            } else {
                tables.insert(name, Table::parse(&text));
            }
        }
        Self { origin: Arc::new(origin), records: BTreeMap::new(), tables, texts }
    }

    /// Where it was read from.
    pub fn path(&self) -> &Path {
        &self.origin.path
    }

    /// Writes it; records that were not changed are links to those of the origin, or stay where it
    /// is written to the origin itself.
    pub fn write(&self, path: &Path) {
        let open = |name: &str| {
            let file = path.join(name);
            fs::create_dir_all(file.parent().expect("below the folder")).expect("a folder");
            file
        };
        let unchanged =
            self.origin.records.keys().filter(|name| !self.records.contains_key(name.as_str()));
        for name in unchanged.chain(&self.origin.others) {
            let (from, to) = (self.origin.path.join(name), open(name));
            if from != to && fs::hard_link(&from, &to).is_err() {
                fs::copy(&from, &to).expect("copied");
            }
        }
        let records = self.records.iter().map(|(name, record)| (name, record.text()));
        let tables = self.tables.iter().map(|(name, table)| (name, table.text()));
        let texts = self.texts.iter().map(|(name, text)| (name, text.clone()));
        for (name, text) in records.chain(tables).chain(texts) {
            fs::write(open(name), text).expect("written");
        }
    }

    /// Names of the sections of a zone, or of all with `""`.
    pub fn sections(&self, zone: &str) -> Vec<String> {
        let table = &self.tables[SECTIONS];
        let of_zone = table.column("zone").expect("a zone");
        let rows = table.rows.iter().filter(|row| zone.is_empty() || row[of_zone] == zone);
        rows.map(|row| row[0].clone()).collect()
    }

    /// A cell of the table of sections.
    pub fn cell(&mut self, section: &str, column: &str) -> &mut String {
        let table = self.tables.get_mut(SECTIONS).expect("a table of sections");
        let at = table.column(column).expect("a column");
        let row = table.rows.iter_mut().find(|row| row[0] == section).expect("a section");
        &mut row[at]
    }

    /// A number of the table of sections; none on straight track.
    pub fn fact(&self, section: &str, column: &str) -> Option<f64> {
        let table = &self.tables[SECTIONS];
        let row = table.rows.iter().find(|row| row[0] == section)?;
        row[table.column(column)?].parse().ok()
    }

    /// A record as `simulation/S01.csv`.
    pub fn record(&self, name: &str) -> &Record {
        self.records.get(name).unwrap_or_else(|| &self.origin.records[name])
    }

    /// A record, to be changed.
    pub fn record_mut(&mut self, name: &str) -> &mut Record {
        let origin = &self.origin.records;
        self.records.entry(name.to_string()).or_insert_with(|| origin[name].clone())
    }

    /// A record in place of another, or a new one.
    pub fn put(&mut self, name: &str, record: Record) {
        self.records.insert(name.to_string(), record);
    }

    /// Changes channels that begin with one of the names, in the records of some sections.
    pub fn channels(
        &mut self,
        side: Side,
        sections: &[String],
        begins: &[&str],
        change: impl Fn(&[f64]) -> Vec<f64>,
    ) {
        for folder in side.folders() {
            for section in sections {
                let record = self.record_mut(&format!("{folder}/{section}.csv"));
                for column in 0..record.header.len() {
                    let name = name_of(&record.header[column]);
                    if begins.iter().any(|begin| name.starts_with(begin)) {
                        record.columns[column] = change(&record.columns[column]);
                    }
                }
            }
        }
    }

    /// Changes one channel: from its samples, the rate in Hz, and the number of the section.
    pub fn channel(
        &mut self,
        side: Side,
        sections: &[String],
        name: &str,
        change: impl Fn(&[f64], f64, usize) -> Vec<f64>,
    ) {
        for folder in side.folders() {
            for (n, section) in sections.iter().enumerate() {
                let record = self.record_mut(&format!("{folder}/{section}.csv"));
                let values = change(record.values(name), super::signal::rate(record), n);
                record.set(name, values);
            }
        }
    }

    /// Changes a value of the vehicle file.
    pub fn vehicle(&mut self, key: &str, value: impl Fn(&str) -> String) {
        let text = self.texts.get_mut("vehicle.yaml").expect("a vehicle");
        let line = |line: &str| match line.strip_prefix(&format!("{key}:")) {
            Some(old) => format!("{key}: {}", value(old.split('#').next().unwrap_or("").trim())),
            None => line.to_string(),
        };
        *text = text.lines().map(line).collect::<Vec<_>>().join("\n") + "\n";
    }
}

/// The files of a folder, relative to it.
fn files(path: &Path, below: &str) -> Vec<String> {
    let mut all = Vec::new();
    for entry in fs::read_dir(path).expect("a folder").map(|entry| entry.expect("readable")) {
        let name = format!("{below}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            all.extend(files(&entry.path(), &format!("{name}/")));
        } else {
            all.push(name);
        }
    }
    all.sort();
    all
}
