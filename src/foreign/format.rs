//! The formats: recognised by the content of a file, not by its ending.

use std::path::Path;

use super::Options;
use crate::problem::Problem;
use crate::yaml::Words;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Columns with a separator.
    Csv,
    /// Columns of fixed width or separated by blanks, with a list of channels before them.
    Ascii,
    Mdf4,
    /// MAT v5 to v7, and v7.3 (HDF5).
    Mat,
    Xlsx,
    Parquet,
    /// Arrow IPC file, Feather v2.
    Arrow,
    Tdms,
}

impl Words for Format {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("csv", Self::Csv),
        ("ascii", Self::Ascii),
        ("mdf4", Self::Mdf4),
        ("mat", Self::Mat),
        ("xlsx", Self::Xlsx),
        ("parquet", Self::Parquet),
        ("arrow", Self::Arrow),
        ("tdms", Self::Tdms),
    ];
}

impl Format {
    /// With its article, for messages, and the endings under which it is written.
    fn described(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Self::Csv => ("a CSV text", &[]),
            Self::Ascii => ("an ASCII text with columns", &[]),
            Self::Mdf4 => ("an ASAM MDF 4 file", &["mf4"]),
            Self::Mat => ("a MATLAB file", &["mat"]),
            Self::Xlsx => ("an Excel workbook (xlsx)", &["xlsx", "xlsm"]),
            Self::Parquet => ("a Parquet file", &["parquet", "pq"]),
            Self::Arrow => ("an Arrow file", &["arrow", "feather", "ipc"]),
            Self::Tdms => ("a TDMS file", &["tdms"]),
        }
    }

    /// With its article, for messages.
    pub(super) fn title(self) -> &'static str {
        self.described().0
    }

    fn is_text(self) -> bool {
        matches!(self, Self::Csv | Self::Ascii)
    }
}

/// A format that is not read: what it is, and the export that is read.
type NotRead = (&'static str, &'static str);

const EXCEL: &str = "save it in Excel or LibreOffice as .xlsx, or as CSV";
const TDMS: &str = "export it in DIAdem as TDMS (.tdms) or as CSV";
const FEATHER: &str = "write it as Feather version 2 or as Parquet, for example with pyarrow";
const MAT: &str = "save it in MATLAB with `save(file, '-v7')` or `'-v7.3'`";
const MDF: &str = "convert it to MDF 4, for example with asammdf: `asammdf.MDF(file).convert('4.10').save('x.mf4')`";
const NAMED: &str = "write it as Parquet or CSV with the names of the channels";
const PARQUET: &str = "write it as Parquet";
const UNPACK: &str = "unpack it, and import the files in it";

const DIADEM: NotRead = ("a DIAdem file", TDMS);
const DIADEM_HEADER: NotRead = ("a DIAdem header file", TDMS);
const MDF_3: NotRead = ("an ASAM MDF file of version 3", MDF);
const NETCDF: NotRead = (
    "a NetCDF file",
    "export it as CSV or Parquet, for example with xarray: `to_dataframe().to_parquet(file)`",
);
const SIMPACK: NotRead =
    ("a binary result of Simpack", "export the channels in the post-processor as ASCII or MATLAB");
const SPREADSHEET: NotRead = ("an OpenDocument spreadsheet", EXCEL);
const XLSB: NotRead = ("a binary Excel workbook (xlsb)", EXCEL);

/// First bytes of formats that are not read.
const SIGNATURES: &[(&[u8], NotRead)] = &[
    (
        b"\xd0\xcf\x11\xe0",
        ("an Excel workbook of the old format (xls) or another file of Microsoft Office", EXCEL),
    ),
    (b"CDF\x01", NETCDF),
    (b"CDF\x02", NETCDF),
    (b"CDF\x05", NETCDF),
    (b"FEA1", ("a Feather file of version 1", FEATHER)),
    (b"TDSh", ("the index of a TDMS file", "import the file without `_index` in its name")),
    (b"DIAEXTENDED", DIADEM_HEADER),
    (b"DIAdem", DIADEM_HEADER),
    (b"\x1f\x8b", ("a gzip file", UNPACK)),
    (b"7z\xbc\xaf\x27\x1c", ("a 7-Zip file", UNPACK)),
    (b"Rar!", ("a RAR file", UNPACK)),
    (b"\x28\xb5\x2f\xfd", ("a zstd file", UNPACK)),
    (b"BZh", ("a bzip2 file", UNPACK)),
    (b"\xfd7zXZ", ("an xz file", UNPACK)),
    (b"%PDF", ("a PDF document", "import the data that it was made from")),
    (b"\x93NUMPY", ("a NumPy file", NAMED)),
    (b"SQLite format 3", ("an SQLite database", "export its table as CSV")),
    (b"ORC", ("an ORC file", PARQUET)),
    (b"Obj\x01", ("an Avro file", PARQUET)),
];

