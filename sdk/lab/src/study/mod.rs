//! Rating studies: people feel textures through a device and rate each trial.
//!
//! A study is described by a file, `study.toml` ([`Study`]). Its [`Plan`] is a function of that
//! file: the order of every participant. A [`Session`] takes one participant through the plan and
//! appends each answer to a file before the next trial begins. Everything else is computed again
//! from these files, such as the table of ratings ([`export`]).
//!
//! The defaults are those of the study in the paper (Methods, "Experiment"): 14 participants, five
//! models, five repetitions, trials of 10 s, training, gain matching with AR, and similarity from 0
//! "Different" to 6 "Same". One thing differs: the paper starts at the maximum voltage, and here
//! each texture starts weak and rises until the participant feels it.
//!
//! From a study to ratings:
//!
//! 1. `read`, `check`: `study.toml`, and what it names. Problems are findings, those of motion,
//!    device and assets by the rules of scenes.
//! 2. `plan`: the order of every participant, a function of the file alone.
//! 3. `session`: one participant on the way through the plan. `progress` is computed by the same
//!    function whether lines are read or recorded; `log` appends a line and syncs it.
//! 4. `run`: what is played, shown and asked, over three traits: a rig (renderer and device), an
//!    asker (terminal, or a page), a clock. `felt` records a source while a trial plays, with the
//!    reader and the writer of guided recordings.
//! 5. `export`: the table of all participants; `felt_spectra`: that of what they felt.

mod asking;
mod check;
mod date;
mod error;
mod export;
mod felt;
mod felt_spectra;
mod file;
mod gain;
mod header;
mod lines;
mod log;
mod meter;
mod order;
mod page;
mod plan;
mod progress;
mod random;
mod read;
mod rules;
mod run;
mod session;
mod simulated;
mod stimulus;

pub use asking::{Asker, Clock, Key, Played, Rig, View};
pub use date::utc;
pub use error::StudyError;
pub use export::{Export, OffTarget, export};
pub use felt::{Felt, FeltSetup, OpenSource};
pub use felt_spectra::{FeltSpectra, Reference, felt_spectra};
pub use file::{
    Attribute, GainMethod, MaskingNoise, Matching, Order, Participants, Phase, Rests, Scale, Study,
    Texture, Training, VERSION,
};
pub use gain::{GainKey, Match};
pub use lines::{
    Answer, Began, DeviceUsed, FeltFile, Header, Line, Matched, OutputLevels, Rise, Simulated,
    SourceUsed, StopReason, Stopped, answers_schema,
};
pub use log::{Log, participant_file};
pub use meter::Meter;
pub use page::{Page, PageOptions, Touch, Touched};
pub use plan::{ParticipantPlan, Plan, Trial};
pub use progress::Step;
pub use read::{check_files, files_of, read_study, study_schema};
pub use rules::{RULES, findings_page};
pub use run::{Ended, run};
pub use session::{Presented, Session};
pub use simulated::SimulatedParticipant;
pub use stimulus::{Stimulus, full_drive, scene_of, set_gain};
