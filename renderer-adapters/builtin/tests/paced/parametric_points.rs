//! Streams of points and of samples on a mock runtime (`runtime.c`), which enforces the rules.

use crate::parametric_mock as mock;

use std::time::Instant;

use htex_device::{Adapter, DeviceError, Output, Quantity, Rates};
use htex_device_builtin::parametric::Parametric;
use mock::{Frame, LONG, Mock, RATE_HZ, settings, sine, write_all};

fn frames(lines: &[String]) -> Vec<Frame> {
    lines.iter().filter_map(|line| Frame::of(line)).collect()
}

fn broken(lines: &[String]) -> Vec<&String> {
    lines.iter().filter(|line| line.starts_with("broken")).collect()
}

#[test]
fn a_texture_is_a_stream_that_keeps_the_rules() {
    let Some(mock) = Mock::new() else { return };
    // A runtime without preferences, one that wants 50 ms before it begins, and one that wants
    // frames of 40 ms.
    for (ideal_ms, first_ms) in [(0.0, 0.0), (0.0, 50.0), (40.0, 30.0)] {
        mock.set("ideal_ns", ideal_ms * 1e6);
        mock.set("first_ns", first_ms * 1e6);
        let mut device =
            mock.open(&[("gain", "1"), ("low_hz", "100"), ("high_hz", "300")]).unwrap();
        write_all(device.as_mut(), &sine(200.0, 0.5, 0.4, RATE_HZ));
        device.finish().unwrap();
        assert_eq!(device.status().frames_played, 3_200);
        drop(device);
        let lines = mock.record();
        assert_eq!(broken(&lines), [""; 0]);
        let frames = frames(&lines);
        let kinds: Vec<&str> = frames.iter().map(|f| f.kind.as_str()).collect();
        let (first, rest) = kinds.split_first().unwrap();
        let (last, between) = rest.split_last().unwrap();
        assert_eq!((*first, *last), ("first", "last"));
        assert!(between.iter().all(|kind| *kind == "intermediate") && between.len() >= 6);
        assert_eq!(frames[0].range_hz, (100.0, 300.0));
        assert!(frames[0].amplitudes.last().unwrap().0 as f64 >= first_ms * 1e6);
        // The runtime must have time for the blocks that are kept back.
        let stop = lines.iter().rposition(|line| line.starts_with("stop right")).unwrap();
        assert_eq!(lines[stop + 1..], ["end"], "the session ends with its last device");
        let since = frames[0].at_ns;
        let stopped: i64 = lines[stop].rsplit(' ').next().unwrap().parse().unwrap();
        assert!(stopped - since >= 400_000_000, "{}", stopped - since);

        let amplitudes: Vec<_> = frames.iter().flat_map(|f| f.amplitudes.clone()).collect();
        let times: Vec<i64> = amplitudes.iter().map(|a| a.0).collect();
        let late = lines.iter().any(|line| line.starts_with("late"));
        if !late {
            let expected = (0..=40).map(|i| 10_000_000 * i).chain([400_000_000]);
            assert_eq!(times, expected.collect::<Vec<_>>());
        }
        assert_eq!(amplitudes.last().unwrap().1, 0.0);
        let level = 0.5 / 2f64.sqrt();
        for (_, value) in &amplitudes[..amplitudes.len() - 1] {
            assert!((value - level).abs() < 1e-3, "{value}");
        }
        let steady: Vec<_> = frames.iter().flat_map(|f| f.frequencies.clone()).skip(16).collect();
        assert!(steady.iter().all(|(_, place)| (place - 0.5).abs() < 0.01), "{steady:?}");
    }
}

/// Each frame must come before the runtime has played all the points it has.
#[test]
fn frames_come_in_time() {
    let Some(mock) = Mock::new() else { return };
    mock.set("ideal_ns", 40e6);
    let mut device = mock.open(&[("block_ms", "20")]).unwrap();
    write_all(device.as_mut(), &sine(200.0, 0.5, 1.0, RATE_HZ));
    device.finish().unwrap();
    let lines = mock.record();
    let late = lines.iter().filter(|line| line.starts_with("late")).count();
    // On a busy machine, a thread is sometimes held up for more than one block of 20 ms.
    assert!(late <= 2 && frames(&lines).len() >= 24, "{late} late: {lines:#?}");
    assert_eq!(broken(&lines), [""; 0]);
}

#[test]
fn a_texture_shorter_than_the_first_frame_is_one_event() {
    let Some(mock) = Mock::new() else { return };
    mock.set("first_ns", 100e6);
    let mut device = mock.open(&[]).unwrap();
    let since = Instant::now();
    write_all(device.as_mut(), &sine(200.0, 0.5, 0.05, RATE_HZ));
    device.finish().unwrap();
    assert!(since.elapsed().as_millis() >= 90, "the runtime plays it after the last block");
    let lines = mock.record();
    assert_eq!(broken(&lines), [""; 0]);
    let frames = frames(&lines);
    assert_eq!((frames.len(), frames[0].kind.as_str()), (1, "whole"));
    assert_eq!(frames[0].amplitudes.last(), Some(&(50_000_000, 0.0)));
    // A device without any samples plays nothing.
    let mut device = mock.open(&[]).unwrap();
    device.finish().unwrap();
    drop(device);
    assert!(!mock.record().iter().any(|line| line.starts_with("points")));
}

