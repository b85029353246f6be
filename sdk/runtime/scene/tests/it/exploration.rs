//! A voice of the crate `htex` plays a motion in the same way as a scene.

use crate::common;

use common::{constant, display, file, grid, planned, rendered, scene, single};
use htex_device::Capabilities;
use htex_format::{AtCondition, Condition, Contact, Law, Quantity};
use htex_play::{Conditions, Effects, Motion, Reach, Registry, Scaling, Voice, VoiceOptions};
use htex_scene::Renderer;
use htex_scene::file::Motion as SceneMotion;

const RATE_HZ: f64 = 20_000.0;
const RECORDED: (f64, f64) = (80.0, 0.4);
/// Frames between two motions, as in a scene at this rate.
const CONTROL: usize = 64;

/// A voice with the same seed as the first surface of a scene.
fn voice(model: &str, motion: Option<(f64, f64)>, effects: Effects) -> Voice {
    let options = VoiceOptions::default()
        .with_seed(1)
        .with_motion(motion.map(|(speed, force)| Motion::new(speed, force)))
        .with_effects(effects);
    single().representation(model).unwrap().voice(&options).unwrap()
}

fn samples(voice: &mut Voice, frames: usize) -> Vec<f32> {
    let mut out = vec![0.0; frames];
    voice.render(&mut out).unwrap();
    out
}

fn rms_db(signal: &[f32]) -> f64 {
    let power: f64 = signal.iter().map(|x| f64::from(*x).powi(2)).sum();
    10.0 * (power / signal.len() as f64).log10()
}

/// Power per octave from `low_hz`, decibels relative to the total.
fn octaves(signal: &[f32], low_hz: f64) -> Vec<f64> {
    let n = 4_000;
    let mut power = [0.0; 6];
    for segment in signal.chunks_exact(n) {
        for (k, power_of) in power.iter_mut().enumerate() {
            let edge = |k: usize| (low_hz * 2f64.powi(k as i32) * n as f64 / RATE_HZ) as usize;
            *power_of += (edge(k)..edge(k + 1)).map(|bin| bin_power(segment, bin)).sum::<f64>();
        }
    }
    let all: f64 = power.iter().sum();
    power.iter().map(|p| 10.0 * (p / all).log10()).collect()
}

/// Goertzel's algorithm on the Hann-windowed segment.
fn bin_power(segment: &[f32], bin: usize) -> f64 {
    let turn = std::f64::consts::TAU / segment.len() as f64;
    let coefficient = 2.0 * (turn * bin as f64).cos();
    let (mut a, mut b) = (0.0, 0.0);
    for (i, x) in segment.iter().enumerate() {
        let window = 0.5 - 0.5 * (turn * i as f64).cos();
        (a, b) = (window * f64::from(*x) + coefficient * a - b, a);
    }
    a * a + b * b - coefficient * a * b
}

#[test]
fn a_constant_motion_plays_as_in_a_scene_from_the_start_or_after_a_change() {
    std::thread::scope(|scope| {
        for model in Registry::builtin_names() {
            scope.spawn(move || plays_as_in_a_scene(model));
        }
    });
}

fn plays_as_in_a_scene(model: &str) {
    for motion in [RECORDED, (160.0, 0.8), (30.0, 0.2), (0.0, 0.4), (80.0, 0.0)] {
        // Over eight seconds, the power in the octave from 20 Hz has an uncertainty of 0.35 dB.
        let mut scene = scene(single(), constant(motion.0, motion.1), 8.0);
        scene.file.surfaces[0].representation = model.to_owned();
        let mut renderer = Renderer::new(&scene, &planned(&scene, &file())).unwrap();
        let played = rendered(&mut renderer);
        let made = samples(&mut voice(model, Some(motion), Effects::default()), played.len());
        let peak = played.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
        let same = |(a, b): (&f32, &f32)| (a - b).abs() <= 1e-5 * peak;
        assert!(played.iter().zip(&made).all(same), "{model} at {motion:?}");

        let mut moved = voice(model, None, Effects::default());
        moved.set_motion(Motion::new(motion.0, motion.1)).unwrap();
        // Waits until the ramps of level and contact end.
        samples(&mut moved, 1_000);
        let moved = samples(&mut moved, played.len());
        if peak == 0.0 {
            assert!(motion.0 * motion.1 == 0.0 && moved.iter().all(|x| *x == 0.0));
            continue;
        }
        let difference_db = rms_db(&moved) - rms_db(&played);
        assert!(difference_db.abs() < 0.4, "{model} at {motion:?}: {difference_db} dB");
        let low_hz = 20.0 * motion.0 / RECORDED.0;
        for (k, (a, b)) in octaves(&moved, low_hz).iter().zip(octaves(&played, low_hz)).enumerate()
        {
            // Octaves 30 dB below the total are not compared. The lowest octave contains the edge
            // of the band. There, a voice after a change of motion plays up to 6 dB more between 5
            // and 7 Hz (of 7.5).
            let most_db = if k == 0 { 3.0 } else { 1.5 };
            assert!(
                (a - b).abs() < most_db || b < -30.0,
                "{model} at {motion:?}, octave {k}: {a} and {b} dB"
            );
        }
    }
}

