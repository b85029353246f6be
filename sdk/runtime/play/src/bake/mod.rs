//! Converts assets to blocks for players on microcontrollers (`spec/baked-1.md`, `htex_player`).
//!
//! ```no_run
//! use htex_play::bake::{Grid, bake};
//! let texture = htex_play::Texture::open("sandpaper.htex")?;
//! let grid = Grid::new(vec![40.0, 160.0], vec![0.4])?;
//! let baked = bake(texture.representation("bands")?, &grid, 8_000.0, 0.3)?;
//! println!("{} bytes, within {:.2} dB", baked.bytes.len(), baked.between_db);
//! # Ok::<(), htex_play::Error>(())
//! ```
//!
//! A block for noise contains filters instead of a model. White noise that passes through a
//! symmetrical filter at a low rate can have the spectrum of any noise model. Such a filter is
//! always stable. The response of a weighted sum of two filters is the weighted sum of their
//! responses, so the player does not need the formula of any model.
//!
//! Because mixing is linear, a block stores only a few filters, and each condition mixes them. For
//! example, a block of the model `bands` with the 60 conditions of `tests/it/bake_sizes.rs` takes
//! 16 kB. The block would take 77 kB if it stored a separate filter in single precision for each
//! condition. For the AR model, a lattice filter would need less computation. But between
//! conditions, the spectra of a lattice filter would differ from the model's spectra, because the
//! AR model interpolates line spectral frequencies. Where the mixed filters differ from the model
//! by more than the limit in [`BakeLimits`], the conversion inserts further conditions.
#![forbid(unsafe_code)]

mod compress;
mod design;
mod encode;
mod filter;
mod fluctuation;
mod grid;
mod interpolator;
mod moments;
mod noise;
mod reading;
mod shape;
mod source;
mod tones;

pub use design::{BakeLimits, BakeResult, bake};
pub use grid::Grid;
pub use source::{c_header, c_name, is_c_name, is_rust_name, rust_name, rust_source};
