//! The folder of a new project, for `htex plugin new` and `htex device new`.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use htex_base::files::{AtFile, OwnFolder};
use htex_check::templates::Template;

use crate::failure::{Exit, Failure, Result};
use crate::output::print;

/// The folder `sdk` of the sources from which this program was built; `None` in a released program.
const SDK: Option<&str> = option_env!("HTEX_SDK");

/// Name and folder of a new project, and the source of its crates.
#[derive(Args)]
pub(crate) struct NewProject {
    /// Name of the project: lower-case letters, digits and hyphens
    name: String,

    /// Folder to write to; it must not exist yet [default: the project's name]
    #[arg(long, value_name = "DIR")]
    dir: Option<PathBuf>,

    /// For --lang rust: the folder `sdk` in the sources of htex, whose crates the project uses
    /// instead of the published crates [default: the sources from which this program was built, if
    /// they still exist; a released program has no default]
    #[arg(long, value_name = "DIR")]
    sdk: Option<PathBuf>,
}

impl NewProject {
    /// Writes the project of a template, and prints its folder and how to build it.
    pub(crate) fn write(self, template: &Template) -> Result {
        let dir = self.dir.clone().unwrap_or_else(|| (&self.name).into());
        self.check(&dir)?;
        // The sources are found before the folder is made, so that a wrong --sdk leaves no folder
        // behind.
        let sources = self.sources(template)?;
        let own = OwnFolder::new(&dir);
        own.make_folder(Path::new("")).writing(&dir)?;
        // The folder has to exist, because only then its path can be made canonical.
        let sources = sources.map(|sources| from_project(&dir, sources)).transpose()?;
        for (file, text) in template.files(&self.name, sources.as_deref()) {
            let write = |into: &mut std::fs::File| into.write_all(text.as_bytes());
            let written = own.replace(Path::new(file), write);
            written.writing(dir.join(file))?;
        }
        let (dir, build) = (dir.display(), template.build());
        print(&format!("{dir}\nbuild: {build}  (in {dir})\nthen:  {dir}/README.md\n"))?;
        Ok(Exit::SUCCESS)
    }

    /// Refuses an invalid name and an existing folder.
    fn check(&self, dir: &Path) -> Result<()> {
        let name = &self.name;
        let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-';
        if !name.bytes().all(plain) || !name.starts_with(|c: char| c.is_ascii_lowercase()) {
            let rule = "lower-case letters, digits and hyphens, a letter first";
            return Err(Failure::Usage(format!("`{name}` is not a valid name: {rule}")));
        }
        if dir.exists() {
            let dir = dir.display();
            return Err(Failure::Usage(format!("{dir} exists; name another with --dir")));
        }
        Ok(())
    }

    /// Returns the folder of the sources from which a project of this template takes its crates.
    /// Returns `None` if the template needs no crates, or takes them from the registry.
    fn sources(&self, template: &Template) -> Result<Option<PathBuf>> {
        if template.crates().is_empty() {
            return Ok(None);
        }
        let Some(sdk) = &self.sdk else {
            // The sources may have been deleted since this program was built.
            return Ok(SDK.and_then(|sdk| sources_of(Path::new(sdk), template).ok()));
        };
        sources_of(sdk, template).map(Some)
    }
}

/// Returns the folder of the sources, given its folder `sdk`.
fn sources_of(sdk: &Path, template: &Template) -> Result<PathBuf> {
    let mut sources = sdk.canonicalize().reading(sdk)?;
    sources.pop();
    let manifests = template.crates().iter().map(|(_, path)| sources.join(path).join("Cargo.toml"));
    if let Some(absent) = manifests.into_iter().find(|manifest| !manifest.is_file()) {
        let (sdk, absent) = (sdk.display(), absent.display());
        let what = "--sdk names the folder `sdk` in the sources of htex";
        return Err(Failure::Usage(format!("{sdk}: there is no {absent}; {what}")));
    }
    Ok(sources)
}

/// Returns the path from a project to the sources. It is relative if both are on the same drive.
fn from_project(dir: &Path, sources: PathBuf) -> Result<String> {
    // Compares the parts of the paths as they are written, so both have to be canonical.
    let dir = dir.canonicalize().reading(dir)?;
    let path = pathdiff::diff_paths(&sources, dir).unwrap_or(sources);
    let text = path.display().to_string();
    // Cargo accepts slashes on every system.
    Ok(if cfg!(windows) { text.replace('\\', "/") } else { text })
}
