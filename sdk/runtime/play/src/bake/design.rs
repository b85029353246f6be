//! Bakes a representation of an asset to a block.

use std::rc::Rc;

use htex_format::{Fluctuation, Quantity, Rights};

use crate::{Error, Motion, Representation};
use htex_dsp::grid::GRID_HZ;
use htex_player::layout::{CHECKSUM, HEADER, MOST_FILTERS, MOST_HALF, MOST_LEVEL};
use htex_player::{Block, Law};

use crate::bake::Grid;
use crate::bake::compress::{Factors, StoredFilters};
use crate::bake::encode::{BlockSpectra, Content, encode};
use crate::bake::filter::Design;
use crate::bake::fluctuation::BlockFluctuation;
use crate::bake::interpolator::Interpolator;
use crate::bake::moments::{Moment, Moments};
use crate::bake::noise::Designer;
use crate::bake::shape::{Shape, Spectra};
use crate::bake::tones::{self, Tone};

/// Largest error of the nine bands at a condition, dB. The shortest filter with at most this error
/// is used.
const TOLERANCE_DB: f64 = 0.1;
/// If the tolerance cannot be met, filters may be left out as long as they add at most this error
/// at a condition, dB.
const LEFT_OUT_DB: f64 = 0.01;
/// The same limit as [`LEFT_OUT_DB`], for a block that would otherwise take more than
/// [`WANTED_BYTES`].
const MORE_LEFT_OUT_DB: f64 = 0.1;
/// Target size of a block, bytes. To reach this size, the accuracy is reduced, but only if it
/// cannot meet the tolerance anyway.
const WANTED_BYTES: usize = 16 * 1024;
/// Maximum number of conditions, including the conditions inserted between the requested
/// conditions.
const MOST_CONDITIONS: usize = 64;
/// Lengths of one side of the filter, in the order in which they are tried.
const HALVES: [usize; 7] = [32, 64, 96, 128, 192, 256, MOST_HALF];
/// Magnitude that about one in a million samples of noise exceeds, relative to the level. It
/// determines the full scale of a block.
const CREST: f64 = 5.0;

#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct BakeResult {
    pub bytes: Vec<u8>,
    /// Number of 32-bit values that the player in C needs for the block, in addition to the struct
    /// `htex_player`.
    pub numbers: usize,
    /// The conditions of the block: the requested conditions, and conditions inserted between them
    /// for accuracy.
    pub grid: Grid,
    /// The id of the model that was baked.
    pub model: String,
    /// Author and licence of the asset. The generated source code states them in comments, because
    /// a block cannot contain them.
    pub rights: Rights,
    /// Physical quantity of the samples, which determines their unit.
    pub quantity: Quantity,
    /// The scaling law that the texture follows when the motion is beyond the grid.
    pub law: Law,
    /// The fluctuation in time that the block plays.
    pub fluctuation: Option<Fluctuation>,
    /// Ceiling of the level, in the asset's unit. Beyond the grid, the scaling law never raises the
    /// level above this ceiling.
    pub ceiling: f64,
    /// A magnitude that samples rarely exceed while the motion is within the grid.
    pub full_scale: f64,
    /// Rate at which noise or sinusoids are computed, hertz.
    pub internal_rate_hz: f64,
    /// Number of coefficients of the noise filter; 0 for sinusoids.
    pub taps: usize,
    /// Number of noise filters, from which the filter of each condition is mixed; 0 for sinusoids.
    pub filters: usize,
    /// Number of sinusoids; 0 for noise.
    pub tones: usize,
    /// Largest error, dB, at the conditions, in any of the nine frequency bands in which spectra
    /// are compared. Only bands within 40 dB of the strongest band count.
    pub at_conditions_db: f64,
    /// Largest error, dB, midway between conditions, in any of the nine bands. Such errors occur
    /// because the model interpolates parameters between conditions, whereas the player mixes
    /// filters or sinusoids.
    pub between_db: f64,
    /// Largest error, dB, at half the lowest and at twice the highest speed of the grid, in any of
    /// the nine bands. At these speeds, the scaling law changes the frequencies of the texture, but
    /// the player cannot change the frequencies of a filter. `None` if the law does not change
    /// frequencies, or if the block contains sinusoids, because the player can change their
    /// frequencies.
    pub beyond_db: Option<f64>,
    /// Lowest and highest recorded speed, mm/s, if the asset states them.
    pub recorded_speeds_mm_s: Option<(f64, f64)>,
}