/// Endings of formats that are not read and have no signature of their own.
const ENDINGS: &[(&str, NotRead)] = &[
    ("xls", ("an Excel workbook of the old format (xls)", EXCEL)),
    ("xlsb", XLSB),
    ("ods", SPREADSHEET),
    ("nc", NETCDF),
    ("mdf", MDF_3),
    ("mf3", MDF_3),
    ("tdm", DIADEM),
    ("tdx", DIADEM),
    ("r64", DIADEM),
    ("sbr", SIMPACK),
    ("spr", SIMPACK),
    ("pxp", ("an Igor file", "export it as CSV")),
    ("erg", ("a result of CarMaker", "export it as CSV or MDF 4")),
    ("sav", ("an SPSS file", "export it as CSV")),
    ("hdf", ("an HDF4 file", "convert it to a MATLAB 7.3 file, CSV or Parquet")),
];

/// The format of a file.
pub fn recognised(
    bytes: &[u8],
    path: &Path,
    shown: &str,
    options: &Options,
) -> Result<Format, Problem> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or("").to_lowercase();
    let not_read = |(what, help): NotRead| {
        Problem::error("format-not-read", format!("`{shown}` is {what}, which is not read"))
            .help(help)
    };
    let content = content(bytes, &ending).map_err(not_read)?;
    let mislabelled = |said: String, is: &str, help: &str| {
        Err(Problem::error("format-mislabelled", format!("{said}, but its content is {is}"))
            .help(help))
    };
    let said_to_be = |form: Format| format!("`{shown}` is said to be {}", form.title());
    let looks_text = !binary(bytes);
    match (options.form, content) {
        (Some(form), Some(content)) if form == content || form.is_text() && content.is_text() => {
            Ok(form)
        }
        (Some(form), Some(content)) => {
            let help = format!(
                "write `{}` for its form, or check whether this is the right file",
                content.word()
            );
            mislabelled(said_to_be(form), content.title(), &help)
        }
        (Some(form), None) if form.is_text() && looks_text => Ok(form),
        (Some(form), None) => {
            let is = if looks_text { "text" } else { "not of a known format" };
            mislabelled(said_to_be(form), is, "check whether the file is complete, and its form")
        }
        (None, Some(content)) => Ok(content),
        (None, None) => {
            let all = || Format::WORDS.iter().map(|(_, format)| *format);
            if let Some(format) =
                all().find(|format| format.described().1.contains(&ending.as_str()))
            {
                let is = if looks_text { "text" } else { "not of this format" };
                return mislabelled(
                    format!("`{shown}` ends like {}", format.title()),
                    is,
                    "check whether the file is complete; if it is a text, say `form: csv`",
                );
            }
            if looks_text {
                return Ok(Format::Csv);
            }
            if let Some((_, unread)) = ENDINGS.iter().find(|(known, _)| *known == ending) {
                return Err(not_read(*unread));
            }
            let words: Vec<&str> = Format::WORDS.iter().map(|(word, _)| *word).collect();
            Err(Problem::error(
                "format-unknown",
                format!("`{shown}` is neither a text nor of a known binary format"),
            )
            .help(format!("formats that are read: {}; export it in one of them", words.join(", "))))
        }
    }
}

/// The binary format of a content; `None` if there is no known signature.
fn content(bytes: &[u8], ending: &str) -> Result<Option<Format>, NotRead> {
    let starts = |signature: &[u8]| bytes.starts_with(signature);
    if let Some((_, unread)) = SIGNATURES.iter().find(|(signature, _)| starts(signature)) {
        return Err(*unread);
    }
    if starts(b"MDF     ") || starts(b"UnFinMF ") {
        return match bytes.get(8) {
            Some(b'4') => Ok(Some(Format::Mdf4)),
            _ => Err(("an ASAM MDF file of version 3 or older", MDF)),
        };
    }
    if starts(b"PK\x03\x04") || starts(b"PK\x05\x06") {
        return zip(bytes);
    }
    if starts(b"PAR1") {
        return Ok(Some(Format::Parquet));
    }
    if starts(b"PARE") {
        return Err(("an encrypted Parquet file", "write it without encryption"));
    }
    if starts(b"ARROW1") {
        return Ok(Some(Format::Arrow));
    }
    if starts(b"\xff\xff\xff\xff") && Format::Arrow.described().1.contains(&ending) {
        return Err((
            "an Arrow stream",
            "write it as an Arrow file, for example with `pyarrow.ipc.new_file`, or as Parquet",
        ));
    }
    if starts(b"TDSm") {
        return Ok(Some(Format::Tdms));
    }
    if hdf5(bytes) {
        return match ending {
            "nc" | "nc4" | "cdf" => Err(NETCDF),
            _ => Ok(Some(Format::Mat)),
        };
    }
    if starts(b"MATLAB 5.0")
        || matches!(bytes.get(124..128), Some([0, 1, b'I', b'M'] | [1, 0, b'M', b'I']))
    {
        return Ok(Some(Format::Mat));
    }
    // MAT v4 begins with a number of type, below 5000, and three small numbers.
    if ending == "mat" && matches!(bytes, [_, low, 0, 0, _, _, _, 0, _, _, _, 0, ..] if *low < 20) {
        return Err(("a MATLAB file of version 4", MAT));
    }
    if starts(b"<?xml") && contains(&bytes[..bytes.len().min(2048)], b"usi:") {
        return Err(DIADEM);
    }
    Ok(None)
}

