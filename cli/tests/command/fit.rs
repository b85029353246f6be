//! From recordings to assets, as a user runs it.

use std::time::Duration;

use crate::common::{Place, computed, entries, numbers, stated, words};
use htex_format::{By, Measure};
use htex_host::Registry;

#[test]
fn fit_info_and_the_file_agree_and_are_the_same_twice() {
    let place = Place::new();
    let csv = place.recording("sandpaper");
    // Its three sweeps are too few for a repeatability.
    let windows = ["--segments", "windows"];
    let fit = ["fit", &csv, "--model", "all", "-o", "a.htex", "--json"];
    let fit = place.json(&[&fit[..], &windows].concat());
    let info = place.json(&["info", "a.htex", "--json"]);
    assert_eq!(fit["bytes"], std::fs::metadata(place.path("a.htex")).unwrap().len());
    let condition = &fit["manifest"]["conditions"][0];
    assert!(condition["repeatability_rms_db"].as_f64().unwrap() > 0.0);
    for (i, loaded) in Registry::builtin().by_default().enumerate() {
        let model = loaded.id();
        let (fitted, read) = (&fit["representations"][i], &info["representations"][i]);
        assert_eq!(fitted["model"], model);
        assert!(fitted["fit_ms"].as_f64().unwrap() > 0.0);
        let mut parameters: Vec<&str> = computed(&fit, i)["parameters"]
            .as_object()
            .unwrap()
            .keys()
            .map(String::as_str)
            .collect();
        parameters.sort_unstable();
        let fields = loaded.descriptor().fields.iter();
        let mut fields: Vec<&str> = fields.map(|field| &field.name[..]).collect();
        fields.sort_unstable();
        assert_eq!(parameters, fields);
        let parameters = |summary| computed(summary, i)["parameters"].clone();
        assert_eq!(parameters(&fit), parameters(&info), "{model}");
        assert_eq!(fitted["payload_bytes"], read["payload_bytes"]);
        let (fitted, read) = (stated(&fit, i), stated(&info, i));
        assert_eq!(numbers(&fitted["quality"]["band_error_db"]).len(), 9);
        let both = Measure::of_both().filter(|m| m.row().stored);
        let keys = both.flat_map(|m| [By::Magnitude, By::Samples].map(|by| m.key(by)));
        let levels = [("level_rms", &fitted["level_rms"], &read["level_rms"])];
        let measures = keys.map(|key| (key, &fitted["quality"][key], &read["quality"][key]));
        for (key, a, b) in measures.chain(levels) {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            // The file keeps levels to nine digits and agreement to four decimals.
            assert!((a - b).abs() <= 5.1e-5 * a.abs().max(1.0), "{model} {key}: {a} {b}");
        }
    }
    let again = ["fit", &csv, "-o", "b.htex", "--name", "a", "--json"];
    place.json(&[&again[..], &windows].concat());
    let read = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert_eq!(read("a.htex"), read("b.htex"));
    assert_eq!(entries(&place.path("")), ["a.htex", "b.htex", "sandpaper.csv"]);
}

#[test]
fn assets_are_small() {
    let place = Place::new();
    let csv = place.recording("vinyl");
    let about = ["--name", "Vinyl floor, worn", "--author", "A Lab, A University", "--license"];
    let fit = |model: &str, file: &str| {
        let arguments = ["fit", &csv, "--model", model, "-o", file, "--json"];
        let tags = ["CC-BY-4.0", "--tags", "vinyl,floor,smooth"];
        let arguments = [&arguments[..], &about, &tags].concat();
        place.json(&arguments)["bytes"].as_u64().unwrap()
    };
    let (one, all) = (fit("sbeta", "one.htex"), fit("all", "all.htex"));
    println!("sBeta alone: {one} bytes; all: {all} bytes");
    assert!(one <= 1_024 && all <= 4_096, "{one} {all}");
}

