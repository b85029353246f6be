//! Operations on the source under test that several checks share.

use std::time::Duration;

use crate::harness::Finding;
use htex_device::{Delivered, DeviceError, Settings, Source, SourceAdapter};

use crate::device::case::{CaseKind, skip_missing};

/// Maximum number of consecutive reads that may deliver nothing, each waiting [`PATIENCE`].
const EMPTY_READS: u32 = 5;
const PATIENCE: Duration = Duration::from_secs(1);

/// A loaded source and its settings.
pub(crate) type Case = crate::device::case::Case<dyn SourceAdapter>;

impl CaseKind for dyn SourceAdapter {
    type Files = ();

    fn files() -> Result<(), DeviceError> {
        Ok(())
    }
}

impl Case {
    /// Returns the given settings. A missing required setting becomes the first endpoint.
    pub(crate) fn settings(&self) -> Result<Settings, Finding> {
        self.filled(self.profile(), |s| self.first_endpoint(&s.name))
    }

    /// Opens a source. If the driver or the source is missing, the check is skipped.
    pub(crate) fn open(&self) -> Result<Box<dyn Source>, Finding> {
        self.adapter.open(&self.settings()?).map_err(skip_missing)
    }

    /// Opens a source and starts sampling.
    pub(crate) fn started(&self) -> Result<Box<dyn Source>, Finding> {
        let mut source = self.open()?;
        source.start()?;
        Ok(source)
    }
}

/// Reads `frames` frames in blocks of various sizes, or fewer if the source ends. Returns their
/// number.
pub(crate) fn read_all(source: &mut dyn Source, frames: usize) -> Result<usize, Finding> {
    let width = source.channels().len();
    let mut samples = vec![0.0; frames * width];
    let (mut read, mut empty) = (0, 0);
    while read < frames {
        let there = match source.read(&mut samples[read * width..], PATIENCE)? {
            Delivered::Frames(there) => there,
            Delivered::End => return Ok(read),
        };
        let Some(new) = samples.get(read * width..(read + there) * width) else {
            return Err(Finding::failed(format!(
                "it delivers {there} frames into space for {}",
                frames - read
            )));
        };
        if !new.iter().all(|sample| sample.is_finite()) {
            return Err(Finding::failed("a sample is not a finite number"));
        }
        empty = if there == 0 { empty + 1 } else { 0 };
        if empty == EMPTY_READS {
            let seconds = PATIENCE.as_secs() * u64::from(EMPTY_READS);
            return Err(Finding::failed(format!("it delivers nothing for {seconds} s")));
        }
        read += there;
    }
    Ok(read)
}

/// Checks that a call was refused as closed.
pub(crate) fn closed<T>(call: &str, answer: Result<T, DeviceError>) -> Result<(), Finding> {
    match answer {
        Err(DeviceError::Closed(_)) => Ok(()),
        Err(error) => Err(Finding::failed(format!("{call}: another error: {error}"))),
        Ok(_) => Err(Finding::failed(format!("{call} is not refused as closed"))),
    }
}
