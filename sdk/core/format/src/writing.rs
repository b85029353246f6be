//! Writes assets as `.htex` files.

use std::path::Path;

use crate::archive::{MANIFEST, MEDIA_TYPE, MIMETYPE};
use crate::check_manifest::check_manifest;
use crate::check_manifest::grid_points;
use crate::limits::Limits;
use crate::table::write_tables;
use crate::validate::inspect;
use crate::zip_writer::ZipWriter;
use crate::{Asset, WriteError, block, write_file};
use htex_base::finding::Findings;

impl Asset {
    /// Encodes the asset as a `.htex` file. Equal assets give equal bytes on every machine.
    ///
    /// Levels are rounded to nine significant digits. Measures of agreement are rounded to four
    /// decimals; if the asset is coded, measures in decibels are rounded to two
    /// ([`crate::Manifest::rounded`]). Parameters are rounded to values that their fields can store
    /// ([`crate::round_parameters`]).
    ///
    /// # Errors
    /// Returns an error if the asset breaks a rule of the format, exceeds the default [`Limits`],
    /// or has parameters that its fields cannot store.
    pub fn to_bytes(&self) -> Result<Vec<u8>, WriteError> {
        let manifest = self.manifest.rounded();
        let mut findings = Findings::default();
        // The reader below also checks the manifest, but the encoders before it need a valid
        // manifest.
        check_manifest(&manifest, &mut findings);
        if findings.has_errors() {
            let findings = findings.into_list();
            return Err(WriteError::Invalid { findings });
        }
        let json = if manifest.is_coded() {
            let mut json = serde_json::to_value(&manifest).map_err(archive_error)?;
            write_tables(&mut json);
            serde_json::to_vec(&json)
        } else {
            serde_json::to_vec(&manifest)
        };
        let json = json.map_err(archive_error)?;
        let blocks = self.blocks()?;
        let reference = self.reference_entry()?;
        count("plugins", manifest.plugins.len(), self.plugins.len())?;
        let plugins = manifest.plugins.iter().zip(&self.plugins);
        let archived = || {
            let mut archive = ZipWriter::default();
            // This entry is the first and is not compressed, so that the media type is at byte 38,
            // where programs look for it. Before it come 30 bytes of header and the 8 letters of
            // the name.
            archive.store(MIMETYPE, MEDIA_TYPE.as_bytes())?;
            archive.deflate(MANIFEST, &json)?;
            for (name, bytes) in blocks.into_iter().chain(reference) {
                archive.store(name, &bytes)?;
            }
            for (plugin, module) in plugins {
                archive.deflate(&plugin.file, module)?;
            }
            archive.finish()
        };
        readable(archived().map_err(archive_error)?)
    }

    /// Writes the asset to a file atomically: a reader sees either the old file or the new one.
    ///
    /// # Errors
    /// Returns [`WriteError::Io`] if the file cannot be written, and the errors of
    /// [`Self::to_bytes`].
    #[allow(clippy::disallowed_methods, reason = "the user named this file")]
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_file(path, &self.to_bytes()?)
            .map_err(|error| WriteError::Io { path: path.to_owned(), error })
    }

    fn blocks(&self) -> Result<Vec<(&str, Vec<u8>)>, WriteError> {
        let stored = &self.manifest.representations;
        count("parameters by representation", stored.len(), self.parameters.len())?;
        let pairs = stored.iter().zip(&self.parameters);
        pairs
            .map(|(stored, flats)| {
                let what = format!("parameters of {} by condition", stored.model);
                count(&what, stored.at.len(), flats.len())?;
                Ok((stored.parameters.as_str(), block::encode(&stored.fields, flats)?))
            })
            .collect()
    }

    fn reference_entry(&self) -> Result<Option<(&str, Vec<u8>)>, WriteError> {
        let named = self.manifest.reference.as_ref();
        let given = self.reference.as_ref();
        count("references", named.iter().len(), given.iter().len())?;
        let Some((named, spectra)) = named.zip(given) else {
            return Ok(None);
        };
        count("reference spectra by condition", self.manifest.conditions.len(), spectra.len())?;
        let points = grid_points(self.manifest.band).unwrap_or(0);
        for spectrum in spectra {
            count("magnitudes of a reference spectrum", points, spectrum.len())?;
        }
        let bytes = spectra.iter().flatten().flat_map(|m| m.to_le_bytes()).collect();
        Ok(Some((&named.file, bytes)))
    }
}

/// Returns the bytes if the reader accepts them. This ensures that every written file is valid.
fn readable(bytes: Vec<u8>) -> Result<Vec<u8>, WriteError> {
    match inspect(&bytes, &Limits::default(), &|_| None) {
        (Some(_), _) => Ok(bytes),
        (None, findings) => Err(WriteError::Invalid { findings }),
    }
}

fn count(what: &str, expected: usize, got: usize) -> Result<(), WriteError> {
    if expected == got {
        return Ok(());
    }
    Err(WriteError::Count { what: what.to_owned(), expected, got })
}

fn archive_error(error: impl std::fmt::Display) -> WriteError {
    WriteError::Archive { problem: error.to_string() }
}
