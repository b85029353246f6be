//! Baking a representation.

use htex_dsp::grid::GRID_HZ;
use htex_play::{Asset, Motion};
use htex_player::Block;
use htex_player::layout::{MOST_HALF, MOST_LEVEL};

use crate::encode::{Condition, SpectraKind, encode};
use crate::filter::{Bins, Design, Wanted};
use crate::interpolator::Interpolator;
use crate::reading::{distance_db, of_tones};
use crate::texture::{Moment, Texture};
use crate::tones::{self, Tone};
use crate::{BakeError, Grid};

/// Largest error of the nine bands at a condition up to which the shortest filter is taken, dB.
const TOLERANCE_DB: f64 = 0.1;
/// Most conditions that are inserted between the wanted ones.
const MOST_CONDITIONS: usize = 64;
/// Lengths of one side of the filter that are tried.
const HALVES: [usize; 7] = [32, 64, 96, 128, 192, 256, MOST_HALF];

#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Baked {
    pub bytes: Vec<u8>,
    /// The conditions of the block: the wanted ones, and those between them that the accuracy needs.
    pub grid: Grid,
    /// The id of the baked model.
    pub model: String,
    /// Rate at which noise or sinusoids are computed, hertz.
    pub internal_rate_hz: f64,
    /// Coefficients of the noise filter; 0 for sinusoids.
    pub taps: usize,
    /// Sinusoids; 0 for noise.
    pub tones: usize,
    /// Largest error of the nine bands at the conditions, dB, among bands within 40 dB of the strongest.
    pub at_conditions_db: f64,
    /// The same midway between conditions, where the model mixes parameters and the player filters or sinusoids.
    pub between_db: f64,
}

/// Bakes a representation, named by its id or short name, else the best one, at the conditions of a grid. The block plays at
/// `rate_hz`. Conditions are inserted midway between neighbours until the error there is at most `within_db`, or the block has
/// 64 conditions.
///
/// # Errors
/// When the asset cannot be played, or a condition or the rate is out of range.
pub fn bake(
    asset: &Asset,
    model: Option<&str>,
    grid: &Grid,
    rate_hz: f64,
    within_db: f64,
) -> Result<Baked, BakeError> {
    let texture = Texture::new(asset, model)?;
    let mut grid = grid.clone();
    loop {
        let (baked, worst) = bake_grid(&texture, &grid, rate_hz)?;
        // More conditions do not help where the filters themselves are less accurate.
        let reachable_db = within_db.max(1.1 * baked.at_conditions_db);
        let refined = grid.refined(&worst, reachable_db);
        let is_last = refined == grid || refined.motions().count() > MOST_CONDITIONS;
        if baked.between_db <= within_db || is_last {
            return Ok(baked);
        }
        grid = refined;
    }
}

/// Bakes the conditions of a grid; returns the errors midway between them, too.
fn bake_grid(
    texture: &Texture<'_>,
    grid: &Grid,
    rate_hz: f64,
) -> Result<(Baked, Vec<(Motion, f64)>), BakeError> {
    let moments: Vec<Moment> = grid
        .motions()
        .map(|motion| texture.at(motion))
        .collect::<Result<_, _>>()?;
    for moment in &moments {
        check_level(moment)?;
    }
    let fastest = moments.iter().map(|m| m.ratio).fold(0.0, f64::max);
    let interpolator = Interpolator::new(rate_hz, fastest * texture.band().high_hz)?;
    let shape = match texture.model().is_sum_of_sines() {
        true => Shape::tones(texture, &moments)?,
        false => Shape::noise(texture, &moments, &interpolator)?,
    };
    let mut between = Vec::new();
    for (motion, mixed) in grid.midpoints() {
        between.push((motion, shape.error_db(texture, motion, &mixed)?));
    }
    let conditions: Vec<Condition> = (0..moments.len())
        .map(|i| shape.condition(i, interpolator.internal_hz))
        .collect();
    let (kind, size) = shape.kind();
    let bytes = encode(kind, size, grid, &interpolator, &conditions);
    Block::open(&bytes)?;
    let (taps, tones) = match kind {
        SpectraKind::Noise => (2 * size + 1, 0),
        SpectraKind::Tones { .. } => (0, size),
    };
    let baked = Baked {
        bytes,
        grid: grid.clone(),
        model: texture.id().to_owned(),
        internal_rate_hz: interpolator.internal_hz,
        taps,
        tones,
        at_conditions_db: shape.at_conditions_db,
        between_db: between.iter().map(|(_, error)| *error).fold(0.0, f64::max),
    };
    Ok((baked, between))
}

fn check_level(moment: &Moment) -> Result<(), BakeError> {
    let Motion {
        speed_mm_s,
        force_n,
        ..
    } = moment.motion;
    let most = 0.1 * f64::from(MOST_LEVEL);
    match moment.level_rms {
        level if level > most => Err(BakeError::Level {
            speed_mm_s,
            force_n,
            level,
            most,
        }),
        level if level > 0.0 => Ok(()),
        _ => Err(BakeError::Silent {
            speed_mm_s,
            force_n,
        }),
    }
}

/// The spectra of all conditions.
struct Shape {
    spectra: Spectra,
    /// The level of each condition as it is stored.
    levels: Vec<f64>,
    at_conditions_db: f64,
}

enum Spectra {
    /// The centre and one side of filters of unit energy.
    Noise(Design, Vec<Vec<f64>>),
    /// Sinusoids, and whether their phases are random.
    Tones(Vec<Vec<Tone>>, bool),
}

