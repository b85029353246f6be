//! A validated block of bytes.

use crate::crc::crc32;
use crate::layout::{
    CHECKSUM, HEADER, KIND_NOISE, KIND_TONES, MAGIC, MOST_GLIDE, MOST_HALF, MOST_LEVEL,
    MOST_MOTION, MOST_ON_AXIS, MOST_ROW, MOST_TONES, MOST_UP, MOST_VALUE, RANDOM_PHASE, RATE_HZ,
    VERSION,
};
use crate::weights::Weights;
use crate::words::Words;

/// Reason why bytes are not a playable block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
#[repr(i32)]
pub enum OpenError {
    /// The bytes are fewer than a header and a checksum.
    TooShort = 1,
    /// The bytes do not begin with `HTXB`.
    NotABlock = 2,
    /// The layout has another version than 1.
    Version = 3,
    /// The length in the header is not that of its parts, or exceeds the bytes.
    Length = 4,
    /// The checksum does not match: the bytes were changed.
    Checksum = 5,
    /// A number of the header is out of range.
    Header = 6,
    /// A number after the header is not finite or out of range.
    Values = 7,
    /// The axes of the conditions do not ascend.
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
            Self::Axes => "the speeds or forces of the block do not ascend",
        })
    }
}

impl core::error::Error for OpenError {}

/// What a block stores for each condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlockKind {
    /// A symmetrical filter for white noise, with `half` coefficients on each side of its centre.
    Noise {
        /// Coefficients on one side.
        half: usize,
    },
    /// Sinusoids.
    Tones {
        count: usize,
        /// Whether their phases are drawn from the seed; otherwise all start at their crests.
        random_phase: bool,
    },
}

impl BlockKind {
    /// Returns the numbers stored for a condition after its level.
    fn values(self) -> usize {
        match self {
            Self::Noise { half } => half + 1,
            Self::Tones { count, .. } => 2 * count,
        }
    }
}

/// A baked texture, validated once and read in place.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    kind: BlockKind,
    rate_hz: f32,
    up: usize,
    row: usize,
    glide: u32,
    speeds: Words<'a>,
    forces: Words<'a>,
    rows: Words<'a>,
    conditions: Words<'a>,
}

/// A level and the conditions to mix.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target {
    pub(crate) weights: Weights,
    pub(crate) level: f32,
}

impl<'a> Block<'a> {
    /// Validates bytes. Bytes after the block's end are ignored, so a block may be read from a larger area of flash memory.
    ///
    /// # Errors
    /// When the bytes are not a complete block of version 1 with all numbers in range.
    pub fn open(bytes: &'a [u8]) -> Result<Self, OpenError> {
        let (header, _) = bytes
            .split_first_chunk::<HEADER>()
            .ok_or(OpenError::TooShort)?;
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
        if crc32(summed) != sum {
            return Err(OpenError::Checksum);
        }
        let block = Self::read_header(header, Words::new(payload)).ok_or(OpenError::Header)?;
        let stored = [block.speeds, block.forces, block.rows, block.conditions];
        let needed = [header[24], header[25]].map(usize::from);
        let [speeds, forces] = needed;
        let conditions = speeds * forces * block.stride();
        let needed = [speeds, forces, block.up_words(), conditions];
        let all: usize = needed.iter().sum();
        if stored.map(Words::len) != needed || payload.len() != 4 * all {
            return Err(OpenError::Length);
        }
        block.checked()
    }

    /// Reads the header; `None` if a number is out of range.
    fn read_header(header: &[u8; HEADER], words: Words<'a>) -> Option<Self> {
        let size = usize::from(half_word(header, 20));
        let kind = match (header[6], header[7]) {
            (KIND_NOISE, 0) if size.is_multiple_of(4) && size <= MOST_HALF => {
                BlockKind::Noise { half: size }
            }
            (KIND_TONES, flags) if flags <= RANDOM_PHASE && size <= MOST_TONES => {
                BlockKind::Tones {
                    count: size,
                    random_phase: flags == RANDOM_PHASE,
                }
            }
            _ => return None,
        };
        let rate_hz = f32::from_bits(word(header, 12));
        let [up, row] = [16, 18].map(|at| usize::from(half_word(header, at)));
        let glide = half_word(header, 22);
        let [speeds, forces] = [header[24], header[25]].map(usize::from);
        let axis = 1..=MOST_ON_AXIS;
        let row_fits = match up {
            1 => row == 0,
            _ => row.is_multiple_of(4) && (4..=MOST_ROW).contains(&row),
        };
        let in_range = size > 0
            && (RATE_HZ.0..=RATE_HZ.1).contains(&rate_hz)
            && (1..=MOST_UP).contains(&up)
            && row_fits
            && (1..=MOST_GLIDE).contains(&glide)
            && axis.contains(&speeds)
            && axis.contains(&forces)
            && header[26..] == [0; 6];
        let rows = up * row;
        let from = speeds + forces + rows;
        in_range.then(|| Self {
            kind,
            rate_hz,
            up,
            row,
            glide: u32::from(glide),
            speeds: words.part(0, speeds),
            forces: words.part(speeds, forces),
            rows: words.part(speeds + forces, rows),
            conditions: words.part(from, speeds * forces * (1 + kind.values())),
        })
    }

