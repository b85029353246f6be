//! Invalid use of the C functions returns an error with a status and a text, for every mistake that
//! a C compiler cannot catch.

use std::ffi::{CStr, CString, c_char, c_void};
use std::path::{Path, PathBuf};
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicUsize, Ordering};

use htex_c::htex_status::*;
use htex_c::*;

fn asset_path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../examples/scenes/vinyl.htex")
}

fn last_error() -> String {
    // SAFETY: a text of the library that ends with a zero.
    unsafe { CStr::from_ptr(htex_last_error()) }.to_str().unwrap().to_owned()
}

fn opened() -> htex_asset {
    let path = CString::new(asset_path().to_str().unwrap()).unwrap();
    let mut asset = htex_asset { id: 0 };
    // SAFETY: live pointers.
    let status = unsafe { htex_asset_open(path.as_ptr(), null(), &mut asset) };
    assert_eq!(status, HTEX_STATUS_OK, "{}", last_error());
    asset
}

fn voice_of(asset: htex_asset) -> htex_voice {
    let mut voice = htex_voice { id: 0 };
    // SAFETY: live pointers.
    let status = unsafe { htex_voice_new(asset, null(), &mut voice) };
    assert_eq!(status, HTEX_STATUS_OK, "{}", last_error());
    voice
}

fn is(status: htex_status, expected: htex_status) {
    assert_eq!(status, expected, "{}", last_error());
    assert!(!last_error().is_empty());
}

const MOTION: htex_motion = htex_motion {
    size: size_of::<htex_motion>() as u32,
    speed_mm_s: 80.0,
    force_n: 0.4,
    position_mm: f64::NAN,
    x_mm: f64::NAN,
    y_mm: f64::NAN,
};

#[test]
fn freed_and_foreign_handles_are_refused() {
    let asset = opened();
    let voice = voice_of(asset);
    assert_eq!(htex_asset_free(asset), HTEX_STATUS_OK);
    let mut block = [0.0f32; 64];
    // SAFETY: live pointers.
    unsafe {
        // The voice continues without its asset.
        assert_eq!(htex_voice_render(voice, block.as_mut_ptr(), 64), HTEX_STATUS_OK);
        let mut out = htex_voice { id: 0 };
        is(htex_voice_new(asset, null(), &mut out), HTEX_STATUS_BAD_HANDLE);
        assert_eq!(htex_voice_free(voice), HTEX_STATUS_OK);
        // Other tests have objects at the same time. These handles belong to none of them.
        let never = [0, 1, 1 << 20, u64::MAX];
        for id in never.into_iter().chain([voice.id]) {
            let voice = htex_voice { id };
            is(htex_voice_render(voice, block.as_mut_ptr(), 64), HTEX_STATUS_BAD_HANDLE);
            is(htex_voice_set_motion(voice, &MOTION), HTEX_STATUS_BAD_HANDLE);
            is(htex_voice_free(voice), HTEX_STATUS_BAD_HANDLE);
        }
        for id in never.into_iter().chain([asset.id]) {
            is(htex_asset_free(htex_asset { id }), HTEX_STATUS_BAD_HANDLE);
        }
        for id in never {
            is(htex_scene_stop(htex_scene { id }), HTEX_STATUS_BAD_HANDLE);
        }
        // A handle of one kind is not accepted as another kind.
        let (asset, voice) = (opened(), voice_of(opened()));
        is(htex_asset_free(htex_asset { id: voice.id }), HTEX_STATUS_BAD_HANDLE);
        is(htex_voice_free(htex_voice { id: asset.id }), HTEX_STATUS_BAD_HANDLE);
        is(htex_library_free(htex_library { id: voice.id }), HTEX_STATUS_BAD_HANDLE);
        assert_eq!(htex_asset_free(asset), HTEX_STATUS_OK);
        assert_eq!(htex_voice_free(voice), HTEX_STATUS_OK);
    }
}

#[test]
fn libraries_refuse_what_is_none() {
    let path = CString::new(asset_path().to_str().unwrap()).unwrap();
    let mut library = htex_library { id: 0 };
    let (mut asset, mut count, mut pages) = (htex_asset { id: 0 }, 0, 0);
    // SAFETY: live pointers, and NULL ones, which the functions look at before they use them.
    unsafe {
        let bad = HTEX_STATUS_INVALID_ARGUMENT;
        is(htex_library_open(null(), &mut library), bad);
        is(htex_library_open(path.as_ptr(), null_mut()), bad);
        is(htex_library_open(c"no.htexlib".as_ptr(), &mut library), HTEX_STATUS_IO);
        is(htex_library_open(path.as_ptr(), &mut library), HTEX_STATUS_INVALID_LIBRARY);
        let bad = HTEX_STATUS_BAD_HANDLE;
        is(htex_library_count(library, &mut count), bad);
        is(htex_library_page_count(library, &mut pages), bad);
        is(htex_library_name(library, null_mut(), 0, &mut pages), bad);
        is(htex_library_page_json(library, 0, null_mut(), 0, &mut pages), bad);
        is(htex_library_entry_json(library, c"a".as_ptr(), null_mut(), 0, &mut pages), bad);
        is(htex_library_asset(library, c"a".as_ptr(), null(), &mut asset), bad);
        is(htex_library_free(library), bad);
    }
}

