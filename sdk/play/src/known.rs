//! Recorded conditions of a representation, with its parameters and levels at them.

use htex_host::LoadedModel;

use crate::exploration::{Coverage, Effects, Explored};
use crate::mesh::{Mesh, Weights};
use crate::{Error, Motion};

/// The motions that a representation was recorded at.
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
    /// What a voice with these effects makes of a motion, and whether it lies within what was recorded.
    pub fn coverage(&self, motion: Motion, effects: Effects) -> Coverage {
        let nearest = self.mesh.motion(&self.weights(motion));
        self.explored.coverage(motion, nearest, effects)
    }

    /// Weights of the conditions at a motion. Does not allocate.
    pub(crate) fn weights(&self, motion: Motion) -> Weights {
        self.mesh.weights(motion.speed_mm_s, motion.force_n)
    }
}

/// What is known of a representation: parameters and level at each condition.
#[derive(Debug, Clone)]
pub(crate) struct Known {
    pub(crate) motions: Motions,
    pub(crate) level_rms: Vec<f64>,
    pub(crate) parameters: Vec<Vec<f64>>,
}

impl Known {
    /// Numbers in the longest set of parameters.
    pub(crate) fn longest(&self) -> usize {
        self.parameters.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Parameters and level at a motion; the model decides in which space to mix.
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
