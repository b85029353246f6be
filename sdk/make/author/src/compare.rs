//! Compares the spectrum of a recording with the spectra of an asset's representations, or with the
//! spectrum of another recording.

use htex_dsp::fluctuation::Fluctuation;
use htex_dsp::vibrotactile::Listener;
use htex_format::{Condition, HeldOut, Measure, Quality, Representation};
use serde::Serialize;

use crate::fluctuation::{FluctuationDifference, voice_fluctuation};
use crate::measure::measure;
use crate::{AuthorError, Exploration, FeltError, TextureSpectrum, agreement, felt};

/// How a spectrum differs from a recording's spectrum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// RMS of the compared spectrum in the band, in the quantity's unit.
    pub level_rms: f64,
    /// The measures of agreement. If two recordings are compared, values that are computed from
    /// rendered samples are missing, because only representations can be rendered.
    #[serde(flatten)]
    pub quality: Quality,
    /// How much of the difference can be felt.
    pub felt: FeltDifference,
}

/// How much of a difference can be felt, band by band and in summary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeltDifference {
    /// Centre frequencies of third-octave bands, hertz.
    pub centre_hz: Vec<f64>,
    /// For each band, the difference between the two levels above the detection threshold,
    /// decibels.
    pub error_db: Vec<f64>,
    /// The difference over all bands, in a few numbers.
    #[serde(flatten)]
    pub error: FeltError,
}

/// How a representation differs from a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedModel {
    /// Id of the model.
    pub model: String,
    /// The asset's held-out error, at the asset's condition nearest to the recording's speed and
    /// force. `None` if it states none.
    #[serde(flatten)]
    pub held_out: Option<HeldOut>,
    #[serde(flatten)]
    pub difference: Difference,
    /// How the fluctuation of the rendered texture differs from the fluctuation of the recording.
    /// `None` if the recording is too short to measure this.
    pub fluctuation: Option<FluctuationDifference>,
}

impl Difference {
    fn new(
        reference: &TextureSpectrum,
        level_rms: f64,
        magnitude: &[f64],
        quality: Quality,
    ) -> Self {
        let of = reference.as_ref();
        let felt = felt(of, magnitude, reference.quantity, &Listener::default());
        Self {
            level_rms,
            felt: FeltDifference {
                centre_hz: felt.centre_hz,
                error_db: felt.error_db,
                error: FeltError::new(reference, magnitude, quality.get(Measure::NineBand)),
            },
            quality,
        }
    }

    /// Compares the spectra of two recordings; `None` if their quantities or bands differ.
    #[must_use]
    pub fn between(reference: &TextureSpectrum, other: &TextureSpectrum) -> Option<Self> {
        if (other.quantity, other.band) != (reference.quantity, reference.band) {
            return None;
        }
        let quality = Quality::from(agreement(reference.as_ref(), &other.magnitude));
        let level_rms = htex_dsp::grid::level_rms(&other.magnitude);
        Some(Self::new(reference, level_rms, &other.magnitude, quality))
    }
}

/// Compares each representation of an asset with a recording. If the recording's speed and force
/// are known, the representations are compared at this speed and force. If not, they are compared
/// at the asset's default condition. `fluctuation` is the recording's fluctuation, if it could be
/// measured.
///
/// # Errors
/// Returns an error if the quantities differ, a representation cannot be read, or a model refuses
/// its parameters.
pub fn compare(
    asset: &htex_play::Texture,
    reference: &TextureSpectrum,
    found: Exploration,
    fluctuation: Option<&Fluctuation>,
) -> Result<Vec<ComparedModel>, AuthorError> {
    let (held, recorded) = (asset.quantity(), reference.quantity);
    if held != recorded {
        return Err(AuthorError::OtherQuantity { held, recorded });
    }
    let motion = found
        .speed_mm_s
        .zip(found.force_n)
        .map(|(speed, force)| htex_play::Motion::new(speed, force));
    let compared = asset.manifest().representations.iter().map(|representation| {
        let playable = asset.representation(&representation.model[..])?;
        let (parameters, level_rms) = playable.parameters(motion)?;
        let model = playable.model()?;
        let of = reference.as_ref();
        let (magnitude, quality) = measure(&model, &parameters, level_rms, of)?;
        let voice = match fluctuation {
            Some(_) => voice_fluctuation(&model, &parameters, of)?,
            None => None,
        };
        let pair = fluctuation.zip(voice.as_ref());
        let conditions = &asset.manifest().conditions;
        let nearest = match motion {
            Some(motion) => nearest(representation, conditions, motion),
            None => playable.default_condition(),
        };
        let at = representation.at.iter().find(|at| at.condition == nearest);
        Ok(ComparedModel {
            fluctuation: pair.map(|(a, b)| FluctuationDifference::new(a, b)),
            model: representation.model.clone(),
            held_out: at.and_then(|at| asset.manifest().held_out(at)),
            difference: Difference::new(reference, level_rms, &magnitude, quality),
        })
    });
    compared.collect()
}

/// Returns the index of the condition that has the largest weight in the texture that is played at
/// a motion.
fn nearest(stored: &Representation, conditions: &[Condition], motion: htex_play::Motion) -> usize {
    let known = |value: Option<f64>| value.unwrap_or(0.0);
    let points: Vec<[f64; 2]> = stored
        .at
        .iter()
        .map(|at| &conditions[at.condition])
        .map(|condition| [known(condition.speed_mm_s), known(condition.force_n)])
        .collect();
    let mesh = htex_play::Mesh::new(&points);
    let weights = mesh.weights(motion.speed_mm_s, motion.force_n);
    let most = weights.iter().max_by(|(_, a), (_, b)| a.total_cmp(b));
    most.and_then(|(i, _)| stored.at.get(i)).map_or(0, |at| at.condition)
}
