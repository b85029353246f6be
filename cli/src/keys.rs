//! Keys of this user, and the signatures of files.

use std::fmt::{Display, Formatter};
use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use htex_base::files::{AtFile, OwnFolder, private, random_key, read_regular};
use htex_base::native::folders;
use htex_base::storage::{Location, Storage};
pub(crate) use htex_format::signing::signature_path;
use htex_format::signing::{
    FileSignature, PublicKey, SecretKey, SignedContent, SignedKind, TrustedKey, TrustedKeys,
    read_signature_at,
};
use serde::Serialize;

use crate::failure::{Failure, Result};

/// The list of trusted keys, in the folder of the keys.
const TRUSTED: &str = "trusted.json";
/// The largest list of trusted keys, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// The user's folder of keys: `keys` in the folder for settings.
pub(crate) struct KeyRing {
    folder: PathBuf,
}

impl KeyRing {
    pub(crate) fn new() -> Result<Self> {
        let config = folders::config().ok_or_else(|| {
            Failure::other("there is no folder for keys: set HOME or HTEX_CONFIG_DIR")
        })?;
        Ok(Self { folder: config.join("keys") })
    }

    fn path(&self, file: &str) -> PathBuf {
        self.folder.join(file)
    }

    /// Returns the keys that the user trusts or has revoked.
    pub(crate) fn trusted(&self) -> Result<TrustedKeys> {
        let path = self.path(TRUSTED);
        let bytes = match read_regular(&path, MOST_BYTES) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Ok(TrustedKeys::default());
            }
            read => read.reading(&path)?,
        };
        serde_json::from_slice(&bytes).map_err(|error| {
            Failure::Other(format!("{}: {error}; mend or remove the file", path.display()))
        })
    }

    /// Changes the list of trusted keys. Other commands that want to change it have to wait.
    pub(crate) fn change(
        &self,
        change: impl FnOnce(&mut TrustedKeys) -> Result<(), String>,
    ) -> Result<()> {
        let folder = self.private_folder()?;
        let lock = folder.open_lock(Path::new("lock")).writing(&self.folder)?;
        lock.lock().writing(&self.folder)?;
        let mut keys = self.trusted()?;
        change(&mut keys).map_err(Failure::Usage)?;
        let text = serde_json::to_string_pretty(&keys)? + "\n";
        let write = |file: &mut File| file.write_all(text.as_bytes());
        Ok(folder.replace(Path::new(TRUSTED), write).writing(self.path(TRUSTED))?)
    }

    /// Creates a secret key, and trusts its public key.
    pub(crate) fn create(&self, name: &str) -> Result<PublicKey> {
        let secret = random_key().map_err(Failure::other)?;
        let public = SecretKey::from_bytes(&secret).public();
        let folder = self.private_folder()?;
        // The list is changed first, because this also checks the name.
        self.change(|keys| keys.trust(name, public))?;
        let file = secret_file(name);
        let mut created = folder.create(Path::new(&file)).writing(self.path(&file))?;
        created.write_all(&secret).and_then(|()| created.sync_all()).writing(self.path(&file))?;
        Ok(public)
    }

    fn private_folder(&self) -> Result<OwnFolder> {
        private::folder(&self.folder).writing(&self.folder)?;
        Ok(OwnFolder::private(&self.folder))
    }

    /// Returns whether the user has the secret key of this name.
    pub(crate) fn has_secret(&self, name: &str) -> bool {
        self.path(&secret_file(name)).is_file()
    }

    /// Returns the secret key of this name or in this file. Without a name, returns the user's only
    /// key.
    pub(crate) fn secret(&self, name: Option<&str>) -> Result<SecretKey> {
        let Some(name) = name else {
            let keys = self.trusted()?;
            let own: Vec<&str> =
                keys.iter().map(|key| &*key.name).filter(|name| self.has_secret(name)).collect();
            return match own[..] {
                [only] => self.secret(Some(only)),
                [] => Err(Failure::usage(
                    "you have no key yet: `htex key new NAME` makes one, or name a file with --key",
                )),
                _ => {
                    let own = own.join(", ");
                    Err(Failure::Usage(format!("you have several keys: choose with --key: {own}")))
                }
            };
        };
        let own = self.path(&secret_file(name));
        let is_own = is_key_name(name) && own.is_file();
        let path = if is_own { own } else { PathBuf::from(name) };
        let opened = if is_own { private::file(&path) } else { File::open(&path) };
        let mut bytes = Vec::new();
        match opened {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Err(Failure::Usage(format!(
                    "`{name}` is neither one of your keys nor a file; `htex key list` shows your keys"
                )));
            }
            opened => {
                opened.and_then(|file| file.take(33).read_to_end(&mut bytes)).reading(&path)?
            }
        };
        let bytes: [u8; 32] = bytes.try_into().map_err(|_| {
            let path = path.display();
            Failure::Usage(format!("{path}: a secret key of ed25519 has exactly 32 bytes"))
        })?;
        Ok(SecretKey::from_bytes(&bytes))
    }

    /// Returns the trusted key of this name, or the public key with these digits.
    pub(crate) fn signer(&self, name: &str) -> Result<PublicKey> {
        let keys = self.trusted()?;
        let digits = name.parse();
        match keys.named(name).or_else(|| keys.of(digits.as_ref().ok()?)) {
            Some(TrustedKey { revoked: true, .. }) => {
                Err(Failure::Usage(format!("you revoked the key `{name}`")))
            }
            Some(key) => Ok(key.public_key),
            None => digits.map_err(|_| {
                Failure::Usage(format!(
                    "`{name}` is no key that you trust: `htex key trust {name} KEY` adds it, and `htex key list` shows your keys"
                ))
            }),
        }
    }
}

