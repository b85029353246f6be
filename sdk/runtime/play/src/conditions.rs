//! The recorded conditions of a representation, with its parameters and levels.

use htex_format::{AtCondition, Condition, Law, Representation, TrianglesError};
use htex_host::LoadedModel;

use crate::exploration::{Coverage, Effects, RecordedRange, Scaling, slides};
use crate::mesh::{Mesh, Weights};
use crate::{Error, Motion};

/// The conditions (speed and normal force) at which a representation was recorded, and the level at
/// each condition. [`Representation::conditions`](crate::Representation::conditions) returns them.
///
/// ```no_run
/// use htex::play::Effects;
/// use htex::{Motion, Texture};
/// let texture = Texture::open("sandpaper.htex")?;
/// let conditions = texture.representation(None)?.conditions()?;
/// println!("{}", conditions.coverage(Motion::new(160.0, 0.4), Effects::default()));
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Conditions {
    pub(crate) mesh: Mesh,
    pub(crate) range: RecordedRange,
    pub(crate) level_rms: Vec<f64>,
    /// The strongest recorded level.
    pub(crate) strongest_rms: f64,
}

/// How to play a motion: which recorded conditions are mixed, and how the mix is scaled.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placement {
    pub(crate) weights: Weights,
    /// Level of the mix before scaling.
    pub(crate) level_rms: f64,
    pub(crate) scaling: Scaling,
    nearest: [f64; 2],
}

impl Conditions {
    /// Collects the conditions at which a representation was fitted. The function triangulates the
    /// conditions itself, and ignores the triangles that the asset stores.
    pub fn new(at: &[AtCondition], conditions: &[Condition], law: Law) -> Self {
        Self::in_mesh(Mesh::new(&points(at, conditions)), at, conditions, law)
    }

    /// Collects the conditions of a representation, with its stored triangles.
    ///
    /// # Errors
    /// Returns an error if the stored triangles are invalid: [`htex_format::check_triangles`].
    pub(crate) fn for_representation(
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
            range: RecordedRange::new(at, conditions, law),
            strongest_rms: level_rms.iter().copied().fold(0.0, f64::max),
            level_rms,
        }
    }

    /// Returns how a voice with these effects plays a motion, and whether the motion is within the
    /// range of the recorded conditions.
    pub fn coverage(&self, motion: Motion, effects: Effects) -> Coverage {
        let Placement { scaling, nearest, .. } = self.locate(motion);
        self.range.coverage(motion, nearest, scaling, effects)
    }

    /// Returns the range of recorded speeds and forces, and the scaling law that applies outside
    /// it.
    pub fn range(&self) -> &RecordedRange {
        &self.range
    }

    /// Returns the factors that scale the texture at a motion outside the recorded range. The
    /// factor of the level is limited, so that the level is at most `ceiling` times the strongest
    /// recorded level. Does not allocate.
    pub fn scaling(&self, motion: Motion, ceiling: f64) -> Scaling {
        self.bounded(&self.locate(motion), ceiling)
    }

    /// Returns the factors at a placement, with the level limited to `ceiling` times the
    /// strongest recorded level.
    pub(crate) fn bounded(&self, placement: &Placement, ceiling: f64) -> Scaling {
        let most = ceiling * self.strongest_rms / placement.level_rms;
        let Scaling { frequency, level } = placement.scaling;
        // Inside the recorded range, no level exceeds the strongest one. If the level is 0, its
        // factor has no limit.
        let level = if level > 1.0 && level > most { most.max(1.0) } else { level };
        Scaling { frequency, level }
    }

    /// Returns how a motion is played. Does not allocate.
    pub(crate) fn locate(&self, motion: Motion) -> Placement {
        let (weights, nearest) = self.mesh.locate(motion.speed_mm_s, motion.force_n);
        Placement {
            level_rms: self.level_at(&weights),
            scaling: self.range.scaling(motion, nearest),
            weights,
            nearest,
        }
    }

    /// Returns the level of a mix of conditions: the weighted mean of their levels. The mean of
    /// logarithms is less accurate for simulated sandpaper: for a free motion, its median
    /// third-octave error is 1.2 dB instead of 0.4 dB. It is also not better for recordings: for
    /// 398 nodes of the Penn Haptic Texture Toolkit, each predicted from the others, its median
    /// error is 0.72 dB instead of 0.68 dB.
    fn level_at(&self, weights: &Weights) -> f64 {
        let level = |(i, weight): (usize, f64)| weight * self.level_rms[i];
        weights.iter().map(level).sum()
    }
}

