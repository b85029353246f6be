//! Devices that are told strengths and points: gamepads through SDL's own virtual joystick,
//! controllers through a runtime of OpenXR that holds calls to the rules, chosen channels of a
//! file. Their own crates test what they do; here the command plays a texture on them.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::native::{self, complaints, count};
use crate::common::{Place, Run};
use htex_check::device::{Direction, checks_of};

/// Checks that are of libraries: marker, exports, extensions, settings as lines, blocks, handles,
/// arrays.
const OF_LIBRARIES: usize = 7;

/// A library of C of the tests of an adapter; `None` without what it is linked with.
fn built(place: &Place, source: &str, links: &[&str]) -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../renderer-adapters").join(source);
    let out = place.path("driver.so");
    let mut cc = Command::new("cc");
    cc.args(["-std=gnu11", "-O1", "-shared", "-fPIC"]).arg(source);
    let run = cc.arg("-o").arg(&out).args(links).output().unwrap();
    run.status.success().then_some(out)
}

/// A gamepad of SDL, as the setting `driver`.
fn pad(place: &Place) -> Option<String> {
    let library = built(place, "builtin/tests/pad.c", &["-lSDL2", "-ldl"]);
    let library = xtask::needs::SDL.met(library.is_some()).then_some(library)?;
    library.map(|library| format!("driver={}", library.display()))
}

/// A runtime of OpenXR, as the setting `runtime`.
fn runtime(place: &Place) -> String {
    let library = built(place, "builtin/tests/runtime.c", &["-lpthread"]);
    format!("runtime={}", library.unwrap().display())
}

fn texture(place: &Place) {
    let csv = place.recording("corrugated-paper");
    let fit = place.run(&["fit", &csv, "-o", "t.htex", "--model", "ar"]);
    assert_eq!(fit.code(), 0, "{}", fit.error());
}

/// A loader of OpenXR on a machine without a runtime prints what is wrong, unless its environment
/// says that it prints nothing.
#[cfg(target_os = "linux")]
#[test]
fn the_list_of_devices_has_no_line_of_the_openxr_loader() {
    let place = Place::new();
    place.write(
        "loader.c",
        r#"#include <stdio.h>
#include <stdlib.h>
#include <string.h>
int xrGetInstanceProcAddr(void *instance, const char *name, void **function)
{
    const char *prints = getenv("XR_LOADER_DEBUG");
    (void)instance;
    if (prints == NULL || strcmp(prints, "none") != 0) {
        fprintf(stderr, "Error [GENERAL | %s | OpenXR-Loader] : no runtime\n", name);
        printf("Info [GENERAL | %s | OpenXR-Loader] : no runtime\n", name);
        fflush(stdout);
    }
    *function = NULL;
    return -51;
}
"#,
    );
    let mut cc = Command::new("cc");
    cc.args(["-shared", "-fPIC", "-o"]);
    let built = cc.arg(place.path("libopenxr_loader.so.1")).arg(place.path("loader.c"));
    assert!(built.status().unwrap().success());
    let list = |variable: Option<&str>| {
        let mut command = place.command(&["device", "list", "--json"]);
        command.env("LD_LIBRARY_PATH", place.path(""));
        command.env_remove("XR_LOADER_DEBUG");
        command.envs(variable.map(|value| ("XR_LOADER_DEBUG", value)));
        Run::of(command.output().unwrap())
    };
    let quiet = list(None);
    assert_eq!((quiet.code(), &quiet.error()[..]), (0, ""));
    let listed: serde_json::Value = serde_json::from_str(&quiet.text()).unwrap();
    assert!(!listed["devices"].as_array().unwrap().is_empty());
    // Who debugs a loader says so, and gets its lines.
    assert!(list(Some("all")).error().contains("OpenXR-Loader"));
}

fn recorded(place: &Place, variable: &str, arguments: &[&str]) -> (String, String) {
    let record = place.path("record.txt");
    let run = place.command(arguments).env(variable, &record).output().unwrap();
    let run = Run::of(run);
    assert_eq!(run.code(), 0, "{}", run.error());
    (std::fs::read_to_string(record).unwrap(), run.text())
}

