//! Hash and signature of embedded models.

use super::{SecretKey, SignedContent, SignedKind};
use crate::{Plugin, Signature};

/// First bytes of every WASM module.
pub(crate) const WASM_MAGIC: &[u8] = b"\0asm";

impl Plugin {
    /// Creates the manifest entry of a model's WASM module, without a signature. `version` is the
    /// model's version.
    pub fn new(model: &str, version: &str, module: &[u8]) -> Self {
        Self {
            model: model.to_owned(),
            version: version.to_owned(),
            file: Self::file_of(model),
            blake3: blake3::hash(module).to_hex().to_string(),
            signature: None,
        }
    }

    /// Returns the name of the archive entry that contains a model's module.
    pub(crate) fn file_of(model: &str) -> String {
        format!("plugins/{model}.wasm")
    }

    /// Signs the entry.
    #[must_use]
    pub fn signed(mut self, key: &SecretKey) -> Self {
        self.signature = Some(Signature {
            public_key: key.public().to_string(),
            ed25519: key.sign(&self.content().text()),
        });
        self
    }

    /// Returns whether the entry's signature is valid for this plugin and for the public key in the
    /// signature. Returns true if the entry has no signature.
    pub fn is_signature_valid(&self) -> bool {
        let Some(signature) = &self.signature else {
            return true;
        };
        let key = signature.public_key.parse::<super::PublicKey>();
        key.is_ok_and(|key| key.has_signed(&self.content().text(), &signature.ed25519))
    }

    fn content(&self) -> SignedContent {
        SignedContent {
            kind: SignedKind::Plugin,
            name: self.model.clone(),
            version: self.version.clone(),
            blake3: self.blake3.clone(),
        }
    }
}
