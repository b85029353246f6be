//! Blocks of all models give the same samples on the host and on an emulated Cortex-M4F, in Rust
//! and in C.

use crate::bake_common as common;
use crate::compilers;
use crate::script;
use crate::stream;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use common::{asset, built, has, player, run};
use compilers::{CORTEX_M0, CORTEX_M4F, compare_on_host, host_program};
use htex_play::Registry;
use htex_play::bake::{Grid, bake};
use htex_player::{Block, Player};
use stream::{Case, Step};
use xtask::needs::{ARM_GCC, BARE_TARGET, CC, Need, QEMU_ARM};

const TARGET: &str = "thumbv7em-none-eabihf";
/// Largest size of the C program with the player in flash memory, bytes.
const MOST_FLASH: u64 = 20 * 1024;
/// Largest number of instructions per sample at 8 kHz: a tenth of the time of a processor with 168
/// MHz.
const MOST_INSTRUCTIONS: u64 = 2100;

fn has_target() -> bool {
    let mut rustc = Command::new("rustc");
    rustc.args(["--print", "target-libdir", "--target", TARGET]);
    let folder = rustc.output().ok().filter(|done| done.status.success());
    folder.is_some_and(|done| Path::new(String::from_utf8_lossy(&done.stdout).trim()).is_dir())
}

/// Builds a project that has its own workspace. Returns the folder of its programs and libraries.
fn cargo(project: &Path, target: Option<&str>) -> PathBuf {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--release", "--locked", "--target-dir"]);
    cargo.arg(built()).arg("--manifest-path");
    cargo.arg(project.join("Cargo.toml"));
    cargo.args(target.iter().flat_map(|target| ["--target", target]));
    // The variables of the running build are for its own workspace.
    cargo.env_remove("CARGO_TARGET_DIR").env_remove("RUSTFLAGS");
    run(&mut cargo);
    built().join(target.unwrap_or("")).join("release")
}

/// Blocks of all models, which are baked only once.
fn baked() -> &'static [(&'static str, Vec<u8>)] {
    static BAKED: OnceLock<Vec<(&str, Vec<u8>)>> = OnceLock::new();
    BAKED.get_or_init(|| {
        let asset = asset();
        let grid = Grid::new(vec![60.0, 120.0], vec![0.3, 0.6]).unwrap();
        let block =
            |model| bake(asset.representation(model).unwrap(), &grid, 8_000.0, 0.3).unwrap().bytes;
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

/// Runs a program on the board with a block in memory. An instruction takes one nanosecond of the
/// board's clock.
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

/// Returns the number after a label in the output.
fn number(output: &str, label: &str) -> u64 {
    let mut lines = output.lines();
    let found = lines.find_map(|line| line.strip_prefix(label));
    found.unwrap_or_else(|| unreachable!("no {label} in {output}")).trim().parse().unwrap()
}

fn all_met(needs: &[(&Need, bool)]) -> bool {
    needs.iter().all(|(need, there)| need.met(*there))
}

#[test]
fn a_cortex_m4f_returns_the_bits_of_the_host() {
    if !all_met(&[(&BARE_TARGET, has_target()), (&QEMU_ARM, has("qemu-system-arm"))]) {
        return;
    }
    let program = cargo(&player().join("examples/cortex-m4"), Some(TARGET)).join("cortex-m4");
    for (model, block, hash) in blocks("rust") {
        let output = on_board(&program, &block);
        assert!(output.contains(&format!("hash {hash:08x}\n")), "{model}: {output}");
        let instructions = number(&output, "instructions per sample");
        let bytes = std::fs::read(&block).unwrap();
        let kind = Block::open(&bytes).unwrap().kind();
        println!("{model}, {} bytes, {kind:?}: {output}", bytes.len());
        assert!((50..MOST_INSTRUCTIONS).contains(&instructions), "{model}: {output}");
        assert!(number(&output, "bytes of a player") <= 16 * 1024);
    }
}

/// The linker keeps all code that a program may reach. It kept no panic, so the program cannot
/// panic.
#[test]
fn no_panic_is_reachable_on_the_board() {
    if !all_met(&[(&BARE_TARGET, has_target()), (&ARM_GCC, has("arm-none-eabi-gcc"))]) {
        return;
    }
    let program = cargo(&player().join("examples/cortex-m4"), Some(TARGET)).join("cortex-m4");
    let symbols = run(Command::new("arm-none-eabi-nm").arg(&program));
    assert!(symbols.contains("htex_player"), "{symbols}");
    assert!(!symbols.contains("panic"), "{symbols}");
}

/// Returns cases for blocks of all models: motions within and beyond the conditions, a finger at
/// rest, and implausible motions.
fn cases() -> Vec<Case> {
    let motions =
        [(80.0, 0.4), (55.5, 0.25), (0.0, 0.0), (101.25, 0.5), (1e6, 100.0), (-60.0, 0.3)];
    let steps = motions.into_iter().flat_map(|(speed, force)| {
        let lengths = [64, 1, 33, 200].map(Step::Render).into_iter();
        let motion = [Step::SetMotion(speed, force)].into_iter();
        motion.chain(lengths).chain([Step::RenderI16(40, 0.5)])
    });
    let steps: Vec<Step> = steps.collect();
    let blocks = baked().iter();
    let case = |(_, block): &(_, Vec<u8>)| Case {
        block: block.clone(),
        seed: script::SEED,
        steps: steps.clone(),
    };
    blocks.map(case).collect()
}

#[test]
fn all_models_play_in_c_on_a_cortex_m4f() {
    let needs = [(&QEMU_ARM, has("qemu-system-arm")), (&ARM_GCC, has("arm-none-eabi-gcc"))];
    if !all_met(&needs) {
        return;
    }
    // One block at a time, because only one fits into the memory of the program.
    for (i, case) in cases().into_iter().enumerate() {
        CORTEX_M4F.compare(&format!("models-{i}"), "", &[case]);
    }
}

#[test]
fn all_models_play_in_c_on_this_machine() {
    if CC.met(has("gcc")) {
        compare_on_host(&host_program("gcc -O2", "models-gcc"), &cases());
    }
}

#[test]
fn the_c_program_fits_into_small_memory() {
    if !ARM_GCC.met(has("arm-none-eabi-gcc")) {
        return;
    }
    for board in [&CORTEX_M4F, &CORTEX_M0] {
        let sources = ["cases.c", "cases_on_board.c", "board.c"];
        let program = board.program(&sources, "", "size");
        let size = run(Command::new("arm-none-eabi-size").arg(&program));
        let flash = size.lines().nth(1).and_then(|row| row.split_whitespace().next());
        let flash: u64 = flash.unwrap().parse().unwrap();
        println!("{}: {size}", board.options);
        assert!(flash <= MOST_FLASH, "{size}");
    }
}
