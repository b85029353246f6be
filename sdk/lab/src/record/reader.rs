//! The samples of a source and the rows of a tracker, block by block.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use htex_author::read::Role;
use htex_device::{Delivered, Source};

use crate::record::data::texture_axes;
use crate::record::error::RecordError;
use crate::record::guide::{FingerPath, Moment, Phase};
use crate::record::signals::Signals;
use crate::record::tracker::TrackerRows;

/// Takes a block: its time, the values of each signal, and the rows of the tracker.
pub(crate) type Take<'a> = dyn FnMut(f64, &[Vec<f64>], &[f64]) -> Result<(), RecordError> + 'a;

/// Length of a block that is read, seconds.
const BLOCK_S: f64 = 0.02;
/// Longest wait for samples at a time.
const WAIT: Duration = Duration::from_millis(100);
/// Time over which the force is shown as a mean, seconds: that of the means by which a take is judged.
const FORCE_S: f64 = 0.05;
/// Longest time without samples.
const SILENT: Duration = Duration::from_secs(5);

/// Whether a session goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    /// It does.
    Go,
    /// It ends; what was recorded is kept.
    Stop,
}

/// A phase that is read.
pub(crate) struct Span {
    pub(crate) phase: Phase,
    /// Number of the take.
    pub(crate) number: u32,
    /// Its length, seconds.
    pub(crate) of_s: f64,
}

impl Span {
    pub(crate) fn new(phase: Phase, number: u32, of_s: f64) -> Self {
        Self {
            phase,
            number,
            of_s,
        }
    }
}

/// Reads a source, from its start on, and a tracker beside it.
pub(crate) struct Reader {
    pub(crate) source: Box<dyn Source>,
    pub(crate) signals: Signals,
    pub(crate) tracker: Option<Box<dyn TrackerRows>>,
    /// Frames that were read from the source.
    read: u64,
    samples: Vec<f64>,
    /// Rows of the tracker that belong to later samples than those that were read.
    rows: Vec<f64>,
    path: FingerPath,
    force: RunningMean,
    /// Indices of the axes of the texture's signal.
    texture: Vec<usize>,
    /// Length of a take, seconds, for the error of a source that ends.
    take_s: f64,
}

impl Reader {
    pub(crate) fn new(
        source: Box<dyn Source>,
        signals: Signals,
        tracker: Option<Box<dyn TrackerRows>>,
        take_s: f64,
    ) -> Self {
        let frames = (FORCE_S * source.rate_hz()).round().max(1.0) as usize;
        Self {
            texture: texture_axes(&signals.list()),
            force: RunningMean::new(frames),
            source,
            signals,
            tracker,
            read: 0,
            samples: Vec::new(),
            rows: Vec::new(),
            path: FingerPath::default(),
            take_s,
        }
    }

    /// Time of the next sample since the source was started, seconds.
    pub(crate) fn now_s(&self) -> f64 {
        self.read as f64 / self.source.rate_hz()
    }

    /// Reads a phase, block by block. `take` gets the time of the block, the values of each signal, and the rows of the tracker.
    pub(crate) fn run(
        &mut self,
        span: Span,
        watch: &mut dyn FnMut(&Moment<'_>) -> Next,
        take: &mut Take<'_>,
    ) -> Result<(), RecordError> {
        let Span {
            phase,
            number,
            of_s,
        } = span;
        let rate_hz = self.source.rate_hz();
        let frames = (of_s * rate_hz).round() as u64;
        let mut done = 0;
        while done < frames {
            let begin_s = self.now_s();
            let values = self.block(frames - done)?;
            done += values.first().map_or(0, Vec::len) as u64;
            let rows = std::mem::take(&mut self.rows);
            take(begin_s, &values, &rows)?;
            let texture: Vec<&[f64]> = self.texture.iter().map(|at| &values[*at][..]).collect();
            let moment = Moment {
                phase,
                number,
                elapsed_s: done as f64 / rate_hz,
                of_s,
                force_n: self.force(&values),
                position_mm: self.position(&values, &rows),
                texture: &texture,
            };
            if watch(&moment) == Next::Stop {
                return Err(RecordError::Left { kept: None });
            }
        }
        Ok(())
    }

    /// The force of the last 50 ms. A sensor may count pressing as negative, as a recording may.
    fn force(&mut self, values: &[Vec<f64>]) -> Option<f64> {
        let normal = self.signals.position(Role::Normal)?;
        self.force.take(&values[normal]);
        Some(self.force.mean().abs())
    }

    /// The finger's place by the tracker, else by the source.
    fn position(&mut self, values: &[Vec<f64>], rows: &[f64]) -> Option<f64> {
        for (axis, role) in [Role::X, Role::Y].into_iter().enumerate() {
            let own = self.signals.position(role);
            let own = own.and_then(|at| values[at].last().copied());
            let at_mm = self.tracked(role, rows).or(own);
            if let Some(at_mm) = at_mm {
                self.path.see(axis, at_mm);
            }
        }
        self.path.place_mm()
    }

    /// The newest position by the tracker along the axis of a role.
    fn tracked(&self, role: Role, rows: &[f64]) -> Option<f64> {
        let signals = self.tracker.as_ref()?.signals();
        let axis = signals.iter().position(|(own, _)| own == role.name())?;
        let newest = rows.chunks_exact(signals.len() + 1).last()?;
        newest.get(axis + 1).copied()
    }

    /// The values of the next samples, at most `most`, and puts aside the tracker's rows until then.
    fn block(&mut self, most: u64) -> Result<Vec<Vec<f64>>, RecordError> {
        let (rate_hz, width) = (self.source.rate_hz(), self.source.channels().len());
        let block = ((BLOCK_S * rate_hz) as u64).clamp(1, most) as usize;
        self.samples.resize(block * width, 0.0);
        let since = Instant::now();
        let frames = loop {
            match self.source.read(&mut self.samples, WAIT)? {
                Delivered::Frames(0) if since.elapsed() > SILENT => {
                    let seconds = SILENT.as_secs();
                    return Err(RecordError::Silent { seconds });
                }
                Delivered::Frames(0) => {}
                Delivered::Frames(frames) => break frames,
                Delivered::End => return Err(self.ended()),
            }
        };
        self.read += frames as u64;
        let now_s = self.now_s();
        if let Some(tracker) = &mut self.tracker {
            tracker.poll(now_s, &mut self.rows)?;
        }
        Ok(self.signals.values(&self.samples[..frames * width]))
    }

    fn ended(&self) -> RecordError {
        RecordError::Ended {
            after_s: 0.0,
            seconds: self.take_s,
            kept: None,
        }
    }
}

/// The mean of the newest values.
struct RunningMean {
    newest: VecDeque<f64>,
    most: usize,
}

impl RunningMean {
    fn new(most: usize) -> Self {
        Self {
            newest: VecDeque::with_capacity(most),
            most,
        }
    }

    fn take(&mut self, values: &[f64]) {
        let values = &values[values.len().saturating_sub(self.most)..];
        let surplus = (self.newest.len() + values.len()).saturating_sub(self.most);
        self.newest.drain(..surplus);
        self.newest.extend(values);
    }

    fn mean(&self) -> f64 {
        self.newest.iter().sum::<f64>() / self.newest.len().max(1) as f64
    }
}
