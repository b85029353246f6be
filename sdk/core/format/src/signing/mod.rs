//! Signatures of models and files. A model's signature is part of the asset that embeds the model;
//! a file's signature is in a separate file.

mod content;
mod key;
mod plugin;
mod signers;
mod trusted;

#[cfg(feature = "storage")]
pub use content::read_signature_at;
pub(crate) use content::refusal;
pub use content::{
    FileSignature, SIGNATURE_EXTENSION, SignatureError, SignedContent, SignedKind, read_signature,
    signature_path,
};
pub use key::{PublicKey, SecretKey};
pub(crate) use plugin::WASM_MAGIC;
pub use signers::Signers;
pub use trusted::{TrustedKey, TrustedKeys, check_key_name};
