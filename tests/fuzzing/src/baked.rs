//! Opens and plays a baked block as a microcontroller does.

use htex_player::{Block, Player, crc32};

/// Offset of the length in the header.
const LENGTH: usize = 8;

/// Opens the input after its first 17 bytes as a block, and plays it at two motions, which are the
/// 16 bytes before it. If the first byte is odd, the block first gets its correct length and
/// checksum.
pub fn baked_block(input: &[u8]) -> bool {
    let Some((&[mends, motions @ ..], block)) = input.split_first_chunk::<17>() else {
        return false;
    };
    let mut block = block.to_vec();
    if mends % 2 == 1 {
        mend(&mut block);
    }
    let Ok(opened) = Block::open(&block) else {
        return false;
    };
    let mut player = Player::new(opened, 1);
    let (numbers, _) = motions.as_chunks().0.as_chunks::<2>();
    for motion in numbers {
        let [speed, force] = motion.map(f32::from_le_bytes);
        let is_set = player.set_motion(speed, force);
        assert_eq!(is_set, speed.is_finite() && force.is_finite());
        let (mut samples, mut integers) = ([0.0; 201], [0; 67]);
        player.render(&mut samples);
        player.render_i16(&mut integers, speed);
        assert!(samples.iter().all(|x| x.is_finite()), "{samples:?}");
    }
    true
}

/// Writes the block's length, and its checksum over the last bytes.
fn mend(block: &mut [u8]) {
    let len = block.len() as u32;
    if let Some(field) = block.get_mut(LENGTH..LENGTH + 4) {
        field.copy_from_slice(&len.to_le_bytes());
    }
    if let Some((content, checksum)) = block.split_last_chunk_mut() {
        *checksum = crc32(content).to_le_bytes();
    }
}
