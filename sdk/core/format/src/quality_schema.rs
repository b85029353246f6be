//! JSON Schema of `quality` and `left_out`.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Map, Value, json};

use crate::measure::MeasureKind;
use crate::quality::{LeftOut, Quality};
use crate::quality_json::{BAND_COUNT, Content, Entries};

fn schema<T: Entries>() -> Schema {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    let object = T::default();
    for entry in object.entries() {
        let mut property = match entry.content {
            Content::Bands(_) => json!({
                "type": "array", "items": { "type": "number" }, "minItems": BAND_COUNT, "maxItems": BAND_COUNT,
            }),
            Content::Number(_, MeasureKind::Correlation) => {
                json!({ "type": "number", "minimum": -1, "maximum": 1 })
            }
            Content::Number(_, MeasureKind::Error) => {
                json!({ "type": "number", "minimum": 0 })
            }
            Content::Number(..) => json!({ "type": "number" }),
        };
        property["description"] = entry.description.into();
        if entry.required {
            required.push(Value::from(entry.key));
        }
        properties.insert(entry.key.into(), property);
    }
    schemars::json_schema!({
        "type": "object", "description": T::DESCRIPTION, "properties": properties, "required": required,
    })
}

macro_rules! in_schema {
    ($($name:ident)*) => {$(
        impl JsonSchema for $name {
            fn schema_name() -> Cow<'static, str> {
                Self::NAME.into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                schema::<Self>()
            }
        }
    )*};
}

in_schema!(Quality LeftOut);
