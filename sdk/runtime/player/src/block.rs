//! A validated block: the bytes of a baked texture.

use crate::crc::crc32;
use crate::law::{Factors, Law};
use crate::layout::{
    CHECKSUM, FLUCTUATES, FLUCTUATION, HEADER, HOLD_S, KIND_NOISE, KIND_TONES, LEAST_FORCE_N,
    MAGIC, MIN_SLIDING_MM_S, MOST_CEILING, MOST_EXPONENT, MOST_FILTERS, MOST_FORCE_N, MOST_GLIDE,
    MOST_HALF, MOST_LEVEL, MOST_OFFSET, MOST_ON_AXIS, MOST_ROW, MOST_SCALE, MOST_SPEED_MM_S,
    MOST_TONES, MOST_UP, MOST_VALUE, RANDOM_PHASE, RATE_HZ, VERSION,
};
use crate::quantity::Quantity;
use crate::weights::Weights;
use crate::words::{Integers, Words};

/// Reason why bytes are not a valid block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
#[repr(i32)]
pub enum OpenError {
    /// There are fewer bytes than a header and a checksum need.
    TooShort = 1,
    /// The bytes do not begin with `HTXB`.
    NotABlock = 2,
    /// The layout does not have version 1.
    Version = 3,
    /// The length in the header differs from the total length of the block's parts, or the input is
    /// shorter than the length in the header.
    Length = 4,
    /// The checksum does not match, so the bytes were changed after the block was written.
    Checksum = 5,
    /// A number in the header is out of range.
    Header = 6,
    /// A number after the header is not finite or out of range.
    Values = 7,
    /// The speeds or the forces of the conditions do not ascend, or are out of range.
    Axes = 8,
}

impl core::fmt::Display for OpenError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::TooShort => "the block is shorter than its header",
            Self::NotABlock => "the bytes are not a baked texture: they do not begin with HTXB",
            Self::Version => "the block has another version than 1: bake the asset again",
            Self::Length => "the length of the block differs from that in its header",
            Self::Checksum => "the checksum of the block does not match: copy or bake it again",
            Self::Header => "a number in the header of the block is out of range",
            Self::Values => "a number of the block is not finite or out of range",
            Self::Axes => "the speeds or forces of the block do not ascend or are out of range",
        })
    }
}

impl core::error::Error for OpenError {}

/// What a block stores for its conditions: filters for noise, or sinusoids.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlockKind {
    /// Symmetrical filters for white noise. Each filter has `half` coefficients on each side of the
    /// centre. Each condition has its own mix of the filters.
    Noise {
        /// Coefficients on one side.
        half: usize,
        /// Number of filters that the conditions mix.
        filters: usize,
    },
    /// Sinusoids.
    Tones {
        count: usize,
        /// Whether the phases are random. The seed determines random phases. Otherwise all
        /// sinusoids start at their crests.
        random_phase: bool,
    },
}

/// A baked texture. Its bytes were validated once and are read in place, without a copy.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    kind: BlockKind,
    quantity: Quantity,
    law: Law,
    /// Largest level to which the law may raise a level of the grid.
    ceiling: f32,
    full_scale: f32,
    /// Largest frequency to which the law may raise a frequency of the grid, cycles per sample of
    /// the internal rate.
    highest: f32,
    rate_hz: f32,
    up: usize,
    row: usize,
    glide: u32,
    speeds: Words<'a>,
    forces: Words<'a>,
    rows: Words<'a>,
    levels: Words<'a>,
    /// For noise: the scales of the filters. For sinusoids: frequencies and amplitudes of each
    /// condition.
    numbers: Words<'a>,
    /// For noise: the weights of the filters in each condition, and then the filters.
    integers: Integers<'a>,
    fluctuation: Option<StoredFluctuation>,
}