/// The range of the points must lie within the controller's range. Otherwise the runtime would
/// change the range.
#[test]
fn frequencies_are_places_in_the_range_of_the_controller() {
    let Some(mock) = Mock::new() else { return };
    for (element, stated, range, place) in [
        ((0.0, 0.0), None, (50.0, 500.0), 0.3333),
        ((80.0, 320.0), None, (80.0, 320.0), 0.5),
        ((80.0, 320.0), Some(("20", "260")), (80.0, 260.0), 0.6667),
        // An actuator with a single frequency.
        ((175.0, 175.0), Some(("100", "300")), (175.0, 175.0), 0.5),
    ] {
        mock.set("min_hz", element.0);
        mock.set("max_hz", element.1);
        let stated = stated.map_or(vec![], |(low, high)| vec![("low_hz", low), ("high_hz", high)]);
        let mut device = mock.open(&stated).unwrap();
        write_all(device.as_mut(), &sine(200.0, 0.3, 0.2, RATE_HZ));
        device.finish().unwrap();
        drop(device);
        let lines = mock.record();
        assert_eq!(broken(&lines), [""; 0]);
        let frames = frames(&lines);
        assert_eq!(frames[0].range_hz, range);
        let (_, last) = frames.last().unwrap().frequencies.last().unwrap();
        assert!((last - place).abs() < 0.01, "{last} {place}");
    }
}

#[test]
fn samples_are_played_as_they_are_at_the_rate_of_the_controller() {
    let Some(mock) = Mock::new() else { return };
    // One runtime has space for only 60 samples at a time, which is less than two blocks.
    for most in [4_000.0, 60.0] {
        mock.set("pcm_rate", 2_000.0);
        mock.set("pcm_most", most);
        let given = [("form", "pcm"), ("hand", "left"), ("block_ms", "20")];
        let can = Parametric.capabilities(&mock.settings(&given)).unwrap();
        can.check().unwrap();
        assert_eq!(can.rates, Rates::List(vec![2_000.0]));
        let mut device = mock.open(&given).unwrap();
        let mut samples = sine(90.0, 0.999, 0.3, 2_000.0);
        samples[100] = 1.0;
        samples[101] = -1.0;
        write_all(device.as_mut(), &samples);
        device.finish().unwrap();
        drop(device);
        let lines = mock.record();
        assert_eq!(broken(&lines), [""; 0]);
        let calls: Vec<&String> = lines.iter().filter(|l| l.starts_with("samples")).collect();
        assert!(calls[0].starts_with("samples left rate 2000 append 0"), "{}", calls[0]);
        assert!(calls[1..].iter().all(|l| l.starts_with("samples left rate 2000 append 1")));
        let played = calls.iter().flat_map(|line| line.split(' ').skip(6));
        let played: Vec<f32> = played.map(|x| x.parse().unwrap()).collect();
        assert!(played == samples, "{} of {} samples", played.len(), samples.len());
        assert!(lines.iter().any(|line| line.starts_with("stop left")));
    }
    let refused = mock.open_at(8_000.0, &[("form", "pcm")]).err().unwrap();
    assert!(matches!(refused, DeviceError::Rate { .. }), "{refused}");
    mock.set("pcm_rate", 0.0);
    let refused = mock.open(&[("form", "pcm")]).err().unwrap().to_string();
    assert!(refused.contains("the right hand has no device that plays samples"), "{refused}");
}

#[test]
fn both_hands_share_a_session_and_each_has_one_device() {
    let Some(mock) = Mock::new() else { return };
    let mut left = mock.open_at(RATE_HZ, &[("hand", "left")]).unwrap();
    let mut right = mock.open(&[("hand", "right"), ("buffer_ms", "1000")]).unwrap();
    let error = mock.open(&[("hand", "right")]).err().unwrap();
    assert!(matches!(error, DeviceError::Busy(_)), "{error}");
    let samples = sine(200.0, 0.5, 0.1, RATE_HZ);
    write_all(left.as_mut(), &samples);
    // The right hand plays while the other one ends.
    write_all(right.as_mut(), &sine(200.0, 0.5, 0.9, RATE_HZ));
    left.finish().unwrap();
    right.finish().unwrap();
    drop((left, right));
    let lines = mock.record();
    assert_eq!(broken(&lines), [""; 0]);
    assert_eq!(lines.iter().filter(|line| *line == "instance").count(), 1);
    for hand in ["left", "right"] {
        let last = frames(&lines).into_iter().rfind(|f| f.hand == hand).unwrap();
        assert_eq!((last.kind.as_str(), last.amplitudes.last().unwrap().1), ("last", 0.0));
    }
    drop(mock.open(&[]).unwrap());
}

