//! Envelopes on a mock vibrator (`vibrator.c`), which enforces the documented limits.

use crate::parametric_mock as mock;

use htex_device::{Adapter, DeviceError};
use htex_device_builtin::parametric::Parametric;
use mock::{LONG, Mock, RATE_HZ, settings, sine, write_all};

/// Parses effects as lists of amplitude, frequency (hertz) and duration (milliseconds).
fn effects(lines: &[String]) -> Vec<Vec<(f64, f64, u32)>> {
    let point = |word: &str| {
        let mut numbers = word.split(':');
        let mut next = || numbers.next().unwrap().parse::<f64>().unwrap();
        (next(), next(), next() as u32)
    };
    let all = lines.iter().filter_map(|line| line.strip_prefix("effect "));
    all.map(|line| line.split(' ').map(point).collect()).collect()
}

fn is_sound(lines: &[String]) -> bool {
    !lines.iter().any(|line| line.starts_with("broken"))
}

#[test]
fn a_texture_is_a_series_of_effects() {
    let Some(mock) = Mock::of("vibrator.c") else {
        return;
    };
    let given = [("form", "pwle"), ("block_ms", "20"), ("gain", "1")];
    // The number of blocks in an effect of 0.1 s, or as many as the vibrator accepts in addition to
    // the point that ends the effect.
    for (most, blocks) in [(16.0, 5), (4.0, 3)] {
        mock.set("most_points", most);
        let mut device = mock.open(&given).unwrap();
        write_all(device.as_mut(), &sine(200.0, 0.5, 0.32, RATE_HZ));
        device.finish().unwrap();
        assert_eq!(device.status().frames_played, 2_560);
        let lines = mock.record();
        assert!(is_sound(&lines), "{lines:#?}");
        assert_eq!(lines.last().unwrap(), "cancel");
        let effects = effects(&lines);
        let (last, whole) = effects.split_last().unwrap();
        assert!(whole.iter().all(|effect| effect.len() == blocks), "{effects:?}");
        assert_eq!(whole.len() * blocks + last.len() - 1, 16);
        let all: Vec<_> = effects.concat();
        let (end, played) = all.split_last().unwrap();
        assert_eq!((end.0, end.2), (0.0, 20));
        let level = 0.5 / 2f64.sqrt();
        assert!(played.iter().all(|p| (p.0 - level).abs() < 1e-3 && p.2 == 20), "{played:?}");
        assert!(played[8..].iter().all(|p| (p.1 - 200.0).abs() < 2.0), "{played:?}");
    }
}

#[test]
fn frequencies_stay_in_the_profile_of_the_vibrator() {
    let Some(mock) = Mock::of("vibrator.c") else {
        return;
    };
    let mut device = mock.open(&[("form", "pwle"), ("block_ms", "20")]).unwrap();
    write_all(device.as_mut(), &sine(700.0, 0.9, 0.3, RATE_HZ));
    device.finish().unwrap();
    let lines = mock.record();
    assert!(is_sound(&lines), "{lines:#?}");
    let all = effects(&lines).concat();
    assert!(all[8..].iter().all(|point| point.1 == 300.0), "{all:?}");
    assert!(all.iter().any(|point| point.0 == 1.0), "{all:?}");
}

#[test]
fn what_ends_it_cancels_it() {
    let Some(mock) = Mock::of("vibrator.c") else {
        return;
    };
    let given = [("form", "pwle"), ("block_ms", "20"), ("buffer_ms", "500")];
    let mut device = mock.open(&given).unwrap();
    let busy = mock.open(&given).err().unwrap();
    assert!(matches!(busy, DeviceError::Busy(_)), "{busy}");
    write_all(device.as_mut(), &sine(200.0, 0.5, 0.5, RATE_HZ));
    drop(device);
    assert_eq!(mock.record().last().unwrap(), "cancel");
    mock.set("fails", 1.0);
    let mut device = mock.open(&given).unwrap();
    let samples = sine(200.0, 0.5, 0.1, RATE_HZ);
    let error = loop {
        if let Err(error) = device.write(&samples, LONG) {
            break error.to_string();
        }
    };
    assert!(error.contains("htex_pwle_play returned -5"), "{error}");
    assert_eq!(mock.record(), ["cancel"]);
}

#[test]
fn what_the_vibrator_does_not_take_is_refused() {
    let Some(mock) = Mock::of("vibrator.c") else {
        return;
    };
    let adapter = Parametric;
    let asked = |given: &[(&str, &str)]| {
        let given = [&[("form", "pwle")], given].concat();
        adapter.capabilities(&mock.settings(&given)).unwrap_err()
    };
    let short = asked(&[("block_ms", "10")]).to_string();
    assert!(short.contains("`block_ms`") && short.contains("20 to 1000 ms"), "{short}");
    mock.set("most_points", 1.0);
    let senseless = asked(&[("block_ms", "20")]);
    assert!(matches!(senseless, DeviceError::Missing(_)), "{senseless}");
    mock.set("absent", 1.0);
    let absent = asked(&[("block_ms", "20")]).to_string();
    assert!(absent.contains("no vibrator that plays envelopes"), "{absent}");
    for library in ["", "libm.so.6", "no-such.so"] {
        let given = settings(&[("form", "pwle"), ("runtime", library)]).unwrap();
        let error = adapter.capabilities(&given).unwrap_err();
        assert!(
            matches!(&error, DeviceError::Setting { name, .. } if name == "runtime"),
            "{error}"
        );
    }
}

/// The vibrator must refuse each effect that breaks a rule.
#[test]
fn each_rule_bites() {
    #[repr(C)]
    struct Point(f32, f32, u32);
    type Play = unsafe extern "C" fn(*const Point, u32) -> i32;
    let Some(mock) = Mock::of("vibrator.c") else {
        return;
    };
    let many: Vec<Point> = (0..17).map(|_| Point(0.5, 200.0, 20)).collect();
    let wrong: [(&str, &[Point]); 7] = [
        ("no-points", &[]),
        ("most-points", &many),
        ("amplitude-0-to-1", &[Point(1.1, 200.0, 20)]),
        ("frequency-above-0", &[Point(0.5, 0.0, 20)]),
        ("frequency-in-profile", &[Point(0.5, 301.0, 20)]),
        ("duration", &[Point(0.5, 200.0, 19)]),
        ("duration", &[Point(0.5, 200.0, 1_001)]),
    ];
    for (rule, points) in wrong {
        // SAFETY: as `vibrator.c` has it.
        let code = unsafe {
            let play = mock.library.get::<Play>("htex_pwle_play").unwrap();
            play(points.as_ptr(), points.len() as u32)
        };
        assert_eq!(code, -2, "{rule}");
        assert_eq!(mock.record(), [format!("broken {rule}")]);
    }
}
