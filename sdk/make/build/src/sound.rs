//! Renders one second of a texture as sound, for catalogues.

use std::error::Error;
use std::io::Cursor;

use htex_host::Registry;
use htex_play::{Texture, VoiceOptions};

/// Sample rate of the sound, hertz. This rate is above twice the band's upper edge (1000 Hz),
/// browsers can play it, and files stay small.
const RATE_HZ: u32 = 8_000;
/// Length of the sound, samples.
const SAMPLES: usize = RATE_HZ as usize;
/// RMS of the sound, relative to full scale.
const RMS: f32 = 0.1;
/// Length of the fade at both ends, samples.
const FADE: usize = 200;

/// Renders one second of the asset's best representation at its default condition, as a 16-bit WAV.
/// All sounds have nearly the same RMS.
pub(crate) fn sound(asset: &[u8], registry: &Registry) -> Result<Vec<u8>, Box<dyn Error>> {
    let data = htex_format::Asset::from_bytes(asset)?;
    let asset = Texture::with_registry(data, registry.clone());
    let options = VoiceOptions::default().with_rate_hz(f64::from(RATE_HZ));
    let mut voice = asset.voice(&options)?;
    let mut samples = vec![0.0_f32; SAMPLES];
    voice.render(&mut samples)?;
    let power: f32 = samples.iter().map(|x| x * x).sum::<f32>() / SAMPLES as f32;
    let gain = if power > 0.0 { RMS / power.sqrt() } else { 0.0 };
    let specification = hound::WavSpec {
        channels: 1,
        sample_rate: RATE_HZ,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = hound::WavWriter::new(&mut bytes, specification)?;
    for (i, sample) in samples.iter().enumerate() {
        let from_end = i.min(SAMPLES - 1 - i).min(FADE) as f32 / FADE as f32;
        let value = (sample * gain * from_end).clamp(-1.0, 1.0);
        writer.write_sample((value * 32_767.0) as i16)?;
    }
    writer.finalize()?;
    Ok(bytes.into_inner())
}
