//! Signals of files that are not assets.

use crate::error::{ExchangeError, Fault};
use crate::format::{Format, Reads, Sampling, Signal};
use crate::profile::Profile;

/// Sample rate of signals, hertz.
pub const RATE_HZ: f64 = 8_000.0;

/// Reads the signal of a file, or says what is wrong with the file.
pub(crate) fn signal(
    format: &'static Format,
    bytes: &[u8],
    sampling: Sampling,
    given: Option<&Profile>,
) -> Result<Result<Signal, Fault>, ExchangeError> {
    Ok(match format.reads {
        Some(Reads::Positions { read, profile }) => {
            let profile = given.map_or_else(|| Profile::find(profile), Ok)?;
            read(bytes, sampling, profile)
        }
        Some(Reads::Signal(read)) => read(bytes, sampling),
        Some(Reads::Asset(_) | Reads::Map) | None => {
            return Err(ExchangeError::Cannot {
                format: format.name,
                problem: "its files are no signals".to_owned(),
            });
        }
    })
}
