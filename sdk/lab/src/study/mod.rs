//! Rating studies: people feel textures through a device and rate each trial.
//!
//! The file `study.toml` describes a study ([`Study`]). This file determines the [`Plan`], which is
//! the order of trials for every participant. A [`Session`] takes one participant through the plan
//! and appends each answer to a file before the next trial begins. htex computes everything else,
//! such as the table of ratings ([`export`]), from `study.toml` and the files of answers.
//!
//! The defaults come from the study in the paper (Methods, "Experiment"): 14 participants, five
//! models, five repetitions, trials of 10 s, training, gain matching with AR, and similarity from 0
//! "Different" to 6 "Same". There is one difference: in the paper, textures started at the maximum
//! voltage. Here each texture starts weak, and its level rises until the participant feels the
//! texture.
//!
//! From a study to ratings:
//!
//! 1. `read`: reads `study.toml` and checks the files that `study.toml` names. Problems become
//!    findings. The rules for scenes also apply to a study's motion, device and assets.
//! 2. `plan`: computes the order of trials for every participant, using only `study.toml`.
//! 3. `session`: takes one participant through the plan. The same function updates the `progress`
//!    for lines that were read from the file and for lines that were just recorded. `log` appends a
//!    line to the file and flushes the line to disk.
//! 4. `run`: plays trials, shows views and asks questions, through three traits: a rig (renderer
//!    and device), an asker (terminal or page) and a clock. `felt` records the signal of a sensor
//!    while a trial plays. The code that reads the signal and writes the recording is the same as
//!    for guided recordings.
//! 5. `export`: makes the table of all ratings. `felt_spectra`: makes the table with the spectra of
//!    the felt forces.

mod asking;
mod date;
mod export;
mod felt;
mod felt_spectra;
mod file;
mod gain;
mod lines;
mod log;
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

pub use asking::{Asker, Clock, Key, Playback, Rig, View};
pub use date::utc;
pub use export::{Export, OffTarget, export};
pub use felt::{Felt, FeltSetup, OpenSource};
pub use felt_spectra::{FeltSpectra, Reference, felt_spectra};
pub use file::{
    Attribute, GainMethod, MaskingNoise, Matching, Order, Participants, Phase, Rests, Scale, Study,
    Texture, Training, VERSION,
};
pub use gain::{GainKey, Match};
pub use lines::{
    Answer, DeviceUsed, FeltFile, GainPress, Header, Line, OutputLevels, Rise, SessionStart,
    Simulated, SourceUsed, Stop, StopReason, answers_schema,
};
pub use log::{Log, participant_file};
pub use page::{Page, PageOptions, Touch, TouchMotion};
pub use plan::{ParticipantPlan, Plan, Trial};
pub use progress::Step;
pub use read::{check_files, read_study, study_schema};
pub use rules::{RULES, findings_page};
pub use run::{SessionEnd, run};
pub use session::{Presentation, Session};
pub use simulated::SimulatedParticipant;
pub use stimulus::{Meter, Stimulus, full_drive, scene_of, set_gain};
