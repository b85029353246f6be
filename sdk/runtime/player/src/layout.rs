//! Constants of the block's layout (`spec/baked-1.md`).

/// The first bytes of a block.
pub const MAGIC: [u8; 4] = *b"HTXB";
/// The version of the layout.
pub const VERSION: u16 = 1;
/// Length of the header, bytes.
pub const HEADER: usize = 52;
/// Length of the checksum at the end, bytes.
pub const CHECKSUM: usize = 4;
/// Kind of a block with filtered noise.
pub const KIND_NOISE: u8 = 1;
/// Kind of a block with sinusoids.
pub const KIND_TONES: u8 = 2;
/// Flag for sinusoids with random phases, which the seed determines.
pub const RANDOM_PHASE: u8 = 1;
/// Flag of a block that has a fluctuation in time.
pub const FLUCTUATES: u8 = 2;
/// Length of the fluctuation, bytes.
pub const FLUCTUATION: usize = 8;
/// Largest absolute value of the offset that is added to the fluctuation's logarithm, octaves.
pub const MOST_OFFSET: f32 = 16.0;
/// Largest number of coefficients on one side of a noise filter; always a multiple of four.
pub const MOST_HALF: usize = 320;
/// Largest number of sinusoids.
pub const MOST_TONES: usize = 64;
/// Largest ratio of the output's sample rate to the internal rate.
pub const MOST_UP: usize = 64;
/// Largest number of interpolator coefficients per phase; always a multiple of four.
pub const MOST_ROW: usize = 64;
/// Largest number of filters in a noise block; each condition is a mix of these filters.
pub const MOST_FILTERS: usize = 64;
/// Largest scale of a filter. With this scale, the scaled product of a 16-bit weight and a 16-bit
/// coefficient is at most 64.
pub const MOST_SCALE: f32 = 1.0 / 16_777_216.0;
/// Largest number of values on an axis of conditions.
pub const MOST_ON_AXIS: usize = 32;
/// Longest gradual change (glide) to another motion, in samples at the internal rate.
pub const MOST_GLIDE: u16 = 4096;
/// Range of the sample rate, hertz.
pub const RATE_HZ: (f32, f32) = (100.0, 1e6);
/// Largest absolute value of a filter coefficient or an amplitude.
pub const MOST_VALUE: f32 = 64.0;
/// Highest level, in the asset's unit.
pub const MOST_LEVEL: f32 = 1e9;
/// Largest ceiling of the level and largest full scale, in the asset's unit.
pub const MOST_CEILING: f32 = 1e10;
/// Largest absolute value of an exponent of the law for motions beyond the grid.
pub const MOST_EXPONENT: f32 = 4.0;
/// Lowest speed at which a finger slides, mm/s. Below this speed the player is silent.
pub const MIN_SLIDING_MM_S: f32 = 0.5;
/// Highest speed of a condition, and of a plausible reading, mm/s.
pub const MOST_SPEED_MM_S: f32 = 1_000.0;
/// Lowest force of a condition, newtons.
pub const LEAST_FORCE_N: f32 = 1e-6;
/// Highest force of a condition, and of a plausible reading, newtons.
pub const MOST_FORCE_N: f32 = 20.0;
/// Time for which the player holds the last plausible motion while readings are not plausible,
/// seconds.
pub const HOLD_S: f32 = 0.1;
/// Lower limit for the ratio of the finger's speed to the nearest speed of the grid. This limit is
/// also the lowest factor by which frequencies change.
pub const MIN_RATIO: f32 = 0.0625;
/// Upper limit for the ratio of the finger's speed to the nearest speed of the grid. This limit is
/// also the highest factor by which frequencies change.
pub const MAX_RATIO: f32 = 8.0;
