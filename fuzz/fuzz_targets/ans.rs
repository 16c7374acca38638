#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| lwc::fuzzing::ans(data));
