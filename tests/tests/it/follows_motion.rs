//! Models that follow the motion themselves, from their sources to a scene: bursts that occur along
//! the way, and a surface that feels the same at the same place. Tested as native libraries and as
//! WASM modules.

use crate::common::{builds, scenes};

use std::path::Path;

use builds::*;
use htex::model::Search;
use htex::play::Reach;
use htex::{Registry, Texture, Voice, VoiceOptions};
use htex_author::{AssetRequest, Exploration, ModelRequest, Recording, Take, fit_asset};
use htex_host::{Band, Stream};
use htex_scene::file::Motion;
use htex_scene::{Plan, Renderer};
use scenes::{planned, rendered, trace, traced};

const RATE_HZ: f64 = 20_000.0;
/// Speed and force stated for the recordings.
const SPEED_MM_S: f64 = 50.0;
const FORCE_N: f64 = 0.5;
/// Samples between two motions, the same as in a scene at this rate.
const CONTROL: usize = 64;
/// Twice the longest time, in samples, by which the stages after a voice read ahead.
const MOST_SHIFT: usize = 200;
/// Duration of a finger's way, 40 mm and back: four seconds.
const WAY_S: f64 = 4.0;

// ---- bursts a millimetre ----

#[test]
fn bursts_come_with_the_way_of_the_finger() {
    let project = bursts_project();
    bursts_follow(&build_c(&project, "native"));
    if has_clang() {
        bursts_follow(&build_c(&project, "wasm"));
    }
}

/// A recording with ten bursts per second at 50 mm/s has a burst every 5 mm, at any speed.
fn bursts_follow(file: &Path) {
    let asset = fitted(file, &ten_bursts_a_second(file));
    let (parameters, _) = asset.representation(None).unwrap().parameters(None).unwrap();
    assert!((parameters[2] - 0.2).abs() < 0.005, "{parameters:?} a mm");
    assert_eq!(&parameters[5..], [SPEED_MM_S, FORCE_N]);
    for speed_mm_s in [25.0, 50.0, 100.0] {
        let mut voice = voice(&asset);
        let played = played(&mut voice, 10.0, |_| (speed_mm_s, FORCE_N, None));
        let a_second = bursts_a_second(&played);
        println!("{speed_mm_s} mm/s: {a_second} bursts a second");
        assert!((a_second / speed_mm_s - 0.2).abs() < 0.02, "{speed_mm_s} mm/s: {a_second}");
        assert!(matches!(voice.coverage(htex::Motion::new(100.0, FORCE_N)).speed, Reach::Followed));
        // A voice that is made at a speed must not also be read faster than it was recorded.
        let at = options().with_motion(htex::Motion::new(speed_mm_s, FORCE_N));
        let mut made = asset.voice(&at).unwrap();
        let a_second =
            bursts_a_second(&self::played(&mut made, 10.0, |_| (speed_mm_s, FORCE_N, None)));
        assert!((a_second / speed_mm_s - 0.2).abs() < 0.02, "made at {speed_mm_s}: {a_second}");
    }
    // The force determines the level, as the model specifies.
    let loudness = |force_n| rms(&played(&mut voice(&asset), 4.0, |_| (SPEED_MM_S, force_n, None)));
    let gain = loudness(2.0 * FORCE_N) / loudness(FORCE_N);
    assert!((gain - 2.0).abs() < 0.1, "twice the force: {gain}");

    one_bad_reading_is_not_felt(&asset);

    // 25 mm/s in the first half, 100 mm/s in the second.
    let path = |t: f64| 25.0 * t + 75.0 * (t - 10.0).max(0.0);
    let scene = traced(&asset, trace(20.0, FORCE_N, |t| [path(t), 0.0]));
    let plan = planned(&scene, RATE_HZ);
    the_plan_leaves_the_motion_to_the_model(&plan);
    let played = rendered(&scene, &plan);
    let (slow, fast) = played.split_at(played.len() / 2);
    let ratio = bursts_a_second(fast) / bursts_a_second(slow);
    assert!((ratio - 4.0).abs() < 0.5, "four times the speed: {ratio}");
}

