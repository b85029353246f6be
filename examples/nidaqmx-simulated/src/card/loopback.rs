//! A finger between the first output and the inputs. The output and the inputs may be in two
//! processes. As in electrovibration, the friction is proportional to the square of the voltage.
//!
//! The output appends what it puts out to a file, in chunks: the rate (f64, hertz; 0 without a
//! clock), the number of samples (u64) and the samples (f64, volts), all little-endian.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Bytes of a chunk before its samples.
const HEAD: usize = 16;

pub struct Loopback {
    file: PathBuf,
    /// Number of bytes of the file that have been read as complete chunks.
    place: u64,
    /// Rate of the output, hertz.
    rate_hz: f64,
    /// The voltages that were put out since the beginning.
    volts: Vec<f64>,
    has_ended: bool,
}

impl Loopback {
    pub fn new(folder: &Path) -> Self {
        Self {
            file: folder.join("Dev1_ao0.wire"),
            place: 0,
            rate_hz: 0.0,
            volts: Vec::new(),
            has_ended: false,
        }
    }

    /// Forgets what was put out before.
    pub fn begin(&mut self) {
        let file = std::mem::take(&mut self.file);
        let emptied = File::create(&file).map(|_| ());
        said(&file, emptied);
        *self = Self { file, ..Self::new(Path::new("")) };
    }

    /// Appends what the output puts out.
    pub fn put(&self, volts: &[f64], rate_hz: Option<f64>) {
        if volts.is_empty() {
            return;
        }
        let mut bytes = rate_hz.unwrap_or(0.0).to_le_bytes().to_vec();
        bytes.extend((volts.len() as u64).to_le_bytes());
        bytes.extend(volts.iter().flat_map(|v| v.to_le_bytes()));
        let file = File::options().create(true).append(true).open(&self.file);
        said(&self.file, file.and_then(|mut file| file.write_all(&bytes)));
    }

    /// Returns the number of frames at this rate that have arrived so far. They are counted from
    /// the first sample of the output, or with `from_signal` from the first voltage that is not
    /// zero. Returns `None` after the output has ended: from then on, the inputs have a clock of
    /// their own.
    pub fn frames(&mut self, rate_hz: f64, from_signal: bool) -> Option<u64> {
        let heard = self.hear(from_signal);
        said(&self.file, heard);
        let frames = if self.rate_hz > 0.0 { (self.volts.len() as f64 * rate_hz / self.rate_hz) as u64 } else { 0 };
        (!self.has_ended).then_some(frames)
    }

    /// Returns the voltage at an input: the square of the output's voltage, so that 1 V gives 1 V.
    pub fn volts(&self, frame: u64, rate_hz: f64) -> f64 {
        let at = (frame as f64 * self.rate_hz / rate_hz) as usize;
        self.volts.get(at).map_or(0.0, |v| v * v)
    }

    fn hear(&mut self, from_signal: bool) -> std::io::Result<()> {
        let mut file = match File::open(&self.file) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
            file => file?,
        };
        file.seek(SeekFrom::Start(self.place))?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        let mut rest = &bytes[..];
        while let Some((rate_hz, volts, after)) = chunk(rest) {
            self.take(rate_hz, &volts, from_signal);
            self.place += (rest.len() - after.len()) as u64;
            rest = after;
        }
        Ok(())
    }

    fn take(&mut self, rate_hz: f64, volts: &[f64], from_signal: bool) {
        let has_begun = !self.volts.is_empty();
        if rate_hz == 0.0 {
            self.has_ended |= has_begun;
            return;
        }
        let from = if has_begun || !from_signal { Some(0) } else { volts.iter().position(|v| *v != 0.0) };
        if let Some(from) = from.filter(|_| !self.has_ended) {
            self.rate_hz = rate_hz;
            self.volts.extend(&volts[from..]);
        }
    }
}

/// Returns the rate and the samples of the first chunk, and the bytes after it. Returns `None` if
/// the chunk is not complete.
fn chunk(bytes: &[u8]) -> Option<(f64, Vec<f64>, &[u8])> {
    let number = |bytes: &[u8]| bytes.try_into().ok().map(f64::from_le_bytes);
    let rate_hz = number(bytes.get(..8)?)?;
    let count = u64::from_le_bytes(bytes.get(8..HEAD)?.try_into().ok()?) as usize;
    let samples = bytes.get(HEAD..HEAD + 8 * count)?;
    let volts = samples.chunks_exact(8).filter_map(number).collect();
    Some((rate_hz, volts, &bytes[HEAD + 8 * count..]))
}

fn said(file: &Path, done: std::io::Result<()>) {
    if let Err(error) = done {
        eprintln!("nidaqmx-simulated: {}: {error}", file.display());
    }
}
