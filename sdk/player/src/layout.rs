//! Numbers of the block's layout (`spec/baked-1.md`).

/// The first bytes of a block.
pub const MAGIC: [u8; 4] = *b"HTXB";
/// The version of the layout.
pub const VERSION: u16 = 1;
/// Length of the header, bytes.
pub const HEADER: usize = 52;
/// Length of the checksum at the end, bytes.
pub const CHECKSUM: usize = 4;
/// The kind of a block of filtered noise.
pub const KIND_NOISE: u8 = 1;
/// The kind of a block of sinusoids.
pub const KIND_TONES: u8 = 2;
/// The flag of sinusoids that start at phases drawn from the seed.
pub const RANDOM_PHASE: u8 = 1;
/// Most coefficients on one side of a noise filter's centre; their number is a multiple of four.
pub const MOST_HALF: usize = 320;
/// Most sinusoids.
pub const MOST_TONES: usize = 64;
/// Highest ratio of the rate of the samples to the internal rate.
pub const MOST_UP: usize = 64;
/// Most coefficients of a phase of the interpolator; their number is a multiple of four.
pub const MOST_ROW: usize = 64;
/// Most filters that the conditions of a noise block mix.
pub const MOST_FILTERS: usize = 64;
/// Largest scale of a filter: a mix of integers of 16 bits with it is at most 64.
pub const MOST_SCALE: f32 = 1.0 / 16_777_216.0;
/// Most values on an axis of conditions.
pub const MOST_ON_AXIS: usize = 32;
/// Longest change of a motion, samples at the internal rate.
pub const MOST_GLIDE: u16 = 4096;
/// Range of the rate, hertz.
pub const RATE_HZ: (f32, f32) = (100.0, 1e6);
/// Largest magnitude of a filter coefficient or an amplitude.
pub const MOST_VALUE: f32 = 64.0;
/// Highest level, in the asset's unit.
pub const MOST_LEVEL: f32 = 1e9;
/// Highest ceiling of the level and highest full scale, in the asset's unit.
pub const MOST_CEILING: f32 = 1e10;
/// Largest magnitude of an exponent of the law.
pub const MOST_EXPONENT: f32 = 4.0;
/// Lowest speed at which a finger slides, mm/s; the voice is silent below.
pub const MIN_SLIDING_MM_S: f32 = 0.5;
/// Highest speed of a condition, and of a reading that is one of a finger, mm/s.
pub const MOST_SPEED_MM_S: f32 = 1_000.0;
/// Lowest force of a condition, newtons.
pub const LEAST_FORCE_N: f32 = 1e-6;
/// Highest force of a condition, and of a reading that is one of a finger, newtons.
pub const MOST_FORCE_N: f32 = 20.0;
/// Time for which the last good motion is held while readings are none of a finger, seconds.
pub const HOLD_S: f32 = 0.1;
/// Lowest ratio of a speed to the nearest of the grid, and lowest factor of frequencies.
pub const MIN_RATIO: f32 = 0.0625;
/// Highest ratio of a speed to the nearest of the grid, and highest factor of frequencies.
pub const MAX_RATIO: f32 = 8.0;
