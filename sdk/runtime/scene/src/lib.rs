//! Plays scenes: surfaces, a motion, and a device. The planner finds the shortest chain of stages
//! for a scene, and states a reason for every stage that it includes or leaves out. The renderer
//! runs exactly that chain.
//!
//! From a scene to samples:
//!
//! 1. `load` reads the file, its assets, trace and response. Problems become findings.
//! 2. `requirements` simulates the motion as the renderer will play it: which surfaces are touched,
//!    which speeds and forces occur, and what the device needs.
//! 3. `representation` chooses the model of each surface within the budget.
//! 4. `plan` asks each effect in the table (`stages`) whether it is needed. An effect that is not
//!    needed is not built. Each decision has a reason.
//! 5. `render` pulls samples through the chain, from the end to the start: the device's stages, the
//!    resampler, the sum of the surfaces of one rate, the stages of each surface (`track`), and its
//!    voice.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod ahead;
mod beyond;
mod check;
mod cost;
mod device;
mod error;
pub mod file;
mod gains;
mod limits;
mod load;
mod measure;
mod motion;
mod output;
mod page;
mod path;
mod plan;
mod played;
mod render;
mod representation;
mod requirements;
mod response;
mod rules;
mod stages;
mod trace;
mod track;
mod validate;

pub use cost::{Costs, FilterCost};
pub use device::DeviceOverride;
pub use error::{SceneError, SceneErrorKind};
pub use file::SceneFile;
pub use gains::{
    Gain, GainKey, Gains, START_DB, factor_of_db, gains_schema, recordings_of, texture_id,
    texture_name,
};
pub use limits::Limits;
pub use load::{FileSource, Scene, Surroundings, validate};
pub use output::output_name;
pub use page::{findings_page, scene_schema};
pub use plan::{ModelChoice, OmittedEffect, Plan, PlannedStage, plan};
pub use render::Renderer;
pub use response::Response;
pub use rules::RULES;
pub use stages::StageRun;
pub use trace::{Trace, TracePoint};
pub use validate::read_scene;
