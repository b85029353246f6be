//! Rules for bands, effects and keyframes.

use std::collections::BTreeSet;

use super::{MOST_HZ, MOST_TICKS};
use crate::error::Fault;
use crate::hjif::{Band, BandType, Effect, EffectType, Keyframe};
use crate::json::within;

/// Largest number of samples in a block of wavelets.
const MOST_BLOCK: usize = 1 << 16;

/// Returns the ids of the library's effects to which a band may refer.
pub(super) fn basis_ids(library: &[Effect]) -> BTreeSet<i64> {
    let basis = library.iter().filter(|e| e.effect_type == EffectType::Basis);
    basis.filter_map(|effect| effect.id).collect()
}

pub(super) fn check(
    band: &Band,
    known: &BTreeSet<i64>,
    is_parametric: bool,
    at: &str,
) -> Result<(), Fault> {
    let low = band.lower_frequency_limit;
    let of = || format!("{at}/lower_frequency_limit");
    within(of, "the limit", low, 0.0..=MOST_HZ)?;
    let of = || format!("{at}/upper_frequency_limit");
    within(of, "the limit", band.upper_frequency_limit, low..=MOST_HZ)?;
    if band.curve_type.is_some() && band.band_type != BandType::Curve {
        let problem = "only bands of curves have a type of curves; leave it out";
        return Err(Fault::new(format!("{at}/curve_type"), problem));
    }
    let is_wavelet = band.band_type == BandType::WaveletWave;
    if is_wavelet && is_parametric {
        let problem = "the profile Simple Parametric has no wavelets";
        return Err(Fault::new(format!("{at}/band_type"), problem));
    }
    for (index, effect) in band.effects.iter().enumerate() {
        let at = format!("{at}/effects/{index}");
        check_effect(effect, &at)?;
        match effect.effect_type {
            EffectType::Basis if is_wavelet => check_block(effect, &at)?,
            EffectType::Basis => {}
            EffectType::Reference => check_reference(effect, known, &at)?,
            EffectType::Composite => {
                let problem = "composite effects are not read; write its effects into the band";
                return Err(Fault::new(format!("{at}/effect_type"), problem));
            }
        }
    }
    Ok(())
}

fn check_reference(effect: &Effect, known: &BTreeSet<i64>, at: &str) -> Result<(), Fault> {
    if effect.id.is_some_and(|id| known.contains(&id)) {
        Ok(())
    } else {
        Err(Fault::new(format!("{at}/id"), "the effect library has no basis effect of this id"))
    }
}

pub(super) fn check_effect(effect: &Effect, at: &str) -> Result<(), Fault> {
    let position = effect.position as f64;
    let of = || format!("{at}/position");
    within(of, "the position", position, 0.0..=MOST_TICKS)?;
    within(|| format!("{at}/phase"), "the phase", effect.phase, -1e3..=1e3)?;
    let mut before = 0;
    for (index, keyframe) in effect.keyframes.iter().enumerate() {
        let at = format!("{at}/keyframes/{index}");
        check_keyframe(keyframe, before, &at)?;
        before = keyframe.relative_position.unwrap_or(before);
    }
    Ok(())
}

fn check_keyframe(keyframe: &Keyframe, before: i64, at: &str) -> Result<(), Fault> {
    if let Some(position) = keyframe.relative_position {
        let of = || format!("{at}/relative_position");
        within(of, "the position", position as f64, 0.0..=MOST_TICKS)?;
        if position < before {
            let problem =
                format!("{position} is before the keyframe before, at {before}; sort them");
            return Err(Fault::new(of(), problem));
        }
    }
    if let Some(amplitude) = keyframe.amplitude_modulation {
        let of = || format!("{at}/amplitude_modulation");
        within(of, "the amplitude", amplitude, -1e3..=1e3)?;
    }
    if let Some(frequency) = keyframe.frequency_modulation {
        let of = || format!("{at}/frequency_modulation");
        within(of, "the frequency", frequency, 0.0..=MOST_HZ)?;
    }
    Ok(())
}

/// Checks a block of wavelets. The block must have all its coefficients, and its last keyframe must
/// contain their largest value.
fn check_block(effect: &Effect, at: &str) -> Result<(), Fault> {
    let samples = effect.keyframes.len().saturating_sub(1);
    if (8..=MOST_BLOCK).contains(&samples) && samples.is_power_of_two() {
        return Ok(());
    }
    let problem = format!(
        "a block of wavelets has a power of two of coefficients, 8 or more, and one keyframe with their scale; this one has {} keyframes",
        effect.keyframes.len()
    );
    Err(Fault::new(format!("{at}/keyframes"), problem))
}