/// In a live scene, a reading with an impossible force or speed does not reach the model.
fn one_bad_reading_is_not_felt(asset: &Texture) {
    let mut scene = traced(asset, trace(1.0, FORCE_N, |t| [50.0 * t, 0.0]));
    (scene.file.motion, scene.trace) = (Motion::Live, None);
    let plan = planned(&scene, RATE_HZ);
    let felt = |bad: Option<(f64, f64)>| {
        let mut renderer = Renderer::new(&scene, &plan).unwrap();
        let mut out = vec![0.0; 20_000];
        for (i, block) in out.chunks_mut(CONTROL).enumerate() {
            let reading = if i == 100 { bad } else { Some((SPEED_MM_S, FORCE_N)) };
            if let Some((speed_mm_s, force_n)) = reading {
                let _ = renderer.set_motion(htex::Motion::new(speed_mm_s, force_n));
            }
            renderer.render(block).unwrap();
        }
        out
    };
    let plain = felt(None);
    for bad in [(SPEED_MM_S, 25.0), (SPEED_MM_S, f64::NAN), (5_000.0, FORCE_N)] {
        assert!(felt(Some(bad)) == plain, "{bad:?}");
    }
}

fn ten_bursts_a_second(file: &Path) -> Vec<f64> {
    let recorded = [150.0, 100.0, 0.1, 0.3, 0.0, 100.0, 0.0];
    let mut stream = Stream::new(&load(file), &recorded, Band::TACTILE, RATE_HZ, 4).unwrap();
    let mut out = vec![0.0; 80_000];
    stream.render(&mut out).unwrap();
    out.into_iter().map(f64::from).collect()
}

/// How often the power over 10 ms rises through a fifth of its largest value, after it was below a
/// twentieth.
fn bursts_a_second(samples: &[f32]) -> f64 {
    let power: Vec<f64> = samples.chunks_exact(200).map(|block| rms(block).powi(2)).collect();
    let mut sorted = power.clone();
    sorted.sort_by(f64::total_cmp);
    let high = sorted[sorted.len() * 19 / 20];
    let (mut bursts, mut silent) = (0, true);
    for power in power {
        if silent && power > 0.2 * high {
            (bursts, silent) = (bursts + 1, false);
        } else if power < 0.05 * high {
            silent = true;
        }
    }
    f64::from(bursts) / (samples.len() as f64 / RATE_HZ)
}

// ---- a surface tied to the place ----

#[test]
fn the_same_place_feels_the_same_on_the_way_back() {
    let project = texel_project();
    place_is_kept(&build_rust(&project, None));
    if has_wasm_target() {
        place_is_kept(&build_rust(&project, Some(WASM)));
    }
}

fn place_is_kept(file: &Path) {
    let asset = fitted(file, &comb());
    let (parameters, _) = asset.representation(None).unwrap().parameters(None).unwrap();
    assert_eq!(&parameters[1..3], [SPEED_MM_S, FORCE_N]);
    assert!((parameters[0] - SPEED_MM_S / 65.0).abs() < 0.005, "{parameters:?}");
    let there_and_back = |t: f64| 20.0 * (1.0 - (std::f64::consts::TAU * t / WAY_S).cos());

    let by_place = |t: f64| {
        let (before, behind) = (there_and_back(t - 1e-4), there_and_back(t + 1e-4));
        ((behind - before).abs() / 2e-4, FORCE_N, Some(there_and_back(t)))
    };
    let through_the_facade = played(&mut voice(&asset), WAY_S, by_place);
    is_the_same_on_the_way_back("facade", &through_the_facade);

    let scene = traced(&asset, trace(WAY_S, FORCE_N, |t| [there_and_back(t), 0.0]));
    let plan = planned(&scene, RATE_HZ);
    the_plan_leaves_the_motion_to_the_model(&plan);
    // A scene reverses the force when the finger turns round.
    let mut played = rendered(&scene, &plan);
    let back = played.len() / 2;
    played[back..].iter_mut().for_each(|x| *x = -*x);
    is_the_same_on_the_way_back("scene", &played);
}