    fn up_words(&self) -> usize {
        self.up * self.row
    }

    fn stride(&self) -> usize {
        1 + self.kind.values()
    }

    /// Returns the block if its numbers are in range.
    fn checked(self) -> Result<Self, OpenError> {
        let is_axis = |axis: Words<'_>| {
            let rises = axis.iter().zip(axis.iter().skip(1)).all(|(a, b)| a < b);
            rises && axis.iter().all(|x| (0.0..=MOST_MOTION).contains(&x))
        };
        if !(is_axis(self.speeds) && is_axis(self.forces)) {
            return Err(OpenError::Axes);
        }
        let values = -MOST_VALUE..=MOST_VALUE;
        let conditions = 0..self.speeds.len() * self.forces.len();
        let sound = self.rows.iter().all(|c| values.contains(&c))
            && conditions.into_iter().all(|i| {
                (0.0..=MOST_LEVEL).contains(&self.level(i)) && self.are_sound(self.values(i))
            });
        match sound {
            true => Ok(self),
            false => Err(OpenError::Values),
        }
    }

    /// Returns whether the numbers of a condition are in range. Frequencies are at most half the internal rate.
    fn are_sound(&self, values: Words<'_>) -> bool {
        let is_tones = matches!(self.kind, BlockKind::Tones { .. });
        values
            .iter()
            .enumerate()
            .all(|(i, x)| match is_tones && i % 2 == 0 {
                true => (0.0..=0.5).contains(&x),
                false => (-MOST_VALUE..=MOST_VALUE).contains(&x),
            })
    }

    /// Returns the rate of the samples, hertz.
    pub fn rate_hz(&self) -> f32 {
        self.rate_hz
    }

    /// Returns the rate at which noise or sinusoids are computed, hertz.
    pub fn internal_rate_hz(&self) -> f32 {
        self.rate_hz / self.up as f32
    }

    /// Returns what is stored for each condition.
    pub fn kind(&self) -> BlockKind {
        self.kind
    }

    /// Returns the speeds of the grid of conditions, mm/s, ascending.
    pub fn speeds_mm_s(&self) -> impl ExactSizeIterator<Item = f32> + 'a {
        self.speeds.iter()
    }

    /// Returns the forces of the grid of conditions, newtons, ascending.
    pub fn forces_n(&self) -> impl ExactSizeIterator<Item = f32> + 'a {
        self.forces.iter()
    }

    /// Returns the number of samples for each sample of the internal rate.
    pub(crate) fn up(&self) -> usize {
        self.up
    }

    /// Returns the coefficients of a phase of the interpolator.
    pub(crate) fn row(&self, phase: usize) -> Words<'a> {
        self.rows.part(phase * self.row, self.row)
    }

    /// Returns the length of a change of the motion, samples at the internal rate.
    pub(crate) fn glide(&self) -> u32 {
        self.glide
    }

    /// Returns the first condition of the grid.
    pub(crate) fn first(&self) -> (f32, f32) {
        (self.speeds.at(0), self.forces.at(0))
    }

    fn level(&self, condition: usize) -> f32 {
        self.conditions.at(condition * self.stride())
    }

    /// Returns the numbers of a condition after its level.
    pub(crate) fn values(&self, condition: usize) -> Words<'a> {
        let stride = self.stride();
        self.conditions.part(condition * stride + 1, stride - 1)
    }

    /// Returns what to play at a motion, clamped to the grid.
    pub(crate) fn target(&self, speed_mm_s: f32, force_n: f32) -> Target {
        let weights = Weights::new(self.speeds, self.forces, speed_mm_s, force_n);
        let levels = weights.iter().map(|(i, weight)| weight * self.level(i));
        Target {
            level: levels.sum(),
            weights,
        }
    }
}

/// Returns the 16-bit number at a byte of the header.
fn half_word(header: &[u8; HEADER], at: usize) -> u16 {
    u16::from_le_bytes([header[at], header[at + 1]])
}

/// Returns the 32-bit number at a byte of the header.
fn word(header: &[u8; HEADER], at: usize) -> u32 {
    u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]])
}
