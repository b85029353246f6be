//! Extra conditions for a texture that was recorded at a single speed: one at a slower and one at a
//! faster speed.
//!
//! If the contact (the finger or tool that slid over the surface) is unknown, a player uses the
//! same shape of the spectrum at every speed, and changes only the level. But in recorded strokes
//! of fingertips, the level of high frequencies rises faster with the speed than the level of low
//! frequencies. At a frequency f, the level was about proportional to the speed raised to the
//! exponent 0.7 + 0.28 log2(f / 250 Hz). The change of this exponent from octave to octave is
//! called the tilt. If a texture was recorded at three speeds or more, the recordings themselves
//! show the tilt. If a texture was recorded at one speed, htex assumes half of the tilt that was
//! measured in the fingertip strokes, because materials differ. The tilt was 0.51 per octave for
//! one material and 0.07 for another. Half of the tilt reduces the error for both materials
//! (`docs/real-recordings.md`).
//!
//! The two conditions are stored like recorded conditions, so the player and the file format need
//! no rule for the tilt. The level of the two conditions follows the texture's scaling law.

use htex_dsp::grid::level_rms;
use htex_format::{Condition, Contact, ExponentSource, Law};

use crate::conditions::{ConditionSpectrum, four_digits};
use crate::spectrum::SegmentSpectra;
use crate::{AuthorError, Averaging, TextureSpectrum};

/// Half of the measured tilt: the change of the level's exponent over an octave.
const TILT: f64 = 0.14;
/// The frequency at which the tilt changes nothing, hertz.
const MIDDLE_HZ: f64 = 250.0;
/// The speeds of the added conditions, relative to the recorded speed.
const SPEEDS: [f64; 2] = [1.0 / 3.0, 3.0];

/// Returns one condition below and one above the recorded speed, if all recordings have the same
/// speed, the contact is unknown, and the law leaves the frequencies unchanged. `parts` are the
/// segment spectra of each recorded condition.
///
/// # Errors
/// Returns the errors of [`TextureSpectrum::average`].
pub(crate) fn conditions(
    recorded: &[ConditionSpectrum],
    parts: &[Vec<SegmentSpectra>],
    law: &Law,
    contact: Contact,
    averaging: Averaging,
) -> Result<Vec<ConditionSpectrum>, AuthorError> {
    let Some(speed) = only_speed(recorded) else { return Ok(Vec::new()) };
    let assumed = law.frequency_speed.source == ExponentSource::Assumed;
    if contact != Contact::Unknown || !assumed {
        return Ok(Vec::new());
    }
    let mut all = Vec::new();
    for ratio in SPEEDS {
        for (one, parts) in recorded.iter().zip(parts) {
            let condition = Condition {
                speed_mm_s: Some(four_digits(ratio * speed)),
                force_n: one.condition.force_n,
                segments: Some(0),
                ..Condition::default()
            };
            let level = libm::pow(ratio, law.level_speed.exponent);
            let spectrum = tilted(&one.spectrum, parts.clone(), [ratio, level], averaging)?;
            let (block_power, halves) = (None, None);
            all.push(ConditionSpectrum { condition, spectrum, block_power, halves });
        }
    }
    Ok(all)
}

/// Returns the speed of the recorded conditions, if all have the same speed and their forces are
/// known.
fn only_speed(recorded: &[ConditionSpectrum]) -> Option<f64> {
    let known = |one: &ConditionSpectrum| one.condition.speed_mm_s.zip(one.condition.force_n);
    let (speed, _) = known(recorded.first()?)?;
    let same = |one| known(one).is_some_and(|(other, _)| Condition::is_same(other, speed));
    (speed > 0.0 && recorded.iter().all(same)).then_some(speed)
}

/// Returns the spectrum of segments at another speed. `ratio` is this speed relative to the recorded
/// one, and `level` the change of the level.
fn tilted(
    recorded: &TextureSpectrum,
    mut parts: Vec<SegmentSpectra>,
    [ratio, level]: [f64; 2],
    averaging: Averaging,
) -> Result<TextureSpectrum, AuthorError> {
    let gain = |hz: &f64| libm::pow(ratio, TILT * libm::log2(hz / MIDDLE_HZ));
    let gains: Vec<f64> = recorded.frequency_hz.iter().map(gain).collect();
    for spectrum in parts.iter_mut().flat_map(|part| &mut part.spectra) {
        spectrum.iter_mut().zip(&gains).for_each(|(bin, gain)| *bin *= gain);
    }
    let mut spectrum = TextureSpectrum::average(&parts, averaging)?;
    let now = level_rms(&spectrum.magnitude);
    if now > 0.0 {
        let gain = level * level_rms(&recorded.magnitude) / now;
        spectrum.magnitude.iter_mut().chain(&mut spectrum.signal).for_each(|x| *x *= gain);
    }
    Ok(TextureSpectrum { segments: 0, repeatability: None, ..spectrum })
}
