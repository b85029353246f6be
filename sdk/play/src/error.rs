//! Errors of opening and playing an asset.

/// An error of opening or playing an asset.
///
/// ```
/// use htex::{Asset, Error};
/// let error = Asset::from_bytes(b"not an asset").unwrap_err();
/// assert!(matches!(error, Error::Read(_)));
/// ```
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file is not a usable asset.
    #[error(transparent)]
    Read(#[from] htex_format::ReadError),
    /// A library or a texture of it cannot be read.
    #[cfg(feature = "library")]
    #[error(transparent)]
    Library(#[from] htex_library::LibraryError),
    /// A model is missing, or returned an error.
    #[error(transparent)]
    Model(#[from] htex_host::HostError),
    /// The asset has no representation of this model.
    #[error("the asset has no representation `{wanted}`; it has {there}")]
    NoRepresentation {
        wanted: String,
        /// The models of the asset's representations.
        there: String,
    },
    /// The asset embeds no model of this id.
    #[error(
        "the asset embeds no model `{id}`; its manifest lists the embedded models under `plugins`"
    )]
    NoEmbeddedModel { id: String },
    /// The only model that can play a representation is embedded in the asset, and embedded models
    /// are not allowed to run ([`crate::Asset::with_embedded`] allows it).
    #[error(
        "no model `{id}` is installed; the asset embeds it, but embedded models are not allowed to run: allow them, or \
         install the model"
    )]
    EmbeddedOff { id: String },
    /// The asset was fitted by another major version of the model.
    #[error(
        "the asset was fitted by {model} {asset}, and version {installed} is installed, which is \
         not compatible; install a {model} of the same major version"
    )]
    ModelVersion { model: String, asset: String, installed: String },
    /// The installed model is older than the one that fitted the asset, and lacks some of its
    /// fields.
    #[error(
        "version {installed} of {model} is installed, and the asset was fitted by {asset}: {problem}; install version {asset} or \
         newer of {model}{}", if *.embedded { ", or allow the model that the asset embeds" } else { "" }
    )]
    ModelOlder {
        model: Box<str>,
        /// The version that fitted the asset.
        asset: Box<str>,
        installed: Box<str>,
        /// Each field that differs, and its difference.
        problem: Box<str>,
        /// Whether the asset embeds a model of this id, which was not allowed to run.
        embedded: bool,
    },
    /// The stored fields differ from those of the model.
    #[error(
        "the parameters do not match the fields of {model}: {problem}; fit the recording again"
    )]
    Fields {
        model: String,
        /// Each field that differs, and its difference.
        problem: String,
    },
    /// The stored triangles are none to interpolate in, in an asset that was not read from a file.
    #[error("the triangles of {model} are invalid: {error}")]
    Triangles {
        model: String,
        #[source]
        error: htex_format::TrianglesError,
    },
    /// A speed or force is negative or not finite.
    #[error(
        "invalid motion: {speed_mm_s} mm/s at {force_n} N; both must be finite and not negative"
    )]
    Motion {
        /// Scanning speed, mm/s.
        speed_mm_s: f64,
        /// Normal force, newtons.
        force_n: f64,
    },
    /// The highest level of a voice is not above 0 or not finite.
    #[error(
        "invalid ceiling: {ceiling} times the strongest recorded level; it must be above 0 and finite"
    )]
    Ceiling {
        /// Multiple of the strongest recorded level.
        ceiling: f64,
    },
    /// A place is not finite.
    #[error("invalid place: x {x_mm} mm, y {y_mm} mm; both must be finite")]
    Place {
        /// Place on the surface, mm.
        x_mm: f64,
        /// Place on the surface across `x_mm`, mm.
        y_mm: f64,
    },
    /// A position is not finite.
    #[error("invalid position: {position_mm} mm along the path; it must be finite")]
    Position {
        /// Position along the path, mm.
        position_mm: f64,
    },
    /// The rate of a voice is not a rate, or too low for its texture.
    #[error(
        "a rate of {rate_hz} Hz: it must be from {least_hz} Hz, twice the highest frequency of the texture, to 10 MHz"
    )]
    Rate {
        /// The rate that was asked for, hertz.
        rate_hz: f64,
        /// The lowest rate, hertz.
        least_hz: f64,
    },
    /// A number of the options or of a call is out of its range.
    #[error("{name} {value}: {range}")]
    OutOfRange {
        /// What it is.
        name: &'static str,
        /// The number.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// An envelope was asked for another number of bands than the voice has.
    #[error(
        "{given} bands were asked for, and the voice has {there}; the options of the voice give their number"
    )]
    Bands {
        /// Places for bands.
        given: usize,
        /// Bands of the voice.
        there: usize,
    },
}
