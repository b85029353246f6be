//! The device {{LABEL}} ({{ID}}): initially an output that writes the force at the finger to a CSV
//! file.
//!
//! The samples are written to a temporary file beside the file that the user named (`PATH.1`, or
//! the next number that is free). When the output is finished, the temporary file is renamed.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::Duration;

use htex_device::{
    Adapter, Capabilities, Descriptor, DeviceError, Endpoint, Output, Quantity, Rates, Setting,
    SettingKind, Settings, Status, StreamFormat,
};

htex_device::export_device!({{TYPE}}, symbols: "plugin");

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
    id: "{{ID}}".to_owned(),
    name: "{{LABEL}}".to_owned(),
    version: env!("CARGO_PKG_VERSION").to_owned(),
    summary: "{{LABEL}}: writes the force to a CSV file.".to_owned(),
    settings: vec![
        Setting::new("path", SettingKind::Path, "Path of the file."),
        Setting::new(
            "limit_n",
            SettingKind::Number { min: 0.001, max: 100.0 },
            "Largest force; samples beyond it are refused.",
        )
        .with_default("1"),
    ],
    ..Descriptor::default()
});

/// The device.
#[derive(Default)]
pub struct {{TYPE}};

impl Adapter for {{TYPE}} {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    /// Lists the connected hardware. A file needs none.
    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        Ok(Vec::new())
    }

    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        Ok(Capabilities {
            quantity: Quantity::LateralForce,
            rates: Rates::Range { min_hz: 100.0, max_hz: 100_000.0 },
            default_rate_hz: 10_000.0,
            limit: Some(settings.number("limit_n")),
            step: None,
            carrier_hz: None,
            paced: false,
            block_frames: 1_024,
        })
    }

    fn open_output(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
        let capabilities = self.capabilities(settings)?;
        if !capabilities.has_rate(format.rate_hz) {
            return Err(DeviceError::Rate {
                device: DESCRIPTOR.name.clone(),
                rate_hz: format.rate_hz,
                rates: capabilities.rates_text(),
            });
        }
        let path = PathBuf::from(settings.text("path"));
        let file = CsvFile::create(&path).map_err(|error| file_error(&path, &error))?;
        Ok(Box::new(OpenFile {
            capabilities,
            path,
            rate_hz: format.rate_hz,
            file: Some(file),
            status: Status::default(),
        }))
    }
}

/// An open output.
struct OpenFile {
    capabilities: Capabilities,
    path: PathBuf,
    rate_hz: f64,
    /// `None` after the end, and after an error.
    file: Option<CsvFile>,
    status: Status,
}

impl Output for OpenFile {
    fn write(&mut self, samples: &[f32], _timeout: Duration) -> Result<usize, DeviceError> {
        // After an error, the file is not put back: it is removed, and the output stays closed.
        let mut file = self.file.take().ok_or_else(|| closed(&self.path))?;
        // All samples are checked before any is written.
        self.capabilities.check_samples(samples, self.status.frames_written)?;
        let written = file.write(samples, self.status.frames_written, self.rate_hz);
        written.map_err(|error| file_error(&self.path, &error))?;
        self.file = Some(file);
        self.status.frames_written += samples.len() as u64;
        self.status.frames_played = self.status.frames_written;
        for sample in samples {
            self.status.peak = self.status.peak.max(f64::from(sample.abs()));
        }
        Ok(samples.len())
    }

    fn status(&self) -> Status {
        self.status
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        let file = self.file.take().ok_or_else(|| closed(&self.path))?;
        file.keep(&self.path).map_err(|error| file_error(&self.path, &error))
    }
}

/// A temporary file, which is removed unless it is kept.
struct CsvFile {
    writer: BufWriter<File>,
    temporary: PathBuf,
}

impl CsvFile {
    fn create(path: &Path) -> io::Result<Self> {
        for number in 1..=100 {
            let mut temporary = path.as_os_str().to_owned();
            temporary.push(format!(".{number}"));
            match File::create_new(&temporary) {
                Ok(file) => {
                    let temporary = PathBuf::from(temporary);
                    let mut csv = Self { writer: BufWriter::new(file), temporary };
                    writeln!(csv.writer, "time_s,force_n")?;
                    return Ok(csv);
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(io::Error::new(ErrorKind::AlreadyExists, "a hundred temporary files are beside it"))
    }

    fn write(&mut self, samples: &[f32], first_frame: u64, rate_hz: f64) -> io::Result<()> {
        for (frame, sample) in (first_frame..).zip(samples) {
            writeln!(self.writer, "{},{sample}", frame as f64 / rate_hz)?;
        }
        Ok(())
    }

    fn keep(mut self, path: &Path) -> io::Result<()> {
        self.writer.flush()?;
        fs::rename(&self.temporary, path)?;
        self.temporary = PathBuf::new();
        Ok(())
    }
}

impl Drop for CsvFile {
    fn drop(&mut self) {
        // After `keep`, the path is empty, and nothing is removed.
        let _ = fs::remove_file(&self.temporary);
    }
}

fn closed(path: &Path) -> DeviceError {
    DeviceError::Closed(path.display().to_string())
}

fn file_error(path: &Path, error: &io::Error) -> DeviceError {
    DeviceError::File { path: path.display().to_string(), what: error.to_string() }
}
