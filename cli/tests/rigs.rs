//! The adapters of cards and of sound on the command line.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::Place;

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

#[test]
fn a_command_without_sound_says_how_to_get_it() {
    let run = Place::new().run(&["device", "info", "audio"]);
    match cfg!(feature = "audio") {
        true => assert_eq!(run.code(), 0, "{}", run.error()),
        false => assert!(run.error().contains("--features audio"), "{}", run.error()),
    }
}

#[test]
fn a_check_names_the_flag_of_a_missing_setting() {
    let run = Place::new().run(&["device", "check", "daq"]);
    assert!(
        run.text().contains("give `--set amplifier_gain=…`"),
        "{}",
        run.text()
    );
}
