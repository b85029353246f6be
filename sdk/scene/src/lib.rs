//! Scenes: surfaces, a motion, and a device. The planner finds the shortest chain of stages for a
//! scene and states the reason for each stage that is included or left out; the renderer runs
//! exactly that chain.
//!
//! From a scene to samples:
//!
//! 1. `load`: the file, its assets, trace and response. Problems are findings.
//! 2. `requirements`: the motion, simulated as the renderer will play it: which surfaces are
//!    touched, which speeds and forces occur, what the device needs.
//! 3. `representation`: the model of each surface, by the budget.
//! 4. `plan`: each effect of the table (`stages`) is asked whether it is needed. One that is not is
//!    not built, and each decision has its reason.
//! 5. `render` pulls: stages of the device, resampler, sum of the surfaces of one rate, stages of a
//!    surface (`track`), voice.
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
pub use error::SceneError;
pub use file::Scene;
pub use gains::{
    Gain, GainKey, Gains, START_DB, factor_of_db, gains_schema, recordings_of, texture_id,
    texture_name,
};
pub use limits::Limits;
pub use load::{LoadError, LoadedScene, SceneFiles, Surroundings, validate};
pub use motion::Finger;
pub use output::output_name;
pub use page::{findings_page, scene_schema};
pub use plan::{Chosen, LeftOut, Plan, PlannedStage, plan};
pub use render::Renderer;
pub use response::Response;
pub use rules::RULES;
pub use stages::StageRun;
pub use trace::{Trace, TracePoint};
pub use validate::read_scene;