fn db(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

/// Three generations of every model of noise, 300 s each, since the level of a minute of such noise
/// scatters by 0.07 dB: on vinyl and corrugated paper a third of the energy lies in the lowest bin,
/// where a copy would lose what the window misses at the band's edge.
#[test]
fn a_copy_of_a_copy_plays_as_strong_as_the_recording() {
    let place = Place::new();
    let all = ["vinyl", "corrugated-paper", "sandpaper", "fine-fabric", "coarse-fabric"];
    // Vinyl has most energy in the lowest bin.
    let tried = if xtask::prove::whole() { 5 } else { 1 };
    for surface in &all[..tried] {
        let csv = place.recording(surface);
        let magnitude = numbers(&place.json(&["process", &csv, "--json"])["magnitude"]);
        let recorded = (magnitude.iter().map(|m| m * m).sum::<f64>() / 3.0).sqrt();
        for model in ["ar", "mfcc", "sbeta", "sslope", "bands"] {
            let level = |recording: &str, more: &[&str]| {
                let fit = ["fit", recording, "--model", model, "-o", "g.htex", "--json"];
                let fitted = place.json(&[&fit[..], more].concat());
                stated(&fitted, 0)["level_rms"].as_f64().unwrap()
            };
            let mut levels = vec![level(&csv, &[])];
            for seed in ["0", "1", "2"] {
                let synth = ["synth", "g.htex", "--seconds", "300", "--rate", "8000"];
                let run = place.run(&[&synth[..], &["--seed", seed, "-o", "g.wav"]].concat());
                assert_eq!(run.code(), 0, "{}", run.error());
                levels.push(level("g.wav", &["--scale", "1"]));
            }
            let off_db: Vec<f64> = levels.iter().map(|level| db(level / recorded)).collect();
            println!("{surface:16} {model:6} {off_db:+.3?} dB over the recording");
            // Bands keeps the energies of its bands, which are rounded to steps of 1 dB. The level
            // of AR makes up for what a conversion takes near its Nyquist frequency.
            let first_db = match model {
                "bands" => 0.25,
                "ar" => 0.02,
                _ => 1e-6,
            };
            assert!(off_db[0].abs() < first_db, "{model}: {off_db:?}");
            assert!(
                off_db.iter().all(|db| (db - off_db[0]).abs() < 0.1),
                "{surface}, {model}: {off_db:?}"
            );
        }
    }
}

#[test]
fn a_fit_that_misses_its_bands_is_told_with_what_does_better() {
    let place = Place::new();
    let simulate = ["simulate", "--surface", "corrugated-paper", "--seed", "1"];
    let run = place.run(&[&simulate[..], &["-o", "cp.csv", "--frf", "rig.csv"]].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    let fit = |options: &[&str]| {
        let fit = ["fit", "cp.csv", "--frf", "rig.csv", "--model", "sbeta", "-o", "s.htex"];
        let fitted = place.json(&[&fit[..], &["--json"], options].concat());
        let error = &stated(&fitted, 0)["quality"]["band_error_rms_db"];
        let warnings = &fitted["manifest"]["provenance"]["warnings"];
        (error.as_f64().unwrap(), warnings.to_string())
    };
    let (by_magnitude_db, told) = fit(&["--option", "sbeta.error=magnitude"]);
    let (by_decibel_db, silent) = fit(&[]);
    println!("{by_magnitude_db:.1} dB, in decibels {by_decibel_db:.1} dB\n{told}");
    assert!(by_magnitude_db > 30.0 && by_decibel_db < 8.0);
    let advice = format!("sbeta.error=decibel with {by_decibel_db:.1} dB, the model bands with ");
    assert!(told.contains(&advice), "{told}");
    assert!(!silent.contains("nine-band error of"), "{silent}");

    // A steep spectrum: one band is far off, and the others hide it in the RMS.
    let mut low = [0.0; 2];
    let noise = |at: usize| {
        let mixed = (at as u64 ^ 0x9E37_79B9).wrapping_mul(0xD134_2543_DE82_EF95);
        let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0x2545_F491_4F6C_DD1D);
        (mixed >> 40) as f64 / f64::from(1u32 << 23) - 1.0
    };
    let mut steep = "t_s,lateral_n\n".to_owned();
    for at in 0..12_000 {
        low[0] += 0.04 * (noise(at) - low[0]);
        low[1] += 0.08 * (low[0] - low[1]);
        steep += &format!(
            "{:.6},{:.7}\n",
            at as f64 / 3000.0,
            0.3 + 0.1 * (low[1] + 0.005 * noise(at + 500_000))
        );
    }
    place.write("steep.csv", steep);
    let fitted = place.json(&words(
        "fit steep.csv --at speed=80,force=0.4 --model sbeta --option \
             sbeta.error=magnitude -o steep.htex --json",
    ));
    let quality = &stated(&fitted, 0)["quality"];
    println!("{quality}");
    let rms_db = quality["band_error_rms_db"].as_f64().unwrap();
    let bands = quality["band_error_db"].as_array().unwrap().iter();
    let worst_db = bands.fold(0.0, |worst: f64, error| worst.max(error.as_f64().unwrap().abs()));
    assert!(rms_db < 12.0 && worst_db > 24.0, "{rms_db} dB, {worst_db} dB");
    let warned = format!("{worst_db:.1} dB in the worst band");
    let warnings = fitted["manifest"]["provenance"]["warnings"].to_string();
    assert!(warnings.contains(&warned), "{warnings}");
}

#[test]
fn knobs_change_the_fit() {
    let place = Place::new();
    let csv = place.recording("fine-fabric");
    let parameters = |model: &str, options: &[&str]| {
        let mut arguments = vec!["fit", &csv, "--model", model, "-o", "k.htex", "--json"];
        options.iter().for_each(|option| arguments.extend(["--option", option]));
        computed(&place.json(&arguments), 0)["parameters"].clone()
    };
    let count = |model: &str, option: &str, list: &str| {
        parameters(model, &[option])[list].as_array().unwrap().len()
    };
    assert_eq!(count("ar", "ar.order=12", "coefficients"), 12);
    assert_eq!(count("mfcc", "mfcc.coefficients=7", "cepstrum"), 7);
    assert_eq!(count("speak", "speak.count=4", "frequency_hz"), 4);
    let speak = |jnd: &str| count("speak", &format!("speak.jnd={jnd}"), "frequency_hz");
    assert!(speak("0.9") < speak("0.12"));
    for (model, options) in [
        (
            "ar",
            &["ar.method=burg", "ar.method=covariance", "ar.method=decibel", "ar.rate_hz=4000"][..],
        ),
        (
            "mfcc",
            &[
                "mfcc.inverse=nnls",
                "mfcc.inverse=interpolate",
                "mfcc.inverse=log-log",
                "mfcc.fit=decibel",
                "mfcc.bands=20",
            ],
        ),
        ("speak", &["speak.phase=zero", "speak.frequency=bin"]),
        ("sbeta", &["sbeta.points=20", "sbeta.jnd=0.4", "sbeta.error=magnitude", "sbeta.bins=0"]),
        ("sslope", &["sslope.rounding_db_per_decade=20"]),
        ("bands", &["bands.bands=19", "bands.step_db=0.5", "bands.layout=within"]),
    ] {
        let default = parameters(model, &[]);
        for option in options {
            assert_ne!(parameters(model, &[option]), default, "{option}");
        }
    }
}

/// `--as paper` is all of the paper's choices, of which each can be replaced.
#[test]
fn one_flag_makes_every_choice_of_the_paper() {
    let place = Place::new();
    let csv = place.recording("sandpaper");
    let fit = |flags: &str| {
        let all = format!("fit {csv} -o a.htex --json {flags}");
        place.json(&words(&all))["manifest"].clone()
    };
    let paper = fit("--as paper");
    let explicit = fit("--model ar,mfcc,speak,sbeta,sslope --segments sweeps \
         --averaging magnitude --level fitted --option speak.frequency=bin \
         --option speak.phase=zero --option sbeta.error=magnitude --option sbeta.lower_bound=1 \
         --option sbeta.bins=0 --option sbeta.refit=never \
         --option sslope.rounding_db_per_decade=20");
    assert_eq!(paper["representations"], explicit["representations"]);
    let recorded = |manifest: &serde_json::Value| {
        let mut options = manifest["provenance"]["options"].as_object().unwrap().clone();
        let name = options.remove("as");
        (options, name)
    };
    assert_eq!(recorded(&paper).0, recorded(&explicit).0);
    assert_eq!(recorded(&paper).1.unwrap(), "paper");
    let other = "--as paper --model sslope --option org.htex.sslope.rounding_db_per_decade=1";
    let options = recorded(&fit(other)).0;
    assert_eq!(options["org.htex.sslope.rounding_db_per_decade"], "1");
    assert!(!options.contains_key("sslope.rounding_db_per_decade"));
    assert!(options["averaging"] == "magnitude" && !options.contains_key("sbeta.refit"));
    // A flag takes precedence also where it names the default.
    let usual = "--segments windows --averaging rms --level recording --model sbeta,speak";
    let (mixed, expected) = (
        fit(&format!("--as paper {usual} --option speak.frequency=interpolated")),
        fit(&format!(
            "{usual} --option speak.phase=zero --option sbeta.error=magnitude \
             --option sbeta.lower_bound=1 --option sbeta.bins=0 --option sbeta.refit=never"
        )),
    );
    assert_eq!(mixed["representations"], expected["representations"]);
}

#[test]
fn several_conditions_of_one_texture() {
    let place = Place::new();
    let mut arguments = vec!["fit"];
    let mut names = Vec::new();
    for (speed, force) in [("60", "0.3"), ("120", "0.3"), ("60", "0.7"), ("120", "0.7")] {
        let name = format!("{speed}-{force}.csv");
        let run = place.run(&words(&format!(
            "simulate --surface sandpaper --seconds 4 --speed {speed} --force {force} -o {name}"
        )));
        assert_eq!(run.code(), 0, "{}", run.error());
        names.push(name);
    }
    arguments.extend(names.iter().map(String::as_str));
    let given: Vec<String> = ["60,force=0.3", "120,force=0.3", "60,force=0.7", "120,force=0.7"]
        .iter()
        .map(|at| format!("--at=speed={at}"))
        .collect();
    arguments.extend(given.iter().map(String::as_str));
    arguments.extend(["-o", "grid.htex", "--json"]);
    let fit = place.json(&arguments);
    assert_eq!(fit["manifest"]["conditions"].as_array().unwrap().len(), 4);
    assert_eq!(fit["representations"][0]["at"].as_array().unwrap().len(), 4);
    let level = |speed: &str, force: &str| {
        let motion = ["--model", "sbeta", "--speed", speed, "--force", force, "--json"];
        let spectrum = place.json(&[&["spectrum", "grid.htex"][..], &motion].concat());
        let sum: f64 = numbers(&spectrum["magnitude"]).iter().map(|m| m * m / 3.0).sum();
        sum.sqrt()
    };
    // At a known condition the level is the condition's own. Between conditions it lies between
    // their levels. Outside it follows the law.
    let known = fit["manifest"]["representations"][3]["at"][3]["level_rms"].as_f64().unwrap();
    assert!((level("120", "0.7") / known - 1.0).abs() < 1e-6);
    assert!(level("60", "0.3") < level("60", "0.5") && level("60", "0.5") < level("60", "0.7"));
    assert!(level("500", "9") > level("120", "0.7"));
}

#[test]
fn killed_at_any_moment_the_old_or_the_new_file_is_there() {
    let place = Place::new();
    let csv = place.recording("vinyl");
    let fit = |name: &str| ["fit", &csv, "-o", "t.htex", "--name", name].map(str::to_owned);
    let run = |name: &str| {
        let arguments = fit(name);
        place.command(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    };
    run("old").output().unwrap();
    let old = std::fs::read(place.path("t.htex")).unwrap();
    run("new").output().unwrap();
    let new = std::fs::read(place.path("t.htex")).unwrap();
    assert_ne!(old, new);
    for i in 0..24 {
        std::fs::write(place.path("t.htex"), &old).unwrap();
        let mut child = run("new").stdout(std::process::Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(5 * i));
        child.kill().unwrap();
        child.wait().unwrap();
        let left = std::fs::read(place.path("t.htex")).unwrap();
        assert!(left == old || left == new, "killed after {} ms", 5 * i);
    }
}

#[test]
fn wrong_usage_is_told_apart_from_failure() {
    let place = Place::new();
    let csv = place.recording("vinyl");
    for (arguments, word) in [
        (&["fit", &csv, "-o", "x.htex", "--model", "wavelet"][..], "wavelet"),
        (&["fit", &csv, "-o", "x.htex", "--option", "ar.order=99"], "order"),
        (&["fit", &csv, "-o", "x.htex", "--option", "ar.colour=1"], "colour"),
        (&["fit", &csv, "-o", "x.htex", "--at", "speed:80"], "--at"),
        (&["fit", &csv, "-o", "x.htex", "--map", "middle=fx_n"], "middle"),
        (&["explain", "NO_SUCH_CODE"], "NO_SUCH_CODE"),
        (&["synth", "a.htex", "-o", "x.wav", "--rate", "7"], "7"),
        (&["simulate", "--surface", "gravel", "-o", "g.csv"], "gravel"),
    ] {
        let run = place.run(arguments);
        assert_eq!(run.code(), 2, "{arguments:?}: {}", run.error());
        assert!(run.error().contains(word), "{arguments:?}: {}", run.error());
    }
    let run = place.run(&["info", "nothing.htex"]);
    assert_eq!(run.code(), 1);
    assert!(run.error().contains("nothing.htex"), "{}", run.error());
    assert_eq!(entries(&place.path("")), ["vinyl.csv"]);
    let strict = ["fit", &csv, "-o", "x.htex", "--speed", "200", "--strict"];
    let run = place.run(&strict);
    assert_eq!(run.code(), 1);
    assert!(run.error().contains("10 %"), "{}", run.error());
}

/// The asset holds the hash of each recording, by which recordings of one name are told apart, also
/// of one whose part is read; a pipe, which is read once, has none.
#[test]
fn an_asset_has_the_hash_of_each_recording() {
    let place = Place::new();
    let first = place.recording("vinyl");
    let second = place.recording("sandpaper");
    std::fs::create_dir(place.path("other")).unwrap();
    std::fs::rename(place.path(&second), place.path(&format!("other/{first}"))).unwrap();
    let other = format!("other/{first}");
    let fit = |recordings: &[&str], more: &[&str]| {
        let fit = ["--model", "bands", "-o", "a.htex", "--json"];
        place.json(&[&["fit"], recordings, &fit, more].concat());
        let asset = htex_format::Asset::open(&place.path("a.htex")).unwrap();
        let recordings = asset.manifest.provenance.recordings.into_iter();
        let hashed = recordings.map(|source| (source.file, source.blake3.unwrap_or_default()));
        hashed.collect::<Vec<_>>()
    };
    let hash = |file: &str| {
        let bytes = std::fs::read(place.path(file)).unwrap();
        blake3::hash(&bytes).to_hex().to_string()
    };
    let named = |file: &str| (first.clone(), hash(file));
    assert_eq!(fit(&[&first, &other], &[]), [named(&first), named(&other)]);
    assert_ne!(hash(&first), hash(&other));
    assert_eq!(fit(&[&first], &["--from", "1"]), [named(&first)]);
    #[cfg(unix)]
    {
        let pipe = place.path("pipe.csv");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        let bytes = std::fs::read(place.path(&first)).unwrap();
        let writer = std::thread::spawn(move || std::fs::write(pipe, bytes));
        let none = ("pipe.csv".to_owned(), String::new());
        assert_eq!(fit(&["pipe.csv"], &[]), [none]);
        writer.join().unwrap().unwrap();
    }
}
