//! An extension of assets. It stores the contents of a model file that are not needed to play the
//! texture.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::texture::Texture;

/// The extension's name in an asset.
pub const EXTENSION: &str = htex_format::HATT;

/// Numbers from a model file of the Penn Haptic Texture Toolkit. A player of the texture does not
/// need these numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Hatt {
    /// Number of the texture in the toolkit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texture: Option<u32>,
    /// Coefficient of kinetic friction between tool and surface: a ratio of forces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_coefficient: Option<f64>,
    /// Rate at which the toolkit runs its filters, hertz.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub sample_rate_hz: f64,
    /// Highest speed of the toolkit's renderer, mm/s. The renderer treats all higher speeds like
    /// this speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_speed_mm_s: Option<f64>,
    /// Largest force of the toolkit's renderer, newtons. The renderer treats all larger forces like
    /// this force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_force_n: Option<f64>,
}

impl Hatt {
    pub(super) fn new(texture: &Texture) -> Self {
        Self {
            texture: texture.number,
            friction_coefficient: texture.friction,
            sample_rate_hz: texture.rate_hz,
            max_speed_mm_s: texture.max_speed_mm_s,
            max_force_n: texture.max_force_n,
        }
    }
}

/// Returns the JSON Schema of the extension: `spec/schemas/hatt-1.json`.
pub fn extension_schema() -> Value {
    let title = "extension org.htex.hatt/1 of htex assets";
    htex_base::schema::document::<Hatt>("hatt-1.json", title)
}
