//! Measures how accurate a contender's magnitudes and rendered samples are.

use crate::{AuthorError, read_spectrum, spectrum_of_samples};
use htex_format::Measure;
use serde::{Deserialize, Serialize};

use crate::tradeoff::Subject;
use crate::tradeoff::accuracy::{Accuracy, accuracy};
use crate::tradeoff::contender::{Contender, ContenderKind, StoredData};

/// Number of renderings that are measured, each with another seed.
const SEEDS: u64 = 3;
/// Length of a rendering, seconds.
const SECONDS: f64 = 20.0;
const QUICK_SECONDS: f64 = 4.0;
/// Largest number of samples in a rendering; at high rates a rendering is therefore shorter.
const MOST_SAMPLES: f64 = 2e6;

/// Accuracy and size of a contender.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Measurement {
    pub(crate) bytes: usize,
    pub(crate) kept_bytes: usize,
    pub(crate) by_magnitude: Accuracy,
    pub(crate) by_samples: Accuracy,
    /// Held-out error in decibels: the fit to the odd blocks is played and compared with the even
    /// blocks in third octaves.
    pub(crate) held_out_error_db: Option<f64>,
    /// Half the range of the nine-band errors of the renderings, decibels.
    pub(crate) samples_spread_db: f64,
}

impl Contender {
    /// Fits, stores and measures the contender. `None` if the contender is the recording and has
    /// too few blocks to be compared with itself.
    pub(crate) fn measure(
        &self,
        subject: &Subject,
        quick: bool,
    ) -> Result<Option<Measurement>, AuthorError> {
        let reference = &subject.spectrum;
        let stored = self.store(subject, reference, &self.fit(reference)?)?;
        let held_out_error_db = self.held_out_error_db(subject, quick)?;
        if matches!(self.kind, ContenderKind::Recording) {
            // A recording cannot differ from itself. Its error is therefore the difference between
            // its own parts.
            let held_out = subject.held_out.as_ref().ok();
            return Ok(held_out.map(|held_out| Measurement {
                bytes: stored.bytes,
                kept_bytes: size_of::<f32>() * subject.samples.len(),
                by_magnitude: held_out.repeats,
                by_samples: held_out.repeats,
                held_out_error_db,
                samples_spread_db: 0.0,
            }));
        }
        let rendered = self.rendered(subject, &stored, quick)?;
        let errors = rendered
            .spectra
            .iter()
            .filter_map(|m| accuracy(reference, m).measures.get(Measure::NineBand));
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = errors.fold(ends, |(low, high), x| (x.min(low), x.max(high)));
        Ok(Some(Measurement {
            bytes: stored.bytes,
            kept_bytes: rendered.kept_bytes,
            by_magnitude: accuracy(reference, &self.magnitude(subject, &stored)?),
            by_samples: accuracy(reference, &rms_of(&rendered.spectra)),
            held_out_error_db,
            samples_spread_db: 0.5 * (high - low),
        }))
    }

    /// Returns the spectra of the renderings, on the subject's grid.
    pub(crate) fn rendered(
        &self,
        subject: &Subject,
        stored: &StoredData,
        quick: bool,
    ) -> Result<RenderedSpectra, AuthorError> {
        let rate_hz = self.setting.output_rate_hz;
        let seconds = if quick { QUICK_SECONDS } else { SECONDS };
        let mut samples = vec![0.0; (seconds * rate_hz).min(MOST_SAMPLES) as usize];
        let mut rendered = RenderedSpectra { spectra: Vec::new(), kept_bytes: 0 };
        for seed in 1..=SEEDS {
            let mut sound = self.sound(subject, stored, seed)?;
            samples.chunks_mut(self.setting.block_samples).try_for_each(&mut sound.render)?;
            let reference = subject.spectrum.as_ref();
            rendered.spectra.push(spectrum_of_samples(
                &samples,
                rate_hz,
                stored.level_rms,
                reference,
            )?);
            rendered.kept_bytes = sound.kept_bytes;
        }
        Ok(rendered)
    }

    /// Returns the magnitudes that would be measured in a recording of the played model. For a
    /// baseline, returns its own magnitudes.
    fn magnitude(&self, subject: &Subject, stored: &StoredData) -> Result<Vec<f64>, AuthorError> {
        let spectrum = &subject.spectrum;
        match &self.kind {
            ContenderKind::Model(model, _) => {
                let reference = spectrum.as_ref();
                Ok(read_spectrum(model, &stored.parameters, stored.level_rms, reference)?)
            }
            ContenderKind::Quantised => Ok(stored.parameters.clone()),
            ContenderKind::Recording => Ok(spectrum.magnitude.clone()),
        }
    }
}

pub(crate) struct RenderedSpectra {
    pub(crate) spectra: Vec<Vec<f64>>,
    kept_bytes: usize,
}

/// Returns the root of the mean power of several magnitude spectra, bin by bin.
pub(crate) fn rms_of(spectra: &[Vec<f64>]) -> Vec<f64> {
    let bins = spectra.first().map_or(0, Vec::len);
    let power = |k: usize| spectra.iter().map(|m| m[k] * m[k]).sum::<f64>();
    let mean = |k: usize| (power(k) / spectra.len() as f64).sqrt();
    (0..bins).map(mean).collect()
}
