//! The JSON Schemas of the documents that host and library exchange through the ABI.

use htex_base::schema::crossing;
use serde_json::Value;

use crate::{Capabilities, Descriptor, Endpoint, InputStream};

/// Returns the files of `spec/schemas` that this crate generates, with their schemas.
pub fn schemas() -> [(&'static str, Value); 4] {
    let [descriptor, capabilities, endpoints, stream] = [
        "device-descriptor-1.json",
        "device-capabilities-1.json",
        "device-endpoints-1.json",
        "device-stream-1.json",
    ];
    let connected = "devices that are connected, ABI 1";
    [
        (descriptor, crossing::<Descriptor>(descriptor, "descriptor of a device, ABI 1")),
        (capabilities, crossing::<Capabilities>(capabilities, "capabilities of an output, ABI 1")),
        (endpoints, crossing::<Vec<Endpoint>>(endpoints, connected)),
        (stream, crossing::<InputStream>(stream, "rate and channels of an open input, ABI 1")),
    ]
}
