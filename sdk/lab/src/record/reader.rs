//! Reads a source in blocks: the values of its signals, and the tracker's rows up to the end of
//! each block. This module also runs the phases of a session block by block, and computes the state
//! that the user sees.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use htex_author::recording::Role;
use htex_device::{Input, InputFrames};

use crate::error::LabError;
use crate::record::data::{TakeHeader, texture_axes};
use crate::record::guide::{FingerPath, Moment, Phase};
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

    /// Reads the next block of at most `most` frames. Returns `None` if nothing arrived for a short
    /// time.
    ///
    /// # Errors
    /// Returns the errors of the source and of the tracker, [`LabError::Silent`], and
    /// [`LabError::Ended`].
    pub(crate) fn block(&mut self, most: u64) -> Result<Option<Block>, LabError> {
        let (rate_hz, width) = (self.source.stream().rate_hz, self.source.stream().channels.len());
        // A block has at least one frame. At a sample rate below 50 Hz, it would have none
        // otherwise.
        let block = ((BLOCK_S * rate_hz) as u64).clamp(1, most.max(1)) as usize;
        self.samples.resize(block * width, 0.0);
        let since = *self.since.get_or_insert_with(Instant::now);
        let frames = match self.source.read(&mut self.samples, WAIT)? {
            InputFrames::Count(0) if since.elapsed() > SILENT => {
                let seconds = SILENT.as_secs();
                return Err(LabError::Silent { seconds });
            }
            InputFrames::Count(0) => return Ok(None),
            InputFrames::Count(frames) => frames,
            InputFrames::End => {
                return Err(LabError::Ended { after_s: 0.0, seconds: self.seconds, kept: None });
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

    /// Returns the interleaved rows of the tracker from `begin_s` on, with times that count from
    /// `begin_s`.
    pub(crate) fn rows_since(&self, header: &TakeHeader, begin_s: f64) -> Vec<f64> {
        let mut kept = Vec::new();
        let rows = self.rows.chunks_exact(header.tracker.len() + 1);
        for row in rows.filter(|row| row[0] >= begin_s) {
            kept.push(row[0] - begin_s);
            kept.extend(&row[1..]);
        }
        kept
    }

    /// Returns an error if a value is not finite.
    ///
    /// # Errors
    /// [`LabError::NotFinite`].
    pub(crate) fn check(&self, header: &TakeHeader) -> Result<(), LabError> {
        for ((role, _), values) in header.signals.iter().zip(&self.values) {
            if let Some(at) = values.iter().position(|value| !value.is_finite()) {
                return Err(LabError::NotFinite {
                    role: role.clone(),
                    value: values[at],
                    at_s: self.begin_s + at as f64 / header.rate_hz,
                });
            }
        }
        Ok(())
    }
}

pub(crate) type Take<'a> = dyn FnMut(&Block) -> Result<(), LabError> + 'a;

/// The displayed force is a mean over this time, seconds. Takes are judged by means over the same
/// time.
const FORCE_S: f64 = 0.05;

/// Whether a session continues.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    /// The session continues.
    Go,
    /// The session ends. The samples that were recorded until then stay on disk.
    Stop,
}

/// A phase of a session that is to be read.
pub(crate) struct Span {
    pub(crate) phase: Phase,
    /// Number of the take.
    pub(crate) number: u32,
    /// Length of the phase, seconds.
    pub(crate) of_s: f64,
}

impl Span {
    pub(crate) fn new(phase: Phase, number: u32, of_s: f64) -> Self {
        Self { phase, number, of_s }
    }
}

/// Reads phases, and keeps track of the finger's position.
pub(crate) struct Phases {
    pub(crate) reader: Reader,
    path: FingerPath,
    force: RunningMean,
    /// Indices of the axes of the texture's signal.
    texture: Vec<usize>,
}

impl Phases {
    pub(crate) fn new(reader: Reader) -> Self {
        let frames = (FORCE_S * reader.source.stream().rate_hz).round().max(1.0) as usize;
        Self {
            texture: texture_axes(&reader.inputs.signals.list()),
            force: RunningMean::new(frames),
            path: FingerPath::default(),
            reader,
        }
    }

    /// Reads a phase and passes each block to `take`.
    pub(crate) fn run(
        &mut self,
        span: Span,
        watch: &mut dyn FnMut(&Moment<'_>) -> Next,
        take: &mut Take<'_>,
    ) -> Result<(), LabError> {
        let Span { phase, number, of_s } = span;
        let rate_hz = self.reader.source.stream().rate_hz;
        let frames = (of_s * rate_hz).round() as u64;
        let mut done = 0;
        while done < frames {
            let Some(block) = self.reader.block(frames - done)? else {
                continue;
            };
            let values = &block.values;
            done += values.first().map_or(0, Vec::len) as u64;
            // The block is stored before it is shown, so that it is not lost if the session stops.
            take(&block)?;
            let texture: Vec<&[f64]> = self.texture.iter().map(|at| &values[*at][..]).collect();
            let moment = Moment {
                phase,
                number,
                elapsed_s: done as f64 / rate_hz,
                of_s,
                force_n: self.force(values),
                position_mm: self.position(&block),
                texture: &texture,
            };
            if watch(&moment) == Next::Stop {
                return Err(LabError::Left { kept: None });
            }
        }
        Ok(())
    }

    /// Returns the absolute value of the mean force over the last 50 ms. The sign is dropped,
    /// because for some sensors and recordings a pressing force is negative.
    fn force(&mut self, values: &[Vec<f64>]) -> Option<f64> {
        let normal = self.reader.inputs.signals.position(Role::Normal)?;
        self.force.push(&values[normal]);
        Some(self.force.mean().abs())
    }

    /// Returns the finger's position. The position comes from the tracker if there is one,
    /// otherwise from the source.
    fn position(&mut self, block: &Block) -> Option<f64> {
        for (axis, role) in [Role::X, Role::Y].into_iter().enumerate() {
            let own = self
                .reader
                .inputs
                .signals
                .position(role)
                .and_then(|at| block.values[at].last().copied());
            let at_mm = self.tracked(role, &block.rows).or(own);
            if let Some(at_mm) = at_mm {
                self.path.see(axis, at_mm);
            }
        }
        self.path.place_mm()
    }

    /// Returns the tracker's newest position along the axis of a role.
    fn tracked(&self, role: Role, rows: &[f64]) -> Option<f64> {
        let signals = self.reader.inputs.tracked();
        let axis = signals.iter().position(|(own, _)| own == role.name())?;
        let newest = rows.chunks_exact(signals.len() + 1).last()?;
        newest.get(axis + 1).copied()
    }
}

/// The mean of the newest values.
struct RunningMean {
    newest: VecDeque<f64>,
    most: usize,
}

impl RunningMean {
    fn new(most: usize) -> Self {
        Self { newest: VecDeque::with_capacity(most), most }
    }

    fn push(&mut self, values: &[f64]) {
        let values = &values[values.len().saturating_sub(self.most)..];
        let surplus = (self.newest.len() + values.len()).saturating_sub(self.most);
        self.newest.drain(..surplus);
        self.newest.extend(values);
    }

    fn mean(&self) -> f64 {
        self.newest.iter().sum::<f64>() / self.newest.len().max(1) as f64
    }
}
