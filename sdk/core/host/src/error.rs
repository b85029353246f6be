//! Errors of finding, loading and calling models.

use std::fmt::Display;

use htex_dsp::resample::UnusableRates;
use htex_model::Status;

/// Maximum number of bytes that a message contains of a model's text.
const LONGEST_SHOWN: usize = 4096;

/// Prepares a model's text for a message: escapes control characters, so that the text cannot
/// control a terminal, and shortens a long text.
pub(crate) fn plain(text: &str) -> String {
    let plain = htex_base::finding::plain(text);
    match plain.char_indices().find(|(at, _)| *at >= LONGEST_SHOWN) {
        None => plain.into_owned(),
        Some((at, _)) => format!("{}…", &plain[..at]),
    }
}

/// Error of finding, loading or calling a model.
///
/// ```
/// use htex_host::{HostError, Registry};
/// let error = Registry::builtin().find("wavelet").unwrap_err();
/// assert!(matches!(error, HostError::UnknownModel { .. }));
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HostError {
    /// The registry has no model of this name.
    #[error("no model `{wanted}`; there are {known}")]
    UnknownModel {
        /// The requested name, or the requested id and version.
        wanted: String,
        /// The names in the registry.
        known: String,
    },
    /// A module does not contain the model that its asset or recipe declares.
    #[error("{path} is declared as {declared} but contains {found}; get it again from its author")]
    OtherModel {
        /// The file, or the entry of an asset.
        path: String,
        /// Declared id and version.
        declared: String,
        /// Id and version of the model in the module.
        found: String,
    },
    /// A file cannot be loaded as a model.
    #[error("cannot load {path}: {what}")]
    Load { path: String, what: String },
    /// A library or module lacks one of the functions of the model ABI.
    #[error("cannot load {path}: it has no `{name}`; it is not an htex model")]
    NoFunction {
        /// The file, or the entry of an asset.
        path: String,
        name: String,
    },
    /// A file is not a WASM module, and it was not named by the user but, for example, by a recipe.
    #[error(
        "{path}: it is no WASM module; only the user may name a native library, because it runs with all of their rights: if you trust it, give it \
         yourself (`--plugin FILE`, `plugins` in Python)"
    )]
    NotModule { path: String },
    /// The model returned an error status.
    #[error("model {model}: {call}: {message}")]
    Call {
        model: String,
        call: &'static str,
        /// The status that the model returned.
        status: Status,
        /// The model's last-error text.
        message: String,
    },
    /// The model returned a value that the ABI does not allow.
    #[error("model {model}: {call} broke the model ABI: {what}; report this to the model's author")]
    Broken {
        /// The model's id, or its origin if the id is not known yet.
        model: String,
        call: &'static str,
        what: String,
    },
    /// The model has no fit option of this name.
    #[error("model {model}: option `{name}` is unknown; there are {known}")]
    UnknownOption {
        model: String,
        name: String,
        /// The names of the model's options.
        known: String,
    },
    /// The value of a fit option is neither one of its choices nor a number in its range.
    #[error("model {model}: option `{name}` is `{text}`; it takes {takes}")]
    OptionValue {
        model: String,
        name: Box<str>,
        text: Box<str>,
        /// The choices, or the kind of number, the range and the unit.
        takes: Box<str>,
    },
    /// The method of synthesis is unknown, or the length of the loop or the number of taps is out
    /// of range.
    #[error(
        "synthesis `{text}`: it takes streamed, loop:SECONDS (0.1 to 60, at most 67 million samples) \
         or filter:TAPS (15 to 4095)"
    )]
    Synthesis { text: String },
    /// The resampler cannot convert the model's sample rate to the requested rate.
    #[error(transparent)]
    Rates(#[from] UnusableRates),
}

impl HostError {
    /// Turns an error of loading a model into one that names the file, or the entry of an asset.
    pub(crate) fn loading<E: Display>(origin: impl Display) -> impl FnOnce(E) -> Self {
        move |error| Self::Load { path: origin.to_string(), what: error.to_string() }
    }
}
