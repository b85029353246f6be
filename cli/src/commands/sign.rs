use std::fmt::{Display, Formatter};
use std::io::Read as _;
use std::path::{Path, PathBuf};

use clap::Args;
use htex_base::files::{AtFile, OwnFolder, open_regular};
use htex_device::AdapterEntry;
use htex_format::library::{Library, MAGIC};
use htex_format::signing::{FileSignature, SignedContent, SignedKind};
use htex_host::{LoadedModel, WasmLimits};
use serde::Serialize;

use crate::assets::read_asset;
use crate::failure::{Failure, Result, for_file};
use crate::keys::{KeyRing, signature_path};
use crate::output::{OutputFile, show, shown};

/// Sign files with your key
///
/// Writes the signature of FILE to FILE.sig, beside it. The signature states the kind of the file
/// (e.g. library), the name and, if there is one, the version of its content, and the BLAKE3 hash
/// of the file. The signature of a library covers all of its textures, including textures that a
/// program downloads one at a time. To read the name of a plugin, the command loads it.
#[derive(Args)]
pub(crate) struct Sign {
    /// Assets, libraries, and plugins (models or devices)
    #[arg(required = true)]
    files: Vec<PathBuf>,

    /// Your key, by name (`htex key list`), or a file with a secret key [default: your only key]
    #[arg(long, value_name = "NAME|FILE")]
    key: Option<String>,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Signatures(Vec<Signed>);

#[derive(Serialize)]
struct Signed {
    file: PathBuf,
    #[serde(flatten)]
    signature: FileSignature,
}

impl Sign {
    pub(crate) fn run(self) -> Result {
        let key = KeyRing::new()?.secret(self.key.as_deref())?;
        let sign = |file: PathBuf| {
            let signature = content_of(&file)?.sign(&key);
            let (folder, _) = OwnFolder::of_file(&file).writing(&file)?;
            let path = signature_path(&file);
            let name = path.file_name().unwrap_or_default();
            OutputFile::Inside(&folder, name.as_ref()).write(signature.to_json().as_bytes())?;
            Ok(Signed { file: path, signature })
        };
        let signed: Result<Vec<Signed>> = self.files.into_iter().map(sign).collect();
        show(&Signatures(signed?), self.json)
    }
}

impl Display for Signatures {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        self.0.iter().try_for_each(|Signed { file, signature }| {
            let content = &signature.content;
            let version = if content.version.is_empty() { "" } else { " " };
            let name = htex_base::finding::plain(&content.name);
            writeln!(
                f,
                "{}: {} {name}{version}{}, key {}",
                shown(file),
                content.kind,
                htex_base::finding::plain(&content.version),
                signature.public_key
            )
        })
    }
}

/// Returns the content that a signature of this local file states.
fn content_of(file: &Path) -> Result<SignedContent> {
    let mut start = Vec::new();
    let opened = open_regular(file).and_then(|f| f.take(8).read_to_end(&mut start));
    opened.reading(file)?;
    if start == MAGIC {
        let library = Library::open(file).map_err(for_file(file))?;
        return SignedContent::library(&library).map_err(for_file(file));
    }
    if start.starts_with(b"PK\x03\x04") {
        return SignedContent::asset(&read_asset(file)?).map_err(for_file(file));
    }
    let bytes = || std::fs::read(file).reading(file);
    let model = LoadedModel::from_file_within(file, &WasmLimits::default());
    let (kind, id, version) = match model {
        Ok(model) => {
            let descriptor = model.descriptor();
            (SignedKind::Plugin, descriptor.id.clone(), descriptor.version.clone())
        }
        Err(no_model) => match AdapterEntry::load(file) {
            Ok(device) => {
                let descriptor = device.descriptor();
                (SignedKind::Device, descriptor.id.clone(), descriptor.version.clone())
            }
            Err(_) if start.starts_with(b"\0asm") => return Err(no_model.into()),
            Err(no_device) => {
                return Err(Failure::Other(format!(
                    "{}: it is no asset, no library, no model ({no_model}) and no device ({no_device})",
                    shown(file)
                )));
            }
        },
    };
    Ok(SignedContent::plugin(kind, &id, &version, &bytes()?))
}