/// Limits for baking: the largest error of a block, and the largest number of filter coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BakeLimits {
    /// Largest allowed error, dB, midway between conditions, in any of the nine bands in which
    /// spectra are compared. Conditions are inserted until the error is within this limit, or until
    /// there are 64 conditions.
    pub within_db: f64,
    /// Largest number of coefficients of a noise filter. A smaller number reduces the computing
    /// time per sample.
    pub longest: usize,
    /// Whether the block plays the fluctuation in time that the asset states.
    pub fluctuation: bool,
}

impl BakeLimits {
    /// Smallest number of coefficients of a filter.
    pub const FEWEST: usize = 2 * HALVES[0] + 1;
    /// Largest number of coefficients of a filter.
    pub const MOST: usize = 2 * MOST_HALF + 1;

    /// Limits the error midway between conditions, in decibels, and allows filters of any length up
    /// to [`Self::MOST`] coefficients.
    pub fn within_db(within_db: f64) -> Self {
        Self { within_db, longest: Self::MOST, fluctuation: false }
    }

    /// Limits the number of coefficients of a filter. A limit below [`Self::FEWEST`] counts as
    /// [`Self::FEWEST`].
    #[must_use]
    pub fn with_longest(self, longest: usize) -> Self {
        Self { longest, ..self }
    }

    /// Sets whether the block plays the fluctuation in time that the asset states. The fluctuation
    /// raises the block's full scale.
    #[must_use]
    pub fn with_fluctuation(self, fluctuation: bool) -> Self {
        Self { fluctuation, ..self }
    }

    /// Returns how many filter lengths may be tried.
    fn lengths(self) -> usize {
        let longest = self.longest.max(Self::FEWEST);
        HALVES.iter().take_while(|half| 2 * **half < longest).count()
    }
}

impl From<f64> for BakeLimits {
    fn from(within_db: f64) -> Self {
        Self::within_db(within_db)
    }
}

/// Bakes a representation: converts it to a block for a microcontroller, with the conditions of
/// `grid` and the sample rate `rate_hz`.
///
/// `limits` may also be a number: the largest allowed error midway between conditions, in decibels.
/// Conditions are inserted midway between neighbours until the error at all midpoints is within the
/// limits, or until the block has 64 conditions.
///
/// # Errors
/// Returns an error if the asset cannot be played, or if a condition or the rate is out of range.
pub fn bake(
    representation: Representation<'_>,
    grid: &Grid,
    rate_hz: f64,
    limits: impl Into<BakeLimits>,
) -> Result<BakeResult, Error> {
    let limits = limits.into();
    let within_db = limits.within_db;
    let texture = Moments::new(representation)?;
    let mut designs = Designs::new(limits.lengths());
    let mut grid = grid.clone();
    loop {
        let designed = GridDesign::new(&texture, &grid, rate_hz, &mut designs)?;
        let between_db = designed.between_db();
        // More conditions do not help if the filters themselves are less accurate.
        let reachable_db = within_db.max(1.1 * designed.shape.at_conditions_db);
        let refined = grid.refined(&designed.between, reachable_db);
        // A full axis is not changed, so the refined grid may be the same.
        let is_last = refined == grid || refined.motions().count() > MOST_CONDITIONS;
        if between_db <= within_db || is_last {
            return designed.baked(&texture, grid, limits);
        }
        grid = refined;
    }
}

/// State that is kept while conditions are inserted.
struct Designs {
    designer: Option<Rc<Designer>>,
    /// Number of lengths that may be tried.
    lengths: usize,
    /// Index of the length of the filters.
    length: usize,
    /// Whether no length meets the tolerance, so that the most accurate length is used.
    is_best: bool,
}