#[test]
fn null_and_misaligned_pointers_are_refused() {
    let asset = opened();
    let voice = voice_of(asset);
    let mut bytes = [0u8; 64];
    let odd = bytes[1..].as_mut_ptr();
    // SAFETY: the functions look at these pointers before they use them.
    unsafe {
        let bad = HTEX_STATUS_INVALID_ARGUMENT;
        is(htex_asset_open(null(), null(), null_mut()), bad);
        is(htex_asset_open(c"x.htex".as_ptr(), null(), null_mut()), HTEX_STATUS_IO);
        is(htex_asset_open(c"\xff".as_ptr(), null(), null_mut()), bad);
        is(htex_asset_from_bytes(null(), 10, null(), null_mut()), bad);
        is(htex_asset_manifest_json(asset, null_mut(), 10, null_mut()), bad);
        is(htex_asset_manifest_json(asset, null_mut(), 0, null_mut()), bad);
        is(htex_asset_condition(asset, 1_000, null_mut()), bad);
        is(htex_asset_condition(asset, 0, null_mut()), bad);
        is(htex_voice_new(asset, null(), null_mut()), bad);
        is(htex_voice_render(voice, null_mut(), 64), bad);
        is(htex_voice_render(voice, odd.cast(), 8), bad);
        is(htex_voice_render(voice, null_mut(), usize::MAX), bad);
        is(htex_voice_set_motion(voice, null()), bad);
        is(htex_voice_set_motion(voice, odd.cast()), bad);
        is(htex_voice_render_path(voice, null(), 2, null_mut(), usize::MAX), bad);
        is(htex_scene_open(null(), null(), null(), null_mut()), bad);
        assert_eq!(htex_voice_render(voice, null_mut(), 0), HTEX_STATUS_OK);
    }
    htex_voice_free(voice);
    htex_asset_free(asset);
}

#[test]
fn motions_out_of_range_leave_the_voice_as_it_was() {
    let asset = opened();
    let (voice, twin) = (voice_of(asset), voice_of(asset));
    let wrong = [f64::NAN, f64::INFINITY, -1.0];
    let mut blocks = [[0.0f32; 256]; 2];
    // SAFETY: live pointers.
    unsafe {
        assert_eq!(htex_voice_set_motion(voice, &MOTION), HTEX_STATUS_OK, "{}", last_error());
        assert_eq!(htex_voice_set_motion(twin, &MOTION), HTEX_STATUS_OK);
        for number in wrong {
            for motion in [
                htex_motion { speed_mm_s: number, ..MOTION },
                htex_motion { force_n: number, ..MOTION },
            ] {
                is(htex_voice_set_motion(voice, &motion), HTEX_STATUS_INVALID_MOTION);
            }
        }
        let place = |x_mm, y_mm| htex_motion { x_mm, y_mm, ..MOTION };
        let far = htex_motion { position_mm: f64::INFINITY, ..MOTION };
        for motion in [far, place(f64::INFINITY, 0.0), place(0.0, f64::INFINITY)] {
            is(htex_voice_set_motion(voice, &motion), HTEX_STATUS_INVALID_MOTION);
        }
        // A place with only one known coordinate counts as unknown.
        assert_eq!(htex_voice_set_motion(voice, &place(f64::NAN, 1.0)), HTEX_STATUS_OK);
        assert_eq!(htex_voice_set_motion(twin, &MOTION), HTEX_STATUS_OK);
        for (voice, block) in [voice, twin].into_iter().zip(&mut blocks) {
            assert_eq!(htex_voice_render(voice, block.as_mut_ptr(), 256), HTEX_STATUS_OK);
        }
    }
    assert_eq!(blocks[0], blocks[1]);
    htex_voice_free(voice);
    htex_voice_free(twin);
    htex_asset_free(asset);
}

