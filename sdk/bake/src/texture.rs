//! The texture of a representation at any motion, with the effects of a motion as a voice has them.

use htex_dsp::grid::GRID_HZ;
use htex_dsp::window::hann_main_lobe;
use htex_host::{Band, Descriptor, LoadedModel};
use htex_play::exploration::CEILING;
use htex_play::{Asset, Motion, Motions};

use crate::BakeError;

/// Points of a bin at which a magnitude is read.
const IN_BIN: i32 = 8;

/// A representation of an asset.
pub(crate) struct Texture<'a> {
    asset: &'a Asset,
    model: LoadedModel,
    id: String,
    motions: Motions,
}

/// A texture at one motion.
pub(crate) struct Moment {
    pub(crate) parameters: Vec<f64>,
    /// RMS in the asset's unit.
    pub(crate) level_rms: f64,
    /// Factor of all frequencies.
    pub(crate) ratio: f64,
    pub(crate) motion: Motion,
}

impl<'a> Texture<'a> {
    pub(crate) fn new(asset: &'a Asset, model: Option<&str>) -> Result<Self, BakeError> {
        let loaded = asset.loaded_model(model)?;
        let id = asset.representation_id(model)?.to_owned();
        if loaded.follows_motion() {
            return Err(BakeError::FollowsMotion { model: id });
        }
        Ok(Self {
            asset,
            model: loaded,
            motions: asset.motions(Some(&id))?,
            id,
        })
    }

    pub(crate) fn id(&self) -> &str {
        &self.id
    }

    pub(crate) fn model(&self) -> &Descriptor {
        self.model.descriptor()
    }

    /// Whether the voice reads as its magnitude states: the magnitude of sinusoids is that through the window, and the voice
    /// of a model that keeps energies compensates the window's blur. Other voices play their magnitude.
    fn reads_as_stated(&self) -> bool {
        self.model().is_sum_of_sines() || self.model().keeps_level
    }

    pub(crate) fn band(&self) -> Band {
        self.asset.band()
    }

    pub(crate) fn at(&self, motion: Motion) -> Result<Moment, BakeError> {
        let (parameters, level_rms) = self.asset.parameters(Some(&self.id), Some(motion))?;
        let scaling = self.motions.scaling(motion, CEILING);
        Ok(Moment {
            parameters,
            level_rms: level_rms * scaling.level,
            ratio: scaling.frequency,
            motion,
        })
    }

    /// Returns the magnitude of unit RMS at recorded frequencies, hertz: those before the moment's ratio.
    pub(crate) fn magnitude(&self, moment: &Moment, hz: &[f64]) -> Result<Vec<f64>, BakeError> {
        Ok(self.model.magnitude(&moment.parameters, self.band(), hz)?)
    }

    /// Returns the magnitude of unit RMS on the band's grid that a recording of the host's voice reads through a Hann
    /// window.
    pub(crate) fn read(&self, moment: &Moment) -> Result<Vec<f64>, BakeError> {
        let grid = self.band().grid_hz();
        if self.reads_as_stated() {
            return self.magnitude(moment, &grid);
        }
        // Positions in the window's main lobe, in bins, and their weights.
        let place = |i: i32| f64::from(i) / f64::from(IN_BIN);
        let lobe: Vec<(f64, f64)> = (-2 * IN_BIN..=2 * IN_BIN)
            .map(|i| (place(i), hann_main_lobe(place(i)).powi(2)))
            .collect();
        let mut dense = Vec::with_capacity(grid.len() * lobe.len());
        for hz in grid {
            dense.extend(lobe.iter().map(|(d, _)| (hz + d * GRID_HZ).max(0.0)));
        }
        let magnitude = self.magnitude(moment, &dense)?;
        let power = |part: &[f64]| -> f64 {
            let weighed = part
                .iter()
                .zip(&lobe)
                .map(|(m, (_, weight))| weight * m * m);
            weighed.sum()
        };
        let mut read: Vec<f64> = magnitude.chunks(lobe.len()).map(power).collect();
        read.iter_mut().for_each(|power| *power = power.sqrt());
        let rms = htex_dsp::grid::level_rms(&read);
        if rms > 0.0 {
            read.iter_mut().for_each(|m| *m /= rms);
        }
        Ok(read)
    }
}
