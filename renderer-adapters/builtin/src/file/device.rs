//! The open file device.

use std::time::Duration;

use htex_base::files::FileInProgress;
use htex_device::{Capabilities, DeviceError, Output, Status};

use crate::file::plan::Plan;
use crate::file::sink::Sink;

/// A file that is being written.
pub(crate) struct FileDevice {
    capabilities: Capabilities,
    path: String,
    /// `None` once the device is finished or failed.
    open: Option<(Sink, FileInProgress)>,
    frames: u64,
    peak: f32,
}

impl FileDevice {
    #[allow(
        clippy::disallowed_methods,
        reason = "the user named this file, or its caller checked its folder"
    )]
    pub(crate) fn create(plan: &Plan, rate_hz: f64) -> Result<Self, DeviceError> {
        plan.check_rate(rate_hz)?;
        let path = plan.path.display().to_string();
        let created = FileInProgress::create(&plan.path).and_then(|mut file| {
            // The writer has its own file handle. `FileInProgress` keeps another handle until it
            // renames the file.
            let writer = file.file().try_clone()?;
            Ok((Sink::new(writer, plan, rate_hz)?, file))
        });
        let open = created.map_err(|error| file_error(&path, &error))?;
        Ok(Self { capabilities: plan.capabilities(), path, open: Some(open), frames: 0, peak: 0.0 })
    }

    /// Removes the temporary file, so that no file is left after an error.
    fn abort(&mut self, error: DeviceError) -> DeviceError {
        self.open = None;
        error
    }

    fn closed(&self) -> DeviceError {
        DeviceError::Closed(self.path.clone())
    }
}

impl Output for FileDevice {
    fn write(&mut self, samples: &[f32], _timeout: Duration) -> Result<usize, DeviceError> {
        let Some((sink, _)) = &mut self.open else {
            return Err(self.closed());
        };
        let written = self.capabilities.check_samples(samples, self.frames);
        let written = written.and_then(|()| {
            let written = sink.write(samples);
            written.map_err(|error| file_error(&self.path, &error))
        });
        written.map_err(|error| self.abort(error))?;
        self.frames += samples.len() as u64;
        let magnitudes = samples.iter().map(|sample| sample.abs());
        self.peak = magnitudes.fold(self.peak, f32::max);
        Ok(samples.len())
    }

    fn status(&self) -> Status {
        Status {
            frames_written: self.frames,
            frames_played: self.frames,
            peak: f64::from(self.peak),
            ..Status::default()
        }
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        let (sink, beside) = self.open.take().ok_or_else(|| self.closed())?;
        let kept = sink.end().and_then(|()| beside.keep());
        kept.map_err(|error| file_error(&self.path, &error))
    }
}

fn file_error(path: &str, error: &std::io::Error) -> DeviceError {
    DeviceError::File { path: path.to_owned(), what: error.to_string() }
}