/// A stroke with increasing speed and force that stops at its end.
fn stroke(block: usize, blocks: usize) -> (f64, f64) {
    let part = block as f64 / blocks as f64;
    if part < 0.9 { (40.0 + 160.0 * part, 0.2 + 0.6 * part) } else { (0.0, 0.4) }
}

#[test]
fn a_live_motion_plays_as_in_a_scene() {
    let blocks = 4 * RATE_HZ as usize / CONTROL;
    for model in Registry::builtin_names() {
        let mut scene = scene(single(), SceneMotion::Live, 5.0);
        scene.file.surfaces[0].representation = model.to_owned();
        let mut renderer = Renderer::new(&scene, &planned(&scene, &file())).unwrap();
        let mut voice = voice(model, Some(stroke(0, blocks)), Effects::default());
        let (mut played, mut followed) = (Vec::new(), Vec::new());
        for block in 0..blocks {
            let (speed_mm_s, force_n) = stroke(block, blocks);
            renderer.set_motion(Motion::new(speed_mm_s, force_n)).unwrap();
            let mut out = [0.0f32; CONTROL];
            renderer.render(&mut out).unwrap();
            played.extend(out);
            voice.set_motion(Motion::new(speed_mm_s, force_n)).unwrap();
            followed.extend(samples(&mut voice, CONTROL));
        }
        // Windows of half a second during the stroke, then silence at its end.
        let window = RATE_HZ as usize / 2;
        for (i, (a, b)) in
            followed.chunks(window).zip(played.chunks(window)).enumerate().skip(1).take(6)
        {
            let difference_db = rms_db(a) - rms_db(b);
            assert!(difference_db.abs() < 1.0, "{model}, window {i}: {difference_db} dB");
        }
        let end = followed.len() - 4_000;
        assert!(followed[end..].iter().chain(&played[end..]).all(|x| *x == 0.0), "{model}");
    }
}

#[test]
fn samples_do_not_depend_on_blocks_or_on_the_recorded_motion() {
    let motions = [RECORDED, (80.0, 0.5), (200.0, 0.4), (0.0, 0.0), (120.0, 0.4), RECORDED];
    for model in Registry::placeless_names() {
        let follow = |size: usize| {
            let mut voice = voice(model, None, Effects::default());
            let mut all = Vec::new();
            for (speed, force) in motions {
                voice.set_motion(Motion::new(speed, force)).unwrap();
                let mut out = [0.0f32; 900];
                out.chunks_mut(size).for_each(|block| voice.render(block).unwrap());
                all.extend(out);
            }
            all
        };
        let whole = follow(900);
        assert!([1, 7, 64].iter().all(|size| follow(*size) == whole), "{model}");
        let (mut plain, mut followed) =
            (voice(model, None, Effects::NONE), voice(model, None, Effects::default()));
        for _ in 0..20 {
            followed.set_motion(Motion::new(RECORDED.0, RECORDED.1)).unwrap();
            assert_eq!(samples(&mut followed, 333), samples(&mut plain, 333), "{model}");
        }
    }
}

