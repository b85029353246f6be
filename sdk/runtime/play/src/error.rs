//! Errors from opening, playing and baking a texture.

use htex_format::ReadError;
use htex_host::HostError;

/// An error from opening, playing or baking a texture. [`Self::kind`] returns the kind of the
/// error, without details.
///
/// ```
/// use htex::Texture;
/// use htex::play::ErrorKind;
/// let error = Texture::from_bytes(b"not an asset").unwrap_err();
/// assert_eq!(error.kind(), ErrorKind::InvalidAsset);
/// ```
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file is not a usable asset.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A library, or a texture in it, cannot be read.
    #[cfg(feature = "library")]
    #[error(transparent)]
    Library(#[from] htex_format::library::LibraryError),
    /// A model is missing, or returned an error.
    #[error(transparent)]
    Model(#[from] HostError),
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
    /// Only the model that is embedded in the asset can play the representation, and the program
    /// has not allowed embedded models. [`crate::Texture::with_embedded`] allows them.
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
    /// The installed version of the model is older than the version that fitted the asset, and
    /// lacks some of the asset's fields.
    #[error(
        "version {installed} of {model} is installed, and the asset was fitted by {asset}: {problem}; install version {asset} or \
         newer of {model}{}", if *.embedded { ", or allow the model that the asset embeds" } else { "" }
    )]
    ModelOlder {
        model: Box<str>,
        /// The version that fitted the asset.
        asset: Box<str>,
        installed: Box<str>,
        /// A list of the fields that differ, and how they differ.
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
        /// A list of the fields that differ, and how they differ.
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
    /// The sample rate of a voice is invalid, or too low for the voice's texture.
    #[error(
        "a rate of {rate_hz} Hz: it must be from {least_hz} Hz, twice the highest frequency of the texture, to 10 MHz"
    )]
    Rate {
        /// The requested rate, hertz.
        rate_hz: f64,
        /// The lowest rate, hertz.
        least_hz: f64,
    },
    /// A number in the options, or an argument of a call, is out of range.
    #[error("{name} {value}: {range}")]
    OutOfRange {
        /// Name of the option or argument.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The allowed range.
        range: &'static str,
    },
    /// The buffer for an envelope has a different number of bands than the voice.
    #[error(
        "{given} bands were asked for, and the voice has {there}; the options of the voice give their number"
    )]
    Bands {
        /// Length of the buffer.
        given: usize,
        /// Number of bands of the voice.
        there: usize,
    },
    /// An axis of the grid of a baked block is invalid.
    #[cfg(feature = "bake")]
    #[error(
        "{axis} of the grid: {values:?}; they are 1 to {most} different numbers, each from {least} to {largest}"
    )]
    Axis { axis: &'static str, values: Vec<f64>, most: usize, least: f64, largest: f64 },
    /// The conditions to bake do not form a grid: at least one combination of their speeds and
    /// forces is missing.
    #[cfg(feature = "bake")]
    #[error(
        "no condition at {speed_mm_s} mm/s and {force_n} N: the conditions are all combinations of their speeds and \
         forces; add it, or give a grid"
    )]
    Incomplete {
        /// The speed of the missing condition.
        speed_mm_s: f64,
        /// The force of the missing condition.
        force_n: f64,
    },
    /// The rate of a baked block is out of range.
    #[cfg(feature = "bake")]
    #[error(
        "{rate_hz} Hz: the rate is from {least_hz} to {most_hz} Hz for frequencies up to {top_hz} Hz"
    )]
    BakeRate {
        rate_hz: f64,
        least_hz: f64,
        most_hz: f64,
        /// The highest frequency of the texture.
        top_hz: f64,
    },
    /// The model computes its samples from the position of the finger (`htex.motion/1`). A baked
    /// block cannot do this.
    #[cfg(feature = "bake")]
    #[error(
        "the model {model} plays from the position of the finger, which a baked block cannot do; bake another representation"
    )]
    FollowsMotion { model: String },
    /// A baked block has too many sinusoids.
    #[cfg(feature = "bake")]
    #[error(
        "the conditions have {count} sinusoids together, and a block at most {most}; bake fewer conditions"
    )]
    Tones { count: usize, most: usize },
    /// The representation has no energy at a condition to bake.
    #[cfg(feature = "bake")]
    #[error("the texture is silent at {speed_mm_s} mm/s and {force_n} N; bake other conditions")]
    Silent { speed_mm_s: f64, force_n: f64 },
    /// The level cannot be stored in a baked block.
    #[cfg(feature = "bake")]
    #[error(
        "the level at {speed_mm_s} mm/s and {force_n} N is {level}; a block stores at most {most}"
    )]
    Level {
        speed_mm_s: f64,
        force_n: f64,
        /// The level, in the asset's unit.
        level: f64,
        most: f64,
    },
    /// The player refuses the baked block.
    #[cfg(feature = "bake")]
    #[error("the player refuses the block: {0}")]
    Refused(#[from] htex_player::OpenError),
}

/// The kind of an [`Error`], without details. [`Error::kind`] returns it.
///
/// ```
/// use htex::Texture;
/// use htex::play::ErrorKind;
/// let error = Texture::open("no such file.htex").unwrap_err();
/// assert_eq!(error.kind(), ErrorKind::Io);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file cannot be read.
    Io,
    /// The file is not a valid asset.
    InvalidAsset,
    /// None of the accepted keys signed the file.
    Signature,
    /// The library is invalid, or has no texture with this name.
    Library,
    /// The texture has no representation for this model.
    NoRepresentation,
    /// A model is missing, incompatible or not allowed to run.
    NoModel,
    /// A model failed.
    Model,
    /// A speed, force, position or place is out of range.
    Motion,
    /// An option or an argument is out of range.
    Option,
    /// The representation cannot be baked.
    Bake,
}

impl Error {
    /// Returns the kind of the error, for programs that react to it.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Read(ReadError::Io { .. }) => ErrorKind::Io,
            Self::Read(ReadError::Signature(_)) => ErrorKind::Signature,
            Self::Read(_) => ErrorKind::InvalidAsset,
            #[cfg(feature = "library")]
            Self::Library(htex_format::library::LibraryError::Signature(_)) => ErrorKind::Signature,
            #[cfg(feature = "library")]
            Self::Library(_) => ErrorKind::Library,
            Self::NoRepresentation { .. } => ErrorKind::NoRepresentation,
            Self::Model(
                HostError::UnknownOption { .. }
                | HostError::OptionValue { .. }
                | HostError::Synthesis { .. }
                | HostError::Rates { .. },
            ) => ErrorKind::Option,
            Self::Model(HostError::Call { .. } | HostError::Broken { .. }) => ErrorKind::Model,
            Self::Model(_)
            | Self::NoEmbeddedModel { .. }
            | Self::EmbeddedOff { .. }
            | Self::ModelVersion { .. }
            | Self::ModelOlder { .. }
            | Self::Fields { .. }
            | Self::Triangles { .. } => ErrorKind::NoModel,
            Self::Motion { .. } | Self::Position { .. } | Self::Place { .. } => ErrorKind::Motion,
            Self::Ceiling { .. }
            | Self::Rate { .. }
            | Self::OutOfRange { .. }
            | Self::Bands { .. } => ErrorKind::Option,
            #[cfg(feature = "bake")]
            Self::Axis { .. }
            | Self::Incomplete { .. }
            | Self::BakeRate { .. }
            | Self::FollowsMotion { .. }
            | Self::Tones { .. }
            | Self::Silent { .. }
            | Self::Level { .. }
            | Self::Refused(_) => ErrorKind::Bake,
        }
    }
}
