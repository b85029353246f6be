//! Motions that no finger makes, on assets and in scenes.

use htex::play::Effects;
use htex::{Texture, VoiceOptions};
use htex_author::recording::Recording;
use htex_device::{Capabilities, Quantity, Rates, Settings};
use htex_scene::file::{self, Budget, Constant, DeviceChoice, Effect, Motion, SceneFile, Switch};
use htex_scene::{Costs, Renderer, Scene, plan};

use super::files::fitted;
use crate::signals::{RATE_HZ, friction, noise, scaled};
use crate::{Bound, Case, Section, refused, within, worse};

pub(crate) const SECTION: Section = Section {
    title: "Motion and drive",
    about: "Speeds and forces from nothing to beyond numbers, on an asset of two conditions (60 and 120 mm/s at \
            0.4 N) in every model, and in scenes with every stage on.",
    cases: CASES,
};

const LIMIT_V: f64 = 150.0;

/// An asset with one or two conditions and all models.
fn asset(conditions: usize) -> Texture {
    let recording = |x| Recording::new("hard", RATE_HZ, vec![x]).unwrap();
    let takes = vec![(recording(friction()), 60.0), (recording(scaled(&noise(), 0.1)), 120.0)];
    let fitted = fitted(takes.into_iter().take(conditions).collect()).unwrap();
    Texture::from_bytes(&fitted.asset.to_bytes().unwrap()).unwrap()
}

fn models() -> Vec<String> {
    let known = crate::seen::models();
    known.iter().map(|m| m.short_name().to_owned()).collect()
}

/// The largest sample, relative to 0.1 N, over every model's voice when it is moved like this
/// before each block.
fn moved(motions: &[(f64, f64)], effects: Effects) -> f64 {
    let asset = asset(2);
    let mut peak = 0.0;
    for model in models() {
        let options = VoiceOptions::default().with_effects(effects);
        let mut voice = asset.representation(&model[..]).unwrap().voice(&options).unwrap();
        let mut block = [0.0f32; 64];
        for i in 0..200 {
            let (speed_mm_s, force_n) = motions[i % motions.len()];
            if let Err(error) = voice.set_motion(htex::Motion::new(speed_mm_s, force_n)) {
                println!("{model}: {error}");
                return f64::NAN;
            }
            voice.render(&mut block).unwrap();
            peak = block.iter().fold(peak, |p, x| worse(p, f64::from(x.abs())));
        }
    }
    peak / 0.1
}

/// How every model's voice refuses a motion. The voice must play on.
fn motion_refused(speed_mm_s: f64, force_n: f64) -> String {
    let asset = asset(2);
    let mut said = String::new();
    for model in models() {
        let representation = asset.representation(&model[..]).unwrap();
        let mut voice = representation.voice(&VoiceOptions::default()).unwrap();
        match voice.set_motion(htex::Motion::new(speed_mm_s, force_n)) {
            Ok(()) => return "it was done".to_owned(),
            Err(error) => said = error.to_string(),
        }
        let mut block = [0.0f32; 256];
        voice.render(&mut block).unwrap();
        if block.iter().all(|x| *x == 0.0) {
            return "the voice fell silent".to_owned();
        }
    }
    said
}

/// What a device accepts: newtons, or volts on a carrier.
fn device(quantity: Quantity, rate_hz: f64, carrier_hz: Option<f64>) -> Capabilities {
    Capabilities {
        quantity,
        rates: Rates::List(vec![rate_hz]),
        default_rate_hz: rate_hz,
        limit: (quantity == Quantity::DisplayVoltage).then_some(LIMIT_V),
        step: None,
        carrier_hz,
        paced: true,
        block_frames: 64,
    }
}

