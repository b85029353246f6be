//! The source ABI is frozen: Rust side, C header and the frozen listing agree.

use htex_device::source::abi::{
    ABI_MAJOR, ABI_MARKER, ABI_MINOR, MAX_CHANNELS, MAX_NAME_BYTES, MAX_RATE_HZ, MAX_SETTINGS,
    MAX_TEXT_BYTES, MIN_RATE_HZ,
};
use htex_tests::surface::{Constants, SOURCE};

/// FNV-1a hash of the listing of each minor version of this major version, oldest first. New
/// versions only add lines.
const FROZEN: &[(&str, u64)] = &[("1.0", 0x4321_9581_e294_5dc9)];

const THAW: &str = "The surface of the source ABI is frozen: sources that exist were built against it. \
    Take the change back; or, if it only adds an optional export or a constant, raise ABI_MINOR \
    (HTEX_SOURCE_ABI_MINOR, the marker), add the listing as spec/abi/source-MAJOR.MINOR.txt and its \
    hash to FROZEN. Anything else is a new ABI_MAJOR.";

/// Constants as the compiler sees them.
fn rust_constants() -> Constants {
    let numbers = [
        ("ABI_MAJOR", ABI_MAJOR.to_string()),
        ("ABI_MINOR", ABI_MINOR.to_string()),
        ("ABI_MARKER", format!("{ABI_MARKER:#x}")),
        ("MAX_TEXT_BYTES", MAX_TEXT_BYTES.to_string()),
        ("MAX_SETTINGS", MAX_SETTINGS.to_string()),
        ("MAX_CHANNELS", MAX_CHANNELS.to_string()),
        ("MAX_NAME_BYTES", MAX_NAME_BYTES.to_string()),
        ("MIN_RATE_HZ", format!("{MIN_RATE_HZ:?}")),
        ("MAX_RATE_HZ", format!("{MAX_RATE_HZ:?}")),
    ];
    let named = numbers.map(|(name, value)| (format!("HTEX_SOURCE_{name}"), value));
    named.into_iter().chain(SOURCE.rust_statuses()).collect()
}

#[test]
fn the_surface_is_frozen() {
    let version = format!("{ABI_MAJOR}.{ABI_MINOR}");
    assert_eq!(version, FROZEN.last().unwrap().0, "{THAW}");
    let now = SOURCE.listing(&rust_constants());
    SOURCE.hold_frozen("source", FROZEN, &now, THAW);
}

#[test]
fn header_and_rust_say_the_same() {
    SOURCE.hold_header(&rust_constants());
}

#[test]
fn the_header_compiles_as_c11_and_cxx17() {
    SOURCE.compile(&rust_constants());
}

/// A host must be able to tell the ABIs apart only by their markers, and codes that both have are
/// the same.
#[test]
fn a_source_is_not_taken_for_a_device_or_a_model() {
    for other in [htex_device::abi::ABI_MARKER, htex_model::abi::ABI_MARKER] {
        assert_ne!(ABI_MARKER >> 16, other >> 16);
    }
    let devices = htex_tests::surface::DEVICE.rust_statuses();
    let mut alike = 0;
    for (name, value) in SOURCE.rust_statuses() {
        if let Some(of_device) = devices.get(&name.replace("SOURCE", "DEVICE")) {
            assert_eq!(*of_device, value, "{name}");
            alike += 1;
        }
    }
    assert_eq!(alike, 11, "all but Overrun and End");
}

#[test]
fn generated_schemas_are_fresh() {
    for (name, schema) in htex_device::source_schemas() {
        let text = format!("{schema:#}\n");
        xtask::generated::file(format!("spec/schemas/{name}"), text.as_bytes());
    }
}