/// How a texture becomes stronger and weaker in time, as a block stores it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StoredFluctuation {
    /// Samples between two values of the envelope, from 1.
    pub(crate) period: u16,
    /// Standard deviations of the slow and the fast part of the envelope's logarithm, in steps of
    /// 1/32 dB.
    pub(crate) strength: [u8; 2],
    /// Added to the logarithm so that the mean square is 1, octaves.
    pub(crate) offset: f32,
}

/// What to play at a motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target {
    pub(crate) weights: Weights,
    pub(crate) level: f32,
    /// Factor for the frequencies of sinusoids.
    pub(crate) frequency: f32,
}

/// How many numbers each part after the header has: first the parts of 32-bit numbers, then the
/// parts of 16-bit numbers.
#[derive(Clone, Copy)]
struct Parts {
    speeds: usize,
    forces: usize,
    rows: usize,
    levels: usize,
    numbers: usize,
    integers: usize,
    /// Length of the fluctuation at the end, bytes; 0 without one.
    fluctuation: usize,
}

impl Parts {
    /// Returns the number of 32-bit values.
    fn words(&self) -> usize {
        self.speeds + self.forces + self.rows + self.levels + self.numbers
    }

    /// Returns the length of all parts, bytes, padded with zeros to a multiple of four.
    fn bytes(&self) -> usize {
        self.padded() + self.fluctuation
    }

    /// Returns the length without the fluctuation, bytes.
    fn padded(&self) -> usize {
        4 * self.words() + (2 * self.integers).next_multiple_of(4)
    }
}

impl<'a> Block<'a> {
    /// Validates bytes. Bytes after the end of the block are ignored, so a block may be read from a
    /// larger area of flash memory.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a complete block of version 1 with all numbers in
    /// range.
    pub fn open(bytes: &'a [u8]) -> Result<Self, OpenError> {
        let header = match bytes.split_first_chunk::<HEADER>() {
            Some((header, rest)) if rest.len() >= CHECKSUM => header,
            _ => return Err(OpenError::TooShort),
        };
        if header[..4] != MAGIC {
            return Err(OpenError::NotABlock);
        }
        if half_word(header, 4) != VERSION {
            return Err(OpenError::Version);
        }
        let length = word(header, 8) as usize;
        let payload = bytes.get(..length).and_then(|all| {
            let (before, sum) = all.split_last_chunk::<CHECKSUM>()?;
            Some((before, before.get(HEADER..)?, u32::from_le_bytes(*sum)))
        });
        let (summed, payload, sum) = payload.ok_or(OpenError::Length)?;
        // The checksum is tested before the other numbers of the header are used, so that damage is
        // reported as damage.
        if crc32(summed) != sum {
            return Err(OpenError::Checksum);
        }
        let (block, parts) = Self::read_header(header).ok_or(OpenError::Header)?;
        if payload.len() != parts.bytes() {
            return Err(OpenError::Length);
        }
        block.with(payload, parts).checked(payload, parts)
    }

