//! Generates the schemas of `spec/schemas` that this crate defines.

use serde_json::Value;

use crate::{Gains, SceneFile};

/// Returns the JSON Schema of version 1.0 scenes: `spec/schemas/scene-1.json`.
pub fn scene_schema() -> Value {
    htex_base::schema::document::<SceneFile>("scene-1.json", "Scene of htex 1")
}

/// Returns the JSON Schema of gains files: `spec/schemas/gains-1.json`.
pub fn gains_schema() -> Value {
    htex_base::schema::crossing::<Gains>("gains-1.json", "gains of persons of htex 1")
}
