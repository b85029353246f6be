//! The player on an emulated Cortex-M4F, in Rust and in C, and in C on the host, returns the bits of the player on the host.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;
#[path = "../../player/tests/common/script.rs"]
mod script;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use common::{asset, built, has, player, run};
use htex_bake::{Grid, bake};
use htex_play::Registry;
use htex_player::{Block, Player};
use xtask::needs::{ARM_GCC, BARE_TARGET, Need, QEMU_ARM};

/// The stack of the C program; with an overflow, data is lost and the test fails.
const STACK: &str = "-Wl,--defsym=stack_size=1024";
const TARGET: &str = "thumbv7em-none-eabihf";
/// Most flash memory of the C program with the player, bytes.
const MOST_FLASH: u64 = 96 * 1024;
/// Most instructions per sample at 8 kHz: a tenth of a processor of 168 MHz.
const MOST_INSTRUCTIONS: u64 = 2100;

fn has_target() -> bool {
    let mut rustc = Command::new("rustc");
    rustc.args(["--print", "target-libdir", "--target", TARGET]);
    let folder = rustc.output().ok().filter(|done| done.status.success());
    folder.is_some_and(|done| Path::new(String::from_utf8_lossy(&done.stdout).trim()).is_dir())
}

/// Builds a project of its own workspace; returns its folder of programs and libraries.
fn cargo(project: &Path, target: Option<&str>) -> PathBuf {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--release", "--locked", "--target-dir"]);
    cargo.arg(built()).arg("--manifest-path");
    cargo.arg(project.join("Cargo.toml"));
    cargo.args(target.iter().flat_map(|target| ["--target", target]));
    // Those of the running build are for the workspace.
    cargo.env_remove("CARGO_TARGET_DIR").env_remove("RUSTFLAGS");
    run(&mut cargo);
    built().join(target.unwrap_or("")).join("release")
}

/// Blocks of all models, baked once.
fn baked() -> &'static [(&'static str, Vec<u8>)] {
    static BAKED: OnceLock<Vec<(&str, Vec<u8>)>> = OnceLock::new();
    BAKED.get_or_init(|| {
        let asset = asset();
        let grid = Grid::new(vec![60.0, 120.0], vec![0.3, 0.6]).unwrap();
        let block = |model| {
            bake(&asset, Some(model), &grid, 8_000.0, 0.3)
                .unwrap()
                .bytes
        };
        let models = Registry::placeless_names().into_iter();
        models.map(|model| (model, block(model))).collect()
    })
}

/// Blocks of all models as files, with the hashes of the host's player.
fn blocks(folder: &str) -> Vec<(&'static str, PathBuf, u32)> {
    let folder = built().join("blocks").join(folder);
    std::fs::create_dir_all(&folder).unwrap();
    let block = |(model, bytes): &(&'static str, Vec<u8>)| {
        let path = folder.join(format!("{model}.bin"));
        std::fs::write(&path, bytes).unwrap();
        let mut player = Player::new(Block::open(bytes).unwrap(), script::SEED);
        (*model, path, script::hash(&mut player))
    };
    baked().iter().map(block).collect()
}

/// Runs a program on the board with a block in memory; an instruction takes a nanosecond of its clock.
fn on_board(program: &Path, block: &Path) -> String {
    let mut qemu = Command::new("qemu-system-arm");
    qemu.args(["-M", "mps2-an386", "-nographic", "-monitor", "none"]);
    qemu.args(["-serial", "none", "-icount", "shift=0"]);
    qemu.args(["-semihosting-config", "enable=on,target=native,chardev=out"]);
    qemu.args(["-chardev", "stdio,id=out"]);
    let block = format!("loader,file={},addr=0x200000,force-raw=on", block.display());
    qemu.arg("-kernel").arg(program).args(["-device", &block]);
    let mut timed = Command::new("timeout");
    timed.arg("120").arg(qemu.get_program());
    run(timed.args(qemu.get_args()))
}

/// The number after a label.
fn number(output: &str, label: &str) -> u64 {
    let mut lines = output.lines();
    let found = lines.find_map(|line| line.strip_prefix(label));
    found
        .unwrap_or_else(|| unreachable!("no {label} in {output}"))
        .trim()
        .parse()
        .unwrap()
}

fn all_met(needs: &[(&Need, bool)]) -> bool {
    needs.iter().all(|(need, there)| need.met(*there))
}

