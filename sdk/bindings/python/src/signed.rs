//! Who must have signed what is opened: the keywords `only_signed_by` and `signature`.

use std::path::Path;

use htex::format::Asset;
use htex::format::signing::{PublicKey, Signers, read_signature_at};
use htex::library::storage::{Location, Storage};
use htex::library::{Library, LibraryError, LibrarySource};
use pyo3::prelude::*;

use crate::errors::{option, raised};

/// One key or several, in hexadecimal digits.
#[derive(FromPyObject)]
pub(crate) enum Keys {
    One(String),
    Several(Vec<String>),
}

/// Who must have signed what is opened, and the signature that was given.
pub(crate) struct Signed {
    /// `None` if no signature is required.
    pub(crate) signers: Option<Signers>,
    signature: Option<Vec<u8>>,
}

impl Signed {
    pub(crate) fn new(keys: Option<Keys>, signature: Option<Vec<u8>>) -> PyResult<Self> {
        if keys.is_none() && signature.is_some() {
            let text =
                "signature is of use only with only_signed_by; give the keys that you accept";
            return Err(option(text));
        }
        Ok(Self { signers: keys.map(signers).transpose()?, signature })
    }

    /// Opens the asset in a file, whose signature is beside it.
    pub(crate) fn open(&self, path: &Path) -> PyResult<Asset> {
        self.check_unset()?;
        let read = match &self.signers {
            None => Asset::open(path),
            Some(signers) => Asset::open_signed(path, signers),
        };
        read.map_err(raised)
    }

    /// Reads an asset from its bytes.
    pub(crate) fn read(&self, bytes: &[u8]) -> PyResult<Asset> {
        let read = match &self.signers {
            None => Asset::from_bytes(bytes),
            Some(signers) => Asset::from_signed_bytes(bytes, self.signature.as_deref(), signers),
        };
        read.map_err(raised)
    }

    /// Refuses a library that is not signed as required. A library that is a file has its signature
    /// beside it.
    pub(crate) fn check<S: LibrarySource>(
        &self,
        library: &Library<S>,
        file: Option<(&Storage, &Location)>,
    ) -> PyResult<()> {
        if file.is_some() {
            self.check_unset()?;
        }
        let Some(signers) = &self.signers else {
            return Ok(());
        };
        let beside = file.map(|(storage, file)| read_signature_at(storage, file));
        let beside = beside.transpose().map_err(|error| raised(LibraryError::from(error)))?;
        let signature = beside.flatten().or_else(|| self.signature.clone());
        library.check_signed(signature.as_deref(), signers).map(drop).map_err(raised)
    }

    fn check_unset(&self) -> PyResult<()> {
        if self.signature.is_none() {
            return Ok(());
        }
        Err(option("the signature of a file is read from PATH.sig; give no signature"))
    }
}

fn signers(keys: Keys) -> PyResult<Signers> {
    let keys = match keys {
        Keys::One(key) => vec![key],
        Keys::Several(keys) => keys,
    };
    if keys.is_empty() {
        return Err(option("only_signed_by has no key, so nothing could be opened; give one"));
    }
    let parsed: Result<Vec<PublicKey>, String> = keys.iter().map(|key| key.parse()).collect();
    let wrong = |problem| option(format!("only_signed_by: {problem}"));
    Ok(Signers::new(parsed.map_err(wrong)?))
}
