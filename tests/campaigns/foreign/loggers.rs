//! Files as data loggers write them: read to the numbers that an independent library reads, or
//! refused with the reason. The files are in `tests/cases/foreign`.

use std::path::{Path, PathBuf};

use fishplate::foreign::{Channel, File, Options, read};
use fishplate::problem::Problems;

const CASES: &str = "tests/cases/foreign";

fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(CASES).join(name)
}

#[track_caller]
fn good(name: &str) -> File {
    read(&case(name), name, &Options::default())
        .unwrap_or_else(|problems| panic!("{}", Problems(problems).render(false)))
}

#[track_caller]
fn channel<'a>(file: &'a File, name: &str) -> &'a Channel {
    let mut channels = file.tables.iter().flat_map(|table| &table.channels);
    channels.find(|channel| channel.name == name).expect("the channel")
}

/// An object that a kept list of objects has without data (npTDMS 1.13: the numbers).
#[test]
fn an_object_without_data_in_a_segment_takes_none() {
    let file = good("tdms-no-data-in-kept-list.tdms");
    assert_eq!(channel(&file, "ch1").values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(channel(&file, "ch2").values, [11.0, 12.0, 13.0, 14.0, 15.0, 16.0]);
}

/// The last of two scales takes the raw values, `10 raw - 3` (npTDMS 1.13: the numbers).
#[test]
fn a_scale_takes_the_raw_values_where_it_says_so() {
    let file = good("tdms-scale-of-raw.tdms");
    let values = &channel(&file, "c").values;
    assert_eq!((values.len(), values[0], values[1], values[49]), (50, -7403.0, -7033.0, 10_727.0));
}

/// Floats of 16 bits (asammdf 8.8: the numbers), the same signal as the floats of 32 bits beside
/// them to a half unit of the eleventh bit.
#[test]
fn floats_of_16_bits_are_read() {
    let file = good("mdf4-half-float.mf4");
    let (half, single) = (&channel(&file, "Y").values, &channel(&file, "Z").values);
    assert_eq!(half[..4], [0.0, 0.699_218_75, 1.395_507_812_5, 2.083_984_375]);
    assert_eq!((half.len(), half[59]), (60, -8.351_562_5));
    for (half, single) in half.iter().zip(single) {
        assert!((half - single).abs() <= single.abs() * 2f64.powi(-11), "{half} {single}");
    }
}

/// Whole numbers of 12 bits that begin at the second of 16 (h5py 3.16: the numbers).
#[test]
fn numbers_of_reduced_precision_are_read() {
    let file = good("hdf5-12-bit-integers.mat");
    let wanted: Vec<f64> = (-200..200).map(f64::from).collect();
    assert_eq!(channel(&file, "x").values, wanted);
}

/// Whole numbers of few bits, and floats of 16 bits; floats that are not those of IEEE 754 are left
/// out. Written and read back by h5py 3.16.
#[test]
fn types_of_hdf5_are_read_or_named() {
    let file = good("hdf5-types.mat");
    assert_eq!(channel(&file, "half").values, [1.0, -0.333_251_953_125, 65_504.0, 0.0]);
    assert_eq!(channel(&file, "nine_bits").values, [0.0, 511.0, 256.0, 7.0]);
    assert_eq!(channel(&file, "five_bits").values, [-16.0, 15.0, -1.0, 3.0]);
    let [(name, why)] = &file.tables[0].left_out[..] else { panic!("{file:?}") };
    assert!(name == "bfloat" && why.contains("a type that is not read"), "{name}: {why}");
}

/// A formula that is not read leaves out its channel alone (asammdf 8.8: the numbers of the other).
#[test]
fn an_unknown_formula_leaves_out_its_channel() {
    let file = good("mdf4-one-formula-blocks-all.mf4");
    let values = &channel(&file, "Z").values;
    assert_eq!(values.len(), 60);
    assert!((values[1] - 0.699_428_5).abs() < 1e-7 && (values[3] - 2.084_599).abs() < 1e-6);
    let [(name, why)] = &file.tables[0].left_out[..] else { panic!("{file:?}") };
    assert!(name == "Y" && why.contains("its conversion is not read"), "{name}: {why}");
}
