//! Calls libhtex as a C program might: in any order, with any handles and any numbers.
#![allow(unsafe_code)] // The functions take pointers; all pointers here are live.

use std::ffi::{CStr, c_char};
use std::ptr::{null, null_mut};

use htex_c::htex_status::*;
use htex_c::*;

use crate::body::Bytes;

/// Largest number of calls per input, and of frames per call.
const MOST_CALLS: usize = 64;
const MOST_FRAMES: usize = 512;

/// Makes calls from the input: pairs of an operation and its arguments, with two existing assets
/// and one made from the end of the input. Returns true if at least one call renders.
///
/// # Panics
/// When a call reports an internal error of the library, an error has no text, or a sample is not
/// finite.
pub fn c_calls(input: &[u8]) -> bool {
    let mut calls =
        Calls { bytes: Bytes(input), assets: Vec::new(), voices: Vec::new(), rendered: false };
    calls.open(ASSET);
    for _ in 0..MOST_CALLS {
        if calls.bytes.0.is_empty() {
            break;
        }
        calls.one();
    }
    // Frees every remaining handle once. Handles that the input already freed are refused.
    for asset in std::mem::take(&mut calls.assets) {
        calls.told(htex_asset_free(asset));
    }
    for voice in std::mem::take(&mut calls.voices) {
        calls.told(htex_voice_free(voice));
    }
    calls.rendered
}

const ASSET: &[u8] = include_bytes!("../../../spec/playing-conformance/five_conditions.htex");

struct Calls<'a> {
    bytes: Bytes<'a>,
    assets: Vec<htex_asset>,
    voices: Vec<htex_voice>,
    rendered: bool,
}

