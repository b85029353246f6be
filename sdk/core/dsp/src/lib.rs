//! Signal processing for texture models: windows, spectra, linear prediction, mel banks, peaks,
//! beta density, Butterworth filters, noise, oscillators, spectral shaping and resampling.
//!
//! This crate does not deal with assets or files. Without the `std` feature it is `no_std + alloc`,
//! and does not detect vector instructions at run time. Elementary functions come from `libm`, and
//! FFTs are plain arithmetic. So the same inputs give the same bits on every processor, in native
//! libraries and in WASM modules.
//!
//! Frequencies and sample rates are in hertz, angles in radians, magnitudes in the unit of the
//! signal, unless a name states another unit.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![deny(unsafe_code)] // Exception: two calls in `wide`.
#![cfg_attr(not(feature = "std"), no_std)]
extern crate alloc;
pub mod all_pole;
pub mod all_zero;
pub mod band_limit;
pub mod bands;
pub mod beta;
pub mod biquad;
mod butterflies;
pub mod butterworth;
mod chebyshev;
mod circle;
pub mod dct;
pub mod decibel_fit;
mod direct_form;
pub mod envelope;
pub mod estimation;
pub mod exponential;
pub mod fft;
pub mod fidelity;
pub mod fir;
pub mod fluctuation;
pub mod glide;
pub mod grid;
pub mod interpolated_peaks;
mod inverse_fft;
mod kernels;
mod lanes;
pub mod lattice;
pub mod least_squares;
pub mod line_spectrum;
pub mod linear_prediction;
pub mod mel;
pub mod nelder_mead;
pub mod noise;
pub mod non_negative;
pub mod normal;
pub mod order;
pub mod peaks;
pub mod pipeline;
mod polyphase;
pub mod quad;
pub mod random_envelope;
mod random_lanes;
pub mod reduced;
pub mod resample;
pub mod root;
pub mod seam;
pub mod shaped_noise;
pub mod shared;
pub mod sharpening;
pub mod sine_bank;
pub mod spectrum;
pub mod triangles;
pub mod trig;
pub mod uniform;
mod upsample;
pub mod vibrotactile;
pub mod warp;
mod wide;
pub mod window;

pub use grid::{Band, GRID_HZ};

/// The examples of the README, as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
