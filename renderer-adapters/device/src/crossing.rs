//! Converts errors to the codes and texts of the ABI, and back.

use std::time::Duration;

use crate::abi::Code;
use crate::{DeviceError, LibraryFault};

/// Longest wait of one call, milliseconds: one day.
const MAX_WAIT_MS: u32 = 86_400_000;

/// Converts an error to its code and its last-error text.
pub(crate) fn outgoing(error: &DeviceError) -> (Code, String) {
    use DeviceError as E;
    // For errors that `incoming` rebuilds, only the part that the host does not know crosses the
    // ABI.
    let text = match error {
        E::Setting { name, what } => format!("{name}: {what}"),
        E::Underflow { advice, .. } | E::Overrun { advice, .. } => advice.clone(),
        E::File { path, what } => format!("{path}: {what}"),
        E::Failed { what, .. } => what.clone(),
        other => other.to_string(),
    };
    let code = match error {
        E::Setting { .. } => Code::InvalidSetting,
        E::Rate { .. } => Code::InvalidRate,
        E::Missing(_) => Code::Missing,
        E::Busy(_) => Code::Busy,
        E::OverLimit { .. } | E::DirectVoltage { .. } => Code::OverLimit,
        E::Underflow { .. } => Code::Underflow,
        E::Closed(_) => Code::Closed,
        E::File { .. } => Code::File,
        E::Overrun { .. } => Code::Overrun,
        E::Failed { .. }
        | E::Message(_)
        | E::Unknown { .. }
        | E::Direction { .. }
        | E::Invalid { .. }
        | E::Library { .. } => Code::Failed,
    };
    (code, text)
}

/// Converts a code and a text to an error. `OverLimit`, `Underflow`, `Overrun` and `End` become
/// failures here, because only the caller knows their details.
pub(crate) fn incoming(code: Code, text: String, device: &str, library: &str) -> DeviceError {
    match code {
        Code::InvalidSetting => {
            let (name, what) = parted(text);
            DeviceError::Setting { name, what }
        }
        Code::File => {
            let (path, what) = parted(text);
            DeviceError::File { path, what }
        }
        // The text is a complete sentence, which lists the supported rates.
        Code::InvalidRate => DeviceError::Message(text),
        Code::Missing => DeviceError::Missing(text),
        Code::Busy => DeviceError::Busy(text),
        Code::Closed | Code::BadHandle => DeviceError::Closed(device.to_owned()),
        Code::InvalidArgument => {
            let library = library.to_owned();
            DeviceError::Library { library, fault: LibraryFault::Answer, what: text }
        }
        _ => DeviceError::Failed { device: device.to_owned(), what: text },
    }
}

/// Converts a timeout to whole milliseconds, at most one day. A wait shorter than a millisecond
/// becomes one millisecond, so that it is still a wait.
pub(crate) fn wait_ms(timeout: Duration) -> u32 {
    let wait_ms = timeout.as_micros().div_ceil(1000);
    wait_ms.min(u128::from(MAX_WAIT_MS)) as u32
}

/// Splits a text at the first `: `.
fn parted(text: String) -> (String, String) {
    match text.split_once(": ") {
        Some((before, behind)) => (before.to_owned(), behind.to_owned()),
        None => (String::new(), text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_come_out_as_they_went_in() {
        let text = || "it is so".to_owned();
        let errors = [
            DeviceError::Setting { name: "limit_v".to_owned(), what: text() },
            DeviceError::Missing(text()),
            DeviceError::Busy(text()),
            DeviceError::Closed("Rig".to_owned()),
            DeviceError::File {
                path: "a/b.wav".to_owned(),
                what: "disk full: 3 bytes left".to_owned(),
            },
            DeviceError::Failed { device: "Rig".to_owned(), what: text() },
        ];
        for error in errors {
            let (code, text) = outgoing(&error);
            assert_eq!(Code::from_answer(code as i64), code);
            assert_eq!(incoming(code, text, "Rig", "rig.so"), error);
        }
    }
}
