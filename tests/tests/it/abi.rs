//! The model ABI is frozen: Rust side, C header and the frozen listing agree.

use htex_model::abi::{
    ABI_MAJOR, ABI_MARKER, ABI_MINOR, ALLOC_ALIGN, GRID_HZ, MAX_BAND_HZ, MAX_FIELDS, MAX_LIST_LEN,
    MAX_PARAMETERS, MAX_RATE_HZ, MAX_TEXT_BYTES, MIN_BINS, MIN_RATE_HZ,
};
use htex_model::motion_1::{MAX_FORCE_N, MAX_POSITION_MM, MAX_SPEED_MM_S};
use htex_model::voices_1::MAX_VOICES;
use htex_tests::surface::{Constants, MODEL, MOTION, Surface, VOICES};
use xtask::generated::file_with;

/// FNV-1a hash of the listing of each minor version of this major version, oldest first. New
/// versions only add lines.
const FROZEN: &[(&str, u64)] = &[("1.0", 0x0ec5_8ff7_62de_0303)];

const THAW: &str = "The surface of the model ABI is frozen: plugins that exist were built against it. \
    Take the change back; or, if it only adds an optional export or a constant, raise ABI_MINOR \
    (HTEX_ABI_MINOR, the marker), add the listing as spec/abi/model-MAJOR.MINOR.txt and its hash \
    to FROZEN. Anything else is a new ABI_MAJOR.";

/// Constants as the compiler sees them.
fn rust_constants() -> Constants {
    let numbers = [
        ("ABI_MAJOR", ABI_MAJOR.to_string()),
        ("ABI_MINOR", ABI_MINOR.to_string()),
        ("ABI_MARKER", format!("{ABI_MARKER:#x}")),
        ("MAX_PARAMETERS", MAX_PARAMETERS.to_string()),
        ("MAX_FIELDS", MAX_FIELDS.to_string()),
        ("MAX_LIST_LEN", MAX_LIST_LEN.to_string()),
        ("MAX_TEXT_BYTES", MAX_TEXT_BYTES.to_string()),
        ("MIN_BINS", MIN_BINS.to_string()),
        ("MAX_BAND_HZ", format!("{MAX_BAND_HZ:?}")),
        ("MIN_RATE_HZ", format!("{MIN_RATE_HZ:?}")),
        ("MAX_RATE_HZ", format!("{MAX_RATE_HZ:?}")),
        ("GRID_HZ", format!("{GRID_HZ:?}")),
        ("ALLOC_ALIGN", ALLOC_ALIGN.to_string()),
    ];
    let named = numbers.map(|(name, value)| (format!("HTEX_{name}"), value));
    named.into_iter().chain(MODEL.rust_statuses()).collect()
}

#[test]
fn the_surface_is_frozen() {
    let version = format!("{ABI_MAJOR}.{ABI_MINOR}");
    assert_eq!(version, FROZEN.last().unwrap().0, "{THAW}");
    let now = MODEL.listing(&rust_constants());
    MODEL.hold_frozen("model", FROZEN, &now, THAW);
}

#[test]
fn header_and_rust_say_the_same() {
    MODEL.hold_header(&rust_constants());
}

#[test]
fn the_extension_for_voices_is_frozen() {
    let constants = [("HTEX_VOICES_1_MAX_VOICES", MAX_VOICES.to_string())];
    hold_extension(&VOICES, "voices", 0xdcb1_d85e_348f_32df, constants);
}

#[test]
fn the_extension_for_motion_is_frozen() {
    let constants = [
        ("HTEX_MOTION_1_MAX_SPEED_MM_S", format!("{MAX_SPEED_MM_S:?}")),
        ("HTEX_MOTION_1_MAX_FORCE_N", format!("{MAX_FORCE_N:?}")),
        ("HTEX_MOTION_1_MAX_POSITION_MM", format!("{MAX_POSITION_MM:?}")),
    ];
    hold_extension(&MOTION, "motion", 0xeb11_2834_3004_91ce, constants);
}

/// Checks revision 1 of an extension: its listing has the hash, and header and Rust side agree.
fn hold_extension<const N: usize>(
    surface: &Surface,
    kind: &str,
    hash: u64,
    constants: [(&str, String); N],
) {
    let constants = constants.map(|(name, value)| (name.to_owned(), value)).into();
    let now = surface.listing(&constants);
    let thaw = "A revision of an extension never changes: make another, htex.NAME/2.";
    surface.hold_frozen(kind, &[("1", hash)], &now, thaw);
    surface.hold_header(&constants);
    surface.compile(&constants);
}

#[test]
fn the_grid_of_the_abi_is_the_grid_of_the_spectra() {
    assert_eq!(GRID_HZ, htex_dsp::GRID_HZ);
}

#[test]
fn the_header_compiles_as_c11_and_cxx17() {
    MODEL.compile(&rust_constants());
}

#[test]
fn generated_descriptor_schema_is_fresh() {
    let schema = htex_model::descriptor_schema();
    let text = format!("{schema:#}\n");
    file_with("spec/schemas/descriptor-1.json", text.as_bytes(), |kept| {
        serde_json::from_slice::<serde_json::Value>(kept).unwrap() == schema
    });
}
