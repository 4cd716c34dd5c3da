#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("campaign"), |input: &[u8]| run("campaign", input));
