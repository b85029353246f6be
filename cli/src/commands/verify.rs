use std::ffi::OsStr;
use std::fmt::{Display, Formatter};
use std::path::Path;

use clap::Args;
use htex_base::finding::plain;
use htex_base::storage::{Location, Storage};
use htex_format::Limits;
use htex_format::library::{Library, LibraryFile, split_address};
use htex_format::signing::{
    FileSignature, PublicKey, SIGNATURE_EXTENSION, SignedContent, SignedKind,
};
use serde::Serialize;

use crate::failure::{Exit, Failure, Result, for_file};
use crate::keys::{KeyRing, Signer, plugin_content, signer_at};
use crate::output::{print, print_json};

/// Check who signed files
///
/// The command reads FILE and FILE.sig. The exit status is 0 if each file has a valid signature
/// made with a key that you trust (`htex key trust`), and 1 otherwise. With --signed-by, each file
/// must have a valid signature made with the given key. A texture of a library
/// (`cloth.htexlib#oak`) counts as signed if the library is signed. To check such a texture, the
/// command reads only the library's index and this texture. No plugin is loaded.
#[derive(Args)]
pub(crate) struct Verify {
    /// Assets, libraries, textures of libraries and plugins, by path or URI
    #[arg(required = true, value_name = "FILE")]
    files: Vec<String>,

    /// The key that must have signed, by the name that you gave it or in hexadecimal digits
    #[arg(long, value_name = "NAME|KEY")]
    signed_by: Option<String>,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// What is known of a file's signature.
#[derive(Serialize)]
struct Verified {
    file: String,
    /// Whether the file has the required signature.
    verified: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<SignedKind>,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    version: Option<String>,
    /// `null` if there is no signature.
    signer: Option<Signer>,
}

impl Verify {
    pub(crate) fn run(self) -> Result {
        let ring = KeyRing::new()?;
        let wanted = self.signed_by.as_deref().map(|name| ring.signer(name)).transpose()?;
        let verified: Result<Vec<Verified>> =
            self.files.iter().map(|file| verify(file, wanted)).collect();
        let verified = verified?;
        if self.json {
            print_json(&verified)?;
        } else {
            verified.iter().try_for_each(|one| print(&one.to_string()))?;
        }
        Ok(Exit::ok_if(verified.iter().all(|one| one.verified)))
    }
}

fn verify(argument: &str, wanted: Option<PublicKey>) -> Result<Verified> {
    let (text, texture) = match split_address(argument) {
        Some((library, texture)) => (library, Some(texture)),
        None => (argument, None),
    };
    let location = Location::parse(OsStr::new(text))?;
    let storage = Storage::from_environment()?;
    if !storage.exists(&location)? {
        return Err(Failure::Other(format!("{}: there is no such file", plain(text))));
    }
    let mut found = Verified {
        file: argument.to_owned(),
        verified: false,
        kind: None,
        name: None,
        version: None,
        signer: None,
    };
    let mut library = None;
    let signer = signer_at(&location, |signature| {
        let content = content(&storage, &location, signature, &mut library)?;
        found.kind = Some(content.kind);
        found.name = Some(content.name.clone());
        found.version = Some(content.version.clone()).filter(|version| !version.is_empty());
        Ok(content)
    })?;
    let Some(signer) = signer else {
        return Ok(found);
    };
    found.verified = match wanted {
        Some(key) => signer.public_key() == Some(key) && !matches!(signer, Signer::Revoked { .. }),
        None => signer.is_trusted(),
    };
    if let (true, Some(texture), Some(library)) = (found.verified, texture, library) {
        // The signature covers the index, and the index contains the hash of the texture.
        library.get(texture).map_err(for_file(text.as_ref()))?;
        found.name = Some(format!("{}#{texture}", library.name()));
    }
    found.signer = Some(signer);
    Ok(found)
}

/// Returns the content that the signature of a file must state. Keeps the library whose index was
/// checked.
fn content(
    storage: &Storage,
    location: &Location,
    signature: &FileSignature,
    opened: &mut Option<Library<LibraryFile>>,
) -> Result<SignedContent> {
    let shown = location.to_string();
    let in_file = Path::new(&shown);
    match (signature.content.kind, location.local()) {
        (SignedKind::Plugin | SignedKind::Device, Some(file)) => plugin_content(file, signature),
        (SignedKind::Plugin | SignedKind::Device, None) => {
            Err(Failure::usage(format!("{shown}: download a plugin before you verify it")))
        }
        // The file is read as the kind that the signature states, whatever the file contains, so no
        // plugin is loaded.
        (SignedKind::Library, _) => {
            let library = Library::open_located(storage, location).map_err(for_file(in_file))?;
            let library = opened.insert(library);
            SignedContent::library(library).map_err(for_file(in_file))
        }
        (SignedKind::Asset, _) => {
            let bytes = storage.read(location, Limits::default().file_bytes)?;
            SignedContent::asset(&bytes).map_err(for_file(in_file))
        }
    }
}

impl Display for Verified {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let file = plain(&self.file);
        let Some(signer) = &self.signer else {
            return writeln!(f, "{file}: not signed: there is no {file}.{SIGNATURE_EXTENSION}");
        };
        write!(f, "{file}: {}", plain(&signer.to_string()))?;
        if let (Some(kind), Some(name), true) =
            (self.kind, &self.name, signer.public_key().is_some())
        {
            write!(f, " ({kind} {}", plain(name))?;
            if let Some(version) = &self.version {
                write!(f, " {}", plain(version))?;
            }
            write!(f, ")")?;
        }
        if !self.verified && signer.is_trusted() {
            write!(f, "; another key was asked for")?;
        }
        writeln!(f)
    }
}
