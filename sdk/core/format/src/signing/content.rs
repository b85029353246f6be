//! A signature of a file, stored in a separate file.

use std::fmt::{Display, Formatter};
use std::io;
use std::path::{Path, PathBuf};

use htex_base::files::read_regular;
use serde::{Deserialize, Serialize};

use super::{PublicKey, SecretKey};
use crate::ReadError;

/// The suffix that is added to a file's name to get the name of its signature file, as in
/// `oak.htex.sig`.
pub const SIGNATURE_EXTENSION: &str = "sig";

/// The largest size of a signature file, bytes.
const MOST_BYTES: usize = 4096;
/// Of a larger file, nothing is read, bytes. A smaller file that is too large is malformed.
const MOST_READ_BYTES: u64 = 1 << 16;

/// The kind of a signed file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SignedKind {
    /// A model, as a module or as a native library.
    Plugin,
    /// A native library with a device.
    Device,
    Asset,
    Library,
}

impl SignedKind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Plugin => "plugin",
            Self::Device => "device",
            Self::Asset => "asset",
            Self::Library => "library",
        }
    }
}

impl Display for SignedKind {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// The content that a signature confirms: the kind, name, version and hash of a file
/// (`spec/signature-1.md`).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SignedContent {
    pub kind: SignedKind,
    /// The id of a model or a device, or the name of an asset or a library.
    pub name: String,
    /// The version of a model, a device or a library; empty for an asset, and for a library that
    /// states no version.
    pub version: String,
    /// BLAKE3 in hexadecimal digits. For a library this is the hash of the index, and otherwise the
    /// hash of the file. A library's index contains the hash of each texture.
    pub blake3: String,
}

impl SignedContent {
    /// Returns the content to sign for a plugin or a device.
    pub fn plugin(kind: SignedKind, id: &str, version: &str, file: &[u8]) -> Self {
        let blake3 = blake3::hash(file).to_hex().to_string();
        Self { kind, name: id.to_owned(), version: version.to_owned(), blake3 }
    }

    /// Returns the content to sign for an asset's file.
    ///
    /// # Errors
    /// Returns an error if the bytes are not an asset.
    pub fn asset(file: &[u8]) -> Result<Self, ReadError> {
        let asset = crate::Asset::from_bytes(file)?;
        Ok(Self::plugin(SignedKind::Asset, &asset.manifest.name, "", file))
    }

    /// Returns the content to sign for a library. Reads the whole index, because the hash in the
    /// header is only a claim: a forged library may state the hash of a signed one. From then on,
    /// the library refuses the pages that are not those of this hash.
    ///
    /// # Errors
    /// Returns an error if the index cannot be read or does not have the hash that the header states.
    #[cfg(feature = "library")]
    pub fn library<S: crate::library::LibrarySource>(
        library: &crate::library::Library<S>,
    ) -> Result<Self, crate::library::LibraryError> {
        library.check_index()?;
        Ok(Self::index(library.index()))
    }

    /// Returns the content to sign for a library, whose index was compared with its hash.
    #[cfg(feature = "library")]
    pub(crate) fn index(index: &crate::library::Index) -> Self {
        Self {
            kind: SignedKind::Library,
            name: index.name().to_owned(),
            version: index.metadata().version.clone().unwrap_or_default(),
            blake3: blake3::Hash::from_bytes(index.blake3()).to_hex().to_string(),
        }
    }

    pub fn sign(self, key: &SecretKey) -> FileSignature {
        let ed25519 = key.sign(&self.text());
        FileSignature {
            htex_signature: VERSION.to_owned(),
            content: self,
            public_key: key.public(),
            ed25519,
        }
    }

    /// Returns the text that is signed: `htex KIND 1`, the name, the version and the hash, each
    /// followed by a zero byte. The text contains the kind, so that a signature is valid only for
    /// files of this kind.
    pub(super) fn text(&self) -> Vec<u8> {
        let mut text = format!("htex {} 1\0", self.kind).into_bytes();
        for part in [&self.name, &self.version, &self.blake3] {
            text.extend_from_slice(part.as_bytes());
            text.push(0);
        }
        text
    }
}

/// The version of the file.
const VERSION: &str = "1.0";

