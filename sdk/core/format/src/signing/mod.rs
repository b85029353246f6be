//! Signatures: of a model that an asset embeds, and of files in a file of their own.

mod content;
mod key;
mod plugin;
mod trusted;

pub use content::{FileSignature, SIGNATURE_EXTENSION, SignatureError, SignedContent, SignedKind};
pub use key::{PublicKey, SecretKey};
pub(crate) use plugin::WASM_MAGIC;
pub use trusted::{TrustedKey, TrustedKeys, check_key_name};
