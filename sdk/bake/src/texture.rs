//! The texture of a representation at any motion, with the effects of a motion as a voice has them.

use htex_host::{Band, Descriptor, LoadedModel};
use htex_play::exploration::CEILING;
use htex_play::{Asset, Motion, Motions};

use crate::BakeError;

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
        Ok(self.model.read_magnitude(&moment.parameters, self.band())?)
    }
}
