//! Scenes: surfaces, a motion, a device. The planner finds the shortest chain of stages that the
//! scene calls for and says why each is in or out; the renderer runs just that chain.
#![forbid(unsafe_code)]

mod check;
mod device;
pub mod file;
mod load;
mod page;
mod response;
mod rules;
mod trace;
mod validate;

pub use device::DeviceOverride;
pub use file::Scene;
pub use load::{LoadError, LoadedScene, Surroundings, validate};
pub use page::{findings_page, scene_schema};
pub use response::Response;
pub use rules::{RULES, explain};
pub use trace::{Trace, TracePoint};
pub use validate::{Limits, read_scene};
