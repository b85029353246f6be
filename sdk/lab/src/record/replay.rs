//! Replays a recording file as an input.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use htex_author::recording::{ReadOptions, read_channels};
use htex_device::{
    Adapter, Channel, Descriptor, DeviceError, Direction, Endpoint, FromScene, Input, InputFrames,
    InputStream, Setting, SettingKind, Settings,
};

/// The input adapter that replays recording files, in all formats that [`read_channels`] reads.
/// Each column of the file except the time is a channel.
#[derive(Debug, Default, Clone, Copy)]
pub struct Replay;

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
    id: "org.htex.file".to_owned(),
    name: "File".to_owned(),
    version: env!("CARGO_PKG_VERSION").to_owned(),
    summary: "Replays a recording: CSV, WAV, FLAC, NPY, MATLAB, TDMS.".to_owned(),
    direction: Direction::Input,
    target: Some("path".to_owned()),
    settings: vec![
        Setting::new("path", SettingKind::Path, "The file.").with_from_scene(FromScene::Never),
        Setting::hardware(
            "rate_hz",
            SettingKind::Number { min: 0.0, max: 1e7 },
            "0",
            "Sample rate, hertz; 0: the file's own rate.",
        ),
        Setting::hardware(
            "pace",
            SettingKind::choice(&["real", "fast"]),
            "real",
            "Whether samples come at their rate, or as fast as they are read.",
        ),
    ],
    ..Descriptor::default()
});

impl Adapter for Replay {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        Ok(Vec::new())
    }

    fn open_input(&self, settings: &Settings) -> Result<Box<dyn Input>, DeviceError> {
        let path = settings.text("path");
        let rate_hz = Some(settings.number("rate_hz")).filter(|rate_hz| *rate_hz > 0.0);
        let options = ReadOptions::default().with_rate_hz(rate_hz);
        let table = read_channels(Path::new(path), &options)
            .map_err(|error| DeviceError::Missing(error.to_string()))?;
        let channels = table.names.iter().map(|name| Channel::new(name, ""));
        Ok(Box::new(Player {
            name: path.to_owned(),
            stream: InputStream { rate_hz: table.rate_hz, channels: channels.collect() },
            samples: table.channels,
            is_paced: settings.text("pace") == "real",
            begun: None,
            next: 0,
            is_stopped: false,
        }))
    }
}

impl Replay {
    /// Opens a file. If `fast` is true, the input delivers samples as fast as it can read them.
    /// Otherwise, it delivers them at their sample rate.
    ///
    /// # Errors
    /// Returns the errors of [`Adapter::open_input`].
    pub fn file(path: &str, fast: bool) -> Result<Box<dyn Input>, DeviceError> {
        let pace = if fast { "fast" } else { "real" };
        let given = [("path", path), ("pace", pace)]
            .map(|(name, value)| (name.to_owned(), value.to_owned()));
        Self.open_input(&Settings::resolve(&DESCRIPTOR, None, &BTreeMap::from(given))?)
    }
}

/// An open file.
struct Player {
    name: String,
    stream: InputStream,
    samples: Vec<Vec<f64>>,
    is_paced: bool,
    begun: Option<Instant>,
    next: usize,
    is_stopped: bool,
}

impl Player {
    /// Waits until at least one frame is due, at most for `timeout`. Returns the number of frames
    /// that are then due, at most `most`.
    fn due(&self, begun: Instant, most: usize, timeout: Duration) -> usize {
        if !self.is_paced {
            return most;
        }
        let there = || (begun.elapsed().as_secs_f64() * self.stream.rate_hz) as usize;
        // A frame is due only at the end of its period.
        let first_s = (self.next + 1) as f64 / self.stream.rate_hz;
        let wait = Duration::from_secs_f64(first_s).saturating_sub(begun.elapsed());
        std::thread::sleep(wait.min(timeout));
        there().saturating_sub(self.next).min(most)
    }
}

impl Input for Player {
    fn stream(&self) -> &InputStream {
        &self.stream
    }

    fn start(&mut self) -> Result<(), DeviceError> {
        if self.is_stopped {
            Err(DeviceError::Closed(self.name.clone()))
        } else {
            self.begun.get_or_insert_with(Instant::now);
            Ok(())
        }
    }

    fn read(&mut self, samples: &mut [f64], timeout: Duration) -> Result<InputFrames, DeviceError> {
        let Some(begun) = self.begun.filter(|_| !self.is_stopped) else {
            return Err(DeviceError::Closed(self.name.clone()));
        };
        let left = self.samples.first().map_or(0, Vec::len) - self.next;
        if left == 0 {
            return Ok(InputFrames::End);
        }
        let width = self.stream.channels.len();
        let frames = self.due(begun, left.min(samples.len() / width), timeout);
        for (row, frame) in samples.chunks_exact_mut(width).take(frames).enumerate() {
            for (sample, channel) in frame.iter_mut().zip(&self.samples) {
                *sample = channel[self.next + row];
            }
        }
        self.next += frames;
        Ok(InputFrames::Count(frames))
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.is_stopped = true;
        Ok(())
    }
}
