//! Assets and samples that the `htex` command writes. The bindings are compared with them.

use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Result, bail};

use super::{copy, exchanged};
use crate::places::{files, workspace};
use crate::platform::Build;
use crate::programs::{program, run};
use crate::{c_module, plugins};

/// Length, rate and seed of the samples, and the motion at which they are played. Speed and force
/// are exact in single precision.
const SECONDS: &str = "2";
const RATE: &str = "48000";
const SEED: &str = "7";
const SPEED: &str = "80";
const FORCE: &str = "0.5";

/// Builds the `htex` command together with libhtex, and returns its path.
///
/// # Errors
/// When it cannot be built.
pub fn command() -> Result<PathBuf> {
    let build = Build::here()?;
    run(&mut build.cargo_of_both())?;
    let name = format!("htex{}", std::env::consts::EXE_SUFFIX);
    Ok(build.built().join(name))
}

/// Scenes from examples/scenes that are rendered and planned.
const SCENES: [&str; 2] = ["two-swatches", "electrovibration"];

/// Number of additional textures in the library: more than one page of its index can hold.
const COPIES: usize = 999;

/// Writes the fixtures:
///
/// - an asset with six models (`vinyl.htex`), a mesh that carries it (`vinyl.glb`), and an asset
///   with an embedded model (`bursts.htex`);
/// - the samples of these assets at 48 kHz, the spectrum of Bands, and the command's output about
///   the asset;
/// - a library (`many.htexlib`) and its list, and signatures of the asset and the library;
/// - scenes with their samples and plans;
/// - the models as modules, and a module that does not return;
/// - files of other haptic formats, with the textures imported from them, and files exported from
///   textures.
pub(super) fn write(folder: &Path) -> Result<()> {
    fs_err::create_dir_all(folder)?;
    let command = command()?;
    let htex =
        |arguments: &[&str]| run(program(&command, folder).args(arguments).stdout(Stdio::null()));
    for module in files(&plugins::wasm()?)? {
        if let (Some(name), true) =
            (module.file_name(), module.extension().is_some_and(|e| e == "wasm"))
        {
            copy(&module, &folder.join(name))?;
        }
    }
    for source in ["examples/model-c-bursts/bursts.c", "sdk/bindings/web/tests/endless.c"] {
        let name = Path::new(source).with_extension("wasm");
        c_module::build(source, &folder.join(name.file_name().unwrap_or_default()))?;
    }
    htex(&[
        "simulate",
        "--surface",
        "vinyl",
        "--force",
        FORCE,
        "-o",
        "vinyl.csv",
        "--frf",
        "response.csv",
    ])?;
    htex(&["fit", "vinyl.csv", "-o", "vinyl.htex"])?;
    htex(&["export", "vinyl.htex", "--to", "gltf", "-o", "vinyl.glb"])?;
    let embedded = ["--embed-plugin", "bursts.wasm", "-o", "bursts.htex"];
    htex(&[&["fit", "vinyl.csv", "--model", "bursts,sbeta"][..], &embedded].concat())?;
    let synth = |asset: &str, model: &str| {
        let out = format!("{model}.wav");
        let what = ["synth", asset, "--model", model, "-o", &out];
        let length = ["--seconds", SECONDS, "--rate", RATE, "--seed", SEED];
        let motion = ["--speed", SPEED, "--force", FORCE];
        htex(&[&what[..], &length, &motion].concat())
    };
    for model in &plugins::fitted_by_default()? {
        synth("vinyl.htex", model)?;
    }
    synth("bursts.htex", "bursts")?;
    copy(&workspace().join("spec/conformance/valid_fluctuation.htex"), &folder.join("swell.htex"))?;
    htex(&["synth", "swell.htex", "--fluctuation", "--seconds", SECONDS, "-o", "swell.wav"])?;
    authored(folder, &htex)?;
    exchanged::write(folder, &htex)?;
    read_otherwise(folder, &htex)?;
    let printed = |arguments: &[&str], out: &str| {
        let file = fs_err::File::create(folder.join(out))?;
        run(program(&command, folder).args(arguments).stdout(file.into_file()))
    };
    exchanged::write_exports(folder, &htex, &printed)?;
    let spectrum = ["spectrum", "vinyl.htex", "--model", "bands", "--json"];
    printed(&spectrum, "spectrum.json")?;
    printed(&["info", "vinyl.htex", "--json"], "info.json")?;
    printed(&["process", "vinyl.csv", "--json"], "process.json")?;
    let scenes = folder.join("scenes");
    fs_err::create_dir_all(&scenes)?;
    for file in files(&workspace().join("examples/scenes"))? {
        copy(&file, &scenes.join(file.file_name().unwrap_or_default()))?;
    }
    for scene in SCENES {
        let file = format!("scenes/{scene}.scene.json");
        htex(&["render", &file, "-o", &format!("{scene}.wav")])?;
        printed(&["plan", &file, "--json"], &format!("{scene}.json"))?;
    }
    copy_many(folder)?;
    let textures = ["many", "vinyl.htex", "bursts.htex"];
    htex(
        &[&["lib", "pack", "many.htexlib", "--name", "Many", "--unlicensed"][..], &textures]
            .concat(),
    )?;
    fs_err::write(folder.join("signer.key"), [7; 32])?;
    htex(&["sign", "vinyl.htex", "many.htexlib", "--key", "signer.key"])?;
    printed(&["lib", "ls", "many.htexlib", "--json"], "many.json")
}

