//! The bytes of a block.

use htex_player::crc32;
use htex_player::layout::{CHECKSUM, HEADER, KIND_NOISE, KIND_TONES, MAGIC, RANDOM_PHASE, VERSION};

use crate::Grid;
use crate::interpolator::Interpolator;

/// Length of a change of the motion, seconds.
const GLIDE_S: f64 = 0.020;

/// What conditions store.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SpectraKind {
    Noise,
    Tones { random_phase: bool },
}

/// The numbers of a condition.
pub(crate) struct Condition {
    pub(crate) level: f64,
    pub(crate) values: Vec<f64>,
}

/// Encodes a block. All conditions have `size` coefficients on a side, or sinusoids.
pub(crate) fn encode(
    kind: SpectraKind,
    size: usize,
    grid: &Grid,
    interpolator: &Interpolator,
    conditions: &[Condition],
) -> Vec<u8> {
    let glide = (GLIDE_S * interpolator.internal_hz).round().max(1.0) as u16;
    let numbers = || {
        let axes = grid.speeds_mm_s().iter().chain(grid.forces_n());
        let stored = conditions.iter();
        let stored = stored.flat_map(|c| std::iter::once(&c.level).chain(&c.values));
        axes.chain(&interpolator.rows).chain(stored)
    };
    let length = HEADER + 4 * numbers().count() + CHECKSUM;
    let (kind, flags) = match kind {
        SpectraKind::Noise => (KIND_NOISE, 0),
        SpectraKind::Tones { random_phase } => {
            (KIND_TONES, if random_phase { RANDOM_PHASE } else { 0 })
        }
    };
    let mut bytes = Vec::with_capacity(length);
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend([kind, flags]);
    bytes.extend((length as u32).to_le_bytes());
    bytes.extend((interpolator.rate_hz as f32).to_le_bytes());
    for number in [interpolator.up, interpolator.row, size, usize::from(glide)] {
        bytes.extend((number as u16).to_le_bytes());
    }
    bytes.extend([grid.speeds_mm_s().len(), grid.forces_n().len()].map(|n| n as u8));
    bytes.resize(HEADER, 0);
    numbers().for_each(|x| bytes.extend((*x as f32).to_le_bytes()));
    bytes.extend(crc32(&bytes).to_le_bytes());
    bytes
}