impl Designs {
    fn new(lengths: usize) -> Self {
        Self { designer: None, lengths, length: 0, is_best: false }
    }

    /// Returns the designer for a design. Makes a new designer if the design has changed.
    fn designer(&mut self, design: Design, texture: &Moments<'_>) -> Rc<Designer> {
        match &self.designer {
            Some(designer) if designer.is_of(&design) => Rc::clone(designer),
            _ => {
                let designer = Rc::new(Designer::new(design, texture.band()));
                // A new design may need another length, so the search starts from the shortest
                // again.
                *self = Self { designer: Some(Rc::clone(&designer)), ..Self::new(self.lengths) };
                designer
            }
        }
    }

    /// Returns the shortest filters that meet the tolerance, or the most accurate filters if none
    /// meet it.
    fn shape(
        &mut self,
        designer: &Rc<Designer>,
        texture: &Moments<'_>,
        moments: &[Rc<Moment>],
    ) -> Result<Shape, Error> {
        let with = |length: usize, within_db: f64| {
            let filter = |m: &Rc<Moment>| designer.filter(texture, m, HALVES[length]);
            let mut filters = Vec::new();
            for (i, moment) in moments.iter().enumerate() {
                filters.push(filter(moment)?);
                // A single condition may exceed the limit.
                let spectra = Spectra::Noise(Rc::clone(designer), vec![Rc::clone(&filters[i])]);
                let alone = std::slice::from_ref(moment);
                if Shape::within(spectra, texture, alone, within_db)?.is_none() {
                    return Ok::<_, Error>(None);
                }
            }
            let spectra = Spectra::Noise(Rc::clone(designer), filters);
            Shape::within(spectra, texture, moments, within_db)
        };
        let mut best: Option<(usize, Shape)> = None;
        // The grid only grows, and the largest error at its conditions grows with it. A length that
        // failed with fewer conditions also fails with more, so the search never returns to a
        // shorter length.
        let lengths =
            if self.is_best { self.length..self.length + 1 } else { self.length..self.lengths };
        for length in lengths {
            // A longer filter is useful only if it is more accurate, so the attempt ends as soon as
            // the error at a condition exceeds the smallest error so far.
            let least_db = best.as_ref().map_or(f64::INFINITY, |(_, shape)| shape.at_conditions_db);
            let Some(shape) = with(length, least_db)? else {
                continue;
            };
            let is_within = shape.at_conditions_db <= TOLERANCE_DB;
            best = Some((length, shape));
            if is_within {
                break;
            }
        }
        // The first length has no limit.
        let Some((length, shape)) = best else {
            return Err(Error::Refused(htex_player::OpenError::Values));
        };
        self.is_best = shape.at_conditions_db > TOLERANCE_DB;
        self.length = length;
        Ok(shape)
    }
}

/// The spectra of a grid before compression.
struct GridDesign {
    moments: Vec<Rc<Moment>>,
    interpolator: Interpolator,
    shape: Shape,
    between: Vec<(Motion, f64)>,
}

impl GridDesign {
    fn new(
        texture: &Moments<'_>,
        grid: &Grid,
        rate_hz: f64,
        designs: &mut Designs,
    ) -> Result<Self, Error> {
        let moments = grid.motions().map(|motion| texture.moment(motion));
        let moments: Vec<Rc<Moment>> = moments.collect::<Result<_, _>>()?;
        for moment in &moments {
            check_level(moment)?;
        }
        let [slowest, fastest] = ratios(&moments);
        let interpolator = Interpolator::new(rate_hz, fastest * texture.band().high_hz)?;
        let shape = if texture.model().is_sum_of_sines() {
            let (tones, random) = tones::tones_of(&moments, texture.band())?;
            let spectra = Spectra::Tones(tones, random);
            Shape::within(spectra, texture, &moments, f64::INFINITY)?
        } else {
            // The bins are closest at the slowest condition. They determine how fine the design
            // must be.
            let design = Design::new(interpolator.internal_hz, GRID_HZ * slowest);
            let designer = designs.designer(design, texture);
            Some(designs.shape(&designer, texture, &moments)?)
        };
        // Nothing exceeds an infinite limit.
        let Some(shape) = shape else {
            return Err(Error::Refused(htex_player::OpenError::Values));
        };
        Ok(Self {
            between: shape.between(texture, grid, f64::INFINITY)?,
            moments,
            interpolator,
            shape,
        })
    }

