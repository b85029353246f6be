//! Plays the block at [`BLOCK`] with the same sequence of motions as the tests. The program prints
//! a hash of the samples and the number of instructions per sample.
//!
//! `docs/microcontroller.md` has the commands. `sdk/runtime/play/tests/it/bake_board.rs` compares
//! the hash with the hash that the host computes.
#![no_std]
#![no_main]

mod board;
#[path = "../../../tests/it/common/script.rs"]
mod script;

use core::fmt::Write;
use core::slice;

use board::{Console, Timer};
use htex_player::{Block, Player};

/// Address and size of the memory in which the block is.
const BLOCK: (usize, usize) = (0x0020_0000, 0x0010_0000);

/// A motion between conditions, mm/s and newtons.
const BETWEEN: (f32, f32) = (87.0, 0.43);
/// Number of samples whose instructions are counted.
const COUNTED: usize = 2000;

/// Runs after reset.
pub(crate) fn main() -> ! {
    // SAFETY: The board has memory there, and nothing writes to it.
    let bytes = unsafe { slice::from_raw_parts(BLOCK.0 as *const u8, BLOCK.1) };
    match Block::open(bytes) {
        Ok(block) => play(block),
        Err(error) => {
            let _ = writeln!(Console, "error: {error}");
        }
    }
    board::exit()
}

fn play(block: Block<'_>) {
    let mut player = Player::new(block, script::SEED);
    let _ = writeln!(Console, "hash {:08x}", script::hash(&mut player));
    let mut buffer = [0.0; 50];
    let timer = Timer::start();
    for _ in 0..COUNTED / buffer.len() {
        player.render(&mut buffer);
    }
    let steady = timer.instructions();
    let timer = Timer::start();
    player.set_motion(BETWEEN.0, BETWEEN.1);
    let set = timer.instructions();
    let timer = Timer::start();
    player.render(&mut buffer);
    let gliding = timer.instructions();
    let per = |instructions: u32, samples: usize| instructions / samples as u32;
    let _ = writeln!(Console, "instructions per sample {}", per(steady, COUNTED));
    let _ = writeln!(Console, "while gliding {}", per(gliding, buffer.len()));
    let _ = writeln!(Console, "to set a motion {set}");
    let _ = writeln!(Console, "bytes of a player {}", size_of::<Player<'_>>());
}
