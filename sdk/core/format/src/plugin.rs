//! Hash and signature of embedded models.

use ed25519_dalek::{Signature as Ed25519, Signer, SigningKey, VerifyingKey};

use crate::{Plugin, Signature};

/// Prefix of every signed text. With it, a signature of a plugin is not valid for any other kind of
/// text.
const DOMAIN: &[u8] = b"htex plugin 1\0";
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

    /// Signs the entry with an ed25519 secret key of 32 bytes.
    #[must_use]
    pub fn signed(mut self, secret_key: &[u8; 32]) -> Self {
        let key = SigningKey::from_bytes(secret_key);
        self.signature = Some(Signature {
            public_key: to_hex(key.verifying_key().as_bytes()),
            ed25519: to_hex(&key.sign(&self.signed_text()).to_bytes()),
        });
        self
    }

    /// Returns whether the entry's signature is valid for this plugin and for the public key in the
    /// signature. Returns true if the entry has no signature.
    pub fn is_signature_valid(&self) -> bool {
        let Some(signature) = &self.signature else {
            return true;
        };
        let key = from_hex(&signature.public_key).and_then(|k| VerifyingKey::from_bytes(&k).ok());
        let made = from_hex(&signature.ed25519).map(|bytes| Ed25519::from_bytes(&bytes));
        // Strict, because the plain check also accepts weak keys, for which one signature is valid
        // for several texts.
        key.zip(made)
            .is_some_and(|(key, made)| key.verify_strict(&self.signed_text(), &made).is_ok())
    }

    /// Returns the text that is signed: `htex plugin 1`, the model, the version and the hash, each
    /// followed by a zero byte.
    fn signed_text(&self) -> Vec<u8> {
        let mut text = DOMAIN.to_vec();
        for part in [&self.model, &self.version, &self.blake3] {
            text.extend_from_slice(part.as_bytes());
            text.push(0);
        }
        text
    }
}

fn to_hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn from_hex<const N: usize>(text: &str) -> Option<[u8; N]> {
    let mut bytes = [0; N];
    // `from_str_radix` also accepts a sign, which is not a hexadecimal digit.
    if text.len() != 2 * N || !text.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    for (i, byte) in bytes.iter_mut().enumerate() {
        *byte = u8::from_str_radix(&text[2 * i..2 * i + 2], 16).ok()?;
    }
    Some(bytes)
}
