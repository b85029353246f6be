//! Code that runs in the audio or haptic thread does not allocate or free.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use htex::{Texture, VoiceOptions};
use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{AssetRequest, Exploration, ModelRequest, Take, fit_asset};
use htex_host::{Registry, Search};
use htex_scene::file::{self, Budget, DeviceChoice, Effect, Motion, Region, SceneFile, Switch};
use htex_scene::{Costs, Renderer, Scene, plan};
use xtask::plugins;

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
}

/// Counts a thread's calls of the system allocator.
struct Counting;

// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        CALLS.with(|calls| calls.set(calls.get() + 1));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        CALLS.with(|calls| calls.set(calls.get() + 1));
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn count(run: impl FnOnce()) -> usize {
    let before = CALLS.with(Cell::get);
    run();
    CALLS.with(Cell::get) - before
}

fn asset() -> Texture {
    Texture::from_bytes(&bytes()).unwrap()
}

/// A texture with two conditions and all models.
fn bytes() -> Vec<u8> {
    recorded_at(&[60.0, 120.0])
}

/// A texture recorded at these speeds, with all models.
fn recorded_at(speeds_mm_s: &[f64]) -> Vec<u8> {
    let take = |speed_mm_s: f64| {
        let options = SimulationOptions::new(Surface::Sandpaper)
            .with_speed_mm_s(speed_mm_s)
            .with_duration_s(4.0);
        Take {
            recording: simulate(&options).unwrap().to_recording("simulated").unwrap(),
            given: Exploration { speed_mm_s: Some(speed_mm_s), force_n: Some(0.4) },
        }
    };
    let model = |model: &htex_host::LoadedModel| {
        let request = ModelRequest::new(model);
        match model.short_name() {
            // The most expensive inverse.
            "mfcc" => request.with_options(model.options(&[("inverse", "nnls")]).unwrap()),
            _ => request,
        }
    };
    let request =
        AssetRequest::new("sandpaper").with_models(Registry::builtin().models().iter().map(model));
    let takes: Vec<Take> = speeds_mm_s.iter().map(|speed| take(*speed)).collect();
    let fitted = fit_asset(&takes, &request).unwrap();
    fitted.asset.to_bytes().unwrap()
}

/// Parameters of a model at both conditions. The model's voice is retuned between them.
#[test]
fn retuning_does_not_allocate() {
    let asset = asset();
    for model in Registry::builtin().models() {
        let band = asset.band();
        let parameters = |speed: f64| {
            let motion = htex::Motion::new(speed, 0.4);
            asset.representation(model.id()).unwrap().parameters(Some(motion)).unwrap().0
        };
        let (slow, fast) = (parameters(60.0), parameters(120.0));
        let rate_hz = model.voice_rate_hz(&slow, band, 20_000.0).unwrap();
        let mut voice = model.voice(&slow, band, rate_hz, 1).unwrap();
        let mut block = [0.0f32; 64];
        for i in 0..50 {
            let to = if i % 2 == 0 { &fast } else { &slow };
            let calls = count(|| {
                voice.retune(to).unwrap();
                voice.render(&mut block).unwrap();
            });
            assert_eq!(calls, 0, "{}, block {i}", model.id());
        }
    }
}

/// Voices in common calls, more than fit in one call.
#[test]
fn rendering_together_does_not_allocate() {
    let asset = asset();
    for model in Registry::builtin_names() {
        let source = |seed| {
            let options = VoiceOptions::default().with_seed(seed);
            asset.representation(model).unwrap().source(&options).unwrap()
        };
        let mut sources: Vec<_> = (0..18).map(source).collect();
        let mut out = vec![0.0; 18 * 128];
        for i in 0..40 {
            let calls = count(|| {
                sources[i % 18].set_motion(htex::Motion::new(60.0 + i as f64, 0.4)).unwrap();
                htex::play::SampleSource::render_together(&mut sources, 128, &mut out).unwrap();
            });
            assert_eq!(calls, 0, "{model}, block {i}");
        }
    }
}

/// Renders blocks of a voice. Before each block the finger changes its speed.
fn follow(voice: &mut htex::Voice, what: &str) {
    let mut block = [0.0f32; 64];
    for i in 0..400 {
        let force_n = if i % 50 < 40 { 0.4 + 0.01 * f64::from(i % 7) } else { 0.0 };
        let calls = count(|| {
            voice.set_motion(htex::Motion::new(60.0 + f64::from(i % 61), force_n)).unwrap();
            assert!(voice.coverage(htex::Motion::new(80.0, 0.4)).slides);
            voice.render(&mut block).unwrap();
        });
        assert_eq!(calls, 0, "{what}, block {i}");
    }
}

