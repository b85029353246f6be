//! Textures made without a recording: from parameters written by hand, or by mixing two textures.
//! The paper names both methods as uses of a representation with few numbers (Balasubramanian &
//! Vardar 2026, Discussion).
//!
//! Such an asset stores how it was made ([`htex_format::Made`]). It stores no measures of quality,
//! because there is no recording to compare the asset with.

mod mix;
mod parameters;

pub use mix::{MixedAsset, mix};
pub use parameters::{ByHand, ByHandAt, ByHandModel, ByHandModels, make, make_all};
