#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| rdh_fuzz::precise(data));
