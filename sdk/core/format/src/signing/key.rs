//! Keys of ed25519 (RFC 8032).

use std::fmt::{Debug, Display, Formatter};
use std::str::FromStr;

use ed25519_dalek::{Signature, Signer, SigningKey, VerifyingKey};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A secret key of 32 bytes.
#[derive(Clone)]
pub struct SecretKey(SigningKey);

impl SecretKey {
    pub fn from_bytes(bytes: &[u8; 32]) -> Self {
        Self(SigningKey::from_bytes(bytes))
    }

    pub fn public(&self) -> PublicKey {
        PublicKey(self.0.verifying_key().to_bytes())
    }

    /// Returns the signature of a text, in hexadecimal digits.
    pub(super) fn sign(&self, text: &[u8]) -> String {
        to_hex(&self.0.sign(text).to_bytes())
    }
}

impl Debug for SecretKey {
    /// Does not show the secret.
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "SecretKey of {}", self.public())
    }
}

/// A public key of 32 bytes, written as 64 lower-case hexadecimal digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PublicKey([u8; 32]);

impl PublicKey {
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }

    /// Returns whether `signature`, in hexadecimal digits, is the signature of a text by this key.
    pub(super) fn has_signed(&self, text: &[u8], signature: &str) -> bool {
        let key = VerifyingKey::from_bytes(&self.0).ok();
        let signature = from_hex(signature).map(|bytes| Signature::from_bytes(&bytes));
        // The check is strict, because the plain check also accepts weak keys. With a weak key, one
        // signature is valid for several texts.
        key.zip(signature)
            .is_some_and(|(key, signature)| key.verify_strict(text, &signature).is_ok())
    }
}

impl Display for PublicKey {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(&to_hex(&self.0))
    }
}

impl FromStr for PublicKey {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bytes = from_hex(text).filter(|bytes| VerifyingKey::from_bytes(bytes).is_ok());
        bytes.map(Self).ok_or_else(|| {
            format!("`{text}` is not a public key of ed25519, which has 64 hexadecimal digits")
        })
    }
}

impl Serialize for PublicKey {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for PublicKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
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
