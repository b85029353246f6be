//! Replays a recording file as a source.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use htex_author::recording::{ReadOptions, read_channels};
use htex_device::{
    Channel, Delivered, Descriptor, DeviceError, Endpoint, FromScene, Setting, SettingKind,
    Settings, Source, SourceAdapter,
};

/// The source adapter for files: every file that [`read_channels`] reads. Its channels are all
/// columns except the time.
#[derive(Debug, Default, Clone, Copy)]
pub struct Replay;

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
    id: "org.htex.file".to_owned(),
    name: "File".to_owned(),
    version: env!("CARGO_PKG_VERSION").to_owned(),
    summary: "Replays a recording: CSV, WAV, FLAC, NPY, MATLAB, TDMS.".to_owned(),
    settings: vec![
        setting("path", SettingKind::Path, None, "The file."),
        setting(
            "rate_hz",
            SettingKind::Number { min: 0.0, max: 1e7 },
            Some("0"),
            "Sample rate, hertz; 0: that of the file.",
        ),
        setting(
            "pace",
            SettingKind::Choice { values: vec!["real".to_owned(), "fast".to_owned()] },
            Some("real"),
            "Whether samples come at their rate, or as fast as they are read.",
        ),
    ],
    profiles: Vec::new(),
    mapping: None,
});

fn setting(name: &str, kind: SettingKind, default: Option<&str>, description: &str) -> Setting {
    Setting {
        name: name.to_owned(),
        kind,
        default: default.map(str::to_owned),
        live_default: None,
        from_scene: FromScene::Never,
        description: description.to_owned(),
    }
}

impl SourceAdapter for Replay {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    fn target(&self) -> &str {
        "path"
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        Ok(Vec::new())
    }

    fn open(&self, settings: &Settings) -> Result<Box<dyn Source>, DeviceError> {
        let path = settings.text("path");
        let rate_hz = Some(settings.number("rate_hz")).filter(|rate_hz| *rate_hz > 0.0);
        let options = ReadOptions::default().with_rate_hz(rate_hz);
        let table = read_channels(Path::new(path), &options)
            .map_err(|error| DeviceError::Missing(error.to_string()))?;
        let channels = table.names.iter().map(|name| Channel::new(name, ""));
        Ok(Box::new(Player {
            name: path.to_owned(),
            channels: channels.collect(),
            samples: table.channels,
            rate_hz: table.rate_hz,
            is_paced: settings.text("pace") == "real",
            begun: None,
            next: 0,
            is_stopped: false,
        }))
    }
}

impl Replay {
    /// Opens a file. With `fast`, it is replayed without waiting.
    ///
    /// # Errors
    /// The errors of [`SourceAdapter::open`].
    pub fn file(path: &str, fast: bool) -> Result<Box<dyn Source>, DeviceError> {
        let pace = if fast { "fast" } else { "real" };
        let given = [("path", path), ("pace", pace)]
            .map(|(name, value)| (name.to_owned(), value.to_owned()));
        Self.open(&Settings::resolve(&DESCRIPTOR, None, &BTreeMap::from(given))?)
    }
}

/// An open file.
struct Player {
    name: String,
    channels: Vec<Channel>,
    samples: Vec<Vec<f64>>,
    rate_hz: f64,
    is_paced: bool,
    begun: Option<Instant>,
    next: usize,
    is_stopped: bool,
}

impl Player {
    /// Returns how many frames are due by now, at most `most`. Waits for the first one.
    fn due(&self, begun: Instant, most: usize, timeout: Duration) -> usize {
        if !self.is_paced {
            return most;
        }
        let there = || (begun.elapsed().as_secs_f64() * self.rate_hz) as usize;
        // A frame is due only at the end of its period.
        let first_s = (self.next + 1) as f64 / self.rate_hz;
        let wait = Duration::from_secs_f64(first_s).saturating_sub(begun.elapsed());
        std::thread::sleep(wait.min(timeout));
        there().saturating_sub(self.next).min(most)
    }
}

impl Source for Player {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    fn start(&mut self) -> Result<(), DeviceError> {
        if self.is_stopped {
            Err(DeviceError::Closed(self.name.clone()))
        } else {
            self.begun.get_or_insert_with(Instant::now);
            Ok(())
        }
    }

    fn read(&mut self, samples: &mut [f64], timeout: Duration) -> Result<Delivered, DeviceError> {
        let Some(begun) = self.begun.filter(|_| !self.is_stopped) else {
            return Err(DeviceError::Closed(self.name.clone()));
        };
        let left = self.samples.first().map_or(0, Vec::len) - self.next;
        if left == 0 {
            return Ok(Delivered::End);
        }
        let width = self.channels.len();
        let frames = self.due(begun, left.min(samples.len() / width), timeout);
        for (row, frame) in samples.chunks_exact_mut(width).take(frames).enumerate() {
            for (sample, channel) in frame.iter_mut().zip(&self.samples) {
                *sample = channel[self.next + row];
            }
        }
        self.next += frames;
        Ok(Delivered::Frames(frames))
    }

    fn stop(&mut self) -> Result<(), DeviceError> {
        self.is_stopped = true;
        Ok(())
    }
}
