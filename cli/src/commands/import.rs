use std::fs::File;
use std::io::Read;
use std::path::PathBuf;

use clap::Args;
use htex_author::settings::Metadata;
use htex_exchange::hatt::{Imported, MOST_BYTES, asset, read};
use htex_files::AtFile;

use super::make::write;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::metadata::checked;
use crate::models::tool;
use crate::output::warn;
use crate::outputs::check_outputs;
use crate::shown::shown;

/// Read a texture of another format: a model file of the Penn Haptic Texture Toolkit (XML).
#[derive(Args)]
pub(crate) struct Import {
    /// The file
    #[arg(value_parser = located::RECORDING)]
    file: PathBuf,

    /// The asset to write
    #[arg(short, long, value_name = "HTEX", value_parser = located::OUTPUT)]
    output: PathBuf,

    #[command(flatten)]
    metadata: Metadata,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl Import {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        check_outputs([self.output.as_path()], [self.file.as_path()])?;
        checked(&self.metadata)?;
        let mut bytes = Vec::new();
        // One more byte than allowed, which the reader refuses.
        File::open(&self.file)
            .and_then(|file| file.take(MOST_BYTES as u64 + 1).read_to_end(&mut bytes))
            .reading(&self.file)?;
        let stem = self.output.file_stem().unwrap_or_default();
        let imported = Imported {
            name: &stem.to_string_lossy(),
            tool: &tool(),
        };
        let texture = read(&bytes);
        let made = texture.and_then(|texture| Ok((asset(&texture, &imported)?, texture.notes)));
        let (mut asset, notes) = made.map_err(|fault| {
            let words = format!("{}: {fault}", shown(&self.file));
            Failure::Other(words)
        })?;
        warn(&notes);
        self.metadata.apply(&mut asset.manifest);
        write(&self.output, &asset, self.json)
    }
}
