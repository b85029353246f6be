//! Errors from opening and playing an asset.

/// An error from opening or playing an asset.
///
/// ```
/// use htex::{Texture, Error};
/// let error = Texture::from_bytes(b"not an asset").unwrap_err();
/// assert!(matches!(error, Error::Read(_)));
/// ```
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file is not a usable asset.
    #[error(transparent)]
    Read(#[from] htex_format::ReadError),
    /// A library, or a texture in it, cannot be read.
    #[cfg(feature = "library")]
    #[error(transparent)]
    Library(#[from] htex_format::library::LibraryError),
    /// A model is missing, or returned an error.
    #[error(transparent)]
    Model(#[from] htex_host::HostError),
    /// The asset has no representation for this model.
    #[error("the asset has no representation `{wanted}`; it has {there}")]
    NoRepresentation {
        wanted: String,
        /// The models that the asset has representations for.
        there: String,
    },
    /// The asset embeds no model with this id.
    #[error(
        "the asset embeds no model `{id}`; its manifest lists the embedded models under `plugins`"
    )]
    NoEmbeddedModel { id: String },
    /// The only model that can play a representation is embedded in the asset, and embedded models
    /// may not run. [`crate::Texture::with_embedded`] allows them.
    #[error(
        "no model `{id}` is installed; the asset embeds it, but embedded models are not allowed to run: allow them, or \
         install the model"
    )]
    EmbeddedOff { id: String },
    /// The asset was fitted with another major version of the model.
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
        /// Each field that differs, and how.
        problem: Box<str>,
        /// Whether the asset embeds a model of this id, which was not allowed to run.
        embedded: bool,
    },
    /// The fields stored in the asset differ from the model's fields.
    #[error(
        "the parameters do not match the fields of {model}: {problem}; fit the recording again"
    )]
    Fields {
        model: String,
        /// Each field that differs, and how.
        problem: String,
    },
    /// The stored triangles cannot be used for interpolation. Only an asset that was not read from
    /// a file can have such triangles.
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
    /// The level ceiling of a voice is not positive or not finite.
    #[error(
        "invalid ceiling: {ceiling} times the strongest recorded level; it must be above 0 and finite"
    )]
    Ceiling {
        /// The ceiling, as a multiple of the strongest recorded level.
        ceiling: f64,
    },
    /// A coordinate of a place on the surface is not finite.
    #[error("invalid place: x {x_mm} mm, y {y_mm} mm; both must be finite")]
    Place {
        /// Coordinate x on the surface, mm.
        x_mm: f64,
        /// Coordinate y on the surface, at a right angle to `x_mm`, mm.
        y_mm: f64,
    },
    /// The position along the path is not finite.
    #[error("invalid position: {position_mm} mm along the path; it must be finite")]
    Position {
        /// Position along the path, mm.
        position_mm: f64,
    },
    /// The sample rate of a voice is invalid, or too low for its texture.
    #[error(
        "a rate of {rate_hz} Hz: it must be from {least_hz} Hz, twice the highest frequency of the texture, to 10 MHz"
    )]
    Rate {
        /// The requested rate, hertz.
        rate_hz: f64,
        /// The lowest rate, hertz.
        least_hz: f64,
    },
    /// A number in the options or in a call is out of range.
    #[error("{name} {value}: {range}")]
    OutOfRange {
        /// Name of the option or argument.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The allowed range.
        range: &'static str,
    },
    /// The buffer for an envelope has another number of bands than the voice.
    #[error(
        "{given} bands were asked for, and the voice has {there}; the options of the voice give their number"
    )]
    Bands {
        /// Length of the buffer.
        given: usize,
        /// Number of bands of the voice.
        there: usize,
    },
}
