//! The FMOD plugin, compiled against stubs of FMOD's headers that were written from its
//! documentation, and run by hosts that do what FMOD does. The tests do not run FMOD itself.

#[allow(dead_code)] // Of programs in other languages.
use crate::common::programs;

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use htex::{Motion, Registry, Texture, VoiceOptions};
use programs::{Language, Project, asset};
use xtask::needs;

/// Speeds (mm/s) and forces (N) of strokes, all exactly representable as floats: two speeds, rests,
/// a lifted finger, and forces beyond the recorded one.
const STROKES: [(f64, f64); 8] = [
    (80.0, 0.5),
    (120.0, 0.5),
    (0.0, 0.5),
    (40.0, 0.75),
    (40.0, 0.0),
    (200.0, 0.25),
    (80.5, 1.5),
    (0.25, 1.5),
];
const STROKE_FRAMES: usize = 6_144;
const RATE_HZ: f64 = 48_000.0;
const SEED: u64 = 7;

/// Counts allocations. Sanitizers and valgrind run without the counter.
const COUNTED: &[&str] = &["-DCOUNTED"];
const SANITIZED: &[&str] = &["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

fn capi(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The plugin and the programs that load it, in a project's folder.
struct Built {
    project: Project,
    plugin: PathBuf,
    host: PathBuf,
    checks: PathBuf,
}

impl Built {
    /// `None` without the compiler.
    fn new(language: Language, name: &str, flags: &[&str]) -> Option<Self> {
        let project = Project::new(language, name)?;
        Some(Self::of(project, flags))
    }

    fn of(project: Project, flags: &[&str]) -> Self {
        let build = |source: &str, more: &[&str]| {
            let includes = ["fmod", "tests/fmod", "tests/hosts"]
                .map(|folder| format!("-I{}", capi(folder).display()));
            let includes = includes.each_ref().map(String::as_str);
            let text = fs::read_to_string(capi(source)).unwrap();
            let program = project.build_with(&text, &[&includes, flags, more].concat());
            let named = project.folder().join(Path::new(source).file_stem().unwrap());
            fs::rename(program, &named).unwrap();
            named
        };
        Self {
            plugin: build("fmod/htex_fmod.c", &["-shared", "-fPIC"]),
            host: build("tests/fmod/host.c", &["-pthread"]),
            checks: build("tests/fmod/checks.c", &["-pthread"]),
            project,
        }
    }

    /// Returns the samples of the strokes, played in blocks of `frames`, and how many blocks were
    /// played and skipped.
    fn played(&self, frames: usize) -> (Vec<u8>, Vec<usize>) {
        let (asset, out) = (asset(), self.project.folder().join("out.f32"));
        let frames = frames.to_string();
        let mut words = vec!["20".to_owned(), SEED.to_string()];
        words.extend(STROKES.map(|(speed_mm_s, force_n)| format!("{speed_mm_s},{force_n}")));
        let mut arguments: Vec<&OsStr> = vec![self.plugin.as_ref(), asset.as_ref()];
        arguments.extend([OsStr::new(&frames), out.as_ref()]);
        arguments.extend(words.iter().map(OsStr::new));
        let run = self.project.run(&self.host, &arguments);
        assert!(run.status.success(), "{run:?}");
        let printed = String::from_utf8(run.stdout).unwrap();
        let counts = printed.split_whitespace().map(|word| word.parse().unwrap());
        (fs::read(out).unwrap(), counts.collect())
    }

    /// Returns what the checks print.
    fn checked(&self, under: &[&str], changes: usize) -> String {
        let (asset, changes) = (asset(), changes.to_string());
        let arguments = [self.plugin.as_os_str(), asset.as_os_str(), OsStr::new(&changes)];
        let run = self.project.run_under(under, &self.checks, &arguments);
        assert!(run.status.success(), "{under:?}: {run:?}");
        String::from_utf8(run.stdout).unwrap()
    }
}

/// The samples of the strokes as the library plays them, 20 dB above the asset's unit.
fn expected() -> Vec<u8> {
    let asset = Texture::open(asset()).unwrap();
    let options = VoiceOptions::default()
        .with_rate_hz(RATE_HZ)
        .with_seed(SEED)
        .with_gain(10.0)
        .with_motion(Some(Motion::new(0.0, 0.0)));
    let mut voice = asset.voice(&options).unwrap();
    let mut samples = vec![0.0f32; STROKES.len() * STROKE_FRAMES];
    for (stroke, (speed_mm_s, force_n)) in samples.chunks_mut(STROKE_FRAMES).zip(STROKES) {
        voice.set_motion(Motion::new(speed_mm_s, force_n)).unwrap();
        voice.render(stroke).unwrap();
    }
    samples.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// The plugin offers the library's models.
#[test]
fn generated_models_are_those_of_the_library() {
    let names: Vec<String> =
        Registry::builtin_names().iter().map(|name| format!("\"{name}\"")).collect();
    let text = format!(
        "/* Written by `cargo xtask generate`. The models of libhtex, in its order; 0 is the one of least error. */\n\
         static const char *const MODELS[] = {{\"least error\", {}}};\n",
        names.join(", ")
    );
    xtask::generated::file("sdk/bindings/capi/fmod/models.h", text.as_bytes());
}

/// The plugin plays in blocks of any length, built with gcc and clang. While the finger rests it
/// tells FMOD to skip it.
#[test]
fn the_plugin_plays_the_samples_of_the_library() {
    let expected = expected();
    for language in [Language::C, Language::Clang] {
        let Some(built) = Built::new(language, "fmod", COUNTED) else {
            continue;
        };
        for frames in [256, 512, 1_024] {
            let (samples, counts) = built.played(frames);
            assert!(samples == expected, "{language:?}, {frames}");
            // Three of the eight strokes are silent, except for the blocks in which the texture
            // fades.
            let fading = 960usize.div_ceil(frames);
            let silent = 3 * (STROKE_FRAMES / frames - fading);
            assert_eq!(counts[1], silent, "{language:?}, {frames}");
            assert_eq!(counts[0] + counts[1], expected.len() / 4 / frames);
        }
    }
}

/// Silence, refusals, parameters, instances, and a mixer that runs at the same time without
/// allocating. The README lists the parameters, and the plugin offers the library's models.
#[test]
fn the_plugin_keeps_to_its_description() {
    let Some(built) = Built::new(Language::C, "fmod_checks", COUNTED) else {
        return;
    };
    let printed = built.checked(&[], 3_000);
    let lines = |prefix: &str| -> Vec<String> {
        let lines = printed.lines().filter_map(|line| line.strip_prefix(prefix));
        lines.map(str::to_owned).collect()
    };
    let readme = fs::read_to_string(capi("fmod/README.md")).unwrap();
    let (rows, models) = (lines("| "), lines("model "));
    assert_eq!(rows.len(), 6);
    for row in rows {
        let row =
            row.replace(&format!("| 0 to {} |", models.len()), "| index in [models.h](models.h) |");
        assert!(readme.contains(&format!("\n| {row}")), "{row}");
    }
    assert_eq!(models, Registry::builtin_names());
    let bytes = fs::read(asset()).unwrap();
    let damaged = Texture::from_bytes(&bytes[..bytes.len() / 2]).unwrap_err();
    let messages = lines("message ");
    assert_eq!(messages[0], format!("the asset cannot be opened: {damaged}"));
    let expected = [
        "no representation `bands`",
        "a rate of 1000 Hz",
        "a rate of 1000 Hz",
        "the texture is silent: no such object",
    ];
    assert_eq!(messages.len(), 1 + expected.len());
    for (message, part) in messages[1..].iter().zip(expected) {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn the_plugin_is_clean_under_valgrind_and_sanitizers() {
    let valgrind = Command::new("valgrind").arg("--version").output().is_ok();
    if needs::VALGRIND.met(valgrind)
        && let Some(built) = Built::new(Language::C, "fmod_valgrind", &[])
    {
        let under = [
            "valgrind",
            "--quiet",
            "--error-exitcode=9",
            "--leak-check=full",
            "--errors-for-leak-kinds=definite,indirect,possible",
        ];
        built.checked(&under, 60);
    }
    for language in [Language::C, Language::Clang] {
        let project = Project::new(language, "fmod_sanitized");
        let met = |project: &Project| needs::SANITIZERS.met(project.builds(SANITIZED));
        if let Some(project) = project.filter(met) {
            Built::of(project, SANITIZED).checked(&[], 300);
        }
    }
}
