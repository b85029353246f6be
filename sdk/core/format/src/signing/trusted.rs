//! The keys that a user trusts, with their names.

use serde::{Deserialize, Serialize};

use super::PublicKey;

/// A key with the name that its user gave it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrustedKey {
    /// Lower-case letters, digits and hyphens, a letter first; at most 64.
    pub name: String,
    pub public_key: PublicKey,
    /// Whether the user no longer trusts it. It is kept, so that what it signed is refused.
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

    /// Returns what the user said of a key.
    pub fn of(&self, key: &PublicKey) -> Option<&TrustedKey> {
        self.keys.iter().find(|known| known.public_key == *key)
    }

    /// Adds a key.
    ///
    /// # Errors
    /// If the name is invalid, or name or key are known already and differ.
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
    /// If no key has the name.
    pub fn revoke(&mut self, name: &str) -> Result<(), String> {
        let key = self.keys.iter_mut().find(|key| key.name == name);
        key.ok_or_else(|| format!("no key has the name `{name}`"))?.revoked = true;
        Ok(())
    }
}

/// Refuses a name that is no name of a key. Such a name is also a safe name for a file.
///
/// # Errors
/// If it is none. The text says what a name is.
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
