//! Makes the folder of an archive: the command, libhtex, the models as plugins, textures, and texts.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, ensure};
use fs_err as fs;

use super::parts::put_notices;
use crate::dist::{Dist, copy, dist, of_command};
use crate::places::{cargo, release_trees, target, workspace};
use crate::platform::{Build, Platform, System};
use crate::plugins::models;
use crate::programs::{output, run};

/// Files of the workspace that every archive contains, and their paths in the archive.
const FILES: [(&str, &str); 11] = [
    ("LICENSE-MIT", "share/doc/htex/LICENSE-MIT"),
    ("LICENSE-APACHE", "share/doc/htex/LICENSE-APACHE"),
    ("CHANGELOG.md", "share/doc/htex/CHANGELOG.md"),
    ("xtask/src/release/desktop/htex.xml", "share/mime/packages/htex.xml"),
    ("xtask/src/release/desktop/org.htex.htex.desktop", "share/applications/org.htex.htex.desktop"),
    ("sdk/bindings/studio/public/icon.svg", "share/icons/hicolor/scalable/apps/org.htex.htex.svg"),
    ("xtask/src/release/desktop/htex.magic", "share/htex/desktop/htex.magic"),
    ("xtask/src/release/desktop/htex.reg", "share/htex/desktop/htex.reg"),
    ("xtask/src/release/desktop/htex-uti.plist", "share/htex/desktop/htex-uti.plist"),
    ("sdk/bindings/studio/shelf/shelf.htexlib", "share/htex/textures.htexlib"),
    ("xtask/src/release/README.md", "README.md"),
];

/// The folders of conformance files in `spec`.
const CONFORMANCE: [&str; 6] = [
    "conformance",
    "library-conformance",
    "scene-conformance",
    "recording-conformance",
    "baked-conformance",
    "playing-conformance",
];

/// The page of catalogues.
const CATALOGUE: &str = "catalogue.html";

/// Where each shell looks for completions, relative to a prefix.
const COMPLETIONS: [(&str, &str); 4] = [
    ("bash", "share/bash-completion/completions/htex"),
    ("zsh", "share/zsh/site-functions/_htex"),
    ("fish", "share/fish/vendor_completions.d/htex.fish"),
    ("powershell", "share/powershell/htex.ps1"),
];

/// Returns a platform's folder, which has the same name as the archive.
pub(super) fn folder(platform: &Platform, version: &str) -> PathBuf {
    release_trees().join(format!("htex-{version}-{}", platform.name))
}

/// Builds everything for a platform, and returns the folder, which has the same name as the
/// archive.
pub(super) fn lay_out(build: &Build, version: &str, notices: Option<&Path>) -> Result<PathBuf> {
    let platform = &build.platform();
    let folder = folder(platform, version);
    crate::places::emptied(&folder)?;
    command(build, &folder)?;
    dist(&Dist { prefix: folder.clone(), whole: true, build: build.clone() })?;
    plugins(build, &folder)?;
    catalogue(&folder)?;
    for (from, to) in FILES {
        copy(&workspace().join(from), &folder.join(to))?;
    }
    conformance(&folder)?;
    help(platform, &folder)?;
    if let Some(notices) = notices {
        put_notices(notices, &folder.join("share/doc/htex"))?;
        // Only a release is built without this machine's paths (`Build::for_release`).
        check_paths(&folder)?;
    }
    Ok(folder)
}

/// Builds the command, together with the whole library.
fn command(build: &Build, folder: &Path) -> Result<()> {
    run(build.cargo_of_both().args(of_command(build)))?;
    let name = executable(build.platform().system);
    copy(&build.built().join(name), &folder.join("bin").join(name))
}