#[test]
fn whatever_ends_it_the_hand_is_at_rest() {
    let Some(mock) = Mock::new() else { return };
    let play = |mock: &Mock| -> Box<dyn Output> {
        let mut device = mock.open(&[("buffer_ms", "1000")]).unwrap();
        write_all(device.as_mut(), &sine(200.0, 0.5, 0.9, RATE_HZ));
        let since = Instant::now();
        let mut seen = Vec::new();
        while !seen.iter().any(|line: &String| line.starts_with("points")) {
            assert!(since.elapsed() < LONG);
            seen.extend(mock.record());
        }
        device
    };
    let until_it_fails = |device: &mut dyn Output| {
        let samples = sine(200.0, 0.5, 0.01, RATE_HZ);
        loop {
            if let Err(error) = device.write(&samples, LONG) {
                return error.to_string();
            }
        }
    };
    drop(play(&mock));
    assert!(mock.record().iter().any(|line| line.starts_with("stop right")));

    let mut device = play(&mock);
    assert!(matches!(device.write(&[2.0], LONG), Err(DeviceError::OverLimit { .. })));
    assert!(mock.record().iter().any(|line| line.starts_with("stop right")));
    drop(device);

    let mut device = play(&mock);
    mock.set("fails", 1.0);
    let error = until_it_fails(device.as_mut());
    assert!(error.contains("xrApplyHapticFeedback") && error.contains("(-2)"), "{error}");
    assert!(mock.record().iter().any(|line| line.starts_with("stop right")));
    assert!(matches!(device.write(&[0.0], LONG), Err(DeviceError::Closed(_))));
    mock.set("fails", 0.0);
    drop(device);

    let mut device = play(&mock);
    mock.set("focused", 0.0);
    let error = until_it_fails(device.as_mut());
    assert!(error.contains("lost the focus"), "{error}");
    assert!(mock.record().iter().any(|line| line.starts_with("stop right")));
}

#[test]
fn what_cannot_take_effect_is_refused() {
    let Some(mock) = Mock::new() else { return };
    let adapter = Parametric;
    adapter.descriptor().check().unwrap();
    let can = adapter.capabilities(&mock.settings(&[])).unwrap();
    can.check().unwrap();
    assert_eq!((can.quantity, can.limit), (Quantity::Sound, Some(1.0)));
    for (given, name, says) in [
        (&[("form", "pcm"), ("gain", "2")][..], "gain", "form=points"),
        (&[("form", "pcm"), ("low_hz", "50"), ("high_hz", "90")], "low_hz", "form=points"),
        (&[("low_hz", "50")], "high_hz", "belongs to it"),
        (&[("high_hz", "50")], "low_hz", "belongs to it"),
        (&[("low_hz", "90"), ("high_hz", "50")], "high_hz", "below low_hz"),
        (&[("low_hz", "0.5"), ("high_hz", "50")], "low_hz", "1 to 1000 Hz"),
    ] {
        match adapter.capabilities(&mock.settings(given)) {
            Err(DeviceError::Setting { name: named, what }) => {
                assert!(named == name && what.contains(says), "{named}: {what}");
            }
            other => unreachable!("{given:?}: {other:?}"),
        }
    }
    assert!(settings(&[("high_hz", "1001")]).is_err());
    mock.set("first_ns", 6e9);
    let long = mock.open(&[("block_ms", "10")]).err().unwrap().to_string();
    assert!(long.contains("block_ms") && long.contains("500 points"), "{long}");
    mock.set("first_ns", 0.0);
    for (what, says) in [
        ("headless", "XR_MND_headless"),
        ("parametric", "XR_EXT_haptic_parametric"),
        ("supported", "XR_EXT_haptic_parametric"),
        ("focused", "focus"),
    ] {
        mock.set(what, 0.0);
        let error = adapter.capabilities(&mock.settings(&[])).unwrap_err();
        assert!(matches!(&error, DeviceError::Missing(text) if text.contains(says)), "{error}");
        mock.set(what, 1.0);
    }
    mock.set("pcm", 0.0);
    let error = adapter.capabilities(&mock.settings(&[("form", "pcm")])).unwrap_err();
    assert!(error.to_string().contains("XR_FB_haptic_pcm"), "{error}");
    for library in ["no-such-runtime.so", "libm.so.6"] {
        let given = settings(&[("runtime", library)]).unwrap();
        let error = adapter.capabilities(&given).unwrap_err();
        assert!(
            matches!(&error, DeviceError::Setting { name, .. } if name == "runtime"),
            "{error}"
        );
    }
    assert_eq!(broken(&mock.record()), [""; 0]);
}
