//! Textures of other quantities than force, from the recording to the device.

use crate::common::{Place, numbers, stated};

const RATE_HZ: usize = 5_000;
const G_M_S2: f64 = 9.806_65;

/// Four seconds of a tool tip in g: tones of 0.3 and 0.4 g at 100 Hz on two axes, gravity on the
/// third.
fn tool_csv() -> String {
    let row = |n: usize| {
        let t = n as f64 / RATE_HZ as f64;
        let tone = (std::f64::consts::TAU * 100.0 * t).sin();
        // A little of everything else, without a generator: a chirp.
        let rest = 0.01 * (std::f64::consts::TAU * (30.0 + 100.0 * t) * t).sin();
        let [x, y, z] = [0.3 * tone + rest, 0.4 * tone, 1.0];
        format!("{t:.6},{x:.9},{y:.9},{z:.9}\n")
    };
    "t_s,ax_g,ay_g,az_g\n".to_owned() + &(0..4 * RATE_HZ).map(row).collect::<String>()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}

/// The numbers of a CSV that a file device wrote, and the name of its second column.
fn written(place: &Place, name: &str) -> (String, Vec<f64>) {
    let text = std::fs::read_to_string(place.path(name)).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let value = |row: &str| row.split_once(',').unwrap().1.parse().unwrap();
    let column = header.split_once(',').unwrap().1;
    (column.to_owned(), rows.lines().map(value).collect())
}

#[test]
fn an_acceleration_keeps_its_unit_from_the_recording_to_the_device() {
    let place = Place::new();
    place.write("tool.csv", tool_csv());
    let refused = place.run(&["process", "tool.csv"]);
    assert_ne!(refused.code(), 0);
    for words in ["choose the quantity acceleration", "(see --map, --quantity)"] {
        assert!(refused.error().contains(words), "{}", refused.error());
    }

    let quantity = ["--quantity", "acceleration"];
    let process = ["process", "tool.csv", "--json"];
    let spectrum = place.json(&[&process[..], &quantity].concat());
    assert_eq!(
        (&spectrum["quantity"], &spectrum["unit"]),
        (&"acceleration".into(), &"m/s2".into())
    );
    // Axes are folded into one; gravity is no texture.
    let at_100_hz = numbers(&spectrum["magnitude"])[16];
    assert!((at_100_hz / (0.5 * G_M_S2) - 1.0).abs() < 0.02, "{at_100_hz}");
    let csv = place.run(&[&["process", "tool.csv"][..], &quantity].concat());
    assert!(csv.text().starts_with("frequency_hz,magnitude_m_s2\n"), "{}", csv.text());

    let fit = ["fit", "tool.csv", "--at", "speed=100,force=1", "-o", "tool.htex", "--json"];
    let fitted = place.json(&[&fit[..], &quantity, &["--model", "speak"]].concat());
    let level = stated(&fitted, 0)["level_rms"].as_f64().unwrap();
    let info = place.run(&["info", "tool.htex"]);
    assert!(info.text().contains("acceleration in m/s2, 20 to 1000 Hz"), "{}", info.text());
    assert!(info.text().contains(&format!("{level:.3} m/s2")), "{}", info.text());
    let spectrum = place.run(&["spectrum", "tool.htex"]);
    assert!(spectrum.text().starts_with("frequency_hz,magnitude_m_s2\n"));
    let compare = place.run(&["compare", "tool.csv", "tool.htex", "--map", "lateral=ax_g:1"]);
    assert!(compare.error().contains("--quantity acceleration"), "{}", compare.error());

    let play = |more: &[&str]| {
        let played = ["play", "tool.htex", "--seconds", "4"];
        place.run(&[&played[..], &["--device", "file", "--set", "path=out.csv"], more].concat())
    };
    let refused = play(&[]);
    assert_eq!(refused.code(), 1);
    assert!(refused.error().contains("quantity=acceleration"), "{}", refused.error());
    assert!(!place.path("out.csv").exists());
    for (more, column, factor) in [
        (&["--set", "quantity=acceleration"][..], "acceleration_m_s2", 1.0),
        (&["--quantity-gain", "0.25"], "lateral_force_n", 0.25),
        (&["--quantity-gain", "2", "--set", "quantity=displacement"], "displacement_m", 2.0),
    ] {
        let played = play(more);
        assert_eq!(played.code(), 0, "{}", played.error());
        let (named, samples) = written(&place, "out.csv");
        assert_eq!(named, column);
        let ratio = rms(&samples) / (factor * level);
        assert!((ratio - 1.0).abs() < 0.03, "{column}: {ratio}");
    }
    let twice = play(&["--quantity-gain", "1", "--set", "quantity=acceleration"]);
    assert!(twice.error().contains("DEVICE_QUANTITY"), "{}", twice.error());
}

/// Units in names, scales on the command line, and every quantity.
#[test]
fn every_quantity_is_read_in_its_unit() {
    let place = Place::new();
    let tone = |n: usize| (std::f64::consts::TAU * 200.0 * n as f64 / RATE_HZ as f64).sin();
    let rows: Vec<f64> = (0..2 * RATE_HZ).map(tone).collect();
    let lines: String = rows.iter().map(|x| format!("{x:.9}\n")).collect();
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: RATE_HZ as u32,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut wav = hound::WavWriter::create(place.path("tone.wav"), spec).unwrap();
    rows.iter().for_each(|x| wav.write_sample(*x as f32).unwrap());
    wav.finalize().unwrap();
    for (quantity, header, unit, amplitude) in [
        ("normal-force", "fz_mn", "N", 1e-3),
        ("acceleration", "accel_mm_s2", "m/s2", 1e-3),
        ("velocity", "velocity [mm/s]", "m/s", 1e-3),
        ("displacement", "disp_um", "m", 1e-6),
    ] {
        place.write("tone.csv", format!("{header}\n{lines}"));
        let rate = RATE_HZ.to_string();
        let csv = ["tone.csv", "--rate", &rate];
        let scale = amplitude.to_string();
        let wav = ["tone.wav", "--scale", &scale];
        for source in [csv, wav] {
            let process = ["process", "--json", "--quantity", quantity];
            let spectrum = place.json(&[&process[..], &source].concat());
            assert_eq!(spectrum["unit"], unit);
            let read = numbers(&spectrum["magnitude"])[36];
            assert!((read / amplitude - 1.0).abs() < 1e-3, "{quantity} of {source:?}: {read}");
        }
    }
}
