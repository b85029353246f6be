//! Recordings in, fitted and measured texture assets out.
//!
//! The way of a recording: [`read::read_recording`], [`segment_spectra`],
//! [`TextureSpectrum::average`], [`fit_asset`]. Definitions follow the paper's Texture processing;
//! where it is silent, the option's own documentation says what is done.
#![forbid(unsafe_code)]

mod alternatives;
mod conditions;
mod error;
mod exploration;
pub mod findings;
mod fit;
mod hertz;
mod level;
mod metrics;
pub mod read;
mod reading;
pub mod recording;
mod rendered;
pub mod response;
mod segments;
pub mod simulate;
mod spectrum;
mod stored;
mod sums;
mod warnings;

pub use conditions::Take;
pub use error::AuthorError;
pub use exploration::{Exploration, Spread};
pub use findings::recording_findings;
pub use fit::{AssetRequest, FittedAsset, ModelRequest, fit_asset, measure};
pub use level::{Level, stored_level};
pub use metrics::{Agreement, agreement};
pub use reading::{Reading, read_take, validate_recording};
pub use recording::Recording;
pub use rendered::{rendered_spectrum, spectrum_of_samples};
pub use response::SetupResponse;
pub use segments::{SegmentChoice, Segments, Sweep, Unread, choose_segments, segment_len};
pub use spectrum::{
    Averaging, SegmentSpectra, SpectrumOptions, SpectrumRef, TextureSpectrum, segment_spectra,
};
pub use stored::stored_fields;
