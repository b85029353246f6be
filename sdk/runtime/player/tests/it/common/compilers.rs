//! The player in C, compiled for hosts and boards.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::stream::{Case, encoded, expected, hash};

/// Warnings that no user of the C file should see.
const STRICT: &str = "-std=c99 -Wall -Wextra -Wconversion -Wsign-conversion -Wdouble-promotion -Wcast-align -Wshadow -pedantic -Werror";

/// The folder of the player in C.
pub fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../player/c")
}

/// The path of a file that tests write.
pub fn written(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("c");
    std::fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

/// Whether a program is installed.
pub fn has(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

/// Runs a command and returns its standard output.
pub fn run(command: &mut Command) -> String {
    let done = command.output().unwrap();
    let error = String::from_utf8_lossy(&done.stderr);
    let output = String::from_utf8_lossy(&done.stdout);
    assert!(done.status.success(), "{command:?}: {error}{output}{}", done.status);
    output.into_owned()
}

/// Makes the command for a compiler and its options, separated by spaces.
pub fn compiler(command: &str) -> Command {
    let mut words = command.split_whitespace();
    let mut compiler = Command::new(words.next().unwrap());
    compiler.args(words).args(STRICT.split_whitespace());
    compiler.arg("-I").arg(folder());
    compiler
}

/// Compiles the program that plays cases on this machine, with a compiler and its options.
pub fn host_program(command: &str, name: &str) -> PathBuf {
    let program = written(name);
    let mut compiler = compiler(command);
    let files = ["htex_player.c", "tests/cases.c", "tests/host.c"];
    compiler.args(files.map(|file| folder().join(file)));
    run(compiler.arg("-o").arg(&program));
    program
}

/// Plays cases on this machine, and compares each result with this crate's player.
pub fn compare_on_host(program: &Path, cases: &[Case]) {
    let [all, results] = ["cases", "results"].map(|end| program.with_extension(end));
    std::fs::write(&all, encoded(cases)).unwrap();
    run(Command::new(program).arg(&all).arg(&results));
    let results = std::fs::read(results).unwrap();
    let mut rest = &results[..];
    for (i, expected) in expected(cases).iter().enumerate() {
        let (own, after) = rest.split_at(expected.len().min(rest.len()));
        let differs = own.iter().zip(expected).position(|(a, b)| a != b);
        assert!(
            own == expected,
            "case {i}, {} bytes, from byte {differs:?} of the results: {:?}",
            cases[i].block.len(),
            cases[i].block
        );
        rest = after;
    }
    assert!(rest.is_empty(), "{} more bytes", rest.len());
}

/// A board that QEMU emulates, and the compiler for it.
pub struct Board {
    pub compiler: &'static str,
    pub options: &'static str,
    pub script: &'static str,
    pub emulator: &'static str,
    pub machine: &'static str,
    /// Address at which the linker script expects the bytes that QEMU loads.
    pub loaded: &'static str,
}

pub const CORTEX_M4F: Board = Board {
    compiler: "arm-none-eabi-gcc",
    options: "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16",
    script: "cortex_m.ld",
    emulator: "qemu-system-arm",
    machine: "mps2-an386",
    loaded: "0x20000",
};

/// A board with 16 kB of RAM, without a floating-point unit and without unaligned loads.
pub const CORTEX_M0: Board =
    Board { options: "-mcpu=cortex-m0 -mthumb", machine: "microbit", ..CORTEX_M4F };

pub const RISCV32: Board = Board {
    compiler: "riscv64-unknown-elf-gcc",
    options: "-march=rv32imac -mabi=ilp32 -mno-relax",
    script: "riscv32.ld",
    emulator: "qemu-system-riscv32",
    machine: "virt -bios none",
    loaded: "0x80060000",
};

impl Board {
    /// Compiles and links sources of `c/tests` with the player.
    pub fn program(&self, sources: &[&str], more: &str, name: &str) -> PathBuf {
        let program = written(name);
        // The source file overrides the permission to fuse.
        let bare =
            "-O2 -ffp-contract=fast -ffreestanding -nostdlib -Wl,--gc-sections -ffunction-sections";
        let mut compiler = compiler(&format!("{} {} {bare} {more}", self.compiler, self.options));
        // Addresses of registers and vectors are not ISO C.
        compiler.arg("-Wno-pedantic");
        let tests = folder().join("tests");
        compiler.arg("-T").arg(tests.join(self.script));
        compiler.arg(folder().join("htex_player.c"));
        compiler.args(sources.iter().map(|source| tests.join(source)));
        run(compiler.arg("-lgcc").arg("-o").arg(&program));
        program
    }

    /// Runs a program with these bytes in memory, and returns what it prints.
    pub fn run(&self, program: &Path, bytes: &[u8]) -> String {
        let loaded = program.with_extension("bin");
        std::fs::write(&loaded, bytes).unwrap();
        let loader = format!("loader,file={},addr={},force-raw=on", loaded.display(), self.loaded);
        let mut qemu = Command::new("timeout");
        qemu.arg("300").arg(self.emulator).arg("-M");
        qemu.args(self.machine.split_whitespace());
        qemu.args(["-nographic", "-monitor", "none", "-serial", "none"]);
        qemu.args(["-icount", "shift=0", "-chardev", "stdio,id=out"]);
        qemu.args(["-semihosting-config", "enable=on,target=native,chardev=out"]);
        qemu.arg("-kernel").arg(program).args(["-device", &loader]);
        run(&mut qemu)
    }

    /// Compiles with the options `more`, plays cases on the board, and compares the hash of all
    /// results with this crate's player.
    pub fn compare(&self, name: &str, more: &str, cases: &[Case]) {
        let sources = ["cases.c", "cases_on_board.c", "board.c"];
        let program = self.program(&sources, more, name);
        let bytes = encoded(cases);
        let length = (bytes.len() as u32).to_le_bytes();
        let output = self.run(&program, &[&length[..], &bytes].concat());
        let expected = hash(&expected(cases).concat());
        assert_eq!(output, format!("hash {expected:08x}\n"));
    }
}
