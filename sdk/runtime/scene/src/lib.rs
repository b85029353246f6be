//! Plays scenes. A scene is a file that describes surfaces, a motion and a device. The planner
//! finds the shortest chain of processing stages that plays a scene, and states a reason for every
//! stage that it includes or leaves out. The renderer runs exactly the planned chain.
//!
//! Five modules, in this order, lead from a scene to samples:
//!
//! 1. `load` reads the scene file and the files that the scene names: assets, trace and frequency
//!    response. The module reports problems as findings.
//! 2. `requirements` simulates the motion as the renderer will play it. The simulation determines
//!    which surfaces are touched, which speeds and forces occur, and what the device needs.
//! 3. `representation` chooses the model of each surface within the scene's budget of time and
//!    error.
//! 4. `plan` goes through the table of effects (`stages`) and includes the effects that the scene
//!    needs. A function in the table decides for each effect whether the scene needs it. The plan
//!    gives a reason for each decision.
//! 5. `render` pulls samples through the chain: each stage requests its input from the stage before
//!    it. The chain starts with the voice of each surface and the surface's stages (`track`). The
//!    samples of surfaces with the same sample rate are then added and resampled. The device's
//!    stages come last.
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
#[cfg(feature = "schemars")]
mod schemas;
mod stages;
mod trace;
mod track;
mod validate;

pub use cost::{Costs, FilterCost};
pub use device::DeviceOverride;
pub use error::{SceneError, SceneErrorKind};
pub use file::SceneFile;
pub use gains::{
    Gain, GainKey, Gains, START_DB, factor_of_db, recordings_of, texture_id, texture_name,
};
pub use limits::Limits;
pub use load::{ALLOW_EMBEDDED, FileSource, Scene, Surroundings, validate};
pub use output::output_name;
pub use page::findings_page;
pub use plan::{ModelChoice, OmittedEffect, Plan, PlannedStage, plan};
pub use render::Renderer;
pub use response::Response;
pub use rules::RULES;
#[cfg(feature = "schemars")]
pub use schemas::{gains_schema, scene_schema};
pub use stages::StageRun;
pub use trace::{Trace, TracePoint};
pub use validate::read_scene;
