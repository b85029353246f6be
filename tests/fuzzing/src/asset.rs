//! A whole `.htex` file.

use htex_format::{Asset, Limits, validate};

use crate::container::with_checksums;
use crate::promise;

/// Smaller than the defaults, so that short inputs reach slow paths.
const LIMITS: Limits = Limits {
    file_bytes: 1 << 20,
    entries: 256,
    entry_bytes: 1 << 20,
    total_bytes: 1 << 20,
    ratio: 200,
    json_depth: 32,
    json_nodes: 1 << 16,
    conditions: 1 << 10,
    values: 1 << 16,
};

/// Opens the bytes unchanged, and again with valid checksums.
pub fn open_asset(input: &[u8]) -> bool {
    let mended = with_checksums(input);
    let opened = open(input);
    (mended != input && open(&mended)) || opened
}

/// Validates, opens, plays and writes the asset. Other targets cover embedded models.
pub(crate) fn open(bytes: &[u8]) -> bool {
    let report = validate(bytes, &LIMITS);
    promise::findings(&report.findings);
    match Asset::from_bytes_with(bytes, &LIMITS) {
        Ok(asset) => {
            assert!(report.valid, "opens, and is not valid: {report:?}");
            promise::round_trip(&asset);
            promise::play(&htex::Texture::new(asset));
            true
        }
        Err(error) => {
            assert!(!report.valid, "valid, and does not open: {error}");
            promise::sentence(&error);
            false
        }
    }
}
