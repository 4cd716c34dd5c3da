//! Records on a server: the same values as from files, few bytes, and what goes wrong is told with
//! the URL.

use crate::common::program;

use std::fs;
use std::path::{Path, PathBuf};

use program::{Ran, program, ran};
use tempfile::TempDir;

/// A campaign with two runs, and its table of sections, which was found on the disk.
struct Campaign {
    folder: TempDir,
    example: PathBuf,
}

impl Campaign {
    /// With the records below a URL, or copies of the files.
    fn new(records: Option<&str>) -> Self {
        let (folder, example) = (
            tempfile::tempdir().expect("a temporary folder"),
            Path::new("examples/run").to_path_buf(),
        );
        for name in ["vehicle.yaml", "profile.csv"] {
            fs::copy(example.join(name), folder.path().join(name)).expect("copied");
        }
        let text = fs::read_to_string(example.join("campaign.yaml")).expect("readable");
        let text = match records {
            Some(url) => text.replace(": records/", &format!(": {url}/")),
            None => text,
        };
        fs::write(folder.path().join("campaign.yaml"), format!("sections: sections.csv\n{text}"))
            .expect("written");
        let made = Self { folder, example };
        if records.is_none() {
            fs::create_dir(made.path("records")).expect("made");
            for file in fs::read_dir(made.example.join("records")).expect("a folder") {
                let file = file.expect("a file");
                fs::copy(file.path(), made.path("records").join(file.file_name())).expect("copied");
            }
        }
        let found = ran(program()
            .arg("sections")
            .arg(&made.example)
            .arg("--out")
            .arg(made.path("sections.csv")));
        assert_eq!(found.code, 0, "{}", found.stderr);
        made
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn reduce(&self, allowed: &str, more: &[&str]) -> Ran {
        let mut command = program();
        command
            .arg("reduce")
            .arg(self.folder.path())
            .arg("--no-plots")
            .arg("--out")
            .arg(self.path("values.parquet"));
        ran(command.args(more).env("FISHPLATE_STORES", allowed))
    }
}

#[test]
fn a_record_in_a_store_is_parquet() {
    let campaign = Campaign::new(Some("https://example.org/runs"));
    let text = fs::read_to_string(campaign.path("campaign.yaml")).expect("readable");
    fs::write(
        campaign.path("campaign.yaml"),
        text.replace("north-track.parquet", "north-track.csv"),
    )
    .expect("written");
    let found = campaign.reduce("", &[]);
    assert_eq!(found.code, 2, "{}", found.stderr);
    assert!(
        found.stderr.contains("error[format-not-read]") && found.stderr.contains("campaign.yaml"),
        "{}",
        found.stderr
    );
}

#[cfg(not(feature = "store"))]
#[test]
fn a_program_without_stores_says_so() {
    let campaign = Campaign::new(Some("https://example.org/runs"));
    let found = campaign.reduce("https://example.org/", &[]);
    let told = "`https://example.org/runs/north-simulated.parquet` is in a store, and this program was built without the feature `store`";
    let says = found.stdout + &found.stderr;
    assert!(says.contains(told), "{says}");
}

#[cfg(feature = "store")]
mod with_the_feature {
    use std::io::{BufRead, BufReader, Write};
    use std::net::{TcpListener, TcpStream};
    use std::process::Command;
    use std::sync::{Arc, Mutex};

    use parquet::arrow::ArrowWriter;
    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
    use serde_json::Value;

    use super::*;

    /// Rows of a row group: a run of the example has some ten.
    const ROWS: usize = 2000;

    /// A copy of a record in row groups as a long run has them.
    fn in_groups(from: &Path, to: &Path) {
        let open = |path: &Path| fs::File::open(path).expect("there");
        let reader = ParquetRecordBatchReaderBuilder::try_new(open(from)).expect("Parquet");
        let (schema, batches) =
            (reader.schema().clone(), reader.with_batch_size(ROWS).build().expect("readable"));
        let file = fs::File::create(to).expect("created");
        let mut writer = ArrowWriter::try_new(file, schema, None).expect("a writer");
        for batch in batches {
            writer.write(&batch.expect("rows")).expect("written");
            writer.flush().expect("a row group");
        }
        writer.close().expect("closed");
    }

