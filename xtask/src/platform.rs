//! The systems that htex is built for, and how cargo, the linkers and the compilers of C are called
//! for each.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Result, bail};

use crate::commit::Commit;
use crate::places::{cargo, target, workspace};

/// Oldest C library of Linux that what is released runs with.
const GLIBC: &str = "2.31";

/// Oldest macOS that what is released runs with: the first for Apple's processors.
const MACOS: &str = "11.0";

const STRIP: &str = "-Cstrip=symbols";

/// Cargo's profile of tests, whose folder is `debug`.
const TESTS: &str = "dev";

/// A system that htex is released for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Platform {
    /// As in the names of archives.
    pub name: &'static str,
    /// Cargo's name of the target.
    pub triple: &'static str,
    /// What the names of the binary utilities begin with.
    utilities: &'static str,
    pub system: System,
}

/// What decides about the names and kinds of libraries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum System {
    Linux,
    Windows,
    MacOs,
}

/// All of them.
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

/// How something is built: for this machine by its own tools, or for release by zig, whose headers
/// and libraries of each system are the same everywhere. Windows has mingw-w64 instead: zig's
/// linker exports all functions of a DLL, of which there may not be more than 65,535.
#[derive(Debug, Clone)]
pub struct Build {
    platform: Platform,
    /// Of a release.
    commit: Option<Commit>,
}

impl Platform {
    /// The platform of a name: `linux-x86_64` and `x86_64-linux` are the same.
    ///
    /// # Errors
    /// The known names.
    pub fn named(name: &str) -> Result<Self> {
        let turned = name.split_once('-').map(|(a, b)| format!("{b}-{a}"));
        let is_it = |one: &&Self| one.name == name || Some(one.name) == turned.as_deref();
        let names = || PLATFORMS.map(|one| one.name).join(", ");
        match PLATFORMS.iter().find(is_it) {
            Some(platform) => Ok(*platform),
            None => bail!("no platform {name}; known are {}", names()),
        }
    }

    /// Whether a wheel is released. What one for macOS needs of Apple's frameworks, for
    /// certificates, is not to be had here: pip builds it there of the sources.
    pub(crate) fn has_wheel(&self) -> bool {
        self.system != System::MacOs
    }

    /// The one that this program runs on.
    ///
    /// # Errors
    /// On others than those that are known.
    pub fn here() -> Result<Self> {
        let (cpu, system) = (std::env::consts::ARCH, std::env::consts::OS);
        match system {
            "macos" => Self::named("macos"),
            _ => Self::named(&format!("{cpu}-{system}")),
        }
    }
}

impl Build {
    /// For this machine.
    ///
    /// # Errors
    /// As [`Platform::here`].
    pub fn here() -> Result<Self> {
        Ok(Self { platform: Platform::here()?, commit: None })
    }

    /// For release.
    pub(crate) fn release(platform: Platform, commit: &Commit) -> Self {
        Self { platform, commit: Some(commit.clone()) }
    }

    pub fn platform(&self) -> Platform {
        self.platform
    }

    /// Whether it is for release.
    pub fn is_release(&self) -> bool {
        self.commit.is_some()
    }

    /// Whether zig compiles C and links.
    pub(crate) fn is_by_zig(&self) -> bool {
        self.is_release() && self.platform.system != System::Windows
    }

    /// Cargo with `build` or `rustc`.
    pub fn cargo(&self, verb: &str) -> Command {
        let mut command = if self.is_by_zig() {
            Command::new(tools().join("cargo-zigbuild"))
        } else {
            Command::new(cargo())
        };
        // The subcommands of cargo-zigbuild.
        let is_build = self.is_by_zig() && verb == "build";
        command.arg(if is_build { "zigbuild" } else { verb });
        command.current_dir(workspace());
        if let Some(commit) = &self.commit {
            command.args(["--target", &with_glibc(&self.platform)]);
            self.for_release(&mut command, commit);
        }
        command
    }

