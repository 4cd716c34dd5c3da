#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("protocol_text"), |input: &[u8]| run("protocol_text", input));
