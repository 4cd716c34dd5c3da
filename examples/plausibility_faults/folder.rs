//! A campaign folder in memory, as texts, to be changed as by an error in its preparation.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// A CSV file.
#[derive(Clone)]
pub struct Table {
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

/// The kinds of record that a fault changes.
#[derive(Clone, Copy, PartialEq)]
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
}

#[derive(Clone)]
pub struct Folder {
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

    pub fn numbers(&self, column: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row[column].parse().unwrap_or(f64::NAN)).collect()
    }

    /// Writes numbers with the decimals of the column.
    pub fn set(&mut self, column: usize, values: &[f64]) {
        let decimals =
            self.rows.first().and_then(|row| row[column].split('.').nth(1)).map_or(0, str::len);
        for (row, value) in self.rows.iter_mut().zip(values) {
            row[column] = format!("{value:.decimals$}");
        }
    }
}

impl Folder {
    pub fn read(path: &Path) -> Self {
        let mut folder = Self { tables: BTreeMap::new(), texts: BTreeMap::new() };
        folder.add(path, "");
        folder
    }

    fn add(&mut self, path: &Path, below: &str) {
        for entry in fs::read_dir(path).expect("a folder").map(|entry| entry.expect("readable")) {
            let name = format!("{below}{}", entry.file_name().to_string_lossy());
            if entry.path().is_dir() {
                self.add(&entry.path(), &format!("{name}/"));
            } else if let Ok(text) = fs::read_to_string(entry.path()) {
                if name.ends_with(".csv") {
                    self.tables.insert(name, Table::parse(&text));
                } else {
                    self.texts.insert(name, text);
                }
            }
        }
    }

    pub fn write(&self, path: &Path) {
        let files = self.tables.iter().map(|(name, table)| (name, table.text()));
        for (name, text) in files.chain(self.texts.iter().map(|(name, text)| (name, text.clone())))
        {
            let file = path.join(name);
            fs::create_dir_all(file.parent().expect("below the folder")).expect("a folder");
            fs::write(file, text).expect("written");
        }
    }

    /// Names of the sections of a zone, or of all with `""`.
    pub fn sections(&self, zone: &str) -> Vec<String> {
        let table = &self.tables["sections.csv"];
        let of_zone = table.column("zone").expect("a zone");
        table
            .rows
            .iter()
            .filter(|row| zone.is_empty() || row[of_zone] == zone)
            .map(|row| row[0].clone())
            .collect()
    }

    /// A cell of the table of sections.
    pub fn cell(&mut self, section: &str, column: &str) -> &mut String {
        let table = self.tables.get_mut("sections.csv").expect("a table of sections");
        let at = table.column(column).expect("a column");
        let row = table.rows.iter_mut().find(|row| row[0] == section).expect("a section");
        &mut row[at]
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
                let table =
                    self.tables.get_mut(&format!("{folder}/{section}.csv")).expect("a record");
                for column in 0..table.header.len() {
                    let name =
                        table.header[column].split(" [").next().unwrap_or_default().to_string();
                    if begins.iter().any(|begin| name.starts_with(begin)) {
                        let changed = change(&table.numbers(column));
                        table.set(column, &changed);
                    }
                }
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
