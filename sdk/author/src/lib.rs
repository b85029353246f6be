//! Authoring: makes fitted and measured texture assets from recordings.
//!
//! The pipeline is [`recording::read_recording`], [`segment_spectra`],
//! [`TextureSpectrum::average`], [`fit_asset`]. Definitions follow the paper's section Texture
//! processing. Where the paper is silent, the documentation of the option says what is done.
//!
//! From a recording to an asset:
//!
//! 1. `segments` finds segments of 0.2 s: one in each complete sweep (by mean threshold), or
//!    half-overlapping windows. `findings` reports problems of the signals, with stable codes
//!    (`spec/recording-findings.md`). `reading` combines both.
//! 2. `spectrum` removes the mean, applies a Hann window and an FFT, folds two axes into one,
//!    divides by the setup's response and averages. `blocks` separates odd from even blocks of
//!    time: two readings that share no sample.
//! 3. `conditions` averages recordings with the same speed and force; others become further
//!    conditions. `grid`, on request, takes many conditions from a free motion: windows of `steady`
//!    motion, `lines` of speed and force, `cells` around their crossings, and spectra over equal
//!    `paths`, corrected by `slopes`.
//! 4. `fit` fits each model at each condition. Parameters are rounded as the file stores them. The
//!    *rounded* parameters get a `level` and are measured, by magnitude (`metrics`) and by samples
//!    (`rendered`). Where band errors are large, other options and models are tried and listed
//!    (`alternatives`). In a grid, each condition is also predicted from its neighbours, by the
//!    player's mesh.
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
mod averaging;
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
mod metrics;
mod odd_and_even;
mod reading;
mod recorded;
mod recording_finding;
mod rendered;
#[allow(clippy::disallowed_methods, reason = "digits of a picture reach no asset")]
pub mod report;
mod request;
mod segments;
pub mod settings;
pub mod simulate;
mod spectrum;
mod stored;
mod take;
pub mod tradeoff;
mod warnings;

pub use averaging::Averaging;
pub use compare::{CompareError, ComparedModel, Difference, FeltDifference, compare};
pub use edit::{EditError, edit};
pub use embed::{EmbedError, embed_plugins};
pub use error::AuthorError;
pub use exploration::{Exploration, Spread};
pub use felt::{DIFFERENCE_THRESHOLD_DB, Felt, FeltError, FeltShare, felt, threshold_magnitude};
pub use findings::recording_findings;
pub use fit::{FittedAsset, fit_asset, fit_asset_watched, measure};
pub use grid::{CellStatus, Grid, GridCell, GridReport};
pub use htex_recording as recording;
pub use htex_recording::{Recording, SetupResponse, velocity};
pub use level::{Level, stored_level};
pub use metrics::{Agreement, agreement};
pub use odd_and_even::{OddAndEven, odd_and_even};
pub use reading::{Reading, read_take, validate_recording, validate_recording_bytes};
pub use recorded::RecordedLoop;
pub use recording_finding::RecordingFinding;
pub use rendered::{read_spectrum, rendered_spectrum, spectrum_of_samples};
pub use request::{AssetRequest, ModelRequest};
pub use segments::{SegmentChoice, Segments, Sweep, Unread, choose_segments, segment_len, sliding};
pub use spectrum::{
    SegmentSpectra, SpectrumOptions, SpectrumRef, TextureSpectrum, segment_spectra,
};
pub use stored::stored_fields;
pub use take::Take;
