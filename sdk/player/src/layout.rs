//! Numbers of the block's layout (`spec/baked-1.md`).

/// The first bytes of a block.
pub const MAGIC: [u8; 4] = *b"HTXB";
/// The version of the layout.
pub const VERSION: u16 = 1;
/// Length of the header, bytes.
pub const HEADER: usize = 32;
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
/// Highest speed or force of a condition.
pub const MOST_MOTION: f32 = 1e6;
/// Lowest speed at which a finger slides, mm/s; the voice is silent below.
pub const MIN_SLIDING_MM_S: f32 = 0.5;
