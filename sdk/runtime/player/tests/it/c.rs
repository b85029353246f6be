//! The player in C renders the same bits as this crate's player, and refuses the same blocks, on
//! this machine and on emulated boards. With hostile blocks, it neither reads nor writes beyond its
//! memory.

use crate::common::cases;
use crate::common::compilers;
use crate::common::mutated;
use crate::common::stream;

use compilers::{Board, CORTEX_M0, CORTEX_M4F, RISCV32, compare_on_host, has, host_program};
use htex_player::Block;
use stream::{Case, Step};
use xtask::needs::{ARM_GCC, CC, CLANG, QEMU_ARM, QEMU_RISCV, RISCV_GCC, SANITIZERS, XTENSA_GCC};

/// Returns the blocks of `spec/baked-conformance`, and the calls that the test makes with them.
fn conformance() -> Vec<Case> {
    let both = cases::blocks_and_steps().into_iter().flat_map(|(block, steps)| {
        [false, true].map(|are_integers| Case {
            steps: steps.iter().map(|s| step(*s, &block, are_integers)).collect(),
            block: block.clone(),
            seed: cases::SEED,
        })
    });
    both.collect()
}

fn step(step: cases::Step, block: &[u8], are_integers: bool) -> Step {
    match (step, are_integers) {
        (cases::Step::SetMotion(speed, force), _) => Step::SetMotion(speed, force),
        (cases::Step::Render(count), false) => Step::Render(count),
        (cases::Step::Render(count), true) => {
            let full_scale = Block::open(block).unwrap().full_scale();
            Step::RenderI16(count, full_scale)
        }
    }
}

/// Options with which compilers would fuse operations, which the source file forbids.
const GCC_OPTIONS: [&str; 3] = ["-O0", "-O2", "-O3 -march=native -ffp-contract=fast"];
const CLANG_OPTIONS: [&str; 3] = ["-O0", "-O2", "-O3 -march=native -ffp-contract=on"];

#[test]
fn gcc_makes_the_bits_of_the_specification() {
    if !CC.met(has("gcc")) {
        return;
    }
    for (i, options) in GCC_OPTIONS.iter().enumerate() {
        let program = host_program(&format!("gcc {options}"), &format!("gcc-{i}"));
        compare_on_host(&program, &conformance());
    }
}

#[test]
fn clang_makes_the_bits_of_the_specification() {
    if !CLANG.met(has("clang")) {
        return;
    }
    for (i, options) in CLANG_OPTIONS.iter().enumerate() {
        let program = host_program(&format!("clang {options}"), &format!("clang-{i}"));
        compare_on_host(&program, &conformance());
    }
}

/// With this option, clang ignores what a source file says about fusing operations, and the file
/// cannot detect the option.
#[cfg(target_arch = "x86_64")]
#[test]
fn a_player_that_was_compiled_to_fuse_opens_no_block() {
    if !CLANG.met(has("clang")) || !std::arch::is_x86_feature_detected!("fma") {
        return;
    }
    let program = host_program("clang -O3 -mfma -ffp-contract=fast", "clang-fused");
    let case = conformance().remove(0);
    let [cases, results] = ["cases", "results"].map(|end| program.with_extension(end));
    std::fs::write(&cases, stream::encoded(&[case])).unwrap();
    compilers::run(std::process::Command::new(&program).arg(cases).arg(&results));
    let refused = i32::to_le_bytes(-4);
    assert_eq!(std::fs::read(results).unwrap(), refused);
}

fn compare_on_arm(board: &Board, name: &str, more: &str) {
    let needs = [(&QEMU_ARM, has("qemu-system-arm")), (&ARM_GCC, has("arm-none-eabi-gcc"))];
    if needs.iter().all(|(need, there)| need.met(*there)) {
        board.compare(name, more, &conformance());
    }
}

#[test]
fn a_cortex_m4f_makes_the_bits_of_the_specification() {
    compare_on_arm(&CORTEX_M4F, "m4f", "");
    compare_on_arm(&CORTEX_M4F, "m4f-portable", "-DHTEX_PLAYER_PORTABLE");
}

