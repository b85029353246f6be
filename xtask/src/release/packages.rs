//! Archives, wheels and the npm package.

use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Result, ensure};
use fs_err as fs;

use super::parts::put_notices;
use super::tree;
use crate::commit::Commit;
use crate::places::{cargo, emptied, release_trees, target, workspace};
use crate::platform::{Build, Platform, System, tools};
use crate::programs::{program, run};

/// Tools that a release needs, apart from Rust, Node.js and the platforms' linkers.
const TOOLS: [(&str, &str); 5] = [
    ("cargo-zigbuild", PYTHON_TOOLS),
    ("python-zig", PYTHON_TOOLS),
    ("maturin", PYTHON_TOOLS),
    (
        "cargo-about",
        "cargo install cargo-about --version 0.9.3 --features cli --locked --root target/release-tools",
    ),
    (
        "cargo-cyclonedx",
        "cargo install cargo-cyclonedx --version 0.5.9 --locked --root target/release-tools",
    ),
];

const PYTHON_TOOLS: &str = "python3 -m venv target/release-tools && target/release-tools/bin/pip install -r xtask/src/release/requirements.txt";

/// # Errors
/// The error says which tool is missing and how to install it. A trial needs only maturin.
pub(super) fn check_tools(is_trial: bool) -> Result<()> {
    for (name, how) in TOOLS.iter().filter(|(name, _)| !is_trial || *name == "maturin") {
        let there = tools().join(name).is_file();
        ensure!(there, "{name} is missing: {how}");
    }
    Ok(())
}

/// Writes a folder as an archive.
pub(super) fn archive(build: &Build, folder: &Path, out: &Path, commit: &Commit) -> Result<()> {
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    if build.platform().system == System::Windows {
        return zip(folder, out, commit);
    }
    // A single thread is used because otherwise the bytes depend on the number of threads. A trial,
    // which nobody downloads, is compressed less and takes a sixth of the time.
    let compressor = if build.is_release() { "xz -9 -T1" } else { "xz -1 -T1" };
    tar(folder, &out.join(format!("{name}.tar.xz")), compressor, commit)
}

/// Writes a folder as a compressed tar file, with sorted names and the commit's time.
fn tar(folder: &Path, to: &Path, compressor: &str, commit: &Commit) -> Result<()> {
    let mut tar = program("tar", folder.parent().unwrap_or(folder));
    tar.args(["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--format=gnu"]);
    tar.args([
        // The umask of this machine must not change the bytes.
        "--mode=u+rwX,go+rX,go-w",
        &format!("--mtime=@{}", commit.seconds),
        "-I",
        compressor,
        "-cf",
    ]);
    run(tar.arg(to).arg(folder.file_name().unwrap_or_default()))
}

/// Writes a folder as a zip file with the same name.
pub(super) fn zip(folder: &Path, out: &Path, commit: &Commit) -> Result<()> {
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    run(program("python3", folder.parent().unwrap_or(folder))
        .args(["-c", ZIP])
        .arg(out.join(format!("{name}.zip")))
        .arg(&*name)
        .arg(&commit.seconds))
}

/// A Python program that writes a folder as a zip file, with sorted names and the commit's time.
const ZIP: &str = "\
import pathlib, sys, time, zipfile
to, name, seconds = sys.argv[1:]
at = time.gmtime(int(seconds))[:6]
with zipfile.ZipFile(to, 'w', zipfile.ZIP_DEFLATED, compresslevel=9) as out:
    for path in sorted(pathlib.Path(name).rglob('*')):
        if path.is_file():
            entry = zipfile.ZipInfo(path.as_posix(), at)
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            out.writestr(entry, path.read_bytes())
";

/// Writes a platform's wheel.
pub(super) fn wheel(build: &Build, out: &Path, notices: Option<&Path>) -> Result<()> {
    let platform = build.platform();
    let mut maturin = build.maturin("build");
    maturin.arg("--locked").args(build.profile());
    if build.is_release() {
        maturin.args(["--target", platform.triple]);
    }
    if build.is_by_zig() {
        maturin.arg("--zig");
    }
    if build.is_release() && platform.system == System::Linux {
        maturin.args(["--compatibility", "manylinux_2_31"]);
    }
    maturin.env("CARGO_TARGET_DIR", std::path::absolute(target())?);
    let Some(notices) = notices else {
        return run(maturin.arg("--out").arg(out));
    };
    // The licences go next to the Python modules, because maturin packs that folder as it is.
    let package = workspace().join("sdk/bindings/python/python/htex");
    put_notices(notices, &package)?;
    let folder = anew("wheel")?;
    let built = run(maturin.arg("--out").arg(&folder));
    // Removed even after a failed build, because the file is among the sources.
    fs::remove_file(package.join(notices.file_name().unwrap_or_default()))?;
    built?;
    for wheel in crate::places::files(&folder)? {
        // A wheel is compressed, so its files have to be unpacked before paths can be found in
        // them.
        let unpacked = anew("wheel-unpacked")?;
        run(program("python3", &unpacked).args(["-m", "zipfile", "-e"]).arg(&wheel).arg("."))?;
        tree::check_paths(&unpacked)?;
        fs::copy(&wheel, out.join(wheel.file_name().unwrap_or_default()))?;
    }
    Ok(())
}

/// Makes an empty folder of this name for intermediate files.
fn anew(name: &str) -> Result<PathBuf> {
    let folder = release_trees().join(name);
    emptied(&folder)?;
    Ok(fs::canonicalize(folder)?)
}

/// Writes the sources of the Python package, which pip builds if there is no wheel for a platform.
///
/// Maturin leaves out some packages of the workspace, but not their lines in `Cargo.lock`. A build
/// with `--locked` refuses these lines, so cargo removes them here.
pub(super) fn sdist(version: &str, out: &Path, commit: &Commit) -> Result<()> {
    let trees = release_trees();
    let (folder, packed) = (anew(&format!("htex-{version}"))?, anew("sdist")?);
    let build = Build::release(Platform::here()?, commit);
    run(build.maturin("sdist").arg("--out").arg(&packed))?;
    let name = format!("htex-{version}.tar.gz");
    run(program("tar", &trees).arg("-xzf").arg(packed.join(&name)))?;
    let metadata = |more: &str| -> Result<()> {
        let mut cargo = program(cargo(), &folder.join("sdk/bindings/python"));
        cargo.args(["metadata", "--format-version", "1", more]);
        run(cargo.stdout(Stdio::null()))
    };
    metadata("--offline")?;
    metadata("--locked")?;
    // `-n` leaves out the time of packing.
    tar(&folder, &out.join(name), "gzip -n -9", commit)
}

/// Writes the npm package.
pub(super) fn npm(out: &Path, notices: Option<&Path>) -> Result<()> {
    let folder = anew("npm")?;
    crate::web::web(&folder)?;
    if let Some(notices) = notices {
        put_notices(notices, &folder)?;
    }
    tree::check_paths(&folder)?;
    run(program("npm", &folder).args(["pack", "--silent", "--pack-destination"]).arg(out))
}
