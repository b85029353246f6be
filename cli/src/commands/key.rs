use std::fmt::{Display, Formatter};

use clap::Args;
use htex_format::signing::PublicKey;
use serde::Serialize;

use super::subcommands;
use crate::failure::{Exit, Failure, Result};
use crate::keys::KeyRing;
use crate::output::{print, show};

/// Make keys, and say whose signatures you trust
///
/// A key signs assets, libraries and plugins (`htex sign`). So that other people can check your
/// signatures, give them the public half of the key: 64 hexadecimal digits. The keys are in the
/// folder `keys` inside your settings folder (`~/.config/htex`, or the folder in HTEX_CONFIG_DIR).
#[derive(Args)]
pub(crate) struct Key {
    #[command(subcommand)]
    command: Command,
}

subcommands! {
    Command {
        New(New),
        Show(Show),
        Trust(Trust),
        List(List),
        Revoke(Revoke),
    }
}

impl Key {
    pub(crate) fn run(self) -> Result {
        self.command.run()
    }
}

/// Make a key of your own, and trust it
#[derive(Args)]
pub(crate) struct New {
    /// Name of the key: lower-case letters, digits and hyphens
    name: String,
}

impl New {
    pub(crate) fn run(self) -> Result {
        let ring = KeyRing::new()?;
        if ring.trusted()?.named(&self.name).is_some() {
            let name = &self.name;
            return Err(Failure::Usage(format!(
                "there is a key `{name}` already; give another name"
            )));
        }
        let key = ring.create(&self.name)?;
        print(&format!(
            "{}  {key}\nothers trust it by: htex key trust {} {key}\n",
            self.name, self.name
        ))?;
        Ok(Exit::SUCCESS)
    }
}

/// Print the public half of a key
#[derive(Args)]
pub(crate) struct Show {
    /// Name of the key
    name: String,
}

impl Show {
    pub(crate) fn run(self) -> Result {
        print(&format!("{}\n", KeyRing::new()?.signer(&self.name)?))?;
        Ok(Exit::SUCCESS)
    }
}

/// Trust a key of somebody else, under a name that you choose
#[derive(Args)]
pub(crate) struct Trust {
    /// Name of the key: lower-case letters, digits and hyphens
    name: String,

    /// The public key, 64 hexadecimal digits
    key: PublicKey,
}

impl Trust {
    pub(crate) fn run(self) -> Result {
        KeyRing::new()?.change(|keys| keys.trust(&self.name, self.key))?;
        Ok(Exit::SUCCESS)
    }
}

/// No longer trust a key: htex then refuses files that were signed with this key
#[derive(Args)]
pub(crate) struct Revoke {
    /// Name of the key
    name: String,
}

impl Revoke {
    pub(crate) fn run(self) -> Result {
        KeyRing::new()?.change(|keys| keys.revoke(&self.name))?;
        Ok(Exit::SUCCESS)
    }
}

/// List your keys, and those that you trust or have revoked
#[derive(Args)]
pub(crate) struct List {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct KeyList {
    keys: Vec<KnownKey>,
}

#[derive(Serialize)]
struct KnownKey {
    name: String,
    public_key: PublicKey,
    /// Whether the user also has the secret half of the key.
    own: bool,
    revoked: bool,
}

impl List {
    pub(crate) fn run(self) -> Result {
        let ring = KeyRing::new()?;
        let trusted = ring.trusted()?;
        let keys = trusted.iter().map(|key| KnownKey {
            name: key.name.clone(),
            public_key: key.public_key,
            own: ring.has_secret(&key.name),
            revoked: key.revoked,
        });
        show(&KeyList { keys: keys.collect() }, self.json)
    }
}

impl Display for KeyList {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        if self.keys.is_empty() {
            return writeln!(f, "no keys; `htex key new NAME` makes one");
        }
        self.keys.iter().try_for_each(|key| {
            let state = match key {
                KnownKey { revoked: true, .. } => "revoked",
                KnownKey { own: true, .. } => "yours",
                _ => "trusted",
            };
            writeln!(f, "{:16} {state:8} {}", key.name, key.public_key)
        })
    }
}
