//! Entries that every asset has.

/// Name of the entry that identifies an asset.
pub(crate) const MIMETYPE: &str = "mimetype";
/// Contents of that entry.
pub(crate) const MEDIA_TYPE: &str = "application/vnd.htex+zip";
pub(crate) const MANIFEST: &str = "manifest.json";
