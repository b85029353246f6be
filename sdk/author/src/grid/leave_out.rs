//! Held-out error of a model: each block of time is compared with what a player makes of the rest
//! of the recording.

use htex_dsp::bands::rms;
use htex_format::{AtCondition, LeftOut, Measure, Measures};
use htex_host::LoadedModel;
use htex_play::exploration::CEILING;
use htex_play::{Conditions, Mesh, Motion};

use super::held_out::{Held, LeftOutBlock};
use super::played::motion;
use crate::conditions::Group;
use crate::{AuthorError, agreement, read_spectrum};

/// Returns the held-out error at each of `conditions` conditions. A block of time is left out, the
/// model is fitted to the rest, and what a player makes near the condition is compared with the
/// block; the error is the RMS over the blocks. `None` if no block has enough windows near the
/// condition, or the rest does not reach it. `fit` returns the stored parameters and the level of a
/// group.
pub(crate) fn left_out(
    model: &LoadedModel,
    conditions: usize,
    blocks: &[LeftOutBlock],
    mut fit: impl FnMut(&Group) -> Result<(Vec<f64>, f64), AuthorError>,
) -> Vec<Option<LeftOut>> {
    let mut errors: Vec<Vec<Measures>> = vec![Vec::new(); conditions];
    for block in blocks {
        let fits: Result<Vec<_>, _> = block.groups.iter().map(&mut fit).collect();
        // If the model cannot be fitted to the rest of the recording, this block gives no error.
        let Some(played) = fits.ok().and_then(|fits| Played::new(model, block, fits)) else {
            continue;
        };
        for held in &block.held {
            let error = played.error(held);
            if let (Some(error), Some(all)) = (error, errors.get_mut(held.cell)) {
                all.push(error);
            }
        }
    }
    let of_blocks = |all: &Vec<Measures>| {
        let over = |measure: Measure| {
            let of_block = all.iter().filter_map(|measures| measures.get(measure));
            let of_block: Vec<f64> = of_block.filter(|error| error.is_finite()).collect();
            (!of_block.is_empty()).then(|| rms(&of_block))
        };
        let measures = Measures::new(over).only(LeftOut::measures());
        over(Measure::NineBand).map(|_| LeftOut(measures))
    };
    errors.iter().map(of_blocks).collect()
}

/// The conditions of a grid fitted without a block of time, as a player plays them.
struct Played<'a> {
    model: &'a LoadedModel,
    mesh: Mesh,
    conditions: Conditions,
    fits: Vec<(Vec<f64>, f64)>,
}

impl<'a> Played<'a> {
    fn new(
        model: &'a LoadedModel,
        block: &LeftOutBlock,
        fits: Vec<(Vec<f64>, f64)>,
    ) -> Option<Self> {
        let points: Vec<[f64; 2]> = block.conditions.iter().map(motion).collect();
        let at = |(condition, fit): (usize, &(Vec<f64>, f64))| AtCondition {
            condition,
            level_rms: fit.1,
            quality: None,
            left_out: None,
        };
        let at: Vec<AtCondition> = fits.iter().enumerate().map(at).collect();
        (!points.is_empty()).then(|| Self {
            model,
            mesh: Mesh::new(&points),
            conditions: Conditions::new(&at, &block.conditions, block.law),
            fits,
        })
    }

    /// Compares what is played at the motion of left-out windows with the spectrum of those
    /// windows.
    fn error(&self, held: &Held) -> Option<Measures> {
        let reference = held.spectrum.as_ref();
        let magnitude = self.magnitude(held.motion, reference).ok()?;
        let error = agreement(reference, &magnitude);
        let is_finite = error.get(Measure::NineBand).is_some_and(f64::is_finite);
        is_finite.then_some(error.measures)
    }

    /// Returns the magnitudes at a motion, as a recording of the voice would read them. Where
    /// frequencies are scaled, it returns the same magnitudes as
    /// [`htex_play::Representation::magnitude`].
    fn magnitude(
        &self,
        [speed, force]: [f64; 2],
        reference: crate::SpectrumRef<'_>,
    ) -> Result<Vec<f64>, AuthorError> {
        let weights: Vec<(usize, f64)> = self.mesh.weights(speed, force).iter().collect();
        let sets: Vec<&[f64]> = weights.iter().map(|(i, _)| &self.fits[*i].0[..]).collect();
        let parts: Vec<f64> = weights.iter().map(|(_, weight)| *weight).collect();
        let level: f64 = weights.iter().map(|(i, w)| w * self.fits[*i].1).sum();
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
        // Noise that is stretched spreads its power over more bins; a line stays a line.
        let spread = if self.model.has_lines() { 1.0 } else { ratio.sqrt() };
        let gain = level * scaling.level / spread;
        Ok(shape.iter().map(|m| m * gain).collect())
    }
}