impl Shape {
    /// Designs the shortest filters within the tolerance.
    fn noise(
        texture: &Texture<'_>,
        moments: &[Moment],
        interpolator: &Interpolator,
    ) -> Result<Self, BakeError> {
        let slowest = moments
            .iter()
            .map(|m| m.ratio)
            .fold(f64::INFINITY, f64::min);
        let design = Design::new(interpolator.internal_hz, GRID_HZ * slowest);
        let (hz, band) = (design.frequencies_hz(), texture.band());
        let wanted = |moment: &Moment| {
            let recorded: Vec<f64> = hz.iter().map(|hz| hz / moment.ratio).collect();
            Ok(Wanted {
                magnitude: texture.magnitude(moment, &recorded)?,
                stated: texture.read(moment)?,
            })
        };
        let wanted: Result<Vec<Wanted>, BakeError> = moments.iter().map(wanted).collect();
        let wanted = wanted?;
        let filters = |half: usize| {
            let moments = moments.iter().map(|m| Bins::new(band, m.ratio));
            let filter = |(wanted, bins): (&Wanted, Bins)| design.filter(wanted, &bins, half);
            wanted.iter().zip(moments).map(filter).collect()
        };
        let mut best: Option<Self> = None;
        for half in HALVES {
            let spectra = Spectra::Noise(design.clone(), filters(half));
            let tried = Self::of(spectra, texture, moments)?;
            let is_within = tried.at_conditions_db <= TOLERANCE_DB;
            best = match best {
                Some(best) if best.at_conditions_db <= tried.at_conditions_db => Some(best),
                _ => Some(tried),
            };
            if is_within {
                break;
            }
        }
        match best {
            Some(best) => Ok(best),
            None => Self::of(
                Spectra::Noise(design.clone(), filters(MOST_HALF)),
                texture,
                moments,
            ),
        }
    }

    fn tones(texture: &Texture<'_>, moments: &[Moment]) -> Result<Self, BakeError> {
        let (tones, random) = tones::of_moments(moments, texture.band())?;
        Self::of(Spectra::Tones(tones, random), texture, moments)
    }

    /// Finds the levels, and measures the conditions.
    fn of(spectra: Spectra, texture: &Texture<'_>, moments: &[Moment]) -> Result<Self, BakeError> {
        let mut shape = Self {
            spectra,
            levels: vec![0.0; moments.len()],
            at_conditions_db: 0.0,
        };
        for (i, moment) in moments.iter().enumerate() {
            let read = shape.read(&[i], texture, moment.ratio);
            let rms = htex_dsp::grid::level_rms(&read);
            if !(rms > 0.0 && rms.is_finite()) {
                return Err(BakeError::Silent {
                    speed_mm_s: moment.motion.speed_mm_s,
                    force_n: moment.motion.force_n,
                });
            }
            shape.levels[i] = moment.level_rms / rms;
            let error = shape.error_db(texture, moment.motion, &[i])?;
            shape.at_conditions_db = shape.at_conditions_db.max(error);
        }
        Ok(shape)
    }

    /// Returns the magnitude on the band's grid of conditions mixed in equal parts, as the player mixes them, at unit power.
    fn read(&self, mixed: &[usize], texture: &Texture<'_>, ratio: f64) -> Vec<f64> {
        let band = texture.band();
        let part = 1.0 / mixed.len() as f64;
        match &self.spectra {
            Spectra::Noise(design, filters) => {
                let mut side = vec![0.0; filters[mixed[0]].len()];
                for i in mixed {
                    let filter = filters[*i].iter();
                    side.iter_mut()
                        .zip(filter)
                        .for_each(|(sum, c)| *sum += part * c);
                }
                let energy = 2.0 * side.iter().map(|c| c * c).sum::<f64>() - side[0] * side[0];
                let scale = 1.0 / energy.sqrt();
                side.iter_mut().for_each(|c| *c *= scale);
                Bins::new(band, ratio).read(design, &side)
            }
            Spectra::Tones(tones, _) => {
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
                of_tones(&sum, band, ratio)
            }
        }
    }

    /// Returns the largest error of the nine bands where conditions are mixed in equal parts, dB.
    fn error_db(
        &self,
        texture: &Texture<'_>,
        motion: Motion,
        mixed: &[usize],
    ) -> Result<f64, BakeError> {
        let moment = texture.at(motion)?;
        let level = mixed.iter().map(|i| self.levels[*i]).sum::<f64>() / mixed.len() as f64;
        let mut read = self.read(mixed, texture, moment.ratio);
        read.iter_mut().for_each(|m| *m *= level);
        let band = texture.band();
        let mut model = texture.read(&moment)?;
        model.iter_mut().for_each(|m| *m *= moment.level_rms);
        Ok(distance_db(&model, &read, band))
    }

    fn kind(&self) -> (SpectraKind, usize) {
        match &self.spectra {
            Spectra::Noise(_, filters) => (SpectraKind::Noise, filters[0].len() - 1),
            Spectra::Tones(tones, random_phase) => {
                let random_phase = *random_phase;
                (SpectraKind::Tones { random_phase }, tones[0].len())
            }
        }
    }

    /// Returns the stored numbers of a condition. Frequencies are stored in cycles per sample.
    fn condition(&self, i: usize, internal_hz: f64) -> Condition {
        Condition {
            level: self.levels[i],
            values: match &self.spectra {
                Spectra::Noise(_, filters) => filters[i].clone(),
                Spectra::Tones(tones, _) => {
                    let numbers = |&(hz, amplitude): &Tone| [hz / internal_hz, amplitude];
                    tones[i].iter().flat_map(numbers).collect()
                }
            },
        }
    }
}
