//! Writes a texture as `.hjif`, either as tones in bands or as samples coded by wavelets.

use super::{
    Band, BandType, BaseSignal, Channel, Effect, EffectType, Hjif, Keyframe, Perception,
    ReferenceDevice, TEXTURE, VIBRATION, analysed,
};
use crate::curve::Point;
use crate::profile::Profile;

/// Number of ticks per second, and per metre. A tick is 1 ms, or 0.1 mm.
const TICKS_PER_S: u32 = 1_000;
const TICKS_PER_M: u32 = 10_000;
/// Number of samples in a block of wavelets.
const BLOCK: usize = 512;
/// Lowest sample rate of a wavelet band, hertz: twice the texture's highest frequency of 1 kHz,
/// plus a tenth.
const LEAST_RATE_HZ: f64 = 2_200.0;
/// Resolution of a coefficient, relative to the largest coefficient of its block.
const RESOLUTION: f64 = 1e-4;
/// The date that is written. The format requires one. A fixed date is used, so that equal inputs
/// give equal bytes.
const NO_DATE: &str = "1970-01-01";

/// Whether the positions in a file are times or distances. For distances, this type also states the
/// speed of the finger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Space {
    /// Speed of the finger over a texture in space, mm/s. `None` stands for a vibration over time.
    pub speed_mm_s: Option<f64>,
}

/// A tone of a vectorial band.
pub(crate) struct Tone {
    pub(crate) hertz: f64,
    /// Amplitude over time, as a fraction of full scale, 0 to 1.
    pub(crate) amplitude: Vec<Point>,
}

impl Space {
    const fn timescale(self) -> u32 {
        match self.speed_mm_s {
            Some(_) => TICKS_PER_M,
            None => TICKS_PER_S,
        }
    }

    /// Converts a time to ticks.
    fn ticks(self, time_s: f64) -> i64 {
        libm::round(time_s * f64::from(self.timescale()) * self.per_s()) as i64
    }

    /// Returns the speed in metres per second; 1 for a vibration over time.
    fn per_s(self) -> f64 {
        self.speed_mm_s.map_or(1.0, |speed| speed / 1e3)
    }

    /// Returns the length of a block of wavelets in ticks. In space it is a power of two, so that
    /// the number of samples per metre is whole.
    fn block_ticks(self) -> i64 {
        let most = BLOCK as f64 * f64::from(self.timescale()) * self.per_s() / LEAST_RATE_HZ;
        match self.speed_mm_s {
            // 512 samples in 200 ms are 2560 Hz, a whole number above the lowest rate.
            None => 200,
            // With blocks of more than 2^13 ticks, the number of samples per metre would not be
            // whole.
            Some(_) => 1 << libm::floor(libm::log2(most.max(1.0))).min(13.0) as i64,
        }
    }

    /// Returns the number of samples of a wavelet band per second or per metre.
    fn per_unit(self) -> f64 {
        BLOCK as f64 * f64::from(self.timescale()) / self.block_ticks() as f64
    }

    /// Returns the sample rate that [`waveform`] expects, hertz.
    #[must_use]
    pub fn rate_hz(self) -> f64 {
        self.per_unit() * self.per_s()
    }
}

/// Makes a file of tones. Each tone has its own band. Level 1 of the format allows at most seven
/// bands.
pub(crate) fn vectorial(
    tones: &[Tone],
    profile: &Profile,
    space: Space,
    description: &str,
) -> Hjif {
    let bands = tones.iter().map(|tone| {
        let per_unit = libm::round(tone.hertz / space.per_s());
        let keyframe = |point: &Point| Keyframe {
            relative_position: Some(space.ticks(point.time_s)),
            amplitude_modulation: Some(point.value),
            frequency_modulation: Some(per_unit),
        };
        Band {
            band_type: BandType::VectorialWave,
            curve_type: None,
            block_length: None,
            lower_frequency_limit: 0.0,
            upper_frequency_limit: libm::ceil(1e3 / space.per_s()),
            effects: vec![effect(0, tone.amplitude.iter().map(keyframe).collect())],
        }
    });
    file(bands.collect(), profile, space, description)
}

/// Makes a file in which samples are coded by wavelets. The samples must lie between -1 and 1 and
/// have the sample rate [`Space::rate_hz`].
pub fn waveform(samples: &[f64], profile: &Profile, space: Space, description: &str) -> Hjif {
    let blocks = samples.chunks(BLOCK).enumerate().map(|(index, samples)| {
        let mut block = samples.to_vec();
        block.resize(BLOCK, 0.0);
        effect(index as i64 * space.block_ticks(), coefficients(&analysed(&block)))
    });
    let band = Band {
        band_type: BandType::WaveletWave,
        curve_type: None,
        block_length: Some(BLOCK as f64),
        lower_frequency_limit: 0.0,
        upper_frequency_limit: space.per_unit(),
        effects: blocks.collect(),
    };
    file(vec![band], profile, space, description)
}

/// Converts coefficients to keyframes. They are relative to the largest one, which is stored as the
/// last keyframe.
fn coefficients(all: &[f64]) -> Vec<Keyframe> {
    let largest = all.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let part = |x: &f64| {
        if largest > 0.0 { libm::round(x / largest / RESOLUTION) * RESOLUTION } else { 0.0 }
    };
    // Removes the digits that come from floating-point errors.
    let digits = |x: f64| libm::round(x * 1e6) / 1e6;
    let values = all.iter().map(part).map(digits).chain([largest]);
    values
        .enumerate()
        .map(|(index, value)| Keyframe {
            relative_position: Some(index as i64),
            amplitude_modulation: Some(value),
            frequency_modulation: None,
        })
        .collect()
}

fn effect(position: i64, keyframes: Vec<Keyframe>) -> Effect {
    Effect {
        effect_type: EffectType::Basis,
        id: None,
        position,
        phase: 0.0,
        base_signal: BaseSignal::Sine,
        keyframes,
    }
}

fn file(bands: Vec<Band>, profile: &Profile, space: Space, description: &str) -> Hjif {
    let modality = if space.speed_mm_s.is_some() { TEXTURE } else { VIBRATION };
    let device = ReferenceDevice {
        id: 1,
        name: profile.title.clone(),
        maximum_frequency: Some(profile.high_hz.value),
        minimum_frequency: Some(profile.low_hz.value),
        resonance_frequency: Some(profile.resonance_hz.value),
        maximum_amplitude: Some(profile.strongest_m_s2.value),
    };
    let channel = Channel {
        id: 0,
        description: String::new(),
        reference_device_id: Some(1),
        gain: 1.0,
        mixing_coefficient: 1.0,
        body_part_mask: 0,
        bands,
    };
    Hjif {
        version: "2023".to_owned(),
        profile: "Main".to_owned(),
        level: 1,
        date: NO_DATE.to_owned(),
        description: description.to_owned(),
        timescale: space.timescale(),
        avatars: Vec::new(),
        perceptions: vec![Perception {
            id: 0,
            avatar_id: 0,
            description: String::new(),
            perception_modality: modality.to_owned(),
            unit_exponent: -3,
            perception_unit_exponent: 0,
            reference_devices: vec![device],
            effect_library: Vec::new(),
            channels: vec![channel],
        }],
        syncs: Vec::new(),
    }
}
