//! A chain of stages, with counts and times for each stage.
//!
//! Each stage requests the samples that it needs from the stage before it. Therefore, a rate
//! converter needs no special treatment, and the samples are the same for all block sizes.

use std::time::Instant;

use serde::Serialize;

use super::{Context, Stage, Statistics};

/// A stage of a chain with its statistics.
pub(crate) struct Slot {
    name: &'static str,
    surface: Option<usize>,
    stage: Box<dyn Stage>,
    blocks: u64,
    ns: u64,
}

/// Statistics of a stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageRun {
    pub name: &'static str,
    /// The surface that the stage belongs to. `None` for all surfaces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<usize>,
    /// Number of blocks that the stage processed.
    pub blocks: u64,
    /// Run time, nanoseconds per sample of the device. `None` if not measured.
    pub ns_per_sample: Option<f64>,
}

impl Slot {
    pub(crate) fn new(name: &'static str, surface: Option<usize>, stage: Box<dyn Stage>) -> Self {
        Self { name, surface, stage, blocks: 0, ns: 0 }
    }

    pub(crate) fn follow(&mut self, context: &Context) {
        self.stage.follow(context);
    }

    /// Runs the stage. Its time excludes the time of its source.
    pub(crate) fn render(
        &mut self,
        timed: bool,
        out: &mut [f32],
        source: &mut dyn FnMut(&mut [f32]),
    ) {
        self.blocks += 1;
        if !timed {
            return self.stage.render(out, source);
        }
        let (start, mut before) = (Instant::now(), 0);
        self.stage.render(out, &mut |block| {
            let start = Instant::now();
            source(block);
            before += start.elapsed().as_nanos() as u64;
        });
        self.ns += (start.elapsed().as_nanos() as u64).saturating_sub(before);
    }

    pub(crate) fn count(&self, statistics: &mut Statistics) {
        self.stage.count(statistics);
    }

    /// Returns the stage's statistics after rendering. They include the time if `timed_frames`
    /// gives the number of frames.
    pub(crate) fn run(&self, timed_frames: Option<u64>) -> StageRun {
        StageRun {
            name: self.name,
            surface: self.surface,
            blocks: self.blocks,
            ns_per_sample: timed_frames.map(|frames| self.ns as f64 / frames.max(1) as f64),
        }
    }
}

/// A chain of stages. The last stage produces the output.
#[derive(Default)]
pub(crate) struct Chain {
    pub(crate) slots: Vec<Slot>,
}

impl Chain {
    pub(crate) fn follow(&mut self, context: &Context) {
        self.slots.iter_mut().for_each(|slot| slot.follow(context));
    }

    pub(crate) fn render(
        &mut self,
        timed: bool,
        out: &mut [f32],
        source: &mut dyn FnMut(&mut [f32]),
    ) {
        run(&mut self.slots, timed, out, source);
    }
}

/// Runs the last stage, which pulls from the stages before it.
fn run(slots: &mut [Slot], timed: bool, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
    match slots.split_last_mut() {
        None => source(out),
        Some((last, before)) => last.render(timed, out, &mut |block| {
            run(before, timed, block, source);
        }),
    }
}