/// A live scene with one surface that covers everything, and with every stage that can be forced
/// on.
fn scene(conditions: usize) -> Scene {
    Scene {
        file: SceneFile {
            htex_scene: "1.0".to_owned(),
            surfaces: vec![file::Surface {
                representation: "sslope".to_owned(),
                ..file::Surface::everywhere("asset.htex".as_ref())
            }],
            motion: Motion::Live,
            device: DeviceChoice::default(),
            duration_s: None,
            seed: 0,
            budget: Budget::default(),
            effects: Effect::ALL.map(|effect| (effect, Switch::On)).into(),
        },
        folder: "".into(),
        assets: vec![asset(conditions)],
        trace: None,
        response: None,
        settings: Settings::default(),
        notes: Vec::new(),
    }
}

/// The largest sample of a scene while the finger makes these motions in turn, and after it moves
/// sanely again. NaN if that is silent, or if the limiter had to handle NaN.
fn felt(device: &Capabilities, motions: &[(f64, f64)]) -> f64 {
    let scene = scene(1);
    let plan = plan(&scene, device, &Costs::embedded()).unwrap();
    let mut renderer = Renderer::new(&scene, &plan).unwrap();
    let mut block = [0.0f32; 64];
    let (mut peak, mut at_limit) = (0.0, 0);
    // The default drive voltage.
    let drive_v = device.limit.map(|limit| 0.5 * limit);
    for i in 0..600 {
        let (speed_mm_s, force_n) = match i {
            400.. => (60.0, 0.4),
            _ => motions[i / 10 % motions.len()],
        };
        renderer.set_motion(htex::Motion::new(speed_mm_s, force_n)).unwrap();
        renderer.render(&mut block).unwrap();
        let sizes = block.iter().map(|x| f64::from(x.abs()));
        at_limit += sizes.clone().filter(|x| Some(*x) == drive_v).count() as u64;
        peak = sizes.fold(peak, worse);
    }
    let held_numbers = renderer.limited_samples() == at_limit;
    if held_numbers && block.iter().any(|x| *x != 0.0) { peak } else { f64::NAN }
}

/// The largest sample of a constant scene with a finger that almost lifts off.
fn all_but_lifted(force_n: f64) -> f64 {
    let mut scene = scene(1);
    scene.file.effects.clear();
    scene.file.duration_s = Some(0.1);
    scene.file.motion =
        Motion::Constant(Constant { speed_mm_s: 80.0, force_n, from_mm: None, direction_deg: 0.0 });
    let device = device(Quantity::Sound, 20_000.0, None);
    let plan = plan(&scene, &device, &Costs::embedded()).unwrap();
    let mut renderer = Renderer::new(&scene, &plan).unwrap();
    let mut block = [f32::NAN; 2_000];
    renderer.render(&mut block).unwrap();
    let samples = block.iter().map(|x| f64::from(x.abs()));
    samples.fold(0.0, worse)
}

fn scene_refused(speed_mm_s: f64, force_n: f64) -> String {
    let scene = scene(2);
    let device = device(Quantity::LateralForce, 20_000.0, None);
    let plan = plan(&scene, &device, &Costs::embedded()).unwrap();
    let mut renderer = Renderer::new(&scene, &plan).unwrap();
    let moved = renderer.set_motion(htex::Motion::new(speed_mm_s, force_n));
    moved.map_or_else(|error| error.to_string(), |()| "it was done".to_owned())
}

/// The extreme values that still count as a reading of a finger.
const ENDS: [(f64, f64); 6] =
    [(0.0, 0.0), (1_000.0, 20.0), (0.0, 20.0), (1_000.0, 0.0), (5e-324, 5e-324), (80.0, 0.4)];
/// Impossible readings, beyond `f32` and longer than a motion is held.
const BEYOND_FLOATS: [(f64, f64); 4] = [(80.0, 1e39), (1e9, 0.4), (1e300, 1e300), (80.0, 0.4)];

