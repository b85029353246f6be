//! Errors of opening and playing an asset.

/// An error of opening or playing an asset.
///
/// ```
/// use htex::{Asset, Error};
/// let error = Asset::from_bytes(b"not an asset").unwrap_err();
/// assert!(matches!(error, Error::Read(_)));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file is not a usable asset.
    #[error(transparent)]
    Read(#[from] htex_format::ReadError),
    /// A model is missing, or refused a call.
    #[error(transparent)]
    Model(#[from] htex_host::HostError),
    /// The asset has no representation of this model.
    #[error("the asset has no representation `{wanted}`; it has {there}")]
    NoRepresentation {
        /// What was asked for.
        wanted: String,
        /// What there is.
        there: String,
    },
    /// The asset brings along no model of this id.
    #[error(
        "the asset brings along no model `{id}`; its manifest lists those it brings under `plugins`"
    )]
    NoEmbeddedModel {
        /// What was asked for.
        id: String,
    },
    /// The asset brings along the only model that could play a representation, and such models are not run
    /// ([`crate::Asset::with_embedded`] runs them).
    #[error(
        "no model `{id}` is installed; the asset brings it along, and models of assets are not run here: allow them, \
         or install the model"
    )]
    EmbeddedOff {
        /// The model's id.
        id: String,
    },
    /// The asset was made by a model of another major version.
    #[error(
        "the asset was fitted by {model} {asset}, and version {installed} is installed, which is \
         not compatible; install a {model} of the same major version"
    )]
    ModelVersion {
        /// The model's id.
        model: String,
        /// The version in the asset.
        asset: String,
        /// The version of the model.
        installed: String,
    },
    /// The stored fields are not those of the model.
    #[error("the parameters do not suit {model}: {problem}; fit the recording again")]
    Fields {
        /// The model's id.
        model: String,
        /// Every field that differs, and how.
        problem: String,
    },
    /// A speed or force that is negative or not a number.
    #[error("motion of {speed_mm_s} mm/s at {force_n} N; both must be finite and not negative")]
    Motion {
        /// Scanning speed, mm/s.
        speed_mm_s: f64,
        /// Normal force, newtons.
        force_n: f64,
    },
    /// A position that is not a finite number.
    #[error("position of {position_mm} mm along the path; it must be finite")]
    Position {
        /// Position along the path, mm.
        position_mm: f64,
    },
}