#[test]
fn options_are_checked_by_their_size() {
    let asset = opened();
    let mut voice = htex_voice { id: 0 };
    let mut options = htex_voice_options {
        size: size_of::<htex_voice_options>() as u32,
        model: null(),
        rate_hz: 0.0,
        seed: 3,
        motion: null(),
        synthesis: null(),
        gain: 0.0,
        limit: 0.0,
        envelope_bands: 0,
        no_frequency_scaling: 0,
        no_level_scaling: 0,
        no_contact: 0,
        ceiling: 0.0,
        fluctuation: 0,
    };
    let mut new = |options: &htex_voice_options| {
        // SAFETY: live pointers.
        let status = unsafe { htex_voice_new(asset, options, &mut voice) };
        if status == HTEX_STATUS_OK {
            htex_voice_free(voice);
        }
        status
    };
    assert_eq!(new(&options), HTEX_STATUS_OK);
    options.size = 0;
    is(new(&options), HTEX_STATUS_INVALID_ARGUMENT);
    // A program that was compiled against an older, shorter struct.
    options.size = size_of::<u32>() as u32;
    assert_eq!(new(&options), HTEX_STATUS_OK);
    options.size = size_of::<htex_voice_options>() as u32;
    options.model = c"nothing".as_ptr();
    is(new(&options), HTEX_STATUS_NO_REPRESENTATION);
    options.model = null();
    options.synthesis = c"somehow".as_ptr();
    is(new(&options), HTEX_STATUS_INVALID_ARGUMENT);
    options.synthesis = null();
    for rate_hz in [f64::NAN, f64::INFINITY, -1.0, 1.0, 1_999.0, 1e12] {
        options.rate_hz = rate_hz;
        is(new(&options), HTEX_STATUS_INVALID_ARGUMENT);
    }
    options.rate_hz = 0.0;
    for (gain, limit, bands) in [
        (f64::NAN, 0.0, 0),
        (-1.0, 0.0, 0),
        (0.0, f64::INFINITY, 0),
        (0.0, -1.0, 0),
        (0.0, 0.0, 33),
    ] {
        (options.gain, options.limit, options.envelope_bands) = (gain, limit, bands);
        is(new(&options), HTEX_STATUS_INVALID_ARGUMENT);
    }
    (options.gain, options.limit, options.envelope_bands) = (2.0, 0.5, 32);
    assert_eq!(new(&options), HTEX_STATUS_OK);
    options.ceiling = 10.0;
    assert_eq!(new(&options), HTEX_STATUS_OK);
    for ceiling in [-1.0, f64::INFINITY, f64::NAN] {
        options.ceiling = ceiling;
        is(new(&options), HTEX_STATUS_INVALID_ARGUMENT);
    }
    options.ceiling = 0.0;

    // A program that was compiled against a newer, longer struct, with an option that is unknown
    // here.
    #[repr(C)]
    struct Newer {
        known: htex_voice_options,
        more: u64,
    }
    options.rate_hz = 0.0;
    options.size = size_of::<Newer>() as u32;
    let mut newer = Newer { known: options, more: 0 };
    // SAFETY: `size` bytes are there.
    let at = |newer: &Newer| unsafe { &*(&raw const *newer).cast::<htex_voice_options>() };
    assert_eq!(new(at(&newer)), HTEX_STATUS_OK);
    newer.more = 1;
    is(new(at(&newer)), HTEX_STATUS_UNSUPPORTED);
    htex_asset_free(asset);
}

#[test]
fn texts_tell_their_length() {
    let asset = opened();
    let mut length = 0;
    // SAFETY: live pointers.
    unsafe {
        assert_eq!(htex_asset_manifest_json(asset, null_mut(), 0, &mut length), HTEX_STATUS_OK);
        let mut text = vec![1 as c_char; length + 1];
        let status = htex_asset_manifest_json(asset, text.as_mut_ptr(), text.len(), null_mut());
        assert_eq!(status, HTEX_STATUS_OK);
        let text = CStr::from_ptr(text.as_ptr()).to_str().unwrap();
        assert_eq!(text.len(), length);
        let json: serde_json::Value = serde_json::from_str(text).unwrap();
        assert_eq!(json["conditions"].as_array().unwrap().len(), 1);
        let mut short = [1 as c_char; 8];
        let status = htex_asset_manifest_json(asset, short.as_mut_ptr(), 8, &mut length);
        is(status, HTEX_STATUS_TRUNCATED);
        assert_eq!(CStr::from_ptr(short.as_ptr()).to_bytes().len(), 7);
    }
    htex_asset_free(asset);
}