/// Writes the files that the author module of the npm package can also make. They are textures
/// (from part of a recording, from samples, by hand, mixed, edited), baked blocks, a library of two
/// textures, and the spectrum of a recording (`process.json`).
fn authored(folder: &Path, htex: &impl Fn(&[&str]) -> Result<()>) -> Result<()> {
    for name in ["pcm16.flac", "pcm16.wav"] {
        let source = workspace().join("sdk/make/recording/tests/lab").join(name);
        copy(&source, &folder.join(name))?;
    }
    let given = ["--speed", SPEED, "--force", FORCE];
    let fitted = ["fit", "vinyl.csv", "--from", "2", "--to", "8"];
    let options = ["--model", "ar,bands", "--option", "ar.order=8", "--keep-reference"];
    let said = ["--license", "CC0-1.0", "--tag", "smooth", "-o", "part.htex"];
    htex(&[&fitted[..], &options, &said].concat())?;
    let samples = ["fit", "ar.wav", "--scale", "2", "-o", "samples.htex"];
    htex(&[&samples[..], &given].concat())?;
    let made = ["make", "--model", "sbeta", "--set", "alpha=2", "beta=5"];
    htex(
        &[&made[..], &["--level", "0.02", "--at", "speed=80,force=0.5", "-o", "hum.htex"]].concat(),
    )?;
    let beta = &["alpha=2", "beta=5"][..];
    let cepstrum = &["cepstrum=-12,3.1,0.4", "bands=26", "inverse=0"][..];
    for (model, set, out) in [("sbeta", beta, "beta.htex"), ("mfcc", cepstrum, "cepstrum.htex")] {
        let made = ["make", "--model", model, "--set"];
        let level = ["--level", "0.02", "--at", "speed=80,force=0.5"];
        let said = ["--quantity", "acceleration", "--license", "CC0-1.0"];
        htex(&[&made[..], set, &level, &said, &["-o", out]].concat())?;
    }
    for out in ["block.bin", "block.h", "block.rs"] {
        htex(&["bake", "vinyl.htex", "--model", "bands", "-o", out])?;
    }
    let grid = ["--grid", "speed=40:160:3,force=0.5", "--rate", "6000"];
    let baked = ["bake", "vinyl.htex", "--model", "ar", "-o", "many-block.h"];
    htex(&[&baked[..], &grid].concat())?;
    let mixed = ["mix", "vinyl.htex", "hum.htex", "--weight", "0.25"];
    htex(&[&mixed[..], &["--name", "between", "-o", "mixed.htex"]].concat())?;
    let edited = ["edit", "vinyl.htex", "--author", "A. Weaver"];
    htex(&[&edited[..], &["--contact", "tool", "-o", "edited.htex"]].concat())?;
    let look = r#"{"hue_deg":28,"saturation":0.5,"lightness":0.4,"gloss":0.2,"relief":0.5,"pattern":"fibres"}"#;
    fs_err::write(folder.join("look.json"), look)?;
    let extension = "org.htex.appearance/1=look.json";
    htex(&["edit", "hum.htex", "--extension", extension, "-o", "lit.htex"])?;
    let pack = ["lib", "pack", "two.htexlib", "--name", "Two", "--unlicensed"];
    htex(&[&pack[..], &["vinyl.htex", "bursts.htex"]].concat())
}