    /// Maturin, which builds wheels, with a verb.
    pub fn maturin(&self, verb: &str) -> Command {
        let mut command = Command::new(tools().join("maturin"));
        command.arg(verb).current_dir(workspace().join("sdk/python"));
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
        // cargo-zigbuild, and maturin, which has it inside, name their compilers of C after the
        // program that runs. With one name, and one version (requirements.txt), the wheel shall
        // take what the archive has compiled.
        command.env("CARGO_BIN_EXE_cargo-zigbuild", tools().join("cargo-zigbuild"));
    }

    /// Flags of the compiler: no path of this machine and no name of a function is in what is
    /// released; and where zig finds the names of Apple's functions that it has none of, in files
    /// of our own.
    fn flags(&self) -> String {
        let mut flags = vec![without_places()];
        match self.platform.system {
            // Zig leaves the names of functions out.
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

    /// Cargo as it builds the command and libhtex, whole: both at once, so that each has the
    /// features of the other. By the profile of the tests all of the workspace is built, which has
    /// the features of the tests.
    pub(crate) fn cargo_of_both(&self) -> Command {
        let mut command = self.cargo("build");
        command.arg("--locked").args(self.profile());
        if self.profile_name() != TESTS {
            command.args(["--package", "htex-cli", "--package", "htex-capi"]);
        }
        command
    }

    /// The arguments of cargo that name the profile of what is installed: `release`, or the one of
    /// `HTEX_PROFILE` where nothing is released, such as that of the tests, which then take what
    /// was compiled.
    pub(crate) fn profile(&self) -> [String; 2] {
        ["--profile".to_owned(), self.profile_name()]
    }

    fn profile_name(&self) -> String {
        let named = std::env::var("HTEX_PROFILE")
            .ok()
            .filter(|name| !name.is_empty() && !self.is_release());
        named.unwrap_or_else(|| "release".to_owned())
    }

    /// Where cargo puts what it builds by [`Self::profile`].
    pub(crate) fn built(&self) -> PathBuf {
        match &*self.profile_name() {
            TESTS => self.output("debug"),
            name => self.output(name),
        }
    }

    /// Where cargo puts what it builds by a profile.
    pub fn output(&self, profile: &str) -> PathBuf {
        if self.is_release() {
            target().join(self.platform.triple).join(profile)
        } else {
            target().join(profile)
        }
    }

    /// The compiler of C, which links, too.
    pub fn cc(&self) -> Command {
        if !self.is_release() {
            return Command::new("cc");
        }
        let mut command = Command::new(tools().join("python"));
        command.args(["-m", "ziglang", "cc", "-target", &zig_target(&self.platform)]);
        command
    }

    /// A program of the binary utilities of the platform, such as `ld`.
    pub fn utility(&self, name: &str) -> Command {
        let prefix = if self.is_release() { self.platform.utilities } else { "" };
        Command::new(format!("{prefix}{name}"))
    }
}

/// Flags of the compiler by which no path of this machine is in what it writes.
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

/// Where the tools of releases are installed: zig, and what cargo calls it by.
pub fn tools() -> PathBuf {
    let tools = target().join("release-tools/bin");
    std::path::absolute(&tools).unwrap_or(tools)
}

/// The search path with the tools before all others.
pub fn tools_first() -> std::ffi::OsString {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(tools()).chain(std::env::split_paths(&path));
    std::env::join_paths(folders).unwrap_or(path)
}

/// The target as cargo-zigbuild takes it.
fn with_glibc(platform: &Platform) -> String {
    match platform.system {
        System::Linux => format!("{}.{GLIBC}", platform.triple),
        _ => platform.triple.to_owned(),
    }
}

/// The target as zig takes it.
fn zig_target(platform: &Platform) -> String {
    let cpu = platform.triple.split('-').next().unwrap_or_default();
    match platform.system {
        System::Linux => format!("{cpu}-linux-gnu.{GLIBC}"),
        System::Windows => format!("{cpu}-windows-gnu"),
        System::MacOs => format!("{cpu}-macos"),
    }
}
