//! Runs the phases of a session block by block, and computes what the user sees.

use std::collections::VecDeque;

use htex_author::recording::Role;

use crate::record::data::texture_axes;
use crate::record::error::RecordError;
use crate::record::guide::{FingerPath, Moment, Phase};
use crate::record::reader::{Block, Reader};

pub(crate) type Take<'a> = dyn FnMut(&Block) -> Result<(), RecordError> + 'a;

/// Length of the mean by which the force is shown, seconds. A take is judged by means of the same
/// length.
const FORCE_S: f64 = 0.05;

/// Whether a session continues.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    /// The session continues.
    Go,
    /// The session ends; what was recorded is kept.
    Stop,
}

/// A phase to be read.
pub(crate) struct Span {
    pub(crate) phase: Phase,
    /// Number of the take.
    pub(crate) number: u32,
    /// Its length, seconds.
    pub(crate) of_s: f64,
}

impl Span {
    pub(crate) fn new(phase: Phase, number: u32, of_s: f64) -> Self {
        Self { phase, number, of_s }
    }
}

/// Reads phases and follows the finger.
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
    ) -> Result<(), RecordError> {
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
            // Stored before it is shown, so that a stop does not lose this block.
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
                return Err(RecordError::Left { kept: None });
            }
        }
        Ok(())
    }

    /// Returns the force of the last 50 ms. The sign is dropped, because a sensor or a recording
    /// may count pressing as negative.
    fn force(&mut self, values: &[Vec<f64>]) -> Option<f64> {
        let normal = self.reader.inputs.signals.position(Role::Normal)?;
        self.force.take(&values[normal]);
        Some(self.force.mean().abs())
    }

    /// Returns the finger's position, from the tracker if there is one, else from the source.
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

/// Mean of the newest values.
struct RunningMean {
    newest: VecDeque<f64>,
    most: usize,
}

impl RunningMean {
    fn new(most: usize) -> Self {
        Self { newest: VecDeque::with_capacity(most), most }
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