#[test]
fn a_voice_reports_its_coverage_of_a_motion() {
    let all = voice("ar", None, Effects::default());
    assert!(all.coverage(Motion::new(80.0, 0.4)).is_inside());
    let beyond = all.coverage(Motion::new(160.0, 0.2));
    assert_eq!(
        beyond.to_string(),
        "160 mm/s, where 80 mm/s was recorded; 0.2 N, where 0.4 N was recorded: \
         frequencies are 2.000 times as high, and the level is 0.500 times as high"
    );
    assert!(!beyond.is_inside() && !all.coverage(Motion::new(0.0, 0.4)).slides);
    let none = voice("ar", None, Effects::NONE).coverage(Motion::new(160.0, 0.0));
    let outside = Reach::Outside { asked: 160.0, recorded: 80.0 };
    assert!(none.slides && none.speed == outside);
    assert_eq!((none.scaling, none.excess()), (Scaling::NONE, 1.0));

    // A 1 kHz texture at a sample rate of 4 kHz can play at most twice as fast.
    let options = VoiceOptions::default().with_rate_hz(4_000.0);
    let low = |speed: f64| {
        let mut voice = single().voice(&options).unwrap();
        voice.set_motion(Motion::new(speed, 0.4)).unwrap();
        (samples(&mut voice, 4_000), voice.coverage(Motion::new(speed, 0.4)))
    };
    let ((faster, coverage), (twice, _)) = (low(320.0), low(160.0));
    assert!(faster == twice && faster != low(120.0).0);
    assert_eq!(coverage.scaling.frequency, 2.0);

    // Four conditions, 60 and 120 mm/s by 0.3 and 0.6 N.
    let of = |motion: (f64, f64)| {
        grid()
            .representation(None)
            .unwrap()
            .conditions()
            .unwrap()
            .coverage(Motion::new(motion.0, motion.1), Effects::default())
    };
    assert!(of((100.0, 0.4)).is_inside() && of((122.0, 0.6)).is_inside());
    let fast = of((240.0, 0.4));
    assert_eq!(fast.force, Reach::Inside);
    let outside = Reach::Outside { asked: 240.0, recorded: 120.0 };
    assert_eq!(fast.speed, outside);
    assert_eq!(fast.excess(), 0.0);
}

/// Forces that are equal within the tolerance count as one force. Each of these forces plays as
/// recorded. Other forces are scaled.
#[test]
fn forces_within_tolerance_count_as_one() {
    let condition = |speed: f64, force: f64| Condition {
        speed_mm_s: Some(speed),
        force_n: Some(force),
        ..Condition::default()
    };
    let conditions = [condition(40.0, 0.4069), condition(80.0, 0.4061), condition(160.0, 0.4014)];
    let at = [0, 1, 2].map(|condition| AtCondition {
        condition,
        level_rms: 1.0,
        quality: None,
        left_out: None,
    });
    let law = Law::assumed(Quantity::LateralForce, Contact::Finger);
    let recorded = Conditions::new(&at, &conditions, law);
    let range = recorded.range();
    assert!(!range.speed.is_one() && range.force.is_one());
    let level = |speed: f64, force: f64| {
        let motion = Motion::new(speed, force);
        recorded.scaling(motion, 4.0).level
    };
    for condition in &conditions {
        let [speed, force] = [condition.speed_mm_s, condition.force_n].map(Option::unwrap);
        assert_eq!(level(speed, force), 1.0);
    }
    assert_eq!(level(80.0, 0.8138), 2.0);
    assert_eq!(level(80.0, 0.2007), 0.5);
    // At most the ceiling: four times the strongest level.
    assert_eq!(level(80.0, 12.0), 4.0);
}

/// Voices and scenes ignore an impossible reading for a tenth of a second. After that there is
/// silence.
#[test]
fn a_failed_reading_is_held_and_then_silent() {
    let failed = (80.0, 12_050.0);
    let mut held = voice("bands", Some(RECORDED), Effects::default());
    let mut plain = voice("bands", Some(RECORDED), Effects::default());
    held.set_motion(Motion::new(failed.0, failed.1)).unwrap();
    let hold = (htex_play::exploration::HOLD_S * RATE_HZ) as usize;
    assert_eq!(samples(&mut held, hold), samples(&mut plain, hold));
    samples(&mut held, 400);
    assert!(samples(&mut held, 1_000).iter().all(|x| *x == 0.0));
    held.set_motion(Motion::new(RECORDED.0, RECORDED.1)).unwrap();
    assert!(samples(&mut held, 1_000).iter().any(|x| *x != 0.0));

    let scene = scene(single(), SceneMotion::Live, 5.0);
    let mut renderer = Renderer::new(&scene, &planned(&scene, &file())).unwrap();
    let mut play = |(speed_mm_s, force_n): (f64, f64), frames: usize| {
        renderer.set_motion(Motion::new(speed_mm_s, force_n)).unwrap();
        let mut out = vec![0.0f32; frames];
        renderer.render(&mut out).unwrap();
        out
    };
    let good = rms_db(&play(RECORDED, 20_000));
    let held_db = rms_db(&play(failed, hold - 2 * CONTROL));
    assert!((held_db - good).abs() < 3.0, "{good} and {held_db} dB");
    play(failed, 2_000);
    assert!(play(failed, 1_000).iter().all(|x| *x == 0.0));
}

