//! The rules of a file: those of the reference software's check of conformance that concern what is read.

use super::{Band, BandType, Effect, EffectType, Hjif, Perception};
use crate::error::Fault;
use crate::json::within;

/// Highest timescale of the profile Main.
const MOST_TIMESCALE: f64 = 48_000.0;
/// Largest position, ticks.
const MOST_TICKS: f64 = 4_294_967_295.0;
/// Highest frequency of a band, hertz or waves in a metre.
const MOST_HZ: f64 = 1e7;
/// Largest gain of a channel.
const MOST_GAIN: f64 = 1e6;

pub(super) fn check(hjif: &Hjif) -> Result<(), Fault> {
    within(
        || "/timescale".to_owned(),
        "the timescale",
        f64::from(hjif.timescale),
        1.0..=MOST_TIMESCALE,
    )?;
    if hjif.perceptions.is_empty() {
        return Err(Fault::new(
            "/perceptions",
            "there is no perception; a file has one or more",
        ));
    }
    for (index, perception) in hjif.perceptions.iter().enumerate() {
        check_perception(perception, &format!("/perceptions/{index}"))?;
    }
    if hjif.chosen().is_none() {
        let there: Vec<&str> = hjif
            .perceptions
            .iter()
            .map(|p| &p.perception_modality[..])
            .collect();
        let problem = format!("no perception vibrates: they are {}", there.join(", "));
        return Err(Fault::new("/perceptions", problem));
    }
    Ok(())
}

fn check_perception(perception: &Perception, at: &str) -> Result<(), Fault> {
    let exponent = f64::from(perception.unit_exponent);
    within(
        || format!("{at}/unit_exponent"),
        "the exponent",
        exponent,
        -9.0..=3.0,
    )?;
    for (index, effect) in perception.effect_library.iter().enumerate() {
        check_effect(effect, &format!("{at}/effect_library/{index}"))?;
    }
    for (index, channel) in perception.channels.iter().enumerate() {
        let at = format!("{at}/channels/{index}");
        within(
            || format!("{at}/gain"),
            "the gain",
            channel.gain,
            -MOST_GAIN..=MOST_GAIN,
        )?;
        let mixing = channel.mixing_coefficient;
        within(
            || format!("{at}/mixing_coefficient"),
            "the coefficient",
            mixing,
            0.0..=MOST_GAIN,
        )?;
        for (index, band) in channel.bands.iter().enumerate() {
            check_band(band, perception, &format!("{at}/bands/{index}"))?;
        }
    }
    Ok(())
}

fn check_band(band: &Band, perception: &Perception, at: &str) -> Result<(), Fault> {
    let low = band.lower_frequency_limit;
    within(
        || format!("{at}/lower_frequency_limit"),
        "the limit",
        low,
        0.0..=MOST_HZ,
    )?;
    within(
        || format!("{at}/upper_frequency_limit"),
        "the limit",
        band.upper_frequency_limit,
        low..=MOST_HZ,
    )?;
    for (index, effect) in band.effects.iter().enumerate() {
        let at = format!("{at}/effects/{index}");
        check_effect(effect, &at)?;
        match effect.effect_type {
            EffectType::Basis if band.band_type == BandType::WaveletWave => {
                check_block(effect, &at)?
            }
            EffectType::Basis => {}
            EffectType::Reference => {
                let known = |known: &&Effect| known.id == effect.id;
                let found = perception.effect_library.iter().find(known);
                if effect.id.is_none()
                    || found.is_none_or(|known| known.effect_type != EffectType::Basis)
                {
                    return Err(Fault::new(
                        format!("{at}/id"),
                        "the effect library has no effect of this id",
                    ));
                }
            }
            EffectType::Composite => {
                let problem = "composite effects are not read; write its effects into the band";
                return Err(Fault::new(format!("{at}/effect_type"), problem));
            }
        }
    }
    Ok(())
}

fn check_effect(effect: &Effect, at: &str) -> Result<(), Fault> {
    within(
        || format!("{at}/position"),
        "the position",
        effect.position as f64,
        0.0..=MOST_TICKS,
    )?;
    within(
        || format!("{at}/phase"),
        "the phase",
        effect.phase,
        -1e3..=1e3,
    )?;
    let mut before = 0;
    for (index, keyframe) in effect.keyframes.iter().enumerate() {
        let at = |key: &str| format!("{at}/keyframes/{index}/{key}");
        if let Some(position) = keyframe.relative_position {
            within(
                || at("relative_position"),
                "the position",
                position as f64,
                0.0..=MOST_TICKS,
            )?;
            if position < before {
                let problem =
                    format!("{position} is before the keyframe before, at {before}; sort them");
                return Err(Fault::new(at("relative_position"), problem));
            }
            before = position;
        }
        if let Some(amplitude) = keyframe.amplitude_modulation {
            within(
                || at("amplitude_modulation"),
                "the amplitude",
                amplitude,
                -1e3..=1e3,
            )?;
        }
        if let Some(frequency) = keyframe.frequency_modulation {
            within(
                || at("frequency_modulation"),
                "the frequency",
                frequency,
                0.0..=MOST_HZ,
            )?;
        }
    }
    Ok(())
}

/// A block of wavelets has its coefficients, and their largest as the last keyframe.
fn check_block(effect: &Effect, at: &str) -> Result<(), Fault> {
    let samples = effect.keyframes.len().saturating_sub(1);
    if samples >= 8 && samples.is_power_of_two() && samples <= 1 << 16 {
        return Ok(());
    }
    let problem = format!(
        "a block of wavelets has a power of two of coefficients, 8 or more, and one keyframe with their scale; this one has {} keyframes",
        effect.keyframes.len()
    );
    Err(Fault::new(format!("{at}/keyframes"), problem))
}