    /// Reads the header, but not the parts. `None` if a number is out of range.
    fn read_header(header: &[u8; HEADER]) -> Option<(Self, Parts)> {
        let size = usize::from(half_word(header, 20));
        let filters = usize::from(header[26]);
        let fluctuates = header[7] & FLUCTUATES != 0;
        let kind = match (header[6], header[7] & !FLUCTUATES, filters) {
            (KIND_NOISE, 0, 1..=MOST_FILTERS) if size.is_multiple_of(4) && size <= MOST_HALF => {
                BlockKind::Noise { half: size, filters }
            }
            (KIND_TONES, flags, 0) if flags <= RANDOM_PHASE && size <= MOST_TONES => {
                BlockKind::Tones { count: size, random_phase: flags == RANDOM_PHASE }
            }
            _ => return None,
        };
        let quantity = Quantity::of_code(header[27])?;
        let number = |at| f32::from_bits(word(header, at));
        let rate_hz = number(12);
        let [up, row] = [16, 18].map(|at| usize::from(half_word(header, at)));
        let glide = half_word(header, 22);
        let [speeds, forces] = [header[24], header[25]].map(usize::from);
        let [a, b, c, ceiling, full_scale, highest] = [28, 32, 36, 40, 44, 48].map(number);
        let axis = 1..=MOST_ON_AXIS;
        let row_fits = match up {
            1 => row == 0,
            _ => row.is_multiple_of(4) && (4..=MOST_ROW).contains(&row),
        };
        let exponents = -MOST_EXPONENT..=MOST_EXPONENT;
        // `contains` is false for NaN, so these checks also refuse it.
        let in_range = size > 0
            && (RATE_HZ.0..=RATE_HZ.1).contains(&rate_hz)
            && (1..=MOST_UP).contains(&up)
            && row_fits
            && (1..=MOST_GLIDE).contains(&glide)
            && axis.contains(&speeds)
            && axis.contains(&forces)
            && [a, b, c].iter().all(|x| exponents.contains(x))
            && (0.0..=MOST_CEILING).contains(&ceiling)
            && (0.0..=MOST_CEILING).contains(&full_scale)
            && full_scale > 0.0
            && (0.0..=0.5).contains(&highest);
        let conditions = speeds * forces;
        let (numbers, integers) = match kind {
            BlockKind::Noise { half, filters } => (filters, filters * (conditions + half + 1)),
            BlockKind::Tones { count, .. } => (2 * count * conditions, 0),
        };
        let parts = Parts {
            speeds,
            forces,
            rows: up * row,
            levels: conditions,
            numbers,
            integers,
            fluctuation: if fluctuates { FLUCTUATION } else { 0 },
        };
        let none = Words::new(&[]);
        let block = Self {
            kind,
            quantity,
            law: Law { frequency_speed: a, level_speed: b, level_force: c },
            ceiling,
            full_scale,
            highest,
            rate_hz,
            up,
            row,
            glide: u32::from(glide),
            speeds: none,
            forces: none,
            rows: none,
            levels: none,
            numbers: none,
            integers: Integers::new(&[]),
            fluctuation: None,
        };
        in_range.then_some((block, parts))
    }

    /// Returns the block with access to its parts.
    fn with(self, payload: &'a [u8], parts: Parts) -> Self {
        let words = Words::new(payload);
        let mut from = 0;
        let mut next = |count: usize| {
            let part = words.part(from, count);
            from += count;
            part
        };
        let integers = payload.get(4 * parts.words()..).unwrap_or(&[]);
        let end = payload.get(parts.padded()..).and_then(<[u8]>::first_chunk::<FLUCTUATION>);
        Self {
            fluctuation: end.map(|end| StoredFluctuation {
                period: u16::from_le_bytes([end[0], end[1]]),
                strength: [end[2], end[3]],
                offset: f32::from_le_bytes([end[4], end[5], end[6], end[7]]),
            }),
            speeds: next(parts.speeds),
            forces: next(parts.forces),
            rows: next(parts.rows),
            levels: next(parts.levels),
            numbers: next(parts.numbers),
            integers: Integers::new(integers),
            ..self
        }
    }

