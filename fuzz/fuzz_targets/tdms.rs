#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("tdms"), |input: &[u8]| run("tdms", input));
