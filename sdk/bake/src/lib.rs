//! Converts assets to blocks for players on microcontrollers (`spec/baked-1.md`, `htex_player`).
//!
//! ```no_run
//! use htex_bake::{Grid, bake};
//! let asset = htex_play::Asset::open("sandpaper.htex")?;
//! let baked = bake(&asset, None, &Grid::new(vec![40.0, 160.0], vec![0.4])?, 8_000.0, 0.3)?;
//! println!("{} bytes, within {:.2} dB", baked.bytes.len(), baked.between_db);
//! # Ok::<(), htex_bake::BakeError>(())
//! ```
//!
//! A block has filters for noise, not models: white noise through a symmetrical filter at a low
//! rate can have the spectrum of every noise model, is always stable, and a weighted sum of two
//! filters has the weighted sum of their magnitudes, so that the player needs no formula of a
//! model. As mixing is linear, the filters of all conditions are stored as few filters that
//! conditions mix: Bands on the grid of `tests/sizes.rs` takes 16 kB, where a filter in single
//! precision for each of its 60 conditions takes 77. A lattice would be cheaper for AR, but between
//! conditions it has other spectra than the model, which interpolates line spectral frequencies.
//! Conditions are inserted where the sum differs from the model by more than `--within`.
#![forbid(unsafe_code)]

mod bake;
mod compress;
mod encode;
mod error;
mod filter;
mod grid;
mod interpolator;
mod noise;
mod reading;
mod shape;
mod source;
mod texture;
mod tones;

pub use bake::{BakeLimits, Baked, bake};
pub use error::BakeError;
pub use grid::Grid;
pub use source::{c_header, c_name, is_c_name, is_rust_name, rust_name, rust_source};