    /// Returns the block if all its numbers are in range.
    fn checked(self, payload: &[u8], parts: Parts) -> Result<Self, OpenError> {
        let is_axis = |axis: Words<'_>, least: f32, most: f32| {
            let rises = axis.iter().zip(axis.iter().skip(1)).all(|(a, b)| a < b);
            rises && axis.iter().all(|x| (least..=most).contains(&x))
        };
        if !(is_axis(self.speeds, MIN_SLIDING_MM_S, MOST_SPEED_MM_S)
            && is_axis(self.forces, LEAST_FORCE_N, MOST_FORCE_N))
        {
            return Err(OpenError::Axes);
        }
        let values = -MOST_VALUE..=MOST_VALUE;
        let levels = 0.0..=MOST_LEVEL;
        let end = payload.get(4 * parts.words() + 2 * parts.integers..parts.padded());
        let offsets = -MOST_OFFSET..=MOST_OFFSET;
        let fluctuates = |f: StoredFluctuation| f.period > 0 && offsets.contains(&f.offset);
        let sound = self.rows.iter().all(|c| values.contains(&c))
            && self.levels.iter().all(|level| levels.contains(&level))
            && self.are_sound(self.numbers)
            && self.fluctuation.is_none_or(fluctuates)
            && end.is_some_and(|zeros| zeros.iter().all(|zero| *zero == 0));
        if sound { Ok(self) } else { Err(OpenError::Values) }
    }

    /// Returns whether the numbers of this kind of block are in range. Frequencies are at most half
    /// the internal rate.
    fn are_sound(&self, numbers: Words<'_>) -> bool {
        let amplitudes = -MOST_VALUE..=MOST_VALUE;
        match self.kind {
            BlockKind::Noise { .. } => numbers.iter().all(|x| (0.0..=MOST_SCALE).contains(&x)),
            BlockKind::Tones { .. } => numbers.iter().enumerate().all(|(i, x)| match i % 2 {
                0 => (0.0..=0.5).contains(&x),
                _ => amplitudes.contains(&x),
            }),
        }
    }

    /// Returns the sample rate, hertz.
    pub fn rate_hz(&self) -> f32 {
        self.rate_hz
    }

    /// Returns the rate at which noise or sinusoids are computed, hertz.
    pub fn internal_rate_hz(&self) -> f32 {
        self.rate_hz / self.up as f32
    }

    /// Returns what the block stores for its conditions.
    pub fn kind(&self) -> BlockKind {
        self.kind
    }

    /// Returns the physical quantity of the samples, which determines their unit.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// Returns the scaling law that the texture follows when the motion is beyond the grid of
    /// conditions.
    pub fn law(&self) -> Law {
        self.law
    }

    /// Returns the ceiling of the level, in the asset's unit. Beyond the grid, the scaling law
    /// never raises the level above this ceiling.
    pub fn ceiling(&self) -> f32 {
        self.ceiling
    }

    /// Returns a magnitude that samples rarely exceed while the motion is within the grid, in the
    /// asset's unit. Use it as the full scale of [`crate::Player::render_i16`].
    pub fn full_scale(&self) -> f32 {
        self.full_scale
    }

    /// Returns how many 32-bit numbers the player in C (`c/htex_player.h`) needs for the block. The
    /// C function `htex_player_size` returns the size of these numbers plus the size of the struct
    /// `htex_player`.
    pub fn numbers(&self) -> usize {
        let interpolator = (self.up + 2) * self.row;
        let envelope = if self.fluctuates() { 32 } else { 0 };
        interpolator
            + envelope
            + match self.kind {
                BlockKind::Noise { half, .. } => 2 * half + 2 * (2 * half + 1),
                BlockKind::Tones { count, .. } => 5 * count,
            }
    }

    /// Returns whether the texture becomes stronger and weaker in time.
    pub fn fluctuates(&self) -> bool {
        self.fluctuation.is_some()
    }

    pub(crate) fn fluctuation(&self) -> Option<StoredFluctuation> {
        self.fluctuation
    }

    /// Returns the speeds of the grid of conditions, mm/s, ascending.
    pub fn speeds_mm_s(&self) -> impl ExactSizeIterator<Item = f32> + 'a {
        self.speeds.iter()
    }

    /// Returns the forces of the grid of conditions, newtons, ascending.
    pub fn forces_n(&self) -> impl ExactSizeIterator<Item = f32> + 'a {
        self.forces.iter()
    }

    /// Returns the number of output samples for each sample at the internal rate.
    pub(crate) fn up(&self) -> usize {
        self.up
    }

    /// Returns the interpolator's coefficients for a phase.
    pub(crate) fn row(&self, phase: usize) -> Words<'a> {
        self.rows.part(phase * self.row, self.row)
    }

    /// Returns the duration of a glide to another motion, samples at the internal rate.
    pub(crate) fn glide(&self) -> u32 {
        self.glide
    }

    /// Returns how long a motion is held, samples.
    pub(crate) fn hold(&self) -> u32 {
        (HOLD_S * self.rate_hz) as u32
    }

    /// Returns the first condition of the grid.
    pub(crate) fn first(&self) -> (f32, f32) {
        (self.speeds.get(0), self.forces.get(0))
    }

    /// Returns the number of filters that are mixed.
    pub(crate) fn filters(&self) -> usize {
        match self.kind {
            BlockKind::Noise { filters, .. } => filters,
            BlockKind::Tones { .. } => 0,
        }
    }

    /// Returns the weight of a filter in a condition, an integer.
    pub(crate) fn filter_weight(&self, condition: usize, filter: usize) -> f32 {
        self.integers.get(condition * self.filters() + filter)
    }

    /// Returns the factor that converts the product of an integer weight and an integer coefficient
    /// to a coefficient.
    pub(crate) fn filter_scale(&self, filter: usize) -> f32 {
        self.numbers.get(filter)
    }

    /// Returns the coefficients of a filter as integers: first the centre, then one side outwards.
    pub(crate) fn filter(&self, filter: usize) -> Integers<'a> {
        let BlockKind::Noise { half, filters } = self.kind else {
            return Integers::new(&[]);
        };
        let first = filters * self.levels.len();
        self.integers.part(first + filter * (half + 1), half + 1)
    }

    /// Returns the frequencies and amplitudes of a condition, pairwise.
    pub(crate) fn tones(&self, condition: usize) -> Words<'a> {
        let BlockKind::Tones { count, .. } = self.kind else {
            return Words::new(&[]);
        };
        self.numbers.part(condition * 2 * count, 2 * count)
    }

    /// Returns what to play at a motion: the nearest motion of the grid, scaled by the law.
    pub(crate) fn target(&self, motion: (f32, f32)) -> Target {
        let nearest = (nearest_on(self.speeds, motion.0), nearest_on(self.forces, motion.1));
        let weights = Weights::new(self.speeds, self.forces, nearest.0, nearest.1);
        let mut level = 0.0;
        for (condition, weight) in weights.iter() {
            level += weight * self.levels.get(condition);
        }
        let factors =
            if motion == nearest { Factors::NONE } else { self.law.factors(motion, nearest) };
        Target { weights, level: self.scaled(level, factors.level), frequency: factors.frequency }
    }

    /// Multiplies a level by a factor, but does not raise it above the ceiling.
    fn scaled(&self, level: f32, factor: f32) -> f32 {
        let scaled = level * factor;
        if scaled > level && scaled > self.ceiling { level.max(self.ceiling) } else { scaled }
    }

    /// Reduces a factor of frequencies so that it does not raise `highest`, the highest frequency
    /// that sounds, above the permitted maximum.
    pub(crate) fn limited(&self, factor: f32, highest: f32) -> f32 {
        if factor > 1.0 && highest * factor > self.highest {
            (self.highest / highest).max(1.0)
        } else {
            factor
        }
    }
}

/// Clamps a number to the range of an axis.
fn nearest_on(axis: Words<'_>, number: f32) -> f32 {
    // Not `clamp`, which can panic.
    number.max(axis.get(0)).min(axis.last())
}

/// Returns the 16-bit number at a position in the header.
fn half_word(header: &[u8; HEADER], at: usize) -> u16 {
    u16::from_le_bytes([header[at], header[at + 1]])
}

/// Returns the 32-bit number at a position in the header.
fn word(header: &[u8; HEADER], at: usize) -> u32 {
    u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]])
}
