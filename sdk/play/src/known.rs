//! Recorded conditions of a representation, with its parameters and levels.

use htex_host::LoadedModel;

use crate::exploration::{Coverage, Effects, Explored};
use crate::mesh::{Mesh, Weights};
use crate::{Error, Motion};

/// The motions at which a representation was recorded.
///
/// ```no_run
/// use htex::{Asset, Effects, Motion};
/// let motions = Asset::open("sandpaper.htex")?.motions(None)?;
/// println!("{}", motions.coverage(Motion::new(160.0, 0.4), Effects::default()));
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Motions {
    pub(crate) mesh: Mesh,
    pub(crate) explored: Explored,
}

impl Motions {
    /// Returns how a voice with these effects plays a motion, and whether the motion lies within the recorded conditions.
    pub fn coverage(&self, motion: Motion, effects: Effects) -> Coverage {
        let nearest = self.mesh.motion(&self.weights(motion));
        self.explored.coverage(motion, nearest, effects)
    }

    /// Returns the weights of the conditions at a motion. Does not allocate.
    pub(crate) fn weights(&self, motion: Motion) -> Weights {
        self.mesh.weights(motion.speed_mm_s, motion.force_n)
    }
}

/// The recorded conditions of a representation, with parameters and level at each.
#[derive(Debug, Clone)]
pub(crate) struct Known {
    pub(crate) motions: Motions,
    pub(crate) level_rms: Vec<f64>,
    pub(crate) parameters: Vec<Vec<f64>>,
}

impl Known {
    /// Returns the length of the longest parameter set.
    pub(crate) fn longest(&self) -> usize {
        self.parameters.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Returns parameters and level at a motion, interpolated by the model.
    pub(crate) fn at(&self, model: &LoadedModel, motion: Motion) -> Result<(Vec<f64>, f64), Error> {
        let weights = self.motions.weights(motion);
        let level_rms = weights.iter().map(|(i, w)| w * self.level_rms[i]).sum();
        let sets: Vec<&[f64]> = weights
            .iter()
            .map(|(i, _)| &self.parameters[i][..])
            .collect();
        if let [only] = sets[..] {
            return Ok((only.to_vec(), level_rms));
        }
        let parameters = model.interpolate(&sets, &weights.weight[..weights.count])?;
        Ok((parameters, level_rms))
    }
}
