//! libhtex as it is installed: pkg-config, CMake, the static library, SDL2, and the size of the small build.

use std::path::Path;

use anyhow::{Result, bail, ensure};

use crate::dist::{Dist, dist};
use crate::places::workspace;
use crate::programs::{program, run};

/// Most bytes of the small build's shared library; the goal is 1.5 MB (docs/languages.md says what takes the rest).
const SMALL: u64 = 2_500_000;

const CMAKE: &str = "cmake_minimum_required(VERSION 3.16)\nproject(app C)\nfind_package(htex 0.1 REQUIRED)\n\
                     add_executable(app main.c)\ntarget_link_libraries(app PRIVATE htex::htex m)\n\
                     add_executable(app_static main.c)\ntarget_link_libraries(app_static PRIVATE htex::static m)\n";

pub(super) fn test(folder: &Path) -> Result<()> {
    let folder = fs_err::canonicalize(folder)?;
    let capi = fs_err::canonicalize(workspace().join("sdk/capi"))?;
    let asset = capi.join("../../examples/scenes/vinyl.htex");
    let install = |name: &str, small| {
        let prefix = folder.join(name);
        dist(&Dist {
            prefix: prefix.clone(),
            small,
        })
        .map(|()| prefix)
    };
    let (whole, small) = (install("whole", false)?, install("small", true)?);
    fs_err::write(folder.join("CMakeLists.txt"), CMAKE)?;
    fs_err::copy(capi.join("examples/play.c"), folder.join("main.c"))?;
    let played = |name: &str, program_name: &Path, prefix: &Path| {
        let out = folder.join(format!("{name}.f32"));
        let mut play = program(program_name, &folder);
        play.arg(&asset)
            .arg(&out)
            .env("LD_LIBRARY_PATH", prefix.join("lib"));
        run(&mut play)?;
        anyhow::Ok(fs_err::read(&out)?)
    };
    let mut samples = Vec::new();
    for (name, prefix) in [("whole", &whole), ("small", &small)] {
        let built = folder.join(format!("play-{name}"));
        // As a user types it.
        let line = format!(
            "cc -std=c11 -Wall -Werror main.c $(pkg-config --cflags --libs htex) -lm -o {}",
            built.display()
        );
        run(program("sh", &folder)
            .args(["-c", &line])
            .env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig")))?;
        samples.push(played(name, &built, prefix)?);
    }
    let mut configure = program("cmake", &folder);
    configure.args(["-S", ".", "-B", "built"]);
    run(configure.arg(format!("-DCMAKE_PREFIX_PATH={}", whole.display())))?;
    run(program("cmake", &folder).args(["--build", "built"]))?;
    for name in ["app", "app_static"] {
        samples.push(played(name, &folder.join("built").join(name), &whole)?);
    }
    if samples.windows(2).any(|pair| pair[0] != pair[1]) || samples[0].len() != 4 * 64 * 625 {
        bail!("the builds render different samples");
    }
    // The library as it is installed allocates nothing in real-time calls.
    let line = "cc -std=c11 -O1 -Wall -Werror -DCOUNTED -pthread $0 $(pkg-config --cflags --libs htex) -lm -o real_time";
    run(program("sh", &folder)
        .args(["-c", line])
        .arg(capi.join("tests/hosts/real_time.c"))
        .env("PKG_CONFIG_PATH", whole.join("lib/pkgconfig")))?;
    run(program("./real_time", &folder)
        .arg(&asset)
        .arg("20000")
        .env("LD_LIBRARY_PATH", whole.join("lib")))?;
    let line =
        "cc -std=c11 -Wall -Werror $0 $(pkg-config --cflags --libs htex sdl2) -lm -o play_sdl";
    let sdl = capi.join("examples/play_sdl.c");
    let mut compile = program("sh", &folder);
    compile.args(["-c", line]).arg(sdl);
    run(compile.env("PKG_CONFIG_PATH", whole.join("lib/pkgconfig")))?;
    run(program("./play_sdl", &folder)
        .arg(&asset)
        .arg("1")
        .env("SDL_AUDIODRIVER", "dummy")
        .env("LD_LIBRARY_PATH", whole.join("lib")))?;
    let library = small.join("lib/libhtex.so");
    let bytes = fs_err::metadata(&library)?.len();
    eprintln!("bindings: libhtex without the engine and scenes: {bytes} bytes");
    let library = library.display();
    ensure!(bytes <= SMALL, "{library}: {bytes} bytes; at most {SMALL}");
    Ok(())
}
