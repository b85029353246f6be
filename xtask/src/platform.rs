//! The systems for which htex is built, and how to call cargo, the linkers and the C compilers for
//! each system.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Result, bail};

use crate::commit::Commit;
use crate::places::{cargo, target, workspace};

/// Oldest Linux C library with which released programs run.
const GLIBC: &str = "2.31";

/// Oldest macOS with which released programs run: the first one for Apple's processors.
const MACOS: &str = "11.0";

const STRIP: &str = "-Cstrip=symbols";

/// Cargo's profile for tests, whose folder is named `debug`.
const TESTS: &str = "dev";

/// A system for which htex is released.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Platform {
    /// Name as it appears in the names of archives.
    pub name: &'static str,
    /// Cargo's name for the target.
    pub triple: &'static str,
    /// Prefix of the names of the binary utilities.
    utilities: &'static str,
    pub system: System,
}

/// An operating system, which determines the names and kinds of libraries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum System {
    Linux,
    Windows,
    MacOs,
}

/// All platforms.
pub const PLATFORMS: [Platform; 4] = [
    Platform {
        name: "x86_64-linux",
        triple: "x86_64-unknown-linux-gnu",
        utilities: "",
        system: System::Linux,
    },
    Platform {
        name: "aarch64-linux",
        triple: "aarch64-unknown-linux-gnu",
        utilities: "aarch64-linux-gnu-",
        system: System::Linux,
    },
    Platform {
        name: "x86_64-windows",
        triple: "x86_64-pc-windows-gnu",
        utilities: "x86_64-w64-mingw32-",
        system: System::Windows,
    },
    Platform {
        name: "macos",
        triple: "aarch64-apple-darwin",
        utilities: "",
        system: System::MacOs,
    },
];

/// How to build something. A build for this machine uses the machine's own tools. A release uses
/// zig, whose headers and libraries for each system are the same on every machine. A release for
/// Windows uses mingw-w64 instead: zig's linker would export all functions of a DLL, but a DLL can
/// export at most 65,535.
#[derive(Debug, Clone)]
pub struct Build {
    platform: Platform,
    /// The commit that is released; `None` outside a release.
    commit: Option<Commit>,
}

impl Platform {
    /// Returns the platform with a name. `linux-x86_64` and `x86_64-linux` are the same.
    ///
    /// # Errors
    /// A message with the known names.
    pub fn find(name: &str) -> Result<Self> {
        let turned = name.split_once('-').map(|(a, b)| format!("{b}-{a}"));
        let is_it = |one: &&Self| one.name == name || Some(one.name) == turned.as_deref();
        let names = || PLATFORMS.map(|one| one.name).join(", ");
        match PLATFORMS.iter().find(is_it) {
            Some(platform) => Ok(*platform),
            None => bail!("no platform {name}; known are {}", names()),
        }
    }

    /// Whether a release has a wheel for this platform. A wheel for macOS would need Apple's
    /// frameworks for certificates, which are not available here. On macOS, pip builds the package
    /// from the sources.
    pub(crate) fn has_wheel(&self) -> bool {
        self.system != System::MacOs
    }

    /// Returns the platform on which this program runs.
    ///
    /// # Errors
    /// On unknown platforms.
    pub fn here() -> Result<Self> {
        let (cpu, system) = (std::env::consts::ARCH, std::env::consts::OS);
        match system {
            "macos" => Self::find("macos"),
            _ => Self::find(&format!("{cpu}-{system}")),
        }
    }
}

impl Build {
    /// Builds for this machine.
    ///
    /// # Errors
    /// As [`Platform::here`].
    pub fn here() -> Result<Self> {
        Ok(Self { platform: Platform::here()?, commit: None })
    }

    /// Builds for a release.
    pub(crate) fn release(platform: Platform, commit: &Commit) -> Self {
        Self { platform, commit: Some(commit.clone()) }
    }

    pub fn platform(&self) -> Platform {
        self.platform
    }

    /// Whether this is a build for a release.
    pub fn is_release(&self) -> bool {
        self.commit.is_some()
    }

    /// Whether zig compiles C and links.
    pub(crate) fn is_by_zig(&self) -> bool {
        self.is_release() && self.platform.system != System::Windows
    }

    /// Returns cargo with `build` or `rustc`.
    pub fn cargo(&self, verb: &str) -> Command {
        let mut command = if self.is_by_zig() {
            Command::new(tools().join("cargo-zigbuild"))
        } else {
            Command::new(cargo())
        };
        // cargo-zigbuild has a subcommand `zigbuild` instead of `build`.
        let is_build = self.is_by_zig() && verb == "build";
        command.arg(if is_build { "zigbuild" } else { verb });
        command.current_dir(workspace());
        if let Some(commit) = &self.commit {
            command.args(["--target", &with_glibc(&self.platform)]);
            self.for_release(&mut command, commit);
        }
        command
    }

    /// Returns maturin, which builds wheels, with a subcommand.
    pub fn maturin(&self, verb: &str) -> Command {
        let mut command = Command::new(tools().join("maturin"));
        command.arg(verb).current_dir(workspace().join("sdk/bindings/python"));
        if let Some(commit) = &self.commit {
            self.for_release(&mut command, commit);
        }
        command
    }

