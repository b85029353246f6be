//! Plays baked textures on microcontrollers.
//!
//! [`Block::open`] validates the bytes that `htex bake` wrote (`spec/baked-1.md`), and [`Player`]
//! renders them. There is no heap and no panic. All samples are computed in single precision and in
//! one fixed order, so they are bit-identical on every processor.
//!
//! ```
//! use htex_player::{Block, OpenError};
//! assert!(matches!(Block::open(b"not a block"), Err(OpenError::TooShort)));
//! ```
//!
//! To give identical bits, the code fuses no operations, computes cosines, logarithms and powers
//! with polynomials, and takes the square root from `libm`.
//! `sdk/runtime/play/tests/it/bake_board.rs` compares the bits of an emulated Cortex-M4F with the
//! host's. `c/htex_player.c` is the same player in C, with the same bits (`tests/it/c.rs`).
#![no_std]
#![forbid(unsafe_code)]

mod block;
mod crc;
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
