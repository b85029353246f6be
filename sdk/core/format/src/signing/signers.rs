//! Who must have signed the files that a program opens.

use super::{FileSignature, PublicKey, SignatureError, SignedContent, SignedKind};
use crate::{Asset, ReadError};

/// The keys of which one must have signed each file that a program opens. Without a key, every file
/// is refused.
///
/// ```
/// use htex_format::signing::{SecretKey, Signers, SignedContent, SignedKind};
/// let key = SecretKey::from_bytes(&[7; 32]);
/// let content = SignedContent::plugin(SignedKind::Plugin, "org.example.felt", "1.0.0", b"\0asm...");
/// let signature = content.clone().sign(&key).to_json();
/// let signers = Signers::new([key.public()]);
/// assert_eq!(signers.check(&content, Some(signature.as_bytes()))?, key.public());
/// assert!(signers.check(&content, None).is_err());
/// assert!(Signers::default().check(&content, Some(signature.as_bytes())).is_err());
/// # Ok::<(), htex_format::signing::SignatureError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Signers {
    keys: Vec<PublicKey>,
    /// Hashes of the files that the program has checked itself.
    files: Vec<[u8; 32]>,
}

impl Signers {
    /// Accepts the files that one of these keys signed.
    pub fn new(keys: impl IntoIterator<Item = PublicKey>) -> Self {
        Self { keys: keys.into_iter().collect(), files: Vec::new() }
    }

    /// Also accepts the asset with this BLAKE3 hash, without a signature of its own. This is for a
    /// texture that the program has read from a library that one of the keys signed.
    #[must_use]
    pub fn with_blake3(mut self, file: [u8; 32]) -> Self {
        self.files.push(file);
        self
    }

    /// Returns the accepted key that signed this content. `signature` is the contents of the file
    /// with the signature, or `None` if there is no such file.
    ///
    /// # Errors
    /// Returns an error if there is no signature, if it is invalid or belongs to other content, or if
    /// another key made it.
    pub fn check(
        &self,
        content: &SignedContent,
        signature: Option<&[u8]>,
    ) -> Result<PublicKey, SignatureError> {
        let signature = FileSignature::from_json(signature.ok_or(SignatureError::Missing)?)?;
        let key = signature.check(content)?;
        if self.keys.contains(&key) { Ok(key) } else { Err(SignatureError::OtherKey { key }) }
    }

    /// Reads an asset from the bytes of a file, if the file is accepted.
    pub(crate) fn read_asset(
        &self,
        file: &[u8],
        signature: Option<&[u8]>,
    ) -> Result<Asset, ReadError> {
        let asset = Asset::from_bytes(file)?;
        if !self.files.contains(blake3::hash(file).as_bytes()) {
            let name = &asset.manifest.name;
            let content = SignedContent::plugin(SignedKind::Asset, name, "", file);
            self.check(&content, signature)?;
        }
        Ok(asset)
    }
}
