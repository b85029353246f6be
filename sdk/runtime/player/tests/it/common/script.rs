//! A script of motions that a player runs on the host and on a board, and a hash of its samples.

use htex_player::Player;

pub const SEED: u32 = 7;
/// Motions (mm/s and newtons) within and beyond the conditions, and of a finger at rest.
const MOTIONS: [(f32, f32); 6] =
    [(80.0, 0.4), (55.5, 0.25), (0.0, 0.0), (101.25, 0.5), (1e6, 100.0), (-60.0, 0.3)];
/// Lengths of the buffers.
const LENGTHS: [usize; 4] = [64, 1, 33, 200];

/// Renders every motion to buffers of several lengths. Returns the FNV-1a hash of the samples'
/// bits.
pub fn hash(player: &mut Player<'_>) -> u32 {
    let mut hash = 0x811C_9DC5u32;
    let mut add = |bits: u32| {
        for byte in bits.to_le_bytes() {
            hash = (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
    };
    let mut buffer = [0.0f32; 200];
    let mut integers = [0i16; 40];
    for (speed, force) in MOTIONS {
        player.set_motion(speed, force);
        for length in LENGTHS {
            let part = &mut buffer[..length];
            player.render(part);
            part.iter().for_each(|x| add(x.to_bits()));
        }
        player.render_i16(&mut integers, 0.5);
        integers.iter().for_each(|x| add(*x as u16 as u32));
    }
    hash
}