#[test]
fn a_cortex_m0_makes_the_bits_of_the_specification() {
    compare_on_arm(&CORTEX_M0, "m0", "");
}

#[test]
fn a_riscv32_makes_the_bits_of_the_specification() {
    let needs =
        [(&QEMU_RISCV, has("qemu-system-riscv32")), (&RISCV_GCC, has("riscv64-unknown-elf-gcc"))];
    if needs.iter().all(|(need, there)| need.met(*there)) {
        RISCV32.compare("riscv32", "", &conformance());
    }
}

/// Compiles the player without warnings; no program is linked.
fn compile(command: &str) {
    let mut compiler = compilers::compiler(command);
    compiler.args(["-O2", "-ffreestanding", "-c"]);
    compiler.arg(compilers::folder().join("htex_player.c"));
    compilers::run(compiler.arg("-o").arg(compilers::written("compiled.o")));
}

#[test]
fn clang_compiles_for_other_processors() {
    if !CLANG.met(has("clang")) {
        return;
    }
    for target in [
        "riscv32-unknown-none-elf -march=rv32imac",
        "riscv32-unknown-none-elf -march=rv32imafc -mabi=ilp32f",
        "thumbv6m-none-eabi",
        "thumbv7em-none-eabihf -mcpu=cortex-m4 -mfpu=fpv4-sp-d16",
        "thumbv8m.main-none-eabihf",
        "aarch64-none-elf",
        // A target with the other byte order.
        "armeb-none-eabi",
        "mips-none-elf",
    ] {
        compile(&format!("clang --target={target}"));
    }
}

#[test]
fn gcc_compiles_for_xtensa() {
    if XTENSA_GCC.met(has("xtensa-lx106-elf-gcc")) {
        compile("xtensa-lx106-elf-gcc");
    }
}

/// Options that would change the bits are refused at compile time.
#[test]
fn options_that_reorder_operations_are_refused() {
    if !(CC.met(has("gcc")) && CLANG.met(has("clang"))) {
        return;
    }
    let of_both = ["-ffast-math", "-ffinite-math-only"];
    let of_gcc = ["-freciprocal-math", "-funsafe-math-optimizations"];
    for (compiler, all) in [("gcc", [of_both, of_gcc].concat()), ("clang", of_both.to_vec())] {
        for options in all {
            let mut compiler = compilers::compiler(&format!("{compiler} -O2 {options} -c"));
            compiler.arg(compilers::folder().join("htex_player.c"));
            let done = compiler.arg("-o").arg(compilers::written("refused.o")).output();
            let error = String::from_utf8(done.unwrap().stderr).unwrap();
            assert!(error.contains("compile this file without -ffast-math"), "{options}: {error}");
        }
    }
}

/// Options of clang that end the program at a read or a write beyond memory, and at an operation
/// without a defined result.
const SANITIZED: &str =
    "clang -O1 -g -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all";

fn has_sanitizers() -> bool {
    let source = compilers::written("empty.c");
    std::fs::write(&source, "int main(void) { return 0; }\n").unwrap();
    let mut clang = compilers::compiler(SANITIZED);
    clang.arg(&source).arg("-o").arg(compilers::written("empty"));
    clang.output().is_ok_and(|done| done.status.success())
}

#[test]
fn hostile_blocks_play_or_are_refused_as_in_rust() {
    if !SANITIZERS.met(has_sanitizers()) {
        return;
    }
    let program = host_program(SANITIZED, "sanitized");
    let damaged = mutated::damaged().into_iter().map(mutated::case);
    let all: Vec<Case> =
        mutated::cases(4000).into_iter().chain(damaged).chain(conformance()).collect();
    compare_on_host(&program, &all);
    let played = all.iter().filter(|case| Block::open(&case.block).is_ok());
    let share = played.count() as f64 / all.len() as f64;
    assert!((0.1..0.9).contains(&share), "{share} of the blocks play");
}
