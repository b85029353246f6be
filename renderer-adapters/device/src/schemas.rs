//! JSON Schemas of what crosses the ABI as JSON.

use serde_json::Value;

use crate::{Capabilities, Descriptor, Endpoint};

/// The files of `spec/schemas` that this crate makes, and what stands in them.
pub fn schemas() -> [(&'static str, Value); 3] {
    let titled = |title: &str, schema: schemars::Schema| {
        let mut schema = schema.to_value();
        if let Some(object) = schema.as_object_mut() {
            object.insert("title".to_owned(), title.into());
        }
        schema
    };
    [
        (
            "device-descriptor-1.json",
            titled(
                "descriptor of a device, ABI 1",
                schemars::schema_for!(Descriptor),
            ),
        ),
        (
            "device-capabilities-1.json",
            titled(
                "capabilities of a device, ABI 1",
                schemars::schema_for!(Capabilities),
            ),
        ),
        (
            "device-endpoints-1.json",
            titled(
                "devices that are connected, ABI 1",
                schemars::schema_for!(Vec<Endpoint>),
            ),
        ),
    ]
}