    fn between_db(&self) -> f64 {
        largest(&self.between)
    }

    /// Encodes the block, with as few filters as the accuracy allows.
    fn baked(
        mut self,
        texture: &Moments<'_>,
        grid: Grid,
        limits: BakeLimits,
    ) -> Result<BakeResult, Error> {
        let within_db = limits.within_db;
        let spectra = match self.shape.spectra.clone() {
            Spectra::Noise(designer, filters) => {
                let sides: Vec<&[f64]> = filters.iter().map(|f| f.as_slice()).collect();
                let [slowest, fastest] = ratios(&self.moments);
                let factors = designer.factors(&sides, slowest, fastest, MOST_FILTERS);
                BlockSpectra::Noise(self.compress(texture, &grid, within_db, &designer, &factors)?)
            }
            Spectra::Tones(tones, random_phase) => {
                let internal_hz = self.interpolator.internal_hz;
                let numbers = |&(hz, amplitude): &Tone| [hz / internal_hz, amplitude];
                BlockSpectra::Tones {
                    count: tones.first().map_or(0, Vec::len),
                    random_phase,
                    numbers: tones.iter().flatten().flat_map(numbers).collect(),
                }
            }
        };
        let law = texture.law();
        let fluctuation = texture.fluctuation().filter(|_| limits.fluctuation);
        let fluctuation =
            fluctuation.map(|strength| BlockFluctuation::new(strength, self.interpolator.rate_hz));
        let content = Content {
            quantity: texture.quantity(),
            law,
            ceiling: self.ceiling(texture),
            full_scale: self.full_scale() * fluctuation.map_or(1.0, |f| f.crest()),
            levels: self.shape.levels.clone(),
            spectra,
            fluctuation,
        };
        let bytes = encode(&grid, &self.interpolator, &content);
        let numbers = Block::open(&bytes)?.numbers();
        // A stored filter is its centre and one side.
        let (taps, filters, tones) = match &content.spectra {
            BlockSpectra::Noise(stored) => {
                (2 * stored.filters[0].len() - 1, stored.filters.len(), 0)
            }
            BlockSpectra::Tones { count, .. } => (0, 0, *count),
        };
        let cannot_follow = law.frequency_speed != 0.0 && tones == 0;
        let beyond_db =
            if cannot_follow { Some(self.shape.beyond_db(texture, &grid)?) } else { None };
        Ok(BakeResult {
            bytes,
            numbers,
            grid,
            model: texture.id().to_owned(),
            rights: texture.rights(),
            quantity: content.quantity,
            law,
            fluctuation: fluctuation.map(|f| f.strength),
            ceiling: content.ceiling,
            full_scale: content.full_scale,
            internal_rate_hz: self.interpolator.internal_hz,
            taps,
            filters,
            tones,
            at_conditions_db: self.shape.at_conditions_db,
            between_db: self.between_db(),
            beyond_db,
            recorded_speeds_mm_s: texture.recorded_speeds_mm_s(),
        })
    }

