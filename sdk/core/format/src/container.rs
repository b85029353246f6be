//! Reading assets from `.htex` files.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::archive::too_large;
use crate::limits::Limits;
use crate::rules::FILE_TOO_LARGE;
use crate::signing::{Signers, read_signature};
use crate::validate::inspect;
use crate::{Asset, ReadError, block};
use htex_base::finding::{Finding, Findings};

impl Asset {
    /// Reads an asset from bytes, within the default [`Limits`].
    ///
    /// # Errors
    /// Returns [`ReadError::Invalid`] if one of the findings is an error. The returned error
    /// contains all findings.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        Self::from_bytes_with(bytes, &Limits::default())
    }

    /// Reads an asset from bytes, within the given limits.
    ///
    /// # Errors
    /// Returns the errors of [`Self::from_bytes`].
    pub fn from_bytes_with(bytes: &[u8], limits: &Limits) -> Result<Self, ReadError> {
        Self::from_bytes_with_findings(bytes, limits).map(|(asset, _)| asset)
    }

    /// Reads an asset from bytes, within the given limits. Also returns all findings; none of them
    /// is an error.
    ///
    /// # Errors
    /// Returns the errors of [`Self::from_bytes`].
    pub fn from_bytes_with_findings(
        bytes: &[u8],
        limits: &Limits,
    ) -> Result<(Self, Vec<Finding>), ReadError> {
        match inspect(bytes, limits, &|_| None) {
            (Some(asset), findings) => Ok((asset, findings)),
            (None, findings) => Err(ReadError::Invalid { findings }),
        }
    }

    /// Reads an asset from a file, within the default [`Limits`]. With the feature `library`, the
    /// path `cloth.htexlib#woven/cotton` names the texture `woven/cotton` in the library
    /// `cloth.htexlib`.
    ///
    /// # Errors
    /// Returns [`ReadError::Io`] if the file cannot be read or the library has no such texture, and
    /// the errors of [`Self::from_bytes`].
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let limits = Limits::default();
        #[cfg(feature = "library")]
        if let Some((library, name)) = in_library(path) {
            let bytes = crate::library::Library::open(library)
                .and_then(|library| library.get(name))
                .map_err(|error| ReadError::Io { path: path.to_owned(), error: error.into() })?;
            return Self::from_bytes_with(&bytes, &limits);
        }
        Self::from_bytes_with(&read_capped(path, &limits)?, &limits)
    }

    /// Reads an asset from a file, as [`Self::open`] does, if one of `signers` signed it. The
    /// signature of `oak.htex` is in `oak.htex.sig`. A texture of a library is signed if its library
    /// is. The bytes that are checked are those that are read.
    ///
    /// # Errors
    /// Returns the errors of [`Self::open`], [`ReadError::Signature`] if the file is not signed by
    /// one of `signers`, and [`ReadError::Io`] if its signature cannot be read.
    pub fn open_signed(path: &Path, signers: &Signers) -> Result<Self, ReadError> {
        let signature = read_signature(Self::file_of(path))?;
        #[cfg(feature = "library")]
        if let Some((library, name)) = in_library(path) {
            use crate::library::{Library, LibraryError};
            let read = Library::open(library).and_then(|library| {
                library.check_signed(signature.as_deref(), signers)?;
                library.get(name)
            });
            return match read {
                Ok(bytes) => Self::from_bytes(&bytes),
                Err(LibraryError::Signature(error)) => Err(error.into()),
                Err(error) => Err(ReadError::Io { path: path.to_owned(), error: error.into() }),
            };
        }
        let bytes = read_capped(path, &Limits::default())?;
        Self::from_signed_bytes(&bytes, signature.as_deref(), signers)
    }

    /// Reads an asset from bytes, within the default [`Limits`], if one of `signers` signed it.
    /// `signature` is the contents of the file with the signature, or `None` without such a file.
    ///
    /// # Errors
    /// Returns the errors of [`Self::from_bytes`], and [`ReadError::Signature`] if the bytes are not
    /// signed by one of `signers`.
    pub fn from_signed_bytes(
        bytes: &[u8],
        signature: Option<&[u8]>,
        signers: &Signers,
    ) -> Result<Self, ReadError> {
        signers.read_asset(bytes, signature)
    }

    /// Returns the file that [`Self::open`] reads: the path itself, or the library's file for a
    /// path such as `cloth.htexlib#oak`.
    pub fn file_of(path: &Path) -> &Path {
        in_library(path).map_or(path, |(library, _)| library)
    }

    /// Returns the size of a representation's parameter block as stored, bytes. Returns 0 if there
    /// is no such block.
    pub fn payload_bytes(&self, representation: usize) -> usize {
        let stored = self.manifest.representations.get(representation);
        let block = stored.zip(self.parameters.get(representation));
        let bytes = block.and_then(|(stored, flats)| block::encode(&stored.fields, flats).ok());
        bytes.map_or(0, |bytes| bytes.len())
    }
}

/// Splits the path of a texture in a library.
#[cfg(all(feature = "library", not(target_family = "wasm")))]
fn in_library(path: &Path) -> Option<(&Path, &str)> {
    let (library, name) = path.to_str().and_then(crate::library::split_address)?;
    Some((library.as_ref(), name))
}

/// Programs for the web do not read files, and other programs may be built without the reader of
/// libraries.
#[cfg(not(all(feature = "library", not(target_family = "wasm"))))]
fn in_library(_: &Path) -> Option<(&Path, &str)> {
    None
}

/// Reads a file, but at most one byte more than the limit.
fn read_capped(path: &Path, limits: &Limits) -> Result<Vec<u8>, ReadError> {
    let failed = |error| ReadError::Io { path: path.to_owned(), error };
    let file = File::open(path).map_err(failed)?;
    let stated = file.metadata().map_err(failed)?.len();
    let mut bytes = Vec::new();
    if stated <= limits.file_bytes {
        // A file may grow while it is read, and a pipe does not state its length.
        let most = limits.file_bytes.saturating_add(1);
        file.take(most).read_to_end(&mut bytes).map_err(failed)?;
    }
    let length = stated.max(bytes.len() as u64);
    if length <= limits.file_bytes {
        return Ok(bytes);
    }
    let mut findings = Findings::default();
    findings.add(FILE_TOO_LARGE, "", too_large(length, limits));
    let findings = findings.into_list();
    Err(ReadError::Invalid { findings })
}
