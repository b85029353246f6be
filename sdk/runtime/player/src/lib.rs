//! Plays baked textures on microcontrollers.
//!
//! [`Block::open`] validates the bytes that `htex bake` wrote (`spec/baked-1.md`), and [`Player`]
//! renders them. The code uses no heap and cannot panic. It computes all samples in single
//! precision and in one fixed order, so they are bit-identical on every processor.
//!
//! ```
//! use htex_player::{Block, OpenError};
//! assert!(matches!(Block::open(b"not a block"), Err(OpenError::TooShort)));
//! ```
//!
//! The bits are identical because the code follows three rules. No multiplication is fused with an
//! addition. Cosines, logarithms and powers are computed with polynomials. The square root is the
//! function of the crate `libm`. The test `sdk/runtime/play/tests/it/bake_board.rs` compares the
//! samples of an emulated Cortex-M4F with the host's samples. `c/htex_player.c` is the same player
//! in C and renders bit-identical samples (`tests/it/c.rs`).
#![no_std]
#![forbid(unsafe_code)]

mod block;
mod crc;
mod envelope;
mod law;
pub mod layout;
mod noise;
mod player;
mod power;
mod quantity;
mod random;
mod tones;
mod upsampler;
mod weights;
mod words;

pub use block::{Block, BlockKind, OpenError};
pub use crc::crc32;
pub use law::Law;
pub use player::Player;
pub use quantity::Quantity;