/// Returns the samples of a live scene, with one invalid reading if `bad` is given.
fn with_bad(device: &Capabilities, bad: Option<(f64, f64, Option<[f64; 2]>)>) -> Vec<f32> {
    let scene = scene(grid(), SceneMotion::Live, 1.0);
    let mut renderer = Renderer::new(&scene, &planned(&scene, device)).unwrap();
    let mut out = vec![0.0f32; 20_000];
    for (i, block) in out.chunks_mut(CONTROL).enumerate() {
        let good = Motion::new(60.0 + 20.0 * (0.05 * i as f64).sin(), 0.4)
            .with_place_mm([0.2 * i as f64, 0.0]);
        match bad.filter(|_| i == 150) {
            None if i == 150 => {}
            None => renderer.set_motion(good).unwrap(),
            Some((speed_mm_s, force_n, place)) => {
                let bad = Motion::new(speed_mm_s, force_n).with_place_mm(place);
                let _ = renderer.set_motion(bad);
            }
        }
        renderer.render(block).unwrap();
    }
    out
}

/// A single invalid reading of force, speed or place does not change what is felt, on any device.
#[test]
fn one_bad_reading_changes_no_sample() {
    let place = Some([30.0, 0.0]);
    for device in [file(), display()] {
        let plain = with_bad(&device, None);
        assert!(plain.iter().any(|x| *x != 0.0));
        for bad in [
            (60.0, 20.5, place),
            (60.0, 1e9, place),
            (60.0, f64::NAN, place),
            (60.0, -3.0, place),
            (1_001.0, 0.4, place),
            (-1e6, 0.4, place),
            (f64::NAN, 0.4, place),
            (f64::INFINITY, f64::NEG_INFINITY, None),
            (60.0, 0.4, Some([f64::NAN, 0.0])),
        ] {
            assert!(with_bad(&device, Some(bad)) == plain, "{bad:?}");
        }
    }
}

/// A voice also treats an invalid number as a failed reading: it refuses the number, holds the last
/// motion, and is then silent.
#[test]
fn a_reading_that_is_no_number_is_held_and_then_silent() {
    let hold = (htex_play::exploration::HOLD_S * RATE_HZ) as usize;
    for (speed_mm_s, force_n) in
        [(f64::NAN, 0.4), (80.0, f64::NAN), (-80.0, 0.4), (80.0, f64::INFINITY)]
    {
        let mut held = voice("bands", Some(RECORDED), Effects::default());
        let mut plain = voice("bands", Some(RECORDED), Effects::default());
        held.set_motion(Motion::new(speed_mm_s, force_n)).unwrap_err();
        assert_eq!(samples(&mut held, hold), samples(&mut plain, hold));
        samples(&mut held, 400);
        assert!(samples(&mut held, 1_000).iter().all(|x| *x == 0.0));
    }
}

/// By its scaling law, a texture recorded at 0.4 N would be 34 dB stronger at 20 N. The ceiling
/// limits it to four times the recorded level, or to the requested ceiling.
#[test]
fn no_voice_is_louder_than_its_ceiling() {
    let strong = |ceiling: f64| {
        let options =
            VoiceOptions::default().with_motion(Motion::new(80.0, 20.0)).with_ceiling(ceiling);
        rms_db(&samples(
            &mut single().representation("bands").unwrap().voice(&options).unwrap(),
            80_000,
        ))
    };
    let recorded =
        rms_db(&samples(&mut voice("bands", Some(RECORDED), Effects::default()), 80_000));
    for (ceiling, rise_db) in [(4.0, 12.04), (10.0, 20.0), (1_000.0, 33.98)] {
        let rise = strong(ceiling) - recorded;
        assert!((rise - rise_db).abs() < 0.1, "{ceiling}: {rise} dB");
    }
}
