#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("columnar"), |input: &[u8]| run("columnar", input));
