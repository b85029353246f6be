//! Software that tests use if it is installed, in addition to Rust. Tests install nothing;
//! `.ci/run` installs the software.

use std::io::Write;
use std::path::PathBuf;

use fs_err as fs;

/// Software without which a test is skipped.
pub struct Need {
    pub what: &'static str,
    /// How to install it.
    pub how: &'static str,
    /// Whether it is an error if the software is missing and `HTEX_REQUIRE_WASM=1` is set.
    pub for_wasm: bool,
}

/// Builds Rust to WASM modules.
pub const WASM_TARGET: Need = Need {
    what: "a Rust toolchain for WASM modules",
    how: "rustup target add wasm32-unknown-unknown, or on Debian apt-get install rustc-web cargo-web rust-web-src",
    for_wasm: true,
};

/// Builds C to WASM modules.
pub const WASM_CLANG: Need = Need {
    what: "a C compiler for WASM modules",
    how: "apt-get install clang lld",
    for_wasm: true,
};

/// A compiler of Zig ([`zig`]).
pub const ZIG: Need = Need {
    what: "a compiler of Zig",
    how: "python3 -m venv target/zig && target/zig/bin/pip install ziglang==0.15.1",
    for_wasm: false,
};

/// A compiler of C.
pub const CC: Need = Need { what: "a C compiler", how: "apt-get install gcc", for_wasm: false };

/// Another compiler of C.
pub const CLANG: Need = Need { what: "clang", how: "apt-get install clang", for_wasm: false };

/// Sanitizers of clang.
pub const SANITIZERS: Need =
    Need { what: "clang's sanitizers", how: "apt-get install libclang-rt-dev", for_wasm: false };

/// A compiler of C++17.
pub const CXX: Need = Need { what: "a C++ compiler", how: "apt-get install g++", for_wasm: false };

/// Builds projects in C.
pub const CMAKE: Need = Need { what: "CMake", how: "apt-get install cmake", for_wasm: false };

/// A compiler of C# and its runtime.
pub const MONO: Need = Need {
    what: "mono",
    how: "apt-get install mono-mcs mono-runtime libmono-system-core4.0-cil",
    for_wasm: false,
};

/// A checker of memory accesses.
pub const VALGRIND: Need =
    Need { what: "valgrind", how: "apt-get install valgrind", for_wasm: false };

/// Sound on Linux.
pub const ALSA: Need =
    Need { what: "ALSA", how: "apt-get install libasound2-dev pkg-config", for_wasm: false };

/// Gamepads.
pub const SDL: Need = Need { what: "SDL 2", how: "apt-get install libsdl2-dev", for_wasm: false };

/// Finds runtimes of OpenXR.
pub const OPENXR: Need = Need {
    what: "the loader of OpenXR",
    how: "apt-get install libopenxr-loader1",
    for_wasm: false,
};

/// Builds Rust for boards with a Cortex-M4F.
pub const BARE_TARGET: Need = Need {
    what: "a Rust toolchain for Cortex-M4F",
    how: "rustup target add thumbv7em-none-eabihf",
    for_wasm: false,
};

/// Emulates a board with a Cortex-M4F.
pub const QEMU_ARM: Need =
    Need { what: "QEMU for ARM boards", how: "apt-get install qemu-system-arm", for_wasm: false };

/// Builds C for boards with a Cortex-M4F.
pub const ARM_GCC: Need = Need {
    what: "a C compiler for ARM boards",
    how: "apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi",
    for_wasm: false,
};

/// Builds C for Xtensa.
pub const XTENSA_GCC: Need = Need {
    what: "a C compiler for Xtensa",
    how: "apt-get install gcc-xtensa-lx106",
    for_wasm: false,
};

/// Builds C for boards with a RISC-V of 32 bits.
pub const RISCV_GCC: Need = Need {
    what: "a C compiler for RISC-V",
    how: "apt-get install gcc-riscv64-unknown-elf",
    for_wasm: false,
};

/// Emulates a board with a RISC-V of 32 bits.
pub const QEMU_RISCV: Need = Need {
    what: "QEMU for RISC-V boards",
    how: "apt-get install qemu-system-misc",
    for_wasm: false,
};

