//! Error of the interpolation between neighbouring lines of speed, before a model is fitted.

use htex_dsp::bands::rms;

use super::lines::Lines;
use super::slopes::third_octaves;
use crate::TextureSpectrum;

/// Returns the RMS difference in decibels, over third octaves, between each spectrum and the interpolation of its two
/// neighbours in speed; `None` where no cell has both. Spectra are those of the cells, by speed and then by force.
pub(super) fn error_db(lines: &Lines, spectra: &[Option<TextureSpectrum>]) -> Option<f64> {
    let [speeds, forces] = &lines.axes;
    let levels: Vec<Option<Vec<f64>>> = spectra.iter().map(|s| s.as_ref().map(levels_db)).collect();
    let mut errors = Vec::new();
    for (i, at) in speeds.windows(3).enumerate() {
        let speed = [at[0], at[1], at[2]].map(libm::exp);
        let part = (speed[1] - speed[0]) / (speed[2] - speed[0]);
        for j in 0..forces.len() {
            let of = |k: usize| levels.get((i + k) * forces.len() + j)?.as_ref();
            let (Some(below), Some(here), Some(above)) = (of(0), of(1), of(2)) else {
                continue;
            };
            let bands = below.iter().zip(here).zip(above);
            errors.extend(
                bands.map(|((below, here), above)| (1.0 - part) * below + part * above - here),
            );
        }
    }
    errors.retain(|error| error.is_finite());
    (!errors.is_empty()).then(|| rms(&errors))
}

/// Returns the energies of the third octaves, decibels.
fn levels_db(spectrum: &TextureSpectrum) -> Vec<f64> {
    let energy = |bins: std::ops::Range<usize>| {
        let bins = spectrum.magnitude.get(bins).unwrap_or_default();
        10.0 * libm::log10(bins.iter().map(|m| m * m).sum())
    };
    third_octaves(spectrum.band)
        .into_iter()
        .map(energy)
        .collect()
}
