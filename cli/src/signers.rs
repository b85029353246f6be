//! `--only-signed-by`: who must have signed the textures that a command plays, renders or converts.

use clap::{ArgMatches, Args};
use htex_base::storage::{Location, Storage};
use htex_format::library::{Library, LibraryFile};
use htex_format::signing::{Signers, read_signature_at};

use crate::failure::{Result, for_file};
use crate::keys::KeyRing;
use crate::located;

/// The option that requires a signature of each texture.
#[derive(Args)]
pub(crate) struct SignerArgs {
    /// Refuse every texture that this key did not sign, before anything is played or written. Give
    /// the name of a key that you trust (`htex key list`), or its hexadecimal digits. The signature
    /// of FILE is in FILE.sig; a texture of a library is signed if its library is. Of a scene, each
    /// texture must be signed
    #[arg(long, value_name = "NAME|KEY", help_heading = "Signatures")]
    only_signed_by: Option<String>,
}

impl SignerArgs {
    /// Returns who must have signed each texture; `None` if signatures are not required.
    pub(crate) fn signers(&self) -> Result<Option<Signers>> {
        self.only_signed_by.as_deref().map(signers).transpose()
    }
}

/// Returns the value of `--only-signed-by` of the subcommand that was given.
pub(crate) fn given(matches: &ArgMatches) -> Option<&String> {
    match matches.subcommand() {
        Some((_, inner)) => given(inner),
        None => matches.try_get_one("only_signed_by").ok().flatten(),
    }
}

/// Returns what is accepted: what the key signed, and the copies of textures whose libraries the
/// key signed.
pub(crate) fn signers(key: &str) -> Result<Signers> {
    let signers = Signers::new([KeyRing::new()?.signer(key)?]);
    Ok(located::signed_textures().into_iter().fold(signers, Signers::with_blake3))
}

/// Refuses a library that none of the signers signed.
pub(crate) fn check_library(
    storage: &Storage,
    location: &Location,
    library: &Library<LibraryFile>,
    signers: &Signers,
) -> Result<()> {
    let signature = read_signature_at(storage, location)?;
    let checked = library.check_signed(signature.as_deref(), signers);
    checked.map(drop).map_err(for_file(location.to_string().as_ref()))
}
