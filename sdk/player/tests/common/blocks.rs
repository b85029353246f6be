//! Small blocks, written from the specification.

use htex_player::crc32;

/// The numbers of a block.
#[derive(Clone)]
pub struct Plan {
    pub kind: u8,
    pub flags: u8,
    pub rate_hz: f32,
    pub up: u16,
    pub row: u16,
    pub size: u16,
    pub glide: u16,
    pub speeds: Vec<f32>,
    pub forces: Vec<f32>,
    pub rows: Vec<f32>,
    pub conditions: Vec<f32>,
}

/// Noise of level 1 and 2 with two different filters.
pub fn noise() -> Plan {
    let filter = |level: f32, decay: f32| {
        let side = (0..=8).map(move |i| 0.5 * decay.powi(i));
        std::iter::once(level).chain(side)
    };
    Plan {
        kind: 1,
        flags: 0,
        rate_hz: 8000.0,
        up: 2,
        row: 4,
        size: 8,
        glide: 20,
        speeds: vec![40.0, 80.0],
        forces: vec![0.4],
        rows: vec![0.0, 0.0, 1.0, 0.0, -0.1, 0.6, 0.6, -0.1],
        conditions: filter(1.0, 0.5).chain(filter(2.0, -0.7)).collect(),
    }
}

/// Two sinusoids of level 1 at both conditions, at 0.05 and 0.1, and at 0.1 and 0.2 cycles per sample.
pub fn tones() -> Plan {
    Plan {
        kind: 2,
        flags: 0,
        up: 1,
        row: 0,
        size: 2,
        rows: vec![],
        conditions: vec![1.0, 0.05, 1.0, 0.1, 0.5, 1.0, 0.1, 1.0, 0.2, 0.5],
        ..noise()
    }
}

impl Plan {
    pub fn bytes(&self) -> Vec<u8> {
        let parts = [&self.speeds, &self.forces, &self.rows, &self.conditions];
        let numbers: Vec<u8> = parts
            .into_iter()
            .flatten()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        let mut bytes = b"HTXB\x01\x00".to_vec();
        bytes.extend([self.kind, self.flags]);
        bytes.extend((32 + numbers.len() as u32 + 4).to_le_bytes());
        bytes.extend(self.rate_hz.to_le_bytes());
        for number in [self.up, self.row, self.size, self.glide] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([self.speeds.len() as u8, self.forces.len() as u8]);
        bytes.extend([0; 6]);
        bytes.extend(numbers);
        with_checksum(bytes)
    }
}

/// The bytes followed by their checksum.
pub fn with_checksum(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.extend(crc32(&bytes).to_le_bytes());
    bytes
}
