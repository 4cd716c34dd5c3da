//! Text tables in the dialects of measuring systems and simulation programs.

use fishplate::foreign::{DateOrder, DecimalMark, Format, Options, Separator};
use fishplate::problem::Problems;

use super::text;

/// Channels as `name [unit] values`.
fn read(content: &[u8], options: &Options) -> Vec<String> {
    let file = text("x.txt", content, options)
        .unwrap_or_else(|problems| panic!("{}", Problems(problems).render(false)));
    let table = &file.tables[0];
    table
        .channels
        .iter()
        .map(|channel| {
            format!(
                "{} [{}] {:?}",
                channel.name,
                channel.unit.as_deref().unwrap_or(""),
                channel.values
            )
        })
        .collect()
}

#[track_caller]
fn refused(content: &[u8], options: &Options) -> (String, String) {
    let problems = text("x.txt", content, options).map(|_| ()).expect_err("refused");
    let place = problems[0].at.as_ref().map(ToString::to_string).unwrap_or_default();
    (problems[0].code.to_string(), place)
}

const TWO: [&str; 2] = ["t [s] [0.0, 0.5]", "y [kN] [1.5, -2.0]"];

#[test]
fn dialects() {
    let none = Options::default();
    for content in [
        &b"t;y\ns;kN\n0;1,5\n0,5;-2\n"[..],
        b"t,y\ns,kN\n0,1.5\n0.5,-2\n",
        b"t [s]\ty [kN]\r\n0\t1.5\r\n0.5\t-2\r\n",
        b"t (s);y (kN)\r0;1,5\r0,5;-2\r",
        b"\"t\";\"y\"\n\"s\";\"kN\"\n\"0\";\"1,5\"\n\"0,5\";\"-2,0\"\n",
        b"Messung;Wagen 5\nDatum: 13.5.2024\n\nt;y;\n[s];[kN];\n0;1,5;\n0,5;-2;\n",
        b"# t y\n0 1.5\n0.5 -2\n",
        b"# Channel 1: t [s]\n# Channel 2: y [kN]\n  0.0   1.5\n  0.5  -2.0\n",
        b"* GENSYS\n* 1 t s\n* 2 y kN\n*\n 0.0D+00 1.5D+00\n 5.0D-01-2.0D+00\n",
        b"% units after the names\n! t / s   y / kN\n0|1.5\n% a comment between\n0.5|-2\n",
        b"\xff\xfet\0;\0y\0\n\0s\0;\0k\0N\0\n\x000\0;\x001\0,\x005\0\n\x000\0,\x005\0;\0-\x002\0\n\0",
    ] {
        let found = read(content, &none);
        let name = String::from_utf8_lossy(content);
        if content.starts_with(b"# t y") || content.starts_with(b"% units") {
            assert_eq!(found.len(), 2, "{name}");
        } else {
            assert_eq!(found, TWO, "{name}");
        }
    }
}

#[test]
fn what_is_said_is_stronger_than_what_is_detected() {
    let said = Options { names_line: Some(1), units_line: Some(3), ..Options::default() };
    assert_eq!(read(b"t;y\nTime;Force\ns;kN\n0;1,5\n0,5;-2\n", &said), TWO);
    let said = Options {
        header_lines: Some(2),
        separator: Some(Separator::Mark(';')),
        decimal: Some(DecimalMark::Comma),
        ..Options::default()
    };
    assert_eq!(read(b"a;b\n1;2\n3;4\n", &said), ["a [] [3.0]", "b [] [4.0]"]);
    let said =
        Options { comment: Some("REM".into()), form: Some(Format::Csv), ..Options::default() };
    assert_eq!(
        read(b"REM x\nt;y\n0;1\nREM y\n1;2\n", &said),
        ["t [] [0.0, 1.0]", "y [] [1.0, 2.0]"]
    );
    let said = Options { encoding: Some("windows-1250".into()), ..Options::default() };
    assert_eq!(read(b"t;\xe8\n0;1\n1;2\n", &said)[1], "č [] [1.0, 2.0]");
}