/// Tells the types of files by their bytes.
pub const FILE: Need = Need { what: "file", how: "apt-get install file", for_wasm: false };

/// Types of files for desktops.
pub const MIME: Need = Need {
    what: "the shared MIME database",
    how: "apt-get install shared-mime-info",
    for_wasm: false,
};

/// An independent reader and player, written in Python, needs these packages.
pub const PEERS: Need = Need {
    what: "Python with NumPy, SciPy and other packages",
    how: "python3 -m venv target/peers && target/peers/bin/pip install -r tests/peers/independent/requirements.txt",
    for_wasm: false,
};

/// A browser without a window.
pub const CHROMIUM: Need =
    Need { what: "Chromium", how: "apt-get install chromium", for_wasm: false };

/// Another validator of JSON Schemas.
pub const AJV: Need =
    Need { what: "Ajv", how: "npm install --prefix target/node ajv@8", for_wasm: false };

/// Khronos's validator of glTF files.
pub const GLTF_VALIDATOR: Need = Need {
    what: "gltf-validator",
    how: "npm install --prefix target/node gltf-validator@2.0.0-dev.3.10",
    for_wasm: false,
};

/// The compiler of Kaitai Struct, its runtime, and a reader of YAML.
pub const KAITAI: Need = Need {
    what: "the compiler of Kaitai Struct",
    how: "npm install --prefix target/node kaitai-struct-compiler@0.11.0 kaitai-struct@0.11.0 yaml@2",
    for_wasm: false,
};

/// Returns the command that runs the compiler of Zig, if there is one: the value of `HTEX_ZIG`, the
/// package `ziglang` in `target/zig`, or `zig`.
pub fn zig() -> Option<String> {
    let given = std::env::var("HTEX_ZIG").ok().filter(|command| !command.is_empty());
    given.or_else(|| {
        let python = crate::places::target().join("zig/bin/python");
        if python.exists() {
            return Some(format!("{} -m ziglang", std::path::absolute(python).ok()?.display()));
        }
        let runs = std::process::Command::new("zig").arg("version").output().is_ok();
        runs.then(|| "zig".to_owned())
    })
}

impl Need {
    /// Returns `there`, which says whether the software is installed. If it is not installed, also
    /// records the running test as skipped, so that it is listed at the end of `cargo test`
    /// ([`told`]).
    ///
    /// # Panics
    /// When software for WASM is missing and `HTEX_REQUIRE_WASM=1` is set.
    #[must_use]
    #[allow(clippy::panic)] // It fails a test.
    pub fn met(&self, there: bool) -> bool {
        let Self { what, how, .. } = self;
        let test = std::thread::current().name().unwrap_or("a test").to_owned();
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let record = format!("{test} {what}").replace(|c| !is_plain(c), "-");
        // Each record is a file, because the tests run in several programs at the same time.
        let record = folder().join(record);
        if there {
            // An earlier run may have written the record, when the software was not installed yet.
            let _ = fs::remove_file(record);
            return true;
        }
        let is_required = std::env::var_os("HTEX_REQUIRE_WASM").is_some_and(|v| v == "1");
        if self.for_wasm && is_required {
            panic!("{what} is absent; to have it: {how}");
        }
        let sentence = format!("{test}: without {what}; to have it: {how}\n");
        let kept = fs::create_dir_all(folder()).and_then(|()| fs::write(record, &sentence));
        if kept.is_err() {
            say(&sentence);
        }
        false
    }
}

/// Returns the tests skipped since the last call, one sentence each, sorted by name.
///
/// # Errors
/// When the records cannot be read or removed.
pub fn told() -> std::io::Result<Vec<String>> {
    if !folder().exists() {
        return Ok(Vec::new());
    }
    let mut sentences = Vec::new();
    for record in fs::read_dir(folder())? {
        let record = record?.path();
        sentences.push(fs::read_to_string(&record)?);
        fs::remove_file(record)?;
    }
    sentences.sort();
    Ok(sentences)
}

/// Writes directly to standard error, because the test harness captures what macros print in a
/// passing test.
pub fn say(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

fn folder() -> PathBuf {
    crate::places::target().join("skipped")
}
