//! Checks of the descriptor, of opening, and of settings.

use crate::harness::{Finding, Found};
use htex_device::{SourceDescriptor, SourceStream};

use crate::device::case::skip_missing;
use crate::device::checks::describe::{KEPT, described, refused};
use crate::device::source::case::Case;

/// Checks the descriptor of a built-in source. For a library, loading has already checked it.
pub(crate) fn descriptor(case: &Case) -> Found {
    let about = SourceDescriptor {
        descriptor: case.adapter.descriptor().clone(),
        target: case.adapter.target().to_owned(),
    };
    about.check()?;
    Ok(described(&about.descriptor))
}

/// Rate and channels must be valid and the same at each opening. For a library, they must also be
/// the same at each call.
pub(crate) fn opens(case: &Case) -> Found {
    let stream = || -> Result<SourceStream, Finding> {
        let source = case.open()?;
        Ok(SourceStream { rate_hz: source.rate_hz(), channels: source.channels().to_vec() })
    };
    let first = stream()?;
    first.check()?;
    let mut others = vec![stream()?];
    if let Ok(native) = case.native() {
        let source = native.open_native(&case.settings()?)?;
        others.push(source.stream_again()?);
        others.push(source.stream_again()?);
    }
    if let Some(other) = others.iter().find(|other| **other != first) {
        let message = format!("rate and channels change: {first:?}, then {other:?}");
        return Err(Finding::failed(message));
    }
    let (count, rate_hz) = (first.channels.len(), first.rate_hz);
    Ok(Finding::passed(format!("{count} channels at {rate_hz} Hz")).with("rate_hz", rate_hz))
}

/// Unusable settings must be refused.
pub(crate) fn bad_settings(case: &Case) -> Found {
    let native = case.native()?;
    let settings = case.settings()?;
    native.open_native(&settings).map_err(skip_missing)?;
    refused(case.adapter.descriptor(), &settings, |lines| native.refusal_of_lines(lines))
}

/// Unusable arrays must be refused, and no call may write beyond the arrays that it gets.
pub(crate) fn arrays(case: &Case) -> Found {
    let checked = case.native()?.check_source_arrays(&case.settings()?);
    checked.map_err(Finding::failed)?;
    Ok(Finding::passed(KEPT))
}