#[test]
fn times_are_seconds_from_the_first() {
    let none = Options::default();
    for content in [
        &b"Zeit;y\n13.05.2024 23:59:59,500;1\n14.05.2024 00:00:00,000;2\n"[..],
        b"time,y\n2024-05-13T23:59:59.5Z,1\n2024-05-14T00:00:00Z,2\n",
        b"Datum;Uhrzeit;y\n13.05.2024;23:59:59,5;1\n14.05.2024;00:00:00,0;2\n",
        b"clock;y\n23:59:59.5;1\n00:00:00.0;2\n",
        b"time;y\n05/13/2024 11:59:59.5 PM;1\n05/14/2024 12:00:00.0 AM;2\n",
    ] {
        let found = read(content, &none);
        assert!(found[0].ends_with("[s] [0.0, 0.5]"), "{found:?}");
        assert_eq!(found.len(), 2, "{found:?}");
    }
    let unclear = b"time;y\n03/04/2024 10:00:00;1\n04/04/2024 10:00:00;2\n";
    assert_eq!(refused(unclear, &none), ("date-order".into(), "x.txt:1:1".into()));
    let said = Options { dates: Some(DateOrder::MonthDayYear), ..Options::default() };
    assert_eq!(read(unclear, &said)[0], format!("time [s] [0.0, {:?}]", 31.0 * 86400.0));
}

#[test]
fn faults_have_their_place() {
    let none = Options::default();
    for (content, code, place) in [
        (&b"t;y\n0;1\n1;abc\n2;3\n"[..], "not-a-number", "x.txt:3:3"),
        (b"t;y\n0;1,5\n1;1.234,5\n2;3\n", "thousands", "x.txt:3:3"),
        (b"t;y\n0;1,5\n1;1.5\n2;3,5\n", "decimal-comma", "x.txt:3:3"),
        (b"t;y\n0;1\n1;2;3\n2;3\n", "ragged-row", "x.txt:3:5"),
        (b"t;y\n0;1\n1\n2;3\n", "ragged-row", "x.txt:3:1"),
        (b"t;y\n0;1\n1;inf\n2;3\n", "not-finite", "x.txt:3:3"),
        (b"t;y\n2026-11-05 10:00:00;1\n2026-13-05 10:00:01;2\n", "not-a-date", "x.txt:3:1"),
        (b"y;d;c\n1;05.11.2026;10:00:00\n2;32.11.2026;10:00:01\n", "not-a-date", "x.txt:3:3"),
        (b"nothing here\n", "no-numbers", "x.txt:1:1"),
        (b"\n\n\n", "no-numbers", ""),
        (b"t;y\n0;1\n\x00\x01\x02", "format-unknown", ""),
    ] {
        assert_eq!(
            refused(content, &none),
            (code.into(), place.into()),
            "{}",
            String::from_utf8_lossy(content)
        );
    }
    let said = Options { names_line: Some(9), ..Options::default() };
    assert_eq!(refused(b"t;y\n0;1\n1;2\n", &said).0, "no-numbers");
    let said = Options { units_line: Some(1), names_line: Some(2), ..Options::default() };
    assert_eq!(refused(b"one\nt;y\n0;1\n1;2\n", &said).0, "header-line");
    assert_eq!(
        text("x.csv", b"", &none).map(|_| ()).map_err(|problems| problems[0].code),
        Err("file-empty")
    );
}

#[test]
fn texts_and_empty_cells() {
    let file = text("x.csv", b"t;note;y;z\n0;ok;;\n1;ok;2;\n2;;NaN;\n", &Options::default())
        .expect("read");
    let table = &file.tables[0];
    assert_eq!(
        table.channels.iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>(),
        ["t", "y"]
    );
    assert!(table.channels[1].values[0].is_nan() && table.channels[1].values[2].is_nan());
    assert_eq!(
        table.left_out.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        ["note", "z"]
    );
}
