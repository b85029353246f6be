//! Writing assets as `.htex` files.

use std::io::{Cursor, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

use crate::check_manifest::check_manifest;
use crate::check_manifest::grid_points;
use crate::entries::{MANIFEST, MEDIA_TYPE, MIMETYPE};
use crate::limits::Limits;
use crate::validate::inspect;
use crate::{Asset, WriteError, block, write_file};
use htex_finding::Findings;

/// zlib-rs chooses the same matches on every processor, so the bytes are the same everywhere.
/// Zopfli takes 100 ms for an asset and saves five bytes.
const DEFLATE_LEVEL: i64 = 9;

impl Asset {
    /// Encodes the asset as a `.htex` file. Equal assets give equal bytes on every machine.
    ///
    /// Levels keep nine significant digits, agreement four decimals
    /// ([`crate::Manifest::rounded`]), and parameters what their store keeps
    /// ([`crate::round_parameters`]).
    ///
    /// # Errors
    /// When the asset breaks a rule of the format, exceeds the default [`Limits`], or has
    /// parameters that its fields cannot hold.
    pub fn to_bytes(&self) -> Result<Vec<u8>, WriteError> {
        let manifest = self.manifest.rounded();
        let mut findings = Findings::default();
        check_manifest(&manifest, &mut findings);
        if findings.has_errors() {
            let findings = findings.into_list();
            return Err(WriteError::Invalid { findings });
        }
        let json = serde_json::to_vec(&manifest).map_err(archive_error)?;
        let mut archive = Writer::new();
        archive.add(MIMETYPE, MEDIA_TYPE.as_bytes(), CompressionMethod::Stored)?;
        archive.add(MANIFEST, &json, CompressionMethod::Deflated)?;
        for (name, bytes) in self.blocks()? {
            archive.add(name, &bytes, CompressionMethod::Stored)?;
        }
        if let Some((name, bytes)) = self.reference_entry()? {
            archive.add(name, &bytes, CompressionMethod::Stored)?;
        }
        count("plugins", manifest.plugins.len(), self.plugins.len())?;
        for (plugin, module) in manifest.plugins.iter().zip(&self.plugins) {
            archive.add(&plugin.file, module, CompressionMethod::Deflated)?;
        }
        readable(archive.finish()?)
    }

    /// Writes the asset to a file atomically: a reader sees the old file or the new one.
    ///
    /// # Errors
    /// [`WriteError::Io`] when the file cannot be written, else as [`Self::to_bytes`].
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_file(path, &self.to_bytes()?).map_err(|error| WriteError::Io {
            path: path.to_owned(),
            error,
        })
    }

    fn blocks(&self) -> Result<Vec<(&str, Vec<u8>)>, WriteError> {
        let stored = &self.manifest.representations;
        count(
            "parameters by representation",
            stored.len(),
            self.parameters.len(),
        )?;
        let pairs = stored.iter().zip(&self.parameters);
        pairs
            .map(|(stored, flats)| {
                let what = format!("parameters of {} by condition", stored.model);
                count(&what, stored.at.len(), flats.len())?;
                Ok((
                    stored.parameters.as_str(),
                    block::encode(&stored.fields, flats)?,
                ))
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
        count(
            "reference spectra by condition",
            self.manifest.conditions.len(),
            spectra.len(),
        )?;
        let points = grid_points(self.manifest.band).unwrap_or(0);
        for spectrum in spectra {
            count("magnitudes of a reference spectrum", points, spectrum.len())?;
        }
        let bytes = spectra
            .iter()
            .flatten()
            .flat_map(|m| m.to_le_bytes())
            .collect();
        Ok(Some((&named.file, bytes)))
    }
}

/// Returns the bytes if the reader accepts them: everything that is written is valid.
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
    Err(WriteError::Count {
        what: what.to_owned(),
        expected,
        got,
    })
}

fn archive_error(error: impl std::fmt::Display) -> WriteError {
    WriteError::Archive {
        problem: error.to_string(),
    }
}

struct Writer(ZipWriter<Cursor<Vec<u8>>>);

impl Writer {
    fn new() -> Self {
        Self(ZipWriter::new(Cursor::new(Vec::new())))
    }

    fn add(
        &mut self,
        name: &str,
        bytes: &[u8],
        method: CompressionMethod,
    ) -> Result<(), WriteError> {
        let level = (method == CompressionMethod::Deflated).then_some(DEFLATE_LEVEL);
        let options = SimpleFileOptions::default()
            .compression_method(method)
            .compression_level(level)
            .last_modified_time(DateTime::default())
            .system(System::Unix)
            .unix_permissions(0o644);
        self.0.start_file(name, options).map_err(archive_error)?;
        self.0.write_all(bytes).map_err(archive_error)
    }

    fn finish(self) -> Result<Vec<u8>, WriteError> {
        Ok(self.0.finish().map_err(archive_error)?.into_inner())
    }
}
