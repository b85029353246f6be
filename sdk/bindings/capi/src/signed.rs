//! Who must have signed what a call opens (`only_signed_by` of `htex_open_options`).

use htex::format::Asset;
#[cfg(all(feature = "library", not(target_family = "wasm")))]
use htex::format::signing::read_signature;
use htex::format::signing::{PublicKey, Signers};
use std::path::Path;

use crate::options::htex_open_options;
use crate::pointers::{needed_text, slice};
use crate::status::{Failure, htex_status};

/// Who must have signed what a call opens, and the signature that the program gave.
pub(crate) struct Signed {
    /// `None` if no signature is required.
    signers: Option<Signers>,
    signature: Option<Vec<u8>>,
}

/// # Safety
/// The pointers in the options are the caller's.
pub(crate) unsafe fn signed(options: &htex_open_options) -> Result<Signed, Failure> {
    // SAFETY: as here.
    let keys = unsafe { slice(options.only_signed_by, options.only_signed_by_len) }?.iter();
    // SAFETY: as here.
    let keys: Result<Vec<PublicKey>, Failure> =
        keys.map(|key| unsafe { needed_text(*key) }.and_then(public_key)).collect();
    let keys = keys?;
    // SAFETY: as here.
    let signature = unsafe { slice(options.signature.data, options.signature.len) }?;
    if keys.is_empty() && !signature.is_empty() {
        return Err(Failure::argument(
            "`signature` is set without `only_signed_by`; set the keys that are accepted",
        ));
    }
    Ok(Signed {
        signers: (!keys.is_empty()).then(|| Signers::new(keys)),
        signature: (!signature.is_empty()).then(|| signature.to_vec()),
    })
}

/// Parses a key of `only_signed_by`.
pub(crate) fn public_key(text: &str) -> Result<PublicKey, Failure> {
    let wrong = |problem: String| {
        Failure::new(
            htex_status::HTEX_STATUS_INVALID_ARGUMENT,
            format!("only_signed_by: {problem}"),
        )
    };
    text.parse().map_err(wrong)
}

impl Signed {
    /// Opens the asset in a file.
    pub(crate) fn open(&self, path: &Path) -> Result<Asset, Failure> {
        let read = match self.signers_of_files()? {
            None => Asset::open(path),
            Some(signers) => Asset::open_signed(path, signers),
        };
        Ok(read.map_err(htex::Error::from)?)
    }

    /// Reads an asset from its bytes.
    pub(crate) fn read(&self, bytes: &[u8]) -> Result<Asset, Failure> {
        let read = match &self.signers {
            None => Asset::from_bytes(bytes),
            Some(signers) => Asset::from_signed_bytes(bytes, self.signature.as_deref(), signers),
        };
        Ok(read.map_err(htex::Error::from)?)
    }

    /// Returns the signers of files whose signatures are beside them.
    pub(crate) fn signers_of_files(&self) -> Result<Option<&Signers>, Failure> {
        if self.signature.is_some() {
            return Err(Failure::argument(
                "the signature of a file is read from PATH.sig; leave `signature` empty",
            ));
        }
        Ok(self.signers.as_ref())
    }

    /// Refuses a library that is not signed as required. `bytes` are the bytes of its whole index.
    #[cfg(all(feature = "library", target_family = "wasm"))]
    pub(crate) fn check_index(
        &self,
        index: &htex::library::Index,
        bytes: &[u8],
    ) -> Result<(), Failure> {
        let Some(signers) = &self.signers else {
            return Ok(());
        };
        let start = index.range().start;
        let read = |page: std::ops::Range<u64>| {
            let range = [page.start, page.end].map(|at| at.saturating_sub(start) as usize);
            // Missing bytes have another hash than those that were signed.
            Ok(bytes.get(range[0]..range[1]).unwrap_or_default().to_vec())
        };
        index.check_signed(self.signature.as_deref(), signers, read)?;
        Ok(())
    }

    /// Refuses a library that is not signed as required. `path` is its file, if it has one.
    #[cfg(all(feature = "library", not(target_family = "wasm")))]
    pub(crate) fn check_library<S: htex::library::LibrarySource>(
        &self,
        library: &htex::library::Library<S>,
        path: Option<&Path>,
    ) -> Result<(), Failure> {
        let Some(signers) = &self.signers else {
            return Ok(());
        };
        let beside = path.filter(|_| self.signature.is_none()).map(read_signature);
        let beside = beside.transpose().map_err(htex::Error::from)?.flatten();
        let signature = self.signature.as_ref().or(beside.as_ref());
        library.check_signed(signature.map(Vec::as_slice), signers)?;
        Ok(())
    }
}
