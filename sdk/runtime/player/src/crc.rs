//! The checksum of a block.

/// Returns the CRC-32 of bytes (polynomial `0xEDB88320`, as in ZIP and PNG).
///
/// ```
/// assert_eq!(htex_player::crc32(b"123456789"), 0xCBF4_3926);
/// ```
pub fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        // Half a byte at a time: the table has 64 bytes instead of 1 kB, for microcontrollers.
        crc = nibble(crc ^ u32::from(*byte));
        crc = nibble(crc);
    }
    !crc
}

/// Performs four bits of the polynomial division.
fn nibble(crc: u32) -> u32 {
    // The index has four bits, and the table has 16 entries.
    TABLE[(crc & 15) as usize] ^ (crc >> 4)
}

const TABLE: [u32; 16] = {
    let mut table = [0; 16];
    let mut i = 0;
    while i < 16 {
        let mut crc = i as u32;
        let mut bit = 0;
        while bit < 4 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 };
            bit += 1;
        }
        table[i] = crc;
        i += 1;
    }
    table
};