    /// Serves the records of the example; the first part of a path says what goes wrong.
    struct Server {
        url: String,
        records: TempDir,
        /// Path and bytes of each answer with content.
        given: Arc<Mutex<Vec<(String, u64)>>>,
    }

    impl Server {
        fn start() -> Self {
            let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
            let url = format!("http://{}", listener.local_addr().expect("an address"));
            let given = Arc::new(Mutex::new(Vec::new()));
            let all = Arc::clone(&given);
            let records = tempfile::tempdir().expect("a temporary folder");
            for file in fs::read_dir("examples/run/records").expect("a folder") {
                let file = file.expect("a file");
                in_groups(&file.path(), &records.path().join(file.file_name()));
            }
            let folder = records.path().to_path_buf();
            std::thread::spawn(move || {
                for stream in listener.incoming().flatten() {
                    let (given, folder) = (Arc::clone(&all), folder.clone());
                    std::thread::spawn(move || while answer(&stream, &folder, &given).is_some() {});
                }
            });
            Self { url, records, given }
        }

        fn size(&self, name: &str) -> u64 {
            fs::metadata(self.records.path().join(name)).expect("there").len()
        }

        fn taken(&self) -> Vec<(String, u64)> {
            std::mem::take(&mut *self.given.lock().expect("no panic"))
        }
    }

    /// One request; nothing when the connection is to be closed.
    fn answer(
        mut stream: &TcpStream,
        folder: &Path,
        given: &Mutex<Vec<(String, u64)>>,
    ) -> Option<()> {
        let mut reader = BufReader::new(stream);
        let mut line = String::new();
        reader.read_line(&mut line).ok().filter(|read| *read > 0)?;
        let mut words = line.split(' ');
        let (method, path) = (words.next()?.to_string(), words.next()?.to_string());
        let mut range = None;
        loop {
            let mut header = String::new();
            reader.read_line(&mut header).ok().filter(|read| *read > 0)?;
            let header = header.trim().to_ascii_lowercase();
            if header.is_empty() {
                break;
            }
            if let Some(bytes) = header.strip_prefix("range: bytes=") {
                let (from, to) = bytes.split_once('-')?;
                range = Some((from.parse::<usize>().ok()?, to.parse::<usize>().ok()? + 1));
            }
        }
        let (_, fault, name) = path
            .split('/')
            .collect::<Vec<_>>()
            .try_into()
            .ok()
            .map(|[a, b, c]: [&str; 3]| (a, b, c))?;
        let content = fs::read(folder.join(name)).ok().filter(|_| fault != "missing");
        let Some(content) = content else {
            return write!(stream, "HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n").ok();
        };
        let size = content.len();
        let head =
            "Last-Modified: Thu, 26 Nov 2026 10:00:00 GMT\r\nETag: \"one\"\r\nAccept-Ranges: bytes";
        if method == "HEAD" {
            return write!(stream, "HTTP/1.1 200 OK\r\nContent-Length: {size}\r\n{head}\r\n\r\n")
                .ok();
        }
        let (from, to) = range?;
        given.lock().expect("no panic").push((name.to_string(), (to - from) as u64));
        let part = &content[from..to];
        let (told, sent) = match fault {
            // The connection ends in the middle of what was announced.
            "cut" if to - from > 1000 => (part.len(), &part[..part.len() / 2]),
            // Fewer bytes than were asked for, and announced as such.
            "short" if to - from > 1000 => (part.len() - 1, &part[..part.len() - 1]),
            _ => (part.len(), part),
        };
        write!(stream, "HTTP/1.1 206 Partial Content\r\nContent-Length: {told}\r\n").ok()?;
        write!(stream, "Content-Range: bytes {from}-{}/{size}\r\n{head}\r\n\r\n", to - 1).ok()?;
        stream.write_all(sent).ok().filter(|()| told == sent.len())
    }

    /// The values and verdicts of a campaign.
    fn judged(campaign: &Campaign) -> Value {
        let out = campaign.path("judged");
        let done = ran(program()
            .arg("judge")
            .arg(campaign.path("values.parquet"))
            .args(["--only", "results", "--out"])
            .arg(&out));
        assert!(done.code < 2, "{}", done.stderr);
        serde_json::from_str(&fs::read_to_string(out.join("results.json")).expect("readable"))
            .expect("JSON")
    }

