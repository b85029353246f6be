//! Held-out error of a model. For each block of time, the model is fitted to the other blocks of
//! the recording. Then the spectrum that a player would play from this fit is compared with the
//! spectrum of the left-out block.

use htex_dsp::bands::rms;
use htex_format::{LeftOut, Measure, Measures};
use htex_host::LoadedModel;
use htex_play::exploration::CEILING;
use htex_play::{Conditions, Mesh, Motion};

use super::held_out::{HeldOutWindows, LeftOutBlock};
use super::played::mesh_of;
use crate::conditions::ConditionSpectrum;
use crate::fit::ConditionFit;
use crate::{AuthorError, agreement, read_spectrum};

/// Returns the held-out error at each of `conditions` conditions. For each block of time, the model
/// is fitted to the other blocks. The spectrum that a player would then play near the condition is
/// compared with the block. The error is the RMS over the blocks. It is `None` if no block has
/// enough windows near the condition, or if the other blocks give no spectrum there. `fit` fits the
/// model at one condition.
pub(crate) fn left_out(
    model: &LoadedModel,
    conditions: usize,
    blocks: &[LeftOutBlock],
    mut fit: impl FnMut(&ConditionSpectrum) -> Result<ConditionFit, AuthorError>,
) -> Vec<Option<LeftOut>> {
    let mut errors: Vec<Vec<Measures>> = vec![Vec::new(); conditions];
    for block in blocks {
        let fits: Result<Vec<_>, _> = block.rest.iter().map(&mut fit).collect();
        // If the model cannot be fitted to the rest of the recording, this block gives no error.
        let Some(played) = fits.ok().and_then(|fits| HeldOutGrid::new(model, block, fits)) else {
            continue;
        };
        for held in &block.held_out {
            let error = played.error(held);
            if let (Some(error), Some(all)) = (error, errors.get_mut(held.cell)) {
                all.push(error);
            }
        }
    }
    errors.iter().map(|of_blocks| left_out_rms(of_blocks)).collect()
}

/// Returns the RMS of the errors on several blocks of time; `None` if no block has an error.
pub(crate) fn left_out_rms(blocks: &[Measures]) -> Option<LeftOut> {
    let over = |measure: Measure| {
        let of_block = blocks.iter().filter_map(|measures| measures.get(measure));
        let of_block: Vec<f64> = of_block.filter(|error| error.is_finite()).collect();
        (!of_block.is_empty()).then(|| rms(&of_block))
    };
    let measures = Measures::new(over).only(LeftOut::measures());
    over(Measure::NineBand).map(|_| LeftOut(measures))
}

/// A grid that was fitted without a block of time. It interpolates between its conditions as a
/// player does.
struct HeldOutGrid<'a> {
    model: &'a LoadedModel,
    mesh: Mesh,
    conditions: Conditions,
    fits: Vec<ConditionFit>,
}

impl<'a> HeldOutGrid<'a> {
    fn new(model: &'a LoadedModel, block: &LeftOutBlock, fits: Vec<ConditionFit>) -> Option<Self> {
        let levels: Vec<f64> = fits.iter().map(|fit| fit.level_rms).collect();
        let (mesh, conditions) = mesh_of(&block.rest, &levels, block.law)?;
        Some(Self { model, mesh, conditions, fits })
    }

    /// Compares two spectra: the spectrum that is played at the motion of left-out windows, and the
    /// spectrum of the windows themselves.
    fn error(&self, held: &HeldOutWindows) -> Option<Measures> {
        let reference = held.spectrum.as_ref();
        let magnitude = self.magnitude(held.motion, reference).ok()?;
        let error = agreement(reference, &magnitude);
        let is_finite = error.get(Measure::NineBand).is_some_and(f64::is_finite);
        is_finite.then_some(error.measures)
    }

    /// Returns the magnitudes that a recording of the texture, played at the given motion, would
    /// have. If frequencies are scaled, these are the same magnitudes as those of
    /// [`htex_play::Representation::magnitude`].
    fn magnitude(
        &self,
        [speed, force]: [f64; 2],
        reference: crate::SpectrumRef<'_>,
    ) -> Result<Vec<f64>, AuthorError> {
        let weights: Vec<(usize, f64)> = self.mesh.weights(speed, force).iter().collect();
        let sets: Vec<&[f64]> = weights.iter().map(|(i, _)| &self.fits[*i].stored[..]).collect();
        let parts: Vec<f64> = weights.iter().map(|(_, weight)| *weight).collect();
        let level: f64 = weights.iter().map(|(i, w)| w * self.fits[*i].level_rms).sum();
        let mixed = match &sets[..] {
            [only] => only.to_vec(),
            _ => self.model.interpolate(&sets, &parts)?,
        };
        let scaling = self.conditions.scaling(Motion::new(speed, force), CEILING);
        let ratio = scaling.frequency;
        if ratio == 1.0 {
            return read_spectrum(self.model, &mixed, level * scaling.level, reference);
        }
        let recorded_hz: Vec<f64> = reference.frequency_hz.iter().map(|f| f / ratio).collect();
        let shape = self.model.magnitude(&mixed, reference.band, &recorded_hz)?;
        // If noise is stretched, its power is spread over more bins. A spectral line stays a line.
        let spread = if self.model.has_lines() { 1.0 } else { ratio.sqrt() };
        let gain = level * scaling.level / spread;
        Ok(shape.iter().map(|m| m * gain).collect())
    }
}
