#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    htex_fuzzing::toml_text(input);
});
