//! Writes the bytes of a block.

use htex_format::Quantity;
use htex_player::layout::{
    CHECKSUM, FLUCTUATES, HEADER, KIND_NOISE, KIND_TONES, MAGIC, RANDOM_PHASE, VERSION,
};
use htex_player::{Law, crc32};

use crate::bake::Grid;
use crate::bake::compress::StoredFilters;
use crate::bake::fluctuation::BlockFluctuation;
use crate::bake::interpolator::Interpolator;

/// Duration of the glide to another motion, seconds.
const GLIDE_S: f64 = 0.020;

/// The content of a block, apart from its grid and its interpolator.
pub(crate) struct Content {
    pub(crate) quantity: Quantity,
    pub(crate) law: Law,
    pub(crate) ceiling: f64,
    pub(crate) full_scale: f64,
    pub(crate) levels: Vec<f64>,
    pub(crate) spectra: BlockSpectra,
    pub(crate) fluctuation: Option<BlockFluctuation>,
}

/// What a block stores for its conditions.
pub(crate) enum BlockSpectra {
    Noise(StoredFilters),
    /// For each condition and each sinusoid: a frequency, in cycles per sample of the internal
    /// rate, and an amplitude.
    Tones {
        count: usize,
        random_phase: bool,
        numbers: Vec<f64>,
    },
}

pub(crate) fn encode(grid: &Grid, interpolator: &Interpolator, content: &Content) -> Vec<u8> {
    let glide = (GLIDE_S * interpolator.internal_hz).round().max(1.0) as u16;
    let (kind, flags, size, filters) = match &content.spectra {
        BlockSpectra::Noise(stored) => {
            let half = stored.filters.first().map_or(0, |f| f.len() - 1);
            (KIND_NOISE, 0, half, stored.filters.len())
        }
        BlockSpectra::Tones { count, random_phase, .. } => {
            let flags = if *random_phase { RANDOM_PHASE } else { 0 };
            (KIND_TONES, flags, *count, 0)
        }
    };
    let flags = if content.fluctuation.is_some() { flags | FLUCTUATES } else { flags };
    let mut bytes = Vec::new();
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend([kind, flags]);
    // The length is filled in at the end.
    bytes.extend([0; 4]);
    bytes.extend((interpolator.rate_hz as f32).to_le_bytes());
    for number in [interpolator.up, interpolator.row, size, usize::from(glide)] {
        bytes.extend((number as u16).to_le_bytes());
    }
    let (speeds, forces) = (grid.speeds_mm_s(), grid.forces_n());
    bytes.extend([speeds.len(), forces.len(), filters].map(|n| n as u8));
    bytes.push(code(content.quantity) as u8);
    let Law { frequency_speed, level_speed, level_force } = content.law;
    let scalars = [content.ceiling, content.full_scale, interpolator.highest].map(|x| x as f32);
    for number in [frequency_speed, level_speed, level_force].iter().chain(&scalars) {
        bytes.extend(number.to_le_bytes());
    }
    debug_assert_eq!(bytes.len(), HEADER);
    let mut put = |numbers: &[f64]| {
        let numbers = numbers.iter();
        bytes.extend(numbers.flat_map(|x| (*x as f32).to_le_bytes()));
    };
    put(speeds);
    put(forces);
    put(&interpolator.rows);
    put(&content.levels);
    match &content.spectra {
        BlockSpectra::Noise(stored) => {
            bytes.extend(stored.scales.iter().flat_map(|scale| scale.to_le_bytes()));
            let integers = stored.weights.iter().chain(stored.filters.iter().flatten());
            bytes.extend(integers.flat_map(|x| x.to_le_bytes()));
        }
        BlockSpectra::Tones { numbers, .. } => put(numbers),
    }
    // The 16-bit integers may end between two words.
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    if let Some(BlockFluctuation { period, strength, offset }) = content.fluctuation {
        bytes.extend(period.to_le_bytes());
        bytes.extend([strength.slow, strength.fast]);
        bytes.extend(offset.to_le_bytes());
    }
    let length = (bytes.len() + CHECKSUM) as u32;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    // The checksum covers the length, so the length is written first.
    bytes.extend(crc32(&bytes).to_le_bytes());
    bytes
}

/// Returns the quantity as a block stores it.
fn code(quantity: Quantity) -> htex_player::Quantity {
    match quantity {
        Quantity::LateralForce => htex_player::Quantity::LateralForce,
        Quantity::NormalForce => htex_player::Quantity::NormalForce,
        Quantity::Acceleration => htex_player::Quantity::Acceleration,
        Quantity::Velocity => htex_player::Quantity::Velocity,
        Quantity::Displacement => htex_player::Quantity::Displacement,
    }
}
