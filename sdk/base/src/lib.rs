//! What the crates of htex share. It knows neither textures nor devices.
//!
//! - [`finding`]: results of validation, with rules, reports and hints.
//! - [`files`]: files that are written whole, and guards for names and folders that somebody else
//!   chose.
//! - `storage`: files by URI. Needs the feature `storage`; web servers and object stores need
//!   `cloud`.
//! - [`schema`]: JSON Schemas made from Rust types, and checks against them.
//! - [`native`]: native libraries, loaded from files or by name.

pub mod files;
pub mod finding;
pub mod native;
pub mod schema;
#[cfg(feature = "storage")]
pub mod storage;
