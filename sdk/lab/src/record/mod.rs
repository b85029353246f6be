//! Recordings under guidance: a source is sampled, converted to newtons, kept on disk while it
//! grows, and judged against its target.
//!
//! A take is recorded into a part file, to which each second is appended and flushed to disk: a
//! program that is killed loses the current second at most, and [`recover`] makes a recording of
//! the rest. A complete take is judged ([`judge`]): if the mean, minimum or maximum of speed or
//! force differs from its target by more than the tolerance (10 % in the paper, Supplementary,
//! "Texture recording"), it is set aside and recorded again; so is one of which too little slides
//! on target, or which has too few sweeps ([`Required`]). Results are files that `htex fit` reads,
//! and JSON beside them.
//!
//! From a finger to a recording:
//!
//! 1. A [`htex_device::Source`] delivers frames of its channels: a card, a sound card, a library,
//!    or a file ([`Replay`]).
//! 2. `signals`: six-axis calibration, the column map, tare; a tracker ([`TrackerRows`]) has a
//!    clock of its own.
//! 3. [`PartFile`]: a take grows in a file of hashed chunks. The same function (`finish`) makes
//!    recordings of takes that are complete, that ended in an error and that a killed program left.
//! 4. [`judge`]: speed and force over the segments that a fit would read, against the target. JSON
//!    beside a take says how it is read, to `htex compare`, `htex process` and the export of
//!    studies.
//! 5. `guide`: what guides the finger, for each block: phase, force, position, samples. `live` has
//!    the newest 0.4 s. The terminal draws a moment; a page only stores it, and the thread of its
//!    server computes the spectrum of a copy when the page asks.

mod beside;
mod calibration;
mod coverage;
mod data;
mod error;
mod finish;
mod format;
mod guide;
mod judge;
mod kept;
mod live;
mod names;
mod page;
mod part;
mod phases;
mod reader;
mod replay;
mod session;
mod setup;
mod signals;
mod tracker;
mod write;

pub use beside::KnownTake;
pub(crate) use beside::{header as header_beside, settings as settings_of};
pub use calibration::{AXES, Calibration};
pub use coverage::{Coverage, Required};
pub use data::{TakeData, TakeHeader, take_schema};
pub use error::RecordError;
pub use finish::{Recorded, recover};
pub use format::{Format, Outcome};
pub use guide::{Force, Guidance, Moment, Phase};
pub use judge::{Measured, Verdict, judge};
pub use kept::kept_spectrum;
pub use live::{LiveSignal, LiveSpectrum};
pub use page::GuidePage;
pub use part::{PartFile, read_part};
pub use phases::Next;
pub(crate) use reader::{Inputs, Reader};
pub use replay::Replay;
pub use session::Session;
pub use setup::{Setup, Tare};
pub use signals::Signals;
pub use tracker::{LineTracker, TableTracker, TrackerRows};
pub(crate) use write::write_signals;
