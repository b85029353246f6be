//! Authoring: makes fitted and measured texture assets from recordings.
//!
//! [`fit_asset`] goes through four stages. Each stage is a function that takes the result of the
//! stage before it. Only the first stage reads a recording. The definitions follow the section
//! *Texture processing* of Balasubramanian & Vardar (2026), which is called "the paper" in this
//! documentation. If the paper leaves a choice open, the documentation of the corresponding option
//! states the choice made here.
//!
//! 1. `take` turns a [`Take`] into a [`SegmentedTake`] ([`segment_take`]). A sweep is a stretch in
//!    which the friction exceeds its mean. The module `segments` chooses segments of 0.2 s: either
//!    one in each complete sweep, or half-overlapping windows. `exploration` leaves out segments
//!    whose speed or force differs from the target, and measures the motion in the remaining
//!    segments. `spectrum` removes the mean of each segment, applies a Hann window and an FFT,
//!    combines two axes into one and divides by the setup's response. `findings` reports problems
//!    of the signals, with stable codes (`spec/recording-findings.md`). The options of the spectrum
//!    are settings of this stage.
//! 2. `conditions` turns the segmented takes into the spectrum of each condition. Recordings with
//!    the same speed and force are averaged to one condition ([`TextureSpectrum::average`]).
//!    `blocks` averages the odd and the even blocks of time separately, which gives two spectra
//!    that share no sample. `law` estimates how frequencies and level follow the motion, and
//!    `between` adds conditions that are computed by this law. The kind of average is a setting of
//!    this stage. For recordings of a free motion, `grid` replaces stages 1 and 2. `grid` defines a
//!    grid of speeds and forces. For each point of the grid, `grid` averages the windows in which
//!    the motion is steady and near that point.
//! 3. `fit` turns the conditions into the parameters of each model, rounded as the file stores
//!    them. `level` computes the level of the *rounded* parameters. From the rounded parameters,
//!    the models compute magnitudes and samples, and `measure` compares both with the recording. If
//!    the error in bands is large, `alternatives` tries other options and models, and lists the
//!    options and models with a smaller error. For a grid, the stage also measures held-out errors.
//!    It leaves out a block of time, and compares this block with the samples that a player makes
//!    from the other blocks. The models with their options, and the source of the level, are
//!    settings of this stage.
//! 4. `asset` puts the conditions, parameters, levels and measures together as a [`FittedAsset`].
//!    Name, licence, author and tags are settings of this stage.
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
mod coding;
mod compare;
mod conditions;
mod describe;
mod edit;
mod embed;
mod error;
mod exploration;
mod felt;
pub mod findings;
mod fit;
mod fluctuation;
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
mod texture_difference;
mod tilted;
pub mod tradeoff;

pub use asset::{FittedAsset, fit_asset, fit_asset_watched, new_asset};
pub use blocks::Repeatability;
pub use coding::Coding;
pub use compare::{ComparedModel, Difference, FeltDifference, compare};
pub use conditions::RecordingFinding;
pub use describe::{describe, played_model};
pub use edit::edit;
pub use embed::embed_plugins;
pub use error::{AuthorError, AuthorErrorKind};
pub use exploration::{Exploration, Spread};
pub use felt::{Felt, FeltError, FeltShare, REPEATABILITY_BOUND, felt, threshold_magnitude};
pub use findings::recording_findings;
pub use fit::{representation, stored_fields};
pub use fluctuation::{FluctuationDifference, SECOND_TAKES_DB, fluctuation};
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
pub use texture_difference::{DifferenceAt, EntryChange, ModelDifference, TextureDifference};
