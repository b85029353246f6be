//! Tests a release in a Debian root without compilers, on this machine's processor or on a
//! processor that QEMU emulates.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use clap::Args;
use fs_err as fs;

use super::{Compiler, Folder, archive};
use crate::places::{emptied, target};
use crate::programs::{program, run};

/// A processor for which a root is made.
struct Processor {
    /// Name as it appears in the names of archives and wheels.
    name: &'static str,
    /// Debian's name for it.
    debian: &'static str,
    compiler: Compiler,
}

const LIBRARIES: &str = "htex static whole whole_static";

const PROCESSORS: [Processor; 2] = [
    Processor {
        name: "x86_64",
        debian: "amd64",
        compiler: Compiler {
            gcc: "gcc",
            package: "gcc",
            system: "Linux",
            processor: "x86_64",
            libraries: LIBRARIES,
        },
    },
    Processor {
        name: "aarch64",
        debian: "arm64",
        compiler: Compiler {
            gcc: "aarch64-linux-gnu-gcc",
            package: "gcc-aarch64-linux-gnu",
            system: "Linux",
            processor: "aarch64",
            libraries: LIBRARIES,
        },
    },
];

/// The script that runs in the root. It first checks that the root has no compilers.
const SCRIPT: &str = "\
set -eu
for compiler in cc gcc clang rustc cargo; do
    if command -v $compiler; then echo \"this root has $compiler\"; exit 1; fi
done
cd /htex
htex=/htex/NAME/bin/htex
begin() { echo \"released: $1\"; }
begin command
$htex --version
$htex demo out >demo.txt
tail -n 5 demo.txt
$htex simulate --surface vinyl --seconds 4 -o rec.csv
$htex fit rec.csv -o vinyl.htex --name Vinyl --license CC0-1.0 >fit.txt
$htex validate vinyl.htex
$htex synth vinyl.htex --seconds 1 -o built-in.wav
for plugin in /htex/NAME/lib/htex/plugins/*; do
    $htex plugin info $plugin >/dev/null
done
begin C
for play in play_pkg_config play_htex play_static play_whole play_whole_static; do
    LD_LIBRARY_PATH=/htex/NAME/lib ./$play vinyl.htex $play.f32
    cmp $play.f32 play_pkg_config.f32
done
LD_LIBRARY_PATH=/htex/NAME/lib/whole ./play_whole vinyl.htex whole.f32
cmp whole.f32 play_pkg_config.f32
begin Python
python3 -m venv python
python/bin/pip install --quiet --no-index --find-links wheels htex
python/bin/python page.py
begin files
sha256sum rec.csv vinyl.htex built-in.wav play_pkg_config.f32
";

/// The commands of a page for Python users.
const PAGE: &str = "\
import htex
fit = htex.fit('rec.csv', name='Vinyl', license='CC0-1.0')
fit.texture.save('python.htex')
texture = htex.open('python.htex')
voice = texture.voice(seed=7)
voice.set_motion(80.0, 0.4)
samples = voice.render(20000)
print(texture.models, float(samples.std()))
assert samples.std() > 0
";

/// Versions of the C library that wheels for another processor may name.
const MANYLINUX: [&str; 4] = ["2_31", "2_28", "2_27", "2_17"];

#[derive(Debug, Args)]
pub struct Bare {
    #[command(flatten)]
    folder: Folder,
    /// The processor: x86_64, or aarch64, which QEMU emulates
    #[arg(long, value_name = "NAME", default_value = "x86_64")]
    processor: String,
}

/// Uses the release in an empty Debian root.
pub(in crate::prove) fn bare(options: &Bare) -> Result<()> {
    let released = options.folder.released()?;
    let processor = PROCESSORS.iter().find(|one| one.name == options.processor);
    let processor = processor.context("--processor: x86_64 or aarch64")?;
    let name = processor.name;
    let ending = format!("-{name}-linux.tar.xz");
    let (archive, stem) = archive(&released, &ending)?;
    let root = root(processor)?;
    let work = root.join("htex");
    emptied(&work)?;
    run(program("tar", &work).arg("-xf").arg(archive))?;
    let unpacked = format!("{stem}-{name}-linux");
    processor.compiler.players(&work.join(&unpacked), &work)?;
    wheels(&released, processor, &work)?;
    fs::write(work.join("page.py"), PAGE)?;
    fs::write(work.join("script.sh"), SCRIPT.replace("NAME", &unpacked))?;
    let mut chroot = Command::new("chroot");
    chroot.arg(&root).args(["/bin/sh", "/htex/script.sh"]).env_clear();
    run(chroot.env("PATH", "/usr/sbin:/usr/bin:/bin").env("HOME", "/root").env("LC_ALL", "C.UTF-8"))
}

/// Collects the wheel and its dependencies, for the root's Python.
fn wheels(released: &Path, processor: &Processor, work: &Path) -> Result<()> {
    let is_it = |file: &PathBuf| {
        let file = file.to_string_lossy();
        file.ends_with(".whl") && file.contains("linux") && file.contains(processor.name)
    };
    let wheel = crate::places::files(released)?.into_iter().rfind(is_it);
    let wheel = wheel.with_context(|| format!("no wheel for Linux on {}", processor.name))?;
    let mut pip = program("python3", work);
    pip.args(["-m", "pip", "download", "--quiet", "--only-binary=:all:"]);
    pip.args(["--python-version", "3.11"]);
    if processor.name != std::env::consts::ARCH {
        for version in MANYLINUX {
            pip.args(["--platform", &format!("manylinux_{version}_{}", processor.name)]);
        }
    }
    run(pip.args(["--dest", "wheels"]).arg(wheel))
}

/// Makes the root for this machine's processor.
pub(in crate::prove) fn bare_root() -> Result<()> {
    root(&PROCESSORS[0]).map(drop)
}

/// Makes a Debian 12 root with Python and without compilers, unless it already exists.
fn root(processor: &Processor) -> Result<PathBuf> {
    let folder = match processor.debian {
        "amd64" => "bare-root".to_owned(),
        other => format!("bare-root-{other}"),
    };
    let root = std::path::absolute(target().join(folder))?;
    let is_made = root.join("made");
    if !is_made.exists() {
        let mut debootstrap = Command::new("debootstrap");
        debootstrap.args(["--variant=minbase", "--include=python3-venv", "--arch"]);
        debootstrap.args([processor.debian, "bookworm"]);
        run(debootstrap.arg(&root).arg("http://deb.debian.org/debian")).context(
            "as root, with the package debootstrap; another processor also needs qemu-user-static and binfmt-support",
        )?;
        // This file is written last, so that an incomplete root does not count as made.
        fs::write(is_made, "")?;
    }
    Ok(root)
}