#[test]
fn following_the_finger_does_not_allocate() {
    assert!(count(|| drop(std::hint::black_box(vec![1u8]))) >= 2, "the counter counts");
    // One interpolates between two speeds, the other scales from a single speed.
    let one = Texture::from_bytes(&recorded_at(&[80.0])).unwrap();
    let assets = [asset(), one];
    let of_all = |asset| Registry::builtin_names().into_iter().map(move |model| (asset, model));
    for (asset, model) in assets.iter().flat_map(of_all) {
        for rate_hz in [20_000.0, 44_100.0] {
            let options = VoiceOptions::default().with_rate_hz(rate_hz);
            let mut voice = asset.representation(model).unwrap().voice(&options).unwrap();
            follow(&mut voice, &format!("{model} at {rate_hz} Hz"));
        }
    }
}

#[test]
fn following_the_finger_does_not_allocate_in_a_sandbox() {
    let Some(modules) = plugins::wasm_if_there() else {
        return;
    };
    let names = Registry::builtin_names().into_iter();
    let files = names.map(|model| modules.join(format!("htex_{model}.wasm")));
    let search = Search::builtin().with_files(files.collect());
    let data = htex_format::Asset::from_bytes(&bytes()).unwrap();
    let asset = Texture::with_registry(data, Registry::search(&search).unwrap());
    for model in Registry::builtin_names() {
        assert!(asset.registry().find(model).unwrap().origin().to_string().contains("wasm"));
        let representation = asset.representation(model).unwrap();
        let mut voice = representation.voice(&VoiceOptions::default()).unwrap();
        follow(&mut voice, &format!("{model} as WASM"));
    }
}

#[test]
fn a_scene_is_rendered_without_allocating() {
    let asset = asset();
    let device = htex_device::Capabilities {
        quantity: htex_device::Quantity::DisplayVoltage,
        rates: htex_device::Rates::List(vec![20_000.0]),
        default_rate_hz: 20_000.0,
        limit: Some(150.0),
        step: Some(0.015),
        carrier_hz: Some(7_000.0),
        paced: true,
        block_frames: 64,
    };
    for model in Registry::builtin_names() {
        let scene = live_scene(&asset, model);
        let plan = plan(&scene, &device, &Costs::embedded()).unwrap();
        let mut renderer = Renderer::new(&scene, &plan).unwrap();
        let mut block = [0.0f32; 64];
        for i in 0..400 {
            let force_n = if i % 100 < 90 { 0.4 } else { 0.0 };
            let motion = htex::Motion::new(90.0 + 30.0 * f64::from(i).sin(), force_n)
                .with_place_mm([f64::from(i % 50), 0.0]);
            let calls = count(|| {
                renderer.set_motion(motion).unwrap();
                assert_eq!(renderer.render(&mut block).unwrap(), block.len());
            });
            assert_eq!(calls, 0, "{model}, block {i}");
        }
        assert!(renderer.peak() > 1.0, "there is a drive");
    }
}

/// Two surfaces side by side, with every effect on, and an arbitrary motion.
fn live_scene(asset: &Texture, model: &str) -> Scene {
    let surface = |from: f64| file::Surface {
        region: Some(Region { x_mm: [from, from + 20.0], y_mm: [-1.0, 1.0] }),
        representation: model.to_owned(),
        ..file::Surface::everywhere("asset.htex".as_ref())
    };
    Scene {
        file: SceneFile {
            htex_scene: "1.0".to_owned(),
            surfaces: vec![surface(0.0), surface(20.0)],
            motion: Motion::Live,
            device: DeviceChoice::default(),
            duration_s: None,
            seed: 0,
            budget: Budget::default(),
            effects: Effect::ALL.map(|effect| (effect, Switch::On)).into(),
        },
        folder: "".into(),
        assets: vec![asset.clone(); 2],
        trace: None,
        response: Some(htex_scene::Response {
            frequency_hz: vec![20.0, 1_000.0],
            magnitude: vec![1.0, 0.3],
            phase_rad: vec![0.0; 2],
        }),
        settings: htex_device::Settings::default(),
        notes: Vec::new(),
    }
}

/// A voice's output, envelope and errors, at motions that lift the finger and at impossible ones.
#[test]
fn voices_measure_and_fail_without_allocating() {
    let asset = asset();
    for model in Registry::builtin_names() {
        let options = VoiceOptions::default().with_limit(0.2).with_envelope_bands(5);
        let mut voice = asset.representation(model).unwrap().voice(&options).unwrap();
        let (mut block, mut bands) = ([0.0f32; 200], [0.0; 5]);
        for i in 0..200u32 {
            let speed_mm_s = [90.0, 0.0, f64::NAN, 300.0, 2_000.0][i as usize % 5];
            let calls = count(|| {
                let set = voice.set_motion(htex::Motion::new(speed_mm_s, 0.4));
                assert_eq!(set.is_err(), speed_mm_s.is_nan());
                drop(set);
                assert!(voice.set_gain(-1.0).is_err());
                voice.set_gain(f64::from(i % 3)).unwrap();
                voice.render(&mut block[..i as usize]).unwrap();
                voice.render_add(&mut block, 0.5).unwrap();
                assert!(voice.envelope(&mut bands[..3]).is_err());
                voice.envelope(&mut bands).unwrap();
            });
            assert_eq!(calls, 0, "{model}, block {i}");
        }
    }
}