const CASES: &[Case] = &[
    within(
        "speeds of 0 and 1000 mm/s, forces of 0 and 20 N, in turns",
        "voices of every model, without effects",
        "move and render",
        Bound(12.0, "× RMS", "finite, and samples"),
        || moved(&ENDS, Effects::NONE),
    ),
    within(
        "speeds and forces of 1e9, 1e39, 1e300, in turns",
        "voices of every model, without effects",
        "move and render",
        Bound(12.0, "× RMS", "finite, and samples"),
        || moved(&BEYOND_FLOATS, Effects::NONE),
    ),
    within(
        "speeds of 0 and 1000 mm/s, forces of 0 and 20 N, in turns, where one force is known",
        "voices of every model",
        "move and render",
        Bound(48.0, "× RMS (a gain of at most 4)", "finite, and samples"),
        || moved(&ENDS, Effects::default()),
    ),
    within(
        "speeds and forces of 1e9, 1e39, 1e300, in turns, where one force is known",
        "voices of every model",
        "move and render",
        Bound(48.0, "× RMS (a gain of at most 4)", "finite, and samples"),
        || moved(&BEYOND_FLOATS, Effects::default()),
    ),
    refused(
        "a speed of -1 mm/s",
        "voices of every model",
        "move",
        "both must be finite and not negative",
        || motion_refused(-1.0, 0.4),
    ),
    refused(
        "a speed that is NaN",
        "voices of every model",
        "move",
        "both must be finite and not negative",
        || motion_refused(f64::NAN, 0.4),
    ),
    refused(
        "an infinite force",
        "voices of every model",
        "move",
        "both must be finite and not negative",
        || motion_refused(80.0, f64::INFINITY),
    ),
    within(
        "speeds of 0 and 1000 mm/s, forces of 0 and 20 N, in turns, on a display on a carrier of 7 kHz",
        "scene",
        "move and render",
        Bound(LIMIT_V, "V", "finite, and not silent for ever,"),
        || felt(&device(Quantity::DisplayVoltage, 20_000.0, Some(7_000.0)), &ENDS),
    ),
    within(
        "speeds and forces of 1e9, 1e39, 1e300, in turns, on a display",
        "scene",
        "move and render",
        Bound(LIMIT_V, "V", "finite, and not silent for ever,"),
        || felt(&device(Quantity::DisplayVoltage, 20_000.0, Some(7_000.0)), &BEYOND_FLOATS),
    ),
    within(
        "speeds and forces of 1e9, 1e39, 1e300, in turns, on a device of newtons",
        "scene",
        "move and render",
        Bound(1.0, "N", "finite, and not silent for ever,"),
        || felt(&device(Quantity::LateralForce, 20_000.0, None), &BEYOND_FLOATS),
    ),
    refused(
        "a carrier at half the rate",
        "scene",
        "plan",
        "at least at 2.5 times its carrier",
        || {
            let device = device(Quantity::DisplayVoltage, 20_000.0, Some(10_000.0));
            let planned = plan(&scene(1), &device, &Costs::embedded());
            planned.map_or_else(|error| error.to_string(), |_| "it was done".to_owned())
        },
    ),
    within(
        "friction far beyond the drive's reach: forces of 1 to 20 N where 0.4 N is known",
        "scene",
        "square root",
        Bound(LIMIT_V, "V", "no radicand below 0, and the output"),
        || {
            felt(
                &device(Quantity::DisplayVoltage, 20_000.0, None),
                &[(60.0, 1.0), (60.0, 20.0), (60.0, 4.0)],
            )
        },
    ),
    within(
        "a force of 5e-324, 1e-300, 1e-30 N, brought to the level of speech",
        "scene",
        "render",
        Bound(1.0, "of full scale", "finite, and samples"),
        || [5e-324, 1e-300, 1e-30].map(all_but_lifted).into_iter().fold(0.0, worse),
    ),
    refused("a speed that is NaN", "scene", "move", "motion", || scene_refused(f64::NAN, 0.4)),
    refused("a force of -1 N", "scene", "move", "motion", || scene_refused(80.0, -1.0)),
    within(
        "back strokes: speeds from -1000 to 1000 mm/s",
        "scene",
        "move and render",
        Bound(1.0, "N", "finite, and not silent for ever,"),
        || {
            felt(
                &device(Quantity::LateralForce, 20_000.0, None),
                &[(-1_000.0, 0.4), (1_000.0, 0.4), (-80.0, 0.4)],
            )
        },
    ),
];
