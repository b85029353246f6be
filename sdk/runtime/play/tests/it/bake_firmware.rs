//! Builds the C examples, and the folders for the build systems of microcontrollers, with the
//! example block.

use crate::bake_common as common;
use crate::compilers;
use crate::stream;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use common::asset;
use compilers::{CORTEX_M4F, folder, has, run, written};
use htex_play::bake::{BakeResult, Grid, bake, c_header};
use htex_player::{Block, Player};
use xtask::firmware::firmware;
use xtask::needs::{ARM_GCC, CC, CMAKE, CXX, QEMU_ARM};

/// The block of the examples.
fn cloth() -> &'static BakeResult {
    static CLOTH: OnceLock<BakeResult> = OnceLock::new();
    CLOTH.get_or_init(|| {
        let grid = Grid::new(vec![60.0, 120.0], vec![0.3, 0.6]).unwrap();
        bake(asset().representation("sslope").unwrap(), &grid, 8_000.0, 0.3).unwrap()
    })
}

fn player(seed: u32) -> Player<'static> {
    Player::new(Block::open(&cloth().bytes).unwrap(), seed)
}

/// The folder of a layout.
fn layout(name: &str) -> PathBuf {
    let out = written(&format!("layout-{}", name.replace('/', "-")));
    firmware(&out).unwrap();
    out.join(name)
}

#[test]
fn generated_example_is_fresh() {
    let text = c_header("texture_cloth", cloth());
    xtask::generated::file("sdk/runtime/player/c/examples/cloth.h", text.as_bytes());
}

#[test]
fn a_double_buffer_is_filled_while_it_is_sent() {
    let needs = [(&QEMU_ARM, has("qemu-system-arm")), (&ARM_GCC, has("arm-none-eabi-gcc"))];
    if !needs.iter().all(|(need, there)| need.met(*there)) {
        return;
    }
    const HALF: usize = 64;
    const HALVES: usize = 40;
    let sources = ["dma_on_board.c", "../examples/dma/texture_dma.c", "board.c"];
    let examples = folder().join("examples");
    let folders = format!("-I{0} -I{0}/dma", examples.display());
    let program = CORTEX_M4F.program(&sources, &folders, "dma");
    // The finger of the program.
    let (mut player, mut bytes) = (player(7), Vec::new());
    for reading in 0..HALVES {
        let speed = (20 * (reading % 9)) as f32;
        player.set_motion(speed, 0.1 * (reading % 7) as f32);
        let mut half = [0; HALF];
        let full_scale = player.block().full_scale();
        player.render_i16(&mut half, full_scale);
        bytes.extend(half.into_iter().flat_map(i16::to_le_bytes));
    }
    assert!(bytes.iter().any(|byte| *byte != 0));
    let expected = format!("late 0\nhash {:08x}\n", stream::hash(&bytes));
    assert_eq!(CORTEX_M4F.run(&program, &[0]), expected);
}

#[test]
fn the_sketch_plays_with_a_stub_of_arduino() {
    if !(CC.met(has("cc")) && CXX.met(has("c++"))) {
        return;
    }
    let library = layout("arduino/HtexPlayer");
    let properties = std::fs::read_to_string(library.join("library.properties")).unwrap();
    let version = concat!("version=", env!("CARGO_PKG_VERSION"), "\n");
    assert!(properties.contains(version), "{properties}");
    let (object, program) = (written("sketch.o"), written("sketch"));
    let mut cc = Command::new("cc");
    cc.args(["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-c"]);
    cc.arg(library.join("src/htex_player.c"));
    run(cc.arg("-o").arg(&object));
    let stub = folder().join("tests/arduino");
    let mut cxx = Command::new("c++");
    cxx.args(["-std=c++17", "-O2", "-Wall", "-Wextra", "-Werror"]);
    for folder in [&stub, &library.join("src"), &library.join("examples/Texture")] {
        cxx.arg("-I").arg(folder);
    }
    cxx.arg(stub.join("sketch.cpp")).arg(&object);
    run(cxx.arg("-o").arg(&program));
    let output = run(&mut Command::new(&program));

    let mut player = player(1);
    let read = |most: f32| most / 1023.0 * 512.0;
    player.set_motion(read(200.0), read(1.0));
    let mut samples = vec![0; 8000];
    let full_scale = player.block().full_scale();
    player.render_i16(&mut samples, full_scale);
    let lines = samples.iter().map(|sample| format!("0 {}\n", 128 + sample / 256));
    assert_eq!(output, lines.collect::<String>());
}

/// The code lines of `docs/microcontroller.md` compile and play. The test puts their includes
/// before a function, and the other lines into it.
#[test]
fn the_lines_of_the_page_play() {
    if !CC.met(has("cc")) {
        return;
    }
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../docs/microcontroller.md");
    let page = std::fs::read_to_string(page).unwrap();
    let all = xtask::markdown::blocks(&page).into_iter();
    let lines: Vec<_> = all.filter(|block| block.language == "c").collect();
    let [lines] = &lines[..] else { panic!() };
    let (declared, done) = lines.text.split_once("int status").unwrap();
    let source = format!(
        "#include <stdio.h>\n{declared}
static int play(float speed_mm_s, float force_n, int16_t *buffer)
{{
int status{done}
return status;
}}
int main(void)
{{
int16_t buffer[64];
int status = play(90.0f, 0.4f, buffer);
for (int i = 0; i < 64; i++)
printf(\"%d \", buffer[i]);
return status;
}}
"
    );
    let (file, program) = (written("page.c"), written("page"));
    std::fs::write(&file, source).unwrap();
    let mut cc = compilers::compiler("cc");
    cc.arg("-I").arg(folder().join("examples")).arg(file);
    cc.arg(folder().join("htex_player.c"));
    run(cc.arg("-o").arg(&program));
    let played = run(&mut Command::new(&program));

    let mut player = player(1);
    player.set_motion(90.0, 0.4);
    let mut samples = [0; 64];
    player.render_i16(&mut samples, 0.5);
    assert_eq!(played, samples.map(|sample| format!("{sample} ")).concat());
}

/// Builds a layout with a stub of its build system. Returns the symbols of the library.
fn built(stub: &str, layout: &Path) -> String {
    let build = written(&format!("build-{stub}"));
    let mut cmake = Command::new("cmake");
    cmake.arg("-S").arg(folder().join("tests").join(stub));
    cmake.arg("-B").arg(&build);
    run(cmake.arg(format!("-DLAYOUT={}", layout.display())));
    run(Command::new("cmake").arg("--build").arg(&build));
    let library = if stub == "zephyr" { "module" } else { "component" };
    run(Command::new("nm").arg(build.join(library).join("libhtex_player.a")))
}

#[test]
fn layouts_build_in_stubs_of_their_builds() {
    if !(CC.met(has("cc")) && CMAKE.met(has("cmake"))) {
        return;
    }
    for (stub, name) in [("esp-idf", "esp-idf/htex_player"), ("zephyr", "zephyr/htex_player")] {
        let symbols = built(stub, &layout(name));
        assert!(symbols.contains(" T htex_player_render_i16"), "{symbols}");
    }
}
