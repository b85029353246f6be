//! What can go wrong between a host and a model.

use htex_dsp::resample::UnusableRates;
use htex_model::Status;

/// Most bytes of a model's words that a message shows.
const LONGEST_SHOWN: usize = 4096;

/// The text as a message shows it: with its control characters written out, as a model's words must
/// not steer a terminal, and cut where they are too long to read.
pub(crate) fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len().min(LONGEST_SHOWN));
    for c in text.chars() {
        if plain.len() >= LONGEST_SHOWN {
            plain.push('…');
            break;
        }
        match c.is_control() {
            true => plain.extend(c.escape_default()),
            false => plain.push(c),
        }
    }
    plain
}

/// An error of one call, or of finding a model.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum HostError {
    /// No model of this name is known.
    #[error("no model `{wanted}`; there are {known}")]
    UnknownModel {
        /// What was asked for.
        wanted: String,
        /// What there is.
        known: String,
    },
    /// A module is of another model than it is declared to be.
    #[error("{path} is said to be {declared} and is {found}; get it again from its maker")]
    OtherModel {
        /// The file, or the entry of an asset.
        path: String,
        /// Id and version that are declared.
        declared: String,
        /// Id and version that it has.
        found: String,
    },
    /// A file is no model.
    #[error("cannot load {path}: {what}")]
    Load {
        /// The file.
        path: String,
        /// Why not.
        what: String,
    },
    /// The model answered with a status.
    #[error("model {model}: {call}: {message}")]
    Call {
        /// The model's id.
        model: String,
        /// The function that was called.
        call: &'static str,
        /// The status it answered.
        status: Status,
        /// Its last-error text.
        message: String,
    },
    /// The model answered something that no model may answer.
    #[error("model {model}: {call} broke the model ABI: {what}; report this to the model's author")]
    Broken {
        /// The model's id, or where it came from.
        model: String,
        /// The function that was called.
        call: &'static str,
        /// What was wrong.
        what: String,
    },
    /// A fit option that the model does not have, or a value it does not take.
    #[error("model {model}: option {what}")]
    Option {
        /// The model's id.
        model: String,
        /// Which option, and what is allowed.
        what: String,
    },
    /// No such way to make samples, or one out of its range.
    #[error(
        "synthesis `{text}`: it takes streamed, loop:SECONDS (0.1 to 60, at most 67 million samples) \
         or filter:TAPS (15 to 4095)"
    )]
    Synthesis {
        /// What was asked for.
        text: String,
    },
    /// The model's samples cannot be brought to the rate that is wanted.
    #[error("{what}")]
    Rates {
        /// The two rates, and which can be converted.
        what: String,
    },
}

impl From<UnusableRates> for HostError {
    fn from(rates: UnusableRates) -> Self {
        let what = rates.to_string();
        Self::Rates { what }
    }
}
