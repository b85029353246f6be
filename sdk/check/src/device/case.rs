//! The device under test, and operations on it that several checks share.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use htex_device::{
    Adapter, Capabilities, DeviceError, Direction, Input, InputFrames, NativeAdapter, Output,
    Rates, Setting, SettingKind, Settings, StreamFormat,
};
use tempfile::TempDir;

use crate::harness::Finding;

/// Level of the test tone: a hundredth of the limit, or of the unit if there is no limit.
const QUIET: f64 = 0.01;
/// Frequency of the test tone, hertz.
const TONE_HZ: f64 = 100.0;
/// Maximum number of consecutive calls that may write or read no samples. Each call waits
/// [`PATIENCE`].
const EMPTY_CALLS: u32 = 5;
const PATIENCE: Duration = Duration::from_secs(1);
/// Block size of an output that is opened only to test its arguments, frames.
const BLOCK: u32 = 256;

/// The device under test.
#[derive(Clone)]
pub enum Subject {
    /// A native library.
    Library(PathBuf),
    /// An adapter that is built into this program.
    Builtin(Arc<dyn Adapter>),
}

/// A loaded adapter and its settings.
pub struct Case {
    pub(crate) adapter: Arc<dyn Adapter>,
    /// The same adapter as a native adapter, if it is a native library.
    native: Option<NativeAdapter>,
    profile: Option<String>,
    given: BTreeMap<String, String>,
    /// The folder for files that an output writes, and a counter for the names of these files.
    pub(crate) folder: TempDir,
    files: AtomicU32,
}

impl Case {
    pub(crate) fn load(
        subject: &Subject,
        profile: Option<&str>,
        given: &BTreeMap<String, String>,
    ) -> Result<Self, DeviceError> {
        let (adapter, native): (Arc<dyn Adapter>, _) = match subject {
            Subject::Builtin(adapter) => (adapter.clone(), None),
            Subject::Library(path) => {
                let native = NativeAdapter::load(path)?;
                (Arc::new(native.clone()), Some(native))
            }
        };
        let folder = TempDir::new().map_err(|error| DeviceError::File {
            path: std::env::temp_dir().display().to_string(),
            what: error.to_string(),
        })?;
        let profile = profile.map(str::to_owned);
        let files = AtomicU32::new(0);
        Ok(Self { adapter, native, profile, given: given.clone(), folder, files })
    }

    pub(crate) fn direction(&self) -> Direction {
        self.adapter.descriptor().direction
    }

    /// Returns the adapter's library. For a built-in adapter, the check is skipped.
    pub(crate) fn native(&self) -> Result<&NativeAdapter, Finding> {
        let built_in = || Finding::skipped("it is built in and has no library");
        self.native.as_ref().ok_or_else(built_in)
    }

    /// Returns the given settings. Fills in missing required settings: with a new file for an
    /// output, or with the first endpoint.
    pub(crate) fn settings(&self) -> Result<Settings, Finding> {
        self.settings_of(self.profile.as_deref())
    }

    pub(crate) fn settings_of(&self, profile: Option<&str>) -> Result<Settings, Finding> {
        let descriptor = self.adapter.descriptor();
        let mut given = self.given.clone();
        let fixed = descriptor.profiles.iter().find(|p| Some(&p.name[..]) == profile);
        for setting in descriptor.settings.iter().filter(|s| s.default.is_none()) {
            let name = &setting.name;
            if given.contains_key(name) || fixed.is_some_and(|p| p.settings.contains_key(name)) {
                continue;
            }
            let missing = || Finding::skipped(format!("give `--set {name}=…`"));
            given.insert(name.clone(), self.value(setting).ok_or_else(missing)?);
        }
        Ok(Settings::resolve(descriptor, profile, &given)?)
    }

    fn value(&self, setting: &Setting) -> Option<String> {
        if setting.kind == SettingKind::Path && self.direction() == Direction::Output {
            let count = self.files.fetch_add(1, Ordering::Relaxed);
            let path = self.folder.path().join(format!("check-{count}.wav"));
            return Some(path.display().to_string());
        }
        // Another check tests errors of listing endpoints.
        let all = self.adapter.endpoints().unwrap_or_default();
        let first = all.into_iter().find(|endpoint| endpoint.setting == setting.name);
        first.map(|endpoint| endpoint.name)
    }