/// Copies the page that `htex lib catalogue` fills in. If the tests of the studio have already
/// built this page, copies their page.
fn catalogue(folder: &Path) -> Result<()> {
    let tested = target().join("bindings/studio/page");
    let page = if tested.join(CATALOGUE).is_file() { tested } else { target().join("studio") };
    if !page.join(CATALOGUE).is_file() {
        crate::studio::studio(&page)?;
    }
    copy(&page.join(CATALOGUE), &folder.join("share/htex/studio").join(CATALOGUE))
}

/// Copies the files on which `htex conformance run` runs a reader.
fn conformance(folder: &Path) -> Result<()> {
    let to = folder.join("share/htex/conformance");
    for part in CONFORMANCE {
        let from = workspace().join("spec").join(part);
        for file in crate::places::files(&from)? {
            let name = file.file_name().unwrap_or_default();
            copy(&file, &to.join(part).join(name))?;
        }
    }
    Ok(())
}

fn executable(system: System) -> &'static str {
    match system {
        System::Windows => "htex.exe",
        _ => "htex",
    }
}

/// Builds the models as native libraries and as modules.
fn plugins(build: &Build, folder: &Path) -> Result<()> {
    let (prefix, suffix) = match build.platform().system {
        System::Linux => ("lib", "so"),
        System::MacOs => ("lib", "dylib"),
        System::Windows => ("", "dll"),
    };
    let to = folder.join("lib/htex/plugins");
    let modules = crate::plugins::wasm()?;
    for model in models()? {
        // The models are built with the same settings as the command, so that their shared code is
        // built only once. Each module contains one model.
        let mut cargo = build.cargo("rustc");
        cargo.args(["--quiet", "--locked", "--lib", "--package", &format!("htex-{model}")]);
        cargo.args(build.profile());
        cargo.args(["--features", "plugin", "--crate-type", "cdylib"]);
        let native = format!("{prefix}htex_{model}.{suffix}");
        if build.platform().system == System::MacOs {
            // Otherwise the library's install name would be the path at which it was built.
            let name = format!("-Clink-arg=-Wl,-install_name,@rpath/{native}");
            cargo.args(["--", &name]);
        }
        run(&mut cargo)?;
        copy(&build.built().join(&native), &to.join(&native))?;
        let module = format!("htex_{model}.wasm");
        copy(&modules.join(&module), &to.join(&module))?;
    }
    Ok(())
}

/// Adds the manual pages and completions that the command writes. If the built command cannot run
/// on this machine, this machine's own command writes them; it has the same arguments.
fn help(platform: &Platform, folder: &Path) -> Result<()> {
    let own = folder.join("bin").join(executable(platform.system));
    let htex = |words: &[&str]| {
        let mut command =
            if Platform::here()? == *platform { Command::new(&own) } else { Command::new(cargo()) };
        if Platform::here()? != *platform {
            command.args(["run", "--quiet", "--locked", "--profile", "quick"]);
            command.args(["--package", "htex-cli", "--"]);
        }
        command.args(words).current_dir(workspace());
        anyhow::Ok(command)
    };
    let pages = std::path::absolute(folder.join("share/man/man1"))?;
    run(&mut htex(&["man", &pages.to_string_lossy()])?)?;
    for (shell, to) in COMPLETIONS {
        let text = output(&mut htex(&["completions", shell])?)?;
        let to = folder.join(to);
        fs::create_dir_all(to.parent().unwrap_or(folder))?;
        fs::write(to, text)?;
    }
    Ok(())
}

/// Checks that no file reveals where it was built.
pub(super) fn check_paths(folder: &Path) -> Result<()> {
    let workspace = fs::canonicalize(workspace())?;
    let home = std::env::var_os("HOME").map(PathBuf::from);
    let registry = home.map(|home| home.join(".cargo"));
    for place in std::iter::once(workspace).chain(registry) {
        let output = Command::new("grep").args(["-rlF", "--"]).arg(&place).arg(folder).output()?;
        let files = String::from_utf8_lossy(&output.stdout).into_owned();
        ensure!(files.is_empty(), "{} is named in\n{files}", place.display());
    }
    Ok(())
}
