use std::path::PathBuf;

use clap::Args;
use htex_base::files::{AtFile, OwnFolder};
use htex_base::native::description::{description, description_path, with_section};
use htex_device::AdapterEntry;
use htex_host::{HostError, LoadedModel, WasmLimits};

use crate::failure::{Exit, Failure, Result};
use crate::output::{OutputFile, print, shown, write_file};

/// Make a plugin's descriptor readable without running the plugin
///
/// Writes the plugin's descriptor into a custom section of a WASM module (`htex.descriptor`), or
/// into a file next to a native library (LIBRARY.descriptor.json). For this, the command loads the
/// plugin once. Afterwards, `htex plugin list` and `htex device list` can show the plugin without
/// loading it. If you sign a WASM module, sign it after this command, not before, because this
/// command changes the module.
#[derive(Args)]
pub(crate) struct Export {
    /// The plugin: a model or a device
    file: PathBuf,

    /// For a module: the file to write [default: FILE]
    #[arg(short, long, value_name = "WASM")]
    output: Option<PathBuf>,
}

impl Export {
    pub(crate) fn run(self) -> Result {
        let file = &self.file;
        let descriptor = descriptor(file)?;
        let bytes = std::fs::read(file).reading(file)?;
        if bytes.starts_with(b"\0asm") {
            let module = with_section(&bytes, &descriptor)
                .ok_or_else(|| Failure::Other(format!("{}: not a module", shown(file))))?;
            let output = self.output.as_ref().unwrap_or(file);
            write_file(output, &module)?;
            print(&format!("{}: {} bytes\n", shown(output), module.len()))?;
            return Ok(Exit::SUCCESS);
        }
        if self.output.is_some() {
            return Err(Failure::usage(
                "--output is for modules: the descriptor of a native library is beside the library",
            ));
        }
        let (folder, _) = OwnFolder::of_file(file).writing(file)?;
        let path = description_path(file);
        let name = path.file_name().unwrap_or_default();
        let text = description(&bytes, &descriptor)?;
        OutputFile::Inside(&folder, name.as_ref()).write(text.as_bytes())?;
        print(&format!("{}\n", shown(&path)))?;
        Ok(Exit::SUCCESS)
    }
}

/// Loads a plugin, and returns its descriptor as JSON.
fn descriptor(file: &std::path::Path) -> Result<String> {
    match LoadedModel::from_file_within(file, &WasmLimits::default()) {
        Ok(model) => Ok(serde_json::to_string(model.descriptor())?),
        // A device lacks the functions of a model.
        Err(HostError::NoFunction { .. }) => {
            Ok(serde_json::to_string(AdapterEntry::load(file)?.descriptor())?)
        }
        Err(error) => Err(error.into()),
    }
}
