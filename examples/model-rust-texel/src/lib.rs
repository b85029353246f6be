//! Single-pitch texel: a surface of one repeating element, such as a grating or a weave. The
//! distance between two elements is `pitch_mm`. A finger that slides over them vibrates at the
//! fundamental `speed/pitch` and its multiples.
//!
//! Real pitches are not exactly constant. Therefore, each harmonic is a small cluster of sinusoids
//! over the path, and `jitter` is the width of the cluster. The voice receives the finger's
//! position (`htex.motion/1`), so that the signal is a function of the position in both directions.
#![no_std]

extern crate alloc;

mod comb;
mod fit;
mod path;
mod voice;

use comb::{Comb, HARMONICS, LINES};
use htex_dsp::shaped_noise::economical_rate_hz;
use htex_model::{
    Band, Error, Fit, FitInput, Model, Numbers, StaticDescriptor, StaticField, Values, mix,
};
pub use voice::TexelVoice;

const PITCH: usize = 0;
const SPEED: usize = 1;
const FORCE: usize = 2;
const JITTER: usize = 3;
const AMPLITUDE: usize = 4;

const PITCH_MM: (f64, f64) = (0.0009765625, 1024.0); // 32-bit floats, as assets store them
const SPEED_MM_S: (f64, f64) = (1.0, 2000.0);
const FORCE_N: (f64, f64) = (0.0, 1000.0);
const JITTERS: (f64, f64) = (0.0, 0.0625);

/// The model.
pub struct Texel;

htex_model::export_model!(Texel, symbols: "plugin", extensions: [motion]);

impl Model for Texel {
    type Voice = TexelVoice;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "org.example.texel",
        "Single-pitch texel",
        env!("CARGO_PKG_VERSION"),
        "One repeating element of the surface: its pitch, and how strong each harmonic is.",
    )
    .fields(&[
        StaticField::scalar("pitch_mm", "mm", PITCH_MM, "Length of the element."),
        StaticField::scalar("speed_mm_s", "mm/s", SPEED_MM_S, "Speed of the recording."),
        StaticField::scalar(
            "force_n",
            "N",
            FORCE_N,
            "Normal force of the recording; 0 where it is not known.",
        ),
        StaticField::scalar(
            "jitter",
            "1",
            JITTERS,
            "Spread of the frequencies, as a part of each; never less than 1 Hz.",
        ),
        StaticField::list(
            "amplitude",
            "1",
            (0.0, 1.0),
            HARMONICS as u32,
            "Harmonics from the fundamental on, over the strongest.",
        ),
    ]);

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        fit::fit(input)
    }

    fn magnitude(
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        let comb = Comb::new(parameters, band)?;
        for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
            let inside = (band.low_hz..=band.high_hz).contains(&f);
            *m = if inside { comb.seen_at(f) } else { 0.0 };
        }
        Ok(())
    }

    /// Interpolates pitch, speed, force and harmonics linearly; a harmonic that a set lacks has
    /// amplitude 0 there.
    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        if let Some(set) = mix::sole(sets, weights) {
            out.extend(set.flat());
            return Ok(());
        }
        let longest = sets.iter().map(|s| s.list(AMPLITUDE).len()).max();
        let mut room = [0.0; AMPLITUDE + 1 + LINES];
        let mixed = &mut room[..AMPLITUDE + 1 + longest.unwrap_or(0)];
        for (set, weight) in sets.iter().zip(weights) {
            for field in [PITCH, SPEED, FORCE, JITTER] {
                mixed[field] += weight * set.scalar(field);
            }
            let amplitudes = mixed[AMPLITUDE + 1..].iter_mut();
            amplitudes
                .zip(set.list(AMPLITUDE))
                .for_each(|(sum, a)| *sum += weight * a);
        }
        mixed[AMPLITUDE] = longest.unwrap_or(0) as f64;
        // The sum of weights has a rounding error, which must not move parameters out of their
        // ranges.
        let amplitudes = mixed[AMPLITUDE + 1..].iter_mut();
        amplitudes.for_each(|a| *a = a.min(1.0));
        mixed[PITCH] = mixed[PITCH].clamp(PITCH_MM.0, PITCH_MM.1);
        mixed[SPEED] = mixed[SPEED].clamp(SPEED_MM_S.0, SPEED_MM_S.1);
        mixed[FORCE] = mixed[FORCE].clamp(FORCE_N.0, FORCE_N.1);
        mixed[JITTER] = mixed[JITTER].clamp(JITTERS.0, JITTERS.1);
        out.extend(mixed);
        Ok(())
    }

    fn voice_rate_hz(_: &Values<'_>, band: Band, wanted_hz: f64) -> f64 {
        economical_rate_hz(wanted_hz, band)
    }

    fn voice(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self::Voice, Error> {
        TexelVoice::new(parameters, band, rate_hz, seed)
    }
}