/// Makes textures in three ways: from the recording with the setup's response, from the recording's
/// forces (`sensors.csv`) with a 60 Hz tracker (`tracker.csv`), and from a free motion on grids.
fn read_otherwise(folder: &Path, htex: &impl Fn(&[&str]) -> Result<()>) -> Result<()> {
    let models = ["--model", "ar,bands"];
    let compensated = ["--frf", "response.csv", "-o", "compensated.htex"];
    htex(&[&["fit", "vinyl.csv"][..], &models, &compensated].concat())?;
    let recording = fs_err::read_to_string(folder.join("vinyl.csv"))?;
    let rows = recording.lines().filter(|line| !line.starts_with('#'));
    let rows: Vec<Vec<&str>> = rows.skip(1).map(|row| row.split(',').collect()).collect();
    let mut sensors = "t_s,fx_n,fy_n,fz_n\n".to_owned();
    let mut tracker = "stamp,px,py\n".to_owned();
    for (i, row) in rows.iter().enumerate() {
        let [t_s, fx, fy, fz, x, y] = row[..] else {
            bail!("vinyl.csv: six columns are expected in {row:?}");
        };
        sensors += &format!("{t_s},{fx},{fy},{fz}\n");
        // Of 20,000 rows per second, 60 remain: a rate that does not divide the recording's rate.
        if i % 333 == 0 {
            tracker += &format!("{},{x},{y}\n", t_s.parse::<f64>()? * 1000.0);
        }
    }
    fs_err::write(folder.join("sensors.csv"), sensors)?;
    fs_err::write(folder.join("tracker.csv"), tracker)?;
    let map = "time=stamp:0.001,x=px,y=py";
    let tracked = ["--tracker", "tracker.csv", "--tracker-map", map];
    htex(&[&["fit", "sensors.csv", "-o", "tracked.htex"][..], &models, &tracked].concat())?;
    let free = ["simulate", "--surface", "vinyl", "--motion", "free"];
    let length = ["--seconds", "30", "--rate", "5000", "-o", "free.csv"];
    htex(&[&free[..], &length].concat())?;
    let bands = ["fit", "free.csv", "--model", "bands"];
    htex(&[&bands[..], &["--grid", "auto", "-o", "grid.htex"]].concat())?;
    let lines = ["--grid", "speed=80,160", "--grid", "force=0.5,1"];
    htex(&[&bands[..], &lines, &["-o", "lines.htex"]].concat())
}

/// Copies the assets to the folder `many`. The library then contains the module of `bursts.htex`
/// twice.
fn copy_many(folder: &Path) -> Result<()> {
    let floor = folder.join("many/floor");
    fs_err::create_dir_all(&floor)?;
    for i in 0..COPIES {
        copy(&folder.join("vinyl.htex"), &floor.join(format!("{i:04}.htex")))?;
    }
    copy(&folder.join("bursts.htex"), &folder.join("many/bursts again.htex"))
}