/// A signature of a file: the content of `FILE.sig`.
///
/// ```
/// use htex_format::signing::{FileSignature, SecretKey, SignedContent, SignedKind};
/// let key = SecretKey::from_bytes(&[7; 32]);
/// let content = SignedContent::plugin(SignedKind::Plugin, "org.example.felt", "1.0.0", b"\0asm...");
/// let text = content.clone().sign(&key).to_json();
/// let signature = FileSignature::from_json(text.as_bytes())?;
/// assert_eq!(signature.check(&content)?, key.public());
/// # Ok::<(), htex_format::signing::SignatureError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileSignature {
    /// `1.0`.
    pub htex_signature: String,
    #[serde(flatten)]
    pub content: SignedContent,
    pub public_key: PublicKey,
    /// The signature, in 128 hexadecimal digits.
    pub ed25519: String,
}

impl FileSignature {
    /// Parses a signature file.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a signature file of version 1.
    pub fn from_json(bytes: &[u8]) -> Result<Self, SignatureError> {
        if bytes.len() > MOST_BYTES {
            return Err(SignatureError::Malformed(format!("more than {MOST_BYTES} bytes")));
        }
        let signature: Self = serde_json::from_slice(bytes)
            .map_err(|error| SignatureError::Malformed(error.to_string()))?;
        let major = signature.htex_signature.split('.').next();
        if major != Some("1") {
            return Err(SignatureError::Newer(signature.htex_signature));
        }
        Ok(signature)
    }

    pub fn to_json(&self) -> String {
        // All keys are texts, so this cannot fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Returns the key that signed this content.
    ///
    /// # Errors
    /// Returns an error if the signature is invalid or belongs to other content.
    pub fn check(&self, content: &SignedContent) -> Result<PublicKey, SignatureError> {
        let told = &self.content;
        if told.blake3 != content.blake3 {
            return Err(SignatureError::Changed);
        }
        let parts = [
            ("kind", told.kind.name(), content.kind.name()),
            ("name", &told.name, &content.name),
            ("version", &told.version, &content.version),
        ];
        if let Some((part, signed, found)) = parts.into_iter().find(|(_, a, b)| a != b) {
            let (signed, found) = (signed.to_owned(), found.to_owned());
            return Err(SignatureError::Other { part, signed, found });
        }
        if self.public_key.has_signed(&content.text(), &self.ed25519) {
            Ok(self.public_key)
        } else {
            Err(SignatureError::Invalid)
        }
    }
}

/// Returns the path of a file's signature: the file's path with `.sig` behind it.
pub fn signature_path(file: &Path) -> PathBuf {
    let mut path = file.as_os_str().to_owned();
    path.push(".");
    path.push(SIGNATURE_EXTENSION);
    path.into()
}

/// Reads the signature beside a file, which is in [`signature_path`]. Returns `None` if there is no
/// such file.
///
/// # Errors
/// Returns an error if it cannot be read, is no regular file, or is too large for a signature.
pub fn read_signature(file: &Path) -> Result<Option<Vec<u8>>, crate::ReadError> {
    let path = signature_path(file);
    match read_regular(&path, MOST_READ_BYTES) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(crate::ReadError::Io { path, error }),
    }
}

/// Reads the signature beside a file at a path or a URI. Returns `None` if there is no such file.
///
/// # Errors
/// Returns an error if it cannot be read, or is too large for a signature.
#[cfg(feature = "storage")]
pub fn read_signature_at(
    storage: &htex_base::storage::Storage,
    file: &htex_base::storage::Location,
) -> Result<Option<Vec<u8>>, htex_base::storage::StorageError> {
    let text = format!("{file}.{SIGNATURE_EXTENSION}");
    let location = htex_base::storage::Location::parse(text.as_ref())?;
    let is_there = storage.exists(&location)?;
    is_there.then(|| storage.read(&location, MOST_READ_BYTES)).transpose()
}

/// Returns the sentence for a file that is not opened because of its signature.
pub(crate) fn refusal(error: &SignatureError) -> String {
    format!("not opened: {error}; get the file and its signature from its signer")
}

/// The reason why a signature is not valid for a file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SignatureError {
    /// There is no signature.
    #[error("it must be signed, and there is no signature of it")]
    Missing,
    /// Another key made the signature.
    #[error("it is signed by another key, {key}")]
    OtherKey { key: PublicKey },
    #[error("this is no signature of htex: {0}")]
    Malformed(String),
    #[error("the signature has version {0}, and this program reads version 1; update the program")]
    Newer(String),
    /// The hash is another.
    #[error("the file was changed after it was signed, or this is another file's signature")]
    Changed,
    #[error("the signature is for the {part} `{signed}`, and the file has `{found}`")]
    Other { part: &'static str, signed: String, found: String },
    #[error("the signature is not one that its key made; do not trust this file")]
    Invalid,
}
