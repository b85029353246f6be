//! Responses of a recording setup.

use htex_author::recording::response_from_bytes;
use htex_author::{Recording, SpectrumOptions, segment_spectra};

use crate::promise::{finite, sentence};

/// Reads a response, evaluates it, and divides a recording by it.
pub fn response_csv(input: &[u8]) -> bool {
    let response = match response_from_bytes("fuzzed.csv", input) {
        Ok(response) => response,
        Err(error) => {
            sentence(&error);
            return false;
        }
    };
    for frequency_hz in [0.0, 20.0, 99.5, 1000.0, f64::MAX] {
        let (re, im) = response.value_at(frequency_hz);
        finite("response", [re, im]);
    }
    let steps: Vec<f64> = (0..40).map(|i| f64::from(i % 7)).collect();
    let recording = Recording::new("fuzzed", 100.0, vec![steps]).expect("forty numbers");
    let options = SpectrumOptions::default().with_response(response);
    match segment_spectra(&recording, &options) {
        Ok(spectra) => {
            spectra.warnings.iter().for_each(sentence);
            let bins = spectra.spectra.iter().flatten();
            finite("bin", bins.flat_map(|bin| [bin.re, bin.im]));
        }
        Err(error) => sentence(&error),
    }
    true
}
