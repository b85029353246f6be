//! The device under test, and operations that several checks use.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use htex_check_runner::Finding;
use htex_device::{
    Adapter, Capabilities, Descriptor, Device, DeviceError, Endpoint, NativeAdapter, Rates,
    Setting, SettingKind, Settings, StreamFormat,
};
use tempfile::TempDir;

/// A hundredth of the limit, or of the unit where there is none.
const QUIET: f64 = 0.01;
/// Frequency of the tone, hertz.
const TONE_HZ: f64 = 100.0;
/// Most consecutive writes that may take nothing, each waiting [`PATIENCE`].
const EMPTY_WRITES: u32 = 5;
const PATIENCE: Duration = Duration::from_secs(1);

/// The device under test, or the source.
#[derive(Clone)]
pub enum Subject<A: ?Sized = dyn Adapter> {
    Library(PathBuf),
    /// An adapter of this program.
    Builtin(Arc<A>),
}

/// A loaded device, and its settings.
pub struct Case {
    pub(crate) adapter: Arc<dyn Adapter>,
    /// The same adapter, if it is a native library.
    pub(crate) native: Option<NativeAdapter>,
    profile: Option<String>,
    given: BTreeMap<String, String>,
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
        Ok(Self {
            adapter,
            native,
            profile: profile.map(str::to_owned),
            given: given.clone(),
            folder,
            files: AtomicU32::new(0),
        })
    }

    /// The given settings; required ones that are missing are a new file or the first endpoint.
    pub(crate) fn settings(&self) -> Result<Settings, Finding> {
        self.settings_of(self.profile.as_deref())
    }

    pub(crate) fn settings_of(&self, profile: Option<&str>) -> Result<Settings, Finding> {
        let value = |setting: &Setting| match setting.kind {
            SettingKind::Path => Some(self.new_file()),
            _ => first(self.adapter.endpoints(), &setting.name),
        };
        filled(self.adapter.descriptor(), profile, &self.given, value)
    }

    /// The path of a new WAV file.
    fn new_file(&self) -> String {
        let count = self.files.fetch_add(1, Ordering::Relaxed);
        let path = self.folder.path().join(format!("check-{count}.wav"));
        path.display().to_string()
    }

    /// The device's capabilities; the check is skipped where the driver or the device is missing.
    pub(crate) fn capabilities(&self) -> Result<Capabilities, Finding> {
        let can = self.adapter.capabilities(&self.settings()?);
        can.map_err(|error| match error {
            DeviceError::Missing(what) => Finding::skipped(what),
            error => error.into(),
        })
    }

    /// A device at its default rate, and its settings.
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
        let format = StreamFormat {
            rate_hz,
            block_frames,
        };
        self.adapter.open(settings, &format)
    }

    /// A quiet tone at the default rate.
    pub(crate) fn tone(&self, frames: usize) -> Result<Vec<f32>, Finding> {
        let can = self.capabilities()?;
        let amplitude = QUIET * can.limit.unwrap_or(1.0);
        let turn = std::f64::consts::TAU * TONE_HZ / can.default_rate_hz;
        let sample = |i| (amplitude * (turn * i as f64).sin()) as f32;
        Ok((0..frames).map(sample).collect())
    }
}

/// The given settings; `value` fills required ones that are missing.
pub(crate) fn filled(
    descriptor: &Descriptor,
    profile: Option<&str>,
    given: &BTreeMap<String, String>,
    value: impl Fn(&Setting) -> Option<String>,
) -> Result<Settings, Finding> {
    let mut given = given.clone();
    let fixed = descriptor
        .profiles
        .iter()
        .find(|p| Some(&p.name[..]) == profile);
    for setting in descriptor.settings.iter().filter(|s| s.default.is_none()) {
        let name = &setting.name;
        if given.contains_key(name) || fixed.is_some_and(|p| p.settings.contains_key(name)) {
            continue;
        }
        let missing = || Finding::skipped(format!("give `setting {name}=…`"));
        given.insert(name.clone(), value(setting).ok_or_else(missing)?);
    }
    Ok(Settings::resolve(descriptor, profile, &given)?)
}

/// The first endpoint that this setting takes.
pub(crate) fn first(
    endpoints: Result<Vec<Endpoint>, DeviceError>,
    setting: &str,
) -> Option<String> {
    let all = endpoints.unwrap_or_default();
    let first = all.into_iter().find(|endpoint| endpoint.setting == setting);
    first.map(|endpoint| endpoint.name)
}

/// Writes all samples, waiting for a device that has a clock.
pub(crate) fn write_all(device: &mut dyn Device, samples: &[f32]) -> Result<(), Finding> {
    let (mut left, mut empty) = (samples, 0);
    while !left.is_empty() {
        let taken = device.write(left, PATIENCE)?;
        empty = if taken == 0 { empty + 1 } else { 0 };
        if empty == EMPTY_WRITES {
            let seconds = PATIENCE.as_secs() * u64::from(EMPTY_WRITES);
            return Err(Finding::failed(format!(
                "it takes no samples for {seconds} s"
            )));
        }
        let Some(rest) = left.get(taken..) else {
            return Err(Finding::failed("it takes more samples than it was offered"));
        };
        left = rest;
    }
    Ok(())
}

/// The rates to try: all of a list, both ends of a range, and the default.
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
