#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("vehicle"), |input: &[u8]| run("vehicle", input));
