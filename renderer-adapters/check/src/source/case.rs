//! The source under test, and operations that several checks use.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use htex_check_runner::Finding;
use htex_device::{Delivered, DeviceError, NativeSourceAdapter, Settings, Source, SourceAdapter};

use crate::case::{filled, first};
use crate::source::Subject;

/// Most consecutive reads that may deliver nothing, each waiting [`PATIENCE`].
const EMPTY_READS: u32 = 5;
const PATIENCE: Duration = Duration::from_secs(1);

/// A loaded source, and its settings.
pub struct Case {
    pub(crate) adapter: Arc<dyn SourceAdapter>,
    /// The same adapter, if it is a native library.
    pub(crate) native: Option<NativeSourceAdapter>,
    profile: Option<String>,
    given: BTreeMap<String, String>,
}

impl Case {
    pub(crate) fn load(
        subject: &Subject,
        profile: Option<&str>,
        given: &BTreeMap<String, String>,
    ) -> Result<Self, DeviceError> {
        let (adapter, native): (Arc<dyn SourceAdapter>, _) = match subject {
            Subject::Builtin(adapter) => (adapter.clone(), None),
            Subject::Library(path) => {
                let native = NativeSourceAdapter::load(path)?;
                (Arc::new(native.clone()), Some(native))
            }
        };
        Ok(Self {
            adapter,
            native,
            profile: profile.map(str::to_owned),
            given: given.clone(),
        })
    }

    /// The given settings; required ones that are missing are the first endpoint.
    pub(crate) fn settings(&self) -> Result<Settings, Finding> {
        let profile = self.profile.as_deref();
        filled(self.adapter.descriptor(), profile, &self.given, |setting| {
            first(self.adapter.endpoints(), &setting.name)
        })
    }

    /// An open source; the check is skipped where the driver or the source is missing.
    pub(crate) fn open(&self) -> Result<Box<dyn Source>, Finding> {
        self.adapter.open(&self.settings()?).map_err(skip_missing)
    }

    /// An open source that samples.
    pub(crate) fn started(&self) -> Result<Box<dyn Source>, Finding> {
        let mut source = self.open()?;
        source.start()?;
        Ok(source)
    }
}

/// A finding, or none where nothing is connected.
pub(crate) fn skip_missing(error: DeviceError) -> Finding {
    match error {
        DeviceError::Missing(what) => Finding::skipped(what),
        error => error.into(),
    }
}

/// Reads `frames` frames in blocks of any size, or fewer if the source ends; returns their number.
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
            return Err(Finding::failed(format!(
                "it delivers nothing for {seconds} s"
            )));
        }
        read += there;
    }
    Ok(read)
}

/// A call that must be refused as closed.
pub(crate) fn closed<T>(call: &str, answer: Result<T, DeviceError>) -> Result<(), Finding> {
    match answer {
        Err(DeviceError::Closed(_)) => Ok(()),
        Err(error) => Err(Finding::failed(format!("{call}: another error: {error}"))),
        Ok(_) => Err(Finding::failed(format!("{call} is not refused as closed"))),
    }
}
