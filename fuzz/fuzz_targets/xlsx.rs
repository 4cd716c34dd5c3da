#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("xlsx"), |input: &[u8]| run("xlsx", input));