    /// Returns the output's capabilities. If the driver or the device is missing, the check is
    /// skipped.
    pub(crate) fn capabilities(&self) -> Result<Capabilities, Finding> {
        let can = self.adapter.capabilities(&self.settings()?);
        can.map_err(skip_missing)
    }

    /// Returns the default sample rate and a block size for opening a library. For an input, both
    /// are 0.
    pub(crate) fn format(&self) -> Result<StreamFormat, Finding> {
        Ok(match self.direction() {
            Direction::Input => StreamFormat { rate_hz: 0.0, block_frames: 0 },
            Direction::Output => {
                let rate_hz = self.capabilities()?.default_rate_hz;
                StreamFormat { rate_hz, block_frames: BLOCK }
            }
        })
    }

    /// Opens an output at its default rate. Also returns its settings.
    pub(crate) fn open_output(&self) -> Result<(Box<dyn Output>, Settings), Finding> {
        let settings = self.settings()?;
        let rate_hz = self.capabilities()?.default_rate_hz;
        let output = self.open_at(&settings, rate_hz)?;
        Ok((output, settings))
    }

    pub(crate) fn open_at(
        &self,
        settings: &Settings,
        rate_hz: f64,
    ) -> Result<Box<dyn Output>, DeviceError> {
        let block_frames = self.adapter.capabilities(settings)?.block_frames;
        let format = StreamFormat { rate_hz, block_frames };
        self.adapter.open_output(settings, &format)
    }

    /// Opens an input. If the driver or the device is missing, the check is skipped.
    pub(crate) fn open_input(&self) -> Result<Box<dyn Input>, Finding> {
        self.adapter.open_input(&self.settings()?).map_err(skip_missing)
    }

    /// Opens an input and starts sampling.
    pub(crate) fn started(&self) -> Result<Box<dyn Input>, Finding> {
        let mut input = self.open_input()?;
        input.start()?;
        Ok(input)
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

/// Writes all samples. If the device has a clock, waits until it takes them.
pub(crate) fn write_all(output: &mut dyn Output, samples: &[f32]) -> Result<(), Finding> {
    let (mut left, mut empty) = (samples, 0);
    while !left.is_empty() {
        let taken = output.write(left, PATIENCE)?;
        empty = if taken == 0 { empty + 1 } else { 0 };
        if empty == EMPTY_CALLS {
            let seconds = PATIENCE.as_secs() * u64::from(EMPTY_CALLS);
            return Err(Finding::failed(format!("it takes no samples for {seconds} s")));
        }
        let Some(rest) = left.get(taken..) else {
            return Err(Finding::failed("it takes more samples than it was offered"));
        };
        left = rest;
    }
    Ok(())
}

/// Returns the sample rates to try: all rates of a list, or both ends of a range; and the default
/// rate.
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

/// Reads `frames` frames in blocks of various sizes, or fewer if the input ends. Returns the number
/// of frames.
pub(crate) fn read_all(input: &mut dyn Input, frames: usize) -> Result<usize, Finding> {
    let width = input.stream().channels.len();
    let mut samples = vec![0.0; frames * width];
    let (mut read, mut empty) = (0, 0);
    while read < frames {
        let there = match input.read(&mut samples[read * width..], PATIENCE)? {
            InputFrames::Count(there) => there,
            InputFrames::End => return Ok(read),
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
        if empty == EMPTY_CALLS {
            let seconds = PATIENCE.as_secs() * u64::from(EMPTY_CALLS);
            return Err(Finding::failed(format!("it delivers nothing for {seconds} s")));
        }
        read += there;
    }
    Ok(read)
}

/// Checks that calls were refused because the device is closed.
pub(crate) fn check_closed<const N: usize>(
    calls: [(&str, Result<(), DeviceError>); N],
) -> Result<(), Finding> {
    for (call, answer) in calls {
        match answer {
            Err(DeviceError::Closed(_)) => {}
            Err(error) => {
                return Err(Finding::failed(format!("{call}: another error: {error}")));
            }
            Ok(()) => return Err(Finding::failed(format!("{call} is not refused as closed"))),
        }
    }
    Ok(())
}

/// Converts an error to a finding. If a driver or the hardware is missing, the check is skipped.
pub(crate) fn skip_missing(error: DeviceError) -> Finding {
    match error {
        DeviceError::Missing(what) => Finding::skipped(what),
        error => error.into(),
    }
}