fn secret_file(name: &str) -> String {
    format!("{name}.key")
}

fn is_key_name(name: &str) -> bool {
    htex_format::signing::check_key_name(name).is_ok()
}

/// The key that signed a file, and whether the user trusts this key.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "state", rename_all = "snake_case")]
pub(crate) enum Signer {
    /// A key that the user trusts.
    Trusted { name: String, public_key: PublicKey },
    /// A key that the user does not know.
    Unknown { public_key: PublicKey },
    /// A key that the user no longer trusts.
    Revoked { name: String, public_key: PublicKey },
    /// No key: the signature is malformed or invalid, or it belongs to another content.
    Invalid { problem: String },
}

impl Signer {
    /// Returns who signed this content. `signature` is the contents of a `.sig` file.
    pub(crate) fn of(ring: &KeyRing, signature: &[u8], content: &SignedContent) -> Result<Self> {
        let checked =
            FileSignature::from_json(signature).and_then(|signature| signature.check(content));
        Ok(match checked {
            Err(error) => Self::Invalid { problem: error.to_string() },
            Ok(public_key) => match ring.trusted()?.of(&public_key) {
                None => Self::Unknown { public_key },
                Some(TrustedKey { name, revoked, .. }) => {
                    let name = name.clone();
                    if *revoked {
                        Self::Revoked { name, public_key }
                    } else {
                        Self::Trusted { name, public_key }
                    }
                }
            },
        })
    }

    /// Returns who signed a local file; `None` if there is no `.sig` file beside it. `content` is
    /// called only if there is one.
    pub(crate) fn of_file(
        file: &Path,
        content: impl FnOnce(&FileSignature) -> Result<SignedContent>,
    ) -> Result<Option<Self>> {
        signer_at(&Location::parse(file.as_os_str())?, content)
    }

    /// Returns who signed a plugin or a device, without loading it. Name and version are those
    /// that the signer states.
    pub(crate) fn of_plugin(file: &Path) -> Result<Option<Self>> {
        Self::of_file(file, |signature| plugin_content(file, signature))
    }

    pub(crate) fn public_key(&self) -> Option<PublicKey> {
        match self {
            Self::Trusted { public_key, .. }
            | Self::Unknown { public_key }
            | Self::Revoked { public_key, .. } => Some(*public_key),
            Self::Invalid { .. } => None,
        }
    }

    pub(crate) fn is_trusted(&self) -> bool {
        matches!(self, Self::Trusted { .. })
    }
}

impl Display for Signer {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Trusted { name, .. } => write!(f, "signed by {name}"),
            Self::Unknown { public_key } => {
                write!(f, "signed by a key that you do not know: {public_key}")
            }
            Self::Revoked { name, .. } => {
                write!(f, "signed by {name}, whose key you revoked; do not trust it")
            }
            Self::Invalid { problem } => write!(f, "not signed: {problem}"),
        }
    }
}

/// Returns who signed a file at a path or a URI; `None` if there is no `.sig` file beside it.
/// `content` is called only if there is one.
pub(crate) fn signer_at(
    file: &Location,
    content: impl FnOnce(&FileSignature) -> Result<SignedContent>,
) -> Result<Option<Signer>> {
    let Some(bytes) = read_signature_at(&Storage::from_environment()?, file)? else {
        return Ok(None);
    };
    let signature = match FileSignature::from_json(&bytes) {
        Ok(signature) => signature,
        Err(error) => return Ok(Some(Signer::Invalid { problem: error.to_string() })),
    };
    Signer::of(&KeyRing::new()?, &bytes, &content(&signature)?).map(Some)
}

/// Returns the content that a plugin's signature must state: the name and the version that the
/// signature itself states, and the hash of the plugin's file.
pub(crate) fn plugin_content(file: &Path, signature: &FileSignature) -> Result<SignedContent> {
    let told = &signature.content;
    // A signature of an asset is not valid for a plugin.
    let kind = match told.kind {
        SignedKind::Device => SignedKind::Device,
        _ => SignedKind::Plugin,
    };
    let bytes = std::fs::read(file).reading(file)?;
    Ok(SignedContent::plugin(kind, &told.name, &told.version, &bytes))
}
