//! Authoring: makes fitted and measured texture assets from recordings.
//!
//! [`fit_asset`] goes through four stages. Each is a function that gets what the one before it
//! returned; only the first reads a recording. The definitions follow the paper's section Texture
//! processing. Where the paper is silent, the documentation of the option says what is done.
//!
//! 1. `take`, a [`Take`] to a [`SegmentedTake`] ([`segment_take`]). `segments` chooses segments of
//!    0.2 s: one in each complete sweep (by mean threshold), or half-overlapping windows.
//!    `exploration` leaves out segments that are off their speed and force, and measures the motion
//!    in the others. `spectrum` removes the mean, applies a Hann window and an FFT, folds two axes
//!    into one and divides by the setup's response. `findings` reports problems of the signals,
//!    with stable codes (`spec/recording-findings.md`). It gets the options of the spectrum.
//! 2. `conditions`, the segmented takes to the spectrum of each condition. Recordings with the same
//!    speed and force are averaged ([`TextureSpectrum::average`]); others become further conditions.
//!    `blocks` separates odd from even blocks of time: two readings that share no sample. `law`
//!    estimates how frequencies and level follow the motion, and `between` adds conditions that the
//!    law computes. It gets the kind of average. For recordings of a free motion, `grid` replaces
//!    both stages: it reads windows of steady motion around the crossings of lines of speed and
//!    force.
//! 3. `fit`, the conditions to the parameters of each model. Parameters are rounded as the file
//!    stores them. The *rounded* parameters get a `level` and are measured by magnitude and by
//!    samples (`measure`). Where band errors are large, other options and models are tried and
//!    listed (`alternatives`). In a grid, each condition is also predicted from its neighbours, by
//!    the player's mesh. It gets the models with their options, and the source of the level.
//! 4. `asset`, all of this to a [`FittedAsset`]. It gets name, licence, author and tags.
//!
//! ```
//! use htex_author::simulate::{SimulationOptions, Surface, simulate};
//! use htex_author::{Averaging, SpectrumOptions, TextureSpectrum, segment_spectra};
//!
//! let simulation = simulate(&SimulationOptions::new(Surface::Vinyl))?;
//! let recording = simulation.to_recording("vinyl")?;
//! let segments = segment_spectra(&recording, &SpectrumOptions::default())?;
//! let texture = TextureSpectrum::average(&[segments], Averaging::Rms)?;
//! // Magnitudes from 20 to 1000 Hz in steps of 5 Hz, newtons.
//! assert_eq!(texture.magnitude.len(), 197);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod alternatives;
mod asset;
mod between;
mod blocks;
pub mod by_hand;
mod compare;
mod conditions;
mod edit;
mod embed;
mod error;
mod exploration;
mod felt;
pub mod findings;
mod fit;
pub mod grid;
mod law;
mod level;
mod measure;
mod odd_and_even;
mod recorded;
#[allow(clippy::disallowed_methods, reason = "digits of a picture reach no asset")]
pub mod report;
mod request;
mod segments;
pub mod settings;
pub mod simulate;
mod spectrum;
mod take;
pub mod tradeoff;

pub use asset::{FittedAsset, fit_asset, fit_asset_watched, new_asset};
pub use compare::{ComparedModel, Difference, FeltDifference, compare};
pub use conditions::RecordingFinding;
pub use edit::edit;
pub use embed::embed_plugins;
pub use error::{AuthorError, AuthorErrorKind};
pub use exploration::{Exploration, Spread};
pub use felt::{Felt, FeltError, FeltShare, felt, threshold_magnitude};
pub use findings::recording_findings;
pub use fit::{representation, stored_fields};
pub use grid::{CellStatus, Grid, GridCell, GridReport};
pub use htex_recording as recording;
pub use htex_recording::{Recording, SetupResponse, velocity};
pub use level::{Level, stored_level};
pub use measure::{Agreement, agreement, read_spectrum, spectrum_of_samples};
pub(crate) use odd_and_even::{OddAndEven, odd_and_even};
pub use recorded::RecordedLoop;
pub use request::{AssetRequest, ModelRequest};
pub(crate) use segments::segment_len;
pub use segments::{SegmentChoice, Segments, Sweep, Unread, choose_segments, sliding};
pub use spectrum::{
    Averaging, SegmentSpectra, SpectrumOptions, SpectrumRef, TextureSpectrum, segment_spectra,
};
pub use take::{SegmentedTake, Take, segment_take, validate_recording, validate_recording_bytes};
