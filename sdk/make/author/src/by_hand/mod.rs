//! Textures made without a recording: from parameters written by hand, or by mixing two textures.
//! The paper names both methods as possible uses of a representation that consists of few numbers
//! (Balasubramanian & Vardar 2026, Discussion).
//!
//! An asset of such a texture stores how the texture was made ([`htex_format::Made`]). The asset
//! stores no measures of quality, because there is no recording with which to compare the texture.

mod mix;
mod parameters;

pub use mix::{MixedAsset, mix};
pub use parameters::{ByHand, ByHandAt, ByHandModel, ByHandModels, make, make_all};
