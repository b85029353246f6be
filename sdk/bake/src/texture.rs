//! The texture of a representation at any motion, with the effects of a motion as a voice has them.

use htex_host::{Band, LoadedModel};
use htex_play::{Asset, Explored, Motion};

use crate::BakeError;

/// A representation of an asset.
pub(crate) struct Texture<'a> {
    asset: &'a Asset,
    model: LoadedModel,
    /// The representation's id.
    id: String,
    explored: Explored,
}

/// A texture at one motion.
pub(crate) struct Moment {
    pub(crate) parameters: Vec<f64>,
    /// RMS in the asset's unit.
    pub(crate) level_rms: f64,
    /// Factor of all frequencies.
    pub(crate) ratio: f64,
    /// The motion.
    pub(crate) motion: Motion,
}

impl<'a> Texture<'a> {
    pub(crate) fn new(asset: &'a Asset, model: Option<&str>) -> Result<Self, BakeError> {
        let loaded = asset.loaded_model(model)?;
        let id = asset.representation_id(model)?.to_owned();
        if loaded.follows_motion() {
            return Err(BakeError::FollowsMotion { model: id });
        }
        let manifest = asset.manifest();
        let stored = manifest.representations.iter().find(|r| r.model == id);
        let at = stored.map_or(&[][..], |r| &r.at);
        Ok(Self {
            asset,
            model: loaded,
            explored: Explored::new(at, &manifest.conditions),
            id,
        })
    }

    pub(crate) fn id(&self) -> &str {
        &self.id
    }

    pub(crate) fn band(&self) -> Band {
        self.asset.band()
    }

    /// Returns the texture at a motion.
    pub(crate) fn at(&self, motion: Motion) -> Result<Moment, BakeError> {
        let (parameters, level_rms) = self.asset.parameters(Some(&self.id), Some(motion))?;
        Ok(Moment {
            parameters,
            level_rms: level_rms * self.explored.force_gain(motion.force_n),
            ratio: self.explored.speed_ratio(motion.speed_mm_s),
            motion,
        })
    }

    /// Returns the magnitude of unit RMS at recorded frequencies, hertz: those before the moment's ratio.
    pub(crate) fn magnitude(&self, moment: &Moment, hz: &[f64]) -> Result<Vec<f64>, BakeError> {
        Ok(self.model.magnitude(&moment.parameters, self.band(), hz)?)
    }
}