/// Returns the speed and force of each condition at which a representation was fitted. An unknown
/// speed or force is 0.
fn points(at: &[AtCondition], conditions: &[Condition]) -> Vec<[f64; 2]> {
    let point = |at: &AtCondition| {
        let known = conditions.get(at.condition).copied().unwrap_or_default();
        [known.speed_mm_s, known.force_n].map(Option::unwrap_or_default)
    };
    at.iter().map(point).collect()
}

/// The recorded conditions of a representation, and the parameters at each condition.
#[derive(Debug, Clone)]
pub(crate) struct RecordedConditions {
    pub(crate) conditions: Conditions,
    pub(crate) parameters: Vec<Vec<f64>>,
}

impl RecordedConditions {
    /// Returns the length of the longest parameter set.
    pub(crate) fn longest(&self) -> usize {
        self.parameters.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Returns the parameters at a placement, interpolated by the model.
    pub(crate) fn mix(
        &self,
        model: &LoadedModel,
        placement: &Placement,
    ) -> Result<Vec<f64>, Error> {
        let weights = &placement.weights;
        let sets: Vec<&[f64]> = weights.iter().map(|(i, _)| &self.parameters[i][..]).collect();
        // Without interpolation, the recorded parameters play bit for bit.
        if let [only] = sets[..] {
            return Ok(only.to_vec());
        }
        Ok(model.interpolate(&sets, &weights.weight[..weights.count])?)
    }
}

/// Returns the default condition of a representation, as an index into its `at`
/// ([`crate::Representation::default_condition`]).
pub(crate) fn default_condition(at: &[AtCondition], conditions: &[Condition]) -> usize {
    let sounds = |i: &usize| !is_silent(&at[*i], conditions);
    let stronger =
        |best: usize, i: usize| if at[i].level_rms > at[best].level_rms { i } else { best };
    if at.is_empty() || sounds(&0) {
        0
    } else {
        (1..at.len()).filter(sounds).reduce(stronger).unwrap_or(0)
    }
}

/// Returns whether nothing is felt at a condition. An unknown speed or force does not make it
/// silent.
fn is_silent(at: &AtCondition, conditions: &[Condition]) -> bool {
    let known = conditions.get(at.condition).copied().unwrap_or_default();
    let [speed_mm_s, force_n] = [known.speed_mm_s, known.force_n].map(|x| x.unwrap_or(f64::MAX));
    at.level_rms <= 0.0 || !slides(speed_mm_s, force_n)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the default condition, given the speed, force and level of each condition.
    fn default_of(all: &[(Option<f64>, Option<f64>, f64)]) -> usize {
        let condition = |(speed_mm_s, force_n, _): &(Option<f64>, Option<f64>, f64)| Condition {
            speed_mm_s: *speed_mm_s,
            force_n: *force_n,
            ..Condition::default()
        };
        let conditions: Vec<Condition> = all.iter().rev().map(condition).collect();
        let at = all.iter().enumerate().map(|(i, (_, _, level_rms))| AtCondition {
            // In reverse order, so that the index into `at` differs from the index of the
            // condition.
            condition: all.len() - 1 - i,
            level_rms: *level_rms,
            quality: None,
            left_out: None,
        });
        default_condition(&at.collect::<Vec<_>>(), &conditions)
    }

    #[test]
    fn the_strongest_takes_the_place_of_a_silent_first() {
        let at = |speed, force, level| (Some(speed), Some(force), level);
        assert_eq!(default_of(&[at(80.0, 0.4, 0.1), at(160.0, 0.4, 0.3)]), 0, "it sounds");
        for silent in [at(80.0, 0.4, 0.0), at(0.0, 0.4, 0.9), at(80.0, 0.0, 0.9), at(0.4, 0.4, 0.9)]
        {
            let all = [silent, at(40.0, 0.4, 0.1), at(80.0, 0.4, 0.3), at(160.0, 0.4, 0.3)];
            assert_eq!(default_of(&all), 2, "{silent:?}: the first of the strongest");
            assert_eq!(default_of(&[silent, at(0.0, 0.0, 0.5)]), 0, "all are silent");
        }
        let unknown = (None, None, 0.2);
        assert_eq!(default_of(&[unknown, at(80.0, 0.4, 0.3)]), 0, "not known, not at rest");
        assert_eq!(default_of(&[at(0.0, 0.0, 0.0), unknown]), 1);
        assert_eq!(default_of(&[]), 0);
    }
}