    fn for_release(&self, command: &mut Command, commit: &Commit) {
        commit.told_to(command);
        command.env("PATH", tools_first());
        command.env("MACOSX_DEPLOYMENT_TARGET", MACOS);
        command.env("RUSTFLAGS", self.flags());
        // cargo-zigbuild and maturin (which contains cargo-zigbuild) name their C compilers after
        // the running program. If both have the same name and the same version (requirements.txt),
        // the wheel reuses the crates that were compiled for the archive.
        command.env("CARGO_BIN_EXE_cargo-zigbuild", tools().join("cargo-zigbuild"));
    }

    /// Returns compiler flags that keep this machine's paths and the names of functions out of
    /// released files. They also tell zig where this project lists the names of Apple's functions
    /// that zig lacks.
    fn flags(&self) -> String {
        let mut flags = vec![without_places()];
        match self.platform.system {
            // Zig already leaves out the names of functions.
            System::Linux => {}
            System::MacOs => {
                let apple = workspace().join("xtask/src/release/apple");
                let apple = std::path::absolute(&apple).unwrap_or(apple);
                for kind in ["framework", "native"] {
                    flags.push(format!("-L{kind}={}", apple.display()));
                }
                flags.push(STRIP.to_owned());
            }
            System::Windows => flags.push(STRIP.to_owned()),
        }
        flags.join(" ")
    }

    /// Returns cargo for building the command and the whole libhtex together, so that both have the
    /// same features. With the tests' profile, cargo builds the entire workspace, so that it reuses
    /// the crates of the tests.
    pub(crate) fn cargo_of_both(&self) -> Command {
        let mut command = self.cargo("build");
        command.arg("--locked").args(self.profile());
        if !self.is_of_tests() {
            command.args(["--package", "htex-cli", "--package", "htex-capi"]);
        }
        command
    }

    /// Returns cargo's arguments that select the profile: `release` or, outside releases, the
    /// profile in `HTEX_PROFILE`. With the profile of the tests, a build reuses the crates that
    /// were compiled for the tests.
    pub(crate) fn profile(&self) -> [String; 2] {
        ["--profile".to_owned(), self.profile_name()]
    }

    /// Whether the build has the profile of the tests.
    pub(crate) fn is_of_tests(&self) -> bool {
        self.profile_name() == TESTS
    }

    fn profile_name(&self) -> String {
        let named = std::env::var("HTEX_PROFILE")
            .ok()
            .filter(|name| !name.is_empty() && !self.is_release());
        named.unwrap_or_else(|| "release".to_owned())
    }

    /// Returns where cargo puts what it builds with [`Self::profile`].
    pub(crate) fn built(&self) -> PathBuf {
        match &*self.profile_name() {
            TESTS => self.output("debug"),
            name => self.output(name),
        }
    }

    /// Returns where cargo puts what it builds with a profile.
    pub fn output(&self, profile: &str) -> PathBuf {
        if self.is_release() {
            target().join(self.platform.triple).join(profile)
        } else {
            target().join(profile)
        }
    }

    /// Returns the C compiler, which also links.
    pub fn cc(&self) -> Command {
        if !self.is_release() {
            return Command::new("cc");
        }
        let mut command = Command::new(tools().join("python"));
        command.args(["-m", "ziglang", "cc", "-target", &zig_target(&self.platform)]);
        command
    }

    /// Returns one of the platform's binary utilities, such as `ld`.
    pub fn utility(&self, name: &str) -> Command {
        let prefix = if self.is_release() { self.platform.utilities } else { "" };
        Command::new(format!("{prefix}{name}"))
    }
}

/// Returns compiler flags that keep this machine's paths out of its output.
pub(crate) fn without_places() -> String {
    let home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".cargo")));
    let sources = std::fs::canonicalize(workspace()).unwrap_or_else(|_| workspace());
    let places = home.into_iter().map(|home| (home, "/cargo"));
    let all = places.chain(std::iter::once((sources, "/htex")));
    let flag = |(from, to): (PathBuf, &str)| format!("--remap-path-prefix={}={to}", from.display());
    all.map(flag).collect::<Vec<_>>().join(" ")
}

/// Returns the folder of the release tools: zig, and the programs through which cargo calls zig.
pub fn tools() -> PathBuf {
    let tools = target().join("release-tools/bin");
    std::path::absolute(&tools).unwrap_or(tools)
}

/// Returns the search path with the release tools first.
pub fn tools_first() -> std::ffi::OsString {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(tools()).chain(std::env::split_paths(&path));
    std::env::join_paths(folders).unwrap_or(path)
}

/// Returns the target in the form that cargo-zigbuild expects.
fn with_glibc(platform: &Platform) -> String {
    match platform.system {
        System::Linux => format!("{}.{GLIBC}", platform.triple),
        _ => platform.triple.to_owned(),
    }
}

/// Returns the target in the form that zig expects.
fn zig_target(platform: &Platform) -> String {
    let cpu = platform.triple.split('-').next().unwrap_or_default();
    match platform.system {
        System::Linux => format!("{cpu}-linux-gnu.{GLIBC}"),
        System::Windows => format!("{cpu}-windows-gnu"),
        System::MacOs => format!("{cpu}-macos"),
    }
}
