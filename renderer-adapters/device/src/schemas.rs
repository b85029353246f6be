//! The JSON Schemas of the documents that cross the ABI.

use htex_base::schema::crossing;
use serde_json::Value;

use crate::{Capabilities, Descriptor, Endpoint, SourceDescriptor, SourceStream};

/// Returns the files of `spec/schemas` that this crate generates, with their schemas.
pub fn schemas() -> [(&'static str, Value); 3] {
    let [descriptor, capabilities, endpoints] =
        ["device-descriptor-1.json", "device-capabilities-1.json", "device-endpoints-1.json"];
    let connected = "devices that are connected, ABI 1";
    [
        (descriptor, crossing::<Descriptor>(descriptor, "descriptor of a device, ABI 1")),
        (capabilities, crossing::<Capabilities>(capabilities, "capabilities of a device, ABI 1")),
        (endpoints, crossing::<Vec<Endpoint>>(endpoints, connected)),
    ]
}

/// Returns the schemas of sources, like [`schemas`]. The endpoints of sources have the schema of
/// devices.
pub fn source_schemas() -> [(&'static str, Value); 2] {
    let [descriptor, stream] = ["source-descriptor-1.json", "source-stream-1.json"];
    [
        (descriptor, crossing::<SourceDescriptor>(descriptor, "descriptor of a source, ABI 1")),
        (stream, crossing::<SourceStream>(stream, "rate and channels of an open source, ABI 1")),
    ]
}