/// Motions from programs compiled against other headers: with only speed and force, and with more
/// fields at the end.
#[test]
fn motions_have_the_size_of_their_header() {
    #[repr(C)]
    struct Early(u32, f64, f64);
    #[repr(C)]
    struct Late(htex_motion, f64);
    let size = |size: usize| u32::try_from(size).unwrap();
    let asset = opened();
    let mut blocks = [[0.0f32; 256]; 3];
    let speeds = [80.0, 200.0];
    let now = speeds.map(|speed_mm_s| htex_motion { speed_mm_s, ..MOTION });
    let early = speeds.map(|speed| Early(size(size_of::<Early>()), speed, 0.4));
    let late = now.map(|motion| {
        let size = size(size_of::<Late>());
        Late(htex_motion { size, ..motion }, 7.0)
    });
    let paths = [now.as_ptr(), early.as_ptr().cast(), late.as_ptr().cast::<htex_motion>()];
    for (path, block) in paths.into_iter().zip(&mut blocks) {
        let voice = voice_of(asset);
        // SAFETY: live pointers, to motions of the sizes that they state.
        unsafe {
            let status = htex_voice_render_path(voice, path, 2, block.as_mut_ptr(), 128);
            assert_eq!(status, HTEX_STATUS_OK, "{}", last_error());
            for wrong in [0, 4, 23, 25, u32::MAX] {
                let motion = htex_motion { size: wrong, ..MOTION };
                is(htex_voice_set_motion(voice, &motion), HTEX_STATUS_INVALID_ARGUMENT);
            }
        }
        assert_eq!(htex_voice_free(voice), HTEX_STATUS_OK);
    }
    assert!(blocks[0] == blocks[1] && blocks[0] == blocks[2]);
    htex_asset_free(asset);
}

/// Mutated files are refused or play. They never crash or leave handles behind.
#[test]
fn mutated_files_are_errors() {
    let original = std::fs::read(asset_path()).unwrap();
    let mut state = 1u64;
    let mut random = |below: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let (mut refused, mut played) = (0, 0);
    for _ in 0..2_000 {
        let mut bytes = original.clone();
        for _ in 0..1 + random(4) {
            let at = random(bytes.len());
            match random(4) {
                0 => bytes.truncate(at.max(1)),
                1 => bytes[at] ^= 1 << random(8),
                2 => bytes[at] = random(256) as u8,
                _ => bytes.insert(at, random(256) as u8),
            }
        }
        let mut asset = htex_asset { id: 0 };
        // SAFETY: live pointers.
        let status =
            unsafe { htex_asset_from_bytes(bytes.as_ptr(), bytes.len(), null(), &mut asset) };
        if status != HTEX_STATUS_OK {
            is(status, HTEX_STATUS_INVALID_ASSET);
            refused += 1;
            continue;
        }
        let mut voice = htex_voice { id: 0 };
        // SAFETY: live pointers.
        if unsafe { htex_voice_new(asset, null(), &mut voice) } == HTEX_STATUS_OK {
            let mut block = [0.0f32; 64];
            // SAFETY: live pointers.
            unsafe { htex_voice_render(voice, block.as_mut_ptr(), 64) };
            assert!(block.iter().all(|x| x.is_finite()));
            htex_voice_free(voice);
            played += 1;
        }
        assert_eq!(htex_asset_free(asset), HTEX_STATUS_OK);
    }
    println!("{refused} refused, {played} played");
    assert!(refused > 1_000);
}

static MESSAGES: AtomicUsize = AtomicUsize::new(0);

unsafe extern "C" fn count(_: htex_log_level, message: *const c_char, context: *mut c_void) {
    assert!(!message.is_null() && context as usize == 42);
    MESSAGES.fetch_add(1, Ordering::Relaxed);
}

