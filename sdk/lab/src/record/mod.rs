//! Guided recordings: reads a source, converts it to newtons, saves it to disk while it grows, and
//! judges it against its target.
//!
//! A take is recorded into a part file. Each second is appended and flushed to disk, so a program
//! that is killed loses at most the current second, and [`recover`] turns the rest into a
//! recording. A complete take is judged ([`judge`]). It is set aside and recorded again if the
//! mean, minimum or maximum of speed or force differs from its target by more than the tolerance
//! (10 % in the paper, Supplementary, "Texture recording"). The same happens if the finger slides
//! on target for too short a time, or if there are too few sweeps ([`Requirements`]). The results are
//! files that `htex fit` reads, with JSON next to them.
//!
//! From a finger to a recording:
//!
//! 1. A [`htex_device::Input`] delivers frames of its channels: a card, a sound card, a library,
//!    or a file ([`Replay`]).
//! 2. `signals` applies the six-axis calibration, the column map and the tare. A tracker
//!    ([`TrackerRows`]) has its own clock.
//! 3. [`PartFile`]: a take grows in a file of hashed chunks. The same function (`finish`) makes
//!    recordings of takes that are complete, that ended in an error, or that a killed program left.
//! 4. [`judge`] compares speed and force over the segments that a fit would read with the target.
//!    The JSON next to a take tells `htex compare`, `htex process` and the export of studies how to
//!    read it.
//! 5. `guide` holds what guides the finger, for each block: phase, force, position, samples. `live`
//!    holds the newest 0.4 s. The terminal draws each moment. A page only stores it, and the thread
//!    of its server computes the spectrum from a copy when the page asks.

mod calibration;
mod coverage;
mod data;
mod files;
mod finish;
mod guide;
mod judge;
mod live;
mod page;
mod part;
mod reader;
mod replay;
mod session;
mod setup;
mod signals;
mod stored;
mod tracker;
mod write;

pub use calibration::Calibration;
pub use coverage::{Coverage, Requirements};
pub use data::{TakeData, TakeHeader, take_schema};
pub use files::{Format, Outcome};
pub use finish::{TakeReport, recover};
pub use guide::{Force, Guidance, Moment, Phase};
pub use judge::{MeanRange, Verdict, judge};
pub use live::{LiveSignal, LiveSpectrum};
pub use page::GuidePage;
pub use part::{PartFile, read_part};
pub use reader::Next;
pub(crate) use reader::{Inputs, Reader};
pub use replay::Replay;
pub use session::Session;
pub use setup::{Setup, Tare};
pub use signals::Signals;
pub use stored::KnownTake;
pub(crate) use stored::{header as header_beside, settings as settings_of};
pub use tracker::{LineTracker, TableTracker, TrackerRows};
pub(crate) use write::write_signals;