    /// Finds the smallest number of filters that meet the tolerance at the conditions and
    /// `within_db` between them, or that are nearly as accurate as all filters. Stores the shape
    /// and the errors of these filters.
    fn compress(
        &mut self,
        texture: &Moments<'_>,
        grid: &Grid,
        within_db: f64,
        designer: &Rc<Designer>,
        factors: &Factors,
    ) -> Result<StoredFilters, Error> {
        let exact_db = [self.shape.at_conditions_db, self.between_db()];
        // An error that is within a limit has to stay within it.
        let limit = |limit_db: f64, exact_db: f64, left_out_db: f64| {
            if exact_db <= limit_db { limit_db } else { exact_db + left_out_db }
        };
        let limits = |left_out_db: f64| {
            [
                limit(TOLERANCE_DB, exact_db[0], left_out_db),
                limit(within_db, exact_db[1], left_out_db),
            ]
        };
        for count in 1..=factors.len() {
            let stored = factors.stored(count);
            let fits = |count: usize| self.bytes(grid, &stored, count) <= WANTED_BYTES;
            let is_last_that_fits = fits(count) && !fits(count + 1);
            let limits_db = match (count == factors.len(), is_last_that_fits) {
                (true, _) => [f64::INFINITY; 2],
                (false, true) => limits(MORE_LEFT_OUT_DB),
                (false, false) => limits(LEFT_OUT_DB),
            };
            let filters = stored.conditions().into_iter().map(Rc::new).collect();
            let spectra = Spectra::Noise(Rc::clone(designer), filters);
            let shape = Shape::within(spectra, texture, &self.moments, limits_db[0])?;
            if let Some(shape) = shape {
                let between = shape.between(texture, grid, limits_db[1])?;
                if largest(&between) <= limits_db[1] {
                    (self.shape, self.between) = (shape, between);
                    return Ok(stored);
                }
            }
        }
        // This is never reached: the last number of filters has no limit, and a filter is never
        // zero.
        Err(Error::Refused(htex_player::OpenError::Values))
    }

    /// Returns the size, in bytes, of a block with `count` filters that have the same length as the
    /// stored filters.
    fn bytes(&self, grid: &Grid, stored: &StoredFilters, count: usize) -> usize {
        let axes = grid.speeds_mm_s().len() + grid.forces_n().len();
        let conditions = self.moments.len();
        let words = axes + self.interpolator.rows.len() + conditions + count;
        let length = stored.filters.first().map_or(0, Vec::len);
        let integers = count * (conditions + length);
        HEADER + 4 * words + (2 * integers).next_multiple_of(4) + CHECKSUM
    }

    /// Returns the ceiling of the level beyond the grid, in the scale of the stored levels. The
    /// scaling law does not raise the level above it.
    fn ceiling(&self, texture: &Moments<'_>) -> f64 {
        let stated = self.moments.iter().map(|m| m.level_rms);
        let pairs = self.shape.levels.iter().zip(stated);
        let loudest = pairs.max_by(|a, b| a.0.total_cmp(b.0));
        // Stored levels include the part of the spectrum beyond the edges of the band, so the
        // ceiling is raised by the same factor.
        let raised = loudest.map_or(1.0, |(stored, stated)| stored / stated);
        texture.ceiling_rms() * raised
    }

    /// Returns a magnitude that samples at the conditions rarely exceed. Sinusoids never exceed it.
    fn full_scale(&self) -> f64 {
        let crest = |i: usize| match &self.shape.spectra {
            Spectra::Noise(..) => CREST,
            Spectra::Tones(tones, _) => {
                // All sinusoids may peak at once, so their amplitudes add.
                let amplitudes = || tones[i].iter().map(|(_, a)| a.abs());
                let power: f64 = amplitudes().map(|a| 0.5 * a * a).sum();
                amplitudes().sum::<f64>() / power.sqrt()
            }
        };
        let levels = self.shape.levels.iter().enumerate();
        let most = levels.map(|(i, level)| level * crest(i));
        most.fold(0.0, f64::max)
    }
}

/// Returns the smallest and the largest factor by which frequencies are multiplied.
fn ratios(moments: &[Rc<Moment>]) -> [f64; 2] {
    let ratios = || moments.iter().map(|m| m.ratio);
    let slowest = ratios().fold(f64::INFINITY, f64::min);
    [slowest, ratios().fold(0.0, f64::max)]
}

fn largest(errors: &[(Motion, f64)]) -> f64 {
    errors.iter().map(|(_, error)| *error).fold(0.0, f64::max)
}

fn check_level(moment: &Moment) -> Result<(), Error> {
    let Motion { speed_mm_s, force_n, .. } = moment.motion;
    let most = 0.1 * f64::from(MOST_LEVEL);
    match moment.level_rms {
        level if level > most => Err(Error::Level { speed_mm_s, force_n, level, most }),
        level if level > 0.0 => Ok(()),
        _ => Err(Error::Silent { speed_mm_s, force_n }),
    }
}