#[test]
fn a_cortex_m4f_returns_the_bits_of_the_host() {
    if !all_met(&[
        (&BARE_TARGET, has_target()),
        (&QEMU_ARM, has("qemu-system-arm")),
    ]) {
        return;
    }
    let program = cargo(&player().join("examples/cortex-m4"), Some(TARGET)).join("cortex-m4");
    for (model, block, hash) in blocks("rust") {
        let output = on_board(&program, &block);
        assert!(
            output.contains(&format!("hash {hash:08x}\n")),
            "{model}: {output}"
        );
        let instructions = number(&output, "instructions per sample");
        let bytes = std::fs::read(&block).unwrap();
        let kind = Block::open(&bytes).unwrap().kind();
        println!("{model}, {} bytes, {kind:?}: {output}", bytes.len());
        assert!(
            (50..MOST_INSTRUCTIONS).contains(&instructions),
            "{model}: {output}"
        );
        assert!(number(&output, "bytes of a player") <= 16 * 1024);
    }
}

#[test]
fn a_damaged_block_is_an_error_on_the_board() {
    if !all_met(&[
        (&BARE_TARGET, has_target()),
        (&QEMU_ARM, has("qemu-system-arm")),
    ]) {
        return;
    }
    let program = cargo(&player().join("examples/cortex-m4"), Some(TARGET)).join("cortex-m4");
    let (_, block, _) = blocks("damaged").remove(2);
    let mut bytes = std::fs::read(&block).unwrap();
    bytes[100] ^= 1;
    std::fs::write(&block, bytes).unwrap();
    let output = on_board(&program, &block);
    assert!(output.contains("error: the checksum"), "{output}");
}

#[test]
fn a_c_program_returns_the_bits_of_the_rust_player() {
    let library = cargo(&player().join("c"), None).join("libhtex_player.a");
    let program = built().join("play");
    let mut cc = Command::new("cc");
    cc.args(["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&program);
    cc.arg("-I")
        .arg(player().join("include"))
        .arg(player().join("c/play.c"));
    cc.arg(library).args(["-lm", "-lpthread", "-ldl"]);
    run(&mut cc);
    for (model, block, hash) in blocks("c") {
        let output = run(Command::new(&program).arg(block));
        assert_eq!(output, format!("hash {hash:08x}\n"), "{model}");
    }
}

#[test]
fn a_c_program_plays_on_a_cortex_m4f() {
    let needs = [
        (&BARE_TARGET, has_target()),
        (&QEMU_ARM, has("qemu-system-arm")),
        (&ARM_GCC, has("arm-none-eabi-gcc")),
    ];
    if !all_met(&needs) {
        return;
    }
    let library = cargo(&player().join("c"), Some(TARGET)).join("libhtex_player.a");
    let program = built().join("play-on-board");
    let mut gcc = Command::new("arm-none-eabi-gcc");
    gcc.args([
        "-std=c11",
        "-O2",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-ffreestanding",
        "-DBOARD",
    ]);
    gcc.args([
        "-mcpu=cortex-m4",
        "-mthumb",
        "-mfloat-abi=hard",
        "-mfpu=fpv4-sp-d16",
    ]);
    gcc.args(["-nostartfiles", "-Wl,--gc-sections", STACK, "-o"])
        .arg(&program);
    gcc.arg("-I").arg(player().join("include"));
    gcc.arg("-T")
        .arg(player().join("examples/cortex-m4/board.ld"));
    gcc.args(["board.c", "play.c"].map(|file| player().join("c").join(file)))
        .arg(library);
    run(&mut gcc);
    for (model, block, hash) in blocks("c-on-board") {
        let output = on_board(&program, &block);
        assert_eq!(output, format!("hash {hash:08x}\n"), "{model}");
    }
    let size = run(Command::new("arm-none-eabi-size").arg(&program));
    let flash: u64 = size
        .lines()
        .nth(1)
        .unwrap()
        .split_whitespace()
        .next()
        .unwrap()
        .parse()
        .unwrap();
    assert!(flash <= MOST_FLASH, "{size}");
    // No panic is reachable: the linker found none to keep.
    let symbols = run(Command::new("arm-none-eabi-nm").arg(&program));
    let panics: Vec<&str> = symbols
        .lines()
        .filter(|line| line.contains("panic"))
        .collect();
    assert!(panics.is_empty(), "{panics:?}");
    println!("{size}");
}
