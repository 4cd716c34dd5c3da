//! A campaign in memory gives what the same campaign gives from its folder.

#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema};

use fishplate::certify::certify;
use fishplate::data::campaign::Memory;
use fishplate::data::hash::sha256;
use fishplate::data::record::{Frame, ReadFrom, read_raw};
use fishplate::data::write::Values;
use fishplate::data::{Campaign, RecordKind};
use fishplate::prepare::{Protocol, prepare_opened};
use fishplate::problem::Problems;
use fishplate::result::Certification;
use fishplate::result::text as results;
use fishplate::run::Settings;

fn folder(example: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(example)
}

/// A record file as a table.
fn table(path: &Path) -> (Schema, RecordBatch) {
    let columns = read_raw(path, "record").unwrap();
    let (mut fields, mut arrays): (Vec<Field>, Vec<ArrayRef>) = (Vec::new(), Vec::new());
    for column in columns {
        let array: ArrayRef = match column.values {
            Values::Numbers(values) => Arc::new(Float64Array::from(values)),
            Values::Texts(texts) => Arc::new(StringArray::from(texts)),
        };
        fields.push(Field::new(column.heading, array.data_type().clone(), true));
        arrays.push(array);
    }
    let schema = Schema::new(fields);
    (schema.clone(), RecordBatch::try_new(Arc::new(schema), arrays).unwrap())
}

/// All parts of a campaign in memory; `named` says whether the records name their files.
fn memory(folder: &Path, named: bool) -> Memory {
    let mut memory = Memory::default();
    for name in ["campaign.yaml", "vehicle.yaml", "sections.csv", "application.csv"] {
        if let Ok(text) = std::fs::read(folder.join(name)) {
            memory.texts.insert(name.into(), text);
        }
    }
    for kind in RecordKind::ALL.map(RecordKind::key) {
        for entry in std::fs::read_dir(folder.join(kind)).unwrap() {
            let path = entry.unwrap().path();
            let name = format!("{kind}/{}", path.file_stem().unwrap().to_str().unwrap());
            let (schema, batch) = table(&path);
            // In two parts, which must not matter.
            let at = batch.num_rows() / 3;
            let batches = vec![batch.slice(0, at), batch.slice(at, batch.num_rows() - at)];
            let mut frame = Frame::new(&name, &schema, batches).unwrap();
            if named {
                let bytes = std::fs::read(&path).unwrap();
                frame = frame.read_from(ReadFrom {
                    ending: "csv",
                    sha256: sha256(&bytes),
                    bytes: bytes.len(),
                });
            }
            memory.records.insert(name, Arc::new(frame));
        }
    }
    memory
}

fn certified(campaign: Campaign) -> Certification {
    let mut problems = Problems::default();
    let pool = prepare_opened(vec![campaign], None, &[], &mut problems).unwrap();
    assert!(!problems.any_error(), "{}", problems.render(false));
    certify(&pool.compiled, &pool.campaigns, Settings { traces: 0 }, &|_| {}).unwrap()
}

fn opened(memory: Memory) -> Campaign {
    let mut problems = Problems::default();
    Campaign::with_memory(None, memory, &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)))
}

#[test]
fn the_results_are_the_same_bytes() {
    for example in ["coach", "coach-good"] {
        let files = certified(Campaign::open(&folder(example), &mut Problems::default()).unwrap());
        let memory = certified(opened(memory(&folder(example), true)));
        assert!(results(&files) == results(&memory), "{example}");
    }
}

/// Records that are not from files have the hash of their numbers.
#[test]
fn numbers_that_change_change_the_hash() {
    let hash = |found: &Certification| {
        found
            .campaign
            .files
            .iter()
            .find(|file| file.path == "measurement/S01")
            .unwrap()
            .sha256
            .clone()
    };
    let before = certified(opened(memory(&folder("coach"), false)));
    let mut changed = memory(&folder("coach"), false);
    let (schema, batch) = table(&folder("coach").join("measurement/S01.csv"));
    let whole = Frame::new("measurement/S01", &schema, vec![batch.clone()]).unwrap();
    changed.records.insert("measurement/S01".into(), Arc::new(whole));
    assert_eq!(hash(&before), hash(&certified(opened(changed.clone()))), "how it lies in memory");
    let mut columns = batch.columns().to_vec();
    let last = columns.len() - 1;
    columns[last] = Arc::new(Float64Array::from(vec![0.0; batch.num_rows()]));
    let other = RecordBatch::try_new(batch.schema(), columns).unwrap();
    changed.records.insert(
        "measurement/S01".into(),
        Arc::new(Frame::new("measurement/S01", &schema, vec![other]).unwrap()),
    );
    assert_ne!(hash(&before), hash(&certified(opened(changed))));
}