/// A scene plays the same samples as the Rust crate, and its notes go to the log.
#[cfg(feature = "scene")]
#[test]
fn a_scene_plays_and_reports() {
    let folder = tempfile::tempdir().unwrap();
    let asset = asset_path().canonicalize().unwrap();
    let scene = serde_json::json!({
        "htex_scene": "1.0",
        "surfaces": [{ "asset": asset }],
        "motion": "live",
        "device": { "adapter": "org.htex.file" }
    });
    let path = folder.path().join("scene.json");
    std::fs::write(&path, scene.to_string()).unwrap();
    let path = CString::new(path.to_str().unwrap()).unwrap();
    let mut playing = htex_scene { id: 0 };
    let mut samples = [0.0f32; 2_000];
    let finger = htex_finger {
        size: size_of::<htex_finger>() as u32,
        speed_mm_s: 80.0,
        force_n: 0.4,
        x_mm: 1.0,
        y_mm: 1.0,
    };
    // SAFETY: live pointers.
    unsafe {
        htex_set_log(Some(count), 42 as *mut c_void);
        let status = htex_scene_open(path.as_ptr(), null(), null(), &mut playing);
        assert_eq!(status, HTEX_STATUS_OK, "{}", last_error());
        htex_set_log(None, null_mut());
        let mut length = 0;
        assert_eq!(htex_scene_plan_json(playing, null_mut(), 0, &mut length), HTEX_STATUS_OK);
        assert!(length > 100);
        let mut rate_hz = 0.0;
        for (asked, expected) in [(48_000.0, 48_000.0), (0.0, 20_000.0)] {
            let options =
                htex_scene_options { size: size_of::<htex_scene_options>() as u32, rate_hz: asked };
            let mut other = htex_scene { id: 0 };
            let status = htex_scene_open(path.as_ptr(), null(), &options, &mut other);
            assert_eq!(status, HTEX_STATUS_OK, "{}", last_error());
            htex_scene_rate_hz(other, &mut rate_hz);
            assert_eq!(rate_hz, expected);
            assert_eq!(htex_scene_free(other), HTEX_STATUS_OK);
        }
        assert_eq!(htex_scene_set_finger(playing, &finger), HTEX_STATUS_OK);
        let lost = htex_finger { x_mm: f64::NAN, ..finger };
        is(htex_scene_set_finger(playing, &lost), HTEX_STATUS_INVALID_MOTION);
        let mut rendered = 0;
        let status = htex_scene_render(playing, samples.as_mut_ptr(), 2_000, &mut rendered);
        assert_eq!((status, rendered), (HTEX_STATUS_OK, 2_000));
        assert_eq!(htex_scene_stop(playing), HTEX_STATUS_OK);
        while rendered > 0 {
            htex_scene_render(playing, samples.as_mut_ptr(), 2_000, &mut rendered);
        }
        assert_eq!(htex_scene_free(playing), HTEX_STATUS_OK);
    }
}

/// A refused device says what to do. An accepted one takes samples until it is finished, and is at
/// rest once it is freed.
#[cfg(feature = "scene")]
#[test]
fn a_device_is_opened_by_its_name() {
    let (name, other) = (c"channels", c"daq");
    let open = |name: &CStr, settings: &CStr, rate_hz: f64| {
        let mut device = htex_device { id: 0 };
        // SAFETY: live pointers.
        let status =
            unsafe { htex_device_open(name.as_ptr(), settings.as_ptr(), rate_hz, &mut device) };
        (status, device)
    };
    is(open(other, c"", 0.0).0, HTEX_STATUS_INVALID_ARGUMENT);
    is(open(name, c"to=nowhere", 0.0).0, HTEX_STATUS_INVALID_ARGUMENT);
    is(open(name, c"to", 0.0).0, HTEX_STATUS_INVALID_ARGUMENT);
    is(open(name, c"to=null", 1.0).0, HTEX_STATUS_INVALID_ARGUMENT);
    is(open(c"sdl", c"driver=/nowhere/libSDL2.so", 0.0).0, HTEX_STATUS_INVALID_ARGUMENT);
    assert!(last_error().contains("SDL"), "{}", last_error());
    let (status, device) = open(name, c"to=null", 0.0);
    assert_eq!(status, HTEX_STATUS_OK, "{}", last_error());
    let (samples, mut written) = ([0.25f32; 256], 7);
    let mut counts = htex_device_counts {
        size: 0,
        frames_written: 0,
        frames_played: 0,
        underruns: 0,
        latency_s: 0.0,
        peak: 0.0,
    };
    // SAFETY: live pointers.
    unsafe {
        let write = |count, written: *mut usize| {
            htex_device_write(device, samples.as_ptr(), count, 1_000, written)
        };
        assert_eq!(write(256, &mut written), HTEX_STATUS_OK, "{}", last_error());
        assert_eq!(written, 256);
        is(htex_device_status(device, &mut counts), HTEX_STATUS_INVALID_ARGUMENT);
        counts.size = size_of::<htex_device_counts>() as u32;
        assert_eq!(htex_device_status(device, &mut counts), HTEX_STATUS_OK);
        assert_eq!((counts.frames_written, counts.peak), (256, 0.25));
        assert_eq!(htex_device_finish(device), HTEX_STATUS_OK, "{}", last_error());
        is(write(1, &mut written), HTEX_STATUS_DEVICE);
        assert_eq!(written, 0);
        assert_eq!(htex_device_free(device), HTEX_STATUS_OK);
        is(write(1, &mut written), HTEX_STATUS_BAD_HANDLE);
    }
}
