//! Guided recordings: reads the signals of a source, converts them to newtons, saves them to disk
//! at once, and judges each recording (a take) against its target.
//!
//! A take is recorded into a part file. Each full second of samples is appended to this file and
//! flushed to disk. Therefore, a program that is killed loses at most the current second, and
//! [`recover`] converts the contents of the part file to a recording. A complete take is judged
//! ([`judge`]). The session sets a take aside and records it again if the speed or the force is off
//! target: its mean, minimum or maximum differs from the target by more than the tolerance. In the
//! paper (`docs/paper.md`), the tolerance is 10 % (Supplementary, "Texture recording"). The session
//! also sets a take aside if the finger slides close to its target speed and force for too short a
//! time, or if there are too few sweeps ([`Requirements`]). The results are recordings that `htex
//! fit` reads, each with a JSON file.
//!
//! From a finger to a recording:
//!
//! 1. A [`htex_device::Input`] delivers frames of its channels. It gets them from a data
//!    acquisition card, a sound card, a library, or a file ([`Replay`]).
//! 2. `signals` converts these frames to forces: it applies the six-axis calibration, the column
//!    map and the tare. A tracker ([`TrackerRows`]) has its own sample rate.
//! 3. During a take, its samples are appended to a [`PartFile`], a file of chunks with hashes. The
//!    function `finish` makes a recording from every part file: from a complete take, from a take
//!    that ended with an error, and from a take of a program that was killed.
//! 4. [`judge`] compares speed and force with their targets, over the segments that a fit would
//!    read. The JSON next to a take tells `htex compare`, `htex process` and the export of studies
//!    how to read the take.
//! 5. `guide` defines the state that guides the finger: phase, force, position and new samples. The
//!    session updates this state with each block. `live` stores the newest 0.4 s of the signal. The
//!    terminal draws each state. For the web page, the session only stores the newest state. When
//!    the page requests this state, the thread of the page's server computes the spectrum from a
//!    copy of the signal.

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