#[test]
fn a_texture_is_played_on_a_gamepad() {
    let place = Place::new();
    let Some(driver) = pad(&place) else { return };
    texture(&place);
    let play = ["play", "t.htex", "--device", "sdl", "--set", &driver, "--seconds", "1"];
    let (told, text) = recorded(&place, "PAD_RECORD", &play);
    let strengths: Vec<(u32, u32)> = told
        .lines()
        .map(|line| {
            let (large, small) = line.split_once(' ').unwrap();
            (large.parse().unwrap(), small.parse().unwrap())
        })
        .collect();
    assert!(strengths.len() > 50, "{told}");
    assert_eq!(strengths.last(), Some(&(0, 0)));
    assert!(strengths.iter().any(|(large, small)| large + small > 6_000), "{told}");
    assert!(text.starts_with("Gamepad: 1.000 s at 8000 Hz"), "{text}");
    assert!(text.contains("0 underruns"), "{text}");
}

#[test]
fn a_texture_is_played_on_a_controller() {
    let place = Place::new();
    let runtime = runtime(&place);
    texture(&place);
    for (form, kind) in [("form=points", "points right"), ("form=pcm", "samples right rate 2000")] {
        let play = ["play", "t.htex", "--device", "parametric", "--seconds", "1"];
        let play = [&play[..], &["--set", &runtime, "--set", form]].concat();
        let (told, text) = recorded(&place, "MOCK_XR_RECORD", &play);
        assert!(!told.contains("broken"), "{told}");
        assert!(told.lines().filter(|line| line.starts_with(kind)).count() > 50, "{told}");
        assert!(told.contains("\nstop right") && told.ends_with("end\n"), "{told}");
        assert!(text.contains("OpenXR controller: 1.000 s"), "{text}");
        std::fs::remove_file(place.path("record.txt")).unwrap();
    }
}

#[test]
fn a_texture_is_played_on_the_actuators_of_a_dualsense() {
    let place = Place::new();
    texture(&place);
    let play = ["play", "t.htex", "--device", "channels", "--seconds", "1"];
    let run = place.run(&[&play[..], &["--set", "to=file", "--set", "path=pad.wav"]].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    let wav = hound::WavReader::open(place.path("pad.wav")).unwrap();
    assert_eq!((wav.spec().channels, wav.spec().sample_rate, wav.duration()), (4, 48_000, 48_000));
    let samples = place.samples("pad.wav");
    let is_alike = |frame: &[f32]| frame[..2] == [0.0, 0.0] && frame[2] == frame[3];
    assert!(samples.chunks(4).all(is_alike));
    assert!(samples.iter().any(|x| x.abs() > 0.05));
}

#[test]
fn they_keep_what_devices_promise() {
    let place = Place::new();
    let driver = pad(&place);
    let all = checks_of(Some(Direction::Output)).count();
    let mut devices = vec![("channels", "to=null".to_owned())];
    devices.extend(driver.map(|driver| ("sdl", driver)));
    for (device, setting) in devices {
        let report = native::checked(&place, &[device, "--set", &setting]);
        assert_eq!(complaints(&report), [], "{device}: {report:#}");
        assert_eq!(count(&report, "passed"), all - OF_LIBRARIES, "{device}: {report:#}");
    }
    let runtime = runtime(&place);
    for form in ["form=points", "form=pcm"] {
        let arguments = ["parametric", "--set", &runtime, "--set", form];
        let report = native::checked(&place, &arguments);
        // What is connected is asked of the installed runtime, which is seldom there.
        let mut complaints = complaints(&report);
        complaints
            .retain(|(check, outcome)| (&check[..], &outcome[..]) != ("endpoints", "warning"));
        assert_eq!(complaints, [], "{form}: {report:#}");
        let passed = count(&report, "passed");
        assert!(passed >= all - OF_LIBRARIES - 1, "{form}: {report:#}");
    }
}

#[test]
fn they_say_what_they_make_of_samples_and_what_is_lost() {
    let place = Place::new();
    for device in ["sdl", "parametric", "channels"] {
        let info = place.json(&["device", "info", device, "--json"]);
        let [plays, loses] = ["plays", "loses"].map(|key| {
            let text = info["descriptor"]["mapping"][key].as_str().unwrap();
            text.to_owned()
        });
        let text = place.run(&["device", "info", device]).text();
        assert!(text.contains(&format!("  plays: {plays}\n  lost: {loses}\n")), "{text}");
    }
    let text = place.run(&["device", "info", "file", "--set", "path=a.wav"]).text();
    assert!(text.contains("mapping\n  plays: the samples\n"), "{text}");
}
