//! The keys that a user trusts, with their names.

use serde::{Deserialize, Serialize};

use super::PublicKey;

/// A public key, and the name that the user gave the key.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrustedKey {
    /// At most 64 lower-case letters, digits and hyphens; the first character is a letter.
    pub name: String,
    pub public_key: PublicKey,
    /// Whether the user has revoked the key and no longer trusts it. A revoked key stays in the
    /// list, so that the program refuses everything that the key signed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub revoked: bool,
}

/// The keys that a user trusts or has revoked, in the order in which they were added.
///
/// ```
/// use htex_format::signing::{SecretKey, TrustedKeys};
/// let mut keys = TrustedKeys::default();
/// let key = SecretKey::from_bytes(&[7; 32]).public();
/// keys.trust("alice", key)?;
/// assert_eq!(keys.of(&key).map(|key| &*key.name), Some("alice"));
/// assert!(keys.trust("alice", SecretKey::from_bytes(&[8; 32]).public()).is_err());
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrustedKeys {
    #[serde(default)]
    keys: Vec<TrustedKey>,
}

impl TrustedKeys {
    pub fn iter(&self) -> impl Iterator<Item = &TrustedKey> {
        self.keys.iter()
    }

    /// Returns the key with this name.
    pub fn named(&self, name: &str) -> Option<&TrustedKey> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// Returns the entry for a public key, or `None` if the user has neither trusted nor revoked
    /// the key.
    pub fn of(&self, key: &PublicKey) -> Option<&TrustedKey> {
        self.keys.iter().find(|known| known.public_key == *key)
    }

    /// Adds a key.
    ///
    /// # Errors
    /// Returns an error if the name is invalid or belongs to another key, or if the key is revoked
    /// or has another name.
    pub fn trust(&mut self, name: &str, key: PublicKey) -> Result<(), String> {
        check_key_name(name)?;
        if let Some(known) = self.of(&key) {
            return match known {
                TrustedKey { revoked: true, name, .. } => {
                    Err(format!("this key was revoked under the name `{name}`"))
                }
                known if known.name == name => Ok(()),
                known => {
                    Err(format!("this key is trusted already, under the name `{}`", known.name))
                }
            };
        }
        if let Some(known) = self.named(name) {
            let other = known.public_key;
            return Err(format!("`{name}` is another key, {other}; give this key another name"));
        }
        self.keys.push(TrustedKey { name: name.to_owned(), public_key: key, revoked: false });
        Ok(())
    }

    /// Marks the key with this name as revoked.
    ///
    /// # Errors
    /// Returns an error if no key has the name.
    pub fn revoke(&mut self, name: &str) -> Result<(), String> {
        let key = self.keys.iter_mut().find(|key| key.name == name);
        key.ok_or_else(|| format!("no key has the name `{name}`"))?.revoked = true;
        Ok(())
    }
}

/// Checks that a name is a valid name for a key. A valid name is also safe as a file name.
///
/// # Errors
/// If the name is invalid. The error text says which names are valid.
pub fn check_key_name(name: &str) -> Result<(), String> {
    let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-';
    let is_name = name.len() <= 64
        && name.bytes().all(plain)
        && name.starts_with(|c: char| c.is_ascii_lowercase());
    if is_name {
        Ok(())
    } else {
        Err(format!(
            "`{name}` is not the name of a key: lower-case letters, digits and hyphens, a letter first, at most 64"
        ))
    }
}
