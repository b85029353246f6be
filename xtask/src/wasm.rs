//! Toolchains for `wasm32-unknown-unknown`.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use clap::ValueEnum;

/// The target of modules.
pub(crate) const TARGET: &str = "wasm32-unknown-unknown";

/// The profile of modules in the workspace's manifest, and the name of its build folder.
pub(crate) const PROFILE: &str = "module";

/// The environment variable for the compiler flags of modules, and the flags. They enable 128-bit
/// vectors, which every engine supports. The compiler does not inline large functions. It does not
/// copy the body of a loop in order to unroll the loop, to treat the first round separately, or to
/// use vectors. (Loops that should use vectors work on arrays.) Messages of panics do not contain
/// the folder of the crates.
const FLAGS: (&str, &str) = (
    "CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS",
    "-Ctarget-feature=+simd128 -Cno-vectorize-loops -Cllvm-args=-inline-threshold=75 \
     -Cllvm-args=-unroll-runtime=false -Cllvm-args=-unroll-allow-partial=false -Cllvm-args=-unroll-allow-peeling=false \
     --remap-path-prefix=sdk/core/=",
);

const NO_TOOLCHAIN: &str = "no toolchain for WASM modules was found: `rustup target add \
    wasm32-unknown-unknown`, or on Debian `apt-get install rustc-web cargo-web rust-web-src`";

/// How a toolchain for WASM modules is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Way {
    /// The first toolchain that is found.
    Auto,
    /// The toolchain in use.
    Installed,
    /// Debian's own compiler.
    Debian,
}

/// A toolchain for WASM modules.
pub(crate) enum Toolchain {
    /// The toolchain in use, which has the target's standard library.
    Ready,
    /// Debian's own compiler, which builds the standard library first, and this linker.
    Debian { linker: PathBuf },
}

impl Toolchain {
    /// Finds a toolchain. Installs nothing.
    pub(crate) fn find(way: Way) -> Result<Self> {
        let found = match way {
            Way::Installed => installed(),
            Way::Debian => debian(),
            Way::Auto => installed().or_else(debian),
        };
        found.context(NO_TOOLCHAIN)
    }

    /// Returns cargo, to which `rustc --profile …` can be added, and the build folder.
    pub(crate) fn cargo(&self, target: &Path) -> (Command, PathBuf) {
        let (mut command, folder) = self.plain_cargo(target);
        command.env(FLAGS.0, FLAGS.1);
        (command, folder)
    }

    fn plain_cargo(&self, target: &Path) -> (Command, PathBuf) {
        match self {
            Self::Ready => (Command::new(crate::places::cargo()), target.to_owned()),
            Self::Debian { linker } => {
                let mut command = Command::new("/usr/bin/cargo");
                command
                    .env("RUSTC", "/usr/bin/rustc")
                    // A stable compiler needs this variable for `-Z build-std`.
                    .env("RUSTC_BOOTSTRAP", "1")
                    .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker)
                    .env_remove("RUSTUP_TOOLCHAIN");
                // A separate folder, because the files of the two compilers would overwrite each
                // other.
                (command, target.join("debian"))
            }
        }
    }

    /// Returns arguments for use after `rustc`.
    pub(crate) fn arguments(&self) -> &'static [&'static str] {
        match self {
            Self::Ready => &["--target", TARGET],
            Self::Debian { .. } => {
                // Debian's compiler may be older than the version that the manifests require.
                &["-Z", "build-std=std,panic_abort", "--ignore-rust-version", "--target", TARGET]
            }
        }
    }
}

fn installed() -> Option<Toolchain> {
    has_target().then_some(Toolchain::Ready)
}

fn debian() -> Option<Toolchain> {
    let linker = linker().filter(|_| is_debian_ready())?;
    Some(Toolchain::Debian { linker })
}

/// Whether the compiler in use has the target's standard library.
fn has_target() -> bool {
    let answer = answer("rustc", &["--print", "target-libdir", "--target", TARGET]);
    answer.is_some_and(|libraries| Path::new(&libraries).is_dir())
}

fn is_debian_ready() -> bool {
    let std = Path::new("/usr/lib/rustlib/src/rust/library/std");
    Path::new("/usr/bin/cargo").exists() && Path::new("/usr/bin/rustc").exists() && std.exists()
}

/// Returns the linker of the current compiler. Every compiler from rustup includes one.
fn linker() -> Option<PathBuf> {
    let sysroot = answer("rustc", &["--print", "sysroot"])?;
    let host = answer("rustc", &["--print", "host-tuple"])?;
    let own = Path::new(&sysroot).join("lib/rustlib").join(host).join("bin/rust-lld");
    [own, PathBuf::from("/usr/bin/wasm-ld")].into_iter().find(|linker| linker.exists())
}

/// Returns what a program prints, if it succeeds.
fn answer(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