impl Calls<'_> {
    fn told(&self, status: htex_status) -> bool {
        assert_ne!(status, HTEX_STATUS_INTERNAL);
        if status != HTEX_STATUS_OK {
            // SAFETY: a text of the library.
            let text = unsafe { CStr::from_ptr(htex_last_error()) };
            assert!(!text.is_empty() && text.to_str().is_ok());
        }
        status == HTEX_STATUS_OK
    }

    fn open(&mut self, bytes: &[u8]) {
        let mut asset = htex_asset { id: 0 };
        // SAFETY: live pointers.
        let status =
            unsafe { htex_asset_from_bytes(bytes.as_ptr(), bytes.len(), null(), &mut asset) };
        if self.told(status) {
            self.assets.push(asset);
        }
    }

    /// A number of any kind: small, usual, or arbitrary bits.
    fn number(&mut self) -> f64 {
        match self.bytes.next() {
            kind @ 0..=199 => f64::from(kind),
            200..=229 => f64::from(self.bytes.next()) / 100.0,
            _ => f64::from_bits(self.bytes.number()),
        }
    }

    fn motion(&mut self) -> htex_motion {
        htex_motion {
            size: size_of::<htex_motion>() as u32,
            speed_mm_s: self.number(),
            force_n: self.number(),
            position_mm: self.number(),
            x_mm: self.number(),
            y_mm: self.number(),
        }
    }

    /// A handle of this kind, or any number.
    fn handle(&mut self, all: &[u64]) -> u64 {
        match usize::from(self.bytes.next()) {
            at if at < 240 && !all.is_empty() => all[at % all.len()],
            _ => self.bytes.number(),
        }
    }

    fn asset(&mut self) -> htex_asset {
        let all: Vec<u64> = self.assets.iter().map(|asset| asset.id).collect();
        htex_asset { id: self.handle(&all) }
    }

    fn voice(&mut self) -> htex_voice {
        let all: Vec<u64> = self.voices.iter().map(|voice| voice.id).collect();
        htex_voice { id: self.handle(&all) }
    }

    fn one(&mut self) {
        match self.bytes.next() % 8 {
            0 => self.new_voice(),
            1 => {
                let (voice, motion) = (self.voice(), self.motion());
                // SAFETY: a live motion.
                self.told(unsafe { htex_voice_set_motion(voice, &motion) });
            }
            2 | 3 => self.render(),
            4 => self.spectrum(),
            5 => self.texts(),
            6 => {
                let asset = self.asset();
                self.told(htex_asset_free(asset));
            }
            _ => {
                let voice = self.voice();
                self.told(htex_voice_free(voice));
            }
        }
    }

    fn new_voice(&mut self) {
        let names =
            [null(), c"ar".as_ptr(), c"sbeta".as_ptr(), c"bands".as_ptr(), c"none".as_ptr()];
        let ways = [null(), null(), c"loop:0.1".as_ptr(), c"filter:15".as_ptr(), c"x".as_ptr()];
        let (asset, motion) = (self.asset(), self.motion());
        let mut options = htex_voice_options {
            size: size_of::<htex_voice_options>() as u32,
            model: names[usize::from(self.bytes.next()) % names.len()],
            rate_hz: [0.0, 8_000.0, 20_000.0, self.number()][usize::from(self.bytes.next()) % 4],
            seed: self.bytes.next().into(),
            motion: if self.bytes.next().is_multiple_of(2) { null() } else { &motion },
            synthesis: ways[usize::from(self.bytes.next()) % ways.len()],
            gain: self.number(),
            limit: self.number(),
            envelope_bands: (self.bytes.next() % 40).into(),
            no_frequency_scaling: (self.bytes.next() % 2).into(),
            no_level_scaling: 0,
            no_contact: 1,
            ceiling: [0.0, self.number()][usize::from(self.bytes.next()) % 2],
            fluctuation: 0,
        };
        // Not a byte of its own: the files that fuzzing has found keep their meaning.
        options.fluctuation = (options.seed % 2) as u32;
        let mut voice = htex_voice { id: 0 };
        // SAFETY: live pointers.
        if self.told(unsafe { htex_voice_new(asset, &options, &mut voice) }) {
            self.voices.push(voice);
        }
    }

    fn render(&mut self) {
        let mut out = [0.0f32; MOST_FRAMES];
        let frames = usize::from(self.bytes.next()) * 2;
        let voice = self.voice();
        // SAFETY: `frames` is at most the length.
        self.rendered |= self.told(unsafe { htex_voice_render(voice, out.as_mut_ptr(), frames) });
        let mut envelope = htex_envelope {
            size: size_of::<htex_envelope>() as u32,
            level_rms: 0.0,
            centroid_hz: 0.0,
            frames: 0,
        };
        let gain = self.number();
        self.told(htex_voice_set_gain(voice, gain));
        // SAFETY: live pointers.
        if self.told(unsafe { htex_voice_envelope(voice, &mut envelope, null_mut(), 0) }) {
            assert!(envelope.level_rms.is_finite() && envelope.centroid_hz.is_finite());
        }
        assert!(out.iter().all(|x| x.is_finite()));
    }

    fn spectrum(&mut self) {
        let (asset, at) = (self.asset(), self.motion());
        let hz = [self.number(), 20.0, 500.0, 1_000.0];
        let mut magnitude = [0.0; 4];
        let mut level = 0.0;
        // SAFETY: live arrays of four numbers.
        unsafe {
            self.told(htex_asset_magnitude(
                asset,
                null(),
                &at,
                hz.as_ptr(),
                magnitude.as_mut_ptr(),
                4,
            ));
            self.told(htex_asset_level_rms(asset, null(), &at, &mut level));
        }
        assert!(level.is_finite());
    }

    fn texts(&mut self) {
        let mut text = [1 as c_char; 256];
        let capacity = self.bytes.next().into();
        let (asset, voice, motion) = (self.asset(), self.voice(), self.motion());
        let mut length = 0;
        // SAFETY: `capacity` is less than the length.
        unsafe {
            self.told(htex_asset_manifest_json(asset, text.as_mut_ptr(), capacity, &mut length));
            self.told(htex_asset_unit(asset, text.as_mut_ptr(), capacity, &mut length));
            self.told(htex_voice_coverage(
                voice,
                &motion,
                text.as_mut_ptr(),
                capacity,
                &mut length,
            ));
        }
    }
}
