//! Operations on the device under test that several checks share.

use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use crate::harness::Finding;
use htex_device::{
    Adapter, Capabilities, Device, DeviceError, Rates, Setting, SettingKind, Settings, StreamFormat,
};
use tempfile::TempDir;

use crate::device::case::{CaseKind, skip_missing};

/// A loaded device and its settings.
pub(crate) type Case = crate::device::case::Case<dyn Adapter>;

/// Level of the test tone: a hundredth of the limit, or of the unit if there is no limit.
const QUIET: f64 = 0.01;
/// Frequency of the test tone, hertz.
const TONE_HZ: f64 = 100.0;
/// Maximum number of consecutive writes that may take nothing, each waiting [`PATIENCE`].
const EMPTY_WRITES: u32 = 5;
const PATIENCE: Duration = Duration::from_secs(1);

/// The folder for the files that a device writes, and a counter for their names.
pub struct Files {
    pub(crate) folder: TempDir,
    count: AtomicU32,
}

impl CaseKind for dyn Adapter {
    type Files = Files;

    fn files() -> Result<Files, DeviceError> {
        let folder = TempDir::new().map_err(|error| DeviceError::File {
            path: std::env::temp_dir().display().to_string(),
            what: error.to_string(),
        })?;
        let count = AtomicU32::new(0);
        Ok(Files { folder, count })
    }
}

impl Case {
    /// Returns the given settings. A missing required setting becomes a new file or the first
    /// endpoint.
    pub(crate) fn settings(&self) -> Result<Settings, Finding> {
        self.settings_of(self.profile())
    }

    pub(crate) fn settings_of(&self, profile: Option<&str>) -> Result<Settings, Finding> {
        let value = |setting: &Setting| match setting.kind {
            SettingKind::Path => Some(self.new_file()),
            _ => self.first_endpoint(&setting.name),
        };
        self.filled(profile, value)
    }

    /// Returns the path of a new WAV file.
    fn new_file(&self) -> String {
        let count = self.files.count.fetch_add(1, Ordering::Relaxed);
        let path = self.files.folder.path().join(format!("check-{count}.wav"));
        path.display().to_string()
    }

    /// Returns the device's capabilities. If the driver or the device is missing, the check is
    /// skipped.
    pub(crate) fn capabilities(&self) -> Result<Capabilities, Finding> {
        let can = self.adapter.capabilities(&self.settings()?);
        can.map_err(skip_missing)
    }

    /// Opens a device at its default rate. Also returns its settings.
    pub(crate) fn open(&self) -> Result<(Box<dyn Device>, Settings), Finding> {
        let settings = self.settings()?;
        let rate_hz = self.capabilities()?.default_rate_hz;
        let device = self.open_at(&settings, rate_hz)?;
        Ok((device, settings))
    }

    pub(crate) fn open_at(
        &self,
        settings: &Settings,
        rate_hz: f64,
    ) -> Result<Box<dyn Device>, DeviceError> {
        let block_frames = self.adapter.capabilities(settings)?.block_frames;
        let format = StreamFormat { rate_hz, block_frames };
        self.adapter.open(settings, &format)
    }

    /// Generates a quiet tone at the default rate.
    pub(crate) fn tone(&self, frames: usize) -> Result<Vec<f32>, Finding> {
        let can = self.capabilities()?;
        let amplitude = QUIET * can.limit.unwrap_or(1.0);
        let turn = std::f64::consts::TAU * TONE_HZ / can.default_rate_hz;
        let sample = |i| (amplitude * (turn * i as f64).sin()) as f32;
        Ok((0..frames).map(sample).collect())
    }
}

/// Writes all samples, and waits if the device has a clock.
pub(crate) fn write_all(device: &mut dyn Device, samples: &[f32]) -> Result<(), Finding> {
    let (mut left, mut empty) = (samples, 0);
    while !left.is_empty() {
        let taken = device.write(left, PATIENCE)?;
        empty = if taken == 0 { empty + 1 } else { 0 };
        if empty == EMPTY_WRITES {
            let seconds = PATIENCE.as_secs() * u64::from(EMPTY_WRITES);
            return Err(Finding::failed(format!("it takes no samples for {seconds} s")));
        }
        let Some(rest) = left.get(taken..) else {
            return Err(Finding::failed("it takes more samples than it was offered"));
        };
        left = rest;
    }
    Ok(())
}

/// Returns the rates to try: all of a list, or both ends of a range, and the default.
pub(crate) fn rates(can: &Capabilities) -> Vec<f64> {
    let mut rates = match &can.rates {
        Rates::List(all) => all.clone(),
        Rates::Range { min_hz, max_hz } => vec![*min_hz, *max_hz],
    };
    rates.push(can.default_rate_hz);
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    rates
}
