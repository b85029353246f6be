//! The adapters of cards and of sound on the command line.

use crate::common::Place;
use htex_device::FromScene;

#[test]
fn cards_are_listed_whether_or_not_their_driver_is_there() {
    let place = Place::new();
    let list = place.json(&["device", "list", "--json"]);
    let all = list["devices"].as_array().unwrap();
    let daq = all.iter().find(|d| d["id"] == "org.htex.daq").unwrap();
    let problem = daq["problem"].as_str().unwrap_or_default();
    let there = daq["endpoints"].as_array().unwrap();
    assert!(!there.is_empty() || problem.contains("ni.com"), "{daq}");
    let sound = all.iter().any(|d| d["id"] == "org.htex.audio");
    assert_eq!(sound, cfg!(feature = "audio"));
}

/// All settings that a file may give to the command's devices, grouped by what it may do with them.
/// Only the user gives the others. Settings of written files describe the file. A new setting
/// belongs into this list, or is `never`.
#[test]
fn what_a_file_may_ask_of_devices() {
    let any = ["encoding", "format", "full_scale", "path", "quantity", "limit_v", "carrier_hz"];
    let mut allowed: Vec<String> =
        any.iter().map(|name| format!("org.htex.file {name} any")).collect();
    for setting in ["limit_v less", "dc_limit_v less", "buffer_ms less", "ramp_ms more"] {
        allowed.push(format!("org.htex.daq {setting}"));
    }
    for device in ["channels", "parametric", "sdl"] {
        allowed.push(format!("org.htex.{device} buffer_ms less"));
    }
    if cfg!(feature = "audio") {
        allowed.push("org.htex.audio buffer_ms less".to_owned());
    }
    let mut found = Vec::new();
    for adapter in htex_device_builtin::devices() {
        let descriptor = adapter.descriptor();
        for setting in &descriptor.settings {
            let how = match setting.from_scene {
                FromScene::Any => "any",
                FromScene::Less => "less",
                FromScene::More => "more",
                FromScene::Never => continue,
            };
            found.push(format!("{} {} {how}", descriptor.id, setting.name));
        }
    }
    allowed.sort();
    found.sort();
    assert_eq!(found, allowed);
}

#[test]
fn a_command_without_sound_says_how_to_get_it() {
    let run = Place::new().run(&["device", "info", "audio"]);
    if cfg!(feature = "audio") {
        assert_eq!(run.code(), 0, "{}", run.error())
    } else {
        assert!(run.error().contains("--features audio"), "{}", run.error())
    }
}

#[test]
fn a_check_names_the_flag_of_a_missing_setting() {
    let run = Place::new().run(&["device", "check", "daq"]);
    assert!(run.text().contains("give `--set amplifier_gain=…`"), "{}", run.text());
}