/// The way there and the reversed way back correlate, apart from the time by which the stages after
/// the voice read ahead. The way back, not reversed, does not correlate.
fn is_the_same_on_the_way_back(name: &str, samples: &[f32]) {
    let (there, back) = samples.split_at(samples.len() / 2);
    let reversed: Vec<f32> = back.iter().rev().copied().collect();
    let forward = best_correlation(there, back);
    let best = best_correlation(there, &reversed);
    println!(
        "{name}: there and back reversed correlate by {best:.5}, not reversed by {forward:.3}"
    );
    assert!(rms(there) > 1e-4, "{name}: there is nothing to feel");
    assert!(best > 0.99, "{name}: {best}");
    assert!(forward < 0.5, "{name}: {forward}");
}

fn best_correlation(a: &[f32], b: &[f32]) -> f64 {
    let part = |x: &[f32], from: usize| x[from..x.len() - MOST_SHIFT + from].to_vec();
    let early = (0..MOST_SHIFT).map(|shift| correlation(&part(a, 0), &part(b, shift)));
    let late = (0..MOST_SHIFT).map(|shift| correlation(&part(a, shift), &part(b, 0)));
    early.chain(late).fold(-1.0, f64::max)
}

fn correlation(a: &[f32], b: &[f32]) -> f64 {
    let dot = |a: &[f32], b: &[f32]| -> f64 {
        a.iter().zip(b).map(|(x, y)| f64::from(*x) * f64::from(*y)).sum()
    };
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
}

/// Four seconds of the multiples of 65 Hz.
fn comb() -> Vec<f64> {
    let sample = |n: u32| {
        let t = f64::from(n) / RATE_HZ;
        let line = |k: u32| {
            let k = f64::from(k);
            (std::f64::consts::TAU * 65.0 * k * t + k * k).sin() * 0.05 * (-0.2 * k).exp()
        };
        (1..=12).map(line).sum()
    };
    (0..80_000).map(sample).collect()
}

// ---- ways and means ----

/// An asset of a recording at 50 mm/s and 0.5 N, fitted by a model from a file.
fn fitted(file: &Path, recording: &[f64]) -> Texture {
    let search = Search::builtin().with_files(vec![file.to_owned()]);
    let registry = Registry::search(&search).unwrap();
    let model = registry.models()[0].clone();
    assert!(model.follows_motion(), "{}", model.id());
    let request = AssetRequest::new("followed").with_models([ModelRequest::new(&model)]);
    let take = Take {
        recording: Recording::new("made", RATE_HZ, vec![recording.to_vec()]).unwrap(),
        given: Exploration { speed_mm_s: Some(SPEED_MM_S), force_n: Some(FORCE_N) },
    };
    let fitted = fit_asset(&[take], &request).unwrap();
    Texture::with_registry(fitted.asset, registry)
}

fn options() -> VoiceOptions {
    VoiceOptions::default().with_rate_hz(RATE_HZ).with_seed(3)
}

fn voice(asset: &Texture) -> Voice {
    let voice = asset.voice(&options()).unwrap();
    assert!(voice.follows_motion());
    voice
}

/// Samples of a voice that moves: speed, force and position are functions of time.
fn played(
    voice: &mut Voice,
    seconds: f64,
    motion: impl Fn(f64) -> (f64, f64, Option<f64>),
) -> Vec<f32> {
    let mut out = vec![0.0; (seconds * RATE_HZ) as usize];
    for (i, block) in out.chunks_mut(CONTROL).enumerate() {
        let (speed, force, position) = motion((i * CONTROL) as f64 / RATE_HZ);
        let motion = htex::Motion::new(speed, force);
        let motion = position.map_or(motion, |mm| motion.with_position_mm(mm));
        voice.set_motion(motion).unwrap();
        voice.render(block).unwrap();
    }
    out
}

/// The plan scales neither frequencies nor levels, and says why.
fn the_plan_leaves_the_motion_to_the_model(plan: &Plan) {
    for name in ["frequency_scaling", "level_scaling"] {
        let left_out = plan.left_out.iter().find(|out| out.name == name);
        let reason = &left_out.unwrap_or_else(|| panic!("{name} is in")).reason;
        assert_eq!(reason, "the model follows the motion itself");
    }
}

fn rms(samples: &[f32]) -> f64 {
    let power: f64 = samples.iter().map(|x| f64::from(*x).powi(2)).sum();
    (power / samples.len() as f64).sqrt()
}
