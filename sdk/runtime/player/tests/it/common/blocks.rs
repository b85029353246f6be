//! Small blocks, written from the specification.

use htex_player::crc32;

/// The content of a block, from which its bytes are made.
#[derive(Clone)]
pub struct Plan {
    pub kind: u8,
    pub flags: u8,
    pub rate_hz: f32,
    pub up: u16,
    pub row: u16,
    pub size: u16,
    pub glide: u16,
    pub filters: u8,
    pub quantity: u8,
    /// The exponents a, b and c.
    pub law: [f32; 3],
    pub ceiling: f32,
    pub full_scale: f32,
    pub highest: f32,
    pub speeds: Vec<f32>,
    pub forces: Vec<f32>,
    pub rows: Vec<f32>,
    pub levels: Vec<f32>,
    /// Scales of filters, or frequencies and amplitudes.
    pub numbers: Vec<f32>,
    /// Weights and filters.
    pub integers: Vec<i16>,
    /// Samples between values, the two strengths, and the offset; written if the flags say so.
    pub fluctuation: (u16, [u8; 2], f32),
}

/// Noise with levels 1 and 2, and with two different filters.
pub fn noise() -> Plan {
    let next = |decay: f32| move |c: &f32| Some(c * decay);
    let filter =
        |decay: f32| std::iter::successors(Some(32_000.0), next(decay)).take(9).map(|c| c as i16);
    let weights = [30_000, 0, -2_000, 32_767];
    Plan {
        kind: 1,
        flags: 0,
        rate_hz: 8000.0,
        up: 2,
        row: 4,
        size: 8,
        glide: 20,
        filters: 2,
        quantity: 1,
        law: [1.0, 0.5, 0.75],
        ceiling: 8.0,
        full_scale: 10.0,
        highest: 0.4,
        speeds: vec![40.0, 80.0],
        forces: vec![0.4],
        rows: vec![0.0, 0.0, 1.0, 0.0, -0.1, 0.6, 0.6, -0.1],
        levels: vec![1.0, 2.0],
        numbers: vec![5e-10, 5e-10],
        integers: weights.into_iter().chain(filter(0.5)).chain(filter(-0.7)).collect(),
        fluctuation: (16, [112, 71], -0.4),
    }
}

/// Two sinusoids with level 1 at both conditions: at 0.05 and 0.1, and at 0.1 and 0.2 cycles per
/// sample.
pub fn tones() -> Plan {
    Plan {
        kind: 2,
        flags: 0,
        up: 1,
        row: 0,
        size: 2,
        filters: 0,
        quantity: 3,
        rows: vec![],
        levels: vec![1.0, 1.0],
        numbers: vec![0.05, 1.0, 0.1, 0.5, 0.1, 1.0, 0.2, 0.5],
        integers: vec![],
        ..noise()
    }
}

impl Plan {
    /// The block without its checksum.
    pub fn content(&self) -> Vec<u8> {
        let parts = [&self.speeds, &self.forces, &self.rows, &self.levels, &self.numbers];
        let numbers = parts.into_iter().flatten().flat_map(|x| x.to_le_bytes());
        let integers = self.integers.iter().flat_map(|x| x.to_le_bytes());
        let mut numbers: Vec<u8> = numbers.chain(integers).collect();
        numbers.resize(numbers.len().next_multiple_of(4), 0);
        if self.flags & 2 != 0 {
            let (period, strength, offset) = self.fluctuation;
            numbers.extend(period.to_le_bytes());
            numbers.extend(strength);
            numbers.extend(offset.to_le_bytes());
        }
        let mut bytes = b"HTXB\x01\x00".to_vec();
        bytes.extend([self.kind, self.flags]);
        bytes.extend((52 + numbers.len() as u32 + 4).to_le_bytes());
        bytes.extend(self.rate_hz.to_le_bytes());
        for number in [self.up, self.row, self.size, self.glide] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([self.speeds.len() as u8, self.forces.len() as u8]);
        bytes.extend([self.filters, self.quantity]);
        let [a, b, c] = self.law;
        for number in [a, b, c, self.ceiling, self.full_scale, self.highest] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(numbers);
        bytes
    }

    pub fn bytes(&self) -> Vec<u8> {
        with_checksum(self.content())
    }
}

/// The bytes followed by their checksum.
pub fn with_checksum(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.extend(crc32(&bytes).to_le_bytes());
    bytes
}
