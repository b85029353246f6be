//! The device ABI is frozen: Rust side, C header and the frozen listing agree.

use htex_device::abi::{
    ABI_MAJOR, ABI_MARKER, ABI_MINOR, MAX_BLOCK_FRAMES, MAX_CHANNELS, MAX_NAME_BYTES, MAX_RATE_HZ,
    MAX_SETTINGS, MAX_TEXT_BYTES, MIN_INPUT_RATE_HZ, MIN_RATE_HZ, STATUS_FRAMES_PLAYED,
    STATUS_FRAMES_WRITTEN, STATUS_LATENCY_S, STATUS_NUMBERS, STATUS_PEAK, STATUS_UNDERRUNS,
};
use htex_tests::surface::{Constants, DEVICE};

/// FNV-1a hash of the listing of each minor version of this major version, oldest first. New
/// versions only add lines.
const FROZEN: &[(&str, u64)] = &[("1.0", 0xfab1_e58d_cca2_ddb3)];

const THAW: &str = "The surface of the device ABI is frozen: devices that exist were built against it. \
    Take the change back; or, if it only adds a member at the end of the table or a constant, raise ABI_MINOR \
    (HTEX_DEVICE_ABI_MINOR, the marker), add the listing as spec/abi/device-MAJOR.MINOR.txt and its \
    hash to FROZEN. Anything else is a new ABI_MAJOR.";

/// Constants as the compiler sees them.
fn rust_constants() -> Constants {
    let numbers = [
        ("ABI_MAJOR", ABI_MAJOR.to_string()),
        ("ABI_MINOR", ABI_MINOR.to_string()),
        ("ABI_MARKER", format!("{ABI_MARKER:#x}")),
        ("MAX_TEXT_BYTES", MAX_TEXT_BYTES.to_string()),
        ("MAX_SETTINGS", MAX_SETTINGS.to_string()),
        ("MIN_RATE_HZ", format!("{MIN_RATE_HZ:?}")),
        ("MIN_INPUT_RATE_HZ", format!("{MIN_INPUT_RATE_HZ:?}")),
        ("MAX_RATE_HZ", format!("{MAX_RATE_HZ:?}")),
        ("MAX_BLOCK_FRAMES", MAX_BLOCK_FRAMES.to_string()),
        ("MAX_CHANNELS", MAX_CHANNELS.to_string()),
        ("MAX_NAME_BYTES", MAX_NAME_BYTES.to_string()),
        ("STATUS_FRAMES_WRITTEN", STATUS_FRAMES_WRITTEN.to_string()),
        ("STATUS_FRAMES_PLAYED", STATUS_FRAMES_PLAYED.to_string()),
        ("STATUS_UNDERRUNS", STATUS_UNDERRUNS.to_string()),
        ("STATUS_LATENCY_S", STATUS_LATENCY_S.to_string()),
        ("STATUS_PEAK", STATUS_PEAK.to_string()),
        ("STATUS_NUMBERS", STATUS_NUMBERS.to_string()),
    ];
    let named = numbers.map(|(name, value)| (format!("HTEX_DEVICE_{name}"), value));
    named.into_iter().chain(DEVICE.rust_statuses()).collect()
}

#[test]
fn the_surface_is_frozen() {
    let version = format!("{ABI_MAJOR}.{ABI_MINOR}");
    assert_eq!(version, FROZEN.last().unwrap().0, "{THAW}");
    let now = DEVICE.listing(&rust_constants());
    DEVICE.hold_frozen("device", FROZEN, &now, THAW);
}

#[test]
fn header_and_rust_say_the_same() {
    DEVICE.hold_header(&rust_constants());
}

#[test]
fn the_header_compiles_as_c11_and_cxx17() {
    DEVICE.compile(&rust_constants());
}

/// A host must be able to tell the two ABIs apart only by their markers.
#[test]
fn no_marker_of_a_model_is_one_of_a_device() {
    assert_ne!(ABI_MARKER >> 16, htex_model::abi::ABI_MARKER >> 16);
}

#[test]
fn generated_schemas_are_fresh() {
    for (name, schema) in htex_device::schemas() {
        let text = format!("{schema:#}\n");
        xtask::generated::file(format!("spec/schemas/{name}"), text.as_bytes());
    }
}