    #[test]
    fn the_same_values_as_from_files() {
        let server = Server::start();
        let (near, far) =
            (Campaign::new(None), Campaign::new(Some(&format!("{}/runs", server.url))));
        for campaign in [&near, &far] {
            let done = campaign.reduce(&server.url, &[]);
            assert_eq!(done.code, 0, "{}", done.stderr);
        }
        let (one, other) = (judged(&near), judged(&far));
        for key in ["verdict", "reasons", "quantities", "zones"] {
            assert_eq!(one[key], other[key], "{key}");
        }
        assert!(one["quantities"].as_array().is_some_and(|all| all.len() > 10));
        let text = other.to_string();
        assert!(text.contains(&format!("{}/runs/north-measured.parquet", server.url)));
        // What neighbouring sections have in common is asked for once.
        let files = [
            "north-measured",
            "north-simulated",
            "north-track",
            "south-measured",
            "south-simulated",
            "south-track",
        ];
        let whole: u64 = files.iter().map(|name| server.size(&format!("{name}.parquet"))).sum();
        let read: u64 = server.taken().iter().map(|(_, bytes)| bytes).sum();
        assert!(read < whole * 11 / 10, "{read} of {whole} bytes");
    }

    #[test]
    fn sections_are_found_in_a_store() {
        let server = Server::start();
        let far = Campaign::new(Some(&format!("{}/runs", server.url)));
        let text = fs::read_to_string(far.path("campaign.yaml")).expect("readable");
        fs::write(far.path("campaign.yaml"), text.replace("sections: sections.csv\n", ""))
            .expect("written");
        let out = far.path("again.csv");
        let done = ran(program()
            .arg("sections")
            .arg(far.folder.path())
            .arg("--out")
            .arg(&out)
            .env("FISHPLATE_STORES", &server.url));
        assert_eq!(done.code, 0, "{}", done.stderr);
        assert_eq!(
            fs::read(out).expect("written"),
            fs::read(far.path("sections.csv")).expect("there")
        );
    }

    #[test]
    fn one_section_reads_its_part_of_the_run() {
        let server = Server::start();
        let far = Campaign::new(Some(&format!("{}/runs", server.url)));
        let table = fs::read_to_string(far.path("sections.csv")).expect("readable");
        let rows: Vec<&str> = table.lines().collect();
        let south = rows.iter().find(|row| row.contains("south")).expect("a section");
        fs::write(far.path("sections.csv"), format!("{}\n{south}\n", rows[0])).expect("written");
        let done = far.reduce(&server.url, &["--jobs", "1"]);
        assert_eq!(done.code, 0, "{}", done.stderr);
        let taken = server.taken();
        let of = |name: &str| {
            taken.iter().filter(|(of, _)| of == name).map(|(_, bytes)| bytes).sum::<u64>()
        };
        // Of some ten row groups, two or three have the section and what is beside it.
        for name in ["south-measured.parquet", "south-simulated.parquet"] {
            let (read, whole) = (of(name), server.size(name));
            assert!(read > whole / 20 && read < whole / 2, "{name}: {read} of {whole} bytes");
        }
        assert_eq!(of("north-measured.parquet"), 0, "the other run is not opened");
    }

    /// A campaign with a record for each section, as Parquet; the records in a folder of their own.
    fn of_sections() -> TempDir {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let out = folder.path().join("campaign");
        let made = ran(program()
            .args(["convert-records", "examples/coach", "--to", "parquet", "--out"])
            .arg(&out));
        assert_eq!(made.code, 0, "{}", made.stderr);
        for name in ["measurement", "simulation"] {
            fs::rename(out.join(name), folder.path().join(name)).expect("moved");
        }
        folder
    }

