//! Makes an example registry of plugins: the built-in models as modules, and the output and the
//! input in `examples`.

use std::path::{Path, PathBuf};

use anyhow::Result;
use fs_err as fs;

use crate::places::{emptied, files, target, workspace};
use crate::plugins::wasm;
use crate::programs::{program, run};

/// The devices: files in C in folders of `examples`.
const DEVICES: [&str; 2] = ["device-c-strip/strip.c", "device-c-ridges/ridges.c"];
/// Address of the sources.
const SOURCES: &str = "https://github.com/htex-project/htex/tree/main";

/// Writes the registry to a folder. `htex` is the command, which signs the plugins with a new key.
///
/// # Errors
/// The error names the plugin that cannot be built or added.
pub fn registry(out: &Path, htex: &Path) -> Result<()> {
    fs::create_dir_all(out)?;
    let out = fs::canonicalize(out)?;
    let folder = std::path::absolute(target().join("registry"))?;
    emptied(&folder)?;
    let htex = |arguments: &[&str]| {
        let mut command = program(htex, &folder);
        run(command.args(arguments).env("HTEX_CONFIG_DIR", folder.join("settings")))
    };
    htex(&["key", "new", "example"])?;
    for (plugin, source) in built(&folder)? {
        let (plugin, out) = (plugin.to_string_lossy(), out.to_string_lossy());
        let source = format!("{SOURCES}/{source}");
        htex(&["plugin", "export", &plugin])?;
        htex(&["sign", &plugin])?;
        let texts = ["--license", "MIT OR Apache-2.0", "--source", &source];
        htex(&[&["registry", "add", &out, &plugin][..], &texts].concat())?;
    }
    Ok(())
}

/// Builds the plugins in a folder. Returns their files, each with the folder of its sources.
fn built(folder: &Path) -> Result<Vec<(PathBuf, String)>> {
    let mut plugins = Vec::new();
    for module in files(&wasm()?)? {
        let name = module.file_name().unwrap_or_default().to_string_lossy();
        let Some(model) = name.strip_prefix("htex_").and_then(|name| name.strip_suffix(".wasm"))
        else {
            continue;
        };
        let copy = folder.join(&*name);
        fs::copy(&module, &copy)?;
        plugins.push((copy, format!("plugins/{model}")));
    }
    for source in DEVICES {
        let source = Path::new("examples").join(source);
        let library = folder.join(source.file_stem().unwrap_or_default());
        let library = library.with_extension(std::env::consts::DLL_EXTENSION);
        let mut cc = program("cc", &workspace());
        cc.args(["-std=c11", "-D_POSIX_C_SOURCE=200809L", "-O2", "-fvisibility=hidden", "-shared"]);
        cc.args(["-fPIC", "-I", "spec/include", "-o"]).arg(&library).arg(&source);
        run(cc.args(["-lm", "-pthread"]))?;
        let folder = source.parent().unwrap_or(&source).to_string_lossy().into_owned();
        plugins.push((library, folder));
    }
    Ok(plugins)
}
