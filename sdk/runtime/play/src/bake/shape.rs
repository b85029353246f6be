//! The spectra and levels of all conditions, and the errors of the spectra.

use std::rc::Rc;

use crate::{Error, Motion};
use htex_player::layout::{MAX_RATIO, MIN_RATIO};

use crate::bake::Grid;
use crate::bake::filter::energy;
use crate::bake::moments::{Moment, Moments};
use crate::bake::noise::{Designer, Filter};
use crate::bake::tones::{self, Tone};

/// The error beyond the grid is computed at the lowest speed divided by this factor, and at the
/// highest speed times this factor.
const BEYOND: f64 = 2.0;

/// The spectra and levels of the conditions of a grid.
pub(crate) struct Shape {
    pub(crate) spectra: Spectra,
    /// The level of each condition, as the block stores it: the level of the whole spectrum,
    /// including the part beyond the edges of the band.
    pub(crate) levels: Vec<f64>,
    /// Largest error of the nine bands at the conditions, dB.
    pub(crate) at_conditions_db: f64,
}

#[derive(Clone)]
pub(crate) enum Spectra {
    Noise(Rc<Designer>, Vec<Filter>),
    /// The sinusoids of each condition, and whether their phases are random.
    Tones(Vec<Vec<Tone>>, bool),
}

impl Spectra {
    /// Mixes conditions in equal parts, as the player does, and returns the magnitude on the band's
    /// frequency grid, at unit power.
    fn read(&self, mixed: &[usize], texture: &Moments<'_>, ratio: f64) -> Vec<f64> {
        let part = 1.0 / mixed.len() as f64;
        match self {
            Self::Noise(designer, filters) => {
                let mut side = vec![0.0; filters[mixed[0]].len()];
                for i in mixed {
                    let filter = filters[*i].iter();
                    side.iter_mut().zip(filter).for_each(|(sum, c)| *sum += part * c);
                }
                let scale = 1.0 / energy(&side).sqrt();
                side.iter_mut().for_each(|c| *c *= scale);
                designer.read(&side, ratio)
            }
            Self::Tones(tones, _) => {
                let mut sum = vec![(0.0, 0.0); tones[mixed[0]].len()];
                for i in mixed {
                    for ((hz, amplitude), (f, a)) in sum.iter_mut().zip(&tones[*i]) {
                        *hz += part * f;
                        *amplitude += part * a;
                    }
                }
                let power: f64 = sum.iter().map(|(_, a)| 0.5 * a * a).sum();
                let scale = 1.0 / power.sqrt();
                sum.iter_mut().for_each(|(_, a)| *a *= scale);
                tones::magnitude(&sum, texture.band(), ratio)
            }
        }
    }
}

impl Shape {
    /// Computes the levels and the errors of the conditions. `None` if the error of a condition
    /// exceeds `within_db`.
    pub(crate) fn within(
        spectra: Spectra,
        texture: &Moments<'_>,
        moments: &[Rc<Moment>],
        within_db: f64,
    ) -> Result<Option<Self>, Error> {
        let mut shape = Self { spectra, levels: Vec::new(), at_conditions_db: 0.0 };
        for (i, moment) in moments.iter().enumerate() {
            let mut read = shape.spectra.read(&[i], texture, moment.ratio);
            let rms = htex_dsp::grid::level_rms(&read);
            if !(rms > 0.0 && rms.is_finite()) {
                return Err(Error::Silent {
                    speed_mm_s: moment.motion.speed_mm_s,
                    force_n: moment.motion.force_n,
                });
            }
            read.iter_mut().for_each(|m| *m /= rms);
            shape.levels.push(moment.level_rms / rms);
            let error_db = texture.bands().distance_db(&moment.stated, &read);
            if error_db > within_db {
                return Ok(None);
            }
            shape.at_conditions_db = shape.at_conditions_db.max(error_db);
        }
        Ok(Some(shape))
    }

    /// Returns the error of the nine bands, dB, at each motion midway between conditions. The list
    /// ends with the first error that exceeds `within_db`.
    pub(crate) fn between(
        &self,
        texture: &Moments<'_>,
        grid: &Grid,
        within_db: f64,
    ) -> Result<Vec<(Motion, f64)>, Error> {
        let mut errors = Vec::new();
        for (motion, mixed) in grid.midpoints() {
            let level = mixed.iter().map(|i| self.levels[*i]).sum::<f64>() / mixed.len() as f64;
            let error_db = self.error_db(texture, motion, &mixed, level)?;
            errors.push((motion, error_db));
            if error_db > within_db {
                break;
            }
        }
        Ok(errors)
    }

    /// Returns the largest error of the nine bands, dB, at half the lowest speed of the grid and at
    /// twice the highest one. At these speeds, the level follows the texture's scaling law, but the
    /// player keeps the spectrum of the nearest condition.
    pub(crate) fn beyond_db(&self, texture: &Moments<'_>, grid: &Grid) -> Result<f64, Error> {
        let law = texture.law();
        let last = grid.speeds_mm_s().len() - 1;
        let mut largest = 0.0f64;
        for (i, factor) in [(0, 1.0 / BEYOND), (last, BEYOND)] {
            let condition = grid.motions().nth(i).unwrap_or(Motion::new(0.0, 0.0));
            let speed = condition.speed_mm_s * factor;
            let ratio = (speed / condition.speed_mm_s).clamp(MIN_RATIO.into(), MAX_RATIO.into());
            let level = self.levels[i] * ratio.powf(law.level_speed.into());
            let motion = Motion::new(speed, condition.force_n);
            largest = largest.max(self.error_db(texture, motion, &[i], level)?);
        }
        Ok(largest)
    }

    /// Returns the error of the nine bands, dB, at a motion for which the player mixes conditions
    /// in equal parts.
    fn error_db(
        &self,
        texture: &Moments<'_>,
        motion: Motion,
        mixed: &[usize],
        level: f64,
    ) -> Result<f64, Error> {
        let moment = texture.moment(motion)?;
        let mut read = self.spectra.read(mixed, texture, moment.ratio);
        read.iter_mut().for_each(|m| *m *= level);
        let model = moment.stated.iter().map(|m| m * moment.level_rms);
        let model: Vec<f64> = model.collect();
        Ok(texture.bands().distance_db(&model, &read))
    }
}