    #[test]
    fn records_of_sections_are_in_folders_of_a_store() {
        let folder = of_sections();
        let campaign = folder.path().join("campaign");
        let url = format!("file://{}", folder.path().display());
        let text = fs::read_to_string(campaign.join("campaign.yaml")).expect("readable");
        let far: String = text
            .lines()
            .map(|line| match line.split_once(':') {
                Some((key @ ("measurement" | "simulation"), _)) => format!("{key}: {url}/{key}/\n"),
                _ => format!("{line}\n"),
            })
            .collect();
        assert_eq!(far.matches(&url).count(), 2, "{far}");
        let certified = |text: &str, campaign: &Path, out: &str, allowed: &str| {
            fs::write(campaign.join("campaign.yaml"), text).expect("written");
            let out = folder.path().join(out);
            let mut command = program();
            command
                .arg("certify")
                .arg(campaign)
                .args(["--only", "results", "--out"])
                .arg(&out)
                .env("FISHPLATE_STORES", allowed);
            let done = ran(&mut command);
            let json = fs::read_to_string(out.join("results.json"))
                .map(|text| serde_json::from_str::<Value>(&text).expect("JSON"));
            (done, json.unwrap_or_default())
        };
        let (done, far_results) = certified(&far, &campaign, "far", &format!("{url}/"));
        assert!(done.code < 2, "{}", done.stderr);
        // The same campaign with its records inside.
        let near = folder.path().join("near");
        let copied =
            Command::new("cp").arg("-r").arg(&campaign).arg(&near).status().expect("started");
        assert!(copied.success());
        for name in ["measurement", "simulation"] {
            let copied = Command::new("cp")
                .arg("-r")
                .arg(folder.path().join(name))
                .arg(&near)
                .status()
                .expect("started");
            assert!(copied.success());
        }
        let (done, near_results) = certified(&text, &near, "near-out", "");
        assert!(done.code < 2, "{}", done.stderr);
        for key in ["verdict", "reasons", "quantities", "zones"] {
            assert_eq!(far_results[key], near_results[key], "{key}");
        }
        assert!(
            far_results.to_string().contains(&format!("{url}/measurement/")),
            "the files are named by their URLs"
        );
        // A store that is not allowed, a section without a record, a campaign that does not name
        // its sections.
        let (done, results) = certified(&far, &campaign, "refused", "");
        assert!(
            format!("{}{}{results}", done.stdout, done.stderr).contains("may not be read"),
            "{}",
            done.stderr
        );
        let first = fs::read_dir(folder.path().join("measurement"))
            .expect("a folder")
            .next()
            .expect("a record")
            .expect("a file");
        fs::remove_file(first.path()).expect("removed");
        let (_, results) = certified(&far, &campaign, "missing", &format!("{url}/"));
        assert!(results.to_string().contains("there is no object"), "{results}");
        let unnamed = far
            .lines()
            .filter(|line| !line.starts_with("sections:"))
            .collect::<Vec<_>>()
            .join("\n");
        fs::remove_file(campaign.join("sections.csv")).expect("removed");
        let (done, _) = certified(&unnamed, &campaign, "unnamed", &format!("{url}/"));
        assert_eq!(done.code, 2);
        assert!(done.stderr.contains("the campaign must name its sections"), "{}", done.stderr);
    }

    #[test]
    fn faults_name_the_url() {
        let server = Server::start();
        for (fault, says) in [
            ("missing", "there is no object"),
            ("cut", "cannot be read"),
            ("short", "cannot be read"),
        ] {
            let url = format!("{}/{fault}", server.url);
            let far = Campaign::new(Some(&url));
            let done = far.reduce(&server.url, &["--jobs", "1", "--shard", "0/12"]);
            let told = format!("{}{}", done.stdout, done.stderr);
            let values = fs::read(far.path("values.parquet"))
                .map(|_| judged(&far).to_string())
                .unwrap_or_default();
            assert!(
                [&told, &values].iter().any(|text| text.contains(says) && text.contains(&url)),
                "{fault}: {told}\n{values}"
            );
        }
    }

    #[test]
    fn no_connection_is_opened_unasked() {
        let server = Server::start();
        let far = Campaign::new(Some(&format!("{}/runs", server.url)));
        for allowed in ["", "http://127.0.0.1", "http://127.0.0.1:1/"] {
            let done = far.reduce(allowed, &[]);
            let told = format!("{}{}", done.stdout, done.stderr);
            assert!(
                told.contains("may not be read") && told.contains("FISHPLATE_STORES"),
                "{told}"
            );
        }
        assert!(server.taken().is_empty());
    }
}
