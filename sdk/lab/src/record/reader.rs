//! Reads a source in blocks: the values of its signals, and the tracker's rows up to the same time.

use std::time::{Duration, Instant};

use htex_device::{Input, InputFrames};

use crate::record::data::TakeHeader;
use crate::record::error::RecordError;
use crate::record::signals::Signals;
use crate::record::tracker::TrackerRows;

/// Length of a block, seconds.
const BLOCK_S: f64 = 0.02;
/// Longest single wait for samples.
const WAIT: Duration = Duration::from_millis(100);
/// Longest total time without samples.
const SILENT: Duration = Duration::from_secs(5);

/// The signals of a source, with a tracker if there is one.
pub(crate) struct Inputs {
    pub(crate) signals: Signals,
    pub(crate) tracker: Option<Box<dyn TrackerRows>>,
}

/// Reads a source.
pub(crate) struct Reader {
    pub(crate) source: Box<dyn Input>,
    pub(crate) inputs: Inputs,
    /// Length of a take in seconds, for messages.
    seconds: f64,
    /// Number of frames read from the source so far.
    read: u64,
    samples: Vec<f64>,
    since: Option<Instant>,
}

/// A block that was read.
pub(crate) struct Block {
    /// Time of the first sample since the source was started, seconds.
    pub(crate) begin_s: f64,
    /// The values of each signal.
    pub(crate) values: Vec<Vec<f64>>,
    /// Interleaved rows of the tracker, with times since the source was started.
    pub(crate) rows: Vec<f64>,
}

impl Inputs {
    /// Returns the role and unit of each tracker signal, without the time.
    pub(crate) fn tracked(&self) -> Vec<(String, String)> {
        let tracker = self.tracker.as_ref();
        tracker.map(|tracker| tracker.signals()).unwrap_or_default()
    }
}

impl Reader {
    pub(crate) fn new(source: Box<dyn Input>, inputs: Inputs, seconds: f64) -> Self {
        Self { source, inputs, seconds, read: 0, samples: Vec::new(), since: None }
    }

    /// Returns the time of the next sample since the source was started, seconds.
    pub(crate) fn now_s(&self) -> f64 {
        self.read as f64 / self.source.stream().rate_hz
    }

    /// Reads the next block of at most `most` frames; `None` if nothing arrived for a short time.
    ///
    /// # Errors
    /// The errors of the source and of the tracker, [`RecordError::Silent`], and
    /// [`RecordError::Ended`].
    pub(crate) fn block(&mut self, most: u64) -> Result<Option<Block>, RecordError> {
        let (rate_hz, width) = (self.source.stream().rate_hz, self.source.stream().channels.len());
        // At least one frame, because a block of a rate below 50 Hz would have none.
        let block = ((BLOCK_S * rate_hz) as u64).clamp(1, most.max(1)) as usize;
        self.samples.resize(block * width, 0.0);
        let since = *self.since.get_or_insert_with(Instant::now);
        let frames = match self.source.read(&mut self.samples, WAIT)? {
            InputFrames::Count(0) if since.elapsed() > SILENT => {
                let seconds = SILENT.as_secs();
                return Err(RecordError::Silent { seconds });
            }
            InputFrames::Count(0) => return Ok(None),
            InputFrames::Count(frames) => frames,
            InputFrames::End => {
                return Err(RecordError::Ended { after_s: 0.0, seconds: self.seconds, kept: None });
            }
        };
        self.since = None;
        let begin_s = self.now_s();
        self.read += frames as u64;
        let (now_s, mut rows) = (self.now_s(), Vec::new());
        if let Some(tracker) = &mut self.inputs.tracker {
            tracker.poll(now_s, &mut rows)?;
        }
        Ok(Some(Block {
            begin_s,
            values: self.inputs.signals.values(&self.samples[..frames * width]),
            rows,
        }))
    }
}

impl Block {
    /// Returns the values frame by frame.
    pub(crate) fn interleaved(&self) -> Vec<f64> {
        let rows = self.values.first().map_or(0, Vec::len);
        (0..rows).flat_map(|row| self.values.iter().map(move |values| values[row])).collect()
    }

    /// Returns the tracker's interleaved rows with times since `begin_s`. Earlier rows are left
    /// out.
    pub(crate) fn rows_since(&self, header: &TakeHeader, begin_s: f64) -> Vec<f64> {
        let mut kept = Vec::new();
        let rows = self.rows.chunks_exact(header.tracker.len() + 1);
        for row in rows.filter(|row| row[0] >= begin_s) {
            kept.push(row[0] - begin_s);
            kept.extend(&row[1..]);
        }
        kept
    }

    /// Refuses values that are not finite.
    ///
    /// # Errors
    /// [`RecordError::NotFinite`].
    pub(crate) fn check(&self, header: &TakeHeader) -> Result<(), RecordError> {
        for ((role, _), values) in header.signals.iter().zip(&self.values) {
            if let Some(at) = values.iter().position(|value| !value.is_finite()) {
                return Err(RecordError::NotFinite {
                    role: role.clone(),
                    value: values[at],
                    at_s: self.begin_s + at as f64 / header.rate_hz,
                });
            }
        }
        Ok(())
    }
}
