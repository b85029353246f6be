//! The samples that each contender (a model or a baseline in the comparison) plays.

use htex_dsp::resample::Resampler;
use htex_dsp::seam::Loop;
use htex_host::{HostError, LoadedModel, StillSound, Stream, Synthesis};

use crate::tradeoff::baseline::SpectrumNoise;
use crate::tradeoff::contender::{Contender, ContenderKind, StoredData};
use crate::tradeoff::{Setting, Subject};

/// Duration of the cross-fade in the recording's loop, seconds.
const FADE_S: f64 = 0.1;

type Render = Box<dyn FnMut(&mut [f32]) -> Result<(), HostError>>;

/// A sound that can be played.
pub(crate) struct Sound {
    pub(crate) render: Render,
    pub(crate) kept_bytes: usize,
}

impl Contender {
    /// Returns the sound of stored data, with an RMS of 1.
    pub(crate) fn sound(
        &self,
        subject: &Subject,
        stored: &StoredData,
        seed: u64,
    ) -> Result<Sound, HostError> {
        match &self.kind {
            ContenderKind::Model(model, _) => of_model(&self.setting, model, subject, stored, seed),
            ContenderKind::Quantised => of_spectrum(&self.setting, subject, stored, seed),
            ContenderKind::Recording => of_recording(&self.setting, subject),
        }
    }
}

impl Sound {
    /// Creates a sound from a function that cannot fail.
    fn sure(kept_bytes: usize, mut render: impl FnMut(&mut [f32]) + 'static) -> Self {
        let render = move |out: &mut [f32]| {
            render(out);
            Ok(())
        };
        Self { render: Box::new(render), kept_bytes }
    }
}

fn of_model(
    setting: &Setting,
    model: &LoadedModel,
    subject: &Subject,
    stored: &StoredData,
    seed: u64,
) -> Result<Sound, HostError> {
    let (band, rate_hz) = (subject.spectrum.band, setting.output_rate_hz);
    let parameters = &stored.parameters;
    let still = StillSound::new(setting.synthesis, model, parameters, band, rate_hz, seed)?;
    if let Some(mut still) = still {
        return Ok(Sound::sure(still.kept_bytes(), move |out| still.render(out)));
    }
    let mut stream = Stream::new(model, parameters, band, rate_hz, seed)?;
    Ok(Sound { render: Box::new(move |out| stream.render(out)), kept_bytes: 0 })
}

fn of_spectrum(
    setting: &Setting,
    subject: &Subject,
    stored: &StoredData,
    seed: u64,
) -> Result<Sound, HostError> {
    let (band, rate_hz) = (subject.spectrum.band, setting.output_rate_hz);
    let mut noise = SpectrumNoise::new(&stored.parameters, band, rate_hz, seed)?;
    let Synthesis::Loop { seconds } = setting.synthesis else {
        return Ok(Sound::sure(0, move |out| noise.render(out)));
    };
    let fade = (FADE_S * rate_hz) as usize;
    let mut piece = vec![0.0; (seconds * rate_hz) as usize + fade];
    noise.render(&mut vec![0.0; fade]);
    noise.render(&mut piece);
    let mut samples = Loop::new(piece, fade).with_rms(1.0);
    let kept = size_of_val(samples.samples());
    Ok(Sound::sure(kept, move |out| samples.render(out)))
}

fn of_recording(setting: &Setting, subject: &Subject) -> Result<Sound, HostError> {
    let (own_hz, rate_hz) = (subject.rate_hz, setting.output_rate_hz);
    let mut samples = Loop::new(subject.samples.clone(), (FADE_S * own_hz) as usize);
    let kept = size_of_val(samples.samples());
    let resampler = Resampler::new(own_hz, rate_hz, subject.spectrum.band.high_hz)?;
    Ok(match resampler {
        None => Sound::sure(kept, move |out| samples.render(out)),
        Some(mut resampler) => Sound::sure(kept, move |out| {
            resampler.process(out, &mut |block| samples.render(block));
        }),
    })
}
