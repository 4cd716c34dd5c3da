//! Inputs that are required to repeat an evaluation, and how imported records were made.

use crate::report::{document::*, number, sides::capital};
use crate::result::{CampaignInfo, FileHash, ImportedOne, ImportedSide, ProtocolInfo};

/// What a document is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One evaluation, which can be verified and traced.
    Certification,
    /// A study, a comparison or a diagnosis.
    Study,
}

/// The last chapter of every document with an evaluation.
pub fn provenance(campaign: &CampaignInfo, protocol: &ProtocolInfo, kind: Kind) -> Chapter {
    let same = "The same inputs give an identical document, byte for byte. It therefore contains no date of creation";
    let issued = super::identity::issued(&campaign.report)
        .unwrap_or_else(|| "which the campaign does not state".to_owned());
    let date = format!("{same}; the only date in its metadata is the date of issue, {issued}.");
    let bytes = number::count(campaign.files.iter().map(|file| file.bytes).sum());
    let mut blocks = vec![
        Block::on_paper([Block::text(date)]),
        Block::on_screen([Block::text(format!("{same}."))]),
        Block::Facts(vec![facts([
            ("Program", PROGRAM.into()),
            ("Protocol", (&protocol.name).into()),
            ("Protocol hash", Run::Hash(protocol.sha256.clone()).into()),
            ("Operations", format!("{} in the processing graph", protocol.graph_nodes).into()),
            ("Inputs", format!("{} files, {bytes} bytes", campaign.files.len()).into()),
        ])]),
        Block::Attached,
    ];
    blocks.extend((kind == Kind::Certification).then(verification));
    let sides: Vec<&ImportedSide> =
        campaign.origin.iter().flat_map(|origin| &origin.imported).collect();
    if !sides.is_empty() {
        blocks.push(Block::heading("How the records were made"));
        blocks.extend(sides.into_iter().flat_map(imported));
    }
    if !campaign.files.is_empty() {
        blocks.push(files(&campaign.files).into());
    }
    Chapter::new("provenance", "Provenance", blocks)
}

fn verification() -> Block {
    let verify = Run::Code("fishplate verify report.pdf CAMPAIGN".into());
    let trace =
        Run::Code("fishplate trace report.pdf QUANTITY SECTION SIGNAL --campaign CAMPAIGN".into());
    Block::text(
        Text::from("Verification: ")
            .then(verify)
            .and(" compares every input with its SHA-256, evaluates the protocol attached to the PDF again and compares every number. Tracing of a value: ")
            .then(trace)
            .and(" lists the lines of its rules, its files and their rows, its filters and the intermediate values."),
    )
}

/// The records of one side: what is the same for all of them is said once.
fn imported(side: &ImportedSide) -> [Block; 2] {
    let all = |holds: &dyn Fn(&ImportedOne) -> bool| side.records.iter().all(holds);
    let done = |record: &ImportedOne| {
        let mut done = [&[record.read_as.clone()][..], &record.steps].concat();
        done.retain(|step| !step.is_empty());
        done
    };
    let common = |step: &String| all(&|record| done(record).contains(step));
    let first = side.records.first().map(done).unwrap_or_default();
    let common: Vec<String> = first.into_iter().filter(common).collect();
    let row = |record: &ImportedOne| {
        let own = done(record).into_iter().filter(|step| !common.contains(step));
        let hash = Some(record.sha256.clone()).filter(|hash| !hash.is_empty());
        let file = Text::from(&record.file);
        vec![
            (&record.section).into(),
            Text::lines([file].into_iter().chain(hash.map(|hash| Run::Hash(hash).into()))).into(),
            own.collect::<Vec<_>>().join("; ").into(),
        ]
    };
    let name = &side.side;
    let mut says = Text::from(Run::Strong(format!("{}.", capital(name))))
        .and(format!(" Channels: {}.", side.channels.join("; ")));
    if !common.is_empty() {
        says = says.and(format!(" Every record: {}.", common.join("; ")));
    }
    let rows = side.records.iter().map(row);
    let table = Table::new(format!("Imported records, {name}"))
        .name("Section")
        .short("File and its SHA-256")
        .text("What was done")
        .wide(1.0)
        .rows(rows)
        .size(7.5);
    [Block::text(says), table.into()]
}

fn files(all: &[FileHash]) -> Table {
    let row = |file: &FileHash| -> Vec<Cell> {
        cells![file.path, file.bytes, Run::Hash(file.sha256.clone())]
    };
    Table::new("Input files and their SHA-256")
        .text("File")
        .wide(1.0)
        .breaks(40)
        .number("Bytes")
        .short("SHA-256")
        .rows(all.iter().map(row))
        .size(7.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_common_is_said_once() {
        let one = |section: &str, rows: &str| ImportedOne {
            section: section.into(),
            file: format!("{section}.csv"),
            sha256: String::new(),
            read_as: "csv".into(),
            steps: vec![rows.into(), "distance = Weg".into()],
        };
        let side = ImportedSide {
            side: "measurement".into(),
            channels: Vec::new(),
            records: vec![one("S01", "5 rows"), one("S02", "6 rows")],
        };
        let printed = |side: &ImportedSide| {
            let [Block::Paragraph(says), Block::Table(table)] = imported(side) else {
                panic!("a sentence and a table")
            };
            (says.letters(), table.printed("What was done"))
        };
        let (says, rows) = printed(&side);
        assert!(says.ends_with("Every record: csv; distance = Weg."), "{says}");
        assert_eq!(rows, ["5 rows", "6 rows"]);
        let mut other = side.clone();
        other.records[1].read_as = "mdf4".into();
        assert_eq!(printed(&other).1[1], "mdf4; 6 rows");
        assert!(printed(&ImportedSide { records: Vec::new(), ..side }).1.is_empty());
    }
}