/// A missing value has its place, as in a file.
#[test]
fn a_faulty_value_is_named_with_its_row() {
    let mut parts = memory(&folder("coach"), false);
    let (schema, batch) = table(&folder("coach").join("measurement/S02.csv"));
    let at = schema.index_of("Y_1R [kN]").unwrap();
    let mut columns = batch.columns().to_vec();
    let values = (0..batch.num_rows()).map(|row| (row != 16).then_some(1.0));
    columns[at] = Arc::new(values.collect::<Float64Array>());
    let batch = RecordBatch::try_new(batch.schema(), columns).unwrap();
    parts.records.insert(
        "measurement/S02".into(),
        Arc::new(Frame::new("measurement/S02", &schema, vec![batch]).unwrap()),
    );
    let found = certified(opened(parts));
    let reason = found.sections[1].reason.as_ref().unwrap().text().to_string();
    assert!(["Y_1R", "measurement/S02", "17"].iter().all(|part| reason.contains(part)), "{reason}");
    assert!(found.sections[0].used);
}

/// What is not in memory is looked for nowhere else.
#[test]
fn nothing_is_read_from_the_disk() {
    let mut problems = Problems::default();
    let mut lacking = memory(&folder("coach"), false);
    lacking.texts.remove("vehicle.yaml");
    assert!(Campaign::with_memory(None, lacking, &mut problems).is_none());
    assert_eq!(problems.0[0].code, "file-missing", "{}", problems.render(false));

    let mut lacking = memory(&folder("coach"), false);
    lacking.records.remove("simulation/S03");
    let campaign = opened(lacking);
    let told = campaign.source_of(RecordKind::Simulation.into(), &campaign.names[2]).unwrap_err();
    assert_eq!(
        (told.code, told.says.as_str()),
        ("file-missing", "there is no record `simulation/S03` in memory")
    );
    // A program that needs files is refused.
    let told = campaign.record_place(RecordKind::Measurement, &campaign.names[0]).unwrap_err();
    assert_eq!(told.code, "record-in-memory");
    assert!(!campaign.on_disk());
}

/// Several campaigns in memory are not the same folder.
#[test]
fn campaigns_in_memory_form_a_pool() {
    let mut second = memory(&folder("coach-good"), false);
    let text = String::from_utf8(second.texts["campaign.yaml"].clone()).unwrap();
    let renamed: String = text
        .lines()
        .filter(|line| !line.starts_with("short name:"))
        .map(|line| format!("{line}\n"))
        .collect();
    second
        .texts
        .insert("campaign.yaml".into(), format!("short name: another\n{renamed}").into_bytes());
    let mut problems = Problems::default();
    let both = vec![opened(memory(&folder("coach"), false)), opened(second)];
    let pool =
        prepare_opened(both, Some(Protocol::Named("en14363-2016-annex-t")), &[], &mut problems)
            .unwrap();
    assert!(!problems.any_error(), "{}", problems.render(false));
    let found = certify(&pool.compiled, &pool.campaigns, Settings { traces: 0 }, &|_| {}).unwrap();
    assert_eq!(found.campaign.members.len(), 2);
}

/// The unit of a column stands in brackets or in the metadata of its field, and not differently in
/// both.
#[test]
fn units_of_columns() {
    let field = |name: &str, unit: &str| {
        Schema::new(vec![
            Field::new(name, DataType::Float64, true)
                .with_metadata([("unit".to_string(), unit.to_string())].into()),
        ])
    };
    assert!(Frame::new("r", &field("Y_1R", "kN"), Vec::new()).is_ok());
    assert!(Frame::new("r", &field("Y_1R [kN]", "kN"), Vec::new()).is_ok());
    assert_eq!(
        Frame::new("r", &field("Y_1R [kN]", "N"), Vec::new()).unwrap_err().code,
        "unit-conflict"
    );
    assert_eq!(Frame::new("r", &Schema::empty(), Vec::new()).unwrap_err().code, "file-empty");
}