/// The HDF5 signature, at the start or after a user block.
fn hdf5(bytes: &[u8]) -> bool {
    [0, 512, 1024, 2048]
        .into_iter()
        .any(|at| bytes.get(at..).is_some_and(|rest| rest.starts_with(b"\x89HDF\r\n\x1a\n")))
}

/// A zip archive, by the names in it, which are not compressed.
fn zip(bytes: &[u8]) -> Result<Option<Format>, NotRead> {
    let has = |name: &[u8]| contains(bytes, name);
    if has(b"xl/workbook.bin") {
        return Err(XLSB);
    }
    if has(b"xl/workbook.xml") || has(b"xl/worksheets/") {
        return Ok(Some(Format::Xlsx));
    }
    if has(b"opendocument.spreadsheet") {
        return Err(SPREADSHEET);
    }
    if has(b".npy") {
        return Err(("a NumPy archive", NAMED));
    }
    Err(("a zip archive", UNPACK))
}

fn contains(bytes: &[u8], what: &[u8]) -> bool {
    memchr::memmem::find(bytes, what).is_some()
}

/// Bytes looked at to tell text from other content.
const LOOKED_AT: usize = 4096;

/// Whether bytes are not a text: control characters, but for UTF-16 and UTF-32, where every other
/// byte or more is zero.
pub fn binary(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(LOOKED_AT)];
    if super::decode::wide(start).is_some() {
        return false;
    }
    start.iter().any(|byte| matches!(byte, 0..=8 | 14..=25 | 27..=31))
}

/// A format whose reader this program was built without.
#[cfg(not(feature = "foreign"))]
pub fn not_built(format: Format, shown: &str) -> Problem {
    Problem::error(
        "format-not-read",
        format!("`{shown}` is {}; this program was built without its reader", format.title()),
    )
    .help("build it with the feature `foreign`, or export the data as CSV or Parquet")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(bytes: &[u8], name: &str, form: Option<Format>) -> Result<Format, &'static str> {
        recognised(bytes, Path::new(name), name, &Options { form, ..Options::default() })
            .map_err(|problem| problem.code)
    }

    #[test]
    fn content_decides() {
        assert_eq!(code(b"a;b\n1;2\n", "x.dat", None), Ok(Format::Csv));
        assert_eq!(code(b"PAR1....", "x.dat", None), Ok(Format::Parquet));
        assert_eq!(code(b"MDF     4.10    ", "x.dat", None), Ok(Format::Mdf4));
        assert_eq!(code(b"MDF     3.30    ", "x.mf4", None), Err("format-not-read"));
        assert_eq!(code(b"\xd0\xcf\x11\xe0\0\0", "x.xlsx", None), Err("format-not-read"));
        assert_eq!(code(b"\x89HDF\r\n\x1a\n", "x.nc", None), Err("format-not-read"));
        assert_eq!(code(b"\x89HDF\r\n\x1a\n", "x.mat", None), Ok(Format::Mat));
        assert_eq!(
            code(b"\0\0\0\0\x02\0\0\0\x03\0\0\0\0\0\0\0", "x.mat", None),
            Err("format-not-read")
        );
        assert_eq!(
            code(b"PK\x03\x04..mimetypeapplication/vnd.oasis.opendocument.spreadsheet", "x", None),
            Err("format-not-read")
        );
    }

    #[test]
    fn a_wrong_label_is_told() {
        assert_eq!(code(b"a;b\n1;2\n", "x.mat", None), Err("format-mislabelled"));
        assert_eq!(code(b"a;b\n1;2\n", "x.mat", Some(Format::Csv)), Ok(Format::Csv));
        assert_eq!(code(b"a;b\n1;2\n", "x.csv", Some(Format::Mat)), Err("format-mislabelled"));
        assert_eq!(
            code(b"TDSm\x0e\0\0\0", "x.tdms", Some(Format::Parquet)),
            Err("format-mislabelled")
        );
        assert_eq!(code(b"\x01\x02\x03\x04", "x.csv", None), Err("format-unknown"));
    }
}
