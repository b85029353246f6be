//! The recorded conditions of a representation, with its parameters and levels.

use htex_format::{AtCondition, Condition, Law, Representation, TrianglesError};
use htex_host::LoadedModel;

use crate::exploration::{Coverage, Effects, Explored, Scaling};
use crate::mesh::{Mesh, Weights};
use crate::{Error, Motion};

/// The motions at which a representation was recorded, with the level at each.
///
/// ```no_run
/// use htex::{Texture, Effects, Motion};
/// let motions = Texture::open("sandpaper.htex")?.motions(None)?;
/// println!("{}", motions.coverage(Motion::new(160.0, 0.4), Effects::default()));
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Motions {
    pub(crate) mesh: Mesh,
    pub(crate) explored: Explored,
    pub(crate) level_rms: Vec<f64>,
    /// The strongest recorded level.
    pub(crate) strongest_rms: f64,
}

/// How a motion is played: which recorded conditions are mixed, and how the mix is scaled.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Located {
    pub(crate) weights: Weights,
    /// Level of the mix before scaling.
    pub(crate) level_rms: f64,
    pub(crate) scaling: Scaling,
    nearest: [f64; 2],
}

impl Motions {
    /// Collects the conditions at which a representation was fitted, without stored triangles.
    pub fn new(at: &[AtCondition], conditions: &[Condition], law: Law) -> Self {
        Self::in_mesh(Mesh::new(&points(at, conditions)), at, conditions, law)
    }

    /// Collects the conditions of a representation, with its stored triangles.
    ///
    /// # Errors
    /// When the stored triangles are invalid: [`htex_format::check_triangles`].
    pub fn of(
        representation: &Representation,
        conditions: &[Condition],
        law: Law,
    ) -> Result<Self, TrianglesError> {
        let Representation { at, triangles, .. } = representation;
        let mesh = Mesh::with_triangles(&points(at, conditions), triangles)?;
        Ok(Self::in_mesh(mesh, at, conditions, law))
    }

    fn in_mesh(mesh: Mesh, at: &[AtCondition], conditions: &[Condition], law: Law) -> Self {
        let level_rms: Vec<f64> = at.iter().map(|at| at.level_rms).collect();
        Self {
            mesh,
            explored: Explored::new(at, conditions, law),
            strongest_rms: level_rms.iter().copied().fold(0.0, f64::max),
            level_rms,
        }
    }

    /// Returns how a voice with these effects plays a motion, and whether the motion lies within
    /// the recorded conditions.
    pub fn coverage(&self, motion: Motion, effects: Effects) -> Coverage {
        let Located { scaling, nearest, .. } = self.locate(motion);
        self.explored.coverage(motion, nearest, scaling, effects)
    }

    /// Returns the recorded speeds and forces, and the law that applies outside them.
    pub fn explored(&self) -> &Explored {
        &self.explored
    }

    /// Returns the factors that scale the texture at a motion outside the recorded ones. They limit
    /// the level to `ceiling` times the strongest recorded level. Does not allocate.
    pub fn scaling(&self, motion: Motion, ceiling: f64) -> Scaling {
        self.bounded(&self.locate(motion), ceiling)
    }

    /// Returns the factors for a located motion, with the level limited to `ceiling` times the
    /// strongest recorded level.
    pub(crate) fn bounded(&self, located: &Located, ceiling: f64) -> Scaling {
        let most = ceiling * self.strongest_rms / located.level_rms;
        let Scaling { frequency, level } = located.scaling;
        // Inside the recorded range no level exceeds the strongest one. A level of 0 has no limit
        // to its factor.
        let level = if level > 1.0 && level > most { most.max(1.0) } else { level };
        Scaling { frequency, level }
    }

    /// Returns how a motion is played. Does not allocate.
    pub(crate) fn locate(&self, motion: Motion) -> Located {
        let (weights, nearest) = self.mesh.locate(motion.speed_mm_s, motion.force_n);
        Located {
            level_rms: self.level_at(&weights),
            scaling: self.explored.scaling(motion, nearest),
            weights,
            nearest,
        }
    }

    /// Returns the level of a mix of conditions: the weighted mean of their levels. The mean of
    /// logarithms is less accurate for simulated sandpaper: its median third-octave error for a
    /// free motion is 1.2 dB instead of 0.4. On recordings it is no better: for 398 nodes of the
    /// Penn Haptic Texture Toolkit, each predicted from the others, the median is 0.72 against 0.68
    /// dB.
    fn level_at(&self, weights: &Weights) -> f64 {
        let level = |(i, weight): (usize, f64)| weight * self.level_rms[i];
        weights.iter().map(level).sum()
    }
}

/// Returns the speed and force of each condition at which a representation was fitted; an unknown
/// one is 0.
fn points(at: &[AtCondition], conditions: &[Condition]) -> Vec<[f64; 2]> {
    let point = |at: &AtCondition| {
        let known = conditions.get(at.condition).copied().unwrap_or_default();
        [known.speed_mm_s, known.force_n].map(Option::unwrap_or_default)
    };
    at.iter().map(point).collect()
}

/// The recorded conditions of a representation, with the parameters at each.
#[derive(Debug, Clone)]
pub(crate) struct Known {
    pub(crate) motions: Motions,
    pub(crate) parameters: Vec<Vec<f64>>,
}

impl Known {
    /// Returns the length of the longest parameter set.
    pub(crate) fn longest(&self) -> usize {
        self.parameters.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Returns the parameters for a located motion, interpolated by the model.
    pub(crate) fn at(&self, model: &LoadedModel, located: &Located) -> Result<Vec<f64>, Error> {
        let weights = &located.weights;
        let sets: Vec<&[f64]> = weights.iter().map(|(i, _)| &self.parameters[i][..]).collect();
        // Without interpolation, the recorded parameters play bit for bit.
        if let [only] = sets[..] {
            return Ok(only.to_vec());
        }
        Ok(model.interpolate(&sets, &weights.weight[..weights.count])?)
    }
}
